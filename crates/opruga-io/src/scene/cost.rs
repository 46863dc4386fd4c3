//! What the bodies of a scene would cost, compared with the limits before any mesh is made.

use crate::limits::Limits;

opruga_math::messages! {
    /// What a scene has too much of.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum CostError {
        "limit.bodies" #[error("the scene has {count} bodies or more")] #[value("{count}")] #[allowed("at most {most} bodies")]
        Bodies { count: String, most: u64 },
        "limit.nodes" #[error("the scene has {count} nodes or more")] #[value("{count}")] #[allowed("at most {most} nodes")]
        Nodes { count: String, most: u64 },
        "limit.memory" #[error("the scene would take about {count} bytes or more")] #[value("{count}")] #[allowed("at most {most} bytes")]
        Memory { count: String, most: u64 },
        "limit.nodes" #[error("the mesh would have {count} nodes or more")] #[value("{count}")] #[allowed("at most {most} nodes")]
        MeshNodes { count: String, most: u64 },
        "limit.memory" #[error("the mesh would take about {count} bytes or more")] #[value("{count}")] #[allowed("at most {most} bytes")]
        MeshMemory { count: String, most: u64 },
    }
}

impl CostError {
    /// The same of a mesh outside of any scene.
    pub(crate) fn of_mesh(self) -> CostError {
        match self {
            CostError::Nodes { count, most } => CostError::MeshNodes { count, most },
            CostError::Memory { count, most } => CostError::MeshMemory { count, most },
            error => error,
        }
    }
}

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
    ) -> Result<(), CostError> {
        self.bodies += copies;
        self.nodes += nodes * copies;
        // A mesh once, and state, models and description for every copy.
        let each = nodes * (120.0 + 60.0 * D as f64 * models) + 1000.0 + 600.0 * models;
        self.bytes += nodes * 250.0 * D as f64 + each * copies;
        let Cost { bodies, nodes: all, bytes } = *self;
        // What is no number is above every limit.
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

/// A count as a whole number; beyond those of 64 bits by its power of ten.
pub(crate) fn shown(count: f64) -> String {
    if count < u64::MAX as f64 { format!("{count:.0}") } else { format!("{count:.0e}") }
}
