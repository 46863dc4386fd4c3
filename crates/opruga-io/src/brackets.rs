//! Brackets of a scene that are never closed. One such bracket causes a parser to report many errors.

use crate::source::end_of_string;

/// A bracket that is still open when the next part of the scene begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Unclosed {
    /// The byte of the bracket.
    pub(crate) open: usize,
    /// The character that would close the bracket.
    pub(crate) wanted: char,
    /// The byte where the next part begins, or the end of the text.
    pub(crate) until: usize,
}

/// Returns the outermost bracket of a value that is not closed before the end of the text, or before a line that cannot be part of a value. Such a
/// line is the head of a table or, in a list, a line with a key.
pub(crate) fn unclosed(text: &str) -> Option<Unclosed> {
    let bytes = text.as_bytes();
    let mut open: Vec<usize> = Vec::new();
    let (mut at, mut begins) = (0, true);
    while at < bytes.len() {
        if begins {
            let line = text[at..].lines().next().unwrap_or_default();
            let outer = open.first().copied();
            let in_list = open.last().is_some_and(|at| bytes[*at] == b'[');
            match outer {
                Some(outer) if is_head(line) || in_list && is_key(line) => return Some(at_end(bytes, outer, at)),
                // A head is not a value.
                None if line.trim_start().starts_with('[') => {
                    at += line.len();
                    begins = false;
                    continue;
                }
                _ => {}
            }
        }
        begins = bytes[at] == b'\n';
        match bytes[at] {
            b'#' => {
                at += bytes[at..].iter().position(|b| *b == b'\n').unwrap_or(bytes.len() - at);
                continue;
            }
            b'"' | b'\'' => {
                at = end_of_string(bytes, at);
                continue;
            }
            b'[' | b'{' => open.push(at),
            // A bracket that closes nothing is an error in its own line.
            b']' | b'}' => _ = open.pop(),
            _ => {}
        }
        at += 1;
    }
    open.first().map(|outer| at_end(bytes, *outer, bytes.len()))
}

fn at_end(bytes: &[u8], open: usize, until: usize) -> Unclosed {
    Unclosed { open, wanted: if bytes[open] == b'[' { ']' } else { '}' }, until }
}

/// Whether a line is the head of a table, such as `[time]` or `[[body]]`. A line such as `[true]` is a list: `true`, `false`, `inf` and `nan` are the
/// only bare words that a list may hold.
fn is_head(line: &str) -> bool {
    let line = line.split('#').next().unwrap_or(line).trim();
    let inner = line.strip_prefix('[').and_then(|l| l.strip_suffix(']'));
    let inner = inner.map(|l| l.strip_prefix('[').and_then(|l| l.strip_suffix(']')).unwrap_or(l).trim());
    inner.is_some_and(|word| is_word(word) && !["true", "false", "inf", "nan"].contains(&word))
}

/// Whether a line begins with a key and its `=`.
fn is_key(line: &str) -> bool {
    line.split_once('=').is_some_and(|(key, _)| is_word(key.trim()))
}

fn is_word(word: &str) -> bool {
    word.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && word.chars().all(|c| c.is_ascii_alphanumeric() || "_-.".contains(c))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bracket_that_stays_open_is_found() {
        let lists = "a = 1\npath = [\n  [0, 1],\n  [1, 2\n  [2, 3],\n]\n[time]\nx = [1]\n";
        let found = unclosed(lists).expect("it is open");
        assert_eq!((found.open, found.wanted, &lists[found.until..][..6]), (13, ']', "[time]"));
        let keys = unclosed("a = [1, 2\nb = 3\n").expect("it is open");
        assert_eq!((keys.open, keys.until), (4, 10));
        let table = unclosed("a = { b = 1\n[[body]]\n").expect("it is open");
        assert_eq!((table.open, table.wanted), (4, '}'));
        assert_eq!(unclosed("a = [\"]\", '[', # ]\n").map(|u| u.open), Some(4), "brackets in texts and remarks");
        for whole in [
            "a = [\n [1, 2],\n [inf],\n]\n[[b]]\nc = { d = 1,\n e = 2 }\n",
            "[a]\nb = [\n [true],\n # c = 1\n]\n",
            "a = 1]\nb = 2\n",
            "a = \"\"\"\n[x]\n\"\"\"\n",
        ] {
            assert_eq!(unclosed(whole), None, "{whole}");
        }
    }
}
