//! Pieces of work on several threads. Which piece is done by which thread changes no bits: every piece has its own room.
//!
//! There is one door for all of it. Callers run in a pool (the world's); `threads` says how many of it they may use.

use rayon::prelude::*;

/// Does the work on every piece; where `threads` is more than one, on the pool of threads that the caller runs in.
pub fn each<T: Send>(threads: usize, pieces: &mut [T], work: impl Fn(&mut T) + Sync + Send) {
    if threads > 1 && pieces.len() > 1 {
        pieces.par_iter_mut().for_each(work);
    } else {
        pieces.iter_mut().for_each(work);
    }
}

/// The same with the part of a column that belongs to a piece: `length` numbers each.
pub fn each_with<T: Send>(
    threads: usize,
    pieces: &mut [T],
    column: &mut [f64],
    length: usize,
    work: impl Fn(&mut T, &mut [f64]) + Sync + Send,
) {
    if threads > 1 && pieces.len() > 1 {
        pieces.par_iter_mut().zip(column.par_chunks_mut(length)).for_each(|(piece, part)| work(piece, part));
    } else {
        pieces.iter_mut().zip(column.chunks_mut(length)).for_each(|(piece, part)| work(piece, part));
    }
}

/// Does the work on every item with its part of a column, whose lengths differ from item to item; asks for no memory.
///
/// # Errors
/// Of the errors of the items that were looked at, the first in their order.
pub fn each_in_column<T: Sync, E: Send>(
    threads: usize,
    items: &[T],
    column: &mut [f64],
    length: &(impl Fn(&T) -> usize + Sync),
    work: &(impl Fn(&T, &mut [f64]) -> Result<(), E> + Sync),
) -> Result<(), E> {
    match items {
        [] => Ok(()),
        [item] => work(item, &mut column[..length(item)]),
        _ => {
            // Halves of halves: a thread that has nothing to do takes one over.
            let (first, second) = items.split_at(items.len() / 2);
            let (own, other) = column.split_at_mut(first.iter().map(length).sum());
            if threads > 1 {
                let (a, b) = rayon::join(
                    || each_in_column(threads, first, own, length, work),
                    || each_in_column(threads, second, other, length, work),
                );
                a.and(b)
            } else {
                each_in_column(threads, first, own, length, work)?;
                each_in_column(threads, second, other, length, work)
            }
        }
    }
}

/// Does the work on parts of a slice that begin at the given places, on several threads; gives what each part came to.
pub fn each_part<T: Send, R: Send>(
    slice: &mut [T],
    starts: &[usize],
    work: impl Fn(usize, &mut [T]) -> R + Sync + Send,
) -> Vec<R> {
    let mut parts = Vec::with_capacity(starts.len());
    let (mut rest, mut at) = (slice, 0);
    for (number, start) in starts.iter().enumerate() {
        let until = starts.get(number + 1).map_or(rest.len(), |next| next - at);
        debug_assert_eq!(*start, at, "parts follow one another from the start on");
        let (part, behind) = rest.split_at_mut(until);
        parts.push((number, part));
        (rest, at) = (behind, at + until);
    }
    parts.into_par_iter().map(|(number, part)| work(number, part)).collect()
}
