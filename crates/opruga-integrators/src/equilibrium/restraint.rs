//! The rigid motions that the loads do not restrain. Under such motions, loads and weight do no work of any order.
//!
//! In a rigid motion q (displacements φ_q, rotation ω_q) the force on a node changes by −K φ_q, where K = −∂F/∂x. If the force
//! F rotated with the body, it would change by ω_q × F. Only the difference of these two changes can hold the body in a
//! position:
//!
//! P_pq = Σ φ_p·(ω_q × F + K φ_q)
//!
//! P is zero for a pressure of any strength, because pressure follows the body. For a spring to a pointer, P is φ_p·K φ_q. For a
//! dead load or the weight, P is zero for a rotation about the axis along which these forces act. P is also zero if the
//! resultant of these forces passes through the support of the body. A dead load may do second-order work in most poses but not
//! in some, such as that of a horizontal pendulum. Several poses of the body are therefore examined.

use super::motion::{Motion, Projection, all_motions, center, displacement, of_weights, shape_at, unpinned_motions};
use super::pieces::whole;
use opruga_core::potential::{Account, Definiteness, Sink};
use opruga_core::state::{Columns, View};
use opruga_core::system::{Member, Stage, System};
use opruga_core::tile::Tile;
use opruga_math::{Column, WIDTH};
use opruga_solve::dense::symmetric_eigen;

/// Times after the present one at which loads are evaluated [s], because some loads begin at zero.
const TIMES: [f64; 7] = [0.0, 1e-3, 1e-2, 0.1, 1.0, 10.0, 100.0];

/// Restraints below a fraction of the loads count as zero. The constant is the square of the fraction, because P is squared.
const NOTHING: f64 = 1e-14;

/// The angle by which the body is rotated in the other poses [rad].
pub(super) const TURN: f64 = 0.9;

/// The motions of the body, or of a piece, that nothing prevents. Pins, loads, the weight (which holds a pendulum), or obstacles
/// that hold nodes along the given directions could prevent a motion. The nodes are at the given positions. Translations come
/// first.
pub(super) fn free_motions<const D: usize>(
    system: &System<D>,
    x: &Columns<D>,
    piece: &[usize],
    touched: &[(usize, [f64; D])],
) -> Vec<Motion<D>> {
    let free = unstiffened_motions(system, x, piece, touched);
    if !free.iter().all(Motion::turns) {
        return free;
    }
    let center = center(x, piece);
    // The loads without a stiffness and the weight may prevent rotations.
    let mut restraint = Restraint::new(&free, piece, center);
    let outer = outer(system);
    let times = if outer.is_empty() { &TIMES[..1] } else { &TIMES[..] };
    for x in poses(x, piece, &free, &center) {
        for time in times {
            restraint.add(system, &x, Source::Dead(&outer), system.time + time);
        }
    }
    restraint.left()
}

/// The motions that are not prevented by pins, by loads with a stiffness, or by obstacles along the given directions.
pub(super) fn unstiffened_motions<const D: usize>(
    system: &System<D>,
    x: &Columns<D>,
    piece: &[usize],
    touched: &[(usize, [f64; D])],
) -> Vec<Motion<D>> {
    let mut free = unpinned_motions(system, x, piece, touched);
    let center = center(x, piece);
    // Loads with a stiffness, in the present state.
    for member in outer(system) {
        let mut restraint = Restraint::new(&free, piece, center);
        for time in TIMES {
            restraint.add(system, x, Source::Stiff(member), system.time + time);
        }
        free = restraint.left();
    }
    free
}

/// The models that act from outside: loads, and every model that ties nodes to space, even if the ledger does not count it
/// among the loads.
pub(super) fn outer<const D: usize>(system: &System<D>) -> Vec<&Member<D>> {
    let acts =
        |member: &&Member<D>| member.potential.properties().account == Account::User || ties_to_space(system, member);
    system.members.iter().filter(acts).collect()
}

/// If the stiffness of a model against rigid motions is below this fraction of its largest stiffness, it counts as zero.
const NO_TIE: f64 = 1e-9;

/// Whether a model resists rigid motions of a body. Forces between nodes do not resist them, since these forces move and rotate
/// with the nodes.
fn ties_to_space<const D: usize>(system: &System<D>, member: &Member<D>) -> bool {
    let properties = member.potential.properties();
    if let Some(between) = properties.acts_between_nodes {
        return !between;
    }
    if !properties.views.hessian {
        return false;
    }
    let (x, rest) = (&system.state.x, Columns::zeros(system.index_count()));
    let view = View { x: x.slices(), v: rest.slices(), ..system.view(Stage::Current, system.time) };
    let Some(scratch) = prepared(system, member, &view) else { return false };
    let all = whole(system);
    let (motions, center) = (all_motions(x, &all), center(x, &all));
    let shapes: Vec<Vec<f64>> = motions.iter().map(|motion| shape_at(x, system.nodes, &all, motion, &center)).collect();
    let mut projection = Projection::of(&shapes);
    member.potential.hessian(&view, &scratch, Definiteness::Exact, &mut projection);
    if projection.largest == 0.0 {
        return false;
    }
    let mut force = vec![[0.0; D]; system.nodes];
    add_forces_of(system, member, &scratch, &view, &mut force);
    motions.iter().enumerate().any(|(p, motion)| {
        let mut found = projection.out[p * motions.len() + p];
        for (node, force) in force.iter().enumerate() {
            let turned = turned(motion, force);
            found += (0..D).map(|d| shapes[p][node * D + d] * turned[d]).sum::<f64>();
        }
        found.abs() > NO_TIE * projection.largest
    })
}

/// Whether a model exerts forces only between nodes, at rest and in motion. The forces of such a model and their moments sum to
/// zero over a body, since the energy of the model does not change under rigid motion.
pub(crate) fn acts_between_nodes<const D: usize>(system: &System<D>, member: &Member<D>) -> bool {
    let properties = member.potential.properties();
    if let Some(between) = properties.acts_between_nodes {
        return between;
    }
    if properties.account == Account::User || !properties.views.hessian || ties_to_space(system, member) {
        return false;
    }
    let (x, rest) = (&system.state.x, Columns::zeros(system.index_count()));
    let view = View { x: x.slices(), v: rest.slices(), ..system.view(Stage::Current, system.time) };
    let Some(scratch) = prepared(system, member, &view) else { return false };
    let all = whole(system);
    let center = center(x, &all);
    let shape = |motion: &Motion<D>| shape_at(x, system.nodes, &all, motion, &center);
    let shapes: Vec<Vec<f64>> = all_motions(x, &all).iter().map(shape).collect();
    let mut stiffness = Projection::of(&shapes);
    member.potential.hessian(&view, &scratch, Definiteness::Exact, &mut stiffness);
    let mut damping = Projection::of(&shapes);
    if member.potential.properties().views.damping {
        member.potential.damping_matrix(&view, &scratch, &mut damping);
    }
    let brakes = |p: usize| damping.out[p * (shapes.len() + 1)].abs() > NO_TIE * damping.largest;
    let mut force = vec![[0.0; D]; system.nodes];
    add_forces_of(system, member, &scratch, &view, &mut force);
    let pushes = |d: usize| {
        let (sum, sizes) = force.iter().fold((0.0, 0.0), |(sum, sizes), f| (sum + f[d], sizes + f[d].abs()));
        f64::abs(sum) > NO_TIE * sizes
    };
    // A model whose results do not change with positions counts as independent of positions.
    stiffness.largest > 0.0 && !(0..shapes.len()).any(brakes) && !(0..D).any(pushes)
}

/// The scratch of a model, prepared in a state, or `None` if the model has no value there.
fn prepared<const D: usize>(system: &System<D>, member: &Member<D>, view: &View<'_, D>) -> Option<Column> {
    let mut scratch = Column::zeros(member.potential.properties().scratch_len);
    member.potential.prepare(system.simd, view, &member.memory, &mut scratch).ok()?;
    Some(scratch)
}

/// Delivers the second derivatives, at rest, of the models that act from outside.
pub(super) fn deliver_outer<const D: usize>(system: &System<D>, x: &Columns<D>, sink: &mut dyn Sink<D>) {
    let rest = Columns::zeros(system.index_count());
    let view = View { x: x.slices(), v: rest.slices(), ..system.view(Stage::Current, system.time) };
    for member in outer(system).into_iter().filter(|member| member.potential.properties().views.hessian) {
        if let Some(scratch) = prepared(system, member, &view) {
            member.potential.hessian(&view, &scratch, Definiteness::Exact, sink);
        }
    }
}

/// The source of the forces that are examined: one load with a stiffness, or the weight together with all loads without a
/// stiffness.
#[derive(Clone, Copy, Debug)]
enum Source<'a, const D: usize> {
    Stiff(&'a Member<D>),
    Dead(&'a [&'a Member<D>]),
}

/// The sum of PᵀP over poses, times and loads, with each P relative to the size of its terms.
struct Restraint<'a, const D: usize> {
    motions: &'a [Motion<D>],
    /// The nodes that move.
    piece: &'a [usize],
    /// The centre of rotation.
    center: [f64; D],
    sum: Vec<f64>,
}

impl<'a, const D: usize> Restraint<'a, D> {
    fn new(motions: &'a [Motion<D>], piece: &'a [usize], center: [f64; D]) -> Self {
        Restraint { motions, piece, center, sum: vec![0.0; motions.len() * motions.len()] }
    }

    /// Adds the contribution of loads in a pose at a time.
    fn add(&mut self, system: &System<D>, x: &Columns<D>, source: Source<'_, D>, time: f64) {
        let n = self.motions.len();
        let shape = |motion| shape_at(x, system.nodes, self.piece, motion, &self.center);
        let shapes: Vec<Vec<f64>> = self.motions.iter().map(shape).collect();
        let rest = Columns::zeros(system.index_count());
        let view = View { x: x.slices(), v: rest.slices(), ..system.view(Stage::Current, time) };
        let mut force = vec![[0.0; D]; system.nodes];
        let mut part = vec![0.0; n * n];
        let mut size = 0.0;
        match source {
            Source::Stiff(member) => {
                let mut projection = Projection::of(&shapes);
                let Some(scratch) = prepared(system, member, &view) else { return };
                member.potential.hessian(&view, &scratch, Definiteness::Exact, &mut projection);
                if projection.largest == 0.0 {
                    return;
                }
                add_forces_of(system, member, &scratch, &view, &mut force);
                part.copy_from_slice(&projection.out);
                size = projection.largest;
            }
            Source::Dead(outer) => {
                for (node, force) in force.iter_mut().enumerate() {
                    *force = system.gravity.map(|g| system.mass.at(node) * g);
                }
                for member in outer {
                    let mut projection = Projection::of(&shapes);
                    let Some(scratch) = prepared(system, member, &view) else { continue };
                    member.potential.hessian(&view, &scratch, Definiteness::Exact, &mut projection);
                    if projection.largest == 0.0 {
                        add_forces_of(system, member, &scratch, &view, &mut force);
                    }
                }
            }
        }
        for (p, shape) in shapes.iter().enumerate() {
            for (q, motion) in self.motions.iter().enumerate() {
                for node in self.piece {
                    let turned = turned(motion, &force[*node]);
                    // Motions are scaled to displacements of about one.
                    for d in 0..D {
                        part[p * n + q] += shape[node * D + d] * turned[d];
                        size += turned[d].abs();
                    }
                }
            }
        }
        if !(size > 0.0 && size.is_finite()) {
            return;
        }
        if matches!(source, Source::Stiff(_)) {
            // A load with a stiffness delivers the symmetric part of P.
            for p in 0..n {
                for q in 0..p {
                    let mean = 0.5 * (part[p * n + q] + part[q * n + p]);
                    (part[p * n + q], part[q * n + p]) = (mean, mean);
                }
            }
        }
        for p in 0..n {
            for q in 0..n {
                self.sum[p * n + q] += (0..n).map(|k| part[k * n + p] * part[k * n + q]).sum::<f64>() / (size * size);
            }
        }
    }

    /// The motions that nothing restrains.
    fn left(&self) -> Vec<Motion<D>> {
        let n = self.motions.len();
        let (values, vectors) = symmetric_eigen(&self.sum, n);
        let loose: Vec<Vec<f64>> =
            values.iter().zip(vectors).filter(|(value, _)| **value <= NOTHING).map(|(_, vector)| vector).collect();
        if loose.len() == n { self.motions.to_vec() } else { of_weights(self.motions, loose) }
    }
}

/// Adds the forces of a model in the state for which `scratch` was prepared.
pub(crate) fn add_forces_of<const D: usize>(
    system: &System<D>,
    member: &Member<D>,
    scratch: &[f64],
    view: &View<'_, D>,
    out: &mut [[f64; D]],
) {
    let index_count = system.index_count();
    let mut columns: [Column; D] = core::array::from_fn(|_| Column::zeros(index_count + WIDTH));
    let mut slots = Column::default();
    let mut tile = Tile {
        range: 0..index_count,
        force: columns.each_mut().map(|column| &mut **column),
        power: &mut [0.0; WIDTH],
        weight: None,
        slots: &mut slots,
    };
    member.potential.add_force(system.simd, view, scratch, &mut tile);
    for (node, force) in out.iter_mut().enumerate() {
        for d in 0..D {
            force[d] += columns[d][node];
        }
    }
}

/// Returns ω × F.
fn turned<const D: usize>(motion: &Motion<D>, force: &[f64; D]) -> [f64; D] {
    let turn = Motion { translation: [0.0; D], rotation: motion.rotation.clone() };
    displacement(&turn, force, &[0.0; D])
}

/// The present pose of the body, the poses in which one of the motions rotates the piece, and the pose in which all motions
/// together rotate it.
fn poses<const D: usize>(x: &Columns<D>, piece: &[usize], motions: &[Motion<D>], center: &[f64; D]) -> Vec<Columns<D>> {
    let turns = if D == 2 { 1 } else { 3 };
    let mut all = Motion { translation: [0.0; D], rotation: vec![0.0; turns] };
    for motion in motions {
        for d in 0..D {
            all.translation[d] += motion.translation[d];
        }
        all.rotation.iter_mut().zip(&motion.rotation).for_each(|(sum, r)| *sum += r);
    }
    let others = motions.iter().chain((motions.len() > 1).then_some(&all));
    core::iter::once(x.clone()).chain(others.map(|motion| pose(x, piece, motion, center))).collect()
}

/// The positions of the body after a piece has moved until its rotation reaches [`TURN`].
pub(super) fn pose<const D: usize>(
    x: &Columns<D>,
    piece: &[usize],
    motion: &Motion<D>,
    center: &[f64; D],
) -> Columns<D> {
    let speed = motion.rotation.iter().map(|r| r * r).sum::<f64>().sqrt();
    let mut out = x.clone();
    if speed == 0.0 {
        return out;
    }
    // Positions move by φ = t + ω × (x − c). The axis passes through c + ω × t/|ω|²; the translation continues along it.
    let axis: Vec<f64> = motion.rotation.iter().map(|r| r / speed).collect();
    let unit = Motion { translation: [0.0; D], rotation: axis.clone() };
    let across = turned(&unit, &motion.translation);
    let through: [f64; D] = core::array::from_fn(|d| center[d] + across[d] / speed);
    let along: f64 = if D == 3 { (0..D).map(|d| axis[d] * motion.translation[d]).sum() } else { 0.0 };
    let (sine, cosine) = libm::sincos(TURN);
    for node in piece {
        let x = x.at(*node);
        let arm: [f64; D] = core::array::from_fn(|d| x[d] - through[d]);
        // Rodrigues: x + sin θ n × r + (1 − cos θ) n × (n × r).
        let first = turned(&unit, &arm);
        let second = turned(&unit, &first);
        let mut to: [f64; D] = core::array::from_fn(|d| x[d] + sine * first[d] + (1.0 - cosine) * second[d]);
        for d in 0..D {
            to[d] += if D == 3 { axis[d] * along * TURN / speed } else { 0.0 };
        }
        out.set(*node, to);
    }
    out
}
