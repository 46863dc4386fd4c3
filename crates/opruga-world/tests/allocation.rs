//! The contract of a frame: after a few frames no frame allocates memory. Also the memory of a world per vertex.
#![allow(unsafe_code)] // an allocator that counts cannot be written without; nothing of it reaches the library

use opruga_core::spec::{Spec, Value, Values};
use opruga_mesh::Mesh;
use opruga_world::blueprint::*;
use opruga_world::{Options, Registry, World};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::Arc;

/// Counts the allocations of the calling thread.
struct Counting;

thread_local! {
    static REQUESTS: Cell<u64> = const { Cell::new(0) };
    static LIVE: Cell<i64> = const { Cell::new(0) };
    /// Whether the next allocation stops the test, to show where it is made.
    static FORBIDDEN: Cell<bool> = const { Cell::new(false) };
}

fn requested(bytes: i64) {
    // At the end of a thread its counters are gone; nothing reads them any more.
    let _ = REQUESTS.try_with(|n| n.set(n.get() + 1));
    let _ = LIVE.try_with(|n| n.set(n.get() + bytes));
    if FORBIDDEN.try_with(|f| f.replace(false)).unwrap_or(false) {
        eprintln!("a frame asks for memory here:\n{}", std::backtrace::Backtrace::force_capture());
    }
}

// SAFETY: every request is passed unchanged to the system allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        requested(layout.size() as i64);
        unsafe { System.alloc(layout) }
    }
    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        requested(layout.size() as i64);
        unsafe { System.alloc_zeroed(layout) }
    }
    unsafe fn realloc(&self, old: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        requested(size as i64 - layout.size() as i64);
        unsafe { System.realloc(old, layout, size) }
    }
    unsafe fn dealloc(&self, old: *mut u8, layout: Layout) {
        let _ = LIVE.try_with(|n| n.set(n.get() - layout.size() as i64));
        unsafe { System.dealloc(old, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

fn live() -> i64 {
    LIVE.with(Cell::get)
}

fn values<const D: usize>(spec: &'static Spec, fields: &[(&str, Value)]) -> Values {
    let mut values = Values::defaults(spec, D);
    for (name, value) in fields {
        values.set(spec, name, value.clone(), D).expect("a field of the test's own");
    }
    values
}

fn model<const D: usize>(kind: &str, fields: &[(&str, f64)]) -> Values {
    let fields: Vec<_> = fields.iter().map(|(n, x)| (*n, Value::Number(*x))).collect();
    values::<D>(Registry::<D>::default().model(kind).expect("a model").spec(), &fields)
}

fn floor<const D: usize>() -> ColliderBlueprint {
    let spec = opruga_collide::all(D).into_iter().find(|s| s.kind == "half_space").expect("a floor");
    let up: Vec<f64> = (0..D).map(|d| if d == 1 { 1.0 } else { 0.0 }).collect();
    let fields = [
        ("point", Value::Numbers(vec![0.0; D])),
        ("normal", Value::Numbers(up)),
        ("restitution", Value::Number(0.3)),
        ("friction", Value::Number(0.4)),
    ];
    ColliderBlueprint { values: values::<D>(spec, &fields) }
}

fn scene<const D: usize>(
    mesh: Mesh<D>,
    count: usize,
    models: &[Values],
    rule: &str,
    drag: Option<Vec<Vec<f64>>>,
) -> Blueprint<D> {
    let mesh = Arc::new(mesh);
    let body = |k: usize| BodyBlueprint {
        name: format!("ball[{k}]"),
        mesh: Arc::clone(&mesh),
        translation: core::array::from_fn(|d| if d == 0 { 2.0 * k as f64 } else { 0.0 }),
        velocity: [0.2; D],
        angular_velocity: Vec::new(),
        velocity_gradient: [[0.0; D]; D],
        contact: None,
        node_velocities: Arc::from([]),
        mass: Mass::Total(1.0),
        thickness: 1.0,
        integrator: None,
        models: models.to_vec(),
        pins: Vec::new(),
    };
    let command = |path: Vec<Vec<f64>>| CommandBlueprint {
        at: 0.0,
        until: 1e3,
        action: Action::Drag { body: 0, node: None, facet: false, stiffness: None, path, largest_force: Some(50.0) },
    };
    Blueprint {
        name: "test".into(),
        title: String::new(),
        length_unit: "m".into(),
        credit: String::new(),
        picture: Default::default(),
        seed: 0,
        time: Time { seconds: 1.0, frame: 1.0 / 60.0, substeps: 48 },
        surroundings: Surroundings {
            gravity: core::array::from_fn(|d| if d == 1 { -9.81 } else { 0.0 }),
            drag: 0.1,
            largest_force: None,
            largest_velocity: None,
            largest_distance: None,
            unfold: false,
        },
        integrator: Values::defaults(Registry::<D>::default().integrator(rule).expect("a rule").spec(), D),
        bodies: (0..count).map(body).collect(),
        colliders: vec![floor::<D>()],
        loads: Vec::new(),
        commands: drag.map(command).into_iter().collect(),
        probes: Vec::new(),
        contact: None,
    }
}

/// Allocations in every frame after ten frames.
fn requests<const D: usize>(name: &str, blueprint: Blueprint<D>) {
    // The stable step of explicit Euler follows from the drag alone, and is shorter than the substep.
    let options = Options { allow_unstable: true, ..Options::default() };
    // Without and with kept states within the frame.
    for look_every in [0, 7] {
        let mut world = World::new(blueprint.clone(), options.clone()).expect("a world");
        world.keep_looks(look_every);
        for _ in 0..10 {
            world.frame().expect("a frame");
        }
        for frame in 10..60 {
            let before = REQUESTS.with(Cell::get);
            FORBIDDEN.with(|f| f.set(true));
            let outcome = world.frame();
            FORBIDDEN.with(|f| f.set(false));
            let requests = REQUESTS.with(Cell::get) - before;
            outcome.expect("a frame");
            assert_eq!(requests, 0, "{name}, frame {frame}: one thread, no memory after ten frames");
        }
        assert!(world.energy().loss_contact > 0.0, "{name} has met the floor");
    }
}

const RULES: [&str; 5] = ["symplectic_euler", "explicit_euler", "heun", "verlet", "runge_kutta"];

fn pulled_ball(rule: &str, gas: &[(&str, f64)]) {
    let models = [
        model::<2>("mass_spring", &[("stiffness", 1600.0), ("damping", 1.0)]),
        model::<2>("pressure", gas),
        model::<2>("bending", &[("stiffness", 0.02)]),
    ];
    let ring = Mesh::ring(0.5, 36, [0.0, 0.55], 0.0).expect("a ring");
    let path = vec![vec![0.0, 0.5, 0.6], vec![0.5, 1.0, 1.0], vec![2.0, -1.0, 0.7]];
    requests(rule, scene(ring, 1, &models, rule, Some(path)));
}

#[test]
fn a_ball_with_gas_on_the_floor_under_a_pull_asks_for_no_memory() {
    for rule in RULES {
        pulled_ball(rule, &[("nRT", 55.0)]);
    }
}

/// Implicit integrators, exact and in real time, with conjugate gradients and with the sparse factor.
#[test]
fn a_net_that_falls_on_the_floor_in_implicit_steps_asks_for_no_memory() {
    let text = |text: &str| Value::Text(text.into());
    let models = [model::<2>("mass_spring", &[("stiffness", 400.0), ("damping", 0.1)])];
    for (rule, accuracy, solver) in [
        ("backward_euler", "exact", "conjugate_gradients"),
        ("backward_euler", "exact", "cholesky"),
        ("bdf2", "exact", "conjugate_gradients"),
        ("newmark", "exact", "conjugate_gradients"),
        ("implicit_midpoint", "exact", "conjugate_gradients"),
        ("backward_euler", "real_time", "conjugate_gradients"),
        ("backward_euler", "real_time", "cholesky"),
    ] {
        let net = Mesh::grid([0.0, 0.02], [0.5, 0.5], [6, 6]).expect("a grid");
        let mut blueprint = scene(net, 1, &models, "symplectic_euler", None);
        blueprint.time.substeps = 4;
        let spec = Registry::<2>::default().integrator(rule).expect("a rule").spec();
        blueprint.integrator = values::<2>(spec, &[("accuracy", text(accuracy)), ("linear_solver", text(solver))]);
        requests(&format!("{rule}, {accuracy}, {solver}"), blueprint);
    }
}

#[test]
fn a_ball_with_leaking_gas_asks_for_no_memory() {
    pulled_ball("symplectic_euler", &[("nRT", 55.0), ("ramp", 0.3), ("leak", 0.1)]);
}

#[test]
fn a_hundred_balls_side_by_side_ask_for_no_memory() {
    let models = [
        model::<2>("mass_spring", &[("stiffness", 1600.0), ("damping", 1.0)]),
        model::<2>("pressure", &[("nRT", 55.0)]),
    ];
    let ring = Mesh::ring(0.5, 36, [0.0, 0.55], 0.0).expect("a ring");
    requests("a hundred balls", scene(ring, 100, &models, "symplectic_euler", None));
}

#[test]
fn a_balloon_in_space_asks_for_no_memory() {
    let models =
        [model::<3>("mass_spring", &[("modulus", 300.0), ("damping", 0.02)]), model::<3>("pressure", &[("nRT", 40.0)])];
    let mut sphere = Mesh::icosphere(0.5, 3).expect("a sphere");
    sphere.translate([0.0, 0.55, 0.0]);
    let path = vec![vec![0.0, 0.5, 0.6, 0.0], vec![0.5, 1.0, 1.0, 0.5]];
    requests("a balloon", scene(sphere, 1, &models, "symplectic_euler", Some(path)));
}

/// Bytes on the heap per vertex of a ring of 100,000, including its blueprint and rest shape.
#[test]
fn a_large_ring_takes_at_most_two_hundred_bytes_a_vertex() {
    let before = live();
    let models = [
        model::<2>("mass_spring", &[("stiffness", 1600.0), ("damping", 40.0)]),
        model::<2>("pressure", &[("nRT", 8e5)]),
    ];
    let ring = Mesh::ring(1591.5, 100_000, [0.0, 1592.0], 0.0).expect("a ring");
    let mut blueprint = scene(ring, 1, &models, "symplectic_euler", None);
    blueprint.bodies[0].mass = Mass::Node(1.0);
    let mut world = World::new(blueprint, Options::default()).expect("a world");
    let built = (live() - before) as f64 / 1e5;
    world.frame().expect("a frame");
    let stepped = (live() - before) as f64 / 1e5;
    println!(
        "{built:.1} bytes a vertex after building, {stepped:.1} after a frame, {} told",
        world.heap_bytes() / 100_000
    );
    assert!(built <= 200.0, "{built:.1} bytes a vertex after building");
    assert!(stepped <= 200.0, "{stepped:.1} bytes a vertex after a frame");
}

/// Torture row 74: worlds are created and dropped, and their memory with them.
#[test]
fn worlds_leave_nothing_behind() {
    let models = [
        model::<2>("mass_spring", &[("stiffness", 1600.0), ("damping", 1.0)]),
        model::<2>("pressure", &[("nRT", 55.0)]),
    ];
    let ring = Mesh::ring(0.5, 12, [0.0, 0.55], 0.0).expect("a ring");
    let blueprint = scene(ring, 9, &models, "verlet", Some(vec![vec![0.0, 0.5, 0.6]]));
    let once = || {
        let mut world = World::new(blueprint.clone(), Options::default()).expect("a world");
        world.frame().expect("a frame");
        world.remove_body("ball[3]").expect("it is there");
        world.frame().expect("a frame");
        drop(world);
    };
    once();
    let before = live();
    for _ in 0..1000 {
        once();
    }
    assert_eq!(live(), before, "bytes left behind by a thousand worlds");
}

/// Torture row 74: bodies and commands of the program are added and removed, and nothing is kept of them: no memory, no bytes in snapshots, no work
/// for later ones.
#[test]
fn bodies_and_commands_that_are_over_leave_nothing_behind() {
    let models = [model::<2>("mass_spring", &[("stiffness", 1600.0), ("damping", 1.0)])];
    let ring = |vertices| Mesh::ring(0.5, vertices, [0.0, 0.55], 0.0).expect("a ring");
    let mut blueprint = scene(ring(12), 2, &models, "symplectic_euler", None);
    blueprint.time.substeps = 16;
    let own = BodyBlueprint { mesh: Arc::new(ring(10)), ..blueprint.bodies[0].clone() };
    let mut world = World::new(blueprint, Options::default()).expect("a world");
    let mut number = 0;
    let mut cycle = || {
        number += 1;
        let guest = BodyBlueprint { name: format!("guest {:06}", number), ..own.clone() };
        let name = guest.name.clone();
        let before = REQUESTS.with(Cell::get);
        let body = world.add_body(guest).expect("a body");
        let added = REQUESTS.with(Cell::get) - before;
        let (at, until) = (world.time(), world.time() + world.blueprint().time.frame);
        let push = |body| Action::Push { body, select: Selector::All, force: [0.01, 0.0] };
        for action in [push(0), push(body)] {
            world.command(CommandBlueprint { at, until, action }).expect("a command");
        }
        for (path, x) in
            [("world.drag", 0.1), ("body.ball[0].models.mass_spring.damping", 1.0 + 1e-6 * f64::from(number))]
        {
            world.set(path, Value::Number(x)).expect("a parameter");
        }
        world.frame().expect("a frame");
        world.remove_body(&name).expect("it is there");
        world.frame().expect("a frame");
        (added, world.snapshot().len(), world.blueprint().bodies.len())
    };
    // The first bodies whose commands end with them are named in warnings.
    let first = (0..40).map(|_| cycle()).last();
    let before = live();
    let last = (0..5000).map(|_| cycle()).last();
    assert_eq!(first, last, "requests of adding a body, bytes of a snapshot, places in the list");
    assert_eq!(live(), before, "bytes that stay of 5000 bodies and 10000 commands");
}
