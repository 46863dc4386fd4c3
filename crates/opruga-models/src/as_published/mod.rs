//! # The published ball
//!
//! The step of the program in D. Križaić, *Postupci izrade elastično deformabilnih objekata* (bachelor's thesis 2460,
//! University of Zagreb, 2012), reproduced up to rounding. The table compares the printed formulas with those that were meant.
//! Every edge of the outline is a spring between i and j, with d = x_i − x_j and r = |d|:
//!
//! - F_i −= (d/r) f, F_j += (d/r) f with f = (r − l) KS + ((v_i − v_j)·d) KD / r, if r ≠ 0;
//! - n = (d_y/r, −d_x/r), "volume" V = Σ ½ |d_x| |n_x| r;
//! - F_i += n p and F_j += n p with p = r · Pressure · (1/V) · 1000;
//! - F_y += MASS · GY once Pressure has reached FINAL_PRESSURE; Pressure grows by a hundredth of that per step;
//! - the mouse: with d = x − pointer and r = |d|, F −= (d/r)(r + (v·d)/r) on the vertex nearest to it;
//! - v_x += F_x/MASS · DT, v_y += F_y · DT, x += v · DT.
//!
//! For the engine, this is an ordinary model. `prepare` computes the forces. The memory of the model is the state of the ramp
//! and the vertex that the mouse holds. F_y is multiplied by the mass of its node, so that the integrator's division gives the
//! published v_y (E9). The published floor (y = 500, v_y = −½ v_y on crossing) is the engine's collider with restitution ½ and
//! no friction. Edges run with the interior to their left. With y downwards, this is the direction of the thesis. Node i of a spring is the
//! second node of its edge.
//!
//! ## Where it is not the physics
//!
//! | | as published | the physics (`mass_spring`, `pressure`) |
//! |---|---|---|
//! | E1 | Σ ½ \|Δx\| \|n_x\| r = Σ ½ \|Δx Δy\| is no area: 2πR²/N for a ring of N, so pressure depends on the number of vertices and on the orientation of the body | divergence theorem: A = ½ Σ (x_i y_j − x_j y_i) |
//! | E2 | both ends of an edge get its whole pressure force, which doubles the pressure | half to each end: P ∂V/∂x |
//! | E3 | a factor of 1000 takes the place of nRT | `nRT` or `pressure`, with units |
//! | E4 | no outside pressure, so the body is always inflated at rest | `ambient`; equal to the inner pressure, the rest shape is in equilibrium |
//! | E5 | no gravity while the pressure is ramped up | gravity always acts; `ramp` affects only the gas |
//! | E6 | the normal divides by r even if r = 0: a collapsed edge gives NaN (kept here) | finite in every state |
//! | E7 | the mouse's spring has stiffness and damping 1, whatever the scene, and divides by r = 0 on the vertex (kept) | the command `drag`: critically damped, stiffness in units of the scene |
//! | E8 | springs are counted by the number of points, which is right only on a ring | loops over edges |
//! | E9 | v_y is not divided by MASS: for MASS ≠ 1 the axes differ in inertia | one mass for both |
//! | E10 | in the text the ramp restores pressure and exempts vertices from gravity; the code ramps once, for all vertices | P follows from nRT/V at every instant |
//! | E11 | n is called the number of particles, with R | n is an amount in moles |

mod refusals;
mod spec;

pub use refusals::Refusal;
pub use spec::SPEC;

use opruga_core::error::{BuildError, StepError};
use opruga_core::potential::{Account, Ingredients, Model, Observe, Potential, Properties, Reading, Views};
use opruga_core::spec::{Spec, Values};
use opruga_core::state::{Layout, Parameter, View};
use opruga_core::system::along_path;
use opruga_core::tile::Tile;
use opruga_math::{Simd, WIDTH};

/// The kind of model that scenes call `as_published`.
#[derive(Debug)]
pub struct AsPublishedModel;

/// The published forces on one body, or on eight identical ones.
#[derive(Debug)]
pub struct AsPublished {
    layout: Layout,
    nodes: usize,
    /// The ends i, j of each spring.
    springs: Vec<[u32; 2]>,
    rest_length: Vec<f64>,
    mass: Parameter,
    constants: Vec<Constants>,
}

/// The constants of one body, by their names in the program.
#[derive(Clone, Debug)]
struct Constants {
    ks: f64,
    kd: f64,
    final_pressure: f64,
    factor: f64,
    gy: f64,
    pointer: Vec<Vec<f64>>,
    presses: Vec<[f64; 2]>,
}

/// The memory of each body: Pressure; the number of the press whose vertex is held, counted from 1, or 0 if none is held; and that vertex.
const MEMORY: usize = 3 * WIDTH;

/// The numbers that follow the forces in the scratch: "volume", press and vertex of each body.
const NUMBERS: usize = 3 * WIDTH;

impl<const D: usize> Model<D> for AsPublishedModel {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }
    fn batches(&self) -> bool {
        true
    }
    fn views(&self) -> Views {
        Views { energy: false, hessian: false, symmetric: false, damping: true }
    }
    fn build(&self, ingredients: &Ingredients<D>) -> Result<Box<dyn Potential<D>>, BuildError> {
        if D != 2 {
            return Err(Refusal::Dimension {}.into());
        }
        let mesh = ingredients.mesh;
        if mesh.facets.is_empty() {
            return Err(Refusal::NoOutline {}.into());
        }
        if ingredients.values.iter().any(|v| v.rows("pointer").is_empty() && !v.rows("held").is_empty()) {
            return Err(Refusal::NoPointer {}.into());
        }
        if ingredients.values.iter().any(|v| v.rows("held").iter().any(|row| row[1] <= row[0])) {
            return Err(Refusal::Interval {}.into());
        }
        let springs: Vec<[u32; 2]> = mesh.facets.iter().map(|f| [f[1], f[0]]).collect();
        let length = |&[i, j]: &[u32; 2]| {
            let (a, b) = (mesh.positions[i as usize], mesh.positions[j as usize]);
            ((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1])).sqrt()
        };
        Ok(Box::new(AsPublished {
            layout: ingredients.layout,
            nodes: mesh.positions.len(),
            rest_length: springs.iter().map(length).collect(),
            springs,
            mass: ingredients.mass.clone(),
            constants: ingredients.values.iter().map(|v| Constants::new(v)).collect(),
        }))
    }
}

impl Constants {
    fn new(values: &Values) -> Constants {
        let number = |name| values.number(name).unwrap_or(0.0);
        let pointer = values.rows("pointer").to_vec();
        let mut presses: Vec<[f64; 2]> = values.rows("held").iter().map(|row| [row[0], row[1]]).collect();
        if let (true, Some(first), Some(last)) = (presses.is_empty(), pointer.first(), pointer.last()) {
            presses.push([first[0], last[0]]);
        }
        Constants {
            ks: number("stiffness"),
            kd: number("damping"),
            final_pressure: number("final_pressure"),
            factor: number("factor"),
            gy: number("gravity_y"),
            pointer,
            presses,
        }
    }
    /// Returns the number of the press that is active at a time, counted from 1, or 0 if no press is active.
    fn press(&self, time: f64) -> usize {
        self.presses.iter().position(|[press, release]| *press <= time && time < *release).map_or(0, |n| n + 1)
    }
}

impl AsPublished {
    fn constants(&self, body: usize) -> &Constants {
        &self.constants[body.min(self.constants.len() - 1)]
    }

    /// Computes the published forces of a step on one body and returns its "volume".
    fn step<const D: usize>(&self, view: &View<D>, body: usize, pressure: f64, forces: &mut [f64]) -> f64 {
        let c = self.constants(body);
        let index_count = forces.len() / 2;
        let (fx, fy) = forces.split_at_mut(index_count);
        let at = |node: u32| self.layout.index(node as usize, body);

        // 1. Gravity, once the ramp has ended.
        for node in 0..self.nodes {
            let p = self.layout.index(node, body);
            fx[p] = 0.0;
            fy[p] = if pressure >= c.final_pressure { self.mass.at(p) * c.gy } else { 0.0 };
        }

        // 3. The springs, and 4. the "volume" from the normals of the springs.
        let mut volume = 0.0;
        for (&[i, j], &l) in self.springs.iter().zip(&self.rest_length) {
            let (i, j) = (at(i), at(j));
            let (dx, dy, r) = difference(view, i, j);
            if r != 0.0 {
                let (vx, vy) = (view.v[0][i] - view.v[0][j], view.v[1][i] - view.v[1][j]);
                let f = (r - l) * c.ks + (vx * dx + vy * dy) * c.kd / r;
                let (px, py) = (dx / r * f, dy / r * f);
                fx[i] -= px;
                fy[i] -= py;
                fx[j] += px;
                fy[j] += py;
            }
            volume += 0.5 * dx.abs() * (dy / r).abs() * r;
        }

        // 5. Pressure: each end of an edge gets the whole force on the edge.
        for &[i, j] in &self.springs {
            let (i, j) = (at(i), at(j));
            let (dx, dy, r) = difference(view, i, j);
            let p = r * pressure * (1.0 / volume) * c.factor;
            let (px, py) = (dy / r * p, -dx / r * p);
            fx[i] += px;
            fy[i] += py;
            fx[j] += px;
            fy[j] += py;
        }
        volume
    }

    /// 2. The mouse: pulls the vertex that it holds. Returns the number of the press, counted from 1, and the vertex that the mouse holds.
    ///    Returns zeros if no press is active.
    fn mouse<const D: usize>(&self, view: &View<D>, body: usize, memory: &[f64], forces: &mut [f64]) -> (usize, usize) {
        let c = self.constants(body);
        let press = c.press(view.time);
        if press == 0 {
            return (0, 0);
        }
        let (pointer, _) = along_path::<2>(&c.pointer, view.time);
        let away = |node: usize| {
            let p = self.layout.index(node, body);
            let (dx, dy) = (view.x[0][p] - pointer[0], view.x[1][p] - pointer[1]);
            (dx, dy, (dx * dx + dy * dy).sqrt())
        };
        let mut vertex = memory[2 * WIDTH + body] as usize;
        if memory[WIDTH + body] as usize != press {
            // A new press holds the nearest vertex; if several are equally near, the first of them.
            vertex = 0;
            for node in 1..self.nodes {
                if away(node).2 < away(vertex).2 {
                    vertex = node;
                }
            }
        }
        let (dx, dy, r) = away(vertex);
        let p = self.layout.index(vertex, body);
        let f = r + (view.v[0][p] * dx + view.v[1][p] * dy) / r;
        let index_count = forces.len() / 2;
        forces[p] -= dx / r * f;
        forces[index_count + p] -= dy / r * f;
        (press, vertex)
    }
}

/// d = x_i − x_j and its length.
fn difference<const D: usize>(view: &View<D>, i: usize, j: usize) -> (f64, f64, f64) {
    let (dx, dy) = (view.x[0][i] - view.x[0][j], view.x[1][i] - view.x[1][j]);
    (dx, dy, (dx * dx + dy * dy).sqrt())
}

impl<const D: usize> Potential<D> for AsPublished {
    fn properties(&self) -> Properties {
        Properties {
            account: Account::User,
            scratch_len: 2 * self.layout.index_count(self.nodes) + NUMBERS,
            forces_in_prepare: true,
            ..Properties::new(SPEC.kind, Views { energy: false, hessian: false, symmetric: false, damping: true })
        }
    }
    fn stencils(&self, visit: &mut dyn FnMut(&[u32])) {
        self.springs.iter().for_each(|spring| visit(spring));
    }
    fn initial_memory(&self) -> Vec<f64> {
        vec![0.0; MEMORY]
    }
    fn prepare(&self, _simd: Simd, view: &View<D>, memory: &[f64], scratch: &mut [f64]) -> Result<(), StepError> {
        let (forces, numbers) = scratch.split_at_mut(2 * self.layout.index_count(self.nodes));
        for body in 0..self.layout.stride() {
            numbers[body] = self.step(view, body, memory[body], forces);
            if numbers[body] == 0.0 {
                return Err(StepError::of(SPEC.kind, Refusal::NoPublishedVolume {}));
            }
            let (press, vertex) = self.mouse(view, body, memory, forces);
            numbers[WIDTH + body] = press as f64;
            numbers[2 * WIDTH + body] = vertex as f64;
        }
        // v_y += F_y DT without the division by MASS (E9).
        let index_count = forces.len() / 2;
        for p in 0..self.nodes * self.layout.stride() {
            forces[index_count + p] *= self.mass.at(p);
        }
        Ok(())
    }
    fn add_force(&self, _simd: Simd, view: &View<D>, scratch: &[f64], tile: &mut Tile<D>) {
        let index_count = self.layout.index_count(self.nodes);
        let end = tile.range.end.min(self.nodes * self.layout.stride());
        for p in tile.range.start..end {
            for d in 0..2 {
                let force = scratch[d * index_count + p];
                tile.force[d][p - tile.range.start] += force;
                tile.power[p % WIDTH] += force * view.v[d][p];
            }
        }
    }
    fn remember(&self, _simd: Simd, _view: &View<D>, _h: f64, scratch: &mut [f64], memory: &mut [f64]) -> [f64; WIDTH] {
        let numbers = &scratch[2 * self.layout.index_count(self.nodes)..];
        for body in 0..self.layout.stride() {
            // 7. The ramp.
            let goal = self.constants(body).final_pressure;
            if memory[body] < goal {
                memory[body] += goal / 100.0;
            }
            memory[WIDTH + body] = numbers[WIDTH + body];
            memory[2 * WIDTH + body] = numbers[2 * WIDTH + body];
        }
        [0.0; WIDTH]
    }
}

impl<const D: usize> Observe<D> for AsPublished {
    fn bonds(&self) -> &[[u32; 2]] {
        &self.springs
    }
    fn readings(&self, _view: &View<D>, scratch: &[f64], memory: &[f64], body: usize) -> Vec<Reading> {
        let numbers = &scratch[2 * self.layout.index_count(self.nodes)..];
        vec![("volume".into(), numbers[body]), ("pressure".into(), memory[body])]
    }
    fn heap_bytes(&self) -> usize {
        self.springs.capacity() * 8 + self.rest_length.capacity() * 8 + self.mass.heap_bytes()
    }
}
