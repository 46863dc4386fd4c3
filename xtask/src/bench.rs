//! Compares Opruga with the algorithm of the thesis, as a student would write it in C++, in one run on one machine. Prints all figures that Opruga
//! promises for its explicit integrators, with their targets.
//!
//! The two programs run alternately, each for some tenths of a second. All rows are run once before any row is run again. The result of a row is the
//! median of the ratios of consecutive runs, so that other load on the machine affects both programs. Load that lasts a minute affects all rows, and
//! not just one of them.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// How often every pair of runs is measured; the result is the median of their ratios.
const ROUNDS: usize = 7;
/// Processor time of one run [s].
const SECONDS: f64 = 0.3;
/// The rings and vertices of the rows that are compared with the baseline.
const ROWS: [(usize, usize); 7] = [(1, 36), (1, 1_024), (1, 16_384), (1, 100_000), (1, 1_048_576), (1_000, 36), MANY];
/// The rings and vertices of the row with a million vertices.
const MANY: (usize, usize) = (27_778, 36);
/// The pressurised sphere of the second table.
const SPHERE: &str = "benches/scenes/icosphere.toml";

/// The two programs, and the folder of the workspace.
struct Programs {
    root: PathBuf,
    baseline: PathBuf,
    opruga: PathBuf,
}

/// A measured run: nanoseconds per vertex and step.
type Timed<'a> = Box<dyn Fn() -> Result<f64, String> + 'a>;

/// Two runs that are measured alternately, and their results for every round: the times, and the first divided by the second.
struct Pair<'a> {
    runs: [Timed<'a>; 2],
    found: [Vec<f64>; 3],
}

impl<'a> Pair<'a> {
    fn new(first: impl Fn() -> Result<f64, String> + 'a, second: impl Fn() -> Result<f64, String> + 'a) -> Self {
        Self { runs: [Box::new(first), Box::new(second)], found: [const { Vec::new() }; 3] }
    }

    fn measure(&mut self) -> Result<(), String> {
        let (first, second) = (self.runs[0]()?, self.runs[1]()?);
        for (list, figure) in self.found.iter_mut().zip([first, second, first / second]) {
            list.push(figure);
        }
        Ok(())
    }

    /// The medians of the two times, and of their ratios.
    fn medians(&self) -> [f64; 3] {
        self.found.each_ref().map(|list| median(list.clone()))
    }
}

/// Compiles and runs the baseline, runs `opruga bench vertices`, and prints the ratios.
pub(crate) fn compare() -> Result<(), String> {
    let programs = Programs::build()?;
    println!("load of the machine before: {}\n", load());
    let mut sets = Vec::new();
    for simd in ["avx512", "avx2", "sse2"] {
        if programs.row((1, 36), simd, &[])?["simd"] == simd {
            sets.push(simd);
        }
    }
    let best = sets[0];
    let rows: Vec<_> = ROWS.iter().flat_map(|&rings| sets.iter().map(move |&simd| (rings, simd))).collect();
    let programs = &programs;
    let mut pairs: Vec<Pair> = Vec::new();
    for &((bodies, vertices), simd) in &rows {
        pairs.push(Pair::new(
            move || programs.baseline(bodies.min(1_000), vertices),
            move || programs.nanoseconds((bodies, vertices), simd, &[]),
        ));
    }
    let classical = [(1, 1_024), (1_000, 36)];
    for rings in classical {
        pairs.push(Pair::new(
            move || programs.nanoseconds(rings, best, &["--integrator", "runge_kutta"]),
            move || programs.nanoseconds(rings, best, &[]),
        ));
    }
    pairs.push(Pair::new(
        || programs.nanoseconds(MANY, best, &[]),
        || programs.nanoseconds(MANY, best, &["--threads", "2"]),
    ));
    pairs.push(Pair::new(|| programs.baseline(1, 16_384), || programs.sphere(best)));
    for round in 1..=ROUNDS {
        eprintln!("round {round} of {ROUNDS}");
        pairs.iter_mut().try_for_each(Pair::measure)?;
    }
    println!(
        "| rings x vertices | instructions | baseline ns | Opruga ns | ratio | target | |\n|---|---|---|---|---|---|---|"
    );
    let mut pairs = pairs.iter().map(Pair::medians);
    for (&((bodies, vertices), simd), [theirs, ours, ratio]) in rows.iter().zip(&mut pairs) {
        let (target, verdict) = match target(bodies, vertices, simd, simd == best) {
            Some(target) => (format!("{target}"), verdict(ratio / target)),
            None => ("–".into(), String::new()),
        };
        println!("| {bodies} x {vertices} | {simd} | {theirs:.2} | {ours:.2} | {ratio:.2} | {target} | {verdict} |");
    }
    println!("\n| what | measured | target | |\n|---|---|---|---|");
    for ((bodies, vertices), [slow, fast, ratio]) in classical.into_iter().zip(&mut pairs) {
        let what = format!("Runge–Kutta over symplectic Euler, {bodies} x {vertices} ({slow:.2} and {fast:.2} ns)");
        say(&what, &format!("{ratio:.2}"), "≤ 4.4", 4.4 / ratio);
    }
    if let Some([one, two, ratio]) = pairs.next() {
        let what = format!("27778 x 36 on two threads over one ({two:.2} ns by the clock, {one:.2} ns)");
        say(&what, &format!("{ratio:.2}"), "≥ 1.8", ratio / 1.8);
        let frames = 1e9 / (two * 16.0 * (MANY.0 * MANY.1) as f64);
        say("27778 x 36 on two threads, frames of 16 steps a second", &format!("{frames:.0}"), "≥ 60", frames / 60.0);
    }
    if let Some([baseline, time, ratio]) = pairs.next() {
        let what = format!(
            "pressurised sphere, 1 x 10242, ns per vertex and step ({:.2} of the baseline's ring of 16384, {baseline:.2} ns)",
            1.0 / ratio
        );
        say(&what, &format!("{time:.1}"), "≤ 15", 15.0 / time);
    }
    programs.balances()?;
    programs.spot(best)?;
    programs.triangles()?;
    let bytes = number(&programs.row((1, 100_000), best, &[])?, "heap_bytes_per_vertex")?;
    say("heap of a ring of 100,000, bytes per vertex", &format!("{bytes:.0}"), "≤ 200", 200.0 / bytes);
    let start = programs.start_time()?;
    let what = "from the call to the initial state of 100,000 vertices, written, s (least of five)";
    say(what, &format!("{start:.2}"), "< 0.5", 0.5 / start);
    println!("\nNo frame asks for memory after the tenth: `cargo test --workspace --test allocation`.");
    println!("load of the machine after: {}", load());
    Ok(())
}

/// The target for the factor by which Opruga is faster than the baseline on rings. `best` means the best instructions of this machine.
fn target(bodies: usize, vertices: usize, simd: &str, best: bool) -> Option<f64> {
    match (bodies, vertices) {
        (1, 1_024 | 16_384 | 100_000) => match simd {
            "avx512" => Some(7.0),
            "avx2" => Some(5.0),
            _ => Some(2.8),
        },
        (1, 36) if best => Some(2.0),
        (1, 1_048_576) if best => Some(4.3),
        (1_000, 36) if best => Some(5.0),
        _ => None,
    }
}

/// The word for a figure that reaches this fraction of its target.
fn verdict(share: f64) -> String {
    if share >= 1.0 { "met".into() } else { format!("{:.0} % short", 100.0 * (1.0 - share)) }
}

fn say(what: &str, measured: &str, target: &str, share: f64) {
    println!("| {what} | {measured} | {target} | {} |", verdict(share));
}

/// The load of the last minute per processor, if the system reports it.
fn load() -> String {
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    match std::fs::read_to_string("/proc/loadavg") {
        Ok(text) => format!("{} at work, {processors} processors", text.split(' ').next().unwrap_or("?")),
        Err(_) => format!("unknown, {processors} processors"),
    }
}

fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers.get(numbers.len() / 2).copied().unwrap_or(f64::NAN)
}

fn number(row: &Value, name: &str) -> Result<f64, String> {
    row[name].as_f64().ok_or_else(|| format!("`opruga` says nothing of {name}: {row}"))
}

/// The output of a program, or its error message if it fails.
fn output(command: &mut Command) -> Result<Vec<u8>, String> {
    let output = command.output().map_err(|e| format!("{command:?}: {e}"))?;
    if !output.status.success() {
        return Err(format!("{command:?}: {}", String::from_utf8_lossy(&output.stderr)));
    }
    Ok(output.stdout)
}

/// The first row of the output of `opruga bench … --json`.
fn first_row(call: &mut Command) -> Result<Value, String> {
    let mut report: Value = serde_json::from_slice(&output(call)?).map_err(|e| format!("opruga bench: {e}"))?;
    match report["rows"].get_mut(0) {
        Some(row) => Ok(row.take()),
        None => Err(format!("opruga bench: {report}")),
    }
}

impl Programs {
    fn build() -> Result<Programs, String> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().ok_or("the workspace has no folder")?;
        let target =
            std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), |folder| root.join(folder));
        std::fs::create_dir_all(&target).map_err(|e| format!("{}: {e}", target.display()))?;
        let baseline = target.join("thesis-baseline");
        let compiled = Command::new("g++")
            .args(["-O3", "-march=native", "-fopenmp", "-o"])
            .arg(&baseline)
            .arg(root.join("benches/baseline/thesis.cpp"))
            .status()
            .map_err(|e| format!("g++ is needed for the baseline: {e}"))?;
        if !compiled.success() {
            return Err("the baseline does not compile".into());
        }
        let built = Command::new(env!("CARGO")).args(["build", "--release"]).current_dir(root).status();
        if !built.is_ok_and(|s| s.success()) {
            return Err("opruga does not build".into());
        }
        Ok(Programs { root: root.into(), baseline, opruga: target.join("release/opruga") })
    }

    /// Nanoseconds per vertex and step of the baseline.
    fn baseline(&self, bodies: usize, vertices: usize) -> Result<f64, String> {
        let mut call = Command::new(&self.baseline);
        call.args([bodies.to_string(), vertices.to_string(), SECONDS.to_string()]).env("CPUT", "1");
        let text = String::from_utf8_lossy(&output(&mut call)?).into_owned();
        text.trim().parse().map_err(|_| format!("the baseline says `{text}`"))
    }

    /// One row of `opruga bench vertices`.
    fn row(&self, (bodies, vertices): (usize, usize), simd: &str, more: &[&str]) -> Result<Value, String> {
        let only = if bodies == 1 { vertices.to_string() } else { format!("{bodies}x{vertices}") };
        let mut call = Command::new(&self.opruga);
        call.args(["bench", "vertices", "--json", "--only", &only, "--seconds", &SECONDS.to_string()]);
        call.args(more).env("OPRUGA_SIMD", simd);
        first_row(&mut call)
    }

    fn nanoseconds(&self, rings: (usize, usize), simd: &str, more: &[&str]) -> Result<f64, String> {
        number(&self.row(rings, simd, more)?, "nanoseconds_per_vertex_step")
    }

    /// The pressurised sphere: nanoseconds per vertex and step.
    fn sphere(&self, simd: &str) -> Result<f64, String> {
        let scene = self.root.join(SPHERE);
        let (nodes, steps) = (10_242.0, 100.0);
        let mut call = Command::new(&self.opruga);
        call.args(["bench", "scene"]).arg(&scene).args(["--frames", "8", "--json"]).env("OPRUGA_SIMD", simd);
        let row = first_row(&mut call)?;
        if row["nodes"].as_f64() != Some(nodes) || row["substeps"].as_f64() != Some(steps) {
            return Err(format!("{} is another scene: {row}", scene.display()));
        }
        Ok(number(&row, "milliseconds_per_frame")? * 1e6 / (nodes * steps))
    }

    /// Prints how the equilibrium volume of the sphere depends on its triangles.
    fn balances(&self) -> Result<(), String> {
        let scene = self.root.join(SPHERE);
        let mut ratios = Vec::new();
        for subdivisions in [2, 3, 4, 5] {
            ratios.push(self.balance(&scene, subdivisions)?);
        }
        let least = ratios.iter().copied().fold(f64::INFINITY, f64::min);
        let spread = 100.0 * (ratios.iter().copied().fold(0.0, f64::max) / least - 1.0);
        let list: Vec<String> = ratios.iter().map(|ratio| format!("{ratio:.4}")).collect();
        let what = format!("V/V_rest in balance from 162 to 10242 vertices ({}), varies by %", list.join(", "));
        say(&what, &format!("{spread:.2}"), "< 1.5", 1.5 / spread);
        Ok(())
    }

    /// Times Spot as a balloon in real time.
    fn spot(&self, simd: &str) -> Result<(), String> {
        let scene = self.root.join("benches/scenes/spot.toml");
        let mut call = Command::new(&self.opruga);
        call.args(["bench", "scene"]).arg(&scene).args(["--allow-outside", "--frames", "240", "--json"]);
        let row = first_row(call.env("OPRUGA_SIMD", simd))?;
        let (nodes, time) = (number(&row, "nodes")?, number(&row, "mean_milliseconds")?);
        let pace = 1e3 / 60.0 / time;
        let what = format!(
            "Spot as a balloon of {nodes} vertices, times real time at 60 frames a second ({time:.2} ms a frame)"
        );
        say(&what, &format!("{pace:.1}"), "≥ 10", pace / 10.0);
        Ok(())
    }

    /// Times how long a surface from a scanner takes to become a body.
    fn triangles(&self) -> Result<(), String> {
        let mut call = Command::new(&self.opruga);
        let row = first_row(call.args(["bench", "load", "--json"]))?;
        let (triangles, time) = (number(&row, "triangles")?, number(&row, "wall_seconds")?);
        let plain = number(&row, "plain_read_seconds")?;
        let what = format!("binary STL of {triangles} triangles made a checked body, s (its bytes alone {plain:.2} s)");
        say(&what, &format!("{time:.2}"), "< 2", 2.0 / time);
        Ok(())
    }

    /// The volume of the sphere after drag has brought it to rest, divided by the volume of its polyhedron at the start.
    fn balance(&self, scene: &Path, subdivisions: u32) -> Result<f64, String> {
        let folder = scratch("balance");
        let set = [
            format!("body.balloon.shape.subdivisions={subdivisions}"),
            "world.gravity=[0,0,0]".into(),
            "world.drag=60".into(),
            "time.frame=0.01".into(),
            format!("time.substeps={}", 6 << subdivisions),
        ];
        let mut call = Command::new(&self.opruga);
        call.arg("run").arg(scene).args(["--seconds", "1", "--no-pictures", "--force", "--out"]).arg(&folder);
        for change in &set {
            call.args(["--set", change]);
        }
        output(&mut call)?;
        let table = folder.join("diagnostics.csv");
        let text = std::fs::read_to_string(&table).map_err(|e| format!("{}: {e}", table.display()))?;
        let _ = std::fs::remove_dir_all(&folder);
        let rows: Vec<&str> = text.lines().filter(|line| !line.starts_with('#')).collect();
        let column = rows.first().and_then(|head| head.split(',').position(|name| name.ends_with("volume")));
        let volume = |row: Option<&&str>| row.and_then(|row| row.split(',').nth(column?)?.parse::<f64>().ok());
        let ratio = volume(rows.last()).zip(volume(rows.get(1))).map(|(last, first)| last / first);
        ratio.ok_or_else(|| format!("{} has no volume", table.display()))
    }

    /// The time that the program takes until a body of 100,000 vertices is ready for its first step [s].
    fn start_time(&self) -> Result<f64, String> {
        let folder = scratch("start");
        let mut best = f64::INFINITY;
        for _ in 0..5 {
            let begin = std::time::Instant::now();
            let mut call = Command::new(&self.opruga);
            call.args(["run", "giant-ring", "--seconds", "0", "--no-pictures", "--force", "--out"]).arg(&folder);
            output(&mut call)?;
            best = best.min(begin.elapsed().as_secs_f64());
        }
        let _ = std::fs::remove_dir_all(&folder);
        Ok(best)
    }
}

/// A folder for the output of a run.
fn scratch(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("opruga-{name}-{}", std::process::id()))
}

#[cfg(test)]
mod tests {
    use super::{target, verdict};

    #[test]
    fn verdicts_say_how_much_is_short() {
        assert_eq!(verdict(1.0), "met");
        assert_eq!(verdict(0.93), "7 % short");
        assert_eq!(target(1, 16_384, "avx2", false), Some(5.0));
        assert_eq!(target(1, 36, "sse2", false), None);
    }
}
