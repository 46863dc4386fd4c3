//! The forces on the nodes of a body: of models, obstacles and pins.

use crate::world::World;
use opruga_core::contacts::{Contacts, Moved};
use opruga_core::potential::Account;
use opruga_core::state::Columns;
use opruga_integrators::accelerations;
use opruga_math::WIDTH;

impl<const D: usize> World<D> {
    /// The forces of the models of one account on the nodes of a body [N]; none: of all models, gravity included.
    ///
    /// Empty where the body is not there or a model refuses the state.
    pub fn node_forces(&mut self, body: usize, account: Option<Account>) -> Vec<[f64; D]> {
        if self.handle(body).is_none() {
            return Vec::new();
        }
        let (island, lane) = self.place[body];
        let system = &mut self.islands[island].system;
        let forces = match account {
            Some(account) => system.forces_of(account),
            None => system.forces(true),
        };
        let Ok(forces) = forces else { return Vec::new() };
        (0..system.nodes).map(|node| forces.at(system.layout.place(node, lane))).collect()
    }
    /// The nodes of a body that pins hold now, along some of their axes or all.
    pub fn held_nodes(&self, body: usize) -> Vec<u32> {
        if self.handle(body).is_none() {
            return Vec::new();
        }
        let (island, lane) = self.place[body];
        let system = &self.islands[island].system;
        let held: std::collections::BTreeSet<usize> = system.pins.iter().map(|pin| pin.place).collect();
        (0..system.nodes as u32).filter(|node| held.contains(&system.layout.place(*node as usize, lane))).collect()
    }
    /// The forces of contact on the nodes of a body [N]: of obstacles in the coming substep, f = m (v' − v*)/h, and of bodies, and of corners
    /// and edges of obstacles, in the last one, impulse over h.
    ///
    /// v* is the velocity that the forces of now would give a node within h without obstacles, v' the one with them:
    /// normal force, friction, and in an impact the impulse over h. Held nodes feel none; the pin takes it.
    /// Empty where the body is not there, nothing can touch it, or a model refuses the state.
    pub fn contact_forces(&mut self, body: usize) -> Vec<[f64; D]> {
        let mut forces = self.obstacle_forces(body);
        if let Some(clusters) = self.clusters.as_ref().filter(|_| self.handle(body).is_some()) {
            let (h, nodes) = (self.h(), self.node_count(body));
            forces.resize(nodes, [0.0; D]);
            let stride = self.islands[self.place[body].0].system.layout.stride();
            for meeting in clusters.meetings().filter(|meeting| meeting.bodies.contains(&body)) {
                meeting.add_forces(body, h, stride, &mut forces);
            }
        }
        forces
    }

    fn obstacle_forces(&mut self, body: usize) -> Vec<[f64; D]> {
        let Some(colliders) = self.colliders.clone().filter(|_| self.handle(body).is_some()) else { return Vec::new() };
        let (h, time, (island, lane)) = (self.h(), self.time(), self.place[body]);
        let system = &mut self.islands[island].system;
        let Ok(forces) = system.forces(true) else { return Vec::new() };
        let (places, layout) = (system.places(), system.layout);
        let used = system.nodes * layout.stride();
        let (mut x, mut v) = (Columns::zeros(places), Columns::zeros(places));
        for place in 0..used {
            let mass = system.mass.at(place);
            for d in 0..D {
                let now = system.state.v.0[d][place];
                v.0[d][place] = if mass > 0.0 { now + h * forces.0[d][place] / mass } else { now };
                x.0[d][place] = system.state.x.0[d][place] + h * v.0[d][place];
            }
        }
        let free = v.clone();
        let [mut normal, mut friction, mut work, mut correction] = [[0.0; WIDTH]; 4];
        colliders.resolve(
            system.simd,
            &mut Moved {
                range: 0..places,
                places_used: used,
                before: system.state.x.0.each_ref().map(|column| &**column),
                x: &mut x,
                v: &mut v,
                force: forces.0.each_ref().map(|column| &**column),
                mass: &system.mass,
                layout,
                time: time + h,
                h,
                loss_contact: &mut normal,
                loss_friction: &mut friction,
                work_colliders: &mut work,
                work_correction: &mut correction,
            },
        );
        let held: std::collections::BTreeSet<usize> = system.pins.iter().map(|pin| pin.place).collect();
        let force = |place: usize| -> [f64; D] {
            let share = if held.contains(&place) { 0.0 } else { system.mass.at(place) / h };
            core::array::from_fn(|d| share * (v.0[d][place] - free.0[d][place]))
        };
        (0..system.nodes).map(|node| force(layout.place(node, lane))).collect()
    }
    /// The sum of the forces that pins exert on nodes [N]; NaN where there is no such body, or one of the nodes is not there.
    pub fn reaction(&mut self, body: usize, nodes: &[u32]) -> [f64; D] {
        let count = self.node_count(body);
        if !self.slots.is_there(body) || nodes.iter().any(|node| *node as usize >= count) {
            return [f64::NAN; D];
        }
        let (island, lane) = self.place[body];
        let still = self.islands[island].integrator.is_static();
        let frame = self.blueprint.time.frame;
        let system = &mut self.islands[island].system;
        let mut sum = [0.0; D];
        let Ok(forces) = system.forces(true) else { return sum };
        // How pins accelerate what they hold; nothing does in statics.
        let mut held = vec![None; system.nodes * D];
        for pin in &system.pins {
            let node = pin.place / system.layout.stride();
            if system.layout.place(node, lane) != pin.place {
                continue;
            }
            let rate = if still { [0.0; D] } else { pin.acceleration(system.time, frame) };
            (0..D).filter(|d| pin.axes[*d]).for_each(|d| held[node * D + d] = Some(rate[d]));
        }
        let inertia = system.inertia.as_ref().filter(|_| !still).map(|inertia| {
            let mut a: Vec<f64> = held.iter().map(|rate| rate.unwrap_or(0.0)).collect();
            let is_held: Vec<bool> = held.iter().map(Option::is_some).collect();
            // Where masses are coupled there are no obstacles, so that these are all forces on what is free.
            accelerations(system, &is_held, &system.node_by_node(&forces), &mut a);
            (inertia, a)
        });
        for node in nodes.iter().map(|node| *node as usize) {
            let place = system.layout.place(node, lane);
            let more = inertia.as_ref().map_or([0.0; D], |(inertia, a)| inertia.product::<D>(node, a));
            // A node that two pins hold is held by one force all the same.
            for d in 0..D {
                if let Some(rate) = held[node * D + d] {
                    sum[d] += system.mass.at(place) * rate + more[d] - forces.0[d][place];
                }
            }
        }
        sum
    }
}
