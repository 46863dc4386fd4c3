//! Plain numbers, words and lists as values of fields, for programs.

use super::Value;

impl From<f64> for Value {
    fn from(number: f64) -> Value {
        Value::Number(number)
    }
}

impl From<i64> for Value {
    fn from(number: i64) -> Value {
        Value::Integer(number)
    }
}

impl From<bool> for Value {
    fn from(flag: bool) -> Value {
        Value::Boolean(flag)
    }
}

impl From<&str> for Value {
    fn from(word: &str) -> Value {
        Value::Text(word.into())
    }
}

impl<const N: usize> From<[f64; N]> for Value {
    fn from(numbers: [f64; N]) -> Value {
        Value::Numbers(numbers.to_vec())
    }
}
