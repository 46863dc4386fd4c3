//! The lengths of the paths along which pins have moved their nodes, beyond a rigid motion of all pins.

use opruga_core::system::Pin;
use opruga_solve::dense::symmetric_eigen;

/// Rotations that the positions of the pins do not determine have eigenvalues below this, relative to the largest.
const NO_TURN: f64 = 1e-9;

/// The lengths of the paths of pins from the start of their motions to a time [m], along the axes that they hold. The nearest rigid motion is
/// subtracted from every piece of the motions, so the paths of pins that move or rotate as a whole have zero length.
pub(crate) fn travel_lengths<const D: usize>(pins: &[&Pin<D>], time: f64) -> Vec<f64> {
    let mut out = vec![0.0; pins.len()];
    if pins.iter().all(|pin| pin.motion.is_empty()) {
        return out;
    }
    let mut times: Vec<f64> = pins.iter().flat_map(|pin| pin.motion.iter().map(|row| row[0])).collect();
    times.retain(|t| *t < time);
    times.push(time);
    times.sort_by(f64::total_cmp);
    times.dedup();
    let mut before: Vec<[f64; D]> = pins.iter().map(|pin| pin.anchor).collect();
    for time in times {
        let after: Vec<[f64; D]> = pins.iter().map(|pin| pin.target(time).0).collect();
        let along_pinned_axes =
            |pin: &Pin<D>, step: [f64; D]| core::array::from_fn(|d| if pin.axes[d] { step[d] } else { 0.0 });
        let steps: Vec<[f64; D]> = pins
            .iter()
            .zip(before.iter().zip(&after))
            .map(|(pin, (from, to))| along_pinned_axes(pin, core::array::from_fn(|d| to[d] - from[d])))
            .collect();
        // A chord of a rotation is perpendicular to the radius at the middle of the chord.
        let middles: Vec<[f64; D]> =
            before.iter().zip(&after).map(|(from, to)| core::array::from_fn(|d| 0.5 * (from[d] + to[d]))).collect();
        let whole = nearest_rigid(&middles, &steps);
        for (k, pin) in pins.iter().enumerate() {
            let own: [f64; D] = along_pinned_axes(pin, core::array::from_fn(|d| steps[k][d] - whole[k][d]));
            out[k] += own.iter().map(|x| x * x).sum::<f64>().sqrt();
        }
        before = after;
    }
    out
}

/// The displacements of points in the small rigid motion that is nearest to their given displacements.
fn nearest_rigid<const D: usize>(points: &[[f64; D]], steps: &[[f64; D]]) -> Vec<[f64; D]> {
    let mean = |all: &[[f64; D]]| -> [f64; D] {
        core::array::from_fn(|d| all.iter().map(|x| x[d]).sum::<f64>() / all.len() as f64)
    };
    let (center, step) = (mean(points), mean(steps));
    // The planes of rotation: one in the plane, three in space.
    let planes: Vec<(usize, usize)> = (0..D).flat_map(|e| (0..e).map(move |d| (d, e))).collect();
    let n = planes.len();
    let turned = |plane: &(usize, usize), point: &[f64; D]| -> [f64; D] {
        let mut out = [0.0; D];
        out[plane.0] = -(point[plane.1] - center[plane.1]);
        out[plane.1] = point[plane.0] - center[plane.0];
        out
    };
    let (mut inertia, mut momentum) = (vec![0.0; n * n], vec![0.0; n]);
    for (point, own) in points.iter().zip(steps) {
        let turns: Vec<[f64; D]> = planes.iter().map(|plane| turned(plane, point)).collect();
        for p in 0..n {
            for d in 0..D {
                momentum[p] += turns[p][d] * (own[d] - step[d]);
                for q in 0..n {
                    inertia[p * n + q] += turns[p][d] * turns[q][d];
                }
            }
        }
    }
    let (values, vectors) = symmetric_eigen(&inertia, n);
    let least = NO_TURN * values.last().copied().unwrap_or(0.0);
    let mut spin = vec![0.0; n];
    for (value, vector) in values.iter().zip(&vectors).filter(|(value, _)| **value > least) {
        let part = vector.iter().zip(&momentum).map(|(a, b)| a * b).sum::<f64>() / value;
        spin.iter_mut().zip(vector).for_each(|(spin, x)| *spin += part * x);
    }
    points
        .iter()
        .map(|point| {
            let mut out = step;
            for (plane, spin) in planes.iter().zip(&spin) {
                let turn = turned(plane, point);
                (0..D).for_each(|d| out[d] += spin * turn[d]);
            }
            out
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    /// A pin that rotates about the x axis in steps of a few degrees from a start angle, and also moves with a constant speed.
    fn turning(x: f64, start: f64, degrees: f64, speed: [f64; 3]) -> Pin<3> {
        let at = |angle: f64| [x, libm::cos(angle.to_radians()), libm::sin(angle.to_radians())];
        let anchor = at(start);
        let row = |k: u32| {
            let t = f64::from(k) / 720.0;
            let to = at(start + degrees * t);
            let offset = (0..3).map(|d| to[d] - anchor[d] + speed[d] * t);
            core::iter::once(t).chain(offset).collect()
        };
        Pin { index: 0, axes: [true; 3], anchor, motion: Arc::new((0..=720).map(row).collect()) }
    }

    #[test]
    fn what_turns_and_flies_as_a_whole_goes_no_way_and_what_turns_against_another_its_half() {
        let ends = |degrees: [f64; 2]| -> Vec<Pin<3>> {
            let angles = [0.0, 90.0, 180.0, 270.0];
            (0..8)
                .map(|k| turning(f64::from(k / 4), angles[k as usize % 4], degrees[k as usize / 4], [3.0, 1e3, 2.0]))
                .collect()
        };
        let of = |pins: &[Pin<3>], time: f64| travel_lengths(&pins.iter().collect::<Vec<_>>(), time);
        for travel in of(&ends([1080.0; 2]), 2.0) {
            assert!(travel < 1e-9, "{travel}");
        }
        for (time, part) in [(0.0, 0.0), (0.5, 0.5), (1.0, 1.0), (7.0, 1.0)] {
            for travel in of(&ends([0.0, 1080.0]), time) {
                // Half of three turns at a radius of 1 m, measured by chords.
                assert!((travel - part * 3.0 * core::f64::consts::PI).abs() < 1e-3, "{travel} at {time}");
            }
        }
        let still = Pin { motion: Arc::new(Vec::new()), ..turning(0.0, 0.0, 0.0, [0.0; 3]) };
        assert_eq!(travel_lengths(&[&still, &still], 1.0), [0.0; 2]);
    }

    #[test]
    fn a_way_there_and_back_counts_twice_and_free_axes_do_not() {
        let pin = |x: f64, axes: [bool; 2], to: f64| Pin {
            index: 0,
            axes,
            anchor: [x, 0.0],
            motion: Arc::new(vec![vec![1.0, 0.0, 0.0], vec![2.0, to, 5.0], vec![3.0, 0.0, 0.0]]),
        };
        let pins = [pin(0.0, [true, false], -1.0), pin(1.0, [true, false], 1.0)];
        let all: Vec<&Pin<2>> = pins.iter().collect();
        for (time, travel) in [(1.0, 0.0), (1.5, 0.5), (2.0, 1.0), (3.0, 2.0), (9.0, 2.0)] {
            for found in travel_lengths(&all, time) {
                assert!((found - travel).abs() < 1e-12, "{found} at {time}");
            }
        }
    }
}
