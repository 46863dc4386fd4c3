//! Separation of rings that touch at points.
//!
//! Around a point at which rings touch, the inside consists of sectors. Every sector gets its own corner, slightly inside the sector, because bodies
//! are not connected by points.

use super::{Ring, bounds, distance};
use std::collections::BTreeMap;

/// The approximate distance of the corners of different sectors from their common point, relative to the size of the drawing.
const APART: f64 = 1.0 / (1u64 << 32) as f64;

/// Rings that bound the same inside and do not touch anywhere. The given rings must have the inside to their left and meet only at common points.
pub(super) fn apart(rings: &[Ring]) -> Vec<Ring> {
    let Some((low, high)) = bounds(rings) else { return Vec::new() };
    let step = distance(low, high) * APART;
    let corners = Corners::of(rings);
    let mut next = corners.next.clone();
    let mut moved = corners.points.clone();
    for here in corners.by_position().into_values().filter(|here| here.len() > 1) {
        // Sorted by direction; of equal ones the first comes last, so that the search finds it.
        let mut leaving: Vec<(f64, usize)> =
            here.iter().map(|corner| (corners.direction(*corner, corners.next[*corner]), *corner)).collect();
        leaving.sort_by(|p, q| p.0.total_cmp(&q.0).then(q.1.cmp(&p.1)));
        for &corner in &here {
            let from = corners.direction(corner, corners.previous[corner]);
            // The sector to the left of the incoming edge ends at the first outgoing edge, clockwise.
            let below = leaving.partition_point(|(to, _)| *to < from);
            let (to, other) = leaving[if below > 0 { below } else { leaving.len() } - 1];
            next[corner] = corners.next[other];
            let middle = from - 0.5 * clockwise(from, to);
            let [x, y] = corners.points[corner];
            moved[corner] = [x + step * libm::cos(middle), y + step * libm::sin(middle)];
        }
    }
    let mut seen = vec![false; next.len()];
    let mut made = Vec::new();
    for first in 0..next.len() {
        let mut ring = Ring { points: Vec::new(), part: corners.parts[first] };
        let mut at = first;
        while !core::mem::replace(&mut seen[at], true) {
            ring.points.push(moved[at]);
            at = next[at];
        }
        if ring.points.len() > 2 {
            made.push(ring);
        }
    }
    made
}

/// Positions at which rings touch themselves or one another. For every ring, these are the numbers of its points that are next to a point other than
/// a neighbour, ascending.
pub(super) fn touching(rings: &[Ring]) -> Vec<Vec<usize>> {
    let mut found = vec![Vec::new(); rings.len()];
    let Some((low, high)) = bounds(rings) else { return found };
    // Slightly more than the largest distance of two corners that have been separated.
    let tolerance = 4.0 * distance(low, high) * APART;
    // Two close points are in the same column of at least one of two gratings, and are consecutive in it.
    for shift in [0.0, tolerance] {
        let mut order: Vec<(f64, f64, usize, usize)> = Vec::new();
        for (number, ring) in rings.iter().enumerate() {
            let column = |x: f64| ((x - low[0] + shift) / (2.0 * tolerance)).floor();
            order.extend(ring.points.iter().enumerate().map(|(index, p)| (column(p[0]), p[1], number, index)));
        }
        order.sort_unstable_by(|p, q| p.0.total_cmp(&q.0).then(p.1.total_cmp(&q.1)).then((p.2, p.3).cmp(&(q.2, q.3))));
        for (k, &(column, y, ring, index)) in order.iter().enumerate() {
            let later = order[k + 1..].iter().take_while(|later| later.0 == column && later.1 - y <= tolerance);
            for &(_, _, other, beside) in later {
                let n = rings[ring].points.len();
                let neighbours = ring == other && [1, n - 1].contains(&index.abs_diff(beside));
                if !neighbours && distance(rings[ring].points[index], rings[other].points[beside]) <= tolerance {
                    found[ring].push(index);
                    found[other].push(beside);
                }
            }
        }
    }
    for indices in &mut found {
        indices.sort_unstable();
        indices.dedup();
    }
    found
}

/// The points of all rings, one after another.
struct Corners {
    points: Vec<[f64; 2]>,
    parts: Vec<u32>,
    next: Vec<usize>,
    previous: Vec<usize>,
}

impl Corners {
    fn of(rings: &[Ring]) -> Corners {
        let mut all = Corners { points: Vec::new(), parts: Vec::new(), next: Vec::new(), previous: Vec::new() };
        for ring in rings {
            let (first, n) = (all.points.len(), ring.points.len());
            all.points.extend(&ring.points);
            all.parts.extend((0..n).map(|_| ring.part));
            all.next.extend((0..n).map(|k| first + (k + 1) % n));
            all.previous.extend((0..n).map(|k| first + (k + n - 1) % n));
        }
        all
    }

    /// Corners by their position.
    fn by_position(&self) -> BTreeMap<[u64; 2], Vec<usize>> {
        let mut corners: BTreeMap<[u64; 2], Vec<usize>> = BTreeMap::new();
        for (corner, point) in self.points.iter().enumerate() {
            // −0 is 0.
            corners.entry(point.map(|x| (x + 0.0).to_bits())).or_default().push(corner);
        }
        corners
    }

    /// The direction angle from one corner to another [rad].
    fn direction(&self, from: usize, to: usize) -> f64 {
        let (p, q) = (self.points[from], self.points[to]);
        libm::atan2(q[1] - p[1], q[0] - p[0])
    }
}

/// The clockwise angle from one direction to another [rad]: above 0, and at most a full turn.
fn clockwise(from: f64, to: f64) -> f64 {
    let angle = from - to;
    if angle > 0.0 { angle } else { angle + core::f64::consts::TAU }
}
