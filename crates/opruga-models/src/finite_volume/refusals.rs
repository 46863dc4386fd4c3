//! Why a body cannot be a solid of finite volumes.

use super::SPEC;
use opruga_core::error::BuildError;
use opruga_math::messages;
use opruga_math::words::number;

messages! {
    /// Why `finite_volume` refuses a body, its parameters or an integrator.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Refusal {
        /// A body without cells.
        "model.no_cells"
        #[error("the body has no cells: it is an outline, a surface or a chain")]
        #[allowed("triangles, quadrilaterals, tetrahedra or hexahedra, as in `grid`, shapes from files with a `filling`, and volume meshes")]
        NoCells {},
        /// Cells with nodes at the midpoints of edges.
        "model.quadratic_cells"
        #[error("the body has {count} quadratic cells, for which this model has no dual faces")]
        #[allowed("linear cells")]
        #[hint("use `order = 1` for the body")]
        Quadratic { count: usize },
        /// A cell that has no volume or is inverted.
        "model.inverted_cell"
        #[error("cell {cell} has no volume or is inverted at rest: det ∂X/∂ξ = {} for a cell {} m long", number(*determinant), number(*size))]
        #[allowed("more than 1e-12 times its length squared (in space, cubed)")]
        InvertedCell { cell: usize, determinant: f64, size: f64 },
        /// Linear cells near incompressibility.
        "model.locking"
        #[error("`poissons_ratio` is {} for triangles or tetrahedra, which lock near incompressibility", number(*ratio))] #[value("{}", number(*ratio))] #[parameters("poissons_ratio")]
        #[allowed("at most {}", number(*most))]
        #[hint("`locking = \"accept\"` accepts cells that lock; `fem` also has `order = 2` and `locking = \"nodal_volume\"`")]
        Locks { ratio: f64, most: f64 },
        /// An unknown material.
        "scene.unknown_name"
        #[error("there is no material `{name}`")]
        NoMaterial { name: String },
        /// The reason why quadrilaterals and hexahedra have no potential, as a part of a refusal.
        "part.no_potential"
        #[error("forces of quadrilaterals and hexahedra, with F at the middle of each dual face, are not the gradient of an energy; triangles and tetrahedra have one (`simplices = true`, `order = 1`)")]
        NoPotentialOfFaces {},
        /// No thickness for which the out-of-plane stress is zero.
        "run.no_thickness"
        #[error("no positive thickness of cell {cell} gives zero stress across the plane at t = {} s: the cell is stretched or inverted beyond what its material can follow in plane stress", number(*time))]
        NoThickness { cell: usize, time: f64 },
    }
}

impl From<Refusal> for BuildError {
    fn from(refusal: Refusal) -> BuildError {
        BuildError::of(SPEC.kind, refusal)
    }
}
