//! Factors of matrices with dense parts that rotate with their body, in the frame of the body.

use crate::Indefinite;
use crate::blocks::{Block, nodes, nodes_mut, product};
use crate::dense_system::{DenseCholesky, DenseFactors};
use crate::following::{FollowingFrame, SolvedBase};
use crate::matrix::BlockMatrix;
use crate::woodbury::Woodbury;
use core::ops::Range;
use opruga_core::dense::Dense;
use opruga_math::Simd;
use std::sync::Arc;

/// The factor of a matrix with dense parts, in the frame of the body if there is one such part.
///
/// If everything next to the dense part (masses, nodes with all axes pinned) is the same in every frame, the factor does not depend on the frame. The
/// factor is then kept while the body rotates and moves.
#[derive(Default)]
pub(crate) struct TurnedFactor {
    size: usize,
    dimensions: usize,
    /// The rotation, row by row.
    frame: Vec<f64>,
    solver: Option<Solver>,
    /// The bits of the data from which the factor was made, if these data are the same in every frame. Also the dense matrix, which keeps its
    /// address.
    made_of: Vec<u64>,
    matrix: Option<Arc<Dense>>,
    /// The terms of a frame that follows its nodes, and the solutions for the vectors in [`SolvedBase`]. These solutions are kept as long as the
    /// inverse.
    following: Option<FollowingFrame>,
    solved_base: Option<SolvedBase>,
}

enum Solver {
    /// The inverse of a matrix that does not change. A product with it reads half as much memory as a solution with the factor.
    Inverse(Dense),
    Positive(DenseCholesky),
    Any(DenseFactors),
}

impl core::fmt::Debug for TurnedFactor {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("TurnedFactor").field("size", &self.size).finish_non_exhaustive()
    }
}

impl TurnedFactor {
    /// Factors a matrix without its rank-one terms.
    pub(crate) fn update<const D: usize>(&mut self, matrix: &BlockMatrix<D>, positive: bool) -> Result<(), Indefinite> {
        let parts = matrix.beside();
        let mut frame = [[0.0; D]; D];
        (0..D).for_each(|d| frame[d][d] = 1.0);
        if let [only] = parts {
            frame = only.frame;
        }
        (self.dimensions, self.following) = (D, None);
        self.frame = frame.iter().flatten().copied().collect();
        let made_of = unturned(matrix, positive);
        let known = made_of.is_some() && made_of.as_ref() == Some(&self.made_of) && self.solver.is_some();
        let same = parts.len() == 1 && self.matrix.as_ref().is_some_and(|own| Arc::ptr_eq(own, &parts[0].matrix));
        if known && same {
            return Ok(());
        }
        (self.solver, self.solved_base) = (None, None);
        let numbers = in_frame(matrix, &frame);
        self.size = matrix.rows() * D;
        self.solver = Some(if positive {
            let factor = DenseCholesky::new(self.size, numbers)?;
            if made_of.is_some() { Solver::Inverse(factor.inverse()) } else { Solver::Positive(factor) }
        } else {
            Solver::Any(DenseFactors::new(self.size, numbers)?)
        });
        self.matrix = parts.first().map(|part| Arc::clone(&part.matrix));
        self.made_of = made_of.unwrap_or_default();
        Ok(())
    }
    /// Takes a frame that follows its nodes, if the inverse exists and there are no other rank-one terms; returns whether the
    /// frame was taken. `right` is replaced by the solution.
    pub(crate) fn follow<const D: usize>(
        &mut self,
        matrix: &BlockMatrix<D>,
        right: Option<&mut [f64]>,
    ) -> Result<bool, Indefinite> {
        let (Some(Solver::Inverse(inverse)), [part], []) = (&self.solver, matrix.beside(), matrix.rank_one()) else {
            return Ok(false);
        };
        let in_order = part.indices.iter().enumerate().all(|(number, index)| number == *index as usize);
        let Some(following) = part.following.as_ref().filter(|_| in_order && part.indices.len() == matrix.rows())
        else {
            return Ok(false);
        };
        let mut masses = vec![0.0; inverse.padded()];
        for (node, masses) in masses.chunks_exact_mut(D).enumerate().take(matrix.rows()) {
            masses.fill(matrix.diagonal_block(node)[0][0]);
        }
        let solve = |sides: &mut [f64]| {
            let right = sides.to_vec();
            inverse.multiply(Simd::best(), &right, sides);
        };
        let base = match self.solved_base.take() {
            Some(base) if base.is_of(following) => base,
            _ => SolvedBase::new(following, &solve),
        };
        let mut side = right.as_ref().map(|right| self.in_frame(right, masses.len()));
        let frame = FollowingFrame::new(following, part.factor, &masses, &base, side.as_deref_mut(), &solve)?;
        if let (Some(right), Some(side)) = (right, side) {
            right.copy_from_slice(&side[..right.len()]);
            self.turn(right, true);
        }
        (self.following, self.solved_base) = (Some(frame), Some(base));
        Ok(true)
    }
    /// Takes all rank-one terms, including the terms of a frame that follows its nodes.
    pub(crate) fn update_parts<const D: usize>(
        &self,
        parts: &mut Woodbury,
        matrix: &BlockMatrix<D>,
        positive: bool,
        right: Option<&mut [f64]>,
    ) -> Result<(), Indefinite> {
        let of_frames: Vec<_> = matrix.beside().iter().flat_map(|part| part.parts_of_rank_one()).collect();
        let all = matrix.rank_one().iter().chain(&of_frames);
        parts.update(matrix.rows() * D, all, positive, right, |sides| self.solve_all(&mut sides.collect::<Vec<_>>()))
    }
    /// Replaces a right-hand side by the solution. The solution takes account of a frame that follows its nodes, but not of rank-one terms.
    pub(crate) fn solve(&self, side: &mut [f64]) {
        let (Some(following), Some(Solver::Inverse(inverse))) = (&self.following, &self.solver) else {
            return self.solve_all(&mut [side]);
        };
        let right = self.in_frame(side, inverse.padded());
        let along = following.along(&right);
        let mut solved = vec![0.0; right.len()];
        inverse.multiply(Simd::best(), &right, &mut solved);
        following.correct(&along, &mut solved);
        side.copy_from_slice(&solved[..side.len()]);
        self.turn(side, true);
    }
    /// Replaces right-hand sides by the solutions without rank-one terms.
    fn solve_all(&self, sides: &mut [&mut [f64]]) {
        let inverse = if let Some(Solver::Inverse(inverse)) = &self.solver { Some(inverse) } else { None };
        let length = inverse.map_or(self.size, Dense::padded);
        let mut all: Vec<f64> = sides.iter().flat_map(|side| self.in_frame(side, length)).collect();
        match &self.solver {
            Some(Solver::Inverse(inverse)) => {
                let right = all.clone();
                inverse.multiply(Simd::best(), &right, &mut all);
            }
            Some(Solver::Positive(factor)) => factor.solve(&mut all),
            Some(Solver::Any(factors)) => factors.solve(&mut all),
            None => all.fill(f64::NAN),
        }
        for (side, own) in sides.iter_mut().zip(all.chunks_exact(length)) {
            side.copy_from_slice(&own[..side.len()]);
            self.turn(side, true);
        }
    }
    /// A vector in the frame, padded to a length.
    fn in_frame(&self, side: &[f64], length: usize) -> Vec<f64> {
        let mut out = vec![0.0; length];
        out[..side.len()].copy_from_slice(side);
        self.turn(&mut out[..side.len()], false);
        out
    }
    /// Rotates a vector into the frame, or back.
    fn turn(&self, b: &mut [f64], back: bool) {
        let (n, frame) = (self.dimensions, &self.frame);
        for node in b.chunks_exact_mut(n) {
            let mut turned = [0.0; 3];
            for i in 0..n {
                turned[i] = (0..n).map(|j| frame[if back { i * n + j } else { j * n + i }] * node[j]).sum();
            }
            node.copy_from_slice(&turned[..n]);
        }
    }
}

/// Whether a block is a multiple of the unit matrix.
fn is_isotropic<const D: usize>(block: &Block<D>) -> bool {
    (0..D).all(|i| (0..D).all(|j| block[i][j] == if i == j { block[0][0] } else { 0.0 }))
}

/// The bits of all data from which the factor is made, if they are the same in every frame.
fn unturned<const D: usize>(matrix: &BlockMatrix<D>, positive: bool) -> Option<Vec<u64>> {
    let [only] = matrix.beside() else { return None };
    let mut out = vec![u64::from(positive), only.factor.to_bits()];
    out.extend(only.indices.iter().map(|index| u64::from(*index)));
    for (number, projector) in &only.pinned {
        if projector.iter().flatten().any(|x| *x != 0.0) {
            return None;
        }
        out.push(u64::from(*number));
    }
    for row in 0..matrix.rows() {
        let range = matrix.row(row);
        for (column, block) in matrix.column[range.clone()].iter().zip(&matrix.values[range]) {
            let zero = block.iter().flatten().all(|x| *x == 0.0);
            if *column as usize == row && is_isotropic(block) {
                out.push(block[0][0].to_bits());
            } else if !zero {
                return None;
            }
        }
    }
    Some(out)
}

/// Returns 𝓡ᵀ A 𝓡 column by column, without rank-one terms.
fn in_frame<const D: usize>(matrix: &BlockMatrix<D>, frame: &Block<D>) -> Vec<f64> {
    let size = matrix.rows() * D;
    let mut out = vec![0.0; size * size];
    let transposed: Block<D> = core::array::from_fn(|i| core::array::from_fn(|j| frame[j][i]));
    // Blocks that are the same in every frame do not change in any bit, so a factor that is kept while the body rotates is equal
    // to a new one.
    let turned = |block: &Block<D>| {
        if is_isotropic(block) { *block } else { product(&transposed, &product(block, frame)) }
    };
    let mut add = |a: usize, b: usize, block: &Block<D>| {
        for j in 0..D {
            for i in 0..D {
                out[(b * D + j) * size + a * D + i] += block[i][j];
            }
        }
    };
    for row in 0..matrix.rows() {
        let range: Range<usize> = matrix.row(row);
        for (column, block) in matrix.column[range.clone()].iter().zip(&matrix.values[range]) {
            add(row, *column as usize, &turned(block));
        }
    }
    let alone = matrix.beside().len() == 1;
    for part in matrix.beside() {
        let mut projectors: Vec<Option<Block<D>>> = vec![None; part.indices.len()];
        for (number, projector) in &part.pinned {
            projectors[*number as usize] = Some(if alone { turned(projector) } else { *projector });
        }
        for (a, row) in part.indices.iter().enumerate() {
            for (b, column) in part.indices.iter().enumerate() {
                let mut block: Block<D> = if alone {
                    core::array::from_fn(|i| {
                        core::array::from_fn(|j| part.factor * part.matrix.at(a * D + i, b * D + j))
                    })
                } else {
                    part.part().block(a, b)
                };
                if let Some(projector) = &projectors[a] {
                    block = product(projector, &block);
                }
                if let Some(projector) = &projectors[b] {
                    block = product(&block, projector);
                }
                add(*row as usize, *column as usize, &block);
            }
        }
    }
    out
}

impl<const D: usize> BlockMatrix<D> {
    /// Whether there are dense parts next to the blocks.
    pub fn has_dense(&self) -> bool {
        !self.beside().is_empty()
    }
    /// The mean size of the diagonal entries of a node, including dense parts.
    pub fn diagonal_size(&self, node: usize) -> f64 {
        let block = self.diagonal_block(node);
        let mut size = (0..D).map(|d| block[d][d].abs()).sum::<f64>() / D as f64;
        for part in self.beside() {
            if let Some(number) = part.number_of(node) {
                size += part.size_at(number);
            }
        }
        size
    }
    /// The diagonal blocks of all nodes, including dense parts.
    pub fn diagonal_blocks(&self) -> Vec<Block<D>> {
        let mut out: Vec<Block<D>> = (0..self.rows()).map(|node| *self.diagonal_block(node)).collect();
        for part in self.beside() {
            let mut own: Vec<Block<D>> = (0..part.indices.len()).map(|number| part.diagonal_block(number)).collect();
            for (number, projector) in &part.pinned {
                own[*number as usize] = product(projector, &product(&own[*number as usize], projector));
            }
            for (index, block) in part.indices.iter().zip(&own) {
                for i in 0..D {
                    (0..D).for_each(|j| out[*index as usize][i][j] += block[i][j]);
                }
            }
        }
        out
    }
    /// Adds the products of the dense parts.
    pub(crate) fn add_dense(&self, x: &[f64], y: &mut [f64]) {
        for part in self.beside() {
            part.add_product(nodes::<D>(x), nodes_mut::<D>(y));
        }
    }
}
