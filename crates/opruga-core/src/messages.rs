//! All messages of this crate, for tests of translations.

use crate::{error, spec, stability};
use opruga_math::message::Variant;

/// The variants of every message.
pub const MESSAGES: &[&[Variant]] = &[
    spec::AllowedValues::VARIANTS,
    spec::Alternatives::VARIANTS,
    spec::ConditionText::VARIANTS,
    spec::ValueError::VARIANTS,
    spec::ChoiceError::VARIANTS,
    error::BrokenOff::VARIANTS,
    error::Source::VARIANTS,
    error::StepError::VARIANTS,
    stability::Unstable::VARIANTS,
];
