//! Refusals of a world, part by part, and its warnings.

use crate::common;

use common::{solid, text};
use opruga_core::spec::{Spec, Value, Values};
use opruga_math::message::Message as _;
use opruga_mesh::Mesh;
use opruga_world::blueprint::*;
use opruga_world::{Options, Registry, World, WorldError};
use std::sync::Arc;

fn values(spec: &'static Spec, fields: &[(&str, Value)]) -> Values {
    let mut values = Values::defaults(spec, 2);
    for (name, value) in fields {
        values.set(spec, name, value.clone(), 2).expect("a field of the test's own");
    }
    values
}

fn model(kind: &str, field: &str, value: f64) -> Values {
    let registry = Registry::<2>::default();
    values(registry.model(kind).expect("a model").spec(), &[(field, Value::Number(value))])
}

fn wall(normal: [f64; 2]) -> ColliderBlueprint {
    let spec = opruga_collide::all(2).into_iter().find(|s| s.kind == "half_space").expect("a wall");
    let fields = [("point", Value::Numbers(vec![0.0, -9.0])), ("normal", Value::Numbers(normal.to_vec()))];
    ColliderBlueprint { values: values(spec, &fields) }
}

fn body(name: &str, mesh: &Arc<Mesh<2>>, models: Vec<Values>) -> BodyBlueprint<2> {
    BodyBlueprint {
        name: name.into(),
        mesh: Arc::clone(mesh),
        translation: [0.0; 2],
        velocity: [0.0; 2],
        angular_velocity: vec![0.0],
        velocity_gradient: [[0.0; 2]; 2],
        contact: None,
        node_velocities: Arc::from([]),
        mass: Mass::Total(1.0),
        thickness: 1.0,
        integrator: None,
        models,
        pins: Vec::new(),
    }
}

fn scene(bodies: Vec<BodyBlueprint<2>>, colliders: Vec<ColliderBlueprint>) -> Blueprint<2> {
    let verlet = Registry::<2>::default().integrator("verlet").expect("an integrator").spec();
    Blueprint {
        name: "test".into(),
        title: String::new(),
        length_unit: "m".into(),
        credit: String::new(),
        picture: Default::default(),
        seed: 0,
        time: Time { seconds: 1.0, frame: 0.01, substeps: 10 },
        surroundings: Surroundings {
            gravity: [0.0, -9.81],
            drag: 0.0,
            largest_force: None,
            largest_velocity: None,
            largest_distance: None,
            unfold: false,
        },
        integrator: Values::defaults(verlet, 2),
        bodies,
        colliders,
        loads: Vec::new(),
        commands: Vec::new(),
        probes: Vec::new(),
        contact: None,
    }
}

fn line() -> Arc<Mesh<2>> {
    Arc::new(Mesh::line([0.0, 0.0], [1.0, 0.0], 1).expect("a line"))
}

#[test]
fn every_part_that_is_refused_is_found_once() {
    let (ring, line) = (Arc::new(Mesh::ring(0.5, 12, [0.0, 0.0], 0.0).expect("a ring")), line());
    let (soft, stiff) = (model("mass_spring", "stiffness", 100.0), model("mass_spring", "stiffness", 1e9));
    let gas = model("pressure", "nRT", 1.0);
    let mut bodies = vec![
        body("good", &ring, vec![soft.clone(), gas.clone()]),
        body("open", &line, vec![soft.clone(), gas]),
        body("loaded", &line, vec![soft]),
    ];
    bodies.extend((0..5).map(|k| body(&format!("stiff[{k}]"), &ring, vec![stiff.clone()])));
    let mut blueprint = scene(bodies, vec![wall([0.0, 1.0]), wall([0.0, 1e-200]), wall([1e-200, 0.0])]);
    blueprint.loads.push(LoadBlueprint {
        body: 2,
        select: Selector::Nodes(vec![0]),
        kind: LoadKind::Pressure(1.0),
        curve: Vec::new(),
    });
    let found: Vec<String> = World::problems(&blueprint, &Options::default(), &Arc::default())
        .iter()
        .map(|problem| match problem {
            WorldError::Build { part, source } => format!("{part}: {}: {}", source.kind, source.code()),
            WorldError::UnstableStep { body, .. } => format!("unstable: {body}"),
            other => other.code().to_string() + ": " + &other.in_full(),
        })
        .collect();
    assert_eq!(
        found,
        [
            "collider 1: half_space: collider.no_direction",
            "collider 2: half_space: collider.no_direction",
            "body `open`: pressure: model.open_surface",
            "path.unknown: `load.0`: no facet of the boundary has all of its nodes selected; allowed: all nodes of at least one facet",
            "unstable: stiff[0]",
        ]
    );
    // A scene without problems is accepted, and an accepted scene has no problems.
    let first = World::new(blueprint.clone(), Options::default()).expect_err("refused");
    assert!(World::problems(&blueprint, &Options::default(), &Arc::default()).contains(&first));
    blueprint.bodies.truncate(1);
    blueprint.colliders.truncate(1);
    blueprint.loads.clear();
    assert_eq!(World::problems(&blueprint, &Options::default(), &Arc::default()), []);
    assert!(World::new(blueprint, Options::default()).is_ok());
}

/// A body without edges is refused with the word for edges in the scene file.
#[test]
fn springs_without_edges_are_refused_by_the_word_of_their_edges() {
    let dot = Arc::new(Mesh { positions: vec![[0.0, 0.0]], ..Mesh::default() });
    let blueprint = scene(vec![body("dot", &dot, vec![model("mass_spring", "stiffness", 1.0)])], Vec::new());
    let refused = World::new(blueprint, Options::default()).expect_err("it has no edges");
    assert_eq!(
        refused.to_string(),
        "body `dot`: mass_spring: the body has no edges to carry springs (`edges = \"all\"`)"
    );
}

/// Two nodes of m = 0.5 kg and a spring k oscillate with ω² = 2k/m, so the estimate is k/2 for each node. The weight of both stretches that by 4 m g
/// / k = 19.62 N / k, which exceeds the distance of one metre between them if the spring is softer than 19.62 N/m.
#[test]
fn a_body_is_warned_of_where_its_sag_exceeds_its_size() {
    let warned = |stiffness: f64, size: f64, gravity: f64| {
        let mesh = Arc::new(Mesh::line([0.0, 0.0], [size, 0.0], 1).expect("a line"));
        let mut blueprint =
            scene(vec![body("b", &mesh, vec![model("mass_spring", "stiffness", stiffness)])], Vec::new());
        blueprint.surroundings.gravity = [0.0, gravity];
        let world = World::new(blueprint, Options::default()).expect("a world");
        world.warnings().iter().filter(|w| w.code == "units.sag").map(|w| w.count).sum::<u64>()
    };
    assert_eq!((warned(19.0, 1.0, -9.81), warned(20.2, 1.0, -9.81)), (1, 0));
    assert_eq!((warned(9.5, 2.0, -9.81), warned(10.1, 2.0, -9.81)), (1, 0));
    assert_eq!((warned(19_000.0, 1.0, 9_810.0), warned(20_200.0, 1.0, 9_810.0)), (1, 0));
    assert_eq!((warned(0.1, 1.0, 0.0), warned(0.0, 1.0, -9.81)), (0, 0), "no weight, or nothing that sags");
}

/// Kinds of bodies are counted, and when the scene changes the warning is replaced rather than repeated.
#[test]
fn the_warning_is_counted_by_kinds_and_goes_when_its_cause_goes() {
    let soft = |stiffness| vec![model("mass_spring", "stiffness", stiffness)];
    let bodies = vec![body("a", &line(), soft(1.0)), body("b", &line(), soft(2.0)), body("c", &line(), soft(1e3))];
    let mut world = World::new(scene(bodies, Vec::new()), Options::default()).expect("a world");
    let counts = |world: &World<2>| world.warnings().iter().map(|w| (w.code.clone(), w.count)).collect::<Vec<_>>();
    assert_eq!(counts(&world), [("units.sag".to_string(), 2)]);
    assert!(world.warnings()[0].message.contains("body `a` of 1 kg"), "{}", world.warnings()[0].message);
    world.set("body.a.models.mass_spring.stiffness", Value::Number(1e3)).expect("a parameter");
    assert_eq!(counts(&world), [("units.sag".to_string(), 1)]);
    world.set("body.b.models.mass_spring.stiffness", Value::Number(1e3)).expect("a parameter");
    assert_eq!(counts(&world), []);
}

/// A law that restores inverted cells is not suggested for a body that already has it; a law that restores them from a stronger inversion is.
#[test]
fn the_hint_of_inverted_cells_names_no_law_that_the_body_has() {
    for (law, hint) in [
        ("linear", "a material that restores such cells (`stable_neo_hookean`, `fixed_corotated`)"),
        ("stable_neo_hookean", "even after a stronger inversion (`fixed_corotated`)"),
        ("fixed_corotated", "smaller cells, or less compression"),
    ] {
        let mesh = Mesh::<2>::grid([0.0; 2], [1.0; 2], [1; 2]).expect("a square");
        let fields = [("material", text(law)), ("youngs_modulus", Value::Number(1e3))];
        let mut world = World::new(solid(mesh, "backward_euler", &[], &fields), Options::default()).expect("a world");
        assert_eq!(world.inverted_cells(), None);
        world.set_node(0, 0, [2.0, 2.0], [0.0; 2]).expect("a node");
        let said = world.inverted_cells().expect("a cell inside out").message;
        assert!(said.ends_with(&format!("{hint}, or `unfold = true` in `[world]`")), "{law}: {said}");
    }
}
