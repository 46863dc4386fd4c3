//! Pieces of work on several threads. Which piece is done by which thread changes no bits: every piece has its own room.

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
