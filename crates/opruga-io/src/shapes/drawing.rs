//! Converts the curves of a drawing to rings of the desired size and spacing.

use super::curves::{Curves, larger};
use super::errors::{ShapeError, ShapeHint, ShapeNotice};
use super::rules::{self, Rule};
use super::{Content, Loaded, Problem, loss_notices, settings};
use crate::budget::{OUTLINES, POINTS};
use crate::problem::SceneError;
use crate::scene::shown;
use crate::source::Source;
use opruga_core::spec::Values;
use opruga_math::message::Setting;
use opruga_math::words::rounded;
use opruga_mesh::outline::{self, OutlineError, Overlap, Painted, Ring};
use opruga_mesh::{MAXIMUM_NODES, Mesh, MeshError};

/// Curves are approximated within this fraction of the spacing.
const TOLERANCE: f64 = 0.002;

/// What a reader found.
pub(super) struct Drawing<'a> {
    pub(super) curves: Curves,
    /// Whether y points downwards.
    pub(super) y_down: bool,
    /// The file, if it is a text, and the location of each part in it.
    pub(super) source: Option<&'a Source<'a>>,
    pub(super) spans: Vec<(usize, usize)>,
    /// The colours of the parts, if they are needed: red, green, blue, opacity.
    pub(super) painted: Vec<Option<[u8; 4]>>,
    /// The fill rule of each part; the even-odd rule for parts without one.
    pub(super) rules: Vec<Rule>,
    pub(super) notices: Vec<SceneError>,
}

impl Drawing<'_> {
    /// An error at a part of the drawing.
    fn at(&self, part: u32, error: SceneError) -> SceneError {
        match (self.source, self.spans.get(part as usize)) {
            (Some(source), Some((from, to))) => source.mark(error, *from, *to),
            _ => error,
        }
    }
}

/// The filling of an outline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Inside {
    /// Nothing: the body is a skin of edges.
    Nothing,
    /// Triangles that follow the outline, with sides of about this length [m].
    Triangles(f64),
    /// Squares that cover the area of the outline, with sides of this length [m].
    Squares(f64),
}

/// A drawing at its final size.
#[derive(Clone, Debug)]
pub(super) struct Outline {
    /// The rings that the body is made of.
    pub(super) rings: Vec<Ring>,
    pub(super) inside: Inside,
    /// The drawing that the body carries for pictures.
    pub(super) painted: Vec<Painted>,
}

impl Outline {
    /// The approximate number of nodes of the body.
    pub(super) fn node_count(&self) -> f64 {
        match self.inside {
            Inside::Nothing => self.rings.iter().map(|ring| ring.points.len() as f64).sum(),
            Inside::Triangles(spacing) => outline::node_estimate(&self.rings, spacing),
            Inside::Squares(spacing) => outline::squares_estimate(&self.rings, spacing),
        }
    }

    /// Makes the body with the drawing that it carries; also reports triangles that are thinner than promised.
    ///
    /// # Errors
    /// The errors of the filling.
    pub(super) fn mesh(&self) -> Result<(Mesh<2>, Option<SceneError>), SceneError> {
        let too_many = |e: MeshError| refused(&e.into());
        let (mut mesh, thin) = match self.inside {
            Inside::Nothing => (outline::skin(&self.rings).map_err(too_many)?, None),
            Inside::Triangles(spacing) => outline::filled(&self.rings, spacing).map_err(|e| refused(&e))?,
            Inside::Squares(spacing) => (outline::squares(&self.rings, spacing).map_err(|e| refused(&e))?, None),
        };
        let thin = thin.map(|thin| loss_notices::thin(&mesh, &thin));
        if !self.painted.is_empty() {
            outline::carry(&mut mesh, &self.rings, &self.painted).map_err(|e| refused(&e))?;
        }
        Ok((mesh, thin))
    }
}

/// Applies the size, spacing, and treatment of overlaps and holes that the scene asks for.
pub(super) fn loaded(mut drawing: Drawing<'_>, shape: &Values) -> Result<Loaded, Problem> {
    let spacing = shape.number("spacing").unwrap_or(1.0);
    let size = shape.number("size").unwrap_or(1.0);
    let extent = drawing.curves.extent();
    if !(extent > 0.0 && extent.is_finite() && extent > 1e-150 && extent < 1e150) {
        return Err(SceneError::of(ShapeError::NoOutline { extent: format!("{extent:e}") }).into());
    }
    OUTLINES.check(drawing.curves.closed() as u64)?;
    let tolerance = TOLERANCE * spacing * extent / size;
    let points = drawing.curves.flat_points(tolerance, POINTS.most);
    let larger_spacing = || ShapeHint::LargerSpacing { spacing: Setting::named("spacing") };
    POINTS.check(points).map_err(|e| Problem::new("spacing", e.advice(larger_spacing())))?;
    let mut rings = drawing.curves.flatten(tolerance);
    drawing.notices.extend(rules::follow(&mut rings, &drawing.rules));
    let mut painted = painted(&drawing.painted, &rings);

    // Strokes and points enclose nothing.
    let before = rings.len();
    rings.retain(|ring| encloses_more(ring, 1e-12 * extent * extent));
    if rings.len() < before {
        let count = before - rings.len();
        drawing.notices.push(SceneError::of(ShapeNotice::LeftOut { count }));
    }
    let how = match shape.text("overlap") {
        Some("union") => Some(Overlap::Union),
        Some("even_odd") => Some(Overlap::EvenOdd),
        _ => None,
    };
    if let Some(how) = how {
        let together = outline::joined(&rings, how);
        // Coloured parts remain visible, one above the other.
        drawing.notices.extend(overlap_notice(&rings, &together, how).filter(|_| painted.is_empty()));
        rings = together;
    }
    // This removes remnants of borders that nearly coincide.
    rings.retain(|ring| ring.area().abs() > 1e-12 * extent * extent || shape.text("overlap") == Some("refuse"));
    let mut rings = scale_and_center(rings, &mut painted, &drawing, shape)?;
    if how.is_none()
        && !drawing.rules.is_empty()
        && let Some((part, notice)) = loss_notices::nested(&rings)
    {
        let notice = drawing.at(part, notice);
        drawing.notices.push(notice);
    }

    let least = shape.number("drop_below").unwrap_or(0.0);
    let before = rings.len();
    rings.retain(|ring| ring.area().abs() >= least);
    if rings.len() < before {
        let count = before - rings.len();
        drawing.notices.push(SceneError::of(ShapeNotice::Dropped { count, outlines: before, least }));
    }
    if rings.is_empty() {
        let error = SceneError::of(ShapeError::NoneLeft { least });
        return Err(Problem::new(if before > 0 { "drop_below" } else { "file" }, error));
    }
    let inside = match shape.text("filling") {
        Some("triangles") => Inside::Triangles(spacing),
        Some("lattice") => {
            // The squares carry the outline itself at full resolution; its points need not be nodes.
            painted.insert(0, Painted { rings: rings.clone(), colour: None });
            let outline = Outline { rings, inside: Inside::Squares(spacing), painted };
            return Ok(Loaded { notices: drawing.notices, content: Content::Outline(outline) });
        }
        _ => Inside::Nothing,
    };
    too_fine(&rings, spacing, inside)?;
    // The points of a contour of a picture, or of a font, were not drawn by the user.
    let given = if drawing.source.is_some() { drawing.curves.points() } else { 0 };
    let before = rings;
    let rings = outline::resampled(&before, spacing).map_err(|e| {
        let [nearer, size, drop_below] = ["spacing", "size", "drop_below"].map(Setting::named);
        let hint = ShapeHint::FinerOutline { spacing: nearer, size, drop_below, lattice: settings::lattice() };
        Problem::new("spacing", refused(&e).value(spacing.to_string()).advice(hint))
    })?;
    drawing.notices.extend(loss_notices::thinned(given, &before, &rings, spacing));
    let outline = Outline { rings, inside, painted };
    Ok(Loaded { notices: drawing.notices, content: Content::Outline(outline) })
}

/// Refuses a spacing that would give the body more nodes than allowed, before they are made.
fn too_fine(rings: &[Ring], spacing: f64, inside: Inside) -> Result<(), Problem> {
    let length: f64 = rings.iter().map(Ring::length).sum();
    let area = match inside {
        Inside::Triangles(_) => rings.iter().map(Ring::area).sum::<f64>().abs(),
        _ => 0.0,
    };
    // One node for every two equilateral triangles, and one for every piece of the outline.
    let (most, each) = (MAXIMUM_NODES as f64, 0.75f64.sqrt());
    let nodes = length / spacing + area / (each * spacing * spacing);
    if nodes <= most {
        return Ok(());
    }
    let least = (length + (length * length + 4.0 * most * area / each).sqrt()) / (2.0 * most);
    let (nodes, least) = (shown(nodes), rounded(least, 3));
    let error = SceneError::of(ShapeError::TooFineOutline { spacing, nodes, least, most: MAXIMUM_NODES });
    Err(Problem::new("spacing", error))
}

/// Whether a ring encloses more than a given area. The halves of a figure of eight are added, although their signed areas
/// cancel.
fn encloses_more(ring: &Ring, least: f64) -> bool {
    let whole = |ring: &Ring| ring.area().abs();
    let halves = || outline::joined(core::slice::from_ref(ring), Overlap::EvenOdd).iter().map(whole).sum::<f64>();
    ring.points.len() > 2 && (whole(ring) > least || halves() > least)
}

/// Reports how many outlines have changed because they cross, touch or cover one another.
fn overlap_notice(rings: &[Ring], together: &[Ring], how: Overlap) -> Option<SceneError> {
    let (count, left) = (changed(rings, together), together.len());
    let notice = match how {
        Overlap::Union => ShapeNotice::Union { count, left, overlap: settings::union() },
        Overlap::EvenOdd => ShapeNotice::EvenOdd { count, left, overlap: settings::parity() },
    };
    (count > 0).then(|| SceneError::of(notice))
}

/// The number of rings that the union does not contain: no ring in it has the same area and the same box.
fn changed(rings: &[Ring], together: &[Ring]) -> usize {
    let Some((low, high)) = outline::bounds(rings) else { return 0 };
    let extent = larger(high[0] - low[0], high[1] - low[1]);
    // Joining rounds coordinates to a grid of 2⁻³⁰ of the extent.
    let tolerance = 1e-7 * extent;
    let mut kept: Vec<(f64, &Ring)> = together.iter().map(|ring| (ring.area().abs(), ring)).collect();
    kept.sort_by(|a, b| a.0.total_cmp(&b.0));
    let same_box = |a: &Ring, b: &Ring| {
        let corners = |ring: &Ring| outline::bounds(core::slice::from_ref(ring)).unwrap_or_default();
        let ((a, b), (c, d)) = (corners(a), corners(b));
        (0..2).all(|axis| (a[axis] - c[axis]).abs() <= tolerance && (b[axis] - d[axis]).abs() <= tolerance)
    };
    let is_kept = |ring: &Ring| {
        let (area, off) = (ring.area().abs(), tolerance * extent);
        let first = kept.partition_point(|(other, _)| *other < area - off);
        kept[first..].iter().take_while(|(other, _)| *other <= area + off).any(|(_, other)| same_box(ring, other))
    };
    rings.iter().filter(|ring| !is_kept(ring)).count()
}

/// The coloured parts of a drawing, in painting order.
fn painted(colours: &[Option<[u8; 4]>], rings: &[Ring]) -> Vec<Painted> {
    let mut all: Vec<Painted> = colours.iter().map(|c| Painted { rings: Vec::new(), colour: *c }).collect();
    for ring in rings {
        if let Some(part) = all.get_mut(ring.part as usize) {
            part.rings.push(ring.clone());
        }
    }
    all.retain(|part| part.colour.is_some() && !part.rings.is_empty());
    all
}

/// Gives holes the opposite orientation, and scales and moves the drawing.
fn scale_and_center(
    mut rings: Vec<Ring>,
    painted: &mut [Painted],
    drawing: &Drawing<'_>,
    shape: &Values,
) -> Result<Vec<Ring>, Problem> {
    outline::nest(&mut rings).map_err(|e| match &e {
        OutlineError::Meeting { parts, .. } if shape.text("overlap") == Some("refuse") => Problem::from(drawing.at(
            parts[1],
            refused(&e).advice(ShapeHint::Overlap { union: settings::union(), parity: settings::parity() }),
        )),
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
    for ring in rings.iter_mut().chain(painted.iter_mut().flat_map(|area| &mut area.rings)) {
        for point in &mut ring.points {
            *point = [center[0] + factor * (point[0] - middle[0]), center[1] + up * (point[1] - middle[1])];
        }
        if drawing.y_down {
            ring.points.reverse();
        }
    }
    Ok(rings)
}

/// Converts an error of outlines to an error of the scene.
pub(super) fn refused(error: &OutlineError) -> SceneError {
    SceneError::of(error.clone())
}
