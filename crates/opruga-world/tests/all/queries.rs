//! Rays and nearest points on the present shapes of bodies.

use opruga_core::spec::Value;
use opruga_math::message::Message as _;
use opruga_mesh::Mesh;
use opruga_world::blueprint::*;
use opruga_world::{AnyWorld, Options, Registry, World};

fn world<const D: usize>(meshes: Vec<(Mesh<D>, [f64; D])>) -> World<D> {
    let registry = Registry::<D>::default();
    let mut scene = Blueprint::new("queries", registry.integrator_values("symplectic_euler", &[]).expect("a rule"));
    for (number, (mesh, at)) in meshes.into_iter().enumerate() {
        let fields = [("stiffness", Value::Number(100.0))];
        let springs = registry.model_values("mass_spring", &fields).expect("a model");
        let body = BodyBlueprint::new(&format!("body{number}"), mesh, Mass::Total(1.0), vec![springs]);
        scene.bodies.push(BodyBlueprint { translation: at, ..body });
    }
    World::new(scene, Options::default()).expect("a world")
}

/// Pseudo-random numbers between −1 and 1.
fn noise(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// Rays from all directions hit a cube at its planes, and none passes through an edge or a corner.
#[test]
fn rays_meet_a_cube_where_its_planes_are() {
    let cube = Mesh::<3>::grid([-1.0; 3], [2.0; 3], [3, 3, 3]).expect("a cube");
    let corners = cube.positions.clone();
    let world = world(vec![(cube, [0.0; 3])]);
    let mut seed = 7;
    let mut targets: Vec<[f64; 3]> = corners.into_iter().filter(|x| x.iter().any(|c| c.abs() == 1.0)).collect();
    targets.extend((0..500).map(|_| core::array::from_fn(|_| 0.99 * noise(&mut seed))));
    for target in targets {
        let direction: [f64; 3] = target.map(|c| if c == 0.0 { 0.0 } else { -c });
        let size = direction.iter().map(|c| c * c).sum::<f64>().sqrt();
        // From outside towards the centre, and from the centre outward.
        let origin: [f64; 3] = target.map(|c| c * 5.0 / size);
        let most = target.iter().fold(0.0, |most: f64, c| if c.abs() > most { c.abs() } else { most });
        let wall = size / most;
        let hit = world.cast_ray(origin, direction, 10.0).expect("a ray").expect("it meets the cube");
        assert!((hit.distance - (5.0 - wall)).abs() < 1e-9, "{target:?}: {hit:?}");
        let back = world.cast_ray([0.0; 3], origin, 10.0).expect("a ray").expect("it meets the cube from inside");
        assert!((back.distance - wall).abs() < 1e-9, "{target:?}: {back:?}");
        for hit in [hit, back] {
            let reached = hit.position.iter().fold(0.0, |most: f64, c| if c.abs() > most { c.abs() } else { most });
            assert!((reached - 1.0).abs() < 1e-9, "{hit:?}");
            let outward: f64 = (0..3).map(|d| hit.normal[d] * hit.position[d]).sum();
            assert!((outward - 1.0).abs() < 1e-9, "the normal points out of the cube: {hit:?}");
            assert!((hit.weights.iter().sum::<f64>() - 1.0).abs() < 1e-9, "{hit:?}");
        }
        assert_eq!(world.cast_ray(origin, direction, 5.0 - wall - 1e-6).expect("a ray"), None, "it ends before");
        assert_eq!(world.cast_ray(origin, origin, 10.0).expect("a ray"), None, "it goes away");
    }
}

/// The nearest point of a cube, from outside and from inside.
#[test]
fn nearest_points_of_a_cube_are_those_of_its_planes() {
    let cube = Mesh::<3>::grid([-1.0; 3], [2.0; 3], [2, 3, 4]).expect("a cube");
    let world = world(vec![(cube, [0.0; 3])]);
    let mut seed = 11;
    for _ in 0..500 {
        let point: [f64; 3] = core::array::from_fn(|_| 2.0 * noise(&mut seed));
        let over = point.map(|c| c.abs() - 1.0);
        let deepest = over.iter().fold(f64::NEG_INFINITY, |most, c| if *c > most { *c } else { most });
        let outside = over.iter().map(|c| if *c > 0.0 { c * c } else { 0.0 }).sum::<f64>().sqrt();
        let expected = if deepest > 0.0 { outside } else { deepest };
        let found = world.nearest_surface_point(point, 10.0).expect("a point").expect("near a cube");
        assert!((found.distance - expected).abs() < 1e-9, "{point:?}: {found:?}, not {expected}");
        let short = expected.abs() - 1e-6;
        if short >= 0.0 {
            assert_eq!(world.nearest_surface_point(point, short).expect("a point"), None, "{point:?}");
        }
    }
}

/// In the plane the ray hits the first of several bodies, at their present positions and not at the initial ones.
#[test]
fn queries_see_bodies_where_they_are() {
    let ring = || Mesh::<2>::ring(0.5, 48, [0.0; 2], 0.0).expect("a ring");
    let line = Mesh::<2>::line([0.0, -1.0], [0.0, 1.0], 4).expect("a line");
    let mut world = world(vec![(ring(), [4.0, 0.0]), (ring(), [2.0, 0.0]), (line, [6.0, 0.0])]);
    let ray = |world: &World<2>, y: f64| world.cast_ray([0.0, y], [1.0, 0.0], 100.0).expect("a ray");
    let apothem = 0.5 * libm::cos(std::f64::consts::PI / 48.0);
    let hit = ray(&world, 0.0).expect("the second ring");
    assert_eq!(hit.body, 1);
    assert!(hit.distance >= 1.5 - 1e-12 && hit.distance <= 2.0 - apothem, "{hit:?}");
    assert!(hit.normal[0] < -0.99, "{hit:?}");
    let line = ray(&world, 0.8).expect("the line");
    assert_eq!((line.body, line.normal), (2, [-1.0, 0.0]), "its normal points to where the ray came from");
    assert_eq!(ray(&world, 1.5), None);
    let inside = world.nearest_surface_point([4.0, 0.1], 1.0).expect("a point").expect("within a ring");
    assert!(inside.body == 0 && inside.distance < -0.39, "{inside:?}");
    for node in 0..48 {
        let x = world.position(1, node);
        world.set_node(1, node, [x[0], x[1] + 3.0], [0.0; 2]).expect("a node");
    }
    assert_eq!(ray(&world, 0.0).expect("the first ring").body, 0);
    assert_eq!(ray(&world, 3.0).expect("the second ring").body, 1);
    // The same in the world without a dimension.
    let any: &dyn AnyWorld = &world;
    let hit = any.cast_ray([0.0, 3.0, 0.0], [1.0, 0.0, 0.0], 100.0).expect("a ray").expect("the second ring");
    assert_eq!((hit.body, hit.position[2], hit.weights[2]), (1, 0.0, 0.0));
}

#[test]
fn queries_without_meaning_are_refused() {
    let world = world(vec![(Mesh::<2>::ring(0.5, 12, [0.0; 2], 0.0).expect("a ring"), [0.0; 2])]);
    let refused = [
        world.cast_ray([f64::NAN, 0.0], [1.0, 0.0], 1.0),
        world.cast_ray([0.0; 2], [0.0; 2], 1.0),
        world.cast_ray([0.0; 2], [f64::INFINITY, 0.0], 1.0),
        world.cast_ray([0.0; 2], [1.0, 0.0], f64::NAN),
        world.nearest_surface_point([f64::NAN, 0.0], 1.0),
        world.nearest_surface_point([0.0; 2], -1.0),
    ];
    for outcome in refused {
        let error = outcome.expect_err("refused");
        assert!(error.in_full().contains("allowed"), "{error}");
    }
}
