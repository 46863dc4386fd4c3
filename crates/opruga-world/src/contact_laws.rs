//! The contact laws of pairs of bodies, from `[contact]` and the settings of the bodies.

use crate::blueprint::{Blueprint, BodyBlueprint, ContactBlueprint};
use crate::error::{Part, WorldError};
use crate::refusals::Refusal;
use opruga_collide::{Laws, PairLaw};
use opruga_core::error::BuildError;
use opruga_core::integrator::Integrator;
use opruga_core::spec::{Role, Value, Values};
use opruga_math::Lane;
use opruga_mesh::{Mesh, TouchingSurface};

/// The default distance of surfaces in contact, relative to the mean edge. This distance is small compared with every facet, but much larger than the
/// errors of gaps that sweeps and rounding cause.
const THICKNESS_OF_EDGE: f64 = 0.01;

impl<const D: usize> BodyBlueprint<D> {
    /// Whether the body touches anything if the scene has contact.
    pub(crate) fn touches(&self) -> bool {
        self.contact.as_ref().is_none_or(|own| own.flag("touch"))
    }
    /// The surface with which it touches other bodies: by default the skin that it carries, if any.
    pub(crate) fn touching_surface(&self) -> TouchingSurface<D> {
        let cells = self.contact.as_ref().is_some_and(|own| own.text("surface") == Some("cells"));
        self.mesh.touching_surface(!cells)
    }
    /// Its group in `[[contact.pair]]`.
    pub fn contact_group(&self) -> &str {
        self.contact.as_ref().and_then(|own| own.text("group")).unwrap_or_else(|| self.common_name())
    }
}

/// The edges of a surface at rest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edges {
    /// The sum of their lengths [m], and their number.
    pub(crate) sum: f64,
    pub(crate) count: usize,
    /// The shortest length [m].
    pub(crate) shortest: f64,
}

/// The lengths of the edges of a surface at rest.
pub(crate) fn edges_of<const D: usize>(surface: &TouchingSurface<D>, mesh: &Mesh<D>) -> Edges {
    let (mut sum, mut count, mut shortest) = (0.0, 0, f64::INFINITY);
    let positions = surface.positions(&mesh.positions);
    let mut add = |a: u32, b: u32| {
        let (a, b) = (&positions[a as usize], &positions[b as usize]);
        let square: f64 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
        sum += square.sqrt();
        count += 1;
        shortest = if square.sqrt() < shortest { square.sqrt() } else { shortest };
    };
    for facet in &surface.facets {
        (0..if D == 2 { 1 } else { D }).for_each(|k| add(facet[k], facet[(k + 1) % D]));
    }
    surface.wires.iter().for_each(|[a, b]| add(*a, *b));
    Edges { sum, count, shortest }
}

/// The properties that bodies of one class share.
#[derive(Clone, Debug, PartialEq)]
struct Class<'a> {
    group: &'a str,
    friction: f64,
    restitution: f64,
    thickness: f64,
    itself: bool,
}

/// The contact laws among some bodies of a scene. `mean_edge` is the mean over all their surfaces [m].
pub(crate) fn laws<const D: usize>(
    scene: &Blueprint<D>,
    contact: &ContactBlueprint,
    bodies: &[usize],
    mean_edge: f64,
) -> Laws {
    let values = &contact.values;
    let mut classes: Vec<Class<'_>> = Vec::new();
    let mut class = Vec::with_capacity(bodies.len());
    for number in bodies {
        let body = &scene.bodies[*number];
        let own = body.contact.as_ref();
        let number_of = |name: &str| own.and_then(|own| own.number(name)).or_else(|| values.number(name));
        let edge = || match edges_of(&body.touching_surface(), &body.mesh) {
            Edges { count: 0, .. } => mean_edge,
            Edges { sum, count, .. } => sum / count as f64,
        };
        let one = Class {
            group: body.contact_group(),
            friction: number_of("friction").unwrap_or(0.0),
            restitution: number_of("restitution").unwrap_or(0.0),
            thickness: number_of("thickness").unwrap_or_else(|| THICKNESS_OF_EDGE * edge()),
            itself: touches_itself(contact, body),
        };
        let found = classes.iter().rposition(|other| *other == one).unwrap_or_else(|| {
            classes.push(one);
            classes.len() - 1
        });
        class.push(found as u32);
    }
    let mut table = Vec::with_capacity(classes.len() * classes.len());
    for a in &classes {
        for b in &classes {
            let mut law = PairLaw {
                touch: true,
                friction: 0.5 * (a.friction + b.friction),
                restitution: 0.5 * (a.restitution + b.restitution),
                thickness: 0.5 * (a.thickness + b.thickness),
            };
            let of_both = |pair: &Values| {
                let names = [pair.text("first"), pair.text("second")];
                names == [Some(a.group), Some(b.group)] || names == [Some(b.group), Some(a.group)]
            };
            for pair in contact.pairs.iter().filter(|pair| of_both(pair)) {
                law.touch = pair.flag("touch");
                law.friction = pair.number("friction").unwrap_or(law.friction);
                law.restitution = pair.number("restitution").unwrap_or(law.restitution);
            }
            table.push(law);
        }
    }
    Laws {
        class,
        classes: classes.len(),
        obstacles: 0,
        table,
        itself: classes.iter().map(|class| class.itself).collect(),
        rest_speed: values.number("rest_speed").unwrap_or(0.0),
        recovery_speed: values.number("recovery_speed").unwrap_or(0.0),
        thickest_elsewhere: [0.0; 2],
    }
}

/// The default reach of a barrier relative to the mean edge, and its largest value relative to the shortest edge. The default reach is small compared
/// with every facet.
const REACH_OF_EDGE: f64 = 0.02;
const REACH_OF_SHORTEST: f64 = 0.5;

/// The reach of the barrier, if the scene has one [m].
pub(crate) fn reach_of(contact: &ContactBlueprint, mean_edge: f64, shortest: f64) -> Option<f64> {
    let own = (REACH_OF_EDGE * mean_edge).smaller(REACH_OF_SHORTEST * shortest);
    is_barrier(contact).then(|| contact.values.number("reach").unwrap_or(own))
}

/// Whether a barrier keeps bodies apart.
pub(crate) fn is_barrier(contact: &ContactBlueprint) -> bool {
    contact.values.text("response") == Some("barrier")
}

/// Refuses bodies at rest whose contact is of a kind that statics does not support.
fn check_rest<const D: usize>(
    scene: &Blueprint<D>,
    body: &BodyBlueprint<D>,
    own: &dyn Integrator<D>,
) -> Result<(), WorldError> {
    let is_static =
        |body: &BodyBlueprint<D>| body.integrator.as_ref().unwrap_or(&scene.integrator).spec().has_role(Role::Statics);
    let integrator = own.name();
    if let Some(other) = scene.bodies.iter().find(|body| body.touches() && is_static(body) != own.is_static()) {
        // The error belongs to a body that has its own integrator, because that integrator differs from the others.
        return Err(match (&body.integrator, &other.integrator) {
            (None, Some(differs)) => {
                let refusal = Refusal::RestBesideMotion { integrator: differs.kind(), other: body.name.clone() };
                refused(other, "integrator", refusal)
            }
            _ => refused(body, "integrator", Refusal::RestBesideMotion { integrator, other: other.name.clone() }),
        });
    }
    if own.is_static() && !own.takes_pushes() {
        return Err(refused(body, cause(body), Refusal::RestInParts { integrator }));
    }
    Ok(())
}

/// The refusal of a field of a body.
fn refused<const D: usize>(body: &BodyBlueprint<D>, field: &str, why: Refusal) -> WorldError {
    WorldError::Build { part: Part::body(&body.name), source: BuildError::of(field, why) }
}

/// The field to which a refusal belongs that depends on the integrator of a body: the integrator of its own or, if the body uses the integrator of
/// the scene, its contact.
fn cause<const D: usize>(body: &BodyBlueprint<D>) -> &'static str {
    if body.integrator.is_some() { "integrator" } else { "contact" }
}

/// Refuses a thickness that a body cannot have: its surface would be in contact with itself at rest, or the body is thinner.
fn check_thickness<const D: usize>(
    contact: &ContactBlueprint,
    body: &BodyBlueprint<D>,
    shortest: impl Fn() -> f64,
) -> Result<(), WorldError> {
    let own = body.contact.as_ref();
    let given = own.and_then(|own| own.number("thickness")).or_else(|| contact.values.number("thickness"));
    let Some(thickness) = given.filter(|_| body.touches()) else { return Ok(()) };
    let refuse = |why: Refusal| Err(refused(body, "contact", why));
    let shortest = shortest();
    // The edges of a wire in space touch only where they cross, so its neighbours do not push one another apart.
    let has_facets = !body.touching_surface().facets.is_empty();
    if has_facets && touches_itself(contact, body) && thickness >= shortest {
        return refuse(Refusal::Thickness { thickness, shortest });
    }
    let extent = |d: usize| {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for x in &body.mesh.positions {
            (low, high) = (x[d].smaller(low), x[d].larger(high));
        }
        high - low
    };
    let size = (0..D).map(extent).fold(0.0, f64::larger);
    if size > 0.0 && thickness >= size { refuse(Refusal::ThickerThanBody { thickness, size }) } else { Ok(()) }
}

/// Whether the parts of a body touch one another.
fn touches_itself<const D: usize>(contact: &ContactBlueprint, body: &BodyBlueprint<D>) -> bool {
    match body.contact.as_ref().and_then(|own| own.get("self")) {
        Some(Value::Boolean(own)) => *own,
        _ => contact.values.flag("self"),
    }
}

/// Refuses a body that cannot be stepped with contact.
pub(crate) fn check<const D: usize>(
    scene: &Blueprint<D>,
    body: &BodyBlueprint<D>,
    integrator: &dyn Integrator<D>,
) -> Result<(), WorldError> {
    let Some(contact) = &scene.contact else { return Ok(()) };
    if body.touches() {
        check_rest(scene, body, integrator)?;
    }
    if body.touches() && is_barrier(contact) && !integrator.takes_pushes() {
        return Err(refused(body, cause(body), Refusal::NoBarrier { integrator: integrator.name() }));
    }
    let shortest = || edges_of(&body.touching_surface(), &body.mesh).shortest;
    let reach = contact.values.number("reach").filter(|_| is_barrier(contact));
    if let Some((reach, shortest)) =
        reach.map(|reach| (reach, shortest())).filter(|(reach, shortest)| reach >= shortest)
    {
        return Err(refused(body, "contact", Refusal::Reach { reach, shortest }));
    }
    check_thickness(contact, body, shortest)?;
    if scene.surroundings.unfold {
        return Err(refused(body, "contact", Refusal::Unfold {}));
    }
    Ok(())
}
