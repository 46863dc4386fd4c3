//! Numbers of arrays in VTK files. The type of an array determines the range of its numbers.

use super::errors::NumberRange;

/// The type of the numbers of an array.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Number {
    /// A whole number: its bytes, and whether it is signed.
    Whole(usize, bool),
    Real(usize),
}

/// A number as the file gives it: whole numbers keep all their digits.
#[derive(Clone, Copy, Debug)]
pub(super) enum Value {
    Whole(i128),
    Real(f64),
}

impl Value {
    pub(super) fn real(self) -> f64 {
        match self {
            Value::Whole(x) => x as f64,
            Value::Real(x) => x,
        }
    }

    /// Returns the number if it is whole, otherwise its real value.
    pub(super) fn whole(self) -> Result<i128, f64> {
        match self {
            Value::Whole(x) => Ok(x),
            // Above 2⁵³ not every whole number can be represented.
            Value::Real(x) if x.fract() == 0.0 && x.abs() <= 9_007_199_254_740_992.0 => Ok(x as i128),
            Value::Real(x) => Err(x),
        }
    }
}

impl Number {
    /// The type with this name in legacy files.
    pub(super) fn named(name: &str) -> Option<Number> {
        Some(match name.to_ascii_lowercase().as_str() {
            "char" | "vtktypeint8" => Number::Whole(1, true),
            "unsigned_char" | "vtktypeuint8" => Number::Whole(1, false),
            "short" | "vtktypeint16" => Number::Whole(2, true),
            "unsigned_short" | "vtktypeuint16" => Number::Whole(2, false),
            "int" | "vtkidtype" | "vtktypeint32" => Number::Whole(4, true),
            "unsigned_int" | "vtktypeuint32" => Number::Whole(4, false),
            "long" | "vtktypeint64" => Number::Whole(8, true),
            "unsigned_long" | "vtktypeuint64" => Number::Whole(8, false),
            "float" => Number::Real(4),
            "double" => Number::Real(8),
            _ => return None,
        })
    }

    /// The type with this name in XML files.
    pub(super) fn of_xml(name: &str) -> Option<Number> {
        Some(match name {
            "Int8" => Number::Whole(1, true),
            "UInt8" => Number::Whole(1, false),
            "Int16" => Number::Whole(2, true),
            "UInt16" => Number::Whole(2, false),
            "Int32" => Number::Whole(4, true),
            "UInt32" => Number::Whole(4, false),
            "Int64" => Number::Whole(8, true),
            "UInt64" => Number::Whole(8, false),
            "Float32" => Number::Real(4),
            "Float64" => Number::Real(8),
            _ => return None,
        })
    }

    /// The number of bytes of one number.
    pub(super) fn size(self) -> usize {
        match self {
            Number::Whole(size, _) | Number::Real(size) => size,
        }
    }

    /// Reads a number from its bytes.
    pub(super) fn of_bytes(self, bytes: &[u8], big_endian: bool) -> Value {
        let add = |x: u64, byte: &u8| x << 8 | u64::from(*byte);
        let bits = if big_endian { bytes.iter().fold(0, add) } else { bytes.iter().rev().fold(0, add) };
        match self {
            Number::Real(4) => Value::Real(f64::from(f32::from_bits(bits as u32))),
            Number::Real(_) => Value::Real(f64::from_bits(bits)),
            Number::Whole(_, false) => Value::Whole(i128::from(bits)),
            Number::Whole(size, true) => {
                let unused = 64 - 8 * size as u32;
                Value::Whole(i128::from((bits << unused) as i64 >> unused))
            }
        }
    }

    /// Reads a number from a word, or returns what the word should be.
    pub(super) fn of_word(self, word: &str) -> Result<Value, NumberRange> {
        match self {
            Number::Real(size) => match word.parse::<f64>() {
                Ok(x) if size == 4 && x.is_finite() && !(x as f32).is_finite() => {
                    let (least, most) = (format!("{:e}", f32::MIN), format!("{:e}", f32::MAX));
                    Err(NumberRange::Between { least, most })
                }
                Ok(x) => Ok(Value::Real(x)),
                Err(_) => Err(NumberRange::Real {}),
            },
            Number::Whole(size, signed) => {
                let count = 1i128 << (8 * size);
                let [least, most] = if signed { [-count / 2, count / 2 - 1] } else { [0, count - 1] };
                match word.parse::<i128>() {
                    Ok(x) if (least..=most).contains(&x) => Ok(Value::Whole(x)),
                    _ => Err(NumberRange::Whole { least, most }),
                }
            }
        }
    }
}
