//! The boundary of a body: its sides, the smooth parts that meet at its vertices, and the collocation points.

use super::integrals::Side;
use super::refusals::Refusal;
use opruga_mesh::{Mesh, MeshError, THIN_ELEMENT, crossing_edges, winding_number};

/// Sides belong to one smooth part if their normals differ by less than 40°.
const COSINE_OF_SMOOTH: f64 = 0.766_044_443_118_978;

/// If a vertex has several normals, its collocation points lie inside the sides. The constants are the distances of the points
/// from the vertex, as fractions of the distance to each of the other corners. A quarter of an edge is close to (1 − 1/√3)/2,
/// the best point for linear elements with a jump at their ends.
const INSET: [f64; 2] = [0.25, 1.0 / 6.0];

/// A collocation point.
#[derive(Clone, Debug)]
pub(super) struct Source<const D: usize> {
    pub(super) at: [f64; D],
    /// The vertex at this point, or `None` if the point lies inside a side.
    pub(super) vertex: Option<u32>,
    /// A side that contains the collocation point, and the shape functions of the side there.
    pub(super) side: u32,
    pub(super) shape: [f64; D],
}

/// A boundary, in units of its own size.
#[derive(Clone, Debug)]
pub(super) struct Surface<const D: usize> {
    pub(super) nodes: usize,
    /// The vertices of each side, oriented with the solid behind it.
    pub(super) facets: Vec<[u32; D]>,
    pub(super) sides: Vec<Side<D>>,
    /// The number of the traction at each corner of each side.
    pub(super) corners: Vec<[u32; D]>,
    /// One source for each traction.
    pub(super) sources: Vec<Source<D>>,
    /// The vertices relative to their mean, in units of the size.
    pub(super) points: Vec<[f64; D]>,
    /// The length of the diagonal of the bounding box [m], and the mean of the vertices [m].
    pub(super) size: f64,
    pub(super) center: [f64; D],
    /// The number of sides whose orientation was reversed so that the solid is behind each.
    pub(super) turned: usize,
}

impl<const D: usize> Surface<D> {
    /// Extracts the boundary of a mesh. The solid is inside the boundary or, with `exterior`, all around it.
    pub(super) fn of(mesh: &Mesh<D>, exterior: bool) -> Result<Surface<D>, Refusal> {
        let nodes = mesh.nodes();
        if mesh.facets.is_empty() {
            return Err(Refusal::NoSurface {});
        }
        let mut touched = vec![false; nodes];
        mesh.facets.iter().flatten().for_each(|node| touched[*node as usize] = true);
        let inner: Vec<usize> = (0..nodes).filter(|node| !touched[*node]).collect();
        if let Some(first) = inner.first() {
            return Err(Refusal::InnerNodes { count: inner.len(), nodes, first: *first });
        }
        refuse_degenerate(mesh)?;
        let (facets, turned) = oriented(mesh, exterior)?;
        refuse_crossing(mesh)?;

        let (low, high) = bounds(&mesh.positions);
        let size = (0..D).map(|d| (high[d] - low[d]) * (high[d] - low[d])).sum::<f64>().sqrt();
        let mut center = [0.0; D];
        for x in &mesh.positions {
            for d in 0..D {
                // Relative to a corner, so that bodies far from the origin keep their digits.
                center[d] += (x[d] - low[d]) / nodes as f64;
            }
        }
        let points: Vec<[f64; D]> =
            mesh.positions.iter().map(|x| core::array::from_fn(|d| ((x[d] - low[d]) - center[d]) / size)).collect();
        for d in 0..D {
            center[d] += low[d];
        }
        let sides: Vec<Side<D>> = facets.iter().map(|facet| side(&facet.map(|node| points[node as usize]))).collect();
        let mut surface = Surface {
            nodes,
            corners: vec![[0; D]; facets.len()],
            facets,
            sides,
            sources: Vec::new(),
            points,
            size,
            center,
            turned,
        };
        surface.number_tractions();
        Ok(surface)
    }

    /// Assigns every smooth part at every vertex a traction and a collocation point.
    fn number_tractions(&mut self) {
        let mut around: Vec<Vec<(u32, usize)>> = vec![Vec::new(); self.nodes];
        for (number, facet) in self.facets.iter().enumerate() {
            for (corner, node) in facet.iter().enumerate() {
                around[*node as usize].push((number as u32, corner));
            }
        }
        for (vertex, around) in around.iter().enumerate() {
            let parts = self.smooth_parts(vertex as u32, around);
            for part in &parts {
                let number = self.sources.len() as u32;
                for (facet, corner) in part {
                    self.corners[*facet as usize][*corner] = number;
                }
                // The collocation point lies on the side with the widest angle, where the distances from the edges are largest.
                let mut widest = part[0];
                let mut least = 2.0;
                for own in part {
                    let cosine = self.cosine_at(*own);
                    if cosine < least - 1e-9 {
                        (widest, least) = (*own, cosine);
                    }
                }
                let (facet, corner) = widest;
                let mut shape = [0.0; D];
                let moved = parts.len() > 1;
                let inset = if moved { INSET[D - 2] } else { 0.0 };
                for (k, shape) in shape.iter_mut().enumerate() {
                    *shape = if k == corner { 1.0 - (D - 1) as f64 * inset } else { inset };
                }
                let corners = &self.sides[facet as usize].corners;
                let at = core::array::from_fn(|d| (0..D).map(|k| shape[k] * corners[k][d]).sum());
                let vertex = (!moved).then_some(vertex as u32);
                self.sources.push(Source { at, vertex, side: facet, shape });
            }
        }
    }

    /// Groups the sides around a vertex by smooth parts, in the order of their first sides.
    fn smooth_parts(&self, vertex: u32, around: &[(u32, usize)]) -> Vec<Vec<(u32, usize)>> {
        let mut part: Vec<usize> = (0..around.len()).collect();
        for a in 0..around.len() {
            for b in a + 1..around.len() {
                let (own, other) = (around[a].0 as usize, around[b].0 as usize);
                // Neighbouring sides share only the vertex in the plane, and an edge from the vertex in space.
                let shared = self.facets[own].iter().filter(|node| self.facets[other].contains(node)).count();
                let cosine: f64 = (0..D).map(|d| self.sides[own].normal[d] * self.sides[other].normal[d]).sum();
                if shared >= D - 1 && cosine >= COSINE_OF_SMOOTH {
                    let (low, high) = if part[a] < part[b] { (part[a], part[b]) } else { (part[b], part[a]) };
                    part.iter_mut().filter(|own| **own == high).for_each(|own| *own = low);
                }
            }
        }
        debug_assert!(around.iter().all(|(facet, corner)| self.facets[*facet as usize][*corner] == vertex));
        let mut parts: Vec<Vec<(u32, usize)>> = Vec::new();
        for first in 0..around.len() {
            let own: Vec<(u32, usize)> = (0..around.len()).filter(|k| part[*k] == first).map(|k| around[k]).collect();
            if !own.is_empty() {
                parts.push(own);
            }
        }
        parts
    }

    /// The cosine of the angle of a side at a corner. In the plane it is zero, so that all edges count alike.
    fn cosine_at(&self, (facet, corner): (u32, usize)) -> f64 {
        if D == 2 {
            return 0.0;
        }
        let corners = &self.sides[facet as usize].corners;
        let arm =
            |k: usize| -> [f64; D] { core::array::from_fn(|d| corners[(corner + k) % D][d] - corners[corner][d]) };
        let (a, b) = (arm(1), arm(2));
        let dot = |a: &[f64; D], b: &[f64; D]| (0..D).map(|d| a[d] * b[d]).sum::<f64>();
        dot(&a, &b) / (dot(&a, &a) * dot(&b, &b)).sqrt()
    }
}

/// Makes a side from its corners.
fn side<const D: usize>(corners: &[[f64; D]; D]) -> Side<D> {
    let arm = |k: usize| -> [f64; D] { core::array::from_fn(|d| corners[k][d] - corners[0][d]) };
    let mut normal = [0.0; D];
    let first = arm(1);
    if D == 2 {
        (normal[0], normal[1]) = (first[1], -first[0]);
    } else {
        let second = arm(2);
        for d in 0..D {
            let (p, q) = ((d + 1) % D, (d + 2) % D);
            normal[d] = first[p] * second[q] - first[q] * second[p];
        }
    }
    let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
    Side { corners: *corners, normal: normal.map(|x| x / length), measure: length / (D - 1) as f64 }
}

fn bounds<const D: usize>(positions: &[[f64; D]]) -> ([f64; D], [f64; D]) {
    let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
    for x in positions {
        for d in 0..D {
            low[d] = if x[d] < low[d] { x[d] } else { low[d] };
            high[d] = if x[d] > high[d] { x[d] } else { high[d] };
        }
    }
    (low, high)
}

/// Orients the facets so that the solid lies behind each of them, and returns how many were reversed. A closed boundary inside
/// another one is a cavity, whatever its orientation.
fn oriented<const D: usize>(mesh: &Mesh<D>, exterior: bool) -> Result<(Vec<[u32; D]>, usize), Refusal> {
    let components = mesh.components()?;
    let of = |component: &opruga_mesh::Component| -> Vec<[u32; D]> {
        component.facets.iter().map(|facet| mesh.facets[*facet as usize]).collect()
    };
    let lists: Vec<Vec<[u32; D]>> = components.iter().map(of).collect();
    let mut facets = mesh.facets.clone();
    let (mut solids, mut turned) = (0, 0);
    for (number, component) in components.iter().enumerate() {
        let point = mesh.positions[lists[number][0][0] as usize];
        let around = lists
            .iter()
            .enumerate()
            .filter(|(other, list)| *other != number && winding_number(list, &mesh.positions, &point).abs() > 0.5);
        let is_inside = around.count() % 2 == 1;
        if exterior && is_inside {
            return Err(Refusal::NestedExterior { facet: component.facets[0] });
        }
        solids += usize::from(!is_inside);
        // Normals point out of the solid. For the medium around a boundary, the caller reverses the normal.
        if (component.signed_volume > 0.0) == is_inside {
            turned += component.facets.len();
            component.facets.iter().for_each(|facet| facets[*facet as usize].swap(0, 1));
        }
    }
    if solids > 1 && !exterior {
        return Err(Refusal::SeveralSolids { solids });
    }
    if exterior {
        facets.iter_mut().for_each(|facet| facet.swap(0, 1));
    }
    Ok((facets, turned))
}

fn refuse_degenerate<const D: usize>(mesh: &Mesh<D>) -> Result<(), Refusal> {
    let (low, high) = bounds(&mesh.positions);
    let size = (0..D).map(|d| (high[d] - low[d]) * (high[d] - low[d])).sum::<f64>().sqrt();
    for (facet, nodes) in mesh.facets.iter().enumerate() {
        let corners = nodes.map(|node| mesh.positions[node as usize]);
        let mut edge = 0.0;
        for k in 0..D {
            let (a, b) = (&corners[k], &corners[(k + 1) % D]);
            let length = (0..D).map(|d| (a[d] - b[d]) * (a[d] - b[d])).sum::<f64>().sqrt();
            edge = if length > edge { length } else { edge };
        }
        let measure = side(&corners).measure;
        let least = THIN_ELEMENT * if D == 2 { size } else { edge * edge };
        if !measure.is_finite() || measure <= least {
            return Err(Refusal::Degenerate { facet, measure, edge });
        }
    }
    Ok(())
}

/// Refuses boundaries that intersect themselves.
fn refuse_crossing<const D: usize>(mesh: &Mesh<D>) -> Result<(), Refusal> {
    if D == 3 {
        let lifted = Mesh::<3> {
            positions: mesh.positions.iter().map(|x| core::array::from_fn(|d| x[d])).collect(),
            facets: mesh.facets.iter().map(|facet| core::array::from_fn(|k| facet[k])).collect(),
            ..Mesh::default()
        };
        let pinched = lifted.pinched_nodes();
        if !pinched.is_empty() {
            return Err(MeshError::NonManifoldNodes { nodes: pinched }.into());
        }
        let crossings = lifted.crossing_facets();
        return match crossings.pairs.first() {
            Some([first, second]) => {
                Err(Refusal::Crossing { count: crossings.pairs.len(), first: *first, second: *second })
            }
            None => Ok(()),
        };
    }
    let edges: Vec<[u32; 2]> = mesh.facets.iter().map(|facet| [facet[0], facet[1]]).collect();
    let positions: Vec<[f64; 2]> = mesh.positions.iter().map(|x| [x[0], x[1]]).collect();
    let pairs = crossing_edges(&edges, &positions).pairs;
    match pairs.first() {
        Some([first, second]) => Err(Refusal::Crossing { count: pairs.len(), first: *first, second: *second }),
        None => Ok(()),
    }
}
