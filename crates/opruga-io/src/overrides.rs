//! `--set PATH=VALUE`: changes parameters of a scene before it is checked.
//!
//! PATH is the position of the field in the scene file, with dots between its parts: `time.substeps`, `world.gravity`, `integrator.kind`,
//! `body.ball.mass`, `body.0.models.mass_spring.stiffness`, `seed`. An entry of a list is named by its number, its `name` or its `kind`.

use crate::document::{self, Data, Entry, Location, Node};
use crate::problem::{SceneError, visible};
use crate::text_errors::{OverrideError, TextHint};
use opruga_core::spec::nearest;

/// Splits `PATH=VALUE`.
///
/// # Errors
/// `set.syntax` if there is no `=` or no path.
pub fn split(argument: &str) -> Result<(String, String), SceneError> {
    match argument.split_once('=') {
        Some((path, value)) if !path.trim().is_empty() => Ok((path.trim().to_string(), value.trim().to_string())),
        _ => Err(SceneError::of(OverrideError::NoOverride { argument: visible(argument) })),
    }
}

/// An override as the location of an error.
pub(crate) fn named(path: &str, value: &str) -> String {
    format!("--set {}={}", visible(path), visible(value))
}

/// Applies all overrides in their order.
pub(crate) fn apply_all(root: &mut Node, overrides: &[(String, String)]) -> Result<(), Vec<SceneError>> {
    let mut errors = Vec::new();
    for (number, (path, value)) in overrides.iter().enumerate() {
        if let Err(error) = apply(root, path, value, number) {
            errors.push(SceneError { file: named(path, value), ..error });
        }
    }
    if errors.is_empty() { Ok(()) } else { Err(errors) }
}

fn apply(root: &mut Node, path: &str, value: &str, number: usize) -> Result<(), SceneError> {
    if value.is_empty() {
        return Err(SceneError::of(OverrideError::NoValue {}).path(path));
    }
    let value = document::parse_value(value, number).map_err(|error| {
        let error = error.path(path).value(visible(value));
        if error.code != "set.value" {
            return error;
        }
        let several = value.contains(',') || value.contains("..");
        if several && !value.contains(['[', '{', '"', '\'']) {
            let reason = error.about.as_ref().and_then(|about| about.fields().into_iter().next());
            let reason = reason.map_or(String::new(), |(_, reason)| reason.to_string());
            let several = SceneError::of(OverrideError::SeveralValues { reason }).path(path).value(visible(value));
            return several.advice(TextHint::Sweep {});
        }
        error.advice(TextHint::Quotes {})
    })?;
    let parts: Vec<&str> = path.split('.').collect();
    if parts.len() > 32 || parts.iter().any(|p| p.is_empty()) {
        return Err(SceneError::of(OverrideError::Path { path: visible(path) }).path(visible(path)));
    }
    set(root, &parts, "", value, number)
}

/// Follows the path and sets the value. Missing tables are created; entries of lists must exist.
fn set(node: &mut Node, parts: &[&str], walked: &str, value: Node, number: usize) -> Result<(), SceneError> {
    let Some((head, rest)) = parts.split_first() else {
        *node = value;
        return Ok(());
    };
    let here = if walked.is_empty() { (*head).to_string() } else { format!("{walked}.{head}") };
    let shown = visible(&here);
    match &mut node.data {
        Data::Table(entries) => {
            let location = Location::Override(number);
            let k = entries.iter().position(|e| e.key == *head).unwrap_or_else(|| {
                let empty = Node { location, data: Data::Table(Vec::new()) };
                entries.push(Entry { key: (*head).to_string(), location, value: empty });
                entries.len() - 1
            });
            set(&mut entries[k].value, rest, &here, value, number)
        }
        Data::Array(items) => {
            let label = |item: &Node| {
                item.get("name")
                    .or_else(|| item.get("kind"))
                    .or_else(|| item.get("do"))
                    .and_then(Node::text)
                    .map(str::to_string)
            };
            if let Ok(k) = head.parse::<usize>() {
                let count = items.len();
                return match items.get_mut(k) {
                    Some(item) => set(item, rest, &here, value, number),
                    None => {
                        let list = visible(walked);
                        let error = SceneError::of(match count {
                            0 => OverrideError::EmptyList { list, index: k.to_string() },
                            count => OverrideError::NoEntry { list, index: k, last: count - 1 },
                        });
                        Err(error.path(shown))
                    }
                };
            }
            let matching: Vec<usize> =
                (0..items.len()).filter(|k| label(&items[*k]).as_deref() == Some(*head)).collect();
            match matching.as_slice() {
                [k] => set(&mut items[*k], rest, &here, value, number),
                [] => {
                    let labels: Vec<String> = items.iter().filter_map(label).collect();
                    let known = labels.iter().take(20).map(|l| visible(l)).collect::<Vec<_>>().join(", ");
                    let (list, name) = (visible(walked), visible(head));
                    let about = match known.is_empty() {
                        true => OverrideError::EmptyList { list, index: format!("`{name}`") },
                        false => OverrideError::NoEntryCalled { list, name, known },
                    };
                    let near = nearest(head, labels.iter().map(String::as_str));
                    Err(SceneError::of(about).path(shown).value(visible(head)).nearest(near))
                }
                several => {
                    let (list, count, indices) = (visible(walked), several.len(), format!("{several:?}"));
                    let about = OverrideError::SeveralEntries { list, count, name: visible(head), indices };
                    Err(SceneError::of(about).path(shown))
                }
            }
        }
        _ => {
            let about = OverrideError::NoFields { value: visible(walked), kind: node.kind(), field: visible(head) };
            Err(SceneError::of(about).path(shown))
        }
    }
}
