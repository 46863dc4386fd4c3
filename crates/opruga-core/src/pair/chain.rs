//! Runs whose second nodes are the next ones: outlines, rows of grids. The inner loop of springs and of gas in the plane.

use super::PairLaw;
use crate::state::View;
use crate::tile::{Tile, Weight};
use opruga_math::{Lane, Pack, RepeatStrip, Strip, StripMut, WIDTH, lanes};

/// A run of pairs (a + k, a + k + 1), in places.
pub(super) struct Chain<'a, 'v, L, const D: usize> {
    pub(super) law: L,
    pub(super) view: &'a View<'v, D>,
    /// The first place of the first node.
    pub(super) a: usize,
    /// The place of the first pair among the parameters.
    pub(super) first: usize,
    /// Places of all pairs.
    pub(super) length: usize,
}

impl<L: PairLaw<D>, const D: usize> Chain<'_, '_, L, D> {
    /// Adds the forces of the run to a tile, or begins its forces with the weight and them.
    ///
    /// One loop serves all cases; which of them is the case is known to the compiler.
    #[inline(always)]
    pub(super) fn add<P: Pack, const BATCH: bool>(&self, weight: Option<Weight<D>>, tile: &mut Tile<D>, power: &mut P) {
        let [_, second, third] = self.law.parameters();
        let repeats = second.repeats() && third.repeats();
        match weight {
            Some(weight) if repeats && weight.mass.repeats() => {
                self.walk::<P, BATCH, true, true>(Some(weight), tile, power)
            }
            Some(weight) => self.walk::<P, BATCH, true, false>(Some(weight), tile, power),
            None if repeats => self.walk::<P, BATCH, false, true>(None, tile, power),
            None => self.walk::<P, BATCH, false, false>(None, tile, power),
        }
    }

    /// The loop. Node p receives the force of its own pair and that of the pair before it, which is the pack of forces
    /// moved up by one node.
    ///
    /// `FRESH`: there is a weight, and the forces of the tile are written and not added to. `SAME`: all but the first
    /// parameter of the law, and the masses, are the same for all pairs.
    #[inline(always)]
    fn walk<P: Pack, const BATCH: bool, const FRESH: bool, const SAME: bool>(
        &self,
        weight: Option<Weight<D>>,
        tile: &mut Tile<D>,
        power: &mut P,
    ) {
        let &Chain { law, view, a, first, length } = self;
        let next = if BATCH { WIDTH } else { 1 };
        let (start, end) = (tile.range.start.max(a), tile.range.end.min(a + length + next));
        // The pack before the first node supplies the force of the pair that ends there.
        let lead = if start > a { if BATCH || start >= a + WIDTH { WIDTH } else { start - a } } else { 0 };
        let packed = (end - start).next_multiple_of(WIDTH);
        let x = Strip::<D>::new(&view.x, start - lead, lead + packed + WIDTH);
        let v = Strip::<D>::new(&view.v, start - lead, lead + packed + WIDTH);
        let [p0, p1, p2] = law.parameters();
        let from = first + start - lead - a;
        let until = lead + packed;
        let (p0, p1, p2) = (p0.strip(from, until), p1.strip(from, until), p2.strip(from, until));
        let mut force = StripMut::<D>::new(tile.force.each_mut().map(|f| &mut **f), start - tile.range.start, packed);
        let (same1, same2): (P, P) = (p1.load(0), p2.load(0));
        let masses = weight.map(|w| w.mass.strip(start, packed));
        let gravity = match weight {
            Some(weight) => weight.gravity,
            None => [0.0; D],
        };
        let mut same_weight = [P::zero(); D];
        if FRESH
            && SAME
            && let Some(masses) = masses
        {
            same_weight = lanes!(P, i => masses.load::<P>(0) * P::splat(gravity[i]));
        }

        let mut previous = [P::zero(); D];
        if lead > 0 {
            let d = lanes!(P, i => x.load::<P>(i, 0) - x.load::<P>(i, next));
            let rate =
                if L::DAMPED { lanes!(P, i => v.load::<P>(i, 0) - v.load::<P>(i, next)) } else { [P::zero(); D] };
            let (f, _) = law.force([p0.load(0), p1.load(0), p2.load(0)], d, rate);
            previous = f;
            if lead < WIDTH {
                // The pair before the first node is not the last of the pack.
                for i in 0..D {
                    let last = f[i].to_array()[lead - 1];
                    previous[i] = P::splat(last);
                }
            }
        }
        // Pairs end before the last node; nodes end with the run or with the tile, and those behind it belong to another
        // tile, whose forces may wait next door.
        let (pairs, nodes) = (a + length - start, end - start);
        let here = lanes!(P, i => x.load::<P>(i, lead));
        let rate_here = lanes!(P, i => if L::DAMPED { v.load::<P>(i, lead) } else { P::zero() });
        let mut walker = Walker {
            law,
            next,
            lead,
            x,
            v,
            p0,
            p1,
            p2,
            same1,
            same2,
            masses,
            gravity,
            same_weight,
            previous,
            here,
            rate_here,
        };
        let whole = pairs.min(nodes) / WIDTH * WIDTH;
        for k in (0..whole).step_by(WIDTH) {
            *power += walker.step::<BATCH, FRESH, SAME, false>(k, pairs, nodes, &mut force);
        }
        if whole < packed {
            *power += walker.step::<BATCH, FRESH, SAME, true>(whole, pairs, nodes, &mut force);
        }
    }
}

impl<L: PairLaw<D>, const D: usize> Chain<'_, '_, L, D> {
    /// Adds the forces of a run whose law is linear to a tile: node p receives the force of a pair from node p − 1 to
    /// node p + 1; beyond the ends of the run the node itself takes the place of the one that is not there.
    #[inline(always)]
    pub(super) fn add_linear<P: Pack>(&self, stride: usize, tile: &mut Tile<D>) {
        let &Chain { law, view, a, length, .. } = self;
        let end_of_run = a + length + stride;
        let (start, end) = (tile.range.start.max(a), tile.range.end.min(end_of_run));
        let (packed, nodes) = ((end - start).next_multiple_of(WIDTH), end - start);
        // From the node before the first on, if there is one.
        let lead = WIDTH.min(start);
        let x = Strip::<D>::new(&view.x, start - lead, lead + packed + WIDTH);
        let [p0, p1, p2] = law.parameters();
        let parameters: [P; 3] = [p0.load(0), p1.load(0), p2.load(0)];
        let mut force = StripMut::<D>::new(tile.force.each_mut().map(|f| &mut **f), start - tile.range.start, packed);
        for k in (0..packed).step_by(WIDTH) {
            let mut f = [P::zero(); D];
            if start + k > a && start + k + WIDTH + stride <= end_of_run && k + WIDTH <= nodes {
                if P::WHOLE {
                    let at = lead + k;
                    let d = lanes!(P, i => if stride == 1 {
                        let (here, next) = (x.load::<P>(i, at), x.load::<P>(i, at + WIDTH));
                        here.after(x.load::<P>(i, at - WIDTH)) - here.ahead_of(next)
                    } else {
                        x.load::<P>(i, at - WIDTH) - x.load::<P>(i, at + WIDTH)
                    });
                    let (sum, _) = law.force(parameters, d, [P::zero(); D]);
                    for i in 0..D {
                        f[i] = force.load::<P>(i, k) + sum[i];
                        force.store(i, k, f[i]);
                    }
                    continue;
                }
                for part in 0..P::PARTS {
                    let d = lanes!(P::Part, i =>
                        x.load_part::<P>(i, lead + k - stride, part) - x.load_part::<P>(i, lead + k + stride, part));
                    let p = [parameters[0].part(part), parameters[1].part(part), parameters[2].part(part)];
                    let (sum, _) = law.force(p, d, [P::Part::zero(); D]);
                    for i in 0..D {
                        f[i].set_part(part, force.load_part::<P>(i, k, part) + sum[i]);
                    }
                }
            } else {
                let here = lanes!(P, i => x.load::<P>(i, lead + k));
                let mut before = here;
                if start + k > a {
                    before = lanes!(P, i => x.load::<P>(i, lead + k - stride));
                } else if stride == 1 {
                    before = lanes!(P, i => here[i].after(P::splat(here[i].to_array()[0])));
                }
                let has_next = P::first((end_of_run - stride).saturating_sub(start + k));
                let behind = lanes!(P, i => P::select(has_next, x.load::<P>(i, lead + k + stride), here[i]));
                let (sum, _) = law.force(parameters, lanes!(P, i => before[i] - behind[i]), [P::zero(); D]);
                let mine = P::first(nodes - k);
                for i in 0..D {
                    let old = force.load::<P>(i, k);
                    f[i] = P::select(mine, old + sum[i], old);
                }
            }
            for i in 0..D {
                force.store(i, k, f[i]);
            }
        }
    }
}

/// What the loop along a chain needs.
struct Walker<'a, P, L, const D: usize> {
    law: L,
    next: usize,
    lead: usize,
    x: Strip<'a, D>,
    v: Strip<'a, D>,
    p0: RepeatStrip<'a>,
    p1: RepeatStrip<'a>,
    p2: RepeatStrip<'a>,
    same1: P,
    same2: P,
    masses: Option<RepeatStrip<'a>>,
    gravity: [f64; D],
    same_weight: [P; D],
    /// The forces of the pack before.
    previous: [P; D],
    /// Positions and velocities of the pack to come, where a pack is one register.
    here: [P; D],
    rate_here: [P; D],
}

impl<P: Pack, L: PairLaw<D>, const D: usize> Walker<'_, P, L, D> {
    /// The pack of nodes from `k` on; gives the power of their pairs. `EDGE`: not all eight are there.
    #[inline(always)]
    fn step<const BATCH: bool, const FRESH: bool, const SAME: bool, const EDGE: bool>(
        &mut self,
        k: usize,
        pairs: usize,
        nodes: usize,
        force: &mut StripMut<D>,
    ) -> P {
        let at = self.lead + k;
        // Part by part: what a law computes with fits the registers of any processor.
        let mut f = [P::zero(); D];
        let mut dissipated = P::zero();
        for part in 0..P::PARTS {
            let (x, v, there) = (&self.x, &self.v, at + self.next);
            let mut d = [P::Part::zero(); D];
            let mut rate = [P::Part::zero(); D];
            for i in 0..D {
                d[i] = if P::WHOLE {
                    to_next::<P, BATCH>(&mut self.here[i], x.load::<P>(i, at + WIDTH)).part(part)
                } else {
                    x.load_part::<P>(i, at, part) - x.load_part::<P>(i, there, part)
                };
                if L::DAMPED {
                    rate[i] = if P::WHOLE {
                        to_next::<P, BATCH>(&mut self.rate_here[i], v.load::<P>(i, at + WIDTH)).part(part)
                    } else {
                        v.load_part::<P>(i, at, part) - v.load_part::<P>(i, there, part)
                    };
                }
            }
            let (q1, q2) = if SAME {
                (self.same1.part(part), self.same2.part(part))
            } else {
                (self.p1.load_part::<P>(at, part), self.p2.load_part::<P>(at, part))
            };
            let (force, loss) = self.law.force([self.p0.load_part::<P>(at, part), q1, q2], d, rate);
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
            let old = match self.masses {
                Some(_) if SAME => self.same_weight[i],
                Some(masses) if FRESH => masses.load::<P>(k) * P::splat(self.gravity[i]),
                _ => force.load::<P>(i, k),
            };
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

/// The numbers of a pack less those of the next nodes; then the next pack takes its place.
#[inline(always)]
pub(super) fn to_next<P: Pack, const BATCH: bool>(here: &mut P, next: P) -> P {
    let difference = if BATCH { *here - next } else { *here - here.ahead_of(next) };
    *here = next;
    difference
}
