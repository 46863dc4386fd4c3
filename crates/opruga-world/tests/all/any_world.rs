//! A world without a dimension in its type shows the same numbers and has the same effects as the underlying world.

use crate::common::{solid, text};
use opruga_core::spec::Value;
use opruga_mesh::Mesh;
use opruga_world::blueprint::{AnyBlueprint, Blueprint};
use opruga_world::{AnyWorld, Options, World};

/// Three alike bodies, which are stepped side by side, and one of another shape. All of them move and rotate.
fn scene<const D: usize>() -> Blueprint<D> {
    let grid = |cells: u32| Mesh::<D>::grid([0.0; D], [1.0; D], [cells; D]).expect("a grid");
    let material =
        [("material", text("linear")), ("youngs_modulus", Value::Number(1e4)), ("poissons_ratio", Value::Number(0.3))];
    let body = |cells: u32| solid(grid(cells), "symplectic_euler", &[], &material).bodies.remove(0);
    let mut scene = solid(grid(1), "symplectic_euler", &[], &material);
    scene.time.substeps = 64;
    scene.surroundings.gravity[1] = -9.81;
    // Copies share their rest shape; only such bodies are stepped side by side.
    let copy = body(1);
    scene.bodies = vec![copy.clone(), copy.clone(), copy, body(2)];
    for (number, body) in scene.bodies.iter_mut().enumerate() {
        body.name = format!("body {number}");
        body.translation[0] = 3.0 * number as f64;
        body.velocity[1] = 1.0 + number as f64;
        body.angular_velocity = vec![0.5; if D == 2 { 1 } else { 3 }];
    }
    scene
}

/// The vector in space, with 0 for the coordinates that it lacks.
fn three<const D: usize>(vector: [f64; D]) -> [f64; 3] {
    core::array::from_fn(|d| vector.get(d).copied().unwrap_or(0.0))
}

fn shows_the_same<const D: usize>(of: fn(Blueprint<D>) -> AnyBlueprint) {
    let mut world = World::new(scene::<D>(), Options::default()).expect("a world");
    let mut any = of(scene::<D>()).build(Options::default()).expect("a world");
    assert_eq!(any.scene().dimension(), D);
    for _ in 0..3 {
        world.frame().expect("a frame");
        any.frame().expect("a frame");
    }
    assert_eq!((any.state_hash(), any.frame_hash()), (world.state_hash(), world.frame_hash()));
    assert_eq!(any.snapshot(), world.snapshot());
    assert_eq!(any.bodies(), [0, 1, 2, 3]);
    for body in any.bodies() {
        let count = world.node_count(body);
        let (positions, velocities) = (any.positions(body), any.velocities(body));
        assert_eq!([positions.len(), velocities.len(), positions.iter().len()], [count; 3]);
        assert_eq!(positions.columns().len(), D);
        // Bodies that are stepped side by side are interleaved in memory too; a single body is contiguous.
        assert_eq!(positions.columns()[0].as_slice().is_some(), body == 3);
        for node in 0..count {
            let of_node = (world.position(body, node as u32), world.velocity(body, node as u32));
            assert_eq!((positions.at(node), velocities.at(node)), (three(of_node.0), three(of_node.1)));
            (0..D).for_each(|d| assert_eq!(velocities.columns()[d].iter().nth(node), Some(of_node.1[d])));
        }
        assert!(positions.at(count)[0].is_nan(), "there is no such node");
        let forces: Vec<[f64; 3]> = world.node_forces(body, None).into_iter().map(three).collect();
        assert_eq!((forces.len(), any.forces(body, None)), (count, forces));
    }
}

#[test]
fn columns_and_forces_are_those_of_the_world_in_both_dimensions() {
    shows_the_same(AnyBlueprint::Plane);
    shows_the_same(AnyBlueprint::Space);
}

#[test]
fn a_body_that_is_gone_has_empty_columns() {
    let mut any: Box<dyn AnyWorld> = AnyBlueprint::Plane(scene()).build(Options::default()).expect("a world");
    any.remove_body("body 1").expect("it is there");
    assert!(any.positions(1).is_empty() && any.velocities(1).is_empty() && any.forces(1, None).is_empty());
    assert!(any.positions(9).is_empty());
    assert!(any.node_mass(1, 0).is_nan());
    assert_eq!(any.bodies(), [0, 2, 3]);
    assert_eq!((any.body("body 1"), any.body("body 3")), (None, Some(3)));
}

/// Inputs of a program through the trait are recorded, repeated and undone as those of the world itself.
#[test]
fn what_a_program_does_is_written_down_and_done_again() {
    let build = || AnyBlueprint::Space(scene()).build(Options::default()).expect("a world");
    let (mut one, mut other) = (build(), build());
    one.keep_inputs();
    let start = one.snapshot();
    one.set("world.drag", Value::Number(2.0)).expect("it can be set");
    one.remove_body("body 2").expect("it is there");
    for input in one.take_inputs() {
        other.repeat(&input.expect("it can be written")).expect("it can be repeated");
    }
    assert!(one.take_inputs().is_empty());
    one.frame().expect("a frame");
    other.frame().expect("a frame");
    assert_eq!(one.state_hash(), other.state_hash());
    one.restore(&start).expect("a state of the same scene");
    assert_eq!(one.state_hash(), build().state_hash());
    assert!(one.repeat(b"nonsense").is_err());
}
