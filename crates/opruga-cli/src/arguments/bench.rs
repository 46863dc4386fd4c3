//! The arguments of `opruga bench`.

use clap::{Args, Subcommand};
use std::path::PathBuf;

#[derive(Debug, Subcommand)]
pub(crate) enum Bench {
    /// The speed of one ring of 8 to 1,048,576 vertices, and of many rings: figure 4 of the thesis
    Vertices(BenchVertices),
    /// The time per frame of a scene [ms], and where it is spent; no pictures or files are written
    Scene(BenchScene),
    /// The time to compute forces and Hessians of finite elements [ns per element]
    Elements(BenchElements),
    /// The time that `--record` adds to the frames of a scene, measured in alternating runs with and without recording
    Record(BenchRecord),
    /// The time to read a surface of many triangles, compared with the time to read the bytes of its file
    Load(BenchLoad),
}

#[derive(Args, Debug)]
pub(crate) struct BenchRecord {
    /// A scene file, or the name of a scene that comes with the program
    pub(crate) scene: String,
    /// Override a parameter, such as time.substeps=64; may be given several times
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub(crate) set: Vec<String>,
    /// Number of frames per run [default: as many as the scene has]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) frames: Option<u32>,
    /// Number of pairs of runs
    #[arg(long, default_value_t = 6, value_parser = clap::value_parser!(u32).range(1..=1_000))]
    pub(crate) rounds: u32,
    /// Keep one state every FRAMES frames, as `run --record-every` does [default: as `run --record` does]
    #[arg(long, value_name = "FRAMES", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) every: Option<u32>,
    /// The folder for the recording, which is removed afterwards [default: the system's folder for temporary files]
    #[arg(long, value_name = "FOLDER")]
    pub(crate) folder: Option<PathBuf>,
    /// Allow shapes to be read from files outside the folder of the scene
    #[arg(long)]
    pub(crate) allow_outside: bool,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Debug)]
pub(crate) struct BenchLoad {
    /// A surface in STL, OBJ, PLY or glTF [default: a torus of --triangles in binary STL]
    pub(crate) file: Option<PathBuf>,
    /// Approximate number of triangles of the torus
    #[arg(long, default_value_t = 1_000_000, conflicts_with = "file", value_parser = clap::value_parser!(u32).range(100..=10_000_000))]
    pub(crate) triangles: u32,
    /// Number of times that the file is read
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=100))]
    pub(crate) rounds: u32,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Debug)]
pub(crate) struct BenchScene {
    /// A scene file, or the name of a scene that comes with the program
    pub(crate) scene: String,
    /// Override a parameter, such as time.substeps=64; may be given several times
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub(crate) set: Vec<String>,
    /// Number of frames that are timed
    #[arg(long, default_value_t = 120, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) frames: u32,
    /// Number of frames before the timed ones
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=1_000_000))]
    pub(crate) after: u32,
    /// Allow shapes to be read from files outside the folder of the scene
    #[arg(long)]
    pub(crate) allow_outside: bool,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Debug)]
pub(crate) struct BenchElements {
    /// Measure only this material of `fem`
    #[arg(long)]
    pub(crate) material: Option<String>,
    /// Number of hexahedra along each side of the measured cube; each hexahedron is cut into six tetrahedra
    #[arg(long, default_value_t = 24, value_parser = clap::value_parser!(u32).range(2..=100))]
    pub(crate) cells: u32,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Debug)]
pub(crate) struct BenchVertices {
    /// Number of threads, 1 to 256; results do not depend on it
    #[arg(long, allow_negative_numbers = true, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=256))]
    pub(crate) threads: u16,
    /// Include the time to draw every frame
    #[arg(long)]
    pub(crate) draw: bool,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// The integrator, one of those that `opruga list` shows
    #[arg(long, default_value = "symplectic_euler")]
    pub(crate) integrator: String,
    /// Measure only one row: `36` for one ring of 36 vertices, `27778x36` for 27,778 such rings
    #[arg(long, value_name = "[RINGSx]VERTICES")]
    pub(crate) only: Option<String>,
    /// Processor time spent on each row [s]: more than 0, at most 600
    #[arg(long, allow_negative_numbers = true, default_value_t = 1.0)]
    pub(crate) seconds: f64,
    /// Write the log–log plot to this SVG file, replacing an existing one
    #[arg(long, value_name = "FILE")]
    pub(crate) plot: Option<PathBuf>,
}
