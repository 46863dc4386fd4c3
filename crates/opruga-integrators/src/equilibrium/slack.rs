//! Rotations that meet no resistance at any angle, which exist only for linear laws.
//!
//! A law that accounts for large rotations rotates with the body, and the weight brings the body back like a pendulum. For a
//! linear law, a rotation is the straight motion ω × r. Forces do not change along that motion, so a torque that acts at the
//! start acts at every angle.

use super::motion::{Motion, center, shape_at};
use super::restraint::{TURN, add_forces_of, outer, pose, unstiffened_motions};
use opruga_core::state::{Columns, View};
use opruga_core::system::{Member, Stage, System};
use opruga_math::Column;

/// Forces count as rounding if they are below this fraction of the forces due to a stretch of the same length.
const NOTHING: f64 = 1e-6;

/// The rotations of a piece that neither pins nor loads with a stiffness prevent. The forces of the body itself must not
/// resist the straight motion, however far it goes. If they resist it, the list is empty.
pub(super) fn endless_turns<const D: usize>(system: &System<D>, piece: &[usize]) -> Vec<Motion<D>> {
    let x = &system.state.x;
    let free = unstiffened_motions(system, x, piece, &[]);
    let endless = |motion: &Motion<D>| motion.turns() && goes_on(system, piece, motion);
    if free.iter().all(endless) { free } else { Vec::new() }
}

/// Whether the forces of the body stay the same under the straight motion of a rotation, but change if its nodes move on
/// circles.
fn goes_on<const D: usize>(system: &System<D>, piece: &[usize], motion: &Motion<D>) -> bool {
    let x = &system.state.x;
    let center = center(x, piece);
    let shape = shape_at(x, system.nodes, piece, motion, &center);
    let speed = motion.rotation.iter().map(|r| r * r).sum::<f64>().sqrt();
    let mut ahead = x.clone();
    for node in piece {
        let from = x.at(*node);
        ahead.set(*node, core::array::from_fn(|d| from[d] + TURN / speed * shape[node * D + d]));
    }
    let around = pose(x, piece, motion, &center);
    let [Some(here), Some(ahead), Some(around)] = [x, &ahead, &around].map(|x| own_forces(system, x)) else {
        return false;
    };
    let apart = |other: &[[f64; D]]| {
        let differences = other.iter().flatten().zip(here.iter().flatten());
        differences.map(|(a, b)| (a - b).abs()).sum::<f64>()
    };
    let (straight, round) = (apart(&ahead), apart(&around));
    round > 0.0 && round.is_finite() && straight <= NOTHING * round
}

/// The forces of the models of the body itself, at rest, with its nodes at the positions `x`. Returns `None` if a model
/// refuses them.
fn own_forces<const D: usize>(system: &System<D>, x: &Columns<D>) -> Option<Vec<[f64; D]>> {
    let rest = Columns::zeros(system.index_count());
    let view = View { x: x.slices(), v: rest.slices(), ..system.view(Stage::Current, system.time) };
    let mut force = vec![[0.0; D]; system.nodes];
    let outer = outer(system);
    let own = |member: &&Member<D>| !outer.iter().any(|load| core::ptr::eq(*load, *member));
    for member in system.members.iter().filter(own) {
        let mut scratch = Column::zeros(member.potential.properties().scratch_len);
        member.potential.prepare(system.simd, &view, &member.memory, &mut scratch).ok()?;
        add_forces_of(system, member, &scratch, &view, &mut force);
    }
    Some(force)
}
