//! The ledger of bodies in which nothing moves: what rounding makes of them is no error of an integrator.

use opruga::blueprint::AnyBlueprint;
use opruga::io::scene;
use opruga::{Options, World, catalogue};

/// Bodies of springs without gravity and obstacles, at rest in their shapes, one of them far from the origin. (The energies of
/// hyperelastic laws are differences of large parts and are rounded with those: what that leaves open is not told from motion
/// yet.)
const BODIES: [&str; 2] = [
    "mass = 1.0\nshape = { kind = \"ring\", radius = 0.37, vertices = 29 }\n\
     models = [{ kind = \"mass_spring\", stiffness = 900.0, damping = 0.3 }]",
    "mass = 2.0\nshape = { kind = \"grid\", size = [1.3, 0.7], cells = [5, 3], corner = [100.1, -30.3] }\n\
     models = [{ kind = \"mass_spring\", stiffness = 400.0, edges = \"shear\" }]",
];

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

/// The closure at the end of a second, how often it was warned of, and what has no cause [J]. The first node begins with a
/// speed along x [m/s].
fn outcome(text: &str, speed: f64) -> (f64, u64, f64) {
    let blueprint = match scene::read(text.as_bytes(), "test.toml", &catalogue(), &scene::Options::default()) {
        Ok((AnyBlueprint::Plane(blueprint), _)) => blueprint,
        Ok(_) => panic!("a scene of the plane"),
        Err(errors) => panic!("{text}\n{}", errors[0]),
    };
    let options = Options { allow_unstable: true, ..Options::default() };
    let mut world = World::new(blueprint, options).expect("a world");
    if speed > 0.0 {
        world.place_node(0, 0, world.position(0, 0), [speed, 0.0]).expect("placed");
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

/// A motion however slow is none of rounding: what explicit Euler adds to it is seen.
#[test]
fn an_open_ledger_of_a_slow_motion_is_warned_of() {
    let body = BODIES[0].replace("damping = 0.3", "damping = 0.0");
    for speed in [1e-2, 1e-5, 1e-8] {
        let (closure, warned, lost) = outcome(&scene("explicit_euler", 64, &body), speed);
        println!("{speed} m/s: closure {closure:.1e}, {lost:.1e} J");
        assert!(closure > 0.1 && warned > 0, "{speed} m/s: {closure:.1e}, {lost:.1e} J");
    }
}
