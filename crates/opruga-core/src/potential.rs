//! The interface of models to integrators: forces, energy and second derivatives, independent of how an integrator steps.

pub use crate::dense_part::{DensePart, Following, RankOnePart, mixed};
use crate::error::{BuildError, StepError};
use crate::memory::{Counts, Need};
use crate::spec::{Spec, Values};
use crate::state::{Layout, View};
use crate::tile::Tile;
use core::fmt::Debug;
use core::ops::Range;
use opruga_math::message::AnyMessage;
use opruga_math::{Simd, WIDTH};
use opruga_mesh::Mesh;
use std::borrow::Cow;

/// The quantities that a model provides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Views {
    /// There is an energy whose negative gradient is the force at rest.
    pub energy: bool,
    /// There are second derivatives −∂F/∂x, or forces do not depend on positions.
    pub hessian: bool,
    /// The second derivatives form a symmetric matrix, like those of an energy.
    pub symmetric: bool,
    /// The force depends on velocities.
    pub damping: bool,
}

impl Views {
    /// Whether everything that is needed is provided.
    pub fn include(self, needed: Views) -> bool {
        (self.energy || !needed.energy)
            && (self.hessian || !needed.hessian)
            && (self.symmetric || !needed.symmetric)
            && (self.damping || !needed.damping)
    }
}

/// The account of the ledger in which the energy and the power of a model are recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Account {
    /// Elastic energy; power is dissipated by damping.
    Elastic,
    /// Energy of the gas.
    Gas,
    /// Work of external forces.
    User,
}

/// Whether a Hessian is delivered as it is, or without the negative eigenvalues of the block of each stencil.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Definiteness {
    /// The second derivatives.
    Exact,
    /// Each block made positive semi-definite.
    Clamped,
}

/// The name and the value of a reading of a body: `volume`, `chamber2.pressure`.
pub type Reading = (Cow<'static, str>, f64);

/// How often an event happened in a model, per substep and body.
#[derive(Clone, Debug, PartialEq)]
pub struct Count {
    /// The kind of event, as a message.
    pub what: AnyMessage,
    /// How often the event happened.
    pub count: u64,
}

/// Symmetric matrices of up to eight stencils with the same number of nodes, side by side in the lanes.
#[derive(Clone, Copy, Debug)]
pub struct StencilPack<'a> {
    /// The number of nodes of a stencil.
    pub nodes: usize,
    /// The number of stencils; later lanes are meaningless.
    pub count: usize,
    /// Indices of the nodes, `[node][lane]`.
    pub indices: &'a [u32],
    /// Blocks K_ab row by row, `[a][b][row][column][lane]`; blocks with a > b are not read.
    pub blocks: &'a [f64],
}

impl StencilPack<'_> {
    /// The index of a node of a stencil.
    #[inline(always)]
    pub fn index(&self, node: usize, lane: usize) -> usize {
        self.indices[node * WIDTH + lane] as usize
    }
    /// The block K_ab of a stencil.
    #[inline(always)]
    pub fn block<const D: usize>(&self, a: usize, b: usize, lane: usize) -> [[f64; D]; D] {
        let (low, high) = if a <= b { (a, b) } else { (b, a) };
        let stored = &self.blocks[(low * self.nodes + high) * D * D * WIDTH..][..D * D * WIDTH];
        let mut out = [[0.0; D]; D];
        for i in 0..D {
            for j in 0..D {
                let (row, column) = if a <= b { (i, j) } else { (j, i) };
                out[i][j] = stored[(row * D + column) * WIDTH + lane];
            }
        }
        out
    }
}

/// Matrices of many stencils that are computed on demand, so that a [`Sink`] can distribute the work over threads.
pub trait StencilPacks<const D: usize>: Sync {
    /// The number of nodes of a stencil.
    fn nodes(&self) -> usize;
    /// The number of stencils; all packs but the last are full.
    fn stencils(&self) -> usize;
    /// Whether these are the indices of all packs, one pack after the other, as in [`StencilPack::indices`].
    fn are_at(&self, indices: &[u32]) -> bool;
    /// Delivers the packs with an index in `rows`, in order, each with its number among all packs.
    fn deliver(&self, rows: &Range<usize>, to: &mut dyn FnMut(usize, &StencilPack<'_>));
}

/// The receiver of a Hessian.
pub trait Sink<const D: usize> {
    /// Adds the block ∂²U/∂xₐ∂x_b for two indices of the same body.
    fn block(&mut self, a: usize, b: usize, value: [[f64; D]; D]);
    /// Adds c·u uᵀ, where u is given by its entries at some indices. The product is never expanded to a dense matrix.
    fn low_rank(&mut self, c: f64, u: &[(usize, [f64; D])]);
    /// Adds a dense matrix that rotates with its body. A sink with a sparse matrix stores this part separately, as it is; a sink
    /// that processes only entries receives the part block by block.
    fn dense(&mut self, part: &DensePart<'_, D>) {
        for (a, row) in part.indices.iter().enumerate() {
            for (b, column) in part.indices.iter().enumerate() {
                self.block(*row as usize, *column as usize, part.block(a, b));
            }
        }
        for (c, u) in part.parts_of_rank_one() {
            self.low_rank(c, &u);
        }
    }
    /// Adds the matrices of some stencils: stencil by stencil, all blocks row by row.
    fn stencils(&mut self, pack: &StencilPack<'_>) {
        for lane in 0..pack.count {
            for a in 0..pack.nodes {
                for b in 0..pack.nodes {
                    self.block(pack.index(a, lane), pack.index(b, lane), pack.block(a, b, lane));
                }
            }
        }
    }
    /// Adds the matrices of many stencils, which may be computed on several threads; the number of threads does not change the
    /// bits.
    fn stencil_packs(&mut self, _threads: usize, packs: &dyn StencilPacks<D>) {
        packs.deliver(&(0..usize::MAX), &mut |_, pack| self.stencils(pack));
    }
}

/// The constant properties of a [`Potential`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Properties {
    /// The name of the model.
    pub name: &'static str,
    /// The quantities that it provides.
    pub views: Views,
    /// The account in which energy and power are recorded.
    pub account: Account,
    /// The smallest rate λ [1/s] at which it damps every node of its bodies in every motion, f = −λ m v.
    pub uniform_damping: f64,
    /// The length of the scratch that `prepare` fills.
    pub scratch_len: usize,
    /// Whether `prepare` and the derivatives use [`View::threads`], for bodies that are large enough.
    pub shares_threads: bool,
    /// Whether `add_force` itself begins the forces of a tile with the weight if `tile.weight` is present. This saves a pass.
    pub begins_tiles: bool,
    /// Whether `prepare` reads everything on which forces depend, so that nodes of one stencil may move one after the other.
    pub forces_in_prepare: bool,
    /// Whether forces act only between nodes: their sum and their moment about any point are zero, and they rotate with the
    /// body. The conformance suite checks the sums. `None` if a model does not declare it; integrators then measure it in every
    /// step.
    pub acts_between_nodes: Option<bool>,
    /// Whether the world uses the energy of this model to check whether a body rests in an equilibrium other than its own
    /// shape.
    pub judges_balance: bool,
}

impl Properties {
    /// The properties of an elastic model without special features.
    pub const fn new(name: &'static str, views: Views) -> Properties {
        Properties {
            name,
            views,
            account: Account::Elastic,
            uniform_damping: 0.0,
            scratch_len: 0,
            shares_threads: false,
            begins_tiles: false,
            forces_in_prepare: false,
            acts_between_nodes: None,
            judges_balance: false,
        }
    }
}

/// A model of one body, or of eight identical bodies side by side: the energy U(x) and its derivatives.
///
/// This is the only dynamic dispatch: one call per model and tile. `memory` is the data that the model remembers from step to
/// step (an amount of gas, a ramp); it is part of the state. `scratch` holds the results of [`Potential::prepare`] for the calls
/// that follow it.
pub trait Potential<const D: usize>: Observe<D> + Send + Sync + Debug {
    /// The constant properties of the model.
    fn properties(&self) -> Properties;
    /// Visits the nodes of every term of the energy that couples nodes, in any order. Colours, tiles and drawings of the coupling are made from these
    /// nodes. Terms of one node, or of the whole body (the volume of a gas, for which the facets are given), are not included.
    fn stencils(&self, _visit: &mut dyn FnMut(&[u32])) {}
    /// The difference between its consistent mass matrix and the lumped masses, for pairs of nodes (row, column, mass [kg]);
    /// empty if masses are lumped.
    fn inertia(&self) -> &[(u32, u32, f64)] {
        &[]
    }
    /// The initial memory.
    fn initial_memory(&self) -> Vec<f64> {
        Vec::new()
    }
    /// Computes quantities of the body as a whole (volume, pressure, a factor over time).
    ///
    /// # Errors
    /// [`StepError::Model`] if the model has no value in this state.
    fn prepare(&self, _simd: Simd, _view: &View<D>, _memory: &[f64], _scratch: &mut [f64]) -> Result<(), StepError> {
        Ok(())
    }
    /// Adds the whole force of the model, −∂U/∂x and damping [N], to every node of the tile.
    fn add_force(&self, simd: Simd, view: &View<D>, scratch: &[f64], tile: &mut Tile<D>);
    /// Updates the memory after a substep; returns the energy that this update gives to each body [J]. The scratch comes from the latest call of
    /// `prepare`, and the method may overwrite it.
    fn remember(
        &self,
        _simd: Simd,
        _view: &View<D>,
        _h: f64,
        _scratch: &mut [f64],
        _memory: &mut [f64],
    ) -> [f64; WIDTH] {
        [0.0; WIDTH]
    }
    /// The energy U of each body [J], after `prepare` in the same state. For one body, the result consists of eight partial sums; for eight bodies,
    /// it has one number for each.
    fn energy(&self, _simd: Simd, _view: &View<D>, _scratch: &[f64]) -> [f64; WIDTH] {
        [0.0; WIDTH]
    }
    /// The size of the terms whose difference is U at rest, for all bodies together [J]. The rounding errors of these terms
    /// must not be taken for energy. Zero if U is a sum of squares.
    fn energy_parts(&self) -> f64 {
        0.0
    }
    /// Delivers ∂²U/∂x∂x, after `prepare` in the same state.
    fn hessian(&self, _view: &View<D>, _scratch: &[f64], _keep: Definiteness, _sink: &mut dyn Sink<D>) {}
    /// Delivers −∂F/∂v, the damping matrix, after `prepare` in the same state.
    fn damping_matrix(&self, _view: &View<D>, _scratch: &[f64], _sink: &mut dyn Sink<D>) {}
    /// Adds ∂²U/∂x∂x · direction; indices outside of the bodies do not change.
    fn add_hessian_product(&self, view: &View<D>, scratch: &[f64], direction: &[&[f64]; D], out: &mut [&mut [f64]; D]) {
        let mut product = ProductSink { direction, out };
        self.hessian(view, scratch, Definiteness::Exact, &mut product);
    }
}

/// Data of a model for people and programs; integrators do not use it.
pub trait Observe<const D: usize> {
    /// The reason why it has no energy or no symmetric second derivatives, for messages of refusal; `None` if it has both.
    fn lacks(&self) -> Option<AnyMessage> {
        None
    }
    /// Pairs of nodes that a spring ties to each other, for pictures.
    fn bonds(&self) -> &[[u32; 2]] {
        &[]
    }
    /// Names and values of the readings of a body (`volume`, `pressure`).
    fn readings(&self, _view: &View<D>, _scratch: &[f64], _memory: &[f64], _body: usize) -> Vec<Reading> {
        Vec::new()
    }
    /// The pressure of the gas [Pa] at each node that bounds it, in any order; empty if the model contains no gas.
    fn node_pressures(&self, _view: &View<D>, _scratch: &[f64], _body: usize) -> Vec<(u32, f64)> {
        Vec::new()
    }
    /// Stress and volume ratio of the cells of a body, in any order; empty if the model has none.
    fn cell_states(&self, _view: &View<D>, _body: usize) -> Vec<CellState> {
        Vec::new()
    }
    /// Stress and volume ratio of the facets of a body, in any order, for a model that consists only of its boundary; `cell` is
    /// the facet.
    fn facet_states(&self, _view: &View<D>, _body: usize) -> Vec<CellState> {
        Vec::new()
    }
    /// Counts of events that a user should know of, such as a limit that took effect. The memory holds these counts.
    fn counts(&self, _memory: &[f64]) -> Vec<Count> {
        Vec::new()
    }
    /// Warnings about the shapes of the bodies in a state. Every call counts them anew, because the memory does not keep them.
    fn shape_counts(&self, _view: &View<D>) -> Vec<Count> {
        Vec::new()
    }
    /// Whether its data have the same bits on every processor; they do not if a library factored a matrix.
    fn same_bits_everywhere(&self) -> bool {
        true
    }
    /// Bytes on the heap.
    fn heap_bytes(&self) -> usize {
        0
    }
}

/// The state of a cell of a body, or of a facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellState {
    /// The cell, in the order of [`opruga_mesh::Cells::iter`].
    pub cell: u32,
    /// The mean Cauchy stress σ of the cell [Pa], row by row. In 2D, it includes the stress perpendicular to the plane.
    pub stress: [[f64; 3]; 3],
    /// The volume ratio J of the cell: its volume divided by its volume at rest.
    pub volume_ratio: f64,
    /// The smallest J at the integration points of the cell: the minimum over the gradients of its shape and the gradients with which its law is
    /// evaluated. A cell of positive volume may be degenerate or inverted at some integration points.
    pub smallest_volume_ratio: f64,
    /// The volume of the cell at rest [m³]; in the plane, its area times the thickness.
    pub measure: f64,
}

impl CellState {
    /// The von Mises stress √(3/2 s:s) with s = σ − ⅓ tr σ 1 [Pa].
    pub fn von_mises(&self) -> f64 {
        let s = &self.stress;
        let square = |x: f64| x * x;
        let normal = square(s[0][0] - s[1][1]) + square(s[1][1] - s[2][2]) + square(s[2][2] - s[0][0]);
        let shear = square(s[0][1]) + square(s[1][2]) + square(s[2][0]);
        (0.5 * normal + 3.0 * shear).sqrt()
    }
    /// Whether its smallest volume ratio is below a thousandth, or NaN. The cell then has no volume, or a negative one,
    /// somewhere.
    pub fn is_degenerate(&self) -> bool {
        /// Cells below this fraction of their volume count as having none.
        const NO_VOLUME: f64 = 1e-3;
        !matches!(self.smallest_volume_ratio.partial_cmp(&NO_VOLUME), Some(core::cmp::Ordering::Greater))
    }
    /// The pressure −⅓ tr σ [Pa].
    pub fn pressure(&self) -> f64 {
        -(self.stress[0][0] + self.stress[1][1] + self.stress[2][2]) / 3.0
    }
}

/// Multiplies the delivered blocks of a Hessian with a vector.
struct ProductSink<'a, 'b, const D: usize> {
    direction: &'a [&'a [f64]; D],
    out: &'a mut [&'b mut [f64]; D],
}

impl<const D: usize> Sink<D> for ProductSink<'_, '_, D> {
    fn block(&mut self, a: usize, b: usize, value: [[f64; D]; D]) {
        for i in 0..D {
            for j in 0..D {
                self.out[i][a] += value[i][j] * self.direction[j][b];
            }
        }
    }
    fn low_rank(&mut self, c: f64, u: &[(usize, [f64; D])]) {
        let mut dot = 0.0;
        for (index, entry) in u {
            for d in 0..D {
                dot += entry[d] * self.direction[d][*index];
            }
        }
        for (index, entry) in u {
            for d in 0..D {
                self.out[d][*index] += c * dot * entry[d];
            }
        }
    }
    fn dense(&mut self, part: &DensePart<'_, D>) {
        let direction = self.direction;
        let product = part.product(|index| core::array::from_fn(|d| direction[d][index]));
        for (index, value) in part.indices.iter().zip(product) {
            for d in 0..D {
                self.out[d][*index as usize] += value[d];
            }
        }
    }
}

/// The data from which a model is built: a body at rest, or eight identical ones with their own parameters.
#[derive(Clone, Debug)]
pub struct Ingredients<'a, const D: usize> {
    /// The rest shape, the same for all.
    pub mesh: &'a Mesh<D>,
    /// Whether there is one body, or eight side by side.
    pub layout: Layout,
    /// The parameters of each body: one entry, or eight.
    pub values: &'a [&'a Values],
    /// Mass of every node [kg], with the layout of the columns.
    pub mass: &'a crate::state::Parameter,
    /// Density of every cell [kg/m³], if they differ.
    pub densities: Option<&'a [f64]>,
    /// Thickness out of the plane in 2D, of a sheet in 3D [m].
    pub thickness: f64,
    /// Acceleration of gravity [m/s²].
    pub gravity: [f64; D],
    /// The length of a substep that the scene declares [s], only for published schemes whose stiffness depends on it.
    pub step: f64,
    /// Stops a preparation that takes seconds, and receives its progress.
    pub break_off: &'a crate::break_off::BreakOff,
}

impl<const D: usize> Ingredients<'_, D> {
    /// A number for every body, eight times if there is only one.
    pub fn by_body(&self, mut number: impl FnMut(&Values) -> f64) -> [f64; WIDTH] {
        core::array::from_fn(|l| number(self.values[l.min(self.values.len() - 1)]))
    }
}

/// A kind of model that scenes can name.
pub trait Model<const D: usize>: Send + Sync {
    /// The parameters and the documentation of the kind.
    fn spec(&self) -> &'static Spec;
    /// Whether its potentials have an energy and second derivatives, on every body and with the default parameters. The
    /// documentation of parameters describes exceptions.
    fn views(&self) -> Views {
        Views { energy: true, hessian: true, symmetric: true, damping: false }
    }
    /// Whether its potentials also handle [`crate::state::Layout::Batch`], in which up to eight bodies with their own parameters share the columns.
    /// Bodies with other models are stepped one by one.
    fn batches(&self) -> bool {
        false
    }
    /// The memory and the couplings that it needs for one body, in addition to the mesh and the state.
    fn need(&self, _counts: &Counts) -> Need {
        Need::default()
    }
    /// Builds a potential for one body, or for eight identical ones.
    ///
    /// # Errors
    /// [`BuildError`] if the body cannot carry the model or a combination of parameters has no meaning.
    fn build(&self, ingredients: &Ingredients<D>) -> Result<Box<dyn Potential<D>>, BuildError>;
}
