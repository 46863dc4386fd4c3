//! From the curves of a drawing to rings of the wanted size and spacing.

use super::curves::{Curves, larger};
use super::{Content, Loaded, Problem};
use crate::problem::SceneError;
use crate::source::Source;
use opruga_core::spec::Values;
use opruga_mesh::outline::{self, OutlineError, Overlap, Ring};

/// Curves are followed within this part of the spacing.
const TOLERANCE: f64 = 0.002;

/// What a reader found.
pub(super) struct Drawing<'a> {
    pub(super) curves: Curves,
    /// Whether y points downwards.
    pub(super) y_down: bool,
    /// The file, if it is a text, and where each part stands in it.
    pub(super) source: Option<&'a Source<'a>>,
    pub(super) places: Vec<(usize, usize)>,
    pub(super) notices: Vec<SceneError>,
}

impl Drawing<'_> {
    /// An error at a part of the drawing.
    fn at(&self, part: u32, error: SceneError) -> SceneError {
        match (self.source, self.places.get(part as usize)) {
            (Some(source), Some((from, to))) => source.mark(error, *from, *to),
            _ => error,
        }
    }
}

/// Size, overlaps, holes and spacing, as the scene asks for.
pub(super) fn loaded(mut drawing: Drawing<'_>, shape: &Values) -> Result<Loaded, Problem> {
    let spacing = shape.number("spacing").unwrap_or(1.0);
    let size = shape.number("size").unwrap_or(1.0);
    let extent = drawing.curves.extent();
    if !(extent > 0.0 && extent.is_finite() && extent > 1e-150 && extent < 1e150) {
        let error = SceneError::new("shape.no_area", "the file holds no closed outline").value(format!("{extent:e}"));
        return Err(error.allowed("outlines that enclose area, of an extent from 1e-150 to 1e150").into());
    }
    let mut rings = drawing.curves.flatten(TOLERANCE * spacing * extent / size);

    // Strokes and points enclose nothing.
    let before = rings.len();
    rings.retain(|ring| ring.points.len() > 2 && ring.area().abs() > 1e-12 * extent * extent);
    if rings.len() < before {
        let count = before - rings.len();
        let (what, verb) = if count == 1 { ("outline", "is") } else { ("outlines", "are") };
        let message = format!("{count} {what} without area {verb} left out");
        drawing.notices.push(SceneError::new("shape.no_area", message).value(count.to_string()));
    }
    match shape.text("overlap") {
        Some("union") => rings = outline::joined(&rings, Overlap::Union),
        Some("even_odd") => rings = outline::joined(&rings, Overlap::EvenOdd),
        _ => {}
    }
    let mut rings = place(rings, &drawing, shape)?;

    let least = shape.number("drop_below").unwrap_or(0.0);
    let before = rings.len();
    rings.retain(|ring| ring.area().abs() >= least);
    if rings.len() < before {
        let count = before - rings.len();
        let message = format!("{count} of {before} outlines have less than {least} m² and are left out");
        drawing.notices.push(SceneError::new("shape.dropped", message).value(count.to_string()));
    }
    if rings.is_empty() {
        let error = SceneError::new("shape.no_area", "no outline is left").value(least.to_string());
        return Err(Problem::new(if before > 0 { "drop_below" } else { "file" }, error));
    }
    let rings = outline::resampled(&rings, spacing).map_err(|e| {
        let hint = "take a smaller `spacing`, a larger `size`, or `drop_below`";
        Problem::new("spacing", refused(&e).value(spacing.to_string()).hint(hint))
    })?;
    let filling = (shape.text("filling") == Some("triangles")).then_some(spacing);
    Ok(Loaded { notices: drawing.notices, content: Content::Outline { rings, filling } })
}

/// Turns holes the other way and brings the drawing to its size and place.
fn place(mut rings: Vec<Ring>, drawing: &Drawing<'_>, shape: &Values) -> Result<Vec<Ring>, Problem> {
    outline::nest(&mut rings).map_err(|e| match &e {
        OutlineError::Meeting { parts, .. } => {
            let hint = "`overlap = \"union\"` keeps what any of them covers, `overlap = \"even_odd\"` what an odd number encloses";
            Problem::from(drawing.at(parts[1], refused(&e).hint(hint)))
        }
        OutlineError::NoArea { part, .. } | OutlineError::NotFinite { part, .. } => {
            drawing.at(*part, refused(&e)).into()
        }
        _ => refused(&e).into(),
    })?;
    let Some((low, high)) = outline::bounds(&rings) else { return Ok(rings) };
    let center: [f64; 2] = shape.vector("center");
    let factor = shape.number("size").unwrap_or(1.0) / larger(high[0] - low[0], high[1] - low[1]);
    let middle = [0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])];
    let up = if drawing.y_down { -factor } else { factor };
    for ring in &mut rings {
        for point in &mut ring.points {
            *point = [center[0] + factor * (point[0] - middle[0]), center[1] + up * (point[1] - middle[1])];
        }
        if drawing.y_down {
            ring.points.reverse();
        }
    }
    Ok(rings)
}

/// An error of outlines as an error of the scene.
pub(super) fn refused(error: &OutlineError) -> SceneError {
    let code = match error {
        OutlineError::Empty | OutlineError::NoArea { .. } => "shape.no_area",
        OutlineError::NotFinite { .. } => "scene.not_finite",
        OutlineError::Meeting { .. } => "shape.crossing",
        OutlineError::TooCoarse { .. } => "shape.spacing",
        OutlineError::TooFine { .. } => "limit.nodes",
        OutlineError::Mesh(_) => "scene.shape",
    };
    let value = match error {
        OutlineError::Meeting { place, .. } | OutlineError::NoArea { place, .. } => {
            format!("{}, {}", place[0], place[1])
        }
        OutlineError::NotFinite { value, .. } => value.to_string(),
        OutlineError::TooCoarse { spacing, .. } | OutlineError::TooFine { spacing, .. } => spacing.to_string(),
        OutlineError::Empty | OutlineError::Mesh(_) => return SceneError::new(code, error.to_string()),
    };
    SceneError::new(code, error.to_string()).value(value)
}
