//! Finite volumes: patches, bars, tubes, Cook's membrane, waves and rubber.

use super::patches::{displaced, irregular, worst};
use super::{BASE, materials};
use crate::bodies::{Cells, at_radius, boundary, displacement, mapped, nodes, octant, outward, symmetric};
use crate::case::{Case, Check, Family, Over, Scale};
use crate::lab::{Lab, Scene, Trouble, moved_pins};

/// A pressure so small that the change of shape of the body does not matter, in units of E.
const SMALL: f64 = 1e-6;

const AFFINE: Case = Case {
    quantity: "largest deviation of inner nodes from the affine displacement that is prescribed on the boundary, neo-Hookean, finite volumes",
    unit: "m",
    source: "exact: the dual faces around an inner node form a closed surface (J. Teran, S. Blemker, V. Ng-Thow-Hing, R. Fedkiw 2003)",
    over: Over::Cells("cells along a side of 1 m"),
    levels: &[2.0, 3.0, 4.0],
    expected: &[0.0],
    scale: Scale::Of(1.0),
    tolerance: 1e-12,
    check: Check::Everywhere,
    quick: true,
    ..BASE
};

const BAR: Case = Case {
    quantity: "elongation of a hanging bar of 1 m, ρ = 1000 kg/m³, E = 125 kPa, finite volumes",
    source: "exact: ρgL²/2E",
    over: Over::Cells("cells along the bar"),
    levels: &[2.0, 4.0, 8.0],
    expected: &[0.03924],
    scale: Scale::Relative,
    tolerance: 1e-9,
    ..AFFINE
};

const TUBE: Case = Case {
    quantity: "displacement of the inner wall of a thick tube under inner pressure, times E/p; a = 1 m, b = 2 m, ν = 0.3, plane strain, finite volumes",
    unit: "m",
    source: "G. Lamé 1852: u(a) = (1 + ν)/E · p a²/(b² − a²) · ((1 − 2ν) a + b²/a)",
    over: Over::Cells("cells through the wall"),
    expected: &[1.906_666_666_666_666_7],
    levels: &[4.0, 8.0, 16.0],
    check: Check::Order(2.0),
    quick: true,
    ..BASE
};

const COOK: Case = Case {
    quantity: "upward displacement of the middle of the pulled side of Cook's membrane, linear, plane stress, E = 1, ν = 1/3, F = 1, finite volumes",
    unit: "m",
    source: "R. D. Cook 1974; limit 23.9676 from two other programs with 153,000 graded quadratic triangles; order 2λ = 1.354 from the corner \
singularity, M. L. Williams 1952",
    over: Over::Cells("cells along a side of the membrane"),
    levels: &[16.0, 32.0, 64.0],
    expected: &[23.9676],
    check: Check::Order(1.354),
    ..BASE
};

const WAVE: Case = Case {
    family: Family::Dynamics,
    quantity: "ωL/c of the slowest wave of a bar of triangles clamped at one end, finite volumes",
    source: "exact: π/2, f = c/4L",
    over: Over::Cells("cells along the bar"),
    levels: &[4.0, 8.0, 16.0],
    expected: &[std::f64::consts::FRAC_PI_2],
    check: Check::Order(2.0),
    quick: true,
    ..BASE
};

const RUBBER: Case = Case {
    family: Family::Materials,
    quantity: "force per area at rest on a cube under uniaxial stress, neo-Hookean, E = 100 kPa, ν = 0.45, finite volumes",
    unit: "Pa",
    source: "roots of the law's own equations ∂ψ/∂λ₂ = 0, P = ∂ψ/∂λ₁, in 30 digits",
    over: Over::Parameter("stretch"),
    levels: &[0.5, 0.8, 1.2, 1.5, 2.0, 3.0],
    expected: materials::NEO_HOOKEAN,
    tolerance: 1e-6,
    check: Check::Everywhere,
    quick: true,
    ..BASE
};

pub(super) const CASES: &[Case] = &[
    Case { name: "finite-volume-patch-triangles", measure: |lab, n| plane(lab, n, Cells::Linear), ..AFFINE },
    Case { name: "finite-volume-patch-quadrilaterals", measure: |lab, n| plane(lab, n, Cells::Boxes), ..AFFINE },
    Case { name: "finite-volume-patch-tetrahedra", measure: |lab, n| space(lab, n, Cells::Linear), ..AFFINE },
    Case { name: "finite-volume-patch-hexahedra", measure: |lab, n| space(lab, n, Cells::Boxes), ..AFFINE },
    Case { name: "finite-volume-hanging-bar-quadrilaterals", measure: |lab, n| bar(lab, n), ..BAR },
    Case { name: "finite-volume-lame-tube-triangles", measure: |lab, n| tube(lab, n, Cells::Linear), ..TUBE },
    Case { name: "finite-volume-lame-tube-quadrilaterals", measure: |lab, n| tube(lab, n, Cells::Boxes), ..TUBE },
    Case { name: "finite-volume-cook-triangles", measure: |lab, n| cook(lab, n, Cells::Linear), ..COOK },
    Case { name: "finite-volume-cook-quadrilaterals", measure: |lab, n| cook(lab, n, Cells::Boxes), ..COOK },
];

pub(super) const MATERIALS: &[Case] = &[
    Case {
        name: "finite-volume-uniaxial-stress-hexahedra",
        measure: |lab, x| pull(lab, "neo_hookean", Cells::Boxes, x),
        ..RUBBER
    },
    Case {
        name: "finite-volume-uniaxial-stress-linear",
        quantity: "force per area at rest on a cube of hexahedra under uniaxial stress, linear, E = 100 kPa, ν = 0.45, finite volumes",
        source: "exact: E (λ₁ − 1)",
        expected: materials::PULLED_STRAIGHT,
        measure: |lab, x| pull(lab, "linear", Cells::Boxes, x),
        ..RUBBER
    },
    Case {
        name: "finite-volume-uniaxial-stress-fixed-corotated",
        quantity: "force per area at rest on a cube of hexahedra under uniaxial stress, fixed corotated, E = 100 kPa, ν = 0.45, finite volumes",
        expected: materials::FIXED_COROTATED,
        measure: |lab, x| pull(lab, "fixed_corotated", Cells::Boxes, x),
        ..RUBBER
    },
    Case {
        name: "finite-volume-uniaxial-stress-st-venant-kirchhoff",
        quantity: "force per area at rest on a cube of hexahedra under uniaxial stress, St. Venant–Kirchhoff, E = 100 kPa, ν = 0.45, finite volumes",
        source: "exact: E (λ₁³ − λ₁)/2, largest in compression at 1/√3",
        levels: materials::KIRCHHOFF,
        expected: materials::PULLED_KIRCHHOFF,
        measure: |lab, x| pull(lab, "st_venant_kirchhoff", Cells::Boxes, x),
        ..RUBBER
    },
    Case {
        name: "finite-volume-uniaxial-stress-stable-neo-hookean",
        quantity: "force per area at rest on a cube of hexahedra under uniaxial stress, stable neo-Hookean, E = 100 kPa, ν = 0.45, finite volumes",
        expected: materials::STABLE_NEO_HOOKEAN,
        measure: |lab, x| pull(lab, "stable_neo_hookean", Cells::Boxes, x),
        ..RUBBER
    },
    Case {
        name: "finite-volume-uniaxial-stress-mooney-rivlin",
        quantity: "force per area at rest on a cube of hexahedra under uniaxial stress, Mooney–Rivlin, E = 100 kPa, ν = 0.45, finite volumes",
        expected: materials::MOONEY_RIVLIN,
        measure: |lab, x| pull(lab, "mooney_rivlin", Cells::Boxes, x),
        ..RUBBER
    },
    Case {
        name: "finite-volume-uniaxial-stress-tetrahedra",
        quantity: "force per area at rest on a cube of tetrahedra under uniaxial stress, stable neo-Hookean, E = 100 kPa, ν = 0.45, finite volumes",
        expected: materials::STABLE_NEO_HOOKEAN,
        measure: |lab, x| pull(lab, "stable_neo_hookean", Cells::Linear, x),
        ..RUBBER
    },
];

pub(super) const DYNAMICS: &[Case] = &[Case { name: "finite-volume-first-wave-triangles", measure: wave, ..WAVE }];

fn solid(law: &str) -> String {
    format!("models = [{{ kind = \"finite_volume\", {law} }}]")
}

fn patch<const D: usize>(mesh: &opruga::mesh::Mesh<D>) -> Result<Scene, Trouble> {
    let pins = moved_pins(boundary(mesh).into_iter().map(|k| (k, displaced(&mesh.positions[k as usize], false))));
    let law = solid("material = \"neo_hookean\", youngs_modulus = 1.0, poissons_ratio = 0.4");
    Scene::statics(D, 1e-13).body(mesh, &format!("density = 1.0\n{law}\n{pins}"))
}

fn plane(lab: &Lab, n: f64, cells: Cells) -> Result<f64, Trouble> {
    let mesh = irregular::<2>(n, cells)?;
    let mut world = lab.plane(patch(&mesh)?)?;
    world.frame()?;
    Ok(worst(&mesh, false, |node| world.position(0, node)))
}

fn space(lab: &Lab, n: f64, cells: Cells) -> Result<f64, Trouble> {
    let mesh = irregular::<3>(n, cells)?;
    let mut world = lab.space(patch(&mesh)?)?;
    world.frame()?;
    Ok(worst(&mesh, false, |node| world.position(0, node)))
}

fn bar(lab: &Lab, n: f64) -> Result<f64, Trouble> {
    let mesh = mapped([1, n as u32], Cells::Boxes, |x| [0.25 * x[0], x[1]])?;
    let (top, bottom) = (nodes(&mesh, |x| x[1] == 1.0), nodes(&mesh, |x| x[1] == 0.0));
    let law = solid("material = \"linear\", youngs_modulus = 125000.0, poissons_ratio = 0.0, plane = \"stress\"");
    let scene = Scene::statics(2, 1e-13)
        .add("[world]\ngravity = [0.0, -9.81]")
        .body(&mesh, &format!("density = 1000.0\n{law}\npin = [{{ select = {{ nodes = {top:?} }} }}]"))?;
    let mut world = lab.plane(scene)?;
    world.frame()?;
    Ok(-bottom.iter().map(|k| world.position(0, *k)[1]).sum::<f64>() / bottom.len() as f64)
}

/// Half of the difference between the results for pressure and suction. A pressure follows the wall, which adds a part of second order in the
/// pressure. This part cancels in the difference.
fn tube(lab: &Lab, n: f64, cells: Cells) -> Result<f64, Trouble> {
    let mesh = octant::<2>(n as u32, n as u32, Some(1.0), 2.0, cells)?;
    let inner = at_radius(&mesh, 1.0);
    let law = solid("material = \"linear\", youngs_modulus = 1.0, poissons_ratio = 0.3");
    let under = |pressure: f64| -> Result<f64, Trouble> {
        let scene = Scene::statics(2, 1e-13).body(&mesh, &format!("density = 1.0\n{law}\n{}", symmetric(&mesh)))?.add(
            &format!(
                "[[load]]\nkind = \"pressure\"\nbody = \"body\"\nselect = {{ nodes = {inner:?} }}\nvalue = {pressure:?}"
            ),
        );
        let mut world = lab.plane(scene)?;
        world.frame()?;
        Ok(outward(&world, &inner))
    };
    Ok((under(SMALL)? - under(-SMALL)?) / (2.0 * SMALL))
}

fn cook(lab: &Lab, n: f64, cells: Cells) -> Result<f64, Trouble> {
    let scene = Scene::statics(2, 1e-9).add(&format!(
        "[[body]]\nname = \"membrane\"\ndensity = 1.0\n\
         shape = {{ kind = \"quadrilateral\", corners = [[0, 0], [48, 44], [48, 60], [0, 44]], cells = [{n}, {n}] }}\n{}\n\
         {}\npin = [{{ select = {{ group = \"left\" }} }}]\n\
         [[load]]\nkind = \"traction\"\nbody = \"membrane\"\nselect = {{ group = \"right\" }}\nvalue = [0.0, 0.0625]",
        cells.fields(),
        solid("material = \"linear\", youngs_modulus = 1.0, poissons_ratio = 0.3333333333333333, plane = \"stress\"")
    ));
    let mut world = lab.plane(scene)?;
    world.frame()?;
    Ok(displacement(&world, [48.0, 52.0])[1])
}

fn wave(lab: &Lab, n: f64) -> Result<f64, Trouble> {
    let mesh = mapped([n as u32, 1], Cells::Linear, |x| [x[0], 0.1 * x[1]])?;
    let law = solid("material = \"linear\", youngs_modulus = 1.0, poissons_ratio = 0.0, plane = \"stress\"");
    let pins = format!(
        "pin = [{{ select = {{ nodes = {:?} }}, axes = \"x\" }}, {{ select = {{ all = true }}, axes = \"y\" }}]",
        nodes(&mesh, |x| x[0] == 0.0)
    );
    let world = lab.plane(Scene::new(2, 0.001, 1, "newmark").body(&mesh, &format!("density = 1.0\n{law}\n{pins}"))?)?;
    Ok(world.modes(0, 1)?.first().ok_or("too few modes")?.omega())
}

/// A cube between frictionless plates that are pulled apart in twenty steps. The cube consists of one box, which is cut into the given cells.
fn pull(lab: &Lab, material: &str, cells: Cells, stretch: f64) -> Result<f64, Trouble> {
    let scene = Scene::new(3, 0.05, 1, "equilibrium\ntolerance = 1e-11").add(&format!(
        "[[body]]\nname = \"cube\"\ndensity = 1.0\nshape = {{ kind = \"grid\", size = [1, 1, 1], cells = [1, 1, 1] }}\n{}\n{}\n\
         pin = [{{ select = {{ side = \"left\" }}, axes = \"x\" }}, {{ select = {{ side = \"bottom\" }}, axes = \"y\" }},\n\
         {{ select = {{ side = \"back\" }}, axes = \"z\" }},\n\
         {{ select = {{ side = \"right\" }}, axes = \"x\", motion = [[0, 0, 0, 0], [1, {:?}, 0, 0]] }}]",
        cells.fields(),
        solid(&format!("material = \"{material}\", youngs_modulus = 1e5, poissons_ratio = 0.45")),
        stretch - 1.0
    ));
    let mut world = lab.space(scene)?;
    for _ in 0..20 {
        world.frame()?;
    }
    let right = world.blueprint().bodies[0].mesh.groups["right"].clone();
    Ok(world.reaction(0, &right)[0])
}
