//! The scene in snapshots: its differences from the scene at the start, and bodies that were added since.

use crate::blueprint::{Action, BodyBlueprint, Surroundings};
use crate::build::build_colliders;
use crate::bytes::{Reader, Writer};
use crate::changes::Before;
use crate::error::WorldError;
use crate::path_faults::SnapshotFault;
use crate::running::Running;
use crate::schema::{CONTACT, MOST_SUBSTEPS};
use crate::slots::Origin;
use crate::world::World;
use opruga_core::spec::Values;
use opruga_mesh::Mesh;
use std::collections::BTreeMap;
use std::sync::Arc;

fn refused<T>(fault: SnapshotFault) -> Result<T, WorldError> {
    Err(WorldError::snapshot(fault))
}

impl<const D: usize> World<D> {
    /// Writes the differences between the scene and the scene at the start. Equal differences give equal bytes.
    pub(crate) fn write_delta(&self, out: &mut Writer<'_>) {
        let (now, then) = (&self.blueprint, &self.at_start);
        let integrator = then.integrator.as_ref().filter(|values| **values != now.integrator);
        out.own_integrator(integrator.map(|_| &now.integrator));
        let s = &now.surroundings;
        if then.surroundings.is_some_and(|before| before != *s) {
            out.count(1 + u64::from(s.unfold));
            out.vectors(&[s.gravity]);
            out.number(s.drag);
            [s.largest_force, s.largest_velocity, s.largest_distance].iter().for_each(|x| out.numbers(x.as_slice()));
        } else {
            out.count(0);
        }
        let substeps = then.time.filter(|before| before.substeps != now.time.substeps);
        out.count(substeps.map_or(0, |_| u64::from(now.time.substeps)));
        let colliders = || then.colliders.iter().filter(|(number, values)| now.colliders[**number].values != **values);
        out.count(colliders().count() as u64);
        for (number, _) in colliders() {
            out.count(*number as u64);
            out.values(&now.colliders[*number].values);
        }
        if let Some(contact) = &now.contact {
            let changed = then.contact.as_ref().is_some_and(|values| *values != contact.values);
            out.count(u64::from(changed));
            if changed {
                out.values(&contact.values);
            }
        }
        self.write_added(out);
        let changed = || {
            then.bodies.iter().filter(|(number, (models, own))| {
                let body = &now.bodies[**number];
                body.models != *models || body.integrator != *own
            })
        };
        out.count(changed().count() as u64);
        for (number, _) in changed() {
            out.count(*number as u64);
            out.models(&now.bodies[*number].models);
            out.own_integrator(now.bodies[*number].integrator.as_ref());
        }
    }

    /// Bodies added since the start, slot by slot. A mesh that an earlier body also has is given by the slot of that body.
    fn write_added(&self, out: &mut Writer<'_>) {
        let bodies = &self.blueprint.bodies;
        out.count((bodies.len() - self.slots.initial) as u64);
        // The usual case, in which a snapshot need not examine the bodies.
        if bodies.len() == self.slots.initial {
            return;
        }
        let mut meshes: BTreeMap<*const Mesh<D>, usize> = BTreeMap::new();
        for (slot, body) in bodies.iter().enumerate() {
            let first = *meshes.entry(Arc::as_ptr(&body.mesh)).or_insert(slot);
            if slot < self.slots.initial {
                continue;
            }
            match self.slots.origin[slot] {
                Origin::Scene | Origin::Free(_) => out.count(0),
                Origin::Command(number) => {
                    out.count(1);
                    out.count(number as u64);
                }
                Origin::Program => {
                    out.count(2);
                    out.count(self.slots.generation[slot]);
                    out.body(body);
                    out.count(u64::from(first < slot));
                    match first < slot {
                        true => out.count(first as u64),
                        false => out.mesh(&body.mesh),
                    }
                }
                Origin::Reserved => out.count(3),
            }
        }
    }

    /// Restores the scene at the start and applies the differences in these bytes. Bodies that commands add come from the given commands.
    pub(crate) fn take_delta(&mut self, reader: &mut Reader<'_>, commands: &[Running<D>]) -> Result<(), WorldError> {
        let known: Vec<Arc<Mesh<D>>> = self.blueprint.bodies.iter().map(|body| Arc::clone(&body.mesh)).collect();
        self.undo_all();
        let registry = Arc::clone(&self.registry);
        if let Some(values) = reader.own_integrator(&registry)? {
            let before = std::mem::replace(&mut self.blueprint.integrator, values);
            self.keep_start(Before::Integrator(before));
        }
        let changed = reader.count()?;
        if changed > 0 {
            let unfold = changed == 2;
            let [gravity] = reader.vectors::<D>()?[..] else { return refused(SnapshotFault::Gravity {}) };
            let drag = reader.number()?;
            let mut limit = || Ok::<_, WorldError>(reader.numbers()?.first().copied());
            let (largest_force, largest_velocity, largest_distance) = (limit()?, limit()?, limit()?);
            let now = Surroundings { gravity, drag, largest_force, largest_velocity, largest_distance, unfold };
            crate::validity::surroundings(&now)?;
            let before = std::mem::replace(&mut self.blueprint.surroundings, now);
            self.keep_start(Before::Surroundings(before));
        }
        let substeps = reader.count()?;
        if substeps > u64::from(MOST_SUBSTEPS) {
            return refused(SnapshotFault::Substeps {});
        }
        if substeps > 0 {
            let before = self.blueprint.time;
            self.blueprint.time.substeps = substeps as u32;
            self.keep_start(Before::Time(before));
        }
        for _ in 0..reader.length()? {
            let number = reader.count()? as usize;
            let values = reader.values(D, |kind| opruga_collide::all(D).into_iter().find(|spec| spec.kind == kind))?;
            let Some(collider) = self.blueprint.colliders.get_mut(number) else {
                return refused(SnapshotFault::NoObstacle {});
            };
            let before = std::mem::replace(&mut collider.values, values);
            self.keep_start(Before::Collider(number, before));
        }
        self.colliders = build_colliders(&self.blueprint)?;
        if let Some(contact) = &mut self.blueprint.contact
            && reader.count()? > 0
        {
            let values = reader.values(D, |kind| (kind == CONTACT.spec.kind).then_some(CONTACT.spec))?;
            let before = std::mem::replace(&mut contact.values, values);
            self.clusters = None;
            self.keep_start(Before::Contact(before));
        }
        self.take_added(reader, commands, &known)?;
        for _ in 0..reader.length()? {
            let number = reader.count()? as usize;
            let (models, own) = (reader.models(&registry)?, reader.own_integrator(&registry)?);
            if number >= self.blueprint.bodies.len() || !self.slots.origin[number].is_taken() {
                return refused(SnapshotFault::NoBody {});
            }
            let body = &mut self.blueprint.bodies[number];
            let models: Vec<Values> = std::mem::replace(&mut body.models, models);
            let integrator = std::mem::replace(&mut body.integrator, own);
            self.keep_start(Before::Body { number, models, integrator });
        }
        Ok(())
    }

    fn take_added(
        &mut self,
        reader: &mut Reader<'_>,
        commands: &[Running<D>],
        known: &[Arc<Mesh<D>>],
    ) -> Result<(), WorldError> {
        for _ in 0..reader.length()? {
            let slot = self.slots.len();
            match reader.count()? {
                0 => self.reserve(slot, Origin::Free(None)),
                1 => {
                    let number = reader.count()? as usize;
                    let command = commands.get(number).map(|running| (&running.command.action, running.generation));
                    let Some((Action::Add(body), generation)) = command else {
                        return refused(SnapshotFault::NotAdded {});
                    };
                    self.blueprint.bodies.push((**body).clone());
                    self.slots.put(slot, Origin::Command(number), generation);
                }
                2 => {
                    let generation = reader.count()?;
                    let body = reader.body(&self.registry)?;
                    let mesh = match reader.count()? {
                        0 => {
                            let mesh = reader.mesh::<D>()?;
                            // A mesh that is already present is shared.
                            let same = known.iter().find(|known| ***known == mesh);
                            same.map_or_else(|| Arc::new(mesh), Arc::clone)
                        }
                        _ => {
                            let first = reader.count()? as usize;
                            let Some(first) = self.blueprint.bodies.get(first) else {
                                return refused(SnapshotFault::NoMesh {});
                            };
                            Arc::clone(&first.mesh)
                        }
                    };
                    let body = BodyBlueprint { mesh, ..body };
                    crate::validity::body(&body)?;
                    self.blueprint.bodies.push(body);
                    self.slots.put(slot, Origin::Program, generation);
                }
                3 => self.reserve(slot, Origin::Reserved),
                _ => return refused(SnapshotFault::FromNowhere {}),
            }
        }
        Ok(())
    }
}
