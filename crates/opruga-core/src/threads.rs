//! Pieces of work on several threads. The assignment of pieces to threads does not change the bits, because every piece has its
//! own memory.
//!
//! This module is the only entry point. [`together`] wakes the threads of the pool in which the caller runs (that of the world), and they stay awake
//! until it returns. Work that is submitted to this module in the meantime is distributed to them. Work is distributed only if `threads` is more than
//! one.

use core::ops::Range;
use opruga_math::Team;
use rayon::prelude::*;
use std::cell::RefCell;
use std::sync::Arc;

thread_local! {
    /// The team that this thread leads.
    static TEAM: RefCell<Option<Arc<Team>>> = const { RefCell::new(None) };
}

/// Ends the leadership of a team when dropped, and releases its members.
struct Leading;

impl Drop for Leading {
    fn drop(&mut self) {
        if let Some(team) = TEAM.take() {
            team.close();
        }
    }
}

/// Runs `work` while `threads` threads, including the thread of the caller, are ready for its pieces.
pub fn together<R>(threads: usize, work: impl FnOnce() -> R) -> R {
    if threads < 2 || team().is_some() {
        return work();
    }
    let team = Arc::new(Team::new(threads));
    rayon::in_place_scope(|scope| {
        for number in 1..threads {
            let team = Arc::clone(&team);
            scope.spawn(move |_| {
                // A thread that leads a team may run this job while it waits. It must not serve in another team.
                if TEAM.with_borrow(Option::is_none) {
                    team.serve(number);
                }
            });
        }
        TEAM.set(Some(team));
        let _leading = Leading;
        work()
    })
}

fn team() -> Option<Arc<Team>> {
    TEAM.with_borrow(Option::clone)
}

/// The team that the caller leads, if work on this many pieces may be distributed.
fn team_for(threads: usize, pieces: usize) -> Option<Arc<Team>> {
    if threads > 1 && pieces > 1 { team() } else { None }
}

/// Does the work on every piece.
pub fn each<T: Send>(threads: usize, pieces: &mut [T], work: impl Fn(&mut T) + Sync) {
    match team_for(threads, pieces.len()) {
        Some(team) => team.each(pieces, work),
        None => pieces.iter_mut().for_each(work),
    }
}

/// Does the work on all pieces, on the threads of the pool in which the caller runs. The threads of a team stay awake between calls, whereas these
/// threads sleep. This function is meant for pieces that take tens of microseconds, between longer work on one thread.
///
/// A single piece needs no memory.
pub fn each_in_pool<T: Send>(mut pieces: impl Iterator<Item = T>, work: impl Fn(T) + Sync + Send) {
    let Some(first) = pieces.next() else { return };
    match pieces.next() {
        None => work(first),
        Some(second) => {
            let all: Vec<T> = [first, second].into_iter().chain(pieces).collect();
            all.into_par_iter().for_each(work);
        }
    }
}

/// Empties the first `count` lists, and adds lists if there are fewer; returns these lists.
pub fn empty_lists<T>(lists: &mut Vec<Vec<T>>, count: usize) -> &mut [Vec<T>] {
    lists.resize_with(lists.len().max(count), Vec::new);
    let lists = &mut lists[..count];
    lists.iter_mut().for_each(Vec::clear);
    lists
}

/// Divides a list into parts for [`each_in_pool`]. A single thread gets one part. Otherwise there are four parts for each thread, so that threads
/// that finish early take over the work of others. Only the last part may have fewer entries than `least`. An empty list has one empty part.
pub fn parts(length: usize, threads: usize, least: usize) -> impl ExactSizeIterator<Item = Range<usize>> {
    let size = part_size(length, threads, least);
    (0..length.max(1)).step_by(size).map(move |first| first..length.min(first + size))
}

/// The number of entries in each of these parts, except the last one; at least 1.
pub fn part_size(length: usize, threads: usize, least: usize) -> usize {
    let size = if threads < 2 { length } else { (length / (4 * threads)).max(least) };
    size.max(1)
}

/// Does the work on every piece like [`each`], and gives every piece its own `length` entries of a slice.
pub fn each_with<T: Send, U: Send>(
    threads: usize,
    pieces: &mut [T],
    slice: &mut [U],
    length: usize,
    work: impl Fn(&mut T, &mut [U]) + Sync,
) {
    match team_for(threads, pieces.len()) {
        Some(team) => team.each_with(pieces, slice, length, work),
        None => pieces.iter_mut().zip(slice.chunks_mut(length)).for_each(|(piece, part)| work(piece, part)),
    }
}

/// Does the work on parts of a slice that begin at the given indices, which increase from 0.
pub fn each_part<T: Send>(threads: usize, slice: &mut [T], starts: &[usize], work: impl Fn(usize, &mut [T]) + Sync) {
    match team_for(threads, starts.len()) {
        Some(team) => team.each_part(slice, starts, work),
        None => {
            for (number, start) in starts.iter().enumerate() {
                let end = starts.get(number + 1).map_or(slice.len(), |next| *next);
                work(number, &mut slice[*start..end]);
            }
        }
    }
}

/// The number of nodes in a block of vectors that one thread processes.
const BLOCK: usize = 512;

/// Does the work on blocks of vectors with several numbers per node; `work` receives the start of its block. Entries beyond the
/// end of the shortest vector are ignored.
pub fn each_block<T: Send, const N: usize>(
    threads: usize,
    numbers: usize,
    vectors: [&mut [T]; N],
    work: impl Fn(usize, [&mut [T]; N]) + Sync,
) {
    let end = vectors.iter().map(|vector| vector.len()).min().unwrap_or(0);
    match team_for(threads, end.div_ceil(BLOCK * numbers)) {
        Some(team) => team.each_block(vectors, BLOCK * numbers, work),
        None => work(0, vectors.map(|vector| &mut vector[..end])),
    }
}
