//! The materials, one file each.

mod corotated;
mod fixed_corotated;
mod linear;
mod mooney_rivlin;
mod neo_hookean;
mod st_venant_kirchhoff;
mod stable_neo_hookean;

pub use corotated::Corotated;
pub use fixed_corotated::FixedCorotated;
pub use linear::Linear;
pub use mooney_rivlin::MooneyRivlin;
pub use neo_hookean::NeoHookean;
pub use st_venant_kirchhoff::StVenantKirchhoff;
pub use stable_neo_hookean::StableNeoHookean;

use super::heat::{Heated, HeatedSlice};
use super::law::{Law, Lift};
use super::plane_stress::PlaneStress;

/// A material of the list: its word and its laws.
pub(super) struct Entry {
    pub(super) name: &'static str,
    /// At the temperature of rest.
    pub(super) cold: Laws,
    /// Where any point may be warmer or colder.
    pub(super) heated: Laws,
}

/// Laws of a material in the plane (strain and stress) and in space.
pub(super) struct Laws {
    pub(super) plane_strain: fn() -> Box<dyn Law<2>>,
    pub(super) plane_stress: fn() -> Box<dyn Law<2>>,
    pub(super) space: fn() -> Box<dyn Law<3>>,
}

macro_rules! entries {
    ($($name:literal $material:ident),*) => {
        /// The words of all materials.
        pub const NAMES: &[&str] = &[$($name),*];
        /// All materials.
        pub(super) const ALL: &[Entry] = &[$(Entry {
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
