//! Rigid motions of a body: translations and rotations about a centre, finite rotations, and the motions that nothing prevents.

use super::linear::Filter;
use opruga_solve::blocks::times;

/// Two held directions count as the same if they differ by less than this.
const SAME: f64 = 1e-8;

/// x moves by t + ω × (x − c). In the plane ω is along the third axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion<const D: usize> {
    pub(super) translation: [f64; D],
    pub(super) rotation: [f64; 3],
}

/// Returns ω × r.
fn cross<const D: usize>(rotation: &[f64; 3], arm: &[f64; D]) -> [f64; D] {
    let mut out = [0.0; D];
    if D == 2 {
        out[0] = -rotation[2] * arm[1];
        out[1] = rotation[2] * arm[0];
    } else {
        for d in 0..D {
            let (e, f) = ((d + 1) % 3, (d + 2) % 3);
            out[d] = rotation[e] * arm[f] - rotation[f] * arm[e];
        }
    }
    out
}

impl<const D: usize> Motion<D> {
    pub(super) const NONE: Motion<D> = Motion { translation: [0.0; D], rotation: [0.0; 3] };

    /// The displacement of a node at this position relative to the centre.
    pub(super) fn displacement(&self, arm: &[f64; D]) -> [f64; D] {
        let turned = cross(&self.rotation, arm);
        core::array::from_fn(|d| self.translation[d] + turned[d])
    }
    /// The displacement in a finite rotation: R − 1 = α (ω× + ½ ω×ω×), α = 1/(1 + ¼ω²), about the axis that does not move
    /// sideways, plus the translation along that axis.
    pub(super) fn finite_displacement(&self, arm: &[f64; D]) -> [f64; D] {
        let (displacement, turn) = (self.displacement(arm), &self.rotation);
        let again = cross(turn, &displacement);
        let square: f64 = turn.iter().map(|w| w * w).sum();
        let along: f64 = if D == 2 { 0.0 } else { (0..D).map(|d| turn[d] * self.translation[d]).sum() };
        let alpha = 1.0 / (1.0 + 0.25 * square);
        core::array::from_fn(|d| {
            let screw = if D == 2 { 0.0 } else { 0.25 * along * turn[d] };
            alpha * (displacement[d] + 0.5 * again[d] + screw)
        })
    }
    pub(super) fn add(&mut self, share: f64, other: &Motion<D>) {
        for d in 0..D {
            self.translation[d] += share * other.translation[d];
        }
        for (own, w) in self.rotation.iter_mut().zip(&other.rotation) {
            *own += share * w;
        }
    }
    pub(super) fn sum(motions: &[Motion<D>], shares: &[f64]) -> Motion<D> {
        let mut out = Motion::NONE;
        for (motion, share) in motions.iter().zip(shares) {
            out.add(*share, motion);
        }
        out
    }
}

/// A sum that loses only its last digit (Neumaier 1974).
#[derive(Clone, Copy, Default)]
pub(super) struct Sum {
    sum: f64,
    lost: f64,
}

impl Sum {
    pub(super) fn add(&mut self, x: f64) {
        let next = self.sum + x;
        self.lost += if self.sum.abs() >= x.abs() { (self.sum - next) + x } else { (x - next) + self.sum };
        self.sum = next;
    }
    pub(super) fn value(self) -> f64 {
        self.sum + self.lost
    }
}

/// The position of a node relative to the centre of its piece.
pub(super) fn arm<const D: usize>(x0: &[f64], u: &[f64], node: usize, center: &[f64; D]) -> [f64; D] {
    core::array::from_fn(|d| x0[node * D + d] + u[node * D + d] - center[d])
}

pub(super) fn along<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    (0..D).map(|d| a[d] * b[d]).sum()
}

/// The combinations of motions that move no node along its held directions.
pub(super) fn unheld<const D: usize>(
    all: &[Motion<D>],
    nodes: &[usize],
    filter: &Filter<D>,
    arm: impl Fn(usize) -> [f64; D],
) -> Vec<Motion<D>> {
    let n = all.len();
    // The components of the motions along each held direction, orthonormalised: at most as many rows as motions.
    let mut rows: Vec<Vec<f64>> = Vec::new();
    let reduced = |row: &[f64], rows: &[Vec<f64>]| {
        let mut rest = row.to_vec();
        for _ in 0..2 {
            for known in rows {
                let share: f64 = rest.iter().zip(known).map(|(a, b)| a * b).sum();
                rest.iter_mut().zip(known).for_each(|(r, k)| *r -= share * k);
            }
        }
        let size = rest.iter().map(|x| x * x).sum::<f64>().sqrt();
        (rest, size)
    };
    for node in nodes.iter().filter(|node| !filter.free[**node]) {
        let displacements: Vec<[f64; D]> = all
            .iter()
            .map(|motion| {
                let displacement = motion.displacement(&arm(*node));
                let free = times(&filter.projectors[*node], &displacement);
                core::array::from_fn(|d| displacement[d] - free[d])
            })
            .collect();
        for d in 0..D {
            let row: Vec<f64> = displacements.iter().map(|displacement| displacement[d]).collect();
            let whole = row.iter().map(|x| x * x).sum::<f64>().sqrt();
            let (rest, size) = reduced(&row, &rows);
            if size > SAME && size > SAME * whole && rows.len() < n {
                rows.push(rest.iter().map(|x| x / size).collect());
            }
        }
    }
    if rows.is_empty() {
        return all.to_vec();
    }
    // The remainders orthogonal to the rows, longest first.
    let mut out = Vec::new();
    while rows.len() < n {
        let mut best: (Vec<f64>, f64) = (Vec::new(), 0.0);
        for k in 0..n {
            let mut unit = vec![0.0; n];
            unit[k] = 1.0;
            let (rest, size) = reduced(&unit, &rows);
            if size > best.1 {
                best = (rest, size);
            }
        }
        if best.1 == 0.0 {
            break;
        }
        let unit: Vec<f64> = best.0.iter().map(|x| x / best.1).collect();
        out.push(Motion::sum(all, &unit));
        rows.push(unit);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use opruga_solve::blocks::isotropic;

    /// If several nodes of a plane body slide along one straight guide, the body can only slide, however many nodes these are.
    /// Directions that differ only by rounding do not count as separate directions.
    #[test]
    fn nodes_that_a_guide_holds_leave_one_motion() {
        let normal = [0.6, 0.8];
        let mut projector = isotropic::<2>(1.0);
        for i in 0..2 {
            for j in 0..2 {
                projector[i][j] -= normal[i] * normal[j];
            }
        }
        let unit = |d: usize| core::array::from_fn(|k| if k == d { 1.0 } else { 0.0 });
        let mut all: Vec<Motion<2>> = (0..2).map(|d| Motion { translation: unit(d), rotation: [0.0; 3] }).collect();
        all.push(Motion { translation: [0.0; 2], rotation: [0.0, 0.0, 1.0] });
        let nodes: Vec<usize> = (0..7).collect();
        let (free, projectors) = ([false; 7], [projector; 7]);
        let along_the_guide = |node: usize| [-0.8 * 0.1 * node as f64, 0.6 * 0.1 * node as f64];
        let left = unheld(&all, &nodes, &Filter { free: &free, projectors: &projectors }, along_the_guide);
        assert_eq!(left.len(), 1, "{left:?}");
        assert!(along(&left[0].translation, &normal).abs() < 1e-14 && left[0].rotation[2].abs() < 1e-14, "{left:?}");
        // If one of these nodes is held along one direction, two motions remain.
        let one = unheld(&all, &nodes[3..4], &Filter { free: &free, projectors: &projectors }, along_the_guide);
        assert_eq!(one.len(), 2, "{one:?}");
    }
}
