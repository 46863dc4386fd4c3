//! The versions of recordings that are read and written.

/// The version that is written.
pub const VERSION: u32 = 6;
/// The one before it, in which every frame without its state is a chunk of its own: what is written now says the same with a payload.
pub(super) const BEFORE: u32 = 5;
