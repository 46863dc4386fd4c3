//! Checks whether the tests detect ten plausible faults, one in each part of the engine and its surroundings.
//!
//! Each fault is put separately into a work tree of the last commit below `target/mutants`. The tests that must fail are run there without and with
//! the fault. This task is run by hand and takes minutes, because the crate of each fault is compiled again.

use crate::workspace;
use std::path::Path;
use std::process::{Command, Output};

/// A fault: one text of a file replaced by another.
struct Mutant {
    name: &'static str,
    file: &'static str,
    /// The original text, which occurs exactly once in the file.
    text: &'static str,
    instead: &'static str,
    /// The tests that must fail, as arguments of `cargo test`.
    tests: &'static [&'static str],
}

const MUTANTS: [Mutant; 10] = [
    // Damping has the wrong sign.
    Mutant {
        name: "springs",
        file: "crates/opruga-models/src/mass_spring/law.rs",
        text: "thrust -= drag;",
        instead: "thrust += drag;",
        tests: &["--package", "opruga-models", "--test", "all", "mass_spring_in_the_plane"],
    },
    // The energy of an adiabatic gas lacks γ.
    Mutant {
        name: "gas",
        file: "crates/opruga-models/src/pressure/gas.rs",
        text: "(pressure, pressure * v / (gamma - 1.0), gamma)",
        instead: "(pressure, pressure * v / gamma, gamma)",
        tests: &["--package", "opruga-models", "--test", "all", "gas_laws"],
    },
    // The second derivative of a material has the wrong sign.
    Mutant {
        name: "fem",
        file: "crates/opruga-models/src/materials/neo_hookean.rs",
        text: "let factor = p.lambda * log - p.mu;",
        instead: "let factor = p.lambda * log + p.mu;",
        tests: &["--package", "opruga-models", "--test", "all", "every_material_on_every_element_in_the_plane"],
    },
    // Friction lets a node slide although it should stop it.
    Mutant {
        name: "contact",
        file: "crates/opruga-collide/src/response.rs",
        text: "let keep = S::select(pace.less_or_equal(most), zero, S::one() - most / pace);",
        instead: "let keep = S::select(pace.less_or_equal(most), S::one(), S::one() - most / pace);",
        tests: &["--package", "opruga-collide", "--test", "all", "friction::"],
    },
    // The iteration along a curve of equilibria uses the load of the previous point for the next point.
    Mutant {
        name: "statics",
        file: "crates/opruga-integrators/src/equilibrium/arc.rs",
        text: "time: h, h, load: now, impulse: 1.0, echo: 0.0 };",
        instead: "time: h, h, load, impulse: 1.0, echo: 0.0 };",
        tests: &["--package", "opruga-integrators", "--lib", "a_truss_is_followed_through_its_snap"],
    },
    // The reader takes the normal of a triangle for its first corner.
    Mutant {
        name: "reader of STL",
        file: "crates/opruga-io/src/shapes/stl.rs",
        text: "record[12..48].chunks_exact(12)",
        instead: "record[0..36].chunks_exact(12)",
        tests: &["--package", "opruga-io", "--test", "all", "every_format_gives_the_same_cube"],
    },
    // Nodes get other numbers than they have in the file.
    Mutant {
        name: "reader of TetGen",
        file: "crates/opruga-io/src/meshes/tetgen.rs",
        text: "found.node(number, position, offset);",
        instead: "found.node(number + 1, position, offset);",
        tests: &["--package", "opruga-io", "--test", "all", "mesh_round_trips::"],
    },
    // The differences between states in a recording lose their signs.
    Mutant {
        name: "recording",
        file: "crates/opruga-io/src/recording/codec.rs",
        text: "let folded = ((difference << 1) ^ (difference >> 63)) as u64;",
        instead: "let folded = (difference << 1) as u64;",
        tests: &["--package", "opruga-io", "--lib", "recording::codec"],
    },
    // The upper end of a range is excluded.
    Mutant {
        name: "sweep",
        file: "crates/opruga/src/sweep/grid.rs",
        text: "k as f64 / (count - 1) as f64",
        instead: "k as f64 / count as f64",
        tests: &["--package", "opruga", "--lib", "ranges_reach_both_ends"],
    },
    // When the user goes back in time and acts, the studio keeps the future that it should drop.
    Mutant {
        name: "studio",
        file: "crates/opruga-studio/src/keyframes.rs",
        text: "self.kept.retain(|(kept, _)| *kept <= frame);",
        instead: "self.kept.retain(|(kept, _)| *kept >= frame);",
        tests: &["--package", "opruga-studio", "--lib", "keyframes_stay_within_their_budget"],
    },
];

/// The result for a fault.
#[derive(Debug, PartialEq)]
enum Verdict {
    Caught,
    Missed,
}

/// `cargo xtask mutants [NAME …]`: returns an error if the tests miss one of the faults, or if one cannot be tried.
pub(crate) fn run(arguments: &[String]) -> Result<(), String> {
    if let Some(unknown) = arguments.iter().find(|name| !MUTANTS.iter().any(|mutant| mutant.name == **name)) {
        let names: Vec<&str> = MUTANTS.iter().map(|mutant| mutant.name).collect();
        return Err(format!("there is no mutant `{unknown}`; there are {}", names.join(", ")));
    }
    let tree = workspace::target()?.join("mutants/tree");
    workspace::check_out(&tree, &workspace::commit("HEAD")?)?;
    let chosen = |mutant: &&Mutant| arguments.is_empty() || arguments.iter().any(|name| name == mutant.name);
    let (mut failed, mut count) = (0, 0);
    for mutant in MUTANTS.iter().filter(chosen) {
        let verdict = attempt(mutant, &tree);
        count += 1;
        failed += usize::from(verdict != Ok(Verdict::Caught));
        match verdict {
            Ok(verdict) => println!("{}: {verdict:?}", mutant.name),
            Err(error) => println!("{}: error: {error}", mutant.name),
        }
    }
    if failed == 0 { Ok(()) } else { Err(format!("{failed} of {count} mutants are not caught")) }
}

/// Runs the tests without and with a fault.
fn attempt(mutant: &Mutant, tree: &Path) -> Result<Verdict, String> {
    let path = tree.join(mutant.file);
    let sound = workspace::read(&path)?;
    let faulty = mutated(mutant, &sound)?;
    let write = |text: &str| std::fs::write(&path, text).map_err(|e| format!("{}: {e}", path.display()));
    let before = test(tree, mutant.tests, false)?;
    if !before.status.success() || passed(&before) == 0 {
        return Err("without it the tests fail, or there are none".into());
    }
    write(&faulty)?;
    // The tests are compiled first, because a compilation error does not count as a failing test.
    let built = test(tree, mutant.tests, true);
    let after = test(tree, mutant.tests, false);
    write(&sound)?;
    if !built?.status.success() {
        return Err("with it the tests cannot be compiled".into());
    }
    verdict(after?.status.code())
}

/// The verdict for the exit code of the tests. Cargo exits with 101 if a test fails. A killed process gives no verdict.
fn verdict(code: Option<i32>) -> Result<Verdict, String> {
    match code {
        Some(0) => Ok(Verdict::Missed),
        Some(101) => Ok(Verdict::Caught),
        other => Err(format!("with it the tests end with {other:?}, which says nothing")),
    }
}

/// The text of the file with the fault.
fn mutated(mutant: &Mutant, text: &str) -> Result<String, String> {
    match text.matches(mutant.text).count() {
        1 => Ok(text.replace(mutant.text, mutant.instead)),
        count => Err(format!("{} has `{}` {count} times, not once", mutant.file, mutant.text)),
    }
}

/// Compiles tests, and also runs them unless `only_built` is set.
fn test(tree: &Path, tests: &[&str], only_built: bool) -> Result<Output, String> {
    let mut cargo = Command::new(env!("CARGO"));
    let target = workspace::target()?.join("mutants/build");
    cargo.arg("test").args(tests).current_dir(tree).env("CARGO_TARGET_DIR", target);
    if only_built {
        cargo.arg("--no-run");
    }
    cargo.output().map_err(|e| format!("cargo test: {e}"))
}

/// The number of tests that passed.
fn passed(output: &Output) -> usize {
    let text = String::from_utf8_lossy(&output.stdout);
    let counts = text
        .lines()
        .filter_map(|line| line.strip_prefix("test result: ok. ")?.split(' ').next()?.parse::<usize>().ok());
    counts.sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_that_does_not_stand_there_once_is_no_mutant() {
        let mutant = &MUTANTS[0];
        assert_eq!(mutated(mutant, "a thrust -= drag; b"), Ok("a thrust += drag; b".into()));
        for text in ["", "thrust -= drag; thrust -= drag;"] {
            assert!(mutated(mutant, text).is_err(), "{text}");
        }
    }

    #[test]
    fn tests_that_were_killed_say_nothing() {
        assert_eq!(verdict(Some(0)), Ok(Verdict::Missed));
        assert_eq!(verdict(Some(101)), Ok(Verdict::Caught));
        assert!(verdict(None).is_err() && verdict(Some(143)).is_err());
    }

    #[test]
    fn every_mutant_finds_its_text_once_in_the_sources() {
        let root = workspace::root().expect("the workspace");
        for mutant in &MUTANTS {
            let text = workspace::read(&root.join(mutant.file)).expect("a source file");
            assert!(mutated(mutant, &text).is_ok(), "{}", mutant.name);
        }
    }

    #[test]
    fn mutants_have_names_of_their_own_and_change_something() {
        for (number, mutant) in MUTANTS.iter().enumerate() {
            assert!(MUTANTS[..number].iter().all(|other| other.name != mutant.name));
            assert_ne!(mutant.text, mutant.instead, "{}", mutant.name);
        }
    }
}
