//! Contact of bodies with implicit integrators is part of the balance of forces.

use crate::contact::{ball, contact, deepest, model, passes, scene, wall_and_dot, world};
use opruga_core::spec::Value;
use opruga_math::Lane;
use opruga_mesh::Mesh;
use opruga_world::blueprint::*;
use opruga_world::{Options, World};

const RULES: [&str; 4] = ["backward_euler", "bdf2", "implicit_midpoint", "newmark"];

/// A solid rectangle of triangles.
pub(crate) fn block(
    name: &str,
    size: [f64; 2],
    cells: [u32; 2],
    x: [f64; 2],
    mass: f64,
    youngs_modulus: f64,
) -> BodyBlueprint<2> {
    let mesh = Mesh::grid([0.0; 2], size, cells).expect("a grid");
    let solid =
        vec![model::<2>("fem", &[("youngs_modulus", youngs_modulus), ("poissons_ratio", 0.3), ("damping", 1e-3)])];
    BodyBlueprint { translation: x, ..BodyBlueprint::new(name, mesh, Mass::Total(mass), solid) }
}

pub(crate) fn heavy(rule: &str, bodies: Vec<BodyBlueprint<2>>, substeps: u32) -> Blueprint<2> {
    let mut scene = scene(rule, bodies);
    scene.surroundings.gravity = [0.0, -9.81];
    scene.time = Time { seconds: 10.0, frame: 1.0 / 60.0, substeps };
    scene
}

/// The contact force of other bodies on a body [N].
pub(crate) fn force_on<const D: usize>(world: &mut World<D>, body: usize) -> [f64; D] {
    let mut sum = [0.0; D];
    for force in world.contact_forces(body) {
        (0..D).for_each(|d| sum[d] += force[d]);
    }
    sum
}

/// A block that falls onto a pinned one comes to rest there; the contact force equals its weight, with steps of a sixtieth of a second.
#[test]
fn blocks_come_to_rest_on_one_another_at_the_steps_of_a_game() {
    for rule in RULES {
        let mut below = block("below", [2.0, 0.5], [9, 3], [-0.5, -0.5], 2.0, 1e5);
        below.pins.push(PinBlueprint { select: Selector::Side("bottom".into()), axes: [true; 2], motion: Vec::new() });
        let bodies = vec![below, block("above", [1.0, 1.0], [4, 4], [0.03, 0.1], 1.0, 1e5)];
        let mut scene = heavy(rule, bodies, 1);
        scene.contact = contact::<2>(&[("friction", 0.4.into())]);
        let mut world = world(&scene);
        for _ in 0..180 {
            world.frame().unwrap_or_else(|error| panic!("{rule}: {error}"));
            assert_eq!(world.crossed_surfaces(), [], "{rule} at {} s", world.time());
        }
        let weight = force_on(&mut world, 1);
        assert!((weight[1] - 9.81).abs() < 1e-3 && weight[0].abs() < 1e-3, "{rule}: {weight:?}");
        let depth = deepest(&world);
        let energy = world.energy();
        assert!(depth == 0.0, "{rule}: {depth} m deep");
        assert!(energy.kinetic < 1e-9, "{rule}: {energy:?}");
        assert!(energy.closure < 1e-4, "{rule}: {energy:?}");
    }
}

/// Free bodies with the same and with different integrators: momentum is conserved, no body passes through another, and the ledger closes.
#[test]
fn bodies_of_all_rules_meet_and_keep_momentum() {
    let rules = || RULES.into_iter().chain(["symplectic_euler"]);
    for (first, second) in rules().flat_map(|first| rules().map(move |second| (first, second))) {
        if first == second && first == "symplectic_euler" {
            continue;
        }
        let registry = opruga_world::Registry::<2>::default();
        let own = |rule: &str, body: BodyBlueprint<2>| BodyBlueprint {
            integrator: Some(registry.integrator_values(rule, &[]).expect("a rule")),
            ..body
        };
        let [a, b] = [([-1.2, 0.1], [2.0, 0.0]), ([1.0, 0.0], [-1.0, 0.3])];
        let square = block("b", [1.0, 1.0], [3, 3], [b.0[0] - 0.5, b.0[1] - 0.5], 2.0, 3e3);
        let bodies = vec![own(first, ball("a", 24, a.0, a.1)), own(second, BodyBlueprint { velocity: b.1, ..square })];
        let mut scene = scene("symplectic_euler", bodies);
        scene.time = Time { seconds: 2.0, frame: 1.0 / 60.0, substeps: 8 };
        scene.contact = contact::<2>(&[("friction", 0.4.into())]);
        let mut world = world(&scene);
        let before = world.momentum();
        let mut met = 0.0;
        for _ in 0..60 {
            world.frame().unwrap_or_else(|error| panic!("{first} {second}: {error}"));
            assert_eq!(world.crossed_surfaces(), [], "{first} {second}");
            let energy = world.energy();
            met = energy.loss_contact + energy.loss_friction;
            assert!(energy.closure < 0.02, "{first} {second}: {energy:?}");
        }
        let after = world.momentum();
        for d in 0..2 {
            let change = (after.linear.0[d] - before.linear.0[d]).abs();
            assert!(change < 1e-6, "{first} {second}: {change} {before:?} {after:?}");
        }
        assert!(met > 1e-3, "{first} {second}: they met: {met}");
        let mean = |body: usize| {
            let nodes = world.node_count(body) as u32;
            (0..nodes).map(|n| world.velocity(body, n)[0]).sum::<f64>() / f64::from(nodes)
        };
        let speed = mean(0) - mean(1);
        assert!(speed < 0.0, "{first} {second}: they part: {speed}");
    }
}

pub(crate) fn fixed(body: BodyBlueprint<2>) -> BodyBlueprint<2> {
    let pin = PinBlueprint { select: Selector::Box([-1e3; 2], [1e3; 2]), axes: [true; 2], motion: Vec::new() };
    BodyBlueprint { pins: vec![pin], ..body }
}

/// A square of springs that falls onto a fixed box.
pub(crate) fn square_over_a_box(response: &str) -> Blueprint<2> {
    let mut mesh = Mesh::grid([-0.4; 2], [0.8; 2], [6; 2]).expect("a grid");
    let (sine, cosine) = (libm::sin(0.902), libm::cos(0.902));
    mesh.positions.iter_mut().for_each(|x| *x = [cosine * x[0] - sine * x[1], sine * x[0] + cosine * x[1]]);
    let fields = [("stiffness", 800.0.into()), ("damping", 1.0.into()), ("edges", "shear".into())];
    let springs = vec![opruga_world::Registry::<2>::default().model_values("mass_spring", &fields).expect("springs")];
    let square = BodyBlueprint {
        translation: [9.427714865254298, 1.9],
        velocity: [-2.387, -7.888],
        ..BodyBlueprint::new("square", mesh, Mass::Total(2.56), springs)
    };
    let sides = Mesh::polyline(&[[9.0, 0.0], [11.0, 0.0], [11.0, 1.0], [9.0, 1.0]], true).expect("a box");
    let base = fixed(BodyBlueprint::new("box", sides, Mass::Total(1.0), Vec::new()));
    let mut scene = heavy("backward_euler", vec![base, square], 1);
    scene.contact = contact::<2>(&[("friction", 0.3.into()), ("response", response.into())]);
    scene
}

/// The impulses that the last round of a step finds are not tried in another round.
#[test]
fn a_square_of_springs_does_not_sink_into_a_box() {
    let mut world = world(&square_over_a_box("constraint"));
    for _ in 0..30 {
        world.frame().unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(world.crossed_surfaces(), [], "at {} s", world.time());
    }
}

/// A corner of an obstacle below an edge whose nodes the obstacle holds: the edge cannot respond, and no response is requested.
#[test]
fn a_ring_rests_on_a_line_with_a_corner_in_its_middle() {
    let ring = Mesh::ring(0.4, 36, [0.0; 2], 0.0).expect("a ring");
    let gas = vec![
        model::<2>("mass_spring", &[("stiffness", 1600.0), ("damping", 1.0)]),
        model::<2>("pressure", &[("nRT", 100.0), ("ambient", 120.0)]),
    ];
    let ring = BodyBlueprint { translation: [0.06, 0.6], ..BodyBlueprint::new("ring", ring, Mass::Total(1.0), gas) };
    let mut scene = heavy("backward_euler", vec![ring], 1);
    let points = Value::Rows(vec![vec![-1.0, 0.0], vec![0.0, 0.0], vec![1.0, 0.0]]);
    scene.colliders.push(ColliderBlueprint::new::<2>("polyline", &[("points", points)]).expect("a collider"));
    let mut world = world(&scene);
    for _ in 0..120 {
        world.frame().unwrap_or_else(|error| panic!("{error}"));
        assert!(world.energy().closure < 1e-6, "{:?}", world.energy());
    }
    let lowest = (0..36).map(|node| world.position(0, node)[1]).fold(f64::INFINITY, Lane::smaller);
    assert!(lowest.abs() < 1e-3, "{lowest}");
}

/// A small body that moves many times its size in a step hits a thin wall.
#[test]
fn fast_bodies_do_not_tunnel_through_bodies_of_implicit_rules() {
    for speed in [1.0, 30.0, 300.0, 3000.0] {
        for rule in RULES {
            let mut scene = scene(rule, wall_and_dot(speed));
            scene.time.frame = 1.0 / 960.0;
            scene.time.substeps = 1;
            let mut world = world(&scene);
            let all = |world: &World<2>| -> Vec<[f64; 2]> {
                (0..41).map(|n| world.position(0, n)).chain((0..2).map(|n| world.position(1, n))).collect()
            };
            let mut before = all(&world);
            for step in 0..(if speed < 2.0 { 480 } else { 64 }) {
                world.frame().unwrap_or_else(|error| panic!("{rule} {speed}: {error}"));
                assert_eq!(world.crossed_surfaces(), [], "{rule}, {speed} m/s, step {step}");
                let after = all(&world);
                let path = |n: usize| [before[n], after[n]];
                for (point, edge) in (0..40).flat_map(|k| [41, 42].map(|point| (point, [k, k + 1]))) {
                    assert!(!passes(path(point), edge.map(path)), "{rule}, {speed} m/s, step {step}: {point} {edge:?}");
                }
                before = after;
            }
        }
    }
}

/// The same bits on any number of threads, and after rewinding.
#[test]
fn contact_of_implicit_rules_has_the_same_bits() {
    let mut bodies = Vec::new();
    for k in 0..6 {
        let x = [1.05 * f64::from(k % 3), 1.1 * f64::from(k / 3)];
        bodies.push(block(&format!("block[{k}]"), [1.0, 1.0], [3, 3], x, 1.0, 2e4));
    }
    let mut scene = heavy("backward_euler", bodies, 2);
    scene.contact = contact::<2>(&[("friction", 0.3.into())]);
    let fields = [("point", Value::Numbers(vec![0.0, -0.1])), ("normal", Value::Numbers(vec![0.1, 1.0]))];
    scene.colliders.push(ColliderBlueprint::new::<2>("half_space", &fields).expect("a plane"));
    let run = |threads: usize| {
        let mut world = World::new(scene.clone(), Options { threads, ..Options::default() }).expect("a world");
        (0..30).for_each(|_| world.frame().expect("a frame"));
        let kept = world.snapshot();
        (0..30).for_each(|_| world.frame().expect("a frame"));
        let end = world.frame_hash();
        world.restore(&kept).expect("the same scene");
        (0..30).for_each(|_| world.frame().expect("a frame"));
        assert_eq!(world.frame_hash(), end, "{threads}: after going back");
        assert_eq!(world.crossed_surfaces(), []);
        end
    };
    let one = run(1);
    assert_eq!(run(3), one);
}

#[test]
fn solids_and_sheets_of_space_rest_on_one_another() {
    solids_and_sheets_rest("exact");
}

#[test]
#[ignore = "a sweep: cargo test -- --ignored whole_sweep"]
fn solids_and_sheets_of_space_rest_on_one_another_by_steps_of_a_budget_whole_sweep() {
    solids_and_sheets_rest("real_time");
}

/// In space, with everything that may support a body: an obstacle below, a pin at the side, a sheet that folds onto itself.
fn solids_and_sheets_rest(accuracy: &str) {
    let registry = opruga_world::Registry::<3>::default();
    let rule = registry.integrator_values("backward_euler", &[("accuracy", accuracy.into())]).expect("a rule");
    let solid = |name: &str, size: f64, x: [f64; 3], mass: f64| {
        let mesh = Mesh::grid([0.0; 3], [size; 3], [2; 3]).expect("a grid");
        let fem = vec![model::<3>("fem", &[("youngs_modulus", 5e4), ("poissons_ratio", 0.3)])];
        BodyBlueprint { translation: x, ..BodyBlueprint::new(name, mesh, Mass::Total(mass), fem) }
    };
    let sheet = Mesh::sheet([-0.2, -0.2, 2.3], [[1.4, 0.0, 0.0], [0.0, 1.4, 0.0]], [6, 6]).expect("a sheet");
    let cloth = vec![
        model::<3>("mass_spring", &[("stiffness", 300.0), ("damping", 0.02)]),
        model::<3>("bending", &[("stiffness", 1e-4)]),
    ];
    let bodies = vec![
        solid("below", 1.0, [0.0, 0.0, 0.05], 1.0),
        solid("above", 0.8, [0.12, 0.07, 1.1], 4.0),
        BodyBlueprint::new("cloth", sheet, Mass::Total(0.1), cloth),
    ];
    let mut scene = scene("backward_euler", bodies);
    scene.bodies.iter_mut().for_each(|body| body.integrator = Some(rule.clone()));
    scene.surroundings.gravity = [0.0, 0.0, -9.81];
    scene.time = Time { seconds: 3.0, frame: 1.0 / 60.0, substeps: 1 };
    scene.contact = contact::<3>(&[("friction", 0.5.into())]);
    let fields = [
        ("point", Value::Numbers(vec![0.0; 3])),
        ("normal", Value::Numbers(vec![0.0, 0.0, 1.0])),
        ("friction", 0.5.into()),
    ];
    scene.colliders.push(ColliderBlueprint::new::<3>("half_space", &fields).expect("a plane"));
    let mut world = world(&scene);
    for _ in 0..100 {
        world.frame().unwrap_or_else(|error| panic!("{accuracy}: {error}"));
        assert_eq!(world.crossed_surfaces(), [], "{accuracy} at {} s", world.time());
    }
    let energy = world.energy();
    assert!(energy.closure < 0.02, "{accuracy}: {energy:?}");
    assert!(energy.kinetic < 5e-3, "{accuracy}: {energy:?}");
    let lowest = |body: usize| {
        (0..world.node_count(body) as u32).map(|n| world.position(body, n)[2]).fold(f64::INFINITY, Lane::smaller)
    };
    assert!(lowest(1) > 0.9 && lowest(2) > 0.0, "{accuracy}: {} {}", lowest(1), lowest(2));
    assert!(energy.in_motion < 20.0, "{accuracy}: no body gets more energy than its fall: {energy:?}");
}

/// Light and stiff blocks that start closer than the distance of their surfaces are separated only by what is missing, with every integrator:
/// displacements move points individually, whereas impulses would move the whole body.
#[test]
fn light_and_stiff_bodies_that_begin_too_near_part_by_no_more_than_they_lack() {
    for rule in RULES {
        for mass in [1e-3, 1.0, 1e3] {
            let (thickness, lack) = (0.02, 0.005);
            let mut below = block("below", [1.0, 0.5], [12, 6], [0.0, -0.5], mass, 1e6);
            below.pins.push(PinBlueprint {
                select: Selector::Side("bottom".into()),
                axes: [true; 2],
                motion: Vec::new(),
            });
            let mut above = block("above", [1.0, 0.5], [10, 5], [0.0, thickness - lack], mass, 1e6);
            above.pins.push(PinBlueprint { select: Selector::Side("top".into()), axes: [true; 2], motion: Vec::new() });
            let mut scene = scene(rule, vec![below, above]);
            scene.time = Time { seconds: 1.0, frame: 0.1, substeps: 1 };
            scene.contact = contact::<2>(&[("thickness", thickness.into()), ("friction", 0.0.into())]);
            let mut world = world(&scene);
            for _ in 0..5 {
                world.frame().unwrap_or_else(|error| panic!("{rule}, {mass} kg: {error}"));
                for body in 0..2 {
                    let blueprint = &scene.bodies[body];
                    for (node, x) in blueprint.mesh.positions.iter().enumerate() {
                        let now = world.position(body, node as u32);
                        let way = (0..2)
                            .map(|d| (now[d] - x[d] - blueprint.translation[d]).abs())
                            .fold(0.0, |most: f64, c| c.larger(most));
                        assert!(way <= lack, "{rule}, {mass} kg: node {node} of body {body} went {way} m");
                    }
                }
            }
        }
    }
}
