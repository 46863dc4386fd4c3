//! Stiffnesses that bodies hold, by what they follow from: a body that is built again, or alike another, takes what is there.

use super::assembly::Stiffness;
use super::refusals::Refusal;
use super::surface::Surface;
use std::sync::{Arc, Mutex, PoisonError, Weak};

/// The bits of all that a stiffness follows from.
type Key = Vec<u64>;

/// Those that somebody holds. The list is as short as the number of different bodies.
static KNOWN: Mutex<Vec<(Key, Weak<Stiffness>)>> = Mutex::new(Vec::new());

fn key<const D: usize>(surface: &Surface<D>, poisson: f64, exterior: bool, asked: &[[f64; D]]) -> Key {
    let mut key = vec![D as u64, u64::from(exterior), poisson.to_bits(), surface.nodes as u64, asked.len() as u64];
    key.extend(surface.points.iter().chain(asked).flatten().map(|x| x.to_bits()));
    key.extend(surface.facets.iter().flatten().map(|node| u64::from(*node)));
    key
}

/// The stiffness of a boundary, made where nobody holds it.
pub(super) fn stiffness<const D: usize>(
    surface: &Surface<D>,
    poisson: f64,
    exterior: bool,
    asked: &[[f64; D]],
) -> Result<Arc<Stiffness>, Refusal> {
    let key = key(surface, poisson, exterior, asked);
    let find = |known: &mut Vec<(Key, Weak<Stiffness>)>| {
        known.retain(|(_, held)| held.strong_count() > 0);
        known.iter().find(|(own, _)| *own == key).and_then(|(_, held)| held.upgrade())
    };
    if let Some(held) = find(&mut KNOWN.lock().unwrap_or_else(PoisonError::into_inner)) {
        return Ok(held);
    }
    // Not under the lock: others build their own meanwhile, and the same numbers twice are the same bits.
    let made = Arc::new(Stiffness::new(surface, poisson, exterior, asked)?);
    let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(held) = find(&mut known) {
        return Ok(held);
    }
    known.push((key, Arc::downgrade(&made)));
    Ok(made)
}
