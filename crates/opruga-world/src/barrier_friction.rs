//! The rounds of friction between bodies that a barrier keeps apart.
//!
//! Each round finds the minimum at given normal forces and multipliers of friction. Both then follow from its result, until friction no longer changes
//! (augmented Lagrangian method).

use crate::barrier_search::{MOST_ROUNDS, Refused, SETTLED, Search, scaled};
use opruga_collide::Rubbing;
use opruga_math::Lane;

/// If a round leaves more than this fraction of the slip of the previous round, sticking becomes ten times as stiff (Nocedal and Wright, Numerical
/// optimization, framework 17.3). With constant stiffness, half of the steps of two gas rings end before friction has settled
/// (`friction_between_gas_rings_settles_in_every_step`).
///
/// Sticking becomes at most a hundred times as stiff. Corrections between stiffer sticking and sliding hardly advance, and a gripper whose plates are
/// smaller than the block then finds no end (`plates_smaller_than_a_block_grip_it_under_a_barrier`).
const SLOW: f64 = 0.5;
const MOST_STICKING: f64 = 100.0;

/// From this round on, the limits µN of friction change by half only. Normal forces and friction may otherwise alternate between two states
/// (`friction_between_gas_rings_settles_in_every_step`).
const DAMPED: u32 = 5;

impl<const D: usize> Search<'_, '_, D> {
    /// Finds the common end of the step, including friction. With a budget, friction depends on the normal forces at the start, and its multipliers
    /// converge over several steps.
    pub(crate) fn find_end(&mut self, h: f64, multipliers: Vec<(u64, [f64; D])>) -> Result<(), Refused> {
        let mut before = Vec::new();
        self.look_ahead(h)?;
        self.press()?;
        self.rub(&multipliers);
        // Bodies that come to rest reach equilibrium only when friction is known. Until then friction is updated after every correction: without
        // friction a sliding body may have its only equilibrium far away (`stacks_come_to_their_balance`).
        let (mut precise, mut rounds) = (self.staying.is_none(), 0);
        let mut last = f64::INFINITY;
        while rounds < MOST_ROUNDS {
            self.converged = true;
            let found = self.find_minimum(precise)?;
            if self.has_budget {
                return Ok(());
            }
            // The multipliers and the normal forces on which friction depends come from this result.
            let multipliers = self.multipliers();
            before = std::mem::take(&mut self.rubbing);
            self.rub(&multipliers);
            let [stuck, sliding] = self.change_of_friction(&before);
            // A stiffer multiplier changes more for the same slip.
            let slip = stuck / self.sticking;
            let settled = found && slip.larger(sliding) <= SETTLED;
            if settled && precise {
                self.rubbing = before;
                return Ok(());
            }
            if precise && found {
                if slip > SLOW * last {
                    self.sticking = (10.0 * self.sticking).smaller(MOST_STICKING);
                }
                if rounds >= DAMPED {
                    self.damp(&before);
                }
                last = slip;
            }
            precise |= settled;
            rounds += u32::from(found);
            let (most, accepts) = self.most_iterations();
            if !found && self.iterations >= most {
                self.rubbing = before;
                return self.accept_or_refuse(accepts).map(|_| ());
            }
        }
        // The bodies are in equilibrium with the previous friction forces.
        self.rubbing = before;
        if self.staying.is_some() {
            self.find_minimum(true)?;
        }
        self.converged = false;
        Ok(())
    }

    /// The friction force of every pair with the opposite sign [N], by the features of the pairs. This force is the multiplier for the next search.
    pub(crate) fn multipliers(&self) -> Vec<(u64, [f64; D])> {
        self.rubbing.iter().map(|rub| (rub.id, scaled(&rub.force(&rub.slip(&self.moved)), -1.0))).collect()
    }

    /// Adds friction to pairs under pressure, with their multipliers if these are known.
    fn rub(&mut self, multipliers: &[(u64, [f64; D])]) {
        let known =
            |id: u64| multipliers.binary_search_by_key(&id, |(id, _)| *id).map_or([0.0; D], |k| multipliers[k].1);
        let rubs = self.pressed.iter().filter(|pair| pair.friction > 0.0 && pair.force > 0.0);
        self.rubbing = rubs.map(|pair| pair.rubbing(known(pair.id), self.sticking)).collect();
    }

    /// Moves the limits of friction only half way from those of the previous round.
    fn damp(&mut self, before: &[Rubbing<D>]) {
        for rub in &mut self.rubbing {
            let old = before.binary_search_by_key(&rub.id, |rub| rub.id).map_or(0.0, |k| before[k].most);
            rub.limit(0.5 * (old + rub.most));
        }
    }

    /// The largest changes of the friction forces of pairs that stick, and of all others, since the search that has just ended. They are fractions of
    /// the largest possible friction force.
    fn change_of_friction(&self, before: &[Rubbing<D>]) -> [f64; 2] {
        let (mut most, mut changes): (f64, _) = (0.0, [0.0; 2]);
        for rub in &self.rubbing {
            let slip = rub.slip(&self.moved);
            let force = rub.force(&slip);
            let old = before.binary_search_by_key(&rub.id, |rub| rub.id).ok().map(|k| &before[k]);
            let was = old.map_or([0.0; D], |old| old.force(&old.slip(&self.moved)));
            let slides = old.is_none_or(|old| old.slides(&old.slip(&self.moved))) || rub.slides(&slip);
            most = rub.most.larger(most);
            let change = &mut changes[usize::from(slides)];
            *change = (0..D).map(|d| (force[d] - was[d]).abs()).sum::<f64>().larger(*change);
        }
        changes.map(|change| if change > 0.0 { change / most } else { 0.0 })
    }
}
