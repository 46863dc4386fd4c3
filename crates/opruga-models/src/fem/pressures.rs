//! The contributions of cells to the volumes of their nodes, and the effect of their pressures on cells, for every set of vector
//! instructions.

use super::elements::Shape;
use super::group::Group;
use super::nodal_volume::Pressures;
use super::work::{Nodes, gather, geometry};
use crate::materials::material::{Tangent, add_cofactor_derivative, no_tangent};
use crate::materials::points::{Points, read_matrix, write_matrix};
use core::marker::PhantomData;
use opruga_core::state::Layout;
use opruga_math::matrix;
use opruga_math::{Lane, Pack, ROW, Register, WIDTH, Work};

/// J − 1 of linear simplices, or tr (F − 1) under a law that does not account for rotations.
pub(super) struct Growth<'a, E, const D: usize, const N: usize> {
    pub(super) shape: PhantomData<E>,
    pub(super) group: Group<'a>,
    pub(super) nodes: Nodes<'a, D>,
    /// One pack for every pack of elements.
    pub(super) grown: &'a mut [f64],
}

impl<E: Shape<D, N>, const D: usize, const N: usize> Work for Growth<'_, E, D, N> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        for k in 0..self.group.packs {
            let pack = self.group.first + k;
            for part in 0..P::PARTS {
                let x = gather::<P::Part, D, N>(&self.group, &self.nodes, pack, part);
                let (inverse, _) = geometry::<P::Part, D>(&self.group, pack, 0, part);
                let mut edges = matrix::zeros::<P::Part, D>();
                for i in 0..D {
                    for j in 0..D {
                        edges[i][j] = x[j + 1][i] - x[0][i];
                    }
                }
                let f = matrix::product(&edges, &inverse);
                let grown = if self.group.turns {
                    matrix::determinant(&f) - P::Part::one()
                } else {
                    matrix::trace(&f) - P::Part::splat(D as f64)
                };
                grown.store(&mut self.grown[k * WIDTH + part * P::Part::NUMBERS..]);
            }
        }
    }
}

/// The pressures of cells: the means over their corners.
pub(super) struct Means<'a, E, const D: usize, const N: usize> {
    pub(super) shape: PhantomData<E>,
    pub(super) group: Group<'a>,
    /// Rows whose last numbers are the pressures of the nodes of one body.
    pub(super) nodes: Nodes<'a, D>,
    /// For eight bodies.
    pub(super) pressures: Pressures<'a>,
    /// One pack for every pack of elements.
    pub(super) means: &'a mut [f64],
}

impl<E: Shape<D, N>, const D: usize, const N: usize> Work for Means<'_, E, D, N> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let share = P::Part::splat(1.0 / N as f64);
        for k in 0..self.group.packs {
            for part in 0..P::PARTS {
                let offset = part * P::Part::NUMBERS;
                let mut sum = P::Part::zero();
                for a in 0..N {
                    sum += match self.group.layout {
                        Layout::Single => {
                            let start = ((self.group.first + k) * N + a) * WIDTH + offset;
                            let rows = &self.group.node_indices[start..start + P::Part::NUMBERS];
                            P::Part::gather_rows(self.nodes.rows, rows)[ROW - 1]
                        }
                        Layout::Batch => {
                            let index = self.group.node_indices[(self.group.first + k) * N + a] as usize;
                            P::Part::load(&self.pressures.of(index / WIDTH)[offset..])
                        }
                    };
                }
                (share * sum).store(&mut self.means[k * WIDTH + offset..]);
            }
        }
    }
}

/// Adds p ∂J/∂F to stresses at points, with one p for each cell.
pub(super) struct PressedStress<'a, const D: usize> {
    pub(super) points: Points<'a>,
    pub(super) turns: bool,
    pub(super) pressures: &'a [f64],
    pub(super) stress: &'a mut [f64],
}

impl<const D: usize> Work for PressedStress<'_, D> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        for point in 0..self.points.count {
            let at = point * D * D * WIDTH;
            for part in 0..P::PARTS {
                let pressure = P::Part::load(&self.pressures[point * WIDTH + part * P::Part::NUMBERS..]);
                let mut along = matrix::identity();
                if self.turns {
                    along = matrix::cofactor(&read_matrix::<P::Part, D>(&self.points.gradient[at..], part));
                }
                let stress = read_matrix::<P::Part, D>(&self.stress[at..], part);
                write_matrix(&mut self.stress[at..], part, &matrix::plus(&stress, pressure, &along));
            }
        }
    }
}

/// Adds p ∂²J/∂F∂F to tangents at points, with one p for each cell.
pub(super) struct PressedTangents<'a, const D: usize> {
    pub(super) points: Points<'a>,
    pub(super) pressures: &'a [f64],
    pub(super) tangent: &'a mut [f64],
}

impl<const D: usize> Work for PressedTangents<'_, D> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        for point in 0..self.points.count {
            for part in 0..P::PARTS {
                let pressure = P::Part::load(&self.pressures[point * WIDTH + part * P::Part::NUMBERS..]);
                let f = read_matrix::<P::Part, D>(&self.points.gradient[point * D * D * WIDTH..], part);
                let mut more: Tangent<P::Part, D> = no_tangent();
                add_cofactor_derivative(&mut more, pressure, &f);
                for i in 0..D {
                    for j in 0..D {
                        let to = &mut self.tangent[((point * D + i) * D + j) * D * D * WIDTH..];
                        let own = read_matrix::<P::Part, D>(to, part);
                        write_matrix(to, part, &matrix::plus(&own, P::Part::one(), &more[i][j]));
                    }
                }
            }
        }
    }
}
