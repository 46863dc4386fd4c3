//! Bodies and commands that the program has added, as bytes. Snapshots contain these bodies and commands completely, so that removed bodies and
//! finished commands need not be kept.

use crate::blueprint::{Action, BodyBlueprint, CommandBlueprint, Mass, PinBlueprint};
use crate::bytes::{Reader, Writer};
use crate::error::WorldError;
use crate::inputs::{read_action, read_selector, write_action, write_selector};
use crate::path_faults::{Content, Promised, SnapshotFault};
use crate::registry::Registry;
use crate::schema;
use opruga_core::spec::{Spec, Value, Values};
use opruga_mesh::{Area, Mesh, Skin};
use std::collections::BTreeMap;
use std::sync::Arc;

fn damaged(what: Content) -> WorldError {
    WorldError::snapshot(SnapshotFault::Unknown { what })
}

impl Writer<'_> {
    fn indices<const N: usize>(&mut self, rows: &[[u32; N]]) {
        self.count(rows.len() as u64);
        rows.iter().flatten().for_each(|index| self.0.extend(index.to_le_bytes()));
    }

    fn list(&mut self, list: &[u32]) {
        self.indices(list.as_chunks::<1>().0);
    }

    fn optional<T>(&mut self, value: Option<T>, write: impl FnOnce(&mut Self, T)) {
        self.count(u64::from(value.is_some()));
        if let Some(value) = value {
            write(self, value);
        }
    }

    /// Writes the kind of a model, integrator or obstacle, and its fields.
    pub(crate) fn values(&mut self, values: &Values) {
        self.text(values.kind());
        self.count(values.iter().count() as u64);
        for (name, value) in values.iter() {
            self.text(name);
            self.value(value);
        }
    }

    pub(crate) fn models(&mut self, models: &[Values]) {
        self.count(models.len() as u64);
        models.iter().for_each(|model| self.values(model));
    }

    pub(crate) fn own_integrator(&mut self, integrator: Option<&Values>) {
        self.optional(integrator, |out, values| out.values(values));
    }

    /// Writes a body without its mesh.
    pub(crate) fn body<const D: usize>(&mut self, body: &BodyBlueprint<D>) {
        self.text(&body.name);
        self.vectors(&[body.translation, body.velocity]);
        self.numbers(&body.angular_velocity);
        // The rows of the gradient, then the velocities of nodes, which are empty for most bodies.
        self.vectors(&[&body.velocity_gradient[..], &body.node_velocities].concat());
        let (kind, numbers): (u64, &[f64]) = match &body.mass {
            Mass::Total(mass) => (0, std::slice::from_ref(mass)),
            Mass::Density(density) => (1, std::slice::from_ref(density)),
            Mass::DensityOfCells(densities) => (2, densities),
            Mass::Node(mass) => (3, std::slice::from_ref(mass)),
        };
        self.count(kind);
        self.numbers(numbers);
        self.number(body.thickness);
        self.own_integrator(body.integrator.as_ref());
        // The contact settings of a body follow its models, so that the bytes of bodies without such settings do not change.
        self.count((body.models.len() + usize::from(body.contact.is_some())) as u64);
        body.models.iter().chain(&body.contact).for_each(|values| self.values(values));
        self.count(body.pins.len() as u64);
        for pin in &body.pins {
            write_selector(self, &pin.select);
            pin.axes.iter().for_each(|axis| self.count(u64::from(*axis)));
            self.value(&Value::Rows(pin.motion.clone()));
        }
    }

    pub(crate) fn mesh<const D: usize>(&mut self, mesh: &Mesh<D>) {
        self.vectors(&mesh.positions);
        self.indices(&mesh.facets);
        self.indices(&mesh.wires);
        self.indices(&mesh.sheets);
        self.indices(&mesh.sheet_quadrilaterals);
        let cells = &mesh.cells;
        self.indices(&cells.triangles);
        self.indices(&cells.quadrilaterals);
        self.indices(&cells.tetrahedra);
        self.indices(&cells.hexahedra);
        self.indices(&cells.quadratic_triangles);
        self.indices(&cells.quadratic_tetrahedra);
        for groups in [&mesh.groups, &mesh.cell_groups] {
            self.count(groups.len() as u64);
            for (name, members) in groups {
                self.text(name);
                self.list(members);
            }
        }
        self.count(mesh.cell_values.len() as u64);
        for (name, values) in &mesh.cell_values {
            self.text(name);
            self.numbers(values);
        }
        self.optional(mesh.skin.as_ref(), |out, skin| {
            out.indices(&skin.triangles);
            out.count(skin.areas.len() as u64);
            for area in &skin.areas {
                out.optional(area.colour, |out, colour| out.list(&colour.map(u32::from)));
                out.count(area.rings.len() as u64);
                area.rings.iter().for_each(|ring| out.list(ring));
                out.indices(&area.triangles);
            }
            out.indices(&skin.outline);
            out.indices(&skin.carriers);
            out.vectors(&skin.weights);
        });
    }

    pub(crate) fn command<const D: usize>(&mut self, command: &CommandBlueprint<D>) {
        self.number(command.at);
        self.number(command.until);
        match &command.action {
            Action::Add(body) => {
                self.count(1);
                self.body(body);
                self.mesh(&body.mesh);
            }
            Action::Change { body, models, integrator } => {
                self.count(2);
                self.count(*body as u64);
                self.optional(models.as_ref(), |out, models| out.models(models));
                self.own_integrator(integrator.as_ref());
            }
            action => {
                self.count(0);
                // `write_action` can write all other actions.
                write_action(self, action);
            }
        }
    }
}

impl Reader<'_> {
    fn indices<const N: usize>(&mut self) -> Result<Vec<[u32; N]>, WorldError> {
        let n = self.count()?;
        let bytes = usize::try_from(n).ok().and_then(|n| n.checked_mul(4 * N));
        let (head, tail) = bytes
            .and_then(|bytes| self.0.split_at_checked(bytes))
            .ok_or_else(|| WorldError::snapshot(SnapshotFault::Promises { count: n, what: Promised::Numbers }))?;
        self.0 = tail;
        let numbers: Vec<u32> = head.as_chunks::<4>().0.iter().map(|bytes| u32::from_le_bytes(*bytes)).collect();
        Ok(numbers.as_chunks::<N>().0.to_vec())
    }

    fn list(&mut self) -> Result<Vec<u32>, WorldError> {
        Ok(self.indices::<1>()?.into_iter().flatten().collect())
    }

    fn optional<T>(&mut self, read: impl FnOnce(&mut Self) -> Result<T, WorldError>) -> Result<Option<T>, WorldError> {
        Ok(if self.count()? == 1 { Some(read(self)?) } else { None })
    }

    /// Reads the values of a kind whose specification `known` returns.
    pub(crate) fn values(
        &mut self,
        dimension: usize,
        known: impl Fn(&str) -> Option<&'static Spec>,
    ) -> Result<Values, WorldError> {
        let kind = self.text()?;
        let spec =
            known(&kind).ok_or_else(|| WorldError::snapshot(SnapshotFault::UnknownKind { kind: kind.clone() }))?;
        let mut values = Values::defaults(spec, dimension);
        for _ in 0..self.length()? {
            let (name, value) = (self.text()?, self.value()?);
            values
                .set(spec, &name, value, dimension)
                .map_err(|problem| WorldError::snapshot(SnapshotFault::Field { kind: kind.clone(), problem }))?;
        }
        Ok(values)
    }

    pub(crate) fn models<const D: usize>(&mut self, registry: &Registry<D>) -> Result<Vec<Values>, WorldError> {
        let n = self.length()?;
        (0..n).map(|_| self.values(D, |kind| registry.model(kind).map(|model| model.spec()))).collect()
    }

    pub(crate) fn own_integrator<const D: usize>(
        &mut self,
        registry: &Registry<D>,
    ) -> Result<Option<Values>, WorldError> {
        self.optional(|reader| reader.values(D, |kind| registry.integrator(kind).map(|rule| rule.spec())))
    }

    /// Reads a body without its mesh, which is added later.
    pub(crate) fn body<const D: usize>(&mut self, registry: &Registry<D>) -> Result<BodyBlueprint<D>, WorldError> {
        let name = self.text()?;
        let [translation, velocity] = self.vectors::<D>()?[..] else { return Err(damaged(Content::Body)) };
        let angular_velocity = self.numbers()?;
        let rows = self.vectors::<D>()?;
        let Some((gradient, node_velocities)) = rows.split_at_checked(D) else { return Err(damaged(Content::Body)) };
        let velocity_gradient = core::array::from_fn(|row| gradient[row]);
        let (kind, numbers) = (self.count()?, self.numbers()?);
        let mass = match (kind, numbers.as_slice()) {
            (0, [mass]) => Mass::Total(*mass),
            (1, [density]) => Mass::Density(*density),
            (2, densities) => Mass::DensityOfCells(Arc::from(densities)),
            (3, [mass]) => Mass::Node(*mass),
            _ => return Err(damaged(Content::Mass)),
        };
        let thickness = self.number()?;
        let integrator = self.own_integrator(registry)?;
        let own = schema::BODY_CONTACT.spec;
        let known = |kind: &str| registry.model(kind).map(|model| model.spec());
        let n = self.length()?;
        let mut models = (0..n)
            .map(|_| self.values(D, |kind| known(kind).or((kind == own.kind).then_some(own))))
            .collect::<Result<Vec<_>, _>>()?;
        let contact = models.pop_if(|last| last.kind() == own.kind);
        if models.iter().any(|model| model.kind() == own.kind) {
            return Err(damaged(Content::Body));
        }
        let mut pins = Vec::new();
        for _ in 0..self.length()? {
            let select = read_selector(self, 0)?;
            let mut axes = [false; D];
            for axis in &mut axes {
                *axis = self.count()? == 1;
            }
            let Value::Rows(motion) = self.value()? else { return Err(damaged(Content::Pin)) };
            pins.push(PinBlueprint { select, axes, motion });
        }
        let mesh = Arc::new(Mesh::default());
        Ok(BodyBlueprint {
            name,
            mesh,
            translation,
            velocity,
            angular_velocity,
            velocity_gradient,
            node_velocities: Arc::from(node_velocities),
            mass,
            thickness,
            integrator,
            models,
            pins,
            contact,
        })
    }

    pub(crate) fn mesh<const D: usize>(&mut self) -> Result<Mesh<D>, WorldError> {
        let mut mesh = Mesh::<D> { positions: self.vectors::<D>()?, ..Mesh::default() };
        mesh.facets = self.indices()?;
        mesh.wires = self.indices()?;
        mesh.sheets = self.indices()?;
        mesh.sheet_quadrilaterals = self.indices()?;
        let cells = &mut mesh.cells;
        cells.triangles = self.indices()?;
        cells.quadrilaterals = self.indices()?;
        cells.tetrahedra = self.indices()?;
        cells.hexahedra = self.indices()?;
        cells.quadratic_triangles = self.indices()?;
        cells.quadratic_tetrahedra = self.indices()?;
        for groups in [&mut mesh.groups, &mut mesh.cell_groups] {
            let n = self.length()?;
            *groups = (0..n).map(|_| Ok((self.text()?, self.list()?))).collect::<Result<_, WorldError>>()?;
        }
        let n = self.length()?;
        mesh.cell_values =
            (0..n).map(|_| Ok((self.text()?, self.numbers()?))).collect::<Result<BTreeMap<_, _>, WorldError>>()?;
        mesh.skin = self.optional(|reader| {
            let triangles = reader.indices()?;
            let mut areas = Vec::new();
            for _ in 0..reader.length()? {
                let colour = reader.optional(Reader::list)?;
                let colour = colour.map(|list| core::array::from_fn(|k| list.get(k).copied().unwrap_or(0) as u8));
                let n = reader.length()?;
                let rings = (0..n).map(|_| reader.list()).collect::<Result<_, _>>()?;
                areas.push(Area { colour, rings, triangles: reader.indices()? });
            }
            let outline = reader.indices()?;
            Ok(Skin { triangles, areas, outline, carriers: reader.indices()?, weights: reader.vectors::<4>()? })
        })?;
        Ok(mesh)
    }

    pub(crate) fn command<const D: usize>(
        &mut self,
        registry: &Registry<D>,
    ) -> Result<CommandBlueprint<D>, WorldError> {
        let (at, until) = (self.number()?, self.number()?);
        let action = match self.count()? {
            0 => read_action(self)?,
            1 => {
                let body = self.body(registry)?;
                let body = BodyBlueprint { mesh: Arc::new(self.mesh()?), ..body };
                crate::validity::body(&body)?;
                Action::Add(Box::new(body))
            }
            2 => Action::Change {
                body: self.count()? as usize,
                models: self.optional(|reader| reader.models(registry))?,
                integrator: self.own_integrator(registry)?,
            },
            _ => return Err(damaged(Content::Command)),
        };
        Ok(CommandBlueprint { at, until, action })
    }
}
