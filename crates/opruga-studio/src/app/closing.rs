//! The window is asked to close, by its cross or by Alt-F4: what was done and is not saved is asked for first.

use super::Studio;
use crate::panels::keeping::What;
use crate::shown::Shown;
use egui::{Id, Modal, Ui, ViewportCommand};
use std::time::Duration;

/// How long the window waits for the simulation to say whether there is anything to be saved. Where it does not, there may be: a frame
/// that takes longer is one of a large scene.
const PATIENCE: Duration = Duration::from_millis(300);

/// How far the window is on its way to its end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Closing {
    /// Nobody has asked for it.
    #[default]
    No,
    /// The person is asked, since the last picture or for longer.
    Asking { fresh: bool },
    /// The scene is being saved; then the window closes.
    Saving,
    /// It closes.
    Now,
}

/// What a person answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Answer {
    Save,
    Discard,
    Cancel,
}

impl Closing {
    /// Whether a question stands before everything else.
    pub(super) fn is_asking(self) -> bool {
        matches!(self, Closing::Asking { .. })
    }
}

impl Studio {
    /// Lets the window close where nothing is lost by it, and asks the person otherwise.
    pub(super) fn close(&mut self, ui: &Ui, shown: &Shown) {
        if ui.input(|i| i.viewport().close_requested()) && self.closing != Closing::Now {
            if self.closing == Closing::No {
                let copied = self.link.copy_now().recv_timeout(PATIENCE);
                let edited = copied.map_or(true, |copied| copied.edited);
                self.closing = if edited { Closing::Asking { fresh: true } } else { Closing::Now };
            }
            if self.closing != Closing::Now {
                ui.ctx().send_viewport_cmd(ViewportCommand::CancelClose);
            }
        }
        match self.closing {
            Closing::Asking { fresh } => match self.ask_whether_to_save(ui, shown, fresh) {
                Some(Answer::Save) => {
                    self.keeping.begin(What::Scene, &self.link, self.show);
                    self.closing = Closing::Saving;
                }
                Some(Answer::Discard) => self.close_now(ui),
                Some(Answer::Cancel) => self.closing = Closing::No,
                None => self.closing = Closing::Asking { fresh: false },
            },
            Closing::Saving if !self.keeping.is_saving() => match self.keeping.saved() {
                Some(files) => {
                    // The window is gone before anybody could read it there.
                    eprintln!("saved: {}", files.join(", "));
                    self.close_now(ui);
                }
                // Why not stands over the scene.
                None => self.closing = Closing::No,
            },
            Closing::Saving => ui.ctx().request_repaint_after(Duration::from_millis(50)),
            Closing::No | Closing::Now => {}
        }
    }

    fn close_now(&mut self, ui: &Ui) {
        self.closing = Closing::Now;
        ui.ctx().send_viewport_cmd(ViewportCommand::Close);
    }

    fn ask_whether_to_save(&self, ui: &Ui, shown: &Shown, fresh: bool) -> Option<Answer> {
        let words = self.language;
        let mut answer = None;
        let question = Modal::new(Id::unique("close question")).show(ui.ctx(), |ui| {
            ui.set_max_width((ui.ctx().content_rect().width() - 60.0).clamp(120.0, 420.0));
            ui.label(words.close_question().replace("{}", &shown.name));
            ui.add_space(8.0);
            ui.horizontal(|ui| {
                for (what, name) in
                    [(Answer::Save, words.save()), (Answer::Discard, words.discard()), (Answer::Cancel, words.cancel())]
                {
                    let button = ui.button(name);
                    if fresh && what == Answer::Save {
                        button.request_focus();
                    }
                    if button.clicked() {
                        answer = Some(what);
                    }
                }
            });
        });
        answer.or(question.should_close().then_some(Answer::Cancel))
    }
}
