//! Equality of texts that look the same in print.

use unicode_normalization::char::{canonical_combining_class, decompose_canonical};

/// The canonical decomposition of a text (NFD): `é` becomes two characters (U+0065 U+0301), whether it was one (U+00E9) or two.
///
/// This function uses the character tables of the library, not its iterators, because the iterators also need the tables for compatibility, which add
/// tens of kilobytes to a web page.
///
/// Source: Unicode Standard Annex 15.
pub(crate) fn decomposed(text: &str) -> String {
    let mut all: Vec<char> = Vec::with_capacity(text.len());
    for letter in text.chars() {
        decompose_canonical(letter, |part| all.push(part));
    }
    // The marks that follow a letter are sorted by their classes.
    for marks in all.chunk_by_mut(|_, next| canonical_combining_class(*next) != 0) {
        let first = usize::from(marks.first().is_some_and(|mark| canonical_combining_class(*mark) == 0));
        marks[first..].sort_by_key(|mark| canonical_combining_class(*mark));
    }
    all.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::decomposed;
    use proptest::prelude::*;
    use unicode_normalization::UnicodeNormalization as _;

    proptest! {
        #[test]
        fn texts_are_decomposed_as_the_library_does(text in "[a-zé\u{1e69}\u{0301}\u{0323}\u{0327}\u{ac01}\u{212b} ]{0,12}|.{0,8}") {
            prop_assert_eq!(decomposed(&text), text.nfd().collect::<String>());
        }
    }
}
