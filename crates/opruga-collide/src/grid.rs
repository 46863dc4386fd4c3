//! Boxes found by a grid with several sizes of cells.

use opruga_math::Lane;

/// Boxes sorted into cells that are at least as large as they are: the smallest cells have the mean extent of the boxes, each level
/// above it twice that. So a box lies in at most 2ᴰ cells, however different the sizes are.
#[derive(Clone, Debug, Default)]
pub(crate) struct Grid<const D: usize> {
    boxes: Vec<[[f64; D]; 2]>,
    levels: Vec<Level>,
    /// The level of every box.
    level_of: Vec<u8>,
    origin: [f64; 3],
}

#[derive(Clone, Debug, Default)]
struct Level {
    /// The extent of a cell [m].
    cell: f64,
    /// Boxes of the buckets, `entries[starts[b]..starts[b + 1]]`; a bucket holds the cells of one hash.
    starts: Vec<u32>,
    entries: Vec<u32>,
    count: usize,
}

/// The most levels: cells of the last one hold whatever is left.
const LEVELS: usize = 24;

impl Level {
    fn bucket<const D: usize>(&self, cell: &[i64; D]) -> usize {
        const PRIMES: [u64; 3] = [73_856_093, 19_349_663, 83_492_791];
        let mut hash = 0u64;
        for (c, prime) in cell.iter().zip(PRIMES) {
            hash ^= (*c as u64).wrapping_mul(prime);
        }
        (hash as usize) & (self.starts.len() - 2)
    }
    fn cell_of<const D: usize>(&self, origin: &[f64; 3], x: &[f64; D]) -> [i64; D] {
        // Rounded towards zero and corrected: rounding down is a call of a function.
        core::array::from_fn(|d| {
            let at = (x[d] - origin[d]) / self.cell;
            let cell = at as i64;
            cell - i64::from(cell as f64 > at)
        })
    }
}

/// Calls back with every cell from one to another.
fn cells_between<const D: usize>(from: [i64; D], to: [i64; D], mut visit: impl FnMut([i64; D])) {
    let mut cell = from;
    loop {
        visit(cell);
        let mut d = 0;
        loop {
            if d == D {
                return;
            }
            if cell[d] < to[d] {
                cell[d] += 1;
                break;
            }
            cell[d] = from[d];
            d += 1;
        }
    }
}

impl<const D: usize> Grid<D> {
    /// Sorts boxes, given by their lowest and highest corners [m], into cells.
    pub(crate) fn fill(&mut self, boxes: impl Iterator<Item = [[f64; D]; 2]>) {
        self.boxes.clear();
        self.boxes.extend(boxes);
        self.level_of.clear();
        self.levels.iter_mut().for_each(|level| level.count = 0);
        let Some(first) = self.boxes.first() else { return };
        let extent = |[low, high]: &[[f64; D]; 2]| (0..D).fold(0.0, |most: f64, d| (high[d] - low[d]).larger(most));
        let (mut sum, mut low) = (0.0, first[0]);
        for one in &self.boxes {
            sum += extent(one);
            for d in 0..D {
                low[d] = one[0][d].smaller(low[d]);
            }
        }
        self.origin = core::array::from_fn(|d| if d < D { low[d] } else { 0.0 });
        let base = (sum / self.boxes.len() as f64).larger(f64::MIN_POSITIVE);
        for one in &self.boxes {
            let (mut level, mut cell, size) = (0, base, extent(one));
            while cell < size && level + 1 < LEVELS {
                (level, cell) = (level + 1, 2.0 * cell);
            }
            if self.levels.len() <= level {
                self.levels.resize(level + 1, Level::default());
            }
            self.levels[level].count += 1;
            self.level_of.push(level as u8);
        }
        let mut cell = base;
        for level in &mut self.levels {
            level.cell = cell;
            cell *= 2.0;
            level.starts.clear();
            level.starts.resize((2 * level.count).next_power_of_two() + 1, 0);
            level.entries.clear();
        }
        // Counted, summed up, and entered from behind, so that a bucket is in the order of the boxes.
        for (number, [low, high]) in self.boxes.iter().enumerate() {
            let level = &mut self.levels[self.level_of[number] as usize];
            let (from, to) = (level.cell_of(&self.origin, low), level.cell_of(&self.origin, high));
            cells_between(from, to, |cell| {
                let bucket = level.bucket(&cell);
                level.starts[bucket] += 1;
            });
        }
        for level in &mut self.levels {
            let mut sum = 0;
            for start in &mut level.starts {
                sum += *start;
                *start = sum;
            }
            level.entries.resize(sum as usize, 0);
        }
        for (number, [low, high]) in self.boxes.iter().enumerate().rev() {
            let level = &mut self.levels[self.level_of[number] as usize];
            let (from, to) = (level.cell_of(&self.origin, low), level.cell_of(&self.origin, high));
            cells_between(from, to, |cell| {
                let bucket = level.bucket(&cell);
                level.starts[bucket] -= 1;
                let entry = level.starts[bucket] as usize;
                level.entries[entry] = number as u32;
            });
        }
    }

    /// Collects the numbers of all boxes that one touches, ascending and each once.
    pub(crate) fn touching(&self, [low, high]: &[[f64; D]; 2], found: &mut Vec<u32>) {
        found.clear();
        let meets = |other: &[[f64; D]; 2]| (0..D).all(|d| other[0][d] <= high[d] && low[d] <= other[1][d]);
        for level in self.levels.iter().filter(|level| level.count > 0) {
            let (from, to) = (level.cell_of(&self.origin, low), level.cell_of(&self.origin, high));
            let mut cells = 1.0;
            for d in 0..D {
                cells *= (to[d] - from[d]) as f64 + 1.0;
            }
            // A box over more cells than there are boxes.
            if cells > level.entries.len() as f64 {
                let number = self.levels.iter().position(|other| core::ptr::eq(other, level)).unwrap_or(0);
                let all = (0..self.boxes.len() as u32).filter(|k| self.level_of[*k as usize] as usize == number);
                found.extend(all.filter(|k| meets(&self.boxes[*k as usize])));
                continue;
            }
            cells_between(from, to, |cell| {
                let bucket = level.bucket(&cell);
                let entries = &level.entries[level.starts[bucket] as usize..level.starts[bucket + 1] as usize];
                found.extend(entries.iter().copied().filter(|k| meets(&self.boxes[*k as usize])));
            });
        }
        found.sort_unstable();
        found.dedup();
    }

    /// Bytes on the heap.
    pub(crate) fn heap_bytes(&self) -> usize {
        let levels: usize = self.levels.iter().map(|l| 4 * (l.starts.capacity() + l.entries.capacity())).sum();
        16 * D * self.boxes.capacity() + self.level_of.capacity() + levels
    }
}
