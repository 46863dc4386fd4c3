//! Forces of pieces against those of slots.

use super::super::{Matching, SPEC};
use super::*;
use opruga_core::potential::Potential;
use opruga_core::spec::{Value, Values};
use opruga_core::state::{Columns, Parameter, View};
use opruga_core::tile::Tile;
use opruga_math::Simd;
use opruga_mesh::Mesh;

fn matching<const D: usize>(mesh: &Mesh<D>, region: f64, share: f64) -> Matching<D> {
    let mut values = Values::defaults(&SPEC, D);
    for (name, number) in [("stiffness", 300.0), ("region", region), ("fit_share", share)] {
        values.set(&SPEC, name, Value::Number(number), D).unwrap();
    }
    let mass = Parameter::column((0..mesh.positions.len()).map(|k| 1.0 + 0.25 * (k % 5) as f64).collect());
    let ingredients = Ingredients {
        mesh,
        layout: Layout::Single,
        values: &[&values],
        mass: &mass,
        densities: None,
        thickness: 1.0,
        gravity: [0.0; D],
        step: 1e-3,
        break_off: &Default::default(),
    };
    Matching::new(&ingredients).unwrap()
}
fn forces<const D: usize>(matching: &Matching<D>, mesh: &Mesh<D>) -> Vec<f64> {
    let nodes = mesh.positions.len();
    let padded = Layout::Single.places(nodes);
    let (mut x, v, mut force) = (Columns::<D>::zeros(padded), Columns::zeros(padded), Columns::zeros(padded));
    for (node, at) in mesh.positions.iter().enumerate() {
        x.set(node, core::array::from_fn(|d| at[d] * (1.0 + 0.2 * at[(d + 1) % D]) + 0.01 * ((node + d) % 7) as f64));
    }
    let view = View { x: x.slices(), v: v.slices(), nodes, layout: Layout::Single, time: 0.0, threads: 1 };
    let (simd, mut slots, mut power) = (Simd::best(), Column::default(), [0.0; WIDTH]);
    let mut scratch = vec![0.0; matching.properties().scratch_len];
    matching.prepare(simd, &view, &[], &mut scratch).unwrap();
    let columns = force.0.each_mut().map(|column| &mut column[..padded]);
    let mut tile = Tile { range: 0..padded, force: columns, power: &mut power, weight: None, slots: &mut slots };
    matching.add_force(simd, &view, &scratch, &mut tile);
    (0..nodes).flat_map(|node| force.at(node)).collect()
}
/// The largest force, and by how much it differs from that of the slots.
fn compare<const D: usize>(mesh: &Mesh<D>, region: f64, share: f64) -> [f64; 2] {
    let mut matching = matching(mesh, region, share);
    let pieces = matching.pieces.take().expect("pieces");
    let slots = forces(&matching, mesh);
    matching.pieces = Some(pieces);
    let size = |list: &mut dyn Iterator<Item = f64>| list.map(f64::abs).fold(0.0, larger);
    let found = forces(&matching, mesh);
    [size(&mut slots.iter().copied()), size(&mut found.iter().zip(&slots).map(|(a, b)| a - b))]
}

#[test]
fn forces_of_pieces_are_those_of_slots() {
    let plate = Mesh::<2>::grid([0.3, 0.2], [1.0, 0.7], [13, 9]).unwrap();
    let block = Mesh::<3>::grid([0.3, 0.2, 0.1], [1.0, 0.7, 0.5], [9, 7, 5]).unwrap();
    for share in [0.0, 0.6] {
        for region in [0.2, 0.5] {
            let [size, off] = compare(&plate, region, share);
            assert!(off < 1e-13 * size, "{size} {off}");
            let [size, off] = compare(&block, region, share);
            assert!(off < 1e-13 * size, "{size} {off}");
        }
    }
    let sheet = Mesh::sheet([0.0; 3], [[1.0, 0.0, 0.5], [0.0, 1.0, 0.2]], [11, 12]).unwrap();
    let [size, off] = compare(&sheet, 0.4, 0.5);
    assert!(off < 1e-13 * size, "{size} {off}");
}

/// A chain of so many regions that sums over it would lose the digits of one.
#[test]
fn small_clusters_of_long_bodies_are_taken_slot_by_slot() {
    let chain = |edges: u32| Mesh::<2>::line([0.0; 2], [f64::from(edges), 0.0], edges).unwrap();
    let short = chain(100);
    // Twelve digits of what a cluster that is off by its radius would pull with, κ m r.
    let [_, off] = compare(&short, 4.0, 0.5);
    assert!(off < 1e-12 * 300.0 * 2.0 * 1.3, "{off}");
    assert!(matching(&chain(1000), 4.0, 0.5).pieces.is_none());
    assert!(matching(&short, 200.0, 0.5).pieces.is_none(), "one cluster");
}
