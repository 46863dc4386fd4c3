//! Consistent and lumped masses of finite elements: bars and plates with closed forms, conserved quantities, refusals.

use opruga_core::spec::{Value, Values};
use opruga_math::Lane;
use opruga_mesh::Mesh;
use opruga_world::blueprint::*;
use opruga_world::{Options, Registry, World, WorldError};
use std::f64::consts::PI;
use std::sync::Arc;

const MODULUS: f64 = 1e6;
const DENSITY: f64 = 1000.0;

fn text(value: &str) -> Value {
    Value::Text(value.into())
}

/// A body of finite elements without external forces, with ν = 0.
fn body<const D: usize>(mesh: Mesh<D>, mass: &str, integrator: &str) -> Blueprint<D> {
    let registry = Registry::<D>::default();
    let spec = registry.model("fem").expect("a model").spec();
    let mut model = Values::defaults(spec, D);
    let set = [
        ("youngs_modulus", Value::Number(MODULUS)),
        ("poissons_ratio", Value::Number(0.0)),
        ("material", text("st_venant_kirchhoff")),
        ("mass", text(mass)),
    ];
    for (name, value) in set {
        model.set(spec, name, value, D).expect("a field of the test's own");
    }
    let spec = registry.integrator(integrator).expect("an integrator").spec();
    Blueprint {
        name: "test".into(),
        title: String::new(),
        length_unit: "m".into(),
        credit: String::new(),
        picture: Default::default(),
        seed: 0,
        time: Time { seconds: 1.0, frame: 0.01, substeps: 4 },
        surroundings: Surroundings {
            gravity: [0.0; D],
            drag: 0.0,
            largest_force: None,
            largest_velocity: None,
            largest_distance: None,
            unfold: false,
        },
        integrator: Values::defaults(spec, D),
        bodies: vec![BodyBlueprint {
            name: "body".into(),
            mesh: Arc::new(mesh),
            translation: [0.0; D],
            velocity: [0.0; D],
            angular_velocity: Vec::new(),
            velocity_gradient: [[0.0; D]; D],
            contact: None,
            node_velocities: Arc::from([]),
            mass: Mass::Density(DENSITY),
            thickness: 0.1,
            integrator: None,
            models: vec![model],
            pins: Vec::new(),
        }],
        colliders: Vec::new(),
        loads: Vec::new(),
        commands: Vec::new(),
        probes: Vec::new(),
        contact: None,
    }
}

fn world<const D: usize>(blueprint: Blueprint<D>) -> World<D> {
    World::new(blueprint, Options::default()).expect("a world")
}

/// A bar clamped at x = 0: lateral motion is pinned everywhere, so only axial motion remains at low frequencies.
fn bar<const D: usize>(mesh: Mesh<D>, mass: &str) -> Blueprint<D> {
    let mut bar = body(mesh, mass, "implicit_midpoint");
    let lateral = core::array::from_fn(|d| d > 0);
    bar.bodies[0].pins = vec![
        PinBlueprint { select: Selector::Side("left".into()), axes: [true; D], motion: Vec::new() },
        PinBlueprint { select: Selector::All, axes: lateral, motion: Vec::new() },
    ];
    bar
}

/// ω of the j-th mode of n linear bar elements of length h: (2c/h) sin(kh/2) with lumped masses, and this times √(3/(2 + cos kh)) with consistent
/// ones; k = (2j − 1)π/2L (Hughes, *The finite element method*, 7.3).
fn closed_form(consistent: bool, j: usize, length: f64, cells: usize) -> f64 {
    let (h, speed) = (length / cells as f64, (MODULUS / DENSITY).sqrt());
    let phase = (2 * j - 1) as f64 * PI / (2.0 * length) * h;
    let lumped = 2.0 * speed / h * libm::sin(0.5 * phase);
    if consistent { lumped * (3.0 / (2.0 + libm::cos(phase))).sqrt() } else { lumped }
}

fn bar_has_the_frequencies_of_the_closed_form<const D: usize>(mesh: Mesh<D>, length: f64, cells: usize) {
    for mass in ["lumped", "consistent"] {
        let modes = world(bar(mesh.clone(), mass)).modes(0, 4).expect("modes");
        for (k, mode) in modes.iter().enumerate() {
            let j = k + 1;
            let wanted = closed_form(mass == "consistent", j, length, cells);
            let wave = (MODULUS / DENSITY).sqrt() * (2 * j - 1) as f64 * PI / (2.0 * length);
            let found = mode.omega();
            assert!((found / wanted - 1.0).abs() < 1e-8, "{mass}, mode {j}: {found} {wanted}");
            assert!(if mass == "lumped" { found < wave } else { found > wave }, "{mass}, mode {j}: {found} {wave}");
        }
    }
}

#[test]
fn waves_in_bars_are_too_slow_with_lumped_and_too_fast_with_consistent_masses() {
    let plane = Mesh::<2>::grid([0.0; 2], [1.0, 0.01], [10, 1]).unwrap();
    bar_has_the_frequencies_of_the_closed_form(plane, 1.0, 10);
    let space = Mesh::<3>::grid([0.0; 3], [2.0, 0.02, 0.02], [8, 1, 1]).unwrap();
    bar_has_the_frequencies_of_the_closed_form(space, 2.0, 8);
}

/// The stiffnesses of cells that belong to two models would add up, and cells of no model have no stiffness. Both are refused if groups are named.
#[test]
fn every_cell_has_one_material() {
    let refusal = |groups: &[&str]| {
        let mut mesh = Mesh::<2>::grid([0.0; 2], [2.0, 1.0], [2, 1]).unwrap();
        mesh.cell_groups.insert("left".into(), vec![0]);
        mesh.cell_groups.insert("right".into(), vec![1]);
        let mut blueprint = body(mesh, "lumped", "backward_euler");
        let spec = Registry::<2>::default().model("fem").expect("a model").spec();
        let model = blueprint.bodies[0].models.remove(0);
        for group in groups {
            let mut model = model.clone();
            if !group.is_empty() {
                model.set(spec, "cells", text(group), 2).expect("a field");
            }
            blueprint.bodies[0].models.push(model);
        }
        World::new(blueprint, Options::default()).map_or_else(|error| error.to_string(), |_| "built".into())
    };
    assert_eq!(refusal(&["left", "right"]), "built");
    assert_eq!(refusal(&[""]), "built");
    let bare = refusal(&["left"]);
    assert!(bare.contains("1 of 2 cells") && bare.contains("`left`"), "{bare}");
    let twice = refusal(&["left", ""]);
    assert!(twice.contains("cell 0 belongs"), "{twice}");
    assert!(refusal(&["", ""]).contains("would add up"));
}

/// The weight of a body with consistent masses follows from its shape functions, so the body falls without deformation.
#[test]
fn a_body_of_consistent_masses_falls_without_being_deformed() {
    let mesh =
        Mesh::<2>::grid([0.0; 2], [0.4, 1.0], [1, 3]).unwrap().into_simplices().unwrap().into_quadratic().unwrap();
    let mut blueprint = body(mesh.clone(), "consistent", "newmark");
    let spec = Registry::<2>::default().integrator("newmark").expect("an integrator").spec();
    blueprint.integrator.set(spec, "tolerance", Value::Number(1e-12), 2).expect("a field");
    blueprint.surroundings.gravity = [0.0, -9.81];
    let mut world = world(blueprint);
    for _ in 0..20 {
        world.frame().unwrap();
    }
    let fall = 0.5 * 9.81 * world.time() * world.time();
    for (node, x) in mesh.positions.iter().enumerate() {
        let now = world.position(0, node as u32);
        for d in 0..2 {
            let expected = if d == 1 { x[d] - fall } else { x[d] };
            assert!((now[d] - expected).abs() < 1e-9, "{node}: {now:?}");
        }
    }
}

/// A bar released in its first mode returns after the period of this mode; average acceleration conserves the energy.
#[test]
fn steps_follow_the_frequencies_of_the_same_masses() {
    for (integrator, mass) in [("newmark", "consistent"), ("implicit_midpoint", "consistent"), ("newmark", "lumped")] {
        let mesh = Mesh::<2>::grid([0.0; 2], [1.0, 0.01], [6, 1]).unwrap();
        let mut blueprint = bar(mesh.clone(), mass);
        let spec = Registry::<2>::default().integrator(integrator).expect("an integrator").spec();
        blueprint.integrator = Values::defaults(spec, 2);
        blueprint.integrator.set(spec, "tolerance", Value::Number(1e-12), 2).expect("a field");
        let mode = world(blueprint.clone()).modes(0, 1).expect("a mode").remove(0);
        let steps = 200;
        blueprint.time = Time { seconds: 1.0, frame: 2.0 * PI / mode.omega() / f64::from(steps), substeps: 1 };
        let mut bar = world(blueprint);
        let size = 1e-5 / mode.shape.iter().map(|u| u[0].abs()).fold(0.0, Lane::larger);
        let start: Vec<[f64; 2]> =
            mesh.positions.iter().zip(&mode.shape).map(|(x, u)| core::array::from_fn(|d| x[d] + size * u[d])).collect();
        for (node, x) in start.iter().enumerate() {
            bar.set_node(0, node as u32, *x, [0.0; 2]).expect("a place");
        }
        let energy = bar.energy().total();
        for _ in 0..steps {
            bar.frame().expect("a frame");
        }
        for (node, x) in start.iter().enumerate() {
            let way = (bar.position(0, node as u32)[0] - x[0]).abs();
            // The phase error of the integrator is (hω)²/12 of a period: 5e-4 of a turn, which enters the cosine squared.
            assert!(way < 1e-3 * 1e-5, "{integrator}, {mass}, node {node}: {way}");
        }
        assert!((bar.energy().total() / energy - 1.0).abs() < 1e-5, "{integrator}, {mass}: {:?}", bar.energy());
    }
}

/// A square plate of few cells has the moment of inertia of the continuum, m (a² + b²)/12, and conserves its momenta while it rotates.
#[test]
fn a_turning_plate_has_the_kinetic_energy_and_the_momenta_of_the_continuum() {
    let quadratic = Mesh::<2>::grid([-0.5, -0.25], [1.0, 0.5], [2, 1]).unwrap().into_simplices().unwrap();
    for mesh in [Mesh::<2>::grid([-0.5, -0.25], [1.0, 0.5], [2, 1]).unwrap(), quadratic.into_quadratic().unwrap()] {
        let mut blueprint = body(mesh, "consistent", "implicit_midpoint");
        blueprint.bodies[0].velocity = [0.3, -0.2];
        blueprint.bodies[0].angular_velocity = vec![2.0];
        let mut plate = world(blueprint);
        let mass = DENSITY * 0.5 * 0.1;
        let moment = mass * (1.0 + 0.25) / 12.0;
        let kinetic = 0.5 * mass * (0.09 + 0.04) + 0.5 * moment * 4.0;
        assert!((plate.energy().kinetic / kinetic - 1.0).abs() < 1e-12, "{} {kinetic}", plate.energy().kinetic);
        let before = plate.momentum();
        assert!((before.angular[2] / (2.0 * moment) - 1.0).abs() < 1e-12, "{before:?}");
        assert!((before.linear.0[0] / (0.3 * mass) - 1.0).abs() < 1e-12, "{before:?}");
        for _ in 0..20 {
            plate.frame().expect("a frame");
        }
        let after = plate.momentum();
        assert!((after.angular[2] / before.angular[2] - 1.0).abs() < 1e-7, "{before:?} {after:?}");
        for d in 0..2 {
            assert!((after.linear.0[d] / before.linear.0[d] - 1.0).abs() < 1e-9, "{before:?} {after:?}");
        }
        let (now, start) = (plate.energy().total(), kinetic);
        assert!((now / start - 1.0).abs() < 1e-3, "{now} {start}");
    }
}

/// All implicit integrators and all solvers of their equations use the same masses.
#[test]
fn solvers_agree_on_consistent_masses() {
    let mesh = Mesh::<3>::grid([0.0; 3], [1.0, 0.3, 0.3], [4, 2, 2]).unwrap().into_simplices().unwrap();
    let run = |solver: &str, accuracy: &str| {
        let mut blueprint = body(mesh.clone(), "consistent", "backward_euler");
        blueprint.surroundings.gravity = [0.0, -9.81, 0.0];
        blueprint.bodies[0].pins =
            vec![PinBlueprint { select: Selector::Side("left".into()), axes: [true; 3], motion: Vec::new() }];
        let spec = Registry::<3>::default().integrator("backward_euler").expect("an integrator").spec();
        for (name, value) in [("linear_solver", solver), ("accuracy", accuracy)] {
            blueprint.integrator.set(spec, name, text(value), 3).expect("a field");
        }
        let mut beam = world(blueprint);
        (0..10).for_each(|_| beam.frame().expect("a frame"));
        beam.position(0, beam.node_count(0) as u32 - 1)
    };
    let wanted = run("cholesky", "exact");
    for (solver, accuracy, error) in [
        ("conjugate_gradients", "exact", 1e-8),
        ("matrix_free", "exact", 1e-8),
        ("conjugate_gradients", "real_time", 1e-3),
        ("cholesky", "real_time", 1e-3),
    ] {
        let found = run(solver, accuracy);
        let fallen = 0.0 - wanted[1] + 0.3;
        for d in 0..3 {
            assert!((found[d] - wanted[d]).abs() < error * fallen, "{solver}, {accuracy}: {found:?} {wanted:?}");
        }
    }
}

/// A floor at a given height.
fn floor<const D: usize>(height: f64) -> ColliderBlueprint {
    let spec = opruga_collide::all(D).into_iter().find(|s| s.kind == "half_space").expect("a floor");
    let mut values = Values::defaults(spec, D);
    let up: [f64; D] = core::array::from_fn(|d| if d == 1 { 1.0 } else { 0.0 });
    for (name, numbers) in [("point", up.map(|x| height * x)), ("normal", up)] {
        values.set(spec, name, Value::Numbers(numbers.to_vec()), D).expect("a field");
    }
    ColliderBlueprint { values }
}

/// In statics masses serve only as weights, so obstacles can be combined with consistent ones. A beam that sags onto a floor, with cells whose
/// corners have zero or negative weight, lies on it as with lumped masses.
#[test]
fn a_beam_lies_on_a_floor_as_deep_with_consistent_as_with_lumped_masses() {
    fn lies<const D: usize>(mesh: &Mesh<D>, mass: &str) -> (f64, f64, usize) {
        let mut blueprint = body(mesh.clone(), mass, "equilibrium");
        let height = -0.02;
        blueprint.surroundings.gravity = core::array::from_fn(|d| if d == 1 { -9.81 } else { 0.0 });
        blueprint.bodies[0].pins =
            vec![PinBlueprint { select: Selector::Side("left".into()), axes: [true; D], motion: Vec::new() }];
        blueprint.colliders.push(floor::<D>(height));
        let mut beam = world(blueprint);
        beam.frame().expect("a balance");
        let heights: Vec<f64> = (0..beam.node_count(0) as u32).map(|node| beam.position(0, node)[1]).collect();
        let lowest = heights.iter().copied().fold(f64::INFINITY, Lane::smaller);
        let touching = heights.iter().filter(|y| **y < height + 1e-8).count();
        (beam.energy().elastic, lowest - height, touching)
    }
    fn agrees<const D: usize>(mesh: &Mesh<D>) {
        let [(consistent, above, touching), (lumped, ..)] = ["consistent", "lumped"].map(|mass| lies(mesh, mass));
        assert!(above.abs() < 1e-8 && touching > 0, "{above} m, {touching} nodes");
        assert!((consistent / lumped - 1.0).abs() < 0.05, "{consistent} {lumped}");
    }
    let space = Mesh::<3>::grid([0.0; 3], [1.0, 0.2, 0.2], [5, 1, 1]).expect("a mesh");
    agrees(&space.into_simplices().expect("tetrahedra").into_quadratic().expect("quadratic ones"));
    let plane = Mesh::<2>::grid([0.0; 2], [1.0, 0.2], [10, 2]).expect("a mesh");
    agrees(&plane);
    agrees(&plane.into_simplices().expect("triangles").into_quadratic().expect("quadratic ones"));
}

/// Statics has no inertia: a beam sags equally with all kinds of mass matrices, but oscillates about this state with different frequencies.
#[test]
fn a_balance_is_the_same_with_consistent_and_lumped_masses() {
    let sag = |mass: &str, material: &str| {
        let mesh = Mesh::<3>::grid([0.0; 3], [1.0, 0.3, 0.3], [4, 2, 2]).expect("a mesh");
        let mesh = mesh.into_simplices().expect("tetrahedra").into_quadratic().expect("quadratic ones");
        let mut blueprint = body(mesh, mass, "equilibrium");
        blueprint.surroundings.gravity = [0.0, -9.81, 0.0];
        blueprint.bodies[0].pins =
            vec![PinBlueprint { select: Selector::Side("left".into()), axes: [true; 3], motion: Vec::new() }];
        let spec = Registry::<3>::default().model("fem").expect("a model").spec();
        blueprint.bodies[0].models[0].set(spec, "material", text(material), 3).expect("a field");
        let mut beam = world(blueprint);
        beam.frame().expect("a balance");
        let frequencies: Vec<f64> = beam.modes(0, 2).expect("modes").iter().map(|mode| mode.omega()).collect();
        (beam.energy().elastic, beam.energy().kinetic, frequencies)
    };
    for material in ["st_venant_kirchhoff", "stable_neo_hookean"] {
        let (consistent, moving, of_consistent) = sag("consistent", material);
        let (lumped, _, of_lumped) = sag("lumped", material);
        assert!((consistent / lumped - 1.0).abs() < 0.02 && moving == 0.0, "{material}: {consistent} {lumped}");
        for (consistent, lumped) in of_consistent.iter().zip(&of_lumped) {
            assert!((consistent / lumped - 1.0).abs() < 0.05, "{material}: {of_consistent:?} {of_lumped:?}");
        }
    }
}

#[test]
fn what_moves_nodes_by_their_own_masses_refuses_consistent_ones_and_says_what_helps() {
    let mesh = || Mesh::<2>::grid([0.0; 2], [1.0, 0.5], [2, 1]).unwrap();
    let refusal = |blueprint: Blueprint<2>| match World::new(blueprint, Options::default()) {
        Err(WorldError::Build { source, .. }) => (source.code().to_string(), source.to_string()),
        Err(other) => panic!("{other}"),
        Ok(_) => panic!("no refusal"),
    };
    for integrator in ["symplectic_euler", "verlet", "runge_kutta", "heun", "explicit_euler"] {
        let (code, message) = refusal(body(mesh(), "consistent", integrator));
        assert_eq!(code, "integrator.mass_matrix");
        for word in [integrator, "consistent", "lumped", "backward_euler"] {
            assert!(message.contains(word), "{message}");
        }
    }
    let mut by_node = body(mesh(), "consistent", "newmark");
    by_node.bodies[0].mass = Mass::Node(1.0);
    assert_eq!(refusal(by_node).0, "model.mass");
    let mut on_a_floor = body(mesh(), "consistent", "newmark");
    on_a_floor.colliders.push(floor::<2>(-1.0));
    let (code, message) = refusal(on_a_floor);
    assert!(code == "model.mass" && message.contains("lumped") && message.contains("`equilibrium`"), "{message}");
}
