//! Finite elements from the text of a scene: weight, bending, stable steps, errors.
//!
//! Expected values are literals from closed forms or from other programs, as the comments say.

use crate::common;
use common::*;
use opruga::math::message::Message;
use opruga::{Options, World, WorldError};

/// The mean of a coordinate over the nodes of body 0 at a given coordinate of the rest shape.
fn mean_at<const D: usize>(world: &World<D>, axis: usize, place: f64, of: usize) -> f64 {
    let rest = &world.blueprint().bodies[0].mesh.positions;
    let nodes: Vec<u32> = (0..rest.len() as u32).filter(|n| (rest[*n as usize][axis] - place).abs() < 1e-9).collect();
    nodes.iter().map(|n| world.position(0, *n)[of] - rest[*n as usize][of]).sum::<f64>() / nodes.len() as f64
}

/// A bar that hangs by its upper end elongates by ρgL²/2E = 0.03924 m, exactly at the nodes of quadrilaterals.
#[test]
fn a_hanging_bar_grows_by_its_weight() {
    for cells in ["", "simplices = true\norder = 1\n", "simplices = true\n"] {
        let mut world = built(plane(&format!(
            "{}[[body]]\nname = \"bar\"\nshape = {{ kind = \"grid\", size = [0.25, 1.0], cells = [2, 8] }}\n{cells}density = 1000\n\
             models = [{{ kind = \"fem\", material = \"linear\", youngs_modulus = 125000.0, poissons_ratio = 0.0, plane = \"stress\" }}]\n\
             pin = [{{ select = {{ side = \"top\" }}, axes = \"xy\" }}]\n",
            head(10.0, 1, -9.81, "backward_euler")
        )));
        frames(&mut world, 5);
        let growth = -mean_at(&world, 1, 0.0, 1);
        // The masses at the nodes of triangles are not exactly the integrals of their shape functions.
        let tolerance = if cells.is_empty() { 1e-6 } else { 2e-3 };
        assert!((growth / 0.03924 - 1.0).abs() < tolerance, "{cells}: {growth}");
    }
}

/// A beam of 1 × 0.1 × 0.1 m, ρ = 1000, ν = 0.3, E = 1e8, clamped at one end: 0.014686 m by quadratic elements of another
/// program (Euler–Bernoulli 0.014715, Timoshenko 0.014865).
#[test]
fn a_beam_of_quadratic_tetrahedra_bends_by_its_weight() {
    let mut world = built(space(
        "format = \"opruga-1\"\ndimension = 3\n[time]\nseconds = 1\nframe = 10.0\nsubsteps = 1\n[world]\n\
         gravity = [0, -9.81, 0]\n[integrator]\nkind = \"backward_euler\"\n\
         [[body]]\nname = \"beam\"\nshape = { kind = \"grid\", size = [1.0, 0.1, 0.1], cells = [12, 2, 2] }\nsimplices = true\n\
         density = 1000\n\
         models = [{ kind = \"fem\", material = \"neo_hookean\", youngs_modulus = 1e8, poissons_ratio = 0.3 }]\n\
         pin = [{ select = { side = \"left\" }, axes = \"xyz\" }]\n",
    ));
    frames(&mut world, 4);
    let sag = -mean_at(&world, 0, 1.0, 1);
    assert!((sag / 0.014686 - 1.0).abs() < 0.01, "{sag}");
}

/// The estimate of the stable step includes finite elements: above it the scene is refused, at it the energy is conserved.
#[test]
fn explicit_integrators_know_their_step() {
    let scene = |substeps: u32| {
        format!(
            "{}[[body]]\nname = \"beam\"\nshape = {{ kind = \"grid\", size = [1.0, 0.2], cells = [10, 2] }}\nsimplices = true\norder = 2\n\
             density = 1000\nmodels = [{{ kind = \"fem\", youngs_modulus = 1e7, poissons_ratio = 0.4 }}]\n\
             pin = [{{ select = {{ side = \"left\" }}, axes = \"xy\" }}]\n",
            head(0.02, substeps, -9.81, "verlet")
        )
    };
    let WorldError::UnstableStep { substeps, .. } = refused(&scene(1)) else { panic!("another refusal") };
    assert!((10..3000).contains(&substeps), "{substeps}");
    assert!(World::new(plane(&scene(substeps * 3 / 4)), Options::default()).is_err());
    // The beam becomes slightly stiffer where it bends.
    let mut world = built(plane(&scene(substeps * 5 / 4)));
    frames(&mut world, 50);
    let energy = world.energy();
    assert!(energy.elastic > 0.1, "{energy:?}");
    assert!(energy.closure.abs() < 0.02, "{energy:?}");
}

/// A square of St. Venant–Kirchhoff in plane stress, stretched along both axes, has no valid thickness.
#[test]
fn a_plate_without_thickness_ends_the_run_at_the_last_good_frame() {
    let mut world = built(plane(&format!(
        "{}[[body]]\nname = \"plate\"\nshape = {{ kind = \"grid\", size = [1.0, 1.0], cells = [2, 2] }}\ndensity = 1\n\
         models = [{{ kind = \"fem\", material = \"st_venant_kirchhoff\", youngs_modulus = 100.0, poissons_ratio = 0.4, plane = \"stress\" }}]\n",
        head(0.01, 40, 0.0, "verlet")
    )));
    // Every node moves away from the centre.
    for node in 0..world.node_count(0) as u32 {
        let x = world.position(0, node);
        world.set_node(0, node, x.map(|c| 0.5 + 1.4 * (c - 0.5)), [0.0; 2]).unwrap_or_else(|e| panic!("{e}"));
    }
    let before = world.time();
    let error = world.frame().expect_err("no thickness").to_string();
    assert!(error.contains("plate") && error.contains("no positive thickness") && error.contains("cell"), "{error}");
    assert_eq!(world.time(), before);
}

#[test]
fn cells_that_cannot_be_had_are_refused_where_they_are_asked_for() {
    let errors = |body: &str| {
        let scene = format!("{}[[body]]\nname = \"b\"\nmass = 1\n{body}\n", head(0.01, 10, 0.0, "verlet"));
        read(&scene).expect_err("errors").iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
    };
    let grid = "shape = { kind = \"grid\", size = [1.0, 1.0], cells = [2, 2] }";
    let of_boxes = errors(&format!("{grid}\norder = 2"));
    assert!(of_boxes.contains("order = 2") && of_boxes.contains("simplices = true"), "{of_boxes}");
    let of_ring = errors("shape = { kind = \"ring\", radius = 1.0, vertices = 9 }\nsimplices = true");
    assert!(of_ring.contains("`simplices`") && of_ring.contains("has none"), "{of_ring}");
    let third = errors(&format!("{grid}\norder = 3"));
    assert!(third.contains("from 1 to 2"), "{third}");
    let corners =
        "shape = { kind = \"quadrilateral\", corners = [[0, 0], [1, 0], [0.2, 0.2], [0, 1]], cells = [2, 2] }";
    assert!(errors(corners).contains("convex"), "{}", errors(corners));
    let locking = refused(&format!(
        "{}[[body]]\nname = \"b\"\nmass = 1\n{grid}\nsimplices = true\norder = 1\n\
         models = [{{ kind = \"fem\", youngs_modulus = 1.0, poissons_ratio = 0.49 }}]\n",
        head(0.01, 10, 0.0, "verlet")
    ))
    .in_full();
    assert!(locking.contains("order = 2"), "{locking}");
}

/// Bodies of finite elements consist by default of elements that do not lock: quadratic triangles and tetrahedra, whether the shape is cut, filled or
/// read. Bodies without elements keep their nodes.
#[test]
fn triangles_and_tetrahedra_of_finite_elements_are_quadratic_by_default() {
    let nodes = |body: &str, model: &str| {
        let scene = format!(
            "{}[[body]]\nname = \"b\"\nmass = 1\n{body}\nmodels = [{{ {model} }}]\n",
            head(0.01, 10, 0.0, "backward_euler")
        );
        built(plane(&scene)).node_count(0)
    };
    let fem = "kind = \"fem\", youngs_modulus = 1.0, poissons_ratio = 0.49";
    let loose = "kind = \"fem\", youngs_modulus = 1.0";
    let grid = "shape = { kind = \"grid\", size = [1.0, 1.0], cells = [2, 2] }";
    assert_eq!(nodes(grid, fem), 9);
    assert_eq!(nodes(&format!("{grid}\nsimplices = true"), fem), 25);
    assert_eq!(nodes(&format!("{grid}\nsimplices = true\norder = 1"), loose), 9);
    assert_eq!(nodes(&format!("{grid}\nsimplices = true"), "kind = \"mass_spring\", stiffness = 1.0"), 9);
    let heart =
        "shape = { kind = \"svg\", file = \"shapes/heart.svg\", spacing = 0.2, size = 1.0, filling = \"triangles\" }";
    assert!(nodes(heart, fem) > 3 * nodes(&format!("{heart}\norder = 1"), loose));
}

/// Two adjacent squares of one metre, with 1000 and 3000 kg/m³ and half a metre deep, as a mesh file gives them.
#[test]
fn a_mesh_file_gives_every_cell_its_density() {
    let mesh = |second: &str| {
        let nodes = "6\n1 0 0 0\n2 1 0 0\n3 2 0 0\n4 0 1 0\n5 1 1 0\n6 2 1 0\n";
        format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{nodes}$EndNodes\n$Elements\n2\n1 3 2 0 1 1 2 5 4\n2 3 2 0 1 2 3 6 5\n\
             $EndElements\n$ElementData\n1\n\"rho\"\n1\n0.0\n3\n0\n1\n2\n1 1000\n2 {second}\n$EndElementData\n"
        )
    };
    let read = |motion: &str, name: &str, second: &str| {
        let text = format!(
            "{}[[body]]\nname = \"two\"\nshape = {{ kind = \"mesh\", file = \"two.msh\" }}\nthickness = 0.5\n\
             density_of_cells = \"{name}\"\n{motion}\n\
             models = [{{ kind = \"fem\", youngs_modulus = 1e6, mass = \"consistent\" }}]\n",
            head(0.01, 1, 0.0, "implicit_midpoint")
        );
        let held = [("two.msh".to_string(), std::sync::Arc::from(mesh(second).as_bytes()))];
        let options = opruga::io::scene::Options {
            files: opruga::io::Files::in_memory(held),
            ..opruga::io::scene::Options::default()
        };
        opruga::io::scene::read(text.as_bytes(), "test.toml", &opruga::catalogue(), &options).map(|read| read.0)
    };
    let plane = |motion: &str| match read(motion, "rho", "3000") {
        Ok(opruga::blueprint::AnyBlueprint::Plane(blueprint)) => built(blueprint),
        other => panic!("{other:?}"),
    };
    let thrown = plane("velocity = [2.0, 0.0]");
    assert!((thrown.momentum().linear.0[0] - 4000.0).abs() < 1e-9, "{:?}", thrown.momentum());
    // About the centre of mass at x = 1.25 m: Σ m (a² + b²)/12 + m d².
    let turned = plane("angular_velocity = 3.0");
    let inertia = 500.0 * (1.0 / 6.0 + 0.75 * 0.75) + 1500.0 * (1.0 / 6.0 + 0.25 * 0.25);
    assert!((turned.momentum().angular[2] / (3.0 * inertia) - 1.0).abs() < 1e-12, "{:?}", turned.momentum());
    assert!((turned.energy().kinetic / (4.5 * inertia) - 1.0).abs() < 1e-12, "{:?}", turned.energy());
    for (name, second, said) in [("sigma", "3000", "`rho`"), ("rho", "0", "a number > 0")] {
        let errors = read("", name, second).expect_err("an error");
        assert!(errors.len() == 1 && errors[0].to_string().contains(said), "{errors:?}");
        assert_eq!(errors[0].path, "body.0.density_of_cells");
    }
}

/// A linear law cannot represent a pendulum: pinned at one node, or in space along one edge, a block rotates without limit, whatever its weight. The
/// same block with another law hangs, and a linear one is held by a second pin.
#[test]
fn a_linear_body_that_only_its_weight_would_hold_is_refused_with_its_rotation() {
    let body = |material: &str, size: &str, cells: &str, pins: &str| {
        format!(
            "[[body]]\nname = \"block\"\nshape = {{ kind = \"grid\", size = {size}, cells = {cells} }}\ndensity = 10\n\
             models = [{{ kind = \"fem\", material = \"{material}\", youngs_modulus = 1e5, poissons_ratio = 0.3 }}]\npin = [{pins}]\n"
        )
    };
    let flat =
        |material: &str, pins: &str| head(1.0, 1, -1.0, "equilibrium") + &body(material, "[1.0, 2.0]", "[1, 2]", pins);
    let solid = |material: &str, pins: &str| {
        let head =
            head(1.0, 1, -1.0, "equilibrium").replace("dimension = 2", "dimension = 3").replace("-1.0]", "-1.0, 0]");
        head + &body(material, "[1.0, 2.0, 3.0]", "[1, 2, 2]", pins)
    };
    let (node, edge) = ("{ select = { nodes = [0] } }", "{ select = { nodes = [0, 1] } }");
    let told = "The forces of this body are linear, so a moment would rotate it for ever";
    for (error, what) in [
        (refused(&flat("linear", node)), "prevents rotation: 1 rigid mode. "),
        (
            World::new(space(&solid("linear", edge)), Options::default()).expect_err("it turns about its edge"),
            "prevents rotation about an axis along x: 1 rigid mode. ",
        ),
    ] {
        let message = error.in_full();
        assert!(message.contains(what) && message.contains(told) && message.contains("`neo_hookean`"), "{message}");
    }
    for material in ["neo_hookean", "st_venant_kirchhoff"] {
        assert!(World::new(plane(&flat(material, node)), Options::default()).is_ok(), "{material}");
        assert!(World::new(space(&solid(material, edge)), Options::default()).is_ok(), "{material}");
    }
    let mut held =
        built(plane(&flat("linear", "{ select = { nodes = [0] } }, { select = { nodes = [1] }, axes = \"y\" }")));
    frames(&mut held, 1);
    assert!(mean_at(&held, 1, 2.0, 1) < 0.0);
}

/// A bar of 1 × 0.2 × 0.2 m that pins compress by 0.4 m, straight or skewed, buckles: its straight shape remains an equilibrium, but an unstable one.
/// Iterations that reach it leave it again, within the default number.
#[test]
fn a_bar_that_is_pressed_until_it_buckles_is_followed_by_default() {
    let bar = |rule: &str, cells: &str, substeps: u32, motion: &str| {
        space(&format!(
            "format = \"opruga-1\"\ndimension = 3\n[time]\nseconds = 1\nframe = 0.05\nsubsteps = {substeps}\n[world]\n\
             gravity = [0, 0, 0]\n[integrator]\nkind = \"{rule}\"\n[[body]]\nname = \"bar\"\n\
             shape = {{ kind = \"grid\", size = [1.0, 0.2, 0.2], cells = [8, 2, 2] }}\n{cells}density = 1000\n\
             models = [{{ kind = \"fem\", youngs_modulus = 1e6, poissons_ratio = 0.4 }}]\n\
             pin = [{{ select = {{ side = \"left\" }} }}, {{ select = {{ side = \"right\" }}, motion = [[0, 0, 0, 0], {motion}] }}]\n"
        ))
    };
    for (rule, cells, substeps, motion, most) in [
        ("backward_euler", "simplices = true\n", 4, "[1.0, -0.4, 0.0, 0.0]", 800),
        ("equilibrium", "", 1, "[1.0, -0.5, 0.5, 0.0]", 400),
    ] {
        let mut world = built(bar(rule, cells, substeps, motion));
        for frame in 0..20 {
            world.frame().unwrap_or_else(|error| panic!("{rule}, frame {frame}: {error}"));
        }
        let work = world.solver_work();
        println!("{rule}: {work:?}");
        assert!(work.iterations < most, "{rule}: {work:?}");
        // Bowed out in any direction, or by the skew of the pins: no node in the middle is where pure compression would leave it.
        let (up, aside) = (mean_at(&world, 0, 0.5, 1), mean_at(&world, 0, 0.5, 2));
        let up = up - if motion.contains("0.5, 0.0") { 0.25 } else { 0.0 };
        let bow = (up * up + aside * aside).sqrt();
        println!("{rule}: the middle is bowed out by {bow} m");
        assert!(bow > 0.05, "{rule}: {bow}");
        // Corners of quadratic cells may fold, which no integration point detects; no cell is inverted at an integration point.
        assert!(world.cell_states(0).iter().all(|cell| cell.smallest_volume_ratio > 0.0), "{rule}");
    }
}
