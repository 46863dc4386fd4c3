//! Bodies that touch one another.

use opruga_core::spec::{Value, Values};
use opruga_math::message::Message as _;
use opruga_mesh::Mesh;
use opruga_world::blueprint::*;
use opruga_world::schema::{BODY_CONTACT, CONTACT, CONTACT_PAIR};
use opruga_world::{ContactPhase, Options, Registry, World, WorldError};
use std::sync::Arc;

pub(crate) fn contact<const D: usize>(fields: &[(&str, Value)]) -> Option<ContactBlueprint> {
    let mut values = Values::defaults(CONTACT.spec, D);
    for (name, value) in fields {
        values.set(CONTACT.spec, name, value.clone(), D).expect("a field");
    }
    Some(ContactBlueprint { values, pairs: Vec::new() })
}

pub(crate) fn model<const D: usize>(kind: &str, fields: &[(&str, f64)]) -> Values {
    let fields: Vec<(&str, Value)> = fields.iter().map(|(name, x)| (*name, Value::Number(*x))).collect();
    Registry::<D>::default().model_values(kind, &fields).expect("a model")
}

/// A scene without gravity, stepped by an explicit integrator.
pub(crate) fn scene<const D: usize>(rule: &str, bodies: Vec<BodyBlueprint<D>>) -> Blueprint<D> {
    let registry = Registry::<D>::default();
    let mut scene = Blueprint::new("contact", registry.integrator_values(rule, &[]).expect("a rule"));
    scene.bodies = bodies;
    scene.contact = contact::<D>(&[]);
    scene
}

/// A ball of gas in the plane.
pub(crate) fn ball(name: &str, vertices: u32, x: [f64; 2], v: [f64; 2]) -> BodyBlueprint<2> {
    let ring = Mesh::ring(0.5, vertices, [0.0; 2], 0.0).expect("a ring");
    let models = vec![
        model::<2>("mass_spring", &[("stiffness", 400.0), ("damping", 0.2)]),
        model::<2>("pressure", &[("nRT", 20.0)]),
    ];
    BodyBlueprint { translation: x, velocity: v, ..BodyBlueprint::new(name, ring, Mass::Total(1.0), models) }
}

pub(crate) fn world<const D: usize>(scene: &Blueprint<D>) -> World<D> {
    World::new(scene.clone(), Options::default()).expect("a world")
}

/// The largest depth of a node of one body inside another: by the even-odd rule, measured to the nearest side.
pub(crate) fn deepest(world: &World<2>) -> f64 {
    let bodies: Vec<usize> = (0..world.blueprint().bodies.len()).collect();
    let outline = |b: usize| -> Vec<[[f64; 2]; 2]> {
        let facets = &world.blueprint().bodies[b].mesh.facets;
        facets.iter().map(|f| f.map(|n| world.position(b, n))).collect()
    };
    let outlines: Vec<_> = bodies.iter().map(|b| outline(*b)).collect();
    let mut deepest: f64 = 0.0;
    for a in &bodies {
        for n in 0..world.node_count(*a) as u32 {
            let p = world.position(*a, n);
            for b in bodies.iter().filter(|b| *b != a) {
                let (mut inside, mut least) = (false, f64::INFINITY);
                for [q, r] in &outlines[*b] {
                    if (q[1] > p[1]) != (r[1] > p[1]) {
                        let x = q[0] + (p[1] - q[1]) / (r[1] - q[1]) * (r[0] - q[0]);
                        inside ^= x > p[0];
                    }
                    let t = opruga_collide::closest_on_segment(&p, q, r);
                    let square: f64 =
                        (0..2).map(|d| (p[d] - q[d] - t * (r[d] - q[d])) * (p[d] - q[d] - t * (r[d] - q[d]))).sum();
                    if square < least {
                        least = square;
                    }
                }
                if inside && least.sqrt() > deepest {
                    deepest = least.sqrt();
                }
            }
        }
    }
    deepest
}

#[test]
fn two_balls_meet_and_keep_momentum() {
    for rule in ["symplectic_euler", "verlet", "runge_kutta"] {
        let bodies = vec![ball("a", 36, [-1.0, 0.1], [2.0, 0.0]), ball("b", 36, [1.0, 0.0], [-1.0, 0.3])];
        let mut scene = scene(rule, bodies);
        scene.contact = contact::<2>(&[("friction", 0.4.into())]);
        let mut world = world(&scene);
        let before = world.momentum();
        let mut met = 0.0;
        for _ in 0..60 {
            world.frame().expect("a frame");
            let depth = deepest(&world);
            assert!(depth < 1e-4, "{rule}: {depth} m deep at {} s", world.time());
            let energy = world.energy();
            met = energy.loss_contact + energy.loss_friction;
            assert!(energy.closure < 0.02, "{rule}: {energy:?}");
        }
        let after = world.momentum();
        for d in 0..2 {
            assert!((after.linear.0[d] - before.linear.0[d]).abs() < 1e-12, "{rule}: {before:?} {after:?}");
        }
        assert!(met > 1e-3, "{rule}: they met: {met}");
        let speed = world.velocity(0, 0)[0] - world.velocity(1, 0)[0];
        assert!(speed < 0.0, "{rule}: they part: {speed}");
    }
}

/// Pairs that may meet in later steps do not count against the limit.
#[test]
fn fast_bodies_far_apart_are_within_the_limit_of_pairs() {
    let fast = [0.0, -40.0];
    let mut scene = scene("symplectic_euler", vec![ball("a", 24, [0.0, 0.0], fast), ball("b", 24, [3.0, 0.0], fast)]);
    scene.time = Time { seconds: 1.0, frame: 1.0 / 60.0, substeps: 2 };
    scene.contact = contact::<2>(&[("most_pairs", 100.0.into()), ("self", false.into())]);
    let mut world = world(&scene);
    for _ in 0..5 {
        world.frame().expect("few pairs in each step");
    }
}

/// Each body has its own range, which depends on its edges, and obstacles have none: a fine body or a huge obstacle does not end a frame early.
#[test]
fn ranges_of_other_bodies_and_obstacles_cut_no_frame_short() {
    let fine = |x: f64| {
        let ring = Mesh::ring(1e-3, 36, [0.0; 2], 0.0).expect("a ring");
        let springs = vec![model::<2>("mass_spring", &[("stiffness", 1.0)])];
        BodyBlueprint { translation: [x, 0.0], ..BodyBlueprint::new("fine", ring, Mass::Total(1e-3), springs) }
    };
    let bodies = || vec![fine(0.0), ball("far", 24, [5e6, 0.0], [0.0, 1.0])];
    let height = |contact: Option<ContactBlueprint>, huge: bool| {
        let mut scene = scene("symplectic_euler", bodies());
        scene.time = Time { seconds: 1.0, frame: 1.0 / 60.0, substeps: 8 };
        scene.contact = contact;
        if huge {
            let corners = [("min", Value::Numbers(vec![-1e13, -20.0])), ("max", Value::Numbers(vec![1e13, -10.0]))];
            scene.colliders.push(ColliderBlueprint::new::<2>("box", &corners).expect("a collider"));
        }
        let mut world = world(&scene);
        for _ in 0..6 {
            world.frame().expect("a frame");
        }
        world.position(1, 0)[1]
    };
    let free = height(None, false);
    assert_eq!(height(contact::<2>(&[]), false), free);
    assert_eq!(height(contact::<2>(&[]), true), free);
}

#[test]
fn points_bounce_by_the_restitution() {
    for (restitution, rule) in [(0.0, "symplectic_euler"), (0.5, "symplectic_euler"), (1.0, "verlet")] {
        let point = |name: &str, x: f64, v: f64, mass: f64| {
            let mesh = Mesh::<2>::line([0.0, -0.5], [0.0, 0.5], 1).expect("a wire");
            let springs = vec![model::<2>("mass_spring", &[("stiffness", 100.0)])];
            let body = BodyBlueprint::new(name, mesh, Mass::Total(mass), springs);
            BodyBlueprint { translation: [x, 0.0], velocity: [v, 0.0], ..body }
        };
        let mut scene = scene(rule, vec![point("a", -1.0, 3.0, 1.0), point("b", 0.5, -1.0, 2.0)]);
        scene.contact = contact::<2>(&[("restitution", restitution.into()), ("thickness", 0.01.into())]);
        let mut world = world(&scene);
        (0..60).for_each(|_| world.frame().expect("a frame"));
        let [a, b] = [0, 1].map(|b| world.velocity(b, 0)[0]);
        // Masses 1 and 2 at 3 and −1 m/s: the centre of mass moves at 1/3 m/s.
        let exact = [1.0 / 3.0 - restitution * 8.0 / 3.0, 1.0 / 3.0 + restitution * 4.0 / 3.0];
        assert!((a - exact[0]).abs() < 1e-9 && (b - exact[1]).abs() < 1e-9, "{rule} {restitution}: {a} {b} {exact:?}");
        let lost = 0.5 * 2.0 / 3.0 * 16.0 * (1.0 - restitution * restitution);
        let energy = world.energy();
        assert!((energy.loss_contact - lost).abs() < 1e-9, "{energy:?} {lost}");
        assert!(energy.loss_integrator.abs() < 1e-9, "{energy:?}");
    }
}

/// Whether a point passes through an edge while all three points move uniformly. The area that they span is a quadratic function of time; where it
/// vanishes, the point is on the line of the edge.
pub(crate) fn passes(point: [[f64; 2]; 2], edge: [[[f64; 2]; 2]; 2]) -> bool {
    let at = |x: &[[f64; 2]; 2], t: f64| -> [f64; 2] { core::array::from_fn(|d| x[0][d] + t * (x[1][d] - x[0][d])) };
    let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
    let minus = |a: [f64; 2], b: [f64; 2]| [a[0] - b[0], a[1] - b[1]];
    let area = |t: f64| cross(minus(at(&edge[1], t), at(&edge[0], t)), minus(at(&point, t), at(&edge[0], t)));
    let (start, middle, end) = (area(0.0), area(0.5), area(1.0));
    let (square, linear) = (2.0 * (start + end) - 4.0 * middle, 4.0 * middle - 3.0 * start - end);
    let inner = linear * linear - 4.0 * square * start;
    if inner < 0.0 {
        return false;
    }
    let q = -0.5 * (linear + inner.sqrt().copysign(linear));
    [q / square, start / q].into_iter().filter(|t| (0.0..=1.0).contains(t)).any(|t| {
        let (edge, arm) = (minus(at(&edge[1], t), at(&edge[0], t)), minus(at(&point, t), at(&edge[0], t)));
        let along = (edge[0] * arm[0] + edge[1] * arm[1]) / (edge[0] * edge[0] + edge[1] * edge[1]);
        (0.0..=1.0).contains(&along)
    })
}

/// A thin wire, and a small one that approaches it at a given speed [m/s].
pub(crate) fn wall_and_dot(speed: f64) -> Vec<BodyBlueprint<2>> {
    let wire = Mesh::<2>::line([0.0, -1.0], [0.0, 1.0], 40).expect("a wire");
    let springs = vec![model::<2>("mass_spring", &[("stiffness", 2000.0)])];
    let wall = BodyBlueprint::new("wall", wire, Mass::Total(5.0), springs.clone());
    let dot = Mesh::<2>::line([-0.02, 0.0], [0.02, 0.015], 1).expect("a wire");
    let dot = BodyBlueprint::new("dot", dot, Mass::Total(0.1), springs);
    vec![wall, BodyBlueprint { translation: [-0.3, 0.013], velocity: [speed, 0.0], ..dot }]
}

/// Nothing passes through a thin wire, at up to sixteen edges in a step. Between two steps all points move uniformly.
#[test]
fn fast_bodies_do_not_tunnel() {
    for speed in [1.0, 30.0, 300.0, 3000.0] {
        let mut scene = scene("symplectic_euler", wall_and_dot(speed));
        scene.time.frame = 1.0 / 3840.0;
        scene.time.substeps = 1;
        let mut world = world(&scene);
        let all = |world: &World<2>| -> Vec<[f64; 2]> {
            (0..41).map(|n| world.position(0, n)).chain((0..2).map(|n| world.position(1, n))).collect()
        };
        let mut before = all(&world);
        for step in 0..(if speed < 2.0 { 1920 } else { 256 }) {
            world.frame().expect("a frame");
            let after = all(&world);
            let path = |n: usize| [before[n], after[n]];
            let through = |point: usize, edge: [usize; 2]| passes(path(point), edge.map(path));
            for k in 0..40 {
                for point in [41, 42] {
                    assert!(!through(point, [k, k + 1]), "{speed} m/s, step {step}: {point} through edge {k}");
                }
            }
            for point in 0..41 {
                assert!(!through(point, [41, 42]), "{speed} m/s, step {step}: point {point} through the dot");
            }
            assert_eq!(world.crossed_surfaces(), [], "{speed} m/s, step {step}");
            before = after;
        }
    }
}

/// Two walls that pins move through one another, and a ball between them.
#[test]
fn pins_that_lead_bodies_through_one_another_end_the_run_with_the_pair_and_the_time() {
    let led = |name: &str, x: f64, motion: Vec<Vec<f64>>| {
        let wire = Mesh::<2>::line([x, -1.0], [x, 1.0], 8).expect("a wire");
        let pin = PinBlueprint { select: Selector::All, axes: [true; 2], motion };
        let springs = vec![model::<2>("mass_spring", &[("stiffness", 2000.0)])];
        BodyBlueprint { pins: vec![pin], ..BodyBlueprint::new(name, wire, Mass::Total(1.0), springs) }
    };
    let way = vec![vec![0.0, 0.0, 0.0], vec![1.0, 4.0, 0.0]];
    let mut scene = scene("symplectic_euler", vec![led("left", -1.0, way), led("right", 1.0, Vec::new())]);
    scene.bodies.push(ball("between", 24, [0.0, 0.0], [0.0; 2]));
    let mut world = world(&scene);
    let error = loop {
        if let Err(error) = world.frame() {
            break error;
        }
        assert_eq!(world.crossed_surfaces(), []);
        assert!(world.time() < 1.0, "the walls pass at t = 0.5 s");
    };
    assert_eq!(error.code(), "contact.led_through");
    let WorldError::LedThrough { first, second, time } = &error else { panic!("{error}") };
    assert!([first, second].iter().all(|name| ["left", "right", "between"].contains(&name.as_str())), "{error}");
    assert!(*time <= 0.52, "{error}");
    assert_eq!(world.crossed_surfaces(), [], "the world is at its last good frame");
}

/// Without the section `[contact]` bodies pass through one another, which is reported once.
#[test]
fn bodies_that_pass_through_one_another_without_contact_are_reported_once() {
    let bodies = || vec![ball("a", 24, [-1.5, 0.0], [4.0, 0.0]), ball("b", 24, [1.5, 0.1], [-4.0, 0.0])];
    let mut scene = scene("symplectic_euler", bodies());
    let codes = |scene: &Blueprint<2>| -> Vec<String> {
        let mut world = world(scene);
        for _ in 0..40 {
            world.frame().expect("a frame");
            world.warn_of_missing_contact();
        }
        world.warnings().into_iter().map(|warning| warning.code).filter(|code| code.starts_with("contact")).collect()
    };
    assert_eq!(codes(&scene), [""; 0]);
    scene.contact = None;
    assert_eq!(codes(&scene), ["contact.none"]);
}

/// The same bits on any number of threads, alone or side by side, and after rewinding.
#[test]
fn contact_has_the_same_bits() {
    let mut bodies = Vec::new();
    let first = ball("ball[0]", 24, [0.0, 0.0], [0.0; 2]);
    for k in 0..9 {
        let x = [1.02 * f64::from(k % 3), 1.05 * f64::from(k / 3)];
        bodies.push(BodyBlueprint { name: format!("ball[{k}]"), translation: x, ..first.clone() });
    }
    let mut scene = scene("symplectic_euler", bodies);
    scene.surroundings.gravity = [0.0, -9.81];
    scene.contact = contact::<2>(&[("friction", 0.3.into()), ("restitution", 0.2.into())]);
    let fields =
        |x: [f64; 2], n: [f64; 2]| [("point", Value::Numbers(x.to_vec())), ("normal", Value::Numbers(n.to_vec()))];
    for (x, n) in [([0.0, -0.6], [0.0, 1.0]), ([-0.6, 0.0], [1.0, 0.0]), ([2.7, 0.0], [-1.0, 0.0])] {
        scene.colliders.push(ColliderBlueprint::new::<2>("half_space", &fields(x, n)).expect("a plane"));
    }
    let run = |threads: usize, batches: bool| {
        let mut world = World::new(scene.clone(), Options { threads, batches, ..Options::default() }).expect("a world");
        (0..20).for_each(|_| world.frame().expect("a frame"));
        let kept = world.snapshot();
        (0..20).for_each(|_| world.frame().expect("a frame"));
        let end = world.frame_hash();
        world.restore(&kept).expect("the same scene");
        (0..20).for_each(|_| world.frame().expect("a frame"));
        assert_eq!(world.frame_hash(), end, "{threads} {batches}: after going back");
        let depth = deepest(&world);
        assert!(depth < 1e-3, "{depth} m deep");
        assert!(world.contact_counts().expect("contact").contacts > 1000);
        assert!(world.energy().closure < 0.05, "{:?}", world.energy());
        end
    };
    let one = run(1, true);
    for (threads, batches) in [(2, true), (3, true), (8, true), (1, false), (3, false)] {
        assert_eq!(run(threads, batches), one, "{threads} threads, batches: {batches}");
    }
}

#[test]
fn what_contact_cannot_do_is_refused() {
    let bodies = || vec![ball("a", 12, [-1.0, 0.1], [2.0, 0.0]), ball("b", 12, [1.0, 0.0], [-1.0, 0.3])];
    let mut implicit = scene("equilibrium", bodies());
    for body in &mut implicit.bodies {
        body.pins.push(PinBlueprint { select: Selector::Nodes(vec![0, 1]), axes: [true; 2], motion: Vec::new() });
    }
    assert!(World::new(implicit.clone(), Options::default()).is_ok());
    // Bodies in statics beside moving ones, under a load that is applied in parts.
    let registry = Registry::<2>::default();
    let rule = |name: &str, fields: &[(&str, Value)]| registry.integrator_values(name, fields).expect("a rule");
    let mut mixed = implicit.clone();
    mixed.bodies[1].integrator = Some(rule("verlet", &[]));
    let in_parts = |field: (&str, Value)| Blueprint { integrator: rule("equilibrium", &[field]), ..implicit.clone() };
    let parts = [in_parts(("load_steps", Value::Integer(2))), in_parts(("arc_length", 0.1.into()))];
    for scene in [mixed].into_iter().chain(parts) {
        let error = World::new(scene, Options::default()).expect_err("refused");
        assert_eq!(error.code(), "contact.implicit");
        assert!(error.to_string().contains("body `a`") && error.in_full().contains("hint"), "{error}");
    }
    let mut apart = Values::defaults(BODY_CONTACT.spec, 2);
    apart.set(BODY_CONTACT.spec, "touch", Value::Boolean(false), 2).expect("a field");
    implicit.bodies.iter_mut().for_each(|body| body.contact = Some(apart.clone()));
    assert!(World::new(implicit, Options::default()).is_ok());
    let mut unfolding = scene("symplectic_euler", bodies());
    unfolding.surroundings.unfold = true;
    assert_eq!(World::new(unfolding, Options::default()).expect_err("refused").code(), "contact.unfold");
    let mut many = scene("symplectic_euler", bodies());
    many.contact = contact::<2>(&[("most_pairs", 2.0.into())]);
    let mut world = world(&many);
    let outcome = (0..60).try_for_each(|_| world.frame());
    let error = outcome.expect_err("too many");
    assert_eq!(error.code(), "limit.contacts");
    let kept = world.frame_hash();
    assert_eq!(world.frame().expect_err("again").code(), "limit.contacts");
    assert_eq!(world.frame_hash(), kept, "the world is as it was");
    // A group that does not exist.
    let mut unknown = scene("symplectic_euler", bodies());
    let mut pair = Values::defaults(CONTACT_PAIR.spec, 2);
    pair.set(CONTACT_PAIR.spec, "first", "a".into(), 2).expect("a field");
    pair.set(CONTACT_PAIR.spec, "second", "nobody".into(), 2).expect("a field");
    unknown.contact.as_mut().expect("contact").pairs.push(pair.clone());
    assert_eq!(World::new(unknown.clone(), Options::default()).expect_err("refused").code(), "scene.unknown_name");
    // Two groups that pass through one another.
    pair.set(CONTACT_PAIR.spec, "second", "b".into(), 2).expect("a field");
    pair.set(CONTACT_PAIR.spec, "touch", Value::Boolean(false), 2).expect("a field");
    unknown.contact.as_mut().expect("contact").pairs = vec![pair];
    let mut through = World::new(unknown, Options::default()).expect("a world");
    (0..30).for_each(|_| through.frame().expect("a frame"));
    assert!(deepest(&through) > 0.1);
}

/// A scene without contact and a scene whose bodies never meet have the same bits.
#[test]
fn contact_that_never_happens_changes_nothing() {
    let bodies = vec![ball("a", 12, [-4.0, 0.1], [0.2, 0.0]), ball("b", 24, [4.0, 0.0], [-0.1, 0.3])];
    let with = scene("verlet", bodies);
    let without = Blueprint { contact: None, ..with.clone() };
    let run = |scene: &Blueprint<2>| {
        let mut world = world(scene);
        (0..10).for_each(|_| world.frame().expect("a frame"));
        (0..12).map(|n| world.position(0, n).map(f64::to_bits)).collect::<Vec<_>>()
    };
    assert_eq!(run(&with), run(&without));
}

/// Bodies that start inside one another separate at the recovery speed, and the energy that this takes is recorded.
#[test]
fn overlap_is_taken_apart() {
    let bodies = vec![ball("a", 36, [-0.47, 0.0], [0.0; 2]), ball("b", 36, [0.47, 0.01], [0.0; 2])];
    let mut scene = scene("symplectic_euler", bodies);
    scene.contact = contact::<2>(&[("recovery_speed", 0.2.into())]);
    let mut world = world(&scene);
    assert!(deepest(&world) > 0.05);
    for frame in 0..90 {
        world.frame().expect("a frame");
        let energy = world.energy();
        assert!(energy.kinetic < 20.0 && energy.closure < 0.05, "{frame}: {energy:?}");
    }
    assert!(deepest(&world) < 1e-4, "{}", deepest(&world));
}

/// A fast cube that hits a cloth, both without damping.
fn cube_on_cloth(substeps: u32) -> Blueprint<3> {
    let solid = vec![model::<3>("fem", &[("youngs_modulus", 3000.0), ("poissons_ratio", 0.4)])];
    let springs = vec![model::<3>("mass_spring", &[("stiffness", 400.0)])];
    let cube = Mesh::<3>::grid([-0.4; 3], [0.8; 3], [3; 3]).expect("a grid");
    let cloth = Mesh::sheet([-1.0, 0.05, 1.0], [[2.0, 0.0, 0.0], [0.0, 0.0, -2.0]], [10; 2]).expect("a sheet");
    let cube = BodyBlueprint {
        translation: [0.0, 0.6, 0.0],
        velocity: [0.0, -12.0, 0.0],
        ..BodyBlueprint::new("cube", cube, Mass::Total(4.0), solid)
    };
    let mut scene =
        scene("symplectic_euler", vec![BodyBlueprint::new("cloth", cloth, Mass::Total(0.5), springs), cube]);
    scene.time = Time { seconds: 1.0, frame: 1.0 / 60.0, substeps };
    scene
}

/// Few points are displaced here, so little belongs to `work_correction`. If the energy changes of symplectic Euler in steps with contact counted as
/// corrections, they would no longer cancel those in the other steps, and both channels would be −7 J.
#[test]
fn a_cube_that_carries_a_cloth_with_it_needs_hardly_any_correction() {
    let mut world = world(&cube_on_cloth(20));
    for _ in 0..20 {
        world.frame().expect("a frame");
    }
    let energy = world.energy();
    assert!(energy.loss_contact > 1.0, "they collide: {energy:?}");
    assert!(energy.work_correction.abs() < 1e-3 * energy.in_motion, "{energy:?}");
    assert!(energy.loss_integrator.abs() < 1e-3 * energy.in_motion, "{energy:?}");
}

/// Obstacles stop the nodes of the cloth in the free motion, and the contact with the cube then changes their velocities. If the work of its impulses
/// were computed from the velocities before the obstacle, about 4 J would be missing, whatever the step. Now the missing energy is proportional to the
/// step: 3.3, 1.7 and 0.8 J with 80, 160 and 320 steps.
#[test]
fn energies_add_up_where_a_cube_presses_a_cloth_on_the_floor() {
    let mut scene = cube_on_cloth(320);
    let fields = [("normal", Value::Numbers(vec![0.0, 1.0, 0.0]))];
    scene.colliders.push(ColliderBlueprint::new::<3>("half_space", &fields).expect("a floor"));
    let mut world = world(&scene);
    for _ in 0..10 {
        world.frame().expect("a frame");
    }
    let energy = world.energy();
    assert!(energy.loss_contact > 10.0, "they collide: {energy:?}");
    // Both contain the same energy changes of symplectic Euler at the floor.
    let missing = energy.work_correction - energy.loss_integrator;
    assert!(missing.abs() < 2e-3 * energy.in_motion, "{missing} J: {energy:?}");
}

/// A cube of tetrahedra falls onto another: 3D, with edges.
#[test]
fn cubes_stack() {
    let mesh = Arc::new(Mesh::<3>::grid([0.0; 3], [1.0; 3], [2, 2, 2]).expect("a cube"));
    let rubber = vec![model::<3>("fem", &[("youngs_modulus", 2e4), ("poissons_ratio", 0.3), ("damping", 0.02)])];
    let cube = BodyBlueprint { mesh, ..BodyBlueprint::new("cube", Mesh::default(), Mass::Total(8.0), rubber) };
    let place = |name: &str, x: [f64; 3]| BodyBlueprint { name: name.into(), translation: x, ..cube.clone() };
    let bodies = vec![place("low", [0.0; 3]), place("high", [0.21, 1.05, 0.13]), place("top", [0.0, 2.1, 0.0])];
    let mut scene = scene("symplectic_euler", bodies);
    scene.surroundings.gravity = [0.0, -9.81, 0.0];
    scene.contact = contact::<3>(&[("friction", 0.5.into())]);
    let fields = [("normal", Value::Numbers(vec![0.0, 1.0, 0.0])), ("friction", 0.5.into())];
    scene.colliders.push(ColliderBlueprint::new::<3>("half_space", &fields).expect("a floor"));
    let mut world = world(&scene);
    for _ in 0..180 {
        world.frame().expect("a frame");
    }
    let low = |body: usize| {
        let all = (0..27).map(|n| world.position(body, n)[1]);
        all.fold(f64::INFINITY, |least, y| if y < least { y } else { least })
    };
    assert!((low(1) - 1.0).abs() < 0.05 && (low(2) - 2.0).abs() < 0.1, "{} {}", low(1), low(2));
    assert!(world.energy().kinetic < 1e-3, "{:?}", world.energy());
}

/// Two balls meet and separate: the contact begins once and ends once, and its impulses equal the change of momentum, on any number of threads.
#[test]
fn contacts_begin_persist_and_end() {
    let mut seen = Vec::new();
    for threads in [1, 3] {
        let bodies = vec![ball("a", 36, [-0.8, 0.1], [2.0, 0.0]), ball("b", 36, [0.8, 0.0], [-1.0, 0.0])];
        let mut scene = scene("symplectic_euler", bodies);
        scene.contact = contact::<2>(&[("friction", 0.4.into()), ("self", false.into())]);
        let mut world = World::new(scene, Options { threads, ..Default::default() }).expect("a world");
        world.frame().expect("a frame");
        assert_eq!(world.contacts(), [], "nobody asked");
        world.report_contacts(true);
        let momentum = |world: &World<2>| -> [f64; 2] {
            let nodes = world.node_count(0);
            let mass = world.blueprint().bodies[0].mesh.positions.len() as f64;
            core::array::from_fn(|d| (0..nodes as u32).map(|n| world.velocity(0, n)[d] / mass).sum())
        };
        let (mut phases, mut all) = (Vec::new(), Vec::new());
        for _ in 0..90 {
            let before = momentum(&world);
            world.frame().expect("a frame");
            let after = momentum(&world);
            let impulse = world.contacts().first().map_or([0.0; 2], |contact| contact.impulse);
            for d in 0..2 {
                assert!(
                    (after[d] - before[d] - impulse[d]).abs() < 1e-12,
                    "{before:?} {after:?} {:?}",
                    world.contacts()
                );
            }
            for contact in world.contacts() {
                assert_eq!(contact.bodies, [0, 1]);
                assert!(contact.normal[0] < -0.9 && contact.position[0].abs() < 1.0, "{contact:?}");
                assert_eq!(contact.pressed > 0.0, contact.phase != ContactPhase::Ended, "{contact:?}");
                phases.push(contact.phase);
                all.push(*contact);
            }
        }
        let (first, last) = (phases.first(), phases.last());
        assert_eq!((first, last), (Some(&ContactPhase::Began), Some(&ContactPhase::Ended)), "{phases:?}");
        for pair in phases.windows(2) {
            assert_eq!(pair[1] == ContactPhase::Began, pair[0] == ContactPhase::Ended, "{phases:?}");
        }
        assert!(phases.contains(&ContactPhase::Persists), "{phases:?}");
        seen.push(all);
    }
    assert_eq!(seen[0], seen[1]);
}

/// A ball that lies on another one presses on it with its weight: the contact forces on its nodes show it, and those on the other ball are opposite.
#[test]
fn forces_of_contact_carry_what_lies_on_a_body() {
    let lower = BodyBlueprint { pins: vec![], ..ball("lower", 36, [0.0, 0.5], [0.0; 2]) };
    let mut scene = scene("symplectic_euler", vec![lower, ball("upper", 36, [0.0, 1.5], [0.0; 2])]);
    scene.surroundings.gravity = [0.0, -9.81];
    scene.surroundings.drag = 5.0;
    let fields = [("point", Value::Numbers(vec![0.0; 2])), ("normal", Value::Numbers(vec![0.0, 1.0]))];
    scene.colliders.push(ColliderBlueprint::new::<2>("half_space", &fields).expect("a plane"));
    for side in [-0.55, 0.55] {
        let fields = [("point", Value::Numbers(vec![side, 0.0])), ("normal", Value::Numbers(vec![-side / 0.55, 0.0]))];
        scene.colliders.push(ColliderBlueprint::new::<2>("half_space", &fields).expect("a wall"));
    }
    let mut world = world(&scene);
    (0..240).for_each(|_| world.frame().expect("a frame"));
    let sum = |forces: Vec<[f64; 2]>| forces.iter().fold(0.0, |sum, f| sum + f[1]);
    let (below, above) = (sum(world.contact_forces(0)), sum(world.contact_forces(1)));
    // The floor supports both balls, and the lower ball supports the upper one.
    assert!((above - 9.81).abs() < 0.5, "the lower ball carries the upper one: {above} N");
    assert!((below - 9.81).abs() < 0.5, "from the floor two weights, from above one: {below} N");
    let kept = world.snapshot();
    world.restore(&kept).expect("its own snapshot");
    assert!(sum(world.contact_forces(1)).abs() < 1e-9, "nothing is known of a step that was not made");
}

/// Contact settings can change during a run; snapshots include them.
#[test]
fn contact_changes_while_bodies_move() {
    let bodies = vec![ball("a", 24, [-0.52, 0.1], [0.4, 1.0]), ball("b", 24, [0.52, 0.0], [-0.4, 0.0])];
    let mut scene = scene("symplectic_euler", bodies);
    scene.contact = contact::<2>(&[("friction", 0.0.into())]);
    let mut smooth = world(&scene);
    let mut rough = world(&scene);
    (0..5).for_each(|_| rough.frame().expect("a frame"));
    (0..5).for_each(|_| smooth.frame().expect("a frame"));
    rough.set("contact.friction", 0.9.into()).expect("a parameter");
    assert_eq!(rough.blueprint().contact.as_ref().and_then(|contact| contact.values.number("friction")), Some(0.9));
    let kept = rough.snapshot();
    for world in [&mut smooth, &mut rough] {
        (0..30).for_each(|_| world.frame().expect("a frame"));
    }
    assert_eq!(smooth.energy().loss_friction, 0.0);
    assert!(rough.energy().loss_friction > 1e-3, "{:?}", rough.energy());
    let end = rough.frame_hash();
    // Restored in the same world, and in a world of the original scene.
    for world in [&mut rough, &mut smooth] {
        world.restore(&kept).expect("a snapshot of the scene");
        (0..30).for_each(|_| world.frame().expect("a frame"));
        assert_eq!(world.frame_hash(), end);
    }
    let refused = smooth.set("contact.friction", Value::Number(-1.0)).expect_err("refused");
    assert!(refused.in_full().contains("allowed"), "{refused}");
    scene.contact = None;
    let refused = world(&scene).set("contact.friction", 0.5.into()).expect_err("refused");
    assert!(refused.to_string().contains("[contact]"), "{refused}");
}
