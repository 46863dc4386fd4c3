//! Builds systems from a blueprint: masses, columns, models, pins and loads.

use crate::blueprint::{Blueprint, BodyBlueprint, LoadKind, Mass};
use crate::carried::{BodyHistory, BodyState};
use crate::contact_laws;
use crate::error::{Part, WorldError};
use crate::island::Island;
use crate::loads::{CentralForces, FollowerPressure, NodeForces};
use crate::masses::{densities, node_masses};
use crate::path_faults::PathFault;
use crate::plausible;
use crate::refusals::Refusal;
use crate::registry::Registry;
use crate::unfold;
use opruga_collide::{Colliders, Refused};
use opruga_core::break_off::BreakOff;
use opruga_core::error::BuildError;
use opruga_core::integrator::Integrator;
use opruga_core::potential::{Ingredients, Potential};
use opruga_core::spec::{Role, Value, Values};
use opruga_core::state::{Columns, Layout, Parameter};
use opruga_core::system::{Pin, Stabilisers, System};
use opruga_math::{Simd, WIDTH};
use opruga_mesh::signed_volume;
use std::collections::BTreeMap;
use std::sync::Arc;

impl<const D: usize> Builder<'_, D> {
    /// Whether anything other than its own pins may hold a body: obstacles, or other bodies that it touches.
    fn may_be_supported(&self, body: &BodyBlueprint<D>) -> bool {
        let scene = self.blueprint;
        let by_others = scene.contact.is_some()
            && body.touches()
            && scene.bodies.iter().filter(|body| body.touches()).nth(1).is_some();
        !scene.colliders.is_empty() || by_others
    }
}

/// The state of a body at the start.
pub(crate) fn initial_state<const D: usize>(body: &BodyBlueprint<D>) -> BodyState<D> {
    let x: Vec<[f64; D]> =
        body.mesh.positions.iter().map(|p| core::array::from_fn(|d| p[d] + body.translation[d])).collect();
    let masses = node_masses(body);
    let total: f64 = masses.iter().sum();
    let mut center = [0.0; D];
    for (p, m) in x.iter().zip(&masses) {
        for d in 0..D {
            center[d] += p[d] * m / if total > 0.0 { total } else { 1.0 };
        }
    }
    let spin = &body.angular_velocity;
    let stretches = body.velocity_gradient != [[0.0; D]; D];
    let v = x
        .iter()
        .enumerate()
        .map(|(node, p)| {
            let mut v = body.velocity;
            let r: [f64; D] = core::array::from_fn(|d| p[d] - center[d]);
            if D == 2 && spin.len() == 1 {
                v[0] -= spin[0] * r[1];
                v[1] += spin[0] * r[0];
            } else if D == 3 && spin.len() == 3 {
                for d in 0..3 {
                    let (e, f) = ((d + 1) % 3, (d + 2) % 3);
                    v[d] += spin[e] * r[f] - spin[f] * r[e];
                }
            }
            if stretches {
                for (v, row) in v.iter_mut().zip(&body.velocity_gradient) {
                    for d in 0..D {
                        *v += row[d] * r[d];
                    }
                }
            }
            if let Some(own) = body.node_velocities.get(node) {
                v.iter_mut().zip(own).for_each(|(v, own)| *v += own);
            }
            v
        })
        .collect();
    BodyState { x, v, memory: Vec::new(), history: BodyHistory::default() }
}

/// The data that are needed to build an island.
pub(crate) struct Builder<'a, const D: usize> {
    pub(crate) blueprint: &'a Blueprint<D>,
    pub(crate) registry: &'a Registry<D>,
    pub(crate) simd: Simd,
    /// The integrator of the scene, for bodies without their own.
    pub(crate) integrator: &'a Arc<dyn Integrator<D>>,
    /// The means to cancel the preparation of a model.
    pub(crate) break_off: &'a BreakOff,
}

/// Bodies that will lie side by side in lanes, with their states.
struct Seats<'a, const D: usize> {
    layout: Layout,
    bodies: Vec<&'a BodyBlueprint<D>>,
    states: &'a [&'a BodyState<D>],
}

impl<const D: usize> Seats<'_, D> {
    /// The body in a lane. A lane without a body of its own repeats the first body.
    fn of_lane(&self, lane: usize) -> usize {
        if lane < self.bodies.len() { lane } else { 0 }
    }
}

impl<const D: usize> Builder<'_, D> {
    /// Builds the island of some bodies in their states.
    pub(crate) fn island(
        &self,
        bodies: &[usize],
        states: &[&BodyState<D>],
        time: f64,
    ) -> Result<Island<D>, WorldError> {
        let layout = if bodies.len() > 1 { Layout::Batch } else { Layout::Single };
        let own = bodies.iter().map(|b| &self.blueprint.bodies[*b]).collect();
        let seats = Seats { layout, bodies: own, states };
        let first = seats.bodies[0];
        let range = plausible::range(&first.mesh);
        let masses = self.plausible_masses(&seats, range)?;
        let mut system = self.bare_system(&seats, &masses, time);
        for (number, values) in first.models.iter().enumerate() {
            self.add_model(&mut system, &seats, number, values)?;
        }
        if self.blueprint.surroundings.drag > 0.0 {
            self.add_drag(&mut system, first, layout)?;
        }
        for (l, body) in seats.bodies.iter().enumerate() {
            self.add_pins(&mut system, body, l, layout);
            self.add_loads(&mut system, bodies[l], body, l, layout)?;
        }
        let integrator = match &first.integrator {
            Some(values) => {
                build_integrator(self.registry, values, || Part::IntegratorOf { name: first.name.clone() })?.into()
            }
            None => Arc::clone(self.integrator),
        };
        let refuse = |source| WorldError::Build { part: Part::body(&first.name), source };
        for body in &seats.bodies {
            contact_laws::check(self.blueprint, body, &*integrator)?;
        }
        self.check_choices(first, &system, &*integrator).map_err(refuse)?;
        system.equip(&*integrator);
        if self.blueprint.surroundings.unfold {
            system.history.add(&unfold::channels(), system.index_count());
        }
        for (l, state) in states.iter().enumerate() {
            state.history.restore(&mut system, l);
        }
        integrator.check(&system, self.may_be_supported(first)).map_err(refuse)?;
        Ok(Island::new(system, integrator, bodies.to_vec(), range))
    }

    /// The masses of the nodes of every body [kg]. Refuses masses and states that are outside the range in which the world can compute.
    fn plausible_masses(&self, seats: &Seats<'_, D>, range: f64) -> Result<Vec<Vec<f64>>, WorldError> {
        let refused = |body: &BodyBlueprint<D>, source| WorldError::Build { part: Part::body(&body.name), source };
        for (body, state) in seats.bodies.iter().zip(seats.states) {
            plausible::check_range(&state.x, range)
                .and_then(|()| plausible::check_speed(&state.v, range, self.substep()))
                .map_err(|source| refused(body, source))?;
        }
        let masses: Vec<Vec<f64>> = seats.bodies.iter().map(|body| node_masses(body)).collect();
        for (body, masses) in seats.bodies.iter().zip(&masses) {
            plausible::check_masses(body, masses).map_err(|source| refused(body, source))?;
        }
        Ok(masses)
    }

    /// The length of a substep [s].
    fn substep(&self) -> f64 {
        self.blueprint.time.frame / f64::from(self.blueprint.time.substeps)
    }

    /// The bodies with their masses and states, before any force acts on them.
    fn bare_system(&self, seats: &Seats<'_, D>, masses: &[Vec<f64>], time: f64) -> System<D> {
        let Seats { layout, bodies, states } = seats;
        let nodes = bodies[0].mesh.positions.len();
        let index_count = layout.index_count(nodes);
        let (mut x, mut v) = (Columns::zeros(index_count), Columns::zeros(index_count));
        for node in 0..nodes {
            for l in 0..layout.stride() {
                x.set(layout.index(node, l), states[seats.of_lane(l)].x[node]);
                v.set(layout.index(node, l), states[seats.of_lane(l)].v[node]);
            }
        }
        for index in nodes * layout.stride()..index_count {
            x.set(index, states[0].x[nodes - 1]);
        }
        let mass = Parameter::from_items(*layout, nodes, |node, l| masses[seats.of_lane(l)][node]);
        let mut system = System::new(self.simd, *layout, nodes, bodies.len(), x, v, mass);
        system.time = time;
        system.gravity = self.blueprint.surroundings.gravity;
        system.stabilisers = Stabilisers {
            largest_force: self.blueprint.surroundings.largest_force,
            largest_velocity: self.blueprint.surroundings.largest_velocity,
        };
        system
    }

    /// Adds a model: it is built on the mesh of the first body, with the parameters of all bodies, and gets the memory that belongs to each of them.
    fn add_model(
        &self,
        system: &mut System<D>,
        seats: &Seats<'_, D>,
        number: usize,
        values: &Values,
    ) -> Result<(), WorldError> {
        let (layout, first) = (seats.layout, seats.bodies[0]);
        let refuse = |source: BuildError| match source.code() {
            BuildError::BROKEN_OFF => WorldError::BrokenOff {},
            _ => WorldError::Build { part: Part::body(&first.name), source },
        };
        let Some(model) = self.registry.model(values.kind()) else {
            return Err(refuse(BuildError::of(values.kind(), Refusal::NoModelHere {})));
        };
        let all: Vec<&Values> = (0..layout.stride()).map(|l| &seats.bodies[seats.of_lane(l)].models[number]).collect();
        let potential = model
            .build(&Ingredients {
                mesh: &first.mesh,
                layout,
                values: &all,
                mass: &system.mass,
                densities: densities(first),
                thickness: first.thickness,
                gravity: self.blueprint.surroundings.gravity,
                step: self.substep(),
                break_off: self.break_off,
            })
            .map_err(refuse)?;
        system.add(potential);
        if let Some(member) = system.members.last_mut() {
            for l in 0..layout.stride() {
                if let Some(kept) = seats.states[seats.of_lane(l)].memory.get(number)
                    && kept.len() * WIDTH == member.memory.len()
                {
                    for (k, value) in kept.iter().enumerate() {
                        member.memory[k * WIDTH + l] = *value;
                    }
                }
            }
        }
        Ok(())
    }

    /// Refuses models and an integrator that cannot be combined.
    fn check_choices(
        &self,
        first: &BodyBlueprint<D>,
        system: &System<D>,
        integrator: &dyn Integrator<D>,
    ) -> Result<(), BuildError> {
        self.check_cells(first)?;
        // Only the models are checked, because loads always provide their derivatives.
        for member in &system.members[..first.models.len()] {
            if !member.potential.properties().views.include(integrator.needs()) {
                return Err(no_view(&*member.potential, integrator.name()));
            }
        }
        if system.inertia.is_some() {
            self.check_mass_matrix(first, integrator)?;
        }
        Ok(())
    }

    /// Refuses cells that belong to two models. If models name groups, also refuses cells that belong to no model.
    fn check_cells(&self, body: &BodyBlueprint<D>) -> Result<(), BuildError> {
        let mut owner = vec![None; body.mesh.cells.len()];
        let mut groups = Vec::new();
        let mut kind = "";
        for (number, model) in
            body.models.iter().enumerate().filter(|(_, model)| model.spec().has_role(Role::OwnsCells))
        {
            kind = model.kind();
            let group = model.text("cells");
            let own: Vec<u32> = match group {
                None => (0..owner.len() as u32).collect(),
                // The model itself refuses a missing group.
                Some(name) => body.mesh.cell_groups.get(name).cloned().unwrap_or_default(),
            };
            groups.extend(group.map(|name| format!("`{name}`")));
            for cell in own {
                if let Some(first) = owner[cell as usize].replace(number)
                    && first != number
                {
                    let refusal = Refusal::CellsTwice { cell, first, second: number, kind };
                    return Err(BuildError::of(kind, refusal));
                }
            }
        }
        let bare = owner.iter().filter(|owner| owner.is_none()).count();
        match owner.iter().position(Option::is_none) {
            Some(first) if !groups.is_empty() => {
                let (count, cells, groups) = (bare, owner.len(), groups.join(", "));
                Err(BuildError::of(kind, Refusal::Uncovered { count, cells, first, groups }))
            }
            _ => Ok(()),
        }
    }

    /// Refuses everything that cannot be combined with a mass matrix that couples nodes.
    fn check_mass_matrix(&self, body: &BodyBlueprint<D>, integrator: &dyn Integrator<D>) -> Result<(), BuildError> {
        let coupling =
            body.models.iter().find(|model| model.text("mass") == Some("consistent")).or(body.models.first());
        let kind = coupling.map_or("", Values::kind);
        let refuse = |refusal: Refusal| Err(BuildError::of(kind, refusal));
        if !integrator.takes_mass_matrix() {
            return refuse(Refusal::MassMatrix { integrator: integrator.name() });
        }
        // In statics masses serve only as weights.
        if !self.blueprint.colliders.is_empty() && !integrator.is_static() {
            return refuse(Refusal::MassAndObstacles {});
        }
        if let Mass::Node(mass) = body.mass {
            return refuse(Refusal::NodeMass { mass });
        }
        Ok(())
    }

    fn add_drag(&self, system: &mut System<D>, body: &BodyBlueprint<D>, layout: Layout) -> Result<(), WorldError> {
        let refuse = |source| WorldError::Build { part: Part::Section { path: "world" }, source };
        let Some(model) = self.registry.model_with(Role::WorldDrag) else { return Ok(()) };
        let mut values = Values::defaults(model.spec(), D);
        let rate = Value::Number(self.blueprint.surroundings.drag);
        values
            .set(model.spec(), model.spec().fields[0].name, rate, D)
            .map_err(|e| refuse(BuildError::of(model.spec().kind, e)))?;
        let all = vec![&values; layout.stride()];
        let ingredients = Ingredients {
            mesh: &*body.mesh,
            layout,
            values: &all,
            mass: &system.mass,
            densities: densities(body),
            thickness: body.thickness,
            gravity: self.blueprint.surroundings.gravity,
            step: self.substep(),
            break_off: self.break_off,
        };
        system.add(model.build(&ingredients).map_err(refuse)?);
        Ok(())
    }

    fn add_pins(&self, system: &mut System<D>, body: &BodyBlueprint<D>, lane: usize, layout: Layout) {
        for pin in &body.pins {
            let motion = Arc::new(pin.motion.clone());
            for node in pin.select.resolve(&body.mesh, &body.translation) {
                let rest = body.mesh.positions[node as usize];
                system.pins.push(Pin {
                    index: layout.index(node as usize, lane),
                    axes: pin.axes,
                    anchor: core::array::from_fn(|d| rest[d] + body.translation[d]),
                    motion: Arc::clone(&motion),
                });
            }
        }
    }

    fn add_loads(
        &self,
        system: &mut System<D>,
        number: usize,
        body: &BodyBlueprint<D>,
        lane: usize,
        layout: Layout,
    ) -> Result<(), WorldError> {
        for (index, load) in self.blueprint.loads.iter().enumerate().filter(|(_, load)| load.body == number) {
            let refused = |fault: PathFault| Err(WorldError::path(format!("load.{index}"), fault));
            let nodes = load.select.resolve(&body.mesh, &body.translation);
            let depth = if D == 2 { body.thickness } else { 1.0 };
            let mut entries: BTreeMap<usize, [f64; D]> = BTreeMap::new();
            match load.kind {
                LoadKind::Force(force) => {
                    for node in &nodes {
                        entries.insert(layout.index(*node as usize, lane), force);
                    }
                }
                LoadKind::Central { value, center } => {
                    let indices = nodes.iter().map(|node| layout.index(*node as usize, lane)).collect();
                    system.add(Box::new(CentralForces { indices, value, center, curve: load.curve.clone() }));
                    continue;
                }
                LoadKind::Traction(traction) => {
                    for (node, share) in body.mesh.boundary_shares(&nodes) {
                        let force = traction.map(|t| t * share * depth);
                        entries.insert(layout.index(node as usize, lane), force);
                    }
                }
                LoadKind::BodyForce(force) => {
                    for (node, share) in body.mesh.cell_shares(&nodes) {
                        entries.insert(layout.index(node as usize, lane), force.map(|f| f * share * depth));
                    }
                    if entries.is_empty() {
                        return refused(PathFault::NoCells {});
                    }
                }
                LoadKind::Pressure(pressure) => {
                    let indices = |side: Vec<u32>| side.iter().map(|&n| layout.index(n as usize, lane)).collect();
                    let sides: Vec<Vec<usize>> = body.mesh.boundary_sides(&nodes).into_iter().map(indices).collect();
                    if sides.is_empty() {
                        return refused(PathFault::NoFacets {});
                    }
                    let load = FollowerPressure::new(pressure * depth, &load.curve, layout.stride(), sides);
                    system.add(Box::new(load));
                    continue;
                }
            }
            if entries.is_empty() {
                return refused(PathFault::NoFacets {});
            }
            system.add(Box::new(NodeForces { entries: entries.into_iter().collect(), curve: load.curve.clone() }));
        }
        Ok(())
    }
}

/// The error for a model that lacks what an integrator needs.
fn no_view<const D: usize>(model: &dyn Potential<D>, integrator: &str) -> BuildError {
    let properties = model.properties();
    let (integrator, why) = (integrator.to_string(), model.lacks());
    let refusal = match properties.views.hessian {
        true => Refusal::NoSymmetry { integrator, why },
        false => Refusal::NoDerivatives { integrator, why },
    };
    BuildError::of(properties.name, refusal)
}

/// The enclosed volume of a body at rest [m³] (area times thickness in 2D).
pub(crate) fn rest_volume<const D: usize>(body: &BodyBlueprint<D>) -> f64 {
    signed_volume(&body.mesh.facets, &body.mesh.positions) * if D == 2 { body.thickness } else { 1.0 }
}

/// The obstacles of a blueprint.
pub(crate) fn build_colliders<const D: usize>(
    blueprint: &Blueprint<D>,
) -> Result<Option<Arc<Colliders<D>>>, WorldError> {
    if blueprint.colliders.is_empty() {
        return Ok(None);
    }
    let values: Vec<_> = blueprint.colliders.iter().map(|c| c.values.clone()).collect();
    let refuse = |Refused { index, source }| WorldError::Build { part: Part::Collider { index }, source };
    Ok(Some(Arc::new(Colliders::<D>::build(&values).map_err(refuse)?)))
}

/// Builds an integrator from its parameters; `part` is the part of the scene to which it belongs.
pub(crate) fn build_integrator<const D: usize>(
    registry: &Registry<D>,
    values: &Values,
    part: impl Fn() -> Part,
) -> Result<Box<dyn Integrator<D>>, WorldError> {
    let refuse = |source| WorldError::Build { part: part(), source };
    let Some(kind) = registry.integrator(values.kind()) else {
        let source = BuildError::of(values.kind(), Refusal::NoIntegratorHere {});
        return Err(refuse(source));
    };
    kind.build(values).map_err(refuse)
}
