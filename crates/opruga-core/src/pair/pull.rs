//! Pairs outside of long runs, evaluated node by node.

use super::parameters::law_parameters;
use super::{PairLaw, PairTable};
use crate::state::{At, Layout, View, load};
use crate::tile::Tile;
use opruga_math::{Pack, WIDTH, Work, lanes};

/// Pairs outside of long runs.
pub(super) struct Gather<'a, 'v, 't, L, const D: usize> {
    pub(super) table: &'a PairTable,
    pub(super) pull: &'a Pull,
    pub(super) law: L,
    pub(super) view: &'a View<'v, D>,
    pub(super) tile: &'a mut Tile<'t, D>,
    pub(super) power: &'a mut [f64; WIDTH],
}
impl<L: PairLaw<D>, const D: usize> Work for Gather<'_, '_, '_, L, D> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let mut power = P::load(self.power);
        self.table.pull::<P, L, D>(self.pull, self.law, self.view, self.tile, &mut power);
        power.store(self.power);
    }
}

/// Tables of the pairs that are evaluated node by node: up to `width` partners of every node.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Pull {
    pub(super) width: usize,
    /// The largest number of partners of a node in each pack of nodes; later slots are empty.
    pub(super) widths: Vec<u32>,
    /// `[node / 8][slot][node % 8]`: the partner, or the node itself if there is none.
    pub(super) partner: Vec<u32>,
    /// The number of the pair, or the number of the pair without effect if there is no partner.
    pub(super) pair: Vec<u32>,
    /// `[node / 8][slot]`: whether the eight partners are consecutive, and the eight pairs too, so that they can be read at once.
    pub(super) together: Vec<bool>,
    /// The pulled pairs by number, padded to packs with the pair without effect, and their two ends.
    pub(super) loose: Vec<u32>,
    pub(super) ends: [Vec<u32>; 2],
}

/// The number of partners of a node that are processed together.
const AT_ONCE: usize = 6;

impl Pull {
    /// The number of slots that are not empty for eight indices.
    #[inline(always)]
    fn used(&self, layout: Layout, index: usize) -> usize {
        let pack = index / WIDTH;
        self.widths[if layout == Layout::Single { pack } else { pack / WIDTH }] as usize
    }

    /// The partners of eight indices in a slot, and the pairs.
    #[inline(always)]
    fn slot(&self, layout: Layout, index: usize, slot: usize) -> (At<'_>, At<'_>) {
        let pack = index / WIDTH;
        match layout {
            Layout::Single => {
                let at = (pack * self.width + slot) * WIDTH;
                let (partner, pair) = (&self.partner[at..at + WIDTH], &self.pair[at..at + WIDTH]);
                if self.together[at / WIDTH] {
                    (At::Run(partner[0] as usize), At::Run(pair[0] as usize))
                } else {
                    (At::Each(partner), At::Each(pair))
                }
            }
            Layout::Batch => {
                // A pack is one node of eight bodies.
                let at = (pack / WIDTH * self.width + slot) * WIDTH + pack % WIDTH;
                (At::Run(self.partner[at] as usize * WIDTH), At::Run(self.pair[at] as usize * WIDTH))
            }
        }
    }
}

/// The numbers of a column at eight indices.
#[inline(always)]
fn read<P: Pack>(column: &[f64], at: At) -> P {
    match at {
        At::Run(index) => P::load(&column[index..]),
        At::Each(indices) => P::gather(column, indices),
    }
}

impl PairTable {
    /// Evaluates the pulled pairs of the nodes of a tile.
    #[inline(always)]
    fn pull<P: Pack, L: PairLaw<D>, const D: usize>(
        &self,
        pull: &Pull,
        law: L,
        view: &View<D>,
        tile: &mut Tile<D>,
        power: &mut P,
    ) {
        let half = P::splat(0.5);
        for index in tile.range.clone().step_by(WIDTH) {
            let x: [P; D] = load(&view.x, index);
            let v: [P; D] = if L::DAMPED { load(&view.v, index) } else { [P::zero(); D] };
            let mut force: [P; D] = lanes!(P, i => P::load(&tile.force[i][index - tile.range.start..]));
            let width = pull.used(self.layout, index);
            for from in (0..width).step_by(AT_ONCE) {
                let slots = from..(from + AT_ONCE).min(width);
                // The slow part of the law is started for all partners first. While the processor computes it for the later
                // partners, it can already finish the first ones.
                let (mut d, mut ahead) = ([[P::zero(); D]; AT_ONCE], [P::zero(); AT_ONCE]);
                for slot in slots.clone() {
                    let (partner, _) = pull.slot(self.layout, index, slot);
                    d[slot - from] = lanes!(P, i => x[i] - read::<P>(view.x[i], partner));
                    ahead[slot - from] = law.ahead(d[slot - from]);
                }
                for slot in slots {
                    let (partner, pair) = pull.slot(self.layout, index, slot);
                    let rate = lanes!(P, i => if L::DAMPED { v[i] - read::<P>(view.v[i], partner) } else { P::zero() });
                    let (f, dissipated) =
                        law.force(law_parameters(&law, pair), d[slot - from], rate, ahead[slot - from]);
                    for i in 0..D {
                        force[i] += f[i];
                    }
                    if L::DAMPED {
                        *power += half * dissipated;
                    }
                }
            }
            for i in 0..D {
                force[i].store(&mut tile.force[i][index - tile.range.start..]);
            }
        }
    }
}
