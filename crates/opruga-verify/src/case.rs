//! The definition of a case before it is run, and the resulting row.

use crate::lab::{Lab, Trouble};

/// The amount by which the observed order may be below the theoretical one.
pub(crate) const ORDER_MARGIN: f64 = 0.2;

/// The area of mechanics to which a case belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Family {
    /// Equilibria of solids, beams and chains.
    Statics,
    /// Material laws.
    Materials,
    /// Gas, balloons, rings.
    Pressure,
    /// Vibrations, waves, impact, friction.
    Dynamics,
    /// Integrators in time.
    Integrators,
    /// Energy and momentum.
    Ledgers,
}

impl Family {
    /// All families, in the order of the reports.
    pub const ALL: [Family; 6] =
        [Family::Statics, Family::Materials, Family::Pressure, Family::Dynamics, Family::Integrators, Family::Ledgers];
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Family::Statics => "statics",
            Family::Materials => "materials",
            Family::Pressure => "pressure",
            Family::Dynamics => "dynamics",
            Family::Integrators => "integrators",
            Family::Ledgers => "ledgers",
        }
    }
}

/// The meaning of the successive levels of a case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Over {
    /// The number of cells along a side. The size of the cells is inversely proportional to it.
    Cells(&'static str),
    /// A step [s], or another size that decreases.
    Step(&'static str),
    /// A parameter of the problem. Every value has its own expected result.
    Parameter(&'static str),
}

impl Over {
    /// The size of cells or the step at a level, which converges to zero.
    pub(crate) fn size(self, level: f64) -> f64 {
        match self {
            Over::Cells(_) => 1.0 / level,
            Over::Step(_) | Over::Parameter(_) => level,
        }
    }
}

/// The divisor of the difference between the measured and the expected value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scale {
    /// The expected value.
    Relative,
    /// A characteristic size of the problem, in the unit of the quantity.
    Of(f64),
}

/// The criterion by which a case passes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Check {
    /// The error at the finest level is within the tolerance. The error also decreases from level to level, and its order over all levels is at least
    /// this order minus 0.2.
    Order(f64),
    /// The error at the finest level is within the tolerance. This criterion is used if the reference has too few digits for an order, or belongs to
    /// a slightly different body.
    Finest,
    /// The errors at all levels are within the tolerance.
    Everywhere,
}

/// A case, fixed before it is run.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Its unique name.
    pub name: &'static str,
    /// The family to which it belongs.
    pub family: Family,
    /// The measured quantity, in physical terms.
    pub quantity: &'static str,
    /// The unit of the quantity.
    pub unit: &'static str,
    /// The source of the expected values.
    pub source: &'static str,
    /// The meaning of the levels.
    pub over: Over,
    /// Meshes, steps or values of the parameter, with coarse ones first.
    pub levels: &'static [f64],
    /// The expected value, or one for each level.
    pub expected: &'static [f64],
    /// The divisor of errors.
    pub scale: Scale,
    /// The largest allowed error.
    pub tolerance: f64,
    /// The levels to which the tolerance applies, and the expected order.
    pub check: Check,
    /// Whether the case takes so little time that the tests of the program run it.
    pub quick: bool,
    /// Runs a scene at a level and measures the quantity.
    pub measure: fn(&Lab, f64) -> Result<f64, Trouble>,
}

/// The result at a level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// The level.
    pub level: f64,
    /// The measured value.
    pub computed: f64,
    /// The expected value.
    pub expected: f64,
    /// The difference divided by the scale of the case.
    pub error: f64,
}

/// The outcome of a case.
#[derive(Clone, Debug)]
pub struct Row {
    /// The case.
    pub case: &'static Case,
    /// The results, level by level.
    pub points: Vec<Point>,
    /// The slope of the logarithm of the error over the logarithm of the size, by a least-squares fit; `None` if no order is expected.
    pub observed_order: Option<f64>,
    /// Whether the case passes.
    pub pass: bool,
    /// The reason why there are no numbers, if the engine has refused something.
    pub trouble: Option<String>,
    /// The computing time [s].
    pub seconds: f64,
}

impl Case {
    /// The criterion in short form: `order 2 ≤ 0.01`.
    pub fn passes_when(&self) -> String {
        let theory = match self.check {
            Check::Order(order) => format!("order {order}"),
            Check::Finest => "finest".into(),
            Check::Everywhere => "everywhere".into(),
        };
        format!("{theory} ≤ {}", self.limit())
    }

    /// The largest allowed error as text.
    pub(crate) fn limit(&self) -> String {
        if self.tolerance < 1e-3 { format!("{:e}", self.tolerance) } else { self.tolerance.to_string() }
    }

    /// Runs all levels on the calling thread.
    pub fn run(&'static self, lab: &Lab) -> Row {
        let start = std::time::Instant::now();
        let mut row =
            Row { case: self, points: Vec::new(), observed_order: None, pass: false, trouble: None, seconds: 0.0 };
        for (number, level) in self.levels.iter().enumerate() {
            match (self.measure)(lab, *level) {
                Ok(computed) => {
                    let expected = *self.expected.get(number).unwrap_or(&self.expected[0]);
                    let scale = match self.scale {
                        Scale::Relative => expected.abs(),
                        Scale::Of(size) => size,
                    };
                    let error = (computed - expected).abs() / scale;
                    row.points.push(Point { level: *level, computed, expected, error });
                }
                Err(trouble) => {
                    row.trouble = Some(format!("at {level}: {trouble}"));
                    break;
                }
            }
        }
        if matches!(self.check, Check::Order(_)) {
            row.observed_order = slope(row.points.iter().map(|p| (self.over.size(p.level), p.error)));
        }
        row.pass = row.trouble.is_none() && self.passes(&row);
        row.seconds = start.elapsed().as_secs_f64();
        row
    }

    fn passes(&self, row: &Row) -> bool {
        let finest = row.points.last().is_some_and(|point| point.error <= self.tolerance);
        match self.check {
            Check::Finest => finest,
            Check::Everywhere => row.points.iter().all(|point| point.error <= self.tolerance),
            Check::Order(order) => {
                let falls = row.points.windows(2).all(|pair| pair[1].error < pair[0].error);
                finest && falls && row.observed_order.is_some_and(|seen| seen >= order - ORDER_MARGIN)
            }
        }
    }
}

impl Row {
    /// The point that decides whether the case passes. It is the finest point or, if all points must be within the tolerance, the point with the
    /// largest error.
    pub fn decisive(&self) -> Option<&Point> {
        match self.case.check {
            Check::Everywhere => {
                self.points.iter().reduce(|worst, point| if point.error > worst.error { point } else { worst })
            }
            _ => self.points.last(),
        }
    }
}

/// The slope of ln error over ln size by least squares; `None` for fewer than three points or for an error of zero.
fn slope(points: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    let logs: Vec<(f64, f64)> = points.map(|(size, error)| (size.ln(), error.ln())).collect();
    if logs.len() < 3 || logs.iter().any(|(_, y)| !y.is_finite()) {
        return None;
    }
    let count = logs.len() as f64;
    let (x, y) = logs.iter().fold((0.0, 0.0), |sum, p| (sum.0 + p.0 / count, sum.1 + p.1 / count));
    let (above, below) =
        logs.iter().fold((0.0, 0.0), |sum, p| (sum.0 + (p.0 - x) * (p.1 - y), sum.1 + (p.0 - x) * (p.0 - x)));
    Some(above / below)
}

#[cfg(test)]
mod tests {
    use super::slope;

    #[test]
    fn the_slope_of_a_power_is_its_exponent() {
        let of = |exponent: f64| slope([0.5f64, 0.25, 0.1].into_iter().map(|h| (h, 3.0 * h.powf(exponent))));
        assert!((of(2.0).unwrap() - 2.0).abs() < 1e-12 && (of(-0.5).unwrap() + 0.5).abs() < 1e-12);
        assert_eq!(slope([(1.0, 1.0), (0.5, 0.5)].into_iter()), None);
        assert_eq!(slope([(1.0, 1.0), (0.5, 0.0), (0.25, 0.1)].into_iter()), None);
    }
}
