//! The derivatives of contact forces with respect to the positions of their nodes.

use super::contact::{Contact, Contacting, SMALL, dot};
use super::contact_query::ContactQuery;
use opruga_solve::blocks::{Block, isotropic};

/// If a direction of friction turns by less than this in an iteration, the next iteration uses the derivative of the
/// direction.
const FOLLOWED: f64 = 0.1;

/// The direction of a slide is always used if the slide is longer than this fraction of the extent.
const SLIDING: f64 = 1e-4;

/// For differences, a surface is evaluated at this distance from a node, as a fraction of the extent of the body.
const BESIDE: f64 = 1e-5;

impl<const D: usize> ContactQuery<'_, D> {
    /// Returns ∂n/∂x along the surface, computed from differences.
    fn turn_of_normal(&self, contact: &Contact<D>) -> Option<Block<D>> {
        let obstacles = self.system.contacts.as_ref()?;
        let (at, step) = (contact.node * D, BESIDE * self.extent);
        let from: [f64; D] = core::array::from_fn(|d| self.x0[at + d]);
        let mut turn = isotropic::<D>(0.0);
        for axis in 0..D {
            let mut unit = [0.0; D];
            unit[axis] = 1.0;
            let aside = contact.along(&unit);
            let to: [f64; D] = core::array::from_fn(|d| from[d] + self.u[at + d] / self.theta + step * aside[d]);
            let mut beside = None;
            obstacles.touch(&from, &to, self.system.time + self.h, self.h, 0.1 * self.extent, &mut |touch| {
                if touch.surface == contact.touch.surface {
                    beside = Some(touch.normal);
                }
            });
            let beside = beside?;
            let difference: [f64; D] = core::array::from_fn(|d| beside[d] - contact.touch.normal[d]);
            // Each row holds the derivative along one axis, and only its part along the surface.
            turn[axis] = contact.along(&difference.map(|x| x / step));
        }
        let half = |i: usize, j: usize| 0.5 * (turn[i][j] + turn[j][i]);
        Some(core::array::from_fn(|i| core::array::from_fn(|j| half(i, j))))
    }
}

impl<const D: usize> Contacting<D> {
    /// Calls `visit` with the blocks −∂f/∂u of the forces of held contacts. The direction of friction follows the slide w, so
    /// friction contributes µλ/|w| across w. The direction of the constraint follows the surface, so the constraint contributes
    /// −λ ∂n/∂x. If `clamped` is set, only blocks without negative eigenvalues are visited.
    pub(crate) fn derivatives(
        &self,
        contact_query: &ContactQuery<'_, D>,
        clamped: bool,
        visit: &mut dyn FnMut(usize, Block<D>),
    ) {
        for contact in self.contacts.iter().filter(|contact| contact.normal_force > 0.0) {
            let normal = &contact.touch.normal;
            // With a settled direction, this stiffness would only shorten the corrections.
            if contact.rubs() && D > 2 && !self.is_settled {
                let slide = contact.slide(contact_query.u, contact_query.theta, contact_query.x0);
                // A direction of slide that turns by a large angle is not settled yet, so its derivative is not used.
                let size = dot(&slide, &slide).sqrt();
                let strength = contact.touch.friction * contact.normal_force / size;
                if dot(&slide, &contact.push) < 0.0
                    && size > SMALL * contact_query.extent
                    && (contact.turn < FOLLOWED || size > SLIDING * contact_query.extent)
                {
                    let mut block = isotropic::<D>(strength);
                    for i in 0..D {
                        for j in 0..D {
                            block[i][j] -= strength * (normal[i] * normal[j] + contact.push[i] * contact.push[j]);
                        }
                    }
                    visit(contact.node, block);
                }
            }
            if let Some(turn) = contact_query.turn_of_normal(contact) {
                let factor = -contact.normal_force / contact_query.theta;
                let trace: f64 = (0..D).map(|d| turn[d][d]).sum();
                if trace != 0.0 && !(clamped && factor * trace < 0.0) {
                    visit(contact.node, turn.map(|row| row.map(|entry| factor * entry)));
                }
            }
        }
    }
}
