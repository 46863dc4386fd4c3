//! Elements of one kind and one material on a body, or on eight alike ones.
//!
//! ```text
//! positions ─gather→ F at the points of some packs of elements ─law→ P ─→ forces of the elements ─scatter→ forces of the nodes
//!            └────────────── a few kilobytes that stay in the first-level cache ──────────────┘
//! ```
//!
//! Every element is evaluated once. A pack is eight neighbouring elements of one body, or the same one of eight bodies.
//!
//! The elements of a body are cut into *shares* that threads may work on. A share has rows of its own for the nodes that it
//! touches, whose forces are added up in the order of its elements, and those of a node in the order of the shares. Shares
//! are the same for every number of threads and for both layouts, and so are the bits.

use super::boxes::beyond;
use super::elements::Shape;
use super::hourglass::{self, fields, stiffness_numbers};
use super::law::Law;
use super::pass::{Matrices, Pass};
use super::work::Nodes;
use core::fmt::Debug;
use core::marker::PhantomData;
use opruga_core::error::StepError;
use opruga_core::potential::{CellState, Definiteness, Sink};
use opruga_core::state::{Layout, View};
use opruga_math::{Column, ROW, Simd, WIDTH, sum_in_fixed_order};

/// Packs of points that are looked at together, at most.
pub(super) const MOST_PACKS: usize = 9;

/// Numbers of an element: μ, λ, the material's own, retardation time.
pub(super) const NUMBERS: usize = 4;

/// Packs of points in a share: a hundred kilobytes, half a millisecond at most.
const SHARE: usize = 512;

/// Where the forces of a share begin in its scratch, behind energies and powers.
pub(super) const FORCES: usize = 2 * WIDTH;

/// Room for some packs of points.
#[repr(align(64))]
pub(super) struct Room<const SIZE: usize>(pub(super) [f64; SIZE]);

/// What an element is made of, for [`Section::new`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell<const N: usize> {
    /// Its number in the mesh.
    pub(super) number: u32,
    /// Its nodes.
    pub(super) nodes: [u32; N],
}

/// Elements of one kind and one material.
#[derive(Debug)]
pub(super) struct Section<E, const D: usize, const N: usize> {
    shape: PhantomData<E>,
    pub(super) layout: Layout,
    pub(super) law: Box<dyn Law<D>>,
    /// The law in space, for stresses across the plane; none in plane stress.
    pub(super) law_in_space: Option<Box<dyn Law<3>>>,
    /// Elements by lowest node.
    pub(super) cells: Vec<Cell<N>>,
    /// Points of an element where the law is asked.
    pub(super) points: usize,
    shares: Vec<Share>,
    /// Where elements find their nodes: N packs of rows of the share for every pack of elements of one body, N places for every
    /// element of eight.
    places: Vec<u32>,
    /// For eight bodies the N rows of the share for every element.
    targets: Vec<u32>,
    /// (∂X/∂ξ)⁻¹ row by row and the measure [m³], point by point; of boxes what [`hourglass::stored`] counts. In packs for one
    /// body.
    pub(super) geometry: Column,
    /// What boxes resist bending with: what [`stiffness_numbers`] counts.
    stiffness: Column,
    /// [`NUMBERS`] packs for every pack of elements, or for all.
    parameters: Column,
    /// Whether the parameters of the first pack hold for all.
    pub(super) uniform: bool,
    pub(super) damped: bool,
}

/// Packs of elements that are worked on by one thread at a time.
#[derive(Debug)]
pub(super) struct Share {
    /// The first pack, and how many.
    pub(super) first: usize,
    pub(super) packs: usize,
    /// The nodes of its elements, rising: a row each.
    pub(super) nodes: Vec<u32>,
    /// Where its scratch begins in that of the section.
    pub(super) start: usize,
}

/// Sums over elements whose bits do not depend on the layout.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Totals {
    /// Energy [J]: one body eight partial sums in the first row, eight bodies a column each.
    pub(super) energy: [[f64; WIDTH]; WIDTH],
    /// Power of damping [W].
    pub(super) power: [[f64; WIDTH]; WIDTH],
}

/// One number for one body, or one for each of eight.
pub(super) fn total(layout: Layout, partial: &[[f64; WIDTH]; WIDTH]) -> [f64; WIDTH] {
    let mut out = [0.0; WIDTH];
    match layout {
        Layout::Single => out[0] = sum_in_fixed_order(&partial[0]),
        Layout::Batch => {
            for l in 0..WIDTH {
                out[l] = sum_in_fixed_order(&core::array::from_fn(|k| partial[k][l]));
            }
        }
    }
    out
}

/// A section, whatever its elements.
pub(super) trait Part<const D: usize>: Send + Sync + Debug {
    /// The shares, which may be evaluated side by side.
    fn shares(&self) -> &[Share];
    /// Numbers that the evaluation of a share leaves: energies [J] and powers [W] of the bodies, forces [N] (−∂U/∂x and
    /// damping), and copies of what it read. For one body the forces of a node are a row, for eight a pack for every axis.
    fn scratch_len(&self, share: &Share) -> usize;
    /// Evaluates the elements of a share.
    fn evaluate(&self, share: &Share, simd: Simd, view: &View<D>, scratch: &mut [f64]) -> Result<(), StepError>;
    /// Delivers ∂²U/∂x∂x, after all shares were evaluated in the same state.
    fn hessian(&self, view: &View<D>, scratch: &[f64], keep: Definiteness, sink: &mut dyn Sink<D>);
    /// Delivers −∂F/∂v, likewise.
    fn damping_matrix(&self, view: &View<D>, scratch: &[f64], sink: &mut dyn Sink<D>);
    /// Stress and volume ratio of the cells of a body.
    fn cell_states(&self, view: &View<D>, body: usize, out: &mut Vec<CellState>);
    /// Bytes on the heap.
    fn heap_bytes(&self) -> usize;
}

/// What every step of the work on some packs of elements needs to know.
#[derive(Clone, Copy, Debug)]
pub(super) struct Group<'a> {
    pub(super) layout: Layout,
    /// The first pack, and how many.
    pub(super) first: usize,
    pub(super) packs: usize,
    /// Elements in all.
    pub(super) count: usize,
    /// Points of an element.
    pub(super) points: usize,
    /// Whether the law knows of rotations.
    pub(super) turns: bool,
    pub(super) places: &'a [u32],
    pub(super) targets: &'a [u32],
    pub(super) geometry: &'a [f64],
    pub(super) stiffness: &'a [f64],
    pub(super) parameters: &'a [f64],
    /// Distance of the parameters of two packs.
    pub(super) step: usize,
}

impl Group<'_> {
    /// How many elements of a pack of one body are there; the last pack is filled up.
    #[inline(always)]
    pub(super) fn present(&self, pack: usize) -> usize {
        match self.layout {
            Layout::Single => (self.count - pack * WIDTH).min(WIDTH),
            Layout::Batch => WIDTH,
        }
    }
}

/// (∂X/∂ξ)⁻¹ and det ∂X/∂ξ of the rest shape at a point.
pub(super) fn rest_gradient<const D: usize, const N: usize>(
    rest: &[[f64; D]; N],
    slopes: &[[f64; D]; N],
) -> ([[f64; D]; D], f64) {
    let mut jacobian = [[0.0; D]; D];
    for i in 0..D {
        for j in 0..D {
            for a in 0..N {
                jacobian[i][j] += rest[a][i] * slopes[a][j];
            }
        }
    }
    let cofactors = opruga_math::matrix::cofactor(&jacobian);
    let determinant = opruga_math::matrix::determinant_by(&jacobian, &cofactors);
    let mut inverse = [[0.0; D]; D];
    for i in 0..D {
        for j in 0..D {
            inverse[i][j] = cofactors[j][i] / determinant;
        }
    }
    (inverse, determinant)
}

/// What a section is built from.
pub(super) struct Plan<'a, const D: usize> {
    pub(super) layout: Layout,
    pub(super) law: Box<dyn Law<D>>,
    pub(super) law_in_space: Option<Box<dyn Law<3>>>,
    pub(super) positions: &'a [[f64; D]],
    /// Depth out of the plane [m]; 1 in space.
    pub(super) thickness: f64,
    /// Whether no stress acts across the plane.
    pub(super) plane_stress: bool,
    pub(super) damped: bool,
}

/// Numbers of the geometry of the points of an element.
const fn stored<E: Shape<D, N>, const D: usize, const N: usize>() -> usize {
    if E::BOX { hourglass::stored::<D, N>() } else { E::POINTS * (D * D + 1) }
}

impl<E: Shape<D, N>, const D: usize, const N: usize> Section<E, D, N> {
    /// Lays out elements; `numbers` gives those of a cell of a body.
    pub(super) fn new(
        plan: Plan<'_, D>,
        mut cells: Vec<Cell<N>>,
        numbers: &dyn Fn(u32, usize) -> [f64; NUMBERS],
    ) -> Self {
        let Plan { layout, law, law_in_space, positions, thickness, plane_stress, damped } = plan;
        let lowest = |cell: &Cell<N>| cell.nodes.iter().copied().min().unwrap_or(0);
        cells.sort_by_key(|cell| (lowest(cell), cell.nodes, cell.number));
        let resists_volume = |cell: &Cell<N>| {
            let bodies = if layout == Layout::Single { 0..1 } else { 0..WIDTH };
            bodies.into_iter().any(|body| {
                let [mu, lambda, ..] = numbers(cell.number, body);
                beyond(mu, lambda) > 0.0
            })
        };
        // Boxes ask the law at their mean too where it resists volume much.
        let mean = E::BOX && !plane_stress && cells.iter().any(resists_volume);
        let points = E::POINTS + usize::from(mean);
        let stored = stored::<E, D, N>();
        let lanes = if layout == Layout::Single { WIDTH } else { 1 };
        let packs = cells.len().div_ceil(lanes);
        let cell = |pack: usize, lane: usize| &cells[(pack * lanes + lane).min(cells.len() - 1)];

        // As many elements in both layouts, whatever the material of the other bodies.
        let shares = shares(&cells, packs, lanes, (SHARE / E::POINTS).max(1) * WIDTH / lanes);
        let mut places = vec![0; packs * N * lanes];
        let mut targets = vec![0; if layout == Layout::Batch { packs * N } else { 0 }];
        for share in &shares {
            for pack in share.first..share.first + share.packs {
                for lane in 0..lanes {
                    for (a, node) in cell(pack, lane).nodes.iter().enumerate() {
                        let row = share.nodes.partition_point(|own| own < node) as u32;
                        if layout == Layout::Batch {
                            targets[pack * N + a] = row;
                        }
                        places[(pack * N + a) * lanes + lane] = match layout {
                            Layout::Single => row,
                            Layout::Batch => layout.place(*node as usize, 0) as u32,
                        };
                    }
                }
            }
        }
        let mut geometry = Column::zeros(packs * stored * lanes);
        let mut parameters = Column::zeros(packs * NUMBERS * WIDTH);
        let stiffnesses = if E::BOX { stiffness_numbers::<D, N>() } else { 0 };
        let mut stiffness = Column::zeros(packs * stiffnesses * WIDTH);
        for pack in 0..packs {
            for lane in 0..lanes {
                let this = cell(pack, lane);
                // What fills a pack up has no measure.
                let there = pack * lanes + lane < cells.len();
                let rest: [[f64; D]; N] = this.nodes.map(|n| positions[n as usize]);
                let mut put = |k: usize, value: f64| geometry[(pack * stored + k) * lanes + lane] = value;
                if E::BOX {
                    let rest = hourglass::Rest::new::<E>(&rest, thickness);
                    let measures = rest.measures.map(|measure| if there { measure } else { 0.0 });
                    let shares = rest.weights.iter().flat_map(|shares| &shares[..N - 1]);
                    let all = shares.chain(&measures).chain(&rest.means[..fields::<D>()]);
                    all.chain(rest.axes.as_flattened()).enumerate().for_each(|(k, value)| put(k, *value));
                    let bodies = if layout == Layout::Single { 0..1 } else { 0..WIDTH };
                    for body in bodies.filter(|_| there) {
                        let [mu, lambda, ..] = numbers(this.number, body);
                        let ratio = 0.5 * lambda / (lambda + mu);
                        let across = if D == 2 && !plane_stress { ratio } else { ratio / (1.0 + ratio) };
                        let mut of_cell = rest.response(across);
                        of_cell.extend([across, if mean { beyond(mu, lambda) } else { 0.0 }]);
                        of_cell.extend(rest.guards[..hourglass::modes::<D, N>()].iter().map(|guard| mu * guard));
                        for (k, number) in of_cell.into_iter().enumerate() {
                            stiffness[(pack * stiffnesses + k) * WIDTH + lane + body] = number;
                        }
                    }
                    continue;
                }
                for q in 0..E::POINTS {
                    let (inverse, determinant) = rest_gradient(&rest, &E::SLOPES[q]);
                    for j in 0..D {
                        for k in 0..D {
                            put(q * (D * D + 1) + j * D + k, inverse[j][k]);
                        }
                    }
                    let measure = if there { E::WEIGHTS[q] * determinant * thickness } else { 0.0 };
                    put((q + 1) * (D * D + 1) - 1, measure);
                }
            }
            for l in 0..WIDTH {
                let (this, body) = if layout == Layout::Single { (cell(pack, l), 0) } else { (cell(pack, 0), l) };
                for (k, number) in numbers(this.number, body).into_iter().enumerate() {
                    parameters[(pack * NUMBERS + k) * WIDTH + l] = number;
                }
            }
        }
        let uniform = parameters.chunks(NUMBERS * WIDTH).all(|pack| pack == &parameters[..NUMBERS * WIDTH]);
        if uniform {
            parameters = Column::from(&parameters[..NUMBERS * WIDTH]);
        }
        let mut section = Section {
            shape: PhantomData,
            layout,
            law,
            law_in_space,
            cells,
            points,
            shares,
            places,
            targets,
            geometry,
            stiffness,
            parameters,
            uniform,
            damped,
        };
        let mut start = 0;
        for k in 0..section.shares.len() {
            section.shares[k].start = start;
            start += section.scratch_len(&section.shares[k]);
        }
        section
    }

    pub(super) fn packs(&self) -> usize {
        match self.layout {
            Layout::Single => self.cells.len().div_ceil(WIDTH),
            Layout::Batch => self.cells.len(),
        }
    }

    pub(super) fn group(&self, first: usize, packs: usize) -> Group<'_> {
        Group {
            layout: self.layout,
            first,
            packs,
            count: self.cells.len(),
            points: self.points,
            turns: self.law.turns(),
            places: &self.places,
            targets: &self.targets,
            geometry: &self.geometry,
            stiffness: &self.stiffness,
            parameters: &self.parameters,
            step: if self.uniform { 0 } else { NUMBERS * WIDTH },
        }
    }

    /// All packs of a share, as many together as have so many packs of points, or one by one.
    pub(super) fn groups(&self, share: &Share, points: usize) -> impl Iterator<Item = Group<'_>> {
        let together = (points / self.points).max(1);
        let end = share.first + share.packs;
        (share.first..end).step_by(together).map(move |first| self.group(first, together.min(end - first)))
    }

    /// The places of the nodes of a pack, by node and lane.
    pub(super) fn places(&self, pack: usize) -> [[u32; WIDTH]; N] {
        let mut out = [[0; WIDTH]; N];
        for l in 0..WIDTH {
            let (element, body) = self.item(pack, l);
            let nodes = self.cells[element.min(self.cells.len() - 1)].nodes;
            for a in 0..N {
                out[a][l] = self.layout.place(nodes[a] as usize, body) as u32;
            }
        }
        out
    }

    /// Numbers of the copy of a vector of every node of a share.
    fn copy(&self, share: &Share) -> usize {
        if self.layout == Layout::Single { share.nodes.len() * ROW } else { 0 }
    }
    /// Numbers of the forces of a share.
    fn forces(&self, share: &Share) -> usize {
        share.nodes.len() * if self.layout == Layout::Single { ROW } else { WIDTH * D }
    }
    /// The positions that the evaluation of a share has copied.
    pub(super) fn positions<'a>(&self, share: &Share, view: &View<'a, D>, scratch: &'a [f64]) -> Nodes<'a, D> {
        let start = share.start + FORCES + self.forces(share);
        Nodes { rows: &scratch[start..start + self.copy(share)], columns: view.x }
    }

    /// The measure of a point of an element [m³]; of the mean of a box that of the box.
    pub(super) fn measure(&self, pack: usize, point: usize, lane: usize) -> f64 {
        let (lanes, lane) = if self.layout == Layout::Single { (WIDTH, lane) } else { (1, 0) };
        let at = |k: usize| self.geometry[(pack * stored::<E, D, N>() + k) * lanes + lane];
        match (E::BOX, point < E::POINTS) {
            (false, _) => at((point + 1) * (D * D + 1) - 1),
            (true, true) => at(N * (N - 1) + point),
            (true, false) => (0..N).map(|q| at(N * (N - 1) + q)).sum(),
        }
    }

    /// The element and body of a lane of a pack.
    pub(super) fn item(&self, pack: usize, lane: usize) -> (usize, usize) {
        match self.layout {
            Layout::Single => (pack * WIDTH + lane, 0),
            Layout::Batch => (pack, lane),
        }
    }

    /// Whether the law may have no energy. Laws of space and of plane strain have one everywhere; what overflows there has
    /// diverged, and is found so.
    pub(super) fn may_refuse(&self) -> bool {
        self.law_in_space.is_none() && D < 3
    }

    /// The refusal of the first element of a pack whose nodes are somewhere but whose energy is not a number.
    pub(super) fn refusal(&self, view: &View<D>, pack: usize, energy: &[f64]) -> Option<StepError> {
        (0..WIDTH).filter(|l| energy[*l].is_nan()).find_map(|l| {
            let (element, body) = self.item(pack, l);
            let cell = self.cells.get(element)?;
            let at = cell.nodes.map(|n| view.position(self.layout.place(n as usize, body)));
            at.iter().flatten().all(|x| x.is_finite()).then(|| StepError::Model {
                model: super::SPEC.kind,
                message: format!(
                    "cell {} has no positive thickness without stress across the plane at t = {} s: it is stretched or \
                     turned inside out beyond what its material can follow in plane stress",
                    cell.number, view.time
                ),
            })
        })
    }
}

/// Cuts packs of so many cells into shares.
fn shares<const N: usize>(cells: &[Cell<N>], packs: usize, lanes: usize, each: usize) -> Vec<Share> {
    let firsts = (0..packs).step_by(each);
    let share = |first: usize| {
        let packs = each.min(packs - first);
        let own = &cells[first * lanes..((first + packs) * lanes).min(cells.len())];
        let mut nodes: Vec<u32> = own.iter().flat_map(|cell| cell.nodes).collect();
        nodes.sort_unstable();
        nodes.dedup();
        Share { first, packs, nodes, start: 0 }
    };
    firsts.map(share).collect()
}

/// A vector of some nodes in rows.
fn to_rows<const D: usize>(columns: &[&[f64]; D], nodes: &[u32], rows: &mut [f64]) {
    for (node, row) in nodes.iter().zip(rows.chunks_exact_mut(ROW)) {
        for d in 0..D {
            row[d] = columns[d][*node as usize];
        }
    }
}

impl<E: Shape<D, N>, const D: usize, const N: usize> Part<D> for Section<E, D, N> {
    fn shares(&self) -> &[Share] {
        &self.shares
    }
    fn scratch_len(&self, share: &Share) -> usize {
        FORCES + self.forces(share) + self.copy(share) * if self.damped { 2 } else { 1 }
    }
    fn evaluate(&self, share: &Share, simd: Simd, view: &View<D>, scratch: &mut [f64]) -> Result<(), StepError> {
        let (sums, rest) = scratch.split_at_mut(FORCES);
        let (forces, rest) = rest.split_at_mut(self.forces(share));
        let (x, v) = rest.split_at_mut(self.copy(share));
        if self.layout == Layout::Single {
            to_rows(&view.x, &share.nodes, x);
            to_rows(&view.v, &share.nodes, v);
        }
        let nodes = [Nodes { rows: x, columns: view.x }, Nodes { rows: v, columns: view.v }];
        forces.fill(0.0);
        let mut totals = Totals::default();
        Pass::new(self, simd).forces(share, view, nodes, &mut totals, forces)?;
        sums[..WIDTH].copy_from_slice(&total(self.layout, &totals.energy));
        sums[WIDTH..].copy_from_slice(&total(self.layout, &totals.power));
        Ok(())
    }
    fn hessian(&self, view: &View<D>, scratch: &[f64], keep: Definiteness, sink: &mut dyn Sink<D>) {
        sink.stencil_packs(view.threads, &Matrices::hessian(self, view, scratch, keep));
    }
    fn damping_matrix(&self, view: &View<D>, scratch: &[f64], sink: &mut dyn Sink<D>) {
        if self.damped {
            sink.stencil_packs(view.threads, &Matrices::damping(self, view, scratch));
        }
    }
    fn cell_states(&self, view: &View<D>, body: usize, out: &mut Vec<CellState>) {
        for share in &self.shares {
            let mut rows = vec![0.0; self.copy(share)];
            to_rows(&view.x, &share.nodes, &mut rows);
            Pass::new(self, Simd::best()).cell_states(share, Nodes { rows: &rows, columns: view.x }, body, out);
        }
    }
    fn heap_bytes(&self) -> usize {
        let shares: usize = self.shares.iter().map(|share| share.nodes.capacity()).sum();
        let places = 4 * (self.places.capacity() + self.targets.capacity() + shares)
            + size_of::<Cell<N>>() * self.cells.capacity();
        places + self.geometry.heap_bytes() + self.stiffness.heap_bytes() + self.parameters.heap_bytes()
    }
}
