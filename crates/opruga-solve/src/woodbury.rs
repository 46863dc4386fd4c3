//! Rank-one terms next to a factored matrix.

use crate::rank_one::RankOne;
use crate::{Indefinite, dense, dot};

/// Adds rank-one terms to a solution: (S + U C Uᵀ)⁻¹ b = S⁻¹ b − S⁻¹ U (C⁻¹ + Uᵀ S⁻¹ U)⁻¹ Uᵀ S⁻¹ b (Woodbury 1950).
#[derive(Debug, Default)]
pub(crate) struct Woodbury {
    /// The u of each term, and S⁻¹ u.
    directions: Vec<Vec<f64>>,
    solved: Vec<Vec<f64>>,
    /// The inverse of C⁻¹ + Uᵀ S⁻¹ U, row by row.
    core: Vec<f64>,
}

impl Woodbury {
    /// Takes the rank-one terms of a matrix of `size` rows whose S is factored. `right` is an additional right-hand side, to
    /// which S⁻¹ is applied as well.
    pub(crate) fn update<'a, const D: usize>(
        &mut self,
        size: usize,
        parts: impl Iterator<Item = &'a RankOne<D>>,
        positive: bool,
        right: Option<&mut [f64]>,
        solve: impl Fn(&mut dyn Iterator<Item = &mut [f64]>),
    ) -> Result<(), Indefinite> {
        let parts: Vec<_> = parts.filter(|part| part.factor != 0.0).collect();
        let n = parts.len();
        self.directions.resize(n, Vec::new());
        self.solved.resize(n, Vec::new());
        for (k, part) in parts.iter().enumerate() {
            self.directions[k].resize(size, 0.0);
            part.write(&mut self.directions[k]);
            self.solved[k].clone_from(&self.directions[k]);
        }
        solve(&mut self.solved.iter_mut().map(Vec::as_mut_slice).chain(right));
        let mut core = vec![0.0; n * n];
        for i in 0..n {
            for j in 0..n {
                let own = if i == j { 1.0 / parts[i].factor } else { 0.0 };
                core[i * n + j] = own + dot(&self.directions[i], &self.solved[j]);
            }
        }
        // If S is positive definite and all entries of C are positive, so is the sum. Otherwise this depends on the signs of
        // the eigenvalues of this small matrix.
        if positive && !dense::has_positive(&core, n, parts.iter().filter(|part| part.factor > 0.0).count()) {
            return Err(Indefinite);
        }
        self.core = dense::inverse(&core, n).ok_or(Indefinite)?;
        Ok(())
    }
    /// Turns S⁻¹ b into the solution.
    pub(crate) fn correct(&self, x: &mut [f64]) {
        let n = self.directions.len();
        let along: Vec<f64> = self.directions.iter().map(|u| dot(u, x)).collect();
        for i in 0..n {
            let weight: f64 = (0..n).map(|j| self.core[i * n + j] * along[j]).sum();
            for (x, s) in x.iter_mut().zip(&self.solved[i]) {
                *x -= weight * s;
            }
        }
    }
}
