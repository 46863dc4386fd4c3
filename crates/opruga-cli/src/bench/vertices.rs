//! `opruga bench vertices`: figure 4 of the thesis, the speed against the number of vertices.

use super::{best, processor_time};
use crate::errors::{CallFault, CallRange};
use crate::failure::Failure;
use opruga::blueprint::{Blueprint, BodyBlueprint, ColliderBlueprint, Mass, Time};
use opruga::core::spec::{Role, Value, Values};
use opruga::io::problem::visible;
use opruga::math::calibration::inverse_roots;
use opruga::math::message::AnyMessage;
use opruga::{Options, Registries, Registry, Simd, World, mesh};
use std::sync::Arc;
use std::time::Instant;

/// One row of the benchmark.
#[derive(Clone, Debug, serde::Serialize)]
pub(crate) struct Row {
    bodies: usize,
    vertices: usize,
    threads: usize,
    simd: &'static str,
    integrator: String,
    /// The median over the repetitions: processor time with one thread, wall-clock time with several.
    nanoseconds_per_vertex_step: f64,
    steps_per_second: f64,
    /// Frames of 16 steps, including drawing if it was requested.
    frames_per_second: f64,
    /// Heap memory of the world.
    heap_bytes_per_vertex: f64,
    /// Time of eight square roots and divisions in the same run, which characterises the machine.
    calibration_nanoseconds: f64,
}

/// Bodies and vertices of each row.
pub(crate) const ROWS: [(usize, usize); 12] = [
    (1, 8),
    (1, 16),
    (1, 36),
    (1, 64),
    (1, 256),
    (1, 1_024),
    (1, 16_384),
    (1, 100_000),
    (1, 1_048_576),
    (100, 36),
    (1_000, 36),
    (27_778, 36),
];

/// The row that `--only` names: `36` is one ring of 36 vertices, `1000x36` is a thousand such rings.
pub(crate) fn row(only: &str) -> Result<(usize, usize), Failure> {
    let (bodies, vertices) = only.split_once(['x', '×']).unwrap_or(("1", only));
    let asked = bodies.trim().parse().ok().zip(vertices.trim().parse().ok());
    asked.filter(|row| ROWS.contains(row)).ok_or_else(|| {
        let name = |(bodies, vertices): &(usize, usize)| match bodies {
            1 => vertices.to_string(),
            _ => format!("{bodies}x{vertices}"),
        };
        let names: Vec<String> = ROWS.iter().map(name).collect();
        Failure::range("--only", visible(only), CallRange::OneOf { names: names.join(", ") })
    })
}

fn values(spec: &'static opruga::core::spec::Spec, fields: &[(&str, Value)]) -> Values {
    let mut values = Values::defaults(spec, 2);
    for (name, value) in fields {
        values.set(spec, name, value.clone(), 2).unwrap_or_else(|e| unreachable!("the benchmark's own scene: {e}"));
    }
    values
}

/// Rings as in the baseline: masses of 1 kg, edges of 0.1 m, k = 1600 N/m, c = 40 N·s/m, a gas that stretches every edge with 160 N at rest, and a
/// floor below. The rings start 60 m above the floor and are in flight while they are measured.
pub(crate) fn rings(
    (bodies, vertices): (usize, usize),
    registry: &Registry<2>,
    integrator: &str,
) -> Result<Blueprint<2>, AnyMessage> {
    let model = |name| registry.model(name).map(|m| m.spec()).ok_or(CallFault::NoModel { name });
    let (springs, gas) = (model("mass_spring")?, model("pressure")?);
    let known = || CallFault::NoIntegrator { name: visible(integrator), known: String::new() };
    let rule = registry.integrator(integrator).map(|i| i.spec()).ok_or_else(known)?;
    let floor = opruga::collide::all(2).into_iter().find(|spec| spec.has_role(Role::HalfSpace));
    let floor = floor.ok_or(CallFault::NoObstacle { name: "half_space" })?;
    let radius = vertices as f64 * 0.1 / (2.0 * std::f64::consts::PI);
    let ring = mesh::Mesh::ring(radius, vertices as u32, [0.0, 0.0], 0.0).map_err(AnyMessage::from)?;
    let models = vec![
        values(springs, &[("stiffness", Value::Number(1600.0)), ("damping", Value::Number(40.0))]),
        values(gas, &[("nRT", Value::Number(160.0 / radius * std::f64::consts::PI * radius * radius))]),
    ];
    let only = BodyBlueprint::new("ring", ring, Mass::Node(1.0), models);
    let body = |number: usize| BodyBlueprint {
        name: format!("ring[{number}]"),
        translation: [number as f64 * 3.0 * radius, radius + 60.0],
        ..only.clone()
    };
    let at_the_floor = [
        ("point", Value::Numbers(vec![0.0, 0.0])),
        ("normal", Value::Numbers(vec![0.0, 1.0])),
        ("restitution", Value::Number(0.1)),
    ];
    let mut scene = Blueprint::new(&format!("{bodies} x {vertices}"), Values::defaults(rule, 2));
    scene.time = Time { seconds: 1.0, frame: 16.0 / 1000.0, substeps: 16 };
    scene.surroundings.gravity = [0.0, -9.8];
    scene.bodies = (0..bodies).map(body).collect();
    scene.colliders = vec![ColliderBlueprint { values: values(floor, &at_the_floor) }];
    Ok(scene)
}

/// Measures one row. `draw` is called once per frame.
pub(crate) fn time(
    (bodies, vertices): (usize, usize),
    registries: &Registries,
    integrator: &str,
    options: &Options,
    seconds: f64,
    mut draw: Option<&mut dyn FnMut(&mut World<2>)>,
) -> Result<Row, AnyMessage> {
    let blueprint = rings((bodies, vertices), &registries.plane, integrator)?;
    let mut world =
        World::with_registry(blueprint, options.clone(), Arc::clone(&registries.plane)).map_err(AnyMessage::from)?;
    let total = bodies * vertices;
    // 200 frames of 16 ms keep the rings in flight; then they start again.
    const FLIGHT: usize = 199;
    let start = world.snapshot();
    let fly = |world: &mut World<2>, frames: usize| -> Result<f64, AnyMessage> {
        let mut elapsed = 0.0;
        let mut left = frames;
        while left > 0 {
            world.restore(&start).map_err(AnyMessage::from)?;
            // The first frame uses memory that has not been accessed yet.
            world.frame().map_err(AnyMessage::from)?;
            let some = left.min(FLIGHT);
            let (wall, processor) = (Instant::now(), processor_time());
            for _ in 0..some {
                world.frame().map_err(AnyMessage::from)?;
            }
            elapsed += if options.threads == 1 { processor_time() - processor } else { wall.elapsed().as_secs_f64() };
            left -= some;
        }
        Ok(elapsed)
    };
    // A warm-up, and the number of frames that fill the time.
    fly(&mut world, 2)?;
    let frames = ((seconds / 5.0 / fly(&mut world, 2)? * 2.0) as usize).clamp(2, 1_000_000);
    let mut repetitions = Vec::new();
    let mut drawn = 0.0;
    for _ in 0..5 {
        repetitions.push(fly(&mut world, frames)? * 1e9 / (frames * 16 * total) as f64);
    }
    if let Some(draw) = draw.as_mut() {
        let start = Instant::now();
        for _ in 0..3 {
            draw(&mut world);
        }
        drawn = start.elapsed().as_secs_f64() / 3.0;
    }
    repetitions.sort_by(f64::total_cmp);
    let nanoseconds = repetitions[repetitions.len() / 2];
    let step = nanoseconds * 1e-9 * total as f64;
    Ok(Row {
        bodies,
        vertices,
        threads: options.threads,
        simd: world.simd().name(),
        integrator: integrator.to_string(),
        nanoseconds_per_vertex_step: nanoseconds,
        steps_per_second: 1.0 / step,
        frames_per_second: 1.0 / (16.0 * step + drawn),
        heap_bytes_per_vertex: world.heap_bytes() as f64 / total as f64,
        calibration_nanoseconds: calibration(world.simd()),
    })
}

/// Time of eight square roots and divisions, which are computed together [ns].
fn calibration(simd: Simd) -> f64 {
    let mut numbers = vec![1.5; 1024];
    let mut packs = 0;
    let seconds = best(20, || packs = inverse_roots(simd, std::hint::black_box(&mut numbers)));
    seconds * 1e9 / packs as f64
}

/// The rows as a table for the terminal.
pub(crate) fn table(rows: &[Row]) -> String {
    use std::fmt::Write as _;
    let mut text = String::from(
        "  bodies  vertices  threads  simd     ns per vertex and step      steps/s     frames/s (16 steps)\n",
    );
    for row in rows {
        let _ = writeln!(
            text,
            "{:>8} {:>9} {:>8}  {:<8} {:>22.3} {:>12.1} {:>12.1}{}",
            row.bodies,
            row.vertices,
            row.threads,
            row.simd,
            row.nanoseconds_per_vertex_step,
            row.steps_per_second,
            row.frames_per_second,
            if row.frames_per_second >= 40.0 { "" } else { "   below the thesis's 40 FPS" },
        );
    }
    text
}

impl Row {
    /// The total number of vertices, and frames per second.
    pub(crate) fn point(&self) -> (f64, f64) {
        ((self.bodies * self.vertices) as f64, self.frames_per_second)
    }
    /// The number of bodies.
    pub(crate) fn bodies(&self) -> usize {
        self.bodies
    }
}

#[cfg(test)]
mod tests {
    use super::row;

    #[test]
    fn only_names_one_row() {
        assert_eq!(row("36").expect("a row"), (1, 36));
        assert_eq!(row("27778x36").expect("a row"), (27_778, 36));
        assert_eq!(row("1000×36").expect("a row"), (1_000, 36));
        for wrong in ["7", "2x36", "x36", "", "36x", "-1", "36,64"] {
            assert!(row(wrong).is_err(), "{wrong}");
        }
    }
}
