//! Stress and volume ratio of the cells of a solid.

use super::Elastic;
use super::grid::{HEXAHEDRON, QUADRILATERAL};
use opruga_core::potential::CellState;
use opruga_core::state::View;
use opruga_math::Lane;
use opruga_math::matrix::determinant;

/// The cells of a solid, with their spacings along the axes [m].
#[derive(Debug)]
pub(super) struct Cells<const D: usize> {
    /// The corners, four or eight per cell.
    nodes: Vec<u32>,
    spacings: Vec<[f64; D]>,
    /// The depth out of the plane [m]. It is 1 in space.
    depth: f64,
}

impl<const D: usize> Cells<D> {
    pub(super) fn new<const N: usize>(cells: &[[u32; N]], spacings: Vec<[f64; D]>, depth: f64) -> Cells<D> {
        Cells { nodes: cells.iter().flatten().copied().collect(), spacings, depth }
    }
    pub(super) fn heap_bytes(&self) -> usize {
        4 * self.nodes.capacity() + 8 * D * self.spacings.capacity()
    }
    /// The states of the cells of one body.
    pub(super) fn states(&self, view: &View<D>, body: usize, elastic: &Elastic) -> Vec<CellState> {
        let corners = 1 << D;
        let cells = self.nodes.chunks_exact(corners).zip(&self.spacings).enumerate();
        let state = |(cell, (nodes, spacing)): (usize, (&[u32], &[f64; D]))| {
            let x = |corner: usize| -> [f64; D] {
                let index = view.layout.index(nodes[corner] as usize, body);
                core::array::from_fn(|d| view.x[d][index])
            };
            let at: Vec<[f64; D]> = (0..corners).map(x).collect();
            self.state(cell as u32, &at, spacing, elastic)
        };
        cells.map(state).collect()
    }
    fn state(&self, cell: u32, at: &[[f64; D]], spacing: &[f64; D], elastic: &Elastic) -> CellState {
        // Whether a corner is at the far end of its edge along an axis, and the corner at the other end of that edge.
        let stepped = |corner: usize, axis: usize| match D {
            2 => QUADRILATERAL.1[corner][axis] == 1,
            _ => HEXAHEDRON.1[corner][axis] == 1,
        };
        let across = |corner: usize, axis: usize| {
            let wanted = |other: &usize| (0..D).all(|d| stepped(*other, d) == (stepped(corner, d) != (d == axis)));
            (0..at.len()).find(wanted).unwrap_or(corner)
        };
        // Row k: the edge from a corner along axis k, divided by its length at rest.
        let edges = |corner: usize| -> [[f64; D]; D] {
            core::array::from_fn(|axis| {
                let (other, sign) = (across(corner, axis), if stepped(corner, axis) { -1.0 } else { 1.0 });
                core::array::from_fn(|d| sign * (at[other][d] - at[corner][d]) / spacing[axis])
            })
        };
        let mut mean = [[0.0; D]; D];
        let mut least = f64::INFINITY;
        for corner in 0..at.len() {
            let own = edges(corner);
            least = Lane::smaller(least, determinant(&own));
            for (row, own) in mean.iter_mut().zip(&own) {
                for d in 0..D {
                    row[d] += own[d] / at.len() as f64;
                }
            }
        }
        let ratio = determinant(&mean);
        // S = λ tr ε 1 + 2μ ε in the axes of the grid, σ = F S Fᵀ/J.
        let [_, lambda, four_mu] = elastic.solid();
        let product = |a: &[f64; D], b: &[f64; D]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let strain = |i: usize, j: usize| 0.5 * (product(&mean[i], &mean[j]) - if i == j { 1.0 } else { 0.0 });
        let trace: f64 = (0..D).map(|i| strain(i, i)).sum();
        let stress = |i: usize, j: usize| 0.5 * four_mu * strain(i, j) + if i == j { lambda * trace } else { 0.0 };
        // In plane stress the depth changes. In plane strain it does not, and there is an out-of-plane stress.
        let poisson = elastic.poissons_ratio;
        let deepened = 1.0 - 2.0 * poisson / (1.0 - poisson) * trace;
        let (deep, across) = match (D, elastic.plane_stress) {
            (2, true) => (if deepened > 0.0 { deepened.sqrt() } else { 0.0 }, 0.0),
            (2, false) => (1.0, lambda * trace),
            _ => (1.0, 0.0),
        };
        let volume_ratio = ratio * deep;
        let mut sigma = [[0.0; 3]; 3];
        for a in 0..D {
            for b in 0..D {
                for i in 0..D {
                    for j in 0..D {
                        sigma[a][b] += mean[i][a] * stress(i, j) * mean[j][b] / volume_ratio;
                    }
                }
            }
        }
        if D == 2 {
            sigma[2][2] = across / volume_ratio;
        }
        let measure = spacing.iter().product::<f64>() * self.depth;
        CellState { cell, stress: sigma, volume_ratio, smallest_volume_ratio: least * deep, measure }
    }
}
