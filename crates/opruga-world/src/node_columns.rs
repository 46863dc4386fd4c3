//! Views of the values of a body's nodes, as they are stored in the columns of a world.

use crate::world::World;

/// One number of every node of a body, as stored in memory. The nodes of up to eight bodies of the same kind are interleaved.
#[derive(Clone, Copy, Debug)]
pub struct Strided<'w> {
    column: &'w [f64],
    stride: usize,
}

impl<'w> Strided<'w> {
    /// The numbers, in the order of the nodes.
    pub fn iter(self) -> impl ExactSizeIterator<Item = f64> + 'w {
        self.column.iter().step_by(self.stride).copied()
    }
    /// The number of nodes.
    pub fn len(self) -> usize {
        self.column.len().div_ceil(self.stride)
    }
    /// Whether there is no node.
    pub fn is_empty(self) -> bool {
        self.column.is_empty()
    }
    /// The value at a node; NaN if there is no such node.
    pub fn at(self, node: usize) -> f64 {
        self.column.get(node * self.stride).copied().unwrap_or(f64::NAN)
    }
    /// The numbers as one slice, if they are contiguous.
    pub fn as_slice(self) -> Option<&'w [f64]> {
        (self.stride == 1).then_some(self.column)
    }
}

/// One vector of every node of a body: a view into the columns of the world without a copy.
#[derive(Clone, Copy, Debug)]
pub struct Vectors<'w> {
    columns: [Strided<'w>; 3],
    dimension: usize,
}

impl<'w> Vectors<'w> {
    /// The number of nodes.
    pub fn len(self) -> usize {
        self.columns[0].len()
    }
    /// Whether there are no nodes, for example because there is no such body.
    pub fn is_empty(self) -> bool {
        self.columns[0].is_empty()
    }
    /// The column of each coordinate: two or three.
    pub fn columns(&self) -> &[Strided<'w>] {
        &self.columns[..self.dimension]
    }
    /// The vector of a node, with 0 for z in the plane; NaN if there is no such node.
    pub fn at(self, node: usize) -> [f64; 3] {
        core::array::from_fn(|d| if d < self.dimension { self.columns[d].at(node) } else { 0.0 })
    }
    /// The vectors in the order of the nodes, with 0 for z in the plane.
    pub fn iter(self) -> impl ExactSizeIterator<Item = [f64; 3]> + 'w {
        (0..self.len()).map(move |node| self.at(node))
    }
}

const NOTHING: Strided<'static> = Strided { column: &[], stride: 1 };

impl<const D: usize> World<D> {
    /// The part of a column that belongs to a body.
    fn column_of<'w>(&self, body: usize, column: &'w [f64]) -> Strided<'w> {
        let Some((island, lane)) = self.island_of_body(body) else { return NOTHING };
        let (layout, nodes) = (island.system.layout, island.system.nodes);
        let Some(last) = nodes.checked_sub(1) else { return NOTHING };
        Strided { column: &column[layout.index(0, lane)..=layout.index(last, lane)], stride: layout.stride() }
    }

    /// The vectors of a body's nodes, by their columns.
    pub(crate) fn vectors_of<'w>(&self, body: usize, columns: [&'w [f64]; D]) -> Vectors<'w> {
        let columns = core::array::from_fn(|d| columns.get(d).map_or(NOTHING, |column| self.column_of(body, column)));
        Vectors { columns, dimension: D }
    }
}
