//! The direction of an iteration of Newton's method.

use super::balance::Balance;
use super::contact::Contacting;
use super::contact_query::ContactQuery;
use super::linear::{Filter, LINEAR_TOLERANCE, Linear, Mixture, hides_rigid_motions};
use super::rigid::Stage;
use super::settings::Settings;
use super::stage::mixture;
use super::workspace::Workspace;
use opruga_core::potential::Definiteness;
use opruga_core::system::System;
use opruga_core::threads::each_block;
use opruga_math::Lane;
use opruga_solve::dot;

/// Which derivatives are used for a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Keep {
    /// The exact derivatives.
    Exact,
    /// The derivatives of each element without their negative eigenvalues.
    Clamped,
    /// The clamped derivatives with the diagonal raised by a fraction of itself, for directions without any stiffness.
    Raised(f64),
}

impl Keep {
    pub(super) fn definiteness(self) -> Definiteness {
        if self == Keep::Exact { Definiteness::Exact } else { Definiteness::Clamped }
    }
    pub(super) fn next(self) -> Option<Keep> {
        match self {
            Keep::Exact => Some(Keep::Clamped),
            Keep::Clamped => Some(Keep::Raised(1e-8)),
            Keep::Raised(part) => (part < 1e-2).then_some(Keep::Raised(100.0 * part)),
        }
    }
}

/// The largest number of times that a direction is corrected because friction has changed.
const MOST_ROUNDS: u32 = 12;

/// The relative error of the friction force that may remain in the first iteration.
const FRICTION_TOLERANCE: f64 = 1e-3;

/// Computes b = −(r − friction) − A d from the residual r and the prescribed displacements d. `trial` is a buffer.
pub(crate) fn wanted_forces<const D: usize>(
    threads: usize,
    mixture: &Mixture<D>,
    linear: &Linear<D>,
    contacting: &Contacting<D>,
    residual: &[f64],
    prescribed: Option<&[f64]>,
    [trial, right]: [&mut [f64]; 2],
) {
    each_block(threads, D, [&mut *trial], |first, [trial]| trial.copy_from_slice(&residual[first..][..trial.len()]));
    contacting.subtract_friction(trial);
    if let Some(prescribed) = prescribed {
        linear.multiply(mixture, prescribed, right);
        for (t, r) in trial.iter_mut().zip(&*right) {
            *t += r;
        }
    }
    each_block(threads, D, [right], |first, [right]| {
        for (r, t) in right.iter_mut().zip(&trial[first..]) {
            *r = -t;
        }
    });
}

/// Solves for `workspace.step`, including prescribed displacements. Afterwards `workspace.reaction` is the force of the
/// constraints, from which friction follows. Returns the number of products. Also returns the slope, along the step, of the
/// incremental potential minus the work of friction and constraints.
pub(super) fn find_direction<const D: usize>(
    system: &System<D>,
    workspace: &mut Workspace<D>,
    balance: &Balance,
    settings: &Settings,
    keep: Keep,
    moves: bool,
    first_norm: &mut f64,
) -> Result<(u32, f64), u32> {
    let Workspace {
        linear,
        mass,
        free,
        projectors,
        residual,
        reaction,
        right,
        trial,
        step,
        prescribed,
        contacting,
        friction,
        u,
        pin_displacement,
        x0,
        extent,
        rigid,
        y,
        ..
    } = workspace;
    let mixture = mixture(system, mass, balance, keep.definiteness(), settings);
    linear.assemble(&mixture);
    let contact_query = ContactQuery::new(system, balance, [x0, u, pin_displacement], *extent);
    contacting
        .derivatives(&contact_query, keep != Keep::Exact, &mut |node, block| linear.add_block(&mixture, node, &block));
    if let Keep::Raised(part) = keep {
        linear.raise(part);
    }
    let displacements = moves.then_some(&**prescribed);
    wanted_forces(system.threads, &mixture, linear, contacting, residual, displacements, [&mut *trial, &mut *right]);
    let filter = Filter { free, projectors };
    filter.apply(right);
    let norm = dot(right, right).sqrt();
    *first_norm = norm.larger(*first_norm);
    // Far from the solution a rough direction is enough (Eisenstat and Walker 1996).
    let share = if *first_norm > 0.0 { (norm / *first_norm).larger(1e-9) } else { 1.0 };
    let tolerance = LINEAR_TOLERANCE * share;
    let mut products = linear.solve(&mixture, &filter, settings, tolerance, right, step).map_err(|_| 0u32)?;
    filter.apply(step);
    if hides_rigid_motions(linear, &mixture) {
        rigid.correct(&Stage { mixture, x0, u, y, filter, contacting }, step);
    }
    let mut slope = -dot(right, step);
    if moves {
        for (s, p) in step.iter_mut().zip(&*prescribed) {
            *s += p;
        }
    }
    if !moves && !contacting.any() {
        reaction.fill(0.0);
        return Ok((products, slope));
    }
    // The residual in the held directions after the step, r + A Δ. It contains the normal forces, which determine friction, and
    // the step follows from friction.
    friction.forget();
    let mut rounds = 0;
    loop {
        linear.multiply(&mixture, step, reaction);
        slope = if moves || rounds > 0 { -dot(reaction, step) } else { slope };
        for (r, residual) in reaction.iter_mut().zip(&*residual) {
            *r += residual;
        }
        if rounds == MOST_ROUNDS || !contacting.follow(reaction, friction, FRICTION_TOLERANCE * share, right) {
            return Ok((products, slope));
        }
        rounds += 1;
        // `right` is the change of the friction force, and `trial` the change of the step.
        filter.apply(right);
        products +=
            linear.solve_again(&mixture, &filter, settings, LINEAR_TOLERANCE, right, trial).map_err(|_| 0u32)?;
        filter.apply(trial);
        for (s, t) in step.iter_mut().zip(&*trial) {
            *s += t;
        }
    }
}
