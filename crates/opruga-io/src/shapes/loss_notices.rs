//! Notices, with numbers, of what was lost when a body was made, and of parts that are worse than promised.

use super::errors::{Change, ShapeHint, ShapeNotice, ThinCause};
use super::settings;
use crate::problem::SceneError;
use opruga_math::message::Setting;
use opruga_math::words::{number, rounded};
use opruga_mesh::Mesh;
use opruga_mesh::outline::{self, Cause, Ring, SMALLEST_ANGLE, Thin};
use opruga_world::shapes::{Loss, REPORTED_LOSS};

/// If an outline has this many times more points in its file than nodes, it loses detail that the user may miss.
const THINNED: usize = 4;

/// The change of an area or a volume: `0.012 m³ (6.3 %) of 0.19 m³ lost`.
fn difference(before: f64, after: f64, unit: &'static str) -> Change {
    let off = (after - before).abs();
    let (off, percent, whole) = (rounded(off, 3), rounded(100.0 * off / before, 2), rounded(before, 3));
    match after < before {
        true => Change::Lost { off, unit, percent, whole },
        false => Change::Added { off, unit, percent, whole },
    }
}

/// The notice that tetrahedra do not have the volume of the surface that they fill; `scale` is a factor for all lengths that is applied later.
pub(crate) fn lost_volume<const D: usize>(filling: &Mesh<D>, loss: Loss, scale: f64) -> SceneError {
    let after = filling.measure().map_or(0.0, |measure| measure.value()) * (scale * scale * scale).abs();
    let change = difference(after / loss.kept, after, "m³");
    let warned = 100.0 * REPORTED_LOSS;
    let hint = match loss.finer {
        Some(spacing) => {
            ShapeHint::SpacingKeeps { spacing: Setting::with("spacing", number(spacing)), percent: warned }
        }
        None => ShapeHint::SmallerSpacing { spacing: Setting::named("spacing") },
    };
    SceneError::of(ShapeNotice::Filling { change, kept: rounded(loss.kept, 3), warned }).advice(hint)
}

/// The notice that a remeshed surface does not enclose its original volume.
pub(super) fn remeshed(made: &Mesh<3>, before: &Mesh<3>, length: f64, scale: f64) -> Option<SceneError> {
    let cube = (scale * scale * scale).abs();
    let (after, before) = (made.enclosed_volume() * cube, before.enclosed_volume() * cube);
    let (change, kept) = (difference(before, after, "m³"), rounded(after / before, 3));
    let notice = ShapeNotice::Remeshed { length, change, kept };
    ((after / before - 1.0).abs() > REPORTED_LOSS)
        .then(|| SceneError::of(notice).advice(ShapeHint::SmallerRemesh { remesh: Setting::named("remesh") }))
}

/// The notice that most points of an outline, or much of its area, are lost because of the spacing of its nodes. The arguments are the number of
/// points in the file, `given`, and the rings before and after.
pub(super) fn thinned(given: usize, before: &[Ring], rings: &[Ring], spacing: f64) -> Option<SceneError> {
    let nodes: usize = rings.iter().map(|ring| ring.points.len()).sum();
    let area = |rings: &[Ring]| rings.iter().map(Ring::area).sum::<f64>();
    let (whole, left) = (area(before), area(rings));
    let (many, much) = (given > THINNED * nodes, (left / whole - 1.0).abs() > REPORTED_LOSS);
    let change = || difference(whole, left, "m²");
    let (finer, lattice) = (Setting::named("spacing"), settings::lattice());
    let notice = match (many, much) {
        (true, _) => ShapeNotice::Thinned { given, nodes, spacing, change: change(), finer, lattice },
        (false, true) => {
            ShapeNotice::Coarse { nodes, spacing, change: change(), kept: rounded(left / whole, 3), finer, lattice }
        }
        (false, false) => return None,
    };
    Some(SceneError::of(notice))
}

/// The notice that outlines became holes in the outline around them, although the outer outline belongs to another element, on which they are
/// painted. The notice gives the number of these outlines. Also returns the part of the drawing with the first of them. Rings are nested; holes run
/// clockwise.
pub(super) fn nested(rings: &[Ring]) -> Option<(u32, SceneError)> {
    // A ring is a hole of the innermost of the rings around it.
    let around = outline::around(rings);
    let holes = (0..rings.len()).filter(|number| rings[*number].area() < 0.0);
    let foreign: Vec<u32> = holes
        .filter(|number| around[*number].is_some_and(|outer| rings[outer].part != rings[*number].part))
        .map(|number| rings[number].part)
        .collect();
    let first = *foreign.first()?;
    Some((
        first,
        SceneError::of(ShapeNotice::Nested {
            count: foreign.len(),
            union: settings::union(),
            parity: settings::parity(),
        }),
    ))
}

/// The notice that triangles have sharper angles than fillings promise.
pub(super) fn thin(mesh: &Mesh<2>, thin: &Thin) -> SceneError {
    let (spacing, lattice) = (Setting::named("spacing"), settings::lattice());
    let (cause, hint) = match thin.cause {
        Cause::Corner(angle) => (ThinCause::Corner { angle: rounded(angle, 3) }, ShapeHint::RoundCorner { lattice }),
        Cause::Finer => {
            (ThinCause::Finer { spacing: spacing.clone() }, ShapeHint::SmallerOrLattice { spacing, lattice })
        }
        Cause::Unfinished => (ThinCause::Unfinished {}, ShapeHint::LargerOrLattice { spacing, lattice }),
    };
    let [angle, x, y] = [thin.angle, thin.position[0], thin.position[1]].map(|number| rounded(number, 3));
    let (count, triangles, least) = (thin.count, mesh.cells.len(), SMALLEST_ANGLE);
    SceneError::of(ShapeNotice::ThinTriangles { count, triangles, least, angle, x, y, cause }).advice(hint)
}

/// The number of vertices at exactly the same position as another one.
pub(super) fn seams(mesh: &Mesh<3>) -> usize {
    let mut coordinates: Vec<[u64; 3]> = mesh.positions.iter().map(|p| p.map(|x| (x + 0.0).to_bits())).collect();
    coordinates.sort_unstable();
    coordinates.windows(2).filter(|pair| pair[0] == pair[1]).count()
}
