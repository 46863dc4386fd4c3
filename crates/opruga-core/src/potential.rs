//! What a model is to an integrator: forces, energy and second derivatives, and nothing about how it steps.

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

/// Which questions a model answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Views {
    /// There is an energy whose negative gradient is the force at rest.
    pub energy: bool,
    /// There are second derivatives −∂F/∂x, or forces do not depend on positions.
    pub hessian: bool,
    /// The second derivatives are a symmetric matrix, as those of an energy are.
    pub symmetric: bool,
    /// The force depends on velocities.
    pub damping: bool,
}

impl Views {
    /// Whether everything that is needed is there.
    pub fn include(self, needed: Views) -> bool {
        (self.energy || !needed.energy)
            && (self.hessian || !needed.hessian)
            && (self.symmetric || !needed.symmetric)
            && (self.damping || !needed.damping)
    }
}

/// Where the energy and the power of a model are entered in the ledger.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Account {
    /// Elastic energy; power is dissipated by damping.
    Elastic,
    /// Energy of the gas.
    Gas,
    /// Work of forces from outside.
    User,
}

/// Whether a Hessian is taken as it is, or each stencil's block without its negative eigenvalues.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Definiteness {
    /// The second derivatives.
    Exact,
    /// Each block made positive semi-definite.
    Clamped,
}

/// The name and the value of something that a reader may want to see of a body: `volume`, `chamber2.pressure`.
pub type Reading = (Cow<'static, str>, f64);

/// How often something happened in a model, per substep and body.
#[derive(Clone, Debug, PartialEq)]
pub struct Count {
    /// What happened.
    pub what: AnyMessage,
    /// How often.
    pub count: u64,
}

/// Symmetric matrices of up to eight stencils of the same number of nodes, side by side in the lanes.
#[derive(Clone, Copy, Debug)]
pub struct StencilPack<'a> {
    /// Nodes of a stencil.
    pub nodes: usize,
    /// How many stencils there are; lanes from there on mean nothing.
    pub count: usize,
    /// Indices of the nodes, `[node][lane]`.
    pub indices: &'a [u32],
    /// Blocks K_ab row by row, `[a][b][row][column][lane]`; those with a > b are not looked at.
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

/// Matrices of many stencils that are worked out on demand: what lets a [`Sink`] spread the work over threads.
pub trait StencilPacks<const D: usize>: Sync {
    /// Nodes of a stencil.
    fn nodes(&self) -> usize;
    /// How many stencils there are; all packs but the last are full.
    fn stencils(&self) -> usize;
    /// Whether these are the indices of all packs, one pack after the other as in [`StencilPack::indices`].
    fn are_at(&self, indices: &[u32]) -> bool;
    /// Delivers the packs with an index in `rows` in their order, each with its number among all.
    fn deliver(&self, rows: &Range<usize>, to: &mut dyn FnMut(usize, &StencilPack<'_>));
}

/// Where a model delivers its Hessian.
pub trait Sink<const D: usize> {
    /// Adds the block ∂²U/∂xₐ∂x_b for two indices of the same body.
    fn block(&mut self, a: usize, b: usize, value: [[f64; D]; D]);
    /// Adds c·u uᵀ, where u is given by its entries at some indices: never written out as a dense matrix.
    fn low_rank(&mut self, c: f64, u: &[(usize, [f64; D])]);
    /// Adds a dense matrix that turns with its body. A sink that keeps a sparse matrix keeps this part beside it, as it is; one that looks
    /// at entries alone sees them block by block.
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
    /// The same of many, which may be worked out on so many threads; they change no bits.
    fn stencil_packs(&mut self, _threads: usize, packs: &dyn StencilPacks<D>) {
        packs.deliver(&(0..usize::MAX), &mut |_, pack| self.stencils(pack));
    }
}

/// What stays the same while a [`Potential`] lives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Properties {
    /// The word that names the model.
    pub name: &'static str,
    /// Which questions it answers.
    pub views: Views,
    /// Where energy and power are entered.
    pub account: Account,
    /// The rate λ [1/s] at which it brakes every node at least, f = −λ m v, whatever the motion; the least of its bodies.
    pub uniform_damping: f64,
    /// How many numbers `prepare` leaves behind.
    pub scratch_len: usize,
    /// Whether `prepare` and the derivatives are spread over [`View::threads`], for bodies that are large enough.
    pub shares_threads: bool,
    /// Whether `add_force` itself begins the forces of a tile with the weight where `tile.weight` says so, which saves a pass.
    pub begins_tiles: bool,
    /// Whether `prepare` reads all that forces depend on, so that nodes of one stencil may move one after the other.
    pub forces_in_prepare: bool,
    /// Whether nodes push only one another: forces have no sum and no moment about any point, and turn with the body. The conformance suite
    /// checks the sums. None where a model does not say: then the integrators measure it in every step.
    pub acts_between_nodes: Option<bool>,
    /// Whether the world judges by its energy if a body rests in another balance than that of its own shape.
    pub judges_balance: bool,
}

impl Properties {
    /// Those of an elastic model without anything special.
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

/// A model of one body, or of eight alike bodies side by side: the energy U(x) and what derives from it.
///
/// This is the only dynamic dispatch: one call per model and tile. `memory` is what the model remembers from step to
/// step (an amount of gas, a ramp); it is part of the state. `scratch` is what [`Potential::prepare`] works out for the
/// calls that follow it.
pub trait Potential<const D: usize>: Observe<D> + Send + Sync + Debug {
    /// What stays the same while it lives.
    fn properties(&self) -> Properties;
    /// Calls back with the nodes of every term of the energy that couples nodes, in any order: what colours, tiles and drawings
    /// of the coupling need. A term of one node, or of the whole body (the volume of a gas, whose facets are named), is none.
    fn stencils(&self, _visit: &mut dyn FnMut(&[u32])) {}
    /// What its consistent mass matrix adds to the lumped masses of pairs of nodes, (row, column, mass [kg]); nothing where
    /// masses are lumped.
    fn inertia(&self) -> &[(u32, u32, f64)] {
        &[]
    }
    /// What is remembered at the start.
    fn initial_memory(&self) -> Vec<f64> {
        Vec::new()
    }
    /// Works out what concerns the body as a whole (volume, pressure, a factor over time).
    ///
    /// # Errors
    /// [`StepError::Model`] where the model has no meaning in this state.
    fn prepare(&self, _simd: Simd, _view: &View<D>, _memory: &[f64], _scratch: &mut [f64]) -> Result<(), StepError> {
        Ok(())
    }
    /// Adds the whole force of the model, −∂U/∂x and damping [N], on every node of the tile.
    fn add_force(&self, simd: Simd, view: &View<D>, scratch: &[f64], tile: &mut Tile<D>);
    /// Moves the memory on by one substep; returns the energy put into each body by that [J]. The scratch is that of the
    /// last `prepare` and may be overwritten.
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
    /// The energy U of each body [J], after `prepare` in the same state: eight numbers whose sum is that of one body,
    /// or one number for each of eight bodies.
    fn energy(&self, _simd: Simd, _view: &View<D>, _scratch: &[f64]) -> [f64; WIDTH] {
        [0.0; WIDTH]
    }
    /// The size of the parts whose difference U is at rest, of all bodies together [J]: rounding of these is no energy. Zero
    /// where U is a sum of squares.
    fn energy_parts(&self) -> f64 {
        0.0
    }
    /// Delivers ∂²U/∂x∂x, after `prepare` in the same state.
    fn hessian(&self, _view: &View<D>, _scratch: &[f64], _keep: Definiteness, _sink: &mut dyn Sink<D>) {}
    /// Delivers −∂F/∂v, the matrix of damping, after `prepare` in the same state.
    fn damping_matrix(&self, _view: &View<D>, _scratch: &[f64], _sink: &mut dyn Sink<D>) {}
    /// Adds ∂²U/∂x∂x · direction; indices outside of the bodies are left alone.
    fn add_hessian_product(&self, view: &View<D>, scratch: &[f64], direction: &[&[f64]; D], out: &mut [&mut [f64]; D]) {
        let mut product = ProductSink { direction, out };
        self.hessian(view, scratch, Definiteness::Exact, &mut product);
    }
}

/// What people and programs read of a model; no integrator asks for it.
pub trait Observe<const D: usize> {
    /// Why it has no energy, or no symmetric second derivatives, for refusals; nothing where it has both.
    fn lacks(&self) -> Option<AnyMessage> {
        None
    }
    /// Pairs of nodes that a spring ties to each other, for pictures.
    fn bonds(&self) -> &[[u32; 2]] {
        &[]
    }
    /// Names and values per body of what a reader may want to see (`volume`, `pressure`), body by body.
    fn readings(&self, _view: &View<D>, _scratch: &[f64], _memory: &[f64], _body: usize) -> Vec<Reading> {
        Vec::new()
    }
    /// The pressure of the gas [Pa] that each node of a body bounds, in any order; nothing where the model holds no gas.
    fn node_pressures(&self, _view: &View<D>, _scratch: &[f64], _body: usize) -> Vec<(u32, f64)> {
        Vec::new()
    }
    /// Stress and volume ratio of the cells of a body, in any order; nothing where the model knows none.
    fn cell_states(&self, _view: &View<D>, _body: usize) -> Vec<CellState> {
        Vec::new()
    }
    /// Stress and volume ratio of the facets of a body, in any order, for a model that knows its boundary alone; `cell` is the facet.
    fn facet_states(&self, _view: &View<D>, _body: usize) -> Vec<CellState> {
        Vec::new()
    }
    /// How often something happened that a user should know of (a limit acted): counts kept in the memory.
    fn counts(&self, _memory: &[f64]) -> Vec<Count> {
        Vec::new()
    }
    /// What deserves attention in the shapes of its bodies in a state, counted by every call: the memory keeps none of it.
    fn shape_counts(&self, _view: &View<D>) -> Vec<Count> {
        Vec::new()
    }
    /// Whether what it was built of has the same bits on every processor: not where a library factored a matrix.
    fn same_bits_everywhere(&self) -> bool {
        true
    }
    /// Bytes on the heap.
    fn heap_bytes(&self) -> usize {
        0
    }
}

/// What a cell of a body is under, or a facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellState {
    /// The cell, in the order of [`opruga_mesh::Cells::iter`].
    pub cell: u32,
    /// Its mean Cauchy stress σ [Pa], row by row; in the plane with what acts across it.
    pub stress: [[f64; 3]; 3],
    /// Its volume over that at rest, J.
    pub volume_ratio: f64,
    /// The least J at its integration points, of its shape and of what its law is asked with: a cell with a volume may be flat or
    /// inside out at some of them.
    pub smallest_volume_ratio: f64,
    /// Its volume at rest [m³], in the plane its area times the thickness.
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
    /// Whether it has no volume or a negative one, somewhere: less than a thousandth of its volume at rest, or a number that is none.
    pub fn is_degenerate(&self) -> bool {
        /// Cells below this part of their volume have none.
        const NO_VOLUME: f64 = 1e-3;
        !matches!(self.smallest_volume_ratio.partial_cmp(&NO_VOLUME), Some(core::cmp::Ordering::Greater))
    }
    /// The pressure −⅓ tr σ [Pa].
    pub fn pressure(&self) -> f64 {
        -(self.stress[0][0] + self.stress[1][1] + self.stress[2][2]) / 3.0
    }
}

/// Multiplies the blocks of a Hessian with a vector as they arrive.
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

/// What a model is built from: a body at rest, or eight alike ones with their own parameters.
#[derive(Clone, Debug)]
pub struct Ingredients<'a, const D: usize> {
    /// The rest shape, the same for all.
    pub mesh: &'a Mesh<D>,
    /// One body or eight side by side.
    pub layout: Layout,
    /// The parameters of each body: one entry, or eight.
    pub values: &'a [&'a Values],
    /// Mass of every node [kg], laid out like the columns.
    pub mass: &'a crate::state::Parameter,
    /// Density of every cell [kg/m³], where they differ.
    pub densities: Option<&'a [f64]>,
    /// Thickness out of the plane in 2D, of a sheet in 3D [m].
    pub thickness: f64,
    /// Acceleration of gravity [m/s²].
    pub gravity: [f64; D],
    /// Length of a substep as the scene declares it [s]: for published schemes whose stiffness depends on it, and for nothing else.
    pub step: f64,
    /// What breaks off a preparation that takes seconds, and is told how far it is.
    pub break_off: &'a crate::break_off::BreakOff,
}

impl<const D: usize> Ingredients<'_, D> {
    /// The same number of every body, eight times if there is only one.
    pub fn by_body(&self, mut number: impl FnMut(&Values) -> f64) -> [f64; WIDTH] {
        core::array::from_fn(|l| number(self.values[l.min(self.values.len() - 1)]))
    }
}

/// A kind of model that scenes can name.
pub trait Model<const D: usize>: Send + Sync {
    /// Its parameters and documentation.
    fn spec(&self) -> &'static Spec;
    /// Whether its potentials have an energy and second derivatives, on every body and with the defaults of its parameters; what some
    /// parameters take away, their documentation says.
    fn views(&self) -> Views {
        Views { energy: true, hessian: true, symmetric: true, damping: false }
    }
    /// What it needs for one body beside the mesh and the state.
    fn need(&self, _counts: &Counts) -> Need {
        Need::default()
    }
    /// Builds it for one body, or for eight alike ones.
    ///
    /// # Errors
    /// [`BuildError`] where the body cannot carry the model or a combination of parameters has no meaning.
    fn build(&self, ingredients: &Ingredients<D>) -> Result<Box<dyn Potential<D>>, BuildError>;
}
