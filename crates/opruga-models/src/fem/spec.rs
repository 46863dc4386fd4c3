//! Parameters of finite elements.

use super::numbers::{EXPANSION, YOUNGS_MODULUS};
use crate::materials::NAMES;
use opruga_core::spec::{Allowed, Bound, Condition, Default, Field, Role, Spec};

/// The parameters of `fem`.
pub const SPEC: Spec = Spec {
    kind: "fem",
    summary: "an elastic solid, computed with finite elements; several materials are available",
    documentation: "Energy U = Σ V ψ(F) over the integration points of the cells, with F = ∂x/∂X; the force is −∂U/∂x. The cells are triangles or \
tetrahedra of first or second order, quadrilaterals or hexahedra. In every material, E and ν are Young's modulus and Poisson's ratio at small \
strain; μ = E/2(1 + ν), λ = Eν/((1 + ν)(1 − 2ν)). Quadratic triangles and tetrahedra (`order = 2` of the body, the default) lock neither in bending \
nor near incompressibility. In quadrilaterals and hexahedra, the strains of bending and twisting follow from assumed stresses; they are exact if the \
cells are rectangular, up to ν = 0.4999. Linear triangles and tetrahedra bend too stiffly. Above ν = 0.45, they lock and are refused unless \
`locking` accepts them; with `locking = \"nodal_volume\"`, they do not lock. In the plane, the body is a slice of a long one (plane strain) or a \
plate that thins freely (plane stress); its depth is the `thickness` of the body. Damping is that of Kelvin and Voigt, S = τ (2μ Ė + λ tr Ė 1), \
where Ė is the rate of Green's strain; this stress is zero under rigid motion. With `thermal_expansion`, an unconstrained body expands by the factor \
g = 1 + α (T − T₀) without stress. The energy is then U = Σ V g³ ψ(F/g) (`linear`: ψ(ε − αΔT 1)). In plane strain, the body expands by the factor 1 \
+ (1 + ν) α (T − T₀) in the plane. The command `set` can change the temperature while the scene runs. Equations, sources and measurements: \
docs/finite-elements.md.",
    dimensions: &[2, 3],
    fields: &[
        Field::new(
            "material",
            Allowed::Choice(NAMES),
            "",
            Default::Text("stable_neo_hookean"),
            "The law: `linear` for small strain, `corotated` for small strain with large rotation, or a law of rubber for large strain.",
        ),
        Field::new(
            "youngs_modulus",
            Allowed::POSITIVE,
            "Pa",
            Default::OneOf(&YOUNGS_MODULUS),
            "Young's modulus E; give exactly one of `youngs_modulus` and `youngs_modulus_of_cells`.",
        ),
        Field::new(
            "youngs_modulus_of_cells",
            Allowed::Text,
            "",
            Default::OneOf(&YOUNGS_MODULUS),
            "The name of the values in the mesh file that give Young's modulus of each cell [Pa].",
        ),
        Field::new(
            "poissons_ratio",
            Allowed::Number { least: Bound::Open(-1.0), greatest: Bound::Open(0.5) },
            "",
            Default::Number(0.3),
            "Poisson's ratio ν; it is nearly 0.5 for rubber.",
        )
        .applies(&[Condition::NotGiven("poissons_ratio_of_cells")]),
        Field::new(
            "poissons_ratio_of_cells",
            Allowed::Text,
            "",
            Default::Absent,
            "The name of the values in the mesh file that give Poisson's ratio of each cell.",
        ),
        Field::new(
            "damping",
            Allowed::NOT_NEGATIVE,
            "s",
            Default::Number(0.0),
            "Retardation time τ of the Kelvin–Voigt solid; a mode of angular frequency ω loses its energy at the rate τω².",
        )
        .applies(&[Condition::NotGiven("damping_of_cells")]),
        Field::new(
            "damping_of_cells",
            Allowed::Text,
            "",
            Default::Absent,
            "The name of the values in the mesh file that give the retardation time of each cell [s].",
        ),
        Field::new(
            "thermal_expansion",
            Allowed::ANY,
            "1/K",
            Default::Absent,
            "Coefficient α of linear thermal expansion. An unconstrained body expands by the factor 1 + α (T − T₀) in every direction. The default \
is 0.",
        )
        .applies(&[Condition::NotGiven("thermal_expansion_of_cells")]),
        Field::new(
            "thermal_expansion_of_cells",
            Allowed::Text,
            "",
            Default::Absent,
            "The name of the values in the mesh file that give the coefficient of thermal expansion of each cell [1/K].",
        ),
        Field::new(
            "temperature",
            Allowed::NOT_NEGATIVE,
            "K",
            Default::Absent,
            "Temperature T; the default is the reference temperature.",
        )
        .applies(&[Condition::NotGiven("temperature_of_cells"), Condition::GivenOneOf(&EXPANSION)]),
        Field::new(
            "temperature_of_cells",
            Allowed::Text,
            "",
            Default::Absent,
            "The name of the values in the mesh file that give the temperature of each cell [K].",
        )
        .applies(&[Condition::GivenOneOf(&EXPANSION)]),
        Field::new(
            "reference_temperature",
            Allowed::NOT_NEGATIVE,
            "K",
            Default::Number(293.15),
            "Temperature T₀ at which the shape at rest is free of stress.",
        )
        .applies(&[Condition::NotGiven("reference_temperature_of_cells"), Condition::GivenOneOf(&EXPANSION)]),
        Field::new(
            "reference_temperature_of_cells",
            Allowed::Text,
            "",
            Default::Absent,
            "The name of the values in the mesh file that give the reference temperature of each cell [K].",
        )
        .applies(&[Condition::GivenOneOf(&EXPANSION)]),
        Field::new(
            "mass",
            Allowed::Choice(&["lumped", "consistent"]),
            "",
            Default::Text("lumped"),
            "With \"lumped\", every node has a mass of its own. With \"consistent\", the mass matrix is ρ∫N_i N_j with the shape functions N, which \
couples the nodes of a cell. Consistent masses make waves too fast, and lumped masses make them too slow. Use consistent masses with implicit \
integrators and for natural frequencies.",
        ),
        Field::new(
            "plane",
            Allowed::Choice(&["strain", "stress"]),
            "",
            Default::Text("strain"),
            "With \"strain\", nothing moves across the plane; with \"stress\", no stress acts across it.",
        )
        .applies(&[Condition::Dimension(2)]),
        Field::new(
            "mooney_share",
            Allowed::FRACTION,
            "",
            Default::Number(0.2),
            "C₂/(C₁ + C₂), where 2(C₁ + C₂) = μ; 0.2 means C₁ : C₂ = 4 : 1. At most ν/(1 − 2ν) is allowed.",
        )
        .applies(&[Condition::Word("material", &["mooney_rivlin"])]),
        Field::new(
            "cells",
            Allowed::Text,
            "",
            Default::Absent,
            "The group of cells of the mesh that have this material; the default is all cells.",
        ),
        Field::new(
            "locking",
            Allowed::Choice(&["refuse", "accept", "nodal_volume"]),
            "",
            Default::Text("refuse"),
            "What happens with linear triangles and tetrahedra above ν = 0.45: \"refuse\" gives an error, and \"accept\" accepts them although they \
lock. With \"nodal_volume\", they resist changes of the volumes of nodes instead of the volumes of cells, so they do not lock; \"nodal_volume\" is \
allowed only for linear triangles and tetrahedra, and not in plane stress.",
        ),
    ], roles: &[Role::OwnsCells], };

/// The fields of `fem` that belong to one law only, besides `youngs_modulus`, `poissons_ratio` and `plane`.
pub fn own_fields(material: &str) -> impl Iterator<Item = &'static str> + use<'_> {
    let own = move |condition: &Condition| matches!(condition, Condition::Word("material", words) if words.contains(&material));
    SPEC.fields.iter().filter(move |field| field.applies.iter().any(own)).map(|field| field.name)
}
