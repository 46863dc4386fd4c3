//! The interface of integrators: an integrator advances a system by one substep, and describes its own stability.

use crate::error::{BuildError, StepError};
use crate::history::{Channel, History};
use crate::memory::Counts;
use crate::open_step::OpenStep;
use crate::potential::{Reading, Views};
use crate::spec::{Spec, Values};
use crate::system::System;
use core::fmt::Debug;
use core::sync::atomic::{AtomicU64, Ordering};
use opruga_math::Lane;

/// A method that moves a system from time t to t + h.
pub trait Integrator<const D: usize>: Send + Sync + Debug {
    /// The name of the integrator.
    fn name(&self) -> &'static str;
    /// The quantities that every model must provide for it. The world checks for these quantities when it is built.
    fn needs(&self) -> Views {
        Views::default()
    }
    /// The number of pairs of columns (x, v) that it uses within a step.
    fn work_columns(&self) -> usize {
        0
    }
    /// The data that it keeps from step to step in addition to x and v. These data are part of the state.
    fn history(&self) -> Vec<Channel> {
        Vec::new()
    }
    /// The matrix that takes (x, v), followed by the vectors of its history, to the next step for the damped oscillator x″ = −ω²x
    /// − c x′.
    ///
    /// The spectral radius of the matrix is at most 1 if the step h is stable. The state is scaled as (x, v), not (ωx, v).
    fn amplification(&self, omega: f64, c: f64, h: f64) -> Amplification;
    /// Refuses a system that it cannot step, such as a free body in statics; `obstacles` is true if there are obstacles that
    /// may hold the body.
    ///
    /// # Errors
    /// [`BuildError`] with the reason.
    fn check(&self, _system: &System<D>, _obstacles: bool) -> Result<(), BuildError> {
        Ok(())
    }
    /// Names and values of readings, such as the applied fraction of the load.
    fn readings(&self, _system: &System<D>) -> Vec<Reading> {
        Vec::new()
    }
    /// The applied fraction of the loads, if the integrator applies them gradually.
    fn part_of_load(&self, _system: &System<D>) -> Option<f64> {
        None
    }
    /// Whether it gives the same bits on processors of all classes, rather than only within one class.
    fn same_bits_everywhere(&self, _system: &System<D>) -> bool {
        true
    }
    /// Whether every step ends in an equilibrium, which may be far from the start of the step and does not depend on
    /// velocities.
    fn is_static(&self) -> bool {
        false
    }
    /// Whether it records its own dissipation in [`crate::system::Work8::numerical`], from its own formula. Dissipation that is
    /// not recorded there remains unexplained energy.
    fn measures_its_damping(&self) -> bool {
        false
    }
    /// Whether it is one of the integrators that leave the least energy unexplained when bodies meet obstacles.
    fn makes_least_of_contact(&self) -> bool {
        false
    }
    /// Whether it changes velocities by h F₀/m alone, with the force F₀ at the start of the step. If a point then moves by h v₁, its energy changes in a
    /// step by ½h (F₀·v₀ − F₁·v₁), up to terms of higher order. These changes cancel in the sum over steps.
    fn kicks_by_first_force(&self) -> bool {
        false
    }
    /// Whether its steps distribute the work on one system over [`System::threads`].
    fn shares_threads(&self) -> bool {
        false
    }
    /// Whether it supports a mass matrix that couples nodes ([`System::inertia`]).
    fn takes_mass_matrix(&self) -> bool {
        false
    }
    /// The memory that it needs in addition to the state [bytes], for one body whose models couple this many pairs of nodes.
    fn memory(&self, counts: &Counts, _couplings: f64) -> f64 {
        16.0 * D as f64 * counts.nodes * self.work_columns() as f64
    }
    /// Makes one substep of h [s].
    ///
    /// # Errors
    /// [`StepError`] if a model refuses.
    fn step(&self, system: &mut System<D>, h: f64) -> Result<(), StepError>;
    /// Whether its steps have a fixed budget, and leave a part of the residual to later steps.
    fn has_budget(&self) -> bool {
        false
    }
    /// Whether the forces of other bodies act within the step ([`System::pushes`]), so that contact is part of the balance that
    /// it solves. Otherwise contact changes velocities after the step.
    fn takes_pushes(&self) -> bool {
        false
    }
    /// Computes, after a step, how the end of this step responds to forces of other bodies, for [`Integrator::answer`]. Returns
    /// the number of the matrix that it uses: the same number means the same responses. `None` if it cannot compute the
    /// responses.
    ///
    /// # Errors
    /// [`StepError`] if a model refuses.
    fn prepare_answer(&self, _system: &mut System<D>) -> Result<Option<u64>, StepError> {
        Ok(None)
    }
    /// Replaces forces on the nodes, which act throughout the step [N], by the displacements that they cause at the end of the
    /// step, to first order [m]. `_vectors` holds `_count` consecutive vectors, each with the coordinates of one node after the
    /// other. Returns whether this was possible.
    fn answer(&self, _system: &mut System<D>, _vectors: &mut [f64], _count: usize) -> bool {
        false
    }
    /// Begins a substep of h [s] whose end is found together with the ends of other bodies; `None` if the integrator does not
    /// solve for its end.
    ///
    /// # Errors
    /// [`StepError`] if a model refuses the start.
    fn open(&self, _system: &mut System<D>, _h: f64) -> Option<Result<Box<dyn OpenStep<D>>, StepError>> {
        None
    }
}

impl<const D: usize> System<D> {
    /// Lays out tiles, buffers and the history for an integrator; a history that the same integrator has declared is kept.
    pub fn equip(&mut self, integrator: &dyn Integrator<D>) {
        self.plan(integrator.work_columns());
        let channels = integrator.history();
        if !self.history.is_of(integrator.name(), &channels) {
            self.history = History::new(integrator.name(), &channels, self.index_count());
        }
    }
}

/// Returns a number that no matrix has had before in this process, for [`Integrator::prepare_answer`].
pub fn next_matrix_number() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(0);
    NEXT.fetch_add(1, Ordering::Relaxed)
}

/// A kind of integrator that scenes can name.
pub trait IntegratorKind<const D: usize>: Send + Sync {
    /// The parameters and the documentation of the kind.
    fn spec(&self) -> &'static Spec;
    /// Whether it steps eight identical bodies side by side; otherwise it steps every body separately.
    fn batches(&self) -> bool {
        true
    }
    /// Builds the integrator.
    ///
    /// # Errors
    /// [`BuildError`] if a combination of parameters has no meaning.
    fn build(&self, values: &Values) -> Result<Box<dyn Integrator<D>>, BuildError>;
}

/// The largest number of values per degree of freedom that an integrator carries from step to step.
pub const MOST_CARRIED: usize = 4;

/// The effect of one step on x, v and the memory of an integrator, for a linear oscillator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Amplification {
    size: usize,
    rows: [[f64; MOST_CARRIED]; MOST_CARRIED],
}

impl Amplification {
    /// Makes an amplification matrix from its rows.
    pub fn new<const N: usize>(matrix: [[f64; N]; N]) -> Amplification {
        const { assert!(N >= 2 && N <= MOST_CARRIED, "x and v, and room for what is remembered") }
        let mut rows = [[0.0; MOST_CARRIED]; MOST_CARRIED];
        for i in 0..N {
            rows[i][..N].copy_from_slice(&matrix[i]);
        }
        Amplification { size: N, rows }
    }
    /// The number of values that are carried from step to step: x, v and the history.
    pub fn size(&self) -> usize {
        self.size
    }
    /// The largest absolute eigenvalue.
    pub fn spectral_radius(&self) -> f64 {
        let (m, mut size, mut apart) = (&self.rows, self.size, 0.0);
        // A value on which nothing else depends has its own eigenvalue. It is split off, because otherwise rounding would
        // perturb it together with eigenvalues close to it.
        while size > 2 && m[..size - 1].iter().all(|row| row[size - 1] == 0.0) {
            size -= 1;
            apart = m[size][size].abs().larger(apart);
        }
        let radius = match size {
            2 => radius_of_two([[m[0][0], m[0][1]], [m[1][0], m[1][1]]]),
            _ => Amplification { size, rows: *m }.radius_by_squaring(),
        };
        if radius.is_finite() { radius.larger(apart) } else { radius }
    }
    /// A matrix with the same eigenvalues, in units in which rows are as large as columns. Positions, velocities and
    /// accelerations differ by powers of the step, so rounding would otherwise exceed the distance of an eigenvalue from 1.
    /// Powers of two cause no rounding.
    fn balanced(&self) -> [[f64; MOST_CARRIED]; MOST_CARRIED] {
        const SWEEPS: usize = 40;
        let (n, mut a) = (self.size, self.rows);
        for _ in 0..SWEEPS {
            let mut changed = false;
            for i in 0..n {
                let (mut row, mut column) = (0.0, 0.0);
                for j in (0..n).filter(|j| *j != i) {
                    row += a[i][j].abs();
                    column += a[j][i].abs();
                }
                let factor = match (row / column).sqrt() {
                    ratio if !(ratio > 0.0 && ratio.is_finite()) => continue,
                    ratio if ratio >= 2.0 => 2.0,
                    ratio if ratio <= 0.5 => 0.5,
                    _ => continue,
                };
                changed = true;
                for j in (0..n).filter(|j| *j != i) {
                    a[i][j] /= factor;
                    a[j][i] *= factor;
                }
            }
            if !changed {
                break;
            }
        }
        a
    }
    /// lim |Aⁿ|^(1/n) (Gelfand), n = 2⁶⁰. The rounding error of the k-th square has only the weight 2⁻ᵏ.
    fn radius_by_squaring(&self) -> f64 {
        const SQUARES: usize = 60;
        let n = self.size;
        let mut a = self.balanced();
        let (mut logarithm, mut share) = (0.0, 1.0);
        for _ in 0..=SQUARES {
            let mut norm = 0.0;
            for row in &a[..n] {
                for entry in &row[..n] {
                    norm = entry.abs().larger(norm);
                }
            }
            if !norm.is_finite() || norm == 0.0 {
                return norm;
            }
            logarithm += share * Lane::ln(norm);
            share *= 0.5;
            let inverse = 1.0 / norm;
            let mut square = [[0.0; MOST_CARRIED]; MOST_CARRIED];
            for i in 0..n {
                for j in 0..n {
                    for k in 0..n {
                        square[i][j] += (a[i][k] * inverse) * (a[k][j] * inverse);
                    }
                }
            }
            a = square;
        }
        Lane::exp(logarithm)
    }
}

impl core::ops::Index<usize> for Amplification {
    type Output = [f64; MOST_CARRIED];
    fn index(&self, row: usize) -> &Self::Output {
        &self.rows[row]
    }
}

/// The largest absolute eigenvalue of a real 2×2 matrix.
fn radius_of_two(m: [[f64; 2]; 2]) -> f64 {
    let half_trace = 0.5 * (m[0][0] + m[1][1]);
    let determinant = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    // Written without cancellation for a matrix close to the unit matrix.
    let half_difference = 0.5 * (m[0][0] - m[1][1]);
    let discriminant = half_difference * half_difference + m[0][1] * m[1][0];
    if discriminant < 0.0 { determinant.sqrt() } else { half_trace.abs() + discriminant.sqrt() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Companion matrices of given roots, a rotation, and a Jordan block of a double root.
    #[test]
    fn spectral_radii_of_three_and_four_carried_numbers() {
        // (λ − 0.9)(λ − 0.5)(λ + 0.2)
        let three = Amplification::new([[1.2, -0.17, -0.09], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        assert!((three.spectral_radius() - 0.9).abs() < 1e-14, "{}", three.spectral_radius());
        // A rotation by 0.3, and 0.5 times a rotation by 2.
        let (c, s) = (0.955_336_489_125_606, 0.295_520_206_661_339_6);
        let four =
            Amplification::new([[c, -s, 0.0, 0.0], [s, c, 0.0, 0.0], [0.0, 0.0, -0.2, -0.4], [0.0, 0.0, 0.4, -0.2]]);
        assert!((four.spectral_radius() - 1.0).abs() < 1e-14, "{}", four.spectral_radius());
        let free = Amplification::new([[1.0, 7.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.3]]);
        assert!((free.spectral_radius() - 1.0).abs() < 1e-14, "{}", free.spectral_radius());
        // Three eigenvalues that are −1 up to rounding. The value on which nothing depends is treated separately.
        let apart = Amplification::new([[-1.0, 4e-4, 0.0], [-4e-4, -1.0, 0.0], [7.0, 5.0, -1.0]]);
        assert!((apart.spectral_radius() - 1.0).abs() < 1e-7, "{}", apart.spectral_radius());
        let lonely = Amplification::new([[0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [1.0, 1.0, -3.0]]);
        assert_eq!(lonely.spectral_radius(), 3.0);
    }
}
