//! Runs many cases in parallel.

use crate::case::{Case, Row};
use crate::lab::Lab;
use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// The interval at which the request to stop is checked while no row arrives.
const LOOK: Duration = Duration::from_millis(20);

/// Runs cases on several threads, each case on one thread, and returns their rows in the order of the cases.
///
/// `done` is called for every row as it arrives. If `stop` is set, unfinished cases are omitted: no further case begins, and the function does not
/// wait for running cases, because a case may take minutes. The results of cases that are still running are discarded. These cases write nothing, and
/// they end at the latest with the program.
pub fn run_all(cases: &[&'static Case], lab: &Lab, threads: usize, stop: &AtomicBool, done: &dyn Fn(&Row)) -> Vec<Row> {
    // Long cases begin first.
    let mut order: Vec<(usize, &'static Case)> = cases.iter().copied().enumerate().collect();
    order.sort_by_key(|(_, case)| case.quick);
    let (order, next, lab) = (Arc::new(order), Arc::new(AtomicUsize::new(0)), lab.clone());
    let (sender, receiver) = channel();
    if stop.load(Ordering::Relaxed) {
        return Vec::new();
    }
    let mut workers = Vec::new();
    for _ in 0..threads.clamp(1, cases.len().max(1)) {
        let (order, next, lab, sender) = (order.clone(), next.clone(), lab.clone(), sender.clone());
        workers.push(thread::spawn(move || {
            while let Some((number, case)) = order.get(next.fetch_add(1, Ordering::Relaxed)) {
                if sender.send((*number, case.run(&lab))).is_err() {
                    return;
                }
            }
        }));
    }
    drop(sender);
    let mut rows: Vec<(usize, Row)> = Vec::new();
    loop {
        match receiver.recv_timeout(LOOK) {
            Ok((number, row)) => {
                done(&row);
                rows.push((number, row));
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => {
                // A worker that did not end normally has panicked. Its case has no row.
                for worker in workers {
                    if let Err(panic) = worker.join() {
                        resume_unwind(panic);
                    }
                }
                break;
            }
        }
        if stop.load(Ordering::Relaxed) && rows.len() < cases.len() {
            // No further case begins.
            next.store(order.len(), Ordering::Relaxed);
            break;
        }
    }
    rows.sort_by_key(|(number, _)| *number);
    rows.into_iter().map(|(_, row)| row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::{Check, Family, Over, Scale};
    use crate::lab::Trouble;
    use std::sync::Mutex;
    use std::sync::PoisonError;

    /// The second case waits for this gate, which the test holds until it has its rows.
    static GATE: Mutex<()> = Mutex::new(());

    fn at_once(_: &Lab, _: f64) -> Result<f64, Trouble> {
        Ok(1.0)
    }

    fn never(_: &Lab, _: f64) -> Result<f64, Trouble> {
        drop(GATE.lock().unwrap_or_else(PoisonError::into_inner));
        Ok(1.0)
    }

    const QUICK: Case = Case {
        name: "quick",
        family: Family::Statics,
        quantity: "one",
        unit: "",
        source: "itself",
        over: Over::Parameter("level"),
        levels: &[1.0],
        expected: &[1.0],
        scale: Scale::Relative,
        tolerance: 0.1,
        check: Check::Finest,
        quick: true,
        measure: at_once,
    };
    static CASES: [Case; 3] = [QUICK, Case { name: "endless", measure: never, ..QUICK }, QUICK];

    #[test]
    fn a_case_that_runs_is_not_waited_for_once_it_shall_stop() {
        let held = GATE.lock().unwrap_or_else(PoisonError::into_inner);
        let cases: Vec<&'static Case> = CASES.iter().collect();
        let stop = AtomicBool::new(false);
        // Without the request to stop, this would wait for ever for the second case, which ends only when the gate is open.
        let rows = run_all(&cases, &Lab::default(), 1, &stop, &|_| stop.store(true, Ordering::Relaxed));
        assert_eq!(rows.iter().map(|row| row.case.name).collect::<Vec<_>>(), ["quick"]);
        drop(held);
        let all = run_all(&cases, &Lab::default(), 1, &AtomicBool::new(false), &|_| {});
        assert_eq!(all.iter().map(|row| row.case.name).collect::<Vec<_>>(), ["quick", "endless", "quick"]);
        assert!(all.iter().all(|row| row.pass));
    }

    #[test]
    #[should_panic(expected = "a case that panics")]
    fn a_panic_of_a_case_is_the_panic_of_the_run() {
        fn panics(_: &Lab, _: f64) -> Result<f64, Trouble> {
            panic!("a case that panics")
        }
        static CASE: Case = Case { name: "panics", measure: panics, ..QUICK };
        run_all(&[&CASE], &Lab::default(), 1, &AtomicBool::new(false), &|_| {});
    }
}
