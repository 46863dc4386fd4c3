//! Nodes of a register that are processed one by one: the face through which they entered, and the surface on which they were.

use crate::shape::{Shape, entry, is_on_edge, support};
use opruga_math::{Register, WIDTH, lanes};

/// The gaps and normals of the nodes of a register.
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

/// The numbers of a register; the rest of the array is zero.
#[inline(always)]
pub(crate) fn numbers<R: Register>(register: R) -> [f64; WIDTH] {
    let mut out = [0.0; WIDTH];
    register.store(&mut out);
    out
}

/// The numbers of several registers, followed by zeros.
#[inline(always)]
pub(crate) fn arrays<R: Register, const D: usize>(registers: &[R; D]) -> [[f64; WIDTH]; D] {
    let mut out = [[0.0; WIDTH]; D];
    for d in 0..D {
        out[d] = numbers(registers[d]);
    }
    out
}

/// The paths of the nodes of a register.
pub(crate) struct NodePaths<const D: usize> {
    /// Their start, carried along with the shape, and their end [m].
    pub(crate) ends: [[[f64; WIDTH]; D]; 2],
    /// Numbers above 0 for nodes that are to be processed (`asked`), and for nodes at which another contact is already active in this step
    /// (`active`).
    pub(crate) asked: [f64; WIDTH],
    pub(crate) active: [f64; WIDTH],
    /// Distances below this size are rounding errors [m].
    pub(crate) small: [f64; WIDTH],
}

impl<const D: usize> NodePaths<D> {
    /// The ends of the path of a node.
    fn of(&self, lane: usize) -> [[f64; D]; 2] {
        self.ends.each_ref().map(|end| lanes!(f64, d => end[d][lane]))
    }

    /// Finds whether and where nodes entered a shape on their paths; the results of other nodes do not change.
    #[inline(never)]
    pub(crate) fn look_for_entries<T: Shape<D>>(&self, shape: &T, margin: f64, found: &mut Found<D>) {
        for l in (0..WIDTH).filter(|l| self.asked[*l] != 0.0) {
            let [a, b] = self.of(l);
            // If another contact keeps a node on the surface, the node may pass edges, because no face is in its way there. A
            // node exactly at the junction of two solids that no contact keeps on the surface counts as inside both of them.
            let kept = T::FACES && self.active[l] > 0.0 && found.gap[l] >= -self.small[l];
            if kept && is_on_edge(shape, margin, &b) {
                found.set(l, (f64::INFINITY, [0.0; D]));
            } else if !kept && let Some(entered) = entry(shape, margin, &a, &b) {
                found.set(l, entered);
            }
        }
    }

    /// Finds the nodes that were on a shape and enter it. The gaps of all other nodes become infinite.
    #[inline(never)]
    pub(crate) fn look_for_supports<T: Shape<D>>(&self, shape: &T, margin: f64, found: &mut Found<D>) {
        for l in 0..WIDTH {
            let [a, b] = self.of(l);
            let asked = self.asked[l] != 0.0;
            let supported =
                if asked { support(shape, margin, self.small[l], [&a, &b], self.active[l] > 0.0) } else { None };
            found.set(l, supported.unwrap_or((f64::INFINITY, [0.0; D])));
        }
    }
}
