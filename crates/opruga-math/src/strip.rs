//! Pieces of columns that a loop processes eight numbers at a time.
//!
//! A strip checks once that all of its columns are long enough. After that, each step of the loop needs only one comparison,
//! however many columns it reads or writes.
//!
//! # Safety
//! The pointers come from slices that the strip borrows and that were long enough when it was made. Every access asserts that it
//! stays below the common length.
#![allow(unsafe_code)]

use crate::lane::{Pack, Register, WIDTH};
use core::marker::PhantomData;

/// The same range of each of `N` columns, for reading.
#[derive(Clone, Copy, Debug)]
pub struct Strip<'a, const N: usize> {
    start: [*const f64; N],
    length: usize,
    borrow: PhantomData<&'a f64>,
}

/// The same range of each of `N` columns, for reading and writing.
#[derive(Debug)]
pub struct StripMut<'a, const N: usize> {
    start: [*mut f64; N],
    length: usize,
    borrow: PhantomData<&'a mut f64>,
}

impl<'a, const N: usize> Strip<'a, N> {
    /// `length` numbers of each column, from index `start` on.
    #[inline(always)]
    pub fn new(columns: &[&'a [f64]; N], start: usize, length: usize) -> Self {
        let mut pointers = [core::ptr::null(); N];
        for n in 0..N {
            pointers[n] = columns[n][start..start + length].as_ptr();
        }
        Strip { start: pointers, length, borrow: PhantomData }
    }
    /// Eight numbers of a column from index `k` on.
    #[inline(always)]
    pub fn load<P: Pack>(&self, column: usize, k: usize) -> P {
        assert!(k + WIDTH <= self.length);
        // SAFETY: see the head of the file.
        unsafe { P::read(self.start[column].add(k)) }
    }
    /// One part of the eight numbers of a column from index `k` on.
    #[inline(always)]
    pub fn load_part<P: Pack>(&self, column: usize, k: usize, part: usize) -> P::Part {
        assert!(k + WIDTH <= self.length && part < P::PARTS);
        // SAFETY: see the head of the file.
        unsafe { P::Part::read(self.start[column].add(k + part * P::Part::NUMBERS)) }
    }
}

impl<'a, const N: usize> StripMut<'a, N> {
    /// `length` numbers of each column, from index `start` on.
    #[inline(always)]
    pub fn new(columns: [&'a mut [f64]; N], start: usize, length: usize) -> Self {
        let mut pointers = [core::ptr::null_mut(); N];
        for (pointer, column) in pointers.iter_mut().zip(columns) {
            *pointer = column[start..start + length].as_mut_ptr();
        }
        StripMut { start: pointers, length, borrow: PhantomData }
    }
    /// Eight numbers of a column from index `k` on.
    #[inline(always)]
    pub fn load<P: Pack>(&self, column: usize, k: usize) -> P {
        assert!(k + WIDTH <= self.length);
        // SAFETY: see the head of the file.
        unsafe { P::read(self.start[column].add(k)) }
    }
    /// One part of the eight numbers of a column from index `k` on.
    #[inline(always)]
    pub fn load_part<P: Pack>(&self, column: usize, k: usize, part: usize) -> P::Part {
        assert!(k + WIDTH <= self.length && part < P::PARTS);
        // SAFETY: see the head of the file.
        unsafe { P::Part::read(self.start[column].add(k + part * P::Part::NUMBERS)) }
    }
    /// Writes one part of the eight numbers of a column from index `k` on.
    #[inline(always)]
    pub fn store_part<P: Pack>(&mut self, column: usize, k: usize, part: usize, value: P::Part) {
        assert!(k + WIDTH <= self.length && part < P::PARTS);
        // SAFETY: see the head of the file.
        unsafe { value.write(self.start[column].add(k + part * P::Part::NUMBERS)) }
    }
    /// Writes eight numbers of a column from index `k` on.
    #[inline(always)]
    pub fn store<P: Pack>(&mut self, column: usize, k: usize, value: P) {
        assert!(k + WIDTH <= self.length);
        // SAFETY: see the head of the file.
        unsafe { value.write(self.start[column].add(k)) }
    }
}

/// A piece of a column, or eight numbers that repeat along the whole of it.
#[derive(Clone, Copy, Debug)]
pub struct RepeatStrip<'a> {
    start: *const f64,
    step: usize,
    length: usize,
    borrow: PhantomData<&'a f64>,
}

impl<'a> RepeatStrip<'a> {
    /// The numbers of a column from `start` on.
    #[inline(always)]
    pub fn new(column: &'a [f64], start: usize, length: usize) -> Self {
        RepeatStrip { start: column[start..start + length].as_ptr(), step: 1, length, borrow: PhantomData }
    }
    /// Eight numbers that repeat along the whole column.
    #[inline(always)]
    pub fn repeated(numbers: &'a [f64; WIDTH], length: usize) -> Self {
        RepeatStrip { start: numbers.as_ptr(), step: 0, length, borrow: PhantomData }
    }
    /// Eight numbers from index `k` on.
    #[inline(always)]
    pub fn load<P: Pack>(&self, k: usize) -> P {
        assert!(k + WIDTH <= self.length);
        // SAFETY: see the head of the file; with step zero the first eight numbers are read.
        unsafe { P::read(self.start.add(k * self.step)) }
    }
    /// One part of the eight numbers from index `k` on.
    #[inline(always)]
    pub fn load_part<P: Pack>(&self, k: usize, part: usize) -> P::Part {
        assert!(k + WIDTH <= self.length && part < P::PARTS);
        // SAFETY: see the head of the file; with step zero the first eight numbers are read.
        unsafe { P::Part::read(self.start.add(k * self.step + part * P::Part::NUMBERS)) }
    }
}
