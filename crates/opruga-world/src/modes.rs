//! Natural frequencies: small oscillations of a body about its present state.
//!
//! The small motion q obeys M q″ + K q = 0. K is ∂²U/∂x∂x of all present models and loads. M contains the masses of the nodes, lumped or consistent
//! depending on the models. The solutions are q = φ cos ωt with K φ = ω² M φ. Damping is ignored. The state should be an equilibrium; in any other
//! state the frequencies follow from the stiffness that springs and gas have in that state. A negative ω² is reported as it is. A negative ω² shows
//! that the state is unstable, for example because the body is about to buckle.

use crate::any_scene::three;
use crate::error::{Part, WorldError};
use crate::path_faults::PathFault;
use crate::refusals::Refusal;
use crate::world::World;
use opruga_core::error::BuildError;
use opruga_core::potential::{Definiteness, Sink, Views};
use opruga_core::state::Columns;
use opruga_core::system::{Stage, System};
use opruga_integrators::equilibrium::rigid::{shape_of, unheld_motions};
use opruga_solve::blocks::isotropic;
use opruga_solve::eigen::{Pencil, lowest_modes, memory};
use opruga_solve::{BlockMatrix, Cholesky, dot};
use std::collections::BTreeMap;

/// One natural frequency and its shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode<const D: usize> {
    /// ω² [1/s²]; zero for rigid modes, negative if the state is unstable.
    pub square: f64,
    /// Displacement of every node, with φᵀMφ = 1 kg·m² [m].
    pub shape: Vec<[f64; D]>,
    /// The error of K φ = ω² M φ: |K φ − ω² M φ| in the norm of the inverse lumped masses [1/s²].
    pub residual: f64,
    /// The name of an unconstrained rigid motion of the body, such as `translation along x`.
    pub rigid: Option<String>,
}

impl<const D: usize> Mode<D> {
    /// The same mode in space; displacements along z are 0 if the body lies in the plane.
    pub(crate) fn in_space(self) -> Mode<3> {
        let Mode { square, shape, residual, rigid } = self;
        Mode { square, shape: shape.into_iter().map(three).collect(), residual, rigid }
    }
    /// ω [rad/s]; zero if ω² is not positive.
    pub fn omega(&self) -> f64 {
        if self.square > 0.0 { self.square.sqrt() } else { 0.0 }
    }
    /// The frequency ω/2π [Hz].
    pub fn frequency(&self) -> f64 {
        self.omega() / (2.0 * core::f64::consts::PI)
    }
}

/// A rigid motion counts as free if its ω² is at most this fraction of the largest ratio of a diagonal element of K to its mass.
const FREE: f64 = 1e-9;

/// The maximum memory of a search for modes [bytes].
const MOST_BYTES: f64 = 4_294_967_296.0;

impl<const D: usize> World<D> {
    /// The lowest `count` natural modes of a body about its present state, rigid ones first.
    ///
    /// # Errors
    /// [`WorldError`] if there is no such body, if a model lacks second derivatives or refuses the state, or if no frequency exists because a node
    /// without mass can move.
    pub fn modes(&self, body: usize, count: usize) -> Result<Vec<Mode<D>>, WorldError> {
        if self.handle(body).is_none() {
            return Err(WorldError::path(format!("body.{body}"), PathFault::NoBody {}));
        }
        let name = self.blueprint.bodies[body].name.clone();
        let refuse =
            |refusal: Refusal| WorldError::Build { part: Part::body(&name), source: BuildError::of("modes", refusal) };
        // The system is built for this body alone, without the other bodies of its batch.
        let mut system = self.island_of(&[body], &BTreeMap::new(), &self.integrator)?.system;
        let has_modes = |views: Views| views.hessian && views.symmetric;
        if let Some(member) = system.members.iter().find(|member| !has_modes(member.potential.properties().views)) {
            let properties = member.potential.properties();
            return Err(refuse(match member.potential.lacks() {
                Some(why) => Refusal::NoSymmetricModes { model: properties.name, why: Some(why) },
                None => Refusal::NoModes { model: properties.name },
            }));
        }
        let mut force = Columns::zeros(system.index_count());
        system.evaluate(Stage::Current, 0.0, 0.0, &mut force).map_err(|cause| refuse(Refusal::State { cause }))?;
        let mut motions = SmallMotions::about(system, count).map_err(refuse)?;
        let (mut modes, known) = motions.rigid();
        motions.leave_out_pinned_axes();
        let wanted = count.saturating_sub(modes.len());
        let found = motions.elastic(wanted, &known).map_err(refuse)?;
        modes.truncate(count);
        modes.extend(found);
        Ok(modes)
    }
}

/// Small motions of a body about its present state: M q″ + K q = 0.
struct SmallMotions<const D: usize> {
    system: System<D>,
    /// K [N/m], without rows and columns of pinned axes.
    stiffness: BlockMatrix<D>,
    /// The lumped mass of every axis of every node [kg].
    mass: Vec<f64>,
    /// Whether a pin holds an axis.
    pinned: Vec<bool>,
    /// Whether a node has no pinned axis.
    free: Vec<bool>,
    /// For every node, the projector that removes its pinned axes.
    projectors: Vec<[[f64; D]; D]>,
    /// The largest ratio of a diagonal element of K to its mass [1/s²].
    fastest: f64,
}

impl<const D: usize> SmallMotions<D> {
    /// The small motions of a system whose forces have been computed in its present state. Refuses a system without natural frequencies, and a search
    /// for `count` modes that needs too much memory.
    fn about(system: System<D>, count: usize) -> Result<Self, Refusal> {
        let mut stiffness = BlockMatrix::<D>::default();
        stiffness.assemble(system.nodes, 0, |matrix| {
            system.hessian(Stage::Current, 0.0, Definiteness::Exact, matrix);
        });
        let mass: Vec<f64> = (0..system.nodes).flat_map(|node| [system.mass.at(node); D]).collect();
        let mut pinned = vec![false; mass.len()];
        system.pinned_axes(&mut |node, d| pinned[node * D + d] = true);
        if pinned.iter().all(|pinned| *pinned) {
            return Err(Refusal::AllHeld {});
        }
        if let Some(light) = (0..mass.len()).find(|k| !(mass[*k] > 0.0 || pinned[*k])) {
            return Err(Refusal::NoMassOfNode { node: light / D });
        }
        let axes = pinned.iter().filter(|pinned| !**pinned).count();
        let bytes = memory(count, axes);
        if bytes > MOST_BYTES {
            let (bytes, most) = (format!("{bytes:.0}"), format!("{MOST_BYTES:.0}"));
            return Err(Refusal::ModesMemory { count: count.min(axes), axes, bytes, most });
        }
        // Pinned axes have no row and no column.
        let free: Vec<bool> = (0..system.nodes).map(|node| !pinned[node * D..(node + 1) * D].contains(&true)).collect();
        let projectors: Vec<[[f64; D]; D]> = (0..system.nodes)
            .map(|node| {
                let kept = |d: usize| if pinned[node * D + d] { 0.0 } else { 1.0 };
                core::array::from_fn(|i| core::array::from_fn(|j| if i == j { kept(i) } else { 0.0 }))
            })
            .collect();
        stiffness.constrain(&free, &projectors);
        let mut fastest: f64 = 0.0;
        for (k, m) in mass.iter().enumerate() {
            let ratio = if pinned[k] { 0.0 } else { stiffness.diagonal_block(k / D)[k % D][k % D].abs() / m };
            let dense = if pinned[k] || !stiffness.has_dense() { 0.0 } else { stiffness.diagonal_size(k / D) / m };
            let ratio = if dense > ratio { dense } else { ratio };
            fastest = if ratio > fastest { ratio } else { fastest };
        }
        let fastest = if fastest > 0.0 { fastest } else { 1.0 };
        Ok(SmallMotions { system, stiffness, mass, pinned, free, projectors, fastest })
    }

    /// Rigid motions without strain, which need no search, and their shapes axis by axis.
    fn rigid(&self) -> (Vec<Mode<D>>, Vec<Vec<f64>>) {
        let mut rigid: Vec<Mode<D>> = Vec::new();
        let mut known: Vec<Vec<f64>> = Vec::new();
        for motion in unheld_motions(&self.system) {
            let mut shape = shape_of(&self.system, &motion);
            if !orthonormalise(&mut shape, &|x, y| weigh(&self.system, &self.mass, x, y), &known) {
                continue;
            }
            let mut strained = vec![0.0; shape.len()];
            self.stiffness.multiply(&shape, &mut strained);
            if dot(&shape, &strained).abs() <= FREE * self.fastest {
                rigid.push(Mode {
                    square: 0.0,
                    shape: vectors(&shape),
                    residual: 0.0,
                    rigid: Some(motion.name().to_string()),
                });
                known.push(shape);
            }
        }
        (rigid, known)
    }

    /// Sets the masses of pinned axes to zero.
    fn leave_out_pinned_axes(&mut self) {
        for (m, pinned) in self.mass.iter_mut().zip(&self.pinned) {
            *m = if *pinned { 0.0 } else { *m };
        }
    }

    /// The lowest modes that are orthogonal to the known ones.
    fn elastic(&self, wanted: usize, known: &[Vec<f64>]) -> Result<Vec<Mode<D>>, Refusal> {
        let (shift, factor) = self.factor()?;
        let by_mass = |x: &[f64], y: &mut [f64]| weigh(&self.system, &self.mass, x, y);
        let by_stiffness = |x: &[f64], y: &mut [f64]| self.stiffness.multiply(x, y);
        let pencil = Pencil {
            mass: &self.mass,
            shift,
            known,
            weigh: &by_mass,
            solve: &|x| factor.solve(x),
            stiffness: &by_stiffness,
        };
        let found = lowest_modes(wanted, &pencil).map_err(|_| Refusal::Indefinite {})?;
        let mode = |square, shape: &[f64], residual| Mode { square, shape: vectors(shape), residual, rigid: None };
        Ok(found.into_iter().map(|found| mode(found.square, &found.shape, found.residual)).collect())
    }

    /// Factors K + s M; returns the factor and s [1/s²]. The matrix must be positive definite; a state that is about to buckle needs a larger s.
    fn factor(&self) -> Result<(f64, Cholesky), Refusal> {
        let system = &self.system;
        let mut shift = 1e-6 * self.fastest;
        let mut factor = Cholesky::default();
        loop {
            let mut shifted = BlockMatrix::<D>::default();
            shifted.assemble(system.nodes, 0, |matrix| {
                system.hessian(Stage::Current, 0.0, Definiteness::Exact, matrix);
                for node in 0..system.nodes {
                    for (other, mass) in system.inertia.iter().flat_map(|inertia| inertia.row(node)) {
                        matrix.block(node, other, isotropic(shift * mass));
                    }
                    matrix.add_diagonal(node, shift * system.mass.at(node));
                }
            });
            shifted.constrain(&self.free, &self.projectors);
            if factor.update(&shifted).is_ok() {
                return Ok((shift, factor));
            }
            shift *= 10.0;
            if shift > 1e3 * self.fastest {
                return Err(Refusal::Indefinite {});
            }
        }
    }
}

fn vectors<const D: usize>(shape: &[f64]) -> Vec<[f64; D]> {
    shape.as_chunks::<D>().0.to_vec()
}

/// M x, without rows and columns of coordinates that have no mass.
fn weigh<const D: usize>(system: &System<D>, mass: &[f64], x: &[f64], y: &mut [f64]) {
    let Some(inertia) = &system.inertia else {
        return y.iter_mut().zip(x).zip(mass).for_each(|((y, x), m)| *y = m * x);
    };
    let x: Vec<f64> = x.iter().zip(mass).map(|(x, m)| if *m > 0.0 { *x } else { 0.0 }).collect();
    for node in 0..system.nodes {
        let coupled = inertia.product::<D>(node, &x);
        for d in 0..D {
            let k = node * D + d;
            y[k] = if mass[k] > 0.0 { mass[k] * x[k] + coupled[d] } else { 0.0 };
        }
    }
}

/// Makes a shape orthogonal to others and gives it unit length in the scalar product of the masses.
fn orthonormalise(shape: &mut [f64], weigh: &impl Fn(&[f64], &mut [f64]), known: &[Vec<f64>]) -> bool {
    let mut momentum = vec![0.0; shape.len()];
    for _ in 0..2 {
        for other in known {
            weigh(other, &mut momentum);
            let along = dot(shape, &momentum);
            shape.iter_mut().zip(other).for_each(|(s, o)| *s -= along * o);
        }
    }
    weigh(shape, &mut momentum);
    let square = dot(shape, &momentum);
    if square.is_nan() || square <= 0.0 {
        return false;
    }
    let scale = 1.0 / square.sqrt();
    shape.iter_mut().for_each(|s| *s *= scale);
    true
}
