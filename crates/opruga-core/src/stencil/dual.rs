//! Numbers that carry a derivative: one formula gives the value and the exact slope.

use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};
use opruga_math::Lane;

/// A number and its derivative with respect to one variable (forward differentiation).
///
/// Comparisons use only the value. If a formula selects one of two branches, the derivative belongs to the selected branch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<S> {
    /// The value of the number.
    pub value: S,
    /// Its derivative.
    pub slope: S,
}

impl<S: Lane> Dual<S> {
    /// Returns a constant: its derivative is zero.
    #[inline(always)]
    pub fn constant(value: S) -> Dual<S> {
        Dual { value, slope: S::zero() }
    }
    /// Returns the variable of the differentiation: its derivative is one.
    #[inline(always)]
    pub fn variable(value: S) -> Dual<S> {
        Dual { value, slope: S::one() }
    }
}

impl<S: Lane> Add for Dual<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Dual { value: self.value + b.value, slope: self.slope + b.slope }
    }
}
impl<S: Lane> Sub for Dual<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Dual { value: self.value - b.value, slope: self.slope - b.slope }
    }
}
impl<S: Lane> Mul for Dual<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        Dual { value: self.value * b.value, slope: self.slope * b.value + self.value * b.slope }
    }
}
impl<S: Lane> Div for Dual<S> {
    type Output = Self;
    #[inline(always)]
    fn div(self, b: Self) -> Self {
        let value = self.value / b.value;
        Dual { value, slope: (self.slope - value * b.slope) / b.value }
    }
}
impl<S: Lane> Neg for Dual<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Dual { value: -self.value, slope: -self.slope }
    }
}
impl<S: Lane> AddAssign for Dual<S> {
    #[inline(always)]
    fn add_assign(&mut self, b: Self) {
        *self = *self + b;
    }
}
impl<S: Lane> SubAssign for Dual<S> {
    #[inline(always)]
    fn sub_assign(&mut self, b: Self) {
        *self = *self - b;
    }
}

impl<S: Lane> Lane for Dual<S> {
    type Mask = S::Mask;
    #[inline(always)]
    fn splat(value: f64) -> Self {
        Dual::constant(S::splat(value))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let value = self.value.sqrt();
        Dual { value, slope: self.slope / (value + value) }
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self::select(self.less(Self::zero()), -self, self)
    }
    #[inline(always)]
    fn less(self, b: Self) -> S::Mask {
        self.value.less(b.value)
    }
    #[inline(always)]
    fn less_or_equal(self, b: Self) -> S::Mask {
        self.value.less_or_equal(b.value)
    }
    #[inline(always)]
    fn select(mask: S::Mask, yes: Self, no: Self) -> Self {
        Dual { value: S::select(mask, yes.value, no.value), slope: S::select(mask, yes.slope, no.slope) }
    }
    #[inline(always)]
    fn both(a: S::Mask, b: S::Mask) -> S::Mask {
        S::both(a, b)
    }
    #[inline(always)]
    fn any(mask: S::Mask) -> bool {
        S::any(mask)
    }
    #[inline(always)]
    fn ln(self) -> Self {
        Dual { value: self.value.ln(), slope: self.slope / self.value }
    }
    #[inline(always)]
    fn exp(self) -> Self {
        let value = self.value.exp();
        Dual { value, slope: value * self.slope }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// f(x) = ln(x² + 1) √x e^(−x) / |x − 3|, differentiated by hand.
    #[test]
    fn derivative_of_a_formula() {
        let x = Dual::variable(1.7f64);
        let one = Dual::one();
        let f = (x * x + one).ln() * x.sqrt() * (-x).exp() / (x - Dual::splat(3.0)).abs();
        let logarithmic = 2.0 * 1.7 / (3.89 * Lane::ln(3.89f64)) + 0.5 / 1.7 - 1.0 + 1.0 / 1.3;
        assert!((f.slope / f.value - logarithmic).abs() < 1e-14);
    }
}
