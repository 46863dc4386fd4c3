//! Vectors in space over lanes.

use opruga_math::Lane;

/// The inverse of the number, or zero for numbers below the smallest normal number.
#[inline(always)]
pub(crate) fn inverse<S: Lane>(a: S) -> S {
    let real = S::splat(f64::MIN_POSITIVE).less_or_equal(a);
    S::select(real, S::one() / S::select(real, a, S::one()), S::zero())
}

/// A vector as a vector in space. If it is in the plane, its third coordinate is zero.
#[inline(always)]
pub(crate) fn in_space<S: Lane, const D: usize>(a: &[S; D]) -> [S; 3] {
    [a[0], a[1], if D == 3 { a[D - 1] } else { S::zero() }]
}

/// The first D components of a vector in space.
#[inline(always)]
pub(crate) fn in_dimension<S: Lane, const D: usize>(a: &[S; 3]) -> [S; D] {
    opruga_math::lanes!(S, d => a[d])
}

/// a − b.
#[inline(always)]
pub(crate) fn minus<S: Lane>(a: &[S; 3], b: &[S; 3]) -> [S; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// s a.
#[inline(always)]
pub(crate) fn scaled<S: Lane>(a: &[S; 3], s: S) -> [S; 3] {
    [a[0] * s, a[1] * s, a[2] * s]
}

/// Scalar product.
#[inline(always)]
pub(crate) fn dot<S: Lane>(a: &[S; 3], b: &[S; 3]) -> S {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Vector product.
#[inline(always)]
pub(crate) fn cross<S: Lane>(a: &[S; 3], b: &[S; 3]) -> [S; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
