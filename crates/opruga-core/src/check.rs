//! The conformance suite: what every model must obey, checked on random states from a fixed seed.
//!
//! A model joins by one line in a test:
//!
//! ```ignore
//! conformance("springs", &MassSpring, &[values], &mesh, &Options::default()).assert();
//! ```
//!
//! | row | what is compared |
//! |---|---|
//! | gradient | force at rest with central differences of the energy (fourth order) |
//! | hessian | second derivatives with central differences of the force; symmetric |
//! | product | `add_hessian_product` with the assembled matrix; eight bodies with one |
//! | clamped | the clamped Hessian has no negative eigenvalue |
//! | tiles | forces in tiles of any size with forces in one tile, to the bit; also begun with the weight |
//! | lanes | all sets of vector instructions of this processor, to the bit |
//! | batch | eight bodies side by side with each alone, to the bit, forces and energy |
//! | translation, rotation | U(Qx + t) = U(x), F(Qx + t, Qv) = Q F(x, v) |
//! | net force, net torque | Σ F = 0, Σ x × F = 0, damping included |
//! | infinitesimal rotation | H Ωx = Ω ∇U for skew Ω, also under load |
//! | rigid motion | no damping force where v = v₀ + ω × x |
//! | power | what the model says that damping takes is −F·v of damping and not negative |
//! | coincident | all nodes in one point: energy and force are finite |
//!
//! Rows that ask for what a model says it lacks ([`Potential::views`], [`Options::rigid`]) are left out.

use crate::potential::{Definiteness, Ingredients, Model, Potential, Sink, Views};
use crate::spec::Values;
use crate::state::{Columns, Layout, Parameter, View};
use crate::tile::{TILE, Tile, Weight};
use core::fmt;
use core::ops::Range;
use opruga_math::{Column, Lane, Simd, WIDTH, sum_in_fixed_order};
use opruga_mesh::Mesh;

/// In which states a model is checked, and what it does not claim.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Seed of the random states.
    pub seed: u64,
    /// How many states.
    pub states: usize,
    /// Random displacement of each coordinate, in mean edge lengths of the mesh.
    pub noise: f64,
    /// Factor on the rest shape before that.
    pub stretch: f64,
    /// Whether the first axis is mirrored: a body turned inside out.
    pub mirrored: bool,
    /// Whether the model claims the rows on rigid motion, net force and net torque.
    pub rigid: bool,
    /// Whether it claims a finite force where all nodes coincide.
    pub coincident: bool,
    /// Whether differences are taken, as many as coordinates: not for meshes of more than some hundred nodes.
    pub derivatives: bool,
    /// Time of the state [s].
    pub time: f64,
    /// Depth out of the plane, or thickness of a sheet [m].
    pub thickness: f64,
    /// Allowed error of the gradient, relative to the largest force.
    pub gradient_tolerance: f64,
    /// Allowed error of the Hessian, relative to its largest entry.
    pub hessian_tolerance: f64,
}

impl Default for Options {
    fn default() -> Options {
        Options {
            seed: 1,
            states: 3,
            noise: 0.15,
            stretch: 1.0,
            mirrored: false,
            rigid: true,
            coincident: true,
            derivatives: true,
            time: 0.37,
            thickness: 0.8,
            gradient_tolerance: 1e-8,
            hessian_tolerance: 1e-7,
        }
    }
}

/// One comparison.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// What was compared.
    pub quantity: &'static str,
    /// In which state.
    pub state: usize,
    /// The largest error; relative unless it is a count of unequal bits.
    pub error: f64,
    /// The error that is allowed.
    pub tolerance: f64,
}

impl Row {
    /// Whether the error is allowed; an error that is not a number is not.
    pub fn passes(&self) -> bool {
        self.error <= self.tolerance
    }
}

/// All comparisons of one model on one mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// The name that was given.
    pub name: String,
    /// The dimension.
    pub dimension: usize,
    /// The comparisons.
    pub rows: Vec<Row>,
    /// Why no state could be checked, if so.
    pub refused: Option<String>,
}

impl Report {
    /// Whether everything was checked and every row passes.
    pub fn passes(&self) -> bool {
        self.refused.is_none() && self.rows.iter().all(Row::passes)
    }
    /// The largest error of a quantity; `None` where it was not compared.
    pub fn worst(&self, quantity: &str) -> Option<f64> {
        self.rows.iter().filter(|r| r.quantity == quantity).map(|r| r.error).reduce(Lane::larger)
    }
    /// Fails a test with a table of all rows unless everything passes.
    ///
    /// # Panics
    /// Where a row does not pass.
    #[track_caller]
    pub fn assert(&self) {
        assert!(self.passes(), "{self}");
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} in {}D", self.name, self.dimension)?;
        if let Some(reason) = &self.refused {
            writeln!(f, "  refused: {reason}")?;
        }
        for row in &self.rows {
            let mark = if row.passes() { "      " } else { "FAILS " };
            let Row { quantity, state, error, tolerance } = row;
            writeln!(f, "  {mark}{quantity:<24} state {state}  {error:>10.2e}  allowed {tolerance:.0e}")?;
        }
        Ok(())
    }
}

/// Checks a model on a mesh, with the parameters of one body or of several (used in turn for eight bodies).
pub fn conformance<const D: usize>(
    name: &str,
    model: &dyn Model<D>,
    values: &[Values],
    mesh: &Mesh<D>,
    options: &Options,
) -> Report {
    let mut report = Report { name: name.into(), dimension: D, rows: Vec::new(), refused: None };
    let mut random = Random::new(options.seed);
    for state in 0..options.states {
        let bodies: Vec<Body<D>> = (0..WIDTH).map(|_| Body::new(mesh, options, &mut random)).collect();
        let suite = Suite { model, values, mesh, options, bodies };
        if let Err(reason) = suite.run(state, &mut random, &mut report.rows) {
            report.refused = Some(reason);
            return report;
        }
    }
    report
}

/// Random numbers by splitmix64 (Steele, Lea, Flood 2014).
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// From a seed.
    pub fn new(seed: u64) -> Random {
        Random(seed)
    }
    /// Any 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
    /// A number in −1 … 1.
    pub fn signed(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
    /// A vector in the cube −1 … 1.
    pub fn vector<const D: usize>(&mut self) -> [f64; D] {
        let mut out = [0.0; D];
        for c in &mut out {
            *c = self.signed();
        }
        out
    }
}

type Matrix<const D: usize> = [[f64; D]; D];

/// A random rotation: Gram–Schmidt on random vectors, the last one turned so that the determinant is one.
fn rotation<const D: usize>(random: &mut Random) -> Matrix<D> {
    let mut q = [[0.0; D]; D];
    for i in 0..D {
        loop {
            let mut v: [f64; D] = random.vector();
            for _ in 0..2 {
                for row in q.iter().take(i) {
                    let along = dot(row, &v);
                    for d in 0..D {
                        v[d] -= along * row[d];
                    }
                }
            }
            let length = dot(&v, &v).sqrt();
            if length > 0.1 {
                q[i] = v.map(|c| c / length);
                break;
            }
        }
    }
    let determinant = if D == 2 {
        q[0][0] * q[1][1] - q[0][1] * q[1][0]
    } else {
        let (a, b, c) = (&q[0], &q[1], &q[D - 1]);
        let (y, z) = (D - 2, D - 1);
        a[0] * (b[y] * c[z] - b[z] * c[y]) - a[y] * (b[0] * c[z] - b[z] * c[0]) + a[z] * (b[0] * c[y] - b[y] * c[0])
    };
    if determinant < 0.0 {
        q[D - 1] = q[D - 1].map(|c| -c);
    }
    q
}

/// A random skew matrix.
fn skew<const D: usize>(random: &mut Random) -> Matrix<D> {
    let mut w = [[0.0; D]; D];
    for i in 0..D {
        for j in 0..i {
            w[i][j] = random.signed();
            w[j][i] = -w[i][j];
        }
    }
    w
}

fn times<const D: usize>(m: &Matrix<D>, v: &[f64; D]) -> [f64; D] {
    core::array::from_fn(|i| dot(&m[i], v))
}

fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// The state of one body.
#[derive(Clone, Debug)]
struct Body<const D: usize> {
    x: Vec<[f64; D]>,
    v: Vec<[f64; D]>,
    mass: Vec<f64>,
}

/// Mean length of the edges of a mesh.
fn mean_edge<const D: usize>(mesh: &Mesh<D>) -> f64 {
    let edges = mesh.edges(opruga_mesh::EdgeSet::All);
    let mut sum = 0.0;
    for &[a, b] in &edges {
        let (a, b) = (mesh.positions[a as usize], mesh.positions[b as usize]);
        let d: [f64; D] = core::array::from_fn(|i| a[i] - b[i]);
        sum += dot(&d, &d).sqrt();
    }
    if edges.is_empty() { 1.0 } else { sum / edges.len() as f64 }
}

impl<const D: usize> Body<D> {
    fn new(mesh: &Mesh<D>, options: &Options, random: &mut Random) -> Body<D> {
        let nodes = mesh.positions.len();
        let edge = mean_edge(mesh);
        let mut center = [0.0; D];
        for p in &mesh.positions {
            for d in 0..D {
                center[d] += p[d] / nodes as f64;
            }
        }
        // A random deformation of the whole, then of every node.
        let mut affine = [[0.0; D]; D];
        for (i, row) in affine.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                let one = if i == j { options.stretch } else { 0.0 };
                *entry = one + 0.2 * options.stretch * random.signed();
            }
            if options.mirrored && i == 0 {
                *row = row.map(|c| -c);
            }
        }
        let mut x = Vec::with_capacity(nodes);
        for p in &mesh.positions {
            let from_center: [f64; D] = core::array::from_fn(|d| p[d] - center[d]);
            let moved = times(&affine, &from_center);
            let noise: [f64; D] = random.vector();
            x.push(core::array::from_fn(|d| center[d] + moved[d] + noise[d] * options.noise * edge));
        }
        let v = (0..nodes).map(|_| random.vector::<D>().map(|c| c * edge)).collect();
        let mass = (0..nodes).map(|_| 1.0 + 0.5 * random.signed()).collect();
        Body { x, v, mass }
    }
    fn still(&self) -> Body<D> {
        Body { v: vec![[0.0; D]; self.x.len()], ..self.clone() }
    }
}

/// A built model with the state in which it is asked.
struct Case<'a, const D: usize> {
    potential: &'a dyn Potential<D>,
    layout: Layout,
    nodes: usize,
    x: Columns<D>,
    v: Columns<D>,
    memory: Vec<f64>,
    scratch: Column,
    time: f64,
}

type Answer<T> = Result<T, String>;

impl<'a, const D: usize> Case<'a, D> {
    fn new(potential: &'a dyn Potential<D>, layout: Layout, bodies: &[&Body<D>], time: f64) -> Case<'a, D> {
        let nodes = bodies[0].x.len();
        let places = layout.places(nodes);
        let (mut x, mut v) = (Columns::zeros(places), Columns::zeros(places));
        for node in 0..nodes {
            for (l, body) in bodies.iter().enumerate().take(layout.stride()) {
                x.set(layout.place(node, l), body.x[node]);
                v.set(layout.place(node, l), body.v[node]);
            }
        }
        // Padding repeats the last node.
        for place in nodes * layout.stride()..places {
            x.set(place, bodies[0].x[nodes - 1]);
        }
        let (memory, scratch) = (potential.initial_memory(), Column::zeros(potential.scratch_len()));
        Case { potential, layout, nodes, x, v, memory, scratch, time }
    }
    fn places(&self) -> usize {
        self.layout.places(self.nodes)
    }
    fn prepare(&mut self, simd: Simd) -> Answer<()> {
        let view =
            View { x: self.x.slices(), v: self.v.slices(), nodes: self.nodes, layout: self.layout, time: self.time };
        self.potential.prepare(simd, &view, &self.memory, &mut self.scratch).map_err(|e| e.to_string())
    }
    fn view(&self) -> View<'_, D> {
        View { x: self.x.slices(), v: self.v.slices(), nodes: self.nodes, layout: self.layout, time: self.time }
    }
    fn energy(&mut self, simd: Simd) -> Answer<[f64; WIDTH]> {
        self.prepare(simd)?;
        Ok(self.potential.energy(simd, &self.view(), &self.scratch))
    }
    /// Force and power with the places cut into tiles; `weight` begins the forces, by the model itself where `fused`.
    fn forces(
        &mut self,
        simd: Simd,
        tiles: &[Range<usize>],
        weight: Option<(&Parameter, [f64; D], bool)>,
    ) -> Answer<(Columns<D>, [f64; WIDTH])> {
        self.prepare(simd)?;
        let mut out = Columns::zeros(self.places());
        let mut power = [0.0; WIDTH];
        let mut slots = Column::default();
        for range in tiles {
            let mut buffers: [Vec<f64>; D] = core::array::from_fn(|_| vec![0.0; range.len() + WIDTH]);
            let mut heaviness = weight.map(|(mass, gravity, _)| Weight { mass, gravity });
            if let Some((_, _, false)) = weight {
                let force = buffers.each_mut().map(Vec::as_mut_slice);
                let weight = heaviness.take();
                let mut tile = Tile { range: range.clone(), force, power: &mut power, weight, slots: &mut slots };
                tile.settle(simd);
            }
            let force = buffers.each_mut().map(Vec::as_mut_slice);
            let mut tile =
                Tile { range: range.clone(), force, power: &mut power, weight: heaviness, slots: &mut slots };
            self.potential.add_force(simd, &self.view(), &self.scratch, &mut tile);
            for d in 0..D {
                out.0[d][range.clone()].copy_from_slice(&buffers[d][..range.len()]);
            }
        }
        Ok((out, power))
    }
    /// Forces node by node of one body, in tiles as a step has them.
    fn plain(&mut self, simd: Simd) -> Answer<(Vec<[f64; D]>, f64)> {
        let tiles = regular(self.places(), TILE);
        let (columns, power) = self.forces(simd, &tiles, None)?;
        Ok((by_node(&columns, self.layout, self.nodes, 0), sum_in_fixed_order(&power)))
    }
}

fn regular(places: usize, length: usize) -> Vec<Range<usize>> {
    (0..places).step_by(length).map(|s| s..(s + length).min(places)).collect()
}

/// Tiles of random sizes, in no order.
fn irregular(places: usize, random: &mut Random) -> Vec<Range<usize>> {
    let mut tiles = Vec::new();
    let mut start = 0;
    while start < places {
        let most = 1 << (random.bits() % 7);
        let end = (start + WIDTH * (1 + random.bits() as usize % most)).min(places);
        tiles.push(start..end);
        start = end;
    }
    tiles.reverse();
    tiles
}

fn by_node<const D: usize>(columns: &Columns<D>, layout: Layout, nodes: usize, body: usize) -> Vec<[f64; D]> {
    (0..nodes).map(|n| columns.at(layout.place(n, body))).collect()
}

fn unequal_bits<const D: usize>(a: &[[f64; D]], b: &[[f64; D]]) -> f64 {
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    pairs.filter(|(a, b)| a.to_bits() != b.to_bits()).count() as f64
}

/// The largest entry.
fn largest<'a>(numbers: impl IntoIterator<Item = &'a f64>) -> f64 {
    let mut out = 0.0;
    for n in numbers {
        out = if n.is_nan() { f64::NAN } else { Lane::larger(n.abs(), out) };
        if out.is_nan() {
            break;
        }
    }
    out
}

/// The largest difference, relative to the largest entry of `b` and at least to `scale`.
fn difference(a: &[f64], b: &[f64], scale: f64) -> f64 {
    let errors: Vec<f64> = a.iter().zip(b).map(|(x, y)| x - y).collect();
    let scale = Lane::larger(largest(b), scale);
    let error = largest(&errors);
    if error == 0.0 { 0.0 } else { error / scale }
}

/// The Hessian of one body as a full matrix.
struct Assembled<const D: usize> {
    size: usize,
    layout: Layout,
    entries: Vec<f64>,
}

impl<const D: usize> Assembled<D> {
    fn row(&self, place: usize, d: usize) -> Option<usize> {
        match self.layout {
            Layout::Single => Some(place * D + d),
            // The first of eight bodies.
            Layout::Batch if place.is_multiple_of(WIDTH) => Some(place / WIDTH * D + d),
            Layout::Batch => None,
        }
    }
    fn of(case: &Case<D>, keep: Definiteness) -> Vec<f64> {
        let size = case.nodes * D;
        let mut sink = Assembled::<D> { size, layout: case.layout, entries: vec![0.0; size * size] };
        case.potential.hessian(&case.view(), &case.scratch, keep, &mut sink);
        sink.entries
    }
}

impl<const D: usize> Sink<D> for Assembled<D> {
    fn block(&mut self, a: usize, b: usize, value: [[f64; D]; D]) {
        for i in 0..D {
            for j in 0..D {
                if let (Some(p), Some(q)) = (self.row(a, i), self.row(b, j)) {
                    self.entries[p * self.size + q] += value[i][j];
                }
            }
        }
    }
    fn low_rank(&mut self, c: f64, u: &[(usize, [f64; D])]) {
        for (a, ua) in u {
            for (b, ub) in u {
                self.block(*a, *b, core::array::from_fn(|i| core::array::from_fn(|j| c * ua[i] * ub[j])));
            }
        }
    }
}

/// Whether a symmetric matrix plus a small multiple of the unit matrix has a Cholesky factor.
fn is_positive(matrix: &[f64], size: usize, shift: f64) -> bool {
    let mut l = matrix.to_vec();
    for i in 0..size {
        for j in 0..=i {
            let mut sum = l[i * size + j] + if i == j { shift } else { 0.0 };
            for k in 0..j {
                sum -= l[i * size + k] * l[j * size + k];
            }
            if i == j {
                if sum.is_nan() || sum <= 0.0 {
                    return false;
                }
                l[i * size + i] = sum.sqrt();
            } else {
                l[i * size + j] = sum / l[j * size + j];
            }
        }
    }
    true
}

struct Suite<'a, const D: usize> {
    model: &'a dyn Model<D>,
    values: &'a [Values],
    mesh: &'a Mesh<D>,
    options: &'a Options,
    bodies: Vec<Body<D>>,
}

impl<const D: usize> Suite<'_, D> {
    /// The model of one of the bodies, or of all eight.
    fn build(&self, body: Option<usize>) -> Answer<Box<dyn Potential<D>>> {
        let nodes = self.mesh.positions.len();
        let values: Vec<&Values> = match body {
            Some(l) => vec![&self.values[l % self.values.len()]],
            None => (0..WIDTH).map(|l| &self.values[l % self.values.len()]).collect(),
        };
        let layout = if body.is_some() { Layout::Single } else { Layout::Batch };
        let mass = Parameter::from_items(layout, nodes, |node, l| self.bodies[body.unwrap_or(l)].mass[node]);
        let ingredients = Ingredients {
            mesh: self.mesh,
            layout,
            values: &values,
            mass: &mass,
            thickness: self.options.thickness,
            gravity: [0.0; D],
        };
        self.model.build(&ingredients).map_err(|e| e.to_string())
    }

    fn run(&self, state: usize, random: &mut Random, rows: &mut Vec<Row>) -> Answer<()> {
        if self.values.is_empty() {
            return Err("no parameters were given".into());
        }
        let mut add = |quantity, error, tolerance| rows.push(Row { quantity, state, error, tolerance });
        let potential = self.build(Some(0))?;
        let views = potential.views();
        self.same_bits(random, &*potential, &mut add)?;
        if views.energy && self.options.derivatives {
            self.gradient(&*potential, &mut add)?;
        }
        if views.hessian && self.options.derivatives {
            self.hessian(random, &*potential, &mut add)?;
        }
        if self.options.rigid {
            self.invariance(random, &*potential, views, &mut add)?;
        }
        if views.damping && potential.account() == crate::potential::Account::Elastic {
            self.dissipation(random, &*potential, &mut add)?;
        }
        if self.options.coincident {
            let mut body = self.bodies[0].clone();
            let point = body.x[0];
            body.x.iter_mut().for_each(|x| *x = point);
            let mut case = self.case(&*potential, &body);
            let (force, power) = case.plain(Simd::best())?;
            let energy = sum_in_fixed_order(&case.energy(Simd::best())?);
            let finite = force.iter().flatten().chain([&power, &energy]).all(|c| c.is_finite());
            add("coincident", if finite { 0.0 } else { f64::NAN }, 0.0);
        }
        Ok(())
    }

    fn case<'a>(&self, potential: &'a dyn Potential<D>, body: &Body<D>) -> Case<'a, D> {
        Case::new(potential, Layout::Single, &[body], self.options.time)
    }

    /// Tiles, sets of instructions, layouts: to the bit.
    fn same_bits(
        &self,
        random: &mut Random,
        potential: &dyn Potential<D>,
        add: &mut dyn FnMut(&'static str, f64, f64),
    ) -> Answer<()> {
        let best = Simd::best();
        let nodes = self.mesh.positions.len();
        let all = self.build(None)?;
        let bodies: Vec<&Body<D>> = self.bodies.iter().collect();
        let mut alone = self.case(potential, &self.bodies[0]);
        let mut eight = Case::new(&*all, Layout::Batch, &bodies, self.options.time);

        let (mut tiles, mut lanes) = (0.0, 0.0);
        let gravity: [f64; D] = random.vector();
        for case in [&mut alone, &mut eight] {
            let places = case.places();
            let stride = case.layout.stride();
            let columns = |c: &Columns<D>| (0..nodes * stride).map(|p| c.at(p)).collect::<Vec<_>>();
            let (whole, power) = case.forces(best, &regular(places, places), None)?;
            let whole = columns(&whole);
            let mut cuts = vec![regular(places, TILE), regular(places, WIDTH), regular(places, 3 * WIDTH)];
            cuts.extend((0..4).map(|_| irregular(places, random)));
            for cut in &cuts {
                tiles += unequal_bits(&columns(&case.forces(best, cut, None)?.0), &whole);
            }
            // Begun with the weight, by the model or before it.
            let mass = Parameter::from_items(case.layout, nodes, |n, l| self.bodies[l].mass[n]);
            if case.potential.begins_tiles() {
                for cut in &cuts {
                    let before = case.forces(best, cut, Some((&mass, gravity, false)))?.0;
                    let fused = case.forces(best, cut, Some((&mass, gravity, true)))?.0;
                    tiles += unequal_bits(&columns(&before), &columns(&fused));
                }
            }
            let energy = case.energy(best)?;
            for simd in Simd::available() {
                let (force, other) = case.forces(simd, &regular(places, places), None)?;
                lanes += unequal_bits(&columns(&force), &whole);
                lanes += unequal_bits(&[other], &[power]) + unequal_bits(&[case.energy(simd)?], &[energy]);
            }
        }
        add("tiles", tiles, 0.0);
        add("lanes", lanes, 0.0);

        // Each of eight bodies alone.
        let mut batch = 0.0;
        let mut powers = 0.0;
        let (together, power) = eight.forces(best, &regular(eight.places(), TILE), None)?;
        let energies = eight.energy(best)?;
        for l in 0..WIDTH {
            let own = self.build(Some(l))?;
            let mut case = self.case(&*own, &self.bodies[l]);
            let (force, own_power) = case.plain(best)?;
            batch += unequal_bits(&by_node(&together, Layout::Batch, nodes, l), &force);
            let energy = sum_in_fixed_order(&case.energy(best)?);
            batch += unequal_bits(&[[energies[l]]], &[[energy]]);
            powers = Lane::larger(difference(&[power[l]], &[own_power], 0.0), powers);
        }
        add("batch", batch, 0.0);
        // Power is added up in another order.
        add("batch power", powers, 1e-11);
        Ok(())
    }

    fn gradient(&self, potential: &dyn Potential<D>, add: &mut dyn FnMut(&'static str, f64, f64)) -> Answer<()> {
        let best = Simd::best();
        let body = self.bodies[0].still();
        let h = 2e-4 * mean_edge(self.mesh) * Lane::smaller(self.options.stretch, 1.0);
        let mut case = self.case(potential, &body);
        let (force, _) = case.plain(best)?;
        let mut expected = Vec::new();
        for node in 0..case.nodes {
            for d in 0..D {
                let at = case.x.0[d][node];
                let mut energy = |shift: f64| -> Answer<f64> {
                    case.x.0[d][node] = at + shift;
                    let energy = case.energy(best)?;
                    case.x.0[d][node] = at;
                    Ok(sum_in_fixed_order(&energy))
                };
                let near = energy(h)? - energy(-h)?;
                let far = energy(2.0 * h)? - energy(-2.0 * h)?;
                expected.push(-(8.0 * near - far) / (12.0 * h));
            }
        }
        let force: Vec<f64> = force.into_iter().flatten().collect();
        add("gradient", difference(&expected, &force, 1e-300), self.options.gradient_tolerance);
        Ok(())
    }

    fn hessian(
        &self,
        random: &mut Random,
        potential: &dyn Potential<D>,
        add: &mut dyn FnMut(&'static str, f64, f64),
    ) -> Answer<()> {
        let best = Simd::best();
        let body = self.bodies[0].still();
        let h = 2e-4 * mean_edge(self.mesh) * Lane::smaller(self.options.stretch, 1.0);
        let mut case = self.case(potential, &body);
        case.prepare(best)?;
        let matrix = Assembled::of(&case, Definiteness::Exact);
        let clamped = Assembled::of(&case, Definiteness::Clamped);
        let size = case.nodes * D;
        let scale = largest(&matrix);

        // Differences of forces, column by column.
        let mut expected = vec![0.0; size * size];
        for node in 0..case.nodes {
            for d in 0..D {
                let at = case.x.0[d][node];
                for (shift, weight) in [(h, -8.0), (-h, 8.0), (2.0 * h, 1.0), (-2.0 * h, -1.0)] {
                    case.x.0[d][node] = at + shift;
                    let (force, _) = case.plain(best)?;
                    for (row, f) in force.iter().flatten().enumerate() {
                        expected[row * size + node * D + d] += weight * f / (12.0 * h);
                    }
                }
                case.x.0[d][node] = at;
            }
        }
        case.prepare(best)?;
        add("hessian", difference(&expected, &matrix, 1e-300), self.options.hessian_tolerance);
        let transposed: Vec<f64> = (0..size * size).map(|k| matrix[k % size * size + k / size]).collect();
        add("symmetry", difference(&transposed, &matrix, 1e-300), 1e-11);

        // Product with a vector, of one body and of eight.
        let all = self.build(None)?;
        let bodies: Vec<Body<D>> = self.bodies.iter().map(Body::still).collect();
        let mut eight = Case::new(&*all, Layout::Batch, &bodies.iter().collect::<Vec<_>>(), self.options.time);
        eight.prepare(best)?;
        let direction: Vec<f64> = (0..size).map(|_| random.signed()).collect();
        let assembled: Vec<f64> =
            (0..size).map(|p| (0..size).map(|q| matrix[p * size + q] * direction[q]).sum::<f64>()).collect();
        for case in [&case, &eight] {
            let places = case.places();
            let (mut along, mut out) = (Columns::<D>::zeros(places), Columns::<D>::zeros(places));
            for node in 0..case.nodes {
                let row = core::array::from_fn(|d| direction[node * D + d]);
                along.set(case.layout.place(node, 0), row);
            }
            let mut columns = out.0.each_mut().map(|c| &mut **c);
            case.potential.add_hessian_product(&case.view(), &case.scratch, &along.slices(), &mut columns);
            let product: Vec<f64> = by_node(&out, case.layout, case.nodes, 0).into_iter().flatten().collect();
            add("product", difference(&product, &assembled, scale), 1e-12);
        }
        let of_eight = Assembled::of(&eight, Definiteness::Exact);
        add("product", difference(&of_eight, &matrix, 1e-300), 1e-12);

        let negative = scale > 0.0 && !is_positive(&clamped, size, 1e-9 * largest(&clamped) + 1e-300);
        add("clamped", if negative { 1.0 } else { 0.0 }, 0.0);
        Ok(())
    }

    fn invariance(
        &self,
        random: &mut Random,
        potential: &dyn Potential<D>,
        views: Views,
        add: &mut dyn FnMut(&'static str, f64, f64),
    ) -> Answer<()> {
        let best = Simd::best();
        let body = &self.bodies[0];
        let nodes = body.x.len();
        let extent = mean_edge(self.mesh) * nodes as f64;
        let mut case = self.case(potential, body);
        let (force, _) = case.plain(best)?;
        let flat: Vec<f64> = force.iter().flatten().copied().collect();
        let energy = sum_in_fixed_order(&case.energy(best)?);
        // Energies are compared with what a force does over an edge, where they are smaller than that.
        let scale = largest(&flat) * mean_edge(self.mesh);

        // Moved, and turned about the first node with the velocities.
        let shift: [f64; D] = random.vector::<D>().map(|c| c * extent);
        let turn = rotation::<D>(random);
        let center = body.x[0];
        let mut moved = body.clone();
        let mut turned = body.clone();
        for node in 0..nodes {
            let from_center: [f64; D] = core::array::from_fn(|d| body.x[node][d] - center[d]);
            let around = times(&turn, &from_center);
            for d in 0..D {
                moved.x[node][d] += shift[d];
                turned.x[node][d] = center[d] + around[d];
            }
            turned.v[node] = times(&turn, &body.v[node]);
        }
        for (quantity, state, turn) in [("translation", moved, None), ("rotation", turned, Some(turn))] {
            let mut case = self.case(potential, &state);
            let (other, _) = case.plain(best)?;
            let same = sum_in_fixed_order(&case.energy(best)?);
            let expected: Vec<f64> = force.iter().flat_map(|f| turn.map_or(*f, |q| times(&q, f))).collect();
            let other: Vec<f64> = other.into_iter().flatten().collect();
            let error = difference(&other, &expected, 1e-300);
            add(quantity, error, 1e-9);
            if views.energy {
                add(quantity, difference(&[same], &[energy], scale), 1e-10);
            }
        }

        // Net force and torque about the first node, relative to the sum of their parts.
        let (mut net, mut torque) = ([0.0; D], [[0.0; D]; D]);
        let (mut strength, mut moment) = (0.0, 0.0);
        for node in 0..nodes {
            let arm: [f64; D] = core::array::from_fn(|d| body.x[node][d] - center[d]);
            let f = &force[node];
            strength += dot(f, f).sqrt();
            moment += (dot(f, f) * dot(&arm, &arm)).sqrt();
            for i in 0..D {
                net[i] += f[i];
                for j in 0..D {
                    torque[i][j] += arm[i] * f[j] - arm[j] * f[i];
                }
            }
        }
        add("net force", difference(&net, &[0.0; D], strength), 1e-13);
        add("net torque", difference(torque.as_flattened(), &vec![0.0; D * D], moment), 1e-13);

        // H Ω(x − x₀) = Ω ∇U.
        if views.hessian && self.options.derivatives {
            let still = body.still();
            let mut case = self.case(potential, &still);
            let (force, _) = case.plain(best)?;
            let omega = skew::<D>(random);
            let places = case.places();
            let (mut along, mut out) = (Columns::<D>::zeros(places), Columns::<D>::zeros(places));
            for node in 0..nodes {
                let arm: [f64; D] = core::array::from_fn(|d| body.x[node][d] - center[d]);
                along.set(node, times(&omega, &arm));
            }
            let mut columns = out.0.each_mut().map(|c| &mut **c);
            potential.add_hessian_product(&case.view(), &case.scratch, &along.slices(), &mut columns);
            let product: Vec<f64> = by_node(&out, case.layout, nodes, 0).into_iter().flatten().collect();
            let expected: Vec<f64> = force.iter().flat_map(|f| times(&omega, &f.map(|c| -c))).collect();
            let terms = largest(&Assembled::of(&case, Definiteness::Exact)) * largest(along.0.iter().flatten());
            add("infinitesimal rotation", difference(&product, &expected, terms), 1e-12);
        }
        Ok(())
    }

    fn dissipation(
        &self,
        random: &mut Random,
        potential: &dyn Potential<D>,
        add: &mut dyn FnMut(&'static str, f64, f64),
    ) -> Answer<()> {
        let best = Simd::best();
        let body = &self.bodies[0];
        let nodes = body.x.len();
        let damping = |v: &dyn Fn(usize) -> [f64; D]| -> Answer<(Vec<f64>, f64, f64)> {
            let mut state = body.clone();
            let rest = self.case(potential, &body.still()).plain(best)?.0;
            for (node, entry) in state.v.iter_mut().enumerate() {
                *entry = v(node);
            }
            let (force, power) = self.case(potential, &state).plain(best)?;
            let mut drag = Vec::new();
            let mut work = 0.0;
            for node in 0..nodes {
                let own: [f64; D] = core::array::from_fn(|d| force[node][d] - rest[node][d]);
                work -= dot(&own, &state.v[node]);
                drag.extend(own);
            }
            Ok((drag, power, work))
        };
        let (random_drag, power, work) = damping(&|node| body.v[node])?;
        // Forces at rest are subtracted: their rounding counts.
        let rest = self.case(potential, &body.still()).plain(best)?.0;
        let rounding = 1e-4 * largest(rest.iter().flatten());
        let scale = Lane::larger(largest(&random_drag), rounding);
        let speeds = largest(body.v.iter().flatten()) * nodes as f64;
        add("power", difference(&[power], &[work], Lane::larger(power.abs(), rounding * speeds)), 1e-9);
        add("power", if power >= 0.0 { 0.0 } else { 1.0 }, 0.0);
        if self.options.rigid {
            // As fast as the random motion: v₀ + ω × (x − x₀).
            let (omega, speed) = (skew::<D>(random), largest(body.v.iter().flatten()));
            let start: [f64; D] = random.vector();
            let arms = |node: usize| -> [f64; D] { core::array::from_fn(|d| body.x[node][d] - body.x[0][d]) };
            let reach = largest((0..nodes).map(arms).collect::<Vec<_>>().iter().flatten());
            let rigid = |node: usize| -> [f64; D] {
                let turning = times(&omega, &arms(node));
                core::array::from_fn(|d| speed * (start[d] + turning[d] / reach))
            };
            let (drag, power, _) = damping(&rigid)?;
            add("rigid motion", largest(&drag) / scale, 1e-11);
            add("rigid motion", power.abs() / (scale * speed), 1e-11);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotations_are_proper() {
        let mut random = Random::new(3);
        for _ in 0..20 {
            let q = rotation::<3>(&mut random);
            let cross = [
                q[0][1] * q[1][2] - q[0][2] * q[1][1],
                q[0][2] * q[1][0] - q[0][0] * q[1][2],
                q[0][0] * q[1][1] - q[0][1] * q[1][0],
            ];
            assert!(difference(&cross, &q[2], 1.0) < 1e-14);
            let q = rotation::<2>(&mut random);
            assert!((q[0][0] * q[1][1] - q[0][1] * q[1][0] - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn a_wrong_number_fails() {
        let row = |error| Row { quantity: "gradient", state: 0, error, tolerance: 1e-8 };
        assert!(row(1e-9).passes() && !row(1e-7).passes() && !row(f64::NAN).passes());
    }
}
