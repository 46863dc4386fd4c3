//! The mapping of the values of an axis to fractions of its length, and the positions of its ticks.

use super::Axis;
use crate::ticks::{decades, format_tick, nice_ticks, scientific};

/// The linear or logarithmic map from a value to a fraction from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scale {
    /// The value at the start.
    pub(crate) low: f64,
    /// The value at the end.
    pub(crate) high: f64,
    /// Whether equal distances mean equal ratios.
    pub(crate) logarithmic: bool,
}

/// A tick of an axis.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tick {
    /// The value.
    pub(crate) value: f64,
    /// The text, which is empty for the small ticks of a logarithmic axis.
    pub(crate) label: String,
}

impl Scale {
    /// The scale that shows all values; `margin` is the free fraction at both ends.
    pub(crate) fn fit(axis: &Axis, values: impl Iterator<Item = f64>, margin: f64) -> Scale {
        let logarithmic = axis.logarithmic;
        let seen = values.filter(|value| value.is_finite() && (!logarithmic || *value > 0.0));
        let (low, high) = seen.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        let [low, high] = if low <= high { [low, high] } else { [1.0, 10.0] };
        if let Some([low, high]) = axis.range.filter(|[low, high]| high > low && (!logarithmic || *low > 0.0)) {
            return Scale { low, high, logarithmic };
        }
        if logarithmic {
            let factor = (high / low).powf(margin).max(1.15);
            return Scale { low: low / factor, high: high * factor, logarithmic };
        }
        // A line that varies by less than a millionth is drawn flat, because the labels of ticks within this range would all be equal.
        let width = if high - low > 1e-6 * low.abs().max(high.abs()) { high - low } else { 0.0 };
        let pad = if width > 0.0 {
            margin * width
        } else if margin > 0.0 {
            (0.1 * high.abs()).max(if high == 0.0 { 1.0 } else { 0.0 })
        } else {
            0.5
        };
        Scale { low: low - pad, high: high + pad, logarithmic }
    }

    /// The fraction for a value; none if it has no position on the scale.
    pub(crate) fn fraction(&self, value: f64) -> Option<f64> {
        let fraction = if self.logarithmic {
            (value / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        };
        fraction.is_finite().then_some(fraction)
    }

    /// The ticks within the scale, about `count` of them.
    pub(crate) fn ticks(&self, count: usize) -> Vec<Tick> {
        if !self.logarithmic {
            let values = nice_ticks(self.low, self.high, count);
            let step = if values.len() > 1 { values[1] - values[0] } else { self.low.abs() };
            return values.into_iter().map(|value| Tick { value, label: format_tick(value, step) }).collect();
        }
        let whole = decades(self.low, self.high);
        let first = 10_f64.powf(self.low.log10().floor());
        let span = (self.high / self.low).log10();
        let every = (whole.len() / (count + 2).max(1)) + 1;
        let mut ticks = Vec::new();
        let mut power = first;
        while power <= self.high {
            for digit in 1..10 {
                let value = power * f64::from(digit);
                if value < self.low * 0.999_999 || value > self.high * 1.000_001 {
                    continue;
                }
                let index = value.log10().round() as i64;
                let listed = match digit {
                    1 => index % every as i64 == 0,
                    2 | 5 => span < 2.2,
                    _ => false,
                };
                if listed || span < 7.0 {
                    let label = if listed { log_label(value) } else { String::new() };
                    ticks.push(Tick { value, label });
                }
            }
            power *= 10.0;
        }
        ticks
    }
}

/// The text of a tick on a logarithmic axis.
fn log_label(value: f64) -> String {
    if (0.0099..100_000.5).contains(&value) {
        let step = 10_f64.powf(value.log10().floor().min(0.0));
        format_tick(value, step)
    } else {
        scientific(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_linear_scale_has_round_ticks() {
        let scale = Scale::fit(&Axis::default(), [0.0, 10.0].into_iter(), 0.0);
        let labels: Vec<String> = scale.ticks(5).into_iter().map(|tick| tick.label).collect();
        assert_eq!(labels, ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(scale.fraction(5.0), Some(0.5));
    }

    #[test]
    fn a_logarithmic_scale_lists_decades_and_skips_what_is_not_positive() {
        let scale = Scale::fit(&Axis::logarithmic("", ""), [0.0, -3.0, 10.0, 1e4].into_iter(), 0.0);
        let labels: Vec<String> =
            scale.ticks(6).into_iter().map(|tick| tick.label).filter(|label| !label.is_empty()).collect();
        assert_eq!(labels, ["10", "100", "1000", "10\u{a0}000"]);
        assert_eq!(scale.fraction(0.0), None);
    }

    #[test]
    fn a_constant_line_has_a_scale() {
        let scale = Scale::fit(&Axis::default(), [3.0, 3.0].into_iter(), 0.05);
        assert!(scale.low < 3.0 && scale.high > 3.0);
        let scale = Scale::fit(&Axis::default(), std::iter::empty(), 0.05);
        assert!(scale.low < scale.high);
    }
}
