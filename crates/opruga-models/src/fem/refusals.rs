//! Why a body cannot be a solid of finite elements.

use super::SPEC;
use opruga_core::error::BuildError;
use opruga_core::spec::AllowedValues;
use opruga_math::words::number;
use opruga_math::{messages, terms};
use opruga_mesh::MeshError;

terms! {
    /// Linear cells that lock.
    pub enum Simplices = "part.simplices" { Triangles = "triangles", Tetrahedra = "tetrahedra" }
}

messages! {
    /// Why `fem` refuses a body, its parameters or a state.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Refusal {
        /// A body without cells.
        "model.no_cells" #[error("the body has no cells: it is an outline, a surface or a chain")]
        #[allowed("filled shapes: `grid`, shapes from files with a `filling`, and volume meshes")]
        NoCellsAtAll {},
        /// An empty group.
        "model.no_cells" #[error("the group of cells `{name}` is empty")]
        EmptyGroup { name: String },
        /// A group that the mesh lacks.
        "model.no_group" #[error("the mesh has no group of cells `{name}`")] #[allowed("{known}")]
        NoGroupOfCells { name: String, known: String },
        /// A mesh without groups.
        "model.no_group" #[error("the mesh has no group of cells `{name}`")] #[allowed("it has none")]
        NoGroupsOfCells { name: String },
        /// Thermal growth to zero or below.
        "model.temperature"
        #[error("cell {cell} would become {growth} times as long with `thermal_expansion` = {expansion} 1/K from {reference} K to {now} K")] #[parameters("thermal_expansion")]
        #[allowed("more than 0")] #[hint("steel has 1.2e-5 1/K, rubber 2e-4 1/K")]
        NoGrowth { cell: u32, growth: f64, expansion: f64, reference: f64, now: f64 },
        /// Linear cells near incompressibility.
        "model.locking" #[error("`poissons_ratio` is {ratio} for linear {cells}, which lock near incompressibility")] #[value("{ratio}")] #[parameters("poissons_ratio")] #[allowed("at most {most}")]
        #[hint("use `order = 2` for the body, or `locking = \"nodal_volume\"`")]
        LinearCellsLock { ratio: f64, cells: Simplices, most: f64 },
        /// Nodal volumes together with thermal expansion.
        "model.locking" #[error("`locking` is \"nodal_volume\", which does not support the thermal expansion of the body")] #[value("\"nodal_volume\"")] #[parameters("locking")]
        #[allowed("\"refuse\" or \"accept\"")] #[hint("bodies with `order = 2`, quadrilaterals and hexahedra do not lock either")]
        NodalVolumeAndHeat {},
        /// Nodal volumes in plane stress.
        "model.locking" #[error("`locking` is \"nodal_volume\" in plane stress, where the thickness is free and nothing locks")] #[value("\"nodal_volume\"")] #[parameters("locking")]
        #[allowed("\"refuse\" or \"accept\"")] #[hint("leave `locking` out")]
        NodalVolumeInPlaneStress {},
        /// Nodal volumes for cells that do not lock.
        "model.locking" #[error("`locking` is \"nodal_volume\", but the cells are not linear triangles or tetrahedra and do not lock")] #[value("\"nodal_volume\"")] #[parameters("locking")]
        #[allowed("\"refuse\" or \"accept\"")] #[hint("leave `locking` out")]
        NodalVolumeOfOthers {},
        /// Values of cells that the mesh does not have.
        "model.no_values" #[error("`{field}` is \"{name}\", but the cells of the mesh have no such numbers")] #[value("\"{name}\"")] #[parameters(field)] #[allowed("{known}")]
        #[hint("`{instead}` gives one number for all cells")]
        NoValues { field: &'static str, name: String, known: String, instead: &'static str },
        /// A mesh without values of cells.
        "model.no_values" #[error("`{field}` is \"{name}\", but the cells of the mesh have no such numbers")] #[value("\"{name}\"")] #[parameters(field)]
        #[allowed("none: the mesh has no numbers for its cells")] #[hint("`{instead}` gives one number for all cells")]
        NoValuesAtAll { field: &'static str, name: String, instead: &'static str },
        /// A value of a cell that is out of range.
        "model.cell_value" #[error("`{field}` of cell {cell} is {value}")] #[value("{value}")] #[parameters(field)] #[allowed("{allowed}")]
        #[hint("the numbers are in the mesh file; `{instead}` gives one number for all cells")]
        CellValue { field: &'static str, cell: usize, value: String, allowed: AllowedValues, instead: &'static str },
        /// A cell that is inverted at rest.
        "model.inverted_cell" #[error("cell {cell} with the nodes {nodes} is inverted at rest: det ∂X/∂ξ = {determinant}")]
        #[allowed("more than {least}")]
        Inverted { cell: u32, nodes: String, determinant: String, least: String },
        /// A cell without volume at rest.
        "model.inverted_cell" #[error("cell {cell} with the nodes {nodes} has no volume at rest: det ∂X/∂ξ = {determinant}")]
        #[allowed("more than {least}")]
        FlatCell { cell: u32, nodes: String, determinant: String, least: String },
        /// A body without volume or area.
        "model.mass" #[error("{problem}")]
        Measure { problem: MeshError },
        /// No thickness for which the out-of-plane stress is zero.
        "run.no_thickness"
        #[error("no positive thickness of cell {cell} gives zero stress across the plane at t = {} s: the cell is stretched or inverted beyond what its material can follow in plane stress", number(*time))]
        NoThicknessLeft { cell: u32, time: f64 },
    }
}

impl From<Refusal> for BuildError {
    fn from(refusal: Refusal) -> BuildError {
        BuildError::of(SPEC.kind, refusal)
    }
}
