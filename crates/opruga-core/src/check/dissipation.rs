//! Damping dissipates energy, reports how much, and does not affect rigid motion.

use super::Suite;
use super::case::{Answer, difference, largest};
use super::random::{Random, dot, skew, times};
use crate::potential::Potential;
use opruga_math::{Lane, Simd};

impl<const D: usize> Suite<'_, D> {
    pub(super) fn dissipation(
        &self,
        random: &mut Random,
        potential: &dyn Potential<D>,
        add: &mut dyn FnMut(&'static str, f64, f64),
    ) -> Answer<()> {
        let best = Simd::best();
        let body = &self.bodies[0];
        let nodes = body.x.len();
        let damping = |v: &dyn Fn(usize) -> [f64; D]| -> Answer<(Vec<f64>, f64, f64)> {
            let mut state = body.clone();
            let rest = self.case(potential, &body.still()).plain(best)?.0;
            for (node, entry) in state.v.iter_mut().enumerate() {
                *entry = v(node);
            }
            let (force, power) = self.case(potential, &state).plain(best)?;
            let mut drag = Vec::new();
            let mut work = 0.0;
            for node in 0..nodes {
                let own: [f64; D] = core::array::from_fn(|d| force[node][d] - rest[node][d]);
                work -= dot(&own, &state.v[node]);
                drag.extend(own);
            }
            Ok((drag, power, work))
        };
        let (random_drag, power, work) = damping(&|node| body.v[node])?;
        // Forces at rest are subtracted, but their rounding remains.
        let rest = self.case(potential, &body.still()).plain(best)?.0;
        let rounding = 1e-4 * largest(rest.iter().flatten());
        let scale = Lane::larger(largest(&random_drag), rounding);
        let speeds = largest(body.v.iter().flatten()) * nodes as f64;
        add("power", difference(&[power], &[work], Lane::larger(power.abs(), rounding * speeds)), 1e-9);
        add("power", if power >= 0.0 { 0.0 } else { 1.0 }, 0.0);
        if self.options.rigid {
            // A rigid motion as fast as the random one: v₀ + ω × (x − x₀).
            let (omega, speed) = (skew::<D>(random), largest(body.v.iter().flatten()));
            let start: [f64; D] = random.vector();
            let arms = |node: usize| -> [f64; D] { core::array::from_fn(|d| body.x[node][d] - body.x[0][d]) };
            let reach = largest((0..nodes).map(arms).collect::<Vec<_>>().iter().flatten());
            let rigid = |node: usize| -> [f64; D] {
                let turning = times(&omega, &arms(node));
                core::array::from_fn(|d| speed * (start[d] + turning[d] / reach))
            };
            let (drag, power, _) = damping(&rigid)?;
            add("rigid motion", largest(&drag) / scale, 1e-11);
            add("rigid motion", power.abs() / (scale * speed), 1e-11);
        }
        Ok(())
    }
}
