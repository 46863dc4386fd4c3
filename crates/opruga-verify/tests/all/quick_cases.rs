//! The quick cases, run as `opruga verify` runs them, and run with a wrong modulus.

use opruga_verify::{Case, Lab, Row, cases, html, markdown, plot, run_all, table, to_json};
use std::sync::LazyLock;
use std::sync::atomic::AtomicBool;

fn run(lab: &Lab) -> Vec<Row> {
    let quick: Vec<&'static Case> = cases().filter(|case| case.quick).collect();
    run_all(&quick, lab, 2, &AtomicBool::new(false), &|_| {})
}

static ROWS: LazyLock<Vec<Row>> = LazyLock::new(|| run(&Lab::default()));

#[test]
fn the_quick_cases_pass() {
    assert!(ROWS.len() >= 40, "{}", ROWS.len());
    let failed: Vec<&str> = ROWS.iter().filter(|row| !row.pass).map(|row| row.case.name).collect();
    assert!(failed.is_empty(), "{}", table(&ROWS));
}

/// The search for the common equilibrium of two elastic balls ends, whichever pairs of features it finds first.
#[test]
fn two_balls_of_few_cells_reach_their_common_equilibrium() {
    let balls = cases().find(|case| case.name == "hertz-sphere").expect("the case");
    let coarse: &'static Case = Box::leak(Box::new(Case { levels: &[4.0], ..*balls }));
    let rows = run_all(&[coarse], &Lab::default(), 1, &AtomicBool::new(false), &|_| {});
    assert_eq!(rows[0].trouble, None);
}

/// A table that passes whatever the engine does would prove nothing: with a shear modulus that is wrong by 1 % it fails.
#[test]
fn a_modulus_that_is_wrong_by_a_hundredth_is_noticed() {
    let wrong = run(&Lab { stiffer: 1.01, ..Lab::default() });
    let noticed = wrong.iter().zip(ROWS.iter()).filter(|(wrong, right)| right.pass && !wrong.pass).count();
    assert!(noticed >= 10, "{noticed} cases notice it\n{}", table(&wrong));
    // Cases that do not depend on a modulus are unchanged.
    let untouched = |name: &str| wrong.iter().find(|row| row.case.name == name).is_some_and(|row| row.pass);
    assert!(untouched("gas-law-adiabatic") && untouched("fall-bdf2") && untouched("patch-hexahedra"));
}

#[test]
fn every_row_is_in_every_report() {
    let (page, text, json) = (html(&ROWS), markdown(&ROWS, Some("")), to_json(&ROWS));
    for (row, object) in ROWS.iter().zip(json["rows"].as_array().expect("rows")) {
        let name = row.case.name;
        assert!(page.contains(&format!("id=\"{name}\"")), "{name}");
        assert!(text.contains(&format!("| `{name}` |")) && text.contains(&format!("({name}.svg)")), "{name}");
        assert_eq!(object["case"], name);
        for key in ["quantity", "computed", "expected", "error", "tolerance", "observed_order", "source", "pass"] {
            assert!(object.get(key).is_some(), "{name}: {key}");
        }
        assert_eq!(object["pass"], row.pass);
        let svg = plot(row).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert!(svg.starts_with("<svg") && svg.contains("limit"), "{name}");
    }
    assert_eq!(json["passed"].as_u64(), Some(ROWS.iter().filter(|row| row.pass).count() as u64));
}

#[test]
fn rows_do_not_depend_on_threads() {
    let few: Vec<&'static Case> = cases().filter(|case| case.quick && case.name.starts_with("order-")).collect();
    let of = |threads| run_all(&few, &Lab::default(), threads, &AtomicBool::new(false), &|_| {});
    for (one, three) in of(1).iter().zip(of(3)) {
        assert_eq!((one.case.name, &one.points), (three.case.name, &three.points));
    }
}

#[test]
fn a_run_that_is_stopped_leaves_the_rest_out() {
    let all: Vec<&'static Case> = cases().filter(|case| case.quick).take(3).collect();
    let stop = AtomicBool::new(true);
    assert!(run_all(&all, &Lab::default(), 2, &stop, &|_| {}).is_empty());
}
