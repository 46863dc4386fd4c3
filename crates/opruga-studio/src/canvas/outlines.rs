//! The outlines that the edges of a body in the plane form: closed lines, the edges that belong to none of them, and the triangles that fill the
//! lines. Outlines are computed once and reused as long as they fit the body.

use opruga::draw::{BodyPicture, Facets};
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Outlines with at most this many edges keep their triangles, which are computed again only if the body has folded. For larger outlines, the visible
/// triangles are computed for every picture.
const MOST_ANEW: usize = 4_000;
/// The largest number of bodies that are checked for folds in one picture. If there are more bodies, they are checked in turn.
const LOOKED_AT: usize = 64;

/// The outlines of every body seen so far.
#[derive(Default)]
pub(crate) struct Outlines {
    known: Vec<Option<Outline>>,
    /// The number of the picture.
    turn: usize,
}

impl core::fmt::Debug for Outlines {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Outlines").field("bodies", &self.known.len()).finish()
    }
}

/// The outline of a body.
#[derive(Default)]
pub(crate) struct Outline {
    /// The numbers of nodes, edges and springs for which the outline was computed.
    counts: [usize; 3],
    /// The closed lines of the outline.
    pub(crate) closed: Vec<Vec<u32>>,
    /// Edges that belong to no closed line.
    pub(crate) open: Vec<[u32; 2]>,
    /// Whether there are springs that are not also edges. Springs that are edges are not drawn, because the outline would cover them.
    pub(crate) springs: bool,
    /// The areas within the closed lines; empty if the body has cells or the outline is large.
    pub(crate) parts: Vec<Part>,
    /// Whether the outline has so many edges that only its visible corners are filled.
    pub(crate) large: bool,
}

/// The area within a line, without its holes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Part {
    /// The nodes of the line and of its holes.
    pub(crate) nodes: Vec<u32>,
    /// The triangles between these nodes, each given by three indices in `nodes`.
    pub(crate) triangles: Vec<[u32; 3]>,
}

impl Part {
    /// The triangles as indices of nodes in the body.
    fn of_body(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        self.triangles.iter().map(|corners| corners.map(|index| self.nodes[index as usize]))
    }
}

impl Outlines {
    /// Forgets all outlines.
    pub(crate) fn forget(&mut self) {
        self.known.clear();
    }

    /// Begins another picture.
    pub(crate) fn next_picture(&mut self) {
        self.turn = self.turn.wrapping_add(1);
    }

    /// The present outline of a body. With many bodies, a fold may be detected some pictures later.
    pub(crate) fn of(&mut self, index: usize, body: &BodyPicture) -> &Outline {
        if self.known.len() <= index {
            self.known.resize_with(index + 1, || None);
        }
        let edges: &[[u32; 2]] = match &body.facets {
            Facets::Edges(edges) => edges,
            Facets::Triangles(_) => &[],
        };
        let counts = [body.positions.len(), edges.len(), body.segments.len()];
        let groups = self.known.len().div_ceil(LOOKED_AT).max(1);
        let its_turn = index % groups == self.turn % groups;
        let slot = &mut self.known[index];
        if slot.as_ref().is_none_or(|outline| outline.counts != counts) {
            *slot = None;
        }
        let outline = slot.get_or_insert_with(|| Outline::new(body, edges, counts));
        let looked_at = its_turn && !outline.large && body.cells.is_empty();
        if looked_at && !fits(body, outline) {
            outline.parts = fill(body, &outline.closed);
        }
        outline
    }
}

impl Outline {
    fn new(body: &BodyPicture, edges: &[[u32; 2]], counts: [usize; 3]) -> Outline {
        let (closed, open) = loops(edges);
        let sorted =
            |list: &[[u32; 2]]| -> BTreeSet<[u32; 2]> { list.iter().map(|[a, b]| [*a.min(b), *a.max(b)]).collect() };
        let springs = !sorted(&body.segments).is_subset(&sorted(edges));
        let large = edges.len() > MOST_ANEW && body.cells.is_empty();
        let parts = if body.cells.is_empty() && !large { fill(body, &closed) } else { Vec::new() };
        Outline { counts, closed, open, springs, parts, large }
    }
}

/// Whether the triangles fit the body: no triangle is inverted, and they cover the area within the lines. Triangles that were made while the lines
/// crossed may not cover this area.
fn fits(body: &BodyPicture, outline: &Outline) -> bool {
    let mut covered = 0.0;
    for triangle in outline.parts.iter().flat_map(Part::of_body) {
        let twice = area(triangle.map(|node| body.positions[node as usize]));
        if twice < 0.0 {
            return false;
        }
        covered += twice;
    }
    covered >= 0.999 * outline.closed.iter().map(|line| enclosed(body, line)).sum::<f64>()
}

/// Twice the area within a line; negative if the line runs clockwise.
fn enclosed(body: &BodyPicture, line: &[u32]) -> f64 {
    let point = |index: usize| body.positions[line[index % line.len()] as usize];
    (0..line.len()).map(|k| (point(k), point(k + 1))).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum()
}

fn area([a, b, c]: [[f64; 3]; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Divides the edges of a body into two sets: closed lines, each with the direction of its edges and without repeated nodes, and edges that belong to
/// no closed line. Lines that touch at a node are separated when the walk along the edges returns to this node.
fn loops(edges: &[[u32; 2]]) -> (Vec<Vec<u32>>, Vec<[u32; 2]>) {
    let mut next: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    edges.iter().rev().for_each(|[a, b]| next.entry(*a).or_default().push(*b));
    let (mut closed, mut open) = (Vec::new(), Vec::new());
    while let Some(first) = next.first_key_value().map(|(node, _)| *node) {
        let mut path = vec![first];
        let mut indices: HashMap<u32, usize> = HashMap::from([(first, 0)]);
        while let Some(&last) = path.last() {
            let Some(ends) = next.get_mut(&last) else {
                // At a dead end, the edges that lead to it belong to no closed line.
                indices.remove(&last);
                path.pop();
                open.extend(path.last().map(|before| [*before, last]));
                continue;
            };
            let Some(node) = ends.pop() else { break };
            if ends.is_empty() {
                next.remove(&last);
            }
            if let Some(&index) = indices.get(&node) {
                let line: Vec<u32> = path.drain(index + 1..).collect();
                line.iter().for_each(|node| {
                    indices.remove(node);
                });
                let line: Vec<u32> = std::iter::once(node).chain(line).collect();
                if line.len() >= 3 {
                    closed.push(line);
                } else {
                    open.extend((0..line.len()).map(|k| [line[k], line[(k + 1) % line.len()]]));
                }
            } else {
                indices.insert(node, path.len());
                path.push(node);
            }
        }
    }
    (closed, open)
}

/// Returns the triangles within closed lines. A clockwise line bounds a hole in the line around it.
pub(crate) fn fill(body: &BodyPicture, lines: &[Vec<u32>]) -> Vec<Part> {
    let point = |node: u32| [body.positions[node as usize][0], body.positions[node as usize][1]];
    let (outer, holes): (Vec<&Vec<u32>>, Vec<&Vec<u32>>) = lines.iter().partition(|line| enclosed(body, line) > 0.0);
    let within = |line: &[u32], p: [f64; 2]| {
        let crosses = |k: &usize| {
            let (a, b) = (point(line[*k]), point(line[(*k + 1) % line.len()]));
            (a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
        };
        (0..line.len()).filter(crosses).count() % 2 == 1
    };
    // If a hole touches the line around it, some of its points are on neither side, so the majority decides.
    let holds = |line: &[u32], hole: &[u32]| {
        let some = hole.iter().step_by((hole.len() / 7).max(1));
        let inside = some.clone().filter(|node| within(line, point(**node))).count();
        2 * inside > some.count()
    };
    let mut parts = Vec::new();
    let mut earcut = earcut::Earcut::new();
    for line in &outer {
        let mut nodes = (*line).clone();
        let mut starts: Vec<u32> = Vec::new();
        for hole in holes.iter().filter(|hole| holds(line, hole)) {
            starts.push(nodes.len() as u32);
            nodes.extend(*hole);
        }
        let mut found: Vec<u32> = Vec::new();
        earcut.earcut(nodes.iter().map(|node| point(*node)), &starts, &mut found);
        let mut triangles = Vec::with_capacity(found.len() / 3);
        for corners in found.chunks_exact(3) {
            let mut triangle = [0, 1, 2].map(|k| corners[k]);
            if area(triangle.map(|index| body.positions[nodes[index as usize] as usize])) < 0.0 {
                triangle.swap(1, 2);
            }
            triangles.push(triangle);
        }
        parts.push(Part { nodes, triangles });
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn covered(body: &BodyPicture, parts: &[Part]) -> f64 {
        let triangles = parts.iter().flat_map(Part::of_body);
        triangles.map(|t| 0.5 * area(t.map(|node| body.positions[node as usize]))).sum()
    }

    fn ring(points: &[[f64; 2]], first: u32) -> (Vec<[f64; 3]>, Vec<[u32; 2]>) {
        let n = points.len() as u32;
        let edges = (0..n).map(|k| [first + k, first + (k + 1) % n]).collect();
        (points.iter().map(|p| [p[0], p[1], 0.0]).collect(), edges)
    }

    #[test]
    fn outlines_are_filled_around_holes_and_after_they_have_folded() {
        let square = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        let hole = [[0.5, 0.5], [0.5, 1.5], [1.5, 1.5], [1.5, 0.5]];
        let (mut positions, mut edges) = ring(&square, 0);
        let (more, others) = ring(&hole, 4);
        positions.extend(more);
        edges.extend(others);
        let mut body = BodyPicture { positions, facets: Facets::Edges(edges), ..Default::default() };
        let mut fills = Outlines::default();
        let parts = fills.of(0, &body).parts.clone();
        assert!((covered(&body, &parts) - 3.0).abs() < 1e-12);
        // A corner is pushed inwards, so the old triangles would overlap.
        body.positions[2] = [0.2, 0.2, 0.0];
        body.positions.truncate(4);
        body.facets = Facets::Edges((0..4).map(|k| [k, (k + 1) % 4]).collect());
        let parts = fills.of(0, &body).parts.clone();
        assert!((covered(&body, &parts) - 0.4).abs() < 1e-12, "{parts:?}");
    }

    #[test]
    fn a_body_that_was_inside_out_or_crossed_is_filled_again_once_it_is_right() {
        let right = ring(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]], 0);
        let body = |points: &[[f64; 2]]| BodyPicture {
            positions: ring(points, 0).0,
            facets: Facets::Edges(right.1.clone()),
            ..Default::default()
        };
        // The corners are in reverse order, or all at one point, or crossed so that the signed areas cancel.
        for wrong in [
            [[0.0, 0.0], [0.0, 2.0], [2.0, 2.0], [2.0, 0.0]],
            [[1.0, 1.0]; 4],
            [[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]],
        ] {
            let mut outlines = Outlines::default();
            outlines.of(0, &body(&wrong));
            let body = BodyPicture { positions: right.0.clone(), ..body(&wrong) };
            let parts = outlines.of(0, &body).parts.clone();
            assert!((covered(&body, &parts) - 4.0).abs() < 1e-12, "{wrong:?}: {parts:?}");
        }
        // One of two rings.
        let (mut positions, mut edges) = right.clone();
        let (more, others) = ring(&[[5.0, 0.0], [5.0, 1.0], [6.0, 1.0], [6.0, 0.0]], 4);
        positions.extend(more);
        edges.extend(others);
        let mut body = BodyPicture { positions, facets: Facets::Edges(edges), ..Default::default() };
        let mut outlines = Outlines::default();
        let before = outlines.of(0, &body).parts.clone();
        assert!((covered(&body, &before) - 4.0).abs() < 1e-12, "{before:?}");
        body.positions.swap(5, 7);
        let parts = outlines.of(0, &body).parts.clone();
        assert!((covered(&body, &parts) - 5.0).abs() < 1e-12 && parts.len() == 2, "{parts:?}");
    }

    #[test]
    fn rings_that_touch_in_one_point_are_filled_both_and_a_hole_may_touch_its_border() {
        // Two triangles that share node 2, in one walk.
        let positions = [[0.0, 0.0], [1.0, 0.0], [0.5, 1.0], [1.0, 2.0], [0.0, 2.0]];
        let body = |edges: Vec<[u32; 2]>, positions: &[[f64; 2]]| BodyPicture {
            positions: positions.iter().map(|p| [p[0], p[1], 0.0]).collect(),
            facets: Facets::Edges(edges),
            ..Default::default()
        };
        for edges in
            [vec![[0, 1], [1, 2], [2, 0], [2, 3], [3, 4], [4, 2]], vec![[4, 2], [2, 0], [0, 1], [3, 4], [2, 3], [1, 2]]]
        {
            let body = body(edges, &positions);
            let mut outlines = Outlines::default();
            let outline = outlines.of(0, &body);
            assert_eq!((outline.closed.len(), outline.open.len()), (2, 0));
            assert!((covered(&body, &outline.parts) - 1.0).abs() < 1e-12, "{:?}", outline.parts);
        }
        // A square with a triangular hole that touches it in node 0.
        let positions = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [0.5, 1.0], [1.0, 0.5]];
        let body = body(vec![[0, 1], [1, 2], [2, 3], [3, 0], [0, 4], [4, 5], [5, 0]], &positions);
        let mut outlines = Outlines::default();
        let outline = outlines.of(0, &body);
        assert!((covered(&body, &outline.parts) - (4.0 - 0.375)).abs() < 1e-12, "{:?}", outline.parts);
    }

    #[test]
    fn open_lines_are_edges_that_close_nothing_and_springs_on_edges_are_not_drawn_twice() {
        let (positions, mut edges) = ring(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], 0);
        let segments = edges.iter().map(|[a, b]| [*b, *a]).collect();
        let mut body = BodyPicture { positions, facets: Facets::Edges(edges.clone()), segments, ..Default::default() };
        assert!(!Outlines::default().of(0, &body).springs);
        body.positions.extend([[3.0, 0.0, 0.0], [4.0, 0.0, 0.0], [5.0, 0.0, 0.0]]);
        edges.extend([[3, 4], [4, 5]]);
        body.facets = Facets::Edges(edges);
        body.segments.push([0, 3]);
        let mut outlines = Outlines::default();
        let outline = outlines.of(0, &body);
        assert!(outline.springs);
        assert_eq!(outline.closed, [[0, 1, 2]]);
        let mut open = outline.open.clone();
        open.sort_unstable();
        assert_eq!(open, [[3, 4], [4, 5]]);
    }
}
