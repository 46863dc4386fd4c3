//! The simulation on its own thread, so that the interface never waits for it.

use super::{Ask, Copied, Course};
use crate::session::{Request, Session};
use crate::shown::Shown;
use opruga::BreakOff;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// How long frames are computed before a new picture is shown.
const BUDGET: Duration = Duration::from_millis(14);
/// How long a frame may take before it is interrupted for a request that cannot wait.
const PATIENCE: Duration = Duration::from_millis(250);
/// How long the thread sleeps while the simulation plays and no frame is due.
const NAP: Duration = Duration::from_millis(3);

/// The connection of the interface to the thread. The thread ends when this value is dropped.
pub struct Link {
    asks: Sender<Ask>,
    last: Arc<Mutex<Arc<Shown>>>,
    /// When the thread began its present work; none while it waits.
    since: Arc<Mutex<Option<Instant>>>,
    /// Interrupts a frame that takes long.
    break_off: Arc<BreakOff>,
}

/// Pictures that the thread has made and that may still be in use. The thread frees the pictures after their last use. The interface would need a
/// millisecond to free the data of a thousand bodies.
#[derive(Default)]
struct Old(Vec<Arc<Shown>>);

impl Old {
    fn keep(&mut self, shown: Arc<Shown>) {
        self.0.retain(|old| Arc::strong_count(old) > 1);
        self.0.push(shown);
    }
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
    /// The system provides no thread.
    pub fn start(mut session: Session, wake: impl Fn() + Send + 'static) -> std::io::Result<Link> {
        let (asks, asked) = channel();
        let last = Arc::new(Mutex::new(Arc::new(session.shown())));
        let break_off = session.break_off();
        let (slot, since) = (Arc::clone(&last), Arc::new(Mutex::new(None)));
        let busy = Arc::clone(&since);
        let work = move || run(session, &asked, &slot, &busy, &wake);
        std::thread::Builder::new().name("simulation".into()).spawn(work)?;
        Ok(Link { asks, last, since, break_off })
    }

    /// Sends a request, which is handled between two frames. A frame that takes long is interrupted for a request that cannot wait.
    pub fn ask(&self, request: Request) {
        if request.breaks_off() {
            self.break_a_long_frame_off();
        }
        // If the thread has ended, the request is not handled, and the last picture stays.
        let _ = self.asks.send(Ask::Do(request));
    }

    /// Requests a copy of the scene, which is available when the present frame is done.
    pub fn copy(&self) -> Receiver<Copied> {
        let (sender, receiver) = channel();
        let _ = self.asks.send(Ask::Copy(sender));
        receiver
    }

    /// Requests a copy immediately: a frame that takes long is interrupted for it.
    pub fn copy_now(&self) -> Receiver<Copied> {
        self.break_a_long_frame_off();
        self.copy()
    }

    fn break_a_long_frame_off(&self) {
        // The thread resets this flag when it receives the next request.
        if self.busy().is_some_and(|busy| busy > PATIENCE) {
            self.break_off.ask(true);
        }
    }

    /// How long the thread has been busy with its present work.
    pub fn busy(&self) -> Option<Duration> {
        self.since.lock().unwrap_or_else(PoisonError::into_inner).map(|since| since.elapsed())
    }

    /// The progress of a preparation that takes long.
    pub fn prepared(&self) -> Option<f64> {
        self.break_off.prepared()
    }

    /// The last picture.
    pub fn shown(&self) -> Arc<Shown> {
        Arc::clone(&self.last.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

fn run(
    session: Session,
    asked: &Receiver<Ask>,
    slot: &Mutex<Arc<Shown>>,
    busy: &Mutex<Option<Instant>>,
    wake: &(dyn Fn() + Send),
) {
    let set = |since: Option<Instant>| *busy.lock().unwrap_or_else(PoisonError::into_inner) = since;
    let break_off = session.break_off();
    let (mut course, mut old) = (Course::new(session), Old::default());
    loop {
        // While nothing moves, the thread sleeps until it receives a request.
        let first = if course.session.is_moving() {
            match asked.recv_timeout(if course.session.is_seeking() { Duration::ZERO } else { NAP }) {
                Ok(ask) => Some(ask),
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => return,
            }
        } else {
            match asked.recv() {
                Ok(ask) => {
                    course.rest();
                    Some(ask)
                }
                Err(_) => return,
            }
        };
        set(Some(Instant::now()));
        break_off.ask(false);
        let news = course.turn(first.into_iter().chain(asked.try_iter()), BUDGET);
        set(None);
        if let Some(shown) = news {
            let shown = Arc::new(shown);
            let last = std::mem::replace(&mut *slot.lock().unwrap_or_else(PoisonError::into_inner), shown);
            old.keep(last);
            wake();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_freed_by_the_thread_that_made_it_once_nobody_looks_at_it() {
        let (mut old, looked_at) = (Old::default(), Arc::new(Shown::default()));
        old.keep(Arc::clone(&looked_at));
        old.keep(Arc::new(Shown::default()));
        assert_eq!((old.0.len(), Arc::strong_count(&looked_at)), (2, 2));
        old.keep(Arc::new(Shown::default()));
        assert_eq!(old.0.len(), 2, "the one that nobody looks at went");
        drop(looked_at);
        old.keep(Arc::new(Shown::default()));
        assert_eq!(old.0.len(), 1);
    }
}
