//! Where a parameter has a say.

use super::{Field, Value, Values};

/// What must hold for a parameter to have a say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Condition {
    /// The scene has so many dimensions.
    Dimension(usize),
    /// Another field has one of these words.
    Word(&'static str, &'static [&'static str]),
    /// Another field is given, or true.
    Given(&'static str),
    /// One at least of some other fields is given, or true.
    GivenOneOf(&'static [&'static str]),
    /// Another field is not given, or false.
    NotGiven(&'static str),
    /// Another field is another number than zero.
    NotZero(&'static str),
}

impl Condition {
    /// Whether it holds among the values of all fields.
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

impl core::fmt::Display for Condition {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match *self {
            Condition::Dimension(wanted) => write!(f, "in {wanted}D"),
            Condition::Word(name, words) => {
                let words: Vec<String> = words.iter().map(|word| format!("\"{word}\"")).collect();
                write!(f, "where `{name}` is {}", words.join(" or "))
            }
            Condition::Given(name) => write!(f, "with `{name}`"),
            Condition::GivenOneOf(names) => {
                let names: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
                write!(f, "with {}", names.join(" or "))
            }
            Condition::NotGiven(name) => write!(f, "without `{name}`"),
            Condition::NotZero(name) => write!(f, "where `{name}` is not 0"),
        }
    }
}

impl Field {
    /// The first condition that does not hold among the values of all fields: then the parameter has no effect.
    pub fn without_effect(&self, values: &Values, dimension: usize) -> Option<&'static Condition> {
        self.applies.iter().find(|condition| !condition.holds(values, dimension))
    }
    /// The sentence of the parameter, and where it has a say.
    pub fn full_documentation(&self) -> String {
        if self.applies.is_empty() {
            return self.documentation.to_string();
        }
        let conditions: Vec<String> = self.applies.iter().map(Condition::to_string).collect();
        format!("{} Has an effect only {}.", self.documentation, conditions.join(" and "))
    }
}
