//! Forces of boxes on their corners.

use super::super::elements::Shape;
use super::super::group::Group;
use super::super::work::scatter;
use super::hourglass::{FIELDS, modes};
use super::rest::Rest;
use super::{Frame, KEPT, Kept, cofactor_along};
use crate::materials::points::read_matrix;
use core::marker::PhantomData;
use opruga_math::matrix;
use opruga_math::{Lane, Pack, Register, WIDTH, Work};

/// Rates of a state, for damping.
pub(in super::super) struct Rates<'a> {
    /// The data that [`super::DeformRates`] has written.
    pub(in super::super) kept: &'a [f64],
    /// Retardation times of the points.
    pub(in super::super) times: &'a [f64],
    /// Power densities, which become powers of cells.
    pub(in super::super) power: &'a mut [f64],
}

/// Computes the forces of cells on nodes. Densities of energy and power become energies and powers of cells.
pub(in super::super) struct Push<'a, E, const D: usize, const N: usize> {
    pub(in super::super) shape: PhantomData<E>,
    pub(in super::super) group: Group<'a>,
    pub(in super::super) kept: &'a [f64],
    pub(in super::super) stress: &'a [f64],
    pub(in super::super) density: &'a mut [f64],
    pub(in super::super) rates: Option<Rates<'a>>,
    pub(in super::super) force: &'a mut [f64],
}

impl<E: Shape<D, N>, const D: usize, const N: usize> Work for Push<'_, E, D, N> {
    type Output = ();
    #[inline(always)]
    #[expect(
        clippy::too_many_lines,
        reason = "with parts of it in functions of their own, forces take 12 % longer with AVX-512, although all is inlined"
    )]
    fn run<P: Pack>(mut self) {
        let (count, turns, points) = (modes::<D, N>(), self.group.turns, self.group.points);
        let half = P::Part::splat(0.5);
        let mut slots = [[P::zero(); D]; N];
        for k in 0..self.group.packs {
            let pack = self.group.first + k;
            for part in 0..P::PARTS {
                let offset = part * P::Part::NUMBERS;
                let rest = Rest::<P::Part, D, N>::read(&self.group, pack, part);
                let Kept { f, g, beta } = Kept::<P::Part, D>::read::<N>(&self.kept[k * KEPT * WIDTH..], part);
                let strained = rest.strained(&if turns { f } else { matrix::identity() });
                // Σ V P, and Σ V f P for the functions f of the stresses.
                let mut on_f = matrix::zeros::<P::Part, D>();
                let mut stresses = [matrix::zeros::<P::Part, D>(); FIELDS];
                for i in 0..D {
                    for j in 0..D {
                        let mut at = rest.measures;
                        for q in 0..N {
                            let from = ((k * points + q) * D * D + i * D + j) * WIDTH + offset;
                            at[q] = at[q] * P::Part::load(&self.stress[from..]);
                        }
                        let (sum, of_fields) = rest.over_points(&at);
                        on_f[i][j] = sum;
                        for field in 0..FIELDS {
                            stresses[field][i][j] = of_fields[field];
                        }
                    }
                }
                let (mut energy, mut lost) = (P::Part::zero(), P::Part::zero());
                for q in 0..N {
                    let from = (k * points + q) * WIDTH + offset;
                    energy += rest.measures[q] * P::Part::load(&self.density[from..]);
                    if let Some(rates) = &self.rates {
                        lost += rest.measures[q] * P::Part::load(&rates.power[from..]);
                    }
                }
                // Σ V f p, where p is the pressure that the law includes at the mean instead of at the points.
                let mut pressures = [P::Part::zero(); FIELDS];
                if points > N {
                    let swells = rest.at_points(P::Part::zero(), &strained.traces(&beta));
                    let mut at = rest.measures;
                    for q in 0..N {
                        let pressure = rest.beyond * at[q] * swells[q];
                        energy += half * pressure * swells[q];
                        at[q] = pressure;
                    }
                    if let Some(rates) = &self.rates {
                        let kept = Kept::<P::Part, D>::read::<N>(&rates.kept[k * KEPT * WIDTH..], part);
                        let swells = rest.at_points(P::Part::zero(), &strained.traces(&kept.beta));
                        for q in 0..N {
                            let time = P::Part::load(&rates.times[(k * points + q) * WIDTH + offset..]);
                            let drag = time * rest.beyond * rest.measures[q] * swells[q];
                            lost += drag * swells[q];
                            at[q] += drag;
                        }
                    }
                    pressures = rest.over_points(&at).1;
                    let (point, measure) = (k * points + N, rest.measure());
                    let stress = read_matrix::<P::Part, D>(&self.stress[point * D * D * WIDTH..], part);
                    on_f = matrix::plus(&on_f, measure, &stress);
                    energy += measure * P::Part::load(&self.density[point * WIDTH + offset..]);
                    if let Some(rates) = &self.rates {
                        lost += measure * P::Part::load(&rates.power[point * WIDTH + offset..]);
                    }
                }
                let pulls = strained.pulls(&beta, &stresses, &pressures);
                if turns {
                    on_f = matrix::plus(&on_f, P::Part::one(), &strained.on_base(&pulls));
                }
                let on_q = rest.on_amplitudes(&pulls.on_beta);
                let mut on_g = on_q;
                if turns {
                    // Forces on the amplitudes q become forces on F and g. Degenerate cells add the guard energy.
                    let frame = Frame::new(&f);
                    let mut on_cofactors = matrix::zeros::<P::Part, D>();
                    let mut guarded = P::Part::zero();
                    for mode in 0..count {
                        for j in 0..D {
                            let stiff = rest.guards[mode] * g[mode][j];
                            guarded += stiff * g[mode][j];
                            let mut sum = P::Part::zero();
                            for i in 0..D {
                                on_cofactors[j][i] += g[mode][j] * on_q[mode][i];
                                sum += frame.cofactors[j][i] * on_q[mode][i];
                            }
                            on_g[mode][j] = frame.phi[0] * sum + frame.lost[0] * stiff;
                        }
                    }
                    let on_volume =
                        frame.phi[1] * matrix::inner(&on_cofactors, &frame.cofactors) + half * frame.lost[1] * guarded;
                    on_f = matrix::plus(&on_f, frame.phi[0], &cofactor_along(&f, &on_cofactors));
                    on_f = matrix::plus(&on_f, on_volume, &frame.cofactors);
                    energy += half * frame.lost[0] * guarded;
                }
                let mut columns = [[P::Part::zero(); D]; N];
                for i in 0..D {
                    for j in 0..D {
                        columns[j][i] = -on_f[i][j];
                    }
                    for mode in 0..count {
                        columns[D + mode][i] = -on_g[mode][i];
                    }
                }
                let forces = rest.on_corners(&columns);
                for node in 0..N {
                    for i in 0..D {
                        slots[node][i].set_part(part, forces[node][i]);
                    }
                }
                // Packs are summed in order, so no density that is still needed is overwritten.
                energy.store(&mut self.density[k * WIDTH + offset..]);
                if let Some(rates) = &mut self.rates {
                    lost.store(&mut rates.power[k * WIDTH + offset..]);
                }
            }
            scatter(&self.group, pack, &slots, self.force);
        }
    }
}
