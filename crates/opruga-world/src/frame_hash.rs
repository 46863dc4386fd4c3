//! A hash of all positions and velocities that is quick enough for every frame.

use crate::world::World;
use opruga_core::state::Layout;
use opruga_core::system::System;
use opruga_math::WIDTH;

/// An odd factor: the golden ratio in 64 bits.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// Hashes one number into a lane. It can be undone, so a number that differs alone is never missed; the rotation brings the
/// upper bits back to where a product spreads them.
#[inline(always)]
fn mix(lane: u64, number: f64) -> u64 {
    (lane ^ number.to_bits()).wrapping_mul(GOLDEN).rotate_left(29)
}

/// Hashes a hash into another.
fn join(hash: u64, other: u64) -> u64 {
    let hash = (hash ^ other).wrapping_mul(GOLDEN);
    hash ^ hash >> 32
}

/// Where the lanes of a body begin: each at another number.
const START: [u64; WIDTH] = {
    let mut start = [0; WIDTH];
    let mut lane = 0;
    while lane < WIDTH {
        start[lane] = (lane as u64 + 1).wrapping_mul(GOLDEN);
        lane += 1;
    }
    start
};

/// The hashes of the bodies of a system, which lie in the lanes of a batch or alone in the first. Node i of a body goes to its
/// lane i modulo eight, coordinate by coordinate, positions first, whichever the layout.
fn of_bodies<const D: usize>(system: &System<D>) -> [u64; WIDTH] {
    let columns = [&system.state.x, &system.state.v].into_iter().flat_map(|columns| columns.slices());
    match system.layout {
        Layout::Single => {
            let mut lanes = START;
            for column in columns {
                let (packs, rest) = column[..system.nodes].as_chunks::<WIDTH>();
                for pack in packs {
                    for (lane, number) in lanes.iter_mut().zip(pack) {
                        *lane = mix(*lane, *number);
                    }
                }
                lanes.iter_mut().zip(rest).for_each(|(lane, number)| *lane = mix(*lane, *number));
            }
            let mut out = [0; WIDTH];
            out[0] = lanes.into_iter().fold(system.nodes as u64, join);
            out
        }
        Layout::Batch => {
            // A row for each lane, in it a hash for each body.
            let mut lanes = START.map(|start| [start; WIDTH]);
            for column in columns {
                let (packs, _) = column[..system.nodes * WIDTH].as_chunks::<WIDTH>();
                for eight in packs.chunks(WIDTH) {
                    for (row, pack) in lanes.iter_mut().zip(eight) {
                        for (lane, number) in row.iter_mut().zip(pack) {
                            *lane = mix(*lane, *number);
                        }
                    }
                }
            }
            let mut out = [system.nodes as u64; WIDTH];
            for (body, hash) in out.iter_mut().enumerate() {
                *hash = lanes.iter().fold(*hash, |hash, row| join(hash, row[body]));
            }
            out
        }
    }
}

impl<const D: usize> World<D> {
    pub(crate) fn frame_hash_here(&self) -> u64 {
        let of_islands: Vec<[u64; WIDTH]> = self.islands.iter().map(|island| of_bodies(&island.system)).collect();
        let there = (0..self.alive.len()).filter(|body| self.alive[*body]);
        there.fold(0, |hash, body| {
            let (island, lane) = self.place[body];
            join(hash, of_islands[island][lane])
        })
    }
}
