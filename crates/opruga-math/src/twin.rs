//! Two lanes side by side, for computations that mostly wait for roots and divisions: while one waits, the other computes.

use crate::lane::Lane;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// Two lanes of the same type. Every number is computed as it would be in a single lane.
#[derive(Clone, Copy, Debug)]
pub struct Twin<S>(pub S, pub S);

macro_rules! operator {
    ($trait:ident $method:ident) => {
        impl<S: Lane> $trait for Twin<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Twin($trait::$method(self.0, other.0), $trait::$method(self.1, other.1))
            }
        }
    };
}
operator!(Add add);
operator!(Sub sub);
operator!(Mul mul);
operator!(Div div);

impl<S: Lane> AddAssign for Twin<S> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
impl<S: Lane> SubAssign for Twin<S> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}
impl<S: Lane> Neg for Twin<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Twin(-self.0, -self.1)
    }
}

impl<S: Lane> Lane for Twin<S> {
    type Mask = (S::Mask, S::Mask);
    #[inline(always)]
    fn splat(value: f64) -> Self {
        Twin(S::splat(value), S::splat(value))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Twin(self.0.sqrt(), self.1.sqrt())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Twin(self.0.abs(), self.1.abs())
    }
    #[inline(always)]
    fn less(self, other: Self) -> Self::Mask {
        (self.0.less(other.0), self.1.less(other.1))
    }
    #[inline(always)]
    fn less_or_equal(self, other: Self) -> Self::Mask {
        (self.0.less_or_equal(other.0), self.1.less_or_equal(other.1))
    }
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        Twin(S::select(mask.0, yes.0, no.0), S::select(mask.1, yes.1, no.1))
    }
    #[inline(always)]
    fn both(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        (S::both(a.0, b.0), S::both(a.1, b.1))
    }
    #[inline(always)]
    fn any(mask: Self::Mask) -> bool {
        S::any(mask.0) | S::any(mask.1)
    }
    #[inline(always)]
    fn ln(self) -> Self {
        Twin(self.0.ln(), self.1.ln())
    }
    #[inline(always)]
    fn exp(self) -> Self {
        Twin(self.0.exp(), self.1.exp())
    }
    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        Twin(self.0.smaller(other.0), self.1.smaller(other.1))
    }
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        Twin(self.0.larger(other.0), self.1.larger(other.1))
    }
}

#[cfg(test)]
mod tests {
    use super::Twin;
    use crate::lane::Lane;
    use crate::singular::singular;

    #[test]
    fn each_of_the_two_has_the_bits_that_it_has_alone() {
        let one = [[1.0, 0.2, -0.3], [0.1, 0.9, 0.4], [-0.2, 0.3, 1.1]];
        // This matrix is already orthogonal, so it is finished before the other one.
        let other = [[0.0, -2.0, 0.0], [3.0, 0.0, 0.0], [0.0, 0.0, 0.5]];
        let mut both = [[Twin::<f64>::zero(); 3]; 3];
        for i in 0..3 {
            for j in 0..3 {
                both[i][j] = Twin(one[i][j], other[i][j]);
            }
        }
        let (first, second, together) = (singular(&one), singular(&other), singular(&both));
        for i in 0..3 {
            assert_eq!((together.sigma[i].0, together.sigma[i].1), (first.sigma[i], second.sigma[i]));
            for j in 0..3 {
                assert_eq!((together.u[i][j].0, together.u[i][j].1), (first.u[i][j], second.u[i][j]));
                assert_eq!((together.v[i][j].0, together.v[i][j].1), (first.v[i][j], second.v[i][j]));
            }
        }
        let (logarithm, root) = (Twin(2.0, 0.5).ln(), Twin(2.0, 0.5).sqrt());
        assert_eq!((logarithm.0, logarithm.1), (Lane::ln(2.0), Lane::ln(0.5)));
        assert_eq!((root.0, root.1), (Lane::sqrt(2.0), Lane::sqrt(0.5)));
    }
}
