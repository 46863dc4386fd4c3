//! The work on some packs of elements, compiled for every set of vector instructions.
//!
//! The work proceeds register by register, because the data of a point barely fit into the registers.

use super::elements::Shape;
use super::group::Group;
use super::numbers::{NUMBERS, beyond};
use crate::materials::material::{Tangent, add_strain_tangent, no_tangent};
use crate::materials::points::{PARAMETERS, Points, read_matrix, write_matrix};
use core::marker::PhantomData;
use opruga_core::state::Layout;
use opruga_math::matrix::{self, Matrix};
use opruga_math::{Lane, Pack, ROW, Register, WIDTH, Work, fetch_early};

/// (∂X/∂ξ)⁻¹ and the measure of a point.
#[inline(always)]
pub(super) fn geometry<R: Register, const D: usize>(
    group: &Group<'_>,
    pack: usize,
    q: usize,
    part: usize,
) -> (Matrix<R, D>, R) {
    let stored = D * D + 1;
    let mut out = [[R::zero(); D]; D];
    match group.layout {
        Layout::Single => {
            let start = (pack * group.points + q) * stored * WIDTH;
            let from = &group.geometry[start..start + stored * WIDTH];
            for j in 0..D {
                for k in 0..D {
                    out[j][k] = R::load(&from[(j * D + k) * WIDTH + part * R::NUMBERS..]);
                }
            }
            (out, R::load(&from[D * D * WIDTH + part * R::NUMBERS..]))
        }
        Layout::Batch => {
            let start = (pack * group.points + q) * stored;
            let from = &group.geometry[start..start + stored];
            for j in 0..D {
                for k in 0..D {
                    out[j][k] = R::splat(from[j * D + k]);
                }
            }
            (out, R::splat(from[D * D]))
        }
    }
}

/// A vector of every node, in the layout that elements read.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nodes<'a, const D: usize> {
    /// For one body: [`ROW`] numbers per node.
    pub(super) rows: &'a [f64],
    /// For eight bodies: the columns of the state.
    pub(super) columns: [&'a [f64]; D],
}

/// Gathers a vector at the nodes of the elements in one part of a pack.
#[inline(always)]
pub(super) fn gather<R: Register, const D: usize, const N: usize>(
    group: &Group<'_>,
    nodes: &Nodes<'_, D>,
    pack: usize,
    part: usize,
) -> [[R; D]; N] {
    let offset = part * R::NUMBERS;
    let mut x = [[R::zero(); D]; N];
    match group.layout {
        Layout::Single => {
            let indices = &group.node_indices[pack * N * WIDTH..(pack + 1) * N * WIDTH];
            for a in 0..N {
                let of_node = &indices[a * WIDTH + offset..a * WIDTH + offset + R::NUMBERS];
                let row = R::gather_rows(nodes.rows, of_node);
                x[a].copy_from_slice(&row[..D]);
            }
        }
        Layout::Batch => {
            let indices = &group.node_indices[pack * N..(pack + 1) * N];
            for a in 0..N {
                for d in 0..D {
                    x[a][d] = R::load(&nodes.columns[d][indices[a] as usize + offset..]);
                }
            }
        }
    }
    x
}

/// Adds the forces of a pack of elements to the forces of their nodes.
#[inline(always)]
pub(super) fn scatter<P: Pack, const D: usize, const N: usize>(
    group: &Group<'_>,
    pack: usize,
    slots: &[[P; D]; N],
    force: &mut [f64],
) {
    match group.layout {
        Layout::Single => {
            let indices = &group.node_indices[pack * N * WIDTH..(pack + 1) * N * WIDTH];
            // Whole rows are added, four numbers at a time.
            let mut rows = [[[0.0; ROW]; WIDTH]; N];
            for a in 0..N {
                for part in 0..P::PARTS {
                    let mut columns = [P::Part::zero(); ROW];
                    for i in 0..D {
                        columns[i] = slots[a][i].part(part);
                    }
                    P::Part::store_rows(columns, rows[a][part * P::Part::NUMBERS..].as_flattened_mut());
                }
            }
            for l in 0..group.present(pack) {
                for a in 0..N {
                    let start = indices[a * WIDTH + l] as usize * ROW;
                    let node = &mut force[start..start + ROW];
                    for i in 0..ROW {
                        node[i] += rows[a][l][i];
                    }
                }
            }
        }
        Layout::Batch => {
            let targets = &group.targets[pack * N..(pack + 1) * N];
            for a in 0..N {
                for i in 0..D {
                    let at = &mut force[(targets[a] as usize * D + i) * WIDTH..][..WIDTH];
                    (P::load(at) + slots[a][i]).store(at);
                }
            }
        }
    }
}

/// Deformation gradients, or their rates: ∂x/∂X of some columns at all points of some packs.
pub(super) struct Gradients<'a, E, const D: usize, const N: usize> {
    pub(super) shape: PhantomData<E>,
    pub(super) group: Group<'a>,
    /// Positions or velocities: in rows for one body, in columns for eight.
    pub(super) nodes: Nodes<'a, D>,
    pub(super) gradient: &'a mut [f64],
}

impl<E: Shape<D, N>, const D: usize, const N: usize> Work for Gradients<'_, E, D, N> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let points = self.group.points;
        for k in 0..self.group.packs {
            let pack = self.group.first + k;
            for part in 0..P::PARTS {
                let x = gather::<P::Part, D, N>(&self.group, &self.nodes, pack, part);
                for q in 0..E::POINTS {
                    let (inverse, _) = geometry::<P::Part, D>(&self.group, pack, q, part);
                    let mut by_reference = matrix::zeros::<P::Part, D>();
                    for i in 0..D {
                        for j in 0..D {
                            by_reference[i][j] = if E::SIMPLEX {
                                x[j + 1][i] - x[0][i]
                            } else {
                                let mut sum = x[0][i] * P::Part::splat(E::SLOPES[q][0][j]);
                                for a in 1..N {
                                    sum += x[a][i] * P::Part::splat(E::SLOPES[q][a][j]);
                                }
                                sum
                            };
                        }
                    }
                    let f = matrix::product(&by_reference, &inverse);
                    write_matrix(&mut self.gradient[(k * points + q) * D * D * WIDTH..], part, &f);
                }
            }
        }
    }
}

/// The parameters of the points of a group, and their retardation times. If the law is also evaluated at the mean of a box, after
/// its points, the volumetric stiffness beyond λ′ is evaluated there.
pub(super) fn parameters_of_points(group: &Group<'_>, points: usize, parameters: &mut [f64], times: &mut [f64]) {
    for k in 0..group.packs {
        let numbers = &group.parameters[(group.first + k) * group.step..][..NUMBERS * WIDTH];
        for q in 0..group.points {
            let point = k * group.points + q;
            let to = &mut parameters[point * PARAMETERS * WIDTH..(point + 1) * PARAMETERS * WIDTH];
            to.copy_from_slice(&numbers[..PARAMETERS * WIDTH]);
            times[point * WIDTH..(point + 1) * WIDTH].copy_from_slice(&numbers[PARAMETERS * WIDTH..]);
            for l in (0..WIDTH).filter(|_| group.points > points) {
                let (mu, lambda) = (numbers[l], numbers[WIDTH + l]);
                let more = beyond(mu, lambda);
                (to[l], to[WIDTH + l]) = if q < points { (mu, lambda - more) } else { (0.0, more) };
            }
        }
    }
}

/// Computes the forces of elements on nodes. Densities of energy and power become energies and powers of elements.
pub(super) struct Forces<'a, E, const D: usize, const N: usize> {
    pub(super) shape: PhantomData<E>,
    pub(super) group: Group<'a>,
    pub(super) stress: &'a [f64],
    pub(super) density: &'a mut [f64],
    pub(super) power: Option<&'a mut [f64]>,
    pub(super) force: &'a mut [f64],
}

/// Replaces, in the pack, the densities at the points of an element by the sum of density times measure.
#[inline(always)]
fn integrate<P: Pack, const D: usize>(group: &Group<'_>, k: usize, density: &mut [f64]) {
    for part in 0..P::PARTS {
        let offset = part * P::Part::NUMBERS;
        let mut sum = P::Part::zero();
        for q in 0..group.points {
            let (_, measure) = geometry::<P::Part, D>(group, group.first + k, q, part);
            sum += measure * P::Part::load(&density[(k * group.points + q) * WIDTH + offset..]);
        }
        // Packs are summed in order, so no density that is still needed is overwritten.
        sum.store(&mut density[k * WIDTH + offset..]);
    }
}

impl<E, const D: usize, const N: usize> Forces<'_, E, D, N> {
    /// Prefetches the data of a pack for the next group. Every step reads more data than fit into a cache, and the processor
    /// does not fetch them by itself while the law is evaluated.
    #[inline(always)]
    fn fetch(&self, pack: usize) {
        if self.group.layout == Layout::Single {
            let (index_count, numbers) = (N * WIDTH, self.group.points * (D * D + 1) * WIDTH);
            fetch_early(self.group.node_indices, pack * index_count..(pack + 1) * index_count);
            fetch_early(self.group.geometry, pack * numbers..(pack + 1) * numbers);
        }
    }
}

impl<E: Shape<D, N>, const D: usize, const N: usize> Work for Forces<'_, E, D, N> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(mut self) {
        let points = self.group.points;
        let mut slots = [[P::zero(); D]; N];
        for k in 0..self.group.packs {
            let pack = self.group.first + k;
            self.fetch(pack + self.group.packs);
            integrate::<P, D>(&self.group, k, self.density);
            if let Some(power) = &mut self.power {
                integrate::<P, D>(&self.group, k, power);
            }
            for part in 0..P::PARTS {
                let mut force = [[P::Part::zero(); D]; N];
                let read = |q: usize| read_matrix::<P::Part, D>(&self.stress[(k * points + q) * D * D * WIDTH..], part);
                for q in 0..E::POINTS {
                    let (inverse, measure) = geometry::<P::Part, D>(&self.group, pack, q, part);
                    let stress = read(q);
                    // ∂U/∂(∂x/∂ξ) = V P (∂X/∂ξ)⁻ᵀ.
                    let pull = matrix::scaled(&matrix::product_transposed(&stress, &inverse), measure);
                    for i in 0..D {
                        if E::SIMPLEX {
                            let mut sum = P::Part::zero();
                            for j in 0..D {
                                force[j + 1][i] = -pull[i][j];
                                sum += pull[i][j];
                            }
                            force[0][i] = sum;
                        } else {
                            for a in 0..N {
                                for j in 0..D {
                                    force[a][i] -= pull[i][j] * P::Part::splat(E::SLOPES[q][a][j]);
                                }
                            }
                        }
                    }
                }
                for a in 0..N {
                    for i in 0..D {
                        slots[a][i].set_part(part, force[a][i]);
                    }
                }
            }
            scatter(&self.group, pack, &slots, self.force);
        }
    }
}

/// Adds the damping stress, F·S with S = τ (2μ Ė + λ tr Ė 1) and Ė = sym FᵀḞ, and computes the power S:Ė.
pub(super) struct ViscousStress<'a, const D: usize> {
    pub(super) points: Points<'a>,
    pub(super) rate: &'a [f64],
    pub(super) times: &'a [f64],
    pub(super) stress: &'a mut [f64],
    pub(super) power: &'a mut [f64],
}

/// Lamé's parameters times the retardation time.
#[inline(always)]
fn viscosities<R: Register>(points: &Points<'_>, times: &[f64], point: usize, part: usize) -> (R, R) {
    let offset = part * R::NUMBERS;
    let own = &points.parameters[point * PARAMETERS * WIDTH..(point + 1) * PARAMETERS * WIDTH];
    let time = R::load(&times[point * WIDTH + offset..]);
    (time * R::load(&own[offset..]), time * R::load(&own[WIDTH + offset..]))
}

impl<const D: usize> Work for ViscousStress<'_, D> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        for point in 0..self.points.count {
            let at = point * D * D * WIDTH;
            for part in 0..P::PARTS {
                let (mu, lambda) = viscosities::<P::Part>(&self.points, self.times, point, part);
                let f = read_matrix::<P::Part, D>(&self.points.gradient[at..], part);
                let rate = read_matrix::<P::Part, D>(&self.rate[at..], part);
                let product = matrix::transposed_product(&f, &rate);
                let mut strain = matrix::zeros::<P::Part, D>();
                for i in 0..D {
                    for j in 0..D {
                        strain[i][j] = P::Part::splat(0.5) * (product[i][j] + product[j][i]);
                    }
                }
                let trace = lambda * matrix::trace(&strain);
                let second = matrix::plus(&matrix::scaled(&strain, mu + mu), trace, &matrix::identity());
                let stress = read_matrix::<P::Part, D>(&self.stress[at..], part);
                let sum = matrix::plus(&stress, P::Part::one(), &matrix::product(&f, &second));
                write_matrix(&mut self.stress[at..], part, &sum);
                let power = matrix::inner(&second, &strain);
                power.store(&mut self.power[point * WIDTH + part * P::Part::NUMBERS..]);
            }
        }
    }
}

/// Derivatives of the damping stress by Ḟ.
pub(super) struct ViscousTangents<'a, const D: usize> {
    pub(super) points: Points<'a>,
    pub(super) times: &'a [f64],
    pub(super) tangent: &'a mut [f64],
}

impl<const D: usize> Work for ViscousTangents<'_, D> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        for point in 0..self.points.count {
            for part in 0..P::PARTS {
                let (mu, lambda) = viscosities::<P::Part>(&self.points, self.times, point, part);
                let f = read_matrix::<P::Part, D>(&self.points.gradient[point * D * D * WIDTH..], part);
                let mut tangent: Tangent<P::Part, D> = no_tangent();
                add_strain_tangent(&mut tangent, mu, lambda, &f);
                for i in 0..D {
                    for j in 0..D {
                        let at = ((point * D + i) * D + j) * D * D * WIDTH;
                        write_matrix(&mut self.tangent[at..], part, &tangent[i][j]);
                    }
                }
            }
        }
    }
}
