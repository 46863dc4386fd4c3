//! Eight numbers in as many registers as the processor needs for them.
//!
//! # Safety
//! `read` and `write` pass the guarantees of their caller on to the registers.
#![allow(unsafe_code)]

use crate::lane::{Lane, Pack, Register, WIDTH};
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// Eight numbers in `N` registers.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct Registers<R, const N: usize>([R; N]);

/// Processes one register after the other. The loop is a macro, because closures are not inlined
/// reliably.
macro_rules! each {
    ($r:ident => $value:expr) => {{
        let mut out = [R::zero(); N];
        for $r in 0..N {
            out[$r] = $value;
        }
        Registers(out)
    }};
}

macro_rules! operator {
    ($trait:ident $method:ident) => {
        impl<R: Register, const N: usize> $trait for Registers<R, N> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                each!(r => $trait::$method(self.0[r], other.0[r]))
            }
        }
    };
}
operator!(Add add);
operator!(Sub sub);
operator!(Mul mul);
operator!(Div div);

impl<R: Register, const N: usize> AddAssign for Registers<R, N> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
impl<R: Register, const N: usize> SubAssign for Registers<R, N> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}
impl<R: Register, const N: usize> Neg for Registers<R, N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        each!(r => -self.0[r])
    }
}

impl<R: Register, const N: usize> Lane for Registers<R, N> {
    type Mask = [R::Mask; N];
    #[inline(always)]
    fn splat(value: f64) -> Self {
        Registers([R::splat(value); N])
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        each!(r => self.0[r].sqrt())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        each!(r => self.0[r].abs())
    }
    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        each!(r => self.0[r].smaller(other.0[r]))
    }
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        each!(r => self.0[r].larger(other.0[r]))
    }
    #[inline(always)]
    fn less(self, other: Self) -> Self::Mask {
        let mut out = [R::zero().less(R::zero()); N];
        for r in 0..N {
            out[r] = self.0[r].less(other.0[r]);
        }
        out
    }
    #[inline(always)]
    fn less_or_equal(self, other: Self) -> Self::Mask {
        let mut out = [R::zero().less(R::zero()); N];
        for r in 0..N {
            out[r] = self.0[r].less_or_equal(other.0[r]);
        }
        out
    }
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        each!(r => R::select(mask[r], yes.0[r], no.0[r]))
    }
    #[inline(always)]
    fn both(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        let mut out = a;
        for r in 0..N {
            out[r] = R::both(a[r], b[r]);
        }
        out
    }
    #[inline(always)]
    fn any(mask: Self::Mask) -> bool {
        let mut out = false;
        for m in mask {
            out |= R::any(m);
        }
        out
    }
    #[inline(always)]
    fn ln(self) -> Self {
        each!(r => self.0[r].ln())
    }
    #[inline(always)]
    fn exp(self) -> Self {
        each!(r => self.0[r].exp())
    }
}

impl<R: Register, const N: usize> Pack for Registers<R, N> {
    type Part = R;
    const PARTS: usize = N;
    #[inline(always)]
    fn part(self, number: usize) -> R {
        self.0[number]
    }
    #[inline(always)]
    fn set_part(&mut self, number: usize, part: R) {
        self.0[number] = part;
    }
    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        // SAFETY: the slice holds eight numbers.
        unsafe { Self::read(from[..WIDTH].as_ptr()) }
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        // SAFETY: the slice has space for eight numbers.
        unsafe { self.write(to[..WIDTH].as_mut_ptr()) }
    }
    #[inline(always)]
    unsafe fn read(from: *const f64) -> Self {
        // SAFETY: the caller guarantees eight numbers.
        each!(r => unsafe { R::read(from.add(R::NUMBERS * r)) })
    }
    #[inline(always)]
    unsafe fn write(self, to: *mut f64) {
        for r in 0..N {
            // SAFETY: the caller guarantees space for eight numbers.
            unsafe { self.0[r].write(to.add(R::NUMBERS * r)) }
        }
    }
    #[inline(always)]
    fn gather(from: &[f64], indices: &[u32]) -> Self {
        let indices = &indices[..WIDTH];
        each!(r => R::gather(from, &indices[r * R::NUMBERS..(r + 1) * R::NUMBERS]))
    }
    #[inline(always)]
    fn to_array(self) -> [f64; WIDTH] {
        let mut out = [0.0; WIDTH];
        self.store(&mut out);
        out
    }
    #[inline(always)]
    fn from_array(numbers: [f64; WIDTH]) -> Self {
        Self::load(&numbers)
    }
    #[inline(always)]
    fn after(self, previous: Self) -> Self {
        each!(r => {
            let before = if r == 0 { previous.0[N - 1] } else { self.0[r - 1] };
            self.0[r].after(before)
        })
    }
    #[inline(always)]
    fn first(count: usize) -> Self::Mask {
        let mut out = [R::zero().less(R::zero()); N];
        for r in 0..N {
            out[r] = R::first(count.saturating_sub(r * R::NUMBERS));
        }
        out
    }
}
