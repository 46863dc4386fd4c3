//! The published ball, compared with a translation of the step of the thesis that does not use the engine.
#![allow(clippy::disallowed_methods)] // the program's sine and cosine

use crate::support;

use crate::support::models::AsPublished;
use opruga_core::spec::Values;
use opruga_core::system::System;
use opruga_mesh::Mesh;
use support::{refusal, system_with_mass};

const N: usize = 36;
const DT: f64 = 0.001;

#[derive(Clone, Copy, Default)]
struct Point {
    x: f64,
    y: f64,
    vx: f64,
    vy: f64,
    fx: f64,
    fy: f64,
}

#[derive(Clone, Copy, Default)]
struct Spring {
    i: usize,
    j: usize,
    length: f64,
    nx: f64,
    ny: f64,
}

/// The constants of thesis.md §2.
#[derive(Clone, Copy)]
struct Program {
    mass: f64,
    gy: f64,
    ks: f64,
    kd: f64,
    final_pressure: f64,
}

const PUBLISHED: Program = Program { mass: 1.0, gy: 10.0, ks: 1600.0, kd: 40.0, final_pressure: 100.0 };

struct Ball {
    program: Program,
    points: [Point; N],
    springs: [Spring; N],
    pressure: f64,
    held: Option<usize>,
}

impl Ball {
    fn new(program: Program) -> Ball {
        let mut points = [Point::default(); N];
        for (i, p) in points.iter_mut().enumerate() {
            let angle = 2.0 * std::f64::consts::PI * i as f64 / N as f64;
            (p.x, p.y) = (200.0 + 100.0 * angle.sin(), 200.0 + 100.0 * angle.cos());
        }
        let mut springs = [Spring::default(); N];
        for (s, spring) in springs.iter_mut().enumerate() {
            (spring.i, spring.j) = (s, (s + 1) % N);
            let (a, b) = (points[spring.i], points[spring.j]);
            spring.length = ((a.x - b.x).powi(2) + (a.y - b.y).powi(2)).sqrt();
        }
        Ball { program, points, springs, pressure: 0.0, held: None }
    }

    fn step(&mut self, mouse: Option<(f64, f64)>, floor: f64) {
        let c = self.program;
        // 1
        for p in &mut self.points {
            p.fx = 0.0;
            p.fy = if self.pressure >= c.final_pressure { c.mass * c.gy } else { 0.0 };
        }
        // 2
        match mouse {
            Some((mx, my)) => {
                if self.held.is_none() {
                    let mut nearest = 0;
                    let mut distance = f64::INFINITY;
                    for (i, p) in self.points.iter().enumerate() {
                        let d = (p.x - mx).powi(2) + (p.y - my).powi(2);
                        if d < distance {
                            (nearest, distance) = (i, d);
                        }
                    }
                    self.held = Some(nearest);
                }
                let p = &mut self.points[self.held.unwrap()];
                let (dx, dy) = (p.x - mx, p.y - my);
                let r = (dx * dx + dy * dy).sqrt();
                let f = r + (p.vx * dx + p.vy * dy) / r;
                p.fx -= dx / r * f;
                p.fy -= dy / r * f;
            }
            None => self.held = None,
        }
        // 3
        for s in &mut self.springs {
            let (a, b) = (self.points[s.i], self.points[s.j]);
            let (dx, dy) = (a.x - b.x, a.y - b.y);
            let r = (dx * dx + dy * dy).sqrt();
            if r != 0.0 {
                let f = (r - s.length) * c.ks + ((a.vx - b.vx) * dx + (a.vy - b.vy) * dy) * c.kd / r;
                self.points[s.i].fx -= dx / r * f;
                self.points[s.i].fy -= dy / r * f;
                self.points[s.j].fx += dx / r * f;
                self.points[s.j].fy += dy / r * f;
            }
            s.nx = (a.y - b.y) / r;
            s.ny = -(a.x - b.x) / r;
        }
        // 4
        let mut volume = 0.0;
        for s in &self.springs {
            let (a, b) = (self.points[s.i], self.points[s.j]);
            let r = ((a.x - b.x).powi(2) + (a.y - b.y).powi(2)).sqrt();
            volume += 0.5 * (a.x - b.x).abs() * s.nx.abs() * r;
        }
        // 5
        for s in &self.springs {
            let (a, b) = (self.points[s.i], self.points[s.j]);
            let r = ((a.x - b.x).powi(2) + (a.y - b.y).powi(2)).sqrt();
            let p = r * self.pressure * (1.0 / volume) * 1000.0;
            for end in [s.i, s.j] {
                self.points[end].fx += s.nx * p;
                self.points[end].fy += s.ny * p;
            }
        }
        // 6
        for p in &mut self.points {
            p.vx += p.fx / c.mass * DT;
            p.vy += p.fy * DT;
            p.x += p.vx * DT;
            p.y += p.vy * DT;
            if p.y > floor {
                p.y = floor;
                p.vy *= -0.5;
            }
        }
        // 7
        if self.pressure < c.final_pressure {
            self.pressure += c.final_pressure / 100.0;
        }
    }
}

/// Symplectic Euler with the forces of the model, then the floor as a half-space with restitution ½ and no friction.
fn step(system: &mut System<2>, mass: f64, floor: f64) {
    let force = system.forces(true).unwrap();
    for node in 0..N {
        let (mut x, mut v, f) = (system.state.x.at(node), system.state.v.at(node), force.at(node));
        for d in 0..2 {
            v[d] += f[d] * (DT / mass);
            x[d] += v[d] * DT;
        }
        if x[1] > floor {
            x[1] = floor;
            v[1] *= -0.5;
        }
        system.state.x.set(node, x);
        system.state.v.set(node, v);
    }
    system.finish_step(DT);
}

/// Returns the node of the engine's ring for a vertex of the program. The engine's ring runs in the opposite direction.
fn node(vertex: usize) -> usize {
    (N - vertex) % N
}

fn ring() -> Mesh<2> {
    // Vertex 0 is at the angle π/2, below the centre on the screen.
    Mesh::ring(100.0, N as u32, [200.0, 200.0], std::f64::consts::FRAC_PI_2).unwrap()
}

/// The largest deviation of positions, relative to the radius, over all steps.
fn deviation(
    program: Program,
    values: Values,
    steps: usize,
    floor: f64,
    mouse: &dyn Fn(f64) -> Option<(f64, f64)>,
) -> f64 {
    let mut ball = Ball::new(program);
    let mut system = system_with_mass(&ring(), &[(&AsPublished, values)], program.mass);
    let (mut worst, mut bounced, mut pulled) = (0.0, false, false);
    for _ in 0..steps {
        let pointer = mouse(system.time);
        pulled |= pointer.is_some();
        ball.step(pointer, floor);
        step(&mut system, program.mass, floor);
        for (vertex, p) in ball.points.iter().enumerate() {
            let x = system.state.x.at(node(vertex));
            let v = system.state.v.at(node(vertex));
            for difference in [x[0] - p.x, x[1] - p.y, DT * (v[0] - p.vx), DT * (v[1] - p.vy)] {
                assert!(difference.is_finite());
                worst = if difference.abs() > worst { difference.abs() } else { worst };
            }
            bounced |= p.y == floor;
        }
    }
    assert!(bounced, "it never met the floor");
    assert!(pulled, "it was never pulled");
    worst / 100.0
}

const PATH: [[f64; 3]; 4] = [[0.0, 420.0, 150.0], [0.5, 380.0, 90.0], [1.0, 120.0, 400.0], [2.5, 60.0, 300.0]];
const HELD: [[f64; 2]; 2] = [[0.25, 0.6], [0.9, 1.7]];

/// The position of the pointer while the button is held.
fn mouse(time: f64) -> Option<(f64, f64)> {
    if !HELD.iter().any(|[press, release]| *press <= time && time < *release) {
        return None;
    }
    for w in PATH.windows(2) {
        if time < w[1][0] {
            let s = (time - w[0][0]) / (w[1][0] - w[0][0]);
            return Some((w[0][1] + s * (w[1][1] - w[0][1]), w[0][2] + s * (w[1][2] - w[0][2])));
        }
    }
    None
}

/// Ramp, flight, two pulls and the floor: 2,000 steps of the defaults, to 1e-9.
#[test]
fn two_thousand_steps() {
    let values = values!(as_published, pointer: &PATH, held: &HELD);
    let error = deviation(PUBLISHED, values, 2000, 345.0, &mouse);
    println!("MASS = 1: {error:.1e}");
    assert!(error < 1e-9, "{error:e}");
}

/// With a mass other than 1, the axes differ in inertia (E9). The other constants are changed too.
#[test]
fn other_constants() {
    let program = Program { mass: 2.5, gy: 35.0, ks: 1200.0, kd: 25.0, final_pressure: 60.0 };
    let values = values!(
        as_published,
        pointer: &PATH,
        held: &HELD,
        stiffness: 1200.0,
        damping: 25.0,
        final_pressure: 60.0,
        gravity_y: 35.0
    );
    let error = deviation(program, values, 2000, 330.0, &mouse);
    println!("MASS = 2.5: {error:.1e}");
    assert!(error < 1e-9, "{error:e}");
}

/// The published floor at 500: the ball falls for more than five seconds and bounces.
#[test]
fn onto_the_published_floor() {
    let still = |time: f64| (1.0..1.2).contains(&time).then_some((500.0, 200.0));
    let values = values!(as_published, pointer: &[[1.0, 500.0, 200.0], [1.2, 500.0, 200.0]]);
    let error = deviation(PUBLISHED, values, 8000, 500.0, &still);
    println!("8000 steps: {error:.1e}");
    assert!(error < 1e-9, "{error:e}");
}

/// Thesis.md §4: in flight the ball settles about a mean radius of 131.
#[test]
fn mean_radius_in_flight() {
    let mut system = system_with_mass(&ring(), &[(&AsPublished, values!(as_published))], 1.0);
    let (mut sum, mut count) = (0.0, 0.0);
    for number in 0..5000 {
        step(&mut system, 1.0, f64::INFINITY);
        if number < 2000 {
            continue;
        }
        let points: Vec<[f64; 2]> = (0..N).map(|n| system.state.x.at(n)).collect();
        let center = [0, 1].map(|d| points.iter().map(|p| p[d]).sum::<f64>() / N as f64);
        let radius = |p: &[f64; 2]| ((p[0] - center[0]).powi(2) + (p[1] - center[1]).powi(2)).sqrt();
        sum += points.iter().map(radius).sum::<f64>() / N as f64;
        count += 1.0;
    }
    println!("mean radius {}", sum / count);
    assert!((sum / count - 131.0).abs() < 1.0, "{}", sum / count);
}

/// Refusals name the problem.
#[test]
fn refusals() {
    let refused = |values| refusal(&ring(), &AsPublished, values);
    assert_eq!(
        refused(values!(as_published, held: &[[0.1, 0.2]])),
        "model.one_of as_published: `held` needs `pointer`"
    );
    assert_eq!(
        refused(values!(as_published, pointer: &PATH, held: &[[0.1, 0.05]])),
        "model.interval as_published: each row of `held` must be [press, release] with press < release"
    );
    assert_eq!(
        refusal(&Mesh::icosphere(1.0, 1).unwrap(), &AsPublished, values!(as_published)),
        "model.dimension as_published: the published program is two-dimensional; allowed: dimension = 2"
    );
}
