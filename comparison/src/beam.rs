//! A slender beam, clamped at one end and released: 1 × 0.1 × 0.1 m, ρ = 1000 kg/m³, ν = 0.3.

use crate::motion::Run;
use crate::mujoco::Body;
use crate::ours::{EXACT, Held, REAL_TIME};
use crate::table::{Reference, Row, Table};
use crate::{FRAME, Settings, mujoco};

const SCENE: &str = "cantilever-beam";

/// The largest number of frames of a run in which the body should come to rest.
const REST_FRAMES: usize = 3000;

/// The damping of runs that must come to rest [s]. With ten times this damping, runs with the real-time setting keep vibrating by 2e-4 of the
/// displacement.
const DAMPING: f64 = 0.01;

/// The sag at rest for a Young's modulus [m], according to quadratic elements of other programs, converged in space; none for other moduli.
fn at_rest(modulus: f64) -> Option<f64> {
    [(1e8, 0.014686), (1e6, 0.747)].into_iter().find(|known| known.0 == modulus).map(|known| known.1)
}

fn values(cells: [u32; 3], modulus: f64) -> Vec<(&'static str, String)> {
    vec![
        ("body.beam.shape.cells", format!("{cells:?}")),
        ("body.beam.models.fem.youngs_modulus", format!("{modulus:e}")),
    ]
}

/// Runs all programs on the beam. The first oscillation is compared with that of a fine mesh of quadratic tetrahedra. The integrator of this
/// reference is backward Euler with one step per frame, solved to the last digits.
pub fn compare(modulus: f64, settings: &Settings) -> Result<Table, String> {
    let rest = at_rest(modulus).ok_or_else(|| format!("{modulus:e} Pa: known are 1e8 and 1e6"))?;
    let fine = Held::new(SCENE, &values([24, 2, 2], modulus), EXACT, 1)?
        .run(300, |run| run.swing(FRAME).is_some())?
        .swing(FRAME);
    let reference = Reference { rest, swing: fine, frame: FRAME };
    let mut rows = Vec::new();
    if let Some(python) = &settings.mujoco {
        for cells in [5, 10] {
            let body = Body::Quadratic { size: [1.0, 0.1, 0.1], cells: [cells, 1, 1], density: 1000.0 };
            let answer = mujoco::run(python, &body, [modulus, 0.3], FRAME, [settings.frames, REST_FRAMES])?;
            let name = format!("MuJoCo {}, {cells} quadratic hexahedra", answer.version);
            rows.push(Row::new(&name, answer.nodes, &answer.swinging, answer.resting, &reference));
        }
    }
    let meshes = [[8, 1, 1], [12, 1, 1], [16, 1, 1], [24, 1, 1], [16, 2, 2]];
    let mut swinging: Vec<Run> = vec![Run::default(); meshes.len()];
    for _ in 0..settings.repeats {
        for (run, cells) in swinging.iter_mut().zip(meshes) {
            let again = Held::new(SCENE, &values(cells, modulus), REAL_TIME, 1)?.run(settings.frames, |_| false)?;
            run.milliseconds.extend(&again.milliseconds);
            run.heights = again.heights;
        }
    }
    for (run, cells) in swinging.iter().zip(meshes) {
        let mut damped = values(cells, modulus);
        damped.push(("body.beam.models.fem.damping", format!("{DAMPING:?}")));
        let mut world = Held::new(SCENE, &damped, REAL_TIME, 1)?;
        let slow = world.run(REST_FRAMES, Run::is_still)?;
        let resting = slow.at_rest();
        let [along, across, _] = cells;
        let name = format!("Opruga, {along} × {across} × {across} cells of 6 quadratic tetrahedra");
        rows.push(Row::new(&name, world.nodes(), run, resting, &reference));
    }
    let title = format!("A beam, E = {modulus:e} Pa; at rest its end hangs {rest} m down, converged in space");
    Ok(Table { title, base: 0, rows })
}
