//! The arguments of `opruga material`.

use clap::Args;

#[derive(Args, Debug)]
pub(crate) struct Material {
    /// The material, as in a scene: linear, st_venant_kirchhoff, corotated, fixed_corotated, neo_hookean, stable_neo_hookean, mooney_rivlin
    pub(crate) name: String,
    /// The deformation gradient F = ∂x/∂X row by row: 4 numbers for the plane, 9 for space, such as 1.1,0,0,1
    #[arg(long = "F", value_name = "NUMBERS", allow_hyphen_values = true)]
    pub(crate) gradient: String,
    /// Young's modulus E [Pa]; with 1 Pa, all stresses are fractions of E
    #[arg(long = "E", value_name = "PA", allow_negative_numbers = true, default_value_t = 1.0)]
    pub(crate) youngs_modulus: f64,
    /// Poisson's ratio ν
    #[arg(long = "nu", value_name = "RATIO", allow_negative_numbers = true, default_value_t = 0.3)]
    pub(crate) poissons_ratio: f64,
    /// In 2D: `strain` if nothing moves across the plane, `stress` if no stress acts across it [default: strain]
    #[arg(long, value_name = "WORD")]
    pub(crate) plane: Option<String>,
    /// Set another number of the material, as in a scene, such as mooney_share=0.2; may be given several times
    #[arg(long = "set", value_name = "FIELD=VALUE")]
    pub(crate) set: Vec<String>,
    /// Print JSON, with all digits
    #[arg(long)]
    pub(crate) json: bool,
}
