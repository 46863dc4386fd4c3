//! The numerical damping of implicit integrators is measured and reported, and the ledger has no other gap.
#![allow(clippy::disallowed_methods)] // expected values of the tests' own

use crate::common;

use common::{built, frames, head, plane, space};
use opruga::{Energy, World};

const RULES: [&str; 5] = [
    "backward_euler",
    "bdf2",
    "implicit_midpoint",
    "newmark",
    "newmark\"\nspectral_radius = 0.5\nlinear_solver = \"auto",
];

const NUMERICAL: &str = "ledger.numerical_damping";

fn warns<const D: usize>(world: &World<D>, code: &str) -> bool {
    world.warnings().iter().any(|warning| warning.code == code)
}

/// Asserts that the initial energy plus all inputs equals the present energy plus all losses.
fn adds_up(start: f64, e: &Energy) {
    let given = start + e.work_user + e.work_gas + e.work_correction;
    let taken = e.loss_damping + e.loss_friction + e.loss_contact + e.loss_numerical;
    let left = given - taken - e.total();
    assert!((left - e.loss_integrator).abs() <= 1e-12 * (given.abs() + taken.abs() + e.in_motion), "{left}: {e:?}");
    assert!((e.closure - left.abs() / e.in_motion).abs() < 1e-9, "{e:?}");
}

const TIGHT: &str = "tolerance = 1e-10\n";

/// The head of a scene whose integrator has a small tolerance.
fn tight(frame: f64, substeps: u32, gravity: f64, rule: &str) -> String {
    head(frame, substeps, gravity, rule).replace("[world]", &format!("{TIGHT}[world]"))
}

/// A soft square that spins about its centre and therefore oscillates in size, with ten steps per revolution.
const SPINNING: &str = "[[body]]\nname = \"square\"\nshape = { kind = \"grid\", size = [1, 1], cells = [3, 3] }\n\
    density = 1000\nangular_velocity = 10.0\nvelocity = [1.0, 2.0]\n\
    models = [ { kind = \"fem\", youngs_modulus = 1e6, poissons_ratio = 0.3MORE } ]\n";

#[test]
fn a_free_body_has_its_energy_less_what_the_rule_took() {
    for rule in RULES {
        for more in ["", ", mass = \"consistent\""] {
            let text = tight(0.05, 1, 0.0, rule) + &SPINNING.replace("MORE", more);
            let mut world = built(plane(&text));
            let start = world.energy().total();
            for _ in 0..100 {
                frames(&mut world, 1);
                let e = world.energy();
                adds_up(start, &e);
                assert!((e.total() + e.loss_numerical - start).abs() < 1e-7 * start, "{rule}{more}: {e:?}");
            }
            let (e, told) = (world.energy(), warns(&world, NUMERICAL));
            assert!(told || e.loss_numerical.abs() <= 0.05 * e.in_motion, "{rule}{more}: {e:?}");
            assert!(rule != "backward_euler" || told && e.loss_numerical > 0.3 * start, "{rule}{more}: {e:?}");
        }
    }
}

/// A stiff bar that swings about its end, with sixteen steps per period: the dissipation of backward Euler is reported, and no integrator without
/// damping is blamed.
#[test]
fn a_pendulum_that_the_rule_stops_is_told() {
    let bar = "[[body]]\nname = \"bar\"\nshape = { kind = \"grid\", size = [1.0, 0.1], cells = [10, 1], corner = [0, 0] }\ndensity = 1000\n\
        models = [ { kind = \"fem\", youngs_modulus = 1e8, poissons_ratio = 0.3 } ]\n\
        pin = [ { select = { box = [[-0.01, -0.01], [0.01, 0.01]] }, axes = \"xy\" } ]\n";
    for (rule, substeps, expected) in [("backward_euler", 1, true), ("implicit_midpoint", 40, false)] {
        let mut world = built(plane(&(tight(0.1, substeps, -9.81, rule) + bar)));
        frames(&mut world, 60);
        let e = world.energy();
        assert_eq!(warns(&world, NUMERICAL), expected, "{rule}: {e:?}");
        assert!(!warns(&world, "ledger.closure") && e.closure < 1e-6, "{rule}: {e:?}");
        assert!(!expected || e.loss_numerical > 0.3 * e.in_motion, "{rule}: {e:?}");
    }
}

/// The advice of the warnings with a code.
fn advice<const D: usize>(world: &World<D>, code: &str) -> Option<String> {
    let warning = world.warnings().into_iter().find(|warning| warning.code == code)?;
    warning.field("help")
}

/// A body that falls and comes to rest loses its energy by impacts, friction and damping. A smaller part that the integrator removes is no news; without
/// damping and impacts, the integrator alone ends the motion.
#[test]
fn the_loss_of_the_rule_is_told_of_only_if_it_exceeds_all_physical_losses() {
    let block = "[[body]]\nname = \"block\"\nshape = { kind = \"grid\", size = [0.4, 0.4], cells = [4, 4], corner = [0, 1] }\ndensity = 500\n\
        models = [ { kind = \"fem\", youngs_modulus = 1e5, poissons_ratio = 0.3, damping = 0.02 } ]\n";
    let text = tight(1.0 / 60.0, 4, -9.81, "backward_euler") + block + FLOOR;
    let mut world = built(plane(&text));
    frames(&mut world, 120);
    let e = world.energy();
    let physical = e.loss_damping + e.loss_friction + e.loss_contact;
    assert!(e.loss_numerical > 0.06 * e.in_motion && e.loss_numerical < 0.8 * physical, "{e:?}");
    assert!(!warns(&world, NUMERICAL), "{e:?}");

    let mut free = built(plane(&(tight(0.05, 1, 0.0, "backward_euler") + &SPINNING.replace("MORE", ""))));
    frames(&mut free, 100);
    assert!(warns(&free, NUMERICAL), "{:?}", free.energy());
}

#[test]
fn the_advice_against_damping_by_the_rule_names_nothing_that_the_scene_uses() {
    // The rule, more settings, and what is advised.
    let cases = [
        ("backward_euler", "", "implicit_midpoint"),
        ("backward_euler", "accuracy = \"real_time\"\n", "bdf2"),
        ("newmark", "spectral_radius = 0.0\n", "spectral_radius"),
    ];
    for (rule, more, expected) in cases {
        let text =
            head(0.05, 1, 0.0, rule).replace("[world]", &format!("{more}[world]")) + &SPINNING.replace("MORE", "");
        let mut world = built(plane(&text));
        frames(&mut world, 100);
        let advice = advice(&world, NUMERICAL).unwrap_or_else(|| panic!("{rule}: {:?}", world.energy()));
        assert!(!advice.contains(&format!("`{rule}`")) && advice.contains(expected), "{rule}: {advice}");
        assert_eq!(
            advice.contains("midpoint"),
            expected == "implicit_midpoint",
            "steps in real time refuse it: {advice}"
        );
    }
}

/// With a tolerance of a tenth of the body, exact steps leave much of their equations unbalanced.
#[test]
fn the_advice_against_an_open_ledger_names_another_setting_than_the_one_in_use() {
    for (accuracy, other) in [("exact", "tolerance"), ("real_time", "exact")] {
        let settings =
            format!("accuracy = \"{accuracy}\"\ntolerance = 0.1\niterations = 1\nwhen_not_converged = \"accept\"\n");
        let text = head(0.1, 1, 0.0, "backward_euler").replace("[world]", &format!("{settings}[world]"));
        let mut world = built(plane(&(text + &SPINNING.replace("MORE", ""))));
        for _ in 0..60 {
            frames(&mut world, 1);
            if let Some(advice) = advice(&world, "ledger.closure") {
                assert!(!advice.contains(accuracy) && advice.contains(other), "{advice}");
                break;
            }
        }
        assert!(warns(&world, "ledger.closure"), "{accuracy}: {:?}", world.energy());
    }
}

const RING: &str = "[[body]]\nname = \"ball\"\nshape = { kind = \"ring\", radius = 0.5, vertices = 16, center = [0.0, 0.7] }\n\
    mass = 1.0\nvelocity = [1.5, -1.0]\nmodels = [ { kind = \"mass_spring\", stiffness = 800.0, damping = 1.0 }, GAS ]\n";

const FLOOR: &str =
    "[[collider]]\nkind = \"half_space\"\npoint = [0.0, 0.0]\nnormal = [0.0, 1.0]\nfriction = 0.3\nrestitution = 0.5\n";

/// Weight, a gas that is pumped up, a load that is applied and removed, a moving pin, obstacles with friction and restitution, halved steps, few
/// iterations in real time.
#[test]
fn nothing_is_left_over_whatever_acts() {
    let gas = RING.replace("GAS", "{ kind = \"pressure\", nRT = 60.0 }");
    let pumped = RING.replace("GAS", "{ kind = \"pressure\", nRT = 60.0, ramp = 0.5 }");
    let load = "[[load]]\nkind = \"force\"\nbody = \"ball\"\nselect = { node = 3 }\nvalue = [4.0, 2.0]\n\
        curve = [[0.0, 0.0], [0.3, 1.0], [0.6, 0.2]]\n";
    let pin = gas.clone()
        + "pin = [ { select = { node = 0 }, axes = \"xy\", motion = [[0.0, 0.0, 0.0], [0.5, 0.4, 0.2], [1.0, 0.0, 0.0]] } ]\n";
    let halves = "iterations = 5\nwhen_not_converged = \"halve\"\n";
    let cases = [
        ("gas", "", gas.clone(), 1e-6),
        ("pumped", "", pumped, 1e-6),
        ("load", "", gas.clone() + load, 1e-6),
        ("pin", "", pin, 1e-6),
        ("halved", halves, gas.clone(), 1e-6),
        ("floor", "", gas.clone() + FLOOR, 1e-3),
        ("real time", "accuracy = \"real_time\"\n", gas.clone() + FLOOR, 0.05),
    ];
    for (name, setting, body, most) in &cases {
        for rule in RULES.into_iter().filter(|rule| *name != "real time" || ["backward_euler", "bdf2"].contains(rule)) {
            let tolerance = if name == &"real time" { "" } else { TIGHT };
            let text =
                head(1.0 / 60.0, 1, -9.81, rule).replace("[world]", &format!("{tolerance}{setting}[world]")) + body;
            let mut world = built(plane(&text));
            let start = world.energy().total();
            let mut worst = 0.0f64;
            for _ in 0..90 {
                frames(&mut world, 1);
                adds_up(start, &world.energy());
                worst = worst.max(world.energy().closure);
            }
            println!("{name}, {rule}: {worst:.2e}, {:?}", world.energy());
            assert!(worst < *most, "{name}, {rule}: {worst} {:?}", world.energy());
        }
    }
}

/// Snapshots, returns to an earlier frame, and sampling within a frame: the sum covers exactly the frames that count.
#[test]
fn what_rules_took_goes_with_the_state() {
    let text =
        |substeps: u32, frame: f64| head(frame, substeps, -9.81, "backward_euler") + &RING.replace(", GAS", "") + FLOOR;
    let mut world = built(plane(&text(4, 1.0 / 16.0)));
    frames(&mut world, 8);
    let kept = world.snapshot();
    frames(&mut world, 8);
    let after = world.energy();
    assert!(after.loss_numerical > 0.01 * after.in_motion, "{after:?}");
    let mut other = built(plane(&text(4, 1.0 / 16.0)));
    other.restore(&kept).expect("a snapshot");
    frames(&mut other, 8);
    assert_eq!(other.energy(), after);
    assert_eq!(other.snapshot(), world.snapshot());
    world.restore(&kept).expect("a snapshot");
    frames(&mut world, 8);
    assert_eq!(world.energy(), after);

    let mut long = built(plane(&text(4, 1.0 / 16.0)));
    let mut short = built(plane(&text(1, 1.0 / 64.0)));
    long.keep_looks(1);
    for _ in 0..16 {
        frames(&mut long, 1);
        let mut seen = Vec::new();
        long.look_within(|world| seen.push(world.energy()));
        seen.push(long.energy());
        assert_eq!(seen.len(), 4);
        for look in seen {
            frames(&mut short, 1);
            let expected = short.energy();
            assert!((look.loss_numerical - expected.loss_numerical).abs() < 1e-9, "{look:?} {expected:?}");
            assert!((look.loss_integrator - expected.loss_integrator).abs() < 1e-9, "{look:?} {expected:?}");
        }
    }
}

/// A program may change the scene while it runs: the energy of such a change is its work, not damping.
#[test]
fn changes_of_the_scene_are_no_damping() {
    let text = "format = \"opruga-1\"\ndimension = 3\n[time]\nseconds = 1\nframe = 0.02\nsubsteps = 1\n[world]\n\
        gravity = [0, 0, -9.81]\n[integrator]\nkind = \"implicit_midpoint\"\ntolerance = 1e-12\n[[body]]\nname = \"cube\"\n\
        shape = { kind = \"grid\", size = [1, 1, 1], cells = [1, 1, 1], corner = [0, 0, 0] }\ndensity = 100\n\
        models = [ { kind = \"fem\", youngs_modulus = 1e5, poissons_ratio = 0.3 } ]\n";
    let mut world = built(space(text));
    let start = world.energy().total();
    frames(&mut world, 5);
    world.set("world.gravity", opruga::core::spec::Value::Numbers(vec![0.0, 0.0, 5.0])).expect("another weight");
    world.set_node(0, 0, [-0.05, 0.0, 0.0], [0.0, 0.0, 0.3]).expect("another place");
    let placed = world.energy();
    frames(&mut world, 5);
    let e = world.energy();
    assert!(
        (e.loss_numerical - placed.loss_numerical).abs() < 1e-3 * e.in_motion && e.closure < 1e-9,
        "{start}: {e:?}"
    );
}

/// Steps in real time have a residual, and more of them add more energy where a block slides on a slab.
#[test]
fn the_advice_against_energy_that_steps_in_real_time_add_is_exact_steps() {
    let fem =
        "models = [{ kind = \"fem\", youngs_modulus = 5e5, poissons_ratio = 0.3, damping = 0.002 }]\ndensity = 500.0\n";
    let text = format!(
        "format = \"opruga-1\"\ndimension = 2\n[time]\nseconds = 1.0\nsubsteps = 16\n[world]\ngravity = [4.39, -8.77]\n\
         [integrator]\nkind = \"backward_euler\"\naccuracy = \"real_time\"\n[contact]\nfriction = 0.3\n\
         [[body]]\nname = \"slab\"\npin = [{{ select = {{ side = \"bottom\" }} }}]\n\
         shape = {{ kind = \"grid\", size = [4.0, 0.2], cells = [40, 2], corner = [-0.5, -0.2] }}\n{fem}\
         [[body]]\nname = \"block\"\n\
         shape = {{ kind = \"grid\", size = [0.2, 0.1], cells = [4, 2], corner = [-0.2, 0.0005] }}\n{fem}"
    );
    let mut world = built(plane(&text));
    frames(&mut world, 60);
    assert!(world.energy().loss_numerical < -10.0, "{:?}", world.energy());
    let warnings = world.warnings();
    let warning = warnings.iter().find(|warning| warning.code == NUMERICAL).expect("a warning");
    assert!(warning.message.contains("accuracy = \"exact\""), "{}", warning.message);
}
