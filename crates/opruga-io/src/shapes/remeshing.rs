//! Remeshes surfaces of files with triangles of a desired size; if that size is not suitable, finds a suitable one.

use super::errors::{ShapeError, ShapeHint};
use crate::problem::SceneError;
use opruga_math::message::Setting;
use opruga_math::words::number;
use opruga_mesh::Mesh;
use opruga_mesh::outline::OutlineError;

/// The largest relative change of the volume of a remeshed surface.
const DRIFT: f64 = 0.25;
/// If the desired length is too coarse, shorter lengths are tried; each is this fraction of the previous length.
const SHORTER: f64 = 0.9;
/// The largest number of lengths that are tried.
const TRIED: usize = 30;
/// The largest number of nodes of a surface for which a length is tried, so that the search does not take longer than making the body would.
const LARGEST_TRIED: f64 = 20_000.0;

/// Why a length is refused.
enum TooCoarse {
    /// Triangles would intersect others that are not their neighbours.
    Crosses,
    /// Only this fraction of the volume would remain.
    Encloses(f64),
}

/// Remeshes the surface with edges of a desired length.
///
/// # Errors
/// `scene.shape` for a length that makes too many nodes, or so few that the surface would cross itself or lose its shape. The hint gives the largest
/// length that works, found by trying shorter lengths in steps of a tenth.
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

/// Returns the surface with edges of a given length, or the reason why this length is too coarse for the surface.
fn made(mesh: &Mesh<3>, length: f64) -> Result<Result<Mesh<3>, TooCoarse>, opruga_mesh::MeshError> {
    let made = mesh.remeshed(length)?;
    // A surface that was accepted although it crosses itself may still do so.
    if !made.crossing_facets().pairs.is_empty() && mesh.crossing_facets().pairs.is_empty() {
        return Ok(Err(TooCoarse::Crosses));
    }
    // Parts that are thinner than their edges shrink with them.
    let kept = made.enclosed_volume() / mesh.enclosed_volume();
    Ok(if (kept - 1.0).abs() > DRIFT { Err(TooCoarse::Encloses(kept)) } else { Ok(made) })
}

/// Tries shorter and shorter lengths, each rounded to two digits, and returns the first one that works. If none works, the error is the shortest
/// length that was tried. Coarse surfaces are made quickly, so all attempts together take little longer than the last one.
fn coarsest(mesh: &Mesh<3>, length: f64) -> Result<f64, f64> {
    let (mut tried, mut next) = (length, length);
    for _ in 0..TRIED {
        next *= SHORTER;
        // The length is rounded as it will be written.
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
