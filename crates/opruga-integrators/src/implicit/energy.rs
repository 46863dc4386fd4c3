//! The energy guard: a step creates no energy without a source.

use super::balance::Balance;
use super::contact::dot;
use super::stage;
use super::workspace::Workspace;
use opruga_core::error::StepError;
use opruga_core::potential::Account;
use opruga_core::system::{Pin, Stage, System};
use opruga_solve::blocks::nodes;

/// The change of the energy of a body in a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Change {
    /// The energy before the step, the energy at its end if known, and the rounding of both [J].
    before: f64,
    after: Option<f64>,
    rounding: f64,
}

impl Change {
    /// Whether the body has gained energy, or `None` if that is unknown.
    fn is_gain(&self) -> Option<bool> {
        let after = self.after?;
        // Written so that NaN counts as a gain.
        let within = after - self.before <= self.rounding;
        Some(!within)
    }

    /// Whether a step whose end is doubtful may have created energy. If the gain is unknown, the answer is yes.
    pub(super) fn may_be_gain(change: Option<Change>) -> bool {
        change.and_then(|change| change.is_gain()).unwrap_or(true)
    }

    /// Whether a step has certainly created energy. If the gain is unknown, the answer is no.
    pub(super) fn is_known_gain(change: Option<Change>) -> bool {
        change.and_then(|change| change.is_gain()).unwrap_or(false)
    }
}

/// Whether a body may gain energy in a step of h [s]: from loads, a gas or moving pins.
fn may_gain<const D: usize>(system: &System<D>, h: f64) -> bool {
    let moves = |pin: &Pin<D>| pin.target(system.time).0 != pin.target(system.time + h).0;
    let given = system.members.iter().any(|member| member.potential.properties().account != Account::Elastic);
    given || system.pins.iter().any(moves)
}

/// The energy of a body before a step [J], or `None` if its models do not compute it.
fn energy_before<const D: usize>(
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
) -> Result<Option<f64>, StepError> {
    system.evaluate(Stage::Current, 0.0, 0.0, &mut workspace.force)?;
    Ok(system.potential_energy(Stage::Current, 0.0).map(|stored| stored + system.kinetic_energy()))
}

/// The change of the energy of a body in the step whose end was found. Returns `None` if the body may gain energy, or if its
/// models do not compute the energy. Afterwards the forces are those of the stage. `energy` is the energy before the step,
/// if it was already computed.
pub(super) fn change<const D: usize>(
    energy: &mut Option<Option<f64>>,
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    balance: &Balance,
) -> Result<Option<Change>, StepError> {
    let h = balance.h;
    if may_gain(system, h) {
        return Ok(None);
    }
    let before = match *energy {
        Some(known) => known,
        None => *energy.insert(energy_before(system, workspace)?),
    };
    let Some(before) = before else {
        stage::evaluate(system, workspace, balance, false)?;
        return Ok(None);
    };
    Workspace::show(system, &workspace.x0, &workspace.u1, &workspace.z, 0.0);
    system.evaluate(Workspace::<D>::STAGE, h, 0.0, &mut workspace.force)?;
    let mut kinetic = 0.0;
    for (velocity, mass) in nodes::<D>(&workspace.v1).iter().zip(&workspace.mass) {
        kinetic += 0.5 * mass * dot(velocity, velocity);
    }
    if let Some(inertia) = &system.inertia {
        kinetic += 0.5 * inertia.square::<D>(&workspace.v1);
    }
    let after = system.potential_energy(Workspace::<D>::STAGE, h).map(|stored| stored + kinetic);
    let size = before.abs() + after.map_or(0.0, f64::abs) + kinetic;
    let rounding = stage::rounding_of_models(system) + stage::CANCELLATION * size;
    stage::evaluate(system, workspace, balance, false)?;
    Ok(Some(Change { before, after, rounding }))
}
