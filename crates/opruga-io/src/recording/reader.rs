//! Reads a recording from any seekable source.

use super::codec;
use super::error::RecordingError;
use super::format::{self, CHUNK, ChunkHead, HEAD, Header, Kind, TRAILER, u64_at};
use super::order::Order;
use core::ops::Range;
use std::io::{ErrorKind, Read, Seek, SeekFrom};

/// How the file of a recording ends.
#[derive(Clone, Debug, PartialEq)]
pub enum Ending {
    /// The recording ends properly: the run that wrote it has finished it.
    Closed,
    /// The recording has no end: the run was killed, or is still running. All frames are intact.
    Open {
        /// Size of a chunk that was not written completely [bytes].
        lost: u64,
    },
    /// The recording contains something that is not a chunk; the frames after it cannot be found.
    Damaged(RecordingError),
}

/// A recording: the header, and any frame on request.
#[derive(Debug)]
pub struct Recording<R> {
    source: R,
    header: Header,
    identity: u32,
    /// Frame and offset of each chunk with a complete state.
    index: Vec<[u64; 2]>,
    /// Frame and offset of each action of a program.
    inputs: Vec<[u64; 2]>,
    order: Order,
    ending: Ending,
    /// The offset at which the chunks of frames end.
    end: u64,
    /// The last frame whose hash was read, and the offset of the next chunk.
    hashed: Option<(u64, u64)>,
    /// The last chunk of frames without states that was read: its first frame, and the hashes of its frames.
    passed: (u64, Vec<u64>),
    /// The last frame whose state was read, and the offset of the next chunk.
    read: Option<(u64, u64)>,
    state: Vec<u8>,
}

impl<R: Read + Seek> Recording<R> {
    /// Reads the header and the index. If there is no index, makes it from the heads of all chunks.
    ///
    /// # Errors
    /// [`RecordingError`] if the header is not that of a complete recording. Damage after the header is reported by [`Recording::ending`].
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
            order: Order::new(header.every),
            header,
            identity,
            index: Vec::new(),
            inputs: Vec::new(),
            ending: Ending::Closed,
            end: length,
            hashed: None,
            passed: (0, Vec::new()),
            read: None,
            state: Vec::new(),
        };
        let first = HEAD as u64 + header_bytes + 4;
        if !recording.follow_index(first, length)? {
            recording.scan(first, length)?;
        }
        Ok(recording)
    }

    /// The description of the run.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// The range from the first frame to the last.
    pub fn frames(&self) -> Range<u64> {
        self.order.frames()
    }

    /// The last frame, up to a given frame, whose state is kept; the frames after it must be computed from that state.
    ///
    /// # Errors
    /// [`RecordingError::NoFrame`].
    pub fn kept(&self, frame: u64) -> Result<u64, RecordingError> {
        self.order.kept(frame).ok_or_else(|| RecordingError::no_frame(frame, &self.frames()))
    }

    /// The hash of a frame, as given by the program that computed it. Every frame has a hash. If frames are read in order, each chunk is read only
    /// once.
    ///
    /// # Errors
    /// [`RecordingError`] if the frame does not exist, or if a chunk before it that must be read is damaged.
    pub fn hash(&mut self, frame: u64) -> Result<u64, RecordingError> {
        self.kept(frame)?;
        let known = frame.checked_sub(self.passed.0).and_then(|k| self.passed.1.get(usize::try_from(k).ok()?));
        if let Some(hash) = known {
            return Ok(*hash);
        }
        let [whole, at] = self.index[self.index.partition_point(|[first, _]| *first <= frame) - 1];
        let mut offset = self.hashed.filter(|(read, _)| (whole..frame).contains(read)).map_or(at, |(_, behind)| behind);
        loop {
            let (head, behind) = self.frame_chunk(offset, frame)?;
            if head.kind == Kind::Passed && frame - head.frame < 1 + head.payload / 8 {
                let damaged = RecordingError::Damaged { from: offset, to: behind };
                let payload = self.payload(&head)?.filter(|payload| payload.len().is_multiple_of(8)).ok_or(damaged)?;
                let others = payload.as_chunks::<8>().0.iter().map(|hash| u64::from_le_bytes(*hash));
                self.passed = (head.frame, core::iter::once(head.hash).chain(others).collect());
                self.hashed = Some((head.frame.saturating_add(head.payload / 8), behind));
                return Ok(self.passed.1[(frame - head.frame) as usize]);
            }
            // The state of the last frame may follow its hash.
            if !matches!(head.kind, Kind::Input | Kind::Passed) && head.frame == frame {
                self.hashed = Some((frame, behind));
                return Ok(head.hash);
            }
            offset = behind;
        }
    }

    /// How the file of the recording ends.
    pub fn ending(&self) -> &Ending {
        &self.ending
    }

    /// The actions of a program during the run: for each, the frame that followed it, in order.
    pub fn inputs(&self) -> impl Iterator<Item = u64> + '_ {
        self.inputs.iter().map(|[frame, _]| *frame)
    }

    /// The bytes of an action of a program, by its number.
    ///
    /// # Errors
    /// [`RecordingError`] if there is no such input, or if its chunk is damaged.
    pub fn input(&mut self, number: usize) -> Result<Vec<u8>, RecordingError> {
        let frames = self.frames();
        let Some([frame, offset]) = self.inputs.get(number).copied() else {
            return Err(RecordingError::no_frame(number as u64, &frames));
        };
        let damaged = |to: u64| RecordingError::Damaged { from: offset, to };
        let head = self.chunk_head(offset)?.ok_or(damaged(offset + CHUNK as u64))?;
        let behind = (offset + CHUNK as u64).saturating_add(head.payload);
        if head.kind != Kind::Input || head.frame != frame || behind > self.end {
            return Err(damaged(offset + CHUNK as u64));
        }
        self.payload(&head)?.ok_or(damaged(behind))
    }

    /// The payload of the chunk whose head was just read; none if it is damaged.
    fn payload(&mut self, head: &ChunkHead) -> Result<Option<Vec<u8>>, RecordingError> {
        let mut payload = Vec::new();
        self.source.by_ref().take(head.payload).read_to_end(&mut payload)?;
        let fits = payload.len() as u64 == head.payload && crc32fast::hash(&payload) == head.payload_sum;
        Ok(fits.then_some(payload))
    }

    /// The state of a frame, if the recording contains it ([`Recording::kept`]). If frames are read in order, each chunk is read once; otherwise,
    /// reading starts at the last complete state.
    ///
    /// # Errors
    /// [`RecordingError`] if the state of that frame is not kept, or if a chunk before it that must be read is damaged.
    pub fn read(&mut self, frame: u64) -> Result<&[u8], RecordingError> {
        if self.kept(frame)? != frame {
            return Err(RecordingError::NotKept { frame, every: self.header.every });
        }
        let [whole, offset] = self.index[self.index.partition_point(|[first, _]| *first <= frame) - 1];
        let (mut next, mut offset) = match self.read {
            Some((read, _)) if read == frame => return Ok(&self.state),
            Some((read, behind)) if (whole..frame).contains(&read) => (self.order.next_kept(read), behind),
            _ => (whole, offset),
        };
        self.read = None;
        loop {
            offset = self.apply(next, offset, next == whole)?;
            if next == frame {
                self.read = Some((frame, offset));
                return Ok(&self.state);
            }
            next = self.order.next_kept(next);
        }
    }

    /// The head of the chunk of a frame or input at an offset, and the offset after the chunk. A frame after `until` counts as damage.
    fn frame_chunk(&mut self, offset: u64, until: u64) -> Result<(ChunkHead, u64), RecordingError> {
        let damaged = RecordingError::Damaged { from: offset, to: offset + CHUNK as u64 };
        let head = self.chunk_head(offset)?.ok_or_else(|| damaged.clone())?;
        let behind = (offset + CHUNK as u64).saturating_add(head.payload);
        if head.kind == Kind::Index || head.frame > until || behind > self.end {
            return Err(damaged);
        }
        Ok((head, behind))
    }

    /// Decodes the state of a frame from the first chunk with a state at or after an offset; returns the offset after the chunk.
    fn apply(&mut self, frame: u64, mut offset: u64, whole: bool) -> Result<u64, RecordingError> {
        let (head, behind) = loop {
            let (head, behind) = self.frame_chunk(offset, frame)?;
            // Inputs before the frame are read by callers that compute it again.
            if !matches!(head.kind, Kind::Input | Kind::Passed) {
                break (head, behind);
            }
            offset = behind;
        };
        let damaged = |to: u64| RecordingError::Damaged { from: offset, to };
        let kind = if whole { Kind::Whole } else { Kind::Difference };
        if head.kind != kind || head.frame != frame {
            return Err(damaged(offset + CHUNK as u64));
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

    /// The head of the chunk at an offset; none if there is no intact one.
    fn chunk_head(&mut self, offset: u64) -> Result<Option<ChunkHead>, RecordingError> {
        let mut bytes = [0; CHUNK];
        self.source.seek(SeekFrom::Start(offset))?;
        match self.source.read_exact(&mut bytes) {
            Ok(()) => Ok(ChunkHead::read(&bytes, self.identity)),
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => Ok(None),
            Err(error) => Err(error.into()),
        }
    }

    /// Reads the index of a file that was written completely; returns whether there was an index.
    fn follow_index(&mut self, first: u64, length: u64) -> Result<bool, RecordingError> {
        let Some(end) = length.checked_sub(TRAILER as u64).filter(|end| *end >= first) else { return Ok(false) };
        self.source.seek(SeekFrom::Start(end))?;
        let mut trailer = [0; TRAILER];
        self.source.read_exact(&mut trailer)?;
        let Some(offset) = format::index_offset(&trailer, self.identity).filter(|offset| *offset >= first) else {
            return Ok(false);
        };
        let Some(head) = self.chunk_head(offset)?.filter(|head| head.kind == Kind::Index) else { return Ok(false) };
        if offset.saturating_add(CHUNK as u64).saturating_add(head.payload) != end {
            return Ok(false);
        }
        let Some(payload) = self.payload(&head)? else { return Ok(false) };
        let Some((counts, pairs)) = payload.split_first_chunk::<16>() else { return Ok(false) };
        let (kept, whole) = (u64_at(counts, 0), u64_at(counts, 8));
        let (pairs, rest) = pairs.as_chunks::<16>();
        let mut index: Vec<[u64; 2]> = pairs.iter().map(|pair| [u64_at(pair, 0), u64_at(pair, 8)]).collect();
        let Some(whole) = usize::try_from(whole).ok().filter(|n| *n <= index.len()) else { return Ok(false) };
        let inputs = index.split_off(whole);
        // An input may follow the last frame, if the run ended before its step.
        let ordered = index.is_sorted_by(|a, b| a[0] < b[0] && a[1] < b[1])
            && inputs.is_sorted_by(|a, b| a[0] <= b[0] && a[1] < b[1])
            && index.iter().all(|[frame, at]| *frame <= kept && (first..offset).contains(at))
            && inputs.iter().all(|[_, at]| (first..offset).contains(at));
        let every = self.header.every;
        let order = match index.first() {
            Some([begin, _]) => head.frame.checked_sub(1).and_then(|last| Order::ended(every, *begin, last, kept)),
            None => Some(Order::new(every)).filter(|_| inputs.is_empty()),
        };
        let Some(order) = order.filter(|_| rest.is_empty() && ordered) else { return Ok(false) };
        (self.index, self.inputs, self.order, self.end) = (index, inputs, order, offset);
        Ok(true)
    }

    /// Goes from chunk to chunk, until the end or until something that is not a chunk.
    fn scan(&mut self, first: u64, length: u64) -> Result<(), RecordingError> {
        let mut offset = first;
        self.ending = loop {
            let left = length - offset;
            if left < CHUNK as u64 {
                break Ending::Open { lost: left };
            }
            let damaged = |to: u64| Ending::Damaged(RecordingError::Damaged { from: offset, to });
            let Some(head) = self.chunk_head(offset)? else { break damaged(offset + CHUNK as u64) };
            if head.payload > left - CHUNK as u64 {
                break Ending::Open { lost: left };
            }
            let behind = offset + CHUNK as u64 + head.payload;
            let fits = match head.kind {
                // The end of the file is missing or damaged; otherwise the index would have been used.
                Kind::Index if length - behind < TRAILER as u64 => break Ending::Open { lost: left },
                Kind::Index => break damaged(length),
                Kind::Input => self.order.follows(head.frame),
                Kind::Passed => self.order.pass_all(head.frame, head.payload),
                Kind::Difference if self.index.is_empty() => false,
                Kind::Whole | Kind::Difference => self.order.keep(head.frame),
            };
            if !fits {
                break damaged(offset + CHUNK as u64);
            }
            match head.kind {
                Kind::Input => self.inputs.push([head.frame, offset]),
                Kind::Whole => self.index.push([head.frame, offset]),
                _ => {}
            }
            offset = behind;
        };
        self.end = offset;
        Ok(())
    }
}
