//! Work beside the interface, such as films and thumbnails: on a thread of its own; in a browser, which gives none, in slices
//! between two pictures of the window.

use std::sync::mpsc::Receiver;

#[cfg(target_arch = "wasm32")]
pub use sliced::{breathe, spawn};
#[cfg(not(target_arch = "wasm32"))]
pub use threaded::{breathe, finish, spawn};

/// What work came to, if it is done.
pub fn done<T>(receiver: &Receiver<T>) -> Option<T> {
    receiver.try_recv().ok()
}

#[cfg(not(target_arch = "wasm32"))]
mod threaded {
    use std::future::Future;
    use std::pin::pin;
    use std::sync::mpsc::{Receiver, channel};
    use std::task::{Context, Poll, Waker};

    /// Does work beside the interface; what it comes to can be received.
    pub fn spawn<T: Send + 'static>(work: impl Future<Output = T> + Send + 'static) -> Receiver<T> {
        let (sender, receiver) = channel();
        std::thread::spawn(move || {
            // Nobody waits any more where the window was closed.
            let _ = sender.send(finish(work));
        });
        receiver
    }

    /// Does work to its end. Here it never waits for anything, as [`breathe`] returns at once.
    pub fn finish<T>(work: impl Future<Output = T>) -> T {
        let mut work = pin!(work);
        let mut context = Context::from_waker(Waker::noop());
        loop {
            if let Poll::Ready(outcome) = work.as_mut().poll(&mut context) {
                return outcome;
            }
            std::thread::yield_now();
        }
    }

    /// The place in long work where the interface has its turn: on a thread it has it anyway.
    pub async fn breathe() {}
}

#[cfg(target_arch = "wasm32")]
mod sliced {
    use crate::browser;
    use std::cell::Cell;
    use std::future::Future;
    use std::sync::mpsc::{Receiver, channel};

    /// How long work goes on before the interface has its turn [ms].
    const SLICE: f64 = 6.0;

    thread_local! {
        /// When the present slice began [ms].
        static BEGAN: Cell<f64> = const { Cell::new(0.0) };
    }

    /// Does work beside the interface; what it comes to can be received.
    pub fn spawn<T: 'static>(work: impl Future<Output = T> + 'static) -> Receiver<T> {
        let (sender, receiver) = channel();
        wasm_bindgen_futures::spawn_local(async move {
            let _ = sender.send(work.await);
        });
        receiver
    }

    /// The place in long work where the interface has its turn, once the slice is used up.
    pub async fn breathe() {
        if browser::milliseconds() - BEGAN.get() > SLICE {
            browser::next_turn().await;
            BEGAN.set(browser::milliseconds());
        }
    }
}
