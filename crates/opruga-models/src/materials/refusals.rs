//! Why a material is refused.

use opruga_math::messages;

/// The hint with the nearest name, or an empty text if no name is near.
fn did_you_mean(word: &Option<String>) -> String {
    word.as_ref().map_or_else(String::new, |word| format!("did you mean `{word}`?"))
}

messages! {
    /// Why a solid of any model refuses a material or its parameters.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Refusal {
        /// An unknown material.
        "scene.unknown_name" #[error("there is no material `{name}`")] #[hint("{}", did_you_mean(nearest))]
        Unknown { name: String, nearest: Option<String> },
        /// A deformation for which the law has no value.
        "model.no_value" #[error("`{material}` has no value at this deformation gradient, whose determinant is {determinant}: the numbers are too large")]
        #[allowed("det F > 0, and stretches that the law can follow")]
        TooLarge { material: String, determinant: f64 },
        /// A deformation for which no thickness gives plane stress.
        "model.no_value"
        #[error("`{material}` has no value at this deformation gradient, whose determinant is {determinant}: no positive thickness gives zero stress across the plane")]
        #[allowed("det F > 0, and stretches that the law can follow")]
        NoThicknessAcross { material: String, determinant: f64 },
        /// A Poisson's ratio that allows no second constant of Mooney–Rivlin.
        "model.not_convex"
        #[error("`poissons_ratio` is {ratio}, for which `mooney_rivlin` is not convex with any `mooney_share`")] #[value("{ratio}")] #[parameters("poissons_ratio", "mooney_share")]
        #[allowed("at least {least}, so that {share} <= ν/(1 − 2ν)")] #[hint("a smaller `mooney_share` allows a smaller `poissons_ratio`, down to 0")]
        NeverConvex { ratio: f64, least: String, share: String },
        /// A second constant of Mooney–Rivlin that is too large for Poisson's ratio.
        "model.not_convex" #[error("`mooney_share` is {share}, for which the law is not convex with `poissons_ratio` = {ratio}")] #[value("{share}")] #[parameters("mooney_share", "poissons_ratio")]
        #[allowed("at most {most} = ν/(1 − 2ν)")] #[hint("a larger `poissons_ratio` allows a larger `mooney_share`")]
        NotConvex { share: f64, ratio: f64, most: String },
    }
}
