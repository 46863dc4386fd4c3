//! Small square matrices: the part of one node in a large one.

/// A square block.
pub type Block<const D: usize> = [[f64; D]; D];

/// The unit matrix times a number.
#[inline(always)]
pub fn isotropic<const D: usize>(value: f64) -> Block<D> {
    let mut out = [[0.0; D]; D];
    for d in 0..D {
        out[d][d] = value;
    }
    out
}

/// The product A·x.
#[inline(always)]
pub fn times<const D: usize>(a: &Block<D>, x: &[f64; D]) -> [f64; D] {
    let mut out = [0.0; D];
    for i in 0..D {
        for j in 0..D {
            out[i] += a[i][j] * x[j];
        }
    }
    out
}

/// The product Aᵀ·x.
#[inline(always)]
pub fn transposed_times<const D: usize>(a: &Block<D>, x: &[f64; D]) -> [f64; D] {
    let mut out = [0.0; D];
    for i in 0..D {
        for j in 0..D {
            out[j] += a[i][j] * x[i];
        }
    }
    out
}

/// The product A·B.
#[inline(always)]
pub fn product<const D: usize>(a: &Block<D>, b: &Block<D>) -> Block<D> {
    let mut out = [[0.0; D]; D];
    for i in 0..D {
        for k in 0..D {
            for j in 0..D {
                out[i][j] += a[i][k] * b[k][j];
            }
        }
    }
    out
}

/// Subtracts A·Bᵀ from C.
#[inline(always)]
pub fn subtract_product_transposed<const D: usize>(c: &mut Block<D>, a: &Block<D>, b: &Block<D>) {
    for i in 0..D {
        for j in 0..D {
            for k in 0..D {
                c[i][j] -= a[i][k] * b[j][k];
            }
        }
    }
}

/// The lower triangle L with L Lᵀ = A; `None` if A is not positive definite.
#[inline]
pub fn lower<const D: usize>(a: &Block<D>) -> Option<Block<D>> {
    let mut l = [[0.0; D]; D];
    for i in 0..D {
        for j in 0..=i {
            let mut sum = a[i][j];
            for k in 0..j {
                sum -= l[i][k] * l[j][k];
            }
            if i == j {
                if !(sum > 0.0 && sum.is_finite()) {
                    return None;
                }
                l[i][i] = sum.sqrt();
            } else {
                l[i][j] = sum / l[j][j];
            }
        }
    }
    Some(l)
}

/// The inverse of a lower triangle.
#[inline]
pub fn inverse_of_lower<const D: usize>(l: &Block<D>) -> Block<D> {
    let mut out = [[0.0; D]; D];
    for j in 0..D {
        out[j][j] = 1.0 / l[j][j];
        for i in j + 1..D {
            let mut sum = 0.0;
            for k in j..i {
                sum -= l[i][k] * out[k][j];
            }
            out[i][j] = sum / l[i][i];
        }
    }
    out
}

/// The inverse of a block; `None` if it is not positive definite.
#[inline]
pub fn inverse_of_positive<const D: usize>(a: &Block<D>) -> Option<Block<D>> {
    let l = inverse_of_lower(&lower(a)?);
    let mut out = [[0.0; D]; D];
    for i in 0..D {
        for j in 0..D {
            for k in 0..D {
                out[i][j] += l[k][i] * l[k][j];
            }
        }
    }
    Some(out)
}

/// A block without the constrained directions, which get a diagonal of the same size: P A P + (1 − P) s.
#[inline]
pub fn constrained_block<const D: usize>(a: &Block<D>, projector: &Block<D>) -> Block<D> {
    let mut size = 0.0;
    for d in 0..D {
        size += a[d][d].abs() / D as f64;
    }
    let size = if size > 0.0 && size.is_finite() { size } else { 1.0 };
    let mut out = product(projector, &product(a, projector));
    let unit = isotropic::<D>(size);
    for i in 0..D {
        for j in 0..D {
            out[i][j] += unit[i][j] - size * projector[i][j];
        }
    }
    out
}

/// A long vector as the vectors of its nodes.
#[inline(always)]
pub fn nodes<const D: usize>(x: &[f64]) -> &[[f64; D]] {
    x.as_chunks::<D>().0
}

/// A mutable long vector as the vectors of its nodes.
#[inline(always)]
pub fn nodes_mut<const D: usize>(x: &mut [f64]) -> &mut [[f64; D]] {
    x.as_chunks_mut::<D>().0
}
