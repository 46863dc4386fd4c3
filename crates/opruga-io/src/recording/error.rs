//! Why a recording, or a frame of it, is refused.

use super::version::VERSION;
use crate::problem::SceneError;

opruga_math::messages! {
    /// Why a recording, or a frame of it, was refused.
    #[derive(Clone, Debug, PartialEq)]
    pub enum RecordingError {
        /// The file does not begin like a recording.
        "recording.not_one" #[error("this is not a recording of Opruga")] #[allowed("a recording of version {VERSION}")]
        #[hint("opruga run SCENE --record FILE writes one")]
        NotOne {},
        /// Another version of the program wrote the recording.
        "recording.version" #[error("the recording has version {found}; this program reads version {VERSION}")] #[value("{found}")]
        #[allowed("a recording of version {VERSION}")] #[hint("use the version of the program that wrote the recording")]
        Version { found: u32 },
        /// The file ends within its header: the run that wrote it did not begin.
        "recording.cut_off" #[error("the recording is cut off in its header: it has {found} of {expected} bytes")]
        #[allowed("a recording of version {VERSION}")]
        CutOff { found: u64, expected: u64 },
        /// A checksum does not match, or the parts are inconsistent.
        "recording.damaged" #[error("the recording is damaged between bytes {from} and {to}")] #[value("bytes {from} to {to}")]
        #[allowed("complete chunks")]
        Damaged { from: u64, to: u64 },
        /// There is no such frame.
        "recording.no_frame" #[error("the recording has no frame {frame}")] #[value("{frame}")] #[allowed("frames {first} to {last}")]
        NoFrame { frame: u64, first: u64, last: u64 },
        /// The recording has no frames.
        "recording.no_frame" #[error("the recording has no frame {frame}")] #[value("{frame}")] #[allowed("none: it has no frames")]
        NoFrames { frame: u64 },
        /// The recording does not contain the state of that frame, which must be computed from an earlier state.
        "recording.not_kept" #[error("the recording keeps one state every {every} frames, but not that of frame {frame}")] #[value("{frame}")]
        #[allowed("one frame in {every}, and the last frame")]
        NotKept { frame: u64, every: u64 },
        /// The system could not read the file.
        "read.failed" #[error("the recording cannot be read: {reason}")]
        Read { reason: String },
    }
}

impl RecordingError {
    /// The code of the error: a stable word that programs can rely on.
    pub fn code(&self) -> &'static str {
        opruga_math::message::Message::code(self)
    }
    /// The error for a frame that is not in this range.
    pub fn no_frame(frame: u64, frames: &core::ops::Range<u64>) -> RecordingError {
        match frames.is_empty() {
            true => RecordingError::NoFrames { frame },
            false => RecordingError::NoFrame { frame, first: frames.start, last: frames.end - 1 },
        }
    }
}

impl From<std::io::Error> for RecordingError {
    fn from(error: std::io::Error) -> RecordingError {
        RecordingError::Read { reason: crate::regular_file::reason(&error) }
    }
}

impl From<&RecordingError> for SceneError {
    fn from(error: &RecordingError) -> SceneError {
        SceneError::of(error.clone())
    }
}
