//! One number, or eight of them: the type over which every formula of physics is written.

use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// How many numbers the wide lane holds, on every machine.
///
/// The width is *virtual*: a processor with narrower registers takes several instructions per
/// operation. Sums are therefore split the same way everywhere, which is what makes their bits equal.
pub const WIDTH: usize = 8;

/// `f64`, or eight of them: one formula serves the scalar reference and the vector path.
///
/// Branches are written as [`Lane::select`], so that both sides are always evaluated and the
/// operations (and with them the bits) do not depend on the width.
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
    /// The outcome of a comparison, one truth value per number.
    type Mask: Copy;

    /// The same number in every place.
    fn splat(value: f64) -> Self;
    /// Square root, correctly rounded.
    fn sqrt(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// Where `self < other`.
    fn less(self, other: Self) -> Self::Mask;
    /// Where `self <= other`.
    fn less_or_equal(self, other: Self) -> Self::Mask;
    /// `yes` where the mask holds, else `no`.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// Where both masks hold.
    fn both(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// Whether the mask holds anywhere.
    fn any(mask: Self::Mask) -> bool;
    /// Natural logarithm (own series, the same bits everywhere); the argument must be positive and normal.
    fn ln(self) -> Self;
    /// Exponential function (own series, the same bits everywhere).
    fn exp(self) -> Self;

    /// The lesser of the two; `other` where `self` is not a number.
    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        Self::select(self.less(other), self, other)
    }
    /// The greater of the two; `other` where `self` is not a number.
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        Self::select(other.less(self), self, other)
    }
    /// Zero in every place.
    #[inline(always)]
    fn zero() -> Self {
        Self::splat(0.0)
    }
    /// One in every place.
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

/// Numbers of a row: what [`Register::gather_rows`] reads at each place.
pub const ROW: usize = 4;

/// As many numbers as the processor computes at once: a piece of a [`Pack`].
///
/// A formula that needs more values at a time than there are registers is faster register by register than pack by pack.
pub trait Register: Lane {
    /// How many numbers.
    const NUMBERS: usize;
    /// Reads the numbers.
    ///
    /// # Safety
    /// So many numbers must lie there.
    #[allow(unsafe_code)]
    unsafe fn read(from: *const f64) -> Self;
    /// Writes the numbers.
    ///
    /// # Safety
    /// There must be room for so many numbers.
    #[allow(unsafe_code)]
    unsafe fn write(self, to: *mut f64);
    /// Reads the numbers from the start of a slice.
    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        // SAFETY: the slice holds so many numbers.
        #[allow(unsafe_code)]
        unsafe {
            Self::read(from[..Self::NUMBERS].as_ptr())
        }
    }
    /// Writes the numbers to the start of a slice.
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        // SAFETY: the slice has room for so many numbers.
        #[allow(unsafe_code)]
        unsafe {
            self.write(to[..Self::NUMBERS].as_mut_ptr());
        }
    }
    /// Reads numbers of single precision from the start of a slice.
    fn load_single(from: &[f32]) -> Self;
    /// Reads the numbers from so many indices of a slice.
    fn gather(from: &[f64], indices: &[u32]) -> Self;
    /// Reads so many rows of [`ROW`] numbers; the first register has the first numbers of all rows.
    ///
    /// Four times faster than gathering column by column, where positions are copied to rows first.
    fn gather_rows(from: &[f64], rows: &[u32]) -> [Self; ROW];
    /// Writes rows of [`ROW`] numbers one after the other; the first register has the first numbers of all rows.
    fn store_rows(columns: [Self; ROW], to: &mut [f64]);
    /// The numbers moved up by one place, the last number of the register before them first.
    fn after(self, before: Self) -> Self;
    /// Where the place in the register is less than `count`.
    fn first(count: usize) -> Self::Mask;
}

/// Eight numbers computed side by side: a [`Lane`] that can be read from and written to columns of memory.
///
/// The types behind it belong to one set of vector instructions each and are made by [`crate::Simd::run`] alone.
pub trait Pack: Lane {
    /// What the processor computes at once.
    type Part: Register;
    /// How many of them make eight numbers.
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
    /// Eight numbers must lie there.
    #[allow(unsafe_code)]
    unsafe fn read(from: *const f64) -> Self;
    /// Writes eight numbers.
    ///
    /// # Safety
    /// There must be room for eight numbers.
    #[allow(unsafe_code)]
    unsafe fn write(self, to: *mut f64);
    /// Reads eight numbers from eight indices of a slice.
    fn gather(from: &[f64], indices: &[u32]) -> Self;
    /// The eight numbers in order.
    fn to_array(self) -> [f64; WIDTH];
    /// Eight numbers in order.
    fn from_array(numbers: [f64; WIDTH]) -> Self;
    /// The numbers moved up by one place, the last number of `previous` first.
    fn after(self, previous: Self) -> Self;
    /// Where the place is less than `count`.
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

/// An array of lanes, each from its number: `lanes!(P, d => expression)`.
///
/// A macro and not a function with a closure: closures are not inlined into code for vector instructions reliably,
/// and what is not inlined costs ten times the time.
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
