//! A table of the stiffnesses in use. The keys of the table are the data that determine a stiffness. A body that is built
//! again, or is identical to another, reuses the existing stiffness.

use super::assembly::Stiffness;
use super::refusals::Refusal;
use super::surface::Surface;
use opruga_core::break_off::BreakOff;
use std::sync::{Arc, Mutex, PoisonError, Weak};

/// The bits of all data that determine a stiffness.
type Key = Vec<u64>;

/// The stiffnesses in use, and the one that was last requested. The last stiffness is kept because a program that reads a
/// scene builds its bodies more than once, one after the other.
struct Known {
    shared: Vec<(Key, Weak<Stiffness>)>,
    last: Option<Arc<Stiffness>>,
}

static KNOWN: Mutex<Known> = Mutex::new(Known { shared: Vec::new(), last: None });

impl Known {
    fn find(&mut self, key: &Key) -> Option<Arc<Stiffness>> {
        self.shared.retain(|(_, shared)| shared.strong_count() > 0);
        let found = self.shared.iter().find(|(own, _)| own == key).and_then(|(_, shared)| shared.upgrade())?;
        self.last = Some(Arc::clone(&found));
        Some(found)
    }
}

fn key<const D: usize>(surface: &Surface<D>, poisson: f64, exterior: bool, asked: &[[f64; D]]) -> Key {
    let mut key = vec![D as u64, u64::from(exterior), poisson.to_bits(), surface.nodes as u64, asked.len() as u64];
    key.extend(surface.points.iter().chain(asked).flatten().map(|x| x.to_bits()));
    key.extend(surface.facets.iter().flatten().map(|node| u64::from(*node)));
    key
}

/// Returns the stiffness of a boundary. Computes the stiffness unless it is still stored.
pub(super) fn stiffness<const D: usize>(
    surface: &Surface<D>,
    poisson: f64,
    exterior: bool,
    asked: &[[f64; D]],
    break_off: &BreakOff,
) -> Result<Arc<Stiffness>, Refusal> {
    let key = key(surface, poisson, exterior, asked);
    if let Some(shared) = KNOWN.lock().unwrap_or_else(PoisonError::into_inner).find(&key) {
        return Ok(shared);
    }
    // This is computed without the lock, so that other threads can build theirs in the meantime. If the same stiffness is
    // computed twice, the bits are equal.
    let made = Arc::new(Stiffness::new(surface, poisson, exterior, asked, break_off)?);
    let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(shared) = known.find(&key) {
        return Ok(shared);
    }
    known.shared.push((key, Arc::downgrade(&made)));
    known.last = Some(Arc::clone(&made));
    Ok(made)
}
