//! What models, integrators, obstacles and the world say in English, in Croatian: sentences with gaps for names and numbers.

use super::sentences::{PARTS, SENTENCES};

/// The Croatian of a sentence, where it is one of these.
pub(super) fn croatian(english: &str) -> Option<String> {
    found(SENTENCES, english)
}

/// The same of a part of a sentence, or of a whole one.
pub(super) fn part(english: &str) -> Option<String> {
    found(PARTS, english).or_else(|| croatian(english))
}

fn found(table: &[(&str, &str)], english: &str) -> Option<String> {
    table.iter().find_map(|(pattern, wanted)| {
        let mut parts = matched(pattern, english)?.into_iter();
        let mut out = String::new();
        let mut rest = *wanted;
        while let Some((start, end, _)) = gap(rest) {
            out.push_str(&rest[..start]);
            out.push_str(&parts.next()?);
            rest = &rest[end..];
        }
        out.push_str(rest);
        Some(out)
    })
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
        for (english, croatian) in SENTENCES.iter().chain(PARTS) {
            assert_eq!(gaps(english), gaps(croatian), "{english}");
            assert_ne!(english, croatian);
        }
    }

    #[test]
    fn every_sentence_is_one_that_the_program_says() {
        // What the sources say, with gaps for what they put in, as one text.
        let crates = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the crates");
        let said: Vec<String> = ["core", "models", "integrators", "collide", "world", "io", "solve"]
            .iter()
            .flat_map(|name| sources(&crates.join(format!("opruga-{name}/src"))))
            .flat_map(|text| literals(&text))
            .collect();
        assert!(said.len() > 1000, "the sources are read");
        // A sentence may be put together of several: the words between its gaps are what is looked for.
        let missing: Vec<&str> = SENTENCES
            .iter()
            .chain(PARTS)
            .flat_map(|(english, _)| {
                english.split("{~}").flat_map(|part| part.split("{}")).flat_map(|part| part.split("{#}"))
            })
            .map(str::trim)
            .filter(|words| words.len() > 14 && !said.iter().any(|text| text.contains(words)))
            .collect();
        assert!(missing.is_empty(), "nobody says this any more: {missing:#?}");
    }

    fn sources(folder: &std::path::Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        entries
            .flat_map(|entry| match entry.path() {
                path if path.is_dir() => sources(&path),
                path => std::fs::read_to_string(path).into_iter().collect(),
            })
            .collect()
    }

    /// The texts in quotes of a source, lines joined.
    fn literals(source: &str) -> Vec<String> {
        let (mut all, mut now, mut escaped) = (Vec::new(), None::<String>, false);
        let mut letters = source.chars().peekable();
        while let Some(letter) = letters.next() {
            match (&mut now, letter) {
                (Some(_), '\n') if escaped => {
                    while letters.next_if(|next| next.is_whitespace()).is_some() {}
                    escaped = false;
                }
                (Some(text), letter) if escaped => {
                    text.push(letter);
                    escaped = false;
                }
                (Some(_), '\\') => escaped = true,
                (Some(_), '"') => all.extend(now.take()),
                (Some(text), letter) => text.push(letter),
                (None, '\'') if letters.peek() == Some(&'"') => drop(letters.next()),
                (None, '/') if letters.peek() == Some(&'/') => while letters.next_if(|next| *next != '\n').is_some() {},
                (None, '"') => now = Some(String::new()),
                (None, _) => {}
            }
        }
        all
    }
}
