//! Common code of the benchmarks of contact between bodies: walls, and the printing of results.

use opruga_collide::{Counts, Touching};
use opruga_core::contacts::Touch;

/// A plane: axis, position, sign of the normal.
pub(crate) type Wall = (usize, f64, f64);

/// Calls `visit` with the contacts of a point with the walls.
pub(crate) fn touch_walls<const D: usize>(
    walls: &[Wall],
    friction: f64,
    [from, to]: [&[f64; D]; 2],
    reach: f64,
    visit: &mut dyn FnMut(Touch<D>),
) {
    for (surface, &(k, bound, sign)) in walls.iter().enumerate() {
        let gap = sign * (to[k] - bound);
        if gap <= reach {
            let mut normal = [0.0; D];
            normal[k] = sign;
            visit(Touch {
                surface,
                gap,
                gap_before: sign * (from[k] - bound),
                normal,
                carried: *from,
                velocity: [0.0; D],
                friction,
                restitution: 0.0,
                rest_speed: 0.0,
                rounding: 0.0,
            });
        }
    }
}

/// Prints the times of contact and of free motion in ten frames [s], the counts of contact, and a hash of the positions.
pub(crate) fn report<const D: usize>(
    first: usize,
    mut touch: Vec<f64>,
    free: f64,
    counts: &Counts,
    vertices: usize,
    x: &[[f64; D]],
) {
    touch.sort_by(f64::total_cmp);
    let of = |n: u64| n as f64 / counts.steps as f64;
    let substeps = counts.steps as f64 / touch.len() as f64;
    let hash =
        (x.iter().flatten()).fold(0u64, |h, x| (h.rotate_left(5) ^ x.to_bits()).wrapping_mul(0x9E37_79B9_7F4A_7C15));
    println!(
        "frames {first:4}..: contact {:8.3} ms (least {:8.3}, most {:8.3}), {:5.1} ns a vertex and step; free {:6.3} ms; rounds {:.2}, searches {:.3}, candidates {:.0}, pairs {:.0}, contacts {:.0}, turns {:.0}; {hash:016x}",
        touch[5] * 1e3,
        touch[0] * 1e3,
        touch[9] * 1e3,
        touch[5] * 1e9 / (vertices as f64 * substeps),
        free * 1e2,
        of(counts.rounds),
        of(counts.searches),
        of(counts.candidates),
        of(counts.pairs),
        of(counts.contacts),
        of(counts.turns),
    );
}

/// Prints the memory of contact per vertex. Also prints the memory in excess of 400 bytes per vertex, divided by the mean
/// number of candidates of the last frames.
pub(crate) fn report_memory<const D: usize>(touching: &Touching<D>, vertices: usize) {
    let bytes = touching.heap_bytes() as f64;
    let candidates = touching.counts.candidates as f64 / touching.counts.steps as f64;
    let of_candidate = (bytes - 400.0 * vertices as f64) / candidates;
    println!(
        "{:.0} bytes a vertex at {:.1} candidates a vertex: beside 400 bytes a vertex, {of_candidate:.0} a candidate",
        bytes / vertices as f64,
        candidates / vertices as f64
    );
}
