//! The matrix of one model by itself: for those who measure it, at the speed that integrators have.

use crate::BlockMatrix;
use opruga_core::potential::{Definiteness, Potential};
use opruga_core::state::View;

impl BlockMatrix<3> {
    /// Fills the matrix with the second derivatives of one model in space. It is compiled here, with the loops that are to be
    /// measured, and not with the program that calls it.
    #[inline(never)]
    pub fn assemble_one(&mut self, model: &dyn Potential<3>, view: &View<'_, 3>, scratch: &[f64], keep: Definiteness) {
        self.assemble(view.nodes, 0, |sink| model.hessian(view, scratch, keep, sink));
    }
}
