//! The work on quadrilaterals and hexahedra, compiled for every set of vector instructions.
//!
//! A cell has the mean F of its deformation gradient and hourglass amplitudes gₐ. It is asked at Gauss's points, with
//!
//! F_q = F (1 + ε_q),  ε_q = Σ_s βₛ f_s(q) D_s,  β = X q,  qₐ = F⁻¹ gₐ,
//!
//! where ε_q is the strain of the assumed stresses ([`super::hourglass`]), carried along by F. Its energy is
//!
//! U = Σ_q V_q ψ(F_q; μ, λ′) + V ψ(F; 0, λ − λ′) + ½ (λ − λ′) Σ_q V_q tr² ε_q + ½ (1 − s) Σ kₐ gₐ·gₐ,  λ′ = min(λ, 2μ):
//!
//! what resists volume beyond λ′ sees the mean F, since no cell of so few corners could bend much and keep the volume of every
//! point (all laws are linear in μ and λ). F⁻¹ is cof Fᵀ φ(J) with φ = J/(J² + δ² (1 − J)²): it is F⁻¹ at rest and nearly so while
//! the cell has a volume, and goes to zero with it; there s = Jφ does too, and stiffness of no direction is left in its place.
//! Under `linear`, which does not know of rotations, F_q is F + ε_q and q is g. In plane stress λ′ is λ.

use super::elements::Shape;
use super::hourglass::{
    FIELDS, MOST_MODES, MOST_STRESSES, PAIR, PAIRS, SIGNS, TERMS, fields, modes, pairs, stiffness_numbers, stored,
};
use super::law::{PARAMETERS, read_matrix, write_matrix};
use super::section::{Group, NUMBERS};
use super::work::{Nodes, gather, scatter};
use core::marker::PhantomData;
use opruga_core::state::Layout;
use opruga_math::matrix::{self, Matrix};
use opruga_math::{Lane, Pack, Register, WIDTH, Work};

/// δ²: cells that have lost most of their volume lose the stiffness of the law against bending.
const FLAT: f64 = 0.01;

/// What is kept of a cell between the steps of a pass: F, g and β.
pub(super) const KEPT: usize = 9 + MOST_MODES * 3 + MOST_STRESSES;

/// Amplitudes, or what belongs to them: mode by mode.
pub(super) type Modes<R, const D: usize> = [[R; D]; MOST_MODES];

/// Factors of the assumed stresses, or what belongs to them.
pub(super) type Stresses<R> = [R; MOST_STRESSES];

/// What does not change of a pack of cells.
pub(super) struct Rest<R, const D: usize, const N: usize> {
    /// The shares of the corners in F and g.
    pub(super) weights: [[R; N]; N],
    /// The measures of the points.
    pub(super) measures: [R; N],
    /// The means of the functions of the assumed stresses.
    means: [R; FIELDS],
    /// Columns: the axes of the cell.
    axes: Matrix<R, D>,
}

impl<R: Register, const D: usize, const N: usize> Rest<R, D, N> {
    #[inline(always)]
    pub(super) fn read(group: &Group<'_>, pack: usize, part: usize) -> Self {
        let count = stored::<D, N>();
        let batch = group.layout == Layout::Batch;
        let from = if batch {
            &group.geometry[pack * count..(pack + 1) * count]
        } else {
            &group.geometry[pack * count * WIDTH..(pack + 1) * count * WIDTH]
        };
        let at = |k: usize| {
            if batch { R::splat(from[k]) } else { R::load(&from[k * WIDTH + part * R::NUMBERS..]) }
        };
        let mut out = Rest {
            weights: [[R::zero(); N]; N],
            measures: [R::zero(); N],
            means: [R::zero(); FIELDS],
            axes: matrix::zeros(),
        };
        for a in 0..N {
            for c in 0..N - 1 {
                out.weights[a][c] = at(a * (N - 1) + c);
            }
        }
        let start = N * (N - 1);
        for q in 0..N {
            out.measures[q] = at(start + q);
        }
        let start = start + N;
        for k in 0..fields::<D>() {
            out.means[k] = at(start + k);
        }
        let start = start + fields::<D>();
        for i in 0..D {
            for j in 0..D {
                out.axes[i][j] = at(start + i * D + j);
            }
        }
        out
    }
    #[inline(always)]
    pub(super) fn measure(&self) -> R {
        let mut sum = self.measures[0];
        for q in 1..N {
            sum += self.measures[q];
        }
        sum
    }
    /// The functions of the assumed stresses at a point.
    #[inline(always)]
    pub(super) fn functions(&self, q: usize) -> [R; FIELDS] {
        let mut out = [R::zero(); FIELDS];
        for k in 0..fields::<D>() {
            out[k] = R::splat(SIGNS[q][k]) - self.means[k];
        }
        out
    }
    /// The strains of the assumed stresses, s − c tr s 1 of the symmetric products of the axes of the cell.
    #[inline(always)]
    pub(super) fn strains(&self, c: R) -> [Matrix<R, D>; PAIRS] {
        let half = R::splat(0.5);
        let mut out = [matrix::zeros::<R, D>(); PAIRS];
        for pair in 0..pairs::<D>() {
            let (a, b) = PAIR[pair];
            for i in 0..D {
                for j in 0..D {
                    out[pair][i][j] = half * (self.axes[i][a] * self.axes[j][b] + self.axes[i][b] * self.axes[j][a]);
                }
            }
            let less = c * matrix::trace(&out[pair]);
            for i in 0..D {
                out[pair][i][i] -= less;
            }
        }
        out
    }
}

/// What a pack of cells resists with.
pub(super) struct Resistance<R> {
    /// Of the trace in the strain of a stress.
    pub(super) c: R,
    /// λ − λ′ [Pa].
    pub(super) beyond: R,
    /// kₐ [N/m].
    pub(super) guards: [R; MOST_MODES],
}

/// The numbers of the material of a pack.
#[inline(always)]
fn numbers<'a, const D: usize, const N: usize>(group: &Group<'a>, pack: usize) -> &'a [f64] {
    let count = stiffness_numbers::<D, N>();
    &group.stiffness[pack * count * WIDTH..(pack + 1) * count * WIDTH]
}

impl<R: Register> Resistance<R> {
    #[inline(always)]
    pub(super) fn read<const D: usize, const N: usize>(group: &Group<'_>, pack: usize, part: usize) -> Self {
        let from = numbers::<D, N>(group, pack);
        let size = modes::<D, N>() * D;
        let at = |k: usize| R::load(&from[(size * size + k) * WIDTH + part * R::NUMBERS..]);
        let mut guards = [R::zero(); MOST_MODES];
        for mode in 0..modes::<D, N>() {
            guards[mode] = at(2 + mode);
        }
        Resistance { c: at(0), beyond: at(1), guards }
    }
}

/// X of a pack of cells, row by row.
#[inline(always)]
pub(super) fn response<R: Register, const D: usize, const N: usize>(
    group: &Group<'_>,
    pack: usize,
    part: usize,
    s: usize,
    amplitude: usize,
) -> R {
    let size = modes::<D, N>() * D;
    R::load(&numbers::<D, N>(group, pack)[(s * size + amplitude) * WIDTH + part * R::NUMBERS..])
}

/// β = X q.
#[inline(always)]
fn factors<R: Register, const D: usize, const N: usize>(
    group: &Group<'_>,
    pack: usize,
    part: usize,
    q: &Modes<R, D>,
) -> Stresses<R> {
    let size = modes::<D, N>() * D;
    let mut out = [R::zero(); MOST_STRESSES];
    for s in 0..size {
        for k in 0..size {
            out[s] += response::<R, D, N>(group, pack, part, s, k) * q[k / D][k % D];
        }
    }
    out
}

/// Xᵀ of forces on β.
#[inline(always)]
pub(super) fn on_amplitudes<R: Register, const D: usize, const N: usize>(
    group: &Group<'_>,
    pack: usize,
    part: usize,
    on: &Stresses<R>,
) -> Modes<R, D> {
    let size = modes::<D, N>() * D;
    let mut out = [[R::zero(); D]; MOST_MODES];
    for s in 0..size {
        for k in 0..size {
            out[k / D][k % D] += response::<R, D, N>(group, pack, part, s, k) * on[s];
        }
    }
    out
}

/// What ε at a point has of the strain of each pair of axes.
#[inline(always)]
fn along_pairs<R: Lane, const D: usize, const N: usize>(beta: &Stresses<R>, functions: &[R; FIELDS]) -> [R; PAIRS] {
    let mut along = [R::zero(); PAIRS];
    for s in 0..modes::<D, N>() * D {
        let (pair, field) = TERMS[s];
        along[pair] += beta[s] * functions[field];
    }
    along
}

/// ε at a point, or F ε of F times the strains.
#[inline(always)]
pub(super) fn strain<R: Lane, const D: usize, const N: usize>(
    beta: &Stresses<R>,
    functions: &[R; FIELDS],
    strains: &[Matrix<R, D>; PAIRS],
) -> Matrix<R, D> {
    let along = along_pairs::<R, D, N>(beta, functions);
    let mut out = matrix::zeros::<R, D>();
    for pair in 0..pairs::<D>() {
        out = matrix::plus(&out, along[pair], &strains[pair]);
    }
    out
}

/// tr ε at a point of the traces of the strains.
#[inline(always)]
fn swelling<R: Lane, const D: usize, const N: usize>(
    beta: &Stresses<R>,
    functions: &[R; FIELDS],
    traces: &[R; PAIRS],
) -> R {
    let along = along_pairs::<R, D, N>(beta, functions);
    let mut out = R::zero();
    for pair in 0..pairs::<D>() {
        out += along[pair] * traces[pair];
    }
    out
}

/// ∂F_q/∂β but for the functions, F D or D, and the traces of D.
#[inline(always)]
pub(super) fn carried<R: Lane, const D: usize>(
    turns: bool,
    f: &Matrix<R, D>,
    strains: &[Matrix<R, D>; PAIRS],
) -> ([Matrix<R, D>; PAIRS], [R; PAIRS]) {
    let (mut out, mut traces) = (*strains, [R::zero(); PAIRS]);
    for pair in 0..pairs::<D>() {
        traces[pair] = matrix::trace(&strains[pair]);
        if turns {
            out[pair] = matrix::product(f, &strains[pair]);
        }
    }
    (out, traces)
}

/// The change of cof F with F along Z; the same with F and Z exchanged.
#[inline(always)]
pub(super) fn cofactor_along<R: Lane, const D: usize>(f: &Matrix<R, D>, z: &Matrix<R, D>) -> Matrix<R, D> {
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

/// cof F, φ and 1 − s of a deformation gradient, with their derivatives by J.
pub(super) struct Frame<R, const D: usize> {
    pub(super) cofactors: Matrix<R, D>,
    pub(super) phi: [R; 3],
    /// 1 − s, −s′, −s″.
    pub(super) lost: [R; 3],
}

impl<R: Lane, const D: usize> Frame<R, D> {
    #[inline(always)]
    pub(super) fn new(f: &Matrix<R, D>) -> Self {
        let cofactors = matrix::cofactor(f);
        let j = matrix::determinant_by(f, &cofactors);
        let (flat, two) = (R::splat(FLAT), R::splat(2.0));
        let change = R::one() - j;
        let inverse = R::one() / (j * j + flat * change * change);
        let slope = two * (j - flat * change);
        let bend = R::splat(2.0 * (1.0 + FLAT));
        let phi = j * inverse;
        let first = inverse - phi * slope * inverse;
        let second = (two * slope * slope * phi * inverse - two * slope * inverse - phi * bend) * inverse;
        let lost = [flat * change * change * inverse, -(phi + j * first), -(two * first + j * second)];
        Frame { cofactors, phi: [phi, first, second], lost }
    }
    /// Cᵀ of amplitudes.
    #[inline(always)]
    fn pulled(cofactors: &Matrix<R, D>, modes: usize, g: &Modes<R, D>) -> Modes<R, D> {
        let mut out = [[R::zero(); D]; MOST_MODES];
        for mode in 0..modes {
            for k in 0..D {
                for j in 0..D {
                    out[mode][k] += cofactors[j][k] * g[mode][j];
                }
            }
        }
        out
    }
}

/// F, g and β of a part of a pack.
pub(super) struct Kept<R, const D: usize> {
    pub(super) f: Matrix<R, D>,
    pub(super) g: Modes<R, D>,
    pub(super) beta: Stresses<R>,
}

impl<R: Register, const D: usize> Kept<R, D> {
    #[inline(always)]
    pub(super) fn read<const N: usize>(from: &[f64], part: usize) -> Self {
        let at = |k: usize| R::load(&from[k * WIDTH + part * R::NUMBERS..]);
        let (mut g, mut beta) = ([[R::zero(); D]; MOST_MODES], [R::zero(); MOST_STRESSES]);
        for k in 0..modes::<D, N>() * D {
            g[k / D][k % D] = at(9 + k);
            beta[k] = at(9 + MOST_MODES * 3 + k);
        }
        Kept { f: read_matrix(from, part), g, beta }
    }
    #[inline(always)]
    fn write<const N: usize>(&self, to: &mut [f64], part: usize) {
        write_matrix(to, part, &self.f);
        for k in 0..modes::<D, N>() * D {
            self.g[k / D][k % D].store(&mut to[(9 + k) * WIDTH + part * R::NUMBERS..]);
            self.beta[k].store(&mut to[(9 + MOST_MODES * 3 + k) * WIDTH + part * R::NUMBERS..]);
        }
    }
}

/// The mean gradient and the amplitudes of positions or velocities.
#[inline(always)]
fn mean<R: Register, const D: usize, const N: usize>(
    x: &[[R; D]; N],
    weights: &[[R; N]; N],
) -> (Matrix<R, D>, Modes<R, D>) {
    // Differences to the first corner: what is far away has all digits of its shape.
    let mut sums = [[R::zero(); D]; N];
    for a in 1..N {
        for i in 0..D {
            let from_first = x[a][i] - x[0][i];
            for c in 0..N - 1 {
                sums[c][i] += weights[a][c] * from_first;
            }
        }
    }
    let mut f = matrix::zeros::<R, D>();
    let mut g = [[R::zero(); D]; MOST_MODES];
    for i in 0..D {
        for j in 0..D {
            f[i][j] = sums[j][i];
        }
        for mode in 0..modes::<D, N>() {
            g[mode][i] = sums[D + mode][i];
        }
    }
    (f, g)
}

/// Deformation gradients at the points: Gauss's, and behind them the mean one where the law is asked there.
pub(super) struct Deform<'a, E, const D: usize, const N: usize> {
    pub(super) shape: PhantomData<E>,
    pub(super) group: Group<'a>,
    pub(super) positions: Nodes<'a, D>,
    /// D² packs for every pack of points.
    pub(super) gradient: &'a mut [f64],
    /// [`KEPT`] packs for every pack of cells.
    pub(super) kept: &'a mut [f64],
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
                let strains = rest.strains(Resistance::<P::Part>::read::<D, N>(&self.group, pack, part).c);
                let (f, g) = mean(&x, &rest.weights);
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
                let kept = Kept { f, g, beta: factors::<P::Part, D, N>(&self.group, pack, part, &q) };
                kept.write::<N>(&mut self.kept[k * KEPT * WIDTH..], part);
                let (along, _) = carried(turns, &f, &strains);
                for point in 0..points {
                    let mut own = f;
                    if point < N {
                        let by = strain::<_, D, N>(&kept.beta, &rest.functions(point), &along);
                        own = matrix::plus(&f, P::Part::one(), &by);
                    }
                    write_matrix(&mut self.gradient[(k * points + point) * D * D * WIDTH..], part, &own);
                }
            }
        }
    }
}

/// Rates of the same.
pub(super) struct DeformRates<'a, E, const D: usize, const N: usize> {
    pub(super) shape: PhantomData<E>,
    pub(super) group: Group<'a>,
    pub(super) velocities: Nodes<'a, D>,
    /// Of the positions.
    pub(super) kept: &'a [f64],
    pub(super) rate: &'a mut [f64],
    /// Rates of F, g and β.
    pub(super) kept_rate: &'a mut [f64],
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
                let strains = rest.strains(Resistance::<P::Part>::read::<D, N>(&self.group, pack, part).c);
                let Kept { f, g, beta } = Kept::<P::Part, D>::read::<N>(&self.kept[k * KEPT * WIDTH..], part);
                let (f_rate, g_rate) = mean(&v, &rest.weights);
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
                let beta_rate = factors::<P::Part, D, N>(&self.group, pack, part, &q_rate);
                let kept = Kept { f: f_rate, g: g_rate, beta: beta_rate };
                kept.write::<N>(&mut self.kept_rate[k * KEPT * WIDTH..], part);
                for point in 0..points {
                    let mut own = f_rate;
                    if point < N {
                        let functions = rest.functions(point);
                        let now = strain::<_, D, N>(&beta, &functions, &strains);
                        let grows = strain::<_, D, N>(&beta_rate, &functions, &strains);
                        let by = if turns {
                            matrix::plus(&matrix::product(&f_rate, &now), P::Part::one(), &matrix::product(&f, &grows))
                        } else {
                            grows
                        };
                        own = matrix::plus(&f_rate, P::Part::one(), &by);
                    }
                    write_matrix(&mut self.rate[(k * points + point) * D * D * WIDTH..], part, &own);
                }
            }
        }
    }
}

/// The parameters of the points of boxes: λ′ at Gauss's, and what is beyond it at the mean.
pub(super) fn parameters_of_points<const N: usize>(group: &Group<'_>, parameters: &mut [f64], times: &mut [f64]) {
    let split = group.points > N;
    for k in 0..group.packs {
        let numbers = &group.parameters[(group.first + k) * group.step..][..NUMBERS * WIDTH];
        for q in 0..group.points {
            let point = k * group.points + q;
            let to = &mut parameters[point * PARAMETERS * WIDTH..(point + 1) * PARAMETERS * WIDTH];
            to.copy_from_slice(&numbers[..PARAMETERS * WIDTH]);
            times[point * WIDTH..(point + 1) * WIDTH].copy_from_slice(&numbers[PARAMETERS * WIDTH..]);
            for l in (0..WIDTH).filter(|_| split) {
                let (mu, lambda) = (numbers[l], numbers[WIDTH + l]);
                (to[l], to[WIDTH + l]) =
                    if q < N { (mu, lambda - beyond(mu, lambda)) } else { (0.0, beyond(mu, lambda)) };
            }
        }
    }
}

/// λ − λ′.
pub(super) fn beyond(mu: f64, lambda: f64) -> f64 {
    if lambda > 2.0 * mu { lambda - 2.0 * mu } else { 0.0 }
}

/// Rates of a state, for damping.
pub(super) struct Rates<'a> {
    /// As [`DeformRates`] leaves them.
    pub(super) kept: &'a [f64],
    /// Retardation times of the points.
    pub(super) times: &'a [f64],
    /// Densities of power, which become powers of cells.
    pub(super) power: &'a mut [f64],
}

/// Forces of cells onto nodes; densities of energy and power become energies and powers of cells.
pub(super) struct Push<'a, E, const D: usize, const N: usize> {
    pub(super) shape: PhantomData<E>,
    pub(super) group: Group<'a>,
    pub(super) kept: &'a [f64],
    pub(super) stress: &'a [f64],
    pub(super) density: &'a mut [f64],
    pub(super) rates: Option<Rates<'a>>,
    pub(super) force: &'a mut [f64],
}

impl<E: Shape<D, N>, const D: usize, const N: usize> Work for Push<'_, E, D, N> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(mut self) {
        let (count, turns, points) = (modes::<D, N>(), self.group.turns, self.group.points);
        let half = P::Part::splat(0.5);
        let mut slots = [[P::zero(); D]; N];
        for k in 0..self.group.packs {
            let pack = self.group.first + k;
            for part in 0..P::PARTS {
                let offset = part * P::Part::NUMBERS;
                let rest = Rest::<P::Part, D, N>::read(&self.group, pack, part);
                let own = Resistance::<P::Part>::read::<D, N>(&self.group, pack, part);
                let strains = rest.strains(own.c);
                let Kept { f, g, beta } = Kept::<P::Part, D>::read::<N>(&self.kept[k * KEPT * WIDTH..], part);
                let (along, traces) = carried(turns, &f, &strains);
                // ∂U/∂F but for ε, and Σ V f P and Σ V f p of the stresses and of the pressure beyond them.
                let mut on_f = matrix::zeros::<P::Part, D>();
                let mut stresses = [matrix::zeros::<P::Part, D>(); FIELDS];
                let mut pressures = [P::Part::zero(); FIELDS];
                let (mut energy, mut lost) = (P::Part::zero(), P::Part::zero());
                for q in 0..N {
                    let point = k * points + q;
                    let (functions, weight) = (rest.functions(q), rest.measures[q]);
                    let stress = read_matrix::<P::Part, D>(&self.stress[point * D * D * WIDTH..], part);
                    let stress = matrix::scaled(&stress, weight);
                    let swells = swelling::<_, D, N>(&beta, &functions, &traces);
                    let mut pressure = own.beyond * weight * swells;
                    energy +=
                        weight * P::Part::load(&self.density[point * WIDTH + offset..]) + half * pressure * swells;
                    if let Some(rates) = &self.rates {
                        let kept = Kept::<P::Part, D>::read::<N>(&rates.kept[k * KEPT * WIDTH..], part);
                        let rate = swelling::<_, D, N>(&kept.beta, &functions, &traces);
                        let time = P::Part::load(&rates.times[point * WIDTH + offset..]);
                        let drag = time * own.beyond * weight * rate;
                        pressure += drag;
                        lost += weight * P::Part::load(&rates.power[point * WIDTH + offset..]) + drag * rate;
                    }
                    on_f = matrix::plus(&on_f, P::Part::one(), &stress);
                    for field in 0..fields::<D>() {
                        stresses[field] = matrix::plus(&stresses[field], functions[field], &stress);
                        pressures[field] += functions[field] * pressure;
                    }
                }
                let mut on_beta = [P::Part::zero(); MOST_STRESSES];
                let mut by_strain = [matrix::zeros::<P::Part, D>(); PAIRS];
                for s in 0..count * D {
                    let (pair, field) = TERMS[s];
                    on_beta[s] = matrix::inner(&stresses[field], &along[pair]) + pressures[field] * traces[pair];
                    by_strain[pair] = matrix::plus(&by_strain[pair], beta[s], &stresses[field]);
                }
                if turns {
                    for pair in 0..pairs::<D>() {
                        let turned = matrix::product(&by_strain[pair], &strains[pair]);
                        on_f = matrix::plus(&on_f, P::Part::one(), &turned);
                    }
                }
                if points > N {
                    let (point, measure) = (k * points + N, rest.measure());
                    let stress = read_matrix::<P::Part, D>(&self.stress[point * D * D * WIDTH..], part);
                    on_f = matrix::plus(&on_f, measure, &stress);
                    energy += measure * P::Part::load(&self.density[point * WIDTH + offset..]);
                    if let Some(rates) = &self.rates {
                        lost += measure * P::Part::load(&rates.power[point * WIDTH + offset..]);
                    }
                }
                let on_q = on_amplitudes::<P::Part, D, N>(&self.group, pack, part, &on_beta);
                let mut on_g = on_q;
                if turns {
                    let frame = Frame::new(&f);
                    let mut on_cofactors = matrix::zeros::<P::Part, D>();
                    let mut guarded = P::Part::zero();
                    for mode in 0..count {
                        for j in 0..D {
                            let stiff = own.guards[mode] * g[mode][j];
                            guarded += stiff * g[mode][j];
                            let mut sum = P::Part::zero();
                            for i in 0..D {
                                on_cofactors[j][i] += g[mode][j] * on_q[mode][i];
                                sum += frame.cofactors[j][i] * on_q[mode][i];
                            }
                            on_g[mode][j] = frame.phi[0] * sum + frame.lost[0] * stiff;
                        }
                    }
                    let on_volume =
                        frame.phi[1] * matrix::inner(&on_cofactors, &frame.cofactors) + half * frame.lost[1] * guarded;
                    on_f = matrix::plus(&on_f, frame.phi[0], &cofactor_along(&f, &on_cofactors));
                    on_f = matrix::plus(&on_f, on_volume, &frame.cofactors);
                    energy += half * frame.lost[0] * guarded;
                }
                let mut columns = [[P::Part::zero(); D]; N];
                for i in 0..D {
                    for j in 0..D {
                        columns[j][i] = on_f[i][j];
                    }
                    for mode in 0..count {
                        columns[D + mode][i] = on_g[mode][i];
                    }
                }
                for node in 0..N {
                    for i in 0..D {
                        let mut sum = P::Part::zero();
                        for c in 0..N - 1 {
                            sum += rest.weights[node][c] * columns[c][i];
                        }
                        slots[node][i].set_part(part, -sum);
                    }
                }
                // Packs are summed in order, so no density that is still needed lies here.
                energy.store(&mut self.density[k * WIDTH + offset..]);
                if let Some(rates) = &mut self.rates {
                    lost.store(&mut rates.power[k * WIDTH + offset..]);
                }
            }
            scatter(&self.group, pack, &slots, self.force);
        }
    }
}
