//! How quadrilaterals and hexahedra resist the motions that do not change their mean deformation.
//!
//! The displacement of a cell with N corners is affine except for N − 1 − D *hourglass* modes. The amplitudes of these modes, gₐ
//! = Σ xₐ γₐ, belong to vectors γ orthogonal to all affine fields (Flanagan and Belytschko 1981). At small strain, the strain ε
//! of these modes is the strain of an assumed stress. The strain follows from stress fields s that bend and twist a box exactly
//! (Pian and Sumihara 1984 in the plane, Pian and Tong 1986 in space; here without their mean) and from the compliance of
//! Hooke's law,
//!
//! ε = C⁻¹ Σ s β,  β = H⁻¹ L g,  L = ∫ s : ∇h,  H = ∫ s : C⁻¹ s,
//!
//! whose energy is ½ g·Lᵀ H⁻¹ L g. No combination of the fields is a pure pressure, so the energy stays finite as ν → 0.5. H⁻¹
//! contains the effect of free sides. The modulus of a box in bending is E in plane stress and E/(1 − ν²) in plane strain. The
//! strain ε is the strain of such bending.

use super::super::elements::{CORNERS, Shape, rest_gradient};
use super::corners::sums;

/// The number of hourglass modes of a hexahedron.
pub(super) const MOST_MODES: usize = 4;

/// The number of assumed stresses of a hexahedron. This number equals the number of amplitudes, modes times axes.
pub(super) const MOST_STRESSES: usize = 12;

/// The number of functions of the assumed stresses of a hexahedron.
pub(super) const FIELDS: usize = 6;

/// The number of pairs of axes of a hexahedron.
pub(super) const PAIRS: usize = 6;

/// The pairs of axes of a cell. The assumed stresses are symmetric products of such pairs of axes. In the plane none of these
/// stresses is a shear.
pub(super) const PAIR: [(usize, usize); PAIRS] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];

/// The axes whose coordinates a function of an assumed stress multiplies.
const FIELD: [&[usize]; FIELDS] = [&[0], &[1], &[2], &[1, 2], &[2, 0], &[0, 1]];

/// The pair of axes and the function of an assumed stress. The stresses of one function are consecutive. A function multiplies
/// stresses along the axes whose coordinates the function does not contain.
pub(super) const fn term<const D: usize>(stress: usize) -> (usize, usize) {
    let of_space = [(1, 0), (2, 0), (4, 0), (2, 1), (0, 1), (5, 1), (0, 2), (1, 2), (3, 2), (0, 3), (1, 4), (2, 5)];
    if D == 2 { (1 - stress, stress) } else { of_space[stress] }
}

/// The first stress of a function, and its axes. If there are two different axes, the first stress acts along the first axis,
/// the second along the second axis, and the third is that of both.
pub(super) const fn axes_of_field<const D: usize>(field: usize) -> (usize, [usize; 2]) {
    match (D, field) {
        (2, _) => (field, [1 - field; 2]),
        (_, 0..3) => (3 * field, [(field + 1) % 3, (field + 2) % 3]),
        _ => (field + 6, [field - 3; 2]),
    }
}

/// The number of hourglass modes of a cell with N corners.
pub(super) const fn modes<const D: usize, const N: usize>() -> usize {
    N - 1 - D
}

/// The number of functions of the assumed stresses.
pub(super) const fn fields<const D: usize>() -> usize {
    if D == 2 { 2 } else { FIELDS }
}

/// The number of pairs of axes in the assumed stresses.
pub(super) const fn pairs<const D: usize>() -> usize {
    if D == 2 { 2 } else { PAIRS }
}

/// How many numbers describe the geometry of a cell: the shares of the functions (row by row), the measures of its points, the
/// means of the functions of the stresses, and its axes.
pub(super) const fn stored<const D: usize, const N: usize>() -> usize {
    measures_at::<N>() + N + fields::<D>() + D * D
}

/// The offset of the measures of the points in these data.
pub(super) const fn measures_at<const N: usize>() -> usize {
    (N - 1) * (N - 1)
}

/// Values below this fraction of the largest value of their kind count as rounding errors, such as differences between equal
/// cells of a grid.
pub(super) const ROUNDING: f64 = 1.0 / (1u64 << 42) as f64;

/// How many numbers describe the material of a cell: X = H⁻¹ L row by row, c, λ − λ′, and kₐ.
pub(super) const fn stiffness_numbers<const D: usize, const N: usize>() -> usize {
    let size = modes::<D, N>() * D;
    size * size + 2 + modes::<D, N>()
}

/// The functions of the assumed stresses at the Gauss points of the corners, without subtraction of their means.
pub(super) const SIGNS: [[f64; FIELDS]; 8] = {
    let mut out = [[1.0; FIELDS]; 8];
    let mut corner = 0;
    while corner < 8 {
        let mut field = 0;
        while field < FIELDS {
            let (axes, mut k) = (FIELD[field], 0);
            while k < axes.len() {
                out[corner][field] *= CORNERS[corner][axes[k]];
                k += 1;
            }
            field += 1;
        }
        corner += 1;
    }
    out
};

/// The axes whose coordinates an hourglass function multiplies.
const fn axes<const D: usize>(mode: usize) -> &'static [usize] {
    if D == 2 {
        return &[0, 1];
    }
    match mode {
        0 => &[1, 2],
        1 => &[2, 0],
        2 => &[0, 1],
        _ => &[0, 1, 2],
    }
}

fn product(corner: usize, axes: &[usize]) -> f64 {
    axes.iter().map(|axis| CORNERS[corner][*axis]).product()
}

/// A cell at rest.
#[derive(Debug)]
pub(super) struct Rest<const D: usize, const N: usize> {
    /// For every function except 1, the share of its sum Σ ±x over the corners in the mean of ∂x/∂X (D columns [1/m]) and in the
    /// hourglass amplitudes.
    pub(super) shares: [[f64; N]; N],
    /// The measures of the Gauss points [m³].
    pub(super) measures: [f64; N],
    /// The means of the functions of the assumed stresses.
    pub(super) means: [f64; FIELDS],
    /// The axes ∂X/∂ξ at the centre, in columns [m].
    pub(super) axes: [[f64; D]; D],
    /// The ratio kₐ/μ [m]: the measure over the squares of the axes that the hourglass function multiplies.
    pub(super) guards: [f64; MOST_MODES],
    /// L.
    work: [[f64; MOST_STRESSES]; MOST_STRESSES],
    /// ∫ s : s and ∫ tr s tr s.
    inner: [[f64; MOST_STRESSES]; MOST_STRESSES],
    trace: [[f64; MOST_STRESSES]; MOST_STRESSES],
}

impl<const D: usize, const N: usize> Rest<D, N> {
    /// Computes the data from the corners of a cell whose determinants at the Gauss points and at the centre are positive.
    pub(super) fn new<E: Shape<D, N>>(corners: &[[f64; D]; N], thickness: f64) -> Self {
        let modes = modes::<D, N>();
        // ∂Nₐ/∂X and the measures at the Gauss points.
        let mut slopes = [[[0.0; D]; N]; N];
        let mut measures = [0.0; N];
        for q in 0..N {
            let (inverse, determinant) = rest_gradient(corners, &E::SLOPES[q]);
            measures[q] = E::WEIGHTS[q] * determinant * thickness;
            for a in 0..N {
                for j in 0..D {
                    slopes[q][a][j] = (0..D).map(|k| E::SLOPES[q][a][k] * inverse[k][j]).sum();
                }
            }
        }
        let measure: f64 = measures.iter().sum();
        let shares = shares(corners, &slopes, &measures);
        let (at_middle, size) = (E::at([0.0; 3]).1, modes * D);
        let mut jacobian = [[0.0; D]; D];
        for i in 0..D {
            for k in 0..D {
                jacobian[i][k] = (0..N).map(|a| corners[a][i] * at_middle[a][k]).sum();
            }
        }
        let mut means = [0.0; FIELDS];
        for (field, mean) in means.iter_mut().enumerate().take(fields::<D>()) {
            let own = (0..N).map(|q| measures[q] * SIGNS[q][field]).sum::<f64>() / measure;
            *mean = if own.abs() > ROUNDING { own } else { 0.0 };
        }
        let mut tensors = [[[0.0; D]; D]; MOST_STRESSES];
        let mut values = [[0.0; N]; MOST_STRESSES];
        for s in 0..size {
            let (pair, field) = term::<D>(s);
            let (a, b) = PAIR[pair];
            for i in 0..D {
                for j in 0..D {
                    tensors[s][i][j] = 0.5 * (jacobian[i][a] * jacobian[j][b] + jacobian[i][b] * jacobian[j][a]);
                }
            }
            values[s] = core::array::from_fn(|q| SIGNS[q][field] - means[field]);
        }
        let mut guards = [0.0; MOST_MODES];
        for (mode, guard) in guards.iter_mut().enumerate().take(modes) {
            let square = |axis: usize| (0..D).map(|i| jacobian[i][axis] * jacobian[i][axis]).sum::<f64>();
            *guard = measure / axes::<D>(mode).iter().map(|axis| square(*axis)).sum::<f64>();
        }
        let none = [[0.0; MOST_STRESSES]; MOST_STRESSES];
        let (work, inner, trace) = (none, none, none);
        let mut rest = Rest { shares, measures, means, axes: jacobian, guards, work, inner, trace };
        for s in 0..size {
            for mode in 0..modes {
                // ∫ f ∂h/∂X for the function f of the stress.
                let mut mean = [0.0; D];
                for q in 0..N {
                    for a in 0..N {
                        let share = measures[q] * values[s][q] * product(a, axes::<D>(mode));
                        for j in 0..D {
                            mean[j] += share * slopes[q][a][j];
                        }
                    }
                }
                for i in 0..D {
                    rest.work[s][mode * D + i] = (0..D).map(|j| tensors[s][i][j] * mean[j]).sum();
                }
            }
            for t in 0..size {
                let both: f64 = (0..N).map(|q| measures[q] * values[s][q] * values[t][q]).sum();
                let trace = |s: usize| (0..D).map(|i| tensors[s][i][i]).sum::<f64>();
                let inner: f64 =
                    tensors[s].as_flattened().iter().zip(tensors[t].as_flattened()).map(|(a, b)| a * b).sum();
                rest.inner[s][t] = inner * both;
                rest.trace[s][t] = trace(s) * trace(t) * both;
            }
        }
        rest
    }

    /// X = H⁻¹ L, row by row, for a law whose strain is (s − c tr s 1)/2μ. Each β is divided by 2μ.
    pub(super) fn response(&self, c: f64) -> Vec<f64> {
        let size = modes::<D, N>() * D;
        // H = A Aᵀ.
        let mut factor = [[0.0; MOST_STRESSES]; MOST_STRESSES];
        let mut out = self.work;
        for i in 0..size {
            for j in 0..=i {
                let inner: f64 = (0..j).map(|k| factor[i][k] * factor[j][k]).sum();
                let rest = self.inner[i][j] - c * self.trace[i][j] - inner;
                factor[i][j] = if i == j { rest.sqrt() } else { rest / factor[j][j] };
            }
        }
        for column in 0..size {
            for i in 0..size {
                let done: f64 = (0..i).map(|k| factor[i][k] * out[k][column]).sum();
                out[i][column] = (out[i][column] - done) / factor[i][i];
            }
            for i in (0..size).rev() {
                let done: f64 = (i + 1..size).map(|k| factor[k][i] * out[k][column]).sum();
                out[i][column] = (out[i][column] - done) / factor[i][i];
            }
        }
        let mut rows: Vec<f64> = out[..size].iter().flat_map(|row| row[..size].to_vec()).collect();
        for row in rows.chunks_mut(size) {
            let largest = row.iter().fold(0.0, |most: f64, x| if x.abs() > most { x.abs() } else { most });
            row.iter_mut().filter(|x| x.abs() <= ROUNDING * largest).for_each(|x| *x = 0.0);
        }
        rows
    }
}

/// The shares of the functions in the mean gradient and the hourglass amplitudes.
fn shares<const D: usize, const N: usize>(
    corners: &[[f64; D]; N],
    slopes: &[[[f64; D]; N]; N],
    measures: &[f64; N],
) -> [[f64; N]; N] {
    let modes = modes::<D, N>();
    let measure: f64 = measures.iter().sum();
    let mut weights = [[0.0; N]; N];
    for a in 0..N {
        for j in 0..D {
            weights[a][j] = (0..N).map(|q| measures[q] * slopes[q][a][j]).sum::<f64>() / measure;
        }
    }
    // The hourglass functions without their affine parts, scaled so that mode α has the amplitude 1.
    let mut rows = vec![vec![0.0; modes + N]; modes];
    for (mode, row) in rows.iter_mut().enumerate() {
        let h: [f64; N] = core::array::from_fn(|a| product(a, axes::<D>(mode)));
        let along: [f64; D] = core::array::from_fn(|j| (0..N).map(|a| h[a] * corners[a][j]).sum());
        for a in 0..N {
            row[modes + a] = h[a] - (0..D).map(|j| along[j] * weights[a][j]).sum::<f64>();
        }
        for other in 0..modes {
            row[other] = (0..N).map(|a| row[modes + a] * product(a, axes::<D>(other))).sum();
        }
    }
    eliminate(&mut rows);
    for (mode, row) in rows.iter().enumerate() {
        for a in 0..N {
            weights[a][D + mode] = row[modes + a];
        }
    }
    // All columns are invariant under translations, so each is a sum of the functions other than 1.
    let mut shares = [[0.0; N]; N];
    for c in 0..N - 1 {
        let column = sums(&core::array::from_fn::<f64, N, _>(|a| weights[a][c] / N as f64));
        let largest = column[1..].iter().fold(0.0, |most: f64, x| if x.abs() > most { x.abs() } else { most });
        for (w, share) in column[1..].iter().enumerate() {
            shares[w][c] = if share.abs() > ROUNDING * largest { *share } else { 0.0 };
        }
    }
    shares
}

/// Reduces the first columns to the unit matrix (Gauss–Jordan with the largest pivot).
fn eliminate(rows: &mut [Vec<f64>]) {
    for k in 0..rows.len() {
        let mut best = k;
        for r in k + 1..rows.len() {
            best = if rows[r][k].abs() > rows[best][k].abs() { r } else { best };
        }
        rows.swap(k, best);
        let pivot = rows[k][k];
        rows[k].iter_mut().for_each(|x| *x /= pivot);
        let own = rows[k].clone();
        for (r, row) in rows.iter_mut().enumerate() {
            let factor = row[k];
            if r != k {
                row.iter_mut().zip(&own).for_each(|(x, y)| *x -= factor * y);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::elements::{Hexahedron, Quadrilateral};
    use super::*;

    /// 2μ Lᵀ H⁻¹ L.
    fn stiffness<const D: usize, const N: usize>(rest: &Rest<D, N>, mu: f64, c: f64) -> Vec<Vec<f64>> {
        let (size, response) = (modes::<D, N>() * D, rest.response(c));
        let entry = |r: usize, t: usize| (0..size).map(|s| rest.work[s][r] * response[s * size + t]).sum::<f64>();
        (0..size).map(|r| (0..size).map(|t| 2.0 * mu * entry(r, t)).collect()).collect()
    }

    /// A box of a × b that bends to the curvature κ, u = (κ x y, …), has the energy E I κ²/2 per length with I = t b³/12.
    #[test]
    fn a_box_bends_as_a_beam_does() {
        let (a, b, mu) = (0.7, 0.2, 3.0);
        let corners: [[f64; 2]; 4] = core::array::from_fn(|k| [0.5 * a * CORNERS[k][0], 0.5 * b * CORNERS[k][1]]);
        let rest = Rest::new::<Quadrilateral>(&corners, 0.5);
        for ratio in [0.0, 0.3, 0.4999] {
            let young = 2.0 * mu * (1.0 + ratio);
            for (c, modulus) in [(ratio, young / (1.0 - ratio * ratio)), (ratio / (1.0 + ratio), young)] {
                let stiffness = stiffness(&rest, mu, c);
                // With x = aξ/2 and y = bη/2, the amplitude of κ x y is κ a b/4.
                let amplitude: f64 = 0.25 * a * b;
                let energy = 0.5 * stiffness[0][0] * amplitude * amplitude;
                let expected = 0.5 * modulus * (0.5 * b * b * b / 12.0) * a;
                assert!((energy / expected - 1.0).abs() < 1e-12, "ν = {ratio}: {energy} {expected}");
                assert!(stiffness[0][1].abs() < 1e-12 * stiffness[0][0]);
            }
        }
    }

    /// In space, a box that bends along x alone has the stiffness E/(1 − ν²). If it may also curve in the other direction, its
    /// stiffness is E.
    #[test]
    fn a_block_bends_as_a_plate_and_as_a_beam() {
        let (sides, mu, ratio) = ([0.7, 0.4, 0.2], 3.0, 0.4999);
        let corners: [[f64; 3]; 8] = core::array::from_fn(|k| core::array::from_fn(|d| 0.5 * sides[d] * CORNERS[k][d]));
        let rest = Rest::new::<Hexahedron>(&corners, 1.0);
        let stiffness = stiffness(&rest, mu, ratio / (1.0 + ratio));
        let young = 2.0 * mu * (1.0 + ratio);
        let [a, b, c] = sides;
        // u_x = κ x z: mode 1, axis 0; u_y = −νκ y z: mode 0, axis 1.
        let (along, across) = (3, 1);
        let (p, q) = (0.25 * a * c, -ratio * 0.25 * b * c);
        let inertia = b * c * c * c / 12.0 * a;
        let plate = stiffness[along][along] * p * p;
        assert!((plate / (young / (1.0 - ratio * ratio) * inertia) - 1.0).abs() < 1e-12, "{plate}");
        let beam = plate + 2.0 * stiffness[along][across] * p * q + stiffness[across][across] * q * q;
        assert!((beam / (young * inertia) - 1.0).abs() < 1e-10, "{beam}");
    }

    /// Hourglass vectors vanish on affine fields and give the amplitudes of the hourglass functions. Every mode has stiffness,
    /// even in skewed and tapered cells.
    #[test]
    fn no_cell_is_without_stiffness() {
        let mut random = 5u64;
        for _ in 0..200 {
            let corners: [[f64; 3]; 8] = core::array::from_fn(|k| {
                core::array::from_fn(|d| {
                    random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                    CORNERS[k][d] + 0.45 * ((random >> 11) as f64 / (1u64 << 52) as f64 - 1.0)
                })
            });
            let rest = Rest::new::<Hexahedron>(&corners, 1.0);
            for mode in 0..4 {
                let amplitude = |at: &dyn Fn(usize) -> f64| -> f64 {
                    let sums = sums(&core::array::from_fn::<f64, 8, _>(at));
                    (0..7).map(|w| rest.shares[w][3 + mode] * sums[1 + w]).sum()
                };
                for d in 0..4 {
                    let seen = amplitude(&|a| if d == 3 { 1.0 } else { corners[a][d] });
                    assert!(seen.abs() < 1e-13, "{seen:e}");
                    let own = amplitude(&|a| product(a, axes::<3>(d)));
                    assert!((own - f64::from(u8::from(d == mode))).abs() < 1e-13);
                }
            }
            // The sum of the inverses of the eigenvalues, which bounds each inverse.
            let mut rows = stiffness(&rest, 1.0, 0.4999 / 1.4999);
            for (r, row) in rows.iter_mut().enumerate() {
                row.extend((0..12).map(|k| f64::from(u8::from(k == r))));
            }
            eliminate(&mut rows);
            let inverse: f64 = (0..12).map(|k| rows[k][12 + k]).sum();
            assert!(inverse > 0.0 && inverse < 400.0, "{inverse}");
        }
    }
}
