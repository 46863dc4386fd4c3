//! What finds the stage of a rule.
//!
//! A rule says by a [`Balance`] which stage it wants; a minimiser finds it, and knows no rule. Every exact minimiser finds the same
//! stage. The guards of a step (`step`) wrap any of them.

use super::balance::{Balance, Solved};
use super::workspace::Workspace;
use opruga_core::error::StepError;
use opruga_core::history::Channel;
use opruga_core::system::System;

/// Finds the stage in which forces balance the change of motion: where they have a potential, the minimum of the incremental
/// potential Φ.
pub(crate) trait Minimiser<const D: usize>: core::fmt::Debug {
    /// Finds the stage from the displacement in `workspace.u` on; on success forces and residual belong to what is found.
    ///
    /// # Errors
    /// [`StepError`] where a model has no meaning, or the caller broke the step off. A search that does not converge is no error.
    fn minimise(
        &self,
        system: &mut System<D>,
        workspace: &mut Workspace<D>,
        balance: &Balance,
    ) -> Result<Solved, StepError>;
    /// What it remembers from step to step.
    fn history(&self) -> Vec<Channel> {
        Vec::new()
    }
    /// Improves the displacement in `workspace.u`, which the motion of the last step leads to, by what it remembers.
    fn predict(&self, _system: &System<D>, _workspace: &mut Workspace<D>, _balance: &Balance) {}
    /// Discards what it reuses from step to step, where a guard refuses the stage that it found.
    fn discard(&self, _system: &mut System<D>) {}
    /// Remembers a step of h [s] that counts.
    fn remember(&self, _system: &mut System<D>, _workspace: &Workspace<D>, _h: f64) {}
    /// Whether later steps may solve with the matrix in `workspace.linear`, too.
    fn keeps_matrix(&self, _system: &System<D>) -> bool {
        false
    }
    /// Whether a step that does not converge is halved whatever the scene says.
    fn always_halves(&self) -> bool {
        false
    }
    /// Whether it works on several threads.
    fn shares_threads(&self) -> bool {
        false
    }
    /// Whether the same bits come out on every processor.
    fn same_bits_everywhere(&self, system: &System<D>) -> bool;
}
