//! Where points are.

/// The positions of points [m].
pub trait Positions<const D: usize> {
    /// The position of a point [m].
    fn at(&self, point: u32) -> [f64; D];
}

impl<const D: usize> Positions<D> for [[f64; D]] {
    #[inline(always)]
    fn at(&self, point: u32) -> [f64; D] {
        self[point as usize]
    }
}

/// Points at a time within a step in which they move with constant velocities.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Within<'a, const D: usize> {
    /// The positions at the start and at the end of the step [m].
    pub(crate) ends: [&'a [[f64; D]]; 2],
    /// The time, as a fraction of the step.
    pub(crate) time: f64,
}

impl<const D: usize> Positions<D> for Within<'_, D> {
    #[inline(always)]
    fn at(&self, point: u32) -> [f64; D] {
        let [from, to] = self.ends.map(|ends| &ends[point as usize]);
        core::array::from_fn(|d| from[d] + self.time * (to[d] - from[d]))
    }
}
