//! Ctrl-C and signals to end: one flag for the whole program, which work looks at between its steps.

use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether the work at hand shall stop.
static STOP: AtomicBool = AtomicBool::new(false);
/// Whether the user has asked the program to end.
static END: AtomicBool = AtomicBool::new(false);
static HANDLER: Once = Once::new();

/// The flag that is set when the work at hand shall stop; from the first call on, Ctrl-C and signals to end set it.
pub(crate) fn asked_to_stop() -> &'static AtomicBool {
    HANDLER.call_once(|| {
        // Where the system gives us no handler, a signal ends the program as it always did.
        let _ = ctrlc::set_handler(|| {
            END.store(true, Ordering::SeqCst);
            STOP.store(true, Ordering::SeqCst);
        });
    });
    &STOP
}

/// Whether the user has asked the program to end, and not only the work at hand to stop.
pub(crate) fn asked_to_end() -> bool {
    END.load(Ordering::SeqCst)
}

/// Stops the work at hand.
pub(crate) fn stop_work() {
    STOP.store(true, Ordering::SeqCst);
}

/// Lets new work begin, unless the user has asked the program to end.
pub(crate) fn begin_work() {
    STOP.store(false, Ordering::SeqCst);
    if asked_to_end() {
        stop_work();
    }
}
