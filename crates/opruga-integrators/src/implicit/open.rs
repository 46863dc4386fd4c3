//! A step of a rule whose end is found together with the ends of other bodies.

use super::balance::{Balance, Solved};
use super::contact_query::ContactQuery;
use super::convergence::{count, finish};
use super::direction::Keep;
use super::ends::{Found, Ledger, Statics, commit, end, enter_end, enter_stage, open_ledger};
use super::fallback::exactly;
use super::friction::SlipRule;
use super::holding;
use super::line_search::given_along;
use super::linear::{Filter, Mixture};
use super::newton::MOST_DECISIONS;
use super::rounding::rounding_of_forces;
use super::rule::Rule;
use super::settings::{MOST_HALVINGS, Otherwise, Settings, Solver};
use super::stage::{evaluate, judge, look, mixture, potential, rounding_of_models};
use super::workspace::Workspace;
use opruga_core::error::StepError;
use opruga_core::open_step::OpenStep;
use opruga_core::potential::Definiteness;
use opruga_core::system::System;
use opruga_math::Lane;

/// A step that has been started.
struct Open<R, const D: usize> {
    rule: R,
    settings: Settings,
    workspace: Box<Workspace<D>>,
    balance: Balance,
    account: Account,
    /// Whether the latest evaluation of forces was at the trial state.
    tried: bool,
}

/// The data that the ledger needs from the start of the step.
enum Account {
    Motion(Box<Ledger>),
    Rest(Box<Statics>),
}

/// Begins a step of h [s] with zero displacement.
///
/// # Errors
/// [`StepError`] if a model refuses the start.
pub(super) fn open<R: Rule<D>, const D: usize>(
    rule: R,
    settings: Settings,
    system: &mut System<D>,
    h: f64,
) -> Result<Box<dyn OpenStep<D>>, StepError> {
    let mut workspace = system.cache.take::<Workspace<D>>();
    let settings = if system.exact { exactly(&settings) } else { settings };
    let rule = rule.pushed();
    let rule = rule.in_contact().unwrap_or(rule);
    // Data that are reused from step to step are valid only if the body is solved alone.
    workspace.answer.last = None;
    holding::take_hold(system, &mut workspace.kick, h);
    let account = Account::Motion(Box::new(open_ledger::<R, D>(system, &mut workspace, h)?));
    begin((rule, settings), system, workspace, account, h)
}

/// Begins a static step, whose length is h [s].
///
/// # Errors
/// [`StepError`] if a model refuses the start.
pub(crate) fn open_at_rest<R: Rule<D>, const D: usize>(
    rule: R,
    settings: Settings,
    system: &mut System<D>,
    h: f64,
) -> Result<Box<dyn OpenStep<D>>, StepError> {
    let mut workspace = system.cache.take::<Workspace<D>>();
    let account = Account::Rest(Box::new(Statics::begin(system, &mut workspace)?));
    begin((rule, settings), system, workspace, account, h)
}

/// Begins a step whose initial state is already in the workspace.
fn begin<R: Rule<D>, const D: usize>(
    (rule, settings): (R, Settings),
    system: &mut System<D>,
    mut workspace: Box<Workspace<D>>,
    account: Account,
    h: f64,
) -> Result<Box<dyn OpenStep<D>>, StepError> {
    workspace.contacting.clear(system.nodes);
    let balance = rule.begin(system, &mut workspace, h);
    workspace.hold(system, balance.theta, h);
    workspace.u.fill(0.0);
    workspace.step.fill(0.0);
    workspace.reaction.fill(0.0);
    workspace.linear.begin();
    workspace.friction.begin(if system.contacts.is_some() { system.nodes } else { 0 });
    let mut open = Open { rule, settings, workspace, balance, account, tried: false };
    evaluate(system, &mut open.workspace, &balance, false)?;
    Ok(Box::new(open))
}

impl<R: Rule<D>, const D: usize> Open<R, D> {
    /// The matrix is always assembled, because interactions between bodies are solved with its factor.
    fn mixture<'a>(&'a self, system: &'a System<D>, keep: Definiteness) -> Mixture<'a, D> {
        let mixture = mixture(system, &self.workspace.mass, &self.balance, keep, &self.settings);
        Mixture { matrix_free: false, ..mixture }
    }
}

impl<R: Rule<D>, const D: usize> OpenStep<D> for Open<R, D> {
    fn stay(&mut self, sigma: f64) {
        if let Account::Rest(_) = self.account {
            let Workspace { y, u, .. } = &mut *self.workspace;
            y.copy_from_slice(u);
            self.balance.sigma = sigma;
        }
    }
    fn displacements(&self) -> &[f64] {
        &self.workspace.u
    }
    fn correction(&mut self) -> &mut [f64] {
        &mut self.workspace.step
    }
    fn evaluate(&mut self, system: &mut System<D>, part: f64) -> Result<(), StepError> {
        let Workspace { trial, u, step, .. } = &mut *self.workspace;
        for (trial, (u, step)) in trial.iter_mut().zip(u.iter().zip(step)) {
            *trial = u + part * *step;
        }
        self.tried = true;
        evaluate(system, &mut self.workspace, &self.balance, true)
    }
    fn potential(&self, system: &System<D>) -> Option<[f64; 2]> {
        if system.is_damped() {
            return None;
        }
        potential(system, &self.workspace, &self.balance, self.tried).map(|(energy, size)| [energy, size])
    }
    fn rounding(&self, system: &System<D>) -> f64 {
        rounding_of_models(system)
    }
    fn rounding_of_forces(&self, system: &System<D>) -> f64 {
        rounding_of_forces(&self.workspace, &self.mixture(system, Definiteness::Clamped))
    }
    fn residual(&self) -> &[f64] {
        &self.workspace.residual
    }
    fn advance(&mut self, part: f64) {
        let Workspace { u, step, .. } = &mut *self.workspace;
        u.iter_mut().zip(step).for_each(|(u, step)| *u += part * *step);
    }
    fn look(&mut self, system: &System<D>) -> bool {
        let changed = look(system, &mut self.workspace, &self.balance, true);
        let Workspace { contacting, u, pin_displacement, x0, free, projectors, prescribed, .. } = &mut *self.workspace;
        contacting.hold(u, self.balance.theta, pin_displacement, x0, free, projectors, prescribed);
        changed
    }
    fn factor(&mut self, system: &System<D>, exact: bool) -> bool {
        let mut linear = std::mem::take(&mut self.workspace.linear);
        let mut factored = false;
        for keep in [Keep::Exact, Keep::Clamped].into_iter().skip(usize::from(!exact)) {
            let mixture = self.mixture(system, keep.definiteness());
            linear.assemble(&mixture);
            let Workspace { contacting, x0, u, pin_displacement, extent, free, projectors, .. } = &*self.workspace;
            let query = ContactQuery::new(system, &self.balance, [x0, u, pin_displacement], *extent);
            contacting
                .derivatives(&query, keep != Keep::Exact, &mut |node, block| linear.add_block(&mixture, node, &block));
            factored = linear.factor_positive(&Filter { free, projectors }).is_ok();
            if factored {
                break;
            }
        }
        self.workspace.linear = linear;
        factored
    }
    fn stiffness(&self, system: &System<D>, node: usize) -> f64 {
        // Nodes that stick to an obstacle move when something pushes them hard enough.
        let is_pinned = self.workspace.pin_displacement[node * D..(node + 1) * D].iter().all(|x| !x.is_nan());
        if is_pinned {
            0.0
        } else {
            self.workspace.linear.size_at(&self.mixture(system, Definiteness::Clamped), node) / D as f64
        }
    }
    fn prescribed(&self) -> &[f64] {
        &self.workspace.prescribed
    }
    fn right_side(&mut self, system: &System<D>, forces: &[f64], out: &mut [f64]) {
        self.multiply(system, &self.workspace.prescribed, out);
        let Workspace { contacting, residual, .. } = &*self.workspace;
        for (out, (r, force)) in out.iter_mut().zip(residual.iter().zip(forces)) {
            *out += r + force;
        }
        contacting.subtract_friction(out);
        out.iter_mut().for_each(|out| *out = -*out);
        self.filter(out);
    }
    fn multiply(&self, system: &System<D>, x: &[f64], y: &mut [f64]) {
        self.workspace.linear.multiply(&self.mixture(system, Definiteness::Clamped), x, y);
    }
    fn filter(&self, x: &mut [f64]) {
        Filter { free: &self.workspace.free, projectors: &self.workspace.projectors }.apply(x);
    }
    fn solve(&self, x: &mut [f64]) {
        self.workspace.linear.solve_positive(x, 1);
    }
    fn follow(&mut self, system: &System<D>, forces: &[f64], tolerance: f64, out: &mut [f64]) -> bool {
        // Pins that move their nodes do work along the correction too.
        let leads = self.workspace.prescribed.iter().any(|displacement| *displacement != 0.0);
        if !leads && !self.workspace.contacting.any() {
            self.workspace.reaction.fill(0.0);
            return false;
        }
        self.multiply(system, &self.workspace.step, out);
        let Workspace { reaction, residual, contacting, friction, .. } = &mut *self.workspace;
        for (k, reaction) in reaction.iter_mut().enumerate() {
            *reaction = out[k] + residual[k] + forces[k];
        }
        let changed = contacting.follow(reaction, friction, tolerance, out);
        if changed {
            self.filter(out);
        }
        changed
    }
    fn given(&mut self) -> f64 {
        given_along(&mut self.workspace)
    }
    fn judge(&mut self, system: &System<D>, iteration: u32) -> bool {
        let is_settled = iteration >= MOST_DECISIONS;
        self.workspace.contacting.is_settled = is_settled;
        if system.contacts.is_none() || is_settled {
            return false;
        }
        let settings = Settings { solver: Solver::Auto, ..self.settings };
        let slip = if settings.real_time { SlipRule::Projected } else { settings.against_slide() };
        let verdict = judge(system, &mut self.workspace, &self.balance, &settings, slip);
        verdict.anew || verdict.unsettled
    }
    fn goal(&self) -> f64 {
        self.settings.tolerance * self.workspace.extent
    }
    fn most_iterations(&self) -> (u32, bool) {
        let accepts = self.settings.real_time || self.settings.otherwise == Otherwise::Accept;
        (self.settings.common_iterations, accepts)
    }
    fn most_halvings(&self) -> u32 {
        let halves = matches!(self.account, Account::Motion(_)) && self.settings.otherwise == Otherwise::Halve;
        if halves { MOST_HALVINGS } else { 0 }
    }
    fn close(mut self: Box<Self>, system: &mut System<D>, iterations: u32, converged: bool) -> Result<(), StepError> {
        let Open { rule, balance, account, .. } = *self;
        let workspace = &mut *self.workspace;
        let solved = Solved { iterations, converged, ..Solved::default() };
        evaluate(system, workspace, &balance, false)?;
        count(system, &solved);
        let work = &mut system.work.solver;
        match converged {
            true => {}
            false if self.settings.real_time => {
                let left = workspace.step.iter().fold(0.0, |most: f64, moved| moved.abs().larger(most));
                (work.cut_off, work.left) = (work.cut_off + 1, left.larger(work.left));
            }
            false => work.accepted += 1,
        }
        match account {
            Account::Motion(ledger) => {
                end(rule, system, workspace, &balance, balance.h);
                finish(system, workspace);
                let found = Found { rule, balance, solved };
                enter_stage(system, workspace, &found, &ledger);
                commit(system, workspace);
                enter_end(system, workspace, &found)?;
                rule.remember(system, workspace, balance.h);
                system.end_implicit(balance.h);
            }
            Account::Rest(statics) => {
                finish(system, workspace);
                rule.end(system, workspace, &balance, balance.h);
                statics.end(system, workspace, balance.h)?;
                rule.remember(system, workspace, balance.h);
            }
        }
        system.cache.put(self.workspace);
        Ok(())
    }
}
