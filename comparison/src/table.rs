//! Rows of the comparison, as a table for people and as data for programs.

use crate::motion::{Run, Swing};
use serde_json::{Value, json};

/// The reference for the motion of a body.
#[derive(Clone, Copy, Debug)]
pub struct Reference {
    /// The sag of the free end at rest [m].
    pub rest: f64,
    /// Its first oscillation.
    pub swing: Option<Swing>,
    /// The length of a frame [s].
    pub frame: f64,
}

/// One program with one setting on one body.
#[derive(Clone, Debug)]
pub struct Row {
    pub name: String,
    pub nodes: usize,
    pub milliseconds: f64,
    /// Errors relative to the reference; none if there is no value.
    pub rest: Option<f64>,
    pub amplitude: Option<f64>,
    pub period: Option<f64>,
}

/// All rows about one body.
#[derive(Clone, Debug)]
pub struct Table {
    pub title: String,
    /// The index of the row to whose time the others are compared.
    pub base: usize,
    pub rows: Vec<Row>,
}

impl Row {
    /// Compares an oscillating run with its reference. Also compares `resting`, the sag of a run that came to rest; none if it did not come to rest.
    pub fn new(name: &str, nodes: usize, swinging: &Run, resting: Option<f64>, reference: &Reference) -> Row {
        let swings = swinging.swing(reference.frame).zip(reference.swing);
        let relative = |value: f64, expected: f64| value / expected - 1.0;
        Row {
            name: name.into(),
            nodes,
            milliseconds: swinging.median(),
            rest: resting.map(|sag| relative(sag, reference.rest)),
            amplitude: swings.map(|(own, expected)| relative(own.amplitude, expected.amplitude)),
            period: swings.map(|(own, expected)| relative(own.period, expected.period)),
        }
    }
}

fn percent(error: Option<f64>) -> String {
    // An error that is rounded to zero is written without a sign.
    let text = |error: f64| format!("{:+.2} %", 100.0 * error).replace("-0.00", "0.00").replace("+0.00", "0.00");
    error.map_or("–".into(), text)
}

impl Table {
    /// The table in Markdown.
    pub fn markdown(&self) -> String {
        let mut out = format!(
            "\n{}\n\n| | nodes | ms per frame | ratio | at rest | first swing | its time |\n|---|---|---|---|---|---|---|\n",
            self.title
        );
        for row in &self.rows {
            out += &format!(
                "| {} | {} | {} | {:.3} | {} | {} | {} |\n",
                row.name,
                row.nodes,
                rounded(row.milliseconds),
                row.milliseconds / self.rows[self.base].milliseconds,
                percent(row.rest),
                percent(row.amplitude),
                percent(row.period)
            );
        }
        out
    }

    /// A JSON object with all digits.
    pub fn json(&self) -> Value {
        let rows: Vec<Value> = self
            .rows
            .iter()
            .map(|row| {
                json!({
                    "program": row.name, "nodes": row.nodes, "milliseconds_per_frame": row.milliseconds,
                    "ratio": row.milliseconds / self.rows[self.base].milliseconds, "error_at_rest": row.rest,
                    "error_of_first_swing": row.amplitude, "error_of_its_time": row.period,
                })
            })
            .collect();
        json!({ "body": self.title, "rows": rows })
    }
}

/// A value with three digits.
fn rounded(value: f64) -> String {
    match value {
        v if v >= 100.0 => format!("{v:.0}"),
        v if v >= 10.0 => format!("{v:.1}"),
        v if v >= 1.0 => format!("{v:.2}"),
        v => format!("{v:.3}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_relative_and_times_are_ratios() {
        let reference = Reference { rest: 2.0, swing: None, frame: 0.1 };
        let of = |ms| Run { milliseconds: vec![ms], heights: vec![0.0, -1.0] };
        let rows =
            vec![Row::new("one", 8, &of(4.0), Some(2.1), &reference), Row::new("other", 8, &of(1.0), None, &reference)];
        let table = Table { title: "a body".into(), base: 0, rows };
        let text = table.markdown();
        assert!(text.contains("| one | 8 | 4.00 | 1.000 | +5.00 % | – | – |"), "{text}");
        assert!(text.contains("| other | 8 | 1.00 | 0.250 | – | – | – |"), "{text}");
        assert_eq!(table.json()["rows"][1]["ratio"], 0.25);
    }
}
