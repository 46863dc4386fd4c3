//! `[[body]]`: shape, mass, models and pins.

use super::Cost;
use super::body_list::Bodies;
use super::copies::{Copies, copies, write_out};
use super::errors::{BodyCondition, BodyError, Part, SceneAllowed, SceneHint, Wanted};
use super::names::{Names, What};
use super::reader::{Reader, join};
use super::shape::{self, ShapeLocation};
use super::velocities::{self, Velocities};
use super::{location_of, pins, selectors};
use crate::document::{Data, Node};
use crate::problem::{SceneError, visible};
use crate::shapes::Loaded;
use opruga_core::spec::{Role, Values};
use opruga_mesh::outline::OutlineError;
use opruga_mesh::{Cut, Measure, Mesh, MeshError};
use opruga_world::blueprint::{BodyBlueprint, Mass, PinBlueprint, Selector};
use opruga_world::validity::{self, LONGEST};
use opruga_world::{schema, shapes};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// A body as it was read, before its mesh is made.
struct Draft<'n, const D: usize> {
    node: &'n Node,
    path: String,
    name: String,
    values: Values,
    shape: Option<Values>,
    /// The contents of the shape's file, if it has one.
    loaded: Option<Loaded>,
    rotation: Vec<f64>,
    velocities: Velocities<D>,
    mass: Option<Mass>,
    integrator: Option<Values>,
    models: Vec<Values>,
    pins: Vec<pins::Located<D>>,
    contact: Option<Values>,
    copies: Option<Copies<D>>,
    /// Whether the nodes of the body have no errors, so that selectors of nodes can be checked.
    shaped: bool,
    /// Whether the body has no errors at all.
    sound: bool,
}

impl<const D: usize> Draft<'_, D> {
    /// Whether one of the body's models owns the cells.
    fn owns_cells(&self) -> bool {
        self.models.iter().any(|model| model.spec().has_role(Role::OwnsCells))
    }
}

/// Reads all bodies, checks their cost, and then makes their meshes.
pub(crate) fn all<const D: usize>(reader: &mut Reader<'_>, root: &Node, seed: u64) -> Bodies<D> {
    let mut drafts: Vec<Draft<'_, D>> = Vec::new();
    for (node, path) in reader.list(root, "", "body") {
        if let Some(draft) = draft(reader, node, path, true) {
            drafts.push(draft);
        }
    }
    duplicate_names(reader, &drafts);
    let mut bodies = Bodies {
        list: Vec::new(),
        initial: 0,
        later: BTreeMap::new(),
        names: BTreeMap::new(),
        copied: BTreeMap::new(),
        cost: Cost::default(),
        broken: Vec::new(),
        unsound: BTreeSet::new(),
    };
    let affordable = within_limits(reader, &drafts, &mut bodies.cost);
    for (number, draft) in drafts.into_iter().enumerate() {
        let Some(body) = (if affordable { build(reader, &draft) } else { None }) else {
            bodies.broken.push(draft.name);
            continue;
        };
        let first = bodies.list.len();
        match draft.copies {
            Some(copies) => write_out(&mut bodies, copies, body, seed, number as u64),
            None => {
                bodies.names.entry(body.name.clone()).or_insert(first);
                bodies.list.push(body);
            }
        }
        if !draft.sound {
            bodies.unsound.extend(first..bodies.list.len());
        }
    }
    bodies.initial = bodies.list.len();
    bodies
}

/// Reads the bodies of `add` commands; other commands, loads and probes may name them.
pub(crate) fn later<const D: usize>(reader: &mut Reader<'_>, commands: &[(&Node, String)], bodies: &mut Bodies<D>) {
    let mut added: Vec<(f64, usize, BodyBlueprint<D>)> = Vec::new();
    let mut names = Names::of(What::Bodies);
    bodies.names.keys().chain(bodies.copied.keys()).for_each(|name| drop(names.take(name, (), |_| None)));
    for (number, (node, path)) in commands.iter().enumerate() {
        let (Some("add"), Some(at)) = (node.get("do").and_then(Node::text), node.get("body")) else { continue };
        let path = join(path, "body");
        let Some(body) = single::<D>(reader, at, path.clone(), &mut bodies.cost) else {
            bodies.broken.extend(at.get("name").and_then(Node::text).map(String::from));
            continue;
        };
        if let Some(error) = names.take(&body.name, (), |_| None) {
            reader.report(location_of(at, "name"), error.path(join(&path, "name")));
        }
        let time = match node.get("at").map(|n| &n.data) {
            Some(Data::Number(x, _)) => *x,
            Some(Data::Integer(Some(n), _)) => *n as f64,
            _ => 0.0,
        };
        added.push((time, number, body));
    }
    // The world numbers them in the order of their times.
    added.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (time, number, body) in added {
        bodies.later.insert(number, (bodies.list.len(), time));
        bodies.names.entry(body.name.clone()).or_insert(bodies.list.len());
        bodies.list.push(body);
    }
}

/// Reads the body of an `add` command.
fn single<const D: usize>(
    reader: &mut Reader<'_>,
    node: &Node,
    path: String,
    cost: &mut Cost,
) -> Option<BodyBlueprint<D>> {
    let drafts = vec![draft::<D>(reader, node, path, false)?];
    if !within_limits(reader, &drafts, cost) {
        return None;
    }
    build(reader, &drafts[0])
}

fn draft<'n, const D: usize>(
    reader: &mut Reader<'_>,
    node: &'n Node,
    path: String,
    may_copy: bool,
) -> Option<Draft<'n, D>> {
    if !matches!(node.data, Data::Table(_)) {
        reader.wrong_type(node, &path, Wanted::Table);
        return None;
    }
    let before = reader.count();
    let values = reader.fields(node, &path, &schema::BODY, None);
    let name = values.text("name").unwrap_or("").to_string();
    if let Some(at) = node.get("name").filter(|_| values.text("name").is_some()) {
        check_name(reader, at, &join(&path, "name"), &name);
    }
    let mass = mass(reader, node, &path, &values);
    let before_shape = reader.count();
    let shape = node
        .get("shape")
        .and_then(|shape| reader.kind_table(shape, &join(&path, "shape"), Part::Shape, &shapes::all()));
    let sound = reader.count() == before_shape;
    let loaded = shape.as_ref().and_then(|values| shape::loaded::<D>(reader, node, &path, values, sound));
    let rotation = reader.turn(node.get("rotation"), &join(&path, "rotation"));
    let velocities = velocities::at_the_start(reader, node, &path);
    let integrator = reader.integrator(node, &path);
    let kinds = reader.catalogue.models.clone();
    let mut models = Vec::new();
    for (item, here) in reader.list(node, &path, "models") {
        models.extend(reader.kind_table(item, &here, Part::Model, &kinds));
    }
    let mut pins = Vec::new();
    for (item, here) in reader.list(node, &path, "pin") {
        pins.extend(pins::pin(reader, item, &here));
    }
    let contact = node.get("contact").map(|at| reader.fields(at, &join(&path, "contact"), &schema::BODY_CONTACT, None));
    if values.flag("fixed") {
        let everything = PinBlueprint { select: Selector::All, axes: [true; D], motion: Vec::new() };
        pins.push((everything, node.location, join(&path, "fixed")));
    }
    let copies = match node.get("copies") {
        Some(at) if !may_copy => {
            reader.report(at.location, SceneError::of(BodyError::NoCopies {}).path(join(&path, "copies")));
            None
        }
        Some(at) => copies(reader, at, &join(&path, "copies")),
        None => None,
    };
    let sound = reader.count() == before;
    // If these fields are correct, so are the names and the positions of the nodes.
    const SHAPING: [&str; 6] = ["name", "shape", "position", "rotation", "scale", "copies"];
    let shaped =
        node.get("name").is_some() && SHAPING.iter().all(|field| reader.sound_since(before, &join(&path, field)));
    Some(Draft {
        node,
        path,
        name,
        values,
        shape,
        loaded,
        rotation,
        velocities,
        mass,
        integrator,
        models,
        pins,
        contact,
        copies,
        shaped,
        sound,
    })
}

/// Names occur in paths and in the heads of tables, so they must not contain the characters that separate the parts of paths and heads.
pub(crate) fn check_name(reader: &mut Reader<'_>, node: &Node, path: &str, name: &str) {
    let Some(fault) = validity::name_fault(name) else { return };
    reader.report(node.location, SceneError::of(fault).path(path).value(visible(name)));
}

/// The densities of the cells of a mesh, by their name in its file.
fn densities<const D: usize>(mesh: &Mesh<D>, name: &str) -> Result<Arc<[f64]>, SceneError> {
    let Some(numbers) = mesh.cell_values.get(name) else {
        let known: Vec<String> = mesh.cell_values.keys().map(|known| format!("`{}`", visible(known))).collect();
        let error = SceneError::of(BodyError::NoCellNumbers { name: visible(name) });
        return Err(match known.is_empty() {
            true => error.allows(SceneAllowed::ThereAreNone {}),
            false => error.allowed(known.join(", ")),
        });
    };
    match numbers.iter().position(|density| !(*density > 0.0 && density.is_finite())) {
        Some(cell) => Err(SceneError::of(BodyError::Density { cell, density: numbers[cell] })),
        None => Ok(Arc::from(numbers.as_slice())),
    }
}

/// Reads the mass: exactly one of mass, density, density_of_cells and node_mass.
fn mass(reader: &mut Reader<'_>, node: &Node, path: &str, values: &Values) -> Option<Mass> {
    const WORDS: [&str; 4] = ["mass", "density", "density_of_cells", "node_mass"];
    let given: Vec<&str> = WORDS.into_iter().filter(|w| node.get(w).is_some()).collect();
    match given.as_slice() {
        // The densities come with the mesh.
        ["density_of_cells"] => Some(Mass::DensityOfCells(Arc::from([]))),
        [word] => {
            let x = values.number(word)?;
            Some(match *word {
                "mass" => Mass::Total(x),
                "density" => Mass::Density(x),
                _ => Mass::Node(x),
            })
        }
        [] if values.flag("fixed") => Some(Mass::Node(1.0)),
        [] if reader.misspelt(node, &schema::BODY, None).iter().any(|meant| WORDS.contains(&meant.as_str())) => None,
        [] => {
            reader.report(node.location, SceneError::of(BodyError::NoMass {}).path(join(path, "mass")));
            None
        }
        several => {
            let about = BodyError::SeveralMasses { first: several[0].into(), second: several[1].into() };
            reader.report(location_of(node, several[1]), SceneError::of(about).path(join(path, several[1])));
            None
        }
    }
}

/// Reports names that occur twice or that look the same in print; both locations are named.
fn duplicate_names<const D: usize>(reader: &mut Reader<'_>, drafts: &[Draft<'_, D>]) {
    let mut names = Names::of(What::Bodies);
    for draft in drafts.iter().filter(|draft| !draft.name.is_empty()) {
        let location = location_of(draft.node, "name");
        let known = names.take(&draft.name, location, |first| reader.line_of(*first));
        if let Some(error) = known {
            let error = error.path(join(&draft.path, "name"));
            reader.report(location, error.advice(SceneHint::OwnName {}));
        }
    }
}

/// Adds the cost of bodies to the cost of the earlier bodies; returns whether the sum is within the limits.
fn within_limits<const D: usize>(reader: &mut Reader<'_>, drafts: &[Draft<'_, D>], cost: &mut Cost) -> bool {
    for draft in drafts {
        let nodes = match (&draft.loaded, &draft.shape) {
            (Some(loaded), _) => loaded.node_count(),
            (None, Some(shape)) => shapes::node_count(shape, D),
            (None, None) => 0.0,
        };
        // If there are nodes at the midpoints of edges, there is at most one node for every point of a grid with half the
        // spacing.
        let filling = draft.shape.as_ref().and_then(|shape| shape.text("filling"));
        let of_mesh = draft.shape.as_ref().is_some_and(|shape| shape.spec().has_role(Role::CellsFromFile));
        let filled = matches!(filling, Some("triangles" | "tetrahedra")) || (D == 3 && filling == Some("lattice"));
        let simplices = draft.values.flag("simplices") || filled || of_mesh;
        let quadratic = draft.values.integer("order").map_or(simplices && draft.owns_cells(), |order| order == 2);
        let nodes = if quadratic { nodes * f64::from(1 << D) } else { nodes };
        let (copies, models) = (draft.copies.map_or(1, |c| c.total()) as f64, draft.models.len() as f64);
        if let Err(error) = cost.add::<D>(copies, nodes, models, &reader.options.limits) {
            let key = if draft.copies.is_some() { "copies" } else { "shape" };
            reader.report(location_of(draft.node, key), SceneError::of(error).path(join(&draft.path, key)));
            return false;
        }
    }
    true
}

/// Divides boxes into simplices and adds nodes at the midpoints of edges, if the body asks for it.
fn of_wanted_cells<const D: usize>(reader: &mut Reader<'_>, draft: &Draft<'_, D>, mesh: Mesh<D>) -> Option<Mesh<D>> {
    let (simplices, order) = (draft.values.flag("simplices"), draft.values.integer("order"));
    let key = if order == Some(2) { "order" } else { "simplices" };
    let refuse = |reader: &mut Reader<'_>, error: SceneError| {
        reader.report(location_of(draft.node, key), error.path(join(&draft.path, key)));
        None
    };
    if (simplices || order == Some(2)) && mesh.cells.is_empty() {
        return refuse(reader, SceneError::of(BodyError::NoCells { field: key }));
    }
    let cut = if draft.values.integer("tetrahedra_per_hexahedron") == Some(5) { Cut::Five } else { Cut::Six };
    let cut = if simplices { mesh.into_simplices_by(cut) } else { Ok(mesh) };
    let wanted = |mesh: Mesh<D>| {
        let boxes = mesh.cells.quadrilaterals.len() + mesh.cells.hexahedra.len();
        let linear = mesh.cells.triangles.len() + mesh.cells.tetrahedra.len();
        // A body of finite elements consists of elements that do not lock, unless the scene says otherwise.
        let quadratic = order.map_or(draft.owns_cells() && boxes == 0 && linear > 0, |order| order == 2);
        if quadratic { mesh.into_quadratic() } else { Ok(mesh) }
    };
    match cut.and_then(wanted) {
        Ok(mesh) => Some(mesh),
        Err(error @ MeshError::NotSimplices { .. }) => {
            refuse(reader, SceneError::of(OutlineError::Mesh { error }).advice(SceneHint::Simplices {}))
        }
        Err(error) => refuse(reader, SceneError::of(OutlineError::Mesh { error })),
    }
}

/// The smallest scale for which the fourth power of a length does not become zero.
const SHORTEST: f64 = 1e-70;

/// Whether any number in a value exceeds the largest length allowed.
fn is_vast(node: &Node) -> bool {
    match &node.data {
        Data::Number(x, _) => x.abs() > LONGEST,
        Data::Array(items) => items.iter().any(is_vast),
        _ => false,
    }
}

/// Makes the mesh of a body, whatever other errors it has, and checks its pins.
fn build<const D: usize>(reader: &mut Reader<'_>, draft: &Draft<'_, D>) -> Option<BodyBlueprint<D>> {
    if !draft.shaped {
        return None;
    }
    let shape = draft.shape.as_ref()?;
    let transform = shapes::Transform { scale: draft.values.number("scale").unwrap_or(1.0), rotation: &draft.rotation };
    let shape_location = ShapeLocation {
        name: &draft.name,
        location: location_of(draft.node, "shape"),
        path: join(&draft.path, "shape"),
    };
    let vast = draft.node.get("shape").and_then(|shape| shape.entries().iter().find(|entry| is_vast(&entry.value)));
    if let Some(entry) = vast {
        let path = join(&shape_location.path, &entry.key);
        let about = BodyError::Vast { field: entry.key.clone(), value: entry.value.shown() };
        reader.report(entry.value.location, SceneError::of(about).path(path));
        return None;
    }
    if let Some(scale) = draft.node.get("scale").filter(|node| is_vast(node)) {
        let about = BodyError::Vast { field: "scale".into(), value: scale.shown() };
        reader.report(scale.location, SceneError::of(about).path(join(&draft.path, "scale")));
        return None;
    }
    if let Some(scale) = draft.node.get("scale").filter(|_| transform.scale < SHORTEST) {
        let error = SceneError::of(BodyError::Tiny { value: scale.shown() });
        reader.report(scale.location, error.path(join(&draft.path, "scale")));
        return None;
    }
    let mesh: Mesh<D> = shape::mesh(reader, shape, draft.loaded.as_ref(), &transform, &shape_location)?;
    if mesh.positions.iter().flatten().any(|x| x.abs() > LONGEST) {
        // The lengths of the shape itself are within the limit, so the scale, if there is one, is at fault.
        let key = if draft.node.get("scale").is_some() { "scale" } else { "shape" };
        let node = draft.node.get(key).unwrap_or(draft.node);
        let error = SceneError::of(BodyError::MadeVast { field: key, value: node.shown() });
        reader.report(node.location, error.path(join(&draft.path, key)));
        return None;
    }
    let mut mesh = of_wanted_cells(reader, draft, mesh)?;
    // Values of nodes are needed only at the start, so the body does not keep them.
    let values = std::mem::take(&mut mesh.node_values);
    let node_velocities = match draft.velocities.of_nodes(&values, shape.spec(), &draft.rotation) {
        Ok(velocities) => velocities,
        Err(error) => {
            let [velocity, of_nodes] = Velocities::<D>::OF_NODES;
            let node = draft.node.get(velocity).unwrap_or(draft.node);
            reader.report(location_of(node, of_nodes), error.path(join(&join(&draft.path, velocity), of_nodes)));
            return None;
        }
    };
    // One metre is a sensible depth for the plane, but not for the thickness of a cloth or the width of a wire.
    let thin = match mesh.measure() {
        Ok(Measure::Length(_)) => Some(BodyError::WireWidth {}),
        Ok(Measure::Area(_)) if D == 3 && !mesh.facets.is_empty() => Some(BodyError::WallThickness {}),
        Ok(Measure::Area(_)) if D == 3 => Some(BodyError::SheetThickness {}),
        _ => None,
    };
    if let (Some(Mass::Density(_)), Some(about), None) = (&draft.mass, thin, draft.node.get("thickness")) {
        let error = SceneError::of(about).path(join(&draft.path, "thickness"));
        reader.report(location_of(draft.node, "density"), error);
        return None;
    }
    let mass = match (&draft.mass, draft.values.text("density_of_cells")) {
        (Some(Mass::DensityOfCells(_)), Some(name)) => match densities(&mesh, name) {
            Ok(densities) => Mass::DensityOfCells(densities),
            Err(error) => {
                let error = error.path(join(&draft.path, "density_of_cells"));
                reader.report(location_of(draft.node, "density_of_cells"), error);
                return None;
            }
        },
        // A body without a mass is an error; it gets some mass only so that the search for errors can continue.
        (mass, _) => mass.clone().unwrap_or(Mass::Node(1.0)),
    };
    if mesh.skin.is_none()
        && let Some(contact) = draft.node.get("contact")
    {
        reader.no_effect(contact, &join(&draft.path, "contact"), "surface", BodyCondition::Lattice {});
    }
    let body = BodyBlueprint {
        name: draft.name.clone(),
        mesh: Arc::new(mesh),
        translation: draft.values.vector("position"),
        velocity: draft.velocities.linear,
        angular_velocity: draft.velocities.angular.clone(),
        velocity_gradient: draft.velocities.gradient,
        node_velocities,
        mass,
        thickness: draft.values.number("thickness").unwrap_or(1.0),
        integrator: draft.integrator.clone(),
        models: draft.models.clone(),
        pins: draft.pins.iter().map(|(pin, _, _)| pin.clone()).collect(),
        contact: draft.contact.clone(),
    };
    for (pin, location, path) in &draft.pins {
        selectors::check(reader, *location, path, &pin.select, &body);
    }
    pins::conflicts(reader, &draft.pins, &body);
    Some(body)
}
