//! Implicit steps from impossible shapes: every body returns to its volume, or is refused with a reason.

use crate::common;

use common::{clamp, solid, text};
use opruga_core::spec::Value;
use opruga_math::Lane;
use opruga_math::matrix::determinant;
use opruga_math::message::Message as _;
use opruga_mesh::Mesh;
use opruga_world::blueprint::{Blueprint, PinBlueprint};
use opruga_world::{Options, World};

const MATERIALS: [&str; 2] = ["stable_neo_hookean", "fixed_corotated"];

/// A weightless cube of 1 m, and a step.
fn body<const D: usize>(mesh: Mesh<D>, material: &str, frame: f64, pins: Vec<PinBlueprint<D>>) -> Blueprint<D> {
    let mut blueprint = solid(
        mesh,
        "backward_euler",
        &[("when_not_converged", text("halve"))],
        &[
            ("material", text(material)),
            ("youngs_modulus", Value::Number(1e5)),
            ("poissons_ratio", Value::Number(0.4)),
            ("damping", Value::Number(0.05)),
        ],
    );
    blueprint.time.frame = frame;
    blueprint.bodies[0].pins = pins;
    blueprint.surroundings.unfold = true;
    blueprint
}

fn cube(n: u32) -> Mesh<3> {
    Mesh::grid([0.0; 3], [1.0; 3], [n; 3]).unwrap().into_simplices().unwrap()
}

/// The volume ratio of the body, and the smallest one of its tetrahedra.
fn volumes(world: &World<3>, mesh: &Mesh<3>) -> (f64, f64) {
    let (mut whole, mut at_rest, mut least) = (0.0, 0.0, f64::INFINITY);
    for cell in &mesh.cells.tetrahedra {
        let sides = |at: &dyn Fn(u32) -> [f64; 3]| {
            let first = at(cell[0]);
            determinant(&[1, 2, 3].map(|k| core::array::from_fn(|d| at(cell[k])[d] - first[d])))
        };
        let now = sides(&|node| world.position(0, node));
        let rest = sides(&|node| mesh.positions[node as usize]);
        (whole, at_rest, least) = (whole + now, at_rest + rest, if now / rest < least { now / rest } else { least });
    }
    (whole / at_rest, least)
}

/// The outcome of a body that starts in another shape, within thirty seconds.
#[derive(Debug, PartialEq)]
enum End {
    /// It has its volume within 0.1 %, and no cell is inverted.
    Back,
    /// An error or a warning gives the reason why not.
    Reasoned(String),
    /// Neither: the volume ratio, and the smallest one of a cell.
    Silent(f64, f64),
}

/// The volume ratio of a body, and the smallest one of its cells.
fn ratios<const D: usize>(world: &World<D>) -> (f64, f64) {
    let cells = world.cell_states(0);
    let (now, rest) = cells.iter().fold((0.0, 0.0), |(a, b), c| (a + c.volume_ratio * c.measure, b + c.measure));
    (now / rest, cells.iter().map(|cell| cell.volume_ratio).fold(f64::INFINITY, Lane::smaller))
}

/// The outcome of a body that starts in a given shape, judged by the volume ratios from `measure`.
fn end<const D: usize>(
    blueprint: Blueprint<D>,
    name: &str,
    shape: &dyn Fn([f64; D], usize) -> [f64; D],
    measure: &dyn Fn(&World<D>) -> (f64, f64),
) -> End {
    let positions = blueprint.bodies[0].mesh.positions.clone();
    let mut world = World::new(blueprint, Options::default()).unwrap();
    for (node, at) in positions.iter().enumerate() {
        world.set_node(0, node as u32, shape(*at, node), [0.0; D]).unwrap();
    }
    let mut told = None;
    for frame in 0..900 {
        if let Err(error) = world.frame() {
            let reason = error.in_full();
            assert!(reason.contains("did not converge") && reason.contains("hint"), "{name}: {reason}");
            assert!(frame > 0 || reason.contains("cells degenerate or inverted"), "{name}: {reason}");
            return End::Reasoned(reason);
        }
        let (whole, least) = measure(&world);
        if frame > 10 && (whole - 1.0).abs() < 1e-3 && least > 0.9 {
            println!("{name}: back after {frame} frames, disturbed {} times", world.solver_work().disturbed);
            return End::Back;
        }
        if let Some(warning) = world.warnings().into_iter().find(|warning| warning.code == "step.odd_rest") {
            assert!(warning.message.contains("body `body`") && warning.message.contains("J = "), "{warning:?}");
            told.get_or_insert_with(|| format!("after {frame} frames: {}", warning.message));
        }
        // Some return by themselves nevertheless.
        if told.is_some() && frame >= 450 {
            break;
        }
    }
    if let Some(reason) = told {
        return End::Reasoned(reason);
    }
    if let Some(warning) = world.inverted_cells() {
        assert!(warning.message.contains("of body `body`, with J = -"), "{warning:?}");
        return End::Reasoned(warning.message);
    }
    let (whole, least) = measure(&world);
    End::Silent(whole, least)
}

/// It ends at its volume, or a step gives the reason why not.
fn comes_back<const D: usize>(blueprint: Blueprint<D>, name: &str, shape: &dyn Fn([f64; D], usize) -> [f64; D]) {
    let end = end(blueprint, name, shape, &ratios);
    assert!(!matches!(end, End::Silent(..)), "{name}: {end:?}");
}

/// A number from −1 to 1 that depends on a node and an axis.
fn random(node: usize, axis: usize) -> f64 {
    let mut state = (node * 3 + axis) as u64 + 1;
    for _ in 0..3 {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    }
    (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

const ALL_MATERIALS: [&str; 4] = ["stable_neo_hookean", "fixed_corotated", "neo_hookean", "corotated"];

fn tetrahedra(material: &str) -> Blueprint<3> {
    body(cube(3), material, 1.0 / 30.0, Vec::new())
}

fn hexahedra(material: &str) -> Blueprint<3> {
    body(Mesh::grid([0.0; 3], [1.0; 3], [3; 3]).unwrap(), material, 1.0 / 30.0, Vec::new())
}

/// Bodies that start exactly on a plane, on a line or in a point, where all lateral forces balance, and mirrored bodies.
#[test]
fn bodies_that_symmetry_holds_flat_or_inside_out_leave_it_or_say_that_they_stay() {
    leave_symmetry("tetrahedra", tetrahedra, &ALL_MATERIALS[..1], |_, _| true);
    leave_symmetry("hexahedra", hexahedra, &ALL_MATERIALS[..1], |_, _| true);
    let plane = |quadratic: bool| {
        let mesh = Mesh::<2>::grid([0.0; 2], [1.0; 2], [3; 2]).unwrap().into_simplices().unwrap();
        let mesh = if quadratic { mesh.into_quadratic().unwrap() } else { mesh };
        body(mesh, "stable_neo_hookean", 1.0 / 30.0, Vec::new())
    };
    for quadratic in [false, true] {
        comes_back(plane(quadratic), "triangles, line", &|x, _| [x[0], 0.0]);
        comes_back(plane(quadratic), "triangles, point", &|_, _| [0.5; 2]);
        comes_back(plane(quadratic), "triangles, mirrored", &|x, _| [-x[0], x[1]]);
    }
}

#[test]
#[ignore = "a sweep: cargo test -- --ignored whole_sweep"]
fn tetrahedra_of_other_materials_leave_symmetry_or_say_that_they_stay_whole_sweep() {
    leave_symmetry("tetrahedra", tetrahedra, &ALL_MATERIALS[1..], |_, _| true);
}

#[test]
#[ignore = "a sweep: cargo test -- --ignored whole_sweep"]
fn hexahedra_of_other_materials_leave_symmetry_or_say_that_they_stay_whole_sweep() {
    // Each material with two of the four shapes, because all of them take three minutes.
    leave_symmetry("hexahedra", hexahedra, &ALL_MATERIALS[1..], |material, shape| (material + shape) % 2 == 0);
}

/// A shape with its name.
type Collapse = (&'static str, fn([f64; 3], usize) -> [f64; 3]);

/// The selected pairs of materials and shapes, by number.
fn leave_symmetry(name: &str, cells: fn(&str) -> Blueprint<3>, materials: &[&str], chosen: fn(usize, usize) -> bool) {
    const SHAPES: [Collapse; 4] = [
        ("plane", |x, _| [x[0], 0.0, x[2]]),
        ("line", |x, _| [x[0], 0.0, 0.0]),
        ("point", |_, _| [0.0; 3]),
        ("mirrored", |x, _| [-x[0], x[1], x[2]]),
    ];
    // One material takes a minute, so they run in parallel.
    std::thread::scope(|threads| {
        for (number, material) in materials.iter().enumerate() {
            threads.spawn(move || {
                for (shape, (what, collapse)) in SHAPES.iter().enumerate() {
                    if chosen(number, shape) {
                        comes_back(cells(material), &format!("{name}, {material}, {what}"), collapse);
                    }
                }
            });
        }
    });
}

/// The same in statics, for a clamped body, and in real time.
#[test]
fn statics_and_real_time_leave_flat_shapes_too() {
    for material in MATERIALS {
        for (rule, field) in
            [("equilibrium", ("load_steps", Value::Integer(1))), ("backward_euler", ("accuracy", text("real_time")))]
        {
            let mut blueprint = solid(
                cube(3),
                rule,
                &[field],
                &[
                    ("material", text(material)),
                    ("youngs_modulus", Value::Number(1e5)),
                    ("damping", Value::Number(0.05)),
                ],
            );
            blueprint.time.frame = 1.0 / 30.0;
            blueprint.bodies[0].pins = clamp();
            blueprint.surroundings.unfold = true;
            // Pinned nodes stay in place.
            let on_line = |x: [f64; 3], _| if x[0] == 0.0 { x } else { [x[0], 0.5, 0.5] };
            let in_point = |x: [f64; 3], _| if x[0] == 0.0 { x } else { [0.5; 3] };
            comes_back(blueprint.clone(), &format!("{rule}, {material}, line"), &on_line);
            comes_back(blueprint, &format!("{rule}, {material}, point"), &in_point);
        }
    }
}

#[test]
fn scattered_stretched_and_twisted_bodies_come_back_or_are_refused_with_a_reason() {
    for material in MATERIALS {
        comes_back(tetrahedra(material), "scattered", &|_, node| core::array::from_fn(|d| random(node, d)));
        comes_back(tetrahedra(material), "stretched tenfold", &|x, _| [10.0 * x[0], x[1], x[2]]);
        let fine = body(cube(4), material, 1.0 / 30.0, Vec::new());
        comes_back(fine, "twisted three times", &|x, _| {
            let angle = 6.0 * core::f64::consts::PI * x[0];
            let (c, s) = (libm::cos(angle), libm::sin(angle));
            let (y, z) = (x[1] - 0.5, x[2] - 0.5);
            [x[0], c * y - s * z, s * y + c * z]
        });
    }
}

/// All other integrators, with every kind of cell: a body that stays folded is reported.
#[test]
fn every_rule_brings_every_kind_of_cell_back_or_says_what_is_folded() {
    let grid = || Mesh::<3>::grid([0.0; 3], [1.0; 3], [2; 3]).unwrap();
    let cells = [
        ("tetrahedra", cube(2)),
        ("quadratic", cube(2).into_quadratic().unwrap()),
        ("hexahedra", grid()),
        ("nodal volumes", cube(2)),
    ];
    for rule in ["bdf2", "implicit_midpoint", "newmark"] {
        for (name, mesh) in &cells {
            let mut material = vec![("youngs_modulus", Value::Number(1e5)), ("damping", Value::Number(0.05))];
            material.extend((*name == "nodal volumes").then(|| ("locking", text("nodal_volume"))));
            let mut blueprint = solid(mesh.clone(), rule, &[("when_not_converged", text("halve"))], &material);
            blueprint.time.frame = 1.0 / 30.0;
            blueprint.surroundings.unfold = true;
            let name = |shape: &str| format!("{rule}, {name}, {shape}");
            comes_back(blueprint.clone(), &name("plane"), &|x, _| [x[0], 0.0, x[2]]);
            // Many inverted or randomly placed nodes take long to recover.
            if mesh.nodes() <= 27 {
                comes_back(blueprint.clone(), &name("mirrored"), &|x, _| [-x[0], x[1], x[2]]);
                comes_back(blueprint, &name("scattered"), &|_, node| core::array::from_fn(|d| random(node, d)));
            }
        }
    }
}

/// The randomness is the same in every run: a displaced body is the same to the last bit, and a snapshot contains the number of displacements.
#[test]
fn disturbances_are_repeatable_and_counted() {
    let flat = || {
        let blueprint = tetrahedra("stable_neo_hookean");
        let positions = blueprint.bodies[0].mesh.positions.clone();
        let mut world = World::new(blueprint, Options::default()).unwrap();
        for (node, x) in positions.iter().enumerate() {
            world.set_node(0, node as u32, [x[0], 0.0, 0.0], [0.0; 3]).unwrap();
        }
        world
    };
    let (mut a, mut b) = (flat(), flat());
    let mut frames = 0;
    while a.solver_work().disturbed == 0 {
        a.frame().unwrap();
        frames += 1;
        assert!(frames < 1000);
    }
    (0..frames + 20).for_each(|_| b.frame().unwrap());
    let snapshot = a.snapshot();
    let mut c = flat();
    c.restore(&snapshot).unwrap();
    (0..20).for_each(|_| a.frame().unwrap());
    (0..20).for_each(|_| c.frame().unwrap());
    assert_eq!((a.state_hash(), a.solver_work()), (b.state_hash(), b.solver_work()));
    assert_eq!((a.state_hash(), a.solver_work()), (c.state_hash(), c.solver_work()));
    assert!(a.warnings().iter().any(|warning| warning.code == "step.disturbed"));
}

/// A viscous body that was stretched and released creeps back. Its elastic forces are out of balance all the time, by U/ε at a strain ε, however
/// slowly it moves. Only damping balances them, so it is not at rest, and no cell is flat or inverted. No step may therefore add energy to it: at
/// small strains its stored energy falls as exp(−2t/τ).
#[test]
fn a_body_that_creeps_back_against_its_viscosity_is_never_taken_for_one_at_rest() {
    let tau = 20.0;
    for stretch in [1.2, 2.0] {
        let mesh = Mesh::<2>::grid([0.0; 2], [1.0, 0.5], [4, 2]).unwrap();
        let mut blueprint = solid(
            mesh.clone(),
            "backward_euler",
            &[],
            &[
                ("material", text("neo_hookean")),
                ("youngs_modulus", Value::Number(1e5)),
                ("poissons_ratio", Value::Number(0.3)),
                ("damping", Value::Number(tau)),
            ],
        );
        blueprint.time.frame = 0.05;
        blueprint.surroundings.unfold = true;
        let mut world = World::new(blueprint, Options::default()).unwrap();
        for (node, x) in mesh.positions.iter().enumerate() {
            world.set_node(0, node as u32, [stretch * x[0], x[1]], [0.0; 2]).unwrap();
        }
        let (mut before, mut late) = (f64::INFINITY, f64::NAN);
        while world.time() < 70.0 - 0.025 {
            world.frame().unwrap();
            let energy = world.energy();
            let now = energy.elastic + energy.kinetic;
            assert!(now < before, "stretched {stretch} times, at {} s: {now} J after {before} J", world.time());
            before = now;
            late = if world.time() < 60.0 + 0.025 { now } else { late };
        }
        assert_eq!(
            (world.solver_work().disturbed, world.solver_work().stayed_degenerate),
            (0, 0),
            "stretched {stretch} times"
        );
        let kept = before / late * libm::exp(2.0 * 10.0 / tau);
        assert!(stretch > 1.2 || (kept - 1.0).abs() < 0.1, "{before} J ten seconds after {late} J");
    }
}

/// Steps that are accepted without convergence may not diverge without limit.
#[test]
fn accepted_steps_that_blow_a_body_up_end_in_an_error() {
    // Two iterations per step, a law that pushes flat cells far out, and a random start.
    let mut blueprint = solid(
        cube(3),
        "newmark",
        &[("when_not_converged", text("accept")), ("iterations", Value::Integer(1))],
        &[
            ("material", text("neo_hookean")),
            ("youngs_modulus", Value::Number(1e5)),
            ("poissons_ratio", Value::Number(-0.5)),
        ],
    );
    blueprint.time.frame = 0.1;
    let positions = blueprint.bodies[0].mesh.positions.clone();
    let mut world = World::new(blueprint, Options::default()).unwrap();
    for (node, _) in positions.iter().enumerate() {
        world.set_node(0, node as u32, core::array::from_fn(|d| random(node, d)), [0.0; 3]).unwrap();
    }
    let mut refused = None;
    for _ in 0..400 {
        if let Err(error) = world.frame() {
            refused = Some(error.in_full());
            break;
        }
        let extent = (0..positions.len()).map(|n| world.position(0, n as u32)[0].abs()).fold(0.0, Lane::larger);
        assert!(extent < 1e4, "{extent}");
    }
    let told = refused.expect("an error");
    assert!(told.contains("a hundred times as large") && told.contains("`newmark` did not converge"), "{told}");
}

/// The largest distance between the same nodes of two worlds.
fn apart<const D: usize>(a: &World<D>, b: &World<D>) -> f64 {
    let distance = |node: u32| {
        let (x, y) = (a.position(0, node), b.position(0, node));
        (0..D).map(|d| (x[d] - y[d]) * (x[d] - y[d])).sum::<f64>().sqrt()
    };
    (0..a.node_count(0) as u32).map(distance).fold(0.0, Lane::larger)
}

fn hanging(mesh: Mesh<3>, rule: &str, frame: f64, damping: f64) -> World<3> {
    let mut blueprint = solid(
        mesh,
        rule,
        &[],
        &[
            ("youngs_modulus", Value::Number(1e5)),
            ("poissons_ratio", Value::Number(0.3)),
            ("damping", Value::Number(damping)),
        ],
    );
    blueprint.time.frame = frame;
    blueprint.surroundings.gravity = [0.0, -9.81, 0.0];
    blueprint.bodies[0].pins = clamp();
    World::new(blueprint, Options::default()).unwrap()
}

/// A clamped body under its weight, node by node: in long steps it comes to rest at the static solution, in short steps it moves as with explicit
/// steps.
#[test]
fn steps_from_ten_microseconds_to_two_seconds_lead_every_node_to_the_same_place() {
    for h in [2.0, 0.1] {
        let mut still = hanging(cube(3), "equilibrium", 1.0, 0.05);
        still.frame().unwrap();
        let mut world = hanging(cube(3), "backward_euler", h, 0.05);
        let start = apart(&world, &still);
        (0..100).for_each(|_| world.frame().unwrap());
        let left = apart(&world, &still);
        assert!(left < 1e-6 * start, "h = {h}: {left} of {start}");
    }
    for (h, rule) in [(1e-3, "newmark"), (1e-5, "newmark"), (1e-5, "backward_euler")] {
        let (mut implicit, mut explicit) = (hanging(cube(3), rule, h, 0.0), hanging(cube(3), "verlet", h, 0.0));
        let rest = hanging(cube(3), rule, h, 0.0);
        (0..100).for_each(|_| {
            implicit.frame().unwrap();
            explicit.frame().unwrap();
        });
        let (way, left) = (apart(&rest, &explicit), apart(&implicit, &explicit));
        assert!(left < 0.02 * way, "{rule}, h = {h}: {left} of {way}");
    }
}

/// Layers of cells that are a thousand times wider than high, in a hanging bar without lateral contraction. Each layer follows the closed form, u(x)
/// = ρ g (L x − x²/2)/E.
#[test]
fn layers_of_slivers_hang_where_the_closed_form_says() {
    let (modulus, weight) = (1e6, 1000.0 * 9.81);
    let mut mesh = Mesh::grid([0.0; 3], [1.0; 3], [4, 2, 2]).unwrap().into_simplices().unwrap();
    for x in &mut mesh.positions {
        // Two layers of 0.5 mm about the middle.
        x[0] = if x[0] == 0.25 {
            0.4995
        } else if x[0] == 0.75 {
            0.5005
        } else {
            x[0]
        };
    }
    for rule in ["equilibrium", "backward_euler"] {
        let mut blueprint = solid(
            mesh.clone(),
            rule,
            &[],
            &[
                ("material", text("linear")),
                ("youngs_modulus", Value::Number(modulus)),
                ("poissons_ratio", Value::Number(0.0)),
            ],
        );
        blueprint.time.frame = 1.0;
        blueprint.surroundings.gravity = [9.81, 0.0, 0.0];
        blueprint.bodies[0].pins = clamp();
        let mut bar = World::new(blueprint, Options::default()).unwrap();
        (0..if rule == "equilibrium" { 1 } else { 60 }).for_each(|_| bar.frame().unwrap());
        for layer in [0.4995, 0.5, 0.5005, 1.0] {
            let (mut sum, mut count) = (0.0, 0.0);
            for (node, x) in mesh.positions.iter().enumerate().filter(|(_, x)| x[0] == layer) {
                sum += bar.position(0, node as u32)[0] - x[0];
                count += 1.0;
            }
            let wanted = weight / modulus * (layer - 0.5 * layer * layer);
            assert!((sum / count / wanted - 1.0).abs() < 0.02, "{rule}, {layer}: {} {wanted}", sum / count);
        }
    }
}

/// Boxes also return from shapes in which their mean deformation does not depend on their corners.
#[test]
fn boxes_come_back_from_shapes_that_no_body_has() {
    boxes_come_back(&MATERIALS[..1]);
}

#[test]
#[ignore = "a sweep: cargo test -- --ignored whole_sweep"]
fn boxes_come_back_from_shapes_that_no_body_has_whole_sweep() {
    boxes_come_back(&MATERIALS[1..]);
}

fn boxes_come_back(materials: &[&str]) {
    for material in materials {
        let back = |name: &str, n: u32, shape: &dyn Fn([f64; 3], usize) -> [f64; 3]| {
            let mesh = Mesh::grid([0.0; 3], [1.0; 3], [n; 3]).unwrap();
            // Boxes have the volume of the tetrahedra into which they could be cut.
            let cut = mesh.clone().into_simplices().unwrap();
            let name = format!("boxes of {material}, {name}");
            let boxes = body(mesh, material, 1.0 / 30.0, Vec::new());
            let end = end(boxes, &name, shape, &|world| volumes(world, &cut));
            assert!(!matches!(end, End::Silent(..)), "{name}: {end:?}");
        };
        back("plane", 3, &|x, _| [x[0], 0.0, x[2]]);
        back("stretched tenfold", 3, &|x, _| [10.0 * x[0], x[1], x[2]]);
        back("twisted three times", 4, &|x, _| {
            let angle = 6.0 * core::f64::consts::PI * x[0];
            let (c, s) = (libm::cos(angle), libm::sin(angle));
            let (y, z) = (x[1] - 0.5, x[2] - 0.5);
            [x[0], c * y - s * z, s * y + c * z]
        });
        // Corners displaced alternately: every amplitude to which the mean deformation is insensitive.
        back("crumpled", 3, &|x, node| core::array::from_fn(|d| x[d] + 0.12 * random(node, d)));
    }
}

/// A bent body comes to rest with steps of any length.
#[test]
fn steps_from_ten_microseconds_to_two_seconds_are_made() {
    let mesh = cube(3);
    for material in MATERIALS {
        for h in [1e-5, 1e-3, 0.1, 2.0] {
            let mut world = World::new(body(mesh.clone(), material, h, clamp()), Options::default()).unwrap();
            for (node, x) in mesh.positions.iter().enumerate() {
                world.set_node(0, node as u32, [x[0], x[1] + 0.3 * x[0] * x[0], x[2]], [0.0; 3]).unwrap();
            }
            for _ in 0..40 {
                world.frame().unwrap_or_else(|error| panic!("{material}, h = {h}: {error}"));
            }
            let (whole, least) = volumes(&world, &mesh);
            assert!(least > 0.2 && (whole - 1.0).abs() < 0.2, "{material}, h = {h}: {whole} {least}");
            if h > 0.05 {
                assert!((whole - 1.0).abs() < 1e-3, "{material}, h = {h}: {whole}");
            }
        }
    }
}

/// Slivers of aspect ratio 1000, and a body far from the origin, return to their shape as the original body does.
#[test]
fn slivers_and_distance_leave_the_answer() {
    let run = |scale: f64, far: f64| {
        let mut mesh = Mesh::grid([0.0; 3], [1.0, scale, 1.0], [3, 3, 3]).unwrap().into_simplices().unwrap();
        mesh.translate([far, far, far]);
        let mut world =
            World::new(body(mesh.clone(), "stable_neo_hookean", 1.0 / 30.0, Vec::new()), Options::default()).unwrap();
        for (node, x) in mesh.positions.iter().enumerate() {
            let at = [far + 1.2 * (x[0] - far), x[1], far + 0.9 * (x[2] - far)];
            world.set_node(0, node as u32, at, [0.0; 3]).unwrap();
        }
        for _ in 0..60 {
            world.frame().unwrap_or_else(|error| panic!("{scale}, {far}: {error}"));
        }
        volumes(&world, &mesh).0
    };
    for (scale, far, tolerance) in [(1.0, 0.0, 1e-4), (1e-3, 0.0, 1e-3), (1.0, 1e6, 1e-4)] {
        let whole = run(scale, far);
        assert!((whole - 1.0).abs() < tolerance, "{scale}, {far}: {whole}");
    }
}
