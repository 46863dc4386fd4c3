//! The energy of bodies in free flight with implicit integrators: the tables of docs/finite-elements.md.
#![allow(clippy::disallowed_methods)] // expected values of the tests' own

use crate::common;

use common::{built, head, plane};

/// The table of docs/finite-elements.md: the largest relative error of the energy of a soft block that flies and spins.
#[test]
fn in_free_flight_rules_of_second_order_keep_the_energy_within_their_error() {
    let text = |rule: &str, substeps: u32| {
        head(1.0 / 60.0, substeps, 0.0, rule)
            + "[[body]]\nname = \"block\"\nshape = { kind = \"grid\", size = [0.4, 0.2], cells = [8, 4] }\ndensity = 1000.0\n\
               velocity = [1.0, 2.0]\nangular_velocity = 6.0\nmodels = [{ kind = \"fem\", youngs_modulus = 1e5 }]\n"
    };
    // Frames of 1/60 s in 1 and 4 steps.
    for (rule, limits, order) in [
        ("implicit_midpoint", [1.2e-3, 5e-5], 2.0),
        ("newmark", [1.5e-3, 1e-4], 2.0),
        ("bdf2", [8e-3, 9e-4], 1.5),
        ("backward_euler", [0.12, 0.09], 0.3),
    ] {
        let missed = [1, 4].map(|substeps| {
            let mut world = built(plane(&text(rule, substeps)));
            let start = world.energy().total();
            (0..300).fold(0.0, |most: f64, _| {
                world.frame().unwrap_or_else(|e| panic!("{rule}: {e}"));
                most.max((world.energy().total() / start - 1.0).abs())
            })
        });
        println!("{rule}: {:.1e} and {:.1e} of the energy", missed[0], missed[1]);
        assert!(missed[0] < limits[0] && missed[1] < limits[1], "{rule}: {missed:?}");
        assert!((missed[0] / missed[1]).ln() / 4.0f64.ln() > order - 0.25, "{rule}: {missed:?}");
    }
}

/// The second table: a block that is released from seven tenths of its height vibrates with strains of a third. Its slowest period is about thirteen
/// steps of 1/60 s (E = 10⁴ Pa), or four (10⁵ Pa); in the latter case the energy grows without bound with the first two integrators.
#[test]
fn a_block_that_trembles_by_a_third_misses_less_of_its_energy_in_shorter_steps() {
    // The largest relative gain and loss of the initial energy, and when a step was refused.
    let missed = |rule: &str, modulus: f64, substeps: u32| {
        let mut world = built(plane(
            &(head(1.0 / 60.0, substeps, 0.0, rule)
                + &format!(
                    "[[body]]\nname = \"block\"\nshape = {{ kind = \"grid\", size = [0.4, 0.4], cells = [8, 8] }}\n\
                     density = 1000.0\nmodels = [{{ kind = \"fem\", youngs_modulus = {modulus:?} }}]\n"
                )),
        ));
        for node in 0..world.node_count(0) as u32 {
            let [x, y] = world.position(0, node);
            world.set_node(0, node, [x, 0.7 * y], [-3.0 * 0.7 * y, 3.0 * x]).expect("a place");
        }
        let start = world.energy().total();
        let (mut gain, mut loss) = (0.0f64, 0.0f64);
        for frame in 0..300 {
            if world.frame().is_err() {
                return (gain, loss, Some(f64::from(frame) / 60.0));
            }
            let off = world.energy().total() / start - 1.0;
            (gain, loss) = (gain.max(off), loss.max(-off));
        }
        (gain, loss, None)
    };
    for (rule, limits) in [("implicit_midpoint", [0.12, 0.01]), ("newmark", [0.17, 0.02])] {
        let errors = [1, 4].map(|substeps| {
            let (gain, loss, refused) = missed(rule, 1e4, substeps);
            println!("{rule}, 1e4 Pa, 1/{} s: {gain:.1e} gained, {loss:.1e} lost", 60 * substeps);
            assert_eq!(refused, None, "{rule}");
            gain.max(loss)
        });
        assert!(errors[0] < limits[0] && errors[1] < limits[1], "{rule}: {errors:?}");
        assert!((errors[0] / errors[1]).ln() / 4.0f64.ln() > 1.3, "{rule}: {errors:?}");
    }
    for rule in ["bdf2", "backward_euler"] {
        for (modulus, substeps) in [(1e4, 1), (1e4, 4), (1e5, 1), (1e5, 4)] {
            let (gain, loss, refused) = missed(rule, modulus, substeps);
            println!("{rule}, {modulus:e} Pa, 1/{} s: {loss:.1e} lost", 60 * substeps);
            assert!(gain < 1e-9 && refused.is_none(), "{rule}: {gain} {refused:?}");
        }
    }
    for (rule, substeps) in [("implicit_midpoint", 1), ("implicit_midpoint", 4), ("newmark", 1), ("newmark", 4)] {
        let (gain, loss, refused) = missed(rule, 1e5, substeps);
        println!("{rule}, 1e5 Pa, 1/{} s: {gain:.1e} gained, {loss:.1e} lost, refused at {refused:?} s", 60 * substeps);
        assert!(substeps == 1 || refused.is_none() && gain.max(loss) < 0.2, "{rule}: {gain} {loss} {refused:?}");
    }
}
