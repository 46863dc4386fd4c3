//! Bending of beams and rods: the elastica, rolling up, sagging.

use super::BASE;
use crate::bodies::{Cells, displacement, mapped, nodes};
use crate::case::{Case, Check, Over};
use crate::lab::{Lab, Scene, Trouble};
use std::fmt::Write as _;

const ELASTICA: Case = Case {
    quantity: "deflection of the tip of a clamped rod under a transverse force, divided by its length, PL²/EI = 2",
    source: "K. E. Bisshopp, D. C. Drucker 1945, elliptic integrals; confirmed by shooting",
    over: Over::Cells("segments"),
    expected: &[0.493457],
    ..BASE
};

const SAG: Case = Case {
    unit: "m",
    source: "another program with quadratic tetrahedra, converged; Euler–Bernoulli ρgAL⁴/8EI = 0.014715 and Timoshenko 0.014865 are theories of thin \
beams",
    over: Over::Cells("cells along the beam"),
    ..BASE
};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "elastica-chain",
        levels: &[10.0, 20.0, 40.0, 80.0],
        check: Check::Order(2.0),
        quick: true,
        measure: |lab, n| chain(lab, n, 2.0),
        ..ELASTICA
    },
    Case {
        name: "elastica-chain-by-load",
        quantity: "deflection of the tip of a clamped rod of 100 segments under a transverse force, divided by its length",
        over: Over::Parameter("PL²/EI"),
        levels: &[0.25, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0],
        expected: &[0.082746, 0.162144, 0.301721, 0.493457, 0.603253, 0.669964, 0.713792, 0.744571, 0.784982, 0.810609],
        tolerance: 0.002,
        check: Check::Everywhere,
        quick: true,
        measure: |lab, load| chain(lab, 100.0, load),
        ..ELASTICA
    },
    Case {
        name: "elastica-quadratic-triangles",
        quantity: "deflection of the tip of a clamped strip of thickness L/50 under a transverse force, divided by its length, PL²/EI = 2, St. \
Venant–Kirchhoff",
        over: Over::Cells("cells along the strip"),
        levels: &[10.0, 20.0, 40.0],
        measure: |lab, n| strip(lab, n, Cells::Quadratic, 1.0),
        ..ELASTICA
    },
    Case {
        name: "elastica-quadrilaterals",
        quantity: "deflection of the tip of a clamped strip of thickness L/50 under a transverse force, divided by its length, PL²/EI = 2, St. \
Venant–Kirchhoff",
        over: Over::Cells("cells along the strip"),
        // Changed after its first run, which had half as many cells along the strip: the spurious shear depends only on the ratio of the length of a
        // cell to the thickness.
        levels: &[100.0, 200.0, 400.0],
        measure: |lab, n| strip(lab, n, Cells::Boxes, 4.0),
        ..ELASTICA
    },
    Case {
        name: "roll-up",
        quantity: "moment that keeps a straight rod of 1 m with EI = 1 N m² rolled up into a closed circle",
        unit: "N m",
        source: "exact: M = 2π EI/L, also for a chain of equal hinges",
        over: Over::Cells("segments"),
        levels: &[12.0, 24.0, 48.0],
        expected: &[std::f64::consts::TAU],
        tolerance: 1e-6,
        check: Check::Everywhere,
        quick: true,
        measure: roll_up,
        ..BASE
    },
    Case {
        name: "heavy-beam-quadratic-tetrahedra",
        quantity: "deflection of the end of a beam of 1 × 0.1 × 0.1 m under its weight, E = 1e8 Pa, ν = 0.3, ρ = 1000 kg/m³, neo-Hookean",
        levels: &[4.0, 8.0, 12.0],
        expected: &[0.014686],
        measure: |lab, n| heavy(lab, n, Cells::Quadratic, 1e8, 4.0),
        ..SAG
    },
    Case {
        name: "heavy-beam-hexahedra",
        quantity: "deflection of the end of a beam of 1 × 0.1 × 0.1 m under its weight, E = 1e8 Pa, ν = 0.3, ρ = 1000 kg/m³, neo-Hookean",
        // Changed after its first run, which had half as many cells along the beam, for the same reason as for the strip.
        levels: &[20.0, 40.0, 80.0],
        expected: &[0.014686],
        measure: |lab, n| heavy(lab, n, Cells::Boxes, 1e8, 20.0),
        ..SAG
    },
    Case {
        name: "very-heavy-beam-quadratic-tetrahedra",
        quantity: "deflection of the end of a beam of 1 × 0.1 × 0.1 m under its weight, E = 1e6 Pa, ν = 0.3, ρ = 1000 kg/m³, neo-Hookean",
        source: "0.747 from another program with quadratic elements, converged in space; the elastica without stretch and shear gives 0.7383",
        levels: &[4.0, 8.0, 12.0],
        expected: &[0.747],
        measure: |lab, n| heavy(lab, n, Cells::Quadratic, 1e6, 4.0),
        ..SAG
    },
];

/// A chain of n segments of length ℓ with hinges of stiffness EI/ℓ and springs that hardly stretch. Two nodes are clamped, so the rod begins at the
/// midpoint of the first segment.
fn chain(lab: &Lab, n: f64, load: f64) -> Result<f64, Trouble> {
    let l = 1.0 / (n - 0.5);
    let scene = Scene::statics(2, 1e-8).add(&format!(
        "load_steps = 8\n[[body]]\nname = \"rod\"\nmass = 1.0\n\
         shape = {{ kind = \"line\", from = [{:?}, 0.0], to = [1.0, 0.0], segments = {n} }}\n\
         models = [{{ kind = \"bending\", stiffness = {:?} }}, {{ kind = \"mass_spring\", stiffness = {:?} }}]\n\
         pin = [{{ select = {{ nodes = [0, 1] }} }}]\n\
         [[load]]\nkind = \"force\"\nbody = \"rod\"\nselect = {{ node = {n} }}\nvalue = [0.0, {:?}]",
        -0.5 * l,
        1.0 / l,
        1e5 / l,
        -load
    ));
    let mut world = lab.plane(scene)?;
    world.frame()?;
    Ok(-displacement(&world, [1.0, 0.0])[1])
}

/// A strip in plane stress with EI = 1 N m². The strip has n cells along its length and `across` cells across its thickness.
fn strip(lab: &Lab, n: f64, cells: Cells, across: f64) -> Result<f64, Trouble> {
    let thickness: f64 = 0.02;
    let scene = Scene::statics(2, 1e-8).add(&format!(
        "load_steps = 8\n[[body]]\nname = \"strip\"\ndensity = 1.0\n\
         shape = {{ kind = \"grid\", size = [1.0, {thickness:?}], cells = [{n}, {across}], corner = [0.0, {:?}] }}\n{}\n\
         models = [{{ kind = \"fem\", material = \"st_venant_kirchhoff\", youngs_modulus = {:?}, poissons_ratio = 0.0, plane = \"stress\" }}]\n\
         pin = [{{ select = {{ side = \"left\" }} }}]\n\
         [[load]]\nkind = \"traction\"\nbody = \"strip\"\nselect = {{ side = \"right\" }}\nvalue = [0.0, {:?}]",
        -0.5 * thickness,
        cells.fields(),
        12.0 / thickness.powi(3),
        -2.0 / thickness
    ));
    let mut world = lab.plane(scene)?;
    world.frame()?;
    Ok(-displacement(&world, [1.0, 0.0])[1])
}

/// Moves the last two nodes of a chain until it is a closed polygon with equal angles, and returns the moment on these nodes.
fn roll_up(lab: &Lab, n: f64) -> Result<f64, Trouble> {
    let l = 1.0 / (n - 1.0);
    let models = format!(
        "models = [{{ kind = \"bending\", stiffness = {:?} }}, {{ kind = \"mass_spring\", stiffness = {:?} }}]",
        1.0 / l,
        1e6 / l
    );
    roll_up_by(lab, n, &models)
}

/// Rolls up a chain with the given models, which must have EI = 1 N m² and hardly stretch.
pub(super) fn roll_up_by(lab: &Lab, n: f64, models: &str) -> Result<f64, Trouble> {
    let (count, l) = (n as usize, 1.0 / (n - 1.0));
    let position_at = |angle: f64, node: usize| {
        (0..node).fold([0.0; 2], |x, k| [x[0] + l * (k as f64 * angle).cos(), x[1] + l * (k as f64 * angle).sin()])
    };
    let mut text = format!(
        "[[body]]\nname = \"rod\"\nmass = 1.0\nshape = {{ kind = \"line\", from = [0.0, 0.0], to = [{:?}, 0.0], segments = {n} }}\n{models}\n\
         pin = [{{ select = {{ nodes = [0, 1] }} }}",
        n * l
    );
    let steps = 40;
    for node in [count - 1, count] {
        let start = position_at(0.0, node);
        let _ = write!(text, ",\n {{ select = {{ node = {node} }}, motion = [");
        for step in 0..=steps {
            let part = f64::from(step) / f64::from(steps);
            let x = position_at(part * std::f64::consts::TAU / (n - 1.0), node);
            let _ = write!(text, "[{part:?}, {:?}, {:?}],", x[0] - start[0], x[1] - start[1]);
        }
        text.push_str("] }");
    }
    let rule = "equilibrium\ntolerance = 1e-8";
    let mut world = lab.plane(Scene::new(2, 1.0 / f64::from(steps), 1, rule).add(&(text + "]")))?;
    for _ in 0..steps {
        world.frame()?;
    }
    let moment = [count - 1, count].map(|node| {
        let (x, force) = (world.position(0, node as u32), world.reaction(0, &[node as u32]));
        x[0] * force[1] - x[1] * force[0]
    });
    Ok(moment[0] + moment[1])
}

/// A beam that is clamped at one end and sags under its weight. The beam has n cells along its length and `n / slender` cells across its thickness.
fn heavy(lab: &Lab, n: f64, cells: Cells, young: f64, slender: f64) -> Result<f64, Trouble> {
    let across = (n / slender) as u32;
    let mesh = mapped([n as u32, across, across], cells, |x| [x[0], 0.1 * x[1] - 0.05, 0.1 * x[2] - 0.05])?;
    let clamped = nodes(&mesh, |x| x[0] == 0.0);
    let steps = if young < 1e7 { 10 } else { 2 };
    let scene = Scene::statics(3, 1e-9)
        .add(&format!("load_steps = {steps}\n[world]\ngravity = [0.0, -9.81, 0.0]"))
        .body(&mesh, &format!(
            "density = 1000.0\nmodels = [{{ kind = \"fem\", material = \"neo_hookean\", youngs_modulus = {young:?}, poissons_ratio = 0.3 }}]\n\
             pin = [{{ select = {{ nodes = {clamped:?} }} }}]"
        ))?;
    let mut world = lab.space(scene)?;
    world.frame()?;
    // The result is the mean over the nodes at the free end.
    let end = nodes(&mesh, |x| x[0] == 1.0);
    Ok(-end.iter().map(|k| world.position(0, *k)[1] - mesh.positions[*k as usize][1]).sum::<f64>() / end.len() as f64)
}
