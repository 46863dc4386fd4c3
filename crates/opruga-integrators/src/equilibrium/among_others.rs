//! A step of statics whose end is found together with the ends of other bodies.

use super::{COMPLETE, LOAD, SPEC, to_rest};
use crate::implicit::balance::Balance;
use crate::implicit::rule::Rule;
use crate::implicit::workspace::Workspace;
use opruga_core::integrator::Amplification;
use opruga_core::system::System;

/// The rule of a step under the whole load. If necessary, the search holds nodes at their present positions.
#[derive(Clone, Copy, Debug)]
pub(super) struct AmongOthers;

impl<const D: usize> Rule<D> for AmongOthers {
    const NAME: &'static str = SPEC.kind;
    const TRAPEZOID: bool = false;
    fn amplification(&self, omega: f64, _c: f64, _h: f64) -> Amplification {
        to_rest(omega)
    }
    fn begin(&self, _system: &System<D>, workspace: &mut Workspace<D>, h: f64) -> Balance {
        workspace.y.fill(0.0);
        workspace.z.fill(0.0);
        Balance { sigma: 0.0, beta: 0.0, theta: 1.0, time: h, h, load: 1.0, impulse: 1.0, echo: 0.0 }
    }
    fn end(&self, _system: &System<D>, workspace: &mut Workspace<D>, _balance: &Balance, _h: f64) {
        workspace.u1.copy_from_slice(&workspace.u);
        workspace.v1.fill(0.0);
    }
    fn remember(&self, system: &mut System<D>, _workspace: &Workspace<D>, _h: f64) {
        system.history.set(LOAD, 1.0);
        system.history.set(COMPLETE, true);
    }
}
