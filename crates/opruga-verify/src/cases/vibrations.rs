//! Natural frequencies of bars, beams, discs and balls, from the modes of bodies at rest.

use super::BASE;
use crate::bodies::{Cells, mapped, nodes, octant, symmetric};
use crate::case::{Case, Check, Family, Over};
use crate::lab::{Lab, Scene, Trouble};
use opruga::World;

const BEAM: Case = Case {
    family: Family::Dynamics,
    quantity: "(βL)² = ωL²√(ρA/EI) of the first bending mode of a beam of thickness L/50 clamped at one end",
    source: "L. Euler, D. Bernoulli: cos βL cosh βL = −1, βL = 1.875104069; finite slenderness lowers it by 2e-4",
    over: Over::Cells("cells along the beam"),
    expected: &[3.516_015_268_500_15],
    ..BASE
};

const DISC: Case = Case {
    family: Family::Dynamics,
    quantity: "ωa√(ρ(1 − ν²)/E) of the breathing of a free disc, plane stress, ν = 0.3",
    source: "A. E. H. Love, Treatise, art. 314 (b): x J₀(x) = (1 − ν) J₁(x)",
    over: Over::Cells("cells along the core of a quarter"),
    levels: &[2.0, 4.0, 8.0],
    expected: &[2.048850],
    check: Check::Order(2.0),
    ..BASE
};

const BALL: Case = Case {
    quantity: "ωa/c_p of the breathing of a free ball, ν = 0.3",
    source: "H. Lamb 1882; Love, Treatise, art. 196: the root of tan x/x = 1/(1 − x²(λ + 2μ)/4μ)",
    over: Over::Cells("cells along the core of an eighth"),
    levels: &[2.0, 4.0, 6.0],
    expected: &[2.670215],
    ..DISC
};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "beam-first-bending-quadratic-triangles",
        levels: &[10.0, 20.0, 40.0],
        quick: true,
        measure: |lab, n| beam(lab, [n as u32, 1], Cells::Quadratic, true, 0),
        ..BEAM
    },
    Case {
        name: "beam-second-bending-quadratic-triangles",
        quantity: "(βL)² = ωL²√(ρA/EI) of the second bending mode of a beam of thickness L/50 clamped at one end",
        source: "L. Euler, D. Bernoulli: cos βL cosh βL = −1, βL = 4.694091133; finite slenderness lowers it by 2e-3",
        levels: &[10.0, 20.0, 40.0],
        expected: &[22.034_491_564_666_77],
        measure: |lab, n| beam(lab, [n as u32, 1], Cells::Quadratic, true, 1),
        ..BEAM
    },
    Case {
        name: "beam-first-bending-quadrilaterals",
        // Changed after its first run, which had half as many cells along the beam: the spurious shear depends only on the ratio of the length of a
        // cell to the thickness.
        levels: &[100.0, 200.0, 400.0],
        measure: |lab, n| beam(lab, [n as u32, 4], Cells::Boxes, true, 0),
        ..BEAM
    },
    Case {
        name: "beam-free-quadratic-triangles",
        quantity: "(βL)² = ωL²√(ρA/EI) of the first bending mode of a free beam of thickness L/50",
        source: "L. Euler, D. Bernoulli: cos βL cosh βL = 1, βL = 4.730040745; finite slenderness lowers it by 1e-3",
        levels: &[10.0, 20.0, 40.0],
        expected: &[22.373_285_448_061_32],
        measure: |lab, n| beam(lab, [n as u32, 1], Cells::Quadratic, false, 3),
        ..BEAM
    },
    Case {
        name: "beam-first-bending-chain",
        quantity: "(βL)² = ωL²√(ρA/EI) of the first bending mode of a chain of hinges clamped at one end",
        source: "L. Euler, D. Bernoulli: cos βL cosh βL = −1, βL = 1.875104069",
        over: Over::Cells("segments"),
        levels: &[10.0, 20.0, 40.0],
        check: Check::Order(2.0),
        quick: true,
        measure: chain,
        ..BEAM
    },
    Case {
        name: "bar-first-wave",
        quantity: "ωL/c of the slowest wave of a bar clamped at one end",
        source: "exact: π/2, f = c/4L",
        over: Over::Cells("cells along the bar"),
        levels: &[4.0, 8.0, 16.0],
        expected: &[std::f64::consts::FRAC_PI_2],
        check: Check::Order(2.0),
        quick: true,
        measure: |lab, n| bar(lab, n, 0),
        ..BEAM
    },
    Case {
        name: "bar-third-wave",
        quantity: "ωL/c of the third longitudinal mode of a bar clamped at one end",
        source: "exact: 5π/2, f = 5c/4L",
        over: Over::Cells("cells along the bar"),
        levels: &[16.0, 32.0, 64.0],
        expected: &[5.0 * std::f64::consts::FRAC_PI_2],
        check: Check::Order(2.0),
        quick: true,
        measure: |lab, n| bar(lab, n, 2),
        ..BEAM
    },
    Case {
        name: "disc-breathes-quadrilaterals",
        quick: true,
        measure: |lab, n| Ok(disc(lab, n, Cells::Boxes, true)? * 0.91f64.sqrt()),
        ..DISC
    },
    Case {
        name: "disc-breathes-quadratic-triangles",
        measure: |lab, n| Ok(disc(lab, n, Cells::Quadratic, true)? * 0.91f64.sqrt()),
        ..DISC
    },
    Case {
        name: "disc-becomes-oval-quadrilaterals",
        quantity: "ωa/c_s of the slowest oval vibration of a free disc, plane stress, ν = 0.3",
        source: "Love, Treatise, art. 314 (b), two waves around: determinant of Bessel functions, 2.345561; 1.3876 in units of the plate's c_p",
        expected: &[2.345561],
        quick: true,
        measure: |lab, n| Ok(disc(lab, n, Cells::Boxes, false)? * 2.6f64.sqrt()),
        ..DISC
    },
    Case {
        name: "ball-breathes-hexahedra",
        measure: |lab, n| Ok(ball(lab, n, Cells::Boxes, Motion::Breathing)? / pressure_speed()),
        ..BALL
    },
    Case {
        name: "ball-becomes-oval-hexahedra",
        // Changed to start at 6 cells. With 2 to 4 cells, the errors due to the masses and to the stiffness have opposite signs and cancel (5e-4,
        // 6e-4, 4e-4).
        levels: &[6.0, 8.0, 12.0],
        quantity: "ωa/c_s of the slowest spheroidal vibration (l = 2) of a free ball, ν = 0.3",
        source: "H. Lamb 1882; Love, Treatise, art. 197: spheroidal vibrations, l = 2",
        expected: &[2.646217],
        measure: |lab, n| Ok(ball(lab, n, Cells::Boxes, Motion::Oval)? * 2.6f64.sqrt()),
        ..BALL
    },
    Case {
        name: "ball-becomes-oval-quadratic-tetrahedra",
        quantity: "ωa/c_s of the slowest spheroidal vibration (l = 2) of a free ball, ν = 0.3",
        source: "H. Lamb 1882; Love, Treatise, art. 197: spheroidal vibrations, l = 2",
        levels: &[1.0, 2.0, 3.0],
        expected: &[2.646217],
        measure: |lab, n| Ok(ball(lab, n, Cells::Quadratic, Motion::Oval)? * 2.6f64.sqrt()),
        ..BALL
    },
    Case {
        name: "ball-twists-hexahedra",
        quantity: "ωa/c_s of the slowest torsional vibration (l = 2) of a free ball",
        source: "H. Lamb 1882: j₂′(x) x = j₂(x), the halves turn against one another",
        expected: &[2.501133],
        measure: |lab, n| Ok(ball(lab, n, Cells::Boxes, Motion::Twist)? * 2.6f64.sqrt()),
        ..BALL
    },
];

/// The speed c_p of pressure waves for E = 1 Pa, ν = 0.3, ρ = 1 kg/m³.
fn pressure_speed() -> f64 {
    (0.7f64 / (1.3 * 0.4)).sqrt()
}

/// The lines of the scene for a linear solid of E = 1 Pa and ρ = 1 kg/m³.
fn solid(poisson: f64, plane: &str, pins: &str) -> String {
    format!(
        "density = 1.0\nmodels = [{{ kind = \"fem\", material = \"linear\", youngs_modulus = 1.0, poissons_ratio = {poisson:?}{plane} }}]\n{pins}"
    )
}

/// A scene in which no time passes. Any integrator without a limit on the step can be used.
fn still(dimension: usize) -> Scene {
    Scene::new(dimension, 0.001, 1, "newmark")
}

fn omega<const D: usize>(world: &World<D>, number: usize) -> Result<f64, Trouble> {
    Ok(world.modes(0, number + 1)?.get(number).ok_or("too few modes")?.omega())
}

fn beam(lab: &Lab, counts: [u32; 2], cells: Cells, clamped: bool, number: usize) -> Result<f64, Trouble> {
    let thickness: f64 = 0.02;
    let mesh = mapped(counts, cells, |x| [x[0], thickness * x[1]])?;
    let end = nodes(&mesh, |x| x[0] == 0.0);
    let pins = if clamped { format!("pin = [{{ select = {{ nodes = {end:?} }} }}]") } else { String::new() };
    let world = lab.plane(still(2).body(&mesh, &solid(0.0, ", plane = \"stress\"", &pins))?)?;
    Ok(omega(&world, number)? * 12.0f64.sqrt() / thickness)
}

fn chain(lab: &Lab, n: f64) -> Result<f64, Trouble> {
    // The clamp of two nodes is at the midpoint of the first segment.
    let l = 1.0 / (n - 0.5);
    let world = lab.plane(still(2).add(&format!(
        "[[body]]\nname = \"rod\"\nmass = {:?}\nshape = {{ kind = \"line\", from = [{:?}, 0.0], to = [1.0, 0.0], segments = {n} }}\n\
         models = [{{ kind = \"bending\", stiffness = {:?} }}, {{ kind = \"mass_spring\", stiffness = {:?} }}]\npin = [{{ select = {{ nodes = [0, 1] }} }}]",
        n * l,
        -0.5 * l,
        1.0 / l,
        1e5 / l
    )))?;
    omega(&world, 0)
}

fn bar(lab: &Lab, n: f64, number: usize) -> Result<f64, Trouble> {
    let mesh = mapped([n as u32, 1], Cells::Boxes, |x| [x[0], 0.1 * x[1]])?;
    let pins = format!(
        "pin = [{{ select = {{ nodes = {:?} }}, axes = \"x\" }}, {{ select = {{ all = true }}, axes = \"y\" }}]",
        nodes(&mesh, |x| x[0] == 0.0)
    );
    let world = lab.plane(still(2).body(&mesh, &solid(0.0, ", plane = \"stress\"", &pins))?)?;
    omega(&world, number)
}

/// Modes whose ω differ by less than this fraction are so close that a mesh mixes them.
const CLOSE_MODES: f64 = 0.03;

/// The angular frequency of the mode that is most similar to a uniform expansion. A mesh may mix this mode with neighbouring modes of other shapes.
/// The result is therefore the root of the mean of ω² over these modes, weighted by the part of the expansion in each of them.
fn breathing<const D: usize>(world: &World<D>, count: usize) -> Result<f64, Trouble> {
    let rest = &world.blueprint().bodies[0].mesh.positions;
    let likeness = |shape: &[[f64; D]]| -> f64 {
        let (mut along, mut square) = (0.0, 0.0);
        for (k, (x, v)) in rest.iter().zip(shape).enumerate() {
            let mass = world.node_mass(0, k as u32);
            along += mass * (0..D).map(|d| x[d] * v[d]).sum::<f64>();
            square += mass * x.iter().map(|c| c * c).sum::<f64>();
        }
        along.abs() / square.sqrt()
    };
    let modes = world.modes(0, count)?;
    let most = modes.iter().max_by(|a, b| likeness(&a.shape).total_cmp(&likeness(&b.shape))).ok_or("no modes")?;
    if likeness(&most.shape) < 0.7 {
        return Err("it does not breathe".into());
    }
    let close = modes.iter().filter(|mode| (mode.omega() / most.omega() - 1.0).abs() < CLOSE_MODES);
    let (mut square, mut whole) = (0.0, 0.0);
    for mode in close {
        let part = likeness(&mode.shape) * likeness(&mode.shape);
        square += part * mode.omega() * mode.omega();
        whole += part;
    }
    Ok((square / whole).sqrt())
}

fn disc(lab: &Lab, n: f64, cells: Cells, breathes: bool) -> Result<f64, Trouble> {
    let mesh = octant::<2>(n as u32, n as u32, None, 1.0, cells)?;
    let world = lab.plane(still(2).body(&mesh, &solid(0.3, ", plane = \"stress\"", &symmetric(&mesh)))?)?;
    if breathes { breathing(&world, 6) } else { omega(&world, 0) }
}

enum Motion {
    Breathing,
    Oval,
    Twist,
}

fn ball(lab: &Lab, n: f64, cells: Cells, motion: Motion) -> Result<f64, Trouble> {
    let mesh = octant::<3>(n as u32, n as u32, None, 1.0, cells)?;
    let pins = match motion {
        Motion::Twist => {
            // The motion is a rotation about z that is odd in z. Points in planes through the axis move only perpendicular to these planes, and
            // points in the plane of the equator do not move.
            let rows: Vec<String> = ["yz", "xz", "xy"]
                .iter()
                .enumerate()
                .map(|(d, axes)| {
                    format!("{{ select = {{ nodes = {:?} }}, axes = \"{axes}\" }}", nodes(&mesh, |x| x[d].abs() < 1e-9))
                })
                .collect();
            format!("pin = [{}]", rows.join(", "))
        }
        _ => symmetric(&mesh),
    };
    let world = lab.space(still(3).body(&mesh, &solid(0.3, "", &pins))?)?;
    if matches!(motion, Motion::Breathing) { breathing(&world, 20) } else { omega(&world, 0) }
}
