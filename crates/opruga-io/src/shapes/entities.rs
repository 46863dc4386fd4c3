//! The length of a drawing with its entities expanded, which is computed before they are expanded.

use crate::budget::{EXPANSION, LimitHint};
use crate::problem::SceneError;
use crate::source::Source;
use std::collections::BTreeMap;

/// The deepest nesting of entities; the XML reader refuses more.
const DEEPEST: usize = 10;

/// Refuses a text that its entities would make much longer, for example with four thousand repetitions of a path that itself consists of four
/// thousand squares.
///
/// External entities and entities that contain themselves are left to the XML reader, which refuses them.
pub(super) fn check(source: &Source<'_>) -> Result<(), SceneError> {
    let text = source.text;
    let Some(begin) = text.find("<!DOCTYPE") else { return Ok(()) };
    // The end of the declarations is not searched for: at worst, a reference within them is counted once too often.
    let mut entities: BTreeMap<&str, &str> = BTreeMap::new();
    let mut at = begin;
    while let Some(place) = text[at..].find("<!ENTITY") {
        at += place + "<!ENTITY".len();
        let rest = text[at..].trim_start();
        let Some((name, after)) = rest.split_once(|c: char| c.is_ascii_whitespace()) else { break };
        let after = after.trim_start();
        let Some(quote) = after.chars().next().filter(|c| matches!(c, '"' | '\'')) else { continue };
        let Some((value, _)) = after[1..].split_once(quote) else { break };
        // If there are two declarations, the first one counts.
        entities.entry(name).or_insert(value);
        at = value.as_ptr() as usize - text.as_ptr() as usize + value.len();
    }
    if entities.is_empty() {
        return Ok(());
    }
    let lengths = written_out(&entities);
    let mut total = 0u64;
    for (place, name) in references(text) {
        total = total.saturating_add(lengths.get(name).copied().unwrap_or(0));
        EXPANSION.check(total).map_err(|error| {
            let error = source.mark(error, place, place + name.len() + 2);
            error.advice(LimitHint::Entities)
        })?;
    }
    Ok(())
}

/// The length of each entity including those that it contains, level by level.
fn written_out<'a>(entities: &BTreeMap<&'a str, &'a str>) -> BTreeMap<&'a str, u64> {
    let inner: Vec<(&str, u64, Vec<&str>)> = entities
        .iter()
        .map(|(name, text)| (*name, text.len() as u64, references(text).map(|(_, inner)| inner).collect()))
        .collect();
    let mut lengths: BTreeMap<&str, u64> = inner.iter().map(|(name, own, _)| (*name, *own)).collect();
    for _ in 0..DEEPEST {
        let with_inner = |(name, own, inner): &(&'a str, u64, Vec<&str>)| {
            let of = |name: &&str| lengths.get(name).copied().unwrap_or(0);
            (*name, inner.iter().fold(*own, |sum, name| sum.saturating_add(of(name))))
        };
        lengths = inner.iter().map(with_inner).collect();
    }
    lengths
}

/// The names of entities in a text, with their positions.
fn references(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.match_indices('&').filter_map(|(place, _)| {
        let name = &text[place + 1..];
        let end = name.find(|c: char| c == ';' || c == '&' || c == '<' || c == '"' || c.is_ascii_whitespace())?;
        (name[end..].starts_with(';') && !name.starts_with('#')).then(|| (place, &name[..end]))
    })
}
