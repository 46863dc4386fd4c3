//! The velocity of a body at the start: one vector, or a field.

use super::place_of;
use super::reader::{Reader, join};
use crate::document::{Data, Node};
use crate::problem::SceneError;
use opruga_core::spec::{Allowed, Value};
use opruga_world::schema;

/// How a body moves at the start.
pub(super) struct Velocities<const D: usize> {
    /// Of the centre of mass [m/s].
    pub(super) linear: [f64; D],
    /// About the centre of mass [rad/s]: one number in 2D, three in 3D.
    pub(super) angular: Vec<f64>,
    /// ∂v/∂x, row by row [1/s].
    pub(super) gradient: [[f64; D]; D],
}

/// Reads `velocity` and `angular_velocity`.
pub(super) fn at_the_start<const D: usize>(reader: &mut Reader<'_>, node: &Node, path: &str) -> Velocities<D> {
    let angular = reader.turn(node.get("angular_velocity"), &join(path, "angular_velocity"));
    let mut out = Velocities { linear: [0.0; D], angular, gradient: [[0.0; D]; D] };
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
    if let Some(spin) = value.get("angular") {
        let angular = join(&here, "angular");
        if node.get("angular_velocity").is_some() {
            let error = SceneError::new("scene.conflict", "the body has `angular_velocity` and `velocity.angular`");
            let error = error.path(angular).value(spin.shown()).allowed("one of them");
            reader.report(spin.place, error);
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
        let count = rows.len();
        let message = format!("`gradient` has {count} {}", if count == 1 { "row" } else { "rows" });
        let error = SceneError::new("scene.length", message).path(join(&here, "gradient"));
        let error = error
            .allowed(format!("{D} rows of {D} finite numbers: how each axis of the velocity changes along every axis"));
        let hint = match D {
            2 => "[[0.1, 0], [0, 0]] stretches along x, [[0, 1], [0, 0]] shears",
            _ => "[[0.1, 0, 0], [0, 0, 0], [0, 0, 0]] stretches along x",
        };
        let shown = value.get("gradient").map_or(String::new(), Node::shown);
        reader.report(place_of(value, "gradient"), error.value(shown).hint(hint));
    }
    out
}
