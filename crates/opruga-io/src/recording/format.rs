//! The parts of the file: head, header, heads of chunks, end.

use super::error::RecordingError;
use super::version::{BEFORE, VERSION};

/// The bytes with which every recording begins.
pub const MAGIC: &[u8; 8] = b"OPRREC\x1a\n";
const END: &[u8; 8] = b"OPREND\x1a\n";
/// The number of bytes before the header.
pub(super) const HEAD: usize = 24;
/// The number of bytes of the head of a chunk.
pub(super) const CHUNK: usize = 48;
/// The number of bytes of the end.
pub(super) const TRAILER: usize = 20;

/// The description of a run in a recording, before the first frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// The program that wrote the recording, with its version.
    pub program: String,
    /// The name of the scene.
    pub name: String,
    /// Where the scene was read from, as given by the user.
    pub file: String,
    /// The scene as it was read.
    pub scene: Vec<u8>,
    /// The length of a frame [s].
    pub frame: f64,
    /// The number of frames from one kept state to the next; the frames between them are computed again. The number is at least 1, which keeps every
    /// state. The states of the first and the last frame are always kept.
    pub every: u64,
    /// The overrides of the call, each a path and a value.
    pub overrides: Vec<(String, String)>,
    /// Whether unknown fields are warnings.
    pub lenient: bool,
    /// Whether a step above the stable limit is a warning.
    pub allow_unstable: bool,
    /// The files that the scene names.
    pub assets: Vec<Asset>,
}

impl Default for Header {
    fn default() -> Header {
        Header {
            program: String::new(),
            name: String::new(),
            file: String::new(),
            scene: Vec::new(),
            frame: 0.0,
            every: 1,
            overrides: Vec::new(),
            lenient: false,
            allow_unstable: false,
            assets: Vec::new(),
        }
    }
}

/// A file that a scene names, as it was when the run began.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Asset {
    /// The name of the file, as the scene gives it.
    pub name: String,
    /// The bytes of the file.
    pub bytes: Vec<u8>,
}

impl Header {
    fn to_bytes(&self) -> Vec<u8> {
        let mut out = Vec::new();
        let mut part = |bytes: &[u8]| {
            out.extend((bytes.len() as u64).to_le_bytes());
            out.extend(bytes);
        };
        for text in [&self.program, &self.name, &self.file] {
            part(text.as_bytes());
        }
        part(&self.scene);
        part(&self.frame.to_le_bytes());
        part(&self.every.to_le_bytes());
        part(&[u8::from(self.lenient), u8::from(self.allow_unstable)]);
        part(&(self.overrides.len() as u64).to_le_bytes());
        for (path, value) in &self.overrides {
            part(path.as_bytes());
            part(value.as_bytes());
        }
        part(&(self.assets.len() as u64).to_le_bytes());
        for asset in &self.assets {
            part(asset.name.as_bytes());
            part(&asset.bytes);
        }
        out
    }

    /// Reads what [`Header::to_bytes`] wrote; none if the bytes are something else.
    fn read(mut bytes: &[u8]) -> Option<Header> {
        let mut part = || {
            let (length, rest) = bytes.split_first_chunk::<8>()?;
            let (part, rest) = rest.split_at_checked(usize::try_from(u64::from_le_bytes(*length)).ok()?)?;
            bytes = rest;
            Some(part)
        };
        let text = |part: &[u8]| String::from_utf8(part.to_vec()).ok();
        let count = |part: &[u8]| Some(u64::from_le_bytes(*part.as_array()?));
        let mut header = Header {
            program: text(part()?)?,
            name: text(part()?)?,
            file: text(part()?)?,
            scene: part()?.to_vec(),
            frame: f64::from_le_bytes(*part()?.as_array()?),
            every: count(part()?)?,
            ..Header::default()
        };
        let [lenient, allow_unstable] = *part()?.as_array::<2>()?;
        (header.lenient, header.allow_unstable) = (lenient == 1, allow_unstable == 1);
        for _ in 0..count(part()?)? {
            header.overrides.push((text(part()?)?, text(part()?)?));
        }
        for _ in 0..count(part()?)? {
            header.assets.push(Asset { name: text(part()?)?, bytes: part()?.to_vec() });
        }
        let sound = header.frame.is_finite() && header.frame > 0.0 && (1..=u64::from(u32::MAX)).contains(&header.every);
        (bytes.is_empty() && sound).then_some(header)
    }
}

/// The beginning of the file, and the checksum that identifies this recording.
pub(super) fn beginning(header: &Header) -> (Vec<u8>, u32) {
    let header = header.to_bytes();
    let mut out = MAGIC.to_vec();
    out.extend(VERSION.to_le_bytes());
    out.extend((header.len() as u64).to_le_bytes());
    out.extend(crc32fast::hash(&out).to_le_bytes());
    let identity = crc32fast::hash(&header);
    out.extend(header);
    out.extend(identity.to_le_bytes());
    (out, identity)
}

/// The size of the header, from the bytes before it.
pub(super) fn header_bytes(head: &[u8], file: u64) -> Result<u64, RecordingError> {
    if head.is_empty() || !head.starts_with(&MAGIC[..head.len().min(8)]) {
        return Err(RecordingError::NotOne {});
    }
    let Some((head, _)) = head.split_first_chunk::<HEAD>() else {
        return Err(RecordingError::CutOff { found: file, expected: HEAD as u64 });
    };
    if crc32fast::hash(&head[..20]) != u32_at(head, 20) {
        return Err(RecordingError::Damaged { from: 0, to: HEAD as u64 });
    }
    // The version is checked after the checksum, because a flipped byte is damage and not another version.
    match u32_at(head, 8) {
        VERSION | BEFORE => {}
        found => return Err(RecordingError::Version { found }),
    }
    let bytes = u64_at(head, 12);
    let expected = (HEAD as u64 + 4).saturating_add(bytes);
    if file < expected {
        return Err(RecordingError::CutOff { found: file, expected });
    }
    Ok(bytes)
}

/// Reads the header, and the checksum that identifies this recording, from the bytes of the header and of the checksum after it.
pub(super) fn header(bytes: &[u8]) -> Result<(Header, u32), RecordingError> {
    let damaged = || RecordingError::Damaged { from: HEAD as u64, to: (HEAD + bytes.len()) as u64 };
    let (header, sum) = bytes.split_last_chunk::<4>().ok_or_else(damaged)?;
    let identity = crc32fast::hash(header);
    if identity != u32::from_le_bytes(*sum) {
        return Err(damaged());
    }
    Ok((Header::read(header).ok_or_else(damaged)?, identity))
}

/// The contents of a chunk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A complete state.
    Whole,
    /// The difference of a state from the previous kept one.
    Difference,
    /// Frames whose states are not kept: the head of the chunk contains the hash of the first frame, and the payload contains those of the others.
    Passed,
    /// An action of the program before the step to a frame.
    Input,
    /// The last frame whose state is kept, the number of chunks with complete states, the frames and offsets of these chunks, and then the frames and
    /// offsets of the inputs.
    Index,
}

/// The head of a chunk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ChunkHead {
    pub(super) kind: Kind,
    /// The frame of this chunk, or the first of its frames. For an input, the frame that follows it; for an index, the frame after the last.
    pub(super) frame: u64,
    /// Size of the decoded payload [bytes].
    pub(super) state: u64,
    pub(super) payload: u64,
    /// The hash of the frame; 0 if the chunk is not a frame.
    pub(super) hash: u64,
    pub(super) payload_sum: u32,
}

impl ChunkHead {
    pub(super) fn to_bytes(self, identity: u32) -> [u8; CHUNK] {
        let mut out = [0; CHUNK];
        let (word, kind): (_, u32) = match self.kind {
            Kind::Whole => (b"FRAM", 0),
            Kind::Difference => (b"FRAM", 1),
            Kind::Index => (b"INDX", 2),
            Kind::Input => (b"INPT", 3),
            Kind::Passed => (b"FRAM", 4),
        };
        out[..4].copy_from_slice(word);
        out[4..8].copy_from_slice(&kind.to_le_bytes());
        out[8..16].copy_from_slice(&self.frame.to_le_bytes());
        out[16..24].copy_from_slice(&self.state.to_le_bytes());
        out[24..32].copy_from_slice(&self.payload.to_le_bytes());
        out[32..40].copy_from_slice(&self.hash.to_le_bytes());
        out[40..44].copy_from_slice(&self.payload_sum.to_le_bytes());
        let sum = sum_of(identity, &out[..44]);
        out[44..].copy_from_slice(&sum.to_le_bytes());
        out
    }

    /// Reads the head; none if the bytes are not the head of a chunk of this recording.
    pub(super) fn read(bytes: &[u8; CHUNK], identity: u32) -> Option<ChunkHead> {
        let kind = match (&bytes[..4], u32_at(bytes, 4)) {
            (b"FRAM", 0) => Kind::Whole,
            (b"FRAM", 1) => Kind::Difference,
            (b"INDX", 2) => Kind::Index,
            (b"INPT", 3) => Kind::Input,
            (b"FRAM", 4) => Kind::Passed,
            _ => return None,
        };
        (sum_of(identity, &bytes[..44]) == u32_at(bytes, 44)).then(|| ChunkHead {
            kind,
            frame: u64_at(bytes, 8),
            state: u64_at(bytes, 16),
            payload: u64_at(bytes, 24),
            hash: u64_at(bytes, 32),
            payload_sum: u32_at(bytes, 40),
        })
    }
}

/// The end of the file, which gives the offset of the index.
pub(super) fn trailer(index: u64, identity: u32) -> Vec<u8> {
    let mut out = index.to_le_bytes().to_vec();
    out.extend(sum_of(identity, &out).to_le_bytes());
    out.extend(END);
    out
}

/// The offset of the index; none if these bytes are not the end of this recording.
pub(super) fn index_offset(trailer: &[u8; TRAILER], identity: u32) -> Option<u64> {
    let whole = trailer[12..] == *END && sum_of(identity, &trailer[..8]) == u32_at(trailer, 8);
    whole.then(|| u64_at(trailer, 0))
}

fn sum_of(identity: u32, bytes: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(&identity.to_le_bytes());
    hasher.update(bytes);
    hasher.finalize()
}

fn u32_at(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(core::array::from_fn(|k| bytes[at + k]))
}

pub(super) fn u64_at(bytes: &[u8], at: usize) -> u64 {
    u64::from_le_bytes(core::array::from_fn(|k| bytes[at + k]))
}
