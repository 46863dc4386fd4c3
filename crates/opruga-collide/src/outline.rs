//! The corners and edges of obstacles, which facets and edges of bodies touch.

use crate::closest::facet_normal;
use crate::collider::Form;
use crate::contacts::Colliders;
use crate::creases::Creases;
use crate::law::PairLaw;
use crate::vector::{add, dot, scaled, subtract};
use opruga_mesh::Mesh;

/// The corners and edges of an obstacle.
///
/// A ball is represented by a corner and a capsule by an edge, with the radius as part of the contact distance. Hollow shapes and
/// half-spaces have no corners that could pass between the nodes of a body.
#[derive(Clone, Debug)]
pub struct Outline<const D: usize> {
    /// The number of the collider.
    pub collider: usize,
    /// Corners, edges and faces of the collider as placed in the scene, before any motion [m]. The first points are inside
    /// faces and are not corners.
    pub mesh: Mesh<D>,
    /// The number of points inside plane faces; in the plane, inside straight lines. Such points belong only to faces.
    pub within_faces: usize,
    /// In space, the edges, ascending. Edges between two coplanar faces are omitted.
    pub edges: Vec<[u32; 2]>,
    /// The contact law of these features.
    pub law: PairLaw,
}

impl<const D: usize> Colliders<D> {
    /// The corners and edges of all colliders that have any, in order.
    pub fn outlines(&self) -> Vec<Outline<D>> {
        let mut out = Vec::new();
        for collider in 0..self.len() {
            let law = &self.collider(collider).law;
            let Some((mesh, radius)) = outline_of(&self.collider(collider).form) else { continue };
            let thickness = law.thickness + radius;
            let law = PairLaw { touch: true, friction: law.friction, restitution: law.restitution, thickness };
            let Creases { mesh, within_faces, edges } = Creases::of(mesh);
            out.push(Outline { collider, mesh, within_faces, edges, law });
        }
        out
    }

    /// Computes the positions [m] and velocities [m/s] of points of a collider at a time [s].
    pub fn move_points(&self, collider: usize, time: f64, points: &[[f64; D]], [x, v]: [&mut [[f64; D]]; 2]) {
        let pose = self.collider(collider).motion.pose(time);
        for ((point, x), v) in points.iter().zip(x).zip(v) {
            *x = pose.transform(point);
            *v = pose.velocity_at(x);
        }
    }
}

/// The corners, edges and faces of a form, and their contact distance.
fn outline_of<const D: usize>(form: &Form<D>) -> Option<(Mesh<D>, f64)> {
    let mesh = |positions: Vec<[f64; D]>| Mesh { positions, ..Mesh::default() };
    let facet = |corners: &[u32]| core::array::from_fn(|k| corners[k]);
    Some(match form {
        Form::HalfSpace { .. } | Form::Box { inside: true, .. } | Form::Ball { inside: true, .. } => return None,
        Form::Box { shape, inside: false } => {
            let mut out = mesh((0..1 << D).map(|bits| shape.corner(bits)).collect());
            for d in 0..D {
                for side in 0..2 {
                    // The corners of a face, along its other axes.
                    let (i, j) = (1u32 << ((d + 1) % D), 1u32 << ((d + 2) % D));
                    let first = side << d;
                    if D == 2 {
                        out.facets.push(facet(&[first, first + i]));
                    } else {
                        out.facets.push(facet(&[first, first + i, first + i + j]));
                        out.facets.push(facet(&[first, first + i + j, first + j]));
                    }
                }
            }
            turn_outward(&mut out);
            (out, 0.0)
        }
        Form::Ball { center, radius, inside: false } => (mesh(vec![*center]), *radius),
        Form::Capsule { a, b, radius } => {
            let mut out = mesh(vec![*a, *b]);
            out.wires.push([0, 1]);
            (out, *radius)
        }
        Form::Polygon { points } => {
            let mut out = mesh(points.clone());
            let count = points.len() as u32;
            out.facets.extend((0..count).map(|k| facet(&[k, (k + 1) % count])));
            turn_outward(&mut out);
            (out, 0.0)
        }
        Form::Polyline { points, closed } => {
            let mut out = mesh(points.clone());
            let count = points.len() as u32;
            out.wires.extend((1..count).map(|k| [k - 1, k]));
            out.wires.extend(closed.then_some([count - 1, 0]));
            (out, 0.0)
        }
        Form::Triangles { points, triangles, solid } => {
            let mut out = mesh(points.clone());
            if *solid {
                out.facets.extend(triangles.iter().map(|corners| facet(corners)));
                turn_outward(&mut out);
            } else {
                out.sheets.clone_from(triangles);
            }
            (out, 0.0)
        }
    })
}

/// Orients the faces of a convex solid with outward normals.
fn turn_outward<const D: usize>(mesh: &mut Mesh<D>) {
    let share = 1.0 / mesh.positions.len() as f64;
    let center = mesh.positions.iter().fold([0.0; D], |sum, x| add(&sum, &scaled(x, share)));
    for facet in &mut mesh.facets {
        let at = facet.map(|p| mesh.positions[p as usize]);
        if dot(&facet_normal(&at), &subtract(&at[0], &center)) < 0.0 {
            facet.swap(0, 1);
        }
    }
}
