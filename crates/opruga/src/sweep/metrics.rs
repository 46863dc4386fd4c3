//! The quantities that a sweep measures in every run.

use super::errors::{SweepAllowed, SweepError};
use opruga_core::spec::{Role, nearest};
use opruga_io::SceneError;
use opruga_io::problem::visible;
use opruga_world::blueprint::Recorded;
use opruga_world::{AnyScene, AnyWorld};

/// The words for quantities that can be measured, and their meanings.
pub const WORDS: [(&str, &str); 5] = [
    ("bounce_height", "the largest rise of the lowest node of a body above the lowest position that it has had"),
    ("settling_time", "the time after which the kinetic energy stays below a hundredth of its largest value"),
    (
        "equilibrium_radius",
        "the mean distance of the nodes of a body from their centre, over the last tenth of the run",
    ),
    ("energy_drift", "the energy that the ledger cannot explain, relative to the largest energy in motion"),
    ("nanoseconds_per_step", "processor time of a substep of the whole world"),
];

/// A run counts as settled once the kinetic energy stays below this fraction of its largest value.
const SETTLED: f64 = 0.01;

/// A number that is measured in every run.
#[derive(Clone, Debug, PartialEq)]
pub struct Metric {
    /// The name of the metric, as requested and as in the table.
    pub name: String,
    quantity: Quantity,
}

#[derive(Clone, Debug, PartialEq)]
enum Quantity {
    /// The height to which a body bounces, for the named body or, without a name, for the first body.
    BounceHeight(Option<String>),
    SettlingTime,
    EquilibriumRadius(Option<String>),
    EnergyDrift,
    NanosecondsPerStep,
    /// A statistic of a column of a probe over all frames.
    Probe(String, Statistic),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Statistic {
    Least,
    Largest,
    Mean,
    Last,
}

impl Metric {
    /// Reads a word of [`WORDS`], followed by `.BODY` if it refers to a body, or `PROBE.COLUMN.min`, `.max`, `.mean` or `.last` for a column of a
    /// probe, such as `top.y.max`.
    ///
    /// # Errors
    /// `sweep.metric` if the metric does not exist.
    pub fn parse(text: &str) -> Result<Metric, SceneError> {
        let (word, body) = match text.split_once('.') {
            Some((word, body)) if !body.is_empty() => (word, Some(body.to_string())),
            _ => (text, None),
        };
        let quantity = match (word, &body) {
            ("bounce_height", _) => Quantity::BounceHeight(body),
            ("equilibrium_radius", _) => Quantity::EquilibriumRadius(body),
            ("settling_time", None) => Quantity::SettlingTime,
            ("energy_drift", None) => Quantity::EnergyDrift,
            ("nanoseconds_per_step", None) => Quantity::NanosecondsPerStep,
            _ => {
                let (column, statistic) = match text.rsplit_once('.') {
                    Some((column, "min")) => (column, Statistic::Least),
                    Some((column, "max")) => (column, Statistic::Largest),
                    Some((column, "mean")) => (column, Statistic::Mean),
                    Some((column, "last")) => (column, Statistic::Last),
                    _ => return Err(unknown(text)),
                };
                Quantity::Probe(column.to_string(), statistic)
            }
        };
        Ok(Metric { name: text.to_string(), quantity })
    }

    /// Checks that a scene has the measured quantity.
    ///
    /// # Errors
    /// `sweep.metric` if the body or the column of the probe does not exist.
    pub fn check(&self, scene: &dyn AnyScene) -> Result<(), SceneError> {
        let metric = || visible(&self.name);
        let missing = |about: SweepError, name: &str, known: Vec<String>| {
            let error = SceneError::of(about).nearest(nearest(name, known.iter().map(String::as_str)));
            Err(match known.is_empty() {
                true => error.allows(SweepAllowed::SceneHasNone),
                false => error.allowed(visible(&known.join(", "))),
            })
        };
        let no_body = |name: &str| SweepError::NoBodyToMeasure { body: visible(name), metric: metric() };
        match &self.quantity {
            Quantity::BounceHeight(body) | Quantity::EquilibriumRadius(body) => {
                let names: Vec<String> = scene.bodies().map(|body| body.name().to_string()).collect();
                match body {
                    Some(name) if !names.contains(name) => return missing(no_body(name), name, names),
                    None if names.is_empty() => return missing(no_body(""), "", names),
                    _ => {}
                }
                if matches!(self.quantity, Quantity::BounceHeight(_)) && upwards(scene).is_none() {
                    return Err(SceneError::of(SweepError::NoUp { metric: metric() }));
                }
                Ok(())
            }
            Quantity::Probe(column, _) => {
                let columns = scene.probe_columns().concat();
                if columns.contains(column) {
                    return Ok(());
                }
                missing(SweepError::NoColumn { column: visible(column), metric: metric() }, column, columns)
            }
            _ => Ok(()),
        }
    }

    /// The unit, given the name of the unit of length in a scene.
    pub fn unit(&self, length: &str) -> String {
        match &self.quantity {
            Quantity::BounceHeight(_) | Quantity::EquilibriumRadius(_) => length.to_string(),
            Quantity::SettlingTime => "s".into(),
            Quantity::EnergyDrift => String::new(),
            Quantity::NanosecondsPerStep => "ns".into(),
            Quantity::Probe(column, _) => {
                let word = column.rsplit('.').next().unwrap_or_default();
                // One of the two dimensions has a column with this word.
                let mut all = Recorded::ALL.map(|(_, what)| what).into_iter();
                let what = all.find(|what| [2, 3].iter().any(|d| what.columns(*d).contains(&word)));
                match (what, length) {
                    (Some(Recorded::Position), _) => length.to_string(),
                    (Some(Recorded::Velocity), _) => format!("{length}/s"),
                    (Some(Recorded::VolumeRatio), _) => String::new(),
                    (Some(Recorded::Stress), "m") => "Pa".into(),
                    (Some(Recorded::Stress), _) => format!("kg/({length} s²)"),
                    (_, "m") => "N".into(),
                    _ => format!("kg {length}/s²"),
                }
            }
        }
    }

    /// Whether the metric is a wall-clock or processor time, which differs from run to run.
    pub fn is_timing(&self) -> bool {
        self.quantity == Quantity::NanosecondsPerStep
    }
}

fn unknown(text: &str) -> SceneError {
    let words: Vec<&str> = WORDS.iter().map(|w| w.0).collect();
    SceneError::of(SweepError::NoMetric { metric: visible(text), words: words.join(", ") })
        .nearest(nearest(text.split('.').next().unwrap_or(text), words.iter().copied()))
}

/// The upward direction: against gravity; without gravity, out of the first half-space.
fn upwards(scene: &dyn AnyScene) -> Option<[f64; 3]> {
    let unit = |vector: [f64; 3]| {
        let length = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
        (length > 0.0).then(|| vector.map(|x| x / length))
    };
    let gravity = scene.gravity();
    unit(core::array::from_fn(|d| gravity.get(d).map_or(0.0, |g| -g))).or_else(|| {
        let floor = scene.colliders().iter().find(|c| c.values.spec().has_role(Role::HalfSpace))?;
        unit(floor.values.vector("normal"))
    })
}

/// Measures a run while it proceeds.
pub(crate) struct Meter {
    gauges: Vec<Gauge>,
    /// The number of frames of the whole run.
    frames: u64,
}

enum Gauge {
    Bounce {
        body: Option<String>,
        up: [f64; 3],
        lowest: f64,
        rise: f64,
    },
    Settling {
        kinetic: Vec<[f64; 2]>,
    },
    Radius {
        body: Option<String>,
        sum: f64,
        count: f64,
    },
    Drift {
        drift: f64,
    },
    /// The time of a step, which is not measured here but by separate runs with a clock.
    Speed,
    Probe {
        number: usize,
        column_index: usize,
        statistic: Statistic,
        least: f64,
        largest: f64,
        sum: f64,
        count: f64,
        last: f64,
    },
}

impl Meter {
    pub(crate) fn new(metrics: &[Metric], scene: &dyn AnyScene, frames: u64) -> Meter {
        let probes = scene.probe_columns();
        let gauges = metrics
            .iter()
            .map(|metric| match &metric.quantity {
                Quantity::BounceHeight(body) => Gauge::Bounce {
                    body: body.clone(),
                    up: upwards(scene).unwrap_or([0.0; 3]),
                    lowest: f64::INFINITY,
                    rise: 0.0,
                },
                Quantity::SettlingTime => Gauge::Settling { kinetic: Vec::new() },
                Quantity::EquilibriumRadius(body) => Gauge::Radius { body: body.clone(), sum: 0.0, count: 0.0 },
                Quantity::EnergyDrift => Gauge::Drift { drift: 0.0 },
                Quantity::NanosecondsPerStep => Gauge::Speed,
                Quantity::Probe(column, statistic) => {
                    let find = |(number, columns): (usize, &Vec<String>)| {
                        columns.iter().position(|c| c == column).map(|column_index| (number, column_index))
                    };
                    let (number, column_index) =
                        probes.iter().enumerate().find_map(find).unwrap_or((usize::MAX, usize::MAX));
                    Gauge::Probe {
                        number,
                        column_index,
                        statistic: *statistic,
                        least: f64::INFINITY,
                        largest: f64::NEG_INFINITY,
                        sum: 0.0,
                        count: 0.0,
                        last: f64::NAN,
                    }
                }
            })
            .collect();
        Meter { gauges, frames }
    }

    /// Whether the world must also be measured within frames, because an impact may last only one substep.
    pub(crate) fn looks_within(&self) -> bool {
        self.gauges.iter().any(|gauge| matches!(gauge, Gauge::Bounce { .. }))
    }

    /// Measures the world within a frame.
    pub(crate) fn look(&mut self, world: &dyn AnyWorld) {
        for gauge in &mut self.gauges {
            let Gauge::Bounce { body, up, lowest, rise } = gauge else { continue };
            let Some(body) = found(world, body.as_deref()) else { continue };
            let mut height = f64::INFINITY;
            for x in world.positions(body).iter() {
                let along = x.iter().zip(&*up).map(|(x, up)| x * up).sum::<f64>();
                if along < height {
                    height = along;
                }
            }
            if height < *lowest {
                *lowest = height;
            }
            if height - *lowest > *rise {
                *rise = height - *lowest;
            }
        }
    }

    /// Measures the world at the start and at the end of each frame.
    pub(crate) fn frame(&mut self, world: &mut dyn AnyWorld) {
        self.look(world);
        let late = world.frames() * 10 >= self.frames * 9;
        for gauge in &mut self.gauges {
            match gauge {
                Gauge::Bounce { .. } | Gauge::Speed => {}
                Gauge::Settling { kinetic } => kinetic.push([world.time(), world.energy().kinetic]),
                Gauge::Radius { body, sum, count } => {
                    if let Some(body) = found(world, body.as_deref()).filter(|_| late) {
                        *sum += radius(world, body);
                        *count += 1.0;
                    }
                }
                Gauge::Drift { drift } => *drift = world.energy().drift(),
                Gauge::Probe { number, column_index, least, largest, sum, count, last, .. } => {
                    let Some((_, x)) = world.probe(*number).get(*column_index).cloned().filter(|(_, x)| x.is_finite())
                    else {
                        continue;
                    };
                    *least = if x < *least { x } else { *least };
                    *largest = if x > *largest { x } else { *largest };
                    (*sum, *count, *last) = (*sum + x, *count + 1.0, x);
                }
            }
        }
    }

    /// Returns the results in the order of the metrics; none for times, and for numbers that the run does not provide.
    pub(crate) fn finish(self) -> Vec<Option<f64>> {
        let finite = |x: f64| Some(x).filter(|x| x.is_finite());
        self.gauges
            .into_iter()
            .map(|gauge| match gauge {
                Gauge::Bounce { rise, lowest, .. } => finite(lowest).map(|_| rise),
                Gauge::Settling { kinetic } => settled(&kinetic),
                Gauge::Radius { sum, count, .. } => finite(sum / count),
                Gauge::Drift { drift } => finite(drift),
                Gauge::Speed => None,
                Gauge::Probe { statistic, least, largest, sum, count, last, .. } => finite(match statistic {
                    Statistic::Least => least,
                    Statistic::Largest => largest,
                    Statistic::Mean => sum / count,
                    Statistic::Last => last,
                }),
            })
            .collect()
    }
}

/// Finds a body by its name or, without a name, the first existing body.
fn found(world: &dyn AnyWorld, name: Option<&str>) -> Option<usize> {
    match name {
        Some(name) => world.body(name),
        None => world.bodies().first().copied(),
    }
}

/// The mean distance of the nodes of a body from their centre.
fn radius(world: &dyn AnyWorld, body: usize) -> f64 {
    let positions = world.positions(body);
    let nodes = positions.len() as f64;
    let mut middle = [0.0; 3];
    positions.iter().for_each(|x| (0..3).for_each(|d| middle[d] += x[d] / nodes));
    let distance = |x: [f64; 3]| (0..3).map(|d| (x[d] - middle[d]) * (x[d] - middle[d])).sum::<f64>().sqrt();
    positions.iter().map(distance).sum::<f64>() / nodes
}

/// Returns the first of the given times from which on the kinetic energy stays below its limit; none if the run does not settle. `kinetic` lists
/// pairs of time and kinetic energy.
fn settled(kinetic: &[[f64; 2]]) -> Option<f64> {
    let largest = kinetic.iter().fold(0.0, |largest, row| if row[1] > largest { row[1] } else { largest });
    match kinetic.iter().rposition(|row| row[1] > SETTLED * largest) {
        None => kinetic.first().map(|row| row[0]),
        Some(last) => kinetic.get(last + 1).map(|row| row[0]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn metrics_are_told_apart_by_their_words() {
        let of = |text: &str| Metric::parse(text).expect("a metric").quantity;
        assert_eq!(of("bounce_height"), Quantity::BounceHeight(None));
        assert_eq!(of("bounce_height.ball"), Quantity::BounceHeight(Some("ball".into())));
        assert_eq!(of("top.y.max"), Quantity::Probe("top.y".into(), Statistic::Largest));
        assert_eq!(Metric::parse("top.vy.mean").expect("a metric").unit("m"), "m/s");
        assert_eq!(Metric::parse("top.ry.mean").expect("a metric").unit("m"), "N");
        let error = Metric::parse("bounce_hight").expect_err("misspelt");
        assert_eq!((error.code, error.hint.as_deref()), ("sweep.metric", Some("did you mean `bounce_height`?")));
    }

    #[test]
    fn settling_is_when_the_kinetic_energy_stays_small() {
        let swing = [[0.0, 0.0], [1.0, 5.0], [2.0, 0.0], [3.0, 1.0], [4.0, 0.01], [5.0, 0.0]];
        assert_eq!(settled(&swing), Some(4.0));
        assert_eq!(settled(&swing[..4]), None, "it still moves at the end");
        assert_eq!(settled(&[[0.0, 0.0], [1.0, 0.0]]), Some(0.0), "it has never moved");
    }
}
