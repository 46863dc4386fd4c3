//! Separate pairs: pairs that close an outline after its chain, and pairs that follow no other pair.

use super::PairLaw;
use super::parameters::law_parameters;
use crate::state::{At, Layout, View, load};
use crate::tile::Tile;
use opruga_math::{Pack, WIDTH, Work, lanes};

/// A pair of one body, or the same pair of eight.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lone {
    /// The indices of its nodes, and of its parameters.
    pub(super) a: usize,
    pub(super) b: usize,
    pub(super) number: usize,
    pub(super) layout: Layout,
}

impl Lone {
    /// Adds the force of the pair to the forces on its nodes in a tile.
    #[inline(always)]
    pub(super) fn add<P: Pack, L: PairLaw<D>, const D: usize>(
        &self,
        law: L,
        view: &View<D>,
        tile: &mut Tile<D>,
        power: &mut P,
    ) {
        let dissipated = match self.layout {
            Layout::Single => self.add_of_one::<P, L, D>(law, view, tile),
            Layout::Batch => self.add_of_eight::<P, L, D>(law, view, tile),
        };
        if L::DAMPED && tile.range.contains(&self.a) {
            *power += dissipated;
        }
    }

    /// Adds the force of a pair of one body. Returns its power in the first of eight partial sums.
    #[inline(always)]
    fn add_of_one<P: Pack, L: PairLaw<D>, const D: usize>(&self, law: L, view: &View<D>, tile: &mut Tile<D>) -> P {
        let &Lone { a, b, number, .. } = self;
        let mut d = [0.0; D];
        let mut rate = [0.0; D];
        for i in 0..D {
            d[i] = view.x[i][a] - view.x[i][b];
            if L::DAMPED {
                rate[i] = view.v[i][a] - view.v[i][b];
            }
        }
        let [p0, p1, p2] = law.parameters();
        let parameters = if L::UNIFORM {
            let [second, third] = law.uniform::<P>();
            [0.0, second.to_array()[0], third.to_array()[0]]
        } else {
            [p0.at(number), p1.at(number), p2.at(number)]
        };
        let (force, dissipated) = law.force(parameters, d, rate, law.ahead(d));
        for (node, sign) in [(a, 1.0), (b, L::SECOND)] {
            if !tile.range.contains(&node) {
                continue;
            }
            // Whole packs are written, because whole packs are read soon afterwards.
            let (first, lane) = ((node - tile.range.start) / WIDTH * WIDTH, node % WIDTH);
            let (until, before) = (P::first(lane + 1), P::first(lane));
            for i in 0..D {
                let pack = &mut tile.force[i][first..first + WIDTH];
                let old = P::load(pack);
                let new = P::select(until, old + P::splat(sign * force[i]), old);
                P::select(before, old, new).store(pack);
            }
        }
        P::select(P::first(1), P::splat(dissipated), P::zero())
    }

    #[inline(always)]
    fn add_of_eight<P: Pack, L: PairLaw<D>, const D: usize>(&self, law: L, view: &View<D>, tile: &mut Tile<D>) -> P {
        let &Lone { a, b, number, .. } = self;
        let (xa, xb): ([P; D], [P; D]) = (load(&view.x, a), load(&view.x, b));
        let d = lanes!(P, i => xa[i] - xb[i]);
        let rate = if L::DAMPED {
            let (va, vb): ([P; D], [P; D]) = (load(&view.v, a), load(&view.v, b));
            lanes!(P, i => va[i] - vb[i])
        } else {
            [P::zero(); D]
        };
        let (force, dissipated) = law.force(law_parameters(&law, At::Run(number)), d, rate, law.ahead(d));
        for (node, minus) in [(a, false), (b, L::SECOND < 0.0)] {
            if !tile.range.contains(&node) {
                continue;
            }
            let first = node - tile.range.start;
            for i in 0..D {
                let pack = &mut tile.force[i][first..first + WIDTH];
                let old = P::load(pack);
                (if minus { old - force[i] } else { old + force[i] }).store(pack);
            }
        }
        dissipated
    }
}

/// A separate pair, as a piece of work.
pub(super) struct Alone<'a, 'v, 't, L, const D: usize> {
    pub(super) lone: Lone,
    pub(super) law: L,
    pub(super) view: &'a View<'v, D>,
    pub(super) tile: &'a mut Tile<'t, D>,
    pub(super) power: &'a mut [f64; WIDTH],
}
impl<L: PairLaw<D>, const D: usize> Work for Alone<'_, '_, '_, L, D> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let mut power = P::load(self.power);
        self.lone.add::<P, L, D>(self.law, self.view, self.tile, &mut power);
        power.store(self.power);
    }
}
