//! Grouping of bodies that lie side by side in the lanes.

use crate::blueprint::BodyBlueprint;
use crate::masses::densities;
use crate::slots::{Origin, Slots};
use opruga_core::spec::{Value, Values};
use opruga_math::WIDTH;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Bodies with more nodes than this fill the vector lanes on their own.
const LARGEST_IN_BATCH: usize = 1024;
/// Stepping fewer bodies than this in a batch costs more than stepping them one by one.
const SMALLEST_BATCH: usize = 3;

/// Whether bodies may lie side by side: they have the same rest shape and integrator, and models that differ only in numbers.
pub(crate) fn alike<const D: usize>(a: &BodyBlueprint<D>, b: &BodyBlueprint<D>) -> bool {
    Arc::ptr_eq(&a.mesh, &b.mesh)
        && a.integrator == b.integrator
        && a.thickness == b.thickness
        && core::mem::discriminant(&a.mass) == core::mem::discriminant(&b.mass)
        && densities(a) == densities(b)
        && a.models.len() == b.models.len()
        && a.models.iter().zip(&b.models).all(|(a, b)| alike_values(a, b))
}

fn alike_values(a: &Values, b: &Values) -> bool {
    let count = |v: &Values| v.iter().count();
    a.kind() == b.kind()
        && count(a) == count(b)
        && a.iter()
            .zip(b.iter())
            .all(|((n, x), (m, y))| n == m && (matches!((x, y), (Value::Number(_), Value::Number(_))) || x == y))
}

/// Groups of bodies that are stepped together, in the order of their first bodies.
///
/// A body keeps its seat among bodies of its kind when others are removed, so only the group that loses or gains a body changes.
pub(crate) fn group<const D: usize>(
    bodies: &[BodyBlueprint<D>],
    slots: &Slots,
    batches: impl Fn(&BodyBlueprint<D>) -> bool,
) -> Vec<Vec<usize>> {
    let mut kinds: Vec<(usize, Vec<usize>)> = Vec::new();
    let mut kind_of: Vec<Option<usize>> = vec![None; bodies.len()];
    let mut by_mesh: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (number, body) in bodies.iter().enumerate().filter(|(number, _)| slots.origin[*number].is_taken()) {
        let candidates = by_mesh.entry(Arc::as_ptr(&body.mesh) as usize).or_default();
        let kind = match candidates.iter().copied().find(|k| alike(&bodies[kinds[*k].0], body)) {
            Some(kind) => kind,
            None => {
                candidates.push(kinds.len());
                kinds.push((number, Vec::new()));
                kinds.len() - 1
            }
        };
        kinds[kind].1.push(number);
        kind_of[number] = Some(kind);
    }
    // Empty seats beside bodies of the same kind.
    for (number, origin) in slots.origin.iter().enumerate() {
        if let Origin::Free(Some(like)) = origin
            && let Some(kind) = kind_of.get(*like).copied().flatten()
        {
            let members = &mut kinds[kind].1;
            members.insert(members.partition_point(|other| *other < number), number);
        }
    }
    let mut groups = Vec::new();
    for (first, members) in kinds {
        let small = bodies[first].mesh.positions.len() <= LARGEST_IN_BATCH;
        for seats in members.chunks(WIDTH) {
            let there: Vec<usize> = seats.iter().copied().filter(|b| slots.alive[*b]).collect();
            if small && there.len() >= SMALLEST_BATCH && batches(&bodies[first]) {
                groups.push(there);
            } else {
                groups.extend(there.into_iter().map(|b| vec![b]));
            }
        }
    }
    groups.sort_by_key(|g| g[0]);
    groups
}
