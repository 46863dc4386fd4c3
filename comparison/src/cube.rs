//! A cube of linear tetrahedra, clamped at one side and released.

use crate::motion::{Run, Swing};
use crate::mujoco::Body;
use crate::ours::{DAMPING, EXACT, Held, REAL_TIME, sag_at_rest};
use crate::rapier::Damping;
use crate::table::{Reference, Row, Table};
use crate::{FRAME, Settings, mujoco, rapier};
use rapier3d::prelude::SoftBodySolver;

const SCENE: &str = "cantilever-cube";

/// The largest number of frames of a run in which the body should come to rest.
const REST_FRAMES: usize = 600;

/// The number of timed frames of exact steps. It is small, because exact steps take long and their motion is that of the reference anyway.
const EXACT_FRAMES: usize = 20;

fn values(n: usize, modulus: f64, material: &str) -> Vec<(&'static str, String)> {
    vec![
        ("body.cube.shape.cells", format!("[{n}, {n}, {n}]")),
        ("body.cube.models.fem.youngs_modulus", format!("{modulus:e}")),
        ("body.cube.models.fem.material", format!("\"{material}\"")),
    ]
}

/// The first oscillation by backward Euler, solved to the last digits.
fn exact_swing(values: &[(&str, String)], substeps: u32) -> Result<Option<Swing>, String> {
    let run = Held::new(SCENE, values, EXACT, substeps)?.run(300, |run| run.swing(FRAME).is_some())?;
    Ok(run.swing(FRAME))
}

/// Runs all programs on the cube of n³ cells.
pub fn compare(n: usize, modulus: f64, settings: &Settings) -> Result<Table, String> {
    let corotated = values(n, modulus, "corotated");
    let exact = |values: &[(&str, String)], substeps| -> Result<Option<Swing>, String> {
        if settings.times_only { Ok(None) } else { exact_swing(values, substeps) }
    };
    let of_one = Reference { rest: sag_at_rest(SCENE, &corotated)?, swing: exact(&corotated, 1)?, frame: FRAME };
    let of_four = Reference { swing: exact(&corotated, rapier::SUBSTEPS)?, ..of_one };
    let world = Held::new(SCENE, &corotated, REAL_TIME, 1)?;
    let (shape, nodes) = (world.shape(), world.nodes());
    let solvers = [SoftBodySolver::Fem, SoftBodySolver::Constraints];

    // The programs run in turn, so that other load on the machine affects all of them equally.
    let mut swinging: [Run; 5] = Default::default();
    for _ in 0..settings.repeats {
        for (part, solver) in swinging[..2].iter_mut().zip(solvers) {
            gather(part, rapier::run(&shape, modulus, solver, Damping::None, settings.frames, |_| false));
        }
        for (part, (rule, substeps)) in
            swinging[2..].iter_mut().zip([(REAL_TIME, 1), (REAL_TIME, rapier::SUBSTEPS), (EXACT, 1)])
        {
            let frames = if rule == EXACT { settings.frames.min(EXACT_FRAMES) } else { settings.frames };
            gather(part, Held::new(SCENE, &corotated, rule, substeps)?.run(frames, |_| false)?);
        }
    }
    let mut rows = Vec::new();
    for (k, (name, solver)) in ["Rapier, elements", "Rapier, constraints"].into_iter().zip(solvers).enumerate() {
        let slow = || rapier::run(&shape, modulus, solver, Damping::Full, REST_FRAMES, Run::is_still);
        let resting = if settings.times_only { None } else { slow().at_rest() };
        rows.push(Row::new(&format!("{name}, 4 steps"), nodes, &swinging[k], resting, &of_four));
    }
    if let Some(python) = &settings.mujoco {
        let kirchhoff = values(n, modulus, "st_venant_kirchhoff");
        let reference = Reference { rest: sag_at_rest(SCENE, &kirchhoff)?, swing: exact(&kirchhoff, 1)?, frame: FRAME };
        let body = Body::Tetrahedra(&shape);
        let answer = mujoco::run(python, &body, [modulus, 0.4], FRAME, [settings.frames, REST_FRAMES])?;
        let name = format!("MuJoCo {}, 1 step, St. Venant–Kirchhoff", answer.version);
        rows.push(Row::new(&name, answer.nodes, &answer.swinging, answer.resting, &reference));
    }
    let mut damped = corotated.clone();
    damped.push(("body.cube.models.fem.damping", format!("{DAMPING:?}")));
    let resting = |substeps| -> Result<Option<f64>, String> {
        if settings.times_only {
            return Ok(None);
        }
        let run = Held::new(SCENE, &damped, REAL_TIME, substeps)?.run(REST_FRAMES, Run::is_still)?;
        Ok(run.at_rest())
    };
    swinging[4].heights.clear();
    rows.push(Row::new("Opruga, real time, 1 step", nodes, &swinging[2], resting(1)?, &of_one));
    rows.push(Row::new("Opruga, real time, 4 steps", nodes, &swinging[3], resting(rapier::SUBSTEPS)?, &of_four));
    rows.push(Row::new("Opruga, exact, 1 step (the reference)", nodes, &swinging[4], None, &of_one));
    let title = format!(
        "A cube of {n}³ cells, {} tetrahedra, E = {modulus:e} Pa, ν = 0.4; at rest its free side hangs {:.5} m down",
        5 * n * n * n,
        of_one.rest
    );
    Ok(Table { title, base: 0, rows })
}

/// Adds the times of a repetition. The motion is kept from the first run.
fn gather(to: &mut Run, run: Run) {
    to.milliseconds.extend(&run.milliseconds);
    if to.heights.is_empty() {
        to.heights = run.heights;
    }
}
