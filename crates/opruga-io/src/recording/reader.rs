//! Reads a recording from anything that can be searched.

use super::codec;
use super::error::RecordingError;
use super::format::{self, CHUNK, ChunkHead, HEAD, Header, Kind, TRAILER, u64_at};
use core::ops::Range;
use std::io::{ErrorKind, Read, Seek, SeekFrom};

/// How the file of a recording ends.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Ending {
    /// As the run that wrote it has meant it to.
    Closed,
    /// Without its end: the run was killed, or is still running. All frames are whole.
    Open {
        /// The bytes of a chunk that was not written to its end.
        lost: u64,
    },
    /// With something else; frames behind it cannot be found.
    Damaged(RecordingError),
}

/// A recording: the header, and any frame on request.
#[derive(Debug)]
pub struct Recording<R> {
    source: R,
    header: Header,
    identity: u32,
    /// Frame and place of the chunks that stand for themselves.
    index: Vec<[u64; 2]>,
    frames: Range<u64>,
    ending: Ending,
    /// Where the chunks of frames end.
    end: u64,
    /// The last frame that was read, and the place of the chunk behind it.
    read: Option<(u64, u64)>,
    state: Vec<u8>,
}

impl<R: Read + Seek> Recording<R> {
    /// Reads the header and the index; where there is no index, makes it anew from the heads of all chunks.
    ///
    /// # Errors
    /// [`RecordingError`] where the head is not that of a whole recording; damage behind it is [`Recording::ending`].
    pub fn open(mut source: R) -> Result<Recording<R>, RecordingError> {
        let length = source.seek(SeekFrom::End(0))?;
        source.rewind()?;
        let mut head = Vec::new();
        source.by_ref().take(HEAD as u64).read_to_end(&mut head)?;
        let header_bytes = format::header_bytes(&head, length)?;
        let mut bytes = Vec::new();
        source.by_ref().take(header_bytes + 4).read_to_end(&mut bytes)?;
        let (header, identity) = format::header(&bytes)?;
        let mut recording = Recording {
            source,
            header,
            identity,
            index: Vec::new(),
            frames: 0..0,
            ending: Ending::Closed,
            end: length,
            read: None,
            state: Vec::new(),
        };
        let first = HEAD as u64 + header_bytes + 4;
        if !recording.follow_index(first, length)? {
            recording.scan(first, length)?;
        }
        Ok(recording)
    }

    /// What it says of its run.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// The first frame, and one past the last.
    pub fn frames(&self) -> Range<u64> {
        self.frames.clone()
    }

    /// How its file ends.
    pub fn ending(&self) -> &Ending {
        &self.ending
    }

    /// The state of a frame. Frames one after the other are read once each, others from the last that stands for itself.
    ///
    /// # Errors
    /// [`RecordingError`] if there is no such frame, or if a chunk on the way to it is damaged.
    pub fn read(&mut self, frame: u64) -> Result<&[u8], RecordingError> {
        if !self.frames.contains(&frame) {
            return Err(RecordingError::NoFrame { frame, frames: self.frames() });
        }
        let [whole, place] = self.index[self.index.partition_point(|[first, _]| *first <= frame) - 1];
        let (mut next, mut place) = match self.read {
            Some((read, _)) if read == frame => return Ok(&self.state),
            Some((read, behind)) if (whole..frame).contains(&read) => (read + 1, behind),
            _ => (whole, place),
        };
        self.read = None;
        loop {
            place = self.apply(next, place, next == whole)?;
            if next == frame {
                self.read = Some((frame, place));
                return Ok(&self.state);
            }
            next += 1;
        }
    }

    /// Goes from a frame to the next by the chunk at a place; returns the place behind it.
    fn apply(&mut self, frame: u64, place: u64, whole: bool) -> Result<u64, RecordingError> {
        let damaged = |to: u64| RecordingError::Damaged { from: place, to };
        let head = self.chunk_head(place)?.ok_or(damaged(place + CHUNK as u64))?;
        let behind = (place + CHUNK as u64).saturating_add(head.payload);
        let kind = if whole { Kind::Whole } else { Kind::Difference };
        if head.kind != kind || head.frame != frame || behind > self.end {
            return Err(damaged(place + CHUNK as u64));
        }
        if whole {
            self.state.clear();
        }
        let bytes = usize::try_from(head.state).map_err(|_| damaged(behind))?;
        let mut payload = Vec::new();
        self.source.by_ref().take(head.payload).read_to_end(&mut payload)?;
        let fits = payload.len() as u64 == head.payload && crc32fast::hash(&payload) == head.payload_sum;
        let fits = fits && (whole || self.state.len() == bytes);
        self.state = fits.then(|| codec::decode(&payload, bytes, &self.state)).flatten().ok_or(damaged(behind))?;
        Ok(behind)
    }

    /// The head of the chunk at a place; none where there is no whole one.
    fn chunk_head(&mut self, place: u64) -> Result<Option<ChunkHead>, RecordingError> {
        let mut bytes = [0; CHUNK];
        self.source.seek(SeekFrom::Start(place))?;
        match self.source.read_exact(&mut bytes) {
            Ok(()) => Ok(ChunkHead::read(&bytes, self.identity)),
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => Ok(None),
            Err(error) => Err(error.into()),
        }
    }

    /// Takes the index of a file that was written to its end; says whether there was one.
    fn follow_index(&mut self, first: u64, length: u64) -> Result<bool, RecordingError> {
        let Some(end) = length.checked_sub(TRAILER as u64).filter(|end| *end >= first) else { return Ok(false) };
        self.source.seek(SeekFrom::Start(end))?;
        let mut trailer = [0; TRAILER];
        self.source.read_exact(&mut trailer)?;
        let Some(place) = format::index_place(&trailer, self.identity).filter(|place| *place >= first) else {
            return Ok(false);
        };
        let Some(head) = self.chunk_head(place)?.filter(|head| head.kind == Kind::Index) else { return Ok(false) };
        if place.saturating_add(CHUNK as u64).saturating_add(head.payload) != end {
            return Ok(false);
        }
        let mut payload = Vec::new();
        self.source.by_ref().take(head.payload).read_to_end(&mut payload)?;
        if payload.len() as u64 != head.payload || crc32fast::hash(&payload) != head.payload_sum {
            return Ok(false);
        }
        let (pairs, rest) = payload.as_chunks::<16>();
        let index: Vec<[u64; 2]> = pairs.iter().map(|pair| [u64_at(pair, 0), u64_at(pair, 8)]).collect();
        let ordered = index.is_sorted_by(|a, b| a[0] < b[0] && a[1] < b[1])
            && index.iter().all(|[frame, at]| *frame < head.frame && (first..place).contains(at));
        if !rest.is_empty() || !ordered {
            return Ok(false);
        }
        self.frames = index.first().map_or(0, |[frame, _]| *frame)..head.frame;
        (self.index, self.end) = (index, place);
        Ok(true)
    }

    /// Goes from chunk to chunk, up to the end or to what is no chunk.
    fn scan(&mut self, first: u64, length: u64) -> Result<(), RecordingError> {
        let mut place = first;
        self.ending = loop {
            let left = length - place;
            if left < CHUNK as u64 {
                break Ending::Open { lost: left };
            }
            let damaged = |to: u64| Ending::Damaged(RecordingError::Damaged { from: place, to });
            let Some(head) = self.chunk_head(place)? else { break damaged(place + CHUNK as u64) };
            if head.payload > left - CHUNK as u64 {
                break Ending::Open { lost: left };
            }
            let behind = place + CHUNK as u64 + head.payload;
            let follows = head.frame == self.frames.end || self.index.is_empty() && head.kind == Kind::Whole;
            match head.kind {
                // Its end is missing, or is not one, else there would have been no need to come here.
                Kind::Index if length - behind < TRAILER as u64 => break Ending::Open { lost: left },
                Kind::Index => break damaged(length),
                _ if !follows || head.frame == u64::MAX => break damaged(place + CHUNK as u64),
                Kind::Difference if self.index.is_empty() => break damaged(place + CHUNK as u64),
                Kind::Difference => {}
                Kind::Whole => {
                    if self.index.is_empty() {
                        self.frames.start = head.frame;
                    }
                    self.index.push([head.frame, place]);
                }
            }
            self.frames.end = head.frame + 1;
            place = behind;
        };
        self.end = place;
        Ok(())
    }
}
