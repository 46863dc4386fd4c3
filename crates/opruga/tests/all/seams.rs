//! Adjacent obstacles, and impacts that end exactly on a surface, with every integrator.
#![allow(clippy::disallowed_methods)] // sines and roots of the tests' own

use crate::common;
use common::*;

/// All integrators that step through time.
fn rules() -> Vec<&'static str> {
    opruga::catalogue().integrators.iter().map(|spec| spec.kind).filter(|kind| *kind != "equilibrium").collect()
}

/// Two adjacent nodes above the seam of two boxes at x = 0 stay on them; so does one exactly above it.
#[test]
fn what_falls_onto_a_seam_lies_on_it() {
    for rule in rules() {
        for x in [0.0, 1e-9, -1e-6, 1e-3] {
            for convex in [false, true] {
                let obstacle = |low: f64, high: f64| match convex {
                    false => format!("kind = \"box\"\nmin = [{low:?}, -1]\nmax = [{high:?}, 0]\n"),
                    true => format!(
                        "kind = \"convex\"\npoints = [[{low:?}, -1], [{high:?}, -1], [{high:?}, 0], [{low:?}, 0]]\n"
                    ),
                };
                let text = head(0.01, 8, -9.81, rule)
                    + &format!(
                        "[[body]]\nname = \"b\"\nshape = {{ kind = \"line\", from = [{:?}, 0.05], to = [{x:?}, 0.05], segments = 1 }}\n\
                         node_mass = 1.0\nmodels = [{{ kind = \"mass_spring\", stiffness = 500.0, damping = 5.0 }}]\n\
                         [[collider]]\n{}[[collider]]\n{}",
                        x - 0.3,
                        obstacle(-2.0, 0.0),
                        obstacle(0.0, 2.0)
                    );
                let mut world = built(plane(&text));
                frames(&mut world, 100);
                for node in 0..2 {
                    let [_, y] = world.position(0, node);
                    assert!(y.abs() < 1e-4, "{rule}, x = {x}, convex {convex}: node {node} at {y}");
                }
            }
        }
    }
}

/// From 0.3 m at 1 m/s, a step ends on the surface to the last digit: the node bounces with e = 0.8 of its speed.
#[test]
fn an_impact_that_ends_exactly_on_the_surface_is_one() {
    for rule in rules() {
        for (height, frame) in [(0.3, 1.0 / 60.0), (0.25, 1.0 / 64.0), (0.5, 0.02)] {
            let text = head(frame, 1, 0.0, rule)
                + &format!(
                    "[[body]]\nname = \"b\"\nshape = {{ kind = \"line\", from = [0, {height:?}], to = [0.2, {height:?}], segments = 1 }}\n\
                     node_mass = 1.0\nvelocity = [0, -1]\nmodels = []\n\
                     [[collider]]\nkind = \"half_space\"\nnormal = [0, 1]\nrestitution = 0.8\n"
                );
            let mut world = built(plane(&text));
            frames(&mut world, (2.0 * height / frame).round() as u64);
            for node in 0..2 {
                let [_, v] = world.velocity(0, node);
                assert!((v - 0.8).abs() < 1e-9, "{rule}, {height} m: {v} m/s");
            }
        }
    }
}
