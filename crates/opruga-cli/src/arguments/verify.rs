//! What can be said of the cases with closed forms.

use clap::Args;
use std::path::PathBuf;

#[derive(Args, Debug)]
pub(crate) struct Verify {
    /// Only cases whose name contains this, or those of a family: statics, materials, pressure, dynamics, integrators,
    /// ledgers; may be given several times
    #[arg(long, value_name = "WORD")]
    pub(crate) filter: Vec<String>,
    /// List the cases with their sources, and run none
    #[arg(long)]
    pub(crate) list: bool,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Write a report with a plot of every case to this folder: report.html, report.md
    #[arg(long, value_name = "FOLDER", conflicts_with = "list")]
    pub(crate) report: Option<PathBuf>,
    /// Replace the report that is there
    #[arg(long, requires = "report")]
    pub(crate) force: bool,
    /// Multiply the shear modulus of every solid and the stiffness of every spring and hinge, 0.5 to 2: which cases notice?
    #[arg(long, value_name = "FACTOR", allow_negative_numbers = true, default_value_t = 1.0, conflicts_with = "list")]
    pub(crate) stiffer: f64,
    /// Threads, 1 to 256; the results do not depend on them [default: one for each core]
    #[arg(long, allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(1..=256))]
    pub(crate) threads: Option<u16>,
}
