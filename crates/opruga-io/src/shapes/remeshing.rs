//! Surfaces of files made anew of triangles of a wanted size, and which size would do where that does not.

use super::errors::{ShapeError, ShapeHint};
use crate::problem::SceneError;
use opruga_math::message::Setting;
use opruga_math::words::number;
use opruga_mesh::Mesh;
use opruga_mesh::outline::OutlineError;

/// A surface that is remeshed may lose or win this part of its volume.
const DRIFT: f64 = 0.25;
/// Lengths that are tried where the wanted one is too coarse, each this part of the one before.
const SHORTER: f64 = 0.9;
/// The most lengths that are tried.
const TRIED: usize = 30;
/// The most nodes that a surface may have for which a length is tried: an answer shall not take longer than the body.
const LARGEST_TRIED: f64 = 20_000.0;

/// Why a length is refused.
enum TooCoarse {
    /// Triangles would meet others that are not their neighbours.
    Crosses,
    /// So much of the volume would be left.
    Encloses(f64),
}

/// The surface with edges of a wanted length.
///
/// # Errors
/// `scene.shape` for a length that makes too many nodes, or so few that the surface would cross itself or lose its shape; the
/// hint has the largest of the lengths below it, in steps of a tenth, that was tried and works.
pub(super) fn remeshed(mesh: &Mesh<3>, length: f64) -> Result<Mesh<3>, SceneError> {
    let refuse = |error| SceneError::of(OutlineError::Mesh { error }).value(length.to_string());
    let error = match made(mesh, length).map_err(refuse)? {
        Ok(made) => return Ok(made),
        Err(TooCoarse::Crosses) => ShapeError::RemeshCrosses { length },
        Err(TooCoarse::Encloses(part)) => {
            ShapeError::RemeshEncloses { length, part: format!("{part:.2}"), percent: 100.0 * DRIFT }
        }
    };
    Err(SceneError::of(error).advice(match coarsest(mesh, length) {
        Ok(length) => ShapeHint::RemeshWorks { remesh: Setting::with("remesh", number(length)) },
        Err(length) => ShapeHint::NoRemeshWorks { remesh: Setting::named("remesh"), length },
    }))
}

/// The surface with edges of a length, or why that is too coarse for it.
fn made(mesh: &Mesh<3>, length: f64) -> Result<Result<Mesh<3>, TooCoarse>, opruga_mesh::MeshError> {
    let made = mesh.remeshed(length)?;
    // One that was taken as it is may go on crossing itself.
    if !made.crossing_facets().pairs.is_empty() && mesh.crossing_facets().pairs.is_empty() {
        return Ok(Err(TooCoarse::Crosses));
    }
    // What is thinner than its edges shrinks with them.
    let kept = made.enclosed_volume() / mesh.enclosed_volume();
    Ok(if (kept - 1.0).abs() > DRIFT { Err(TooCoarse::Encloses(kept)) } else { Ok(made) })
}

/// The first of ever shorter lengths that works, each of two digits; or the shortest that was tried. Coarse surfaces are quickly
/// made, so that all of them together take little longer than the last one.
fn coarsest(mesh: &Mesh<3>, length: f64) -> Result<f64, f64> {
    let (mut tried, mut next) = (length, length);
    for _ in 0..TRIED {
        next *= SHORTER;
        // As it will be written.
        let shown = format!("{next:.1e}").parse().unwrap_or(next);
        if shown >= tried {
            continue;
        }
        if mesh.remesh_estimate(shown) > LARGEST_TRIED {
            break;
        }
        tried = shown;
        if matches!(made(mesh, shown), Ok(Ok(_))) {
            return Ok(shown);
        }
    }
    Err(tried)
}
