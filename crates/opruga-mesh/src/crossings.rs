//! Facets of a surface that meet although they are not neighbours.
//!
//! A tree of boxes over the facets, in the order of a space-filling curve, gives the candidates. The signs of determinants, exact for the given
//! coordinates, decide whether two facets meet.

use crate::Mesh;
use crate::boxes::{Bounds, Tree};
use crate::geometry::{cross, subtract};
use robust::{Coord, Coord3D, orient2d, orient3d};

/// The maximum number of listed pairs.
pub(crate) const MOST_LISTED: usize = 1000;

/// The maximum number of pairs of boxes that are compared, per facet; sound surfaces need about fifty.
const MOST_COMPARED: u64 = 2000;

/// The result of a search for facets that meet.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Crossings {
    /// Pairs of facets, lower number first, ascending; at most a thousand.
    pub pairs: Vec<[u32; 2]>,
    /// Whether all facets were compared; otherwise there were too many pairs or too many overlapping boxes.
    pub complete: bool,
}

impl Mesh<3> {
    /// Pairs of facets that cross, touch or overlap, except at nodes and edges that they share.
    ///
    /// Takes about a second for a million facets. Nodes with equal positions but different numbers are not shared: components that touch count as
    /// meeting.
    ///
    /// # Source
    /// J. R. Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates", Discrete and Computational Geometry 18
    /// (1997); library robust.
    pub fn crossing_facets(&self) -> Crossings {
        let mut found = Crossings { pairs: Vec::new(), complete: true };
        if self.facets.len() < 2 {
            return found;
        }
        // Scaled by a power of two to a size of about one, so that products of three lengths neither overflow nor vanish.
        let (low, high) = self.bounds();
        let extent = (0..3).map(|d| high[d] - low[d]).fold(0.0, |most, x| if x > most { x } else { most });
        let factor = inverse_power(extent);
        let points: Vec<[f64; 3]> = self.positions.iter().map(|x| x.map(|x| x * factor)).collect();
        let sorted = Sorted::of(&self.facets, points);
        let mut budget = MOST_COMPARED * self.facets.len() as u64;
        // Pairs of overlapping nodes of one level; every pair of leaves occurs once.
        let mut waiting = vec![[1usize; 2]];
        while let Some([node, other]) = waiting.pop() {
            if budget < 4 || found.pairs.len() >= MOST_LISTED {
                found.complete = false;
                break;
            }
            if node >= sorted.leaves {
                budget -= 1;
                sorted.compare([node - sorted.leaves, other - sorted.leaves], &mut found.pairs);
                continue;
            }
            let ([a, b], [c, d]) = ([2 * node, 2 * node + 1], [2 * other, 2 * other + 1]);
            let below = if node == other { &[[a, a], [b, b], [a, b]][..] } else { &[[a, c], [a, d], [b, c], [b, d]] };
            budget -= below.len() as u64;
            waiting.extend(below.iter().filter(|[a, b]| a == b || overlap(&sorted.boxes[*a], &sorted.boxes[*b])));
        }
        found.pairs.sort_unstable();
        found
    }
}

/// A box in half of the memory, rounded outward.
type Small = [[f32; 3]; 2];

fn small([low, high]: &Bounds) -> Small {
    let down = |x: f64| if f64::from(x as f32) > x { (x as f32).next_down() } else { x as f32 };
    let up = |x: f64| if f64::from(x as f32) < x { (x as f32).next_up() } else { x as f32 };
    [low.map(down), high.map(up)]
}

/// Whether two boxes overlap. The code has no branches, because the result is unpredictable.
fn overlap(a: &Small, b: &Small) -> bool {
    (0..3).fold(true, |so_far, d| so_far & (a[0][d] <= b[1][d]) & (b[0][d] <= a[1][d]))
}

/// The facets in the order of the curve, with the data that are needed first.
struct Sorted {
    leaves: usize,
    boxes: Vec<Small>,
    facets: Vec<SortedFacet>,
    /// The index of the first facet of each leaf, followed by the end of the facets of the last leaf.
    begins: Vec<u32>,
    points: Vec<[f64; 3]>,
}

struct SortedFacet {
    bounds: Small,
    number: u32,
    nodes: [u32; 3],
    /// Twice the area of the facet times its normal, rounded.
    normal: [f64; 3],
    /// The largest error of the normal times a difference of points, per unit of the largest component of that difference.
    error: f64,
}

/// The rounding error of a product of a normal and a difference. The normal takes two differences, six products and three sums; the rest takes one
/// difference, three products and two sums. Each operation has a relative error of at most half of 2⁻⁵², and no intermediate result is larger than
/// six products of largest components.
const ERROR: f64 = 64.0 * f64::EPSILON;

impl Sorted {
    fn of(facets: &[[u32; 3]], points: Vec<[f64; 3]>) -> Sorted {
        let corners = |facet: &[u32; 3]| facet.map(|node| points[node as usize]);
        let tree = Tree::of(facets.iter().map(corners));
        let boxes = tree.boxes.iter().map(small).collect();
        let (mut sorted, mut begins) = (Vec::with_capacity(facets.len()), Vec::with_capacity(tree.leaves + 1));
        for leaf in 0..tree.leaves {
            begins.push(sorted.len() as u32);
            for &number in tree.facets_of(leaf) {
                let nodes = facets[number as usize];
                let [a, b, c] = corners(&nodes);
                let (u, v) = (subtract(b, a), subtract(c, a));
                sorted.push(SortedFacet {
                    bounds: small(&tree.facet_boxes[number as usize]),
                    number,
                    nodes,
                    normal: cross(u, v),
                    error: ERROR * largest(u) * largest(v),
                });
            }
        }
        begins.push(sorted.len() as u32);
        Sorted { leaves: tree.leaves, boxes, facets: sorted, begins, points }
    }

    fn facets_of(&self, leaf: usize) -> &[SortedFacet] {
        &self.facets[self.begins[leaf] as usize..self.begins[leaf + 1] as usize]
    }

    /// Compares the facets of two leaves, or the facets of one leaf with one another.
    fn compare(&self, [leaf, other]: [usize; 2], pairs: &mut Vec<[u32; 2]>) {
        let others = self.facets_of(other);
        for (index, a) in self.facets_of(leaf).iter().enumerate() {
            for b in if leaf == other { &others[index + 1..] } else { others } {
                if overlap(&a.bounds, &b.bounds) && self.meet(a, b) {
                    let (a, b) = (a.number, b.number);
                    pairs.push(if a < b { [a, b] } else { [b, a] });
                }
            }
        }
    }

    /// Whether two facets meet anywhere except at shared nodes.
    fn meet(&self, a: &SortedFacet, b: &SortedFacet) -> bool {
        let (mut first, mut second) = (a.nodes, b.nodes);
        let mut shared = 0;
        // Shared nodes come first, in the same order.
        for k in 0..3 {
            if let Some(index) = second[shared..].iter().position(|node| *node == first[k]) {
                first.swap(shared, k);
                second.swap(shared, shared + index);
                shared += 1;
            }
        }
        // A facet that is strictly on one side of the plane of the other meets it at most in shared nodes.
        if shared < 3 && (self.beside(a, &second[shared..]) || self.beside(b, &first[shared..])) {
            return false;
        }
        let [p, q] = [first, second].map(|nodes| nodes.map(|node| self.points[node as usize]));
        match shared {
            0 => sides(&p).iter().any(|side| reaches(side, &q)) || sides(&q).iter().any(|side| reaches(side, &p)),
            // The sides opposite the shared node: any common point lies on one of them.
            1 => reaches(&[p[1], p[2]], &q) || reaches(&[q[1], q[2]], &p),
            2 => folded(&p, &q[2]),
            _ => true,
        }
    }

    /// Whether it is certain that points are strictly on one side of the plane of a facet. If rounding leaves a doubt, the exact signs decide later.
    fn beside(&self, facet: &SortedFacet, nodes: &[u32]) -> bool {
        let origin = self.points[facet.nodes[0] as usize];
        let side = |node: u32| {
            let offset = subtract(self.points[node as usize], origin);
            let [x, y, z] = facet.normal;
            let height = x * offset[0] + y * offset[1] + z * offset[2];
            let error = facet.error * largest(offset);
            // For numbers near the underflow limit, rounding errors are not proportional to their terms.
            if height.abs() > error && error > 1e-280 { height } else { 0.0 }
        };
        let first = side(nodes[0]);
        let same = |node: &u32| if first > 0.0 { side(*node) > 0.0 } else { side(*node) < 0.0 };
        first != 0.0 && nodes[1..].iter().all(same)
    }
}

fn largest(x: [f64; 3]) -> f64 {
    x.into_iter().map(f64::abs).fold(0.0, |most, x| if x > most { x } else { most })
}

fn sides(triangle: &[[f64; 3]; 3]) -> [[[f64; 3]; 2]; 3] {
    [[triangle[0], triangle[1]], [triangle[1], triangle[2]], [triangle[2], triangle[0]]]
}

fn exact(p: &[f64; 3]) -> Coord3D<f64> {
    Coord3D { x: p[0], y: p[1], z: p[2] }
}

/// The side of the plane through three points on which a fourth lies.
fn side(a: &[f64; 3], b: &[f64; 3], c: &[f64; 3], d: &[f64; 3]) -> f64 {
    orient3d(exact(a), exact(b), exact(c), exact(d))
}

/// Whether a segment has a point in common with a triangle, including its border.
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

/// Does the same as `reaches` for a segment in the plane of the triangle. The segment and the triangle are projected along the axis for which the
/// projection of the triangle is largest.
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
    // A side that is collinear with the segment but does not overlap it passes `crosses`, so one such side is not enough.
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

/// Whether the triangle between an edge (the first two corners) and another point overlaps the given triangle.
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

/// The reciprocal of the largest power of two below a positive number.
fn inverse_power(x: f64) -> f64 {
    let exponent = x.to_bits() >> 52;
    if (1..2046).contains(&exponent) { f64::from_bits((2046 - exponent) << 52) } else { 1.0 }
}
