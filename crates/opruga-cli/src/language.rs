//! The language of the errors and warnings that people read. JSON is in English.

use clap::ValueEnum;
use opruga::words::Translation;
use std::sync::OnceLock;

static CHOSEN: OnceLock<Language> = OnceLock::new();

/// A language of errors and warnings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Language {
    /// English
    #[default]
    En,
    /// Croatian
    Hr,
}

/// Sets the language once, after the arguments have been read.
pub(crate) fn choose(language: Language) {
    let _ = CHOSEN.set(language);
}

/// The texts of the chosen language, or `None` for English.
pub(crate) fn translation() -> Option<&'static Translation> {
    match CHOSEN.get() {
        Some(Language::Hr) => Some(Translation::croatian()),
        _ => None,
    }
}
