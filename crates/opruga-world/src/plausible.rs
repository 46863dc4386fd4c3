//! Valid but implausible scenes: units that do not fit together, bodies that start inside an obstacle.

use crate::blueprint::{BodyBlueprint, Mass};
use crate::error::{Part, WorldError};
use crate::island::Island;
use crate::masses::node_masses;
use crate::refusals::Refusal;
use crate::selection::{extent, longest_side};
use crate::warnings::{Remedy, Warning, WorldWarning};
use crate::world::World;
use opruga_core::error::BuildError;
use opruga_core::spec::Role;
use opruga_core::stability::Spectrum;
use opruga_math::words::number;
use opruga_mesh::{Measure, Mesh, Share};

/// The code of the warning of [`sag`].
pub(crate) const SAG: &str = "units.sag";

/// Warns about a body that its own weight would stretch by more than its size. Usual causes are millimetres mixed with metres, grams with kilograms,
/// or a stiffness per metre that was meant per millimetre.
///
/// In a chain of springs k between nodes of mass m the fastest oscillation is ω = 2 √(k/m), so k ≈ m ω²/4 represents the springs of one node,
/// whatever the models are. The weight M g of a body of N nodes is carried by rows of springs. In a surface, there are as many rows side by side as
/// springs in a row; in a solid, there are N^⅓ times as many. The sag is therefore about M g / k or M g / (k N^⅓). An outline sags more, but gas
/// usually supports it, so it is treated as a surface.
///
/// If only the boundary of a solid has nodes, the stiffness grows in proportion to the wave number, and not to its square. The fastest motion of a
/// node is therefore that of one spring between the node and its surroundings, with k ≈ m ω². A cube of n × n × n springs has N = 6 n² nodes on its
/// boundary: sag ≈ M g / (k √(N/6)) in space.
pub(crate) fn sag<const D: usize>(body: &BodyBlueprint<D>, gravity: &[f64; D], spectrum: &Spectrum) -> Option<Warning> {
    let masses = node_masses(body);
    let (nodes, mass) = (masses.len() as f64, masses.iter().sum::<f64>());
    let is_boundary = body.models.iter().any(|model| model.spec().has_role(Role::InsideOfBoundary));
    let across = match body.mesh.measure() {
        // Without cells, the measure is that of the surface.
        _ if is_boundary && D == 3 => (nodes / 6.0).sqrt(),
        Ok(Measure::Volume(_)) => libm::cbrt(nodes),
        _ => 1.0,
    };
    let part = if is_boundary { 1.0 } else { 0.25 };
    let stiffness = part * spectrum.omega * spectrum.omega * mass / nodes * across;
    let g = gravity.iter().map(|g| g * g).sum::<f64>().sqrt();
    let size = longest_side(&body.mesh);
    let sag = mass * g / stiffness;
    // Without models nothing sags; if all values are zero, the sag is NaN.
    let implausible = stiffness > 0.0 && sag.is_finite() && sag > size && size > 0.0;
    implausible.then(|| Warning::new(WorldWarning::Sag { body: body.common_name().into(), mass, sag, size }, 1))
}

/// The largest rounding error of positions, relative to the distance between neighbouring nodes.
const ROUNDING: f64 = 1e-6;

/// The distance from the origin along an axis up to which the positions of a body keep their digits [m]. At this distance they are rounded by 1e-6 of
/// the distance between its nodes at rest, so that strains have an error of that size. A body without extent has no limit.
pub(crate) fn range<const D: usize>(mesh: &Mesh<D>) -> f64 {
    let nodes = mesh.positions.len() as f64;
    let apart = match mesh.measure() {
        Ok(Measure::Length(length)) => length / nodes,
        Ok(Measure::Area(area)) => (area / nodes).sqrt(),
        Ok(Measure::Volume(volume)) => libm::cbrt(volume / nodes),
        _ => 0.0,
    };
    if apart > 0.0 { ROUNDING * apart / f64::EPSILON } else { f64::INFINITY }
}

/// Refuses a body beyond its [`range`].
pub(crate) fn check_range<const D: usize>(x: &[[f64; D]], range: f64) -> Result<(), BuildError> {
    let farthest = x.iter().flatten().fold(0.0, |most: f64, c| if c.abs() > most { c.abs() } else { most });
    if farthest <= range {
        return Ok(());
    }
    Err(BuildError::of("position", Refusal::FarBody { farthest, range }))
}

/// Refuses a body that moves farther in a step of h [s] than its [`range`].
pub(crate) fn check_speed<const D: usize>(v: &[[f64; D]], range: f64, h: f64) -> Result<(), BuildError> {
    let fastest = v.iter().flatten().fold(0.0, |most: f64, c| if c.abs() > most { c.abs() } else { most });
    // This form treats NaN as too fast.
    if fastest * h <= range {
        return Ok(());
    }
    Err(BuildError::of("velocity", Refusal::FastBody { fastest, h, range }))
}

/// The largest number whose square is finite.
const LARGEST: f64 = 1e154;

/// The fields of a scene that determine the masses of a body, with their values; the value farthest from 1 comes first.
fn words_of_masses<const D: usize>(body: &BodyBlueprint<D>) -> Vec<(&'static str, f64)> {
    let thickness = ("thickness", body.thickness);
    let mut words = match &body.mass {
        Mass::Node(mass) => vec![("node_mass", *mass)],
        Mass::Total(mass) => vec![("mass", *mass)],
        Mass::Density(density) => vec![("density", *density), thickness],
        Mass::DensityOfCells(densities) => {
            let least = densities.iter().copied().fold(f64::INFINITY, |least, x| if x < least { x } else { least });
            vec![("density_of_cells", least), thickness]
        }
    };
    words.sort_by(|(_, a), (_, b)| libm::log(*b).abs().total_cmp(&libm::log(*a).abs()));
    words
}

/// Refuses a body with a node that should have mass, but whose mass is too small for a number: it would never move.
pub(crate) fn check_masses<const D: usize>(body: &BodyBlueprint<D>, masses: &[f64]) -> Result<(), BuildError> {
    // Below this, numbers lose digits and 1/m is not finite.
    let weighs = |mass: &f64| *mass >= f64::MIN_POSITIVE && mass.is_finite();
    if masses.iter().all(weighs) {
        return Ok(());
    }
    // A node that belongs to no element has no share.
    let shares = body.mesh.lumped_measures(Share::Proportional).unwrap_or_else(|_| vec![1.0; masses.len()]);
    let Some(node) = (0..masses.len()).find(|node| shares[*node] > 0.0 && !weighs(&masses[*node])) else {
        return Ok(());
    };
    let (word, value) = words_of_masses(body)[0];
    let (value, mass) = (format!("{value:?}"), masses[node]);
    Err(BuildError::of("mass", Refusal::MassOfNode { word, value, node, mass }))
}

impl<const D: usize> World<D> {
    /// Refuses a scene whose energy or momentum is not finite before its first step; the error names the cause.
    pub(crate) fn check_sums(&self) -> Result<(), WorldError> {
        if self.energy.is_finite() && self.momentum.is_finite() {
            return Ok(());
        }
        let most =
            |numbers: &[f64]| numbers.iter().fold(0.0, |most: f64, x| if x.abs() > most { x.abs() } else { most });
        let refuse = |part: Part, kind: &str, refusal: Refusal| {
            Err(WorldError::Build { part, source: BuildError::of(kind, refusal) })
        };
        let g = most(&self.blueprint.surroundings.gravity);
        if g > LARGEST {
            let refusal = Refusal::Weight { weight: g, most: LARGEST };
            return refuse(Part::Section { path: "world.gravity" }, "gravity", refusal);
        }
        let finite = |island: &&Island<D>| {
            let (survey, stock) = (&island.survey, &island.stock);
            let energy = survey.kinetic + survey.gravity + stock.elastic + stock.gas;
            survey.mass.is_finite() && energy.is_finite() && survey.momentum.is_finite()
        };
        let island = self.islands.iter().find(|island| !finite(island)).or(self.islands.first());
        let Some(body) = island.map(|island| &self.blueprint.bodies[island.bodies[0]]) else { return Ok(()) };
        let (word, value) = words_of_masses(body)[0];
        let refusal = match value > LARGEST {
            true => Refusal::BeyondFinite { word, value: format!("{value:?}"), most: LARGEST },
            false => Refusal::Sums {},
        };
        refuse(Part::body(&body.name), "mass", refusal)
    }
}

/// Depths below this fraction of the size of a body count as rounding errors in the numbers of the scene.
const SHALLOW: f64 = 1e-6;

impl<const D: usize> World<D> {
    /// Warns about bodies whose free nodes start inside an obstacle. The first step puts these nodes on its surface, which may fold the body or fling
    /// it away. Copies in the same obstacle get one warning, which names the deepest of them.
    pub(crate) fn warn_of_buried_bodies(&mut self) {
        let Some(colliders) = self.colliders.clone() else { return };
        let mut found: Vec<(String, f64, Warning, usize)> = Vec::new();
        for body in 0..self.blueprint.bodies.len() {
            let own = &self.blueprint.bodies[body];
            let (low, high) = extent(&own.mesh);
            let size = longest_side(&own.mesh);
            let box_at = |corner: &[f64; D]| core::array::from_fn(|d| corner[d] + own.translation[d]);
            if !colliders.reach(0.0, 0.0, &box_at(&low), &box_at(&high)) {
                continue;
            }
            // Pinned nodes do not count, because obstacles do not move them.
            let pinned = self.pinned_nodes(body);
            let nodes: Vec<u32> =
                (0..self.node_count(body) as u32).filter(|node| pinned.binary_search(node).is_err()).collect();
            let points: Vec<[f64; D]> = nodes.iter().map(|node| self.position(body, *node)).collect();
            let Some(buried) = colliders.buried(&points, SHALLOW * size) else { continue };
            let name = own.common_name().to_string();
            let warning = WorldWarning::StartsInside {
                body: own.name.clone(),
                collider: buried.collider,
                kind: self.blueprint.colliders[buried.collider].values.kind().into(),
                nodes: buried.count,
                deepest: nodes[buried.point],
                depth: buried.depth,
                remedy: match &buried.shift {
                    Some(shift) => Remedy::Moved { shift: out_of(shift, SHALLOW * size) },
                    None => Remedy::Nowhere {},
                },
            };
            let warning = Warning::new(warning, 1);
            match found.iter_mut().find(|(other, _, _, collider)| *other == name && *collider == buried.collider) {
                None => found.push((name, buried.depth, warning, buried.collider)),
                Some((_, depth, known, _)) => {
                    known.count += 1;
                    if buried.depth > *depth {
                        (*depth, known.message) = (buried.depth, warning.message);
                    }
                }
            }
        }
        self.warnings.extend(found.into_iter().map(|(_, _, warning, _)| warning));
    }
}

/// A displacement that the user can type, rounded up to five digits.
fn out_of<const D: usize>(shift: &[f64; D], slack: f64) -> String {
    let typed = |x: f64| match x {
        x if x.abs() <= slack => "0".into(),
        x => {
            let step = libm::exp10(libm::floor(libm::log10(x.abs())) - 4.0);
            number(libm::copysign(libm::ceil(x.abs() / step) * step, x))
        }
    };
    shift.map(typed).join(", ")
}
