//! The impulses of all active contacts at once, by conjugate gradients between sweeps.
//!
//! A sweep passes an impulse on from contact to contact. For coupled bodies, such as bodies with implicit integrators, a sweep removes only a part of
//! smooth errors, such as the error of a pressure that varies along a side. As long as the same contacts are active, the equations are linear:
//! contacts that press keep their normal velocity, and those that stick do not slide. Their matrix W = G Y Gᵀ is symmetric and has no negative
//! eigenvalues, so conjugate gradients can solve them. Contacts that would pull or begin to slide are removed from the equations, and sweeps decide
//! which of them return. (Silcowitz, Niebe and Erleben 2010, a projected Gauss–Seidel subspace method.)

use crate::coupled::Coupled;
use crate::row::Row;
use crate::spread::Spread;
use crate::vector::{across, add, dot, scaled, subtract};
use core::ops::Range;
use opruga_core::dense::Dense;
use opruga_math::{Lane, Simd, WIDTH, sum_in_fixed_order};

/// The fraction of the initial remaining velocities at which conjugate gradients end. With 1e-3, the errors of the cases
/// `contact-patch-…` of the verification exceed 1e-6.
const LEFT: f64 = 1e-4;

/// An active contact. Its unknowns are the changes of its impulse along its normal and, if it sticks, along the axes
/// perpendicular to it.
struct Active {
    row: usize,
    unknowns: Range<usize>,
}

/// The fractions of a change of the impulse up to which a contact presses, and up to which it sticks; infinite if there is no
/// limit.
fn reach<const D: usize>(row: &Row<D>, sticks: bool, change: &[f64; D]) -> (f64, f64) {
    let more = dot(change, &row.normal);
    let presses = if more < 0.0 { -row.normal_impulse / more } else { f64::INFINITY };
    if !sticks {
        return (presses, f64::INFINITY);
    }
    // |F + s f|² = µ² (N + s n)².
    let slides = subtract(change, &scaled(&row.normal, more));
    let (own, squared) = (row.friction_impulse, row.friction * row.friction);
    let a = dot(&slides, &slides) - squared * more * more;
    let half = dot(&own, &slides) - squared * row.normal_impulse * more;
    let c = dot(&own, &own) - squared * row.normal_impulse * row.normal_impulse;
    // c < 0 inside the cone, which ends at the first root s above zero. If there is no root, the square root is NaN, for which
    // all comparisons are false.
    let root = (half * half - a * c).sqrt();
    let sum = half + if half < 0.0 { -root } else { root };
    let roots = [-sum / a, -c / sum];
    (presses, roots.into_iter().filter(|root| *root > 0.0).fold(f64::INFINITY, f64::smaller))
}

/// The active contacts, and their equations.
struct Subspace<const D: usize> {
    active: Vec<Active>,
    /// The direction of each unknown.
    axes: Vec<[f64; D]>,
    /// The matrix W.
    matrix: Dense,
    /// The remaining velocities [m/s].
    left: Vec<f64>,
    /// Whether each unknown is free; the equations determine only free unknowns.
    is_free: Vec<bool>,
}

/// Finds the impulses with which all pressing contacts keep their normal velocity and no sticking contact slides.
pub(crate) fn step<const D: usize>(
    rows: &mut [Row<D>],
    spread: &Spread,
    inverse_mass: &[[f64; D]],
    coupled: &mut Coupled<D>,
    v: &mut [[f64; D]],
) {
    let mut space = Subspace::new(rows, spread, inverse_mass, coupled, v);
    let mut given = vec![[0.0; D]; space.active.len()];
    while space.is_free.contains(&true) {
        let changes = space.solve();
        let by_row = |active: &Active| {
            active.unknowns.clone().fold([0.0; D], |sum, k| add(&sum, &scaled(&space.axes[k], changes[k])))
        };
        let by_row: Vec<[f64; D]> = space.active.iter().map(by_row).collect();
        let part = space.leave(rows, &by_row);
        let velocities = space.velocities(&changes);
        for (left, velocity) in space.left.iter_mut().zip(&velocities) {
            *left -= part * velocity;
        }
        for ((active, change), given) in space.active.iter().zip(&by_row).zip(&mut given) {
            let (row, change) = (&mut rows[active.row], scaled(change, part));
            let more = dot(&change, &row.normal);
            row.normal_impulse = (row.normal_impulse + more).larger(0.0);
            row.friction_impulse = add(&row.friction_impulse, &subtract(&change, &scaled(&row.normal, more)));
            *given = add(given, &change);
        }
        if part >= 1.0 {
            break;
        }
    }
    for (active, given) in space.active.iter().zip(&given) {
        coupled.give(rows[active.row].on(spread), given, inverse_mass, v);
    }
}

impl<const D: usize> Subspace<D> {
    fn new(
        rows: &[Row<D>],
        spread: &Spread,
        inverse_mass: &[[f64; D]],
        coupled: &Coupled<D>,
        v: &[[f64; D]],
    ) -> Subspace<D> {
        let (mut active, mut axes, mut left) = (Vec::new(), Vec::new(), Vec::new());
        // Contacts of uncoupled bodies converge by sweeps, and there may be thousands.
        let acts = |row: &Row<D>| row.coupled && row.normal_impulse > 0.0 && row.mass[0] > 0.0;
        for (number, row) in rows.iter().enumerate().filter(|(_, row)| acts(row)) {
            let first = axes.len();
            axes.push(row.normal);
            let cone = row.friction * row.normal_impulse;
            if row.friction > 0.0 && dot(&row.friction_impulse, &row.friction_impulse) < cone * cone {
                axes.extend(across(&row.normal));
            }
            let u = subtract(&row.mean(spread, v), &row.carry);
            left.extend(axes[first..].iter().map(|axis| -dot(&u, axis)));
            left[first] += row.target;
            active.push(Active { row: number, unknowns: first..axes.len() });
        }
        let mut entries = Vec::with_capacity(axes.len() * axes.len());
        let mut moved = vec![[0.0; D]; v.len()];
        for Active { row, unknowns } in &active {
            for axis in &axes[unknowns.clone()] {
                moved.fill([0.0; D]);
                coupled.add_answer(rows[*row].on(spread), axis, inverse_mass, &mut moved);
                for Active { row, unknowns } in &active {
                    let velocity = rows[*row].mean(spread, &moved);
                    entries.extend(axes[unknowns.clone()].iter().map(|axis| dot(axis, &velocity)));
                }
            }
        }
        let matrix = Dense::of_lower(axes.len(), |row, column| entries[row * axes.len() + column]);
        Subspace { active, matrix, is_free: vec![true; axes.len()], axes, left }
    }

    /// W x, for vectors of [`Dense::padded`] numbers.
    fn velocities(&self, x: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; x.len()];
        self.matrix.multiply(Simd::best(), x, &mut out);
        out
    }

    /// The changes of the free unknowns, by conjugate gradients [N s].
    fn solve(&self) -> Vec<f64> {
        let (n, length) = (self.axes.len(), self.matrix.padded());
        let free = |k: usize, x: f64| if self.is_free[k] { x } else { 0.0 };
        let mut left: Vec<f64> = self.left.iter().enumerate().map(|(k, left)| free(k, *left)).collect();
        left.resize(length, 0.0);
        let (mut changes, mut direction, mut steepest) = (vec![0.0; length], vec![0.0; length], vec![0.0; length]);
        let (mut size, mut first) = (0.0, None);
        for _ in 0..n {
            (0..n).for_each(|k| steepest[k] = left[k] / self.matrix.at(k, k));
            let next = sum(&left, &steepest);
            if next.is_nan() || next <= LEFT * LEFT * *first.get_or_insert(next) {
                break;
            }
            let again = if size > 0.0 { next / size } else { 0.0 };
            direction.iter_mut().zip(&steepest).for_each(|(d, s)| *d = s + again * *d);
            let velocities = self.velocities(&direction);
            let length = next / sum(&direction, &velocities);
            if !(length > 0.0 && length.is_finite()) {
                break;
            }
            size = next;
            for k in 0..n {
                changes[k] += length * direction[k];
                left[k] -= free(k, length * velocities[k]);
            }
        }
        changes
    }

    /// Returns the fraction of the changes up to which all contacts press and stick. Finds the first contact that ceases to do
    /// so: one that pulls is removed from the equations, and one that slides loses its friction unknowns.
    fn leave(&mut self, rows: &[Row<D>], changes: &[[f64; D]]) -> f64 {
        let (mut part, mut first) = (1.0, None);
        for (active, change) in
            self.active.iter().zip(changes).filter(|(active, _)| self.is_free[active.unknowns.start])
        {
            let sticks = active.unknowns.len() > 1 && self.is_free[active.unknowns.start + 1];
            let (presses, sticks) = reach(&rows[active.row], sticks, change);
            if presses.smaller(sticks) < part {
                part = presses.smaller(sticks);
                first = Some((active.unknowns.clone(), presses <= sticks));
            }
        }
        if let Some((unknowns, pulls)) = first {
            self.is_free[unknowns].iter_mut().skip(usize::from(!pulls)).for_each(|free| *free = false);
        }
        part
    }
}

/// Σ a b of vectors whose length is a multiple of eight, in eight partial sums.
fn sum(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; WIDTH];
    for (a, b) in a.as_chunks::<WIDTH>().0.iter().zip(b.as_chunks::<WIDTH>().0) {
        for l in 0..WIDTH {
            sums[l] += a[l] * b[l];
        }
    }
    sum_in_fixed_order(&sums)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// The contacts of a column of points along y, each with an impulse of 1 N s. The lowest point is pinned.
    pub(crate) fn column(points: usize, friction: f64) -> (Vec<Row<2>>, Vec<[f64; 2]>) {
        let mut inverse_mass = vec![[1.0; 2]; points];
        inverse_mass[0] = [0.0; 2];
        let row = |k: usize| {
            let mut row = Row {
                pair: u32::MAX,
                id: k as u64,
                points: [k as u32 + 1, k as u32, 0, 0],
                weights: [1.0, -1.0, 0.0, 0.0],
                spread: [0; 2],
                normal: [0.0, 1.0],
                gap: 0.0,
                target: 0.0,
                carry: [0.0; 2],
                friction,
                mass: [0.0; 2],
                normal_impulse: 1.0,
                friction_impulse: [0.0; 2],
                of_obstacle: false,
                coupled: true,
            };
            row.weigh(&Spread::default(), &inverse_mass);
            row
        };
        ((0..points - 1).map(row).collect(), inverse_mass)
    }

    #[test]
    fn a_column_that_falls_is_stopped_by_one_step() {
        let (mut rows, inverse_mass) = column(40, 0.5);
        let mut v = vec![[0.01, -1.0]; 40];
        v[0] = [0.0; 2];
        step(&mut rows, &Spread::default(), &inverse_mass, &mut Coupled::default(), &mut v);
        assert!(v.iter().flatten().all(|v| v.abs() < 1e-3), "{v:?}");
        // Each contact carries the points above it, in addition to its previous impulse.
        assert!(rows.iter().enumerate().all(|(k, row)| (row.normal_impulse - 1.0 - (39 - k) as f64).abs() < 0.1));
    }

    #[test]
    fn contacts_that_would_pull_or_slide_leave_the_others_in_balance() {
        let (mut rows, inverse_mass) = column(10, 0.1);
        let mut v = vec![[0.0, -1.0]; 10];
        (v[0], v[5], v[9]) = ([0.0; 2], [40.0, -1.0], [0.0, 30.0]);
        let before = v.clone();
        step(&mut rows, &Spread::default(), &inverse_mass, &mut Coupled::default(), &mut v);
        // The last point leaves, so its contact has no impulse; the point that is fast along x slides.
        assert!(rows[8].normal_impulse == 0.0 && v[9][1] > v[8][1] && v[5][0] > 30.0);
        assert!(rows.iter().all(|row| row.normal_impulse >= 0.0));
        let momentum = |v: &[[f64; 2]]| v[1..].iter().map(|v| v[1]).sum::<f64>();
        assert!((momentum(&v) - momentum(&before) - (rows[0].normal_impulse - 1.0)).abs() < 1e-9);
    }
}
