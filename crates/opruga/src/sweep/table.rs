//! The table of a sweep: one row for each point, written when the point is done and read again when the sweep is resumed.
//!
//! Each row ends with a checksum of its cells. A resumed sweep uses existing rows as its own results. A row that was changed in the meantime, by hand
//! or by a program that reformatted its numbers, is refused, and the error names its line. The point is not computed again automatically, because its
//! new row would overwrite the changes. To have it computed again, delete the line.

use super::Sweep;
use super::errors::{RowFault, SweepError};
use super::grid::Point;
use opruga_io::SceneError;
use opruga_io::problem::visible;
use opruga_io::tables::{Digits, cell};

/// One row of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The number of the point, from 0.
    pub number: usize,
    /// The values of the parameters that vary; none where a parameter has the value of the scene.
    pub values: Point,
    /// How the run ended.
    pub status: Status,
    /// The error in one sentence; empty if there is none.
    pub message: String,
    /// The results in the order of the metrics; none where the run does not provide the number.
    pub numbers: Vec<Option<f64>>,
}

/// How the run of a point ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Status {
    /// The run reached its end.
    Done,
    /// The run was refused or has diverged; the text is the code of the error.
    Failed(String),
}

impl Status {
    /// The word of the table: `done` or the code of the error.
    pub fn word(&self) -> &str {
        match self {
            Status::Done => "done",
            Status::Failed(code) => code,
        }
    }
}

/// The name of the last column.
const CHECKSUM: &str = "checksum";

/// The header of the table: `point`, the paths, `status`, the metrics, `message`, `checksum`.
pub fn head(sweep: &Sweep) -> String {
    let paths = sweep.axes.iter().map(|axis| cell(&axis.path));
    let metrics = sweep.metrics.iter().map(|metric| cell(&metric.name));
    let ends = |word: &str| std::iter::once(word.to_string());
    let ending = ends("message").chain(ends(CHECKSUM));
    let cells: Vec<String> = ends("point").chain(paths).chain(ends("status")).chain(metrics).chain(ending).collect();
    cells.join(",") + "\n"
}

/// The checksum of a row as 16 hexadecimal digits: the 64-bit hash FNV-1a of the header of the table, its line end, and the row up to the comma
/// before the checksum.
fn checksum(head: &str, cells: &str) -> String {
    let bytes = head.trim_end().bytes().chain([b'\n']).chain(cells.bytes());
    let hash =
        bytes.fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3));
    format!("{hash:016x}")
}

/// A row as a line of the table. Cells of unknown values are empty. Numbers have 17 significant digits.
pub fn line(sweep: &Sweep, row: &Row) -> String {
    let flat = |text: &str| cell(&text.split_whitespace().collect::<Vec<_>>().join(" "));
    let mut cells = vec![row.number.to_string()];
    cells.extend(row.values.iter().map(|value| value.as_deref().map_or(String::new(), cell)));
    cells.push(flat(row.status.word()));
    cells.extend(row.numbers.iter().map(|x| x.map_or(String::new(), |x| Digits(x).to_string())));
    cells.push(flat(&row.message));
    let cells = cells.join(",");
    format!("{cells},{}\n", checksum(&head(sweep), &cells))
}

/// Reads the rows of a table of this sweep, which may be incomplete. A last line without a line end was not written completely, and is ignored. Rows
/// are sorted by their points.
///
/// # Errors
/// `sweep.damaged` if the table does not belong to this sweep; `sweep.changed_row` for every row that was changed after it was written.
pub fn read_rows(sweep: &Sweep, points: &[Point], text: &str, file: &str) -> Result<Vec<Row>, Vec<SceneError>> {
    let placed = |line: usize, error: SceneError| SceneError {
        file: file.to_string(),
        line: Some(line),
        column: Some(1),
        ..error
    };
    let damaged = |line: usize, fault: RowFault, content: &str| {
        placed(line, SceneError::of(SweepError::Table { fault, content: visible(content) }))
    };
    let changed =
        |line: usize, content: &str| placed(line, SceneError::of(SweepError::ChangedRow { content: visible(content) }));
    let own = head(sweep);
    let whole = text.rfind('\n').map_or("", |end| &text[..=end]);
    let mut lines = whole.lines();
    match lines.next() {
        None => return Ok(Vec::new()),
        Some(first) if first == own.trim_end() => {}
        Some(first) if format!("{first},{CHECKSUM}") == own.trim_end() => {
            return Err(vec![damaged(1, RowFault::NoChecksums, first)]);
        }
        Some(first) => return Err(vec![damaged(1, RowFault::Head, first)]),
    }
    let mut rows: Vec<Option<Row>> = vec![None; points.len()];
    let mut errors = Vec::new();
    for (number, content) in lines.enumerate() {
        let row = match read_row(sweep, points, content) {
            Ok(row) => row,
            Err(what) => {
                errors.push(damaged(number + 2, what, content));
                continue;
            }
        };
        if content.rsplit_once(',').is_none_or(|(cells, sum)| sum != checksum(&own, cells)) {
            errors.push(changed(number + 2, content));
            continue;
        }
        let index = row.number;
        if rows[index].replace(row).is_some() {
            errors.push(damaged(number + 2, RowFault::TwoRows, content));
        }
    }
    if errors.is_empty() { Ok(rows.into_iter().flatten().collect()) } else { Err(errors) }
}

fn read_row(sweep: &Sweep, points: &[Point], line: &str) -> Result<Row, RowFault> {
    let cells = split(line).ok_or(RowFault::Quote)?;
    let (axes, metrics) = (sweep.axes.len(), sweep.metrics.len());
    if cells.len() != axes + metrics + 4 {
        return Err(RowFault::Cells);
    }
    let number: usize = cells[0].parse().map_err(|_| RowFault::PointNumber)?;
    let point = points.get(number).ok_or(RowFault::NoPoint)?;
    if point.iter().zip(&cells[1..]).any(|(value, cell)| value.as_deref().unwrap_or("") != cell) {
        return Err(RowFault::Values);
    }
    let numbers = cells[axes + 2..axes + 2 + metrics].iter().map(|cell| match cell.as_str() {
        "" => Ok(None),
        text => text.parse().map(Some).map_err(|_| RowFault::Number),
    });
    Ok(Row {
        number,
        values: point.clone(),
        status: match cells[axes + 1].as_str() {
            "done" => Status::Done,
            "" => return Err(RowFault::Status),
            code => Status::Failed(code.to_string()),
        },
        message: cells[axes + metrics + 2].clone(),
        numbers: numbers.collect::<Result<_, _>>()?,
    })
}

/// The cells of a line.
fn split(line: &str) -> Option<Vec<String>> {
    let (mut out, mut quoted) = (vec![String::new()], false);
    let mut signs = line.chars().peekable();
    while let Some(sign) = signs.next() {
        match sign {
            '"' if quoted && signs.peek() == Some(&'"') => {
                signs.next();
                out.last_mut()?.push('"');
            }
            '"' => quoted = !quoted,
            ',' if !quoted => out.push(String::new()),
            sign => out.last_mut()?.push(sign),
        }
    }
    (!quoted).then_some(out)
}

#[cfg(test)]
mod tests {
    use super::super::{Axis, Design, Metric};
    use super::*;

    fn sweep() -> Sweep {
        Sweep {
            name: "s".into(),
            file: "s.toml".into(),
            text: String::new(),
            files: opruga_io::Files::default(),
            fixed: Vec::new(),
            axes: Axis::parse("world.gravity=[0, -9.81],[0, \"a\"]").expect("it can be read").into_iter().collect(),
            design: Design::Grid,
            metrics: vec![
                Metric::parse("energy_drift").expect("a metric"),
                Metric::parse("settling_time").expect("one"),
            ],
            allow_unstable: false,
            lenient: false,
            registries: opruga_world::Registries::default(),
        }
    }

    fn rows(points: &[Point]) -> Vec<Row> {
        let failed = Status::Failed("run.diverged".into());
        vec![
            Row {
                number: 0,
                values: points[0].clone(),
                status: Status::Done,
                message: String::new(),
                numbers: vec![Some(0.1), None],
            },
            Row {
                number: 1,
                values: points[1].clone(),
                status: failed,
                message: "a \"b\", c".into(),
                numbers: vec![None, None],
            },
        ]
    }

    #[test]
    fn what_is_written_is_read_again_and_a_torn_line_is_left_out() {
        let sweep = sweep();
        let points = super::super::grid::points(&sweep.axes, sweep.design).expect("points");
        let rows = rows(&points);
        let text = format!("{}{}{}", head(&sweep), line(&sweep, &rows[1]), line(&sweep, &rows[0]));
        assert_eq!(read_rows(&sweep, &points, &text, "f").expect("a table"), rows, "sorted by their points");
        for cut in text.len() - line(&sweep, &rows[0]).len()..text.len() {
            assert_eq!(read_rows(&sweep, &points, &text[..cut], "f").expect("a table"), rows[1..], "{cut}");
        }
        assert_eq!(read_rows(&sweep, &points, "poi", "f"), Ok(Vec::new()));
    }

    #[test]
    fn a_table_of_something_else_is_refused_with_its_line() {
        let sweep = sweep();
        let points = super::super::grid::points(&sweep.axes, sweep.design).expect("points");
        let row = line(&sweep, &rows(&points)[0]);
        for (text, at) in [
            ("a,b\n".to_string(), 1),
            (format!("{}7{}", head(&sweep), &row[1..]), 2),
            (format!("{}1{}", head(&sweep), &row[1..]), 2),
            (format!("{}{row}{row}", head(&sweep)), 3),
            (format!("{}{}", head(&sweep), row.replace("done", "")), 2),
            (format!("{}{}", head(&sweep), row.replace("1.0", "one")), 2),
        ] {
            let errors = read_rows(&sweep, &points, &text, "f").expect_err(&text);
            assert_eq!((errors.len(), errors[0].code, errors[0].line), (1, "sweep.damaged", Some(at)), "{text}");
        }
    }

    /// If any character of a row is changed, the row is not accepted.
    #[test]
    fn a_row_that_was_changed_by_hand_is_refused_with_its_line() {
        let sweep = sweep();
        let points = super::super::grid::points(&sweep.axes, sweep.design).expect("points");
        let rows = rows(&points);
        let (first, second) = (line(&sweep, &rows[0]), line(&sweep, &rows[1]));
        let mut changed = 0;
        for at in
            (0..first.len() - 1).filter(|at| first.is_char_boundary(*at) && first.as_bytes()[*at].is_ascii_digit())
        {
            let digit = if &first[at..=at] == "7" { "8" } else { "7" };
            let text = format!("{}{second}{}{digit}{}", head(&sweep), &first[..at], &first[at + 1..]);
            let errors = read_rows(&sweep, &points, &text, "f").expect_err(&text);
            assert_eq!((errors.len(), errors[0].line), (1, Some(3)), "{text}");
            changed += usize::from(errors[0].code == "sweep.changed_row");
        }
        assert!(changed > 20, "numbers and checksums: {changed}");
        // Every such row is reported at once; a row that is missing is computed again.
        let text =
            format!("{}{}{}", head(&sweep), second.replace("a \"\"b", "a \"\"c"), first.replace("done", "run.x"));
        let lines: Vec<_> = read_rows(&sweep, &points, &text, "f").expect_err(&text).iter().map(|e| e.line).collect();
        assert_eq!(lines, [Some(2), Some(3)]);
        assert_eq!(read_rows(&sweep, &points, &format!("{}{first}", head(&sweep)), "f"), Ok(rows[..1].to_vec()));
    }
}
