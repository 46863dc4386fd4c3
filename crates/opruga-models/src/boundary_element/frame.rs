//! The frame of a moving body: the rotation nearest to its deformation, with forces and second derivatives in this frame.
//!
//! With weights w of the vertices (their shares of the boundary, Σ w = 1, Σ w X = 0), A = Σ w (x − x̄) Xᵀ, R the rotation nearest to
//! A, y = Rᵀ(x − x̄), u = y − X and g = K u,
//!
//! U = ½ uᵀ g,  f = −R (g − w λ × X),  G λ = τ = Σ y × g,  G = (tr B) 1 − B,  B = Rᵀ A.
//!
//! Under a displacement R d, R turns by θ = G⁻¹ Σ w X × d, so f is the exact gradient of U, and Σ y × f = τ − G λ = 0. The second
//! derivatives are
//!
//! δ²U = dᵀK d + 2 θ·Z d + θᵀ S θ,
//! θ·Z d = −(θ × y)ᵀ K d − θ·Σ d × g + Σ w (θ·λ X·d − X·θ λ·d),
//! θᵀ S θ = (θ × y)ᵀ K (θ × y) + Σ (g·θ y·θ − g·y θ·θ) + λ·(θ × B θ),
//!
//! or (d − θ × y)ᵀ K (d − θ × y) plus the terms of g and λ, which vanish at rest ([`Following`]). Without these terms the sum is
//! never negative.
//!
//! R is not chosen to minimise U, because K contains only strains and no rotations. U(R) would be of fourth order in a rotation
//! from rest, and any uniform expansion 1 + e of the plane has U = 0 in the frame turned by arccos 1/(1 + e). A body in that
//! frame would not resist expansion (docs/boundary-elements.md, "The frame").

use opruga_core::potential::{Definiteness, Following};
use opruga_math::rotation::nearest_rotation;
use opruga_math::{matrix, symmetric};
use std::sync::Arc;

/// If G about an axis is below this fraction of Σ w |X|², the rotation about this axis is undetermined, and the frame does not
/// follow it.
const UNDETERMINED: f64 = 1e-12;

type Vector = [f64; 3];

/// A body at rest.
#[derive(Clone, Debug)]
pub(super) struct Rest<const D: usize> {
    /// X of each vertex [m], Σ w X = 0.
    pub(super) positions: Vec<[f64; D]>,
    /// w of each vertex.
    pub(super) weights: Vec<f64>,
    /// Σ w |X|² [m²].
    pub(super) inertia: f64,
}

/// A frame, and how it follows displacements.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame<const D: usize> {
    pub(super) rotation: [[f64; D]; D],
    /// B [m²].
    pub(super) stretch: [[f64; 3]; 3],
    /// G⁻¹ [1/m²].
    pub(super) follows: [[f64; 3]; 3],
}

fn lift<const D: usize>(x: &[f64]) -> Vector {
    [x[0], x[1], if D == 3 { x[2] } else { 0.0 }]
}
fn cross(a: &Vector, b: &Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
fn dot(a: &Vector, b: &Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
fn times(a: &[[f64; 3]; 3], x: &Vector) -> Vector {
    core::array::from_fn(|i| dot(&a[i], x))
}
fn axis(k: usize) -> Vector {
    core::array::from_fn(|d| if d == k { 1.0 } else { 0.0 })
}
/// The axes of rotation: only the third in the plane.
fn axes<const D: usize>() -> core::ops::Range<usize> {
    if D == 2 { 2..3 } else { 0..3 }
}

impl<const D: usize> Rest<D> {
    /// Makes a body from positions relative to any point [m], and from the shares of its vertices, which need not sum to 1.
    pub(super) fn new(positions: &[[f64; D]], shares: &[f64]) -> Rest<D> {
        let all: f64 = shares.iter().sum();
        let weights: Vec<f64> = shares.iter().map(|share| share / all).collect();
        let mut mean = [0.0; D];
        for (x, w) in positions.iter().zip(&weights) {
            (0..D).for_each(|d| mean[d] += w * x[d]);
        }
        let positions: Vec<[f64; D]> = positions.iter().map(|x| core::array::from_fn(|d| x[d] - mean[d])).collect();
        let inertia = positions.iter().zip(&weights).map(|(x, w)| w * x.iter().map(|x| x * x).sum::<f64>()).sum();
        Rest { positions, weights, inertia }
    }

    /// Computes the frame of a state. Writes y and u, vertex by vertex.
    pub(super) fn frame(&self, x: impl Fn(usize) -> [f64; D], y: &mut [f64], u: &mut [f64]) -> Frame<D> {
        let first = x(0);
        let mut mean = [0.0; D];
        for (vertex, w) in self.weights.iter().enumerate() {
            let x = x(vertex);
            (0..D).for_each(|d| mean[d] += w * (x[d] - first[d]));
        }
        let arm = |vertex: usize| -> [f64; D] {
            let x = x(vertex);
            core::array::from_fn(|d| (x[d] - first[d]) - mean[d])
        };
        let mut moments = [[0.0; D]; D];
        for (vertex, (rest, w)) in self.positions.iter().zip(&self.weights).enumerate() {
            let arm = arm(vertex);
            for i in 0..D {
                for j in 0..D {
                    moments[i][j] += w * arm[i] * rest[j];
                }
            }
        }
        let rotation = nearest_rotation(&moments);
        for (vertex, rest) in self.positions.iter().enumerate() {
            let arm = arm(vertex);
            for j in 0..D {
                let turned = (0..D).map(|i| rotation[i][j] * arm[i]).sum::<f64>();
                y[vertex * D + j] = turned;
                u[vertex * D + j] = turned - rest[j];
            }
        }
        let stretch = matrix::transposed_product(&rotation, &moments);
        let mut out = Frame { rotation, stretch: [[0.0; 3]; 3], follows: [[0.0; 3]; 3] };
        for i in 0..D {
            for j in 0..D {
                out.stretch[i][j] = 0.5 * (stretch[i][j] + stretch[j][i]);
            }
        }
        out.follows = inverse_of::<D>(&out.stretch, UNDETERMINED * self.inertia);
        out
    }

    /// λ, the multiplier of the frame [N/m].
    pub(super) fn multiplier(&self, frame: &Frame<D>, y: &[f64], g: &[f64]) -> Vector {
        let mut torque = [0.0; 3];
        for (y, g) in y.chunks_exact(D).zip(g.chunks_exact(D)).take(self.weights.len()) {
            let part = cross(&lift::<D>(y), &lift::<D>(g));
            (0..3).for_each(|d| torque[d] += part[d]);
        }
        times(&frame.follows, &torque)
    }

    /// The force on a vertex [N].
    pub(super) fn force(&self, frame: &Frame<D>, multiplier: &Vector, vertex: usize, g: &[f64]) -> [f64; D] {
        let follows = cross(multiplier, &lift::<D>(&self.positions[vertex]));
        let w = self.weights[vertex];
        let pulled: [f64; D] = core::array::from_fn(|j| g[vertex * D + j] - w * follows[j]);
        core::array::from_fn(|i| -(0..D).map(|j| frame.rotation[i][j] * pulled[j]).sum::<f64>())
    }

    /// The matrix J of [`Following`] without the factor G⁻¹: w e × X for each axis e, as vectors of `length` numbers, one after
    /// the other.
    pub(super) fn follows(&self, length: usize) -> Vec<f64> {
        let mut out = vec![0.0; axes::<D>().len() * length];
        for (k, out) in axes::<D>().zip(out.chunks_exact_mut(length)) {
            for ((to, x), w) in out.chunks_exact_mut(D).zip(&self.positions).zip(&self.weights) {
                let spin = cross(&axis(k), &lift::<D>(x));
                (0..D).for_each(|d| to[d] = w * spin[d]);
            }
        }
        out
    }

    /// How the frame follows displacements, for the second derivatives. K is multiplied by `factor`. The terms that depend on forces
    /// are included only with `Exact`.
    pub(super) fn following(
        &self,
        frame: &Frame<D>,
        multiplier: &Vector,
        [y, g]: [&[f64]; 2],
        keep: Definiteness,
        base: &Arc<Vec<f64>>,
        factor: f64,
    ) -> Following {
        let (first, axes) = (axes::<D>().start, axes::<D>());
        let length = base.len() / axes.len();
        let mut out = Following { base: Arc::clone(base), ..Following::default() };
        for (k, row) in axes.clone().zip(&mut out.mix) {
            for (l, entry) in axes.clone().zip(row) {
                *entry = frame.follows[k][l];
            }
        }
        let follows = out.follows(length);
        (out.spins, out.forces) = (vec![0.0; base.len()], vec![0.0; base.len()]);
        let mut s = [[0.0; 3]; 3];
        if keep == Definiteness::Exact {
            self.add_stress(frame, multiplier, [y, g], &mut s);
        }
        for k in axes.clone() {
            let range = (k - first) * length..(k - first + 1) * length;
            for (vertex, spin) in out.spins[range.clone()].chunks_exact_mut(D).enumerate().take(self.weights.len()) {
                spin.copy_from_slice(&cross(&axis(k), &lift::<D>(&y[vertex * D..]))[..D]);
            }
            if keep != Definiteness::Exact {
                continue;
            }
            for (vertex, force) in out.forces[range].chunks_exact_mut(D).enumerate().take(self.weights.len()) {
                let (w, x) = (self.weights[vertex], lift::<D>(&self.positions[vertex]));
                let pulled = cross(&lift::<D>(&g[vertex * D..]), &axis(k));
                for (d, force) in force.iter_mut().enumerate() {
                    let turned = axes.clone().map(|l| s[k][l] * follows[(l - first) * length + vertex * D + d]);
                    let own = w * (multiplier[k] * x[d] - x[k] * multiplier[d]) - pulled[d];
                    *force = (0.5 * turned.sum::<f64>() + own) / factor;
                }
            }
        }
        out
    }

    /// Adds the terms of S that depend on forces.
    fn add_stress(&self, frame: &Frame<D>, multiplier: &Vector, [y, g]: [&[f64]; 2], s: &mut [[f64; 3]; 3]) {
        let mut pull = [[0.0; 3]; 3];
        for (y, g) in y.chunks_exact(D).zip(g.chunks_exact(D)).take(self.weights.len()) {
            let (y, g) = (lift::<D>(y), lift::<D>(g));
            for k in 0..3 {
                for l in 0..3 {
                    pull[k][l] += 0.5 * (g[k] * y[l] + g[l] * y[k]);
                }
            }
        }
        let trace = matrix::trace(&pull);
        for k in 0..3 {
            for l in 0..3 {
                let column: Vector = core::array::from_fn(|m| frame.stretch[m][l]);
                let row: Vector = core::array::from_fn(|m| frame.stretch[m][k]);
                let turned = 0.5 * (cross(&column, multiplier)[k] + cross(&row, multiplier)[l]);
                s[k][l] += pull[k][l] - if k == l { trace } else { 0.0 } + turned;
            }
        }
    }
}

/// G⁻¹ without the axes for which G is not above `least`.
fn inverse_of<const D: usize>(stretch: &[[f64; 3]; 3], least: f64) -> [[f64; 3]; 3] {
    let trace = matrix::trace(stretch);
    let mut out = [[0.0; 3]; 3];
    if D == 2 {
        out[2][2] = if trace > least { 1.0 / trace } else { 0.0 };
        return out;
    }
    let mut g = [[0.0; 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            g[i][j] = if i == j { trace } else { 0.0 } - stretch[i][j];
        }
    }
    let (values, vectors) = symmetric::eigen(&g);
    for k in (0..3).filter(|k| values[*k] > least) {
        for i in 0..3 {
            for j in 0..3 {
                out[i][j] += vectors[i][k] * vectors[j][k] / values[k];
            }
        }
    }
    out
}
