//! Matrices of quadrilaterals and hexahedra, compiled for every set of vector instructions.
//!
//! The energy of [`super`] is differentiated by F and β first, where every point adds
//!
//! ∂F_q/∂βₛ = f_s(q) F D_s,  ∂F_q/∂F = · (1 + ε_q),
//!
//! and then, since β depends on F and g, by these; the corners come last.

use super::super::elements::Shape;
use super::super::group::Group;
use super::hourglass::{FIELDS, MOST_MODES, MOST_STRESSES, PAIRS, modes, pairs, term};
use super::rest::Rest;
use super::{Frame, KEPT, Kept, Modes, cofactor_along, corners};
use crate::materials::material::{Tangent, add_cofactor_derivative, no_tangent};
use crate::materials::points::read_matrix;
use core::marker::PhantomData;
use opruga_core::potential::Definiteness;
use opruga_math::matrix::{self, Matrix};
use opruga_math::{Lane, Pack, Register, WIDTH, Work};

/// What a matrix of cells is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in super::super) enum Of {
    /// Energy; clamped: without what could be negative.
    Energy(Definiteness),
    /// Damping.
    Damping,
}

/// Tangents at the points of one pack of cells to blocks K_ab, a ≤ b, `[(a N + b)][i][k]` packs.
pub(in super::super) struct Contract<'a, E, const D: usize, const N: usize> {
    pub(in super::super) shape: PhantomData<E>,
    pub(in super::super) group: Group<'a>,
    /// Which pack of the group.
    pub(in super::super) pack: usize,
    pub(in super::super) of: Of,
    /// As [`super::Deform`] leaves it.
    pub(in super::super) kept: &'a [f64],
    /// At the points; looked at where the energy is differentiated exactly.
    pub(in super::super) stress: &'a [f64],
    /// D⁴ packs for every pack of points.
    pub(in super::super) tangent: &'a [f64],
    pub(in super::super) times: &'a [f64],
    pub(in super::super) blocks: &'a mut [f64],
}

/// How many amplitudes there are at most.
const AMPLITUDES: usize = MOST_MODES * 3;

/// Second derivatives by F and β, and what the first derivatives by β are made of.
struct Sums<R, const D: usize> {
    /// By F and F, of rows that do not fall.
    ff: Tangent<R, D>,
    /// By F and β.
    fb: [Matrix<R, D>; MOST_STRESSES],
    /// By β and β, of numbers that do not fall.
    bb: [[R; MOST_STRESSES]; MOST_STRESSES],
    /// By β.
    on_beta: [R; MOST_STRESSES],
}

/// Second derivatives by the columns of F and g: rows i ≤ m of columns c and d at `[i][m][c][d]`.
struct ByColumns<R, const D: usize, const N: usize>([[[[R; N]; N]; D]; D]);

impl<R: Lane, const D: usize, const N: usize> ByColumns<R, D, N> {
    /// By two different columns.
    #[inline(always)]
    fn add(&mut self, [i, c]: [usize; 2], [m, d]: [usize; 2], value: R) {
        if i <= m {
            self.0[i][m][c][d] += value;
        }
        if m <= i {
            self.0[m][i][d][c] += value;
        }
    }
}

impl<E: Shape<D, N>, const D: usize, const N: usize> Contract<'_, E, D, N> {
    #[inline(always)]
    fn tangent_at<R: Register>(&self, point: usize, part: usize) -> Tangent<R, D> {
        let mut out = no_tangent();
        for i in 0..D {
            for j in 0..D {
                out[i][j] = read_matrix(&self.tangent[((point * D + i) * D + j) * D * D * WIDTH..], part);
            }
        }
        out
    }

    /// The sums over the points.
    #[inline(always)]
    fn points<R: Register>(&self, part: usize, rest: &Rest<'_, R, D, N>, kept: &Kept<R, D>) -> Sums<R, D> {
        let (turns, size, points) = (self.group.turns, modes::<D, N>() * D, self.group.points);
        let one = matrix::identity::<R, D>();
        let strained = rest.strained(&if turns { kept.f } else { one });
        let plain = rest.strained(&one);
        // ∂F_q/∂β but for the functions.
        let (along, traces) = strained.pairs();
        // ∂F_q/∂F: · (1 + ε_q).
        let mut grown = [one; N];
        if turns {
            let fields = plain.fields(&kept.beta);
            rest.matrices_at_points(&one, &fields, |i, j, own| (0..N).for_each(|q| grown[q][i][j] = own[q]));
        }
        let mut sums = Sums {
            ff: no_tangent(),
            fb: [matrix::zeros(); MOST_STRESSES],
            bb: [[R::zero(); MOST_STRESSES]; MOST_STRESSES],
            on_beta: [R::zero(); MOST_STRESSES],
        };
        let mut squares = [[[R::zero(); N]; PAIRS]; PAIRS];
        for q in 0..N {
            let point = self.pack * points + q;
            let (grown, weight) = (&grown[q], rest.measures[q]);
            let tangent = self.tangent_at::<R>(point, part);
            let weighted = matrix::scaled(grown, weight);
            for m in 0..D {
                for n in 0..D {
                    // What the stress does as F changes along m by that row.
                    let mut by = [[R::zero(); D]; D];
                    for i in 0..=m {
                        for l in 0..D {
                            for k in 0..D {
                                by[i][l] += tangent[i][l][m][k] * grown[n][k];
                            }
                        }
                        for j in 0..D {
                            for l in 0..D {
                                sums.ff[i][j][m][n] += weighted[j][l] * by[i][l];
                            }
                        }
                    }
                }
            }
            let mut image = [matrix::zeros::<R, D>(); PAIRS];
            let mut on_f = image;
            for pair in 0..pairs::<D>() {
                for i in 0..D {
                    for j in 0..D {
                        image[pair][i][j] = weight * matrix::inner(&tangent[i][j], &along[pair]);
                    }
                }
                on_f[pair] = if turns { matrix::product(&image[pair], grown) } else { image[pair] };
            }
            let mut beyond = rest.beyond * weight;
            if self.of == Of::Damping {
                beyond = beyond * R::load(&self.times[point * WIDTH + part * R::NUMBERS..]);
            }
            for a in 0..pairs::<D>() {
                for b in a..pairs::<D>() {
                    squares[a][b][q] = matrix::inner(&along[a], &image[b]) + beyond * traces[a] * traces[b];
                }
            }
            let functions = rest.functions(q);
            for s in 0..size {
                let (pair, field) = term::<D>(s);
                sums.fb[s] = matrix::plus(&sums.fb[s], functions[field], &on_f[pair]);
            }
        }
        for a in 0..pairs::<D>() {
            for b in a..pairs::<D>() {
                squares[a][b] = corners::sums(&squares[a][b]);
            }
        }
        for s in 0..size {
            for t in s..size {
                let ((a, f), (b, g)) = (term::<D>(s), term::<D>(t));
                let own = if a <= b { &squares[a][b] } else { &squares[b][a] };
                sums.bb[s][t] = rest.square(own, f, g);
            }
        }
        if points > N {
            let tangent = self.tangent_at::<R>(self.pack * points + N, part);
            let measure = rest.measure();
            for i in 0..D {
                for j in 0..D {
                    for m in i..D {
                        for n in 0..D {
                            sums.ff[i][j][m][n] += measure * tangent[i][j][m][n];
                        }
                    }
                }
            }
        }
        if turns && self.of == Of::Energy(Definiteness::Exact) {
            let mut stresses = [matrix::zeros::<R, D>(); FIELDS];
            for i in 0..D {
                for j in 0..D {
                    let mut at = rest.measures;
                    for q in 0..N {
                        let from = ((self.pack * points + q) * D * D + i * D + j) * WIDTH + part * R::NUMBERS;
                        at[q] = at[q] * R::load(&self.stress[from..]);
                    }
                    let (_, of_fields) = rest.over_points(&at);
                    for field in 0..FIELDS {
                        stresses[field][i][j] = of_fields[field];
                    }
                }
            }
            let mut at = rest.at_points(R::zero(), &strained.traces(&kept.beta));
            for q in 0..N {
                at[q] = rest.beyond * rest.measures[q] * at[q];
            }
            sums.on_beta = strained.pulls(&kept.beta, &stresses, &rest.over_points(&at).1).on_beta;
            let (strains, _) = plain.pairs();
            for s in 0..size {
                let (pair, field) = term::<D>(s);
                let turned = matrix::product(&stresses[field], &strains[pair]);
                sums.fb[s] = matrix::plus(&sums.fb[s], R::one(), &turned);
            }
        }
        sums
    }

    /// Second derivatives by F and g, of those by F and β.
    #[inline(always)]
    fn by_columns<R: Register>(
        &self,
        rest: &Rest<'_, R, D, N>,
        kept: &Kept<R, D>,
        sums: &Sums<R, D>,
    ) -> ByColumns<R, D, N> {
        let (count, size, turns) = (modes::<D, N>(), modes::<D, N>() * D, self.group.turns);
        let mut second = ByColumns([[[[R::zero(); N]; N]; D]; D]);
        // By q instead of β: with F, and with q.
        let mut fq = [matrix::zeros::<R, D>(); AMPLITUDES];
        let mut half = [[R::zero(); AMPLITUDES]; MOST_STRESSES];
        let mut qq = [[R::zero(); AMPLITUDES]; AMPLITUDES];
        for k in 0..size {
            for s in rest.stresses(k) {
                let response = rest.response(s, k);
                fq[k] = matrix::plus(&fq[k], response, &sums.fb[s]);
                for t in 0..size {
                    half[t][k] += response * if s <= t { sums.bb[s][t] } else { sums.bb[t][s] };
                }
            }
        }
        for k in 0..size {
            for s in rest.stresses(k) {
                let response = rest.response(s, k);
                for l in k..size {
                    qq[k][l] += response * half[s][l];
                }
            }
            for l in 0..k {
                qq[k][l] = qq[l][k];
            }
        }
        if !turns {
            for i in 0..D {
                for m in i..D {
                    for c in 0..D {
                        for d in 0..D {
                            second.0[i][m][c][d] = sums.ff[i][c][m][d];
                        }
                    }
                    for mode in 0..count {
                        for other in 0..count {
                            second.0[i][m][D + mode][D + other] = qq[mode * D + i][other * D + m];
                        }
                    }
                }
                for c in 0..D {
                    for k in 0..size {
                        second.add([i, c], [k % D, D + k / D], fq[k][i][c]);
                    }
                }
            }
            return second;
        }

        let Kept { f, g, .. } = kept;
        let frame = Frame::new(f);
        let cofactors = &frame.cofactors;
        // ∂cof F/∂F.
        let mut slope: Tangent<R, D> = no_tangent();
        add_cofactor_derivative(&mut slope, R::one(), f);
        // ∂q/∂F; ∂q/∂g is φ cof Fᵀ.
        let mut change = [matrix::zeros::<R, D>(); AMPLITUDES];
        for mode in 0..count {
            for k in 0..D {
                let mut own = R::zero();
                for j in 0..D {
                    own += cofactors[j][k] * g[mode][j];
                }
                let own = frame.phi[1] * own;
                for i in 0..D {
                    for c in 0..D {
                        let mut turned = R::zero();
                        for j in 0..D {
                            // Cofactors of a row do not change with that row.
                            if i != j {
                                turned += slope[j][k][i][c] * g[mode][j];
                            }
                        }
                        change[mode * D + k][i][c] = cofactors[i][c] * own + frame.phi[0] * turned;
                    }
                }
            }
        }
        // By F and q, of everything that F does.
        let mut whole = fq;
        for k in 0..size {
            for l in 0..size {
                whole[k] = matrix::plus(&whole[k], qq[k][l], &change[l]);
            }
        }
        for i in 0..D {
            for m in i..D {
                for c in 0..D {
                    for d in 0..D {
                        let mut sum = sums.ff[i][c][m][d];
                        for k in 0..size {
                            sum += whole[k][i][c] * change[k][m][d] + change[k][i][c] * fq[k][m][d];
                        }
                        second.0[i][m][c][d] = sum;
                    }
                }
            }
            for c in 0..D {
                for mode in 0..count {
                    for j in 0..D {
                        let mut sum = R::zero();
                        for k in 0..D {
                            sum += cofactors[j][k] * whole[mode * D + k][i][c];
                        }
                        second.add([i, c], [j, D + mode], frame.phi[0] * sum);
                    }
                }
            }
        }
        let square = frame.phi[0] * frame.phi[0];
        for mode in 0..count {
            for other in mode..count {
                let mut left = matrix::zeros::<R, D>();
                for j in 0..D {
                    for k in 0..D {
                        for l in 0..D {
                            left[j][l] += cofactors[j][k] * qq[mode * D + k][other * D + l];
                        }
                    }
                }
                let block = matrix::product_transposed(&left, cofactors);
                for j in 0..D {
                    for k in 0..D {
                        let value = square * block[j][k];
                        if mode != other {
                            second.add([j, D + mode], [k, D + other], value);
                        } else if j <= k {
                            second.0[j][k][D + mode][D + mode] = value;
                        }
                    }
                }
            }
        }
        if self.of != Of::Damping {
            for mode in 0..count {
                for i in 0..D {
                    second.0[i][i][D + mode][D + mode] += frame.lost[0] * rest.guards[mode];
                }
            }
        }
        if self.of == Of::Energy(Definiteness::Exact) {
            let on_q = rest.on_amplitudes(&sums.on_beta);
            add_bent_frame(kept, &frame, &slope, &rest.guards, &on_q, &mut second);
        }
        second
    }
}

impl<E: Shape<D, N>, const D: usize, const N: usize> Work for Contract<'_, E, D, N> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let pack = self.group.first + self.pack;
        for part in 0..P::PARTS {
            let rest = Rest::<P::Part, D, N>::read(&self.group, pack, part);
            let kept = Kept::<P::Part, D>::read::<N>(&self.kept[self.pack * KEPT * WIDTH..], part);
            let sums = self.points(part, &rest, &kept);
            let second = self.by_columns(&rest, &kept, &sums);
            for i in 0..D {
                for m in i..D {
                    // From columns to corners, on both sides.
                    let mut by_corner = [[P::Part::zero(); N]; N];
                    for d in 0..N - 1 {
                        let column = core::array::from_fn(|c| [second.0[i][m][c][d]]);
                        let column = rest.on_corners(&column);
                        for a in 0..N {
                            by_corner[a][d] = column[a][0];
                        }
                    }
                    for a in 0..N {
                        let row = rest.on_corners(&by_corner[a].map(|x| [x]));
                        for b in if i == m { a..N } else { 0..N } {
                            let (low, high) = if a <= b { ((a, i), (b, m)) } else { ((b, m), (a, i)) };
                            let block = (low.0 * N + high.0) * D * D;
                            let at = (block + low.1 * D + high.1) * WIDTH + part * P::Part::NUMBERS;
                            row[b][0].store(&mut self.blocks[at..]);
                            if a == b {
                                let mirrored = (block + m * D + i) * WIDTH + part * P::Part::NUMBERS;
                                row[b][0].store(&mut self.blocks[mirrored..]);
                            }
                        }
                    }
                }
            }
        }
    }
}

/// Adds the second derivatives of q under the forces on it, u: those of φ(J) N : cof F with N = Σ gₐ ⊗ uₐ; and of what is
/// left in the place of the law where a cell is flat, ½ (1 − s) Σ kₐ gₐ·gₐ, but for that by g alone.
#[inline(always)]
fn add_bent_frame<R: Lane, const D: usize, const N: usize>(
    kept: &Kept<R, D>,
    frame: &Frame<R, D>,
    slope: &Tangent<R, D>,
    guards: &[R; MOST_MODES],
    on_q: &Modes<R, D>,
    second: &mut ByColumns<R, D, N>,
) {
    let count = modes::<D, N>();
    let (Kept { f, g, .. }, cofactors, half) = (kept, &frame.cofactors, R::splat(0.5));
    let mut on_cofactors = matrix::zeros::<R, D>();
    let mut guarded = R::zero();
    for mode in 0..count {
        for j in 0..D {
            guarded += guards[mode] * g[mode][j] * g[mode][j];
            for k in 0..D {
                on_cofactors[j][k] += g[mode][j] * on_q[mode][k];
            }
        }
    }
    let turned = cofactor_along(f, &on_cofactors);
    let whole = matrix::inner(&on_cofactors, cofactors);
    let by_volume = frame.phi[1] * whole + half * frame.lost[1] * guarded;
    let twice = frame.phi[2] * whole + half * frame.lost[2] * guarded;
    // In the plane cof F is linear in F.
    let mut bent: Tangent<R, D> = no_tangent();
    if D == 3 {
        add_cofactor_derivative(&mut bent, frame.phi[0], &on_cofactors);
    }
    for i in 0..D {
        for c in 0..D {
            for m in i..D {
                for d in 0..D {
                    let mixed = cofactors[i][c] * turned[m][d] + turned[i][c] * cofactors[m][d];
                    second.0[i][m][c][d] += twice * cofactors[i][c] * cofactors[m][d]
                        + by_volume * slope[i][c][m][d]
                        + frame.phi[1] * mixed
                        + bent[i][c][m][d];
                }
            }
            for mode in 0..count {
                for j in 0..D {
                    let (mut along, mut moved) = (R::zero(), R::zero());
                    for k in 0..D {
                        along += cofactors[j][k] * on_q[mode][k];
                        moved += slope[j][k][i][c] * on_q[mode][k];
                    }
                    let stiff = frame.lost[1] * guards[mode] * g[mode][j];
                    let mixed = (frame.phi[1] * along + stiff) * cofactors[i][c] + frame.phi[0] * moved;
                    second.add([i, c], [j, D + mode], mixed);
                }
            }
        }
    }
}
