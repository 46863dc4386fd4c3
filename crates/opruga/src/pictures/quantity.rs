//! The quantity that the colours of bodies show, and its value at every node.

use super::Fixed;
use crate::core::potential::{Account, CellState};
use crate::draw::{ColourMap, Legend};
use crate::{AnyBody, AnyScene, AnyWorld};
use opruga_core::spec::Role;

/// The quantity that the colours of bodies show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quantity {
    /// The mean elongation of the edges at each node [%].
    #[default]
    Strain,
    /// The force on each node [N] from all models that store energy, except the gas.
    ElasticForce,
    /// The pressure of the gas in the chamber that the node bounds, or in the only chamber [Pa]; bodies without gas have no colour.
    Pressure,
    /// The speed of each node [m/s].
    Speed,
    /// The von Mises stress of finite elements, averaged over the cells at each node [Pa]; bodies without finite elements have no colour.
    VonMises,
    /// The volume of finite elements divided by that at rest, averaged over the cells at each node.
    VolumeRatio,
    /// Nothing: each body has one colour, and drawings have their own.
    Plain,
}

impl Quantity {
    /// All quantities, in the order of menus.
    pub const ALL: [Quantity; 7] = [
        Quantity::Strain,
        Quantity::ElasticForce,
        Quantity::Pressure,
        Quantity::Speed,
        Quantity::VonMises,
        Quantity::VolumeRatio,
        Quantity::Plain,
    ];

    /// The default quantity for the bodies of a scene: none if one of them is painted in its own colours, stress if all of them are solids whose
    /// stress is known, otherwise strain.
    pub(super) fn of(scene: &dyn AnyScene) -> Quantity {
        let mut areas = scene.bodies().filter_map(|body| body.skin()).flat_map(|skin| &skin.areas);
        if areas.any(|area| area.colour.is_some()) {
            return Quantity::Plain;
        }
        let knows =
            |body: &dyn AnyBody| [Role::OwnsCells, Role::InsideOfBoundary].iter().any(|role| body.has_role(*role));
        let mut solids = scene.bodies().map(knows);
        if scene.body_count() > 0 && solids.all(|solid| solid) { Quantity::VonMises } else { Quantity::Strain }
    }

    /// Name and unit for legends; none if there is no quantity.
    pub(super) fn legend(self) -> Option<Legend> {
        let (label, unit) = match self {
            Quantity::Strain => ("strain", "%"),
            Quantity::ElasticForce => ("elastic force", "N"),
            Quantity::Pressure => ("pressure", "Pa"),
            Quantity::Speed => ("speed", "m/s"),
            Quantity::VonMises => ("von Mises stress", "Pa"),
            Quantity::VolumeRatio => ("volume / volume at rest", ""),
            Quantity::Plain => return None,
        };
        // In most parts of a body the stress is small. These parts have a light colour, because the shading is visible only on light colours.
        let stress = matches!(self, Quantity::VonMises | Quantity::ElasticForce);
        let map = if stress { ColourMap::Embers } else { ColourMap::default() };
        Some(Legend { label: label.into(), unit: unit.into(), range: None, map })
    }
}

/// Strains below this value, and the stresses of such strains, are rounding errors of positions. If they were shown, they would fill the whole range
/// of colours of a body at rest.
const ROUNDING: f64 = 1e-11;

/// Adds a quantity at every node of a body.
pub(super) fn push_quantity(
    world: &mut dyn AnyWorld,
    body: usize,
    nodes: usize,
    quantity: Quantity,
    scalars: &mut Vec<f32>,
) {
    let size = |v: [f64; 3]| v.iter().map(|c| c * c).sum::<f64>().sqrt() as f32;
    match quantity {
        Quantity::Strain | Quantity::Plain => {}
        Quantity::Speed => scalars.extend(world.velocities(body).iter().map(size)),
        Quantity::VonMises => {
            let models = world.scene().body(body).map_or(&[][..], |body| body.models());
            let moduli = models.iter().filter_map(|model| model.number("youngs_modulus"));
            let rounding = ROUNDING * moduli.fold(0.0, |largest: f64, e| if e > largest { e } else { largest });
            let seen = |state: &CellState| Some(state.von_mises()).filter(|stress| *stress > rounding).unwrap_or(0.0);
            push_means(world, body, nodes, seen, scalars);
        }
        Quantity::VolumeRatio => push_means(world, body, nodes, |state| state.volume_ratio, scalars),
        Quantity::ElasticForce => {
            let forces = world.forces(body, Some(Account::Elastic));
            scalars.extend((0..nodes).map(|node| forces.get(node).map_or(f32::NAN, |force| size(*force))));
        }
        Quantity::Pressure => {
            let readings = world.readings(body);
            let pressure = readings.iter().find(|(name, _)| name == "pressure").map_or(f64::NAN, |(_, p)| *p);
            let first = scalars.len();
            scalars.extend(std::iter::repeat_n(pressure as f32, nodes));
            for (node, pressure) in world.node_pressures(body) {
                scalars[first + node as usize] = pressure as f32;
            }
        }
    }
}

/// Adds the mean of a quantity of the cells or facets at every node of a body; NaN if a node has none.
fn push_means(
    world: &dyn AnyWorld,
    body: usize,
    nodes: usize,
    number: impl Fn(&CellState) -> f64,
    scalars: &mut Vec<f32>,
) {
    let (mut sum, mut count) = (vec![0.0; nodes], vec![0.0; nodes]);
    world.visit_states(body, &mut |state, nodes| {
        for node in nodes {
            sum[*node as usize] += number(state);
            count[*node as usize] += 1.0;
        }
    });
    scalars.extend(sum.iter().zip(&count).map(|(sum, count)| (sum / count) as f32));
}

/// Mean elongation of the edges at each node [%].
pub(super) fn strain(fixed: &Fixed, positions: &[[f64; 3]]) -> Vec<f64> {
    let mut sum = vec![0.0; fixed.nodes];
    let mut count = vec![0.0; fixed.nodes];
    for ([a, b], rest) in &fixed.edges {
        let (p, q) = (positions[*a as usize], positions[*b as usize]);
        let length = p.iter().zip(&q).map(|(x, y)| (x - y) * (x - y)).sum::<f64>().sqrt();
        let stretch = if *rest > 0.0 { length / rest - 1.0 } else { 0.0 };
        let stretch = if stretch.abs() > ROUNDING { 100.0 * stretch } else { 0.0 };
        for node in [*a as usize, *b as usize] {
            sum[node] += stretch;
            count[node] += 1.0;
        }
    }
    sum.iter().zip(&count).map(|(s, c)| if *c > 0.0 { s / c } else { 0.0 }).collect()
}
