//! The interface of methods that find the stage of a rule.
//!
//! A rule defines its stage by a [`Balance`]. A minimiser finds this stage and does not depend on the rule. All exact
//! minimisers find the same stage. The guards of a step (file `step`) wrap any minimiser.

use super::balance::{Balance, Solved};
use super::workspace::Workspace;
use opruga_core::error::StepError;
use opruga_core::history::Channel;
use opruga_core::system::System;

/// Finds the stage in which forces balance the change of motion. If the forces have a potential, this stage is the minimum of
/// the incremental potential Φ.
pub(crate) trait Minimiser<const D: usize>: core::fmt::Debug {
    /// Finds the stage, starting from the displacement in `workspace.u`. On success, the forces and the residual are those of
    /// this stage.
    ///
    /// # Errors
    /// [`StepError`] if a model has no value, or if the caller has stopped the step. A search that does not converge is not an
    /// error.
    fn minimise(
        &self,
        system: &mut System<D>,
        workspace: &mut Workspace<D>,
        balance: &Balance,
    ) -> Result<Solved, StepError>;
    /// The data that the minimiser remembers from step to step.
    fn history(&self) -> Vec<Channel> {
        Vec::new()
    }
    /// Uses its memory to improve the displacement in `workspace.u`, which continues the motion of the previous step.
    fn predict(&self, _system: &System<D>, _workspace: &mut Workspace<D>, _balance: &Balance) {}
    /// Discards the data that the minimiser reuses from step to step, after a guard has refused its stage.
    fn discard(&self, _system: &mut System<D>) {}
    /// Remembers an accepted step of h [s].
    fn remember(&self, _system: &mut System<D>, _workspace: &Workspace<D>, _h: f64) {}
    /// Whether later steps may solve with the matrix in `workspace.linear` too.
    fn keeps_matrix(&self, _system: &System<D>) -> bool {
        false
    }
    /// Whether a step that does not converge is halved, whatever the scene specifies.
    fn always_halves(&self) -> bool {
        false
    }
    /// Whether the minimiser uses several threads.
    fn shares_threads(&self) -> bool {
        false
    }
    /// Whether the minimiser gives the same bits on every processor.
    fn same_bits_everywhere(&self, system: &System<D>) -> bool;
}
