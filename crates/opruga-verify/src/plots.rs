//! Plots of errors.

use crate::case::{Check, Over, Row};
use opruga::draw::{Axis, Chart, DrawError, Level, Line, Marker, Nothing, Panel};

/// The value that replaces an error of zero on a logarithmic axis.
const NOTHING: f64 = 1e-17;

/// The plot of a row as the text of an SVG file. The plot shows the error over the size of cells or steps, with the theoretical slope and the limit,
/// or the values over a parameter beside the expected values.
///
/// # Errors
/// [`DrawError`] for a row without numbers.
pub fn plot(row: &Row) -> Result<String, DrawError> {
    if row.points.is_empty() {
        return Err(DrawError::Empty { nothing: Nothing::NumberOfCase });
    }
    match row.case.over {
        Over::Parameter(_) => over_parameter(row),
        _ => Chart { width: 640.0, x: size_axis(row), panels: vec![errors(&[row])], ..Chart::default() }.to_svg(),
    }
}

/// Plots several rows in each panel.
pub(crate) fn together(panels: &[(&str, Vec<&Row>)]) -> Result<String, DrawError> {
    let panels = panels
        .iter()
        .filter(|(_, rows)| !rows.is_empty())
        .map(|(label, rows)| Panel { y: Axis::logarithmic(*label, ""), ..errors(rows) });
    Chart {
        width: 720.0,
        x: Axis::logarithmic("size of the cells, one over their number along a side", ""),
        panels: panels.collect(),
        ..Chart::default()
    }
    .to_svg()
}

fn size_axis(row: &Row) -> Axis {
    match row.case.over {
        Over::Cells(what) => Axis::logarithmic(format!("one over the number of {what}"), ""),
        Over::Step(what) | Over::Parameter(what) => Axis::logarithmic(what, ""),
    }
}

/// Errors over sizes, both on logarithmic axes.
fn errors(rows: &[&Row]) -> Panel {
    let mut lines = Vec::new();
    let alone = rows.len() == 1;
    let names = without_common_words(&rows.iter().map(|row| row.case.name).collect::<Vec<_>>());
    for (row, name) in rows.iter().zip(&names) {
        let points: Vec<[f64; 2]> =
            row.points.iter().map(|p| [row.case.over.size(p.level), p.error.max(NOTHING)]).collect();
        let name = if alone { "measured".to_string() } else { name.clone() };
        lines.push(Line { name, points: points.clone(), marker: Some(Marker::Circle), ..Line::default() });
        if let (Check::Order(order), Some(first), Some(last), true) =
            (row.case.check, points.first(), points.last(), alone)
        {
            let start = last[1] * (first[0] / last[0]).powf(order);
            let name = format!("order {order}");
            let points = vec![[first[0], start], *last];
            lines.push(Line { name, points, dashed: true, colour: Some([120, 124, 132]), ..Line::default() });
        }
    }
    let mut levels: Vec<Level> = Vec::new();
    for row in rows {
        let value = row.case.tolerance;
        if levels.iter().any(|level| level.value == value) {
            continue;
        }
        // If the limits differ, the label names the rows to which each belongs.
        let own = rows.iter().zip(&names).filter(|(other, _)| other.case.tolerance == value);
        let own: Vec<&str> = own.map(|(_, name)| name.as_str()).collect();
        let whose = if own.len() == rows.len() { String::new() } else { format!(" of {}", own.join(" and ")) };
        levels.push(Level { value, label: format!("limit{whose}: {}", row.case.limit()) });
    }
    Panel { height: 260.0, y: Axis::logarithmic("error", ""), lines, levels }
}

/// The names of cases without the leading words that all of them share, because the axis already contains these words.
fn without_common_words(names: &[&str]) -> Vec<String> {
    let words: Vec<Vec<&str>> = names.iter().map(|name| name.split('-').collect()).collect();
    let most = words.iter().map(|words| words.len() - 1).min().unwrap_or(0);
    let common = (0..most).take_while(|k| words.iter().all(|own| own[*k] == words[0][*k])).count();
    words.iter().map(|words| words[common..].join(" ")).collect()
}

fn over_parameter(row: &Row) -> Result<String, DrawError> {
    let case = row.case;
    let Over::Parameter(what) = case.over else { return Err(DrawError::Empty { nothing: Nothing::Parameter }) };
    let of = |value: fn(&crate::case::Point) -> f64| row.points.iter().map(|p| [p.level, value(p)]).collect::<Vec<_>>();
    let values = Panel {
        height: 220.0,
        y: Axis::linear(if case.unit.is_empty() { "value" } else { "" }, case.unit),
        lines: vec![
            Line {
                name: "expected".into(),
                points: of(|p| p.expected),
                colour: Some([120, 124, 132]),
                dashed: true,
                marker: Some(Marker::Square),
                ..Line::default()
            },
            Line {
                name: "measured".into(),
                // The measured points are not connected, because only the expected values form a line.
                points: of(|p| p.computed).into_iter().flat_map(|point| [point, [f64::NAN; 2]]).collect(),
                marker: Some(Marker::Circle),
                ..Line::default()
            },
        ],
        levels: Vec::new(),
    };
    let errors = Panel {
        height: 150.0,
        y: Axis::logarithmic("error", ""),
        lines: vec![Line { points: of(|p| p.error.max(NOTHING)), marker: Some(Marker::Circle), ..Line::default() }],
        levels: vec![Level { value: case.tolerance, label: format!("limit {}", case.limit()) }],
    };
    // If all expected values are zero, the values are the errors, so one panel is enough.
    let panels = if case.expected.iter().all(|x| *x == 0.0) { vec![errors] } else { vec![values, errors] };
    Chart { width: 640.0, x: Axis::linear(what, ""), panels, ..Chart::default() }.to_svg()
}

#[cfg(test)]
mod tests {
    use super::without_common_words;

    #[test]
    fn names_of_cases_are_told_apart_by_what_they_do_not_have_in_common() {
        let names = ["cook-linear-triangles", "cook-linear-quadrilaterals", "cook-linear-quadratic-triangles"];
        assert_eq!(without_common_words(&names), ["triangles", "quadrilaterals", "quadratic triangles"]);
        assert_eq!(without_common_words(&["tube", "tube-fine"]), ["tube", "tube fine"]);
        assert_eq!(without_common_words(&["one"]), ["one"]);
        assert!(without_common_words(&[]).is_empty());
    }
}
