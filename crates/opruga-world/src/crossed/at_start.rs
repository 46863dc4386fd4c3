//! A warning about bodies that overlap at the start.

use super::{Boundary, Crossed, Surfaces};
use crate::contact_laws::is_barrier;
use crate::warnings::{Warning, WorldWarning};
use crate::world::World;
use opruga_math::Lane;
use opruga_math::words::rounded;

/// The depth of an overlap that is not reported, relative to the size of the body: bodies that are placed side by side may overlap by rounding errors.
const DEPTH: f64 = 1e-6;

impl<const D: usize> World<D> {
    /// Warns once about bodies that begin inside or across one another in a scene whose contact would move them apart. A barrier refuses such bodies.
    pub(crate) fn warn_of_overlapping_bodies(&mut self) {
        if self.blueprint.contact.as_ref().is_none_or(is_barrier) {
            return;
        }
        let (crossed, surfaces) = self.crossed_among(|[a, b]| a != b, Surfaces::shrunk);
        let Some(first) = crossed.first() else { return };
        let [body, other] = first.bodies.map(|body| self.blueprint.bodies[body].name.clone());
        let position = self.center_of(first, &surfaces).map(|x| rounded(x, 3)).join(", ");
        let warning = WorldWarning::StartsOverlapping { body, other, pairs: crossed.len() as u64, position };
        self.warnings.push(Warning::new(warning, 1));
    }

    /// A point where two bodies overlap [m]: the centre of a facet that crosses the other body, or the centre of the common part of their boxes.
    fn center_of(&self, crossed: &Crossed, surfaces: &Surfaces<D>) -> [f64; D] {
        let [body, other] = crossed.bodies;
        let facet = crossed.facets.and_then(|[facet, _]| surfaces.origin.iter().position(|own| *own == (body, facet)));
        if let Some(facet) = facet {
            let mut center = [0.0; D];
            for point in surfaces.facets[facet] {
                let x = &surfaces.positions[point as usize];
                center.iter_mut().zip(x).for_each(|(sum, x)| *sum += x / D as f64);
            }
            return center;
        }
        let [a, b] = [body, other].map(|body| self.bounds_of(body));
        core::array::from_fn(|d| 0.5 * (a[0][d].larger(b[0][d]) + a[1][d].smaller(b[1][d])))
    }
}

impl<const D: usize> Surfaces<D> {
    /// The surfaces with all closed boundaries moved inward by a small part of the size of the body, so that bodies that only touch do not cross.
    fn shrunk(mut self) -> Surfaces<D> {
        let mut inward = vec![[0.0; D]; self.positions.len()];
        for Boundary { facets, .. } in &self.closed {
            for facet in &self.facets[facets.clone()] {
                let normal = normal(facet.map(|point| self.positions[point as usize]));
                for point in facet {
                    (0..D).for_each(|d| inward[*point as usize][d] -= normal[d]);
                }
            }
        }
        for Boundary { facets, bounds: [low, high], .. } in &self.closed {
            let size = (0..D).map(|d| high[d] - low[d]).fold(0.0, f64::larger);
            for point in self.facets[facets.clone()].iter().flatten() {
                // A point belongs to several facets, but is moved once.
                let direction = std::mem::replace(&mut inward[*point as usize], [0.0; D]);
                let length = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
                if length > 0.0 {
                    (0..D).for_each(|d| self.positions[*point as usize][d] += DEPTH * size / length * direction[d]);
                }
            }
        }
        self
    }
}

/// The outward normal of a facet, multiplied by its length in the plane and by twice its area in space.
fn normal<const D: usize>(corners: [[f64; D]; D]) -> [f64; D] {
    let side = |k: usize, d: usize| corners[k][d % D] - corners[0][d % D];
    core::array::from_fn(|d| match D {
        2 => {
            if d == 0 {
                side(1, 1)
            } else {
                -side(1, 0)
            }
        }
        _ => side(1, d + 1) * side(2, d + 2) - side(1, d + 2) * side(2, d + 1),
    })
}
