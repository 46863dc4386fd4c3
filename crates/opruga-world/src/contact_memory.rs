//! The state of contact that is kept from frame to frame: the impulses at the end of the last substep, which are the starting values of the next one.
//!
//! Impulses belong to pairs of features. Pushes, which are impulses that a step already includes, belong to nodes. The memory stores both by the
//! numbers of bodies in the scene, independently of clusters. Their order depends only on bodies and features.

use crate::bytes::{Reader, Writer};
use crate::clusters::Clusters;
use crate::error::WorldError;
use crate::island::Island;
use crate::meeting::Meeting;
use crate::path_faults::SnapshotFault;

/// The impulses of a pair along its normal and perpendicular to it [N s]; with a barrier, its friction multiplier [N].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Kept<const D: usize> {
    pub(crate) pair: PairKey,
    pub(crate) along: f64,
    pub(crate) across: [f64; D],
}

/// Two features.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct PairKey {
    /// The kind of the pair: see [`KINDS`].
    pub(crate) kind: u32,
    /// The body and the feature. For an obstacle, [`OBSTACLE`] plus the number of the obstacle takes the place of the body.
    pub(crate) first: [u32; 2],
    pub(crate) second: [u32; 2],
}

/// The number of kinds of pairs: a vertex and a facet, two edges, or a point and a surface of an obstacle that holds nodes.
const KINDS: u32 = 3;

/// The last kind: a point and a surface of an obstacle.
const OF_SURFACE: u32 = 2;

/// The offset that is added to the number of an obstacle whose corners and edges are features.
const OBSTACLE: u32 = 1 << 31;

/// The impulse of contact on a node in its step [N s].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Push<const D: usize> {
    pub(crate) body: u32,
    /// The number of the point within the body.
    pub(crate) point: u32,
    pub(crate) impulse: [f64; D],
}

/// The state of contact, in ascending order.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct ContactMemory<const D: usize> {
    pub(crate) pairs: Vec<Kept<D>>,
    pub(crate) pushes: Vec<Push<D>>,
}

impl<const D: usize> ContactMemory<D> {
    /// Forgets everything.
    pub(crate) fn clear(&mut self) {
        self.pairs.clear();
        self.pushes.clear();
    }

    /// Forgets the entries of bodies that were replaced or removed.
    pub(crate) fn forget(&mut self, is_gone: impl Fn(usize) -> bool) {
        let gone = |[body, _]: [u32; 2]| body < OBSTACLE && is_gone(body as usize);
        self.pairs.retain(|kept| !gone(kept.pair.first) && !gone(kept.pair.second));
        self.pushes.retain(|push| !is_gone(push.body as usize));
    }

    /// Stores the impulses that the clusters have found at the end of a frame.
    pub(crate) fn take(&mut self, clusters: &Clusters<D>) {
        self.clear();
        for meeting in clusters.meetings() {
            meeting.remember(self);
        }
        self.pairs.sort_unstable_by_key(|kept| kept.pair);
        self.pushes.sort_unstable_by_key(|push| (push.body, push.point));
    }

    /// Writes everything into a snapshot.
    pub(crate) fn write(&self, out: &mut Writer<'_>) {
        out.count(self.pairs.len() as u64);
        for Kept { pair: PairKey { kind, first, second }, along, across } in &self.pairs {
            out.count(u64::from(*kind));
            first.iter().chain(second).for_each(|n| out.count(u64::from(*n)));
            out.number(*along);
            across.iter().for_each(|c| out.number(*c));
        }
        out.count(self.pushes.len() as u64);
        for Push { body, point, impulse } in &self.pushes {
            out.count(u64::from(*body));
            out.count(u64::from(*point));
            impulse.iter().for_each(|c| out.number(*c));
        }
    }

    /// Reads the state of contact from a snapshot.
    ///
    /// # Errors
    /// [`WorldError::Snapshot`] if the snapshot contains impossible values.
    pub(crate) fn read(reader: &mut Reader<'_>) -> Result<ContactMemory<D>, WorldError> {
        let refuse = || WorldError::snapshot(SnapshotFault::Contact {});
        let index = |reader: &mut Reader<'_>| u32::try_from(reader.count()?).map_err(|_| refuse());
        let number = |reader: &mut Reader<'_>| {
            let x = reader.number()?;
            if x.is_finite() { Ok(x) } else { Err(refuse()) }
        };
        let vector = |reader: &mut Reader<'_>| {
            let mut out = [0.0; D];
            for c in &mut out {
                *c = number(reader)?;
            }
            Ok::<_, WorldError>(out)
        };
        let mut out = ContactMemory::default();
        for _ in 0..reader.length()? {
            let kind = index(reader)?;
            let [a, b, c, d] = [index(reader)?, index(reader)?, index(reader)?, index(reader)?];
            let pair = PairKey { kind, first: [a, b], second: [c, d] };
            out.pairs.push(Kept { pair, along: number(reader)?, across: vector(reader)? });
        }
        for _ in 0..reader.length()? {
            out.pushes.push(Push { body: index(reader)?, point: index(reader)?, impulse: vector(reader)? });
        }
        let ascend = out.pairs.is_sorted_by(|a, b| a.pair < b.pair)
            && out.pushes.is_sorted_by(|a, b| (a.body, a.point) < (b.body, b.point));
        if !ascend || out.pairs.iter().any(|kept| kept.pair.kind >= KINDS || kept.along < 0.0) {
            return Err(refuse());
        }
        Ok(out)
    }
}

impl<const D: usize> Meeting<D> {
    /// Adds the impulses of this meeting to the memory.
    fn remember(&self, memory: &mut ContactMemory<D>) {
        let bodies = |number: u32| match self.bodies.get(number as usize) {
            Some(body) => *body as u32,
            None => OBSTACLE | self.cluster.outlines[number as usize - self.bodies.len()],
        };
        let key = |[kind, first, feature, second, other]: [u32; 5]| PairKey {
            kind,
            first: [bodies(first), feature],
            second: [if kind == OF_SURFACE { OBSTACLE } else { bodies(second) }, other],
        };
        match &self.barrier {
            Some(kept) => memory.pairs.extend(kept.multipliers.iter().map(|(id, across)| Kept {
                pair: key(self.touching.features_of(*id)),
                along: 0.0,
                across: *across,
            })),
            None => self.touching.visit_kept(|features, along, across| {
                memory.pairs.push(Kept { pair: key(features), along, across });
            }),
        }
        for (body, pushed) in self.pushed.iter().enumerate() {
            let first = self.touching.coupled.points_of(body).start;
            let number = self.touching.surface.body[first];
            let push = |(point, impulse): &(usize, [f64; D])| Push {
                body: bodies(number),
                point: *point as u32,
                impulse: *impulse,
            };
            memory.pushes.extend(pushed.applied.iter().map(push));
        }
    }

    /// Takes the stored impulses of its bodies as initial values.
    pub(crate) fn recall(&mut self, memory: &ContactMemory<D>, islands: &mut [&mut Island<D>], h: f64) {
        let number = |body: u32| match body.checked_sub(OBSTACLE) {
            Some(outline) => self.cluster.outlines.binary_search(&outline).ok().map(|k| (self.bodies.len() + k) as u32),
            None => self.bodies.binary_search(&(body as usize)).ok().map(|k| k as u32),
        };
        let known = |kept: &Kept<D>| {
            let PairKey { kind, first, second } = kept.pair;
            let other = if kind == OF_SURFACE { 0 } else { number(second[0])? };
            let id = self.touching.id_of([kind, number(first[0])?, first[1], other, second[1]])?;
            Some((id, kept.along, kept.across))
        };
        // The impulses are stored in the order of the pairs, which is that of their numbers.
        let firsts = self.bodies.iter().map(|body| *body as u32);
        let firsts = firsts.chain(self.cluster.outlines.iter().map(|outline| OBSTACLE | outline));
        let of_body = |kind: u32, body: u32| {
            let from = memory.pairs.partition_point(|kept| (kept.pair.kind, kept.pair.first[0]) < (kind, body));
            memory.pairs[from..].iter().take_while(move |kept| (kept.pair.kind, kept.pair.first[0]) == (kind, body))
        };
        let firsts = (0..KINDS).flat_map(|kind| firsts.clone().map(move |body| (kind, body)));
        let pairs = firsts.flat_map(|(kind, body)| of_body(kind, body)).filter_map(known);
        let pairs: Vec<(u64, f64, [f64; D])> = pairs.collect();
        match &mut self.barrier {
            Some(kept) => kept.multipliers = pairs.into_iter().map(|(id, _, across)| (id, across)).collect(),
            None => self.touching.keep(pairs.into_iter()),
        }
        for (body, pushed) in self.pushed.iter_mut().enumerate() {
            let first = self.touching.coupled.points_of(body).start;
            let own = self.bodies[self.touching.surface.body[first] as usize] as u32;
            let from = memory.pushes.partition_point(|push| push.body < own);
            let pushes = memory.pushes[from..].iter().take_while(|push| push.body == own);
            let there = pushes.filter(|push| (push.point as usize) < pushed.indices.len());
            pushed.applied = there.map(|push| (push.point as usize, push.impulse)).collect();
            if !pushed.applied.is_empty() {
                islands[pushed.island].system.pushes = Some(pushed.forces(h));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn memory() -> ContactMemory<2> {
        let pair = |kind: u32, first: [u32; 2], second: [u32; 2]| PairKey { kind, first, second };
        let kept = |pair: PairKey| Kept { pair, along: 2.0, across: [0.5, -0.25] };
        ContactMemory {
            pairs: vec![
                kept(pair(0, [1, 4], [2, 0])),
                kept(pair(0, [OBSTACLE, 0], [1, 3])),
                kept(pair(OF_SURFACE, [3, 5], [OBSTACLE, 1])),
            ],
            pushes: vec![
                Push { body: 1, point: 4, impulse: [2.0, 0.0] },
                Push { body: 2, point: 0, impulse: [-2.0, 0.0] },
            ],
        }
    }

    #[test]
    fn what_is_written_is_read() {
        let mut bytes = Vec::new();
        memory().write(&mut Writer(&mut bytes));
        assert_eq!(ContactMemory::read(&mut Reader(&bytes)).expect("what was written"), memory());
        for length in 0..bytes.len() {
            assert!(ContactMemory::<2>::read(&mut Reader(&bytes[..length])).is_err(), "{length} bytes");
        }
        let refused = |change: &dyn Fn(&mut ContactMemory<2>)| {
            let (mut bytes, mut damaged) = (Vec::new(), memory());
            change(&mut damaged);
            damaged.write(&mut Writer(&mut bytes));
            ContactMemory::<2>::read(&mut Reader(&bytes)).is_err()
        };
        assert!(refused(&|memory| memory.pairs.swap(0, 1)));
        assert!(refused(&|memory| memory.pairs[0].along = -1.0));
        assert!(refused(&|memory| memory.pairs[0].across[1] = f64::NAN));
        assert!(refused(&|memory| memory.pairs[2].pair.kind = KINDS));
        assert!(refused(&|memory| memory.pushes.swap(0, 1)));
    }

    #[test]
    fn bodies_that_change_are_forgotten() {
        let mut left = memory();
        left.forget(|body| body == 2);
        let kept: Vec<u32> = left.pairs.iter().map(|kept| kept.pair.second[0]).collect();
        assert_eq!(kept, [1, OBSTACLE]);
        assert_eq!(left.pushes.len(), 1);
        left.forget(|body| body == 3);
        assert_eq!(left.pairs.len(), 1);
    }
}
