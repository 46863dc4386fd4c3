//! Bodies that start with the velocities of nodes in a mesh file.

use crate::common::{head, read};
use opruga::blueprint::AnyBlueprint;
use opruga::io::files::Files;
use opruga::io::series::{Format, Shape};
use opruga::io::{SceneError, scene};
use opruga::{Options, World, catalogue};
use std::sync::Arc;

const FILE: &str = "shape = { kind = \"mesh\", file = \"a.msh\", unreferenced = \"leave_out\" }\n";

/// A square of two triangles and a node without cells, with values of nodes.
fn square(values: &str) -> String {
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n9 5 5 0\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n\
         $Elements\n2\n1 2 0 1 2 3\n2 2 0 1 3 4\n$EndElements\n{values}"
    )
}

fn node_data(name: &str, components: usize, rows: &[&str]) -> String {
    format!("$NodeData\n1\n\"{name}\"\n1\n0\n3\n0\n{components}\n{}\n{}\n$EndNodeData\n", rows.len(), rows.join("\n"))
}

fn wind() -> String {
    node_data("wind", 3, &["4 4 0.5 0", "3 3 0.25 0", "2 2 0 0", "1 1 -1 0", "9 90 90 0"])
}

fn with_file(text: &str, name: &str, bytes: &[u8]) -> Result<AnyBlueprint, Vec<SceneError>> {
    let options =
        scene::Options { files: Files::in_memory([(name.to_string(), Arc::from(bytes))]), ..scene::Options::default() };
    scene::read(text.as_bytes(), "test.toml", &catalogue(), &options).map(|r| r.0)
}

fn plane(text: &str, file: &str) -> World<2> {
    match with_file(text, "a.msh", file.as_bytes()) {
        Ok(AnyBlueprint::Plane(blueprint)) => World::new(blueprint, Options::default()).expect("a world"),
        Ok(_) => panic!("a scene of the plane"),
        Err(errors) => panic!("{errors:?}"),
    }
}

fn velocities<const D: usize>(world: &World<D>, body: usize) -> Vec<[f64; D]> {
    (0..world.node_count(body) as u32).map(|node| world.velocity(body, node)).collect()
}

fn body(more: &str) -> String {
    head(0.01, 8, 0.0, "verlet") + "[[body]]\nname = \"b\"\ndensity = 900\n" + FILE + more
}

const SPRINGS: &str = "models = [{ kind = \"mass_spring\", stiffness = 100.0 }]\n";

#[test]
fn nodes_start_with_the_velocities_of_the_mesh_file() {
    let start = |more: &str| velocities(&plane(&(body(more) + SPRINGS), &square(&wind())), 0);
    let own = [[1.0, -1.0], [2.0, 0.0], [3.0, 0.25], [4.0, 0.5]];
    assert_eq!(start("velocity = { of_nodes = \"wind\" }\n"), own);
    assert_eq!(
        start("velocity = { of_nodes = \"wind\" }\nscale = 10\nposition = [3, 4]\n"),
        own,
        "scale changes lengths alone"
    );
    // The other fields of the table are added, about the centre of mass: (0.5, 0.5).
    let both = start("velocity = { of_nodes = \"wind\", linear = [10, 0], angular = 2 }\n");
    assert_eq!(both, [[12.0, -2.0], [13.0, 1.0], [12.0, 1.25], [13.0, -0.5]]);
    // A rotation of the body by a quarter turn rotates them, too.
    for (v, own) in start("rotation = 1.5707963267948966\nvelocity = { of_nodes = \"wind\" }\n").iter().zip(own) {
        assert!((v[0] + own[1]).abs() < 1e-15 && (v[1] - own[0]).abs() < 1e-15, "{v:?} {own:?}");
    }
    // All copies have them.
    let copies = plane(
        &(body("velocity = { of_nodes = \"wind\" }\ncopies = { count = [2, 1], spacing = [3, 3] }\n") + SPRINGS),
        &square(&wind()),
    );
    assert_eq!((velocities(&copies, 0), velocities(&copies, 1)), (own.to_vec(), own.to_vec()));
}

/// Midpoint nodes of cells of second order have the mean of both ends.
#[test]
fn nodes_in_the_middle_of_edges_have_the_mean_velocity() {
    let solid = "models = [{ kind = \"fem\", youngs_modulus = 1e5 }]\n";
    let world = plane(&(body("velocity = { of_nodes = \"wind\" }\n") + solid), &square(&wind()));
    assert_eq!(world.node_count(0), 9);
    let (all, at) = (velocities(&world, 0), |x: f64, y: f64| (0..9u32).find(|node| world.position(0, *node) == [x, y]));
    for (x, y, wanted) in [(0.5, 0.0, [1.5, -0.5]), (1.0, 0.5, [2.5, 0.125]), (0.5, 0.5, [2.0, -0.375])] {
        assert_eq!(all[at(x, y).expect("a node in the middle") as usize], wanted);
    }
}

/// Errors of a scene or its mesh file about velocities of nodes are reported where the scene names them.
#[test]
fn velocities_of_nodes_that_are_not_there_are_refused_with_those_that_are() {
    let rows = ["1 1 0 0", "2 1 0 0", "3 1 0 0", "4 1 0 0"];
    let more = wind()
        + &node_data("T", 1, &["1 1", "2 1", "3 1", "4 1"])
        + &node_data("few", 3, &rows[1..])
        + &node_data("up", 3, &["1 0 0 0", "2 0 0 0", "3 0 0 0.5", "4 0 0 0"]);
    let cases = [
        ("velocity = { of_nodes = \"wimd\" }", "scene.no_values", "wimd", "`few`, `up`, `wind`"),
        ("velocity = { of_nodes = \"T\" }", "scene.length", "1", "2, or 3 of which the last is 0"),
        ("velocity = { of_nodes = \"few\" }", "scene.not_finite", "NaN", "finite numbers for every node"),
        ("velocity = { of_nodes = \"up\" }", "scene.dimension", "0.5", "0 along z"),
    ];
    for (said, code, value, allowed) in cases {
        let errors = with_file(&(body(&format!("{said}\n")) + SPRINGS), "a.msh", square(&more).as_bytes())
            .err()
            .unwrap_or_default();
        let [error] = &errors[..] else { panic!("{said}: {errors:?}") };
        assert_eq!(
            (error.code, error.path.as_str(), error.line),
            (code, "body.0.velocity.of_nodes", Some(15)),
            "{error}"
        );
        assert_eq!((error.value.as_deref(), error.allowed.as_deref()), (Some(value), Some(allowed)), "{error}");
        assert!(error.hint.is_some() && error.file == "test.toml", "{error}");
    }
    let drawn = body("velocity = { of_nodes = \"wind\" }\n")
        .replace(FILE, "shape = { kind = \"grid\", size = [1, 1], cells = [1, 1] }\n");
    let errors = read(&drawn).err().unwrap_or_default();
    let [error] = &errors[..] else { panic!("{errors:?}") };
    assert_eq!((error.code, error.allowed.as_deref()), ("scene.no_values", Some("there are none")), "{error}");
    assert!(error.message.contains("the shape is a `grid`"), "{error}");
    let none = with_file(&body("velocity = { of_nodes = \"wind\" }\n"), "a.msh", square("").as_bytes())
        .err()
        .unwrap_or_default();
    assert_eq!(none[0].allowed.as_deref(), Some("there are none"));
}

/// A state continues in a new world of the same scene and file with the same bits, also if a command adds the body later.
#[test]
fn a_body_that_starts_with_velocities_of_nodes_goes_on_from_a_snapshot() {
    let added = head(0.01, 8, -9.81, "verlet")
        + "[[body]]\nname = \"a\"\nshape = { kind = \"grid\", size = [1, 1], cells = [1, 1] }\nmass = 1\n"
        + SPRINGS
        + "[[command]]\ndo = \"add\"\nat = 0.1\n[command.body]\nname = \"b\"\ndensity = 900\nvelocity = { of_nodes = \"wind\" }\n"
        + FILE
        + SPRINGS;
    for (number, text) in [body("velocity = { of_nodes = \"wind\" }\n") + SPRINGS, added].into_iter().enumerate() {
        let mut whole = plane(&text, &square(&wind()));
        crate::common::frames(&mut whole, 5);
        let state = whole.snapshot();
        crate::common::frames(&mut whole, 15);
        let mut again = plane(&text, &square(&wind()));
        again.restore(&state).expect("a state");
        crate::common::frames(&mut again, 15);
        assert_eq!(again.frame_hash(), whole.frame_hash());
        assert!(velocities(&whole, number).iter().flatten().any(|v| v.abs() > 0.5), "the body moves as the file says");
    }
}

/// The frame that a run writes as VTK XML starts another run, with the same positions and velocities of nodes to the last bit.
#[test]
fn a_frame_in_vtk_xml_is_the_start_of_another_run() {
    let text = "format = \"opruga-1\"\ndimension = 3\n[time]\nseconds = 1\nframe = 0.01\nsubsteps = 8\n[integrator]\nkind = \"verlet\"\n\
                [[body]]\nname = \"b\"\ndensity = 900\nposition = [0.1, 2, 3]\nvelocity = { linear = [1, 2, 3], angular = [0, 1, 5] }\n\
                shape = { kind = \"grid\", size = [1, 2, 1], cells = [2, 3, 1] }\nsimplices = true\nmodels = [{ kind = \"fem\", youngs_modulus = 1e6 }]\n";
    let Ok(AnyBlueprint::Space(blueprint)) = read(text) else { panic!("a scene of space") };
    let mut world = World::new(blueprint, Options::default()).expect("a world");
    crate::common::frames(&mut world, 7);
    let (at, fast) = (
        |world: &World<3>| -> Vec<[f64; 3]> {
            (0..world.node_count(0) as u32).map(|node| world.position(0, node)).collect()
        },
        velocities(&world, 0),
    );
    let blueprint = world.blueprint();
    let shape = Shape { body: &blueprint.bodies[0], positions: &at(&world), velocities: &fast, cell_fields: &[] };
    let mut file = Vec::new();
    Format::Vtu.write(&mut file, "", 0.07, &[shape]).expect("memory does not fail");
    let text = "format = \"opruga-1\"\ndimension = 3\n[time]\nseconds = 1\nframe = 0.01\nsubsteps = 8\n[integrator]\nkind = \"verlet\"\n\
                [[body]]\nname = \"b\"\ndensity = 900\nvelocity = { of_nodes = \"velocity [m/s]\" }\n\
                shape = { kind = \"mesh\", file = \"frame.vtu\" }\nmodels = [{ kind = \"fem\", youngs_modulus = 1e6 }]\n";
    let Ok(AnyBlueprint::Space(blueprint)) = with_file(text, "frame.vtu", &file) else { panic!("a scene of space") };
    let again = World::new(blueprint, Options::default()).expect("a world");
    assert_eq!((at(&again), velocities(&again, 0)), (at(&world), fast));
}
