//! Measures the time of contact in a heap of gas balls in a box and, for comparison, the time of their free motion: `cargo
//! bench -p opruga-collide --bench heap`.
#![allow(missing_docs)]

mod common;

use opruga_collide::{Laws, PairLaw, Touching};
use opruga_core::contacts::Touch;
use opruga_mesh::Mesh;
use std::time::Instant;

const VERTICES: usize = 36;
const RADIUS: f64 = 0.5;
const APART: f64 = 1.15;
const STIFFNESS: f64 = 1600.0;
const DAMPING: f64 = 0.6;
const GAS: f64 = 55.0;
const MASS: f64 = 1.0 / VERTICES as f64;
/// The substep, and the number of substeps per frame.
const H: f64 = 1.0 / 60.0 / SUBSTEPS as f64;
const SUBSTEPS: usize = 32;

/// The length of an edge at rest [m].
fn edge() -> f64 {
    2.0 * RADIUS * libm::sin(std::f64::consts::PI / VERTICES as f64)
}

struct Heap {
    touching: Touching<2>,
    balls: usize,
    /// Planes: axis, position, sign of the normal.
    walls: [(usize, f64, f64); 3],
    force: Vec<[f64; 2]>,
}

fn heap(columns: usize, rows: usize) -> Heap {
    let mut touching = Touching::<2>::default();
    let edge = edge();
    for ball in 0..columns * rows {
        let jitter = |k: usize| 0.06 * ((ball * 7919 + k * 104_729) % 1000) as f64 / 1000.0;
        let center =
            [0.7 + APART * (ball % columns) as f64 + jitter(1), 0.7 + APART * (ball / columns) as f64 + jitter(2)];
        let positions: Vec<[f64; 2]> = (0..VERTICES)
            .map(|k| {
                let angle = std::f64::consts::TAU * k as f64 / VERTICES as f64;
                [center[0] + RADIUS * libm::cos(angle), center[1] + RADIUS * libm::sin(angle)]
            })
            .collect();
        let facets = (0..VERTICES as u32).map(|k| [k, (k + 1) % VERTICES as u32]).collect();
        touching.after[0].extend(&positions);
        touching.surface.add(&Mesh { positions, facets, ..Mesh::default() }, ball as u32);
    }
    let points = touching.surface.points();
    touching.after[1].resize(points, [0.0; 2]);
    touching.before = touching.after.clone();
    touching.inverse_mass.resize(points, [1.0 / MASS; 2]);
    touching.laws = Laws {
        obstacles: 0,
        class: vec![0; columns * rows],
        classes: 1,
        table: vec![PairLaw { touch: true, friction: 0.3, restitution: 0.0, thickness: 0.01 * edge }],
        itself: vec![true],
        rest_speed: 0.05,
        recovery_speed: 0.5,
        thickest_elsewhere: [0.0; 2],
    };
    (touching.margin, touching.most) = (0.5 * edge, 10_000_000);
    let width = 0.3 + APART * columns as f64;
    Heap {
        touching,
        balls: columns * rows,
        walls: [(1, 0.0, 1.0), (0, 0.0, 1.0), (0, width, -1.0)],
        force: vec![[0.0; 2]; points],
    }
}

impl Heap {
    fn free(&mut self) {
        std::mem::swap(&mut self.touching.before, &mut self.touching.after);
        let Heap { touching, force, .. } = self;
        let ([x, v], [x1, v1]) = (&touching.before, &mut touching.after);
        force.fill([0.0, -9.81 * MASS]);
        let edge = edge();
        for ball in 0..self.balls {
            let of = |k: usize| ball * VERTICES + k % VERTICES;
            let area: f64 =
                (0..VERTICES).map(|k| (x[of(k)], x[of(k + 1)])).map(|(p, q)| 0.5 * (p[0] * q[1] - p[1] * q[0])).sum();
            let pressure = GAS / area;
            for k in 0..VERTICES {
                let (a, b) = (of(k), of(k + 1));
                let d = [x[b][0] - x[a][0], x[b][1] - x[a][1]];
                let length = (d[0] * d[0] + d[1] * d[1]).sqrt();
                let rate = ((v[b][0] - v[a][0]) * d[0] + (v[b][1] - v[a][1]) * d[1]) / length;
                let f = (STIFFNESS * (length - edge) + DAMPING * rate) / length;
                let push = [0.5 * pressure * d[1], -0.5 * pressure * d[0]];
                for k in 0..2 {
                    force[a][k] += f * d[k] + push[k];
                    force[b][k] -= f * d[k] - push[k];
                }
            }
        }
        for p in 0..force.len() {
            for k in 0..2 {
                v1[p][k] = v[p][k] + H * force[p][k] / MASS;
                x1[p][k] = x[p][k] + H * v1[p][k];
            }
            for (k, bound, sign) in &self.walls {
                if sign * (x1[p][*k] - bound) < 0.0 {
                    (x1[p][*k], v1[p][*k]) = (*bound, 0.0);
                }
            }
        }
    }

    fn touch(&mut self) {
        let walls = self.walls;
        let obstacles = |_: u32, from: &[f64; 2], to: &[f64; 2], reach: f64, visit: &mut dyn FnMut(Touch<2>)| {
            common::touch_walls(&walls, 0.3, [from, to], reach, visit);
        };
        self.touching.step(H, Some(&obstacles)).expect("no trouble");
    }
}

fn run(columns: usize, rows: usize, frames: usize) {
    let mut heap = heap(columns, rows);
    let points = heap.touching.surface.points();
    println!("{points} vertices");
    for block in 0..frames / 10 {
        let (mut free, mut touch) = (0.0, Vec::new());
        heap.touching.counts = Default::default();
        for _ in 0..10 {
            let mut of_frame = 0.0;
            for _ in 0..SUBSTEPS {
                let start = Instant::now();
                heap.free();
                free += start.elapsed().as_secs_f64();
                let start = Instant::now();
                heap.touch();
                of_frame += start.elapsed().as_secs_f64();
            }
            touch.push(of_frame);
        }
        common::report(10 * block, touch, free, &heap.touching.counts, points, &heap.touching.after[0]);
    }
    common::report_memory(&heap.touching, points);
}

fn main() {
    let number =
        |k: usize, otherwise: usize| std::env::args().filter_map(|a| a.parse().ok()).nth(k).unwrap_or(otherwise);
    run(number(0, 50), number(1, 20), number(2, 60));
}
