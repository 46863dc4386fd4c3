//! From a world to what the renderer sees.
// Pictures are no physics: a last bit may differ.
#![allow(clippy::disallowed_methods)]

mod quantity;
mod rest;

use crate::World;
use crate::blueprint::{BodyBlueprint, PinBlueprint};
use crate::collide::Picture as Placed;
use crate::core::potential::Account;
use crate::draw::{
    AreaPicture, ArrowKind, ArrowPicture, BodyPicture, ColliderPicture, Facets, Picture, PullPicture, RestPicture,
    Sight,
};
use crate::mesh::{EdgeSet, Mesh, Skin, triangle_parts};
use opruga_core::spec::Role;
pub use quantity::Quantity;
use quantity::{push_quantity, strain};
pub use rest::rest_of;
use rest::{is_shown, rest_lines};

/// The most arrows of a body in a plane and in space, where those at the back are hidden.
const MOST_ARROWS: [usize; 2] = [40, 130];
/// Bodies up to which arrows are drawn: those of more could not be told apart.
const MOST_BODIES: usize = 64;

/// What stays the same from picture to picture: outlines, springs, rest lengths.
#[derive(Clone, Debug)]
pub struct Scenery {
    dimension: u8,
    title: String,
    y_down: bool,
    length_unit: String,
    credit: String,
    sight: Sight,
    panels: Option<u32>,
    /// What the colours tell where nobody asks for something else.
    quantity: Quantity,
    bodies: Vec<Fixed>,
}

#[derive(Clone, Debug)]
struct Fixed {
    /// Which of the bodies in its place it is; none where it is still to come.
    generation: Option<u64>,
    nodes: usize,
    facets: Facets,
    cells: Vec<[u32; 3]>,
    segments: Vec<[u32; 2]>,
    /// Edges and their rest lengths, for colouring by strain.
    edges: Vec<([u32; 2], f64)>,
    pinned: Vec<u32>,
    nodes_drawn: bool,
    /// The mean length of its edges at rest [m].
    node_spacing: f64,
    /// Its larger side at rest [m].
    extent: f64,
    /// Where it lay at the start, where that is shown.
    rest: RestPicture,
    label: String,
    /// The depth of a body in the plane [m].
    thickness: f64,
    /// The nodes at which arrows start, evenly spread.
    arrow_nodes: Vec<u32>,
    /// What is drawn instead of the facets.
    skin: Option<Skin>,
    /// The springs, where they are drawn whatever else is to be seen.
    springs: Option<Vec<[u32; 2]>>,
}

/// What changes from picture to picture, kept small.
#[derive(Clone, Debug)]
pub struct Moment {
    /// Time [s].
    pub time: f64,
    /// Coordinates of all nodes of all bodies, body by body [m].
    coordinates: Vec<f32>,
    /// What the colours tell.
    quantity: Quantity,
    /// That quantity at every node; for strains the coordinates are too coarse. Empty where bodies are plain.
    scalars: Vec<f32>,
    /// Bodies that are there.
    bodies: Vec<usize>,
    pulls: Vec<PullPicture>,
    colliders: Vec<ColliderPicture>,
    arrows: Vec<ArrowPicture>,
}

fn three<const D: usize>(x: [f64; D]) -> [f64; 3] {
    let mut out = [0.0; 3];
    out[..D].copy_from_slice(&x);
    out
}

impl Scenery {
    /// Looks at the bodies of a world, and at those that its commands will add.
    pub fn new<const D: usize>(world: &World<D>) -> Scenery {
        let (present, pictured) = (&world.blueprint().bodies, world.blueprint().picture);
        let many = present.len() > 64;
        // A body alone is told by the title, and copies have no names that say anything.
        let named = (2..=8).contains(&present.len()) && present.iter().all(|b| !b.name.contains('['));
        let fixed = |(place, blueprint): (usize, &BodyBlueprint<D>)| {
            let mesh = &blueprint.mesh;
            let edges = mesh.edges(EdgeSet::All);
            let length = |e: &[u32; 2]| {
                let (a, b) = (mesh.positions[e[0] as usize], mesh.positions[e[1] as usize]);
                a.iter().zip(&b).map(|(p, q)| (p - q) * (p - q)).sum::<f64>().sqrt()
            };
            // In a crowd the marks of pins would hide the bodies.
            let pins: &[PinBlueprint<D>] = if many { &[] } else { &blueprint.pins };
            let mut pinned: Vec<u32> =
                pins.iter().flat_map(|p| p.select.resolve(mesh, &blueprint.translation)).collect();
            pinned.sort_unstable();
            pinned.dedup();
            let surface: Vec<[u32; 3]> = if D == 3 {
                mesh.facets.iter().map(|f| [f[0], f[1], f[D - 1]]).chain(mesh.sheets.iter().copied()).collect()
            } else {
                Vec::new()
            };
            let mut cells = mesh.cells.triangles.clone();
            for q in &mesh.cells.quadrilaterals {
                cells.extend([[q[0], q[1], q[2]], [q[0], q[2], q[3]]]);
            }
            cells.extend(mesh.cells.quadratic_triangles.iter().flat_map(triangle_parts));
            let edges_length: f64 = edges.iter().map(length).sum();
            let side = |axis: usize| {
                let places = || mesh.positions.iter().map(move |position| position[axis]);
                places().fold(f64::NEG_INFINITY, f64::max) - places().fold(f64::INFINITY, f64::min)
            };
            let facets = if D == 2 {
                Facets::Edges(mesh.facets.iter().map(|f| [f[0], f[1]]).collect())
            } else {
                Facets::Triangles(surface)
            };
            let integrator = blueprint.integrator.as_ref().unwrap_or(&world.blueprint().integrator);
            let rest = if is_shown(blueprint, integrator.kind()) {
                let at = |x: &[f64; D]| three::<D>(core::array::from_fn(|d| x[d] + blueprint.translation[d]));
                rest_lines(&facets, mesh.positions.iter().map(at).collect())
            } else {
                RestPicture::default()
            };
            Fixed {
                generation: world.handle(place).map(|handle| handle.generation),
                extent: (0..D).map(side).fold(0.0, f64::max),
                rest,
                node_spacing: edges_length / edges.len().max(1) as f64,
                nodes: mesh.nodes(),
                facets,
                segments: if many || D == 3 && !mesh.facets.is_empty() { mesh.wires.clone() } else { edges.clone() },
                cells: if D == 2 { cells } else { Vec::new() },
                edges: edges.iter().map(|e| (*e, length(e))).collect(),
                nodes_drawn: world.blueprint().bodies.len() <= 2 && mesh.nodes() <= 64,
                pinned,
                label: if named { blueprint.name.clone() } else { String::new() },
                thickness: if D == 2 { blueprint.thickness } else { 1.0 },
                arrow_nodes: if present.len() <= MOST_BODIES { spread(mesh, MOST_ARROWS[D - 2]) } else { Vec::new() },
                skin: mesh.skin.clone(),
                springs: None,
            }
        };
        Scenery {
            dimension: D as u8,
            title: world.blueprint().title.clone(),
            bodies: present.iter().chain(world.coming_bodies()).enumerate().map(fixed).collect(),
            y_down: y_down(world),
            length_unit: world.blueprint().length_unit.clone(),
            credit: world.blueprint().credit.clone(),
            sight: Sight {
                region: pictured.region.map(|corners| corners.map(three)),
                azimuth: pictured.azimuth,
                elevation: pictured.elevation,
            },
            panels: pictured.panels,
            quantity: Quantity::of(present),
        }
    }

    /// Draws every spring and every node that it holds, and the body itself instead of a skin.
    pub fn show_springs<const D: usize>(&mut self, world: &World<D>) {
        let bodies = world.blueprint().bodies.iter().chain(world.coming_bodies());
        for (fixed, body) in self.bodies.iter_mut().zip(bodies) {
            // A body that no model can carry is told when it comes.
            fixed.springs = world.springs(body).ok();
        }
    }

    /// How many moments a film strip shows, where the scene says so.
    pub fn panels(&self) -> Option<usize> {
        self.panels.map(|panels| panels as usize)
    }

    /// Whether y counts downwards.
    pub fn y_down(&self) -> bool {
        self.y_down
    }

    /// Keeps what a world looks like now; with arrows also pulls, and the pressure on the bodies with gas [Pa] or the
    /// force on the nodes of the others [N].
    pub fn capture<const D: usize>(&self, world: &mut World<D>, arrows: bool) -> Moment {
        self.capture_quantity(world, arrows, self.quantity)
    }

    /// As [`Scenery::capture`], with another quantity for the colours.
    pub fn capture_quantity<const D: usize>(&self, world: &mut World<D>, arrows: bool, quantity: Quantity) -> Moment {
        let (mut coordinates, mut scalars) = (Vec::new(), Vec::new());
        // A body that has taken the place of one of these since is unknown here.
        let known = |body: &usize| {
            let fixed = self.bodies.get(*body);
            fixed.is_some_and(|fixed| match (fixed.generation, world.handle(*body)) {
                (Some(generation), Some(handle)) => generation == handle.generation,
                _ => fixed.nodes == world.node_count(*body),
            })
        };
        let bodies: Vec<usize> = world.bodies().filter(known).collect();
        for &body in &bodies {
            let fixed = &self.bodies[body];
            let positions: Vec<[f64; 3]> = (0..fixed.nodes as u32).map(|n| three(world.position(body, n))).collect();
            coordinates.extend(positions.iter().flat_map(|position| position[..D].iter().map(|c| *c as f32)));
            match quantity {
                Quantity::Strain => scalars.extend(strain(fixed, &positions).into_iter().map(|s| s as f32)),
                _ => push_quantity(world, body, fixed.nodes, quantity, &mut scalars),
            }
        }
        let pulls: Vec<PullPicture> = world
            .pulls()
            .into_iter()
            .map(|(node, pointer, _)| PullPicture { node: three(node), pointer: three(pointer) })
            .collect();
        let mut drawn = Vec::new();
        if arrows {
            if bodies.len() <= MOST_BODIES {
                bodies.iter().for_each(|&body| self.push_arrows(world, body, &mut drawn));
            }
            for (node, _, force) in world.pulls() {
                drawn.push(ArrowPicture { kind: ArrowKind::Pull, from: three(node), vector: three(force) });
            }
        }
        let colliders =
            world.colliders().map_or_else(Vec::new, |c| c.pictures(world.time()).into_iter().map(collider).collect());
        Moment { time: world.time(), coordinates, quantity, scalars, bodies, pulls, colliders, arrows: drawn }
    }

    /// Adds the arrows of a body: the pressure of its gas at some of its nodes, or without gas the force on them.
    fn push_arrows<const D: usize>(&self, world: &mut World<D>, body: usize, arrows: &mut Vec<ArrowPicture>) {
        let fixed = &self.bodies[body];
        let gas = world.blueprint().bodies[body].models.iter().any(|model| model.spec().has_role(Role::Gas));
        let mut forces = world.node_forces(body, gas.then_some(Account::Gas));
        let kind = if gas {
            // The force on a node over the surface that belongs to it.
            let positions: Vec<[f64; 3]> = (0..fixed.nodes as u32).map(|n| three(world.position(body, n))).collect();
            for (force, surface) in forces.iter_mut().zip(surfaces(fixed, &positions)) {
                *force = if surface > 0.0 { force.map(|f| f / surface) } else { [0.0; D] };
            }
            ArrowKind::Pressure
        } else {
            ArrowKind::Force
        };
        for &node in &fixed.arrow_nodes {
            if let Some(force) = forces.get(node as usize).filter(|force| force.iter().any(|f| *f != 0.0)) {
                arrows.push(ArrowPicture { kind, from: three(world.position(body, node)), vector: three(*force) });
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

/// The skin that a body carries, coloured as the nodes that carry it.
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

/// The areas of a drawing that a flat body carries: those with colours of their own where the colours of the body tell
/// nothing, else its silhouette.
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
        // Its points were counted ring by ring.
        let first = area.rings.first().and_then(|ring| ring.first()).copied().unwrap_or(0);
        picture.triangles = area.triangles.iter().map(|t| t.map(|point| point - first)).collect();
        picture
    });
    drawn.collect()
}

/// Whether y counts downwards in a plane: gravity says so, or where there is none, the floor.
fn y_down<const D: usize>(world: &World<D>) -> bool {
    let gravity = world.blueprint().surroundings.gravity[1];
    if D != 2 || gravity != 0.0 {
        return D == 2 && gravity > 0.0;
    }
    let pictures = world.colliders().map_or_else(Vec::new, |colliders| colliders.pictures(world.time()));
    let mut floors = pictures.iter().filter_map(|placed| match placed {
        Placed::HalfSpace { normal, .. } if normal[1] != 0.0 => Some(normal[1] < 0.0),
        _ => None,
    });
    floors.next() == Some(true) && floors.all(|down| down)
}

/// An obstacle as the renderer knows it. A box that is turned is drawn by its outline or faces.
fn collider<const D: usize>(placed: Placed<D>) -> ColliderPicture {
    let points = |points: Vec<[f64; D]>| -> Vec<[f64; 3]> { points.into_iter().map(three).collect() };
    match placed {
        Placed::HalfSpace { point, normal } => {
            ColliderPicture::HalfSpace { point: three(point), normal: three(normal) }
        }
        Placed::Ball { center, radius, .. } => ColliderPicture::Ball { center: three(center), radius },
        Placed::Capsule { a, b, radius } => ColliderPicture::Capsule { a: three(a), b: three(b), radius },
        Placed::Polygon { points: p } => ColliderPicture::Polygon(points(p)),
        Placed::Polyline { points: p, closed } => {
            let mut p = points(p);
            if closed && let Some(first) = p.first().copied() {
                p.push(first);
            }
            ColliderPicture::Polyline(p)
        }
        Placed::Triangles { points: p, triangles, .. } => ColliderPicture::Mesh { positions: points(p), triangles },
        Placed::Box { corners, inside } => {
            let corners = points(corners);
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
            if D == 2 {
                return ColliderPicture::Polygon(vec![corners[0], corners[1], corners[3], corners[2]]);
            }
            // Corner k lies on the upper side of axis d where bit d of k is set.
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

/// Up to so many nodes of a body, each as far as possible from those before it.
fn spread<const D: usize>(mesh: &Mesh<D>, most: usize) -> Vec<u32> {
    if mesh.nodes() <= most {
        return (0..mesh.nodes() as u32).collect();
    }
    let mut chosen = vec![0_u32];
    let mut gaps = vec![f64::INFINITY; mesh.nodes()];
    while chosen.len() < most {
        let last = mesh.positions[chosen[chosen.len() - 1] as usize];
        let mut farthest = 0;
        for (node, position) in mesh.positions.iter().enumerate() {
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

/// The surface that belongs to each node [m²]: half of the edges in a plane, a third of the triangles in space.
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
