//! Outlines through given points.

use crate::lattice::{check_points, without_repeated_end};
use crate::plane::outline;
use crate::{Mesh, MeshError, signed_volume};

/// An outline through given points, and whether it had to be turned.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    /// The outline; node i is point i.
    pub mesh: Mesh<2>,
    /// True where the points ran clockwise, so that the facets run against them.
    pub flipped: bool,
}

/// Twice the signed area of the triangle a b c [m²]; positive where c lies left of a → b.
fn side(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Lower and higher of two coordinates.
fn span(p: f64, q: f64) -> [f64; 2] {
    if p <= q { [p, q] } else { [q, p] }
}

/// Whether the segments a b and c d have a common point.
fn segments_meet(a: [f64; 2], b: [f64; 2], c: [f64; 2], d: [f64; 2]) -> bool {
    // Their boxes must overlap, and each must have no whole segment strictly on one side.
    let overlap = (0..2).all(|axis| {
        let (p, q) = (span(a[axis], b[axis]), span(c[axis], d[axis]));
        p[0] <= q[1] && q[0] <= p[1]
    });
    let parted = |p: f64, q: f64| (p > 0.0 && q > 0.0) || (p < 0.0 && q < 0.0);
    overlap && !parted(side(a, b, c), side(a, b, d)) && !parted(side(c, d, a), side(c, d, b))
}

impl Mesh<2> {
    /// An outline through the given points [m], in either direction; the first point may be repeated at the end.
    ///
    /// Node i is point i. Facets run counter-clockwise: with the points, or against them where these run clockwise, which `flipped` tells.
    ///
    /// # Errors
    /// [`MeshError::Count`] for fewer than 3 points; [`MeshError::Size`] where one is not finite or they enclose no area;
    /// [`MeshError::RepeatedPoint`] where two in a row coincide; [`MeshError::SelfIntersection`] with the first two edges that cross, touch or overlap.
    pub fn polygon(points: &[[f64; 2]]) -> Result<Polygon, MeshError> {
        let points = without_repeated_end(points);
        check_points(points, 3, true)?;
        if let Some([first, second]) = self_intersection(points) {
            let n = points.len();
            let ends = |edge: usize| [edge as u32, ((edge + 1) % n) as u32];
            return Err(MeshError::SelfIntersection { first: ends(first), second: ends(second) });
        }
        let mut mesh = outline(points.to_vec());
        let area = signed_volume(&mesh.facets, &mesh.positions);
        if area == 0.0 || !area.is_finite() {
            return Err(MeshError::Size { what: "area of the outline", value: area, must: "finite and not zero" });
        }
        let flipped = area < 0.0;
        if flipped {
            mesh.facets.iter_mut().for_each(|facet| facet.swap(0, 1));
        }
        Ok(Polygon { mesh, flipped })
    }
}

/// The lowest pair of edges of a closed outline that meet beyond a shared end. Edge i runs from point i to the next.
///
/// A sweep along the longer side of the bounding box: only edges that overlap there are compared.
fn self_intersection(points: &[[f64; 2]]) -> Option<[usize; 2]> {
    let n = points.len();
    let ends = |edge: usize| (points[edge], points[(edge + 1) % n]);

    let extent = |axis: usize| {
        let (mut low, mut high) = (points[0][axis], points[0][axis]);
        for point in points {
            low = span(low, point[axis])[0];
            high = span(high, point[axis])[1];
        }
        high - low
    };
    let axis = usize::from(extent(1) > extent(0));

    // Edges by where they begin along the sweep.
    let mut order: Vec<(f64, f64, usize)> = (0..n)
        .map(|edge| {
            let (a, b) = ends(edge);
            let [low, high] = span(a[axis], b[axis]);
            (low, high, edge)
        })
        .collect();
    order.sort_unstable_by(|p, q| p.0.total_cmp(&q.0).then(p.2.cmp(&q.2)));

    let mut active: Vec<(f64, usize)> = Vec::new();
    let mut found: Option<[usize; 2]> = None;
    for (low, high, edge) in order {
        active.retain(|other| other.0 >= low);
        for &(_, other) in &active {
            let pair = if edge < other { [edge, other] } else { [other, edge] };
            if found.is_none_or(|best| pair < best) && edges_conflict(points, pair) {
                found = Some(pair);
            }
        }
        active.push((high, edge));
    }
    found
}

/// Whether two edges, the lower first, meet in more than the end that neighbours share.
fn edges_conflict(points: &[[f64; 2]], [first, second]: [usize; 2]) -> bool {
    let n = points.len();
    let ends = |edge: usize| (points[edge], points[(edge + 1) % n]);
    let folds_back = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
        let ahead = (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1]);
        side(a, b, c) == 0.0 && ahead < 0.0
    };
    let ((a, b), (c, d)) = (ends(first), ends(second));
    if second == first + 1 {
        folds_back(a, b, d)
    } else if first == 0 && second == n - 1 {
        folds_back(c, d, b)
    } else {
        segments_meet(a, b, c, d)
    }
}
