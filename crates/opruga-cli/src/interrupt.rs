//! Signals: Ctrl-C and termination signals set one flag for the whole program. Commands check this flag between steps of their work.

use crate::failure::Failure;
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Whether the present work should stop.
static STOP: AtomicBool = AtomicBool::new(false);
/// Whether the user has asked the program to end.
static END: AtomicBool = AtomicBool::new(false);
/// Whether another program reports the end instead of this one. That program ends by itself and prints what became of its work.
static SILENT: AtomicBool = AtomicBool::new(false);
static HANDLER: Once = Once::new();

/// How long the present work may take to end before a message reports that it continues.
const PATIENCE: Duration = Duration::from_secs(2);

/// The flag that is set when the present work should stop. Once this function has been called, Ctrl-C and termination signals set the flag. A
/// second signal ends the program at once: files are written under temporary names, so existing files stay intact.
pub(crate) fn asked_to_stop() -> &'static AtomicBool {
    HANDLER.call_once(|| {
        // If the system provides no handler, a signal ends the program as usual.
        let _ = ctrlc::set_handler(|| {
            if END.swap(true, Ordering::SeqCst) {
                std::process::exit(i32::from(Failure::Interrupted.exit_code()));
            }
            STOP.store(true, Ordering::SeqCst);
            std::thread::spawn(|| {
                std::thread::sleep(PATIENCE);
                if !SILENT.load(Ordering::SeqCst) {
                    eprintln!("the run ends after the present step; a second interrupt ends it at once");
                }
            });
        });
    });
    &STOP
}

/// Sets whether another program reports the end instead of this one.
pub(crate) fn leave_the_word(to_another: bool) {
    SILENT.store(to_another, Ordering::SeqCst);
}

/// Whether the user has asked the whole program to end, and not only the present work to stop.
pub(crate) fn asked_to_end() -> bool {
    END.load(Ordering::SeqCst)
}

/// Stops the present work.
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

/// After this call, a file that reaches the limit of file sizes (`ulimit -f`) does not end the program. The write that reaches the limit fails, as
/// on a full disk, and is reported with its path and bytes.
pub(crate) fn outlive_the_limit_on_files() {
    #[cfg(unix)]
    {
        // If the system provides no handler, the signal ends the program as usual.
        let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, std::sync::Arc::new(AtomicBool::new(false)));
    }
}
