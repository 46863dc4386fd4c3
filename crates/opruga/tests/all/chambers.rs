//! Bodies with several chambers of gas: each chamber has its own readings and colour.
#![allow(clippy::disallowed_methods)] // expected values of the tests' own

use crate::common;
use common::*;
use opruga::World;
use opruga::pictures::{Quantity, Scenery};

/// Two pinned rings of different size in one body, with the same amount of gas in each; the larger has a hole.
fn two() -> World<2> {
    built(plane(&format!(
        "{}[[body]]\nname = \"two\"\nfixed = true\nmodels = [{{ kind = \"pressure\", nRT = 6.0 }}]\n\
         shape = {{ kind = \"rings\", centers = [[0, 0], [2, 0], [0, 0]], radii = [0.5, 0.3, -0.2], vertices = 40 }}\n",
        head(0.02, 20, 0.0, "symplectic_euler")
    )))
}

/// The area of a polygon of 40 corners on a circle [m²].
fn area(radius: f64) -> f64 {
    20.0 * radius * radius * f64::sin(std::f64::consts::TAU / 40.0)
}

#[test]
fn every_chamber_has_volume_pressure_and_amount_of_its_own() {
    let readings = two().readings(0);
    let volumes = [area(0.5) - area(0.2), area(0.3)];
    let expected = [
        ("volume", volumes[0] + volumes[1]),
        ("pressure", 12.0 / (volumes[0] + volumes[1])),
        ("nRT", 12.0),
        ("chamber1.volume", volumes[0]),
        ("chamber1.pressure", 6.0 / volumes[0]),
        ("chamber1.nRT", 6.0),
        ("chamber2.volume", volumes[1]),
        ("chamber2.pressure", 6.0 / volumes[1]),
        ("chamber2.nRT", 6.0),
    ];
    assert_eq!(readings.len(), expected.len(), "{readings:?}");
    for ((name, value), (expected_name, expected)) in readings.iter().zip(expected) {
        assert_eq!(name, expected_name);
        assert!((value - expected).abs() < 1e-12 * expected, "{name}: {value}, not {expected}");
    }
}

/// The readings of a body with one chamber have no numbers.
#[test]
fn the_only_chamber_has_no_number() {
    let mut world = built(plane(&format!(
        "{}[[body]]\nname = \"one\"\nshape = {{ kind = \"ring\", radius = 0.5, vertices = 40 }}\nmodels = [{{ kind = \"pressure\", nRT = 6.0 }}]\nmass = 1\n",
        head(0.02, 20, 0.0, "symplectic_euler")
    )));
    let names: Vec<String> = world.readings(0).into_iter().map(|(name, _)| name.into_owned()).collect();
    assert_eq!(names, ["volume", "pressure", "nRT"]);
}

/// The nodes of a hole bound the chamber around it.
#[test]
fn pressure_colours_every_chamber_by_its_own() {
    let mut world = two();
    let scenery = Scenery::new(&world);
    let picture = scenery.picture(&scenery.capture_quantity(&mut world, false, Quantity::Pressure));
    let larger = 6.0 / (area(0.5) - area(0.2));
    for (ring, pressure) in [larger, 6.0 / area(0.3), larger].into_iter().enumerate() {
        for scalar in &picture.bodies[0].scalar[40 * ring..40 * (ring + 1)] {
            assert!((scalar - pressure).abs() < 1e-5 * pressure, "ring {ring}: {scalar}, not {pressure}");
        }
    }
}

/// If springs are requested, they are drawn with their nodes, however little space there is for dots.
#[test]
fn springs_that_are_asked_for_bring_their_nodes() {
    let mut world = built(plane(opruga::scenes::find("ball").expect("a scene")));
    let mut scenery = Scenery::new(&world);
    let picture = scenery.picture(&scenery.capture(&mut world, false));
    let spacing = picture.bodies[0].node_spacing.expect("dots where they have room");
    assert!((spacing - std::f64::consts::TAU * 0.5 / 36.0).abs() < 1e-3, "{spacing}");
    scenery.show_springs(&world);
    let picture = scenery.picture(&scenery.capture(&mut world, false));
    assert!(picture.bodies[0].nodes_drawn && picture.bodies[0].node_spacing.is_none());
}
