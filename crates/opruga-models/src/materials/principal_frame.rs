//! Tangents in the frame of the singular vectors, computed in several passes. Only one of these passes depends on the material.
//!
//! ```text
//! F ──▶ U, V, σ ──▶ ψᵢⱼ, differences, sums ──▶ without negative eigenvalues ──▶ the whole tangent, where one asks for it
//!      whatever the material  the material      whatever the material
//! ```
//! The code for singular vectors and eigenvalues is therefore compiled once, and not with every material. The passes exchange
//! [`PRINCIPAL`] matrices for every pack of points: U, V, ψᵢⱼ, and for pairs of axes a < b the components of [`Principal::pair`]
//! at [a][b] and [b][a]. Before the pass of the material, the third matrix contains σ in its first row. Before the pass that
//! removes negative eigenvalues, the fourth matrix contains the difference at [a][b] and the sum at [b][a].

use super::material::{Material, Parameters, Principal, out_of_frame};
use super::points::{PRINCIPAL, Points, read, read_matrix, write_matrix, write_tangent};
use opruga_math::matrix::{self, Matrix};
use opruga_math::singular::singular;
use opruga_math::{Lane, Pack, Register, Twin, WIDTH, Work};

/// The packs and parts of two registers. Two registers are processed at a time, because the computation of singular vectors and
/// eigenvalues waits for square roots and divisions.
type Two = [(usize, usize); 2];

/// Two registers of `parts` from `first` on. If the number of registers is odd, the last one is repeated.
#[inline(always)]
fn two<P: Pack>(first: usize, parts: usize) -> Two {
    let second = (first + 1).min(parts - 1);
    [(first / P::PARTS, first % P::PARTS), (second / P::PARTS, second % P::PARTS)]
}

/// Reads one of the [`PRINCIPAL`] matrices for two parts.
#[inline(always)]
fn read_twin<R: Register, const D: usize>(from: &[f64], number: usize, at: Two) -> Matrix<Twin<R>, D> {
    let [(pack, part), (other_pack, other_part)] = at;
    let one = read_matrix::<R, D>(&from[(pack * PRINCIPAL + number) * D * D * WIDTH..], part);
    let other = read_matrix::<R, D>(&from[(other_pack * PRINCIPAL + number) * D * D * WIDTH..], other_part);
    twin(&one, &other)
}

/// Writes one of the [`PRINCIPAL`] matrices for two parts.
#[inline(always)]
fn write_twin<R: Register, const D: usize>(to: &mut [f64], number: usize, at: Two, matrix: &Matrix<Twin<R>, D>) {
    let mut one = [[R::zero(); D]; D];
    let mut other = one;
    for i in 0..D {
        for j in 0..D {
            (one[i][j], other[i][j]) = (matrix[i][j].0, matrix[i][j].1);
        }
    }
    let [(pack, part), (other_pack, other_part)] = at;
    write_matrix(&mut to[(pack * PRINCIPAL + number) * D * D * WIDTH..], part, &one);
    write_matrix(&mut to[(other_pack * PRINCIPAL + number) * D * D * WIDTH..], other_part, &other);
}

#[inline(always)]
fn twin<R: Lane, const D: usize>(one: &Matrix<R, D>, other: &Matrix<R, D>) -> Matrix<Twin<R>, D> {
    let mut out = [[Twin(one[0][0], other[0][0]); D]; D];
    for i in 0..D {
        for j in 0..D {
            out[i][j] = Twin(one[i][j], other[i][j]);
        }
    }
    out
}

/// Computes singular vectors and values of F.
pub(crate) struct Frames<'a, const D: usize> {
    pub(crate) points: Points<'a>,
    /// Whether the law accounts for rotations. If a law does not account for rotations, its tangent is the same in every frame,
    /// and the axes are the unit vectors.
    pub(crate) turns: bool,
    pub(crate) out: &'a mut [f64],
}
impl<const D: usize> Work for Frames<'_, D> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let parts = self.points.count * P::PARTS;
        for first in (0..parts).step_by(2) {
            let at = two::<P>(first, parts);
            let (mut u, mut v) = (matrix::identity::<_, D>(), matrix::identity::<_, D>());
            let mut sigma = [Twin::<P::Part>::one(); D];
            if self.turns {
                let (_, f) = read::<P::Part, D>(&self.points, at[0].0, at[0].1);
                let (_, g) = read::<P::Part, D>(&self.points, at[1].0, at[1].1);
                let singular = singular(&twin(&f, &g));
                (u, v, sigma) = (singular.u, singular.v, singular.sigma);
            }
            let mut row = matrix::zeros::<Twin<P::Part>, D>();
            row[0] = sigma;
            write_twin(self.out, 0, at, &u);
            write_twin(self.out, 1, at, &v);
            write_twin(self.out, 2, at, &row);
        }
    }
}

/// Applies the material to the singular values.
pub(crate) struct InFrame<'a, M, const D: usize> {
    pub(crate) points: Points<'a>,
    pub(crate) out: &'a mut [f64],
    #[allow(dead_code)] // says which material
    pub(crate) material: M,
}
impl<M: Material<D>, const D: usize> Work for InFrame<'_, M, D> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let parts = self.points.count * P::PARTS;
        for first in (0..parts).step_by(2) {
            let at = two::<P>(first, parts);
            let (p, f) = read::<P::Part, D>(&self.points, at[0].0, at[0].1);
            let (q, g) = read::<P::Part, D>(&self.points, at[1].0, at[1].1);
            let parameters =
                Parameters { mu: Twin(p.mu, q.mu), lambda: Twin(p.lambda, q.lambda), own: Twin(p.own, q.own) };
            let sigma = read_twin::<P::Part, D>(self.out, 2, at)[0];
            let principal = M::principal(&parameters, &twin(&f, &g), &sigma);
            let mut pairs = matrix::zeros::<Twin<P::Part>, D>();
            for a in 0..D {
                for b in a + 1..D {
                    (pairs[a][b], pairs[b][a]) = (principal.difference[a][b], principal.sum[a][b]);
                }
            }
            write_twin(self.out, 2, at, &principal.second);
            write_twin(self.out, 3, at, &pairs);
        }
    }
}

/// Removes negative eigenvalues.
pub(crate) struct Clamp<'a, const D: usize> {
    pub(crate) count: usize,
    pub(crate) out: &'a mut [f64],
}
impl<const D: usize> Work for Clamp<'_, D> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let parts = self.count * P::PARTS;
        for first in (0..parts).step_by(2) {
            let at = two::<P>(first, parts);
            let mut principal = Principal::<Twin<P::Part>, D>::zeros();
            principal.second = read_twin(self.out, 2, at);
            let pairs = read_twin::<P::Part, D>(self.out, 3, at);
            for a in 0..D {
                for b in a + 1..D {
                    (principal.difference[a][b], principal.sum[a][b]) = (pairs[a][b], pairs[b][a]);
                }
            }
            let clamped = principal.clamped();
            write_twin(self.out, 2, at, &clamped.second);
            write_twin(self.out, 3, at, &clamped.pairs());
        }
    }
}

/// Computes the whole tangents.
pub(crate) struct OutOfFrame<'a, const D: usize> {
    pub(crate) count: usize,
    pub(crate) principal: &'a [f64],
    pub(crate) tangent: &'a mut [f64],
}
impl<const D: usize> Work for OutOfFrame<'_, D> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        for pack in 0..self.count {
            for part in 0..P::PARTS {
                let mut found = [[[P::Part::zero(); D]; D]; PRINCIPAL];
                for k in 0..PRINCIPAL {
                    found[k] = read_matrix(&self.principal[(pack * PRINCIPAL + k) * D * D * WIDTH..], part);
                }
                let [u, v, second, pairs] = &found;
                write_tangent(self.tangent, pack, part, &out_of_frame(u, v, second, pairs));
            }
        }
    }
}
