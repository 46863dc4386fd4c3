//! Bodies at rest that touch one another, with `equilibrium`.

use super::BASE;
use super::pressed::{BARRIER, patch_at_rest_by_barrier, pressures_at_rest, weight};
use crate::case::{Case, Check, Over, Scale};

const WEIGHT: Case = Case {
    quantity: "force between a solid at rest and the one that it stands on, relative to its weight, by `equilibrium`",
    source: "exact: 1 (I. Newton)",
    over: Over::Parameter("mass of the upper body divided by that of the lower one"),
    levels: &[1e-4, 1.0, 1e4],
    expected: &[1.0],
    tolerance: 1e-6,
    check: Check::Everywhere,
    ..BASE
};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "contact-patch-statics",
        quantity: "two blocks with non-matching meshes are pressed together: largest relative deviation of the pressure on a node from the applied \
pressure, by `equilibrium`",
        source: "exact: uniform pressure (R. L. Taylor, P. Papadopoulos 1991, contact patch test)",
        over: Over::Cells("cells along a side of the lower block; one more along that of the upper block"),
        levels: &[2.0, 3.0, 4.0],
        scale: Scale::Of(1.0),
        tolerance: 1e-6,
        check: Check::Everywhere,
        measure: pressures_at_rest,
        ..BASE
    },
    Case { name: "weight-on-body-statics", measure: |lab, ratio| weight(lab, "equilibrium", "", ratio, 1.0), ..WEIGHT },
    Case {
        name: "weight-on-body-barrier-statics",
        quantity: "force between a solid at rest and the one that it stands on, relative to its weight, by `equilibrium` with a barrier",
        levels: &[0.01, 1.0, 100.0],
        measure: |lab, ratio| weight(lab, "equilibrium", "response = \"barrier\"\n", ratio, 1.0),
        ..WEIGHT
    },
    Case {
        name: "contact-patch-barrier-statics",
        quantity: "two blocks with non-matching meshes are pressed together: largest relative deviation of the pressure on a node from the applied \
pressure, by `equilibrium` with a barrier",
        measure: patch_at_rest_by_barrier,
        ..BARRIER
    },
];
