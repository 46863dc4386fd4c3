//! The boxes that the bodies of an island pass through.

use opruga_core::state::{Columns, Layout};
use opruga_core::system::System;
use opruga_math::{Lane, Pack, Strip, WIDTH, Work, lanes};

/// A box, given by its lowest and highest corner [m].
pub(crate) type Bounds<const D: usize> = [[f64; D]; 2];

/// The minimum and maximum of vectors of nodes. A single body has them in eight parts, a batch has them for each lane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Path<const D: usize> {
    box_of_lanes: [[[f64; WIDTH]; D]; 2],
    /// Zero while all numbers are finite.
    unsound: [f64; WIDTH],
}

impl<const D: usize> Default for Path<D> {
    fn default() -> Self {
        let nowhere = [[[f64::INFINITY; WIDTH]; D], [[f64::NEG_INFINITY; WIDTH]; D]];
        Path { box_of_lanes: nowhere, unsound: [0.0; WIDTH] }
    }
}

impl<const D: usize> Path<D> {
    /// Includes the vectors of all nodes.
    pub(crate) fn include(&mut self, system: &System<D>, vectors: &Columns<D>) {
        let end = system.nodes * system.layout.stride();
        system.simd.run(Include { path: self, vectors, end });
    }

    /// Includes the vector of the node at an index into the columns.
    pub(crate) fn include_one(&mut self, index: usize, x: &[f64; D]) {
        let (lane, [low, high]) = (index % WIDTH, &mut self.box_of_lanes);
        for d in 0..D {
            low[d][lane] = x[d].smaller(low[d][lane]);
            high[d][lane] = x[d].larger(high[d][lane]);
        }
    }

    /// Whether all numbers were finite.
    pub(crate) fn is_sound(&self) -> bool {
        self.unsound.iter().all(|sum| *sum == 0.0)
    }

    /// The box of a body.
    pub(crate) fn of(&self, layout: Layout, lane: usize) -> Bounds<D> {
        let [low, high] = &self.box_of_lanes;
        match layout {
            Layout::Single => [
                low.map(|lanes| lanes.into_iter().fold(f64::INFINITY, Lane::smaller)),
                high.map(|lanes| lanes.into_iter().fold(f64::NEG_INFINITY, Lane::larger)),
            ],
            Layout::Batch => [low.map(|lanes| lanes[lane]), high.map(|lanes| lanes[lane])],
        }
    }
}

struct Include<'a, const D: usize> {
    path: &'a mut Path<D>,
    vectors: &'a Columns<D>,
    end: usize,
}

impl<const D: usize> Work for Include<'_, D> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let packed = self.end.next_multiple_of(WIDTH);
        let vectors = Strip::<D>::new(&self.vectors.slices(), 0, packed);
        let Path { box_of_lanes: [low, high], unsound } = self.path;
        let mut sum = P::load(&unsound[..]);
        let (mut least, mut most) = (lanes!(P, d => P::load(&low[d])), lanes!(P, d => P::load(&high[d])));
        for k in (0..packed).step_by(WIDTH) {
            for d in 0..D {
                let mut x: P = vectors.load(d, k);
                if k + WIDTH > self.end {
                    // Entries after the last node repeat the first node of the pack.
                    x = P::select(P::first(self.end - k), x, P::splat(x.to_array()[0]));
                }
                // Zero times a finite number is zero; zero times infinity or NaN is not.
                sum += x * P::zero();
                (least[d], most[d]) = (x.smaller(least[d]), x.larger(most[d]));
            }
        }
        *unsound = sum.to_array();
        for d in 0..D {
            (low[d], high[d]) = (least[d].to_array(), most[d].to_array());
        }
    }
}

/// A box enlarged by a distance [m] on all sides.
pub(crate) fn wider<const D: usize>([low, high]: Bounds<D>, distance: f64) -> Bounds<D> {
    [low.map(|c| c - distance), high.map(|c| c + distance)]
}

/// Whether two boxes have a point in common.
pub(crate) fn overlap<const D: usize>(a: &Bounds<D>, b: &Bounds<D>) -> bool {
    (0..D).all(|d| a[0][d] <= b[1][d] && b[0][d] <= a[1][d])
}
