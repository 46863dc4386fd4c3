//! Nodes that are pinned or moved along a path: their prescribed positions, and the work of the pins.

use core::ops::Range;
use opruga_math::WIDTH;

/// A node pinned along some axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Pin<const D: usize> {
    /// The index of the node in the columns.
    pub index: usize,
    /// Which axes are pinned.
    pub axes: [bool; D],
    /// The position at which it is pinned [m].
    pub anchor: [f64; D],
    /// Displacement from this position over time, rows `[t, dx, dy(, dz)]`; empty if there is none.
    pub motion: std::sync::Arc<Vec<Vec<f64>>>,
}

impl<const D: usize> Pin<D> {
    /// The prescribed position and velocity at a time.
    pub fn target(&self, time: f64) -> ([f64; D], [f64; D]) {
        let (offset, rate) = along_path::<D>(&self.motion, time);
        (core::array::from_fn(|d| self.anchor[d] + offset[d]), rate)
    }
    /// The acceleration of the path around a time [m/s²], from the mean velocities over a `span` before and a `span` after this
    /// time. At a corner of the path, this is the change of velocity divided by `span`.
    pub fn acceleration(&self, time: f64, span: f64) -> [f64; D] {
        if self.motion.is_empty() {
            return [0.0; D];
        }
        let [before, now, after] = [time - span, time, time + span].map(|time| along_path::<D>(&self.motion, time).0);
        core::array::from_fn(|d| ((after[d] - now[d]) - (now[d] - before[d])) / (span * span))
    }
}

/// The point and its velocity on a piecewise linear path with rows `[t, x, y(, z)]`. Before and after the path, the point is at
/// rest.
pub fn along_path<const D: usize>(path: &[Vec<f64>], time: f64) -> ([f64; D], [f64; D]) {
    let point = |row: &Vec<f64>| core::array::from_fn(|d| row[d + 1]);
    let (Some(first), Some(last)) = (path.first(), path.last()) else {
        return ([0.0; D], [0.0; D]);
    };
    if time < first[0] {
        return (point(first), [0.0; D]);
    }
    for pair in path.windows(2) {
        if time < pair[1][0] {
            let span = pair[1][0] - pair[0][0];
            let s = (time - pair[0][0]) / span;
            let (a, b): ([f64; D], [f64; D]) = (point(&pair[0]), point(&pair[1]));
            return (
                core::array::from_fn(|d| a[d] + s * (b[d] - a[d])),
                core::array::from_fn(|d| (b[d] - a[d]) / span),
            );
        }
    }
    (point(last), [0.0; D])
}

/// The pinned nodes: every node once with its pinned axes, ordered by index.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct PinnedNodes<const D: usize>(Vec<PinnedNode<D>>);

/// A pinned node.
#[derive(Clone, Debug, PartialEq)]
struct PinnedNode<const D: usize> {
    index: usize,
    axes: [bool; D],
    /// The mean velocity of the node within the step [m/s], if it is known; a motion may begin or end within a step.
    mean: Option<[f64; D]>,
}

impl<const D: usize> PinnedNodes<D> {
    /// The nodes of these pins; a node that is pinned twice is listed once.
    pub(crate) fn of(pins: &[Pin<D>]) -> PinnedNodes<D> {
        let mut nodes: Vec<PinnedNode<D>> =
            pins.iter().map(|pin| PinnedNode { index: pin.index, axes: pin.axes, mean: None }).collect();
        nodes.sort_by_key(|node| node.index);
        nodes.dedup_by(|next, kept| {
            let same = next.index == kept.index;
            if same {
                (0..D).for_each(|d| kept.axes[d] |= next.axes[d]);
            }
            same
        });
        PinnedNodes(nodes)
    }
    /// Stores the mean velocities of moving pins in the coming step of length `h` [s].
    pub(crate) fn learn(&mut self, pins: &[Pin<D>], time: f64, h: f64) {
        for pin in pins.iter().filter(|pin| !pin.motion.is_empty()) {
            let (from, to) = (pin.target(time).0, pin.target(time + h).0);
            if let Ok(k) = self.0.binary_search_by_key(&pin.index, |node| node.index) {
                let node = &mut self.0[k];
                let mean = node.mean.get_or_insert([0.0; D]);
                for d in (0..D).filter(|d| pin.axes[*d]) {
                    mean[d] = (to[d] - from[d]) / h;
                }
            }
        }
    }
    /// Pinned indices within a range, and their pinned axes.
    pub(crate) fn within(&self, range: &Range<usize>) -> impl Iterator<Item = (usize, usize)> {
        self.nodes(range).flat_map(|node| (0..D).filter(|d| node.axes[*d]).map(|d| (node.index, d)))
    }
    fn nodes(&self, range: &Range<usize>) -> impl Iterator<Item = &PinnedNode<D>> {
        let first = self.0.partition_point(|node| node.index < range.start);
        let last = self.0.partition_point(|node| node.index < range.end);
        self.0[first..last].iter()
    }
    /// Adds the work −F·v dt that pins do against the forces of the models.
    #[inline]
    pub(crate) fn add_work_against(
        &self,
        range: &Range<usize>,
        weight: f64,
        force: impl Fn(usize, usize) -> f64,
        velocity: [&[f64]; D],
        work: &mut [f64; WIDTH],
    ) {
        if self.0.is_empty() {
            return;
        }
        for node in self.nodes(range) {
            for d in (0..D).filter(|d| node.axes[*d]) {
                let rate = node.mean.map_or(velocity[d][node.index], |mean| mean[d]);
                work[node.index % WIDTH] -= weight * force(d, node.index) * rate;
            }
        }
    }
}
