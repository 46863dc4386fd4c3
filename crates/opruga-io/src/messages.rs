//! All messages of this crate and of those below it, for tests of translations.

use crate::meshes::MESSAGES as OF_MESHES;
use crate::shapes::MESSAGES as OF_SHAPES;
use crate::{budget, checkpoint, problem, recording, refusals, rounding, scene, text_errors, write_faults};
use opruga_math::message::Variant;

/// The variants of every message.
pub const MESSAGES: &[&[&[Variant]]] = &[
    opruga_mesh::MESSAGES,
    opruga_core::messages::MESSAGES,
    OF_MESHES,
    OF_SHAPES,
    scene::MESSAGES,
    text_errors::MESSAGES,
    refusals::MESSAGES,
    &[
        problem::Label::VARIANTS,
        problem::Around::VARIANTS,
        budget::Counted::VARIANTS,
        budget::LimitHint::VARIANTS,
        budget::LimitError::VARIANTS,
        rounding::Rounded::VARIANTS,
        checkpoint::CheckpointError::VARIANTS,
        recording::RecordingError::VARIANTS,
        write_faults::Doing::VARIANTS,
        write_faults::WriteFault::VARIANTS,
        write_faults::Use::VARIANTS,
        scene::CostError::VARIANTS,
    ],
];
