//! Pieces of work on several threads. Which piece is done by which thread changes no bits: every piece has its own room.
//!
//! There is one door for all of it. [`together`] calls the threads of the pool that the caller runs in (the world's), and
//! they stay awake as long as it lasts; what goes through this door meanwhile is handed to them. `threads` says whether
//! work may be.

use opruga_math::Team;
use std::cell::RefCell;
use std::sync::Arc;

thread_local! {
    /// The team that this thread leads.
    static TEAM: RefCell<Option<Arc<Team>>> = const { RefCell::new(None) };
}

/// Whoever leads a team leads it no longer, and its members go home.
struct Leading;

impl Drop for Leading {
    fn drop(&mut self) {
        if let Some(team) = TEAM.take() {
            team.close();
        }
    }
}

/// Does something while so many threads are at hand for its pieces, the caller's among them.
pub fn together<R>(threads: usize, work: impl FnOnce() -> R) -> R {
    if threads < 2 || team().is_some() {
        return work();
    }
    let team = Arc::new(Team::new(threads));
    rayon::in_place_scope(|scope| {
        for number in 1..threads {
            let team = Arc::clone(&team);
            scope.spawn(move |_| {
                // A leader that waits for the end of all this may find this here still to be done.
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

/// The team that the caller leads, where work on so many pieces may be handed out.
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

/// The same with the part of a slice that belongs to a piece: `length` entries each.
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

/// Does the work on parts of a slice that begin at the given indices, which rise from 0 on.
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

/// Nodes in a block of vectors that are worked on by one thread.
const BLOCK: usize = 512;

/// Does the work on blocks of some vectors with so many numbers a node; it is told where its block begins. All end with the
/// shortest.
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
