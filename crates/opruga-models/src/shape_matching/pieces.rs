//! Overlapping clusters, evaluated node by node instead of slot by slot.
//!
//! Nodes that are in the same clusters form a *piece* (Rivers and James 2007 sum over regions in the same way). A cluster needs
//! only the moments Σ m u and Σ m u ⊗ Q of a piece, and a node needs only the sum of the affine maps of its clusters:
//!
//! ```text
//! nodes ──moments──▶ pieces ──sums──▶ clusters: R, T ──maps t + H Q──▶ pieces, summed ──▶ nodes
//! ```
//!
//! A node is therefore read and written once, however many clusters it is in. For all clusters, u = x − x₀ and Q = X − X₀ are
//! relative to one node in the middle of the body, so that the clusters can share the sums. Taking positions relative to this
//! node loses digits. The rounding error grows with the square of the size of the body divided by the size of its smallest
//! cluster. Beyond [`MOST_DIGITS_LOST`] the clusters are evaluated slot by slot.

use super::layout::Clusters;
use opruga_core::potential::Ingredients;
use opruga_core::state::Layout;
use opruga_math::{Column, WIDTH};
use std::collections::BTreeMap;

/// The numbers of an affine map of one coordinate: a constant and up to three slopes.
pub(super) const MAP: usize = opruga_math::ROW;

/// The largest allowed (size of the body / size of the cluster)². With this value, forces keep twelve digits, as the tests of
/// forces require.
const MOST_DIGITS_LOST: f64 = 1e4;

/// The pieces of one body, or of eight identical ones.
#[derive(Debug)]
pub(super) struct Pieces<const D: usize> {
    /// The node to which u and Q are relative.
    pub(super) origin: usize,
    /// The nodes of each piece, one piece after the other, and the start of each.
    pub(super) nodes: Vec<u32>,
    pub(super) start: Vec<u32>,
    /// One over the number of clusters that contain a piece.
    pub(super) share: Vec<f64>,
    /// For one body: the first row of the piece of each node, in rows of [`MAP`] numbers. The list is filled up to whole packs.
    pub(super) row_of: Vec<u32>,
    /// The piece of each node.
    pub(super) piece_of: Vec<u32>,
    /// The clusters of each piece, and the start of each list.
    pub(super) clusters: Vec<u32>,
    pub(super) clusters_start: Vec<u32>,
    /// The pieces of each cluster, and the start of each list.
    pub(super) pieces: Vec<u32>,
    pub(super) pieces_start: Vec<u32>,
    /// m [kg] of every node.
    pub(super) mass: Column,
    /// Q [m] of every node of a body.
    pub(super) offset: [Column; D],
    /// For one body: m (1, Q) of every node times the share, twice, in the order of `nodes`.
    pub(super) weights: Column,
    /// For every cluster: C with φₖ = Σ Cₖⱼ (Qⱼ − Q̄ⱼ), `[k · D + j]`, and Q̄ [m].
    pub(super) inverse: Vec<Column>,
    pub(super) center: [Column; D],
}

/// C with φ = C q, from the lower triangular L of q = L φ. The row of an omitted column is zero.
fn inverse<const D: usize>(frame: &[[f64; D]; D]) -> [[f64; D]; D] {
    let mut out = [[0.0; D]; D];
    for k in 0..D {
        if frame[k][k] <= 0.0 {
            continue;
        }
        out[k][k] = 1.0;
        for l in 0..k {
            let above = out[l];
            for j in 0..D {
                out[k][j] -= frame[k][l] * above[j];
            }
        }
        out[k].iter_mut().for_each(|x| *x /= frame[k][k]);
    }
    out
}

impl<const D: usize> Pieces<D> {
    /// Makes the pieces of overlapping clusters with a linear fit. Returns `None` if too many digits would be lost.
    pub(super) fn new(ingredients: &Ingredients<D>, clusters: &Clusters<D>) -> Option<Pieces<D>> {
        let (layout, mesh) = (ingredients.layout, ingredients.mesh);
        if clusters.is_whole || clusters.columns > D {
            return None;
        }
        let count = clusters.nodes;
        let origin = middle(&mesh.positions);
        let offset_of =
            |node: usize| -> [f64; D] { core::array::from_fn(|d| mesh.positions[node][d] - mesh.positions[origin][d]) };
        let reach = (0..count).map(|node| offset_of(node).iter().map(|q| q * q).sum::<f64>()).fold(0.0, larger);
        let mut smallest = f64::INFINITY;
        for at in (0..clusters.len()).map(|cluster| layout.index(cluster, 0)) {
            for k in 0..D {
                let own = clusters.frame[k * D + k][at];
                let square = own * own * clusters.inverse_mass[at];
                smallest = if own > 0.0 && square < smallest { square } else { smallest };
            }
        }
        if reach > MOST_DIGITS_LOST * smallest {
            return None;
        }

        // Nodes with the same clusters; pieces are ordered by their first node.
        let mut cluster_of = vec![0; clusters.slots()];
        for cluster in 0..clusters.len() {
            cluster_of[clusters.range(cluster)].fill(cluster as u32);
        }
        let mut known = BTreeMap::new();
        let mut members: Vec<Vec<u32>> = Vec::new();
        let mut piece_of = vec![0u32; count];
        let (mut of_piece, mut clusters_start) = (Vec::new(), vec![0]);
        let mut of_cluster = vec![Vec::new(); clusters.len()];
        for node in 0..count {
            let slots = clusters.slots_start[node] as usize..clusters.slots_start[node + 1] as usize;
            let own: Vec<u32> = clusters.slots_of[slots].iter().map(|slot| cluster_of[*slot as usize]).collect();
            let piece = *known.entry(own.clone()).or_insert_with(|| {
                own.iter().for_each(|cluster| of_cluster[*cluster as usize].push(members.len() as u32));
                of_piece.extend_from_slice(&own);
                clusters_start.push(of_piece.len() as u32);
                members.push(Vec::new());
                members.len() - 1
            });
            members[piece].push(node as u32);
            piece_of[node] = piece as u32;
        }
        let starts = |lists: &[Vec<u32>]| {
            let mut out = vec![0u32];
            lists.iter().for_each(|list| out.push(out[out.len() - 1] + list.len() as u32));
            out
        };
        let share: Vec<f64> = clusters_start.windows(2).map(|two| 1.0 / f64::from(two[1] - two[0])).collect();
        let rows = Self::row(Layout::Single) / MAP;
        let mut row_of: Vec<u32> = piece_of.iter().map(|piece| piece * rows as u32).collect();
        row_of.resize(count.next_multiple_of(WIDTH), 0);

        let padded = layout.index_count(count);
        let mut out = Pieces {
            origin,
            nodes: members.concat(),
            start: starts(&members),
            share,
            row_of,
            piece_of,
            clusters: of_piece,
            clusters_start,
            pieces: of_cluster.concat(),
            pieces_start: starts(&of_cluster),
            mass: Column::zeros(padded + WIDTH),
            offset: core::array::from_fn(|_| Column::zeros(count + WIDTH)),
            weights: Column::zeros(if layout == Layout::Single { count * WIDTH } else { 0 }),
            inverse: (0..D * D).map(|_| Column::zeros(layout.index_count(clusters.len()) + WIDTH)).collect(),
            center: core::array::from_fn(|_| Column::zeros(layout.index_count(clusters.len()) + WIDTH)),
        };
        for node in 0..count {
            let own = offset_of(node);
            for d in 0..D {
                out.offset[d][node] = own[d];
            }
            for body in 0..layout.stride() {
                let at = layout.index(node, body);
                out.mass[at] = ingredients.mass.at(at);
            }
        }
        if layout == Layout::Single {
            for (k, node) in out.nodes.iter().enumerate() {
                let node = *node as usize;
                let mass = out.mass[node] * out.share[out.piece_of[node] as usize];
                for half in 0..WIDTH / MAP {
                    out.weights[k * WIDTH + half * MAP] = mass;
                    for d in 0..D {
                        out.weights[k * WIDTH + half * MAP + 1 + d] = mass * out.offset[d][node];
                    }
                }
            }
        }
        out.lay_out_clusters(clusters);
        Some(out)
    }

    /// C and Q̄ of every cluster.
    fn lay_out_clusters(&mut self, clusters: &Clusters<D>) {
        let layout = clusters.layout;
        for cluster in 0..clusters.len() {
            let first = clusters.range(cluster).start;
            for body in 0..layout.stride() {
                let at = layout.index(cluster, body);
                let mut frame = [[0.0; D]; D];
                let mut center = [0.0; D];
                for d in 0..D {
                    for k in 0..D {
                        frame[d][k] = clusters.frame[d * D + k][at];
                    }
                    for slot in first..first + clusters.count[cluster] as usize {
                        let node = clusters.indices[slot] as usize / layout.stride();
                        center[d] += clusters.mass[layout.index(slot, body)] * self.offset[d][node];
                    }
                    self.center[d][at] = center[d] * clusters.inverse_mass[at];
                }
                let inverse = inverse(&frame);
                for k in 0..D {
                    for j in 0..D {
                        self.inverse[k * D + j][at] = inverse[k][j];
                    }
                }
            }
        }
    }

    /// The number of pieces.
    pub(super) fn len(&self) -> usize {
        self.share.len()
    }
    /// The length of a row of a piece or a cluster in the scratch: one map for each coordinate, two maps in a pack.
    pub(super) fn row(layout: Layout) -> usize {
        match layout {
            Layout::Single => WIDTH * (D - 1),
            Layout::Batch => WIDTH * MAP * D,
        }
    }
    /// The nodes of a piece, as a range of `nodes`.
    #[inline(always)]
    pub(super) fn members(&self, piece: usize) -> core::ops::Range<usize> {
        self.start[piece] as usize..self.start[piece + 1] as usize
    }
    /// The clusters of a piece.
    #[inline(always)]
    pub(super) fn clusters_of(&self, piece: usize) -> &[u32] {
        &self.clusters[self.clusters_start[piece] as usize..self.clusters_start[piece + 1] as usize]
    }
    /// The pieces of a cluster.
    #[inline(always)]
    pub(super) fn pieces_of(&self, cluster: usize) -> &[u32] {
        &self.pieces[self.pieces_start[cluster] as usize..self.pieces_start[cluster + 1] as usize]
    }
    pub(super) fn heap_bytes(&self) -> usize {
        let columns = self.inverse.iter().chain(&self.center).chain(&self.offset);
        let lists = [&self.nodes, &self.start, &self.row_of, &self.piece_of, &self.clusters, &self.clusters_start];
        let lists = lists.into_iter().chain([&self.pieces, &self.pieces_start]).map(|list| 4 * list.capacity());
        columns.map(Column::heap_bytes).sum::<usize>()
            + lists.sum::<usize>()
            + self.mass.heap_bytes()
            + self.weights.heap_bytes()
            + 8 * self.share.capacity()
    }
}

fn larger(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

/// The node that is closest to the centre of the bounding box.
fn middle<const D: usize>(positions: &[[f64; D]]) -> usize {
    let (mut low, mut high) = (positions[0], positions[0]);
    for x in positions {
        for d in 0..D {
            low[d] = if x[d] < low[d] { x[d] } else { low[d] };
            high[d] = if x[d] > high[d] { x[d] } else { high[d] };
        }
    }
    let mut best = (0, f64::INFINITY);
    for (node, x) in positions.iter().enumerate() {
        let off: f64 = (0..D).map(|d| x[d] - (low[d] + 0.5 * (high[d] - low[d]))).map(|q| q * q).sum();
        if off < best.1 {
            best = (node, off);
        }
    }
    best.0
}
