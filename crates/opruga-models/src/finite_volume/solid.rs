//! A solid of finite volumes. Every such solid has a tangent, but only some have a potential.

use super::SPEC;
use super::kernels::Positions;
use super::part::{Matter, Part};
use super::refusals::Refusal;
use opruga_core::error::StepError;
use opruga_core::potential::{CellState, Definiteness, Observe, Potential, Properties, Sink, Views};
use opruga_core::state::{Layout, View};
use opruga_core::tile::Tile;
use opruga_math::message::AnyMessage;
use opruga_math::{ROW, Simd, WIDTH, sum_in_fixed_order};

/// The length of the partial sums of the energies of eight bodies.
const ENERGY: usize = WIDTH * WIDTH;

/// The solid of one body, or of eight identical ones.
#[derive(Debug)]
pub struct Solid<const D: usize> {
    pub(super) layout: Layout,
    pub(super) nodes: usize,
    pub(super) parts: Vec<Box<dyn Part<D>>>,
    pub(super) matter: Matter<D>,
    /// Whether all cells are triangles or tetrahedra.
    pub(super) is_simplicial: bool,
    pub(super) energy_parts: f64,
}

impl<const D: usize> Solid<D> {
    /// The length of the rows of positions.
    fn rows(&self) -> usize {
        if self.layout == Layout::Single { self.nodes * ROW } else { 0 }
    }
    fn forces(&self) -> usize {
        if self.layout == Layout::Single { self.nodes * ROW } else { self.nodes * D * WIDTH }
    }
    fn write_rows(&self, view: &View<D>, rows: &mut [f64]) {
        for (node, row) in rows.chunks_exact_mut(ROW).enumerate() {
            for d in 0..D {
                row[d] = view.x[d][node];
            }
        }
    }
}

impl<const D: usize> Potential<D> for Solid<D> {
    fn properties(&self) -> Properties {
        let symmetric = self.is_simplicial;
        let views = Views { energy: symmetric, hessian: true, symmetric, damping: false };
        Properties {
            scratch_len: ENERGY + self.rows() + self.forces(),
            forces_in_prepare: true,
            ..Properties::new(SPEC.kind, views)
        }
    }
    fn stencils(&self, visit: &mut dyn FnMut(&[u32])) {
        self.parts.iter().for_each(|part| part.stencils(visit));
    }
    fn energy_parts(&self) -> f64 {
        self.energy_parts
    }
    fn prepare(&self, simd: Simd, view: &View<D>, _memory: &[f64], scratch: &mut [f64]) -> Result<(), StepError> {
        let (energy, rest) = scratch.split_at_mut(ENERGY);
        let (rows, forces) = rest.split_at_mut(self.rows());
        self.write_rows(view, rows);
        energy.fill(0.0);
        forces.fill(0.0);
        for part in &self.parts {
            part.evaluate(&self.matter, simd, view, rows, forces, energy)
                .map_err(|refusal| StepError::of(SPEC.kind, refusal))?;
        }
        Ok(())
    }
    fn add_force(&self, _simd: Simd, _view: &View<D>, scratch: &[f64], tile: &mut Tile<D>) {
        let forces = &scratch[ENERGY + self.rows()..];
        let range = tile.range.clone();
        match self.layout {
            Layout::Single => {
                let own = range.start..range.end.min(self.nodes).max(range.start);
                for (k, row) in forces[own.start * ROW..own.end * ROW].chunks_exact(ROW).enumerate() {
                    for d in 0..D {
                        tile.force[d][k] += row[d];
                    }
                }
            }
            Layout::Batch => {
                for node in range.start / WIDTH..(range.end / WIDTH).min(self.nodes) {
                    for d in 0..D {
                        let from = &forces[(node * D + d) * WIDTH..][..WIDTH];
                        let to = &mut tile.force[d][node * WIDTH - range.start..][..WIDTH];
                        for l in 0..WIDTH {
                            to[l] += from[l];
                        }
                    }
                }
            }
        }
    }
    fn energy(&self, _simd: Simd, _view: &View<D>, scratch: &[f64]) -> [f64; WIDTH] {
        match self.layout {
            Layout::Single => core::array::from_fn(|l| scratch[l]),
            Layout::Batch => {
                core::array::from_fn(|l| sum_in_fixed_order(&core::array::from_fn(|slot| scratch[slot * WIDTH + l])))
            }
        }
    }
    fn hessian(&self, view: &View<D>, scratch: &[f64], keep: Definiteness, sink: &mut dyn Sink<D>) {
        let positions = Positions { rows: &scratch[ENERGY..ENERGY + self.rows()], columns: view.x };
        for part in &self.parts {
            part.tangent(&self.matter, positions, keep, sink);
        }
    }
}

impl<const D: usize> Observe<D> for Solid<D> {
    fn lacks(&self) -> Option<AnyMessage> {
        (!self.is_simplicial).then(|| Refusal::NoPotentialOfFaces {}.into())
    }
    fn cell_states(&self, view: &View<D>, body: usize) -> Vec<CellState> {
        let mut rows = vec![0.0; self.rows()];
        self.write_rows(view, &mut rows);
        let mut out = Vec::new();
        for part in &self.parts {
            part.cell_states(&self.matter, Positions { rows: &rows, columns: view.x }, body, &mut out);
        }
        out
    }
    fn heap_bytes(&self) -> usize {
        self.parts.iter().map(|part| part.heap_bytes()).sum::<usize>() + 8 * self.matter.parameters.capacity()
    }
}
