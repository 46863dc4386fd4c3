//! Models that consist of pairs of nodes: springs, edges of a gas chamber.
//!
//! Pairs are sorted into *runs*. In a run, both ends advance by one node from each pair to the next, as along an outline or a
//! row of a grid. Each pair of a run is evaluated once, eight pairs at a time, without a table of indices. Pairs outside of
//! long runs are evaluated from both of their ends, node by node (*pull*). Both methods add forces in an order that depends
//! neither on tiles nor on the layout.
//!
//! ```text
//! run of 5:   a   0 1 2 3 4        pull of node 7:   partners 2, 9, 12
//!             b   1 2 3 4 5                          pairs    17, 31, 40
//! ```

mod chain;
mod force;
mod lone;
mod parameters;
mod pull;

use crate::state::{Layout, Parameter};
use crate::tile::TILE;
use core::ops::Range;
use opruga_math::{Lane, Pack, WIDTH};
use pull::Pull;

/// The law of a pair: the force on its first node as a function of the differences of its ends.
pub trait PairLaw<const D: usize>: Copy {
    /// Whether the law reads velocities.
    const DAMPED: bool;
    /// Whether the law reads two numbers that are equal for all pairs of a body ([`PairLaw::uniform`]), and no others.
    const UNIFORM: bool;
    /// The force on the second node divided by the force on the first: −1 or +1.
    const SECOND: f64;
    /// Whether [`PairLaw::ahead`] computes anything.
    const AHEAD: bool;
    /// Three numbers per pair that the law reads.
    fn parameters(&self) -> [&Parameter; 3];
    /// If the law is uniform, returns two numbers for each body, which replace the second and third parameters.
    #[inline(always)]
    fn uniform<P: Pack>(&self) -> [P; 2] {
        [P::zero(); 2]
    }
    /// A result that the force needs and that is slow to compute, such as a division by |d|. It depends only on d = xₐ − x_b. Loops request it some
    /// packs before the force, so that nothing waits for it.
    fn ahead<S: Lane>(&self, d: [S; D]) -> S;
    /// The force on the first node [N] and the dissipated power [W] of pairs, from d = xₐ − x_b, its rate, and the result of
    /// [`PairLaw::ahead`] for d.
    fn force<S: Lane>(&self, parameters: [S; 3], d: [S; D], rate: [S; D], ahead: S) -> ([S; D], S);
}

/// A function of a pair that is summed over all pairs.
pub trait PairTerm<P: Pack, const D: usize>: Copy {
    /// Three numbers per pair that the function reads.
    fn parameters(&self) -> [&Parameter; 3];
    /// The value for eight pairs with these ends.
    fn of(&self, parameters: [P; 3], a: [P; D], b: [P; D]) -> P;
}

/// A run of pairs (a + k, b + k); `first` is the number of its first pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Run {
    a: u32,
    b: u32,
    first: u32,
    count: u32,
}

/// The pairs of a body, sorted for evaluation.
#[derive(Clone, Debug, PartialEq)]
pub struct PairTable {
    layout: Layout,
    runs: Vec<Run>,
    /// The runs that touch each tile of the plan, one tile after the other, and the start of each list.
    tile_runs: Vec<u32>,
    tile_start: Vec<u32>,
    pull: Option<Pull>,
    /// The number of pairs, plus one without effect if some are pulled.
    count: usize,
    pairs: Vec<[u32; 2]>,
}

/// The length of the shortest run that is not pulled, if pulling is allowed.
const SHORTEST_RUN: u32 = 24;

impl PairTable {
    /// Sorts pairs of `nodes` nodes into runs. The shorter runs are pulled if `antisymmetric` is set, which means that the law
    /// changes sign with its argument.
    pub fn new(layout: Layout, nodes: usize, pairs: &[[u32; 2]], antisymmetric: bool) -> PairTable {
        let mut runs: Vec<Run> = Vec::new();
        for (k, &[a, b]) in pairs.iter().enumerate() {
            match runs.last_mut() {
                Some(r) if r.a + r.count == a && r.b + r.count == b => r.count += 1,
                _ => runs.push(Run { a, b, first: k as u32, count: 1 }),
            }
        }
        // A few short runs are cheaper than a table for every node.
        let short: u32 = runs.iter().filter(|r| r.count < SHORTEST_RUN).map(|r| r.count).sum();
        let pulled = antisymmetric && short as usize * 2 > pairs.len() && nodes > 16;
        let mut pull = None;
        if pulled {
            let mut lists: Vec<Vec<(u32, u32)>> = vec![Vec::new(); nodes];
            for r in runs.iter().filter(|r| r.count < SHORTEST_RUN) {
                for k in 0..r.count {
                    lists[(r.a + k) as usize].push((r.b + k, r.first + k));
                    lists[(r.b + k) as usize].push((r.a + k, r.first + k));
                }
            }
            let numbers = |r: &Run| r.first..r.first + r.count;
            let mut loose: Vec<u32> = runs.iter().filter(|r| r.count < SHORTEST_RUN).flat_map(numbers).collect();
            let mut ends = [0, 1].map(|e| loose.iter().map(|&p| pairs[p as usize][e]).collect::<Vec<u32>>());
            let padded = loose.len().next_multiple_of(WIDTH);
            loose.resize(padded, pairs.len() as u32);
            ends.iter_mut().for_each(|e| e.resize(padded, 0));
            runs.retain(|r| r.count >= SHORTEST_RUN);
            let width = lists.iter().map(Vec::len).max().unwrap_or(0);
            let packs = nodes.div_ceil(WIDTH);
            let most = |lists: &[Vec<(u32, u32)>]| lists.iter().map(Vec::len).max().unwrap_or(0) as u32;
            let mut table = Pull {
                width,
                widths: lists.chunks(WIDTH).map(most).collect(),
                partner: vec![0; packs * width * WIDTH],
                pair: vec![pairs.len() as u32; packs * width * WIDTH],
                together: Vec::new(),
                loose,
                ends,
            };
            for node in 0..packs * WIDTH {
                for slot in 0..width {
                    let at = (node / WIDTH * width + slot) * WIDTH + node % WIDTH;
                    table.partner[at] = node.min(nodes - 1) as u32;
                    if let Some((partner, pair)) = lists.get(node).and_then(|l| l.get(slot)) {
                        table.partner[at] = *partner;
                        table.pair[at] = *pair;
                    }
                }
            }
            let follow = |list: &[u32]| list.windows(2).all(|two| two[1] == two[0] + 1);
            let packs = table.partner.chunks(WIDTH).zip(table.pair.chunks(WIDTH));
            table.together = packs.map(|(partner, pair)| follow(partner) && follow(pair)).collect();
            pull = Some(table);
        }
        let (tile_runs, tile_start) = runs_by_tile(layout, nodes, &runs);
        PairTable {
            layout,
            runs,
            tile_runs,
            tile_start,
            count: pairs.len() + usize::from(pulled),
            pull,
            pairs: pairs.to_vec(),
        }
    }

    /// The number of pairs that need parameters: all, plus one without effect if some are pulled.
    pub fn parameter_count(&self) -> usize {
        self.count
    }
    /// The pairs themselves.
    pub fn pairs(&self) -> &[[u32; 2]] {
        &self.pairs
    }
    /// Bytes on the heap.
    pub fn heap_bytes(&self) -> usize {
        let pull =
            self.pull.as_ref().map_or(0, |p| 4 * (p.partner.capacity() + p.pair.capacity() + p.widths.capacity()));
        pull + self.runs.capacity() * size_of::<Run>()
            + 4 * (self.tile_runs.capacity() + self.tile_start.capacity())
            + self.pairs.capacity() * 8
    }

    /// The start of the runs of a tile.
    #[inline]
    fn runs_from(&self, tile: usize) -> usize {
        self.tile_start[tile.min(self.tile_start.len() - 1)] as usize
    }
}

/// The runs that touch each tile, one tile after the other, and the start of each list.
fn runs_by_tile(layout: Layout, nodes: usize, runs: &[Run]) -> (Vec<u32>, Vec<u32>) {
    let stride = layout.stride();
    let mut lists = vec![Vec::new(); layout.index_count(nodes).div_ceil(TILE)];
    for (number, run) in runs.iter().enumerate() {
        for end in [run.a, run.b] {
            let (from, until) = (end as usize * stride, (end + run.count) as usize * stride);
            for list in &mut lists[from / TILE..until.div_ceil(TILE)] {
                if list.last() != Some(&(number as u32)) {
                    list.push(number as u32);
                }
            }
        }
    }
    let mut starts = vec![0];
    for list in &lists {
        starts.push(starts[starts.len() - 1] + list.len() as u32);
    }
    (lists.concat(), starts)
}

/// The part of `0..length` for which `from + k` lies in `start..end`.
#[inline(always)]
fn within(from: usize, length: usize, start: usize, end: usize) -> Range<usize> {
    let low = start.saturating_sub(from).min(length);
    let high = end.saturating_sub(from).min(length);
    low..high.max(low)
}

/// The slot for a node of a run, given its `index`. `node` is the index of the first or of the second node of the first pair,
/// and `start` is the first index of the evaluated part of the run.
#[inline(always)]
fn slot_of(index: usize, node: usize, start: usize) -> usize {
    WIDTH + index - node - start
}
