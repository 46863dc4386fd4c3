//! Errors of drawing or writing a picture.

use opruga_math::message::Variant;
use opruga_video::VideoError;

opruga_math::terms! {
    /// The content that a picture or a plot lacks.
    pub enum Nothing = "part.nothing_to_draw" {
        Picture = "a film strip needs a picture",
        FinitePlace = "no body has a node at a finite position",
        Cell = "a map needs a panel, a column and a row",
        Panel = "a plot needs a panel",
        Sample = "a GIF needs sample frames for its palette",
        NumberOfCase = "the case has no numbers",
        Parameter = "no parameter",
        NumberOfSweep = "no point of the sweep has a number to plot",
    }
}

opruga_math::terms! {
    /// A list of a picture whose items refer to nodes.
    pub enum PictureList = "part.picture_list" {
        Areas = "areas",
        LinesAtRest = "lines at rest",
        Facets = "facets",
        Cells = "cells",
        Segments = "segments",
        PinnedNodes = "pinned nodes",
    }
}

opruga_math::messages! {
    /// The reasons why a picture, a plot or a video could not be made.
    #[derive(Clone, Debug, PartialEq)]
    pub enum DrawError {
        /// The image has no area, or is larger than 16384 pixels on a side.
        "draw.failed"
        #[error("an image of {width} by {height} pixels cannot be drawn; each side must be between 1 and 16384")]
        Size { width: u32, height: u32 },
        /// There is nothing to draw.
        "draw.failed"
        #[error("there is nothing to draw: {nothing}")]
        Empty { nothing: Nothing },
        /// A facet, a cell, a segment or a pin refers to a node that the body does not have. The body is given by its index in the picture.
        "draw.failed"
        #[error("body {body} has {nodes} nodes, numbered from 0, but its {list} name node {node}")]
        Node { body: usize, nodes: usize, list: PictureList, node: u32 },
        /// The list of scalars of a body has a different length from the list of positions. The body is given by its index in the picture.
        "draw.failed"
        #[error("body {body} has {nodes} nodes, but {scalars} scalars; there must be none, or one per node")]
        Scalars { body: usize, nodes: usize, scalars: usize },
        /// The dimension of a picture is neither 2 nor 3.
        "draw.failed"
        #[error("a picture has {dimensions} dimensions; it must have 2 or 3")]
        Dimension { dimensions: u8 },
        /// The size of a frame differs from that of the video [pixels].
        "draw.failed"
        #[error("a frame of {found:?} pixels was pushed to a video of {expected:?} pixels")]
        FrameSize { expected: [u32; 2], found: [u32; 2] },
        /// The rate of a video is not a finite number above zero.
        "draw.failed"
        #[error("a video cannot have {rate} frames per second")]
        Rate { rate: f64 },
        /// The film could not be made.
        "draw.failed"
        #[error("{cause}")]
        Video { cause: VideoError },
        /// The PNG encoder or its output failed; contains the system's reason.
        "draw.failed"
        #[error("the PNG encoder failed: {reason}")]
        Png { reason: String },
        /// The GIF encoder or its output failed; contains the system's reason.
        "draw.failed"
        #[error("the GIF encoder failed: {reason}")]
        Gif { reason: String },
    }
}

/// All messages of this crate, for catalogues.
pub const MESSAGES: &[&[Variant]] = &[Nothing::VARIANTS, PictureList::VARIANTS, DrawError::VARIANTS];

impl From<VideoError> for DrawError {
    fn from(cause: VideoError) -> DrawError {
        DrawError::Video { cause }
    }
}

impl From<png::EncodingError> for DrawError {
    fn from(error: png::EncodingError) -> DrawError {
        DrawError::Png { reason: error.to_string() }
    }
}

impl From<gif::EncodingError> for DrawError {
    fn from(error: gif::EncodingError) -> DrawError {
        DrawError::Gif { reason: error.to_string() }
    }
}
