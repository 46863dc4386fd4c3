//! The work on quadrilaterals and hexahedra, compiled for every set of vector instructions.
//!
//! A cell has the mean F of its deformation gradient, which the law sees, and hourglass amplitudes gₐ
//! ([`super::hourglass`]). Its energy is
//!
//! U = V ψ(F) + ½ k₀ Σ gₐ·gₐ + ½ Σ qₐ·Kₐᵦ qᵦ,  qₐ = Aᵀ gₐ,  A = ½ (F + cof F).
//!
//! A is F itself for a rotation, turns with the body as it does, and is smooth: in the plane it is the rotation nearest to F
//! times the mean of the stretches, and a cell that is pressed flat keeps half of it. Under `linear`, which does not know of
//! rotations, q is g. The damping of Kelvin and Voigt acts on the rate of q with τ (K + k₀).

use super::elements::Shape;
use super::hourglass::{MOST_MODES, modes, stiffness_numbers};
use super::law::{read_matrix, write_matrix};
use super::material::{Tangent, add_cofactor_derivative, no_tangent};
use super::section::Group;
use super::work::{Nodes, gather, scatter};
use core::marker::PhantomData;
use opruga_core::potential::Definiteness;
use opruga_core::state::Layout;
use opruga_math::matrix::{self, Matrix};
use opruga_math::{Lane, Pack, Register, WIDTH, Work};

/// Packs of hourglass amplitudes of a pack of cells, at most.
pub(super) const AMPLITUDES: usize = MOST_MODES * 3;

/// Amplitudes, or what belongs to them: mode by mode.
type Modes<R, const D: usize> = [[R; D]; MOST_MODES];

/// The shares of the corners of a pack of cells in F and g, and the measure.
#[inline(always)]
fn weights<R: Register, const D: usize, const N: usize>(
    group: &Group<'_>,
    pack: usize,
    part: usize,
) -> ([[R; N]; N], R) {
    let stored = N * (N - 1) + 1;
    let mut out = [[R::zero(); N]; N];
    match group.layout {
        Layout::Single => {
            let from = &group.geometry[pack * stored * WIDTH..(pack + 1) * stored * WIDTH];
            for a in 0..N {
                for c in 0..N - 1 {
                    out[a][c] = R::load(&from[(a * (N - 1) + c) * WIDTH + part * R::NUMBERS..]);
                }
            }
            (out, R::load(&from[(stored - 1) * WIDTH + part * R::NUMBERS..]))
        }
        Layout::Batch => {
            let from = &group.geometry[pack * stored..(pack + 1) * stored];
            for a in 0..N {
                for c in 0..N - 1 {
                    out[a][c] = R::splat(from[a * (N - 1) + c]);
                }
            }
            (out, R::splat(from[stored - 1]))
        }
    }
}

/// k₀, and what K makes of some amplitudes.
#[inline(always)]
fn stiffened<R: Register, const D: usize, const N: usize>(
    group: &Group<'_>,
    pack: usize,
    part: usize,
    q: &Modes<R, D>,
) -> (R, Modes<R, D>) {
    let numbers = stiffness_numbers::<D, N>();
    let from = &group.stiffness[pack * numbers * WIDTH..(pack + 1) * numbers * WIDTH];
    let mut out = [[R::zero(); D]; MOST_MODES];
    let mut next = 1;
    let size = modes::<D, N>() * D;
    for r in 0..size {
        for s in r..size {
            let k = R::load(&from[next * WIDTH + part * R::NUMBERS..]);
            next += 1;
            out[r / D][r % D] += k * q[s / D][s % D];
            if r != s {
                out[s / D][s % D] += k * q[r / D][r % D];
            }
        }
    }
    (R::load(&from[part * R::NUMBERS..]), out)
}

/// The change of cof F with F along Z; the same with F and Z exchanged.
#[inline(always)]
fn cofactor_along<R: Lane, const D: usize>(f: &Matrix<R, D>, z: &Matrix<R, D>) -> Matrix<R, D> {
    if D == 2 {
        return matrix::cofactor(z);
    }
    let mut out = matrix::zeros::<R, D>();
    for i in 0..D {
        for j in 0..D {
            let (k, m) = ((i + 1) % D, (i + 2) % D);
            let (l, n) = ((j + 1) % D, (j + 2) % D);
            out[i][j] = f[k][l] * z[m][n] + z[k][l] * f[m][n] - f[k][n] * z[m][l] - z[k][n] * f[m][l];
        }
    }
    out
}

/// A of a deformation gradient.
#[inline(always)]
fn frame<R: Lane, const D: usize>(turns: bool, f: &Matrix<R, D>) -> Matrix<R, D> {
    if turns {
        matrix::scaled(&matrix::plus(f, R::one(), &matrix::cofactor(f)), R::splat(0.5))
    } else {
        matrix::identity()
    }
}

/// The change of A with F along Z; also what a force Z on A is on F.
#[inline(always)]
fn frame_along<R: Lane, const D: usize>(turns: bool, f: &Matrix<R, D>, z: &Matrix<R, D>) -> Matrix<R, D> {
    if turns {
        matrix::scaled(&matrix::plus(z, R::one(), &cofactor_along(f, z)), R::splat(0.5))
    } else {
        matrix::zeros()
    }
}

/// Aᵀ g, mode by mode.
#[inline(always)]
fn pulled<R: Lane, const D: usize>(modes: usize, a: &Matrix<R, D>, g: &Modes<R, D>) -> Modes<R, D> {
    let mut out = [[R::zero(); D]; MOST_MODES];
    for mode in 0..modes {
        for j in 0..D {
            for i in 0..D {
                out[mode][j] += a[i][j] * g[mode][i];
            }
        }
    }
    out
}

#[inline(always)]
fn inner<R: Lane, const D: usize>(modes: usize, a: &Modes<R, D>, b: &Modes<R, D>) -> R {
    let mut sum = R::zero();
    for mode in 0..modes {
        for i in 0..D {
            sum += a[mode][i] * b[mode][i];
        }
    }
    sum
}

#[inline(always)]
fn read_amplitudes<R: Register, const D: usize, const N: usize>(from: &[f64], part: usize) -> Modes<R, D> {
    let mut out = [[R::zero(); D]; MOST_MODES];
    for mode in 0..modes::<D, N>() {
        for i in 0..D {
            out[mode][i] = R::load(&from[(mode * D + i) * WIDTH + part * R::NUMBERS..]);
        }
    }
    out
}

/// Mean deformation gradients and hourglass amplitudes, or their rates.
pub(super) struct Deform<'a, E, const D: usize, const N: usize> {
    pub(super) shape: PhantomData<E>,
    pub(super) group: Group<'a>,
    /// Positions or velocities.
    pub(super) nodes: Nodes<'a, D>,
    /// D² packs for every pack of cells.
    pub(super) gradient: &'a mut [f64],
    /// [`AMPLITUDES`] packs for every pack of cells.
    pub(super) amplitudes: &'a mut [f64],
}

impl<E: Shape<D, N>, const D: usize, const N: usize> Work for Deform<'_, E, D, N> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        for k in 0..self.group.packs {
            let pack = self.group.first + k;
            for part in 0..P::PARTS {
                let x = gather::<P::Part, D, N>(&self.group, &self.nodes, pack, part);
                let (weights, _) = weights::<P::Part, D, N>(&self.group, pack, part);
                // Differences to the first corner: what is far away has all digits of its shape.
                let mut sums = [[P::Part::zero(); D]; N];
                for a in 1..N {
                    for i in 0..D {
                        let from_first = x[a][i] - x[0][i];
                        for c in 0..N - 1 {
                            sums[c][i] += weights[a][c] * from_first;
                        }
                    }
                }
                let mut f = matrix::zeros::<P::Part, D>();
                for i in 0..D {
                    for j in 0..D {
                        f[i][j] = sums[j][i];
                    }
                }
                write_matrix(&mut self.gradient[k * D * D * WIDTH..], part, &f);
                let to = &mut self.amplitudes[k * AMPLITUDES * WIDTH..(k + 1) * AMPLITUDES * WIDTH];
                for mode in 0..modes::<D, N>() {
                    for i in 0..D {
                        sums[D + mode][i].store(&mut to[(mode * D + i) * WIDTH + part * P::Part::NUMBERS..]);
                    }
                }
            }
        }
    }
}

/// Rates of a state, for damping.
pub(super) struct Rates<'a> {
    pub(super) gradient: &'a [f64],
    pub(super) amplitudes: &'a [f64],
    /// Retardation times.
    pub(super) times: &'a [f64],
    /// Densities of power, which become powers of cells.
    pub(super) power: &'a mut [f64],
}

/// Forces of cells onto nodes; densities of energy and power become energies and powers of cells.
pub(super) struct Push<'a, E, const D: usize, const N: usize> {
    pub(super) shape: PhantomData<E>,
    pub(super) group: Group<'a>,
    pub(super) gradient: &'a [f64],
    pub(super) amplitudes: &'a [f64],
    pub(super) stress: &'a [f64],
    pub(super) density: &'a mut [f64],
    pub(super) rates: Option<Rates<'a>>,
    pub(super) force: &'a mut [f64],
}

impl<E: Shape<D, N>, const D: usize, const N: usize> Work for Push<'_, E, D, N> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(mut self) {
        let (count, turns) = (modes::<D, N>(), self.group.turns);
        let mut slots = [[P::zero(); D]; N];
        for k in 0..self.group.packs {
            let pack = self.group.first + k;
            for part in 0..P::PARTS {
                let at = k * WIDTH + part * P::Part::NUMBERS;
                let (weights, measure) = weights::<P::Part, D, N>(&self.group, pack, part);
                let f = read_matrix::<P::Part, D>(&self.gradient[k * D * D * WIDTH..], part);
                let g = read_amplitudes::<P::Part, D, N>(&self.amplitudes[k * AMPLITUDES * WIDTH..], part);
                let a = frame(turns, &f);
                let q = pulled(count, &a, &g);
                let (least, mut p) = stiffened::<P::Part, D, N>(&self.group, pack, part, &q);
                let own = least * inner(count, &g, &g) + inner(count, &q, &p);
                let half = P::Part::splat(0.5);
                (measure * P::Part::load(&self.density[at..]) + half * own).store(&mut self.density[at..]);
                if let Some(rates) = &mut self.rates {
                    let f_rate = read_matrix::<P::Part, D>(&rates.gradient[k * D * D * WIDTH..], part);
                    let g_rate = read_amplitudes::<P::Part, D, N>(&rates.amplitudes[k * AMPLITUDES * WIDTH..], part);
                    let turned = pulled(count, &frame_along(turns, &f, &f_rate), &g);
                    let mut rate = pulled(count, &a, &g_rate);
                    for mode in 0..count {
                        for i in 0..D {
                            rate[mode][i] += turned[mode][i];
                        }
                    }
                    let (_, mut drag) = stiffened::<P::Part, D, N>(&self.group, pack, part, &rate);
                    let time = P::Part::load(&rates.times[at..]);
                    for mode in 0..count {
                        for i in 0..D {
                            drag[mode][i] = time * (drag[mode][i] + least * rate[mode][i]);
                            p[mode][i] += drag[mode][i];
                        }
                    }
                    let lost = inner(count, &rate, &drag);
                    (measure * P::Part::load(&rates.power[at..]) + lost).store(&mut rates.power[at..]);
                }
                // ∂U/∂A, ∂U/∂g and ∂U/∂F.
                let mut on_frame = matrix::zeros::<P::Part, D>();
                let mut columns = [[P::Part::zero(); D]; N];
                for mode in 0..count {
                    for i in 0..D {
                        let mut sum = least * g[mode][i];
                        for j in 0..D {
                            on_frame[i][j] += g[mode][i] * p[mode][j];
                            sum += a[i][j] * p[mode][j];
                        }
                        columns[D + mode][i] = sum;
                    }
                }
                let stress = read_matrix::<P::Part, D>(&self.stress[k * D * D * WIDTH..], part);
                let on_gradient = matrix::plus(&frame_along(turns, &f, &on_frame), measure, &stress);
                for i in 0..D {
                    for j in 0..D {
                        columns[j][i] = on_gradient[i][j];
                    }
                }
                for node in 0..N {
                    for i in 0..D {
                        let mut sum = P::Part::zero();
                        for c in 0..N - 1 {
                            sum += weights[node][c] * columns[c][i];
                        }
                        slots[node][i].set_part(part, -sum);
                    }
                }
            }
            scatter(&self.group, pack, &slots, self.force);
        }
    }
}

/// What a matrix of cells is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Of {
    /// Energy; clamped: without what could be negative.
    Energy(Definiteness),
    /// Damping.
    Damping,
}

/// Tangents of the mean deformation, and hourglass stiffness, of one pack of cells to blocks K_ab, a ≤ b,
/// `[(a N + b)][i][k]` packs.
pub(super) struct Contract<'a, E, const D: usize, const N: usize> {
    pub(super) shape: PhantomData<E>,
    pub(super) group: Group<'a>,
    /// Which pack of the group.
    pub(super) pack: usize,
    pub(super) of: Of,
    pub(super) gradient: &'a [f64],
    pub(super) amplitudes: &'a [f64],
    pub(super) times: &'a [f64],
    /// D⁴ packs for every pack of cells.
    pub(super) tangent: &'a [f64],
    pub(super) blocks: &'a mut [f64],
}

/// Derivatives by F (D columns) and g (a column each mode), both by row: [row][column].
type ByColumns<R, const D: usize, const N: usize> = [[R; N]; D];

impl<E: Shape<D, N>, const D: usize, const N: usize> Work for Contract<'_, E, D, N> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let (count, turns) = (modes::<D, N>(), self.group.turns);
        let (k, pack) = (self.pack, self.group.first + self.pack);
        let half = P::Part::splat(0.5);
        for part in 0..P::PARTS {
            let (weights, measure) = weights::<P::Part, D, N>(&self.group, pack, part);
            let f = read_matrix::<P::Part, D>(&self.gradient[k * D * D * WIDTH..], part);
            let g = read_amplitudes::<P::Part, D, N>(&self.amplitudes[k * AMPLITUDES * WIDTH..], part);
            let a = frame(turns, &f);
            // ∂A_mj/∂F_il.
            let mut slope: Tangent<P::Part, D> = no_tangent();
            if turns {
                add_cofactor_derivative(&mut slope, half, &f);
                for i in 0..D {
                    for j in 0..D {
                        slope[i][j][i][j] += half;
                    }
                }
            }
            // ∂q/∂(F, g).
            let zero: ByColumns<P::Part, D, N> = [[P::Part::zero(); N]; D];
            let mut change = [[zero; D]; MOST_MODES];
            for mode in 0..count {
                for j in 0..D {
                    for i in 0..D {
                        change[mode][j][i][D + mode] = a[i][j];
                        for l in 0..D {
                            for m in 0..D {
                                change[mode][j][i][l] += g[mode][m] * slope[m][j][i][l];
                            }
                        }
                    }
                }
            }
            // K ∂q/∂(F, g).
            let (mut least, force) = stiffened::<P::Part, D, N>(&self.group, pack, part, &pulled(count, &a, &g));
            let mut stiff = [[zero; D]; MOST_MODES];
            for i in 0..D {
                for c in 0..N - 1 {
                    let mut one = [[P::Part::zero(); D]; MOST_MODES];
                    for mode in 0..count {
                        for j in 0..D {
                            one[mode][j] = change[mode][j][i][c];
                        }
                    }
                    let (_, mut image) = stiffened::<P::Part, D, N>(&self.group, pack, part, &one);
                    if self.of == Of::Damping {
                        let time = P::Part::load(&self.times[k * WIDTH + part * P::Part::NUMBERS..]);
                        for mode in 0..count {
                            for j in 0..D {
                                image[mode][j] = time * (image[mode][j] + least * one[mode][j]);
                            }
                        }
                    }
                    for mode in 0..count {
                        for j in 0..D {
                            stiff[mode][j][i][c] = image[mode][j];
                        }
                    }
                }
            }
            if self.of == Of::Damping {
                least = P::Part::zero();
            }
            let mut second = [[zero; N]; D];
            for i in 0..D {
                for c in 0..N - 1 {
                    for mode in 0..count {
                        for j in 0..D {
                            let weight = change[mode][j][i][c];
                            for k in 0..D {
                                for d in 0..N - 1 {
                                    second[i][c][k][d] += weight * stiff[mode][j][k][d];
                                }
                            }
                        }
                    }
                    if c >= D {
                        second[i][c][i][c] += least;
                    }
                }
            }
            for i in 0..D {
                for j in 0..D {
                    let from = &self.tangent[((k * D + i) * D + j) * D * D * WIDTH..];
                    let own = read_matrix::<P::Part, D>(from, part);
                    for m in 0..D {
                        for l in 0..D {
                            second[i][j][m][l] += measure * own[m][l];
                        }
                    }
                }
            }
            if turns && self.of == Of::Energy(Definiteness::Exact) {
                let mut on_frame = matrix::zeros::<P::Part, D>();
                for mode in 0..count {
                    for i in 0..D {
                        for l in 0..D {
                            on_frame[i][l] += g[mode][i] * force[mode][l];
                            for m in 0..D {
                                let mut mixed = P::Part::zero();
                                for j in 0..D {
                                    mixed += force[mode][j] * slope[m][j][i][l];
                                }
                                second[i][l][m][D + mode] += mixed;
                                second[m][D + mode][i][l] += mixed;
                            }
                        }
                    }
                }
                // In the plane cof F is linear in F.
                if D == 3 {
                    let mut bent: Tangent<P::Part, D> = no_tangent();
                    add_cofactor_derivative(&mut bent, half, &on_frame);
                    for i in 0..D {
                        for j in 0..D {
                            for m in 0..D {
                                for l in 0..D {
                                    second[i][j][m][l] += bent[i][j][m][l];
                                }
                            }
                        }
                    }
                }
            }
            for i in 0..D {
                for node in 0..N {
                    let mut row = zero;
                    for c in 0..N - 1 {
                        for m in 0..D {
                            for d in 0..N - 1 {
                                row[m][d] += weights[node][c] * second[i][c][m][d];
                            }
                        }
                    }
                    for other in node..N {
                        for m in 0..D {
                            let mut sum = P::Part::zero();
                            for d in 0..N - 1 {
                                sum += row[m][d] * weights[other][d];
                            }
                            let at = ((node * N + other) * D * D + i * D + m) * WIDTH + part * P::Part::NUMBERS;
                            sum.store(&mut self.blocks[at..]);
                        }
                    }
                }
            }
        }
    }
}
