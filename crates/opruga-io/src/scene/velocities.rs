//! The initial velocity of a body: one vector, or a field.

use super::errors::{BodyError, SceneAllowed, SceneHint};
use super::location_of;
use super::reader::{Reader, join};
use crate::document::{Data, Node};
use crate::problem::{SceneError, visible};
use opruga_core::spec::{Allowed, Role, Spec, Value};
use opruga_mesh::{Mesh, NodeValues};
use opruga_world::{schema, shapes};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The initial motion of a body.
pub(super) struct Velocities<const D: usize> {
    /// The velocity of the centre of mass [m/s].
    pub(super) linear: [f64; D],
    /// The angular velocity about the centre of mass [rad/s]: one number in 2D, three in 3D.
    pub(super) angular: Vec<f64>,
    /// ∂v/∂x, row by row [1/s].
    pub(super) gradient: [[f64; D]; D],
    /// The name of vectors in the mesh file [m/s], if each node has its own velocity.
    of_nodes: Option<String>,
}

/// Reads `velocity` and `angular_velocity`.
pub(super) fn at_the_start<const D: usize>(reader: &mut Reader<'_>, node: &Node, path: &str) -> Velocities<D> {
    let angular = reader.turn(node.get("angular_velocity"), &join(path, "angular_velocity"));
    let mut out = Velocities { linear: [0.0; D], angular, gradient: [[0.0; D]; D], of_nodes: None };
    let Some(value) = node.get("velocity") else { return out };
    let here = join(path, "velocity");
    if !matches!(value.data, Data::Table(_)) {
        if let Some(Value::Numbers(row)) = reader.plain(value, &here, "velocity", &Allowed::Vector) {
            out.linear.copy_from_slice(&row);
        }
        return out;
    }
    let values = reader.fields(value, &here, &schema::VELOCITY, None);
    out.linear = values.vector("linear");
    out.of_nodes = values.text("of_nodes").map(String::from);
    if let Some(spin) = value.get("angular") {
        let angular = join(&here, "angular");
        if node.get("angular_velocity").is_some() {
            reader.report(spin.location, SceneError::of(BodyError::TwoSpins { value: spin.shown() }).path(angular));
            return out;
        }
        out.angular = reader.turn(Some(spin), &angular);
    }
    let rows = values.rows("gradient");
    if rows.len() == D {
        for (to, row) in out.gradient.iter_mut().zip(rows) {
            to.copy_from_slice(row);
        }
    } else if !rows.is_empty() {
        let value_shown = value.get("gradient").map_or(String::new(), Node::shown);
        let about = BodyError::Gradient { count: rows.len(), dimension: D, value: value_shown };
        let hint = if D == 2 { SceneHint::Gradient {} } else { SceneHint::GradientInSpace {} };
        let error = SceneError::of(about).path(join(&here, "gradient")).advice(hint);
        reader.report(location_of(value, "gradient"), error);
    }
    out
}

impl<const D: usize> Velocities<D> {
    /// The path, within a body, of the field that names the vectors of nodes.
    pub(super) const OF_NODES: [&str; 2] = ["velocity", "of_nodes"];

    /// The velocities of single nodes, from the values of nodes in the mesh file; they are rotated like the body.
    ///
    /// # Errors
    /// `scene.no_values`, `scene.length`, `scene.not_finite`, `scene.dimension`, `scene.range`.
    pub(super) fn of_nodes(
        &self,
        all: &BTreeMap<String, NodeValues>,
        shape: &Spec,
        rotation: &[f64],
    ) -> Result<Arc<[[f64; D]]>, SceneError> {
        let Some(name) = &self.of_nodes else { return Ok(Arc::from([])) };
        let shown = || visible(name);
        let fits = |field: &NodeValues| field.components == 3 || field.components == D;
        let Some(field) = all.get(name) else {
            let known: Vec<String> =
                all.iter().filter(|(_, f)| fits(f)).map(|(known, _)| format!("`{}`", visible(known))).collect();
            let error = SceneError::of(match shape.has_role(Role::CellsFromFile) {
                true => BodyError::NoNodeVectors { name: shown() },
                false => BodyError::NotAMeshFile { name: shown(), kind: shape.kind.into() },
            });
            return Err(match known.is_empty() {
                true => error.allows(SceneAllowed::ThereAreNone {}),
                false => error.allowed(known.join(", ")),
            });
        };
        if !fits(field) {
            let (name, components) = (shown(), field.components);
            return Err(SceneError::of(match D {
                2 => BodyError::ComponentsInPlane { name, components },
                _ => BodyError::ComponentsInSpace { name, components },
            }));
        }
        let mut rows = Vec::with_capacity(field.values.len() / field.components);
        for (node, row) in field.values.chunks_exact(field.components).enumerate() {
            if let Some(x) = row.iter().find(|x| !x.is_finite()) {
                return Err(SceneError::of(BodyError::NodeValue { name: shown(), node, value: x.to_string() }));
            }
            if let Some(z) = row.get(D).filter(|z| **z != 0.0) {
                return Err(SceneError::of(BodyError::LeavesPlane { name: shown(), node, z: *z }));
            }
            rows.push(core::array::from_fn(|d| row[d]));
        }
        // The vectors are rotated like positions, about the origin.
        let mut turned = Mesh::<D> { positions: rows, ..Mesh::default() };
        let refused = |problem| SceneError::of(BodyError::Rotation { problem });
        shapes::apply_transform(&mut turned, &shapes::Transform { scale: 1.0, rotation }).map_err(refused)?;
        match turned.positions.iter().flatten().find(|x| !x.is_finite()) {
            Some(x) => Err(SceneError::of(BodyError::Turned { name: shown(), value: *x })),
            None => Ok(Arc::from(turned.positions)),
        }
    }
}
