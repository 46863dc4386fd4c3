//! The difference between a consistent mass matrix and lumped masses.
//!
//! M = diag(m) + D. A pair of nodes has the same entry for all axes. All entries of D sum to zero, so the mass of a body is the
//! sum of the masses of its nodes; the weight of a node follows from the sum of its row of M.

use opruga_math::{WIDTH, sum_in_fixed_order};

/// The matrix D [kg] in compressed rows, symmetric.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Inertia {
    /// The first entry of each node, and the end of the last one.
    start: Vec<u32>,
    column: Vec<u32>,
    value: Vec<f64>,
}

impl Inertia {
    /// Makes the matrix for `nodes` nodes from entries (row, column, mass), which are added in their order.
    pub fn new(nodes: usize, mut entries: Vec<(u32, u32, f64)>) -> Inertia {
        entries.sort_by_key(|(row, column, _)| (*row, *column));
        let mut out = Inertia { start: vec![0; nodes + 1], ..Inertia::default() };
        let mut last = None;
        for (row, column, mass) in entries {
            if last == Some((row, column)) {
                if let Some(value) = out.value.last_mut() {
                    *value += mass;
                }
                continue;
            }
            last = Some((row, column));
            out.start[row as usize + 1] += 1;
            out.column.push(column);
            out.value.push(mass);
        }
        for node in 0..nodes {
            out.start[node + 1] += out.start[node];
        }
        out
    }

    /// The entries of a node: the other node, and the mass.
    #[inline]
    pub fn row(&self, node: usize) -> impl Iterator<Item = (usize, f64)> {
        let range = self.start[node] as usize..self.start[node + 1] as usize;
        self.column[range.clone()].iter().zip(&self.value[range]).map(|(column, value)| (*column as usize, *value))
    }

    /// The number of nodes that the matrix couples.
    pub fn nodes(&self) -> usize {
        self.start.len().saturating_sub(1)
    }

    /// The vector (D x)ₐ of a node a, for a vector x that holds the coordinates of one node after the other.
    #[inline]
    pub fn product<const D: usize>(&self, node: usize, x: &[f64]) -> [f64; D] {
        let mut out = [0.0; D];
        for (other, mass) in self.row(node) {
            for d in 0..D {
                out[d] += mass * x[other * D + d];
            }
        }
        out
    }

    /// Returns x·D x.
    pub fn square<const D: usize>(&self, x: &[f64]) -> f64 {
        let mut parts = [0.0; WIDTH];
        for node in 0..self.nodes() {
            let product = self.product::<D>(node, x);
            for d in 0..D {
                parts[node % WIDTH] += product[d] * x[node * D + d];
            }
        }
        sum_in_fixed_order(&parts)
    }

    /// The matrix made from the entries of this matrix, followed by other entries.
    pub(crate) fn with(&self, others: Vec<(u32, u32, f64)>) -> Inertia {
        let own = (0..self.nodes()).flat_map(|a| self.row(a).map(move |(b, mass)| (a as u32, b as u32, mass)));
        Inertia::new(self.nodes(), own.chain(others).collect())
    }

    /// Bytes on the heap.
    pub fn heap_bytes(&self) -> usize {
        4 * (self.start.capacity() + self.column.capacity()) + 8 * self.value.capacity()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_of_the_same_pair_add_up_and_products_are_those_of_the_matrix() {
        let list = vec![(1, 0, -1.0), (0, 0, 2.0), (0, 1, -1.0), (1, 1, 3.0), (0, 0, 0.5), (2, 2, 1.0)];
        let matrix = Inertia::new(3, list);
        let x = [1.0, 10.0, 2.0, 20.0, 3.0, 30.0];
        assert_eq!(matrix.product::<2>(0, &x), [0.5, 5.0]);
        assert_eq!(matrix.product::<2>(1, &x), [5.0, 50.0]);
        assert_eq!(matrix.square::<2>(&x), 101.0 * (0.5 * 1.0 + 5.0 * 2.0 + 3.0 * 3.0));
        let more = matrix.with(vec![(2, 0, 1.0), (0, 2, 1.0)]);
        assert_eq!(more.product::<2>(2, &x), [4.0, 40.0]);
        assert_eq!(more.row(0).collect::<Vec<_>>(), [(0, 2.5), (1, -1.0), (2, 1.0)]);
    }
}
