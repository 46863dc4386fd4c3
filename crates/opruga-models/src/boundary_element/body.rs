//! A body of boundary elements: its stiffness, its frame and its forces.

use super::assembly::Stiffness;
use super::frame::{Frame, Rest};
use super::refusals::TurnedFacets;
use super::skin::{Constants, Skin};
use super::surface::Surface;
use super::{SPEC, cache, stresses};
use opruga_core::error::{BuildError, StepError};
use opruga_core::potential::{
    CellState, Count, Definiteness, DensePart, Ingredients, Observe, Potential, Properties, Reading, Sink, Views,
};
use opruga_core::spec::Values;
use opruga_core::state::{Layout, View};
use opruga_core::tile::Tile;
use opruga_math::{Simd, WIDTH};
use std::sync::Arc;

/// One body, or eight identical ones with their own moduli.
#[derive(Debug)]
pub struct BoundaryElement<const D: usize> {
    layout: Layout,
    rest: Rest<D>,
    skin: Skin<D>,
    exterior: bool,
    bodies: Vec<Body>,
    /// Indices of the vertices of each body.
    indices: Vec<Vec<u32>>,
    /// The displacements that the frame follows at rest ([`Rest::follows`]).
    follows: Arc<Vec<f64>>,
    /// The length of a column.
    column: usize,
    turned: usize,
}

/// The data of one body.
#[derive(Debug)]
struct Body {
    stiffness: Arc<Stiffness>,
    /// The factor from the forces of the scaled stiffness to the forces of the body [N/m].
    strength: f64,
    /// The factor from the scaled stresses to the stresses of the body [Pa/m].
    stress: f64,
    law: Constants,
}

/// The numbers of a state in the scratch besides x, y, u and g: the frame, λ, U, and the number of the latest request for this
/// state (0 means none).
const NUMBERS: usize = 32;
const ASKED: usize = NUMBERS - 1;

/// The number of states that are kept. A step alternates between its initial state, its present state, and the state in which
/// the rigid motion is balanced, and a product with K takes most of the time. If only one state is kept, the results are the
/// same, but the steps of a free body take up to a fifth longer.
const STATES: usize = 3;

impl<const D: usize> BoundaryElement<D> {
    pub(super) fn new(ingredients: &Ingredients<D>) -> Result<BoundaryElement<D>, BuildError> {
        let (mesh, nodes) = (ingredients.mesh, ingredients.mesh.nodes());
        let exterior = ingredients.values.iter().any(|values| values.flag("exterior"));
        let surface = Surface::of(mesh, exterior)?;
        let mut bodies = Vec::new();
        for values in ingredients.values {
            bodies.push(Body::of(ingredients, values, &surface)?);
        }
        let mut shares = vec![0.0; nodes];
        for (facet, side) in surface.facets.iter().zip(&surface.sides) {
            facet.iter().for_each(|node| shares[*node as usize] += side.measure);
        }
        let positions: Vec<[f64; D]> = surface.points.iter().map(|x| x.map(|x| surface.size * x)).collect();
        let layout = ingredients.layout;
        let index = |body: usize| (0..nodes).map(|node| layout.index(node, body) as u32).collect();
        let rest = if exterior {
            Rest { positions: mesh.positions.clone(), weights: vec![0.0; nodes], inertia: 0.0 }
        } else {
            Rest::new(&positions, &shares)
        };
        let column = bodies[0].stiffness.matrix.padded();
        Ok(BoundaryElement {
            layout,
            follows: Arc::new(rest.follows(column)),
            rest,
            skin: Skin::new(&surface, ingredients.thickness),
            exterior,
            column,
            bodies,
            indices: (0..layout.stride()).map(index).collect(),
            turned: surface.turned,
        })
    }
}

impl Body {
    fn of<const D: usize>(
        ingredients: &Ingredients<D>,
        values: &Values,
        surface: &Surface<D>,
    ) -> Result<Body, BuildError> {
        let young = values.number("youngs_modulus").unwrap_or(0.0);
        let ratio = values.number("poissons_ratio").unwrap_or(0.0);
        let shear = young / (2.0 * (1.0 + ratio));
        // Plane stress is plane strain with another Poisson's ratio and the same shear modulus.
        let stress = D == 2 && values.text("plane") == Some("stress");
        let poisson = if stress { ratio / (1.0 + ratio) } else { ratio };
        let asked: Vec<[f64; D]> = values
            .rows("stress_points")
            .iter()
            .map(|row| core::array::from_fn(|d| (row[d] - surface.center[d]) / surface.size))
            .collect();
        let exterior = values.flag("exterior");
        let stiffness = cache::stiffness(surface, poisson, exterior, &asked, ingredients.break_off)?;
        let depth = if D == 2 { ingredients.thickness } else { surface.size };
        let law = Constants { shear, poisson: ratio, plane_stress: stress };
        Ok(Body { stiffness, strength: shear * depth, stress: shear / surface.size, law })
    }
    /// g = K u.
    fn product(&self, simd: Simd, u: &[f64], g: &mut [f64]) {
        self.stiffness.matrix.multiply(simd, u, g);
        g.iter_mut().for_each(|g| *g *= self.strength);
    }
}

/// The results of `prepare` for a body.
struct Known<'a, const D: usize> {
    frame: Frame<D>,
    multiplier: [f64; 3],
    energy: f64,
    y: &'a [f64],
    u: &'a [f64],
    g: &'a [f64],
}

impl<const D: usize> BoundaryElement<D> {
    fn body(&self, body: usize) -> &Body {
        &self.bodies[body.min(self.bodies.len() - 1)]
    }
    fn forces_len(&self) -> usize {
        D * self.layout.index_count(self.rest.weights.len())
    }
    /// The length of one state, and of all states of a body.
    fn of_state(&self) -> usize {
        4 * self.column + NUMBERS
    }
    fn of_body(&self) -> usize {
        STATES * self.of_state()
    }
    /// The most recently requested state of a body.
    fn known<'a>(&self, scratch: &'a [f64], body: usize) -> Known<'a, D> {
        let states = &scratch[self.forces_len() + body * self.of_body()..][..self.of_body()];
        let (_, own) = states[last_asked(states, self.of_state()) * self.of_state()..].split_at(self.column);
        let (y, own) = own.split_at(self.column);
        let (u, own) = own.split_at(self.column);
        let (g, numbers) = own.split_at(self.column);
        let mut at = numbers.iter().copied();
        let mut next = || at.next().unwrap_or(0.0);
        let mut frame = Frame { rotation: [[0.0; D]; D], stretch: [[0.0; 3]; 3], follows: [[0.0; 3]; 3] };
        frame.rotation.iter_mut().flatten().for_each(|x| *x = next());
        frame.stretch.iter_mut().flatten().for_each(|x| *x = next());
        frame.follows.iter_mut().flatten().for_each(|x| *x = next());
        let multiplier = core::array::from_fn(|_| next());
        Known { frame, multiplier, energy: next(), y, u, g }
    }
    fn prepare_body(&self, simd: Simd, view: &View<D>, body: usize, scratch: &mut [f64]) {
        let states = &mut scratch[self.forces_len() + body * self.of_body()..][..self.of_body()];
        let (length, index) = (self.of_state(), |node: usize| view.layout.index(node, body));
        let last = states[last_asked(states, length) * length..][self.numbers() + ASKED];
        let is_this = |state: &[f64]| {
            let mut nodes = state.chunks_exact(D).enumerate().take(self.rest.weights.len());
            let same = |(node, x): (usize, &[f64])| {
                view.position(index(node)).iter().zip(x).all(|(now, x)| now.to_bits() == x.to_bits())
            };
            state[self.numbers() + ASKED] > 0.0 && nodes.all(same)
        };
        let found = states.chunks_exact(length).position(is_this);
        let number = found.unwrap_or_else(|| {
            let asked = |number: &usize| states[number * length + self.numbers() + ASKED];
            (0..STATES).min_by(|a, b| asked(a).total_cmp(&asked(b))).unwrap_or(0)
        });
        let state = &mut states[number * length..][..length];
        if found.is_none() {
            self.compute(simd, view, body, state);
        }
        state[self.numbers() + ASKED] = last + 1.0;
        let Known { frame, multiplier, g, .. } = self.known(scratch, body);
        let forces: Vec<[f64; D]> =
            (0..self.rest.weights.len()).map(|node| self.rest.force(&frame, &multiplier, node, g)).collect();
        let indices = self.forces_len() / D;
        for (node, force) in forces.iter().enumerate() {
            (0..D).for_each(|d| scratch[d * indices + index(node)] = force[d]);
        }
    }
    /// The offset of the numbers of a state.
    fn numbers(&self) -> usize {
        4 * self.column
    }
    /// Computes a state.
    fn compute(&self, simd: Simd, view: &View<D>, body: usize, state: &mut [f64]) {
        let (x, own) = state.split_at_mut(self.column);
        let (y, own) = own.split_at_mut(self.column);
        let (u, own) = own.split_at_mut(self.column);
        let (g, numbers) = own.split_at_mut(self.column);
        let index = |node: usize| view.layout.index(node, body);
        for (node, x) in x.chunks_exact_mut(D).enumerate().take(self.rest.weights.len()) {
            x.copy_from_slice(&view.position(index(node)));
        }
        let frame = if self.exterior {
            for (node, rest) in self.rest.positions.iter().enumerate() {
                let x = view.position(index(node));
                (0..D).for_each(|d| u[node * D + d] = x[d] - rest[d]);
            }
            let rotation = opruga_math::matrix::identity();
            Frame { rotation, stretch: [[0.0; 3]; 3], follows: [[0.0; 3]; 3] }
        } else {
            self.rest.frame(|node| view.position(index(node)), y, u)
        };
        self.body(body).product(simd, u, g);
        let multiplier = if self.exterior { [0.0; 3] } else { self.rest.multiplier(&frame, y, g) };
        let energy = 0.5 * opruga_solve::dot(u, g);
        let all = frame.rotation.iter().flatten().chain(frame.stretch.iter().flatten());
        let all = all.chain(frame.follows.iter().flatten()).chain(&multiplier).chain([&energy]);
        numbers.iter_mut().zip(all).for_each(|(to, x)| *to = *x);
    }
}

/// The index of the state that was last requested.
fn last_asked(states: &[f64], length: usize) -> usize {
    let asked = |number: &usize| states[number * length + length - NUMBERS + ASKED];
    (0..STATES).max_by(|a, b| asked(a).total_cmp(&asked(b))).unwrap_or(0)
}

impl<const D: usize> Potential<D> for BoundaryElement<D> {
    fn properties(&self) -> Properties {
        let views = Views { energy: true, hessian: true, symmetric: true, damping: false };
        Properties {
            scratch_len: self.forces_len() + self.layout.stride() * self.of_body(),
            forces_in_prepare: true,
            acts_between_nodes: Some(!self.exterior),
            ..Properties::new(SPEC.kind, views)
        }
    }
    fn prepare(&self, simd: Simd, view: &View<D>, _memory: &[f64], scratch: &mut [f64]) -> Result<(), StepError> {
        for body in 0..self.layout.stride() {
            self.prepare_body(simd, view, body, scratch);
        }
        Ok(())
    }
    fn add_force(&self, _simd: Simd, _view: &View<D>, scratch: &[f64], tile: &mut Tile<D>) {
        let indices = self.forces_len() / D;
        for d in 0..D {
            let from = &scratch[d * indices..(d + 1) * indices];
            for (force, own) in tile.force[d].iter_mut().zip(&from[tile.range.start.min(indices)..]) {
                *force += own;
            }
        }
    }
    fn energy(&self, _simd: Simd, _view: &View<D>, scratch: &[f64]) -> [f64; WIDTH] {
        let mut out = [0.0; WIDTH];
        for (body, energy) in out.iter_mut().enumerate().take(self.layout.stride()) {
            *energy = self.known(scratch, body).energy;
        }
        out
    }
    fn hessian(&self, _view: &View<D>, scratch: &[f64], keep: Definiteness, sink: &mut dyn Sink<D>) {
        for (number, indices) in self.indices.iter().enumerate() {
            let (body, known) = (self.body(number), self.known(scratch, number));
            let following = (!self.exterior).then(|| {
                let state = [known.y, known.g];
                self.rest.following(&known.frame, &known.multiplier, state, keep, &self.follows, body.strength)
            });
            sink.dense(&DensePart {
                factor: body.strength,
                frame: &known.frame.rotation,
                indices,
                matrix: &body.stiffness.matrix,
                following: following.as_ref(),
            });
        }
    }
}

impl<const D: usize> Observe<D> for BoundaryElement<D> {
    fn readings(&self, _view: &View<D>, scratch: &[f64], _memory: &[f64], body: usize) -> Vec<Reading> {
        let own = self.body(body);
        let changes = own.stiffness.changes;
        let mut out: Vec<Reading> = vec![
            ("asymmetry".into(), changes.asymmetry),
            ("rigid_part".into(), changes.rigid),
            ("rotation_error".into(), changes.rotation),
            ("negative_part".into(), changes.negative),
        ];
        let u = self.known(scratch, body).u;
        let components = stresses::components(D);
        for (number, row) in own.stiffness.stresses.iter().enumerate() {
            let (point, (_, _, name)) = (number / components.len(), components[number % components.len()]);
            out.push((format!("stress{point}.{name}").into(), own.stress * opruga_solve::dot(row, &u[..row.len()])));
        }
        out
    }
    fn facet_states(&self, view: &View<D>, body: usize) -> Vec<CellState> {
        let mut scratch = vec![0.0; self.properties().scratch_len];
        self.prepare_body(Simd::best(), view, body, &mut scratch);
        let known = self.known(&scratch, body);
        self.skin.states(self.body(body).law, &known.frame.rotation, known.u, known.g)
    }
    fn counts(&self, _memory: &[f64]) -> Vec<Count> {
        let count = Count { what: TurnedFacets::Turned {}.into(), count: self.turned as u64 };
        if self.turned > 0 { vec![count] } else { Vec::new() }
    }
    fn same_bits_everywhere(&self) -> bool {
        false
    }
    fn heap_bytes(&self) -> usize {
        let matrices = self.bodies.iter().map(|body| body.stiffness.matrix.heap_bytes()).sum::<usize>();
        matrices + self.skin.heap_bytes() + self.indices.len() * self.rest.weights.len() * 4
    }
}
