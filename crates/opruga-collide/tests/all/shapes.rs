//! Every shape: end positions of nodes, fast nodes, degenerate positions, bounds, pictures, errors.
#![allow(missing_docs)]

use crate::common;
use common::*;
use opruga_collide::{Colliders, Picture, Refused};
use opruga_core::error::BuildError;
use opruga_core::spec::{Value, Values};

const H: f64 = 1.0 / 960.0;
const INSIDE: (&str, Value) = ("inside", Value::Boolean(true));

/// The position and velocity of one node after one step without forces.
fn after<const D: usize>(collider: &Values, x: [f64; D], v: [f64; D], h: f64) -> ([f64; D], [f64; D]) {
    let mut system = particles(&[x], &[v], 1.0, std::slice::from_ref(collider));
    step(&mut system, h);
    at(&system, 0)
}
fn near<const D: usize>(a: [f64; D], b: [f64; D]) {
    assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-12), "{a:?} is not {b:?}");
}

#[test]
fn nodes_end_on_the_surface() {
    let plate = values::<2>("box", &[("min", vector(&[-1.0, -0.5])), ("max", vector(&[1.0, 0.5]))]);
    near(after(&plate, [0.2, 0.4], [0.0; 2], H).0, [0.2, 0.5]);
    near(after(&plate, [0.9, 0.1], [0.0; 2], H).0, [1.0, 0.1]);
    near(after(&plate, [-0.3, -0.45], [0.0; 2], H).0, [-0.3, -0.5]);
    near(after(&plate, [1.1, 0.1], [0.0; 2], H).0, [1.1, 0.1]);
    // A margin rounds the corner: the node is at 45° from it.
    let round =
        values::<2>("box", &[("min", vector(&[-1.0, -0.5])), ("max", vector(&[1.0, 0.5])), ("thickness", number(0.2))]);
    let corner = 0.2 * 0.5f64.sqrt();
    near(after(&round, [1.1, 0.6], [0.0; 2], H).0, [1.0 + corner, 0.5 + corner]);
    // Rotated by 90° (from x to y), the long side points up.
    let turned = values::<2>(
        "box",
        &[
            ("center", vector(&[0.0, 0.0])),
            ("size", vector(&[2.0, 1.0])),
            ("rotation", number(core::f64::consts::FRAC_PI_2)),
        ],
    );
    near(after(&turned, [0.0, 0.9], [0.0; 2], H).0, [0.0, 1.0]);
    let turned = values::<3>(
        "box",
        &[
            ("center", vector(&[0.0; 3])),
            ("size", vector(&[4.0, 2.0, 2.0])),
            ("rotation", vector(&[0.0, 0.0, core::f64::consts::FRAC_PI_2])),
        ],
    );
    near(after(&turned, [0.1, 1.9, 0.2], [0.0; 3], H).0, [0.1, 2.0, 0.2]);

    let ball = values::<3>("ball", &[("center", vector(&[1.0, 0.0, 0.0])), ("radius", number(2.0))]);
    near(after(&ball, [1.0, 0.0, 1.5], [0.0; 3], H).0, [1.0, 0.0, 2.0]);
    let bowl = values::<3>("ball", &[("radius", number(2.0)), INSIDE]);
    near(after(&bowl, [0.0, -2.5, 0.0], [0.0; 3], H).0, [0.0, -2.0, 0.0]);
    near(after(&bowl, [0.0, -1.5, 0.0], [0.0; 3], H).0, [0.0, -1.5, 0.0]);

    let capsule =
        values::<2>("capsule", &[("a", vector(&[-1.0, 0.0])), ("b", vector(&[1.0, 0.0])), ("radius", number(0.5))]);
    near(after(&capsule, [0.3, 0.1], [0.0; 2], H).0, [0.3, 0.5]);
    near(after(&capsule, [1.2, 0.0], [0.0; 2], H).0, [1.5, 0.0]);

    let triangle =
        values::<2>("convex", &[("points", rows(&[&[0.0, 0.0], &[2.0, 0.0], &[0.5, 0.3], &[0.0, 2.0], &[0.0, 1.0]]))]);
    near(after(&triangle, [0.1, 0.5], [0.0; 2], H).0, [0.0, 0.5]);
    near(after(&triangle, [1.0, 0.9], [0.0; 2], H).0, [1.05, 0.95]);
    near(after(&triangle, [1.2, 1.2], [0.0; 2], H).0, [1.2, 1.2]);
    let round = values::<2>(
        "convex",
        &[("points", rows(&[&[0.0, 0.0], &[2.0, 0.0], &[0.0, 2.0]])), ("thickness", number(0.1))],
    );
    near(after(&round, [2.05, 0.0], [0.0; 2], H).0, [2.1, 0.0]);

    let cube: Vec<Vec<f64>> = (0..8).map(|k| (0..3).map(|d| f64::from(k >> d & 1)).collect()).collect();
    let cube = values::<3>("convex", &[("points", Value::Rows(cube))]);
    near(after(&cube, [0.4, 0.9, 0.3], [0.0; 3], H).0, [0.4, 1.0, 0.3]);
    near(after(&cube, [0.4, 0.3, 0.1], [0.0; 3], H).0, [0.4, 0.3, 0.0]);
}

#[test]
fn degenerate_places_have_a_direction() {
    for list in [
        values::<3>("ball", &[("radius", number(1.0)), ("friction", number(0.5)), ("restitution", number(0.5))]),
        values::<3>(
            "capsule",
            &[
                ("a", vector(&[-1.0, 0.0, 0.0])),
                ("b", vector(&[1.0, 0.0, 0.0])),
                ("radius", number(1.0)),
                ("friction", number(0.5)),
            ],
        ),
        values::<3>(
            "box",
            &[
                ("min", vector(&[-1.0; 3])),
                ("max", vector(&[1.0; 3])),
                ("friction", number(0.5)),
                ("thickness", number(0.1)),
            ],
        ),
        values::<3>("ball", &[("radius", number(1.0)), INSIDE, ("friction", number(0.5))]),
        values::<3>(
            "triangle_mesh",
            &[
                ("points", rows(&[&[-1.0, 0.0, -1.0], &[1.0, 0.0, -1.0], &[0.0, 0.0, 2.0]])),
                ("triangles", Value::Integers(vec![0, 1, 2])),
                ("thickness", number(0.1)),
            ],
        ),
    ] {
        for v in [[0.0; 3], [1e-300, 0.0, 0.0], [1.0, -2.0, 0.5]] {
            for x in [[0.0; 3], [1e-200, 0.0, 0.0], [1.0, 1.0, 1.0], [0.0, 1.0, 0.0], [1e300, 1e300, 0.0]] {
                let (x, v) = after(&list, x, v, H);
                assert!(x.iter().chain(&v).all(|x| x.is_finite()), "{list:?} {x:?} {v:?}");
            }
        }
    }
    // As documented: up from the centre of a ball.
    near(after(&values::<2>("ball", &[("radius", number(1.0))]), [0.0; 2], [0.0; 2], H).0, [0.0, 1.0]);
    // NaN does not spread to other nodes.
    let mut system = particles(
        &[[f64::NAN, 0.0], [0.0, 0.5]],
        &[[0.0; 2]; 2],
        1.0,
        &[values::<2>("ball", &[("radius", number(1.0))])],
    );
    step(&mut system, H);
    near(at(&system, 1).0, [0.0, 1.0]);
}

#[test]
fn fast_nodes_do_not_tunnel() {
    let square = rows(&[&[-1.0, -0.01], &[1.0, -0.01], &[1.0, 0.01], &[-1.0, 0.01]]);
    let cube: Vec<Vec<f64>> =
        (0..8).map(|k| vec![f64::from(k & 1) * 2.0 - 1.0, f64::from(k >> 1 & 1) * 0.02 - 0.01]).collect();
    for (name, collider, top) in [
        ("box", values::<2>("box", &[("min", vector(&[-1.0, -0.01])), ("max", vector(&[1.0, 0.01]))]), 0.01),
        (
            "capsule",
            values::<2>(
                "capsule",
                &[("a", vector(&[-1.0, 0.0])), ("b", vector(&[1.0, 0.0])), ("radius", number(0.01))],
            ),
            0.01,
        ),
        ("ball", values::<2>("ball", &[("radius", number(0.02))]), 0.02),
        ("convex", values::<2>("convex", &[("points", Value::Rows(cube))]), 0.01),
        ("polyline", values::<2>("polyline", &[("points", square), ("closed", Value::Boolean(true))]), 0.01),
    ] {
        for speed in [5.0, 13.0, 40.0, 1000.0, 1e6] {
            let mut system = particles(
                &[[if name == "ball" { 0.0 } else { 0.001 }, 0.5]],
                &[[0.0, -speed]],
                1.0,
                std::slice::from_ref(&collider),
            );
            run(&mut system, H, 200);
            let (x, v) = at(&system, 0);
            // Stopped on the upper side.
            assert!((x[1] - top).abs() < 1e-7 && v == [0.0, 0.0], "{name} at {speed} m/s: {x:?} {v:?}");
        }
    }
}

#[test]
fn thin_surfaces_hold_on_both_sides() {
    for side in [1.0, -1.0] {
        // Along an edge between two segments, onto a vertex, and into the middle.
        for x in [0.0, 0.3, -1.0] {
            let line = values::<2>(
                "polyline",
                &[("points", rows(&[&[-2.0, 0.0], &[0.0, 0.0], &[2.0, 0.0]])), ("friction", number(0.3))],
            );
            let mut system = particles(&[[x, side]], &[[0.0, 0.0]], 1.0, &[line]);
            system.gravity = [0.0, -side * G];
            run(&mut system, H, 9600);
            let (x, v) = at(&system, 0);
            assert!(x[1] * side > 0.0 && x[1].abs() < 1e-6 && v == [0.0, 0.0], "{x:?} {v:?}");
        }
        // The diagonal of a square of two triangles, and its corner region.
        for x in [[0.5, 0.5], [0.2, 0.2], [0.9, 0.1]] {
            let square = values::<3>(
                "triangle_mesh",
                &[
                    ("points", rows(&[&[0.0, 0.0, 0.0], &[1.0, 0.0, 0.0], &[1.0, 0.0, 1.0], &[0.0, 0.0, 1.0]])),
                    ("triangles", Value::Integers(vec![0, 1, 2, 0, 2, 3])),
                ],
            );
            let mut system = particles(&[[x[0], side, x[1]]], &[[0.0; 3]], 1.0, &[square]);
            system.gravity = [0.0, -side * G, 0.0];
            run(&mut system, H, 9600);
            let (x, v) = at(&system, 0);
            assert!(x[1] * side > 0.0 && x[1].abs() < 1e-6 && v == [0.0; 3], "{x:?} {v:?}");
        }
    }
}

#[test]
fn a_groove_keeps_its_nodes() {
    // A narrow V: a node that one flank pushes out must not slip through the other.
    let groove = values::<2>(
        "polyline",
        &[("points", rows(&[&[-0.1, 1.0], &[0.0, 0.0], &[0.1, 1.0]])), ("friction", number(0.2))],
    );
    let start: Vec<[f64; 2]> = (0..7).map(|k| [0.01 * k as f64 - 0.03, 0.9]).collect();
    let mut system = particles(&start, &[[3.0, -5.0]; 7], 1.0, &[groove]);
    system.gravity = [0.0, -G];
    for _ in 0..9600 {
        step(&mut system, H);
        for node in 0..7 {
            let x = at(&system, node).0;
            assert!(x[1] > 0.0 && (x[1] >= 1.0 || x[0].abs() < 0.1 * x[1] + 1e-12), "{x:?}");
        }
    }
}

#[test]
fn a_moving_mesh_takes_nodes_along() {
    // A plate that rises at 3 m/s through resting nodes, and one that rotates.
    let plate = values::<3>(
        "triangle_mesh",
        &[
            ("points", rows(&[&[-1.0, 0.0, -1.0], &[1.0, 0.0, -1.0], &[1.0, 0.0, 1.0], &[-1.0, 0.0, 1.0]])),
            ("triangles", Value::Integers(vec![0, 1, 2, 0, 2, 3])),
            ("motion", rows(&[&[0.0, 0.0, 0.0, 0.0], &[1.0, 0.0, 3.0, 0.0]])),
        ],
    );
    let mut system = particles(&[[0.2, 0.5, 0.2], [0.0, 0.7, 0.0]], &[[0.0; 3]; 2], 1.0, &[plate]);
    run(&mut system, H, 480);
    for node in 0..2 {
        let (x, v) = at(&system, node);
        assert!((x[1] - 1.5).abs() < 1e-6 && (v[1] - 3.0).abs() < 1e-12, "{x:?} {v:?}");
    }
    let paddle = values::<2>(
        "polyline",
        &[("points", rows(&[&[0.0, 0.0], &[1.0, 0.0]])), ("pivot", vector(&[0.0, 0.0])), ("spin", number(20.0))],
    );
    let mut system = particles(&[[0.5, 0.1]], &[[0.0; 2]], 1.0, &[paddle]);
    run(&mut system, H, 20);
    let (x, v) = at(&system, 0);
    // The paddle hits the node at atan(0.1/0.5), and throws it ahead.
    assert!(v[1] > 9.0 && v[0] < -1.0 && sum(&system.work.user) > 0.0, "{x:?} {v:?}");
}

#[test]
fn reach_is_never_no_where_something_touches() {
    let far = |list: &[Values], low: [f64; 2], high: [f64; 2], t: [f64; 2]| {
        colliders::<2>(list).reach(t[0], t[1], &low, &high)
    };
    let floor = values::<2>("half_space", &[("normal", vector(&[0.0, 1.0])), ("thickness", number(0.1))]);
    assert!(!far(std::slice::from_ref(&floor), [-1.0, 0.2], [1.0, 2.0], [0.0, 1.0]));
    assert!(far(&[floor], [-1.0, 0.05], [1.0, 2.0], [0.0, 1.0]));
    let rising = values::<2>(
        "half_space",
        &[("normal", vector(&[0.0, 1.0])), ("motion", rows(&[&[0.0, 0.0, 0.0], &[1.0, 0.0, 1.0], &[2.0, 0.0, 0.0]]))],
    );
    assert!(!far(std::slice::from_ref(&rising), [0.0, 0.5], [1.0, 2.0], [0.0, 0.4]));
    assert!(far(std::slice::from_ref(&rising), [0.0, 0.5], [1.0, 2.0], [0.0, 2.0]));
    assert!(!far(&[rising], [0.0, 0.5], [1.0, 2.0], [2.0, 5.0]));
    let room = values::<2>("box", &[("min", vector(&[-5.0; 2])), ("max", vector(&[5.0; 2])), INSIDE]);
    assert!(!far(std::slice::from_ref(&room), [-1.0; 2], [1.0; 2], [0.0, 1.0]));
    assert!(far(&[room], [-1.0; 2], [1.0, 5.1], [0.0, 1.0]));
    let bowl = values::<2>("ball", &[("radius", number(5.0)), INSIDE]);
    assert!(!far(std::slice::from_ref(&bowl), [-1.0; 2], [1.0; 2], [0.0, 1.0]));
    assert!(far(&[bowl], [3.0; 2], [4.0; 2], [0.0, 1.0]));
    let arm = values::<2>(
        "capsule",
        &[
            ("a", vector(&[0.0, 0.0])),
            ("b", vector(&[2.0, 0.0])),
            ("radius", number(0.1)),
            ("spin", number(1.0)),
            ("pivot", vector(&[0.0, 0.0])),
        ],
    );
    assert!(far(std::slice::from_ref(&arm), [-2.0, -0.1], [-1.9, 0.1], [0.0, 0.1]));
    assert!(!far(&[arm], [-3.0, -0.1], [-2.9, 0.1], [0.0, 0.1]));
    assert!(!far(&[], [0.0; 2], [0.0; 2], [0.0, 1.0]));
}

#[test]
fn pictures_show_where_things_are() {
    let list = [
        values::<2>("half_space", &[("point", vector(&[1.0, 2.0])), ("normal", vector(&[0.0, 3.0]))]),
        values::<2>(
            "box",
            &[
                ("min", vector(&[0.0; 2])),
                ("max", vector(&[2.0; 2])),
                INSIDE,
                ("motion", rows(&[&[0.0, 0.0, 0.0], &[1.0, 1.0, 0.0]])),
            ],
        ),
        values::<2>("ball", &[("radius", number(2.0))]),
        values::<2>(
            "capsule",
            &[
                ("a", vector(&[0.0, 0.0])),
                ("b", vector(&[2.0, 0.0])),
                ("radius", number(0.1)),
                ("spin", number(core::f64::consts::PI)),
            ],
        ),
        values::<2>("convex", &[("points", rows(&[&[0.0, 0.0], &[1.0, 0.0], &[0.2, 0.2], &[0.0, 1.0]]))]),
        values::<2>("polyline", &[("points", rows(&[&[0.0, 0.0], &[1.0, 0.0]]))]),
    ];
    let pictures = colliders::<2>(&list).pictures(0.5);
    assert_eq!(pictures[0], Picture::HalfSpace { point: [1.0, 2.0], normal: [0.0, 1.0] });
    assert_eq!(
        pictures[1],
        Picture::Box { corners: vec![[0.5, 0.0], [2.5, 0.0], [0.5, 2.0], [2.5, 2.0]], inside: true }
    );
    assert_eq!(pictures[2], Picture::Ball { center: [0.0; 2], radius: 2.0, inside: false });
    let Picture::Capsule { a, b, .. } = pictures[3] else { panic!() };
    near(a, [1.0, -1.0]);
    near(b, [1.0, 1.0]);
    assert_eq!(pictures[4], Picture::Polygon { points: vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]] });
    assert_eq!(pictures[5], Picture::Polyline { points: vec![[0.0, 0.0], [1.0, 0.0]], closed: false });
}

#[test]
fn refusals_name_collider_and_value() {
    fn refused<const D: usize>(list: Values) -> BuildError {
        let ball = values::<D>("ball", &[("radius", number(1.0))]);
        let Refused { index, source } = Colliders::<D>::build(&[ball, list]).unwrap_err();
        assert_eq!(index, 1);
        source
    }
    // A zero direction is not a valid value of the field; nor is one whose length underflows.
    let e = refused::<2>(values::<2>("half_space", &[("normal", vector(&[1e-200, 0.0]))]));
    assert_eq!((e.kind.as_str(), e.code()), ("half_space", "collider.no_direction"));
    assert_eq!(e.about.in_full(), "`normal` is [1e-200, 0.0]; allowed: a vector with a length above 1e-150");
    let e = refused::<2>(values::<2>("box", &[("min", vector(&[0.0, 0.0]))]));
    assert_eq!(e.code(), "collider.box_fields");
    let e = refused::<3>(values::<3>("box", &[("min", vector(&[0.0; 3])), ("max", vector(&[1.0, -1.0, 1.0]))]));
    assert_eq!(e.code(), "collider.empty_box");
    assert!(e.about.to_string().contains("[1.0, -1.0, 1.0]"));
    let e = refused::<2>(values::<2>(
        "box",
        &[("min", vector(&[0.0; 2])), ("max", vector(&[1.0; 2])), INSIDE, ("thickness", number(0.5))],
    ));
    assert_eq!(e.code(), "collider.no_room");
    let e = refused::<2>(values::<2>("ball", &[("radius", number(1.0)), INSIDE, ("thickness", number(1.0))]));
    assert_eq!(e.code(), "collider.no_room");
    let e = refused::<3>(values::<3>(
        "capsule",
        &[("a", vector(&[1.0; 3])), ("b", vector(&[1.0; 3])), ("radius", number(1.0))],
    ));
    assert_eq!(e.code(), "collider.no_direction");
    let e =
        refused::<2>(values::<2>("convex", &[("points", rows(&[&[0.0, 0.0], &[1.0, 1.0], &[2.0, 2.0], &[2.0, 2.0]]))]));
    assert_eq!(e.code(), "collider.flat_hull");
    let flat = rows(&[&[0.0, 0.0, 0.0], &[1.0, 0.0, 0.0], &[0.0, 1.0, 0.0], &[1.0, 1.0, 0.0], &[1.0, 1.0, 0.0]]);
    assert_eq!(refused::<3>(values::<3>("convex", &[("points", flat)])).code(), "collider.flat_hull");
    assert_eq!(
        refused::<3>(values::<3>("convex", &[("points", rows(&[&[1.0, 0.0, 0.0]]))])).code(),
        "collider.flat_hull"
    );
    let e = refused::<2>(values::<2>("polyline", &[("points", rows(&[&[0.0, 0.0], &[1.0, 0.0], &[1.0, 0.0]]))]));
    assert_eq!((e.code(), e.about.to_string().contains("points 1 and 2")), ("collider.degenerate_facet", true));
    let e = refused::<2>(values::<2>(
        "polyline",
        &[("points", rows(&[&[0.0, 0.0], &[1.0, 0.0]])), ("closed", Value::Boolean(true))],
    ));
    assert_eq!(e.code(), "collider.points");
    let mesh = |numbers: &[u32]| {
        values::<3>(
            "triangle_mesh",
            &[("points", rows(&[&[0.0; 3], &[1.0; 3], &[2.0; 3]])), ("triangles", Value::Integers(numbers.to_vec()))],
        )
    };
    assert_eq!(refused::<3>(mesh(&[0, 1, 3])).about.in_full(), "`triangles` names point 3; allowed: 0 to 2");
    assert_eq!(refused::<3>(mesh(&[0, 1])).code(), "collider.triangles");
    assert_eq!(refused::<3>(mesh(&[0, 1, 2])).code(), "collider.degenerate_facet");
    assert_eq!(Colliders::<2>::build(&[mesh(&[0, 1, 2])]).unwrap_err().source.code(), "collider.kind");
}

#[test]
fn hulls_of_many_points_hold_all_of_them() {
    let mut seed = 11u64;
    let mut random = move || {
        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (seed >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
    };
    for count in [5, 20, 200] {
        let points: Vec<Vec<f64>> = (0..count).map(|_| vec![random(), 1e-3 * random(), 1e3 * random()]).collect();
        let hull = colliders::<3>(&[values::<3>("convex", &[("points", Value::Rows(points))])]);
        let Picture::Triangles { points, triangles, solid: true } = &hull.pictures(0.0)[0] else { panic!() };
        // Euler: F = 2 V − 4.
        let mut corners: Vec<u32> = triangles.iter().flatten().copied().collect();
        corners.sort_unstable();
        corners.dedup();
        assert_eq!(triangles.len(), 2 * corners.len() - 4);
        assert_eq!(points.len(), count);
    }
    // A grid of points with many of them on faces and edges.
    let grid: Vec<Vec<f64>> =
        (0..125).map(|k| vec![(k % 5) as f64 * 0.1, (k / 5 % 5) as f64 * 0.1, (k / 25) as f64 * 0.1]).collect();
    let cube = values::<3>("convex", &[("points", Value::Rows(grid))]);
    near(after(&cube, [0.2, 0.39, 0.2], [0.0; 3], H).0, [0.2, 0.4, 0.2]);
}
