//! The thesis's algorithm as a student would write it in C++, and Opruga, in one run on one machine.

use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

/// Compiles and runs the baseline, runs `opruga bench vertices`, and prints the ratios.
pub(crate) fn compare() -> Result<(), String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().ok_or("the workspace has no folder")?;
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), |folder| root.join(folder));
    std::fs::create_dir_all(&target).map_err(|e| format!("{}: {e}", target.display()))?;
    let program = target.join("thesis-baseline");
    let compiled = Command::new("g++")
        .args(["-O3", "-march=native", "-fopenmp", "-o"])
        .arg(&program)
        .arg(root.join("benches/baseline/thesis.cpp"))
        .status()
        .map_err(|e| format!("g++ is needed for the baseline: {e}"))?;
    if !compiled.success() {
        return Err("the baseline does not compile".into());
    }
    let opruga = target.join("release/opruga");
    let built = Command::new(env!("CARGO")).args(["build", "--release"]).current_dir(root).status();
    if !built.is_ok_and(|s| s.success()) {
        return Err("opruga does not build".into());
    }
    let baseline = Command::new(&program).env("CPUT", "1").output().map_err(|e| e.to_string())?;
    let baseline = baseline_rows(&String::from_utf8_lossy(&baseline.stdout));
    println!("| rings x vertices | instructions | baseline ns | Opruga ns | ratio |\n|---|---|---|---|---|");
    for simd in ["avx512", "avx2", "sse2"] {
        let output = Command::new(&opruga)
            .args(["bench", "vertices", "--json"])
            .env("OPRUGA_SIMD", simd)
            .output()
            .map_err(|e| e.to_string())?;
        let report: Value = serde_json::from_slice(&output.stdout).map_err(|e| format!("opruga bench: {e}"))?;
        for row in report["rows"].as_array().into_iter().flatten() {
            if row["simd"] != simd {
                continue;
            }
            let (bodies, vertices) = (row["bodies"].as_u64().unwrap_or(0), row["vertices"].as_u64().unwrap_or(0));
            let ours = row["nanoseconds_per_vertex_step"].as_f64().unwrap_or(f64::NAN);
            let theirs = baseline.get(&if bodies == 1 { vertices } else { 0 }).copied().unwrap_or(f64::NAN);
            println!("| {bodies} x {vertices} | {simd} | {theirs:.2} | {ours:.2} | {:.2} |", theirs / ours);
        }
    }
    start_time(&opruga)
}

/// How long the program takes until a body of 100,000 vertices could make its first step.
fn start_time(opruga: &Path) -> Result<(), String> {
    let folder = std::env::temp_dir().join(format!("opruga-start-{}", std::process::id()));
    let mut best = f64::INFINITY;
    for _ in 0..5 {
        let begin = std::time::Instant::now();
        let run = Command::new(opruga)
            .args(["run", "giant-ring", "--seconds", "0", "--no-pictures", "--force", "--out"])
            .arg(&folder)
            .output()
            .map_err(|e| e.to_string())?;
        best = best.min(begin.elapsed().as_secs_f64());
        if !run.status.success() {
            return Err(String::from_utf8_lossy(&run.stderr).into_owned());
        }
    }
    let _ = std::fs::remove_dir_all(&folder);
    println!("\nfrom the call to the initial state of 100,000 vertices, written: {best:.2} s");
    Ok(())
}

/// Nanoseconds per vertex and step by vertices; 0 stands for 1,000 rings of 36.
fn baseline_rows(text: &str) -> BTreeMap<u64, f64> {
    let mut rows = BTreeMap::new();
    for line in text.lines() {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        if let (Some(n), Some(t)) = (cells.get(1), cells.get(3))
            && let (Ok(n), Ok(t)) = (n.parse(), t.parse())
        {
            rows.insert(n, t);
        }
        if let Some(rest) = line.strip_prefix("1000x36, 1 thread(s), barrier each step: ")
            && let Some(t) = rest.split(' ').next().and_then(|t| t.parse().ok())
        {
            rows.insert(0, t);
        }
    }
    rows
}
