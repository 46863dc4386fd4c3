//! Search for boxes in a grid with several sizes of cells.

use opruga_math::Lane;

/// Boxes that are sorted into cells of several sizes. The smallest cells have the mean extent of the boxes, and each further level has cells twice as
/// large. A box is in a cell that contains its lowest corner and is at least as large as the box. A box therefore extends at most into the next cell
/// along every axis, however different the sizes of boxes are, and no box is found twice.
#[derive(Clone, Debug, Default)]
pub(crate) struct Grid<const D: usize> {
    boxes: Vec<[[f64; D]; 2]>,
    levels: Vec<Level<D>>,
    /// The level of every box.
    level_of: Vec<u8>,
    origin: [f64; 3],
    /// The number of queries since the boxes were sorted.
    queries: u32,
}

#[derive(Clone, Debug, Default)]
struct Level<const D: usize> {
    /// One over the extent of a cell [1/m].
    per_metre: f64,
    /// For every bucket, the start of its boxes in `entries`, and the last query that has examined the bucket. A bucket holds
    /// the boxes of all cells with the same hash.
    buckets: Vec<[u32; 2]>,
    /// Boxes with their numbers, one bucket after the other.
    entries: Vec<([[f64; D]; 2], u32)>,
    count: usize,
}

/// The last cell along an axis, which contains everything beyond it. The indices of cells are exact up to this cell and would overflow beyond it
/// (`boxes_far_beyond_all_others_are_found`).
const FARTHEST: f64 = 1e15;

/// The largest number of levels; the last one contains all larger boxes.
const LEVELS: usize = 24;

impl<const D: usize> Level<D> {
    fn bucket(&self, cell: &[i64; D]) -> usize {
        const PRIMES: [u64; 3] = [73_856_093, 19_349_663, 83_492_791];
        let mut hash = 0u64;
        for (c, prime) in cell.iter().zip(PRIMES) {
            hash ^= (*c as u64).wrapping_mul(prime);
        }
        (hash as usize) & (self.buckets.len() - 2)
    }
    fn cell_of(&self, origin: &[f64; 3], x: &[f64; D]) -> [i64; D] {
        // Rounded towards zero and corrected, because rounding down is a function call.
        core::array::from_fn(|d| {
            let at = ((x[d] - origin[d]) * self.per_metre).larger(-FARTHEST).smaller(FARTHEST);
            let cell = at as i64;
            cell - i64::from(cell as f64 > at)
        })
    }
}

/// Calls `visit` with every cell from one to another.
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
    /// Sorts boxes into cells. A box is given by its lowest and its highest corner [m].
    pub(crate) fn fill(&mut self, boxes: impl Iterator<Item = [[f64; D]; 2]>) {
        self.boxes.clear();
        self.boxes.extend(boxes);
        self.level_of.clear();
        self.queries = 0;
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
            // Rounded so that no box is larger than its cell.
            level.per_metre = (1.0 - 1e-9) / cell;
            cell *= 2.0;
            level.buckets.clear();
            level.buckets.resize((2 * level.count).next_power_of_two() + 1, [0; 2]);
            level.entries.clear();
        }
        // Counting sort from the back, so that a bucket is in the order of the boxes.
        for (number, [low, _]) in self.boxes.iter().enumerate() {
            let level = &mut self.levels[self.level_of[number] as usize];
            let bucket = level.bucket(&level.cell_of(&self.origin, low));
            level.buckets[bucket][0] += 1;
        }
        for level in &mut self.levels {
            let mut sum = 0;
            for [start, _] in &mut level.buckets {
                sum += *start;
                *start = sum;
            }
            level.entries.resize(sum as usize, ([[0.0; D]; 2], 0));
        }
        for (number, one) in self.boxes.iter().enumerate().rev() {
            let level = &mut self.levels[self.level_of[number] as usize];
            let bucket = level.bucket(&level.cell_of(&self.origin, &one[0]));
            level.buckets[bucket][0] -= 1;
            let entry = level.buckets[bucket][0] as usize;
            level.entries[entry] = (*one, number as u32);
        }
    }

    /// Collects the numbers of all boxes that touch a box, each once, in an order that depends only on the boxes.
    pub(crate) fn touching(&mut self, [low, high]: &[[f64; D]; 2], found: &mut Vec<u32>) {
        found.clear();
        let meets = |other: &[[f64; D]; 2]| {
            let mut meets = true;
            for d in 0..D {
                meets &= (other[0][d] <= high[d]) & (low[d] <= other[1][d]);
            }
            meets
        };
        self.queries += 1;
        for level in self.levels.iter_mut().filter(|level| level.count > 0) {
            let (mut from, to) = (level.cell_of(&self.origin, low), level.cell_of(&self.origin, high));
            let mut cells = 1.0;
            for d in 0..D {
                from[d] -= 1;
                cells *= (to[d] - from[d]) as f64 + 1.0;
            }
            // If a box covers more cells than there are boxes, all boxes are examined.
            if cells > level.entries.len() as f64 {
                found.extend(level.entries.iter().filter(|(other, _)| meets(other)).map(|(_, number)| *number));
                continue;
            }
            cells_between(from, to, |cell| {
                let bucket = level.bucket(&cell);
                // Several cells may share a bucket.
                let [begin, looked] = level.buckets[bucket];
                if looked == self.queries {
                    return;
                }
                level.buckets[bucket][1] = self.queries;
                let entries = &level.entries[begin as usize..level.buckets[bucket + 1][0] as usize];
                found.extend(entries.iter().filter(|(other, _)| meets(other)).map(|(_, number)| *number));
            });
        }
    }

    /// Bytes on the heap.
    pub(crate) fn heap_bytes(&self) -> usize {
        let of = |level: &Level<D>| 8 * level.buckets.capacity() + (16 * D + 8) * level.entries.capacity();
        let levels: usize = self.levels.iter().map(of).sum();
        16 * D * self.boxes.capacity() + self.level_of.capacity() + levels
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_far_beyond_all_others_are_found() {
        let mut grid = Grid::<2>::default();
        let at = |x: f64| [[x, 0.0], [x + 1.0, 1.0]];
        let boxes = [at(-1e200), at(-1e30), at(0.0), at(1.5), at(1e30), at(1e200)];
        grid.fill(boxes.into_iter());
        let mut found = Vec::new();
        for (number, one) in boxes.iter().enumerate() {
            grid.touching(one, &mut found);
            assert_eq!(found, [number as u32]);
        }
    }
}
