//! The motions of a body as a whole, or of each of its pieces, that nothing holds.

use super::pieces::{pieces, whole};
use super::restraint::{deliver_outer, free_motions};
use super::slack::endless_turns;
use opruga_core::error::{BuildError, StepError};
use opruga_core::potential::Sink;
use opruga_core::state::Columns;
use opruga_core::system::System;
use opruga_math::words::number;
use opruga_solve::blocks::Block;
use opruga_solve::dense::symmetric_eigen;

/// Refuses a body that can move as a whole, or of which a piece can.
pub(super) fn refuse_free_motions<const D: usize>(system: &System<D>) -> Result<(), BuildError> {
    let x = &system.state.x;
    let refused = |message: String| Err(BuildError::new("equilibrium", "static.rigid_modes", message));
    let free = free_motions(system, x, &whole(system), &[]);
    if !free.is_empty() {
        return refused(format!(
            "nothing holds the body against {}; an equilibrium needs a body that is held; hint: pin as many axes of nodes \
             as there are rigid modes, or give it something to rest on",
            counted(&free)
        ));
    }
    let endless = endless_turns(system, &whole(system));
    if !endless.is_empty() {
        return refused(format!(
            "nothing holds the body against {}, since its forces are linear: what turns it turns it without end, and no weight \
             brings it back as it does a pendulum; an equilibrium needs a body that is held; hint: pin as many axes of nodes as \
             there are rigid modes, or take a material for large rotations, such as `neo_hookean`",
            counted(&endless)
        ));
    }
    let pieces = pieces(system);
    if pieces.len() > 1 {
        for piece in &pieces {
            let mut free = free_motions(system, x, piece, &[]);
            if free.is_empty() {
                free = endless_turns(system, piece);
            }
            if !free.is_empty() {
                return refused(format!(
                    "the body is in {} pieces, and nothing holds that of {} about {} against {}; an equilibrium needs every \
                     piece held; hint: pin as many axes of its nodes as it has rigid modes, join it to the others, or leave it out",
                    pieces.len(),
                    number_of(piece.len()),
                    place(&center(x, piece)),
                    counted(&free)
                ));
            }
        }
    }
    Ok(())
}

/// `translation along x, rotation: 2 rigid modes`.
fn counted<const D: usize>(free: &[Motion<D>]) -> String {
    let count = if free.len() == 1 { "1 rigid mode".into() } else { format!("{} rigid modes", free.len()) };
    format!("{}: {count}", names(free))
}

fn names<const D: usize>(free: &[Motion<D>]) -> String {
    free.iter().map(Motion::name).collect::<Vec<String>>().join(", ")
}

fn number_of(nodes: usize) -> String {
    if nodes == 1 { "1 node".into() } else { format!("{nodes} nodes") }
}

/// `(0.5, 2)`, a place in metres with four digits.
fn place<const D: usize>(x: &[f64; D]) -> String {
    let numbers: Vec<String> = x.iter().map(|x| number(*x)).collect();
    format!("({}) m", numbers.join(", "))
}

/// A motion of the whole: a translation and a rotation about the centre.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion<const D: usize> {
    pub(super) translation: [f64; D],
    /// One number in the plane, three in space.
    pub(super) rotation: Vec<f64>,
}

impl<const D: usize> Motion<D> {
    pub(super) fn turns(&self) -> bool {
        self.rotation.iter().any(|x| x.abs() > 1e-6)
    }
    /// `translation along x`, `rotation`.
    pub fn name(&self) -> String {
        let shown = |vector: &[f64]| {
            let size = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
            if let Some(axis) = vector.iter().position(|x| x.abs() > 0.999_999 * size) {
                return ["x", "y", "z"][axis].to_string();
            }
            let numbers: Vec<String> = vector.iter().map(|x| format!("{:.3}", x / size)).collect();
            format!("({})", numbers.join(", "))
        };
        match (self.turns(), D) {
            (false, _) => format!("translation along {}", shown(&self.translation)),
            (true, 2) => "rotation".into(),
            (true, _) => format!("rotation about an axis along {}", shown(&self.rotation)),
        }
    }
}

/// Adds up φᵀ K ψ for all pairs of motions.
pub(super) struct Projection<'a> {
    motions: &'a [Vec<f64>],
    pub(super) out: Vec<f64>,
    /// The largest entry of K that was met.
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
        for (a, x) in u {
            for (b, y) in u {
                let block = core::array::from_fn(|i| core::array::from_fn(|j| c * x[i] * y[j]));
                Sink::<D>::block(self, *a, *b, block);
            }
        }
    }
}

/// The mean of the places of some nodes.
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

/// Refuses a body that can move as a whole though it lies on obstacles, which hold nodes along the given directions, with its
/// nodes at the given places.
pub(super) fn refuse_what_contact_leaves_free<const D: usize>(
    system: &System<D>,
    x: &Columns<D>,
    touched: &[(usize, [f64; D])],
) -> Result<(), StepError> {
    if touched.is_empty() {
        return Ok(());
    }
    let free = free_motions(system, x, &whole(system), touched);
    if !free.is_empty() {
        let message = format!(
            "the body lies on an obstacle, and neither that nor pins hold it against {}; an equilibrium needs a body that is \
             held; hint: pin an axis of a node for each, or let the obstacle rub (`friction`)",
            names(&free)
        );
        return Err(StepError::Model { model: "equilibrium", message });
    }
    let pieces = pieces(system);
    // A piece that has not met an obstacle yet may still do so.
    let lies = |piece: &&Vec<usize>| touched.iter().any(|(node, _)| piece.binary_search(node).is_ok());
    for piece in pieces.iter().filter(|_| pieces.len() > 1).filter(lies) {
        let own: Vec<(usize, [f64; D])> =
            touched.iter().filter(|(node, _)| piece.binary_search(node).is_ok()).copied().collect();
        let free = free_motions(system, x, piece, &own);
        if !free.is_empty() {
            let message = format!(
                "the body is in {} pieces, and that of {} about {} lies on an obstacle, and neither that nor pins hold it \
                 against {}; an equilibrium needs every piece held; hint: pin an axis of a node for each, or let the obstacle rub \
                 (`friction`)",
                pieces.len(),
                number_of(piece.len()),
                place(&center(x, piece)),
                names(&free)
            );
            return Err(StepError::Model { model: "equilibrium", message });
        }
    }
    Ok(())
}

/// Whether neither pins nor loads with a stiffness hold a body or one of its pieces.
pub(super) fn is_loose<const D: usize>(system: &System<D>) -> bool {
    let x = &system.state.x;
    !unheld_motions(system).is_empty()
        || pieces(system).iter().any(|piece| !loose_motions(system, x, piece, &[], true).is_empty())
}

/// The motions of the whole that neither pins nor loads with a stiffness hold, translations first.
pub fn unheld_motions<const D: usize>(system: &System<D>) -> Vec<Motion<D>> {
    loose_motions(system, &system.state.x, &whole(system), &[], true)
}

/// The motions of a piece that neither pins hold nor what holds nodes along the given directions, with the nodes at the given
/// places; translations first.
pub(super) fn unpinned_motions<const D: usize>(
    system: &System<D>,
    x: &Columns<D>,
    piece: &[usize],
    touched: &[(usize, [f64; D])],
) -> Vec<Motion<D>> {
    loose_motions(system, x, piece, touched, false)
}

/// All motions of a piece: translations, then rotations about its centre, each scaled to a mean displacement of one.
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

fn loose_motions<const D: usize>(
    system: &System<D>,
    x: &Columns<D>,
    piece: &[usize],
    touched: &[(usize, [f64; D])],
    by_stiffness: bool,
) -> Vec<Motion<D>> {
    let motions = all_motions(x, piece);
    let center = center(x, piece);
    let shapes: Vec<Vec<f64>> =
        motions.iter().map(|motion| shape_at(x, system.nodes, piece, motion, &center)).collect();
    let n = motions.len();

    // How much each combination moves held axes, or strains what acts from outside.
    let mut held = vec![0.0; n * n];
    system.held_axes(&mut |place, d| {
        for p in 0..n {
            for q in 0..n {
                held[p * n + q] += shapes[p][place * D + d] * shapes[q][place * D + d];
            }
        }
    });
    for (node, direction) in touched {
        let along = |shape: &Vec<f64>| (0..D).map(|d| shape[node * D + d] * direction[d]).sum::<f64>();
        for p in 0..n {
            for q in 0..n {
                held[p * n + q] += along(&shapes[p]) * along(&shapes[q]);
            }
        }
    }
    if by_stiffness {
        let mut projection = Projection::of(&shapes);
        deliver_outer(system, x, &mut projection);
        if projection.largest > 0.0 {
            for (held, strained) in held.iter_mut().zip(&projection.out) {
                *held += strained / projection.largest;
            }
        }
    }
    // A rotation about the line on which all nodes lie moves nothing.
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
            (0..n * n).map(|e| a[e / n] * held[e] * b[e % n]).sum()
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

/// The motions of sums of others, as simple as may be.
pub(super) fn of_weights<const D: usize>(motions: &[Motion<D>], weights: Vec<Vec<f64>>) -> Vec<Motion<D>> {
    // In parts of translations and of rotations, which are the same for all lists of motions.
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

/// The displacements of all nodes in a motion, one coordinate after the other.
pub fn shape_of<const D: usize>(system: &System<D>, motion: &Motion<D>) -> Vec<f64> {
    let (x, all) = (&system.state.x, whole(system));
    shape_at(x, system.nodes, &all, motion, &center(x, &all))
}

/// The displacements of all nodes, at the given places, in a motion of a piece about the given centre: the others stay.
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

/// Row echelon form from the rotations backward: as many motions as possible are plain translations along axes.
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
