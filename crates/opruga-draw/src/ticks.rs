//! Round numbers for axes, legends and scale bars.

/// Returns about `count` values between two limits, with a round number between neighbours.
pub fn nice_ticks(low: f64, high: f64, count: usize) -> Vec<f64> {
    if !(low.is_finite() && high.is_finite()) || high <= low {
        return vec![low];
    }
    let inside = |pieces: usize| {
        let step = nice_step((high - low) / pieces as f64);
        let slack = 1e-9 * (high - low) / step;
        let first = (low / step - slack).ceil() as i64;
        let last = (high / step + slack).floor() as i64;
        (first..=last).map(|index| index as f64 * step).collect::<Vec<f64>>()
    };
    let mut pieces = count.max(1);
    let mut ticks = inside(pieces);
    // Two ticks are needed to read a scale.
    while ticks.len() < 2 {
        pieces += 1;
        ticks = inside(pieces);
    }
    ticks
}

/// The smallest number that is 1, 2, 2.5 or 5 times a power of ten and at least `rough`.
pub fn nice_step(rough: f64) -> f64 {
    let power = power_of_ten(rough);
    let mantissa = rough / power;
    let round = [1.0, 2.0, 2.5, 5.0].into_iter().find(|&candidate| mantissa <= candidate * (1.0 + 1e-9));
    round.unwrap_or(10.0) * power
}

/// The largest number that is 1, 2 or 5 times a power of ten and at most `limit`.
pub fn nice_length(limit: f64) -> f64 {
    let power = power_of_ten(limit);
    let mantissa = limit / power;
    let round = [5.0, 2.0].into_iter().find(|&candidate| mantissa >= candidate * (1.0 - 1e-9));
    round.unwrap_or(1.0) * power
}

/// The powers of ten between two positive limits.
pub fn decades(low: f64, high: f64) -> Vec<f64> {
    let first = (low.log10() - 1e-9).ceil() as i32;
    let last = (high.log10() + 1e-9).floor() as i32;
    (first..=last).map(ten_to).collect()
}

/// The largest power of ten that is at most the value.
fn power_of_ten(value: f64) -> f64 {
    if !(value.is_finite() && value > 0.0) {
        return 1.0;
    }
    ten_to((value.log10() + 1e-12).floor() as i32)
}

/// A power of ten, correctly rounded.
fn ten_to(exponent: i32) -> f64 {
    format!("1e{exponent}").parse().unwrap_or(1.0)
}

/// A number as short text, with as many digits as are needed to distinguish neighbours that differ by `step`.
pub fn format_tick(value: f64, step: f64) -> String {
    if value == 0.0 || value.abs() < step.abs() * 1e-6 {
        return "0".to_string();
    }
    let magnitude = value.abs();
    // A power of ten is used only if three digits before it are enough to distinguish neighbours.
    let fine = step.abs() < 0.0099 * magnitude && magnitude < 1e12;
    let small = magnitude < 1e-3 && step.abs() < 0.99e-4;
    if small || magnitude >= 1e6 && !fine {
        return scientific(value);
    }
    let mut digits = 0;
    while digits < 9 && {
        let scaled = step.abs() * ten_to(digits);
        (scaled - scaled.round()).abs() > 1e-6 * scaled.max(1.0) || scaled.round() == 0.0
    } {
        digits += 1;
    }
    grouped(&format!("{value:.digits$}", digits = digits as usize)).replace('-', "−")
}

/// A number as short text with up to three significant digits.
pub fn format_value(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    format_tick(value, ten_to((value.abs().log10() + 1e-9).floor() as i32 - 2)).trim_end_matches_fraction()
}

/// Removes trailing zeros of a decimal fraction.
trait TrimFraction {
    /// The text without trailing zeros of its decimal fraction.
    fn trim_end_matches_fraction(self) -> String;
}

impl TrimFraction for String {
    fn trim_end_matches_fraction(self) -> String {
        if !self.contains('.') || self.contains('×') {
            return self;
        }
        self.trim_end_matches('0').trim_end_matches('.').to_string()
    }
}

/// A number as a mantissa and a power of ten, such as 2.5×10³.
pub fn scientific(value: f64) -> String {
    let text = format!("{value:e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let mantissa: f64 = mantissa.parse().unwrap_or(1.0);
    let mut exponent: i32 = exponent.parse().unwrap_or(0);
    let mut rounded = (mantissa * 100.0).round() / 100.0;
    if rounded.abs() >= 10.0 {
        rounded /= 10.0;
        exponent += 1;
    }
    let power: String = exponent
        .to_string()
        .chars()
        .map(|sign| match sign {
            '-' => '⁻',
            digit => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][digit.to_digit(10).unwrap_or(0) as usize],
        })
        .collect();
    let mantissa = format!("{rounded}").replace('-', "−");
    match mantissa.as_str() {
        "1" => format!("10{power}"),
        "−1" => format!("−10{power}"),
        _ => format!("{mantissa}×10{power}"),
    }
}

/// Inserts a thin space between groups of three digits of an integer part with five digits or more.
fn grouped(text: &str) -> String {
    let (sign, rest) = text.strip_prefix('-').map_or(("", text), |rest| ("-", rest));
    let (whole, fraction) = rest.split_once('.').map_or((rest, None), |(whole, fraction)| (whole, Some(fraction)));
    let mut out = String::from(sign);
    for (index, digit) in whole.chars().enumerate() {
        if whole.len() >= 5 && index > 0 && (whole.len() - index) % 3 == 0 {
            out.push('\u{a0}');
        }
        out.push(digit);
    }
    if let Some(fraction) = fraction {
        out.push('.');
        out.push_str(fraction);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(nice_ticks(0.0, 1.0, 5), vec![0.0, 0.2, 0.4, 0.6000000000000001, 0.8, 1.0]);
        assert_eq!(nice_ticks(-3.2, 7.9, 5), vec![-2.5, 0.0, 2.5, 5.0, 7.5]);
        assert_eq!(nice_ticks(0.66, 0.79, 2), vec![0.7000000000000001, 0.75]);
        assert_eq!(nice_ticks(4.0, 4.0, 5), vec![4.0]);
    }

    #[test]
    fn lengths_are_round() {
        assert_eq!(nice_length(0.37), 0.2);
        assert_eq!(nice_length(9.0), 5.0);
        assert_eq!(nice_length(1000.0), 1000.0);
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!(format_tick(0.25, 0.05), "0.25");
        assert_eq!(format_tick(-2.0, 1.0), "−2");
        assert_eq!(format_tick(27778.0, 1.0), "27\u{a0}778");
        assert_eq!(format_tick(7_960_500.0, 500.0), "7\u{a0}960\u{a0}500");
        assert_eq!(format_tick(2.5e6, 5e5), "2.5×10⁶");
        assert_eq!(format_tick(0.0005, 0.0005), "0.0005", "as its neighbour 0.0010");
        assert_eq!(format_value(0.5), "0.5");
        assert_eq!(format_value(1234.0), "1234");
        assert_eq!(scientific(2.5e-7), "2.5×10⁻⁷");
        assert_eq!(scientific(1e6), "10⁶");
    }

    #[test]
    fn decades_lie_between_the_limits() {
        assert_eq!(decades(20.0, 2e4), vec![100.0, 1e3, 1e4]);
    }
}
