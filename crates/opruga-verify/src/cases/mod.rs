//! The table of cases: names, quantities, references, levels, tolerances and orders, fixed before they are run.
//!
//! Unless specified otherwise, a case must satisfy two conditions. The error on the finest mesh is at most 1 %, and over at least three meshes the
//! error falls with an order of at least the theoretical order minus 0.2. Cases that are exact on every mesh have tighter tolerances.

mod at_rest;
mod balloons;
mod beams;
mod belts;
mod boundary;
mod boundary_bodies;
mod boundary_shell;
mod contact;
mod finite_differences;
mod fits;
mod heat;
mod hertz;
mod integrators;
mod ledgers;
mod matching;
mod materials;
mod meetings;
mod membranes;
mod patches;
mod pressed;
mod pressure;
mod solids;
mod springs;
mod vibrations;
mod volumes;

use crate::case::{Case, Check, Family, Over, Scale};

/// The values that a case has unless it gives others.
const BASE: Case = Case {
    name: "",
    family: Family::Statics,
    quantity: "",
    unit: "",
    source: "",
    over: Over::Cells("cells along a side"),
    levels: &[],
    expected: &[0.0],
    scale: Scale::Relative,
    tolerance: 0.01,
    check: Check::Finest,
    quick: false,
    measure: |_, _| Ok(0.0),
};

/// All cases, family by family.
pub fn cases() -> impl Iterator<Item = &'static Case> {
    let lists = [
        patches::CASES,
        membranes::CASES,
        beams::CASES,
        springs::CASES,
        solids::CASES,
        finite_differences::CASES,
        heat::CASES,
        volumes::CASES,
        matching::STATICS,
        boundary::STATICS,
        pressed::CASES,
        hertz::CASES,
        fits::CASES,
        at_rest::CASES,
        finite_differences::MATERIALS,
        materials::CASES,
        volumes::MATERIALS,
        finite_differences::PRESSURE,
        pressure::CASES,
        balloons::CASES,
        finite_differences::DYNAMICS,
        vibrations::CASES,
        contact::CASES,
        meetings::CASES,
        belts::CASES,
        volumes::DYNAMICS,
        matching::DYNAMICS,
        integrators::CASES,
        ledgers::CASES,
        meetings::LEDGERS,
        boundary::LEDGERS,
    ];
    lists.into_iter().flatten()
}

/// Cases that a reader might expect, and the reasons for their absence.
pub const LEFT_OUT: &[(&str, &str)] =
    &[("thin membranes of rubber", "there is no model of membranes; springs obey another law")];

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_case_says_what_it_needs_before_it_is_run() {
        let mut names = BTreeSet::new();
        for case in cases() {
            let name = case.name;
            assert!(names.insert(name), "{name} is there twice");
            assert!(name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-'), "{name}");
            assert!(!case.quantity.is_empty() && case.source.len() > 10, "{name}");
            assert!(case.tolerance > 0.0 && case.tolerance <= 0.01, "{name}: {}", case.tolerance);
            assert!(case.expected.len() == 1 || case.expected.len() == case.levels.len(), "{name}");
            match case.check {
                Check::Order(_) => assert!(case.levels.len() >= 3 && case.expected.len() == 1, "{name}"),
                Check::Finest => assert!(!case.levels.is_empty() && case.expected.len() == 1, "{name}"),
                Check::Everywhere => assert!(!case.levels.is_empty(), "{name}"),
            }
            if case.scale == Scale::Relative {
                assert!(case.expected.iter().all(|x| *x != 0.0), "{name}: nothing to divide by");
            }
            let sizes: Vec<f64> = case.levels.iter().map(|level| case.over.size(*level)).collect();
            if !matches!(case.over, Over::Parameter(_)) {
                assert!(sizes.windows(2).all(|pair| pair[1] < pair[0]), "{name}: fine levels come last");
            }
        }
        assert!(names.len() >= 40, "{}", names.len());
        for family in Family::ALL {
            assert!(cases().any(|case| case.family == family), "{}", family.name());
        }
    }
}
