//! The simulation behind the interface. The interface sends requests to it and receives its latest picture. The simulation runs on its own thread or,
//! in a browser, in the time that remains between pictures of the window.

pub mod sliced;
#[cfg(not(target_arch = "wasm32"))]
pub mod threaded;

#[cfg(target_arch = "wasm32")]
pub use sliced::Link;
#[cfg(not(target_arch = "wasm32"))]
pub use threaded::Link;

use crate::differences::Difference;
use crate::session::{Request, Session};
use crate::shown::Shown;
use opruga::Registries;
use opruga::io::Files;
use std::sync::mpsc::Sender;
use std::time::Duration;
use web_time::Instant;

/// The data that are needed to run the scene again from its start: its text, the files that it names, and the number of frames.
#[derive(Clone, Debug)]
pub struct Copied {
    /// The name of the scene.
    pub name: String,
    /// The text of the scene with everything that was done.
    pub text: String,
    /// The location of the files that the scene names.
    pub files: Files,
    /// The models and integrators that the scene can name.
    pub registries: Registries,
    /// How the scene on the right differs from the scene on the left; `None` if only one scene is shown.
    pub differences: Option<Vec<Difference>>,
    /// The number of frames up to the last frame of this run.
    pub frames: u64,
    /// A fingerprint of the present text.
    pub mark: u64,
    /// Whether anything was edited or recorded after the scene was opened or saved.
    pub edited: bool,
}

impl Copied {
    /// The copy of a session.
    pub fn of(session: &Session) -> Copied {
        Copied {
            name: session.name().to_string(),
            text: session.saved(),
            files: session.files().clone(),
            registries: session.registries().clone(),
            differences: session.differences().map(<[_]>::to_vec),
            frames: session.latest(),
            mark: session.mark(),
            edited: session.is_edited(),
        }
    }
}

/// A request of the interface.
enum Ask {
    Do(Request),
    Copy(Sender<Copied>),
}

/// A session with the clock that it follows.
struct Course {
    session: Session,
    begin: Instant,
    /// The time on the clock at the previous turn.
    last: Duration,
}

impl Course {
    fn new(session: Session) -> Course {
        Course { session, begin: Instant::now(), last: Duration::ZERO }
    }

    /// Forgets the time that has passed since the previous turn, because nothing moved.
    fn rest(&mut self) {
        self.last = self.begin.elapsed();
    }

    /// Handles the requests, and lets the simulation advance by the time that has passed since the previous turn. Returns the picture, if there is a
    /// new one.
    fn turn(&mut self, asks: impl IntoIterator<Item = Ask>, budget: Duration) -> Option<Shown> {
        let mut news = false;
        for ask in asks {
            news = true;
            match ask {
                Ask::Do(request) => self.session.handle(request),
                Ask::Copy(reply) => {
                    // The sender of the request may no longer exist.
                    let _ = reply.send(Copied::of(&self.session));
                }
            }
        }
        let begin = self.begin;
        let clock = move || begin.elapsed();
        let now = clock();
        let (before, was_seeking, message_count) =
            (self.session.frames(), self.session.is_seeking(), self.session.message_count());
        self.session.tick(now.saturating_sub(self.last), budget, &clock);
        self.last = now;
        // A frame that fails also needs a new picture, although it changes nothing.
        news |= self.session.frames() != before || was_seeking || self.session.message_count() != message_count;
        news.then(|| self.session.shown())
    }
}
