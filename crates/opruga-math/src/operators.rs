//! The arithmetic operators of the wide lanes, written once.

/// Writes the operators and the two assigning ones, which look alike for every type.
macro_rules! operators {
    ($type:ty, $($trait:ident $method:ident $function:expr;)*) => {
        $(impl $trait for $type {
            type Output = $type;
            #[inline(always)]
            fn $method(self, other: $type) -> $type { $function(self, other) }
        })*
        impl AddAssign for $type {
            #[inline(always)]
            fn add_assign(&mut self, other: $type) { *self = *self + other; }
        }
        impl SubAssign for $type {
            #[inline(always)]
            fn sub_assign(&mut self, other: $type) { *self = *self - other; }
        }
        impl Neg for $type {
            type Output = $type;
            #[inline(always)]
            fn neg(self) -> $type { <$type as Lane>::splat(-0.0) - self }
        }
    };
}

pub(crate) use operators;
