//! The action of a press of the pointer.

use crate::words::Language;

/// The action of a press of the primary button.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tool {
    /// Pull.
    #[default]
    Pull,
    /// Push.
    Push,
    /// Pin, and move pinned points.
    Pin,
    /// Move a body.
    Shift,
    /// Draw an outline.
    Draw,
}

impl Tool {
    /// All tools, in the order of the toolbar.
    pub const ALL: [Tool; 5] = [Tool::Pull, Tool::Push, Tool::Pin, Tool::Shift, Tool::Draw];

    /// The name of the tool and a text about what it does.
    pub fn words(self, language: Language) -> (&'static str, &'static str) {
        match self {
            Tool::Pull => (language.pull(), language.pull_hint()),
            Tool::Push => (language.push(), language.push_hint()),
            Tool::Pin => (language.pin(), language.pin_hint()),
            Tool::Shift => (language.shift(), language.shift_hint()),
            Tool::Draw => (language.draw(), language.draw_hint()),
        }
    }
}
