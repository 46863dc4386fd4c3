//! The rule for which frames may follow one another, used both for writing and for reading recordings.

use core::ops::Range;

/// The frames of a recording so far, and which of their states are kept.
#[derive(Clone, Copy, Debug)]
pub(super) struct Order {
    /// The number of frames from one kept state to the next.
    every: u64,
    /// None before the first frame.
    span: Option<Span>,
}

#[derive(Clone, Copy, Debug)]
struct Span {
    first: u64,
    last: u64,
    /// The last frame whose state is kept.
    kept: u64,
}

impl Order {
    pub(super) fn new(every: u64) -> Order {
        Order { every, span: None }
    }

    /// The order of a recording that has ended, from its first and last frame and the last frame whose state is kept. None if the given values are
    /// inconsistent.
    pub(super) fn ended(every: u64, first: u64, last: u64, kept: u64) -> Option<Order> {
        let order = Order { every, span: Some(Span { first, last, kept }) };
        let apart = last.checked_sub(kept).is_some_and(|apart| apart < every) && kept >= first;
        (apart && (order.due(kept) || kept == last) && last < u64::MAX).then_some(order)
    }

    /// The range from the first frame to the last.
    pub(super) fn frames(&self) -> Range<u64> {
        self.span.map_or(0..0, |span| span.first..span.last + 1)
    }

    /// The last frame whose state is kept.
    pub(super) fn last_kept(&self) -> Option<u64> {
        self.span.map(|span| span.kept)
    }

    /// Whether the state of a frame must be kept, whatever follows it.
    fn due(&self, frame: u64) -> bool {
        self.span.is_none_or(|span| (frame - span.first).is_multiple_of(self.every))
    }

    /// Whether this frame may be the next one. No frame follows a state that was kept before it was due: such a state ends the recording.
    pub(super) fn follows(&self, frame: u64) -> bool {
        self.span.is_some_and(|span| frame == span.last + 1 && self.due(span.kept)) && frame < u64::MAX
    }

    /// Adds a frame whose state is not kept, if such a frame may follow; returns whether it was added.
    pub(super) fn pass(&mut self, frame: u64) -> bool {
        let may = self.follows(frame) && !self.due(frame);
        if let Some(span) = self.span.as_mut().filter(|_| may) {
            span.last = frame;
        }
        may
    }

    /// Adds either all frames of a chunk without states or none of them; the payload of the chunk contains the hashes of all but its first frame.
    pub(super) fn pass_all(&mut self, frame: u64, payload: u64) -> bool {
        let before = *self;
        let others = payload / 8;
        let all = payload.is_multiple_of(8)
            && frame.checked_add(others).is_some_and(|last| (frame..=last).all(|frame| self.pass(frame)));
        if !all {
            *self = before;
        }
        all
    }

    /// Adds a frame with its state, or the state of the last frame, which ends the recording; returns whether it was added.
    pub(super) fn keep(&mut self, frame: u64) -> bool {
        let begins = self.span.is_none() && frame < u64::MAX;
        let ends = self.span.is_some_and(|span| frame == span.last && frame > span.kept);
        let may = begins || ends || self.follows(frame);
        if may {
            let first = self.span.map_or(frame, |span| span.first);
            self.span = Some(Span { first, last: frame, kept: frame });
        }
        may
    }

    /// The last frame, up to this one, whose state is kept.
    pub(super) fn kept(&self, frame: u64) -> Option<u64> {
        let span = self.span.filter(|span| (span.first..=span.last).contains(&frame))?;
        Some(if frame >= span.kept { span.kept } else { span.first + (frame - span.first) / self.every * self.every })
    }

    /// The next frame whose state is kept, after a given frame whose state is kept.
    pub(super) fn next_kept(&self, frame: u64) -> u64 {
        let last = self.span.map_or(0, |span| span.kept);
        if last.saturating_sub(frame) < self.every { last } else { frame + self.every }
    }
}
