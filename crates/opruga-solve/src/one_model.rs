//! The matrix of a single model, for measurements at the speed of the integrators.

use crate::BlockMatrix;
use opruga_core::potential::{Definiteness, Potential};
use opruga_core::state::View;

impl<const D: usize> BlockMatrix<D> {
    /// Fills the matrix with the second derivatives of one model.
    #[inline(never)]
    pub fn assemble_one(&mut self, model: &dyn Potential<D>, view: &View<'_, D>, scratch: &[f64], keep: Definiteness) {
        self.assemble(view.nodes, 0, |sink| model.hessian(view, scratch, keep, sink));
    }
}
