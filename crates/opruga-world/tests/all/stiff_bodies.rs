//! Bodies so stiff for their mass that rounding of positions causes forces above their weight: as a whole they still follow the closed form of the
//! integrator.

#![allow(clippy::disallowed_methods, reason = "closed forms, and no bits")]

use crate::common;

use common::{solid, text};
use opruga_core::spec::{Value, Values};
use opruga_mesh::Mesh;
use opruga_world::blueprint::{ColliderBlueprint, Mass, PinBlueprint, Selector};
use opruga_world::{Options, World};

const GRAVITY: f64 = 9.81;
const SUBSTEPS: u32 = 4;
const H: f64 = 1.0 / 60.0 / SUBSTEPS as f64;

type Fields<'a> = &'a [(&'a str, Value)];

fn body<const D: usize>(
    mesh: Mesh<D>,
    rule: &str,
    of_rule: Fields<'_>,
    stiffness: f64,
    density: f64,
) -> opruga_world::blueprint::Blueprint<D> {
    let fields = [("youngs_modulus", Value::Number(stiffness)), ("poissons_ratio", Value::Number(0.3))];
    let mut scene = solid(mesh, rule, of_rule, &fields);
    scene.time.substeps = SUBSTEPS;
    scene.bodies[0].mass = Mass::Density(density);
    scene.surroundings.gravity = core::array::from_fn(|d| if d == 1 { -GRAVITY } else { 0.0 });
    scene
}

fn square(size: f64) -> Mesh<2> {
    Mesh::<2>::grid([0.0; 2], [size; 2], [4, 4]).expect("a square")
}

/// The displacement of a point in free fall from rest after the given steps of an integrator.
fn falls_by(rule: &str, steps: usize) -> f64 {
    let (mut x, mut v, mut way, mut before) = (0.0, 0.0, 0.0, 0.0);
    for step in 0..steps {
        let backward = rule == "backward_euler" || rule == "bdf2" && step == 0;
        let (x0, v0) = (x, v);
        if backward {
            v += H * GRAVITY;
            x += H * v;
        } else if rule == "bdf2" {
            v = (4.0 * v0 - before) / 3.0 + 2.0 / 3.0 * H * GRAVITY;
            x = x0 + way / 3.0 + 2.0 / 3.0 * H * v;
        } else {
            v += H * GRAVITY;
            x += 0.5 * H * (v0 + v);
        }
        (way, before) = (x - x0, v0);
    }
    x
}

/// An integrator, its parameters, and whether it runs in real time.
type RuleRow = (&'static str, &'static [(&'static str, f64)], bool);

const RULES: [RuleRow; 7] = [
    ("backward_euler", &[], false),
    ("bdf2", &[], false),
    ("newmark", &[], false),
    ("newmark", &[("spectral_radius", 0.5)], false),
    ("implicit_midpoint", &[], false),
    ("backward_euler", &[], true),
    ("bdf2", &[], true),
];

fn fields(numbers: &[(&'static str, f64)], real_time: bool) -> Vec<(&'static str, Value)> {
    let accuracy = ("accuracy", text(if real_time { "real_time" } else { "exact" }));
    numbers.iter().map(|(name, number)| (*name, Value::Number(*number))).chain([accuracy]).collect()
}

/// Lets a body fall for half a second; returns the largest difference between the expected and the actual displacement of its nodes.
fn falls_short<const D: usize>(scene: opruga_world::blueprint::Blueprint<D>, rule: &str) -> (f64, World<D>) {
    let from = scene.bodies[0].mesh.positions.clone();
    let mut world = World::new(scene, Options::default()).expect("a world");
    (0..30).for_each(|_| world.frame().expect("a frame"));
    let wanted = falls_by(rule, 30 * SUBSTEPS as usize);
    let mut worst: f64 = 0.0;
    for (node, from) in from.iter().enumerate() {
        let at = world.position(0, node as u32);
        for d in 0..D {
            let way = if d == 1 { wanted } else { 0.0 };
            worst = worst.max((at[d] - from[d] + way).abs());
        }
    }
    (worst, world)
}

#[test]
fn grains_of_silicon_fall_by_the_closed_form_of_every_rule() {
    for (rule, numbers, real_time) in RULES {
        let of_rule = fields(numbers, real_time);
        let (worst, world) = falls_short(body(square(1e-5), rule, &of_rule, 1.7e11, 2330.0), rule);
        assert!(worst < 2e-14, "{rule} {of_rule:?}: {worst} m");
        let told = world.warnings().into_iter().find(|warning| warning.code == "conditioning").expect("a warning");
        assert!(told.message.contains("forces up to "), "{told:?}");
    }
    let cube = Mesh::<3>::grid([0.0; 3], [1e-5; 3], [2, 2, 2]).expect("a cube");
    let (worst, _) = falls_short(body(cube, "backward_euler", &[], 1.7e11, 2330.0), "backward_euler");
    assert!(worst < 2e-14, "{worst} m");
}

#[test]
fn bodies_fall_however_stiff_they_are() {
    for (rule, numbers, real_time) in RULES {
        for stiffness in [1e13, 1e15, 1e17, 1e18, 1e22, 1e40] {
            let of_rule = fields(numbers, real_time);
            let (worst, _) = falls_short(body(square(1.0), rule, &of_rule, stiffness, 1000.0), rule);
            // Below this stiffness the matrix provides everything that `tolerance` requires.
            let allowed = if stiffness < 1e16 { 1e-7 } else { 1e-13 };
            assert!(worst < allowed, "{rule} {of_rule:?} at {stiffness} Pa: {worst} m");
        }
    }
}

#[test]
fn steel_far_from_the_origin_falls() {
    let mut scene = body(square(0.01), "backward_euler", &[], 2e11, 7800.0);
    scene.bodies[0].translation = [3e4, -1e5];
    let mut world = World::new(scene, Options::default()).expect("a world");
    let before = world.position(0, 0)[1];
    (0..30).for_each(|_| world.frame().expect("a frame"));
    let (fell, wanted) = (before - world.position(0, 0)[1], falls_by("backward_euler", 120));
    // The resolution of positions there is 1.5e-11 m.
    assert!((fell - wanted).abs() < 2e-9, "{fell} m, {wanted} m");
    assert!(world.warnings().iter().any(|warning| warning.code == "conditioning"), "{:?}", world.warnings());
}

#[test]
fn stiff_pieces_of_a_body_fall_each_by_itself() {
    let mut mesh = Mesh::<2>::grid([0.0; 2], [3.0, 1.0], [3, 1]).expect("a grid");
    mesh.cells.quadrilaterals.remove(1);
    let (worst, _) = falls_short(body(mesh, "backward_euler", &[], 1e18, 1000.0), "backward_euler");
    assert!(worst < 2e-9, "{worst} m");
}

/// Implicit midpoint keeps the angular momentum of a free body.
#[test]
fn stiff_rods_that_spin_keep_their_angular_momentum() {
    let rod = Mesh::<2>::grid([-0.5, -0.05], [1.0, 0.1], [10, 1]).expect("a rod");
    let mut scene = body(rod, "implicit_midpoint", &[], 1e18, 1000.0);
    scene.surroundings.gravity = [0.0; 2];
    scene.bodies[0].angular_velocity = vec![10.0];
    let mut world = World::new(scene, Options::default()).expect("a world");
    let before = world.momentum().angular[2];
    // The integrator stretches a body that rotates fast compared with the step, and eventually tears it apart.
    (0..10).for_each(|_| world.frame().expect("a frame"));
    let after = world.momentum().angular[2];
    assert!(before > 10.0 && (after / before - 1.0).abs() < 1e-9, "{before}, {after}");
    let rod = Mesh::<3>::grid([-0.5, -0.05, -0.05], [1.0, 0.1, 0.1], [5, 1, 1]).expect("a rod");
    let mut scene = body(rod, "implicit_midpoint", &[], 1e18, 1000.0);
    scene.surroundings.gravity = [0.0; 3];
    scene.bodies[0].angular_velocity = vec![1.0, 2.0, 5.0];
    let mut world = World::new(scene, Options::default()).expect("a world");
    let before = world.momentum().angular;
    (0..30).for_each(|_| world.frame().expect("a frame"));
    let after = world.momentum().angular;
    for axis in 0..3 {
        assert!((after[axis] - before[axis]).abs() < 1e-9 * before[2].abs(), "{before:?}, {after:?}");
    }
}

/// A square that hangs at one corner swings like one that is a million times softer and still stiff.
#[test]
fn stiff_bodies_swing_about_their_pin() {
    for (rule, numbers, real_time) in RULES {
        let ends = [1e11, 1e18].map(|stiffness| {
            let of_rule = fields(numbers, real_time);
            let mut scene = body(square(1.0), rule, &of_rule, stiffness, 1000.0);
            let corner = Selector::Nodes(vec![0]);
            scene.bodies[0].pins = vec![PinBlueprint { select: corner, axes: [true; 2], motion: Vec::new() }];
            let mut world = World::new(scene, Options::default()).expect("a world");
            (0..30).for_each(|_| world.frame().expect("a frame"));
            world.position(0, 24)
        });
        let apart = (ends[0][0] - ends[1][0]).hypot(ends[0][1] - ends[1][1]);
        let allowed = if real_time { 1e-2 } else { 1e-5 };
        assert!(ends[1][1] < 0.5 && apart < allowed, "{rule}, real time {real_time}: {ends:?}");
    }
}

fn floor(height: f64) -> ColliderBlueprint {
    let spec = opruga_collide::all(2).into_iter().find(|s| s.kind == "half_space").expect("a floor");
    let mut values = Values::defaults(spec, 2);
    for (name, numbers) in [("point", vec![0.0, height]), ("normal", vec![0.0, 1.0])] {
        values.set(spec, name, Value::Numbers(numbers), 2).expect("a field");
    }
    ColliderBlueprint { values }
}

#[test]
fn stiff_bodies_fall_onto_the_ground_and_rest_there() {
    for (stiffness, height) in [(1e15, 0.0), (1e18, 0.0), (1e15, 0.1), (1e18, 0.1)] {
        let mut scene = body(square(1.0), "backward_euler", &[], stiffness, 1000.0);
        scene.colliders = vec![floor(-height)];
        let mut world = World::new(scene, Options::default()).expect("a world");
        (0..30).for_each(|_| world.frame().expect("a frame"));
        for node in 0..25 {
            let (at, wanted) = (world.position(0, node)[1], f64::from(node / 5) * 0.25 - height);
            assert!(
                (at - wanted).abs() < 1e-9,
                "{stiffness} Pa from {height} m: node {node} at {at} m, not {wanted} m"
            );
        }
        // Rounding of positions corresponds to 400 N per node at 1e18 Pa.
        let borne: f64 = world.contact_forces(0).iter().map(|force| force[1]).sum();
        assert!((borne / (1000.0 * GRAVITY) - 1.0).abs() < 0.05, "{stiffness} Pa from {height} m: {borne} N");
    }
}

/// A tolerance below the rounding of positions and energies is met as far as rounding permits.
#[test]
fn tolerances_below_rounding_end_with_what_rounding_leaves() {
    for stiffness in [1e5, 1e8, 1e11] {
        let tolerance = [("tolerance", Value::Number(1e-14))];
        let (worst, _) =
            falls_short(body(square(1.0), "backward_euler", &tolerance, stiffness, 1000.0), "backward_euler");
        assert!(worst < 1e-10, "{stiffness} Pa: {worst} m");
    }
}
