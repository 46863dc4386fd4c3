//! The motions of a body as a whole that nothing holds.

use opruga_core::error::{BuildError, StepError};
use opruga_core::potential::{Account, Definiteness, Sink};
use opruga_core::system::{Stage, System};
use opruga_solve::blocks::Block;
use opruga_solve::dense::symmetric_eigen;

/// Refuses a body that can move as a whole.
pub(super) fn refuse_free_motions<const D: usize>(system: &System<D>) -> Result<(), BuildError> {
    let free = free_motions(system);
    if free.is_empty() {
        return Ok(());
    }
    let names: Vec<String> = free.iter().map(Motion::name).collect();
    let count = if names.len() == 1 { "1 rigid mode".into() } else { format!("{} rigid modes", names.len()) };
    let message = format!(
        "nothing holds the body against {}: {count}; an equilibrium needs a body that is held; hint: pin as many axes of nodes \
         as there are rigid modes, or give it something to rest on",
        names.join(", ")
    );
    Err(BuildError::new("equilibrium", "static.rigid_modes", message))
}

/// A motion of the whole: a translation and a rotation about the centre.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion<const D: usize> {
    translation: [f64; D],
    /// One number in the plane, three in space.
    rotation: Vec<f64>,
}

impl<const D: usize> Motion<D> {
    fn turns(&self) -> bool {
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
struct Projection<'a> {
    motions: &'a [Vec<f64>],
    out: Vec<f64>,
    /// The largest entry that was met.
    largest: f64,
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

/// The motions of the whole that neither pins nor loads with a stiffness nor the weight of a pendulum hold, translations
/// first.
fn free_motions<const D: usize>(system: &System<D>) -> Vec<Motion<D>> {
    let mut free = unheld_motions(system);
    if free.iter().all(Motion::turns) {
        free.retain(|motion| !swings(system, motion, &center(system)));
    }
    free
}

fn center<const D: usize>(system: &System<D>) -> [f64; D] {
    let mut center = [0.0; D];
    for node in 0..system.nodes {
        let x = system.state.x.at(node);
        for d in 0..D {
            center[d] += x[d] / system.nodes as f64;
        }
    }
    center
}

/// Refuses a body that can move as a whole though it lies on obstacles, which hold nodes along the given directions, with its
/// nodes at the given places.
pub(super) fn refuse_what_contact_leaves_free<const D: usize>(
    system: &System<D>,
    positions: &[[f64; D]],
    touched: &[(usize, [f64; D])],
) -> Result<(), StepError> {
    let mut free = unheld_by(system, positions, touched);
    if free.iter().all(Motion::turns) {
        free.retain(|motion| !swings(system, motion, &center(system)));
    }
    if touched.is_empty() || free.is_empty() {
        return Ok(());
    }
    let names: Vec<String> = free.iter().map(Motion::name).collect();
    let message = format!(
        "the body lies on an obstacle, and neither that nor pins hold it against {}; an equilibrium needs a body that is \
         held; hint: pin an axis of a node for each, or let the obstacle rub (`friction`)",
        names.join(", ")
    );
    Err(StepError::Model { model: "equilibrium", message })
}

/// The motions of the whole that neither pins nor loads with a stiffness hold, translations first.
pub fn unheld_motions<const D: usize>(system: &System<D>) -> Vec<Motion<D>> {
    let positions: Vec<[f64; D]> = (0..system.nodes).map(|node| system.state.x.at(node)).collect();
    unheld_by(system, &positions, &[])
}

/// The same of nodes at the given places, some of which are held along the given directions as well.
fn unheld_by<const D: usize>(
    system: &System<D>,
    positions: &[[f64; D]],
    touched: &[(usize, [f64; D])],
) -> Vec<Motion<D>> {
    let nodes = system.nodes;
    let position = |node: usize| positions[node];
    let mut center = [0.0; D];
    for x in positions {
        for d in 0..D {
            center[d] += x[d] / nodes as f64;
        }
    }
    // Translations, then rotations about the centre, each scaled to a mean displacement of one.
    let turns = if D == 2 { 1 } else { 3 };
    let mut size: f64 = 0.0;
    for node in 0..nodes {
        let x = position(node);
        size += (0..D).map(|d| (x[d] - center[d]) * (x[d] - center[d])).sum::<f64>();
    }
    let size = (size / nodes as f64).sqrt();
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
    let shapes: Vec<Vec<f64>> = motions
        .iter()
        .map(|motion| (0..nodes).flat_map(|node| displacement(motion, &position(node), &center)).collect())
        .collect();
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
    let mut projection = Projection { motions: &shapes, out: vec![0.0; n * n], largest: 0.0 };
    system.outer_hessian(Stage::Current, 0.0, Definiteness::Exact, &mut projection);
    if projection.largest > 0.0 {
        for (held, strained) in held.iter_mut().zip(&projection.out) {
            *held += strained / projection.largest;
        }
    }
    // A rotation about the line on which all nodes lie moves nothing.
    let moved: Vec<f64> =
        (0..n * n).map(|k| shapes[k / n].iter().zip(&shapes[k % n]).map(|(a, b)| a * b).sum::<f64>()).collect();
    let (extents, axes) = symmetric_eigen(&moved, n);
    let real: Vec<Vec<f64>> = extents
        .iter()
        .zip(&axes)
        .filter(|(extent, _)| **extent > 1e-12 * nodes as f64)
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
    simplest(loose, n).iter().map(|weights| combine(&motions, weights)).collect()
}

/// The displacements of all nodes in a motion, one coordinate after the other.
pub fn shape_of<const D: usize>(system: &System<D>, motion: &Motion<D>) -> Vec<f64> {
    let center = center(system);
    (0..system.nodes).flat_map(|node| displacement(motion, &system.state.x.at(node), &center)).collect()
}

/// Whether weight or loads bring a turning body to a place of its own, as that of a pendulum: they do work on the way, of
/// first or of second order.
fn swings<const D: usize>(system: &System<D>, motion: &Motion<D>, center: &[f64; D]) -> bool {
    let (mut first, mut second, mut size) = (0.0, 0.0, 0.0);
    for node in 0..system.nodes {
        let way = displacement(motion, &system.state.x.at(node), center);
        // The turn goes on: ω × (ω × r).
        let turned: [f64; D] = core::array::from_fn(|d| way[d] + center[d]);
        let still = Motion { translation: [0.0; D], rotation: motion.rotation.clone() };
        let curve = displacement(&still, &turned, center);
        let mass = system.mass.at(node);
        for d in 0..D {
            let weight = mass * system.gravity[d];
            first += weight * way[d];
            second += weight * curve[d];
            size += (weight * way[d]).abs() + (weight * curve[d]).abs();
        }
    }
    let loaded = system.members.iter().any(|member| member.potential.account() == Account::User);
    loaded || first.abs() + second.abs() > 1e-9 * size
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

fn displacement<const D: usize>(motion: &Motion<D>, x: &[f64; D], center: &[f64; D]) -> [f64; D] {
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
