//! The logarithm of many numbers at once, with the bits of [`crate::elementary::natural_logarithm`].

use crate::lane::Lane;

/// ln 2 in two parts, such that the product of the first part and any exponent is exact.
const LN_2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];

/// Coefficients of r in ln(1 + f) = s (2 + r), in even powers of s = f/(2 + f), from s² on (fdlibm, `e_log.c`).
const LOGARITHM: [f64; 7] = [
    6.666_666_666_666_735e-1,
    3.999_999_999_940_942e-1,
    2.857_142_874_366_239e-1,
    2.222_219_843_214_978_4e-1,
    1.818_357_216_161_805e-1,
    1.531_383_769_920_937_3e-1,
    1.479_819_860_511_658_6e-1,
];

/// The logarithm ln(m 2ᵏ) for √½ ≤ m < √2, with the operations of `libm::log` in the same order, so that lanes have the same
/// bits.
#[inline(always)]
pub(crate) fn logarithm_of_parts<S: Lane>(mantissa: S, exponent: S) -> S {
    let c = |k: usize| S::splat(LOGARITHM[k]);
    let f = mantissa - S::one();
    let half = S::splat(0.5) * f * f;
    let s = f / (S::splat(2.0) + f);
    let z = s * s;
    let w = z * z;
    // The two halves of the series, with the names of fdlibm.
    let t1 = w * (c(1) + w * (c(3) + w * c(5)));
    let t2 = z * (c(0) + w * (c(2) + w * (c(4) + w * c(6))));
    let r = t2 + t1;
    s * (half + r) + exponent * S::splat(LN_2[1]) - half + f + exponent * S::splat(LN_2[0])
}
