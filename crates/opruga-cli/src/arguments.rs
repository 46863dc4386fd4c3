//! The commands and arguments of the command line.

mod bench;
mod material;
mod verify;

use crate::recorder::Wanted;
pub(crate) use bench::{Bench, BenchElements, BenchLoad, BenchRecord, BenchScene, BenchVertices};
use clap::{Args, Parser, Subcommand};
pub(crate) use material::Material;
use std::path::PathBuf;
pub(crate) use verify::Verify;

/// Elastically deformable bodies: run a scene, look at the result, measure it.
#[derive(Debug, Parser)]
#[command(
    name = "opruga",
    version,
    max_term_width = 110,
    after_help = "Without a command, `opruga` opens the studio if there is a screen; otherwise it runs the scene \
`ball`.\n\nOPRUGA_SIMD=scalar|sse2|avx2|avx512 in the environment selects the vector instructions of the kernels; by default, the kernels use the \
best ones that the processor has. The results are the same, bit for bit. `scalar` selects the instructions that every processor of an architecture \
has: `sse2` on x86-64."
)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
    /// The language of errors and warnings; JSON is always in English
    #[arg(long, global = true, value_enum, default_value_t)]
    pub(crate) language: crate::language::Language,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Run a scene and write tables, pictures, a video and plots
    Run(Run),
    /// Open a scene in the window of Opruga Studio: pull its bodies, draw others, change their physics
    Studio {
        /// A scene file, or the name of a scene that comes with the program [default: ball]
        scene: Option<String>,
    },
    /// Show a recorded run in the window of Opruga Studio: jump to any moment and continue from there
    View {
        /// The recording, as `opruga run --record` writes it
        recording: std::path::PathBuf,
    },
    /// Read a scene and report all of its errors, without running it
    Check(Check),
    /// Run a scene with many values of its parameters and compare the results
    Sweep(Sweep),
    /// Draw the pictures of a recorded run again, export its frames, or recompute the run and compare
    Replay(Replay),
    /// Find the natural frequencies of a body and draw its mode shapes
    Modes(Modes),
    /// List models, integrators, shapes, colliders and the scenes that come with the program
    List {
        /// Print JSON
        #[arg(long)]
        json: bool,
    },
    /// Write a commented scene NAME.toml to start from
    New {
        /// The name of the scene, with or without .toml
        name: String,
        /// Replace an existing file
        #[arg(long)]
        force: bool,
        /// Print an error as JSON
        #[arg(long)]
        json: bool,
    },
    /// Print the reference of the scene format (Markdown), generated from the descriptions in the code
    Reference {
        /// Print the JSON Schema for editors instead
        #[arg(long)]
        schema: bool,
    },
    /// Fill a surface or an outline with cells, look at a mesh, or write it in another format
    Mesh(Mesh),
    /// Print energy density, stress and tangent of a finite-element material at a deformation gradient
    Material(Material),
    /// Compare the engine with closed forms and published numbers; exit code 1 if a case fails
    Verify(Verify),
    /// Measure speed
    Bench {
        #[command(subcommand)]
        what: Bench,
    },
}

#[derive(Args, Debug)]
pub(crate) struct Mesh {
    /// A surface (.obj, .stl, .ply, .gltf, .glb), a drawing (.svg, .png), a map (.json, .geojson, .topojson), a font (.ttf, .otf), or a mesh (.msh,
    /// .vtk, .vtu, .mesh, .mfem, .node, .ele)
    pub(crate) input: PathBuf,
    /// The mesh file to write: .msh, .vtk, .vtu, .mesh, .mfem, .node; its picture is written next to it, with `.png` appended to the name
    #[arg(short, long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// Approximate length of the edges of cells [m]; required for surfaces and drawings
    ///
    /// In space, H is the side of the cubes of a lattice. The points of the lattice near the surface are moved onto it, so edges are 0.9 H long on
    /// average. Parts thinner than H may be lost; a message then reports the loss.
    #[arg(long, value_name = "H", allow_negative_numbers = true)]
    pub(crate) size: Option<f64>,
    /// The length of the longest side of the whole body [m]; it replaces the units of the file, and drawings require it
    #[arg(long, value_name = "L", allow_negative_numbers = true)]
    pub(crate) scale_to: Option<f64>,
    /// Set a field of the shape, as in a scene, such as layer=countries, feature=Italy, path=wing, text=opruga; may be given several times
    #[arg(long = "set", value_name = "FIELD=VALUE")]
    pub(crate) set: Vec<String>,
    /// The order of the cells: 1 has nodes at the corners only; 2 also has one in the middle of every edge
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=2))]
    pub(crate) order: u32,
    /// Repair the mesh: flip inverted cells, drop nodes that no cell uses, merge vertices at the same position; report how many repairs of each sort
    /// were made
    #[arg(long)]
    pub(crate) mend: bool,
    /// The file for the picture [default: next to the mesh]
    #[arg(long, value_name = "FILE")]
    pub(crate) picture: Option<PathBuf>,
    /// Replace existing files
    #[arg(long)]
    pub(crate) force: bool,
    /// Treat warnings as errors and write nothing
    #[arg(long)]
    pub(crate) strict: bool,
    /// Print the result, or an error, as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Debug)]
pub(crate) struct Check {
    /// A scene file, or the name of a scene that comes with the program
    pub(crate) scene: String,
    /// Override a parameter, such as time.substeps=64; may be given several times
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub(crate) set: Vec<String>,
    /// Print the result, or the errors, as JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Treat warnings as errors
    #[arg(long)]
    pub(crate) strict: bool,
    /// Treat unknown fields as warnings
    #[arg(long, conflicts_with = "strict")]
    pub(crate) lenient: bool,
    /// Treat a step above the stable limit as a warning, as `opruga run --allow-unstable` does
    #[arg(long)]
    pub(crate) allow_unstable: bool,
    /// Allow shapes to be read from files outside the folder of the scene
    #[arg(long)]
    pub(crate) allow_outside: bool,
    /// Repeat the check whenever the scene or one of its files changes, until you press Ctrl-C
    #[arg(long)]
    pub(crate) watch: bool,
}

#[derive(Args, Debug)]
pub(crate) struct Sweep {
    /// A scene file, or the name of a scene that comes with the program
    #[arg(conflicts_with = "resume", required_unless_present = "resume")]
    pub(crate) scene: Option<String>,
    /// The values of a parameter; may be given several times
    ///
    /// PATH=a,b,c lists the values. PATH=LOW..HIGH:COUNT gives COUNT values, including both ends. With :log, the ratio of neighbouring values is
    /// constant; with :whole, the values are rounded to whole numbers. PATH=VALUE gives the parameter the same value in all runs. If several
    /// parameters vary, there is one run for every combination of their values, unless --each or --sample is given.
    #[arg(long = "set", value_name = "PATH=VALUES", conflicts_with = "resume")]
    pub(crate) set: Vec<String>,
    /// Vary one parameter at a time; the others keep their values from the scene
    #[arg(long, conflicts_with_all = ["resume", "sample"])]
    pub(crate) each: bool,
    /// Use this many random points instead of a grid; give ranges as LOW..HIGH, without :COUNT
    ///
    /// The points form a Latin hypercube sample: if the range of a parameter is divided into as many equal parts as there are points,
    /// each part contains exactly one point.
    #[arg(long, value_name = "COUNT", conflicts_with = "resume")]
    pub(crate) sample: Option<usize>,
    /// Draw the random points independently of each other, instead of as a Latin hypercube
    #[arg(long, requires = "sample")]
    pub(crate) independent: bool,
    /// The seed of the random points
    #[arg(long, requires = "sample", default_value_t = 1)]
    pub(crate) seed: u64,
    /// What to measure in every run; may be given several times
    ///
    /// METRIC is bounce_height[.BODY], settling_time, equilibrium_radius[.BODY], energy_drift or nanoseconds_per_step. For a column of a probe of the
    /// scene, it is PROBE.COLUMN.min, .max, .mean or .last, such as top.y.max.
    #[arg(long = "metric", value_name = "METRIC", conflicts_with = "resume")]
    pub(crate) metrics: Vec<String>,
    /// The simulated time at which runs end [s] [default: that of the scene]
    #[arg(long, allow_negative_numbers = true, conflicts_with = "resume")]
    pub(crate) seconds: Option<f64>,
    /// The folder for the output [default: out/SCENE-sweep]
    ///
    /// If you repeat the same call for the same folder, an interrupted sweep continues.
    #[arg(long, value_name = "FOLDER", conflicts_with = "resume")]
    pub(crate) out: Option<PathBuf>,
    /// Continue the sweep in this folder; the folder also contains the definition of the sweep
    #[arg(long, value_name = "FOLDER")]
    pub(crate) resume: Option<PathBuf>,
    /// Start from the beginning, whatever the folder contains
    #[arg(long, conflicts_with = "resume")]
    pub(crate) force: bool,
    /// Number of simultaneous runs, 1 to 256 [default: the number of cores]; it affects measured speeds, but no other results
    #[arg(long, allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(1..=256))]
    pub(crate) threads: Option<u16>,
    /// Print the summary, or an error, as JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Run even if the step is above the stable limit
    #[arg(long, conflicts_with = "resume")]
    pub(crate) allow_unstable: bool,
    /// Allow shapes to be read from files outside the folder of the scene
    #[arg(long, conflicts_with = "resume")]
    pub(crate) allow_outside: bool,
    /// Ignore unknown fields of the scene
    #[arg(long, conflicts_with = "resume")]
    pub(crate) lenient: bool,
}

/// The options for the pictures of a run or of a recording.
#[derive(Args, Clone, Debug)]
pub(crate) struct Pictures {
    /// Pictures and exported frames per second of simulated time, at most 240 [default: 20]
    ///
    /// The time between two pictures is a whole number of frames of the scene: frames of 1/60 s allow 60, 30, 20, 15, 12, … pictures per second. The
    /// nearest allowed rate is used.
    #[arg(long, allow_negative_numbers = true)]
    pub(crate) fps: Option<f64>,
    /// Write no strip, video or plots
    #[arg(long)]
    no_pictures: bool,
    /// Write the animation as video.gif instead of video.mp4
    #[arg(long, conflicts_with = "no_pictures")]
    gif: bool,
    /// Draw arrows: the pressure of gas (without gas, the force on nodes) and the pull of the pointer
    #[arg(long, conflicts_with = "no_pictures")]
    arrows: bool,
    /// Draw all springs and nodes, even on surfaces and under skins, and even if there are many
    #[arg(long, conflicts_with = "no_pictures")]
    springs: bool,
}

impl Pictures {
    /// Whether the call gives any of these options.
    fn is_given(&self) -> bool {
        self.fps.is_some() || self.no_pictures || self.gif || self.arrows || self.springs
    }

    /// The output that the call requests. If `notes` is true, a note reports when the pictures have another rate than requested.
    fn wanted(&self, notes: bool) -> Wanted {
        Wanted {
            row_every: None,
            fps: self.fps,
            pictures: !self.no_pictures,
            arrows: self.arrows,
            springs: self.springs,
            gif: self.gif,
            notes,
        }
    }
}

#[derive(Args, Clone, Debug)]
pub(crate) struct Run {
    /// A scene file, or the name of a scene that comes with the program [default: ball]
    #[arg(conflicts_with = "resume")]
    pub(crate) scene: Option<String>,
    /// The simulated time at which the run ends [s] [default: that of the scene]
    ///
    /// A run consists of whole frames. If the last frame ends after this time, a note reports the time at which the frame ends. A resumed run that
    /// continues from t = 5 with --seconds 8 runs for 3 s; without --seconds, it ends where the earlier run was meant to end. --seconds 0 writes the
    /// state at the start.
    #[arg(long, allow_negative_numbers = true)]
    pub(crate) seconds: Option<f64>,
    #[command(flatten)]
    pub(crate) pictures: Pictures,
    /// The folder for the output [default: out/SCENE]
    #[arg(long, value_name = "FOLDER")]
    pub(crate) out: Option<PathBuf>,
    /// Replace existing output
    #[arg(long)]
    pub(crate) force: bool,
    /// Number of threads, 1 to 256; results do not depend on it
    #[arg(long, allow_negative_numbers = true, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=256))]
    pub(crate) threads: u16,
    /// Also write Cauchy's stress, the von Mises stress and J of every node to final.csv
    ///
    /// The value at a node is the mean over the finite elements around it, weighted by their volume at rest. The columns are sxx, syy, szz and sxy,
    /// in 3D also syz and szx, and then von_mises (computed from the mean stress) and volume_ratio. Nodes of bodies without finite elements have NaN.
    #[arg(long)]
    pub(crate) stress: bool,
    /// Override a parameter, such as time.substeps=64; may be given several times
    ///
    /// PATH is the position of the field in the scene file, with dots between the parts: integrator.kind=heun, body.ball.models.pressure.nRT=50,
    /// body.0.mass=2, world.gravity=[0,0]. Entries of lists are named by number, name or kind.
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub(crate) set: Vec<String>,
    /// Print the summary, or an error, as JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Continue from the checkpoint of an earlier run; the results are the same, bit for bit, as without the interruption
    ///
    /// The checkpoint contains the scene with the changes made by --set and --seconds, and the options --lenient and --allow-unstable. Other options
    /// must be given again. The output covers only the rest of the run, so it goes to a folder of its own.
    #[arg(long, value_name = "FILE")]
    pub(crate) resume: Option<PathBuf>,
    /// Real time between two checkpoints during the run [s]; 0 writes a checkpoint only at the end
    ///
    /// A killed run loses at most the work of this interval. `checkpoint` and `diagnostics.csv` reach up to the last checkpoint;
    /// `checkpoint.previous` is the checkpoint before the last one. --resume continues from either of these files.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, default_value_t = 60.0)]
    pub(crate) checkpoint_every: f64,
    /// Record the run to this file; `opruga replay` can later draw its pictures and write its frames as VTU, glTF, PC2, MDD, OBJ or PLY
    ///
    /// The file contains a hash of every frame. It also contains the scene, so it needs no other file. If the run is killed, the file still contains
    /// all frames that were finished. --force replaces an existing file.
    #[arg(long, value_name = "FILE")]
    pub(crate) record: Option<PathBuf>,
    /// Keep one state every FRAMES frames of the recording; 1 keeps all states
    ///
    /// The states in between are computed again on request and checked against their hashes. By default, the interval is chosen so that recording
    /// takes less than a tenth of the time of the run; it is at most 32 frames.
    #[arg(long, value_name = "FRAMES", requires = "record", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) record_every: Option<u32>,
    /// Write a row of diagnostics.csv every FRAMES frames; 1 writes every frame
    ///
    /// The first and the last frame always have a row. By default, every frame has a row if the table then stays below 67 MB. Otherwise, only every
    /// n-th frame has a row, and a warning reports n.
    #[arg(long, value_name = "FRAMES", value_parser = clap::value_parser!(u32).range(1..=1_000_000_000))]
    pub(crate) diagnostics_every: Option<u32>,
    /// Check after every frame that no surfaces cross; a run in which surfaces cross ends with exit code 1
    ///
    /// The check is exact and shares no code with contact detection. It covers the bodies to which `[contact]` applies, or all bodies if that section
    /// is missing.
    #[arg(long)]
    pub(crate) check_contact: bool,
    /// Run even if the step is above the stable limit
    #[arg(long)]
    pub(crate) allow_unstable: bool,
    /// Treat warnings before the run as errors
    #[arg(long)]
    pub(crate) strict: bool,
    /// Treat unknown fields as warnings
    #[arg(long, conflicts_with = "strict")]
    pub(crate) lenient: bool,
    /// Allow shapes to be read from files outside the folder of the scene
    #[arg(long)]
    pub(crate) allow_outside: bool,
    /// Run again whenever the scene or one of its files changes, until you press Ctrl-C; later runs replace the output of earlier ones
    #[arg(long, conflicts_with = "resume")]
    pub(crate) watch: bool,
}

#[derive(Args, Debug)]
pub(crate) struct Modes {
    /// A scene file, or the name of a scene that comes with the program
    pub(crate) scene: String,
    /// How many modes to compute, starting with the lowest: 1 or more, or `all`
    #[arg(short = 'n', long = "count", default_value = "10", allow_negative_numbers = true, value_parser = count_of_modes)]
    pub(crate) count: usize,
    /// The body whose modes are computed [default: the first one]
    #[arg(long, value_name = "NAME")]
    pub(crate) body: Option<String>,
    /// Find the modes about the equilibrium (computed by the integrator `equilibrium`) instead of about the state at the start
    #[arg(long)]
    pub(crate) equilibrium: bool,
    /// Find the modes about the state at this simulated time [s]
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, default_value_t = 0.0)]
    pub(crate) after: f64,
    /// Override a parameter, such as body.ball.mass=2; may be given several times
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub(crate) set: Vec<String>,
    /// The folder for the output [default: out/SCENE-modes]
    #[arg(long, value_name = "FOLDER")]
    pub(crate) out: Option<PathBuf>,
    /// Replace existing output
    #[arg(long)]
    pub(crate) force: bool,
    /// Write no picture of the mode shapes
    #[arg(long)]
    pub(crate) no_pictures: bool,
    /// Print the frequencies, or an error, as JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Allow shapes to be read from files outside the folder of the scene
    #[arg(long)]
    pub(crate) allow_outside: bool,
}

#[derive(Args, Debug)]
pub(crate) struct Replay {
    /// A recording: a file that `opruga run --record` has written
    pub(crate) file: PathBuf,
    /// Recompute every frame and compare its hash, and its whole state where the recording contains one; exit code 1 if a frame differs
    ///
    /// Without an output option, nothing is written. With --out or another output option, the output is written afterwards if all frames agree.
    #[arg(long)]
    pub(crate) verify: bool,
    /// The simulated time at which to begin [s] [default: the first frame]
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    pub(crate) from: Option<f64>,
    /// The simulated time at which to end [s] [default: the last frame]
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    pub(crate) to: Option<f64>,
    #[command(flatten)]
    pub(crate) pictures: Pictures,
    /// The folder for the output [default: out/SCENE-replay]
    #[arg(long, value_name = "FOLDER")]
    pub(crate) out: Option<PathBuf>,
    /// Replace existing output
    #[arg(long)]
    pub(crate) force: bool,
    /// Also write the state at every picture as VTK (frame-000012.vtk …; ParaView opens frames.vtk.series)
    #[arg(long)]
    pub(crate) vtk: bool,
    /// Also write the state at every picture as VTK XML, with displacements, groups and stress (ParaView opens frames.pvd)
    #[arg(long)]
    pub(crate) vtu: bool,
    /// Also write the run as animated glTF (run.glb), with one morph target per picture
    #[arg(long)]
    pub(crate) gltf: bool,
    /// Also write a point cache of every body (NAME.pc2), for use with the mesh that --obj writes
    #[arg(long)]
    pub(crate) pc2: bool,
    /// Also write a point cache of every body (NAME.mdd), for use with the mesh that --obj writes
    #[arg(long)]
    pub(crate) mdd: bool,
    /// Also write the state at every picture as Wavefront OBJ
    #[arg(long)]
    pub(crate) obj: bool,
    /// Also write the state at every picture as Stanford PLY
    #[arg(long)]
    pub(crate) ply: bool,
    /// Number of threads, 1 to 256; results do not depend on it
    #[arg(long, allow_negative_numbers = true, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=256))]
    pub(crate) threads: u16,
    /// Print the result, or an error, as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

impl Replay {
    /// Whether the call requests that files are written.
    pub(crate) fn writes(&self) -> bool {
        let formats = [self.vtk, self.vtu, self.obj, self.ply, self.gltf, self.pc2, self.mdd];
        self.out.is_some() || self.pictures.is_given() || formats.contains(&true)
    }

    /// The output that the call requests.
    pub(crate) fn wanted(&self) -> Wanted {
        self.pictures.wanted(!self.json)
    }
}

impl Run {
    /// The output that the call requests.
    pub(crate) fn wanted(&self) -> Wanted {
        let wanted = self.pictures.wanted(!self.json && !self.pictures.no_pictures);
        Wanted { row_every: self.diagnostics_every, ..wanted }
    }

    /// The arguments with which `opruga` runs a scene if it is called without a command.
    pub(crate) fn default_scene() -> Run {
        match Arguments::parse_from(["opruga", "run"]).command {
            Some(Command::Run(run)) => run,
            _ => unreachable!("the command is `run`"),
        }
    }
}

impl Command {
    /// Whether the call requests errors as JSON.
    pub(crate) fn json(&self) -> bool {
        match self {
            Command::Run(run) => run.json,
            Command::Check(check) => check.json,
            Command::Sweep(sweep) => sweep.json,
            Command::Replay(replay) => replay.json,
            Command::Mesh(mesh) => mesh.json,
            Command::Material(material) => material.json,
            Command::Modes(modes) => modes.json,
            Command::Verify(verify) => verify.json,
            Command::List { json } => *json,
            Command::Bench { what: Bench::Vertices(bench) } => bench.json,
            Command::Bench { what: Bench::Scene(bench) } => bench.json,
            Command::Bench { what: Bench::Elements(bench) } => bench.json,
            Command::Bench { what: Bench::Record(bench) } => bench.json,
            Command::Bench { what: Bench::Load(bench) } => bench.json,
            Command::New { json, .. } => *json,
            Command::Reference { .. } | Command::Studio { .. } | Command::View { .. } => false,
        }
    }
}

/// Reads a number of modes. The word `all` stands for a number larger than the number of modes of any body.
fn count_of_modes(text: &str) -> Result<usize, String> {
    match text {
        "all" => Ok(usize::MAX),
        _ => text
            .parse()
            .ok()
            .filter(|count| *count > 0)
            .ok_or_else(|| "allowed: a whole number from 1, or `all`".into()),
    }
}
