//! The registers of x86-64: two numbers with SSE2, four with AVX2, eight with AVX-512.
//!
//! Registers of all widths use only the basic operations of IEEE 754, so they give the same bits.
//!
//! # Safety
//! The instructions of AVX2 and AVX-512 exist only on processors that have them. The types are private to this crate, and their
//! values are created only in `Simd::run`, after the processor has been tested. `read` and `write` pass the guarantees of their
//! caller on to the load and store instructions.
#![allow(unsafe_code, unused_unsafe)] // not every operation of every register is unsafe

use crate::lane::{Lane, ROW, Register};
use crate::logarithm::logarithm_of_parts;
use core::arch::x86_64::*;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

macro_rules! register {
    ($(#[$note:meta])* $type:ident($register:ty), $count:literal numbers, masks $mask:ty,
     $add:ident $sub:ident $mul:ident $div:ident $set:ident $sqrt:ident $load:ident $store:ident $min:ident $max:ident,
     abs $abs:expr, less $less:expr, less_or_equal $less_or_equal:expr, select $select:expr, both $both:expr, any $any:expr,
     after $after:expr, first $first:expr, single $single:expr, gather $gather:expr, split $split:expr, rows $rows:expr, to_rows $to_rows:expr) => {
        $(#[$note])*
        #[derive(Clone, Copy)]
        #[repr(transparent)]
        pub(crate) struct $type($register);

        // SAFETY (all blocks of this macro): see the head of the file.
        impl Add for $type {
            type Output = $type;
            #[inline(always)]
            fn add(self, other: $type) -> $type { $type(unsafe { $add(self.0, other.0) }) }
        }
        impl Sub for $type {
            type Output = $type;
            #[inline(always)]
            fn sub(self, other: $type) -> $type { $type(unsafe { $sub(self.0, other.0) }) }
        }
        impl Mul for $type {
            type Output = $type;
            #[inline(always)]
            fn mul(self, other: $type) -> $type { $type(unsafe { $mul(self.0, other.0) }) }
        }
        impl Div for $type {
            type Output = $type;
            #[inline(always)]
            fn div(self, other: $type) -> $type { $type(unsafe { $div(self.0, other.0) }) }
        }
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
        impl Lane for $type {
            type Mask = $mask;
            #[inline(always)]
            fn splat(value: f64) -> Self { $type(unsafe { $set(value) }) }
            #[inline(always)]
            fn sqrt(self) -> Self { $type(unsafe { $sqrt(self.0) }) }
            #[inline(always)]
            fn abs(self) -> Self { $type(unsafe { $abs(self.0) }) }
            #[inline(always)]
            fn smaller(self, other: Self) -> Self { $type(unsafe { $min(self.0, other.0) }) }
            #[inline(always)]
            fn larger(self, other: Self) -> Self { $type(unsafe { $max(self.0, other.0) }) }
            #[inline(always)]
            fn less(self, other: Self) -> $mask { unsafe { $less(self.0, other.0) } }
            #[inline(always)]
            fn less_or_equal(self, other: Self) -> $mask { unsafe { $less_or_equal(self.0, other.0) } }
            #[inline(always)]
            fn select(mask: $mask, yes: Self, no: Self) -> Self { $type(unsafe { $select(mask, yes.0, no.0) }) }
            #[inline(always)]
            fn both(a: $mask, b: $mask) -> $mask { unsafe { $both(a, b) } }
            #[inline(always)]
            fn any(mask: $mask) -> bool { unsafe { $any(mask) } }
            #[inline(always)]
            fn ln(self) -> Self {
                let least = <$type as Lane>::splat(f64::MIN_POSITIVE);
                let most = <$type as Lane>::splat(f64::MAX);
                let special = <$type as Lane>::select(
                    <$type as Lane>::both(least.less_or_equal(self), self.less_or_equal(most)),
                    <$type as Lane>::zero(),
                    <$type as Lane>::one(),
                );
                // Numbers that are not positive and normal are rare and take the slow path.
                if <$type as Lane>::any(<$type as Lane>::zero().less(special)) {
                    return self.each_number(<f64 as Lane>::ln);
                }
                let (mantissa, exponent) = unsafe { $split(self.0) };
                logarithm_of_parts($type(mantissa), $type(exponent))
            }
            #[inline(always)]
            fn exp(self) -> Self { self.each_number(<f64 as Lane>::exp) }
        }
        impl $type {
            /// Applies a function of one number to each.
            #[inline(always)]
            fn each_number(self, function: fn(f64) -> f64) -> Self {
                let mut numbers = [0.0; $count];
                unsafe { $store(numbers.as_mut_ptr(), self.0) };
                for number in &mut numbers {
                    *number = function(*number);
                }
                $type(unsafe { $load(numbers.as_ptr()) })
            }
        }
        impl Register for $type {
            const NUMBERS: usize = $count;
            #[inline(always)]
            unsafe fn read(from: *const f64) -> Self { $type(unsafe { $load(from) }) }
            #[inline(always)]
            unsafe fn write(self, to: *mut f64) { unsafe { $store(to, self.0) } }
            #[inline(always)]
            fn after(self, before: Self) -> Self { $type(unsafe { $after(self.0, before.0) }) }
            #[inline(always)]
            fn first(count: usize) -> $mask { unsafe { $first(count) } }
            #[inline(always)]
            fn load_single(from: &[f32]) -> Self { $type(unsafe { $single(from[..$count].as_ptr()) }) }
            #[inline(always)]
            fn gather(from: &[f64], indices: &[u32]) -> Self { $type(unsafe { $gather(from, &indices[..$count]) }) }
            #[inline(always)]
            fn gather_rows(from: &[f64], rows: &[u32]) -> [Self; ROW] {
                let rows = &rows[..$count];
                let mut starts = [core::ptr::null(); $count];
                for k in 0..$count {
                    starts[k] = from[ROW * rows[k] as usize..][..ROW].as_ptr();
                }
                let [a, b, c, d] = unsafe { $rows(starts) };
                [$type(a), $type(b), $type(c), $type(d)]
            }
            #[inline(always)]
            fn store_rows(columns: [Self; ROW], to: &mut [f64]) {
                let [a, b, c, d] = columns;
                unsafe { $to_rows(a.0, b.0, c.0, d.0, to[..ROW * $count].as_mut_ptr()) }
            }
        }
    };
}

/// The bits of √½, rounded down to 32 bits, and their difference from the bits of 1. The mantissas of the logarithm begin at
/// √½.
const ROOT_OF_HALF: i64 = 0x3fe6_a09e << 32;
const SHIFT: i64 = (0x3ff0_0000 - 0x3fe6_a09e) << 32;
/// The bits of the fraction.
const FRACTION: i64 = (1 << 52) - 1;
/// The bits of 2⁵²: a small whole number that is written to its last bits becomes a floating-point number. `BIAS`, which includes
/// the bias of the exponent, is then subtracted.
const WHOLE: i64 = 0x4330_0000_0000_0000;
const BIAS: f64 = 4_503_599_627_370_496.0 + 1023.0;

/// Converts a count of at most eight. The count is converted as a small signed integer, because every processor has one
/// instruction for this.
#[inline(always)]
fn few(count: usize) -> f64 {
    f64::from(count.min(8) as i32)
}

/// The indices of the lanes. A comparison with a count gives the mask of that many first lanes.
const LANE_INDICES: [f64; 4] = [0.0, 1.0, 2.0, 3.0];

register! {
    /// Two numbers in a register of SSE2, which every x86-64 has.
    Sse2(__m128d), 2 numbers, masks __m128d,
    _mm_add_pd _mm_sub_pd _mm_mul_pd _mm_div_pd _mm_set1_pd _mm_sqrt_pd _mm_loadu_pd _mm_storeu_pd _mm_min_pd _mm_max_pd,
    abs |a| _mm_andnot_pd(_mm_set1_pd(-0.0), a),
    less |a, b| _mm_cmplt_pd(a, b), less_or_equal |a, b| _mm_cmple_pd(a, b),
    select |m, yes, no| _mm_or_pd(_mm_and_pd(m, yes), _mm_andnot_pd(m, no)),
    both |a, b| _mm_and_pd(a, b), any |m| _mm_movemask_pd(m) != 0,
    after |a, before| _mm_shuffle_pd::<0b01>(before, a),
    first |count| _mm_cmplt_pd(_mm_loadu_pd(LANE_INDICES.as_ptr()), _mm_set1_pd(few(count))),
    single |from: *const f32| _mm_cvtps_pd(_mm_castsi128_ps(_mm_loadl_epi64(from.cast()))),
    gather |from: &[f64], at: &[u32]| _mm_setr_pd(from[at[0] as usize], from[at[1] as usize]),
    split |x: __m128d| {
        let bits = _mm_add_epi64(_mm_castpd_si128(x), _mm_set1_epi64x(SHIFT));
        let exponent = _mm_or_si128(_mm_srli_epi64::<52>(bits), _mm_set1_epi64x(WHOLE));
        let mantissa = _mm_add_epi64(_mm_and_si128(bits, _mm_set1_epi64x(FRACTION)), _mm_set1_epi64x(ROOT_OF_HALF));
        (_mm_castsi128_pd(mantissa), _mm_sub_pd(_mm_castsi128_pd(exponent), _mm_set1_pd(BIAS)))
    },
    rows |at: [*const f64; 2]| {
        let (a, b) = (_mm_loadu_pd(at[0]), _mm_loadu_pd(at[1]));
        let (c, d) = (_mm_loadu_pd(at[0].add(2)), _mm_loadu_pd(at[1].add(2)));
        [_mm_unpacklo_pd(a, b), _mm_unpackhi_pd(a, b), _mm_unpacklo_pd(c, d), _mm_unpackhi_pd(c, d)]
    },
    to_rows |a, b, c, d, to: *mut f64| {
        _mm_storeu_pd(to, _mm_unpacklo_pd(a, b));
        _mm_storeu_pd(to.add(2), _mm_unpacklo_pd(c, d));
        _mm_storeu_pd(to.add(4), _mm_unpackhi_pd(a, b));
        _mm_storeu_pd(to.add(6), _mm_unpackhi_pd(c, d));
    }
}
register! {
    /// Four numbers in a register of AVX2.
    Avx2(__m256d), 4 numbers, masks __m256d,
    _mm256_add_pd _mm256_sub_pd _mm256_mul_pd _mm256_div_pd _mm256_set1_pd _mm256_sqrt_pd _mm256_loadu_pd _mm256_storeu_pd
    _mm256_min_pd _mm256_max_pd,
    abs |a| _mm256_andnot_pd(_mm256_set1_pd(-0.0), a),
    less |a, b| _mm256_cmp_pd::<_CMP_LT_OQ>(a, b), less_or_equal |a, b| _mm256_cmp_pd::<_CMP_LE_OQ>(a, b),
    select |m, yes, no| _mm256_blendv_pd(no, yes, m),
    both |a, b| _mm256_and_pd(a, b), any |m| _mm256_movemask_pd(m) != 0,
    after |a, before| _mm256_shuffle_pd::<0b0101>(_mm256_permute2f128_pd::<0x21>(before, a), a),
    first |count| first_avx2(count),
    single |from: *const f32| _mm256_cvtps_pd(_mm_loadu_ps(from)),
    gather |from: &[f64], at: &[u32]| {
        _mm256_setr_pd(from[at[0] as usize], from[at[1] as usize], from[at[2] as usize], from[at[3] as usize])
    },
    split |x| split_avx2(x), rows |at| rows_avx2(at), to_rows |a, b, c, d, to| to_rows_avx2(a, b, c, d, to)
}
register! {
    /// Eight numbers in a register of AVX-512.
    Avx512(__m512d), 8 numbers, masks __mmask8,
    _mm512_add_pd _mm512_sub_pd _mm512_mul_pd _mm512_div_pd _mm512_set1_pd _mm512_sqrt_pd _mm512_loadu_pd _mm512_storeu_pd
    _mm512_min_pd _mm512_max_pd,
    abs |a| _mm512_abs_pd(a),
    less |a, b| _mm512_cmp_pd_mask::<_CMP_LT_OQ>(a, b), less_or_equal |a, b| _mm512_cmp_pd_mask::<_CMP_LE_OQ>(a, b),
    select |m, yes, no| _mm512_mask_blend_pd(m, no, yes),
    both |a, b| a & b, any |m| m != 0,
    after |a, before| {
        _mm512_castsi512_pd(_mm512_alignr_epi64::<7>(_mm512_castpd_si512(a), _mm512_castpd_si512(before)))
    },
    first |count| if count >= 8 { 0xff } else { ((1u32 << count) - 1) as u8 },
    single |from: *const f32| _mm512_cvtps_pd(_mm256_loadu_ps(from)),
    gather |from: &[f64], at: &[u32]| gather_avx512(from, at),
    split |x| split_avx512(x), rows |at| rows_avx512(at), to_rows |a, b, c, d, to| to_rows_avx512(a, b, c, d, to)
}

/// A mask of the first lanes. The mask is made by a function, because a closure longer than one call is not inlined.
///
/// # Safety
/// The processor must have AVX2.
#[inline]
#[target_feature(enable = "avx,avx2")]
unsafe fn first_avx2(count: usize) -> __m256d {
    // SAFETY: there are four indices.
    let indices = unsafe { _mm256_loadu_pd(LANE_INDICES.as_ptr()) };
    _mm256_cmp_pd::<_CMP_LT_OQ>(indices, _mm256_set1_pd(few(count)))
}

/// Mantissas from √½ to √2 and exponents of positive, normal numbers.
///
/// # Safety
/// The processor must have AVX2.
#[inline]
#[target_feature(enable = "avx,avx2")]
unsafe fn split_avx2(x: __m256d) -> (__m256d, __m256d) {
    let bits = _mm256_add_epi64(_mm256_castpd_si256(x), _mm256_set1_epi64x(SHIFT));
    let exponent = _mm256_or_si256(_mm256_srli_epi64::<52>(bits), _mm256_set1_epi64x(WHOLE));
    let fraction = _mm256_and_si256(bits, _mm256_set1_epi64x(FRACTION));
    let mantissa = _mm256_add_epi64(fraction, _mm256_set1_epi64x(ROOT_OF_HALF));
    (_mm256_castsi256_pd(mantissa), _mm256_sub_pd(_mm256_castsi256_pd(exponent), _mm256_set1_pd(BIAS)))
}

/// Does for eight numbers what `split_avx2` does for four.
///
/// # Safety
/// The processor must have AVX-512.
#[inline]
#[target_feature(enable = "avx,avx2,avx512f,avx512dq,avx512vl")]
unsafe fn split_avx512(x: __m512d) -> (__m512d, __m512d) {
    let bits = _mm512_add_epi64(_mm512_castpd_si512(x), _mm512_set1_epi64(SHIFT));
    let exponent = _mm512_or_si512(_mm512_srli_epi64::<52>(bits), _mm512_set1_epi64(WHOLE));
    let fraction = _mm512_and_si512(bits, _mm512_set1_epi64(FRACTION));
    let mantissa = _mm512_add_epi64(fraction, _mm512_set1_epi64(ROOT_OF_HALF));
    (_mm512_castsi512_pd(mantissa), _mm512_sub_pd(_mm512_castsi512_pd(exponent), _mm512_set1_pd(BIAS)))
}

/// Reads four numbers at each of four addresses. The k-th register has the k-th numbers.
///
/// # Safety
/// The processor must have AVX2, and four numbers must lie at every address.
#[inline]
#[target_feature(enable = "avx,avx2")]
unsafe fn rows_avx2(at: [*const f64; 4]) -> [__m256d; ROW] {
    // SAFETY: the caller guarantees four numbers at every address.
    let (a, b, c, d) =
        unsafe { (_mm256_loadu_pd(at[0]), _mm256_loadu_pd(at[1]), _mm256_loadu_pd(at[2]), _mm256_loadu_pd(at[3])) };
    // `even` and `more_even` have numbers 0 and 2 of two rows each, `odd` and `more_odd` numbers 1 and 3.
    let (even, odd) = (_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
    let (more_even, more_odd) = (_mm256_unpacklo_pd(c, d), _mm256_unpackhi_pd(c, d));
    [
        _mm256_permute2f128_pd::<0x20>(even, more_even),
        _mm256_permute2f128_pd::<0x20>(odd, more_odd),
        _mm256_permute2f128_pd::<0x31>(even, more_even),
        _mm256_permute2f128_pd::<0x31>(odd, more_odd),
    ]
}

/// Reads four numbers at each of eight addresses. The k-th register has the k-th numbers.
///
/// # Safety
/// The processor must have AVX-512, and four numbers must lie at every address.
#[inline]
#[target_feature(enable = "avx,avx2,avx512f,avx512dq,avx512vl")]
unsafe fn rows_avx512(at: [*const f64; 8]) -> [__m512d; ROW] {
    // SAFETY: the caller guarantees four numbers at every address.
    let (a, b, c, d) = unsafe {
        (
            _mm512_insertf64x4::<1>(_mm512_castpd256_pd512(_mm256_loadu_pd(at[0])), _mm256_loadu_pd(at[4])),
            _mm512_insertf64x4::<1>(_mm512_castpd256_pd512(_mm256_loadu_pd(at[1])), _mm256_loadu_pd(at[5])),
            _mm512_insertf64x4::<1>(_mm512_castpd256_pd512(_mm256_loadu_pd(at[2])), _mm256_loadu_pd(at[6])),
            _mm512_insertf64x4::<1>(_mm512_castpd256_pd512(_mm256_loadu_pd(at[3])), _mm256_loadu_pd(at[7])),
        )
    };
    // `even` has numbers 0 and 2 of rows 0 1 4 5, `more_even` those of rows 2 3 6 7; `odd` and `more_odd` have numbers 1 and 3 of
    // these rows.
    let (even, odd) = (_mm512_unpacklo_pd(a, b), _mm512_unpackhi_pd(a, b));
    let (more_even, more_odd) = (_mm512_unpacklo_pd(c, d), _mm512_unpackhi_pd(c, d));
    let low = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13);
    let high = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
    [
        _mm512_permutex2var_pd(even, low, more_even),
        _mm512_permutex2var_pd(odd, low, more_odd),
        _mm512_permutex2var_pd(even, high, more_even),
        _mm512_permutex2var_pd(odd, high, more_odd),
    ]
}

/// Writes four registers as four rows of four numbers.
///
/// # Safety
/// The processor must have AVX2, and there must be space for sixteen numbers.
#[inline]
#[target_feature(enable = "avx,avx2")]
unsafe fn to_rows_avx2(a: __m256d, b: __m256d, c: __m256d, d: __m256d, to: *mut f64) {
    // The first halves of rows 0 and 2, and of rows 1 and 3; then their second halves.
    let (even, odd) = (_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
    let (even_end, odd_end) = (_mm256_unpacklo_pd(c, d), _mm256_unpackhi_pd(c, d));
    // SAFETY: the caller guarantees space for sixteen numbers.
    unsafe {
        _mm256_storeu_pd(to, _mm256_permute2f128_pd::<0x20>(even, even_end));
        _mm256_storeu_pd(to.add(4), _mm256_permute2f128_pd::<0x20>(odd, odd_end));
        _mm256_storeu_pd(to.add(8), _mm256_permute2f128_pd::<0x31>(even, even_end));
        _mm256_storeu_pd(to.add(12), _mm256_permute2f128_pd::<0x31>(odd, odd_end));
    }
}

/// Writes four registers as eight rows of four numbers.
///
/// # Safety
/// The processor must have AVX-512, and there must be space for 32 numbers.
#[inline]
#[target_feature(enable = "avx,avx2,avx512f,avx512dq,avx512vl")]
unsafe fn to_rows_avx512(a: __m512d, b: __m512d, c: __m512d, d: __m512d, to: *mut f64) {
    // The first halves of rows 0 2 4 6, and of rows 1 3 5 7; then their second halves.
    let (even, odd) = (_mm512_unpacklo_pd(a, b), _mm512_unpackhi_pd(a, b));
    let (even_end, odd_end) = (_mm512_unpacklo_pd(c, d), _mm512_unpackhi_pd(c, d));
    // Joins the halves of rows: `low` takes the first two rows of a pair of registers, `high` the last two.
    let low = _mm512_setr_epi64(0, 1, 8, 9, 2, 3, 10, 11);
    let high = _mm512_setr_epi64(4, 5, 12, 13, 6, 7, 14, 15);
    let (rows_02, rows_46) =
        (_mm512_permutex2var_pd(even, low, even_end), _mm512_permutex2var_pd(even, high, even_end));
    let (rows_13, rows_57) = (_mm512_permutex2var_pd(odd, low, odd_end), _mm512_permutex2var_pd(odd, high, odd_end));
    // SAFETY: the caller guarantees space for 32 numbers.
    unsafe {
        for (k, (even, odd)) in [(rows_02, rows_13), (rows_46, rows_57)].into_iter().enumerate() {
            let to = to.add(16 * k);
            _mm256_storeu_pd(to, _mm512_castpd512_pd256(even));
            _mm256_storeu_pd(to.add(4), _mm512_castpd512_pd256(odd));
            _mm256_storeu_pd(to.add(8), _mm512_extractf64x4_pd::<1>(even));
            _mm256_storeu_pd(to.add(12), _mm512_extractf64x4_pd::<1>(odd));
        }
    }
}

/// The numbers at eight indices of a slice.
///
/// # Safety
/// The processor must have AVX-512.
#[inline]
#[target_feature(enable = "avx,avx2,avx512f,avx512dq,avx512vl")]
unsafe fn gather_avx512(from: &[f64], indices: &[u32]) -> __m512d {
    assert!(from.len() <= i32::MAX as usize && indices.len() == 8);
    // SAFETY: eight indices are given, and all of them are within the slice.
    unsafe {
        let index = _mm256_loadu_si256(indices.as_ptr().cast());
        let inside = _mm256_cmplt_epu32_mask(index, _mm256_set1_epi32(from.len() as i32));
        assert!(inside == 0xff, "gather outside of the column");
        _mm512_i32gather_pd::<8>(index, from.as_ptr())
    }
}
