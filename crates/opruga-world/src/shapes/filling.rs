//! What fills a closed surface, and how much of its volume that has.

use opruga_core::spec::Values;
use opruga_mesh::{Mesh, MeshError};

/// A loss of this part of an area or a volume is reported.
pub const REPORTED_LOSS: f64 = 0.05;
/// A filling that loses or wins more than this part of the volume is refused.
const REFUSED: f64 = 0.25;
/// Spacings that are tried for a hint, each this part of the one before, and how many.
const FINER: (f64, usize) = (0.85, 6);
/// The most nodes that a filling may have that is tried for a hint: an answer shall not take much longer than the body.
const LARGEST_TRIED: f64 = 10_000.0;

/// What fills a closed surface: how, and with cubes of which side [m].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filling {
    /// Equal tetrahedra that reach a little beyond the surface and carry it as a skin.
    Lattice(f64),
    /// Tetrahedra whose boundary follows the surface.
    Tetrahedra(f64),
}

/// What of the volume of a surface its filling has not, since it cuts edges off and leaves thin parts out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loss {
    /// The volume of the filling over that of the surface.
    pub kept: f64,
    /// A spacing that keeps the volume within [`REPORTED_LOSS`], if one was found.
    pub finer: Option<f64>,
}

impl Filling {
    /// The filled body; and what it has lost of the volume, where that is more than [`REPORTED_LOSS`].
    ///
    /// # Errors
    /// What [`Mesh::lattice_filling`] and [`Mesh::tetrahedra_filling`] refuse; [`MeshError::Lost`] for tetrahedra that lose more than a quarter.
    pub fn of(self, surface: &Mesh<3>) -> Result<(Mesh<3>, Option<Loss>), MeshError> {
        let spacing = match self {
            // It reaches beyond the surface, and carries it as it is.
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

/// A spacing that keeps the volume, of two digits. What is cut off falls with the square of the spacing: the first that is tried follows from that.
fn finer(surface: &Mesh<3>, spacing: f64, now: f64) -> Option<f64> {
    let (step, most) = FINER;
    let square = (REPORTED_LOSS / (now - 1.0).abs()).sqrt();
    let mut next = spacing * if square < step { square } else { step };
    for _ in 0..most {
        // As it will be written.
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

/// The filling that a shape in space asks for.
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
