//! The simulation on a thread of its own: the interface sends what is asked and takes the last picture; neither waits.

use crate::pair::Difference;
use crate::session::{Request, Session};
use crate::shown::Shown;
use opruga::io::Files;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// How long frames are computed before a new picture is shown.
const BUDGET: Duration = Duration::from_millis(14);
/// How long the thread sleeps while time passes and no frame is due.
const NAP: Duration = Duration::from_millis(3);

/// The scene as it can be run again from its start: its text, the files it names, and how many frames.
#[derive(Clone, Debug)]
pub struct Copied {
    /// Its name.
    pub name: String,
    /// Its text with everything that was done.
    pub text: String,
    /// Where the files are that it names.
    pub files: Files,
    /// In what the scene on the right differs, where there is one.
    pub differences: Option<Vec<Difference>>,
    /// Frames up to the last one of this course of things.
    pub frames: u64,
}

impl Copied {
    /// The copy of a session.
    pub fn of(session: &Session) -> Copied {
        Copied {
            name: session.name().to_string(),
            text: session.saved(),
            files: session.files().clone(),
            differences: session.differences().map(<[_]>::to_vec),
            frames: session.latest(),
        }
    }
}

enum Ask {
    Do(Request),
    Copy(Sender<Copied>),
}

/// The end of the thread that the interface holds. When it goes, the thread ends.
pub struct Link {
    asks: Sender<Ask>,
    last: Arc<Mutex<Arc<Shown>>>,
}

impl core::fmt::Debug for Link {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("Link")
    }
}

impl Link {
    /// Starts the thread of a session; `wake` is called whenever there is a new picture.
    ///
    /// # Errors
    /// Where the system gives no thread.
    pub fn start(mut session: Session, wake: impl Fn() + Send + 'static) -> std::io::Result<Link> {
        let (asks, asked) = channel();
        let last = Arc::new(Mutex::new(Arc::new(session.shown())));
        let slot = Arc::clone(&last);
        std::thread::Builder::new().name("simulation".into()).spawn(move || run(session, &asked, &slot, &wake))?;
        Ok(Link { asks, last })
    }

    /// Asks for something; it is done between two frames.
    pub fn ask(&self, request: Request) {
        // Where the thread has ended there is nobody to ask: the last picture stays.
        let _ = self.asks.send(Ask::Do(request));
    }

    /// Asks for a copy of the scene; it comes when the present frame is done.
    pub fn copy(&self) -> Receiver<Copied> {
        let (sender, receiver) = channel();
        let _ = self.asks.send(Ask::Copy(sender));
        receiver
    }

    /// The last picture.
    pub fn shown(&self) -> Arc<Shown> {
        Arc::clone(&self.last.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

fn run(mut session: Session, asked: &Receiver<Ask>, slot: &Mutex<Arc<Shown>>, wake: &(dyn Fn() + Send)) {
    let begin = Instant::now();
    let clock = move || begin.elapsed();
    let mut last = clock();
    loop {
        // While nothing moves the thread sleeps until somebody asks for something.
        let first = if session.is_moving() {
            match asked.recv_timeout(if session.is_seeking() { Duration::ZERO } else { NAP }) {
                Ok(ask) => Some(ask),
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => return,
            }
        } else {
            match asked.recv() {
                Ok(ask) => {
                    last = clock();
                    Some(ask)
                }
                Err(_) => return,
            }
        };
        let mut news = first.is_some();
        for ask in first.into_iter().chain(asked.try_iter()) {
            match ask {
                Ask::Do(request) => session.handle(request),
                Ask::Copy(reply) => {
                    let _ = reply.send(Copied::of(&session));
                }
            }
        }
        let now = clock();
        let before = session.frames();
        let (was_seeking, told) = (session.is_seeking(), session.told());
        session.tick(now.saturating_sub(last), BUDGET, &clock);
        last = now;
        // A frame that fails is news too, though it leaves everything as it was.
        news |= session.frames() != before || was_seeking || session.told() != told;
        if news {
            let shown = Arc::new(session.shown());
            *slot.lock().unwrap_or_else(PoisonError::into_inner) = shown;
            wake();
        }
    }
}
