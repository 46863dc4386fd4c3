//! Anderson mixing: uses previous iterations to estimate the effect of terms that the matrix of an iteration omits.
//!
//! The matrix omits derivatives that are not symmetric or belong to no model: the derivatives of damping with respect to
//! position, of friction with respect to the normal force, and of curved obstacles. Without these derivatives, corrections only
//! fall by a constant factor in each iteration. An iteration is a map z → z + f(z) of the displacements and the forces of the
//! constraints. The next state follows from the combination of the last few pairs (z, f) with the smallest |f|:
//!
//! z' = z + f − Σ γⱼ (Δzⱼ + Δfⱼ),  γ = argmin |f − Σ γⱼ Δfⱼ|.
//!
//! On a linear problem, Anderson mixing is the generalised minimal residual method (GMRES).
//!
//! Source: Anderson 1965; Walker and Ni, *Anderson acceleration for fixed-point iterations*, SIAM J. Numer. Anal. 49 (2011).

use opruga_solve::dot;

/// The largest number of pairs that are remembered.
const MOST: usize = 8;

/// A difference adds no information if its component orthogonal to the others is below this fraction of its size.
const NOTHING_NEW: f64 = 1e-6;

/// The recorded iterations, between which nothing but the state has changed.
#[derive(Debug, Default)]
pub(crate) struct Mixing {
    /// The previous state and its change. Both are empty if there is no previous state.
    state: Vec<f64>,
    change: Vec<f64>,
    /// Differences of changes and of states + changes, oldest first.
    changes: Vec<Vec<f64>>,
    displacements: Vec<Vec<f64>>,
    known: usize,
    /// The same differences after orthogonalisation, and the remainder of a change.
    across: Vec<Vec<f64>>,
    combined: Vec<Vec<f64>>,
    rest: Vec<f64>,
}

impl Mixing {
    /// Restarts, with memory for states of up to `most` numbers.
    pub(crate) fn begin(&mut self, most: usize) {
        self.forget();
        for list in [&mut self.changes, &mut self.displacements, &mut self.across, &mut self.combined] {
            list.resize_with(MOST, Vec::new);
            list.iter_mut().for_each(|vector| reserve(vector, most));
        }
        for vector in [&mut self.state, &mut self.change, &mut self.rest] {
            reserve(vector, most);
        }
    }

    /// Discards what has been recorded.
    pub(crate) fn forget(&mut self) {
        self.known = 0;
        self.state.clear();
    }

    /// Whether there is nothing to mix with.
    pub(crate) fn is_empty(&self) -> bool {
        self.known == 0
    }

    /// Records a state and its change in an iteration.
    pub(crate) fn note(&mut self, state: &[f64], change: &[f64]) {
        if self.state.len() == state.len() {
            if self.known == MOST {
                self.changes.rotate_left(1);
                self.displacements.rotate_left(1);
                self.known -= 1;
            }
            let (changes, displacements) = (&mut self.changes[self.known], &mut self.displacements[self.known]);
            changes.clear();
            displacements.clear();
            for k in 0..state.len() {
                let of_change = change[k] - self.change[k];
                changes.push(of_change);
                displacements.push(state[k] - self.state[k] + of_change);
            }
            self.known += 1;
        }
        refill(&mut self.state, state);
        refill(&mut self.change, change);
    }

    /// Removes from a change that was just recorded the part that previous iterations make unnecessary.
    pub(crate) fn mix(&mut self, change: &mut [f64]) {
        let Mixing { changes, displacements, known, across, combined, rest, .. } = self;
        refill(rest, change);
        // Orthogonal differences of changes, newest first, and the same combinations of displacements.
        let mut found = 0;
        for k in (0..*known).rev() {
            let (before, others) = across.split_at_mut(found);
            let (displacements_before, other_displacements) = combined.split_at_mut(found);
            let (own, displacement) = (&mut others[0], &mut other_displacements[0]);
            refill(own, &changes[k]);
            refill(displacement, &displacements[k]);
            let whole = dot(own, own);
            for (other, its_displacement) in before.iter().zip(&*displacements_before) {
                let part = dot(own, other);
                subtract(own, part, other);
                subtract(displacement, part, its_displacement);
            }
            let left = dot(own, own);
            if left.is_nan() || left <= NOTHING_NEW * NOTHING_NEW * whole {
                continue;
            }
            let size = left.sqrt();
            own.iter_mut().for_each(|x| *x /= size);
            displacement.iter_mut().for_each(|x| *x /= size);
            let part = dot(rest, own);
            subtract(rest, part, own);
            subtract(change, part, displacement);
            found += 1;
        }
    }
}

fn reserve(vector: &mut Vec<f64>, most: usize) {
    vector.reserve(most.saturating_sub(vector.len()));
}

fn refill(own: &mut Vec<f64>, from: &[f64]) {
    own.clear();
    own.extend_from_slice(from);
}

fn subtract(from: &mut [f64], factor: f64, vector: &[f64]) {
    for (x, y) in from.iter_mut().zip(vector) {
        *x -= factor * y;
    }
}

#[cfg(test)]
mod tests {
    use super::Mixing;

    /// z → z + f(z) with f = b − A z for a matrix that is not symmetric and far from the identity: plain iteration diverges.
    #[test]
    fn a_linear_map_of_four_numbers_is_at_rest_after_five_iterations() {
        let matrix = [[1.9, 0.7, 0.0, 0.1], [-0.6, 1.3, 0.4, 0.0], [0.0, -0.9, 0.8, 0.3], [0.2, 0.0, -0.5, 2.3]];
        let wanted = [1.0, -2.0, 0.5, 3.0];
        let mut z = [0.0; 4];
        let mut mixing = Mixing::default();
        mixing.begin(4);
        for _ in 0..6 {
            let mut f: Vec<f64> =
                matrix.iter().map(|row| (0..4).map(|k| row[k] * (wanted[k] - z[k])).sum::<f64>()).collect();
            mixing.note(&z, &f);
            mixing.mix(&mut f);
            for k in 0..4 {
                z[k] += f[k];
            }
        }
        for k in 0..4 {
            assert!((z[k] - wanted[k]).abs() < 1e-9, "{z:?}");
        }
    }
}
