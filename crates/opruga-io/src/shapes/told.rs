//! What the making of a body has lost, and where it is worse than promised: said in figures.

use crate::problem::SceneError;
use opruga_math::words::{counted, number, rounded};
use opruga_mesh::Mesh;
use opruga_mesh::outline::{self, Cause, Ring, SMALLEST_ANGLE, Thin};
use opruga_world::shapes::{LOST_AND_TOLD, Loss};

/// An outline that has so many times more points in its file than nodes loses detail that one may look for.
const THINNED: usize = 4;

/// How much of an area or a volume is gone, or has come: `0.012 m³ (6.3 %) of 0.19 m³ is lost`.
fn difference(before: f64, after: f64, unit: &str) -> String {
    let off = (after - before).abs();
    let what = if after < before { "lost" } else { "added" };
    let part = rounded(100.0 * off / before, 2);
    format!("{} {unit} ({part} %) of {} {unit} {what}", rounded(off, 3), rounded(before, 3))
}

/// That tetrahedra have not the volume of the surface that they fill; `scale` is a factor on all lengths that is still to come.
pub(crate) fn lost_volume<const D: usize>(filling: &Mesh<D>, loss: Loss, scale: f64) -> SceneError {
    let after = filling.measure().map_or(0.0, |measure| measure.value()) * (scale * scale * scale).abs();
    let what = difference(after / loss.kept, after, "m³");
    let error = SceneError::new("shape.lost_volume", format!("the filling leaves {what}"));
    let hint = match loss.finer {
        Some(spacing) => format!("`spacing = {}` keeps the volume within {} %", number(spacing), 100.0 * LOST_AND_TOLD),
        None => "take a smaller `spacing`".to_string(),
    };
    let allowed = format!("{} % of the volume, above 25 % is an error", 100.0 * LOST_AND_TOLD);
    error.value(rounded(loss.kept, 3)).allowed(allowed).hint(hint)
}

/// That a surface made anew does not enclose the volume that it had.
pub(super) fn remeshed(made: &Mesh<3>, before: &Mesh<3>, length: f64, scale: f64) -> Option<SceneError> {
    let cube = (scale * scale * scale).abs();
    let (after, before) = (made.enclosed_volume() * cube, before.enclosed_volume() * cube);
    let what = format!("edges of {} m leave {}", number(length), difference(before, after, "m³"));
    let error = SceneError::new("shape.lost_volume", what).value(rounded(after / before, 3));
    ((after / before - 1.0).abs() > LOST_AND_TOLD).then(|| error.hint("take a smaller `remesh`"))
}

/// That most points of an outline are left out, or much of its area, as the spacing of its nodes wants it: `given` points in the file, and the rings
/// before and after.
pub(super) fn thinned(given: usize, before: &[Ring], rings: &[Ring], spacing: f64) -> Option<SceneError> {
    let nodes: usize = rings.iter().map(|ring| ring.points.len()).sum();
    let area = |rings: &[Ring]| rings.iter().map(Ring::area).sum::<f64>();
    let (whole, left) = (area(before), area(rings));
    let (many, much) = (given > THINNED * nodes, (left / whole - 1.0).abs() > LOST_AND_TOLD);
    (many || much).then(|| {
        let points = counted(given as u64, "point of the file becomes", "points of the file become");
        let points = if many { format!("{points} ") } else { String::new() };
        let message = format!(
            "{points}{nodes} nodes{} {} m apart{} {}",
            if many { "," } else { "" },
            number(spacing),
            if many { ":" } else { " leave" },
            difference(whole, left, "m²")
        );
        let hint = "a smaller `spacing` keeps finer detail, `filling = \"lattice\"` carries all of it";
        let value = if many { given.to_string() } else { rounded(left / whole, 3) };
        SceneError::new("shape.thinned", message).value(value).hint(hint)
    })
}

/// How many outlines of a drawing are holes since they lie within one of another element, which paints there too; and the first of these
/// elements. Rings are nested, holes run clockwise.
pub(super) fn nested(rings: &[Ring]) -> Option<(u32, SceneError)> {
    // The innermost of those around it is what a ring is a hole of.
    let around = outline::around(rings);
    let holes = (0..rings.len()).filter(|number| rings[*number].area() < 0.0);
    let foreign: Vec<u32> = holes
        .filter(|number| around[*number].is_some_and(|outer| rings[outer].part != rings[*number].part))
        .map(|number| rings[number].part)
        .collect();
    let first = *foreign.first()?;
    let count = foreign.len();
    let message = if count == 1 {
        format!("{count} outline lies within one of another element and is a hole there")
    } else {
        format!("{count} outlines lie within those of other elements and are holes there")
    };
    let hint =
        "`overlap = \"union\"` keeps what any element paints, `overlap = \"even_odd\"` says that holes are meant";
    Some((first, SceneError::new("shape.nested", message).value(count.to_string()).hint(hint)))
}

/// That triangles have sharper angles than fillings promise.
pub(super) fn thin(mesh: &Mesh<2>, thin: &Thin) -> SceneError {
    let (why, hint) = match thin.cause {
        Cause::Corner(angle) => {
            let why = format!("the outline itself has a corner of {}° there", rounded(angle, 3));
            (why, "round it off in the drawing, or take `filling = \"lattice\"`")
        }
        Cause::Finer => {
            ("the outline is finer there than `spacing`".into(), "take a smaller `spacing`, or `filling = \"lattice\"`")
        }
        Cause::Unfinished => (
            "the refinement has added as many nodes as it may".into(),
            "take a larger `spacing`, or `filling = \"lattice\"`",
        ),
    };
    let message = format!(
        "{} of {} {} angles below {SMALLEST_ANGLE}°, the smallest {}° at ({}, {}): {why}",
        thin.count,
        counted(mesh.cells.len() as u64, "triangle", "triangles"),
        if thin.count == 1 { "has" } else { "have" },
        rounded(thin.angle, 3),
        rounded(thin.place[0], 3),
        rounded(thin.place[1], 3),
    );
    let error = SceneError::new("shape.thin_triangles", message).value(rounded(thin.angle, 3));
    error.allowed(format!("angles from {SMALLEST_ANGLE}°")).hint(hint)
}

/// Vertices that lie exactly where another one lies.
pub(super) fn seams(mesh: &Mesh<3>) -> usize {
    let mut places: Vec<[u64; 3]> = mesh.positions.iter().map(|p| p.map(|x| (x + 0.0).to_bits())).collect();
    places.sort_unstable();
    places.windows(2).filter(|pair| pair[0] == pair[1]).count()
}
