//! # Finite volumes
//!
//! The force on a node is the force that the stress exerts on the part of the body that belongs to the node (Teran, Blemker,
//! Ng-Thow-Hing, Fedkiw 2003). That part is the dual cell of the node. The faces of the dual cell lie between the centres of
//! edges, sides and cells. With the area vectors S of the dual faces at rest,
//!
//! fᵢ = Σ P(F) S,  fⱼ = −Σ P(F) S over the dual faces from i to j.
//!
//! The net force of each face is therefore exactly zero, and Σ x × f = 0 if P Fᵀ is symmetric and F is the same for all faces
//! of a cell.
//!
//! | cell | F | energy |
//! |---|---|---|
//! | triangle, tetrahedron | constant, ∇Nₐ = −Wₐ/V with Wₐ = Σ S around a corner | V ψ(F); forces and Hessian are those of linear finite elements |
//! | quadrilateral, hexahedron | at the centre of each dual face | none: the tangent is not symmetric if F differs between faces |
//!
//! For triangles and tetrahedra Kₐᵦ = Wₐ · ∂P/∂F · Wᵦ/V. For boxes the tangent is −∂fᵢ/∂x_b = −Σ S · ∂P/∂F · ∇N_b at the centre
//! of the face. `equilibrium` accepts this tangent, and implicit integrators refuse it with a reason. Materials are those of
//! [`crate::materials`].
//!
//! A constant F is exact on cells of any shape, because the dual faces around an inner node form a closed surface.
//!
//! Limits: triangles and tetrahedra lock as linear finite elements do. Boxes that bend conserve angular momentum only
//! approximately, because F, and with it P Fᵀ, differs between the faces of a cell.

mod cell;
mod cells;
mod kernels;
mod part;
mod refusals;
mod solid;
mod spec;

pub use refusals::Refusal;
pub use solid::Solid;
pub use spec::SPEC;

use crate::materials::law::Law;
use crate::materials::moduli::{lame, refuse_what_is_not_convex};
use crate::materials::points::{MOST_PACKS, PARAMETERS};
use crate::materials::{ALL, Laws};
use cell::{Hexahedron, Quadrilateral, Tetrahedron, Triangle};
use cells::Cells;
use opruga_core::error::BuildError;
use opruga_core::memory::{Counts, Need};
use opruga_core::potential::{Ingredients, Model, Potential, Views};
use opruga_core::spec::Spec;
use opruga_math::WIDTH;
use part::{Matter, Part};

/// The kind of model that scenes call `finite_volume`.
#[derive(Debug)]
pub struct FiniteVolumeModel;

/// Poisson's ratio above which triangles and tetrahedra are refused.
const LOCKS_ABOVE: f64 = 0.45;

/// Some bodies have no energy, but all have a tangent.
const VIEWS: Views = Views { energy: false, hessian: true, symmetric: false, damping: false };

/// The data common to both dimensions.
struct Builder<'a, const D: usize> {
    ingredients: &'a Ingredients<'a, D>,
    laws: &'static Laws,
    parts: Vec<Box<dyn Part<D>>>,
    /// The total volume at rest [m³].
    volume: f64,
    is_simplicial: bool,
}

impl<'a, const D: usize> Builder<'a, D> {
    fn new(ingredients: &'a Ingredients<'a, D>) -> Result<Self, BuildError> {
        let cells = &ingredients.mesh.cells;
        if cells.is_empty() {
            return Err(Refusal::NoCells {}.into());
        }
        let count = cells.quadratic_triangles.len() + cells.quadratic_tetrahedra.len();
        if count > 0 {
            return Err(Refusal::Quadratic { count }.into());
        }
        let name = ingredients.values[0].text("material").unwrap_or("");
        let entry = ALL.iter().find(|entry| entry.name == name);
        let laws = &entry.ok_or_else(|| Refusal::NoMaterial { name: name.into() })?.cold;
        for values in ingredients.values {
            refuse_what_is_not_convex(values, values.number("poissons_ratio").unwrap_or(0.0))?;
        }
        Ok(Builder { ingredients, laws, parts: Vec::new(), volume: 0.0, is_simplicial: true })
    }

    fn is_stress(&self) -> bool {
        D == 2 && self.ingredients.values[0].text("plane") == Some("stress")
    }

    fn add<C: cell::Cell<D, N>, const N: usize>(&mut self, list: &[[u32; N]], first: usize) -> Result<(), BuildError> {
        if list.is_empty() {
            return Ok(());
        }
        if C::SIMPLEX && !self.is_stress() {
            for values in self.ingredients.values {
                let ratio = values.number("poissons_ratio").unwrap_or(0.0);
                if ratio > LOCKS_ABOVE && values.text("locking") != Some("accept") {
                    return Err(Refusal::Locks { ratio, most: LOCKS_ABOVE }.into());
                }
            }
        }
        let (layout, mesh) = (self.ingredients.layout, self.ingredients.mesh);
        let thickness = if D == 2 { self.ingredients.thickness } else { 1.0 };
        let cells = Cells::<C, D, N>::new(layout, list, first, &mesh.positions, thickness)?;
        self.volume += cells.volume.iter().sum::<f64>();
        self.is_simplicial &= C::SIMPLEX;
        self.parts.push(Box::new(cells));
        Ok(())
    }

    fn finish(self, law: Box<dyn Law<D>>, in_space: Option<Box<dyn Law<3>>>) -> Box<Solid<D>> {
        let number = |name: &'static str| self.ingredients.by_body(move |values| values.number(name).unwrap_or(0.0));
        let (young, poisson, own) = (number("youngs_modulus"), number("poissons_ratio"), number("mooney_share"));
        let moduli: [[f64; 2]; WIDTH] = core::array::from_fn(|l| lame(young[l], poisson[l]));
        let mut parameters = Vec::with_capacity(MOST_PACKS * PARAMETERS * WIDTH);
        for _ in 0..MOST_PACKS {
            parameters.extend(moduli.map(|[mu, _]| mu));
            parameters.extend(moduli.map(|[_, lambda]| lambda));
            parameters.extend(own);
            parameters.extend([1.0; WIDTH]);
        }
        let largest =
            moduli.iter().map(|[mu, lambda]| 2.0 * mu + lambda).fold(0.0, |most, x| if x > most { x } else { most });
        let energy_parts = if law.cancels() && self.is_simplicial { self.volume * largest } else { 0.0 };
        Box::new(Solid {
            layout: self.ingredients.layout,
            nodes: self.ingredients.mesh.positions.len(),
            parts: self.parts,
            matter: Matter { law, in_space, parameters },
            is_simplicial: self.is_simplicial,
            energy_parts,
        })
    }
}

impl Model<2> for FiniteVolumeModel {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }
    fn batches(&self) -> bool {
        true
    }
    fn views(&self) -> Views {
        VIEWS
    }
    fn need(&self, counts: &Counts) -> Need {
        Need { bytes: counts.cell_bytes, couplings: counts.cell_pairs }
    }
    fn build(&self, ingredients: &Ingredients<2>) -> Result<Box<dyn Potential<2>>, BuildError> {
        let mut builder = Builder::new(ingredients)?;
        let cells = &ingredients.mesh.cells;
        builder.add::<Triangle, 3>(&cells.triangles, 0)?;
        builder.add::<Quadrilateral, 4>(&cells.quadrilaterals, cells.triangles.len())?;
        let laws = builder.laws;
        let (law, space) = if builder.is_stress() {
            ((laws.plane_stress)(), None)
        } else {
            ((laws.plane_strain)(), Some((laws.space)()))
        };
        Ok(builder.finish(law, space))
    }
}

impl Model<3> for FiniteVolumeModel {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }
    fn batches(&self) -> bool {
        true
    }
    fn views(&self) -> Views {
        VIEWS
    }
    fn need(&self, counts: &Counts) -> Need {
        Need { bytes: counts.cell_bytes, couplings: counts.cell_pairs }
    }
    fn build(&self, ingredients: &Ingredients<3>) -> Result<Box<dyn Potential<3>>, BuildError> {
        let mut builder = Builder::new(ingredients)?;
        let cells = &ingredients.mesh.cells;
        builder.add::<Tetrahedron, 4>(&cells.tetrahedra, 0)?;
        builder.add::<Hexahedron, 8>(&cells.hexahedra, cells.tetrahedra.len())?;
        let law = (builder.laws.space)();
        Ok(builder.finish(law, None))
    }
}
