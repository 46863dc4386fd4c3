//! What the bodies of a scene would cost, compared with the limits before any mesh is made.

use crate::limits::Limits;
use crate::problem::SceneError;

/// How much there is of what is limited. Bodies that commands take away count too: the world remembers them.
#[derive(Clone, Copy, Default)]
pub(crate) struct Cost {
    bodies: f64,
    nodes: f64,
    bytes: f64,
}

impl Cost {
    /// Adds a body of so many nodes and models, and its copies.
    ///
    /// # Errors
    /// `limit.bodies`, `limit.nodes` or `limit.memory`.
    pub(crate) fn add<const D: usize>(
        &mut self,
        copies: f64,
        nodes: f64,
        models: f64,
        limits: &Limits,
    ) -> Result<(), SceneError> {
        self.bodies += copies;
        self.nodes += nodes * copies;
        // A mesh once, and state, models and description for every copy.
        let each = nodes * (120.0 + 60.0 * D as f64 * models) + 1000.0 + 600.0 * models;
        self.bytes += nodes * 250.0 * D as f64 + each * copies;
        let Cost { bodies, nodes: all, bytes } = *self;
        let over = |code, message: String, value: f64, most: u64, what: &str| {
            Err(SceneError::new(code, message).value(shown(value)).allowed(format!("at most {most} {what}")))
        };
        // What is no number is above every limit.
        let within = |count: f64, most: u64| count <= most as f64;
        if !within(bodies, limits.bodies) {
            let message = format!("the scene has {} bodies or more", shown(bodies));
            return over("limit.bodies", message, bodies, limits.bodies, "bodies");
        }
        if !within(all, limits.nodes) || !within(nodes, u64::from(u32::MAX)) {
            return over(
                "limit.nodes",
                format!("the scene has {} nodes or more", shown(all)),
                all,
                limits.nodes,
                "nodes",
            );
        }
        if !within(bytes, limits.memory_bytes) {
            let message = format!("the scene would take about {} bytes or more", shown(bytes));
            return over("limit.memory", message, bytes, limits.memory_bytes, "bytes");
        }
        Ok(())
    }
}

/// A count as a whole number; beyond those of 64 bits by its power of ten.
pub(crate) fn shown(count: f64) -> String {
    if count < u64::MAX as f64 { format!("{count:.0}") } else { format!("{count:.0e}") }
}
