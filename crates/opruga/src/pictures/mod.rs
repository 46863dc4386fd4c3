//! Converts a world to a picture for the renderer.
// Pictures are not physics: the last bit may differ.
#![allow(clippy::disallowed_methods)]

mod quantity;
mod rest;

use crate::collide::Picture as Placed;
use crate::core::potential::Account;
use crate::draw::{
    AreaPicture, ArrowKind, ArrowPicture, BodyPicture, ColliderPicture, Facets, Picture, PullPicture, RestPicture,
    Sight,
};
use crate::mesh::{Skin, triangle_parts};
use crate::{AnyBody, AnyScene, AnyWorld};
use opruga_core::spec::Role;
pub use quantity::Quantity;
use quantity::{push_quantity, strain};
pub use rest::rest_of;
use rest::{is_shown, rest_lines};

/// The largest number of arrows of a body: in the plane, and in space, where the arrows at the back are hidden.
const MOST_ARROWS: [usize; 2] = [40, 130];
/// The largest number of bodies for which arrows are drawn; with more, the arrows could not be distinguished.
const MOST_BODIES: usize = 64;

/// The data that stay the same from picture to picture: outlines, springs, rest lengths.
#[derive(Clone, Debug)]
pub struct Scenery {
    dimension: u8,
    title: String,
    y_down: bool,
    length_unit: String,
    credit: String,
    sight: Sight,
    panels: Option<u32>,
    /// The quantity that the colours show by default.
    quantity: Quantity,
    bodies: Vec<Fixed>,
}

#[derive(Clone, Debug)]
struct Fixed {
    /// The generation of the body with this index; none if it is added later.
    generation: Option<u64>,
    nodes: usize,
    facets: Facets,
    cells: Vec<[u32; 3]>,
    segments: Vec<[u32; 2]>,
    /// The distance that contact keeps between wires, if the scene gives it [m].
    wire_width: f64,
    /// The edges and their rest lengths, from which the strain is computed for the colours.
    edges: Vec<([u32; 2], f64)>,
    pinned: Vec<u32>,
    nodes_drawn: bool,
    /// The mean length of the edges of the body at rest [m].
    node_spacing: f64,
    /// The larger side of the body at rest [m].
    extent: f64,
    /// The outline or the sharp edges of the body at its initial position, if these are shown.
    rest: RestPicture,
    label: String,
    /// The depth of a body in the plane [m].
    thickness: f64,
    /// The nodes at which arrows start, uniformly distributed.
    arrow_nodes: Vec<u32>,
    /// The skin that is drawn instead of the facets.
    skin: Option<Skin>,
    /// The springs, if they are drawn whatever the other options are.
    springs: Option<Vec<[u32; 2]>>,
}

/// The data that change from picture to picture, in compact form.
#[derive(Clone, Debug)]
pub struct Moment {
    /// Time [s].
    pub time: f64,
    /// Coordinates of all nodes of all bodies, body by body [m].
    coordinates: Vec<f32>,
    /// The quantity that the colours show.
    quantity: Quantity,
    /// The value of that quantity at every node. The quantity is computed before the coordinates are rounded, because rounded coordinates are not
    /// precise enough for strains. Empty if bodies have plain colours.
    scalars: Vec<f32>,
    /// The existing bodies.
    bodies: Vec<usize>,
    pulls: Vec<PullPicture>,
    colliders: Vec<ColliderPicture>,
    arrows: Vec<ArrowPicture>,
}

impl Scenery {
    /// Prepares the bodies of a world, including those that its commands will add.
    pub fn new(world: &dyn AnyWorld) -> Scenery {
        let (scene, pictured) = (world.scene(), world.scene().pictured());
        let (present, flat) = (scene.body_count(), scene.dimension() == 2);
        let many = present > 64;
        // The title names a single body, and the names of copies carry no information.
        let named = (2..=8).contains(&present) && scene.bodies().all(|body| !body.name().contains('['));
        let fixed = |(number, body): (usize, &dyn AnyBody)| {
            let positions = body.rest_positions();
            let edges = body.edges();
            let length = |e: &[u32; 2]| {
                let (a, b) = (positions[e[0] as usize], positions[e[1] as usize]);
                a.iter().zip(&b).map(|(p, q)| (p - q) * (p - q)).sum::<f64>().sqrt()
            };
            // In a crowd, the marks of pins would hide the bodies.
            let pinned = if many { Vec::new() } else { body.pinned_nodes() };
            let edges_length: f64 = edges.iter().map(length).sum();
            let side = |axis: usize| {
                let coordinates = || positions.iter().map(move |position| position[axis]);
                coordinates().fold(f64::NEG_INFINITY, f64::max) - coordinates().fold(f64::INFINITY, f64::min)
            };
            let facets = if flat {
                Facets::Edges(body.facets().as_chunks().0.to_vec())
            } else {
                Facets::Triangles([body.facets().as_chunks().0, body.sheets()].concat())
            };
            let rest = if is_shown(body, scene.integrator()) {
                let translation = body.translation();
                let at = |x: &[f64; 3]| core::array::from_fn(|d| x[d] + translation[d]);
                rest_lines(&facets, positions.iter().map(at).collect())
            } else {
                RestPicture::default()
            };
            let arrows = if present <= MOST_BODIES { MOST_ARROWS[usize::from(!flat)] } else { 0 };
            Fixed {
                generation: world.handle(number).map(|handle| handle.generation),
                extent: (0..scene.dimension()).map(side).fold(0.0, f64::max),
                rest,
                node_spacing: edges_length / edges.len().max(1) as f64,
                nodes: positions.len(),
                segments: if many || !flat && !body.facets().is_empty() {
                    body.wires().to_vec()
                } else {
                    edges.clone()
                },
                facets,
                wire_width: wire_width(scene, body),
                cells: if flat { triangles(body) } else { Vec::new() },
                edges: edges.iter().map(|e| (*e, length(e))).collect(),
                nodes_drawn: present <= 2 && positions.len() <= 64,
                pinned,
                label: if named { body.name().to_string() } else { String::new() },
                thickness: if flat { body.thickness() } else { 1.0 },
                arrow_nodes: spread(&positions, arrows),
                skin: body.skin().cloned(),
                springs: None,
            }
        };
        Scenery {
            dimension: scene.dimension() as u8,
            title: scene.title().to_string(),
            bodies: scene.bodies().chain(world.coming_bodies()).enumerate().map(fixed).collect(),
            y_down: y_down(world),
            length_unit: scene.length_unit().to_string(),
            credit: scene.credit().to_string(),
            sight: Sight { region: pictured.region, azimuth: pictured.azimuth, elevation: pictured.elevation },
            panels: pictured.panels,
            quantity: Quantity::of(scene),
        }
    }

    /// Makes the pictures show every spring with the nodes that it connects, and the body itself instead of its skin.
    pub fn show_springs(&mut self, world: &dyn AnyWorld) {
        for (number, fixed) in self.bodies.iter_mut().enumerate() {
            // If a model refuses a body, the world reports this when the body is added.
            fixed.springs = world.springs_of(number);
        }
    }

    /// The number of moments on a film strip, if the scene gives it.
    pub fn panels(&self) -> Option<usize> {
        self.panels.map(|panels| panels as usize)
    }

    /// Whether y points downwards.
    pub fn y_down(&self) -> bool {
        self.y_down
    }

    /// Captures the present picture of a world. If `arrows` is set, it also contains the pulls and, at the nodes, the pressure on bodies with gas
    /// [Pa] or the force on other bodies [N].
    pub fn capture(&self, world: &mut dyn AnyWorld, arrows: bool) -> Moment {
        self.capture_quantity(world, arrows, self.quantity)
    }

    /// Does the same as [`Scenery::capture`] with another quantity for the colours.
    pub fn capture_quantity(&self, world: &mut dyn AnyWorld, arrows: bool, quantity: Quantity) -> Moment {
        let (mut coordinates, mut scalars) = (Vec::new(), Vec::new());
        // A body that has replaced one of these since [`Scenery::new`] is unknown here.
        let known = |body: &usize| {
            let fixed = self.bodies.get(*body);
            fixed.is_some_and(|fixed| match (fixed.generation, world.handle(*body)) {
                (Some(generation), Some(handle)) => generation == handle.generation,
                _ => fixed.nodes == world.node_count(*body),
            })
        };
        let bodies: Vec<usize> = world.bodies().into_iter().filter(known).collect();
        for &body in &bodies {
            let fixed = &self.bodies[body];
            let positions: Vec<[f64; 3]> = world.positions(body).iter().collect();
            let dimension = usize::from(self.dimension);
            coordinates.extend(positions.iter().flat_map(|position| position[..dimension].iter().map(|c| *c as f32)));
            match quantity {
                Quantity::Strain => scalars.extend(strain(fixed, &positions).into_iter().map(|s| s as f32)),
                _ => push_quantity(world, body, fixed.nodes, quantity, &mut scalars),
            }
        }
        let present = world.pulls();
        let pulls = present.iter().map(|[node, pointer, _]| PullPicture { node: *node, pointer: *pointer }).collect();
        let mut drawn = Vec::new();
        if arrows {
            if bodies.len() <= MOST_BODIES {
                bodies.iter().for_each(|&body| self.push_arrows(world, body, &mut drawn));
            }
            let pull =
                |[node, _, force]: [[f64; 3]; 3]| ArrowPicture { kind: ArrowKind::Pull, from: node, vector: force };
            drawn.extend(present.into_iter().map(pull));
        }
        let colliders = world.obstacles().into_iter().map(collider).collect();
        Moment { time: world.time(), coordinates, quantity, scalars, bodies, pulls, colliders, arrows: drawn }
    }

    /// Adds arrows to a body: at some of its nodes, they show the pressure of its gas or, without gas, the force on the node.
    fn push_arrows(&self, world: &mut dyn AnyWorld, body: usize, arrows: &mut Vec<ArrowPicture>) {
        let fixed = &self.bodies[body];
        let gas = world.scene().body(body).is_some_and(|body| body.has_role(Role::Gas));
        let mut forces = world.forces(body, gas.then_some(Account::Gas));
        let positions: Vec<[f64; 3]> = world.positions(body).iter().collect();
        let kind = if gas {
            // The force on a node divided by the surface that belongs to it.
            for (force, surface) in forces.iter_mut().zip(surfaces(fixed, &positions)) {
                *force = if surface > 0.0 { force.map(|f| f / surface) } else { [0.0; 3] };
            }
            ArrowKind::Pressure
        } else {
            ArrowKind::Force
        };
        for &node in &fixed.arrow_nodes {
            if let Some(force) = forces.get(node as usize).filter(|force| force.iter().any(|f| *f != 0.0)) {
                arrows.push(ArrowPicture { kind, from: positions[node as usize], vector: *force });
            }
        }
    }

    /// The picture of a moment.
    pub fn picture(&self, moment: &Moment) -> Picture {
        let mut bodies = Vec::new();
        let mut coordinates = moment.coordinates.chunks_exact(usize::from(self.dimension));
        let mut scalars = moment.scalars.iter().map(|scalar| f64::from(*scalar));
        for &body in &moment.bodies {
            let fixed = &self.bodies[body];
            let positions: Vec<[f64; 3]> = coordinates
                .by_ref()
                .take(fixed.nodes)
                .map(|c| [f64::from(c[0]), f64::from(c[1]), c.get(2).map_or(0.0, |z| f64::from(*z))])
                .collect();
            let scalar: Vec<f64> = scalars.by_ref().take(fixed.nodes).collect();
            let skin = fixed.skin.as_ref().filter(|_| fixed.springs.is_none());
            if let Some(skin) = skin.filter(|_| self.dimension == 3) {
                bodies.push(skinned(skin, &positions, &scalar, &fixed.label));
                continue;
            }
            let areas = skin.map_or_else(Vec::new, |skin| areas(skin, &positions, moment.quantity));
            bodies.push(BodyPicture {
                scalar,
                positions,
                facets: fixed.facets.clone(),
                cells: fixed.cells.clone(),
                segments: fixed.springs.as_ref().unwrap_or(&fixed.segments).clone(),
                spring_width: if fixed.springs.is_none() { fixed.wire_width } else { 0.0 },
                colour: None,
                outlined: None,
                nodes_drawn: (fixed.nodes_drawn && areas.is_empty()) || fixed.springs.is_some(),
                node_spacing: fixed.springs.is_none().then_some(fixed.node_spacing),
                extent: fixed.springs.is_none().then_some(fixed.extent),
                rest: fixed.rest.clone(),
                areas,
                pinned: fixed.pinned.clone(),
                label: fixed.label.clone(),
            });
        }
        Picture {
            dimension: self.dimension,
            time: moment.time,
            title: self.title.clone(),
            credit: self.credit.clone(),
            sight: self.sight,
            bodies,
            colliders: moment.colliders.clone(),
            arrows: moment.arrows.clone(),
            pulls: moment.pulls.clone(),
            y_down: self.y_down,
            length_unit: self.length_unit.clone(),
            legend: moment.quantity.legend(),
        }
    }
}

/// The distance that contact keeps between the wires of a body without a surface, if the scene gives it; otherwise 0 [m].
fn wire_width(scene: &dyn AnyScene, body: &dyn AnyBody) -> f64 {
    let Some(contact) = scene.contact().filter(|_| body.facets().is_empty() && body.sheets().is_empty()) else {
        return 0.0;
    };
    let own = body.contact().and_then(|own| own.number("thickness"));
    own.or_else(|| contact.values.number("thickness")).unwrap_or(0.0)
}

/// The triangles that fill the cells of a body in a plane.
fn triangles(body: &dyn AnyBody) -> Vec<[u32; 3]> {
    let cells = body.cells();
    let mut triangles = cells.triangles.clone();
    for q in &cells.quadrilaterals {
        triangles.extend([[q[0], q[1], q[2]], [q[0], q[2], q[3]]]);
    }
    triangles.extend(cells.quadratic_triangles.iter().flat_map(triangle_parts));
    triangles
}

/// The skin that a body carries, with the colours of the nodes that carry it.
fn skinned(skin: &Skin, positions: &[[f64; 3]], scalar: &[f64], label: &str) -> BodyPicture {
    BodyPicture {
        scalar: if scalar.is_empty() { Vec::new() } else { skin.values(scalar) },
        positions: skin.positions(positions),
        facets: Facets::Triangles(skin.triangles.clone()),
        cells: Vec::new(),
        segments: Vec::new(),
        label: label.into(),
        ..BodyPicture::default()
    }
}

/// The areas of a drawing that a flat body carries: its coloured areas if the body has no colours of its own, otherwise its silhouette.
fn areas(skin: &Skin, positions: &[[f64; 3]], quantity: Quantity) -> Vec<AreaPicture> {
    let painted = quantity == Quantity::Plain && skin.areas.iter().any(|area| area.colour.is_some());
    let seen = skin.areas.iter().filter(|area| area.colour.is_some() == painted);
    let points = skin.positions(positions);
    let drawn = seen.map(|area| {
        let mut picture = AreaPicture { colour: area.colour, ..AreaPicture::default() };
        for ring in &area.rings {
            picture.positions.extend(ring.iter().map(|point| points[*point as usize]));
            picture.ends.push(picture.positions.len());
        }
        // Its points are numbered ring by ring.
        let first = area.rings.first().and_then(|ring| ring.first()).copied().unwrap_or(0);
        picture.triangles = area.triangles.iter().map(|t| t.map(|point| point - first)).collect();
        picture
    });
    drawn.collect()
}

/// Whether y points downwards in the plane, according to gravity or, if there is none, to the floor.
fn y_down(world: &dyn AnyWorld) -> bool {
    let &[_, gravity] = world.scene().gravity() else { return false };
    if gravity != 0.0 {
        return gravity > 0.0;
    }
    let obstacles = world.obstacles();
    let mut floors = obstacles.iter().filter_map(|placed| match placed {
        Placed::HalfSpace { normal, .. } if normal[1] != 0.0 => Some(normal[1] < 0.0),
        _ => None,
    });
    floors.next() == Some(true) && floors.all(|down| down)
}

/// An obstacle in the form for the renderer. A rotated box is drawn by its outline or its faces.
fn collider(placed: Placed<3>) -> ColliderPicture {
    match placed {
        Placed::HalfSpace { point, normal } => ColliderPicture::HalfSpace { point, normal },
        Placed::Ball { center, radius, .. } => ColliderPicture::Ball { center, radius },
        Placed::Capsule { a, b, radius } => ColliderPicture::Capsule { a, b, radius },
        Placed::Polygon { points } => ColliderPicture::Polygon(points),
        Placed::Polyline { points: mut p, closed } => {
            if closed && let Some(first) = p.first().copied() {
                p.push(first);
            }
            ColliderPicture::Polyline(p)
        }
        Placed::Triangles { points, triangles, .. } => ColliderPicture::Mesh { positions: points, triangles },
        Placed::Box { corners, inside } => {
            let (mut min, mut max) = (corners[0], corners[0]);
            for corner in &corners {
                for d in 0..3 {
                    min[d] = min[d].min(corner[d]);
                    max[d] = max[d].max(corner[d]);
                }
            }
            let straight = corners.iter().all(|c| (0..3).all(|d| c[d] == min[d] || c[d] == max[d]));
            if straight || inside {
                return ColliderPicture::Box { min, max, inside };
            }
            if let [a, b, c, d] = corners[..] {
                return ColliderPicture::Polygon(vec![a, b, d, c]);
            }
            // Corner k is on the upper side of axis d if bit d of k is set.
            let mut triangles = Vec::new();
            for axis in 0..3u32 {
                let (u, v) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
                for side in [0, 1 << axis] {
                    triangles.extend([[side, side + u, side + u + v], [side, side + u + v, side + v]]);
                }
            }
            ColliderPicture::Mesh { positions: corners, triangles }
        }
    }
}

/// Chooses up to `most` nodes of a body, each as far as possible from those chosen before it.
fn spread(positions: &[[f64; 3]], most: usize) -> Vec<u32> {
    if positions.len() <= most {
        return (0..positions.len() as u32).collect();
    }
    let mut chosen = Vec::with_capacity(most);
    chosen.extend((most > 0).then_some(0_u32));
    let mut gaps = vec![f64::INFINITY; positions.len()];
    while chosen.len() < most {
        let last = positions[chosen[chosen.len() - 1] as usize];
        let mut farthest = 0;
        for (node, position) in positions.iter().enumerate() {
            let gap = position.iter().zip(&last).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
            gaps[node] = gaps[node].min(gap);
            if gaps[node] > gaps[farthest] {
                farthest = node;
            }
        }
        chosen.push(farthest as u32);
    }
    chosen
}

/// The surface that belongs to each node [m²]: half of each adjacent edge in the plane, a third of each adjacent triangle in space.
fn surfaces(fixed: &Fixed, positions: &[[f64; 3]]) -> Vec<f64> {
    let mut out = vec![0.0; fixed.nodes];
    let arm =
        |a: u32, b: u32| -> [f64; 3] { std::array::from_fn(|d| positions[b as usize][d] - positions[a as usize][d]) };
    let size = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    match &fixed.facets {
        Facets::Edges(edges) => {
            for [a, b] in edges {
                let share = 0.5 * size(arm(*a, *b)) * fixed.thickness;
                [a, b].into_iter().for_each(|node| out[*node as usize] += share);
            }
        }
        Facets::Triangles(triangles) => {
            for [a, b, c] in triangles {
                let (u, v) = (arm(*a, *b), arm(*a, *c));
                let area = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
                [a, b, c].into_iter().for_each(|node| out[*node as usize] += size(area) / 6.0);
            }
        }
    }
    out
}
