//! The energy ledger: the energies, the work and the losses of a world.

use opruga_core::potential::Account;
use opruga_core::state::{Layout, View};
use opruga_core::system::{SolverWork, System, Work8};
use opruga_math::{Lane, Pack, Strip, WIDTH, Work, lanes, sum_in_fixed_order};

/// The energies of the world, and the work and the losses since the start [J]. Every channel is measured separately.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Kinetic energy ½ v·M v, with lumped masses ½ Σ m v².
    pub kinetic: f64,
    /// Elastic energy of the models.
    pub elastic: f64,
    /// Energy of the gas, ambient pressure included.
    pub gas: f64,
    /// Potential energy −Σ m g·x.
    pub gravity: f64,
    /// Work of loads, pushes, pulls, moving obstacles and pins, plus the energy of changes of the scene: parameters that were set, bodies that were
    /// added or removed.
    pub work_user: f64,
    /// Energy that ramps, heating and leaks supply to the gas.
    pub work_gas: f64,
    /// Energy dissipated by damping.
    pub loss_damping: f64,
    /// Energy dissipated by friction.
    pub loss_friction: f64,
    /// Energy lost in impacts.
    pub loss_contact: f64,
    /// Energy that obstacles supply when they put nodes back on their surface: the work against the forces on those nodes, to first order in the
    /// depth.
    pub work_correction: f64,
    /// Energy that implicit integrators dissipate numerically, from the formula of each integrator; negative if an integrator has added energy.
    pub loss_numerical: f64,
    /// The remainder: the error of explicit integrators, and the residual of the equations of implicit ones.
    pub loss_integrator: f64,
    /// |loss_integrator| relative to `in_motion`.
    pub closure: f64,
    /// The largest energy in motion so far, or the energy that rounding alone may add to a body at rest, if that is larger.
    pub in_motion: f64,
}

impl Energy {
    /// The sum of kinetic, elastic, gas and gravity [J].
    pub fn total(&self) -> f64 {
        self.kinetic + self.elastic + self.gas + self.gravity
    }

    /// The energy that neither a model nor an obstacle has removed or added, relative to `in_motion`: the numerical loss plus the remainder.
    pub fn drift(&self) -> f64 {
        self.part_in_motion(self.loss_numerical + self.loss_integrator)
    }

    /// Whether the numerical loss or gain of integrators is so large that the frame is counted.
    pub(crate) fn is_damped_by_rules(&self) -> bool {
        self.part_in_motion(self.loss_numerical) > LARGEST_DAMPING
    }

    /// Whether the numerical loss changes what a user sees: integrators have removed more energy than damping, friction and impacts together, so most
    /// motion has ended without a physical cause. Integrators never add energy for a physical reason.
    pub(crate) fn rules_prevail(&self) -> bool {
        let physical = self.loss_damping + self.loss_friction + self.loss_contact;
        self.is_damped_by_rules() && (self.loss_numerical < 0.0 || self.loss_numerical > physical)
    }

    /// Whether every number is finite.
    pub(crate) fn is_finite(&self) -> bool {
        let works = self.work_user + self.work_gas + self.work_correction;
        let losses = self.loss_damping + self.loss_friction + self.loss_contact + self.loss_numerical;
        (self.total() + works + losses + self.loss_integrator + self.closure + self.in_motion).is_finite()
    }

    /// The absolute value of an energy relative to the energy in motion; zero if nothing has moved.
    pub(crate) fn part_in_motion(&self, energy: f64) -> f64 {
        if self.in_motion > 0.0 { energy.abs() / self.in_motion } else { 0.0 }
    }
}

/// The linear [kg m/s] and the angular [kg m²/s] momentum; the angular momentum is one number in the plane and three in space.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Momentum<const D: usize> {
    /// Σ m v.
    pub linear: Vector<D>,
    /// Σ m x × v about the origin; in the plane only the last number is used.
    pub angular: [f64; 3],
}

impl<const D: usize> Momentum<D> {
    /// Whether every number is finite.
    pub(crate) fn is_finite(&self) -> bool {
        self.linear.0.iter().chain(&self.angular).all(|x| x.is_finite())
    }
}

/// A vector whose default is zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vector<const D: usize>(pub [f64; D]);
impl<const D: usize> Default for Vector<D> {
    fn default() -> Self {
        Vector([0.0; D])
    }
}

/// Energies of one island at the end of a frame [J].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Stock {
    pub(crate) elastic: f64,
    pub(crate) gas: f64,
    /// The sum of the sizes of the terms whose differences are the elastic energies.
    pub(crate) parts: f64,
}

/// A survey of all nodes of an island: motion, bounds, and whether every number is finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Survey<const D: usize> {
    pub(crate) mass: f64,
    pub(crate) kinetic: f64,
    pub(crate) gravity: f64,
    pub(crate) momentum: Momentum<D>,
    /// Lowest and highest position [m].
    pub(crate) position: [[f64; D]; 2],
    /// Lowest and highest velocity [m/s].
    pub(crate) velocity: [[f64; D]; 2],
    pub(crate) finite: bool,
}

/// Adds up eight parts: the parts of a single body, or the parts of the bodies of a batch without its unused lanes.
pub(crate) fn total_of<const D: usize>(system: &System<D>, parts: &[f64; WIDTH]) -> f64 {
    match system.layout {
        Layout::Single => sum_in_fixed_order(parts),
        Layout::Batch => parts[..system.bodies].iter().sum(),
    }
}

/// The energies of the models of a system in its present state.
pub(crate) fn take_stock<const D: usize>(system: &mut System<D>) -> Stock {
    let mut out = Stock::default();
    let time = system.time;
    let view = View {
        x: system.state.x.slices(),
        v: system.state.v.slices(),
        nodes: system.nodes,
        layout: system.layout,
        time,
        threads: system.threads,
    };
    for member in &mut system.members {
        if !member.potential.properties().views.energy {
            continue;
        }
        // A model that refuses the state would have ended the frame.
        let _ = member.potential.prepare(system.simd, &view, &member.memory, &mut member.scratch);
        let energy = member.potential.energy(system.simd, &view, &member.scratch);
        let energy = match system.layout {
            Layout::Single => sum_in_fixed_order(&energy),
            Layout::Batch => energy[..system.bodies].iter().sum(),
        };
        match member.potential.properties().account {
            Account::Gas => out.gas += energy,
            _ => out.elastic += energy,
        }
        out.parts += member.potential.energy_parts();
    }
    out
}

/// Surveys all nodes of a system in one pass.
pub(crate) fn survey<const D: usize>(system: &System<D>) -> Survey<D> {
    let sums = system.simd.run(Look { system });
    let mut momentum = Momentum::default();
    let mut gravity = 0.0;
    for d in 0..D {
        gravity -= system.gravity[d] * total_of(system, &sums.weight[d]);
        momentum.linear.0[d] = total_of(system, &sums.linear[d]);
    }
    for axis in 0..3 {
        momentum.angular[axis] = total_of(system, &sums.angular[axis]);
    }
    let least = |lanes: &[[f64; WIDTH]; D]| lanes.map(|l| l.into_iter().fold(f64::INFINITY, Lane::smaller));
    let most = |lanes: &[[f64; WIDTH]; D]| lanes.map(|l| l.into_iter().fold(f64::NEG_INFINITY, Lane::larger));
    let coupled = coupled_motion(system, &mut momentum);
    Survey {
        mass: total_of(system, &sums.mass),
        kinetic: total_of(system, &sums.kinetic) + coupled,
        gravity,
        momentum,
        position: [least(&sums.position[0]), most(&sums.position[1])],
        velocity: [least(&sums.velocity[0]), most(&sums.velocity[1])],
        finite: sums.finite.iter().all(|x| *x == 0.0),
    }
}

/// The part that a mass matrix with coupled nodes adds to the momentum, and to the kinetic energy [J].
fn coupled_motion<const D: usize>(system: &System<D>, momentum: &mut Momentum<D>) -> f64 {
    let Some(inertia) = &system.inertia else { return 0.0 };
    let v = system.node_by_node(&system.state.v);
    for node in 0..system.nodes {
        let (x, own) = (system.state.x.at(node), inertia.product::<D>(node, &v));
        for d in 0..D {
            momentum.linear.0[d] += own[d];
        }
        momentum.angular[2] += x[0] * own[1] - x[1] * own[0];
        if D == 3 {
            let z = D - 1;
            momentum.angular[0] += x[1] * own[z] - x[z] * own[1];
            momentum.angular[1] += x[z] * own[0] - x[0] * own[z];
        }
    }
    0.5 * inertia.square::<D>(&v)
}

/// The results of [`survey`], each in eight partial sums.
struct Looked<const D: usize> {
    mass: [f64; WIDTH],
    kinetic: [f64; WIDTH],
    weight: [[f64; WIDTH]; D],
    linear: [[f64; WIDTH]; D],
    angular: [[f64; WIDTH]; 3],
    position: [[[f64; WIDTH]; D]; 2],
    velocity: [[[f64; WIDTH]; D]; 2],
    finite: [f64; WIDTH],
}

struct Look<'a, const D: usize> {
    system: &'a System<D>,
}
impl<const D: usize> Work for Look<'_, D> {
    type Output = Looked<D>;
    #[inline(always)]
    fn run<P: Pack>(self) -> Looked<D> {
        let system = self.system;
        let end = system.nodes * system.layout.stride();
        let packed = end.next_multiple_of(WIDTH);
        let x = Strip::<D>::new(&system.state.x.slices(), 0, packed);
        let v = Strip::<D>::new(&system.state.v.slices(), 0, packed);
        let masses = system.mass.strip(0, packed);
        let heft = system.weighing().strip(0, packed);
        let (mut all, mut kinetic, mut finite) = (P::zero(), P::zero(), P::zero());
        let (mut weight, mut linear, mut angular) = ([P::zero(); D], [P::zero(); D], [P::zero(); 3]);
        let (mut low, mut high) = ([P::splat(f64::INFINITY); D], [P::splat(f64::NEG_INFINITY); D]);
        let (mut slow, mut fast) = (low, high);
        for k in (0..packed).step_by(WIDTH) {
            let mut mass: P = masses.load(k);
            let mut weighs: P = heft.load(k);
            let mut position: [P; D] = lanes!(P, d => x.load(d, k));
            let mut velocity: [P; D] = lanes!(P, d => v.load(d, k));
            if k + WIDTH > end {
                // Entries after the last node have no mass, and the position of the first node of the pack.
                let real = P::first(end - k);
                mass = P::select(real, mass, P::zero());
                weighs = P::select(real, weighs, P::zero());
                for d in 0..D {
                    position[d] = P::select(real, position[d], P::splat(position[d].to_array()[0]));
                    velocity[d] = P::select(real, velocity[d], P::splat(velocity[d].to_array()[0]));
                }
            }
            let mut square = P::zero();
            for d in 0..D {
                let momentum = mass * velocity[d];
                square += velocity[d] * momentum;
                weight[d] += weighs * position[d];
                linear[d] += momentum;
                low[d] = position[d].smaller(low[d]);
                high[d] = position[d].larger(high[d]);
                slow[d] = velocity[d].smaller(slow[d]);
                fast[d] = velocity[d].larger(fast[d]);
                // Zero times a finite number is zero; zero times infinity or NaN is not.
                finite += (position[d] + velocity[d]) * P::zero();
            }
            all += mass;
            kinetic += square;
            angular[2] += mass * (position[0] * velocity[1] - position[1] * velocity[0]);
            if D == 3 {
                let z = D - 1;
                angular[0] += mass * (position[1] * velocity[z] - position[z] * velocity[1]);
                angular[1] += mass * (position[z] * velocity[0] - position[0] * velocity[z]);
            }
        }
        let mut out = Looked {
            mass: all.to_array(),
            kinetic: (kinetic * P::splat(0.5)).to_array(),
            weight: [[0.0; WIDTH]; D],
            linear: [[0.0; WIDTH]; D],
            angular: [angular[0].to_array(), angular[1].to_array(), angular[2].to_array()],
            position: [[[0.0; WIDTH]; D]; 2],
            velocity: [[[0.0; WIDTH]; D]; 2],
            finite: finite.to_array(),
        };
        for d in 0..D {
            out.weight[d] = weight[d].to_array();
            out.linear[d] = linear[d].to_array();
            out.position[0][d] = low[d].to_array();
            out.position[1][d] = high[d].to_array();
            out.velocity[0][d] = slow[d].to_array();
            out.velocity[1][d] = fast[d].to_array();
        }
        out
    }
}

/// The unexplained energy, relative to the energy in motion, above which a frame is counted and causes a warning.
pub(crate) const LARGEST_CLOSURE: f64 = 0.1;

/// The numerical loss, relative to the energy in motion, above which a frame is counted. This limit is half of the limit for the unexplained energy,
/// because the loss is known and has the same sign in every step.
pub(crate) const LARGEST_DAMPING: f64 = 0.05;

/// The relative error of a number after many roundings.
const ROUNDING: f64 = 1e-13;

/// Ten times the rounding error of a difference of numbers, relative to the numbers. The ledger therefore still closes if a few rounding errors of
/// 1e-16 all have the same sign.
const CANCELLATION: f64 = 1e-14;

impl<const D: usize> Survey<D> {
    /// The energy of motions that consist of rounding errors [J]. In a step of h [s], every node is assumed to have an error of one rounding of the
    /// largest coordinate.
    fn of_rounding(&self, h: f64) -> f64 {
        let ends = self.position.iter().flatten();
        let farthest = ends.fold(0.0, |most: f64, x| most.larger(x.abs()));
        let speed = ROUNDING * farthest / h;
        if speed.is_finite() { self.mass * speed * speed } else { 0.0 }
    }
}

/// Work and losses, summed over all frames since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Flows {
    pub(crate) user: f64,
    pub(crate) gas: f64,
    pub(crate) damping: f64,
    pub(crate) friction: f64,
    pub(crate) contact: f64,
    pub(crate) correction: f64,
    /// The numerical loss of integrators.
    pub(crate) numerical: f64,
    /// The energy at the start, plus the energy that changes of the scene added or removed.
    pub(crate) start: f64,
    /// The energy that changes of the scene added so far, minus the energy that they removed.
    pub(crate) changed: f64,
    /// The largest energy in motion so far.
    pub(crate) largest: f64,
    pub(crate) limited_forces: u64,
    pub(crate) limited_velocities: u64,
    pub(crate) limited_pulls: u64,
    /// The number of bodies that were removed because they went too far.
    pub(crate) lost_bodies: u64,
    /// The work of implicit integrators.
    pub(crate) solver: SolverWork,
    /// Frames that ended with an unexplained energy above [`LARGEST_CLOSURE`].
    pub(crate) open_frames: u64,
    /// Frames that ended with a numerical loss above [`LARGEST_DAMPING`].
    pub(crate) damped_frames: u64,
}

impl Flows {
    /// Adds the work and the losses of an island since the start of the last frame, and the numerical loss of its integrator
    /// [J].
    pub(crate) fn add<const D: usize>(&mut self, system: &System<D>, numerical_loss: f64, work: &Work8) {
        self.numerical += numerical_loss;
        self.user += total_of(system, &work.user);
        self.gas += total_of(system, &work.gas);
        self.damping += total_of(system, &work.damping);
        self.friction += total_of(system, &work.friction);
        self.contact += total_of(system, &work.contact);
        self.correction += total_of(system, &work.correction);
        self.limited_forces += work.limited_forces;
        self.limited_velocities += work.limited_velocities;
        self.solver.add(&work.solver);
    }
    /// Counts a frame that ended with this ledger, if a warning may be due. The ledger of models without an energy does not close.
    pub(crate) fn count_frame(&mut self, energy: &Energy, has_energy: impl FnOnce() -> bool) {
        self.open_frames += u64::from(energy.closure > LARGEST_CLOSURE && has_energy());
        self.damped_frames += u64::from(energy.is_damped_by_rules());
    }
    /// Makes the ledger from the present energies, after steps of h [s].
    pub(crate) fn ledger<'a, const D: usize>(
        &mut self,
        h: f64,
        islands: impl Iterator<Item = (&'a Stock, &'a Survey<D>)>,
    ) -> (Energy, Momentum<D>) {
        let mut energy = Energy {
            work_user: self.user + self.changed,
            work_gas: self.gas,
            loss_damping: self.damping,
            loss_friction: self.friction,
            loss_contact: self.contact,
            work_correction: self.correction,
            loss_numerical: self.numerical,
            ..Energy::default()
        };
        let mut momentum = Momentum::default();
        let mut rounding = 0.0;
        for (stock, survey) in islands {
            rounding += survey.of_rounding(h) + CANCELLATION * stock.parts;
            energy.kinetic += survey.kinetic;
            energy.elastic += stock.elastic;
            energy.gas += stock.gas;
            energy.gravity += survey.gravity;
            for d in 0..D {
                momentum.linear.0[d] += survey.momentum.linear.0[d];
            }
            for axis in 0..3 {
                momentum.angular[axis] += survey.momentum.angular[axis];
            }
        }
        let given = self.start + self.user + self.gas + self.correction;
        let taken = self.damping + self.friction + self.contact + self.numerical;
        energy.loss_integrator = given - taken - energy.total();
        let moved = energy.kinetic + energy.elastic.abs() + (energy.gas + energy.gravity - self.start).abs();
        self.largest = self.largest.larger(moved);
        // If nothing moves, the remainder consists of rounding errors, and there is no motion to which it could be compared.
        rounding += ROUNDING * (energy.gas.abs() + energy.gravity.abs() + self.start.abs());
        energy.in_motion = self.largest.larger(rounding);
        energy.closure = energy.part_in_motion(energy.loss_integrator);
        (energy, momentum)
    }
}
