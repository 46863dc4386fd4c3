//! The values of a law at one deformation gradient, for tables and for comparison with other programs.

use super::law::Law;
use super::moduli::{lame, refuse_what_is_not_convex};
use super::points::{PARAMETERS, Points};
use super::{ALL, Entry, NAMES, Refusal};
use opruga_core::error::BuildError;
use opruga_core::potential::Definiteness;
use opruga_core::spec::{Values, nearest};
use opruga_math::{Simd, WIDTH};

/// The values of a law at a point.
#[derive(Clone, Debug, PartialEq)]
pub struct AtPoint<const D: usize> {
    /// μ and λ [Pa].
    pub lame: [f64; 2],
    /// Energy per volume at rest ψ [J/m³].
    pub energy: f64,
    /// First Piola–Kirchhoff stress P = ∂ψ/∂F [Pa].
    pub stress: [[f64; D]; D],
    /// ∂Pᵢⱼ/∂Fₖₗ in row i·D + j and column k·D + l [Pa].
    pub tangent: Vec<Vec<f64>>,
    /// The out-of-plane stretch. In plane strain, this stretch is 1. In plane stress, it is the stretch for which the
    /// out-of-plane stress is zero. `None` in space.
    pub across: Option<f64>,
}

/// Evaluates the law that these fields of a model describe, in the plane.
///
/// # Errors
/// `scene.unknown_name` if there is no such material, `model.not_convex`, and `model.no_value` if the law has no finite energy,
/// stress and tangent.
pub fn in_plane(values: &Values, gradient: &[[f64; 2]; 2]) -> Result<AtPoint<2>, BuildError> {
    let entry = entry(values)?;
    let law =
        if values.text("plane") == Some("stress") { (entry.cold.plane_stress)() } else { (entry.cold.plane_strain)() };
    let mut point = ask(&*law, values, gradient)?;
    point.across = point.across.or(Some(1.0));
    Ok(point)
}

/// Evaluates the law that these fields of a model describe, in space.
///
/// # Errors
/// The errors of [`in_plane`].
pub fn in_space(values: &Values, gradient: &[[f64; 3]; 3]) -> Result<AtPoint<3>, BuildError> {
    ask(&*(entry(values)?.cold.space)(), values, gradient)
}

fn entry(values: &Values) -> Result<&'static Entry, BuildError> {
    let name = values.text("material").unwrap_or("");
    ALL.iter().find(|entry| entry.name == name).ok_or_else(|| {
        let meant = nearest(name, NAMES.iter().copied());
        BuildError::of(values.kind(), Refusal::Unknown { name: name.into(), nearest: meant })
    })
}

fn ask<const D: usize>(law: &dyn Law<D>, values: &Values, gradient: &[[f64; D]; D]) -> Result<AtPoint<D>, BuildError> {
    let number = |name: &str| values.number(name).unwrap_or(0.0);
    let (ratio, own) = (number("poissons_ratio"), number("mooney_share"));
    refuse_what_is_not_convex(values, ratio)?;
    let [mu, lambda] = lame(number("youngs_modulus"), ratio);
    // The same point in all lanes of a pack.
    let spread = |numbers: &[f64]| numbers.iter().flat_map(|x| [*x; WIDTH]).collect::<Vec<f64>>();
    let (f, parameters) = (spread(gradient.as_flattened()), spread(&[mu, lambda, own, 1.0]));
    debug_assert_eq!(parameters.len(), PARAMETERS * WIDTH);
    let points = Points { count: 1, gradient: &f, parameters: &parameters };
    let (mut energy, mut across) = (vec![0.0; WIDTH], vec![1.0; WIDTH]);
    let (mut stress, mut tangent) = (vec![0.0; D * D * WIDTH], vec![0.0; D * D * D * D * WIDTH]);
    let simd = Simd::best();
    law.stress(simd, points, &mut energy, &mut stress);
    law.tangent(simd, points, Definiteness::Exact, &mut tangent);
    let found = law.thickness(simd, points, &mut across);
    if energy[..1].iter().chain(&stress).chain(&tangent).any(|x| !x.is_finite()) {
        let determinant = opruga_math::matrix::determinant::<f64, D>(gradient);
        let material = values.text("material").unwrap_or("").to_string();
        let refusal = match (found, across[0].is_nan()) {
            (true, true) => Refusal::NoThicknessAcross { material, determinant },
            _ => Refusal::TooLarge { material, determinant },
        };
        return Err(BuildError::of(values.kind(), refusal));
    }
    let row = |row: usize| (0..D * D).map(|column| tangent[(row * D * D + column) * WIDTH]).collect();
    Ok(AtPoint {
        lame: [mu, lambda],
        energy: energy[0],
        stress: core::array::from_fn(|i| core::array::from_fn(|j| stress[(i * D + j) * WIDTH])),
        tangent: (0..D * D).map(row).collect(),
        across: found.then_some(across[0]),
    })
}
