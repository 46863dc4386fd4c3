//! Deformation gradients at the points, and their rates, from positions.

use super::super::elements::Shape;
use super::super::group::Group;
use super::super::work::{Nodes, gather};
use super::hourglass::{MOST_MODES, modes};
use super::rest::Rest;
use super::{Frame, KEPT, Kept, Modes, cofactor_along};
use crate::materials::points::write_matrix;
use core::marker::PhantomData;
use opruga_math::matrix::{self, Matrix};
use opruga_math::{Lane, Pack, Register, WIDTH, Work};

/// Splits F and g, which are given in columns.
#[inline(always)]
fn split<R: Register, const D: usize, const N: usize>(columns: &[[R; D]; N]) -> (Matrix<R, D>, Modes<R, D>) {
    let mut f = matrix::zeros::<R, D>();
    let mut g = [[R::zero(); D]; MOST_MODES];
    for i in 0..D {
        for j in 0..D {
            f[i][j] = columns[j][i];
        }
    }
    g[..modes::<D, N>()].copy_from_slice(&columns[D..N - 1]);
    (f, g)
}

/// Writes an entry of the matrices of all points.
#[inline(always)]
fn put_points<R: Register, const N: usize>(to: &mut [f64], part: usize, entry: usize, entries: usize, own: &[R; N]) {
    for (q, own) in own.iter().enumerate() {
        own.store(&mut to[(q * entries + entry) * WIDTH + part * R::NUMBERS..]);
    }
}

/// Deformation gradients at the Gauss points, followed by the mean deformation gradient if the law is also evaluated for it.
pub(in super::super) struct Deform<'a, E, const D: usize, const N: usize> {
    pub(in super::super) shape: PhantomData<E>,
    pub(in super::super) group: Group<'a>,
    pub(in super::super) positions: Nodes<'a, D>,
    /// D² packs for every pack of points.
    pub(in super::super) gradient: &'a mut [f64],
    /// [`KEPT`] packs for every pack of cells.
    pub(in super::super) kept: &'a mut [f64],
}

impl<E: Shape<D, N>, const D: usize, const N: usize> Work for Deform<'_, E, D, N> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let (points, turns, count) = (self.group.points, self.group.turns, modes::<D, N>());
        for k in 0..self.group.packs {
            let pack = self.group.first + k;
            for part in 0..P::PARTS {
                let x = gather::<P::Part, D, N>(&self.group, &self.positions, pack, part);
                let rest = Rest::<P::Part, D, N>::read(&self.group, pack, part);
                let (f, g) = split::<_, D, N>(&rest.mean(&x));
                let mut q = g;
                if turns {
                    let frame = Frame::new(&f);
                    q = Frame::pulled(&frame.cofactors, count, &g);
                    for mode in 0..count {
                        for i in 0..D {
                            q[mode][i] = frame.phi[0] * q[mode][i];
                        }
                    }
                }
                let kept = Kept { f, g, beta: rest.factors(&q) };
                kept.write::<N>(&mut self.kept[k * KEPT * WIDTH..], part);
                let by = if turns { f } else { matrix::identity() };
                let fields = rest.strained(&by).fields(&kept.beta);
                let to = &mut self.gradient[k * points * D * D * WIDTH..];
                rest.matrices_at_points(&f, &fields, |i, j, own| put_points(to, part, i * D + j, D * D, &own));
                if points > N {
                    write_matrix(&mut to[N * D * D * WIDTH..], part, &f);
                }
            }
        }
    }
}

/// The rates of the quantities that `Deform` computes.
pub(in super::super) struct DeformRates<'a, E, const D: usize, const N: usize> {
    pub(in super::super) shape: PhantomData<E>,
    pub(in super::super) group: Group<'a>,
    pub(in super::super) velocities: Nodes<'a, D>,
    /// The quantities kept for the positions.
    pub(in super::super) kept: &'a [f64],
    pub(in super::super) rate: &'a mut [f64],
    /// Rates of F, g and β.
    pub(in super::super) kept_rate: &'a mut [f64],
}

impl<E: Shape<D, N>, const D: usize, const N: usize> Work for DeformRates<'_, E, D, N> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let (points, turns, count) = (self.group.points, self.group.turns, modes::<D, N>());
        for k in 0..self.group.packs {
            let pack = self.group.first + k;
            for part in 0..P::PARTS {
                let v = gather::<P::Part, D, N>(&self.group, &self.velocities, pack, part);
                let rest = Rest::<P::Part, D, N>::read(&self.group, pack, part);
                let Kept { f, g, beta } = Kept::<P::Part, D>::read::<N>(&self.kept[k * KEPT * WIDTH..], part);
                let (f_rate, g_rate) = split::<_, D, N>(&rest.mean(&v));
                let mut q_rate = g_rate;
                if turns {
                    let frame = Frame::new(&f);
                    let j_rate = matrix::inner(&frame.cofactors, &f_rate);
                    let own = Frame::pulled(&frame.cofactors, count, &g);
                    let turned = Frame::pulled(&cofactor_along(&f, &f_rate), count, &g);
                    let moved = Frame::pulled(&frame.cofactors, count, &g_rate);
                    for mode in 0..count {
                        for i in 0..D {
                            q_rate[mode][i] = frame.phi[1] * j_rate * own[mode][i]
                                + frame.phi[0] * (turned[mode][i] + moved[mode][i]);
                        }
                    }
                }
                let beta_rate = rest.factors(&q_rate);
                let kept = Kept { f: f_rate, g: g_rate, beta: beta_rate };
                kept.write::<N>(&mut self.kept_rate[k * KEPT * WIDTH..], part);
                let by = if turns { f } else { matrix::identity() };
                let mut fields = rest.strained(&by).fields(&beta_rate);
                if turns {
                    let turned = rest.strained(&f_rate).fields(&beta);
                    for (field, turned) in fields.iter_mut().zip(&turned) {
                        *field = matrix::plus(field, P::Part::one(), turned);
                    }
                }
                let to = &mut self.rate[k * points * D * D * WIDTH..];
                rest.matrices_at_points(&f_rate, &fields, |i, j, own| put_points(to, part, i * D + j, D * D, &own));
                if points > N {
                    write_matrix(&mut to[N * D * D * WIDTH..], part, &f_rate);
                }
            }
        }
    }
}
