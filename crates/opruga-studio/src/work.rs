//! Work in the background, such as films and thumbnails. Such work is done on its own thread or, in a browser, which has no threads, in slices
//! between two pictures of the window.

use std::sync::mpsc::Receiver;

#[cfg(target_arch = "wasm32")]
pub use sliced::{breathe, spawn};
#[cfg(not(target_arch = "wasm32"))]
pub use threaded::{breathe, finish, spawn};

/// The result of the work, if it is finished.
pub fn done<T>(receiver: &Receiver<T>) -> Option<T> {
    receiver.try_recv().ok()
}

#[cfg(not(target_arch = "wasm32"))]
mod threaded {
    use std::future::Future;
    use std::pin::pin;
    use std::sync::mpsc::{Receiver, channel};
    use std::task::{Context, Poll, Waker};

    /// Starts work in the background; its result can be received.
    pub fn spawn<T: Send + 'static>(work: impl Future<Output = T> + Send + 'static) -> Receiver<T> {
        let (sender, receiver) = channel();
        std::thread::spawn(move || {
            // If the window was closed, the result is no longer needed.
            let _ = sender.send(finish(work));
        });
        receiver
    }

    /// Does the work completely. This function never waits, because [`breathe`] returns at once.
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

    /// A point in long work at which the interface may run. This version of the function does nothing, because the work has its own thread.
    pub async fn breathe() {}
}

#[cfg(target_arch = "wasm32")]
mod sliced {
    use crate::browser;
    use std::cell::Cell;
    use std::future::Future;
    use std::sync::mpsc::{Receiver, channel};

    /// How long work continues before the interface may run [ms].
    const SLICE: f64 = 6.0;

    thread_local! {
        /// The time at which the present slice of work began [ms].
        static BEGAN: Cell<f64> = const { Cell::new(0.0) };
    }

    /// Starts work in the background; its result can be received.
    pub fn spawn<T: 'static>(work: impl Future<Output = T> + 'static) -> Receiver<T> {
        let (sender, receiver) = channel();
        wasm_bindgen_futures::spawn_local(async move {
            let _ = sender.send(work.await);
        });
        receiver
    }

    /// A point in long work at which the interface may run, if the present slice of time is used up.
    pub async fn breathe() {
        if browser::milliseconds() - BEGAN.get() > SLICE {
            browser::next_turn().await;
            BEGAN.set(browser::milliseconds());
        }
    }
}
