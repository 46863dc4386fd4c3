//! Forces from outside: loads, pushes, the pull of a pointer, a user's own law.

use opruga_core::error::StepError;
use opruga_core::potential::{Account, Potential, Views};
use opruga_core::state::{Layout, View};
use opruga_core::system::along_path;
use opruga_core::tile::Tile;
use opruga_math::{Simd, WIDTH};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, PoisonError, RwLock};

const USER: Views = Views { energy: false, hessian: false, damping: false };

/// Adds a force at a place and enters its power.
fn push<const D: usize>(tile: &mut Tile<D>, view: &View<D>, place: usize, force: [f64; D]) {
    let k = place - tile.range.start;
    let mut power = 0.0;
    for d in 0..D {
        tile.force[d][k] += force[d];
        power += force[d] * view.v[d][place];
    }
    tile.power[place % WIDTH] += power;
}

/// Given forces on nodes, with a factor over time.
#[derive(Debug)]
pub(crate) struct NodeForces<const D: usize> {
    /// Place and force [N], places rising.
    pub(crate) entries: Vec<(usize, [f64; D])>,
    /// Factor over time, rows `[t, factor]`; empty: 1.
    pub(crate) curve: Vec<Vec<f64>>,
}

/// The factor of a curve at a time; constant before its first and after its last point.
pub(crate) fn factor(curve: &[Vec<f64>], time: f64) -> f64 {
    if curve.is_empty() { 1.0 } else { along_path::<1>(curve, time).0[0] }
}

impl<const D: usize> Potential<D> for NodeForces<D> {
    fn name(&self) -> &'static str {
        "force"
    }
    fn views(&self) -> Views {
        USER
    }
    fn account(&self) -> Account {
        Account::User
    }
    fn spans(&self, _visit: &mut dyn FnMut(u32, u32)) {}
    fn add_force(&self, _simd: Simd, view: &View<D>, _scratch: &[f64], tile: &mut Tile<D>) {
        let factor = factor(&self.curve, view.time);
        let first = self.entries.partition_point(|(place, _)| *place < tile.range.start);
        let last = self.entries.partition_point(|(place, _)| *place < tile.range.end);
        for (place, force) in &self.entries[first..last] {
            push(tile, view, *place, force.map(|f| f * factor));
        }
    }
}

/// A pressure on facets along their present inner normal, with a factor over time.
#[derive(Debug)]
pub(crate) struct FollowerPressure<const D: usize> {
    /// Places of the corners of every facet.
    pub(crate) facets: Vec<[usize; D]>,
    /// Pressure [Pa], times thickness in 2D.
    pub(crate) pressure: f64,
    pub(crate) curve: Vec<Vec<f64>>,
    pub(crate) stride: usize,
}

impl<const D: usize> Potential<D> for FollowerPressure<D> {
    fn name(&self) -> &'static str {
        "pressure load"
    }
    fn views(&self) -> Views {
        USER
    }
    fn account(&self) -> Account {
        Account::User
    }
    fn spans(&self, visit: &mut dyn FnMut(u32, u32)) {
        for facet in &self.facets {
            let (mut low, mut high) = (facet[0], facet[0]);
            for &place in facet {
                low = low.min(place);
                high = high.max(place);
            }
            visit((low / self.stride) as u32, (high / self.stride) as u32);
        }
    }
    fn add_force(&self, _simd: Simd, view: &View<D>, _scratch: &[f64], tile: &mut Tile<D>) {
        let strength = -self.pressure * factor(&self.curve, view.time) / D as f64;
        for facet in &self.facets {
            if facet.iter().all(|p| !tile.range.contains(p)) {
                continue;
            }
            let corner = |n: usize| view.position(facet[n]);
            // Outward area vector: right of an edge, ½ (b − a) × (c − a) of a triangle.
            let mut area = [0.0; D];
            let (a, b) = (corner(0), corner(1));
            if D == 2 {
                area[0] = b[1] - a[1];
                area[1] = a[0] - b[0];
            } else {
                let c = corner(D - 1);
                for d in 0..3 {
                    let (e, f) = ((d + 1) % 3, (d + 2) % 3);
                    area[d] = 0.5 * ((b[e] - a[e]) * (c[f] - a[f]) - (b[f] - a[f]) * (c[e] - a[e]));
                }
            }
            for &place in facet {
                if tile.range.contains(&place) {
                    push(tile, view, place, area.map(|c| c * strength));
                }
            }
        }
    }
}

/// A spring, critically damped on the held mass, from a moving pointer to a node or to a point of a facet.
#[derive(Debug)]
pub(crate) struct Pull<const D: usize> {
    /// Places of the held nodes and their shares, which add up to one.
    pub(crate) held: Vec<(usize, f64)>,
    /// Path of the pointer, rows `[t, x, y(, z)]`; it grows while somebody leads the pointer.
    pub(crate) path: Arc<RwLock<Vec<Vec<f64>>>>,
    /// Stiffness [N/m].
    pub(crate) stiffness: f64,
    /// Damping [N·s/m].
    pub(crate) damping: f64,
    /// The largest force [N].
    pub(crate) largest_force: f64,
    /// How often it was reached.
    pub(crate) limited: Arc<AtomicU64>,
}

impl<const D: usize> Pull<D> {
    /// The held point, the pointer, and the force on the held point [N].
    pub(crate) fn force(&self, view: &View<D>) -> ([f64; D], [f64; D], [f64; D], bool) {
        let path = self.path.read().unwrap_or_else(PoisonError::into_inner);
        let (pointer, speed) = along_path::<D>(&path, view.time);
        let (mut x, mut v) = ([0.0; D], [0.0; D]);
        for (place, share) in &self.held {
            for d in 0..D {
                x[d] += share * view.x[d][*place];
                v[d] += share * view.v[d][*place];
            }
        }
        let mut force = [0.0; D];
        let mut square = 0.0;
        for d in 0..D {
            force[d] = self.stiffness * (pointer[d] - x[d]) + self.damping * (speed[d] - v[d]);
            square += force[d] * force[d];
        }
        let limited = square > self.largest_force * self.largest_force;
        if limited {
            let factor = self.largest_force / square.sqrt();
            force = force.map(|f| f * factor);
        }
        (x, pointer, force, limited)
    }
}

impl<const D: usize> Potential<D> for Pull<D> {
    fn name(&self) -> &'static str {
        "drag"
    }
    fn views(&self) -> Views {
        Views { damping: true, ..USER }
    }
    fn account(&self) -> Account {
        Account::User
    }
    /// The force is known before any node moves: nothing is read tile by tile.
    fn spans(&self, _visit: &mut dyn FnMut(u32, u32)) {}
    fn scratch_len(&self) -> usize {
        D
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
        for (place, share) in &self.held {
            if tile.range.contains(place) {
                let mut force = [0.0; D];
                for d in 0..D {
                    force[d] = share * scratch[d];
                }
                push(tile, view, *place, force);
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
    fn name(&self) -> &'static str {
        "user force"
    }
    fn views(&self) -> Views {
        USER
    }
    fn account(&self) -> Account {
        Account::User
    }
    fn spans(&self, _visit: &mut dyn FnMut(u32, u32)) {}
    fn add_force(&self, _simd: Simd, view: &View<D>, _scratch: &[f64], tile: &mut Tile<D>) {
        let stride = self.layout.stride();
        let nodes = tile.range.start / stride..tile.range.end.div_ceil(stride).min(view.nodes);
        for node in nodes {
            let place = self.layout.place(node, self.body);
            if tile.range.contains(&place) {
                let force = (self.law)(node as u32, view.position(place), view.velocity(place), view.time);
                push(tile, view, place, force);
            }
        }
    }
}
