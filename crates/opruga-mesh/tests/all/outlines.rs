//! Closed curves: holes, spacing, fillings, overlaps.
#![allow(clippy::disallowed_methods, reason = "what tests expect needs no equal bits")]

use opruga_mesh::outline::{self, Cause, OutlineError, Overlap, Ring, Thin};
use opruga_mesh::{CellQuality, Mesh, signed_volume};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

fn circle(center: [f64; 2], radius: f64, n: u32) -> Ring {
    let at = |k: u32| TAU * f64::from(k) / f64::from(n);
    let points = (0..n).map(|k| [center[0] + radius * libm::cos(at(k)), center[1] + radius * libm::sin(at(k))]);
    Ring { points: points.collect(), part: 0 }
}

fn square(low: f64, high: f64, part: u32) -> Ring {
    Ring { points: vec![[low, low], [high, low], [high, high], [low, high]], part }
}

fn quality(mesh: &Mesh<2>) -> CellQuality {
    mesh.cell_quality().expect("triangles")
}

/// Whether the refinement of a filling was completed.
fn complete(thin: Option<Thin>) -> bool {
    thin.is_none_or(|thin| thin.cause != Cause::Unfinished)
}

fn total(rings: &[Ring]) -> f64 {
    rings.iter().map(Ring::area).sum()
}

#[test]
fn rings_in_rings_are_holes_and_islands_whichever_way_they_run() {
    for mask in 0..8u32 {
        let mut rings = vec![square(0.0, 4.0, 0), square(1.0, 3.0, 1), square(1.5, 2.5, 2)];
        let mut wrong = 0;
        for (k, ring) in rings.iter_mut().enumerate() {
            if mask >> k & 1 == 1 {
                ring.points.reverse();
            }
            // Rings at an even depth run counter-clockwise.
            wrong += usize::from((ring.area() > 0.0) != (k % 2 == 0));
        }
        assert_eq!(outline::nest(&mut rings), Ok(wrong));
        assert_eq!(total(&rings), 16.0 - 4.0 + 1.0);
        let mesh = outline::skin(&rings).expect("a skin");
        assert_eq!(mesh.chambers().expect("chambers").len(), 2, "the ring with its hole, and the island in it");
    }
}

#[test]
fn rings_that_cross_or_touch_are_refused_with_the_place() {
    let mut rings = vec![square(0.0, 2.0, 3), square(1.0, 3.0, 7)];
    let Err(OutlineError::Meeting { parts, position, .. }) = outline::nest(&mut rings) else { panic!("they cross") };
    assert_eq!(parts, [3, 7]);
    assert!([[2.0, 1.0], [1.0, 2.0]].contains(&position), "{position:?}");
    let mut touching = vec![square(0.0, 1.0, 0), square(1.0, 2.0, 1)];
    assert!(matches!(outline::nest(&mut touching), Err(OutlineError::Meeting { .. })));
    let mut eight = vec![Ring { points: vec![[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 1.0]], part: 0 }];
    assert!(matches!(outline::nest(&mut eight), Err(OutlineError::Meeting { .. })));
}

#[test]
fn rings_without_area_or_with_broken_numbers_are_refused() {
    assert_eq!(outline::nest(&mut []), Err(OutlineError::Empty {}));
    let line = Ring { points: vec![[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]], part: 4 };
    assert!(matches!(outline::nest(&mut [line]), Err(OutlineError::NoArea { part: 4, .. })));
    let broken = Ring { points: vec![[0.0, 0.0], [1.0, f64::NAN], [2.0, 2.0]], part: 5 };
    assert!(matches!(outline::nest(&mut [broken]), Err(OutlineError::NotFinite { part: 5, .. })));
}

#[test]
fn a_resampled_circle_is_a_regular_polygon() {
    let rings = outline::resampled(&[circle([3.0, 4.0], 1.0, 5000)], 0.1).expect("a circle");
    let ring = &rings[0];
    assert_eq!(ring.points.len(), 63, "2π / 0.1 rounded");
    let edges: Vec<f64> = (0..63)
        .map(|k| {
            let (a, b) = (ring.points[k], ring.points[(k + 1) % 63]);
            ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)).sqrt()
        })
        .collect();
    for edge in &edges {
        assert!((edge / edges[0] - 1.0).abs() < 1e-4, "{edge} and {}", edges[0]);
    }
    assert!((ring.area() - 0.5 * 63.0 * (TAU / 63.0).sin()).abs() < 1e-5);
}

#[test]
fn corners_stay_where_they_are() {
    let rings = outline::resampled(&[square(0.0, 1.0, 0)], 0.15).expect("a square");
    assert_eq!(rings[0].points.len(), 4 * 7);
    for corner in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]] {
        assert!(rings[0].points.contains(&corner), "{corner:?}");
    }
    assert!((rings[0].area() - 1.0).abs() < 1e-14);
}

/// The corners of a regular polygon turn by 360° divided by their number: turns by 45° and by 40° are corners, a turn by 30° is a curve.
#[test]
fn blunt_corners_stay_and_curves_are_cut_evenly() {
    for (corners, stay) in [(8, true), (9, true), (12, false)] {
        let polygon = circle([0.5, -0.25], 1.0, corners);
        let rings = outline::resampled(std::slice::from_ref(&polygon), 0.45).expect("a polygon");
        let kept = polygon.points.iter().filter(|point| rings[0].points.contains(point)).count();
        assert_eq!(kept == corners as usize, stay, "{kept} of {corners}");
    }
}

#[test]
fn a_spacing_that_makes_edges_cross_is_refused() {
    // A hole that nearly fills its outline: there is no space for long chords between them.
    let mut rings = vec![circle([0.0, 0.0], 1.0, 400), circle([0.0, 0.0], 0.99, 400)];
    outline::nest(&mut rings).expect("they do not touch");
    assert!(outline::resampled(&rings, 0.02).is_ok());
    assert!(matches!(outline::resampled(&rings, 0.5), Err(OutlineError::TooCoarse { .. })));
}

#[test]
fn a_filled_disc_has_the_area_of_its_outline_and_good_angles() {
    for spacing in [0.3, 0.1, 0.05, 0.02] {
        let rings = outline::resampled(&[circle([1.0, -2.0], 1.0, 2000)], spacing).expect("a circle");
        let (mesh, thin) = outline::filled(&rings, spacing).expect("a filling");
        let quality = quality(&mesh);
        let area = mesh.measure().expect("an area").value();
        assert!((area / total(&rings) - 1.0).abs() < 1e-12, "{area}");
        assert!((signed_volume(&mesh.facets, &mesh.positions) / area - 1.0).abs() < 1e-12);
        assert!(thin.is_none() && quality.smallest_angle >= 25.0 / 180.0 * PI, "{quality:?}");
        assert!(quality.longest_edge < 1.75 * spacing && quality.shortest_edge > 0.4 * spacing, "{quality:?}");
        assert_eq!(mesh.check(), [], "spacing {spacing}");
        // One disc: V − E + T = 1.
        let edges = mesh.edges(opruga_mesh::EdgeSet::All).len();
        assert_eq!(mesh.nodes() as i64 - edges as i64 + mesh.cells.len() as i64, 1);
        let equilateral = 4.0 * area / 3f64.sqrt() / spacing / spacing;
        assert!((mesh.cells.len() as f64 / equilateral - 1.0).abs() < 0.25, "{} triangles", mesh.cells.len());
    }
}

#[test]
fn holes_stay_empty_and_islands_in_holes_are_filled() {
    let mut rings = vec![circle([0.0; 2], 1.0, 300), circle([0.0; 2], 0.6, 200), circle([0.0; 2], 0.3, 100)];
    outline::nest(&mut rings).expect("rings");
    let rings = outline::resampled(&rings, 0.05).expect("rings");
    let (mesh, thin) = outline::filled(&rings, 0.05).expect("a filling");
    assert!((mesh.measure().expect("an area").value() - total(&rings)).abs() < 1e-12);
    assert!(thin.is_none() && quality(&mesh).smallest_angle >= 25.0 / 180.0 * PI);
    let edges = mesh.edges(opruga_mesh::EdgeSet::All).len();
    assert_eq!(mesh.nodes() as i64 - edges as i64 + mesh.cells.len() as i64, 1, "an annulus (0) and a disc (1)");
}

#[test]
fn a_filling_is_the_same_bits_every_time() {
    let rings = outline::resampled(&[circle([0.0; 2], 1.0, 400), circle([3.0, 0.0], 1.0, 400)], 0.07).expect("rings");
    let (first, _) = outline::filled(&rings, 0.07).expect("a filling");
    for _ in 0..3 {
        assert_eq!(outline::filled(&rings, 0.07).expect("a filling").0, first);
    }
}

#[test]
fn a_thin_slanted_outline_is_filled_in_time_with_its_length() {
    let (far, wide) = (2e3, 3.0);
    let strip = Ring { points: vec![[0.0, 0.0], [far, far], [far, far + wide], [0.0, wide]], part: 0 };
    let rings = outline::resampled(&[strip], 1.0).expect("a strip");
    let (mesh, _) = outline::filled(&rings, 1.0).expect("a filling");
    let quality = quality(&mesh);
    let area = mesh.measure().expect("an area").value();
    assert!((area / total(&rings) - 1.0).abs() < 1e-9, "{area}, {}, {}", total(&rings), far * wide);
    assert!(quality.smallest_angle > 10.0 / 180.0 * PI, "{quality:?}");
}

#[test]
fn joined_parts_cover_what_they_should() {
    let parts = [square(0.0, 2.0, 0), square(1.0, 3.0, 1)];
    let union = outline::joined(&parts, Overlap::Union);
    assert_eq!(union.len(), 1);
    assert!((total(&union).abs() - 7.0).abs() < 1e-6);
    let mut odd = outline::joined(&parts, Overlap::EvenOdd);
    assert!((odd.iter().map(|r| r.area().abs()).sum::<f64>() - 6.0).abs() < 1e-6);
    // A hole of one part that another part covers is not a hole.
    let mut ring = vec![square(0.0, 4.0, 0), square(1.0, 3.0, 0), square(0.5, 3.5, 1)];
    ring[1].points.reverse();
    let filled = outline::joined(&ring, Overlap::Union);
    assert_eq!(filled.len(), 1);
    assert!((total(&filled).abs() - 16.0).abs() < 1e-6);
    // Parts that do not meet are unchanged.
    odd = outline::joined(&[square(0.0, 1.0, 0), square(5.0, 6.0, 1)], Overlap::Union);
    assert_eq!(odd.len(), 2);
}

fn ring(points: &[[f64; 2]]) -> Ring {
    Ring { points: points.to_vec(), part: 0 }
}

/// The rings that bound a body. Its area must have the expected value, also if triangles fill it.
fn body_of(rings: &[Ring], how: Overlap, wanted: f64, pieces: usize) -> Vec<Ring> {
    let mut made = outline::joined(rings, how);
    outline::nest(&mut made).expect("rings that meet nowhere");
    assert!((total(&made) / wanted - 1.0).abs() < 1e-8, "{how:?}: {} instead of {wanted}", total(&made));
    let mesh = outline::skin(&made).expect("a skin");
    assert_eq!(mesh.chambers().expect("closed").len(), pieces, "{how:?}");
    let (low, high) = outline::bounds(&made).expect("points");
    let spacing = 0.05 * (high[0] - low[0]);
    let coarse = outline::resampled(&made, spacing).expect("equal edges");
    for rings in [&made, &coarse] {
        let (filling, thin) = outline::filled(rings, spacing).expect("a filling");
        let quality = quality(&filling);
        let area = filling.measure().expect("an area").value();
        assert!((area / total(rings) - 1.0).abs() < 1e-9, "{how:?}: {area} instead of {}", total(rings));
        assert!(complete(thin) && quality.smallest_angle > 0.1, "{quality:?}");
        assert_eq!(filling.chambers().expect("closed").len(), pieces, "{how:?}");
    }
    made
}

#[test]
fn a_pentagram_has_the_area_of_its_tips_or_of_the_whole_star() {
    let points: Vec<[f64; 2]> =
        (0..5).map(|k| TAU * (0.25 + 0.4 * f64::from(k))).map(|a| [3.0 + a.cos(), 5.0 + a.sin()]).collect();
    let star = [ring(&points)];
    // The inner pentagon has a radius of φ⁻².
    let inner = ((3.0 - 5f64.sqrt()) / 2.0, 72f64.to_radians());
    let whole = 5.0 * inner.0 * 36f64.to_radians().sin();
    let tips = whole - 2.5 * inner.0 * inner.0 * inner.1.sin();
    // A single part follows the even-odd rule, whatever the rule between parts.
    body_of(&star, Overlap::EvenOdd, tips, 5);
    body_of(&star, Overlap::Union, tips, 5);
    let wound = outline::wound(&star);
    assert!(wound.len() == 1 && (total(&wound) / whole - 1.0).abs() < 1e-8, "{}", total(&wound));
}

#[test]
fn two_discs_leave_two_crescents_or_one_silhouette() {
    let mut discs = [circle([0.0, 0.0], 1.0, 4000), circle([1.0, 0.0], 1.0, 4000)];
    discs[1].part = 1;
    let lens = 2.0 * PI / 3.0 - 0.75f64.sqrt();
    let disc = discs[0].area();
    assert!((disc / PI - 1.0).abs() < 1e-6);
    let near = |rings: &[Ring], wanted: f64| assert!((total(rings) / wanted - 1.0).abs() < 2e-6, "{}", total(rings));
    for (how, wanted, pieces) in [(Overlap::EvenOdd, 2.0 * (PI - lens), 2), (Overlap::Union, 2.0 * PI - lens, 1)] {
        let mut made = outline::joined(&discs, how);
        outline::nest(&mut made).expect("rings that meet nowhere");
        near(&made, wanted);
        let coarse = outline::resampled(&made, 0.05).expect("equal edges");
        let (filling, _) = outline::filled(&coarse, 0.05).expect("a filling");
        assert_eq!(filling.chambers().expect("closed").len(), pieces);
        assert!((filling.measure().expect("an area").value() / wanted - 1.0).abs() < 2e-3);
    }
}

#[test]
fn bow_ties_and_figures_of_eight_are_two_bodies() {
    let uneven = [ring(&[[0.0, 0.0], [8.0, 8.0], [8.0, 2.0], [0.0, 8.0]])];
    let even = [ring(&[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]])];
    assert_eq!(even[0].area(), 0.0, "its halves run opposite ways");
    for how in [Overlap::EvenOdd, Overlap::Union] {
        body_of(&uneven, how, 200.0 / 7.0, 2);
        body_of(&even, how, 2.0, 2);
    }
    let mut crossing = even.to_vec();
    assert!(matches!(outline::nest(&mut crossing), Err(OutlineError::Meeting { .. })));
}

#[test]
fn areas_that_touch_in_points_are_apart() {
    let at_a_corner = [square(0.0, 1.0, 0), square(1.0, 2.0, 1)];
    let at_a_side = [square(0.0, 1.0, 0), Ring { part: 1, ..ring(&[[1.0, 0.5], [2.0, 0.0], [2.0, 1.0]]) }];
    // A hole that touches its outline opens it; a hole that touches it twice cuts it in two.
    let hole = [square(0.0, 4.0, 0), ring(&[[4.0, 2.0], [2.0, 3.0], [2.0, 1.0]])];
    let diamond = [square(0.0, 4.0, 0), ring(&[[4.0, 2.0], [2.0, 3.0], [0.0, 2.0], [2.0, 1.0]])];
    for how in [Overlap::EvenOdd, Overlap::Union] {
        let apart = body_of(&at_a_corner, how, 2.0, 2);
        let (a, b) = (&apart[0].points, &apart[1].points);
        let far = |p: &[f64; 2], q: &[f64; 2]| ((p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2)).sqrt();
        let least = a.iter().flat_map(|p| b.iter().map(move |q| far(p, q))).fold(f64::INFINITY, f64::min);
        assert!(least > 0.0 && least < 3e-9, "{least}");
        body_of(&at_a_side, how, 1.5, 2);
        assert_eq!(body_of(&hole, how, 14.0, 1).len(), 1);
        body_of(&diamond, how, 12.0, 2);
    }
}

/// The length of a horizontal line inside rings by the even-odd rule.
fn covered(rings: &[Ring], y: f64) -> f64 {
    let mut crossings = Vec::new();
    for ring in rings {
        for (k, a) in ring.points.iter().enumerate() {
            let b = ring.points[(k + 1) % ring.points.len()];
            if (a[1] > y) != (b[1] > y) {
                crossings.push(a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]));
            }
        }
    }
    crossings.sort_by(f64::total_cmp);
    crossings.chunks_exact(2).map(|pair| pair[1] - pair[0]).sum()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    /// Corners on a small grid touch and cross in all ways: the result bounds the same inside and is filled.
    #[test]
    fn whatever_crosses_is_joined(places in proptest::collection::vec((0i8..6, 0i8..6), 3..16), line in 0.01f64..0.99) {
        let rings = [ring(&places.iter().map(|(x, y)| [f64::from(*x), f64::from(*y)]).collect::<Vec<_>>())];
        let mut made = outline::joined(&rings, Overlap::EvenOdd);
        for row in 0..6 {
            let y = f64::from(row) + line;
            prop_assert!((covered(&made, y) - covered(&rings, y)).abs() < 1e-6, "at {}", y);
        }
        if made.is_empty() {
            return Ok(());
        }
        prop_assert_eq!(outline::nest(&mut made).map(|_| ()), Ok(()));
        prop_assert!(outline::skin(&made).expect("a skin").chambers().is_ok());
        let (filling, _) = outline::filled(&made, 1.0).expect("a filling");
        prop_assert!((filling.measure().expect("an area").value() / total(&made) - 1.0).abs() < 1e-8);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    /// Stars with arbitrary spikes are either refused, or filled with the area of their outline.
    #[test]
    fn stars_are_filled_or_refused(radii in proptest::collection::vec(0.2f64..1.0, 3..14), spacing in 0.03f64..0.5) {
        let n = radii.len() as f64;
        let points = radii.iter().enumerate().map(|(k, r)| {
            let angle = TAU * k as f64 / n;
            [r * libm::cos(angle), r * libm::sin(angle)]
        });
        let mut rings = vec![Ring { points: points.collect(), part: 0 }];
        prop_assume!(outline::nest(&mut rings).is_ok());
        let Ok(rings) = outline::resampled(&rings, spacing) else { return Ok(()) };
        let (mesh, thin) = outline::filled(&rings, spacing).expect("rings that do not cross are filled");
        let quality = quality(&mesh);
        prop_assert!((mesh.measure().expect("an area").value() / total(&rings) - 1.0).abs() < 1e-9);
        prop_assert!(mesh.chambers().is_ok());
        prop_assert!(quality.smallest_angle > 0.0 && quality.longest_edge < 4.0 * spacing, "{:?}", quality);
        // Triangles thinner than promised are reported, with the actual angle.
        let least = quality.smallest_angle.to_degrees();
        prop_assert_eq!(thin.is_some(), least < outline::SMALLEST_ANGLE - 1e-6, "{}", least);
        prop_assert!(thin.is_none_or(|thin| (thin.angle - least).abs() < 1e-9 && thin.count > 0), "{:?}", thin);
    }

    /// A filling has the same triangles whatever its position and size.
    #[test]
    fn fillings_move_with_their_outline(power in -3i32..4) {
        let factor = 2f64.powi(power);
        let unit = vec![circle([0.0; 2], 1.0, 50)];
        let larger = vec![Ring { points: unit[0].points.iter().map(|p| p.map(|x| x * factor)).collect(), part: 0 }];
        let (a, _) = outline::filled(&unit, 0.125).expect("a filling");
        let (b, _) = outline::filled(&larger, 0.125 * factor).expect("a filling");
        prop_assert_eq!(a.cells.triangles, b.cells.triangles);
    }
}

/// Triangles thinner than promised are reported with the position of the thinnest and its cause.
#[test]
fn thin_triangles_are_told_with_their_cause() {
    // A wedge of 15°: no triangle at its tip has a larger angle.
    let wedge = ring(&[[0.0, 0.0], [10.0, 0.0], [10.0, 10.0 * 15f64.to_radians().tan()]]);
    let rings = outline::resampled(&[wedge], 0.5).expect("a wedge");
    let thin = outline::filled(&rings, 0.5).expect("a filling").1.expect("thin triangles");
    assert!(thin.count > 0 && thin.angle <= 15.0 + 1e-9 && thin.position[0] < 0.5, "{thin:?}");
    assert!(matches!(thin.cause, Cause::Corner(corner) if (corner - 15.0).abs() < 1e-6), "{thin:?}");
    // A slit much thinner than the spacing: its corners are right angles.
    let slit =
        ring(&[[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [2.01, 2.0], [2.01, 0.5], [2.0, 0.5], [2.0, 2.0], [0.0, 2.0]]);
    let thin = outline::filled(&[slit], 1.0).expect("a filling").1.expect("thin triangles");
    assert!(thin.angle < 5.0 && thin.cause == Cause::Finer, "{thin:?}");
}

/// A strip with twenty thousand points on one side. (That the time grows only in proportion to their number is tested in the module that triangulates
/// them.)
#[test]
fn long_straight_sides_are_filled() {
    let count = 20_000;
    let side = f64::from(count);
    let mut points: Vec<[f64; 2]> = (0..count).map(|k| [f64::from(k), 0.0]).collect();
    points.extend([[side, 0.0], [side, 1.0], [0.0, 1.0]]);
    let (mesh, thin) = outline::filled(&[Ring { points, part: 0 }], 1.0).expect("a strip");
    assert!((mesh.measure().expect("an area").value() - side).abs() < 1e-6 * side);
    assert!(complete(thin) && mesh.check().is_empty());
}
