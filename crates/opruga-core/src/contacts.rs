//! The interface of rigid obstacles to a system: one pass over the nodes after they were moved freely.

use crate::state::{Columns, Layout, Parameter};
use core::fmt::Debug;
use core::ops::Range;
use opruga_math::{Simd, WIDTH};

/// The nodes of a tile, after a free move, on which obstacles may act.
#[derive(Debug)]
pub struct Moved<'a, const D: usize> {
    /// The indices of the tile.
    pub range: Range<usize>,
    /// The first index that belongs to no node. Indices from this one to the end of the last pack are padding.
    pub padding_start: usize,
    /// Positions before the step: `before[d][p - range.start]` [m].
    pub before: [&'a [f64]; D],
    /// Positions after the free motion [m], by index.
    pub x: &'a mut Columns<D>,
    /// Velocities after the free motion [m/s], by index.
    pub v: &'a mut Columns<D>,
    /// Mean force of the step on each node, m Δv/h: `force[d][p - range.start]` [N].
    pub force: [&'a [f64]; D],
    /// Mass of each node [kg].
    pub mass: &'a Parameter,
    /// Whether the columns hold one body, or eight side by side.
    pub layout: Layout,
    /// Time at the end of the step [s].
    pub time: f64,
    /// The length of the substep [s].
    pub h: f64,
    /// Energy that contact dissipated along the normal [J], eight partial sums.
    pub loss_contact: &'a mut [f64; WIDTH],
    /// Energy that friction dissipated [J], eight partial sums.
    pub loss_friction: &'a mut [f64; WIDTH],
    /// Work done on the body by obstacles that move [J], eight partial sums.
    pub work_colliders: &'a mut [f64; WIDTH],
    /// Energy that appears because nodes are moved back to the surface [J], eight partial sums: Σ F·(h v̄ − Δx), the difference
    /// between the work along the mean velocity and along the displacement.
    pub work_correction: &'a mut [f64; WIDTH],
}

/// A surface next to a node at the end of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch<const D: usize> {
    /// The number of the surface, which never changes.
    pub surface: usize,
    /// The distance of the node minus the thickness; negative inside [m].
    pub gap: f64,
    /// The distance before the step, in the frame of the obstacle [m].
    pub gap_before: f64,
    /// The unit normal out of the obstacle.
    pub normal: [f64; D],
    /// The position to which a node that sticks to the obstacle would move [m].
    pub carried: [f64; D],
    /// Velocity of the obstacle at the node [m/s].
    pub velocity: [f64; D],
    /// Coulomb's coefficient.
    pub friction: f64,
    /// Ratio of normal speeds after and before an impact.
    pub restitution: f64,
    /// The normal speed up to which there is no bounce [m/s].
    pub rest_speed: f64,
    /// The size below which a gap counts as rounding [m].
    pub rounding: f64,
}

/// The obstacles that a block of bodies may meet within a frame.
pub trait Contacts<const D: usize>: Send + Sync + Debug {
    /// Applies non-penetration, restitution and friction to the nodes of a tile. Returns the lanes that contain a node on which
    /// it acted, one bit each: lane l contains the indices that are l modulo eight.
    fn resolve(&self, simd: Simd, moved: &mut Moved<D>) -> u8;
    /// Visits every surface that a node reaches when it moves from `from` to `to` [m] in the step of length `h` that ends at `time` [s]: surfaces
    /// whose gap at the end is at most `reach` [m], and surfaces that the node has crossed.
    ///
    /// Implicit integrators call this method, because they constrain nodes while they solve for the end of the step.
    fn touch(
        &self,
        _from: &[f64; D],
        _to: &[f64; D],
        _time: f64,
        _h: f64,
        _reach: f64,
        _visit: &mut dyn FnMut(Touch<D>),
    ) {
    }
}
