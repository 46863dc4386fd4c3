//! Runs in which the second node of each pair has the next index after the first node: outlines, rows of grids. This is the
//! inner loop of springs and of gas in the plane.

use super::PairLaw;
use super::lone::Lone;
use crate::state::{Layout, Parameter, View};
use crate::tile::{Tile, Weight};
use opruga_math::{Lane, Pack, RepeatStrip, Simd, Strip, StripMut, WIDTH, Work, lanes};

/// A run of pairs (a + k, a + k + 1), in indices.
pub(super) struct Chain<'a, 'v, L, const D: usize> {
    pub(super) law: L,
    pub(super) view: &'a View<'v, D>,
    /// The index of the first node of the first pair.
    pub(super) a: usize,
    /// The index of the first pair's parameters.
    pub(super) first: usize,
    /// The number of indices of all pairs.
    pub(super) length: usize,
    pub(super) layout: Layout,
    /// The separate pair that follows the run.
    pub(super) closing: Option<Lone>,
}

/// One case of the loop.
struct Walk<'a, 'c, 'v, 't, L, const D: usize, const BATCH: bool, const FRESH: bool, const SAME: bool> {
    chain: &'a Chain<'c, 'v, L, D>,
    // This is a reference. Numbers stored next to pointers would be read together with the pointers, and such a read waits
    // until all these values have been written.
    weight: &'a Weight<'a, D>,
    tile: &'a mut Tile<'t, D>,
    power: &'a mut [f64; WIDTH],
}
impl<L: PairLaw<D>, const D: usize, const BATCH: bool, const FRESH: bool, const SAME: bool> Work
    for Walk<'_, '_, '_, '_, L, D, BATCH, FRESH, SAME>
{
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let mut power = P::load(self.power);
        self.chain.walk::<P, BATCH, FRESH, SAME>(self.weight, self.tile, &mut power);
        if let Some(closing) = self.chain.closing {
            let layout = if BATCH { Layout::Batch } else { Layout::Single };
            Lone { layout, ..closing }.add::<P, L, D>(self.chain.law, self.chain.view, self.tile, &mut power);
        }
        power.store(self.power);
    }
}

impl<L: PairLaw<D>, const D: usize> Chain<'_, '_, L, D> {
    /// Adds the forces of the run to a tile.
    ///
    /// One loop serves all cases; the case is known at compile time.
    pub(super) fn add(&self, simd: Simd, tile: &mut Tile<D>, power: &mut [f64; WIDTH]) {
        match self.layout {
            Layout::Single => self.add_laid_out::<false>(simd, tile, power),
            Layout::Batch => self.add_laid_out::<true>(simd, tile, power),
        }
    }

    fn add_laid_out<const BATCH: bool>(&self, simd: Simd, tile: &mut Tile<D>, power: &mut [f64; WIDTH]) {
        let weight = &Weight { mass: &Parameter::NONE, gravity: [0.0; D] };
        if L::UNIFORM {
            tile.settle(simd);
            return simd.run(Walk::<_, _, BATCH, false, true> { chain: self, weight, tile, power });
        }
        // If the forces of the tile have not been written yet, and all of its nodes belong to the run, the loop writes the
        // weight too.
        let [_, second, third] = self.law.parameters();
        // Padding follows the last node.
        let nodes = tile.range.end.min(self.view.nodes * self.layout.stride());
        let whole = self.a <= tile.range.start && nodes <= self.a + self.length + self.layout.stride();
        match tile.weight {
            Some(weight) if whole && second.repeats() && third.repeats() && weight.mass.repeats() => {
                tile.weight = None;
                simd.run(Walk::<_, _, BATCH, true, true> { chain: self, weight: &weight, tile, power });
            }
            _ => {
                tile.settle(simd);
                simd.run(Walk::<_, _, BATCH, false, false> { chain: self, weight, tile, power });
            }
        }
    }

    /// The loop over the pairs. Node p receives the force of its own pair and the force of the previous pair. The latter force is in the pack of
    /// forces shifted by one node.
    ///
    /// `FRESH`: there is a weight, equal for all nodes, and the forces of the tile are overwritten instead of added. `SAME`: all
    /// but the first parameter of the law are equal for all pairs, and are read once.
    #[inline(always)]
    fn walk<P: Pack, const BATCH: bool, const FRESH: bool, const SAME: bool>(
        &self,
        weight: &Weight<D>,
        tile: &mut Tile<D>,
        power: &mut P,
    ) {
        let &Chain { law, view, a, first, length, .. } = self;
        let next = if BATCH { WIDTH } else { 1 };
        let (start, end) = (tile.range.start.max(a), tile.range.end.min(a + length + next));
        // The pack before the first node supplies the force of the pair that ends at the first node.
        let lead = if start > a { if BATCH || start >= a + WIDTH { WIDTH } else { start - a } } else { 0 };
        let packed = (end - start).next_multiple_of(WIDTH);
        let x = Strip::<D>::new(&view.x, start - lead, lead + packed + next);
        let v = Strip::<D>::new(&view.v, start - lead, lead + packed + next);
        let [p0, p1, p2] = law.parameters();
        let from = first + start - lead - a;
        let until = lead + packed;
        let (p0, p1, p2) = (p0.strip(from, until), p1.strip(from, until), p2.strip(from, until));
        let mut force = StripMut::<D>::new(tile.force.each_mut().map(|f| &mut **f), start - tile.range.start, packed);

        let same: [P; 2] = if L::UNIFORM { law.uniform() } else { [p1.load(0), p2.load(0)] };
        let mass: P = weight.mass.load(0);
        let weight = lanes!(P, i => mass * P::splat(weight.gravity[i]));

        let mut previous = [P::zero(); D];
        if lead > 0 {
            let d = lanes!(P, i => x.load::<P>(i, 0) - x.load::<P>(i, next));
            let rate =
                if L::DAMPED { lanes!(P, i => v.load::<P>(i, 0) - v.load::<P>(i, next)) } else { [P::zero(); D] };
            let [second, third] = if L::UNIFORM { same } else { [p1.load(0), p2.load(0)] };
            let (f, _) = law.force([p0.load(0), second, third], d, rate, law.ahead(d));
            previous = f;
            if lead < WIDTH {
                // In this case, the pair that ends at the first node is not the last one of the pack.
                for i in 0..D {
                    let last = f[i].to_array()[lead - 1];
                    previous[i] = P::splat(last);
                }
            }
        }
        // No pair begins at the last node of the run. The nodes of the loop end where the run or the tile ends. Later nodes
        // belong to another tile, whose forces may already be stored next to these.
        let (pairs, nodes) = (a + length - start, end - start);
        let mut walker =
            Walker { law, next, lead, packed, x, v, p0, p1, p2, same, weight, previous, ahead: [P::zero(); MOST_LAG] };
        for n in 0..lag::<P>() {
            if n * WIDTH < packed {
                walker.look_ahead(n, n * WIDTH);
            }
        }
        let whole = pairs.min(nodes) / WIDTH * WIDTH;
        for k in (0..whole).step_by(WIDTH) {
            *power += walker.step::<BATCH, FRESH, SAME, false>(k, pairs, nodes, &mut force);
        }
        if whole < packed {
            *power += walker.step::<BATCH, FRESH, SAME, true>(whole, pairs, nodes, &mut force);
        }
    }
}

/// The data of the loop along a chain.
struct Walker<'a, P, L, const D: usize> {
    law: L,
    next: usize,
    lead: usize,
    /// The number of indices of the nodes, filled up to whole packs.
    packed: usize,
    x: Strip<'a, D>,
    v: Strip<'a, D>,
    p0: RepeatStrip<'a>,
    p1: RepeatStrip<'a>,
    p2: RepeatStrip<'a>,
    /// The second and third parameters and the weight, if they are the same everywhere.
    same: [P; 2],
    weight: [P; D],
    /// The forces of the previous pack.
    previous: [P; D],
    /// The results of [`PairLaw::ahead`] for the coming packs.
    ahead: [P; MOST_LAG],
}

/// The largest number of packs between [`PairLaw::ahead`] and the force. A processor looks ahead by itself, but not for as long as a root and a
/// division take, because operations that wait for these two fill its queues.
const MOST_LAG: usize = 2;

/// The number of packs between [`PairLaw::ahead`] and the force: one is enough if a pack takes many registers.
const fn lag<P: Pack>() -> usize {
    if P::PARTS > 2 { 1 } else { MOST_LAG }
}

impl<P: Pack, L: PairLaw<D>, const D: usize> Walker<'_, P, L, D> {
    /// Calls [`PairLaw::ahead`] for the pack that starts at `k`.
    #[inline(always)]
    fn look_ahead(&mut self, into: usize, k: usize) {
        if L::AHEAD {
            let at = self.lead + k;
            for part in 0..P::PARTS {
                let (x, there) = (&self.x, at + self.next);
                let d = lanes!(P::Part, i => x.load_part::<P>(i, at, part) - x.load_part::<P>(i, there, part));
                self.ahead[into].set_part(part, self.law.ahead(d));
            }
        }
    }

    /// Processes the pack of nodes that starts at `k`; returns the power of their pairs. `EDGE`: not all eight nodes exist.
    #[inline(always)]
    fn step<const BATCH: bool, const FRESH: bool, const SAME: bool, const EDGE: bool>(
        &mut self,
        k: usize,
        pairs: usize,
        nodes: usize,
        force: &mut StripMut<D>,
    ) -> P {
        let at = self.lead + k;
        let ahead = self.ahead[0];
        for n in 1..lag::<P>() {
            self.ahead[n - 1] = self.ahead[n];
        }
        let later = k + lag::<P>() * WIDTH;
        if later < self.packed {
            self.look_ahead(lag::<P>() - 1, later);
        }
        // The pack is processed part by part, so that the data of a law fit into the registers of any processor.
        let mut f = [P::zero(); D];
        let mut dissipated = P::zero();
        for part in 0..P::PARTS {
            let (x, v, there) = (&self.x, &self.v, at + self.next);
            let d = lanes!(P::Part, i => x.load_part::<P>(i, at, part) - x.load_part::<P>(i, there, part));
            let rate = lanes!(P::Part, i => if L::DAMPED {
                v.load_part::<P>(i, at, part) - v.load_part::<P>(i, there, part)
            } else {
                P::Part::zero()
            });
            let (p1, p2) = if SAME {
                (self.same[0].part(part), self.same[1].part(part))
            } else {
                (self.p1.load_part::<P>(at, part), self.p2.load_part::<P>(at, part))
            };
            let (force, loss) = self.law.force([self.p0.load_part::<P>(at, part), p1, p2], d, rate, ahead.part(part));
            for i in 0..D {
                f[i].set_part(part, force[i]);
            }
            dissipated.set_part(part, loss);
        }
        if EDGE {
            let real = P::first(pairs.saturating_sub(k));
            for i in 0..D {
                f[i] = P::select(real, f[i], P::zero());
            }
            dissipated = P::select(P::both(real, P::first(nodes - k)), dissipated, P::zero());
        }
        for i in 0..D {
            let arriving = if BATCH { self.previous[i] } else { f[i].after(self.previous[i]) };
            let old = if FRESH { self.weight[i] } else { force.load::<P>(i, k) };
            let sum = old + f[i];
            let mut sum = if L::SECOND < 0.0 { sum - arriving } else { sum + arriving };
            if EDGE {
                sum = P::select(P::first(nodes - k), sum, old);
            }
            force.store(i, k, sum);
        }
        self.previous = f;
        dissipated
    }
}
