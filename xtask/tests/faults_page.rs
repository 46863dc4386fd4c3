//! The tests named on the page of faults exist, so that a reader of a row can run them.

use std::path::{Path, PathBuf};

/// The section whose rows name their tests by file and function.
const WHOLE: &str = "## Found from outside";

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace has a folder").to_path_buf()
}

/// The file for a name that begins with its crate.
fn file_of(name: &str) -> PathBuf {
    if name.starts_with("xtask/") { root().join(name) } else { root().join("crates").join(name) }
}

/// Whether a source has a test of this name.
fn has_test(source: &str, name: &str) -> bool {
    let head = format!("fn {name}(");
    let lines: Vec<&str> = source.lines().map(str::trim).collect();
    lines.iter().enumerate().filter(|(_, line)| line.starts_with(&head)).any(|(at, _)| {
        // Attributes and comments are in between.
        let above = lines[..at].iter().rev().take_while(|line| line.starts_with("#[") || line.starts_with("//"));
        above.into_iter().any(|line| line.starts_with("#[test]"))
    })
}

/// The texts between backticks.
fn quoted(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

#[test]
fn tests_that_the_page_of_faults_names_are_there() {
    let page = std::fs::read_to_string(root().join("docs/faults.md")).expect("the page of faults");
    let mut missing = Vec::new();
    let mut named = 0;
    for (file, test) in page.lines().flat_map(quoted).filter_map(|text| text.split_once("::")) {
        if !file.ends_with(".rs") {
            continue;
        }
        named += 1;
        match std::fs::read_to_string(file_of(file)) {
            Ok(source) if has_test(&source, test) => {}
            Ok(_) => missing.push(format!("{file} has no test `{test}`")),
            Err(_) => missing.push(format!("there is no file {file}, of `{test}`")),
        }
    }
    assert!(named > 100, "the page names {named} tests");
    assert!(missing.is_empty(), "docs/faults.md:\n{}", missing.join("\n"));
}

#[test]
fn rows_of_faults_found_from_outside_name_their_tests_in_full() {
    let page = std::fs::read_to_string(root().join("docs/faults.md")).expect("the page of faults");
    let (_, section) = page.split_once(WHOLE).expect("the section");
    let section = section.split("\n## ").next().unwrap_or(section);
    let rows: Vec<&str> = section.lines().filter(|line| line.starts_with("| ")).skip(1).collect();
    assert!(rows.len() > 60, "{} rows", rows.len());
    for row in rows {
        let last = row.trim_end_matches('|').trim().rsplit(" | ").next().unwrap_or(row);
        // A fault that no test can show is marked as such.
        if last == "–" {
            continue;
        }
        for one in last.split(", ") {
            let inner = one.strip_prefix('`').and_then(|one| one.strip_suffix('`')).unwrap_or("");
            let whole = inner.split_once(".rs::").is_some_and(|(_, test)| {
                !test.is_empty() && test.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
            });
            assert!(whole, "`crate/path.rs::test_name` is wanted, not {one}, in the row\n{row}");
        }
    }
}
