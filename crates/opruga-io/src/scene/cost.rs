//! The cost of the bodies of a scene, compared with the limits before any mesh is made.

use crate::limits::Limits;

opruga_math::messages! {
    /// Quantities that exceed their limits.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum CostError {
        "limit.bodies" #[error("the scene has {count} bodies or more")] #[value("{count}")] #[allowed("at most {most} bodies")]
        Bodies { count: String, most: u64 },
        "limit.nodes" #[error("the scene has {count} nodes or more")] #[value("{count}")] #[allowed("at most {most} nodes")]
        Nodes { count: String, most: u64 },
        "limit.memory" #[error("the scene would need at least about {count} bytes")] #[value("{count}")] #[allowed("at most {most} bytes")]
        Memory { count: String, most: u64 },
        "limit.nodes" #[error("the mesh would have {count} nodes or more")] #[value("{count}")] #[allowed("at most {most} nodes")]
        MeshNodes { count: String, most: u64 },
        "limit.memory" #[error("the mesh would need at least about {count} bytes")] #[value("{count}")] #[allowed("at most {most} bytes")]
        MeshMemory { count: String, most: u64 },
    }
}

impl CostError {
    /// The same error for a mesh that does not belong to a scene.
    pub(crate) fn of_mesh(self) -> CostError {
        match self {
            CostError::Nodes { count, most } => CostError::MeshNodes { count, most },
            CostError::Memory { count, most } => CostError::MeshMemory { count, most },
            error => error,
        }
    }
}

/// The quantities that are limited. Bodies that commands remove count, too, because the world remembers them.
#[derive(Clone, Copy, Default)]
pub(crate) struct Cost {
    bodies: f64,
    nodes: f64,
    bytes: f64,
}

impl Cost {
    /// Adds a body with this number of nodes and models, and its copies.
    ///
    /// # Errors
    /// `limit.bodies`, `limit.nodes` or `limit.memory`.
    pub(crate) fn add<const D: usize>(
        &mut self,
        copies: f64,
        nodes: f64,
        models: f64,
        limits: &Limits,
    ) -> Result<(), CostError> {
        self.bodies += copies;
        self.nodes += nodes * copies;
        // The mesh counts once, while state, models and description count for every copy.
        let each = nodes * (120.0 + 60.0 * D as f64 * models) + 1000.0 + 600.0 * models;
        self.bytes += nodes * 250.0 * D as f64 + each * copies;
        let Cost { bodies, nodes: all, bytes } = *self;
        // NaN exceeds every limit.
        let within = |count: f64, most: u64| count <= most as f64;
        if !within(bodies, limits.bodies) {
            return Err(CostError::Bodies { count: shown(bodies), most: limits.bodies });
        }
        if !within(all, limits.nodes) || !within(nodes, u64::from(u32::MAX)) {
            return Err(CostError::Nodes { count: shown(all), most: limits.nodes });
        }
        if !within(bytes, limits.memory_bytes) {
            return Err(CostError::Memory { count: shown(bytes), most: limits.memory_bytes });
        }
        Ok(())
    }
}

/// A count as a whole number, or as a power of ten if it exceeds 64 bits.
pub(crate) fn shown(count: f64) -> String {
    if count < u64::MAX as f64 { format!("{count:.0}") } else { format!("{count:.0e}") }
}
