//! How messages write numbers and counts, in the same way in all crates.

/// Writes a number in readable form: at most six significant digits without trailing zeros, and an exponent below 10⁻⁴ and from
/// 10⁷ up.
///
/// Tables and JSON contain all digits. Sentences need only as many digits as a person reads.
#[must_use]
pub fn number(x: f64) -> String {
    rounded(x, 6)
}

/// Writes a number with this many significant digits.
#[must_use]
pub fn rounded(x: f64, digits: usize) -> String {
    if !x.is_finite() {
        return if x.is_nan() { "not a number".into() } else { format!("{}infinite", if x < 0.0 { "-" } else { "" }) };
    }
    if x == 0.0 {
        return "0".into();
    }
    // The number is rounded here; the second formatting does not round again.
    let rounded = format!("{x:.*e}", digits.clamp(1, 15) - 1);
    let x: f64 = rounded.parse().unwrap_or(x);
    let (mantissa, exponent) = rounded.split_once('e').unwrap_or((&rounded, "0"));
    let bare = |digits: &str| match digits.contains('.') {
        true => digits.trim_end_matches('0').trim_end_matches('.').to_string(),
        false => digits.to_string(),
    };
    match exponent.parse::<i32>() {
        Ok(power @ -4..=6) => bare(&format!("{x:.*}", usize::try_from(digits as i32 - 1 - power).unwrap_or(0))),
        _ => format!("{}e{exponent}", bare(mantissa)),
    }
}

/// A count with its noun: `1 node`, `2 nodes`, `0 nodes`.
#[must_use]
pub fn counted(count: u64, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_that_people_read() {
        let rows = [
            (0.0, "0"),
            (-0.0, "0"),
            (1.0, "1"),
            (-2.5, "-2.5"),
            (0.1 + 0.2, "0.3"),
            (1.0 / 60.0, "0.0166667"),
            (123_456.789, "123457"),
            (1_234_567.8, "1234570"),
            (0.000_1, "0.0001"),
            (0.000_012_345_678, "1.23457e-5"),
            (1.234_567_8e30, "1.23457e30"),
            (-4e100, "-4e100"),
            (5e-324, "4.94066e-324"),
            (f64::MAX, "1.79769e308"),
            (f64::NAN, "not a number"),
            (f64::NEG_INFINITY, "-infinite"),
        ];
        for (x, text) in rows {
            assert_eq!(number(x), text);
        }
        assert_eq!([rounded(1234.5, 2), rounded(0.098_76, 3), rounded(2.0, 4)], ["1200", "0.0988", "2"]);
    }

    #[test]
    fn one_of_a_kind_stands_in_the_singular() {
        assert_eq!([0, 1, 2].map(|n| counted(n, "body", "bodies")), ["0 bodies", "1 body", "2 bodies"]);
    }
}
