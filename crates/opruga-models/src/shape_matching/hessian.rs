//! Second derivatives of shape matching: a diagonal and terms of rank one. The symbols are those of [`super`].
//!
//! For a cluster with the mass M, δ²U = κ (Σ m |δx|² − M |δx̄|² − (1 − β) aᵀ G⁻¹ a − β Σₖ |δcₖ|²), where a = Σ m Rᵀ(R q × δx)
//! measures the rotation in δx, and G = (tr S) 1 − S with S = Rᵀ A determines how fast R follows.

use super::Matching;
use super::shape::{inertia, turned_trace};
use opruga_core::potential::{Definiteness, Sink};
use opruga_math::{matrix, symmetric};

/// If G about an axis is below this fraction of its value at rest, the rotation of the cluster about this axis is undetermined
/// and has no stiffness.
const UNDETERMINED: f64 = 1e-12;

impl<const D: usize> Matching<D> {
    pub(super) fn second_derivatives(&self, scratch: &[f64], keep: Definiteness, sink: &mut dyn Sink<D>) {
        let clusters = &self.clusters;
        let layout = clusters.layout;
        for node in 0..clusters.nodes {
            for body in 0..layout.stride() {
                let own = clusters.slots_start[node] as usize..clusters.slots_start[node + 1] as usize;
                let mass: f64 =
                    clusters.slots_of[own].iter().map(|slot| clusters.mass[layout.index(*slot as usize, body)]).sum();
                let index = layout.index(node, body);
                let strength = self.law.stiffness.at(body) * mass;
                sink.block(index, index, matrix::scaled(&matrix::identity(), strength));
            }
        }
        let mut part = Vec::new();
        for cluster in 0..clusters.len() {
            for body in 0..layout.stride() {
                self.of_cluster(scratch, keep, [cluster, body], &mut part, sink);
            }
        }
    }

    fn of_cluster(
        &self,
        scratch: &[f64],
        keep: Definiteness,
        [cluster, body]: [usize; 2],
        part: &mut Vec<(usize, [f64; D])>,
        sink: &mut dyn Sink<D>,
    ) {
        let clusters = &self.clusters;
        let layout = clusters.layout;
        let (stiffness, share) = (self.law.stiffness.at(body), self.law.share.at(body));
        let first = clusters.range(cluster).start;
        let slots = first..first + clusters.count[cluster] as usize;
        let at = layout.index(cluster, body);
        // Delivers the square of Σ u·δx, where u is a vector of every slot.
        let mut deliver = |c: f64, of_slot: &dyn Fn(usize) -> [f64; D]| {
            part.clear();
            part.extend(slots.clone().map(|slot| {
                let mass = clusters.mass[layout.index(slot, body)];
                (clusters.indices[slot] as usize + body, of_slot(layout.index(slot, body)).map(|x| mass * x))
            }));
            sink.low_rank(c, part);
        };
        for d in 0..D {
            let mut axis = [0.0; D];
            axis[d] = 1.0;
            deliver(-stiffness * clusters.inverse_mass[at], &|_| axis);
            if share > 0.0 {
                for column in &clusters.phi {
                    deliver(-stiffness * share, &|index| axis.map(|x| x * column[index]));
                }
            }
        }
        if share >= 1.0 {
            return;
        }
        let number = |column: usize| self.stored.at(clusters, scratch, column, cluster, body);
        let (mut frame, mut linear, mut rotation) = (matrix::zeros(), matrix::zeros(), matrix::zeros::<f64, D>());
        for d in 0..D {
            for k in 0..D {
                frame[d][k] = clusters.frame[d * D + k][at];
                linear[d][k] = number(self.stored.moments + d * clusters.columns + k);
                rotation[d][k] = number(self.stored.rotation + d * D + k);
            }
        }
        let goal = matrix::product(&rotation, &frame);
        let moved = |index: usize| {
            let mut out = [0.0; D];
            for d in 0..D {
                for k in 0..D {
                    out[d] += goal[d][k] * clusters.phi[k][index];
                }
            }
            out
        };
        let stretch = matrix::transposed_product(&rotation, &matrix::product_transposed(&linear, &frame));
        for (axis, weight) in rotations(&frame, &stretch, keep) {
            // The rotation axis in space. In the plane there is one axis, and only its length matters.
            let axis: [f64; 3] = if D == 2 {
                [0.0, 0.0, axis[0]]
            } else {
                let mut turned = [0.0; 3];
                for i in 0..D {
                    for j in 0..D {
                        turned[i] += rotation[i][j] * axis[j];
                    }
                }
                turned
            };
            deliver(-stiffness * (1.0 - share) * weight, &|index| {
                let q = moved(index);
                let z = if D == 3 { q[D - 1] } else { 0.0 };
                let cross =
                    [axis[1] * z - axis[2] * q[1], axis[2] * q[0] - axis[0] * z, axis[0] * q[1] - axis[1] * q[0]];
                core::array::from_fn(|d| cross[d])
            });
        }
    }
}

/// G⁻¹ as Σ w e eᵀ, in the frame of the rest shape. Let I be the inertia of the cluster at rest. The corresponding part of the
/// Hessian has no negative eigenvalue if G ⪰ I. The eigenvalues of I^(−½) G I^(−½) show for which axes of rotation this
/// condition fails.
fn rotations<const D: usize>(
    frame: &[[f64; D]; D],
    stretch: &[[f64; D]; D],
    keep: Definiteness,
) -> Vec<([f64; D], f64)> {
    let clamped = |ratio: f64| match keep {
        Definiteness::Clamped if ratio < 1.0 => 1.0,
        _ => ratio,
    };
    if D == 2 {
        let size = matrix::trace(&matrix::product_transposed(frame, frame));
        let ratio = clamped(matrix::trace(stretch) / size);
        let mut axis = [0.0; D];
        axis[0] = 1.0 / size.sqrt();
        let determined = size > 0.0 && ratio > UNDETERMINED;
        return if determined { vec![(axis, 1.0 / ratio)] } else { Vec::new() };
    }
    let mut symmetric_stretch = matrix::plus(stretch, 1.0, &transposed(stretch));
    symmetric_stretch = matrix::scaled(&symmetric_stretch, 0.5);
    let (moments, axes) = symmetric::eigen(&inertia(frame));
    let largest = moments.iter().fold(0.0, |most, x| if *x > most { *x } else { most });
    // I^(−½), without the axis of a collinear cluster.
    let mut root = matrix::zeros::<f64, D>();
    for k in (0..D).filter(|k| moments[*k] > UNDETERMINED * largest) {
        let factor = 1.0 / moments[k].sqrt();
        for i in 0..D {
            for j in 0..D {
                root[i][j] += factor * axes[i][k] * axes[j][k];
            }
        }
    }
    let follows = matrix::product(&root, &matrix::product(&turned_trace(&symmetric_stretch), &root));
    let (ratios, vectors) = symmetric::eigen(&follows);
    let mut out = Vec::new();
    for k in 0..D {
        let mut axis = [0.0; D];
        for i in 0..D {
            for j in 0..D {
                axis[i] += root[i][j] * vectors[j][k];
            }
        }
        let ratio = clamped(ratios[k]);
        // An axis without inertia contributes nothing.
        if ratio > UNDETERMINED && axis.iter().any(|x| *x != 0.0) {
            out.push((axis, 1.0 / ratio));
        }
    }
    out
}

fn transposed<const D: usize>(a: &[[f64; D]; D]) -> [[f64; D]; D] {
    core::array::from_fn(|i| core::array::from_fn(|j| a[j][i]))
}
