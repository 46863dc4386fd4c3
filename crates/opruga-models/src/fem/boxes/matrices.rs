//! Matrices of quadrilaterals and hexahedra, compiled for every set of vector instructions.
//!
//! The energy of a cell (see [`super`]) is first differentiated by F and β. Every point contributes through
//!
//! ∂F_q/∂βₛ = f_s(q) F D_s,  ∂F_q/∂F = · (1 + ε_q).
//!
//! Since β depends on F and g, the derivatives by F and g follow (in `columns`). The derivatives by the corners come last.

use super::super::elements::Shape;
use super::super::group::Group;
use super::hourglass::{FIELDS, MOST_STRESSES, PAIRS, modes, pairs, term};
use super::rest::{Rest, Strained};
use super::{KEPT, Kept, corners};
use crate::materials::material::{Tangent, no_tangent};
use crate::materials::points::read_matrix;
use core::marker::PhantomData;
use opruga_core::potential::Definiteness;
use opruga_math::matrix::{self, Matrix};
use opruga_math::{Lane, Pack, Register, WIDTH, Work};

/// The quantity whose matrix is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in super::super) enum Of {
    /// The elastic energy. If it is clamped, terms that could be negative are left out.
    Energy(Definiteness),
    /// Damping.
    Damping,
}

/// Contracts tangents at the points of one pack of cells to blocks K_ab, a ≤ b, `[(a N + b)][i][k]` packs.
pub(in super::super) struct Contract<'a, E, const D: usize, const N: usize> {
    pub(in super::super) shape: PhantomData<E>,
    pub(in super::super) group: Group<'a>,
    /// The index of the pack in the group.
    pub(in super::super) pack: usize,
    pub(in super::super) of: Of,
    /// The quantities that [`super::Deform`] has kept.
    pub(in super::super) kept: &'a [f64],
    /// The stress at the points. It is read only if the energy is differentiated exactly.
    pub(in super::super) stress: &'a [f64],
    /// D⁴ packs for every pack of points.
    pub(in super::super) tangent: &'a [f64],
    pub(in super::super) times: &'a [f64],
    pub(in super::super) blocks: &'a mut [f64],
}

/// Second derivatives by F and β, and the first derivatives by β from which others follow.
pub(super) struct Sums<R, const D: usize> {
    /// By F and F, for non-decreasing rows.
    pub(super) ff: Tangent<R, D>,
    /// By F and β.
    pub(super) fb: [Matrix<R, D>; MOST_STRESSES],
    /// By β and β, for non-decreasing indices.
    pub(super) bb: [[R; MOST_STRESSES]; MOST_STRESSES],
    /// By β.
    pub(super) on_beta: [R; MOST_STRESSES],
}

impl<E: Shape<D, N>, const D: usize, const N: usize> Contract<'_, E, D, N> {
    #[inline(always)]
    fn tangent_at<R: Register>(&self, point: usize, part: usize) -> Tangent<R, D> {
        let mut out = no_tangent();
        for i in 0..D {
            for j in 0..D {
                out[i][j] = read_matrix(&self.tangent[((point * D + i) * D + j) * D * D * WIDTH..], part);
            }
        }
        out
    }

    /// The sums over the points.
    #[inline(always)]
    fn points<R: Register>(&self, part: usize, rest: &Rest<'_, R, D, N>, kept: &Kept<R, D>) -> Sums<R, D> {
        let (turns, size, points) = (self.group.turns, modes::<D, N>() * D, self.group.points);
        let one = matrix::identity::<R, D>();
        let strained = rest.strained(&if turns { kept.f } else { one });
        let plain = rest.strained(&one);
        // ∂F_q/∂β without the factors f_s(q).
        let (along, traces) = strained.pairs();
        // ∂F_q/∂F: · (1 + ε_q).
        let mut grown = [one; N];
        if turns {
            let fields = plain.fields(&kept.beta);
            rest.matrices_at_points(&one, &fields, |i, j, own| (0..N).for_each(|q| grown[q][i][j] = own[q]));
        }
        let mut sums = Sums {
            ff: no_tangent(),
            fb: [matrix::zeros(); MOST_STRESSES],
            bb: [[R::zero(); MOST_STRESSES]; MOST_STRESSES],
            on_beta: [R::zero(); MOST_STRESSES],
        };
        let mut squares = [[[R::zero(); N]; PAIRS]; PAIRS];
        for q in 0..N {
            let point = self.pack * points + q;
            let (grown, weight) = (&grown[q], rest.measures[q]);
            let tangent = self.tangent_at::<R>(point, part);
            let weighted = matrix::scaled(grown, weight);
            for m in 0..D {
                for n in 0..D {
                    // The change of the stress as F changes along m in that row.
                    let mut by = [[R::zero(); D]; D];
                    for i in 0..=m {
                        for l in 0..D {
                            for k in 0..D {
                                by[i][l] += tangent[i][l][m][k] * grown[n][k];
                            }
                        }
                        for j in 0..D {
                            for l in 0..D {
                                sums.ff[i][j][m][n] += weighted[j][l] * by[i][l];
                            }
                        }
                    }
                }
            }
            let mut image = [matrix::zeros::<R, D>(); PAIRS];
            let mut on_f = image;
            for pair in 0..pairs::<D>() {
                for i in 0..D {
                    for j in 0..D {
                        image[pair][i][j] = weight * matrix::inner(&tangent[i][j], &along[pair]);
                    }
                }
                on_f[pair] = if turns { matrix::product(&image[pair], grown) } else { image[pair] };
            }
            let mut beyond = rest.beyond * weight;
            if self.of == Of::Damping {
                beyond = beyond * R::load(&self.times[point * WIDTH + part * R::NUMBERS..]);
            }
            for a in 0..pairs::<D>() {
                for b in a..pairs::<D>() {
                    squares[a][b][q] = matrix::inner(&along[a], &image[b]) + beyond * traces[a] * traces[b];
                }
            }
            let functions = rest.functions(q);
            for s in 0..size {
                let (pair, field) = term::<D>(s);
                sums.fb[s] = matrix::plus(&sums.fb[s], functions[field], &on_f[pair]);
            }
        }
        for a in 0..pairs::<D>() {
            for b in a..pairs::<D>() {
                squares[a][b] = corners::sums(&squares[a][b]);
            }
        }
        for s in 0..size {
            for t in s..size {
                let ((a, f), (b, g)) = (term::<D>(s), term::<D>(t));
                let own = if a <= b { &squares[a][b] } else { &squares[b][a] };
                sums.bb[s][t] = rest.square(own, f, g);
            }
        }
        if points > N {
            self.add_middle(part, rest, &mut sums);
        }
        if turns && self.of == Of::Energy(Definiteness::Exact) {
            self.add_turned_stresses(part, rest, kept, &strained, &mut sums);
        }
        sums
    }

    /// Adds the contribution of the law at the mean of the cell. The point of the mean follows the other points.
    #[inline(always)]
    fn add_middle<R: Register>(&self, part: usize, rest: &Rest<'_, R, D, N>, sums: &mut Sums<R, D>) {
        let tangent = self.tangent_at::<R>(self.pack * self.group.points + N, part);
        let measure = rest.measure();
        for i in 0..D {
            for j in 0..D {
                for m in i..D {
                    for n in 0..D {
                        sums.ff[i][j][m][n] += measure * tangent[i][j][m][n];
                    }
                }
            }
        }
    }

    /// Adds the contribution that the stresses make because their strains rotate with F.
    #[inline(always)]
    fn add_turned_stresses<R: Register>(
        &self,
        part: usize,
        rest: &Rest<'_, R, D, N>,
        kept: &Kept<R, D>,
        strained: &Strained<R, D>,
        sums: &mut Sums<R, D>,
    ) {
        let mut stresses = [matrix::zeros::<R, D>(); FIELDS];
        for i in 0..D {
            for j in 0..D {
                let mut at = rest.measures;
                for q in 0..N {
                    let from = ((self.pack * self.group.points + q) * D * D + i * D + j) * WIDTH + part * R::NUMBERS;
                    at[q] = at[q] * R::load(&self.stress[from..]);
                }
                let (_, of_fields) = rest.over_points(&at);
                for field in 0..FIELDS {
                    stresses[field][i][j] = of_fields[field];
                }
            }
        }
        let mut at = rest.at_points(R::zero(), &strained.traces(&kept.beta));
        for q in 0..N {
            at[q] = rest.beyond * rest.measures[q] * at[q];
        }
        sums.on_beta = strained.pulls(&kept.beta, &stresses, &rest.over_points(&at).1).on_beta;
        let (strains, _) = rest.strained(&matrix::identity::<R, D>()).pairs();
        for s in 0..modes::<D, N>() * D {
            let (pair, field) = term::<D>(s);
            let turned = matrix::product(&stresses[field], &strains[pair]);
            sums.fb[s] = matrix::plus(&sums.fb[s], R::one(), &turned);
        }
    }
}

impl<E: Shape<D, N>, const D: usize, const N: usize> Work for Contract<'_, E, D, N> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let pack = self.group.first + self.pack;
        for part in 0..P::PARTS {
            let rest = Rest::<P::Part, D, N>::read(&self.group, pack, part);
            let kept = Kept::<P::Part, D>::read::<N>(&self.kept[self.pack * KEPT * WIDTH..], part);
            let sums = self.points(part, &rest, &kept);
            let second = self.by_columns(&rest, &kept, &sums);
            for i in 0..D {
                for m in i..D {
                    // Converts from columns to corners, on both sides.
                    let mut by_corner = [[P::Part::zero(); N]; N];
                    for d in 0..N - 1 {
                        let column = core::array::from_fn(|c| [second.0[i][m][c][d]]);
                        let column = rest.on_corners(&column);
                        for a in 0..N {
                            by_corner[a][d] = column[a][0];
                        }
                    }
                    for a in 0..N {
                        let row = rest.on_corners(&by_corner[a].map(|x| [x]));
                        for b in if i == m { a..N } else { 0..N } {
                            let (low, high) = if a <= b { ((a, i), (b, m)) } else { ((b, m), (a, i)) };
                            let block = (low.0 * N + high.0) * D * D;
                            let at = (block + low.1 * D + high.1) * WIDTH + part * P::Part::NUMBERS;
                            row[b][0].store(&mut self.blocks[at..]);
                            if a == b {
                                let mirrored = (block + m * D + i) * WIDTH + part * P::Part::NUMBERS;
                                row[b][0].store(&mut self.blocks[mirrored..]);
                            }
                        }
                    }
                }
            }
        }
    }
}
