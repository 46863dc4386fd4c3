//! What a scene may well say, but hardly means: units that do not go together.

use crate::blueprint::BodyBlueprint;
use crate::build::node_masses;
use crate::selection::extent;
use crate::world::Warning;
use opruga_core::stability::Spectrum;
use opruga_mesh::Measure;

/// The code of the warning of [`sag`].
pub(crate) const SAG: &str = "units.sag";

/// Warns of a body that its own weight would stretch by more than its size: millimetres among metres, grams among
/// kilograms, or a stiffness per metre that was meant per millimetre.
///
/// In a chain of springs k between nodes of mass m the fastest oscillation is ω = 2 √(k/m), so k ≈ m ω²/4 stands for the
/// springs of one node, whatever the models are. A body of N nodes carries its weight M g with as many springs side by
/// side as one after the other if it is a surface, with N^⅓ times as many if it is a solid: sag ≈ M g / (k N^⅓) or M g / k.
/// An outline sags more; what holds it up is usually gas, so it is taken for a surface.
pub(crate) fn sag<const D: usize>(body: &BodyBlueprint<D>, gravity: &[f64; D], spectrum: &Spectrum) -> Option<Warning> {
    let masses = node_masses(body);
    let (nodes, mass) = (masses.len() as f64, masses.iter().sum::<f64>());
    let across = match body.mesh.measure() {
        Ok(Measure::Volume(_)) => libm::cbrt(nodes),
        _ => 1.0,
    };
    let stiffness = 0.25 * spectrum.omega * spectrum.omega * mass / nodes * across;
    let g = gravity.iter().map(|g| g * g).sum::<f64>().sqrt();
    let (low, high) = extent(&body.mesh);
    let size = (0..D).map(|a| high[a] - low[a]).fold(0.0, |m, x| if x > m { x } else { m });
    let sag = mass * g / stiffness;
    // Without models there is nothing to sag; not a number where all is zero.
    let odd = stiffness > 0.0 && sag.is_finite() && sag > size && size > 0.0;
    odd.then(|| Warning {
        code: SAG.into(),
        message: format!(
            "body `{}` of {mass:.3e} kg would sag by about {sag:.1e} m under its weight, more than its size of {size:.3} m: \
             are its units mixed (metres, kilograms, newtons per metre)?",
            body.common_name(),
        ),
        count: 1,
    })
}
