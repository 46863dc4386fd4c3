//! How a system borrows the memory of its steps.

use crate::system::System;
use crate::workspace::Workspace;
use opruga_math::WIDTH;

impl<const D: usize> Workspace<D> {
    /// Enlarges the workspace so that it suffices for the steps of a system.
    pub fn fit(&mut self, system: &System<D>) {
        self.grow(system.plan.buffer_length(), system.stages, system.index_count());
    }
}

impl<const D: usize> System<D> {
    /// Swaps the memory of the system with the memory of a workspace, to borrow memory or to give it back.
    pub fn exchange(&mut self, workspace: &mut Workspace<D>) {
        std::mem::swap(&mut self.forces, &mut workspace.forces);
        std::mem::swap(&mut self.before, &mut workspace.before);
        std::mem::swap(&mut self.velocity_before, &mut workspace.velocity_before);
        std::mem::swap(&mut self.state.work, &mut workspace.stages);
    }
    /// Makes a workspace for a step if none was lent.
    pub(crate) fn ensure_workspace(&mut self) {
        let (buffers, stages, index_count) = (self.plan.buffer_length(), self.stages, self.index_count());
        let own = self.state.work.iter().take(stages).flatten().all(|c| c.0[0].len() >= index_count + WIDTH);
        if self.forces[0].len() < buffers + WIDTH || self.state.work.len() < stages || !own {
            let mut workspace = Workspace::default();
            self.exchange(&mut workspace);
            workspace.grow(buffers, stages, index_count);
            self.exchange(&mut workspace);
        }
    }
}
