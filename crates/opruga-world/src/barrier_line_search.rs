//! The line search for bodies that a barrier keeps apart. This search determines how long a correction may be.
//!
//! A correction ends before any pair meets, and the sum of all energies falls along it.

use crate::barrier_search::{Opened, Refused, Search};
use opruga_collide::{Touching, Trouble};
use opruga_math::Lane;
use opruga_solve::dot;

/// The largest fraction of the slope that may remain after a correction. Without this limit, corrections alternate between sticking and sliding,
/// because the energies differ by less than their rounding errors (`what_sticks_on_a_body_does_not_creep`).
const SLOPE_LEFT: f64 = 0.8;

/// If the slope at the end of a whole correction is still more than this fraction of the slope at its beginning, the factor by which the next
/// correction is lengthened doubles, up to `LONGEST_STRETCH`. A matrix without negative eigenvalues is too stiff for bodies that buckle. Without this
/// rule, a square of springs that buckles on landing takes more than 100 iterations (`bodies_that_buckle_find_an_end`).
const STEEP: f64 = 0.3;
const LONGEST_STRETCH: f64 = 16.0;

/// The maximum number of halvings of a correction: a trillionth of a correction counts as none.
const MOST_HALVINGS: u32 = 40;

/// Energies whose difference is below this fraction of their terms count as equal.
const ROUNDING: f64 = 1e-12;

/// The energies on which the length of a correction depends.
struct Energies {
    bodies: Vec<OwnEnergy>,
    /// B + D (see `barrier_search`) [J].
    between: f64,
}

/// The incremental potential of a body.
struct OwnEnergy {
    /// Φ and the size of its terms [J]; `None` with damping or a model without an energy.
    energy: Option<[f64; 2]>,
    /// The slope of Φ, or the work of the residual, along the whole correction [J].
    slope: f64,
}

impl Energies {
    /// Returns the change since the start of a part of a correction, and the size of its terms [J].
    ///
    /// The work of a body that has no potential is the mean of the slopes at both ends. Its forces are smooth. Those of barriers and of friction are
    /// not, so the slopes alone would let corrections alternate between sticking and sliding
    /// (`plates_grip_and_lift_a_block_under_a_barrier`).
    fn change_since(&self, before: &Energies, part: f64) -> [f64; 2] {
        let mut change = [self.between - before.between, self.between + before.between];
        for (after, before) in self.bodies.iter().zip(&before.bodies) {
            let [own, size] = match (before.energy, after.energy) {
                (Some([before, size]), Some([after, other])) => [after - before, size + other],
                _ => [0.5 * part * (before.slope + after.slope), 0.0],
            };
            change = [change[0] + own, change[1] + size];
        }
        change
    }
}

impl<const D: usize> Search<'_, '_, D> {
    /// The slope of the sum of all energies along the correction, minus the work of the obstacles.
    pub(crate) fn slope(&mut self, gradient: &[f64]) -> f64 {
        let mut slope = self.slope_of_obstacles() - self.by_obstacles;
        for open in &mut self.opened {
            let given = open.step.given();
            let range = open.range();
            let between = &gradient[range];
            let residual = open.step.residual().to_vec();
            for (s, (r, g)) in open.step.correction().iter().zip(residual.iter().zip(between)) {
                slope += s * (r + g);
            }
            slope -= given;
        }
        slope
    }

    /// Moves along the correction as far as the pairs allow and as long as the sum of all energies falls. Returns the fraction of the correction that
    /// was applied.
    pub(crate) fn go(&mut self, slope: f64) -> Result<f64, Refused> {
        for (p, of_point) in self.coordinates.iter().enumerate() {
            let from = &self.x[p];
            self.trial[p] = match of_point {
                Some((body, at)) => {
                    let Opened { first, step, .. } = &mut self.opened[*body];
                    let step = step.correction();
                    std::array::from_fn(|d| from[d] + step[at - *first + d])
                }
                None => std::array::from_fn(|d| from[d] + self.ahead[p][d]),
            };
        }
        self.touching.surface.follow(&mut self.trial);
        let far = std::mem::take(&mut self.trial);
        let mut part = self.free_part(&far)?;
        let start = std::mem::take(&mut self.x);
        let moved = self.moved.clone();
        let before = self.energies();
        let given = self.by_obstacles + self.opened.iter_mut().map(|open| open.step.given()).sum::<f64>();
        let rounding: f64 = self.opened.iter().map(|open| open.step.rounding(&self.islands[open.island].system)).sum();
        let between = |part: f64| {
            let at = |(a, b): (&[f64; D], &[f64; D])| std::array::from_fn(|d| a[d] + part * (b[d] - a[d]));
            start.iter().zip(&far).map(at).collect::<Vec<[f64; D]>>()
        };
        let mut gone = 0.0;
        for _ in 0..MOST_HALVINGS {
            self.x = between(part);
            for (p, moved) in moved.iter().enumerate() {
                self.moved[p] = std::array::from_fn(|d| moved[d] + (self.x[p][d] - start[p][d]));
            }
            let allowed = self
                .opened
                .iter_mut()
                .all(|open| open.step.evaluate(&mut self.islands[open.island].system, part).is_ok())
                && self.press().is_ok();
            let mut now = f64::NAN;
            if allowed {
                let gradient = self.gradient();
                now = self.slope(&gradient);
            }
            // If the step is small, the difference between the energies is lost in rounding.
            let [change, size] = if allowed { self.energies().change_since(&before, part) } else { [0.0; 2] };
            let risen = change - part * given > ROUNDING * (size + (part * given).abs()) + rounding;
            if allowed && !risen && now <= SLOPE_LEFT * slope.abs() {
                let steep = part == 1.0 && now < -STEEP * slope.abs();
                self.stretch = if steep { (2.0 * self.stretch).smaller(LONGEST_STRETCH) } else { 1.0 };
                gone = part;
                break;
            }
            let secant = slope.abs() / (slope.abs() + now);
            part *= if secant.is_finite() && !risen { secant.larger(0.1).smaller(0.6) } else { 0.4 };
        }
        if gone == 0.0 {
            self.x = between(0.0);
            self.moved = moved;
        }
        self.trial = far;
        for open in &mut self.opened {
            open.step.advance(gone);
            if gone == 0.0 {
                open.step.evaluate(&mut self.islands[open.island].system, 0.0)?;
            }
        }
        for ahead in self.ahead.iter_mut().flatten() {
            *ahead -= gone * *ahead;
        }
        if gone == 0.0 {
            self.press()?;
        }
        Ok(gone)
    }

    /// The energies in the state that was evaluated last.
    fn energies(&mut self) -> Energies {
        let own = |open: &mut Opened<D>| {
            let energy = open.step.potential(&self.islands[open.island].system);
            let residual = open.step.residual().to_vec();
            OwnEnergy { energy, slope: dot(open.step.correction(), &residual) }
        };
        let bodies = self.opened.iter_mut().map(own).collect();
        let pressed = self.pressed.iter().map(|pair| pair.energy);
        let between = pressed.chain(self.rubbing.iter().map(|rub| rub.energy(&rub.slip(&self.moved)))).sum();
        Energies { bodies, between }
    }

    /// The fraction of the paths to these positions [m] that the points can follow before any pair meets.
    fn free_part(&mut self, far: &[[f64; D]]) -> Result<f64, Refused> {
        let Touching { surface, laws, most, .. } = &*self.touching;
        let mut end = far.to_vec();
        let mut part = 1.0;
        for _ in 0..MOST_HALVINGS {
            match self.barrier.look(surface, laws, [&self.x, &end], *most) {
                Ok(()) => return Ok(part * self.barrier.free_part(surface, laws, [&self.x, &end])),
                // Paths across many bodies have more pairs than the limit allows. Paths of half the length may have few enough.
                Err(Trouble::TooMany) => part *= 0.5,
                Err(trouble) => return Err(trouble.into()),
            }
            for (end, (x, far)) in end.iter_mut().zip(self.x.iter().zip(far)) {
                *end = std::array::from_fn(|d| x[d] + part * (far[d] - x[d]));
            }
        }
        Ok(self.barrier.look(surface, laws, [&self.x, &self.x], *most).map(|()| 0.0)?)
    }

    /// Searches for pairs along the paths that the points would take in a step of h [s].
    pub(crate) fn look_ahead(&mut self, h: f64) -> Result<(), Refused> {
        let Touching { surface, laws, most, before: [x, v], .. } = &*self.touching;
        self.trial.clear();
        self.trial.extend(x.iter().zip(v).map(|(x, v)| std::array::from_fn(|d| x[d] + h * v[d])));
        self.barrier.forget();
        Ok(self.barrier.look(surface, laws, [&self.x, &self.trial], *most)?)
    }

    /// Finds the pairs within reach.
    pub(crate) fn press(&mut self) -> Result<(), Refused> {
        let Touching { surface, laws, .. } = &*self.touching;
        Ok(self.barrier.press(surface, laws, &self.x, &mut self.pressed)?)
    }
}
