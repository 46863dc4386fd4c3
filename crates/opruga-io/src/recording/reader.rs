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
    /// Frame and place of what a program did.
    inputs: Vec<[u64; 2]>,
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
            inputs: Vec::new(),
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

    /// The last frame up to a given one whose state is kept: those behind it are to be computed from that.
    ///
    /// # Errors
    /// [`RecordingError::NoFrame`].
    pub fn kept(&self, frame: u64) -> Result<u64, RecordingError> {
        if !self.frames.contains(&frame) {
            return Err(RecordingError::NoFrame { frame, frames: self.frames() });
        }
        let first = self.frames.start;
        Ok(if frame + 1 == self.frames.end {
            frame
        } else {
            first + (frame - first) / self.header.every * self.header.every
        })
    }

    /// How its file ends.
    pub fn ending(&self) -> &Ending {
        &self.ending
    }

    /// What a program did during the run: for each the frame that followed it, in order.
    pub fn inputs(&self) -> impl Iterator<Item = u64> + '_ {
        self.inputs.iter().map(|[frame, _]| *frame)
    }

    /// The bytes of what a program did, by its number.
    ///
    /// # Errors
    /// [`RecordingError`] if there is no such input, or if its chunk is damaged.
    pub fn input(&mut self, number: usize) -> Result<Vec<u8>, RecordingError> {
        let frames = self.frames();
        let Some([frame, place]) = self.inputs.get(number).copied() else {
            return Err(RecordingError::NoFrame { frame: number as u64, frames });
        };
        let damaged = |to: u64| RecordingError::Damaged { from: place, to };
        let head = self.chunk_head(place)?.ok_or(damaged(place + CHUNK as u64))?;
        let behind = (place + CHUNK as u64).saturating_add(head.payload);
        if head.kind != Kind::Input || head.frame != frame || behind > self.end {
            return Err(damaged(place + CHUNK as u64));
        }
        self.payload(&head)?.ok_or(damaged(behind))
    }

    /// The payload of the chunk whose head was just read; none where it is damaged.
    fn payload(&mut self, head: &ChunkHead) -> Result<Option<Vec<u8>>, RecordingError> {
        let mut payload = Vec::new();
        self.source.by_ref().take(head.payload).read_to_end(&mut payload)?;
        let fits = payload.len() as u64 == head.payload && crc32fast::hash(&payload) == head.payload_sum;
        Ok(fits.then_some(payload))
    }

    /// The state of a frame that is kept ([`Recording::kept`]). Frames one after the other are read once each, others from
    /// the last that stands for itself.
    ///
    /// # Errors
    /// [`RecordingError`] if there is no state of that frame, or if a chunk on the way to it is damaged.
    pub fn read(&mut self, frame: u64) -> Result<&[u8], RecordingError> {
        if self.kept(frame)? != frame {
            return Err(RecordingError::NotKept { frame, every: self.header.every });
        }
        let [whole, place] = self.index[self.index.partition_point(|[first, _]| *first <= frame) - 1];
        let (mut next, mut place) = match self.read {
            Some((read, _)) if read == frame => return Ok(&self.state),
            Some((read, behind)) if (whole..frame).contains(&read) => (self.behind(read), behind),
            _ => (whole, place),
        };
        self.read = None;
        loop {
            place = self.apply(next, place, next == whole)?;
            if next == frame {
                self.read = Some((frame, place));
                return Ok(&self.state);
            }
            next = self.behind(next);
        }
    }

    /// The frame of the next state behind one.
    fn behind(&self, frame: u64) -> u64 {
        let last = self.frames.end - 1;
        if last - frame < self.header.every { last } else { frame + self.header.every }
    }

    /// Goes from a frame to the next by the chunk at a place; returns the place behind it.
    fn apply(&mut self, frame: u64, mut place: u64, whole: bool) -> Result<u64, RecordingError> {
        let (head, behind) = loop {
            let damaged = RecordingError::Damaged { from: place, to: place + CHUNK as u64 };
            let head = self.chunk_head(place)?.ok_or_else(|| damaged.clone())?;
            let behind = (place + CHUNK as u64).saturating_add(head.payload);
            if head.kind != Kind::Input {
                break (head, behind);
            }
            // What came before the frame is read by those who do it again.
            let between = frame.saturating_sub(self.header.every)..=frame;
            if !between.contains(&head.frame) || behind > self.end {
                return Err(damaged);
            }
            place = behind;
        };
        let damaged = |to: u64| RecordingError::Damaged { from: place, to };
        let kind = if whole { Kind::Whole } else { Kind::Difference };
        if head.kind != kind || head.frame != frame || behind > self.end {
            return Err(damaged(place + CHUNK as u64));
        }
        if whole {
            self.state.clear();
        }
        let bytes = usize::try_from(head.state).map_err(|_| damaged(behind))?;
        let payload = self.payload(&head)?.filter(|_| whole || self.state.len() == bytes);
        let state = payload.and_then(|payload| codec::decode(&payload, bytes, &self.state));
        self.state = state.ok_or(damaged(behind))?;
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
        let Some(payload) = self.payload(&head)? else { return Ok(false) };
        let Some((whole, pairs)) = payload.split_first_chunk::<8>() else { return Ok(false) };
        let (pairs, rest) = pairs.as_chunks::<16>();
        let mut index: Vec<[u64; 2]> = pairs.iter().map(|pair| [u64_at(pair, 0), u64_at(pair, 8)]).collect();
        let Some(whole) = usize::try_from(u64::from_le_bytes(*whole)).ok().filter(|n| *n <= index.len()) else {
            return Ok(false);
        };
        let inputs = index.split_off(whole);
        // An input may come after the last frame: the run has ended before its step.
        let ordered = index.is_sorted_by(|a, b| a[0] < b[0] && a[1] < b[1])
            && inputs.is_sorted_by(|a, b| a[0] <= b[0] && a[1] < b[1])
            && index.iter().all(|[frame, at]| *frame < head.frame && (first..place).contains(at))
            && inputs.iter().all(|[_, at]| (first..place).contains(at));
        if !rest.is_empty() || !ordered {
            return Ok(false);
        }
        self.frames = index.first().map_or(0, |[frame, _]| *frame)..head.frame;
        (self.index, self.inputs, self.end) = (index, inputs, place);
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
            // One past the last state, and the next one at most.
            let next = self.frames.end..self.frames.end.saturating_add(self.header.every);
            // A state nearer to the one before than others are is the last.
            let ended =
                !self.index.is_empty() && !(self.frames.end - 1 - self.frames.start).is_multiple_of(self.header.every);
            let begins = self.index.is_empty() && head.kind == Kind::Whole;
            let follows = next.contains(&head.frame) && !ended || begins;
            match head.kind {
                // Its end is missing, or is not one, else there would have been no need to come here.
                Kind::Index if length - behind < TRAILER as u64 => break Ending::Open { lost: left },
                Kind::Index => break damaged(length),
                Kind::Input if next.contains(&head.frame) || self.index.is_empty() => {
                    self.inputs.push([head.frame, place]);
                    place = behind;
                    continue;
                }
                Kind::Input => break damaged(place + CHUNK as u64),
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
