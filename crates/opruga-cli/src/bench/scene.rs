//! `opruga bench scene`: measures how long the frames of a scene take, and how implicit bodies use this time.

use super::timed::{Spent, registries};
use super::{Machine, median, processor_time};
use crate::arguments::BenchScene;
use crate::failure::{Failure, print_data};
use crate::forecast::is_implicit;
use crate::opened::{Opened, open};
use opruga::math::words::counted;
use opruga::{AnyWorld, Registries, WorldError};
use serde_json::json;
use std::sync::Arc;

/// Runs a scene without writing anything and prints how long its frames take.
pub(crate) fn bench(call: &BenchScene, library: &Registries) -> Result<u8, Failure> {
    let Opened { source, reading, options, blueprint, .. } =
        open(&call.scene, library, &call.set, call.allow_outside, call.json)?;
    // Errors in the scene are reported as by `run`. Only implicit integrators get timed models. Explicit integrators call models tile by tile, so
    // reading the clock would take most of the measured time.
    let implicit = is_implicit(&*source.build(blueprint.clone(), &reading, &options)?);
    let spent = Arc::new(Spent::default());
    let models = if implicit { registries(library, &spent) } else { library.clone() };
    let failed = |error: WorldError| source.run_error(&error, 0.0);
    let mut world = blueprint.build_with(options, &models).map_err(failed)?;
    let nodes: usize = world.bodies().into_iter().map(|body| world.node_count(body)).sum();
    let machine = Machine::measure(world.simd());

    let frame = |world: &mut dyn AnyWorld| world.frame().map_err(|error| source.frame_error(&error, world, &reading));
    for _ in 0..call.after {
        frame(&mut *world)?;
    }
    let (before, work) = (spent.milliseconds(), world.solver_work());
    let mut times = Vec::with_capacity(call.frames as usize);
    for _ in 0..call.frames {
        let start = processor_time();
        frame(&mut *world)?;
        times.push((processor_time() - start) * 1e3);
    }
    let frames = f64::from(call.frames);
    let mean = times.iter().sum::<f64>() / frames;
    let least = times.iter().copied().fold(f64::INFINITY, f64::min);
    let after = spent.milliseconds();
    let [forces, matrices] = [0, 1].map(|k| (after[k] - before[k]) / frames);
    let now = world.solver_work();
    let per_frame = |now: u64, before: u64| (now - before) as f64 / frames;
    let iterations = per_frame(now.iterations, work.iterations);
    let products = per_frame(now.linear_iterations, work.linear_iterations);
    let phases = implicit.then(|| {
        json!({
            "forces": forces, "matrices": matrices, "solving_and_contact": mean - forces - matrices,
            "iterations": iterations, "products": products,
        })
    });
    let row = json!({
        "scene": source.name, "nodes": nodes, "frames": call.frames, "substeps": world.scene().time().substeps,
        "integrators": world.integrators(), "simd": world.simd().name(), "threads": 1,
        "milliseconds_per_frame": median(&times), "least_milliseconds": least, "mean_milliseconds": mean,
        "phases": phases, "calibration": machine,
    });
    if call.json {
        print_data(&format!("{}\n", json!({ "rows": [row] })))?;
        return Ok(0);
    }
    let mut text = format!(
        "{}: {}, {} of {} by {}\n  {:.3} ms per frame (median), {least:.3} at least, {mean:.3} on average\n",
        source.name,
        counted(nodes as u64, "node", "nodes"),
        counted(call.frames.into(), "frame", "frames"),
        counted(world.scene().time().substeps.into(), "substep", "substeps"),
        world.integrators().join(", "),
        median(&times),
    );
    if implicit {
        text += &format!(
            "  of that on average {forces:.3} ms forces, {matrices:.3} ms matrices, {:.3} ms solving and contact\n  {iterations:.2} iterations and \
             {products:.1} products with the matrix per frame\n",
            mean - forces - matrices,
        );
    }
    text += &format!("  {}\n", machine.sentence());
    print_data(&text)?;
    Ok(0)
}
