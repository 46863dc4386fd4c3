//! Energies and powers of a share, summed in an order that does not depend on the layout.

use opruga_core::state::Layout;
use opruga_math::{WIDTH, sum_in_fixed_order};

/// Sums over elements whose bits do not depend on the layout.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Totals {
    /// Energy [J]: for one body, eight partial sums in the first row; for eight bodies, a column for
    /// each.
    pub(super) energy: [[f64; WIDTH]; WIDTH],
    /// Power of damping [W].
    pub(super) power: [[f64; WIDTH]; WIDTH],
}

/// One total for one body, or one total for each of eight bodies.
pub(super) fn total(layout: Layout, partial: &[[f64; WIDTH]; WIDTH]) -> [f64; WIDTH] {
    let mut out = [0.0; WIDTH];
    match layout {
        Layout::Single => out[0] = sum_in_fixed_order(&partial[0]),
        Layout::Batch => {
            for l in 0..WIDTH {
                out[l] = sum_in_fixed_order(&core::array::from_fn(|k| partial[k][l]));
            }
        }
    }
    out
}
