//! Angles of the hinges, with the same bits on every machine.

use opruga_math::Lane;

/// Coefficients of (atan t)/t − 1 in t² for |t| < 7/16, to the last bit of a double (fdlibm, `s_atan.c`).
const SERIES: [f64; 11] = [
    3.333_333_333_333_293e-1,
    -1.999_999_999_987_648_3e-1,
    1.428_571_427_250_346_6e-1,
    -1.111_111_040_546_235_6e-1,
    9.090_887_133_436_507e-2,
    -7.691_876_205_044_83e-2,
    6.661_073_137_387_531e-2,
    -5.833_570_133_790_573_5e-2,
    4.976_877_994_615_932e-2,
    -3.653_157_274_421_691_6e-2,
    1.628_582_011_536_578_2e-2,
];

/// Returns the angle of the point (x, y) from the x axis, in −π … π, or zero at the origin.
#[inline(always)]
pub(super) fn angle<S: Lane>(y: S, x: S) -> S {
    let (ax, ay) = (x.abs(), y.abs());
    // The quotient of the smaller and the larger coordinate. It is reduced below tan(π/8) by atan t = π/4 + atan((t − 1)/(t +
    // 1)).
    let steep = ax.less(ay);
    let (low, high) = (S::select(steep, ax, ay), S::select(steep, ay, ax));
    let turned = (S::splat(0.414_213_562_373_095_03) * high).less(low);
    let over = S::select(turned, low - high, low);
    let under = S::select(turned, low + high, high);
    let t = over / S::select(S::zero().less(high), under, S::one());
    let z = t * t;
    let mut series = S::splat(SERIES[10]);
    for k in 1..SERIES.len() {
        series = series * z + S::splat(SERIES[10 - k]);
    }
    let small = t - t * (z * series);
    let mut angle = S::select(turned, S::splat(core::f64::consts::FRAC_PI_4) + small, small);
    angle = S::select(steep, S::splat(core::f64::consts::FRAC_PI_2) - angle, angle);
    angle = S::select(x.less(S::zero()), S::splat(core::f64::consts::PI) - angle, angle);
    S::select(y.less(S::zero()), -angle, angle)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angle_is_that_of_the_standard_library() {
        let mut worst: f64 = 0.0;
        for k in 0..100_000 {
            let phi = (k as f64 / 50_000.0 - 1.0) * core::f64::consts::PI;
            #[allow(clippy::disallowed_methods)] // the reference
            let (y, x) = (phi.sin() * 1e-7, phi.cos() * 1e-7);
            worst = Lane::larger((angle(y, x) - y.atan2(x)).abs(), worst);
        }
        assert!(worst <= 4.5e-16, "{worst:e}");
        for (y, x) in [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (-1.0, 0.0), (0.0, -1.0), (1.0, 1.0), (-1e-300, 1e300)] {
            assert_eq!(angle(y, x), f64::atan2(y, x), "{y} {x}");
        }
    }
}
