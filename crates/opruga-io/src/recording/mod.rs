//! Recordings: one file with every frame of a run, which needs no other file, survives a kill at any moment, and is checked byte by byte.
//!
//! ```text
//! 0    8  "OPRREC\x1a\n"        refuses texts and files that a transfer has changed
//! 8    4  version               little-endian, as all numbers
//! 12   8  bytes of the header
//! 20   4  CRC-32 of bytes 0 … 19
//! 24      the header: program, scene, how the run was called, files that the scene had named, how many frames a state is
//!         kept; then CRC-32 of it
//!
//! the first frame, one in so many behind it and the last are chunks with their states; the frames between, as many as went to
//! the system together, are one chunk:
//! 0    4  "FRAM"                "INPT": something that a program did
//! 4    4  0: the state itself, 1: its difference from the state before, 3: an input, 4: frames
//!         without their states
//! 8    8  the number of the frame, or of the first; of an input, the frame that follows
//! 16   8  bytes of the state
//! 24   8  bytes of the payload
//! 32   8  the hash of the frame, or of the first
//! 40   4  CRC-32 of the payload
//! 44   4  CRC-32 of the header's CRC-32 and of bytes 0 … 43: a chunk of another recording does not fit
//! 48      the payload; of frames without their states, the hashes of all but the first, 8 bytes each
//!
//! a run that ends adds a chunk "INDX": the last frame whose state is kept, how many states stand for themselves, the number
//! and place of each, the frame and place of every input; and
//! 0    8  the place of that chunk
//! 8    4  CRC-32 of the header's CRC-32 and of bytes 0 … 7
//! 12   8  "OPREND\x1a\n"
//! ```
//! All offsets have 64 bits. The file of a killed run, which has no end, is read chunk by chunk, and the index is made again. A chunk that was not
//! written completely is omitted and reported. Every chunk goes to the system as soon as it is complete, before the next one begins, so a process
//! that is killed loses at most the last chunk. The bytes of a state and the hash of a frame have a meaning only for the world that wrote them. The
//! hash is compared with that of a frame that is computed again. The same run gives the same bytes.

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
