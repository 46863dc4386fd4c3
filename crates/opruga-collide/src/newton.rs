//! The impulses of all contacts of coupled bodies at once, by a semismooth Newton method.
//!
//! ```text
//! motion    u = free + W λ                         W = G Y Gᵀ, the velocities of gaps by impulses
//! pressing  N = max(0, a),  a = N − ρ (uₙ − target)
//! friction  F = the point of the disc |F| ≤ µ max(0, a) that is nearest to b = F − r uₜ
//! ```
//!
//! G maps the velocities of points to the velocities u of gaps, and Y contains the responses of the bodies to impulses (see [`Coupled`]). N and F are
//! the impulses along and across a normal, and ρ and r are the inverse mobilities of the contact in these directions. A contact that is apart (a ≤ 0)
//! has no impulse, one that sticks (|b| ≤ µ a) does not move, and one that slides has the full friction along b. The residuals of these laws are
//! linear except at the borders between the cases. Newton's method therefore converges even if sweeps let contacts alternate between sticking and
//! sliding. Contacts are redundant, so W has no inverse. A fraction of its diagonal is added, which acts on the change of the impulses and makes the
//! solution unique (a proximal point). The next attempt removes the error of this term. It uses a smaller fraction if the present attempt has
//! converged, and a larger one if not.
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

/// The largest number of unknowns. An elimination needs ⅓ n³ products for n unknowns. For this many unknowns, it needs 0.2 · 10⁹ products, as many as
/// a hundred sweeps need for bodies with as many points.
pub(crate) const MOST_UNKNOWNS: usize = 900;

/// Limits for the fraction of the diagonal of W that restrains changes of impulses: its initial value, which is also the smallest, and its largest
/// value. The fraction is increased if Newton's method did not converge, which makes the problem easier. It is decreased if Newton's method did
/// converge, so that the next impulses are closer to the solution. With a constant fraction, `a_cube_of_space_comes_to_its_balance_on_a_slab` does
/// not converge.
const LEAST_PROXIMAL: f64 = 1e-7;
const MOST_PROXIMAL: f64 = 1.0;
const FIRMER: f64 = 10.0;
const LOOSER: f64 = 0.03;

/// The number of sweeps between attempts with Newton's method. Sweeps determine which contacts stick and slide; sweeps alone do not converge.
const SWEEPS: usize = 10;

/// The largest number of consecutive attempts that do not halve the change of a sweep.
const MOST_IN_VAIN: usize = 10;

/// The largest number of iterations of one attempt, and the largest number of those that increase the residual.
const MOST_ITERATIONS: usize = 30;
const MOST_UPHILL: usize = 1;

/// The largest number of halvings of a correction. If none of them reduces the residual, a tenth of the correction is taken.
/// Cases then change, and the residual may rise temporarily.
const MOST_HALVINGS: usize = 12;
const UPHILL: f64 = 0.1;

/// The fraction of the tolerance to which Newton's method solves, so that the following sweep finds nothing to change. Also the fraction of the
/// initial squared residual below which the residual is rounding.
const ENOUGH: f64 = 0.1;
const ROUNDING: f64 = 1e-12;

/// A contact and its unknowns: the impulse along its normal and, if it has friction, those across it.
struct Contact<const D: usize> {
    row: usize,
    axes: [[f64; D]; D],
    first: usize,
    count: usize,
    friction: f64,
    /// The inverses of the mobilities along and across the normal [kg].
    mass: [f64; 2],
}

/// The case of a contact at a trial.
enum Case<const D: usize> {
    Apart,
    Sticks,
    /// It slides along this direction. The number is the ratio of the radius of the disc to the length of b.
    Slides([f64; D], f64),
}

struct Equations<const D: usize> {
    contacts: Vec<Contact<D>>,
    /// The matrix W of all unknowns, in rows of `stride` numbers.
    mobility: Vec<f64>,
    stride: usize,
    /// Velocities without impulses, relative to the targets [m/s].
    free: Vec<f64>,
    /// The impulses from which changes are counted [N s], the diagonal of W [1/kg], and the fraction of this diagonal that restrains the changes.
    center: Vec<f64>,
    diagonal: Vec<f64>,
    proximal: f64,
}

/// Impulses, their velocities, and the residuals.
struct Trial {
    impulses: Vec<f64>,
    /// Velocities relative to the targets, including the restraining term [m/s].
    velocities: Vec<f64>,
    /// The residuals of the laws of the contacts [m/s].
    missed: Vec<f64>,
}

/// The number of unknowns of a contact.
pub(crate) fn count_of<const D: usize>(row: &Row<D>) -> usize {
    match row.mass[0] > 0.0 {
        true if row.friction > 0.0 => D,
        moves => usize::from(moves),
    }
}

/// The required accuracy of a solution.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Aim {
    /// The largest change of velocity that a turn of a contact may make at the end [m/s].
    pub(crate) enough: f64,
    /// What follows if the first sweep has not converged: at most this number of sweeps in all or, if there is no number,
    /// Newton's method.
    pub(crate) sweeps: Option<usize>,
}

/// Finds the impulses with which all contacts obey their laws. Uses sweeps over all contacts, and Newton's method if sweeps
/// have not converged. Ends when no turn of a contact changes its velocity by more than `enough` [m/s], or when many
/// consecutive attempts have hardly reduced this change. Returns the number of turns.
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
        // If Newton's method has converged, sweeps would only disturb its result.
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

    /// Takes one turn of every contact: sets the normal impulse that its bound requires, then the friction that this impulse
    /// allows. Velocities do not include the restraining term. Returns the largest change of a velocity [m/s].
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

    /// Runs Newton's method. Changes are counted from the given impulses, which are then replaced by the impulses with the smallest residual. Returns
    /// whether it converged.
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

    /// W λ, using symmetry, padded to whole packs.
    fn by_impulses(&self, impulses: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.stride];
        for (line, impulse) in self.mobility.chunks_exact(self.stride).zip(impulses).filter(|(_, x)| **x != 0.0) {
            Simd::best().run(Add { from: line, factor: *impulse, to: &mut out });
        }
        out
    }

    /// The velocities due to impulses, relative to the targets and including the restraining term [m/s].
    fn velocities(&self, impulses: &[f64]) -> Vec<f64> {
        let mut out = self.by_changes(impulses);
        for (at, (u, free)) in out.iter_mut().zip(&self.free).enumerate() {
            *u += free - self.proximal * self.diagonal[at] * self.center[at];
        }
        out
    }

    /// The change of velocities due to a change of impulses, including the restraining term.
    fn by_changes(&self, impulses: &[f64]) -> Vec<f64> {
        let mut out = self.by_impulses(impulses);
        out.iter_mut()
            .zip(&self.diagonal)
            .zip(impulses)
            .for_each(|((u, diagonal), x)| *u += self.proximal * diagonal * x);
        out
    }

    /// The case of a contact, and its residual [m/s].
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

    /// Newton's correction of the impulses; `None` if its equations have no solution.
    fn correction(&self, Trial { impulses, velocities: u, missed }: &Trial) -> Option<Vec<f64>> {
        let mut out = vec![0.0; impulses.len()];
        let mut present = Vec::new();
        for contact in &self.contacts {
            match self.case(contact, impulses, u).0 {
                // A contact that is apart loses its impulse.
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
            // Rows of W, followed by the velocity that is lost because contacts that are apart lose their impulses. The
            // restraining term is added below.
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
                // The derivative of (F − µ a d)/r, with a = N − ρ uₙ and with the direction d of F − r uₜ.
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

    /// Finds impulses along a correction with a smaller residual by halving the correction. If no such impulses are found, takes a tenth of the
    /// correction, which has a larger residual.
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
            pair: u32::MAX,
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

    /// A column of points of 1 kg on a pinned point, with two equal contacts between neighbours. The force can be divided between two such contacts
    /// in more than one way.
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
        // The lowest two contacts carry all seven points, in addition to their previous impulses of 1 N s each.
        let carried: f64 = rows[..2].iter().map(|row| row.normal_impulse).sum();
        assert!((carried - 2.0 - 7.0).abs() < 1e-9, "{carried}");
    }

    #[test]
    fn contacts_that_slide_have_the_whole_friction_against_their_motion() {
        let (mut rows, inverse_mass) = column(2, 0.3);
        let mut v = vec![[0.0; 3], [3.0, 4.0, -1.0]];
        solved(&mut rows, &inverse_mass, &mut v);
        // The two contacts begin with 2 N s, and another 1 N s stops the fall. The friction of 0.3 · 3 N s slows the point down
        // along its motion.
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
        // The effect of the two impulses is undone.
        assert!((v[1][2] - 3.0).abs() < 1e-12 && v[1][0] == 1.0, "{v:?}");
    }
}
