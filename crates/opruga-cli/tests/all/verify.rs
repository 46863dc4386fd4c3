//! `opruga verify` as its users see it.
#![allow(clippy::disallowed_methods)] // no physics here

use crate::common;
use common::*;
use serde_json::Value;

#[test]
fn a_report_has_a_plot_for_every_case_and_is_not_replaced_unasked() {
    let folder = tempfile::tempdir().expect("a folder");
    let call = ["verify", "--filter", "order-heun", "--filter", "fall-", "--report", "r", "--json", "--threads", "1"];
    let output = opruga(folder.path(), &call);
    assert_eq!(code(&output), 0, "{}", said(&output));
    assert!(said(&output).is_empty(), "{}", said(&output));
    let found: Value = serde_json::from_slice(&output.stdout).expect("stdout is JSON");
    let rows = found["rows"].as_array().expect("rows");
    assert_eq!((rows.len(), found["failed"].as_u64()), (5, Some(0)));
    for row in rows {
        for key in
            ["case", "quantity", "computed", "expected", "error", "tolerance", "observed_order", "source", "pass"]
        {
            assert!(row.get(key).is_some(), "{key}");
        }
        let svg = folder.path().join("r").join(format!("{}.svg", row["case"].as_str().expect("a name")));
        assert!(std::fs::read_to_string(svg).expect("a plot").starts_with("<svg"));
    }
    for name in ["report.html", "report.md", "report.json"] {
        let text = std::fs::read_to_string(folder.path().join("r").join(name)).expect("a report");
        assert!(text.contains("order-heun"), "{name}");
    }
    let again = opruga(folder.path(), &call);
    assert_eq!(code(&again), 4, "{}", said(&again));
    let error: Value = serde_json::from_str(&said(&again)).expect("the error is JSON");
    assert_eq!(error["code"], "write.exists");
}

#[test]
fn the_table_is_for_people_and_the_list_tells_sources() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = opruga(folder.path(), &["verify", "--filter", "finite-volume-hanging-bar-quadrilaterals"]);
    assert_eq!(code(&output), 0, "{}", said(&output));
    assert!(printed(&output).contains("1 of 1 pass") && printed(&output).contains("0.03924 m"), "{}", printed(&output));
    assert!(said(&output).contains("pass  finite-volume-hanging-bar-quadrilaterals"), "{}", said(&output));
    let list = printed(&opruga(folder.path(), &["verify", "--list"]));
    assert!(list.contains("nafems-le1-quadrilaterals") && list.contains("NAFEMS"), "{list}");
    let of_family = opruga(folder.path(), &["verify", "--list", "--filter", "materials", "--json"]);
    let rows: Value = serde_json::from_slice(&of_family.stdout).expect("JSON");
    assert!(rows["rows"].as_array().expect("rows").iter().all(|row| row["family"] == "materials"));
}

#[test]
fn a_word_that_names_no_case_is_refused_with_the_nearest() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = opruga(folder.path(), &["verify", "--filter", "ledger"]);
    // A part of a name is sufficient, but the name of a family must be complete.
    assert_eq!(code(&output), 2, "{}", said(&output));
    assert!(said(&output).contains("did you mean `ledgers`"), "{}", said(&output));
}

#[test]
fn a_wrong_modulus_is_noticed_and_fails() {
    let folder = tempfile::tempdir().expect("a folder");
    let call = |factor: &str| opruga(folder.path(), &["verify", "--filter", "simple-shear", "--stiffer", factor]);
    assert_eq!((code(&call("1")), code(&call("1.01")), code(&call("3"))), (0, 1, 2), "{}", said(&call("1.01")));
    assert!(printed(&call("1.01")).contains("0 of 1 pass") && said(&call("3")).contains("0.5 to 2"));
}

/// A case may take minutes: the program does not wait for it, and leaves no part of a report.
#[cfg(unix)]
#[test]
fn an_interrupted_verification_ends_with_130_and_writes_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let call = ["verify", "--report", "r", "--json", "--threads", "2"];
    let child = program(folder.path(), &call).spawn().expect("the program runs");
    until("the report's folder is there", || folder.path().join("r").join(".opruga-lock").exists());
    // Cases are running by then; together they take far longer.
    std::thread::sleep(std::time::Duration::from_millis(700));
    signal(&child, "INT");
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(130), "{}", said(&output));
    let error: Value = serde_json::from_str(&said(&output)).expect("the error is JSON");
    assert_eq!(error["code"], "interrupted");
    assert!(printed(&output).is_empty() && contents(&folder.path().join("r")).is_empty());
}
