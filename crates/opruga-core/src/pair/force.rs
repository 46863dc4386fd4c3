//! Forces of pairs on the nodes of a tile, and sums over pairs.

use super::chain::Chain;
use super::lone::{Alone, Lone};
use super::parameters::{law_parameters, load_parameters};
use super::pull::Gather;
use super::{PairLaw, PairTable, PairTerm, Run, slot_of, within};
use crate::state::{At, Layout, OrderedSum, View, load};
use crate::tile::{TILE, Tile};
use core::ops::Range;
use opruga_math::{Pack, Simd, Strip, StripMut, WIDTH, Work, lanes};

impl PairTable {
    /// Adds the forces of all pairs on the nodes of a tile.
    pub fn add_force<L: PairLaw<D>, const D: usize>(&self, simd: Simd, law: L, view: &View<D>, tile: &mut Tile<D>) {
        let stride = self.layout.stride();
        let (start, end) = (tile.range.start, tile.range.end);
        let mut power = [0.0; WIDTH];
        // The runs that touch a tile of the plan are known. For any other range, all runs are checked.
        let numbered = start % TILE == 0 && end <= start + TILE;
        let mine = if numbered {
            &self.tile_runs[self.runs_from(start / TILE)..self.runs_from(start / TILE + 1)]
        } else {
            &[]
        };
        let count = if numbered { mine.len() } else { self.runs.len() };
        let nth = |k: usize| self.runs[if numbered { mine[k] as usize } else { k }];
        let lone = |run: Run| Lone {
            a: run.a as usize * stride,
            b: run.b as usize * stride,
            number: run.first as usize * stride,
            layout: self.layout,
        };
        let mut k = 0;
        while k < count {
            let run = nth(k);
            k += 1;
            if run.count == 1 {
                tile.settle(simd);
                simd.run(Alone { lone: lone(run), law, view, tile, power: &mut power });
                continue;
            }
            let (a, b) = (run.a as usize * stride, run.b as usize * stride);
            let (first, length) = (run.first as usize * stride, run.count as usize * stride);
            // The indices of the run whose first node is in the tile, and those whose second node is.
            let own = within(a, length, start, end);
            let other = within(b, length, start, end);
            if own.is_empty() && other.is_empty() {
                continue;
            }
            if run.b == run.a + 1 && length > WIDTH {
                // The pair that closes an outline follows its chain, in one piece of work.
                let closing = if k < count && nth(k).count == 1 { Some(lone(nth(k))) } else { None };
                k += usize::from(closing.is_some());
                Chain { law, view, a, first, length, layout: self.layout, closing }.add(simd, tile, &mut power);
                continue;
            }
            tile.settle(simd);
            if length <= WIDTH {
                let extent = [a, b, first, length];
                simd.run(Short { table: self, law, view, extent, own, other, tile, power: &mut power });
                continue;
            }
            let starts = [a, b, first];
            let parts = if other.start <= own.end && own.start <= other.end {
                [(own.start.min(other.start)..own.end.max(other.end), own, other), (0..0, 0..0, 0..0)]
            } else {
                [(own.clone(), own, 0..0), (other.clone(), 0..0, other)]
            };
            for (all, own, other) in parts {
                simd.run(Long { table: self, law, view, starts, all, own, other, tile, power: &mut power });
            }
        }
        tile.settle(simd);
        if let Some(pull) = &self.pull {
            simd.run(Gather { table: self, pull, law, view, tile, power: &mut power });
        }
        if L::DAMPED {
            for l in 0..WIDTH {
                tile.power[l] += power[l];
            }
        }
    }

    /// Evaluates a run of at most one pack.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)] // inner loop of `add_force`
    fn short<P: Pack, L: PairLaw<D>, const D: usize>(
        &self,
        law: L,
        view: &View<D>,
        [a, b, first, length]: [usize; 4],
        own: Range<usize>,
        other: Range<usize>,
        tile: &mut Tile<D>,
        power: &mut P,
    ) {
        let d = lanes!(P, i => P::load(&view.x[i][a..]) - P::load(&view.x[i][b..]));
        let rate = if L::DAMPED {
            lanes!(P, i => P::load(&view.v[i][a..]) - P::load(&view.v[i][b..]))
        } else {
            [P::zero(); D]
        };
        let (force, dissipated) = law.force(law_parameters(&law, At::Run(first)), d, rate, law.ahead(d));
        let start = tile.range.start;
        for i in 0..D {
            let into = &mut *tile.force[i];
            if own.len() == WIDTH && other.len() == WIDTH && self.layout == Layout::Batch {
                (P::load(&into[a - start..]) + force[i]).store(&mut into[a - start..]);
                let old = P::load(&into[b - start..]);
                let new = if L::SECOND < 0.0 { old - force[i] } else { old + force[i] };
                new.store(&mut into[b - start..]);
                continue;
            }
            let each = force[i].to_array();
            for k in own.clone() {
                into[a + k - start] += each[k];
            }
            for k in other.clone() {
                into[b + k - start] += L::SECOND * each[k];
            }
        }
        if L::DAMPED {
            let _ = length;
            let until = P::select(P::first(own.end), dissipated, P::zero());
            *power += P::select(P::first(own.start), P::zero(), until);
        }
    }

    /// Evaluates the indices `all` of a run once and adds the forces to the nodes of the tile.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)] // inner loop of `add_force`
    fn run<P: Pack, L: PairLaw<D>, const D: usize>(
        &self,
        law: L,
        view: &View<D>,
        [a, b, first]: [usize; 3],
        all: Range<usize>,
        own: Range<usize>,
        other: Range<usize>,
        tile: &mut Tile<D>,
        power: &mut P,
    ) {
        if all.is_empty() {
            return;
        }
        let packed = all.len().next_multiple_of(WIDTH);
        let column_length = packed + 2 * WIDTH;
        tile.slots.grow(D * column_length);
        // One strip that starts at the lower of the two end nodes serves both ends, so that few pointers occupy registers.
        let base = a.min(b);
        let (to_a, to_b) = (a - base, b - base);
        let span = packed + to_a.max(to_b);
        let x = Strip::<D>::new(&view.x, base + all.start, span);
        let v = Strip::<D>::new(&view.v, base + all.start, span);
        let [p0, p1, p2] = law.parameters();
        let (p0, p1, p2) = (
            p0.strip(first + all.start, packed),
            p1.strip(first + all.start, packed),
            p2.strip(first + all.start, packed),
        );
        // Slot columns begin with a spare pack, so that a shifted read stays inside.
        let mut slots = StripMut::<1>::new([&mut **tile.slots], 0, D * column_length);
        // Indices of the run, relative to `all.start`, whose first node belongs to the tile.
        let (low, high) = (own.start.saturating_sub(all.start), own.end.saturating_sub(all.start));
        for k in (0..packed).step_by(WIDTH) {
            let (at_a, at_b) = (k + to_a, k + to_b);
            let d = lanes!(P, i => x.load::<P>(i, at_a) - x.load::<P>(i, at_b));
            let rate =
                if L::DAMPED { lanes!(P, i => v.load::<P>(i, at_a) - v.load::<P>(i, at_b)) } else { [P::zero(); D] };
            let [second, third] = if L::UNIFORM { law.uniform() } else { [p1.load(k), p2.load(k)] };
            let (force, dissipated) = law.force([p0.load(k), second, third], d, rate, law.ahead(d));
            for i in 0..D {
                slots.store(0, i * column_length + WIDTH + k, force[i]);
            }
            if L::DAMPED {
                // The power of a pair is counted in the tile of its first node.
                if k >= low && k + WIDTH <= high {
                    *power += dissipated;
                } else {
                    let before = low.saturating_sub(k).min(WIDTH);
                    let until = high.saturating_sub(k).min(WIDTH);
                    let kept = P::select(P::first(until), dissipated, P::zero());
                    *power += P::select(P::first(before), P::zero(), kept);
                }
            }
        }
        // Indices that are first nodes, and that are second nodes; most are both.
        let firsts = a + own.start..a + own.end;
        let seconds = b + other.start..b + other.end;
        let both = firsts.start.max(seconds.start)..firsts.end.min(seconds.end);
        let start = tile.range.start;
        for i in 0..D {
            let column = &tile.slots[i * column_length..(i + 1) * column_length];
            let into = &mut *tile.force[i];
            // Stretches of first nodes only, of second nodes only, and of both.
            let overlap = !(both.is_empty() || own.is_empty() || other.is_empty());
            let alone = if overlap {
                [
                    (firsts.start..both.start, a, 1.0),
                    (both.end..firsts.end, a, 1.0),
                    (seconds.start..both.start, b, L::SECOND),
                    (both.end..seconds.end, b, L::SECOND),
                ]
            } else {
                [(firsts.clone(), a, 1.0), (0..0, a, 1.0), (seconds.clone(), b, L::SECOND), (0..0, b, 1.0)]
            };
            for (range, node, sign) in alone {
                if !range.is_empty() {
                    let slot = slot_of(range.start, node, all.start);
                    add_slots::<P, false>(into, range.start - start, range.len(), column, slot, slot, sign);
                }
            }
            if overlap {
                let (slot_a, slot_b) = (slot_of(both.start, a, all.start), slot_of(both.start, b, all.start));
                add_slots::<P, true>(into, both.start - start, both.len(), column, slot_a, slot_b, L::SECOND);
            }
        }
    }

    /// Sums a function of both ends over all pairs, with bits that do not depend on the layout.
    #[inline(always)]
    pub fn sum<P: Pack, T: PairTerm<P, D>, const D: usize>(&self, view: &View<D>, term: T) -> P {
        match self.layout {
            Layout::Single => self.sum_laid_out::<P, T, D, false>(view, term),
            Layout::Batch => self.sum_laid_out::<P, T, D, true>(view, term),
        }
    }

    /// Computes the sum of [`Self::sum`] for a layout known at compile time, so that the partial sums stay in registers.
    #[inline(always)]
    fn sum_laid_out<P: Pack, T: PairTerm<P, D>, const D: usize, const BATCH: bool>(
        &self,
        view: &View<D>,
        term: T,
    ) -> P {
        let layout = if BATCH { Layout::Batch } else { Layout::Single };
        let stride = layout.stride();
        let mut sum = OrderedSum::<P>::new(layout);
        for run in &self.runs {
            let (a, b) = (run.a as usize * stride, run.b as usize * stride);
            let (first, length) = (run.first as usize * stride, run.count as usize * stride);
            let packed = length.next_multiple_of(WIDTH);
            let base = a.min(b);
            let (to_a, to_b) = (a - base, b - base);
            let x = Strip::<D>::new(&view.x, base, packed + to_a.max(to_b));
            let [p0, p1, p2] = term.parameters();
            let (p0, p1, p2) = (p0.strip(first, packed), p1.strip(first, packed), p2.strip(first, packed));
            for eight in (0..packed).step_by(if BATCH { WIDTH * WIDTH } else { WIDTH }) {
                // With bodies side by side, every pack has its own partial sum, one of eight.
                for j in 0..if BATCH { WIDTH } else { 1 } {
                    let k = eight + j * WIDTH;
                    if BATCH && k >= packed {
                        break;
                    }
                    let from = lanes!(P, i => x.load::<P>(i, k + to_a));
                    let to = lanes!(P, i => x.load::<P>(i, k + to_b));
                    let value = term.of([p0.load(k), p1.load(k), p2.load(k)], from, to);
                    if BATCH {
                        sum.add_to(j, value);
                    } else {
                        sum.add(k, length, value);
                    }
                }
            }
        }
        if let Some(pull) = &self.pull {
            match layout {
                Layout::Single => {
                    for k in (0..pull.loose.len()).step_by(WIDTH) {
                        let (a, b) = (&pull.ends[0][k..k + WIDTH], &pull.ends[1][k..k + WIDTH]);
                        let xa = lanes!(P, i => P::gather(view.x[i], a));
                        let xb = lanes!(P, i => P::gather(view.x[i], b));
                        sum.add(
                            k,
                            pull.loose.len(),
                            term.of(load_parameters(&term.parameters(), At::Each(&pull.loose[k..k + WIDTH])), xa, xb),
                        );
                    }
                }
                Layout::Batch => {
                    for (k, &pair) in pull.loose.iter().enumerate() {
                        let (a, b) = (pull.ends[0][k] as usize * WIDTH, pull.ends[1][k] as usize * WIDTH);
                        let at = load_parameters(&term.parameters(), At::Run(pair as usize * WIDTH));
                        sum.add(k * WIDTH, usize::MAX, term.of(at, load(&view.x, a), load(&view.x, b)));
                    }
                }
            }
        }
        sum.total()
    }
}

/// A run of at most one pack.
struct Short<'a, 'v, 't, L, const D: usize> {
    table: &'a PairTable,
    law: L,
    view: &'a View<'v, D>,
    extent: [usize; 4],
    own: Range<usize>,
    other: Range<usize>,
    tile: &'a mut Tile<'t, D>,
    power: &'a mut [f64; WIDTH],
}
impl<L: PairLaw<D>, const D: usize> Work for Short<'_, '_, '_, L, D> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let mut power = P::load(self.power);
        self.table.short::<P, L, D>(self.law, self.view, self.extent, self.own, self.other, self.tile, &mut power);
        power.store(self.power);
    }
}

/// A run of more than one pack.
struct Long<'a, 'v, 't, L, const D: usize> {
    table: &'a PairTable,
    law: L,
    view: &'a View<'v, D>,
    starts: [usize; 3],
    all: Range<usize>,
    own: Range<usize>,
    other: Range<usize>,
    tile: &'a mut Tile<'t, D>,
    power: &'a mut [f64; WIDTH],
}
impl<L: PairLaw<D>, const D: usize> Work for Long<'_, '_, '_, L, D> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let mut power = P::load(self.power);
        let Long { law, view, starts, all, own, other, tile, .. } = self;
        self.table.run::<P, L, D>(law, view, starts, all, own, other, tile, &mut power);
        power.store(self.power);
    }
}

/// Adds slots to `count` forces that start at `at`. Each force receives one slot times `sign`. If `BOTH` is set, it receives the slot of the first
/// node and then `sign` times the slot of the second node. Later forces do not change.
#[inline(always)]
fn add_slots<P: Pack, const BOTH: bool>(
    into: &mut [f64],
    at: usize,
    count: usize,
    slots: &[f64],
    first: usize,
    second: usize,
    sign: f64,
) {
    let packed = count.next_multiple_of(WIDTH);
    let first = Strip::<1>::new(&[slots], first, packed);
    let second = Strip::<1>::new(&[slots], if BOTH { second } else { 0 }, packed);
    let mut into = StripMut::<1>::new([into], at, packed);
    for k in (0..packed).step_by(WIDTH) {
        let old: P = into.load(0, k);
        let slot: P = first.load(0, k);
        let new = if BOTH {
            let other: P = second.load(0, k);
            if sign < 0.0 { (old + slot) - other } else { (old + slot) + other }
        } else if sign < 0.0 {
            old - slot
        } else {
            old + slot
        };
        if k + WIDTH <= count {
            into.store(0, k, new);
        } else {
            into.store(0, k, P::select(P::first(count - k), new, old));
        }
    }
}
