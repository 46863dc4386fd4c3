//! The pairs of a step, found on one thread or several.

use crate::close_pair::ClosePair;
use crate::distances::Unclear;
use crate::finder::Finder;
use crate::found::Found;
use crate::gap::Gap;
use crate::impact::key;
use crate::law::PairLaw;
use crate::least_parts;
use crate::spread::Spread;
use crate::touching::Touching;
use opruga_core::threads;

impl<const D: usize> Touching<D> {
    /// Computes the gaps of all candidates that may touch; rows are in the order of their features.
    pub(crate) fn take_gaps(&mut self, h: f64) {
        self.rows.clear();
        self.watched.clear();
        self.inactive.clear();
        self.heads.clear();
        self.spread.clear();
        self.close.iter_mut().for_each(Vec::clear);
        let mut all = std::mem::take(&mut self.found);
        self.divide(&mut all);
        self.lend_lists(&mut all[0]);
        let touching = &*self;
        threads::each_in_pool(all.iter_mut(), |found| Finder { touching, found, h }.find());
        all.iter_mut().for_each(|found| self.take_in(found));
        self.found = all;
        self.put_passing(h);
    }

    /// Divides the candidates into parts: one, or several if there are threads for them. The result does not depend on the
    /// number of parts.
    fn divide(&self, all: &mut Vec<Found<D>>) {
        let pairs = &self.candidates.vertex_facet;
        let lists = [pairs.len(), self.candidates.edge_edge.len()];
        let length = lists[0] + lists[1];
        let size = threads::part_size(length, self.threads, least_parts::CANDIDATES);
        if size >= length {
            all.resize_with(1, Found::default);
            all[0].part = lists.map(|length| 0..length);
            return;
        }
        let mut number = 0;
        for (list, length) in lists.into_iter().enumerate() {
            let mut first = 0;
            while first < length {
                let mut end = length.min(first + size);
                while list == 0 && end < length && pairs[end][0] == pairs[end - 1][0] {
                    end += 1;
                }
                if all.len() <= number {
                    all.push(Found::default());
                }
                all[number].part = [0..0, 0..0];
                all[number].part[list] = first..end;
                (first, number) = (end, number + 1);
            }
        }
        all.truncate(number);
    }

    /// Adds the pairs found in a part of the candidates to the pairs of the previous parts.
    fn take_in(&mut self, found: &mut Found<D>) {
        let first = self.spread.append(&mut found.spread);
        if first > 0 {
            let rows = found.rows.iter_mut().chain(&mut found.watched).chain(&mut found.inactive);
            rows.for_each(|row| row.spread[0] += first);
            found.heads.iter_mut().for_each(|head| Spread::shift(head, first));
        }
        append(&mut self.rows, &mut found.rows);
        append(&mut self.watched, &mut found.watched);
        append(&mut self.inactive, &mut found.inactive);
        append(&mut self.heads, &mut found.heads);
        for list in 0..2 {
            append(&mut self.close[list], &mut found.close[list]);
            for Unclear { candidate, distance, .. } in &found.unclear[list] {
                self.clearance.note(list, *candidate, *distance);
            }
        }
        for (candidate, distance) in &found.notes {
            self.clearance.note(0, *candidate, *distance);
        }
    }

    /// Lends the memory of the lists to a part of the candidates, which returns it with the pairs that it finds.
    fn lend_lists(&mut self, found: &mut Found<D>) {
        std::mem::swap(&mut self.rows, &mut found.rows);
        std::mem::swap(&mut self.watched, &mut found.watched);
        std::mem::swap(&mut self.inactive, &mut found.inactive);
        std::mem::swap(&mut self.heads, &mut found.heads);
        std::mem::swap(&mut self.close, &mut found.close);
    }

    /// A pair whose gap must not become negative within the step.
    pub(crate) fn close_pair(
        &self,
        gap: &Gap<D>,
        law: &PairLaw,
        h: f64,
        pair: [u32; 2],
        with_facet: bool,
    ) -> ClosePair<D> {
        let own = gap.gap - law.thickness;
        let target = if own > 0.0 || self.at_once { -own / h } else { 0.0 };
        let Gap { points, weights, normal, .. } = *gap;
        let (thickness, friction) = (law.thickness, law.friction);
        ClosePair { id: key(pair, with_facet), points, weights, normal, gap: own, thickness, friction, target }
    }
}

/// Moves all entries of a list to the end of another one.
pub(crate) fn append<T>(to: &mut Vec<T>, from: &mut Vec<T>) {
    if to.is_empty() {
        std::mem::swap(to, from);
    } else {
        to.append(from);
    }
}
