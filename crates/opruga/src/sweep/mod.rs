//! Sweeps: one scene run with many values of its parameters, and the quantities measured in every run.
//!
//! ```
//! use opruga::sweep::{Axis, Design, Metric, Status, Sweep};
//! use std::sync::atomic::AtomicBool;
//!
//! fn main() -> Result<(), Box<dyn std::error::Error>> {
//!     let sweep = Sweep {
//!         name: "ball".into(),
//!         file: "ball.toml".into(),
//!         text: opruga::scenes::find("ball").ok_or("there is no such scene")?.into(),
//!         files: opruga::io::Files::default(),
//!         fixed: vec![("time.seconds".into(), "2".into())],
//!         axes: Axis::parse("collider.0.restitution=0,0.6")?.into_iter().collect(),
//!         design: Design::Grid,
//!         metrics: vec![Metric::parse("bounce_height.ball")?],
//!         allow_unstable: false,
//!         lenient: false,
//!         registries: opruga::Registries::default(),
//!     };
//!     let points = sweep.points().map_err(|errors| errors[0].to_string())?;
//!     for (number, point) in points.iter().enumerate() {
//!         let row = sweep.measure(number, point, None, &|| 0.0, &AtomicBool::new(false)).ok_or("stopped")?;
//!         assert_eq!(row.status, Status::Done);
//!         println!("restitution {:?}: the ball rises by {:?} m", point[0], row.numbers[0]);
//!     }
//!     Ok(())
//! }
//! ```

#![allow(clippy::result_large_err, reason = "errors are rare, and say much")]

#[doc(hidden)]
pub mod errors;
mod grid;
mod metrics;
mod plots;
mod programs;
mod question;
mod table;

pub use grid::{Axis, Design, MOST_POINTS, Point, Range, Values, number};
pub use metrics::{Metric, WORDS};
pub use plots::plots;
pub use question::Question;
pub use table::{Row, Status, head, line, read_rows};

use crate::{Options, Simd, WorldError};
use errors::SweepError;
use metrics::Meter;
use opruga_io::{Files, SceneError, scene};
use opruga_math::message::Message;
use opruga_world::blueprint::AnyBlueprint;
use opruga_world::{AnyScene, AnyWorld, Registries};
use std::sync::atomic::{AtomicBool, Ordering};

/// The total processor time [s] of the runs that measure a speed; after this time, the speed is known precisely enough.
const TIMED: f64 = 0.1;

/// The question of a sweep. The same question always has the same answer, except for times.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// The name of the scene.
    pub name: String,
    /// The origin of the scene, for errors.
    pub file: String,
    /// The text of the scene.
    pub text: String,
    /// The location of the files that the scene names.
    pub files: Files,
    /// Parameters that are changed for all points, each with a path and a value.
    pub fixed: Vec<(String, String)>,
    /// The parameters that vary.
    pub axes: Vec<Axis>,
    /// The design of the points.
    pub design: Design,
    /// The quantities that are measured.
    pub metrics: Vec<Metric>,
    /// Whether steps above the stable limit are allowed.
    pub allow_unstable: bool,
    /// Whether unknown fields are ignored.
    pub lenient: bool,
    /// The models and integrators that the scene can name.
    pub registries: Registries,
}

impl Sweep {
    /// Checks the question and returns the points. The scene must be readable, and must have every parameter that varies and every quantity that is
    /// measured.
    ///
    /// If the scene refuses a point only because of a value, this is not an error here; the row of the point reports it.
    ///
    /// # Errors
    /// The errors of the scene, of [`Axis`] and of [`Metric`].
    pub fn points(&self) -> Result<Vec<Point>, Vec<SceneError>> {
        let mut errors = Vec::new();
        if self.metrics.is_empty() {
            let words: Vec<&str> = WORDS.iter().map(|w| w.0).collect();
            errors.push(SceneError::of(SweepError::NothingMeasured { words: words.join(", ") }));
        }
        for (index, metric) in self.metrics.iter().enumerate() {
            if self.metrics[..index].contains(metric) {
                errors.push(SceneError::of(SweepError::MetricTwice { metric: metric.name.clone() }));
            }
        }
        let points = grid::points(&self.axes, self.design).map_err(|e| errors.push(e)).unwrap_or_default();
        match self.read(&vec![None; self.axes.len()]) {
            Err(mut of_scene) => errors.append(&mut of_scene),
            Ok(blueprint) => self.check(blueprint.scene(), &points, &mut errors),
        }
        if errors.is_empty() { Ok(points) } else { Err(errors) }
    }

    fn check(&self, scene: &dyn AnyScene, points: &[Point], errors: &mut Vec<SceneError>) {
        errors.extend(self.metrics.iter().filter_map(|metric| metric.check(scene).err()));
        for index in 0..self.axes.len() {
            // Checks the first value of each parameter separately: a path that names nothing is wrong for all values.
            let Some(value) = points.iter().find_map(|point| point[index].clone()) else { continue };
            let mut point = vec![None; self.axes.len()];
            point[index] = Some(value);
            let found = self.read(&point).err().unwrap_or_default();
            errors.extend(found.into_iter().find(|e| e.code.starts_with("set.") || e.code.contains("unknown")));
        }
    }

    fn read(&self, point: &[Option<String>]) -> Result<AnyBlueprint, Vec<SceneError>> {
        let varied = self.axes.iter().zip(point);
        let overrides = self.fixed.iter().cloned();
        let overrides = overrides.chain(varied.filter_map(|(axis, value)| Some((axis.path.clone(), value.clone()?))));
        let options = scene::Options {
            lenient: self.lenient,
            overrides: overrides.collect(),
            files: self.files.clone(),
            ..scene::Options::default()
        };
        scene::read(self.text.as_bytes(), &self.file, &crate::catalogue_of(&self.registries), &options)
            .map(|(blueprint, _)| blueprint)
    }

    /// Runs one point on the calling thread and measures it; none if `stop` was set in the meantime.
    ///
    /// `clock` returns the processor time of this thread [s]. This clock is used only for speeds.
    pub fn measure(
        &self,
        number: usize,
        point: &[Option<String>],
        simd: Option<Simd>,
        clock: &dyn Fn() -> f64,
        stop: &AtomicBool,
    ) -> Option<Row> {
        let most_bytes = Some(scene::Limits::default().memory_bytes);
        let options =
            Options { threads: 1, simd, allow_unstable: self.allow_unstable, most_bytes, ..Options::default() };
        let run = Run { sweep: self, options, clock, stop };
        let outcome = match self.read(point) {
            Ok(blueprint) => run.measure(&blueprint),
            Err(errors) => {
                let first = errors.into_iter().next();
                Err(first.map_or_else(|| Failed::of("scene", ""), Failed::from))
            }
        };
        let nothing = || vec![None; self.metrics.len()];
        let (status, message, numbers) = match outcome {
            Ok(numbers) => (Status::Done, String::new(), numbers),
            Err(Failed::Stopped) => return None,
            Err(Failed::Refused(code, message)) => (Status::Failed(code), message, nothing()),
        };
        Some(Row { number, values: point.to_vec(), status, message, numbers })
    }
}

/// The reason why a point has no numbers.
enum Failed {
    Stopped,
    Refused(String, String),
}

impl Failed {
    fn of(code: &str, message: &str) -> Failed {
        Failed::Refused(code.into(), message.into())
    }
}

/// Joins the message, the allowed values and the hint in one line, as errors of worlds do.
impl From<SceneError> for Failed {
    fn from(error: SceneError) -> Failed {
        let mut message = error.message;
        for (word, what) in [("allowed", error.allowed), ("hint", error.hint)] {
            message.extend(what.map(|what| format!("; {word}: {what}")));
        }
        Failed::of(error.code, &message)
    }
}

impl From<WorldError> for Failed {
    fn from(error: WorldError) -> Failed {
        Failed::of(error.code(), &error.in_full())
    }
}

struct Run<'a> {
    sweep: &'a Sweep,
    options: Options,
    clock: &'a dyn Fn() -> f64,
    stop: &'a AtomicBool,
}

impl Run<'_> {
    fn measure(&self, blueprint: &AnyBlueprint) -> Result<Vec<Option<f64>>, Failed> {
        let frames = blueprint.scene().time().frames();
        let mut world = blueprint.clone().build_with(self.options.clone(), &self.sweep.registries)?;
        let mut meter = Meter::new(&self.sweep.metrics, world.scene(), frames);
        if meter.looks_within() {
            world.keep_looks(1);
        }
        meter.frame(&mut *world);
        while world.frames() < frames {
            self.frame(&mut *world)?;
            world.look_within(&mut |world| meter.look(world));
            meter.frame(&mut *world);
        }
        let mut numbers = meter.finish();
        if self.sweep.metrics.iter().any(Metric::is_timing) {
            let speed = self.speed(blueprint, frames)?;
            for (metric, number) in self.sweep.metrics.iter().zip(&mut numbers) {
                if metric.is_timing() {
                    *number = speed;
                }
            }
        }
        Ok(numbers)
    }

    fn frame(&self, world: &mut dyn AnyWorld) -> Result<(), Failed> {
        if self.stop.load(Ordering::Relaxed) {
            return Err(Failed::Stopped);
        }
        Ok(world.frame()?)
    }

    /// Returns the processor time [ns] of a substep in the fastest of several runs. Runs are repeated until they have taken a tenth of a second
    /// together. These runs are separate from the other runs and measure nothing else.
    fn speed(&self, blueprint: &AnyBlueprint, frames: u64) -> Result<Option<f64>, Failed> {
        let steps = frames as f64 * f64::from(blueprint.scene().time().substeps);
        let (mut fastest, mut spent) = (f64::INFINITY, 0.0);
        // The number of runs is limited, because the clock might not advance.
        for _ in 0..50 {
            let mut world = blueprint.clone().build_with(self.options.clone(), &self.sweep.registries)?;
            let start = (self.clock)();
            while world.frames() < frames {
                self.frame(&mut *world)?;
            }
            let took = (self.clock)() - start;
            spent += took;
            fastest = if took < fastest { took } else { fastest };
            if spent >= TIMED {
                break;
            }
        }
        Ok((steps > 0.0 && fastest > 0.0).then(|| fastest * 1e9 / steps))
    }
}
