//! Estimates the memory that an implicit integrator needs for one body, before anything is built.
//!
//! The numbers come from measured runs (docs/performance.md, "Memory").

use super::settings::{Settings, Solver};
use opruga_core::memory::Counts;
use opruga_math::Lane;

/// The number of vectors of a step: with a matrix, and without one.
const VECTORS: f64 = 38.0;
const VECTORS_WITHOUT_MATRIX: f64 = 30.0;

/// The number of copies of the matrix, in units of its blocks. The packed form and the preconditioners are included. The first
/// number is for exact minimisers, the second for real time.
const COPIES: f64 = 1.9;
const COPIES_IN_REAL_TIME: f64 = 1.6;

/// The memory of a body whose models couple this many pairs of nodes [bytes].
pub(crate) fn of_body<const D: usize>(settings: &Settings, counts: &Counts, couplings: f64) -> f64 {
    let Counts { nodes, is_bulk, .. } = *counts;
    let dimension = D as f64;
    let vector = 8.0 * dimension * nodes;
    if settings.solver == Solver::MatrixFree {
        return VECTORS_WITHOUT_MATRIX * vector;
    }
    let block = 8.0 * dimension * dimension;
    // This includes the blocks below the diagonal, each with its index.
    let matrix = (nodes + 2.0 * couplings) * (block + 16.0);
    let whole = |number: f64| number.smaller(f64::from(u32::MAX)) as usize;
    let direct = match settings.solver {
        Solver::Auto if settings.real_time => D == 2 || nodes <= 600.0,
        solver => solver.is_direct::<D>(whole(nodes)),
    };
    let copies = if settings.real_time && !direct { COPIES_IN_REAL_TIME } else { COPIES };
    let kept = if settings.real_time && direct { 16.0 * vector / dimension } else { 0.0 };
    let of_each = couplings / nodes.larger(1.0);
    // The fill of a minimum-degree factor grows as N log N for surfaces, and as N to the power 4/3 for bodies that fill space.
    let blocks = match (direct, is_bulk) {
        (false, _) => 0.0,
        (true, false) => 1.2 * of_each * nodes * libm::log2(nodes.larger(2.0)),
        (true, true) => (6.0 + 0.95 * of_each) * nodes * libm::cbrt(nodes),
    };
    VECTORS * vector + copies * matrix + kept + blocks * block
}
