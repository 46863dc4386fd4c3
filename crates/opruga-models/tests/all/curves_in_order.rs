//! Curves whose edges follow the numbers of their nodes are evaluated in one walk; others are evaluated stencil by stencil. Both
//! evaluations give the same forces.

use crate::support::models::FiniteDifference;
use crate::support::{Part, system};
use opruga_core::spec::Values;
use opruga_core::state::Columns;
use opruga_core::system::Stage;
use opruga_core::tile::{TILE, Tile};
use opruga_math::{Column, Lane, WIDTH};
use opruga_mesh::Mesh;

/// The forces of a disturbed curve, and the power of its damping.
fn forces<const D: usize>(mesh: &Mesh<D>, values: &Values) -> (Vec<f64>, f64) {
    let parts: [Part<D>; 1] = [(&FiniteDifference, values.clone())];
    let mut system = system(mesh, &parts);
    for (node, at) in mesh.positions.iter().enumerate() {
        system.state.x.set(node, core::array::from_fn(|d| at[d] + 0.01 * ((node * 3 + d * 5) % 7) as f64));
        system.state.v.set(node, core::array::from_fn(|d| 0.1 * ((node * 5 + d * 3) % 11) as f64));
    }
    let (view, member) = (system.view(Stage::Current, 0.0), &system.members[0]);
    let padded = system.layout.index_count(system.nodes);
    let (mut force, mut slots, mut power) = (Columns::<D>::zeros(padded), Column::default(), [0.0; WIDTH]);
    for start in (0..padded).step_by(TILE) {
        let range = start..(start + TILE).min(padded);
        let columns = force.0.each_mut().map(|column| &mut column[range.clone()]);
        let mut tile = Tile { range, force: columns, power: &mut power, weight: None, slots: &mut slots };
        member.potential.add_force(system.simd, &view, &member.scratch, &mut tile);
    }
    ((0..system.nodes).flat_map(|node| force.at(node)).collect(), power.iter().sum())
}

/// Compares a curve with the same curve whose edges are in another order; returns whether they differ by rounding.
fn compare<const D: usize>(name: &str, mesh: &Mesh<D>, damping: f64) -> bool {
    let values = values!(finite_difference, youngs_modulus: 5e4, thickness: 0.05, damping: damping);
    let mut other = mesh.clone();
    other.facets.rotate_left(usize::from(!mesh.facets.is_empty()));
    other.wires.iter_mut().for_each(|wire| wire.reverse());
    let ((found, power), (expected, other)) = (forces(mesh, &values), forces(&other, &values));
    let size = |v: &mut dyn Iterator<Item = f64>| v.map(f64::abs).fold(0.0, Lane::larger);
    let whole = size(&mut expected.iter().copied());
    let off = size(&mut found.iter().zip(&expected).map(|(a, b)| a - b));
    assert!(whole > 0.0 && off < 1e-12 * whole, "{name}: {off} of {whole}");
    assert!((power - other).abs() <= 1e-12 * other.abs(), "{name}: {power} {other}");
    off > 0.0
}

#[test]
fn the_walk_has_the_forces_of_the_stencils() {
    let points: Vec<[f64; 3]> =
        (0..1100).map(|k| [0.1 * f64::from(k), 0.03 * f64::from(k % 3), 0.02 * f64::from(k % 2)]).collect();
    let flat: Vec<[f64; 2]> = points.iter().map(|x| [x[0], x[1]]).collect();
    let mut two_ways = 0;
    for damping in [0.0, 0.01] {
        for count in [2, 3, 4, 7, 8, 9, 17, 600, 1100] {
            let chain = Mesh::polyline(&flat[..count], false).unwrap();
            two_ways += u32::from(compare(&format!("chain of {count}"), &chain, damping));
            let wire = Mesh::polyline(&points[..count], false).unwrap();
            two_ways += u32::from(compare(&format!("wire of {count}"), &wire, damping));
        }
        for count in [3, 4, 5, 8, 9, 513, 1700] {
            let ring = Mesh::ring(0.5, count, [0.2, 2.0], 0.1).unwrap();
            two_ways += u32::from(compare(&format!("ring of {count}"), &ring, damping));
            let mut loop_of = points[..count.min(1100) as usize].to_vec();
            loop_of.iter_mut().enumerate().for_each(|(k, x)| x[2] += 0.05 * (k % 4) as f64);
            let loop_of = Mesh::polyline(&loop_of, true).unwrap();
            two_ways += u32::from(compare(&format!("loop of {count}"), &loop_of, damping));
        }
        compare("line", &Mesh::<3>::line([0.0; 3], [1.0, 0.3, 0.2], 12).unwrap(), damping);
    }
    assert!(two_ways > 40, "{two_ways} of 64 curves: orders of edges that are summed up in one way compare nothing");
}
