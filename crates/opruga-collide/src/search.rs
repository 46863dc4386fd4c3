//! The search for all pairs that may meet in a step, whatever contact does.

use crate::body_pairs::Distances;
use crate::reach::FreeMotion;
use crate::touching::{Touching, Trouble};

impl<const D: usize> Touching<D> {
    /// The positions of the points between which contact adds to their motion in a step [m].
    pub(crate) fn free_ends(&self) -> [&[[f64; D]]; 2] {
        // As long as the contact forces are not those of the equilibrium, the free motion alone could take bodies at rest anywhere.
        [&self.before[0], if self.at_once { &self.before[0] } else { &self.after[0] }]
    }

    fn distances(&self) -> Distances {
        Distances { margin: (self.margin, if self.at_once { 0.0 } else { STEPS }), thickest: self.thickest }
    }

    /// Begins a step of h [s]: computes the positions that points may take in it.
    pub(crate) fn begin_search(&mut self, h: f64) {
        let mut reach = std::mem::take(&mut self.reach);
        if reach.fit(&self.surface, &self.before[0]) {
            self.pairs.clear();
        }
        let recovery = if self.at_once { self.thickest[0] + self.margin } else { h * self.laws.recovery_speed };
        // Bodies at rest have no free motion, but their forces move them between two corrections.
        let unknown = if self.at_once { recovery } else { 0.0 };
        let motion = FreeMotion { ends: self.free_ends(), recovery, unknown, is_repeated: self.is_begun };
        reach.begin(motion, self.threads);
        self.pairs.follow(&mut reach, self.margin);
        self.reach = reach;
        self.include_neighbours();
        let mut reach = std::mem::take(&mut self.reach);
        self.pairs.find_approaches(&mut reach);
        let motion = FreeMotion { ends: self.free_ends(), recovery, unknown, is_repeated: true };
        reach.sweep(motion, self.threads);
        (self.reach, self.is_begun) = (reach, true);
    }

    fn include_neighbours(&mut self) {
        let distances = self.distances();
        let laws = &self.laws;
        self.pairs.include_neighbours(&self.surface, &self.reach, distances, |a, b| laws.meet(a, b));
    }

    /// Searches for candidates if the present ones may not include all pairs that meet in this step.
    pub(crate) fn search(&mut self) -> Result<(), Trouble> {
        self.include_neighbours();
        let mut distances = self.distances();
        let (mut reach, mut pairs) = (std::mem::take(&mut self.reach), std::mem::take(&mut self.pairs));
        pairs.activate(&reach, self.margin);
        reach.find_stale(&self.surface, distances.margin);
        let mut is_complete = pairs.are_complete(&reach, distances.margin);
        let searches = u64::from(!is_complete);
        if !is_complete {
            is_complete = pairs.search(&self.surface, &mut reach, self.threads, distances, self.most);
        }
        if !is_complete {
            // If there are too many pairs for later steps, only those of this step are searched for.
            reach.look_at_all();
            pairs.forget_features();
            distances.margin.1 = 0.0;
            is_complete = pairs.search(&self.surface, &mut reach, self.threads, distances, self.most);
        }
        if !is_complete {
            reach.forget();
            pairs.forget_features();
        }
        pairs.set_limits(&reach);
        (self.reach, self.pairs) = (reach, pairs);
        self.counts.searches += searches;
        if is_complete { Ok(()) } else { Err(Trouble::TooMany) }
    }

    /// Extends the displacements of points to their end positions; returns whether any had to be extended.
    pub(crate) fn grow(&mut self) -> bool {
        if self.at_once {
            self.touched.fill(true);
        }
        let mut reach = std::mem::take(&mut self.reach);
        let [_, free] = self.free_ends();
        let any = reach.grow(&self.surface, &self.touched, [free, &self.end]);
        self.reach = reach;
        any
    }
}

/// The number of later steps that a search for candidates of fast points covers. The number changes only the run time. With half of it, the searches of
/// a heap of a thousand balls take a quarter longer. With twice as many steps, a frame of 27 cubes takes a sixth longer, because it has more
/// candidates.
const STEPS: f64 = 16.0;
