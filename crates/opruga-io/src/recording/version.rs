//! The versions of recordings that can be read and written.

/// The version that is written.
pub const VERSION: u32 = 6;
/// The previous version, in which every frame without its state is a chunk of its own. The present version can store the hashes of several such
/// frames in a payload.
pub(super) const BEFORE: u32 = 5;
