//! Computes the stiffness of a boundary: G t = H u, K = symmetric part of Mᵀ G⁻¹ H without rigid motion.
//!
//! If u(ξ) is taken out of the strongly singular integral, the equation at a point ξ of the boundary is
//!
//! interior ∫ T (u(y) − u(ξ)) dS = ∫ U t dS,  exterior u(ξ) + ∫ T (u(y) − u(ξ)) dS = ∫ U t dS.
//!
//! The equation holds at corners too and contains no strongly singular integral. Translations of the body satisfy it up to
//! rounding. Rotations satisfy the equation up to the error of the integrals. Removing rotations from the stiffness corrects
//! that error.

use super::integrals::{Integrator, Sums};
use super::kernels::{Block, Kelvin};
use super::progress::{Part, Progress};
use super::refusals::{NoSolution, Refusal};
use super::stresses;
use super::surface::{Source, Surface};
use opruga_core::break_off::BreakOff;
use opruga_core::dense::Dense;
use opruga_solve::dense_system::{DenseCholesky, DenseFactors, clamp};
use std::sync::Arc;

/// The number of columns that are solved together. A request to stop takes effect between two such groups of columns.
const SIDES: usize = 256;

/// The relative changes that were made to a matrix to obtain the stiffness of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Changes {
    /// |K − Kᵀ|/|K + Kᵀ| before the symmetric part was taken.
    pub(super) asymmetry: f64,
    /// The relative size |QQᵀK|/|K| of the part of K that exerted forces under rigid motion. This size is measured after rigid
    /// motion was removed from the columns of K.
    pub(super) rigid: f64,
    /// The largest traction of a rotation by 1 rad, over μ. It measures the error of the integrals.
    pub(super) rotation: f64,
    /// The norm of the removed part with negative eigenvalues, divided by the norm of K.
    pub(super) negative: f64,
}

/// The stiffness of a boundary, for a shear modulus of 1 and lengths in units of its size.
#[derive(Debug)]
pub(super) struct Stiffness {
    pub(super) matrix: Arc<Dense>,
    pub(super) changes: Changes,
    /// The matrix from the displacements of the vertices to the stress at the requested points, with a row for each component
    /// at each point.
    pub(super) stresses: Vec<Vec<f64>>,
}

/// The system before it is solved, column by column.
struct System {
    /// The number of rows, D for each source.
    rows: usize,
    g: Vec<f64>,
    h: Vec<f64>,
}

impl System {
    fn assemble<const D: usize>(
        surface: &Surface<D>,
        kelvin: Kelvin,
        exterior: bool,
        progress: &mut Progress,
    ) -> Result<System, Refusal> {
        let rows = surface.sources.len() * D;
        let columns = surface.nodes * D;
        let mut system = System { rows, g: vec![0.0; rows * rows], h: vec![0.0; rows * columns] };
        let integrator = Integrator::new(kelvin);
        // The rows of a source are computed together and then written to their columns.
        let (mut own_g, mut own_h) = (vec![[[0.0; D]; D]; surface.sources.len()], vec![[[0.0; D]; D]; surface.nodes]);
        for (number, source) in surface.sources.iter().enumerate() {
            progress.step(1.0 / surface.sources.len() as f64)?;
            own_g.fill([[0.0; D]; D]);
            own_h.fill([[0.0; D]; D]);
            equation(surface, &integrator, source, exterior, &mut own_g, &mut own_h);
            for (blocks, to) in [(&own_g, &mut system.g), (&own_h, &mut system.h)] {
                for (column, block) in blocks.iter().enumerate() {
                    for i in 0..D {
                        for j in 0..D {
                            to[(column * D + j) * rows + number * D + i] = block[i][j];
                        }
                    }
                }
            }
        }
        Ok(system)
    }
}

/// The blocks of one source.
fn equation<const D: usize>(
    surface: &Surface<D>,
    integrator: &Integrator<D>,
    source: &Source<D>,
    exterior: bool,
    g: &mut [Block<D>],
    h: &mut [Block<D>],
) {
    // The coefficient of u(ξ).
    let mut own = [[0.0; D]; D];
    if exterior {
        for d in 0..D {
            own[d][d] = 1.0;
        }
    }
    for (number, (facet, side)) in surface.facets.iter().zip(&surface.sides).enumerate() {
        let touches = match source.vertex {
            Some(vertex) => facet.iter().position(|node| *node == vertex).map(|corner| {
                let mut shape = [0.0; D];
                shape[corner] = 1.0;
                shape
            }),
            None => (source.side as usize == number).then_some(source.shape),
        };
        let sums: Sums<D> = match &touches {
            Some(shape) => integrator.singular(&source.at, shape, side),
            None => integrator.regular(&source.at, side),
        };
        for k in 0..D {
            let traction = surface.corners[number][k] as usize;
            add(&mut g[traction], 1.0, &sums.displacement[k]);
            add(&mut h[facet[k] as usize], 1.0, &sums.traction[k]);
            if touches.is_none() {
                add(&mut own, -1.0, &sums.traction[k]);
            }
        }
    }
    for (node, share) in surface.facets[source.side as usize].iter().zip(&source.shape) {
        add(&mut h[*node as usize], *share, &own);
    }
}

fn add<const D: usize>(to: &mut Block<D>, factor: f64, value: &Block<D>) {
    for i in 0..D {
        for j in 0..D {
            to[i][j] += factor * value[i][j];
        }
    }
}

/// Rigid motions of the vertices, orthonormal, translations first. If the vertices are collinear, there are fewer motions.
pub(super) fn rigid_motions<const D: usize>(points: &[[f64; D]]) -> Vec<Vec<f64>> {
    let mut raw: Vec<Vec<f64>> = Vec::new();
    for d in 0..D {
        raw.push(points.iter().flat_map(|_| (0..D).map(move |e| if d == e { 1.0 } else { 0.0 })).collect());
    }
    for first in 0..D {
        for second in first + 1..D {
            let turn = |x: &[f64; D]| -> [f64; D] {
                core::array::from_fn(|d| match d {
                    d if d == first => -x[second],
                    d if d == second => x[first],
                    _ => 0.0,
                })
            };
            raw.push(points.iter().flat_map(turn).collect());
        }
    }
    let mut out: Vec<Vec<f64>> = Vec::new();
    for mut motion in raw {
        let before = opruga_solve::dot(&motion, &motion).sqrt();
        for _ in 0..2 {
            for known in &out {
                let along = opruga_solve::dot(&motion, known);
                motion.iter_mut().zip(known).for_each(|(x, y)| *x -= along * y);
            }
        }
        let length = opruga_solve::dot(&motion, &motion).sqrt();
        if length > 1e-9 * before {
            motion.iter_mut().for_each(|x| *x /= length);
            out.push(motion);
        }
    }
    out
}

/// Computes A q, for a matrix A given column by column.
fn times(matrix: &[f64], rows: usize, vector: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; rows];
    for (column, weight) in matrix.chunks_exact(rows).zip(vector) {
        out.iter_mut().zip(column).for_each(|(out, entry)| *out += weight * entry);
    }
    out
}

impl Stiffness {
    /// Computes the stiffness. `asked` contains the points at which the stress is requested, in units of the size and relative
    /// to the mean of the vertices.
    pub(super) fn new<const D: usize>(
        surface: &Surface<D>,
        poisson: f64,
        exterior: bool,
        asked: &[[f64; D]],
        break_off: &BreakOff,
    ) -> Result<Stiffness, Refusal> {
        let kelvin = Kelvin { poisson };
        let mut progress = Progress::new(break_off, surface.sources.len() * D);
        progress.part(Part::Integrals)?;
        let System { rows, g, mut h } = System::assemble(surface, kelvin, exterior, &mut progress)?;
        progress.part(Part::Factors)?;
        let factors = DenseFactors::new(rows, g).map_err(|_| Refusal::Singular { reason: NoSolution::Singular })?;
        // The medium around a boundary has no rigid motion.
        let motions = if exterior { Vec::new() } else { rigid_motions(&surface.points) };
        let mut changes = Changes::default();
        let pulled: Vec<Vec<f64>> = motions.iter().map(|motion| times(&h, rows, motion)).collect();
        for (number, (motion, force)) in motions.iter().zip(&pulled).enumerate() {
            for (column, weight) in h.chunks_exact_mut(rows).zip(motion) {
                column.iter_mut().zip(force).for_each(|(entry, force)| *entry -= weight * force);
            }
            if number >= D {
                changes.rotation = larger(changes.rotation, rotation_traction(surface, &factors, motion, force));
            }
        }
        progress.part(Part::Solutions)?;
        let columns = surface.nodes * D;
        for sides in h.chunks_mut(rows * SIDES) {
            factors.solve(sides);
            progress.step(sides.len() as f64 / (rows * columns) as f64)?;
        }
        drop(factors);
        progress.part(Part::Symmetry)?;
        if h.iter().any(|x| !x.is_finite()) {
            return Err(Refusal::Singular { reason: NoSolution::Singular });
        }
        let stresses = stresses::rows(surface, kelvin, asked, rows, &h);
        let mut k = forces_of_tractions(surface, rows, &h);
        drop(h);
        free_and_symmetrise(columns, &motions, &mut k, &mut changes);
        progress.part(Part::Signs)?;
        make_positive(columns, surface.nodes, &motions, &mut k, &mut changes)?;
        let matrix = Dense::of_lower(columns, |row, column| k[column * columns + row]);
        Ok(Stiffness { matrix: Arc::new(matrix), changes, stresses })
    }
}

fn larger(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

/// Returns an upper bound on the traction of a rotation by 1 rad, for a shear modulus of 1. Exact integrals would give zero.
/// `motion` contains the displacements of all vertices in a rotation about an axis through their mean, scaled to a norm of 1,
/// and `force` is H times `motion`.
fn rotation_traction<const D: usize>(
    surface: &Surface<D>,
    factors: &DenseFactors,
    motion: &[f64],
    force: &[f64],
) -> f64 {
    let mut traction = force.to_vec();
    factors.solve(&mut traction);
    let most = traction.iter().fold(0.0, |most, x| larger(most, x.abs()));
    // The displacement of a vertex is the angle times the distance from the axis. That distance is at most the distance from the
    // mean of the vertices. So the angle is at least the largest displacement divided by the largest distance from the mean.
    let moved = motion.chunks_exact(D).map(|x| x.iter().map(|x| x * x).sum::<f64>().sqrt());
    let reach = surface.points.iter().map(|x| x.iter().map(|x| x * x).sum::<f64>().sqrt());
    most * reach.fold(0.0, larger) / moved.fold(0.0, larger)
}

/// K = Mᵀ t for every column: ∫ N_a N_b dS is measure (1 + δ)/(D (D + 1)).
fn forces_of_tractions<const D: usize>(surface: &Surface<D>, rows: usize, tractions: &[f64]) -> Vec<f64> {
    let columns = surface.nodes * D;
    let mut k = vec![0.0; columns * columns];
    for (own, to) in tractions.chunks_exact(rows).zip(k.chunks_exact_mut(columns)) {
        for ((facet, side), corners) in surface.facets.iter().zip(&surface.sides).zip(&surface.corners) {
            let share = side.measure / (D * (D + 1)) as f64;
            for a in 0..D {
                for b in 0..D {
                    let weight = if a == b { 2.0 * share } else { share };
                    for d in 0..D {
                        to[facet[a] as usize * D + d] += weight * own[corners[b] as usize * D + d];
                    }
                }
            }
        }
    }
    k
}

/// Removes rigid motion from the rows, as it was removed from the columns, and then takes the symmetric part.
fn free_and_symmetrise(size: usize, motions: &[Vec<f64>], k: &mut [f64], changes: &mut Changes) {
    let (mut rigid, mut all) = (0.0, 0.0);
    for column in k.chunks_exact_mut(size) {
        all += opruga_solve::dot(column, column);
        for motion in motions {
            let along = opruga_solve::dot(motion, column);
            rigid += along * along;
            column.iter_mut().zip(motion).for_each(|(entry, x)| *entry -= along * x);
        }
    }
    let (mut skew, mut even) = (0.0, 0.0);
    for column in 0..size {
        for row in column..size {
            let (a, b) = (k[column * size + row], k[row * size + column]);
            skew += (a - b) * (a - b);
            even += (a + b) * (a + b);
            let mean = 0.5 * (a + b);
            (k[column * size + row], k[row * size + column]) = (mean, mean);
        }
    }
    changes.rigid = (rigid / all).sqrt();
    changes.asymmetry = (skew / even).sqrt();
}

/// The largest number of vertices for which negative eigenvalues are removed. Larger boundaries with negative eigenvalues are
/// refused. Finding all eigenvectors takes as long as the rest of the preparation.
const MOST_CLAMPED: usize = 1000;

/// The largest fraction of a stiffness that may be removed with its negative eigenvalues.
const MOST_NEGATIVE: f64 = 0.05;

/// Removes negative eigenvalues, because some motions would then create energy. Collocation can produce such eigenvalues if the
/// sides have unequal sizes.
fn make_positive(
    size: usize,
    vertices: usize,
    motions: &[Vec<f64>],
    k: &mut [f64],
    changes: &mut Changes,
) -> Result<(), Refusal> {
    if is_positive(size, motions, k) {
        return Ok(());
    }
    let refused = |reason| Refusal::Singular { reason };
    if vertices > MOST_CLAMPED {
        return Err(refused(NoSolution::NegativeOfMany));
    }
    changes.negative = clamp(size, k).map_err(|_| refused(NoSolution::NotFinite))?;
    if changes.negative > MOST_NEGATIVE {
        return Err(refused(NoSolution::ManyNegative));
    }
    // Rounding of the eigenvectors must not add rigid motion.
    for _ in 0..2 {
        for column in k.chunks_exact_mut(size) {
            for motion in motions {
                let along = opruga_solve::dot(motion, column);
                column.iter_mut().zip(motion).for_each(|(entry, x)| *entry -= along * x);
            }
        }
        for column in 0..size {
            for row in column + 1..size {
                let (a, b) = (k[column * size + row], k[row * size + column]);
                (k[column * size + row], k[row * size + column]) = (b, a);
            }
        }
    }
    for column in 0..size {
        for row in column + 1..size {
            let mean = 0.5 * (k[column * size + row] + k[row * size + column]);
            (k[column * size + row], k[row * size + column]) = (mean, mean);
        }
    }
    Ok(())
}

/// Whether a stiffness, given its rigid motions, has no negative eigenvalues beyond rounding.
fn is_positive(size: usize, motions: &[Vec<f64>], k: &[f64]) -> bool {
    let mean = (0..size).map(|n| k[n * size + n]).sum::<f64>() / size as f64;
    let mut shifted = k.to_vec();
    for motion in motions {
        for (column, weight) in shifted.chunks_exact_mut(size).zip(motion) {
            column.iter_mut().zip(motion).for_each(|(entry, x)| *entry += mean * weight * x);
        }
    }
    for n in 0..size {
        shifted[n * size + n] += 1e-12 * mean;
    }
    DenseCholesky::new(size, shifted).is_ok()
}

#[cfg(test)]
#[path = "assembly_tests.rs"]
mod tests;
