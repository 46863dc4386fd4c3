//! Dense parts that models deliver next to a sparse matrix.

use crate::blocks::{Block, times};
use crate::rank_one::RankOne;
use opruga_core::dense::Dense;
use opruga_core::potential::{DensePart, Following, RankOnePart};
use std::sync::Arc;

/// A dense part on some nodes, between projectors if directions of nodes are constrained.
#[derive(Clone, Debug)]
pub(crate) struct Beside<const D: usize> {
    pub(crate) factor: f64,
    pub(crate) frame: Block<D>,
    pub(crate) indices: Vec<u32>,
    pub(crate) matrix: Arc<Dense>,
    pub(crate) following: Option<Following>,
    /// For each node with constrained directions, its number in the list and its projector.
    pub(crate) pinned: Vec<(u32, Block<D>)>,
}

impl<const D: usize> Beside<D> {
    pub(crate) fn new(factor: f64, part: &DensePart<'_, D>) -> Beside<D> {
        Beside {
            factor: factor * part.factor,
            frame: *part.frame,
            indices: part.indices.to_vec(),
            matrix: Arc::clone(part.matrix),
            following: part.following.cloned(),
            pinned: Vec::new(),
        }
    }
    pub(crate) fn part(&self) -> DensePart<'_, D> {
        DensePart {
            factor: self.factor,
            frame: &self.frame,
            indices: &self.indices,
            matrix: &self.matrix,
            following: self.following.as_ref(),
        }
    }
    /// The mean of the diagonal entries of a node in its list.
    pub(crate) fn size_at(&self, number: usize) -> f64 {
        self.factor * (0..D).map(|d| self.matrix.at(number * D + d, number * D + d).abs()).sum::<f64>() / D as f64
    }
    /// The diagonal block of a node in its list, before its projector is applied.
    pub(crate) fn diagonal_block(&self, number: usize) -> Block<D> {
        self.part().block(number, number)
    }
    /// Adds A x to y.
    pub(crate) fn add_product(&self, x: &[[f64; D]], y: &mut [[f64; D]]) {
        let mut free: Vec<[f64; D]> = self.indices.iter().map(|index| x[*index as usize]).collect();
        for (number, projector) in &self.pinned {
            free[*number as usize] = times(projector, &free[*number as usize]);
        }
        // The list is in the order of the matrix, while a part is read by indices.
        let order: Vec<u32> = (0..self.indices.len() as u32).collect();
        let mut out = DensePart { indices: &order, ..self.part() }.product(|number| free[number]);
        for (number, projector) in &self.pinned {
            out[*number as usize] = times(projector, &out[*number as usize]);
        }
        for (index, value) in self.indices.iter().zip(&out) {
            (0..D).for_each(|d| y[*index as usize][d] += value[d]);
        }
    }
    /// The rank-one terms that are added because the frame follows its nodes.
    pub(crate) fn parts_of_rank_one(&self) -> Vec<RankOne<D>> {
        let part = |(factor, entries): RankOnePart<D>| {
            let entries = entries.into_iter().map(|(index, entry)| (index as u32, entry)).collect();
            RankOne { factor, entries }
        };
        self.part().parts_of_rank_one().into_iter().map(part).collect()
    }
    /// Constrains the nodes that are not free, by their projectors. If any node is constrained, the frame no longer follows its
    /// nodes, and rank-one terms with the same effect are returned.
    pub(crate) fn constrain(&mut self, free: &[bool], projectors: &[Block<D>]) -> Vec<RankOne<D>> {
        self.pinned.clear();
        for (number, index) in self.indices.iter().enumerate().filter(|(_, index)| !free[**index as usize]) {
            self.pinned.push((number as u32, projectors[*index as usize]));
        }
        if self.pinned.is_empty() {
            return Vec::new();
        }
        let parts = self.parts_of_rank_one();
        self.following = None;
        parts
    }
    /// The number of a node in its list.
    pub(crate) fn number_of(&self, node: usize) -> Option<usize> {
        // A body that is stepped alone lists its nodes in order.
        if self.indices.get(node) == Some(&(node as u32)) {
            return Some(node);
        }
        self.indices.iter().position(|index| *index as usize == node)
    }
}
