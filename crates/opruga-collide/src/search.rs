//! The search for all pairs that may meet in a step, whatever contact does.

use crate::touching::{Touching, Trouble};

impl<const D: usize> Touching<D> {
    /// Begins a step of h [s]: computes the positions that points may take in it.
    pub(crate) fn begin_search(&mut self, h: f64) {
        let [x0, x1] = [&self.before[0], &self.after[0]];
        if self.at_once {
            // As long as the contact forces are not those of the equilibrium, the free motion alone could take bodies anywhere.
            self.reach.begin(
                &self.surface.body,
                [x0, x0],
                self.thickest[0] + self.margin,
                (self.margin, 0.0),
                self.threads,
            );
        } else {
            self.reach.begin(
                &self.surface.body,
                [x0, x1],
                h * self.laws.recovery_speed,
                (self.margin, STEPS),
                self.threads,
            );
        }
        self.clearance.follow(&self.surface, x0);
    }

    /// Searches for candidates if the present ones may not include all pairs that meet in this step.
    pub(crate) fn search(&mut self) -> Result<(), Trouble> {
        self.clearance.set_push(self.reach.body_push());
        self.search_if_necessary()?;
        self.clearance.set_limits(&self.surface, self.thickest, |_| true);
        Ok(())
    }

    fn search_if_necessary(&mut self) -> Result<(), Trouble> {
        if self.reach.is_covered() && self.clearance.covers_all(self.margin) {
            return Ok(());
        }
        self.counts.searches += 1;
        let Touching { surface, laws, reach, clearance, candidates, margin, thickest, most, .. } = self;
        candidates.threads = self.threads;
        for steps in [if self.at_once { 0.0 } else { STEPS }, 0.0] {
            reach.take_due();
            reach.widen(&surface.body, *margin, steps);
            clearance.widen(*margin, steps);
            let stale = |a: u32, b: u32| {
                if a == b { clearance.is_due(a) } else { reach.is_stale(a) || reach.is_stale(b) }
            };
            let own = |p: u32| clearance.own_box(surface, p);
            let meet = |a, b| laws.meet(a, b);
            if candidates.refresh(surface, &reach.found_in, own, *thickest, *most, meet, stale) {
                reach.found();
                clearance.take(surface, candidates, *margin);
                return Ok(());
            }
            // If there are too many pairs for later steps, only those of this step are searched for.
            reach.look_at_all();
            clearance.forget_own();
        }
        reach.forget();
        Err(Trouble::TooMany)
    }

    /// Extends the boxes of points to their end positions; returns whether any box had to be extended.
    pub(crate) fn grow(&mut self) -> bool {
        let Touching { surface, reach, touched, after: [free, _], before: [from, _], end, margin, at_once, .. } = self;
        if *at_once {
            touched.fill(true);
            return reach.grow(&surface.body, touched, [from, end], *margin);
        }
        reach.grow(&surface.body, touched, [free, end], *margin)
    }
}

/// The number of later steps that a search for candidates of fast points covers. A search costs about as much as the
/// computation of the gaps in eight steps.
const STEPS: f64 = 8.0;
