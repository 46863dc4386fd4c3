//! The differences between two runs of a scene, and between two reports of `verify`.

use std::collections::BTreeMap;

/// The figures of a case of `verify`, by name.
pub(super) type Row = BTreeMap<String, String>;

/// The largest number of figures that are reported for a scene or a case.
const MOST: usize = 6;

/// The result of a run.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Outcome {
    /// How it ended.
    ending: String,
    /// The names of the figures.
    columns: Vec<String>,
    /// The figures of every frame, as text: equal texts are equal bits.
    rows: Vec<Vec<String>>,
}

/// A figure that differs between the two sides.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Difference {
    /// The scene, or the case of `verify`.
    pub(super) subject: String,
    /// The first frame that differs; none if the figure does not belong to a frame.
    frame: Option<usize>,
    figure: String,
    values: [String; 2],
}

impl Outcome {
    /// Returns how two runs ended, if both ended in the same way and too early.
    pub(super) fn early(&self, other: &Outcome) -> Option<String> {
        let same = self.ending == other.ending && self.ending != "exit code 0";
        same.then(|| format!("{} after {} frames", self.ending, self.rows.len().saturating_sub(1)))
    }

    /// Reads the lines of hashes and the table of figures.
    pub(super) fn new(ending: String, hashes: &str, table: &str) -> Outcome {
        let mut lines = table.lines();
        let mut columns = vec!["hash of the state".to_string()];
        columns.extend(lines.next().map(cells).unwrap_or_default());
        let (mut hashes, mut rows) = (hashes.lines(), Vec::new());
        loop {
            // A frame without a hash or a row has empty cells, which differ from every other cell.
            let (hash, line) = (hashes.next(), lines.next());
            if hash.is_none() && line.is_none() {
                return Outcome { ending, columns, rows };
            }
            let mut row = vec![hash.unwrap_or_default().to_string()];
            row.extend(line.map(cells).unwrap_or_default());
            rows.push(row);
        }
    }
}

/// The cells of a line; names in quotes may contain commas.
fn cells(line: &str) -> Vec<String> {
    let (mut out, mut quoted) = (vec![String::new()], false);
    for letter in line.chars() {
        match letter {
            '"' => quoted = !quoted,
            ',' if !quoted => out.push(String::new()),
            _ => out.last_mut().into_iter().for_each(|cell| cell.push(letter)),
        }
    }
    out
}

impl Difference {
    fn new(subject: &str, frame: Option<usize>, figure: &str, values: [&str; 2]) -> Difference {
        let shown = |value: &str| if value.is_empty() { "–".to_string() } else { value.to_string() };
        Difference { subject: subject.into(), frame, figure: figure.into(), values: values.map(shown) }
    }

    /// Makes the difference for a scene, a case or a figure that only one side has.
    pub(super) fn unknown(subject: &str, known: [bool; 2]) -> Difference {
        Difference::new(subject, None, "", known.map(|known| if known { "known" } else { "unknown" }))
    }
}

/// The differences between two runs of a scene: how they ended, which figures differ, and the values in the first frame that differs.
pub(super) fn of_scene(scene: &str, base: &Outcome, present: &Outcome) -> Vec<Difference> {
    let mut out = Vec::new();
    if base.ending != present.ending {
        out.push(Difference::new(scene, None, "ending", [&base.ending, &present.ending]));
    }
    if base.rows.len() != present.rows.len() {
        let counts = [base, present].map(|outcome| outcome.rows.len().to_string());
        out.push(Difference::new(scene, None, "rows", [&counts[0], &counts[1]]));
    }
    let place = |outcome: &Outcome, name: &String| outcome.columns.iter().position(|column| column == name);
    for (one, other, known) in [(base, present, [true, false]), (present, base, [false, true])] {
        for name in one.columns.iter().filter(|name| place(other, name).is_none()) {
            out.push(Difference { figure: name.clone(), ..Difference::unknown(scene, known) });
        }
    }
    let common: Vec<(&String, usize, usize)> =
        base.columns.iter().enumerate().filter_map(|(here, name)| Some((name, here, place(present, name)?))).collect();
    for (frame, rows) in base.rows.iter().zip(&present.rows).enumerate() {
        let cell = |row: &[String], at: usize| row.get(at).cloned().unwrap_or_default();
        let values = common.iter().map(|(name, here, there)| (*name, cell(rows.0, *here), cell(rows.1, *there)));
        let differing: Vec<_> = values.filter(|(_, then, now)| then != now).collect();
        if !differing.is_empty() {
            out.extend(told(
                scene,
                Some(frame),
                differing.iter().map(|(name, then, now)| (name.as_str(), [then.as_str(), now])),
            ));
            break;
        }
    }
    out
}

/// The differences between two reports of `verify`.
pub(super) fn of_rows(base: &BTreeMap<String, Row>, present: &BTreeMap<String, Row>) -> Vec<Difference> {
    let mut out = Vec::new();
    for name in union(base, present) {
        match (base.get(name), present.get(name)) {
            (Some(then), Some(now)) => {
                let value = |row: &'_ Row, figure: &str| row.get(figure).cloned().unwrap_or_default();
                let values =
                    union(then, now).into_iter().map(|figure| (figure, value(then, figure), value(now, figure)));
                let differing: Vec<_> = values.filter(|(_, then, now)| then != now).collect();
                let named = differing.iter().map(|(figure, then, now)| (figure.as_str(), [then.as_str(), now]));
                out.extend(told(name, None, named));
            }
            (then, now) => out.push(Difference::unknown(name, [then.is_some(), now.is_some()])),
        }
    }
    out
}

/// The names that occur on either side.
fn union<'a, T>(base: &'a BTreeMap<String, T>, present: &'a BTreeMap<String, T>) -> Vec<&'a String> {
    let others = present.keys().filter(|name| !base.contains_key(*name));
    base.keys().chain(others).collect()
}

/// Lists the first of the figures that differ, and the number of the others.
fn told<'a>(
    subject: &str,
    frame: Option<usize>,
    differing: impl ExactSizeIterator<Item = (&'a str, [&'a str; 2])>,
) -> Vec<Difference> {
    let more = differing.len().saturating_sub(MOST);
    let mut out: Vec<_> =
        differing.take(MOST).map(|(figure, values)| Difference::new(subject, frame, figure, values)).collect();
    if more > 0 {
        out.push(Difference::new(subject, frame, &format!("and {more} more figures"), ["", ""]));
    }
    out
}

/// The differences as a table: scene or case, first frame, figure, both values.
pub(super) fn table(differences: &[Difference], sides: [&str; 2]) -> String {
    let row = |difference: &Difference| {
        let frame = difference.frame.map_or("–".into(), |frame| frame.to_string());
        let [then, now] = difference.values.clone().map(shortened);
        [difference.subject.clone(), frame, difference.figure.clone(), then, now]
    };
    let head = ["scene or case", "frame", "figure", sides[0], sides[1]].map(String::from);
    let rows: Vec<[String; 5]> = std::iter::once(head).chain(differences.iter().map(row)).collect();
    let wide: Vec<usize> =
        (0..5).map(|column| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0)).collect();
    let line = |row: &[String; 5]| {
        let cells: Vec<String> = row.iter().zip(&wide).map(|(cell, wide)| format!("{cell:<wide$}")).collect();
        format!("{}\n", cells.join("  ").trim_end())
    };
    rows.iter().map(line).collect()
}

/// Shortens long values, such as lists of all levels of a case, to their beginning.
fn shortened(value: String) -> String {
    const WIDTH: usize = 60;
    if value.chars().count() <= WIDTH { value } else { value.chars().take(WIDTH - 1).chain(['…']).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HASHES: &str = "0a\n0b\n0c\n";
    const TABLE: &str = "time,energy,\"volume, ball\"\n0,1.5000000000000000e0,3\n1,1.2500000000000000e0,3\n2,1,3\n";

    fn outcome(hashes: &str, table: &str) -> Outcome {
        Outcome::new("exit code 0".into(), hashes, table)
    }

    fn found(hashes: &str, table: &str) -> Vec<(Option<usize>, String, [String; 2])> {
        let differences = of_scene("ball", &outcome(HASHES, TABLE), &outcome(hashes, table));
        differences.into_iter().map(|d| (d.frame, d.figure, d.values)).collect()
    }

    fn difference(frame: usize, figure: &str, values: [&str; 2]) -> (Option<usize>, String, [String; 2]) {
        (Some(frame), figure.into(), values.map(String::from))
    }

    #[test]
    fn equal_runs_do_not_differ() {
        assert_eq!(found(HASHES, TABLE), []);
    }

    #[test]
    fn a_changed_bit_is_named_with_its_frame() {
        assert_eq!(found("0a\n0b\n0d\n", TABLE), [difference(2, "hash of the state", ["0c", "0d"])]);
        let [then, now] = ["1.2500000000000000e0", "1.2500000000000002e0"];
        // The columns may be in another order.
        let other = TABLE.replace(then, now);
        assert_eq!(found(HASHES, &other), [difference(1, "energy", [then, now])]);
        // For runs that diverge from each other, only the first differing frame is reported.
        let apart = found("0a\n0e\n0f\n", &other);
        assert_eq!(apart, [difference(1, "hash of the state", ["0b", "0e"]), difference(1, "energy", [then, now])]);
    }

    #[test]
    fn columns_are_compared_by_name_and_missing_ones_are_told() {
        let turned = "energy,time,\"volume, ball\"\n1.5000000000000000e0,0,3\n1.2500000000000000e0,1,3\n1,2,3\n";
        assert_eq!(found(HASHES, turned), []);
        let renamed = found(HASHES, &TABLE.replace("volume, ball", "volume"));
        let figures: Vec<_> = renamed.iter().map(|(_, figure, values)| (figure.as_str(), values[0].as_str())).collect();
        assert_eq!(figures, [("volume, ball", "known"), ("volume", "unknown")]);
    }

    #[test]
    fn runs_that_end_early_or_otherwise_differ() {
        let shorter =
            found("0a\n0b\n", "time,energy,\"volume, ball\"\n0,1.5000000000000000e0,3\n1,1.2500000000000000e0,3\n");
        assert_eq!(shorter, [(None, "rows".to_string(), ["3".to_string(), "2".to_string()])]);
        let failed = Outcome { ending: "exit code 1, step.not_finite".into(), ..outcome(HASHES, TABLE) };
        assert_eq!(of_scene("ball", &outcome(HASHES, TABLE), &failed)[0].figure, "ending");
        // A hash without a row does not count as a row.
        assert_eq!(found(HASHES, "time,energy,\"volume, ball\"\n").len(), 3);
    }

    #[test]
    fn rows_of_verify_are_compared_figure_by_figure() {
        let row = |computed: &str| BTreeMap::from([("computed".to_string(), computed.to_string())]);
        let base =
            BTreeMap::from([("a".to_string(), row("0.1")), ("b".to_string(), row("2")), ("c".to_string(), row("3"))]);
        assert_eq!(of_rows(&base, &base), []);
        let mut present = base.clone();
        present.insert("a".into(), row("0.10000000000000002"));
        present.remove("c");
        let differences = of_rows(&base, &present);
        assert_eq!(differences.len(), 2);
        assert_eq!(differences[0], Difference::new("a", None, "computed", ["0.1", "0.10000000000000002"]));
        assert_eq!(differences[1], Difference::unknown("c", [true, false]));
        let text = table(&differences, ["1a2b", "present"]);
        assert!(text.lines().count() == 3 && text.contains("0.10000000000000002"), "{text}");
    }
}
