//! Outlines and surfaces become bodies of finite elements by a single line, and are stepped implicitly.
#![allow(clippy::disallowed_methods, reason = "what tests expect needs no equal bits")]

use crate::common;
use common::*;
use opruga::World;

const FEM: &str = "density = 1000\nmodels = [{ kind = \"fem\", material = \"stable_neo_hookean\", youngs_modulus = 5e4, poissons_ratio = 0.4 }]\n";

/// The line that makes the shape, and the least numbers of nodes and cells.
fn fallen<const D: usize>(mut world: World<D>, shape: &str) {
    let cells = world.blueprint().bodies[0].mesh.cells.len();
    assert!(cells > 50, "{shape}: {cells} cells");
    let mass: f64 = {
        let before = world.momentum().linear.0;
        assert!(before.iter().all(|p| *p == 0.0));
        world.frame().unwrap_or_else(|e| panic!("{shape}: {e}"));
        // Backward Euler: the first step of h = 0.01 s adds m g h.
        world.momentum().linear.0[1] / (-9.81 * 0.01)
    };
    let measure = world.blueprint().bodies[0].mesh.measure().expect("a filled body").value();
    assert!((mass / (1000.0 * measure) - 1.0).abs() < 1e-6, "{shape}: {mass} kg in {measure}");
    frames(&mut world, 4);
    // In free fall nothing is strained, whatever the cells are: velocities are n g h.
    let energy = world.energy();
    let kinetic = 0.5 * mass * (9.81f64 * 0.05).powi(2);
    assert!((energy.kinetic / kinetic - 1.0).abs() < 1e-6, "{shape}: {} J, not {kinetic}", energy.kinetic);
    assert!(energy.elastic.abs() < 1e-6 * kinetic, "{shape}: {} J of strain", energy.elastic);
}

#[test]
fn outlines_are_solids_in_one_line() {
    let italy = "kind = \"map\", file = \"shapes/countries-110m.json\", layer = \"countries\", feature = \"Italy\"";
    let word = "kind = \"text\", file = \"shapes/inter-black-subset.otf\", text = \"OR\"";
    let fish = "kind = \"svg\", file = \"shapes/fish.svg\", overlap = \"union\"";
    let heart = "kind = \"svg\", file = \"shapes/heart.svg\"";
    for (shape, spacing, filling, order) in [
        (heart, 0.1, "triangles", 1),
        (heart, 0.1, "triangles", 2),
        (heart, 0.1, "lattice", 1),
        (italy, 0.04, "triangles", 2),
        (italy, 0.06, "lattice", 1),
        (word, 0.03, "triangles", 2),
        (fish, 0.08, "triangles", 1),
        (fish, 0.1, "lattice", 1),
    ] {
        let shape = format!("{shape}, spacing = {spacing}, size = 1.0, filling = \"{filling}\"");
        let rule = "backward_euler";
        let text = format!(
            "{}[[body]]\nname = \"it\"\nshape = {{ {shape} }}\norder = {order}\n{FEM}",
            head(0.01, 1, -9.81, rule)
        );
        fallen(built(plane(&text)), &shape);
    }
}

#[test]
fn surfaces_are_solids_in_one_line() {
    for (file, spacing, filling, order) in [
        ("spot", 0.15, "tetrahedra", "order = 1"),
        // Quadratic by default.
        ("torus", 0.16, "tetrahedra", ""),
        ("torus", 0.15, "lattice", "order = 1"),
    ] {
        let shape = format!(
            "kind = \"surface\", file = \"shapes/{file}.obj\", size = 1.0, filling = \"{filling}\", spacing = {spacing}"
        );
        let text = format!(
            "format = \"opruga-1\"\ndimension = 3\n[time]\nseconds = 1\nframe = 0.01\nsubsteps = 1\n[world]\ngravity = [0, -9.81, 0]\n\
             [integrator]\nkind = \"backward_euler\"\n[[body]]\nname = \"it\"\nshape = {{ {shape} }}\n{order}\n{FEM}"
        );
        fallen(built(space(&text)), &shape);
    }
}
