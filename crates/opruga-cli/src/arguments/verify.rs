//! The arguments of `opruga verify`.

use clap::Args;
use std::path::PathBuf;

#[derive(Args, Debug)]
pub(crate) struct Verify {
    /// Run only cases whose name contains WORD, or whose family is WORD (statics, materials, pressure, dynamics, integrators, ledgers); may be given
    /// several times
    #[arg(long, value_name = "WORD")]
    pub(crate) filter: Vec<String>,
    /// List the cases with their sources, but run none
    #[arg(long)]
    pub(crate) list: bool,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Write a report with a plot of every case to this folder: report.html, report.md
    #[arg(long, value_name = "FOLDER", conflicts_with = "list")]
    pub(crate) report: Option<PathBuf>,
    /// Replace an existing report
    #[arg(long, requires = "report")]
    pub(crate) force: bool,
    /// Multiply the shear modulus of every solid and the stiffness of every spring and hinge by FACTOR, 0.5 to 2, to see which cases detect this
    /// change
    #[arg(long, value_name = "FACTOR", allow_negative_numbers = true, default_value_t = 1.0, conflicts_with = "list")]
    pub(crate) stiffer: f64,
    /// Number of threads, 1 to 256; results do not depend on it [default: one per core]
    #[arg(long, allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(1..=256))]
    pub(crate) threads: Option<u16>,
}
