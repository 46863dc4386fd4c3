//! Nodes of a pack that are looked at one by one: by which face they came in, and what they lay on.

use crate::shape::{Shape, entry, is_on_edge, support};
use opruga_math::{Pack, WIDTH, lanes};

/// The gaps and normals of the nodes of a pack.
pub(crate) struct Found<const D: usize> {
    pub(crate) gap: [f64; WIDTH],
    pub(crate) normal: [[f64; WIDTH]; D],
}

impl<const D: usize> Found<D> {
    fn set(&mut self, lane: usize, (gap, normal): (f64, [f64; D])) {
        self.gap[lane] = gap;
        for d in 0..D {
            self.normal[d][lane] = normal[d];
        }
    }
}

/// The numbers of packs.
#[inline(always)]
pub(crate) fn arrays<P: Pack, const D: usize>(packs: &[P; D]) -> [[f64; WIDTH]; D] {
    let mut out = [[0.0; WIDTH]; D];
    for d in 0..D {
        out[d] = packs[d].to_array();
    }
    out
}

/// For the nodes that are asked for: whether they came into the shape on their way, and where.
#[inline(never)]
pub(crate) fn look_for_entries<T: Shape<D>, const D: usize>(
    shape: &T,
    margin: f64,
    small: &[f64; WIDTH],
    held: &[f64; WIDTH],
    way: &[[[f64; WIDTH]; D]; 2],
    asked: &[f64; WIDTH],
    found: &mut Found<D>,
) {
    for l in (0..WIDTH).filter(|l| asked[*l] != 0.0) {
        let [a, b]: [[f64; D]; 2] = [0, 1].map(|end: usize| lanes!(f64, d => way[end][d][l]));
        // What something else keeps on the surface passes edges, on which no face is in its way. What lies exactly where two
        // solids meet, and is kept by nothing, is in both of them.
        let kept = T::FACES && held[l] > 0.0 && found.gap[l] >= -small[l];
        if kept && is_on_edge(shape, margin, &b) {
            found.set(l, (f64::INFINITY, [0.0; D]));
        } else if !kept && let Some(entered) = entry(shape, margin, &a, &b) {
            found.set(l, entered);
        }
    }
}

/// For the nodes that are asked for: whether they lay on the shape and go into it. Others are far away.
#[inline(never)]
pub(crate) fn look_for_supports<T: Shape<D>, const D: usize>(
    shape: &T,
    margin: f64,
    small: &[f64; WIDTH],
    held: &[f64; WIDTH],
    way: &[[[f64; WIDTH]; D]; 2],
    asked: &[f64; WIDTH],
    found: &mut Found<D>,
) {
    for l in 0..WIDTH {
        let [a, b]: [[f64; D]; 2] = [0, 1].map(|end: usize| lanes!(f64, d => way[end][d][l]));
        let supported = if asked[l] == 0.0 { None } else { support(shape, margin, small[l], [&a, &b], held[l] > 0.0) };
        found.set(l, supported.unwrap_or((f64::INFINITY, [0.0; D])));
    }
}
