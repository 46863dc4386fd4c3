//! What is wrong, where, and what would be right: for people and, as JSON, for programs.

use core::fmt;
pub(crate) use opruga_world::validity::unprintable;

/// An error in a scene, with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneError {
    /// A stable word for programs, such as `scene.unknown_field`.
    pub code: &'static str,
    /// What is wrong, in one sentence without a full stop.
    pub message: String,
    /// The file, or the option of the command line.
    pub file: String,
    /// The line, from 1; none where the error is in no line.
    pub line: Option<usize>,
    /// The column in characters, from 1.
    pub column: Option<usize>,
    /// The path of the field, as `--set` takes it: `body.0.models.1.stiffness`.
    pub path: String,
    /// The offending value, as it was written.
    pub value: Option<String>,
    /// What is allowed.
    pub allowed: Option<String>,
    /// What would help, often the nearest word.
    pub hint: Option<String>,
    /// The offending line, for people.
    pub excerpt: Option<Excerpt>,
}

/// A line of a file with a part of it marked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Excerpt {
    /// The line, shortened around the marked part, unprintable characters made visible.
    pub line: String,
    /// How many characters lie before the marked part.
    pub start: usize,
    /// How many characters are marked.
    pub length: usize,
}

/// Something odd that a scene may do: counted, never silent.
#[derive(Clone, Debug, PartialEq)]
pub struct Notice {
    /// The same description as that of an error.
    pub about: SceneError,
    /// How often it occurs.
    pub count: usize,
}

impl SceneError {
    /// An error in no particular line.
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
        }
    }
    /// What stands behind the errors that are shown: so many were only counted.
    pub(crate) fn and_more(count: usize) -> SceneError {
        SceneError { value: Some(count.to_string()), ..SceneError::new(MORE, format!("and {count} more")) }
    }
    /// How many errors this one stands for.
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
    /// Adds the nearest word as a hint, if one is near.
    #[must_use]
    pub fn nearest(mut self, word: Option<String>) -> SceneError {
        if let Some(word) = word {
            self.hint = Some(format!("did you mean `{word}`?"));
        }
        self
    }
    /// The error object of the command line: `{code, message, file, line, column, path, value, allowed, hint}`; what an
    /// error does not have is null.
    pub fn to_json(&self) -> serde_json::Value {
        let there = |text: &String| Some(text.clone()).filter(|text| !text.is_empty());
        serde_json::json!({
            "code": self.code,
            "message": self.message,
            "file": there(&self.file),
            "line": self.line,
            "column": self.column,
            "path": there(&self.path),
            "value": self.value,
            "allowed": self.allowed,
            "hint": self.hint,
        })
    }
    /// The exit code of a program that stops because of this error.
    pub fn exit_code(&self) -> i32 {
        if self.code.starts_with("read.") { 4 } else { 2 }
    }
}

/// The code of the error that stands for those that are not shown.
const MORE: &str = "scene.more";

/// The most errors that are shown of a file: who has mended fifty calls again.
pub const MOST_SHOWN: usize = 50;

/// The first errors of a list, and one behind them that says how many more there are.
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

/// How many errors a list stands for.
pub fn count_of(errors: &[SceneError]) -> usize {
    errors.iter().map(SceneError::stands_for).sum()
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        describe(f, self, "error")
    }
}

impl std::error::Error for SceneError {}

/// What is told of because the scene itself asks for it, or a flat face with all of its corners is nothing odd: worth knowing, and no error where
/// warnings are errors.
const ASKED_FOR: [&str; 3] = ["shape.overlap", "shape.dropped", "mesh.concave_face"];

impl Notice {
    /// Whether a notice of this code tells of nothing but what was asked for, or stands so in the file.
    pub fn is_asked_for(code: &str) -> bool {
        ASKED_FOR.contains(&code)
    }
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        describe(f, &self.about, if Notice::is_asked_for(self.about.code) { "note" } else { "warning" })?;
        if self.count > 1 { write!(f, "\n  = {} times", self.count) } else { Ok(()) }
    }
}

/// `file:line:column: error[code]: message`, the line with its marked part, what is allowed, what would help.
fn describe(f: &mut fmt::Formatter<'_>, error: &SceneError, severity: &str) -> fmt::Result {
    if !error.file.is_empty() {
        write!(f, "{}:", visible(&error.file))?;
        if let (Some(line), Some(column)) = (error.line, error.column) {
            write!(f, "{line}:{column}:")?;
        }
        write!(f, " ")?;
    }
    write!(f, "{severity}[{}]: {}", error.code, error.message)?;
    if let (Some(excerpt), Some(line)) = (&error.excerpt, error.line) {
        let number = line.to_string();
        let margin = " ".repeat(number.len());
        write!(f, "\n {number} | {}", excerpt.line)?;
        write!(f, "\n {margin} | {}{}", " ".repeat(excerpt.start), "^".repeat(excerpt.length))?;
    }
    if let Some(allowed) = &error.allowed {
        write!(f, "\n  = allowed: {allowed}")?;
    }
    if let Some(hint) = &error.hint {
        write!(f, "\n  = hint: {hint}")?;
    }
    Ok(())
}

/// A text from outside, fit to be printed: control characters, marks that turn the direction of writing and invisible
/// characters are written as escapes, and more than 120 characters are cut.
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
