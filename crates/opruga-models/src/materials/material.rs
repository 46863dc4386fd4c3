//! The definition of a material: energy density, stress and tangent as functions of the deformation gradient.

use core::fmt::Debug;
use opruga_math::matrix::{self, Matrix};
use opruga_math::singular::{Singular, singular};
use opruga_math::{Lane, symmetric};

/// The parameters of a material at a point.
#[derive(Clone, Copy, Debug)]
pub struct Parameters<S> {
    /// Lamé's second parameter, the shear modulus μ = E/2(1 + ν) [Pa].
    pub mu: S,
    /// Lamé's first parameter λ = Eν/((1 + ν)(1 − 2ν)) [Pa].
    pub lambda: S,
    /// An additional parameter of the material. For Mooney–Rivlin, it is the share of the second constant.
    pub own: S,
}

/// ∂Pᵢⱼ/∂Fₖₗ as `[i][j][k][l]` [Pa].
pub type Tangent<S, const D: usize> = [[[[S; D]; D]; D]; D];

/// A law of the deformation gradient F = ∂x/∂X, in the plane (plane strain) or in space.
///
/// Formulas are straight-line code over [`Lane`], without closures or branches on values. A new material is a file with this
/// trait and a line in the list of materials.
pub trait Material<const D: usize>: Copy + Debug + Send + Sync + 'static {
    /// The name of the material in scenes.
    const NAME: &'static str;
    /// Whether rotating a body takes no energy. All laws have this property except the law for small rotations.
    const TURNS: bool = true;
    /// Whether ψ at rest is a difference of terms as large as the moduli instead of a sum of squares. Rounding then leaves a
    /// remainder of these terms.
    const CANCELS: bool = false;
    /// Energy density ψ(F) [J/m³], zero at rest, and first Piola–Kirchhoff stress P = ∂ψ/∂F [Pa].
    fn energy_and_stress<S: Lane>(p: &Parameters<S>, f: &Matrix<S, D>) -> (S, Matrix<S, D>);
    /// The second derivatives by the principal stretches σ of F: ∂P/∂F in the frame of its singular vectors [Pa].
    fn principal<S: Lane>(p: &Parameters<S>, f: &Matrix<S, D>, sigma: &[S; D]) -> Principal<S, D>;
    /// The derivatives by tr FᵀF and det F, for a law that depends on nothing else. The tangent of such a law follows from these
    /// derivatives alone.
    #[inline(always)]
    fn invariants<S: Lane>(_p: &Parameters<S>, _f: &Matrix<S, D>) -> Option<Invariants<S>> {
        None
    }
    /// The tangent ∂P/∂F [Pa]. A separate formula is worthwhile if the tangent needs neither invariants nor singular vectors.
    #[inline(always)]
    fn tangent<S: Lane>(p: &Parameters<S>, f: &Matrix<S, D>) -> Tangent<S, D> {
        if let Some(invariants) = Self::invariants(p, f) {
            return invariants.tangent(f);
        }
        let singular = singular(f);
        Self::principal(p, f, &singular.sigma).tangent(&singular)
    }
}

/// Derivatives of an energy ψ(I, J) with I = tr FᵀF and J = det F [Pa]. If ψ_IJ = 0, they determine the tangent, ∂P/∂F = 2ψ_I 1 +
/// 4ψ_II F ⊗ F + ψ_JJ cof F ⊗ cof F + ψ_J ∂(cof F)/∂F.
#[derive(Clone, Copy, Debug)]
pub struct Invariants<S> {
    /// 2 ∂ψ/∂I.
    pub stretch: S,
    /// 4 ∂²ψ/∂I², or `None` if the law is linear in I.
    pub stretch_twice: Option<S>,
    /// ∂ψ/∂J.
    pub volume: S,
    /// ∂²ψ/∂J².
    pub volume_twice: S,
}

impl<S: Lane> Invariants<S> {
    /// The tangent.
    #[inline(always)]
    pub fn tangent<const D: usize>(&self, f: &Matrix<S, D>) -> Tangent<S, D> {
        let mut out = no_tangent();
        add_identity(&mut out, self.stretch);
        if let Some(twice) = self.stretch_twice {
            add_square(&mut out, twice, f);
        }
        add_square(&mut out, self.volume_twice, &matrix::cofactor(f));
        add_cofactor_derivative(&mut out, self.volume, f);
        out
    }
}

/// Second derivatives of an isotropic energy ψ(σ₁, …) by principal stretches, which determine its tangent.
///
/// In the frame of the singular vectors the tangent has the eigenvectors uᵢvⱼᵀ ± uⱼvᵢᵀ with the eigenvalues
/// (ψᵢ − ψⱼ)/(σᵢ − σⱼ) and (ψᵢ + ψⱼ)/(σᵢ + σⱼ), and the matrix ψᵢⱼ between the uᵢvᵢᵀ.
///
/// # Source
/// Smith, de Goes, Kim, "Analytic eigensystems for isotropic distortion energies", ACM Trans. Graph. 38 (2019).
#[derive(Clone, Copy, Debug)]
pub struct Principal<S, const D: usize> {
    /// ψᵢⱼ = ∂²ψ/∂σᵢ∂σⱼ.
    pub second: Matrix<S, D>,
    /// (ψᵢ − ψⱼ)/(σᵢ − σⱼ), for i < j, or its limit if the two stretches are equal.
    pub difference: Matrix<S, D>,
    /// (ψᵢ + ψⱼ)/(σᵢ + σⱼ), for i < j.
    pub sum: Matrix<S, D>,
}

impl<S: Lane, const D: usize> Principal<S, D> {
    /// Returns second derivatives that are all zero.
    #[inline(always)]
    pub fn zeros() -> Self {
        Principal { second: matrix::zeros(), difference: matrix::zeros(), sum: matrix::zeros() }
    }

    /// Adds a function of J = det F with these derivatives.
    #[inline(always)]
    pub fn add_volumetric(&mut self, sigma: &[S; D], first: S, second: S) {
        for i in 0..D {
            for j in 0..D {
                let (without_i, without_j) = (others(sigma, i, i), others(sigma, j, j));
                self.second[i][j] += second * without_i * without_j;
                if i != j {
                    self.second[i][j] += first * others(sigma, i, j);
                }
                if i < j {
                    self.difference[i][j] += -(first * others(sigma, i, j));
                    self.sum[i][j] += first * others(sigma, i, j);
                }
            }
        }
    }

    /// Adds a function of I = tr FᵀF with these derivatives.
    #[inline(always)]
    pub fn add_stretch(&mut self, sigma: &[S; D], first: S, second: S) {
        let two = first + first;
        for i in 0..D {
            for j in 0..D {
                self.second[i][j] += S::splat(4.0) * second * sigma[i] * sigma[j];
                if i == j {
                    self.second[i][j] += two;
                }
                if i < j {
                    self.difference[i][j] += two;
                    self.sum[i][j] += two;
                }
            }
        }
    }

    /// Returns these derivatives without negative eigenvalues.
    #[inline(always)]
    pub fn clamped(&self) -> Self {
        let mut own = *self;
        own.second = symmetric::positive_part(&self.second);
        for i in 0..D {
            for j in i + 1..D {
                own.difference[i][j] = self.difference[i][j].larger(S::zero());
                own.sum[i][j] = self.sum[i][j].larger(S::zero());
            }
        }
        own
    }

    /// The product of the tangent with u_a v_bᵀ, a < b: its components along u_a v_bᵀ and along u_b v_aᵀ.
    #[inline(always)]
    pub fn pair(&self, a: usize, b: usize) -> (S, S) {
        let half = S::splat(0.5);
        (half * (self.difference[a][b] + self.sum[a][b]), half * (self.difference[a][b] - self.sum[a][b]))
    }

    /// The values of [`Principal::pair`] for every pair of axes a < b, at [a][b] and at [b][a].
    #[inline(always)]
    pub(crate) fn pairs(&self) -> Matrix<S, D> {
        let mut out = matrix::zeros();
        for a in 0..D {
            for b in a + 1..D {
                (out[a][b], out[b][a]) = self.pair(a, b);
            }
        }
        out
    }

    /// The tangent.
    #[inline(always)]
    pub fn tangent(&self, singular: &Singular<S, D>) -> Tangent<S, D> {
        out_of_frame(&singular.u, &singular.v, &self.second, &self.pairs())
    }
}

/// The tangent of a law from its form in the frame of the singular vectors: its second derivatives by stretches, and
/// [`Principal::pairs`].
#[inline(always)]
pub(crate) fn out_of_frame<S: Lane, const D: usize>(
    u: &Matrix<S, D>,
    v: &Matrix<S, D>,
    second: &Matrix<S, D>,
    pairs: &Matrix<S, D>,
) -> Tangent<S, D> {
    let mut out = no_tangent();
    for a in 0..D {
        for b in 0..D {
            // u_a v_bᵀ, and the product of the tangent with it.
            let mut image = matrix::zeros::<S, D>();
            if a == b {
                for c in 0..D {
                    add_outer(&mut image, second[a][c], u, c, v, c);
                }
            } else {
                let (low, high) = if a < b { (a, b) } else { (b, a) };
                add_outer(&mut image, pairs[low][high], u, a, v, b);
                add_outer(&mut image, pairs[high][low], u, b, v, a);
            }
            for i in 0..D {
                for j in 0..D {
                    let weight = u[i][a] * v[j][b];
                    for k in 0..D {
                        for l in 0..D {
                            out[i][j][k][l] += weight * image[k][l];
                        }
                    }
                }
            }
        }
    }
    out
}

/// Adds s u_a v_bᵀ of the columns a and b.
#[inline(always)]
fn add_outer<S: Lane, const D: usize>(
    to: &mut Matrix<S, D>,
    s: S,
    u: &Matrix<S, D>,
    a: usize,
    v: &Matrix<S, D>,
    b: usize,
) {
    for k in 0..D {
        let weight = s * u[k][a];
        for l in 0..D {
            to[k][l] += weight * v[l][b];
        }
    }
}

/// The product of all stretches except σᵢ and σⱼ, or except σᵢ if i = j.
#[inline(always)]
fn others<S: Lane, const D: usize>(sigma: &[S; D], i: usize, j: usize) -> S {
    let mut out = S::one();
    for k in 0..D {
        if k != i && k != j {
            out = out * sigma[k];
        }
    }
    out
}

/// A tangent of zeros.
#[inline(always)]
pub(crate) fn no_tangent<S: Lane, const D: usize>() -> Tangent<S, D> {
    [[[[S::zero(); D]; D]; D]; D]
}

/// Adds s to ∂Pᵢⱼ/∂Fᵢⱼ for all i and j: the tangent of s/2 tr FᵀF.
#[inline(always)]
pub(crate) fn add_identity<S: Lane, const D: usize>(to: &mut Tangent<S, D>, s: S) {
    for i in 0..D {
        for j in 0..D {
            to[i][j][i][j] += s;
        }
    }
}

/// Adds s A ⊗ A.
#[inline(always)]
pub(crate) fn add_square<S: Lane, const D: usize>(to: &mut Tangent<S, D>, s: S, a: &Matrix<S, D>) {
    for i in 0..D {
        for j in 0..D {
            let weight = s * a[i][j];
            for k in 0..D {
                for l in 0..D {
                    to[i][j][k][l] += weight * a[k][l];
                }
            }
        }
    }
}

/// Adds s ∂²(det F)/∂F∂F, the derivative of the cofactors.
#[inline(always)]
pub(crate) fn add_cofactor_derivative<S: Lane, const D: usize>(to: &mut Tangent<S, D>, s: S, f: &Matrix<S, D>) {
    if D == 2 {
        for i in 0..D {
            for j in 0..D {
                let (k, l) = (1 - i, 1 - j);
                to[i][j][k][l] += if i == j { s } else { -s };
            }
        }
        return;
    }
    for i in 0..D {
        for j in 0..D {
            // εᵢₖₘ εⱼₗₙ Fₘₙ.
            let (k, m) = ((i + 1) % D, (i + 2) % D);
            let (l, n) = ((j + 1) % D, (j + 2) % D);
            to[i][j][k][l] += s * f[m][n];
            to[i][j][m][n] += s * f[k][l];
            to[i][j][k][n] += -(s * f[m][l]);
            to[i][j][m][l] += -(s * f[k][n]);
        }
    }
}

/// Adds the tangent of a stress F·S with S = 2μE + λ tr E 1, without the term that contains S itself: μ ((F Fᵀ)ᵢₖ δⱼₗ + Fᵢₗ
/// Fₖⱼ) + λ Fᵢⱼ Fₖₗ.
#[inline(always)]
pub(crate) fn add_strain_tangent<S: Lane, const D: usize>(to: &mut Tangent<S, D>, mu: S, lambda: S, f: &Matrix<S, D>) {
    let left = matrix::product_transposed(f, f);
    add_square(to, lambda, f);
    for i in 0..D {
        for j in 0..D {
            for k in 0..D {
                to[i][j][k][j] += mu * left[i][k];
                for l in 0..D {
                    to[i][j][k][l] += mu * f[i][l] * f[k][j];
                }
            }
        }
    }
}

/// The volume ratio below which the logarithm is continued as a parabola: 1 % of the volume at rest.
pub(crate) const LEAST_VOLUME: f64 = 0.01;

/// ln J with its first two derivatives. Below [`LEAST_VOLUME`] the logarithm is continued as a parabola, so that a degenerate or
/// inverted point has an energy and is pushed back.
#[inline(always)]
pub(crate) fn logarithm_of_volume<S: Lane>(j: S) -> [S; 3] {
    let least = S::splat(LEAST_VOLUME);
    let flat = j.less(least);
    let real = S::select(flat, least, j);
    let inverse = S::one() / real;
    // r = (J − J₀)/J₀; zero where the logarithm itself is used.
    let r = S::select(flat, (j - least) * inverse, S::zero());
    let value = real.ln() + r - S::splat(0.5) * r * r;
    [value, inverse - inverse * r, -(inverse * inverse)]
}
