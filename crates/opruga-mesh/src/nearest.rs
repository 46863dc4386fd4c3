//! The point of a surface nearest to another point.

use crate::Mesh;
use crate::boxes::{Tree, distance_to};
use crate::geometry::{dot, subtract};

/// A surface prepared for queries of its nearest points.
pub(crate) struct Nearest {
    tree: Tree,
    corners: Vec<[[f64; 3]; 3]>,
}

impl Nearest {
    pub(crate) fn to(mesh: &Mesh<3>) -> Nearest {
        let corners: Vec<[[f64; 3]; 3]> =
            mesh.facets.iter().map(|facet| facet.map(|node| mesh.positions[node as usize])).collect();
        Nearest { tree: Tree::of(corners.iter().copied()), corners }
    }

    /// The point of the surface nearest to a point; if there are several, the point on the facet with the lowest number.
    pub(crate) fn point(&self, from: [f64; 3]) -> [f64; 3] {
        let mut best = (f64::INFINITY, u32::MAX, from);
        let mut waiting = vec![1usize];
        while let Some(node) = waiting.pop() {
            if distance_to(&self.tree.boxes[node], &from) > best.0 {
                continue;
            }
            if node < self.tree.leaves {
                // The nearer of the two nodes is examined first.
                let far = |node: usize| distance_to(&self.tree.boxes[node], &from);
                let (p, q) = (2 * node, 2 * node + 1);
                waiting.extend(if far(p) < far(q) { [q, p] } else { [p, q] });
                continue;
            }
            for &facet in self.tree.facets_of(node - self.tree.leaves) {
                let point = nearest_on(&self.corners[facet as usize], from);
                let offset = subtract(point, from);
                let square = dot(offset, offset);
                if square < best.0 || square == best.0 && facet < best.1 {
                    best = (square, facet, point);
                }
            }
        }
        best.2
    }
}

/// The point of a triangle nearest to a point, found by testing the regions of its corners and sides before its interior.
///
/// Source: C. Ericson, Real-Time Collision Detection (2005), section 5.1.5.
fn nearest_on(&[a, b, c]: &[[f64; 3]; 3], p: [f64; 3]) -> [f64; 3] {
    let along = |from: [f64; 3], u: [f64; 3], s: f64| core::array::from_fn(|d| from[d] + s * u[d]);
    let (ab, ac, bc) = (subtract(b, a), subtract(c, a), subtract(c, b));
    let (ap, bp, cp) = (subtract(p, a), subtract(p, b), subtract(p, c));
    let (d1, d2) = (dot(ab, ap), dot(ac, ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let (d3, d4) = (dot(ab, bp), dot(ac, bp));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return along(a, ab, d1 / (d1 - d3));
    }
    let (d5, d6) = (dot(ab, cp), dot(ac, cp));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return along(a, ac, d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return along(b, bc, (d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    let whole = va + vb + vc;
    core::array::from_fn(|d| a[d] + ab[d] * (vb / whole) + ac[d] * (vc / whole))
}
