//! Values at the corners of a box, or at Gauss's points beside them, and the functions 1, ξ, η, … that are ±1 there.
//!
//! ```text
//! N = 4:  1  ξ  η  ξη          N = 8:  1  ξ  η  ζ  ηζ  ζξ  ξη  ξηζ
//! ```
//!
//! The sums with the signs of all these functions are computed from sums and differences of pairs, with 24 instead of 56
//! additions in space.

use opruga_math::Lane;

/// Σ x over the corners with the signs of every function.
#[inline(always)]
pub(super) fn sums<R: Lane, const N: usize>(x: &[R; N]) -> [R; N] {
    let mut out = *x;
    let low = sums_of_square([x[0], x[1], x[2], x[3]]);
    if N == 4 {
        out.copy_from_slice(&low);
    } else {
        let high = sums_of_square([x[4], x[5], x[6], x[7]]);
        out.copy_from_slice(&[
            low[0] + high[0],
            low[1] + high[1],
            low[2] + high[2],
            high[0] - low[0],
            high[2] - low[2],
            high[1] - low[1],
            low[3] + high[3],
            high[3] - low[3],
        ]);
    }
    out
}

/// Σ c over the functions at every corner: the transpose of [`sums`].
#[inline(always)]
pub(super) fn values<R: Lane, const N: usize>(c: &[R; N]) -> [R; N] {
    let mut out = *c;
    if N == 4 {
        out.copy_from_slice(&values_of_square([c[0], c[1], c[2], c[3]]));
    } else {
        let low = values_of_square([c[0] - c[3], c[1] - c[5], c[2] - c[4], c[6] - c[7]]);
        let high = values_of_square([c[0] + c[3], c[1] + c[5], c[2] + c[4], c[6] + c[7]]);
        out[..4].copy_from_slice(&low);
        out[4..].copy_from_slice(&high);
    }
    out
}

#[inline(always)]
fn sums_of_square<R: Lane>(x: [R; 4]) -> [R; 4] {
    let (low, high) = (x[0] + x[1], x[3] + x[2]);
    let (low_slope, high_slope) = (x[1] - x[0], x[2] - x[3]);
    [low + high, low_slope + high_slope, high - low, high_slope - low_slope]
}

#[inline(always)]
fn values_of_square<R: Lane>(c: [R; 4]) -> [R; 4] {
    let (low, high) = (c[0] - c[2], c[0] + c[2]);
    let (low_slope, high_slope) = (c[1] - c[3], c[1] + c[3]);
    [low - low_slope, low + low_slope, high + high_slope, high - high_slope]
}

#[cfg(test)]
mod tests {
    use super::super::super::elements::CORNERS;
    use super::*;

    fn sign(corner: usize, function: usize) -> f64 {
        let [x, y, z] = CORNERS[corner];
        [1.0, x, y, z, y * z, z * x, x * y, x * y * z][function]
    }

    #[test]
    fn sums_and_values_have_the_signs_of_the_functions() {
        let unit = |k: usize| core::array::from_fn::<f64, 8, _>(|l| f64::from(u8::from(k == l)));
        for corner in 0..8 {
            let (sums, values) = (sums(&unit(corner)), (0..8).map(|w| values(&unit(w))[corner]));
            for (function, (sum, value)) in sums.into_iter().zip(values).enumerate() {
                assert_eq!((sum, value), (sign(corner, function), sign(corner, function)));
            }
        }
        let unit = |k: usize| core::array::from_fn::<f64, 4, _>(|l| f64::from(u8::from(k == l)));
        for corner in 0..4 {
            for (function, of_space) in [0, 1, 2, 6].into_iter().enumerate() {
                assert_eq!(sums(&unit(corner))[function], sign(corner, of_space));
                assert_eq!(values(&unit(function))[corner], sign(corner, of_space));
            }
        }
    }
}
