//! Shapes from files: drawings become outlines, and outlines become bodies.
//!
//! ```text
//! svg, map, text, bitmap ──→ curves ──drawing──→ rings at the wanted size and spacing ──┐
//! obj, stl, ply, gltf ─────→ triangles ──→ welded, checked, turned outward, sized ───────┼→ mesh
//! msh, vtk, vtu, mesh, ele → elements ───→ checked ──────────────────────────────────────┘
//! ```
//! Every reader reports errors with the line or byte of its file. Nothing is repaired unless the scene asks for it; repairs are counted.

mod bitmap;
mod composite;
mod curves;
mod drawing;
mod drawing_errors;
mod entities;
mod errors;
mod glb;
mod globe;
mod gltf;
mod gltf_errors;
mod gltf_json;
mod json;
pub(crate) mod loss_notices;
mod map;
mod obj;
mod ply;
mod remeshing;
mod rules;
mod settings;
mod stl;
mod surface_errors;
mod svg;
mod svg_clip;
mod svg_elements;
mod svg_fill;
mod svg_index;
mod svg_outlines;
mod svg_path;
mod svg_sheets;
mod svg_style;
mod svg_units;
mod svg_viewport;
mod svg_xml;
mod text;
mod triangles;
mod volume;

use crate::files::Files;
use crate::limits::Limits;
use crate::meshes;
use crate::problem::{SceneError, visible};
use crate::scene::Cost;
use crate::source::Source;
use errors::ShapeError;
use opruga_core::spec::Values;
use opruga_mesh::outline::OutlineError;
use opruga_mesh::{Mesh, MeshError};
use opruga_world::shapes::{self, Filling, Transform};
use std::any::Any;
use std::sync::Arc;

/// All messages about shapes from files.
pub(crate) const MESSAGES: &[&[opruga_math::message::Variant]] = &[
    errors::Change::VARIANTS,
    errors::ThinCause::VARIANTS,
    errors::ShapeHint::VARIANTS,
    errors::ShapeError::VARIANTS,
    errors::ShapeNotice::VARIANTS,
    surface_errors::FaceProblem::VARIANTS,
    surface_errors::SurfaceError::VARIANTS,
    surface_errors::SurfaceNotice::VARIANTS,
    surface_errors::ObjError::VARIANTS,
    surface_errors::ObjNotice::VARIANTS,
    surface_errors::PlyError::VARIANTS,
    surface_errors::PlyNotice::VARIANTS,
    surface_errors::StlError::VARIANTS,
    surface_errors::StlNotice::VARIANTS,
    gltf_errors::Sized::VARIANTS,
    gltf_errors::GltfError::VARIANTS,
    gltf_errors::GltfNotice::VARIANTS,
    drawing_errors::SvgError::VARIANTS,
    drawing_errors::SvgNotice::VARIANTS,
    drawing_errors::MapError::VARIANTS,
    drawing_errors::MapNotice::VARIANTS,
    drawing_errors::LetterError::VARIANTS,
];

/// Returns the bytes of a file by the name that the scene uses.
type Open<'o> = dyn FnMut(&str) -> Result<Arc<[u8]>, SceneError> + 'o;

/// The contents of a shape's file, checked, before a mesh is made from it.
#[derive(Clone, Debug)]
pub(crate) struct Loaded {
    /// Notices about the file, with counts.
    pub(crate) notices: Vec<SceneError>,
    content: Content,
}

#[derive(Clone, Debug)]
enum Content {
    /// A drawing.
    Outline(drawing::Outline),
    /// A surface at its final size, the edge length to which it is remeshed, and its filling.
    Surface { mesh: Box<Mesh<3>>, remesh: Option<f64>, filling: Option<Filling> },
    /// Cells in the plane.
    Plane(Box<Mesh<2>>),
    /// Cells in space.
    Space(Box<Mesh<3>>),
}

/// Why a shape's file is refused.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// The field of the shape at fault, if the error has no location in the file itself.
    pub field: &'static str,
    /// What is wrong.
    pub about: SceneError,
}

impl Problem {
    fn new(field: &'static str, about: SceneError) -> Problem {
        Problem { field, about }
    }
}

/// A problem in the file.
impl From<SceneError> for Problem {
    fn from(about: SceneError) -> Problem {
        Problem { field: "file", about }
    }
}

/// Reads the file of a shape for a scene of 2 or 3 dimensions; `open` returns the bytes of a file by the name that the scene uses.
///
/// # Errors
/// The first error that is found, with its location in the file.
pub(crate) fn load(shape: &Values, dimension: usize, open: &mut Open<'_>) -> Result<Loaded, Problem> {
    let name = shape.text("file").unwrap_or("").to_string();
    let bytes = open(&name)?;
    match shape.kind() {
        "svg" => {
            let source = text_of(&name, &bytes)?;
            drawing::loaded(svg::read(&source, shape.text("path"), shape.flag("colours"))?, shape)
        }
        "map" => {
            let source = text_of(&name, &bytes)?;
            drawing::loaded(map::read(&source, shape)?, shape)
        }
        "text" => drawing::loaded(text::read(&name, &bytes, shape)?, shape),
        "bitmap" => {
            let read = bitmap::read(&bytes, shape).map_err(|e| SceneError { file: name.clone(), ..e })?;
            drawing::loaded(read, shape)
        }
        "mesh" => volume::loaded(&name, &bytes, shape, dimension, open),
        "surface" => surface(&name, &bytes, shape, open),
        kind => Err(SceneError::of(ShapeError::ReadsNoFile { kind: kind.into() }).into()),
    }
}

/// Makes the body that a scene would make from a shape's file, independently of any scene. Also returns notices about the file, with counts. The
/// names of the files that were read are added to `named`.
///
/// # Errors
/// The first error that is found, with its location in the file, or the field of the shape that it is about.
pub fn body<const D: usize>(
    shape: &Values,
    files: &Files,
    limits: &Limits,
    named: &mut Vec<String>,
) -> Result<(Mesh<D>, Vec<SceneError>), Problem> {
    let loaded = load(shape, D, &mut |name| {
        named.push(name.to_string());
        files.read(name, limits.shape_bytes)
    })?;
    let dense = if shape.get("spacing").is_some() { "spacing" } else { "file" };
    let cost = Cost::default().add::<D>(1.0, loaded.node_count(), 0.0, limits);
    cost.map_err(|error| Problem::new(dense, SceneError::of(error.of_mesh())))?;
    let (mesh, made) =
        loaded.mesh::<D>(&Transform { scale: 1.0, rotation: &[] }).map_err(|about| Problem::new(dense, about))?;
    Ok((mesh, [loaded.notices, made].concat()))
}

/// The kind of shape for a file of this name; none if the name does not determine it.
pub fn kind_of_file(name: &str) -> Option<&'static str> {
    match name.rsplit_once('.')?.1.to_ascii_lowercase().as_str() {
        "svg" => Some("svg"),
        "geojson" | "topojson" => Some("map"),
        "png" => Some("bitmap"),
        "ttf" | "otf" => Some("text"),
        "obj" | "stl" | "ply" | "gltf" | "glb" => Some("surface"),
        _ => meshes::is_mesh(name).then_some("mesh"),
    }
}

/// Reads a surface; the format is determined by the contents or, failing that, by the ending.
fn surface(name: &str, bytes: &[u8], shape: &Values, open: &mut Open<'_>) -> Result<Loaded, Problem> {
    let ending = name.rsplit_once('.').map_or("", |(_, ending)| ending).to_ascii_lowercase();
    let text = || text_of(name, bytes);
    let named = |error: SceneError| SceneError { file: name.to_string(), ..error };
    match ending.as_str() {
        "obj" => {
            let source = text()?;
            triangles::loaded(obj::read(&source)?, name, Some(&source), shape)
        }
        "stl" if stl::is_binary(bytes) => triangles::loaded(stl::read_binary(bytes).map_err(named)?, name, None, shape),
        "stl" => {
            let source = text()?;
            triangles::loaded(stl::read_text(&source)?, name, Some(&source), shape)
        }
        "ply" => {
            let found = ply::read(name, bytes)?;
            // Only text files have lines.
            let source = core::str::from_utf8(bytes).ok().map(|text| Source { file: name, text });
            triangles::loaded(found, name, source.as_ref(), shape)
        }
        "gltf" | "glb" => {
            let (json, binary) = glb::chunks(name, bytes)?;
            let source = text_of(name, json)?;
            triangles::loaded(gltf::read(&source, binary, open)?, name, Some(&source), shape)
        }
        _ if meshes::is_mesh(name) => triangles::loaded(volume::surface(name, bytes, open)?, name, None, shape),
        _ => {
            let error = SceneError::of(ShapeError::Ending { ending: visible(&ending), others: meshes::ENDINGS });
            Err(error.value(visible(name)).into())
        }
    }
}

/// The text of a file.
fn text_of<'a>(name: &'a str, bytes: &'a [u8]) -> Result<Source<'a>, SceneError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    match core::str::from_utf8(bytes) {
        Ok(text) => Ok(Source { file: name, text }),
        Err(e) => {
            let good = core::str::from_utf8(&bytes[..e.valid_up_to()]).unwrap_or("");
            let byte = bytes.get(good.len()).copied().unwrap_or(0);
            let error = SceneError::of(ShapeError::Encoding { byte: format!("0x{byte:02x}") });
            Err(Source { file: name, text: good }.mark(error, good.len(), good.len()))
        }
    }
}

impl Loaded {
    /// The approximate number of nodes of the body.
    pub(crate) fn node_count(&self) -> f64 {
        match &self.content {
            Content::Outline(outline) => outline.node_count(),
            Content::Surface { mesh, filling: Some(filling), .. } => mesh.lattice_estimate(filling.spacing()),
            Content::Surface { mesh, remesh: Some(length), .. } => mesh.remesh_estimate(*length),
            Content::Surface { mesh, .. } | Content::Space(mesh) => mesh.nodes() as f64,
            Content::Plane(mesh) => mesh.nodes() as f64,
        }
    }

    /// Makes the mesh, scaled and rotated; also returns what was lost, with counts.
    ///
    /// # Errors
    /// The errors of the filling.
    pub(crate) fn mesh<const D: usize>(
        &self,
        transform: &Transform<'_>,
    ) -> Result<(Mesh<D>, Vec<SceneError>), SceneError> {
        let refuse = |error: MeshError| SceneError::of(OutlineError::Mesh { error });
        let mut notices = Vec::new();
        let made: Box<dyn Any> = match &self.content {
            Content::Outline(outline) => {
                let (mesh, thin) = outline.mesh()?;
                notices.extend(thin);
                Box::new(mesh)
            }
            Content::Surface { mesh, remesh, filling } => {
                let surface = match remesh {
                    None => (**mesh).clone(),
                    Some(length) => {
                        let made = remeshing::remeshed(mesh, *length)?;
                        notices.extend(loss_notices::remeshed(&made, mesh, *length, transform.scale));
                        made
                    }
                };
                Box::new(match filling {
                    None => surface,
                    Some(filling) => {
                        let (body, loss) = filling.of(&surface).map_err(refuse)?;
                        notices.extend(loss.map(|loss| loss_notices::lost_volume(&body, loss, transform.scale)));
                        body
                    }
                })
            }
            Content::Plane(mesh) => mesh.clone(),
            Content::Space(mesh) => mesh.clone(),
        };
        let Ok(mut mesh) = made.downcast::<Mesh<D>>() else {
            return Err(SceneError::of(ShapeError::Dimension { dimension: D }));
        };
        shapes::apply_transform(&mut mesh, transform).map_err(refuse)?;
        Ok((*mesh, notices))
    }
}
