//! Eight numbers in as many registers as the processor needs for them.
//!
//! # Safety
//! `read` and `write` hand the promise of their caller on to the registers.
#![allow(unsafe_code)]

use crate::lane::{Lane, Pack, Register, WIDTH};
use core::mem::MaybeUninit;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// Eight numbers in `N` registers.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct Registers<R, const N: usize>([R; N]);

/// Does the same for every register, one after the other; a macro, since closures are not inlined reliably.
///
/// Written out and not a loop: formulas are hundreds of such operations, and the compiler takes a third of its time to
/// see that their loops are none. A processor takes one, two or four registers; eight are plain numbers.
macro_rules! for_each {
    ($r:ident => $do:stmt) => {
        for_each!(@ $r 0 $do);
        if N > 1 {
            for_each!(@ $r 1 $do);
        }
        if N > 2 {
            for_each!(@ $r 2 $do);
            for_each!(@ $r 3 $do);
        }
        if N > 4 {
            for_each!(@ $r 4 $do);
            for_each!(@ $r 5 $do);
            for_each!(@ $r 6 $do);
            for_each!(@ $r 7 $do);
        }
        const { assert!(N == 1 || N == 2 || N == 4 || N == 8, "what is written out above") };
    };
    (@ $r:ident $number:literal $do:stmt) => {{
        let $r = $number;
        $do
    }};
}

/// A value for every register, as an array; one that was filled with zeros first would be a loop again.
macro_rules! array {
    ($type:ty, $r:ident => $value:expr) => {{
        let mut out = MaybeUninit::<[$type; N]>::uninit();
        let first = out.as_mut_ptr().cast::<$type>();
        for_each!($r => {
            let value = $value;
            // SAFETY: it is one of the array's N.
            unsafe { first.add($r).write(value) }
        });
        // SAFETY: all N were written.
        unsafe { out.assume_init() }
    }};
}
/// The same as registers.
macro_rules! each {
    ($r:ident => $value:expr) => {
        Registers(array!(R, $r => $value))
    };
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
        each!(_r => R::splat(value))
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
        array!(R::Mask, r => self.0[r].less(other.0[r]))
    }
    #[inline(always)]
    fn less_or_equal(self, other: Self) -> Self::Mask {
        array!(R::Mask, r => self.0[r].less_or_equal(other.0[r]))
    }
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        each!(r => R::select(mask[r], yes.0[r], no.0[r]))
    }
    #[inline(always)]
    fn both(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        array!(R::Mask, r => R::both(a[r], b[r]))
    }
    #[inline(always)]
    fn any(mask: Self::Mask) -> bool {
        let mut out = false;
        for_each!(r => out |= R::any(mask[r]));
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
        // SAFETY: the slice has room for eight numbers.
        unsafe { self.write(to[..WIDTH].as_mut_ptr()) }
    }
    #[inline(always)]
    unsafe fn read(from: *const f64) -> Self {
        // SAFETY: the caller promises eight numbers.
        each!(r => unsafe { R::read(from.add(R::NUMBERS * r)) })
    }
    #[inline(always)]
    unsafe fn write(self, to: *mut f64) {
        // SAFETY: the caller promises room for eight numbers.
        for_each!(r => unsafe { self.0[r].write(to.add(R::NUMBERS * r)) });
    }
    #[inline(always)]
    fn gather(from: &[f64], places: &[u32]) -> Self {
        let places = &places[..WIDTH];
        each!(r => R::gather(from, &places[r * R::NUMBERS..(r + 1) * R::NUMBERS]))
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
        array!(R::Mask, r => R::first(count.saturating_sub(r * R::NUMBERS)))
    }
}
