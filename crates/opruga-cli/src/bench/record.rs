//! `opruga bench record`: measures the time that recording takes, from runs of the same scene with and without it.

use super::{Machine, median, processor_time_of_all};
use crate::arguments::BenchRecord;
use crate::checkpoints::Calling;
use crate::failure::{Failure, print_data};
use crate::opened::{Opened, open};
use crate::recordings;
use opruga::math::words::counted;
use opruga::recordings::TapeError;
use opruga::{AnyWorld, Registries, WorldError};
use serde_json::json;
use std::path::Path;
use std::time::Instant;

/// Times of one run: processor time of all threads, and wall time [ms].
type Times = [f64; 2];

/// Runs a scene repeatedly, with and without a recording, and prints the difference.
pub(crate) fn bench(call: &BenchRecord, registries: &Registries) -> Result<u8, Failure> {
    let opened = open(&call.scene, registries, &call.set, call.allow_outside, call.json)?;
    let name = format!("opruga-bench-{}.rec", std::process::id());
    let path = call.folder.clone().unwrap_or_else(std::env::temp_dir).join(name);
    let outcome = of_scene(call, &opened, &path);
    let _ = std::fs::remove_file(&path);
    outcome
}

fn of_scene(call: &BenchRecord, opened: &Opened, path: &Path) -> Result<u8, Failure> {
    let Opened { source, reading, options, blueprint, .. } = opened;
    let new = || source.build(blueprint.clone(), reading, options);
    let first = new()?;
    let machine = Machine::measure(first.simd());
    let every = call.every.map_or_else(|| opruga::recordings::states_apart(&*first), u64::from);
    let nodes: usize = first.bodies().into_iter().map(|body| first.node_count(body)).sum();
    drop(first);
    let frames = call.frames.map_or_else(|| blueprint.scene().time().frames().max(1), u64::from);
    let (mut without, mut with, mut around, mut bytes) = (Vec::new(), Vec::new(), Vec::new(), 0);
    for round in 0..2 * call.rounds {
        let mut world = new()?;
        let failed = |error: WorldError, world: &dyn AnyWorld| source.frame_error(&error, world, reading);
        let start = now();
        // Each run of a pair comes first equally often.
        if round % 4 == 0 || round % 4 == 3 {
            for _ in 0..frames {
                world.frame().map_err(|error| failed(error, &*world))?;
            }
            without.push(since(start));
            continue;
        }
        let calling = Calling { overrides: reading.overrides.clone(), ..Calling::default() };
        let mut tape = recordings::begin(path, true, Some(every as u32), source, &calling, &mut *world)?;
        let beginning = since(start);
        for _ in 0..frames {
            tape.step(&mut *world).map_err(|error| match error {
                TapeError::World(error) => failed(error, &*world),
                error => error.into(),
            })?;
        }
        let end = now();
        bytes = tape.finish(&mut *world)?;
        around.push([0, 1].map(|clock| beginning[clock] + since(end)[clock]));
        with.push(since(start));
        // The recording is removed, because replacing it would include the time of a sync.
        let _ = std::fs::remove_file(path);
    }
    let of = |times: &[Times], clock: usize| median(&times.iter().map(|times| times[clock]).collect::<Vec<_>>());
    let added = |clock: usize| {
        let shares: Vec<f64> =
            with.iter().zip(&without).map(|(with, plain)| with[clock] / plain[clock] - 1.0).collect();
        median(&shares)
    };
    let per_frame = |milliseconds: f64| milliseconds / frames as f64;
    let row = json!({
        "scene": source.name, "nodes": nodes, "frames": frames, "rounds": call.rounds, "every": every,
        "bytes": bytes,
        "without": {"processor_milliseconds_per_frame": per_frame(of(&without, 0)), "wall_milliseconds_per_frame": per_frame(of(&without, 1))},
        "with": {"processor_milliseconds_per_frame": per_frame(of(&with, 0)), "wall_milliseconds_per_frame": per_frame(of(&with, 1))},
        "added": {"processor": added(0), "wall": added(1)},
        "begin_and_close": {"processor_milliseconds": of(&around, 0), "wall_milliseconds": of(&around, 1)},
        "calibration": machine,
    });
    if call.json {
        print_data(&format!("{}\n", json!({ "rows": [row] })))?;
        return Ok(0);
    }
    print_data(&format!(
        "{}: {}, {} in each of {}, with and without a recording in turns\n  \
         without {:.4} ms of the processor per frame, with it {:.4}: {:+.1} % (median of the pairs; by the clock {:+.1} %)\n  \
         in that beginning and closing the file, {:.2} ms of the processor and {:.1} ms by the clock for the whole run\n  \
         one state in {} kept, {:.2} MB\n  {}\n",
        source.name,
        counted(nodes as u64, "node", "nodes"),
        counted(frames, "frame", "frames"),
        counted(call.rounds.into(), "pair of runs", "pairs of runs"),
        per_frame(of(&without, 0)),
        per_frame(of(&with, 0)),
        100.0 * added(0),
        100.0 * added(1),
        of(&around, 0),
        of(&around, 1),
        counted(every, "frame", "frames"),
        bytes as f64 * 1e-6,
        machine.sentence(),
    ))?;
    Ok(0)
}

/// The readings of both clocks.
fn now() -> (f64, Instant) {
    (processor_time_of_all(), Instant::now())
}

/// The time elapsed on both clocks.
fn since((processor, wall): (f64, Instant)) -> Times {
    [processor_time_of_all() - processor, wall.elapsed().as_secs_f64()].map(|seconds| seconds * 1e3)
}
