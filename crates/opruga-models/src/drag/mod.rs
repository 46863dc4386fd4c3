//! # Drag
//!
//! Every node is slowed down in proportion to its mass and velocity, as in thin air at rest:
//!
//! f_i = −λ m_i v_i, so a_i = −λ v_i and v falls as e^(−λt).
//!
//! By design, drag damps rigid motion as well: a falling body tends to the speed g/λ, and a flying body loses momentum. To damp
//! oscillations alone, use the damping of springs or of bending, which is zero under rigid motion. Drag has no energy. The
//! dissipated power is λ Σ m v². Drag is also known as mass-proportional (Rayleigh) damping.

mod spec;

pub use spec::SPEC;

use opruga_core::error::BuildError;
use opruga_core::potential::{Ingredients, Model, Observe, Potential, Properties, Sink, Views};
use opruga_core::spec::Spec;
use opruga_core::state::{Parameter, View};
use opruga_core::tile::Tile;
use opruga_math::{Lane, Pack, Simd, WIDTH, Work};

/// The kind of model that scenes call `drag`.
#[derive(Debug)]
pub struct DragModel;

/// Drag on the nodes of one body, or of eight.
#[derive(Debug)]
pub struct Drag {
    /// λ of each body [1/s].
    rate: Parameter,
    mass: Parameter,
}

impl<const D: usize> Model<D> for DragModel {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }
    fn batches(&self) -> bool {
        true
    }
    fn views(&self) -> Views {
        Views { energy: false, hessian: true, symmetric: true, damping: true }
    }
    fn build(&self, ingredients: &Ingredients<D>) -> Result<Box<dyn Potential<D>>, BuildError> {
        let rate = ingredients.by_body(|values| values.number("rate").unwrap_or(0.0));
        Ok(Box::new(Drag { rate: Parameter::by_body(rate), mass: ingredients.mass.clone() }))
    }
}

impl<const D: usize> Potential<D> for Drag {
    fn properties(&self) -> Properties {
        Properties {
            uniform_damping: (0..WIDTH).map(|body| self.rate.at(body)).fold(f64::INFINITY, Lane::smaller),
            ..Properties::new(SPEC.kind, Views { energy: false, hessian: true, symmetric: true, damping: true })
        }
    }
    fn add_force(&self, simd: Simd, view: &View<D>, _scratch: &[f64], tile: &mut Tile<D>) {
        simd.run(Force { drag: self, view, tile });
    }
    fn damping_matrix(&self, view: &View<D>, _scratch: &[f64], sink: &mut dyn Sink<D>) {
        for index in 0..view.nodes * view.layout.stride() {
            let strength = self.rate.at(index) * self.mass.at(index);
            let block = core::array::from_fn(|i| core::array::from_fn(|j| if i == j { strength } else { 0.0 }));
            sink.block(index, index, block);
        }
    }
}

impl<const D: usize> Observe<D> for Drag {
    fn heap_bytes(&self) -> usize {
        self.rate.heap_bytes() + self.mass.heap_bytes()
    }
}

struct Force<'a, 'b, 'c, const D: usize> {
    drag: &'a Drag,
    view: &'a View<'a, D>,
    tile: &'b mut Tile<'c, D>,
}
impl<const D: usize> Work for Force<'_, '_, '_, D> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let Force { drag, view, tile } = self;
        tile.settle_by::<P>();
        let start = tile.range.start;
        let end = view.nodes * view.layout.stride();
        let mut power = P::from_array(*tile.power);
        for index in tile.range.clone().step_by(WIDTH) {
            let strength = drag.rate.load::<P>(index) * drag.mass.load::<P>(index);
            // Indices after the last node carry no force.
            let strength = P::select(P::first(end.saturating_sub(index)), strength, P::zero());
            for d in 0..D {
                let v = P::load(&view.v[d][index..]);
                let force = strength * v;
                power += force * v;
                let k = index - start;
                (P::load(&tile.force[d][k..]) - force).store(&mut tile.force[d][k..]);
            }
        }
        power.store(tile.power);
    }
}
