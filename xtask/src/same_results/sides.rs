//! The two programs and the results of their runs. The programs are called only through their command lines, because the commit may be old.

use super::comparison::{Outcome, Row};
use super::hashes::hashes;
use crate::workspace;
use serde_json::Value;
use serde_json::value::RawValue;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A commit, or the present tree, with its program.
#[derive(Debug)]
pub(super) struct Side {
    /// The beginning of the commit's hash, or `present`.
    pub(super) name: String,
    /// Its sources.
    pub(super) root: PathBuf,
    program: PathBuf,
    /// The folder of its results.
    folder: PathBuf,
    /// Whether stored results can be used, because the program would compute the same.
    keeps: bool,
}

impl Side {
    /// Makes the side of a commit. Its sources are in a separate work tree. All commits share this work tree, so that cargo compiles only what
    /// differs from the commit that was compiled before. The build folder of the work tree is separate from that of the present tree. Otherwise cargo
    /// could consider a crate as built because the same path in the other tree was built after the file was changed, whatever the file contains.
    pub(super) fn of_commit(folder: &Path, commit: &str) -> Result<Side, String> {
        let root = folder.join("base");
        workspace::check_out(&root, commit)?;
        let name = commit[..12].to_string();
        let side = Side { folder: folder.join(&name), program: program(&folder.join(&name)), name, root, keeps: true };
        if !side.program.is_file() {
            side.build(&folder.join("build"))?;
        }
        Ok(side)
    }

    /// Makes the side of the present tree as it is.
    pub(super) fn present(folder: &Path) -> Result<Side, String> {
        let (own, name) = (folder.join("present"), "present".to_string());
        let side = Side { program: program(&own), root: workspace::root()?, folder: own, name, keeps: false };
        side.build(&workspace::target()?)?;
        Ok(side)
    }

    /// Builds the program and keeps a copy of it, so that later compilations do not change it.
    fn build(&self, target: &Path) -> Result<(), String> {
        eprintln!("building {}", self.name);
        let status = Command::new(env!("CARGO"))
            .args(["build", "--release", "--quiet", "--package", "opruga-cli", "--target-dir"])
            .arg(target)
            .current_dir(&self.root)
            .status()
            .map_err(|e| format!("cargo build: {e}"))?;
        if !status.success() {
            return Err(format!("{} is not built", self.name));
        }
        let built = program(&target.join("release"));
        std::fs::create_dir_all(&self.folder).map_err(|e| format!("{}: {e}", self.folder.display()))?;
        std::fs::copy(&built, &self.program).map(drop).map_err(|e| format!("{}: {e}", built.display()))
    }

    /// Calls the program in a folder in which no file has the name of a scene.
    fn call(&self, arguments: &[&str]) -> Result<Output, String> {
        let mut call = Command::new(&self.program);
        // The variable is removed, because stored results were computed with the best instructions of this machine.
        call.args(arguments).current_dir(&self.folder).env_remove("OPRUGA_SIMD");
        call.output().map_err(|e| format!("{}: {e}", self.program.display()))
    }

    /// Runs a scene for some frames, or reads the earlier result.
    pub(super) fn run(&self, name: &str, call: &str, frames: u64) -> Result<Outcome, String> {
        let folder = self.folder.join(format!("{frames}-frames")).join(name.replace('/', "-"));
        let file = |name: &str| folder.join(name).display().to_string();
        let [ending, table, hashes] = ["ending", "diagnostics.csv", "hashes"].map(|name| folder.join(name));
        // Results of a scene outside the tree are not used again, because its file may have changed.
        let own = !Path::new(call).is_absolute()
            || self.root.canonicalize().is_ok_and(|root| Path::new(call).starts_with(root));
        // The file with the ending is written last. If it exists, the other files are complete.
        if !(self.keeps && own && ending.is_file()) {
            let _ = std::fs::remove_dir_all(&folder);
            std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
            let found = self.compute(call, frames, &file)?;
            let write =
                |path: &Path, text: &str| std::fs::write(path, text).map_err(|e| format!("{}: {e}", path.display()));
            write(&table, &found.table)?;
            write(&hashes, &found.hashes)?;
            write(&ending, &found.ending)?;
        }
        Ok(Outcome::new(workspace::read(&ending)?, &workspace::read(&hashes)?, &workspace::read(&table)?))
    }

    fn compute(&self, call: &str, frames: u64, file: &dyn Fn(&str) -> String) -> Result<Found, String> {
        let [probe, recording, output] = ["probe", "recording", "output"].map(file);
        let common = ["run", call, "--no-pictures", "--json", "--allow-outside", "--force"];
        // The program itself reports the length of a frame.
        let begun = self.call(&[&common[..], &["--seconds", "0", "--out", &probe]].concat())?;
        let length = serde_json::from_slice::<Value>(&begun.stdout).ok().and_then(|summary| summary["frame"].as_f64());
        let Some(length) = length else {
            return Ok(Found { ending: format!("refused: {}", ending(&begun)), ..Found::default() });
        };
        let seconds = format!("{:?}", length * frames as f64);
        let run = ["--seconds", &seconds, "--out", &output, "--diagnostics-every", "1", "--checkpoint-every", "0"];
        let record = ["--record", &recording, "--record-every", "1000000"];
        let ended = self.call(&[&common[..], &run, &record].concat())?;
        let bytes = std::fs::read(&recording).map_err(|e| format!("{call}: {e}: {}", ending(&ended)))?;
        let lines = hashes(&bytes).map_err(|e| format!("{call}: {e}"))?;
        let found = Found {
            ending: ending(&ended),
            hashes: lines.values().map(|hash| format!("{hash:016x}\n")).collect(),
            table: workspace::read(&Path::new(&output).join("diagnostics.csv"))?,
        };
        // Only the compared data are kept, because the recording may be large.
        let _ = std::fs::remove_file(&recording);
        [probe, output].iter().for_each(|folder| drop(std::fs::remove_dir_all(folder)));
        Ok(found)
    }

    /// Runs all cases of `opruga verify` or those of a family, or reads the earlier result. Returns the rows.
    pub(super) fn verify(&self, family: Option<&str>) -> Result<BTreeMap<String, Row>, String> {
        let path = self.folder.join(format!("verify-{}.json", family.unwrap_or("all")));
        if !(self.keeps && path.is_file()) {
            eprintln!("verify, {}", self.name);
            let mut arguments = vec!["verify", "--json"];
            family.iter().for_each(|family| arguments.extend(["--filter", *family]));
            let output = self.call(&arguments)?;
            // Failing cases are rows as well.
            rows(&output.stdout).map_err(|e| format!("verify, {}: {e}: {}", self.name, ending(&output)))?;
            std::fs::write(&path, &output.stdout).map_err(|e| format!("{}: {e}", path.display()))?;
        }
        rows(workspace::read(&path)?.as_bytes())
    }
}

/// The files of a run.
#[derive(Default)]
struct Found {
    ending: String,
    hashes: String,
    table: String,
}

/// The program in a folder.
fn program(folder: &Path) -> PathBuf {
    folder.join(format!("opruga{}", std::env::consts::EXE_SUFFIX))
}

/// Describes how a call ended: its exit code, and the codes of its errors.
fn ending(output: &Output) -> String {
    let said: Value = serde_json::from_slice(&output.stderr).unwrap_or_default();
    let mut codes: Vec<&str> =
        said["errors"].as_array().into_iter().flatten().filter_map(|e| e["code"].as_str()).collect();
    codes.extend(said["code"].as_str());
    let exit = output.status.code().map_or("killed".into(), |code| format!("exit code {code}"));
    if codes.is_empty() { exit } else { format!("{exit}, {}", codes.join(" ")) }
}

/// The rows of `verify --json` by case, without the times. Numbers stay text, so that nothing is rounded.
fn rows(bytes: &[u8]) -> Result<BTreeMap<String, Row>, String> {
    let report: BTreeMap<String, Box<RawValue>> = serde_json::from_slice(bytes).map_err(|e| e.to_string())?;
    let rows = report.get("rows").ok_or("there are no rows")?;
    let rows: Vec<BTreeMap<String, Box<RawValue>>> = serde_json::from_str(rows.get()).map_err(|e| e.to_string())?;
    let row = |row: BTreeMap<String, Box<RawValue>>| {
        let name = row.get("case").ok_or("a row has no case")?.get().trim_matches('"').to_string();
        let figures = row.into_iter().filter(|(figure, _)| figure != "seconds");
        Ok((name, figures.map(|(figure, value)| (figure, spaceless(value.get()))).collect()))
    };
    rows.into_iter().map(row).collect()
}

/// A value on one line.
fn spaceless(value: &str) -> String {
    value.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::rows;

    #[test]
    fn rows_of_verify_keep_every_digit_and_no_seconds() {
        let text =
            br#"{"schema": 1, "rows": [{"case": "a", "computed": 0.30000000000000004, "seconds": 2.0, "levels": [
            {"level": 1.0}
        ]}]}"#;
        let rows = rows(text).expect("rows");
        assert_eq!(rows["a"]["computed"], "0.30000000000000004");
        assert_eq!(rows["a"]["levels"], "[ {\"level\": 1.0} ]");
        assert!(!rows["a"].contains_key("seconds"));
        assert!(super::rows(b"{}").is_err() && super::rows(b"?").is_err());
    }
}
