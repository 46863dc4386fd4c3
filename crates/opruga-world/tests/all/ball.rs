//! A ring of springs and gas in a world: closed forms, ledger, bits, snapshots.

use opruga_core::spec::{Spec, Value, Values};
use opruga_math::Simd;
use opruga_math::message::Message as _;
use opruga_mesh::Mesh;
use opruga_world::blueprint::*;
use opruga_world::{Options, Registry, World};
use std::sync::Arc;

fn values(spec: &'static Spec, fields: &[(&str, Value)]) -> Values {
    let mut values = Values::defaults(spec, 2);
    for (name, value) in fields {
        values.set(spec, name, value.clone(), 2).expect("a field of the test's own");
    }
    values
}

fn model(kind: &str, fields: &[(&str, f64)]) -> Values {
    let registry = Registry::<2>::default();
    let fields: Vec<_> = fields.iter().map(|(n, x)| (*n, Value::Number(*x))).collect();
    values(registry.model(kind).expect("a model").spec(), &fields)
}

fn integrator(kind: &str) -> Values {
    Values::defaults(Registry::<2>::default().integrator(kind).expect("an integrator").spec(), 2)
}

fn floor(restitution: f64, friction: f64) -> ColliderBlueprint {
    let spec = opruga_collide::all(2).into_iter().find(|s| s.kind == "half_space").expect("a floor");
    let fields = [
        ("point", Value::Numbers(vec![0.0, 0.0])),
        ("normal", Value::Numbers(vec![0.0, 1.0])),
        ("restitution", Value::Number(restitution)),
        ("friction", Value::Number(friction)),
    ];
    ColliderBlueprint { values: values(spec, &fields) }
}

fn rings(count: usize, vertices: u32, rule: &str) -> Blueprint<2> {
    let mesh = Arc::new(Mesh::ring(0.5, vertices, [0.0, 0.0], 0.0).expect("a ring"));
    Blueprint {
        name: "test".into(),
        title: String::new(),
        length_unit: "m".into(),
        credit: String::new(),
        picture: Default::default(),
        seed: 0,
        time: Time { seconds: 1.0, frame: 1.0 / 60.0, substeps: 40 },
        surroundings: Surroundings {
            gravity: [0.0, -9.81],
            drag: 0.0,
            largest_force: None,
            largest_velocity: None,
            largest_distance: None,
            unfold: false,
        },
        integrator: integrator(rule),
        bodies: (0..count)
            .map(|k| BodyBlueprint {
                name: format!("ball[{k}]"),
                mesh: Arc::clone(&mesh),
                translation: [2.0 * k as f64, 0.8 + 0.01 * k as f64],
                velocity: [0.3, 0.0],
                angular_velocity: vec![1.0],
                velocity_gradient: [[0.0; 2]; 2],
                contact: None,
                node_velocities: Arc::from([]),
                mass: Mass::Total(1.0),
                thickness: 1.0,
                integrator: None,
                models: vec![
                    model("mass_spring", &[("stiffness", 1600.0 + k as f64), ("damping", 0.5)]),
                    model("pressure", &[("nRT", 50.0)]),
                ],
                pins: Vec::new(),
            })
            .collect(),
        colliders: vec![floor(0.4, 0.3)],
        loads: Vec::new(),
        commands: Vec::new(),
        probes: Vec::new(),
        contact: None,
    }
}

fn run(blueprint: Blueprint<2>, options: Options, frames: usize) -> World<2> {
    let mut world = World::new(blueprint, options).expect("a world");
    for _ in 0..frames {
        world.frame().expect("a frame");
    }
    world
}

#[test]
fn threads_lanes_and_batches_give_the_same_bits() {
    let reference = run(
        rings(11, 36, "symplectic_euler"),
        Options { batches: false, simd: Some(Simd::Baseline), ..Options::default() },
        60,
    );
    assert!(reference.position(0, 27)[1] < 0.5, "the balls have come down");
    for threads in [1, 2, 3, 8] {
        for simd in Simd::available() {
            for batches in [false, true] {
                let options = Options { threads, simd: Some(simd), batches, ..Options::default() };
                let world = run(rings(11, 36, "symplectic_euler"), options, 60);
                assert_eq!(
                    world.state_hash(),
                    reference.state_hash(),
                    "{threads} threads, {simd:?}, batches {batches}"
                );
            }
        }
    }
}

#[test]
fn a_restored_snapshot_goes_on_bit_for_bit_on_another_number_of_threads() {
    let mut first = run(rings(5, 36, "verlet"), Options::default(), 30);
    let bytes = first.snapshot();
    let mut second = World::new(rings(5, 36, "verlet"), Options { threads: 3, ..Options::default() }).expect("a world");
    second.restore(&bytes).expect("its own snapshot");
    assert_eq!(first.state_hash(), second.state_hash());
    for _ in 0..40 {
        first.frame().expect("a frame");
        second.frame().expect("a frame");
    }
    assert_eq!(first.state_hash(), second.state_hash());
    assert_eq!(first.energy(), second.energy());
}

#[test]
fn a_damaged_snapshot_is_refused_and_leaves_the_world_as_it_was() {
    let mut world = run(rings(2, 8, "symplectic_euler"), Options::default(), 3);
    let hash = world.state_hash();
    let bytes = world.snapshot();
    for length in 0..bytes.len() {
        assert!(world.restore(&bytes[..length]).is_err(), "cut at {length}");
    }
    let mut longer = bytes.clone();
    longer.push(0);
    assert!(world.restore(&longer).is_err());
    assert_eq!(world.state_hash(), hash);
    world.restore(&bytes).expect("the whole snapshot");
    assert_eq!(world.state_hash(), hash);
}

#[test]
fn a_free_ring_keeps_its_momentum_and_falls_like_a_stone() {
    let mut blueprint = rings(1, 36, "symplectic_euler");
    blueprint.colliders.clear();
    let world = run(blueprint, Options::default(), 60);
    let momentum = world.momentum();
    // m v: 1 kg at 0.3 m/s sideways and −9.81 m/s after one second of free fall.
    assert!((momentum.linear.0[0] - 0.3).abs() < 1e-12);
    assert!((momentum.linear.0[1] + 9.81).abs() < 1e-11);
    // Symplectic Euler after n steps: y = −g h² n (n + 1) / 2.
    let (h, n) = (world.h(), 2400.0);
    let mean = (0..36).map(|i| world.position(0, i)[1]).sum::<f64>() / 36.0;
    let expected = 0.8 - 9.81 * h * h * n * (n + 1.0) / 2.0;
    assert!((mean - expected).abs() < 1e-9, "{mean} {expected}");
}

#[test]
fn the_ledger_closes_at_first_order_and_every_channel_has_its_sign() {
    let closure = |substeps: u32| {
        let mut blueprint = rings(1, 36, "symplectic_euler");
        blueprint.time.substeps = substeps;
        let world = run(blueprint, Options::default(), 90);
        let e = world.energy();
        assert!(e.loss_damping > 0.0 && e.loss_contact > 0.0 && e.loss_friction > 0.0);
        assert!(e.work_user == 0.0 && e.work_gas == 0.0);
        e.loss_integrator.abs()
    };
    let (coarse, fine) = (closure(40), closure(160));
    assert!(fine < 0.5 * coarse, "{coarse} {fine}");
}

#[test]
fn a_diverging_world_names_body_and_node_and_stays_at_its_last_good_frame() {
    let mut blueprint = rings(3, 36, "symplectic_euler");
    blueprint.time.substeps = 1;
    let refused = World::new(blueprint.clone(), Options::default());
    let message = refused.expect_err("the step is too long").to_string();
    assert!(message.contains("is unstable for body"), "{message}");
    let mut world = World::new(blueprint, Options { allow_unstable: true, ..Options::default() }).expect("allowed");
    let error = loop {
        let hash = world.state_hash();
        match world.frame() {
            Ok(()) => assert!(world.frames() < 2000),
            Err(error) => {
                assert_eq!(world.state_hash(), hash, "the world is at its last good frame");
                break error;
            }
        }
    };
    assert!(error.to_string().contains("body `ball["), "{error}");
    assert!(error.to_string().contains("node"), "{error}");
}

#[test]
fn parameters_change_in_flight_and_bad_ones_are_refused() {
    let mut world = run(rings(1, 36, "symplectic_euler"), Options::default(), 5);
    world.set("body.ball[0].models.pressure.nRT", Value::Number(80.0)).expect("a parameter");
    let error = world.set("body.ball[0].models.pressure.nRt", Value::Number(80.0)).expect_err("misspelt");
    assert!(error.in_full().contains("did you mean `nRT`"), "{error}");
    let error = world.set("body.bal[0].models.pressure.nRT", Value::Number(80.0)).expect_err("misspelt");
    assert!(error.in_full().contains("did you mean `ball[0]`"), "{error}");
    assert!(world.set("body.ball[0].models.mass_spring.stiffness", Value::Number(-1.0)).is_err());
    // A stiffness for which the step is too long is refused; the old one is kept.
    assert!(world.set("body.ball[0].models.mass_spring.stiffness", Value::Number(1e9)).is_err());
    world.frame().expect("goes on");
}

#[test]
fn bodies_come_and_go_and_old_handles_are_told() {
    let mut world = run(rings(4, 36, "symplectic_euler"), Options::default(), 5);
    let handle = world.handle(2).expect("a body");
    world.remove_body("ball[2]").expect("it is there");
    assert_eq!(world.resolve(handle).expect_err("it is gone").code(), "stale_handle");
    assert_eq!(world.bodies().count(), 3);
    let mut body = rings(1, 36, "symplectic_euler").bodies[0].clone();
    assert!(world.add_body(body.clone()).is_err(), "the name is taken");
    body.name = "new".into();
    body.translation = [-5.0, 3.0];
    let number = world.add_body(body).expect("a new body");
    world.frame().expect("a frame");
    assert!(world.position(number, 0)[0] < -4.0);
}

fn command(at: f64, action: Action<2>) -> CommandBlueprint<2> {
    CommandBlueprint { at, until: at, action }
}

/// Two rings whose parameters change; one of them is removed, and a third is added and pulled.
fn changing() -> Blueprint<2> {
    let mut blueprint = rings(2, 36, "symplectic_euler");
    blueprint.surroundings.largest_velocity = Some(50.0);
    let mut late = blueprint.bodies[0].clone();
    late.name = "late".into();
    late.translation = [-3.0, 1.0];
    let set = |path: &str, value| Action::Set { path: path.into(), value };
    let pull = Action::Drag {
        body: 2,
        node: None,
        facet: false,
        stiffness: None,
        path: vec![vec![0.4, -3.0, 1.0], vec![0.8, -2.0, 2.0]],
        largest_force: None,
    };
    blueprint.commands = vec![
        command(0.1, set("body.ball[0].models.pressure.nRT", Value::Number(80.0))),
        command(0.2, set("collider.0.friction", Value::Number(0.9))),
        command(0.2, set("world.gravity", Value::Numbers(vec![1.0, -5.0]))),
        command(0.2, set("world.largest_velocity", Value::Number(4.0))),
        command(0.3, Action::Add(Box::new(late))),
        CommandBlueprint { at: 0.4, until: 0.8, action: pull },
        command(0.5, set("time.substeps", Value::Integer(60))),
        command(0.5, Action::Remove { name: "ball[1]".into() }),
    ];
    blueprint
}

/// Changes by commands before a snapshot are part of it, in a new world and in one that has continued.
#[test]
fn a_snapshot_of_a_changed_scene_can_be_restored() {
    let whole = run(changing(), Options::default(), 60);
    let mut hashes = Vec::new();
    for frames in [3, 9, 15, 20, 28, 40] {
        let first = run(changing(), Options::default(), frames);
        let bytes = first.snapshot();
        let mut second = World::new(changing(), Options { threads: 2, ..Options::default() }).expect("a world");
        second.restore(&bytes).unwrap_or_else(|e| panic!("after {frames} frames: {e}"));
        assert_eq!(second.state_hash(), first.state_hash(), "after {frames} frames");
        assert_eq!(second.blueprint().bodies.len(), first.blueprint().bodies.len());
        while second.frames() < 60 {
            second.frame().expect("a frame");
        }
        assert_eq!(second.state_hash(), whole.state_hash(), "interrupted after {frames} frames");
        assert_eq!(second.energy(), whole.energy());
        // The same world, after restoring.
        second.restore(&bytes).expect("back");
        assert_eq!(second.state_hash(), first.state_hash());
        while second.frames() < 60 {
            second.frame().expect("a frame");
        }
        assert_eq!(second.state_hash(), whole.state_hash(), "rewound to {frames} frames");
        for length in [8, 16, 24, 32, 40, 60, bytes.len() - 8] {
            assert!(second.restore(&bytes[..length]).is_err(), "cut at {length}");
            assert_eq!(second.state_hash(), whole.state_hash(), "a refused snapshot changes nothing");
        }
        second.frame().expect("goes on");
        hashes.push(first.state_hash());
    }
    hashes.dedup();
    assert_eq!(hashes.len(), 6);
}

#[test]
fn parameters_of_obstacles_limits_and_copies_change_in_flight() {
    let mut world = run(rings(3, 36, "symplectic_euler"), Options::default(), 2);
    world.set("world.largest_force", Value::Number(900.0)).expect("a parameter");
    world.set("world.largest_velocity", Value::Integer(3)).expect("a parameter");
    world.set("collider.0.restitution", Value::Number(0.9)).expect("a parameter");
    world.set("body.ball.models.pressure.nRT", Value::Number(70.0)).expect("all copies");
    world.set("body.ball[1].models.1.nRT", Value::Number(60.0)).expect("one copy, its model by number");
    let gas: Vec<_> = world.blueprint().bodies.iter().map(|b| b.models[1].number("nRT")).collect();
    assert_eq!(gas, [Some(70.0), Some(60.0), Some(70.0)]);
    for _ in 0..60 {
        world.frame().expect("a frame");
    }
    assert!(world.warnings().iter().any(|w| w.code == "limit.velocity" && w.count > 0), "{:?}", world.warnings());
    let before = world.state_hash();
    for (path, value, text) in [
        ("world.largest_force", Value::Number(0.0), "`world.largest_force`: is 0; allowed: a number > 0"),
        ("world.largest_forc", Value::Number(1.0), "did you mean `largest_force`?"),
        ("collider.1.friction", Value::Number(0.1), "`collider.1.friction`: there is no collider 1; allowed: 0"),
        ("collider.0.friction", Value::Number(-0.1), "a number >= 0"),
        ("collider.0.normal", Value::Numbers(vec![0.0, 0.0]), "normal"),
        ("body.ball.models.gas.nRT", Value::Number(1.0), "has no model `gas`; allowed: mass_spring, pressure"),
        ("body.ball.models.mass_spring.stiffness", Value::Number(1e9), "is unstable for body"),
        ("body.9.models.pressure.nRT", Value::Number(1.0), "there is no body `9`"),
        (
            "gravity",
            Value::Number(1.0),
            "allowed: body.NAME.models.KIND.FIELD, body.NAME.integrator.FIELD, integrator.FIELD",
        ),
    ] {
        let error = world.set(path, value).expect_err(path).in_full();
        assert!(error.contains(text), "{error}");
    }
    assert_eq!(world.state_hash(), before);
    assert_eq!(world.blueprint().surroundings.largest_force, Some(900.0));
    world.frame().expect("goes on");
}

/// All bodies may be removed, and commands may name bodies that do not exist: nothing panics, and it is reported.
#[test]
fn an_empty_world_goes_on_and_commands_on_lost_bodies_are_told() {
    let mut blueprint = rings(1, 36, "symplectic_euler");
    let push = |body: usize| Action::Push { body, select: Selector::All, force: [1.0, 0.0] };
    blueprint.probes.push(ProbeBlueprint {
        name: "p".into(),
        body: 0,
        select: Selector::All,
        record: vec![Recorded::Position, Recorded::Reaction],
    });
    blueprint.commands = vec![
        CommandBlueprint { at: 0.5, until: 0.6, action: push(0) },
        command(0.0, Action::Remove { name: "ball[0]".into() }),
        CommandBlueprint { at: 0.2, until: 0.6, action: push(7) },
    ];
    let mut world = run(blueprint, Options::default(), 5);
    assert_eq!(world.bodies().count(), 0);
    assert_eq!((world.energy().kinetic, world.readings(0).len(), world.readings(9).len()), (0.0, 0, 0));
    assert!(world.probe(0).iter().all(|(_, x)| x.is_nan()) && world.probe(0).len() == 4);
    assert!(world.warnings().iter().any(|w| w.code == "command.no_body" && w.message.contains("`ball[0]`")));
    let error = loop {
        if let Err(error) = world.frame() {
            break error.to_string();
        }
        assert!(world.frames() < 20, "the push on body 7 has begun");
    };
    assert!(error.starts_with("`body.7`: there is no such body at t = 0.2"), "{error}");
    world.frame().expect("goes on: the error is told once");
    let bytes = world.snapshot();
    world.restore(&bytes).expect("an empty world too");
}

/// Torture row 61: values that are not finite are refused on every path.
#[test]
fn numbers_that_are_not_finite_stay_outside() {
    let mut world = run(rings(1, 36, "symplectic_euler"), Options::default(), 2);
    let hash = world.state_hash();
    let error = world.set_node(0, 3, [f64::NAN, 0.0], [0.0; 2]).expect_err("no place").in_full();
    assert_eq!(error, "`body.0.node.3`: NaN is neither a position nor a velocity; allowed: finite numbers");
    assert!(world.set_node(0, 3, [0.0; 2], [f64::INFINITY, 0.0]).is_err());
    assert!(world.set_node(0, 36, [0.0; 2], [0.0; 2]).is_err());
    assert!(world.set_node(1, 0, [0.0; 2], [0.0; 2]).is_err());
    assert!(world.set("world.gravity", Value::Numbers(vec![0.0, f64::NAN])).is_err());
    assert!(world.set("body.ball[0].models.pressure.nRT", Value::Number(f64::INFINITY)).is_err());
    assert_eq!(world.state_hash(), hash);
    // A force law of the program fails: the frame is refused and undone.
    world
        .add_force(
            0,
            std::sync::Arc::new(|_, _: [f64; 2], _: [f64; 2], t: f64| [if t > 0.05 { f64::NAN } else { 0.0 }, 0.0]),
        )
        .expect("a force");
    world.frame().expect("still finite");
    let error = loop {
        let hash = world.state_hash();
        if let Err(error) = world.frame() {
            assert_eq!(world.state_hash(), hash);
            break error.to_string();
        }
        assert!(world.frames() < 20, "it diverges");
    };
    assert!(
        error.starts_with(
            "body `ball[0]` diverged: node 0 left the range of finite numbers in the substep from t = 0.05"
        ),
        "{error}"
    );
}
