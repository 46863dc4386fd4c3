//! Moduli of materials, and which of them have no meaning together.

use opruga_core::error::BuildError;
use opruga_core::spec::Values;

/// μ and λ [Pa] of Young's modulus [Pa] and Poisson's ratio.
pub(crate) fn lame(modulus: f64, ratio: f64) -> [f64; 2] {
    [modulus / (2.0 * (1.0 + ratio)), modulus * ratio / ((1.0 + ratio) * (1.0 - 2.0 * ratio))]
}

/// Refuses a Mooney–Rivlin solid that is not convex with a Poisson's ratio.
pub(crate) fn refuse_what_is_not_convex(values: &Values, ratio: f64) -> Result<(), BuildError> {
    if values.text("material") != Some("mooney_rivlin") {
        return Ok(());
    }
    let (share, most) = (values.number("mooney_share").unwrap_or(0.0), ratio / (1.0 - 2.0 * ratio));
    if share > most {
        Err(BuildError::new(values.kind(), "model.not_convex", not_convex(share, ratio, most)))
    } else {
        Ok(())
    }
}

/// Why a share of the second constant of Mooney and Rivlin is refused with a Poisson's ratio that allows at most `most`.
fn not_convex(share: f64, ratio: f64, most: f64) -> String {
    if most < 0.0 {
        // No share is allowed at all: λ < 0.
        let least = share / (1.0 + 2.0 * share);
        return format!(
            "`poissons_ratio` is {ratio}, with which `mooney_rivlin` is not convex, whatever the `mooney_share`; allowed: at least \
             {least}, so that {share} <= ν/(1 − 2ν); hint: a smaller `mooney_share` allows a smaller one, down to 0"
        );
    }
    format!(
        "`mooney_share` is {share} with `poissons_ratio` = {ratio}, and not convex; allowed: at most {most} = ν/(1 − 2ν); hint: a \
         larger `poissons_ratio` allows a larger one"
    )
}
