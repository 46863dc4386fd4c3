//! A parsed scene as a tree of values, each with the location where it was written.

use crate::brackets::unclosed;
use crate::limits::Limits;
use crate::problem::{MOST_SHOWN, SceneError, visible};
use crate::scene::errors::ValueKind;
use crate::source::Source;
use crate::text_errors::{OverrideError, TextError, TextHint};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Where a value was written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Location {
    /// The range of bytes in the scene.
    Bytes(usize, usize),
    /// In the override with this number.
    Override(usize),
}

/// A value and its location.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    pub(crate) location: Location,
    pub(crate) data: Data,
}

/// A value.
#[derive(Clone, Debug)]
pub(crate) enum Data {
    Table(Vec<Entry>),
    Array(Vec<Node>),
    Text(String),
    /// A whole number; none if it does not fit into 64 bits.
    Integer(Option<i64>, String),
    /// A number as it was written; it may not be finite.
    Number(f64, String),
    Boolean(bool),
    Date(String),
}

/// A key and its value.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    pub(crate) key: String,
    pub(crate) location: Location,
    pub(crate) value: Node,
}

impl Node {
    pub(crate) fn entries(&self) -> &[Entry] {
        match &self.data {
            Data::Table(entries) => entries,
            _ => &[],
        }
    }
    pub(crate) fn entry(&self, key: &str) -> Option<&Entry> {
        self.entries().iter().find(|e| e.key == key)
    }
    pub(crate) fn get(&self, key: &str) -> Option<&Node> {
        self.entry(key).map(|e| &e.value)
    }
    pub(crate) fn text(&self) -> Option<&str> {
        match &self.data {
            Data::Text(text) => Some(text),
            _ => None,
        }
    }
    /// The type of the value, in words.
    pub(crate) fn kind(&self) -> ValueKind {
        match &self.data {
            Data::Table(_) => ValueKind::Table,
            Data::Array(_) => ValueKind::List,
            Data::Text(_) => ValueKind::Text,
            Data::Integer(..) => ValueKind::Whole,
            Data::Number(..) => ValueKind::Number,
            Data::Boolean(_) => ValueKind::Truth,
            Data::Date(_) => ValueKind::Date,
        }
    }
    /// The value as a short text for messages.
    pub(crate) fn shown(&self) -> String {
        match &self.data {
            Data::Table(entries) if entries.is_empty() => "{}".into(),
            Data::Table(_) => "{ … }".into(),
            Data::Array(items) if items.len() <= 4 => {
                format!("[{}]", items.iter().map(Node::shown).collect::<Vec<_>>().join(", "))
            }
            Data::Array(items) => format!("a list of {}", items.len()),
            Data::Text(text) => format!("\"{}\"", visible(text)),
            Data::Integer(_, text) | Data::Number(_, text) | Data::Date(text) => visible(text),
            Data::Boolean(x) => x.to_string(),
        }
    }
}

/// Parses a scene. A syntax error stops parsing; a key that occurs twice is reported, and its first value is used.
pub(crate) fn parse(source: &Source<'_>) -> (Option<Node>, Vec<SceneError>) {
    let (table, problems) = DeTable::parse_recoverable(source.text);
    let end = table.span().end;
    let root = table_node(table.into_inner(), Location::Bytes(0, end.min(1)));
    let mut errors: Vec<SceneError> = Vec::new();
    let (mut broken, mut broken_line) = (false, None);
    let mut problems: Vec<_> = problems.iter().collect();
    problems.sort_by_key(|problem| problem.span().map_or(0, |span| span.start));
    let (open, mut reported) = (if problems.is_empty() { None } else { unclosed(source.text) }, false);
    let count = problems.len();
    for problem in problems.into_iter().take(MOST_SHOWN) {
        let span = problem.span().unwrap_or(0..0);
        // An unclosed bracket causes errors in all text after it. It is a single mistake, so only one error is reported.
        if let Some(open) = open.filter(|open| span.start >= open.open) {
            if !std::mem::replace(&mut reported, true) {
                let (line, until) = (source.position(open.open).0, source.position(open.until).0);
                let about = match open.wanted {
                    ']' => TextError::OpenList { line },
                    _ => TextError::OpenTable { line },
                };
                // If the parser reports its first error before the next part, the bracket is missing there. Otherwise the location is that of the
                // open bracket.
                let location = if span.start < open.until { span.start } else { open.open };
                let bracket = open.wanted;
                let hint = match location == open.open {
                    true => TextHint::BracketBefore { bracket, line: until },
                    false => TextHint::BracketHere { bracket },
                };
                errors.push(source.mark(SceneError::of(about).advice(hint), location, location + 1));
            }
            broken = true;
            continue;
        }
        if problem.message() == "duplicate key" {
            errors.push(duplicate(source, &root, span.start, span.end));
            continue;
        }
        // An error also causes errors in the lines after it, up to the next valid line. They are not reported.
        let line = source.position(span.start).0;
        let structure = FOLLOW.iter().any(|what| problem.message().starts_with(what));
        let follows = broken_line.is_some_and(|before| line == before || line == before + 1 && structure);
        broken_line = Some(line);
        broken = true;
        if follows {
            continue;
        }
        let empty = span.is_empty()
            && source.text.get(..span.start).is_some_and(|t| t.trim_end_matches([' ', '\t']).ends_with('='));
        let error = SceneError::of(match empty {
            true => TextError::NoValue {},
            false => TextError::Syntax { reason: problem.message().replace(", expected nothing", "") },
        });
        let hint = source.text.lines().nth(line - 1).and_then(|text| with_unit(text.split_once('=')?.1));
        let error = hint.map_or(error.clone(), |hint| error.advice(hint));
        errors.push(source.mark(error, span.start, span.end));
    }
    if count > MOST_SHOWN {
        errors.push(SceneError { file: source.file.to_string(), ..SceneError::and_more(count - MOST_SHOWN) });
    }
    (if broken { None } else { Some(root) }, errors)
}

/// Errors of the parser that only follow from an error in the previous line.
const FOLLOW: [&str; 3] = ["invalid key-value pair", "missing table open", "key with no value"];

/// A hint if the value is a number followed by a unit.
fn with_unit(value: &str) -> Option<TextHint> {
    let value = value.split('#').next().unwrap_or(value).trim();
    let end = value.find(|c: char| !(c.is_ascii_digit() || "+-._eE".contains(c)))?;
    let (number, unit) = (value[..end].trim_end_matches(['e', 'E']), value[end..].trim());
    let known = number.parse::<f64>().is_ok() && !unit.is_empty() && unit.len() <= 12;
    let known = known && unit.chars().next().is_some_and(char::is_alphabetic);
    known.then(|| TextHint::Unit { bare: number.into() })
}

/// The error for a key that is written a second time; it names the first location.
fn duplicate(source: &Source<'_>, root: &Node, start: usize, end: usize) -> SceneError {
    let word = source.text.get(start..end).unwrap_or("").trim_matches(['"', '\'']);
    let mut first = None;
    last_before(root, word, start, &mut first);
    let (line, _) = source.position(start);
    let key = visible(word);
    let error = SceneError::of(match first.map(|at| source.position(at).0) {
        Some(other) if other != line => TextError::TwiceInLines { key, line: other },
        _ => TextError::Twice { key },
    });
    source.mark(error.path(word), start, end)
}

/// Finds the last key of this name that is written before a byte.
fn last_before(node: &Node, word: &str, before: usize, best: &mut Option<usize>) {
    match &node.data {
        Data::Table(entries) => {
            for entry in entries {
                if let Location::Bytes(at, _) = entry.location
                    && entry.key == word
                    && at < before
                    && best.is_none_or(|b| at > b)
                {
                    *best = Some(at);
                }
                last_before(&entry.value, word, before, best);
            }
        }
        Data::Array(items) => items.iter().for_each(|item| last_before(item, word, before, best)),
        _ => {}
    }
}

fn table_node(table: DeTable<'_>, location: Location) -> Node {
    let entries = table
        .into_iter()
        .map(|(key, value)| {
            let span = key.span();
            Entry {
                key: key.into_inner().into_owned(),
                location: Location::Bytes(span.start, span.end),
                value: node(value),
            }
        })
        .collect();
    Node { location, data: Data::Table(entries) }
}

fn node(value: Spanned<DeValue<'_>>) -> Node {
    let span = value.span();
    let location = Location::Bytes(span.start, span.end);
    let data = match value.into_inner() {
        DeValue::Table(table) => return table_node(table, location),
        DeValue::Array(items) => Data::Array(items.into_iter().map(node).collect()),
        DeValue::String(text) => Data::Text(text.into_owned()),
        DeValue::Integer(x) => {
            let text = match x.radix() {
                16 => format!("0x{}", x.as_str()),
                8 => format!("0o{}", x.as_str()),
                2 => format!("0b{}", x.as_str()),
                _ => x.as_str().to_string(),
            };
            Data::Integer(i64::from_str_radix(x.as_str(), x.radix()).ok(), text)
        }
        DeValue::Float(x) => {
            let number = match x.as_str() {
                "inf" | "+inf" => f64::INFINITY,
                "-inf" => f64::NEG_INFINITY,
                text => text.parse().unwrap_or(f64::NAN),
            };
            Data::Number(number, x.as_str().to_string())
        }
        DeValue::Boolean(x) => Data::Boolean(x),
        DeValue::Datetime(x) => Data::Date(x.to_string()),
    };
    Node { location, data }
}

/// Parses the value of an override: a TOML value or a bare word. The value has the same limits of depth and size as a value in a scene.
///
/// # Errors
/// `set.value`, `scene.depth` or `scene.too_large`, without a location.
pub(crate) fn parse_value(text: &str, number: usize) -> Result<Node, SceneError> {
    let trimmed = text.trim();
    Source::check_value(trimmed, &Limits::default())?;
    let (parsed, errors) = DeValue::parse_recoverable(trimmed);
    let mut value = if errors.is_empty() {
        node(parsed)
    } else if !trimmed.is_empty()
        && trimmed.chars().all(|c| c.is_alphanumeric() || "_-./[]".contains(c))
        && trimmed.starts_with(char::is_alphabetic)
    {
        Node { location: Location::Override(number), data: Data::Text(trimmed.to_string()) }
    } else {
        let reason = errors.first().map(|e| e.message().to_string()).unwrap_or_default();
        return Err(SceneError::of(OverrideError::Value { reason }));
    };
    set_location(&mut value, Location::Override(number));
    Ok(value)
}

fn set_location(node: &mut Node, location: Location) {
    node.location = location;
    match &mut node.data {
        Data::Table(entries) => entries.iter_mut().for_each(|e| {
            e.location = location;
            set_location(&mut e.value, location);
        }),
        Data::Array(items) => items.iter_mut().for_each(|item| set_location(item, location)),
        _ => {}
    }
}
