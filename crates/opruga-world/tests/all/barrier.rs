//! The response `barrier`: forces that grow without bound as a gap closes.

use crate::contact::{ball, contact, model, scene, wall_and_dot, world};
use crate::implicit_contact::{force_on, heavy, square_over_a_box};
use opruga_core::spec::Value;
use opruga_mesh::Mesh;
use opruga_world::blueprint::*;
use opruga_world::error::Crossing;
use opruga_world::{Options, World, WorldError};

const RULES: [&str; 4] = ["backward_euler", "bdf2", "implicit_midpoint", "newmark"];

/// A solid rectangle of triangles.
fn block(name: &str, size: [f64; 2], cells: [u32; 2], x: [f64; 2], mass: f64, youngs_modulus: f64) -> BodyBlueprint<2> {
    let mesh = Mesh::grid([0.0; 2], size, cells).expect("a grid");
    let material = [("youngs_modulus", youngs_modulus), ("poissons_ratio", 0.3)];
    let solid = vec![model::<2>("fem", &material)];
    BodyBlueprint { translation: x, ..BodyBlueprint::new(name, mesh, Mass::Total(mass), solid) }
}

fn pinned(side: &str, body: BodyBlueprint<2>) -> BodyBlueprint<2> {
    let pin = PinBlueprint { select: Selector::Side(side.into()), axes: [true; 2], motion: Vec::new() };
    BodyBlueprint { pins: vec![pin], ..body }
}

/// A block that falls onto a pinned one rests there under its weight, at a distance below the reach.
#[test]
fn a_block_rests_on_another_one_by_its_weight() {
    for rule in RULES {
        let below = pinned("bottom", block("below", [2.0, 0.5], [9, 3], [-0.5, -0.5], 2.0, 1e5));
        let bodies = vec![below, block("above", [1.0, 1.0], [4, 4], [0.03, 0.05], 1.0, 1e5)];
        let mut scene = heavy(rule, bodies, 1);
        scene.contact = contact::<2>(&[("response", "barrier".into()), ("friction", 0.4.into())]);
        let mut world = world(&scene);
        for _ in 0..180 {
            world.frame().unwrap_or_else(|error| panic!("{rule}: {error}"));
            assert_eq!(world.crossed_surfaces(), [], "{rule} at {} s", world.time());
        }
        let weight = force_on(&mut world, 1);
        assert!((weight[1] - 9.81).abs() < 1e-3 && weight[0].abs() < 1e-3, "{rule}: {weight:?}");
        let energy = world.energy();
        assert!(energy.kinetic < 1e-6, "{rule}: {energy:?}");
        assert!(energy.closure < 1e-4, "{rule}: {energy:?}");
    }
}

/// Free bodies that meet keep their momentum and separate, without a gain of energy.
#[test]
fn bodies_keep_momentum_and_part() {
    for rule in RULES {
        let [a, b] = [([-1.2, 0.1], [2.0, 0.0]), ([1.0, 0.0], [-1.0, 0.3])];
        let square = block("b", [1.0, 1.0], [3, 3], [b.0[0] - 0.5, b.0[1] - 0.5], 2.0, 3e3);
        let bodies = vec![ball("a", 24, a.0, a.1), BodyBlueprint { velocity: b.1, ..square }];
        let mut scene = scene(rule, bodies);
        scene.time = Time { seconds: 2.0, frame: 1.0 / 60.0, substeps: 4 };
        scene.contact = contact::<2>(&[("response", "barrier".into()), ("friction", 0.4.into())]);
        let mut world = world(&scene);
        let before = world.momentum();
        for _ in 0..60 {
            world.frame().unwrap_or_else(|error| panic!("{rule}: {error}"));
            assert_eq!(world.crossed_surfaces(), [], "{rule}");
            assert!(world.energy().closure < 0.02, "{rule}: {:?}", world.energy());
        }
        let after = world.momentum();
        for d in 0..2 {
            let change = (after.linear.0[d] - before.linear.0[d]).abs();
            assert!(change < 1e-6, "{rule}: {change} {before:?} {after:?}");
        }
        let mean = |body: usize| {
            let nodes = world.node_count(body) as u32;
            (0..nodes).map(|n| world.velocity(body, n)[0]).sum::<f64>() / f64::from(nodes)
        };
        assert!(mean(0) < mean(1), "{rule}: they part: {} {}", mean(0), mean(1));
    }
}

/// A body that is pushed off its course meets others within the same frame.
#[test]
fn a_body_that_is_hit_meets_the_next_one_within_the_frame() {
    let bodies = vec![
        ball("a", 24, [-1.2, 0.0], [8.0, 0.0]),
        ball("b", 24, [0.0, 0.0], [0.0; 2]),
        ball("c", 24, [4.0, 0.0], [0.0; 2]),
    ];
    let mut scene = scene("backward_euler", bodies);
    scene.time = Time { seconds: 1.0, frame: 1.0, substeps: 120 };
    scene.contact = contact::<2>(&[("response", "barrier".into())]);
    let mut world = world(&scene);
    world.frame().expect("a frame");
    assert_eq!(world.crossed_surfaces(), []);
    let mean = (0..24).map(|node| world.velocity(2, node)[0]).sum::<f64>() / 24.0;
    assert!(mean > 1.0, "{mean}");
}

/// A small body that moves many times its size in a step does not pass through a thin wall. If no end of the step is found, nothing has moved.
#[test]
fn fast_bodies_do_not_tunnel() {
    for speed in [1.0, 30.0, 300.0, 3000.0] {
        let mut scene = scene("backward_euler", wall_and_dot(speed));
        scene.time.frame = 1.0 / 960.0;
        scene.time.substeps = 1;
        scene.contact = contact::<2>(&[("response", "barrier".into())]);
        let mut world = world(&scene);
        for step in 0..(if speed < 2.0 { 480 } else { 64 }) {
            let before = world.position(1, 0);
            if let Err(error) = world.frame() {
                assert!(speed > 1000.0, "{speed}: {error}");
                assert_eq!(world.position(1, 0), before);
                break;
            }
            assert_eq!(world.crossed_surfaces(), [], "{speed} m/s, step {step}");
        }
    }
}

/// A block on a slope that friction just holds does not creep; one that friction does not hold slides according to Coulomb's law.
#[test]
fn what_sticks_on_a_body_does_not_creep() {
    let slope = 0.5_f64;
    let along = [1.0 / (1.0 + slope * slope).sqrt(), -slope / (1.0 + slope * slope).sqrt()];
    for (friction, sticks) in [(0.52, true), (0.4, false)] {
        let base = pinned("bottom", block("base", [6.0, 0.5], [12, 2], [-1.0, -0.5], 10.0, 1e7));
        let mut scene =
            heavy("backward_euler", vec![base, block("rider", [0.5, 0.5], [2, 2], [0.1, 0.011], 1.0, 1e7)], 1);
        // Gravity is rotated instead of the slope.
        scene.surroundings.gravity = [-9.81 * along[1], -9.81 * along[0]];
        scene.contact = contact::<2>(&[("response", "barrier".into()), ("friction", friction.into())]);
        let mut world = world(&scene);
        let mean = |world: &World<2>| (0..9).map(|node| world.position(1, node)[0]).sum::<f64>() / 9.0;
        for _ in 0..60 {
            world.frame().expect("a frame");
        }
        let (start, v0) = (mean(&world), world.velocity(1, 4)[0]);
        for _ in 0..60 {
            world.frame().expect("a frame");
        }
        let way = mean(&world) - start;
        if sticks {
            assert!(way.abs() < 1e-5, "{friction}: crept {way} m in a second");
        } else {
            let wanted = v0 + 0.5 * 9.81 * along[0] * (slope - friction);
            assert!((way - wanted).abs() < 0.02 * wanted, "{friction}: {way} m, {wanted}");
        }
    }
}

/// A square of springs falls onto its corner, where springs buckle sideways.
#[test]
fn bodies_that_buckle_find_an_end() {
    let mut world = world(&square_over_a_box("barrier"));
    for _ in 0..30 {
        world.frame().unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(world.crossed_surfaces(), [], "at {} s", world.time());
    }
}

/// Bodies at rest reach their common equilibrium with a barrier. Each is supported against its weight, at the position that a constraint would give.
#[test]
fn stacks_come_to_their_balance() {
    for (bodies, friction) in [(2, 0.0), (2, 0.5), (3, 0.3), (3, 0.5), (3, 0.8)] {
        let scene = crate::rest_together::high_stack(bodies, friction);
        let by = |response: &str| {
            let mut scene = scene.clone();
            scene.contact = contact::<2>(&[("response", response.into()), ("friction", friction.into())]);
            let mut world = world(&scene);
            world.frame().unwrap_or_else(|error| panic!("{response}, {bodies}, {friction}: {error}"));
            assert_eq!(world.crossed_surfaces(), []);
            world
        };
        let mut still = by("barrier");
        let weights = [-9.81 * if bodies == 2 { 400.0 } else { 500.0 }, 9.81 * 400.0, 9.81 * 100.0];
        for (body, wanted) in weights.into_iter().take(bodies).enumerate() {
            let force = force_on(&mut still, body);
            let wrong = ((force[1] - wanted).abs() + force[0].abs()) / wanted.abs();
            assert!(wrong < 1e-6, "{bodies}, {friction}: {body}: {force:?} instead of {wanted}");
        }
        // With friction there are many equilibria.
        if friction == 0.0 {
            let change = (still.position(1, 40)[1] - by("constraint").position(1, 40)[1]).abs();
            assert!(change < 2e-3, "{change}");
        }
        // A second frame changes nothing.
        let before = still.position(1, 40);
        still.frame().expect("the same balance");
        let change = (still.position(1, 40)[1] - before[1]).abs();
        assert!(change < 1e-5 && still.energy().closure < 1e-9, "{change} {:?}", still.energy());
    }
}

/// If the end of a substep is not found and the scene allows it, all bodies of the cluster make the substep in halves.
#[test]
fn substeps_without_an_end_are_halved_where_that_is_asked_for() {
    let fall = |otherwise: &str| {
        let below = pinned("bottom", block("below", [2.0, 0.5], [9, 3], [-0.5, -0.5], 2.0, 1e4));
        let above = block("above", [1.0, 1.0], [4, 4], [0.03, 0.05], 1.0, 1e4);
        let mut scene = heavy("backward_euler", vec![below, BodyBlueprint { velocity: [0.0, -10.0], ..above }], 1);
        let fields = [("iterations", Value::Integer(8)), ("when_not_converged", otherwise.into())];
        scene.integrator =
            opruga_world::Registry::<2>::default().integrator_values("backward_euler", &fields).expect("a rule");
        scene.contact = contact::<2>(&[("response", "barrier".into())]);
        let mut world = world(&scene);
        let outcome = (0..20).try_for_each(|_| world.frame());
        (world, outcome)
    };
    let (world, outcome) = fall("error");
    assert!(outcome.is_err(), "{:?}", world.energy());
    let (world, outcome) = fall("halve");
    outcome.expect("halves have an end");
    assert_eq!(world.crossed_surfaces(), []);
    assert!((world.time() - 20.0 / 60.0).abs() < 1e-12, "{}", world.time());
    assert!(world.energy().closure < 1e-3, "{:?}", world.energy());
    assert!(world.warnings().iter().any(|warning| warning.code == "step.halved"), "{:?}", world.warnings());
}

#[test]
fn a_barrier_refuses_explicit_rules_and_surfaces_that_meet() {
    let bodies = |at: f64| {
        vec![block("a", [1.0; 2], [2; 2], [0.0; 2], 1.0, 1e4), block("b", [1.0; 2], [2; 2], [at, 0.3], 1.0, 1e4)]
    };
    let with = |rule: &str, at: f64| {
        let mut scene = heavy(rule, bodies(at), 1);
        scene.contact = contact::<2>(&[("response", "barrier".into())]);
        scene
    };
    let refused = World::new(with("verlet", 1.5), Options::default()).expect_err("an explicit rule");
    assert!(refused.to_string().contains("barrier"), "{refused}");
    let error = World::new(with("backward_euler", 0.9), Options::default()).expect_err("they cross");
    let crosses =
        |crossing: &Crossing| matches!(crossing, Crossing::Between { body, other, .. } if body == "a" && other == "b");
    assert!(matches!(&error, WorldError::Cross { crossing, pairs: 1, .. } if crosses(crossing)), "{error}");
    // A program can also move a body into another one between two frames.
    let mut world = world(&with("backward_euler", 1.5));
    for node in 0..world.node_count(1) as u32 {
        let [x, y] = world.position(1, node);
        world.set_node(1, node, [x - 0.6, y], [0.0; 2]).expect("a node");
    }
    let before = world.position(0, 0);
    let error = world.frame().expect_err("they cross");
    assert!(matches!(&error, WorldError::Cross { crossing, .. } if crosses(crossing)), "{error}");
    assert_eq!(world.position(0, 0), before);
}

#[test]
fn a_fault_of_contact_is_listed_once_for_all_bodies() {
    let bodies = ["a", "b", "c"].iter().enumerate();
    let body = |(k, name): (usize, &&str)| block(name, [1.0; 2], [2; 2], [2.0 * k as f64, 0.0], 1.0, 1e4);
    let mut scene = heavy("verlet", bodies.map(body).collect(), 1);
    scene.contact = contact::<2>(&[("response", "barrier".into())]);
    let problems = World::problems(&scene, &Options::default(), &std::sync::Arc::default());
    assert_eq!(problems.iter().map(WorldError::code).collect::<Vec<_>>(), ["contact.barrier"]);
}

/// In space, with crossing edges and a sheet over them, with exact steps and in real time.
#[test]
fn solids_and_a_sheet_rest_in_space() {
    for accuracy in ["exact", "real_time"] {
        let cube = |name: &str, side: f64, cells: u32, x: [f64; 3]| {
            let mesh = Mesh::<3>::grid([0.0; 3], [side; 3], [cells; 3]).expect("a grid");
            let fem = model::<3>("fem", &[("youngs_modulus", 1e5), ("poissons_ratio", 0.3)]);
            BodyBlueprint { translation: x, ..BodyBlueprint::new(name, mesh, Mass::Total(1.0), vec![fem]) }
        };
        let mut scene = crate::contact::scene::<3>(
            "backward_euler",
            vec![cube("low", 1.0, 2, [0.0; 3]), cube("high", 0.8, 2, [0.13, 1.05, 0.07])],
        );
        scene.bodies[0].pins =
            vec![PinBlueprint { select: Selector::Side("bottom".into()), axes: [true; 3], motion: Vec::new() }];
        scene.surroundings.gravity = [0.0, -9.81, 0.0];
        scene.time = Time { seconds: 1.0, frame: 1.0 / 60.0, substeps: 1 };
        let registry = opruga_world::Registry::<3>::default();
        scene.integrator =
            registry.integrator_values("backward_euler", &[("accuracy", accuracy.into())]).expect("a rule");
        scene.contact = contact::<3>(&[("response", "barrier".into()), ("friction", 0.4.into())]);
        let mut world = World::<3>::new(scene.clone(), Options::default()).expect("a world");
        for _ in 0..60 {
            world.frame().unwrap_or_else(|error| panic!("{accuracy}: {error}"));
            assert_eq!(world.crossed_surfaces(), [], "{accuracy} at {} s", world.time());
        }
        let force: f64 = world.contact_forces(1).iter().map(|force| force[1]).sum();
        assert!((force - 9.81).abs() < 0.05, "{accuracy}: {force}");
        assert!(world.energy().kinetic < 1e-3, "{accuracy}: {:?}", world.energy());
    }
}

/// Light rings give way easily, so a multiplier that is only as stiff as the pair approaches its value in dozens of rounds.
#[test]
fn friction_between_gas_rings_settles_in_every_step() {
    let ring = |name: &str, x: [f64; 2]| {
        let ring = Mesh::ring(0.5, 36, [0.0; 2], 0.0).expect("a ring");
        let models = vec![
            model::<2>("mass_spring", &[("stiffness", 900.0), ("damping", 1.0)]),
            model::<2>("bending", &[("stiffness", 0.1)]),
            model::<2>("pressure", &[("nRT", 60.0), ("ambient", 20.0)]),
        ];
        BodyBlueprint { translation: x, ..BodyBlueprint::new(name, ring, Mass::Total(1.0), models) }
    };
    let mut scene = scene("backward_euler", vec![ring("low", [0.0, 0.55]), ring("high", [0.1, 1.7])]);
    scene.surroundings.gravity = [0.0, -9.81];
    scene.time = Time { seconds: 2.0, frame: 1.0 / 60.0, substeps: 2 };
    scene.contact = contact::<2>(&[("response", "barrier".into()), ("friction", 0.4.into())]);
    let fields = [("normal", Value::Numbers(vec![0.0, 1.0])), ("friction", 0.4.into())];
    scene.colliders.push(ColliderBlueprint::new::<2>("half_space", &fields).expect("a floor"));
    let mut world = world(&scene);
    for _ in 0..60 {
        world.frame().expect("a frame");
    }
    assert!(world.energy().loss_friction > 0.01, "they rub: {:?}", world.energy());
    assert!(world.warnings().iter().all(|warning| warning.code != "step.not_converged"), "{:?}", world.warnings());
}
