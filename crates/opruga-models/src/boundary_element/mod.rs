//! # Boundary elements
//!
//! A linear elastic solid, represented by its boundary alone. With Kelvin's solution U and its tractions T, the equations of
//! elasticity in the interior become an equation on the boundary (Somigliana). Collocation turns this equation into G t = H u for
//! linear displacements u and tractions t. The forces on the vertices follow from the tractions, f = Mᵀ G⁻¹ H u, so the stiffness
//! is the symmetric part of Mᵀ G⁻¹ H without rigid motion (file `assembly`). A moving body has U = ½ uᵀ K u with u = Rᵀ(x − x̄) −
//! X in the nearest frame R (file `frame`). The infinite medium around a boundary (`exterior`) does not rotate: u = x − X.
//!
//! Collocation is used instead of Galerkin's method, because it needs one integral instead of two. The matrix of collocation is
//! slightly unsymmetric. A reading shows how unsymmetric it is.
//!
//! Limits: strain must be small in the frame R. A body has only one frame, so a slender body that bends by large angles is too
//! stiff and grows. The mass is on the boundary. There are at most 2000 vertices, since all matrices are dense.

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

/// The largest number of vertices.
pub const MOST_VERTICES: usize = 2000;

/// The kind of model that scenes call `boundary_element`.
#[derive(Debug)]
pub struct BoundaryElementModel;

/// The memory that the matrices need while they are computed [bytes]. There are three matrices, each with D rows for each
/// traction. There are about 15 % more tractions than vertices.
fn bytes(dimensions: usize, nodes: f64) -> f64 {
    let rows = 1.15 * dimensions as f64 * nodes;
    8.0 * 3.5 * rows * rows
}

impl<const D: usize> Model<D> for BoundaryElementModel {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }
    fn batches(&self) -> bool {
        true
    }
    fn need(&self, counts: &Counts) -> Need {
        Need { bytes: bytes(D, counts.nodes), couplings: 0.0 }
    }
    fn build(&self, ingredients: &Ingredients<D>) -> Result<Box<dyn Potential<D>>, BuildError> {
        let nodes = ingredients.mesh.nodes();
        if nodes > MOST_VERTICES {
            return Err(Refusal::TooMany { nodes, bytes: bytes(D, nodes as f64), most: MOST_VERTICES }.into());
        }
        // Dense systems would make the web page larger by a twentieth and slow down the other models.
        #[cfg(target_arch = "wasm32")]
        return Err(Refusal::Page {}.into());
        #[cfg(not(target_arch = "wasm32"))]
        Ok(Box::new(BoundaryElement::new(ingredients)?))
    }
}
