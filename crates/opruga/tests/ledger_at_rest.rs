//! The ledger of bodies in which nothing moves: what rounding makes of them is no error of an integrator.

use opruga::blueprint::AnyBlueprint;
use opruga::io::scene;
use opruga::{Options, World, catalogue};

/// A body without gravity and obstacles, at rest in its shape.
const BODIES: [(usize, &str); 5] = [
    (
        2,
        "mass = 1.0\nshape = { kind = \"ring\", radius = 0.37, vertices = 29 }\nmodels = [{ kind = \"mass_spring\", stiffness = 900.0, damping = 0.3 }]",
    ),
    (
        2,
        "mass = 0.02\nshape = { kind = \"grid\", size = [1.3, 0.7], cells = [5, 3], corner = [100.1, -30.3] }\nmodels = [{ kind = \"mass_spring\", stiffness = 400.0, edges = \"shear\" }]",
    ),
    (
        2,
        "density = 800.0\nshape = { kind = \"grid\", size = [0.13, 0.07], cells = [5, 3] }\nrotation = 0.4\nmodels = [{ kind = \"fem\", material = \"neo_hookean\", youngs_modulus = 3e4, poissons_ratio = 0.3 }]",
    ),
    (
        3,
        "density = 1000.0\nshape = { kind = \"grid\", size = [0.6, 0.5, 0.4], cells = [3, 2, 2] }\nrotation = [0.5, 0.3, 0.4]\nmodels = [{ kind = \"fem\", material = \"stable_neo_hookean\", youngs_modulus = 2e4, poissons_ratio = 0.45 }]",
    ),
    (
        3,
        "density = 1000.0\nshape = { kind = \"grid\", size = [0.6, 0.5, 0.4], cells = [3, 2, 2], corner = [5.0, 7.0, 9.0] }\nmodels = [{ kind = \"fem\", material = \"corotated\", youngs_modulus = 2e7, poissons_ratio = 0.3, damping = 0.001 }]",
    ),
];

fn scene(dimension: usize, rule: &str, substeps: u32, body: &str) -> String {
    format!(
        "format = \"opruga-1\"\ndimension = {dimension}\n[time]\nseconds = 9.0\nsubsteps = {substeps}\n[world]\n\
         gravity = {:?}\n[integrator]\nkind = \"{rule}\"\n[[body]]\nname = \"it\"\n{body}\n",
        vec![0.0; dimension]
    )
}

/// The closure at the end of a second, how often it was warned of, and what has no cause [J]. The first node begins with a
/// speed along x [m/s].
fn outcome(text: &str, speed: f64) -> (f64, u64, f64) {
    fn of<const D: usize>(mut world: World<D>, speed: f64) -> (f64, u64, f64) {
        if speed > 0.0 {
            let velocity = core::array::from_fn(|axis| if axis == 0 { speed } else { 0.0 });
            world.place_node(0, 0, world.position(0, 0), velocity).expect("placed");
        }
        (0..60).for_each(|_| world.frame().expect("a frame"));
        let warned = world.warnings().into_iter().find(|warning| warning.code == "ledger.closure");
        (world.energy().closure, warned.map_or(0, |warning| warning.count), world.energy().loss_integrator)
    }
    let options = Options { allow_unstable: true, ..Options::default() };
    match scene::read(text.as_bytes(), "test.toml", &catalogue(), &scene::Options::default()) {
        Ok((AnyBlueprint::Plane(blueprint), _)) => of(World::new(blueprint, options).expect("a world"), speed),
        Ok((AnyBlueprint::Space(blueprint), _)) => of(World::new(blueprint, options).expect("a world"), speed),
        Err(errors) => panic!("{text}\n{}", errors[0]),
    }
}

#[test]
fn a_body_at_rest_without_gravity_has_a_closed_ledger() {
    let explicit = ["symplectic_euler", "verlet", "heun", "runge_kutta"].map(|rule| (rule, 64));
    let implicit = ["backward_euler", "implicit_midpoint", "newmark", "bdf2"].map(|rule| (rule, 1));
    for (number, (dimension, body)) in BODIES.iter().enumerate() {
        for (rule, substeps) in explicit.iter().chain(&implicit) {
            // The stiffest one is too stiff for explicit steps of a quarter of a millisecond.
            if number == 4 && *substeps > 1 {
                continue;
            }
            let (closure, warned, lost) = outcome(&scene(*dimension, rule, *substeps, body), 0.0);
            println!("{rule}, body {number}: closure {closure:.1e}, {lost:.1e} J");
            assert!(closure < 0.01 && warned == 0, "{rule}, body {number}: {closure:.1e}, {lost:.1e} J");
        }
    }
}

/// A motion however slow is none of rounding: what explicit Euler adds to it is seen.
#[test]
fn an_open_ledger_of_a_slow_motion_is_warned_of() {
    let body = BODIES[0].1.replace("damping = 0.3", "damping = 0.0");
    for speed in [1e-2, 1e-5, 1e-8] {
        let (closure, warned, lost) = outcome(&scene(2, "explicit_euler", 64, &body), speed);
        println!("{speed} m/s: closure {closure:.1e}, {lost:.1e} J");
        assert!(closure > 0.1 && warned > 0, "{speed} m/s: {closure:.1e}, {lost:.1e} J");
    }
}
