//! All messages of this crate and of those below it, for tests of translations.

use crate::meshes::MESSAGES as OF_MESHES;
use crate::{budget, problem, rounding, scene};
use opruga_math::message::Variant;

/// The variants of every message.
pub const MESSAGES: &[&[&[Variant]]] = &[
    opruga_mesh::MESSAGES,
    OF_MESHES,
    &[
        problem::Label::VARIANTS,
        problem::Around::VARIANTS,
        budget::Counted::VARIANTS,
        budget::LimitHint::VARIANTS,
        budget::LimitError::VARIANTS,
        rounding::Rounded::VARIANTS,
        scene::CostError::VARIANTS,
    ],
];
