//! Tables for people and programs.

use crate::case::{Case, Check, Family, Row};
use crate::cases::LEFT_OUT;
use crate::plots::{plot, together};
use serde_json::{Value, json};
use std::fmt::Write as _;

/// A number with a few digits.
fn short(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let size = value.abs();
    if !(1e-3..1e7).contains(&size) {
        return format!("{value:.2e}");
    }
    let digits = (5 - size.log10().floor() as i32).clamp(0, 8) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_string() } else { text }
}

/// An error with two digits.
fn rough(value: f64) -> String {
    if value == 0.0 { "0".into() } else { format!("{value:.1e}") }
}

fn with_unit(value: f64, case: &Case) -> String {
    if case.unit.is_empty() { short(value) } else { format!("{} {}", short(value), case.unit) }
}

/// The theoretical and the observed order.
fn orders(row: &Row) -> String {
    match (row.case.check, row.observed_order) {
        (Check::Order(order), Some(seen)) => format!("{seen:.2} of {order}"),
        (Check::Order(order), None) => format!("? of {order}"),
        _ => "–".into(),
    }
}

/// The table for a terminal: case, measured, expected, error, limit, order, time, outcome.
pub fn table(rows: &[Row]) -> String {
    let wide = rows.iter().map(|row| row.case.name.len()).max().unwrap_or(0).max(4);
    let mut text = format!(
        "{:<wide$} {:>16} {:>16} {:>9} {:>9} {:>13} {:>8}\n",
        "case", "measured", "expected", "error", "limit", "order", "time"
    );
    for family in Family::ALL {
        let of: Vec<&Row> = rows.iter().filter(|row| row.case.family == family).collect();
        if of.is_empty() {
            continue;
        }
        let _ = writeln!(text, "{}", family.name());
        for row in of {
            let case = row.case;
            let verdict = if row.pass { "pass" } else { "FAIL" };
            match row.decisive() {
                Some(point) => {
                    let _ = writeln!(
                        text,
                        "{:<wide$} {:>16} {:>16} {:>9} {:>9} {:>13} {:>6.2} s  {verdict}",
                        case.name,
                        with_unit(point.computed, case),
                        with_unit(point.expected, case),
                        rough(point.error),
                        rough(case.tolerance),
                        orders(row),
                        row.seconds
                    );
                }
                None => _ = writeln!(text, "{:<wide$} {:>74} {:>6.2} s  {verdict}", case.name, "", row.seconds),
            }
            if let Some(trouble) = &row.trouble {
                let _ = writeln!(text, "{:<wide$}   {trouble}", "");
            }
        }
    }
    let failed: Vec<&str> = rows.iter().filter(|row| !row.pass).map(|row| row.case.name).collect();
    let seconds: f64 = rows.iter().map(|row| row.seconds).sum();
    let _ = write!(text, "{} of {} pass, {seconds:.1} s of computing", rows.len() - failed.len(), rows.len());
    if !failed.is_empty() {
        let _ = write!(text, "; not: {}", failed.join(", "));
    }
    text.push('\n');
    text
}

/// The rows as JSON, each with the measured and the expected value at the finest or the worst level, and with the results at all levels.
pub fn to_json(rows: &[Row]) -> Value {
    let row = |row: &Row| {
        let (case, point) = (row.case, row.decisive());
        let order = if let Check::Order(order) = case.check { Some(order) } else { None };
        let points: Vec<Value> = row
            .points
            .iter()
            .map(|p| json!({"level": p.level, "computed": p.computed, "expected": p.expected, "error": p.error}))
            .collect();
        json!({
            "case": case.name,
            "family": case.family.name(),
            "quantity": case.quantity,
            "unit": case.unit,
            "computed": point.map(|p| p.computed),
            "expected": point.map_or(case.expected[0], |p| p.expected),
            "error": point.map(|p| p.error),
            "tolerance": case.tolerance,
            "order": order,
            "observed_order": row.observed_order,
            "source": case.source,
            "pass": row.pass,
            "message": row.trouble,
            "seconds": row.seconds,
            "levels": points,
        })
    };
    json!({
        "schema": 1,
        "passed": rows.iter().filter(|row| row.pass).count(),
        "failed": rows.iter().filter(|row| !row.pass).count(),
        "rows": rows.iter().map(row).collect::<Vec<_>>(),
    })
}

/// The figure beside the table, which shows the errors of several kinds of cells together.
pub fn overview(rows: &[Row]) -> Option<String> {
    let named = |names: &[&str]| -> Vec<&Row> {
        names
            .iter()
            .filter_map(|name| rows.iter().find(|row| row.case.name == *name && !row.points.is_empty()))
            .collect()
    };
    let cook = named(&["cook-linear-triangles", "cook-linear-quadrilaterals", "cook-linear-quadratic-triangles"]);
    let tube = named(&["lame-tube-triangles", "lame-tube-quadrilaterals", "lame-tube-quadratic-triangles"]);
    if cook.is_empty() && tube.is_empty() {
        return None;
    }
    together(&[("error, Cook's membrane", cook), ("error, Lamé's tube", tube)]).ok()
}

fn level(row: &Row) -> &'static str {
    match row.case.check {
        Check::Order(_) | Check::Finest => "finest",
        Check::Everywhere => "worst",
    }
}

/// The row of a case in the Markdown table: its definition, then its results.
fn markdown_row(row: &Row) -> String {
    let case = row.case;
    let (computed, expected, error) = match row.decisive() {
        Some(p) => (with_unit(p.computed, case), with_unit(p.expected, case), rough(p.error)),
        None => ("none".into(), with_unit(case.expected[0], case), "–".into()),
    };
    let order = row.observed_order.map_or("–".into(), |seen| format!("{seen:.2}"));
    let verdict = if row.pass { "pass" } else { "**fail**" };
    format!(
        "| `{}` | {} | {} | {} | {computed} | {expected} | {error} | {order} | {verdict} |",
        case.name,
        escaped(case.quantity),
        escaped(case.source),
        case.passes_when(),
    )
}

/// Text for a cell of a table.
fn escaped(text: &str) -> String {
    text.replace('|', "\\|")
}

/// The report as Markdown: a table for every family, the failures, and the omitted cases. `plots` is the location of the plots. Without a location,
/// the report contains no plots.
pub fn markdown(rows: &[Row], plots: Option<&str>) -> String {
    let mut text = String::new();
    for family in Family::ALL {
        let of: Vec<&Row> = rows.iter().filter(|row| row.case.family == family).collect();
        if of.is_empty() {
            continue;
        }
        let title = family.name();
        let _ = write!(
            text,
            "## {}{}\n\n| case | what is measured | expected value by | passes | measured | expected | error | order | |\n|---|---|---|---|---|---|---|---|---|\n",
            title[..1].to_uppercase(),
            &title[1..]
        );
        of.iter().for_each(|row| _ = writeln!(text, "{}", markdown_row(row)));
        text.push('\n');
        if let Some(folder) = plots {
            for row in of.iter().filter(|row| !row.points.is_empty()) {
                let _ = writeln!(text, "![{name}]({folder}{name}.svg)", name = row.case.name);
            }
            text.push('\n');
        }
    }
    let failed: Vec<&Row> = rows.iter().filter(|row| !row.pass).collect();
    if !failed.is_empty() {
        text.push_str("## What fails\n\n");
        for row in failed {
            let found = row.trouble.clone().unwrap_or_else(|| {
                row.decisive().map_or_else(String::new, |p| {
                    format!("{} error {}, order {}", level(row), rough(p.error), orders(row))
                })
            });
            let _ = writeln!(text, "* `{}`: {}", row.case.name, found.replace('\n', " "));
        }
        text.push('\n');
    }
    text.push_str("## What is left out\n\n");
    LEFT_OUT.iter().for_each(|(what, why)| _ = writeln!(text, "* {what}: {why}."));
    text
}

/// The report as one HTML page, plots included.
pub fn html(rows: &[Row]) -> String {
    let plain = |text: &str| text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    let passed = rows.iter().filter(|row| row.pass).count();
    let mut text = format!(
        "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width\">\n\
         <title>Opruga: verification</title>\n<style>\n{STYLE}</style>\n<h1>Verification</h1>\n<p>{passed} of {} cases pass.</p>\n",
        rows.len()
    );
    for family in Family::ALL {
        let of: Vec<&Row> = rows.iter().filter(|row| row.case.family == family).collect();
        if of.is_empty() {
            continue;
        }
        let _ = write!(
            text,
            "<h2>{}</h2>\n<table>\n<tr><th>case<th>measured<th>expected<th>error<th>limit<th>order<th>time<th></tr>\n",
            family.name()
        );
        for row in &of {
            let case = row.case;
            let (computed, expected, error) = match row.decisive() {
                Some(p) => (with_unit(p.computed, case), with_unit(p.expected, case), rough(p.error)),
                None => ("–".into(), with_unit(case.expected[0], case), "–".into()),
            };
            let (class, verdict) = if row.pass { ("pass", "pass") } else { ("fail", "fail") };
            let _ = writeln!(
                text,
                "<tr class=\"{class}\"><td><a href=\"#{name}\">{name}</a><td>{}<td>{}<td>{error}<td>{}<td>{}<td>{:.2} s<td>{verdict}</tr>",
                plain(&computed),
                plain(&expected),
                rough(case.tolerance),
                orders(row),
                row.seconds,
                name = case.name,
            );
        }
        text.push_str("</table>\n");
        for row in of {
            let case = row.case;
            let name = case.name;
            let _ = writeln!(
                text,
                "<section id=\"{name}\"><h3>{name}</h3><p>{}{}.</p><p class=\"source\">{}</p>",
                plain(case.quantity),
                if case.unit.is_empty() { String::new() } else { format!(" [{}]", plain(case.unit)) },
                plain(case.source)
            );
            if let Some(trouble) = &row.trouble {
                let _ = writeln!(text, "<pre>{}</pre>", plain(trouble));
            }
            if let Ok(svg) = plot(row) {
                // The names in the plot are made unique within the page.
                text.push_str(&svg.replace("panel-", &format!("{name}-panel-")));
            }
            text.push_str("</section>\n");
        }
    }
    text.push_str("<h2>left out</h2>\n<ul>\n");
    LEFT_OUT.iter().for_each(|(what, why)| _ = writeln!(text, "<li>{}: {}.", plain(what), plain(why)));
    text.push_str("</ul>\n</html>\n");
    text
}

const STYLE: &str = "body { font: 15px/1.45 Inter, Helvetica, Arial, sans-serif; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; color: #1c1f26 }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums }
th, td { text-align: right; padding: .2rem .6rem; border-bottom: 1px solid #e3e5ea }
th:first-child, td:first-child { text-align: left }
tr.fail td { background: #fbe9e7; font-weight: 600 }
a { color: inherit }
h2 { text-transform: capitalize; margin-top: 2.5rem }
section { break-inside: avoid; margin: 2rem 0 }
section p { margin: .2rem 0 }
.source { color: #5b606b }
svg { max-width: 100%; height: auto }
";

#[cfg(test)]
mod tests {
    use super::short;

    #[test]
    fn numbers_are_short() {
        assert_eq!(
            [short(0.0), short(23.9676), short(-108_610.28), short(0.493457)],
            ["0", "23.9676", "-108610", "0.493457"]
        );
        assert_eq!([short(1e-13), short(3.0), short(10_000.0)], ["1.00e-13", "3", "10000"]);
    }
}
