//! Whether surfaces of a world cross: a check that shares no code with the detection of contact.

mod at_start;

use crate::contact_laws::laws;
use crate::error::Crossing;
use crate::warnings::{Warning, WorldWarning};
use crate::world::World;
use opruga_collide::{Laws, Picture};
use opruga_mesh::{Crossings, Mesh, crossing_edges, winding_number};

/// Two bodies, or a body and itself, whose surfaces cross.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crossed {
    /// The bodies, by their index in the scene.
    pub bodies: [usize; 2],
    /// A facet of each surface, numbered in this order: boundary or skin, open surfaces, wires. None if one body lies inside the other without
    /// crossing it.
    pub facets: Option<[u32; 2]>,
}

impl Crossing {
    /// What two bodies do, given their names.
    pub fn of(crossed: &Crossed, name: impl Fn(usize) -> String) -> Crossing {
        let [first, second] = crossed.bodies;
        let (body, other) = (name(first), name(second));
        match crossed.facets {
            None => Crossing::Inside { body, other },
            Some([first, second]) if body == other => Crossing::Within { first, second, body },
            Some([first, second]) => Crossing::Between { first, body, second, other },
        }
    }
}

/// A body with points inside another body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// The body to which the points belong, and the body that contains them, by their index in the scene.
    pub bodies: [usize; 2],
    /// The fraction of the points of its surface that are inside.
    pub share: f64,
}

/// The present surfaces of some bodies as one mesh.
struct Surfaces<const D: usize> {
    positions: Vec<[f64; D]>,
    /// Boundaries, open surfaces, and, in the plane, wires.
    facets: Vec<[u32; D]>,
    /// The body of every facet, and the number of the facet in it.
    origin: Vec<(usize, u32)>,
    /// The closed boundaries of bodies.
    closed: Vec<Boundary<D>>,
}

/// A closed boundary: its body, the range of its facets, and its bounding box.
struct Boundary<const D: usize> {
    body: usize,
    facets: core::ops::Range<usize>,
    bounds: [[f64; D]; 2],
}

impl<const D: usize> World<D> {
    /// Surfaces that cross, and bodies that lie inside one another, among the bodies that contact keeps apart. There is one pair of facets for each
    /// pair of bodies, in ascending order. Without a section `[contact]` all bodies are checked, but no body against itself.
    ///
    /// The check is exact for the given coordinates. Wires in space are not checked.
    pub fn crossed_surfaces(&self) -> Vec<Crossed> {
        self.crossed_among(|_| true, |surfaces| surfaces).0
    }

    /// Surfaces that cross, among the pairs of bodies that `asked` accepts, and the surfaces as `changed` returns them.
    fn crossed_among(
        &self,
        asked: impl Fn([usize; 2]) -> bool,
        changed: impl FnOnce(Surfaces<D>) -> Surfaces<D>,
    ) -> (Vec<Crossed>, Surfaces<D>) {
        let (bodies, laws) = self.kept_apart();
        let index = |body: usize| bodies.binary_search(&body).unwrap_or(0) as u32;
        let touch = |a: usize, b: usize| laws.as_ref().map_or(a != b, |laws| laws.meet(index(a), index(b)));
        let meet = |a: usize, b: usize| asked([a, b]) && touch(a, b);
        // Most bodies are far from all others, so a sweep along x keeps only the boxes that overlap the present x.
        let bounds: Vec<[[f64; D]; 2]> = bodies.iter().map(|body| self.bounds_of(*body)).collect();
        let mut order: Vec<usize> = (0..bodies.len()).collect();
        order.sort_by(|a, b| bounds[*a][0][0].total_cmp(&bounds[*b][0][0]));
        let mut is_close: Vec<bool> = bodies.iter().map(|body| meet(*body, *body)).collect();
        let mut over: Vec<usize> = Vec::new();
        for a in order {
            over.retain(|b| bounds[*b][1][0] >= bounds[a][0][0]);
            for b in &over {
                if overlap(&bounds[a], &bounds[*b]) && meet(bodies[a], bodies[*b]) {
                    (is_close[a], is_close[*b]) = (true, true);
                }
            }
            over.push(a);
        }
        let close: Vec<usize> =
            bodies.iter().zip(&is_close).filter(|(_, close)| **close).map(|(body, _)| *body).collect();
        let surfaces = changed(self.surfaces(&close));
        let mut found: Vec<Crossed> = Vec::new();
        for [first, second] in surfaces.crossings().pairs {
            let (mut a, mut b) = (surfaces.origin[first as usize], surfaces.origin[second as usize]);
            if a.0 > b.0 {
                (a, b) = (b, a);
            }
            if meet(a.0, b.0) {
                found.push(Crossed { bodies: [a.0, b.0], facets: Some([a.1, b.1]) });
            }
        }
        found.extend(surfaces.nested().into_iter().filter(|crossed| meet(crossed.bodies[0], crossed.bodies[1])));
        found.sort_by_key(|crossed| (crossed.bodies, crossed.facets.is_none()));
        found.dedup_by_key(|crossed| crossed.bodies);
        (found, surfaces)
    }

    /// The bodies that contact keeps apart, and the laws of their pairs. Without a section `[contact]`, these are all bodies, and there are no laws.
    fn kept_apart(&self) -> (Vec<usize>, Option<Laws>) {
        let there = (0..self.blueprint.bodies.len()).filter(|body| self.handle(*body).is_some());
        let contact = self.blueprint.contact.as_ref();
        let bodies: Vec<usize> = there.filter(|b| contact.is_none() || self.blueprint.bodies[*b].touches()).collect();
        let laws = contact.map(|contact| laws(&self.blueprint, contact, &bodies, 1.0));
        (bodies, laws)
    }

    /// Bodies with points inside the closed boundary of another body, in ascending order. Only the bodies that contact keeps apart are checked, or
    /// all bodies without a section `[contact]`. The check shares no code with the detection of contact.
    pub fn overlaps(&self) -> Vec<Overlap> {
        let (bodies, laws) = self.kept_apart();
        let surfaces = self.surfaces(&bodies);
        let points = surfaces.points_of(&bodies);
        let mut found = Vec::new();
        for (inner, own) in bodies.iter().enumerate() {
            for boundary in &surfaces.closed {
                let other = bodies.binary_search(&boundary.body).unwrap_or(inner);
                if other == inner || laws.as_ref().is_some_and(|laws| !laws.meet(inner as u32, other as u32)) {
                    continue;
                }
                let inside = points[inner].iter().filter(|p| surfaces.is_inside(boundary, **p)).count();
                if inside > 0 {
                    let share = inside as f64 / points[inner].len() as f64;
                    found.push(Overlap { bodies: [*own, boundary.body], share });
                }
            }
        }
        found
    }

    /// The bounding box of the nodes of a body [m].
    pub(crate) fn bounds_of(&self, body: usize) -> [[f64; D]; 2] {
        let nodes = 0..self.blueprint.bodies[body].mesh.nodes() as u32;
        bounds(nodes.map(|node| self.position(body, node)))
    }

    /// Warns once about bodies that pass through one another in a scene without contact. Call it after every frame. The check runs in frames 1, 2, 4,
    /// 8, …, so that it costs little in long runs. The check is not part of a frame, because it allocates memory and games do not need it.
    pub fn warn_of_missing_contact(&mut self) {
        const NONE: &str = "contact.none";
        let due = self.frames.is_power_of_two() && self.blueprint.contact.is_none() && self.blueprint.bodies.len() > 1;
        if !due || self.warnings.iter().any(|warning| warning.code == NONE) {
            return;
        }
        let crossed = self.crossed_surfaces();
        let Some(first) = crossed.first() else { return };
        let [a, b] = first.bodies.map(|body| self.blueprint.bodies[body].name.clone());
        let warning = WorldWarning::NoContact { time: self.time(), pairs: crossed.len() as u64, first: a, second: b };
        self.warnings.push(Warning::new(warning, 1));
    }

    /// Warns about bodies that begin across an obstacle without an inside. Copies get one warning for each obstacle.
    pub(crate) fn warn_of_pinched_bodies(&mut self) {
        let Some(colliders) = self.colliders.clone() else { return };
        let mut found: Vec<(String, Warning, usize)> = Vec::new();
        for (collider, picture) in colliders.pictures(self.time()).iter().enumerate() {
            let Some((points, facets)) = thin(picture) else { continue };
            let extent = bounds(points.iter().copied());
            let count = self.blueprint.bodies.len();
            let bodies: Vec<usize> = (0..count).filter(|body| overlap(&extent, &self.bounds_of(*body))).collect();
            let mut surfaces = self.surfaces(&bodies);
            let first = surfaces.positions.len() as u32;
            surfaces.positions.extend(points);
            surfaces.origin.extend((0..facets.len() as u32).map(|number| (count, number)));
            surfaces.facets.extend(facets.iter().map(|facet| facet.map(|p| first + p)));
            let pairs = surfaces.crossings().pairs;
            let mut across: Vec<usize> = pairs
                .iter()
                .map(|pair| pair.map(|facet| surfaces.origin[facet as usize].0))
                .filter(|[a, b]| (*a == count) != (*b == count))
                .map(|[a, b]| a.min(b))
                .collect();
            across.sort_unstable();
            across.dedup();
            for own in across.iter().map(|body| &self.blueprint.bodies[*body]) {
                let name = own.common_name().to_string();
                if let Some((_, warning, _)) = found.iter_mut().find(|(other, _, at)| *other == name && *at == collider)
                {
                    warning.count += 1;
                    continue;
                }
                let kind = self.blueprint.colliders[collider].values.kind().into();
                let warning = WorldWarning::StartsAcross { body: own.name.clone(), collider, kind };
                found.push((name, Warning::new(warning, 1), collider));
            }
        }
        self.warnings.extend(found.into_iter().map(|(_, warning, _)| warning));
    }

    fn surfaces(&self, bodies: &[usize]) -> Surfaces<D> {
        let mut out = Surfaces { positions: Vec::new(), facets: Vec::new(), origin: Vec::new(), closed: Vec::new() };
        for body in bodies {
            let own = &self.blueprint.bodies[*body];
            let (first, begin) = (out.positions.len() as u32, out.facets.len());
            let nodes: Vec<[f64; D]> = (0..own.mesh.nodes() as u32).map(|node| self.position(*body, node)).collect();
            let surface = own.touching_surface();
            out.positions.extend(surface.positions(&nodes));
            out.facets.extend(surface.facets.iter().map(|facet| facet.map(|point| first + point)));
            if surface.closed > 0 {
                let facets = begin..begin + surface.closed;
                let points = out.facets[facets.clone()].iter().flatten();
                let bounds = bounds(points.map(|point| out.positions[*point as usize]));
                out.closed.push(Boundary { body: *body, facets, bounds });
            }
            out.origin.extend((0..(out.facets.len() - begin) as u32).map(|number| (*body, number)));
        }
        out
    }
}

impl<const D: usize> Surfaces<D> {
    fn crossings(&self) -> Crossings {
        if D == 2 {
            let edges: Vec<[u32; 2]> = self.facets.iter().map(|facet| [facet[0], facet[1]]).collect();
            let positions: Vec<[f64; 2]> = self.positions.iter().map(|x| [x[0], x[1]]).collect();
            return crossing_edges(&edges, &positions);
        }
        let lifted = Mesh::<3> {
            positions: self.positions.iter().map(|x| core::array::from_fn(|d| x[d])).collect(),
            facets: self.facets.iter().map(|facet| core::array::from_fn(|k| facet[k])).collect(),
            ..Mesh::default()
        };
        lifted.crossing_facets()
    }

    /// The points of the facets of each of these bodies, in ascending order.
    fn points_of(&self, bodies: &[usize]) -> Vec<Vec<u32>> {
        let mut points = vec![Vec::new(); bodies.len()];
        for (facet, (body, _)) in self.facets.iter().zip(&self.origin) {
            if let Ok(own) = bodies.binary_search(body) {
                points[own].extend(facet);
            }
        }
        for own in &mut points {
            own.sort_unstable();
            own.dedup();
        }
        points
    }

    /// Whether a point lies within a closed boundary.
    fn is_inside(&self, Boundary { facets, bounds: [low, high], .. }: &Boundary<D>, point: u32) -> bool {
        let x = &self.positions[point as usize];
        let within = (0..D).all(|d| low[d] <= x[d] && x[d] <= high[d]);
        within && winding_number(&self.facets[facets.clone()], &self.positions, x).abs() > 0.5
    }

    /// Bodies with a point inside another body.
    fn nested(&self) -> Vec<Crossed> {
        let mut found = Vec::new();
        for boundary in &self.closed {
            let outer = boundary.body;
            let mut last = None;
            for (facet, (inner, _)) in self.facets.iter().zip(&self.origin) {
                // One point of every other body is enough: a body that lies inside the boundary lies there with all of its points.
                if *inner == outer || last == Some(*inner) {
                    continue;
                }
                last = Some(*inner);
                if self.is_inside(boundary, facet[0]) {
                    let bodies = if *inner < outer { [*inner, outer] } else { [outer, *inner] };
                    found.push(Crossed { bodies, facets: None });
                }
            }
        }
        found
    }
}

/// Points and facets.
type Thin<'a, const D: usize> = (&'a [[f64; D]], Vec<[u32; D]>);

/// The points and facets of an obstacle without an inside; none if it has an inside.
fn thin<const D: usize>(picture: &Picture<D>) -> Option<Thin<'_, D>> {
    match picture {
        Picture::Polyline { points, closed } => {
            let (count, sides) = (points.len(), points.len() - usize::from(!closed));
            let facet = |k: usize| core::array::from_fn(|end| ((k + end) % count) as u32);
            Some((points, (0..sides).map(facet).collect()))
        }
        Picture::Triangles { points, triangles, solid: false } => {
            let facets = triangles.iter().map(|triangle| core::array::from_fn(|k| triangle[k]));
            Some((points, facets.collect()))
        }
        _ => None,
    }
}

/// The bounding box of some points.
fn bounds<const D: usize>(points: impl Iterator<Item = [f64; D]>) -> [[f64; D]; 2] {
    let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
    for x in points {
        for d in 0..D {
            low[d] = if x[d] < low[d] { x[d] } else { low[d] };
            high[d] = if x[d] > high[d] { x[d] } else { high[d] };
        }
    }
    [low, high]
}

fn overlap<const D: usize>(a: &[[f64; D]; 2], b: &[[f64; D]; 2]) -> bool {
    (0..D).all(|d| a[0][d] <= b[1][d] && b[0][d] <= a[1][d])
}
