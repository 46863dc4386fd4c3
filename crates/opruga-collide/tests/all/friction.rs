//! Coulomb friction against closed forms (validation B5).
#![allow(missing_docs)]

use crate::common;
use common::*;
use opruga_core::spec::Values;

const H: f64 = 1.0 / 960.0;

/// A plane that falls to the right at the angle with tan θ = 0.5; in 3D it is also inclined along z.
fn incline<const D: usize>(tangent: f64, friction: f64) -> (Values, [f64; D], [f64; D]) {
    let size = (1.0 + tangent * tangent).sqrt();
    let mut normal = [0.0; D];
    let mut down = [0.0; D];
    (normal[0], normal[1]) = (tangent / size, 1.0 / size);
    (down[0], down[1]) = (1.0 / size, -tangent / size);
    if D == 3 {
        // Rotated by 36.87° about y.
        (normal[2], normal[0]) = (0.6 * normal[0], 0.8 * normal[0]);
        (down[2], down[0]) = (0.6 * down[0], 0.8 * down[0]);
    }
    (values::<D>("half_space", &[("normal", vector(&normal)), ("friction", number(friction))]), normal, down)
}

fn weight<const D: usize>() -> [f64; D] {
    let mut g = [0.0; D];
    g[1] = -G;
    g
}

fn slides<const D: usize>() {
    // a = g (sin θ − µ cos θ), tan θ = ½, µ = 0.49: .0877433 m/s²; s and v after 2.5 s.
    let (plane, _, down) = incline::<D>(0.5, 0.49);
    let mut system = particles(&[[0.0; D]], &[[0.0; D]], 1.0, &[plane]);
    system.gravity = weight();
    run(&mut system, H, 2400);
    let (x, v) = at(&system, 0);
    let (s, speed) = (dot(&x, &down), dot(&v, &down));
    println!("{D}D slide: s {s:.6} ({:+.4} %), v {speed:.6}", 100.0 * (s / 0.274198 - 1.0));
    assert!((s / 0.274198 - 1.0).abs() < 2e-3);
    assert!((speed / 0.219358 - 1.0).abs() < 2e-3);
}
#[test]
fn mu_049_slides_by_the_closed_form() {
    slides::<2>();
    slides::<3>();
}

fn sticks<const D: usize>(tangent: f64) {
    let (plane, _, down) = incline::<D>(tangent, 0.5);
    let mut system = particles(&[[0.0; D]], &[[0.0; D]], 1.0, &[plane]);
    system.gravity = weight();
    run(&mut system, H, 9600);
    let (x, _) = at(&system, 0);
    println!("{D}D stick tan {tangent}: creep {:e}", dot(&x, &down));
    assert!(dot(&x, &down).abs() < 1e-4);
    assert!(x.iter().all(|x| x.abs() < 1e-9));
}
#[test]
fn mu_050_sticks() {
    // An angle of 26.565° is a little below atan ½, so the node sticks. A tangent of exactly ½ is the limit itself.
    for tangent in [0.499_990_2, 0.5] {
        sticks::<2>(tangent);
        sticks::<3>(tangent);
    }
}

#[test]
fn a_dropped_node_sticks_where_it_lands() {
    let (plane, normal, down) = incline::<2>(0.5, 0.6);
    let start = [normal[0] * 1e-3, normal[1] * 1e-3];
    let mut system = particles(&[start], &[[0.0; 2]], 1.0, &[plane]);
    system.gravity = weight();
    run(&mut system, H, 96);
    let landed = dot(&at(&system, 0).0, &down);
    run(&mut system, H, 9600);
    let (x, v) = at(&system, 0);
    assert_eq!(v, [0.0; 2]);
    assert!((dot(&x, &down) - landed).abs() < 1e-12);
}

#[test]
fn sliding_stops_after_the_closed_form() {
    // The node stops after the distance v0²/(2 µ g) and the time v0/(µ g).
    let (v0, mu) = (2.0, 0.3);
    let floor = values::<2>("half_space", &[("normal", vector(&[0.0, 1.0])), ("friction", number(mu))]);
    let mut system = particles(&[[0.0, 0.0]], &[[v0, 0.0]], 3.0, &[floor]);
    system.gravity = weight();
    let mut steps = 0;
    while at(&system, 0).1[0] > 0.0 {
        step(&mut system, H);
        steps += 1;
        assert!(steps < 10_000);
    }
    let (distance, time) = (v0 * v0 / (2.0 * mu * G), v0 / (mu * G));
    let (x, v) = at(&system, 0);
    println!("stop: {:.6} of {distance:.6} m, {:.6} of {time:.6} s", x[0], steps as f64 * H);
    assert!((x[0] / distance - 1.0).abs() < 2e-3);
    assert!((steps as f64 * H - time).abs() < 1.01 * H);
    assert_eq!(v, [0.0, 0.0]);
    // Friction took all of the kinetic energy.
    assert!((sum(&system.work.friction) / (0.5 * 3.0 * v0 * v0) - 1.0).abs() < 1e-12);
}

#[test]
fn a_conveyor_takes_a_node_along() {
    // The floor moves at 1 m/s. The node slides until it has that speed, after the time v/(µ g).
    let floor = values::<2>(
        "half_space",
        &[
            ("normal", vector(&[0.0, 1.0])),
            ("friction", number(0.5)),
            ("motion", rows(&[&[0.0, 0.0, 0.0], &[10.0, 10.0, 0.0]])),
        ],
    );
    let mut system = particles(&[[0.0, 0.0]], &[[0.0, 0.0]], 2.0, &[floor]);
    system.gravity = weight();
    run(&mut system, H, 960);
    let (x, v) = at(&system, 0);
    assert!((v[0] - 1.0).abs() < 1e-12 && v[1] == 0.0);
    // The node is behind the floor by v²/(2 µ g).
    assert!((x[0] - (1.0 - 0.5 / (0.5 * G))).abs() < 2e-3, "{x:?}");
    // The work of the floor is the kinetic energy plus the same amount lost by friction.
    let (work, lost) = (sum(&system.work.user), sum(&system.work.friction));
    assert!((work - 2.0).abs() < 1e-9 && (lost - 1.0).abs() < 2e-2, "{work} {lost}");
}

#[test]
fn a_turntable_holds_a_node_within_the_friction_limit() {
    // If ω² r < µ g, the node moves with the floor at its radius. If ω is larger, the node slides outward.
    let radius = |spin: f64| {
        let table = values::<3>(
            "half_space",
            &[("normal", vector(&[0.0, 1.0, 0.0])), ("friction", number(0.5)), ("spin", vector(&[0.0, spin, 0.0]))],
        );
        let mut system = particles(&[[0.5, 0.0, 0.0]], &[[0.0, 0.0, -0.5 * spin]], 1.0, &[table]);
        system.gravity = weight();
        run(&mut system, H, 1920);
        let x = at(&system, 0).0;
        assert!(x[1].abs() < 1e-9);
        (x[0] * x[0] + x[2] * x[2]).sqrt()
    };
    // The limit of ω is 3.13 rad/s.
    assert!((radius(3.0) - 0.5).abs() < 1e-9, "{}", radius(3.0));
    assert!(radius(3.3) > 0.6, "{}", radius(3.3));
}
