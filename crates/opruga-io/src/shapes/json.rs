//! JSON with the location of each value in the file.

use super::drawing_errors::MapError;
use crate::problem::{SceneError, visible};
use crate::source::Source;
use serde::Deserialize;
use serde_json::value::RawValue;

/// A value as it is written in the file, parsed when it is needed.
pub(super) type Raw<'a> = &'a RawValue;

/// The range of a value in the text of its file.
pub(super) fn span(source: &Source<'_>, raw: &str) -> (usize, usize) {
    let from = (raw.as_ptr() as usize).saturating_sub(source.text.as_ptr() as usize);
    (from, from + raw.len())
}

/// Parses a value of some type.
///
/// # Errors
/// `json.syntax` with line and column.
pub(super) fn parse<'a, T: Deserialize<'a>>(source: &Source<'_>, raw: &'a str) -> Result<T, SceneError> {
    serde_json::from_str(raw).map_err(|e| {
        // The library gives lines and columns (in bytes) relative to the value.
        let line = raw.split_inclusive('\n').take(e.line().saturating_sub(1)).map(str::len).sum::<usize>();
        let at = span(source, raw).0 + (line + e.column().saturating_sub(1)).min(raw.len().saturating_sub(1));
        let text = e.to_string();
        let message = text.rsplit_once(" at line ").map_or(text.as_str(), |(message, _)| message);
        let found: String = source.text.get(at..).unwrap_or("").chars().take(12).collect();
        let (reason, found) = (visible(message), visible(&found));
        source.mark(SceneError::of(MapError::Json { reason, found }), at, at + 1)
    })
}

/// An error at a value.
pub(super) fn refuse(source: &Source<'_>, raw: &str, error: SceneError) -> SceneError {
    let (from, end) = span(source, raw);
    let shown: String = raw.chars().take(40).collect();
    let value = error.value.clone().unwrap_or_else(|| visible(&shown));
    source.mark(error, from, end).value(value)
}
