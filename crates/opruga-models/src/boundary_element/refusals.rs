//! Why the boundary element method cannot be applied to a body.

use super::SPEC;
use opruga_core::error::BuildError;
use opruga_math::words::number;
use opruga_math::{messages, terms};
use opruga_mesh::MeshError;

terms! {
    /// Why the equations of a boundary have no solution.
    pub enum NoSolution = "part.no_solution" {
        Singular = "the matrix of the tractions is singular",
        NotFinite = "the stiffness is not finite",
        NegativeOfMany = "the stiffness has negative eigenvalues, and the program can remove them only from boundaries of at most 1000 vertices",
        ManyNegative = "the negative eigenvalues make up more than a twentieth of the stiffness",
    }
}

messages! {
    /// Why `boundary_element` refuses a body or its parameters.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Refusal {
        /// A body without facets.
        "model.no_surface"
        #[error("the body has no closed boundary: it is a line, a sheet, a chain or a node")]
        #[allowed("closed outlines in the plane, closed surfaces in space")]
        NoSurface {},
        /// An open boundary.
        "model.open_surface"
        #[error("{problem}")]
        #[allowed("a closed boundary")]
        #[hint("`cap = true` closes a surface from a file")]
        Open { problem: MeshError },
        /// A boundary that is not a manifold.
        "model.not_manifold"
        #[error("{problem}")]
        #[allowed("a boundary that has an inside and an outside everywhere")]
        NotManifold { problem: MeshError },
        /// Facets with opposite orientations.
        "model.orientation"
        #[error("{problem}")]
        #[allowed("facets that all have the same orientation")]
        Orientation { problem: MeshError },
        /// Facets that intersect.
        "model.crossing_surface"
        #[error("{count} pairs of facets cross or touch; the first are facets {first} and {second}")]
        #[allowed("a boundary that does not meet itself")]
        Crossing { count: usize, first: u32, second: u32 },
        /// A facet without a normal.
        "model.degenerate_facet"
        #[error("facet {facet} is degenerate: its measure is {} and one of its edges is {} m long", number(*measure), number(*edge))]
        #[allowed("a measure above 1e-10 times the length of the edge (in space, times its square)")]
        Degenerate { facet: usize, measure: f64, edge: f64 },
        /// Nodes that are not on the surface.
        "model.inner_nodes"
        #[error("{count} of {nodes} nodes are not on the boundary; the first is node {first}")]
        #[allowed("only nodes of the boundary, because the method has no others")]
        #[hint("use the surface without its filling, such as `polygon` or `svg` in the plane and `box`, `icosphere` or `surface` in space")]
        InnerNodes { count: usize, nodes: usize, first: usize },
        /// Several solids.
        "model.several_solids"
        #[error("the boundary encloses {solids} solids that do not touch")]
        #[allowed("one, with cavities")]
        #[hint("make a body for each solid")]
        SeveralSolids { solids: usize },
        /// A boundary inside another one, while the solid is the exterior.
        "model.nested_exterior"
        #[error("`exterior` is true, but facet {facet} belongs to a boundary inside another one")] #[parameters("exterior")]
        #[allowed("cavities that do not contain one another")]
        NestedExterior { facet: u32 },
        /// More vertices than dense matrices allow.
        "limit.memory"
        #[error("the boundary has {nodes} vertices, whose dense matrices need about {} bytes during their assembly", number(*bytes))]
        #[allowed("at most {most} vertices")]
        #[hint("use a coarser surface (`spacing`), or fill it and use `fem`")]
        TooMany { nodes: usize, bytes: f64, most: usize },
        /// The web page cannot solve dense systems.
        "model.not_on_the_page"
        #[error("the web page does not compute boundary elements")]
        #[hint("use the studio or the command line")]
        Page {},
        /// The preparation was stopped on request.
        "run.broken_off"
        #[error("the preparation was interrupted")]
        Ended {},
        /// A singular system.
        "model.singular"
        #[error("the equations of the boundary have no solution: {reason}")]
        #[hint("use facets of more uniform size")]
        Singular { reason: NoSolution },
    }
}

messages! {
    /// Facets whose orientation was changed.
    #[derive(Clone, Debug, PartialEq)]
    pub enum TurnedFacets {
        /// Facets of cavities.
        "mesh.turned"
        #[error("facets were flipped so that the solid is behind each of them; a boundary inside another one bounds a cavity")]
        Turned {},
    }
}

impl From<Refusal> for BuildError {
    fn from(refusal: Refusal) -> BuildError {
        BuildError::of(SPEC.kind, refusal)
    }
}

impl From<MeshError> for Refusal {
    fn from(error: MeshError) -> Refusal {
        let problem = error;
        match problem {
            MeshError::Open { .. } => Refusal::Open { problem },
            MeshError::InconsistentOrientation { .. } | MeshError::InsideOut { .. } => Refusal::Orientation { problem },
            problem => Refusal::NotManifold { problem },
        }
    }
}
