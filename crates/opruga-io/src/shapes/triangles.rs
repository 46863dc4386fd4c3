//! Triangles of a file, from which a closed surface, cloth, or a filled body is made.

use super::curves::larger;
use super::errors::ShapeHint;
use super::surface_errors::{FaceProblem, SurfaceError, SurfaceNotice};
use super::{Content, Loaded, Problem, loss_notices, settings};
use crate::meshes::MeshFileError;
use crate::problem::SceneError;
use crate::rounding::Stored;
use crate::source::Source;
use opruga_core::spec::Values;
use opruga_math::message::Setting;
use opruga_math::words::{number, rounded};
use opruga_mesh::{FaceError, Mesh, MeshError, cut_face};
use opruga_world::shapes;
use std::collections::BTreeMap;

/// Faces with corners farther from their plane than this fraction of their size are reported, because another division would give another surface.
const BENT: f64 = 0.02;
/// A triangle is refused if its area is below this fraction of its longest edge squared.
const THIN: f64 = 1e-10;
/// A triangle is a sliver if its area is below this fraction of its longest edge squared. This fraction corresponds to an angle of a tenth of a
/// degree.
const SLIVER: f64 = 1e-3;
/// Usual extents of surfaces [m].
const USUAL: [f64; 2] = [1e-4, 1e2];
/// If a surface is larger or smaller than usual by more than this factor, another unit does not explain it.
const UNITS: f64 = 1e5;

/// What a reader found.
#[derive(Debug, Default)]
pub(super) struct Triangles {
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// The location of each triangle in the file.
    pub(super) locations: Locations,
    /// Named sets of vertices.
    pub(super) groups: BTreeMap<String, Vec<u32>>,
    /// The rounding in the file, if the positions above are not those in the file.
    pub(super) stored: Option<Stored>,
    /// Whether coordinates have 4 bytes.
    pub(super) single: bool,
    /// Whether the format gives every triangle separate corners.
    pub(super) soup: bool,
    pub(super) notices: Vec<SceneError>,
    pub(super) polygons: Polygons,
}

/// Faces with more than three corners that were divided into triangles.
#[derive(Debug, Default)]
pub(super) struct Polygons {
    count: usize,
    concave: usize,
    bent: usize,
    /// The largest distance of a corner from the plane of its face, as a fraction of the size of the face.
    most_bent: f64,
}

/// The locations of triangles in a file.
#[derive(Debug, Default)]
pub(super) enum Locations {
    /// Only the numbers of the triangles are known.
    #[default]
    Numbers,
    /// The byte of the text at which the line of each triangle begins.
    Lines(Vec<u32>),
    /// The byte at which the first triangle begins, and the size of each triangle [bytes].
    Bytes { first: usize, each: usize },
    /// The byte at which each triangle begins.
    Starts(Vec<u64>),
}

impl Triangles {
    /// The rounding of the numbers in the file.
    fn as_stored(&self) -> Stored {
        Stored::of(&self.positions, self.triangles.iter().map(|triangle| &triangle[..]), self.single)
    }

    /// Adds a polygon as triangles inside it; returns the number of these triangles, or the reason why there are none.
    pub(super) fn polygon(&mut self, corners: &[u32]) -> Result<usize, FaceProblem> {
        if corners.len() < 3 {
            return Err(FaceProblem::Few {});
        }
        if has_twins(corners) {
            return Err(FaceProblem::Twice {});
        }
        if let [a, b, c] = *corners {
            self.triangles.push([a, b, c]);
            return Ok(1);
        }
        let positions: Vec<[f64; 3]> = corners.iter().map(|corner| self.positions[*corner as usize]).collect();
        let cut = cut_face(&positions).map_err(|error| match error {
            FaceError::Crossing => FaceProblem::Crossing {},
            FaceError::Folded(off) => FaceProblem::Bent { off: rounded(off, 2) },
        })?;
        self.polygons.count += 1;
        self.polygons.concave += usize::from(cut.concave);
        self.polygons.bent += usize::from(cut.bent > BENT);
        self.polygons.most_bent = larger(self.polygons.most_bent, cut.bent);
        self.triangles.extend(cut.triangles.iter().map(|triangle| triangle.map(|k| corners[k as usize])));
        Ok(cut.triangles.len())
    }

    /// Reports the polygons that other programs may divide differently.
    fn cut(&self) -> Vec<SceneError> {
        let Polygons { count: faces, concave, bent, most_bent } = self.polygons;
        let concave = (concave > 0).then(|| SceneError::of(SurfaceNotice::Concave { count: concave, faces }));
        let off = rounded(most_bent, 2);
        let bent = (bent > 0).then(|| SceneError::of(SurfaceNotice::BentFaces { count: bent, faces, off }));
        concave.into_iter().chain(bent).collect()
    }

    /// An error at a triangle.
    fn at(&self, source: Option<&Source<'_>>, triangle: u32, error: SceneError) -> SceneError {
        match (&self.locations, source) {
            (Locations::Lines(lines), Some(source)) => match lines.get(triangle as usize) {
                Some(from) => {
                    let from = *from as usize;
                    let end = source.text[from..].find('\n').map_or(source.text.len(), |k| from + k);
                    source.mark(error, from, end)
                }
                None => error,
            },
            (Locations::Bytes { first, each }, _) => at_byte(error, (first + each * triangle as usize) as u64),
            (Locations::Starts(starts), _) => match starts.get(triangle as usize) {
                Some(byte) => at_byte(error, *byte),
                None => error,
            },
            _ => error,
        }
    }
}

/// Whether an index occurs twice.
fn has_twins(corners: &[u32]) -> bool {
    if corners.len() <= 16 {
        return corners.iter().enumerate().any(|(k, corner)| corners[..k].contains(corner));
    }
    let mut sorted = corners.to_vec();
    sorted.sort_unstable();
    sorted.windows(2).any(|pair| pair[0] == pair[1])
}

fn at_byte(error: SceneError, byte: u64) -> SceneError {
    SceneError { byte: usize::try_from(byte).ok(), ..error }
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    core::array::from_fn(|d| a[d] - b[d])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Applies the welding, checks, orientation, size and filling that the scene asks for.
pub(super) fn loaded(
    mut found: Triangles,
    file: &str,
    source: Option<&Source<'_>>,
    shape: &Values,
) -> Result<Loaded, Problem> {
    let named = |error: SceneError| Problem::from(SceneError { file: file.to_string(), ..error });
    if found.triangles.is_empty() {
        return Err(named(SceneError::of(SurfaceError::NoTriangles {})));
    }
    let stored = found.stored.unwrap_or_else(|| found.as_stored());
    let mut notices = std::mem::take(&mut found.notices);
    notices.extend(stored.warning().map_err(named)?);
    notices.extend(found.cut());
    weld(&mut found, source, shape, &mut notices).map_err(named)?;
    let given = found.triangles.len();
    let mut mesh = Mesh::<3> {
        positions: std::mem::take(&mut found.positions),
        facets: std::mem::take(&mut found.triangles),
        groups: std::mem::take(&mut found.groups),
        ..Mesh::default()
    };
    mesh.validate().map_err(|problem| named(SceneError::of(SurfaceError::Index { problem })))?;
    if let Some([first, second]) = mesh.duplicate_facets() {
        let error = SceneError::of(SurfaceError::SameCorners { first, second });
        return Err(named(found.at(source, second, error)));
    }
    if let Some((facet, area)) = mesh.thin_facet(THIN) {
        let (area, least) = (format!("{area:e}"), format!("{THIN:e}"));
        let error = SceneError::of(SurfaceError::NoArea { triangle: facet, area, least });
        return Err(named(found.at(source, facet, error)));
    }
    notices.extend(slivers(&mesh));
    let unused = mesh.drop_unreferenced();
    if unused > 0 {
        notices.push(SceneError::of(SurfaceNotice::UnreferencedVertices { count: unused }));
    }
    orient(&mut mesh, &found, source, shape, &mut notices).map_err(named)?;
    if !mesh.facets.is_empty() {
        let of_file = |facet: &u32| (*facet as usize) < given;
        compare(&mesh, &found, of_file, source, shape, &mut notices).map_err(named)?;
    }
    if shape.number("size").is_none() {
        notices.extend(unusual_scale(&mesh));
    }
    scale_and_center(&mut mesh, shape).map_err(named)?;
    let filling = match shapes::filling(shape) {
        Ok(Some(_)) if mesh.facets.is_empty() => {
            let filling = shape.text("filling").unwrap_or("").to_string();
            return Err(Problem::new(
                "filling",
                SceneError::of(SurfaceError::NothingToFill { filling, cap: settings::cap() }),
            ));
        }
        Ok(filling) => filling,
        Err(problem) => return Err(Problem::new("filling", SceneError::of(SurfaceError::Filling { problem }))),
    };
    let remesh = shape.number("remesh");
    if remesh.is_some() && mesh.facets.is_empty() {
        return Err(Problem::new("remesh", SceneError::of(SurfaceError::NotRemeshed { cap: settings::cap() })));
    }
    Ok(Loaded { notices, content: Content::Surface { mesh: Box::new(mesh), remesh, filling } })
}

/// Reports the number of triangles that are so thin that springs and bending along them need short time steps; also reports the thinnest of them.
fn slivers(mesh: &Mesh<3>) -> Option<SceneError> {
    let thinness = |facet: &[u32; 3]| {
        let [a, b, c] = facet.map(|node| mesh.positions[node as usize]);
        let normal = cross(minus(b, a), minus(c, a));
        let longest = [minus(b, a), minus(c, b), minus(a, c)].into_iter().map(|e| dot(e, e)).fold(0.0, larger);
        0.5 * dot(normal, normal).sqrt() / longest
    };
    let (mut count, mut worst) = (0, (f64::INFINITY, 0));
    for (number, facet) in mesh.facets.iter().enumerate() {
        let thinness = thinness(facet);
        count += usize::from(thinness < SLIVER);
        worst = if thinness < worst.0 { (thinness, number) } else { worst };
    }
    let (area, thinnest) = worst;
    let (triangles, least) = (mesh.facets.len(), format!("{SLIVER:e}"));
    (count > 0).then(|| {
        SceneError::of(SurfaceNotice::Slivers {
            count,
            triangles,
            thinnest,
            area,
            least,
            remesh: Setting::named("remesh"),
        })
    })
}

/// Reports a surface whose file is probably not in metres.
fn unusual_scale(mesh: &Mesh<3>) -> Option<SceneError> {
    let (low, high) = mesh.bounds();
    let extent = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, larger);
    if (USUAL[0]..=USUAL[1]).contains(&extent) {
        return None;
    }
    let [least, most] = USUAL;
    let explained = extent < UNITS * most && extent * UNITS > least;
    let size = Setting::named("size");
    let hint = match (explained, extent > most) {
        (false, _) => ShapeHint::Size { size: size.clone() },
        (true, true) => ShapeHint::Millimetres { scale: Setting::with("scale", "0.001"), size: size.clone() },
        (true, false) => ShapeHint::Kilometres { scale: Setting::with("scale", "1000.0"), size: size.clone() },
    };
    Some(SceneError::of(SurfaceNotice::Scale { extent, least, most, size }).advice(hint))
}

/// Merges vertices if the scene or the format asks for it.
fn weld(
    found: &mut Triangles,
    source: Option<&Source<'_>>,
    shape: &Values,
    notices: &mut Vec<SceneError>,
) -> Result<(), SceneError> {
    let distance = match (shape.number("weld"), found.soup) {
        (Some(distance), _) => distance,
        (None, true) => 0.0,
        (None, false) => return Ok(()),
    };
    let before = found.positions.len();
    let (mut positions, mut triangles) = (found.positions.clone(), found.triangles.clone());
    let joined = match opruga_mesh::weld(&mut positions, &mut triangles, distance) {
        Ok(joined) => joined,
        Err(MeshError::RepeatedNode { index, .. }) => {
            let error =
                SceneError::of(SurfaceError::Joined { triangle: index, distance, weld: Setting::named("weld") });
            return Err(found.at(source, index, error));
        }
        Err(problem) => return Err(SceneError::of(SurfaceError::Weld { problem }).value(distance.to_string())),
    };
    if joined > 0 && !found.groups.is_empty() {
        // The vertices of groups are found by the corners of the triangles.
        let mut number = vec![u32::MAX; before];
        for (old, new) in found.triangles.iter().flatten().zip(triangles.iter().flatten()) {
            number[*old as usize] = *new;
        }
        for nodes in found.groups.values_mut() {
            nodes.iter_mut().for_each(|node| *node = number[*node as usize]);
            nodes.retain(|node| *node != u32::MAX);
            nodes.sort_unstable();
            nodes.dedup();
        }
    }
    // A format that repeats every corner always needs welding.
    if joined > 0 && !found.soup {
        notices.push(SceneError::of(SurfaceNotice::Welded { count: joined, vertices: before }));
    }
    (found.positions, found.triangles) = (positions, triangles);
    Ok(())
}

/// Makes all triangles face outward, and closes open surfaces or keeps them open, as the scene asks.
fn orient(
    mesh: &mut Mesh<3>,
    found: &Triangles,
    source: Option<&Source<'_>>,
    shape: &Values,
    notices: &mut Vec<SceneError>,
) -> Result<(), SceneError> {
    let refuse = |mesh: &Mesh<3>, error: MeshError| refused(mesh, found, source, error);
    let open = shape.text("open").unwrap_or("refuse");
    let mut turned = mesh.orient_components();
    if let (Err(MeshError::Open { .. }), "cap" | "sheet") = (&turned, open) {
        if open == "sheet" {
            let against = mesh.orient_alike().map_err(|e| refuse(mesh, e))?;
            flipped(notices, against);
            mesh.sheets = std::mem::take(&mut mesh.facets);
            return Ok(());
        }
        let closed = mesh.cap().map_err(|e| refuse(mesh, e))?;
        notices.push(SceneError::of(SurfaceNotice::Capped { count: closed }));
        turned = mesh.orient_components();
    }
    let turned = turned.map_err(|e| refuse(mesh, e))?;
    flipped(notices, turned.against);
    if turned.inside_out > 0 {
        notices.push(SceneError::of(SurfaceNotice::InsideOut { count: turned.inside_out }));
    }
    if let Some((facet, volume)) = turned.flat {
        let error = SceneError::of(SurfaceError::Flat { volume: format!("{volume:e}") });
        return Err(found.at(source, facet, error));
    }
    let pinched = mesh.pinched_nodes();
    if let Some(first) = pinched.first() {
        let shown = pinched
            .iter()
            .take(8)
            .map(|node| format!("({})", mesh.positions[*node as usize].map(|x| x.to_string()).join(", ")));
        let positions = shown.collect::<Vec<_>>().join(", ");
        let error = SceneError::of(SurfaceError::Pinched { positions, count: pinched.len() });
        let facet = mesh.facets.iter().position(|facet| facet.contains(first)).unwrap_or(0);
        return Err(found.at(source, facet as u32, error));
    }
    Ok(())
}

/// Refuses, or counts, triangles of a closed surface that intersect others that are not their neighbours.
fn compare(
    mesh: &Mesh<3>,
    found: &Triangles,
    of_file: impl Fn(&u32) -> bool,
    source: Option<&Source<'_>>,
    shape: &Values,
    notices: &mut Vec<SceneError>,
) -> Result<(), SceneError> {
    let crossings = mesh.crossing_facets();
    let count = crossings.pairs.len();
    let Some([first, second]) = crossings.pairs.first().copied() else {
        if !crossings.complete {
            notices.push(SceneError::of(SurfaceNotice::NotCompared {}));
        }
        return Ok(());
    };
    let complete = crossings.complete;
    if shape.text("overlap") == Some("keep") {
        notices.push(SceneError::of(match complete {
            true => SurfaceNotice::Crossings { count },
            false => SurfaceNotice::ManyCrossings { count },
        }));
        return Ok(());
    }
    let middle = |facet: u32| {
        let corners = mesh.facets[facet as usize].map(|node| mesh.positions[node as usize]);
        let mean: [f64; 3] = core::array::from_fn(|d| (corners[0][d] + corners[1][d] + corners[2][d]) / 3.0);
        mean.map(number).join(", ")
    };
    let (first_center, second_center) = (middle(first), middle(second));
    let keep = Setting::with("overlap", "\"keep\"");
    let error = SurfaceError::MeetsItself { first, first_center, second, second_center, count, complete, keep };
    let error = SceneError::of(error);
    // Triangles that close a free boundary do not occur in the file.
    Err(match [second, first].into_iter().find(of_file) {
        Some(facet) => found.at(source, facet, error),
        None => error,
    })
}

/// Reports triangles that were flipped to be consistent with their neighbours.
fn flipped(notices: &mut Vec<SceneError>, count: usize) {
    if count > 0 {
        notices.push(SceneError::of(SurfaceNotice::Against { count }));
    }
}

/// An error in the topology of a surface.
fn refused(mesh: &Mesh<3>, found: &Triangles, source: Option<&Source<'_>>, error: MeshError) -> SceneError {
    let coordinates = |node: u32| mesh.positions[node as usize].map(number).join(", ");
    match error {
        MeshError::Open { loops, nodes } => {
            let positions: Vec<String> = nodes.iter().take(8).map(|n| format!("({})", coordinates(*n))).collect();
            let hint = match loss_notices::seams(mesh) {
                0 => ShapeHint::CapOrSheet { cap: settings::cap(), sheet: settings::sheet() },
                count => ShapeHint::Weld {
                    count,
                    weld: Setting::with("weld", 0),
                    cap: settings::cap(),
                    sheet: settings::sheet(),
                },
            };
            SceneError::of(SurfaceError::Open { loops, positions: positions.join(", ") }).advice(hint)
        }
        MeshError::NonManifoldEdges { edges } => {
            let positions: Vec<String> =
                edges.iter().take(8).map(|[a, b]| format!("({}) – ({})", coordinates(*a), coordinates(*b))).collect();
            SceneError::of(SurfaceError::CrowdedEdges { count: edges.len(), positions: positions.join("; ") })
        }
        MeshError::NonOrientable { facet } => found.at(source, facet, SceneError::of(SurfaceError::OneSided { facet })),
        problem => SceneError::of(MeshFileError::Topology { problem }),
    }
}

/// Rotates, scales and moves the surface.
fn scale_and_center(mesh: &mut Mesh<3>, shape: &Values) -> Result<(), SceneError> {
    if shape.text("up") == Some("z") {
        mesh.positions.iter_mut().for_each(|p| *p = [p[0], p[2], -p[1]]);
    }
    let (low, high) = mesh.bounds();
    let extent = (0..3).map(|d| high[d] - low[d]).fold(0.0, larger);
    if !(extent > 1e-150 && extent < 1e150) {
        return Err(SceneError::of(SurfaceError::Extent { extent: format!("{extent:e}") }));
    }
    let factor = shape.number("size").map_or(1.0, |size| size / extent);
    let center: [f64; 3] = shape.vector("center");
    for position in &mut mesh.positions {
        *position = core::array::from_fn(|d| center[d] + factor * (position[d] - 0.5 * (low[d] + high[d])));
    }
    Ok(())
}
