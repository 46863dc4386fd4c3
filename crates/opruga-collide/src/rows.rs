//! The pairs of a step, found on one thread or several.

use crate::close_pair::ClosePair;
use crate::finder::Finder;
use crate::found::Found;
use crate::gap::Gap;
use crate::impact::key;
use crate::law::PairLaw;
use crate::least_parts;
use crate::lists;
use crate::spread::Spread;
use crate::touching::Touching;
use crate::unclear::Unclear;
use core::ops::Range;
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
    fn divide(&mut self, all: &mut Vec<Found<D>>) {
        let Touching { pairs, pieces, threads, .. } = self;
        pieces.clear();
        let active = || pairs.all.iter().enumerate().filter(|(_, pair)| pair.is_active);
        let length = active().map(|(_, pair)| pair.range(0).len() + pair.range(1).len()).sum();
        let size = threads::part_size(length, *threads, least_parts::CANDIDATES);
        for (number, pair) in active() {
            for list in 0..2 {
                let Range { start: mut first, end: last } = pair.range(list);
                while first < last {
                    let mut end = last.min(first + size);
                    while list == 0 && end < last && pairs.features[0][end][0] == pairs.features[0][end - 1][0] {
                        end += 1;
                    }
                    pieces.push((number as u32, list, first..end));
                    first = end;
                }
            }
        }
        let (mut parts, mut first, mut candidates) = (0, 0, 0);
        for (k, (.., range)) in pieces.iter().enumerate() {
            candidates += range.len();
            if candidates >= size || k + 1 == pieces.len() {
                if all.len() <= parts {
                    all.push(Found::default());
                }
                all[parts].part = first..k + 1;
                (parts, first, candidates) = (parts + 1, k + 1, 0);
            }
        }
        all.resize_with(parts.max(1), Found::default);
        if parts == 0 {
            all[0].part = 0..0;
        }
    }

    /// Adds the pairs found in a part of the candidates to the pairs of the previous parts.
    fn take_in(&mut self, found: &mut Found<D>) {
        let first = self.spread.append(&mut found.spread);
        if first > 0 {
            let rows = found.rows.iter_mut().chain(&mut found.inactive);
            rows.for_each(|row| row.spread[0] += first);
            found.heads.iter_mut().for_each(|head| Spread::shift(head, first));
        }
        lists::append(&mut self.rows, &mut found.rows);
        lists::append(&mut self.watched, &mut found.watched);
        lists::append(&mut self.inactive, &mut found.inactive);
        lists::append(&mut self.heads, &mut found.heads);
        for list in 0..2 {
            lists::append(&mut self.close[list], &mut found.close[list]);
        }
        for ((pair, list, range), least) in self.pieces[found.part.clone()].iter().zip(&found.least) {
            if *range == self.pairs.all[*pair as usize].range(*list) {
                self.pairs.set_least(*pair as usize, *list, *least);
            }
        }
        for list in 0..2 {
            for Unclear { candidate, pair, distance, .. } in &found.unclear[list] {
                self.pairs.note(&self.reach, *pair as usize, list, *candidate as usize, *distance);
            }
        }
        for (pair, candidate, distance) in &found.notes {
            self.pairs.note(&self.reach, *pair as usize, 0, *candidate, *distance);
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
        (features, pair): ([u32; 2], u32),
        with_facet: bool,
    ) -> ClosePair<D> {
        let own = gap.gap - law.thickness;
        let target = if own > 0.0 || self.at_once { -own / h } else { 0.0 };
        let Gap { points, weights, normal, .. } = *gap;
        let (thickness, friction) = (law.thickness, law.friction);
        let id = key(features, with_facet);
        ClosePair { id, pair, points, weights, normal, gap: own, thickness, friction, target }
    }
}
