//! Impulses of contacts of bodies that answer as a whole, all at once: a semismooth Newton method.
//!
//! ```text
//! motion    u = free + W λ                         W = G Y Gᵀ, the velocities of gaps by impulses
//! pressing  N = max(0, a),  a = N − ρ (uₙ − target)
//! friction  F = the point of the disc |F| ≤ µ max(0, a) that is nearest to b = F − r uₜ
//! ```
//!
//! A contact that is apart (a ≤ 0) has no impulse, one that sticks (|b| ≤ µ a) does not move, one that slides has the whole friction along b.
//! What they miss is linear but at the borders between these cases, so Newton's method converges where sweeps let contacts stick and slide in
//! turn. Contacts are redundant, and W has no inverse: a part of its diagonal, on the change of the impulses, makes the solution unique (a
//! proximal point). What that holds back, the next attempt gives, with a smaller part where this one has ended and with a larger one where not.
//!
//! Source: P. Alart, A. Curnier, A mixed formulation for frictional contact problems prone to Newton like solution methods, Computer Methods in
//! Applied Mechanics and Engineering 92 (1991) 353–375; V. Acary, M. Brémond, O. Huber, On solving contact problems with Coulomb friction:
//! formulations and numerical comparisons (2018), section 6 (proximal point with Newton's method).

use crate::coupled::Coupled;
use crate::elimination::{Add, Eliminate};
use crate::row::Row;
use crate::spread::Spread;
use crate::vector::{across, add, dot, scaled, subtract};
use opruga_math::{Lane, Simd, WIDTH};

/// The most unknowns. An elimination takes ⅓ n³ products: 0.2 · 10⁹ for so many, as much as a hundred sweeps take over bodies of so many points.
pub(crate) const MOST_UNKNOWNS: usize = 900;

/// The part of the diagonal of W that holds changes of impulses back: at the beginning and at least, and at most. It is larger where Newton's method
/// did not end, which then finds it easier, and smaller where it did, as the next impulses are to come nearer. With a fixed part,
/// `a_cube_of_space_comes_to_its_balance_on_a_slab` has no end.
const LEAST_PROXIMAL: f64 = 1e-7;
const MOST_PROXIMAL: f64 = 1.0;
const FIRMER: f64 = 10.0;
const LOOSER: f64 = 0.03;

/// Sweeps between attempts with Newton's method. They choose which contacts stick and slide; one by one they do not converge.
const SWEEPS: usize = 10;

/// The most attempts in a row that do not halve what a sweep changes.
const MOST_IN_VAIN: usize = 10;

/// The most iterations of one attempt, and the most of them after which more is missed.
const MOST_ITERATIONS: usize = 30;
const MOST_UPHILL: usize = 1;

/// How often a correction is halved. Where nothing helps, a tenth of it is taken: cases change then, and what is missed may rise on the way.
const MOST_HALVINGS: usize = 12;
const UPHILL: f64 = 0.1;

/// The part of the tolerance to which Newton's method goes: the sweep that follows finds nothing to change. And the part of the squares of what is
/// missed at the beginning below which the rest is rounding.
const ENOUGH: f64 = 0.1;
const ROUNDING: f64 = 1e-12;

/// A contact and its unknowns: the impulse along its normal, and where it has friction those across it.
struct Contact<const D: usize> {
    row: usize,
    axes: [[f64; D]; D],
    first: usize,
    count: usize,
    friction: f64,
    /// Inverses of the mobilities along and across [kg].
    mass: [f64; 2],
}

/// What a contact does at a trial.
enum Case<const D: usize> {
    Apart,
    Sticks,
    /// Along a direction; with the radius of the disc over the length of b.
    Slides([f64; D], f64),
}

struct Equations<const D: usize> {
    contacts: Vec<Contact<D>>,
    /// W by unknowns, row by row of `stride` numbers.
    mobility: Vec<f64>,
    stride: usize,
    /// Velocities without impulses, less the targets [m/s].
    free: Vec<f64>,
    /// The impulses that changes are counted from [N s]; of the diagonal of W [1/kg] the part that holds changes back.
    center: Vec<f64>,
    diagonal: Vec<f64>,
    proximal: f64,
}

/// Impulses, what they give, and what they miss.
struct Trial {
    impulses: Vec<f64>,
    /// Velocities, less the targets and with what holds changes of impulses back [m/s].
    velocities: Vec<f64>,
    /// What the laws of the contacts miss [m/s].
    missed: Vec<f64>,
}

/// The unknowns of a contact.
pub(crate) fn count_of<const D: usize>(row: &Row<D>) -> usize {
    match row.mass[0] > 0.0 {
        true if row.friction > 0.0 => D,
        moves => usize::from(moves),
    }
}

/// How near to its end a solution comes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Aim {
    /// By how much a turn of a contact may change its velocity at the end [m/s].
    pub(crate) enough: f64,
    /// Whether sweeps go on alone, so many at most, where they have not ended at once; else Newton's method leads to the end.
    pub(crate) sweeps: Option<usize>,
}

/// Goes to the impulses at which all contacts obey their laws: sweeps over all contacts, and Newton's method where these have not ended. Ends where
/// no turn of a contact changes its velocity by more than `enough` [m/s], or where many attempts in a row have hardly changed that. Gives the
/// number of turns.
pub(crate) fn solve<const D: usize>(
    rows: &mut [Row<D>],
    spread: &Spread,
    inverse_mass: &[[f64; D]],
    coupled: &mut Coupled<D>,
    v: &mut [[f64; D]],
    Aim { enough, sweeps }: Aim,
) -> usize {
    if rows.iter().all(|row| count_of(row) == 0) {
        return 0;
    }
    let mut equations = Equations::new(rows, spread, inverse_mass, coupled, v);
    let old = equations.center.clone();
    let mut impulses = old.clone();
    let (mut turns, mut best, mut in_vain, mut ended) = (0, f64::INFINITY, 0, true);
    loop {
        let mut velocities = equations.by_impulses(&impulses);
        velocities.iter_mut().zip(&equations.free).for_each(|(u, free)| *u += free);
        turns += equations.contacts.len();
        let change = equations.sweep(&mut impulses, &mut velocities, false);
        in_vain = if change < 0.5 * best { 0 } else { in_vain + 1 };
        best = change.smaller(best);
        if change <= enough || in_vain > MOST_IN_VAIN {
            break;
        }
        if let Some(most) = sweeps {
            for sweep in 1..most {
                turns += equations.contacts.len();
                if equations.sweep(&mut impulses, &mut velocities, sweep % 2 == 1) <= enough {
                    break;
                }
            }
            break;
        }
        // Where Newton's method has ended, sweeps would only disturb what it has found.
        for sweep in 1..if ended { 1 } else { SWEEPS } {
            turns += equations.contacts.len();
            equations.sweep(&mut impulses, &mut velocities, sweep % 2 == 1);
        }
        ended = equations.improve(&mut impulses, ENOUGH * enough);
        let factor = if ended { LOOSER } else { FIRMER };
        equations.proximal = (factor * equations.proximal).larger(LEAST_PROXIMAL).smaller(MOST_PROXIMAL);
    }
    for contact in &equations.contacts {
        let unknowns = contact.first..contact.first + contact.count;
        let sum = |of: &[f64]| {
            contact.axes.iter().zip(&of[unknowns.clone()]).fold([0.0; D], |sum, (axis, x)| add(&sum, &scaled(axis, *x)))
        };
        let (from, to) = (sum(&old), sum(&impulses));
        let row = &mut rows[contact.row];
        coupled.give(row.on(spread), &subtract(&to, &from), inverse_mass, v);
        row.normal_impulse = impulses[contact.first];
        row.friction_impulse = subtract(&to, &scaled(&row.normal, row.normal_impulse));
    }
    turns
}

impl<const D: usize> Equations<D> {
    fn new(rows: &[Row<D>], spread: &Spread, inverse_mass: &[[f64; D]], coupled: &Coupled<D>, v: &[[f64; D]]) -> Self {
        let (mut contacts, mut size) = (Vec::new(), 0);
        for (number, row) in rows.iter().enumerate().filter(|(_, row)| row.mass[0] > 0.0) {
            let mut axes = [row.normal; D];
            axes.iter_mut().skip(1).zip(across(&row.normal)).for_each(|(axis, across)| *axis = across);
            let count = count_of(row);
            contacts.push(Contact { row: number, axes, first: size, count, friction: row.friction, mass: row.mass });
            size += count;
        }
        let stride = size.next_multiple_of(WIDTH);
        let (mut mobility, mut moved) = (vec![0.0; size * stride], vec![[0.0; D]; v.len()]);
        let (mut center, mut free, mut diagonal) = (Vec::new(), Vec::new(), Vec::new());
        for contact in &contacts {
            let row = &rows[contact.row];
            let (impulse, u) = (row.impulse(), subtract(&row.mean(spread, v), &row.carry));
            for (k, axis) in contact.axes[..contact.count].iter().enumerate() {
                coupled.add_answer(row.on(spread), axis, inverse_mass, &mut moved);
                let line = &mut mobility[(contact.first + k) * stride..][..size];
                for other in &contacts {
                    let velocity = rows[other.row].mean(spread, &moved);
                    let own = &mut line[other.first..other.first + other.count];
                    own.iter_mut().zip(&other.axes).for_each(|(entry, axis)| *entry = dot(axis, &velocity));
                }
                coupled.clear_answer(row.on(spread), &mut moved);
                center.push(dot(&impulse, axis));
                diagonal.push(1.0 / contact.mass[usize::from(k > 0)]);
                free.push(dot(&u, axis) - if k == 0 { row.target } else { 0.0 });
            }
        }
        let mut equations = Equations { contacts, mobility, stride, free, center, diagonal, proximal: LEAST_PROXIMAL };
        let by_impulses = equations.by_impulses(&equations.center);
        equations.free.iter_mut().zip(&by_impulses).for_each(|(free, given)| *free -= given);
        equations
    }

    /// One turn of every contact: the normal impulse that its bound needs, then the friction that this allows. Velocities are those without what holds
    /// changes back. Gives by how much one of them changed, at most [m/s].
    fn sweep(&self, impulses: &mut [f64], u: &mut [f64], back: bool) -> f64 {
        let change = |k: usize, by: f64, impulses: &mut [f64], u: &mut [f64]| {
            if by != 0.0 {
                impulses[k] += by;
                Simd::best().run(Add { from: &self.mobility[k * self.stride..][..self.stride], factor: by, to: u });
            }
        };
        let mut largest: f64 = 0.0;
        for k in 0..self.contacts.len() {
            let Contact { first, count, friction, mass: [along, across], .. } =
                self.contacts[if back { self.contacts.len() - 1 - k } else { k }];
            let normal = impulses[first];
            let by = (normal - along * u[first]).larger(0.0) - normal;
            change(first, by, impulses, u);
            largest = (by / along).abs().larger(largest);
            if count == 1 || normal <= 0.0 && impulses[first] <= 0.0 {
                continue;
            }
            let mut after = [0.0; D];
            for k in 1..count {
                after[k] = impulses[first + k] - across * u[first + k];
            }
            let (size, most) = (dot(&after, &after).sqrt(), friction * impulses[first]);
            let part = if size > most { most / size } else { 1.0 };
            let mut square = 0.0;
            for k in 1..count {
                let by = part * after[k] - impulses[first + k];
                square += by * by;
                change(first + k, by, impulses, u);
            }
            largest = (square.sqrt() / across).larger(largest);
        }
        largest
    }

    /// Newton's method with changes counted from some impulses, which become those that miss least. Says whether it ended.
    fn improve(&mut self, impulses: &mut Vec<f64>, enough: f64) -> bool {
        self.center.clone_from(impulses);
        let mut trial = self.trial(impulses.clone(), self.velocities(impulses));
        let before = square(&trial.missed);
        let (mut best, mut uphill) = (before, 0);
        for _ in 0..MOST_ITERATIONS {
            if best < ROUNDING * before || trial.missed.iter().all(|missed| missed.abs() <= enough) {
                return true;
            }
            let Some(correction) = self.correction(&trial) else { return false };
            let rises;
            (trial, rises) = self.search(&trial, &correction);
            uphill += usize::from(rises);
            let size = square(&trial.missed);
            if size < best {
                best = size;
                impulses.clone_from(&trial.impulses);
            }
            if uphill > MOST_UPHILL {
                break;
            }
        }
        false
    }

    /// W λ, by symmetry, filled up to whole packs.
    fn by_impulses(&self, impulses: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.stride];
        for (line, impulse) in self.mobility.chunks_exact(self.stride).zip(impulses).filter(|(_, x)| **x != 0.0) {
            Simd::best().run(Add { from: line, factor: *impulse, to: &mut out });
        }
        out
    }

    /// The velocities at impulses, less the targets and with what holds changes back [m/s].
    fn velocities(&self, impulses: &[f64]) -> Vec<f64> {
        let mut out = self.by_changes(impulses);
        for (at, (u, free)) in out.iter_mut().zip(&self.free).enumerate() {
            *u += free - self.proximal * self.diagonal[at] * self.center[at];
        }
        out
    }

    /// How velocities change with impulses, what holds changes back included.
    fn by_changes(&self, impulses: &[f64]) -> Vec<f64> {
        let mut out = self.by_impulses(impulses);
        out.iter_mut()
            .zip(&self.diagonal)
            .zip(impulses)
            .for_each(|((u, diagonal), x)| *u += self.proximal * diagonal * x);
        out
    }

    /// What a contact does, and what it misses [m/s].
    fn case(&self, contact: &Contact<D>, impulses: &[f64], u: &[f64]) -> (Case<D>, [f64; D]) {
        let range = contact.first..contact.first + contact.count;
        let (own, u) = (&impulses[range.clone()], &u[range]);
        let [along, across] = contact.mass;
        let mut missed = [0.0; D];
        let presses = own[0] - along * u[0];
        if presses <= 0.0 {
            for k in 0..contact.count {
                missed[k] = own[k] / contact.mass[usize::from(k > 0)];
            }
            return (Case::Apart, missed);
        }
        missed[0] = u[0];
        let mut wanted = [0.0; D];
        for k in 1..contact.count {
            wanted[k] = own[k] - across * u[k];
        }
        let (size, most) = (dot(&wanted, &wanted).sqrt(), contact.friction * presses);
        if size <= most {
            missed[1..contact.count].copy_from_slice(&u[1..]);
            return (Case::Sticks, missed);
        }
        for k in 1..contact.count {
            missed[k] = (own[k] - wanted[k] * (most / size)) / across;
        }
        (Case::Slides(scaled(&wanted, 1.0 / size), most / size), missed)
    }

    fn trial(&self, impulses: Vec<f64>, velocities: Vec<f64>) -> Trial {
        let mut out = vec![0.0; impulses.len()];
        for contact in &self.contacts {
            let (_, missed) = self.case(contact, &impulses, &velocities);
            out[contact.first..contact.first + contact.count].copy_from_slice(&missed[..contact.count]);
        }
        Trial { impulses, velocities, missed: out }
    }

    /// Newton's correction of the impulses; none where its equations have no solution.
    fn correction(&self, Trial { impulses, velocities: u, missed }: &Trial) -> Option<Vec<f64>> {
        let mut out = vec![0.0; impulses.len()];
        let mut present = Vec::new();
        for contact in &self.contacts {
            match self.case(contact, impulses, u).0 {
                // What is apart loses its impulse.
                Case::Apart => {
                    for k in contact.first..contact.first + contact.count {
                        out[k] = -impulses[k];
                    }
                }
                case => present.push((contact, case)),
            }
        }
        let lost = self.by_impulses(&out);
        let unknowns: Vec<usize> =
            present.iter().flat_map(|(contact, _)| contact.first..contact.first + contact.count).collect();
        let size = unknowns.len();
        let stride = (size + 1).next_multiple_of(WIDTH);
        let mut matrix = vec![0.0; size * stride];
        let mut lines = matrix.chunks_exact_mut(stride);
        for (contact, case) in &present {
            // Rows of W, with what holds changes back, and the velocity that is lost at the end.
            let line_of = |k: usize, line: &mut [f64]| {
                let from = &self.mobility[(contact.first + k) * self.stride..][..self.stride];
                line.iter_mut().zip(&unknowns).for_each(|(to, column)| *to = from[*column]);
                line[size] = lost[contact.first + k];
            };
            let own = unknowns.partition_point(|k| *k < contact.first);
            let resistance = |k: usize| self.proximal * self.diagonal[contact.first + k];
            let normal = lines.next()?;
            line_of(0, normal);
            normal[own] += resistance(0);
            let normal = &*normal;
            let mut of_axes: [Vec<f64>; D] = std::array::from_fn(|_| Vec::new());
            for k in 1..contact.count {
                of_axes[k].resize(stride, 0.0);
                line_of(k, &mut of_axes[k]);
                of_axes[k][own + k] += resistance(k);
            }
            for k in 1..contact.count {
                let line = lines.next()?;
                let Case::Slides(direction, part) = case else {
                    line.copy_from_slice(&of_axes[k]);
                    continue;
                };
                // F − µ a d with a = N − ρ uₙ and d the direction of F − r uₜ, over r.
                let [along, across] = contact.mass;
                let by_normal = contact.friction * direction[k];
                Simd::best().run(Add { from: normal, factor: by_normal * along / across, to: line });
                line[own] -= by_normal / across;
                for l in 1..contact.count {
                    let turned = part * (f64::from(u8::from(k == l)) - direction[k] * direction[l]);
                    Simd::best().run(Add { from: &of_axes[l], factor: turned, to: line });
                    line[own + l] += (f64::from(u8::from(k == l)) - turned) / across;
                }
            }
        }
        for (k, line) in unknowns.iter().zip(matrix.chunks_exact_mut(stride)) {
            line[size] = -missed[*k] - line[size];
        }
        if !Simd::best().run(Eliminate { matrix: &mut matrix, size, stride }) {
            return None;
        }
        for (k, line) in unknowns.iter().zip(matrix.chunks_exact(stride)) {
            out[*k] = line[size];
        }
        out.iter().all(|x| x.is_finite()).then_some(out)
    }

    /// The impulses along a correction that miss less, halving it; where none does, a tenth of it, and what they miss rises.
    fn search(&self, from: &Trial, correction: &[f64]) -> (Trial, bool) {
        let change = self.by_changes(correction);
        let along = |x: &[f64], c: &[f64], part: f64| x.iter().zip(c).map(|(x, c)| x + part * c).collect();
        let at =
            |part: f64| self.trial(along(&from.impulses, correction, part), along(&from.velocities, &change, part));
        let (now, mut part) = (square(&from.missed), 1.0);
        for _ in 0..MOST_HALVINGS {
            let trial = at(part);
            if square(&trial.missed) < (1.0 - 1e-4 * part) * now {
                return (trial, false);
            }
            part *= 0.5;
        }
        (at(UPHILL), true)
    }
}

fn square(of: &[f64]) -> f64 {
    of.iter().map(|x| x * x).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A contact of two points, with an impulse of 1 N s.
    fn contact(points: [u32; 2], friction: f64, inverse_mass: &[[f64; 3]]) -> Row<3> {
        let mut row = Row {
            id: 0,
            points: [points[0], points[1], 0, 0],
            weights: [1.0, -1.0, 0.0, 0.0],
            spread: [0; 2],
            normal: [0.0, 0.0, 1.0],
            gap: 0.0,
            target: 0.0,
            carry: [0.0; 3],
            friction,
            mass: [0.0; 2],
            normal_impulse: 1.0,
            friction_impulse: [0.0; 3],
            of_obstacle: false,
            coupled: true,
        };
        row.weigh(&Spread::default(), inverse_mass);
        row
    }

    /// Points of 1 kg one above the other on one that is held, with two equal contacts between each two: what each of them carries has no
    /// unique answer.
    fn column(points: usize, friction: f64) -> (Vec<Row<3>>, Vec<[f64; 3]>) {
        let mut inverse_mass = vec![[1.0; 3]; points];
        inverse_mass[0] = [0.0; 3];
        let row = |k: usize| contact([(k / 2) as u32 + 1, (k / 2) as u32], friction, &inverse_mass);
        ((0..2 * (points - 1)).map(row).collect(), inverse_mass)
    }

    fn solved(rows: &mut [Row<3>], inverse_mass: &[[f64; 3]], v: &mut [[f64; 3]]) {
        for _ in 0..3 {
            solve(
                rows,
                &Spread::default(),
                inverse_mass,
                &mut Coupled::default(),
                v,
                Aim { enough: 1e-12, sweeps: None },
            );
        }
    }

    #[test]
    fn contacts_that_are_redundant_stop_a_column_and_stick() {
        let (mut rows, inverse_mass) = column(8, 0.5);
        let mut v = vec![[0.01, -0.02, -1.0]; 8];
        v[0] = [0.0; 3];
        solved(&mut rows, &inverse_mass, &mut v);
        assert!(v.iter().flatten().all(|v| v.abs() < 1e-9), "{v:?}");
        // The lowest two carry all seven points, which had two impulses of 1 N s from above and below.
        let carried: f64 = rows[..2].iter().map(|row| row.normal_impulse).sum();
        assert!((carried - 2.0 - 7.0).abs() < 1e-9, "{carried}");
    }

    #[test]
    fn contacts_that_slide_have_the_whole_friction_against_their_motion() {
        let (mut rows, inverse_mass) = column(2, 0.3);
        let mut v = vec![[0.0; 3], [3.0, 4.0, -1.0]];
        solved(&mut rows, &inverse_mass, &mut v);
        // 2 N s were there, and 1 N s stops the fall: 0.3 · 3 N s slow the point down along its motion.
        let speed = 5.0 - 0.9;
        let expected = [0.6 * speed, 0.8 * speed, 0.0];
        assert!(v[1].iter().zip(expected).all(|(v, e)| (v - e).abs() < 1e-9), "{v:?}");
    }

    #[test]
    fn contacts_that_part_have_no_impulse() {
        let (mut rows, inverse_mass) = column(2, 0.3);
        let mut v = vec![[0.0; 3], [1.0, 0.0, 5.0]];
        solved(&mut rows, &inverse_mass, &mut v);
        assert!(rows.iter().all(|row| row.impulse() == [0.0; 3]), "{rows:?}");
        // What the two impulses gave is taken back.
        assert!((v[1][2] - 3.0).abs() < 1e-12 && v[1][0] == 1.0, "{v:?}");
    }
}
