//! Exchanges scenes with the outside in other ways than by saving: files that were dropped or chosen and, on a web page, the address that contains
//! the scene.

use crate::report::Report;
use crate::runner::Link;
use crate::session::Request;
use crate::shown::Severity;
use egui::Ui;

/// The result of reading a file or an address.
pub(crate) enum Arrived {
    /// A request for the session.
    Request(Request),
    /// A report for the user.
    Message(Severity, Report),
}

impl Arrived {
    fn of(outcome: Result<Request, Report>) -> Arrived {
        outcome.map_or_else(|refused| Arrived::Message(Severity::Refused, refused), Arrived::Request)
    }
}

#[cfg(target_arch = "wasm32")]
pub(crate) use page::Hand;
#[cfg(not(target_arch = "wasm32"))]
pub(crate) use window::Hand;

#[cfg(not(target_arch = "wasm32"))]
mod window {
    use super::*;

    /// A desktop window gets files from the system, and has no address.
    #[derive(Debug, Default)]
    pub(crate) struct Hand {}

    impl Hand {
        pub(crate) fn copy_link(&mut self, _: &Link) {}

        pub(crate) fn choose_file(&mut self) {}

        pub(crate) fn arrived(&mut self, ui: &Ui) -> Vec<Arrived> {
            let files = ui.input(|i| i.raw.dropped_files.clone());
            files.iter().map(|file| Arrived::of(crate::dropping::take(file.path()))).collect()
        }
    }
}

#[cfg(target_arch = "wasm32")]
mod page {
    use super::*;
    use crate::browser::{self, Chosen};
    use crate::runner::Copied;
    use crate::share::{self, Shared};
    use crate::work;
    use opruga::io::scene::Limits;
    use std::sync::Arc;
    use std::sync::mpsc::{Receiver, TryRecvError};

    /// The request for a file that the browser provides: see [`crate::dropping`].
    fn request_of(file: &str, bytes: Vec<u8>) -> Result<Request, Report> {
        let content: Arc<[u8]> = bytes.as_slice().into();
        let files = || opruga::scenes::files().with([(file.to_string(), content)]);
        crate::dropping::request(file, || Ok(bytes), files)
    }

    /// A web page reads files in parallel to the interface, and stores the scene in its address.
    #[derive(Debug, Default)]
    pub(crate) struct Hand {
        linked: Option<Receiver<Copied>>,
        files: Vec<Receiver<Chosen>>,
    }

    impl Hand {
        pub(crate) fn copy_link(&mut self, link: &Link) {
            self.linked = Some(link.copy());
        }

        pub(crate) fn choose_file(&mut self) {
            let endings = ".toml,.svg,.obj,.stl,.ply,.gltf,.glb";
            self.files.push(browser::choose(endings, Limits::default().file_bytes));
        }

        pub(crate) fn arrived(&mut self, ui: &Ui) -> Vec<Arrived> {
            let mut arrived = Vec::new();
            for dropped in ui.input(|i| i.raw.dropped_files.clone()) {
                let Some(file) = dropped.web_file().cloned() else { continue };
                self.files.push(work::spawn(async move { browser::read(&file, Limits::default().file_bytes).await }));
            }
            self.files.retain(|file| match file.try_recv() {
                Ok(file) => {
                    arrived.push(Arrived::of(file.and_then(|(name, bytes)| request_of(&name, bytes))));
                    false
                }
                Err(TryRecvError::Empty) => true,
                Err(TryRecvError::Disconnected) => false,
            });
            if let Some(copied) = self.linked.as_ref().and_then(work::done) {
                self.linked = None;
                let shared = Shared { name: copied.name, text: copied.text, files: copied.files };
                arrived.push(match share::to_fragment(&shared).and_then(|fragment| browser::set_fragment(&fragment)) {
                    Ok(address) => {
                        ui.ctx().copy_text(address);
                        Arrived::Message(Severity::Done, Report::LinkCopied)
                    }
                    Err(refused) => Arrived::Message(Severity::Refused, refused),
                });
            }
            if !self.files.is_empty() || self.linked.is_some() {
                ui.ctx().request_repaint_after(std::time::Duration::from_millis(100));
            }
            arrived
        }
    }
}
