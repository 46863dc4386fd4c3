//! Moduli of materials, and checks of their combinations.

use super::Refusal;
use opruga_core::error::BuildError;
use opruga_core::spec::Values;

/// Returns μ and λ [Pa] for Young's modulus [Pa] and Poisson's ratio.
pub(crate) fn lame(modulus: f64, ratio: f64) -> [f64; 2] {
    [modulus / (2.0 * (1.0 + ratio)), modulus * ratio / ((1.0 + ratio) * (1.0 - 2.0 * ratio))]
}

/// Refuses a Mooney–Rivlin solid whose constants do not give a polyconvex law for a Poisson's ratio.
pub(crate) fn refuse_what_is_not_convex(values: &Values, ratio: f64) -> Result<(), BuildError> {
    if values.text("material") != Some("mooney_rivlin") {
        return Ok(());
    }
    let (share, most) = (values.number("mooney_share").unwrap_or(0.0), ratio / (1.0 - 2.0 * ratio));
    if share > most { Err(BuildError::of(values.kind(), not_convex(share, ratio, most))) } else { Ok(()) }
}

/// The refusal of a Mooney–Rivlin share for a Poisson's ratio that allows at most `most`.
fn not_convex(share: f64, ratio: f64, most: f64) -> Refusal {
    if most < 0.0 {
        // No share is allowed, because λ < 0.
        let least = share / (1.0 + 2.0 * share);
        return Refusal::NeverConvex { ratio, least: least.to_string(), share: share.to_string() };
    }
    Refusal::NotConvex { share, ratio, most: most.to_string() }
}
