//! Invariance: a run does not depend on where it was interrupted, nor on the rotation, reflection, position or numbering of its scene.

use crate::common;
use common::*;
use opruga::blueprint::{Action, AnyBlueprint, Blueprint, BodyBlueprint};
use opruga::core::spec::Value;
use opruga::mesh::Mesh;
use opruga::{Options, Simd, World, collide};
use std::sync::Arc;

/// A map of the plane.
type Map<'a> = &'a dyn Fn([f64; 2]) -> [f64; 2];
/// A map of space.
type MapOfSpace<'a> = &'a dyn Fn([f64; 3]) -> [f64; 3];
/// A selection of the parts of a scene.
type Keep<'a> = &'a dyn Fn(&mut Blueprint<2>);

/// Two bodies with everything that acts in the plane, on a floor, next to a round obstacle, one of them pulled.
fn scene() -> Blueprint<2> {
    plane(&format!(
        "{}drag = 0.1\n[[body]]\nname = \"ball\"\nmass = 1\nvelocity = [1.5, -1]\nangular_velocity = 2\nposition = [-1, 0.8]\n\
         shape = {{ kind = \"ring\", radius = 0.5, vertices = 24, start_angle = 0.1 }}\n\
         models = [{{ kind = \"mass_spring\", stiffness = 800.0, damping = 0.5 }}, {{ kind = \"pressure\", nRT = 40.0, ambient = 5.0 }}, {{ kind = \"bending\", stiffness = 0.05 }}]\n\
         [[body]]\nname = \"box\"\nmass = 2\nposition = [1.2, 0.3]\n\
         shape = {{ kind = \"regular_polygon\", sides = 5, radius = 0.4, vertices_per_side = 3, start_angle = 0.3 }}\n\
         models = [{{ kind = \"mass_spring\", stiffness = 900.0, damping = 0.5 }}, {{ kind = \"pressure\", pressure = 80.0, process = \"adiabatic\" }}]\n\
         [[collider]]\nkind = \"half_space\"\npoint = [0, -0.2]\nnormal = [0.1, 1]\nfriction = 0.4\nrestitution = 0.3\n\
         [[collider]]\nkind = \"ball\"\ncenter = [0.2, 0.1]\nradius = 0.3\nfriction = 0.2\n\
         [[command]]\ndo = \"drag\"\nat = 0.5\nbody = \"box\"\nnode = 4\npath = [[0.5, 1.5, 0.5], [1, 2, 1.5]]\n",
        head(1.0 / 60.0, 48, -9.81, "symplectic_euler")
    ))
}

/// The scene under a linear isometry; `mirror` is true for a reflection.
fn mapped(mut scene: Blueprint<2>, map: Map, mirror: bool) -> Blueprint<2> {
    let pair = |v: &[f64]| map([v[0], v[1]]);
    scene.surroundings.gravity = map(scene.surroundings.gravity);
    for body in &mut scene.bodies {
        let mut mesh = (*body.mesh).clone();
        for x in &mut mesh.positions {
            *x = map(*x);
        }
        if mirror {
            for facet in &mut mesh.facets {
                facet.swap(0, 1);
            }
            for spin in &mut body.angular_velocity {
                *spin = -*spin;
            }
        }
        body.mesh = Arc::new(mesh);
        body.translation = map(body.translation);
        body.velocity = map(body.velocity);
    }
    for collider in &mut scene.colliders {
        let spec = collide::all(2).into_iter().find(|s| s.kind == collider.values.kind()).expect("a collider");
        for name in ["point", "normal", "center"] {
            if let Some(v) = collider.values.numbers(name).map(pair) {
                collider.values.set(spec, name, Value::Numbers(v.to_vec()), 2).expect("a vector");
            }
        }
    }
    for command in &mut scene.commands {
        if let Action::Drag { path, .. } = &mut command.action {
            for row in path {
                let v = pair(&row[1..]);
                row[1..].copy_from_slice(&v);
            }
        }
    }
    scene
}

/// All positions, then all velocities.
fn state<const D: usize>(world: &World<D>) -> Vec<[f64; D]> {
    let nodes = || world.bodies().flat_map(|b| (0..world.node_count(b) as u32).map(move |n| (b, n)));
    nodes().map(|(b, n)| world.position(b, n)).chain(nodes().map(|(b, n)| world.velocity(b, n))).collect()
}

fn ran<const D: usize>(scene: Blueprint<D>, count: u64) -> World<D> {
    let mut world = built(scene);
    frames(&mut world, count);
    world
}

/// The largest difference between a mapped state and another one; for velocities divided by a hundred, because the fast motions of the bodies have
/// some hundred radians per second.
fn difference(a: &[[f64; 2]], b: &[[f64; 2]], map: Map) -> f64 {
    let positions = a.len() / 2;
    largest(a.iter().zip(b).enumerate().flat_map(|(k, (a, b))| {
        let (a, scale) = (map(*a), if k < positions { 1.0 } else { 0.01 });
        [scale * (a[0] - b[0]), scale * (a[1] - b[1])]
    }))
}

#[test]
fn a_scene_turned_by_right_angles_has_the_same_bits() {
    let turns: [(&str, Map); 3] =
        [("90°", &|[x, y]| [-y, x]), ("180°", &|[x, y]| [-x, -y]), ("270°", &|[x, y]| [y, -x])];
    // The direction in which a round obstacle pushes is not rotated exactly.
    let parts: [(&str, Keep, f64); 3] = [
        ("models and a pull", &|s| s.colliders.clear(), 0.0),
        ("a floor", &|s| s.colliders.truncate(1), 0.0),
        ("a floor and a round obstacle", &|_| {}, 1e-10),
    ];
    for (part, keep, tolerance) in parts {
        let scene = || {
            let mut scene = scene();
            keep(&mut scene);
            scene
        };
        let reference = ran(scene(), 40);
        for (name, turn) in turns {
            let world = ran(mapped(scene(), turn, false), 40);
            let off = difference(&state(&reference), &state(&world), turn);
            assert!(off <= tolerance, "{part}, turned by {name}: {off:e}");
        }
    }
    let all = ran(scene(), 40).energy();
    assert!(all.loss_contact > 0.01 && all.work_user != 0.0, "all of it takes part");
}

#[test]
fn a_scene_turned_by_any_angle_moves_the_same() {
    let reference = ran(scene(), 40);
    // Sines and cosines of a few angles.
    for (s, c) in
        [(0.6, 0.8), (-0.28, 0.96), (5.0 / 13.0, -12.0 / 13.0), (0.099_833_416_646_828_15, 0.995_004_165_278_025_8)]
    {
        let turn = move |[x, y]: [f64; 2]| [c * x - s * y, s * x + c * y];
        let world = ran(mapped(scene(), &turn, false), 40);
        let off = difference(&state(&reference), &state(&world), &turn);
        println!("sin {s}: {off:.1e}");
        assert!(off < 1e-10, "sin {s}: {off:e}");
    }
}

#[test]
fn a_mirrored_scene_moves_as_its_mirror_image() {
    let reference = ran(scene(), 40);
    let mirror = |[x, y]: [f64; 2]| [-x, y];
    let world = ran(mapped(scene(), &mirror, true), 40);
    let off = difference(&state(&reference), &state(&world), &mirror);
    println!("mirror: {off:.1e}");
    assert!(off < 1e-10, "{off:e}");
}

/// Far away, numbers are coarser: 1.2e-10 m at 1e6 m. The shape is preserved to that precision.
#[test]
fn a_scene_far_away_keeps_its_shape() {
    let free = || {
        let mut scene = scene();
        scene.colliders.clear();
        scene.commands.clear();
        scene
    };
    let reference = ran(free(), 30);
    for (far, tolerance) in [(1e3, 1e-11), (1e6, 1e-8)] {
        let mut moved = free();
        for body in &mut moved.bodies {
            body.translation[0] += far;
        }
        let world = ran(moved, 30);
        let relative = |w: &World<2>, n: u32| {
            let (a, b) = (w.position(0, 0), w.position(0, n));
            [b[0] - a[0], b[1] - a[1]]
        };
        let off = largest((0..24).flat_map(|n| {
            let (a, b) = (relative(&reference, n), relative(&world, n));
            [a[0] - b[0], a[1] - b[1]]
        }));
        println!("{far} m away: {off:.1e}");
        assert!(off < tolerance, "{far} m away: {off:e}");
    }
}

#[test]
fn the_order_of_bodies_does_not_matter_to_the_bit() {
    let text = opruga::scenes::find("pressures").expect("a scene");
    let many = || {
        let mut scene = plane(text);
        let bodies = scene.bodies.clone();
        for k in 0..4 {
            scene.bodies.extend(bodies.iter().map(|b| BodyBlueprint {
                name: format!("{} {k}", b.name),
                velocity: [0.1 * f64::from(k), 0.0],
                ..b.clone()
            }));
        }
        scene
    };
    let reference = ran(many(), 90);
    let mut turned = many();
    turned.bodies.reverse();
    let mut mixed = many();
    mixed.bodies = (0..20).map(|k| many().bodies[(7 * k + 3) % 20].clone()).collect();
    for scene in [turned, mixed] {
        let world = ran(scene, 90);
        for body in reference.bodies() {
            let other = world.body(&reference.blueprint().bodies[body].name).expect("the same bodies");
            for node in 0..reference.node_count(body) as u32 {
                assert_eq!(reference.position(body, node), world.position(other, node));
                assert_eq!(reference.velocity(body, node), world.velocity(other, node));
            }
        }
    }
}

/// The difference between the states after the nodes are renumbered.
fn renumbered<const D: usize>(scene: Blueprint<D>, step: usize, count: u64) -> f64 {
    let mut other = scene.clone();
    let mut new = Vec::new();
    for body in &mut other.bodies {
        let n = body.mesh.positions.len();
        let number: Vec<usize> = (0..n).map(|k| (step * k + 5) % n).collect();
        let mut mesh: Mesh<D> = (*body.mesh).clone();
        for (k, x) in body.mesh.positions.iter().enumerate() {
            mesh.positions[number[k]] = *x;
        }
        for node in mesh.facets.iter_mut().flatten() {
            *node = number[*node as usize] as u32;
        }
        body.mesh = Arc::new(mesh);
        new.push(number);
    }
    for command in &mut other.commands {
        if let Action::Drag { body, node: Some(node), .. } = &mut command.action {
            *node = new[*body][*node as usize] as u32;
        }
    }
    let (a, b) = (ran(scene, count), ran(other, count));
    largest(a.bodies().flat_map(|body| {
        let (a, b, new) = (&a, &b, &new);
        (0..a.node_count(body)).flat_map(move |n| {
            let (x, y) = (a.position(body, n as u32), b.position(body, new[body][n] as u32));
            (0..D).map(move |d| x[d] - y[d])
        })
    }))
}

#[test]
fn the_numbering_of_nodes_does_not_matter() {
    let flat = renumbered(scene(), 7, 40);
    let text = opruga::scenes::find("balloons").expect("a scene");
    let round = renumbered(space(text), 5, 30);
    println!("renumbered: {flat:.1e} {round:.1e}");
    assert!(flat < 1e-10 && round < 1e-10, "{flat:e} {round:e}");
}

fn interrupted<const D: usize>(scene: &Blueprint<D>, name: &str, at: &[u64], end: u64) {
    let whole = ran(scene.clone(), end);
    for &at in at {
        let bytes = ran(scene.clone(), at).snapshot();
        for (threads, simd) in [(3, Simd::Baseline), (2, Simd::best())] {
            let options = Options { threads, simd: Some(simd), ..Options::default() };
            let mut world = World::new(scene.clone(), options).expect("a world");
            world.restore(&bytes).unwrap_or_else(|e| panic!("{name} at frame {at}: {e}"));
            frames(&mut world, end - at);
            assert_eq!(world.state_hash(), whole.state_hash(), "{name}, interrupted at frame {at}");
            assert_eq!(world.energy(), whole.energy(), "{name}, interrupted at frame {at}");
        }
    }
}

/// During the ramp, in flight, during the pull, and at rest; in the plane and in space.
#[test]
fn an_interrupted_run_ends_like_a_whole_one() {
    for (name, at, end) in [
        ("ball", &[1, 20, 100, 211, 250, 331][..], 345),
        ("leaking-tyre", &[1, 30], 90),
        ("hanging-net", &[20], 40),
        ("ball-as-published", &[50, 200], 260),
        ("thousand-balls", &[12], 16),
        ("balloons", &[25], 32),
        ("cloth-over-ball", &[25], 32),
    ] {
        match read(opruga::scenes::find(name).expect("a scene")).expect("a sound scene") {
            AnyBlueprint::Plane(scene) => interrupted(&scene, name, at, end),
            AnyBlueprint::Space(scene) => interrupted(&scene, name, at, end),
        }
    }
}

/// A body of boundary elements that rotates while it falls onto a floor: its factor is kept within a frame.
#[test]
fn an_interrupted_run_of_boundary_elements_ends_like_a_whole_one() {
    for rule in ["backward_euler", "bdf2", "implicit_midpoint", "newmark"] {
        let text = format!(
            "format = \"opruga-1\"\ndimension = 2\n[time]\nseconds = 1\nframe = 0.016666666666666666\nsubsteps = 1\n\
             [integrator]\nkind = \"{rule}\"\n[world]\ngravity = [0, -9.81]\n[[body]]\nname = \"b\"\nmass = 1\nangular_velocity = 3\n\
             shape = {{ kind = \"ring\", radius = 0.5, vertices = 24, center = [0, 1] }}\n\
             models = [{{ kind = \"boundary_element\", youngs_modulus = 2000.0 }}]\n\
             [[collider]]\nkind = \"half_space\"\npoint = [0, 0]\nnormal = [0, 1]\nfriction = 0.3\n"
        );
        let AnyBlueprint::Plane(scene) = read(&text).expect("a sound scene") else { panic!("a scene of the plane") };
        interrupted(&scene, rule, &[1, 13, 30], 45);
    }
}

/// The balloons under a linear isometry of space.
fn balloons(map: MapOfSpace, mirror: bool) -> Blueprint<3> {
    let mut scene = space(opruga::scenes::find("balloons").expect("a scene"));
    scene.surroundings.gravity = map(scene.surroundings.gravity);
    for body in &mut scene.bodies {
        let mut mesh = (*body.mesh).clone();
        mesh.positions.iter_mut().for_each(|x| *x = map(*x));
        if mirror {
            mesh.facets.iter_mut().for_each(|f| f.swap(0, 1));
        }
        body.mesh = Arc::new(mesh);
        body.translation = map(body.translation);
        body.velocity = map([0.3, -2.0, 0.2]);
    }
    for collider in &mut scene.colliders {
        let spec = collide::all(3).into_iter().find(|s| s.kind == collider.values.kind()).expect("a collider");
        for name in ["point", "normal"] {
            let v = map(collider.values.vector(name));
            collider.values.set(spec, name, Value::Numbers(v.to_vec()), 3).expect("a vector");
        }
    }
    scene
}

#[test]
fn space_has_no_preferred_direction() {
    let same = |x| x;
    // In flight and while they are pressed to the floor. Later, when they bounce, contacts of single nodes begin and end, and every such event
    // amplifies the rounding error.
    let reference = ran(balloons(&same, false), 15);
    assert!(reference.energy().loss_contact > 0.01);
    let before = state(&reference);
    let maps: [(&str, MapOfSpace, bool); 4] = [
        ("axes exchanged in a circle", &|[x, y, z]| [z, x, y], false),
        ("a quarter turn about x", &|[x, y, z]| [x, -z, y], false),
        (
            "a turn about two axes",
            &|[x, y, z]| {
                let (x, y) = (0.6 * x - 0.8 * y, 0.8 * x + 0.6 * y);
                [x, 0.96 * y - 0.28 * z, 0.28 * y + 0.96 * z]
            },
            false,
        ),
        ("a mirror", &|[x, y, z]| [x, y, -z], true),
    ];
    for (name, map, mirror) in maps {
        let after = state(&ran(balloons(map, mirror), 15));
        let off = largest(before.iter().zip(&after).flat_map(|(a, b)| {
            let a = map(*a);
            [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
        }));
        println!("{name}: {off:.1e}");
        assert!(off < 1e-10, "{name}: {off:e}");
    }
}

/// The scene of a ball on a floor with lengths in units of 1/f metres: lengths, gravity and speeds grow by f, energies by f². In the plane gas acts
/// on a depth, which grows as well.
fn in_units(f: f64) -> Blueprint<2> {
    let text = format!(
        "{}[[body]]\nname = \"ball\"\nmass = 2\nthickness = {f:?}\nposition = [0, {:?}]\nvelocity = [{:?}, {:?}]\nangular_velocity = 2\n\
         shape = {{ kind = \"ring\", radius = {:?}, vertices = 24 }}\n\
         models = [{{ kind = \"mass_spring\", stiffness = 800.0, damping = 0.5 }}, \
         {{ kind = \"pressure\", nRT = {:?}, ambient = {:?} }}, {{ kind = \"bending\", stiffness = {:?}, damping = {:?} }}]\n\
         [[collider]]\nkind = \"half_space\"\npoint = [0, 0]\nnormal = [0, 1]\nfriction = 0.4\nrestitution = 0.3\nrest_speed = {:?}\n\
         [[command]]\ndo = \"drag\"\nat = 0.25\nbody = \"ball\"\nnode = 4\npath = [[0.25, {f:?}, {f:?}], [1, {:?}, {f:?}]]\n",
        head(1.0 / 64.0, 64, -9.81 * f, "symplectic_euler"),
        0.625 * f,
        1.5 * f,
        -3.0 * f,
        0.5 * f,
        40.0 * f * f,
        5.0 / f,
        0.05 * f * f,
        0.001 * f * f,
        0.05 * f,
        2.0 * f,
    );
    plane(&text)
}

/// Metres, about millimetres, about kilometres: powers of two give the same bits, because the engine contains no absolute length.
#[test]
fn the_unit_of_length_does_not_matter_to_the_bit() {
    let reference = ran(in_units(1.0), 64);
    let energy = reference.energy();
    assert!(energy.loss_contact > 0.01 && energy.loss_friction > 0.01 && energy.work_user.abs() > 0.01, "{energy:?}");
    for f in [1024.0, 1.0 / 1024.0, 2.0] {
        let world = ran(in_units(f), 64);
        for (a, b) in state(&reference).into_iter().zip(state(&world)) {
            assert_eq!(a.map(|c| f * c), b, "lengths times {f}");
        }
        let scaled = world.energy();
        assert_eq!((f * f * energy.kinetic, f * f * energy.loss_friction), (scaled.kinetic, scaled.loss_friction));
    }
}
