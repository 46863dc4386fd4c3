//! Errors that are found in the text of a scene, in overrides and in files before the contents are interpreted.

use crate::scene::errors::ValueKind;
use opruga_math::{messages, terms};

terms! {
    /// The kinds of input whose size is limited.
    pub(crate) enum Measured = "part.measured" { Scene = "the scene", File = "the file" }
}

messages! {
    /// Errors in a text.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum TextError {
        "scene.syntax" #[error("the text is not TOML: a value is missing")]
        NoValue {},
        "scene.syntax" #[error("the text is not TOML: the list that opens in line {line} is not closed")]
        OpenList { line: usize },
        "scene.syntax" #[error("the text is not TOML: the table that opens in line {line} is not closed")]
        OpenTable { line: usize },
        "scene.syntax" #[error("the text is not TOML: {reason}")]
        Syntax { reason: String },
        "scene.duplicate_key" #[error("`{key}` is given twice, first in line {line}")] #[hint("keep one of the two")]
        TwiceInLines { key: String, line: usize },
        "scene.duplicate_key" #[error("`{key}` is given twice")] #[hint("keep one of the two")]
        Twice { key: String },
        "scene.encoding" #[error("the scene is written in UTF-16 or UTF-32")] #[allowed("UTF-8")] #[hint("save it as UTF-8")]
        Wide {},
        "scene.encoding" #[error("the scene begins with two byte-order marks (U+FEFF)")] #[value("U+FEFF U+FEFF")]
        #[allowed("UTF-8, with at most one byte-order mark")] #[hint("save it as UTF-8 without a byte-order mark")]
        TwoMarks {},
        "scene.encoding" #[error("byte {byte} is not valid UTF-8")] #[allowed("UTF-8")] #[hint("save it as UTF-8")]
        Byte { byte: String },
        "scene.empty" #[error("the scene is empty")] #[hint("`opruga new NAME` writes a scene to begin with")]
        Empty {},
        "scene.depth" #[error("tables and arrays are nested more than {most} levels deep")] #[allowed("at most {most} levels")]
        Depth { most: usize },
        "scene.too_large" #[error("the text has more values, keys and lines than fit into the memory of its reader")]
        #[allowed("at most {values} values in lists, or {lines} lines with a key")] #[hint("large shapes belong in mesh files")]
        Pieces { values: u64, lines: u64 },
        "scene.too_large" #[error("{what} has {size} bytes")] #[value("{size}")] #[allowed("at most {most} bytes")]
        Size { what: Measured, size: u64, most: u64 },
    }

    /// What helps if a text is wrong.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum TextHint {
        "part.text_hint" #[error("a `{bracket}` is missing between here and line {line}")]
        BracketBefore { bracket: char, line: usize },
        "part.text_hint" #[error("a `{bracket}` is missing before here")]
        BracketHere { bracket: char },
        "part.text_hint" #[error("numbers have no units: write {bare}; `opruga reference` gives the unit of every field")]
        Unit { bare: String },
        "part.text_hint" #[error("texts with spaces need quotes")]
        Quotes {},
        "part.text_hint" #[error("`opruga sweep` accepts lists (8,16,32) and ranges (0.5..4:log:7), and makes one run for each value; a vector must be in brackets")]
        Sweep {},
    }

    /// Errors in a file.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum FileError {
        "read.failed" #[error("the file cannot be read: {reason}")]
        Failed { reason: String },
        "read.failed" #[error("there is no file `{name}`")] #[value("{name}")] #[allowed("{known}")]
        NotHeld { name: String, known: String },
        "read.failed" #[error("there is no file `{name}`")] #[value("{name}")] #[allowed("none: a scene without a folder cannot name files")]
        NoFolder { name: String },
        "read.failed" #[error("the file `{name}` does not exist")] #[value("{name}")] #[hint("files are looked up in `{folder}`")]
        NotThere { name: String, folder: String },
        "read.not_regular_file" #[error("this is a folder")]
        Folder {},
        "read.not_regular_file" #[error("this is not a regular file")]
        NotRegular {},
        "read.changed" #[error("the file changed while it was being read")] #[hint("try again once it is saved")]
        Changed {},
        "shape.outside" #[error("`{name}` is outside the folder of the scene")] #[value("{name}")]
        #[allowed("a file in the folder of the scene or below it, with / in its path")]
        #[hint("`--allow-outside` lets a scene read files from anywhere")]
        Outside { name: String },
    }

    /// Errors in an override.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum OverrideError {
        "set.syntax" #[error("`{argument}` is not an override")] #[value("{argument}")] #[allowed("PATH=VALUE")]
        #[hint("for example --set body.ball.mass=2")]
        NoOverride { argument: String },
        "set.value" #[error("the value is missing")] #[allowed("PATH=VALUE")]
        NoValue {},
        "set.value" #[error("the value is not TOML: {reason}")]
        Value { reason: String },
        "set.value" #[error("the value is not TOML: {reason}")] #[allowed("one value")]
        SeveralValues { reason: String },
        "set.path" #[error("`{path}` is not a path")] #[allowed("names separated by single dots")]
        Path { path: String },
        "set.path" #[error("`{list}` has no entry {index}")] #[value("{index}")] #[allowed("it is empty")]
        EmptyList { list: String, index: String },
        "set.path" #[error("`{list}` has no entry {index}")] #[value("{index}")] #[allowed("numbers from 0 to {last}")]
        NoEntry { list: String, index: usize, last: usize },
        "set.path" #[error("`{list}` has no entry `{name}`")] #[value("{name}")] #[allowed("{known}")]
        NoEntryCalled { list: String, name: String, known: String },
        "set.path" #[error("`{list}` has {count} entries called `{name}`")] #[value("{name}")] #[allowed("their numbers: {indices}")]
        SeveralEntries { list: String, count: usize, name: String, indices: String },
        "set.path" #[error("`{value}` is {kind}, which has no fields")] #[value("{field}")]
        NoFields { value: String, kind: ValueKind, field: String },
    }
}

/// All messages of this file.
pub(crate) const MESSAGES: &[&[opruga_math::message::Variant]] =
    &[Measured::VARIANTS, TextError::VARIANTS, TextHint::VARIANTS, FileError::VARIANTS, OverrideError::VARIANTS];
