//! A cluster at rest: columns that are orthonormal with respect to its masses. The cluster has as many columns as are linearly
//! independent on its nodes.

use opruga_math::Lane;

/// The largest number of columns: 3 coordinates and 6 products of them in space.
pub(super) const MOST_COLUMNS: usize = 9;

/// A column counts as dependent if the part of it that is independent of the previous columns is below this fraction of the size
/// of the cluster.
const OWN: f64 = 1e-7;

/// A cluster of one body at rest.
#[derive(Debug)]
pub(super) struct Shape<const D: usize> {
    /// φₖ of every node [1/√kg], `[k][node]`: Σ m φₖ = 0 and Σ m φₖ φₗ = δₖₗ. It is zero if column k depends on the previous
    /// ones.
    pub(super) columns: Vec<Vec<f64>>,
    /// L [m √kg] with q = Σₖ Lₖ φₖ over the first D columns, `[axis][k]`.
    pub(super) frame: [[f64; D]; D],
    /// Mass [kg].
    pub(super) mass: f64,
}

impl<const D: usize> Shape<D> {
    /// Makes the shape from the rest positions of nodes and their masses in the cluster [kg].
    pub(super) fn new(positions: &[[f64; D]], masses: &[f64], quadratic: bool) -> Shape<D> {
        let mass: f64 = masses.iter().sum();
        let centered = |mut column: Vec<f64>| {
            let mean = column.iter().zip(masses).map(|(x, m)| m * x).sum::<f64>() / mass;
            column.iter_mut().for_each(|x| *x -= mean);
            column
        };
        // q = X − X̄. It is computed from differences to one of the nodes, so that no digits are lost far from the origin.
        let from = positions[0];
        let linear: Vec<Vec<f64>> =
            (0..D).map(|d| centered(positions.iter().map(|x| x[d] - from[d]).collect())).collect();
        let square: f64 = linear.iter().map(|q| inner(masses, q, q)).sum();
        let radius = (square / mass).sqrt();
        let mut raw = linear.clone();
        if quadratic {
            let products = (0..D).map(|d| (d, d)).chain((0..D).flat_map(|a| (a + 1..D).map(move |b| (a, b))));
            // Products are computed in units of the radius of the cluster, so that all columns have the same magnitude.
            for (a, b) in products {
                let product = linear[a].iter().zip(&linear[b]).map(|(x, y)| x * y / radius).collect();
                raw.push(if radius > 0.0 { centered(product) } else { vec![0.0; positions.len()] });
            }
        }
        let size = square.sqrt();
        let mut columns: Vec<Vec<f64>> = Vec::new();
        for mut column in raw {
            // Two passes are enough (Kahan, Parlett 1980).
            for _ in 0..2 {
                for before in &columns {
                    let along = inner(masses, &column, before);
                    column.iter_mut().zip(before).for_each(|(x, y)| *x -= along * y);
                }
            }
            let length = inner(masses, &column, &column).sqrt();
            let factor = if length > OWN * size { 1.0 / length } else { 0.0 };
            column.iter_mut().for_each(|x| *x *= factor);
            columns.push(column);
        }
        let mut frame = [[0.0; D]; D];
        for d in 0..D {
            for k in 0..D {
                frame[d][k] = inner(masses, &linear[d], &columns[k]);
            }
        }
        Shape { columns, frame, mass }
    }
}

/// Σ m x y.
fn inner(masses: &[f64], x: &[f64], y: &[f64]) -> f64 {
    let mut sums = [0.0; opruga_math::WIDTH];
    for (k, ((m, x), y)) in masses.iter().zip(x).zip(y).enumerate() {
        sums[k % opruga_math::WIDTH] += m * x * y;
    }
    opruga_math::sum_in_fixed_order(&sums)
}

/// The tensor of inertia, Σ m (|q|² 1 − q qᵀ) in space and Σ m |q|² in the plane.
pub(super) fn inertia<const D: usize>(frame: &[[f64; D]; D]) -> [[f64; D]; D] {
    let outer = opruga_math::matrix::product_transposed(frame, frame);
    turned_trace(&outer)
}

/// (tr S) 1 − S.
pub(super) fn turned_trace<S: Lane, const D: usize>(s: &[[S; D]; D]) -> [[S; D]; D] {
    let trace = opruga_math::matrix::trace(s);
    let mut out = opruga_math::matrix::scaled(s, -S::one());
    for d in 0..D {
        out[d][d] += trace;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check<const D: usize>(positions: &[[f64; D]], quadratic: bool, rank: usize) {
        let masses: Vec<f64> = (0..positions.len()).map(|k| 1.0 + 0.3 * (k % 4) as f64).collect();
        let shape = Shape::new(positions, &masses, quadratic);
        let ones = vec![1.0; positions.len()];
        let mut there = 0;
        for (k, column) in shape.columns.iter().enumerate() {
            assert!(inner(&masses, column, &ones).abs() < 1e-12);
            for (l, other) in shape.columns.iter().enumerate() {
                let found = inner(&masses, column, other);
                if k == l {
                    there += usize::from(found > 0.5);
                    assert!((found - 1.0).abs() < 1e-12 || found == 0.0, "{found}");
                } else {
                    assert!(found.abs() < 1e-12, "{found}");
                }
            }
        }
        assert_eq!(there, rank);
        // q follows from the columns.
        for (node, x) in positions.iter().enumerate() {
            for d in 0..D {
                let mean = positions.iter().zip(&masses).map(|(x, m)| m * x[d]).sum::<f64>() / shape.mass;
                let sum: f64 = (0..D).map(|k| shape.frame[d][k] * shape.columns[k][node]).sum();
                assert!((x[d] - mean - sum).abs() < 1e-10, "{}", x[d] - mean - sum);
            }
        }
    }

    #[test]
    fn columns_are_orthonormal_and_as_many_as_the_nodes_tell_apart() {
        let cube: Vec<[f64; 3]> =
            (0..27).map(|k| [f64::from(k % 3), f64::from(k / 3 % 3) * 0.8, f64::from(k / 9) + 0.1]).collect();
        check(&cube, false, 3);
        check(&cube, true, 9);
        check(&cube[..9], true, 5);
        check(&cube[..3], false, 1);
        check(&cube[..2], true, 1);
        check(&cube[..1], true, 0);
        check(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]], false, 1);
        check(&[[1e6, 0.0], [1e6 + 1.0, 0.5], [1e6, 2.0], [1e6 + 2.0, 2.0]], true, 3);
    }
}
