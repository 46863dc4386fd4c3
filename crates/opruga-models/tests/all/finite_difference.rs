//! Curves, surfaces and solids by finite differences: derivatives, closed forms, refusals.

use crate::support::models::FiniteDifference;
use crate::support::{Part, system};
use opruga_core::check::{Options, conformance};
use opruga_core::potential::{Ingredients, Model};
use opruga_core::spec::Values;
use opruga_core::state::{Layout, Parameter};
use opruga_core::system::Stage;
use opruga_math::Lane;
use opruga_mesh::Mesh;

fn chain<const D: usize>() -> Mesh<D> {
    let at =
        |k: u32| core::array::from_fn(|d| [0.1 * f64::from(k), 0.03 * f64::from(k % 3), 0.02 * f64::from(k % 2)][d]);
    Mesh::polyline(&(0..29).map(at).collect::<Vec<_>>(), false).unwrap()
}
fn sheet(cells: [u32; 2]) -> Mesh<3> {
    Mesh::sheet([0.0, 1.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 0.0, 0.8]], cells).unwrap()
}
fn once() -> Options {
    Options { states: 1, ..Options::default() }
}

#[test]
fn curves_are_the_gradient_of_their_energy() {
    let damped = [
        values!(finite_difference, youngs_modulus: 5e4, thickness: 0.05, damping: 0.01),
        values!(finite_difference, youngs_modulus: 1e4, thickness: 0.1),
    ];
    let ring = |n| Mesh::ring(0.5, n, [0.2, 2.0], 0.1).unwrap();
    conformance("ring", &FiniteDifference, &damped, &ring(36), &Options::default()).assert();
    conformance("ring of three", &FiniteDifference, &damped, &ring(3), &Options::default()).assert();
    conformance("inside out", &FiniteDifference, &damped, &ring(36), &Options { mirrored: true, ..once() }).assert();
    conformance("chain", &FiniteDifference, &damped, &chain::<2>(), &Options::default()).assert();
    conformance("bent chain in space", &FiniteDifference, &damped, &chain::<3>(), &Options::default()).assert();
    let line = Mesh::<3>::line([0.0; 3], [1.0, 0.3, 0.2], 12).unwrap();
    conformance("line in space", &FiniteDifference, &damped, &line, &Options::default()).assert();
    let large = Options { states: 1, derivatives: false, ..Options::default() };
    conformance("long ring", &FiniteDifference, &damped, &ring(1700), &large).assert();
}

/// A helix of radius r and slope c, whose curvature is r/(r² + c²) and whose torsion is c/(r² + c²) [1/m].
#[allow(clippy::disallowed_methods, reason = "the reference")]
fn helix(count: u32, radius: f64, slope: f64) -> Vec<[f64; 3]> {
    let whole = 1.0 / (radius * radius + slope * slope).sqrt();
    let at = |k: u32| {
        let t = 6.0 * f64::from(k) / f64::from(count - 1) * whole;
        [radius * t.cos(), radius * t.sin(), slope * t]
    };
    (0..count).map(at).collect()
}

#[test]
fn curves_with_torsion_are_the_gradient_of_their_energy() {
    let with = [
        values!(finite_difference, youngs_modulus: 5e4, thickness: 0.05, torsion: true, damping: 0.01),
        values!(finite_difference, youngs_modulus: 1e4, thickness: 0.1),
    ];
    let open = Mesh::polyline(&helix(14, 0.5, 0.2), false).unwrap();
    conformance("helix", &FiniteDifference, &with, &open, &Options::default()).assert();
    let closed = Mesh::polyline(&helix(12, 0.5, 0.05), true).unwrap();
    conformance("closed", &FiniteDifference, &with, &closed, &Options::default()).assert();
}

/// A helix deformed into another one with the same length and curvature but another torsion has the energy ½ GJ (τ − τ₀)² L.
#[test]
fn the_energy_of_torsion_has_second_order() {
    let whole = |curvature: f64, torsion: f64| {
        let square = curvature * curvature + torsion * torsion;
        [curvature / square, torsion / square]
    };
    let [rest, moved] = [whole(1.2, 0.5), whole(1.2, 0.9)];
    let error = |count: u32| {
        let mesh = Mesh::polyline(&helix(count, rest[0], rest[1]), false).unwrap();
        let places = helix(count, moved[0], moved[1]);
        let of = |torsion: bool| {
            let values = values!(finite_difference, youngs_modulus: 1e6, thickness: 0.05, torsion: torsion);
            let parts: [Part<3>; 1] = [(&FiniteDifference, values)];
            let mut system = system(&mesh, &parts);
            places.iter().enumerate().for_each(|(node, x)| system.state.x.set(node, *x));
            let member = &system.members[0];
            let energy = member.potential.energy(system.simd, &system.view(Stage::Current, 0.0), &member.scratch);
            energy.iter().sum::<f64>()
        };
        let t2 = 0.05 * 0.05;
        let rigidity = 1e6 * core::f64::consts::PI * t2 * t2 / 64.0 / 1.3;
        // Edges at the ends have no torsion, so the effective curve is shorter by two edges.
        let length = 6.0 * (f64::from(count) - 3.0) / (f64::from(count) - 1.0);
        (of(true) - of(false)) / (0.5 * rigidity * 0.16 * length) - 1.0
    };
    let errors = [error(25), error(49), error(97)];
    assert!(errors[2].abs() < 2e-3, "{errors:?}");
    for pair in errors.windows(2) {
        assert!((pair[0] / pair[1] - 4.0).abs() < 0.3, "{errors:?}");
    }
}

#[test]
fn surfaces_are_the_gradient_of_their_energy() {
    let damped = [
        values!(finite_difference, youngs_modulus: 5e4, thickness: 0.2, damping: 0.01),
        values!(finite_difference, youngs_modulus: 1e4, thickness: 0.3, poissons_ratio: 0.0),
    ];
    conformance("sheet", &FiniteDifference, &damped, &sheet([5, 4]), &Options::default()).assert();
    conformance("one cell", &FiniteDifference, &damped, &sheet([1, 1]), &Options::default()).assert();
    conformance("strip", &FiniteDifference, &damped, &sheet([1, 6]), &Options::default()).assert();
    let large = Options { states: 1, derivatives: false, ..Options::default() };
    conformance("large", &FiniteDifference, &damped, &sheet([37, 41]), &large).assert();
}

#[test]
fn solids_are_the_gradient_of_their_energy() {
    let damped = [
        values!(finite_difference, youngs_modulus: 5e4, damping: 0.01),
        values!(finite_difference, youngs_modulus: 1e4, poissons_ratio: 0.45),
    ];
    let stress = [values!(finite_difference, youngs_modulus: 5e4, plane: "stress")];
    let plate = Mesh::<2>::grid([0.0, 1.0], [1.0, 0.6], [5, 3]).unwrap();
    let block = Mesh::<3>::grid([0.0; 3], [1.0, 0.8, 0.6], [3, 2, 2]).unwrap();
    conformance("plate", &FiniteDifference, &damped, &plate, &Options::default()).assert();
    conformance("plane stress", &FiniteDifference, &stress, &plate, &Options::default()).assert();
    conformance("block", &FiniteDifference, &damped, &block, &Options::default()).assert();
    conformance("inside out", &FiniteDifference, &damped, &block, &Options { mirrored: true, ..once() }).assert();
}

/// The energy of a body [J] with moved nodes.
fn energy<const D: usize>(mesh: &Mesh<D>, values: Values, moved: impl Fn([f64; D]) -> [f64; D]) -> f64 {
    let parts: [Part<D>; 1] = [(&FiniteDifference, values)];
    let mut system = system(mesh, &parts);
    for (node, x) in mesh.positions.iter().enumerate() {
        system.state.x.set(node, moved(*x));
    }
    let member = &system.members[0];
    member.potential.energy(system.simd, &system.view(Stage::Current, 0.0), &member.scratch).iter().sum()
}

/// λ/2 (tr E)² + μ E:E with Green's strain of F.
fn st_venant_kirchhoff<const D: usize>(f: [[f64; D]; D], [lambda, mu]: [f64; 2]) -> f64 {
    let (mut trace, mut square) = (0.0, 0.0);
    for i in 0..D {
        for j in 0..D {
            let c: f64 = (0..D).map(|k| f[k][i] * f[k][j]).sum();
            let strain = 0.5 * (c - f64::from(u8::from(i == j)));
            trace += if i == j { strain } else { 0.0 };
            square += strain * strain;
        }
    }
    0.5 * lambda * trace * trace + mu * square
}

fn lame(e: f64, nu: f64) -> [f64; 2] {
    [e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), e / (2.0 * (1.0 + nu))]
}

fn affine<const D: usize>(f: [[f64; D]; D]) -> impl Fn([f64; D]) -> [f64; D] {
    move |x| core::array::from_fn(|i| 0.3 + (0..D).map(|j| f[i][j] * x[j]).sum::<f64>())
}

#[test]
fn solids_under_affine_motion_have_the_energy_of_st_venant_and_kirchhoff() {
    let [lambda, mu] = lame(7e4, 0.28);
    let plate = Mesh::<2>::grid([0.0, 1.0], [1.0, 0.6], [5, 3]).unwrap();
    let f = [[1.2, 0.3], [-0.1, 0.9]];
    let of = |values| energy(&plate, values, affine(f)) / 0.6;
    let strain = values!(finite_difference, youngs_modulus: 7e4, poissons_ratio: 0.28);
    let expected = st_venant_kirchhoff(f, [lambda, mu]);
    assert!((of(strain) / expected - 1.0).abs() < 1e-13);
    let stress = values!(finite_difference, youngs_modulus: 7e4, poissons_ratio: 0.28, plane: "stress");
    let expected = st_venant_kirchhoff(f, [2.0 * lambda * mu / (lambda + 2.0 * mu), mu]);
    assert!((of(stress) / expected - 1.0).abs() < 1e-13);

    let block = Mesh::<3>::grid([0.0; 3], [1.0, 0.8, 0.6], [3, 2, 4]).unwrap();
    let f = [[1.1, 0.2, -0.1], [0.05, 0.8, 0.3], [-0.2, 0.1, 1.3]];
    let values = values!(finite_difference, youngs_modulus: 7e4, poissons_ratio: 0.28);
    let found = energy(&block, values, affine(f)) / 0.48;
    assert!((found / st_venant_kirchhoff(f, [lambda, mu]) - 1.0).abs() < 1e-13);
}

/// The order of convergence: the power of the spacing with which an error falls from one mesh to another that is twice as fine.
fn order(errors: [f64; 2]) -> f64 {
    Lane::ln((errors[0] / errors[1]).abs()) / Lane::ln(2.0_f64)
}

#[test]
fn sheets_bend_and_twist_as_plates() {
    let (e, t, nu) = (2e6, 0.01, 0.3);
    let rigidity = e * t * t * t / (12.0 * (1.0 - nu * nu));
    let sheet = |n| Mesh::sheet([0.0; 3], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [n, n]).unwrap();
    let of = |n, nu: f64, moved: &dyn Fn([f64; 3]) -> [f64; 3]| {
        energy(&sheet(n), values!(finite_difference, youngs_modulus: e, thickness: t, poissons_ratio: nu), moved)
    };
    // A saddle z = c x y twists without bending: ½ D 2 (1 − ν) c² A, and membrane strains of fourth order in c.
    let c = 1e-4;
    let twisted = of(8, nu, &|[x, y, _]| [x, y, c * x * y]);
    let expected = rigidity * (1.0 - nu) * c * c;
    assert!((twisted / expected - 1.0).abs() < 1e-3, "{twisted} {expected}");
    // Rolled into a cylinder with constant chords: each cell turns by the same angle. Without lateral coupling every row has ½ D
    // κ² times its area, the first and last columns of nodes none.
    let rolled = |n: u32| {
        let h = 1.0 / f64::from(n);
        let turn = 0.4 * h;
        #[allow(clippy::disallowed_methods, reason = "the reference")]
        let moved = move |[x, y, _]: [f64; 3]| {
            // The corners of a polygon with sides h whose directions change by `turn` from one to the next.
            let k = (x / h).round();
            let (radius, angle) = (0.5 * h / (0.5 * turn).sin(), k * turn);
            [radius * angle.sin(), y, radius * (1.0 - angle.cos())]
        };
        let rigidity = e * t * t * t / 12.0;
        let inner = f64::from(n - 1) / f64::from(n);
        of(n, 0.0, &moved) / (0.5 * rigidity * 0.16 * inner) - 1.0
    };
    let errors = [rolled(8), rolled(16)];
    let order = order(errors);
    assert!(errors[1].abs() < 1e-3 && (order - 2.0).abs() < 0.1, "{errors:?}, order {order}");
}

#[test]
fn rings_and_wires_have_no_energy_at_rest_and_that_of_their_curvature_when_bent() {
    let (e, t, depth) = (1e6, 0.02, 1.0);
    let inertia = t * t * t / 12.0 * depth;
    // A straight line bent to an arc of a polygon with sides h: B = 2 sin(φ/2) · cos(φ/2)/(h cos(φ/2)).
    let bent = |n: u32| {
        let h = 1.0 / f64::from(n);
        let turn = 1.5 * h;
        #[allow(clippy::disallowed_methods, reason = "the reference")]
        let moved = move |[x, _]: [f64; 2]| {
            let (radius, angle) = (0.5 * h / (0.5 * turn).sin(), (x / h).round() * turn);
            [radius * angle.sin(), radius * (1.0 - angle.cos())]
        };
        let line = Mesh::<2>::line([0.0, 0.0], [1.0, 0.0], n).unwrap();
        let found = energy(&line, values!(finite_difference, youngs_modulus: e, thickness: t), moved);
        found / (0.5 * e * inertia * 2.25 * f64::from(n - 1) / f64::from(n)) - 1.0
    };
    let errors = [bent(10), bent(20)];
    let order = order(errors);
    assert!(errors[1].abs() < 1e-3 && (order - 2.0).abs() < 0.1, "{errors:?}, order {order}");
    let ring = Mesh::ring(0.5, 24, [0.0, 0.0], 0.0).unwrap();
    let rest = energy(&ring, values!(finite_difference, youngs_modulus: e, thickness: t), |x| x);
    assert!(rest.abs() < 1e-20, "{rest}");
}

/// The code with which a body is refused.
fn refused<const D: usize>(mesh: &Mesh<D>, values: &Values) -> Option<String> {
    let mass = Parameter::uniform(1.0);
    let ingredients = Ingredients {
        mesh,
        layout: Layout::Single,
        values: &[values],
        mass: &mass,
        densities: None,
        thickness: 1.0,
        gravity: [0.0; D],
        step: 1e-3,
        break_off: &Default::default(),
    };
    FiniteDifference.build(&ingredients).err().map(|error| error.code().to_string())
}

#[test]
fn bodies_that_are_no_regular_grid_are_refused() {
    let curve = values!(finite_difference, youngs_modulus: 1e5, thickness: 0.02);
    let solid = values!(finite_difference, youngs_modulus: 1e5);
    let code = |text: &str| Some(format!("model.{text}"));
    assert_eq!(refused(&Mesh::icosphere(0.5, 1).unwrap(), &curve), code("not_a_grid"));
    let mut triangles = Mesh::<2>::grid([0.0; 2], [1.0, 1.0], [2, 2]).unwrap();
    triangles = triangles.into_simplices().unwrap();
    assert_eq!(refused(&triangles, &solid), code("not_a_grid"));
    let mut branching = Mesh::<3>::line([0.0; 3], [1.0, 0.0, 0.0], 4).unwrap();
    branching.wires.push([1, 4]);
    assert_eq!(refused(&branching, &curve), code("not_a_grid"));
    let skewed = Mesh::sheet([0.0; 3], [[1.0, 0.0, 0.0], [0.5, 1.0, 0.0]], [3, 3]).unwrap();
    assert_eq!(refused(&skewed, &curve), code("not_rectangular"));
    let mut moved = Mesh::<2>::grid([0.0; 2], [1.0, 1.0], [2, 2]).unwrap();
    moved.positions[4] = [0.6, 0.5];
    assert_eq!(refused(&moved, &solid), code("not_rectangular"));
    let mut uneven = Mesh::sheet([0.0; 3], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [2, 1]).unwrap();
    for node in [1, 4] {
        uneven.positions[node][0] = 0.4;
    }
    assert_eq!(refused(&uneven, &curve), code("uneven_grid"));
    let line = Mesh::<2>::line([0.0; 2], [1.0, 0.0], 4).unwrap();
    assert_eq!(refused(&line, &solid), code("no_thickness"));
    assert_eq!(refused(&Mesh::<2>::grid([0.0; 2], [1.0, 1.0], [2, 2]).unwrap(), &curve), code("solid_thickness"));
    assert_eq!(refused(&line, &curve), None);
    let torsion = values!(finite_difference, youngs_modulus: 1e5, thickness: 0.02, torsion: true);
    let straight = Mesh::<3>::line([0.0; 3], [1.0, 0.3, 0.2], 4).unwrap();
    assert_eq!(refused(&straight, &torsion), code("no_torsion"));
    assert_eq!(refused(&sheet([2, 2]), &torsion), code("torsion_of_surface"));
}

/// Under an affine motion, stress and volume ratio equal those of finite elements with the same law.
#[test]
fn cells_under_affine_motion_have_the_stress_of_finite_elements() {
    fn compare<const D: usize>(mesh: &Mesh<D>, f: [[f64; D]; D], plane: Option<&str>, element: &dyn Model<D>) {
        let mut differences = values!(finite_difference, youngs_modulus: 1e5, poissons_ratio: 0.3);
        let mut elements = values!(fem, material: "st_venant_kirchhoff", youngs_modulus: 1e5, poissons_ratio: 0.3);
        if let Some(plane) = plane {
            differences = values!(finite_difference, youngs_modulus: 1e5, poissons_ratio: 0.3, plane: plane);
            elements =
                values!(fem, material: "st_venant_kirchhoff", youngs_modulus: 1e5, poissons_ratio: 0.3, plane: plane);
        }
        let states = |model: &dyn Model<D>, values: Values| {
            let parts: [Part<D>; 1] = [(model, values)];
            let mut system = system(mesh, &parts);
            let moved = affine(f);
            mesh.positions.iter().enumerate().for_each(|(node, x)| system.state.x.set(node, moved(*x)));
            system.members[0].potential.cell_states(&system.view(Stage::Current, 0.0), 0)
        };
        let (ours, theirs) = (states(&FiniteDifference, differences), states(element, elements));
        assert_eq!(ours.len(), theirs.len());
        for (a, b) in ours.iter().zip(&theirs) {
            assert!(
                (a.volume_ratio - b.volume_ratio).abs() < 1e-12 && (a.measure - b.measure).abs() < 1e-12,
                "{a:?} {b:?}"
            );
            assert!((a.smallest_volume_ratio - b.smallest_volume_ratio).abs() < 1e-12, "{a:?} {b:?}");
            let off = a.stress.iter().flatten().zip(b.stress.iter().flatten()).map(|(a, b)| (a - b).abs());
            assert!(off.fold(0.0, Lane::larger) < 1e-7, "{a:?} {b:?}");
        }
    }
    let plate = Mesh::<2>::grid([0.0, 1.0], [1.0, 0.6], [5, 3]).unwrap();
    let block = Mesh::<3>::grid([0.0; 3], [1.0, 0.8, 0.6], [3, 2, 2]).unwrap();
    let flat = [[1.1, 0.2], [-0.1, 0.9]];
    compare(&plate, flat, Some("strain"), &crate::support::models::Fem);
    compare(&plate, flat, Some("stress"), &crate::support::models::Fem);
    let f = [[1.1, 0.2, 0.1], [-0.1, 0.9, 0.05], [0.0, 0.1, 1.2]];
    compare(&block, f, None, &crate::support::models::Fem);
}

/// The energies of a body in two states, displaced along an axis by up to 1e-3 of a cell: first with neighbouring nodes in
/// opposite directions, then in a wave as long as the body.
#[allow(clippy::disallowed_methods, reason = "the start of a test")]
fn energies<const D: usize>(mesh: &Mesh<D>, thin: bool, axis: usize) -> [f64; 2] {
    const CELL: f64 = 0.2;
    let solid = values!(finite_difference, youngs_modulus: 1e4);
    let values = if thin { values!(finite_difference, youngs_modulus: 1e4, thickness: 0.05) } else { solid };
    let parts: [Part<D>; 1] = [(&FiniteDifference, values)];
    [true, false].map(|checkerboard| {
        let mut body = system(mesh, &parts);
        for (node, at) in mesh.positions.iter().enumerate() {
            let mut x = *at;
            let number: f64 = at.iter().map(|x| (x / CELL).round()).sum();
            let wave = |along: f64| (std::f64::consts::PI * along).cos();
            x[axis] += 1e-3 * CELL * if checkerboard { wave(number) } else { wave(at.iter().sum()) };
            body.state.x.set(node, x);
        }
        crate::support::energy(&mut body)
    })
}

/// Staggered differences detect modes that differences over two cells cannot detect.
#[test]
fn a_checkerboard_takes_more_energy_than_a_long_wave() {
    let solid = Mesh::<3>::grid([0.0; 3], [1.0, 0.8, 0.6], [5, 4, 3]).unwrap();
    let plate = Mesh::<2>::grid([0.0; 2], [1.0, 0.8], [5, 4]).unwrap();
    let cloth = Mesh::sheet([0.0; 3], [[1.0, 0.0, 0.0], [0.0, 0.8, 0.0]], [5, 4]).unwrap();
    let line = Mesh::<2>::line([0.0; 2], [1.0, 0.0], 5).unwrap();
    let mut all: Vec<(&str, usize, [f64; 2])> = Vec::new();
    all.extend((0..3).map(|axis| ("solid", axis, energies(&solid, false, axis))));
    all.extend((0..2).map(|axis| ("solid of the plane", axis, energies(&plate, false, axis))));
    all.extend((0..3).map(|axis| ("sheet", axis, energies(&cloth, true, axis))));
    all.extend((0..2).map(|axis| ("curve", axis, energies(&line, true, axis))));
    for (name, axis, [checkerboard, wave]) in all {
        assert!(checkerboard > 5.0 * wave, "{name} along {axis}: {checkerboard} J, {wave} J");
    }
}
