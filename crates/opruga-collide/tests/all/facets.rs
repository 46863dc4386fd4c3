//! Obstacles of facets at any angle: nodes that slide on them, lie in their grooves, or begin on them.
#![allow(missing_docs)]

use crate::common;
use common::*;
use opruga_core::spec::Values;

const H: f64 = 1.0 / 960.0;

/// A slab of 40 m × 2 m, rotated about the origin by an angle, whose upper side passes through the origin.
fn slab(angle: f64) -> Values {
    let (sin, cos) = libm::sincos(angle);
    let corner = |along: f64, up: f64| [cos * along - sin * up, sin * along + cos * up];
    let corners = [corner(-20.0, -2.0), corner(20.0, -2.0), corner(20.0, 0.0), corner(-20.0, 0.0)];
    let points: Vec<&[f64]> = corners.iter().map(|c| c.as_slice()).collect();
    values::<2>("convex", &[("points", rows(&points))])
}

/// On a slope without friction a node moves by g sin θ t²/2, on a convex body as on a half-space.
#[test]
fn nodes_slide_freely_down_a_convex_body_turned_by_any_angle() {
    for degrees in [10.0f64, 26.565, 30.0, 45.0, 60.0, -20.0] {
        let angle = degrees.to_radians();
        let (sin, cos) = libm::sincos(angle);
        let start: Vec<[f64; 2]> = (0..7).map(|k| 0.37 * f64::from(k)).map(|s| [cos * s, sin * s]).collect();
        let mut system = particles(&start, &[[0.0, 0.0]; 7], 1.0, &[slab(angle)]);
        system.gravity = [0.0, -G];
        run(&mut system, H, 960);
        // Symplectic Euler moves h t/2 farther than the exact fall.
        let expected = -G * sin * 0.5 * (1.0 + H);
        for (node, from) in start.iter().enumerate() {
            let (x, _) = at(&system, node);
            let way = cos * (x[0] - from[0]) + sin * (x[1] - from[1]);
            let gap = cos * x[1] - sin * x[0];
            assert!((way / expected - 1.0).abs() < 1e-6, "{degrees}°, node {node}: {way} of {expected}");
            assert!(gap.abs() < 1e-9, "{degrees}°, node {node}: {gap}");
        }
    }
}

#[test]
fn nodes_slide_freely_down_a_convex_body_in_space() {
    // A block whose upper face has the normal (2, 5, 1)/√30.
    let normal = [2.0, 5.0, 1.0].map(|c: f64| c / 30f64.sqrt());
    let along = [5.0, -2.0, 0.0].map(|c: f64| c / 29f64.sqrt());
    let across = [
        normal[1] * along[2] - normal[2] * along[1],
        normal[2] * along[0] - normal[0] * along[2],
        normal[0] * along[1] - normal[1] * along[0],
    ];
    let point = |a: f64, b: f64, c: f64| [0, 1, 2].map(|d| a * along[d] + b * across[d] - c * normal[d]);
    let corners: Vec<[f64; 3]> =
        (0..8).map(|k| point([-30.0, 30.0][k & 1], [-20.0, 20.0][k >> 1 & 1], [0.0, 2.0][k >> 2])).collect();
    let points: Vec<&[f64]> = corners.iter().map(|c| c.as_slice()).collect();
    let start: Vec<[f64; 3]> = (0..7).map(|k| point(0.3 * f64::from(k), -0.2 * f64::from(k), 0.0)).collect();
    let block = values::<3>("convex", &[("points", rows(&points))]);
    let mut system = particles(&start, &[[0.0; 3]; 7], 1.0, &[block]);
    system.gravity = [0.0, -G, 0.0];
    run(&mut system, H, 960);
    for (node, from) in start.iter().enumerate() {
        let (x, _) = at(&system, node);
        for d in 0..3 {
            let down = if d == 1 { -G } else { 0.0 } + G * normal[1] * normal[d];
            let way = 0.5 * down * (1.0 + H);
            assert!((x[d] - from[d] - way).abs() < 1e-6, "node {node}, axis {d}: {} of {way}", x[d] - from[d]);
        }
    }
}

/// Grooves of one surface act like those of two half-spaces: no energy is created, and nodes in them lie still.
#[test]
fn a_groove_of_one_polyline_makes_no_energy() {
    let planes = [[1.0, 1.0], [-1.0, 1.0]].map(|n| values::<2>("half_space", &[("normal", vector(&n))]));
    let polyline = [values::<2>("polyline", &[("points", rows(&[&[-3.0, 3.0], &[0.0, 0.0], &[3.0, 3.0]]))])];
    let start = [[0.13, 1.0], [-0.7, 1.2], [0.02, 0.4], [0.5, 0.9]];
    let speeds = [[0.3, 0.0], [1.0, -2.0], [0.0, 0.0], [-0.4, 0.1]];
    let ends = [planes.as_slice(), polyline.as_slice()].map(|list| {
        let mut system = particles(&start, &speeds, 2.0, list);
        system.gravity = [0.0, -10.0];
        let potential = |system: &_| (0..4).map(|n| 2.0 * 10.0 * at::<2>(system, n).0[1]).sum::<f64>();
        let all = kinetic(&system) + potential(&system);
        for step_number in 0..960 * 4 {
            step(&mut system, H);
            let energy = kinetic(&system) + potential(&system);
            assert!(energy <= all + 1e-9, "step {step_number}: {energy} J of {all} J");
        }
        (0..4).map(|n| at(&system, n)).collect::<Vec<_>>()
    });
    for (plane, groove) in ends[0].iter().zip(&ends[1]) {
        for d in 0..2 {
            assert!(groove.1[d].abs() < 1e-6 && (plane.0[d] - groove.0[d]).abs() < 1e-6, "{plane:?} {groove:?}");
        }
    }
}

/// The same holds for a groove so sharp that its sides push nodes back and forth.
#[test]
fn a_sharp_groove_holds_its_nodes_and_makes_no_energy() {
    let polyline = values::<2>("polyline", &[("points", rows(&[&[-0.2, 3.0], &[0.0, 0.0], &[0.3, 3.0]]))]);
    let mut system = particles(&[[0.05, 2.0], [-0.02, 1.0]], &[[3.0, -1.0], [0.0, 0.0]], 2.0, &[polyline]);
    system.gravity = [0.0, -10.0];
    let energy = |system: &_| kinetic(system) + (0..2).map(|n| 2.0 * 10.0 * at::<2>(system, n).0[1]).sum::<f64>();
    let all = energy(&system);
    for step_number in 0..960 * 4 {
        step(&mut system, H);
        assert!(energy(&system) <= all + 1e-9, "step {step_number}: {} J of {all} J", energy(&system));
    }
    for node in 0..2 {
        let (x, v) = at(&system, node);
        assert!(x[1] > 0.0 && x[1] < 0.01 && x[0].abs() < 1e-3 && dot(&v, &v) < 1e-2, "{x:?} {v:?}");
    }
}

/// A node that begins exactly on a thin surface goes to the side of its normal, whatever the rounding of its position.
#[test]
fn nodes_that_begin_on_a_thin_surface_are_held_on_the_side_of_its_normal() {
    for degrees in [0.0f64, 17.0, -33.0] {
        let (sin, cos) = libm::sincos(degrees.to_radians());
        let along = |s: f64| [cos * s, sin * s];
        let start: Vec<[f64; 2]> = (-9..9).map(|k| along(0.07 * f64::from(k))).collect();
        let line = values::<2>("polyline", &[("points", rows(&[&along(-40.0), &along(40.0)]))]);
        let mut system = particles(&start, &vec![[0.0; 2]; start.len()], 1.0, &[line]);
        system.gravity = [0.0, -G];
        run(&mut system, H, 960);
        for node in 0..start.len() {
            let (x, _) = at(&system, node);
            let gap = cos * x[1] - sin * x[0];
            assert!((0.0..1e-5).contains(&gap), "{degrees}°, node {node}: {gap}");
        }
    }
    let corners: [&[f64]; 3] = [&[-20.0, 3.0, -20.0], &[0.0, 1.0, 20.0], &[20.0, -1.0, -20.0]];
    let start: Vec<[f64; 3]> = (1..9)
        .map(|k| (0.05 * f64::from(k), 0.9 - 0.09 * f64::from(k)))
        .map(|(a, b)| [0, 1, 2].map(|d| a * corners[0][d] + b * corners[1][d] + (1.0 - a - b) * corners[2][d]))
        .collect();
    for triangle in [vec![0, 1, 2], vec![0, 2, 1]] {
        // Gravity pulls against the normal.
        let up = if triangle == [0, 1, 2] { 1.0 } else { -1.0 };
        let mesh = values::<3>(
            "triangle_mesh",
            &[("points", rows(&corners)), ("triangles", opruga_core::spec::Value::Integers(triangle))],
        );
        let mut system = particles(&start, &vec![[0.0; 3]; start.len()], 1.0, &[mesh]);
        system.gravity = [0.0, -G * up, 0.0];
        run(&mut system, H, 240);
        for node in 0..start.len() {
            let (x, _) = at(&system, node);
            // The plane is 0.1 x + y = 1.
            let gap = up * (0.1 * x[0] + x[1] - 1.0);
            assert!((0.0..1e-5).contains(&gap), "{up}, node {node}: {gap}");
        }
    }
}

/// The margin of a thin surface grows with its distance from the origin. So a node that begins exactly on the surface is not
/// inside it, whether the surface is near the origin or far away. If the scene requires a thickness, a node that is closer to
/// the surface than this thickness is inside.
#[test]
fn nodes_that_begin_on_a_thin_surface_are_not_buried_in_it() {
    for far in [0.0, 3.0, 1e3, 1e6, 1e7] {
        let line = |thickness: f64| {
            let points = rows(&[&[-1.0, far], &[1.0, far]]);
            colliders::<2>(&[values::<2>("polyline", &[("points", points), ("thickness", number(thickness))])])
        };
        let nodes = [[-0.1, far], [0.0, far], [0.1, far]];
        assert!(line(0.0).buried(&nodes, 2e-7).is_none(), "{far} m: {:?}", line(0.0).buried(&nodes, 2e-7));
        let buried = line(0.25).buried(&nodes, 2e-7).expect("within the margin");
        assert!(buried.count == 3 && (buried.depth - 0.25).abs() < 1e-6, "{far} m: {buried:?}");
    }
}
