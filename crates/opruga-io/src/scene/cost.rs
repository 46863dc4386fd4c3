//! What the bodies of a scene would cost, compared with the limits before any mesh is made.

use super::Limits;
use crate::problem::SceneError;

/// How much there is of what is limited. Bodies that commands take away count too: the world remembers them.
#[derive(Clone, Copy, Default)]
pub(crate) struct Cost {
    bodies: u64,
    nodes: u64,
    bytes: u64,
}

impl Cost {
    /// Adds a body of so many nodes and models, and its copies.
    ///
    /// # Errors
    /// `limit.bodies`, `limit.nodes` or `limit.memory`.
    pub(crate) fn add<const D: usize>(
        &mut self,
        copies: u64,
        nodes: u64,
        models: u64,
        limits: &Limits,
    ) -> Result<(), SceneError> {
        self.bodies = self.bodies.saturating_add(copies);
        self.nodes = self.nodes.saturating_add(nodes.saturating_mul(copies));
        // A mesh once, and state, models and description for every copy.
        let each = nodes.saturating_mul(120 + 60 * D as u64 * models).saturating_add(1000 + 600 * models);
        let mesh = nodes.saturating_mul(250 * D as u64);
        self.bytes = self.bytes.saturating_add(mesh).saturating_add(each.saturating_mul(copies));
        let Cost { bodies, nodes: all, bytes } = *self;
        let over = |code, message: String, value: u64, most: u64, what: &str| {
            Err(SceneError::new(code, message).value(value.to_string()).allowed(format!("at most {most} {what}")))
        };
        if bodies > limits.bodies {
            let message = format!("the scene has {bodies} bodies or more");
            return over("limit.bodies", message, bodies, limits.bodies, "bodies");
        }
        if all > limits.nodes || nodes > u64::from(u32::MAX) {
            return over("limit.nodes", format!("the scene has {all} nodes or more"), all, limits.nodes, "nodes");
        }
        if bytes > limits.memory_bytes {
            let message = format!("the scene would take about {bytes} bytes or more");
            return over("limit.memory", message, bytes, limits.memory_bytes, "bytes");
        }
        Ok(())
    }
}
