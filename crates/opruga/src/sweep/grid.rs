//! The values of a sweep: lists and ranges of parameters, and the points made from them.

use super::errors::{RangeFault, SweepError};
use opruga_core::check::Random;
use opruga_io::SceneError;
use opruga_io::problem::visible;
use opruga_math::elementary::{exponential, natural_logarithm};

/// The largest number of points of a sweep.
pub const MOST_POINTS: usize = 1_000_000;

/// A parameter and its values.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The path of the parameter, as used by `--set`.
    pub path: String,
    /// The values.
    pub values: Values,
}

/// The values of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// A list of values, each as a scene file would write it.
    Listed(Vec<String>),
    /// Numbers between two ends, including both ends.
    Range(Range),
}

/// Numbers between two ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// The lower end.
    pub low: f64,
    /// The upper end.
    pub high: f64,
    /// The number of values; none if a sample chooses the values.
    pub count: Option<usize>,
    /// Whether all pairs of neighbouring values have the same ratio instead of the same difference.
    pub logarithmic: bool,
    /// Whether the values are rounded to whole numbers.
    pub whole: bool,
}

/// The points that a sweep visits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Design {
    /// All combinations of the values of the parameters.
    Grid,
    /// The values of one parameter after the other, with the others as in the scene.
    Each,
    /// Random points, which depend only on a seed.
    Sample {
        /// The number of points.
        count: usize,
        /// The seed.
        seed: u64,
        /// Whether points are independent. Otherwise they form a Latin hypercube: if the range of a parameter is divided into as many equal parts as
        /// there are points, each part contains one point.
        independent: bool,
    },
}

/// One point of a sweep: a value for each parameter; none where the parameter has the value of the scene.
pub type Point = Vec<Option<String>>;

impl Axis {
    /// Reads `PATH=a,b,c` or `PATH=LOW..HIGH:COUNT[:log][:whole]`. A single value is not an axis and gives `None`.
    ///
    /// # Errors
    /// `set.syntax` if there is no path, `sweep.values` if values are missing, `sweep.range` if a range is invalid.
    pub fn parse(argument: &str) -> Result<Option<Axis>, SceneError> {
        let (path, text) = opruga_io::overrides::split(argument)?;
        let refuse =
            |error: SceneError| SceneError { file: format!("--set {}", visible(argument)), ..error }.path(&path);
        if let Some(range) = Range::parse(&text).map_err(refuse)? {
            return Ok(Some(Axis { path, values: Values::Range(range) }));
        }
        if text.contains(char::is_control) {
            return Err(refuse(SceneError::of(SweepError::ControlCharacter { text: visible(&text) })));
        }
        let values = split_list(&text);
        if values.len() > 1 && values.iter().any(String::is_empty) {
            return Err(refuse(SceneError::of(SweepError::NoValue { text: visible(&text) })));
        }
        Ok((values.len() > 1).then_some(Axis { path, values: Values::Listed(values) }))
    }

    /// The values of a grid.
    pub fn listed(&self) -> Vec<String> {
        match &self.values {
            Values::Listed(values) => values.clone(),
            Values::Range(range) => {
                let count = range.count.unwrap_or(1);
                let fraction = |k: usize| if count > 1 { k as f64 / (count - 1) as f64 } else { 0.0 };
                let mut out: Vec<String> = (0..count).map(|k| range.at(fraction(k))).collect();
                // Neighbours may be rounded to the same whole number.
                out.dedup();
                out
            }
        }
    }

    /// The value at a fraction from 0 to 1 (exclusive).
    fn at(&self, fraction: f64) -> String {
        match &self.values {
            Values::Listed(values) => {
                values.get((fraction * values.len() as f64) as usize).or(values.last()).cloned().unwrap_or_default()
            }
            Values::Range(range) => range.at(fraction),
        }
    }

    /// The values as numbers, if all of them are numbers.
    pub fn numbers(&self) -> Option<Vec<f64>> {
        match &self.values {
            Values::Listed(values) => values.iter().map(|value| number(value)).collect(),
            Values::Range(_) => self.listed().iter().map(|value| number(value)).collect(),
        }
    }

    /// Whether the values are best shown on a logarithmic axis.
    pub fn logarithmic(&self) -> bool {
        match &self.values {
            Values::Range(range) => range.logarithmic,
            Values::Listed(_) => self.numbers().is_some_and(|numbers| {
                let sum =
                    |of: fn(f64) -> f64| numbers.windows(2).map(|pair| (of(pair[1]) - of(pair[0])).abs()).collect();
                let (plain, ratios): (Vec<f64>, Vec<f64>) = (sum(|x| x), sum(natural_logarithm));
                numbers.len() > 2 && numbers.iter().all(|x| *x > 0.0) && uneven(&ratios) < uneven(&plain)
            }),
        }
    }
}

/// The ratio of the largest distance to the smallest: 1 for equally spaced values.
fn uneven(distances: &[f64]) -> f64 {
    let (low, high) = distances.iter().fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), d| {
        (if *d < low { *d } else { low }, if *d > high { *d } else { high })
    });
    high / low
}

/// A value as a number, if it is a finite number.
pub fn number(text: &str) -> Option<f64> {
    text.replace('_', "").parse::<f64>().ok().filter(|x| x.is_finite())
}

impl Range {
    fn parse(text: &str) -> Result<Option<Range>, SceneError> {
        let mut parts = text.split(':').map(str::trim);
        let Some((low, high)) = parts.next().and_then(|ends| ends.split_once("..")) else { return Ok(None) };
        if text.starts_with(['"', '\'', '[', '{']) {
            return Ok(None);
        }
        let refuse = |fault| SceneError::of(SweepError::InvalidRange { text: visible(text), fault });
        let (Some(low), Some(high)) = (number(low.trim()), number(high.trim())) else {
            return Err(refuse(RangeFault::Ends));
        };
        let mut range = Range { low, high, count: None, logarithmic: false, whole: false };
        for part in parts {
            match (part, part.parse::<usize>()) {
                ("log", _) if range.logarithmic => return Err(refuse(RangeFault::TwoLogs)),
                ("whole", _) if range.whole => return Err(refuse(RangeFault::TwoWholes)),
                (_, Ok(_)) if range.count.is_some() => return Err(refuse(RangeFault::TwoCounts)),
                ("log", _) => range.logarithmic = true,
                ("whole", _) => range.whole = true,
                (_, Ok(count)) if (2..=MOST_POINTS).contains(&count) => range.count = Some(count),
                (_, Ok(_)) => return Err(refuse(RangeFault::Count)),
                _ => return Err(refuse(RangeFault::Word)),
            }
        }
        if low >= high {
            return Err(refuse(RangeFault::Order));
        }
        if range.logarithmic && low <= 0.0 {
            return Err(refuse(RangeFault::Ratios));
        }
        Ok(Some(range))
    }

    /// The number at a fraction from 0 (the lower end) to 1 (the upper end), as a scene file would write it.
    fn at(&self, fraction: f64) -> String {
        let x = if fraction <= 0.0 {
            self.low
        } else if fraction >= 1.0 {
            self.high
        } else if self.logarithmic {
            let (low, high) = (natural_logarithm(self.low), natural_logarithm(self.high));
            exponential(low + fraction * (high - low))
        } else {
            self.low + fraction * (self.high - self.low)
        };
        // Only fifteen digits are written, because later ones would show rounding errors. Numbers such as counts of vertices are whole.
        let x = number(&format!("{:.14e}", if self.whole { x.round() } else { x })).unwrap_or(x);
        format!("{x}")
    }
}

/// Splits at commas outside brackets and quotes.
fn split_list(text: &str) -> Vec<String> {
    let (mut out, mut depth, mut quote) = (vec![String::new()], 0i32, None);
    for c in text.chars() {
        match (c, quote) {
            ('"' | '\'', None) => quote = Some(c),
            (_, Some(open)) if c == open => quote = None,
            ('[' | '{', None) => depth += 1,
            (']' | '}', None) => depth -= 1,
            _ => {}
        }
        if c == ',' && depth == 0 && quote.is_none() {
            out.push(String::new());
        } else if let Some(last) = out.last_mut() {
            last.push(c);
        }
    }
    out.iter().map(|value| value.trim().to_string()).collect()
}

/// The points of a sweep, in the order of its table.
///
/// # Errors
/// `sweep.axes` if nothing varies, `sweep.range` if a range lacks its number of values or has one in a sample, or if a sample has no points,
/// `sweep.too_many` if there are more than [`MOST_POINTS`].
pub(super) fn points(axes: &[Axis], design: Design) -> Result<Vec<Point>, SceneError> {
    if axes.is_empty() {
        return Err(SceneError::of(SweepError::NothingVaries {}));
    }
    for (index, axis) in axes.iter().enumerate() {
        if axes[..index].iter().any(|other| other.path == axis.path) {
            return Err(SceneError::of(SweepError::VariesTwice {}).path(visible(&axis.path)));
        }
        let Values::Range(range) = &axis.values else { continue };
        let range_shown = || format!("{}..{}", range.low, range.high);
        let about = match (design, range.count) {
            (Design::Sample { .. }, Some(_)) => SweepError::SampleWithCount { range: range_shown() },
            (Design::Grid | Design::Each, None) => SweepError::NoCount { range: range_shown() },
            _ => continue,
        };
        return Err(SceneError::of(about).path(visible(&axis.path)));
    }
    let too_many = |count| SceneError::of(SweepError::TooManyPoints { count, most: MOST_POINTS });
    match design {
        Design::Grid => {
            let listed: Vec<Vec<String>> = axes.iter().map(Axis::listed).collect();
            let count = listed.iter().try_fold(1usize, |all, values| all.checked_mul(values.len()));
            let count = count.filter(|count| *count <= MOST_POINTS).ok_or_else(|| {
                let numbers: Vec<String> = listed.iter().map(|values| values.len().to_string()).collect();
                too_many(numbers.join(" × "))
            })?;
            // The last parameter varies fastest.
            Ok((0..count)
                .map(|mut number| {
                    let mut point: Point = listed
                        .iter()
                        .rev()
                        .map(|values| {
                            let value = values[number % values.len()].clone();
                            number /= values.len();
                            Some(value)
                        })
                        .collect();
                    point.reverse();
                    point
                })
                .collect())
        }
        Design::Each => Ok(axes
            .iter()
            .enumerate()
            .flat_map(|(index, axis)| {
                axis.listed().into_iter().map(move |value| {
                    let mut point = vec![None; axes.len()];
                    point[index] = Some(value);
                    point
                })
            })
            .collect()),
        Design::Sample { count: 0, .. } => Err(SceneError::of(SweepError::EmptySample { most: MOST_POINTS })),
        Design::Sample { count, .. } if count > MOST_POINTS => Err(too_many(count.to_string())),
        Design::Sample { count, seed, independent } => {
            let mut random = Random::new(seed);
            let mut out = vec![Vec::with_capacity(axes.len()); count];
            for axis in axes {
                // Each part of the range gets one point; the shuffle (Fisher and Yates) determines which.
                let mut parts: Vec<usize> = (0..count).collect();
                for k in (1..count).rev() {
                    parts.swap(k, (random.bits() % (k as u64 + 1)) as usize);
                }
                for (point, part) in out.iter_mut().zip(parts) {
                    let within = (random.bits() >> 11) as f64 / (1u64 << 53) as f64;
                    let fraction = if independent { within } else { (part as f64 + within) / count as f64 };
                    point.push(Some(axis.at(fraction)));
                }
            }
            Ok(out)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(argument: &str) -> Axis {
        Axis::parse(argument).expect("it can be read").expect("it varies")
    }

    #[test]
    fn ranges_reach_both_ends_with_equal_distances_or_equal_ratios() {
        assert_eq!(axis("a=0.1..0.9:5").listed(), ["0.1", "0.3", "0.5", "0.7", "0.9"]);
        assert_eq!(axis("a=8..512:log:7").listed(), ["8", "16", "32", "64", "128", "256", "512"]);
        assert_eq!(axis("a=1..1000:4:log").listed(), ["1", "10", "100", "1000"]);
        assert_eq!(axis("a=1..4:7:whole").listed(), ["1", "2", "3", "4"], "1.5 is rounded to 2, and twice is once");
        assert_eq!(axis("a=-2..-1:2").listed(), ["-2", "-1"]);
        assert!(axis("a=1,10,100").logarithmic() && !axis("a=1,2,3").logarithmic());
    }

    #[test]
    fn lists_are_cut_at_commas_outside_of_brackets_and_quotes() {
        assert_eq!(axis("g=[0, -9.81],[0,0]").listed(), ["[0, -9.81]", "[0,0]"]);
        assert_eq!(axis("n=\"a,b\",c").listed(), ["\"a,b\"", "c"]);
        assert_eq!(Axis::parse("n=36"), Ok(None), "a single value varies nothing");
        assert_eq!(Axis::parse("n=[1,2]"), Ok(None));
        assert_eq!(Axis::parse("n=\"../a,b\""), Ok(None));
    }

    #[test]
    fn what_makes_no_sense_is_refused_with_the_value() {
        for (argument, code) in [
            ("a=1..", "sweep.range"),
            ("a=2..1:3", "sweep.range"),
            ("a=0..1:log:3", "sweep.range"),
            ("a=0..1:1", "sweep.range"),
            ("a=0..1:3:4", "sweep.range"),
            ("a=1..2:log:log:3", "sweep.range"),
            ("a=1..2:3:whole:log:whole", "sweep.range"),
            ("a=0..1:cubic", "sweep.range"),
            ("a=1,,2", "sweep.values"),
            ("a=[1,\n2],[3]", "sweep.values"),
            ("a", "set.syntax"),
        ] {
            let error = Axis::parse(argument).expect_err(argument);
            assert_eq!(error.code, code, "{argument}");
            assert!(error.value.is_some() && error.allowed.is_some(), "{argument}: {error}");
        }
        let few = points(&[axis("a=0..1")], Design::Grid).expect_err("no count");
        assert_eq!(few.code, "sweep.range");
        let sample = Design::Sample { count: 3, seed: 1, independent: false };
        assert_eq!(points(&[axis("a=0..1:3")], sample).expect_err("a count too many").code, "sweep.range");
        assert_eq!(points(&[], Design::Grid).expect_err("nothing").code, "sweep.axes");
        let large = [axis("a=0..1:2000"), axis("b=0..1:2000")];
        assert_eq!(points(&large, Design::Grid).expect_err("four million").code, "sweep.too_many");
        assert_eq!(points(&[axis("a=1,2"), axis("a=1,3")], Design::Grid).expect_err("twice").code, "sweep.axes");
    }

    #[test]
    fn a_grid_has_every_pair_once_and_each_varies_one_at_a_time() {
        let axes = [axis("a=1,2"), axis("b=x,y,z")];
        let grid = points(&axes, Design::Grid).expect("points");
        let names: Vec<String> = grid.iter().map(|p| p.iter().flatten().cloned().collect()).collect();
        assert_eq!(names, ["1x", "1y", "1z", "2x", "2y", "2z"]);
        let each = points(&axes, Design::Each).expect("points");
        assert_eq!(each.len(), 5);
        assert!(each.iter().all(|point| point.iter().flatten().count() == 1));
    }

    /// Each of n equal parts of each range contains exactly one of n points.
    #[test]
    fn a_latin_hypercube_is_stratified_along_every_axis() {
        let axes = [axis("a=0..1"), axis("b=1..1000:log"), axis("c=p,q")];
        let sample = |seed| points(&axes, Design::Sample { count: 40, seed, independent: false }).expect("points");
        let of = |points: &[Point], k: usize| -> Vec<String> {
            points.iter().map(|p| p[k].clone().expect("a value")).collect()
        };
        let one = sample(1);
        let mut parts: Vec<usize> = of(&one, 0).iter().map(|x| (number(x).expect("x") * 40.0) as usize).collect();
        parts.sort_unstable();
        assert_eq!(parts, (0..40).collect::<Vec<_>>());
        let mut parts: Vec<usize> =
            of(&one, 1).iter().map(|x| (number(x).expect("x").log10() / 3.0 * 40.0) as usize).collect();
        parts.sort_unstable();
        assert_eq!(parts, (0..40).collect::<Vec<_>>());
        assert_eq!(of(&one, 2).iter().filter(|x| *x == "p").count(), 20);
        assert_eq!(one, sample(1), "the same seed gives the same points");
        assert_ne!(one, sample(2));
        let free = points(&axes, Design::Sample { count: 40, seed: 1, independent: true }).expect("points");
        let mut parts: Vec<usize> = of(&free, 0).iter().map(|x| (number(x).expect("x") * 40.0) as usize).collect();
        parts.sort_unstable();
        parts.dedup();
        assert!(parts.len() < 40, "points that know nothing of each other do not fill every part");
    }
}
