//! # Materials
//!
//! Functions of the deformation gradient F, one file each, for every model of a solid: [`Linear`], [`StVenantKirchhoff`],
//! [`Corotated`], [`FixedCorotated`], [`NeoHookean`], [`StableNeoHookean`], [`MooneyRivlin`]. Each has an energy density ψ(F),
//! P = ∂ψ/∂F and ∂P/∂F, in space and in plane strain. In plane stress, a law in the plane is derived from the law in space. At
//! every point the thickness has the stretch for which the out-of-plane stress is zero, and this stretch is condensed out of
//! the tangent. Thermal expansion applies any of these laws to F/g (file `heat`).
//!
//! Clamped tangents come from the analytic eigensystem of isotropic energies ([`material::Principal`]; Smith et al. 2019).

mod at_point;
mod corotated;
mod fixed_corotated;
mod heat;
pub(crate) mod law;
mod linear;
pub mod material;
pub(crate) mod moduli;
mod mooney_rivlin;
mod neo_hookean;
mod plane_stress;
pub(crate) mod points;
mod principal_frame;
mod refusals;
mod st_venant_kirchhoff;
mod stable_neo_hookean;

pub use at_point::{AtPoint, in_plane, in_space};

pub use corotated::Corotated;
pub use fixed_corotated::FixedCorotated;
pub use linear::Linear;
pub use mooney_rivlin::MooneyRivlin;
pub use neo_hookean::NeoHookean;
pub use refusals::Refusal;
pub use st_venant_kirchhoff::StVenantKirchhoff;
pub use stable_neo_hookean::StableNeoHookean;

use heat::{Heated, HeatedSlice};
use law::{Law, Lift};
use plane_stress::PlaneStress;

/// An entry of the list of materials: its name and its laws.
pub(crate) struct Entry {
    pub(crate) name: &'static str,
    /// The laws if all points are at the reference temperature.
    pub(crate) cold: Laws,
    /// The laws if the temperature of any point may differ from the reference.
    pub(crate) heated: Laws,
}

/// The laws of a material in the plane (plane strain and plane stress) and in space.
pub(crate) struct Laws {
    pub(crate) plane_strain: fn() -> Box<dyn Law<2>>,
    pub(crate) plane_stress: fn() -> Box<dyn Law<2>>,
    pub(crate) space: fn() -> Box<dyn Law<3>>,
}

macro_rules! entries {
    ($($name:literal $material:ident),*) => {
        /// The names of all materials.
        pub const NAMES: &[&str] = &[$($name),*];
        /// All materials.
        pub(crate) const ALL: &[Entry] = &[$(Entry {
            name: $name,
            cold: Laws {
                plane_strain: || Box::new(Lift($material)),
                plane_stress: || Box::new(PlaneStress(Box::new(Lift($material)))),
                space: || Box::new(Lift($material)),
            },
            heated: Laws {
                plane_strain: || {
                    Box::new(HeatedSlice { plane: Box::new(Lift($material)), space: Box::new(Lift($material)) })
                },
                plane_stress: || Box::new(Heated(Box::new(PlaneStress(Box::new(Lift($material)))))),
                space: || Box::new(Heated(Box::new(Lift($material)))),
            },
        }),*];
    };
}
entries! {
    "linear" Linear,
    "st_venant_kirchhoff" StVenantKirchhoff,
    "corotated" Corotated,
    "fixed_corotated" FixedCorotated,
    "neo_hookean" NeoHookean,
    "stable_neo_hookean" StableNeoHookean,
    "mooney_rivlin" MooneyRivlin
}
