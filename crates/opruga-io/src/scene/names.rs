//! Names that are the same, or look the same in print.

use crate::problem::{SceneError, visible};
use opruga_world::validity::NameFault;
use std::collections::BTreeMap;

/// What a name belongs to.
#[derive(Clone, Copy)]
pub(super) enum What {
    Bodies,
    Probes,
}

/// The names that bodies, or probes, have so far. `é` is one character (U+00E9) or two (U+0065 U+0301), which look the same in print. Two bodies
/// whose names differ only in this could not be told apart, so both forms count as the same name.
pub(super) struct Names<P> {
    what: What,
    /// The decomposed form (NFD) of a name → the first name with that form as it was written, and its location.
    seen: BTreeMap<String, (String, P)>,
}

impl<P> Names<P> {
    /// Makes an empty list of names.
    pub(super) fn of(what: What) -> Names<P> {
        Names { what, seen: BTreeMap::new() }
    }

    /// Adds a name. If the name exists already, or looks like an existing name in print, returns an error that contains the name. `line` returns the
    /// line of the existing name, if it has one.
    pub(super) fn take(
        &mut self,
        name: &str,
        location: P,
        line: impl FnOnce(&P) -> Option<usize>,
    ) -> Option<SceneError> {
        let form: String = crate::canonical::decomposed(name);
        let Some((first, at)) = self.seen.get(&form) else {
            self.seen.insert(form, (name.to_string(), location));
            return None;
        };
        let (same, line, own) = (first == name, line(at), visible(name));
        let (here, there) = (code_points(name, first), code_points(first, name));
        let name = own;
        Some(SceneError::of(match (self.what, same) {
            (What::Bodies, true) => NameFault::TwoBodies { name, line },
            (What::Probes, true) => NameFault::TwoProbes { name, line },
            (What::Bodies, false) => NameFault::AlikeBodies { name, here, there, line },
            (What::Probes, false) => NameFault::AlikeProbes { name, here, there, line },
        }))
    }
}

/// The part of a name in which it differs from another one, from the first differing character to the last, as code points; none if there is no such
/// part.
fn code_points(name: &str, other: &str) -> Option<String> {
    let (own, others): (Vec<char>, Vec<char>) = (name.chars().collect(), other.chars().collect());
    let before = own.iter().zip(&others).take_while(|(a, b)| a == b).count();
    let left = own.len().min(others.len()) - before;
    let behind = own.iter().rev().zip(others.iter().rev()).take(left).take_while(|(a, b)| a == b).count();
    let points: Vec<String> = own[before..own.len() - behind].iter().map(|c| format!("U+{:04X}", *c as u32)).collect();
    (!points.is_empty()).then(|| points.join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_print_alike_are_one_name_and_their_code_points_are_told() {
        let mut names = Names::of(What::Bodies);
        assert!(names.take("caf\u{e9}-1", (), |_| None).is_none());
        assert!(names.take("cafe-1", (), |_| None).is_none(), "another letter is another name");
        let error = names.take("cafe\u{301}-1", (), |_| Some(3)).expect("it prints alike");
        assert_eq!(error.code, "scene.duplicate_name");
        assert!(error.message.contains("U+0065 U+0301 here and U+00E9 there"), "{error}");
        let twice = names.take("cafe-1", (), |_| None).expect("it is there");
        assert_eq!(twice.message, "two bodies are called `cafe-1`");
    }
}
