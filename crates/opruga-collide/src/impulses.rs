//! Impulses on pairs in contact: projected Gauss–Seidel.

use crate::coupled::Coupled;
use crate::newton::Aim;
use crate::row::Row;
use crate::spread::Spread;
use crate::subspace;
use crate::turns::{COUPLED_TOLERANCE, TOLERANCE, Turns};
use crate::vector::{dot, scaled};
use crate::working_set;
use core::any::Any;
use opruga_math::Lane;

/// The largest number of sweeps in a step. A sweep passes an impulse through all contacts in its direction. A column of bodies
/// therefore needs about as many sweeps as there are contacts that an elastic wave passes within one step: a few.
const MOST_SWEEPS: usize = 60;

/// The corresponding fraction (see [`TOLERANCE`]) for bodies at rest, relative to the approach in the present correction. The
/// next correction solves for the remainder, whose approach is smaller. With a fraction of a tenth, one and a half times as
/// many corrections are needed.
const TOLERANCE_AT_REST: f64 = 1e-3;

/// The largest number of sweeps for bodies with implicit integrators and bodies at rest. Contacts without friction need up to 30.
/// Contacts that alternate between sticking and sliding never converge. With 300 sweeps, no test and no case of the verification
/// becomes more accurate.
const MOST_COUPLED_SWEEPS: usize = 100;

/// The number of sweeps before each step in the subspace of the active contacts: one forward, one backward.
const SWEEPS_BETWEEN: usize = 2;

/// After this many steps in the subspace that did not halve the change of a sweep, only sweeps are made. With friction,
/// contacts may alternate between sticking and sliding.
const MOST_FAILURES: usize = 16;

/// After this many steps in the subspace that did not halve the change of a sweep, the sweeps of bodies at rest end. The next
/// correction continues from their result.
const MOST_FAILURES_AT_REST: usize = 2;

/// The problem to solve.
pub(crate) struct Problem<'a, const D: usize> {
    pub(crate) rows: &'a mut Vec<Row<D>>,
    pub(crate) spread: &'a Spread,
    pub(crate) inverse_mass: &'a Vec<[f64; D]>,
    pub(crate) coupled: &'a mut Coupled<D>,
    pub(crate) v: &'a mut Vec<[f64; D]>,
    pub(crate) turns: &'a mut Turns<D>,
    /// For bodies at rest, the approach velocity that would cross a whole thickness in the step [m/s]. Their sweeps also end at the fraction
    /// [`COUPLED_TOLERANCE`] of this velocity.
    pub(crate) at_rest: Option<f64>,
    /// Whether the steps of coupled bodies have a fixed budget.
    pub(crate) has_budget: bool,
    /// The body of every point.
    pub(crate) body: &'a [u32],
    /// The threads that may solve for sets of contacts that no point connects.
    pub(crate) threads: usize,
}

impl<const D: usize> Problem<'_, D> {
    /// Returns the same problem if it has `E` dimensions, otherwise none.
    fn of<const E: usize>(&mut self) -> Option<Problem<'_, E>> {
        fn cast<A: Any, B: Any>(one: &mut A) -> Option<&mut B> {
            (one as &mut dyn Any).downcast_mut()
        }
        Some(Problem {
            rows: cast(self.rows)?,
            spread: self.spread,
            inverse_mass: (self.inverse_mass as &dyn Any).downcast_ref()?,
            coupled: cast(self.coupled)?,
            v: cast(self.v)?,
            turns: cast(self.turns)?,
            at_rest: self.at_rest,
            has_budget: self.has_budget,
            body: self.body,
            threads: self.threads,
        })
    }

    /// Sweeps over the rows, forward and backward, until the velocities no longer change. Sets of rows that no point connects are solved separately.
    /// Returns the number of turns.
    ///
    /// The code behind this call is not generic, so that the sweeps are compiled once, with this crate.
    pub(crate) fn solve(mut self) -> usize {
        if let Some(plane) = self.of::<2>() {
            return solve_in_plane(plane);
        }
        self.of::<3>().map_or(0, solve_in_space)
    }
}

#[inline(never)]
fn solve_in_plane(problem: Problem<'_, 2>) -> usize {
    solve(problem)
}

#[inline(never)]
fn solve_in_space(problem: Problem<'_, 3>) -> usize {
    solve(problem)
}

fn solve<const D: usize>(problem: Problem<'_, D>) -> usize {
    let Problem { rows, spread, inverse_mass, coupled, v, turns, at_rest, has_budget, body, threads } = problem;
    turns.join(rows, spread, inverse_mass, coupled);
    let mut count = turns.solve_alone(rows, (v, body), (MOST_SWEEPS, TOLERANCE), threads);
    for set in 0..turns.starts().len() - 1 {
        let Some((mut sweeps, approach)) = turns.coupled_set(set, rows, (inverse_mass, v), (spread, body)) else {
            continue;
        };
        let before = *sweeps.now;
        let together = sweeps.rows.iter().any(|row| row.coupled);
        let (most, enough) = match (together, at_rest) {
            (true, None) if has_budget => (MOST_SWEEPS, TOLERANCE * approach),
            (true, None) => (MOST_COUPLED_SWEEPS, COUPLED_TOLERANCE * approach),
            (true, Some(whole)) => {
                (MOST_COUPLED_SWEEPS, (TOLERANCE_AT_REST * approach).larger(COUPLED_TOLERANCE * whole))
            }
            (false, _) => (MOST_SWEEPS, TOLERANCE * approach),
        };
        let aim = Aim { enough, sweeps: has_budget.then_some(most) };
        if together && let Some(turns) = working_set::solve(sweeps.rows, spread, inverse_mass, coupled, sweeps.v, aim) {
            count += turns;
            continue;
        }
        let (mut failures, mut smallest) = (0, f64::INFINITY);
        for sweep in 0..most {
            let steps = together && sweep > 0 && sweep % SWEEPS_BETWEEN == 0 && failures < MOST_FAILURES;
            if steps {
                subspace::step(sweeps.rows, spread, inverse_mass, coupled, sweeps.v);
                // All velocities may have changed.
                sweeps.heads.iter_mut().for_each(|(_, last)| *last = 0);
            }
            let (changed, largest) = sweeps.sweep_coupled(sweep % 2 == 1, enough, spread, coupled);
            if steps {
                failures += usize::from(largest > 0.5 * smallest);
                smallest = largest.smaller(smallest);
            }
            if !changed || at_rest.is_some() && failures >= MOST_FAILURES_AT_REST {
                break;
            }
        }
        count += (*sweeps.now - before) as usize;
    }
    count
}

/// Finds displacements that separate overlapping pairs by at most `most` [m] without causing other overlaps. The sweeps are the same as for
/// velocities, but act on positions. `wanted` is the required increase of the gap of every row [m]. `masses` contains the effective mass of every row
/// along its normal [kg] if its points respond independently.
pub(crate) fn part<const D: usize>(
    rows: &[Row<D>],
    spread: &Spread,
    inverse_mass: &[[f64; D]],
    (wanted, masses): (&[f64], &[f64]),
    multipliers: &mut Vec<f64>,
    moved: &mut [[f64; D]],
    most: f64,
) {
    multipliers.clear();
    multipliers.resize(rows.len(), 0.0);
    for _ in 0..MOST_SWEEPS {
        let mut largest: f64 = 0.0;
        for (k, row) in rows.iter().enumerate() {
            let now = dot(&row.mean(spread, moved), &row.normal);
            let old = multipliers[k];
            let new = (old + (wanted[k] - now) * masses[k]).larger(0.0);
            if new != old {
                multipliers[k] = new;
                row.give(spread, &scaled(&row.normal, new - old), inverse_mass, moved);
                largest = ((new - old) / masses[k]).abs().larger(largest);
            }
        }
        if largest <= TOLERANCE * most {
            return;
        }
    }
}
