//! The ledger of bodies at rest: rounding errors do not count as errors of an integrator.

use opruga::blueprint::AnyBlueprint;
use opruga::io::{Files, scene};
use opruga::{Energy, Options, World, catalogue};

/// Bodies of springs without gravity and obstacles, at rest in their shapes, one of them far from the origin.
const BODIES: [&str; 2] = [
    "mass = 1.0\nshape = { kind = \"ring\", radius = 0.37, vertices = 29 }\n\
     models = [{ kind = \"mass_spring\", stiffness = 900.0, damping = 0.3 }]",
    "mass = 2.0\nshape = { kind = \"grid\", size = [1.3, 0.7], cells = [5, 3], corner = [100.1, -30.3] }\n\
     models = [{ kind = \"mass_spring\", stiffness = 400.0, edges = \"shear\" }]",
];

/// The laws of solids. The energy of some at rest is a difference of large terms, and has their rounding errors.
const LAWS: [&str; 7] = [
    "linear",
    "corotated",
    "fixed_corotated",
    "st_venant_kirchhoff",
    "neo_hookean",
    "stable_neo_hookean",
    "mooney_rivlin",
];

/// A solid on the floor, at this distance from the origin [m].
fn solid(law: &str, modulus: f64, far: f64) -> String {
    format!(
        "density = 1000.0\nshape = {{ kind = \"grid\", size = [1.0, 0.5], cells = [4, 2], corner = [{far}, 0.0] }}\n\
         models = [{{ kind = \"fem\", material = \"{law}\", youngs_modulus = {modulus}, poissons_ratio = 0.3, damping = 1e-4 }}]"
    )
}

/// The scene with gravity and a floor.
fn on_a_floor(scene: &str) -> String {
    let floor = "[[collider]]\nkind = \"half_space\"\npoint = [0.0, 0.0]\nnormal = [0.0, 1.0]\nrestitution = 0.0\nfriction = 0.5\n";
    scene.replace("gravity = [0.0, 0.0]", "gravity = [0.0, -9.81]") + floor
}

fn scene(rule: &str, substeps: u32, body: &str) -> String {
    format!(
        "format = \"opruga-1\"
dimension = 2
[time]
seconds = 9.0
substeps = {substeps}
[world]
\
         gravity = [0.0, 0.0]
[integrator]
kind = \"{rule}\"
[[body]]
name = \"it\"
{body}
"
    )
}

/// The closure at the end of a second, the count of its warning, and the unexplained energy [J]. The first node begins with a speed along x [m/s].
fn outcome(text: &str, speed: f64) -> (f64, u64, f64) {
    let blueprint = match scene::read(text.as_bytes(), "test.toml", &catalogue(), &scene::Options::default()) {
        Ok((AnyBlueprint::Plane(blueprint), _)) => blueprint,
        Ok(_) => panic!("a scene of the plane"),
        Err(errors) => panic!("{text}\n{}", errors[0]),
    };
    let options = Options { allow_unstable: true, ..Options::default() };
    let mut world = World::new(blueprint, options).expect("a world");
    if speed > 0.0 {
        world.set_node(0, 0, world.position(0, 0), [speed, 0.0]).expect("placed");
    }
    (0..60).for_each(|_| world.frame().expect("a frame"));
    let warned = world.warnings().into_iter().find(|warning| warning.code == "ledger.closure");
    (world.energy().closure, warned.map_or(0, |warning| warning.count), world.energy().loss_integrator)
}

#[test]
fn a_body_at_rest_without_gravity_has_a_closed_ledger() {
    let explicit = ["symplectic_euler", "verlet", "heun", "runge_kutta"].map(|rule| (rule, 64));
    let implicit = ["backward_euler", "implicit_midpoint", "newmark", "bdf2"].map(|rule| (rule, 1));
    for (number, body) in BODIES.iter().enumerate() {
        for (rule, substeps) in explicit.iter().chain(&implicit) {
            let (closure, warned, lost) = outcome(&scene(rule, *substeps, body), 0.0);
            println!("{rule}, body {number}: closure {closure:.1e}, {lost:.1e} J");
            assert!(closure < 0.01 && warned == 0, "{rule}, body {number}: {closure:.1e}, {lost:.1e} J");
        }
    }
}

/// Solids of every law, soft and a hundred times stiffer, at rest, and the same on a floor, where they settle under their own weight more and more
/// slowly.
#[test]
fn a_solid_at_rest_has_a_closed_ledger() {
    let explicit = ["symplectic_euler", "verlet"].map(|rule| (rule, 64, 1e6));
    let implicit = ["backward_euler", "implicit_midpoint", "newmark", "bdf2"];
    let implicit = [1e6, 1e8].map(|modulus| implicit.map(|rule| (rule, 1, modulus)));
    for law in LAWS {
        for (rule, substeps, modulus) in explicit.iter().chain(implicit.as_flattened()) {
            for far in [0.1, 40.0] {
                let free = scene(rule, *substeps, &solid(law, *modulus, far));
                let (closure, warned, lost) = outcome(&free, 0.0);
                println!("{law}, {rule}, {modulus:e} Pa at {far} m: closure {closure:.1e}, {lost:.1e} J");
                assert!(
                    closure < 0.1 && warned == 0,
                    "{law}, {rule}, {modulus:e} Pa at {far} m: {closure:.1e}, {lost:.1e} J"
                );
                let (closure, warned, lost) = outcome(&on_a_floor(&free), 0.0);
                println!("  on a floor: closure {closure:.1e}, {lost:.1e} J");
                assert_eq!(
                    warned, 0,
                    "{law}, {rule}, {modulus:e} Pa at {far} m on a floor: {closure:.1e}, {lost:.1e} J"
                );
            }
        }
    }
}

/// The energy that explicit Euler adds to a slow oscillation of a solid is distinguished from rounding, even if the solid lies on a floor.
#[test]
fn an_open_ledger_of_a_solid_is_warned_of() {
    for law in LAWS {
        let body = solid(law, 1e6, 0.1).replace("damping = 1e-4", "damping = 0.0");
        let open = scene("explicit_euler", 160, &body);
        for (text, speed) in [(open.clone(), 1e-2), (open.clone(), 1e-4), (on_a_floor(&open), 0.0)] {
            let (closure, warned, lost) = outcome(&text, speed);
            println!("{law}, {speed} m/s: closure {closure:.1e}, {lost:.1e} J");
            assert!(closure > 0.1 && warned > 0, "{law}, {speed} m/s: {closure:.1e}, {lost:.1e} J");
        }
    }
}

/// However slow a motion is, it is not a rounding error: the energy that explicit Euler adds to it is detected.
#[test]
fn an_open_ledger_of_a_slow_motion_is_warned_of() {
    let body = BODIES[0].replace("damping = 0.3", "damping = 0.0");
    for speed in [1e-2, 1e-5, 1e-8] {
        let (closure, warned, lost) = outcome(&scene("explicit_euler", 64, &body), speed);
        println!("{speed} m/s: closure {closure:.1e}, {lost:.1e} J");
        assert!(closure > 0.1 && warned > 0, "{speed} m/s: {closure:.1e}, {lost:.1e} J");
    }
}

/// The physics of benchmark scenes is no worse than that of others: their runs have no warnings.
#[test]
fn the_scene_that_times_spot_has_a_closed_ledger() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../benches/scenes/spot.toml");
    let text = std::fs::read(&path).expect("the scene");
    let options = scene::Options { files: Files::beside(&path).allow_outside(true), ..scene::Options::default() };
    let Ok((AnyBlueprint::Space(blueprint), _)) = scene::read(&text, "spot.toml", &catalogue(), &options) else {
        panic!("a scene of space")
    };
    let mut world = World::new(blueprint, Options::default()).expect("a world");
    (0..240).for_each(|_| world.frame().expect("a frame"));
    let warnings = world.warnings();
    assert!(warnings.is_empty(), "{warnings:?}, closure {}", world.energy().closure);
}

/// Statics: moving pins do the work of the springs and no more, whatever the mass of the body and the speed of the pins; energy that a gas gets by
/// heat or by its ramp, or loses by a leak, is not counted as theirs.
#[test]
fn balances_that_are_led_have_a_closed_ledger() {
    let chain = |mass: f64| {
        format!(
            "shape = {{ kind = \"line\", from = [0.0, 0.0], to = [1.0, 0.0], segments = 4 }}\nmass = {mass:?}\n\
             models = [{{ kind = \"mass_spring\", stiffness = 100.0 }}]\n\
             pin = [{{ select = {{ node = 0 }}, axes = \"xy\" }}, {{ select = {{ all = true }}, axes = \"y\" }}, \
             {{ select = {{ node = 4 }}, motion = [[0.0, 0.0, 0.0], [1.0, 0.5, 0.0]] }}]"
        )
    };
    let ring = |gas: &str| {
        format!(
            "shape = {{ kind = \"ring\", radius = 0.5, vertices = 24 }}\nmass = 1.0\n\
             models = [{{ kind = \"mass_spring\", stiffness = 1000.0 }}, {{ kind = \"pressure\", nRT = 100.0, {gas} }}]\n\
             pin = [{{ select = {{ node = 0 }}, axes = \"xy\" }}, {{ select = {{ node = 12 }}, axes = \"y\" }}]"
        )
    };
    // Four springs in a row that are extended by half a metre: ½ · 25 N/m · 0.25 m².
    for mass in [1.0, 1e5] {
        let ([_, energy], closure) = led(&chain(mass));
        assert!((energy.work_user - 3.125).abs() < 1e-9 && closure < 1e-9, "{mass} kg: {energy:?}");
    }
    for gas in ["temperature = [[0.0, 1.0], [1.0, 1.5]]", "ramp = 0.5", "leak = 0.5"] {
        let ([first, energy], closure) = led(&ring(gas));
        println!("{gas}: {first:?} {energy:?}");
        let given = energy.work_gas - first.work_gas;
        assert!(given.abs() > 1.0 && closure < 1e-9, "{gas}: {closure:e} {energy:?}");
        // After its first equilibrium no pin moves this ring, so only the error of the finite steps remains.
        let led = energy.work_user - first.work_user;
        assert!(led.abs() < 0.2 * given.abs(), "{gas}: {led} J of {given} J");
    }
}

/// The energies of a body after its first equilibrium and after one second of equilibria, and then its closure.
fn led(body: &str) -> ([Energy; 2], f64) {
    let text = scene("equilibrium", 1, body).replace("[time]\n", "[time]\nframe = 0.1\n");
    let blueprint = match scene::read(text.as_bytes(), "test.toml", &catalogue(), &scene::Options::default()) {
        Ok((AnyBlueprint::Plane(blueprint), _)) => blueprint,
        Ok(_) => panic!("a scene of the plane"),
        Err(errors) => panic!("{text}\n{}", errors[0]),
    };
    let mut world = World::new(blueprint, Options::default()).expect("a world");
    world.frame().expect("a frame");
    let first = world.energy();
    (1..10).for_each(|_| world.frame().expect("a frame"));
    ([first, world.energy()], world.energy().closure)
}
