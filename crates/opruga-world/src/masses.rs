//! How much the nodes of a body weigh.

use crate::blueprint::{BodyBlueprint, Mass};
use opruga_mesh::{Measure, Share};

/// The masses of the nodes of a body [kg].
pub(crate) fn node_masses<const D: usize>(body: &BodyBlueprint<D>) -> Vec<f64> {
    let nodes = body.mesh.nodes();
    // A mesh without elements, or with mixed ones, has no shares: its nodes weigh the same.
    let shares = body.mesh.lumped_measures(Share::Proportional).unwrap_or_else(|_| vec![1.0; nodes]);
    let first = shares.first().copied().unwrap_or(0.0);
    // Shares that agree to rounding are equal: a regular ring has equal masses to the bit.
    let alike = shares.iter().all(|s| (s - first).abs() <= 1e-9 * first.abs());
    match &body.mass {
        &Mass::Node(mass) => vec![mass; nodes],
        &Mass::Total(mass) if alike => vec![mass / nodes as f64; nodes],
        &Mass::Total(mass) => {
            let total: f64 = shares.iter().sum();
            shares.iter().map(|s| mass * s / total).collect()
        }
        &Mass::Density(density) => {
            // What the elements lack in dimensions is thickness: a sheet's, twice a wire's.
            let depth = match body.mesh.measure() {
                Ok(Measure::Length(_)) => density * body.thickness * body.thickness,
                Ok(Measure::Area(_)) => density * body.thickness,
                _ => density,
            };
            shares.iter().map(|s| if alike { first * depth } else { s * depth }).collect()
        }
        // A mesh without as many cells has been refused.
        Mass::DensityOfCells(densities) => match body.mesh.lumped_masses(densities) {
            Ok(masses) if D == 2 => masses.iter().map(|mass| mass * body.thickness).collect(),
            Ok(masses) => masses,
            Err(_) => vec![0.0; nodes],
        },
    }
}

/// The density of every cell of a body [kg/m³], where they differ.
pub(crate) fn densities<const D: usize>(body: &BodyBlueprint<D>) -> Option<&[f64]> {
    match &body.mass {
        Mass::DensityOfCells(densities) => Some(densities),
        _ => None,
    }
}
