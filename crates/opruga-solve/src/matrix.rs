//! A sparse symmetric matrix of blocks, with one row and column of blocks for each node, and rank-one terms.

use crate::blocks::{Block, isotropic, nodes, nodes_mut, product, times};

use crate::beside::Beside;
use crate::landing::{Landing, is_known};
use crate::rank_one::RankOne;
use opruga_core::potential::{DensePart, Sink, StencilPack, StencilPacks};
use opruga_core::threads::each_part;
use opruga_math::{Simd, WIDTH};

/// Compressed rows of blocks, filled by models through [`Sink`].
///
/// The pattern is determined once. From then on, the k-th call of a model adds to the same block as before, without a search. If a call is for
/// another block, the matrix searches for that block; a missing block extends the pattern.
#[derive(Clone, Debug, Default)]
pub struct BlockMatrix<const D: usize> {
    /// The start of the blocks of each row, and the end of the last.
    pub(crate) start: Vec<u32>,
    /// The column of each block, ascending within a row.
    pub(crate) column: Vec<u32>,
    /// The index of the diagonal block of each row.
    pub(crate) diagonal: Vec<u32>,
    pub(crate) values: Vec<Block<D>>,
    /// The number of changes of the pattern.
    pub(crate) generation: u64,
    scripts: [Script; SCRIPTS],
    script: usize,
    cursor: usize,
    packs: Cursor,
    recording: bool,
    missing: Vec<(u32, u32)>,
    factor: f64,
    rank_one: Vec<RankOne<D>>,
    ranks: usize,
    beside: Vec<Beside<D>>,
}

/// The number of sequences of calls that are remembered.
const SCRIPTS: usize = 2;

/// A sequence of calls, and the block of each call.
#[derive(Clone, Debug, Default)]
struct Script {
    calls: Vec<(u32, u32)>,
    slots: Vec<u32>,
    /// The nodes of packs of stencils, in the order of delivery, and the indices of their blocks.
    pack_indices: Vec<u32>,
    pack_slots: Vec<u32>,
}

/// The position of packs of stencils in their script.
#[derive(Clone, Copy, Debug, Default)]
struct Cursor {
    indices: usize,
    slots: usize,
}

impl Script {
    fn heap_bytes(&self) -> usize {
        let numbers = self.slots.capacity() + self.pack_indices.capacity() + self.pack_slots.capacity();
        self.calls.capacity() * 8 + numbers * 4
    }
    fn is_empty(&self) -> bool {
        self.calls.is_empty() && self.pack_indices.is_empty()
    }
    fn clear(&mut self) {
        self.calls.clear();
        self.slots.clear();
        self.pack_indices.clear();
        self.pack_slots.clear();
    }
}

/// The number of calls in the script that are searched for a call out of order.
const LOOK_AHEAD: usize = 64;

impl<const D: usize> BlockMatrix<D> {
    /// The number of rows of blocks.
    pub fn rows(&self) -> usize {
        self.diagonal.len()
    }
    /// The number of blocks.
    pub fn blocks(&self) -> usize {
        self.column.len()
    }
    /// The number of rank-one terms.
    pub fn parts(&self) -> usize {
        self.rank_one.len()
    }
    /// Bytes on the heap.
    pub fn heap_bytes(&self) -> usize {
        let scripts: usize = self.scripts.iter().map(Script::heap_bytes).sum();
        self.values.capacity() * size_of::<Block<D>>() + (self.column.capacity() + self.start.capacity()) * 4 + scripts
    }

    /// Fills the matrix again: `deliver` is called once, or more often while the pattern is being determined. `script` is the number of the sequence
    /// of calls, for models that deliver in different orders.
    pub fn assemble(&mut self, nodes: usize, script: usize, mut deliver: impl FnMut(&mut BlockMatrix<D>)) {
        if self.rows() != nodes {
            *self = BlockMatrix { generation: self.generation + 1, ..BlockMatrix::default() };
            self.start = (0..=nodes as u32).collect();
            self.column = (0..nodes as u32).collect();
            self.diagonal = (0..nodes as u32).collect();
            self.values = vec![[[0.0; D]; D]; nodes];
        }
        self.script = script.min(SCRIPTS - 1);
        self.recording = self.scripts[self.script].is_empty();
        loop {
            self.values.fill([[0.0; D]; D]);
            (self.cursor, self.packs, self.ranks, self.factor) = (0, Cursor::default(), 0, 1.0);
            if self.recording {
                self.scripts[self.script].clear();
            }
            self.beside.clear();
            deliver(self);
            if self.missing.is_empty() {
                break;
            }
            self.grow();
            self.recording = true;
        }
        self.recording = false;
        self.rank_one.truncate(self.ranks);
    }
    /// Sets the factor of everything that is delivered from now on.
    pub fn scale(&mut self, factor: f64) {
        self.factor = factor;
    }
    /// Adds a multiple of the unit matrix to the block of a node, regardless of the scale.
    pub fn add_diagonal(&mut self, node: usize, value: f64) {
        let block = &mut self.values[self.diagonal[node] as usize];
        for d in 0..D {
            block[d][d] += value;
        }
    }

    /// Adds the missing blocks to the pattern.
    fn grow(&mut self) {
        let mut keys: Vec<(u32, u32)> = std::mem::take(&mut self.missing);
        for row in 0..self.rows() {
            keys.extend(self.row(row).map(|at| (row as u32, self.column[at])));
        }
        keys.sort_unstable();
        keys.dedup();
        let rows = self.rows();
        self.start = vec![0; rows + 1];
        self.column.clear();
        for (at, (row, column)) in keys.iter().enumerate() {
            self.start[*row as usize + 1] += 1;
            self.column.push(*column);
            if row == column {
                self.diagonal[*row as usize] = at as u32;
            }
        }
        for row in 0..rows {
            self.start[row + 1] += self.start[row];
        }
        self.values = vec![[[0.0; D]; D]; keys.len()];
        self.scripts = Default::default();
        self.generation += 1;
    }

    pub(crate) fn row(&self, row: usize) -> core::ops::Range<usize> {
        self.start[row] as usize..self.start[row + 1] as usize
    }

    fn find(&mut self, key: (u32, u32)) -> Option<usize> {
        if !self.recording {
            let script = &self.scripts[self.script];
            let ahead = script.calls[self.cursor.min(script.calls.len())..].iter().take(LOOK_AHEAD);
            if let Some(skipped) = ahead.clone().position(|call| *call == key) {
                self.cursor += skipped + 1;
                return Some(script.slots[self.cursor - 1] as usize);
            }
        }
        let at = self.look_up(key)?;
        if self.recording {
            self.scripts[self.script].calls.push(key);
            self.scripts[self.script].slots.push(at as u32);
        }
        Some(at)
    }

    /// Searches for the index of a block.
    fn look_up(&self, key: (u32, u32)) -> Option<usize> {
        let row = self.row(key.0 as usize);
        self.column[row.clone()].binary_search(&key.1).ok().map(|at| row.start + at)
    }

    fn block_by_block(&mut self, pack: &StencilPack<'_>) {
        for lane in 0..pack.count {
            for a in 0..pack.nodes {
                for b in 0..pack.nodes {
                    self.block(pack.index(a, lane), pack.index(b, lane), pack.block(a, b, lane));
                }
            }
        }
    }

    /// Records the indices of the blocks of a pack of stencils.
    fn record(&mut self, pack: &StencilPack<'_>) {
        self.scripts[self.script].pack_indices.extend_from_slice(pack.indices);
        for lane in 0..pack.count {
            for a in 0..pack.nodes {
                for b in 0..pack.nodes {
                    let key = (pack.index(a, lane) as u32, pack.index(b, lane) as u32);
                    match self.look_up(key) {
                        Some(at) => self.scripts[self.script].pack_slots.push(at as u32),
                        None => self.missing.push(key),
                    }
                }
            }
        }
    }

    /// Adds the blocks of a pack of stencils at the same indices as before; returns the number of these indices.
    fn replay(&mut self, pack: &StencilPack<'_>) -> usize {
        let count = pack.count * pack.nodes * pack.nodes;
        let slots = &self.scripts[self.script].pack_slots[self.packs.slots..][..count];
        let Self { values, factor, .. } = self;
        Landing { values, first: 0, factor: *factor }.add(Simd::best(), pack, slots);
        count
    }

    /// Adds packs of stencils on several threads, each of which handles some rows; returns false if they are out of order.
    fn replay_in_rows(&mut self, threads: usize, packs: &dyn StencilPacks<D>) -> bool {
        let (nodes, stencils) = (packs.nodes(), packs.stencils());
        let (index_count, slots) = (stencils.div_ceil(WIDTH) * WIDTH * nodes, stencils * nodes * nodes);
        let script = &self.scripts[self.script];
        let (Some(known), Some(slots)) = (
            script.pack_indices.get(self.packs.indices..self.packs.indices + index_count),
            script.pack_slots.get(self.packs.slots..self.packs.slots + slots),
        ) else {
            return false;
        };
        if !packs.are_at(known) {
            return false;
        }
        // Ranges of rows with about equally many blocks.
        let share = self.values.len().div_ceil(threads);
        let mut rows: Vec<usize> =
            (0..threads).map(|k| self.start.partition_point(|start| (*start as usize) < k * share)).collect();
        rows.dedup();
        rows.retain(|row| *row < self.rows());
        let starts: Vec<usize> = rows.iter().map(|row| self.start[*row] as usize).collect();
        let factor = self.factor;
        each_part(threads, &mut self.values, &starts, |part, values| {
            let rows = rows[part]..rows.get(part + 1).map_or(usize::MAX, |row| *row);
            let mut landing = Landing { values, first: starts[part], factor };
            packs.deliver(&rows, &mut |number, pack| {
                let from = number * WIDTH * nodes * nodes;
                landing.add(Simd::best(), pack, &slots[from..from + pack.count * nodes * nodes]);
            });
        });
        self.packs.indices += index_count;
        self.packs.slots += slots.len();
        true
    }

    /// Computes y = A x. Each row is summed in the order of its columns, so the bits are the same everywhere.
    pub fn multiply(&self, x: &[f64], y: &mut [f64]) {
        let by_node = nodes::<D>(x);
        for (row, out) in nodes_mut::<D>(y).iter_mut().enumerate() {
            *out = self.row_times(row, by_node);
        }
        for part in &self.rank_one {
            let along = part.factor * part.along(by_node);
            let y = nodes_mut::<D>(y);
            for (node, u) in &part.entries {
                for d in 0..D {
                    y[*node as usize][d] += along * u[d];
                }
            }
        }
        self.add_dense(x, y);
    }
    #[inline(always)]
    fn row_times(&self, row: usize, x: &[[f64; D]]) -> [f64; D] {
        let mut out = [0.0; D];
        let range = self.row(row);
        for (column, block) in self.column[range.clone()].iter().zip(&self.values[range]) {
            let part = times(block, &x[*column as usize]);
            for d in 0..D {
                out[d] += part[d];
            }
        }
        out
    }

    /// Removes directions from the matrix: A ← P A P + (1 − P) s, where P is the projector of every node that is not `free`, and
    /// s is the size of the diagonal of the node.
    pub fn constrain(&mut self, free: &[bool], projectors: &[Block<D>]) {
        for row in 0..self.rows() {
            for at in self.start[row] as usize..self.start[row + 1] as usize {
                let column = self.column[at] as usize;
                if free[row] && free[column] {
                    continue;
                }
                let inner = if free[column] { self.values[at] } else { product(&self.values[at], &projectors[column]) };
                let mut block = if free[row] { inner } else { product(&projectors[row], &inner) };
                if row == column {
                    let mut size = 0.0;
                    for d in 0..D {
                        size += self.values[at][d][d].abs() / D as f64;
                    }
                    let size = if size > 0.0 && size.is_finite() { size } else { 1.0 };
                    let unit = isotropic::<D>(size);
                    for i in 0..D {
                        for j in 0..D {
                            block[i][j] += unit[i][j] - size * projectors[row][i][j];
                        }
                    }
                }
                self.values[at] = block;
            }
        }
        for part in &mut self.beside {
            self.rank_one.extend(part.constrain(free, projectors));
        }
        for part in &mut self.rank_one {
            for (node, u) in &mut part.entries {
                if !free[*node as usize] {
                    *u = times(&projectors[*node as usize], u);
                }
            }
        }
    }

    /// Copies another matrix into the present memory, without its sequences of calls.
    pub fn copy_from(&mut self, other: &BlockMatrix<D>) {
        if self.generation != other.generation || self.rows() != other.rows() {
            self.start.clone_from(&other.start);
            self.column.clone_from(&other.column);
            self.diagonal.clone_from(&other.diagonal);
            self.generation = other.generation;
        }
        self.values.clone_from(&other.values);
        self.rank_one.resize(other.rank_one.len(), RankOne::default());
        for (own, part) in self.rank_one.iter_mut().zip(&other.rank_one) {
            own.factor = part.factor;
            own.entries.clone_from(&part.entries);
        }
        self.ranks = other.ranks;
        self.beside.clone_from(&other.beside);
    }
    /// The diagonal block of a node.
    pub fn diagonal_block(&self, node: usize) -> &Block<D> {
        &self.values[self.diagonal[node] as usize]
    }

    pub(crate) fn beside(&self) -> &[Beside<D>] {
        &self.beside
    }
    pub(crate) fn rank_one(&self) -> &[RankOne<D>] {
        &self.rank_one
    }
}

impl<const D: usize> Sink<D> for BlockMatrix<D> {
    fn block(&mut self, a: usize, b: usize, value: Block<D>) {
        let key = (a as u32, b as u32);
        let script = &self.scripts[self.script];
        let at = if !self.recording && script.calls.get(self.cursor) == Some(&key) {
            self.cursor += 1;
            script.slots[self.cursor - 1] as usize
        } else {
            match self.find(key) {
                Some(at) => at,
                None => return self.missing.push(key),
            }
        };
        let block = &mut self.values[at];
        for i in 0..D {
            for j in 0..D {
                block[i][j] += self.factor * value[i][j];
            }
        }
    }
    fn low_rank(&mut self, c: f64, u: &[(usize, [f64; D])]) {
        if self.rank_one.len() == self.ranks {
            self.rank_one.push(RankOne::default());
        }
        let part = &mut self.rank_one[self.ranks];
        part.factor = self.factor * c;
        part.entries.clear();
        part.entries.extend(u.iter().map(|(index, entry)| (*index as u32, *entry)));
        self.ranks += 1;
    }
    fn dense(&mut self, part: &DensePart<'_, D>) {
        self.beside.push(Beside::new(self.factor, part));
    }
    fn stencils(&mut self, pack: &StencilPack<'_>) {
        let (index_count, slots) = (pack.indices.len(), pack.count * pack.nodes * pack.nodes);
        if !is_known(pack.nodes) {
            return self.block_by_block(pack);
        }
        if self.recording {
            let known = self.missing.len();
            self.record(pack);
            if self.missing.len() > known {
                return;
            }
        } else {
            let script = &self.scripts[self.script];
            let expected = script.pack_indices.get(self.packs.indices..self.packs.indices + index_count);
            if expected != Some(pack.indices) || script.pack_slots.len() < self.packs.slots + slots {
                // Out of order.
                return self.block_by_block(pack);
            }
        }
        let slots = self.replay(pack);
        self.packs.indices += index_count;
        self.packs.slots += slots;
    }
    fn stencil_packs(&mut self, threads: usize, packs: &dyn StencilPacks<D>) {
        let known = threads > 1 && !self.recording && is_known(packs.nodes());
        if !(known && self.replay_in_rows(threads, packs)) {
            packs.deliver(&(0..usize::MAX), &mut |_, pack| self.stencils(pack));
        }
    }
}

#[cfg(test)]
#[path = "matrix_tests.rs"]
mod tests;
