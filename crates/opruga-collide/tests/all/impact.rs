//! Restitution, energy and rest.
#![allow(missing_docs)]

use crate::common;
use common::*;
use opruga_core::contacts::{Contacts, Moved};
use opruga_core::spec::{Value, Values};
use opruga_core::state::{Columns, Layout, Parameter};
use opruga_math::{Lane, Simd, WIDTH};

const H: f64 = 1.0 / 960.0;

fn floor(fields: &[(&str, Value)]) -> Values {
    let mut all = vec![("normal", vector(&[0.0, 1.0]))];
    all.extend_from_slice(fields);
    values::<2>("half_space", &all)
}

/// The energies that the pass takes and gives equal the change of kinetic energy, for any shape, motion and state (no force
/// acts).
fn one_pass<const D: usize>(
    list: &[Values],
    x: &[[f64; D]],
    v: &[[f64; D]],
    h: f64,
    time: f64,
) -> (Columns<D>, Columns<D>, f64) {
    let places = Layout::Single.index_count(x.len());
    let (mut cx, mut cv) = (Columns::zeros(places), Columns::zeros(places));
    let mut before: Vec<Vec<f64>> = vec![vec![0.0; places]; D];
    for (k, (x, v)) in x.iter().zip(v).enumerate() {
        cv.set(k, *v);
        for d in 0..D {
            before[d][k] = x[d];
            cx.0[d][k] = x[d] + h * v[d];
        }
    }
    let mass = Parameter::column((0..places).map(|k| 1.0 + 0.25 * k as f64).collect());
    let energy = |v: &Columns<D>| (0..x.len()).map(|k| 0.5 * mass.at(k) * dot(&v.at(k), &v.at(k))).sum::<f64>();
    let start = energy(&cv);
    let (mut contact, mut friction, mut work, mut correction) =
        ([0.0; WIDTH], [0.0; WIDTH], [0.0; WIDTH], [0.0; WIDTH]);
    let none = vec![0.0; places + WIDTH];
    let mut moved = Moved {
        range: 0..places,
        padding_start: x.len(),
        before: core::array::from_fn(|d| before[d].as_slice()),
        x: &mut cx,
        v: &mut cv,
        force: core::array::from_fn(|_| none.as_slice()),
        mass: &mass,
        layout: Layout::Single,
        time,
        h,
        loss_contact: &mut contact,
        loss_friction: &mut friction,
        work_colliders: &mut work,
        work_correction: &mut correction,
    };
    colliders::<D>(list).resolve(Simd::best(), &mut moved);
    let change = energy(&cv) - start;
    let entered = sum(&work) - sum(&contact) - sum(&friction);
    assert!((change - entered).abs() < 1e-12 * (1.0 + start), "{change} {entered}");
    assert!(contact.iter().chain(&friction).all(|l| *l >= 0.0));
    (cx, cv, change)
}

#[test]
fn a_ball_bounces_back_with_its_fraction_of_speed() {
    for e in [0.0, 0.3, 1.0] {
        let (_, v, change) =
            one_pass::<2>(&[floor(&[("restitution", number(e))])], &[[0.0, 1e-3]], &[[0.7, -2.0]], H, H);
        assert_eq!(v.at(0)[0], 0.7);
        assert!((v.at(0)[1] - 2.0 * e).abs() < 1e-15);
        assert!((change + 0.5 * 4.0 * (1.0 - e * e)).abs() < 1e-14);
    }
}

#[test]
fn the_floor_of_the_thesis() {
    // The axis y points down, and the floor is at y = 500. The rule of the thesis replaces v_y by −½ v_y when the node crosses
    // y = 500, even if it lies on the floor.
    let plane = values::<2>(
        "half_space",
        &[
            ("point", vector(&[0.0, 500.0])),
            ("normal", vector(&[0.0, -1.0])),
            ("restitution", number(0.5)),
            ("rest_speed", number(0.0)),
        ],
    );
    let mut system = particles(&[[200.0, 495.0]], &[[3.0, 0.0]], 1.0, &[plane]);
    system.gravity = [0.0, 100.0];
    let (h, mut y, mut v) = (0.01, 495.0, 0.0);
    for k in 0..2000 {
        step(&mut system, h);
        v += h * 100.0;
        y += h * v;
        if y > 500.0 {
            y = 500.0;
            v *= -0.5;
        }
        let (x, w) = at(&system, 0);
        assert!((x[1] - y).abs() < 1e-9 && (w[1] - v).abs() < 1e-9, "step {k}: {x:?} {w:?}, thesis {y} {v}");
        assert!(x[1] <= 500.0 && w[0] == 3.0);
    }
}

#[test]
fn heights_fall_by_the_square_of_the_restitution() {
    let e: f64 = 0.8;
    let mut system = particles(&[[0.0, 1.0]], &[[0.0, 0.0]], 1.0, &[floor(&[("restitution", number(e))])]);
    system.gravity = [0.0, -G];
    let (h, mut top, mut tops, mut last) = (1e-5, 0.0f64, vec![], 0.0);
    for _ in 0..400_000 {
        step(&mut system, h);
        let (x, v) = at(&system, 0);
        if last < 0.0 && v[1] > 0.0 {
            tops.push(top);
            top = 0.0;
        }
        if last > 0.0 || v[1] > 0.0 {
            top = if x[1] > top { x[1] } else { top };
        }
        last = v[1];
    }
    assert!(tops.len() > 3);
    for (k, top) in tops.iter().enumerate().take(6).skip(1) {
        let expected = (0..2 * k).fold(1.0, |p, _| p * e);
        assert!((top / expected - 1.0).abs() < 1e-3, "{tops:?}");
    }
}

/// The floor returns e² of ½ m s², with s² = u² + 2 a g from the speed u and the gap g before the step: a force that acts in the
/// rest of the step creates no energy. A node whose position lags, as with symplectic Euler, arrives with less energy.
#[test]
fn an_impact_gives_back_no_more_than_came_in_while_a_force_pushes() {
    let (h, mass) = (0.01, 3.0);
    for e in [0.3, 1.0] {
        for pull in [-20.0, 0.0, 9.81, 400.0] {
            for (speed, share) in [(1.0, 0.05), (1.0, 0.5), (1.0, 0.95), (0.3, 0.5)] {
                let (end, floor) = (speed + h * pull, [floor(&[("restitution", number(e))])]);
                let gap = share * h * end;
                let mut system = particles(&[[0.0, gap]], &[[0.0, -speed]], mass, &floor);
                system.gravity = [0.0, -pull];
                step(&mut system, h);
                let (x, v) = at(&system, 0);
                let square = speed * speed + 2.0 * pull * gap;
                let most = speed.larger(end);
                let reached = (most * most).smaller(square);
                let expected = 0.5 * mass * e * e * reached;
                let kinetic = 0.5 * mass * v[1] * v[1];
                let told = format!("e = {e}, pull {pull}, speed {speed}, share {share}: {kinetic} of {expected}");
                assert!(x[1] == 0.0 && v[1] > 0.0 && (kinetic / expected - 1.0).abs() < 1e-12, "{told}");
                let taken = sum(&system.work.contact) - sum(&system.work.correction);
                assert!(taken > -1e-12 * mass * square, "{told}: {taken}");
                assert!(
                    (taken - 0.5 * mass * (square - e * e * reached)).abs() < 1e-12 * mass * square,
                    "{told}: {taken}"
                );
            }
        }
    }
}

#[test]
fn a_bouncing_node_comes_to_rest() {
    // Restitution 0.9 and a step as long as a frame: weight adds 0.16 m/s per step, more than the rest speed.
    let mut system = particles(&[[0.0, 0.3]], &[[0.0, 0.0]], 1.0, &[floor(&[("restitution", number(0.9))])]);
    system.gravity = [0.0, -G];
    run(&mut system, 1.0 / 60.0, 60 * 60);
    assert_eq!(at(&system, 0), ([0.0, 0.0], [0.0, 0.0]));
}

#[test]
fn the_energy_of_a_pass_is_accounted_for() {
    let mut seed = 7u64;
    let mut random = move || {
        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (seed >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
    };
    let x: Vec<[f64; 3]> = (0..61).map(|_| [random(), random(), random()]).collect();
    let v: Vec<[f64; 3]> = (0..61).map(|_| [3.0 * random(), 3.0 * random(), 3.0 * random()]).collect();
    let law = |e: f64, mu: f64| {
        vec![
            ("restitution", number(e)),
            ("friction", number(mu)),
            ("spin", vector(&[0.4, -1.0, 2.0])),
            ("motion", rows(&[&[0.0, 0.0, 0.0, 0.0], &[1.0, 1.0, 2.0, -1.0]])),
        ]
    };
    for (kind, own) in [
        ("half_space", vec![("normal", vector(&[0.2, 1.0, -0.3]))]),
        (
            "box",
            vec![
                ("center", vector(&[0.0, 0.1, 0.0])),
                ("size", vector(&[1.0, 1.2, 0.8])),
                ("rotation", vector(&[0.1, 0.5, 0.2])),
            ],
        ),
        ("box", vec![("min", vector(&[-0.7; 3])), ("max", vector(&[0.8; 3])), ("inside", Value::Boolean(true))]),
        ("ball", vec![("radius", number(0.8))]),
        ("ball", vec![("radius", number(0.8)), ("inside", Value::Boolean(true))]),
        ("capsule", vec![("a", vector(&[-0.5, 0.0, 0.1])), ("b", vector(&[0.5, 0.2, 0.0])), ("radius", number(0.4))]),
        (
            "convex",
            vec![(
                "points",
                rows(&[
                    &[0.9, 0.0, 0.0],
                    &[-0.9, 0.0, 0.1],
                    &[0.0, 0.9, 0.0],
                    &[0.0, -0.9, 0.0],
                    &[0.0, 0.1, 0.9],
                    &[0.0, 0.0, -0.9],
                ]),
            )],
        ),
        (
            "triangle_mesh",
            vec![
                ("points", rows(&[&[-2.0, 0.0, -2.0], &[2.0, 0.0, -2.0], &[0.0, 0.1, 2.0]])),
                ("triangles", Value::Integers(vec![0, 1, 2])),
                ("thickness", number(0.2)),
            ],
        ),
    ] {
        for (e, mu) in [(0.0, 0.0), (0.6, 0.0), (0.0, 0.4), (0.5, 0.3), (1.0, 5.0)] {
            let mut fields = own.clone();
            fields.extend(law(e, mu));
            let (after, _, change) = one_pass::<3>(&[values::<3>(kind, &fields)], &x, &v, 0.01, 0.5);
            assert!(change != 0.0 && after.0.iter().flatten().all(|x| x.is_finite()), "{kind}");
        }
    }
}

#[test]
fn a_piston_pushes_and_its_work_is_the_energy() {
    // A wall at 2 m/s meets a node at rest. With e = 1, the node leaves at 4 m/s.
    let wall = values::<2>(
        "box",
        &[
            ("min", vector(&[-1.0, -1.0])),
            ("max", vector(&[0.0, 1.0])),
            ("restitution", number(1.0)),
            ("motion", rows(&[&[0.0, 0.0, 0.0], &[1.0, 2.0, 0.0]])),
        ],
    );
    let mut system = particles(&[[0.5, 0.0]], &[[0.0, 0.0]], 3.0, &[wall]);
    run(&mut system, H, 480);
    let (x, v) = at(&system, 0);
    assert!((v[0] - 4.0).abs() < 1e-12 && v[1] == 0.0, "{v:?}");
    assert!((x[0] - (0.5 + 4.0 * 0.25)).abs() < 4.0 * 2.0 * H, "{x:?}");
    assert!((sum(&system.work.user) - 24.0).abs() < 1e-11);
    assert_eq!(sum(&system.work.contact), 0.0);
}

#[test]
fn nodes_settle_in_a_corner() {
    // A container tilted by 30°: nodes slide into its lowest corner, stay within both walls, and lie still. 2D and 3D.
    let container = values::<2>(
        "box",
        &[
            ("center", vector(&[0.0, 0.0])),
            ("size", vector(&[2.0, 2.0])),
            ("rotation", number(0.5235987755982988)),
            ("inside", Value::Boolean(true)),
            ("restitution", number(0.4)),
            ("friction", number(0.1)),
        ],
    );
    let start: Vec<[f64; 2]> = (0..9).map(|k| [0.1 * k as f64 - 0.4, 0.05 * k as f64]).collect();
    let mut system = particles(&start, &[[1.0, 0.5]; 9], 1.0, std::slice::from_ref(&container));
    system.gravity = [0.0, -G];
    run(&mut system, H, 960 * 20);
    let (sin, cos) = (0.5, 0.75f64.sqrt());
    for node in 0..9 {
        let (x, v) = at(&system, node);
        let local = [cos * x[0] + sin * x[1], cos * x[1] - sin * x[0]];
        assert!((local[0] + 1.0).abs() < 1e-12 && (local[1] + 1.0).abs() < 1e-12, "{local:?}");
        assert!(v[0].abs() + v[1].abs() < 1e-12, "{v:?}");
    }
    let room = values::<3>(
        "box",
        &[("min", vector(&[-1.0; 3])), ("max", vector(&[1.0; 3])), ("inside", Value::Boolean(true))],
    );
    let mut system = particles(&[[0.3, 0.1, -0.2], [5.0, -7.0, 3.0]], &[[0.0; 3]; 2], 1.0, &[room]);
    system.gravity = [-4.0, -9.0, 2.0];
    run(&mut system, H, 4800);
    for node in 0..2 {
        assert_eq!(at(&system, node), ([-1.0, -1.0, 1.0], [0.0; 3]));
    }
}

#[test]
fn an_acute_wedge_of_two_planes_holds() {
    // Two planes at 60°: normals (±cos 30°, sin 30°).
    let side = |s: f64| {
        values::<2>("half_space", &[("normal", vector(&[s * 0.75f64.sqrt(), 0.5])), ("friction", number(0.2))])
    };
    let mut system = particles(&[[0.2, 1.0]], &[[0.0, 0.0]], 1.0, &[side(1.0), side(-1.0)]);
    system.gravity = [0.0, -G];
    run(&mut system, H, 9600);
    let (x, v) = at(&system, 0);
    println!("wedge: {x:?} {v:?}");
    assert!(x[0].abs() < 1e-3 && x[1].abs() < 1e-3 && v[0].abs() + v[1].abs() < 0.05);
}
