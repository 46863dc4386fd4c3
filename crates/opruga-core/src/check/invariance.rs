//! Checks that a rigid motion does not change the energy and only rotates the forces, and that net force and net torque are
//! zero.

use super::Suite;
use super::case::{Answer, by_node, difference, largest, mean_edge};
use super::derivatives::Assembled;
use super::random::{Random, dot, rotation, skew, times};
use crate::potential::{Definiteness, Potential, Views};
use crate::state::Columns;
use opruga_math::{Simd, sum_in_fixed_order};

impl<const D: usize> Suite<'_, D> {
    pub(super) fn invariance(
        &self,
        random: &mut Random,
        potential: &dyn Potential<D>,
        views: Views,
        add: &mut dyn FnMut(&'static str, f64, f64),
    ) -> Answer<()> {
        let best = Simd::best();
        let body = &self.bodies[0];
        let nodes = body.x.len();
        let extent = mean_edge(self.mesh) * nodes as f64;
        let mut case = self.case(potential, body);
        let (force, _) = case.plain(best)?;
        let flat: Vec<f64> = force.iter().flatten().copied().collect();
        let energy = sum_in_fixed_order(&case.energy(best)?);
        // Differences of energies are relative to the work of the largest force along a mean edge, unless the energy itself is
        // larger.
        let scale = largest(&flat) * mean_edge(self.mesh);

        // The body is displaced, and rotated about the first node together with its velocities.
        let shift: [f64; D] = random.vector::<D>().map(|c| c * extent);
        let turn = rotation::<D>(random);
        let center = body.x[0];
        let mut moved = body.clone();
        let mut turned = body.clone();
        for node in 0..nodes {
            let from_center: [f64; D] = core::array::from_fn(|d| body.x[node][d] - center[d]);
            let around = times(&turn, &from_center);
            for d in 0..D {
                moved.x[node][d] += shift[d];
                turned.x[node][d] = center[d] + around[d];
            }
            turned.v[node] = times(&turn, &body.v[node]);
        }
        for (quantity, state, turn) in [("translation", moved, None), ("rotation", turned, Some(turn))] {
            let mut case = self.case(potential, &state);
            let (other, _) = case.plain(best)?;
            let same = sum_in_fixed_order(&case.energy(best)?);
            let expected: Vec<f64> = force.iter().flat_map(|f| turn.map_or(*f, |q| times(&q, f))).collect();
            let other: Vec<f64> = other.into_iter().flatten().collect();
            let error = difference(&other, &expected, 1e-300);
            add(quantity, error, 1e-9);
            if views.energy {
                add(quantity, difference(&[same], &[energy], scale), 1e-10);
            }
        }

        // Net force and torque about the first node, relative to the sum of their terms.
        let (mut net, mut torque) = ([0.0; D], [[0.0; D]; D]);
        let (mut strength, mut moment) = (0.0, 0.0);
        for node in 0..nodes {
            let arm: [f64; D] = core::array::from_fn(|d| body.x[node][d] - center[d]);
            let f = &force[node];
            strength += dot(f, f).sqrt();
            moment += (dot(f, f) * dot(&arm, &arm)).sqrt();
            for i in 0..D {
                net[i] += f[i];
                for j in 0..D {
                    torque[i][j] += arm[i] * f[j] - arm[j] * f[i];
                }
            }
        }
        add("net force", difference(&net, &[0.0; D], strength), 1e-13);
        add("net torque", difference(torque.as_flattened(), &vec![0.0; D * D], moment), 1e-13);

        // H Ω(x − x₀) = Ω ∇U.
        if views.hessian && self.options.derivatives {
            let still = body.still();
            let mut case = self.case(potential, &still);
            let (force, _) = case.plain(best)?;
            let omega = skew::<D>(random);
            let index_count = case.index_count();
            let (mut along, mut out) = (Columns::<D>::zeros(index_count), Columns::<D>::zeros(index_count));
            for node in 0..nodes {
                let arm: [f64; D] = core::array::from_fn(|d| body.x[node][d] - center[d]);
                along.set(node, times(&omega, &arm));
            }
            let mut columns = out.0.each_mut().map(|c| &mut **c);
            potential.add_hessian_product(&case.view(), &case.scratch, &along.slices(), &mut columns);
            let product: Vec<f64> = by_node(&out, case.layout, nodes, 0).into_iter().flatten().collect();
            let expected: Vec<f64> = force.iter().flat_map(|f| times(&omega, &f.map(|c| -c))).collect();
            let terms = largest(&Assembled::of(&case, Definiteness::Exact)) * largest(along.0.iter().flatten());
            add("infinitesimal rotation", difference(&product, &expected, terms), 1e-12);
        }
        Ok(())
    }
}
