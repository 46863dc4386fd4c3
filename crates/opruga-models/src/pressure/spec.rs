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
curved, V includes this curvature, so that a uniform pressure causes a uniform stress. The volume of a hole counts as negative because of the \
orientation of its boundary. Every closed boundary that does not lie inside another one is a separate chamber; all chambers have the same \
parameters. In a solid body, the gas belongs in the cavities: with `inside = \"cavities\"`, each cavity is a separate chamber. For each body NAME, \
`diagnostics.csv` has the columns `NAME.volume` [m³] and `NAME.nRT` [J], which are sums over all chambers, and `NAME.pressure` [Pa], the mean \
pressure weighted by volume. nRT is P V, also for an adiabatic gas, whose temperature changes. A body with several chambers also has \
`NAME.chamber1.volume`, `NAME.chamber1.pressure`, `NAME.chamber1.nRT`, `NAME.chamber2.volume` and so on. Chambers are numbered in the order in which \
their first facets appear in the shape. V_s is the larger of two volumes: `smallest_volume` times V₀, and the volume at which the gas reaches \
`largest_pressure`. Below V_s, the pressure keeps the value P(V_s), even when the volume passes zero and the body is inverted. U is then still a \
function of V with a continuous slope, so no energy is created. A smaller V_s shortens the passage of the volume through zero. A step that does not \
resolve this passage loses a few per cent of the energy; the ledger shows the loss. If V_s is much smaller than the default, use shorter steps: at a \
thousandth of the rest volume, the force is a thousand times as large, and every step that jumps from there to the other side of zero adds energy. \
Without ambient pressure, U as a function of V has no minimum. Source: Matyka and Ollila 2003; thesis 3.3.",
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
pressure as e^(−λt); if the pressure is lower than the ambient pressure, gas flows in. Gas that has leaked stays lost when the rate changes.",
        ),
        Field::new(
            "temperature",
            Allowed::CurveNotNegative,
            "",
            Default::Absent,
            "The factor T/T₀ by which nRT is multiplied over time: `[[t, factor], …]`, linear between its points. T₀ is the temperature for which \
`nRT` or `pressure` is given.",
        ),
        Field::new(
            "largest_pressure",
            Allowed::POSITIVE,
            "Pa",
            Default::Absent,
            "Upper limit of the pressure inside; every substep in which this limit acts is counted.",
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
