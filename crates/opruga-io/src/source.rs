//! The bytes of a scene before they are parsed: encoding, size, depth, and the position of a byte in the text.

use crate::limits::Limits;
use crate::problem::{Excerpt, SceneError, unprintable};
use crate::text_errors::{Measured, TextError};

/// The byte-order mark of UTF-8.
const MARK: &[u8] = b"\xef\xbb\xbf";

/// The memory that a parser takes for a value in a list, in units of the memory for a line or a word. A measurement with `toml` 1.2 gave 50 bytes for
/// a line or a word, 200 for a value in a list, 490 for a line with a key, and 600 for a table made by a dotted key. When lines and words were not
/// counted, 30 million empty lines took 1.4 GB (test: `torture.rs`, `the_memory_of_a_parser_is_bounded`).
const PIECES: u64 = 4;
/// The memory for the table of a dotted key, in the same units.
const OF_TABLE: u64 = 12;

/// A text with its name, which can find the line of a byte.
#[derive(Debug)]
pub(crate) struct Source<'a> {
    pub(crate) file: &'a str,
    pub(crate) text: &'a str,
}

impl<'a> Source<'a> {
    /// Checks size and encoding. A byte-order mark of UTF-8 is skipped.
    pub(crate) fn new(file: &'a str, bytes: &'a [u8], limits: &Limits) -> Result<Source<'a>, SceneError> {
        let error = |about: TextError| SceneError { file: file.to_string(), ..SceneError::of(about) };
        if bytes.len() as u64 > limits.file_bytes {
            let (size, most) = (bytes.len() as u64, limits.file_bytes);
            return Err(error(TextError::Size { what: Measured::Scene, size, most }));
        }
        let zeros = |k: usize| bytes.iter().skip(k).step_by(2).take(32).filter(|b| **b == 0).count();
        let wide = bytes.starts_with(&[0xff, 0xfe])
            || bytes.starts_with(&[0xfe, 0xff])
            || (bytes.len() >= 4
                && (zeros(0) > 0 || zeros(1) > 0)
                && (zeros(0) * 4 >= bytes.len().div_ceil(2).min(32)
                    || zeros(1) * 4 >= bytes.len().div_ceil(2).min(32)));
        if wide {
            return Err(Source { file, text: "" }.mark(error(TextError::Wide {}), 0, 0));
        }
        let bytes = bytes.strip_prefix(MARK).unwrap_or(bytes);
        if bytes.starts_with(MARK) {
            // The parser would skip a second mark. It occurs if two programs added a mark to the file.
            return Err(Source { file, text: "" }.mark(error(TextError::TwoMarks {}), 0, 0));
        }
        let text = match core::str::from_utf8(bytes) {
            Ok(text) => text,
            Err(e) => {
                let good = core::str::from_utf8(&bytes[..e.valid_up_to()]).unwrap_or("");
                let source = Source { file, text: good };
                let byte = bytes.get(good.len()).copied().unwrap_or(0);
                let about = TextError::Byte { byte: format!("0x{byte:02x}") };
                return Err(source.mark(error(about), good.len(), good.len()));
            }
        };
        let source = Source { file, text };
        if text.trim().is_empty() {
            return Err(source.mark(error(TextError::Empty {}), 0, 0));
        }
        source.check_nesting(limits, false)?;
        Ok(source)
    }

    /// Checks a value outside a scene, such as one on the command line, for the same depth and size.
    ///
    /// # Errors
    /// `scene.depth` or `scene.too_large`, without a location.
    pub(crate) fn check_value(text: &str, limits: &Limits) -> Result<(), SceneError> {
        Source { file: "", text }.check_nesting(limits, true).map_err(|error| SceneError {
            line: None,
            column: None,
            excerpt: None,
            ..error
        })
    }

    /// Line and column of a byte, both from 1; columns count characters.
    pub(crate) fn position(&self, offset: usize) -> (usize, usize) {
        let offset = self.boundary(offset);
        let before = &self.text[..offset];
        let line_start = before.rfind('\n').map_or(0, |k| k + 1);
        (before.bytes().filter(|b| *b == b'\n').count() + 1, before[line_start..].chars().count() + 1)
    }

    /// The byte at a line and a column, both from 1; columns count characters. If there is no such position, this is the end of the text.
    pub(crate) fn offset(&self, line: usize, column: usize) -> usize {
        let mut start = 0;
        for _ in 1..line {
            match self.text[start..].find('\n') {
                Some(k) => start += k + 1,
                None => return self.text.len(),
            }
        }
        let rest = &self.text[start..];
        start + rest.char_indices().nth(column.saturating_sub(1)).map_or(rest.len(), |(k, _)| k)
    }

    /// Adds location and excerpt to an error.
    pub(crate) fn mark(&self, mut error: SceneError, start: usize, end: usize) -> SceneError {
        let start = self.boundary(start);
        let end = self.boundary(end.max(start));
        let (line, column) = self.position(start);
        let line_start = self.text[..start].rfind('\n').map_or(0, |k| k + 1);
        let line_end = self.text[start..].find('\n').map_or(self.text.len(), |k| start + k);
        // A long line is shown from 40 characters before the marked part.
        let mut before = self.text[line_start..start].char_indices().rev();
        let shown_from = match before.nth(39) {
            Some((k, _)) if before.nth(39).is_some() => line_start + k,
            _ => line_start,
        };
        let mut excerpt = Excerpt { line: String::new(), start: 0, length: 0 };
        let mut count = 0;
        for (k, c) in self.text[shown_from..line_end].trim_end_matches('\r').char_indices() {
            let here = shown_from + k;
            let width = if unprintable(c) { c.escape_unicode().count() } else { 1 };
            if here < start {
                excerpt.start += width;
            } else if here < end {
                excerpt.length += width;
            }
            if unprintable(c) {
                excerpt.line.extend(c.escape_unicode())
            } else {
                excerpt.line.push(c)
            }
            count += 1;
            if count == 120 {
                break;
            }
        }
        excerpt.length = excerpt.length.max(1);
        error.file = self.file.to_string();
        error.line = Some(line);
        error.column = Some(column);
        error.excerpt = Some(excerpt);
        error
    }

    fn boundary(&self, offset: usize) -> usize {
        let mut offset = offset.min(self.text.len());
        while !self.text.is_char_boundary(offset) {
            offset -= 1;
        }
        offset
    }

    /// Scans the text once, with knowledge of strings and comments. Counts the depth of nested tables and arrays (by brackets and by dots in keys)
    /// and the memory that a parser would take for the text, before the parser allocates or recurses. `value` is true if the text is a value and not
    /// a whole scene.
    fn check_nesting(&self, limits: &Limits, value: bool) -> Result<(), SceneError> {
        let too_deep = |at: usize| self.mark(SceneError::of(TextError::Depth { most: limits.depth }), at, at + 1);
        let bytes = self.text.as_bytes();
        // For every open bracket: whether it is an inline table, and the depth of the key before it.
        let mut open: Vec<(bool, usize)> = Vec::new();
        let (mut depth, mut key, mut in_key, mut header, mut pieces) = (0usize, 0usize, !value, 0usize, 0u64);
        let mut at = 0;
        let mut line_begins = !value;
        let mut between = true;
        while at < bytes.len() {
            let byte = bytes[at];
            if line_begins && !byte.is_ascii_whitespace() {
                pieces += PIECES;
            }
            let space = byte.is_ascii_whitespace();
            pieces += u64::from(between && !space || byte == b'\n');
            between = space;
            if pieces > limits.values.saturating_mul(PIECES) {
                let about = TextError::Pieces { values: limits.values, lines: limits.values / 3 };
                return Err(self.mark(SceneError::of(about), at, at + 1));
            }
            match byte {
                b'#' => at += bytes[at..].iter().position(|b| *b == b'\n').unwrap_or(bytes.len() - at) - 1,
                b'"' | b'\'' => {
                    at = end_of_string(bytes, at) - 1;
                    line_begins = false;
                }
                b'\n' if open.is_empty() => {
                    (in_key, key, line_begins) = (!value, 0, !value);
                    at += 1;
                    continue;
                }
                b' ' | b'\t' | b'\r' | b'\n' => {}
                b'[' if line_begins && open.is_empty() => {
                    // A header: its depth applies to all lines below it.
                    at += usize::from(bytes.get(at + 1) == Some(&b'['));
                    let end = end_of_header(bytes, at + 1);
                    header = 1 + bytes[at..end].iter().filter(|b| **b == b'.').count();
                    pieces += PIECES + OF_TABLE * (header as u64 - 1);
                    if header > limits.depth || bytes[at + 1..end].iter().filter(|b| **b == b'[').count() > limits.depth
                    {
                        return Err(too_deep(at));
                    }
                    at = end.max(at + 1) - 1;
                    line_begins = false;
                }
                b'[' | b'{' => {
                    open.push((byte == b'{', key));
                    depth += key + 1;
                    (key, in_key) = (0, byte == b'{');
                    pieces += PIECES;
                    line_begins = false;
                }
                b']' | b'}' => {
                    if open.last().is_some_and(|(table, _)| *table == (byte == b'}')) {
                        let (_, before) = open.pop().unwrap_or_default();
                        depth = depth.saturating_sub(before + 1);
                        (key, in_key) = (before, false);
                    }
                }
                b'=' => {
                    in_key = false;
                    pieces += PIECES;
                    line_begins = false;
                }
                b',' => {
                    pieces += PIECES;
                    if open.last().is_some_and(|(table, _)| *table) {
                        (key, in_key) = (0, true);
                    }
                }
                b'.' if in_key => {
                    key += 1;
                    pieces += OF_TABLE;
                }
                _ => line_begins = false,
            }
            if header + depth + key > limits.depth {
                return Err(too_deep(at));
            }
            at += 1;
        }
        Ok(())
    }
}

/// The index after a string that begins at `at`; an unclosed string ends with its line or with the text.
pub(crate) fn end_of_string(bytes: &[u8], at: usize) -> usize {
    let quote = bytes[at];
    let long = bytes[at..].starts_with(&[quote; 3]);
    let mut k = at + if long { 3 } else { 1 };
    while k < bytes.len() {
        if bytes[k] == b'\\' && quote == b'"' {
            k += 2;
        } else if long && bytes[k..].starts_with(&[quote; 3]) {
            k += 3;
            // Two more quotes may belong to the string.
            while k < bytes.len() && bytes[k] == quote {
                k += 1;
            }
            return k;
        } else if !long && bytes[k] == quote {
            return k + 1;
        } else if !long && bytes[k] == b'\n' {
            return k;
        } else {
            k += 1;
        }
    }
    bytes.len()
}

/// The end of the line of a header, or of its bracket.
fn end_of_header(bytes: &[u8], from: usize) -> usize {
    let mut k = from;
    while k < bytes.len() && bytes[k] != b'\n' && bytes[k] != b']' && bytes[k] != b'#' {
        k = if bytes[k] == b'"' || bytes[k] == b'\'' { end_of_string(bytes, k) } else { k + 1 };
    }
    k.min(bytes.len())
}
