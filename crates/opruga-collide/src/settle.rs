//! The result of the impulses of a substep: the motion of points, and the energies that contact took and gave.

use crate::impulses::part;
use crate::least_parts;
use crate::lists;
use crate::touching::{Touching, acting};
use crate::vector::{dot, subtract};
use opruga_core::threads;
use opruga_math::Lane;

/// The fraction of the thickness by which pairs may be too close before they are separated. Pairs that are too close by no more than this fraction do
/// not overlap with their surfaces themselves. The errors that sweeps leave are smaller, so they do not move points.
pub(crate) const OVERLAP: f64 = 0.01;

impl<const D: usize> Touching<D> {
    /// Moves the points with their new velocities, and separates overlapping ones.
    pub(crate) fn settle(&mut self, h: f64) {
        for row in &self.rows {
            let (points, weights) = row.on(&self.spread);
            let presses = row.normal_impulse > 0.0 && !row.of_obstacle;
            // Without branches, because the processor cannot predict which points have a weight.
            points.iter().zip(weights).for_each(|(p, w)| self.touched[*p as usize] |= presses & (*w != 0.0));
        }
        self.recover(h);
        let Touching { before: [before, _], after: [free, _], end, moved, v, touched, inverse_mass, coupled, .. } =
            self;
        end.resize(free.len(), [0.0; D]);
        let size = threads::part_size(end.len(), self.threads, least_parts::POINTS);
        let parts = end.chunks_mut(size).zip(moved.chunks_mut(size)).enumerate();
        threads::each_in_pool(parts, |(part, (end, moved))| {
            let first = part * size;
            end.copy_from_slice(&free[first..first + end.len()]);
            for (k, (end, moved)) in end.iter_mut().zip(moved.iter_mut()).enumerate() {
                let p = first + k;
                if !touched[p] {
                    continue;
                }
                for d in (0..D).filter(|d| inverse_mass[p][*d] > 0.0) {
                    end[d] = before[p][d] + (h * v[p][d] + moved[d]);
                }
                if coupled.body_of(p as u32).is_none() {
                    *moved = [0.0; D];
                }
            }
        });
        self.stay_in_front(h);
        self.lead_carried();
    }

    /// Moves touched points back in front of the obstacles that hold them. Sweeps leave small errors, and a point that ends behind a thin obstacle would
    /// be held on its other side from then on.
    fn stay_in_front(&mut self, h: f64) {
        for row in self.rows.iter().filter(|row| row.of_obstacle) {
            let p = row.points[0] as usize;
            if !self.touched[p] {
                continue;
            }
            let (start, end) = (&self.before[0][p], &mut self.end[p]);
            let travel: [f64; D] = core::array::from_fn(|d| end[d] - start[d] - h * row.carry[d]);
            let gap = row.gap + dot(&travel, &row.normal);
            if gap < 0.0 {
                for d in (0..D).filter(|d| self.inverse_mass[p][*d] > 0.0) {
                    end[d] -= gap * row.normal[d];
                }
            }
        }
    }

    /// Moves carried points to the end positions of the nodes that carry them.
    pub(crate) fn lead_carried(&mut self) {
        self.surface.follow(&mut self.end);
        for (p, carrier) in self.surface.carried() {
            self.touched[p] = carrier.nodes.iter().any(|node| self.touched[*node as usize]);
        }
    }

    /// Records the energies that contact took and gave, and moves the points.
    pub(crate) fn book(&mut self, h: f64) {
        let touched = &self.touched;
        let is_node = |p: &u32| self.surface.carrier_of(*p).is_none();
        self.changed.extend((0..self.surface.points() as u32).filter(|p| touched[*p as usize]).filter(is_node));
        for (k, p) in self.changed.iter().enumerate() {
            self.number[*p as usize] = k as u32;
        }
        self.losses.clear();
        lists::resize(&mut self.losses, self.changed.len(), [0.0; 4]);
        self.find_stopped(h);
        for row in &self.rows {
            if row.normal_impulse == 0.0 {
                continue;
            }
            for (p, weight) in acting(&self.spread, row) {
                if !self.touched[p as usize] {
                    continue;
                }
                let (v0, v1) = (&self.before[1][p as usize], &self.v[p as usize]);
                // The velocity of a coupled point is already the mean velocity of the step. A point of a coupled body that responds by itself in
                // this step, and a point that an obstacle has stopped in the free motion, get their impulses at the end of the step.
                let is_at_end = self.coupled.has(p) || self.stopped[self.number[p as usize] as usize];
                let v0 = match (self.coupled.body_of(p), is_at_end) {
                    (Some(_), _) => v1,
                    (None, true) => &self.after[1][p as usize],
                    (None, false) => v0,
                };
                let (mut along, mut across, mut carried) = (0.0, 0.0, 0.0);
                for d in 0..D {
                    let mean = 0.5 * (v0[d] + v1[d]) - row.carry[d];
                    let [n, t] = [row.normal_impulse * row.normal[d], row.friction_impulse[d]];
                    along -= weight * n * mean;
                    across -= weight * t * mean;
                    carried += weight * (n + t) * row.carry[d];
                    if self.inverse_mass[p as usize][d] == 0.0 {
                        // A pin restores the motion that a contact takes from its node.
                        carried -= weight * (n + t) * 0.5 * (v0[d] + v1[d]);
                    }
                }
                let sum = &mut self.losses[self.number[p as usize] as usize];
                for (sum, more) in sum.iter_mut().zip([along, across, carried]) {
                    *sum += more;
                }
            }
        }
        self.zones.book(&self.before[1], &self.v, &self.inverse_mass, &self.number, &mut self.losses);
        for (k, (p, losses)) in self.changed.iter().zip(&mut self.losses).enumerate() {
            let p = *p as usize;
            // With these integrators, the energy changes along the path h v₁ cancel in the sum over steps.
            let telescopes = self.kicked_by_first_force.get(self.surface.body[p] as usize) == Some(&true);
            for d in (0..D).filter(|_| self.coupled.body_of(p as u32).is_none()) {
                let inverse = self.inverse_mass[p][d];
                if inverse > 0.0 {
                    let (v0, free, v1) = (self.before[1][p][d], self.after[1][p][d], self.v[p][d]);
                    let travel = self.end[p][d] - self.before[0][p][d];
                    let by_velocity = if self.coupled.has(p as u32) || self.stopped[k] {
                        self.after[0][p][d] - self.before[0][p][d]
                    } else if telescopes {
                        h * v1
                    } else {
                        0.5 * h * (v0 + v1)
                    };
                    losses[3] += (free - v0) / (inverse * h) * (by_velocity - travel);
                    self.after[0][p][d] = self.end[p][d];
                    self.after[1][p][d] = v1;
                }
            }
        }
    }

    /// Finds the changed points that obstacles hold at the end of the free motion. The ledger already contains the work of these obstacles.
    fn find_stopped(&mut self, h: f64) {
        self.stopped.clear();
        self.stopped.resize(self.changed.len(), false);
        for row in self.rows.iter().filter(|row| row.of_obstacle) {
            let p = row.points[0] as usize;
            let [start, end] = [&self.before[0][p], &self.after[0][p]];
            let travel: [f64; D] = core::array::from_fn(|d| end[d] - start[d] - h * row.carry[d]);
            if self.touched[p] && row.gap + dot(&travel, &row.normal) < OVERLAP * self.thickest[0] {
                self.stopped[self.number[p] as usize] = true;
            }
        }
    }

    /// Computes displacements that separate overlapping pairs.
    fn recover(&mut self, h: f64) {
        let most = self.laws.recovery_speed * h;
        for row in &self.rows {
            row.on(&self.spread).0.iter().for_each(|p| self.moved[*p as usize] = [0.0; D]);
        }
        // Rows that no point connects are processed separately, so that nothing moves because of overlaps elsewhere.
        for ends in self.turns.starts().windows(2) {
            let rows = &self.rows[ends[0] as usize..ends[1] as usize];
            self.wanted.clear();
            let mut overlap = false;
            for row in rows {
                let u = subtract(&row.mean(&self.spread, &self.v), &row.carry);
                let end = row.gap + h * dot(&u, &row.normal);
                // Sweeps that end early leave smaller overlaps than this.
                overlap |= end < -OVERLAP * self.thickest[0];
                self.wanted.push(if row.of_obstacle { -end } else { (-end).smaller(most) });
            }
            if !overlap {
                continue;
            }
            // Displacements move every point by itself, even in bodies that respond to impulses as a whole.
            self.masses.clear();
            self.masses.extend(rows.iter().map(|row| row.mass_apart(&self.spread, &self.inverse_mass)));
            let wanted = (&self.wanted[..], &self.masses[..]);
            part(rows, &self.spread, &self.inverse_mass, wanted, &mut self.multipliers, &mut self.moved, most);
            for (row, _) in rows.iter().zip(&self.multipliers).filter(|(_, multiplier)| **multiplier > 0.0) {
                acting(&self.spread, row).for_each(|(p, _)| self.touched[p as usize] = true);
            }
        }
    }
}
