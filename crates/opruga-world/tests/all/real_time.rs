//! The real-time setting of implicit integrators: its difference from the exact setting, its independence of threads and interruptions, and (`--
//! --ignored --nocapture`) its computing time.

use crate::common;
use opruga_math::message::Message;

use common::{clamp, solid, text};
use opruga_core::spec::Value;
use opruga_math::Lane;
use opruga_math::words::number;
use opruga_mesh::{Cut, Mesh};
use opruga_world::blueprint::Blueprint;
use opruga_world::{Options, Registry, World};
use std::time::Instant;

/// A body of one material that is clamped at x = 0 and released.
fn clamped(mesh: Mesh<3>, rule: &str, accuracy: &str, modulus: f64, more: &[(&str, Value)]) -> Blueprint<3> {
    let mut material = vec![("youngs_modulus", Value::Number(modulus)), ("poissons_ratio", Value::Number(0.4))];
    material.push(("material", text("corotated")));
    material.extend_from_slice(more);
    let of_rule: &[(&str, Value)] =
        if rule == "equilibrium" || accuracy.is_empty() { &[] } else { &[("accuracy", text(accuracy))] };
    let mut blueprint = solid(mesh, rule, of_rule, &material);
    blueprint.surroundings.gravity = [0.0, -9.81, 0.0];
    blueprint.bodies[0].pins = clamp();
    blueprint
}

fn cube(n: u32) -> Mesh<3> {
    Mesh::grid([0.0; 3], [1.0; 3], [n; 3]).unwrap().into_simplices_by(Cut::Five).unwrap()
}

fn world(blueprint: Blueprint<3>, threads: usize) -> World<3> {
    World::new(blueprint, Options { threads, ..Options::default() }).expect("a world")
}

/// Mean height of the nodes that are farthest from the clamp at rest, minus their height at rest.
fn tip(world: &World<3>, at_rest: &[[f64; 3]]) -> f64 {
    let far = at_rest.iter().map(|p| p[0]).fold(0.0, Lane::larger);
    let nodes: Vec<usize> = (0..at_rest.len()).filter(|n| at_rest[*n][0] > far - 1e-9).collect();
    nodes.iter().map(|n| world.position(0, *n as u32)[1] - at_rest[*n][1]).sum::<f64>() / nodes.len() as f64
}

/// The height of the tip after every frame.
fn swing(mut world: World<3>, mesh: &Mesh<3>, frames: usize) -> (Vec<f64>, World<3>) {
    let path = (0..frames)
        .map(|_| {
            world.frame().unwrap();
            tip(&world, &mesh.positions)
        })
        .collect();
    (path, world)
}

/// The lowest point of the first oscillation, and the time between it and the next one, from parabolas [frames].
fn amplitude_and_period(path: &[f64]) -> (f64, f64) {
    let mut lows = (1..path.len() - 1).filter(|k| path[*k] < path[k - 1] && path[*k] <= path[k + 1]).map(|k| {
        let (a, b, c) = (path[k - 1], path[k], path[k + 1]);
        let offset = 0.5 * (a - c) / (a - 2.0 * b + c);
        (b - 0.25 * (a - c) * offset, k as f64 + offset)
    });
    let (first, second) = (lows.next().expect("a swing"), lows.next().expect("a second swing"));
    (first.0, second.1 - first.1)
}

/// The amplitude of the first oscillation is within 3 % and the period within 1 % of exact steps. At rest the position is within 1 % of the static
/// solution on the same mesh, with a small mean number of iterations: for a soft cube, which bends by a quarter of its length, and for a stiff one.
#[test]
fn a_clamped_cube_swings_and_rests_as_with_exact_steps() {
    let mesh = cube(4);
    for (modulus, frames) in [(1e6, 60), (1e5, 150)] {
        let run = |accuracy: &str| {
            let blueprint = clamped(mesh.clone(), "backward_euler", accuracy, modulus, &[]);
            swing(world(blueprint, 1), &mesh, frames)
        };
        let ((exact, _), (quick, mut world_at_rest)) = (run("exact"), run("real_time"));
        let (a, b) = (amplitude_and_period(&quick), amplitude_and_period(&exact));
        assert!((a.0 / b.0 - 1.0).abs() < 0.03 && (a.1 / b.1 - 1.0).abs() < 0.01, "E = {modulus}: {a:?} {b:?}");
        // Backward Euler needs a long time to damp the soft cube.
        for _ in 0..1500 {
            world_at_rest.frame().unwrap();
        }
        let work = world_at_rest.solver_work();
        let statics = clamped(mesh.clone(), "equilibrium", "", modulus, &[]);
        let (wanted, _) = swing(world(statics, 1), &mesh, 1);
        let found = tip(&world_at_rest, &mesh.positions);
        assert!((found / wanted[0] - 1.0).abs() < 0.01, "E = {modulus}: {found} {}", wanted[0]);
        assert!(work.iterations < 2 * work.steps, "{work:?}");
    }
}

/// A snapshot contains the stored matrix and the velocity before the last step.
#[test]
fn neither_threads_nor_interruptions_nor_instructions_leave_a_trace() {
    let mesh = cube(10);
    for rule in ["backward_euler", "bdf2"] {
        let blueprint = || clamped(mesh.clone(), rule, "real_time", 1e5, &[]);
        let mut whole = world(blueprint(), 1);
        let mut snapshot = None;
        for frame in 0..14 {
            if frame == 7 {
                snapshot = Some(whole.snapshot());
            }
            whole.frame().unwrap();
        }
        for threads in [1, 2, 3, 8] {
            let mut other = world(blueprint(), threads);
            other.restore(snapshot.as_ref().unwrap()).unwrap();
            (0..7).for_each(|_| other.frame().unwrap());
            assert_eq!(other.state_hash(), whole.state_hash(), "{rule}, {threads} threads");
        }
        assert!(whole.same_bits_everywhere());
        for simd in opruga_math::Simd::available() {
            let options = Options { simd: Some(simd), threads: 2, ..Options::default() };
            let mut other = World::new(blueprint(), options).unwrap();
            (0..14).for_each(|_| other.frame().unwrap());
            assert_eq!(other.state_hash(), whole.state_hash(), "{rule}, {simd:?}");
        }
    }
}

/// Threads share the forces of one solid, in explicit and exact steps too, with several parts and damping.
#[test]
fn one_large_solid_has_the_same_bits_on_any_number_of_threads() {
    let quadratic = Mesh::grid([0.0; 3], [1.0; 3], [5; 3]).unwrap().into_simplices().unwrap().into_quadratic().unwrap();
    let boxes = Mesh::grid([0.0; 3], [1.0; 3], [10; 3]).unwrap();
    for (mesh, rule, accuracy, frames) in [
        (cube(10), "symplectic_euler", "", 6),
        (boxes, "verlet", "", 6),
        (quadratic, "backward_euler", "exact", 1),
        (cube(10), "newmark", "exact", 1),
        // With nodal volumes.
        (cube(10), "verlet", "nodal_volume", 6),
    ] {
        assert!(mesh.nodes() >= 1000, "{} nodes are not shared", mesh.nodes());
        let nodal = accuracy == "nodal_volume";
        let mut more = vec![("damping", Value::Number(1e-3)), ("material", text("fixed_corotated"))];
        if nodal {
            more.extend([("locking", text(accuracy)), ("poissons_ratio", Value::Number(0.47))]);
        }
        let mut blueprint = clamped(mesh, rule, if nodal { "" } else { accuracy }, 1e4, &more);
        let spec = Registry::<3>::default().integrator(rule).expect("an integrator").spec();
        if accuracy.is_empty() || nodal {
            blueprint.time.substeps = 40;
        } else {
            blueprint.integrator.set(spec, "linear_solver", text("conjugate_gradients"), 3).expect("a field");
        }
        let run = |threads: usize| {
            let mut world = world(blueprint.clone(), threads);
            (0..frames).for_each(|_| world.frame().unwrap());
            let ledger = world.energy();
            (world.state_hash(), [ledger.kinetic, ledger.elastic, ledger.loss_damping].map(f64::to_bits))
        };
        let alone = run(1);
        for threads in [2, 3, 8] {
            assert_eq!(run(threads), alone, "{rule}, {threads} threads");
        }
    }
}

/// A small stiff body uses the sparse factor, and keeps it.
#[test]
fn a_stiff_beam_of_quadratic_tetrahedra_hangs_as_its_statics_say() {
    let mesh = Mesh::grid([0.0; 3], [1.0, 0.1, 0.1], [8, 1, 1]).unwrap();
    let mesh = mesh.into_simplices().unwrap().into_quadratic().unwrap();
    let run = |rule: &str, frames: usize| {
        let blueprint = clamped(mesh.clone(), rule, "real_time", 1e8, &[("poissons_ratio", Value::Number(0.3))]);
        swing(world(blueprint, 1), &mesh, frames)
    };
    let ((wanted, _), (path, beam)) = (run("equilibrium", 1), run("backward_euler", 200));
    let work = beam.solver_work();
    println!("{} nodes, statics {wanted:?}, at rest {}, {work:?}", mesh.positions.len(), path[199]);
    assert!((path[199] / wanted[0] - 1.0).abs() < 1e-3, "{} {wanted:?}", path[199]);
    assert!(work.iterations < 2 * work.steps, "{work:?}");
}

/// The equations of this beam need more products than those of a cube. When their solution was cut off too early, the beam gained energy without
/// limit.
#[test]
fn a_slender_beam_of_many_cells_hangs_as_deep_as_the_published_one() {
    let mesh = Mesh::grid([0.0; 3], [1.0, 0.1, 0.1], [20, 2, 2]).unwrap();
    let mesh = mesh.into_simplices().unwrap().into_quadratic().unwrap();
    let more = [("poissons_ratio", Value::Number(0.3)), ("material", text("st_venant_kirchhoff"))];
    let mut beam = world(clamped(mesh.clone(), "backward_euler", "real_time", 1e8, &more), 1);
    for _ in 0..120 {
        beam.frame().unwrap();
    }
    let sunk = -tip(&beam, &mesh.positions);
    assert!((sunk / 0.014_686 - 1.0).abs() < 0.01, "{sunk}");
}

/// Slender beams of quadratic tetrahedra: their first oscillation matches exact steps, they stay in their plane and come to rest at the static
/// solution, and no budget is used up before that.
#[test]
fn slender_beams_swing_and_rest_as_with_exact_steps() {
    slender_beams(&[[14, 2, 1]]);
}

#[test]
#[ignore = "a sweep: cargo test -- --ignored whole_sweep"]
fn slender_beams_swing_and_rest_as_with_exact_steps_whole_sweep() {
    slender_beams(&[[16, 2, 2], [32, 2, 2]]);
}

fn slender_beams(beams: &[[u32; 3]]) {
    for &cells in beams {
        let mesh = Mesh::grid([0.0; 3], [1.0, 0.1, 0.1], cells).unwrap();
        let mesh = mesh.into_simplices().unwrap().into_quadratic().unwrap();
        let last = mesh.positions.len() as u32 - 1;
        let beam = |rule: &str, accuracy: &str, damping: f64| {
            let more = [
                ("poissons_ratio", Value::Number(0.3)),
                ("material", text("st_venant_kirchhoff")),
                ("damping", Value::Number(damping)),
            ];
            world(clamped(mesh.clone(), rule, accuracy, 1e8, &more), 1)
        };
        let ((quick, world_after), (exact, _)) = (
            swing(beam("backward_euler", "real_time", 0.0), &mesh, 12),
            swing(beam("backward_euler", "exact", 0.0), &mesh, 12),
        );
        let lowest = |path: &[f64]| path.iter().copied().fold(0.0, Lane::smaller);
        let (a, b) = (lowest(&quick), lowest(&exact));
        assert!((a / b - 1.0).abs() < 0.03, "{cells:?}: {a} {b}");
        let work = world_after.solver_work();
        println!("{cells:?}, {} nodes: {a} {b}, {work:?}", last + 1);
        assert_eq!(work.cut_off, 0, "{cells:?}: {work:?}");
        let sideways = (0..=last).map(|n| {
            let shift = world_after.position(0, n)[2] - mesh.positions[n as usize][2];
            shift.abs()
        });
        let of_statics = {
            let mut still = beam("equilibrium", "", 0.0);
            still.frame().unwrap();
            still
        };
        // The tetrahedra of one cut are not quite symmetric, so statics also moves them out of the plane.
        let natural = (0..=last).map(|n| (of_statics.position(0, n)[2] - mesh.positions[n as usize][2]).abs());
        let (sideways, natural) = (sideways.fold(0.0, Lane::larger), natural.fold(0.0, Lane::larger));
        assert!(sideways < 3.0 * natural + 1e-5, "{cells:?}: {sideways} {natural}");
        if cells[0] == 16 {
            let (path, _) = swing(beam("backward_euler", "real_time", 0.01), &mesh, 300);
            let wanted = tip(&of_statics, &mesh.positions);
            assert!((path[299] / wanted - 1.0).abs() < 1e-3, "{} {wanted}", path[299]);
            assert!((path[299] - path[250]).abs() < 1e-3 * wanted.abs(), "{} {}", path[299], path[250]);
        }
    }
}

/// A slender beam whose matrix is not factored needs many products and has an error in bending, which is reported.
#[test]
fn steps_that_may_be_worse_than_promised_are_counted_with_what_is_left() {
    let mesh = Mesh::grid([0.0; 3], [1.0, 0.1, 0.1], [16, 2, 2]).unwrap();
    let mesh = mesh.into_simplices().unwrap().into_quadratic().unwrap();
    let mut blueprint = clamped(mesh, "backward_euler", "real_time", 1e8, &[("poissons_ratio", Value::Number(0.3))]);
    let spec = Registry::<3>::default().integrator("backward_euler").expect("an integrator").spec();
    blueprint.integrator.set(spec, "linear_solver", text("conjugate_gradients"), 3).expect("a field");
    let mut beam = world(blueprint, 1);
    (0..20).for_each(|_| beam.frame().unwrap());
    let work = beam.solver_work();
    assert!(work.cut_off > 0 && work.cut_off <= work.steps && work.left > 0.0 && work.left < 0.1, "{work:?}");
    let warning = beam.warnings().into_iter().find(|warning| warning.code == "step.cut_off").expect("a warning");
    assert_eq!(warning.count, work.cut_off);
    assert!(warning.message.contains(&format!("{} m", number(work.left))), "{warning:?}");
}

/// A clamped bar under a sudden weight: the more the bar bends, the larger the residual after one iteration. With the smaller weights it is 8 %
/// (backward Euler) and 2 % (BDF2), with the larger ones 32 % and 10 %.
#[test]
fn a_step_that_leaves_more_out_of_balance_than_its_rule_promises_is_counted() {
    let counted = |rule: &str, iterations: i64, weight: f64| {
        let mesh = Mesh::<2>::grid([0.0; 2], [1.0, 0.1], [8, 2]).unwrap();
        let material = [("youngs_modulus", Value::Number(1e6)), ("material", text("corotated"))];
        let of_rule = [("accuracy", text("real_time")), ("iterations", Value::Integer(iterations))];
        let mut bar = solid(mesh, rule, &of_rule, &material);
        bar.surroundings.gravity = [0.0, -weight];
        bar.bodies[0].pins = clamp();
        let mut bar = World::new(bar, Options::default()).unwrap();
        bar.frame().unwrap();
        let (work, warnings) = (bar.solver_work(), bar.warnings());
        assert_eq!((work.steps, work.halved), (1, 0), "{rule}, {weight}: one step");
        assert_eq!(warnings.iter().any(|warning| warning.code == "step.cut_off"), work.cut_off > 0, "{warnings:?}");
        work.cut_off
    };
    for (rule, little, much) in [("backward_euler", 10.0, 40.0), ("bdf2", 2.5, 12.5)] {
        assert_eq!(counted(rule, 1, little), 0, "{rule}");
        assert_eq!(counted(rule, 1, much), 1, "{rule}");
        assert_eq!(counted(rule, 3, much), 0, "{rule}: three iterations");
    }
}

fn cpu() -> f64 {
    // The time of this thread: nanoseconds on a processor, the first number of schedstat.
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    text.split(' ').next().and_then(|n| n.parse::<f64>().ok()).unwrap_or(0.0) * 1e-9
}

#[test]
#[ignore = "a measurement"]
fn time_and_error_of_the_clamped_cube() {
    let sizes = std::env::var("CUBES").unwrap_or("10".into());
    let threads = std::env::var("THREADS").ok().and_then(|t| t.parse().ok()).unwrap_or(1);
    for n in sizes.split(',').map(|n| n.parse::<u32>().unwrap()) {
        let mesh = cube(n);
        for modulus in [1e6, 1e5] {
            let frames = if modulus > 5e5 { 60 } else { 150 };
            let mut quick = world(clamped(mesh.clone(), "backward_euler", "real_time", modulus, &[]), threads);
            let mut path = Vec::new();
            let mut spent = Vec::new();
            for _ in 0..frames {
                let (start, wall) = (cpu(), Instant::now());
                quick.frame().unwrap();
                spent.push(if threads > 1 { wall.elapsed().as_secs_f64() } else { cpu() - start } * 1e3);
                path.push(tip(&quick, &mesh.positions));
            }
            let work = quick.solver_work();
            println!(
                "n = {n}, E = {modulus:e}, {threads} threads: mean {:.2} ms, of frames 5 to 30 {:.2} ms, slowest {:.2} ms; {:.2} \
                 iterations and {:.1} products a step; energy {:.1e}",
                spent.iter().sum::<f64>() / frames as f64,
                spent[5..30].iter().sum::<f64>() / 25.0,
                spent.iter().copied().fold(0.0, Lane::larger),
                work.iterations as f64 / work.steps as f64,
                work.linear_iterations as f64 / work.steps as f64,
                quick.energy().closure,
            );
            if std::env::var("EXACT").is_ok() {
                let (exact, _) =
                    swing(world(clamped(mesh.clone(), "backward_euler", "exact", modulus, &[]), 1), &mesh, frames);
                let (a, b) = (amplitude_and_period(&path), amplitude_and_period(&exact));
                let (at_rest, _) = swing(world(clamped(mesh.clone(), "equilibrium", "", modulus, &[]), 1), &mesh, 1);
                for _ in 0..1500 {
                    quick.frame().unwrap();
                }
                println!(
                    "    amplitude {:+.2} %, period {:+.2} % of {:?}; at rest {:+.3} % of {}",
                    100.0 * (a.0 / b.0 - 1.0),
                    100.0 * (a.1 / b.1 - 1.0),
                    b,
                    100.0 * (tip(&quick, &mesh.positions) / at_rest[0] - 1.0),
                    at_rest[0]
                );
            }
        }
    }
}

#[test]
#[ignore = "a measurement"]
fn time_and_error_of_the_clamped_beam() {
    for cells in [[8, 1, 1], [12, 1, 1], [16, 1, 1], [20, 2, 2]] {
        let mesh = Mesh::grid([0.0; 3], [1.0, 0.1, 0.1], cells).unwrap();
        let mesh = mesh.into_simplices().unwrap().into_quadratic().unwrap();
        for (modulus, truth) in [(1e8, 0.014_686), (1e6, 0.747)] {
            let more = [("poissons_ratio", Value::Number(0.3)), ("material", text("st_venant_kirchhoff"))];
            let mut beam = world(clamped(mesh.clone(), "backward_euler", "real_time", modulus, &more), 1);
            let start = cpu();
            for _ in 0..300 {
                beam.frame().unwrap();
            }
            let (spent, work) = ((cpu() - start) / 300.0 * 1e3, beam.solver_work());
            let tip = -tip(&beam, &mesh.positions);
            println!(
                "{cells:?}, {} nodes, E = {modulus:e}: {spent:.3} ms a step, {:.2} iterations; tip {tip:.6}, {:+.2} %",
                mesh.positions.len(),
                work.iterations as f64 / work.steps as f64,
                100.0 * (tip / truth - 1.0)
            );
        }
    }
}

/// The setting makes steps of an integrator cheaper without replacing it by another; integrators without dissipation refuse it.
#[test]
fn real_time_steps_are_those_of_their_rule() {
    let tip = |rule: &str, accuracy: &str| {
        let mut world = world(clamped(cube(4), rule, accuracy, 1e5, &[]), 1);
        (0..90).for_each(|_| world.frame().unwrap());
        let last = world.node_count(0) as u32 - 1;
        world.position(0, last)[1]
    };
    let [euler, exact, quick] = [("backward_euler", "exact"), ("bdf2", "exact"), ("bdf2", "real_time")]
        .map(|(rule, accuracy)| tip(rule, accuracy));
    assert!((quick - exact).abs() < 0.05 * (euler - exact).abs(), "{euler} {exact} {quick}");
    for rule in ["implicit_midpoint", "newmark"] {
        let refused = World::new(clamped(cube(4), rule, "real_time", 1e5, &[]), Options::default());
        let said = refused.expect_err("it damps nothing").in_full();
        assert!(said.contains("damps nothing") && said.contains("`backward_euler` and `bdf2`"), "{said}");
    }
}
