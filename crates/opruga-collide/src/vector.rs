//! Vectors of numbers or of lanes.

use opruga_math::{Lane, lanes};

/// The lowest and the highest corner of a box.
pub(crate) type Bounds<const D: usize> = [[f64; D]; 2];

/// A box, enlarged by a distance [m] on all sides.
pub(crate) fn wider<const D: usize>([mut low, mut high]: Bounds<D>, distance: f64) -> Bounds<D> {
    for d in 0..D {
        low[d] -= distance;
        high[d] += distance;
    }
    [low, high]
}

/// A box, moved by a displacement [m].
pub(crate) fn shifted<const D: usize>(own: Bounds<D>, by: &[f64; D]) -> Bounds<D> {
    own.map(|corner| add(&corner, by))
}

/// The distance between two boxes along the axis where it is largest [m]; negative if they overlap.
#[inline]
pub(crate) fn apart<const D: usize>([low_a, high_a]: &Bounds<D>, [low_b, high_b]: &Bounds<D>) -> f64 {
    let mut most = f64::NEG_INFINITY;
    for d in 0..D {
        most = (low_a[d] - high_b[d]).larger(low_b[d] - high_a[d]).larger(most);
    }
    most
}

/// The scalar product.
#[inline(always)]
pub(crate) fn dot<S: Lane, const D: usize>(a: &[S; D], b: &[S; D]) -> S {
    let mut sum = a[0] * b[0];
    for d in 1..D {
        sum += a[d] * b[d];
    }
    sum
}
/// a + b.
#[inline(always)]
pub(crate) fn add<S: Lane, const D: usize>(a: &[S; D], b: &[S; D]) -> [S; D] {
    lanes!(S, d => a[d] + b[d])
}
/// a − b.
#[inline(always)]
pub(crate) fn subtract<S: Lane, const D: usize>(a: &[S; D], b: &[S; D]) -> [S; D] {
    lanes!(S, d => a[d] - b[d])
}
/// s a.
#[inline(always)]
pub(crate) fn scaled<S: Lane, const D: usize>(a: &[S; D], s: S) -> [S; D] {
    lanes!(S, d => a[d] * s)
}
/// The same vector in every lane.
#[inline(always)]
pub(crate) fn splat<S: Lane, const D: usize>(a: &[f64; D]) -> [S; D] {
    lanes!(S, d => S::splat(a[d]))
}
/// `yes` where the mask is true, otherwise `no`.
#[inline(always)]
pub(crate) fn choose<S: Lane, const D: usize>(mask: S::Mask, yes: &[S; D], no: &[S; D]) -> [S; D] {
    lanes!(S, d => S::select(mask, yes[d], no[d]))
}
/// The length.
#[inline(always)]
pub(crate) fn length<S: Lane, const D: usize>(a: &[S; D]) -> S {
    dot(a, a).sqrt()
}
/// Multiplies a matrix, given by its rows, by a vector.
#[inline(always)]
pub(crate) fn turned<S: Lane, const D: usize>(rows: &[[f64; D]; D], a: &[S; D]) -> [S; D] {
    lanes!(S, d => dot(&splat(&rows[d]), a))
}
/// Multiplies the transpose of a matrix, given by its rows, by a vector.
pub(crate) fn turned_back<const D: usize>(rows: &[[f64; D]; D], a: &[f64; D]) -> [f64; D] {
    let mut out = [0.0; D];
    for i in 0..D {
        for j in 0..D {
            out[i] += rows[j][i] * a[j];
        }
    }
    out
}
/// The product of two matrices, given by their rows.
pub(crate) fn product<const D: usize>(a: &[[f64; D]; D], b: &[[f64; D]; D]) -> [[f64; D]; D] {
    let mut out = [[0.0; D]; D];
    for i in 0..D {
        for j in 0..D {
            for k in 0..D {
                out[i][j] += a[i][k] * b[k][j];
            }
        }
    }
    out
}
/// The unit matrix.
pub(crate) fn identity<const D: usize>() -> [[f64; D]; D] {
    let mut out = [[0.0; D]; D];
    for d in 0..D {
        out[d][d] = 1.0;
    }
    out
}
/// The sum of the absolute values.
pub(crate) fn magnitude<const D: usize>(a: &[f64; D]) -> f64 {
    let mut sum = 0.0;
    for x in a {
        sum += x.abs();
    }
    sum
}
/// The matrix Ω for which Ω r is the velocity of a rotating body at r. The matrix is made from one number in 2D and from a vector along the axis in
/// 3D.
pub(crate) fn turning<const D: usize>(spin: &[f64]) -> [[f64; D]; D] {
    let mut out = [[0.0; D]; D];
    if D == 2 {
        out[0][1] = -spin[0];
        out[1][0] = spin[0];
    } else {
        for d in 0..D {
            out[d][(d + 1) % D] = -spin[(d + 2) % D];
            out[(d + 1) % D][d] = spin[(d + 2) % D];
        }
    }
    out
}
/// The rotation exp(Ω t): 1 + sin φ K + (1 − cos φ) K² with φ = |ω| t and K = Ω/|ω| (Rodrigues; in 2D K² = −1).
pub(crate) fn rotation<const D: usize>(omega: &[[f64; D]; D], time: f64) -> [[f64; D]; D] {
    let mut square = 0.0;
    for row in omega {
        square += 0.5 * dot(row, row);
    }
    let rate = square.sqrt();
    let mut out = identity();
    if rate > 0.0 {
        let mut k = *omega;
        for row in &mut k {
            *row = scaled(row, 1.0 / rate);
        }
        let kk = product(&k, &k);
        let (sin, cos) = (libm::sin(rate * time), libm::cos(rate * time));
        for i in 0..D {
            for j in 0..D {
                out[i][j] += sin * k[i][j] + (1.0 - cos) * kk[i][j];
            }
        }
    }
    out
}
/// Returns unit vectors that are perpendicular to a normal and to one another.
pub(crate) fn across<const D: usize>(normal: &[f64; D]) -> impl Iterator<Item = [f64; D]> {
    let mut out = [[0.0; D]; D];
    if D == 2 {
        (out[0][0], out[0][1]) = (-normal[1], normal[0]);
    } else {
        // The axis along which the normal has the smallest component.
        let least = (0..D).min_by(|i, j| normal[*i].abs().total_cmp(&normal[*j].abs())).unwrap_or(0);
        let (i, j) = ((least + 1) % 3, (least + 2) % 3);
        let size = (normal[i] * normal[i] + normal[j] * normal[j]).sqrt();
        (out[0][i], out[0][j]) = (-normal[j] / size, normal[i] / size);
        let (a, b) = (*normal, out[0]);
        (0..3).for_each(|d| out[1][d] = a[(d + 1) % 3] * b[(d + 2) % 3] - a[(d + 2) % 3] * b[(d + 1) % 3]);
    }
    out.into_iter().take(D - 1)
}
