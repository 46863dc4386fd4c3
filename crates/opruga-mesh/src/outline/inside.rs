//! The nesting of rings, and whether a point is inside one.

use super::Ring;
use super::segments::{Segments, bounds_of};
use robust::{Coord, orient2d};

/// An edge of a ring, from its lower end to its upper one.
#[derive(Clone, Copy)]
struct Rising {
    low: [f64; 2],
    high: [f64; 2],
    ring: usize,
    /// Whether the ring runs upwards on this edge.
    upward: bool,
}

impl Rising {
    /// Whether the edge crosses a level. The lower end counts and the upper one does not, so rings that only touch the level cross it twice or never.
    fn crosses(&self, level: f64) -> bool {
        self.low[1] <= level && level < self.high[1]
    }

    /// Whether a point is strictly to the left of the edge; exact.
    fn is_right_of(&self, point: [f64; 2]) -> bool {
        self.side(point) > 0.0
    }

    fn side(&self, point: [f64; 2]) -> f64 {
        let exact = |p: [f64; 2]| Coord { x: p[0], y: p[1] };
        orient2d(exact(self.low), exact(self.high), exact(point))
    }

    /// Whether the edge is to the left of another edge that crosses the same level, if the two meet at most at an end.
    fn is_left_of(&self, other: &Rising) -> bool {
        let by_low = if self.low[1] >= other.low[1] { other.side(self.low) } else { -self.side(other.low) };
        let by_high = || if self.high[1] <= other.high[1] { other.side(self.high) } else { -self.side(other.high) };
        if by_low == 0.0 { by_high() > 0.0 } else { by_low > 0.0 }
    }

    /// The approximate position at which the edge crosses a level.
    fn at(&self, level: f64) -> f64 {
        self.low[0] + (level - self.low[1]) / (self.high[1] - self.low[1]) * (self.high[0] - self.low[0])
    }
}

fn rising(rings: &[&[[f64; 2]]]) -> Vec<Rising> {
    let mut edges = Vec::with_capacity(rings.iter().map(|points| points.len()).sum());
    for (ring, points) in rings.iter().enumerate() {
        for (k, a) in points.iter().enumerate() {
            let b = points[(k + 1) % points.len()];
            let upward = b[1] > a[1];
            let (low, high) = if upward { (*a, b) } else { (b, *a) };
            edges.push(Rising { low, high, ring, upward });
        }
    }
    edges
}

fn tree_of(edges: &[Rising]) -> Segments {
    Segments::of(edges.iter().map(|edge| bounds_of(edge.low, edge.high)).collect())
}

/// For every ring, the innermost other ring that contains it. Rings must not meet.
///
/// The nearest edge to the right of the rightmost point of a ring gives the answer: it belongs to the surrounding ring, or to a ring beside it, which
/// has the same surrounding ring.
pub fn around(rings: &[Ring]) -> Vec<Option<usize>> {
    let all: Vec<&[[f64; 2]]> = rings.iter().map(|ring| ring.points.as_slice()).collect();
    let edges = rising(&all);
    let tree = tree_of(&edges);
    let left = |ring: &Ring| ring.area() > 0.0;
    let counter_clockwise: Vec<bool> = rings.iter().map(left).collect();
    let rightmost = |points: &[[f64; 2]]| {
        let first = *points.first()?;
        Some(points.iter().fold(first, |best, p| if p[0] > best[0] { *p } else { best }))
    };
    let mut order: Vec<(usize, [f64; 2])> =
        all.iter().enumerate().filter_map(|(ring, points)| Some((ring, rightmost(points)?))).collect();
    // The ring that is found extends farther to the right, so its own result is already known.
    order.sort_by(|p, q| q.1[0].total_cmp(&p.1[0]).then(p.0.cmp(&q.0)));
    let mut found: Vec<Option<usize>> = vec![None; rings.len()];
    for (ring, point) in order {
        let mut nearest: Option<(Rising, f64)> = None;
        tree.along_ray(point, |number| {
            let edge = edges[number as usize];
            if edge.ring != ring
                && edge.crosses(point[1])
                && edge.is_right_of(point)
                && nearest.is_none_or(|(best, _)| edge.is_left_of(&best))
            {
                // Rounding must not hide an edge slightly to the left.
                let at = edge.at(point[1]);
                let slack = 1e-12 * (at.abs() + point[0].abs());
                nearest = Some((edge, at + slack));
            }
            nearest.map_or(f64::INFINITY, |(_, reach)| reach)
        });
        found[ring] = nearest.and_then(|(edge, _)| {
            // The inside is to the left of a counter-clockwise ring.
            if edge.upward == counter_clockwise[edge.ring] { Some(edge.ring) } else { found[edge.ring] }
        });
    }
    found
}

/// A closed curve prepared for queries of many points.
pub struct Inside {
    edges: Vec<Rising>,
    tree: Segments,
}

impl Inside {
    /// The closed curve through some points.
    pub fn of(points: &[[f64; 2]]) -> Inside {
        let edges = rising(&[points]);
        let tree = tree_of(&edges);
        Inside { edges, tree }
    }

    /// Whether a point is inside, that is, whether an odd number of edges cross the ray to its right.
    pub fn holds(&self, point: [f64; 2]) -> bool {
        let mut inside = false;
        self.tree.along_ray(point, |number| {
            let edge = &self.edges[number as usize];
            inside ^= edge.crosses(point[1]) && edge.is_right_of(point);
            f64::INFINITY
        });
        inside
    }
}

#[cfg(test)]
mod tests {
    use super::{Inside, Ring, around};
    use proptest::prelude::*;

    fn square(x: f64, y: f64, half: f64, clockwise: bool) -> Ring {
        let mut points = vec![[x - half, y - half], [x + half, y - half], [x + half, y + half], [x - half, y + half]];
        if clockwise {
            points.reverse();
        }
        Ring { points, part: 0 }
    }

    /// Finds the smallest ring that contains each ring, by testing every ring with a point of every other one.
    fn by_all_pairs(rings: &[Ring]) -> Vec<Option<usize>> {
        let of = |number: usize| {
            let holds =
                |other: &usize| *other != number && Inside::of(&rings[*other].points).holds(rings[number].points[0]);
            (0..rings.len()).filter(holds).min_by(|a, b| rings[*a].area().abs().total_cmp(&rings[*b].area().abs()))
        };
        (0..rings.len()).map(of).collect()
    }

    /// Adds a square with nested squares; for each square, `tree` gives whether it exists, whether it is divided into nine, and whether it runs
    /// clockwise.
    fn nested(x: f64, y: f64, half: f64, tree: &mut impl Iterator<Item = (bool, bool, bool)>, out: &mut Vec<Ring>) {
        let Some((there, divided, clockwise)) = tree.next() else { return };
        if !there {
            return;
        }
        // Sides of neighbours are on common lines, so that rays meet corners.
        out.push(square(x, y, half, clockwise));
        if divided {
            for i in [-1.0, 0.0, 1.0] {
                for j in [-1.0, 0.0, 1.0] {
                    nested(x + 0.625 * half * i, y + 0.625 * half * j, 0.25 * half, tree, out);
                }
            }
        }
    }

    proptest! {
        #[test]
        fn the_innermost_ring_around_another_is_that_of_all_pairs(
            tree in proptest::collection::vec(any::<(bool, bool, bool)>(), 1..60),
        ) {
            let mut rings = Vec::new();
            let mut tree = tree.into_iter();
            nested(0.0, 0.0, 64.0, &mut core::iter::once((true, true, false)).chain(tree.by_ref()), &mut rings);
            prop_assert_eq!(around(&rings), by_all_pairs(&rings));
        }
    }

    #[test]
    fn rings_in_a_row_and_in_one_another_are_placed() {
        are_placed(6000);
    }

    #[test]
    #[ignore = "a sweep: cargo test -- --ignored whole_sweep"]
    fn rings_in_a_row_and_in_one_another_are_placed_however_many_whole_sweep() {
        are_placed(30_000);
    }

    fn are_placed(n: u32) {
        let row: Vec<Ring> = (0..n).map(|k| square(f64::from(k), 0.0, 0.4, k % 2 == 0)).collect();
        assert!(around(&row).iter().all(Option::is_none));
        let onion: Vec<Ring> = (0..n).map(|k| square(0.0, 0.0, f64::from(1 + k), k % 2 == 0)).collect();
        let around = around(&onion);
        assert!((0..n as usize - 1).all(|k| around[k] == Some(k + 1)) && around[n as usize - 1].is_none());
    }

    #[test]
    fn a_point_beside_a_tip_or_level_with_a_corner_is_not_inside() {
        let diamond = Inside::of(&[[0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]]);
        assert!(diamond.holds([0.0, 0.0]) && diamond.holds([0.9, 0.0]) && diamond.holds([0.0, 0.9]));
        for out in [[-2.0, 0.0], [2.0, 0.0], [-2.0, 1.0], [-2.0, -1.0], [0.6, 0.6]] {
            assert!(!diamond.holds(out), "{out:?}");
        }
    }
}
