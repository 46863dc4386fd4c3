//! The velocity of a body at the start: one vector, or a field.

use super::place_of;
use super::reader::{Reader, join};
use crate::document::{Data, Node};
use crate::problem::{SceneError, visible};
use opruga_core::spec::{Allowed, Value};
use opruga_mesh::{Mesh, NodeValues};
use opruga_world::{schema, shapes};
use std::collections::BTreeMap;
use std::sync::Arc;

/// How a body moves at the start.
pub(super) struct Velocities<const D: usize> {
    /// Of the centre of mass [m/s].
    pub(super) linear: [f64; D],
    /// About the centre of mass [rad/s]: one number in 2D, three in 3D.
    pub(super) angular: Vec<f64>,
    /// ∂v/∂x, row by row [1/s].
    pub(super) gradient: [[f64; D]; D],
    /// The name of vectors of the mesh file [m/s], if nodes have each their own.
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

impl<const D: usize> Velocities<D> {
    /// The path of the field that names vectors of nodes, in a body.
    pub(super) const OF_NODES: [&str; 2] = ["velocity", "of_nodes"];

    /// What every node has by itself, from the values that the mesh file has for its nodes; they turn as the body does.
    ///
    /// # Errors
    /// `scene.no_values`, `scene.length`, `scene.not_finite`, `scene.dimension`, `scene.range`.
    pub(super) fn of_nodes(
        &self,
        all: &BTreeMap<String, NodeValues>,
        kind: &str,
        rotation: &[f64],
    ) -> Result<Arc<[[f64; D]]>, SceneError> {
        let Some(name) = &self.of_nodes else { return Ok(Arc::from([])) };
        let shown = format!("`{}`", visible(name));
        let axes = if D == 2 { "2, or 3 of which the last is 0" } else { "3" };
        let fits = |field: &NodeValues| field.components == 3 || field.components == D;
        let Some(field) = all.get(name) else {
            let known: Vec<String> =
                all.iter().filter(|(_, f)| fits(f)).map(|(known, _)| format!("`{}`", visible(known))).collect();
            let known = if known.is_empty() { "there are none".into() } else { known.join(", ") };
            let (message, hint) = if kind == "mesh" {
                (format!("the nodes of the mesh have no vectors {shown}"), NAMED)
            } else {
                (
                    format!("{shown} would stand in a mesh file, and the shape is a `{kind}`"),
                    "`kind = \"mesh\"` reads one",
                )
            };
            let error = SceneError::new("scene.no_values", message).value(visible(name));
            return Err(error.allowed(known).hint(hint));
        };
        if !fits(field) {
            let count = field.components;
            let message = if count == 1 {
                format!("{shown} has {count} number a node")
            } else {
                format!("{shown} has {count} numbers a node")
            };
            let error = SceneError::new("scene.length", message).value(field.components.to_string());
            return Err(error.allowed(axes).hint("a velocity is a vector"));
        }
        let mut rows = Vec::with_capacity(field.values.len() / field.components);
        for (node, row) in field.values.chunks_exact(field.components).enumerate() {
            if let Some(x) = row.iter().find(|x| !x.is_finite()) {
                let message = format!("{shown} of node {node} is {x}");
                let error = SceneError::new("scene.not_finite", message).value(x.to_string());
                return Err(error.allowed("finite numbers for every node").hint("nodes are counted from 0"));
            }
            if let Some(z) = row.get(D).filter(|z| **z != 0.0) {
                let message = format!("{shown} of node {node} leaves the plane");
                let error = SceneError::new("scene.dimension", message).value(z.to_string()).allowed("0 along z");
                return Err(error.hint("nodes are counted from 0; `dimension = 3` at the head of a scene in space"));
            }
            rows.push(core::array::from_fn(|d| row[d]));
        }
        // They turn as positions do, about zero.
        let mut turned = Mesh::<D> { positions: rows, ..Mesh::default() };
        let refused = |error: opruga_mesh::MeshError| SceneError::new("scene.range", visible(&error.to_string()));
        shapes::place(&mut turned, &shapes::Transform { scale: 1.0, rotation }).map_err(refused)?;
        match turned.positions.iter().flatten().find(|x| !x.is_finite()) {
            Some(x) => {
                let error = SceneError::new("scene.range", format!("{shown}, turned with the body, is {x}"));
                Err(error.value(x.to_string()).allowed("finite numbers"))
            }
            None => Ok(Arc::from(turned.positions)),
        }
    }
}

/// What is said to those who name vectors that are not there.
const NAMED: &str = "vectors of nodes are `$NodeData` of Gmsh, `POINT_DATA` of VTK and `<PointData>` of VTU files";
