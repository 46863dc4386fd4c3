//! Reads the words and binary numbers of a mesh file one after the other, each with its position.

use super::errors::{Keyword, NumberHint, NumberRange, ScanError};
use super::terms::Expected;
use crate::problem::{SceneError, visible};
use crate::source::Source;
use opruga_math::message::AnyMessage;

/// The error for a file that ends with a word instead of the end of a line.
pub(crate) fn cut_line(code: &'static str, word: &[u8]) -> SceneError {
    SceneError { code, ..SceneError::of(ScanError::CutLine { word: visible(&String::from_utf8_lossy(word)) }) }
}

/// Bytes that are read from front to back. Text and binary parts may alternate in one file.
#[derive(Clone, Debug)]
pub(super) struct Scanner<'a> {
    pub(super) file: &'a str,
    pub(super) bytes: &'a [u8],
    /// The index of the next byte.
    pub(super) at: usize,
    /// Whether the file holds binary numbers. Positions are then bytes, otherwise lines.
    pub(super) binary: bool,
    /// Whether binary numbers are big-endian.
    pub(super) big_endian: bool,
    /// The mark that begins a comment, which extends to the end of the line.
    pub(super) comment: Option<u8>,
}

impl<'a> Scanner<'a> {
    /// Makes a scanner for a text file; `comment` is the mark that begins comments.
    pub(super) fn new(file: &'a str, bytes: &'a [u8], comment: Option<u8>) -> Scanner<'a> {
        let at = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        Scanner { file, bytes, at, binary: false, big_endian: false, comment }
    }

    /// Adds the position of the bytes between `from` and `to` to an error: line and column in a text, the first byte in a binary file.
    pub(super) fn mark(&self, error: SceneError, from: usize, to: usize) -> SceneError {
        if self.binary {
            return SceneError { byte: Some(from), file: self.file.to_string(), ..error };
        }
        let good = match core::str::from_utf8(self.bytes) {
            Ok(text) => text,
            Err(e) => core::str::from_utf8(&self.bytes[..e.valid_up_to()]).unwrap_or(""),
        };
        Source { file: self.file, text: good }.mark(error, from, to)
    }

    /// An error at the word or number that begins at a byte.
    pub(super) fn error(&self, message: impl Into<AnyMessage>, from: usize) -> SceneError {
        self.at(SceneError::of(message), from)
    }

    /// An error at the word or number that begins at a byte, with the code of a format.
    pub(super) fn error_of(&self, code: &'static str, error: ScanError, from: usize) -> SceneError {
        self.at(SceneError { code, ..SceneError::of(error) }, from)
    }

    /// Adds the position to an error that has none yet.
    pub(super) fn at(&self, error: SceneError, from: usize) -> SceneError {
        let end =
            from + self.bytes[from.min(self.bytes.len())..].iter().take_while(|b| !b.is_ascii_whitespace()).count();
        self.mark(error, from, end)
    }

    /// An error at the end of the file.
    pub(super) fn ends(&self, code: &'static str, wanted: impl Into<AnyMessage>) -> SceneError {
        let end = if self.binary { self.bytes.len() } else { self.bytes.trim_ascii_end().len() };
        let error = SceneError::of(ScanError::Ends { wanted: wanted.into() });
        self.mark(SceneError { code, ..error }, end, end)
    }

    /// Skips blanks, and with `lines` also ends of lines and comments.
    fn skip(&mut self, lines: bool) {
        while let Some(&byte) = self.bytes.get(self.at) {
            if self.comment == Some(byte) {
                self.at += self.bytes[self.at..].iter().take_while(|b| **b != b'\n').count();
            } else if byte.is_ascii_whitespace() && (lines || byte != b'\n') {
                self.at += 1;
            } else {
                return;
            }
        }
    }

    /// Whether nothing but blanks and comments follows.
    pub(super) fn is_done(&mut self) -> bool {
        self.skip(true);
        self.at == self.bytes.len()
    }

    /// Refuses a file without an end mark whose last line has no line end: a truncated number, such as the `1` of `1.75`, would look complete. A last
    /// line that ends in a comment is accepted.
    pub(super) fn last_line_ends(&self, code: &'static str) -> Result<(), SceneError> {
        let from = self.bytes.iter().rposition(|b| *b == b'\n').map_or(0, |at| at + 1);
        let last = &self.bytes[from..];
        let commented = self.comment.is_some_and(|mark| last.contains(&mark));
        if commented || last.last().is_none_or(u8::is_ascii_whitespace) {
            return Ok(());
        }
        let from = last.iter().rposition(|b| b.is_ascii_whitespace()).map_or(from, |at| from + at + 1);
        Err(self.at(cut_line(code, &self.bytes[from..]), from))
    }

    /// The next word and the byte at which it begins, without consuming it; none at the end of the file.
    pub(super) fn peek(&mut self) -> Option<(&'a str, usize)> {
        self.skip(true);
        let from = self.at;
        let end = |b: &&u8| !b.is_ascii_whitespace() && Some(**b) != self.comment;
        let length = self.bytes[from..].iter().take_while(end).count();
        // Bytes that are not UTF-8 are not a word of any format.
        (length > 0).then(|| (core::str::from_utf8(&self.bytes[from..from + length]).unwrap_or("\u{fffd}"), from))
    }

    /// Consumes the next word; returns it and the byte at which it begins.
    pub(super) fn word(&mut self, code: &'static str, wanted: Expected) -> Result<(&'a str, usize), SceneError> {
        let Some((word, from)) = self.peek() else { return Err(self.ends(code, wanted)) };
        self.at = from
            + self.bytes[from..].iter().take_while(|b| !b.is_ascii_whitespace() && Some(**b) != self.comment).count();
        Ok((word, from))
    }

    /// Consumes the next word if it is on the same line.
    pub(super) fn word_of_line(&mut self) -> Option<(&'a str, usize)> {
        self.skip(false);
        if matches!(self.bytes.get(self.at), None | Some(b'\n')) {
            return None;
        }
        self.word("", Expected::Nothing).ok()
    }

    /// Consumes the rest of the line with its end; returns this rest without surrounding blanks, and the byte at which it begins.
    pub(super) fn line(&mut self) -> (String, usize) {
        self.skip(false);
        let from = self.at;
        let length = self.bytes[from..].iter().take_while(|b| **b != b'\n').count();
        self.at = usize::min(from + length + 1, self.bytes.len());
        (String::from_utf8_lossy(&self.bytes[from..from + length]).trim().to_string(), from)
    }

    /// Consumes the end of the line; refuses anything before it.
    pub(super) fn line_end(&mut self, code: &'static str, of: Expected) -> Result<(), SceneError> {
        self.skip(false);
        match self.bytes.get(self.at) {
            None => Ok(()),
            Some(b'\n') => {
                self.at += 1;
                Ok(())
            }
            Some(_) => {
                let from = self.at;
                let (word, _) = self.word(code, Expected::Nothing)?;
                Err(self.error_of(code, ScanError::Behind { of, word: visible(word) }, from))
            }
        }
    }

    /// Consumes a word that must be `wanted` in upper or lower case.
    pub(super) fn expect(&mut self, code: &'static str, wanted: &str) -> Result<(), SceneError> {
        let Some((word, from)) = self.peek() else { return Err(self.ends(code, Keyword::One { word: wanted.into() })) };
        if !word.eq_ignore_ascii_case(wanted) {
            return Err(self.error_of(code, ScanError::Other { word: visible(word), wanted: wanted.into() }, from));
        }
        self.at = from + word.len();
        Ok(())
    }

    /// The next word as a whole number.
    pub(super) fn whole<T: core::str::FromStr>(
        &mut self,
        code: &'static str,
        what: Expected,
    ) -> Result<(T, usize), SceneError> {
        let (word, from) = self.word(code, what)?;
        match word.parse() {
            Ok(number) => Ok((number, from)),
            Err(_) => Err(self.error_of(code, ScanError::NotWhole { word: visible(word), what }, from)),
        }
    }

    /// The next word as a finite number.
    pub(super) fn number(&mut self, code: &'static str, what: Expected) -> Result<f64, SceneError> {
        let (word, from) = self.word(code, what)?;
        match word.parse::<f64>() {
            Ok(x) => self.finite(x, what, from),
            Err(_) => Err(self.no_number(code, word, what, NumberRange::Real {}, from)),
        }
    }

    /// The error for a word that is not a number in the allowed range.
    pub(super) fn no_number(
        &self,
        code: &'static str,
        word: &str,
        what: Expected,
        allowed: NumberRange,
        from: usize,
    ) -> SceneError {
        let hint = word.contains(',').then_some(NumberHint::Comma);
        self.error_of(code, ScanError::NotNumber { word: visible(word), what, allowed, hint }, from)
    }

    /// Refuses a number that is not finite.
    pub(super) fn finite(&self, x: f64, what: Expected, from: usize) -> Result<f64, SceneError> {
        if x.is_finite() { Ok(x) } else { Err(self.error(ScanError::NotFiniteNumber { what, number: x }, from)) }
    }

    /// Reads a count and refuses it if the rest of the file cannot hold that many items of at least `least` bytes each.
    pub(super) fn fits(
        &self,
        code: &'static str,
        count: u64,
        least: u64,
        what: Expected,
        from: usize,
    ) -> Result<usize, SceneError> {
        let rest = (self.bytes.len() - self.at) as u64;
        if count.checked_mul(least).is_some_and(|bytes| bytes <= rest + least) {
            return Ok(count as usize);
        }
        Err(self.error_of(code, ScanError::Promised { count, what, rest, most: rest / least }, from))
    }

    /// The next bytes.
    pub(super) fn take(&mut self, count: usize, code: &'static str, what: Expected) -> Result<&'a [u8], SceneError> {
        match self.bytes.get(self.at..).and_then(|rest| rest.get(..count)) {
            Some(found) => {
                self.at += count;
                Ok(found)
            }
            None => Err(self.ends(code, what)),
        }
    }

    fn fixed<const N: usize>(&mut self, code: &'static str, what: Expected) -> Result<[u8; N], SceneError> {
        let bytes = self.take(N, code, what)?;
        let mut word = [0; N];
        word.copy_from_slice(bytes);
        if self.big_endian {
            word.reverse();
        }
        Ok(word)
    }

    /// A binary whole number of 4 bytes.
    pub(super) fn binary_i32(&mut self, code: &'static str, what: Expected) -> Result<i32, SceneError> {
        self.fixed(code, what).map(i32::from_le_bytes)
    }

    /// A binary whole number of 8 bytes.
    pub(super) fn binary_u64(&mut self, code: &'static str, what: Expected) -> Result<u64, SceneError> {
        self.fixed(code, what).map(u64::from_le_bytes)
    }

    /// A binary number of 8 bytes, finite.
    pub(super) fn binary_f64(&mut self, code: &'static str, what: Expected) -> Result<f64, SceneError> {
        let from = self.at;
        let x = f64::from_le_bytes(self.fixed(code, what)?);
        self.finite(x, what, from)
    }
}
