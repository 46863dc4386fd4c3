//! Stress at points of the solid: σ = ∫ D t dS − ∫ S u dS (Somigliana).
//!
//! For the stress at the point p, with r = y − p, ρ = |r|, e = r/ρ, the normal n in y, α = D − 1, β = D, γ = D + 2 and μ = 1,
//!
//! D_kij = [(1 − 2ν)(δ_ki e_j + δ_kj e_i − δ_ij e_k) + β e_i e_j e_k]/(4πα(1 − ν)ρ^α),
//! S_kij = {β e·n [(1 − 2ν)δ_ij e_k + ν(δ_ik e_j + δ_jk e_i) − γ e_i e_j e_k] + βν(n_i e_j e_k + n_j e_i e_k)
//!         + (1 − 2ν)(β n_k e_i e_j + n_j δ_ik + n_i δ_jk) − (1 − 4ν) n_k δ_ij}/(2πα(1 − ν)ρ^β).
//!
//! Source: Brebbia, Telles, Wrobel 1984, equations 5.3.5 to 5.3.7.

use super::integrals::Integrator;
use super::kernels::Kelvin;
use super::surface::Surface;
use core::f64::consts::PI;

/// The components of a stress in their order: xx, yy, xy, and zz, xz, yz in space.
pub(super) const fn components(dimensions: usize) -> &'static [(usize, usize, &'static str)] {
    const ALL: &[(usize, usize, &str)] =
        &[(0, 0, "xx"), (1, 1, "yy"), (0, 1, "xy"), (2, 2, "zz"), (0, 2, "xz"), (1, 2, "yz")];
    if dimensions == 2 { ALL.split_at(3).0 } else { ALL }
}

/// Returns the matrix from the displacements of the vertices to the stress, given the tractions due to each displacement.
/// The matrix has a row for every component of stress at every point.
pub(super) fn rows<const D: usize>(
    surface: &Surface<D>,
    kelvin: Kelvin,
    points: &[[f64; D]],
    height: usize,
    tractions: &[f64],
) -> Vec<Vec<f64>> {
    let mut out = Vec::new();
    let integrator = Integrator::new(kelvin);
    for point in points {
        for (i, j, _) in components(D) {
            let mut of_tractions = vec![0.0; height];
            let mut row = vec![0.0; surface.nodes * D];
            for ((facet, side), corners) in surface.facets.iter().zip(&surface.sides).zip(&surface.corners) {
                integrator.visit(point, side, &mut |r, shape, weight| {
                    let (pulled, moved) = kernels(kelvin, r, &side.normal, *i, *j);
                    for a in 0..D {
                        for k in 0..D {
                            of_tractions[corners[a] as usize * D + k] += weight * shape[a] * pulled[k];
                            row[facet[a] as usize * D + k] -= weight * shape[a] * moved[k];
                        }
                    }
                });
            }
            for (entry, column) in row.iter_mut().zip(tractions.chunks_exact(height)) {
                *entry += opruga_solve::dot(column, &of_tractions);
            }
            out.push(row);
        }
    }
    out
}

/// D_kij and S_kij of one component.
fn kernels<const D: usize>(kelvin: Kelvin, r: &[f64; D], n: &[f64; D], i: usize, j: usize) -> ([f64; D], [f64; D]) {
    let nu = kelvin.poisson;
    let length = r.iter().map(|x| x * x).sum::<f64>().sqrt();
    let e = r.map(|x| x / length);
    let (alpha, beta, gamma) = ((D - 1) as f64, D as f64, (D + 2) as f64);
    let power = if D == 2 { length } else { length * length };
    let whole = 1.0 / (4.0 * PI * alpha * (1.0 - nu) * power);
    let along: f64 = (0..D).map(|d| e[d] * n[d]).sum();
    let unit = |a: usize, b: usize| if a == b { 1.0 } else { 0.0 };
    let free = 1.0 - 2.0 * nu;
    let pulled = core::array::from_fn(|k| {
        whole * (free * (unit(k, i) * e[j] + unit(k, j) * e[i] - unit(i, j) * e[k]) + beta * e[i] * e[j] * e[k])
    });
    let moved = core::array::from_fn(|k| {
        let first =
            free * unit(i, j) * e[k] + nu * (unit(i, k) * e[j] + unit(j, k) * e[i]) - gamma * e[i] * e[j] * e[k];
        let second = beta * nu * (n[i] * e[j] * e[k] + n[j] * e[i] * e[k]);
        let third = free * (beta * n[k] * e[i] * e[j] + n[j] * unit(i, k) + n[i] * unit(j, k));
        2.0 * whole / length * (beta * along * first + second + third - (1.0 - 4.0 * nu) * n[k] * unit(i, j))
    });
    (pulled, moved)
}
