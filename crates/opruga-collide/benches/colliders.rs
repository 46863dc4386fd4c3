//! Measures the time per node of the pass over one collider: `cargo bench -p opruga-collide`.
#![allow(missing_docs)]

#[path = "../tests/all/common/mod.rs"]
mod common;
use common::*;
use opruga_core::contacts::{Contacts, Moved};
use opruga_core::spec::{Value, Values};
use opruga_core::state::{Columns, Layout, Parameter};
use opruga_core::tile::TILE;
use opruga_math::{Simd, WIDTH};

const NODES: usize = 1024;

/// Returns the time per node and pass [ns], the shortest of many.
fn time(simd: Simd, list: &[Values], height: f64, v: [f64; 2]) -> f64 {
    let contacts = colliders::<2>(list);
    let (mut x0, mut v0) = (Columns::<2>::zeros(NODES), Columns::<2>::zeros(NODES));
    for k in 0..NODES {
        x0.set(k, [0.001 * k as f64, height]);
        v0.set(k, v);
    }
    let before = x0.clone();
    let mass = Parameter::uniform(1.0);
    let none = vec![0.0; TILE + WIDTH];
    let mut best = f64::INFINITY;
    // The first pass pushes touching nodes out.
    let passes = if height < 0.0 { 1 } else { 8 };
    for _ in 0..50 {
        let repeats = 200;
        let mut spent = 0.0;
        for _ in 0..repeats {
            let (mut x, mut v) = (x0.clone(), v0.clone());
            let (mut contact, mut friction, mut work, mut correction) =
                ([0.0; WIDTH], [0.0; WIDTH], [0.0; WIDTH], [0.0; WIDTH]);
            let start = std::time::Instant::now();
            for _ in 0..passes {
                for tile in 0..NODES / TILE {
                    let range = tile * TILE..(tile + 1) * TILE;
                    let mut moved = Moved {
                        range: range.clone(),
                        padding_start: NODES,
                        before: core::array::from_fn(|d| &before.0[d][range.clone()]),
                        x: &mut x,
                        v: &mut v,
                        force: core::array::from_fn(|_| none.as_slice()),
                        mass: &mass,
                        layout: Layout::Single,
                        time: 1.0,
                        h: 1e-3,
                        loss_contact: &mut contact,
                        loss_friction: &mut friction,
                        work_colliders: &mut work,
                        work_correction: &mut correction,
                    };
                    contacts.resolve(simd, &mut moved);
                }
            }
            spent += start.elapsed().as_secs_f64();
        }
        let each = spent * 1e9 / (repeats * passes * NODES) as f64;
        best = if each < best { each } else { best };
    }
    best
}

fn main() {
    let floor = |mu: f64| values::<2>("half_space", &[("normal", vector(&[0.0, 1.0])), ("friction", number(mu))]);
    let far = values::<2>("ball", &[("center", vector(&[9.0, 0.0])), ("radius", number(1.0))]);
    let container = values::<2>(
        "box",
        &[("min", vector(&[-9.0; 2])), ("max", vector(&[9.0; 2])), ("inside", Value::Boolean(true))],
    );
    let close_ball = values::<2>("ball", &[("center", vector(&[0.5, 0.0])), ("radius", number(0.5))]);
    let close_box =
        values::<2>("box", &[("min", vector(&[0.2, -1.0])), ("max", vector(&[0.8, 0.5])), ("rotation", number(0.001))]);
    let close_capsule =
        values::<2>("capsule", &[("a", vector(&[0.2, 0.0])), ("b", vector(&[0.8, 0.0])), ("radius", number(0.5))]);
    let line = values::<2>(
        "polyline",
        &[("points", rows(&[&[0.0, 0.0], &[0.2, 0.4], &[0.5, 0.0], &[0.7, 0.6], &[1.0, 0.0]]))],
    );
    for simd in [Simd::Baseline, Simd::Avx2, Simd::Avx512] {
        println!("{simd:?}, ns per node:");
        for (name, list, height) in [
            ("floor, nothing touches", vec![floor(0.0)], 0.51),
            ("room and a ball, nothing near", vec![container.clone(), far.clone()], 0.51),
            ("ball, box overlaps, nothing touches", vec![close_ball.clone()], 0.501),
            ("box, same", vec![close_box.clone()], 0.5005),
            ("capsule, same", vec![close_capsule.clone()], 0.501),
            ("floor, all touch, friction 0", vec![floor(0.0)], -0.001),
            ("floor, all touch, friction 0.3", vec![floor(0.3)], -0.001),
            ("polyline, box overlaps, nothing touches", vec![line.clone()], 0.55),
        ] {
            let v = if height < 0.0 { [0.1, -1.0] } else { [0.1, 0.0] };
            println!("  {name:40} {:.3}", time(simd, &list, height, v));
        }
    }
}
