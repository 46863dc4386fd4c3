//! Access to the states of a world within the last frame.

use crate::ledger::{Energy, Flows, Momentum};
use crate::world::World;

impl<const D: usize> World<D> {
    /// Keeps states of the coming frames for [`World::look_within`], `every` substeps apart; 0 keeps none.
    ///
    /// Results do not depend on it. Each kept state is a copy of all positions and velocities. Only the first frame allocates this memory.
    pub fn keep_looks(&mut self, every: u32) {
        (self.looks.every, self.looks.fresh) = (every, false);
    }

    /// Calls `look` with the world in each state that was kept within the last frame, one after another; then restores the world.
    ///
    /// Positions, velocities, time, energy, momentum, readings and probes then belong to that state.
    pub fn look_within(&mut self, mut look: impl FnMut(&mut World<D>)) {
        let every = self.looks.every;
        if every == 0 || !self.looks.fresh {
            return;
        }
        let now: (Flows, Energy, Momentum<D>) = (self.flows, self.energy, self.momentum);
        let start = (self.frames - 1) as f64 * self.blueprint.time.frame;
        for number in 0..(self.blueprint.time.substeps - 1) / every {
            let ends: Vec<_> = self.islands.iter().map(|island| (island.stock, island.survey)).collect();
            let mut flows = self.looks.flows;
            let mut complete = true;
            for island in &mut self.islands {
                // Islands that were built after the last frame have no kept states.
                let work = island.swap_look(number as usize);
                island.refresh();
                match work {
                    Some(work) => flows.add(&island.system, island.numerical_loss(&work), &work),
                    None => complete = false,
                }
            }
            if complete {
                self.flows = flows;
                self.refresh_ledger();
                self.looks.time = Some(start + f64::from((number + 1) * every) * self.h());
                look(self);
                self.looks.time = None;
            }
            for (island, (stock, survey)) in self.islands.iter_mut().zip(ends) {
                island.swap_look(number as usize);
                (island.stock, island.survey) = (stock, survey);
            }
            (self.flows, self.energy, self.momentum) = now;
        }
    }
}
