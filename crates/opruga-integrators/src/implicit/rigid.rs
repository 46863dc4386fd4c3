//! The balance of a stage in the rigid motions of a body that nothing prevents.
//!
//! Positions have sixteen digits. Rounding the positions causes forces of about ε |x| times the stiffness of a node. Such a
//! force may be a multiple of the weight of the node: E ε |x|/(ρ g ℓ²) times this weight in a body with cells of size ℓ. The
//! residual of a single node is then meaningless. But at all positions, the forces between nodes and their moments sum to zero
//! over a piece of a body. The rounding of that sum is smaller by another factor ε. The sum of the residuals, which consists of
//! weight, loads and inertia, is therefore known even if its terms are not. A matrix whose stiffness is 1/ε times its mass is
//! also useless for these motions, since the sums of its rows are rounding errors.
//!
//! For each piece (`pieces`) let φ be the motions t + ω × (x − c) of the piece that neither pins nor obstacles prevent. The
//! motions φ are orthonormal with respect to the masses. The motion φ a that balances the piece follows from
//!
//! (σ + φᵀ(K + βC)φ) a = −φᵀ r
//!
//! Models that exert forces only between nodes are omitted from r and K. The sums of these forces and of their moments are
//! zero, but the computed moments have rounding errors like the forces themselves. Any model that ties nodes to space resists
//! rigid motion, if its resistance exceeds rounding. A piece moves by a finite rotation (Cayley's), which does not change its
//! shape.

use super::contact::Contacting;
use super::linear::{Filter, Mixture};
use super::rigid_motion::{Motion, Sum, along, arm, unheld};
use crate::equilibrium::pieces::pieces;
use crate::equilibrium::restraint::{acts_between_nodes, add_forces_of};
use opruga_core::inertia::Inertia;
use opruga_core::potential::{Definiteness, DensePart, Sink};
use opruga_core::system::{Member, System};
use opruga_solve::blocks::{Block, times};
use opruga_solve::dense::inverse;

/// The number of rigid motions in space.
const MOST: usize = 6;

/// A part of a body that its models connect.
#[derive(Debug)]
struct Piece<const D: usize> {
    center: [f64; D],
    motions: Vec<Motion<D>>,
    /// The inverse of the matrix of these motions.
    inverse: Vec<f64>,
}

/// The rigid motions that are free in an iteration.
#[derive(Debug, Default)]
pub(crate) struct Rigid<const D: usize> {
    /// The nodes of each piece. The lists are empty until they are determined. The pieces stay the same as long as the models
    /// do.
    nodes: Vec<Vec<usize>>,
    /// The models that exert forces only between nodes, or `None` if they have not been determined in this step.
    inner: Option<Vec<usize>>,
    pieces: Vec<Piece<D>>,
    /// The ratio of the forces due to rounding of positions to the loads, or zero if this ratio is not needed.
    pub(super) conditioning: f64,
}

/// The data of a stage for finding the rigid motions.
pub(super) struct Stage<'a, const D: usize> {
    pub(super) mixture: Mixture<'a, D>,
    pub(super) x0: &'a [f64],
    pub(super) u: &'a [f64],
    pub(super) y: &'a [f64],
    pub(super) filter: Filter<'a, D>,
    pub(super) contacting: &'a Contacting<D>,
}

impl<const D: usize> Rigid<D> {
    /// Discards the results of an earlier step.
    pub(super) fn begin(&mut self) {
        self.inner = None;
        self.conditioning = 0.0;
    }

    /// Finds the motions of every piece that nothing prevents, and their matrix, after the forces have been evaluated.
    pub(super) fn find(&mut self, stage: &Stage<'_, D>) {
        let Stage { mixture, x0, u, filter, .. } = stage;
        if self.nodes.iter().map(Vec::len).sum::<usize>() != mixture.mass.len() {
            self.nodes = pieces(mixture.system);
        }
        self.pieces.clear();
        let mut displacements = vec![[0.0; D]; mixture.mass.len() * MOST];
        let mut owner = vec![0; mixture.mass.len()];
        for (number, nodes) in self.nodes.iter().enumerate() {
            let piece = Piece::free(nodes, mixture, x0, u, filter);
            for node in nodes {
                owner[*node] = number;
                for (p, motion) in piece.motions.iter().enumerate() {
                    let displacement = motion.displacement(&arm(x0, u, *node, &piece.center));
                    displacements[node * MOST + p] =
                        if filter.free[*node] { displacement } else { times(&filter.projectors[*node], &displacement) };
                }
            }
            self.pieces.push(piece);
        }
        // The matrices of the models cost time, so they are not computed for bodies that are held.
        if !self.any_is_free() {
            return;
        }
        if self.inner.is_none() {
            let system = mixture.system;
            let inner = |number: &usize| acts_between_nodes(system, &system.members[*number]);
            self.inner = Some((0..system.members.len()).filter(inner).collect());
        }
        let mut sink = Resistance {
            factor: 1.0,
            owner: &owner,
            displacements: &displacements,
            of: vec![[[0.0; MOST]; MOST]; self.pieces.len()],
        };
        let (system, view) = (mixture.system, mixture.system.view(mixture.stage, mixture.system.time + mixture.time));
        for (_, member) in self.outer(system) {
            if member.potential.properties().views.hessian {
                sink.factor = 1.0;
                member.potential.hessian(&view, &member.scratch, Definiteness::Exact, &mut sink);
            }
            if member.potential.properties().views.damping && mixture.beta != 0.0 {
                sink.factor = mixture.beta;
                member.potential.damping_matrix(&view, &member.scratch, &mut sink);
            }
        }
        for (piece, resistance) in self.pieces.iter_mut().zip(&sink.of) {
            let n = piece.motions.len();
            let mut matrix = vec![0.0; n * n];
            for p in 0..n {
                for q in 0..n {
                    matrix[p * n + q] = resistance[p][q] + if p == q { mixture.sigma } else { 0.0 };
                }
            }
            piece.inverse = inverse(&matrix, n).unwrap_or_else(|| {
                (0..n * n).map(|k| if k / n == k % n { 1.0 / mixture.sigma } else { 0.0 }).collect()
            });
        }
    }

    /// Whether any piece has a motion that nothing prevents.
    fn any_is_free(&self) -> bool {
        self.pieces.iter().any(|piece| !piece.motions.is_empty())
    }

    /// The residual in the free directions without the forces between nodes: inertia, the weight, friction and all external
    /// models. Forces between nodes are left out, because the other forces may be lost in the rounding of these.
    pub(super) fn residual(&self, stage: &Stage<'_, D>) -> Vec<f64> {
        let Stage { mixture, u, y, filter, contacting, .. } = stage;
        if !self.any_is_free() {
            return Vec::new();
        }
        let system = mixture.system;
        let displacement: Vec<f64> = u.iter().zip(*y).map(|(u, y)| u - y).collect();
        let mut out = momenta::<D>(mixture.mass, system.inertia.as_ref(), &displacement);
        let view = system.view(mixture.stage, system.time + mixture.time);
        let mut force = vec![[0.0; D]; mixture.mass.len()];
        for (node, force) in force.iter_mut().enumerate() {
            *force = system.gravity.map(|g| system.weighing().at(node) * g);
        }
        for (_, member) in self.outer(system) {
            add_forces_of(system, member, &member.scratch, &view, &mut force);
        }
        for (k, out) in out.iter_mut().enumerate() {
            *out = mixture.sigma * *out - force[k / D][k % D];
        }
        contacting.subtract_friction(&mut out);
        filter.apply(&mut out);
        out
    }

    /// The external models.
    pub(super) fn outer<'a>(&'a self, system: &'a System<D>) -> impl Iterator<Item = (usize, &'a Member<D>)> {
        system
            .members
            .iter()
            .enumerate()
            .filter(|(number, _)| !self.inner.iter().flatten().any(|inner| inner == number))
    }

    /// φᵀ f of forces in the free directions, piece by piece.
    pub(super) fn sums(&self, x0: &[f64], u: &[f64], force: &[f64]) -> Vec<f64> {
        let mut out = Vec::new();
        for (piece, nodes) in self.pieces.iter().zip(&self.nodes) {
            for motion in &piece.motions {
                let mut sum = Sum::default();
                for node in nodes {
                    let displacement = motion.displacement(&arm(x0, u, *node, &piece.center));
                    (0..D).for_each(|d| sum.add(displacement[d] * force[node * D + d]));
                }
                out.push(sum.value());
            }
        }
        out
    }

    /// The coefficients of the rigid motions that forces cause.
    pub(super) fn shares(&self, sums: &[f64]) -> Vec<f64> {
        let (mut out, mut first) = (Vec::new(), 0);
        for piece in &self.pieces {
            let n = piece.motions.len();
            for p in 0..n {
                out.push((0..n).map(|q| piece.inverse[p * n + q] * sums[first + q]).sum());
            }
            first += n;
        }
        out
    }

    /// The motion of every piece, from the coefficients of its motions.
    fn motions(&self, shares: &[f64]) -> Vec<Motion<D>> {
        let mut first = 0;
        let motion = |piece: &Piece<D>| {
            let n = piece.motions.len();
            first += n;
            Motion::sum(&piece.motions, &shares[first - n..first])
        };
        self.pieces.iter().map(motion).collect()
    }

    /// The finite displacements of all nodes, from coefficients of the motions.
    pub(super) fn finite_displacements(&self, x0: &[f64], u: &[f64], shares: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for ((motion, piece), nodes) in self.motions(shares).iter().zip(&self.pieces).zip(&self.nodes) {
            for node in nodes {
                let displacement = motion.finite_displacement(&arm(x0, u, *node, &piece.center));
                out[node * D..][..D].copy_from_slice(&displacement);
            }
        }
    }

    /// Replaces the rigid motions in a direction by the motions that balance the body.
    pub(super) fn correct(&mut self, stage: &Stage<'_, D>, step: &mut [f64]) {
        self.find(stage);
        let Stage { mixture, x0, u, filter, .. } = stage;
        let moved = momenta::<D>(mixture.mass, mixture.system.inertia.as_ref(), step);
        let there = self.sums(x0, u, &moved);
        let wanted: Vec<f64> =
            self.shares(&self.sums(x0, u, &self.residual(stage))).iter().map(|share| -share).collect();
        // The present motions are removed, and the required ones are added as finite rotations, because a straight motion would
        // stretch the body.
        let motions = self.motions(&there).into_iter().zip(self.motions(&wanted));
        for (((found, wanted), piece), nodes) in motions.zip(&self.pieces).zip(&self.nodes) {
            for node in nodes {
                let arm = arm(x0, u, *node, &piece.center);
                let (from, to) = (found.displacement(&arm), wanted.finite_displacement(&arm));
                let displacement = core::array::from_fn(|d| to[d] - from[d]);
                let displacement =
                    if filter.free[*node] { displacement } else { times(&filter.projectors[*node], &displacement) };
                (0..D).for_each(|d| step[node * D + d] += displacement[d]);
            }
        }
    }
}

/// Returns M s.
fn momenta<const D: usize>(mass: &[f64], inertia: Option<&Inertia>, s: &[f64]) -> Vec<f64> {
    let mut out: Vec<f64> = s.iter().enumerate().map(|(k, s)| mass[k / D] * s).collect();
    if let Some(inertia) = inertia {
        for node in 0..mass.len() {
            let coupled = inertia.product::<D>(node, s);
            (0..D).for_each(|d| out[node * D + d] += coupled[d]);
        }
    }
    out
}

impl<const D: usize> Piece<D> {
    /// The rigid motions of some nodes that nothing prevents, orthonormal with respect to the masses.
    fn free(nodes: &[usize], mixture: &Mixture<D>, x0: &[f64], u: &[f64], filter: &Filter<D>) -> Piece<D> {
        let mass = mixture.mass;
        let total: f64 = nodes.iter().map(|node| mass[*node]).sum();
        // Relative to a node, so that no digits are lost far from the origin.
        let first: [f64; D] = arm(x0, u, nodes[0], &[0.0; D]);
        let mut center = first;
        let mut spread = 0.0;
        for node in nodes {
            let arm = arm(x0, u, *node, &first);
            (0..D).for_each(|d| center[d] += arm[d] * mass[*node] / total);
        }
        for node in nodes {
            let arm = arm(x0, u, *node, &center);
            spread += mass[*node] / total * along(&arm, &arm);
        }
        let radius = spread.sqrt();
        let mut all = Vec::new();
        for d in 0..D {
            let mut motion = Motion::NONE;
            motion.translation[d] = 1.0;
            all.push(motion);
        }
        for axis in if D == 2 { 2..3 } else { 0..3 } {
            let mut motion = Motion::NONE;
            motion.rotation[axis] = 1.0 / radius;
            all.push(motion);
        }
        if !(radius > 0.0 && radius.is_finite()) {
            all.truncate(D);
        }
        let arms = |node: usize| arm(x0, u, node, &center);
        let kept = unheld(&all, nodes, filter, arms);
        // Gram–Schmidt with respect to the masses; a rotation about the line through all nodes moves nothing.
        let mut motions: Vec<Motion<D>> = Vec::new();
        let inertia = mixture.system.inertia.as_ref();
        let product = |a: &Motion<D>, b: &Motion<D>| {
            let mut sum = Sum::default();
            for node in nodes {
                let (displacement, mut moved) = (
                    a.displacement(&arms(*node)),
                    b.displacement(&arms(*node)).map(|displacement| mass[*node] * displacement),
                );
                for (other, mass) in inertia.iter().flat_map(|inertia| inertia.row(*node)) {
                    let beside = b.displacement(&arms(other));
                    (0..D).for_each(|d| moved[d] += mass * beside[d]);
                }
                (0..D).for_each(|d| sum.add(displacement[d] * moved[d]));
            }
            sum.value()
        };
        for mut motion in kept {
            for _ in 0..2 {
                for known in &motions {
                    let share = product(known, &motion);
                    motion.add(-share, known);
                }
            }
            let size = product(&motion, &motion);
            if size > 1e-12 * total {
                let mut unit = Motion::NONE;
                unit.add(1.0 / size.sqrt(), &motion);
                motions.push(unit);
            }
        }
        Piece { center, motions, inverse: Vec::new() }
    }
}

/// Sums φᵀ K φ for every piece.
struct Resistance<'a, const D: usize> {
    factor: f64,
    owner: &'a [usize],
    displacements: &'a [[f64; D]],
    of: Vec<[[f64; MOST]; MOST]>,
}

impl<const D: usize> Sink<D> for Resistance<'_, D> {
    fn block(&mut self, a: usize, b: usize, value: Block<D>) {
        let out = &mut self.of[self.owner[a]];
        for q in 0..MOST {
            let pulled = times(&value, &self.displacements[b * MOST + q]);
            for p in 0..MOST {
                out[p][q] += self.factor * along(&self.displacements[a * MOST + p], &pulled);
            }
        }
    }
    fn low_rank(&mut self, c: f64, u: &[(usize, [f64; D])]) {
        let Some((first, _)) = u.first() else { return };
        let out = &mut self.of[self.owner[*first]];
        let mut sums = [0.0; MOST];
        for (index, entry) in u {
            for p in 0..MOST {
                sums[p] += along(entry, &self.displacements[index * MOST + p]);
            }
        }
        for p in 0..MOST {
            for q in 0..MOST {
                out[p][q] += self.factor * c * sums[p] * sums[q];
            }
        }
    }
    fn dense(&mut self, part: &DensePart<'_, D>) {
        let Some(first) = part.indices.first() else { return };
        let out = &mut self.of[self.owner[*first as usize]];
        for q in 0..MOST {
            let pulled = part.product(|index| self.displacements[index * MOST + q]);
            for (index, pulled) in part.indices.iter().zip(&pulled) {
                for p in 0..MOST {
                    out[p][q] += self.factor * along(&self.displacements[*index as usize * MOST + p], pulled);
                }
            }
        }
    }
}
