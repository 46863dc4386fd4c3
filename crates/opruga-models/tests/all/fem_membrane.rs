//! Cook's membrane: bending and near incompressibility, against published numbers.
//!
//! A trapezoid of 48 × (44 → 16), clamped at the left, pulled up along the right side by a uniform traction.

use crate::sparse;
use crate::support;

use crate::support::models::Fem;
use opruga_core::potential::Model;
use opruga_core::spec::Values;
use opruga_mesh::Mesh;
use support::system;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Boxes,
    Triangles,
    Quadratic,
}

/// The membrane of n × n cells; quadratic cells with straight sides.
fn membrane(n: u32, kind: Kind) -> Mesh<2> {
    let grid = Mesh::<2>::grid([0.0; 2], [1.0, 1.0], [n, n]).unwrap();
    let mut mesh = match kind {
        Kind::Boxes => grid,
        Kind::Triangles => grid.into_simplices().unwrap(),
        Kind::Quadratic => grid.into_simplices().unwrap().into_quadratic().unwrap(),
    };
    for x in &mut mesh.positions {
        let [s, t] = *x;
        *x = [48.0 * s, 44.0 * s + t * (44.0 - 28.0 * s)];
    }
    mesh
}

/// The upward displacements of the middle and of the upper corner of the right side.
fn pulled(mesh: &Mesh<2>, values: Values, force: f64) -> [f64; 2] {
    let mut system = system(mesh, &[(&Fem as &dyn Model<2>, values)]);
    let mut load = vec![0.0; 2 * mesh.positions.len()];
    let right: Vec<u32> = (0..mesh.positions.len() as u32).filter(|n| mesh.positions[*n as usize][0] == 48.0).collect();
    for (node, share) in mesh.boundary_shares(&right) {
        load[2 * node as usize + 1] = force / 16.0 * share;
    }
    let held: Vec<bool> = (0..load.len()).map(|k| mesh.positions[k / 2][0] == 0.0).collect();
    let residual = sparse::equilibrium(&mut system, &load, &held);
    assert!(residual < 1e-6 * force, "{residual:e}");
    [52.0, 60.0].map(|y| {
        let node = mesh.positions.iter().position(|x| x[0] == 48.0 && (x[1] - y).abs() < 1e-9).unwrap();
        system.state.x.at(node)[1] - mesh.positions[node][1]
    })
}

/// Plane stress, E = 1, ν = 1/3, F = 1: 23.9676 in the limit; quadratic triangles converge from below.
#[test]
fn quadratic_triangles_bend_as_they_should_in_plane_stress() {
    let values = || values!(fem, material: "linear", youngs_modulus: 1.0, poissons_ratio: 1.0 / 3.0, plane: "stress");
    let found: Vec<f64> = [4, 8, 16].iter().map(|n| pulled(&membrane(*n, Kind::Quadratic), values(), 1.0)[0]).collect();
    assert!((found[1] / 23.9676 - 1.0).abs() < 0.006 && (found[2] / 23.9676 - 1.0).abs() < 0.003, "{found:?}");
    assert!(found.windows(2).all(|w| w[0] < w[1] && w[1] < 23.9676), "{found:?}");
    // Boxes are as close; linear triangles with the same nodes are much stiffer.
    let boxes = pulled(&membrane(16, Kind::Boxes), values(), 1.0)[0];
    let triangles = pulled(&membrane(16, Kind::Triangles), values(), 1.0)[0];
    println!("plane stress, middle: quadratic 4, 8, 16: {found:?}, boxes 16: {boxes}, triangles 16: {triangles}");
    assert!((boxes / 23.9676 - 1.0).abs() < 0.005, "{boxes}");
    assert!(triangles < 0.97 * boxes, "{triangles} {boxes}");
}

/// Neo-Hookean in plane strain, E = 240.565, F = 100: the corner and the middle of the right side.
#[test]
fn a_large_pull_of_a_compressible_membrane_is_that_of_other_codes() {
    for (ratio, corner, middle) in [(0.3, 7.7648, 7.8815), (0.45, 7.1660, 7.2258)] {
        let values = values!(fem, material: "neo_hookean", youngs_modulus: 240.565, poissons_ratio: ratio);
        let [m, c] = pulled(&membrane(16, Kind::Quadratic), values, 100.0);
        println!("neo-Hookean, ν = {ratio}, quadratic 16: corner {c}, middle {m}");
        assert!((c / corner - 1.0).abs() < 0.006, "ν = {ratio}: corner {c}, expected {corner}");
        assert!((m / middle - 1.0).abs() < 0.006, "ν = {ratio}: middle {m}, expected {middle}");
    }
}

/// Nearly incompressible, ν = 0.4999: published solutions reach 6.9 at the corner. The accepted elements do not lock.
#[test]
fn what_is_offered_near_incompressibility_does_not_lock() {
    let values = |locking: &str| values!(fem, material: "neo_hookean", youngs_modulus: 240.565, poissons_ratio: 0.4999, locking: locking);
    let quadratic = pulled(&membrane(8, Kind::Quadratic), values("refuse"), 100.0)[1] / 6.9 - 1.0;
    let boxes = pulled(&membrane(12, Kind::Boxes), values("refuse"), 100.0)[1] / 6.9 - 1.0;
    let triangles = pulled(&membrane(12, Kind::Triangles), values("accept"), 100.0)[1] / 6.9 - 1.0;
    println!("ν = 0.4999 against 6.9: quadratic 8: {quadratic}, boxes 12: {boxes}, triangles 12: {triangles}");
    assert!((-0.03..0.005).contains(&quadratic), "quadratic triangles: {quadratic}");
    assert!((-0.03..0.005).contains(&boxes), "quadrilaterals: {boxes}");
    // Nor do linear triangles whose nodes resist volume; they bend no better than other linear triangles of their size.
    let nodal = pulled(&membrane(16, Kind::Triangles), values("nodal_volume"), 100.0)[1] / 6.9 - 1.0;
    println!("volumes of nodes, triangles 16: {nodal}");
    assert!((-0.07..0.005).contains(&nodal), "volumes of nodes: {nodal}");
    // Linear triangles do lock, which is why they are refused.
    assert!(triangles < -0.1, "linear triangles: {triangles}");
}
