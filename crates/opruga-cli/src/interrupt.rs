//! Signals: Ctrl-C and those to end, one flag for the whole program, which work looks at between its steps.

use crate::failure::Failure;
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Whether the work at hand shall stop.
static STOP: AtomicBool = AtomicBool::new(false);
/// Whether the user has asked the program to end.
static END: AtomicBool = AtomicBool::new(false);
/// Whether another program has the word, which ends by itself and says what became of its work.
static SILENT: AtomicBool = AtomicBool::new(false);
static HANDLER: Once = Once::new();

/// How long the work at hand may take to end before the user is told that it goes on.
const PATIENCE: Duration = Duration::from_secs(2);

/// The flag that is set when the work at hand shall stop; from the first call on, Ctrl-C and signals to end set it. A second one
/// ends the program at once: files are written aside, so that those that were there are whole.
pub(crate) fn asked_to_stop() -> &'static AtomicBool {
    HANDLER.call_once(|| {
        // Where the system gives us no handler, a signal ends the program as it always did.
        let _ = ctrlc::set_handler(|| {
            if END.swap(true, Ordering::SeqCst) {
                std::process::exit(i32::from(Failure::Interrupted.exit_code()));
            }
            STOP.store(true, Ordering::SeqCst);
            std::thread::spawn(|| {
                std::thread::sleep(PATIENCE);
                if !SILENT.load(Ordering::SeqCst) {
                    eprintln!("ends after the step at hand; asked once more, at once");
                }
            });
        });
    });
    &STOP
}

/// Leaves it to another program to say how it ends, or takes the word back.
pub(crate) fn leave_the_word(to_another: bool) {
    SILENT.store(to_another, Ordering::SeqCst);
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

/// From here on a file that reaches the limit on the size of files (`ulimit -f`) is a failed write like a full disk, which is
/// told with path and bytes, and no longer the end of the program.
pub(crate) fn outlive_the_limit_on_files() {
    #[cfg(unix)]
    {
        // Where the system gives us no handler, the signal ends the program as it always did.
        let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, std::sync::Arc::new(AtomicBool::new(false)));
    }
}
