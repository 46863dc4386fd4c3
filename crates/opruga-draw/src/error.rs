//! What can go wrong while a picture is drawn or written.

/// Why a picture, a plot or a video could not be made.
#[derive(Debug, thiserror::Error)]
pub enum DrawError {
    /// The image has no area, or is larger than 16384 pixels on a side.
    #[error("an image of {width} by {height} pixels cannot be drawn; each side must be between 1 and 16384")]
    Size {
        /// The width asked for, in pixels.
        width: u32,
        /// The height asked for, in pixels.
        height: u32,
    },
    /// There is nothing to draw.
    #[error("there is nothing to draw: {0}")]
    Empty(&'static str),
    /// A facet, a cell, a segment or a pin names a node which the body does not have.
    #[error("body {body} has {nodes} nodes, but its {part} name node {node}")]
    Node {
        /// The body, by its place in the picture.
        body: usize,
        /// The number of nodes of the body.
        nodes: usize,
        /// The list which holds the wrong number.
        part: &'static str,
        /// The node which does not exist.
        node: u32,
    },
    /// The list of scalars of a body has another length than the list of positions.
    #[error("body {body} has {nodes} nodes, but {scalars} scalars; there must be none, or one a node")]
    Scalars {
        /// The body, by its place in the picture.
        body: usize,
        /// The number of nodes of the body.
        nodes: usize,
        /// The number of scalars of the body.
        scalars: usize,
    },
    /// A picture says that it is neither flat nor solid.
    #[error("a picture has {0} dimensions; it must have 2 or 3")]
    Dimension(u8),
    /// A frame of a video has another size than the video.
    #[error("a frame of {found:?} pixels was pushed to a video of {expected:?} pixels")]
    FrameSize {
        /// The width and the height of the video.
        expected: [u32; 2],
        /// The width and the height of the frame.
        found: [u32; 2],
    },
    /// The rate of a video is not a finite number above zero.
    #[error("a video cannot have {0} frames per second")]
    Rate(f64),
    /// The film could not be made.
    #[error(transparent)]
    Video(#[from] opruga_video::VideoError),
    /// The bytes could not be written.
    #[error("the bytes could not be written: {0}")]
    Write(#[from] std::io::Error),
    /// The PNG encoder failed.
    #[error("the PNG encoder failed: {0}")]
    Png(#[from] png::EncodingError),
    /// The GIF encoder failed.
    #[error("the GIF encoder failed: {0}")]
    Gif(#[from] gif::EncodingError),
}
