//! The filling of a closed surface, and the part of its volume that the filling keeps.

use opruga_core::spec::Values;
use opruga_mesh::{Mesh, MeshError};

/// The relative loss of an area or a volume above which it is reported.
pub const REPORTED_LOSS: f64 = 0.05;
/// The relative loss or gain of volume above which a filling is refused.
const REFUSED: f64 = 0.25;
/// The ratio between successive spacings that are tried for a hint, and their number.
const FINER: (f64, usize) = (0.85, 6);
/// The maximum number of nodes of a filling that is tried for a hint: finding the hint should not take much longer than building the body.
const LARGEST_TRIED: f64 = 10_000.0;

/// The filling of a closed surface: its method, and the side of its cubes [m].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filling {
    /// Equal tetrahedra that extend slightly beyond the surface and carry it as a skin.
    Lattice(f64),
    /// Tetrahedra whose boundary follows the surface.
    Tetrahedra(f64),
}

/// The volume of a surface that its filling lacks, because the filling cuts off edges and omits thin parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loss {
    /// The volume of the filling divided by the volume of the surface.
    pub kept: f64,
    /// A spacing that keeps the volume within [`REPORTED_LOSS`], if one was found.
    pub finer: Option<f64>,
}

impl Filling {
    /// The filled body, and its loss of volume if that is more than [`REPORTED_LOSS`].
    ///
    /// # Errors
    /// The errors of [`Mesh::lattice_filling`] and [`Mesh::tetrahedra_filling`]. Also [`MeshError::Lost`] for tetrahedra that lose more than a
    /// quarter of the volume.
    pub fn of(self, surface: &Mesh<3>) -> Result<(Mesh<3>, Option<Loss>), MeshError> {
        let spacing = match self {
            // This filling extends beyond the surface, and carries the surface unchanged.
            Filling::Lattice(spacing) => return Ok((surface.lattice_filling(spacing)?, None)),
            Filling::Tetrahedra(spacing) => spacing,
        };
        let mesh = surface.tetrahedra_filling(spacing)?;
        let kept = kept(&mesh, surface);
        if (kept - 1.0).abs() <= REPORTED_LOSS {
            return Ok((mesh, None));
        }
        let finer = finer(surface, spacing, kept);
        if (kept - 1.0).abs() > REFUSED {
            return Err(MeshError::Lost { spacing, kept, finer });
        }
        Ok((mesh, Some(Loss { kept, finer })))
    }

    /// Side of the cubes [m].
    pub fn spacing(self) -> f64 {
        match self {
            Filling::Lattice(spacing) | Filling::Tetrahedra(spacing) => spacing,
        }
    }
}

fn kept(filling: &Mesh<3>, surface: &Mesh<3>) -> f64 {
    filling.enclosed_volume() / surface.enclosed_volume()
}

/// Returns a spacing with two significant digits at which the filling keeps the volume. The loss falls with the square of the spacing, which gives
/// the first spacing to try.
fn finer(surface: &Mesh<3>, spacing: f64, now: f64) -> Option<f64> {
    let (step, most) = FINER;
    let square = (REPORTED_LOSS / (now - 1.0).abs()).sqrt();
    let mut next = spacing * if square < step { square } else { step };
    for _ in 0..most {
        // The number as it will be printed.
        let shown: f64 = format!("{next:.1e}").parse().ok()?;
        if surface.lattice_estimate(shown) > LARGEST_TRIED {
            return None;
        }
        let works = |made: &Mesh<3>| (kept(made, surface) - 1.0).abs() <= REPORTED_LOSS;
        if surface.tetrahedra_filling(shown).is_ok_and(|made| works(&made)) {
            return Some(shown);
        }
        next *= step;
    }
    None
}

/// The filling that a shape in space requests.
///
/// # Errors
/// [`MeshError::NoSpacing`] for a filling without `spacing`.
pub fn filling(shape: &Values) -> Result<Option<Filling>, MeshError> {
    let make = match shape.text("filling") {
        Some("lattice") => Filling::Lattice,
        Some("tetrahedra") => Filling::Tetrahedra,
        _ => return Ok(None),
    };
    shape.number("spacing").map(|spacing| Some(make(spacing))).ok_or(MeshError::NoSpacing {})
}
