//! Boundary elements: refusals, the energy of uniform strains, and stresses.

use crate::support::models::BoundaryElement as Boundary;
use crate::support::{energy, forces, refusal, system};
use opruga_core::spec::{Value, Values};
use opruga_core::system::Stage;
use opruga_mesh::Mesh;

fn ring() -> Mesh<2> {
    Mesh::ring(0.5, 24, [0.2, 2.0], 0.1).unwrap()
}
fn block() -> Mesh<3> {
    Mesh::box_surface([0.1, 0.2, 0.3], [1.0, 0.8, 0.6], [3, 2, 2]).unwrap()
}
/// The forces of a body in a state, and its energy.
fn pulled<const D: usize>(rest: &Mesh<D>, young: f64, map: impl Fn(usize, &[f64; D]) -> [f64; D]) -> (Vec<f64>, f64) {
    let mut body = system(rest, &[(&Boundary, values!(boundary_element, youngs_modulus: young))]);
    for (node, x) in rest.positions.iter().enumerate() {
        body.state.x.set(node, map(node, x));
    }
    (forces(&mut body), energy(&mut body))
}
fn size(v: &[f64]) -> f64 {
    v.iter().fold(0.0, |most, x| if x.abs() > most { x.abs() } else { most })
}

/// Rows 26, 27, 31, 32, 34, 35, 37 and 39 of the list of bad bodies.
#[test]
fn bodies_without_a_surface_are_refused() {
    let plane = |mesh: &Mesh<2>| refusal(mesh, &Boundary, values!(boundary_element, youngs_modulus: 1.0));
    let space = |mesh: &Mesh<3>| refusal(mesh, &Boundary, values!(boundary_element, youngs_modulus: 1.0));
    let starts = |found: String, code: &str| assert!(found.starts_with(code), "{found}");

    starts(plane(&Mesh { positions: vec![[0.0; 2]], ..Mesh::default() }), "model.no_surface");
    starts(plane(&Mesh::line([0.0; 2], [1.0, 0.0], 4).unwrap()), "model.no_surface");
    starts(space(&Mesh::sheet([0.0; 3], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [2, 2]).unwrap()), "model.no_surface");
    starts(space(&Mesh::grid([0.0; 3], [1.0; 3], [2, 2, 2]).unwrap()), "model.inner_nodes");
    let mut open = block();
    open.facets.pop();
    starts(space(&open), "model.open_surface");
    let mut wrong = block();
    wrong.facets[3].swap(0, 1);
    starts(space(&wrong), "model.orientation");
    let mut sliver = block();
    let [a, b, _] = sliver.facets[0];
    sliver.positions[a as usize] = sliver.positions[b as usize];
    starts(space(&sliver), "model.degenerate_facet");
    // A bow.
    let bow = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
    let facets = vec![[0, 1], [1, 2], [2, 3], [3, 0]];
    starts(plane(&Mesh { positions: bow.to_vec(), facets, ..Mesh::default() }), "model.crossing_surface");
    // A third triangle at an edge.
    let mut crowded = block();
    crowded.facets.push(crowded.facets[0]);
    starts(space(&crowded), "model.not_manifold");
    // Two boxes next to each other; a sphere with too many vertices.
    let (mut two, other) = (block(), block());
    let first = two.nodes() as u32;
    two.positions.extend(other.positions.iter().map(|x| [x[0] + 3.0, x[1], x[2]]));
    two.facets.extend(other.facets.iter().map(|facet| facet.map(|node| node + first)));
    starts(space(&two), "model.several_solids");
    let large = space(&Mesh::icosphere(1.0, 4).unwrap());
    assert!(large.starts_with("limit.memory") && large.contains("bytes"), "{large}");
    // An inverted boundary is reversed. A boundary inside another one is a cavity, whatever its orientation.
    let mut inside_out = block();
    inside_out.facets.iter_mut().for_each(|facet| facet.swap(0, 1));
    assert_eq!(space(&inside_out), "built");
    let mut nested = block();
    nested.positions.extend(other.positions.iter().map(|x| x.map(|c| 0.3 + 0.5 * c)));
    nested.facets.extend(other.facets.iter().map(|facet| facet.map(|node| node + first)));
    assert_eq!(space(&nested), "built");
}

/// U of a uniform strain is V σ:ε/2. The body resists expansion; in the frame of least energy it would not.
#[test]
fn uniform_strains_have_their_energy() {
    let nu = 0.3;
    let (mu, lambda) = (1.0 / (2.0 * (1.0 + nu)), nu / ((1.0 + nu) * (1.0 - 2.0 * nu)));
    for strain in [[0.1, 0.1, 0.1], [0.05, -0.02, 0.0], [-0.1, 0.0, 0.03]] {
        let mesh = block();
        let (_, found) = pulled(&mesh, 1.0, |_, x| core::array::from_fn(|d| (1.0 + strain[d]) * x[d]));
        let trace: f64 = strain.iter().sum();
        let squares: f64 = strain.iter().map(|e| e * e).sum();
        let expected = 0.48 * (0.5 * lambda * trace * trace + mu * squares);
        assert!((found / expected - 1.0).abs() < 1e-8, "{found} {expected}");
    }
}

/// Collapsed, mirrored and scattered states have finite forces without a net force or torque.
#[test]
fn degenerate_states_have_finite_forces() {
    let mesh = block();
    type State = fn(usize, &[f64; 3]) -> [f64; 3];
    let states: [State; 6] = [
        |_, x| [x[0], x[1], 0.0],
        |_, x| [x[0], 0.0, 0.0],
        |_, _| [0.0; 3],
        |_, x| [-x[0], x[1], x[2]],
        |node, _| core::array::from_fn(|d| ((node * 37 + d * 11) % 17) as f64 / 17.0),
        |_, x| [10.0 * x[0], x[1], x[2]],
    ];
    for (number, state) in states.into_iter().enumerate() {
        let (found, energy) = pulled(&mesh, 900.0, state);
        assert!(energy.is_finite() && found.iter().all(|f| f.is_finite()), "{number}");
        for d in 0..3 {
            let net: f64 = found.iter().skip(d).step_by(3).sum();
            assert!(net.abs() < 1e-9 * size(&found), "{number}: {net}");
        }
    }
    let ring = ring();
    let (found, _) = pulled(&ring, 900.0, |_, x| [x[0], 0.0]);
    assert!(found.iter().all(|f| f.is_finite()));
}

/// Stresses at points inside, component by component.
fn stresses<const D: usize>(
    mesh: &Mesh<D>,
    fields: Vec<(&str, Value)>,
    points: &[[f64; D]],
    moved: impl Fn(&[f64; D]) -> [f64; D],
) -> Vec<(String, f64)> {
    let spec = &opruga_models::boundary_element::SPEC;
    let mut values = Values::defaults(spec, D);
    let rows = Value::Rows(points.iter().map(|point| point.to_vec()).collect());
    for (name, value) in fields.into_iter().chain([("stress_points", rows)]) {
        values.set(spec, name, value, D).unwrap();
    }
    let mut body = system(mesh, &[(&Boundary, values)]);
    for (node, x) in mesh.positions.iter().enumerate() {
        body.state.x.set(node, moved(x));
    }
    body.forces(false).unwrap();
    let view = body.view(Stage::Current, 0.0);
    let member = &body.members[0];
    let all = member.potential.readings(&view, &member.scratch, &[], 0);
    all.into_iter().filter(|(name, _)| name.starts_with("stress")).map(|(name, x)| (name.into_owned(), x)).collect()
}

/// Under a uniform small strain the stress is λ tr ε 1 + 2μ ε at every point, in the middle and close to a side. In a rotated
/// body, this holds in the frame of the body. In plane stress, 2λμ/(λ + 2μ) replaces λ.
#[test]
fn stresses_of_uniform_strains_are_those_of_hooke() {
    let (young, nu) = (7e4, 0.28);
    let (mu, lambda) = (young / (2.0 * (1.0 + nu)), young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)));
    let moduli = || vec![("youngs_modulus", Value::Number(young)), ("poissons_ratio", Value::Number(nu))];
    let check = |found: &[(String, f64)], expected: &[f64], names: &[&str]| {
        assert_eq!(found.len() % names.len(), 0);
        for (number, (name, value)) in found.iter().enumerate() {
            let (point, component) = (number / names.len(), number % names.len());
            assert_eq!(name, &format!("stress{point}.{}", names[component]));
            let wanted = expected[component];
            assert!((value - wanted).abs() < 1e-5 * young * 1e-6, "{name}: {value} Pa, and not {wanted} Pa");
        }
    };
    // So small that the squares of strains, on which the frame and Hooke's law may differ, are negligible.
    let strain = [[1e-6, 4e-7, -2e-7], [4e-7, -6e-7, 3e-7], [-2e-7, 3e-7, 8e-7]];
    let trace = strain[0][0] + strain[1][1] + strain[2][2];
    let stress = |i: usize, j: usize| 2.0 * mu * strain[i][j] + if i == j { lambda * trace } else { 0.0 };
    let stretched = |x: &[f64; 3]| -> [f64; 3] {
        core::array::from_fn(|i| x[i] + (0..3).map(|j| strain[i][j] * x[j]).sum::<f64>())
    };
    let points = [[0.6, 0.6, 0.6], [0.3, 0.9, 0.4], [0.6, 0.6, 0.88]];
    let expected = [stress(0, 0), stress(1, 1), stress(0, 1), stress(2, 2), stress(0, 2), stress(1, 2)];
    let names = ["xx", "yy", "xy", "zz", "xz", "yz"];
    check(&stresses(&block(), moduli(), &points, stretched), &expected, &names);
    // Rotated by an angle of a triangle with sides 3, 4 and 5, and moved: the stress at a point rotates with the body.
    let turn = |x: [f64; 3]| [0.6 * x[0] - 0.8 * x[1] + 5.0, 0.8 * x[0] + 0.6 * x[1], x[2] - 2.0];
    check(&stresses(&block(), moduli(), &points, |x| turn(stretched(x))), &expected, &names);

    let trace = strain[0][0] + strain[1][1];
    let flat = |x: &[f64; 2]| -> [f64; 2] {
        core::array::from_fn(|i| x[i] + (0..2).map(|j| strain[i][j] * x[j]).sum::<f64>())
    };
    // A square: on a round outline of straight edges tractions are linear, while those of a uniform stress jump from edge to
    // edge.
    let square = Mesh::ring(0.5, 4, [0.2, 2.0], 0.1).unwrap();
    let points = [[0.2, 2.0], [0.3, 2.15]];
    for (plane, lambda) in [("strain", lambda), ("stress", 2.0 * lambda * mu / (lambda + 2.0 * mu))] {
        let mut fields = moduli();
        fields.push(("plane", Value::Text(plane.into())));
        let stress = |i: usize, j: usize| 2.0 * mu * strain[i][j] + if i == j { lambda * trace } else { 0.0 };
        check(
            &stresses(&square, fields, &points, flat),
            &[stress(0, 0), stress(1, 1), stress(0, 1)],
            &["xx", "yy", "xy"],
        );
    }
}

/// Compares the stress of each facet that has a corner inside a flat side with Hooke's law, for small uniform strains e; returns
/// the largest difference over the largest stress, and the number of compared facets.
fn off_on_the_boundary<const D: usize>(
    mesh: &Mesh<D>,
    values: Values,
    stress: impl Fn(f64) -> [[f64; 3]; 3],
) -> (f64, usize) {
    let small = 1e-6;
    let mut body = system(mesh, &[(&Boundary, values)]);
    let strain = |i: usize, j: usize| small * if i == j { 1.0 + i as f64 } else { 0.5 };
    for (node, x) in mesh.positions.iter().enumerate() {
        body.state.x.set(node, core::array::from_fn(|i| x[i] + (0..D).map(|j| strain(i, j) * x[j]).sum::<f64>()));
    }
    // Vertices at which all facets have the same normal.
    let normal = |facet: &[u32; D]| -> [f64; 3] {
        let at = |k: usize, d: usize| if d < D { mesh.positions[facet[k] as usize][d] } else { 0.0 };
        let arm = |k: usize| -> [f64; 3] { core::array::from_fn(|d| at(k, d) - at(0, d)) };
        let (a, b) = (arm(1), if D == 3 { arm(D - 1) } else { [0.0, 0.0, 1.0] });
        let n = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        let length = n.iter().map(|x| x * x).sum::<f64>().sqrt();
        n.map(|x| x / length)
    };
    let flat = |node: u32| {
        let own: Vec<_> = mesh.facets.iter().filter(|facet| facet.contains(&node)).map(normal).collect();
        own.iter().all(|n| (0..3).all(|d| (n[d] - own[0][d]).abs() < 1e-9))
    };
    let expected = stress(small);
    let largest = size(expected.as_flattened());
    let (mut worst, mut compared) = (0.0f64, 0);
    for state in body.members[0].potential.facet_states(&body.view(Stage::Current, 0.0), 0) {
        if mesh.facets[state.cell as usize].iter().any(|node| flat(*node)) {
            let off = state.stress.iter().flatten().zip(expected.iter().flatten());
            worst = off.map(|(a, b)| (a - b).abs() / largest).fold(worst, |most, x| if x > most { x } else { most });
            compared += 1;
        }
    }
    (worst, compared)
}

/// Stresses agree within a twentieth: K is the symmetric part of the collocation matrix, and on these meshes it deviates from the
/// whole matrix by that much.
#[test]
fn stresses_on_the_boundary_are_those_of_hooke() {
    let (young, nu) = (2e5, 0.3);
    let mu = young / (2.0 * (1.0 + nu));
    let lambda = young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
    let block = Mesh::box_surface([0.1, 0.2, 0.3], [1.0, 0.8, 0.6], [6, 5, 4]).unwrap();
    let (off, compared) = off_on_the_boundary(&block, values!(boundary_element, youngs_modulus: young), |small| {
        let entry = |i: usize, j: usize| {
            if i == j { 2.0 * mu * (1.0 + i as f64) + 6.0 * lambda } else { mu }
        };
        core::array::from_fn(|i| core::array::from_fn(|j| small * entry(i, j)))
    });
    assert!(off < 0.05 && compared > 100, "{off} {compared}");

    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.5], [0.0, 0.5]];
    let side = |k: usize, t: f64| -> [f64; 2] {
        core::array::from_fn(|d| corners[k][d] + t * (corners[(k + 1) % 4][d] - corners[k][d]))
    };
    let points: Vec<[f64; 2]> = (0..32).map(|k| side(k / 8, (k % 8) as f64 / 8.0)).collect();
    let mut outline = Mesh::polyline(&points, true).unwrap();
    outline.facets = std::mem::take(&mut outline.wires);
    for plane in ["strain", "stress"] {
        let across = if plane == "stress" { 2.0 * mu * lambda / (lambda + 2.0 * mu) } else { lambda };
        let values = values!(boundary_element, youngs_modulus: young, plane: plane);
        let (off, compared) = off_on_the_boundary(&outline, values, |small| {
            let direct = |k: usize| 2.0 * mu * (1.0 + k as f64) + 3.0 * across;
            let third = if plane == "stress" { 0.0 } else { 3.0 * lambda };
            [[direct(0), mu, 0.0], [mu, direct(1), 0.0], [0.0, 0.0, third]].map(|row| row.map(|x| small * x))
        });
        assert!(off < 0.05 && compared == 32, "{plane}: {off} {compared}");
    }
}
