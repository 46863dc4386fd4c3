//! The contact forces with which a step in real time begins: the contact forces of the previous step.

use super::contact::{Contacting, Hold, dot, split};
use opruga_math::Lane;

impl<const D: usize> Contacting<D> {
    /// Calls `visit` with the force on every held node [N]: along the normal, plus friction if the node slips.
    pub(super) fn visit_forces(&self, mut visit: impl FnMut(usize, [f64; D])) {
        for contact in self.contacts.iter().filter(|contact| contact.is_active()) {
            let friction = if contact.rubs() { contact.touch.friction } else { 0.0 };
            let direction = |d: usize| contact.touch.normal[d] + friction * contact.push[d];
            visit(contact.node, core::array::from_fn(|d| contact.normal_force * direction(d)));
        }
    }

    /// Assigns the forces of the previous step, as delivered by [`Contacting::visit_forces`], to the contacts that the first
    /// search has found. Slipping contacts keep slipping, and sticking ones keep sticking.
    pub(super) fn start_from(&mut self, force: impl Fn(usize) -> [f64; D]) {
        for contacts in self.contacts.chunk_by_mut(|a, b| a.node == b.node) {
            let force = force(contacts[0].node);
            if force == [0.0; D] {
                continue;
            }
            let normal_forces = split(contacts, &force);
            for (k, contact) in contacts.iter_mut().enumerate().filter(|(_, contact)| contact.is_active()) {
                contact.normal_force = normal_forces[k.min(D - 1)].larger(0.0);
                if contact.touch.friction == 0.0 {
                    continue;
                }
                let friction = contact.along(&force);
                let size = dot(&friction, &friction).sqrt();
                // The recorded tangential force of a node is µ λ if the node slipped, and zero if it stuck.
                if size > 0.5 * contact.touch.friction * contact.normal_force {
                    (contact.hold, contact.push) = (Hold::Slip, friction.map(|f| f / size));
                } else {
                    contact.hold = Hold::Stick;
                }
            }
        }
    }
}
