//! The lowest natural frequencies: K φ = ω² M φ.
//!
//! A block Lanczos recurrence on (K + s M)⁻¹ M, whose largest eigenvalues 1/(ω² + s) belong to the lowest frequencies. A
//! block of several vectors finds frequencies that occur more than once, as those of round bodies do; every vector is made
//! orthogonal to all before it (twice), so that no frequency is found again. The shift s > 0 lets K be singular, as that of
//! a free body is.
//!
//! Source: Grimes, Lewis, Simon 1994; Parlett, *The symmetric eigenvalue problem*, 13.

use crate::dense::symmetric_eigen;
use crate::dot;

/// One natural frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// ω² [1/s²]; negative where the state is unstable.
    pub square: f64,
    /// The shape φ with φᵀMφ = 1.
    pub shape: Vec<f64>,
    /// |K φ − ω² M φ| in the norm of the inverse lumped masses [1/s²].
    pub residual: f64,
}

/// A vector, and M times it.
struct Weighed {
    vector: Vec<f64>,
    momentum: Vec<f64>,
}

/// Vectors of a block.
const BLOCK: usize = 6;

/// The lowest `count` modes, those in `skip` (M-orthonormal shapes that are already known) left out.
///
/// `mass` holds lumped masses, zero where a coordinate is held: sizes of residuals are told by them. `weigh` makes M x, `solve`
/// makes (K + s M)⁻¹ b of b in place, `stiffness` makes K x; M has neither rows nor columns of what is held. The search ends when every residual is below 10⁻¹⁰ (ω² + s), or when the space is exhausted.
pub fn lowest_modes(
    count: usize,
    mass: &[f64],
    shift: f64,
    skip: &[Vec<f64>],
    weigh: impl Fn(&[f64], &mut [f64]),
    mut solve: impl FnMut(&mut [f64]),
    mut stiffness: impl FnMut(&[f64], &mut [f64]),
) -> Vec<Mode> {
    let freedom = mass.iter().filter(|m| **m > 0.0).count().saturating_sub(skip.len());
    let count = count.min(freedom);
    let most = (3 * count + 60).min(freedom);
    let weighed = |x: &[f64]| {
        let mut out = vec![0.0; x.len()];
        weigh(x, &mut out);
        out
    };
    let skip: Vec<Weighed> = skip.iter().map(|x| Weighed { momentum: weighed(x), vector: x.clone() }).collect();
    let mut basis: Vec<Weighed> = Vec::new();
    // (K + s M)⁻¹ M of each vector of the basis.
    let mut images: Vec<Vec<f64>> = Vec::new();
    let mut block: Vec<Vec<f64>> = (0..BLOCK.min(freedom)).map(|k| start(mass, k)).collect();
    let mut seed = BLOCK;
    let mut best = Vec::new();
    while basis.len() < most {
        let mut fresh = 0;
        for mut vector in std::mem::take(&mut block) {
            if basis.len() == most {
                break;
            }
            // A vector that is spent is replaced by a new one.
            let mut attempts = 0;
            while !orthonormalise(&mut vector, &weighed, &skip, &basis) && attempts < 4 {
                vector = start(mass, seed);
                seed += 1;
                attempts += 1;
            }
            if attempts == 4 {
                continue;
            }
            let momentum = weighed(&vector);
            let mut image = momentum.clone();
            solve(&mut image);
            for (entry, m) in image.iter_mut().zip(mass) {
                *entry = if *m > 0.0 { *entry } else { 0.0 };
            }
            block.push(image.clone());
            basis.push(Weighed { vector, momentum });
            images.push(image);
            fresh += 1;
        }
        if fresh == 0 {
            break;
        }
        if basis.len() >= count {
            best = ritz(count, mass, &basis, &images, &weighed, &mut stiffness);
            if best.iter().all(|mode| mode.residual <= 1e-10 * (mode.square.abs() + shift)) {
                break;
            }
        }
    }
    best
}

/// The best approximations within a basis.
fn ritz(
    count: usize,
    mass: &[f64],
    basis: &[Weighed],
    images: &[Vec<f64>],
    weighed: &impl Fn(&[f64]) -> Vec<f64>,
    stiffness: &mut impl FnMut(&[f64], &mut [f64]),
) -> Vec<Mode> {
    let n = basis.len();
    let mut projected = vec![0.0; n * n];
    for i in 0..n {
        for j in 0..n {
            projected[i * n + j] = dot(&basis[i].momentum, &images[j]);
        }
    }
    for i in 0..n {
        for j in 0..i {
            let mean = 0.5 * (projected[i * n + j] + projected[j * n + i]);
            (projected[i * n + j], projected[j * n + i]) = (mean, mean);
        }
    }
    let (_, vectors) = symmetric_eigen(&projected, n);
    let mut modes = Vec::with_capacity(count);
    for k in 0..count {
        let weights = &vectors[n - 1 - k];
        let mut shape = vec![0.0; mass.len()];
        for (weight, vector) in weights.iter().zip(basis) {
            for (out, v) in shape.iter_mut().zip(&vector.vector) {
                *out += weight * v;
            }
        }
        let mut force = vec![0.0; mass.len()];
        stiffness(&shape, &mut force);
        // Rayleigh's quotient, which does not lose the digits that 1/θ − s would.
        let square = dot(&shape, &force);
        let mut residual = 0.0;
        for ((f, x), m) in force.iter().zip(&weighed(&shape)).zip(mass) {
            if *m > 0.0 {
                let rest = f - square * x;
                residual += rest * rest / m;
            }
        }
        modes.push(Mode { square, shape, residual: residual.sqrt() });
    }
    modes.sort_by(|a, b| a.square.total_cmp(&b.square));
    modes
}

/// Makes a vector orthogonal to others and of length one, in the scalar product of M; false if nothing is left of it.
fn orthonormalise(
    vector: &mut [f64],
    weighed: &impl Fn(&[f64]) -> Vec<f64>,
    skip: &[Weighed],
    basis: &[Weighed],
) -> bool {
    let norm = |v: &[f64]| dot(v, &weighed(v)).sqrt();
    let before = norm(vector);
    if !(before > 0.0 && before.is_finite()) {
        return false;
    }
    vector.iter_mut().for_each(|v| *v /= before);
    for _ in 0..2 {
        for other in skip.iter().chain(basis) {
            let along = dot(vector, &other.momentum);
            for (v, o) in vector.iter_mut().zip(&other.vector) {
                *v -= along * o;
            }
        }
    }
    let after = norm(vector);
    if after < 1e-10 {
        return false;
    }
    vector.iter_mut().for_each(|v| *v /= after);
    true
}

/// A vector of pseudo-random entries, always the same for the same number.
fn start(mass: &[f64], number: usize) -> Vec<f64> {
    let entry = |(k, m): (usize, &f64)| {
        // SplitMix64 (Steele, Lea, Flood 2014).
        let mut z = ((number + 1) as u64 * 0x51_7c_c1_b7 + k as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        let random = ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0;
        if *m > 0.0 { random } else { 0.0 }
    };
    mass.iter().enumerate().map(entry).collect()
}
