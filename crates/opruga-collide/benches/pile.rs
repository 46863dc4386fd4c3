//! Measures the time of contact in a pile of elastic cubes in a walled box and, for comparison, the time of their free motion:
//! `cargo bench -p opruga-collide --bench pile`.
#![allow(missing_docs)]

mod common;

use opruga_collide::{Laws, PairLaw, Touching};
use opruga_core::contacts::Touch;
use opruga_mesh::Mesh;
use std::time::Instant;

/// The number of nodes along an edge of a cube, and their distance at rest [m].
const NODES: usize = 5;
const SPACING: f64 = 0.2;
const MASS: f64 = 0.8;
const STIFFNESS: f64 = 8e3;
const DAMPING: f64 = 2.0;
/// The substep, and the number of substeps per frame.
const H: f64 = 1.0 / 60.0 / SUBSTEPS as f64;
const SUBSTEPS: usize = 20;

struct Pile {
    touching: Touching<3>,
    x: Vec<[f64; 3]>,
    v: Vec<[f64; 3]>,
    /// Two nodes and their distance at rest.
    springs: Vec<([u32; 2], f64)>,
    /// The node of every touching point.
    nodes: Vec<u32>,
    force: Vec<[f64; 3]>,
    width: f64,
}

/// A cube of nodes with the triangles of its sides.
fn cube(corner: [f64; 3]) -> Mesh<3> {
    let number = |at: [usize; 3]| (at[0] + NODES * (at[1] + NODES * at[2])) as u32;
    let mut mesh = Mesh::<3>::default();
    for k in 0..NODES * NODES * NODES {
        let at = [k % NODES, k / NODES % NODES, k / (NODES * NODES)];
        mesh.positions.push(std::array::from_fn(|d| corner[d] + SPACING * at[d] as f64));
    }
    for d in 0..3 {
        let (u, w) = ((d + 1) % 3, (d + 2) % 3);
        for side in [0, NODES - 1] {
            for (i, j) in (0..NODES - 1).flat_map(|i| (0..NODES - 1).map(move |j| (i, j))) {
                let at = |a: usize, b: usize| {
                    let mut at = [side; 3];
                    (at[u], at[w]) = (i + a, j + b);
                    number(at)
                };
                let [a, b, c, e] = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
                let outward = if side == 0 { [[a, c, b], [a, e, c]] } else { [[a, b, c], [a, c, e]] };
                mesh.facets.extend(outward);
            }
        }
    }
    mesh
}

fn pile(count: [usize; 3]) -> Pile {
    let (mut touching, mut out_x, mut springs, mut nodes) = (Touching::<3>::default(), vec![], vec![], vec![]);
    let bodies = count[0] * count[1] * count[2];
    for body in 0..bodies {
        let at = [body % count[0], body / count[0] % count[1], body / (count[0] * count[1])];
        let jitter = |k: usize| 0.03 * ((body * 7919 + k * 104_729) % 1000) as f64 / 1000.0;
        let mesh = cube(std::array::from_fn(|d| 0.1 + at[d] as f64 + jitter(d)));
        let first = out_x.len() as u32;
        for a in 0..mesh.positions.len() {
            for b in 0..a {
                let apart: [f64; 3] = std::array::from_fn(|d| mesh.positions[a][d] - mesh.positions[b][d]);
                let length = (apart[0] * apart[0] + apart[1] * apart[1] + apart[2] * apart[2]).sqrt();
                if length < 1.8 * SPACING {
                    springs.push(([first + a as u32, first + b as u32], length));
                }
            }
        }
        nodes.extend(touching.surface.add(&mesh, body as u32).iter().map(|node| first + node));
        out_x.extend(&mesh.positions);
    }
    let points = touching.surface.points();
    for columns in touching.before.iter_mut().chain(&mut touching.after) {
        columns.resize(points, [0.0; 3]);
    }
    touching.inverse_mass.resize(points, [1.0 / MASS; 3]);
    touching.laws = Laws {
        obstacles: 0,
        class: vec![0; bodies],
        classes: 1,
        table: vec![PairLaw { touch: true, friction: 0.5, restitution: 0.0, thickness: 0.01 * SPACING }],
        itself: vec![true],
        rest_speed: 0.05,
        recovery_speed: 0.5,
        thickest_elsewhere: [0.0; 2],
    };
    (touching.margin, touching.most) = (0.5 * SPACING, 10_000_000);
    let (v, force) = (vec![[0.0; 3]; out_x.len()], vec![[0.0; 3]; out_x.len()]);
    Pile { touching, x: out_x, v, springs, nodes, force, width: count[0] as f64 + 0.5 }
}

impl Pile {
    fn take(&mut self) {
        for (p, node) in self.nodes.iter().enumerate() {
            (self.touching.after[0][p], self.touching.after[1][p]) = (self.x[*node as usize], self.v[*node as usize]);
        }
    }

    fn walls(&self) -> [(usize, f64, f64); 5] {
        let far = self.width;
        [(1, 0.0, 1.0), (0, -0.5, 1.0), (0, far, -1.0), (2, -0.5, 1.0), (2, far, -1.0)]
    }

    fn free(&mut self) {
        let walls = self.walls();
        std::mem::swap(&mut self.touching.before, &mut self.touching.after);
        let Pile { x, v, springs, force, .. } = self;
        force.fill([0.0, -9.81 * MASS, 0.0]);
        for ([a, b], rest) in springs {
            let (a, b) = (*a as usize, *b as usize);
            let d: [f64; 3] = std::array::from_fn(|k| x[b][k] - x[a][k]);
            let length = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
            let rate = (0..3).map(|k| (v[b][k] - v[a][k]) * d[k]).sum::<f64>() / length;
            let f = (STIFFNESS * (length - *rest) + DAMPING * rate) / length;
            for k in 0..3 {
                force[a][k] += f * d[k];
                force[b][k] -= f * d[k];
            }
        }
        for p in 0..force.len() {
            for k in 0..3 {
                v[p][k] += H * force[p][k] / MASS;
                x[p][k] += H * v[p][k];
            }
            for (k, bound, sign) in walls {
                if sign * (x[p][k] - bound) < 0.0 {
                    (x[p][k], v[p]) = (bound, [0.0; 3]);
                }
            }
        }
        self.take();
    }

    fn touch(&mut self) {
        let walls = self.walls();
        let obstacles = |_: u32, from: &[f64; 3], to: &[f64; 3], reach: f64, visit: &mut dyn FnMut(Touch<3>)| {
            common::touch_walls(&walls, 0.5, [from, to], reach, visit);
        };
        self.touching.step(H, Some(&obstacles)).expect("no trouble");
        for p in &self.touching.changed {
            let (p, node) = (*p as usize, self.nodes[*p as usize] as usize);
            (self.x[node], self.v[node]) = (self.touching.after[0][p], self.touching.after[1][p]);
        }
    }
}

fn run(edge: usize, frames: usize) {
    let mut pile = pile([edge; 3]);
    pile.take();
    let points = pile.touching.surface.points();
    println!("{points} vertices");
    for block in 0..frames / 10 {
        let (mut free, mut touch) = (0.0, Vec::new());
        pile.touching.counts = Default::default();
        for _ in 0..10 {
            let mut of_frame = 0.0;
            for _ in 0..SUBSTEPS {
                let start = Instant::now();
                pile.free();
                free += start.elapsed().as_secs_f64();
                let start = Instant::now();
                pile.touch();
                of_frame += start.elapsed().as_secs_f64();
            }
            touch.push(of_frame);
        }
        common::report(10 * block, touch, free, &pile.touching.counts, points, &pile.x);
    }
    common::report_memory(&pile.touching, points);
}

fn main() {
    let number =
        |k: usize, otherwise: usize| std::env::args().filter_map(|a| a.parse().ok()).nth(k).unwrap_or(otherwise);
    run(number(0, 3), number(1, 130));
}
