//! Values of plain fields: types are never converted, numbers are finite, and rows have the required length.

use super::errors::{FieldError, SceneAllowed, SceneHint};
use super::reader::{Reader, join};
use crate::document::{Data, Node};
use crate::problem::{SceneError, visible};
use opruga_core::spec::{Allowed, Value, nearest};
use opruga_math::message::AnyMessage;
use opruga_world::schema::LARGEST_WHOLE;

/// The last name of a path that is not an index.
fn name_of(path: &str) -> String {
    visible(path.rsplit('.').find(|part| part.parse::<usize>().is_err()).unwrap_or(path))
}

/// Larger angles are rounded by more than 1e-10 [rad].
const LARGEST_ANGLE: f64 = 1e6;

impl Reader<'_> {
    /// Reads the value of a field, or reports its errors.
    pub(crate) fn plain(&mut self, node: &Node, path: &str, name: &str, range: &Allowed) -> Option<Value> {
        let value = match range {
            Allowed::Number { .. } => Value::Number(self.number(node, path, range)?),
            Allowed::Integer { .. } => Value::Integer(self.integer(node, path, range)?),
            Allowed::Boolean => match node.data {
                Data::Boolean(x) => Value::Boolean(x),
                _ => return self.refuse_type(node, path, range),
            },
            Allowed::Text => match &node.data {
                Data::Text(text) => Value::Text(text.clone()),
                _ => return self.refuse_type(node, path, range),
            },
            Allowed::Choice(words) => match &node.data {
                Data::Text(text) if words.contains(&text.as_str()) => Value::Text(text.clone()),
                Data::Text(text) => {
                    let about = FieldError::Word { field: name.into(), value: node.shown() };
                    let closest = nearest(text, words.iter().copied());
                    let error =
                        SceneError::of(about).path(path).allows(range.describe(self.dimension)).nearest(closest);
                    self.report(node.location, error);
                    return None;
                }
                _ => return self.refuse_type(node, path, range),
            },
            Allowed::Vector => Value::Numbers(self.row(node, path, self.dimension, range)?),
            Allowed::Direction => {
                let row = self.row(node, path, self.dimension, range)?;
                if row.iter().all(|x| *x == 0.0) {
                    let about = FieldError::Is { field: name.into(), value: node.shown() };
                    let error = SceneError::of(about).path(path).allows(range.describe(self.dimension));
                    self.report(node.location, error);
                    return None;
                }
                Value::Numbers(row)
            }
            Allowed::Numbers => match &node.data {
                Data::Array(items) => Value::Numbers(self.row(node, path, items.len(), range)?),
                _ => return self.refuse_type(node, path, range),
            },
            Allowed::Integers => Value::Integers(self.naturals(node, path, range)?),
            Allowed::Points => Value::Rows(self.rows(node, path, self.dimension, false, range)?),
            Allowed::Curve | Allowed::CurveNotNegative => Value::Rows(self.rows(node, path, 2, true, range)?),
            Allowed::Path => Value::Rows(self.rows(node, path, self.dimension + 1, true, range)?),
        };
        match range.accept(value, self.dimension) {
            Ok(value) => Some(value),
            Err((_, allowed)) => {
                let field = if name.is_empty() { name_of(path) } else { name.into() };
                let error = SceneError::of(FieldError::Is { field, value: node.shown() });
                self.report(node.location, error.path(path).allows(allowed));
                None
            }
        }
    }

    fn refuse_type<T>(&mut self, node: &Node, path: &str, range: &Allowed) -> Option<T> {
        let about = FieldError::Type { field: name_of(path), kind: node.kind(), value: node.shown() };
        let mut error = SceneError::of(about).path(visible(path)).allows(range.describe(self.dimension));
        if let Data::Text(text) = &node.data
            && !matches!(range, Allowed::Choice(_) | Allowed::Text)
            && (text.trim().parse::<f64>().is_ok() || text == "true" || text == "false")
        {
            error = error.advice(SceneHint::NoQuotes {});
        }
        self.report(node.location, error);
        None
    }

    /// Reads a finite number; −0 becomes 0.
    pub(crate) fn number(&mut self, node: &Node, path: &str, range: &Allowed) -> Option<f64> {
        match &node.data {
            Data::Number(x, text) if !x.is_finite() => {
                let (field, value) = (name_of(path), node.shown());
                let about = match text.contains("nan") || text.contains("inf") {
                    true => FieldError::NotFiniteField { field, value },
                    false => FieldError::TooLarge { field, value },
                };
                let error = SceneError::of(about).path(path).allows(range.describe(self.dimension));
                self.report(node.location, error);
                None
            }
            Data::Number(x, _) => Some(*x + 0.0),
            Data::Integer(..) => self.whole_for_real(node, path).map(|x| x as f64),
            _ => self.refuse_type(node, path, range),
        }
    }

    fn integer(&mut self, node: &Node, path: &str, range: &Allowed) -> Option<i64> {
        match &node.data {
            Data::Integer(Some(x), _) if x.abs() <= LARGEST_WHOLE => Some(*x),
            // A decimal point would change the type, but would not bring the number into the range.
            Data::Integer(..) => self.whole(node, path, range.describe(self.dimension).into(), None),
            _ => self.refuse_type(node, path, range),
        }
    }

    /// Reads a whole number in a field that accepts any number.
    fn whole_for_real(&mut self, node: &Node, path: &str) -> Option<i64> {
        self.whole(node, path, SceneAllowed::Wholes {}.into(), Some(SceneHint::DecimalPoint {}))
    }

    /// Reads a whole number that a 64-bit float can represent exactly.
    fn whole(&mut self, node: &Node, path: &str, allowed: AnyMessage, hint: Option<SceneHint>) -> Option<i64> {
        match &node.data {
            Data::Integer(Some(x), _) if x.unsigned_abs() <= LARGEST_WHOLE as u64 => Some(*x),
            _ => {
                let about = FieldError::Is { field: name_of(path), value: node.shown() };
                let error = SceneError::of(about).path(path).allows(allowed);
                self.report(node.location, hint.map_or(error.clone(), |hint| error.advice(hint)));
                None
            }
        }
    }

    /// Reads a list of exactly `length` finite numbers.
    pub(crate) fn row(&mut self, node: &Node, path: &str, length: usize, range: &Allowed) -> Option<Vec<f64>> {
        let Data::Array(items) = &node.data else { return self.refuse_type(node, path, range) };
        if items.len() != length {
            let about = FieldError::Length { field: name_of(path), count: items.len(), value: node.shown() };
            let error = SceneError::of(about).path(path).allows(range.describe(self.dimension));
            self.report(node.location, error);
            return None;
        }
        let before = self.count();
        let numbers: Vec<f64> = items
            .iter()
            .enumerate()
            .filter_map(|(k, item)| self.number(item, &join(path, &k.to_string()), &Allowed::ANY))
            .collect();
        (self.count() == before).then_some(numbers)
    }

    /// Reads rows of equal length. In a curve or path, the first number of each row is an increasing time.
    pub(crate) fn rows(
        &mut self,
        node: &Node,
        path: &str,
        length: usize,
        rising: bool,
        range: &Allowed,
    ) -> Option<Vec<Vec<f64>>> {
        let Data::Array(items) = &node.data else { return self.refuse_type(node, path, range) };
        let before = self.count();
        let mut rows: Vec<Vec<f64>> = Vec::with_capacity(items.len());
        for (k, item) in items.iter().enumerate() {
            let here = join(path, &k.to_string());
            let Some(row) = self.row(item, &here, length, range) else { continue };
            if rising
                && let Some(last) = rows.last()
                && row[0] <= last[0]
            {
                let about = FieldError::NotRising { time: row[0], before: last[0], value: item.shown() };
                let error = SceneError::of(about).path(here).allows(range.describe(self.dimension));
                self.report(item.location, error);
            }
            rows.push(row);
        }
        (self.count() == before).then_some(rows)
    }

    /// Reads a list of non-negative whole numbers.
    pub(crate) fn naturals(&mut self, node: &Node, path: &str, range: &Allowed) -> Option<Vec<u32>> {
        let Data::Array(items) = &node.data else { return self.refuse_type(node, path, range) };
        if items.len() > 1 && items.iter().all(|item| matches!(item.data, Data::Array(_))) {
            // Gives one error instead of one per triangle.
            let name = path.rsplit('.').next().unwrap_or(path);
            let about = FieldError::Lists { field: visible(name), value: node.shown() };
            let error = SceneError::of(about).path(path).allows(range.describe(self.dimension));
            self.report(node.location, error);
            return None;
        }
        let before = self.count();
        let numbers =
            items.iter().enumerate().filter_map(|(k, item)| self.natural(item, &join(path, &k.to_string()))).collect();
        (self.count() == before).then_some(numbers)
    }

    /// Reads a non-negative whole number.
    pub(crate) fn natural(&mut self, node: &Node, path: &str) -> Option<u32> {
        let range = Allowed::Integer { least: 0, greatest: i64::from(u32::MAX) };
        match self.plain(node, path, &name_of(path), &range)? {
            Value::Integer(x) => u32::try_from(x).ok(),
            _ => None,
        }
    }

    /// Reads a rotation: one number in 2D, three in 3D.
    pub(crate) fn turn(&mut self, node: Option<&Node>, path: &str) -> Vec<f64> {
        let parts = if self.dimension == 2 { 1 } else { 3 };
        let zero = vec![0.0; parts];
        let Some(node) = node else { return zero };
        let before = self.errors.len();
        let read = match parts {
            1 => self.number(node, path, &Allowed::ANY).map(|x| vec![x]),
            _ => self.row(node, path, 3, &Allowed::Vector),
        };
        let spins = path.ends_with("velocity") || path.ends_with("angular");
        for k in before..self.errors.len() {
            let (allowed, example) = match (parts, spins) {
                (1, false) => (SceneAllowed::Angle {}, SceneHint::QuarterTurn {}),
                (1, true) => (SceneAllowed::Spin {}, SceneHint::QuarterTurn {}),
                (_, false) => (SceneAllowed::AngleInSpace {}, SceneHint::TurnsInSpace {}),
                (_, true) => (SceneAllowed::SpinInSpace {}, SceneHint::SpinsInSpace {}),
            };
            self.errors[k] = self.errors[k].clone().allows(allowed).advice(example);
        }
        let angle = read.iter().flatten().map(|x| x.abs()).fold(0.0, |most: f64, x| if x > most { x } else { most });
        if !spins && angle > LARGEST_ANGLE {
            self.report(node.location, SceneError::of(FieldError::Angle { value: node.shown() }).path(path));
            return zero;
        }
        read.unwrap_or(zero)
    }

    /// Reads the value of a `set` command: any plain value, to be checked against its parameter later.
    pub(crate) fn any_value(&mut self, node: &Node, path: &str) -> Option<Value> {
        match &node.data {
            Data::Integer(..) => self.whole_for_real(node, path).map(Value::Integer),
            Data::Number(..) => self.number(node, path, &Allowed::ANY).map(Value::Number),
            Data::Boolean(x) => Some(Value::Boolean(*x)),
            Data::Text(text) => Some(Value::Text(text.clone())),
            Data::Array(items) if items.iter().any(|i| matches!(i.data, Data::Array(_))) => {
                let length = items
                    .iter()
                    .map(|i| if let Data::Array(row) = &i.data { row.len() } else { 0 })
                    .next()
                    .unwrap_or(0);
                self.rows(node, path, length, false, &Allowed::Points).map(Value::Rows)
            }
            Data::Array(items) => self.row(node, path, items.len(), &Allowed::Numbers).map(Value::Numbers),
            _ => self.refuse_type(node, path, &Allowed::ANY),
        }
    }
}
