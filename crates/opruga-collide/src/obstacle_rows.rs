//! Contacts of points with obstacles, in addition to contacts between bodies.

use crate::least_parts;
use crate::lists;
use crate::row::{OBSTACLE_BIT, Row};
use crate::touching::{Obstacles, Touching};
use crate::vector::{length, subtract};
use opruga_core::contacts::Touch;
use opruga_core::threads;

impl<const D: usize> Touching<D> {
    /// Adds the contacts of obstacles with the points of all present contacts from the index `first` on. These contacts prevent bodies from pushing
    /// the points through obstacles.
    pub(crate) fn hold_points(&mut self, first: usize, h: f64, obstacles: Option<Obstacles<'_, D>>) {
        let Some(obstacles) = obstacles else { return };
        self.asks.resize(self.surface.points(), false);
        for row in &self.rows[first..] {
            let (points, weights) = row.on(&self.spread);
            // Without branches, because the processor cannot predict which points have a weight.
            points.iter().zip(weights).for_each(|(p, weight)| self.asks[*p as usize] |= *weight != 0.0);
        }
        self.asked.clear();
        for p in 0..self.asks.len() {
            let asks = std::mem::take(&mut self.asks[p]) && !std::mem::replace(&mut self.known[p], true);
            // Coupled bodies account for obstacles themselves when they solve for their end positions.
            if asks && !self.surface.is_of_obstacle(p as u32) && self.coupled.body_of(p as u32).is_none() {
                self.asked.push(p as u32);
            }
        }
        let parts = threads::parts(self.asked.len(), self.threads, least_parts::CONTACTS);
        let mut lists = std::mem::take(&mut self.obstacle_rows);
        let of_parts = threads::empty_lists(&mut lists, parts.len());
        of_parts[0] = std::mem::take(&mut self.rows);
        let touching = &*self;
        threads::each_in_pool(parts.zip(of_parts.iter_mut()), |(range, rows)| {
            touching.asked[range].iter().for_each(|p| touching.hold_point(*p, h, obstacles, rows));
        });
        of_parts.iter_mut().for_each(|rows| lists::append(&mut self.rows, rows));
        self.obstacle_rows = lists;
    }

    /// Adds the contacts between obstacles and one point.
    fn hold_point(&self, p: u32, h: f64, obstacles: Obstacles<'_, D>, rows: &mut Vec<Row<D>>) {
        let (x0, x1) = (self.before[0][p as usize], self.after[0][p as usize]);
        let travel = length(&subtract(&x1, &x0));
        let reach = travel + h * length(&self.v[p as usize]) + self.margin;
        obstacles(p, &x0, &x1, reach, &mut |touch: Touch<D>| {
            let id = OBSTACLE_BIT | u64::from(p) << 31 | touch.surface as u64;
            let mut row = Row::new(id, ([p; 4], [1.0, 0.0, 0.0, 0.0]), touch.normal, touch.friction);
            row.gap = touch.gap_before;
            row.carry = touch.velocity;
            row.target = if row.gap > 0.0 { -row.gap / h } else { 0.0 };
            row.of_obstacle = true;
            if row.can_move(&self.spread, &self.inverse_mass) {
                lists::push(rows, row);
            }
        });
    }
}
