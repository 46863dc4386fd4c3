//! Maintenance tasks of the workspace: licences, results, sizes, pictures, speeds, and the web page of the studio. `cargo xtask --help` lists them.
#![allow(clippy::disallowed_methods)] // no physics here

mod bench;
mod circles;
mod gallery;
mod goldens;
mod licences;
mod mutants;
mod names;
mod same_results;
mod tokens;
mod web;
mod workspace;

use std::process::ExitCode;

/// A task: its word, its arguments, its description, the largest number of arguments, and its function.
struct Chore {
    word: &'static str,
    arguments: &'static str,
    about: &'static str,
    most: usize,
    work: fn(&[String]) -> Result<(), String>,
}

const CHORES: [Chore; 12] = [
    Chore {
        word: "licences",
        arguments: "",
        about: "looks whether the licences of all dependencies are allowed",
        most: 0,
        work: |_| licences::check(),
    },
    Chore {
        word: "goldens",
        arguments: "",
        about: "runs every scene and writes scenes/golden.txt",
        most: 0,
        work: |_| goldens::write(),
    },
    Chore {
        word: "same-results",
        arguments: "BASE [--scenes A,B] [--frames N] [--quick] [--also FOLDER]",
        about: "runs all scenes and `opruga verify` of another commit and of the present tree, and compares every bit",
        most: usize::MAX,
        work: same_results::run,
    },
    Chore {
        word: "circles",
        arguments: "",
        about: "lists the import circles between the files of each crate",
        most: 0,
        work: |_| circles::check(),
    },
    Chore {
        word: "tokens",
        arguments: "[BASE] [--long]",
        about: "counts Rust tokens and long functions of each crate, and their change since a commit",
        most: 2,
        work: tokens::report,
    },
    Chore {
        word: "names",
        arguments: "",
        about: "refuses names that have a word which the glossary replaces",
        most: 0,
        work: |_| names::check(),
    },
    Chore {
        word: "mutants",
        arguments: "[NAME …]",
        about: "puts ten faults into the code, one by one, and looks whether the tests notice",
        most: usize::MAX,
        work: mutants::run,
    },
    Chore {
        word: "gallery",
        arguments: "[--check] [PICTURE …]",
        about: "draws the pictures of the documentation anew, or only compares them",
        most: usize::MAX,
        work: gallery::run,
    },
    Chore {
        word: "bench",
        arguments: "",
        about: "measures Opruga beside the baseline, for about ten minutes",
        most: 0,
        work: |_| bench::compare(),
    },
    Chore {
        word: "web",
        arguments: "[--serve] [--port NUMBER]",
        about: "compiles the page of the studio and lays its files out",
        most: 3,
        work: web::build,
    },
    Chore {
        word: "web-trial",
        arguments: "[PROFILE] [--built]",
        about: "tries the page in a browser",
        most: 2,
        work: web::trial,
    },
    Chore {
        word: "web-measure",
        arguments: "[PICTURES]",
        about: "measures the page in a browser",
        most: 1,
        work: web::measure,
    },
];

impl Chore {
    fn usage(&self) -> String {
        format!("cargo xtask {} {}", self.word, self.arguments).trim_end().to_string()
    }
}

/// All tasks, for people.
fn help() -> String {
    let rows: Vec<String> = CHORES.iter().map(|chore| format!("  {:<68} {}", chore.usage(), chore.about)).collect();
    format!("Chores of the workspace\n{}", rows.join("\n"))
}

/// Executes the task that the arguments name, or returns help to be printed.
fn chore(arguments: &[String]) -> Result<Option<String>, String> {
    let is_help = |word: &String| word == "--help" || word == "-h" || word == "help";
    let chore = arguments.first().and_then(|word| CHORES.iter().find(|chore| chore.word == word));
    match (chore, arguments.first()) {
        (Some(chore), _) => {
            let rest = &arguments[1..];
            if rest.iter().any(is_help) {
                return Ok(Some(format!("{}\n{}", chore.usage(), chore.about)));
            }
            let option =
                rest.iter().find(|word| word.starts_with('-') && !chore.arguments.contains(&format!("[{word}")));
            if let Some(unknown) = option.or(rest.get(chore.most)) {
                return Err(format!("`{unknown}` says nothing here; usage: {}", chore.usage()));
            }
            (chore.work)(rest).map(|()| None)
        }
        (None, Some(word)) if is_help(word) => Ok(Some(help())),
        (None, Some(word)) => Err(format!("there is no chore `{word}`\n{}", help())),
        (None, None) => Err(help()),
    }
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match chore(&arguments) {
        Ok(text) => {
            text.iter().for_each(|text| println!("{text}"));
            ExitCode::SUCCESS
        }
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(words: &[&str]) -> Result<Option<String>, String> {
        chore(&words.iter().map(ToString::to_string).collect::<Vec<_>>())
    }

    #[test]
    fn every_chore_answers_help_and_refuses_words_that_say_nothing() {
        assert!(said(&["--help"]).is_ok_and(|text| text.is_some_and(|text| text.contains("web-measure"))));
        assert!(said(&[]).is_err() && said(&["banch"]).is_err());
        for chore in &CHORES {
            for help in [&[chore.word, "--help"][..], &[chore.word, "-h"], &[chore.word, "x", "--help"]] {
                assert!(said(help).is_ok_and(|text| text.is_some_and(|text| text.contains(chore.about))), "{help:?}");
            }
            assert!(said(&[chore.word, "--no-such-word"]).is_err(), "{}", chore.word);
            if chore.most < usize::MAX {
                let many = [&[chore.word][..], &["1"; 4][..]].concat();
                assert!(said(&many).is_err(), "{}", chore.word);
            }
        }
    }
}
