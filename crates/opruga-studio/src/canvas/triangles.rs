//! The triangles that fill the outlines of bodies in the plane, found once and used while they still fit.

use opruga::draw::{BodyPicture, Facets};
use std::collections::BTreeMap;

/// Outlines up to which triangles are found anew where a body has folded.
const MOST_ANEW: usize = 4_000;

/// Triangles of every body that was seen.
#[derive(Default)]
pub(crate) struct Fills {
    known: BTreeMap<usize, Fill>,
}

impl core::fmt::Debug for Fills {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Fills").field("bodies", &self.known.len()).finish()
    }
}

struct Fill {
    nodes: usize,
    edges: usize,
    triangles: Vec<[u32; 3]>,
}

impl Fills {
    /// Forgets all of them.
    pub(crate) fn forget(&mut self) {
        self.known.clear();
    }

    /// The triangles that fill a body now.
    pub(crate) fn of(&mut self, place: usize, body: &BodyPicture) -> &[[u32; 3]] {
        let Facets::Edges(edges) = &body.facets else { return &[] };
        let known = self.known.get(&place).is_some_and(|fill| {
            let same = fill.nodes == body.positions.len() && fill.edges == edges.len();
            same && (edges.len() > MOST_ANEW || fits(body, &fill.triangles))
        });
        if !known {
            let triangles = fill(body, edges);
            self.known.insert(place, Fill { nodes: body.positions.len(), edges: edges.len(), triangles });
        }
        self.known.get(&place).map_or(&[], |fill| &fill.triangles)
    }
}

/// Whether no triangle has turned over.
fn fits(body: &BodyPicture, triangles: &[[u32; 3]]) -> bool {
    triangles.iter().all(|t| area(t.map(|node| body.positions[node as usize])) >= 0.0)
}

fn area([a, b, c]: [[f64; 3]; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// The closed lines of a body's edges, each in its own direction.
fn loops(edges: &[[u32; 2]]) -> Vec<Vec<u32>> {
    let next: BTreeMap<u32, u32> = edges.iter().map(|[a, b]| (*a, *b)).collect();
    let mut left: std::collections::BTreeSet<u32> = next.keys().copied().collect();
    let mut out = Vec::new();
    while let Some(first) = left.pop_first() {
        let mut line = vec![first];
        let mut at = next.get(&first).copied();
        while let Some(node) = at.filter(|node| left.remove(node)) {
            line.push(node);
            at = next.get(&node).copied();
        }
        if line.len() >= 3 && at == Some(first) {
            out.push(line);
        }
    }
    out
}

/// Triangles within the outlines; a line that runs clockwise is a hole in the one around it.
fn fill(body: &BodyPicture, edges: &[[u32; 2]]) -> Vec<[u32; 3]> {
    let point = |node: u32| [body.positions[node as usize][0], body.positions[node as usize][1]];
    let twice = |line: &[u32]| -> f64 {
        (0..line.len())
            .map(|k| {
                let (a, b) = (point(line[k]), point(line[(k + 1) % line.len()]));
                a[0] * b[1] - a[1] * b[0]
            })
            .sum()
    };
    let (outer, holes): (Vec<Vec<u32>>, Vec<Vec<u32>>) = loops(edges).into_iter().partition(|line| twice(line) > 0.0);
    let within = |line: &[u32], p: [f64; 2]| {
        let crosses = |k: &usize| {
            let (a, b) = (point(line[*k]), point(line[(*k + 1) % line.len()]));
            (a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
        };
        (0..line.len()).filter(crosses).count() % 2 == 1
    };
    let mut triangles = Vec::new();
    let mut earcut = earcut::Earcut::new();
    for line in &outer {
        let mut nodes = line.clone();
        let mut starts: Vec<u32> = Vec::new();
        for hole in holes.iter().filter(|hole| within(line, point(hole[0]))) {
            starts.push(nodes.len() as u32);
            nodes.extend(hole);
        }
        let mut found: Vec<u32> = Vec::new();
        earcut.earcut(nodes.iter().map(|node| point(*node)), &starts, &mut found);
        for corners in found.chunks_exact(3) {
            let mut triangle = [0, 1, 2].map(|k| nodes[corners[k] as usize]);
            if area(triangle.map(|node| body.positions[node as usize])) < 0.0 {
                triangle.swap(1, 2);
            }
            triangles.push(triangle);
        }
    }
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;

    fn covered(body: &BodyPicture, triangles: &[[u32; 3]]) -> f64 {
        triangles.iter().map(|t| 0.5 * area(t.map(|node| body.positions[node as usize]))).sum()
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
        let mut fills = Fills::default();
        let triangles = fills.of(0, &body).to_vec();
        assert!((covered(&body, &triangles) - 3.0).abs() < 1e-12);
        // A corner is pushed in: the old triangles would overlap.
        body.positions[2] = [0.2, 0.2, 0.0];
        body.positions.truncate(4);
        body.facets = Facets::Edges((0..4).map(|k| [k, (k + 1) % 4]).collect());
        let triangles = fills.of(0, &body).to_vec();
        assert!((covered(&body, &triangles) - 0.4).abs() < 1e-12, "{triangles:?}");
    }
}
