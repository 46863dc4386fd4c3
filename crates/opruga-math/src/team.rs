//! Threads that work on pieces in parallel and stay awake while they wait for more. Distributing pieces costs less than a
//! microsecond, but waking a sleeping thread takes fifty microseconds.
//!
//! The thread that distributes pieces, the *leader*, works too. The leader waits for pieces that a member has taken, but never
//! for members to arrive. If a member is late or never arrives, the others do more of the work.
//!
//! Each piece is assigned to a member, and others take it only if that member is late. The same processor therefore uses the
//! same memory again.

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};

/// How often a waiting thread checks before it yields. These checks take about twenty microseconds.
const LOOKS: u32 = 2_000;

/// The largest number of pieces that are distributed one by one. If there are more, several are distributed at a time.
const MOST_PIECES: usize = u16::MAX as usize;

/// The work on the piece with this number.
type Work<'a> = dyn Fn(usize) + Sync + 'a;

/// Threads that work on pieces in parallel.
#[derive(Debug)]
pub struct Team {
    members: Box<[Member]>,
    /// The work, which is valid while a piece is taken and not done.
    work: Task,
    done: Apart<AtomicUsize>,
    /// Whether the leader is already distributing pieces. If a piece itself distributes work, it does all of that work alone.
    busy: AtomicBool,
    failed: AtomicBool,
    closed: AtomicBool,
}

/// The remaining pieces of a member: the first in the lower sixteen bits, the end in the next.
type Member = Apart<AtomicU64>;

/// A value that has cache lines of its own.
#[derive(Debug, Default)]
#[repr(align(128))]
struct Apart<T>(T);

struct Task(UnsafeCell<Option<*const Work<'static>>>);

impl core::fmt::Debug for Task {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("Task")
    }
}

// SAFETY: only the leader writes the task, while no piece is taken; others read it while they have a piece. The orderings of the
// atomics in `take` and `hand_out` ensure that a piece is taken after the write and completed before the next write.
#[allow(unsafe_code)]
unsafe impl Sync for Task {}
// SAFETY: the work that the task refers to can be called from every thread.
#[allow(unsafe_code)]
unsafe impl Send for Task {}

/// The start of a slice whose parts are given to several threads.
struct Start<T>(*mut T);

// SAFETY: every part is given to only one thread, and its content may be sent to another thread.
#[allow(unsafe_code)]
unsafe impl<T: Send> Sync for Start<T> {}

impl<T> Start<T> {
    /// A part of the slice.
    ///
    /// # Safety
    /// The part must be within the slice, and no one else may have any of it.
    #[allow(unsafe_code, clippy::mut_from_ref)]
    unsafe fn part(&self, first: usize, length: usize) -> &mut [T] {
        // SAFETY: guaranteed by the caller.
        unsafe { core::slice::from_raw_parts_mut(self.0.add(first), length) }
    }
}

impl Team {
    /// A team with this many members, including the leader.
    pub fn new(members: usize) -> Team {
        Team {
            members: (0..members.max(1)).map(|_| Member::default()).collect(),
            work: Task(UnsafeCell::new(None)),
            done: Apart::default(),
            busy: AtomicBool::new(false),
            failed: AtomicBool::new(false),
            closed: AtomicBool::new(false),
        }
    }
    /// The number of members.
    pub fn members(&self) -> usize {
        self.members.len()
    }

    /// Works as the member with this number (the leader is 0) until the team is closed.
    pub fn serve(&self, own: usize) {
        let mut looks = 0;
        while !self.closed.load(Ordering::Acquire) {
            looks =
                if is_left(self.members[own].0.load(Ordering::Relaxed)) && self.help(own) > 0 { 0 } else { looks + 1 };
            pause(looks);
        }
    }
    /// Releases the members.
    pub fn close(&self) {
        self.closed.store(true, Ordering::Release);
    }

    /// Does the work on every piece.
    pub fn each<T: Send>(&self, pieces: &mut [T], work: impl Fn(&mut T) + Sync) {
        let start = Start(pieces.as_mut_ptr());
        self.hand_out(pieces.len(), &|number| {
            // SAFETY: every number below the length occurs once.
            #[allow(unsafe_code)]
            let piece = unsafe { start.part(number, 1) };
            work(&mut piece[0]);
        });
    }

    /// Does the work on every piece, each with its own part of a slice. A part has `length` entries; the last part may have
    /// fewer.
    pub fn each_with<T: Send, U: Send>(
        &self,
        pieces: &mut [T],
        slice: &mut [U],
        length: usize,
        work: impl Fn(&mut T, &mut [U]) + Sync,
    ) {
        let (start, parts, end) = (Start(pieces.as_mut_ptr()), Start(slice.as_mut_ptr()), slice.len());
        self.hand_out(pieces.len().min(end.div_ceil(length)), &|number| {
            // SAFETY: every number below the length occurs once, and its part begins before the end of the slice.
            #[allow(unsafe_code)]
            let (piece, part) = unsafe {
                let first = number * length;
                (start.part(number, 1), parts.part(first, length.min(end - first)))
            };
            work(&mut piece[0], part);
        });
    }

    /// Does the work on blocks of some slices. A block has `length` entries of each slice, from the same index on; the last
    /// block may have fewer. Entries beyond the end of the shortest slice are ignored. The work receives the start of its block.
    pub fn each_block<T: Send, const N: usize>(
        &self,
        slices: [&mut [T]; N],
        length: usize,
        work: impl Fn(usize, [&mut [T]; N]) + Sync,
    ) {
        let end = slices.iter().map(|slice| slice.len()).min().unwrap_or(0);
        let starts = slices.map(|slice| Start(slice.as_mut_ptr()));
        self.hand_out(end.div_ceil(length), &|number| {
            let first = number * length;
            // SAFETY: every number occurs once, and its block begins before the end of every slice.
            #[allow(unsafe_code)]
            let blocks = starts.each_ref().map(|start| unsafe { start.part(first, length.min(end - first)) });
            work(first, blocks);
        });
    }

    /// Does the work on parts of a slice that begin at the given indices. The first index is 0.
    ///
    /// # Panics
    /// Panics if an index is smaller than the previous one or beyond the end.
    pub fn each_part<T: Send>(&self, slice: &mut [T], starts: &[usize], work: impl Fn(usize, &mut [T]) + Sync) {
        let (parts, end) = (Start(slice.as_mut_ptr()), slice.len());
        assert!(starts.is_sorted() && starts.last().is_none_or(|last| *last <= end), "parts follow one another");
        self.hand_out(starts.len(), &|number| {
            let first = starts[number];
            let length = starts.get(number + 1).copied().unwrap_or(end) - first;
            // SAFETY: starts increase up to the end of the slice at most, and every number occurs once.
            #[allow(unsafe_code)]
            let part = unsafe { parts.part(first, length) };
            work(number, part);
        });
    }

    /// Calls the work once for every number below `count`, in no particular order.
    ///
    /// # Panics
    /// If the work panics.
    pub fn hand_out(&self, count: usize, work: &Work<'_>) {
        if count < 2 || self.members() < 2 || self.busy.swap(true, Ordering::Acquire) {
            return (0..count).for_each(work);
        }
        let together = count.div_ceil(MOST_PIECES);
        let some = |number: usize| (number * together..count.min((number + 1) * together)).for_each(work);
        let some: &Work<'_> = if together == 1 { work } else { &some };
        let pieces = count.div_ceil(together);
        self.done.0.store(0, Ordering::Relaxed);
        // SAFETY: no thread has a piece, so none reads it. The work is not called after this function has returned, because
        // every piece is done by then.
        #[allow(unsafe_code)]
        unsafe {
            *self.work.0.get() = Some(core::mem::transmute::<*const Work<'_>, *const Work<'static>>(some));
        }
        for (number, member) in self.members.iter().enumerate() {
            let at = |number: usize| (number * pieces / self.members()) as u64;
            member.0.store(at(number) | at(number + 1) << 16, Ordering::Release);
        }
        self.help(0);
        let mut looks = 0;
        while self.done.0.load(Ordering::Acquire) < pieces {
            looks += 1;
            pause(looks);
        }
        self.busy.store(false, Ordering::Release);
        assert!(!self.failed.swap(false, Ordering::Relaxed), "a thread of the team has panicked");
    }

    /// Does the remaining pieces of this member, then those of the others. Returns the number of pieces done.
    fn help(&self, own: usize) -> usize {
        let mut did = 0;
        for k in 0..self.members() {
            while let Some(piece) = self.take((own + k) % self.members()) {
                // SAFETY: a piece was taken, so the work exists until that piece counts as done.
                #[allow(unsafe_code)]
                let work = unsafe { (*self.work.0.get()).map(|work| &*work) };
                // If a panic ended this thread, a thread that waits for this piece would wait for ever.
                let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| work.map(|work| work(piece))));
                if outcome.is_err() {
                    self.failed.store(true, Ordering::Relaxed);
                }
                did += 1;
            }
        }
        if did > 0 {
            self.done.0.fetch_add(did, Ordering::Release);
        }
        did
    }

    /// Takes the next piece of a member.
    fn take(&self, member: usize) -> Option<usize> {
        let left = &self.members[member].0;
        let take = |now| is_left(now).then_some(now + 1);
        left.fetch_update(Ordering::AcqRel, Ordering::Acquire, take).ok().map(|now| (now & 0xffff) as usize)
    }
}

/// Whether a member has remaining pieces.
fn is_left(pieces: u64) -> bool {
    pieces & 0xffff < pieces >> 16
}

/// Waits a moment: at first in a busy loop, later by yielding to other threads.
fn pause(looks: u32) {
    match looks {
        0 => {}
        1..LOOKS => core::hint::spin_loop(),
        _ => std::thread::yield_now(),
    }
}

#[cfg(test)]
mod tests {
    use super::Team;

    /// Runs the work with a team of this many threads.
    fn with(members: usize, work: impl FnOnce(&Team)) {
        let team = Team::new(members);
        std::thread::scope(|scope| {
            for own in 1..members {
                let team = &team;
                scope.spawn(move || team.serve(own));
            }
            let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| work(&team)));
            team.close();
            outcome.unwrap_or_else(|reason| std::panic::resume_unwind(reason));
        });
    }

    #[test]
    fn every_piece_is_done_once_however_many_there_are() {
        for members in [1, 2, 3, 8] {
            with(members, |team| {
                for count in [0, 1, 2, 3, 7, 100, 1000, 70_000] {
                    let mut pieces = vec![0_u32; count];
                    for round in 1..=20 {
                        team.each(&mut pieces, |piece| *piece += 1);
                        assert!(pieces.iter().all(|piece| *piece == round), "{count} pieces on {members} threads");
                    }
                }
            });
        }
    }

    #[test]
    fn parts_of_slices_go_with_their_pieces() {
        with(3, |team| {
            let (mut pieces, mut slice) = ([10, 20, 30], vec![0; 11]);
            team.each_with(&mut pieces, &mut slice, 4, |piece, part| part.fill(*piece));
            assert_eq!(slice, [10, 10, 10, 10, 20, 20, 20, 20, 30, 30, 30]);
            let (mut one, mut other) = (vec![0; 10], vec![0; 12]);
            team.each_block([&mut one, &mut other], 4, |first, [one, other]| {
                one.fill(first);
                other.copy_from_slice(one);
            });
            assert_eq!(one, [0, 0, 0, 0, 4, 4, 4, 4, 8, 8]);
            assert_eq!(other, [0, 0, 0, 0, 4, 4, 4, 4, 8, 8, 0, 0]);
            team.each_part(&mut slice, &[0, 1, 1, 8], |number, part| part.fill(number));
            assert_eq!(slice, [0, 2, 2, 2, 2, 2, 2, 2, 3, 3, 3]);
        });
    }

    #[test]
    fn nobody_is_waited_for_who_never_comes() {
        let (team, mut pieces) = (Team::new(4), vec![0; 100]);
        team.each(&mut pieces, |piece| *piece = 1);
        assert_eq!(pieces, vec![1; 100]);
    }

    #[test]
    fn pieces_may_hand_out_themselves() {
        with(2, |team| {
            let mut rows = vec![vec![0; 5]; 8];
            team.each(&mut rows, |row| team.each(row, |entry| *entry += 1));
            assert_eq!(rows, vec![vec![1; 5]; 8]);
        });
    }

    #[test]
    fn a_panic_reaches_the_leader_and_the_team_goes_on() {
        with(2, |team| {
            let mut pieces = vec![0; 64];
            let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
                team.hand_out(64, &|number| assert_ne!(number, 40, "as intended"));
            }));
            assert!(outcome.is_err());
            team.each(&mut pieces, |piece| *piece = 1);
            assert_eq!(pieces, vec![1; 64]);
        });
    }

    #[test]
    #[should_panic(expected = "parts follow one another")]
    fn parts_that_would_overlap_are_refused() {
        Team::new(2).each_part(&mut [0; 4], &[0, 3, 2], |_, _| {});
    }
}
