//! Parameters of the gas.

use super::gas::SMALLEST_VOLUME;
use opruga_core::spec::{Allowed, Bound, Condition, Default, Field, Role, Spec};

const AMOUNT: &[&str] = &["nRT", "pressure"];

/// The parameters of `pressure`.
pub const SPEC: Spec = Spec {
    kind: "pressure",
    summary: "ideal gas inside closed boundaries: isothermal or adiabatic, with ambient pressure, ramp, leak and heating",
    documentation: "P V = nRT (isothermal, U = −nRT ln(V/V₀) + P_a V) or P V^γ = P₀ V₀^γ (adiabatic, \
U = P₀ V₀^γ V^{1−γ}/(γ−1) + P_a V); force (P − P_a) ∂V/∂x on every node, half of an edge's in 2D and a third of a triangle's in 3D. \
V is the enclosed area times thickness in 2D, the enclosed volume in 3D, by the divergence theorem, and sides of quadratic cells and of boxes bend in it as the cells do, so that an even pressure leaves an even stress; holes count negative by their orientation, \
and every closed boundary that lies in no other one is a chamber of its own with the same parameters. In a solid body the gas belongs \
into its cavities: `inside = \"cavities\"`, each a chamber of its own. \
`diagnostics.csv` has the columns `NAME.volume` [m³], `NAME.pressure` [Pa] and `NAME.nRT` [J]: volume and nRT (P V also of an adiabatic gas, whose temperature changes) of all chambers of the body NAME, \
and the mean of their pressures weighed by volume. A body of several chambers has besides `NAME.chamber1.volume`, `NAME.chamber1.pressure`, \
`NAME.chamber1.nRT`, `NAME.chamber2.volume` and so on, in the order of the boundaries in the shape, that of a chamber being the first of its facets. \
Below V_s = max(`smallest_volume` V₀, the volume of `largest_pressure`) the pressure stays P(V_s), through zero and for a body turned inside out: \
U remains a function of V with continuous slope, so no energy is made; the passage is as short as V_s is small, and a step that does \
not resolve it misses some per cent of the energy, which the ledger shows. A far smaller V_s than the default wants finer steps: one that \
jumps from a thousandth of the volume to its other side feels a thousandfold push, and gains each time. Without ambient pressure U has no minimum in V. \
Source: Matyka and Ollila 2003; thesis 3.3.",
    dimensions: &[2, 3],
    fields: &[
        Field::new(
            "nRT",
            Allowed::NOT_NEGATIVE,
            "J",
            Default::OneOf(AMOUNT),
            "Amount of gas times temperature; exactly one of `nRT` and `pressure`. A command that sets either fills the chamber anew, \
             whatever had leaked.",
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
            "Pressure P_a outside; equal to `pressure` it makes the rest shape an equilibrium.",
        ),
        Field::new(
            "inside",
            Allowed::Choice(&["boundary", "cavities"]),
            "",
            Default::Text("boundary"),
            "Where the gas is: within the boundary, less its holes, as in a balloon; or within the holes of the boundary, as in the \
             cavity of a solid.",
        ),
        Field::new(
            "process",
            Allowed::Choice(&["isothermal", "adiabatic"]),
            "",
            Default::Text("isothermal"),
            "Whether temperature or heat stays constant.",
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
            "Rate λ of loss: d(nRT)/dt = −λ (1 − P_a/P) nRT, which is −λ (P − P_a) V, so that in a volume that stays the same the \
             pressure nears that outside by e^(−λt); air flows in where it is lower than that. What has leaked stays lost when the \
             rate changes.",
        ),
        Field::new(
            "temperature",
            Allowed::CurveNotNegative,
            "",
            Default::Absent,
            "T/T₀ over time: `[[t, factor], …]`, straight between its points.",
        ),
        Field::new(
            "largest_pressure",
            Allowed::POSITIVE,
            "Pa",
            Default::Absent,
            "Cap on the pressure inside; every substep in which it acts is counted.",
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
