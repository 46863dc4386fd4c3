//! Cook's membrane: a trapezoid of 48 × (44 → 16), clamped at the left, pulled upwards along the right side.

use super::BASE;
use crate::bodies::{Cells, displacement};
use crate::case::{Case, Check, Over};
use crate::lab::{Lab, Scene, Trouble};

/// Twice the exponent λ of the singularity at the clamped upper corner. With the angle α = 108.4° between the clamped and the free side, λ satisfies
/// sin² λα = (κ + 1)²/4κ − λ²/κ sin² α with κ = 2 in plane stress and 2.2 in plane strain (M. L. Williams 1952). On uniform meshes, displacements
/// under a load far from the corner converge at the order 2λ.
const SINGULAR: f64 = 1.354;

const LINEAR: Case = Case {
    quantity: "upward displacement of the middle of the pulled side, linear, plane stress, E = 1, ν = 1/3, F = 1",
    unit: "m",
    source: "R. D. Cook 1974; limit 23.9676 from two other programs with 153,000 graded quadratic triangles; order 2λ = 1.354 from the corner \
singularity, M. L. Williams 1952",
    over: Over::Cells("cells along a side of the membrane"),
    expected: &[23.9676],
    check: Check::Order(SINGULAR),
    ..BASE
};

const LARGE: Case = Case {
    quantity: "upward displacement of the pulled corner, neo-Hookean, plane strain, E = 240.565, F = 100",
    levels: &[4.0, 8.0, 16.0],
    check: Check::Finest,
    ..LINEAR
};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "cook-linear-quadratic-triangles",
        levels: &[8.0, 16.0, 32.0],
        tolerance: 0.002,
        quick: true,
        measure: |lab, n| cook(lab, n, Cells::Quadratic, STRESS, 1.0, 52.0),
        ..LINEAR
    },
    Case {
        name: "cook-linear-quadrilaterals",
        levels: &[16.0, 32.0, 64.0],
        measure: |lab, n| cook(lab, n, Cells::Boxes, STRESS, 1.0, 52.0),
        ..LINEAR
    },
    Case {
        name: "cook-linear-triangles",
        levels: &[16.0, 32.0, 64.0],
        measure: |lab, n| cook(lab, n, Cells::Linear, STRESS, 1.0, 52.0),
        ..LINEAR
    },
    Case {
        name: "cook-linear-0-49-quadrilaterals",
        quantity: "upward displacement of the pulled corner, linear, plane strain, E = 1, ν = 0.49, F = 1",
        source: "R. D. Cook 1974; 19.48 from two other programs with 32 × 32 quadratic triangles",
        levels: &[8.0, 16.0, 32.0],
        expected: &[19.48],
        check: Check::Finest,
        measure: |lab, n| {
            cook(lab, n, Cells::Boxes, "material = \"linear\", youngs_modulus = 1.0, poissons_ratio = 0.49", 1.0, 60.0)
        },
        ..LINEAR
    },
    Case {
        name: "cook-linear-0-49-quadratic-triangles",
        quantity: "upward displacement of the middle of the pulled side, linear, plane strain, E = 1, ν = 0.49, F = 1",
        source: "R. D. Cook 1974; 18.63 from two other programs with 32 × 32 quadratic triangles",
        levels: &[4.0, 8.0, 16.0],
        expected: &[18.63],
        check: Check::Finest,
        measure: |lab, n| {
            cook(
                lab,
                n,
                Cells::Quadratic,
                "material = \"linear\", youngs_modulus = 1.0, poissons_ratio = 0.49",
                1.0,
                52.0,
            )
        },
        ..LINEAR
    },
    Case {
        name: "cook-linear-0-49-triangles",
        quantity: "upward displacement of the pulled corner, linear, plane strain, E = 1, ν = 0.49, F = 1, nodal volumes",
        source: "R. D. Cook 1974; 19.48 from two other programs with 32 × 32 quadratic triangles",
        expected: &[19.48],
        levels: &[16.0, 32.0, 64.0],
        check: Check::Finest,
        measure: |lab, n| {
            let law = "material = \"linear\", youngs_modulus = 1.0, poissons_ratio = 0.49, locking = \"nodal_volume\"";
            cook(lab, n, Cells::Linear, law, 1.0, 60.0)
        },
        ..LINEAR
    },
    Case {
        name: "cook-large-0-3",
        source: "7.7648 from another program with quadratic triangles, μ/2 (I₁ − 3) − μ ln J + λ/2 ln² J, ν = 0.3",
        expected: &[7.7648],
        measure: |lab, n| {
            cook(
                lab,
                n,
                Cells::Quadratic,
                "material = \"neo_hookean\", youngs_modulus = 240.565, poissons_ratio = 0.3",
                100.0,
                60.0,
            )
        },
        ..LARGE
    },
    Case {
        name: "cook-large-0-45",
        source: "7.1660 from another program with quadratic triangles, μ/2 (I₁ − 3) − μ ln J + λ/2 ln² J, ν = 0.45",
        expected: &[7.1660],
        measure: |lab, n| {
            cook(
                lab,
                n,
                Cells::Quadratic,
                "material = \"neo_hookean\", youngs_modulus = 240.565, poissons_ratio = 0.45",
                100.0,
                60.0,
            )
        },
        ..LARGE
    },
    Case {
        name: "cook-large-0-4999-quadratic-triangles",
        source: "6.9 in the limit, read off fig. 5 of J. C. Simo, F. Armero 1992 (two digits), ν = 0.4999",
        levels: &[8.0, 12.0, 16.0],
        expected: &[6.9],
        measure: |lab, n| cook(lab, n, Cells::Quadratic, NEARLY, 100.0, 60.0),
        ..LARGE
    },
    Case {
        name: "cook-large-0-4999-triangles",
        quantity: "upward displacement of the pulled corner, neo-Hookean, plane strain, E = 240.565, F = 100, nodal volumes",
        source: "6.9 in the limit, read off fig. 5 of J. C. Simo, F. Armero 1992 (two digits), ν = 0.4999",
        levels: &[16.0, 32.0, 64.0],
        expected: &[6.9],
        measure: |lab, n| cook(lab, n, Cells::Linear, &format!("{NEARLY}, locking = \"nodal_volume\""), 100.0, 60.0),
        ..LARGE
    },
    Case {
        name: "cook-large-0-4999-quadrilaterals",
        source: "6.9 in the limit, read off fig. 5 of J. C. Simo, F. Armero 1992 (two digits), ν = 0.4999",
        levels: &[8.0, 16.0, 32.0],
        expected: &[6.9],
        measure: |lab, n| cook(lab, n, Cells::Boxes, NEARLY, 100.0, 60.0),
        ..LARGE
    },
];

const STRESS: &str =
    "material = \"linear\", youngs_modulus = 1.0, poissons_ratio = 0.3333333333333333, plane = \"stress\"";
const NEARLY: &str = "material = \"neo_hookean\", youngs_modulus = 240.565, poissons_ratio = 0.4999";

/// The upward displacement at a given height of the right side.
fn cook(lab: &Lab, n: f64, cells: Cells, law: &str, force: f64, height: f64) -> Result<f64, Trouble> {
    let steps = if law.contains("linear") { 1 } else { 5 };
    let scene = Scene::statics(2, 1e-9).add(&format!(
        "load_steps = {steps}\n[[body]]\nname = \"membrane\"\ndensity = 1.0\n\
         shape = {{ kind = \"quadrilateral\", corners = [[0, 0], [48, 44], [48, 60], [0, 44]], cells = [{n}, {n}] }}\n{}\n\
         models = [{{ kind = \"fem\", {law} }}]\npin = [{{ select = {{ group = \"left\" }} }}]\n\
         [[load]]\nkind = \"traction\"\nbody = \"membrane\"\nselect = {{ group = \"right\" }}\nvalue = [0.0, {:?}]",
        cells.fields(),
        force / 16.0
    ));
    let mut world = lab.plane(scene)?;
    world.frame()?;
    Ok(displacement(&world, [48.0, height])[1])
}
