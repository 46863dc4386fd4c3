//! # Finite elements
//!
//! A solid whose energy is that of its points (Bonet and Wood 2008; Zienkiewicz and Taylor 2005): with the shape functions
//! Nₐ of a cell x = Σ Nₐ(ξ) xₐ, and at each integration point of the measure V
//!
//! F = ∂x/∂X = (Σ xₐ ⊗ ∂Nₐ/∂ξ)(∂X/∂ξ)⁻¹,  U = Σ V ψ(F),  fₐ = −Σ V P(F) ∂Nₐ/∂X,  Kₐᵦ = Σ V ∂Nₐ/∂X · ∂P/∂F · ∂Nᵦ/∂X.
//!
//! | cell | points | locks |
//! |---|---|---|
//! | triangle, tetrahedron | 1 | in bending; near incompressibility unless volumes are those of nodes (file `nodal_volume`): refused above ν = 0.45 |
//! | quadrilateral, hexahedron | 4, 8, and the mean above ν = 1/3 | no |
//! | quadratic triangle, tetrahedron | 3, 4 | no |
//!
//! Quadrilaterals and hexahedra have a mean deformation gradient (Flanagan and Belytschko 1981, so that patches of any cells are
//! exact). How they bend and twist besides is the strain that assumed stresses have at small strain (Pian and Sumihara 1984, Pian
//! and Tong 1986), carried along by the mean, and the law is asked at Gauss's points with that: see the files `hourglass` and
//! `boxes`. A rectangular cell bends exactly for every ν, in plane strain, plane stress and space.
//!
//! **Materials** are functions of F in a file each ([`materials`]): [`materials::Linear`], [`materials::StVenantKirchhoff`],
//! [`materials::Corotated`], [`materials::FixedCorotated`], [`materials::NeoHookean`], [`materials::StableNeoHookean`],
//! [`materials::MooneyRivlin`]; plane stress makes a law of the plane of the law of space: the stretch of the thickness is
//! that without stress across, at every point, and is condensed out of the tangent.
//! Clamped tangents come from the analytic eigensystem of isotropic energies ([`material::Principal`]; Smith et al. 2019).
//!
//! **Damping** is that of Kelvin and Voigt: P = F S, S = τ (2μ Ė + λ tr Ė 1), Ė = sym FᵀḞ; zero under rigid motion.
//!
//! Limits: energies of quadratic cells are integrated at points of degree 2, exact for straight sides and linear laws. Boxes bend
//! at small strain as Hooke's law of their E and ν lets them; how much a bent cell swells across is taken from there in all states.
//! Corotated laws have no unique rotation, and so no unique force, where the two smallest stretches are opposite.

mod box_matrices;
mod boxes;
mod contraction;
mod elements;
mod hourglass;
mod law;
mod mass;
pub mod material;
pub mod materials;
mod nodal_volume;
mod numbers;
mod pass;
mod plane_stress;
mod section;
mod spec;
mod work;

pub use spec::SPEC;

use boxes::beyond;
use elements::{Hexahedron, QuadraticTetrahedron, QuadraticTriangle, Quadrilateral, Shape, Tetrahedron, Triangle};
use law::Law;
use nodal_volume::NodalVolumes;
use numbers::Numbers;
use opruga_core::error::{BuildError, StepError};
use opruga_core::potential::{CellState, Definiteness, Ingredients, Model, Potential, Sink, Views};
use opruga_core::spec::Spec;
use opruga_core::state::{Layout, View};
use opruga_core::threads::each_part;
use opruga_core::tile::Tile;
use opruga_math::{ROW, Simd, WIDTH};
use opruga_mesh::Mesh;
use section::{Cell, FORCES, Part, Plan, Section, rest_gradient};
use std::sync::{Mutex, PoisonError};

/// The kind `fem`.
#[derive(Debug)]
pub struct FemModel;

/// det ∂X/∂ξ below this fraction of the cube (square) of the longest edge is no volume.
const NO_VOLUME: f64 = 1e-12;

/// The solid of one body, or of eight alike ones.
#[derive(Debug)]
pub struct Solid<const D: usize> {
    layout: Layout,
    nodes: usize,
    parts: Vec<Box<dyn Part<D>>>,
    /// The shares of all parts.
    shares: Vec<Task>,
    /// Where the scratch of each begins, behind that of the whole.
    starts: Vec<usize>,
    sums: Sums,
    /// What the consistent mass matrix has more than the lumped masses.
    inertia: Vec<(u32, u32, f64)>,
    /// What resists the volumes of nodes.
    volumes: Option<NodalVolumes<D>>,
    damped: bool,
    /// What [`Potential::energy_parts`] tells [J].
    energy_parts: f64,
}

fn refuse(code: &'static str, message: impl Into<String>) -> BuildError {
    BuildError::new(SPEC.kind, code, message)
}

/// What a solid is built of.
struct Built<const D: usize> {
    parts: Vec<Box<dyn Part<D>>>,
    inertia: Vec<(u32, u32, f64)>,
    volumes: Option<NodalVolumes<D>>,
    energy_parts: f64,
}

impl<const D: usize> Built<D> {
    const NOTHING: Built<D> = Built { parts: Vec::new(), inertia: Vec::new(), volumes: None, energy_parts: 0.0 };
}

/// What is the same for all cells while a solid is built.
struct Builder<'a, const D: usize> {
    ingredients: &'a Ingredients<'a, D>,
    /// Which cells are of this material.
    chosen: Vec<bool>,
    numbers: Numbers<'a>,
    stress: bool,
    /// The density [kg/m³, in the plane per area] of every cell where the mass matrix is consistent.
    density: Option<Vec<f64>>,
}

impl<'a, const D: usize> Builder<'a, D> {
    fn new(ingredients: &'a Ingredients<'a, D>) -> Result<Self, BuildError> {
        let (mesh, first) = (ingredients.mesh, ingredients.values[0]);
        if mesh.cells.is_empty() {
            let message = "the body has no cells: it is an outline, a surface or a chain. Filled shapes are `grid`, shapes from \
                           files with a `filling`, and volume meshes";
            return Err(refuse("model.no_cells", message));
        }
        let mut chosen = vec![true; mesh.cells.len()];
        if let Some(name) = first.text("cells") {
            let Some(group) = mesh.cell_groups.get(name) else {
                return Err(refuse(
                    "model.no_group",
                    format!("the mesh has no group of cells `{name}`; {}", known(mesh)),
                ));
            };
            chosen.fill(false);
            group.iter().for_each(|cell| chosen[*cell as usize] = true);
            if group.is_empty() {
                return Err(refuse("model.no_cells", format!("the group of cells `{name}` is empty")));
            }
        }
        let numbers = Numbers::new(ingredients, &chosen)?;
        Ok(Builder {
            ingredients,
            chosen,
            numbers,
            stress: D == 2 && first.text("plane") == Some("stress"),
            density: (first.text("mass") == Some("consistent")).then(|| densities(ingredients)).transpose()?,
        })
    }

    fn entry(&self) -> Result<&'static materials::Entry, BuildError> {
        let name = self.ingredients.values[0].text("material").unwrap_or("");
        let found = materials::ALL.iter().find(|entry| entry.name == name);
        found.ok_or_else(|| refuse("scene.unknown_name", format!("there is no material `{name}`")))
    }

    /// What holds for linear simplices near incompressibility.
    fn locking(&self) -> &str {
        self.ingredients.values[0].text("locking").unwrap_or("refuse")
    }

    /// The section of one kind of cells, the first of which has the number `first` in the mesh.
    fn add<E: Shape<D, N>, const N: usize>(
        &self,
        built: &mut Built<D>,
        list: &[[u32; N]],
        first: usize,
        law: fn() -> Box<dyn Law<D>>,
        law_in_space: Option<fn() -> Box<dyn Law<3>>>,
    ) -> Result<(), BuildError> {
        let numbered = list.iter().enumerate().filter(|(k, _)| self.chosen[first + k]);
        let cells: Vec<Cell<N>> =
            numbered.map(|(k, nodes)| Cell { number: (first + k) as u32, nodes: *nodes }).collect();
        if cells.is_empty() {
            return Ok(());
        }
        let positions = &self.ingredients.mesh.positions;
        let mut measures = Vec::with_capacity(cells.len());
        for cell in &cells {
            measures.push(self.check::<E, N>(cell, positions)?);
        }
        if let Some(density) = &self.density {
            for cell in &cells {
                let rest = cell.nodes.map(|n| positions[n as usize]);
                mass::entries::<E, D, N>(&cell.nodes, &rest, density[cell.number as usize], &mut built.inertia);
            }
        }
        let law = law();
        let nodal = E::SIMPLEX && self.locking() == "nodal_volume";
        if nodal {
            let lame = |cell: u32, body: usize| {
                let [mu, lambda, ..] = self.numbers.of(cell, body);
                [mu, lambda]
            };
            let list = cells.iter().map(|cell| (cell.number, cell.nodes));
            let (layout, thickness) = (self.ingredients.layout, if D == 2 { self.ingredients.thickness } else { 1.0 });
            let volumes = NodalVolumes::new(layout, law.turns(), positions, thickness, list, &lame);
            built.volumes = Some(volumes);
        } else if E::SIMPLEX && !self.stress {
            let kind = if D == 2 { "triangles" } else { "tetrahedra" };
            self.numbers.refuse_what_locks(&mut cells.iter().map(|cell| cell.number), kind)?;
        }
        let plan = Plan {
            layout: self.ingredients.layout,
            law,
            law_in_space: law_in_space.map(|law| law()),
            positions,
            thickness: if D == 2 { self.ingredients.thickness } else { 1.0 },
            plane_stress: self.stress,
            damped: self.numbers.damped,
        };
        let numbers = |cell: u32, body: usize| {
            let mut numbers = self.numbers.of(cell, body);
            if nodal {
                numbers[1] -= beyond(numbers[0], numbers[1]);
            }
            numbers
        };
        if plan.law.cancels() {
            let modulus = |cell: u32, body: usize| {
                let [mu, lambda, ..] = numbers(cell, body);
                2.0 * mu + lambda
            };
            let bodies = self.ingredients.values.len();
            let of_cell = |(cell, measure): (&Cell<N>, &f64)| {
                measure * (0..bodies).map(|body| modulus(cell.number, body)).sum::<f64>()
            };
            built.energy_parts += plan.thickness * cells.iter().zip(&measures).map(of_cell).sum::<f64>();
        }
        built.parts.push(Box::new(Section::<E, D, N>::new(plan, cells, &numbers)));
        Ok(())
    }

    /// Refuses a cell that is flat or turned inside out at rest; returns its volume, in the plane its area.
    fn check<E: Shape<D, N>, const N: usize>(&self, cell: &Cell<N>, positions: &[[f64; D]]) -> Result<f64, BuildError> {
        let rest: [[f64; D]; N] = cell.nodes.map(|n| positions[n as usize]);
        let mut longest = 0.0;
        for a in &rest {
            for b in &rest {
                let square: f64 = (0..D).map(|d| (a[d] - b[d]) * (a[d] - b[d])).sum();
                longest = if square > longest { square } else { longest };
            }
        }
        let size = longest.sqrt();
        let least = NO_VOLUME * (0..D).map(|_| size).product::<f64>();
        // Boxes are looked at in the middle too.
        let middle = E::BOX.then(|| E::at([0.0; 3]).1);
        let mut measure = 0.0;
        for (slopes, weight) in E::SLOPES.iter().chain(&middle).zip(E::WEIGHTS.iter().chain(&[0.0])) {
            let (_, determinant) = rest_gradient(&rest, slopes);
            if !(determinant.is_finite() && determinant > least) {
                let what = if determinant < -least { "is turned inside out" } else { "has no volume" };
                let message = format!(
                    "cell {} with the nodes {:?} {what} at rest: det ∂X/∂ξ = {determinant:e}; allowed: more than {least:e}",
                    cell.number, cell.nodes
                );
                return Err(refuse("model.inverted_cell", message));
            }
            measure += weight * determinant;
        }
        Ok(measure)
    }

    fn finish(self, built: Built<D>) -> Result<Box<Solid<D>>, BuildError> {
        let Built { parts, inertia, volumes, energy_parts } = built;
        if self.locking() == "nodal_volume" && (self.stress || volumes.is_none()) {
            let message = if self.stress {
                "`locking` is `nodal_volume`; allowed in plane stress: `refuse` or `accept`, since nothing locks where the thickness is free"
            } else {
                "`locking` is `nodal_volume`, but the cells are no linear triangles or tetrahedra; allowed for others: `refuse` or \
                 `accept`, since they do not lock"
            };
            return Err(refuse("model.locking", message));
        }
        let (layout, nodes) = (self.ingredients.layout, self.ingredients.mesh.positions.len());
        let (mut shares, mut starts) = (Vec::new(), Vec::new());
        let mut start = FORCES;
        for (part, own) in parts.iter().enumerate() {
            for (share, list) in own.shares().iter().enumerate() {
                let length = own.scratch_len(list);
                shares.push(Task { part, share, start, length });
                starts.push(start - FORCES);
                start += length;
            }
        }
        let sums = Sums::new(layout, nodes, &parts, &shares);
        let damped = self.numbers.damped;
        Ok(Box::new(Solid { layout, nodes, parts, shares, starts, sums, inertia, volumes, damped, energy_parts }))
    }
}

/// The density of every cell [kg/m³, in the plane per area], where they do not differ from the masses of the nodes.
fn densities<const D: usize>(ingredients: &Ingredients<D>) -> Result<Vec<f64>, BuildError> {
    if let Some(densities) = ingredients.densities {
        let depth = if D == 2 { ingredients.thickness } else { 1.0 };
        return Ok(densities.iter().map(|density| depth * density).collect());
    }
    let measure = ingredients.mesh.measure().map_err(|e| refuse("model.mass", e.to_string()))?.value();
    let nodes = 0..ingredients.mesh.nodes();
    Ok(vec![
        nodes.map(|node| ingredients.mass.at(ingredients.layout.place(node, 0))).sum::<f64>() / measure;
        ingredients.mesh.cells.len()
    ])
}

/// The names of the groups of cells of a mesh.
fn known<const D: usize>(mesh: &Mesh<D>) -> String {
    let names: Vec<_> = mesh.cell_groups.keys().map(|n| format!("`{n}`")).collect();
    if names.is_empty() { "it has none".into() } else { format!("known: {}", names.join(", ")) }
}

impl Model<2> for FemModel {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }
    fn build(&self, ingredients: &Ingredients<2>) -> Result<Box<dyn Potential<2>>, BuildError> {
        let builder = Builder::new(ingredients)?;
        let entry = builder.entry()?;
        let (law, space) =
            if builder.stress { (entry.plane_stress, None) } else { (entry.plane_strain, Some(entry.space)) };
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
    fn build(&self, ingredients: &Ingredients<3>) -> Result<Box<dyn Potential<3>>, BuildError> {
        let builder = Builder::new(ingredients)?;
        let law = builder.entry()?.space;
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

/// A share of one of the parts, and where its scratch lies.
#[derive(Clone, Copy, Debug)]
struct Task {
    part: usize,
    share: usize,
    start: usize,
    length: usize,
}

/// Where the forces of the nodes lie in the scratch.
#[derive(Debug)]
enum Sums {
    /// All of them one after the other from here on.
    Whole(usize),
    /// For every node in rows of several shares: where its list begins, and the lists of places [`ROW`] by [`ROW`].
    Listed { start: Vec<u32>, rows: Vec<u32> },
}

impl Sums {
    fn new<const D: usize>(layout: Layout, nodes: usize, parts: &[Box<dyn Part<D>>], tasks: &[Task]) -> Sums {
        let touched = |task: &Task| &parts[task.part].shares()[task.share].nodes;
        if let [task] = tasks
            && touched(task).len() == nodes
        {
            return Sums::Whole(task.start + FORCES);
        }
        let row = if layout == Layout::Single { 1 } else { D * WIDTH / ROW };
        let mut start = vec![0; nodes + 1];
        for node in tasks.iter().flat_map(touched) {
            start[*node as usize + 1] += 1;
        }
        for node in 0..nodes {
            start[node + 1] += start[node];
        }
        let (mut next, mut rows) = (start.clone(), vec![0; start[nodes] as usize]);
        for task in tasks {
            for (k, node) in touched(task).iter().enumerate() {
                let next = &mut next[*node as usize];
                rows[*next as usize] = ((task.start + FORCES) / ROW + k * row) as u32;
                *next += 1;
            }
        }
        Sums::Listed { start, rows }
    }
    fn heap_bytes(&self) -> usize {
        match self {
            Sums::Whole(_) => 0,
            Sums::Listed { start, rows } => 4 * (start.capacity() + rows.capacity()),
        }
    }
}

impl<const D: usize> Potential<D> for Solid<D> {
    fn name(&self) -> &'static str {
        SPEC.kind
    }
    fn views(&self) -> Views {
        Views { energy: true, hessian: true, damping: self.damped }
    }
    fn inertia(&self) -> &[(u32, u32, f64)] {
        &self.inertia
    }
    /// `prepare` has read all positions before any of them changes.
    fn spans(&self, _visit: &mut dyn FnMut(u32, u32)) {}
    fn energy_parts(&self) -> f64 {
        self.energy_parts
    }
    fn shares_threads(&self) -> bool {
        self.shares.len() > 1
    }
    /// Energies and powers, and what every share leaves.
    fn scratch_len(&self) -> usize {
        self.cells_len() + self.volumes.as_ref().map_or(0, NodalVolumes::scratch_len)
    }
    /// Evaluates every element once: energies, powers and the forces of all nodes.
    fn prepare(&self, simd: Simd, view: &View<D>, _memory: &[f64], scratch: &mut [f64]) -> Result<(), StepError> {
        let (cells, of_volumes) = scratch.split_at_mut(self.cells_len());
        let (sums, rest) = cells.split_at_mut(FORCES);
        let refused: Mutex<Option<(usize, StepError)>> = Mutex::new(None);
        each_part(view.threads, rest, &self.starts, |number, scratch| {
            let part = &self.parts[self.shares[number].part];
            if let Err(error) = part.evaluate(&part.shares()[self.shares[number].share], simd, view, scratch) {
                let mut first = refused.lock().unwrap_or_else(PoisonError::into_inner);
                if first.as_ref().is_none_or(|(other, _)| number < *other) {
                    *first = Some((number, error));
                }
            }
        });
        if let Some((_, error)) = refused.into_inner().unwrap_or_else(PoisonError::into_inner) {
            return Err(error);
        }
        sums.fill(0.0);
        for task in &self.shares {
            let own = &rest[task.start - FORCES..][..FORCES];
            for (sum, own) in sums.iter_mut().zip(own) {
                *sum += own;
            }
        }
        if let Some(volumes) = &self.volumes {
            for (sum, own) in sums.iter_mut().zip(volumes.evaluate(view, of_volumes)) {
                *sum += own;
            }
        }
        Ok(())
    }
    fn add_force(&self, _simd: Simd, _view: &View<D>, scratch: &[f64], tile: &mut Tile<D>) {
        let range = tile.range.clone();
        match (self.layout, &self.sums) {
            (Layout::Single, Sums::Whole(at)) => {
                let own = range.start..range.end.min(self.nodes).max(range.start);
                for (k, row) in scratch[at + own.start * ROW..at + own.end * ROW].chunks_exact(ROW).enumerate() {
                    for d in 0..D {
                        tile.force[d][k] += row[d];
                    }
                }
            }
            (Layout::Single, Sums::Listed { start, rows }) => {
                for node in range.start..range.end.min(self.nodes) {
                    let mut sum = [0.0; ROW];
                    for row in &rows[start[node] as usize..start[node + 1] as usize] {
                        let row = &scratch[*row as usize * ROW..][..ROW];
                        for d in 0..ROW {
                            sum[d] += row[d];
                        }
                    }
                    for d in 0..D {
                        tile.force[d][node - range.start] += sum[d];
                    }
                }
            }
            (Layout::Batch, sums) => {
                for node in range.start / WIDTH..(range.end / WIDTH).min(self.nodes) {
                    let place = node * WIDTH - range.start;
                    let mut sum = [[0.0; WIDTH]; D];
                    let mut add = |from: usize| {
                        for (sum, force) in sum.iter_mut().zip(scratch[from..].chunks_exact(WIDTH)) {
                            for l in 0..WIDTH {
                                sum[l] += force[l];
                            }
                        }
                    };
                    match sums {
                        Sums::Whole(at) => add(at + node * D * WIDTH),
                        Sums::Listed { start, rows } => {
                            let own = &rows[start[node] as usize..start[node + 1] as usize];
                            own.iter().for_each(|row| add(*row as usize * ROW));
                        }
                    }
                    for d in 0..D {
                        for (to, sum) in tile.force[d][place..place + WIDTH].iter_mut().zip(&sum[d]) {
                            *to += sum;
                        }
                    }
                }
            }
        }
        if let Some(volumes) = &self.volumes {
            let stride = self.layout.stride();
            let scratch = &scratch[self.cells_len()..];
            for place in range.start..range.end.min(self.nodes * stride) {
                let force = volumes.force(scratch, place / stride, place % stride);
                for d in 0..D {
                    tile.force[d][place - range.start] += force[d];
                }
            }
        }
        // The first tile reports the power of the whole body.
        if range.start == 0 {
            for l in 0..WIDTH {
                tile.power[l] += scratch[WIDTH + l];
            }
        }
    }
    fn energy(&self, _simd: Simd, _view: &View<D>, scratch: &[f64]) -> [f64; WIDTH] {
        core::array::from_fn(|l| scratch[l])
    }
    fn hessian(&self, view: &View<D>, scratch: &[f64], keep: Definiteness, sink: &mut dyn Sink<D>) {
        for (part, scratch) in self.parts_in(scratch) {
            part.hessian(view, scratch, keep, sink);
        }
        if let Some(volumes) = &self.volumes {
            volumes.hessian(view, &scratch[self.cells_len()..], keep, sink);
        }
    }
    fn damping_matrix(&self, view: &View<D>, scratch: &[f64], sink: &mut dyn Sink<D>) {
        for (part, scratch) in self.parts_in(scratch) {
            part.damping_matrix(view, scratch, sink);
        }
    }
    fn cell_states(&self, view: &View<D>, body: usize) -> Vec<CellState> {
        let mut out = Vec::new();
        for part in &self.parts {
            part.cell_states(view, body, &mut out);
        }
        if let Some(volumes) = &self.volumes {
            volumes.add_stresses(view, body, &mut out);
        }
        out
    }
    fn heap_bytes(&self) -> usize {
        self.parts.iter().map(|part| part.heap_bytes()).sum::<usize>()
            + self.sums.heap_bytes()
            + self.volumes.as_ref().map_or(0, NodalVolumes::heap_bytes)
    }
}

impl<const D: usize> Solid<D> {
    /// Numbers that the evaluation of the cells leaves.
    fn cells_len(&self) -> usize {
        self.shares.last().map_or(FORCES, |task| task.start + task.length)
    }

    /// The parts, each with its scratch.
    fn parts_in<'a>(&'a self, scratch: &'a [f64]) -> impl Iterator<Item = (&'a dyn Part<D>, &'a [f64])> {
        self.shares.iter().filter(|task| task.share == 0).map(|task| (&*self.parts[task.part], &scratch[task.start..]))
    }
}
