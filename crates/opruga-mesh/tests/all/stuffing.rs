//! Tetrahedra in closed surfaces: angles within their bounds for any surface, volumes that converge, boundaries on the surface.

use opruga_mesh::{LARGEST_DIHEDRAL_ANGLE, Mesh, MeshError, SMALLEST_DIHEDRAL_ANGLE};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use std::f64::consts::PI;

/// The triangles of Spot the cow.
fn spot() -> Mesh<3> {
    let text = include_str!("../../../../scenes/shapes/spot.obj");
    let mut mesh = Mesh::<3>::default();
    for line in text.lines() {
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        match words.first() {
            Some(&"v") => mesh.positions.push(std::array::from_fn(|d| words[d + 1].parse().unwrap())),
            Some(&"f") => mesh
                .facets
                .push(std::array::from_fn(|k| words[k + 1].split('/').next().unwrap().parse::<u32>().unwrap() - 1)),
            _ => {}
        }
    }
    mesh
}

/// The filling, after checks that apply to all fillings.
fn filled(surface: &Mesh<3>, spacing: f64) -> Mesh<3> {
    let body = surface.tetrahedra_filling(spacing).unwrap();
    sound(surface, spacing, &body);
    body
}

fn sound(surface: &Mesh<3>, spacing: f64, body: &Mesh<3>) {
    let quality = body.cell_quality().unwrap();
    let degrees = |angle: f64| angle * 180.0 / PI;
    println!(
        "spacing {spacing}: {} nodes, {} tetrahedra, {:.3}° to {:.3}°, volume {:.5} of {:.5}, euler {}, components {}",
        body.nodes(),
        quality.cells,
        degrees(quality.smallest_angle),
        degrees(quality.largest_angle),
        quality.measure,
        surface.enclosed_volume(),
        body.euler_characteristic(),
        body.components().map_or_else(|e| e.to_string(), |c| c.len().to_string()),
    );
    assert_eq!(quality.inverted, 0);
    assert!(degrees(quality.smallest_angle) >= SMALLEST_DIHEDRAL_ANGLE, "{quality:?}");
    assert!(degrees(quality.largest_angle) <= LARGEST_DIHEDRAL_ANGLE, "{quality:?}");
    assert!(body.unreferenced_nodes().is_empty());
    assert!(body.chambers().is_ok(), "the boundary is closed and touches itself along no edge");
}

#[test]
fn spot_torus_and_sphere_are_filled_with_good_angles_and_their_volume() {
    let (spot, torus, sphere) = (spot(), Mesh::torus(1.0, 0.4, [96, 48]).unwrap(), Mesh::icosphere(1.0, 4).unwrap());
    for (name, surface, spacing, genus, tolerance) in
        [("spot", &spot, 0.16, 0, 0.06), ("torus", &torus, 0.28, 1, 0.06), ("sphere", &sphere, 0.4, 0, 0.06)]
    {
        let mut last = f64::INFINITY;
        for halving in [1.0, 2.0, 4.0] {
            let body = filled(surface, spacing / halving);
            let error = (body.cell_quality().unwrap().measure / surface.enclosed_volume() - 1.0).abs();
            println!("{name}: {error:e}");
            // Second order: the error falls to about a quarter with every halving, with some noise.
            assert!(error < 0.5 * last, "{name}: {error} after {last}");
            last = error;
            if halving > 1.0 {
                assert_eq!(body.euler_characteristic(), 2 - 2 * genus, "{name}");
            }
        }
        assert!(last < tolerance / 16.0, "{name}: {last}");
    }
}

#[test]
fn boundary_nodes_lie_on_the_surface() {
    let sphere = Mesh::icosphere(1.0, 5).unwrap();
    let body = filled(&sphere, 0.25);
    for node in body.facets.iter().flatten() {
        let r = body.positions[*node as usize].iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!((0.998..=1.0 + 1e-12).contains(&r), "a boundary node at {r}");
    }
}

#[test]
fn sharp_boxes_are_rounded_within_a_spacing() {
    let mut cube = Mesh::box_surface([0.0; 3], [1.0, 0.7, 0.5], [1, 1, 1]).unwrap();
    cube.rotate([1.0, 2.0, 3.0], 0.7, [0.0; 3]).unwrap();
    let mut body = filled(&cube, 0.1);
    let volume = body.cell_quality().unwrap().measure;
    assert!((0.95..0.999).contains(&(volume / 0.35)), "{volume}");
    body.rotate([1.0, 2.0, 3.0], -0.7, [0.0; 3]).unwrap();
    for point in &body.positions {
        assert!((0..3).all(|d| (-1e-9..=[1.0, 0.7, 0.5][d] + 1e-9).contains(&point[d])), "{point:?}");
    }
    assert!(cube.tetrahedra_filling(40.0).is_err(), "nothing fits");
    assert!(cube.tetrahedra_filling(0.0).is_err() && cube.tetrahedra_filling(1e-9).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, rng_seed: RngSeed::Fixed(7), ..ProptestConfig::default() })]

    /// Unusually coarse meshes: the bounds hold nevertheless.
    #[test]
    fn angles_keep_their_bounds_on_any_surface(
        stretch in prop::array::uniform3(0.3..2.0f64),
        dents in prop::collection::vec(-0.35..0.5f64, 42),
        turn in prop::array::uniform3(-2.0..2.0f64),
        spacing in 0.09..0.5f64,
    ) {
        let mut surface = Mesh::icosphere(1.0, 1).unwrap();
        for (position, dent) in surface.positions.iter_mut().zip(&dents) {
            *position = position.map(|x| x * (1.0 + dent));
        }
        surface.scale(stretch, [0.0; 3]).unwrap();
        surface.rotate([turn[0], turn[1], 1.0], turn[2], [0.1, 0.2, 0.3]).unwrap();
        let body = match surface.tetrahedra_filling(spacing) {
            Ok(body) => body,
            Err(MeshError::Torn { .. }) => return Ok(()),
            Err(error) => panic!("{error}"),
        };
        sound(&surface, spacing, &body);
        let ratio = body.cell_quality().unwrap().measure / surface.enclosed_volume();
        prop_assert!((0.4..1.3).contains(&ratio), "{ratio}");
    }
}
