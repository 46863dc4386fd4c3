//! Prefetching of numbers before they are read.
#![allow(unsafe_code)]

use core::ops::Range;

/// The size of a cache line [bytes].
#[cfg(target_arch = "x86_64")]
const LINE: usize = 64;

/// Asks the processor to bring a part of a list into its first-level cache, for lists that are read too seldom for the processor
/// to predict the reads. The part beyond the end of the list is ignored. On processors without such an instruction nothing
/// happens.
#[inline(always)]
pub fn fetch_early<T>(list: &[T], part: Range<usize>) {
    #[cfg(target_arch = "x86_64")]
    {
        use core::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let end = part.end.min(list.len());
        for place in (part.start..end).step_by((LINE / size_of::<T>().clamp(1, LINE)).max(1)) {
            // SAFETY: every x86-64 has the instruction, the address is within the list, and nothing is read.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(list.as_ptr().add(place).cast()) };
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (list, part);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_part_of_any_list_can_be_asked_for() {
        let list = [1.0; 100];
        for part in [0..100, 7..9, 99..300, 200..300, 0..0] {
            fetch_early(&list, part);
        }
        fetch_early::<f64>(&[], 0..8);
        fetch_early(&[[0u8; 300]; 3], 0..3);
        fetch_early(&[(); 3], 0..3);
        assert_eq!(list, [1.0; 100]);
    }
}
