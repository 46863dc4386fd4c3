//! Where the energy is and where it went.

use opruga_core::potential::Account;
use opruga_core::state::{Layout, View};
use opruga_core::system::{Stage, System, Work8};
use opruga_math::{Lane, Pack, WIDTH, Work, lanes, sum_in_fixed_order};

/// Energy of the world and what entered and left it since the start [J]; every channel is measured by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Kinetic energy ½ Σ m v².
    pub kinetic: f64,
    /// Elastic energy of the models.
    pub elastic: f64,
    /// Energy of the gas, ambient pressure included.
    pub gas: f64,
    /// Potential energy −Σ m g·x.
    pub gravity: f64,
    /// Work of loads, pushes, pulls and moving obstacles.
    pub work_user: f64,
    /// Energy given to the gas by ramps, heating and leaks.
    pub work_gas: f64,
    /// Energy taken by damping.
    pub loss_damping: f64,
    /// Energy taken by friction.
    pub loss_friction: f64,
    /// Energy taken by impacts.
    pub loss_contact: f64,
    /// What the other channels do not explain: error of the integrator, and positions put back by obstacles and pins.
    pub loss_integrator: f64,
    /// |loss_integrator| relative to the largest energy that was in motion.
    pub closure: f64,
}

impl Energy {
    /// Kinetic, elastic, gas and gravity together [J].
    pub fn total(&self) -> f64 {
        self.kinetic + self.elastic + self.gas + self.gravity
    }
}

/// Linear [kg m/s] and angular [kg m²/s] momentum; in the plane the latter is one number, in space three.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Momentum<const D: usize> {
    /// Σ m v.
    pub linear: Vector<D>,
    /// Σ m x × v about the origin; in the plane only the last number is used.
    pub angular: [f64; 3],
}

/// A vector with a default.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vector<const D: usize>(pub [f64; D]);
impl<const D: usize> Default for Vector<D> {
    fn default() -> Self {
        Vector([0.0; D])
    }
}

/// What one island has and did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Account1<const D: usize> {
    pub(crate) kinetic: f64,
    pub(crate) elastic: f64,
    pub(crate) gas: f64,
    pub(crate) gravity: f64,
    pub(crate) momentum: Momentum<D>,
}

/// Adds the numbers that belong to real bodies.
pub(crate) fn total_of<const D: usize>(system: &System<D>, parts: &[f64; WIDTH]) -> f64 {
    match system.layout {
        Layout::Single => sum_in_fixed_order(parts),
        Layout::Batch => parts[..system.bodies].iter().sum(),
    }
}

/// Takes stock of a system in its present state.
pub(crate) fn take_stock<const D: usize>(system: &mut System<D>) -> Account1<D> {
    let mut out = Account1::default();
    let time = system.time;
    let view = View {
        x: system.state.x.slices(),
        v: system.state.v.slices(),
        nodes: system.nodes,
        layout: system.layout,
        time,
    };
    for member in &mut system.members {
        // A model that refused the state would have ended the frame.
        let _ = member.potential.prepare(system.simd, &view, &member.memory, &mut member.scratch);
        if member.potential.views().energy {
            let energy = member.potential.energy(system.simd, &view, &member.scratch);
            let energy = match system.layout {
                Layout::Single => sum_in_fixed_order(&energy),
                Layout::Batch => energy[..system.bodies].iter().sum(),
            };
            match member.potential.account() {
                Account::Gas => out.gas += energy,
                _ => out.elastic += energy,
            }
        }
    }
    let motion = system.simd.run(Motion { system: &*system });
    out.kinetic = total_of(system, &motion[0]);
    let weight: [f64; D] = core::array::from_fn(|d| total_of(system, &motion[1 + d]));
    for d in 0..D {
        out.gravity -= system.gravity[d] * weight[d];
        out.momentum.linear.0[d] = total_of(system, &motion[4 + d]);
    }
    for axis in 0..3 {
        out.momentum.angular[axis] = total_of(system, &motion[7 + axis]);
    }
    out
}

/// ½mv², m x (three), m v (three), m x × v (three), eight partial sums each.
struct Motion<'a, const D: usize> {
    system: &'a System<D>,
}
impl<const D: usize> Work for Motion<'_, D> {
    type Output = [[f64; WIDTH]; 10];
    #[inline(always)]
    fn run<P: Pack>(self) -> Self::Output {
        let system = self.system;
        let view = system.view(Stage::Current, system.time);
        let end = system.nodes * system.layout.stride();
        let mut sums = [P::zero(); 10];
        for place in (0..end).step_by(WIDTH) {
            let mass: P = system.mass.load(place);
            let mass = if place + WIDTH <= end { mass } else { P::select(P::first(end - place), mass, P::zero()) };
            let x: [P; D] = lanes!(P, d => P::load(&view.x[d][place..]));
            let v: [P; D] = lanes!(P, d => P::load(&view.v[d][place..]));
            let mut square = P::zero();
            for d in 0..D {
                square += v[d] * v[d];
                sums[1 + d] += mass * x[d];
                sums[4 + d] += mass * v[d];
            }
            sums[0] += P::splat(0.5) * mass * square;
            sums[9] += mass * (x[0] * v[1] - x[1] * v[0]);
            if D == 3 {
                sums[7] += mass * (x[1] * v[D - 1] - x[D - 1] * v[1]);
                sums[8] += mass * (x[D - 1] * v[0] - x[0] * v[D - 1]);
            }
        }
        let mut out = [[0.0; WIDTH]; 10];
        for n in 0..10 {
            sums[n].store(&mut out[n]);
        }
        out
    }
}

/// What entered and left, added up over all frames since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Flows {
    pub(crate) user: f64,
    pub(crate) gas: f64,
    pub(crate) damping: f64,
    pub(crate) friction: f64,
    pub(crate) contact: f64,
    /// The energy at the start, moved by what commands put in or took out by changing the scene.
    pub(crate) start: f64,
    /// The largest energy in motion so far.
    pub(crate) largest: f64,
    pub(crate) limited_forces: u64,
    pub(crate) limited_velocities: u64,
    pub(crate) limited_pulls: u64,
}

impl Flows {
    pub(crate) fn add<const D: usize>(&mut self, system: &System<D>, work: &Work8) {
        self.user += total_of(system, &work.user);
        self.gas += total_of(system, &work.gas);
        self.damping += total_of(system, &work.damping);
        self.friction += total_of(system, &work.friction);
        self.contact += total_of(system, &work.contact);
        self.limited_forces += work.limited_forces;
        self.limited_velocities += work.limited_velocities;
    }
    /// The ledger for the present stock.
    pub(crate) fn ledger<const D: usize>(&mut self, stock: &[Account1<D>]) -> (Energy, Momentum<D>) {
        let mut energy = Energy {
            work_user: self.user,
            work_gas: self.gas,
            loss_damping: self.damping,
            loss_friction: self.friction,
            loss_contact: self.contact,
            ..Energy::default()
        };
        let mut momentum = Momentum::default();
        for island in stock {
            energy.kinetic += island.kinetic;
            energy.elastic += island.elastic;
            energy.gas += island.gas;
            energy.gravity += island.gravity;
            for d in 0..D {
                momentum.linear.0[d] += island.momentum.linear.0[d];
            }
            for axis in 0..3 {
                momentum.angular[axis] += island.momentum.angular[axis];
            }
        }
        let given = self.start + self.user + self.gas;
        let taken = self.damping + self.friction + self.contact;
        energy.loss_integrator = given - taken - energy.total();
        let moved = energy.kinetic + energy.elastic.abs() + (energy.gas + energy.gravity - self.start).abs();
        self.largest = self.largest.larger(moved);
        energy.closure = if self.largest > 0.0 { energy.loss_integrator.abs() / self.largest } else { 0.0 };
        (energy, momentum)
    }
}
