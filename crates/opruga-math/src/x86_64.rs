//! The wide lanes of x86-64: eight numbers in one register of AVX-512, two of AVX2 or four of SSE2.
//!
//! Their operations are the basic ones of IEEE 754, so all give the same bits.
//!
//! # Safety
//! The instructions of AVX2 and AVX-512 exist only on processors that have them. The types are private to this
//! crate and values of them are made inside `Simd::run` alone, after the processor was asked. `read` and `write` hand
//! the promise of their caller on to the load and store instructions.
#![allow(unsafe_code)]

use crate::lane::{Lane, Pack, WIDTH};
use crate::operators::operators;
use core::arch::x86_64::*;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// A function of one number, eight times.
#[inline(always)]
fn each_number(numbers: [f64; WIDTH], function: fn(f64) -> f64) -> [f64; WIDTH] {
    let mut out = numbers;
    for number in &mut out {
        *number = function(*number);
    }
    out
}

/// One register after the other; a macro, since closures are not inlined reliably.
macro_rules! registers {
    ($set:ident, $count:literal, $r:ident => $value:expr) => {{
        // SAFETY: see the head of the file.
        let mut out = [unsafe { $set(0.0) }; $count];
        for $r in 0..$count {
            out[$r] = unsafe { $value };
        }
        out
    }};
}

/// Eight numbers in `$count` registers of `$width` numbers.
macro_rules! split_registers {
    ($(#[$note:meta])* $type:ident, $register:ty, $count:literal, $width:literal, $prefix:ident,
     add $add:ident, sub $sub:ident, mul $mul:ident, div $div:ident, set $set:ident, sqrt $sqrt:ident,
     andnot $andnot:ident, and $and:ident, load $load:ident, store $store:ident,
     less $less:expr, less_or_equal $less_or_equal:expr, select $select:expr, any $any:ident, shift $shift:expr, min $min:ident, max $max:ident) => {
        $(#[$note])*
        #[derive(Clone, Copy)]
        #[repr(C, align(64))]
        pub(crate) struct $type([$register; $count]);

        // SAFETY (all blocks of this macro): see the head of the file.
        operators! { $type,
            Add add |a: $type, b: $type| $type(registers!($set, $count, r => $add(a.0[r], b.0[r])));
            Sub sub |a: $type, b: $type| $type(registers!($set, $count, r => $sub(a.0[r], b.0[r])));
            Mul mul |a: $type, b: $type| $type(registers!($set, $count, r => $mul(a.0[r], b.0[r])));
            Div div |a: $type, b: $type| $type(registers!($set, $count, r => $div(a.0[r], b.0[r])));
        }
        impl Lane for $type {
            type Mask = [$register; $count];
            #[inline(always)]
            fn splat(value: f64) -> Self { $type([unsafe { $set(value) }; $count]) }
            #[inline(always)]
            fn sqrt(self) -> Self { $type(registers!($set, $count, r => $sqrt(self.0[r]))) }
            #[inline(always)]
            fn abs(self) -> Self { $type(registers!($set, $count, r => $andnot($set(-0.0), self.0[r]))) }
            #[inline(always)]
            fn smaller(self, other: Self) -> Self { $type(registers!($set, $count, r => $min(self.0[r], other.0[r]))) }
            #[inline(always)]
            fn larger(self, other: Self) -> Self { $type(registers!($set, $count, r => $max(self.0[r], other.0[r]))) }
            #[inline(always)]
            fn less(self, other: Self) -> Self::Mask { registers!($set, $count, r => $less(self.0[r], other.0[r])) }
            #[inline(always)]
            fn less_or_equal(self, other: Self) -> Self::Mask {
                registers!($set, $count, r => $less_or_equal(self.0[r], other.0[r]))
            }
            #[inline(always)]
            fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
                $type(registers!($set, $count, r => $select(mask[r], yes.0[r], no.0[r])))
            }
            #[inline(always)]
            fn both(a: Self::Mask, b: Self::Mask) -> Self::Mask { registers!($set, $count, r => $and(a[r], b[r])) }
            #[inline(always)]
            fn any(mask: Self::Mask) -> bool {
                let mut bits = 0;
                for r in 0..$count { bits |= unsafe { $any(mask[r]) }; }
                bits != 0
            }
            #[inline(always)]
            fn ln(self) -> Self { Self::from_array(each_number(self.to_array(), <f64 as Lane>::ln)) }
            #[inline(always)]
            fn exp(self) -> Self { Self::from_array(each_number(self.to_array(), <f64 as Lane>::exp)) }
        }
        impl Pack for $type {
            #[inline(always)]
            fn load(from: &[f64]) -> Self {
                unsafe { Self::read(from[..WIDTH].as_ptr()) }
            }
            #[inline(always)]
            fn store(self, to: &mut [f64]) {
                unsafe { self.write(to[..WIDTH].as_mut_ptr()) }
            }
            #[inline(always)]
            unsafe fn read(from: *const f64) -> Self {
                $type(registers!($set, $count, r => $load(from.add($width * r))))
            }
            #[inline(always)]
            unsafe fn write(self, to: *mut f64) {
                for r in 0..$count { unsafe { $store(to.add($width * r), self.0[r]) } }
            }
            #[inline(always)]
            fn gather(from: &[f64], places: &[u32]) -> Self {
                let places = &places[..WIDTH];
                let mut out = [0.0; WIDTH];
                for l in 0..WIDTH { out[l] = from[places[l] as usize]; }
                Self::from_array(out)
            }
            #[inline(always)]
            fn to_array(self) -> [f64; WIDTH] {
                let mut out = [0.0; WIDTH];
                self.store(&mut out);
                out
            }
            #[inline(always)]
            fn from_array(numbers: [f64; WIDTH]) -> Self { Self::load(&numbers) }
            #[inline(always)]
            fn after(self, previous: Self) -> Self {
                $type(registers!($set, $count, r => {
                    let before = if r == 0 { previous.0[$count - 1] } else { self.0[r - 1] };
                    $shift(before, self.0[r])
                }))
            }
            #[inline(always)]
            fn first(count: usize) -> Self::Mask {
                const PLACES: [f64; WIDTH] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
                Self::load(&PLACES).less(Self::splat(count as f64))
            }
        }
    };
}

split_registers! {
    /// Eight numbers in four registers of SSE2, which every x86-64 has.
    Sse2, __m128d, 4, 2, _mm,
    add _mm_add_pd, sub _mm_sub_pd, mul _mm_mul_pd, div _mm_div_pd, set _mm_set1_pd, sqrt _mm_sqrt_pd,
    andnot _mm_andnot_pd, and _mm_and_pd, load _mm_loadu_pd, store _mm_storeu_pd,
    less |a, b| _mm_cmplt_pd(a, b), less_or_equal |a, b| _mm_cmple_pd(a, b),
    select |m, y, n| _mm_or_pd(_mm_and_pd(m, y), _mm_andnot_pd(m, n)), any _mm_movemask_pd,
    shift |before, r| _mm_shuffle_pd::<0b01>(before, r), min _mm_min_pd, max _mm_max_pd
}
split_registers! {
    /// Eight numbers in two registers of AVX2.
    Avx2, __m256d, 2, 4, _mm256,
    add _mm256_add_pd, sub _mm256_sub_pd, mul _mm256_mul_pd, div _mm256_div_pd, set _mm256_set1_pd, sqrt _mm256_sqrt_pd,
    andnot _mm256_andnot_pd, and _mm256_and_pd, load _mm256_loadu_pd, store _mm256_storeu_pd,
    less |a, b| _mm256_cmp_pd::<_CMP_LT_OQ>(a, b), less_or_equal |a, b| _mm256_cmp_pd::<_CMP_LE_OQ>(a, b),
    select |m, y, n| _mm256_blendv_pd(n, y, m), any _mm256_movemask_pd,
    shift |before, r| _mm256_shuffle_pd::<0b0101>(_mm256_permute2f128_pd::<0x21>(before, r), r),
    min _mm256_min_pd, max _mm256_max_pd
}

/// Eight numbers in one register of AVX-512.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub(crate) struct Avx512(__m512d);

// SAFETY (all blocks below): see the head of the file.
operators! { Avx512,
    Add add |a: Avx512, b: Avx512| Avx512(unsafe { _mm512_add_pd(a.0, b.0) });
    Sub sub |a: Avx512, b: Avx512| Avx512(unsafe { _mm512_sub_pd(a.0, b.0) });
    Mul mul |a: Avx512, b: Avx512| Avx512(unsafe { _mm512_mul_pd(a.0, b.0) });
    Div div |a: Avx512, b: Avx512| Avx512(unsafe { _mm512_div_pd(a.0, b.0) });
}
impl Lane for Avx512 {
    type Mask = __mmask8;
    #[inline(always)]
    fn splat(value: f64) -> Self {
        Avx512(unsafe { _mm512_set1_pd(value) })
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Avx512(unsafe { _mm512_sqrt_pd(self.0) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Avx512(unsafe { _mm512_abs_pd(self.0) })
    }
    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        Avx512(unsafe { _mm512_min_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        Avx512(unsafe { _mm512_max_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn less(self, other: Self) -> Self::Mask {
        unsafe { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn less_or_equal(self, other: Self) -> Self::Mask {
        unsafe { _mm512_cmp_pd_mask::<_CMP_LE_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        Avx512(unsafe { _mm512_mask_blend_pd(mask, no.0, yes.0) })
    }
    #[inline(always)]
    fn both(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        a & b
    }
    #[inline(always)]
    fn any(mask: Self::Mask) -> bool {
        mask != 0
    }
    #[inline(always)]
    fn ln(self) -> Self {
        Self::from_array(each_number(self.to_array(), <f64 as Lane>::ln))
    }
    #[inline(always)]
    fn exp(self) -> Self {
        Self::from_array(each_number(self.to_array(), <f64 as Lane>::exp))
    }
}
impl Pack for Avx512 {
    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        unsafe { Self::read(from[..WIDTH].as_ptr()) }
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        unsafe { self.write(to[..WIDTH].as_mut_ptr()) }
    }
    #[inline(always)]
    unsafe fn read(from: *const f64) -> Self {
        Avx512(unsafe { _mm512_loadu_pd(from) })
    }
    #[inline(always)]
    unsafe fn write(self, to: *mut f64) {
        unsafe { _mm512_storeu_pd(to, self.0) }
    }
    #[inline(always)]
    fn gather(from: &[f64], places: &[u32]) -> Self {
        let places = &places[..WIDTH];
        assert!(from.len() <= i32::MAX as usize);
        unsafe {
            let index = _mm256_loadu_si256(places.as_ptr().cast());
            let inside = _mm256_cmplt_epu32_mask(index, _mm256_set1_epi32(from.len() as i32));
            assert!(inside == 0xff, "gather outside of the column");
            Avx512(_mm512_i32gather_pd::<8>(index, from.as_ptr()))
        }
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
        Avx512(unsafe {
            _mm512_castsi512_pd(_mm512_alignr_epi64::<7>(_mm512_castpd_si512(self.0), _mm512_castpd_si512(previous.0)))
        })
    }
    #[inline(always)]
    fn first(count: usize) -> Self::Mask {
        if count >= WIDTH { 0xff } else { ((1u32 << count) - 1) as u8 }
    }
}
