//! Converts positions to deformation gradients, stresses to forces, and tangents to matrices, for every set of vector
//! instructions.

use super::cell::Cell;
use super::cells::Cells;
use crate::materials::points::{read_matrix, write_matrix};
use core::ops::Range;
use opruga_core::state::Layout;
use opruga_math::matrix::{self, Matrix};
use opruga_math::{Lane, Pack, ROW, Register, WIDTH, Work};

/// Positions: in rows for one body, in columns for eight bodies.
#[derive(Clone, Copy)]
pub(super) struct Positions<'a, const D: usize> {
    pub(super) rows: &'a [f64],
    pub(super) columns: [&'a [f64]; D],
}

/// Some packs, and some points of each of their cells, at which a law is evaluated together.
#[derive(Clone)]
pub(super) struct Group {
    pub(super) packs: Range<usize>,
    pub(super) points: Range<usize>,
}

impl Group {
    /// The number of packs of points.
    pub(super) fn len(&self) -> usize {
        self.packs.len() * self.points.len()
    }
    fn number(&self, pack: usize, point: usize) -> usize {
        (pack - self.packs.start) * self.points.len() + point - self.points.start
    }
}

#[inline(always)]
fn corners<R: Register, C: Cell<D, N>, const D: usize, const N: usize>(
    cells: &Cells<C, D, N>,
    x: &Positions<D>,
    pack: usize,
    offset: usize,
) -> [[R; D]; N] {
    let mut out = [[R::zero(); D]; N];
    for a in 0..N {
        let nodes = &cells.nodes[(pack * N + a) * WIDTH + offset..][..R::NUMBERS];
        match cells.layout {
            Layout::Single => {
                let row = R::gather_rows(x.rows, nodes);
                out[a].copy_from_slice(&row[..D]);
            }
            Layout::Batch => {
                for d in 0..D {
                    out[a][d] = R::load(&x.columns[d][nodes[0] as usize * WIDTH + offset..]);
                }
            }
        }
    }
    out
}

/// The area vector k of a cell, for the lanes of a pack [m²]: for a simplex, Wₐ of the corner k + 1; otherwise the area vector
/// of a dual face.
#[inline(always)]
fn area<R: Register, C: Cell<D, N>, const D: usize, const N: usize>(
    cells: &Cells<C, D, N>,
    pack: usize,
    k: usize,
    offset: usize,
) -> [R; D] {
    let read = |column: &[f64], row: usize| -> [R; D] {
        core::array::from_fn(|j| R::load(&column[(row * D + j) * WIDTH + offset..]))
    };
    if C::SIMPLEX {
        let volume = R::load(&cells.volume[pack * WIDTH + offset..]);
        read(&cells.inverse, pack * D + k).map(|slope| -(volume * slope))
    } else {
        read(&cells.areas, pack * C::POINTS + k)
    }
}

/// Computes F of a group, D² packs for every pack of points.
pub(super) struct Gradients<'a, C, const D: usize, const N: usize> {
    pub(super) cells: &'a Cells<C, D, N>,
    pub(super) group: Group,
    pub(super) positions: Positions<'a, D>,
    pub(super) out: &'a mut [f64],
}
impl<C: Cell<D, N>, const D: usize, const N: usize> Work for Gradients<'_, C, D, N> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        for pack in self.group.packs.clone() {
            for part in 0..P::PARTS {
                let offset = part * P::Part::NUMBERS;
                let x = corners::<P::Part, C, D, N>(self.cells, &self.positions, pack, offset);
                for q in self.group.points.clone() {
                    let mut side = matrix::zeros::<P::Part, D>();
                    for i in 0..D {
                        for j in 0..D {
                            if C::SIMPLEX {
                                side[i][j] = x[j + 1][i] - x[0][i];
                                continue;
                            }
                            for a in 0..N {
                                side[i][j] += x[a][i] * P::Part::splat(C::SLOPES[q][a][j]);
                            }
                        }
                    }
                    let inverse: Matrix<P::Part, D> =
                        read_matrix(&self.cells.inverse[(pack * C::POINTS + q) * D * D * WIDTH..], part);
                    let at = self.group.number(pack, q) * D * D * WIDTH;
                    write_matrix(&mut self.out[at..], part, &matrix::product(&side, &inverse));
                }
            }
        }
    }
}

/// Adds the tractions P S of a group to the forces on nodes: rows of nodes for one body, columns of packs for eight.
pub(super) struct Tractions<'a, C, const D: usize, const N: usize> {
    pub(super) cells: &'a Cells<C, D, N>,
    pub(super) group: Group,
    pub(super) stress: &'a [f64],
    pub(super) forces: &'a mut [f64],
}
impl<C: Cell<D, N>, const D: usize, const N: usize> Work for Tractions<'_, C, D, N> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let cells = self.cells;
        for pack in self.group.packs.clone() {
            // The law does not read the cells, so there is time to fetch the cells of the next group from memory.
            cells.fetch(pack + self.group.packs.len());
            let mut corners = [[P::zero(); D]; N];
            for part in 0..P::PARTS {
                let offset = part * P::Part::NUMBERS;
                let mut force = [[P::Part::zero(); D]; N];
                for q in self.group.points.clone() {
                    let at = self.group.number(pack, q) * D * D * WIDTH;
                    let stress: Matrix<P::Part, D> = read_matrix(&self.stress[at..], part);
                    let areas = if C::SIMPLEX { 0..D } else { q..q + 1 };
                    for k in areas {
                        let area = area::<P::Part, C, D, N>(cells, pack, k, offset);
                        for i in 0..D {
                            let mut traction = P::Part::zero();
                            for j in 0..D {
                                traction += stress[i][j] * area[j];
                            }
                            // The forces on the two sides of a dual face are opposite; the first corner of a simplex gets the
                            // negative sum of the others.
                            let [to, from] = if C::SIMPLEX { [k + 1, 0] } else { C::EDGES[q] };
                            force[to][i] += traction;
                            force[from][i] -= traction;
                        }
                    }
                }
                for a in 0..N {
                    for d in 0..D {
                        corners[a][d].set_part(part, force[a][d]);
                    }
                }
            }
            scatter(cells, pack, &corners, self.forces);
        }
    }
}

/// Adds the forces on the corners of a pack to the forces on nodes, cell by cell, so that the order of additions is the same for
/// one body and for eight.
#[inline(always)]
fn scatter<P: Pack, C: Cell<D, N>, const D: usize, const N: usize>(
    cells: &Cells<C, D, N>,
    pack: usize,
    corners: &[[P; D]; N],
    forces: &mut [f64],
) {
    let nodes = &cells.nodes[pack * N * WIDTH..(pack + 1) * N * WIDTH];
    if cells.layout == Layout::Batch {
        for a in 0..N {
            for d in 0..D {
                let to = &mut forces[(nodes[a * WIDTH] as usize * D + d) * WIDTH..];
                (P::load(to) + corners[a][d]).store(to);
            }
        }
        return;
    }
    let mut rows = [[[0.0; ROW]; WIDTH]; N];
    for a in 0..N {
        for part in 0..P::PARTS {
            let mut row = [P::Part::zero(); ROW];
            for d in 0..D {
                row[d] = corners[a][d].part(part);
            }
            P::Part::store_rows(row, rows[a][part * P::Part::NUMBERS..].as_flattened_mut());
        }
    }
    for lane in 0..WIDTH {
        for a in 0..N {
            let to = &mut forces[nodes[a * WIDTH + lane] as usize * ROW..][..ROW];
            for d in 0..ROW {
                to[d] += rows[a][lane][d];
            }
        }
    }
}

/// Adds −∂fₐ/∂x_b of the points of one pack to blocks `[a][b][row][column][lane]`.
pub(super) struct Contract<'a, C, const D: usize, const N: usize> {
    pub(super) cells: &'a Cells<C, D, N>,
    pub(super) group: Group,
    /// D⁴ packs for every pack of points.
    pub(super) tangent: &'a [f64],
    pub(super) blocks: &'a mut [f64],
}
impl<C: Cell<D, N>, const D: usize, const N: usize> Work for Contract<'_, C, D, N> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let (cells, pack) = (self.cells, self.group.packs.start);
        for part in 0..P::PARTS {
            let offset = part * P::Part::NUMBERS;
            for q in self.group.points.clone() {
                let inverse: Matrix<P::Part, D> =
                    read_matrix(&cells.inverse[(pack * C::POINTS + q) * D * D * WIDTH..], part);
                let at = self.group.number(pack, q) * D * D * D * D * WIDTH;
                let mut slopes = [[P::Part::zero(); D]; N];
                for b in 0..N {
                    for l in 0..D {
                        for m in 0..D {
                            slopes[b][l] += P::Part::splat(C::SLOPES[q][b][m]) * inverse[m][l];
                        }
                    }
                }
                let areas = if C::SIMPLEX { 0..D } else { q..q + 1 };
                for k in areas {
                    // S contracted with the tangent: Sⱼ ∂Pᵢⱼ/∂Fₖₗ.
                    let area = area::<P::Part, C, D, N>(cells, pack, k, offset);
                    let mut pulled = [[[P::Part::zero(); D]; D]; D];
                    for i in 0..D {
                        for j in 0..D {
                            let row: Matrix<P::Part, D> =
                                read_matrix(&self.tangent[at + (i * D + j) * D * D * WIDTH..], part);
                            for m in 0..D {
                                for l in 0..D {
                                    pulled[i][m][l] += area[j] * row[m][l];
                                }
                            }
                        }
                    }
                    let [to, from] = if C::SIMPLEX { [k + 1, 0] } else { C::EDGES[q] };
                    for b in 0..N {
                        for i in 0..D {
                            for m in 0..D {
                                let mut sum = P::Part::zero();
                                for l in 0..D {
                                    sum += pulled[i][m][l] * slopes[b][l];
                                }
                                for (a, sum) in [(to, -sum), (from, sum)] {
                                    let at = (((a * N + b) * D + i) * D + m) * WIDTH + offset;
                                    let block = &mut self.blocks[at..];
                                    (P::Part::load(block) + sum).store(block);
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}
