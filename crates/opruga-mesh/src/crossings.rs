//! Facets of a surface that meet one another where they are not neighbours.
//!
//! Candidates come from a tree of boxes over the facets in the order of a space-filling curve; whether two facets meet is
//! decided by the signs of determinants, exact for the coordinates as they are.

use crate::Mesh;
use crate::boxes::{Tree, overlap};
use robust::{Coord, Coord3D, orient2d, orient3d};

/// Pairs that are listed at most.
const MOST_LISTED: usize = 1000;

/// Pairs of boxes that are compared at most, for each facet: sound surfaces take about fifty.
const MOST_COMPARED: u64 = 2000;

/// What was found of facets that meet.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Crossings {
    /// Pairs of facets, lower number first, ascending; at most a thousand.
    pub pairs: Vec<[u32; 2]>,
    /// Whether all facets were compared; else there were too many pairs, or too many boxes overlap.
    pub complete: bool,
}

impl Mesh<3> {
    /// Pairs of facets that cross, touch or overlap anywhere but at the nodes and edges that they share.
    ///
    /// Takes about a second for a million facets. Nodes at the same place under different numbers are not shared: where
    /// components touch, they meet.
    ///
    /// # Source
    /// J. R. Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates", Discrete and
    /// Computational Geometry 18 (1997); library robust.
    pub fn crossing_facets(&self) -> Crossings {
        let mut found = Crossings { pairs: Vec::new(), complete: true };
        if self.facets.len() < 2 {
            return found;
        }
        // Scaled by a power of two to a size of about one: products of three lengths neither overflow nor vanish.
        let (low, high) = self.bounds();
        let extent = (0..3).map(|d| high[d] - low[d]).fold(0.0, |most, x| if x > most { x } else { most });
        let factor = inverse_power(extent);
        let place = |node: u32| self.positions[node as usize].map(|x| x * factor);
        let corners: Vec<[[f64; 3]; 3]> = self.facets.iter().map(|facet| facet.map(place)).collect();
        let tree = Tree::of(&corners);
        let mut budget = MOST_COMPARED * self.facets.len() as u64;
        // Pairs of nodes of one level; every pair of leaves comes once.
        let mut waiting = vec![[1usize; 2]];
        while let Some([node, other]) = waiting.pop() {
            if budget == 0 || found.pairs.len() >= MOST_LISTED {
                found.complete = false;
                break;
            }
            budget -= 1;
            if node != other && !overlap(&tree.boxes[node], &tree.boxes[other]) {
                continue;
            }
            let ([a, b], [c, d]) = ([2 * node, 2 * node + 1], [2 * other, 2 * other + 1]);
            if node >= tree.leaves {
                self.compare(&tree, &corners, [node - tree.leaves, other - tree.leaves], &mut found.pairs);
            } else if node == other {
                waiting.extend([[a, a], [b, b], [a, b]]);
            } else {
                waiting.extend([[a, c], [a, d], [b, c], [b, d]]);
            }
        }
        found.pairs.sort_unstable();
        found
    }

    /// Compares the facets of two leaves, or of one with one another.
    fn compare(&self, tree: &Tree, corners: &[[[f64; 3]; 3]], [leaf, other]: [usize; 2], pairs: &mut Vec<[u32; 2]>) {
        for (place, &a) in tree.facets_of(leaf).iter().enumerate() {
            let others = tree.facets_of(other);
            for &b in if leaf == other { &others[place + 1..] } else { others } {
                if overlap(&tree.facet_boxes[a as usize], &tree.facet_boxes[b as usize]) && self.meet(corners, a, b) {
                    pairs.push(if a < b { [a, b] } else { [b, a] });
                }
            }
        }
    }

    /// Whether two facets meet anywhere but at what they share.
    fn meet(&self, corners: &[[[f64; 3]; 3]], a: u32, b: u32) -> bool {
        let (mut first, mut second) = (self.facets[a as usize], self.facets[b as usize]);
        let (mut p, mut q) = (corners[a as usize], corners[b as usize]);
        let mut shared = 0;
        // What is shared comes first, in the same order.
        for k in 0..3 {
            if let Some(place) = second[shared..].iter().position(|node| *node == first[k]) {
                first.swap(shared, k);
                p.swap(shared, k);
                second.swap(shared, shared + place);
                q.swap(shared, shared + place);
                shared += 1;
            }
        }
        match shared {
            0 => sides(&p).iter().any(|side| reaches(side, &q)) || sides(&q).iter().any(|side| reaches(side, &p)),
            // The sides across from the shared node: whatever is common reaches them.
            1 => reaches(&[p[1], p[2]], &q) || reaches(&[q[1], q[2]], &p),
            2 => folded(&p, &q[2]),
            _ => true,
        }
    }
}

fn sides(triangle: &[[f64; 3]; 3]) -> [[[f64; 3]; 2]; 3] {
    [[triangle[0], triangle[1]], [triangle[1], triangle[2]], [triangle[2], triangle[0]]]
}

fn exact(p: &[f64; 3]) -> Coord3D<f64> {
    Coord3D { x: p[0], y: p[1], z: p[2] }
}

/// On which side of the plane through three points a fourth lies.
fn side(a: &[f64; 3], b: &[f64; 3], c: &[f64; 3], d: &[f64; 3]) -> f64 {
    orient3d(exact(a), exact(b), exact(c), exact(d))
}

/// Whether a segment has a point in common with a triangle, borders included.
fn reaches(segment: &[[f64; 3]; 2], triangle: &[[f64; 3]; 3]) -> bool {
    let ([p, q], [a, b, c]) = (segment, triangle);
    let (above, below) = (side(a, b, c, p), side(a, b, c, q));
    if above > 0.0 && below > 0.0 || above < 0.0 && below < 0.0 {
        return false;
    }
    if above == 0.0 && below == 0.0 {
        return reaches_in_plane(segment, triangle);
    }
    let around = [side(p, q, a, b), side(p, q, b, c), side(p, q, c, a)];
    around.iter().all(|x| *x >= 0.0) || around.iter().all(|x| *x <= 0.0)
}

/// The same for a segment in the plane of the triangle, along the axis from which the triangle looks largest.
fn reaches_in_plane(segment: &[[f64; 3]; 2], triangle: &[[f64; 3]; 3]) -> bool {
    let axis = widest(triangle);
    let flat = |p: &[f64; 3]| Coord { x: p[(axis + 1) % 3], y: p[(axis + 2) % 3] };
    let ([p, q], [a, b, c]) = (segment.each_ref().map(flat), triangle.each_ref().map(flat));
    let within = |point| {
        let around = [orient2d(a, b, point), orient2d(b, c, point), orient2d(c, a, point)];
        around.iter().all(|x| *x >= 0.0) || around.iter().all(|x| *x <= 0.0)
    };
    let crosses = |from, to| {
        let apart = |x: f64, y: f64| x > 0.0 && y > 0.0 || x < 0.0 && y < 0.0;
        !apart(orient2d(p, q, from), orient2d(p, q, to)) && !apart(orient2d(from, to, p), orient2d(from, to, q))
    };
    // Collinear segments that do not overlap pass the second test, but then neither end is within.
    within(p) || within(q) || [(a, b), (b, c), (c, a)].into_iter().filter(|(from, to)| crosses(*from, *to)).count() > 1
}

/// The axis along which the projection of a triangle is largest.
fn widest([a, b, c]: &[[f64; 3]; 3]) -> usize {
    let area = |axis: usize| {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        ((b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u])).abs()
    };
    let areas = [area(0), area(1), area(2)];
    let better = |best: usize, axis: usize| if areas[axis] > areas[best] { axis } else { best };
    better(better(0, 1), 2)
}

/// Whether the triangle of an edge (the first two corners) and another point lies on the triangle itself.
fn folded(triangle: &[[f64; 3]; 3], other: &[f64; 3]) -> bool {
    let [a, b, c] = triangle;
    if side(a, b, c, other) != 0.0 {
        return false;
    }
    let axis = widest(triangle);
    let flat = |p: &[f64; 3]| Coord { x: p[(axis + 1) % 3], y: p[(axis + 2) % 3] };
    let (one, two) = (orient2d(flat(a), flat(b), flat(c)), orient2d(flat(a), flat(b), flat(other)));
    one > 0.0 && two > 0.0 || one < 0.0 && two < 0.0
}

/// One over the power of two that is next below a positive number.
fn inverse_power(x: f64) -> f64 {
    let exponent = x.to_bits() >> 52;
    if (1..2046).contains(&exponent) { f64::from_bits((2046 - exponent) << 52) } else { 1.0 }
}
