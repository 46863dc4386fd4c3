//! Small models, written independently and in a simple way, since integrators do not depend on the crate of models.

use opruga_core::error::StepError;
use opruga_core::potential::{Definiteness, Observe, Potential, Properties, Sink, Views};
use opruga_core::state::{Columns, Layout, Parameter, View};
use opruga_core::system::System;
use opruga_core::tile::Tile;
use opruga_math::Simd;

/// Every node on a linear spring and damper to the origin.
#[derive(Debug)]
pub(crate) struct Anchors {
    pub(crate) stiffness: f64,
    pub(crate) damping: f64,
}

impl<const D: usize> Potential<D> for Anchors {
    fn properties(&self) -> Properties {
        Properties {
            uniform_damping: self.damping,
            ..Properties::new(
                "anchors",
                Views { energy: true, hessian: true, symmetric: true, damping: self.damping > 0.0 },
            )
        }
    }
    fn energy(&self, _simd: Simd, view: &View<D>, _scratch: &[f64]) -> [f64; 8] {
        let places = 0..view.nodes * view.layout.stride();
        let square: f64 = places.flat_map(|p| view.position(p)).map(|x| x * x).sum();
        [0.5 * self.stiffness * square, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    }
    fn hessian(&self, view: &View<D>, _scratch: &[f64], _keep: Definiteness, sink: &mut dyn Sink<D>) {
        (0..view.nodes).for_each(|p| sink.block(p, p, diagonal(self.stiffness)));
    }
    fn damping_matrix(&self, view: &View<D>, _scratch: &[f64], sink: &mut dyn Sink<D>) {
        (0..view.nodes).for_each(|p| sink.block(p, p, diagonal(self.damping)));
    }
    fn add_force(&self, _simd: Simd, view: &View<D>, _scratch: &[f64], tile: &mut Tile<D>) {
        for p in tile.range.clone() {
            for d in 0..D {
                tile.force[d][p - tile.range.start] -= self.stiffness * view.x[d][p] + self.damping * view.v[d][p];
                tile.power[p % 8] += self.damping * view.v[d][p] * view.v[d][p];
            }
        }
    }
}

impl<const D: usize> Observe<D> for Anchors {}

fn diagonal<const D: usize>(value: f64) -> [[f64; D]; D] {
    core::array::from_fn(|i| core::array::from_fn(|j| if i == j { value } else { 0.0 }))
}

/// One node on a spring and damper to the origin. Coordinate d starts with d + 1 times the amplitude.
pub(crate) fn oscillator<const D: usize>(mass: f64, stiffness: f64, damping: f64, x: f64, v: f64) -> System<D> {
    let (mut columns, mut velocities) = (Columns::zeros(8), Columns::zeros(8));
    columns.set(0, core::array::from_fn(|d| x * (d + 1) as f64));
    velocities.set(0, core::array::from_fn(|d| v * (d + 1) as f64));
    let mut system = System::new(Simd::best(), Layout::Single, 1, 1, columns, velocities, Parameter::uniform(mass));
    system.add(Box::new(Anchors { stiffness, damping }));
    system
}

/// Springs with damping along their axes, which may form a ring. In the plane the ring encloses an isothermal gas, p = nRT/A.
#[derive(Debug)]
pub(crate) struct Springs {
    pub(crate) pairs: Vec<[usize; 2]>,
    pub(crate) stiffness: f64,
    pub(crate) damping: f64,
    pub(crate) rest_length: f64,
    pub(crate) gas: f64,
}

impl Springs {
    /// Area inside the ring (its first two coordinates) by Gauss's theorem.
    fn area<const D: usize>(&self, view: &View<D>) -> f64 {
        let twice = |&[a, b]: &[usize; 2]| view.x[0][a] * view.x[1][b] - view.x[0][b] * view.x[1][a];
        0.5 * self.pairs.iter().map(twice).sum::<f64>()
    }
}

impl Springs {
    /// Delivers matrices with one factor along each spring and another across it.
    fn deliver<const D: usize>(&self, view: &View<D>, sink: &mut dyn Sink<D>, strength: impl Fn(f64) -> [f64; 2]) {
        for &[a, b] in &self.pairs {
            let d: [f64; D] = core::array::from_fn(|i| view.x[i][a] - view.x[i][b]);
            let length = d.iter().map(|c| c * c).sum::<f64>().sqrt();
            let [along, across] = strength(length);
            let block: [[f64; D]; D] = core::array::from_fn(|i| {
                core::array::from_fn(|j| {
                    let n = d[i] * d[j] / (length * length);
                    along * n + across * (if i == j { 1.0 } else { 0.0 } - n)
                })
            });
            let minus = block.map(|row| row.map(|c| -c));
            for (p, q, block) in [(a, a, block), (b, b, block), (a, b, minus), (b, a, minus)] {
                sink.block(p, q, block);
            }
        }
    }
}

impl<const D: usize> Potential<D> for Springs {
    fn properties(&self) -> Properties {
        Properties {
            scratch_len: 1,
            ..Properties::new(
                "springs",
                Views {
                    energy: true,
                    hessian: self.gas == 0.0,
                    symmetric: self.gas == 0.0,
                    damping: self.damping > 0.0,
                },
            )
        }
    }
    fn stencils(&self, visit: &mut dyn FnMut(&[u32])) {
        self.pairs.iter().for_each(|pair| visit(&pair.map(|node| node as u32)));
    }
    fn energy(&self, _simd: Simd, view: &View<D>, _scratch: &[f64]) -> [f64; 8] {
        let stretch = |&[a, b]: &[usize; 2]| {
            let d: [f64; D] = core::array::from_fn(|i| view.x[i][a] - view.x[i][b]);
            d.iter().map(|c| c * c).sum::<f64>().sqrt() - self.rest_length
        };
        let energy: f64 = self.pairs.iter().map(stretch).map(|s| 0.5 * self.stiffness * s * s).sum();
        [energy, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    }
    fn hessian(&self, view: &View<D>, _scratch: &[f64], keep: Definiteness, sink: &mut dyn Sink<D>) {
        self.deliver(view, sink, |length| {
            let across = self.stiffness * (1.0 - self.rest_length / length);
            [self.stiffness, if keep == Definiteness::Clamped && across < 0.0 { 0.0 } else { across }]
        });
    }
    fn damping_matrix(&self, view: &View<D>, _scratch: &[f64], sink: &mut dyn Sink<D>) {
        self.deliver(view, sink, |_| [self.damping, 0.0]);
    }
    fn prepare(&self, _simd: Simd, view: &View<D>, _memory: &[f64], scratch: &mut [f64]) -> Result<(), StepError> {
        scratch[0] = if self.gas > 0.0 { self.gas / self.area(view) } else { 0.0 };
        Ok(())
    }
    fn add_force(&self, _simd: Simd, view: &View<D>, scratch: &[f64], tile: &mut Tile<D>) {
        for &[a, b] in &self.pairs {
            let d: [f64; D] = core::array::from_fn(|i| view.x[i][a] - view.x[i][b]);
            let rate: [f64; D] = core::array::from_fn(|i| view.v[i][a] - view.v[i][b]);
            let length = d.iter().map(|c| c * c).sum::<f64>().sqrt();
            let speed = d.iter().zip(&rate).map(|(d, r)| d * r).sum::<f64>() / length;
            let tension = self.stiffness * (length - self.rest_length) + self.damping * speed;
            if tile.range.contains(&a) {
                tile.power[a % 8] += self.damping * speed * speed;
            }
            // Each end of an edge gets half of the force of the pressure, along the outer normal of the edge (counter-clockwise
            // rings).
            let normal = [-d[1], d[0]];
            for (end, sign) in [(a, -1.0), (b, 1.0)] {
                if tile.range.contains(&end) {
                    let k = end - tile.range.start;
                    for i in 0..D {
                        tile.force[i][k] += sign * tension * d[i] / length;
                    }
                    for i in 0..2 {
                        tile.force[i][k] += 0.5 * scratch[0] * normal[i];
                    }
                }
            }
        }
    }
}

impl<const D: usize> Observe<D> for Springs {}

const TWO_NODES: Springs = Springs { pairs: Vec::new(), stiffness: 30.0, damping: 0.0, rest_length: 1.0, gas: 0.0 };
const TWO_MASSES: [f64; 2] = [0.5, 1.5];

/// Two nodes of different mass on a stretched spring that spins, drifts and oscillates.
pub(crate) fn two_nodes<const D: usize>(damping: f64) -> System<D> {
    let (mut x, mut v) = (Columns::zeros(8), Columns::zeros(8));
    x.set(1, core::array::from_fn(|d| [1.2, 0.3, -0.4][d]));
    v.set(0, core::array::from_fn(|d| [0.5, -1.0, 0.7][d]));
    v.set(1, core::array::from_fn(|d| [-0.3, 2.0, 0.2][d]));
    let mass = Parameter::column(TWO_MASSES.to_vec());
    let mut system = System::new(Simd::best(), Layout::Single, 2, 1, x, v, mass);
    system.add(Box::new(Springs { pairs: vec![[0, 1]], damping, ..TWO_NODES }));
    system
}

/// Kinetic and elastic energy of [`two_nodes`] [J].
pub(crate) fn energy_of_two_nodes<const D: usize>(system: &System<D>) -> f64 {
    let square = |a: [f64; D]| a.iter().map(|c| c * c).sum::<f64>();
    let (a, b) = (system.state.x.at(0), system.state.x.at(1));
    let stretch = square(core::array::from_fn(|i| a[i] - b[i])).sqrt() - TWO_NODES.rest_length;
    let kinetic: f64 = (0..2).map(|p| 0.5 * TWO_MASSES[p] * square(system.state.v.at(p))).sum();
    kinetic + 0.5 * TWO_NODES.stiffness * stretch * stretch
}
