//! The description of the parameters of a model, integrator, shape or collider.
//!
//! One description serves the scene reader, the error messages, the documentation, the JSON Schema and the panels of the studio. The description does
//! not depend on any file format.

mod allowed;
mod condition;
mod convert;
mod names;

pub use allowed::{AllowedValues, ChoiceError, ValueError, quoted};
pub use condition::{Alternatives, Condition, ConditionText};
pub use names::{close_matches, nearest};

use crate::error::BuildError;

/// The complete description of a kind of model, integrator, shape or collider that a scene can name.
#[derive(Clone, Copy, Debug)]
pub struct Spec {
    /// The name in the scene file.
    pub kind: &'static str,
    /// A one-line summary for lists.
    pub summary: &'static str,
    /// Physics, formula, source and limits, in Markdown.
    pub documentation: &'static str,
    /// The dimensions in which it exists.
    pub dimensions: &'static [usize],
    /// The parameters, in the order of the documentation.
    pub fields: &'static [Field],
    /// The roles that higher layers of the program use; most kinds have none.
    pub roles: &'static [Role],
}

/// What a kind does. Higher layers of the program use its role, so that none of them depends on the name of a kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// A model that owns cells of the mesh and provides their stress and volume ratio J. Two models that own the same cell are
    /// refused.
    OwnsCells,
    /// A model of the solid inside a closed boundary that uses only the nodes of the boundary.
    InsideOfBoundary,
    /// A model of gas in closed chambers.
    Gas,
    /// A model whose forces act along the edges of the mesh; pictures draw them as lines.
    Edges,
    /// The model that a world with a drag (`world.drag`) adds to every body. The first parameter of this model is the rate [1/s].
    WorldDrag,
    /// A model whose readings have the units of the published program: pixels instead of metres.
    Published,
    /// An obstacle that fills the space on one side of a plane. Its vector `normal` points out of the obstacle.
    HalfSpace,
    /// A shape that reads cells, and values of nodes, from a mesh file.
    CellsFromFile,
    /// An integrator whose steps end in an equilibrium.
    Statics,
    /// The explicit integrator that a program offers if the user has named none, or has named one without a stable step.
    OfferedExplicit,
    /// The integrator that replaces [`Role::Statics`] if a body has to move. This integrator is stable at any step.
    OfferedImplicit,
}

impl Spec {
    /// Whether it has a role.
    pub fn has_role(&self, role: Role) -> bool {
        self.roles.contains(&role)
    }
    /// The sets of fields of which exactly one must be given, each set once.
    pub fn choices(&self) -> impl Iterator<Item = &'static [&'static str]> {
        self.fields.iter().filter_map(|field| match field.default {
            Default::OneOf(set) if set.first() == Some(&field.name) => Some(set),
            _ => None,
        })
    }
}

/// One parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Field {
    /// The name in the scene file.
    pub name: &'static str,
    /// The allowed values.
    pub range: Allowed,
    /// The SI unit; empty for a plain number or word.
    pub unit: &'static str,
    /// The default.
    pub default: Default,
    /// One sentence in terms of physics.
    pub documentation: &'static str,
    /// The conditions under which it has an effect: all of them must hold.
    pub applies: &'static [Condition],
    /// The initial value in an editor if the field is not given and has no default.
    pub start: Option<f64>,
    /// Other fields that must be given together with it.
    pub companions: &'static [&'static str],
}

impl Field {
    /// A parameter from its name, allowed values, unit, default and sentence.
    pub const fn new(
        name: &'static str,
        range: Allowed,
        unit: &'static str,
        default: Default,
        documentation: &'static str,
    ) -> Field {
        Field { name, range, unit, default, documentation, applies: &[], start: None, companions: &[] }
    }
    /// The same parameter, with an effect only under these conditions.
    pub const fn applies(self, applies: &'static [Condition]) -> Field {
        Field { applies, ..self }
    }
    /// The same parameter, with this initial value in an editor.
    pub const fn starts_at(self, start: f64) -> Field {
        Field { start: Some(start), ..self }
    }
    /// The same parameter, with others that must be given together with it.
    pub const fn with(self, companions: &'static [&'static str]) -> Field {
        Field { companions, ..self }
    }
}

/// The values that a field may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Allowed {
    /// A finite number between two bounds.
    Number {
        /// The lower bound.
        least: Bound,
        /// The upper bound.
        greatest: Bound,
    },
    /// A whole number between two bounds, both allowed.
    Integer {
        /// The smallest value.
        least: i64,
        /// The largest value.
        greatest: i64,
    },
    /// `true` or `false`.
    Boolean,
    /// Any text of at most 256 bytes.
    Text,
    /// One of several words.
    Choice(&'static [&'static str]),
    /// As many finite numbers as the scene has dimensions.
    Vector,
    /// As many finite numbers as the scene has dimensions, not all zero.
    Direction,
    /// A list of points, each with as many numbers as the scene has dimensions.
    Points,
    /// A list of whole numbers not below zero.
    Integers,
    /// A list of numbers.
    Numbers,
    /// A curve over time: `[[t, value], …]`, with increasing t.
    Curve,
    /// A curve over time whose values are not negative.
    CurveNotNegative,
    /// A path over time: `[[t, x, y(, z)], …]`, with increasing t.
    Path,
}

/// One end of an interval of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// No bound, although numbers must be finite.
    None,
    /// The number itself is allowed.
    Closed(f64),
    /// The number itself is not allowed.
    Open(f64),
}

impl Allowed {
    /// Any finite number.
    pub const ANY: Allowed = Allowed::Number { least: Bound::None, greatest: Bound::None };
    /// Zero or more.
    pub const NOT_NEGATIVE: Allowed = Allowed::Number { least: Bound::Closed(0.0), greatest: Bound::None };
    /// More than zero.
    pub const POSITIVE: Allowed = Allowed::Number { least: Bound::Open(0.0), greatest: Bound::None };
    /// Between zero and one.
    pub const FRACTION: Allowed = Allowed::Number { least: Bound::Closed(0.0), greatest: Bound::Closed(1.0) };
}

/// The value of a field that is not given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Default {
    /// The field must be given.
    Required,
    /// The field stays empty.
    Absent,
    /// The field stays empty; exactly one of these fields must be given.
    OneOf(&'static [&'static str]),
    /// A number.
    Number(f64),
    /// A whole number.
    Integer(i64),
    /// A Boolean.
    Boolean(bool),
    /// A word.
    Text(&'static str),
    /// A vector of zeros.
    Origin,
}

/// The value of one field.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number in SI units.
    Number(f64),
    /// A whole number.
    Integer(i64),
    /// A Boolean.
    Boolean(bool),
    /// A text or a word.
    Text(String),
    /// A vector, or a plain list of numbers.
    Numbers(Vec<f64>),
    /// A list of whole numbers.
    Integers(Vec<u32>),
    /// A list of rows: points, a curve or a path.
    Rows(Vec<Vec<f64>>),
}

/// The values of the fields of one [`Spec`], checked and complete: defaults are filled in.
#[derive(Clone, Debug)]
pub struct Values {
    spec: &'static Spec,
    entries: Vec<(&'static str, Value)>,
}

impl PartialEq for Values {
    fn eq(&self, other: &Values) -> bool {
        self.kind() == other.kind() && self.entries == other.entries
    }
}

impl Values {
    /// The defaults of a specification; required fields stay empty until [`Values::set`] sets them.
    pub fn defaults(spec: &'static Spec, dimension: usize) -> Values {
        let mut entries = Vec::new();
        for field in spec.fields {
            let value = match field.default {
                Default::Required | Default::Absent | Default::OneOf(_) => continue,
                Default::Number(x) => Value::Number(x),
                Default::Integer(x) => Value::Integer(x),
                Default::Boolean(x) => Value::Boolean(x),
                Default::Text(x) => Value::Text(x.to_string()),
                Default::Origin => Value::Numbers(vec![0.0; dimension]),
            };
            entries.push((field.name, value));
        }
        Values { spec, entries }
    }
    /// The name of the kind.
    pub fn kind(&self) -> &'static str {
        self.spec.kind
    }
    /// Its description.
    pub fn spec(&self) -> &'static Spec {
        self.spec
    }
    /// Sets a field after checking it against its specification.
    ///
    /// # Errors
    /// A [`ValueError`] with the allowed values; the values do not change.
    pub fn set(&mut self, spec: &Spec, name: &str, value: Value, dimension: usize) -> Result<(), ValueError> {
        let Some(field) = spec.fields.iter().find(|f| f.name == name) else {
            return Err(ValueError::UnknownField {
                name: name.to_string(),
                nearest: nearest(name, spec.fields.iter().map(|f| f.name)),
            });
        };
        let value = field.range.accept(value, dimension).map_err(|(value, allowed)| ValueError::NotAllowed {
            name: name.to_string(),
            value,
            allowed,
        })?;
        match self.entries.iter_mut().find(|(n, _)| *n == name) {
            Some(entry) => entry.1 = value,
            None => self.entries.push((field.name, value)),
        }
        Ok(())
    }
    /// Sets a field like [`Values::set`]. If the field belongs to a set of which exactly one must be given, clears the other
    /// fields of the set.
    ///
    /// # Errors
    /// A [`ValueError`] with the allowed values; the values do not change.
    pub fn set_instead(&mut self, spec: &Spec, name: &str, value: Value, dimension: usize) -> Result<(), ValueError> {
        self.set(spec, name, value, dimension)?;
        for set in spec.choices().filter(|set| set.contains(&name)) {
            self.entries.retain(|(other, _)| *other == name || !set.contains(other));
        }
        Ok(())
    }
    /// The value of a field, if it has one.
    pub fn get(&self, name: &str) -> Option<&Value> {
        self.entries.iter().find(|(n, _)| *n == name).map(|(_, v)| v)
    }
    /// Every field that has a value.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, &Value)> {
        self.entries.iter().map(|(n, v)| (*n, v))
    }
    /// The number of a field, if it has one.
    pub fn number(&self, name: &str) -> Option<f64> {
        match self.get(name) {
            Some(Value::Number(x)) => Some(*x),
            Some(Value::Integer(x)) => Some(*x as f64),
            _ => None,
        }
    }
    /// The whole number of a field, if it has one.
    pub fn integer(&self, name: &str) -> Option<i64> {
        match self.get(name) {
            Some(Value::Integer(x)) => Some(*x),
            _ => None,
        }
    }
    /// The Boolean of a field; `false` if it has none.
    pub fn flag(&self, name: &str) -> bool {
        matches!(self.get(name), Some(Value::Boolean(true)))
    }
    /// The word of a field, if it has one.
    pub fn text(&self, name: &str) -> Option<&str> {
        match self.get(name) {
            Some(Value::Text(x)) => Some(x),
            _ => None,
        }
    }
    /// The numbers of a field, if it has any.
    pub fn numbers(&self, name: &str) -> Option<&[f64]> {
        match self.get(name) {
            Some(Value::Numbers(x)) => Some(x),
            _ => None,
        }
    }
    /// The vector of a field; zeros if it has none.
    pub fn vector<const D: usize>(&self, name: &str) -> [f64; D] {
        let mut out = [0.0; D];
        for (o, x) in out.iter_mut().zip(self.numbers(name).unwrap_or(&[])) {
            *o = *x;
        }
        out
    }
    /// The rows of a field; empty if it has none.
    pub fn rows(&self, name: &str) -> &[Vec<f64>] {
        match self.get(name) {
            Some(Value::Rows(x)) => x,
            _ => &[],
        }
    }
    /// The whole numbers of a field; empty if it has none.
    pub fn integers(&self, name: &str) -> &[u32] {
        match self.get(name) {
            Some(Value::Integers(x)) => x,
            _ => &[],
        }
    }
    /// Checks the sets of fields of which exactly one must be given.
    ///
    /// # Errors
    /// `model.one_of` for the first set in which no field, or more than one, is given.
    pub fn check_choices(&self, spec: &Spec) -> Result<(), BuildError> {
        match spec.choices().find(|set| set.iter().filter(|name| self.get(name).is_some()).count() != 1) {
            Some(set) => Err(BuildError::of(spec.kind, ChoiceError::OneOf { fields: quoted(set) })),
            None => Ok(()),
        }
    }
    /// The required fields that have no value yet.
    pub fn missing(&self, spec: &Spec) -> Vec<&'static str> {
        let absent = |f: &&Field| f.default == Default::Required && self.get(f.name).is_none();
        spec.fields.iter().filter(absent).map(|f| f.name).collect()
    }
}

impl Allowed {
    /// Returns the value itself if it is allowed.
    ///
    /// # Errors
    /// The offending value and the allowed values, in words.
    pub fn accept(&self, value: Value, dimension: usize) -> Result<Value, (String, AllowedValues)> {
        let refuse = |v: &Value| Err((v.to_string(), self.describe(dimension)));
        let rows_ok = |rows: &[Vec<f64>], length: usize| {
            !rows.is_empty() && rows.iter().all(|r| r.len() == length && r.iter().all(|x| x.is_finite()))
        };
        let rising = |rows: &[Vec<f64>]| rows.windows(2).all(|w| w[0][0] < w[1][0]);
        match (self, &value) {
            (Allowed::Number { least, greatest }, Value::Number(_) | Value::Integer(_)) => {
                let x = match value {
                    Value::Integer(i) => i as f64,
                    Value::Number(x) => x,
                    _ => f64::NAN,
                };
                let low = match least {
                    Bound::None => true,
                    Bound::Closed(b) => x >= *b,
                    Bound::Open(b) => x > *b,
                };
                let high = match greatest {
                    Bound::None => true,
                    Bound::Closed(b) => x <= *b,
                    Bound::Open(b) => x < *b,
                };
                if x.is_finite() && low && high { Ok(Value::Number(x + 0.0)) } else { refuse(&value) }
            }
            (Allowed::Integer { least, greatest }, Value::Integer(i)) if i >= least && i <= greatest => Ok(value),
            (Allowed::Boolean, Value::Boolean(_)) => Ok(value),
            (Allowed::Text, Value::Text(t)) if t.len() <= 256 => Ok(value),
            (Allowed::Choice(words), Value::Text(t)) if words.contains(&t.as_str()) => Ok(value),
            (Allowed::Vector, Value::Numbers(v)) if v.len() == dimension && v.iter().all(|x| x.is_finite()) => {
                Ok(value)
            }
            (Allowed::Direction, Value::Numbers(v))
                if v.len() == dimension && v.iter().all(|x| x.is_finite()) && v.iter().any(|x| *x != 0.0) =>
            {
                Ok(value)
            }
            (Allowed::Numbers, Value::Numbers(v)) if v.iter().all(|x| x.is_finite()) => Ok(value),
            (Allowed::Integers, Value::Integers(_)) => Ok(value),
            (Allowed::Points, Value::Rows(rows)) if rows_ok(rows, dimension) => Ok(value),
            (Allowed::Curve, Value::Rows(rows)) if rows_ok(rows, 2) && rising(rows) => Ok(value),
            (Allowed::CurveNotNegative, Value::Rows(rows))
                if rows_ok(rows, 2) && rising(rows) && rows.iter().all(|row| row[1] >= 0.0) =>
            {
                Ok(value)
            }
            (Allowed::Path, Value::Rows(rows)) if rows_ok(rows, dimension + 1) && rising(rows) => Ok(value),
            _ => refuse(&value),
        }
    }
}

impl core::fmt::Display for Value {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Value::Number(x) => write!(f, "{x}"),
            Value::Integer(x) => write!(f, "{x}"),
            Value::Boolean(x) => write!(f, "{x}"),
            Value::Text(x) => write!(f, "\"{}\"", x.escape_debug()),
            Value::Numbers(x) => write!(f, "{x:?}"),
            Value::Integers(x) => write!(f, "{x:?}"),
            Value::Rows(x) => write!(f, "{x:?}"),
        }
    }
}
