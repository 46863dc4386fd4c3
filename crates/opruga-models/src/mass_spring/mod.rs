//! # Mass–spring system
//!
//! Particles joined by linear springs (Nealen et al. 2005, §4; thesis 3.2). The energy of one spring between a and b, with d =
//! x_a − x_b and r = |d|:
//!
//! U = ½ k (r − l₀)²,  f_a = −k (r − l₀) d/r − c (ḋ·d/r) d/r,  f_b = −f_a,
//!
//! ∂²U/∂x_a∂x_a = k (n nᵀ + (1 − l₀/r)(1 − n nᵀ)), n = d/r. A compressed spring has a negative eigenvalue across its axis,
//! which the clamped Hessian omits. The damping matrix is −∂f_a/∂v_a = c n nᵀ. Springs resist neither bending nor a change of
//! enclosed area.

mod law;
mod refusals;
mod spec;

use law::SpringLaw;
pub use refusals::Refusal;
pub use spec::SPEC;

use opruga_core::error::BuildError;
use opruga_core::memory::{Counts, Need};
use opruga_core::pair::PairTable;
use opruga_core::potential::{Definiteness, Ingredients, Model, Observe, Potential, Properties, Sink, Views};
use opruga_core::spec::Spec;
use opruga_core::state::{Layout, Parameter, View};
use opruga_core::tile::Tile;
use opruga_math::{Pack, Simd, WIDTH, Work};
use opruga_mesh::EdgeSet;

/// The kind of model that scenes call `mass_spring`.
#[derive(Debug)]
pub struct MassSpring;

/// The springs of one body, or of eight identical ones.
#[derive(Debug)]
pub struct Springs {
    layout: Layout,
    table: PairTable,
    rest_length: Parameter,
    stiffness: Parameter,
    damping: Parameter,
    damped: bool,
}

impl<const D: usize> Model<D> for MassSpring {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }
    fn batches(&self) -> bool {
        true
    }
    fn need(&self, counts: &Counts) -> Need {
        Need { bytes: 110.0 * counts.edges, couplings: counts.edges }
    }
    fn build(&self, ingredients: &Ingredients<D>) -> Result<Box<dyn Potential<D>>, BuildError> {
        let mesh = ingredients.mesh;
        let word = ingredients.values[0].text("edges").unwrap_or("all");
        let set = match word {
            "boundary" => EdgeSet::Boundary,
            "shear" => EdgeSet::AllWithShear,
            _ => EdgeSet::All,
        };
        let edges = mesh.edges(set);
        if edges.is_empty() {
            return Err(Refusal::NoEdges { edges: word.into() }.into());
        }
        let lengths: Vec<f64> =
            edges.iter().map(|&[a, b]| distance(&mesh.positions[a as usize], &mesh.positions[b as usize])).collect();
        for values in ingredients.values {
            values.check_choices(&SPEC)?;
            if values.number("modulus").is_some()
                && let Some(k) = lengths.iter().position(|l| *l == 0.0)
            {
                return Err(Refusal::NoLengthOfSpring { edge: k }.into());
            }
        }
        let areas = mesh.edge_areas(&edges).map_err(|problem| Refusal::Mesh { problem })?;
        if ingredients.values[0].number("modulus").is_some() && areas.iter().all(|a| *a == 0.0) {
            return Err(Refusal::NoTriangles {}.into());
        }
        let table = PairTable::new(ingredients.layout, mesh.positions.len(), &edges, true);
        let values = |body: usize| ingredients.values[body.min(ingredients.values.len() - 1)];
        let count = table.parameter_count();
        let each = |number: &dyn Fn(usize, usize) -> f64| {
            // The padding pair after the last pair has no stiffness and no damping.
            Parameter::from_items(ingredients.layout, count, |spring, body| {
                if spring < edges.len() { number(spring, body) } else { 0.0 }
            })
        };
        let damped = ingredients.values.iter().any(|v| v.number("damping").unwrap_or(0.0) > 0.0);
        Ok(Box::new(Springs {
            layout: ingredients.layout,
            rest_length: each(&|s, b| lengths[s] * values(b).number("rest_scale").unwrap_or(1.0)),
            stiffness: each(&|s, b| match values(b).number("modulus") {
                Some(modulus) => modulus * areas[s] / (lengths[s] * lengths[s]),
                None => values(b).number("stiffness").unwrap_or(0.0),
            }),
            damping: each(&|_, b| values(b).number("damping").unwrap_or(0.0)),
            table,
            damped,
        }))
    }
}

fn distance<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    let d: [f64; D] = core::array::from_fn(|i| a[i] - b[i]);
    law::dot(&d, &d).sqrt()
}

impl Springs {
    fn law<const DAMPED: bool>(&self) -> SpringLaw<'_, DAMPED> {
        SpringLaw { rest_length: &self.rest_length, stiffness: &self.stiffness, damping: &self.damping }
    }
}

impl<const D: usize> Potential<D> for Springs {
    fn properties(&self) -> Properties {
        Properties {
            begins_tiles: true,
            ..Properties::new(
                "mass_spring",
                Views { energy: true, hessian: true, symmetric: true, damping: self.damped },
            )
        }
    }
    fn stencils(&self, visit: &mut dyn FnMut(&[u32])) {
        self.table.pairs().iter().for_each(|pair| visit(pair));
    }
    fn add_force(&self, simd: Simd, view: &View<D>, _scratch: &[f64], tile: &mut Tile<D>) {
        if self.damped {
            self.table.add_force(simd, self.law::<true>(), view, tile);
        } else {
            self.table.add_force(simd, self.law::<false>(), view, tile);
        }
    }
    fn energy(&self, simd: Simd, view: &View<D>, _scratch: &[f64]) -> [f64; WIDTH] {
        simd.run(Energy { springs: self, view })
    }
    fn hessian(&self, view: &View<D>, _scratch: &[f64], keep: Definiteness, sink: &mut dyn Sink<D>) {
        let bodies = self.layout.stride();
        for (spring, &[a, b]) in self.table.pairs().iter().enumerate() {
            for body in 0..bodies {
                let (a, b) = (self.layout.index(a as usize, body), self.layout.index(b as usize, body));
                let at = self.layout.index(spring, body);
                let (xa, xb) = (view.position(a), view.position(b));
                let d: [f64; D] = core::array::from_fn(|i| xa[i] - xb[i]);
                let (length, inverse) = law::length(&d);
                // Coincident ends have no force and no direction. Their blocks are delivered as zeros, so that the order of calls
                // does not change.
                let (k, mut across) = if inverse == 0.0 {
                    (0.0, 0.0)
                } else {
                    let k = self.stiffness.at(at);
                    (k, k * (1.0 - self.rest_length.at(at) / length))
                };
                if keep == Definiteness::Clamped && across < 0.0 {
                    across = 0.0;
                }
                let n = d.map(|c| c * inverse);
                let block: [[f64; D]; D] = core::array::from_fn(|i| {
                    core::array::from_fn(|j| {
                        let along = n[i] * n[j];
                        k * along + across * (if i == j { 1.0 - along } else { -along })
                    })
                });
                let minus = block.map(|row| row.map(|c| -c));
                sink.block(a, a, block);
                sink.block(b, b, block);
                sink.block(a, b, minus);
                sink.block(b, a, minus);
            }
        }
    }
    fn damping_matrix(&self, view: &View<D>, _scratch: &[f64], sink: &mut dyn Sink<D>) {
        for (spring, &[a, b]) in self.table.pairs().iter().enumerate() {
            for body in 0..self.layout.stride() {
                let (a, b) = (self.layout.index(a as usize, body), self.layout.index(b as usize, body));
                let c = self.damping.at(self.layout.index(spring, body));
                let (xa, xb) = (view.position(a), view.position(b));
                let d: [f64; D] = core::array::from_fn(|i| xa[i] - xb[i]);
                let (_, inverse) = law::length(&d);
                let n = d.map(|component| component * inverse);
                let block: [[f64; D]; D] = core::array::from_fn(|i| core::array::from_fn(|j| c * n[i] * n[j]));
                let minus = block.map(|row| row.map(|entry| -entry));
                sink.block(a, a, block);
                sink.block(b, b, block);
                sink.block(a, b, minus);
                sink.block(b, a, minus);
            }
        }
    }
}

impl<const D: usize> Observe<D> for Springs {
    fn bonds(&self) -> &[[u32; 2]] {
        self.table.pairs()
    }
    fn heap_bytes(&self) -> usize {
        self.table.heap_bytes()
            + self.rest_length.heap_bytes()
            + self.stiffness.heap_bytes()
            + self.damping.heap_bytes()
    }
}

struct Energy<'a, const D: usize> {
    springs: &'a Springs,
    view: &'a View<'a, D>,
}
impl<const D: usize> Work for Energy<'_, D> {
    type Output = [f64; WIDTH];
    #[inline(always)]
    fn run<P: Pack>(self) -> [f64; WIDTH] {
        let law = self.springs.law::<false>();
        let sum = self.springs.table.sum::<P, _, D>(self.view, law);
        let mut out = [0.0; WIDTH];
        match self.springs.layout {
            Layout::Single => out[0] = sum.to_array()[0],
            Layout::Batch => sum.store(&mut out),
        }
        out
    }
}
