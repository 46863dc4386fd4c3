//! The impulses of the previous substep, from which the present one starts.

use crate::row::OBSTACLE_BIT;
use crate::touching::Touching;

/// The impulse of a contact in the previous substep.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LastImpulse<const D: usize> {
    /// Its bodies in one number, and the key of its features. Impulses are sorted by both.
    pub(crate) bodies: u64,
    pub(crate) id: u64,
    /// The impulses along and across its normal [N s].
    pub(crate) along: f64,
    pub(crate) across: [f64; D],
}

/// The number of contacts of points with obstacles that hold them.
pub(crate) const OF_OBSTACLES: u64 = u64::MAX;

/// Two bodies in one number, in the order of [`crate::body_pairs::BodyPairs::all`].
pub(crate) fn number_of([a, b]: [u32; 2]) -> u64 {
    let [a, b] = if a < b { [a, b] } else { [b, a] };
    u64::from(a) << 32 | u64::from(b)
}

impl<const D: usize> Touching<D> {
    /// The impulse of a contact between two bodies in the previous substep; `None` if it did not press.
    pub(crate) fn last_of(&self, bodies: [u32; 2], id: u64) -> Option<&LastImpulse<D>> {
        let key = (number_of(bodies), id);
        self.last.binary_search_by_key(&key, |last| (last.bodies, last.id)).ok().map(|k| &self.last[k])
    }

    /// Keeps the impulses for the next substep.
    pub(crate) fn keep_impulses(&mut self) {
        let nothing = LastImpulse { bodies: 0, id: 0, along: 0.0, across: [0.0; D] };
        self.last.clear();
        self.last.resize(self.rows.len(), nothing);
        for (row, k) in self.rows.iter().zip(self.turns.order()) {
            let bodies = self.pairs.all.get(row.pair as usize).map_or(OF_OBSTACLES, |pair| number_of(pair.bodies));
            let (id, along, across) = (row.id, row.normal_impulse, row.friction_impulse);
            self.last[*k as usize] = LastImpulse { bodies, id, along, across };
        }
        self.last.retain(|last| last.along > 0.0);
    }

    /// Applies the impulses of the previous substep. Contacts between bodies contain these impulses already; those with obstacles that hold points
    /// get them here.
    pub(crate) fn start_warm(&mut self) {
        let mut k = self.last.partition_point(|last| last.bodies < OF_OBSTACLES);
        for row in &mut self.rows {
            if row.of_obstacle {
                while self.last.get(k).is_some_and(|last| last.id < row.id) {
                    k += 1;
                }
                if let Some(last) = self.last.get(k).filter(|last| last.id == row.id) {
                    (row.normal_impulse, row.friction_impulse) = (last.along, last.across);
                }
            }
            if row.normal_impulse > 0.0 {
                let impulse = row.impulse();
                if row.coupled {
                    self.coupled.give(row.on(&self.spread), &impulse, &self.inverse_mass, &mut self.v);
                } else {
                    row.give(&self.spread, &impulse, &self.inverse_mass, &mut self.v);
                }
            }
        }
    }

    /// Calls `visit` with the pressing pairs, in the form of [`Touching::features_of`], and their impulses of the previous step
    /// along and across their normals [N s].
    pub fn visit_kept(&self, mut visit: impl FnMut([u32; 5], f64, [f64; D])) {
        for LastImpulse { id, along, across, .. } in &self.last {
            visit(self.features_of(*id), *along, *across);
        }
    }

    /// Lets the next step start from these impulses.
    pub fn keep(&mut self, pairs: impl Iterator<Item = (u64, f64, [f64; D])>) {
        let mut last = std::mem::take(&mut self.last);
        last.clear();
        last.extend(pairs.map(|(id, along, across)| {
            let [_, first, _, second, _] = self.features_of(id);
            let bodies = if id & OBSTACLE_BIT == 0 { number_of([first, second]) } else { OF_OBSTACLES };
            LastImpulse { bodies, id, along, across }
        }));
        last.sort_by_key(|last| (last.bodies, last.id));
        self.last = last;
    }
}
