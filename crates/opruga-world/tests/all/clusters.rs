//! Clusters: bodies that may touch are stepped through a frame together, all others on their own.

use crate::contact::{ball, contact, model, scene};
use crate::implicit_contact::heavy;
use opruga_core::spec::Value;
use opruga_mesh::Mesh;
use opruga_world::blueprint::*;
use opruga_world::{Options, Registry, World};

/// Positions and velocities of some bodies after some frames.
fn end(scene: &Blueprint<2>, bodies: &[usize], frames: u32, threads: usize, batches: bool) -> Vec<[u64; 4]> {
    let mut world = World::new(scene.clone(), Options { threads, batches, ..Options::default() }).expect("a world");
    (0..frames).for_each(|_| world.frame().expect("a frame"));
    let bits = |world: &World<2>, body: usize, node: u32| {
        let (x, v) = (world.position(body, node), world.velocity(body, node));
        [x[0], x[1], v[0], v[1]].map(f64::to_bits)
    };
    bodies
        .iter()
        .flat_map(|b| (0..world.node_count(*b) as u32).map(move |n| (*b, n)))
        .map(|(b, n)| bits(&world, b, n))
        .collect()
}

/// A thin diagonal far above some bodies, whose bounding box covers them. It joins them into one cluster without touching any of them.
fn link() -> BodyBlueprint<2> {
    let wire = Mesh { positions: vec![[-30.0, 60.0], [30.0, -60.0]], wires: vec![[0, 1]], ..Mesh::default() };
    let models = vec![model::<2>("mass_spring", &[("stiffness", 1.0)])];
    BodyBlueprint { translation: [40.0, 40.0], ..BodyBlueprint::new("link", wire, Mass::Total(1.0), models) }
}

fn with_self(scene: &mut Blueprint<2>, itself: bool) {
    scene.contact = contact::<2>(&[("self", itself.into()), ("friction", 0.3.into()), ("thickness", 0.002.into())]);
}

/// Two rings full of gas that burst open within one frame, far beyond their predicted boxes, and meet.
fn bursting() -> Vec<BodyBlueprint<2>> {
    let full = |name: &str, x: [f64; 2], v: [f64; 2]| {
        let mut body = ball(name, 24, x, v);
        body.models[1] = model::<2>("pressure", &[("nRT", 30_000.0)]);
        body
    };
    vec![full("a", [0.0, 0.0], [0.0; 2]), full("b", [2.0, 0.1], [0.0; 2])]
}

/// Bodies that leave their boxes and meet have the same motion, to the bit, as bodies that are stepped together from the start, on any number of
/// threads.
#[test]
fn bodies_that_meet_unexpectedly_go_through_the_frame_together() {
    for rule in ["symplectic_euler", "verlet", "backward_euler"] {
        let mut alone = scene(rule, bursting());
        alone.time = Time { seconds: 1.0, frame: 1.0 / 60.0, substeps: 64 };
        with_self(&mut alone, false);
        let mut linked = alone.clone();
        linked.bodies.push(link());
        let steps = |scene: &Blueprint<2>| {
            let mut world = World::new(scene.clone(), Options::default()).expect("a world");
            world.frame().expect("a frame");
            world.contact_counts().expect("contact").steps
        };
        // As long as each body is stepped alone, no contact is counted. These steps belong to both bodies together, in a second attempt at the frame.
        assert_eq!(steps(&alone), 64, "{rule}");
        let known = end(&linked, &[0, 1], 3, 1, true);
        for (threads, batches) in [(1, true), (2, true), (3, true), (8, true), (1, false), (3, false)] {
            assert_eq!(
                end(&alone, &[0, 1], 3, threads, batches),
                known,
                "{rule}, {threads} threads, batches: {batches}"
            );
        }
        // The bodies have met: without contact they end elsewhere.
        let mut passing = alone.clone();
        passing.contact = None;
        assert_ne!(end(&passing, &[0, 1], 3, 1, true), known, "{rule}");
    }
}

/// The motion of a pair of bodies does not depend on bodies elsewhere.
#[test]
fn bodies_elsewhere_change_nothing() {
    let square = |name: &str, x: [f64; 2], v: [f64; 2]| {
        let mesh = Mesh::grid([0.0; 2], [1.0, 1.0], [3, 3]).expect("a grid");
        let solid = vec![model::<2>("fem", &[("youngs_modulus", 3e3), ("poissons_ratio", 0.3)])];
        BodyBlueprint { translation: x, velocity: v, ..BodyBlueprint::new(name, mesh, Mass::Total(1.0), solid) }
    };
    let pair = |x: f64, speed: f64| vec![square("a", [x, 0.0], [speed, 0.0]), square("b", [x + 1.1, 0.3], [0.0; 2])];
    let settings: [(&str, Vec<(&str, Value)>); 4] = [
        ("symplectic_euler", Vec::new()),
        ("backward_euler", Vec::new()),
        ("implicit_midpoint", Vec::new()),
        ("backward_euler", vec![("response", "barrier".into())]),
    ];
    for (rule, more) in settings {
        let scene_of = |bodies| {
            let mut scene = heavy(rule, bodies, 16);
            scene.contact = contact::<2>(&[("friction", 0.3.into()), ("thickness", 0.002.into())]);
            let values = &mut scene.contact.as_mut().expect("contact").values;
            for (name, value) in &more {
                values.set(opruga_world::schema::CONTACT.spec, name, value.clone(), 2).expect("a field");
            }
            if !more.is_empty() {
                values.set(opruga_world::schema::CONTACT.spec, "reach", 0.005.into(), 2).expect("a field");
            }
            scene
        };
        let mut bodies = [pair(0.0, 2.0), pair(20.0, 1.3)].concat();
        bodies[2..].iter_mut().for_each(|body| body.name += " elsewhere");
        let both = scene_of(bodies);
        let known = end(&both, &[0, 1, 2, 3], 20, 1, true);
        let half = known.len() / 2;
        assert_eq!(end(&scene_of(pair(0.0, 2.0)), &[0, 1], 20, 1, true), known[..half], "{rule} {more:?}");
        assert_eq!(end(&scene_of(pair(20.0, 1.3)), &[0, 1], 20, 1, true), known[half..], "{rule} {more:?}");
        for threads in [2, 3, 8] {
            assert_eq!(end(&both, &[0, 1, 2, 3], 20, threads, true), known, "{rule} {more:?}, {threads} threads");
        }
    }
}

/// Bodies that are far apart and do not touch themselves are stepped as without contact.
#[test]
fn bodies_far_apart_step_alone() {
    for rule in ["symplectic_euler", "implicit_midpoint"] {
        let bodies: Vec<_> =
            (0..10).map(|k| ball(&format!("b[{k}]"), 24, [4.0 * f64::from(k), 0.0], [0.3, 0.1])).collect();
        let mut scene = heavy(rule, bodies, 16);
        with_self(&mut scene, false);
        let mut free = scene.clone();
        free.contact = None;
        let all: Vec<usize> = (0..10).collect();
        assert_eq!(end(&scene, &all, 10, 1, true), end(&free, &all, 10, 1, true), "{rule}");
        let mut world = World::new(scene, Options::default()).expect("a world");
        (0..10).for_each(|_| world.frame().expect("a frame"));
        assert_eq!(world.contact_counts().expect("contact").steps, 0, "{rule}");
    }
}

/// An obstacle finer than the mesh is met even if no body was expected to reach it.
#[test]
fn obstacles_that_bodies_reach_unexpectedly_are_met() {
    let mut bodies = bursting();
    bodies.truncate(1);
    let mut scene = scene("symplectic_euler", bodies);
    scene.time = Time { seconds: 1.0, frame: 1.0 / 60.0, substeps: 64 };
    with_self(&mut scene, false);
    // Below the midpoint of an edge of the ring.
    let angle = 0.5 * std::f64::consts::TAU / 24.0;
    let tip = [0.75 * libm::cos(angle), 0.75 * libm::sin(angle)];
    let corners = vec![tip.to_vec(), vec![5.0, -0.4], vec![5.0, 2.0]];
    scene.colliders =
        vec![ColliderBlueprint::new::<2>("convex", &[("points", Value::Rows(corners))]).expect("a needle")];
    let mut world = World::new(scene, Options::default()).expect("a world");
    (0..4).for_each(|_| world.frame().expect("a frame"));
    assert!(world.contact_counts().expect("contact").contacts > 0);
    let ring: Vec<[f64; 2]> = (0..24).map(|node| world.position(0, node)).collect();
    let inside = (0..24).filter(|k| {
        let (p, q) = (ring[*k], ring[(*k + 1) % 24]);
        (p[1] > tip[1]) != (q[1] > tip[1]) && p[0] + (tip[1] - p[1]) / (q[1] - p[1]) * (q[0] - p[0]) > tip[0]
    });
    assert_eq!(inside.count() % 2, 0, "the tip is in the ring");
}

/// Contact between bodies with different integrators is reported once; frames and pairs are counted.
#[test]
fn contact_of_different_integrators_is_counted() {
    let values = |rule: &str| Registry::<2>::default().integrator_values(rule, &[]).expect("a rule");
    let run = |second: &str| {
        let mut bodies = vec![ball("a", 24, [0.0, 0.0], [1.0, 0.0]), ball("b", 24, [1.02, 0.0], [-1.0, 0.0])];
        bodies[1].integrator = Some(values(second));
        let mut scene = scene("symplectic_euler", bodies);
        scene.time = Time { seconds: 1.0, frame: 1.0 / 60.0, substeps: 16 };
        let mut world = World::new(scene, Options::default()).expect("a world");
        world.report_contacts(true);
        let mut touched = 0;
        for _ in 0..60 {
            world.frame().expect("a frame");
            touched +=
                world.contacts().iter().filter(|contact| contact.bodies == [0, 1] && contact.pressed > 0.0).count();
        }
        let warning = world.warnings().into_iter().find(|warning| warning.code == "contact.mixed");
        (touched as u64, warning.map(|warning| (warning.count, warning.message)))
    };
    for second in ["verlet", "backward_euler"] {
        let (touched, warning) = run(second);
        let (count, message) = warning.expect("a warning");
        assert!(touched > 0 && count == touched, "{second}: {count}, {touched}");
        assert!(
            message.contains("`a` (symplectic_euler)") && message.contains(&format!("`b` ({second})")),
            "{message}"
        );
    }
    assert_eq!(run("symplectic_euler").1, None);
}

/// Impulses are part of the state: a world that restores a snapshot continues bit for bit, with the same number of iterations.
#[test]
fn impulses_are_part_of_the_state() {
    let square = |name: &str, x: [f64; 2]| {
        let mesh = Mesh::grid([0.0; 2], [1.0, 1.0], [3, 3]).expect("a grid");
        let solid = vec![model::<2>("fem", &[("youngs_modulus", 1e5), ("poissons_ratio", 0.3), ("damping", 1e-3)])];
        BodyBlueprint { translation: x, ..BodyBlueprint::new(name, mesh, Mass::Total(1.0), solid) }
    };
    for (rule, response) in
        [("symplectic_euler", "constraint"), ("backward_euler", "constraint"), ("backward_euler", "barrier")]
    {
        let mut below = square("below", [0.0, -1.05]);
        below.pins.push(PinBlueprint { select: Selector::Side("bottom".into()), axes: [true; 2], motion: Vec::new() });
        let bodies = vec![below, square("above", [0.1, 0.0]), square("top", [0.05, 1.05])];
        let substeps = if rule == "symplectic_euler" { 64 } else { 1 };
        let mut scene = heavy(rule, bodies, substeps);
        scene.contact = contact::<2>(&[("friction", 0.4.into()), ("response", response.into())]);
        let mut world = World::new(scene.clone(), Options::default()).expect("a world");
        (0..30).for_each(|_| world.frame().expect("a frame"));
        let kept = world.snapshot();
        let turns = |world: &mut World<2>| {
            let before = world.contact_counts().map_or(0, |counts| counts.turns);
            world.frame().expect("a frame");
            world.contact_counts().expect("contact").turns - before
        };
        let own = turns(&mut world);
        let hash = world.frame_hash();
        for threads in [1, 3] {
            let mut other = World::new(scene.clone(), Options { threads, ..Options::default() }).expect("a world");
            other.restore(&kept).expect("the same scene");
            assert_eq!(other.snapshot(), kept, "{rule} {response}");
            assert_eq!(turns(&mut other), own, "{rule} {response}");
            assert_eq!(other.frame_hash(), hash, "{rule} {response}");
        }
        // Damaged bytes at its end are refused, and the world is unchanged.
        let mut damaged = kept.clone();
        let end = damaged.len();
        damaged[end - 1] ^= 0xff;
        damaged.truncate(end - 8);
        let now = world.snapshot();
        assert!(world.restore(&damaged).is_err(), "{rule} {response}");
        assert_eq!(world.snapshot(), now, "{rule} {response}");
    }
}
