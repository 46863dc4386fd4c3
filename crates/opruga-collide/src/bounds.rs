//! The space through which the nodes of a tile moved in a step.

use opruga_core::contacts::Moved;
use opruga_math::{Lane, Pack, Strip, WIDTH, Work, lanes};

/// The box around all nodes of a tile, before and after their free motion.
pub(crate) struct Bounds<'a, 'm, const D: usize> {
    pub(crate) moved: &'a Moved<'m, D>,
    pub(crate) used: usize,
}

impl<const D: usize> Work for Bounds<'_, '_, D> {
    type Output = [[f64; D]; 2];
    #[inline(always)]
    fn run<P: Pack>(self) -> [[f64; D]; 2] {
        let length = self.moved.range.len();
        let mut x = [&[] as &[f64]; D];
        for d in 0..D {
            x[d] = &self.moved.x.0[d];
        }
        let x = Strip::<D>::new(&x, self.moved.range.start, length);
        let before = Strip::<D>::new(&self.moved.before, 0, length);
        // Four ranges are kept, for positions before and after and for even and odd packs, so that their computations do not
        // wait for one another.
        let mut ranges = [Range::<P, D>::empty(), Range::empty(), Range::empty(), Range::empty()];
        let mut k = 0;
        while k + 2 * WIDTH <= self.used {
            ranges[0].include(&lanes!(P, d => x.load::<P>(d, k)));
            ranges[1].include(&lanes!(P, d => before.load::<P>(d, k)));
            ranges[2].include(&lanes!(P, d => x.load::<P>(d, k + WIDTH)));
            ranges[3].include(&lanes!(P, d => before.load::<P>(d, k + WIDTH)));
            k += 2 * WIDTH;
        }
        while k < self.used {
            // Padding is replaced by the first node of the pack.
            let nodes = P::first(self.used - k);
            for (range, column) in [(0, &x), (1, &before)] {
                ranges[range].include(&lanes!(P, d => {
                    let pack = column.load::<P>(d, k);
                    P::select(nodes, pack, P::splat(pack.to_array()[0]))
                }));
            }
            k += WIDTH;
        }
        let mut out = [[f64::INFINITY; D], [f64::NEG_INFINITY; D]];
        for d in 0..D {
            for range in &ranges {
                let (low, high) = (range.low[d].to_array(), range.high[d].to_array());
                for l in 0..WIDTH {
                    out[0][d] = low[l].smaller(out[0][d]);
                    out[1][d] = high[l].larger(out[1][d]);
                }
            }
        }
        out
    }
}

/// The smallest and largest coordinates.
struct Range<P, const D: usize> {
    low: [P; D],
    high: [P; D],
}

impl<P: Pack, const D: usize> Range<P, D> {
    #[inline(always)]
    fn empty() -> Self {
        Range { low: [P::splat(f64::INFINITY); D], high: [P::splat(f64::NEG_INFINITY); D] }
    }
    #[inline(always)]
    fn include(&mut self, x: &[P; D]) {
        for d in 0..D {
            self.low[d] = x[d].smaller(self.low[d]);
            self.high[d] = x[d].larger(self.high[d]);
        }
    }
}
