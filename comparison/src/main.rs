//! Compares Opruga with similar engines, on the same bodies in one run (docs/comparison.md).
//!
//! Everything runs on one thread, and its processor time is measured. Errors are given next to times. The displacement at rest is compared with the
//! static solution. The first oscillation (its depth, and the time until the return) is compared with that of backward Euler with the same step,
//! solved to the last digits.

mod beam;
mod cube;
mod discs;
mod falling;
mod motion;
mod mujoco;
mod ours;
mod pile;
mod rapier;
mod solids;
mod table;

use clap::Parser;
use serde_json::Value;

/// Length of a frame, which is the same for all programs [s].
pub const FRAME: f64 = 1.0 / 60.0;

/// Processor time of this thread [s].
pub fn processor_time() -> f64 {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    now.tv_sec as f64 + now.tv_nsec as f64 * 1e-9
}

/// Opruga beside Rapier and MuJoCo: milliseconds per frame of one thread, and errors.
#[derive(Debug, Parser)]
pub struct Settings {
    /// Bodies: `cube`, `beam`, `pile`, `discs`, `solids`
    #[arg(long, value_delimiter = ',', default_value = "cube,beam")]
    bodies: Vec<String>,
    /// Cells along a side of the cube
    #[arg(long, value_delimiter = ',', default_value = "4,10")]
    cells: Vec<usize>,
    /// Cubes of the pile along every axis
    #[arg(long, value_delimiter = ',', default_value = "3")]
    along: Vec<usize>,
    /// Young's moduli of the cube [Pa]
    #[arg(long, value_delimiter = ',', default_value = "1e5,1e6")]
    moduli: Vec<f64>,
    /// Frames that are timed
    #[arg(long, default_value_t = 120)]
    frames: usize,
    /// How often they are timed; the programs take turns
    #[arg(long, default_value_t = 3)]
    repeats: usize,
    /// A Python with the package `mujoco`; without it, MuJoCo is left out
    #[arg(long, value_name = "PYTHON")]
    mujoco: Option<String>,
    /// Leave out what takes long: the exact steps and states of rest of the cubes, the finer steps of the solids
    #[arg(long)]
    times_only: bool,
    /// An object for programs
    #[arg(long)]
    json: bool,
}

fn compare(settings: &Settings, done: &mut dyn FnMut(String, Value)) -> Result<(), String> {
    for body in &settings.bodies {
        match body.as_str() {
            "cube" => {
                for &n in &settings.cells {
                    for &modulus in &settings.moduli {
                        let table = cube::compare(n, modulus, settings)?;
                        done(table.markdown(), table.json());
                    }
                }
            }
            "beam" => {
                for modulus in [1e8, 1e6] {
                    let table = beam::compare(modulus, settings)?;
                    done(table.markdown(), table.json());
                }
            }
            "pile" => {
                for &along in &settings.along {
                    let table = pile::compare(along)?;
                    done(table.markdown(), table.json());
                }
            }
            "discs" => {
                let table = discs::compare()?;
                done(table.markdown(), table.json());
            }
            "solids" => {
                let table = solids::compare(settings.times_only)?;
                done(table.markdown(), table.json());
            }
            other => return Err(format!("there is no body `{other}`; known: cube, beam, pile, discs, solids")),
        }
    }
    Ok(())
}

fn main() {
    let settings = Settings::parse();
    let mut tables = Vec::new();
    let outcome = compare(&settings, &mut |text, table| {
        if settings.json {
            tables.push(table);
        } else {
            print!("{text}");
        }
    });
    if settings.json {
        println!("{}", serde_json::json!({ "rapier": rapier::VERSION, "frame": FRAME, "tables": tables }));
    }
    if let Err(message) = outcome {
        eprintln!("error: {message}");
        std::process::exit(2);
    }
}
