//! The simulation without threads. The simulation runs before every picture of the window, for a limited time. If its frames take longer, simulated
//! time slows down, and the status line shows by how much.

use super::{Ask, Copied, Course};
use crate::session::{Request, Session};
use crate::shown::Shown;
use std::cell::RefCell;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

/// How long frames are computed before a picture. At sixty pictures per second, this leaves the same time for the interface.
const BUDGET: Duration = Duration::from_millis(8);

/// The simulation and its last picture.
pub struct Link {
    inner: RefCell<Inner>,
    wake: Box<dyn Fn()>,
}

struct Inner {
    course: Course,
    asks: Vec<Ask>,
    last: Arc<Shown>,
}

impl core::fmt::Debug for Link {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("Link")
    }
}

impl Link {
    /// Takes over a session; `wake` is called whenever a new picture of the window is needed.
    ///
    /// # Errors
    /// Without threads, this function returns no error. With threads, it returns an error if the system refuses to start one.
    pub fn start(mut session: Session, wake: impl Fn() + 'static) -> std::io::Result<Link> {
        let last = Arc::new(session.shown());
        let inner = Inner { course: Course::new(session), asks: Vec::new(), last };
        Ok(Link { inner: RefCell::new(inner), wake: Box::new(wake) })
    }

    /// Replaces the function that is called whenever a new picture of the window is needed.
    pub fn wake_by(&mut self, wake: impl Fn() + 'static) {
        self.wake = Box::new(wake);
    }

    /// How long the simulation has been busy. Without threads this is always none, because the window waits while the simulation runs.
    pub fn busy(&self) -> Option<Duration> {
        None
    }

    /// The progress of a preparation. Without threads this is always none.
    pub fn prepared(&self) -> Option<f64> {
        None
    }

    /// Sends a request, which is handled in the next turn.
    pub fn ask(&self, request: Request) {
        self.inner.borrow_mut().asks.push(Ask::Do(request));
        (self.wake)();
    }

    /// Requests a copy of the scene, which is available after the next turn.
    pub fn copy(&self) -> Receiver<Copied> {
        let (sender, receiver) = channel();
        self.inner.borrow_mut().asks.push(Ask::Copy(sender));
        (self.wake)();
        receiver
    }

    /// The last picture.
    pub fn shown(&self) -> Arc<Shown> {
        Arc::clone(&self.inner.borrow().last)
    }

    /// Gives the simulation its turn before a picture of the window.
    pub fn turn(&self) {
        let mut inner = self.inner.borrow_mut();
        let moving = inner.course.session.is_moving();
        let asks = std::mem::take(&mut inner.asks);
        if !moving {
            inner.course.rest();
        }
        if moving || !asks.is_empty() {
            if let Some(shown) = inner.course.turn(asks, BUDGET) {
                inner.last = Arc::new(shown);
            }
            (self.wake)();
        }
    }

    /// Gives access to the session itself.
    pub fn with_session<T>(&self, look: impl FnOnce(&Session) -> T) -> T {
        look(&self.inner.borrow().course.session)
    }
}
