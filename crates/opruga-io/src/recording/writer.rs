//! Writes a recording frame by frame to anything that takes bytes.

use super::codec;
use super::format::{self, ChunkHead, Header, Kind};
use super::order::Order;
use crate::safe_write::{Counted, Target};
use std::io::{self, Write as _};

/// The number of states from one complete state to the next, and thus the largest number of states that must be read to obtain one.
const GROUP: u64 = 64;

/// Writes a recording. Everything written before a successful [`Writer::flush`] is intact in the file, whatever happens afterwards.
#[derive(Debug)]
pub struct Writer<W> {
    out: Counted<W>,
    identity: u32,
    /// Bytes that have not been given to the file yet.
    pending: Vec<u8>,
    /// The chunk of frames without states to which more frames may be added: where it begins in `pending`, its first frame and the hash of that
    /// frame.
    passed: Option<(usize, u64, u64)>,
    /// The size of the file [bytes], including bytes that have not been written to it yet.
    offset: u64,
    /// The last state that was kept.
    previous: Vec<u8>,
    order: Order,
    /// The number of states from the last complete state on, including that state.
    group: u64,
    /// Frame and offset of each chunk with a complete state.
    index: Vec<[u64; 2]>,
    /// Frame and offset of the inputs.
    inputs: Vec<[u64; 2]>,
}

impl<W: Target> Writer<W> {
    /// Writes the header.
    ///
    /// # Errors
    /// The errors of the target.
    pub fn new(target: W, header: &Header) -> io::Result<Writer<W>> {
        let (pending, identity) = format::beginning(header);
        let mut writer = Writer {
            out: Counted { inner: target, bytes: 0 },
            identity,
            offset: pending.len() as u64,
            pending,
            passed: None,
            previous: Vec::new(),
            order: Order::new(header.every),
            group: 0,
            index: Vec::new(),
            inputs: Vec::new(),
        };
        writer.flush()?;
        Ok(writer)
    }

    /// Adds the next frame without its state, if the header does not require the state. Frames that go to the file together, with nothing between
    /// them, form one chunk.
    ///
    /// # Errors
    /// An error if the frame is out of order; it is then not added. The file is not written before [`Writer::flush`].
    pub fn push(&mut self, frame: u64, hash: u64) -> io::Result<()> {
        if !self.order.pass(frame) {
            return Err(out_of_order(frame));
        }
        match self.passed {
            Some(_) => self.pending.extend(hash.to_le_bytes()),
            None => self.passed = Some((self.begin(), frame, hash)),
        }
        Ok(())
    }

    /// Ends the chunk of frames without states, if there is one.
    fn end_passed(&mut self) {
        if let Some((from, frame, hash)) = self.passed.take() {
            self.end(from, Kind::Passed, frame, 0, hash);
        }
    }

    /// Adds a frame with its state: the first frame, which may have any number, or the next one. A state that is not due at its frame ends the
    /// recording, and so does the state of the frame that was pushed last. To avoid copying, this function takes the bytes of `state` and leaves
    /// other bytes in it.
    ///
    /// # Errors
    /// An error if the frame is out of order; the frame is then not added, and the state stays with its owner.
    pub fn keep(&mut self, frame: u64, hash: u64, state: &mut Vec<u8>) -> io::Result<()> {
        if !self.order.keep(frame) {
            return Err(out_of_order(frame));
        }
        self.end_passed();
        let begun = self.group > 0 && self.group < GROUP;
        let kind = if begun && self.previous.len() == state.len() { Kind::Difference } else { Kind::Whole };
        if kind == Kind::Whole {
            self.index.push([frame, self.offset]);
            self.previous.clear();
            self.group = 0;
        }
        self.group += 1;
        let from = self.begin();
        codec::encode(state, &self.previous, &mut self.pending);
        self.end(from, kind, frame, state.len() as u64, hash);
        std::mem::swap(&mut self.previous, state);
        Ok(())
    }

    /// Adds an action of a program that precedes the step to the next frame.
    ///
    /// # Errors
    /// An error if the frame is out of order; it is then not added.
    pub fn input(&mut self, frame: u64, bytes: &[u8]) -> io::Result<()> {
        if !self.order.follows(frame) {
            return Err(out_of_order(frame));
        }
        self.end_passed();
        self.inputs.push([frame, self.offset]);
        let from = self.begin();
        self.pending.extend_from_slice(bytes);
        self.end(from, Kind::Input, frame, bytes.len() as u64, 0);
        Ok(())
    }

    /// Reserves space for the head of a chunk, whose payload follows; returns the position of the head.
    fn begin(&mut self) -> usize {
        let from = self.pending.len();
        self.pending.resize(from + format::CHUNK, 0);
        from
    }

    /// Writes the head of a chunk once its payload is complete.
    fn end(&mut self, from: usize, kind: Kind, frame: u64, state: u64, hash: u64) {
        let (head, payload) = self.pending[from..].split_at_mut(format::CHUNK);
        let payload_sum = crc32fast::hash(payload);
        let chunk = ChunkHead { kind, frame, state, payload: payload.len() as u64, hash, payload_sum };
        head.copy_from_slice(&chunk.to_bytes(self.identity));
        self.offset += (self.pending.len() - from) as u64;
    }

    /// Gives all frames so far to the system, so that they survive the end of the process.
    ///
    /// # Errors
    /// The errors of the target; [`Writer::bytes`] is the number of bytes that it has taken.
    pub fn flush(&mut self) -> io::Result<()> {
        self.end_passed();
        if self.pending.is_empty() {
            return Ok(());
        }
        self.out.write_all(&self.pending)?;
        self.pending.clear();
        self.out.flush()
    }

    /// Makes everything that was flushed survive a power failure.
    ///
    /// # Errors
    /// The errors of the target.
    pub fn sync(&self) -> io::Result<()> {
        self.out.inner.sync()
    }

    /// The number of bytes that the target has taken.
    pub fn bytes(&self) -> u64 {
        self.out.bytes
    }

    /// Writes the remaining data, the index and the end, and syncs all of it.
    ///
    /// # Errors
    /// The errors of the target.
    pub fn finish(&mut self) -> io::Result<()> {
        self.end_passed();
        let offset = self.offset;
        let from = self.begin();
        self.pending.extend(self.order.last_kept().unwrap_or(u64::MAX).to_le_bytes());
        self.pending.extend((self.index.len() as u64).to_le_bytes());
        let numbers = self.index.iter().chain(&self.inputs).flatten();
        self.pending.extend(numbers.flat_map(|n| n.to_le_bytes()));
        let bytes = self.pending.len() - from - format::CHUNK;
        self.end(from, Kind::Index, self.order.frames().end, bytes as u64, 0);
        self.pending.extend(format::trailer(offset, self.identity));
        self.flush()?;
        self.sync()
    }
}

fn out_of_order(frame: u64) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, format!("frame {frame} is out of order"))
}
