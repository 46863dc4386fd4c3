//! What is known about the distances of candidates.

/// The candidates of one kind in their order, and a bound on the distance of each.
///
/// Candidates of the same two bodies share an entry of `bodies`, so that the limit for their bounds is computed once for all of them.
#[derive(Clone, Debug, Default)]
pub(crate) struct KnownPairs {
    features: Vec<[u32; 2]>,
    /// The latest known distance of every pair, plus the paths of both bodies at that time [m].
    until: Vec<f64>,
    /// The index of the bodies of every pair.
    index: Vec<u32>,
    bodies: Vec<[u32; 2]>,
    /// For every entry of `bodies`, the value below which a bound does not exclude a contact in this step [m].
    limits: Vec<f64>,
    /// The bounds of the previous candidates during a merge.
    before: Vec<f64>,
}

impl KnownPairs {
    /// Discards all bounds.
    pub(crate) fn forget(&mut self) {
        self.features.clear();
        self.until.clear();
    }

    /// Replaces the pairs by new ones, both in ascending order; `bodies` gives the bodies of a pair. The bounds of pairs in both lists are
    /// kept.
    pub(crate) fn take(&mut self, pairs: &[[u32; 2]], bodies: impl Fn([u32; 2]) -> [u32; 2]) {
        std::mem::swap(&mut self.until, &mut self.before);
        self.until.clear();
        let mut known = self.features.iter().zip(&self.before).peekable();
        for features in pairs {
            while known.next_if(|(one, _)| *one < features).is_some() {}
            let same = known.next_if(|(one, _)| *one == features);
            self.until.push(same.map_or(f64::NEG_INFINITY, |(_, until)| *until));
        }
        self.features.clear();
        self.features.extend(pairs);
        self.index.clear();
        self.bodies.clear();
        // Pairs are sorted by their first feature, hence by its body, so the entries of one body are the last ones.
        let mut first = 0;
        for features in pairs {
            let own = bodies(*features);
            if self.bodies.get(first).is_some_and(|[body, _]| *body != own[0]) {
                first = self.bodies.len();
            }
            let entry = self.bodies[first..].iter().position(|other| *other == own);
            self.index.push((first + entry.unwrap_or(self.bodies.len() - first)) as u32);
            if entry.is_none() {
                self.bodies.push(own);
            }
        }
    }

    /// Sets the limit of all pairs, given the limit for two bodies [m].
    pub(crate) fn set_limits(&mut self, limit: impl Fn(&[u32; 2]) -> f64) {
        self.limits.clear();
        self.limits.extend(self.bodies.iter().map(limit));
    }

    /// Whether the bound of a pair exceeds its limit by more than a distance [m].
    #[inline(always)]
    pub(crate) fn exceeds(&self, pair: usize, distance: f64) -> bool {
        self.until[pair] > self.limits[self.index[pair] as usize] + distance
    }

    /// The bodies of a pair.
    #[inline]
    pub(crate) fn bodies(&self, pair: usize) -> [u32; 2] {
        self.bodies[self.index[pair] as usize]
    }

    /// Sets the bound of a pair [m].
    #[inline]
    pub(crate) fn set(&mut self, pair: usize, until: f64) {
        self.until[pair] = until;
    }

    /// Bytes on the heap.
    pub(crate) fn heap_bytes(&self) -> usize {
        8 * (self.features.capacity() + self.until.capacity() + self.before.capacity() + self.bodies.capacity())
            + 4 * self.index.capacity()
            + 8 * self.limits.capacity()
    }
}
