//! Any bytes are the question of a sweep and its table, or typed errors. A zero stands between the two.
#![no_main]

use libfuzzer_sys::fuzz_target;
use opruga::sweep::{Design, Question, read_rows};

fuzz_target!(|bytes: &[u8]| {
    let end = bytes.iter().position(|byte| *byte == 0).unwrap_or(bytes.len());
    let (question, table) = (&bytes[..end], bytes.get(end + 1..).unwrap_or_default());
    let printable = |text: String| assert!(text.chars().all(|c| c == '\n' || !c.is_control()));
    let question = match Question::read(question) {
        Ok(question) => question,
        Err(error) => return printable(error.to_string()),
    };
    // Reading what was written asks the same.
    assert!(Question::read(question.to_text().as_bytes()).is_ok_and(|again| again.same(&question)));
    let sweep = match question.sweep() {
        Ok(sweep) => sweep,
        Err(errors) => return errors.iter().for_each(|error| printable(error.to_string())),
    };
    // A sample asks for as many points as it likes.
    if matches!(sweep.design, Design::Sample { count, .. } if count > 1000) {
        return;
    }
    match sweep.points() {
        Err(errors) => errors.iter().for_each(|error| printable(error.to_string())),
        Ok(points) => match read_rows(&sweep, &points, &String::from_utf8_lossy(table), "results.csv") {
            Ok(rows) => assert!(rows.iter().all(|row| row.number < points.len())),
            Err(error) => printable(error.to_string()),
        },
    }
});
