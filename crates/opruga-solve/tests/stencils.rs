//! Matrices of stencils that are delivered eight at a time have the same result as their blocks one by one.

use opruga_core::potential::{Sink, StencilPack};
use opruga_math::WIDTH;
use opruga_solve::BlockMatrix;

const NODES: usize = 23;

fn random(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// Packs of stencils with `n` nodes in D dimensions; the last one is not full.
struct Packs {
    n: usize,
    indices: Vec<Vec<u32>>,
    blocks: Vec<Vec<f64>>,
    counts: Vec<usize>,
}

impl Packs {
    fn new<const D: usize>(n: usize, packs: usize) -> Packs {
        let mut seed = n as u64;
        let mut out = Packs { n, indices: Vec::new(), blocks: Vec::new(), counts: Vec::new() };
        for pack in 0..packs {
            let first: Vec<usize> = (0..WIDTH).map(|l| (7 * pack + 3 * l) % NODES).collect();
            // The nodes of a stencil differ, because 23 is prime.
            out.indices.push((0..n * WIDTH).map(|k| ((first[k % WIDTH] + 5 * (k / WIDTH)) % NODES) as u32).collect());
            let mut blocks = vec![f64::NAN; n * n * D * D * WIDTH];
            for a in 0..n {
                for b in a..n {
                    for i in 0..D {
                        for j in 0..D {
                            for l in 0..WIDTH {
                                let at = |i: usize, j: usize| (((a * n + b) * D + i) * D + j) * WIDTH + l;
                                blocks[at(i, j)] = if a == b && j < i { blocks[at(j, i)] } else { random(&mut seed) };
                            }
                        }
                    }
                }
            }
            out.blocks.push(blocks);
            out.counts.push(if pack + 1 == packs { 3 } else { WIDTH });
        }
        out
    }
    fn deliver<const D: usize>(&self, whole: bool, order: &[usize], sink: &mut BlockMatrix<D>) {
        for &k in order {
            let pack = StencilPack {
                nodes: self.n,
                count: self.counts[k],
                indices: &self.indices[k],
                blocks: &self.blocks[k],
            };
            if whole {
                sink.stencils(&pack);
            } else {
                for lane in 0..pack.count {
                    for a in 0..self.n {
                        for b in 0..self.n {
                            sink.block(pack.index(a, lane), pack.index(b, lane), pack.block(a, b, lane));
                        }
                    }
                }
            }
            // Other blocks are delivered in between.
            let mut unit = [[0.0; D]; D];
            unit[0][0] = 1.0;
            sink.block(k, k, unit);
            sink.scale(if k % 2 == 0 { 0.5 } else { 1.0 });
        }
    }
}

/// The products with all unit vectors, as bits.
fn bits<const D: usize>(matrix: &BlockMatrix<D>) -> Vec<u64> {
    let mut out = Vec::new();
    for k in 0..D * NODES {
        let (mut x, mut y) = (vec![0.0; D * NODES], vec![0.0; D * NODES]);
        x[k] = 1.0;
        matrix.multiply(&x, &mut y);
        out.extend(y.iter().map(|y| y.to_bits()));
    }
    out
}

fn check<const D: usize>(n: usize) {
    let packs = Packs::new::<D>(n, 4);
    let orders: [&[usize]; 4] = [&[0, 1, 2, 3], &[0, 1, 2, 3], &[2, 0, 1, 3], &[0, 3]];
    let mut together = BlockMatrix::<D>::default();
    for (round, order) in orders.into_iter().enumerate() {
        let mut apart = BlockMatrix::<D>::default();
        apart.assemble(NODES, 0, |sink| packs.deliver(false, order, sink));
        together.assemble(NODES, 0, |sink| packs.deliver(true, order, sink));
        assert_eq!(bits(&together), bits(&apart), "{n} nodes, {D} dimensions, round {round}: {order:?}");
    }
}

#[test]
fn stencils_of_every_size_land_as_their_blocks_do_first_replayed_reordered_and_left_out() {
    for n in [2, 3, 4, 5, 6, 8, 10] {
        check::<2>(n);
        check::<3>(n);
    }
}
