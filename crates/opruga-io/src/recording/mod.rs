//! Recordings: one file with every frame of a run, which needs no other file, survives a kill at any moment, and is checked byte by byte.
//!
//! A file consists of a header, chunks, an index and an end. All numbers are little-endian, and all offsets have 64 bits. Each row of the tables
//! below gives an offset, a size in bytes, and the content. The file begins with the header:
//!
//! ```text
//! 0    8  "OPRREC\x1a\n", which reveals texts and files that a transfer has changed
//! 8    4  version
//! 12   8  size of the header [bytes]
//! 20   4  CRC-32 of bytes 0 … 19
//! 24      the header: program, scene, length of a frame, number of frames from one kept state to
//!         the next, settings of the call, files that the scene names
//!      4  CRC-32 of the header
//! ```
//! Chunks follow. A chunk holds a frame with its state, an action of a program, or a sequence of frames without states that went to the system
//! together. The states of the first and the last frame are kept, and those at regular intervals between them.
//!
//! ```text
//! 0    4  "FRAM" for frames, "INPT" for an action of a program, "INDX" for the index
//! 4    4  kind: 0 a complete state, 1 the difference of a state from the previous kept one,
//!         2 the index, 3 an action of a program, 4 frames without states
//! 8    8  number of the frame, or of the first frame of kind 4; for an action, the frame that
//!         follows it; for the index, the frame after the last
//! 16   8  size of the decoded payload [bytes]; 0 for frames without states
//! 24   8  size of the payload [bytes]
//! 32   8  hash of the frame, or of the first frame of kind 4; otherwise 0
//! 40   4  CRC-32 of the payload
//! 44   4  CRC-32 of the header's CRC-32 and of bytes 0 … 43, which differs in another recording
//! 48      the payload; for frames without states, the hashes of all but the first, 8 bytes each
//! ```
//! A run that ends adds the index, which is a chunk too, and the end of the file. The payload of the index consists of the number of the last frame
//! whose state is kept, the number of chunks with complete states, the frame and the offset of each of these chunks, and the frame and the offset of
//! each action. The end consists of:
//!
//! ```text
//! 0    8  offset of the index
//! 8    4  CRC-32 of the header's CRC-32 and of bytes 0 … 7
//! 12   8  "OPREND\x1a\n"
//! ```
//! The file of a killed run, which has no end, is read chunk by chunk, and the index is made again. A chunk that was not written completely is
//! omitted and reported. Every chunk goes to the system as soon as it is complete, before the next one begins, so a process that is killed loses at
//! most the last chunk. The bytes of a state and the hash of a frame have a meaning only for the world that wrote them. If a frame is computed again,
//! its hash is compared with the recorded one. The same run gives the same bytes.

mod codec;
mod error;
mod file;
mod format;
mod order;
mod reader;
mod version;
mod writer;

pub use error::RecordingError;
pub use file::RecordingFile;
pub use format::{Asset, Header, MAGIC};
pub use reader::{Ending, Recording};
pub use version::VERSION;
pub use writer::Writer;
