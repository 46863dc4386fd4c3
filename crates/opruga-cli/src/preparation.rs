//! Work that can take long: its interruption by Ctrl-C, and the progress of a preparation on the terminal.

use crate::interrupt::asked_to_stop;
use opruga::BreakOff;
use std::io::IsTerminal;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// The interval at which a request to stop is passed on and the bar is drawn.
const TURN: Duration = Duration::from_millis(50);
/// Work that takes less time shows no bar.
const SHORT: Duration = Duration::from_secs(1);

/// Does work that can be interrupted. Another thread passes on a request to stop, and shows the progress of a preparation.
pub(crate) fn watched<T>(break_off: &BreakOff, work: impl FnOnce() -> T) -> T {
    let stop = asked_to_stop();
    let done = std::thread::scope(|scope| {
        let (ended, end) = channel::<()>();
        scope.spawn(move || {
            let (begin, mut bar) = (Instant::now(), None);
            while end.recv_timeout(TURN) == Err(RecvTimeoutError::Timeout) {
                break_off.ask(stop.load(Ordering::SeqCst));
                if let Some(share) = break_off.prepared().filter(|_| begin.elapsed() > SHORT) {
                    bar.get_or_insert_with(progress_bar).set_position((100.0 * share) as u64);
                }
            }
            if let Some(bar) = bar {
                bar.finish_and_clear();
            }
        });
        let done = work();
        drop(ended);
        done
    });
    // A request that comes later applies to the next work.
    break_off.ask(false);
    done
}

fn progress_bar() -> indicatif::ProgressBar {
    if !std::io::stderr().is_terminal() {
        return indicatif::ProgressBar::hidden();
    }
    let style = indicatif::ProgressStyle::with_template("preparing the bodies {wide_bar} {pos} %, {eta} left");
    indicatif::ProgressBar::new(100).with_style(style.unwrap_or_else(|_| indicatif::ProgressStyle::default_bar()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interrupt::{begin_work, stop_work};

    #[test]
    fn the_wish_to_stop_reaches_work_that_can_be_broken_off() {
        let break_off = BreakOff::default();
        assert_eq!(watched(&break_off, || 7), 7);
        stop_work();
        let late = Instant::now() + Duration::from_secs(60);
        watched(&break_off, || {
            while !break_off.is_asked() {
                assert!(Instant::now() < late, "nobody passed it on");
                std::thread::sleep(Duration::from_millis(5));
            }
        });
        begin_work();
        assert!(!break_off.is_asked());
    }
}
