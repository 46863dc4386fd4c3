//! The masses of the nodes of a body.

use crate::blueprint::{BodyBlueprint, Mass};
use opruga_mesh::{Measure, Share};

/// The masses of the nodes of a body [kg].
pub(crate) fn node_masses<const D: usize>(body: &BodyBlueprint<D>) -> Vec<f64> {
    let nodes = body.mesh.nodes();
    // A mesh without elements, or with elements of different dimensions, does not determine the shares of its nodes. All of its
    // nodes then get the same mass.
    let shares = body.mesh.lumped_measures(Share::Proportional).unwrap_or_else(|_| vec![1.0; nodes]);
    let first = shares.first().copied().unwrap_or(0.0);
    // Shares that agree to rounding are made equal, so that a regular ring has bitwise equal masses.
    let alike = shares.iter().all(|s| (s - first).abs() <= 1e-9 * first.abs());
    match &body.mass {
        &Mass::Node(mass) => vec![mass; nodes],
        &Mass::Total(mass) if alike => vec![mass / nodes as f64; nodes],
        &Mass::Total(mass) => {
            let total: f64 = shares.iter().sum();
            shares.iter().map(|s| mass * s / total).collect()
        }
        &Mass::Density(density) => {
            // The thickness replaces missing dimensions of the elements: once for a sheet, twice for a wire.
            let depth = match body.mesh.measure() {
                Ok(Measure::Length(_)) => density * body.thickness * body.thickness,
                Ok(Measure::Area(_)) => density * body.thickness,
                _ => density,
            };
            shares.iter().map(|s| if alike { first * depth } else { s * depth }).collect()
        }
        // A mesh with another number of cells has been refused.
        Mass::DensityOfCells(densities) => match body.mesh.lumped_masses(densities) {
            Ok(masses) if D == 2 => masses.iter().map(|mass| mass * body.thickness).collect(),
            Ok(masses) => masses,
            Err(_) => vec![0.0; nodes],
        },
    }
}

/// The density of every cell of a body [kg/m³], if the densities differ.
pub(crate) fn densities<const D: usize>(body: &BodyBlueprint<D>) -> Option<&[f64]> {
    match &body.mass {
        Mass::DensityOfCells(densities) => Some(densities),
        _ => None,
    }
}
