//! Which frames may follow which: one rule for those who write recordings and those who read them.

use core::ops::Range;

/// The frames of a recording so far, and the states among them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Order {
    /// From one frame whose state is kept to the next.
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

    /// Of a recording that has ended: the frames, and the last whose state is kept. None where that cannot be.
    pub(super) fn ended(every: u64, first: u64, last: u64, kept: u64) -> Option<Order> {
        let order = Order { every, span: Some(Span { first, last, kept }) };
        let apart = last.checked_sub(kept).is_some_and(|apart| apart < every) && kept >= first;
        (apart && (order.due(kept) || kept == last) && last < u64::MAX).then_some(order)
    }

    /// The first frame, and one past the last.
    pub(super) fn frames(&self) -> Range<u64> {
        self.span.map_or(0..0, |span| span.first..span.last + 1)
    }

    /// The last frame whose state is kept.
    pub(super) fn last_kept(&self) -> Option<u64> {
        self.span.map(|span| span.kept)
    }

    /// Whether the state of a frame has to be kept, whatever comes behind it.
    fn due(&self, frame: u64) -> bool {
        self.span.is_none_or(|span| (frame - span.first).is_multiple_of(self.every))
    }

    /// Whether this is the frame that comes next; an earlier state than is due has ended the recording.
    pub(super) fn follows(&self, frame: u64) -> bool {
        self.span.is_some_and(|span| frame == span.last + 1 && self.due(span.kept)) && frame < u64::MAX
    }

    /// Takes a frame whose state is not kept; says whether it may come now.
    pub(super) fn pass(&mut self, frame: u64) -> bool {
        let may = self.follows(frame) && !self.due(frame);
        if let Some(span) = self.span.as_mut().filter(|_| may) {
            span.last = frame;
        }
        may
    }

    /// Takes the frames of a chunk with the hashes of the others in its payload: all of them or none.
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

    /// Takes a frame with its state, or the state of the last frame, which ends the recording; says whether it may come now.
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

    /// The last frame up to this one whose state is kept.
    pub(super) fn kept(&self, frame: u64) -> Option<u64> {
        let span = self.span.filter(|span| (span.first..=span.last).contains(&frame))?;
        Some(if frame >= span.kept { span.kept } else { span.first + (frame - span.first) / self.every * self.every })
    }

    /// The frame of the next state behind one that is kept.
    pub(super) fn next_kept(&self, frame: u64) -> u64 {
        let last = self.span.map_or(0, |span| span.kept);
        if last.saturating_sub(frame) < self.every { last } else { frame + self.every }
    }
}
