//! One number as a register, for targets other than x86-64 and as a reference in tests.
//!
//! # Safety
//! `read` and `write` rely on the guarantees of their caller.
#![allow(unsafe_code)]

use crate::lane::{ROW, Register};

impl Register for f64 {
    const NUMBERS: usize = 1;
    #[inline(always)]
    unsafe fn read(from: *const f64) -> f64 {
        // SAFETY: the caller guarantees a number.
        unsafe { from.read() }
    }
    #[inline(always)]
    unsafe fn write(self, to: *mut f64) {
        // SAFETY: the caller guarantees space for a number.
        unsafe { to.write(self) }
    }
    #[inline(always)]
    fn load_single(from: &[f32]) -> f64 {
        f64::from(from[0])
    }
    #[inline(always)]
    fn gather(from: &[f64], indices: &[u32]) -> f64 {
        from[indices[0] as usize]
    }
    #[inline(always)]
    fn gather_rows(from: &[f64], rows: &[u32]) -> [f64; ROW] {
        let row = &from[ROW * rows[0] as usize..][..ROW];
        [row[0], row[1], row[2], row[3]]
    }
    #[inline(always)]
    fn store_rows(columns: [f64; ROW], to: &mut [f64]) {
        to[..ROW].copy_from_slice(&columns);
    }
    #[inline(always)]
    fn after(self, before: f64) -> f64 {
        before
    }
    #[inline(always)]
    fn first(count: usize) -> bool {
        count > 0
    }
}
