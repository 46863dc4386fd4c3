//! `opruga bench record`: what recording costs, beside the same run without, in one call.

use super::{Machine, median, processor_time};
use crate::arguments::BenchRecord;
use crate::checkpoints::Calling;
use crate::failure::{Failure, print_data};
use crate::recordings;
use crate::source::{Opened, Source, open};
use opruga::World;
use opruga::blueprint::{AnyBlueprint, Blueprint};
use opruga::math::words::counted;
use serde_json::json;
use std::path::Path;
use std::time::Instant;

/// Times of the frames of one run: of this thread on the processor, and by the clock on the wall [ms].
type Times = [f64; 2];

/// Runs a scene again and again, with and without a recording, and prints what that adds.
pub(crate) fn bench(call: &BenchRecord) -> Result<u8, Failure> {
    let opened = open(&call.scene, &call.set, call.allow_outside, call.json)?;
    let name = format!("opruga-bench-{}.rec", std::process::id());
    let path = call.folder.clone().unwrap_or_else(std::env::temp_dir).join(name);
    let outcome = match opened.blueprint.clone() {
        AnyBlueprint::Plane(blueprint) => of_scene(call, &opened, &blueprint, &path),
        AnyBlueprint::Space(blueprint) => of_scene(call, &opened, &blueprint, &path),
    };
    let _ = std::fs::remove_file(&path);
    outcome
}

fn of_scene<const D: usize>(
    call: &BenchRecord,
    opened: &Opened,
    blueprint: &Blueprint<D>,
    path: &Path,
) -> Result<u8, Failure> {
    let Opened { source, reading, options, .. } = opened;
    let new = || source.build(blueprint.clone(), reading, options);
    let first = new()?;
    let machine = Machine::measure(first.simd());
    let every = call.every.map_or_else(|| opruga::recordings::states_apart(&first), u64::from);
    let nodes: usize = first.bodies().map(|body| first.node_count(body)).sum();
    drop(first);
    let (mut without, mut with, mut closing, mut bytes) = (Vec::new(), Vec::new(), Vec::new(), 0);
    for round in 0..2 * call.rounds {
        let mut world = new()?;
        // One of a pair comes first as often as the other.
        if round % 4 == 0 || round % 4 == 3 {
            without.push(frames(call, source, &mut world, |world| Ok(world.frame()?))?);
            continue;
        }
        let calling = Calling { overrides: reading.overrides.clone(), ..Calling::default() };
        let mut tape = recordings::begin(path, true, Some(every as u32), source, &calling, &mut world)?;
        with.push(frames(call, source, &mut world, |world| tape.step(world))?);
        let start = Instant::now();
        bytes = tape.finish(&mut world)?;
        closing.push(start.elapsed().as_secs_f64() * 1e3);
    }
    let of = |times: &[Times], clock: usize| median(&times.iter().map(|times| times[clock]).collect::<Vec<_>>());
    let added = |clock: usize| {
        let shares: Vec<f64> =
            with.iter().zip(&without).map(|(with, plain)| with[clock] / plain[clock] - 1.0).collect();
        median(&shares)
    };
    let per_frame = |milliseconds: f64| milliseconds / f64::from(call.frames);
    let row = json!({
        "scene": source.name, "nodes": nodes, "frames": call.frames, "rounds": call.rounds, "every": every,
        "bytes": bytes,
        "without": {"processor_milliseconds_per_frame": per_frame(of(&without, 0)), "wall_milliseconds_per_frame": per_frame(of(&without, 1))},
        "with": {"processor_milliseconds_per_frame": per_frame(of(&with, 0)), "wall_milliseconds_per_frame": per_frame(of(&with, 1))},
        "added": {"processor": added(0), "wall": added(1)},
        "closing_milliseconds": median(&closing), "calibration": machine,
    });
    if call.json {
        print_data(&format!("{}\n", json!({ "rows": [row] })))?;
        return Ok(0);
    }
    print_data(&format!(
        "{}: {}, {} in each of {}, with and without a recording in turns\n  \
         without {:.4} ms of the processor per frame, with it {:.4}: {:+.1} % (median of the pairs; by the clock {:+.1} %)\n  \
         one state in {} kept, {:.2} MB; closing the file took {:.1} ms\n  {}\n",
        source.name,
        counted(nodes as u64, "node", "nodes"),
        counted(call.frames.into(), "frame", "frames"),
        counted(call.rounds.into(), "pair of runs", "pairs of runs"),
        per_frame(of(&without, 0)),
        per_frame(of(&with, 0)),
        100.0 * added(0),
        100.0 * added(1),
        counted(every, "frame", "frames"),
        bytes as f64 * 1e-6,
        median(&closing),
        machine.sentence(),
    ))?;
    Ok(0)
}

/// The time of the frames of a run.
fn frames<const D: usize>(
    call: &BenchRecord,
    source: &Source,
    world: &mut World<D>,
    mut frame: impl FnMut(&mut World<D>) -> Result<(), opruga::recordings::TapeError>,
) -> Result<Times, Failure> {
    use opruga::recordings::TapeError;
    let (wall, start) = (Instant::now(), processor_time());
    for _ in 0..call.frames {
        frame(world).map_err(|error| match error {
            TapeError::World(error) => source.run_error(&error, world.time()),
            error => error.into(),
        })?;
    }
    Ok([processor_time() - start, wall.elapsed().as_secs_f64()].map(|seconds| seconds * 1e3))
}
