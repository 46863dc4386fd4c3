//! The nodes that take part in contacts because they carry points of these contacts.

use crate::surface::Surface;

/// The points on which a contact acts, and their weights.
pub(crate) type Weighted<'a> = (&'a [u32], &'a [f64]);

/// The nodes and weights of those contacts of a step that have a carried point, one contact after the other. Such a contact acts
/// on these nodes instead of its own points. Σ wᵢ vᵢ is the same for both, and so are momentum and angular momentum of an
/// impulse. In other lists, a head represents each contact: either its own points, or its range in this list ([`Spread::head`]).
#[derive(Clone, Debug, Default)]
pub(crate) struct Spread {
    points: Vec<u32>,
    weights: Vec<f64>,
}

/// The last entry of a head that represents a range of [`Spread`].
const ELSEWHERE: u32 = u32::MAX;

impl Spread {
    /// Discards everything.
    pub(crate) fn clear(&mut self) {
        self.points.clear();
        self.weights.clear();
    }

    /// Moves all entries of another list behind the present ones; returns the index of the first moved entry.
    pub(crate) fn append(&mut self, other: &mut Spread) -> u32 {
        let first = self.points.len() as u32;
        self.points.append(&mut other.points);
        self.weights.append(&mut other.weights);
        first
    }

    /// Updates a head after the entries that it represents were moved by this number of indices.
    pub(crate) fn shift(head: &mut [u32; 4], by: u32) {
        if head[3] == ELSEWHERE {
            head[0] += by;
        }
    }

    /// Replaces the carried points by the nodes that carry them, and distributes their weights over these nodes. Returns the index of the first new
    /// entry and the number of new entries; both are zero if no point is carried.
    pub(crate) fn put<const D: usize>(&mut self, surface: &Surface<D>, (points, weights): Weighted<'_>) -> [u32; 2] {
        if !surface.carries_any(points) {
            return [0; 2];
        }
        let first = self.points.len();
        for (point, weight) in points.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
            surface.visit_nodes(*point, |node, share| {
                // A node may carry several of the points, and may itself be one of them.
                match self.points[first..].iter().position(|p| *p == node) {
                    Some(at) => self.weights[first + at] += weight * share,
                    None => {
                        self.points.push(node);
                        self.weights.push(weight * share);
                    }
                }
            });
        }
        [first as u32, (self.points.len() - first) as u32]
    }

    /// The nodes of a contact and their weights, given the index of the first node and the number of nodes.
    #[inline]
    pub(crate) fn at(&self, [first, count]: [u32; 2]) -> Weighted<'_> {
        let range = first as usize..(first + count) as usize;
        (&self.points[range.clone()], &self.weights[range])
    }

    /// The head that represents the nodes of a contact in other lists.
    pub(crate) fn head([first, count]: [u32; 2]) -> [u32; 4] {
        [first, count, 0, ELSEWHERE]
    }

    /// The range in this list that a head represents, as the index of its first entry and the number of its entries; both are zero for a head that
    /// contains points.
    pub(crate) fn range_of(head: &[u32; 4]) -> [u32; 2] {
        if Self::is_elsewhere(head) { [head[0], head[1]] } else { [0; 2] }
    }

    /// The head of a contact that acts on nothing.
    pub(crate) const NOBODY: [u32; 4] = [0, 0, 0, ELSEWHERE];

    /// The points that a head represents.
    #[inline(always)]
    pub(crate) fn points_of<'a, const D: usize>(&'a self, head: &'a [u32; 4]) -> &'a [u32] {
        if head[3] == ELSEWHERE { &self.points[head[0] as usize..(head[0] + head[1]) as usize] } else { &head[..=D] }
    }

    /// The weights of these points; all are 1 for points that are not in this list.
    #[inline(always)]
    pub(crate) fn weights_of<'a, const D: usize>(&'a self, head: &'a [u32; 4]) -> &'a [f64] {
        if Self::is_elsewhere(head) {
            &self.weights[head[0] as usize..(head[0] + head[1]) as usize]
        } else {
            &[1.0; 4][..=D]
        }
    }

    /// Whether a head represents points in this list, or none.
    #[inline(always)]
    pub(crate) fn is_elsewhere(head: &[u32; 4]) -> bool {
        head[3] == ELSEWHERE
    }

    /// Bytes on the heap.
    pub(crate) fn heap_bytes(&self) -> usize {
        4 * self.points.capacity() + 8 * self.weights.capacity()
    }
}
