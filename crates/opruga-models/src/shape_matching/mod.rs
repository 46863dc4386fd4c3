//! # Shape matching
//!
//! Clusters of nodes are pulled towards the nearest copy of their rest shape (Müller, Heidelberger, Teschner, Gross 2005). With
//! the masses m of the nodes in a cluster, their mean x̄, p = x − x̄ and q = X − X̄,
//!
//! U = (1 − β) U_R + β U_A,  U_R = min over rotations R of ½ κ Σ m |p − R q|²,  U_A = min over T of ½ κ Σ m |p − T q̃|²,
//!
//! where q̃ is q (linear: stretch and shear), or q and the products of its coordinates, centred (quadratic: 5 columns in the
//! plane, 9 in space). Each energy is minimal over its own map, so the derivatives of the maps do not enter the gradient:
//!
//! f = −κ m (p − (1 − β) R q − β T q̃),  Σ f = 0,  Σ x × f = 0.
//!
//! R is the rotation nearest to A = Σ m p qᵀ, with det R = 1 even if the cluster is inverted. T comes from columns φₖ that are
//! orthonormal with respect to the masses (Σ m φₖ φₗ = δₖₗ): T q̃ = Σ cₖ φₖ with cₖ = Σ m p φₖ, so no matrix is inverted. If
//! the nodes of a cluster lie on a line or a plane, or are few, some columns are linearly dependent. Such columns are left out,
//! and their directions stay free.
//!
//! **Hessian** (file `hessian`): κ m on the diagonal, minus terms of rank one: translations, rotations with 1/(σᵢ + σⱼ) of A, and
//! the D columns cₖ with κβ. A compressed cluster has negative eigenvalues along rotations (σᵢ + σⱼ less than at rest). The
//! clamped Hessian has none.
//!
//! **Frequencies** at rest, if the masses in U are those of the nodes: 0 for rigid motion, √((1 − β)κ) for strains that T
//! follows, √κ for all other motions.
//!
//! **As published**, T is divided by the D-th root of det T (of the linear fit), and κ may be α/h². That force has no
//! potential: only explicit integrators accept it, and its power counts as external work. If det T is not positive, R replaces
//! T. The columns of the paper's quadratic fit are not centred. Here these columns are centred, so that no momentum arises.
//!
//! Limits: κ is not the stiffness of a material, and refining a body does not change its stiffness. R is not unique if the two
//! smallest σ are opposite. The singular vectors then determine the choice.

mod hessian;
mod kernels;
mod layout;
mod piece_kernels;
mod pieces;
mod refusals;
mod regions;
mod shape;
mod spec;

pub use refusals::{MatchingWarning, Refusal};
pub use spec::SPEC;

use kernels::{Energy, Fit, Law, Moments, Push, SlotForces, Stored, VOLUME};
use layout::Clusters;
use opruga_core::error::{BuildError, StepError};
use opruga_core::memory::{Counts, Need};
use opruga_core::potential::{
    Account, Count, Definiteness, Ingredients, Model, Observe, Potential, Properties, Sink, Views,
};
use opruga_core::spec::Spec;
use opruga_core::state::{Layout, Parameter, View};
use opruga_core::tile::Tile;
use opruga_math::matrix::determinant;
use opruga_math::message::AnyMessage;
use opruga_math::{Pack, Simd, WIDTH, Work};
use piece_kernels::{PieceForces, PieceMaps, PieceMoments};
use pieces::Pieces;

/// The kind of model that scenes call `shape_matching`.
#[derive(Debug)]
pub struct ShapeMatchingModel;

/// The clusters of one body, or of eight identical ones, and their law.
#[derive(Debug)]
pub struct Matching<const D: usize> {
    clusters: Clusters<D>,
    /// The pieces that the clusters share, if using them saves work.
    pieces: Option<Pieces<D>>,
    law: Law,
    stored: Stored,
    /// Whether the force is the published one, which is not a gradient.
    is_published: bool,
    /// The substep [s] to which `goal_step` of each body refers, if it is given.
    step: Option<f64>,
}

impl<const D: usize> Model<D> for ShapeMatchingModel {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }
    fn batches(&self) -> bool {
        true
    }
    fn need(&self, counts: &Counts) -> Need {
        // A body that is one cluster needs this memory for masses and columns. With boxes, a node is in 2ᴰ clusters.
        Need { bytes: 150.0 * counts.nodes, couplings: 0.0 }
    }
    fn build(&self, ingredients: &Ingredients<D>) -> Result<Box<dyn Potential<D>>, BuildError> {
        Ok(Box::new(Matching::new(ingredients)?))
    }
}

impl<const D: usize> Matching<D> {
    fn new(ingredients: &Ingredients<D>) -> Result<Matching<D>, BuildError> {
        let first = ingredients.values[0];
        let is_published = first.text("scheme") == Some("as_published");
        for values in ingredients.values {
            values.check_choices(&SPEC)?;
            if let (Some(share), false) = (values.number("goal_step"), is_published) {
                return Err(
                    Refusal::GoalStep { share, stiffness: share / (ingredients.step * ingredients.step) }.into()
                );
            }
        }
        let lists = regions::clusters(ingredients.mesh, first)?;
        let clusters = Clusters::new(ingredients, &lists, first.text("fit") == Some("quadratic"));
        let number = |name: &'static str| ingredients.by_body(move |values| values.number(name).unwrap_or(0.0));
        let stiffness = ingredients.by_body(|values| match values.number("goal_step") {
            Some(share) => share / (ingredients.step * ingredients.step),
            None => values.number("stiffness").unwrap_or(0.0),
        });
        Ok(Matching {
            stored: Stored::of(&clusters),
            pieces: Pieces::new(ingredients, &clusters),
            clusters,
            law: Law {
                stiffness: Parameter::by_body(stiffness),
                share: Parameter::by_body(number("fit_share")),
                keeps_volume: is_published,
            },
            is_published,
            step: ingredients
                .values
                .iter()
                .any(|values| values.number("goal_step").is_some())
                .then_some(ingredients.step),
        })
    }
}

/// Runs work that is compiled for 2, 3, 5 and 9 columns.
macro_rules! by_columns {
    ($columns:expr, $simd:expr, $work:ident $fields:tt) => {
        match $columns {
            2 => by_columns!(@run $simd, $work 2 $fields),
            3 => by_columns!(@run $simd, $work 3 $fields),
            5 => by_columns!(@run $simd, $work 5 $fields),
            _ => by_columns!(@run $simd, $work 9 $fields),
        }
    };
    (@run $simd:expr, $work:ident $columns:literal { $($field:ident: $value:expr),* }) => {
        $simd.run($work::<D, $columns> { $($field: $value),* })
    };
}

impl<const D: usize> Potential<D> for Matching<D> {
    fn properties(&self) -> Properties {
        let is_gradient = !self.is_published;
        let views = Views { energy: is_gradient, hessian: is_gradient, symmetric: is_gradient, damping: false };
        Properties {
            account: if self.is_published { Account::User } else { Account::Elastic },
            scratch_len: self.scratch_len(),
            begins_tiles: true,
            forces_in_prepare: true,
            acts_between_nodes: is_gradient.then_some(true),
            ..Properties::new(SPEC.kind, views)
        }
    }
    /// Visits the nodes of every cluster. Does nothing if a cluster is the whole body.
    fn stencils(&self, visit: &mut dyn FnMut(&[u32])) {
        let stride = self.clusters.layout.stride() as u32;
        for cluster in (0..self.clusters.len()).filter(|_| !self.clusters.is_whole) {
            let first = self.clusters.range(cluster).start;
            let slots = &self.clusters.indices[first..first + self.clusters.count[cluster] as usize];
            let nodes: Vec<u32> = slots.iter().map(|index| index / stride).collect();
            visit(&nodes);
        }
    }
    fn initial_memory(&self) -> Vec<f64> {
        // For every body: the step for which the stiffness was declared, and how often a cluster was mirrored.
        let mut memory = vec![self.step.unwrap_or(0.0); WIDTH];
        memory.resize(2 * WIDTH, 0.0);
        memory
    }
    fn prepare(&self, simd: Simd, view: &View<D>, memory: &[f64], scratch: &mut [f64]) -> Result<(), StepError> {
        if let Some(declared) = self.step
            && let Some(now) = memory.iter().take(WIDTH).find(|now| **now != declared)
        {
            let refusal = Refusal::StepChanged { now: *now, declared, stiffness: self.law.stiffness.at(0) };
            return Err(StepError::of(SPEC.kind, refusal));
        }
        let (clusters, stored, law) = (&self.clusters, self.stored, &self.law);
        if let Some(pieces) = &self.pieces {
            simd.run(PieceMoments { clusters, pieces, stored, view, scratch });
            simd.run(Fit { clusters, stored, law, scratch });
            simd.run(PieceMaps { clusters, pieces, stored, view, scratch });
            return Ok(());
        }
        by_columns!(
            clusters.columns,
            simd,
            Moments { clusters: clusters, stored: stored, view: view, scratch: scratch }
        );
        simd.run(Fit { clusters, stored, law, scratch });
        if !clusters.is_whole {
            by_columns!(
                clusters.columns,
                simd,
                SlotForces { clusters: clusters, stored: stored, law: law, view: view, scratch: scratch }
            );
        }
        Ok(())
    }
    fn add_force(&self, simd: Simd, view: &View<D>, scratch: &[f64], tile: &mut Tile<D>) {
        let (clusters, stored, law, works) = (&self.clusters, self.stored, &self.law, self.is_published);
        if let Some(pieces) = &self.pieces {
            let rows = &scratch[stored.forces..];
            simd.run(PieceForces { pieces, law, view, rows, tile, works });
            return;
        }
        if clusters.is_whole {
            by_columns!(
                clusters.columns,
                simd,
                Push {
                    clusters: clusters,
                    stored: stored,
                    law: law,
                    view: view,
                    scratch: scratch,
                    tile: tile,
                    works: works
                }
            );
            return;
        }
        tile.settle(simd);
        simd.run(Gather { clusters, forces: &scratch[stored.forces..], view, tile, works });
    }
    fn remember(&self, _simd: Simd, _view: &View<D>, h: f64, scratch: &mut [f64], memory: &mut [f64]) -> [f64; WIDTH] {
        // A stiffness that depends on the step is refused if the step differs.
        let (steps, mirrored) = memory.split_at_mut(WIDTH);
        steps.fill(h);
        for (body, count) in mirrored.iter_mut().enumerate().take(self.clusters.layout.stride()) {
            *count +=
                (0..self.clusters.len()).filter(|cluster| self.is_mirrored(scratch, *cluster, body)).count() as f64;
        }
        [0.0; WIDTH]
    }
    fn energy(&self, simd: Simd, view: &View<D>, scratch: &[f64]) -> [f64; WIDTH] {
        simd.run(Energy { clusters: &self.clusters, stored: self.stored, law: &self.law, view, scratch })
    }
    fn hessian(&self, _view: &View<D>, scratch: &[f64], keep: Definiteness, sink: &mut dyn Sink<D>) {
        if !self.is_published {
            self.second_derivatives(scratch, keep, sink);
        }
    }
}

impl<const D: usize> Matching<D> {
    /// The length of the data of the clusters, followed by forces of slots, or by rows of pieces and clusters.
    fn scratch_len(&self) -> usize {
        match &self.pieces {
            Some(pieces) => {
                self.stored.forces + (pieces.len() + self.clusters.len()) * Pieces::<D>::row(self.clusters.layout)
            }
            None => self.stored.len(&self.clusters),
        }
    }
    /// Whether the fitted map of a cluster inverts its rest shape.
    fn is_mirrored(&self, scratch: &[f64], cluster: usize, body: usize) -> bool {
        let (clusters, stored) = (&self.clusters, self.stored);
        let at = clusters.layout.index(cluster, body);
        let mut map = [[0.0; D]; D];
        let mut frame = [[0.0; D]; D];
        for d in 0..D {
            for k in 0..D {
                map[d][k] = scratch[(stored.moments + d * clusters.columns + k) * stored.stride + at];
                frame[d][k] = clusters.frame[d * D + k][at];
            }
        }
        let at_rest = determinant(&frame);
        // Below this fraction of the volume at rest, the sign is determined by rounding.
        determinant(&map) * at_rest < -VOLUME * at_rest * at_rest
    }
}

impl<const D: usize> Observe<D> for Matching<D> {
    fn counts(&self, memory: &[f64]) -> Vec<Count> {
        vec![Count { what: MatchingWarning::Mirrored {}.into(), count: memory.iter().skip(WIDTH).sum::<f64>() as u64 }]
    }
    fn lacks(&self) -> Option<AnyMessage> {
        self.is_published.then(|| Refusal::NoPotentialOfGoal {}.into())
    }
    fn heap_bytes(&self) -> usize {
        self.clusters.heap_bytes() + self.pieces.as_ref().map_or(0, Pieces::heap_bytes)
    }
}

/// Adds up the forces of the slots of every node of a tile.
struct Gather<'a, 'b, 'c, const D: usize> {
    clusters: &'a Clusters<D>,
    forces: &'a [f64],
    view: &'a View<'a, D>,
    tile: &'b mut Tile<'c, D>,
    works: bool,
}
impl<const D: usize> Work for Gather<'_, '_, '_, D> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let Gather { clusters, forces, view, tile, works } = self;
        let stride = clusters.layout.stride();
        let indices = clusters.slots() * stride;
        let start = tile.range.start;
        for node in start / stride..(tile.range.end / stride).min(clusters.nodes) {
            let own = &clusters.slots_of[clusters.slots_start[node] as usize..clusters.slots_start[node + 1] as usize];
            let index = node * stride;
            match clusters.layout {
                Layout::Single => {
                    let mut sum = [0.0; D];
                    for slot in own {
                        for d in 0..D {
                            sum[d] += forces[d * indices + *slot as usize];
                        }
                    }
                    for d in 0..D {
                        tile.force[d][index - start] += sum[d];
                        if works {
                            tile.power[index % WIDTH] += sum[d] * view.v[d][index];
                        }
                    }
                }
                Layout::Batch => {
                    let mut power = P::from_array(*tile.power);
                    for d in 0..D {
                        let mut sum = P::zero();
                        for slot in own {
                            sum += P::load(&forces[d * indices + *slot as usize * WIDTH..]);
                        }
                        let to = &mut tile.force[d][index - start..];
                        (P::load(to) + sum).store(to);
                        if works {
                            power += sum * P::load(&view.v[d][index..]);
                        }
                    }
                    power.store(tile.power);
                }
            }
        }
    }
}
