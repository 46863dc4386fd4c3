//! The container of a checkpoint: the scene itself and the state of the world, with checksums over every byte.
//!
//! ```text
//! 0   8  "OPRUGA\x1a\n"         magic: refuses texts and files that a transfer has changed
//! 8   4  version                little-endian, as all numbers
//! 12  8  bytes of the scene
//! 20  8  bytes of the payload
//! 28  4  CRC-32 of bytes 0 … 27
//! 32     the scene, then CRC-32 of it
//!        the payload in pieces of 1 MiB, each followed by its CRC-32
//! ```
//! The file ends after the last checksum: anything more or less is refused.

use crate::problem::SceneError;
use opruga_math::messages;
use std::io::{self, Write};

/// The version that is written.
pub const VERSION: u32 = 1;
const MAGIC: &[u8; 8] = b"OPRUGA\x1a\n";
const PIECE: usize = 1 << 20;
const HEAD: usize = 32;

/// The contents of a checkpoint.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Checkpoint {
    /// The text of the scene as it was read, so that the checkpoint needs no other file. Overrides belong in the payload.
    pub scene: String,
    /// The bytes of the state, in the encoding of the world that wrote the state.
    pub payload: Vec<u8>,
}

messages! {
    /// Why a checkpoint was refused.
    #[derive(Clone, Debug, PartialEq)]
    pub enum CheckpointError {
        /// The file does not begin like a checkpoint.
        "checkpoint.not_one" #[error("this is not a checkpoint of Opruga")] #[allowed("a complete checkpoint of version {VERSION}")]
        NotOne {},
        /// Another version of the program wrote the checkpoint.
        "checkpoint.version" #[error("the checkpoint has version {found}; this program reads version {VERSION}")]
        #[allowed("a complete checkpoint of version {VERSION}")]
        Version { found: u32 },
        /// The checkpoint is shorter than its header says.
        "checkpoint.cut_off" #[error("the checkpoint is cut off: it has {found} of {expected} bytes")]
        #[allowed("a complete checkpoint of version {VERSION}")]
        CutOff { found: u64, expected: u64 },
        /// Further bytes follow the end of the checkpoint.
        "checkpoint.too_long" #[error("{extra} bytes follow the end of the checkpoint")] #[allowed("a complete checkpoint of version {VERSION}")]
        TooLong { extra: u64 },
        /// A checksum does not match.
        "checkpoint.damaged" #[error("the checkpoint is damaged between bytes {from} and {to}")]
        #[allowed("a complete checkpoint of version {VERSION}")]
        Damaged { from: u64, to: u64 },
    }
}

impl CheckpointError {
    /// The code of the error: a stable word that programs can rely on.
    pub fn code(&self) -> &'static str {
        opruga_math::message::Message::code(self)
    }
}

impl From<&CheckpointError> for SceneError {
    fn from(error: &CheckpointError) -> SceneError {
        SceneError::of(error.clone())
    }
}

impl Checkpoint {
    /// Writes the checkpoint; [`crate::safe_write::safe_write`] makes the file.
    ///
    /// # Errors
    /// The errors of the writer.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        let mut head = Vec::with_capacity(HEAD);
        head.extend_from_slice(MAGIC);
        head.extend_from_slice(&VERSION.to_le_bytes());
        head.extend_from_slice(&(self.scene.len() as u64).to_le_bytes());
        head.extend_from_slice(&(self.payload.len() as u64).to_le_bytes());
        let sum = crc32fast::hash(&head);
        head.extend_from_slice(&sum.to_le_bytes());
        out.write_all(&head)?;
        out.write_all(self.scene.as_bytes())?;
        out.write_all(&crc32fast::hash(self.scene.as_bytes()).to_le_bytes())?;
        for piece in self.payload.chunks(PIECE) {
            out.write_all(piece)?;
            out.write_all(&crc32fast::hash(piece).to_le_bytes())?;
        }
        Ok(())
    }

    /// Reads a checkpoint. Sizes are compared with the number of bytes present before anything is allocated.
    ///
    /// # Errors
    /// Any flipped byte, truncation or addition, and any other version, is refused.
    pub fn read(bytes: &[u8]) -> Result<Checkpoint, CheckpointError> {
        let found = bytes.len() as u64;
        if !bytes.starts_with(&MAGIC[..bytes.len().min(8)]) {
            return Err(CheckpointError::NotOne {});
        }
        if bytes.len() < HEAD {
            return Err(CheckpointError::CutOff { found, expected: HEAD as u64 });
        }
        let version = u32::from_le_bytes(array(&bytes[8..12]));
        if version != VERSION {
            return Err(CheckpointError::Version { found: version });
        }
        if crc32fast::hash(&bytes[..28]) != u32::from_le_bytes(array(&bytes[28..32])) {
            return Err(CheckpointError::Damaged { from: 0, to: HEAD as u64 });
        }
        let scene_bytes = u64::from_le_bytes(array(&bytes[12..20]));
        let payload_bytes = u64::from_le_bytes(array(&bytes[20..28]));
        let sums = payload_bytes.div_ceil(PIECE as u64).saturating_mul(4).saturating_add(4);
        let expected = (HEAD as u64).saturating_add(scene_bytes).saturating_add(payload_bytes).saturating_add(sums);
        if found < expected {
            return Err(CheckpointError::CutOff { found, expected });
        }
        if found > expected {
            return Err(CheckpointError::TooLong { extra: found - expected });
        }
        let mut at = HEAD;
        let scene = checked(bytes, &mut at, scene_bytes as usize)?.to_vec();
        let mut payload = Vec::with_capacity(payload_bytes as usize);
        while payload.len() < payload_bytes as usize {
            let size = PIECE.min(payload_bytes as usize - payload.len());
            payload.extend_from_slice(checked(bytes, &mut at, size)?);
        }
        let scene = String::from_utf8(scene)
            .map_err(|_| CheckpointError::Damaged { from: HEAD as u64, to: HEAD as u64 + scene_bytes })?;
        Ok(Checkpoint { scene, payload })
    }
}

/// Returns the next `size` bytes if the checksum after them matches.
fn checked<'b>(bytes: &'b [u8], at: &mut usize, size: usize) -> Result<&'b [u8], CheckpointError> {
    let from = *at;
    let to = from + size;
    *at = to + 4;
    if crc32fast::hash(&bytes[from..to]) == u32::from_le_bytes(array(&bytes[to..to + 4])) {
        Ok(&bytes[from..to])
    } else {
        Err(CheckpointError::Damaged { from: from as u64, to: to as u64 + 4 })
    }
}

fn array<const N: usize>(bytes: &[u8]) -> [u8; N] {
    core::array::from_fn(|k| bytes[k])
}
