//! Stress on the boundary, from tractions and from strains along the boundary.
//!
//! With the normal n, tangents a and b, tractions t = σ n and the strains ε along the facet,
//!
//! σ_nn = t·n,  σ_an = t·a,  σ_aa = 2μ/(1 − ν) (ε_aa + ν ε_bb) + ν/(1 − ν) σ_nn,  σ_ab = 2μ ε_ab,
//!
//! with ε_bb = 0 in the plane. A traction is the force on a vertex over its share of the boundary. At an edge or a corner the
//! force belongs to several smooth parts, and the traction of a single part cannot be determined. If a facet has vertices that
//! belong to only one smooth part, only the tractions of these vertices are used.
//!
//! Source: Brebbia, Telles, Wrobel 1984, section 5.11 (stresses on the boundary).

use super::surface::Surface;
use opruga_core::potential::CellState;

/// The data for computing the stress of each facet from the displacements and forces of its vertices.
#[derive(Debug)]
pub(super) struct Skin<const D: usize> {
    facets: Vec<Facet<D>>,
}

#[derive(Debug)]
struct Facet<const D: usize> {
    nodes: [u32; D],
    /// Unit vectors: D − 1 tangents and the normal.
    axes: [[f64; D]; D],
    /// The gradient of each shape function along each tangent [1/m].
    slopes: [[f64; D]; D],
    /// The factor of the force on each vertex in the mean traction [1/m²].
    pulls: [f64; D],
    /// Length times thickness, or area [m²].
    measure: f64,
}

/// The constants of a law.
#[derive(Clone, Copy, Debug)]
pub(super) struct Constants {
    /// μ [Pa].
    pub(super) shear: f64,
    pub(super) poisson: f64,
    /// Whether the stress out of the plane is zero.
    pub(super) plane_stress: bool,
}

fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    (0..D).map(|d| a[d] * b[d]).sum()
}

/// The tangents of a facet and its normal. The first tangent points along the first edge.
fn axes<const D: usize>(corners: &[[f64; D]; D], normal: &[f64; D]) -> [[f64; D]; D] {
    let edge: [f64; D] = core::array::from_fn(|d| corners[1][d] - corners[0][d]);
    let length = dot(&edge, &edge).sqrt();
    let mut out = [[0.0; D]; D];
    out[0] = edge.map(|x| x / length);
    if D == 3 {
        let (n, a) = (normal, out[0]);
        out[1] = core::array::from_fn(|d| {
            let (e, f) = ((d + 1) % 3, (d + 2) % 3);
            n[e] * a[f] - n[f] * a[e]
        });
    }
    out[D - 1] = *normal;
    out
}

impl<const D: usize> Skin<D> {
    /// Makes the data from the vertices at rest [m] and, in the plane, the thickness [m].
    pub(super) fn new(surface: &Surface<D>, thickness: f64) -> Skin<D> {
        let scale = if D == 2 { surface.size * thickness } else { surface.size * surface.size };
        let mut shares = vec![0.0; surface.nodes];
        let mut part = vec![None; surface.nodes];
        let mut several = vec![false; surface.nodes];
        let all = || surface.facets.iter().zip(&surface.sides).zip(&surface.corners);
        for ((facet, side), corners) in all() {
            for (node, corner) in facet.iter().zip(corners) {
                let node = *node as usize;
                shares[node] += scale * side.measure / D as f64;
                several[node] |= part[node].is_some_and(|known| known != *corner);
                part[node] = Some(*corner);
            }
        }
        let facets = all().map(|((nodes, side), _)| {
            let axes = axes(&side.corners, &side.normal);
            let sure = nodes.iter().filter(|node| !several[**node as usize]).count();
            let pulls = nodes.map(|node| match (sure, several[node as usize]) {
                (0, _) => 1.0 / (D as f64 * shares[node as usize]),
                (_, true) => 0.0,
                (sure, false) => 1.0 / (sure as f64 * shares[node as usize]),
            });
            let slopes = slopes(&side.corners, &axes).map(|slope| slope.map(|s| s / surface.size));
            Facet { nodes: *nodes, axes, slopes, pulls, measure: scale * side.measure }
        });
        Skin { facets: facets.collect() }
    }

    /// The stress of every facet from u [m] and the forces g [N]. The stress is rotated from the frame of the body into that
    /// of the world.
    pub(super) fn states(&self, law: Constants, frame: &[[f64; D]; D], u: &[f64], g: &[f64]) -> Vec<CellState> {
        let of = |facet: &Facet<D>| -> [[f64; 3]; 3] {
            let local = facet.stress(law, u, g);
            let mut out = [[0.0; 3]; 3];
            for i in 0..D {
                for j in 0..D {
                    // Σ a_i σ_ab b_j with axes rotated by R.
                    for a in 0..D {
                        for b in 0..D {
                            out[i][j] += dot(&frame[i], &facet.axes[a]) * local[a][b] * dot(&frame[j], &facet.axes[b]);
                        }
                    }
                }
            }
            if D == 2 && !law.plane_stress {
                out[2][2] = law.poisson * (out[0][0] + out[1][1]);
            }
            out
        };
        let bulk = (1.0 - 2.0 * law.poisson) / (2.0 * law.shear * (1.0 + law.poisson));
        let states = self.facets.iter().enumerate().map(|(number, facet)| {
            let stress = of(facet);
            let volume_ratio = 1.0 + bulk * (stress[0][0] + stress[1][1] + stress[2][2]);
            CellState {
                cell: number as u32,
                stress,
                volume_ratio,
                smallest_volume_ratio: volume_ratio,
                measure: facet.measure,
            }
        });
        states.collect()
    }
    pub(super) fn heap_bytes(&self) -> usize {
        self.facets.len() * size_of::<Facet<D>>()
    }
}

impl<const D: usize> Facet<D> {
    /// The stress in the axes of the facet [Pa].
    fn stress(&self, law: Constants, u: &[f64], g: &[f64]) -> [[f64; D]; D] {
        let n = D - 1;
        let of = |all: &[f64], corner: usize| -> [f64; D] {
            core::array::from_fn(|d| all[self.nodes[corner] as usize * D + d])
        };
        // Tractions and the gradients of u along the tangents, both in these axes.
        let (mut traction, mut gradient) = ([0.0; D], [[0.0; D]; D]);
        for corner in 0..D {
            let (moved, force) = (of(u, corner), of(g, corner));
            for a in 0..D {
                traction[a] += self.pulls[corner] * dot(&force, &self.axes[a]);
                (0..n).for_each(|b| gradient[a][b] += dot(&moved, &self.axes[a]) * self.slopes[corner][b]);
            }
        }
        // Plane stress has the same shear modulus and another Poisson's ratio.
        let nu = if law.plane_stress { law.poisson / (1.0 + law.poisson) } else { law.poisson };
        let strain = |a: usize, b: usize| 0.5 * (gradient[a][b] + gradient[b][a]);
        let trace: f64 = (0..n).map(|a| strain(a, a)).sum();
        let mut out = [[0.0; D]; D];
        for a in 0..n {
            for b in 0..n {
                out[a][b] = 2.0 * law.shear * strain(a, b);
            }
            out[a][a] += (2.0 * law.shear * nu * trace + nu * traction[n]) / (1.0 - nu);
            (out[a][n], out[n][a]) = (traction[a], traction[a]);
        }
        out[n][n] = traction[n];
        out
    }
}

/// The gradient of each shape function along each tangent. The last entry is 0.
fn slopes<const D: usize>(corners: &[[f64; D]; D], axes: &[[f64; D]; D]) -> [[f64; D]; D] {
    let along = |corner: usize, axis: usize| {
        let arm: [f64; D] = core::array::from_fn(|d| corners[corner][d] - corners[0][d]);
        dot(&arm, &axes[axis])
    };
    let mut out = [[0.0; D]; D];
    if D == 2 {
        out[1][0] = 1.0 / along(1, 0);
    } else {
        // The first edge lies along the first tangent: the second coordinate of its end is 0.
        let (length, x, y) = (along(1, 0), along(2, 0), along(2, 1));
        out[1] = core::array::from_fn(|a| [1.0 / length, -x / (length * y), 0.0][a]);
        out[2] = core::array::from_fn(|a| [0.0, 1.0 / y, 0.0][a]);
    }
    out[0] = core::array::from_fn(|a| -(1..D).map(|corner| out[corner][a]).sum::<f64>());
    out
}
