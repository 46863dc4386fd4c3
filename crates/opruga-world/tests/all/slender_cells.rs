//! The excess stiffness of slender cells: the first frequencies of beams and plates against the length of cells in thicknesses of the body. The
//! tables of docs/finite-elements.md are printed by `cargo test -p opruga-world --test all slender_cells:: -- --nocapture`.

#![allow(clippy::disallowed_methods, reason = "shapes, and no bits")]

use crate::common;

use common::{clamp, solid, text};
use opruga_core::spec::Value;
use opruga_mesh::Mesh;
use opruga_world::{Options, Warning, World};

fn world<const D: usize>(mesh: Mesh<D>) -> World<D> {
    let fields = [
        ("material", text("st_venant_kirchhoff")),
        ("youngs_modulus", Value::Number(1e9)),
        ("poissons_ratio", Value::Number(0.3)),
    ];
    let mut blueprint = solid(mesh, "backward_euler", &[], &fields);
    blueprint.bodies[0].pins = clamp();
    World::new(blueprint, Options::default()).expect("a world")
}

/// The warning of slender cells.
fn told<const D: usize>(mesh: Mesh<D>) -> Option<Warning> {
    world(mesh).warnings().into_iter().find(|warning| warning.code == "cells.slender")
}

/// The frequencies of the first modes [rad/s].
fn frequencies<const D: usize>(mesh: Mesh<D>, count: usize) -> Vec<f64> {
    world(mesh).modes(0, count).expect("modes").iter().map(|mode| mode.omega()).collect()
}

/// The largest error of the first frequencies of a body [%].
fn error<const D: usize>(mesh: Mesh<D>, fine: &[f64]) -> f64 {
    let off = frequencies(mesh, fine.len()).into_iter().zip(fine).map(|(found, fine)| 100.0 * (found / fine - 1.0));
    off.fold(0.0, |worst: f64, off| if off.abs() > worst.abs() { off } else { worst })
}

/// Boxes, linear and quadratic simplices.
fn kinds<const D: usize>(boxes: Mesh<D>) -> [Mesh<D>; 3] {
    let linear = boxes.clone().into_simplices().expect("simplices");
    let quadratic = linear.clone().into_quadratic().expect("quadratic simplices");
    [boxes, linear, quadratic]
}

fn beam(along: u32, across: u32, t: f64) -> Mesh<2> {
    Mesh::grid([0.0; 2], [1.0, t], [along, across]).expect("a beam")
}

fn plate(along: u32, across: u32, t: f64) -> Mesh<3> {
    Mesh::grid([0.0; 3], [1.0, 1.0, t], [along, along, across]).expect("a plate")
}

/// A beam clamped at one end, with 16 cells along it: errors by the number of cells across and by the length of cells in thicknesses, for
/// quadrilaterals and for linear and quadratic triangles.
#[test]
fn beams_of_linear_triangles_are_warned_of_from_where_they_bend_45_percent_too_stiffly() {
    println!(
        "| cells across | length : thickness | quadrilaterals | linear triangles | quadratic triangles |\n|---|---|---|---|---|"
    );
    for across in [1, 4] {
        for ratio in [0.25, 0.5, 1.0, 2.0, 8.0, 50.0] {
            let t = 1.0 / (16.0 * ratio);
            let fine = frequencies(beam(64, 4, t), 2);
            let [boxes, linear, quadratic] = kinds(beam(16, across, t));
            let warned = [&boxes, &linear, &quadratic].map(|mesh| told(mesh.clone()).is_some());
            let errors = [boxes, linear, quadratic].map(|mesh| error(mesh, &fine));
            let [a, b, c] = errors.map(|off| format!("{off:+.1} %"));
            println!("| {across} | {ratio} | {a} | {b} | {c} |");
            // One cell across is too few, however short it is.
            let long = ratio >= 1.0 || across == 1;
            assert_eq!(warned, [false, long, false], "{across} {ratio}");
            assert!(!long || errors[1] > 44.0, "{errors:?}");
            assert!(ratio < 1.0 || errors[0].abs() < 3.0 && errors[2].abs() < 3.0, "{errors:?}");
        }
    }
}

/// A square plate clamped at one side, with 6 cells in either direction.
#[test]
fn plates_of_quadratic_tetrahedra_are_warned_of_from_where_they_twist_10_percent_too_stiffly() {
    println!(
        "| cells across | length : thickness | hexahedra | linear tetrahedra | quadratic tetrahedra |\n|---|---|---|---|---|"
    );
    for (across, ratios) in [(1, &[1.0, 3.0, 5.5, 6.5, 12.0, 24.0][..]), (2, &[3.0, 12.0])] {
        for ratio in ratios {
            let t = 1.0 / (6.0 * ratio);
            let fine = frequencies(plate(16, 1, t), 5);
            let [boxes, linear, quadratic] = kinds(plate(6, across, t));
            let warned = [&boxes, &linear, &quadratic].map(|mesh| told(mesh.clone()).is_some());
            let errors = [boxes, linear, quadratic].map(|mesh| error(mesh, &fine));
            let [a, b, c] = errors.map(|off| format!("{off:+.1} %"));
            println!("| {across} | {ratio} | {a} | {b} | {c} |");
            assert_eq!(warned, [false, true, *ratio > 6.0], "{across} {ratio}");
            assert!(errors[0].abs() < 6.0 && errors[1] > 44.0, "{errors:?}");
            assert!(if *ratio > 6.0 { errors[2] > 10.0 } else { errors[2] < 11.0 }, "{errors:?}");
        }
    }
}

/// The published frequencies of a thin square plate clamped at one side, ν = 0.3 (Leissa, "The free vibration of rectangular plates", Journal of
/// Sound and Vibration 31, 1973), which are the reference for the others.
#[test]
fn a_thin_plate_of_hexahedra_has_the_published_frequencies() {
    let t: f64 = 0.004;
    let rigidity = 1e9 * t * t * t / (12.0 * (1.0 - 0.09));
    let unit = (rigidity / (1000.0 * t)).sqrt();
    for (found, published) in frequencies(plate(16, 1, t), 3).into_iter().zip([3.4917, 8.5246, 21.429]) {
        assert!((found / (published * unit) - 1.0).abs() < 0.012, "{} {published}", found / unit);
    }
}

/// Blocks, balls and other thick bodies are not reported, whatever their cells; shells are judged by their thickness.
#[test]
fn thick_bodies_are_not_warned_of_and_curved_ones_are_by_their_thickness() {
    for size in [[1.0, 1.0, 1.0], [2.0, 1.0, 1.5], [4.0, 2.0, 2.0]] {
        let cells = size.map(|x| (2.0 * x) as u32);
        for mesh in kinds(Mesh::<3>::grid([0.3, -1.0, 2.0], size, cells).expect("a block")) {
            assert_eq!(told(mesh), None, "{size:?}");
        }
    }
    // Half a ring of 1 m, 5 cm thick, of tetrahedra of 26 cm or 2.6 cm.
    for (along, warned) in [(12, true), (120, false)] {
        let mut mesh =
            Mesh::<3>::grid([0.0; 3], [1.0; 3], [along, 2, 2]).expect("a grid").into_simplices().expect("simplices");
        for x in &mut mesh.positions {
            let (s, c) = (core::f64::consts::PI * x[0]).sin_cos();
            let r = 1.0 + 0.05 * x[1];
            *x = [-r * c, r * s, 0.05 * x[2]];
        }
        let found = told(mesh);
        assert_eq!(found.is_some(), warned, "{along} {found:?}");
        if let Some(warning) = found {
            assert!(warning.message.contains("thickness of 0.05 m") && warning.count == 1, "{}", warning.message);
        }
    }
}
