//! Finite elements against exact results: patches, uniaxial stress, linear elasticity.

use crate::support;

use crate::support::models::Fem;
use opruga_core::potential::{CellState, Model, Potential};
use opruga_core::spec::{Value, Values};
use opruga_core::system::{Stage, System};
use opruga_mesh::Mesh;
use opruga_models::fem::SPEC;
use opruga_models::materials::NAMES;
use support::{eigenvalues_below, forces, hessian, newton, refusal, system};

fn irregular<const D: usize>(cells: [u32; D]) -> Mesh<D> {
    let mut mesh = Mesh::grid([0.0; D], core::array::from_fn(|d| 0.5 * f64::from(cells[d])), cells).unwrap();
    let mut random = 11u64;
    for x in &mut mesh.positions {
        for c in x.iter_mut() {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            *c += 0.12 * ((random >> 11) as f64 / (1u64 << 53) as f64 - 0.5);
        }
    }
    mesh
}

fn kinds<const D: usize>(boxes: Mesh<D>) -> [(&'static str, Mesh<D>); 3] {
    let simplices = boxes.clone().into_simplices().unwrap();
    let quadratic = simplices.clone().into_quadratic().unwrap();
    [("boxes", boxes), ("simplices", simplices), ("quadratic", quadratic)]
}

fn solid<const D: usize>(mesh: &Mesh<D>, values: Values) -> System<D>
where
    Fem: Model<D>,
{
    system(mesh, &[(&Fem, values)])
}

fn largest(numbers: impl IntoIterator<Item = f64>) -> f64 {
    numbers.into_iter().fold(0.0, |m, x| if x.abs() > m { x.abs() } else { m })
}

fn move_all<const D: usize>(system: &mut System<D>, to: impl Fn(&[f64; D]) -> [f64; D]) {
    for node in 0..system.nodes {
        let x = system.state.x.at(node);
        system.state.x.set(node, to(&x));
    }
}

/// The rest shape has no stress, and only rigid motion has zero energy there.
fn rest<const D: usize>(cells: [u32; D])
where
    Fem: opruga_core::potential::Model<D>,
{
    let rigid = D * (D + 1) / 2;
    for material in NAMES {
        for (kind, mesh) in kinds(irregular(cells)) {
            let mut system = solid(&mesh, values!(fem, material: *material, youngs_modulus: 1e5, poissons_ratio: 0.4));
            assert!(largest(forces(&mut system)) < 1e-9, "{material}, {kind}: {:e}", largest(forces(&mut system)));
            let matrix = hessian(&mut system);
            let scale = largest(matrix.entries.iter().copied());
            assert_eq!(eigenvalues_below(&mut system, 1e-9 * scale), rigid, "{material}, {kind}");
            assert_eq!(eigenvalues_below(&mut system, -1e-9 * scale), 0, "{material}, {kind}");
        }
    }
}

#[test]
fn bodies_at_rest_in_the_plane_have_no_stress_and_three_free_motions() {
    rest([2, 2]);
}

#[test]
fn bodies_at_rest_in_space_have_no_stress_and_six_free_motions() {
    rest([1, 1, 2]);
}

/// At rest every law is Hooke's law with the same E and ν.
fn small_strain<const D: usize>(cells: [u32; D], plane: &str)
where
    Fem: opruga_core::potential::Model<D>,
{
    for (kind, mesh) in kinds(irregular(cells)) {
        for ratio in [-0.3, 0.0, 0.25, 0.45] {
            let of = |material: &str| {
                let values = values!(fem, material: material, youngs_modulus: 2.0, poissons_ratio: ratio, plane: plane, mooney_share: 0.0);
                hessian(&mut solid(&mesh, values)).entries
            };
            let hooke = of("linear");
            let scale = largest(hooke.iter().copied());
            // The Mooney–Rivlin solid is refused if it would not be convex.
            for material in NAMES.iter().filter(|m| ratio >= 0.0 || **m != "mooney_rivlin") {
                let difference = largest(of(material).iter().zip(&hooke).map(|(a, b)| a - b));
                assert!(difference < 1e-10 * scale, "{material}, {kind}, ν = {ratio}: {difference:e} of {scale:e}");
            }
        }
        // Mooney–Rivlin with both constants.
        let of = |material: &str| {
            let values = values!(fem, material: material, youngs_modulus: 2.0, poissons_ratio: 0.4, plane: plane, mooney_share: 0.7);
            hessian(&mut solid(&mesh, values)).entries
        };
        let (hooke, mooney) = (of("linear"), of("mooney_rivlin"));
        let difference = largest(mooney.iter().zip(&hooke).map(|(a, b)| a - b));
        assert!(difference < 1e-10 * largest(hooke), "{kind}: {difference:e}");
    }
}

#[test]
fn young_and_poisson_mean_at_small_strain_what_they_say() {
    small_strain([2, 1], "strain");
    small_strain([2, 1], "stress");
    small_strain([1, 1, 1], "strain");
}

/// Affine motion of an irregular patch: inner nodes are in equilibrium, and they find it if only the boundary is moved.
fn patch<const D: usize>(cells: [u32; D])
where
    Fem: opruga_core::potential::Model<D>,
{
    let gradient: [[f64; D]; D] = core::array::from_fn(|i| {
        core::array::from_fn(|j| f64::from(u8::from(i == j)) + 0.05 * [0.9, -0.4, 0.7, 0.3, -0.6][(2 * i + 3 * j) % 5])
    });
    let affine = |x: &[f64; D]| -> [f64; D] {
        core::array::from_fn(|i| 0.3 + (0..D).map(|j| gradient[i][j] * x[j]).sum::<f64>())
    };
    for material in NAMES {
        for (kind, mesh) in kinds(irregular(cells)) {
            let boundary: Vec<bool> = (0..mesh.positions.len() as u32)
                .map(|node| mesh.facets.iter().any(|facet| facet.contains(&node)))
                .collect();
            assert!(boundary.iter().any(|on| !on), "{kind}: the patch has inner nodes");
            let mut system = solid(&mesh, values!(fem, material: *material, youngs_modulus: 1.0, poissons_ratio: 0.4));
            move_all(&mut system, affine);
            let all = forces(&mut system);
            let inner = (0..all.len()).filter(|k| !boundary[k / D]).map(|k| all[k]);
            assert!(largest(inner) < 1e-12 * largest(all.iter().copied()), "{material}, {kind}");

            // From a start that deviates by a fraction of a cell.
            let mut state = 1u64;
            for node in 0..system.nodes {
                if !boundary[node] {
                    let x = system.state.x.at(node);
                    let off = x.map(|c| {
                        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                        c + 0.02 * ((state >> 40) as f64 / (1u64 << 24) as f64 - 0.5)
                    });
                    system.state.x.set(node, off);
                }
            }
            let held: Vec<usize> = (0..all.len()).filter(|k| boundary[k / D]).collect();
            newton(&mut system, &vec![0.0; all.len()], &held, 0.0);
            for (node, rest) in mesh.positions.iter().enumerate() {
                let (x, expected) = (system.state.x.at(node), affine(rest));
                for d in 0..D {
                    assert!((x[d] - expected[d]).abs() < 1e-12, "{material}, {kind}: {x:?} {expected:?}");
                }
            }
        }
    }
}

/// If nodes resist changes of volume, uniform motion stays uniform, with the stress of Hooke's law at small strain.
#[test]
fn volumes_of_nodes_leave_even_motion_even() {
    let mesh = irregular([3, 3, 3]).into_simplices().unwrap();
    let inner = |node: usize| !mesh.facets.iter().any(|facet| facet.contains(&(node as u32)));
    for material in NAMES {
        let values =
            values!(fem, material: *material, youngs_modulus: 3.0, poissons_ratio: 0.49, locking: "nodal_volume");
        let mut system = solid(&mesh, values);
        assert!(largest(forces(&mut system)) < 1e-12, "{material}");
        move_all(&mut system, |x| [x[0] + 2e-6 * x[0] + 1e-6 * x[1], x[1] - 1e-6 * x[1], x[2]]);
        let all = forces(&mut system);
        let between = (0..all.len()).filter(|k| inner(k / 3)).map(|k| all[k]);
        // Positions keep ten digits of the displacements under a strain of 1e-6.
        assert!(largest(between) < 1e-8 * largest(all.iter().copied()), "{material}");
        let view = system.view(Stage::Current, 0.0);
        let potential: &dyn Potential<3> = &*system.members[0].potential;
        for state in potential.cell_states(&view, 0) {
            // λ tr ε + 2με with μ = 3/2.98 and λ = 49 μ.
            let (mu, swollen) = (3.0 / 2.98, 1e-6);
            let expected = 49.0 * mu * swollen + 2.0 * mu * 2e-6;
            assert!((state.stress[0][0] / expected - 1.0).abs() < 1e-3, "{material}: {state:?} {expected:e}");
        }
    }
}

#[test]
fn affine_motion_of_an_irregular_patch_is_exact_in_the_plane() {
    patch([3, 3]);
}

#[test]
fn affine_motion_of_an_irregular_patch_is_exact_in_space() {
    patch([2, 2, 2]);
}

/// A unit cube, or a thin unit plate, pulled along x between frictionless plates: lateral stretch and first Piola–Kirchhoff
/// stress.
fn uniaxial<const D: usize>(mesh: &Mesh<D>, values: Values, stretch: f64) -> (f64, f64, CellState)
where
    Fem: Model<D>,
{
    let mut system = solid(mesh, values);
    let side = 1.0 / stretch.sqrt();
    move_all(&mut system, |x| core::array::from_fn(|d| if d == 0 { stretch * x[0] } else { side * x[d] }));
    let mut held = Vec::new();
    for (node, x) in mesh.positions.iter().enumerate() {
        for d in 0..D {
            if x[d] == 0.0 || (d == 0 && x[d] == 1.0) {
                held.push(node * D + d);
            }
        }
    }
    let residual = newton(&mut system, &vec![0.0; mesh.positions.len() * D], &held, 0.0);
    assert!(residual < 1e-6, "{residual:e}");
    let all = forces(&mut system);
    let pull: f64 = mesh.positions.iter().enumerate().filter(|(_, x)| x[0] == 1.0).map(|(n, _)| -all[D * n]).sum();
    let corner = mesh.positions.iter().position(|x| *x == [1.0; D]).unwrap();
    let lateral = system.state.x.at(corner)[1];
    let view = system.view(Stage::Current, 0.0);
    let potential: &dyn Potential<D> = &*system.members[0].potential;
    let state = potential.cell_states(&view, 0)[0];
    (lateral, pull, state)
}

/// Stretch, lateral stretch and stress for E = 1e5 Pa, ν = 0.45: roots of the equations of the laws.
type Row = (f64, f64, f64);
const NEO_HOOKEAN: &[Row] = &[
    (0.5, 1.350870, -108_610.28),
    (0.8, 1.104462, -24_992.97),
    (1.2, 0.920634, 17_023.92),
    (1.5, 0.830679, 35_861.44),
    (2.0, 0.725935, 59_879.63),
    (3.0, 0.598315, 99_333.56),
];
const STABLE_NEO_HOOKEAN: &[Row] = &[
    (0.5, 1.331937, -110_935.10),
    (0.8, 1.103291, -25_033.20),
    (1.2, 0.920162, 17_232.32),
    (1.5, 0.828994, 37_542.79),
    (2.0, 0.722881, 66_717.12),
    (3.0, 0.594620, 120_136.23),
];
const ST_VENANT_KIRCHHOFF: &[Row] = &[(0.8, 1.077961, -14_400.0), (1.2, 0.895545, 26_400.0), (1.5, 0.661438, 93_750.0)];

#[test]
fn uniaxial_stress_follows_the_laws() {
    let boxes = Mesh::<3>::grid([0.0; 3], [1.0; 3], [1, 1, 1]).unwrap();
    for (kind, mesh) in kinds(boxes) {
        uniaxial_table(kind, &mesh, &|values| values);
    }
    // A plate with free thickness has the stress, the volume and the stretch of a body in space.
    for (kind, mesh) in kinds(Mesh::<2>::grid([0.0; 2], [1.0; 2], [1, 1]).unwrap()) {
        uniaxial_table(kind, &mesh, &|mut values| {
            values.set(&SPEC, "plane", Value::Text("stress".into()), 2).unwrap();
            values
        });
    }
}

fn uniaxial_table<const D: usize>(kind: &str, mesh: &Mesh<D>, finish: &dyn Fn(Values) -> Values)
where
    Fem: Model<D>,
{
    for (material, rows) in [
        ("neo_hookean", NEO_HOOKEAN),
        ("stable_neo_hookean", STABLE_NEO_HOOKEAN),
        ("st_venant_kirchhoff", ST_VENANT_KIRCHHOFF),
    ] {
        for &(stretch, lateral, stress) in rows {
            let values = values!(fem, material: material, youngs_modulus: 1e5, poissons_ratio: 0.45);
            let (side, pull, state) = uniaxial(mesh, finish(values), stretch);
            assert!((side - lateral).abs() < 1e-6, "{material}, {kind}, {stretch}: {side} {lateral}");
            assert!((pull - stress).abs() < 6e-3, "{material}, {kind}, {stretch}: {pull} {stress}");
            // The Cauchy stress is the force over the present area, and acts only along x.
            let cauchy = pull / (side * side);
            assert!((state.stress[0][0] / cauchy - 1.0).abs() < 1e-9, "{state:?} {cauchy}");
            assert!((state.von_mises() / cauchy.abs() - 1.0).abs() < 1e-9 && state.stress[1][1].abs() < 1e-4);
            assert!((state.volume_ratio - stretch * side * side).abs() < 1e-9);
        }
    }
}

/// Corotated boxes stay uniform when they are stretched to three times their length and their sides shrink to a tenth.
#[test]
fn a_long_drawn_box_stays_even() {
    let mesh = Mesh::<3>::grid([0.0; 3], [1.0; 3], [1, 1, 1]).unwrap();
    for stretch in [1.5, 3.0] {
        let values = values!(fem, material: "corotated", youngs_modulus: 1e5, poissons_ratio: 0.45);
        let (side, pull, _) = uniaxial(&mesh, values, stretch);
        assert!((side - (1.0 - 0.45 * (stretch - 1.0))).abs() < 1e-9, "{stretch}: {side}");
        assert!((pull / (1e5 * (stretch - 1.0)) - 1.0).abs() < 1e-9, "{stretch}: {pull}");
    }
}

/// At small strain the stress is Eε and the lateral strain is −νε, in plane stress too.
#[test]
fn a_bar_in_plane_stress_has_the_modulus_of_youngs() {
    for (kind, mesh) in kinds(Mesh::<2>::grid([0.0; 2], [2.0, 1.0], [2, 1]).unwrap()) {
        for material in NAMES {
            let values = values!(fem, material: *material, youngs_modulus: 3.0, poissons_ratio: 0.4, plane: "stress");
            let mut system = solid(&mesh, values);
            let strain = 1e-6;
            move_all(&mut system, |x| [(1.0 + strain) * x[0], (1.0 - 0.4 * strain) * x[1]]);
            let all = forces(&mut system);
            let end = mesh.positions.iter().enumerate().filter(|(_, x)| x[0] == 2.0);
            let pull: f64 = end.map(|(n, _)| -all[2 * n]).sum();
            assert!((pull / (3.0 * strain) - 1.0).abs() < 1e-5, "{material}, {kind}: {pull:e}");
            assert!(largest(all.iter().skip(1).step_by(2).copied()) < 1e-5 * strain, "{material}, {kind}");
        }
    }
}

/// If nothing moves across the plane, the stress across it is ν (σ₁ + σ₂) at small strain.
#[test]
fn plane_strain_has_a_stress_across_the_plane() {
    let mesh = Mesh::<2>::grid([0.0; 2], [1.0, 1.0], [2, 2]).unwrap();
    for material in NAMES {
        let values = values!(fem, material: *material, youngs_modulus: 3.0, poissons_ratio: 0.4);
        let mut system = solid(&mesh, values);
        move_all(&mut system, |x| [x[0] + 2e-6 * x[0] + 1e-6 * x[1], x[1] - 1e-6 * x[1]]);
        let view = system.view(Stage::Current, 0.0);
        let potential: &dyn Potential<2> = &*system.members[0].potential;
        let states = potential.cell_states(&view, 0);
        assert_eq!(states.len(), 4);
        for state in states {
            let s = &state.stress;
            let across = 0.4 * (s[0][0] + s[1][1]);
            assert!(across != 0.0 && (s[2][2] / across - 1.0).abs() < 1e-4, "{material}: {s:?}");
            assert!((s[0][1] - 3.0 / 2.8 * 1e-6).abs() < 1e-10, "{material}: {s:?}");
        }
    }
}

/// The law in the plane is the law in space with the stretch 1 along z: the force of a slice is proportional to its depth.
#[test]
fn a_slice_of_a_long_body_is_the_body() {
    let plane = Mesh::<2>::grid([0.0; 2], [1.0, 0.6], [3, 2]).unwrap();
    let space = Mesh::<3>::grid([0.0; 3], [1.0, 0.6, 1.0], [3, 2, 1]).unwrap();
    for material in NAMES {
        let values = || values!(fem, material: *material, youngs_modulus: 50.0, poissons_ratio: 0.45);
        for bend in [0.0, 0.2] {
            let (mut flat, mut solid_body) = (solid(&plane, values()), solid(&space, values()));
            let moved = |x: f64, y: f64| [x + 0.1 * x * x + bend * y * x, y - 0.15 * x * x + 0.1 * y];
            move_all(&mut flat, |x| moved(x[0], x[1]));
            move_all(&mut solid_body, |x| {
                let [a, b] = moved(x[0], x[1]);
                [a, b, x[2]]
            });
            let (flat, of_space) = (forces(&mut flat), forces(&mut solid_body));
            let (layer, scale) = (plane.positions.len(), largest(flat.iter().copied()));
            for node in 0..layer {
                for d in 0..2 {
                    // Each of the two layers of the slice carries half of it.
                    let sum = of_space[3 * node + d] + of_space[3 * (node + layer) + d];
                    let own = flat[2 * node + d];
                    assert!((own - sum).abs() < 1e-10 * scale, "{material}, {bend}: {own} {sum}");
                }
            }
        }
    }
}

/// The power of damping at rest under a uniform strain rate is τ V (2μ ε̇:ε̇ + λ tr² ε̇).
#[test]
fn damping_is_that_of_kelvin_and_voigt() {
    for (kind, mesh) in kinds(irregular([2, 2, 1])) {
        let volume = mesh.measure().unwrap().value();
        let values = values!(fem, youngs_modulus: 1e3, poissons_ratio: 0.25, damping: 0.01);
        let mut system = solid(&mesh, values);
        for node in 0..system.nodes {
            let x = system.state.x.at(node);
            system.state.v.set(node, [0.3 * x[0] + 0.4 * x[1], 0.1 * x[1], -0.2 * x[2]]);
        }
        let with = system.forces(true).unwrap();
        let work: f64 = (0..system.nodes)
            .map(|n| with.at(n).iter().zip(system.state.v.at(n)).map(|(f, v)| -f * v).sum::<f64>())
            .sum();
        // μ = λ = 400 Pa; ε̇:ε̇ = 0.09 + 0.01 + 0.04 + 2·0.04, tr ε̇ = 0.2.
        let expected = 0.01 * volume * (800.0 * 0.22 + 400.0 * 0.04);
        assert!((work / expected - 1.0).abs() < 1e-10, "{kind}: {work} {expected}");
    }
}

/// A bar of a soft and a stiff material, as groups of cells and as values of cells: the forces are in equilibrium.
#[test]
fn materials_differ_from_cell_to_cell() {
    let mut mesh = Mesh::<2>::grid([0.0; 2], [2.0, 1.0], [2, 1]).unwrap();
    mesh.cell_groups.insert("soft".into(), vec![0]);
    mesh.cell_groups.insert("stiff".into(), vec![1]);
    mesh.cell_values.insert("E".into(), vec![1.0, 3.0]);
    let grouped: Vec<_> = [("soft", 1.0), ("stiff", 3.0)]
        .into_iter()
        .map(|(cells, modulus)| values!(fem, youngs_modulus: modulus, poissons_ratio: 0.0, cells: cells, material: "linear"))
        .map(|values| (&Fem as &dyn opruga_core::potential::Model<2>, values))
        .collect();
    let numbered = values!(fem, youngs_modulus_of_cells: "E", poissons_ratio: 0.0, material: "linear");
    for mut system in [system(&mesh, &grouped), solid(&mesh, numbered)] {
        // In series, the soft half takes three quarters of the stretch.
        move_all(&mut system, |x| [if x[0] == 1.0 { 1.03 } else { 1.02 * x[0] }, x[1]]);
        let all = forces(&mut system);
        for (node, x) in mesh.positions.iter().enumerate() {
            let expected = [0.015, 0.0, -0.015][x[0] as usize];
            assert!((all[2 * node] - expected).abs() < 1e-15, "{all:?}");
        }
    }
}

/// Two adjacent cells with parameters from the mesh have the same forces as the two cells by themselves, in motion too.
#[test]
fn every_number_of_the_material_may_differ_from_cell_to_cell() {
    let mut both = Mesh::<2>::grid([0.0; 2], [2.0, 1.0], [2, 1]).unwrap();
    for (name, numbers) in [("E", [1.0, 3.0]), ("nu", [0.1, 0.4]), ("tau", [0.0, 0.2])] {
        both.cell_values.insert(name.into(), numbers.to_vec());
    }
    let values = || {
        values!(
            fem,
            youngs_modulus_of_cells: "E",
            poissons_ratio_of_cells: "nu",
            damping_of_cells: "tau",
            material: "neo_hookean"
        )
    };
    let shape = |x: [f64; 2]| [1.1 * x[0] + 0.05 * x[0] * x[1], 0.95 * x[1] + 0.02 * x[0] * x[0]];
    let pushed = |mesh: &Mesh<2>, values| {
        let mut system = solid(mesh, values);
        move_all(&mut system, |x| shape(*x));
        forces(&mut system)
    };
    let all = pushed(&both, values());
    let mut sum = vec![0.0; all.len()];
    for (k, (modulus, ratio)) in [(1.0, 0.1), (3.0, 0.4)].into_iter().enumerate() {
        let mesh = Mesh::<2>::grid([k as f64, 0.0], [1.0, 1.0], [1, 1]).unwrap();
        let own = values!(fem, youngs_modulus: modulus, poissons_ratio: ratio, material: "neo_hookean");
        let of_cell = pushed(&mesh, own);
        for (node, x) in mesh.positions.iter().enumerate() {
            let at = both.positions.iter().position(|y| y == x).unwrap();
            (0..2).for_each(|d| sum[2 * at + d] += of_cell[2 * node + d]);
        }
    }
    for (found, expected) in all.iter().zip(&sum) {
        assert!((found - expected).abs() < 1e-14, "{all:?} {sum:?}");
    }
    // A value out of range is refused with cell and range; a missing name is refused with the names that exist.
    both.cell_values.insert("nu".into(), vec![0.1, 0.5]);
    let refused = refusal(&both, &Fem, values());
    assert!(
        refused.contains("`poissons_ratio_of_cells` of cell 1 is 0.5; allowed: a number > -1 and < 0.5"),
        "{refused}"
    );
    both.cell_values.remove("tau");
    let refused = refusal(&both, &Fem, values!(fem, youngs_modulus: 1.0, damping_of_cells: "tau"));
    assert!(
        refused.contains("`damping_of_cells`") && refused.contains("allowed: `E`, `nu`; hint: `damping`"),
        "{refused}"
    );
}

/// St. Venant–Kirchhoff has no thickness without stress across the plane if both sides are stretched strongly.
#[test]
fn plane_stress_without_a_thickness_is_a_refused_step() {
    let mesh = Mesh::<2>::grid([0.0; 2], [1.0, 1.0], [1, 1]).unwrap();
    let values =
        values!(fem, material: "st_venant_kirchhoff", youngs_modulus: 1.0, poissons_ratio: 0.4, plane: "stress");
    let mut system = solid(&mesh, values);
    // t² = 1 − λ/(λ + 2μ) (2 E₁ + 2 E₂) with λ/(λ + 2μ) = 2/3.
    move_all(&mut system, |x| x.map(|c| 1.3 * c));
    system.forces(true).unwrap();
    move_all(&mut system, |x| x.map(|c| c / 1.3 * 1.35));
    let message = system.forces(true).unwrap_err().to_string();
    assert!(message.contains("cell 0") && message.contains("no positive thickness"), "{message}");
}
