//! The forces of models, obstacles and pins on the nodes of a body.

use crate::world::World;
use opruga_core::contacts::Moved;
use opruga_core::potential::Account;
use opruga_core::state::Columns;
use opruga_integrators::accelerations;
use opruga_math::WIDTH;

impl<const D: usize> World<D> {
    /// The forces on the nodes of a body [N] from the models that belong to one account of the ledger; without an account, from all models, including
    /// gravity.
    ///
    /// Empty if there is no such body or if a model refuses the state.
    pub fn node_forces(&mut self, body: usize, account: Option<Account>) -> Vec<[f64; D]> {
        if self.handle(body).is_none() {
            return Vec::new();
        }
        let (island, lane) = self.locations[body];
        let system = &mut self.islands[island].system;
        let forces = match account {
            Some(account) => system.forces_of(account),
            None => system.forces(true),
        };
        let Ok(forces) = forces else { return Vec::new() };
        (0..system.nodes).map(|node| forces.at(system.layout.index(node, lane))).collect()
    }
    /// The nodes of a body that are pinned now, along some or all axes.
    pub fn pinned_nodes(&self, body: usize) -> Vec<u32> {
        if self.handle(body).is_none() {
            return Vec::new();
        }
        let (island, lane) = self.locations[body];
        let system = &self.islands[island].system;
        let pinned: std::collections::BTreeSet<usize> = system.pins.iter().map(|pin| pin.index).collect();
        (0..system.nodes as u32).filter(|node| pinned.contains(&system.layout.index(*node as usize, lane))).collect()
    }
    /// The contact forces on the nodes of a body [N]. The forces of obstacles are the forces in the coming substep, f = m (v' − v*)/h. The forces of
    /// bodies, of corners and edges of obstacles, and of faces of obstacles on bodies with implicit integrators in scenes with contact come from the
    /// last substep: the impulse divided by h.
    ///
    /// v* is the velocity that the present forces would give a node within h without obstacles, and v' is the velocity with obstacles. The force
    /// consists of the normal force and friction; in an impact, it is the impulse over h. Pinned nodes have no contact force, because the pin takes
    /// it up. Empty if there is no such body, if nothing can touch it, or if a model refuses the state.
    pub fn contact_forces(&mut self, body: usize) -> Vec<[f64; D]> {
        let mut forces = self.obstacle_forces(body);
        if let Some(clusters) = self.clusters.as_ref().filter(|_| self.handle(body).is_some()) {
            let (h, nodes) = (self.h(), self.node_count(body));
            forces.resize(nodes, [0.0; D]);
            let stride = self.islands[self.locations[body].0].system.layout.stride();
            for meeting in clusters.meetings().filter(|meeting| meeting.bodies.contains(&body)) {
                meeting.add_forces(body, h, stride, &mut forces);
            }
        }
        forces
    }

    fn obstacle_forces(&mut self, body: usize) -> Vec<[f64; D]> {
        let Some(colliders) = self.colliders.clone().filter(|_| self.handle(body).is_some()) else { return Vec::new() };
        // Where faces of obstacles touch a body like faces of bodies, their forces are among those of bodies.
        let meetings = self.clusters.iter().flat_map(|clusters| clusters.meetings());
        let without_faces =
            meetings.filter(|meeting| meeting.bodies.contains(&body)).find_map(|meeting| meeting.without_faces.clone());
        let contacts = without_faces.unwrap_or_else(|| colliders.into_contacts());
        let (h, time, (island, lane)) = (self.h(), self.time(), self.locations[body]);
        let system = &mut self.islands[island].system;
        let Ok(forces) = system.forces(true) else { return Vec::new() };
        let (index_count, layout) = (system.index_count(), system.layout);
        let used = system.nodes * layout.stride();
        let (mut x, mut v) = (Columns::zeros(index_count), Columns::zeros(index_count));
        for index in 0..used {
            let mass = system.mass.at(index);
            for d in 0..D {
                let now = system.state.v.0[d][index];
                v.0[d][index] = if mass > 0.0 { now + h * forces.0[d][index] / mass } else { now };
                x.0[d][index] = system.state.x.0[d][index] + h * v.0[d][index];
            }
        }
        let free = v.clone();
        let [mut normal, mut friction, mut work, mut correction] = [[0.0; WIDTH]; 4];
        contacts.resolve(
            system.simd,
            &mut Moved {
                range: 0..index_count,
                padding_start: used,
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
        let pinned: std::collections::BTreeSet<usize> = system.pins.iter().map(|pin| pin.index).collect();
        let force = |index: usize| -> [f64; D] {
            let share = if pinned.contains(&index) { 0.0 } else { system.mass.at(index) / h };
            core::array::from_fn(|d| share * (v.0[d][index] - free.0[d][index]))
        };
        (0..system.nodes).map(|node| force(layout.index(node, lane))).collect()
    }
    /// The sum of the forces that pins exert on nodes [N]; NaN if there is no such body or if one of the nodes does not exist.
    pub fn reaction(&mut self, body: usize, nodes: &[u32]) -> [f64; D] {
        let count = self.node_count(body);
        if !self.slots.is_there(body) || nodes.iter().any(|node| *node as usize >= count) {
            return [f64::NAN; D];
        }
        let (island, lane) = self.locations[body];
        let still = self.islands[island].integrator.is_static();
        let frame = self.blueprint.time.frame;
        let system = &mut self.islands[island].system;
        let mut sum = [0.0; D];
        let Ok(forces) = system.forces(true) else { return sum };
        // The accelerations that pins impose on their nodes; zero in statics.
        let mut rates = vec![None; system.nodes * D];
        for pin in &system.pins {
            let node = pin.index / system.layout.stride();
            if system.layout.index(node, lane) != pin.index {
                continue;
            }
            let rate = if still { [0.0; D] } else { pin.acceleration(system.time, frame) };
            (0..D).filter(|d| pin.axes[*d]).for_each(|d| rates[node * D + d] = Some(rate[d]));
        }
        let inertia = system.inertia.as_ref().filter(|_| !still).map(|inertia| {
            let mut a: Vec<f64> = rates.iter().map(|rate| rate.unwrap_or(0.0)).collect();
            let is_pinned: Vec<bool> = rates.iter().map(Option::is_some).collect();
            // A coupled mass matrix excludes obstacles, so these are all the forces on the free nodes.
            accelerations(system, &is_pinned, &system.node_by_node(&forces), &mut a);
            (inertia, a)
        });
        for node in nodes.iter().map(|node| *node as usize) {
            let index = system.layout.index(node, lane);
            let more = inertia.as_ref().map_or([0.0; D], |(inertia, a)| inertia.product::<D>(node, a));
            // A node with two pins still has only one force.
            for d in 0..D {
                if let Some(rate) = rates[node * D + d] {
                    sum[d] += system.mass.at(index) * rate + more[d] - forces.0[d][index];
                }
            }
        }
        sum
    }
}
