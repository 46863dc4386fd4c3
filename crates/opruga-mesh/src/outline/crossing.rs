//! Crossings and contacts of closed curves with themselves or one another.

use super::segments::{Segments, bounds_of};
use crate::MeshError;

/// Twice the signed area of the triangle a b c [m²]; positive if c is to the left of a → b.
fn side(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Lower and higher of two coordinates.
fn span(p: f64, q: f64) -> [f64; 2] {
    if p <= q { [p, q] } else { [q, p] }
}

/// Whether the segments a b and c d have a common point.
fn segments_meet(a: [f64; 2], b: [f64; 2], c: [f64; 2], d: [f64; 2]) -> bool {
    // Their boxes must overlap, and neither segment may be strictly on one side of the other.
    let overlap = (0..2).all(|axis| {
        let (p, q) = (span(a[axis], b[axis]), span(c[axis], d[axis]));
        p[0] <= q[1] && q[0] <= p[1]
    });
    let parted = |p: f64, q: f64| (p > 0.0 && q > 0.0) || (p < 0.0 && q < 0.0);
    overlap && !parted(side(a, b, c), side(a, b, d)) && !parted(side(c, d, a), side(c, d, b))
}

/// An edge of a ring: (number of the ring, number of the edge); edge i runs from point i to the next.
pub(crate) type EdgeOfRing = (usize, usize);

/// The maximum number of boxes that are compared: a constant, which takes about a second, plus a number for each edge. Typical drawings need about a
/// hundred per edge. Without a limit, a hundred thousand long edges that fan out from one point, whose boxes all overlap, would take minutes.
const MOST_COMPARED: [u64; 2] = [1 << 27, 500];

/// The margin of boxes around their edges, relative to the extent. It is needed because the ends of edges were rounded during rotation, and
/// [`segments_meet`] rounds too.
const MARGIN: f64 = 64.0 * f64::EPSILON;

/// The lowest pair of edges of closed rings that meet other than at a shared end.
///
/// Only edges with overlapping boxes are compared. Boxes are aligned with the direction of most long edges, so that the boxes of a slanted comb are
/// thin too.
///
/// # Errors
/// [`MeshError::NotCompared`] if too many boxes overlap.
pub(crate) fn first_meeting(rings: &[&[[f64; 2]]]) -> Result<Option<[EdgeOfRing; 2]>, MeshError> {
    let edges = rings.iter().map(|points| points.len() as u64).sum();
    let most = MOST_COMPARED[0] + MOST_COMPARED[1] * edges;
    let mut compared = 0;
    search(rings, most, &mut compared).map_err(|()| MeshError::NotCompared { edges, most })
}

/// Does the same as [`first_meeting`], counts the comparisons of boxes, and gives up if there are too many.
fn search(rings: &[&[[f64; 2]]], most: u64, compared: &mut u64) -> Result<Option<[EdgeOfRing; 2]>, ()> {
    let edges: Vec<EdgeOfRing> =
        rings.iter().enumerate().flat_map(|(ring, points)| (0..points.len()).map(move |edge| (ring, edge))).collect();
    let ends = |(ring, edge): EdgeOfRing| (rings[ring][edge], rings[ring][(edge + 1) % rings[ring].len()]);
    let Some(origin) = rings.iter().find_map(|ring| ring.first().copied()) else { return Ok(None) };
    let extent = |axis: usize| {
        let mut range = [origin[axis]; 2];
        for point in rings.iter().flat_map(|ring| ring.iter()) {
            range = [span(range[0], point[axis])[0], span(range[1], point[axis])[1]];
        }
        range[1] - range[0]
    };
    let (width, height) = (extent(0), extent(1));
    let size = if width > height { width } else { height };

    // The mean direction of the edges and their perpendiculars, weighted by length. Angles are multiplied by four, because four times the angle gives
    // the same direction for an edge and its perpendicular.
    let (mut along, mut across) = (0.0, 0.0);
    for edge in &edges {
        let (a, b) = ends(*edge);
        let (x, y) = ((b[0] - a[0]) / size, (b[1] - a[1]) / size);
        let square = x * x + y * y;
        if square > 0.0 {
            let (re, im) = (x * x - y * y, 2.0 * x * y);
            along += (re * re - im * im) / square;
            across += 2.0 * re * im / square;
        }
    }
    let angle = 0.25 * libm::atan2(across, along);
    let (cos, sin) = (libm::cos(angle), libm::sin(angle));
    let turned = |p: [f64; 2]| {
        let (x, y) = (p[0] - origin[0], p[1] - origin[1]);
        [cos * x + sin * y, cos * y - sin * x]
    };
    let margin = MARGIN * size;
    let boxes = edges.iter().map(|edge| {
        let (a, b) = ends(*edge);
        let [low, high] = bounds_of(turned(a), turned(b));
        [low.map(|x| x - margin), high.map(|x| x + margin)]
    });
    let tree = Segments::of(boxes.collect());

    // Edges are tested in ascending order: the first edge that meets a later one is part of the lowest pair.
    for number in 0..edges.len() as u32 {
        let mut lowest: Option<u32> = None;
        *compared += tree.beside(number, |other| {
            let better = other > number && lowest.is_none_or(|best| other < best);
            if better && edges_conflict(rings, [edges[number as usize], edges[other as usize]]) {
                lowest = Some(other);
            }
        });
        if let Some(other) = lowest {
            return Ok(Some([edges[number as usize], edges[other as usize]]));
        }
        if *compared > most {
            return Err(());
        }
    }
    Ok(None)
}

/// Whether two edges, the lower one first, meet other than at the end that neighbours of one ring share.
fn edges_conflict(rings: &[&[[f64; 2]]], [first, second]: [EdgeOfRing; 2]) -> bool {
    let ends = |(ring, edge): EdgeOfRing| (rings[ring][edge], rings[ring][(edge + 1) % rings[ring].len()]);
    let folds_back = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
        let ahead = (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1]);
        side(a, b, c) == 0.0 && ahead < 0.0
    };
    let ((a, b), (c, d)) = (ends(first), ends(second));
    let same = first.0 == second.0;
    if same && second.1 == first.1 + 1 {
        folds_back(a, b, d)
    } else if same && first.1 == 0 && second.1 == rings[first.0].len() - 1 {
        folds_back(c, d, b)
    } else {
        segments_meet(a, b, c, d)
    }
}

#[cfg(test)]
mod tests {
    use super::{EdgeOfRing, edges_conflict, first_meeting, search};
    use proptest::prelude::*;

    fn by_all_pairs(rings: &[&[[f64; 2]]]) -> Option<[EdgeOfRing; 2]> {
        let edges: Vec<EdgeOfRing> = rings
            .iter()
            .enumerate()
            .flat_map(|(ring, points)| (0..points.len()).map(move |edge| (ring, edge)))
            .collect();
        let pairs = edges.iter().enumerate().flat_map(|(k, p)| edges[k + 1..].iter().map(|q| [*p, *q]));
        pairs.into_iter().find(|pair| edges_conflict(rings, *pair))
    }

    proptest! {
        /// On a coarse grid, points and edges often touch.
        #[test]
        fn the_lowest_pair_that_meets_is_that_of_all_pairs(
            rings in proptest::collection::vec(proptest::collection::vec([0..9u8, 0..9u8], 3..12), 1..4),
            angle in 0..12u8,
        ) {
            let (sin, cos) = (libm::sin(0.3 * f64::from(angle)), libm::cos(0.3 * f64::from(angle)));
            let turn = |[x, y]: [u8; 2]| [cos * f64::from(x) - sin * f64::from(y), sin * f64::from(x) + cos * f64::from(y)];
            let rings: Vec<Vec<[f64; 2]>> =
                rings.into_iter().map(|ring| ring.into_iter().map(turn).collect()).collect();
            let rings: Vec<&[[f64; 2]]> = rings.iter().map(Vec::as_slice).collect();
            prop_assert_eq!(first_meeting(&rings), Ok(by_all_pairs(&rings)));
        }
    }

    /// A comb of long teeth, rotated by an angle.
    fn comb(teeth: u32, angle: f64) -> Vec<[f64; 2]> {
        let width = 1.0 / f64::from(2 * teeth);
        let mut points = vec![[1.0, 1.0], [0.0, 1.0]];
        for tooth in 0..teeth {
            let x = f64::from(2 * tooth) * width;
            points.extend([[x, 0.0], [x + width, 0.0], [x + width, 0.99], [x + 2.0 * width, 0.99]]);
        }
        let (sin, cos) = (libm::sin(angle), libm::cos(angle));
        points.into_iter().map(|[x, y]| [cos * x - sin * y, sin * x + cos * y]).collect()
    }

    #[test]
    fn edges_of_combs_are_compared_with_few_others_however_many_and_however_they_lie() {
        for angle in [0.0, 0.2, 0.7, 1.2] {
            for teeth in [1_000, 8_000] {
                let points = comb(teeth, angle);
                let mut compared = 0;
                assert_eq!(search(&[&points], u64::MAX, &mut compared), Ok(None), "{teeth} teeth");
                let each = compared / points.len() as u64;
                assert!(each < 300, "each of {} edges at {angle} is compared with {each} boxes", points.len());
            }
        }
    }

    #[test]
    fn too_many_edges_side_by_side_are_refused_and_not_compared_for_ever() {
        // Thin spikes that fan out: every box overlaps those of a whole quadrant.
        let spikes = 4_000;
        let place = |k: u32, r: f64| {
            let angle = core::f64::consts::PI * f64::from(k) / f64::from(spikes);
            [r * libm::cos(angle), r * libm::sin(angle)]
        };
        let points: Vec<[f64; 2]> = (0..spikes).flat_map(|k| [place(2 * k, 1.0), place(2 * k + 1, 1e-3)]).collect();
        assert_eq!(first_meeting(&[&points]), Ok(None));
        assert_eq!(search(&[&points], 1_000_000, &mut 0), Err(()));
    }
}
