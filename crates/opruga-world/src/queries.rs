//! Queries of programs: the first body that a ray hits, and the nearest point of the bodies.

use crate::error::WorldError;
use crate::path_faults::PathFault;
use crate::world::World;
use opruga_collide::{closest_on_facet, closest_on_segment, facet_normal};
use opruga_math::Lane;
use opruga_mesh::winding_number;

/// A point on the surface of a body as it is now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint<const D: usize> {
    /// The body, by its index in the scene.
    pub body: usize,
    /// The nodes of its edge (2D) or triangle (3D). A wire in space has only two nodes, of which the second is repeated with weight 0.
    pub nodes: [u32; D],
    /// The weights of these nodes at the point; their sum is 1.
    pub weights: [f64; D],
    /// Its position [m].
    pub position: [f64; D],
    /// The unit normal. The normal points out of a closed boundary; for an open surface or a wire it points towards the origin of the query.
    pub normal: [f64; D],
    /// The distance along the ray, or from the given point [m]. Negative if that point is inside a closed boundary.
    pub distance: f64,
}

impl<const D: usize> SurfacePoint<D> {
    /// The same point in space; an edge in the plane repeats its second node with weight 0.
    pub(crate) fn in_space(self) -> SurfacePoint<3> {
        let lift = |a: [f64; D]| core::array::from_fn(|d| if d < D { a[d] } else { 0.0 });
        let nodes = core::array::from_fn(|k| self.nodes[if k < D { k } else { D - 1 }]);
        SurfacePoint {
            body: self.body,
            nodes,
            weights: lift(self.weights),
            position: lift(self.position),
            normal: lift(self.normal),
            distance: self.distance,
        }
    }
}

/// A facet of a body, or a wire in space.
#[derive(Clone, Copy, Debug)]
struct Piece<const D: usize> {
    body: usize,
    nodes: [u32; D],
    at: [[f64; D]; D],
    closed: bool,
    wire: bool,
}

fn minus<const D: usize>(a: &[f64; D], b: &[f64; D]) -> [f64; D] {
    core::array::from_fn(|d| a[d] - b[d])
}

fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The vector scaled to length 1; unchanged if it has no direction.
fn unit<const D: usize>(a: [f64; D]) -> [f64; D] {
    let length = dot(&a, &a).sqrt();
    if length > 0.0 { a.map(|c| c / length) } else { a }
}

/// The intersection of a ray and a facet: the length along the ray, and the weights of the corners. Points on an edge belong to both of its facets.
fn meet<const D: usize>(origin: &[f64; D], direction: &[f64; D], at: &[[f64; D]; D]) -> Option<(f64, [f64; D])> {
    let normal = facet_normal(at);
    let slope = dot(direction, &normal);
    let length = dot(&minus(&at[0], origin), &normal) / slope;
    if !(length >= 0.0 && length.is_finite()) {
        return None;
    }
    let point: [f64; D] = core::array::from_fn(|d| origin[d] + length * direction[d]);
    let mut weights = [0.0; D];
    if D == 2 {
        let e = minus(&at[1], &at[0]);
        let t = dot(&minus(&point, &at[0]), &e) / dot(&e, &e);
        (weights[0], weights[1]) = (1.0 - t, t);
    } else {
        for k in 0..D {
            let mut part = *at;
            part[k] = point;
            weights[k] = signed_area(&part, &normal);
        }
        let whole: f64 = weights.iter().sum();
        weights = weights.map(|w| w / whole);
    }
    // Because of this tolerance, rounding lets no ray pass between two facets.
    weights.iter().all(|w| *w >= -1e-12).then_some((length, weights))
}

fn signed_area<const D: usize>(at: &[[f64; D]; D], normal: &[f64; D]) -> f64 {
    let (e, f) = (minus(&at[1], &at[0]), minus(&at[D - 1], &at[0]));
    (0..D).map(|d| normal[d] * (e[(d + 1) % D] * f[(d + 2) % D] - e[(d + 2) % D] * f[(d + 1) % D])).sum()
}

impl<const D: usize> World<D> {
    /// The first point of a body that a ray hits, at most `reach` [m] from its origin; `None` if it hits nothing. Wires in space are too thin to be
    /// hit. If points have the same distance, the first body and facet win.
    ///
    /// # Errors
    /// [`WorldError::Path`] for an origin, direction or reach that is not finite, and for a direction of length zero.
    pub fn cast_ray(
        &self,
        origin: [f64; D],
        direction: [f64; D],
        reach: f64,
    ) -> Result<Option<SurfacePoint<D>>, WorldError> {
        refuse_infinite("origin", &origin)?;
        refuse_infinite("direction", &direction)?;
        refuse_reach(reach)?;
        let most = direction.iter().fold(0.0, |most: f64, d| if d.abs() > most { d.abs() } else { most });
        if most == 0.0 {
            return Err(WorldError::path("direction", PathFault::NoDirection { value: format!("{direction:?}") }));
        }
        let direction = unit(direction.map(|d| d / most));
        let mut best: Option<SurfacePoint<D>> = None;
        for body in self.bodies() {
            let farthest = best.map_or(reach, |best| best.distance);
            let [low, high] = self.bounds_of(body);
            // The part of the ray within the box.
            let (mut enter, mut leave) = (0.0, farthest);
            for d in 0..D {
                let [a, b] = [low[d], high[d]].map(|bound| (bound - origin[d]) / direction[d]);
                // NaN if the ray runs along a face of the box; the comparisons then ignore it.
                let (a, b) = if a < b { (a, b) } else { (b, a) };
                enter = if a > enter { a } else { enter };
                leave = if b < leave { b } else { leave };
            }
            if enter > leave + 1e-9 * (1.0 + farthest.smaller(enter)) {
                continue;
            }
            self.pieces(body, &mut |piece| {
                let Some((length, weights)) = meet(&origin, &direction, &piece.at).filter(|_| !piece.wire) else {
                    return;
                };
                if length > best.map_or(reach, |best| best.distance) || best.is_some_and(|best| best.distance == length)
                {
                    return;
                }
                best = Some(self.surface_point(&piece, weights, &origin, length));
            });
        }
        Ok(best)
    }

    /// The point nearest to a given point on the surfaces of all bodies, at most `reach` [m] away; `None` if there is no such point. If points have
    /// the same distance, the first body and facet win.
    ///
    /// # Errors
    /// [`WorldError::Path`] for a point or reach that is not finite.
    pub fn nearest_surface_point(&self, point: [f64; D], reach: f64) -> Result<Option<SurfacePoint<D>>, WorldError> {
        refuse_infinite("point", &point)?;
        refuse_reach(reach)?;
        let mut best: Option<(f64, Piece<D>, [f64; D])> = None;
        for body in self.bodies() {
            let [low, high] = self.bounds_of(body);
            let outside: [f64; D] = core::array::from_fn(|d| {
                let beyond = if point[d] < low[d] { low[d] - point[d] } else { point[d] - high[d] };
                if beyond > 0.0 { beyond } else { 0.0 }
            });
            let farthest = best.as_ref().map_or(reach, |best| best.0);
            if dot(&outside, &outside).sqrt() > farthest {
                continue;
            }
            self.pieces(body, &mut |piece| {
                let weights = if piece.wire {
                    let t = closest_on_segment(&point, &piece.at[0], &piece.at[1]);
                    core::array::from_fn(|k| [1.0 - t, t, 0.0][k])
                } else {
                    closest_on_facet(&point, &piece.at)
                };
                let between = minus(&point, &position_of(&piece.at, &weights));
                let distance = dot(&between, &between).sqrt();
                let nearer = best.as_ref().is_none_or(|best| distance < best.0);
                if nearer && distance <= reach {
                    best = Some((distance, piece, weights));
                }
            });
        }
        Ok(best.map(|(distance, piece, weights)| {
            let mesh = &self.blueprint.bodies[piece.body].mesh;
            let inside = piece.closed && {
                let positions: Vec<[f64; D]> =
                    (0..mesh.nodes() as u32).map(|node| self.position(piece.body, node)).collect();
                winding_number(&mesh.facets, &positions, &point) > 0.5
            };
            self.surface_point(&piece, weights, &point, if inside { -distance } else { distance })
        }))
    }

    fn surface_point(&self, piece: &Piece<D>, weights: [f64; D], from: &[f64; D], distance: f64) -> SurfacePoint<D> {
        let position = position_of(&piece.at, &weights);
        let towards = minus(from, &position);
        let mut normal = if piece.wire { unit(towards) } else { unit(facet_normal(&piece.at)) };
        if !piece.closed && dot(&normal, &towards) < 0.0 {
            normal = normal.map(|n| -n);
        }
        SurfacePoint { body: piece.body, nodes: piece.nodes, weights, position, normal, distance }
    }

    /// Visits the boundary, open surfaces and wires of a body, in this order.
    fn pieces(&self, body: usize, visit: &mut dyn FnMut(Piece<D>)) {
        let mesh = &self.blueprint.bodies[body].mesh;
        let mut piece = |nodes: [u32; D], closed: bool, wire: bool| {
            visit(Piece { body, nodes, at: nodes.map(|node| self.position(body, node)), closed, wire });
        };
        mesh.facets.iter().for_each(|facet| piece(*facet, true, false));
        if D == 3 {
            mesh.sheets.iter().for_each(|sheet| piece(core::array::from_fn(|k| sheet[k]), false, false));
        }
        mesh.wires.iter().for_each(|[a, b]| piece(core::array::from_fn(|k| [*a, *b, *b][k]), false, D == 3));
    }
}

fn position_of<const D: usize>(at: &[[f64; D]; D], weights: &[f64; D]) -> [f64; D] {
    core::array::from_fn(|d| (0..D).map(|k| weights[k] * at[k][d]).sum())
}

fn refuse_infinite<const D: usize>(name: &str, numbers: &[f64; D]) -> Result<(), WorldError> {
    if numbers.iter().all(|x| x.is_finite()) {
        return Ok(());
    }
    Err(WorldError::path(name, PathFault::NotFinite { value: format!("{numbers:?}") }))
}

fn refuse_reach(reach: f64) -> Result<(), WorldError> {
    if reach >= 0.0 {
        return Ok(());
    }
    Err(WorldError::path("reach", PathFault::IsText { value: reach.to_string(), allowed: ">= 0".into() }))
}
