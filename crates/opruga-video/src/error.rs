//! Errors of writing a film.

use opruga_math::words::number;

opruga_math::messages! {
    /// The reasons why a film could not be made.
    #[derive(Clone, Debug, PartialEq)]
    pub enum VideoError {
        /// A frame has no pixels, or more than the format allows.
        "video.size"
        #[error("a film cannot have {width} by {height} pixels")]
        #[allowed("1 to 16384 per side, and at most 35 million in all")]
        Size { width: u32, height: u32 },
        /// The size of a frame differs from that of the film.
        "video.frame_size"
        #[error("a frame has {width} by {height} pixels; the film has {film_width} by {film_height}")]
        FrameSize { width: u32, height: u32, film_width: u32, film_height: u32 },
        /// The rate is outside the range of the clock of the format.
        "video.rate"
        #[error("a film cannot have {} frames per second", number(*rate))]
        #[allowed("0.0001 to 10000")]
        Rate { rate: f64 },
        /// The film has no frame.
        "video.empty"
        #[error("a film needs at least one frame")]
        Empty {},
        /// The system could not write the bytes; contains the reason.
        "write.failed"
        #[error("cannot write the film: {reason}")]
        Write { reason: String },
    }
}

impl From<std::io::Error> for VideoError {
    fn from(error: std::io::Error) -> VideoError {
        VideoError::Write { reason: error.to_string() }
    }
}
