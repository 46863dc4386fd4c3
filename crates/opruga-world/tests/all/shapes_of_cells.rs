//! Warnings about cells that are folded where no integration point shows it, and about cells that have rotated under a law of small rotations.

#![allow(clippy::disallowed_methods, reason = "shapes, and no bits")]

use crate::common;

use common::{solid, text};
use opruga_core::spec::Value;
use opruga_mesh::Mesh;
use opruga_world::blueprint::Blueprint;
use opruga_world::{Options, World};

fn body<const D: usize>(mesh: Mesh<D>, material: &str) -> Blueprint<D> {
    solid(mesh, "backward_euler", &[], &[("material", text(material)), ("youngs_modulus", Value::Number(1e4))])
}

fn world<const D: usize>(mesh: Mesh<D>, material: &str) -> World<D> {
    World::new(body(mesh, material), Options::default()).expect("a world")
}

/// A square or a cube of one box, cut into quadratic simplices.
fn quadratic<const D: usize>() -> Mesh<D> {
    let boxes = Mesh::<D>::grid([0.0; D], [1.0; D], [1; D]).expect("a box");
    boxes.into_simplices().expect("simplices").into_quadratic().expect("quadratic")
}

/// Moves the middle node of the first edge of the first quadratic cell to a fraction of that edge. Returns the warning, and the value at the
/// integration points.
fn shifted<const D: usize>(part: f64) -> (Option<String>, f64) {
    let mesh = quadratic::<D>();
    let cell: Vec<u32> = mesh.cells.iter().next().expect("a cell").2.to_vec();
    let (a, b, middle) = (cell[0], cell[1], cell[D + 1]);
    let mut world = world(mesh.clone(), "stable_neo_hookean");
    let (p, q) = (mesh.positions[a as usize], mesh.positions[b as usize]);
    world.set_node(0, middle, core::array::from_fn(|d| p[d] + part * (q[d] - p[d])), [0.0; D]).expect("placed");
    let points = world.cell_states(0).iter().map(|cell| cell.smallest_volume_ratio).fold(f64::INFINITY, f64::min);
    (world.inverted_cells().map(|warning| warning.message), points)
}

/// Beyond three quarters of an edge the map of a cell folds at the corner, and the integration points do not show it.
#[test]
fn quadratic_cells_that_fold_at_a_corner_are_inside_out() {
    for (part, folded) in [(0.5, false), (0.74, false), (0.76, true), (0.26, false), (0.24, true)] {
        let (plane, of_plane) = shifted::<2>(part);
        let (space, of_space) = shifted::<3>(part);
        assert!(of_plane > 0.0 && of_space > 0.0, "{part}: integration points are right side out");
        assert_eq!((plane.is_some(), space.is_some()), (folded, folded), "{part}: {plane:?} {space:?}");
        if let Some(said) = plane {
            // J along the edge falls from 3 − 4·0.24 at one corner to 3 − 4·0.76 at the other.
            assert!(said.contains("with J = -0.04"), "{said}");
        }
    }
}

/// The same for boxes: a corner beyond the diagonal of its neighbours.
#[test]
fn boxes_that_fold_at_a_corner_are_inside_out() {
    let found = |to: f64| {
        let mesh = Mesh::<2>::grid([0.0; 2], [1.0; 2], [1; 2]).expect("a square");
        let mut world = world(mesh, "stable_neo_hookean");
        let corner = (0..4).find(|node| world.position(0, *node) == [1.0, 1.0]).expect("a corner");
        world.set_node(0, corner, [to; 2], [0.0; 2]).expect("placed");
        (world.inverted_cells().map(|w| w.message), world.cell_states(0)[0].smallest_volume_ratio)
    };
    assert_eq!(found(0.51).0, None);
    let (said, points) = found(0.49);
    assert!(points > 0.0);
    assert!(said.is_some_and(|said| said.contains("J = -0.02")));
    let mut world = world(Mesh::<3>::grid([0.0; 3], [1.0; 3], [1; 3]).expect("a cube"), "stable_neo_hookean");
    let corner = (0..8).find(|node| world.position(0, *node) == [1.0; 3]).expect("a corner");
    world.set_node(0, corner, [0.66; 3], [0.0; 3]).expect("placed");
    assert!(world.cell_states(0)[0].smallest_volume_ratio > 0.0 && world.inverted_cells().is_some());
    world.set_node(0, corner, [0.68; 3], [0.0; 3]).expect("placed");
    assert_eq!(world.inverted_cells(), None);
}

/// Bodies under large bending, tension and shear, without folded cells, are not reported; nor are cells whose nodes at a quarter of their sides make
/// the volume at a corner zero even at rest.
#[test]
fn cells_that_are_strained_far_and_not_folded_are_not_warned_of() {
    let mesh = Mesh::<3>::grid([0.0; 3], [4.0, 1.0, 1.0], [8, 2, 2]).expect("a bar");
    for mesh in [mesh.clone(), mesh.into_simplices().expect("simplices").into_quadratic().expect("quadratic")] {
        let positions = mesh.positions.clone();
        let mut world = world(mesh, "stable_neo_hookean");
        let bent = |x: [f64; 3]| {
            let (r, t) = (1.3 - (x[1] - 0.5), x[0] / 1.3);
            [r * t.sin() + 0.3 * x[2], 2.0 - r * t.cos(), 0.4 * x[2]]
        };
        for (node, x) in positions.iter().enumerate() {
            world.set_node(0, node as u32, bent(*x), [0.0; 3]).expect("placed");
        }
        assert_eq!(world.inverted_cells(), None);
    }
    let mut mesh = quadratic::<2>();
    let [a, b, _, middle, ..] = mesh.cells.quadratic_triangles[0];
    let (p, q) = (mesh.positions[a as usize], mesh.positions[b as usize]);
    mesh.positions[middle as usize] = core::array::from_fn(|d| p[d] + 0.25 * (q[d] - p[d]));
    let mut world = world(mesh, "stable_neo_hookean");
    world.set_node(0, b, [q[0] + 0.01, q[1] + 0.02], [0.0; 2]).expect("placed");
    assert_eq!(world.inverted_cells(), None);
}

/// A cell that is folded at rest is refused, even if the integration points do not show it.
#[test]
fn quadratic_cells_that_are_folded_at_rest_are_refused() {
    let mut mesh = quadratic::<2>();
    let [a, b, _, middle, ..] = mesh.cells.quadratic_triangles[0];
    let (p, q) = (mesh.positions[a as usize], mesh.positions[b as usize]);
    mesh.positions[middle as usize] = core::array::from_fn(|d| p[d] + 0.8 * (q[d] - p[d]));
    let error = World::new(body(mesh, "stable_neo_hookean"), Options::default()).expect_err("refused");
    assert_eq!(error.code(), "model.inverted_cell", "{error:?}");
}

/// The warning about rotated cells after a square has rotated for some frames at an angular velocity [rad/s].
fn spun(material: &str, spin: f64, frames: usize) -> Option<(String, u64)> {
    let mesh = Mesh::<2>::grid([0.0; 2], [1.0; 2], [2; 2]).expect("a square");
    let mut blueprint = body(mesh, material);
    blueprint.bodies[0].angular_velocity = vec![spin];
    let mut world = World::new(blueprint, Options::default()).expect("a world");
    (0..frames).for_each(|_| world.frame().expect("a frame"));
    world.warnings().into_iter().find(|w| w.code == "law.turned").map(|w| (w.message, w.count))
}

/// A frame takes 1/60 s, so 1 rad/s reaches 20° in 21 frames.
#[test]
fn cells_of_the_linear_law_that_turn_by_more_than_twenty_degrees_are_warned_of() {
    assert_eq!(spun("linear", 1.0, 20), None);
    let (said, count) = spun("linear", 1.0, 24).expect("a warning");
    assert!(said.contains("body `body`") && said.contains("`corotated`"), "{said}");
    assert!((2..=4).contains(&count), "{count} frames");
    assert_eq!(spun("corotated", 1.0, 60), None);
    assert_eq!(spun("stable_neo_hookean", 1.0, 60), None);
}

/// The criterion is the rotation of cells, independent of the motion of the whole body, of strain, and of small shear.
#[test]
fn strains_are_no_rotations_and_rotations_of_cells_are() {
    let mesh = Mesh::<3>::grid([0.0; 3], [4.0, 1.0, 1.0], [8, 2, 2]).expect("a bar");
    let simplices = mesh.clone().into_simplices().expect("simplices");
    for mesh in [mesh, simplices.clone(), simplices.into_quadratic().expect("quadratic")] {
        let told = |shape: &dyn Fn([f64; 3]) -> [f64; 3]| {
            let mut world = world(mesh.clone(), "linear");
            for (node, x) in mesh.positions.iter().enumerate() {
                world.set_node(0, node as u32, shape(*x), [0.0; 3]).expect("placed");
            }
            // Pins that hold the nodes at the given positions.
            world.frame().expect("a frame");
            world.warnings().into_iter().find(|w| w.code == "law.turned").map(|w| w.message)
        };
        let turned = |angle: f64| {
            move |x: [f64; 3]| {
                let (s, c) = angle.to_radians().sin_cos();
                [c * x[0] - s * x[2], x[1], s * x[0] + c * x[2]]
            }
        };
        assert_eq!(told(&turned(15.0)), None);
        assert!(told(&turned(30.0)).is_some());
        assert!(told(&turned(170.0)).is_some());
        // Twisted by 60° from end to end, by up to half of that in either direction from the middle of the body: its ends have rotated.
        assert!(told(&|x| turned_about_x(x, 60.0 * (x[0] / 4.0 - 0.5))).is_some());
        assert_eq!(told(&|x| turned_about_x(x, 20.0 * (x[0] / 4.0 - 0.5))), None);
    }
}

fn turned_about_x(x: [f64; 3], angle: f64) -> [f64; 3] {
    let (s, c) = angle.to_radians().sin_cos();
    let (y, z) = (x[1] - 0.5, x[2] - 0.5);
    [x[0], 0.5 + c * y - s * z, 0.5 + s * y + c * z]
}
