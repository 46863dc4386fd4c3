//! Implicit integrators and statics on whole scenes: rest, sliding, impact, sag, catenary, snapshots, errors.
#![allow(clippy::disallowed_methods)] // expected values of the tests' own

use crate::common;
use opruga::math::message::Message;

use common::{built, frames, head, plane, refused, space};
use opruga::World;

/// The integrators that step through time.
const RULES: [&str; 4] = ["backward_euler", "bdf2", "implicit_midpoint", "newmark"];

/// A stiff block of springs on y = 0: hω is about 30 at a step of 1/60 s, five times the limit of explicit integrators.
const BLOCK: &str = "[[body]]\nname = \"block\"\nshape = { kind = \"grid\", size = [0.4, 0.2], cells = [4, 2] }\n\
    mass = 2.0\nmodels = [ { kind = \"mass_spring\", stiffness = 2e5, damping = 20.0, edges = \"shear\" } ]\n";

/// A floor at some height with a coefficient of friction.
fn floor(height: f64, friction: f64, restitution: f64) -> String {
    format!(
        "[[collider]]\nkind = \"half_space\"\npoint = [0.0, {height:?}]\nnormal = [0.0, 1.0]\nfriction = {friction:?}\n\
         restitution = {restitution:?}\n"
    )
}

fn nodes(world: &World<2>) -> Vec<[f64; 2]> {
    (0..world.node_count(0) as u32).map(|n| world.position(0, n)).collect()
}

fn mean(world: &World<2>, of: impl Fn(u32) -> f64) -> f64 {
    let count = world.node_count(0) as u32;
    (0..count).map(of).sum::<f64>() / f64::from(count)
}

#[test]
fn a_stiff_block_falls_comes_to_rest_and_stays() {
    for rule in RULES {
        let mut world = built(plane(&(head(1.0 / 60.0, 1, -9.81, rule) + BLOCK + &floor(-0.05, 0.4, 0.0))));
        for frame in 0..240 {
            frames(&mut world, 1);
            let lowest = nodes(&world).iter().map(|x| x[1]).fold(f64::INFINITY, f64::min);
            assert!(lowest > -0.05 - 1e-8, "{rule}, frame {frame}: {lowest}");
        }
        let before = nodes(&world);
        frames(&mut world, 60);
        for (x, now) in before.iter().zip(nodes(&world)) {
            assert!((now[0] - x[0]).abs() + (now[1] - x[1]).abs() < 1e-7, "{rule}: {x:?} {now:?}");
        }
        let energy = world.energy();
        // The whole potential energy was dissipated by the impact, the damping of the springs and the numerical damping.
        assert!(energy.kinetic < 1e-4 && energy.loss_contact > 0.1, "{rule}: {energy:?}");
        assert!(energy.work_correction.abs() < 1e-9 && energy.work_user.abs() < 1e-9, "{rule}: {energy:?}");
        let solver = world.solver_work();
        assert!(solver.steps == 300 && solver.iterations < 6 * 300, "{rule}: {solver:?}");
    }
}

/// Places a block on an incline with tan θ = ½ (gravity is tilted, not the floor), made of springs with this damping, with this number of steps per
/// frame. Returns the displacement, the speed, and the increase of the speed in the last two seconds, all after 2.5 s.
fn on_the_incline(rule: &str, substeps: u32, damping: f64, friction: f64) -> ([f64; 3], opruga::Energy) {
    let size = 1.25f64.sqrt();
    let (along, across) = (9.81 * 0.5 / size, -9.81 / size);
    let head = head(1.0 / 60.0, substeps, 0.0, rule)
        .replace("gravity = [0, 0.0]", &format!("gravity = [{along:?}, {across:?}]"));
    let block = BLOCK.replace("damping = 20.0", &format!("damping = {damping:?}"));
    let mut world = built(plane(&(head + &block + &floor(0.0, friction, 0.0))));
    let speed = |world: &World<2>| world.momentum().linear.0[0] / 2.0;
    frames(&mut world, 30);
    let early = speed(&world);
    frames(&mut world, 120);
    let now = speed(&world);
    ([mean(&world, |n| world.position(0, n)[0]) - 0.2, now, now - early], world.energy())
}

/// With µ = 0.49 the block accelerates at .0877433 m/s² (validation B5), with one step per frame and with many. An elastic block slips a little
/// farther while it settles under its weight, with every integrator as far as with Verlet's in tiny steps. With µ = 0.52 it stays where it is.
#[test]
fn a_block_on_an_incline_sticks_or_slides_by_coulombs_law() {
    let across = 9.81 / 1.25f64.sqrt();
    let ([true_way, ..], _) = on_the_incline("verlet", 512, 300.0, 0.49);
    assert!((true_way / 0.274_198 - 1.0).abs() < 0.02, "{true_way}");
    for rule in RULES {
        // A rod of two nodes reproduces the limit exactly, with every integrator.
        let rod = "[[body]]\nname = \"rod\"\nshape = { kind = \"line\", from = [0.0, 0.0], to = [0.4, 0.0], segments = 1 }\n\
            mass = 2.0\nmodels = [ { kind = \"mass_spring\", stiffness = 2e5 } ]\n";
        let head = head(1.0 / 60.0, 1, 0.0, rule)
            .replace("gravity = [0, 0.0]", &format!("gravity = [{:?}, {:?}]", 0.5 * across, -across));
        let mut world = built(plane(&(head + rod + &floor(0.0, 0.5, 0.0))));
        frames(&mut world, 600);
        assert!(world.position(0, 0)[0].abs() < 1e-4, "{rule}: {:?}", world.position(0, 0));
        let ([way, speed, _], energy) = on_the_incline(rule, 1, 20.0, 0.49);
        println!("{rule}: {way:.6} m, {speed:.6} m/s with little damping");
        assert!((way / 0.274_198 - 1.0).abs() < 1e-2, "{rule}: {way} {speed}");
        assert!((speed / 0.219_358 - 1.0).abs() < 3e-3, "{rule}: {way} {speed}");
        // Friction dissipates µ N s of the lost potential energy.
        let rubbed = 0.49 * 2.0 * across * way;
        assert!((energy.loss_friction / rubbed - 1.0).abs() < 2e-2, "{rule}: {} {rubbed}", energy.loss_friction);
        let ([way, speed, _], energy) = on_the_incline(rule, 1, 20.0, 0.52);
        assert!(way.abs() < 1e-3 && speed.abs() < 1e-4, "{rule}: {way} {speed}");
        assert!(energy.loss_friction.abs() < 1e-2, "{rule}: {energy:?}");
        for substeps in [1, 4, 16, 64] {
            let ([way, speed, gained], energy) = on_the_incline(rule, substeps, 300.0, 0.49);
            println!("{rule}, {substeps} steps: {way:.6} m, {speed:.6} m/s, gained {gained:.6} m/s");
            assert!((gained / 0.175_487 - 1.0).abs() < 1e-3, "{rule}, {substeps} steps: {way} {speed} {gained}");
            assert!((way / 0.274_198 - 1.0).abs() < 0.02, "{rule}, {substeps} steps: {way} {speed}");
            if substeps >= 16 {
                assert!((way / true_way - 1.0).abs() < 1e-2, "{rule}, {substeps} steps: {way} {true_way}");
            }
            // Friction dissipates µ N s of the lost potential energy.
            let rubbed = 0.49 * 2.0 * across * way;
            let lost = energy.loss_friction;
            assert!((lost / rubbed - 1.0).abs() < 2e-2, "{rule}, {substeps} steps: {lost} {rubbed}");
            if substeps == 4 || substeps == 64 {
                continue;
            }
            // A soft body creeps a little while it settles under its weight; then it stays.
            let ([way, speed, _], energy) = on_the_incline(rule, substeps, 300.0, 0.52);
            assert!(way.abs() < 1e-4 && speed.abs() < 1e-6, "{rule}, {substeps} steps: {way} {speed}");
            assert!(energy.loss_friction.abs() < 1e-3, "{rule}, {substeps} steps: {energy:?}");
        }
    }
}

/// While all nodes slide in the same direction, friction removes µ times the normal impulse of the floor, even for a block that hops and vibrates:
/// mΔv = −µ (m g T + mΔw), with w upwards.
#[test]
fn friction_takes_its_share_of_every_impact() {
    let block = BLOCK.replace("mass = 2.0", "mass = 2.0\nvelocity = [5.0, 0.0]");
    for rule in RULES {
        for substeps in [1, 4, 16, 64] {
            let text = head(1.0 / 60.0, substeps, -9.81, rule) + &block + &floor(-0.01, 0.3, 0.0);
            let mut world = built(plane(&text));
            frames(&mut world, 60);
            let [along, up] = world.momentum().linear.0.map(|p| p / 2.0);
            let missing = along - 5.0 + 0.3 * (9.81 + up);
            println!("{rule}, {substeps} steps: {along} m/s, {missing:e}");
            assert!(missing.abs() < 1e-6, "{rule}, {substeps} steps: {along} {up} {missing:e}");
            let energy = world.energy();
            assert!(energy.closure < 0.02, "{rule}, {substeps} steps: {energy:?}");
        }
    }
}

/// Half of the speed returns, once for each impact; the rest of the energy is in the ledger.
#[test]
fn a_bounce_returns_what_the_restitution_says() {
    for rule in RULES {
        let bar = "[[body]]\nname = \"bar\"\nshape = { kind = \"line\", from = [0.0, 0.5], to = [1.0, 0.5], segments = 4 }\n\
            mass = 1.0\nvelocity = [0.0, -3.0]\nmodels = [ { kind = \"mass_spring\", stiffness = 500.0 } ]\n";
        let mut world = built(plane(&(head(0.01, 1, 0.0, rule) + bar + &floor(0.0, 0.0, 0.5))));
        frames(&mut world, 30);
        let speed = mean(&world, |n| world.velocity(0, n)[1]);
        assert!((speed - 1.5).abs() < 1e-9, "{rule}: {speed}");
        let lost = 0.5 * (9.0 - 1.5 * 1.5);
        assert!((world.energy().loss_contact - lost).abs() < 0.02 * lost, "{rule}: {:?}", world.energy());
    }
}

/// A weight on a spring hangs m g/k lower, for every step from 1e-5 s to 2 s (validation B7).
#[test]
fn the_sag_does_not_depend_on_the_step() {
    for rule in RULES {
        for (h, steps) in [(1e-5, 100_000u64), (1e-3, 1000), (0.1, 200), (2.0, 60)] {
            let text = head(h * 100.0, 100, -9.81, rule)
                + "[[body]]\nname = \"weight\"\nshape = { kind = \"line\", from = [0.0, 0.0], to = [0.0, -1.0], segments = 1 }\n\
                   node_mass = 1.0\nmodels = [ { kind = \"mass_spring\", stiffness = 1000.0, damping = 60.0 } ]\n\
                   pin = [ { select = { node = 0 }, axes = \"xy\" } ]\n";
            let mut world = built(plane(&text));
            frames(&mut world, steps.div_ceil(100));
            let sag = -1.0 - world.position(0, 1)[1];
            assert!((sag / 0.009_81 - 1.0).abs() < 0.01, "{rule}, h = {h}: {sag}");
        }
    }
}

/// Span 1, length 2: the sag of the catenary is .796388 (validation B4).
#[test]
fn a_hanging_chain_is_a_catenary() {
    let links = 100;
    let height = 0.75f64.sqrt();
    let points: Vec<[f64; 2]> = (0..=links)
        .map(|k| {
            let s = f64::from(k) / f64::from(links);
            let depth = if s < 0.5 { 2.0 * s } else { 2.0 - 2.0 * s };
            [s, -height * depth]
        })
        .collect();
    for solver in ["conjugate_gradients", "cholesky"] {
        let text = head(0.1, 1, -9.81, "equilibrium")
            .replace("kind = \"equilibrium\"\n", &format!("kind = \"equilibrium\"\nlinear_solver = \"{solver}\"\n"))
            + &format!(
                "[[body]]\nname = \"chain\"\nshape = {{ kind = \"polyline\", points = {points:?} }}\nmass = 1.0\n\
                 models = [ {{ kind = \"mass_spring\", stiffness = 1e7 }} ]\n\
                 pin = [ {{ select = {{ nodes = [0, {links}] }}, axes = \"xy\" }} ]\n"
            );
        let mut world = built(plane(&text));
        frames(&mut world, 1);
        let sag = -nodes(&world).iter().map(|x| x[1]).fold(0.0, f64::min);
        println!("{solver}: sag {sag}, {:?}", world.solver_work());
        assert!((sag - 0.796_388).abs() < 2e-4, "{solver}: {sag}");
        // It stays there.
        frames(&mut world, 1);
        assert!((-nodes(&world)[50][1] - sag).abs() < 1e-9);
    }
}

#[test]
fn a_run_that_is_taken_up_again_ends_with_the_same_bits() {
    for rule in RULES {
        let text = head(1.0 / 60.0, 2, -9.81, rule)
            + "[[body]]\nname = \"ball\"\nshape = { kind = \"ring\", radius = 0.5, vertices = 24, center = [0.0, 0.7] }\n\
               mass = 1.0\nangular_velocity = 2.0\nmodels = [ { kind = \"mass_spring\", stiffness = 4e3, damping = 1.0 },\n\
               { kind = \"pressure\", nRT = 100.0, ambient = 10.0 } ]\n"
            + &floor(0.0, 0.5, 0.3);
        let mut whole = built(plane(&text));
        frames(&mut whole, 60);
        let mut first = built(plane(&text));
        frames(&mut first, 31);
        let mut second = built(plane(&text));
        second.restore(&first.snapshot()).unwrap();
        frames(&mut second, 29);
        assert_eq!(second.state_hash(), whole.state_hash(), "{rule}");
        assert_eq!(second.solver_work(), whole.solver_work(), "{rule}");
        assert!(whole.same_bits_everywhere());
    }
}

/// A gas-filled ring of springs: the pressure of the gas balances them, with every solver.
#[test]
fn all_linear_solvers_lead_to_the_same_motion() {
    let run = |solver: &str| {
        let text = head(1.0 / 60.0, 1, -9.81, "backward_euler").replace(
            "kind = \"backward_euler\"\n",
            &format!("kind = \"backward_euler\"\nlinear_solver = \"{solver}\"\n"),
        ) + "[[body]]\nname = \"ball\"\nshape = { kind = \"ring\", radius = 0.5, vertices = 64, center = [0.0, 0.7] }\n\
               mass = 1.0\nmodels = [ { kind = \"mass_spring\", stiffness = 4e3, damping = 1.0 },\n\
               { kind = \"pressure\", nRT = 100.0, ambient = 10.0 }, { kind = \"bending\", stiffness = 0.2, damping = 0.01 } ]\n"
            + &floor(0.0, 0.5, 0.0);
        let mut world = built(plane(&text));
        frames(&mut world, 40);
        (nodes(&world), world.same_bits_everywhere())
    };
    let (wanted, everywhere) = run("conjugate_gradients");
    assert!(everywhere);
    for (solver, promised) in [("matrix_free", true), ("cholesky", false)] {
        let (found, everywhere) = run(solver);
        assert_eq!(everywhere, promised);
        let error = common::largest(found.iter().flatten().zip(wanted.iter().flatten()).map(|(a, b)| a - b));
        assert!(error < 1e-6, "{solver}: {error}");
    }
}

/// In space: a stiff sheet of springs falls over a ball, and no node enters the ball.
#[test]
fn a_stiff_sheet_lies_on_a_ball() {
    let text = "format = \"opruga-1\"\ndimension = 3\n[time]\nseconds = 1\n[world]\ngravity = [0.0, -9.81, 0.0]\n\
        [integrator]\nkind = \"backward_euler\"\n\
        [[body]]\nname = \"sheet\"\nshape = { kind = \"sheet\", corner = [-0.5, 0.55, -0.5], u = [0.0, 0.0, 1.0], \
        v = [1.0, 0.0, 0.0], cells = [10, 10] }\nmass = 0.5\n\
        models = [ { kind = \"mass_spring\", stiffness = 2000.0, damping = 0.5 } ]\n\
        [[collider]]\nkind = \"ball\"\ncenter = [0.0, 0.0, 0.0]\nradius = 0.5\nfriction = 0.5\n";
    let mut world = built(space(&text.replace("seconds = 1\n", "seconds = 1\nsubsteps = 1\n")));
    for _ in 0..90 {
        frames(&mut world, 1);
        for node in 0..world.node_count(0) as u32 {
            let x = world.position(0, node);
            let far = (x[0] * x[0] + x[1] * x[1] + x[2] * x[2]).sqrt();
            assert!(far > 0.5 - 1e-7, "t = {}: node {node} at {x:?}, {far}", world.time());
        }
    }
}

#[test]
fn refusals_say_what_is_wrong_and_what_helps() {
    let free = head(0.1, 1, -9.81, "equilibrium") + BLOCK;
    let error = refused(&free);
    assert_eq!(error.code(), "static.rigid_modes");
    assert!(error.to_string().contains("translation along x, translation along y, rotation: 3 rigid modes"), "{error}");

    let arc = head(0.1, 1, -9.81, "equilibrium")
        .replace("kind = \"equilibrium\"\n", "kind = \"equilibrium\"\narc_length = 0.1\n");
    // Without load, at the beginning of the curve, nothing presses a body onto an obstacle.
    let error = refused(&(format!("{arc}{BLOCK}") + &floor(-5.0, 0.5, 0.0)));
    assert_eq!(error.code(), "static.arc_length_and_obstacles");
    assert!(error.in_full().contains("allowed: pins that hold the body, or no `arc_length`"), "{error}");

    let published = "[[body]]\nname = \"ball\"\nshape = { kind = \"ring\", radius = 100.0, vertices = 20 }\nnode_mass = 1.0\n\
        models = [ { kind = \"as_published\" } ]\n";
    let error = refused(&(head(0.01, 1, 0.0, "backward_euler") + published));
    assert_eq!(error.code(), "integrator.needs");
    assert!(error.to_string().contains("no second derivatives, which `backward_euler` needs"), "{error}");

    // One iteration is not enough.
    let turning = |fields: &str| {
        let text = head(0.2, 1, -9.81, "backward_euler")
            .replace("kind = \"backward_euler\"\n", &format!("kind = \"backward_euler\"\n{fields}"));
        text + &BLOCK.replace("mass = 2.0\n", "mass = 2.0\nangular_velocity = 5.0\n")
    };
    let mut world = built(plane(&turning("iterations = 2\n")));
    let before = nodes(&world);
    let error = world.frame().unwrap_err();
    assert_eq!(error.code(), "run.not_converged");
    let text = error.in_full();
    for part in
        ["did not converge in 2 iterations at t = 0 s", "out of balance by", "allowed:", "hint: use more substeps"]
    {
        assert!(text.contains(part), "{text}");
    }
    assert_eq!((nodes(&world), world.time()), (before, 0.0));
    // The two other policies for the same case.
    for (policy, code) in [("accept", "step.not_converged"), ("halve", "step.halved")] {
        let fields =
            format!("iterations = {}\nwhen_not_converged = \"{policy}\"\n", if policy == "accept" { 2 } else { 4 });
        let mut world = built(plane(&turning(&fields)));
        frames(&mut world, 5);
        let counted = world.warnings().iter().find(|w| w.code == code).map(|w| w.count);
        assert!(counted.is_some_and(|count| count >= 1), "{policy}: {:?}", world.warnings());
    }
}

/// The fixed budget of the real-time setting: what one step does not complete is done in the next ones.
#[test]
fn real_time_stays_near_the_exact_solution() {
    let run = |accuracy: &str| {
        let text = head(1.0 / 60.0, 1, -9.81, "backward_euler")
            .replace("kind = \"backward_euler\"\n", &format!("kind = \"backward_euler\"\naccuracy = \"{accuracy}\"\n"))
            + &BLOCK.replace("mass = 2.0\n", "mass = 2.0\nangular_velocity = 3.0\n")
            + &floor(-0.5, 0.4, 0.0);
        let mut world = built(plane(&text));
        let mut path = Vec::new();
        for _ in 0..90 {
            frames(&mut world, 1);
            path.push([mean(&world, |n| world.position(0, n)[0]), mean(&world, |n| world.position(0, n)[1])]);
        }
        (path, world.solver_work())
    };
    let ((exact, _), (quick, work)) = (run("exact"), run("real_time"));
    let error = common::largest(exact.iter().flatten().zip(quick.iter().flatten()).map(|(a, b)| a - b));
    println!("real time: {error} m of 0.5 m, {work:?}");
    assert!(error < 0.02 && work.iterations <= 3 * work.steps, "{error} {work:?}");
}

/// Every pair of model and integrator that claims to be compatible is stepped, in the plane and in space; every other one is refused.
#[test]
fn every_pair_of_model_and_integrator_does_as_it_says() {
    let models = |dimension: usize, kind: &str| match (kind, dimension) {
        ("mass_spring", _) => Some("{ kind = \"mass_spring\", stiffness = 100.0, damping = 0.5 }"),
        ("pressure", _) => Some("{ kind = \"pressure\", nRT = 20.0 }, { kind = \"mass_spring\", stiffness = 100.0 }"),
        ("bending", _) => {
            Some("{ kind = \"bending\", stiffness = 0.1 }, { kind = \"mass_spring\", stiffness = 100.0 }")
        }
        ("drag", _) => Some("{ kind = \"drag\", rate = 1.0 }, { kind = \"mass_spring\", stiffness = 100.0 }"),
        ("as_published", 2) => Some("{ kind = \"as_published\" }"),
        // Others have their own tests.
        _ => None,
    };
    let mut tried = 0;
    for (model, integrator, fits) in opruga::Registry::<2>::default().pairs() {
        for dimension in [2, 3] {
            let Some(models) = models(dimension, model) else { continue };
            let (shape, gravity) = match dimension {
                2 => ("kind = \"ring\", radius = 1.0, vertices = 12", "[0.0, -1.0]"),
                _ => ("kind = \"icosphere\", radius = 1.0, subdivisions = 1", "[0.0, -1.0, 0.0]"),
            };
            let pins = if integrator == "equilibrium" {
                "pin = [ { select = { nodes = [0, 3, 5] }, axes = \"all\" } ]\n"
            } else {
                ""
            };
            let pins = pins.replace("all", if dimension == 2 { "xy" } else { "xyz" });
            let text = format!(
                "format = \"opruga-1\"\ndimension = {dimension}\n[time]\nseconds = 1.0\nframe = 0.002\nsubsteps = 4\n\
                 [world]\ngravity = {gravity}\n[integrator]\nkind = \"{integrator}\"\n[[body]]\nname = \"ball\"\n\
                 shape = {{ {shape} }}\nnode_mass = 1.0\nmodels = [ {models} ]\n{pins}"
            );
            let built = match common::read(&text) {
                Ok(opruga::blueprint::AnyBlueprint::Plane(b)) => {
                    World::new(b, opruga::Options::default()).map(|mut w| frames(&mut w, 3))
                }
                Ok(opruga::blueprint::AnyBlueprint::Space(b)) => {
                    World::new(b, opruga::Options::default()).map(|mut w| frames(&mut w, 3))
                }
                Err(errors) => panic!("{model} with {integrator}: {}", errors[0]),
            };
            match built {
                Ok(()) => assert!(fits, "{model} with {integrator} in {dimension}D"),
                Err(error) => assert!(
                    !fits && error.code() == "integrator.needs",
                    "{model} with {integrator} in {dimension}D: {error}"
                ),
            }
            tried += 1;
        }
    }
    assert!(tried >= 9 * 10 - 20, "{tried}");
}

/// Numerical damping is reported as such, and not as an unexplained error. (For explicit integrators, torture tests check that they warn.)
#[test]
fn the_ledger_tells_a_rules_own_damping_from_errors() {
    let ball = "[[body]]\nname = \"ball\"\nshape = { kind = \"ring\", radius = 0.5, vertices = 12, center = [0.0, 0.0] }\nmass = 1.0\n\
        angular_velocity = 8.0\nmodels = [ { kind = \"mass_spring\", stiffness = 1000.0 } ]\n";
    for rule in RULES {
        let mut world = built(plane(&(head(1.0 / 60.0, 1, 0.0, rule) + ball)));
        frames(&mut world, 240);
        let energy = world.energy();
        assert!(world.warnings().iter().all(|warning| warning.code != "ledger.closure"), "{rule}: {energy:?}");
        let damped = world.warnings().iter().any(|warning| warning.code == "ledger.numerical_damping");
        assert!(rule != "backward_euler" || damped && energy.loss_numerical > 0.1 * energy.in_motion, "{energy:?}");
        assert!(energy.closure < 1e-4, "{rule}: {energy:?}");
    }
}

/// A floor without friction supports a block, but does not fix its position along the floor.
#[test]
fn an_equilibrium_on_a_floor_names_the_motions_that_it_leaves_free() {
    let text = |friction: f64, shape: &str, level: f64| {
        head(1.0 / 60.0, 1, -9.81, "equilibrium")
            + &format!(
                "[[body]]\nname = \"block\"\nshape = {shape}\ndensity = 1000.0\nmodels = [ {{ kind = \"fem\", youngs_modulus = 1e5, \
                 poissons_ratio = 0.4 }} ]\n"
            )
            + &floor(level, friction, 0.0)
    };
    let square = "{ kind = \"grid\", size = [0.4, 0.2], cells = [4, 2] }";
    // It is above the floor, just touches it, or begins within it, partly or completely.
    let levels = [-0.05, -0.099, 0.0, 0.03, 0.05, 0.09, 0.15, 0.3];
    for (friction, level) in [0.0, 0.1, 0.5, 1.0].into_iter().flat_map(|friction| levels.map(|level| (friction, level)))
    {
        let mut world = built(plane(&text(friction, square, level)));
        let at_rest = mean(&world, |node| world.position(0, node)[0]);
        let outcome = world.frame();
        println!("{friction}, {level} m: {outcome:?}, {:?}", world.solver_work());
        let iterations = world.solver_work().iterations;
        match outcome {
            Ok(()) => {
                let way = mean(&world, |node| world.position(0, node)[0]) - at_rest;
                assert!(friction > 0.0 && iterations < 20 && way.abs() < 1e-3, "{way} m, {iterations} iterations");
                let low = mean(&world, |node| world.position(0, node)[1]) - level;
                assert!((low - 0.1).abs() < 2e-3, "{low} m over the floor");
            }
            Err(error) => {
                let said = error.in_full();
                assert!(friction == 0.0 && said.contains("translation along x") && said.contains("hint"), "{said}");
            }
        }
    }
}

/// A weight on a damped spring whose other end is pinned starts with the velocity of the whole body, and the pin stops the other end at once: the
/// damper must not act because of the former motion of the pinned node. With c = 2 and k = 40 at 1 kg, v₀ = ½ m/s and no gravity, after one second: x
/// = e⁻¹ (v₀/ω) sin ω, v = e⁻¹ v₀ (cos ω − (sin ω)/ω), ω = √39.
#[test]
fn a_pin_ends_the_motion_of_its_node_before_the_first_step() {
    let omega = 39f64.sqrt();
    let (x, v) = ((-1f64).exp() * 0.5 / omega * omega.sin(), (-1f64).exp() * 0.5 * (omega.cos() - omega.sin() / omega));
    for (rule, error) in [("verlet", 2e-5), ("heun", 1e-4), ("runge_kutta", 1e-9), ("newmark", 5e-5)] {
        let text = head(0.1, 64, 0.0, rule)
            + "[[body]]\nname = \"weight\"\nshape = { kind = \"line\", from = [0.0, 0.0], to = [0.0, -1.0], segments = 1 }\n\
               node_mass = 1.0\nvelocity = [0.0, 0.5]\n\
               models = [ { kind = \"mass_spring\", stiffness = 40.0, damping = 2.0 } ]\n\
               pin = [ { select = { node = 0 } } ]\n";
        let mut world = built(plane(&text));
        frames(&mut world, 10);
        let [dx, dv] = [world.position(0, 1)[1] + 1.0 - x, world.velocity(0, 1)[1] - v];
        println!("{rule}: {dx:e} m, {dv:e} m/s");
        assert!(dx.abs() < error && dv.abs() < error, "{rule}: {dx:e} {dv:e}");
        // The energy removed by the pin is its work, and none is missing.
        let energy = world.energy();
        assert!(energy.loss_integrator.abs() < 1e-3 && (energy.work_user + 0.125).abs() < 1e-3, "{rule}: {energy:?}");
    }
}
