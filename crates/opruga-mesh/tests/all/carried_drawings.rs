//! Drawings that bodies in the plane carry: squares around them, and weights that follow every affine motion.
#![allow(clippy::disallowed_methods, reason = "what tests expect needs no equal bits")]

use opruga_mesh::outline::{self, Painted, Ring};
use opruga_mesh::{Mesh, Skin};
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

fn star(radii: &[f64], center: [f64; 2]) -> Ring {
    let n = radii.len() as f64;
    let at = |(k, r): (usize, &f64)| {
        let angle = TAU * k as f64 / n;
        [center[0] + r * angle.cos(), center[1] + r * angle.sin()]
    };
    Ring { points: radii.iter().enumerate().map(at).collect(), part: 0 }
}

fn square(low: f64, high: f64) -> Ring {
    Ring { points: vec![[low, low], [high, low], [high, high], [low, high]], part: 0 }
}

fn nested(mut rings: Vec<Ring>) -> Vec<Ring> {
    outline::nest(&mut rings).expect("rings that do not meet");
    rings
}

/// Whether a point is in one of the squares of a body.
fn covers(mesh: &Mesh<2>, p: [f64; 2]) -> bool {
    mesh.cells.quadrilaterals.iter().any(|q| {
        let (low, high) = (mesh.positions[q[0] as usize], mesh.positions[q[2] as usize]);
        (0..2).all(|a| low[a] - 1e-9 <= p[a] && p[a] <= high[a] + 1e-9)
    })
}

/// The number of edges of the boundary that begin at each node.
fn starts(mesh: &Mesh<2>) -> BTreeMap<u32, usize> {
    let mut counts = BTreeMap::new();
    mesh.facets.iter().for_each(|[a, _]| *counts.entry(*a).or_default() += 1);
    counts
}

/// The painted area of a skin, by its rings and by its triangles.
fn areas(skin: &Skin, positions: &[[f64; 2]]) -> (f64, f64) {
    let points = skin.positions(&positions.iter().map(|p| [p[0], p[1], 0.0]).collect::<Vec<_>>());
    let cross =
        |o: [f64; 3], a: [f64; 3], b: [f64; 3]| 0.5 * ((a[0] - o[0]) * (b[1] - o[1]) - (b[0] - o[0]) * (a[1] - o[1]));
    let ring = |ring: &Vec<u32>| -> f64 {
        (0..ring.len())
            .map(|k| cross([0.0; 3], points[ring[k] as usize], points[ring[(k + 1) % ring.len()] as usize]))
            .sum()
    };
    let mut out = (0.0, 0.0);
    for area in &skin.areas {
        out.0 += area.rings.iter().map(ring).sum::<f64>().abs();
        out.1 += area
            .triangles
            .iter()
            .map(|t| cross(points[t[0] as usize], points[t[1] as usize], points[t[2] as usize]).abs())
            .sum::<f64>();
    }
    out
}

#[test]
fn a_body_of_squares_has_the_holes_that_are_wider_than_a_square() {
    let rings = nested(vec![square(0.0, 4.0), square(1.0, 3.0)]);
    let mesh = outline::squares(&rings, 0.5).expect("squares");
    // The rings are on lines of the lattice, so squares that they touch from outside are included too.
    assert!(mesh.measure().expect("an area").value() >= 12.0);
    assert_eq!(mesh.check(), []);
    let coarse = outline::squares(&rings, 3.0).expect("squares");
    assert_eq!(coarse.components().expect("closed").len(), 1, "the hole is lost between squares of 3");
    assert_eq!(outline::squares(&rings, 0.26).expect("squares").components().expect("closed").len(), 2);
    assert!(matches!(outline::squares(&rings, 1e-6), Err(outline::OutlineError::TooFine { .. })));
    assert!(outline::squares(&rings, f64::NAN).is_err());
}

/// Two squares of the drawing on a diagonal: a third one is added between them.
#[test]
fn squares_never_hang_together_by_a_corner() {
    let rings = nested(vec![square(0.1, 0.9), square(1.1, 1.9)]);
    let mesh = outline::squares(&rings, 0.9).expect("squares");
    assert!(starts(&mesh).values().all(|count| *count == 1), "{:?}", mesh.cells.quadrilaterals);
}

#[test]
fn a_body_without_cells_carries_by_triangles_between_its_nodes() {
    let rings = nested(vec![star(&[1.0; 24], [0.0; 2])]);
    let mut mesh = outline::skin(&rings).expect("a skin");
    let painted = [Painted { rings: vec![star(&[0.3; 9], [0.4, 0.1])], colour: Some([255, 0, 0, 255]) }];
    outline::carry(&mut mesh, &rings, &painted).expect("carried");
    let skin = mesh.skin.as_ref().expect("a skin");
    assert!((areas(skin, &mesh.positions).0 / painted[0].rings[0].area() - 1.0).abs() < 1e-6);
    // The ring expands to twice its size, and the drawing with it.
    let twice: Vec<[f64; 2]> = mesh.positions.iter().map(|p| p.map(|x| 2.0 * x)).collect();
    assert!((areas(skin, &twice).0 / painted[0].rings[0].area() - 4.0).abs() < 1e-5);
    assert_eq!(skin.areas[0].colour, Some([255, 0, 0, 255]));
}

/// A drawing that crosses itself is painted by the even-odd rule.
#[test]
fn areas_that_cross_themselves_are_painted_where_they_are_enclosed_once() {
    let rings = nested(vec![square(-3.0, 3.0)]);
    let mut mesh = outline::squares(&rings, 1.0).expect("squares");
    let cross = Ring { points: vec![[-2.0, -1.0], [2.0, 1.0], [2.0, -1.0], [-2.0, 1.0]], part: 0 };
    let hole = vec![square(-2.0, 2.0), square(-1.0, 1.0)];
    let painted = [Painted { rings: vec![cross], colour: None }, Painted { rings: hole, colour: Some([1, 2, 3, 4]) }];
    outline::carry(&mut mesh, &rings, &painted).expect("carried");
    let (by_rings, _) = areas(mesh.skin.as_ref().expect("a skin"), &mesh.positions);
    assert!((by_rings - (4.0 + 12.0)).abs() < 1e-6, "{by_rings}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 80, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn squares_cover_the_drawing_and_hold_together(radii in proptest::collection::vec(0.2f64..1.0, 3..14), spacing in 0.05f64..0.9) {
        let mut rings = vec![star(&radii, [0.3, -0.2])];
        prop_assume!(outline::nest(&mut rings).is_ok());
        let mesh = outline::squares(&rings, spacing).expect("squares");
        prop_assert!(mesh.measure().expect("an area").value() >= rings[0].area() - 1e-9);
        prop_assert_eq!(mesh.check(), vec![]);
        prop_assert!(starts(&mesh).values().all(|count| *count == 1), "nodes of the boundary are of one loop");
        for (k, p) in rings[0].points.iter().enumerate() {
            let q = rings[0].points[(k + 1) % rings[0].points.len()];
            prop_assert!((0..9).all(|s| covers(&mesh, [0, 1].map(|a| p[a] + f64::from(s) / 8.0 * (q[a] - p[a])))));
        }
    }

    /// If the body moves by an affine map, so does every point of the drawing; at rest it is where it was drawn.
    #[test]
    fn drawings_follow_every_affine_motion(
        radii in proptest::collection::vec(0.3f64..1.0, 5..20),
        map in proptest::array::uniform6(-2.0f64..2.0),
        how in 0..3,
    ) {
        let mut rings = vec![star(&radii, [0.0; 2])];
        prop_assume!(outline::nest(&mut rings).is_ok());
        let mut mesh = match how {
            0 => outline::squares(&rings, 0.3).expect("squares"),
            1 => outline::filled(&rings, 0.3).expect("triangles").0,
            _ => outline::skin(&rings).expect("a skin"),
        };
        // This includes a part outside the body.
        let painted = [Painted { rings: rings.clone(), colour: None }, Painted { rings: vec![star(&[0.2; 7], [1.1, 0.0])], colour: None }];
        outline::carry(&mut mesh, &rings, &painted).expect("carried");
        let skin = mesh.skin.as_ref().expect("a skin");
        let moved = |p: [f64; 3]| [map[0] * p[0] + map[1] * p[1] + map[4], map[2] * p[0] + map[3] * p[1] + map[5], 0.0];
        let rest: Vec<[f64; 3]> = mesh.positions.iter().map(|p| [p[0], p[1], 0.0]).collect();
        let now: Vec<[f64; 3]> = rest.iter().map(|p| moved(*p)).collect();
        for (p, q) in skin.positions(&rest).iter().zip(skin.positions(&now)) {
            let wanted = moved(*p);
            prop_assert!((0..2).all(|a| (wanted[a] - q[a]).abs() < 1e-9), "{:?}: {:?}, not {:?}", p, q, wanted);
        }
        let drawn: f64 = painted.iter().map(|area| area.rings[0].area()).sum();
        let (by_rings, by_triangles) = areas(skin, &mesh.positions);
        prop_assert!((by_rings / drawn - 1.0).abs() < 1e-5 && (by_triangles / drawn - 1.0).abs() < 1e-5, "{} {} {}", by_rings, by_triangles, drawn);
    }
}

/// A body of squares touches with the outline of the drawing, in edges of about half a square, after any motion, and also if mirrored.
#[test]
fn lattices_touch_with_their_outline() {
    let rings = nested(vec![square(0.0, 2.0), square(0.7, 1.3)]);
    let mut mesh = outline::squares(&rings, 0.3).expect("squares");
    outline::carry(&mut mesh, &rings, &[Painted { rings: rings.clone(), colour: None }]).expect("carried");
    let area = |mesh: &Mesh<2>, by: &dyn Fn([f64; 2]) -> [f64; 2]| {
        let surface = mesh.touching_surface(true);
        let nodes: Vec<[f64; 2]> = mesh.positions.iter().map(|p| by(*p)).collect();
        let points = surface.positions(&nodes);
        let length = |[a, b]: &[u32; 2]| {
            let (a, b) = (points[*a as usize], points[*b as usize]);
            (a[0] - b[0]).hypot(a[1] - b[1])
        };
        let longest = surface.facets.iter().map(length).fold(0.0, f64::max);
        (opruga_mesh::signed_volume(&surface.facets, &points), longest, surface.closed == surface.facets.len())
    };
    let (hollow, longest, closed) = area(&mesh, &|p| p);
    assert!((hollow - (4.0 - 0.36)).abs() < 1e-9 && longest < 0.2 && closed, "{hollow} {longest}");
    let (bent, ..) = area(&mesh, &|[x, y]| [x + 0.5 * y, 2.0 * y]);
    assert!((bent - 2.0 * hollow).abs() < 1e-9, "{bent}");
    assert!(mesh.touching_surface(false).carried.is_empty());
    mesh.mirror([1.0, 0.0], [0.0; 2]).expect("mirrored");
    let (mirrored, ..) = area(&mesh, &|p| p);
    assert!((mirrored - hollow).abs() < 1e-9, "{mirrored}");
}

/// Detail that edges of half a square would cross is kept as drawn.
#[test]
fn outlines_too_fine_for_their_squares_keep_their_points() {
    // Two prongs with a slit of a hundredth between them.
    let prongs = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.51, 1.0], [0.5, 0.1], [0.49, 1.0], [0.0, 1.0]];
    let rings = nested(vec![Ring { points: prongs, part: 0 }]);
    let mut mesh = outline::squares(&rings, 0.4).expect("squares");
    outline::carry(&mut mesh, &rings, &[Painted { rings: rings.clone(), colour: None }]).expect("carried");
    let surface = mesh.touching_surface(true);
    let area = opruga_mesh::signed_volume(&surface.facets, &surface.positions(&mesh.positions));
    assert!((area - rings[0].area().abs()).abs() < 0.05 * area, "{area} {}", rings[0].area());
}
