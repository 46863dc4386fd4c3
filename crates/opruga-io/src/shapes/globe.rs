//! Lays out polygons of the globe in a plane, in degrees.
//!
//! * A ring that crosses the antimeridian (from 179° to −179°) is drawn in one piece, beyond 180°.
//! * A ring around a pole is cut along the antimeridian and closed along the pole.
//! * Polygons are moved next to one another if that makes the map narrower; the longitudes of some then exceed 180°.
//! * Polygons that were cut along the antimeridian, as RFC 7946 requires, are joined again.

use super::curves::{Point, larger, smaller};
use opruga_mesh::outline::{self, Overlap, Ring};

/// A step of at least this many degrees between neighbours crosses the antimeridian, because no edge is that long.
const OVER: f64 = 270.0;
/// A whole turn [°].
const TURN: f64 = 360.0;
/// Longitudes that differ by less than this [°] are equal.
const SAME: f64 = 1e-9;

/// A polygon: its outline, then its holes.
pub(super) type Polygon = Vec<Vec<Point>>;

/// Counts of the changes that were made.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct LaidOut {
    /// The number of rings that cross the antimeridian.
    pub(super) over: usize,
    /// The number of rings around a pole.
    pub(super) polar: usize,
    /// The number of polygons that were moved beyond 180°, so that they are next to the others.
    pub(super) beside: usize,
    /// The number of polygons that were cut along the antimeridian.
    pub(super) cut: usize,
}

/// Lays polygons out, each with its data. If `stitched` is set, the format omits cuts along the antimeridian, as topologies do, and a step of exactly
/// one turn means no motion.
pub(super) fn lay_out<T>(polygons: &mut Vec<(Polygon, T)>, stitched: bool) -> LaidOut {
    let mut done = LaidOut::default();
    for (polygon, _) in &mut *polygons {
        let mut around: Option<[f64; 2]> = None;
        for ring in polygon {
            match unrolled(ring, stitched) {
                Some((flat, winding)) => {
                    done.over += usize::from(winding == 0.0);
                    done.polar += usize::from(winding != 0.0);
                    *ring = if winding == 0.0 { centred(flat) } else { closed_along_the_pole(&flat, winding) };
                }
                // A hole that does not cross the antimeridian moves with its outline.
                None => {
                    if let (Some([low, high]), Some(first)) = (around, ring.first()) {
                        let turns = turns_into(first[0], low, high);
                        ring.iter_mut().for_each(|p| p[0] += turns);
                    }
                }
            }
            around = around.or(Some(span(ring)));
        }
    }
    done.beside = side_by_side(polygons);
    done.cut = sewn(polygons);
    done
}

fn is_same(p: Point, q: Point) -> bool {
    (q[0] - p[0]).abs() < SAME && (q[1] - p[1]).abs() < SAME
}

/// The lowest and the highest longitude.
fn span(ring: &[Point]) -> [f64; 2] {
    ring.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], p| [smaller(low, p[0]), larger(high, p[0])])
}

/// The turn that moves a longitude into a range, if a whole turn can.
fn turns_into(x: f64, low: f64, high: f64) -> f64 {
    [0.0, TURN, -TURN].into_iter().find(|turn| low <= x + turn && x + turn <= high).unwrap_or(0.0)
}

/// Makes the longitudes of a ring continuous over the antimeridian. Returns the ring, and how much its longitudes grow in one round (0, or one turn
/// for a ring around a pole); none if no step crosses the antimeridian.
fn unrolled(ring: &[Point], stitched: bool) -> Option<(Vec<Point>, f64)> {
    let mut turns = 0.0;
    let mut flat = Vec::with_capacity(ring.len());
    let mut any = false;
    for (k, p) in ring.iter().enumerate() {
        flat.push([p[0] + turns, p[1]]);
        let q = ring[(k + 1) % ring.len()];
        let step = q[0] - p[0];
        // Along a pole, and along a parallel around the whole globe, a step of one turn is allowed.
        let whole = (step.abs() - TURN).abs() < SAME;
        let along_pole = p[1].abs() == 90.0 && q[1].abs() == 90.0;
        if step.abs() >= OVER && !along_pole && (stitched || !whole) {
            turns -= TURN.copysign(step);
            any = true;
        }
    }
    // After a step of exactly one turn, both points are equal, so one of them is enough.
    flat.dedup_by(|q, p| is_same(*q, *p));
    let swept = flat.windows(2).any(|pair| {
        let (o, a, b) = (flat[0], pair[0], pair[1]);
        (a[0] - o[0]) * (b[1] - o[1]) != (b[0] - o[0]) * (a[1] - o[1])
    });
    (any && (swept || turns != 0.0)).then_some((flat, turns))
}

/// The ring, moved so that its centre is above −180° and at most at 180°.
fn centred(mut ring: Vec<Point>) -> Vec<Point> {
    let [low, high] = span(&ring);
    let turns = TURN * (1.0 - ((0.5 * (low + high) + 180.0) / TURN).ceil());
    ring.iter_mut().for_each(|p| p[0] += turns);
    ring
}

/// Closes a ring around a pole, whose longitudes grow by a turn of either sign in one round. The ring is cut where it first crosses the antimeridian,
/// and closed along the pole of the hemisphere that contains its mean latitude.
fn closed_along_the_pole(flat: &[Point], winding: f64) -> Vec<Point> {
    let n = flat.len();
    let at = |k: usize| if k < n { flat[k] } else { [flat[k - n][0] + winding, flat[k - n][1]] };
    let turn_of = |x: f64| ((x + 180.0) / TURN).floor();
    let cut = (0..n).find(|k| turn_of(at(*k)[0]) != turn_of(at(k + 1)[0])).unwrap_or(0);
    let (p, q) = (at(cut), at(cut + 1));
    let meridian = TURN * larger(turn_of(p[0]), turn_of(q[0])) - 180.0;
    let share = if q[0] == p[0] { 0.0 } else { (meridian - p[0]) / (q[0] - p[0]) };
    let latitude = p[1] + share * (q[1] - p[1]);
    let mut ring = vec![[meridian, latitude]];
    ring.extend((cut + 1..=cut + n).map(at));
    ring.push([meridian + winding, latitude]);
    let north = flat.iter().map(|p| p[1]).sum::<f64>() > 0.0;
    let pole = if north { 90.0 } else { -90.0 };
    ring.extend([[meridian + winding, pole], [meridian, pole]]);
    ring.dedup_by(|q, p| is_same(*q, *p));
    centred(ring)
}

/// Moves polygons by whole turns so that the map is as narrow as possible; returns the number of moved polygons.
fn side_by_side<T>(polygons: &mut [(Polygon, T)]) -> usize {
    let mut spans: Vec<[f64; 2]> =
        polygons.iter().filter_map(|(polygon, _)| polygon.first()).map(|ring| span(ring)).collect();
    spans.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let Some(first) = spans.first().copied() else { return 0 };
    let high = spans.iter().fold(f64::NEG_INFINITY, |high, span| larger(high, span[1]));
    if !(high - first[0] > 180.0 && high - first[0] <= 2.0 * TURN) {
        return 0;
    }
    // The widest gap between polygons becomes the border of the map.
    let (mut reach, mut widest, mut start) = (first[1], larger(first[0] + TURN - high, 0.0), first[0]);
    for [low, far] in spans {
        if low - reach > widest + SAME {
            (widest, start) = (low - reach, low);
        }
        reach = larger(reach, far);
    }
    let mut moved = 0;
    for (polygon, _) in polygons.iter_mut().filter(|(polygon, _)| !polygon.is_empty()) {
        if span(&polygon[0])[0] < start {
            polygon.iter_mut().flatten().for_each(|p| p[0] += TURN);
            moved += 1;
        }
    }
    moved
}

/// Joins polygons that share a border along the antimeridian; returns the number of joined polygons.
fn sewn<T>(polygons: &mut Vec<(Polygon, T)>) -> usize {
    // Borders along the antimeridian: the longitude, the range of latitudes, and the side on which the polygon is.
    let mut borders: Vec<(usize, f64, [f64; 2], bool)> = Vec::new();
    for (number, (polygon, _)) in polygons.iter().enumerate() {
        let Some(ring) = polygon.first() else { continue };
        let [low, high] = span(ring);
        for (k, p) in ring.iter().enumerate() {
            let q = ring[(k + 1) % ring.len()];
            let off = (p[0] - 180.0) / TURN;
            if (q[0] - p[0]).abs() < SAME && (off - off.round()).abs() < SAME && p[1] != q[1] {
                let west = p[0] - low > high - p[0];
                borders.push((number, p[0], [smaller(p[1], q[1]), larger(p[1], q[1])], west));
            }
        }
    }
    let mut cut: Vec<usize> = shared(&borders);
    cut.sort_unstable();
    cut.dedup();
    let Some(first) = cut.first().copied() else { return 0 };
    let mut rings: Vec<Ring> = Vec::new();
    for number in &cut {
        let own = core::mem::take(&mut polygons[*number].0);
        rings.extend(own.into_iter().map(|points| Ring { points, part: *number as u32 }));
    }
    for ring in &mut rings {
        // Both sides get the same longitude, to the last bit.
        for p in &mut ring.points {
            let off = ((p[0] - 180.0) / TURN).round();
            if (p[0] - 180.0 - TURN * off).abs() < SAME {
                p[0] = 180.0 + TURN * off;
            }
        }
    }
    polygons[first].0 = outline::joined(&rings, Overlap::Union).into_iter().map(|ring| ring.points).collect();
    polygons.retain(|(polygon, _)| !polygon.is_empty());
    cut.len()
}

/// The polygons with a border along a meridian that overlaps a border on the other side of this meridian.
fn shared(borders: &[(usize, f64, [f64; 2], bool)]) -> Vec<usize> {
    // The borders of one meridian, from south to north.
    let turn = |x: f64| ((x - 180.0) / TURN).round();
    let mut order: Vec<&(usize, f64, [f64; 2], bool)> = borders.iter().collect();
    order.sort_by(|a, b| turn(a.1).total_cmp(&turn(b.1)).then(a.2[0].total_cmp(&b.2[0])).then(a.0.cmp(&b.0)));
    let mut found = Vec::new();
    for meridian in order.chunk_by(|a, b| turn(a.1) == turn(b.1)) {
        let side = |west: bool| meridian.iter().filter(move |border| border.3 == west);
        for west in [false, true] {
            // For each border of the other side: the latitude at which it begins, and the northernmost latitude of all borders that begin there or
            // farther south.
            let (mut reach, mut others) = (f64::NEG_INFINITY, Vec::new());
            for border in side(!west) {
                reach = larger(reach, border.2[1]);
                others.push((border.2[0], reach));
            }
            for border in side(west) {
                let before = others.partition_point(|other| other.0 < border.2[1]);
                if before > 0 && others[before - 1].1 > border.2[0] {
                    found.push(border.0);
                }
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn box_of(x: [f64; 2], y: [f64; 2]) -> Vec<Point> {
        vec![[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]]
    }

    fn area(polygon: &Polygon) -> f64 {
        polygon.iter().map(|points| Ring { points: points.clone(), part: 0 }.area()).sum::<f64>().abs()
    }

    #[test]
    fn a_ring_over_the_antimeridian_is_in_one_piece() {
        let mut one = vec![(vec![box_of([176.0, -176.0], [0.0, 4.0])], ())];
        assert_eq!(lay_out(&mut one, false), LaidOut { over: 1, ..LaidOut::default() });
        assert_eq!((area(&one[0].0), span(&one[0].0[0])), (32.0, [176.0, 184.0]));
        // A band around the globe crosses nothing, and wide polygons have long edges.
        for x in [[-180.0, 180.0], [-130.0, 130.0]] {
            let mut band = vec![(vec![box_of(x, [-10.0, 10.0])], ())];
            assert_eq!(lay_out(&mut band, false), LaidOut::default());
            assert_eq!(band[0].0[0], box_of(x, [-10.0, 10.0]));
        }
    }

    #[test]
    fn a_polygon_that_was_cut_is_one_again() {
        let mut two =
            vec![(vec![box_of([176.0, 180.0], [0.0, 4.0])], 'a'), (vec![box_of([-180.0, -176.0], [1.0, 3.0])], 'b')];
        assert_eq!(lay_out(&mut two, false), LaidOut { beside: 1, cut: 2, ..LaidOut::default() });
        assert_eq!((two.len(), two[0].1, two[0].0.len()), (1, 'a', 1));
        assert!((area(&two[0].0) - 24.0).abs() < 1e-6 && (span(&two[0].0[0])[1] - 184.0).abs() < 1e-6);
        // Islands on both sides are placed next to each other, and remain two islands.
        let mut islands =
            vec![(vec![box_of([170.0, 175.0], [0.0, 4.0])], ()), (vec![box_of([-175.0, -170.0], [0.0, 4.0])], ())];
        assert_eq!(lay_out(&mut islands, false), LaidOut { beside: 1, ..LaidOut::default() });
        assert_eq!(span(&islands[1].0[0]), [185.0, 190.0]);
    }

    #[test]
    fn a_ring_around_a_pole_is_closed_along_it() {
        for (latitude, first) in [(-70.0, -150.0), (-70.0, -180.0), (80.0, 10.0)] {
            let mut ring: Vec<Point> = (0..36).map(|k| [first + 10.0 * f64::from(k), latitude]).collect();
            ring.iter_mut().for_each(|p| p[0] -= if p[0] >= 180.0 { TURN } else { 0.0 });
            for _ in 0..2 {
                let mut cap = vec![(vec![ring.clone()], ())];
                assert_eq!(lay_out(&mut cap, true), LaidOut { polar: 1, ..LaidOut::default() });
                assert_eq!(span(&cap[0].0[0]), [-180.0, 180.0]);
                let wanted = TURN * (90.0 - f64::abs(latitude));
                assert!((area(&cap[0].0) - wanted).abs() < 1e-9, "{latitude}, {first}: {}", area(&cap[0].0));
                ring.reverse();
            }
        }
    }
}
