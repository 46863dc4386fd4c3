//! Moments of pieces, their sums in clusters, and sums of the clusters' maps, for every set of vector instructions. The symbols
//! are those of the file `pieces`.
//!
//! For one body the data of a piece or a cluster are rows, `[coordinate][1, Q₁, Q₂, Q₃]`, with two coordinates in a pack, so
//! that sums do not gather numbers from several places. For eight bodies every number is a pack. One body and eight bodies add
//! their numbers in the same order.

use super::kernels::{Law, Stored};
use super::layout::Clusters;
use super::pieces::{MAP, Pieces};
use opruga_core::state::{Layout, View, load};
use opruga_core::tile::Tile;
use opruga_math::{Lane, Pack, Register, WIDTH, Work, lanes};

/// The largest number of registers that a row of one body needs: sixteen numbers, two in each register.
const REGISTERS: usize = 8;

/// The number of registers that hold the D maps of a row. Later registers are not read.
const fn registers<P: Pack, const D: usize>() -> usize {
    (MAP * D).div_ceil(P::Part::NUMBERS)
}

/// The index of the number (coordinate, column) of row `row` for eight bodies.
#[inline(always)]
fn at<const D: usize>(row: usize, d: usize, c: usize) -> usize {
    row * WIDTH * MAP * D + (d * MAP + c) * WIDTH
}

/// Sums the rows at even positions of a list and the rows at odd positions separately, and then adds both sums, so that no
/// addition waits for the previous one.
#[inline(always)]
fn sum_rows<P: Pack, const D: usize>(rows: &[f64], list: &[u32]) -> [P::Part; REGISTERS] {
    let length = WIDTH * (D - 1);
    let mut sums = [[P::Part::zero(); REGISTERS]; 2];
    let mut pairs = list.chunks_exact(2);
    for two in &mut pairs {
        for s in 0..2 {
            let row = &rows[two[s] as usize * length..][..length];
            for r in 0..registers::<P, D>() {
                sums[s][r] += P::Part::load(&row[r * P::Part::NUMBERS..]);
            }
        }
    }
    if let [last] = pairs.remainder() {
        let row = &rows[*last as usize * length..][..length];
        for r in 0..registers::<P, D>() {
            sums[0][r] += P::Part::load(&row[r * P::Part::NUMBERS..]);
        }
    }
    let mut out = [P::Part::zero(); REGISTERS];
    for r in 0..registers::<P, D>() {
        out[r] = sums[0][r] + sums[1][r];
    }
    out
}
/// Computes one number of the same sum for eight bodies.
#[inline(always)]
fn sum_number<P: Pack, const D: usize>(rows: &[f64], list: &[u32], d: usize, c: usize) -> P {
    let mut sums = [P::zero(); 2];
    for (k, row) in list.iter().enumerate() {
        sums[k % 2] += P::load(&rows[at::<D>(*row as usize, d, c)..]);
    }
    sums[0] + sums[1]
}

/// Computes the moments of all pieces and their sums in all clusters. Computes x̄ − x₀ and cₖ = Σ m p φₖ from these sums.
pub(super) struct PieceMoments<'a, const D: usize> {
    pub(super) clusters: &'a Clusters<D>,
    pub(super) pieces: &'a Pieces<D>,
    pub(super) stored: Stored,
    pub(super) view: &'a View<'a, D>,
    pub(super) scratch: &'a mut [f64],
}
impl<const D: usize> Work for PieceMoments<'_, D> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let PieceMoments { clusters, pieces, stored, view, scratch } = self;
        let (numbers, rows) = scratch.split_at_mut(stored.forces);
        match clusters.layout {
            Layout::Single => {
                of_pieces::<P, D>(pieces, view, rows);
                for cluster in 0..clusters.len() {
                    let sum = sum_rows::<P, D>(rows, pieces.pieces_of(cluster));
                    let mut own = [0.0; 2 * WIDTH];
                    for r in 0..registers::<P, D>() {
                        sum[r].store(&mut own[r * P::Part::NUMBERS..]);
                    }
                    for d in 0..D {
                        numbers[d * stored.stride + cluster] = own[d * MAP];
                        for j in 0..D {
                            numbers[(stored.moments + d * D + j) * stored.stride + cluster] = own[d * MAP + 1 + j];
                        }
                    }
                }
            }
            Layout::Batch => {
                of_pieces_side_by_side::<P, D>(pieces, view, rows);
                for cluster in 0..clusters.len() {
                    let (list, index) = (pieces.pieces_of(cluster), cluster * WIDTH);
                    for d in 0..D {
                        sum_number::<P, D>(rows, list, d, 0).store(&mut numbers[d * stored.stride + index..]);
                        for j in 0..D {
                            let to = (stored.moments + d * D + j) * stored.stride + index;
                            sum_number::<P, D>(rows, list, d, 1 + j).store(&mut numbers[to..]);
                        }
                    }
                }
            }
        }
        for index in (0..stored.stride).step_by(WIDTH) {
            let center: [P; D] = lanes!(P, j => P::load(&pieces.center[j][index..]));
            let inverse_mass = P::load(&clusters.inverse_mass[index..]);
            for d in 0..D {
                let first = P::load(&numbers[d * stored.stride + index..]);
                // Σ m u (Q − Q̄), and the columns from it.
                let second: [P; D] = lanes!(P, j => {
                    P::load(&numbers[(stored.moments + d * D + j) * stored.stride + index..]) - first * center[j]
                });
                (first * inverse_mass).store(&mut numbers[d * stored.stride + index..]);
                for k in 0..D {
                    let mut moment = P::zero();
                    // C is lower triangular.
                    for j in 0..=k {
                        moment += P::load(&pieces.inverse[k * D + j][index..]) * second[j];
                    }
                    moment.store(&mut numbers[(stored.moments + d * D + k) * stored.stride + index..]);
                }
            }
        }
    }
}

/// Σ w m u (1, Q) of the nodes of every piece.
#[inline(always)]
fn of_pieces<P: Pack, const D: usize>(pieces: &Pieces<D>, view: &View<D>, rows: &mut [f64]) {
    let from: [f64; D] = core::array::from_fn(|d| view.x[d][pieces.origin]);
    let low = P::Part::first(MAP);
    for piece in 0..pieces.len() {
        let mut sum = [P::Part::zero(); REGISTERS];
        for k in pieces.members(piece) {
            let node = pieces.nodes[k] as usize;
            let weights = &pieces.weights[k * WIDTH..][..WIDTH];
            let mut u = [0.0; 4];
            for d in 0..D {
                u[d] = view.x[d][node] - from[d];
            }
            for r in 0..registers::<P, D>() {
                let first = r * P::Part::NUMBERS;
                let weight = P::Part::load(&weights[first % WIDTH..]);
                // A wide register holds the maps of two coordinates; in space the second register holds only one.
                let one = P::Part::splat(u[first / MAP]);
                let value = if P::Part::NUMBERS > MAP {
                    P::Part::select(low, one, P::Part::splat(u[first / MAP + 1]))
                } else {
                    one
                };
                sum[r] += weight * value;
            }
        }
        for r in 0..registers::<P, D>() {
            sum[r].store(&mut rows[piece * WIDTH * (D - 1) + r * P::Part::NUMBERS..]);
        }
    }
}
#[inline(always)]
fn of_pieces_side_by_side<P: Pack, const D: usize>(pieces: &Pieces<D>, view: &View<D>, rows: &mut [f64]) {
    let from: [P; D] = load(&view.x, pieces.origin * WIDTH);
    for piece in 0..pieces.len() {
        let share = P::splat(pieces.share[piece]);
        let mut sum = [[P::zero(); MAP]; D];
        for k in pieces.members(piece) {
            let node = pieces.nodes[k] as usize;
            let x: [P; D] = load(&view.x, node * WIDTH);
            let mass = P::load(&pieces.mass[node * WIDTH..]) * share;
            for d in 0..D {
                let u = x[d] - from[d];
                sum[d][0] += mass * u;
                for j in 0..D {
                    sum[d][1 + j] += mass * P::splat(pieces.offset[j][node]) * u;
                }
            }
        }
        for d in 0..D {
            for c in 0..=D {
                sum[d][c].store(&mut rows[at::<D>(piece, d, c)..]);
            }
        }
    }
}

/// Computes the maps of all clusters, t + H Q with H = G C. For every piece, sums the maps of its clusters and multiplies the
/// sum by the share of the piece. Finally computes x̄.
pub(super) struct PieceMaps<'a, const D: usize> {
    pub(super) clusters: &'a Clusters<D>,
    pub(super) pieces: &'a Pieces<D>,
    pub(super) stored: Stored,
    pub(super) view: &'a View<'a, D>,
    pub(super) scratch: &'a mut [f64],
}
impl<const D: usize> Work for PieceMaps<'_, D> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let PieceMaps { clusters, pieces, stored, view, scratch } = self;
        let layout = clusters.layout;
        let (numbers, rows) = scratch.split_at_mut(stored.forces);
        let (of_pieces, of_clusters) = rows.split_at_mut(pieces.len() * Pieces::<D>::row(layout));
        for index in (0..stored.stride).step_by(WIDTH) {
            let center: [P; D] = lanes!(P, j => P::load(&pieces.center[j][index..]));
            for d in 0..D {
                let mut goal = [P::zero(); D];
                for k in 0..D {
                    goal[k] = P::load(&numbers[(stored.goal + d * D + k) * stored.stride + index..]);
                }
                let mut map = [P::zero(); MAP];
                map[0] = P::load(&numbers[d * stored.stride + index..]);
                for j in 0..D {
                    let mut slope = P::zero();
                    for k in j..D {
                        slope += goal[k] * P::load(&pieces.inverse[k * D + j][index..]);
                    }
                    map[0] -= slope * center[j];
                    map[1 + j] = slope;
                }
                // x̄ itself, which the energy needs.
                let from = match layout {
                    Layout::Single => P::splat(view.x[d][pieces.origin]),
                    Layout::Batch => P::load(&view.x[d][pieces.origin * WIDTH..]),
                };
                let mean = P::load(&numbers[d * stored.stride + index..]);
                (from + mean).store(&mut numbers[d * stored.stride + index..]);
                for c in 0..=D {
                    match layout {
                        Layout::Single => {
                            let each = map[c].to_array();
                            for l in 0..WIDTH.min(clusters.len().saturating_sub(index)) {
                                of_clusters[(index + l) * WIDTH * (D - 1) + d * MAP + c] = each[l];
                            }
                        }
                        Layout::Batch => map[c].store(&mut of_clusters[at::<D>(index / WIDTH, d, c)..]),
                    }
                }
            }
        }
        for piece in 0..pieces.len() {
            let (list, share) = (pieces.clusters_of(piece), P::splat(pieces.share[piece]));
            match layout {
                Layout::Single => {
                    let sum = sum_rows::<P, D>(of_clusters, list);
                    let share = P::Part::splat(pieces.share[piece]);
                    for r in 0..registers::<P, D>() {
                        (sum[r] * share).store(&mut of_pieces[piece * WIDTH * (D - 1) + r * P::Part::NUMBERS..]);
                    }
                }
                Layout::Batch => {
                    for d in 0..D {
                        for c in 0..=D {
                            let sum = sum_number::<P, D>(of_clusters, list, d, c);
                            (sum * share).store(&mut of_pieces[at::<D>(piece, d, c)..]);
                        }
                    }
                }
            }
        }
    }
}

/// Adds κ m (t + H Q − u) to the nodes of a tile. Each node uses the map of its piece.
pub(super) struct PieceForces<'a, 'b, 'c, const D: usize> {
    pub(super) pieces: &'a Pieces<D>,
    pub(super) law: &'a Law,
    pub(super) view: &'a View<'a, D>,
    /// The rows of the pieces.
    pub(super) rows: &'a [f64],
    pub(super) tile: &'b mut Tile<'c, D>,
    /// Whether the power of the forces is requested.
    pub(super) works: bool,
}
impl<const D: usize> Work for PieceForces<'_, '_, '_, D> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let PieceForces { pieces, law, view, rows, tile, works } = self;
        tile.settle_by::<P>();
        let layout = view.layout;
        let stiffness = law.stiffness.load::<P>(0);
        let from: [P; D] = match layout {
            Layout::Single => lanes!(P, d => P::splat(view.x[d][pieces.origin])),
            Layout::Batch => load(&view.x, pieces.origin * WIDTH),
        };
        let start = tile.range.start;
        let mut power = P::from_array(*tile.power);
        for index in tile.range.clone().step_by(WIDTH) {
            let strength = stiffness * P::load(&pieces.mass[index..]);
            let node = index / layout.stride();
            let offset: [P; D] = match layout {
                Layout::Single => lanes!(P, j => P::load(&pieces.offset[j][index..])),
                Layout::Batch => lanes!(P, j => P::splat(pieces.offset[j][node])),
            };
            let x: [P; D] = load(&view.x, index);
            for d in 0..D {
                let mut map = [P::zero(); MAP];
                match layout {
                    Layout::Single => {
                        for part in 0..P::PARTS {
                            let own = &pieces.row_of[index + part * P::Part::NUMBERS..];
                            let read = P::Part::gather_rows(&rows[d * MAP..], own);
                            for c in 0..=D {
                                map[c].set_part(part, read[c]);
                            }
                        }
                    }
                    Layout::Batch => {
                        let piece = pieces.piece_of[node] as usize;
                        for c in 0..=D {
                            map[c] = P::load(&rows[at::<D>(piece, d, c)..]);
                        }
                    }
                }
                let mut goal = map[0];
                for j in 0..D {
                    goal += map[1 + j] * offset[j];
                }
                let force = strength * (goal - (x[d] - from[d]));
                let k = index - start;
                (P::load(&tile.force[d][k..]) + force).store(&mut tile.force[d][k..]);
                if works {
                    power += force * P::load(&view.v[d][index..]);
                }
            }
        }
        power.store(tile.power);
    }
}
