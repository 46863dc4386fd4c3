//! The positions of nodes within a step, as obstacles see them.

use super::balance::Balance;
use opruga_core::system::System;

/// The positions of nodes within a step, and the obstacles that they may meet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ContactQuery<'a, const D: usize> {
    pub(crate) system: &'a System<D>,
    pub(crate) x0: &'a [f64],
    pub(crate) u: &'a [f64],
    /// How far pinned axes have to move in the stage [m]; NaN for free axes.
    pub(crate) pin_displacement: &'a [f64],
    pub(crate) theta: f64,
    pub(crate) h: f64,
    pub(crate) extent: f64,
}

impl<'a, const D: usize> ContactQuery<'a, D> {
    pub(crate) fn new(
        system: &'a System<D>,
        balance: &Balance,
        [x0, u, pin_displacement]: [&'a [f64]; 3],
        extent: f64,
    ) -> ContactQuery<'a, D> {
        ContactQuery { system, x0, u, pin_displacement, theta: balance.theta, h: balance.h, extent }
    }
}
