//! Rank-one terms, as delivered.

use crate::blocks::nodes_mut;

/// The rank-one term c·u uᵀ.
#[derive(Clone, Debug, Default)]
pub(crate) struct RankOne<const D: usize> {
    pub(crate) factor: f64,
    pub(crate) entries: Vec<(u32, [f64; D])>,
}

impl<const D: usize> RankOne<D> {
    pub(crate) fn along(&self, x: &[[f64; D]]) -> f64 {
        let mut sums = [0.0; opruga_math::WIDTH];
        for (k, (node, u)) in self.entries.iter().enumerate() {
            for d in 0..D {
                sums[k % opruga_math::WIDTH] += u[d] * x[*node as usize][d];
            }
        }
        opruga_math::sum_in_fixed_order(&sums)
    }
    /// u as a long vector.
    pub(crate) fn write(&self, out: &mut [f64]) {
        out.fill(0.0);
        for (node, u) in &self.entries {
            nodes_mut::<D>(out)[*node as usize] = *u;
        }
    }
}
