//! The law of one stencil: energy and gradient over lanes, and their derivatives.

use super::dual::Dual;
use core::fmt::Debug;
use opruga_math::Lane;

/// The blocks ∂²U/∂xₐ∂x_b of a stencil, `[a][b]` with rows i and columns j of the coordinates.
pub type Blocks<const D: usize, const N: usize> = [[[[f64; D]; D]; N]; N];

/// The law of one stencil of N nodes in D dimensions with K parameters.
///
/// Formulas are straight-line code over [`Lane`], without closures and without branches on values ([`Lane::select`]). Methods
/// should be `#[inline(always)]`, so that they become vector code in the loops here.
pub trait Kernel<const D: usize, const N: usize, const K: usize>: Copy + Debug + Send + Sync + 'static {
    /// The name of the model.
    const NAME: &'static str;
    /// The energy U [J].
    fn energy<S: Lane>(parameters: &[S; K], x: &[[S; D]; N]) -> S;
    /// ∂U/∂x of every node [N].
    fn gradient<S: Lane>(parameters: &[S; K], x: &[[S; D]; N]) -> [[S; D]; N];
    /// The damping force on every node [N] and the power that it dissipates [W]; evaluated only if the model is damped.
    #[inline(always)]
    fn damping<S: Lane>(_parameters: &[S; K], _x: &[[S; D]; N], _v: &[[S; D]; N]) -> ([[S; D]; N], S) {
        ([[S::zero(); D]; N], S::zero())
    }
    /// −∂F/∂v of the damping force; by default its exact derivative by dual numbers.
    fn damping_matrix(parameters: &[f64; K], x: &[[f64; D]; N]) -> Blocks<D, N> {
        let constants = parameters.map(Dual::constant);
        let x = x.map(|node| node.map(Dual::constant));
        let mut v = [[Dual::constant(0.0); D]; N];
        let mut out = [[[[0.0; D]; D]; N]; N];
        for b in 0..N {
            for j in 0..D {
                v[b][j].slope = 1.0;
                let (force, _) = Self::damping(&constants, &x, &v);
                v[b][j].slope = 0.0;
                for a in 0..N {
                    for i in 0..D {
                        out[a][b][i][j] = -force[a][i].slope;
                    }
                }
            }
        }
        out
    }
    /// ∂²U/∂x∂x. By default, it is the exact derivative of [`Kernel::gradient`], computed with dual numbers.
    fn hessian(parameters: &[f64; K], x: &[[f64; D]; N]) -> Blocks<D, N> {
        let constants = parameters.map(Dual::constant);
        let mut at = x.map(|node| node.map(Dual::constant));
        let mut out = [[[[0.0; D]; D]; N]; N];
        for b in 0..N {
            for j in 0..D {
                at[b][j].slope = 1.0;
                let slope = Self::gradient(&constants, &at);
                at[b][j].slope = 0.0;
                for a in 0..N {
                    for i in 0..D {
                        out[a][b][i][j] = slope[a][i].slope;
                    }
                }
            }
        }
        out
    }
}
