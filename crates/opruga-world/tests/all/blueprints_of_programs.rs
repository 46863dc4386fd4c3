//! A blueprint of a program must satisfy the rules of a scene file; everything else is refused with the code of the reader.

use crate::common;
use opruga_math::message::Message;

use common::{clamp, solid, text};
use opruga_core::spec::Value;
use opruga_mesh::Mesh;
use opruga_world::blueprint::*;
use opruga_world::{Options, Registry, World, WorldError};
use std::sync::Arc;

fn sound() -> Blueprint<2> {
    let material =
        [("youngs_modulus", Value::Number(1e5)), ("poissons_ratio", Value::Number(0.3)), ("material", text("linear"))];
    let mut blueprint =
        solid(Mesh::grid([0.0; 2], [1.0; 2], [2; 2]).expect("a grid"), "backward_euler", &[], &material);
    blueprint.bodies[0].pins = clamp();
    blueprint
}

fn refused(what: &str, blueprint: Blueprint<2>) -> WorldError {
    World::new(blueprint, Options::default()).err().unwrap_or_else(|| panic!("{what} is refused"))
}

type Change = fn(&mut Blueprint<2>);

/// The body of the blueprint with another mesh.
fn meshed(blueprint: &mut Blueprint<2>, change: impl FnOnce(&mut Mesh<2>)) {
    change(Arc::make_mut(&mut blueprint.bodies[0].mesh));
}

#[test]
fn what_no_scene_could_say_is_refused_with_the_code_of_the_reader() {
    World::new(sound(), Options::default()).expect("a sound blueprint");
    let all = || Selector::All;
    let cases: &[(&str, &str, &str, Change)] = &[
        ("mass", "scene.range", "-1", |b| b.bodies[0].mass = Mass::Total(-1.0)),
        ("node mass", "scene.range", "0", |b| b.bodies[0].mass = Mass::Node(0.0)),
        ("density", "scene.range", "NaN", |b| b.bodies[0].mass = Mass::Density(f64::NAN)),
        ("densities", "scene.length", "4 cells", |b| b.bodies[0].mass = Mass::DensityOfCells(Arc::from([1.0]))),
        ("a density", "scene.range", "-2", |b| {
            b.bodies[0].mass = Mass::DensityOfCells(Arc::from([1.0, 1.0, -2.0, 1.0]))
        }),
        ("thickness", "scene.range", "thickness", |b| b.bodies[0].thickness = 0.0),
        ("velocity", "scene.range", "velocity", |b| b.bodies[0].velocity[1] = f64::INFINITY),
        ("place", "scene.range", "position", |b| b.bodies[0].translation[0] = f64::NAN),
        ("turning", "scene.length", "angular_velocity", |b| b.bodies[0].angular_velocity = vec![1.0; 3]),
        ("turning speed", "scene.range", "angular_velocity", |b| b.bodies[0].angular_velocity = vec![f64::NAN]),
        ("no name", "scene.name", "empty", |b| b.bodies[0].name = String::new()),
        ("a name", "scene.name", "a number", |b| b.bodies[0].name = "12".into()),
        ("a path", "scene.name", "`.`", |b| b.bodies[0].name = "a.b".into()),
        ("two names", "scene.duplicate_name", "`body`", |b| b.bodies.push(b.bodies[0].clone())),
        ("a facet", "scene.shape", "999", |b| meshed(b, |mesh| mesh.facets[0][1] = 999)),
        ("a cell", "scene.shape", "999", |b| meshed(b, |mesh| mesh.cells.quadrilaterals[0][1] = 999)),
        ("a group", "scene.shape", "999", |b| meshed(b, |mesh| _ = mesh.groups.insert("g".into(), vec![999]))),
        ("no nodes", "scene.shape", "no nodes", |b| meshed(b, |mesh| *mesh = Mesh::default())),
        ("a node", "scene.shape", "node 3", |b| meshed(b, |mesh| mesh.positions[3][0] = f64::NAN)),
        ("far node", "scene.shape", "1e70", |b| meshed(b, |mesh| mesh.positions[3][0] = 1e80)),
        ("substeps", "scene.range", "from 1 to", |b| b.time.substeps = 0),
        ("frame", "scene.range", "frame", |b| b.time.frame = -0.1),
        ("seconds", "scene.range", "seconds", |b| b.time.seconds = f64::NAN),
        ("frames", "scene.range", "would not advance", |b| (b.time.seconds, b.time.frame) = (1e30, 1e-3)),
        ("gravity", "scene.range", "gravity", |b| b.surroundings.gravity[1] = f64::NAN),
        ("drag", "scene.range", "drag", |b| b.surroundings.drag = -1.0),
        ("limit", "scene.range", "largest_force", |b| b.surroundings.largest_force = Some(0.0)),
        ("pin", "scene.range", "no node 77", |b| b.bodies[0].pins[0].select = Selector::Nodes(vec![77])),
        ("group", "scene.unknown_name", "`wing`", |b| b.bodies[0].pins[0].select = Selector::Group("wing".into())),
        ("nothing", "scene.selects_nothing", "no node", |b| {
            b.bodies[0].pins[0].select =
                Selector::And(vec![Selector::Side("left".into()), Selector::Side("right".into())])
        }),
        ("motion", "scene.range", "motion", |b| b.bodies[0].pins[0].motion = vec![vec![0.0, 1.0]]),
    ];
    for (what, code, said, change) in cases {
        let mut blueprint = sound();
        change(&mut blueprint);
        let error = refused(what, blueprint);
        assert_eq!(error.code(), *code, "{what}: {error}");
        assert!(error.in_full().contains(said), "{what}: {error}");
    }
    let load = |body, kind, curve| LoadBlueprint { body, select: Selector::Side("right".into()), kind, curve };
    for (what, load) in [
        ("body", load(1, LoadKind::Force([1.0, 0.0]), Vec::new())),
        ("force", load(0, LoadKind::Force([f64::NAN, 0.0]), Vec::new())),
        ("curve", load(0, LoadKind::Pressure(1.0), vec![vec![1.0, 1.0], vec![0.0, 1.0]])),
    ] {
        let error = refused(what, Blueprint { loads: vec![load], ..sound() });
        assert!(error.code().starts_with("scene.") && error.to_string().starts_with("load 0"), "{what}: {error}");
    }
    let probe =
        |name: &str, body| ProbeBlueprint { name: name.into(), body, select: all(), record: vec![Recorded::Position] };
    for probes in [vec![probe("p", 3)], vec![probe("p", 0), probe("p", 0)]] {
        assert!(refused("probes", Blueprint { probes, ..sound() }).code().starts_with("scene."));
    }
    let drag = |path| Action::Drag { body: 0, node: None, facet: false, stiffness: None, path, largest_force: None };
    let mut bad = sound().bodies[0].clone();
    (bad.name, bad.mass) = ("late".into(), Mass::Total(f64::NAN));
    for action in [drag(Vec::new()), drag(vec![vec![0.0, 1.0]]), Action::Add(Box::new(bad.clone()))] {
        let command = CommandBlueprint { at: 0.0, until: 1.0, action };
        assert_eq!(refused("command", Blueprint { commands: vec![command.clone()], ..sound() }).code(), "scene.range");
        let mut world = World::new(sound(), Options::default()).expect("a world");
        assert_eq!(world.command(command).expect_err("in the run too").code(), "scene.range");
    }
    let mut world = World::new(sound(), Options::default()).expect("a world");
    let before = world.snapshot();
    assert_eq!(world.add_body(bad).expect_err("no mass").code(), "scene.range");
    assert_eq!(world.snapshot(), before, "the world stays as it was");
}

/// Copies are distinguished by a number that is not part of their name.
#[test]
fn names_of_copies_are_names() {
    let mut blueprint = sound();
    blueprint.bodies[0].name = "row[3]".into();
    World::new(blueprint, Options::default()).expect("a copy");
}

#[test]
fn fields_are_refused_as_the_reader_of_scenes_refuses_them() {
    let registry = Registry::<2>::default();
    let code = |kind, fields: &[(&str, Value)]| registry.model_values(kind, fields).expect_err("refused").code();
    assert_eq!(code("mass_sprong", &[]), "scene.unknown_name");
    assert_eq!(code("drag", &[]), "scene.missing");
    assert_eq!(code("mass_spring", &[]), "model.one_of");
    assert_eq!(code("mass_spring", &[("stiffness", (-1.0).into())]), "scene.range");
    assert_eq!(code("mass_spring", &[("stiffnes", 1.0.into())]), "scene.unknown_field");
    let floor = ColliderBlueprint::new::<2>("half_space", &[("normal", [0.0, 0.0].into())]);
    assert_eq!(floor.expect_err("no direction").code(), "scene.range");
}

#[test]
fn a_blueprint_from_code_is_a_world() {
    let registry = Registry::<2>::default();
    let springs = registry.model_values("mass_spring", &[("stiffness", 100.0.into())]).expect("springs");
    let mut scene = Blueprint::new("test", registry.integrator_values("verlet", &[]).expect("a rule"));
    let ring = Mesh::ring(0.5, 12, [0.0; 2], 0.0).expect("a ring");
    let rest = ring.positions[3];
    scene.bodies.push(BodyBlueprint::new("ring", ring, Mass::Total(1.0), vec![springs]));
    let mut world = World::new(scene, Options::default()).expect("a world");
    assert_eq!(world.node_count(0), 12);
    world.frame().expect("a frame");
    let x = world.position(0, 3);
    assert!((0..2).all(|d| (x[d] - rest[d]).abs() < 1e-15), "nothing acts on it: {x:?}");
}
