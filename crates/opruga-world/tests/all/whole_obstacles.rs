//! Obstacles that are finer than the mesh, in contact with edges and facets of bodies.

use opruga_core::spec::{Value, Values};
use opruga_mesh::Mesh;
use opruga_world::blueprint::*;
use opruga_world::schema::CONTACT;
use opruga_world::{Options, Registry, World};

fn model<const D: usize>(kind: &str, fields: &[(&str, f64)]) -> Values {
    let fields: Vec<(&str, Value)> = fields.iter().map(|(name, x)| (*name, Value::Number(*x))).collect();
    Registry::<D>::default().model_values(kind, &fields).expect("a model")
}

fn collider<const D: usize>(kind: &str, fields: &[(&str, Value)]) -> ColliderBlueprint {
    ColliderBlueprint::new::<D>(kind, fields).expect("a collider")
}

fn scene<const D: usize>(rule: &str, body: BodyBlueprint<D>, obstacle: ColliderBlueprint) -> Blueprint<D> {
    let registry = Registry::<D>::default();
    let mut scene = Blueprint::new("whole obstacles", registry.integrator_values(rule, &[]).expect("a rule"));
    scene.bodies.push(body);
    scene.colliders.push(obstacle);
    scene.contact = Some(ContactBlueprint { values: Values::defaults(CONTACT.spec, D), pairs: Vec::new() });
    scene
}

/// A coarse ball of gas whose lowest edge has its midpoint below the centre.
fn ball(at: [f64; 2], velocity: [f64; 2]) -> BodyBlueprint<2> {
    let ring = Mesh::ring(0.5, 12, [0.0; 2], std::f64::consts::PI / 12.0).expect("a ring");
    let models = vec![
        model::<2>("mass_spring", &[("stiffness", 400.0), ("damping", 1.0)]),
        model::<2>("pressure", &[("nRT", 20.0)]),
    ];
    let body = BodyBlueprint::new("ball", ring, Mass::Total(1.0), models);
    BodyBlueprint { translation: at, velocity, ..body }
}

/// The distance of a point from the outline of the ball [m]; negative inside.
fn signed_distance(world: &World<2>, p: [f64; 2]) -> f64 {
    let (mut inside, mut least) = (false, f64::INFINITY);
    for facet in &world.blueprint().bodies[0].mesh.facets {
        let [q, r] = facet.map(|n| world.position(0, n));
        if (q[1] > p[1]) != (r[1] > p[1]) {
            inside ^= q[0] + (p[1] - q[1]) / (r[1] - q[1]) * (r[0] - q[0]) > p[0];
        }
        let t = opruga_collide::closest_on_segment(&p, &q, &r);
        let away: [f64; 2] = core::array::from_fn(|d| p[d] - q[d] - t * (r[d] - q[d]));
        let square = away[0] * away[0] + away[1] * away[1];
        least = if square < least { square } else { least };
    }
    if inside { -least.sqrt() } else { least.sqrt() }
}

/// Obstacles in the plane with a tip at the origin, narrower than an edge of the ball; with the points that must stay outside, and their distance.
fn needles() -> Vec<(ColliderBlueprint, f64, [f64; 2])> {
    let numbers = |x: &[f64]| Value::Numbers(x.to_vec());
    let rows = |x: &[[f64; 2]]| Value::Rows(x.iter().map(|row| row.to_vec()).collect());
    vec![
        (collider::<2>("box", &[("min", numbers(&[-0.02, -2.0])), ("max", numbers(&[0.02, 0.0]))]), 0.0, [0.02, 0.0]),
        (collider::<2>("ball", &[("center", numbers(&[0.0, -0.03])), ("radius", 0.03.into())]), 0.03, [0.0, -0.03]),
        (
            collider::<2>(
                "capsule",
                &[("a", numbers(&[0.0, -2.0])), ("b", numbers(&[0.0, -0.02])), ("radius", 0.02.into())],
            ),
            0.02,
            [0.0, -0.02],
        ),
        (collider::<2>("convex", &[("points", rows(&[[-0.1, -2.0], [0.1, -2.0], [0.0, 0.0]]))]), 0.0, [0.0, 0.0]),
        (collider::<2>("polyline", &[("points", rows(&[[-0.1, -2.0], [0.0, 0.0], [0.1, -2.0]]))]), 0.0, [0.0, 0.0]),
    ]
}

/// The ball lands on a needle with the midpoint of an edge: with contact the needle stays outside and supports it.
#[test]
fn needles_stay_outside_of_a_coarse_ball() {
    for rule in ["symplectic_euler", "verlet", "runge_kutta", "backward_euler", "newmark"] {
        for (needle, radius, tip) in needles() {
            let kind = needle.values.kind();
            let mut scene = scene(rule, ball([0.0, 0.6], [0.0; 2]), needle);
            scene.surroundings.gravity = [0.0, -9.81];
            let run = |scene: &Blueprint<2>| {
                let mut world = World::new(scene.clone(), Options::default()).expect("a world");
                let mut least = f64::INFINITY;
                for _ in 0..60 {
                    world.frame().expect("a frame");
                    let distance = signed_distance(&world, tip) - radius;
                    least = if distance < least { distance } else { least };
                }
                (world, least)
            };
            let (with, least) = run(&scene);
            assert!(least > -1e-6, "{rule}, {kind}: {least} m inside");
            assert!(least < 0.02, "{rule}, {kind}: it meets the needle: {least}");
            let energy = with.energy();
            assert!(energy.loss_contact > 0.0 && energy.closure < 0.05, "{rule}, {kind}: {energy:?}");
            scene.contact = None;
            let (_, without) = run(&scene);
            assert!(without < -0.05, "{rule}, {kind}: without contact it goes in: {without}");
        }
    }
}

/// A body that is shot at a needle does not pass through it at any speed.
#[test]
fn a_fast_edge_does_not_pass_a_needle() {
    for speed in [10.0, 100.0, 1000.0] {
        for (needle, radius, tip) in needles() {
            let kind = needle.values.kind();
            let mut scene = scene("symplectic_euler", ball([0.0, 0.6], [0.0, -speed]), needle);
            scene.time.frame = 0.1 / speed;
            let mut world = World::new(scene, Options::default()).expect("a world");
            for _ in 0..20 {
                world.frame().expect("a frame");
                let distance = signed_distance(&world, tip) - radius;
                assert!(distance > -1e-6, "{kind} at {speed} m/s: {distance} m inside");
            }
        }
    }
}

/// A moving needle pushes the ball, and its work is in the ledger.
#[test]
fn a_needle_that_moves_pushes_the_ball() {
    for (needle, radius, tip) in needles() {
        let kind = needle.values.kind().to_string();
        let mut needle = needle;
        let path = Value::Rows(vec![vec![0.0, 0.0, 0.0], vec![1.0, 0.0, 1.0]]);
        let spec = opruga_collide::all(2).into_iter().find(|spec| spec.kind == kind).expect("a kind");
        needle.values.set(spec, "motion", path, 2).expect("a path");
        let scene = scene("symplectic_euler", ball([0.0, 0.55], [0.0; 2]), needle);
        let mut world = World::new(scene, Options::default()).expect("a world");
        for _ in 0..50 {
            world.frame().expect("a frame");
            let at = [tip[0], tip[1] + world.time()];
            let distance = signed_distance(&world, at) - radius;
            assert!(distance > -1e-6, "{kind}: {distance} m inside at {} s", world.time());
        }
        let speed = world.momentum().linear.0[1];
        assert!(speed > 0.5, "{kind}: it goes along: {speed} kg m/s");
        assert!(world.energy().closure < 0.05, "{kind}: {:?}", world.energy());
    }
}

/// The height of a sheet above a point of the xz plane [m]; infinity if the sheet does not cover it.
fn height_over(world: &World<3>, [x, z]: [f64; 2]) -> f64 {
    let mut least = f64::INFINITY;
    for corners in &world.blueprint().bodies[0].mesh.sheets {
        let [p, q, r] = corners.map(|n| world.position(0, n));
        let area =
            |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        let [a, b, c] = [p, q, r].map(|p| [p[0], p[2]]);
        let whole = area(a, b, c);
        let weights = [area([x, z], b, c), area(a, [x, z], c), area(a, b, [x, z])].map(|part| part / whole);
        if weights.iter().all(|w| *w >= 0.0) {
            let height = weights[0] * p[1] + weights[1] * q[1] + weights[2] * r[1];
            least = if height < least { height } else { least };
        }
    }
    least
}

/// A coarse sheet falls on edges and corners that are finer than its triangles and stays above them.
#[test]
fn edges_of_obstacles_stay_below_a_coarse_sheet() {
    let numbers = |x: &[f64]| Value::Numbers(x.to_vec());
    let rows = |x: &[[f64; 3]]| Value::Rows(x.iter().map(|row| row.to_vec()).collect());
    let ridge = [[-2.0, 0.0, 0.07], [2.0, 0.0, 0.07]];
    let mut roof = ridge.to_vec();
    roof.extend([-2.0, 2.0].iter().flat_map(|x| [[*x, -1.0, -0.1], [*x, -1.0, 0.3]]));
    let spike = [[0.0, 0.0, 0.07], [-0.05, -1.0, 0.0], [0.1, -1.0, 0.02], [0.0, -1.0, 0.15]];
    let faces = Value::Integers(vec![0, 1, 2, 0, 2, 3, 0, 3, 1]);
    let [a, b] = [numbers(&[-2.0, -0.01, 0.07]), numbers(&[2.0, -0.01, 0.07])];
    let cases = [
        ("box", vec![("min", numbers(&[-2.0, -1.0, 0.06])), ("max", numbers(&[2.0, 0.0, 0.08]))]),
        ("convex", vec![("points", rows(&roof))]),
        ("convex", vec![("points", rows(&spike))]),
        ("capsule", vec![("a", a), ("b", b), ("radius", 0.01.into())]),
        ("ball", vec![("center", numbers(&[0.0, -0.02, 0.07])), ("radius", 0.02.into())]),
        ("triangle_mesh", vec![("points", rows(&spike)), ("triangles", faces)]),
    ];
    for (kind, fields) in cases {
        let sheet = Mesh::sheet([-0.5, 0.1, -0.5], [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], [3, 3]).expect("a sheet");
        let models = vec![model::<3>("mass_spring", &[("stiffness", 300.0), ("damping", 0.5)])];
        let body = BodyBlueprint::new("sheet", sheet, Mass::Total(0.5), models);
        let mut scene = scene("symplectic_euler", body, collider::<3>(kind, &fields));
        scene.surroundings.gravity = [0.0, -9.81, 0.0];
        let run = |scene: &Blueprint<3>| {
            let mut world = World::new(scene.clone(), Options::default()).expect("a world");
            let mut least = f64::INFINITY;
            for _ in 0..20 {
                world.frame().expect("a frame");
                let height = height_over(&world, [0.0, 0.07]);
                least = if height < least { height } else { least };
            }
            (least, world.energy())
        };
        let (least, energy) = run(&scene);
        assert!(least > -1e-6 && least < 0.03, "{kind}: the sheet is {least} m above the tip");
        assert!(energy.loss_contact > 0.0 && energy.closure < 0.05, "{kind}: {energy:?}");
        scene.contact = None;
        let (least, _) = run(&scene);
        assert!(least < -0.05, "{kind}: without contact it sinks below: {least}");
    }
}

/// The same bits on any number of threads.
#[test]
fn whole_obstacles_have_the_same_bits() {
    for (needle, _, _) in needles() {
        let kind = needle.values.kind();
        let mut scene = scene("symplectic_euler", ball([0.0, 0.6], [0.3, 0.0]), needle);
        scene.surroundings.gravity = [0.0, -9.81];
        let other = BodyBlueprint { name: "other".into(), ..ball([0.3, 1.7], [0.0; 2]) };
        scene.bodies.push(other);
        let run = |threads: usize| {
            let mut world = World::new(scene.clone(), Options { threads, ..Options::default() }).expect("a world");
            (0..60).for_each(|_| world.frame().expect("a frame"));
            world.frame_hash()
        };
        assert_eq!(run(1), run(3), "{kind}");
    }
}

/// A block of 4.9 N on a box, which may move.
fn block_on_a_shelf(rule: &str, response: &str, motion: &[[f64; 4]]) -> World<3> {
    let mesh = Mesh::<3>::grid([-0.05, 0.002, -0.05], [0.1; 3], [2; 3]).expect("a block");
    let fem = model::<3>("fem", &[("youngs_modulus", 1e5), ("poissons_ratio", 0.3), ("damping", 0.01)]);
    let block = BodyBlueprint::new("block", mesh, Mass::Total(0.5), vec![fem]);
    let numbers = |x: [f64; 3]| Value::Numbers(x.to_vec());
    let mut fields = vec![("min", numbers([-0.3, -0.1, -0.3])), ("max", numbers([0.3, 0.0, 0.3]))];
    if !motion.is_empty() {
        fields.push(("motion", Value::Rows(motion.iter().map(|row| row.to_vec()).collect())));
    }
    let mut scene = scene(rule, block, collider::<3>("box", &fields));
    scene.surroundings.gravity[1] = -9.81;
    scene.time = Time { seconds: 10.0, frame: 1.0 / 60.0, substeps: if rule == "symplectic_euler" { 60 } else { 4 } };
    let contact = &mut scene.contact.as_mut().expect("contact").values;
    contact.set(CONTACT.spec, "response", Value::Text(response.into()), 3).expect("a response");
    World::new(scene, Options::default()).expect("a world")
}

/// The contact forces on the nodes of a block at rest support it, whether the face of the box constrains nodes or touches facets.
#[test]
fn the_contact_forces_on_a_block_at_rest_on_a_box_are_its_weight() {
    let responses = [
        ("symplectic_euler", "constraint"),
        ("backward_euler", "constraint"),
        ("newmark", "constraint"),
        ("backward_euler", "barrier"),
    ];
    for (rule, response) in responses {
        let mut world = block_on_a_shelf(rule, response, &[]);
        (0..60).for_each(|_| world.frame().expect("a frame"));
        let force: f64 = world.contact_forces(0).iter().map(|force| force[1]).sum();
        assert!((force / (0.5 * 9.81) - 1.0).abs() < 0.05, "{rule}, {response}: {force} N");
    }
}

/// A box that sets off at 1 m/s, lifts a block by 0.5 m and stops does the work m g Δh + m v², half of which the impact at the beginning takes.
#[test]
fn a_box_that_lifts_a_block_by_a_barrier_does_work_on_it() {
    let motion = [[0.0; 4], [0.3, 0.0, 0.0, 0.0], [0.8, 0.0, 0.5, 0.0]];
    let mut world = block_on_a_shelf("backward_euler", "barrier", &motion);
    (0..72).for_each(|_| world.frame().expect("a frame"));
    let (energy, work) = (world.energy(), 0.5 * (9.81 * 0.5 + 1.0));
    assert!((energy.work_user / work - 1.0).abs() < 1e-3, "{work} J: {energy:?}");
    assert!(energy.loss_contact.abs() < 0.05 * work, "{work} J: {energy:?}");
}
