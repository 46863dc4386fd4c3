//! Closes the window when the user presses its button or Alt-F4. If there is unsaved work, the user is asked first.

use super::Studio;
use crate::panels::keeping::What;
use crate::shown::Shown;
use egui::{Id, Modal, Ui, ViewportCommand};
use std::time::Duration;

/// How long the window waits for the simulation to report whether there is unsaved work. If the simulation does not answer in time, it is computing a
/// long frame of a large scene, and the window assumes that there is unsaved work.
const PATIENCE: Duration = Duration::from_millis(300);

/// The state of closing the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Closing {
    /// The user has not asked to close the window.
    #[default]
    No,
    /// The user is being asked. `fresh` is set for the first picture that shows the question.
    Asking { fresh: bool },
    /// The scene is being saved; after that the window closes.
    Saving,
    /// The window closes now.
    Now,
}

/// The answer of the user.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Answer {
    Save,
    Discard,
    Cancel,
}

impl Closing {
    /// Whether a modal question is open.
    pub(super) fn is_asking(self) -> bool {
        matches!(self, Closing::Asking { .. })
    }
}

impl Studio {
    /// Lets the window close if nothing is lost, and asks the user otherwise.
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
                    // The report is also printed, because the window closes before anyone can read the report in it.
                    eprintln!("saved: {}", files.join(", "));
                    self.close_now(ui);
                }
                // The scene was not saved; the reason is shown over the scene.
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
