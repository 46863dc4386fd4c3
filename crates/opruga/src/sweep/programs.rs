//! Sweeps from a program: one call makes the usual question, and another call computes all of its rows.

use super::{Axis, Design, Metric, Row, Sweep};
use opruga_io::{Files, SceneError};
use opruga_world::Registries;
use std::sync::atomic::AtomicBool;

impl Sweep {
    /// Makes a sweep over every combination of the values of `axes` (such as `"body.ball.mass=1,2"`). The scene names no files, and uses the models
    /// and integrators of this library unless [`Sweep::registries`] is replaced.
    ///
    /// # Errors
    /// [`SceneError`] about an axis that cannot be read, or about a metric that does not exist.
    pub fn new(name: &str, text: &str, axes: &[&str], metrics: &[&str]) -> Result<Sweep, SceneError> {
        let mut sweep = Sweep {
            name: name.into(),
            file: format!("{name}.toml"),
            text: text.into(),
            files: Files::default(),
            fixed: Vec::new(),
            axes: Vec::new(),
            design: Design::Grid,
            metrics: metrics.iter().map(|metric| Metric::parse(metric)).collect::<Result<_, _>>()?,
            allow_unstable: false,
            lenient: false,
            registries: Registries::default(),
        };
        for argument in axes {
            match Axis::parse(argument)? {
                Some(axis) => sweep.axes.push(axis),
                // A parameter with a single value does not vary. The value applies to all points, as on the command line.
                None => sweep.fixed.push(opruga_io::overrides::split(argument)?),
            }
        }
        Ok(sweep)
    }

    /// Runs all points on the calling thread. Speeds (`nanoseconds_per_step`) are not measured, because they need a clock: see [`Sweep::measure`].
    ///
    /// # Errors
    /// The errors of [`Sweep::points`]. If a point fails, its row reports it.
    pub fn run(&self) -> Result<Vec<Row>, Vec<SceneError>> {
        let never = AtomicBool::new(false);
        let points = self.points()?;
        Ok(points.iter().enumerate().filter_map(|(k, point)| self.measure(k, point, None, &|| 0.0, &never)).collect())
    }
}
