//! Allowed values, and refusals of others, as messages.

use super::{Allowed, Bound};
use opruga_math::messages;

/// The hint with the nearest name; empty if there is none.
fn did_you_mean(word: &Option<String>) -> String {
    word.as_ref().map_or_else(String::new, |word| format!("did you mean `{word}`?"))
}

messages! {
    /// The values that a field may take, in words.
    #[derive(Clone, Debug, PartialEq)]
    pub enum AllowedValues {
        "part.allowed" #[error("a finite number")]
        Finite {},
        "part.allowed" #[error("a number {bound}")]
        Bound { bound: String },
        "part.allowed" #[error("a number {low} and {high}")]
        Between { low: String, high: String },
        "part.allowed" #[error("a whole number from {least} to {greatest}")]
        Integer { least: i64, greatest: i64 },
        "part.allowed" #[error("true or false")]
        Boolean {},
        "part.allowed" #[error("a text of at most 256 bytes")]
        Text {},
        "part.allowed" #[error("one of {words}")]
        Choice { words: String },
        "part.allowed" #[error("{dimension} finite numbers")]
        Vector { dimension: usize },
        "part.allowed" #[error("{dimension} finite numbers that are not all zero")]
        Direction { dimension: usize },
        "part.allowed" #[error("a list of finite numbers")]
        Numbers {},
        "part.allowed" #[error("a list of whole numbers from 0")]
        Integers {},
        "part.allowed" #[error("a list of points of {dimension} finite numbers")]
        Points { dimension: usize },
        "part.allowed" #[error("a curve [[t, value], …] of finite numbers with rising t")]
        Curve {},
        "part.allowed" #[error("a curve [[t, value], …] of finite numbers with rising t and values >= 0")]
        CurveNotNegative {},
        "part.allowed" #[error("a path [[t, {axes}], …] of finite numbers with rising t")]
        Path { axes: &'static str },
    }

    /// Why a value was refused.
    #[derive(Clone, Debug, PartialEq)]
    pub enum ValueError {
        /// There is no field with that name.
        "scene.unknown_field" #[error("there is no field `{name}`")] #[hint("{}", did_you_mean(nearest))]
        UnknownField { name: String, nearest: Option<String> },
        /// The value is outside of its range or of another type.
        "scene.range" #[error("`{name}` is {value}")] #[value("{value}")] #[parameters(name)] #[allowed("{allowed}")]
        NotAllowed { name: String, value: String, allowed: AllowedValues },
    }

    /// Why fields of which exactly one must be given were refused.
    #[derive(Clone, Debug, PartialEq)]
    pub enum ChoiceError {
        "model.one_of" #[error("exactly one of {fields} must be given")]
        OneOf { fields: String },
        "model.one_of" #[error("exactly one of {fields} must be given; none of them is")]
        None { fields: String },
        "model.one_of" #[error("exactly one of {fields} must be given, not {given}")]
        Several { fields: String, given: String },
    }
}

/// Fields in quotes, as a list.
pub fn quoted(fields: &[&str]) -> String {
    format!("`{}`", fields.join("`, `"))
}

impl Allowed {
    /// The allowed values, in words.
    pub fn describe(&self, dimension: usize) -> AllowedValues {
        match self {
            Allowed::Number { least, greatest } => {
                let low = match least {
                    Bound::None => None,
                    Bound::Closed(b) => Some(format!(">= {b}")),
                    Bound::Open(b) => Some(format!("> {b}")),
                };
                let high = match greatest {
                    Bound::None => None,
                    Bound::Closed(b) => Some(format!("<= {b}")),
                    Bound::Open(b) => Some(format!("< {b}")),
                };
                match (low, high) {
                    (None, None) => AllowedValues::Finite {},
                    (Some(low), Some(high)) => AllowedValues::Between { low, high },
                    (Some(bound), None) | (None, Some(bound)) => AllowedValues::Bound { bound },
                }
            }
            Allowed::Integer { least, greatest } => AllowedValues::Integer { least: *least, greatest: *greatest },
            Allowed::Boolean => AllowedValues::Boolean {},
            Allowed::Text => AllowedValues::Text {},
            Allowed::Choice(words) => AllowedValues::Choice { words: format!("\"{}\"", words.join("\", \"")) },
            Allowed::Vector => AllowedValues::Vector { dimension },
            Allowed::Direction => AllowedValues::Direction { dimension },
            Allowed::Numbers => AllowedValues::Numbers {},
            Allowed::Integers => AllowedValues::Integers {},
            Allowed::Points => AllowedValues::Points { dimension },
            Allowed::Curve => AllowedValues::Curve {},
            Allowed::CurveNotNegative => AllowedValues::CurveNotNegative {},
            Allowed::Path => AllowedValues::Path { axes: if dimension == 2 { "x, y" } else { "x, y, z" } },
        }
    }
}
