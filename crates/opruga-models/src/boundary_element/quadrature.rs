//! Gauss–Legendre rules.

/// Points and weights on the interval from 0 to 1.
#[derive(Clone, Debug)]
pub(super) struct Rule {
    pub(super) points: Vec<f64>,
    pub(super) weights: Vec<f64>,
}

/// Returns P_n and its derivative.
fn legendre(n: usize, x: f64) -> [f64; 2] {
    let (mut before, mut value) = (1.0, x);
    for k in 2..=n {
        let k = k as f64;
        (before, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k);
    }
    [value, n as f64 * (x * value - before) / (x * x - 1.0)]
}

impl Rule {
    /// The rule of n > 1 points, exact for polynomials of degree 2n − 1.
    pub(super) fn of(n: usize) -> Rule {
        // Between two neighbouring points of a fine grid the polynomial changes its sign at most once.
        let grid = 64 * n * n;
        let at = |k: usize| (k as f64 + 0.5) / grid as f64 * 2.0 - 1.0;
        let mut rule = Rule { points: Vec::new(), weights: Vec::new() };
        for k in 0..grid - 1 {
            if (legendre(n, at(k))[0] < 0.0) == (legendre(n, at(k + 1))[0] < 0.0) {
                continue;
            }
            let mut x = 0.5 * (at(k) + at(k + 1));
            for _ in 0..6 {
                let [value, slope] = legendre(n, x);
                x -= value / slope;
            }
            let slope = legendre(n, x)[1];
            rule.points.push(0.5 + 0.5 * x);
            rule.weights.push(1.0 / ((1.0 - x * x) * slope * slope));
        }
        rule
    }
}

/// Points of a simplex with D nodes in barycentric coordinates, and weights that sum to 1.
#[derive(Clone, Debug)]
pub(super) struct SimplexRule<const D: usize> {
    pub(super) points: Vec<([f64; D], f64)>,
}

impl<const D: usize> SimplexRule<D> {
    /// The rule with n points along each direction. In the plane, the result is the rule of an interval. In space, it is the
    /// rule of a square of which one side is collapsed to a corner of the triangle.
    pub(super) fn of(n: usize) -> SimplexRule<D> {
        let rule = Rule::of(n);
        let mut points = Vec::new();
        for (s, weight) in rule.points.iter().zip(&rule.weights) {
            if D == 2 {
                let mut shape = [0.0; D];
                (shape[0], shape[1]) = (1.0 - s, *s);
                points.push((shape, *weight));
                continue;
            }
            for (t, other) in rule.points.iter().zip(&rule.weights) {
                let mut shape = [1.0 - s; D];
                (shape[1], shape[2]) = (s * (1.0 - t), s * t);
                points.push((shape, 2.0 * s * weight * other));
            }
        }
        SimplexRule { points }
    }
    /// The rule for smooth integrands: 4 points of an interval; in a triangle, Radon's 7 points, exact to degree 5.
    pub(super) fn far() -> SimplexRule<D> {
        if D == 2 {
            return SimplexRule::of(4);
        }
        let root = 15.0_f64.sqrt();
        let mut points = vec![([1.0 / 3.0; D], 9.0 / 40.0)];
        for sign in [-1.0, 1.0] {
            let (own, weight) = ((6.0 + sign * root) / 21.0, (155.0 + sign * root) / 1200.0);
            for k in 0..D {
                let mut shape = [own; D];
                shape[k] = 1.0 - 2.0 * own;
                points.push((shape, weight));
            }
        }
        SimplexRule { points }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_are_exact_for_their_degree() {
        for n in [2, 4, 8, 12] {
            let rule = Rule::of(n);
            assert_eq!(rule.points.len(), n);
            for degree in 0..2 * n {
                let power = |x: f64| (0..degree).fold(1.0, |product, _| product * x);
                let sum: f64 = rule.points.iter().zip(&rule.weights).map(|(x, w)| w * power(*x)).sum();
                assert!((sum - 1.0 / (degree as f64 + 1.0)).abs() < 1e-14);
            }
        }
        for rule in [SimplexRule::<3>::far(), SimplexRule::of(4)] {
            // ∫ a² b over a triangle is 2 · 2! 1! / 5! of its area.
            let sum: f64 = rule.points.iter().map(|([a, b, _], w)| w * a * a * b).sum();
            assert!((sum - 4.0 / 120.0).abs() < 1e-15);
        }
    }
}
