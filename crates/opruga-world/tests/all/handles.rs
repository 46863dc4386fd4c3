//! Bodies by number and by handle. A missing body is reported, and another body is never used instead. Bodies of the program are added and removed,
//! and snapshots contain them completely.

use crate::common;

use opruga_core::spec::{Value, Values};
use opruga_mesh::Mesh;
use opruga_world::blueprint::*;
use opruga_world::{Options, Registry, World};
use std::sync::Arc;

fn model(kind: &str, fields: &[(&str, f64)]) -> Values {
    let registry = Registry::<2>::default();
    let spec = registry.model(kind).expect("a model").spec();
    let mut values = Values::defaults(spec, 2);
    for (name, x) in fields {
        values.set(spec, name, Value::Number(*x), 2).expect("a field");
    }
    values
}

/// Rings side by side, in free space.
fn rings(count: usize) -> Blueprint<2> {
    let mut blueprint =
        common::solid(Mesh::ring(0.5, 12, [0.0; 2], 0.0).expect("a ring"), "symplectic_euler", &[], &[]);
    blueprint.time.substeps = 16;
    blueprint.surroundings.gravity = [0.0, -9.81];
    let body = blueprint.bodies.remove(0);
    let models =
        vec![model("mass_spring", &[("stiffness", 600.0), ("damping", 0.5)]), model("pressure", &[("nRT", 30.0)])];
    blueprint.bodies = (0..count)
        .map(|k| BodyBlueprint {
            name: format!("ring[{k}]"),
            mass: Mass::Total(1.0),
            models: models.clone(),
            translation: [2.0 * k as f64, 5.0],
            ..body.clone()
        })
        .collect();
    blueprint
}

fn world(blueprint: &Blueprint<2>) -> World<2> {
    World::new(blueprint.clone(), Options::default()).expect("a world")
}

/// A body of the program, similar to the rings but with a shape of its own.
fn guest(name: &str, vertices: u32, x: f64) -> BodyBlueprint<2> {
    let mesh = Arc::new(Mesh::ring(0.4, vertices, [0.0; 2], 0.1).expect("a ring"));
    BodyBlueprint { name: name.into(), mesh, translation: [x, 7.0], ..rings(1).bodies[0].clone() }
}

fn frames(world: &mut World<2>, count: usize) {
    (0..count).for_each(|_| world.frame().expect("a frame"));
}

fn codes(world: &World<2>) -> Vec<String> {
    world.warnings().into_iter().map(|warning| warning.code).collect()
}

#[test]
fn what_is_not_there_is_told_and_never_another_body() {
    let mut blueprint = rings(3);
    blueprint.probes.push(ProbeBlueprint {
        name: "p".into(),
        body: 1,
        select: Selector::Nodes(vec![0]),
        record: vec![Recorded::Position],
    });
    let mut world = world(&blueprint);
    world.remove_body("ring[1]").expect("it is there");
    for (body, node) in [(1, 0), (7, 0), (usize::MAX, 0), (0, 12), (0, u32::MAX)] {
        assert!(
            world.position(body, node).iter().chain(&world.velocity(body, node)).all(|x| x.is_nan()),
            "{body}, {node}"
        );
        assert!(world.node_mass(body, node).is_nan(), "{body}, {node}");
        assert!(world.reaction(body, &[0, node]).iter().all(|x| x.is_nan()), "{body}, {node}");
        assert!(world.set_node(body, node, [0.0; 2], [0.0; 2]).is_err(), "{body}, {node}");
    }
    for body in [1, 7, usize::MAX] {
        assert_eq!((world.node_count(body), world.rest_volume(body).is_nan()), (0, true), "{body}");
        assert!(world.handle(body).is_none() && world.usual_pull(body).is_none(), "{body}");
        assert!(world.modes(body, 3).is_err() && world.pinned_nodes(body).is_empty(), "{body}");
        assert!(world.readings(body).is_empty() && world.node_pressures(body).is_empty(), "{body}");
        assert!(world.cell_states(body).is_empty() && world.contact_forces(body).is_empty(), "{body}");
        assert!(world.node_forces(body, None).is_empty(), "{body}");
        assert!(world.add_force(body, Arc::new(|_, _, _, _| [0.0; 2])).is_err(), "{body}");
        let push = Action::Push { body, select: Selector::All, force: [1.0, 0.0] };
        assert!(world.command(CommandBlueprint { at: 0.0, until: 1.0, action: push }).is_err(), "{body}");
    }
    assert!(world.probe(0).iter().all(|(_, x)| x.is_nan()) && world.probe(9).is_empty());
    assert!(world.position(2, 0)[0] > 3.0, "the others are where they were");
}

#[test]
fn a_handle_means_its_body_or_none() {
    let blueprint = rings(2);
    let mut world = world(&blueprint);
    let first = world.handle(0).expect("a body");
    assert!(world.view(first).expect("a body").position(12).is_err());
    assert_eq!(world.view(first).expect("a body").position(3).expect("a node"), world.position(0, 3));
    let add = |world: &mut World<2>, name: &str| {
        let number = world.add_body(guest(name, 9, 8.0)).expect("a body");
        world.handle(number).expect("it is there")
    };
    let empty = world.snapshot();
    let a = add(&mut world, "a");
    let with_a = world.snapshot();
    world.remove_body("a").expect("it is there");
    assert_eq!(world.view(a).expect_err("gone").code(), "stale_handle");
    let b = add(&mut world, "b");
    assert_eq!(
        (a.index, world.resolve(a).is_err(), world.resolve(b).is_ok()),
        (b.index, true, true),
        "the place is used again"
    );
    // Restored to a time when `a` was present: its handle is valid again, that of `b` is not.
    world.restore(&with_a).expect("its own snapshot");
    assert_eq!(world.blueprint().bodies[world.resolve(a).expect("back")].name, "a");
    assert!(world.resolve(b).is_err());
    // Restored to a time before both: a body that is added now is neither of them.
    world.restore(&empty).expect("its own snapshot");
    let c = add(&mut world, "c");
    assert_eq!([a, b, c].map(|handle| world.resolve(handle).is_ok()), [false, false, true]);
    assert_eq!(c.index, a.index);
    assert!(world.resolve(first).is_ok(), "those of the scene stay");
    let other = World::new(blueprint, Options::default()).expect("a world");
    assert_eq!(other.resolve(first).expect_err("of another world").code(), "stale_handle");
}

/// A new world needs only the scene: bodies of the program, their changed parameters and commands are restored from the snapshot.
#[test]
fn bodies_and_commands_of_the_program_come_back_with_a_snapshot() {
    let blueprint = rings(3);
    let mut whole = world(&blueprint);
    let mut fixed = guest("fixed", 7, -3.0);
    fixed.pins.push(PinBlueprint {
        select: Selector::Or(vec![
            Selector::Nodes(vec![1]),
            Selector::Not(Box::new(Selector::HalfSpace { point: [-3.0, 7.0], normal: [0.0, -1.0] })),
        ]),
        axes: [true, false],
        motion: vec![vec![0.0, 0.0, 0.0], vec![2.0, 0.3, 0.0]],
    });
    let copy = BodyBlueprint { name: "copy".into(), translation: [9.0, 5.0], ..blueprint.bodies[0].clone() };
    frames(&mut whole, 3);
    for body in [guest("gone", 8, 20.0), fixed, copy] {
        whole.add_body(body).expect("a body");
    }
    whole.remove_body("gone").expect("it is there");
    whole.set("body.copy.models.pressure.nRT", Value::Number(45.0)).expect("a parameter");
    whole.set("body.ring.models.pressure.nRT", Value::Number(35.0)).expect("a parameter");
    whole.set("world.gravity", Value::Numbers(vec![0.5, -3.0])).expect("a parameter");
    let (copy, now) = (whole.body("copy").expect("there"), whole.time());
    let give = |at: f64, until: f64, action| CommandBlueprint { at: now + at, until: now + until, action };
    let path = vec![vec![now, 9.0, 6.0], vec![now + 1.0, 10.0, 6.0]];
    let drag = Action::Drag { body: copy, node: Some(2), facet: false, stiffness: None, path, largest_force: None };
    let models = Some(vec![model("mass_spring", &[("stiffness", 500.0)])]);
    for command in [
        give(0.0, 0.5, drag),
        give(0.2, 0.4, Action::Push { body: 1, select: Selector::All, force: [0.1, 0.0] }),
        give(0.3, 0.3, Action::Add(Box::new(guest("late", 10, 14.0)))),
        give(0.35, 0.35, Action::Change { body: copy, models, integrator: None }),
        give(0.4, 0.4, Action::Remove { name: "ring[2]".into() }),
    ] {
        whole.command(command).expect("a command");
    }
    let mut snapshots = Vec::new();
    for frame in 3..60 {
        if [3, 10, 23, 30, 45].contains(&frame) {
            snapshots.push((frame, whole.snapshot(), whole.frame_hash()));
        }
        frames(&mut whole, 1);
    }
    let end = (whole.state_hash(), whole.energy(), whole.snapshot());
    let mut used = world(&blueprint);
    frames(&mut used, 5);
    used.add_body(guest("other", 11, -9.0)).expect("a body");
    for (frame, bytes, hash) in &snapshots {
        let mut fresh = world(&blueprint);
        for (what, again) in [("fresh", &mut fresh), ("whole", &mut whole), ("used", &mut used)] {
            again.restore(bytes).unwrap_or_else(|e| panic!("{what}, {frame}: {e}"));
            assert_eq!(again.frame_hash(), *hash, "{what}, frame {frame}");
            frames(again, 60 - frame);
            assert_eq!((again.state_hash(), again.energy()), (end.0, end.1), "{what} from frame {frame}");
        }
        assert_eq!(fresh.snapshot(), end.2, "the same state has the same bytes, from frame {frame}");
        for cut in (0..bytes.len()).step_by(97) {
            assert!(fresh.restore(&bytes[..cut]).is_err(), "cut at {cut}");
        }
        assert_eq!(fresh.state_hash(), end.0, "a refused snapshot changes nothing");
    }
}

/// Damage at any position is refused, or gives a world that steps or returns an error; nothing panics.
#[test]
fn damaged_snapshots_of_bodies_of_the_program_never_panic() {
    let blueprint = rings(1);
    let mut first = world(&blueprint);
    let number = first.add_body(guest("guest", 5, 4.0)).expect("a body");
    let action = Action::Pin { body: number, select: Selector::Nodes(vec![1]), axes: [true; 2] };
    first.command(CommandBlueprint { at: 0.0, until: 9.0, action }).expect("a command");
    frames(&mut first, 1);
    let bytes = first.snapshot();
    let mut again = world(&blueprint);
    for at in 0..bytes.len() {
        for bit in [0, 7] {
            let mut damaged = bytes.clone();
            damaged[at] ^= 1 << bit;
            if again.restore(&damaged).is_ok() {
                let _ = again.frame();
            }
        }
    }
    again.restore(&bytes).expect("the whole snapshot");
    assert_eq!(again.state_hash(), first.state_hash());
}

#[test]
fn laws_of_force_do_not_pass_to_the_next_body_in_a_place() {
    let mut world = world(&rings(1));
    let number = world.add_body(guest("first", 9, 4.0)).expect("a body");
    world.add_force(number, Arc::new(|_, _, _, _| [5.0, 0.0])).expect("a law");
    frames(&mut world, 2);
    let (pushed, bytes) = (world.momentum().linear.0[0], world.snapshot());
    assert!(pushed > 0.1 && !codes(&world).contains(&"restore.no_force".to_string()));
    world.remove_body("first").expect("it is there");
    assert_eq!(world.add_body(guest("second", 9, 4.0)).expect("a body"), number, "the same place");
    frames(&mut world, 2);
    assert!(world.momentum().linear.0[0].abs() < 1e-12, "nothing pushes it");
    // The first body is restored without its law, which is reported until it has one.
    world.restore(&bytes).expect("its own snapshot");
    assert!(codes(&world).contains(&"restore.no_force".to_string()));
    world.add_force(number, Arc::new(|_, _, _, _| [5.0, 0.0])).expect("a law");
    assert!(!codes(&world).contains(&"restore.no_force".to_string()));
}

/// Commands of the scene find the body that another of its commands added, whatever bodies the program added before.
#[test]
fn commands_of_the_scene_find_their_bodies_beside_those_of_the_program() {
    let mut blueprint = rings(1);
    let at = |at: f64, action| CommandBlueprint { at, until: at, action };
    blueprint.commands = vec![
        at(0.1, Action::Add(Box::new(guest("late", 9, 6.0)))),
        CommandBlueprint {
            at: 0.2,
            until: 0.4,
            action: Action::Push { body: 1, select: Selector::All, force: [1.0, 0.0] },
        },
    ];
    let run = |with_guest: bool| {
        let mut world = world(&blueprint);
        if with_guest {
            assert_eq!(world.add_body(guest("guest", 9, -6.0)).expect("a body"), 2);
        }
        frames(&mut world, 40);
        let late = world.body("late").expect("it came");
        assert_eq!(late, 1);
        let mean = |body: usize| (0..9).map(|node| world.velocity(body, node)[0]).sum::<f64>() / 9.0;
        (world.position(late, 0), world.body("guest").map(mean))
    };
    let (alone, beside) = (run(false), run(true));
    assert_eq!(alone.0, beside.0);
    assert!(beside.1.expect("a guest").abs() < 1e-12, "nobody pushed the guest");
}

/// A batch keeps the seat of a removed body of the program, so no other island is rebuilt.
#[test]
fn bodies_keep_their_seats_when_those_of_the_program_go() {
    let mut world = world(&rings(1));
    let like = |k: usize| {
        let body = world_body();
        BodyBlueprint { name: format!("guest[{k}]"), translation: [3.0 * k as f64, 9.0], ..body }
    };
    fn world_body() -> BodyBlueprint<2> {
        rings(1).bodies[0].clone()
    }
    let mesh = Arc::clone(&world.blueprint().bodies[0].mesh);
    for k in 1..32 {
        world.add_body(BodyBlueprint { mesh: Arc::clone(&mesh), ..like(k) }).expect("a body");
    }
    assert_eq!(world.islands(), 4);
    let mut built = world.islands_built();
    for (k, islands) in [(3, 4), (4, 4), (12, 4)] {
        world.remove_body(&format!("guest[{k}]")).expect("it is there");
        assert_eq!((world.islands_built() - built, world.islands()), (1, islands), "guest {k}");
        built = world.islands_built();
    }
    world.add_body(BodyBlueprint { mesh, ..like(40) }).expect("a body");
    assert_eq!((world.islands_built() - built, world.islands()), (1, 4), "it takes a free seat");
}
