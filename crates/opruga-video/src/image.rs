//! The pixels of a frame.

/// A frame: four bytes per pixel, row by row from the top.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Image<'a> {
    pub(crate) size: [u32; 2],
    pub(crate) pixels: &'a [u8],
}

impl<'a> Image<'a> {
    /// The width [pixels].
    pub(crate) fn width(&self) -> u32 {
        self.size[0]
    }
    /// The height [pixels].
    pub(crate) fn height(&self) -> u32 {
        self.size[1]
    }
    /// Four bytes per pixel.
    pub(crate) fn pixels(&self) -> &'a [u8] {
        self.pixels
    }
}
