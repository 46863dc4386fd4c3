//! Commands given while the world runs have the same effect as commands that the scene contained from the start.
#![allow(missing_docs)]

use opruga_core::spec::{Spec, Value, Values};
use opruga_mesh::Mesh;
use opruga_world::blueprint::*;
use opruga_world::{Options, Registry, World};
use std::sync::Arc;

fn values(spec: &'static Spec, numbers: &[(&str, f64)]) -> Values {
    let mut values = Values::defaults(spec, 2);
    for (name, number) in numbers {
        values.set(spec, name, Value::Number(*number), 2).expect("allowed");
    }
    values
}

fn model(kind: &str, numbers: &[(&str, f64)]) -> Values {
    values(Registry::<2>::default().model(kind).expect("a model").spec(), numbers)
}

fn integrator(kind: &str) -> Values {
    values(Registry::<2>::default().integrator(kind).expect("an integrator").spec(), &[])
}

fn ball(name: &str, x: f64) -> BodyBlueprint<2> {
    BodyBlueprint {
        name: name.into(),
        mesh: Arc::new(Mesh::ring(0.5, 24, [0.0, 0.0], 0.0).expect("a ring")),
        translation: [x, 1.0],
        velocity: [0.3, 0.0],
        angular_velocity: Vec::new(),
        velocity_gradient: [[0.0; 2]; 2],
        contact: None,
        node_velocities: Arc::from([]),
        mass: Mass::Total(1.0),
        thickness: 1.0,
        integrator: None,
        models: vec![
            model("mass_spring", &[("stiffness", 400.0), ("damping", 1.0)]),
            model("pressure", &[("nRT", 20.0)]),
        ],
        pins: Vec::new(),
    }
}

fn scene(commands: Vec<CommandBlueprint<2>>) -> Blueprint<2> {
    Blueprint {
        name: "acting".into(),
        title: String::new(),
        length_unit: "m".into(),
        credit: String::new(),
        picture: Default::default(),
        seed: 1,
        time: Time { seconds: 2.0, frame: 1.0 / 60.0, substeps: 16 },
        surroundings: Surroundings {
            gravity: [0.0, -9.81],
            drag: 0.1,
            largest_force: None,
            largest_velocity: None,
            largest_distance: None,
            unfold: false,
        },
        integrator: integrator("symplectic_euler"),
        bodies: vec![ball("one", 0.0), ball("two", 2.0)],
        colliders: Vec::new(),
        loads: Vec::new(),
        commands,
        probes: Vec::new(),
        contact: None,
    }
}

fn world(commands: Vec<CommandBlueprint<2>>) -> World<2> {
    World::new(scene(commands), Options::default()).expect("a world")
}

fn frames(world: &mut World<2>, count: u32) {
    (0..count).for_each(|_| world.frame().expect("a frame"));
}

/// A command of the scene after those of the user.
fn late() -> CommandBlueprint<2> {
    let push = Action::Push { body: 1, select: Selector::Nodes(vec![3]), force: [2.0, 1.0] };
    CommandBlueprint { at: 1.2, until: 1.4, action: push }
}

fn change() -> Action<2> {
    let models = vec![model("pressure", &[("nRT", 30.0)]), model("mass_spring", &[("stiffness", 900.0)])];
    Action::Change { body: 0, models: Some(models), integrator: Some(integrator("runge_kutta")) }
}

#[test]
fn a_pointer_that_is_led_gives_the_bits_of_the_path_that_it_has_gone() {
    let frame = 1.0 / 60.0;
    let (mut live, mut path) = (world(vec![late()]), Vec::new());
    frames(&mut live, 10);
    let time = |k: u64| k as f64 * frame;
    let spot = |k: u64| vec![time(k), 0.5 + 0.02 * k as f64, 1.0 + 0.01 * (k % 7) as f64];
    path.extend([spot(10), spot(11)]);
    let drag = |path: Vec<Vec<f64>>, until| CommandBlueprint {
        at: time(10),
        until,
        action: Action::Drag { body: 0, node: None, facet: false, stiffness: None, path, largest_force: None },
    };
    let number = live.act(drag(path.clone(), 1e9)).expect("it begins");
    for k in 10..40 {
        path.push(spot(k + 2));
        live.lead(number, spot(k + 2)).expect("later than before");
        frames(&mut live, 1);
    }
    live.finish(number, time(40)).expect("it ends");
    frames(&mut live, 60);
    let mut replayed = world(vec![drag(path, time(40)), late()]);
    frames(&mut replayed, 100);
    assert_eq!(live.state_hash(), replayed.state_hash());
    let mut untouched = world(vec![late()]);
    frames(&mut untouched, 100);
    assert_ne!(live.state_hash(), untouched.state_hash(), "the pull did something");
    assert!(live.lead(number, vec![0.0, 0.0, 0.0]).is_err(), "time goes forward");
}

#[test]
fn a_body_changes_models_and_integrator_while_it_moves_and_keeps_its_motion() {
    let mut live = world(vec![late()]);
    frames(&mut live, 30);
    let before = (live.position(0, 5), live.velocity(0, 5), live.readings(0));
    let now = live.time();
    live.act(CommandBlueprint { at: now, until: now, action: change() }).expect("it begins");
    assert_eq!((live.position(0, 5), live.velocity(0, 5)), (before.0, before.1));
    assert_eq!(live.integrators(), ["symplectic_euler", "runge_kutta"]);
    frames(&mut live, 70);
    let mut replayed = world(vec![CommandBlueprint { at: now, until: now, action: change() }, late()]);
    frames(&mut replayed, 100);
    assert_eq!(live.state_hash(), replayed.state_hash());
}

#[test]
fn a_change_that_is_refused_leaves_the_world_as_it_was() {
    let (mut live, mut other) = (world(vec![late()]), world(vec![late()]));
    frames(&mut live, 20);
    let now = live.time();
    let stiff = Action::Change {
        body: 0,
        models: Some(vec![model("mass_spring", &[("stiffness", 1e12)]), model("pressure", &[("nRT", 1.0)])]),
        integrator: None,
    };
    let error = live.act(CommandBlueprint { at: now, until: now, action: stiff }).expect_err("far too stiff");
    assert!(error.to_string().contains("unstable"), "{error}");
    assert!(live.act(CommandBlueprint { at: now + 1.0, until: now + 1.0, action: change() }).is_err(), "not now");
    frames(&mut live, 80);
    frames(&mut other, 100);
    assert_eq!(live.state_hash(), other.state_hash());
}

#[test]
fn a_world_goes_back_before_and_behind_what_was_done_and_comes_to_the_same_bits() {
    let mut live = world(vec![late()]);
    frames(&mut live, 20);
    let early = live.snapshot();
    frames(&mut live, 10);
    let now = live.time();
    live.act(CommandBlueprint { at: now, until: now, action: change() }).expect("it begins");
    let remove = Action::Remove { name: "two".into() };
    live.act(CommandBlueprint { at: now, until: now, action: remove }).expect("it begins");
    frames(&mut live, 10);
    let (middle, hash) = (live.snapshot(), live.state_hash());
    let now = live.time();
    let push = Action::Push { body: 0, select: Selector::All, force: [0.1, 0.2] };
    live.act(CommandBlueprint { at: now, until: now + 0.2, action: push }).expect("it begins");
    frames(&mut live, 60);
    let end = live.state_hash();
    live.rewind(&early).expect("the same past");
    assert_eq!(live.frames(), 20);
    frames(&mut live, 20);
    assert_eq!(live.state_hash(), hash, "after the first two commands were run again");
    frames(&mut live, 60);
    assert_eq!(live.state_hash(), end);
    live.rewind(&middle).expect("the same past");
    frames(&mut live, 60);
    assert_eq!(live.state_hash(), end);
    assert!(live.restore(&middle).is_err(), "for a checkpoint it is another scene");
    assert_eq!(live.state_hash(), end);
}
