//! One contact, and its turn in a sweep.

use crate::coupled::Coupled;
use crate::spread::{Spread, Weighted};
use crate::surface::Surface;
use crate::vector::{dot, length, scaled, subtract};
use opruga_math::Lane;

/// The bit that marks the key of a row for a point and an obstacle that holds it.
pub(crate) const OBSTACLE_BIT: u64 = 1 << 63;

/// One contact: a lower bound on its normal velocity, and Coulomb friction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row<const D: usize> {
    /// The index of its pair of bodies, and the key of its features. Rows are sorted by both. The index is `u32::MAX` for a point and an obstacle that
    /// holds it.
    pub(crate) pair: u32,
    pub(crate) id: u64,
    pub(crate) points: [u32; 4],
    pub(crate) weights: [f64; 4],
    /// The index in [`Spread`] of the nodes that carry its points, and their number; this number is zero if the contact acts on
    /// its own points.
    pub(crate) spread: [u32; 2],
    pub(crate) normal: [f64; D],
    /// The gap at the start of the step, minus the thickness [m].
    pub(crate) gap: f64,
    /// The smallest normal velocity that it must have at the end [m/s].
    pub(crate) target: f64,
    /// The velocity of an obstacle [m/s]; zero between bodies.
    pub(crate) carry: [f64; D],
    pub(crate) friction: f64,
    /// The effective mass along the normal, and the smallest effective mass across it [kg]; 0 if nothing can move.
    pub(crate) mass: [f64; 2],
    /// Multipliers: the impulse along the normal and that across it [N s].
    pub(crate) normal_impulse: f64,
    pub(crate) friction_impulse: [f64; D],
    /// Whether the second feature is an obstacle.
    pub(crate) of_obstacle: bool,
    /// Whether its points belong to a coupled body ([`Coupled`]).
    pub(crate) coupled: bool,
}

/// The mobility below which a pair counts as immovable, as a fraction of the mobility that it would have if its points moved independently. If
/// obstacles hold all of its points, only a rounding error of about 1e-16 remains. Half-spaces and round obstacles can hold the nodes of bodies with
/// implicit integrators in this way. In contrast, a stiff body of a million nodes, which moves as a whole, has a fraction of 1e-6. The limit was
/// introduced for corners of polylines, which form their own pairs now. No test of contact changes if it is 0.
const IMMOBILE: f64 = 1e-12;

impl<const D: usize> Row<D> {
    pub(crate) fn new(id: u64, (points, weights): ([u32; 4], [f64; 4]), normal: [f64; D], friction: f64) -> Row<D> {
        Row {
            pair: u32::MAX,
            id,
            points,
            weights,
            spread: [0; 2],
            normal,
            gap: 0.0,
            target: 0.0,
            carry: [0.0; D],
            friction,
            mass: [0.0; 2],
            normal_impulse: 0.0,
            friction_impulse: [0.0; D],
            of_obstacle: false,
            coupled: false,
        }
    }

    /// The order of the rows of a step.
    pub(crate) fn sort_key(&self) -> (u32, u64) {
        (self.pair, self.id)
    }

    /// The effective mass of the row along its normal [kg] if its points respond independently; 0 if no point can move.
    pub(crate) fn mass_apart(&self, spread: &Spread, inverse_mass: &[[f64; D]]) -> f64 {
        if !self.coupled || self.mass[0] == 0.0 {
            return self.mass[0];
        }
        let mut apart = *self;
        apart.weigh(spread, inverse_mass);
        apart.mass[0]
    }

    /// Computes its masses; returns whether any of its points can move.
    pub(crate) fn can_move(&mut self, spread: &Spread, inverse_mass: &[[f64; D]]) -> bool {
        self.weigh(spread, inverse_mass);
        self.mass[0] > 0.0
    }

    /// Computes its masses.
    pub(crate) fn weigh(&mut self, spread: &Spread, inverse_mass: &[[f64; D]]) {
        let (points, weights) = self.on(spread);
        let (mut along, mut across) = (0.0, 0.0);
        for (p, w) in points.iter().zip(weights) {
            let (w, m) = (w * w, &inverse_mass[*p as usize]);
            let mut most: f64 = 0.0;
            for d in 0..D {
                along += w * self.normal[d] * self.normal[d] * m[d];
                most = m[d].larger(most);
            }
            across += w * most;
        }
        let inverse = |k: f64| if k > 0.0 { 1.0 / k } else { 0.0 };
        self.mass = [inverse(along), inverse(across)];
    }

    /// Computes its masses if its points are coupled.
    pub(crate) fn weigh_coupled(&mut self, spread: &Spread, coupled: &Coupled<D>, inverse_mass: &[[f64; D]]) {
        let mobility = coupled.mobility(self.on(spread), inverse_mass);
        self.weigh(spread, inverse_mass);
        let free = self.mass.map(|mass| if mass > 0.0 { 1.0 / mass } else { 0.0 });
        // Across the normal, the largest row sum bounds the mobility in any direction.
        let (mut along, mut across) = (0.0, 0.0);
        for (d, row) in mobility.iter().enumerate() {
            along += self.normal[d] * dot(row, &self.normal);
            across = row.iter().map(|c| c.abs()).sum::<f64>().larger(across);
        }
        // If obstacles or pins hold the points, the response is only rounding.
        let inverse = |k: f64, free: f64| if k > IMMOBILE * free { 1.0 / k } else { 0.0 };
        (self.mass, self.coupled) = ([inverse(along, free[0]), inverse(across, free[1])], true);
    }

    /// The friction impulse that stops the sliding of velocity u, as far as the normal impulse allows [N s].
    #[inline(always)]
    fn friction_after(&self, u: &[f64; D], un: f64, normal_impulse: f64) -> [f64; D] {
        let mut after = self.friction_impulse;
        for d in 0..D {
            after[d] -= (u[d] - un * self.normal[d]) * self.mass[1];
        }
        // Impulses of the previous substep may have been along another normal.
        let along = dot(&after, &self.normal);
        for d in 0..D {
            after[d] -= along * self.normal[d];
        }
        let (size, most) = (length(&after), self.friction * normal_impulse);
        if size > most { scaled(&after, most / size) } else { after }
    }

    /// Takes one turn of a row with coupled or carried points, as [`Row::solve`] does for other rows.
    pub(crate) fn solve_coupled(
        &mut self,
        spread: &Spread,
        inverse_mass: &[[f64; D]],
        coupled: &mut Coupled<D>,
        v: &mut [[f64; D]],
    ) -> f64 {
        if self.mass[0] == 0.0 {
            return 0.0;
        }
        let un = dot(&subtract(&self.mean(spread, v), &self.carry), &self.normal);
        let old = self.normal_impulse;
        let new = (old + (self.target - un) * self.mass[0]).larger(0.0);
        let mut changed = ((new - old) / self.mass[0]).abs();
        if new != old {
            coupled.give(self.on(spread), &scaled(&self.normal, new - old), inverse_mass, v);
            self.normal_impulse = new;
        }
        if self.friction > 0.0 && (new > 0.0 || old > 0.0) {
            let u = subtract(&self.mean(spread, v), &self.carry);
            let un = dot(&u, &self.normal);
            let after = self.friction_after(&u, un, new);
            let change = subtract(&after, &self.friction_impulse);
            let largest = length(&change);
            if largest > 0.0 {
                coupled.give(self.on(spread), &change, inverse_mass, v);
                self.friction_impulse = after;
                changed = (largest / self.mass[1]).larger(changed);
            }
        }
        changed
    }

    /// If nodes carry any of its points, distributes the contact over these nodes.
    pub(crate) fn put_into(&mut self, spread: &mut Spread, surface: &Surface<D>) {
        self.spread = spread.put(surface, (&self.points[..=D], &self.weights[..=D]));
    }

    /// The points on which it acts, and their weights.
    #[inline]
    pub(crate) fn on<'a>(&'a self, spread: &'a Spread) -> Weighted<'a> {
        if self.spread[1] == 0 { (&self.points[..=D], &self.weights[..=D]) } else { spread.at(self.spread) }
    }

    /// The entry that represents these points in lists outside the row.
    #[inline]
    pub(crate) fn head(&self) -> [u32; 4] {
        if self.spread[1] == 0 { self.points } else { Spread::head(self.spread) }
    }

    /// Returns Σ wᵢ aᵢ for its points.
    #[inline]
    pub(crate) fn mean(&self, spread: &Spread, of: &[[f64; D]]) -> [f64; D] {
        mean(self.on(spread), of)
    }

    /// Applies an impulse to its points [N s].
    #[inline]
    pub(crate) fn give(&self, spread: &Spread, impulse: &[f64; D], inverse_mass: &[[f64; D]], v: &mut [[f64; D]]) {
        let (points, weights) = self.on(spread);
        for (p, w) in points.iter().zip(weights) {
            let p = *p as usize;
            for d in 0..D {
                v[p][d] += w * impulse[d] * inverse_mass[p][d];
            }
        }
    }

    /// The normal velocity of a row that acts on its own points, given their indices in the list of velocities [m/s].
    #[inline(always)]
    pub(crate) fn normal_velocity(&self, points: &[u32; 4], v: &[[f64; D]]) -> f64 {
        let mut sum = -dot(&self.carry, &self.normal);
        for k in 0..=D {
            sum += self.weights[k] * dot(&v[points[k] as usize], &self.normal);
        }
        sum
    }

    /// Applies an impulse [N s] to the points of such a row.
    #[inline(always)]
    pub(crate) fn push(&self, points: &[u32; 4], impulse: &[f64; D], inverse_mass: &[[f64; D]], v: &mut [[f64; D]]) {
        for k in 0..=D {
            let p = points[k] as usize;
            for d in 0..D {
                v[p][d] += self.weights[k] * impulse[d] * inverse_mass[p][d];
            }
        }
    }

    /// The total impulse [N s].
    pub(crate) fn impulse(&self) -> [f64; D] {
        let mut out = self.friction_impulse;
        for d in 0..D {
            out[d] += self.normal_impulse * self.normal[d];
        }
        out
    }

    /// Takes one turn of a row that acts on its own points, given their indices in the lists. Sets the normal impulse that its bound
    /// requires, then the friction that this impulse allows. Returns the change of its velocity [m/s].
    #[inline(always)]
    pub(crate) fn solve(&mut self, points: &[u32; 4], inverse_mass: &[[f64; D]], v: &mut [[f64; D]]) -> f64 {
        // The velocities and inverse masses of its points (at most D + 1) are read from memory once.
        let (mut own, mut inverse) = ([[0.0; D]; 4], [[0.0; D]; 4]);
        for k in 0..=D {
            let p = points[k] as usize;
            (own[k], inverse[k]) = (v[p], inverse_mass[p]);
        }
        let mean = |own: &[[f64; D]; 4]| {
            let mut sum = [0.0; D];
            for k in 0..=D {
                for d in 0..D {
                    sum[d] += self.weights[k] * own[k][d];
                }
            }
            subtract(&sum, &self.carry)
        };
        let give = |own: &mut [[f64; D]; 4], impulse: &[f64; D]| {
            for k in 0..=D {
                for d in 0..D {
                    own[k][d] += self.weights[k] * impulse[d] * inverse[k][d];
                }
            }
        };
        let mut u = mean(&own);
        let mut un = dot(&u, &self.normal);
        let old = self.normal_impulse;
        let new = (old + (self.target - un) * self.mass[0]).larger(0.0);
        let mut changed = 0.0;
        if new != old {
            give(&mut own, &scaled(&self.normal, new - old));
            changed = ((new - old) / self.mass[0]).abs();
        }
        let mut after = self.friction_impulse;
        if self.friction > 0.0 && (new > 0.0 || old > 0.0) {
            if new != old {
                u = mean(&own);
                un = dot(&u, &self.normal);
            }
            after = self.friction_after(&u, un, new);
            let change = subtract(&after, &self.friction_impulse);
            let largest = dot(&change, &change);
            if largest > 0.0 {
                give(&mut own, &change);
                changed = (largest.sqrt() / self.mass[1]).larger(changed);
            }
        }
        if changed > 0.0 {
            (self.normal_impulse, self.friction_impulse) = (new, after);
            // The first point is written last: a contact with an obstacle has no other points, and its unused entries repeat
            // the first one.
            for k in (0..=D).rev() {
                v[points[k] as usize] = own[k];
            }
        }
        changed
    }
}

/// Returns Σ wᵢ aᵢ for some points.
#[inline]
fn mean<const D: usize>((points, weights): Weighted<'_>, of: &[[f64; D]]) -> [f64; D] {
    let mut sum = [0.0; D];
    for (p, w) in points.iter().zip(weights) {
        let a = &of[*p as usize];
        for d in 0..D {
            sum[d] += w * a[d];
        }
    }
    sum
}
