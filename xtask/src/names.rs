//! Finds words that the glossary replaces, in names of items, fields and locals.
//!
//! A name is an identifier after `fn`, `struct`, `enum`, `trait`, `type`, `const`, `static`, `mod` or `let`, an identifier before a single colon (a
//! field or an argument), or an argument of a closure. Underscores and capital letters separate the words of a name. Tests are ignored, because their
//! names are sentences.

use crate::{tokens, workspace};
use std::collections::BTreeMap;

/// `cargo xtask names`: refuses names that contain a replaced word.
pub(crate) fn check() -> Result<(), String> {
    let root = workspace::root()?;
    let glossary = workspace::read(&root.join("docs/glossary.md"))?;
    let words = replaced(&glossary);
    if words.is_empty() {
        return Err("docs/glossary.md replaces no words".into());
    }
    let mut found: BTreeMap<&str, Vec<String>> = words.iter().map(|word| (word.as_str(), Vec::new())).collect();
    let mut count = 0;
    for path in workspace::rust_files(&root.join("crates"))? {
        let inside = path.strip_prefix(&root).map_err(|e| e.to_string())?;
        if inside.iter().any(|part| ["tests", "testing", "examples"].contains(&part.to_string_lossy().as_ref())) {
            continue;
        }
        for name in defined(&tokens::product(&workspace::read(&path)?)) {
            count += 1;
            for part in parts(&name) {
                if let Some(list) = found.get_mut(part.as_str()) {
                    list.push(format!("{}: {name}", inside.display()));
                }
            }
        }
    }
    let refused: Vec<String> = found
        .iter()
        .filter(|(_, list)| !list.is_empty())
        .map(|(word, list)| format!("names with the word `{word}`, which the glossary replaces:\n{}", list.join("\n")))
        .collect();
    if !refused.is_empty() {
        return Err(refused.join("\n"));
    }
    println!("{count} names have none of {} words", words.len());
    Ok(())
}

/// The words written as code in the last column of the tables of the glossary, which are refused in names.
fn replaced(glossary: &str) -> Vec<String> {
    let mut out = Vec::new();
    for line in glossary.lines().filter(|line| line.starts_with('|')) {
        let last = line.trim_end_matches('|').rsplit('|').next().unwrap_or_default();
        out.extend(last.split('`').skip(1).step_by(2).map(String::from));
    }
    out.sort();
    out.dedup();
    out
}

/// The names that the code defines, each as often as it is defined.
fn defined(code: &str) -> Vec<String> {
    const WORDS: [&str; 9] = ["fn", "struct", "enum", "trait", "type", "const", "static", "mod", "let"];
    let mut out = Vec::new();
    let (mut before, mut in_closure) = (String::new(), false);
    let mut rest = code;
    while let Some(first) = rest.chars().next() {
        let length = if first == '_' || first.is_alphanumeric() {
            rest.find(|c: char| c != '_' && !c.is_alphanumeric()).unwrap_or(rest.len())
        } else if first == '"' {
            text_length(rest)
        } else {
            first.len_utf8()
        };
        let (token, behind) = rest.split_at(length);
        rest = behind;
        if token.trim().is_empty() {
            continue;
        }
        let is_name = first == '_' || first.is_alphabetic();
        if first == '|' {
            // A closure begins where an expression may begin. In `a | b` and `a || b`, however, the bar follows a name or a bracket.
            let begins = matches!(before.as_str(), "(" | "," | "=" | "{" | ";" | "move" | ">" | "&");
            in_closure = !in_closure && begins && !rest.starts_with('|');
        }
        let next = rest.trim_start();
        let field = next.starts_with(':') && !next.starts_with("::") && before != ":";
        if is_name && token != "mut" && (WORDS.contains(&before.as_str()) || field || in_closure) {
            out.push(token.to_string());
        }
        if token != "mut" {
            before = token.to_string();
        }
    }
    out
}

/// The length of a quoted text at the beginning of some code.
fn text_length(code: &str) -> usize {
    let mut escaped = false;
    for (at, letter) in code.char_indices().skip(1) {
        match letter {
            '"' if !escaped => return at + 1,
            _ => escaped = letter == '\\' && !escaped,
        }
    }
    code.len()
}

/// The words of a name in lower case.
fn parts(name: &str) -> Vec<String> {
    let mut out = Vec::new();
    for piece in name.split('_').filter(|piece| !piece.is_empty()) {
        let is_constant = piece.chars().all(|letter| !letter.is_lowercase());
        let mut word = String::new();
        for letter in piece.chars() {
            if letter.is_uppercase() && !is_constant && !word.is_empty() {
                out.push(std::mem::take(&mut word));
            }
            word.extend(letter.to_lowercase());
        }
        out.push(word);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_that_code_defines() {
        let code = "struct BodyRoom { near: [u32; 2] }\nfn said(way: &str) -> std::fmt::Result { let mut held = a::place; \
                    let text = \"odd: one\"; list.map(|told, (x, y)| told | x) }";
        assert_eq!(defined(code), ["BodyRoom", "near", "said", "way", "held", "text", "told", "x", "y"]);
    }

    #[test]
    fn names_are_cut_into_words() {
        assert_eq!(parts("make_room"), ["make", "room"]);
        assert_eq!(parts("BodyRoom"), ["body", "room"]);
        assert_eq!(parts("MOST_ROOM"), ["most", "room"]);
    }

    #[test]
    fn the_glossary_marks_the_words_as_code() {
        let table = "| term | meaning | Croatian | replaces |\n|---|---|---|---|\n| active | of a constraint | aktivan | `held`, `worn` |\n\
                     | pin | condition | – | hold |\n";
        assert_eq!(replaced(table), ["held", "worn"]);
    }
}
