//! Forces from outside: loads, pushes, the pull of a pointer, and a user's own law.

use opruga_core::error::StepError;
use opruga_core::potential::{Account, Definiteness, Observe, Potential, Properties, Sink, Views};
use opruga_core::state::{Layout, View};
use opruga_core::system::along_path;
use opruga_core::tile::Tile;
use opruga_math::{Simd, WIDTH};
use opruga_mesh::{MOST_SIDE_NODES, SidePoint, side_points, side_tangents, side_vector};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, PoisonError, RwLock};

const USER: Views = Views { energy: false, hessian: true, symmetric: true, damping: false };

/// A multiple of the identity matrix.
fn isotropic<const D: usize>(value: f64) -> [[f64; D]; D] {
    core::array::from_fn(|i| core::array::from_fn(|j| if i == j { value } else { 0.0 }))
}

/// Adds a force at an index and records its power.
fn push<const D: usize>(tile: &mut Tile<D>, view: &View<D>, index: usize, force: [f64; D]) {
    let k = index - tile.range.start;
    let mut power = 0.0;
    for d in 0..D {
        tile.force[d][k] += force[d];
        power += force[d] * view.v[d][index];
    }
    tile.power[index % WIDTH] += power;
}

/// Given forces on nodes, with a factor over time.
#[derive(Debug)]
pub(crate) struct NodeForces<const D: usize> {
    /// Index and force [N], with ascending indices.
    pub(crate) entries: Vec<(usize, [f64; D])>,
    /// A factor over time, rows `[t, factor]`; an empty curve means the factor 1.
    pub(crate) curve: Vec<Vec<f64>>,
}

/// The factor of a curve at a time; constant before its first and after its last point.
pub(crate) fn factor(curve: &[Vec<f64>], time: f64) -> f64 {
    if curve.is_empty() { 1.0 } else { along_path::<1>(curve, time).0[0] }
}

impl<const D: usize> Potential<D> for NodeForces<D> {
    fn properties(&self) -> Properties {
        Properties { account: Account::User, ..Properties::new("force", USER) }
    }
    fn add_force(&self, _simd: Simd, view: &View<D>, _scratch: &[f64], tile: &mut Tile<D>) {
        let factor = factor(&self.curve, view.time);
        let first = self.entries.partition_point(|(index, _)| *index < tile.range.start);
        let last = self.entries.partition_point(|(index, _)| *index < tile.range.end);
        for (index, force) in &self.entries[first..last] {
            push(tile, view, *index, force.map(|f| f * factor));
        }
    }
}

impl<const D: usize> Observe<D> for NodeForces<D> {}

/// Forces of equal size towards a fixed point, with a factor over time: F = s (c − x)/|c − x|.
///
/// A node at the point itself feels no force, because there is no direction.
#[derive(Debug)]
pub(crate) struct CentralForces<const D: usize> {
    /// Indices of the nodes, ascending.
    pub(crate) indices: Vec<usize>,
    /// s [N].
    pub(crate) value: f64,
    /// c [m].
    pub(crate) center: [f64; D],
    pub(crate) curve: Vec<Vec<f64>>,
}

impl<const D: usize> CentralForces<D> {
    /// The unit vector from a node to the point, and their distance [m].
    fn direction(&self, view: &View<D>, index: usize) -> Option<([f64; D], f64)> {
        let x = view.position(index);
        let arm: [f64; D] = core::array::from_fn(|d| self.center[d] - x[d]);
        let distance = arm.iter().fold(0.0, |length, a| libm::hypot(length, *a));
        (distance > 0.0).then(|| (arm.map(|a| a / distance), distance))
    }
}

impl<const D: usize> Potential<D> for CentralForces<D> {
    fn properties(&self) -> Properties {
        Properties { account: Account::User, ..Properties::new("central force", USER) }
    }
    fn add_force(&self, _simd: Simd, view: &View<D>, _scratch: &[f64], tile: &mut Tile<D>) {
        let size = self.value * factor(&self.curve, view.time);
        let first = self.indices.partition_point(|index| *index < tile.range.start);
        let last = self.indices.partition_point(|index| *index < tile.range.end);
        for &index in &self.indices[first..last] {
            if let Some((direction, _)) = self.direction(view, index) {
                push(tile, view, index, direction.map(|n| size * n));
            }
        }
    }
    /// −∂F/∂x = s/r (1 − n nᵀ), where r is the distance to the point and n the unit vector towards it.
    fn hessian(&self, view: &View<D>, _scratch: &[f64], keep: Definiteness, sink: &mut dyn Sink<D>) {
        let size = self.value * factor(&self.curve, view.time);
        if size < 0.0 && keep != Definiteness::Exact {
            return;
        }
        for index in &self.indices {
            if let Some((n, distance)) = self.direction(view, *index) {
                let mut block = isotropic(size / distance);
                for i in 0..D {
                    (0..D).for_each(|j| block[i][j] -= size / distance * n[i] * n[j]);
                }
                sink.block(*index, *index, block);
            }
        }
    }
}

impl<const D: usize> Observe<D> for CentralForces<D> {}

/// A pressure on sides of cells along their present inner normal, with a factor over time: F_a = −p ∫ Nₐ dA, integrated exactly with the shape
/// functions Nₐ of the sides.
#[derive(Debug)]
pub(crate) struct FollowerPressure<const D: usize> {
    /// Pressure [Pa], times thickness in 2D.
    pressure: f64,
    curve: Vec<Vec<f64>>,
    stride: usize,
    /// Indices of the nodes of every side.
    sides: Vec<Vec<usize>>,
    /// For each number of nodes, the integration points of sides with that number.
    points: Vec<Vec<SidePoint>>,
}

impl<const D: usize> FollowerPressure<D> {
    pub(crate) fn new(pressure: f64, curve: &[Vec<f64>], stride: usize, sides: Vec<Vec<usize>>) -> FollowerPressure<D> {
        let points = (0..=MOST_SIDE_NODES).map(|n| if n < D { Vec::new() } else { side_points(D, n) }).collect();
        FollowerPressure { pressure, curve: curve.to_vec(), stride, sides, points }
    }
    /// The positions of the nodes of a side.
    fn corners(view: &View<D>, side: &[usize]) -> [[f64; D]; MOST_SIDE_NODES] {
        core::array::from_fn(|n| side.get(n).map_or([0.0; D], |&index| view.position(index)))
    }
}

impl<const D: usize> Potential<D> for FollowerPressure<D> {
    fn properties(&self) -> Properties {
        Properties { account: Account::User, ..Properties::new("pressure load", USER) }
    }
    fn stencils(&self, visit: &mut dyn FnMut(&[u32])) {
        for side in &self.sides {
            let nodes: Vec<u32> = side.iter().map(|index| (index / self.stride) as u32).collect();
            visit(&nodes);
        }
    }
    fn add_force(&self, _simd: Simd, view: &View<D>, _scratch: &[f64], tile: &mut Tile<D>) {
        let strength = -self.pressure * factor(&self.curve, view.time);
        for side in &self.sides {
            if side.iter().all(|p| !tile.range.contains(p)) {
                continue;
            }
            let x = FollowerPressure::corners(view, side);
            for point in &self.points[side.len()] {
                let area = side_vector(point, &x);
                for (&index, shape) in side.iter().zip(point.shape) {
                    if tile.range.contains(&index) {
                        push(tile, view, index, area.map(|a| a * (strength * point.weight * shape)));
                    }
                }
            }
        }
    }
    fn hessian(&self, view: &View<D>, _scratch: &[f64], keep: Definiteness, sink: &mut dyn Sink<D>) {
        if keep == Definiteness::Exact {
            self.add_hessian(view, sink);
        }
    }
}

impl<const D: usize> Observe<D> for FollowerPressure<D> {}

/// The symmetric part of −∂F/∂x of a pressure on sides. This derivative is exact for a closed surface, because a pressure on it has a potential.
impl<const D: usize> FollowerPressure<D> {
    fn add_hessian(&self, view: &View<D>, sink: &mut dyn Sink<D>) {
        let strength = 0.5 * self.pressure * factor(&self.curve, view.time);
        for side in &self.sides {
            let x = FollowerPressure::corners(view, side);
            for (m, &moved) in side.iter().enumerate() {
                for (n, &pushed) in side.iter().enumerate() {
                    let mut block = [[0.0; D]; D];
                    for point in &self.points[side.len()] {
                        let weight = strength * point.weight * point.shape[n];
                        let by = point.slope[m];
                        if D == 2 {
                            block[0][1] += weight * by[0];
                            block[1][0] -= weight * by[0];
                        } else {
                            // ∂(t₀ × t₁)/∂x_m v = (∂N/∂ξ) v × t₁ + (∂N/∂η) t₀ × v.
                            let t = side_tangents(point, &x);
                            for d in 0..3 {
                                let (e, f) = ((d + 1) % 3, (d + 2) % 3);
                                block[d][e] += weight * (by[0] * t[1][f] - by[1] * t[0][f]);
                                block[d][f] += weight * (by[1] * t[0][e] - by[0] * t[1][e]);
                            }
                        }
                    }
                    sink.block(pushed, moved, block);
                    sink.block(moved, pushed, core::array::from_fn(|i| core::array::from_fn(|j| block[j][i])));
                }
            }
        }
    }
}

/// A spring from a moving pointer to a node or to a point of a facet, critically damped for the grabbed mass.
#[derive(Debug)]
pub(crate) struct Pull<const D: usize> {
    /// Indices of the grabbed nodes and their weights, which add up to one.
    pub(crate) grabbed: Vec<(usize, f64)>,
    /// Path of the pointer, rows `[t, x, y(, z)]`; it grows while the pointer is moved.
    pub(crate) path: Arc<RwLock<Vec<Vec<f64>>>>,
    /// Stiffness [N/m].
    pub(crate) stiffness: f64,
    /// Damping [N·s/m].
    pub(crate) damping: f64,
    /// The largest force [N].
    pub(crate) largest_force: f64,
    /// The number of times that the limit was reached.
    pub(crate) limited: Arc<AtomicU64>,
}

/// A factor that makes the squares of the largest numbers finite.
const FAR: f64 = 1e-200;

impl<const D: usize> Pull<D> {
    /// The grabbed point, the pointer, and the force on the grabbed point [N].
    pub(crate) fn force(&self, view: &View<D>) -> ([f64; D], [f64; D], [f64; D], bool) {
        let path = self.path.read().unwrap_or_else(PoisonError::into_inner);
        let (pointer, speed) = along_path::<D>(&path, view.time);
        let (mut x, mut v) = ([0.0; D], [0.0; D]);
        for (index, share) in &self.grabbed {
            for d in 0..D {
                x[d] += share * view.x[d][*index];
                v[d] += share * view.v[d][*index];
            }
        }
        let mut force = [0.0; D];
        let mut square = 0.0;
        for d in 0..D {
            force[d] = self.stiffness * (pointer[d] - x[d]) + self.damping * (speed[d] - v[d]);
            square += force[d] * force[d];
        }
        let within = square <= self.largest_force * self.largest_force && square.is_finite();
        let limited = !within && self.largest_force.is_finite();
        if limited {
            if !square.is_finite() {
                // A force whose square overflows still has a direction. A component that is the difference of two infinite numbers (NaN) does not
                // pull.
                force = force.map(|f| if f.is_nan() { 0.0 } else { FAR * f.clamp(-f64::MAX, f64::MAX) });
                square = force.iter().map(|f| f * f).sum();
            }
            let factor = if square > 0.0 { self.largest_force / square.sqrt() } else { 0.0 };
            force = force.map(|f| f * factor);
        }
        (x, pointer, force, limited)
    }
}

impl<const D: usize> Potential<D> for Pull<D> {
    fn properties(&self) -> Properties {
        Properties {
            account: Account::User,
            scratch_len: D,
            forces_in_prepare: true,
            ..Properties::new("drag", Views { damping: true, ..USER })
        }
    }
    fn prepare(&self, _simd: Simd, view: &View<D>, _memory: &[f64], scratch: &mut [f64]) -> Result<(), StepError> {
        let (_, _, force, limited) = self.force(view);
        scratch.copy_from_slice(&force);
        if limited {
            self.limited.fetch_add(1, Ordering::Relaxed);
        }
        Ok(())
    }
    fn add_force(&self, _simd: Simd, view: &View<D>, scratch: &[f64], tile: &mut Tile<D>) {
        for (index, share) in &self.grabbed {
            if tile.range.contains(index) {
                let mut force = [0.0; D];
                for d in 0..D {
                    force[d] = share * scratch[d];
                }
                push(tile, view, *index, force);
            }
        }
    }
    fn hessian(&self, view: &View<D>, _scratch: &[f64], _keep: Definiteness, sink: &mut dyn Sink<D>) {
        self.add_spring(view, self.stiffness, sink);
    }
    fn damping_matrix(&self, view: &View<D>, _scratch: &[f64], sink: &mut dyn Sink<D>) {
        self.add_spring(view, self.damping, sink);
    }
}

impl<const D: usize> Observe<D> for Pull<D> {}

impl<const D: usize> Pull<D> {
    /// Adds a spring or damper of the given strength at the grabbed point; adds zeros if the force is at its limit.
    fn add_spring(&self, view: &View<D>, strength: f64, sink: &mut dyn Sink<D>) {
        let (_, _, _, limited) = self.force(view);
        let strength = if limited { 0.0 } else { strength };
        for (a, of_a) in &self.grabbed {
            for (b, of_b) in &self.grabbed {
                sink.block(*a, *b, isotropic(strength * of_a * of_b));
            }
        }
    }
}

/// A user's law: the force on a node from its number, position, velocity and the time.
pub type ForceLaw<const D: usize> = dyn Fn(u32, [f64; D], [f64; D], f64) -> [f64; D] + Send + Sync;

/// A user's law on every node of one body.
pub(crate) struct UserForce<const D: usize> {
    pub(crate) law: Arc<ForceLaw<D>>,
    pub(crate) layout: Layout,
    pub(crate) body: usize,
}

impl<const D: usize> core::fmt::Debug for UserForce<D> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("UserForce")
    }
}

impl<const D: usize> Potential<D> for UserForce<D> {
    fn properties(&self) -> Properties {
        Properties { account: Account::User, ..Properties::new("user force", Views { damping: true, ..USER }) }
    }
    fn add_force(&self, _simd: Simd, view: &View<D>, _scratch: &[f64], tile: &mut Tile<D>) {
        let stride = self.layout.stride();
        let nodes = tile.range.start / stride..tile.range.end.div_ceil(stride).min(view.nodes);
        for node in nodes {
            let index = self.layout.index(node, self.body);
            if tile.range.contains(&index) {
                let force = (self.law)(node as u32, view.position(index), view.velocity(index), view.time);
                push(tile, view, index, force);
            }
        }
    }
    fn hessian(&self, view: &View<D>, _scratch: &[f64], _keep: Definiteness, sink: &mut dyn Sink<D>) {
        self.add_slope(view, [1.0, 0.0], sink);
    }
    fn damping_matrix(&self, view: &View<D>, _scratch: &[f64], sink: &mut dyn Sink<D>) {
        self.add_slope(view, [0.0, 1.0], sink);
    }
}

impl<const D: usize> Observe<D> for UserForce<D> {}

impl<const D: usize> UserForce<D> {
    /// Adds the symmetric part of −∂F/∂x or −∂F/∂v at every node, by central differences, because the law is a black box.
    fn add_slope(&self, view: &View<D>, [of_x, of_v]: [f64; 2], sink: &mut dyn Sink<D>) {
        const STEP: f64 = 6e-6;
        for node in 0..view.nodes {
            let index = self.layout.index(node, self.body);
            let (x, v) = (view.position(index), view.velocity(index));
            let mut slope = [[0.0; D]; D];
            for j in 0..D {
                let step = STEP * (1.0 + of_x * x[j].abs() + of_v * v[j].abs());
                let at = |sign: f64| {
                    let (mut x, mut v) = (x, v);
                    x[j] += sign * of_x * step;
                    v[j] += sign * of_v * step;
                    (self.law)(node as u32, x, v, view.time)
                };
                let (ahead, behind) = (at(1.0), at(-1.0));
                for i in 0..D {
                    slope[i][j] = (behind[i] - ahead[i]) / (2.0 * step);
                }
            }
            let block = core::array::from_fn(|i| core::array::from_fn(|j| 0.5 * (slope[i][j] + slope[j][i])));
            sink.block(index, index, block);
        }
    }
}
