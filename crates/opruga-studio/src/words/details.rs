//! What models, integrators, obstacles, the world and the readers of files say in English, in Croatian: sentences with gaps
//! for names and numbers.

use super::{own, parts, readers, sentences};
use std::cell::RefCell;
use std::collections::HashMap;
use std::sync::LazyLock;

/// A sentence with gaps in English, and in Croatian.
type Pair = (&'static str, &'static str);

/// The same, with the words before the first gap and behind the last one: of a thousand sentences few begin and end like a text, and a
/// message is looked up whenever it is shown.
struct Known {
    pair: Pair,
    first: &'static str,
    last: &'static str,
}

impl Known {
    fn new(pair: &Pair) -> Known {
        let (mut rest, mut first) = (pair.0, None);
        while let Some((start, end, _)) = gap(rest) {
            first = first.or(Some(&rest[..start]));
            rest = &rest[end..];
        }
        Known { pair: *pair, first: first.unwrap_or(rest), last: rest }
    }
}

/// Lookups that are remembered: parts of sentences are tried again and again, and a message is shown for many pictures.
const REMEMBERED: usize = 4_096;

thread_local! {
    /// What was found in the table of whole sentences and in that of parts.
    static FOUND: [RefCell<HashMap<String, Option<String>>>; 2] = Default::default();
}

/// What was looked up before, or else is now.
fn remembered(table: usize, english: &str, look: impl FnOnce() -> Option<String>) -> Option<String> {
    FOUND.with(|tables| {
        if let Some(known) = tables[table].borrow().get(english) {
            return known.clone();
        }
        let found = look();
        let mut known = tables[table].borrow_mut();
        if known.len() >= REMEMBERED {
            known.clear();
        }
        known.insert(english.into(), found.clone());
        found
    })
}

static WHOLE: LazyLock<Vec<Known>> = LazyLock::new(|| whole().map(Known::new).collect());
static PARTS: LazyLock<Vec<Known>> = LazyLock::new(|| parts().map(Known::new).collect());

/// Whole sentences: those of the readers first, since the engine has some that fit much.
pub(super) fn whole() -> impl Iterator<Item = &'static Pair> {
    readers::SENTENCES.into_iter().chain([own::SENTENCES, sentences::SENTENCES]).flatten()
}

/// Parts of sentences.
pub(super) fn parts() -> impl Iterator<Item = &'static Pair> {
    readers::PARTS.into_iter().chain([parts::PARTS]).flatten()
}

/// The Croatian of a sentence, where it is one of these.
pub(super) fn croatian(english: &str) -> Option<String> {
    remembered(0, english, || found(&WHOLE, english))
}

/// The same of a part of a sentence, or of a whole one.
pub(super) fn part(english: &str) -> Option<String> {
    remembered(1, english, || found(&PARTS, english)).or_else(|| croatian(english))
}

fn found(table: &[Known], english: &str) -> Option<String> {
    let near = table.iter().filter(|known| english.starts_with(known.first) && english.ends_with(known.last));
    let mut near = near.map(|known| known.pair).filter(|(pattern, _)| may_fit(pattern, english));
    near.find_map(|(pattern, wanted)| {
        let mut parts = matched(pattern, english)?.into_iter();
        let mut out = String::new();
        let mut rest = wanted;
        while let Some((start, end, _)) = gap(rest) {
            out.push_str(&rest[..start]);
            out.push_str(&parts.next()?);
            rest = &rest[end..];
        }
        out.push_str(rest);
        Some(out)
    })
}

/// Whether the words between the gaps of a pattern stand in a text one after another: of hundreds of patterns few do, and only these are
/// looked at closer, since what fills their gaps may be sentences again.
fn may_fit(pattern: &str, text: &str) -> bool {
    let (mut pattern, mut text) = (pattern, text);
    let mut begins = true;
    loop {
        let gap = gap(pattern);
        let words = gap.map_or(pattern, |(start, ..)| &pattern[..start]);
        let at = match (begins, gap) {
            (true, None) => (words == text).then_some(0),
            (true, Some(_)) => text.starts_with(words).then_some(0),
            (false, None) => text.ends_with(words).then(|| text.len() - words.len()),
            (false, Some(_)) => text.find(words),
        };
        let (Some(at), Some((_, end, _))) = (at, gap) else { return at.is_some() };
        (pattern, text, begins) = (&pattern[end..], &text[at + words.len()..], false);
    }
}

/// What may fill a gap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Gap {
    Name,
    Value,
    Sentence,
}

/// The next gap of a pattern: where it begins and ends, and what may fill it.
fn gap(pattern: &str) -> Option<(usize, usize, Gap)> {
    let start = pattern.find('{')?;
    Some(match &pattern[start..] {
        rest if rest.starts_with("{~}") => (start, start + 3, Gap::Sentence),
        rest if rest.starts_with("{#}") => (start, start + 3, Gap::Value),
        _ => (start, start + 2, Gap::Name),
    })
}

/// Whether a text is a number, a word in quotes or a list of such, and no sentence.
fn is_value(text: &str) -> bool {
    text.starts_with(['"', '[', '(', '{']) || !text.contains(' ')
}

/// What fills the gaps of a pattern, those in Croatian that are sentences themselves; none where it does not fit.
fn matched(pattern: &str, text: &str) -> Option<Vec<String>> {
    let Some((start, end, kind)) = gap(pattern) else { return (pattern == text).then(Vec::new) };
    let text = text.strip_prefix(&pattern[..start])?;
    let rest = &pattern[end..];
    let next = gap(rest).map_or(rest, |(start, ..)| &rest[..start]);
    let filled = |end: usize| {
        let own = &text[..end];
        let own = match kind {
            Gap::Sentence => part(own)?,
            Gap::Value if !is_value(own) => return None,
            Gap::Value | Gap::Name => own.to_string(),
        };
        let mut all = vec![own];
        all.extend(matched(rest, &text[end..])?);
        Some(all)
    };
    if next.is_empty() {
        return filled(text.len());
    }
    // The shortest that lets the rest fit.
    text.match_indices(next).find_map(|(end, _)| filled(end))
}

#[cfg(test)]
mod tests {
    use super::super::said_in_sources::{literals, sources};
    use super::*;

    #[test]
    fn gaps_keep_names_and_numbers_and_sentences_within_sentences_are_translated_too() {
        let english = "nothing holds the body against translation along x, rotation: 2 rigid modes; an equilibrium needs a body \
                       that is held; hint: pin as many axes of nodes as there are rigid modes, or give it something to rest on";
        let found = croatian(english).expect("it is known");
        assert!(found.starts_with("ništa ne drži tijelo protiv: pomak duž x, zakret (krutih pomaka: 2)"), "{found}");
        assert_eq!(
            croatian("exactly one of `nRT` and `pressure` must be given").as_deref(),
            Some("treba zadati točno jedno od `nRT` i `pressure`")
        );
        assert_eq!(croatian("something that nobody says"), None);
        assert_eq!(croatian("nothing holds the body against the wind: 2 rigid modes"), None);
    }

    #[test]
    fn both_languages_have_the_same_gaps_in_the_same_order() {
        let gaps = |mut text: &str| {
            let mut all = Vec::new();
            while let Some((_, end, kind)) = gap(text) {
                all.push(kind);
                text = &text[end..];
            }
            all
        };
        for (english, croatian) in whole().chain(parts()) {
            assert_eq!(gaps(english), gaps(croatian), "{english}");
            assert_ne!(english, croatian);
        }
    }

    #[test]
    fn every_sentence_is_one_that_the_program_says() {
        // What the sources say, with gaps for what they put in, as one text.
        let crates = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the crates");
        let said: Vec<String> = ["core", "mesh", "models", "integrators", "collide", "world", "io", "solve"]
            .iter()
            .flat_map(|name| sources(&crates.join(format!("opruga-{name}/src"))))
            .flat_map(|text| literals(&text))
            .collect();
        assert!(said.len() > 1000, "the sources are read");
        // A sentence may be put together of several: the words between its gaps are what is looked for.
        // What readers say is put together of more parts than can be found again.
        let missing: Vec<&str> = sentences::SENTENCES
            .iter()
            .chain(parts::PARTS)
            .flat_map(|(english, _)| {
                english.split("{~}").flat_map(|part| part.split("{}")).flat_map(|part| part.split("{#}"))
            })
            .map(str::trim)
            .filter(|words| words.len() > 14 && !said.iter().any(|text| text.contains(words)))
            .collect();
        assert!(missing.is_empty(), "nobody says this any more: {missing:#?}");
    }
}
