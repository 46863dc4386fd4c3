//! Sweeps that a program asks for: the usual question in one call, and all of its rows in another.

use super::{Axis, Design, Metric, Row, Sweep};
use opruga_io::{Files, SceneError};
use opruga_world::Registries;
use std::sync::atomic::AtomicBool;

impl Sweep {
    /// A sweep over every combination of the values of `axes` (`"body.ball.mass=1,2"`), in a scene that names no files and knows the models and integrators of this
    /// library: [`Sweep::registries`] can be replaced.
    ///
    /// # Errors
    /// [`SceneError`] of an axis that varies nothing or cannot be read, or of a metric that does not exist.
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
                // One value varies nothing: it holds for all points, as on the command line.
                None => sweep.fixed.push(opruga_io::overrides::split(argument)?),
            }
        }
        Ok(sweep)
    }

    /// Runs all points on the calling thread. Speeds (`nanoseconds_per_step`) need a clock: see [`Sweep::measure`].
    ///
    /// # Errors
    /// Those of [`Sweep::points`]. A point that fails is a row that says so.
    pub fn run(&self) -> Result<Vec<Row>, Vec<SceneError>> {
        let never = AtomicBool::new(false);
        let points = self.points()?;
        Ok(points.iter().enumerate().filter_map(|(k, point)| self.measure(k, point, None, &|| 0.0, &never)).collect())
    }
}
