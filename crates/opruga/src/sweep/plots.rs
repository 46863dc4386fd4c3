//! Plots of a sweep: lines over one parameter, maps over two.

use super::table::Status;
use super::{Axis, Design, Row, Sweep, number};
use opruga_draw::{Chart, DrawError, HeatMap, HeatPanel, Line, Marker, Nothing, Panel, format_value};

/// Returns all plots, each with its name and its text (SVG).
///
/// If one parameter varies, or several one after the other, each plot shows a metric over a parameter. For a grid of two parameters, each plot is a
/// map of a metric, with marks where runs have failed. For a grid of more parameters, or for a sample, each plot shows a metric over a parameter as
/// separate points. The credit is below each plot.
///
/// # Errors
/// [`DrawError`] if nothing can be drawn.
pub fn plots(sweep: &Sweep, rows: &[Row], length_unit: &str, credit: &str) -> Result<Vec<(String, String)>, DrawError> {
    let sweep_plots = Plots { sweep, rows, length_unit, credit };
    match (sweep.design, sweep.axes.as_slice()) {
        (Design::Grid, [x, y]) => Ok(vec![("plots.svg".into(), sweep_plots.map(x, y)?)]),
        (_, axes) => {
            let alone = axes.len() == 1;
            let one = |(index, axis)| -> Result<_, DrawError> {
                let name = if alone { "plots.svg".into() } else { format!("plots-{}.svg", file_name(axes, index)) };
                Ok((name, sweep_plots.over(index, axis)?))
            };
            axes.iter().enumerate().map(one).collect()
        }
    }
}

/// The last word of a path if that is sufficient to distinguish the parameters, otherwise the whole path.
fn file_name(axes: &[Axis], index: usize) -> String {
    let last = |axis: &Axis| axis.path.rsplit('.').next().unwrap_or_default().to_string();
    let word = last(&axes[index]);
    let alone = axes.iter().filter(|axis| last(axis) == word).count() == 1;
    let name = if alone { word } else { axes[index].path.clone() };
    name.chars().map(|c| if c.is_alphanumeric() || c == '.' { c } else { '_' }).collect()
}

struct Plots<'a> {
    sweep: &'a Sweep,
    rows: &'a [Row],
    length_unit: &'a str,
    credit: &'a str,
}

impl Plots<'_> {
    /// Every metric over one parameter.
    fn over(&self, index: usize, axis: &Axis) -> Result<String, DrawError> {
        let listed = match self.sweep.design {
            Design::Sample { .. } => None,
            _ => Some(axis.listed()),
        };
        let words = axis.numbers().is_none().then_some(listed).flatten();
        let lines = !matches!(self.sweep.design, Design::Sample { .. })
            && (self.sweep.axes.len() == 1 || self.sweep.design == Design::Each);
        // Values that are words have the positions 1, 2, 3, … on the axis.
        let at = |value: &str| match &words {
            Some(words) => words.iter().position(|word| word == value).map(|k| k as f64 + 1.0),
            None => number(value),
        };
        let mut panels = Vec::new();
        for (column, metric) in self.sweep.metrics.iter().enumerate() {
            let mut points = Vec::new();
            for row in self.rows {
                let Some(x) = row.values[index].as_deref().and_then(at) else { continue };
                points.push([x, row.numbers[column].unwrap_or(f64::NAN)]);
                if !lines {
                    // This makes a gap in the line, because points that are not neighbours are not connected.
                    points.push([f64::NAN; 2]);
                }
            }
            let values = || points.iter().map(|point| point[1]).filter(|y| y.is_finite());
            if values().next().is_none() {
                continue;
            }
            let mut y = axis_of(&metric.name, &metric.unit(self.length_unit));
            let (low, high) = values().fold((f64::INFINITY, 0.0), wider);
            y.logarithmic = low > 0.0 && high > 100.0 * low;
            // The axis of a time begins at zero, so that small variations look small.
            if metric.is_timing() && !y.logarithmic {
                y.range = Some([0.0, 1.15 * high]);
            }
            let line = Line { points, marker: Some(Marker::Circle), ..Line::default() };
            panels.push(Panel { y, lines: vec![line], ..Panel::default() });
        }
        if panels.is_empty() {
            return Err(DrawError::Empty { nothing: Nothing::NumberOfSweep });
        }
        let mut label = axis.path.clone();
        if let Some(words) = &words {
            let named: Vec<String> = words.iter().enumerate().map(|(k, word)| format!("{} {word}", k + 1)).collect();
            label = format!("{label} ({})", named.join(", "));
        }
        let x = opruga_draw::Axis { logarithmic: axis.logarithmic(), ..opruga_draw::Axis::linear(label, "") };
        Chart { title: self.sweep.name.clone(), x, panels, credit: self.credit.into(), ..Chart::default() }.to_svg()
    }

    /// Every metric as a map over two parameters.
    fn map(&self, x: &Axis, y: &Axis) -> Result<String, DrawError> {
        let (columns, rows) = (x.listed(), y.listed());
        let mut panels = Vec::new();
        for (index, metric) in self.sweep.metrics.iter().enumerate() {
            let mut values = vec![vec![f64::NAN; columns.len()]; rows.len()];
            let mut failed = Vec::new();
            for row in self.rows {
                // The points of a grid are numbered so that the last parameter varies fastest.
                let (column, line) = (row.number / rows.len(), row.number % rows.len());
                values[line][column] = row.numbers[index].unwrap_or(f64::NAN);
                if row.status != Status::Done {
                    failed.push([column, line]);
                }
            }
            let finite = || values.iter().flatten().copied().filter(|v| v.is_finite());
            let (low, high) = finite().fold((f64::INFINITY, 0.0), wider);
            panels.push(HeatPanel {
                scale: opruga_draw::Axis {
                    logarithmic: low > 0.0 && high > 100.0 * low,
                    ..axis_of(&metric.name, &metric.unit(self.length_unit))
                },
                values,
                failed,
            });
        }
        let [x_label, y_label] = [[x, y], [y, x]].map(|[axis, other]| short_path(&axis.path, &other.path));
        HeatMap {
            title: self.sweep.name.clone(),
            x_label,
            x: short_values(columns),
            y_label,
            y: short_values(rows),
            panels,
            credit: self.credit.into(),
            ..HeatMap::default()
        }
        .to_svg()
    }
}

/// Shortens a path to its last two words, or to as many more as are needed so that the result does not begin with a number. The whole path is kept if
/// the path of the other parameter ends in the same words.
fn short_path(path: &str, other: &str) -> String {
    let words: Vec<&str> = path.split('.').collect();
    let mut kept = words.len().min(2);
    while kept < words.len() && words[words.len() - kept].parse::<u64>().is_ok() {
        kept += 1;
    }
    let short = words[words.len() - kept..].join(".");
    let alike = other == short || other.ends_with(&format!(".{short}"));
    if alike { path.to_string() } else { short }
}

/// Shortens values to three digits, unless two of them would then be equal.
fn short_values(values: Vec<String>) -> Vec<String> {
    let short: Vec<String> = values.iter().map(|v| number(v).map_or(v.clone(), format_value)).collect();
    let distinct = short.iter().collect::<std::collections::BTreeSet<_>>().len() == short.len();
    if distinct { short } else { values }
}

/// A range extended to contain another number.
fn wider((low, high): (f64, f64), x: f64) -> (f64, f64) {
    (if x < low { x } else { low }, if x > high { x } else { high })
}

/// A linear axis; the words of its name are separated by spaces.
fn axis_of(name: &str, unit: &str) -> opruga_draw::Axis {
    opruga_draw::Axis::linear(name.replace('_', " "), unit)
}

#[cfg(test)]
mod tests {
    use super::{short_path, short_values};

    #[test]
    fn titles_of_axes_are_short_and_tell_the_parameters_apart() {
        let (mass, gas) = ("body.ball.mass", "body.ball.models.pressure.nRT");
        assert_eq!([short_path(mass, gas), short_path(gas, mass)], ["ball.mass", "pressure.nRT"]);
        assert_eq!(short_path("collider.0.restitution", mass), "collider.0.restitution");
        let (left, right) = ("body.left.models.pressure.nRT", "body.right.models.pressure.nRT");
        assert_eq!([short_path(left, right), short_path(right, left)], [left, right]);
        assert_eq!(short_path("mass", gas), "mass");
    }

    #[test]
    fn values_that_differ_look_different() {
        let listed = |values: &[&str]| values.iter().map(|value| value.to_string()).collect::<Vec<String>>();
        assert_eq!(short_values(listed(&["0.123456", "0.5"])), ["0.123", "0.5"]);
        assert_eq!(short_values(listed(&["2.5001", "2.5002"])), ["2.5001", "2.5002"]);
    }
}
