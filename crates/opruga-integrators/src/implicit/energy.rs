//! The guard of energy: a step makes none where nothing gives any.

use super::balance::Balance;
use super::contact::dot;
use super::rule::Rule;
use super::stage;
use super::workspace::Workspace;
use opruga_core::error::StepError;
use opruga_core::potential::Account;
use opruga_core::system::{Pin, Stage, System};
use opruga_solve::blocks::nodes;

/// Gains of energy below this part of it are rounding.
const NO_GAIN: f64 = 1e-9;

/// The part of its energy of motion that a body may gain in a step in real time.
const LITTLE_GAIN: f64 = 1e-3;

/// The energy of a body before a step [J]; none where it may gain some: from loads, a gas or moving pins.
fn energy_before<const D: usize>(
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    h: f64,
) -> Result<Option<f64>, StepError> {
    let moves = |pin: &Pin<D>| pin.target(system.time).0 != pin.target(system.time + h).0;
    let given = system.members.iter().any(|member| member.potential.properties().account != Account::Elastic);
    if given || system.pins.iter().any(moves) {
        return Ok(None);
    }
    system.evaluate(Stage::Current, 0.0, 0.0, &mut workspace.force)?;
    Ok(system.potential_energy(Stage::Current, 0.0).map(|stored| stored + system.kinetic_energy()))
}

/// Whether a body has more energy at the end of the step than before, and than a part of that of its motion.
fn gains<const D: usize>(
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    before: f64,
    h: f64,
    part: f64,
) -> Result<bool, StepError> {
    Workspace::show(system, &workspace.x0, &workspace.u1, &workspace.z, 0.0);
    system.evaluate(Workspace::<D>::STAGE, h, 0.0, &mut workspace.force)?;
    // What cannot be told is a gain where some is allowed for.
    let Some(stored) = system.potential_energy(Workspace::<D>::STAGE, h) else { return Ok(part > 0.0) };
    let mut kinetic = 0.0;
    for (velocity, mass) in nodes::<D>(&workspace.v1).iter().zip(&workspace.mass) {
        kinetic += 0.5 * mass * dot(velocity, velocity);
    }
    if let Some(inertia) = &system.inertia {
        kinetic += 0.5 * inertia.square::<D>(&workspace.v1);
    }
    let after = stored + kinetic;
    // Written so that what is no number is a gain.
    let within = after - before <= NO_GAIN * (after.abs() + before.abs() + kinetic) + part * kinetic;
    Ok(!within)
}

/// Whether a step whose end is doubtful may have made energy; else forces are again those of the stage.
pub(super) fn gains_in_doubt<const D: usize>(
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    balance: &Balance,
) -> Result<bool, StepError> {
    let gained = match energy_before(system, workspace, balance.h)? {
        Some(before) => gains(system, workspace, before, balance.h, LITTLE_GAIN)?,
        // Nobody knows what it may have gained.
        None => true,
    };
    if !gained {
        stage::evaluate(system, workspace, balance, false)?;
    }
    Ok(gained)
}

/// The rule instead of one by which a body in contact has gained energy; else forces are again those of the stage. `energy` is that
/// before the step, once it was asked for.
pub(super) fn calmer_rule<R: Rule<D>, const D: usize>(
    rule: R,
    energy: &mut Option<Option<f64>>,
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    balance: &Balance,
) -> Result<Option<R>, StepError> {
    let Some(calmed) = rule.calmed().filter(|_| workspace.contacting.any_at_rest()) else { return Ok(None) };
    if energy.is_none() {
        *energy = Some(energy_before(system, workspace, balance.h)?);
    }
    let Some(before) = energy.flatten() else { return Ok(None) };
    if gains(system, workspace, before, balance.h, 0.0)? {
        return Ok(Some(calmed));
    }
    // What is entered later goes by the stage.
    stage::evaluate(system, workspace, balance, false)?;
    Ok(None)
}
