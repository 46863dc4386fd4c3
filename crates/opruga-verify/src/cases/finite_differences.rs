//! Finite differences: rods, rings, plates, columns and bars.

use super::BASE;
use crate::bodies::displacement;
use crate::case::{Case, Check, Family, Over};
use crate::lab::{Lab, Scene, Trouble};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

const ROD: Case = Case { over: Over::Cells("segments"), check: Check::Order(2.0), quick: true, ..BASE };

const BEAM: Case = Case {
    family: Family::Dynamics,
    source: "L. Euler, D. Bernoulli: cos βL cosh βL = −1",
    levels: &[10.0, 20.0, 40.0],
    ..ROD
};

const COLUMN: Case = Case {
    family: Family::Materials,
    over: Over::Parameter("stretch"),
    levels: &[0.7, 0.8, 0.9, 1.2, 1.5],
    tolerance: 1e-6,
    check: Check::Everywhere,
    quick: true,
    ..BASE
};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "finite-difference-elastica",
        quantity: "deflection of the tip of a clamped rod under a transverse force, divided by its length, PL²/EI = 2",
        source: "K. E. Bisshopp, D. C. Drucker 1945, elliptic integrals; confirmed by shooting",
        levels: &[10.0, 20.0, 40.0, 80.0],
        expected: &[0.493457],
        measure: elastica,
        ..ROD
    },
    Case {
        name: "finite-difference-roll-up",
        quantity: "moment that keeps a straight rod of 1 m with EI = 1 N m² rolled up into a closed circle",
        unit: "N m",
        source: "exact: M = 2π EI/L",
        levels: &[12.0, 24.0, 48.0],
        expected: &[TAU],
        measure: |lab, n| super::beams::roll_up_by(lab, n, &stiff()),
        ..ROD
    },
    Case {
        name: "finite-difference-euler-column",
        quantity: "force under which a rod clamped at one end buckles, times L²/EI",
        source: "L. Euler 1744: π²EI/4L²",
        levels: &[10.0, 20.0, 40.0],
        expected: &[PI * PI / 4.0],
        measure: column_buckles,
        ..ROD
    },
    Case {
        name: "finite-difference-square-plate",
        quantity: "deflection of the middle of a square plate with simply supported sides under a uniform load, w D/q a⁴",
        source: "S. Timoshenko, S. Woinowsky-Krieger, Theory of Plates and Shells, table 8, by Navier's series",
        over: Over::Cells("cells along a side"),
        levels: &[8.0, 16.0, 32.0],
        expected: &[0.004_062_353_2],
        measure: |lab, n| plate(lab, [n, n], true),
        ..ROD
    },
    Case {
        name: "finite-difference-cylindrical-bending",
        quantity: "deflection of the middle of a strip of ν = 0 between two simple supports under a uniform load, w D/q L⁴",
        source: "L. Euler, D. Bernoulli: 5/384",
        over: Over::Cells("cells along the strip"),
        levels: &[8.0, 16.0, 32.0],
        expected: &[5.0 / 384.0],
        measure: |lab, n| plate(lab, [n, 2.0], false),
        ..ROD
    },
];

pub(super) const MATERIALS: &[Case] = &[
    Case {
        name: "finite-difference-uniaxial-stress",
        quantity: "force per area at rest on a block under uniaxial stress, E = 100 kPa, ν = 0.45",
        unit: "Pa",
        source: "exact: E λ (λ² − 1)/2; it is largest in compression at λ = 1/√3, beyond which the law softens",
        expected: &[-17_850.0, -14_400.0, -8_550.0, 26_400.0, 93_750.0],
        measure: |lab, stretch| Ok(block(lab, stretch)?[0]),
        ..COLUMN
    },
    Case {
        name: "finite-difference-uniaxial-narrowing",
        quantity: "lateral stretch of a block under uniaxial stress, E = 100 kPa, ν = 0.45",
        source: "exact: √(1 − ν (λ² − 1))",
        expected: &[
            1.108_828_210_319_344_3,
            1.077_961_038_256_949_1,
            1.041_873_312_836_066_4,
            0.895_544_527_089_523_8,
            0.661_437_827_766_147_7,
        ],
        measure: |lab, stretch| Ok(block(lab, stretch)?[1]),
        ..COLUMN
    },
    Case {
        name: "finite-difference-turning-point",
        quantity: "stiffness of a block at the stretch 1/√3, relative to that at rest: the slope of the force between 0.577 and 0.5777",
        source: "exact: (3λ² − 1)/2 is zero at 1/√3",
        over: Over::Parameter("difference of two stretches about 1/√3"),
        levels: &[0.002, 0.001],
        scale: crate::case::Scale::Of(1.0),
        tolerance: 1e-5,
        measure: turning_point,
        ..COLUMN
    },
];

const RING: Case = Case { family: Family::Pressure, unit: "N/m", levels: &[16.0, 32.0, 64.0], ..ROD };

pub(super) const PRESSURE: &[Case] = &[
    Case {
        name: "finite-difference-ring-buckles",
        quantity: "outer pressure at which a ring of EI = 1 N m², R = 1 m, buckles",
        source: "M. Lévy 1884: 3EI/R³ for the pressure of a fluid",
        expected: &[3.0],
        measure: ring_buckles,
        ..RING
    },
    Case {
        name: "finite-difference-ring-buckles-dead-load",
        quantity: "load per length of the circle, of fixed direction, at which a ring of EI = 1 N m², R = 1 m, buckles; four points on the axes, \
which do not move along the circle, are pinned in that direction",
        source: "J. Singer, C. D. Babcock 1970: 4EI/R³ for a load that keeps its direction, if the ring does not turn",
        expected: &[4.0],
        measure: ring_buckles_under_dead_load,
        ..RING
    },
    Case {
        name: "finite-difference-ring-buckles-centred-load",
        quantity: "load towards the centre of the circle at which a ring of EI = 1 N m², R = 1 m, buckles",
        source: "J. Singer, C. D. Babcock 1970: 4.5EI/R³ for a load that stays directed towards the centre",
        expected: &[4.5],
        measure: ring_buckles_under_centred_load,
        ..RING
    },
];

pub(super) const DYNAMICS: &[Case] = &[
    Case {
        name: "finite-difference-beam-first",
        quantity: "(βL)² = ωL²√(ρA/EI) of the first bending mode of a rod clamped at one end",
        expected: &[3.516_015_268_5],
        measure: |lab, n| beam(lab, n, 0),
        ..BEAM
    },
    Case {
        name: "finite-difference-beam-second",
        quantity: "(βL)² = ωL²√(ρA/EI) of the second bending mode of a rod clamped at one end",
        levels: &[20.0, 40.0, 80.0],
        expected: &[22.034_491_564_7],
        measure: |lab, n| beam(lab, n, 1),
        ..BEAM
    },
    Case {
        name: "finite-difference-beam-third",
        quantity: "(βL)² = ωL²√(ρA/EI) of the third bending mode of a rod clamped at one end",
        levels: &[20.0, 40.0, 80.0],
        expected: &[61.697_214_413_9],
        measure: |lab, n| beam(lab, n, 2),
        ..BEAM
    },
    Case {
        name: "finite-difference-beam-fourth",
        quantity: "(βL)² = ωL²√(ρA/EI) of the fourth bending mode of a rod clamped at one end",
        levels: &[40.0, 80.0, 160.0],
        expected: &[120.901_916_075],
        measure: |lab, n| beam(lab, n, 3),
        ..BEAM
    },
    Case {
        name: "finite-difference-free-ring",
        quantity: "ωR²√(ρA/EI) of the oval mode of a free ring",
        source: "R. Hoppe 1871: n (n² − 1)/√(n² + 1), n = 2",
        levels: &[16.0, 32.0, 64.0],
        expected: &[2.683_281_572_999_747_7],
        measure: free_ring,
        ..BEAM
    },
    Case {
        name: "finite-difference-bar-first-wave",
        quantity: "ωL/c of the slowest wave of a plane bar clamped at one end",
        source: "exact: π/2",
        over: Over::Cells("cells along the bar"),
        levels: &[4.0, 8.0, 16.0],
        expected: &[FRAC_PI_2],
        measure: |lab, n| bar(lab, n, 0),
        ..BEAM
    },
    Case {
        name: "finite-difference-bar-third-wave",
        quantity: "ωL/c of the third longitudinal mode of a plane bar clamped at one end",
        source: "exact: 5π/2",
        over: Over::Cells("cells along the bar"),
        levels: &[16.0, 32.0, 64.0],
        expected: &[5.0 * FRAC_PI_2],
        measure: |lab, n| bar(lab, n, 2),
        ..BEAM
    },
];

/// The thickness of a rod that hardly stretches. In `stiff`, E is chosen so that EI = 1 N m² per metre of depth.
const THIN: f64 = 1e-3;
fn stiff() -> String {
    format!(
        "models = [{{ kind = \"finite_difference\", thickness = {THIN:?}, youngs_modulus = {:?} }}]",
        12.0 / (THIN * THIN * THIN)
    )
}

/// A rod of n segments from −½ℓ to 1, clamped by two nodes at the midpoint of the first segment.
fn rod(n: f64, mass: f64) -> String {
    let l = 1.0 / (n - 0.5);
    format!(
        "[[body]]\nname = \"rod\"\nmass = {mass:?}\n\
         shape = {{ kind = \"line\", from = [{:?}, 0.0], to = [1.0, 0.0], segments = {n} }}\n{}\n\
         pin = [{{ select = {{ nodes = [0, 1] }} }}]\n",
        -0.5 * l,
        stiff()
    )
}

fn elastica(lab: &Lab, n: f64) -> Result<f64, Trouble> {
    let load = format!("[[load]]\nkind = \"force\"\nbody = \"rod\"\nselect = {{ node = {n} }}\nvalue = [0.0, -2.0]");
    let scene = Scene::statics(2, 1e-8).add(&format!("load_steps = 8\n{}{load}", rod(n, 1.0)));
    let mut world = lab.plane(scene)?;
    world.frame()?;
    Ok(-displacement(&world, [1.0, 0.0])[1])
}

/// The load at which the square of the lowest frequency is zero, found by linear extrapolation from two loads.
fn critical(loads: [f64; 2], square: impl Fn(f64) -> Result<f64, Trouble>) -> Result<f64, Trouble> {
    let [low, high] = [square(loads[0])?, square(loads[1])?];
    Ok(loads[0] + (loads[1] - loads[0]) * low / (low - high))
}

fn column_buckles(lab: &Lab, n: f64) -> Result<f64, Trouble> {
    critical([2.2, 2.4], |load| {
        let push = format!(
            "[[load]]\nkind = \"force\"\nbody = \"rod\"\nselect = {{ node = {n} }}\nvalue = [{:?}, 0.0]",
            -load
        );
        let mut world = lab.plane(Scene::statics(2, 1e-9).add(&(rod(n, n) + &push)))?;
        world.frame()?;
        Ok(world.modes(0, 1)?.first().ok_or("no modes")?.square)
    })
}

fn ring(n: f64, pins: &str) -> String {
    format!(
        "[[body]]\nname = \"ring\"\nmass = 1.0\nshape = {{ kind = \"ring\", radius = 1.0, vertices = {n} }}\n{}\n{pins}\n",
        stiff()
    )
}

/// The pressure at which the lowest frequency of a pinned ring falls to zero.
fn ring_loses_its_roundness(lab: &Lab, n: f64, pins: &str, load: impl Fn(f64) -> String) -> Result<f64, Trouble> {
    critical([1.0, 2.0], |pressure| {
        let mut world = lab.plane(Scene::statics(2, 1e-8).add(&(ring(n, pins) + &load(pressure))))?;
        world.frame()?;
        Ok(world.modes(0, 1)?.first().ok_or("no modes")?.square)
    })
}

fn ring_buckles(lab: &Lab, n: f64) -> Result<f64, Trouble> {
    ring_loses_its_roundness(lab, n, &super::pressure::ring_pins(n as u32), |pressure| {
        format!("[[load]]\nkind = \"pressure\"\nbody = \"ring\"\nvalue = {pressure:?}")
    })
}

/// Pins the ring in the tangential direction at its four points on the axes. The ring then cannot rotate. The pins allow its oval motion, which has
/// no tangential component at these points.
fn tangential_pins(n: f64) -> String {
    let count = n as u32;
    format!(
        "pin = [{{ select = {{ nodes = [0, {}] }}, axes = \"y\" }}, {{ select = {{ nodes = [{}, {}] }}, axes = \"x\" }}]",
        count / 2,
        count / 4,
        3 * (count / 4)
    )
}

/// The force of a pressure on a node: half of the forces on its two edges, which have the length 2 sin π/n. The force on an edge is along its normal.
fn node_force(n: f64, pressure: f64) -> f64 {
    pressure * (TAU / n).sin()
}

/// The pressure at which a ring buckles under dead load: the nodes carry the forces of this pressure on the round ring, and the directions of these
/// forces do not change.
fn ring_buckles_under_dead_load(lab: &Lab, n: f64) -> Result<f64, Trouble> {
    ring_loses_its_roundness(lab, n, &tangential_pins(n), |pressure| {
        let force = -node_force(n, pressure);
        let load = |node: u32| {
            let angle = TAU * f64::from(node) / n;
            format!(
                "[[load]]\nkind = \"force\"\nbody = \"ring\"\nselect = {{ node = {node} }}\nvalue = [{:?}, {:?}]\n",
                force * angle.cos(),
                force * angle.sin()
            )
        };
        (0..n as u32).map(load).collect()
    })
}

fn ring_buckles_under_centred_load(lab: &Lab, n: f64) -> Result<f64, Trouble> {
    ring_loses_its_roundness(lab, n, &tangential_pins(n), |pressure| {
        let force = node_force(n, pressure);
        format!("[[load]]\nkind = \"central_force\"\nbody = \"ring\"\nvalue = {force:?}\ncenter = [0.0, 0.0]")
    })
}

/// A scene in which no time passes. Any integrator without a limit on the step can be used.
fn still(dimension: usize) -> Scene {
    Scene::new(dimension, 0.001, 1, "newmark")
}

fn beam(lab: &Lab, n: f64, number: usize) -> Result<f64, Trouble> {
    // The part of the rod beyond the clamp is 1 m long and half a segment shorter than the whole rod. Its mass is 1 kg.
    let world = lab.plane(still(2).add(&rod(n, n / (n - 0.5))))?;
    Ok(world.modes(0, number + 1)?.get(number).ok_or("too few modes")?.omega())
}

fn free_ring(lab: &Lab, n: f64) -> Result<f64, Trouble> {
    let world = lab.plane(still(2).add(&ring(n, "")))?;
    let omega = world.modes(0, 4)?.get(3).ok_or("too few modes")?.omega();
    // The mass of 1 kg is distributed over the length 2πR.
    Ok(omega / TAU.sqrt())
}

/// A plate of 1 m length with D = 1 N m under a load of 0.01 N/m², which deflects by at most a two-hundredth of its thickness.
fn plate(lab: &Lab, [n, across]: [f64; 2], square: bool) -> Result<f64, Trouble> {
    let (poisson, width) = if square { (0.3, 1.0) } else { (0.0, across / n) };
    let thickness: f64 = 0.01;
    let young = 12.0 * (1.0 - poisson * poisson) / (thickness * thickness * thickness);
    let sides = if square { &["left", "right", "bottom", "top"][..] } else { &["left", "right"] };
    let mut pins: Vec<String> =
        sides.iter().map(|side| format!("{{ select = {{ group = \"{side}\" }}, axes = \"z\" }}")).collect();
    // In the plane of the plate, the pins prevent only rigid motions.
    pins.push("{ select = { node = 0 }, axes = \"xy\" }".into());
    pins.push(format!("{{ select = {{ node = {n} }}, axes = \"y\" }}"));
    let scene = Scene::statics(3, 1e-11).add(&format!(
        "[world]\ngravity = [0.0, 0.0, -0.01]\n[[body]]\nname = \"plate\"\nmass = {width:?}\n\
         shape = {{ kind = \"sheet\", corner = [0, 0, 0], u = [1, 0, 0], v = [0, {width:?}, 0], cells = [{n}, {across}] }}\n\
         models = [{{ kind = \"finite_difference\", youngs_modulus = {young:?}, poissons_ratio = {poisson:?}, thickness = {thickness:?} }}]\n\
         pin = [{}]",
        pins.join(", ")
    ));
    let mut world = lab.space(scene)?;
    world.frame()?;
    Ok(-displacement(&world, [0.5, 0.5 * width, 0.0])[2] / 0.01)
}

/// The force on a block of 1 m³ between frictionless plates, and its lateral stretch.
fn block(lab: &Lab, stretch: f64) -> Result<[f64; 2], Trouble> {
    let scene = Scene::new(3, 0.05, 1, "equilibrium\ntolerance = 1e-11").add(&format!(
        "[[body]]\nname = \"block\"\ndensity = 1.0\nshape = {{ kind = \"grid\", size = [1, 1, 1], cells = [2, 2, 1] }}\n\
         models = [{{ kind = \"finite_difference\", youngs_modulus = 1e5, poissons_ratio = 0.45 }}]\n\
         pin = [{{ select = {{ side = \"left\" }}, axes = \"x\" }}, {{ select = {{ side = \"bottom\" }}, axes = \"y\" }},\n\
         {{ select = {{ side = \"back\" }}, axes = \"z\" }},\n\
         {{ select = {{ side = \"right\" }}, axes = \"x\", motion = [[0, 0, 0, 0], [1, {:?}, 0, 0]] }}]",
        stretch - 1.0
    ));
    let mut world = lab.space(scene)?;
    for _ in 0..20 {
        world.frame()?;
    }
    let right = world.blueprint().bodies[0].mesh.groups["right"].clone();
    Ok([world.reaction(0, &right)[0], 1.0 + displacement(&world, [1.0; 3])[1]])
}

fn turning_point(lab: &Lab, difference: f64) -> Result<f64, Trouble> {
    let middle = 3.0f64.sqrt().recip();
    let [low, high] = [block(lab, middle - 0.5 * difference)?[0], block(lab, middle + 0.5 * difference)?[0]];
    Ok((high - low) / difference / 1e5)
}

/// A bar in plane stress with ν = 0 and c = 1 m/s.
fn bar(lab: &Lab, n: f64, number: usize) -> Result<f64, Trouble> {
    let world = lab.plane(still(2).add(&format!(
        "[[body]]\nname = \"bar\"\ndensity = 1.0\nshape = {{ kind = \"grid\", size = [1.0, 0.1], cells = [{n}, 1] }}\n\
         models = [{{ kind = \"finite_difference\", youngs_modulus = 1.0, poissons_ratio = 0.0, plane = \"stress\" }}]\n\
         pin = [{{ select = {{ side = \"left\" }}, axes = \"x\" }}, {{ select = {{ all = true }}, axes = \"y\" }}]"
    )))?;
    Ok(world.modes(0, number + 1)?.get(number).ok_or("too few modes")?.omega())
}
