//! Why a recording, or a frame of it, is refused.

use super::version::VERSION;
use crate::problem::SceneError;

/// Why a recording, or a frame of it, was refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RecordingError {
    /// It does not begin as a recording.
    #[error("this is no recording of Opruga")]
    NotOne,
    /// Another version of the program wrote it.
    #[error("the recording has version {found}; this program reads version {VERSION}")]
    Version {
        /// The version that was found.
        found: u32,
    },
    /// It ends within its head: the run that wrote it did not begin.
    #[error("the recording is cut off in its head: it has {found} bytes of {expected}")]
    CutOff {
        /// The bytes that it has.
        found: u64,
        /// The bytes that its head should have.
        expected: u64,
    },
    /// A checksum does not fit, or the parts do not fit together.
    #[error("the recording is damaged between bytes {from} and {to}")]
    Damaged {
        /// The first byte of the damaged part.
        from: u64,
        /// One past its last byte.
        to: u64,
    },
    /// There is no such frame.
    #[error("the recording has no frame {frame}")]
    NoFrame {
        /// The frame that was asked for.
        frame: u64,
        /// The first frame, and one past the last.
        frames: core::ops::Range<u64>,
    },
    /// The state of that frame is not in it: it is computed from one before.
    #[error("the recording keeps one state in {every} frames, and not that of frame {frame}")]
    NotKept {
        /// The frame that was asked for.
        frame: u64,
        /// From one state to the next.
        every: u64,
    },
    /// The system could not read it.
    #[error("the recording cannot be read: {0}")]
    Read(String),
}

impl RecordingError {
    /// A stable word for programs.
    pub fn code(&self) -> &'static str {
        match self {
            RecordingError::NotOne => "recording.not_one",
            RecordingError::Version { .. } => "recording.version",
            RecordingError::CutOff { .. } => "recording.cut_off",
            RecordingError::Damaged { .. } => "recording.damaged",
            RecordingError::NoFrame { .. } => "recording.no_frame",
            RecordingError::NotKept { .. } => "recording.not_kept",
            RecordingError::Read(_) => "read.failed",
        }
    }
}

impl From<std::io::Error> for RecordingError {
    fn from(error: std::io::Error) -> RecordingError {
        RecordingError::Read(crate::regular_file::reason(&error))
    }
}

impl From<&RecordingError> for SceneError {
    fn from(error: &RecordingError) -> SceneError {
        let said = SceneError::new(error.code(), error.to_string());
        match error {
            RecordingError::Read(_) => said,
            RecordingError::NoFrame { frame, frames } if !frames.is_empty() => {
                said.value(frame.to_string()).allowed(format!("frames {} to {}", frames.start, frames.end - 1))
            }
            RecordingError::NoFrame { frame, .. } => said.value(frame.to_string()).allowed("none: it has no frames"),
            RecordingError::NotKept { frame, every } => {
                said.value(frame.to_string()).allowed(format!("every {every}th frame, and the last"))
            }
            RecordingError::Version { found } => {
                said.value(found.to_string()).allowed(format!("a recording of version {VERSION}"))
            }
            RecordingError::Damaged { from, to } => said.value(format!("bytes {from} to {to}")).allowed("whole chunks"),
            _ => said.allowed(format!("a recording of version {VERSION}")),
        }
    }
}
