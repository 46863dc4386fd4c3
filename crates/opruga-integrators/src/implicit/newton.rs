//! Newton's method for the balance of forces in a stage.

use super::balance::{Balance, Solved};
use super::direction::{Keep, find_direction};
use super::initial_guess::begin;
use super::instability::Instability;
use super::line_search::{Stretches, line_search, slope_along};
use super::linear::{Filter, has_symmetric_matrix};
use super::minimiser::Minimiser;
use super::rigid_balance;
use super::rounding::{at_rounding, carries, in_doubt, most_rounding, random_error, settle, visible};
use super::settings::Settings;
use super::stage::{evaluate, judge, longest, look};
use super::step_limit::part_without_inertia;
use super::workspace::Workspace;
use opruga_core::error::StepError;
use opruga_core::system::System;
use opruga_math::Lane;

/// Convergence is slow if a correction is above this fraction of the previous one.
const SLOW: f64 = 0.03;

/// From this iteration on, contacts do not change any more. Contacts that would still change make little difference.
pub(super) const MOST_DECISIONS: u32 = 30;

/// Newton's method: exact, to the tolerance of its settings.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Newton(pub(crate) Settings);

impl<const D: usize> Minimiser<D> for Newton {
    fn minimise(
        &self,
        system: &mut System<D>,
        workspace: &mut Workspace<D>,
        balance: &Balance,
    ) -> Result<Solved, StepError> {
        let mut run = Iteration::new(workspace, balance, &self.0);
        let model_error = begin(system, workspace, balance)?;
        prepare(system, workspace);
        while run.solved.iterations < self.0.iterations {
            system.go_on()?;
            run.solved.iterations += 1;
            let contacts = run.hold(system, workspace);
            let Some((keep, slope)) = run.choose_direction(system, workspace, contacts.farthest > 0.0) else { break };
            let mut correction = run.measure(system, workspace, keep, slope, contacts.changed);
            run.go(system, workspace, &mut correction, contacts.farthest)?;
            let stuck = correction.length == 0.0 && !contacts.changed;
            if stuck && run.ends_at_rounding(system, workspace)?
                || !run.choose_derivatives(workspace, &correction, stuck)
            {
                break;
            }
            let changed = contacts.changed | run.judge(system, workspace);
            if !changed && !stuck && run.ends(system, workspace, &correction)? {
                break;
            }
        }
        run.estimate_error(system, workspace);
        model_error.filter(|_| !run.solved.converged).map_or(Ok(run.solved), Err)
    }
    fn same_bits_everywhere(&self, system: &System<D>) -> bool {
        !self.0.solver.is_direct::<D>(system.nodes) && has_symmetric_matrix(system)
    }
}

/// Resets the memory of an iteration.
fn prepare<const D: usize>(system: &System<D>, workspace: &mut Workspace<D>) {
    workspace.linear.begin();
    workspace.rigid.begin();
    workspace.mixing.begin(workspace.u.len());
    workspace.friction.begin(if system.contacts.is_some() { system.nodes } else { 0 });
}

/// The data of the iteration besides the vectors.
#[derive(Debug)]
struct Iteration<'a> {
    balance: &'a Balance,
    settings: &'a Settings,
    solved: Solved,
    /// The correction below which the iteration ends [m].
    goal: f64,
    /// The largest coordinate [m].
    size: f64,
    first_norm: f64,
    /// Which derivatives the next direction uses first.
    first: Keep,
    /// The last correction that was taken in full [m].
    before: f64,
    instability: Instability,
}

/// The effect of obstacles in an iteration.
#[derive(Clone, Copy, Debug)]
struct Contacts {
    /// Whether the set of held nodes has changed.
    changed: bool,
    /// The largest distance that held nodes have to move [m].
    farthest: f64,
}

/// One correction of the iteration.
#[derive(Clone, Copy, Debug)]
struct Correction {
    /// Which derivatives the direction of this correction uses.
    keep: Keep,
    slope: f64,
    /// The largest displacement of a node due to the direction alone [m], and the part of this displacement that remains after
    /// shortening [m].
    plain: f64,
    gone: f64,
    /// Whether previous iterations were mixed in.
    mixed: bool,
    /// Whether the correction is at most half of the previous one.
    nears: bool,
    /// The fraction of the correction that was taken.
    length: f64,
}

impl<'a> Iteration<'a> {
    fn new<const D: usize>(workspace: &Workspace<D>, balance: &'a Balance, settings: &'a Settings) -> Iteration<'a> {
        let mut size: f64 = 0.0;
        for x in &workspace.x0 {
            size = x.abs().larger(size);
        }
        Iteration {
            balance,
            settings,
            solved: Solved::default(),
            goal: settings.tolerance * workspace.extent,
            size,
            first_norm: 0.0,
            first: Keep::Exact,
            before: f64::INFINITY,
            instability: Instability::new(),
        }
    }

    /// Determines which nodes are held, and how far they have to move.
    fn hold<const D: usize>(&self, system: &System<D>, workspace: &mut Workspace<D>) -> Contacts {
        let changed = look(system, workspace, self.balance, true);
        let Workspace { contacting, u, pin_displacement, x0, free, projectors, prescribed, .. } = workspace;
        let farthest = contacting.hold(u, self.balance.theta, pin_displacement, x0, free, projectors, prescribed);
        Contacts { changed, farthest }
    }

    /// Computes the direction in `workspace.step` and returns the slope along it. The direction uses the exact derivatives as
    /// long as they are positive definite. Returns `None` if no derivatives lead downhill.
    fn choose_direction<const D: usize>(
        &mut self,
        system: &System<D>,
        workspace: &mut Workspace<D>,
        moves: bool,
    ) -> Option<(Keep, f64)> {
        let mut keep = self.first;
        let slope = loop {
            match find_direction(system, workspace, self.balance, self.settings, keep, moves, &mut self.first_norm) {
                Ok((products, slope)) => {
                    self.solved.products += products;
                    if slope <= 0.0 || !moves && keep != Keep::Exact {
                        break slope;
                    }
                }
                Err(products) => self.solved.products += products,
            }
            keep = keep.next()?;
        };
        if keep != Keep::Exact {
            self.first = Keep::Clamped;
        }
        Some((keep, slope))
    }

    /// Measures the correction in `workspace.step`, shortens it in statics, and mixes in previous corrections if convergence is
    /// slow.
    fn measure<const D: usize>(
        &mut self,
        system: &System<D>,
        workspace: &mut Workspace<D>,
        keep: Keep,
        mut slope: f64,
        changed: bool,
    ) -> Correction {
        let plain = longest(&workspace.step, D);
        self.solved.correction = plain;
        let mut gone = plain;
        if self.balance.sigma == 0.0 {
            // Without inertia, a step in a soft direction can be very long.
            let part = part_without_inertia(system, workspace, self.balance, plain);
            workspace.step.iter_mut().for_each(|s| *s *= part);
            gone *= part;
            slope *= part;
        }
        // If convergence is slow, the terms that the matrix omits matter.
        if changed {
            workspace.mixing.forget();
        }
        let mixed = mix(workspace, plain > SLOW * self.before, &mut slope);
        // With inertia, rounding is reached when a correction is no longer below half of the previous one.
        let halves = self.solved.iterations == 1 || self.before.is_finite() && plain <= 0.5 * self.before;
        let nears = self.balance.sigma != 0.0 && halves;
        self.before = plain;
        self.instability.note(plain, keep != Keep::Exact && !mixed);
        Correction { keep, slope, plain, gone, mixed, nears, length: 1.0 }
    }

    /// Applies the correction in `workspace.step`. The line search limits the correction unless it is short.
    fn go<const D: usize>(
        &mut self,
        system: &mut System<D>,
        workspace: &mut Workspace<D>,
        correction: &mut Correction,
        farthest: f64,
    ) -> Result<(), StepError> {
        let Correction { keep, slope, plain, .. } = *correction;
        if plain <= self.goal {
            return full_step(system, workspace, self.balance);
        }
        // If the matrix is too stiff, the correction may be extended even near obstacles, unless the body falls towards them
        // without inertia.
        let falls = self.balance.sigma == 0.0 && system.contacts.is_some();
        let stiff = keep != Keep::Exact && !falls;
        let stretches = if stiff && farthest <= 1e-3 * workspace.extent && !workspace.contacting.any_turns() {
            self.instability.stretches(workspace.extent)
        } else {
            Stretches::No
        };
        let length = line_search(system, workspace, self.balance, slope, stretches)?;
        correction.length = length;
        correction.gone *= length;
        if length > 1.0 {
            self.instability.stretched();
        }
        if length != 1.0 {
            workspace.mixing.forget();
            self.before = f64::INFINITY;
        }
        Ok(())
    }

    /// Whether an iteration without progress ends because its residual is rounding.
    fn ends_at_rounding<const D: usize>(
        &mut self,
        system: &mut System<D>,
        workspace: &mut Workspace<D>,
    ) -> Result<bool, StepError> {
        let Iteration { balance, settings, size, .. } = *self;
        if at_rounding(system, workspace, balance, settings, size)
            && rigid_balance::accepts(system, workspace, balance, settings, size, true)?
        {
            self.solved.converged = true;
            self.solved.error_estimate = settle(system, workspace, balance, settings)?;
        }
        Ok(self.solved.converged)
    }

    /// Chooses the derivatives of the next direction. Returns whether there are any such derivatives.
    fn choose_derivatives<const D: usize>(
        &mut self,
        workspace: &Workspace<D>,
        correction: &Correction,
        stuck: bool,
    ) -> bool {
        let Correction { keep, mixed, gone, .. } = *correction;
        if !stuck {
            if keep != Keep::Exact && gone <= 1e-2 * workspace.extent {
                // Derivatives that were not positive definite may become positive definite this close to the solution.
                self.first = Keep::Exact;
            }
            return true;
        }
        // A stiffer matrix gives shorter directions, which lead downhill more reliably.
        match keep.next() {
            _ if mixed => {}
            Some(next) => self.first = next,
            None => return false,
        }
        true
    }

    /// Decides from the forces of the constraints which nodes remain held. Returns whether these nodes, or how they are held,
    /// have changed.
    fn judge<const D: usize>(&self, system: &System<D>, workspace: &mut Workspace<D>) -> bool {
        workspace.contacting.is_settled = self.solved.iterations >= MOST_DECISIONS;
        if system.contacts.is_none() || workspace.contacting.is_settled {
            return false;
        }
        let verdict = judge(system, workspace, self.balance, self.settings, self.settings.against_slide());
        if verdict.anew {
            workspace.mixing.forget();
        }
        verdict.anew || verdict.unsettled
    }

    /// Whether the iteration ends because its correction is small or because its residual is rounding.
    fn ends<const D: usize>(
        &mut self,
        system: &mut System<D>,
        workspace: &mut Workspace<D>,
        correction: &Correction,
    ) -> Result<bool, StepError> {
        let Iteration { balance, settings, size, .. } = *self;
        if correction.plain <= self.goal && rigid_balance::accepts(system, workspace, balance, settings, size, false)? {
            self.solved.converged = true;
            return Ok(true);
        }
        let last = self.solved.iterations == settings.iterations;
        if (last || !correction.nears)
            && at_rounding(system, workspace, balance, settings, size)
            && (last || carries(system, workspace, balance))
            && rigid_balance::accepts(system, workspace, balance, settings, size, true)?
        {
            self.solved.converged = true;
            self.solved.error_estimate = settle(system, workspace, balance, settings)?;
        }
        Ok(self.solved.converged)
    }

    /// Estimates how far rounding may have moved the result. If the iteration did not converge, estimates how large a
    /// displacement rounding hides.
    fn estimate_error<const D: usize>(&mut self, system: &mut System<D>, workspace: &mut Workspace<D>) {
        let Iteration { balance, settings, size, .. } = *self;
        if !self.solved.converged {
            self.solved.floor = most_rounding(system, workspace, balance, settings, size);
            return;
        }
        self.solved.conditioning = workspace.rigid.conditioning;
        let doubt = in_doubt(system, workspace, balance, settings, size);
        let suspected = doubt.displacement.larger(self.solved.error_estimate);
        if suspected > 0.0 {
            let left = left_over(system, workspace, balance, settings);
            let random_error = if doubt.lost { random_error(system, workspace, balance, settings, size) } else { 0.0 };
            self.solved.error_estimate =
                left.map_or(suspected, |left| visible(left.larger(random_error.smaller(suspected)), workspace.extent));
        }
    }
}

/// How far the residual would move a node [m], computed with the matrix of the result. The earlier estimate used an earlier
/// matrix. Returns `None` if the matrix is not positive definite, or if obstacles hold nodes.
fn left_over<const D: usize>(
    system: &System<D>,
    workspace: &mut Workspace<D>,
    balance: &Balance,
    settings: &Settings,
) -> Option<f64> {
    if workspace.contacting.any() {
        return None;
    }
    find_direction(system, workspace, balance, settings, Keep::Exact, false, &mut 0.0).ok()?;
    Some(longest(&workspace.step, D))
}

/// Records an iteration. If `wanted` is set, replaces the step of the iteration by a combination with previous iterations.
/// Returns whether the step was replaced.
fn mix<const D: usize>(workspace: &mut Workspace<D>, wanted: bool, slope: &mut f64) -> bool {
    workspace.mixing.note(&workspace.u, &workspace.step);
    if !wanted || workspace.mixing.is_empty() {
        return false;
    }
    workspace.trial.copy_from_slice(&workspace.step);
    workspace.mixing.mix(&mut workspace.step);
    Filter { free: &workspace.free, projectors: &workspace.projectors }.apply(&mut workspace.step);
    for (s, p) in workspace.step.iter_mut().zip(&workspace.prescribed) {
        *s += p;
    }
    let found = slope_along(workspace);
    if found < 0.0 {
        *slope = found;
        return true;
    }
    workspace.step.copy_from_slice(&workspace.trial);
    false
}

fn full_step<const D: usize>(
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    balance: &Balance,
) -> Result<(), StepError> {
    for (u, s) in workspace.u.iter_mut().zip(&workspace.step) {
        *u += s;
    }
    evaluate(system, workspace, balance, false)
}
