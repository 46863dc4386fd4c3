//! The simulation in the time that a picture of the window leaves, where there are no threads: it has its turn before every
//! picture. Frames that take longer than that slow simulated time down, and the line below says by how much.

use super::{Ask, Copied, Course};
use crate::session::{Request, Session};
use crate::shown::Shown;
use std::cell::RefCell;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

/// How long frames are computed in a turn: at sixty pictures a second as much is left for the interface.
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
    /// Takes a session; `wake` is called whenever there shall be a new picture of the window.
    ///
    /// # Errors
    /// None; where there are threads, one may be refused.
    pub fn start(mut session: Session, wake: impl Fn() + 'static) -> std::io::Result<Link> {
        let last = Arc::new(session.shown());
        let inner = Inner { course: Course::new(session), asks: Vec::new(), last };
        Ok(Link { inner: RefCell::new(inner), wake: Box::new(wake) })
    }

    /// Calls another one from now on.
    pub fn wake_by(&mut self, wake: impl Fn() + 'static) {
        self.wake = Box::new(wake);
    }

    /// For how long it has been at what it does now: here the window waits for it, and it is never at anything.
    pub fn busy(&self) -> Option<Duration> {
        None
    }

    /// The share that is done of a preparation: none either.
    pub fn prepared(&self) -> Option<f64> {
        None
    }

    /// Asks for something; it is done in the next turn.
    pub fn ask(&self, request: Request) {
        self.inner.borrow_mut().asks.push(Ask::Do(request));
        (self.wake)();
    }

    /// Asks for a copy of the scene; it comes with the next turn.
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

    /// The turn of the simulation before a picture of the window.
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

    /// Looks at the session itself.
    pub fn with_session<T>(&self, look: impl FnOnce(&Session) -> T) -> T {
        look(&self.inner.borrow().course.session)
    }
}
