//! # Boundary elements
//!
//! A linear elastic solid by its boundary alone. Kelvin's solution U and its tractions T turn the equations of elasticity inside into
//! one on the boundary (Somigliana), which collocation makes G t = H u for linear displacements u and tractions t. The forces on the
//! vertices are those of the tractions, f = Mᵀ G⁻¹ H u, so the stiffness is the symmetric part of Mᵀ G⁻¹ H, freed of rigid motion (file
//! `assembly`). A body that moves has U = ½ uᵀ K u with u = Rᵀ(x − x̄) − X in the frame R that is nearest to it (file `frame`). The
//! infinite medium around a boundary (`exterior`) does not turn: u = x − X.
//!
//! Collocation, and not Galerkin's method: one integral instead of two, and what it loses, symmetry, is small (the readings say how small).
//!
//! Limits: strain is small in the frame R, and there is one frame, so a slender body that bends by large angles is too stiff and
//! grows. The mass lies on the boundary. Vertices: at most 2000, since all matrices are dense.

#[cfg(not(target_arch = "wasm32"))]
mod assembly;
#[cfg(not(target_arch = "wasm32"))]
mod body;
#[cfg(not(target_arch = "wasm32"))]
mod cache;
#[cfg(not(target_arch = "wasm32"))]
mod frame;
#[cfg(not(target_arch = "wasm32"))]
mod integrals;
#[cfg(not(target_arch = "wasm32"))]
mod kernels;
#[cfg(not(target_arch = "wasm32"))]
mod progress;
#[cfg(not(target_arch = "wasm32"))]
mod quadrature;
mod refusals;
#[cfg(not(target_arch = "wasm32"))]
mod skin;
mod spec;
#[cfg(not(target_arch = "wasm32"))]
mod stresses;
#[cfg(not(target_arch = "wasm32"))]
mod surface;

#[cfg(not(target_arch = "wasm32"))]
pub use body::BoundaryElement;
pub use refusals::{NoSolution, Refusal, TurnedFacets};
pub use spec::SPEC;

use opruga_core::error::BuildError;
use opruga_core::memory::{Counts, Need};
use opruga_core::potential::{Ingredients, Model, Potential};
use opruga_core::spec::Spec;

/// Vertices at most.
pub const MOST_VERTICES: usize = 2000;

/// The kind `boundary_element`.
#[derive(Debug)]
pub struct BoundaryElementModel;

/// What the matrices take while they are made [bytes]: three of them of D rows for each traction, which are a seventh more than vertices.
fn bytes(dimensions: usize, nodes: f64) -> f64 {
    let rows = 1.15 * dimensions as f64 * nodes;
    8.0 * 3.5 * rows * rows
}

impl<const D: usize> Model<D> for BoundaryElementModel {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }
    fn need(&self, counts: &Counts) -> Need {
        Need { bytes: bytes(D, counts.nodes), couplings: 0.0 }
    }
    fn build(&self, ingredients: &Ingredients<D>) -> Result<Box<dyn Potential<D>>, BuildError> {
        let nodes = ingredients.mesh.nodes();
        if nodes > MOST_VERTICES {
            return Err(Refusal::TooMany { nodes, bytes: bytes(D, nodes as f64), most: MOST_VERTICES }.into());
        }
        // Large dense systems would take a twentieth of the page, and grow the other models.
        #[cfg(target_arch = "wasm32")]
        return Err(Refusal::Page {}.into());
        #[cfg(not(target_arch = "wasm32"))]
        Ok(Box::new(BoundaryElement::new(ingredients)?))
    }
}
