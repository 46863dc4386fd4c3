//! # Materials
//!
//! Functions of the deformation gradient F in a file each, for every model of a solid: [`Linear`], [`StVenantKirchhoff`],
//! [`Corotated`], [`FixedCorotated`], [`NeoHookean`], [`StableNeoHookean`], [`MooneyRivlin`]. Each has an energy density ψ(F),
//! P = ∂ψ/∂F and ∂P/∂F, in space and in plane strain. Plane stress makes a law of the plane of the law of space: the stretch of
//! the thickness is that without stress across, at every point, and is condensed out of the tangent. Heat makes a law of
//! F/g of any of these (file `heat`).
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

/// A material of the list: its word and its laws.
pub(crate) struct Entry {
    pub(crate) name: &'static str,
    /// At the temperature of rest.
    pub(crate) cold: Laws,
    /// Where any point may be warmer or colder.
    pub(crate) heated: Laws,
}

/// Laws of a material in the plane (strain and stress) and in space.
pub(crate) struct Laws {
    pub(crate) plane_strain: fn() -> Box<dyn Law<2>>,
    pub(crate) plane_stress: fn() -> Box<dyn Law<2>>,
    pub(crate) space: fn() -> Box<dyn Law<3>>,
}

macro_rules! entries {
    ($($name:literal $material:ident),*) => {
        /// The words of all materials.
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
