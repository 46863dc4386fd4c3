//! The energy ledger of bodies at rest, and of an integrator that creates energy.

use super::*;
use opruga::core::spec::Value;

/// A loaded body at rest: damping, loads and obstacles neither remove nor add energy, with every integrator, and every ledger is closed.
#[test]
fn a_body_that_lies_still_takes_and_gives_no_energy() {
    // With integrators of several stages, nodes next to those at rest have velocities of about 1e-7 m/s without moving.
    for (rule, most) in [("symplectic_euler", 1e-8), ("verlet", 1e-5), ("runge_kutta", 1e-5), ("heun", 1e-5)] {
        let models =
            "{ kind = \"mass_spring\", stiffness = 600.0, damping = 0.5 }, { kind = \"pressure\", nRT = 30.0 }";
        let floor = FLOOR.replace("0.2", "0");
        let load = "[[load]]\nkind = \"force\"\nbody = \"b\"\nvalue = [0.0, -0.5]\n";
        let mut world = built(plane(&ring(64, models, &format!("{floor}{load}")).replace("symplectic_euler", rule)));
        world.set("world.drag", Value::Number(3.0)).expect("a parameter");
        frames(&mut world, 1200);
        let before = world.energy();
        frames(&mut world, 60);
        let after = world.energy();
        // Per second.
        for (name, flow) in [
            ("damping", after.loss_damping - before.loss_damping),
            ("loads", after.work_user - before.work_user),
            ("put back", after.work_correction - before.work_correction),
            ("impacts", after.loss_contact - before.loss_contact),
            ("friction", after.loss_friction - before.loss_friction),
            ("unexplained", after.loss_integrator - before.loss_integrator),
        ] {
            println!("{rule}: {name} {flow:.1e} J/s");
            assert!(flow.abs() < most, "{rule}: {name} {flow:.3e} J/s");
        }
        assert!(world.warnings().iter().all(|w| w.code != "ledger.closure"), "{rule}");
    }
}

/// A block of springs on a slope, held by friction: no energy flows, however long it stays there.
#[test]
fn a_block_held_by_friction_takes_and_gives_no_energy() {
    let mut world = built(plane(
        "format = \"opruga-1\"\ndimension = 2\n[time]\nseconds = 9.0\nsubsteps = 64\n[world]\n\
         gravity = [4.387157534545926, -8.77433466235913]\n[integrator]\nkind = \"symplectic_euler\"\n[[body]]\nname = \"block\"\n\
         mass = 1.0\nshape = { kind = \"grid\", size = [1.0, 0.5], cells = [8, 4] }\n\
         models = [{ kind = \"mass_spring\", stiffness = 2000.0, damping = 10.0, edges = \"shear\" }]\n[[collider]]\n\
         kind = \"half_space\"\npoint = [0.0, 0.0]\nnormal = [0.0, 1.0]\nfriction = 0.6\n",
    ));
    frames(&mut world, 180);
    let before = world.energy();
    frames(&mut world, 300);
    let after = world.energy();
    assert!(after.kinetic < 1e-12, "{after:?}");
    assert!((after.loss_friction - before.loss_friction).abs() < 1e-9, "{before:?} {after:?}");
    assert!((after.loss_integrator - before.loss_integrator).abs() < 1e-9, "{before:?} {after:?}");
}

/// Explicit Euler creates energy: the ledger stays open, which is reported; with symplectic Euler the ledger of the same ball is closed.
#[test]
fn a_ledger_that_stays_open_is_warned_of() {
    for (rule, closes) in [("symplectic_euler", true), ("explicit_euler", false)] {
        let models =
            "{ kind = \"mass_spring\", stiffness = 600.0, damping = 0.05 }, { kind = \"pressure\", nRT = 30.0 }";
        let mut world = built(plane(&ring(64, models, FLOOR).replace("symplectic_euler", rule)));
        frames(&mut world, 180);
        let warned = world.warnings().into_iter().any(|w| w.code == "ledger.closure" && w.count > 10);
        assert!((world.energy().closure < 0.1) == closes && warned != closes, "{rule}: {:?}", world.energy());
    }
}
