//! Elements of one kind and one material, on one body or on eight identical ones.
//!
//! ```text
//! positions ─gather→ F at the points of some packs of elements ─law→ P ─→ forces of the elements ─scatter→ forces of the nodes
//!            └────────────── a few kilobytes that stay in the first-level cache ──────────────┘
//! ```
//!
//! Every element is evaluated once. A pack consists of eight neighbouring elements of one body, or of the same element of eight
//! bodies.
//!
//! The elements of a body are divided into *shares* for threads. A share has its own rows for the nodes that it touches. Forces
//! are summed in these rows in the order of the elements of the share, and then at each node in the order of the shares.
//! Neither the shares nor the bits of the results depend on the number of threads or on the layout.

use super::boxes::{self, Boxes};
use super::elements::{Cell, Shape, rest_gradient};
use super::group::Group;
use super::numbers::{NUMBERS, beyond};
use super::refusals::Refusal;
use super::work::Nodes;
use crate::materials::law::Law;
use core::fmt::Debug;
use core::marker::PhantomData;
use opruga_core::error::StepError;
use opruga_core::state::{Layout, View};
use opruga_math::{Column, ROW, WIDTH};

/// The number of packs of points in a share. A share takes at most a hundred kilobytes of memory and half a millisecond of
/// time.
const SHARE: usize = 512;

/// The offset of the forces of a share in its scratch, after energies and powers.
pub(super) const FORCES: usize = 2 * WIDTH;

/// Elements of one kind and one material.
#[derive(Debug)]
pub(super) struct Section<E, const D: usize, const N: usize> {
    shape: PhantomData<E>,
    pub(super) layout: Layout,
    pub(super) law: Box<dyn Law<D>>,
    /// The law in space, which gives the out-of-plane stress. It is `None` in plane stress.
    pub(super) law_in_space: Option<Box<dyn Law<3>>>,
    /// The elements, ordered by lowest node.
    pub(super) cells: Vec<Cell<N>>,
    /// The number of points of an element at which the law is evaluated.
    pub(super) points: usize,
    pub(super) shares: Vec<Share>,
    /// The location of the nodes of the elements: for one body, N packs of rows of the share for every pack of elements; for
    /// eight bodies, N indices for every element.
    pub(super) node_indices: Vec<u32>,
    /// For eight bodies, the N rows of the share for every element.
    pub(super) targets: Vec<u32>,
    /// (∂X/∂ξ)⁻¹ row by row and the measure [m³], point by point; in packs for one body. Boxes have data of their own.
    pub(super) geometry: Column,
    pub(super) boxes: Boxes,
    /// The parameters: [`NUMBERS`] values for every pack of elements, or one set for all of them.
    pub(super) parameters: Column,
    /// Whether the parameters of the first pack apply to all packs.
    pub(super) uniform: bool,
    pub(super) damped: bool,
    /// Whether the nodes carry the volumetric stiffness beyond λ′ (see [`super::nodal_volume`]).
    pub(super) nodal: bool,
    /// The depth out of the plane [m]. It is 1 in space.
    pub(super) thickness: f64,
}

/// Packs of elements that one thread processes at a time.
#[derive(Debug)]
pub(super) struct Share {
    /// The first pack, and the number of packs.
    pub(super) first: usize,
    pub(super) packs: usize,
    /// The nodes of its elements, ascending, with a row for each.
    pub(super) nodes: Vec<u32>,
    /// The offset of the scratch of this share in the scratch of the section.
    pub(super) start: usize,
}

/// The data from which a section is built.
pub(super) struct Plan<'a, const D: usize> {
    pub(super) layout: Layout,
    pub(super) law: Box<dyn Law<D>>,
    pub(super) law_in_space: Option<Box<dyn Law<3>>>,
    pub(super) positions: &'a [[f64; D]],
    /// The depth out of the plane [m]. It is 1 in space.
    pub(super) thickness: f64,
    /// Whether the out-of-plane stress is zero.
    pub(super) plane_stress: bool,
    /// Whether the nodes carry the volumetric stiffness beyond λ′ (see [`super::nodal_volume`]).
    pub(super) nodal: bool,
    pub(super) damped: bool,
}

/// How many numbers describe the geometry of the points of an element, unless it is a box.
const fn stored<E: Shape<D, N>, const D: usize, const N: usize>() -> usize {
    if E::BOX { 0 } else { E::POINTS * (D * D + 1) }
}

impl<E: Shape<D, N>, const D: usize, const N: usize> Section<E, D, N> {
    /// Lays out elements. `numbers` gives the parameters of a cell of a body.
    pub(super) fn new(
        plan: Plan<'_, D>,
        mut cells: Vec<Cell<N>>,
        numbers: &dyn Fn(u32, usize) -> [f64; NUMBERS],
    ) -> Self {
        let Plan { layout, law, law_in_space, positions, thickness, plane_stress, nodal, damped } = plan;
        let lowest = |cell: &Cell<N>| cell.nodes.iter().copied().min().unwrap_or(0);
        cells.sort_by_key(|cell| (lowest(cell), cell.nodes, cell.number));
        let resists_volume = |cell: &Cell<N>| {
            let bodies = if layout == Layout::Single { 0..1 } else { 0..WIDTH };
            bodies.into_iter().any(|body| {
                let [mu, lambda, ..] = numbers(cell.number, body);
                beyond(mu, lambda) > 0.0
            })
        };
        // Boxes also evaluate the law at their mean if it resists changes of volume strongly.
        let mean = E::BOX && !plane_stress && cells.iter().any(resists_volume);
        let points = E::POINTS + usize::from(mean);
        let stored = stored::<E, D, N>();
        let lanes = if layout == Layout::Single { WIDTH } else { 1 };
        let packs = cells.len().div_ceil(lanes);
        let cell = |pack: usize, lane: usize| &cells[(pack * lanes + lane).min(cells.len() - 1)];

        // The number of elements in a share is the same in both layouts, whatever the material of the other bodies.
        let shares = shares(&cells, packs, lanes, (SHARE / E::POINTS).max(1) * WIDTH / lanes);
        let mut node_indices = vec![0; packs * N * lanes];
        let mut targets = vec![0; if layout == Layout::Batch { packs * N } else { 0 }];
        for share in &shares {
            for pack in share.first..share.first + share.packs {
                for lane in 0..lanes {
                    for (a, node) in cell(pack, lane).nodes.iter().enumerate() {
                        let row = share.nodes.partition_point(|own| own < node) as u32;
                        if layout == Layout::Batch {
                            targets[pack * N + a] = row;
                        }
                        node_indices[(pack * N + a) * lanes + lane] = match layout {
                            Layout::Single => row,
                            Layout::Batch => layout.index(*node as usize, 0) as u32,
                        };
                    }
                }
            }
        }
        let mut geometry = Column::zeros(packs * stored * lanes);
        let mut parameters = Column::zeros(packs * NUMBERS * WIDTH);
        let boxes = if E::BOX && !cells.is_empty() {
            let plan = boxes::Plan { layout, positions, thickness, plane_stress, cells: &cells, mean };
            Boxes::new::<E, D, N>(&plan, numbers)
        } else {
            Boxes::default()
        };
        for pack in 0..packs {
            for lane in 0..lanes {
                let this = cell(pack, lane);
                // Lanes that fill up the last pack have no measure.
                let there = pack * lanes + lane < cells.len();
                let rest: [[f64; D]; N] = this.nodes.map(|n| positions[n as usize]);
                let mut put = |k: usize, value: f64| geometry[(pack * stored + k) * lanes + lane] = value;
                for q in 0..if E::BOX { 0 } else { E::POINTS } {
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
            node_indices,
            targets,
            geometry,
            boxes,
            parameters,
            uniform,
            damped,
            nodal,
            thickness,
        };
        let mut start = 0;
        for k in 0..section.shares.len() {
            section.shares[k].start = start;
            start += section.numbers_of(&section.shares[k]);
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
            node_indices: &self.node_indices,
            targets: &self.targets,
            geometry: &self.geometry,
            boxes: &self.boxes,
            parameters: &self.parameters,
            step: if self.uniform { 0 } else { NUMBERS * WIDTH },
        }
    }

    /// Splits the packs of a share into groups of at most `points` packs of points. Every group has at least one pack of
    /// elements.
    pub(super) fn groups(&self, share: &Share, points: usize) -> impl Iterator<Item = Group<'_>> {
        let together = (points / self.points).max(1);
        let end = share.first + share.packs;
        (share.first..end).step_by(together).map(move |first| self.group(first, together.min(end - first)))
    }

    /// The indices of the nodes of a pack, by node and lane.
    pub(super) fn indices(&self, pack: usize) -> [[u32; WIDTH]; N] {
        let mut out = [[0; WIDTH]; N];
        for l in 0..WIDTH {
            let (element, body) = self.item(pack, l);
            let nodes = self.cells[element.min(self.cells.len() - 1)].nodes;
            for a in 0..N {
                out[a][l] = self.layout.index(nodes[a] as usize, body) as u32;
            }
        }
        out
    }

    /// The length of a copy of one vector per node of a share.
    pub(super) fn copy(&self, share: &Share) -> usize {
        if self.layout == Layout::Single { share.nodes.len() * ROW } else { 0 }
    }
    /// The length of the forces of a share.
    pub(super) fn forces(&self, share: &Share) -> usize {
        share.nodes.len() * if self.layout == Layout::Single { ROW } else { WIDTH * D }
    }
    /// The positions that were copied when the share was evaluated.
    pub(super) fn positions<'a>(&self, share: &Share, view: &View<'a, D>, scratch: &'a [f64]) -> Nodes<'a, D> {
        let start = share.start + FORCES + self.forces(share);
        Nodes { rows: &scratch[start..start + self.copy(share)], columns: view.x }
    }
    /// The offset of J − 1 of the elements in the scratch of a share.
    pub(super) fn grown(&self, share: &Share) -> usize {
        FORCES + self.forces(share) + self.copy(share) * if self.damped { 2 } else { 1 }
    }

    /// The length of the scratch of a share.
    pub(super) fn numbers_of(&self, share: &Share) -> usize {
        self.grown(share) + if self.nodal { share.packs * WIDTH } else { 0 }
    }

    /// The measure of a point of an element [m³]. For the mean of a box, it is the measure of the box.
    pub(super) fn measure(&self, pack: usize, point: usize, lane: usize) -> f64 {
        let (lanes, lane) = if self.layout == Layout::Single { (WIDTH, lane) } else { (1, 0) };
        if E::BOX {
            return self.boxes.measure::<D, N>(
                self.group(pack, 1).one_or(self.boxes.one_geometry, pack),
                point,
                [lane, lanes],
            );
        }
        self.geometry[(pack * stored::<E, D, N>() + (point + 1) * (D * D + 1) - 1) * lanes + lane]
    }

    /// The element and body of a lane of a pack.
    pub(super) fn item(&self, pack: usize, lane: usize) -> (usize, usize) {
        match self.layout {
            Layout::Single => (pack * WIDTH + lane, 0),
            Layout::Batch => (pack, lane),
        }
    }

    /// Whether the energy of the law may be undefined. Laws in space and in plane strain have an energy everywhere. If that
    /// energy overflows, the motion has diverged, which is detected elsewhere.
    pub(super) fn may_refuse(&self) -> bool {
        self.law_in_space.is_none() && D < 3
    }

    /// The refusal of the first element of a pack whose nodes have finite positions but whose energy is NaN.
    pub(super) fn refusal(&self, view: &View<D>, pack: usize, energy: &[f64]) -> Option<StepError> {
        (0..WIDTH).filter(|l| energy[*l].is_nan()).find_map(|l| {
            let (element, body) = self.item(pack, l);
            let cell = self.cells.get(element)?;
            let at = cell.nodes.map(|n| view.position(self.layout.index(n as usize, body)));
            at.iter().flatten().all(|x| x.is_finite()).then(|| {
                let refusal = Refusal::NoThicknessLeft { cell: cell.number, time: view.time };
                StepError::of(super::SPEC.kind, refusal)
            })
        })
    }
}

/// Divides packs into shares of `each` packs.
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
