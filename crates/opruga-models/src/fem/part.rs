//! The interface between a section and its solid: shares that are evaluated in parallel, matrices, and states of cells.

use super::elements::{Cell, Shape};
use super::nodal_volume::Pressures;
use super::pass::{Matrices, Pass};
use super::pressures::Growth;
use super::section::{FORCES, Section, Share};
use super::totals::{Totals, total};
use super::work::Nodes;
use core::fmt::Debug;
use core::marker::PhantomData;
use opruga_core::error::StepError;
use opruga_core::potential::{CellState, Definiteness, Sink};
use opruga_core::state::{Layout, View};
use opruga_math::{ROW, Simd, WIDTH};

/// A section, whatever its elements.
pub(super) trait Part<const D: usize>: Send + Sync + Debug {
    /// The shares, which may be evaluated in parallel.
    fn shares(&self) -> &[Share];
    /// Visits the nodes of every element.
    fn stencils(&self, visit: &mut dyn FnMut(&[u32]));
    /// The length of the scratch of a share: energies [J] and powers [W] of the bodies, forces [N] (−∂U/∂x and damping), and
    /// copies of the data read. For one body the forces of a node are a row. For eight bodies they are a pack for every
    /// axis.
    fn scratch_len(&self, share: &Share) -> usize;
    /// Evaluates the elements of a share.
    fn evaluate(
        &self,
        share: &Share,
        simd: Simd,
        view: &View<D>,
        pressures: Pressures<'_>,
        scratch: &mut [f64],
    ) -> Result<(), StepError>;
    /// Writes J − 1 of the elements of a share to its scratch, if their nodes resist changes of volume.
    fn grow(&self, share: &Share, simd: Simd, view: &View<D>, scratch: &mut [f64]);
    /// The location of J − 1 of a pack in the scratch of the section, if the scratch contains it.
    fn grown_at(&self, pack: usize) -> Option<usize>;
    /// Delivers ∂²U/∂x∂x, after all shares have been evaluated in the same state.
    fn hessian(
        &self,
        view: &View<D>,
        pressures: Pressures<'_>,
        scratch: &[f64],
        keep: Definiteness,
        sink: &mut dyn Sink<D>,
    );
    /// Delivers −∂F/∂v, under the same condition as `hessian`.
    fn damping_matrix(&self, view: &View<D>, scratch: &[f64], sink: &mut dyn Sink<D>);
    /// Stress and volume ratio of the cells of a body.
    fn cell_states(&self, view: &View<D>, body: usize, out: &mut Vec<CellState>);
    /// Bytes on the heap.
    fn heap_bytes(&self) -> usize;
}

/// Copies a vector at some nodes to rows.
fn to_rows<const D: usize>(columns: &[&[f64]; D], nodes: &[u32], rows: &mut [f64]) {
    for (node, row) in nodes.iter().zip(rows.chunks_exact_mut(ROW)) {
        for d in 0..D {
            row[d] = columns[d][*node as usize];
        }
    }
}

impl<E: Shape<D, N>, const D: usize, const N: usize> Part<D> for Section<E, D, N> {
    fn shares(&self) -> &[Share] {
        &self.shares
    }
    fn stencils(&self, visit: &mut dyn FnMut(&[u32])) {
        self.cells.iter().for_each(|cell| visit(&cell.nodes));
    }
    fn scratch_len(&self, share: &Share) -> usize {
        self.numbers_of(share)
    }
    fn grow(&self, share: &Share, simd: Simd, view: &View<D>, scratch: &mut [f64]) {
        if !(E::SIMPLEX && self.nodal) {
            return;
        }
        let (rest, grown) = scratch.split_at_mut(self.grown(share));
        let x = &mut rest[FORCES + self.forces(share)..][..self.copy(share)];
        if self.layout == Layout::Single {
            to_rows(&view.x, &share.nodes, x);
        }
        let nodes = Nodes { rows: x, columns: view.x };
        simd.run(Growth::<E, D, N> { shape: PhantomData, group: self.group(share.first, share.packs), nodes, grown });
    }
    fn grown_at(&self, pack: usize) -> Option<usize> {
        let share = self.shares.iter().find(|share| (share.first..share.first + share.packs).contains(&pack))?;
        self.nodal.then(|| share.start + self.grown(share) + (pack - share.first) * WIDTH)
    }
    fn evaluate(
        &self,
        share: &Share,
        simd: Simd,
        view: &View<D>,
        pressures: Pressures<'_>,
        scratch: &mut [f64],
    ) -> Result<(), StepError> {
        let scratch = &mut scratch[..self.grown(share)];
        let (sums, rest) = scratch.split_at_mut(FORCES);
        let (forces, rest) = rest.split_at_mut(self.forces(share));
        let (x, v) = rest.split_at_mut(self.copy(share));
        if self.layout == Layout::Single {
            to_rows(&view.x, &share.nodes, x);
            to_rows(&view.v, &share.nodes, v);
            // The spare number of a row carries the pressure.
            for (node, row) in share.nodes.iter().zip(x.chunks_exact_mut(ROW)).filter(|_| self.nodal) {
                row[ROW - 1] = pressures.of(*node as usize)[0];
            }
        }
        let nodes = [Nodes { rows: x, columns: view.x }, Nodes { rows: v, columns: view.v }];
        forces.fill(0.0);
        let mut totals = Totals::default();
        Pass::new(self, simd).forces(share, view, nodes, pressures, &mut totals, forces)?;
        sums[..WIDTH].copy_from_slice(&total(self.layout, &totals.energy));
        sums[WIDTH..].copy_from_slice(&total(self.layout, &totals.power));
        Ok(())
    }
    fn hessian(
        &self,
        view: &View<D>,
        pressures: Pressures<'_>,
        scratch: &[f64],
        keep: Definiteness,
        sink: &mut dyn Sink<D>,
    ) {
        sink.stencil_packs(view.threads, &Matrices::hessian(self, view, pressures, scratch, keep));
    }
    fn damping_matrix(&self, view: &View<D>, scratch: &[f64], sink: &mut dyn Sink<D>) {
        if self.damped {
            sink.stencil_packs(view.threads, &Matrices::damping(self, view, scratch));
        }
    }
    fn cell_states(&self, view: &View<D>, body: usize, out: &mut Vec<CellState>) {
        for share in &self.shares {
            let mut rows = vec![0.0; self.copy(share)];
            to_rows(&view.x, &share.nodes, &mut rows);
            Pass::new(self, Simd::best()).cell_states(share, Nodes { rows: &rows, columns: view.x }, body, out);
        }
    }
    fn heap_bytes(&self) -> usize {
        let shares: usize = self.shares.iter().map(|share| share.nodes.capacity()).sum();
        let list_bytes = 4 * (self.node_indices.capacity() + self.targets.capacity() + shares)
            + size_of::<Cell<N>>() * self.cells.capacity();
        list_bytes + self.geometry.heap_bytes() + self.boxes.heap_bytes() + self.parameters.heap_bytes()
    }
}
