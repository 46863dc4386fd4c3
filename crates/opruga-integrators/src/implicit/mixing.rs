//! What the matrix of an iteration leaves out, seen from the iterations before: Anderson's mixing.
//!
//! The derivatives of damping by position, of friction by the normal force and of curved obstacles are not symmetric, or of
//! no model; without them corrections fall by a steady factor. An iteration is a map z → z + f(z) of the displacements and
//! the forces of the constraints. Of the last few pairs (z, f), the combination with the least |f| leads on:
//!
//! z' = z + f − Σ γⱼ (Δzⱼ + Δfⱼ),  γ = argmin |f − Σ γⱼ Δfⱼ|.
//!
//! On a linear problem that is the method of generalised minimal residuals.
//!
//! Source: Anderson 1965; Walker and Ni, *Anderson acceleration for fixed-point iterations*, SIAM J. Numer. Anal. 49 (2011).

use opruga_solve::dot;

/// Pairs that are remembered at most.
const MOST: usize = 8;

/// Differences whose part across the others is below this part of them say nothing new.
const NOTHING_NEW: f64 = 1e-6;

/// The iterations that have been made since anything else changed.
#[derive(Debug, Default)]
pub(crate) struct Mixing {
    /// The last state and its change; empty where there is none.
    state: Vec<f64>,
    change: Vec<f64>,
    /// Differences of changes and of states + changes, the oldest first.
    changes: Vec<Vec<f64>>,
    ways: Vec<Vec<f64>>,
    known: usize,
}

impl Mixing {
    /// Begins anew.
    pub(crate) fn forget(&mut self) {
        self.known = 0;
        self.state.clear();
    }

    /// Whether there is anything to mix with.
    pub(crate) fn is_empty(&self) -> bool {
        self.known == 0
    }

    /// Notes a state and the change that an iteration makes of it.
    pub(crate) fn note(&mut self, state: &[f64], change: &[f64]) {
        if self.state.len() == state.len() && self.known < MOST {
            if self.changes.len() == self.known {
                self.changes.push(Vec::new());
                self.ways.push(Vec::new());
            }
            let (changes, ways) = (&mut self.changes[self.known], &mut self.ways[self.known]);
            changes.clear();
            ways.clear();
            for k in 0..state.len() {
                let of_change = change[k] - self.change[k];
                changes.push(of_change);
                ways.push(state[k] - self.state[k] + of_change);
            }
            self.known += 1;
        } else if self.state.len() == state.len() {
            self.changes.rotate_left(1);
            self.ways.rotate_left(1);
            self.known -= 1;
            return self.note(state, change);
        }
        self.state.clear();
        self.state.extend_from_slice(state);
        self.change.clear();
        self.change.extend_from_slice(change);
    }

    /// Takes what the iterations before make superfluous out of a change that has been noted.
    pub(crate) fn mix(&self, change: &mut [f64]) {
        // Orthogonal differences of changes, the newest first, and the same combinations of ways.
        let mut basis: Vec<(Vec<f64>, Vec<f64>)> = Vec::with_capacity(self.known);
        let mut rest = change.to_vec();
        for k in (0..self.known).rev() {
            let (mut across, mut way) = (self.changes[k].clone(), self.ways[k].clone());
            let whole = dot(&across, &across);
            for (other, its_way) in &basis {
                let part = dot(&across, other);
                subtract(&mut across, part, other);
                subtract(&mut way, part, its_way);
            }
            let left = dot(&across, &across);
            if left.is_nan() || left <= NOTHING_NEW * NOTHING_NEW * whole {
                continue;
            }
            let size = left.sqrt();
            across.iter_mut().for_each(|x| *x /= size);
            way.iter_mut().for_each(|x| *x /= size);
            let part = dot(&rest, &across);
            subtract(&mut rest, part, &across);
            subtract(change, part, &way);
            basis.push((across, way));
        }
    }
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
