//! Parameters of the gas.

use super::gas::SMALLEST_VOLUME;
use opruga_core::spec::{Allowed, Bound, Condition, Default, Field, Role, Spec};

const AMOUNT: &[&str] = &["nRT", "pressure"];

/// The parameters of `pressure`.
pub const SPEC: Spec = Spec {
    kind: "pressure",
    summary: "ideal gas inside closed boundaries: isothermal or adiabatic, with ambient pressure, ramp, leak and heating",
    documentation: "P V = nRT (isothermal, U = −nRT ln(V/V₀) + P_a V) or P V^γ = P₀ V₀^γ (adiabatic, U = P₀ V₀^γ V^{1−γ}/(γ−1) + P_a V). The force \
on every node is (P − P_a) ∂V/∂x: half of the force on each adjacent edge in 2D, a third of the force on each adjacent triangle in 3D. V is the \
enclosed area times thickness in 2D and the enclosed volume in 3D, by the divergence theorem. If the sides of quadratic cells or of hexahedra are \
curved, V includes this curvature, so that a uniform pressure causes a uniform stress. Holes count as negative because of their orientation. Every \
closed boundary that does not lie inside another one is a separate chamber; all chambers have the same parameters. In a solid body, the gas belongs \
in the cavities: with `inside = \"cavities\"`, each cavity is a separate chamber. For each body NAME, `diagnostics.csv` has the columns \
`NAME.volume` [m³] and `NAME.nRT` [J], which are sums over all chambers, and `NAME.pressure` [Pa], the mean pressure weighted by volume. nRT is P V, \
also for an adiabatic gas, whose temperature changes. A body with several chambers also has `NAME.chamber1.volume`, `NAME.chamber1.pressure`, \
`NAME.chamber1.nRT`, `NAME.chamber2.volume` and so on. Chambers are numbered in the order in which their first facets appear in the shape. Below V_s \
= max(`smallest_volume` V₀, the volume of `largest_pressure`) the pressure keeps the value P(V_s), even when the volume passes zero and the body is \
inverted. U is then still a function of V with a continuous slope, so no energy is created. The smaller V_s is, the shorter the passage through zero \
is. A step that does not resolve the passage loses a few per cent of the energy; the ledger shows the loss. If V_s is much smaller than the default, \
use shorter steps: a step that jumps from a thousandth of the volume to the other side of zero feels a force a thousand times as large, and each \
such jump adds energy. Without ambient pressure U has no minimum in V. Source: Matyka and Ollila 2003; thesis 3.3.",
    dimensions: &[2, 3],
    fields: &[
        Field::new(
            "nRT",
            Allowed::NOT_NEGATIVE,
            "J",
            Default::OneOf(AMOUNT),
            "Amount of gas times temperature; give exactly one of `nRT` and `pressure`. A command that sets either one refills the chamber, no \
matter how much has leaked.",
        )
        .starts_at(20.0),
        Field::new(
            "pressure",
            Allowed::NOT_NEGATIVE,
            "Pa",
            Default::OneOf(AMOUNT),
            "Absolute pressure P₀ inside at the rest volume.",
        )
        .starts_at(50.0),
        Field::new(
            "ambient",
            Allowed::NOT_NEGATIVE,
            "Pa",
            Default::Number(0.0),
            "Pressure P_a outside; if it equals `pressure`, the rest shape is an equilibrium.",
        ),
        Field::new(
            "inside",
            Allowed::Choice(&["boundary", "cavities"]),
            "",
            Default::Text("boundary"),
            "Where the gas is: inside the boundary but outside its holes, as in a balloon; or inside the holes of the boundary, as in the cavity of \
a solid.",
        ),
        Field::new(
            "process",
            Allowed::Choice(&["isothermal", "adiabatic"]),
            "",
            Default::Text("isothermal"),
            "Whether the temperature of the gas stays constant (`isothermal`), or no heat enters or leaves it (`adiabatic`).",
        ),
        Field::new(
            "gamma",
            Allowed::Number { least: Bound::Open(1.0), greatest: Bound::Closed(10.0) },
            "",
            Default::Number(1.4),
            "Ratio of heat capacities γ of an adiabatic gas.",
        )
        .applies(&[Condition::Word("process", &["adiabatic"])]),
        Field::new(
            "ramp",
            Allowed::NOT_NEGATIVE,
            "s",
            Default::Number(0.0),
            "Time over which the amount of gas rises linearly from zero at the start.",
        ),
        Field::new(
            "leak",
            Allowed::NOT_NEGATIVE,
            "1/s",
            Default::Number(0.0),
            "Rate λ of loss: d(nRT)/dt = −λ (1 − P_a/P) nRT, which is −λ (P − P_a) V. At constant volume, the pressure approaches the ambient \
pressure as e^(−λt); if it is lower than the ambient pressure, gas flows in. Gas that has leaked stays lost when the rate changes.",
        ),
        Field::new(
            "temperature",
            Allowed::CurveNotNegative,
            "",
            Default::Absent,
            "Factor T/T₀ over time by which nRT is multiplied, where T₀ is the temperature for which `nRT` or `pressure` is given: `[[t, factor], \
…]`, linear between its points.",
        ),
        Field::new(
            "largest_pressure",
            Allowed::POSITIVE,
            "Pa",
            Default::Absent,
            "Upper limit of the pressure inside; every substep in which it acts is counted.",
        ),
        Field::new(
            "smallest_volume",
            Allowed::Number { least: Bound::Open(0.0), greatest: Bound::Open(1.0) },
            "",
            Default::Number(SMALLEST_VOLUME),
            "Fraction of the rest volume below which the pressure no longer rises.",
        ),
    ],
    roles: &[Role::Gas],
};
