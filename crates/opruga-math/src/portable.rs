//! Eight numbers in plain Rust: what runs on targets other than x86-64, and what the tests compare with.
//!
//! # Safety
//! `read` and `write` hand the promise of their caller on.
#![allow(unsafe_code)]

use crate::lane::{Lane, Pack, WIDTH};
use crate::operators::operators;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// Eight numbers in plain Rust.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct Portable([f64; WIDTH]);

#[inline(always)]
fn each(mut f: impl FnMut(usize) -> f64) -> Portable {
    let mut out = [0.0; WIDTH];
    for l in 0..WIDTH {
        out[l] = f(l);
    }
    Portable(out)
}
#[inline(always)]
fn each_mask(mut f: impl FnMut(usize) -> bool) -> [bool; WIDTH] {
    let mut out = [false; WIDTH];
    for l in 0..WIDTH {
        out[l] = f(l);
    }
    out
}

operators! { Portable,
    Add add |a: Portable, b: Portable| each(|l| a.0[l] + b.0[l]);
    Sub sub |a: Portable, b: Portable| each(|l| a.0[l] - b.0[l]);
    Mul mul |a: Portable, b: Portable| each(|l| a.0[l] * b.0[l]);
    Div div |a: Portable, b: Portable| each(|l| a.0[l] / b.0[l]);
}

impl Lane for Portable {
    type Mask = [bool; WIDTH];
    #[inline(always)]
    fn splat(value: f64) -> Self {
        Portable([value; WIDTH])
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        each(|l| self.0[l].sqrt())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        each(|l| self.0[l].abs())
    }
    #[inline(always)]
    fn less(self, other: Self) -> Self::Mask {
        each_mask(|l| self.0[l] < other.0[l])
    }
    #[inline(always)]
    fn less_or_equal(self, other: Self) -> Self::Mask {
        each_mask(|l| self.0[l] <= other.0[l])
    }
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        each(|l| if mask[l] { yes.0[l] } else { no.0[l] })
    }
    #[inline(always)]
    fn both(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        each_mask(|l| a[l] & b[l])
    }
    #[inline(always)]
    fn any(mask: Self::Mask) -> bool {
        mask.iter().any(|&m| m)
    }
    #[inline(always)]
    fn ln(self) -> Self {
        each(|l| Lane::ln(self.0[l]))
    }
    #[inline(always)]
    fn exp(self) -> Self {
        each(|l| Lane::exp(self.0[l]))
    }
}

impl Pack for Portable {
    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        let from = &from[..WIDTH];
        each(|l| from[l])
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        to[..WIDTH].copy_from_slice(&self.0);
    }
    #[inline(always)]
    unsafe fn read(from: *const f64) -> Self {
        // SAFETY: the caller promises eight numbers.
        Portable(unsafe { from.cast::<[f64; WIDTH]>().read_unaligned() })
    }
    #[inline(always)]
    unsafe fn write(self, to: *mut f64) {
        // SAFETY: the caller promises room for eight numbers.
        unsafe { to.cast::<[f64; WIDTH]>().write_unaligned(self.0) }
    }
    #[inline(always)]
    fn gather(from: &[f64], places: &[u32]) -> Self {
        let places = &places[..WIDTH];
        each(|l| from[places[l] as usize])
    }
    #[inline(always)]
    fn to_array(self) -> [f64; WIDTH] {
        self.0
    }
    #[inline(always)]
    fn from_array(numbers: [f64; WIDTH]) -> Self {
        Portable(numbers)
    }
    #[inline(always)]
    fn after(self, previous: Self) -> Self {
        each(|l| if l == 0 { previous.0[WIDTH - 1] } else { self.0[l - 1] })
    }
    #[inline(always)]
    fn first(count: usize) -> Self::Mask {
        each_mask(|l| l < count)
    }
}
