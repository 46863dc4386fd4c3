//! A hash of all positions and velocities that is fast enough for every frame: it costs less than a substep, even in scenes with few substeps.

use crate::world::World;
use opruga_core::state::Layout;
use opruga_core::system::System;
use opruga_math::{Pack, WIDTH, Work};

/// An odd factor: the golden ratio in 64 bits.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// The initial values of the sums of the lanes, which all differ.
const START: [u64; WIDTH] = {
    let mut start = [0; WIDTH];
    let mut lane = 0;
    while lane < WIDTH {
        start[lane] = (lane as u64 + 1).wrapping_mul(GOLDEN);
        lane += 1;
    }
    start
};

/// Combines two hashes.
#[inline(always)]
fn join(hash: u64, other: u64) -> u64 {
    let hash = (hash ^ other).wrapping_mul(GOLDEN);
    hash ^ hash >> 32
}

/// Eight sums of the bits of numbers, and eight sums of these sums, which depend on the order (Fletcher). These sums need only additions of 64 bits,
/// which every set of vector instructions has.
///
/// The upper half of a number is combined with its lower half, so that different numbers have terms that differ by less than 2³². Two changed numbers
/// in one lane therefore never cancel. If their terms add up to zero, the sums of sums differ by one term times the distance, which is not a multiple
/// of 2⁶⁴. More than two changes cancel only by chance.
struct Sums {
    first: [u64; WIDTH],
    second: [u64; WIDTH],
}

impl Sums {
    #[inline(always)]
    fn add(&mut self, pack: &[f64; WIDTH]) {
        for lane in 0..WIDTH {
            let bits = pack[lane].to_bits();
            self.first[lane] = self.first[lane].wrapping_add(bits ^ bits >> 32);
            self.second[lane] = self.second[lane].wrapping_add(self.first[lane]);
        }
    }

    /// One hash for each lane.
    #[inline(always)]
    fn hashes(&self) -> [u64; WIDTH] {
        let mut out = [0; WIDTH];
        for lane in 0..WIDTH {
            out[lane] = join(join(0, self.first[lane]), self.second[lane]);
        }
        out
    }
}

/// The hashes of the bodies of a system, which are in the lanes of a batch, or alone in the first lane. In either layout, each body has eight pairs
/// of sums, and its node i is added to pair i modulo eight, coordinate by coordinate, positions first.
struct OfBodies<'a, const D: usize>(&'a System<D>);

impl<const D: usize> Work for OfBodies<'_, D> {
    type Output = [u64; WIDTH];
    #[inline(always)]
    fn run<P: Pack>(self) -> [u64; WIDTH] {
        let system = self.0;
        let (positions, velocities) = (system.state.x.slices(), system.state.v.slices());
        match system.layout {
            Layout::Single => {
                let mut sums = Sums { first: START, second: [0; WIDTH] };
                for columns in [&positions, &velocities] {
                    for column in columns {
                        let (packs, rest) = column[..system.nodes].as_chunks::<WIDTH>();
                        for pack in packs {
                            sums.add(pack);
                        }
                        if !rest.is_empty() {
                            let mut last = [0.0; WIDTH];
                            last[..rest.len()].copy_from_slice(rest);
                            sums.add(&last);
                        }
                    }
                }
                let mut out = [0; WIDTH];
                out[0] = system.nodes as u64;
                for hash in sums.hashes() {
                    out[0] = join(out[0], hash);
                }
                out
            }
            Layout::Batch => {
                let mut out = [system.nodes as u64; WIDTH];
                // This is done row by row, because the sums of all rows would not fit into registers.
                for row in 0..WIDTH {
                    let mut sums = Sums { first: [START[row]; WIDTH], second: [0; WIDTH] };
                    for columns in [&positions, &velocities] {
                        for column in columns {
                            let (packs, _) = column[..system.nodes * WIDTH].as_chunks::<WIDTH>();
                            let mut node = row;
                            while node < system.nodes {
                                sums.add(&packs[node]);
                                node += WIDTH;
                            }
                            // Include the padding after the last node, as for a single body.
                            if node < system.nodes.next_multiple_of(WIDTH) {
                                sums.add(&[0.0; WIDTH]);
                            }
                        }
                    }
                    let hashes = sums.hashes();
                    for body in 0..WIDTH {
                        out[body] = join(out[body], hashes[body]);
                    }
                }
                out
            }
        }
    }
}

impl<const D: usize> World<D> {
    /// A 64-bit hash of all positions and velocities, coordinate by coordinate of every body, eight numbers at a time. The hash is so fast that every
    /// frame of a recording has one.
    pub fn frame_hash(&self) -> u64 {
        let hash = |system: &System<D>| system.simd.run(OfBodies(system));
        let of_islands: Vec<[u64; WIDTH]> = self.islands.iter().map(|island| hash(&island.system)).collect();
        self.bodies().fold(0, |hash, body| {
            let (island, lane) = self.locations[body];
            join(hash, of_islands[island][lane])
        })
    }
}
