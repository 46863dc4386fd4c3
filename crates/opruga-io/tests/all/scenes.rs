//! The meaning of scenes: the full scene, copies, selectors, overrides, commands.

use crate::common;
use common::*;
use opruga_core::spec::Value;
use opruga_io::Catalogue;
use opruga_io::scene::{Limits, Options, read};
use opruga_io::{overrides, reference, schema, template};
use opruga_world::blueprint::{Action, AnyBlueprint, LoadKind, Mass, Selector};
use std::sync::Arc;

#[test]
fn the_full_scene_has_all_its_parts() {
    let scene = plane(FULL);
    assert_eq!(scene.name, "scene");
    assert_eq!(scene.title, "Everything");
    assert_eq!(scene.seed, 7);
    assert_eq!(scene.time.substeps, 16);
    assert_eq!(scene.surroundings.gravity, [0.0, -9.81]);
    assert_eq!(scene.surroundings.largest_force, Some(1e6));
    assert_eq!(scene.integrator.kind(), "newton");
    assert_eq!(scene.integrator.integer("iterations"), Some(12));
    assert_eq!(scene.bodies.len(), 1 + 6 + 1);
    let ball = &scene.bodies[0];
    assert_eq!((&ball.mass, ball.mesh.nodes(), ball.angular_velocity.as_slice()), (&Mass::Total(1.0), 36, &[0.5][..]));
    assert_eq!(ball.models[1].rows("temperature"), [[0.0, 1.0], [2.0, 1.5]]);
    assert_eq!(ball.pins[0].motion[1], [1.0, 0.5, 0.0]);
    assert_eq!(scene.bodies[7].pins[0].select, Selector::All);
    assert_eq!(scene.loads[1].body, 4);
    assert_eq!(scene.loads[2].kind, LoadKind::Pressure(10.0));
    // Commands are sorted by time.
    assert_eq!(scene.commands.iter().map(|c| c.at).collect::<Vec<_>>(), [1.0, 1.0, 1.5, 2.0, 2.5, 3.0, 5.0]);
    assert_eq!(
        scene.commands[3].action,
        Action::Set { path: "body.ball.models.pressure.nRT".into(), value: Value::Number(50.0) }
    );
}

#[test]
fn copies_share_their_mesh_and_jitter_by_the_seed() {
    let scene = plane(FULL);
    let row = &scene.bodies[1..7];
    assert!(row.iter().all(|b| Arc::ptr_eq(&b.mesh, &row[0].mesh)));
    assert_eq!(row[4].name, "row[4]");
    for (k, body) in row.iter().enumerate() {
        let at = [5.5 + 2.0 * (k % 3) as f64, 2.0 * (k / 3) as f64];
        for a in 0..2 {
            let moved = body.translation[a] - at[a];
            assert!(moved != 0.0 && moved.abs() <= 0.1, "copy {k} is moved by {moved}");
        }
    }
    assert_eq!(scene.bodies, plane(FULL).bodies);
    assert_ne!(scene.bodies, plane(&FULL.replace("seed = 7", "seed = 8")).bodies);
    // Positions in selectors move along with every copy.
    let text = format!(
        "{HEAD}[[body]]\nname = \"b\"\nmass = 1\nshape = {{ kind = \"ring\", radius = 1, vertices = 4 }}\n\
        pin = [{{ select = {{ ball = {{ center = [1, 0], radius = 0.1 }} }} }}]\ncopies = {{ count = [3], spacing = [10, 0] }}\n"
    );
    for body in plane(&text).bodies {
        assert_eq!(body.pins[0].select.resolve(&body.mesh, &body.translation), [0]);
    }
}

#[test]
fn selectors_select() {
    let cases = [
        ("{ all = true }", vec![0, 1, 2, 3, 4, 5, 6, 7, 8]),
        ("{ boundary = true }", vec![0, 1, 2, 3, 5, 6, 7, 8]),
        ("{ side = \"top\" }", vec![6, 7, 8]),
        ("{ group = \"left\" }", vec![0, 3, 6]),
        ("{ box = [[0.4, 0.4], [2, 2]] }", vec![4, 5, 7, 8]),
        ("{ box = [[2, 2], [0.4, 0.4]] }", vec![4, 5, 7, 8]),
        ("{ ball = { center = [0, 0], radius = 0.5 } }", vec![0, 1, 3]),
        ("{ half_space = { point = [0.5, 0], normal = [2, 0] } }", vec![1, 2, 4, 5, 7, 8]),
        ("{ and = [ { side = \"top\" }, { side = \"left\" } ] }", vec![6]),
        ("{ or = [ { node = 4 }, { nodes = [1, 2, 2] } ] }", vec![1, 2, 4]),
        ("{ not = { boundary = true } }", vec![4]),
    ];
    for (select, nodes) in cases {
        let text = format!(
            "{HEAD}[[body]]\nname = \"g\"\nmass = 1\nshape = {{ kind = \"grid\", size = [1, 1], cells = [2, 2] }}\npin = [{{ select = {select} }}]\n"
        );
        let scene = plane(&text);
        assert_eq!(scene.bodies[0].pins[0].select.resolve(&scene.bodies[0].mesh, &[0.0; 2]), nodes, "{select}");
    }
}

#[test]
fn every_shape_is_made_with_as_many_nodes_as_estimated() {
    let plane_shapes = [
        "{ kind = \"ring\", radius = 1, vertices = 12, center = [1, 2], start_angle = 0.5 }",
        "{ kind = \"regular_polygon\", sides = 5, radius = 1, vertices_per_side = 3 }",
        "{ kind = \"polygon\", points = [[0, 0], [1, 0], [0, 1]] }",
        "{ kind = \"line\", from = [0, 0], to = [1, 0], segments = 4 }",
        "{ kind = \"polyline\", points = [[0, 0], [1, 0], [1, 1]], closed = true }",
        "{ kind = \"grid\", size = [1, 2], cells = [3, 4] }",
    ];
    let space_shapes = [
        "{ kind = \"grid\", size = [1, 2, 3], cells = [3, 4, 5] }",
        "{ kind = \"sheet\", u = [1, 0, 0], v = [0, 0, 1], cells = [3, 4] }",
        "{ kind = \"box\", size = [1, 1, 1], cells = [3, 2, 4] }",
        "{ kind = \"icosphere\", radius = 1, subdivisions = 2, center = [0, 0, 3] }",
        "{ kind = \"torus\", radius = 1, tube_radius = 0.2, nodes_around = 20, nodes_of_tube = 8 }",
        "{ kind = \"line\", from = [0, 0, 0], to = [1, 0, 0], segments = 4 }",
    ];
    let limits =
        |nodes: usize| Options { limits: Limits { nodes: nodes as u64, ..Limits::default() }, ..Options::default() };
    for shape in plane_shapes {
        let text = format!("{HEAD}[[body]]\nname = \"s\"\nmass = 1\nshape = {shape}\nrotation = 0.3\nscale = 2\n");
        let nodes = plane(&text).bodies[0].mesh.nodes();
        assert!(read_with(&text, &limits(nodes)).is_ok(), "{shape}");
        assert!(read_with(&text, &limits(nodes - 1)).is_err(), "{shape}");
    }
    for shape in space_shapes {
        let text =
            format!("{HEAD}[[body]]\nname = \"s\"\nmass = 1\nshape = {shape}\nrotation = [0.3, 0, 1]\nscale = 2\n")
                .replace("dimension = 2", "dimension = 3");
        let nodes = space(&text).bodies[0].mesh.nodes();
        assert!(read_with(&text, &limits(nodes)).is_ok(), "{shape}");
        assert!(read_with(&text, &limits(nodes - 1)).is_err(), "{shape}");
    }
}

fn overridden(text: &str, arguments: &[&str]) -> Result<AnyBlueprint, String> {
    let overrides = arguments.iter().map(|a| overrides::split(a).expect("PATH=VALUE")).collect();
    let options = Options { overrides, ..Options::default() };
    read_with(text, &options).map(|r| r.0).map_err(|e| e.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))
}

#[test]
fn overrides_reach_every_parameter() {
    let arguments = [
        "seed=3",
        "time.substeps=4",
        "world.gravity=[0, -1]",
        "integrator.iterations=5",
        "body.ball.mass=2.5",
        "body.1.density=7",
        "body.ball.models.mass_spring.stiffness=10",
        "body.0.models.0.edges=boundary",
        "collider.half_space.friction=0.9",
        "body.row.copies.count=[1]",
        "load.traction.body=row[0]",
    ];
    let Ok(AnyBlueprint::Plane(scene)) = overridden(FULL, &arguments) else {
        panic!("{:?}", overridden(FULL, &arguments))
    };
    assert_eq!((scene.seed, scene.time.substeps, scene.surroundings.gravity), (3, 4, [0.0, -1.0]));
    assert_eq!(scene.integrator.integer("iterations"), Some(5));
    assert_eq!((&scene.bodies[0].mass, &scene.bodies[1].mass), (&Mass::Total(2.5), &Mass::Density(7.0)));
    assert_eq!(scene.bodies[0].models[0].number("stiffness"), Some(10.0));
    assert_eq!(scene.bodies[0].models[0].text("edges"), Some("boundary"));
    assert_eq!(scene.colliders[0].values.number("friction"), Some(0.9));
    assert_eq!(scene.bodies.len(), 3);
    // The sections that the file lacks are made.
    assert!(overridden(HEAD, &["world.drag=1", "time.frame=0.5"]).is_ok());
}

#[test]
fn wrong_overrides_are_explained() {
    let cases = [
        (
            "body.bal.mass=1",
            "--set body.bal.mass=1: error[set.path]: `body` has no entry `bal`\n  = allowed: ball, row, wall\n  = hint: did you mean `ball`?",
        ),
        (
            "body.9.mass=1",
            "--set body.9.mass=1: error[set.path]: `body` has no entry 9\n  = allowed: numbers from 0 to 2",
        ),
        ("body.ball.mas=1", "--set body.ball.mas=1: error[scene.unknown_field]: there is no field `mas` in `body`"),
        (
            "time.substeps=0",
            "--set time.substeps=0: error[scene.range]: `substeps` is 0\n  = allowed: a whole number from 1 to 1000000",
        ),
        ("seed.x=1", "--set seed.x=1: error[set.path]: `seed` is a whole number, which has no fields"),
        ("world.gravity=[1", "--set world.gravity=[1: error[set.value]: the value is not TOML"),
        (
            "body.ball.mass=nan",
            "--set body.ball.mass=nan: error[scene.not_finite]: `mass` is not finite\n  = allowed: a number > 0",
        ),
    ];
    for (argument, expected) in cases {
        let text = overridden(FULL, &[argument]).expect_err(argument);
        assert!(text.starts_with(expected), "{argument}\n{text}");
    }
    assert_eq!(overrides::split("mass").expect_err("no value").code, "set.syntax");
}

#[test]
fn the_template_is_a_scene() {
    let scene = plane(&template::commented("my \"scene\"\n"));
    assert_eq!(scene.title, "my scene");
    assert_eq!((scene.bodies.len(), scene.colliders.len(), scene.commands.len(), scene.probes.len()), (1, 1, 1, 1));
}

/// The template names what the program really has.
#[test]
fn the_template_fits_the_registry() {
    let registry = opruga_world::Registry::<2>::default();
    let catalogue = Catalogue { models: registry.models(), integrators: registry.integrators(), ..catalogue() };
    let text = template::commented("ball");
    if let Err(errors) = read(text.as_bytes(), "ball.toml", &catalogue, &Options::default()) {
        panic!("{}", errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"));
    }
}

#[test]
fn the_reference_and_the_json_schema_name_every_field() {
    let page = reference::markdown(&catalogue());
    let json = schema::json_schema(&catalogue()).to_string();
    for word in [
        "seconds",
        "largest_force",
        "node_mass",
        "jitter",
        "motion",
        "stiffness",
        "iterations",
        "subdivisions",
        "nearest_facet",
        "record",
        "half_space",
        "traction",
        "curve",
    ] {
        assert!(page.contains(word), "{word} is missing in the page");
        assert!(json.contains(word), "{word} is missing in the schema");
    }
    assert!(page.contains("| `mass` | kg | a number > 0 |  | Mass of the whole body. |"), "{page}");
    assert!(schema::json_schema(&catalogue())["properties"]["time"]["required"] == serde_json::json!(["seconds"]));
}

#[test]
fn a_scene_without_bodies_is_a_scene() {
    assert!(plane(HEAD).bodies.is_empty());
    assert!(plane(&format!("\u{feff}{HEAD}")).bodies.is_empty());
    assert!(plane(&HEAD.replace('\n', "\r\n")).bodies.is_empty());
}

#[test]
fn lenient_and_strict() {
    let text = format!("{HEAD}{BALL}colour = \"red\"\n");
    assert!(read_text(&text).is_err());
    let lenient = Options { lenient: true, ..Options::default() };
    let (_, notices) = read_with(&text, &lenient).expect("lenient");
    assert_eq!((notices.len(), notices[0].about.code), (1, "scene.unknown_field"));
    // A clockwise polygon is reversed, and this is reported.
    let text = format!(
        "{HEAD}[[body]]\nname = \"p\"\nmass = 1\nshape = {{ kind = \"polygon\", points = [[0, 0], [0, 1], [1, 0]] }}\n"
    );
    assert_eq!(read_text(&text).expect("turned").1[0].about.code, "shape.flipped");
    assert!(read_with(&text, &Options { strict: true, ..Options::default() }).is_err());
}

/// Bodies that commands add are numbered after the others, in the order of time, whatever their order in the file; loads, commands, probes and
/// parameters may name them.
#[test]
fn bodies_that_come_later_can_be_named() {
    let add = |name: &str, at: f64| {
        format!(
            "[[command]]\ndo = \"add\"\nat = {at:?}\nbody = {{ name = \"{name}\", shape = {{ kind = \"ring\", radius = 1, vertices = 4 }}, mass = 1, \
             models = [{{ kind = \"mass_spring\", stiffness = 1 }}] }}\n"
        )
    };
    let scene = plane(&format!(
        "{HEAD}{BALL}{}{}[[command]]\ndo = \"drag\"\nat = 3\nbody = \"first\"\nnode = 3\npath = [[3, 0, 0], [4, 1, 1]]\n\
         [[command]]\ndo = \"set\"\nat = 3\npath = \"body.second.models.mass_spring.stiffness\"\nvalue = 5\n\
         [[load]]\nkind = \"force\"\nbody = \"second\"\nselect = {{ side = \"top\" }}\nvalue = [0, 1]\n\
         [[probe]]\nname = \"p\"\nbody = \"first\"\nrecord = [\"position\"]\n",
        add("second", 2.0),
        add("first", 1.0)
    ));
    assert_eq!(scene.bodies.len(), 1);
    assert!(matches!(&scene.commands[0].action, Action::Add(body) if body.name == "first"));
    assert!(matches!(scene.commands[2].action, Action::Drag { body: 1, node: Some(3), .. }));
    assert_eq!((scene.loads[0].body, scene.probes[0].body), (2, 1));
    let misspelt = format!(
        "{HEAD}{}[[command]]\ndo = \"set\"\nat = 3\npath = \"body.late.models.mass_spring.stifness\"\nvalue = 5\n",
        add("late", 2.0)
    );
    assert_eq!(errors(&misspelt)[0].code, "scene.unknown_parameter");
}

/// A load, push or pin on a body with copies acts on all of them, with its positions moved along; on `name[i]` it acts on one.
#[test]
fn loads_and_commands_on_all_copies() {
    let on = |body: &str| {
        plane(&format!(
            "{HEAD}{BALL}copies = {{ count = [2, 3], spacing = [5, 7] }}\n\
             [[load]]\nkind = \"force\"\nbody = \"{body}\"\nselect = {{ ball = {{ center = [1, 0], radius = 0.1 }} }}\nvalue = [0, 1]\n\
             [[command]]\ndo = \"push\"\nat = 1\nuntil = 2\nbody = \"{body}\"\nselect = {{ box = [[0.9, -0.1], [1.1, 0.1]] }}\nforce = [1, 0]\n\
             [[command]]\ndo = \"pin\"\nat = 2\nuntil = 3\nbody = \"{body}\"\n"
        ))
    };
    let all = on("ball");
    assert_eq!((all.loads.len(), all.commands.len()), (6, 12));
    for (k, load) in all.loads.iter().enumerate() {
        let body = &all.bodies[load.body];
        assert_eq!((load.body, body.name.as_str()), (k, format!("ball[{k}]").as_str()));
        assert_eq!(load.select.resolve(&body.mesh, &body.translation), [0]);
        let Action::Push { body: pushed, select, .. } = &all.commands[k].action else { panic!("a push") };
        assert_eq!((*pushed, select.resolve(&body.mesh, &body.translation)), (k, vec![0]));
    }
    let one = on("ball[0]");
    assert_eq!((one.loads.len(), one.commands.len(), one.loads[0].body), (1, 2, 0));
    assert_eq!(one.loads[0], all.loads[0]);
}

/// Commands begin and end with frames, here of 1/60 s; a command that therefore never acts is reported with its line.
#[test]
fn commands_that_never_act_are_told() {
    let lasting = |what: &str, at: f64, until: f64| {
        format!("[[command]]\ndo = \"{what}\"\nat = {at}\nuntil = {until}\nbody = \"ball\"\n")
    };
    let push = |at: f64, until: f64| lasting("push", at, until) + "force = [1, 0]\n";
    let set = |at: f64| format!("[[command]]\ndo = \"set\"\nat = {at}\npath = \"world.gravity\"\nvalue = [{at}, 0]\n");
    let remove = |at: f64| format!("[[command]]\ndo = \"remove\"\nat = {at}\nbody = \"ball\"\n");
    let drag = "[[command]]\ndo = \"drag\"\nat = 0.005\nbody = \"ball\"\npath = [[0.005, 0, 0], [0.012, 1, 0]]\n";
    let between = "the command begins at 0.005 s and ends at 0.012 s, and no frame begins in between";
    let last = "and no frame of the run begins then or later";
    let cases = [
        (push(0.005, 0.012), Some((between.to_string(), 15))),
        (lasting("pin", 0.005, 0.012), Some((between.to_string(), 15))),
        (drag.to_string(), Some((between.to_string(), 16))),
        (push(0.0, 0.01), None),
        (push(0.016, 0.017), None),
        (
            set(0.005) + &set(0.012),
            Some(("`world.gravity` is set at 0.005 s and again at 0.012 s, and no frame begins in between".into(), 14)),
        ),
        (set(0.012) + &set(0.02), None),
        (remove(0.983_333), None),
        (remove(0.99), Some((format!("the command begins at 0.99 s, {last}"), 14))),
        (remove(1.0), Some((format!("the command begins at 1 s, {last}"), 14))),
        (push(0.99, 2.0), Some((format!("the command begins at 0.99 s, {last}"), 14))),
        (remove(1.5), Some(("the command begins at 1.5 s, but the run ends at 1 s".into(), 14))),
    ];
    for (commands, expected) in cases {
        let text = format!("{HEAD}{BALL}{commands}");
        let (_, notices) = read_text(&text).unwrap_or_else(|errors| panic!("{text}: {errors:?}"));
        let told: Vec<_> = notices.iter().map(|n| (n.about.code, n.about.message.as_str(), n.about.line)).collect();
        let expected: Vec<_> =
            expected.iter().map(|(message, line)| ("command.never", message.as_str(), Some(*line))).collect();
        assert_eq!(told, expected, "{text}");
        let strict = read_with(&text, &Options { strict: true, ..Options::default() });
        assert_eq!(strict.is_err(), !expected.is_empty(), "{text}");
    }
    // The same notice about several commands is counted.
    let twice = push(0.005, 0.012).repeat(2);
    let (_, notices) = read_text(&format!("{HEAD}{BALL}{twice}")).expect("a scene");
    assert_eq!(notices.iter().map(|n| n.count).collect::<Vec<_>>(), [2]);
    // An end that the call has set does not count as that of the scene.
    let options = Options { overrides: vec![("time.seconds".into(), "0.5".into())], ..Options::default() };
    assert_eq!(read_with(&format!("{HEAD}{BALL}{}", remove(0.7)), &options).expect("a scene").1, []);
}

/// Two rings are separate, a hole is in a ring, or a ring is in a hole; others are refused with the numbers of the two.
#[test]
fn rings_lie_apart_or_inside_one_of_the_other_sign() {
    let meet = |a: u32, b: u32| format!("the rings {a} and {b} cross or touch");
    let alike =
        |inner: u32, outer: u32| format!("ring {inner} lies inside ring {outer}, and their radii have the same sign");
    let alone =
        |ring: u32| format!("ring {ring} is a hole, because its radius is negative, but it lies inside no other ring");
    let fine = String::new;
    for (centers, radii, vertices, expected) in [
        ("[[0, 0], [2.5, 0], [0, 0]]", "[1, 1, -0.4]", 40, fine()),
        ("[[0, 0], [0.1, 0], [-0.5, 0]]", "[1, -0.4, -0.15]", 40, fine()),
        ("[[0, 0], [0, 0]]", "[-0.4, 1]", 40, fine()),
        ("[[0, 0], [0, 0], [0, 0]]", "[1, -0.6, 0.3]", 40, fine()),
        ("[[0, 0], [0, 0]]", "[1, 0.4]", 40, alike(1, 0)),
        ("[[0, 0], [0, 0], [0, 0.1]]", "[1, -0.6, -0.3]", 40, alike(2, 1)),
        ("[[0, 0], [0.5, 0]]", "[1, 1]", 40, meet(0, 1)),
        ("[[0, 0], [2, 0]]", "[1, 1]", 40, meet(0, 1)),
        ("[[0, 5], [0, 0], [0, 2.001]]", "[1, 1, 1]", 40, fine()),
        ("[[0, 5], [0, 0], [0, 1.999]]", "[1, 1, 1]", 40, meet(1, 2)),
        ("[[0, 0], [0, 0]]", "[1, -1]", 40, meet(0, 1)),
        ("[[0, 0], [1, 0]]", "[1, -0.4]", 40, meet(0, 1)),
        ("[[0, 0], [0.6, 0]]", "[1, -0.4]", 40, meet(0, 1)),
        ("[[0, 0], [3, 0]]", "[1, -0.4]", 40, alone(1)),
        // Triangles are smaller than their circles: one triangle within the other, and one across a side of the other.
        ("[[0, 0], [0, 0]]", "[1, -0.9]", 3, fine()),
        ("[[0, 0], [-0.45, 0]]", "[1, -0.2]", 3, meet(0, 1)),
        ("[[0, 0], [-0.2, 0]]", "[1, -0.2]", 3, fine()),
    ] {
        let shape = format!("kind = \"rings\", centers = {centers}, radii = {radii}, vertices = {vertices}");
        let text = format!("{HEAD}{BALL}").replace("kind = \"ring\", radius = 1.0, vertices = 8", &shape);
        let said = read_text(&text).err().map_or(String::new(), |errors| errors[0].message.clone());
        assert_eq!(said, expected, "{shape}");
    }
}
