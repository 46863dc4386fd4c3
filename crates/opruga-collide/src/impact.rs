//! When two features meet within a step, and their gap at that time.

use crate::ccd::{edge_meets_edge, vertex_meets_facet};
use crate::gap::Gap;
use crate::positions::Within;
use crate::surface::Surface;

/// The key of a pair of a vertex and a facet, or of two edges.
pub(crate) fn key([a, b]: [u32; 2], with_facet: bool) -> u64 {
    u64::from(!with_facet) << 62 | u64::from(a) << 31 | u64::from(b)
}

/// The features of a key, and whether they are a vertex and a facet.
pub(crate) fn features_in(id: u64) -> ([u32; 2], bool) {
    let part = |shift: u32| ((id >> shift) & ((1 << 31) - 1)) as u32;
    ([part(31), part(0)], id >> 62 == 0)
}

/// The fraction of the step at which a vertex and a facet, or two edges, come closer to one another than a distance [m]; `None` if they stay apart.
#[inline]
pub(crate) fn meeting_time<const D: usize>(
    surface: &Surface<D>,
    [x0, x1]: [&[[f64; D]]; 2],
    distance: f64,
    [a, b]: [u32; 2],
    with_facet: bool,
) -> Option<f64> {
    let ends = |p: u32| [x0[p as usize], x1[p as usize]];
    if with_facet {
        let corners = surface.facets[b as usize].map(ends);
        let facet = core::array::from_fn(|end| corners.map(|corner| corner[end]));
        vertex_meets_facet(&ends(a), &facet, distance)
    } else {
        let [a, b] = [a, b].map(|e| surface.edges[e as usize].map(ends));
        let swept = |e: [[[f64; D]; 2]; 2]| [[e[0][0], e[1][0]], [e[0][1], e[1][1]]];
        edge_meets_edge(&swept(a), &swept(b), distance)
    }
}

/// The gap of a pair at the start of the step, with the normal and the weights at a time within the step; `None` for edges that meet at one of their
/// ends at that time.
pub(crate) fn impact<const D: usize>(
    surface: &Surface<D>,
    ends: [&[[f64; D]]; 2],
    time: f64,
    [a, b]: [u32; 2],
    with_facet: bool,
) -> Option<Gap<D>> {
    let at_impact = Within { ends, time };
    let mut then = if with_facet {
        Gap::of_vertex_and_facet(surface, &at_impact, a, b)
    } else {
        // For edges that meet at an end, a vertex meets a facet too.
        Gap::of_edges(surface, &at_impact, a, b)?
    };
    // The features are apart at the start, so the gap at the start must not be negative.
    then.gap = then.along(ends[0]);
    if then.gap < 0.0 {
        (then.gap, then.normal) = (-then.gap, then.normal.map(|n| -n));
    }
    Some(then)
}
