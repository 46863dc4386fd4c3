//! Cells that are too long for the thickness of their body, and therefore too stiff in bending and torsion.
//!
//! A cell whose shape functions cannot represent bending has a spurious strain in proportion to its length. A body of thickness T is then too stiff
//! in bending, with a relative error of about (L/T)², however many cells there are across its thickness. Measurements on beams and plates
//! (`tests/all/slender_cells.rs`, docs/finite-elements.md) show that the first frequencies are 45 % too high for linear cells with a longest edge of
//! T, and 10 % too high for quadratic tetrahedra with a longest edge of 8.5 T. Quadratic tetrahedra lack only a part of torsion. Quadratic triangles
//! and boxes have no limit.

use crate::blueprint::BodyBlueprint;
use crate::warnings::{BendingHint, Warning, WorldWarning};
use crate::world::World;
use opruga_core::spec::Role;
use opruga_mesh::{Element, Mesh};
use opruga_solve::dense::symmetric_eigen;

/// The measured limit of a kind of cells.
struct Limit {
    /// The longest edge of cells, relative to the thickness of their body.
    length: f64,
    /// The relative error of the first frequencies at this length [%].
    error: f64,
    /// A better choice for bending.
    hint: BendingHint,
}

const LINEAR: Limit = Limit { length: 1.0, error: 45.0, hint: BendingHint::Quadratic };
const QUADRATIC_TETRAHEDRON: Limit = Limit { length: 8.5, error: 10.0, hint: BendingHint::Hexahedra };

/// The limit of a kind of cells, if it has one.
fn limit(element: Element) -> Option<&'static Limit> {
    match element {
        Element::Triangle | Element::Tetrahedron => Some(&LINEAR),
        Element::QuadraticTetrahedron => Some(&QUADRATIC_TETRAHEDRON),
        _ => None,
    }
}

impl<const D: usize> World<D> {
    /// Warns about bodies of finite elements with more than half of their volume in cells beyond the limit of their kind. There is one warning, for
    /// the body that exceeds its limit the most; copies are counted.
    pub(crate) fn warn_of_slender_cells(&mut self) {
        let mut worst: Option<(usize, Slender)> = None;
        let mut count = 0;
        // Copies share their mesh.
        let mut last: Option<(*const Mesh<D>, Option<Slender>)> = None;
        for (number, body) in self.blueprint.bodies.iter().enumerate() {
            let mesh: *const Mesh<D> = &raw const *body.mesh;
            let found = match &last {
                Some((known, found)) if *known == mesh => *found,
                _ => slender(body),
            };
            last = Some((mesh, found));
            let Some(found) = found else { continue };
            count += 1;
            if worst.is_none_or(|(_, known)| found.times() / found.limit.length > known.times() / known.limit.length) {
                worst = Some((number, found));
            }
        }
        let Some((body, found)) = worst else { return };
        let Limit { length: limit, error, hint: help } = *found.limit;
        let (length, times, thickness) = (found.length, found.times(), found.thickness);
        let body = self.blueprint.bodies[body].name.clone();
        let warning = WorldWarning::Slender { body, length, times, thickness, limit, error, help };
        self.warnings.push(Warning::new(warning, count));
    }
}

/// The cells of a body that are too long.
#[derive(Clone, Copy)]
struct Slender {
    /// The mean of their longest edges [m].
    length: f64,
    /// The thickness of the body [m].
    thickness: f64,
    limit: &'static Limit,
}

impl Slender {
    fn times(&self) -> f64 {
        self.length / self.thickness
    }
}

fn slender<const D: usize>(body: &BodyBlueprint<D>) -> Option<Slender> {
    let mesh = &*body.mesh;
    let solid = body.models.iter().any(|model| model.spec().has_role(Role::OwnsCells));
    if !solid || mesh.cells.iter().all(|(element, ..)| limit(element).is_none()) {
        return None;
    }
    let measures = mesh.cell_measures();
    let volume: f64 = measures.iter().map(|cell| cell.whole).sum();
    let thickness = thickness(mesh, volume)?;
    let (mut beyond, mut lengths) = (0.0, 0.0);
    let mut kind: Option<(f64, &'static Limit)> = None;
    for ((element, ..), cell) in mesh.cells.iter().zip(&measures) {
        let Some(limit) = limit(element).filter(|limit| cell.longest > limit.length * thickness) else { continue };
        beyond += cell.whole;
        lengths += cell.whole * cell.longest;
        // If several kinds of cells are beyond their limits, the kind with the lowest limit is named.
        if kind.is_none_or(|(length, _)| limit.length < length) {
            kind = Some((limit.length, limit));
        }
    }
    let (_, limit) = kind?;
    (beyond > 0.5 * volume).then(|| Slender { length: lengths / beyond, thickness, limit })
}

/// The thickness of a body at its thinnest [m]. It is the extent along the shortest axis of inertia or, if the body is curved or hollow, twice the
/// volume divided by the surface, which is the thickness of a plate and of a shell. The shortest extent of a block in D dimensions is at most 2D
/// times its volume over its surface.
fn thickness<const D: usize>(mesh: &Mesh<D>, volume: f64) -> Option<f64> {
    let mut surface = 0.0;
    for facet in &mesh.facets {
        let at = |k: usize| mesh.positions[facet[k] as usize];
        let side = |k: usize| -> [f64; 3] {
            let (from, to) = (at(0), at(k));
            core::array::from_fn(|d| if d < D { to[d] - from[d] } else { 0.0 })
        };
        let (a, b) = (side(1), if D == 3 { side(2) } else { [0.0, 0.0, 1.0] });
        let normal: [f64; 3] =
            core::array::from_fn(|d| a[(d + 1) % 3] * b[(d + 2) % 3] - a[(d + 2) % 3] * b[(d + 1) % 3]);
        let area = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
        surface += if D == 3 { 0.5 * area } else { area };
    }
    let plate = 2.0 * volume / surface;
    let block = D as f64 * plate;
    let across = shortest_extent(mesh);
    let thickness = if across > 2.0 * block {
        plate
    } else if across < block {
        across
    } else {
        block
    };
    (thickness > 0.0 && thickness.is_finite()).then_some(thickness)
}

/// The extent along the axis with the smallest spread of nodes [m].
fn shortest_extent<const D: usize>(mesh: &Mesh<D>) -> f64 {
    let count = mesh.positions.len() as f64;
    let center: [f64; D] = core::array::from_fn(|d| mesh.positions.iter().map(|x| x[d]).sum::<f64>() / count);
    let mut spread = vec![0.0; D * D];
    for x in &mesh.positions {
        for (k, s) in spread.iter_mut().enumerate() {
            *s += (x[k / D] - center[k / D]) * (x[k % D] - center[k % D]);
        }
    }
    let (_, axes) = symmetric_eigen(&spread, D);
    let Some(axis) = axes.first() else { return 0.0 };
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for x in &mesh.positions {
        let along: f64 = (0..D).map(|d| axis[d] * (x[d] - center[d])).sum();
        low = if along < low { along } else { low };
        high = if along > high { along } else { high };
    }
    high - low
}
