//! # Finite elements
//!
//! A solid whose energy is a sum over integration points (Bonet and Wood 2008; Zienkiewicz and Taylor 2005). With the shape
//! functions Nₐ of a cell, x = Σ Nₐ(ξ) xₐ, and at each integration point with the measure V
//!
//! F = ∂x/∂X = (Σ xₐ ⊗ ∂Nₐ/∂ξ)(∂X/∂ξ)⁻¹,  U = Σ V ψ(F),  fₐ = −Σ V P(F) ∂Nₐ/∂X,  Kₐᵦ = Σ V ∂Nₐ/∂X · ∂P/∂F · ∂Nᵦ/∂X.
//!
//! | cell | points | locks |
//! |---|---|---|
//! | triangle, tetrahedron | 1 | in bending; near incompressibility (refused above ν = 0.45) unless nodes resist changes of volume (`nodal_volume`) |
//! | quadrilateral, hexahedron | 4, 8, and the mean above ν = 1/3 | no |
//! | quadratic triangle, tetrahedron | 3, 4 | no |
//!
//! Quadrilaterals and hexahedra use a mean deformation gradient (Flanagan and Belytschko 1981), so that a uniform strain is
//! exact on arbitrary cells. Bending and twisting add the small strain of assumed stresses (Pian and Sumihara 1984, Pian and
//! Tong 1986), transformed by the mean gradient. The law is evaluated with that strain at the Gauss points (see the folder
//! `boxes`). A rectangular cell bends exactly for every ν, in plane strain, plane stress and space.
//!
//! **Materials** are functions of F, one file each: see [`crate::materials`].
//!
//! **Damping** is of the Kelvin–Voigt type: P = F S, S = τ (2μ Ė + λ tr Ė 1), Ė = sym FᵀḞ. It is zero under rigid motion.
//!
//! **Heat**: a point that has expanded by the factor g = 1 + α ΔT has the energy g³ ψ(F/g), or ψ(ε − αΔT 1) under the law of
//! small strain (file `materials/heat`). Without expansion none of these terms is computed.
//!
//! Limits: energies of quadratic cells are integrated with rules of degree 2, which are exact for straight sides and linear
//! laws. At small strain, boxes bend according to Hooke's law with their E and ν. In all states, Hooke's law also determines
//! how much a bent cell expands sideways. Corotated laws have no unique rotation, and so no unique force, if the two smallest
//! stretches are opposite.

mod boxes;
mod builder;
mod contraction;
mod elements;
mod group;
mod mass;
mod nodal_volume;
mod numbers;
mod part;
mod pass;
mod pressures;
mod refusals;
mod section;
mod solid;
mod spec;
mod totals;
mod work;

pub use refusals::{Refusal, Simplices};
pub use solid::Solid;
pub use spec::{SPEC, own_fields};

use builder::Builder;
use elements::{Hexahedron, QuadraticTetrahedron, QuadraticTriangle, Quadrilateral, Tetrahedron, Triangle};
use opruga_core::error::BuildError;
use opruga_core::memory::{Counts, Need};
use opruga_core::potential::{Ingredients, Model, Potential};
use opruga_core::spec::Spec;
use solid::Built;

/// The kind of model that scenes call `fem`.
#[derive(Debug)]
pub struct FemModel;

impl Model<2> for FemModel {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }
    fn batches(&self) -> bool {
        true
    }
    fn need(&self, counts: &Counts) -> Need {
        Need { bytes: counts.cell_bytes, couplings: counts.cell_pairs }
    }
    fn build(&self, ingredients: &Ingredients<2>) -> Result<Box<dyn Potential<2>>, BuildError> {
        let builder = Builder::new(ingredients)?;
        let laws = builder.laws()?;
        let (law, space) =
            if builder.stress { (laws.plane_stress, None) } else { (laws.plane_strain, Some(laws.space)) };
        let cells = &ingredients.mesh.cells;
        let mut built = Built::NOTHING;
        builder.add::<Triangle, 3>(&mut built, &cells.triangles, 0, law, space)?;
        let mut first = cells.triangles.len();
        builder.add::<Quadrilateral, 4>(&mut built, &cells.quadrilaterals, first, law, space)?;
        first += cells.quadrilaterals.len();
        builder.add::<QuadraticTriangle, 6>(&mut built, &cells.quadratic_triangles, first, law, space)?;
        Ok(builder.finish(built)?)
    }
}

impl Model<3> for FemModel {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }
    fn batches(&self) -> bool {
        true
    }
    fn need(&self, counts: &Counts) -> Need {
        Need { bytes: counts.cell_bytes, couplings: counts.cell_pairs }
    }
    fn build(&self, ingredients: &Ingredients<3>) -> Result<Box<dyn Potential<3>>, BuildError> {
        let builder = Builder::new(ingredients)?;
        let law = builder.laws()?.space;
        let cells = &ingredients.mesh.cells;
        let mut built = Built::NOTHING;
        builder.add::<Tetrahedron, 4>(&mut built, &cells.tetrahedra, 0, law, None)?;
        let mut first = cells.tetrahedra.len();
        builder.add::<Hexahedron, 8>(&mut built, &cells.hexahedra, first, law, None)?;
        first += cells.hexahedra.len();
        builder.add::<QuadraticTetrahedron, 10>(&mut built, &cells.quadratic_tetrahedra, first, law, None)?;
        Ok(builder.finish(built)?)
    }
}
