//! Errors, warnings and names of kinds in other languages: translations in Fluent syntax, looked up by code, variant and fields of a message, and by
//! the path of a name.
//!
//! The name of an entry consists of the code, in which `-` replaces the point, and the variant: `msh-version-Unknown`. The attributes `.allowed` and
//! `.hint` of the entry are the texts of the same name. A field is a variable; if it is a message itself, its own entry is used. The cases of a
//! selector match a count by numbers and by plural categories of the language. These cases match a text by the text itself, a message by its variant,
//! and a missing field by `none`. `NUMBER` supports `maximumSignificantDigits`, which is 6 by default. The first argument of `ALLOWED` and `HINT` is
//! a field that is a message: `ALLOWED` inserts the allowed values of this message, and `HINT` its hint. If the message has none, the text of the
//! next argument is used. `ABOUT` inserts the description of the parameter whose path is in a field. If the text of an entry is empty, the English
//! text is used instead.
//!
//! # Source
//! Project Fluent, "Fluent Syntax Guide", <https://projectfluent.org/fluent/guide/>; Unicode CLDR, "Language Plural Rules".

use fluent_syntax::ast::{
    CallArguments, Entry, Expression, InlineExpression, Message as Known, Pattern, PatternElement, VariantKey,
};
use fluent_syntax::parser::parse_runtime;
use fluent_syntax::unicode::unescape_unicode_to_string;
use opruga_math::message::{Field, Message};
use opruga_math::words::rounded;
use std::collections::HashMap;
use std::sync::{LazyLock, RwLock};

mod names;
pub use names::Named;

static CROATIAN: LazyLock<Translation> = LazyLock::new(|| {
    let translation = Translation::new(&CROATIAN_FILES).0;
    // A test checks that there are no problems.
    let _ = translation.add_names(CROATIAN_NAMES);
    translation
});

/// The Croatian names of kinds and parameters.
const CROATIAN_NAMES: &str = include_str!("../hr/kinds.ftl");

/// The Croatian texts, in files by their origin.
const CROATIAN_FILES: [&str; 11] = [
    include_str!("../hr/problems.ftl"),
    include_str!("../hr/limits.ftl"),
    include_str!("../hr/meshes.ftl"),
    include_str!("../hr/mesh_files.ftl"),
    include_str!("../hr/shapes.ftl"),
    include_str!("../hr/scenes.ftl"),
    include_str!("../hr/refusals.ftl"),
    include_str!("../hr/sweeps.ftl"),
    include_str!("../hr/files.ftl"),
    include_str!("../hr/models.ftl"),
    include_str!("../hr/warnings.ftl"),
];

/// The texts of a language.
#[derive(Debug, Default)]
pub struct Translation {
    entries: HashMap<&'static str, Known<&'static str>>,
    names: RwLock<names::Names>,
}

impl Translation {
    /// The Croatian texts.
    pub fn croatian() -> &'static Translation {
        &CROATIAN
    }

    /// Parses the texts of files; also returns their errors. If two entries have the same name, the later entry is used.
    fn new(files: &[&'static str]) -> (Translation, Vec<String>) {
        let (mut translation, mut problems) = (Translation::default(), Vec::new());
        for file in files {
            let resource = parse_runtime(*file).unwrap_or_else(|(resource, errors)| {
                problems.extend(errors.iter().map(|error| format!("{error} at byte {}", error.pos.start)));
                resource
            });
            for entry in resource.body {
                if let Entry::Message(message) = entry
                    && let Some(twice) = translation.entries.insert(message.id.name, message)
                {
                    problems.push(format!("there are two entries `{}`", twice.id.name));
                }
            }
        }
        (translation, problems)
    }

    /// The text of a message; none if the translation does not contain it.
    pub fn text(&self, message: &dyn Message) -> Option<String> {
        let pattern = self.entry(message)?.value.as_ref()?;
        Some(self.resolved(pattern, &message.fields())).filter(|text| !text.is_empty())
    }

    /// The text of a message; in English if the translation does not contain it.
    pub fn text_or_english(&self, message: &dyn Message) -> String {
        self.text(message).unwrap_or_else(|| message.to_string())
    }

    /// The allowed values of a message; none if it has none.
    pub fn allowed(&self, message: &dyn Message) -> Option<String> {
        self.beside(message, "allowed").or_else(|| message.allowed())
    }

    /// The hint of a message; none if it has none.
    pub fn hint(&self, message: &dyn Message) -> Option<String> {
        self.beside(message, "hint").or_else(|| message.hint())
    }

    /// The text of a message with its allowed values and its hint, as [`Message::in_full`] in English.
    pub fn in_full(&self, message: &dyn Message) -> Option<String> {
        let beside = [("dopušteno", self.allowed(message)), ("savjet", self.hint(message))];
        let beside = beside.into_iter().filter_map(|(label, text)| text.map(|text| format!("; {label}: {text}")));
        Some(self.text(message)? + &beside.collect::<String>())
    }

    fn beside(&self, message: &dyn Message, name: &str) -> Option<String> {
        let pattern = self.entry(message)?.attributes.iter().find(|attribute| attribute.id.name == name)?;
        Some(self.resolved(&pattern.value, &message.fields())).filter(|text| !text.is_empty())
    }

    /// The allowed values (`ALLOWED`) or the hint (`HINT`) of the message in the first argument. If the message has none, those of the first other
    /// argument that has some are used.
    fn beside_of(
        &self,
        name: &str,
        arguments: &CallArguments<&'static str>,
        fields: &[(&'static str, Field)],
    ) -> String {
        let messages = arguments.positional.iter().map(|argument| match argument {
            InlineExpression::VariableReference { id } => match field(fields, id.name) {
                Some(Field::Message(message)) => Some(message),
                _ => None,
            },
            _ => None,
        });
        let texts = messages.enumerate().map(|(index, message)| match (index, name) {
            (0, "ALLOWED") => self.allowed(&**message?),
            (0, _) => self.hint(&**message?),
            _ => Some(self.text_or_english(&**message?)),
        });
        texts.flatten().next().unwrap_or_default()
    }

    /// The description of the parameter whose path is in a field; empty if the language has none.
    fn about(&self, arguments: &CallArguments<&'static str>, fields: &[(&'static str, Field)]) -> String {
        let Some(InlineExpression::VariableReference { id }) = arguments.positional.first() else {
            return String::new();
        };
        let path = field(fields, id.name).map_or_else(String::new, Field::to_string);
        let [part, kind, parameter] = path.split('-').collect::<Vec<_>>()[..] else { return String::new() };
        self.named_parameter(part, kind, parameter).map_or_else(String::new, |known| known.about.into())
    }

    fn entry(&self, message: &dyn Message) -> Option<&Known<&'static str>> {
        self.entries.get(&*entry_name(message.code(), message.variant()))
    }

    fn resolved(&self, pattern: &Pattern<&'static str>, fields: &[(&'static str, Field)]) -> String {
        let mut out = String::new();
        for element in &pattern.elements {
            match element {
                PatternElement::TextElement { value } => out += value,
                PatternElement::Placeable { expression } => out += &self.filled(expression, fields),
            }
        }
        out
    }

    fn filled(&self, expression: &Expression<&'static str>, fields: &[(&'static str, Field)]) -> String {
        match expression {
            Expression::Inline(InlineExpression::VariableReference { id }) => match field(fields, id.name) {
                Some(Field::Message(message)) => self.text_or_english(&**message),
                Some(field) => field.to_string(),
                None => format!("{{${}}}", id.name),
            },
            Expression::Inline(InlineExpression::StringLiteral { value }) => unescape_unicode_to_string(value).into(),
            Expression::Inline(InlineExpression::NumberLiteral { value }) => (*value).into(),
            Expression::Inline(InlineExpression::Placeable { expression }) => self.filled(expression, fields),
            Expression::Inline(InlineExpression::FunctionReference { id, arguments }) => match id.name {
                "NUMBER" => number_of(arguments, fields),
                "ABOUT" => self.about(arguments, fields),
                name => self.beside_of(name, arguments, fields),
            },
            Expression::Inline(InlineExpression::MessageReference { id, .. }) => {
                let pattern = self.entries.get(id.name).and_then(|entry| entry.value.as_ref());
                pattern.map_or_else(String::new, |pattern| self.resolved(pattern, fields))
            }
            Expression::Select { selector: InlineExpression::VariableReference { id }, variants } => {
                let value = field(fields, id.name);
                let fits = |key: &VariantKey<&str>| value.is_some_and(|value| fits(key, value));
                let chosen = variants.iter().find(|variant| fits(&variant.key));
                let chosen = chosen.or_else(|| variants.iter().find(|variant| variant.default));
                chosen.map_or_else(String::new, |variant| self.resolved(&variant.value, fields))
            }
            // Terms are not supported here.
            _ => String::new(),
        }
    }
}

mod complete;

/// The name of the entry of a message in a translation.
fn entry_name(code: &str, variant: &str) -> String {
    format!("{}-{variant}", code.replace('.', "-"))
}

/// A number with a given number of significant digits, as requested by `NUMBER($x, maximumSignificantDigits: 3)`.
fn number_of(arguments: &CallArguments<&'static str>, fields: &[(&'static str, Field)]) -> String {
    let digits = arguments.named.iter().find_map(|argument| match &argument.value {
        InlineExpression::NumberLiteral { value } => value.parse().ok(),
        _ => None,
    });
    match arguments.positional.first() {
        Some(InlineExpression::VariableReference { id }) => match field(fields, id.name) {
            Some(Field::Number(x)) => rounded(*x, digits.unwrap_or(6)),
            other => other.map_or_else(String::new, Field::to_string),
        },
        _ => String::new(),
    }
}

fn field<'f>(fields: &'f [(&'static str, Field)], name: &str) -> Option<&'f Field> {
    fields.iter().find(|(known, _)| *known == name).map(|(_, value)| value)
}

/// Whether a case of a selector matches a value.
fn fits(key: &VariantKey<&str>, value: &Field) -> bool {
    match (key, value) {
        (VariantKey::NumberLiteral { value }, Field::Count(count)) => value.parse() == Ok(*count),
        (VariantKey::Identifier { name }, Field::Count(count)) => *name == plural(*count),
        (VariantKey::Identifier { name }, Field::Text(text)) => name == text || *name == "none" && text.is_empty(),
        (VariantKey::Identifier { name }, Field::Message(message)) => *name == message.variant(),
        _ => false,
    }
}

/// The plural category of a whole number in Croatian: `one` (1, 21), `few` (2 to 4, 22) or `other` (0, 5, 11).
fn plural(count: i64) -> &'static str {
    match (count.unsigned_abs() % 10, count.unsigned_abs() % 100) {
        (_, 11..=14) => "other",
        (1, _) => "one",
        (2..=4, _) => "few",
        _ => "other",
    }
}

#[cfg(test)]
mod tests;
