//! One number, or eight of them: the type over which every formula of physics is written.

use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// The number of values in the wide lane, on every machine.
///
/// The width is *virtual*: a processor with narrower registers takes several instructions per operation. Sums are therefore split
/// the same way everywhere, which makes their bits equal.
pub const WIDTH: usize = 8;

/// One `f64`, or eight: one formula serves the scalar reference and the vector path.
///
/// Branches are written as [`Lane::select`], so that both sides are always evaluated, and the operations (and so the bits) do not
/// depend on the width.
pub trait Lane:
    Copy
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
{
    /// The result of a comparison, one truth value per number.
    type Mask: Copy;

    /// The same number in every lane.
    fn splat(value: f64) -> Self;
    /// Square root, correctly rounded.
    fn sqrt(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// True where `self < other`.
    fn less(self, other: Self) -> Self::Mask;
    /// True where `self <= other`.
    fn less_or_equal(self, other: Self) -> Self::Mask;
    /// `yes` where the mask is true, otherwise `no`.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// True where both masks are true.
    fn both(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// Whether the mask is true anywhere.
    fn any(mask: Self::Mask) -> bool;
    /// Natural logarithm, with the same bits everywhere. It is fast if the argument is positive and normal.
    fn ln(self) -> Self;
    /// Exponential function, with the same bits everywhere.
    fn exp(self) -> Self;

    /// The smaller of the two, or `other` if `self` is NaN.
    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        Self::select(self.less(other), self, other)
    }
    /// The larger of the two, or `other` if `self` is NaN.
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        Self::select(other.less(self), self, other)
    }
    /// The number zero in every lane.
    #[inline(always)]
    fn zero() -> Self {
        Self::splat(0.0)
    }
    /// The number one in every lane.
    #[inline(always)]
    fn one() -> Self {
        Self::splat(1.0)
    }
}

impl Lane for f64 {
    type Mask = bool;
    #[inline(always)]
    fn splat(value: f64) -> f64 {
        value
    }
    #[inline(always)]
    fn sqrt(self) -> f64 {
        f64::sqrt(self)
    }
    #[inline(always)]
    fn abs(self) -> f64 {
        f64::abs(self)
    }
    #[inline(always)]
    fn less(self, other: f64) -> bool {
        self < other
    }
    #[inline(always)]
    fn less_or_equal(self, other: f64) -> bool {
        self <= other
    }
    #[inline(always)]
    fn select(mask: bool, yes: f64, no: f64) -> f64 {
        if mask { yes } else { no }
    }
    #[inline(always)]
    fn both(a: bool, b: bool) -> bool {
        a & b
    }
    #[inline(always)]
    fn any(mask: bool) -> bool {
        mask
    }
    #[inline(always)]
    fn ln(self) -> f64 {
        crate::elementary::natural_logarithm(self)
    }
    #[inline(always)]
    fn exp(self) -> f64 {
        crate::elementary::exponential(self)
    }
}

/// The number of values in a row, which [`Register::gather_rows`] reads for each lane.
pub const ROW: usize = 4;

/// The numbers that the processor computes at once: a part of a [`Pack`].
///
/// If a formula needs more values at a time than there are registers, it is faster to compute register by register than pack by
/// pack.
pub trait Register: Lane {
    /// How many numbers a register holds.
    const NUMBERS: usize;
    /// Reads the numbers.
    ///
    /// # Safety
    /// `from` must point to that many numbers.
    #[allow(unsafe_code)]
    unsafe fn read(from: *const f64) -> Self;
    /// Writes the numbers.
    ///
    /// # Safety
    /// There must be space for that many numbers.
    #[allow(unsafe_code)]
    unsafe fn write(self, to: *mut f64);
    /// Reads the numbers from the start of a slice.
    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        // SAFETY: the slice holds that many numbers.
        #[allow(unsafe_code)]
        unsafe {
            Self::read(from[..Self::NUMBERS].as_ptr())
        }
    }
    /// Writes the numbers to the start of a slice.
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        // SAFETY: the slice has space for that many numbers.
        #[allow(unsafe_code)]
        unsafe {
            self.write(to[..Self::NUMBERS].as_mut_ptr());
        }
    }
    /// Reads single-precision numbers from the start of a slice.
    fn load_single(from: &[f32]) -> Self;
    /// Reads the numbers at the given indices of a slice.
    fn gather(from: &[f64], indices: &[u32]) -> Self;
    /// Reads rows of [`ROW`] numbers, one row for each lane. The first register has the first numbers of all rows.
    ///
    /// If positions have been copied to rows first, reading rows is four times faster than gathering column by column.
    fn gather_rows(from: &[f64], rows: &[u32]) -> [Self; ROW];
    /// Writes consecutive rows of [`ROW`] numbers. The first register has the first numbers of all rows.
    fn store_rows(columns: [Self; ROW], to: &mut [f64]);
    /// The numbers shifted up by one lane, with the last number of the previous register in the first lane.
    fn after(self, before: Self) -> Self;
    /// True where the index of the lane is less than `count`.
    fn first(count: usize) -> Self::Mask;
}

/// Eight numbers computed side by side: a [`Lane`] that can be read from and written to columns of memory.
///
/// Each type that implements this trait belongs to one set of vector instructions, and only [`crate::Simd::run`] creates its
/// values.
pub trait Pack: Lane {
    /// The part of a pack that the processor computes at once.
    type Part: Register;
    /// The number of parts in eight numbers.
    const PARTS: usize;
    /// One of the parts.
    fn part(self, number: usize) -> Self::Part;
    /// Replaces one of the parts.
    fn set_part(&mut self, number: usize, part: Self::Part);
    /// Reads eight numbers from the start of a slice.
    fn load(from: &[f64]) -> Self;
    /// Writes the eight numbers to the start of a slice.
    fn store(self, to: &mut [f64]);
    /// Reads eight numbers.
    ///
    /// # Safety
    /// `from` must point to eight numbers.
    #[allow(unsafe_code)]
    unsafe fn read(from: *const f64) -> Self;
    /// Writes eight numbers.
    ///
    /// # Safety
    /// There must be space for eight numbers.
    #[allow(unsafe_code)]
    unsafe fn write(self, to: *mut f64);
    /// Reads the numbers at eight indices of a slice.
    fn gather(from: &[f64], indices: &[u32]) -> Self;
    /// The eight numbers in order.
    fn to_array(self) -> [f64; WIDTH];
    /// Eight numbers in order.
    fn from_array(numbers: [f64; WIDTH]) -> Self;
    /// The numbers shifted up by one lane, with the last number of `previous` in the first lane.
    fn after(self, previous: Self) -> Self;
    /// True where the index of the lane is less than `count`.
    fn first(count: usize) -> Self::Mask;
    /// The sum of the eight numbers in one fixed order: ((0+4)+(2+6)) + ((1+5)+(3+7)).
    #[inline(always)]
    fn sum(self) -> f64 {
        sum_in_fixed_order(&self.to_array())
    }
}

/// The sum of eight numbers in one fixed order: ((0+4)+(2+6)) + ((1+5)+(3+7)).
#[inline(always)]
pub fn sum_in_fixed_order(a: &[f64; WIDTH]) -> f64 {
    ((a[0] + a[4]) + (a[2] + a[6])) + ((a[1] + a[5]) + (a[3] + a[7]))
}

/// An array of lanes, each computed from its index: `lanes!(P, d => expression)`.
///
/// `lanes!` is a macro and not a function with a closure, because closures are not inlined reliably into code for vector
/// instructions. Code that is not inlined takes ten times as long.
#[macro_export]
macro_rules! lanes {
    ($type:ty, $number:ident => $value:expr) => {{
        let mut out = [<$type as $crate::Lane>::zero(); D];
        for $number in 0..D {
            out[$number] = $value;
        }
        out
    }};
}
