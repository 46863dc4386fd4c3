//! States kept within a frame, for measurements of motions that are faster than the frames.

use crate::ledger::Flows;

/// The settings and data for states that are kept within frames.
#[derive(Debug, Default)]
pub(crate) struct Looks {
    /// Substeps between two kept states; 0: none.
    pub(crate) every: u32,
    /// Whether the last frame has kept states.
    pub(crate) fresh: bool,
    /// The flows before the last frame.
    pub(crate) flows: Flows,
    /// The time of the state that `look_within` shows at present [s].
    pub(crate) time: Option<f64>,
}
