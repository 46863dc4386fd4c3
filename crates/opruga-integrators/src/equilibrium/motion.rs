//! The rigid motions of a body or a piece (translations and rotations), and which of them are prevented by pins.

use crate::refusals::MotionName;
use opruga_core::potential::{DensePart, Sink};
use opruga_core::state::Columns;
use opruga_core::system::System;
use opruga_solve::blocks::Block;
use opruga_solve::dense::symmetric_eigen;

/// A rigid motion: a translation and a rotation about the centre.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion<const D: usize> {
    pub(super) translation: [f64; D],
    /// The rate of rotation: one number in the plane, three in space.
    pub(super) rotation: Vec<f64>,
}

impl<const D: usize> Motion<D> {
    pub(super) fn turns(&self) -> bool {
        self.rotation.iter().any(|x| x.abs() > 1e-6)
    }
    /// Returns the name of the motion, such as `translation along x` or `rotation`.
    pub fn name(&self) -> MotionName {
        let shown = |vector: &[f64]| {
            let size = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
            if let Some(axis) = vector.iter().position(|x| x.abs() > 0.999_999 * size) {
                return ["x", "y", "z"][axis].to_string();
            }
            let numbers: Vec<String> = vector.iter().map(|x| format!("{:.3}", x / size)).collect();
            format!("({})", numbers.join(", "))
        };
        match (self.turns(), D) {
            (false, _) => MotionName::Translation { axis: shown(&self.translation) },
            (true, 2) => MotionName::Rotation {},
            (true, _) => MotionName::RotationAbout { axis: shown(&self.rotation) },
        }
    }
}

/// Sums φᵀ K ψ for all pairs of motions φ and ψ.
pub(super) struct Projection<'a> {
    motions: &'a [Vec<f64>],
    pub(super) out: Vec<f64>,
    /// The largest entry of K so far.
    pub(super) largest: f64,
}

impl Projection<'_> {
    pub(super) fn of(motions: &[Vec<f64>]) -> Projection<'_> {
        Projection { motions, out: vec![0.0; motions.len() * motions.len()], largest: 0.0 }
    }
}

impl<const D: usize> Sink<D> for Projection<'_> {
    fn block(&mut self, a: usize, b: usize, value: Block<D>) {
        let n = self.motions.len();
        for p in 0..n {
            for q in 0..n {
                for i in 0..D {
                    for j in 0..D {
                        self.out[p * n + q] += self.motions[p][a * D + i] * value[i][j] * self.motions[q][b * D + j];
                    }
                }
            }
        }
        let sizes = value.iter().flatten().map(|x| x.abs());
        self.largest = sizes.fold(self.largest, |most, x| if x > most { x } else { most });
    }
    fn low_rank(&mut self, c: f64, u: &[(usize, [f64; D])]) {
        let n = self.motions.len();
        let along = |motion: &Vec<f64>| -> f64 {
            u.iter().map(|(node, x)| (0..D).map(|d| motion[node * D + d] * x[d]).sum::<f64>()).sum()
        };
        let sums: Vec<f64> = self.motions.iter().map(along).collect();
        for p in 0..n {
            (0..n).for_each(|q| self.out[p * n + q] += c * sums[p] * sums[q]);
        }
        let squares = u.iter().flat_map(|(_, x)| x).map(|x| (c * x * x).abs());
        self.largest = squares.fold(self.largest, |most, x| if x > most { x } else { most });
    }
    fn dense(&mut self, part: &DensePart<'_, D>) {
        let n = self.motions.len();
        for q in 0..n {
            let motion = &self.motions[q];
            let pulled = part.product(|index| core::array::from_fn(|d| motion[index * D + d]));
            for p in 0..n {
                for (index, pulled) in part.indices.iter().zip(&pulled) {
                    let own = &self.motions[p][*index as usize * D..];
                    self.out[p * n + q] += (0..D).map(|d| own[d] * pulled[d]).sum::<f64>();
                }
            }
        }
        // In a matrix without negative eigenvalues the largest entry is on the diagonal.
        for number in 0..part.indices.len() {
            let sizes = part.block(number, number).into_iter().flatten().map(|x: f64| x.abs());
            self.largest = sizes.fold(self.largest, |most, x| if x > most { x } else { most });
        }
    }
}

/// The mean of the positions of some nodes.
pub(super) fn center<const D: usize>(x: &Columns<D>, piece: &[usize]) -> [f64; D] {
    let mut center = [0.0; D];
    for node in piece {
        let x = x.at(*node);
        for d in 0..D {
            center[d] += x[d] / piece.len() as f64;
        }
    }
    center
}

/// The rigid motions of a piece that neither pins nor constraints prevent. The nodes are at the positions `x`. Each entry of
/// `touched` constrains a node along a direction. Translations come first.
pub(super) fn unpinned_motions<const D: usize>(
    system: &System<D>,
    x: &Columns<D>,
    piece: &[usize],
    touched: &[(usize, [f64; D])],
) -> Vec<Motion<D>> {
    loose_motions(system, x, piece, touched, None)
}

/// All rigid motions of a piece: first translations, then rotations about the centre of the piece. Each motion is scaled to a
/// mean displacement of one.
pub(super) fn all_motions<const D: usize>(x: &Columns<D>, piece: &[usize]) -> Vec<Motion<D>> {
    let center = center(x, piece);
    let turns = if D == 2 { 1 } else { 3 };
    let mut size: f64 = 0.0;
    for node in piece {
        let x = x.at(*node);
        size += (0..D).map(|d| (x[d] - center[d]) * (x[d] - center[d])).sum::<f64>();
    }
    let size = (size / piece.len() as f64).sqrt();
    let mut motions: Vec<Motion<D>> = Vec::new();
    for d in 0..D {
        let mut translation = [0.0; D];
        translation[d] = 1.0;
        motions.push(Motion { translation, rotation: vec![0.0; turns] });
    }
    if size > 0.0 {
        for axis in 0..turns {
            let mut rotation = vec![0.0; turns];
            rotation[axis] = 1.0 / size;
            motions.push(Motion { translation: [0.0; D], rotation });
        }
    }
    motions
}

/// The motions that are not prevented by pins, by obstacles along the given directions, or by the stiffness that `deliver`
/// adds. Translations come first.
pub(super) fn loose_motions<const D: usize>(
    system: &System<D>,
    x: &Columns<D>,
    piece: &[usize],
    touched: &[(usize, [f64; D])],
    deliver: Option<&dyn Fn(&mut Projection<'_>)>,
) -> Vec<Motion<D>> {
    let motions = all_motions(x, piece);
    let center = center(x, piece);
    let shapes: Vec<Vec<f64>> =
        motions.iter().map(|motion| shape_at(x, system.nodes, piece, motion, &center)).collect();
    let n = motions.len();

    // The resistance of pinned axes, obstacles and external ties to every pair of motions.
    let mut resistance = vec![0.0; n * n];
    system.pinned_axes(&mut |node, d| {
        for p in 0..n {
            for q in 0..n {
                resistance[p * n + q] += shapes[p][node * D + d] * shapes[q][node * D + d];
            }
        }
    });
    for (node, direction) in touched {
        let along = |shape: &Vec<f64>| (0..D).map(|d| shape[node * D + d] * direction[d]).sum::<f64>();
        for p in 0..n {
            for q in 0..n {
                resistance[p * n + q] += along(&shapes[p]) * along(&shapes[q]);
            }
        }
    }
    if let Some(deliver) = deliver {
        let mut projection = Projection::of(&shapes);
        deliver(&mut projection);
        if projection.largest > 0.0 {
            for (resistance, strained) in resistance.iter_mut().zip(&projection.out) {
                *resistance += strained / projection.largest;
            }
        }
    }
    // A rotation about the line through all nodes moves nothing.
    let moved: Vec<f64> =
        (0..n * n).map(|k| shapes[k / n].iter().zip(&shapes[k % n]).map(|(a, b)| a * b).sum::<f64>()).collect();
    let (extents, axes) = symmetric_eigen(&moved, n);
    let real: Vec<Vec<f64>> = extents
        .iter()
        .zip(&axes)
        .filter(|(extent, _)| **extent > 1e-12 * piece.len() as f64)
        .map(|(extent, axis)| axis.iter().map(|c| c / extent.sqrt()).collect())
        .collect();
    let m = real.len();
    let reduced: Vec<f64> = (0..m * m)
        .map(|k| {
            let (a, b) = (&real[k / m], &real[k % m]);
            (0..n * n).map(|e| a[e / n] * resistance[e] * b[e % n]).sum()
        })
        .collect();
    let (values, vectors) = symmetric_eigen(&reduced, m);
    let largest = values.last().copied().unwrap_or(0.0);
    let loose: Vec<Vec<f64>> = values
        .iter()
        .zip(&vectors)
        .filter(|(value, _)| **value <= 1e-10 * largest || largest == 0.0)
        .map(|(_, vector)| (0..n).map(|p| (0..m).map(|k| vector[k] * real[k][p]).sum()).collect())
        .collect();
    of_weights(&motions, loose)
}

/// Returns combinations of the given motions with the given weights, in as simple a form as possible.
pub(super) fn of_weights<const D: usize>(motions: &[Motion<D>], weights: Vec<Vec<f64>>) -> Vec<Motion<D>> {
    // The components of translations and rotations are treated separately, so the result is the same for all lists of motions.
    let turns = if D == 2 { 1 } else { 3 };
    let longest = |motion: &Motion<D>| motion.rotation.iter().map(|r| r * r).sum::<f64>().sqrt();
    let most = motions.iter().map(longest).fold(0.0, |most: f64, r| if r > most { r } else { most });
    let scale = if most > 0.0 { most } else { 1.0 };
    let rows = weights
        .iter()
        .map(|weights| combine(motions, weights))
        .map(|motion| {
            let row = motion.translation.iter().copied().chain(motion.rotation.iter().map(|r| r / scale));
            row.collect::<Vec<f64>>()
        })
        .collect();
    simplest(rows, D + turns)
        .into_iter()
        .map(|row| Motion {
            translation: core::array::from_fn(|d| row[d]),
            rotation: row[D..].iter().map(|r| r * scale).collect(),
        })
        .collect()
}

/// The displacement of every node in a rigid motion of a piece about the given centre. The positions of the nodes are `x`.
/// Nodes outside the piece do not move.
pub(super) fn shape_at<const D: usize>(
    x: &Columns<D>,
    nodes: usize,
    piece: &[usize],
    motion: &Motion<D>,
    center: &[f64; D],
) -> Vec<f64> {
    let mut shape = vec![0.0; nodes * D];
    for node in piece {
        shape[node * D..][..D].copy_from_slice(&displacement(motion, &x.at(*node), center));
    }
    shape
}

/// Returns the row echelon form, starting from the rotations: as many motions as possible are pure translations along axes.
fn simplest(mut rows: Vec<Vec<f64>>, n: usize) -> Vec<Vec<f64>> {
    let mut done = 0;
    for column in (0..n).rev() {
        let Some(pivot) = (done..rows.len()).max_by(|a, b| rows[*a][column].abs().total_cmp(&rows[*b][column].abs()))
        else {
            break;
        };
        if rows[pivot][column].abs() < 1e-7 {
            continue;
        }
        rows.swap(done, pivot);
        let scale = rows[done][column];
        rows[done].iter_mut().for_each(|x| *x /= scale);
        let own = rows[done].clone();
        for (_, row) in rows.iter_mut().enumerate().filter(|(k, _)| *k != done) {
            let factor = row[column];
            row.iter_mut().zip(&own).for_each(|(x, o)| *x -= factor * o);
        }
        done += 1;
    }
    rows.iter_mut().flatten().filter(|x| x.abs() < 1e-7).for_each(|x| *x = 0.0);
    rows.reverse();
    rows
}

fn combine<const D: usize>(motions: &[Motion<D>], weights: &[f64]) -> Motion<D> {
    let mut out = Motion { translation: [0.0; D], rotation: vec![0.0; if D == 2 { 1 } else { 3 }] };
    for (motion, weight) in motions.iter().zip(weights) {
        for d in 0..D {
            out.translation[d] += weight * motion.translation[d];
        }
        for (o, r) in out.rotation.iter_mut().zip(&motion.rotation) {
            *o += weight * r;
        }
    }
    out
}

pub(super) fn displacement<const D: usize>(motion: &Motion<D>, x: &[f64; D], center: &[f64; D]) -> [f64; D] {
    let mut out = motion.translation;
    let arm: [f64; D] = core::array::from_fn(|d| x[d] - center[d]);
    if D == 2 {
        out[0] -= motion.rotation[0] * arm[1];
        out[1] += motion.rotation[0] * arm[0];
    } else {
        for d in 0..D {
            let (e, f) = ((d + 1) % D, (d + 2) % D);
            out[d] += motion.rotation[e] * arm[f] - motion.rotation[f] * arm[e];
        }
    }
    out
}
