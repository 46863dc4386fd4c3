//! Statics of bodies that touch: they reach their common equilibrium.

use crate::contact::{contact, model, scene};
use crate::implicit_contact::force_on;
use opruga_math::message::Message as _;
use opruga_mesh::Mesh;
use opruga_world::blueprint::*;
use opruga_world::{Options, World};

/// A solid of 1e5 Pa.
fn block(name: &str, size: [f64; 2], cells: [u32; 2], x: [f64; 2], mass: f64) -> BodyBlueprint<2> {
    let mesh = Mesh::grid([0.0; 2], size, cells).expect("a grid");
    let fem = model::<2>("fem", &[("youngs_modulus", 1e5), ("poissons_ratio", 0.3), ("damping", 1e-2)]);
    BodyBlueprint { translation: x, ..BodyBlueprint::new(name, mesh, Mass::Total(mass), vec![fem]) }
}

/// A slab with pins below, and a free and heavy cube on it.
fn stack(rule: &str) -> Blueprint<2> {
    let mut slab = block("slab", [2.0, 0.5], [9, 3], [-0.5, -0.5], 2.0);
    slab.pins.push(PinBlueprint { select: Selector::Side("bottom".into()), axes: [true; 2], motion: Vec::new() });
    let mut scene = scene(rule, vec![slab, block("cube", [1.0, 1.0], [4, 4], [0.03, 0.02], 400.0)]);
    scene.surroundings.gravity = [0.0, -9.81];
    scene.time = Time { seconds: 10.0, frame: 1.0 / 60.0, substeps: 1 };
    scene.contact = contact::<2>(&[("friction", 0.5.into())]);
    scene
}

/// The height of the cube at its middle [m].
fn height(world: &World<2>) -> f64 {
    let top = |node: u32| world.position(1, node)[1];
    // The midpoints of its upper and lower sides.
    top(22) - top(2)
}

fn world<const D: usize>(scene: &Blueprint<D>, threads: usize) -> World<D> {
    World::new(scene.clone(), Options { threads, ..Options::default() }).expect("a world")
}

#[test]
fn a_stack_comes_to_its_balance_in_one_frame() {
    let at_rest = |threads: usize| {
        let mut world = world(&stack("equilibrium"), threads);
        world.frame().expect("a balance");
        world
    };
    let mut world = at_rest(1);
    assert_eq!(world.crossed_surfaces(), []);
    for (body, wanted) in [(0, -400.0 * 9.81), (1, 400.0 * 9.81)] {
        let force = force_on(&mut world, body);
        assert!((force[1] / wanted - 1.0).abs() < 1e-6 && force[0].abs() < 1e-3, "{body}: {force:?}");
    }
    // A second frame changes nothing.
    let before = height(&world);
    world.frame().expect("the same balance");
    assert!((height(&world) - before).abs() < 1e-7, "{} {before}", height(&world));
    let energy = world.energy();
    assert!(energy.closure < 1e-9 && energy.loss_contact == 0.0, "{energy:?}");
    let hash = at_rest(1).state_hash();
    assert_eq!(at_rest(3).state_hash(), hash);
}

/// The weight of the cube compresses it by 2 % of its height. Damped motion comes to rest in this state.
#[test]
fn a_pressed_cube_comes_to_rest_where_statics_says() {
    let mut still = world(&stack("equilibrium"), 1);
    still.frame().expect("a balance");
    let wanted = 1.0 - height(&still);
    assert!(wanted > 0.015, "{wanted}");
    let mut moving = world(&stack("backward_euler"), 1);
    for _ in 0..600 {
        moving.frame().expect("a step");
    }
    let pressed = 1.0 - height(&moving);
    assert!((pressed / wanted - 1.0).abs() < 0.02, "{pressed} {wanted}");
}

/// Bodies of 5e4 Pa, each on the previous one, with meshes that do not match.
pub(crate) fn high_stack(bodies: usize, friction: f64) -> Blueprint<2> {
    let all = [
        ("slab", [3.0, 0.5], [24, 4], [-1.5, -0.5], 200.0),
        ("cube", [1.0, 1.0], [8, 8], [-0.6, 0.01], 400.0),
        ("top", [0.7, 0.6], [5, 4], [-0.5, 1.02], 100.0),
    ];
    let body = |(name, size, cells, at, mass): (&str, [f64; 2], [u32; 2], [f64; 2], f64)| {
        let mut body = block(name, size, cells, at, mass);
        let fem = model::<2>("fem", &[("youngs_modulus", 5e4), ("poissons_ratio", 0.3)]);
        body.models = vec![fem];
        body
    };
    let mut bodies: Vec<_> = all.into_iter().take(bodies).map(body).collect();
    bodies[0].pins.push(PinBlueprint { select: Selector::Side("bottom".into()), axes: [true; 2], motion: Vec::new() });
    let mut scene = scene("equilibrium", bodies);
    scene.surroundings.gravity = [0.0, -9.81];
    scene.time = Time { seconds: 0.05, frame: 0.05, substeps: 1 };
    scene.contact = contact::<2>(&[("friction", friction.into())]);
    scene
}

#[test]
fn high_stacks_come_to_their_balance() {
    for (bodies, friction) in [(2, 0.5), (2, 0.0), (3, 0.5)] {
        let mut world = world(&high_stack(bodies, friction), 1);
        world.frame().unwrap_or_else(|error| panic!("{bodies}, {friction}: {error}"));
        assert_eq!(world.crossed_surfaces(), []);
        let weights = [-9.81 * if bodies == 2 { 400.0 } else { 500.0 }, 9.81 * 400.0, 9.81 * 100.0];
        for (body, wanted) in weights.into_iter().take(bodies).enumerate() {
            let force = force_on(&mut world, body);
            let wrong = ((force[1] - wanted).abs() + force[0].abs()) / wanted.abs();
            assert!(wrong < 1e-6, "{bodies}, {friction}: {body}: {force:?} instead of {wanted}");
        }
    }
}

/// In space many contacts of flat faces support one weight, and there are many solutions for which of them stick or slide.
#[test]
fn a_cube_of_space_comes_to_its_balance_on_a_slab() {
    for friction in [0.5, 0.0] {
        let body = |name: &str, size: [f64; 3], cells: [u32; 3], at: [f64; 3], mass: f64| {
            let mesh = Mesh::grid([0.0; 3], size, cells).expect("a grid");
            let fem = model::<3>("fem", &[("youngs_modulus", 5e4), ("poissons_ratio", 0.3)]);
            BodyBlueprint { translation: at, ..BodyBlueprint::new(name, mesh, Mass::Total(mass), vec![fem]) }
        };
        let mut slab = body("slab", [2.0, 0.5, 2.0], [4, 1, 4], [-1.0, -0.5, -1.0], 200.0);
        slab.pins.push(PinBlueprint { select: Selector::Side("bottom".into()), axes: [true; 3], motion: Vec::new() });
        let cube = body("cube", [1.0; 3], [3; 3], [-0.6, 0.01, -0.4], 400.0);
        let mut scene = scene("equilibrium", vec![slab, cube]);
        scene.surroundings.gravity = [0.0, -9.81, 0.0];
        scene.time = Time { seconds: 0.05, frame: 0.05, substeps: 1 };
        scene.contact = contact::<3>(&[("friction", friction.into())]);
        let mut world = world(&scene, 1);
        world.frame().unwrap_or_else(|error| panic!("{friction}: {error}"));
        assert_eq!(world.crossed_surfaces(), []);
        let force = force_on(&mut world, 1);
        let wanted = 9.81 * 400.0;
        let wrong = (0..3).map(|d| (force[d] - if d == 1 { wanted } else { 0.0 }).abs()).sum::<f64>() / wanted;
        assert!(wrong < 1e-6, "{friction}: {force:?} instead of {wanted}");
    }
}

#[test]
fn overlap_is_taken_apart_and_what_nothing_holds_is_refused() {
    let mut overlapping = stack("equilibrium");
    overlapping.bodies[1].translation[1] = -0.01;
    let mut apart = world(&overlapping, 1);
    apart.frame().expect("a balance");
    assert_eq!(apart.crossed_surfaces(), []);
    let mut reference = world(&stack("equilibrium"), 1);
    reference.frame().expect("a balance");
    assert!((height(&apart) - height(&reference)).abs() < 1e-3, "{} {}", height(&apart), height(&reference));
    // A cube beside the slab falls forever.
    let mut falling = stack("equilibrium");
    falling.bodies[1].translation = [5.0, 0.0];
    let mut falling = world(&falling, 1);
    let kept = falling.state_hash();
    let error = falling.frame().expect_err("no balance");
    let said = error.in_full();
    assert!(said.contains("`cube`") && said.contains("no common equilibrium") && said.contains("hint"), "{said}");
    assert_eq!(falling.state_hash(), kept);
}

/// A block with pins below, and another one 31 mm above it, whose upper side moves down by the given displacement in each second. Nothing has weight.
fn lowered(ways: &[f64]) -> World<2> {
    let body = |name: &str, size: [f64; 2], cells: [u32; 2], at: [f64; 2], side: &str, motion: Vec<Vec<f64>>| {
        let mut body = block(name, size, cells, at, 1.0);
        body.pins.push(PinBlueprint { select: Selector::Side(side.into()), axes: [true; 2], motion });
        body
    };
    let mut motion = vec![vec![0.0; 3]];
    for (second, way) in ways.iter().enumerate() {
        motion.push(vec![second as f64 + 1.0, 0.0, motion[second][2] - way]);
    }
    let below = body("below", [1.0, 1.0], [2, 2], [0.1, -1.03], "bottom", Vec::new());
    let above = body("above", [1.0, 2.0], [2, 4], [0.13, 0.001], "top", motion);
    let mut scene = scene("equilibrium", vec![below, above]);
    scene.time = Time { seconds: ways.len() as f64, frame: 1.0, substeps: 1 };
    scene.contact = contact::<2>(&[("thickness", 1e-3.into())]);
    world(&scene, 1)
}

/// The residual of a body on which no force acts is rounding, and so are the forces on it.
#[test]
fn bodies_without_forces_do_not_keep_others_from_their_balance() {
    let mut world = lowered(&[0.0, 0.02]);
    for second in 0..2 {
        world.frame().unwrap_or_else(|error| panic!("{second}: {error}"));
        for body in 0..2 {
            assert_eq!(force_on(&mut world, body), [0.0; 2], "{second}: {body}");
        }
    }
}

#[test]
fn a_block_that_comes_down_presses_one_on_which_no_force_acted() {
    let mut world = lowered(&[0.02, 0.03]);
    world.frame().expect("a balance apart");
    world.frame().expect("a balance");
    assert_eq!(world.crossed_surfaces(), []);
    // The nodes of the lower side of the first block and of the upper side of the second.
    let held = [(0, [0, 1, 2]), (1, [12, 13, 14])].map(|(body, nodes)| world.reaction(body, &nodes)[1]);
    // Together they are 3 m high and are shortened by 20 mm. A bar would need 1e5 · 0.02/3 N; pins and plane strain stiffen the blocks.
    assert!(held[0] > 7e2 && held[0] < 1e3, "{held:?}");
    assert!((held[0] + held[1]).abs() < 1e-6 * held[0], "{held:?}");
    for (body, held) in held.into_iter().enumerate() {
        let pushed = force_on(&mut world, body)[1];
        assert!((pushed + held).abs() < 1e-6 * held.abs(), "{body}: {pushed} {held}");
    }
}
