//! Second derivatives of quadrilaterals and hexahedra. Converts derivatives by F and β to derivatives by the columns of F and g
//! (see [`super`]).

use super::super::elements::Shape;
use super::hourglass::{MOST_MODES, MOST_STRESSES, modes};
use super::matrices::{Contract, Of, Sums};
use super::rest::Rest;
use super::{Frame, Kept, Modes, cofactor_along};
use crate::materials::material::{Tangent, add_cofactor_derivative, no_tangent};
use opruga_core::potential::Definiteness;
use opruga_math::matrix::{self, Matrix};
use opruga_math::{Lane, Register};

/// The largest number of amplitudes.
const AMPLITUDES: usize = MOST_MODES * 3;

/// Second derivatives by the columns of F and g: rows i ≤ m of columns c and d at `[i][m][c][d]`.
pub(super) struct ByColumns<R, const D: usize, const N: usize>(pub(super) [[[[R; N]; N]; D]; D]);

impl<R: Lane, const D: usize, const N: usize> ByColumns<R, D, N> {
    /// Adds a second derivative by entries of two different columns.
    #[inline(always)]
    fn add(&mut self, [i, c]: [usize; 2], [m, d]: [usize; 2], value: R) {
        if i <= m {
            self.0[i][m][c][d] += value;
        }
        if m <= i {
            self.0[m][i][d][c] += value;
        }
    }

    /// Adds the derivatives of a cell whose frame does not rotate.
    #[inline(always)]
    fn add_unturned(&mut self, sums: &Sums<R, D>, by_q: &ByAmplitudes<R, D>) {
        let (count, size) = (modes::<D, N>(), modes::<D, N>() * D);
        for i in 0..D {
            for m in i..D {
                for c in 0..D {
                    for d in 0..D {
                        self.0[i][m][c][d] = sums.ff[i][c][m][d];
                    }
                }
                for mode in 0..count {
                    for other in 0..count {
                        self.0[i][m][D + mode][D + other] = by_q.qq[mode * D + i][other * D + m];
                    }
                }
            }
            for c in 0..D {
                for k in 0..size {
                    self.add([i, c], [k % D, D + k / D], by_q.fq[k][i][c]);
                }
            }
        }
    }

    /// Adds the derivatives by F, and the derivatives by F and g that exist because q depends on F.
    #[inline(always)]
    fn add_by_gradient(
        &mut self,
        sums: &Sums<R, D>,
        by_q: &ByAmplitudes<R, D>,
        frame: &Frame<R, D>,
        change: &[Matrix<R, D>; AMPLITUDES],
    ) {
        let (count, size, cofactors) = (modes::<D, N>(), modes::<D, N>() * D, &frame.cofactors);
        // The derivatives by F and q, including all terms that depend on F.
        let mut whole = by_q.fq;
        for k in 0..size {
            for l in 0..size {
                whole[k] = matrix::plus(&whole[k], by_q.qq[k][l], &change[l]);
            }
        }
        for i in 0..D {
            for m in i..D {
                for c in 0..D {
                    for d in 0..D {
                        let mut sum = sums.ff[i][c][m][d];
                        for k in 0..size {
                            sum += whole[k][i][c] * change[k][m][d] + change[k][i][c] * by_q.fq[k][m][d];
                        }
                        self.0[i][m][c][d] = sum;
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
                        self.add([i, c], [j, D + mode], frame.phi[0] * sum);
                    }
                }
            }
        }
    }

    /// Adds the derivatives by g, except the derivatives that come through q.
    #[inline(always)]
    fn add_by_amplitudes(&mut self, by_q: &ByAmplitudes<R, D>, frame: &Frame<R, D>) {
        let (count, cofactors) = (modes::<D, N>(), &frame.cofactors);
        let square = frame.phi[0] * frame.phi[0];
        for mode in 0..count {
            for other in mode..count {
                let mut left = matrix::zeros::<R, D>();
                for j in 0..D {
                    for k in 0..D {
                        for l in 0..D {
                            left[j][l] += cofactors[j][k] * by_q.qq[mode * D + k][other * D + l];
                        }
                    }
                }
                let block = matrix::product_transposed(&left, cofactors);
                for j in 0..D {
                    for k in 0..D {
                        let value = square * block[j][k];
                        if mode != other {
                            self.add([j, D + mode], [k, D + other], value);
                        } else if j <= k {
                            self.0[j][k][D + mode][D + mode] = value;
                        }
                    }
                }
            }
        }
    }
}

/// Second derivatives by amplitudes q instead of β.
struct ByAmplitudes<R, const D: usize> {
    /// By F and q.
    fq: [Matrix<R, D>; AMPLITUDES],
    /// By q and q.
    qq: [[R; AMPLITUDES]; AMPLITUDES],
}

impl<R: Register, const D: usize> ByAmplitudes<R, D> {
    #[inline(always)]
    fn new<const N: usize>(rest: &Rest<'_, R, D, N>, sums: &Sums<R, D>) -> Self {
        let size = modes::<D, N>() * D;
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
        ByAmplitudes { fq, qq }
    }
}

impl<E: Shape<D, N>, const D: usize, const N: usize> Contract<'_, E, D, N> {
    /// Second derivatives by F and g, computed from the second derivatives by F and β.
    #[inline(always)]
    pub(super) fn by_columns<R: Register>(
        &self,
        rest: &Rest<'_, R, D, N>,
        kept: &Kept<R, D>,
        sums: &Sums<R, D>,
    ) -> ByColumns<R, D, N> {
        let mut second = ByColumns([[[[R::zero(); N]; N]; D]; D]);
        let by_q = ByAmplitudes::new(rest, sums);
        if !self.group.turns {
            second.add_unturned(sums, &by_q);
            return second;
        }
        let count = modes::<D, N>();
        let frame = Frame::new(&kept.f);
        // ∂cof F/∂F.
        let mut slope: Tangent<R, D> = no_tangent();
        add_cofactor_derivative(&mut slope, R::one(), &kept.f);
        second.add_by_gradient(sums, &by_q, &frame, &change_of_amplitudes::<R, D, N>(kept, &frame, &slope));
        second.add_by_amplitudes(&by_q, &frame);
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

/// ∂q/∂F; ∂q/∂g is φ cof Fᵀ.
#[inline(always)]
fn change_of_amplitudes<R: Lane, const D: usize, const N: usize>(
    kept: &Kept<R, D>,
    frame: &Frame<R, D>,
    slope: &Tangent<R, D>,
) -> [Matrix<R, D>; AMPLITUDES] {
    let (count, g, cofactors) = (modes::<D, N>(), &kept.g, &frame.cofactors);
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
                        // The cofactors of a row do not depend on that row.
                        if i != j {
                            turned += slope[j][k][i][c] * g[mode][j];
                        }
                    }
                    change[mode * D + k][i][c] = cofactors[i][c] * own + frame.phi[0] * turned;
                }
            }
        }
    }
    change
}

/// Adds the second derivatives of q under the forces u on q. They are the second derivatives of φ(J) N : cof F with N = Σ gₐ ⊗
/// uₐ. Also adds the second derivatives of the guard energy ½ (1 − s) Σ kₐ gₐ·gₐ, except the second derivatives by g alone. The
/// guard energy replaces the law in a degenerate cell.
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
