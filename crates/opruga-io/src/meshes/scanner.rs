//! Words and binary numbers of a mesh file, one after the other, each with its place.

use crate::problem::{SceneError, visible};
use crate::source::Source;

/// What is said where the last line of a text may be cut off.
pub(crate) const MIDDLE_OF_LINE: &str = "the file ends in the middle of its last line, maybe of a number";

/// Adds the word that the file ends with, and what helps.
pub(crate) fn middle_of_line(error: SceneError, word: &[u8]) -> SceneError {
    let error = error.value(visible(&String::from_utf8_lossy(word))).allowed("a line break behind the last word");
    error.hint("end the last line with a line break if the file is whole; if not, it is cut off")
}

/// Bytes that are read from front to back. What follows may be text or binary, in one file.
#[derive(Clone, Debug)]
pub(super) struct Scanner<'a> {
    pub(super) file: &'a str,
    pub(super) bytes: &'a [u8],
    /// The next byte.
    pub(super) at: usize,
    /// Whether the file holds binary numbers: places are bytes then, lines otherwise.
    pub(super) binary: bool,
    /// Whether binary numbers begin with their highest byte.
    pub(super) big_endian: bool,
    /// The mark after which the rest of a line is a comment, if there is one.
    pub(super) comment: Option<u8>,
}

impl<'a> Scanner<'a> {
    /// A text file; `comment` begins comments.
    pub(super) fn new(file: &'a str, bytes: &'a [u8], comment: Option<u8>) -> Scanner<'a> {
        let at = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        Scanner { file, bytes, at, binary: false, big_endian: false, comment }
    }

    /// Adds the place from one byte to another: line and column of a text, the byte of a binary file.
    pub(super) fn mark(&self, error: SceneError, from: usize, to: usize) -> SceneError {
        if self.binary {
            let message = format!("{}, at byte {from}", error.message);
            return SceneError { message, file: self.file.to_string(), ..error };
        }
        let good = match core::str::from_utf8(self.bytes) {
            Ok(text) => text,
            Err(e) => core::str::from_utf8(&self.bytes[..e.valid_up_to()]).unwrap_or(""),
        };
        Source { file: self.file, text: good }.mark(error, from, to)
    }

    /// An error at the word or number that begins at a byte.
    pub(super) fn error(&self, code: &'static str, message: impl Into<String>, from: usize) -> SceneError {
        self.at(SceneError::new(code, message), from)
    }

    /// The same for an error that has no place yet.
    pub(super) fn at(&self, error: SceneError, from: usize) -> SceneError {
        let end =
            from + self.bytes[from.min(self.bytes.len())..].iter().take_while(|b| !b.is_ascii_whitespace()).count();
        self.mark(error, from, end)
    }

    /// An error at the end of the file.
    pub(super) fn ends(&self, code: &'static str, wanted: &str) -> SceneError {
        let end = if self.binary { self.bytes.len() } else { self.bytes.trim_ascii_end().len() };
        let error = SceneError::new(code, format!("the file ends where {wanted} should follow"));
        self.mark(error, end, end).value("end of file").hint("the file is cut off")
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

    /// Refuses a text of a format without a mark at its end whose last line has no end: of a number that is cut off, such as the
    /// `1` of `1.75`, what is left looks whole. Behind a comment nothing is missing.
    pub(super) fn last_line_ends(&self, code: &'static str) -> Result<(), SceneError> {
        let from = self.bytes.iter().rposition(|b| *b == b'\n').map_or(0, |at| at + 1);
        let last = &self.bytes[from..];
        let commented = self.comment.is_some_and(|mark| last.contains(&mark));
        if commented || last.last().is_none_or(u8::is_ascii_whitespace) {
            return Ok(());
        }
        let from = last.iter().rposition(|b| b.is_ascii_whitespace()).map_or(from, |at| from + at + 1);
        Err(middle_of_line(self.error(code, MIDDLE_OF_LINE, from), &self.bytes[from..]))
    }

    /// The next word and where it begins, without taking it; none at the end of the file.
    pub(super) fn peek(&mut self) -> Option<(&'a str, usize)> {
        self.skip(true);
        let from = self.at;
        let end = |b: &&u8| !b.is_ascii_whitespace() && Some(**b) != self.comment;
        let length = self.bytes[from..].iter().take_while(end).count();
        // What is no UTF-8 is no word that any format knows.
        (length > 0).then(|| (core::str::from_utf8(&self.bytes[from..from + length]).unwrap_or("\u{fffd}"), from))
    }

    /// The next word and where it begins.
    pub(super) fn word(&mut self, code: &'static str, wanted: &str) -> Result<(&'a str, usize), SceneError> {
        let Some((word, from)) = self.peek() else { return Err(self.ends(code, wanted)) };
        self.at = from
            + self.bytes[from..].iter().take_while(|b| !b.is_ascii_whitespace() && Some(**b) != self.comment).count();
        Ok((word, from))
    }

    /// The next word if it is on the same line.
    pub(super) fn word_of_line(&mut self) -> Option<(&'a str, usize)> {
        self.skip(false);
        if matches!(self.bytes.get(self.at), None | Some(b'\n')) {
            return None;
        }
        self.word("", "").ok()
    }

    /// The rest of the line without blanks around it, and where it begins; the end of the line is taken.
    pub(super) fn line(&mut self) -> (String, usize) {
        self.skip(false);
        let from = self.at;
        let length = self.bytes[from..].iter().take_while(|b| **b != b'\n').count();
        self.at = usize::min(from + length + 1, self.bytes.len());
        (String::from_utf8_lossy(&self.bytes[from..from + length]).trim().to_string(), from)
    }

    /// Refuses anything else on the line; takes its end.
    pub(super) fn line_end(&mut self, code: &'static str, of: &str) -> Result<(), SceneError> {
        self.skip(false);
        match self.bytes.get(self.at) {
            None => Ok(()),
            Some(b'\n') => {
                self.at += 1;
                Ok(())
            }
            Some(_) => {
                let from = self.at;
                let (word, _) = self.word(code, "")?;
                let error = self.error(code, format!("{of} has something behind it"), from);
                Err(error.value(visible(word)).allowed("the end of the line"))
            }
        }
    }

    /// A word that must be a certain one; upper and lower case are the same.
    pub(super) fn expect(&mut self, code: &'static str, wanted: &str) -> Result<(), SceneError> {
        let (word, from) = self.word(code, &format!("`{wanted}`"))?;
        if word.eq_ignore_ascii_case(wanted) {
            return Ok(());
        }
        let error = self.error(code, format!("`{}` stands where `{wanted}` should", visible(word)), from);
        Err(error.value(visible(word)).allowed(wanted))
    }

    /// The next word as a whole number.
    pub(super) fn whole<T: core::str::FromStr>(
        &mut self,
        code: &'static str,
        what: &str,
    ) -> Result<(T, usize), SceneError> {
        let (word, from) = self.word(code, what)?;
        match word.parse() {
            Ok(number) => Ok((number, from)),
            Err(_) => {
                let error = self.error(code, format!("`{}` stands where {what} should", visible(word)), from);
                Err(error.value(visible(word)).allowed("a whole number"))
            }
        }
    }

    /// The next word as a finite number.
    pub(super) fn number(&mut self, code: &'static str, what: &str) -> Result<f64, SceneError> {
        let (word, from) = self.word(code, what)?;
        match word.parse::<f64>() {
            Ok(x) => self.finite(x, what, from),
            Err(_) => {
                let error = self.error(code, format!("`{}` stands where {what} should", visible(word)), from);
                let error = error.value(visible(word)).allowed("a number such as 1.5 or -2e-3");
                Err(if word.contains(',') { error.hint("write a point, not a comma") } else { error })
            }
        }
    }

    /// Refuses a number that is not finite.
    pub(super) fn finite(&self, x: f64, what: &str, from: usize) -> Result<f64, SceneError> {
        if x.is_finite() {
            return Ok(x);
        }
        let error = self.error("scene.not_finite", format!("{what} is not finite"), from);
        Err(error.value(x.to_string()).allowed("a finite number"))
    }

    /// A count that the rest of the file can hold, where each thing takes `least` bytes or more.
    pub(super) fn fits(
        &self,
        code: &'static str,
        count: u64,
        least: u64,
        what: &str,
        from: usize,
    ) -> Result<usize, SceneError> {
        let rest = (self.bytes.len() - self.at) as u64;
        if count.checked_mul(least).is_some_and(|bytes| bytes <= rest + least) {
            return Ok(count as usize);
        }
        let error = self.error(code, format!("{count} {what} are promised, but only {rest} bytes follow"), from);
        Err(error.value(count.to_string()).allowed(format!("at most {}", rest / least)).hint("the file is cut off"))
    }

    /// The next bytes.
    pub(super) fn take(&mut self, count: usize, code: &'static str, what: &str) -> Result<&'a [u8], SceneError> {
        match self.bytes.get(self.at..).and_then(|rest| rest.get(..count)) {
            Some(found) => {
                self.at += count;
                Ok(found)
            }
            None => Err(self.ends(code, what)),
        }
    }

    fn fixed<const N: usize>(&mut self, code: &'static str, what: &str) -> Result<[u8; N], SceneError> {
        let bytes = self.take(N, code, what)?;
        let mut word = [0; N];
        word.copy_from_slice(bytes);
        if self.big_endian {
            word.reverse();
        }
        Ok(word)
    }

    /// A binary whole number of 4 bytes.
    pub(super) fn binary_i32(&mut self, code: &'static str, what: &str) -> Result<i32, SceneError> {
        self.fixed(code, what).map(i32::from_le_bytes)
    }

    /// A binary whole number of 8 bytes.
    pub(super) fn binary_u64(&mut self, code: &'static str, what: &str) -> Result<u64, SceneError> {
        self.fixed(code, what).map(u64::from_le_bytes)
    }

    /// A binary number of 8 bytes, finite.
    pub(super) fn binary_f64(&mut self, code: &'static str, what: &str) -> Result<f64, SceneError> {
        let from = self.at;
        let x = f64::from_le_bytes(self.fixed(code, what)?);
        self.finite(x, what, from)
    }
}
