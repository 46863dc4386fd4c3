//! Many cases at once.

use crate::case::{Case, Row};
use crate::lab::Lab;
use std::sync::Mutex;
use std::sync::PoisonError;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Runs cases on some threads, each case on one, and returns their rows in the order of the cases.
///
/// `done` sees every row as it comes. Where `stop` is set, the cases that have not begun are left out.
pub fn run_all(
    cases: &[&'static Case],
    lab: &Lab,
    threads: usize,
    stop: &AtomicBool,
    done: &(dyn Fn(&Row) + Sync),
) -> Vec<Row> {
    let next = AtomicUsize::new(0);
    // What takes long begins first.
    let mut order: Vec<usize> = (0..cases.len()).collect();
    order.sort_by_key(|number| cases[*number].quick);
    let rows: Mutex<Vec<(usize, Row)>> = Mutex::new(Vec::new());
    let worker = || {
        while let Some((number, case)) =
            { order.get(next.fetch_add(1, Ordering::Relaxed)).map(|number| (*number, cases[*number])) }
        {
            if stop.load(Ordering::Relaxed) {
                return;
            }
            let row = case.run(lab);
            done(&row);
            rows.lock().unwrap_or_else(PoisonError::into_inner).push((number, row));
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..threads.clamp(1, cases.len().max(1)) {
            scope.spawn(worker);
        }
    });
    let mut rows = rows.into_inner().unwrap_or_else(PoisonError::into_inner);
    rows.sort_by_key(|(number, _)| *number);
    rows.into_iter().map(|(_, row)| row).collect()
}
