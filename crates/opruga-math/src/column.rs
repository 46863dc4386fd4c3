//! A column of numbers that begins on a cache line, so that no pack of it crosses the border of a cache line.

use aligned_vec::{AVec, ConstAlign};
use core::ops::{Deref, DerefMut};

/// The size of a cache line [bytes].
const LINE: usize = 64;

/// Consecutive numbers, the first at the start of a cache line.
#[derive(Clone, PartialEq)]
pub struct Column(AVec<f64, ConstAlign<LINE>>);

impl Column {
    /// A column of `length` zeros.
    pub fn zeros(length: usize) -> Column {
        let mut numbers = AVec::with_capacity(LINE, length);
        numbers.resize(length, 0.0);
        Column(numbers)
    }
    /// Bytes on the heap.
    pub fn heap_bytes(&self) -> usize {
        self.0.capacity() * size_of::<f64>()
    }
    /// Appends zeros if there are fewer than `length` numbers.
    pub fn grow(&mut self, length: usize) {
        if self.0.len() < length {
            self.0.resize(length, 0.0);
        }
    }
}

impl Default for Column {
    fn default() -> Column {
        Column::zeros(0)
    }
}

impl From<&[f64]> for Column {
    fn from(numbers: &[f64]) -> Column {
        Column(AVec::from_slice(LINE, numbers))
    }
}

impl FromIterator<f64> for Column {
    fn from_iter<I: IntoIterator<Item = f64>>(numbers: I) -> Column {
        Column(AVec::from_iter(LINE, numbers))
    }
}

impl Deref for Column {
    type Target = [f64];
    #[inline(always)]
    fn deref(&self) -> &[f64] {
        &self.0
    }
}

impl DerefMut for Column {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [f64] {
        &mut self.0
    }
}

impl<'a> IntoIterator for &'a Column {
    type Item = &'a f64;
    type IntoIter = core::slice::Iter<'a, f64>;
    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl core::fmt::Debug for Column {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        self.0.as_slice().fmt(f)
    }
}

#[cfg(test)]
mod tests {
    use super::Column;

    #[test]
    fn columns_begin_on_a_cache_line_and_hold_what_they_were_given() {
        for length in [0, 1, 7, 8, 1000] {
            let column: Column = (0..length).map(|k| k as f64).collect();
            assert_eq!(column.as_ptr().align_offset(64), 0);
            assert_eq!(column.len(), length);
            assert!(column.iter().enumerate().all(|(k, v)| *v == k as f64));
            assert_eq!(Column::from(&*column), column.clone());
        }
        let mut zeros = Column::zeros(3);
        zeros[1] = 2.0;
        zeros.grow(5);
        zeros.grow(2);
        assert_eq!(*zeros, [0.0, 2.0, 0.0, 0.0, 0.0]);
        assert!(zeros.heap_bytes() >= 40 && zeros.as_ptr().align_offset(64) == 0);
    }
}
