//! Sweeps of projected Gauss–Seidel over a set of contacts that points connect.

use crate::blocks::{Blocks, solve as solve_block};
use crate::coupled::Coupled;
use crate::row::Row;
use crate::spread::Spread;
use opruga_math::Lane;

/// Sweeps over the rows of one set.
pub(crate) struct Sweeps<'a, const D: usize> {
    pub(crate) rows: &'a mut [Row<D>],
    pub(crate) heads: &'a mut [([u32; 4], u32)],
    pub(crate) inverse_mass: &'a [[f64; D]],
    pub(crate) v: &'a mut [[f64; D]],
    pub(crate) stamps: &'a mut [u32],
    /// The number of turns so far.
    pub(crate) now: &'a mut u32,
}

impl<const D: usize> Sweeps<'_, D> {
    /// Finds the contacts that are solved together in pairs.
    pub(crate) fn find_blocks(&self, blocks: &mut Blocks) {
        blocks.find(self.rows, self.heads, self.inverse_mass);
    }

    /// Sweeps over rows whose points respond independently; returns whether any velocity changed by more than `enough` [m/s]. The impulses of a block
    /// are found together before the turn of each of its rows, which adds friction.
    pub(crate) fn sweep_alone(&mut self, backward: bool, enough: f64, blocks: &mut Blocks) -> bool {
        let turn = |blocks: &mut Blocks,
                    k: usize,
                    rows: &mut [Row<D>],
                    heads: &[([u32; 4], u32)],
                    inverse_mass: &[_],
                    v: &mut [_]| {
            let mut changed: f64 = 0.0;
            if let Some((other, coupling)) = blocks.partner(k)
                && let Ok(both) = rows.get_disjoint_mut([k, other])
            {
                changed = solve_block(both, [&heads[k].0, &heads[other].0], coupling, inverse_mass, v);
            }
            rows[k].solve(&heads[k].0, inverse_mass, v).larger(changed)
        };
        let followers =
            |blocks: &Blocks, k: usize, _: &Row<D>, heads: &[([u32; 4], u32)], visit: &mut dyn FnMut(u32)| {
                if let Some((other, _)) = blocks.partner(k) {
                    heads[other].0.iter().take(D + 1).for_each(|p| visit(*p));
                }
            };
        self.sweep(backward, enough, (blocks, &Spread::default()), turn, followers).0
    }

    /// Sweeps over rows with coupled or carried points; returns whether any velocity changed by more than `enough`, and the largest change [m/s].
    pub(crate) fn sweep_coupled(
        &mut self,
        backward: bool,
        enough: f64,
        spread: &Spread,
        coupled: &mut Coupled<D>,
    ) -> (bool, f64) {
        let turn = |coupled: &mut Coupled<D>,
                    k: usize,
                    rows: &mut [Row<D>],
                    _: &[([u32; 4], u32)],
                    inverse_mass: &[_],
                    v: &mut [_]| {
            let row = &mut rows[k];
            if row.coupled || row.spread[1] > 0 {
                return row.solve_coupled(spread, inverse_mass, coupled, v);
            }
            let points = row.points;
            row.solve(&points, inverse_mass, v)
        };
        let followers = |coupled: &Coupled<D>, _: usize, row: &Row<D>, _: &[_], visit: &mut dyn FnMut(u32)| {
            if row.coupled {
                coupled.followers(row.on(spread), visit);
            }
        };
        self.sweep(backward, enough, (coupled, spread), turn, followers)
    }

    /// Sweeps over all rows by `turn`, which gets the index of its row and returns the change of velocities [m/s]. A row is skipped as long as no velocity of its
    /// points has changed by more than `enough` since its last turn, so the cost of a sweep depends on the number of rows that still change.
    /// `followers` visits the points that respond together with the points of the row. Returns whether any velocity changed by more than `enough`,
    /// and the largest change [m/s].
    #[inline(always)]
    fn sweep<C>(
        &mut self,
        backward: bool,
        enough: f64,
        (others, spread): (&mut C, &Spread),
        turn: impl Fn(&mut C, usize, &mut [Row<D>], &[([u32; 4], u32)], &[[f64; D]], &mut [[f64; D]]) -> f64,
        followers: impl Fn(&C, usize, &Row<D>, &[([u32; 4], u32)], &mut dyn FnMut(u32)),
    ) -> (bool, f64) {
        let Sweeps { rows, heads, inverse_mass, v, stamps, now } = self;
        let (mut largest, mut changed): (f64, bool) = (0.0, false);
        for k in 0..rows.len() {
            let k = if backward { rows.len() - 1 - k } else { k };
            let (head, last) = heads[k];
            let points = spread.points_of::<D>(&head);
            if last > 0 && points.iter().all(|p| stamps[*p as usize] <= last) {
                continue;
            }
            **now += 1;
            let change = turn(others, k, rows, heads, inverse_mass, v);
            largest = change.larger(largest);
            if change > enough {
                changed = true;
                points.iter().for_each(|p| stamps[*p as usize] = **now);
                followers(others, k, &rows[k], heads, &mut |p| stamps[p as usize] = **now);
            }
            heads[k].1 = **now;
        }
        (changed, largest)
    }
}
