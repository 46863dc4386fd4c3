//! Matrices of quadrilaterals and hexahedra, compiled for every set of vector instructions.
//!
//! The energy of [`super::boxes`] is differentiated by F and β first, where every point adds
//!
//! ∂F_q/∂βₛ = f_s(q) F D_s,  ∂F_q/∂F = · (1 + ε_q),
//!
//! and then, since β depends on F and g, by these; the corners come last.

use super::boxes::{Frame, Kept, Modes, Resistance, Rest, carried, cofactor_along, on_amplitudes, response, strain};
use super::elements::Shape;
use super::hourglass::{FIELDS, MOST_MODES, MOST_STRESSES, PAIRS, TERMS, fields, modes, pairs};
use super::law::read_matrix;
use super::material::{Tangent, add_cofactor_derivative, no_tangent};
use super::section::Group;
use core::marker::PhantomData;
use opruga_core::potential::Definiteness;
use opruga_math::matrix::{self, Matrix};
use opruga_math::{Lane, Pack, Register, WIDTH, Work};

/// What a matrix of cells is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Of {
    /// Energy; clamped: without what could be negative.
    Energy(Definiteness),
    /// Damping.
    Damping,
}

/// Tangents at the points of one pack of cells to blocks K_ab, a ≤ b, `[(a N + b)][i][k]` packs.
pub(super) struct Contract<'a, E, const D: usize, const N: usize> {
    pub(super) shape: PhantomData<E>,
    pub(super) group: Group<'a>,
    /// Which pack of the group.
    pub(super) pack: usize,
    pub(super) of: Of,
    /// As [`super::boxes::Deform`] leaves it.
    pub(super) kept: &'a [f64],
    /// At the points; looked at where the energy is differentiated exactly.
    pub(super) stress: &'a [f64],
    /// D⁴ packs for every pack of points.
    pub(super) tangent: &'a [f64],
    pub(super) times: &'a [f64],
    pub(super) blocks: &'a mut [f64],
}

/// Derivatives by F (D columns) and g (a column each mode), both by row: [row][column].
type ByColumns<R, const D: usize, const N: usize> = [[R; N]; D];

/// Second derivatives by F and β, and what the first derivatives by β are made of.
struct Sums<R, const D: usize> {
    /// By F and F.
    ff: Tangent<R, D>,
    /// By F and β.
    fb: [Matrix<R, D>; MOST_STRESSES],
    /// By β and β.
    bb: [[R; MOST_STRESSES]; MOST_STRESSES],
    /// By β.
    on_beta: [R; MOST_STRESSES],
}

/// Derivatives of a stress by Z where F changes by Z B.
#[inline(always)]
fn by_left<R: Lane, const D: usize>(tangent: &Tangent<R, D>, b: &Matrix<R, D>) -> Tangent<R, D> {
    let mut out = no_tangent();
    for i in 0..D {
        for j in 0..D {
            for k in 0..D {
                for m in 0..D {
                    for l in 0..D {
                        out[i][j][k][m] += tangent[i][j][k][l] * b[m][l];
                    }
                }
            }
        }
    }
    out
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
    fn points<R: Register>(
        &self,
        part: usize,
        rest: &Rest<R, D, N>,
        own: &Resistance<R>,
        kept: &Kept<R, D>,
    ) -> Sums<R, D> {
        let (turns, size, points) = (self.group.turns, modes::<D, N>() * D, self.group.points);
        let exact = self.of == Of::Energy(Definiteness::Exact);
        let strains = rest.strains(own.c);
        let (along, traces) = carried(turns, &kept.f, &strains);
        let mut sums = Sums {
            ff: no_tangent(),
            fb: [matrix::zeros(); MOST_STRESSES],
            bb: [[R::zero(); MOST_STRESSES]; MOST_STRESSES],
            on_beta: [R::zero(); MOST_STRESSES],
        };
        // Σ V f P.
        let mut stresses = [matrix::zeros::<R, D>(); FIELDS];
        for q in 0..N {
            let point = self.pack * points + q;
            let (functions, weight) = (rest.functions(q), rest.measures[q]);
            let now = strain::<_, D, N>(&kept.beta, &functions, &strains);
            let tangent = self.tangent_at::<R>(point, part);
            let mut grown = matrix::identity::<R, D>();
            if turns {
                grown = matrix::plus(&grown, R::one(), &now);
            }
            let half = by_left(&tangent, &grown);
            for i in 0..D {
                for j in 0..D {
                    for m in 0..D {
                        for n in 0..D {
                            let mut sum = R::zero();
                            for l in 0..D {
                                sum += grown[j][l] * half[i][l][m][n];
                            }
                            sums.ff[i][j][m][n] += weight * sum;
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
                on_f[pair] = matrix::product(&image[pair], &grown);
            }
            let mut beyond = own.beyond * weight;
            if self.of == Of::Damping {
                beyond = beyond * R::load(&self.times[point * WIDTH + part * R::NUMBERS..]);
            }
            let mut square = [[R::zero(); PAIRS]; PAIRS];
            for a in 0..pairs::<D>() {
                for b in 0..pairs::<D>() {
                    square[a][b] = matrix::inner(&along[a], &image[b]) + beyond * traces[a] * traces[b];
                }
            }
            for s in 0..size {
                let (pair, field) = TERMS[s];
                sums.fb[s] = matrix::plus(&sums.fb[s], functions[field], &on_f[pair]);
                for t in 0..size {
                    let (other, with) = TERMS[t];
                    sums.bb[s][t] += functions[field] * functions[with] * square[pair][other];
                }
            }
            if exact {
                let stress = read_matrix::<R, D>(&self.stress[point * D * D * WIDTH..], part);
                let swells = beyond * matrix::trace(&now);
                for field in 0..fields::<D>() {
                    stresses[field] = matrix::plus(&stresses[field], weight * functions[field], &stress);
                }
                for s in 0..size {
                    let (pair, field) = TERMS[s];
                    sums.on_beta[s] += functions[field] * swells * traces[pair];
                }
            }
        }
        if points > N {
            let tangent = self.tangent_at::<R>(self.pack * points + N, part);
            let measure = rest.measure();
            for i in 0..D {
                for j in 0..D {
                    sums.ff[i][j] = core::array::from_fn(|k| {
                        core::array::from_fn(|l| sums.ff[i][j][k][l] + measure * tangent[i][j][k][l])
                    });
                }
            }
        }
        if exact && turns {
            for s in 0..size {
                let (pair, field) = TERMS[s];
                sums.on_beta[s] += matrix::inner(&stresses[field], &along[pair]);
                let turned = matrix::product(&stresses[field], &strains[pair]);
                sums.fb[s] = matrix::plus(&sums.fb[s], R::one(), &turned);
            }
        }
        sums
    }
}

impl<E: Shape<D, N>, const D: usize, const N: usize> Work for Contract<'_, E, D, N> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let (count, size, turns) = (modes::<D, N>(), modes::<D, N>() * D, self.group.turns);
        let pack = self.group.first + self.pack;
        let zero: ByColumns<P::Part, D, N> = [[P::Part::zero(); N]; D];
        for part in 0..P::PARTS {
            let rest = Rest::<P::Part, D, N>::read(&self.group, pack, part);
            let own = Resistance::<P::Part>::read::<D, N>(&self.group, pack, part);
            let kept = Kept::<P::Part, D>::read::<N>(&self.kept[self.pack * super::boxes::KEPT * WIDTH..], part);
            let sums = self.points(part, &rest, &own, &kept);
            let Kept { f, g, .. } = &kept;
            let frame = Frame::new(f);
            let cofactors = &frame.cofactors;
            // ∂cof F/∂F.
            let mut slope: Tangent<P::Part, D> = no_tangent();
            add_cofactor_derivative(&mut slope, P::Part::one(), f);

            // ∂q/∂(F, g).
            let mut change = [[zero; D]; MOST_MODES];
            for mode in 0..count {
                for k in 0..D {
                    if !turns {
                        change[mode][k][k][D + mode] = P::Part::one();
                        continue;
                    }
                    let mut own = P::Part::zero();
                    for j in 0..D {
                        own += cofactors[j][k] * g[mode][j];
                        change[mode][k][j][D + mode] = frame.phi[0] * cofactors[j][k];
                    }
                    for i in 0..D {
                        for c in 0..D {
                            let mut turned = P::Part::zero();
                            for j in 0..D {
                                turned += slope[j][k][i][c] * g[mode][j];
                            }
                            change[mode][k][i][c] = frame.phi[1] * cofactors[i][c] * own + frame.phi[0] * turned;
                        }
                    }
                }
            }
            // ∂β/∂(F, g).
            let mut factors = [zero; MOST_STRESSES];
            for s in 0..size {
                for k in 0..size {
                    let weight = response::<P::Part, D, N>(&self.group, pack, part, s, k);
                    let (mode, own) = (k / D, &change[k / D][k % D]);
                    for i in 0..D {
                        for c in 0..D {
                            factors[s][i][c] += weight * own[i][c];
                        }
                        factors[s][i][D + mode] += weight * own[i][D + mode];
                    }
                }
            }
            // What the forces on β become with them, and half of the mixed part.
            let mut image = [zero; MOST_STRESSES];
            for s in 0..size {
                for t in 0..size {
                    for i in 0..D {
                        for c in 0..N - 1 {
                            image[s][i][c] += sums.bb[s][t] * factors[t][i][c];
                        }
                    }
                }
                for i in 0..D {
                    for c in 0..D {
                        image[s][i][c] += sums.fb[s][i][c];
                    }
                }
            }
            let mut second = [[zero; N]; D];
            for i in 0..D {
                for c in 0..N - 1 {
                    for s in 0..size {
                        let weight = factors[s][i][c];
                        for m in 0..D {
                            for d in 0..N - 1 {
                                second[i][c][m][d] += weight * image[s][m][d];
                            }
                        }
                    }
                    if c < D {
                        for s in 0..size {
                            let weight = sums.fb[s][i][c];
                            for m in 0..D {
                                for d in 0..N - 1 {
                                    second[i][c][m][d] += weight * factors[s][m][d];
                                }
                            }
                        }
                        for m in 0..D {
                            for d in 0..D {
                                second[i][c][m][d] += sums.ff[i][c][m][d];
                            }
                        }
                    }
                }
            }
            if turns && self.of != Of::Damping {
                for mode in 0..count {
                    for i in 0..D {
                        second[i][D + mode][i][D + mode] += frame.lost[0] * own.guards[mode];
                    }
                }
            }
            if turns && self.of == Of::Energy(Definiteness::Exact) {
                let on_q = on_amplitudes::<P::Part, D, N>(&self.group, pack, part, &sums.on_beta);
                add_bent_frame(count, &kept, &frame, &slope, &own, &on_q, &mut second);
            }
            for i in 0..D {
                for node in 0..N {
                    let mut row = zero;
                    for c in 0..N - 1 {
                        for m in 0..D {
                            for d in 0..N - 1 {
                                row[m][d] += rest.weights[node][c] * second[i][c][m][d];
                            }
                        }
                    }
                    for other in node..N {
                        for m in 0..D {
                            let mut sum = P::Part::zero();
                            for d in 0..N - 1 {
                                sum += row[m][d] * rest.weights[other][d];
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

/// Adds the second derivatives of q under the forces on it, u: those of φ(J) N : cof F with N = Σ gₐ ⊗ uₐ; and of what is
/// left in the place of the law where a cell is flat, ½ (1 − s) Σ kₐ gₐ·gₐ, but for that by g alone.
#[inline(always)]
fn add_bent_frame<R: Lane, const D: usize, const N: usize>(
    count: usize,
    kept: &Kept<R, D>,
    frame: &Frame<R, D>,
    slope: &Tangent<R, D>,
    own: &Resistance<R>,
    on_q: &Modes<R, D>,
    second: &mut [[ByColumns<R, D, N>; N]; D],
) {
    let (Kept { f, g, .. }, cofactors, half) = (kept, &frame.cofactors, R::splat(0.5));
    let mut on_cofactors = matrix::zeros::<R, D>();
    let mut guarded = R::zero();
    for mode in 0..count {
        for j in 0..D {
            guarded += own.guards[mode] * g[mode][j] * g[mode][j];
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
            for m in 0..D {
                for d in 0..D {
                    let mixed = cofactors[i][c] * turned[m][d] + turned[i][c] * cofactors[m][d];
                    second[i][c][m][d] += twice * cofactors[i][c] * cofactors[m][d]
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
                    let stiff = frame.lost[1] * own.guards[mode] * g[mode][j];
                    let mixed = (frame.phi[1] * along + stiff) * cofactors[i][c] + frame.phi[0] * moved;
                    second[i][c][j][D + mode] += mixed;
                    second[j][D + mode][i][c] += mixed;
                }
            }
        }
    }
}
