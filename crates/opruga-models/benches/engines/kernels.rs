//! A spring and a linear tetrahedron as kernels.

use opruga_core::stencil::Kernel;
use opruga_math::Lane;
use opruga_math::matrix;
use opruga_models::materials::material::{Material, Parameters};
use std::marker::PhantomData;

/// The stiffness of every spring [N/m].
pub(crate) const STIFFNESS: f64 = 1e3;
/// Young's modulus [Pa].
pub(crate) const MODULUS: f64 = 1e5;
/// The default Poisson's ratio of `fem`.
const RATIO: f64 = 0.3;

/// A spring; parameters: length at rest, stiffness, damping.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spring;

/// d, |d| and 1/|d|, with d from the second node to the first.
#[inline(always)]
fn apart<S: Lane, const D: usize>(x: &[[S; D]; 2]) -> ([S; D], S, S) {
    let mut d = x[0];
    for i in 0..D {
        d[i] = x[0][i] - x[1][i];
    }
    let square = dot(&d, &d);
    let inverse = S::one() / square.sqrt();
    let inverse = S::select(S::splat(f64::MIN_POSITIVE).less_or_equal(square), inverse, S::zero());
    (d, square * inverse, inverse)
}

#[inline(always)]
fn dot<S: Lane, const D: usize>(a: &[S; D], b: &[S; D]) -> S {
    let mut sum = a[0] * b[0];
    for i in 1..D {
        sum += a[i] * b[i];
    }
    sum
}

/// ±factor d on the two nodes.
#[inline(always)]
fn both<S: Lane, const D: usize>(d: &[S; D], factor: S) -> [[S; D]; 2] {
    let mut out = [*d; 2];
    for i in 0..D {
        out[0][i] = d[i] * factor;
        out[1][i] = -out[0][i];
    }
    out
}

impl<const D: usize> Kernel<D, 2, 3> for Spring {
    const NAME: &'static str = "spring";
    #[inline(always)]
    fn energy<S: Lane>(p: &[S; 3], x: &[[S; D]; 2]) -> S {
        let (_, length, _) = apart(x);
        let stretch = length - p[0];
        S::splat(0.5) * p[1] * stretch * stretch
    }
    #[inline(always)]
    fn gradient<S: Lane>(p: &[S; 3], x: &[[S; D]; 2]) -> [[S; D]; 2] {
        let (d, length, inverse) = apart(x);
        both(&d, p[1] * (length - p[0]) * inverse)
    }
    #[inline(always)]
    fn damping<S: Lane>(p: &[S; 3], x: &[[S; D]; 2], v: &[[S; D]; 2]) -> ([[S; D]; 2], S) {
        let (d, _, inverse) = apart(x);
        let mut rate = v[0];
        for i in 0..D {
            rate[i] = v[0][i] - v[1][i];
        }
        let speed = dot(&rate, &d) * inverse;
        let drag = p[2] * speed;
        (both(&d, -(drag * inverse)), drag * speed)
    }
}

pub(crate) fn spring_parameters<const D: usize>(positions: &[[f64; D]], [a, b]: [u32; 2], damping: f64) -> [f64; 3] {
    let (_, length, _) = apart(&[positions[a as usize], positions[b as usize]]);
    [length, STIFFNESS, damping]
}

/// A linear tetrahedron of a material; parameters: (∂X/∂ξ)⁻¹ row by row, its volume, μ, λ.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tetrahedron<M>(PhantomData<M>);

impl<M: Material<3>> Tetrahedron<M> {
    /// Energy density, stress, and (∂X/∂ξ)⁻¹.
    #[inline(always)]
    fn ask<S: Lane>(p: &[S; 12], x: &[[S; 3]; 4]) -> (S, [[S; 3]; 3], [[S; 3]; 3]) {
        let (mut inverse, mut sides) = ([[S::zero(); 3]; 3], [[S::zero(); 3]; 3]);
        for i in 0..3 {
            for j in 0..3 {
                inverse[i][j] = p[3 * i + j];
                sides[i][j] = x[j + 1][i] - x[0][i];
            }
        }
        let parameters = Parameters { mu: p[10], lambda: p[11], own: S::zero() };
        let (energy, stress) = M::energy_and_stress(&parameters, &matrix::product(&sides, &inverse));
        (energy, stress, inverse)
    }
}

impl<M: Material<3>> Kernel<3, 4, 12> for Tetrahedron<M> {
    const NAME: &'static str = "tetrahedron";
    #[inline(always)]
    fn energy<S: Lane>(p: &[S; 12], x: &[[S; 3]; 4]) -> S {
        p[9] * Self::ask(p, x).0
    }
    #[inline(always)]
    fn gradient<S: Lane>(p: &[S; 12], x: &[[S; 3]; 4]) -> [[S; 3]; 4] {
        let (_, stress, inverse) = Self::ask(p, x);
        let pull = matrix::scaled(&matrix::product_transposed(&stress, &inverse), p[9]);
        let mut out = [[S::zero(); 3]; 4];
        for i in 0..3 {
            for j in 0..3 {
                out[j + 1][i] = pull[i][j];
                out[0][i] -= pull[i][j];
            }
        }
        out
    }
}

pub(crate) fn tetrahedron_parameters(positions: &[[f64; 3]], nodes: [u32; 4]) -> [f64; 12] {
    let x = nodes.map(|node| positions[node as usize]);
    let sides: [[f64; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| x[j + 1][i] - x[0][i]));
    let cofactors = matrix::cofactor(&sides);
    let determinant = matrix::determinant_by(&sides, &cofactors);
    let mut out = [0.0; 12];
    for i in 0..3 {
        for j in 0..3 {
            out[3 * i + j] = cofactors[j][i] / determinant;
        }
    }
    out[9] = determinant / 6.0;
    out[10] = MODULUS / (2.0 * (1.0 + RATIO));
    out[11] = MODULUS * RATIO / ((1.0 + RATIO) * (1.0 - 2.0 * RATIO));
    out
}
