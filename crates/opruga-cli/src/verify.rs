//! `opruga verify`: compares the engine with closed forms and published numbers.

use crate::arguments::Verify;
use crate::errors::{CallFault, CallRange};
use crate::failure::{Failure, print_data};
use crate::interrupt;
use crate::run::simd_from_environment;
use opruga::Registries;
use opruga::core::spec::nearest;
use opruga::io::output_folder::{Existing, OutputFolder};
use opruga::io::problem::visible;
use opruga::math::words::counted;
use opruga_verify::{Case, Check, Family, Lab, Row};
use serde_json::json;
use std::fmt::Write as _;
use std::io::IsTerminal;

/// Runs the cases. The exit code is 1 if one of them fails.
pub(crate) fn verify(call: &Verify, registries: &Registries) -> Result<u8, Failure> {
    let cases = chosen(&call.filter)?;
    if !(0.5..=2.0).contains(&call.stiffer) {
        return Err(Failure::range("--stiffer", call.stiffer, CallRange::Between { least: 0.5, most: 2.0 }));
    }
    if call.list {
        print_data(&if call.json { list_as_json(&cases) } else { list(&cases) })?;
        return Ok(0);
    }
    let lab = Lab { simd: simd_from_environment()?, stiffer: call.stiffer, registries: registries.clone() };
    let stop = interrupt::asked_to_stop();
    // Checks before the work whether the report can be written.
    let existing = if call.force { Existing::Replace } else { Existing::Refuse };
    let folder = call.report.as_ref().map(|path| OutputFolder::open(path, existing)).transpose()?;
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = call.threads.map_or(cores, usize::from);
    let bar = progress_bar(cases.len());
    // With --json, errors of a call are JSON, and nothing else is printed.
    let verbose = !call.json && !std::io::stderr().is_terminal();
    let rows = opruga_verify::run_all(&cases, &lab, threads, stop, &|row: &Row| {
        bar.inc(1);
        if verbose {
            let verdict = if row.pass { "pass" } else { "FAIL" };
            eprintln!("{verdict}  {} ({:.2} s)", row.case.name, row.seconds);
        }
    });
    bar.finish_and_clear();
    if rows.len() < cases.len() {
        // Cases that are still running end with the program.
        return Err(Failure::Interrupted);
    }
    if let Some(folder) = &folder {
        write_report(folder, &rows)?;
    }
    let json = serde_json::to_string_pretty(&opruga_verify::to_json(&rows)).unwrap_or_default() + "\n";
    print_data(&if call.json { json } else { opruga_verify::table(&rows) })?;
    if let Some(folder) = folder.filter(|_| !call.json) {
        eprintln!("written to {}", folder.path("").display());
    }
    let failed = rows.iter().any(|row| !row.pass);
    if failed && !call.json {
        eprintln!("docs/verification.md explains the failures that are known");
    }
    Ok(u8::from(failed))
}

/// The cases that any of the words names, or all cases if there are no words.
fn chosen(words: &[String]) -> Result<Vec<&'static Case>, Failure> {
    for word in words {
        let of_word = |case: &Case| case.name.contains(word.as_str()) || case.family.name() == word;
        if !opruga_verify::cases().any(of_word) {
            let families = Family::ALL.map(Family::name);
            let known = opruga_verify::cases().map(|case| case.name).chain(families);
            let closest = nearest(word, known);
            let (word, families) = (visible(word), families.join(", "));
            return Err(Failure::call(match closest {
                Some(closest) => CallFault::NoCaseNear { word, families, closest },
                None => CallFault::NoCase { word, families },
            }));
        }
    }
    let wanted = |case: &&Case| {
        words.is_empty() || words.iter().any(|word| case.name.contains(word.as_str()) || case.family.name() == word)
    };
    Ok(opruga_verify::cases().filter(wanted).collect())
}

/// `report.html`, `report.md`, `report.json`, and a plot for each case.
fn write_report(folder: &OutputFolder, rows: &[Row]) -> Result<(), Failure> {
    let write = |name: &str, text: &str| folder.write(name, false, |out| out.write_all(text.as_bytes()));
    for row in rows {
        if let Ok(svg) = opruga_verify::plot(row) {
            write(&format!("{}.svg", row.case.name), &svg)?;
        }
    }
    let mut text = String::from("# Verification\n\n");
    if let Some(svg) = opruga_verify::overview(rows) {
        write("overview.svg", &svg)?;
        text.push_str("![Errors of the kinds of cells over their size](overview.svg)\n\n");
    }
    text.push_str(&opruga_verify::markdown(rows, Some("")));
    write("report.md", &text)?;
    let json = serde_json::to_string_pretty(&opruga_verify::to_json(rows)).unwrap_or_default();
    write("report.json", &(json + "\n"))?;
    // The page is written last, so that a visible page belongs to a complete report.
    write("report.html", &opruga_verify::html(rows))?;
    Ok(())
}

/// The list of the cases by family, as text.
fn list(cases: &[&Case]) -> String {
    let mut text = String::new();
    for family in Family::ALL {
        let mut of = cases.iter().filter(|case| case.family == family).peekable();
        if of.peek().is_some() {
            let _ = writeln!(text, "{}", family.name());
        }
        for case in of {
            let _ =
                writeln!(text, "  {}\n    {}\n    {}; {}", case.name, case.quantity, case.passes_when(), case.source);
        }
    }
    let _ = writeln!(text, "{}", counted(cases.len() as u64, "case", "cases"));
    text
}

fn list_as_json(cases: &[&Case]) -> String {
    let rows: Vec<_> = cases
        .iter()
        .map(|case| {
            let order = if let Check::Order(order) = case.check { Some(order) } else { None };
            json!({"case": case.name, "family": case.family.name(), "quantity": case.quantity, "unit": case.unit,
                   "expected": case.expected, "levels": case.levels, "tolerance": case.tolerance, "order": order,
                   "source": case.source})
        })
        .collect();
    serde_json::to_string_pretty(&json!({"schema": 1, "rows": rows})).unwrap_or_default() + "\n"
}

fn progress_bar(cases: usize) -> indicatif::ProgressBar {
    if !std::io::stderr().is_terminal() {
        return indicatif::ProgressBar::hidden();
    }
    let style = indicatif::ProgressStyle::with_template("{bar:40} {pos}/{len} cases, {elapsed}");
    indicatif::ProgressBar::new(cases as u64)
        .with_style(style.unwrap_or_else(|_| indicatif::ProgressStyle::default_bar()))
}
