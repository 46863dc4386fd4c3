//! `final.csv`, `diagnostics.csv` and `summary.json`.

use opruga_world::Warning;
use serde::Serialize;
use std::io::{self, Write};

/// The state of one body at the end.
#[derive(Clone, Copy, Debug)]
pub struct FinalBody<'a> {
    /// The name of the body.
    pub name: &'a str,
    /// Positions, node by node; z is 0 in the plane [m].
    pub positions: &'a [[f64; 3]],
    /// Velocities, node by node [m/s].
    pub velocities: &'a [[f64; 3]],
}

/// Writes `final.csv` of a world of this dimension: `body,node,x,y[,z],vx,vy[,vz]`, 17 significant digits.
///
/// # Errors
/// The errors of the writer.
pub fn write_final<'a>(
    out: &mut dyn Write,
    dimension: usize,
    bodies: impl Iterator<Item = FinalBody<'a>>,
) -> io::Result<()> {
    write_final_with(out, dimension, &[], bodies.map(|body| (body, Vec::new())))
}

/// Writes `final.csv` with additional columns; for every body, these have one row of numbers per node.
///
/// # Errors
/// The errors of the writer.
pub fn write_final_with<'a>(
    out: &mut dyn Write,
    dimension: usize,
    further: &[&str],
    bodies: impl Iterator<Item = (FinalBody<'a>, Vec<Vec<f64>>)>,
) -> io::Result<()> {
    let axes = &["x", "y", "z"][..dimension];
    let columns = axes.iter().map(|a| (*a).to_string()).chain(axes.iter().map(|a| format!("v{a}")));
    let columns: Vec<String> = columns.chain(further.iter().map(|name| cell(name))).collect();
    writeln!(out, "body,node,{}", columns.join(","))?;
    for (body, rows) in bodies {
        let name = cell(body.name);
        for (node, (x, v)) in body.positions.iter().zip(body.velocities).enumerate() {
            write!(out, "{name},{node}")?;
            let row = rows.get(node).map_or(&[][..], |row| &row[..]);
            let further = (0..further.len()).map(|k| row.get(k).unwrap_or(&f64::NAN));
            for value in x[..dimension].iter().chain(&v[..dimension]).chain(further) {
                write!(out, ",{}", Digits(*value))?;
            }
            writeln!(out)?;
        }
    }
    Ok(())
}

/// A table of numbers: a header and rows with the same number of columns; `diagnostics.csv` is one.
#[derive(Debug)]
pub struct NumberTable {
    columns: Vec<String>,
    rows: Vec<f64>,
}

impl NumberTable {
    /// An empty table.
    pub fn new(columns: Vec<String>) -> NumberTable {
        NumberTable { columns, rows: Vec::new() }
    }
    /// Adds a row. Missing numbers become NaN. Too many numbers are a fault of the caller; the surplus is dropped.
    pub fn push(&mut self, row: &[f64]) {
        debug_assert_eq!(row.len(), self.columns.len(), "a row fits its head");
        self.rows.extend((0..self.columns.len()).map(|k| row.get(k).copied().unwrap_or(f64::NAN)));
    }
    /// The names of the columns.
    pub fn columns(&self) -> &[String] {
        &self.columns
    }
    /// The rows.
    pub fn rows(&self) -> impl Iterator<Item = &[f64]> {
        self.rows.chunks_exact(self.columns.len().max(1))
    }
    /// Writes the table as CSV, 17 significant digits.
    ///
    /// # Errors
    /// The errors of the writer.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "{}", self.columns.iter().map(|c| cell(c)).collect::<Vec<_>>().join(","))?;
        for row in self.rows() {
            let numbers: Vec<String> = row.iter().map(|x| Digits(*x).to_string()).collect();
            writeln!(out, "{}", numbers.join(","))?;
        }
        Ok(())
    }
}

/// A number with 17 significant digits: reading it back gives the same bits.
#[derive(Clone, Copy, Debug)]
pub struct Digits(pub f64);

impl core::fmt::Display for Digits {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{:.16e}", self.0)
    }
}

/// A text as a cell of a table: in quotes if it contains commas, quotes or line ends.
pub fn cell(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_string() }
}

/// The contents of `summary.json` for a run; `schema` is added when it is written.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Summary {
    /// The name of the scene.
    pub scene: String,
    /// 2 or 3.
    pub dimension: usize,
    /// The number of bodies at the end.
    pub bodies: usize,
    /// The number of nodes.
    pub nodes: usize,
    /// The number of edges between nodes, in all bodies.
    pub elements: usize,
    /// The kinds of the models in use.
    pub models: Vec<String>,
    /// The kind of the integrator; if bodies have their own, all kinds, separated by commas.
    pub integrator: String,
    /// The length of a frame [s].
    pub frame: f64,
    /// The substeps of a frame.
    pub substeps: u32,
    /// The length of a substep [s].
    pub h: f64,
    /// The number of substeps, without those before the checkpoint of a resumed run.
    pub steps: u64,
    /// Simulated time of the checkpoint from which the run was resumed [s]; none if it was not resumed.
    pub resumed_at: Option<f64>,
    /// Simulated time at the end [s].
    pub time: f64,
    /// Wall-clock time [s].
    pub wall_seconds: f64,
    /// Wall-clock time per node and substep [ns]; none if there was no step.
    pub nanoseconds_per_node_step: Option<f64>,
    /// The instruction set in use: `scalar`, `avx2`, `avx512` …
    pub simd: String,
    /// The number of threads.
    pub threads: usize,
    /// `everywhere` or `this_cpu_class`.
    pub reproducibility: String,
    /// Energies and works [J].
    pub energy: EnergySummary,
    /// Momentum.
    pub momentum: MomentumSummary,
    /// The hash of positions, then velocities, as 16 hexadecimal digits.
    pub state_hash: String,
    /// Statistics of implicit integrators; omitted if there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub solver: Option<SolverSummary>,
    /// The quality of the cells of bodies; omitted if no body has cells.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub cells: Vec<CellSummary>,
    /// Warnings with their counts.
    pub warnings: Vec<WarningSummary>,
    /// The files that were written.
    pub files: Vec<String>,
}

/// The quality of the cells of a body at rest; bodies with the same mesh have one entry, named after the first.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct CellSummary {
    /// The name of the body.
    pub body: String,
    /// The number of cells.
    pub cells: usize,
    /// The smallest angle [°]: between faces of tetrahedra, between sides of other cells.
    pub smallest_angle: f64,
    /// The largest angle [°].
    pub largest_angle: f64,
    /// The shortest straight edge [m].
    pub shortest_edge: f64,
    /// The longest straight edge [m].
    pub longest_edge: f64,
}

/// Energies at the end, and work and losses since the beginning [J].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the words are the documentation")]
pub struct EnergySummary {
    pub kinetic: f64,
    pub elastic: f64,
    pub gas: f64,
    pub gravity: f64,
    pub work_user: f64,
    pub work_gas: f64,
    pub work_correction: f64,
    pub loss_damping: f64,
    pub loss_friction: f64,
    pub loss_contact: f64,
    pub loss_numerical: f64,
    pub loss_integrator: f64,
    pub closure: f64,
}

/// Statistics of implicit integrators since the beginning.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct SolverSummary {
    /// Number of systems of equations, one per body and step.
    pub systems: u64,
    /// Iterations of Newton's method.
    pub newton_iterations: u64,
    /// Products with the matrix, or factorisations.
    pub linear_iterations: u64,
    /// The largest residual at a node at the end of a step [N].
    pub largest_residual: f64,
    /// Number of steps that were accepted without convergence.
    pub accepted: u64,
    /// Number of steps that were divided into halves.
    pub halved: u64,
    /// Number of steps with `accuracy = "real_time"` that may be less accurate than this setting promises.
    pub cut_off: u64,
    /// The largest residual of the steps counted in `cut_off`, as the displacement [m] that it would cause if only one node could move.
    pub largest_left: f64,
    /// How often a body at rest in a degenerate shape was displaced at random (`[world] unfold = true`).
    pub disturbed: u64,
    /// How often a displacement counted in `disturbed` had no effect.
    #[serde(rename = "odd_rests")]
    pub stayed_degenerate: u64,
}

/// Momentum at the end.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct MomentumSummary {
    /// Σ m v [kg·m/s], one number per axis.
    pub linear: Vec<f64>,
    /// Σ m x × v [kg·m²/s]: one number in 2D, three in 3D.
    pub angular: Vec<f64>,
}

/// A counted warning.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct WarningSummary {
    /// The code: a stable word that programs can rely on.
    pub code: String,
    /// The message, in one sentence.
    pub message: String,
    /// How often the warning occurred.
    pub count: u64,
}

impl From<&Warning> for WarningSummary {
    fn from(warning: &Warning) -> WarningSummary {
        WarningSummary { code: warning.code.clone(), message: warning.message.clone(), count: warning.count }
    }
}

impl Summary {
    /// The object of `summary.json`, with `schema = 1` first. Numbers that are not finite become null.
    pub fn to_json(&self) -> serde_json::Value {
        let mut object = serde_json::Map::new();
        object.insert("schema".into(), 1.into());
        if let Ok(serde_json::Value::Object(fields)) = serde_json::to_value(self) {
            object.extend(fields);
        }
        serde_json::Value::Object(object)
    }
    /// Writes `summary.json`.
    ///
    /// # Errors
    /// The errors of the writer.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        serde_json::to_writer_pretty(&mut *out, &self.to_json())?;
        writeln!(out)
    }
}
