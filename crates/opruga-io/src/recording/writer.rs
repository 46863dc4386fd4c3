//! Writes a recording, frame by frame, into anything that takes bytes.

use super::codec;
use super::format::{self, ChunkHead, Header, Kind};
use crate::safe_write::{Counted, Target};
use std::io::{self, Write as _};

/// Frames from one that stands for itself to the next: as many are read, at most, to see one of them.
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
    /// The frame that comes next; none before the first.
    next: Option<u64>,
    /// Frame and place of the chunks that stand for themselves.
    index: Vec<[u64; 2]>,
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
        let mut writer = Writer { out, identity, pending, place, previous: Vec::new(), next: None, index: Vec::new() };
        writer.flush()?;
        writer.sync()?;
        Ok(writer)
    }

    /// Adds the state of a frame. Frames follow one another without gaps; the first may have any number.
    ///
    /// # Errors
    /// A frame out of its order; it is left out. The file is not written to before [`Writer::flush`].
    pub fn push(&mut self, frame: u64, state: &[u8]) -> io::Result<()> {
        if self.next.is_some_and(|next| next != frame) || frame == u64::MAX {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, format!("frame {frame} is out of order")));
        }
        let begun = self.index.last().is_some_and(|[first, _]| frame - first < GROUP);
        let kind = if begun && self.previous.len() == state.len() { Kind::Difference } else { Kind::Whole };
        if kind == Kind::Whole {
            self.index.push([frame, self.place]);
            self.previous.clear();
        }
        let mut payload = Vec::new();
        codec::encode(state, &self.previous, &mut payload);
        self.chunk(kind, frame, state.len() as u64, &payload);
        self.previous.clear();
        self.previous.extend_from_slice(state);
        self.next = Some(frame + 1);
        Ok(())
    }

    fn chunk(&mut self, kind: Kind, frame: u64, state: u64, payload: &[u8]) {
        let head =
            ChunkHead { kind, frame, state, payload: payload.len() as u64, payload_sum: crc32fast::hash(payload) };
        self.pending.extend(head.to_bytes(self.identity));
        self.pending.extend(payload);
        self.place += (format::CHUNK + payload.len()) as u64;
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
        let index: Vec<u8> = self.index.iter().flatten().flat_map(|n| n.to_le_bytes()).collect();
        self.chunk(Kind::Index, self.next.unwrap_or(0), index.len() as u64, &index);
        self.pending.extend(format::trailer(place, self.identity));
        self.flush()?;
        self.sync()
    }
}
