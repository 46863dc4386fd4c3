//! Heat, forces per volume, and a start with a velocity field.

use super::BASE;
use crate::bodies::{Cells, displacement, mapped, nodes};
use crate::case::{Case, Check, Family, Over};
use crate::lab::{Lab, Scene, Trouble};

/// The thermal strain αΔT of all cases.
const STRAIN: f64 = 0.01;

const HEATED_BAR: Case = Case {
    quantity: "stress in a heated bar between two walls, divided by E; αΔT = 0.01, ν = 0.3, linear",
    unit: "",
    source: "exact: −αΔT (S. Timoshenko, J. N. Goodier, Theory of Elasticity, ch. 13)",
    over: Over::Cells("cells along the bar"),
    levels: &[1.0, 2.0, 4.0],
    expected: &[-STRAIN],
    tolerance: 1e-9,
    check: Check::Everywhere,
    quick: true,
    ..BASE
};

const COLUMN: Case = Case {
    quantity: "downward displacement of the top of a column of 2 m under a force of 2000 N/m³, E = 100 kPa, ν = 0",
    unit: "m",
    source: "exact: bL²/2E",
    over: Over::Cells("cells along the column"),
    expected: &[0.04],
    ..HEATED_BAR
};

pub(super) const CASES: &[Case] = &[
    Case { name: "heated-bar-quadrilaterals", measure: |lab, n| bar(lab, n, Cells::Boxes), ..HEATED_BAR },
    Case { name: "heated-bar-quadratic-triangles", measure: |lab, n| bar(lab, n, Cells::Quadratic), ..HEATED_BAR },
    Case {
        name: "heated-slice",
        quantity: "expansion of a free heated slice in plane strain, quadrilaterals; αΔT = 0.01, ν = 0.3, linear",
        source: "exact: (1 + ν) αΔT (S. Timoshenko, J. N. Goodier, Theory of Elasticity, ch. 13)",
        expected: &[1.3 * STRAIN],
        measure: slice,
        ..HEATED_BAR
    },
    Case {
        name: "bimetal",
        quantity: "rise of the end of a strip of 10 × 1 m whose lower half is warmer, αΔT = 1e-3, quadrilaterals, ν = 0, plane stress",
        unit: "m",
        source: "S. Timoshenko 1925, layers of equal thickness h/2 and equal modulus: 3/4 αΔT L²/h; the ends deviate from beam theory",
        over: Over::Cells("cells through the strip"),
        levels: &[2.0, 4.0, 8.0],
        expected: &[0.075],
        tolerance: 0.01,
        check: Check::Finest,
        measure: strip,
        ..HEATED_BAR
    },
    Case { name: "column-quadrilaterals", measure: |lab, n| column(lab, n, Cells::Boxes), ..COLUMN },
    Case { name: "column-quadratic-triangles", measure: |lab, n| column(lab, n, Cells::Quadratic), ..COLUMN },
];

/// A start with a velocity field, listed among the ledgers.
pub(super) const START: Case = Case {
    name: "stretching-start",
    family: Family::Ledgers,
    quantity: "kinetic energy of a square of 1 m that begins with the velocity gradient ∂v/∂x = 1/s along one axis, divided by ρ",
    unit: "J m³/kg",
    source: "exact: ½ ∫ x² dV = 1/24; the masses are at the nodes, so they lie too far out; the error falls with the square of the cell size",
    over: Over::Cells("cells along each side"),
    levels: &[8.0, 16.0, 32.0],
    expected: &[1.0 / 24.0],
    tolerance: 0.01,
    check: Check::Order(2.0),
    measure: start,
    ..HEATED_BAR
};

/// The lines of the scene for a solid of E = 1 Pa that heat expands by the factor 1 + αΔT, with further fields of its model and its pins.
fn warm(poisson: f64, more: &str, pins: &str) -> String {
    format!(
        "density = 1.0\nmodels = [{{ kind = \"fem\", material = \"linear\", youngs_modulus = 1.0, poissons_ratio = {poisson:?}, \
         thermal_expansion = 1e-4, temperature = 393.15{more} }}]\npin = [{pins}]"
    )
}

fn pin(nodes: &[u32], axes: &str) -> String {
    format!("{{ select = {{ nodes = {nodes:?} }}, axes = \"{axes}\" }}")
}

fn bar(lab: &Lab, n: f64, cells: Cells) -> Result<f64, Trouble> {
    let mesh = mapped([n as u32, 1], cells, |x| [4.0 * x[0], x[1]])?;
    let ends = nodes(&mesh, |x| x[0] == 0.0 || x[0] == 4.0);
    let below = nodes(&mesh, |x| x[1] == 0.0);
    let pins = [pin(&ends, "x"), pin(&below, "y")].join(", ");
    let scene = Scene::statics(2, 1e-13).body(&mesh, &warm(0.3, ", plane = \"stress\"", &pins))?;
    let mut world = lab.plane(scene)?;
    world.frame()?;
    let states = world.cell_states(0);
    // The stress is proportional to the modulus, so a modulus other than 1 Pa would be detected.
    Ok(states.iter().map(|state| state.stress[0][0]).sum::<f64>() / states.len() as f64)
}

fn slice(lab: &Lab, n: f64) -> Result<f64, Trouble> {
    let mesh = mapped([n as u32, 2], Cells::Boxes, |x| [x[0], x[1]])?;
    let pins = [pin(&nodes(&mesh, |x| x[0] == 0.0), "x"), pin(&nodes(&mesh, |x| x[1] == 0.0), "y")].join(", ");
    let scene = Scene::statics(2, 1e-13).body(&mesh, &warm(0.3, "", &pins))?;
    let mut world = lab.plane(scene)?;
    world.frame()?;
    Ok(displacement(&world, [1.0, 1.0])[0])
}

fn strip(lab: &Lab, n: f64) -> Result<f64, Trouble> {
    let mut mesh = mapped([10 * n as u32, n as u32], Cells::Boxes, |x| [10.0 * x[0], x[1]])?;
    let height = |nodes: &[u32]| nodes.iter().map(|node| mesh.positions[*node as usize][1]).sum::<f64>() / 4.0;
    let temperatures =
        mesh.cells.iter().map(|(_, _, nodes)| if height(nodes) < 0.5 { 303.15 } else { 293.15 }).collect();
    mesh.cell_values.insert("T".into(), temperatures);
    let corner = nodes(&mesh, |x| x[0] == 0.0 && x[1] == 0.0);
    let pins = [pin(&nodes(&mesh, |x| x[0] == 0.0), "x"), pin(&corner, "y")].join(", ");
    let body = warm(0.0, ", plane = \"stress\"", &pins).replace("temperature = 393.15", "temperature_of_cells = \"T\"");
    let scene = Scene::statics(2, 1e-13).body(&mesh, &body)?;
    let mut world = lab.plane(scene)?;
    world.frame()?;
    Ok(displacement(&world, [10.0, 0.0])[1])
}

fn column(lab: &Lab, n: f64, cells: Cells) -> Result<f64, Trouble> {
    let mesh = mapped([1, n as u32], cells, |x| [0.5 * x[0], 2.0 * x[1]])?;
    let (top, bottom) = (nodes(&mesh, |x| x[1] == 2.0), nodes(&mesh, |x| x[1] == 0.0));
    let body = format!(
        "density = 1.0\nmodels = [{{ kind = \"fem\", material = \"linear\", youngs_modulus = 1e5, poissons_ratio = 0.0, plane = \"stress\" }}]\npin = [{}]",
        pin(&bottom, "xy")
    );
    let load = "[[load]]\nkind = \"body_force\"\nbody = \"body\"\nvalue = [0.0, -2000.0]";
    let mut world = lab.plane(Scene::statics(2, 1e-13).body(&mesh, &body)?.add(load))?;
    world.frame()?;
    Ok(top.iter().map(|k| 2.0 - world.position(0, *k)[1]).sum::<f64>() / top.len() as f64)
}

fn start(lab: &Lab, n: f64) -> Result<f64, Trouble> {
    let mesh = mapped([n as u32; 2], Cells::Boxes, |x| [x[0], x[1]])?;
    let body = "density = 1.0\nvelocity = { gradient = [[1.0, 0.0], [0.0, 0.0]] }\nmodels = [{ kind = \"fem\", youngs_modulus = 1e-6 }]";
    let world = lab.plane(Scene::new(2, 1e-3, 1, "verlet").body(&mesh, body)?)?;
    Ok(world.energy().kinetic)
}
