//! The vectors that an implicit step uses.

use super::answer_matrix::AnswerMatrix;
use super::contact::Contacting;
use super::impact::Struck;
use super::linear::Linear;
use super::mixing::Mixing;
use super::reused_matrix::ReusedMatrix;
use super::rigid::Rigid;
use super::settings::Solver;
use opruga_core::state::Columns;
use opruga_core::system::{Stage, System};
use opruga_core::threads::each_block;
use opruga_math::Lane;
use opruga_solve::blocks::{Block, isotropic, times};

/// The workspace of an implicit step. Long vectors hold the coordinates of one node after the other.
#[derive(Debug)]
pub(crate) struct Workspace<const D: usize> {
    /// The state at the start.
    pub(crate) x0: Vec<f64>,
    pub(crate) v0: Vec<f64>,
    /// The changes of velocities due to pins at the start of the step. The list is empty if there are none.
    pub(crate) kick: Vec<f64>,
    /// The acceleration at the start [m/s²], for rules that use it.
    pub(crate) a0: Vec<f64>,
    /// Mass of every node [kg].
    pub(crate) mass: Vec<f64>,
    /// The vectors of the stage, relative to x₀.
    pub(crate) y: Vec<f64>,
    pub(crate) z: Vec<f64>,
    /// The displacement of the stage from the start, u = x_s − x₀, so that velocities lose no digits far from the origin.
    pub(crate) u: Vec<f64>,
    /// Displacement and velocity at the end of the step.
    pub(crate) u1: Vec<f64>,
    pub(crate) v1: Vec<f64>,
    /// The force of the models, and the residual.
    pub(crate) force: Columns<D>,
    /// The external part of the force.
    pub(crate) outer: Columns<D>,
    pub(crate) residual: Vec<f64>,
    pub(crate) trial: Vec<f64>,
    pub(crate) step: Vec<f64>,
    pub(crate) right: Vec<f64>,
    /// The displacement u − y, if a mass matrix couples nodes.
    pub(crate) displacement: Vec<f64>,
    /// The part of the force that acts along held directions [N].
    pub(crate) reaction: Vec<f64>,
    pub(crate) prescribed: Vec<f64>,
    /// How far pinned axes have to move in the stage. The number is NaN for free axes.
    pub(crate) pin_displacement: Vec<f64>,
    /// Which nodes are entirely free, and the projectors of the others.
    pub(crate) free: Vec<bool>,
    pub(crate) projectors: Vec<Block<D>>,
    /// Nodes that met an obstacle in this step.
    pub(crate) struck: Vec<Struck<D>>,
    /// The velocities that the rule will still add from its memory [m/s].
    pub(crate) memory: Vec<f64>,
    pub(crate) linear: Linear<D>,
    /// The matrix that determines how the end of the step responds to forces of other bodies.
    pub(crate) answer: AnswerMatrix<D>,
    /// Whether the real-time setting factors its matrix with a given solver, if already determined.
    pub(crate) direct: Option<(Solver, bool)>,
    /// The matrix of the real-time setting.
    pub(crate) reused: ReusedMatrix<D>,
    pub(crate) contacting: Contacting<D>,
    /// The rigid motions that are free.
    pub(crate) rigid: Rigid<D>,
    /// The last iterations, for mixing.
    pub(crate) mixing: Mixing,
    /// Mixing of the normal forces that determine friction, within a direction.
    pub(crate) friction: Mixing,
    /// The largest extent of the body [m].
    pub(crate) extent: f64,
}

impl<const D: usize> Default for Workspace<D> {
    fn default() -> Self {
        Workspace {
            x0: Vec::new(),
            v0: Vec::new(),
            kick: Vec::new(),
            a0: Vec::new(),
            mass: Vec::new(),
            y: Vec::new(),
            z: Vec::new(),
            u: Vec::new(),
            u1: Vec::new(),
            v1: Vec::new(),
            force: Columns::zeros(0),
            outer: Columns::zeros(0),
            residual: Vec::new(),
            trial: Vec::new(),
            step: Vec::new(),
            right: Vec::new(),
            displacement: Vec::new(),
            reaction: Vec::new(),
            struck: Vec::new(),
            memory: Vec::new(),
            prescribed: Vec::new(),
            pin_displacement: Vec::new(),
            free: Vec::new(),
            projectors: Vec::new(),
            linear: Linear::default(),
            answer: AnswerMatrix::default(),
            direct: None,
            reused: ReusedMatrix::default(),
            contacting: Contacting::default(),
            rigid: Rigid::default(),
            mixing: Mixing::default(),
            friction: Mixing::default(),
            extent: 1.0,
        }
    }
}

/// Writes two numbers for every coordinate into two sets of columns. Indices after the last node repeat that node.
pub(crate) fn write<const D: usize>(
    index_count: usize,
    nodes: usize,
    threads: usize,
    [one, other]: [&mut Columns<D>; 2],
    numbers: impl Fn(usize) -> [f64; 2] + Sync,
) {
    for d in 0..D {
        let columns = [&mut one.0[d][..index_count], &mut other.0[d][..index_count]];
        each_block(threads, 1, columns, |first, [one, other]| {
            for (index, (one, other)) in (first..).zip(one.iter_mut().zip(other)) {
                [*one, *other] = numbers(index.min(nodes - 1) * D + d);
            }
        });
    }
}

impl<const D: usize> Workspace<D> {
    /// Copies the state of a system at the start of a step.
    pub(crate) fn load(&mut self, system: &System<D>) {
        let size = system.nodes * D;
        for vector in [
            &mut self.x0,
            &mut self.v0,
            &mut self.y,
            &mut self.z,
            &mut self.u,
            &mut self.u1,
            &mut self.v1,
            &mut self.memory,
            &mut self.residual,
            &mut self.trial,
            &mut self.step,
            &mut self.right,
            &mut self.reaction,
            &mut self.prescribed,
            &mut self.pin_displacement,
        ] {
            vector.resize(size, 0.0);
        }
        self.struck.clear();
        self.struck.reserve(system.nodes);
        self.mass.clear();
        self.mass.extend((0..system.nodes).map(|node| system.mass.at(node)));
        self.free.resize(system.nodes, true);
        self.projectors.resize(system.nodes, isotropic(1.0));
        for column in self.force.0.iter_mut().chain(&mut self.outer.0) {
            column.grow(system.index_count() + opruga_math::WIDTH);
        }
        for (columns, out) in [(&system.state.x, &mut self.x0), (&system.state.v, &mut self.v0)] {
            each_block(system.threads, D, [out], |first, [out]| {
                for (node, out) in (first / D..).zip(out.as_chunks_mut::<D>().0) {
                    *out = columns.at(node);
                }
            });
        }
        let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
        for node in self.x0.as_chunks::<D>().0 {
            for d in 0..D {
                low[d] = node[d].smaller(low[d]);
                high[d] = node[d].larger(high[d]);
            }
        }
        self.extent = 0.0;
        for d in 0..D {
            self.extent = (high[d] - low[d]).larger(self.extent);
        }
        if !(self.extent > 0.0 && self.extent.is_finite()) {
            self.extent = 1.0;
        }
    }

    /// Sets how far pinned axes have to move in the stage: by the fraction `theta` of their displacement in the step, which has
    /// the length `h`.
    pub(crate) fn hold(&mut self, system: &System<D>, theta: f64, h: f64) {
        self.pin_displacement.fill(f64::NAN);
        for pin in &system.pins {
            let (target, _) = pin.target(system.time + h);
            for d in 0..D {
                if pin.axes[d] {
                    let k = pin.index * D + d;
                    self.pin_displacement[k] = theta * (target[d] - self.x0[k]);
                }
            }
        }
    }

    /// Writes a stage into the work columns of a system: x₀ + u, and the velocities β (u − z).
    pub(crate) fn show(system: &mut System<D>, x0: &[f64], u: &[f64], z: &[f64], beta: f64) {
        let (index_count, nodes, threads) = (system.index_count(), system.nodes, system.threads);
        let stage = system.state.work[0].each_mut();
        write(index_count, nodes, threads, stage, |k| [x0[k] + u[k], beta * (u[k] - z[k])]);
    }

    /// The largest residual on a node along free directions [N].
    pub(crate) fn largest_residual(&self) -> f64 {
        let mut largest: f64 = 0.0;
        for (node, rest) in self.residual.as_chunks::<D>().0.iter().enumerate() {
            let rest = if self.free[node] { *rest } else { times(&self.projectors[node], rest) };
            let square: f64 = rest.iter().map(|r| r * r).sum();
            largest = if square > largest { square } else { largest };
        }
        largest.sqrt()
    }

    /// The stage in which forces are evaluated.
    pub(crate) const STAGE: Stage = Stage::Work(0);
}
