//! Tiles: the columns are processed in pieces that fit into the first-level cache.

use crate::state::Parameter;
use core::ops::Range;
use opruga_math::{Column, Pack, Simd, StripMut, WIDTH, Work, lanes};

/// The number of indices of a tile.
pub const TILE: usize = 512;

/// The forces on the nodes of one tile, to which models add.
#[derive(Debug)]
pub struct Tile<'a, const D: usize> {
    /// The indices of the tile; both ends are multiples of eight.
    pub range: Range<usize>,
    /// Force [N]: `force[d][p - range.start]` belongs to index p.
    pub force: [&'a mut [f64]; D],
    /// Power that the model dissipates (damping) or gives to the bodies (loads) [W], eight partial sums.
    pub power: &'a mut [f64; WIDTH],
    /// The weight m g with which the forces begin, if it has not been written yet. Only the first model receives it, and only if
    /// it sets [`crate::potential::Properties::begins_tiles`]; it then has to call [`Tile::settle`] or do the same itself.
    pub weight: Option<Weight<'a, D>>,
    /// A buffer for the forces of stencils before they are summed at the nodes.
    pub slots: &'a mut Column,
}

/// Mass of each node and the acceleration of gravity.
#[derive(Clone, Copy, Debug)]
pub struct Weight<'a, const D: usize> {
    /// Mass [kg].
    pub mass: &'a Parameter,
    /// Acceleration [m/s²].
    pub gravity: [f64; D],
}

impl<const D: usize> Tile<'_, D> {
    /// Begins the forces with the weight, unless that has been done.
    #[inline]
    pub fn settle(&mut self, simd: Simd) {
        if self.weight.is_some() {
            simd.run(Settle { tile: self });
        }
    }
    /// Does the same as [`Tile::settle`], within code for one set of instructions.
    #[inline(always)]
    pub fn settle_by<P: Pack>(&mut self) {
        let Some(weight) = self.weight.take() else { return };
        let length = self.range.len();
        let mass = weight.mass.strip(self.range.start, length);
        let gravity: [P; D] = lanes!(P, d => P::splat(weight.gravity[d]));
        let mut force = StripMut::<D>::new(self.force.each_mut().map(|f| &mut **f), 0, length);
        for k in (0..length).step_by(WIDTH) {
            let m: P = mass.load(k);
            for d in 0..D {
                force.store(d, k, m * gravity[d]);
            }
        }
    }
}

struct Settle<'a, 'b, const D: usize> {
    tile: &'a mut Tile<'b, D>,
}
impl<const D: usize> Work for Settle<'_, '_, D> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        self.tile.settle_by::<P>();
    }
}

/// The order in which tiles are evaluated and moved.
///
/// The forces of a tile read positions of its neighbours. A tile may move only when the forces of every tile that reads it have been computed. In a
/// chain of nodes, a tile can move after the forces of the next tile are known, so its forces stay in the cache. In a mesh whose neighbouring nodes
/// have distant numbers, a tile moves later, and more buffers are needed.
#[derive(Clone, Debug, PartialEq)]
pub struct TilePlan {
    tiles: Vec<Range<usize>>,
    buffer: Vec<u32>,
    /// For every tile, the tiles that may move once its forces are known, in order.
    release: Vec<u32>,
    release_start: Vec<u32>,
    buffers: usize,
}

impl TilePlan {
    /// The plan for `index_count` indices, given every pair (first, last) of indices that a stencil spans.
    pub fn new(index_count: usize, spans: impl Iterator<Item = (usize, usize)>) -> TilePlan {
        let count = index_count.div_ceil(TILE);
        let tiles: Vec<_> = (0..count).map(|t| t * TILE..((t + 1) * TILE).min(index_count)).collect();
        // The last tile whose forces read a tile.
        let mut last_reader: Vec<usize> = (0..count).collect();
        for (first, last) in spans {
            let (low, high) = (first.min(last) / TILE, first.max(last) / TILE);
            last_reader[low] = last_reader[low].max(high);
        }
        let mut release_start = vec![0u32];
        let mut release = Vec::with_capacity(count);
        let mut buffer = vec![0u32; count];
        let mut free: Vec<u32> = Vec::new();
        let mut buffers = 0;
        let mut by_reader: Vec<Vec<u32>> = vec![Vec::new(); count];
        for (tile, reader) in last_reader.iter().enumerate() {
            by_reader[*reader].push(tile as u32);
        }
        for (tile, released) in by_reader.iter().enumerate() {
            buffer[tile] = free.pop().unwrap_or_else(|| {
                buffers += 1;
                buffers as u32 - 1
            });
            for &done in released {
                release.push(done);
                free.push(buffer[done as usize]);
            }
            release_start.push(release.len() as u32);
        }
        TilePlan { tiles, buffer, release, release_start, buffers }
    }
    /// The number of tiles.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.tiles.len()
    }
    /// Whether there is no tile.
    pub fn is_empty(&self) -> bool {
        self.tiles.is_empty()
    }
    /// The indices of a tile.
    #[inline(always)]
    pub fn range(&self, tile: usize) -> Range<usize> {
        self.tiles[tile].clone()
    }
    /// The index of the buffer with the forces of a tile.
    #[inline(always)]
    pub fn buffer(&self, tile: usize) -> usize {
        self.buffer[tile] as usize * TILE
    }
    /// The tiles that may move once the forces of this one are known.
    #[inline(always)]
    pub fn released_after(&self, tile: usize) -> &[u32] {
        &self.release[self.release_start[tile] as usize..self.release_start[tile + 1] as usize]
    }
    /// The number of indices of all buffers together.
    pub fn buffer_length(&self) -> usize {
        self.buffers * TILE
    }
}
