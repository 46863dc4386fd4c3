//! Adjacent solids: nothing falls between them, and nothing is stopped by the seam.
#![allow(missing_docs)]

use crate::common;
use common::*;
use opruga_core::spec::Values;

const H: f64 = 1.0 / 960.0;

/// Two solids with tops at y = 0 that meet at x = 0, in either order, as boxes or as convex bodies.
fn pairs(more: &[(&str, opruga_core::spec::Value)]) -> Vec<Vec<Values>> {
    let with = |own: &[(&'static str, opruga_core::spec::Value)]| -> Vec<(&str, opruga_core::spec::Value)> {
        own.iter().map(|(name, value)| (*name, value.clone())).chain(more.iter().cloned()).collect()
    };
    let cuboid = |low: f64, high: f64| {
        values::<2>("box", &with(&[("min", vector(&[low, -1.0])), ("max", vector(&[high, 0.0]))]))
    };
    let convex = |low: f64, high: f64| {
        let corners: [&[f64]; 4] = [&[low, -1.0], &[high, -1.0], &[high, 0.0], &[low, 0.0]];
        values::<2>("convex", &with(&[("points", rows(&corners))]))
    };
    let mut out = Vec::new();
    for make in [&cuboid as &dyn Fn(f64, f64) -> Values, &convex] {
        out.push(vec![make(-2.0, 0.0), make(0.0, 2.0)]);
        out.push(vec![make(0.0, 2.0), make(-2.0, 0.0)]);
    }
    out
}

/// Positions near the seam, and on it.
const PLACES: [f64; 9] = [0.0, 1e-12, -1e-12, 1e-7, -1e-7, 1e-4, -1e-4, 2e-3, -2e-3];

#[test]
fn nothing_falls_between_two_solids() {
    for (friction, restitution, thickness) in [(0.0, 0.0, 0.0), (0.5, 0.0, 0.0), (0.0, 0.5, 0.0), (0.3, 0.3, 0.01)] {
        let more =
            [("friction", number(friction)), ("restitution", number(restitution)), ("thickness", number(thickness))];
        for (which, colliders) in pairs(&more).into_iter().enumerate() {
            for across in [0.0, 1e-9, -1e-9, 0.3, -0.3] {
                let start = PLACES.map(|x| [x, 0.2]);
                let mut system = particles(&start, &[[across, 0.0]; 9], 1.0, &colliders);
                system.gravity = [0.0, -G];
                run(&mut system, H, 1920);
                for (node, from) in PLACES.iter().enumerate() {
                    let (x, v) = at(&system, node);
                    let what = format!("pair {which}, µ {friction}, e {restitution}, from {from} at {across} m/s");
                    assert!((x[1] - thickness).abs() < 1e-4, "{what}: {x:?}");
                    // A node that creeps by less than the grain of the surface may stop on the seam.
                    if friction == 0.0 && thickness == 0.0 {
                        assert!(
                            (x[0] - from - 2.0 * across).abs() < 4e-9 && (v[0] - across).abs() < 2e-9,
                            "{what}: {x:?} {v:?}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn what_slides_over_a_seam_does_not_feel_it() {
    for (which, colliders) in pairs(&[]).into_iter().enumerate() {
        for speed in [1e-3, 0.01, 0.1, 1.0, -1e-3, -0.01, -0.1, -1.0] {
            let start: Vec<[f64; 2]> = (1..8).map(|k| [-speed * 0.25 * f64::from(k), 0.0]).collect();
            let mut system = particles(&start, &[[speed, 0.0]; 7], 1.0, &colliders);
            system.gravity = [0.0, -G];
            run(&mut system, H, 1920);
            for (node, from) in start.iter().enumerate() {
                let (x, v) = at(&system, node);
                let what = format!("pair {which}, {speed} m/s, from {}", from[0]);
                assert!(
                    (v[0] - speed).abs() < 1e-12 && (x[0] - from[0] - 2.0 * speed).abs() < 1e-9,
                    "{what}: {x:?} {v:?}"
                );
                assert!(x[1].abs() < 1e-9, "{what}: {x:?}");
            }
        }
    }
}

#[test]
fn who_lands_beside_the_edge_of_a_solid_bounces_from_its_top() {
    for colliders in pairs(&[("restitution", number(1.0)), ("rest_speed", number(1e-3))]) {
        for inside in [5e-4, 1e-3, 2e-3, 5e-3] {
            let start = [[2.0 - inside, 0.1], [-2.0 + inside, 0.1]];
            let mut system = particles(&start, &[[0.0, -5.0]; 2], 1.0, &colliders);
            run(&mut system, H, 48);
            for node in 0..2 {
                let (x, v) = at(&system, node);
                assert!((v[1] - 5.0).abs() < 1e-9 && v[0].abs() < 1e-12, "{inside} m inside: {x:?} {v:?}");
            }
        }
    }
}

/// A single solid: a node that hits its side stays outside, and one that slides off its edge falls.
#[test]
fn a_side_is_no_top() {
    let [colliders, ..] = &pairs(&[])[..] else { panic!("there are pairs") };
    let alone = &colliders[1..];
    let start = [[-0.1, -0.3], [-0.1, -0.6], [1.9, 0.0]];
    let mut system = particles(&start, &[[0.5, 0.0]; 3], 1.0, alone);
    system.gravity = [0.0, -G];
    run(&mut system, H, 240);
    for node in 0..2 {
        let (x, v) = at(&system, node);
        assert!(x[0].abs() < 1e-12 && v[0].abs() < 1e-12 && v[1] < -1.0, "{x:?} {v:?}");
    }
    run(&mut system, H, 240);
    let (x, v) = at(&system, 2);
    assert!(x[0] > 2.1 && x[1] < -0.2 && (v[0] - 0.5).abs() < 1e-12, "{x:?} {v:?}");
}
