//! The walk along a curve against the stencils of stretch and bending.

use super::super::{FiniteDifference, SPEC};
use opruga_core::potential::{Ingredients, Potential};
use opruga_core::spec::{Value, Values};
use opruga_core::state::{Columns, Layout, Parameter, View};
use opruga_core::tile::{TILE, Tile};
use opruga_math::{Column, Simd, WIDTH};
use opruga_mesh::Mesh;

/// Forces of a disturbed curve, and the power of its damping.
fn forces<const D: usize>(curve: &FiniteDifference<D>, mesh: &Mesh<D>) -> (Vec<f64>, f64) {
    let nodes = mesh.positions.len();
    let padded = Layout::Single.places(nodes);
    let (mut x, mut v, mut force) = (Columns::<D>::zeros(padded), Columns::<D>::zeros(padded), Columns::zeros(padded));
    for (node, at) in mesh.positions.iter().enumerate() {
        x.set(node, core::array::from_fn(|d| at[d] + 0.01 * ((node * 3 + d * 5) % 7) as f64));
        v.set(node, core::array::from_fn(|d| 0.1 * ((node * 5 + d * 3) % 11) as f64));
    }
    let view = View { x: x.slices(), v: v.slices(), nodes, layout: Layout::Single, time: 0.0, threads: 1 };
    let (mut slots, mut power) = (Column::default(), [0.0; WIDTH]);
    for start in (0..padded).step_by(TILE) {
        let range = start..(start + TILE).min(padded);
        let columns = force.0.each_mut().map(|column| &mut column[range.clone()]);
        let mut tile = Tile { range, force: columns, power: &mut power, weight: None, slots: &mut slots };
        curve.add_force(Simd::best(), &view, &[], &mut tile);
    }
    ((0..nodes).flat_map(|node| force.at(node)).collect(), power.iter().sum())
}

fn compare<const D: usize>(name: &str, mesh: &Mesh<D>, fields: &[(&str, f64)]) {
    let mut values = Values::defaults(&SPEC, D);
    for (name, number) in [("youngs_modulus", 5e4), ("thickness", 0.05)].iter().chain(fields) {
        values.set(&SPEC, name, Value::Number(*number), D).unwrap();
    }
    let mass = Parameter::uniform(1.0);
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
    let mut curve = FiniteDifference::new(&ingredients).unwrap();
    assert!(curve.along.is_some(), "{name}");
    let (found, power) = forces(&curve, mesh);
    curve.along = None;
    let (expected, other) = forces(&curve, mesh);
    let size = |v: &mut dyn Iterator<Item = f64>| v.map(f64::abs).fold(0.0, |a, b| if b > a { b } else { a });
    let whole = size(&mut expected.iter().copied());
    let off = size(&mut found.iter().zip(&expected).map(|(a, b)| a - b));
    assert!(whole > 0.0 && off < 1e-12 * whole, "{name}: {off} of {whole}");
    assert!((power - other).abs() <= 1e-12 * other.abs(), "{name}: {power} {other}");
}

#[test]
fn the_walk_has_the_forces_of_the_stencils() {
    let points: Vec<[f64; 3]> =
        (0..1100).map(|k| [0.1 * f64::from(k), 0.03 * f64::from(k % 3), 0.02 * f64::from(k % 2)]).collect();
    let flat: Vec<[f64; 2]> = points.iter().map(|x| [x[0], x[1]]).collect();
    for damping in [0.0, 0.01] {
        let fields = [("damping", damping)];
        for count in [2, 3, 4, 7, 8, 9, 17, 600, 1100] {
            compare(&format!("chain of {count}"), &Mesh::polyline(&flat[..count], false).unwrap(), &fields);
            compare(&format!("wire of {count}"), &Mesh::polyline(&points[..count], false).unwrap(), &fields);
        }
        for count in [3, 4, 5, 8, 9, 513, 1700] {
            compare(&format!("ring of {count}"), &Mesh::ring(0.5, count, [0.2, 2.0], 0.1).unwrap(), &fields);
            let mut loop_of = points[..count.min(1100) as usize].to_vec();
            loop_of.iter_mut().enumerate().for_each(|(k, x)| x[2] += 0.05 * (k % 4) as f64);
            compare(&format!("loop of {count}"), &Mesh::polyline(&loop_of, true).unwrap(), &fields);
        }
        compare("line", &Mesh::<3>::line([0.0; 3], [1.0, 0.3, 0.2], 12).unwrap(), &fields);
    }
}

/// A curve whose nodes are numbered in another way has its stencils alone.
#[test]
fn curves_in_another_order_are_left_to_the_stencils() {
    let mut mesh = Mesh::<2>::line([0.0; 2], [1.0, 0.0], 4).unwrap();
    mesh.wires.reverse();
    let mut values = Values::defaults(&SPEC, 2);
    for (name, number) in [("youngs_modulus", 5e4), ("thickness", 0.05)] {
        values.set(&SPEC, name, Value::Number(number), 2).unwrap();
    }
    let mass = Parameter::uniform(1.0);
    let ingredients = Ingredients {
        mesh: &mesh,
        layout: Layout::Single,
        values: &[&values],
        mass: &mass,
        densities: None,
        thickness: 1.0,
        gravity: [0.0; 2],
        step: 1e-3,
        break_off: &Default::default(),
    };
    assert!(FiniteDifference::new(&ingredients).unwrap().along.is_none());
}
