//! Errors and notices, which say what is wrong, where, and what would be right. The messages are written for people and, as JSON, for programs.

use crate::scene::errors::FieldError;
use core::fmt;
use opruga_math::message::{AnyMessage, IntoField, Message, Replacing};
use opruga_math::words::number;
use opruga_words::Translation;
use opruga_world::Warning;
pub(crate) use opruga_world::validity::unprintable;

opruga_math::terms! {
    /// Words around errors and warnings.
    pub enum Label = "part.label" { Error = "error", Warning = "warning", Note = "note", Allowed = "allowed", Hint = "hint" }
}

opruga_math::messages! {
    /// Texts around the sentence of an error or a warning.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Around {
        "part.label" #[error("{count} times")]
        Times { count: usize },
        "part.label" #[error(", at byte {byte}")]
        AtByte { byte: usize },
        "part.label" #[error("at t = {} s: {about}", number(*time))]
        #[allowed("{}", about.allowed().unwrap_or_default())] #[hint("{}", about.hint().unwrap_or_default())]
        AtTime { time: f64, about: AnyMessage },
        "part.label" #[error("did you mean `{word}`?")]
        Nearest { word: String },
        "part.label" #[error("without --strict, this is a warning")]
        NotStrict {},
    }
}

/// An error in a scene, with its location.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneError {
    /// The code: a stable word that programs can rely on, such as `scene.unknown_field`.
    pub code: &'static str,
    /// What is wrong, in one sentence without a full stop.
    pub message: String,
    /// The file, or the option of the command line.
    pub file: String,
    /// The line, from 1; none if the error belongs to no line.
    pub line: Option<usize>,
    /// The column in characters, from 1.
    pub column: Option<usize>,
    /// The path of the field, as used by `--set`: `body.0.models.1.stiffness`.
    pub path: String,
    /// The offending value, as it was written.
    pub value: Option<String>,
    /// What is allowed.
    pub allowed: Option<String>,
    /// What would help, often the nearest word.
    pub hint: Option<String>,
    /// The offending line, for people.
    pub excerpt: Option<Excerpt>,
    /// The offending byte of a file that has no lines.
    pub byte: Option<usize>,
    /// The error as a value, for translations to other languages. None if there are only the texts above.
    pub about: Option<AnyMessage>,
    /// What would help, as a value, if the message itself does not give it.
    pub advice: Option<AnyMessage>,
    /// What is allowed, as a value, if the message itself does not give it.
    pub allowance: Option<AnyMessage>,
}

/// A line of a file with a part of it marked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Excerpt {
    /// The line, shortened around the marked part, with unprintable characters made visible.
    pub line: String,
    /// The number of characters before the marked part.
    pub start: usize,
    /// The number of marked characters.
    pub length: usize,
}

/// Something unusual in a scene, with a count.
#[derive(Clone, Debug, PartialEq)]
pub struct Notice {
    /// The description of the notice, in the form of an error.
    pub about: SceneError,
    /// How often the notice occurs.
    pub count: usize,
}

impl SceneError {
    /// Makes an error without a line.
    pub fn new(code: &'static str, message: impl Into<String>) -> SceneError {
        SceneError {
            code,
            message: message.into(),
            file: String::new(),
            line: None,
            column: None,
            path: String::new(),
            value: None,
            allowed: None,
            hint: None,
            excerpt: None,
            byte: None,
            about: None,
            advice: None,
            allowance: None,
        }
    }
    /// Makes an error from a message, with its code, its value, what is allowed and what helps, but without a line.
    pub fn of(message: impl Into<AnyMessage>) -> SceneError {
        let about = message.into();
        SceneError {
            value: about.value(),
            allowed: about.allowed(),
            hint: about.hint(),
            about: Some(about.clone()),
            ..SceneError::new(about.code(), about.to_string())
        }
    }
    /// The last entry after the errors that are shown: the number of errors that were only counted.
    pub(crate) fn and_more(count: usize) -> SceneError {
        SceneError::of(FieldError::More { count })
    }
    /// The number of errors that this error represents.
    fn stands_for(&self) -> usize {
        match (&self.value, self.code) {
            (Some(count), MORE) => count.parse().unwrap_or(1),
            _ => 1,
        }
    }
    /// Adds the path of the field.
    #[must_use]
    pub fn path(mut self, path: impl Into<String>) -> SceneError {
        self.path = path.into();
        self
    }
    /// Adds the offending value.
    #[must_use]
    pub fn value(mut self, value: impl Into<String>) -> SceneError {
        self.value = Some(value.into());
        self
    }
    /// Adds what is allowed.
    #[must_use]
    pub fn allowed(mut self, allowed: impl Into<String>) -> SceneError {
        self.allowed = Some(allowed.into());
        self
    }
    /// Adds what would help.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> SceneError {
        self.hint = Some(hint.into());
        self
    }
    /// Adds what is allowed, as a value.
    #[must_use]
    pub fn allows(mut self, allowance: impl Into<AnyMessage>) -> SceneError {
        let allowance = allowance.into();
        self.allowed = Some(allowance.to_string());
        self.allowance = Some(allowance);
        self
    }
    /// Adds what would help, as a value.
    #[must_use]
    pub fn advice(mut self, advice: impl Into<AnyMessage>) -> SceneError {
        let advice = advice.into();
        self.hint = Some(advice.to_string());
        self.advice = Some(advice);
        self
    }
    /// Adds the nearest word as a hint, if one is near.
    #[must_use]
    pub fn nearest(self, word: Option<String>) -> SceneError {
        match word {
            Some(word) => self.advice(Around::Nearest { word }),
            None => self,
        }
    }
    /// The error object of the command line: `{code, message, file, line, column, path, value, allowed, hint}`; missing parts are null.
    pub fn to_json(&self) -> serde_json::Value {
        let there = |text: &String| Some(text.clone()).filter(|text| !text.is_empty());
        serde_json::json!({
            "code": self.code,
            "message": self.sentence(None),
            "file": there(&self.file),
            "line": self.line,
            "column": self.column,
            "path": there(&self.path),
            "value": self.value,
            "allowed": self.allowed,
            "hint": self.hint,
        })
    }
    /// The sentence that says what is wrong, in the language of the translation, or in English if there is none.
    pub fn sentence(&self, translation: Option<&Translation>) -> String {
        let text = self.sentence_alone(translation);
        let suffix = self.byte.map_or_else(String::new, |byte| in_words(translation, &Around::AtByte { byte }));
        text + &suffix
    }
    /// The text that [`fmt::Display`] writes, in the language of a translation.
    pub fn text(&self, translation: Option<&Translation>) -> String {
        describe(self, Label::Error, translation)
    }
    /// The same error with other settings and names.
    #[must_use]
    pub fn replaced(mut self, by: &Replacing<'_>) -> SceneError {
        let mut changed = false;
        for message in [&mut self.about, &mut self.advice, &mut self.allowance].into_iter().flatten() {
            let replaced = IntoField::replaced(message, by);
            changed |= replaced != *message;
            *message = replaced;
        }
        // If no name or setting in the message changes, texts that were set in addition to it are kept.
        if !changed {
            return self;
        }
        let Some(about) = &self.about else { return self };
        let text = |message: &Option<AnyMessage>| message.as_ref().map(AnyMessage::to_string);
        self.message = about.to_string();
        self.allowed = text(&self.allowance).or_else(|| about.allowed()).or(self.allowed);
        self.hint = text(&self.advice).or_else(|| about.hint()).or(self.hint);
        self
    }
    /// The sentence without a location.
    fn sentence_alone(&self, translation: Option<&Translation>) -> String {
        let known = translation.zip(self.about.as_ref()).and_then(|(translation, about)| translation.text(&**about));
        known.unwrap_or_else(|| self.message.clone())
    }
    /// What is allowed and what helps.
    fn beside(&self, translation: Option<&Translation>) -> (Option<String>, Option<String>) {
        let known = translation.zip(self.about.as_ref());
        let allowance = translation.zip(self.allowance.as_ref()).and_then(|(own, allowance)| own.text(&**allowance));
        let allowed = || allowance.or_else(|| known.and_then(|(own, about)| own.allowed(&**about)));
        let advice = translation.zip(self.advice.as_ref()).and_then(|(own, advice)| own.text(&**advice));
        let hint = || advice.or_else(|| known.and_then(|(own, about)| own.hint(&**about)));
        (
            self.allowed.clone().map(|english| allowed().unwrap_or(english)),
            self.hint.clone().map(|english| hint().unwrap_or(english)),
        )
    }
    /// The exit code of a program that stops because of this error.
    pub fn exit_code(&self) -> i32 {
        if self.code.starts_with("read.") { 4 } else { 2 }
    }
}

/// The code of the error that stands for the errors that are not shown.
const MORE: &str = "scene.more";

/// The largest number of errors that are shown for a file. After fixing fifty errors, the user runs the check again.
pub const MOST_SHOWN: usize = 50;

/// The first errors of a list, followed by an error that gives the number of the others.
pub fn shown(mut errors: Vec<SceneError>) -> Vec<SceneError> {
    let of_list = |error: &SceneError| error.code != MORE;
    let mut hidden: usize = errors.iter().filter(|error| !of_list(error)).map(SceneError::stands_for).sum();
    let file = errors.first().map(|error| error.file.clone()).unwrap_or_default();
    errors.retain(of_list);
    hidden += errors.len().saturating_sub(MOST_SHOWN);
    errors.truncate(MOST_SHOWN);
    if hidden > 0 {
        errors.push(SceneError { file, ..SceneError::and_more(hidden) });
    }
    errors
}

/// The number of errors that a list represents.
pub fn count_of(errors: &[SceneError]) -> usize {
    errors.iter().map(SceneError::stands_for).sum()
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text(None))
    }
}

impl std::error::Error for SceneError {}

/// Notices about what the scene itself asks for, or about what is usual in files, such as concave faces. Such notices are worth knowing, but do not
/// become errors when warnings are treated as errors.
const ASKED_FOR: [&str; 3] = ["shape.overlap", "shape.dropped", "mesh.concave_face"];

impl Notice {
    /// Whether a notice with this code only reports what the scene asked for, or a property of the file.
    pub fn is_asked_for(code: &str) -> bool {
        ASKED_FOR.contains(&code)
    }
    /// The text that [`fmt::Display`] writes, in the language of a translation.
    pub fn text(&self, translation: Option<&Translation>) -> String {
        let severity = if Notice::is_asked_for(self.about.code) { Label::Note } else { Label::Warning };
        let text = describe(&self.about, severity, translation);
        match self.count {
            0 | 1 => text,
            count => format!("{text}\n  = {}", in_words(translation, &Around::Times { count })),
        }
    }
}

/// The notice without its location in the file.
impl From<Notice> for Warning {
    fn from(Notice { about, count }: Notice) -> Warning {
        let message = about.sentence(None);
        Warning { code: about.code.into(), message, count: count as u64, about: about.about }
    }
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text(None))
    }
}

/// A message in the language of a translation, or in English if there is none.
pub fn in_words(translation: Option<&Translation>, message: &dyn Message) -> String {
    translation.map_or_else(|| message.to_string(), |translation| translation.text_or_english(message))
}

/// The text of a warning of a world, for people.
pub fn warning_text(warning: &Warning, translation: Option<&Translation>) -> String {
    let known = translation.zip(warning.about.as_ref()).and_then(|(own, about)| own.in_full(&**about));
    let message = known.unwrap_or_else(|| warning.message.clone());
    let text = format!("{}[{}]: {message}", in_words(translation, &Label::Warning), warning.code);
    match warning.count {
        0 | 1 => text,
        count => format!("{text} ({})", in_words(translation, &Around::Times { count: count as usize })),
    }
}

/// `file:line:column: error[code]: message`, the line with its marked part, what is allowed, and what would help.
fn describe(error: &SceneError, severity: Label, translation: Option<&Translation>) -> String {
    let mut out = String::new();
    if !error.file.is_empty() {
        out += &format!("{}:", visible(&error.file));
        if let (Some(line), Some(column)) = (error.line, error.column) {
            out += &format!("{line}:{column}:");
        }
        out.push(' ');
    }
    out += &format!("{}[{}]: {}", in_words(translation, &severity), error.code, error.sentence(translation));
    if let (Some(excerpt), Some(line)) = (&error.excerpt, error.line) {
        let number = line.to_string();
        let margin = " ".repeat(number.len());
        out += &format!("\n {number} | {}", excerpt.line);
        out += &format!("\n {margin} | {}{}", " ".repeat(excerpt.start), "^".repeat(excerpt.length));
    }
    let (allowed, hint) = error.beside(translation);
    for (label, text) in [(Label::Allowed, allowed), (Label::Hint, hint)] {
        if let Some(text) = text {
            out += &format!("\n  = {}: {text}", in_words(translation, &label));
        }
    }
    out
}

/// Makes a text from outside safe to print: control characters, marks that change the direction of writing and invisible characters are escaped, and
/// texts of more than 120 characters are cut.
pub fn visible(text: &str) -> String {
    let mut out = String::new();
    for (n, c) in text.chars().enumerate() {
        if n == 120 {
            out.push('…');
            break;
        }
        if unprintable(c) { out.extend(c.escape_unicode()) } else { out.push(c) }
    }
    out
}
