//! States kept within a frame change nothing, and show what a world with shorter frames would have shown.

use opruga_core::spec::{Spec, Value, Values};
use opruga_mesh::Mesh;
use opruga_world::blueprint::*;
use opruga_world::{Energy, Options, Registry, World};
use std::sync::Arc;

fn values(spec: &'static Spec, fields: &[(&str, Value)]) -> Values {
    let mut values = Values::defaults(spec, 2);
    for (name, value) in fields {
        values.set(spec, name, value.clone(), 2).expect("a field of the test's own");
    }
    values
}

/// Rings over a floor, with `substeps` of 1/1920 s in a frame.
fn rings(count: usize, substeps: u32) -> Blueprint<2> {
    let registry = Registry::<2>::default();
    let spec = |kind: &str| registry.model(kind).expect("a model").spec();
    let floor = opruga_collide::all(2).into_iter().find(|s| s.kind == "half_space").expect("a floor");
    let models = vec![
        values(spec("mass_spring"), &[("stiffness", Value::Number(1600.0)), ("damping", Value::Number(0.5))]),
        values(spec("pressure"), &[("nRT", Value::Number(50.0)), ("leak", Value::Number(0.3))]),
    ];
    let mesh = Arc::new(Mesh::ring(0.5, 24, [0.0, 0.0], 0.0).expect("a ring"));
    let body = |k: usize| BodyBlueprint {
        name: format!("ball[{k}]"),
        mesh: Arc::clone(&mesh),
        translation: [2.0 * k as f64, 0.6 + 0.01 * k as f64],
        velocity: [0.3, 0.0],
        angular_velocity: vec![1.0],
        velocity_gradient: [[0.0; 2]; 2],
        contact: None,
        node_velocities: Arc::from([]),
        mass: Mass::Total(1.0),
        thickness: 1.0,
        integrator: None,
        models: models.clone(),
        pins: Vec::new(),
    };
    Blueprint {
        name: "test".into(),
        title: String::new(),
        length_unit: "m".into(),
        credit: String::new(),
        picture: Default::default(),
        seed: 0,
        time: Time { seconds: 1.0, frame: f64::from(substeps) / 1920.0, substeps },
        surroundings: Surroundings {
            gravity: [0.0, -9.81],
            drag: 0.0,
            largest_force: None,
            largest_velocity: None,
            largest_distance: None,
            unfold: false,
        },
        integrator: Values::defaults(registry.integrator("symplectic_euler").expect("an integrator").spec(), 2),
        bodies: (0..count).map(body).collect(),
        colliders: vec![ColliderBlueprint {
            values: values(
                floor,
                &[("point", Value::Numbers(vec![0.0; 2])), ("normal", Value::Numbers(vec![0.0, 1.0]))],
            ),
        }],
        loads: Vec::new(),
        commands: Vec::new(),
        probes: Vec::new(),
        contact: None,
    }
}

/// The data of a kept state.
#[derive(Clone, Debug, PartialEq)]
struct Seen {
    time: f64,
    hash: u64,
    energy: Energy,
    volume: f64,
}

fn see(world: &mut World<2>) -> Seen {
    let volume = world.readings(0).iter().find(|(name, _)| *name == "volume").expect("a gas has a volume").1;
    Seen { time: world.time(), hash: world.state_hash(), energy: world.energy(), volume }
}

#[test]
fn looks_change_no_bit() {
    for threads in [1, 2] {
        for count in [1, 11] {
            let options = || Options { threads, ..Options::default() };
            let mut plain = World::new(rings(count, 32), options()).expect("a world");
            let mut watched = World::new(rings(count, 32), options()).expect("a world");
            watched.keep_looks(5);
            let mut looks = 0;
            for _ in 0..60 {
                plain.frame().expect("a frame");
                watched.frame().expect("a frame");
                let before = see(&mut watched);
                watched.look_within(|_| looks += 1);
                assert_eq!(see(&mut watched), before);
                assert_eq!(before, see(&mut plain));
            }
            assert_eq!(looks, 60 * 6, "after 5, 10, 15, 20, 25 and 30 of 32 substeps");
            assert_eq!(watched.snapshot(), plain.snapshot());
        }
    }
}

#[test]
fn a_look_shows_what_shorter_frames_show() {
    // A quarter of the longer frame is exact, so both worlds have the same times.
    let mut long = World::new(rings(3, 32), Options::default()).expect("a world");
    let mut short = World::new(rings(3, 8), Options::default()).expect("a world");
    long.keep_looks(8);
    for _ in 0..60 {
        long.frame().expect("a frame");
        let mut seen = Vec::new();
        long.look_within(|world| seen.push(see(world)));
        seen.push(see(&mut long));
        assert_eq!(seen.len(), 4);
        for look in seen {
            short.frame().expect("a frame");
            let expected = see(&mut short);
            assert_eq!((look.hash, look.volume), (expected.hash, expected.volume));
            assert!((look.time - expected.time).abs() < 1e-12);
            let close = |a: f64, b: f64| (a - b).abs() < 1e-9 * 50.0;
            assert!(close(look.energy.total(), expected.energy.total()));
            assert!(close(look.energy.loss_contact, expected.energy.loss_contact));
            assert!(close(look.energy.loss_integrator, expected.energy.loss_integrator));
        }
    }
}

#[test]
fn without_looks_nothing_is_shown() {
    let mut world = World::new(rings(1, 32), Options::default()).expect("a world");
    world.look_within(|_| panic!("no frame yet"));
    world.frame().expect("a frame");
    world.look_within(|_| panic!("none was asked for"));
    world.keep_looks(8);
    world.look_within(|_| panic!("the last frame kept none"));
}

#[test]
fn gas_pushes_every_node_outwards_with_its_pressure() {
    let mut world = World::new(rings(11, 32), Options::default()).expect("a world");
    for body in [0, 3, 10] {
        let pressure = world.readings(body).iter().find(|(name, _)| *name == "pressure").expect("a pressure").1;
        let forces = world.node_forces(body, Some(opruga_core::potential::Account::Gas));
        // P ∂V/∂x: the pressure times half of the chord between the neighbours, perpendicular to it.
        let (before, after) = (world.position(body, 23), world.position(body, 1));
        let chord = [after[0] - before[0], after[1] - before[1]];
        let expected = 0.5 * pressure * (chord[0] * chord[0] + chord[1] * chord[1]).sqrt();
        for force in forces {
            let size = (force[0] * force[0] + force[1] * force[1]).sqrt();
            assert!((size / expected - 1.0).abs() < 1e-9, "{size} {expected}");
        }
    }
}
