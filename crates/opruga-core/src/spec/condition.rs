//! Conditions under which a parameter has an effect.

use super::{Field, Value, Values};
use opruga_math::message::AnyMessage;
use opruga_math::messages;

messages! {
    /// Conditions, one of which must hold.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Alternatives {
        "part.alternatives" #[error("{word}")]
        Last { word: String },
        "part.alternatives" #[error("{word} or {rest}")]
        Either { word: String, rest: AnyMessage },
    }

    /// A condition under which a parameter has an effect, in words.
    #[derive(Clone, Debug, PartialEq)]
    pub enum ConditionText {
        "part.condition" #[error("in {dimension}D")]
        Dimension { dimension: usize },
        "part.condition" #[error("if `{field}` is {words}")]
        Word { field: &'static str, words: AnyMessage },
        "part.condition" #[error("with `{field}`")]
        Given { field: &'static str },
        "part.condition" #[error("with {fields}")]
        GivenOneOf { fields: AnyMessage },
        "part.condition" #[error("without `{field}`")]
        NotGiven { field: &'static str },
        "part.condition" #[error("if `{field}` is not 0")]
        NotZero { field: &'static str },
        "part.condition" #[error("in a scene with `[{section}]`")]
        Section { section: &'static str },
    }
}

/// A condition under which a parameter has an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Condition {
    /// The scene has this many dimensions.
    Dimension(usize),
    /// Another field has one of these words.
    Word(&'static str, &'static [&'static str]),
    /// Another field is given, or true.
    Given(&'static str),
    /// At least one of several other fields is given or, if Boolean, is true.
    GivenOneOf(&'static [&'static str]),
    /// Another field is not given, or false.
    NotGiven(&'static str),
    /// Another field is not zero.
    NotZero(&'static str),
}

impl Condition {
    /// Whether it holds for these values of all fields.
    pub fn holds(&self, values: &Values, dimension: usize) -> bool {
        let given = |name: &str| values.get(name).is_some_and(|value| *value != Value::Boolean(false));
        match *self {
            Condition::Dimension(wanted) => wanted == dimension,
            Condition::Word(name, words) => values.text(name).is_some_and(|word| words.contains(&word)),
            Condition::Given(name) => given(name),
            Condition::GivenOneOf(names) => names.iter().any(|name| given(name)),
            Condition::NotGiven(name) => !given(name),
            Condition::NotZero(name) => values.number(name).is_none_or(|number| number != 0.0),
        }
    }
}

fn alternatives(words: impl DoubleEndedIterator<Item = String>) -> AnyMessage {
    let either = |rest, word| match rest {
        None => Some(AnyMessage::from(Alternatives::Last { word })),
        Some(rest) => Some(Alternatives::Either { word, rest }.into()),
    };
    words.rev().fold(None, either).unwrap_or_else(|| Alternatives::Last { word: String::new() }.into())
}

impl Condition {
    /// The condition in words.
    pub fn text(&self) -> ConditionText {
        match *self {
            Condition::Dimension(dimension) => ConditionText::Dimension { dimension },
            Condition::Word(field, words) => {
                ConditionText::Word { field, words: alternatives(words.iter().map(|word| format!("\"{word}\""))) }
            }
            Condition::Given(field) => ConditionText::Given { field },
            Condition::GivenOneOf(names) => {
                ConditionText::GivenOneOf { fields: alternatives(names.iter().map(|name| format!("`{name}`"))) }
            }
            Condition::NotGiven(field) => ConditionText::NotGiven { field },
            Condition::NotZero(field) => ConditionText::NotZero { field },
        }
    }
}

impl Field {
    /// The first condition that does not hold for these values of all fields: the parameter then has no effect.
    pub fn without_effect(&self, values: &Values, dimension: usize) -> Option<&'static Condition> {
        self.applies.iter().find(|condition| !condition.holds(values, dimension))
    }
    /// The sentence of the parameter, and the conditions under which it has an effect.
    pub fn full_documentation(&self) -> String {
        if self.applies.is_empty() {
            return self.documentation.to_string();
        }
        let conditions: Vec<String> = self.applies.iter().map(|condition| condition.text().to_string()).collect();
        format!("{} Has an effect only {}.", self.documentation, conditions.join(" and "))
    }
}
