//! # Pressure of an ideal gas
//!
//! The model of the thesis (3.3; Matyka and Ollila 2003), as a potential of the enclosed volume V:
//!
//! isothermal U = −nRT ln(V/V₀) + P_a V,  adiabatic U = P₀ V₀^γ V^{1−γ}/(γ − 1) + P_a V,
//!
//! f_i = (P − P_a) ∂V/∂x_i,  ∇²U = (γP/V) ∇V ∇Vᵀ − (P − P_a) ∇²V.
//!
//! The first term of the Hessian has rank one and is delivered as such. The clamped Hessian keeps only this term. Net force and
//! net torque of a closed boundary are zero. `Gas::at` describes the behaviour at and below zero volume.
//!
//! The documentation of `as_published` lists the differences from the published program (errors E1 to E11).

mod chamber;
mod curved;
mod gas;
mod refusals;
mod spec;

use chamber::{Boundary, NodeRings};
use curved::CurvedSides;
use gas::Gas;
pub use refusals::Refusal;
pub use spec::SPEC;

use opruga_core::error::{BuildError, StepError};
use opruga_core::memory::{Counts, Need};
use opruga_core::pair::PairTable;
use opruga_core::potential::{
    Account, Count, Definiteness, Ingredients, Model, Observe, Potential, Properties, Reading, Sink, Views,
};
use opruga_core::spec::{Spec, Values};
use opruga_core::state::{Layout, View};
use opruga_core::tile::Tile;
use opruga_math::{Lane, Pack, Simd, WIDTH, Work};
use opruga_mesh::{Mesh, MeshError};

/// The kind of model that scenes call `pressure`.
#[derive(Debug)]
pub struct PressureModel;

/// The gas of one body, or of eight identical ones.
#[derive(Debug)]
pub struct Pressure {
    layout: Layout,
    /// The depth in the plane [m]. It is 1 in space.
    depth: f64,
    chambers: Vec<Chamber>,
    scratch_len: usize,
    /// Whether nRT of any gas depends on time.
    changes: bool,
}

#[derive(Debug)]
struct Chamber {
    boundary: Boundary,
    /// One gas per body.
    gases: Vec<Gas>,
    /// The offset of the data of the chamber in the scratch. The data are the volume, the force per ∂V/∂x and nRT of each body,
    /// followed by the area vectors.
    scratch: usize,
    area_len: usize,
}

/// The length of the data of a chamber in the scratch, before its area vectors.
const NUMBERS: usize = 4 * WIDTH;

/// The length of the memory of a chamber. For each body: the lost nRT₀ [J], how often the pressure was limited, how often the
/// chamber enclosed no volume, and the full nRT₀ [J] to which the loss refers.
const MEMORY: usize = 4 * WIDTH;

/// The loss of a gas since it was filled [J], from the memory of its chamber. It is zero if the scene has since set another
/// amount.
fn lost(gas: &Gas, memory: &[f64], body: usize) -> f64 {
    if memory[3 * WIDTH + body] == gas.amount { memory[body] } else { 0.0 }
}

impl<const D: usize> Model<D> for PressureModel {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }
    fn batches(&self) -> bool {
        true
    }
    fn need(&self, counts: &Counts) -> Need {
        Need { bytes: 100.0 * counts.facets, couplings: counts.facets }
    }
    fn build(&self, ingredients: &Ingredients<D>) -> Result<Box<dyn Potential<D>>, BuildError> {
        let mesh = ingredients.mesh;
        for values in ingredients.values {
            values.check_choices(&SPEC)?;
        }
        if mesh.facets.is_empty() {
            return Err(Refusal::NoBoundary {}.into());
        }
        let parts = chambers(mesh, ingredients.values)?;
        let depth = if D == 2 { ingredients.thickness } else { 1.0 };
        let nodes = mesh.positions.len();
        let mut scratch = 0;
        let mut chambers = Vec::new();
        let bends = |side: &Vec<u32>| side.len() > D;
        let all: Vec<u32> = if mesh.cells.is_empty() { Vec::new() } else { (0..nodes as u32).collect() };
        let sides: Vec<Vec<u32>> = mesh.boundary_sides(&all).into_iter().filter(bends).collect();
        for (number, facets) in parts.iter().enumerate() {
            let curved = CurvedSides::of(facets, &sides);
            let rest_volume = depth
                * match &curved {
                    Some(sides) => sides.volume(|node| mesh.positions[node as usize], |_, _| {}),
                    None => opruga_mesh::signed_volume(facets, &mesh.positions),
                };
            if rest_volume.is_nan() || rest_volume <= 0.0 {
                return Err(Refusal::NoVolume { chamber: number, volume: rest_volume }.into());
            }
            let boundary = if let Some(sides) = curved {
                Boundary::Curved(sides)
            } else if D == 2 {
                let edges: Vec<[u32; 2]> = facets.iter().map(|f| [f[0], f[1]]).collect();
                Boundary::Plane(PairTable::new(ingredients.layout, nodes, &edges, false))
            } else {
                let triangles: Vec<[u32; 3]> = facets.iter().map(|f| [f[0], f[1], f[D - 1]]).collect();
                // The mesh contains only the surface of this chamber, so nodes of other chambers have an empty ring.
                let skin = Mesh::<3> {
                    positions: mesh.positions.iter().map(|p| [p[0], p[1], p[D - 1]]).collect(),
                    facets: triangles.clone(),
                    ..Mesh::default()
                };
                let rings = skin.node_rings().map_err(|problem| Refusal::Branches { problem })?;
                Boundary::Space(NodeRings::new(&rings, triangles))
            };
            let area_len = boundary.area_len::<D>(ingredients.layout, nodes);
            let gases = ingredients.values.iter().map(|v| Gas::new(v, rest_volume)).collect();
            chambers.push(Chamber { boundary, gases, scratch, area_len });
            scratch += NUMBERS + area_len;
        }
        let changes = chambers.iter().any(|c: &Chamber| c.gases.iter().any(|g| g.changes));
        Ok(Box::new(Pressure { layout: ingredients.layout, depth, chambers, scratch_len: scratch, changes }))
    }
}

/// Returns the facets around each chamber, oriented outwards.
fn chambers<const D: usize>(mesh: &Mesh<D>, values: &[&Values]) -> Result<Vec<Vec<[u32; D]>>, BuildError> {
    let open = |problem: MeshError| Refusal::OpenBoundary { problem };
    let facets = |numbers: &[u32]| -> Vec<[u32; D]> { numbers.iter().map(|&f| mesh.facets[f as usize]).collect() };
    // Bodies that are stepped together differ only in parameters.
    if values.first().and_then(|v| v.text("inside")) != Some("cavities") {
        return Ok(mesh.chambers().map_err(open)?.iter().map(|part| facets(part)).collect());
    }
    // Seen from inside, a hole of the boundary has the opposite orientation.
    let holes = mesh.components().map_err(open)?.into_iter().filter(|component| component.signed_volume < 0.0);
    let mut parts: Vec<Vec<[u32; D]>> = holes.map(|hole| facets(&hole.facets)).collect();
    if parts.is_empty() {
        return Err(Refusal::NoCavity {}.into());
    }
    for facet in parts.iter_mut().flatten() {
        facet.swap(0, 1);
    }
    Ok(parts)
}

impl Chamber {
    fn gas(&self, body: usize) -> &Gas {
        &self.gases[body.min(self.gases.len() - 1)]
    }
    /// The results of `prepare`. For each body: volume (area), gauge pressure times depth, nRT, and 1 if its pressure was
    /// limited. The area vectors follow.
    fn known<'a>(&self, scratch: &'a [f64]) -> Known<'a> {
        let (numbers, area) = scratch[self.scratch..self.scratch + NUMBERS + self.area_len].split_at(NUMBERS);
        let (volume, rest) = numbers.split_at(WIDTH);
        let (gauge, rest) = rest.split_at(WIDTH);
        let (amount, limited) = rest.split_at(WIDTH);
        Known { volume, gauge, amount, limited, area }
    }
}

struct Known<'a> {
    volume: &'a [f64],
    gauge: &'a [f64],
    amount: &'a [f64],
    limited: &'a [f64],
    area: &'a [f64],
}

impl Pressure {
    /// The number of different bodies in a pack.
    fn bodies(&self) -> usize {
        self.layout.stride()
    }
    /// Volume [m³], pressure [Pa] and nRT [J] of a chamber of one body.
    fn chamber_state(&self, chamber: &Chamber, scratch: &[f64], body: usize) -> (f64, f64, f64) {
        let known = chamber.known(scratch);
        let (volume, amount, gas) = (known.volume[body] * self.depth, known.amount[body], chamber.gas(body));
        (volume, gas.at(volume, amount).pressure, gas.heat(volume, amount))
    }
}

impl<const D: usize> Potential<D> for Pressure {
    fn properties(&self) -> Properties {
        Properties {
            account: Account::Gas,
            scratch_len: self.scratch_len,
            forces_in_prepare: !self.chambers.iter().any(|chamber| matches!(chamber.boundary, Boundary::Plane(_))),
            ..Properties::new("pressure", Views { energy: true, hessian: true, symmetric: true, damping: false })
        }
    }
    fn stencils(&self, visit: &mut dyn FnMut(&[u32])) {
        self.chambers.iter().for_each(|chamber| chamber.boundary.stencils(visit));
    }
    fn initial_memory(&self) -> Vec<f64> {
        let mut memory = Vec::new();
        for chamber in &self.chambers {
            memory.extend([0.0; 3 * WIDTH]);
            memory.extend((0..WIDTH).map(|body| chamber.gas(body).amount));
        }
        memory
    }
    fn prepare(&self, simd: Simd, view: &View<D>, memory: &[f64], scratch: &mut [f64]) -> Result<(), StepError> {
        simd.run(Volumes { model: self, view, scratch });
        for (number, chamber) in self.chambers.iter().enumerate() {
            let scratch = &mut scratch[chamber.scratch..chamber.scratch + NUMBERS];
            for body in 0..self.bodies() {
                let gas = chamber.gas(body);
                let lost = lost(gas, &memory[number * MEMORY..], body);
                let amount = if gas.changes || lost != 0.0 { gas.amount_at(view.time, lost) } else { gas.amount };
                let (pressure, limited) = gas.pressure_at(scratch[body] * self.depth, amount);
                scratch[WIDTH + body] = (pressure - gas.ambient) * self.depth;
                scratch[2 * WIDTH + body] = amount;
                scratch[3 * WIDTH + body] = f64::from(limited);
            }
        }
        Ok(())
    }
    fn add_force(&self, simd: Simd, view: &View<D>, scratch: &[f64], tile: &mut Tile<D>) {
        for chamber in &self.chambers {
            let known = chamber.known(scratch);
            chamber.boundary.add_force(simd, view, known.gauge, known.area, tile);
        }
    }
    fn remember(&self, simd: Simd, view: &View<D>, h: f64, scratch: &mut [f64], memory: &mut [f64]) -> [f64; WIDTH] {
        let mut given = [0.0; WIDTH];
        for (number, chamber) in self.chambers.iter().enumerate() {
            let known = chamber.known(scratch);
            for body in 0..self.bodies() {
                let (gas, memory) = (chamber.gas(body), &mut memory[number * MEMORY..]);
                if memory[3 * WIDTH + body] != gas.amount {
                    (memory[body], memory[3 * WIDTH + body]) = (0.0, gas.amount);
                }
                memory[WIDTH + body] += known.limited[body];
                memory[2 * WIDTH + body] += f64::from(known.volume[body] <= 0.0);
            }
        }
        if !self.changes {
            return given;
        }
        simd.run(Volumes { model: self, view, scratch });
        for (number, chamber) in self.chambers.iter().enumerate() {
            let memory = &mut memory[number * MEMORY..(number + 1) * MEMORY];
            for body in 0..self.bodies() {
                let gas = chamber.gas(body);
                if !gas.changes {
                    continue;
                }
                let volume = scratch[chamber.scratch + body] * self.depth;
                let before = gas.amount_at(view.time - h, memory[body]);
                if gas.leak > 0.0 {
                    // Half of the inflow, then the leak, then the other half of the inflow.
                    let middle = view.time - 0.5 * h;
                    let cold = gas.cold_at(middle, memory[body]);
                    memory[body] += cold - gas.after_leak(cold, gas.warmth(middle), volume, h);
                }
                let after = gas.amount_at(view.time, memory[body]);
                given[body] += gas.at(volume, after).energy - gas.at(volume, before).energy;
            }
        }
        given
    }
    fn energy(&self, _simd: Simd, _view: &View<D>, scratch: &[f64]) -> [f64; WIDTH] {
        let mut out = [0.0; WIDTH];
        for chamber in &self.chambers {
            let known = chamber.known(scratch);
            for body in 0..self.bodies() {
                out[body] += chamber.gas(body).at(known.volume[body] * self.depth, known.amount[body]).energy;
            }
        }
        out
    }
    fn hessian(&self, view: &View<D>, scratch: &[f64], keep: Definiteness, sink: &mut dyn Sink<D>) {
        for chamber in &self.chambers {
            let known = chamber.known(scratch);
            for body in 0..self.bodies() {
                let state = chamber.gas(body).at(known.volume[body] * self.depth, known.amount[body]);
                let slope = chamber.boundary.slope(view, body);
                let u: Vec<(usize, [f64; D])> =
                    slope.into_iter().map(|(p, g)| (p, g.map(|c| c * self.depth))).collect();
                sink.low_rank(state.curvature, &u);
                if keep == Definiteness::Exact {
                    chamber.boundary.second_derivatives(view, body, -known.gauge[body], sink);
                }
            }
        }
    }
}

impl<const D: usize> Observe<D> for Pressure {
    fn readings(&self, _view: &View<D>, scratch: &[f64], _memory: &[f64], body: usize) -> Vec<Reading> {
        let mut volume = 0.0;
        let mut amount = 0.0;
        let (mut pressure, mut weight) = (0.0, 0.0);
        let mut single = Vec::new();
        for (number, chamber) in self.chambers.iter().enumerate() {
            let (v, p, nrt) = self.chamber_state(chamber, scratch, body);
            volume += v;
            amount += nrt;
            // Chambers are weighted by their size. The smallest positive number gives empty chambers equal weights.
            let size = v.abs().larger(f64::MIN_POSITIVE);
            (pressure, weight) = (pressure + p * size, weight + size);
            let name = |what: &str| format!("chamber{}.{what}", number + 1).into();
            single.extend([(name("volume"), v), (name("pressure"), p), (name("nRT"), nrt)]);
        }
        let mean = pressure / weight;
        let mut out: Vec<Reading> = vec![("volume".into(), volume), ("pressure".into(), mean), ("nRT".into(), amount)];
        if self.chambers.len() > 1 {
            out.extend(single);
        }
        out
    }
    fn node_pressures(&self, _view: &View<D>, scratch: &[f64], body: usize) -> Vec<(u32, f64)> {
        let mut out = Vec::new();
        for chamber in &self.chambers {
            let (_, pressure, _) = self.chamber_state(chamber, scratch, body);
            out.extend(chamber.boundary.nodes().iter().map(|node| (*node, pressure)));
        }
        out
    }
    fn counts(&self, memory: &[f64]) -> Vec<Count> {
        let sum = |first: usize| -> f64 {
            memory.chunks_exact(MEMORY).flat_map(|chamber| &chamber[first..first + self.bodies()]).sum()
        };
        let counted = |what: PressureWarning, first: usize| Count { what: what.into(), count: sum(first) as u64 };
        vec![counted(PressureWarning::Limited {}, WIDTH), counted(PressureWarning::Inverted {}, 2 * WIDTH)]
    }
    fn heap_bytes(&self) -> usize {
        self.chambers.iter().map(|c| c.boundary.heap_bytes() + c.gases.capacity() * size_of::<Gas>()).sum()
    }
}

opruga_math::messages! {
    /// Warnings about a gas.
    #[derive(Clone, Debug, PartialEq)]
    pub enum PressureWarning {
        /// The pressure was limited.
        "pressure.limited"
        #[error("the pressure of a gas was limited to its `largest_pressure`, or to the pressure at its `smallest_volume` (counted once per substep and body)")]
        Limited {},
        /// A chamber without volume.
        "pressure.inverted"
        #[error("a chamber enclosed nothing or was inverted; its gas pushes it open, as `opruga reference` describes, but an outline that passed through itself may not recover (counted once per substep and body)")]
        Inverted {},
    }
}

struct Volumes<'a, const D: usize> {
    model: &'a Pressure,
    view: &'a View<'a, D>,
    scratch: &'a mut [f64],
}
impl<const D: usize> Work for Volumes<'_, D> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        for chamber in &self.model.chambers {
            let scratch = &mut self.scratch[chamber.scratch..chamber.scratch + NUMBERS + chamber.area_len];
            let (numbers, area) = scratch.split_at_mut(NUMBERS);
            chamber.boundary.volume::<P, D>(self.view, area).store(numbers);
        }
    }
}
