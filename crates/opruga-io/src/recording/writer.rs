//! Writes a recording, frame by frame, into anything that takes bytes.

use super::codec;
use super::format::{self, ChunkHead, Header, Kind};
use crate::safe_write::{Counted, Target};
use std::io::{self, Write as _};

/// States from one that stands for itself to the next: as many are read, at most, to see one of them.
const GROUP: u64 = 64;

/// Writes a recording. What [`Writer::flush`] has returned from is whole in the file, whatever happens afterwards.
#[derive(Debug)]
pub struct Writer<W> {
    out: Counted<W>,
    identity: u32,
    /// What was not given to the file yet.
    pending: Vec<u8>,
    /// The bytes of the file, with those not given to it yet.
    place: u64,
    previous: Vec<u8>,
    /// From one frame whose state is kept to the next.
    every: u64,
    /// The last frame whose state was kept; none before the first.
    last: Option<u64>,
    /// The frame of the last input.
    input: u64,
    /// Frame and place of the chunks that stand for themselves.
    index: Vec<[u64; 2]>,
    /// Frame and place of the inputs.
    inputs: Vec<[u64; 2]>,
}

impl<W: Target> Writer<W> {
    /// Writes the header, and makes it last.
    ///
    /// # Errors
    /// Those of the target.
    pub fn new(target: W, header: &Header) -> io::Result<Writer<W>> {
        let (pending, identity) = format::beginning(header);
        let place = pending.len() as u64;
        let out = Counted { inner: target, bytes: 0 };
        let (previous, index, inputs) = (Vec::new(), Vec::new(), Vec::new());
        let every = header.every;
        let mut writer = Writer { out, identity, pending, place, previous, every, last: None, input: 0, index, inputs };
        writer.flush()?;
        writer.sync()?;
        Ok(writer)
    }

    /// Adds the state of a frame: the first, which may have any number, or one so far behind the last as the header says;
    /// nearer ones end the recording.
    ///
    /// # Errors
    /// A frame out of its order; it is left out. The file is not written to before [`Writer::flush`].
    pub fn push(&mut self, frame: u64, state: &[u8]) -> io::Result<()> {
        self.code(frame, state)?;
        self.previous.clear();
        self.previous.extend_from_slice(state);
        Ok(())
    }

    /// [`Writer::push`] of a state that nobody needs any more: it is exchanged for other bytes instead of copied.
    ///
    /// # Errors
    /// As [`Writer::push`]; the state stays with its owner then.
    pub fn take(&mut self, frame: u64, state: &mut Vec<u8>) -> io::Result<()> {
        self.code(frame, state)?;
        std::mem::swap(&mut self.previous, state);
        Ok(())
    }

    /// Adds something that a program did before the step to a frame, which lies behind the last state.
    ///
    /// # Errors
    /// A frame out of its order; it is left out.
    pub fn input(&mut self, frame: u64, bytes: &[u8]) -> io::Result<()> {
        self.check_order(frame)?;
        if frame < self.input {
            return Err(out_of_order(frame));
        }
        self.input = frame;
        self.inputs.push([frame, self.place]);
        let from = self.begin();
        self.pending.extend_from_slice(bytes);
        self.end(from, Kind::Input, frame, bytes.len() as u64);
        Ok(())
    }

    /// Adds the chunk of a state.
    fn code(&mut self, frame: u64, state: &[u8]) -> io::Result<()> {
        self.check_order(frame)?;
        if frame < self.input {
            return Err(out_of_order(frame));
        }
        // A state nearer to the one before than others are is the last.
        let whole_steps =
            |[first, _]: &[u64; 2]| self.last.is_some_and(|last| (last - first).is_multiple_of(self.every));
        if !self.index.first().is_none_or(whole_steps) {
            return Err(out_of_order(frame));
        }
        let begun = self.index.last().is_some_and(|[first, _]| (frame - first) / self.every < GROUP);
        let kind = if begun && self.previous.len() == state.len() { Kind::Difference } else { Kind::Whole };
        if kind == Kind::Whole {
            self.index.push([frame, self.place]);
            self.previous.clear();
        }
        let from = self.begin();
        codec::encode(state, &self.previous, &mut self.pending);
        self.end(from, kind, frame, state.len() as u64);
        self.last = Some(frame);
        Ok(())
    }

    /// Refuses a frame that does not lie among those behind the last state, up to the next one.
    fn check_order(&self, frame: u64) -> io::Result<()> {
        let follows = self.last.is_none_or(|last| frame > last && frame - last <= self.every);
        if follows && frame < u64::MAX { Ok(()) } else { Err(out_of_order(frame)) }
    }

    /// Leaves room for the head of a chunk, whose payload follows; returns where it begins.
    fn begin(&mut self) -> usize {
        let from = self.pending.len();
        self.pending.resize(from + format::CHUNK, 0);
        from
    }

    /// Writes the head of a chunk, once its payload is there.
    fn end(&mut self, from: usize, kind: Kind, frame: u64, state: u64) {
        let (head, payload) = self.pending[from..].split_at_mut(format::CHUNK);
        let payload_sum = crc32fast::hash(payload);
        let chunk = ChunkHead { kind, frame, state, payload: payload.len() as u64, payload_sum };
        head.copy_from_slice(&chunk.to_bytes(self.identity));
        self.place += (self.pending.len() - from) as u64;
    }

    /// Gives all frames so far to the system: from then on they outlive the process.
    ///
    /// # Errors
    /// Those of the target; [`Writer::bytes`] tells how many bytes it has taken.
    pub fn flush(&mut self) -> io::Result<()> {
        self.out.write_all(&self.pending)?;
        self.pending.clear();
        self.out.flush()
    }

    /// Makes what was flushed outlive a loss of power.
    ///
    /// # Errors
    /// Those of the target.
    pub fn sync(&self) -> io::Result<()> {
        self.out.inner.sync()
    }

    /// Bytes that the target has taken.
    pub fn bytes(&self) -> u64 {
        self.out.bytes
    }

    /// Writes what is left, the index and the end, and makes all of it last.
    ///
    /// # Errors
    /// Those of the target.
    pub fn finish(&mut self) -> io::Result<()> {
        let place = self.place;
        let from = self.begin();
        let numbers = self.index.iter().chain(&self.inputs).flatten();
        self.pending.extend((self.index.len() as u64).to_le_bytes());
        self.pending.extend(numbers.flat_map(|n| n.to_le_bytes()));
        let bytes = self.pending.len() - from - format::CHUNK;
        self.end(from, Kind::Index, self.last.map_or(0, |last| last + 1), bytes as u64);
        self.pending.extend(format::trailer(place, self.identity));
        self.flush()?;
        self.sync()
    }
}

fn out_of_order(frame: u64) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, format!("frame {frame} is out of order"))
}
