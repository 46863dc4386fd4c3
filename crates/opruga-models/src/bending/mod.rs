//! # Bending
//!
//! Outlines, chains and shells that resist a change of their angles, as thin walls do (Grinspun et al. 2003; for outlines, the
//! two-dimensional counterpart). A hinge is a node between two edges or an edge between two triangles. Over all hinges,
//!
//! U = Σ ½ k (θ − θ₀)²,  f = −k (θ − θ₀) ∇θ − c θ̇ ∇θ.
//!
//! θ comes from atan2 of its sine and cosine, so that it is accurate at every angle. ∇θ is exact, and the Hessian is its exact
//! derivative by dual numbers. [`SPEC`] describes how k follows from a modulus and a thickness, and what happens to degenerate
//! hinges.
//!
//! Two closed forms hold for the outline with k = EI/ℓ: a ring buckles under the outer pressure 3EI/R³ (Lévy), and a clamped
//! strip bends by PL³/3EI. A shell that is rolled into a cylinder has the flexural rigidity E t³/12. On a regular triangular
//! lattice, a shell has this rigidity in every direction, with a Poisson's ratio of −1/3 in bending (Seung and Nelson 1988).
//! Hinges measure only the angles across edges, so a shell that is free to warp deflects more than a plate: by an eighth on
//! the regular lattice and by a quarter on grids of right triangles.
//!
//! Limits: chains in space resist bending but not twist, and their damping does not act on a change of the plane in which they
//! bend. A hinge of such a chain that is bent at rest exerts no force when it is exactly straight.

mod angle;
pub(crate) mod hinge;
mod refusals;
mod spec;
mod turn;

pub use refusals::Refusal;
pub use spec::SPEC;

use crate::vectors::{cross, dot, in_space, minus};
use hinge::Hinge;
use opruga_core::error::BuildError;
use opruga_core::memory::{Counts, Need};
use opruga_core::potential::{Definiteness, Ingredients, Model, Observe, Potential, Properties, Sink, Views};
use opruga_core::spec::{Spec, Values};
use opruga_core::state::View;
use opruga_core::stencil::Stencils;
use opruga_core::tile::Tile;
use opruga_math::{Simd, WIDTH};
use turn::Turn;

/// The kind of model that scenes call `bending`.
#[derive(Debug)]
pub struct BendingModel;

/// The hinges of one body, or of eight identical ones.
#[derive(Debug)]
pub struct Bending {
    /// The hinges of outlines and chains.
    turns: Stencils<Turn, 3, 4>,
    /// The hinges of surfaces.
    hinges: Stencils<Hinge, 4, 4>,
    damped: bool,
}

impl<const D: usize> Model<D> for BendingModel {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }
    fn batches(&self) -> bool {
        true
    }
    fn need(&self, counts: &Counts) -> Need {
        Need { bytes: 60.0 * counts.hinges, couplings: counts.hinges }
    }
    fn build(&self, ingredients: &Ingredients<D>) -> Result<Box<dyn Potential<D>>, BuildError> {
        let mesh = ingredients.mesh;
        for values in ingredients.values {
            values.check_choices(&SPEC)?;
            match (values.number("modulus"), values.number("thickness")) {
                (Some(_), None) => return Err(Refusal::NoThickness {}.into()),
                (None, Some(_)) => return Err(Refusal::Thickness {}.into()),
                _ => {}
            }
        }
        let turns = mesh.bends().map_err(|problem| Refusal::Bends { problem })?;
        let hinges = mesh.hinges().map_err(|problem| Refusal::Hinges { problem })?;
        if turns.is_empty() && hinges.is_empty() {
            return Err(Refusal::NoHinges {}.into());
        }

        // The rest shape of each hinge: cos θ₀, sin θ₀, and k divided by E t³/12 (by E π t⁴/64 for a chain in space).
        let at = |node: u32| in_space(&mesh.positions[node as usize]);
        let mut turn_shapes = Vec::with_capacity(turns.len());
        for &[before, node, after] in &turns {
            let (u, w) = (minus(&at(node), &at(before)), minus(&at(after), &at(node)));
            let normal = cross(&u, &w);
            let mut sine = if D == 2 { normal[2] } else { dot(&normal, &normal).sqrt() };
            let cosine = dot(&u, &w);
            if D == 3 && cosine > 0.0 && sine < 1e-9 * cosine {
                // The chain is straight up to rounding, so all directions of bending are equivalent.
                sine = 0.0;
            }
            let length = 0.5 * (dot(&u, &u).sqrt() + dot(&w, &w).sqrt());
            let depth = if D == 2 { ingredients.thickness } else { 1.0 };
            turn_shapes.push(Shape::new(sine, cosine, depth / length));
        }
        let mut hinge_shapes = Vec::with_capacity(hinges.len());
        for &[a, b, c, d] in &hinges {
            let (e, ac, ad) = (minus(&at(b), &at(a)), minus(&at(c), &at(a)), minus(&at(d), &at(a)));
            let (n1, n2) = (cross(&e, &ac), cross(&ad, &e));
            let square = dot(&e, &e);
            let areas = 0.5 * (dot(&n1, &n1).sqrt() + dot(&n2, &n2).sqrt());
            hinge_shapes.push(Shape::new(-square.sqrt() * dot(&n1, &ad), dot(&n1, &n2), square / areas));
        }
        let shapes = turn_shapes.iter().chain(&hinge_shapes);
        if let Some(number) = shapes.clone().position(|s| !(s.cosine.is_finite() && s.factor.is_finite())) {
            return Err(Refusal::NoHingeLength { hinge: number }.into());
        }

        let values = |body: usize| ingredients.values[body.min(ingredients.values.len() - 1)];
        let damped = ingredients.values.iter().any(|v| v.number("damping").unwrap_or(0.0) > 0.0);
        let (layout, nodes) = (ingredients.layout, mesh.positions.len());
        Ok(Box::new(Bending {
            turns: Stencils::new(layout, nodes, &turns, damped, |hinge, body| {
                turn_shapes[hinge].parameters(values(body), D == 3)
            }),
            hinges: Stencils::new(layout, nodes, &hinges, damped, |hinge, body| {
                hinge_shapes[hinge].parameters(values(body), false)
            }),
            damped,
        }))
    }
}

/// The rest shape of a hinge.
#[derive(Clone, Copy, Debug)]
struct Shape {
    sine: f64,
    cosine: f64,
    /// Stiffness per flexural rigidity [1/m in the plane and for chains, 1 for surfaces].
    factor: f64,
}

impl Shape {
    /// Makes a shape from the sine and the cosine, which may have a common factor.
    fn new(sine: f64, cosine: f64, factor: f64) -> Shape {
        let length = (sine * sine + cosine * cosine).sqrt();
        Shape { sine: sine / length, cosine: cosine / length, factor }
    }
    /// k, c, cos θ₀, sin θ₀.
    fn parameters(&self, values: &Values, round: bool) -> [f64; 4] {
        let stiffness = match (values.number("modulus"), values.number("thickness")) {
            (Some(modulus), Some(t)) => {
                let inertia = if round { core::f64::consts::PI * t * t * t * t / 64.0 } else { t * t * t / 12.0 };
                modulus * inertia * self.factor
            }
            _ => values.number("stiffness").unwrap_or(0.0),
        };
        let straight = values.text("rest") == Some("straight");
        let (cosine, sine) = if straight { (1.0, 0.0) } else { (self.cosine, self.sine) };
        [stiffness, values.number("damping").unwrap_or(0.0), cosine, sine]
    }
}

impl Bending {
    fn parts<const D: usize>(&self) -> [&dyn Potential<D>; 2] {
        [&self.turns, &self.hinges]
    }
}

impl<const D: usize> Potential<D> for Bending {
    fn properties(&self) -> Properties {
        Properties::new(SPEC.kind, Views { energy: true, hessian: true, symmetric: true, damping: self.damped })
    }
    fn stencils(&self, visit: &mut dyn FnMut(&[u32])) {
        self.parts::<D>().iter().for_each(|part| part.stencils(visit));
    }
    fn add_force(&self, simd: Simd, view: &View<D>, scratch: &[f64], tile: &mut Tile<D>) {
        for part in self.parts::<D>() {
            part.add_force(simd, view, scratch, tile);
        }
    }
    fn energy(&self, simd: Simd, view: &View<D>, scratch: &[f64]) -> [f64; WIDTH] {
        let mut energy = [0.0; WIDTH];
        for part in self.parts::<D>() {
            let own = part.energy(simd, view, scratch);
            for l in 0..WIDTH {
                energy[l] += own[l];
            }
        }
        energy
    }
    fn hessian(&self, view: &View<D>, scratch: &[f64], keep: Definiteness, sink: &mut dyn Sink<D>) {
        for part in self.parts::<D>() {
            part.hessian(view, scratch, keep, sink);
        }
    }
    fn damping_matrix(&self, view: &View<D>, scratch: &[f64], sink: &mut dyn Sink<D>) {
        for part in self.parts::<D>() {
            part.damping_matrix(view, scratch, sink);
        }
    }
}

impl<const D: usize> Observe<D> for Bending {
    fn heap_bytes(&self) -> usize {
        self.parts::<D>().iter().map(|part| part.heap_bytes()).sum()
    }
}
