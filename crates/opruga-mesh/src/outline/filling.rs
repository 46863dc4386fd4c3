//! The inside of closed curves as triangles.

use super::constrained::constrained;
use super::thin::Thin;
use super::{OutlineError, Ring, distance};
use crate::{MAXIMUM_NODES, Mesh};
use spade::{AngleLimit, Point2, RefinementParameters, Triangulation};
use std::collections::BTreeMap;

/// The ratio of the circumradius to the shortest edge at [`super::SMALLEST_ANGLE`]: ½ / sin 25°.
const RADIUS_TO_EDGE: f64 = 1.183_100_791_576_249_3;

/// √3 / 2, the ratio of the height of an equilateral triangle to its side.
const HEIGHT: f64 = 0.866_025_403_784_438_6;

/// The smallest distance of inner nodes from the outline, relative to the spacing.
const CLEARANCE: f64 = 0.6;

/// Triangles whose area is below this fraction of the squared spacing are not divided further. The fraction of an equilateral triangle is 0.43.
const SMALLEST_AREA: f64 = 0.1;

/// The approximate number of nodes of a filling: those of the rings, and one for every two triangles inside.
pub fn node_estimate(rings: &[Ring], spacing: f64) -> f64 {
    let inside: f64 = rings.iter().map(Ring::area).sum::<f64>() / (HEIGHT * spacing * spacing);
    let border: usize = rings.iter().map(|ring| ring.points.len()).sum();
    crate::mesh::estimated(border as f64 + inside.abs())
}

/// The inside of rings that [`super::nest`] has oriented, as a lattice of nearly equilateral triangles of side `spacing` [m].
///
/// Nodes of the rings come first and keep their order. Edges of the rings may be halved if a triangle would otherwise be too thin. Inside, the nodes
/// form a regular triangular lattice. Between this lattice and the outline there is a constrained Delaunay triangulation, which is refined until no
/// angle is below [`super::SMALLEST_ANGLE`]. Small triangles are not divided further, because smaller triangles would require short time steps.
/// Smaller angles in the result are reported.
///
/// # Errors
/// [`OutlineError::TooCoarse`] if edges of the rings cross, [`OutlineError::TooFine`] if the mesh would be too large.
///
/// # Source
/// J. Ruppert, "A Delaunay refinement algorithm for quality 2-dimensional mesh generation", J. Algorithms 18 (1995); library spade.
pub fn filled(rings: &[Ring], spacing: f64) -> Result<(Mesh<2>, Option<Thin>), OutlineError> {
    let estimate = node_estimate(rings, spacing) as u64;
    if estimate > MAXIMUM_NODES {
        return Err(OutlineError::TooFine { spacing, nodes: estimate });
    }
    let (low, high) = super::bounds(rings).ok_or(OutlineError::Empty {})?;
    let extent = distance(low, high);

    // The library needs numbers of moderate size, so the drawing is scaled to the unit square and back.
    let shrink = |p: [f64; 2]| Point2::new((p[0] - low[0]) / extent, (p[1] - low[1]) / extent);
    let failed = |part: u32, position| OutlineError::TooCoarse { spacing, parts: [part; 2], position };
    let (mut triangulation, given) = constrained(rings, &lattice(rings, low, high, spacing), shrink, failed)?;
    let parameters = RefinementParameters::<f64>::new()
        .with_angle_limit(AngleLimit::from_radius_to_shortest_edge_ratio(RADIUS_TO_EDGE))
        .with_min_required_area(SMALLEST_AREA * (spacing / extent) * (spacing / extent))
        .with_max_additional_vertices(4 * triangulation.num_vertices() + 1000)
        .exclude_outer_faces(true);
    let refined = triangulation.refine(parameters);

    // Nodes: first those of the rings, then those of the lattice, then those of the refinement in the order of their insertion.
    let mut outside = refined.excluded_faces;
    outside.sort_unstable();
    let number = |index: usize| given.get(index).copied().unwrap_or(index);
    let mut triangles: Vec<[u32; 3]> = triangulation
        .inner_faces()
        .filter(|face| outside.binary_search(&face.fix()).is_err())
        .map(|face| face.vertices().map(|vertex| number(vertex.fix().index()) as u32))
        .collect();
    let mut used = vec![false; triangulation.num_vertices()];
    triangles.iter().flatten().for_each(|node| used[*node as usize] = true);
    let border: Vec<[f64; 2]> = rings.iter().flat_map(|ring| ring.points.iter().copied()).collect();
    if !used[..border.len()].iter().all(|u| *u) {
        return Err(failed(0, low));
    }
    let mut vertices = vec![[0.0; 2]; used.len()];
    for vertex in triangulation.vertices() {
        let p = vertex.position();
        vertices[number(vertex.fix().index())] = [low[0] + p.x * extent, low[1] + p.y * extent];
    }
    // Points of the rings keep their bits.
    vertices[..border.len()].copy_from_slice(&border);
    let mut numbers = vec![0u32; used.len()];
    let mut positions = Vec::new();
    for (index, vertex) in vertices.into_iter().enumerate().filter(|(index, _)| used[*index]) {
        numbers[index] = positions.len() as u32;
        positions.push(vertex);
    }
    triangles.iter_mut().flatten().for_each(|node| *node = numbers[*node as usize]);
    for triangle in &mut triangles {
        let lowest = (0..3).min_by_key(|k| triangle[*k]).unwrap_or(0);
        triangle.rotate_left(lowest);
    }
    triangles.sort_unstable();
    let mut mesh = Mesh::<2> { positions, ..Mesh::default() };
    mesh.cells.triangles = triangles;
    mesh.facets = mesh.facets_from_cells()?;
    let thin = Thin::of(&mesh, rings, spacing, refined.refinement_complete);
    Ok((mesh, thin))
}

/// The inside of rings that do not meet, as triangles between their points, which are numbered ring by ring; no points are added.
///
/// # Errors
/// [`OutlineError::TooCoarse`] if rings meet, [`OutlineError::Empty`] without rings.
pub(crate) fn triangles_between(rings: &[Ring]) -> Result<Vec<[u32; 3]>, OutlineError> {
    let (low, high) = super::bounds(rings).ok_or(OutlineError::Empty {})?;
    let extent = distance(low, high);
    let shrink = |p: [f64; 2]| Point2::new((p[0] - low[0]) / extent, (p[1] - low[1]) / extent);
    let failed = |part: u32, position| OutlineError::TooCoarse { spacing: extent, parts: [part; 2], position };
    let (mut triangulation, given) = constrained(rings, &[], shrink, failed)?;
    // A refinement without new vertices reports which triangles are outside.
    let nothing = RefinementParameters::<f64>::new().with_max_additional_vertices(0).exclude_outer_faces(true);
    let mut outside = triangulation.refine(nothing).excluded_faces;
    outside.sort_unstable();
    let inner = triangulation.inner_faces().filter(|face| outside.binary_search(&face.fix()).is_err());
    Ok(inner.map(|face| face.vertices().map(|vertex| given[vertex.fix().index()] as u32)).collect())
}

/// Points of a triangular lattice inside the rings and at some distance from them, row by row.
fn lattice(rings: &[Ring], low: [f64; 2], high: [f64; 2], spacing: f64) -> Vec<[f64; 2]> {
    // Edges, sorted by the grid cells that they pass through.
    let cell = |x: f64| (x / spacing).floor() as i64;
    let edges: Vec<([f64; 2], [f64; 2])> = rings.iter().flat_map(Ring::edges).collect();
    let mut edges_by_cell: BTreeMap<(i64, i64), Vec<usize>> = BTreeMap::new();
    for (number, (a, b)) in edges.iter().enumerate() {
        let range = |axis: usize| {
            let (p, q) = (cell(a[axis] - low[axis]), cell(b[axis] - low[axis]));
            if p <= q { p..=q } else { q..=p }
        };
        for i in range(0) {
            for j in range(1) {
                edges_by_cell.entry((i, j)).or_default().push(number);
            }
        }
    }
    let clear = |point: [f64; 2]| {
        let (i, j) = (cell(point[0] - low[0]), cell(point[1] - low[1]));
        let around = (i - 1..=i + 1).flat_map(|i| (j - 1..=j + 1).map(move |j| (i, j)));
        around
            .filter_map(|key| edges_by_cell.get(&key))
            .flatten()
            .all(|edge| distance_to_segment(point, edges[*edge]) >= CLEARANCE * spacing)
    };

    // The lattice is centred in the box, so that symmetric outlines get symmetric lattices.
    let height = HEIGHT * spacing;
    let rows = ((high[1] - low[1]) / height).floor() as i64;
    let first_y = low[1] + 0.5 * ((high[1] - low[1]) - rows as f64 * height);
    let middle = 0.5 * (low[0] + high[0]);
    // A sweep from below: edges are added at their lower end and removed at their upper end.
    let lower =
        |edge: &usize| if edges[*edge].0[1] < edges[*edge].1[1] { edges[*edge].0[1] } else { edges[*edge].1[1] };
    let mut waiting: Vec<usize> = (0..edges.len()).collect();
    waiting.sort_by(|p, q| lower(q).total_cmp(&lower(p)));
    let mut active: Vec<usize> = Vec::new();
    let mut points = Vec::new();
    let mut crossings: Vec<f64> = Vec::new();
    for row in 0..=rows {
        let y = first_y + row as f64 * height;
        while let Some(edge) = waiting.pop_if(|edge| lower(edge) <= y) {
            active.push(edge);
        }
        active.retain(|edge| edges[*edge].0[1] > y || edges[*edge].1[1] > y);
        crossings.clear();
        for edge in &active {
            let (a, b) = edges[*edge];
            if (a[1] > y) != (b[1] > y) {
                crossings.push(a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]));
            }
        }
        crossings.sort_by(f64::total_cmp);
        let shift = if row % 2 == 0 { 0.0 } else { 0.5 };
        for inside in crossings.chunks_exact(2) {
            let column = |x: f64| ((x - middle) / spacing - shift).floor() as i64;
            for k in column(inside[0])..=column(inside[1]) + 1 {
                let x = middle + (k as f64 + shift) * spacing;
                if inside[0] <= x && x < inside[1] && clear([x, y]) {
                    points.push([x, y]);
                }
            }
        }
    }
    points
}

fn distance_to_segment(point: [f64; 2], (a, b): ([f64; 2], [f64; 2])) -> f64 {
    let (u, v) = ([b[0] - a[0], b[1] - a[1]], [point[0] - a[0], point[1] - a[1]]);
    let square = u[0] * u[0] + u[1] * u[1];
    let t = if square > 0.0 { (u[0] * v[0] + u[1] * v[1]) / square } else { 0.0 };
    let t = t.clamp(0.0, 1.0);
    distance(point, [a[0] + t * u[0], a[1] + t * u[1]])
}
