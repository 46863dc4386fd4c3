//! The work on some packs of elements, compiled for every set of vector instructions.
//!
//! It goes register by register: what a point needs at a time hardly fits the registers of one.

use super::elements::Shape;
use super::law::{PARAMETERS, Points, read_matrix, write_matrix};
use super::material::{Tangent, add_strain_tangent, no_tangent};
use super::section::{Group, NUMBERS};
use core::marker::PhantomData;
use opruga_core::state::Layout;
use opruga_math::matrix::{self, Matrix};
use opruga_math::{Lane, Pack, ROW, Register, WIDTH, Work};

/// (∂X/∂ξ)⁻¹ and the measure of a point.
#[inline(always)]
fn geometry<R: Register, const D: usize>(group: &Group<'_>, pack: usize, q: usize, part: usize) -> (Matrix<R, D>, R) {
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

/// A vector of every node, laid out as elements read it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nodes<'a, const D: usize> {
    /// For one body: [`ROW`] numbers a node.
    pub(super) rows: &'a [f64],
    /// For eight bodies: the columns of the state.
    pub(super) columns: [&'a [f64]; D],
}

/// Deformation gradients, or their rates: ∂x/∂X of some columns at all points of some packs.
pub(super) struct Gradients<'a, E, const D: usize, const N: usize> {
    pub(super) shape: PhantomData<E>,
    pub(super) group: Group<'a>,
    /// Positions or velocities: in rows for one body, in columns for eight.
    pub(super) nodes: Nodes<'a, D>,
    pub(super) gradient: &'a mut [f64],
    /// Room for the parameters of the points and their retardation times.
    pub(super) parameters: Option<(&'a mut [f64], &'a mut [f64])>,
}

impl<E: Shape<D, N>, const D: usize, const N: usize> Work for Gradients<'_, E, D, N> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(mut self) {
        let points = self.group.points;
        for k in 0..self.group.packs {
            let pack = self.group.first + k;
            let numbers = &self.group.parameters[pack * self.group.step..][..NUMBERS * WIDTH];
            for part in 0..P::PARTS {
                let offset = part * P::Part::NUMBERS;
                let mut x = [[P::Part::zero(); D]; N];
                match self.group.layout {
                    Layout::Single => {
                        let places = &self.group.places[pack * N * WIDTH..(pack + 1) * N * WIDTH];
                        for a in 0..N {
                            let of_node = &places[a * WIDTH + offset..a * WIDTH + offset + P::Part::NUMBERS];
                            let row = P::Part::gather_rows(self.nodes.rows, of_node);
                            x[a].copy_from_slice(&row[..D]);
                        }
                    }
                    Layout::Batch => {
                        let places = &self.group.places[pack * N..(pack + 1) * N];
                        for a in 0..N {
                            for d in 0..D {
                                x[a][d] = P::Part::load(&self.nodes.columns[d][places[a] as usize + offset..]);
                            }
                        }
                    }
                }
                let mut mean = matrix::zeros::<P::Part, D>();
                let shares = if self.group.selective {
                    geometry::<P::Part, D>(&self.group, pack, E::POINTS, part).0
                } else {
                    mean
                };
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
                    if E::SELECTIVE && self.group.selective {
                        mean = matrix::plus(&mean, shares[q / D][q % D], &f);
                    }
                }
                if E::SELECTIVE && self.group.selective {
                    write_matrix(&mut self.gradient[(k * points + E::POINTS) * D * D * WIDTH..], part, &mean);
                }
                if let Some((parameters, times)) = &mut self.parameters {
                    for q in 0..points {
                        // The part with λ of the mean deformation alone, the part with μ of all points.
                        let at_mean = self.group.selective && q == E::POINTS;
                        let read = |k: usize| P::Part::load(&numbers[k * WIDTH + offset..]);
                        let mu = if at_mean { P::Part::zero() } else { read(0) };
                        let lambda = if self.group.selective && !at_mean { P::Part::zero() } else { read(1) };
                        let point = k * points + q;
                        let to = &mut parameters[point * PARAMETERS * WIDTH..(point + 1) * PARAMETERS * WIDTH];
                        mu.store(&mut to[offset..]);
                        lambda.store(&mut to[WIDTH + offset..]);
                        read(2).store(&mut to[2 * WIDTH + offset..]);
                        read(3).store(&mut times[point * WIDTH + offset..]);
                    }
                }
            }
        }
    }
}

/// Forces of elements onto nodes; densities of energy and power become energies and powers of elements.
pub(super) struct Forces<'a, E, const D: usize, const N: usize> {
    pub(super) shape: PhantomData<E>,
    pub(super) group: Group<'a>,
    pub(super) stress: &'a [f64],
    pub(super) density: &'a mut [f64],
    pub(super) power: Option<&'a mut [f64]>,
    pub(super) force: &'a mut [f64],
}

/// The sum over the points of an element of a density times the measure, in the place of the pack.
#[inline(always)]
fn integrate<P: Pack, const D: usize>(group: &Group<'_>, k: usize, density: &mut [f64]) {
    for part in 0..P::PARTS {
        let offset = part * P::Part::NUMBERS;
        let mut sum = P::Part::zero();
        for q in 0..group.points {
            let (_, measure) = geometry::<P::Part, D>(group, group.first + k, q, part);
            sum += measure * P::Part::load(&density[(k * group.points + q) * WIDTH + offset..]);
        }
        // Packs are summed in order, so no density that is still needed lies here.
        sum.store(&mut density[k * WIDTH + offset..]);
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
            integrate::<P, D>(&self.group, k, self.density);
            if let Some(power) = &mut self.power {
                integrate::<P, D>(&self.group, k, power);
            }
            for part in 0..P::PARTS {
                let mut force = [[P::Part::zero(); D]; N];
                let read = |q: usize| read_matrix::<P::Part, D>(&self.stress[(k * points + q) * D * D * WIDTH..], part);
                for q in 0..E::POINTS {
                    let (inverse, measure) = geometry::<P::Part, D>(&self.group, pack, q, part);
                    let mut stress = read(q);
                    if E::SELECTIVE && self.group.selective {
                        stress = matrix::plus(&stress, P::Part::one(), &read(E::POINTS));
                    }
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
            match self.group.layout {
                Layout::Single => {
                    let places = &self.group.places[pack * N * WIDTH..(pack + 1) * N * WIDTH];
                    let mut numbers = [[[0.0; WIDTH]; D]; N];
                    for a in 0..N {
                        for i in 0..D {
                            numbers[a][i] = slots[a][i].to_array();
                        }
                    }
                    for l in 0..self.group.present(pack) {
                        for a in 0..N {
                            // Whole rows: one addition of four numbers.
                            let mut row = [0.0; ROW];
                            for i in 0..D {
                                row[i] = numbers[a][i][l];
                            }
                            let start = places[a * WIDTH + l] as usize * ROW;
                            let node = &mut self.force[start..start + ROW];
                            for i in 0..ROW {
                                node[i] += row[i];
                            }
                        }
                    }
                }
                Layout::Batch => {
                    let places = &self.group.places[pack * N..(pack + 1) * N];
                    for a in 0..N {
                        for i in 0..D {
                            let at = &mut self.force[places[a] as usize * D + i * WIDTH..][..WIDTH];
                            (P::load(at) + slots[a][i]).store(at);
                        }
                    }
                }
            }
        }
    }
}

/// Adds the stress of damping, F·S with S = τ (2μ Ė + λ tr Ė 1) and Ė = sym FᵀḞ, and gives the power S:Ė.
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

/// Derivatives of the stress of damping by Ḟ.
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

/// Tangents at the points of one pack of elements to blocks K_ab, a ≤ b, `[(a N + b)][i][k]` packs.
pub(super) struct Contract<'a, E, const D: usize, const N: usize> {
    pub(super) shape: PhantomData<E>,
    pub(super) group: Group<'a>,
    pub(super) tangent: &'a [f64],
    pub(super) blocks: &'a mut [f64],
}

impl<E: Shape<D, N>, const D: usize, const N: usize> Work for Contract<'_, E, D, N> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        // The first node of a simplex has what the others leave: sums over b of K_ab are zero.
        let start = usize::from(E::SIMPLEX);
        for part in 0..P::PARTS {
            let mut blocks = [[[[P::Part::zero(); D]; D]; N]; N];
            let mut mean = [[P::Part::zero(); D]; N];
            let (shares, whole) = geometry::<P::Part, D>(&self.group, self.group.first, self.group.points - 1, part);
            for q in 0..self.group.points {
                let (inverse, mut measure) = geometry::<P::Part, D>(&self.group, self.group.first, q, part);
                let mut slopes = [[P::Part::zero(); D]; N];
                if E::SELECTIVE && q == E::POINTS {
                    (slopes, measure) = (mean, whole);
                } else {
                    for a in start..N {
                        for m in 0..D {
                            slopes[a][m] = if E::SIMPLEX {
                                inverse[a - 1][m]
                            } else {
                                let mut sum = inverse[0][m] * P::Part::splat(E::SLOPES[q][a][0]);
                                for j in 1..D {
                                    sum += inverse[j][m] * P::Part::splat(E::SLOPES[q][a][j]);
                                }
                                sum
                            };
                            if E::SELECTIVE && self.group.selective {
                                mean[a][m] += shares[q / D][q % D] * slopes[a][m];
                            }
                        }
                    }
                }
                for i in 0..D {
                    // Row i of the tangent: ∂Pᵢⱼ/∂Fₖₗ.
                    let mut row = [[[P::Part::zero(); D]; D]; D];
                    for j in 0..D {
                        row[j] = read_matrix(&self.tangent[((q * D + i) * D + j) * D * D * WIDTH..], part);
                    }
                    for a in start..N {
                        let mut pulled = matrix::zeros::<P::Part, D>();
                        for j in 0..D {
                            let weight = measure * slopes[a][j];
                            for k in 0..D {
                                for l in 0..D {
                                    pulled[k][l] += weight * row[j][k][l];
                                }
                            }
                        }
                        for b in a..N {
                            for k in 0..D {
                                for l in 0..D {
                                    blocks[a][b][i][k] += pulled[k][l] * slopes[b][l];
                                }
                            }
                        }
                    }
                }
            }
            if E::SIMPLEX {
                for b in 1..N {
                    for i in 0..D {
                        for k in 0..D {
                            let mut sum = P::Part::zero();
                            for a in 1..N {
                                sum += if a <= b { blocks[a][b][i][k] } else { blocks[b][a][k][i] };
                            }
                            blocks[0][b][i][k] = -sum;
                        }
                    }
                }
                for i in 0..D {
                    for k in 0..D {
                        let mut sum = P::Part::zero();
                        for b in 1..N {
                            sum += blocks[0][b][i][k];
                        }
                        blocks[0][0][i][k] = -sum;
                    }
                }
            }
            for a in 0..N {
                for b in a..N {
                    write_matrix(&mut self.blocks[(a * N + b) * D * D * WIDTH..], part, &blocks[a][b]);
                }
            }
        }
    }
}
