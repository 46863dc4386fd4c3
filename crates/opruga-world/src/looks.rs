//! Looks into the middle of a frame, for readers that must not miss what swings faster than frames pass.

use crate::ledger::Flows;

/// Where a world is looked at between frames.
#[derive(Debug, Default)]
pub(crate) struct Looks {
    /// Substeps between two looks; 0: none.
    pub(crate) every: u32,
    /// Whether the last frame has left looks behind.
    pub(crate) fresh: bool,
    /// What had entered and left before the last frame.
    pub(crate) flows: Flows,
    /// The time while a look lasts [s].
    pub(crate) time: Option<f64>,
}
