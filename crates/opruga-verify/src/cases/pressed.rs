//! Bodies at rest that press on one another: patches, Hertz's contact with an obstacle, stacks.

use super::BASE;
use crate::bodies::{Cells, mapped, nodes};
use crate::case::{Case, Check, Over, Scale};
use crate::lab::{Lab, Scene, Trouble};
use opruga::World;
use opruga::mesh::Mesh;
use std::cell::Cell;

const PATCH: Case = Case {
    quantity: "two blocks with non-matching meshes are pressed together: largest relative deviation of the pressure on a node from the applied \
pressure",
    source: "exact: uniform pressure (R. L. Taylor, P. Papadopoulos 1991, contact patch test)",
    over: Over::Cells("cells along a side of the lower block; one more along that of the upper block"),
    levels: &[2.0, 3.0, 4.0],
    expected: &[0.0],
    scale: Scale::Of(1.0),
    tolerance: 1e-6,
    check: Check::Everywhere,
    ..BASE
};

pub(super) const BARRIER: Case = Case {
    over: Over::Parameter("reach of the barrier [m]"),
    levels: &[2e-5, 1e-5, 5e-6],
    tolerance: 0.01,
    check: Check::Order(1.0),
    ..PATCH
};

const STACK: Case = Case {
    quantity: "force between a solid at rest and the one that it stands on, relative to its weight, by backward Euler at 1/60 s",
    source: "exact: 1 (I. Newton)",
    expected: &[1.0],
    tolerance: 1e-6,
    check: Check::Everywhere,
    ..BASE
};

pub(super) const CASES: &[Case] = &[
    Case { name: "contact-patch-triangles", measure: |lab, n| pressures::<2>(lab, n, Cells::Linear), ..PATCH },
    Case { name: "contact-patch-quadrilaterals", measure: |lab, n| pressures::<2>(lab, n, Cells::Boxes), ..PATCH },
    Case { name: "contact-patch-tetrahedra", measure: |lab, n| pressures::<3>(lab, n, Cells::Linear), ..PATCH },
    Case {
        name: "contact-patch-hexahedra",
        levels: &[2.0, 3.0],
        measure: |lab, n| pressures::<3>(lab, n, Cells::Boxes),
        ..PATCH
    },
    Case {
        name: "contact-patch-barrier",
        measure: |lab, reach| Ok(patch::<2>(lab, 3.0, Cells::Linear, Some(reach), DAMPED)?.worst),
        ..BARRIER
    },
    Case {
        name: "barrier-reaches-constraint",
        quantity: "difference in height of a block that presses on another one, between a barrier and a constraint",
        source: "in the limit of a vanishing reach: the constraint",
        unit: "m",
        // The amount by which the pressure reduces the height of each block.
        scale: Scale::Of(1e-3),
        measure: |lab, reach| {
            let by = |reach| Ok::<f64, Trouble>(patch::<2>(lab, 3.0, Cells::Linear, reach, DAMPED)?.height);
            Ok(by(Some(reach))? - by(None)?)
        },
        ..BARRIER
    },
    Case {
        name: "hertz-line",
        quantity: "half width of the contact between a cylinder of 1 m and a plane, relative to Hertz's value at the same force, plane strain",
        source: "closed form: √(4 F R/(π E*)), E* = E/(1 − ν²) (H. Hertz 1882)",
        over: Over::Cells("cells along half of the width"),
        levels: &[16.0, 32.0, 64.0],
        expected: &[1.0],
        measure: hertz_line,
        ..BASE
    },
    Case {
        name: "weight-on-body-masses",
        over: Over::Parameter("mass of the upper body divided by that of the lower one"),
        levels: &[1e-4, 1e4],
        measure: |lab, ratio| weight(lab, "backward_euler", "", ratio, 1.0),
        ..STACK
    },
    Case {
        name: "weight-on-body-barrier",
        over: Over::Parameter("mass of the upper body divided by that of the lower one"),
        levels: &[0.01, 1.0, 100.0],
        measure: |lab, ratio| weight(lab, "backward_euler", "response = \"barrier\"\n", ratio, 1.0),
        ..STACK
    },
    Case {
        name: "weight-on-body-stiffness",
        over: Over::Parameter("stiffness of the upper body divided by that of the lower one"),
        levels: &[1e-4, 1e4],
        measure: |lab, ratio| weight(lab, "backward_euler", "", 1.0, ratio),
        ..STACK
    },
];

/// A block of equal cells whose lowest corner is at a given height. Its inner nodes are moved at random by up to an eighth of a cell.
fn block<const D: usize>(n: u32, cells: Cells, height: f64) -> Result<Mesh<D>, Trouble> {
    let random = Cell::new(11u64);
    mapped([n; D], cells, |x| {
        let inside = x.iter().all(|c| (1e-9..1.0 - 1e-9).contains(c));
        let mut out = x;
        for c in &mut out {
            random.set(random.get().wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407));
            let by = 0.25 / f64::from(n) * ((random.get() >> 11) as f64 / (1u64 << 53) as f64 - 0.5);
            *c += if inside { by } else { 0.0 };
        }
        out[1] += height;
        out
    })
}

/// A row of `pin = [ … ]` that pins the nodes that satisfy a condition along an axis.
fn pinned<const D: usize>(mesh: &Mesh<D>, axis: usize, which: impl Fn(&[f64; D]) -> bool) -> String {
    format!("{{ select = {{ nodes = {:?} }}, axes = \"{}\" }}", nodes(mesh, which), ["x", "y", "z"][axis])
}

/// Pins that let the sides of a block slide on walls.
fn walls<const D: usize>(mesh: &Mesh<D>) -> Vec<String> {
    let side = |c: f64| c.abs() < 1e-9 || (c - 1.0).abs() < 1e-9;
    (0..D).filter(|d| *d != 1).map(|d| pinned(mesh, d, |x| side(x[d]))).collect()
}

fn solid(law: &str, pins: &[String]) -> String {
    format!(
        "mass = 1000.0\nmodels = [{{ kind = \"fem\", youngs_modulus = 1e6, poissons_ratio = 0.3{law} }}]\npin = [{}]\n",
        pins.join(",\n  ")
    )
}

/// For each node, its part of the boundary at a given height: an area, or a length in the plane.
fn shares<const D: usize>(mesh: &Mesh<D>, height: f64) -> Vec<f64> {
    let surface = mesh.touching_surface(true);
    let (positions, mut of_points) = (surface.positions(&mesh.positions), vec![0.0; surface.points()]);
    for facet in &surface.facets {
        let corners: Vec<[f64; D]> = facet.iter().map(|point| positions[*point as usize]).collect();
        if corners.iter().any(|x| (x[1] - height).abs() > 1e-9) {
            continue;
        }
        let edge = |k: usize, d: usize| corners[k][d] - corners[0][d];
        let measure = if D == 2 {
            edge(1, 0).abs()
        } else {
            0.5 * (edge(1, 0) * edge(2, D - 1) - edge(2, 0) * edge(1, D - 1)).abs()
        };
        facet.iter().for_each(|point| of_points[*point as usize] += measure / D as f64);
    }
    let (nodes, carried) = of_points.split_at_mut(surface.nodes.len());
    for (carrier, share) in surface.carried.iter().zip(carried) {
        carrier.nodes.iter().zip(&carrier.weights).for_each(|(node, weight)| nodes[*node as usize] += weight * *share);
    }
    let mut out = vec![0.0; mesh.positions.len()];
    surface.nodes.iter().zip(nodes).for_each(|(node, share)| out[*node as usize] = *share);
    out
}

/// The largest relative error of the pressure in the patch test, if contact is a constraint.
fn pressures<const D: usize>(lab: &Lab, n: f64, cells: Cells) -> Result<f64, Trouble>
where
    Lab: Worlds<D>,
{
    Ok(patch(lab, n, cells, None, DAMPED)?.worst)
}

/// The largest relative error of the pressure in the patch test with statics, if contact is a constraint.
pub(super) fn pressures_at_rest(lab: &Lab, n: f64) -> Result<f64, Trouble> {
    Ok(patch::<2>(lab, n, Cells::Boxes, None, "equilibrium")?.worst)
}

/// The largest relative error of the pressure in the patch test with statics, if contact is a barrier of a given reach [m].
pub(super) fn patch_at_rest_by_barrier(lab: &Lab, reach: f64) -> Result<f64, Trouble> {
    Ok(patch::<2>(lab, 3.0, Cells::Linear, Some(reach), "equilibrium")?.worst)
}

/// An integrator that damps all motion, so that bodies come to rest in steps of 0.1 s.
const DAMPED: &str = "backward_euler";

/// The results for two blocks.
struct Patch {
    /// The largest relative error of the pressure on a node.
    worst: f64,
    /// The mean height of the nodes at the top [m].
    height: f64,
}

/// Brings two blocks without friction to rest, the upper one under a pressure of 1 kPa. Contact is a constraint or a barrier. If it is a barrier of a
/// given reach [m], the blocks start outside of this reach.
fn patch<const D: usize>(lab: &Lab, n: f64, cells: Cells, reach: Option<f64>, rule: &str) -> Result<Patch, Trouble>
where
    Lab: Worlds<D>,
{
    let (thickness, pressure) = (1e-3, 1e3);
    let gap = thickness + reach.unwrap_or(0.0);
    let barrier = reach.map_or(String::new(), |reach| format!("response = \"barrier\"\nreach = {reach:?}\n"));
    let (lower, upper) = (block::<D>(n as u32, cells, 0.0)?, block::<D>(n as u32 + 1, cells, 1.0 + gap)?);
    let bottom = pinned(&lower, 1, |x| x[1].abs() < 1e-9);
    let mut value = vec!["0.0".to_string(); D];
    value[1] = format!("{:?}", -pressure);
    let top = nodes(&upper, |x| (x[1] - 2.0 - gap).abs() < 1e-9);
    let scene = Scene::new(D, 0.1, 1, rule)
        .add(&format!("[contact]\nthickness = {thickness:?}\nself = false\n{barrier}"))
        .named("lower", &lower, &solid("", &[walls(&lower), vec![bottom]].concat()))?
        .named("upper", &upper, &solid("", &walls(&upper)))?
        .add(&format!(
            "[[load]]\nkind = \"traction\"\nbody = \"upper\"\nvalue = [{}]\nselect = {{ nodes = {top:?} }}",
            value.join(", ")
        ));
    let mut world = lab.world(scene)?;
    for _ in 0..if rule == DAMPED { 60 } else { 1 } {
        world.frame()?;
    }
    let forces = world.contact_forces(1);
    let mut worst: f64 = 0.0;
    for (force, share) in forces.iter().zip(shares(&upper, 1.0 + gap)).filter(|(_, share)| *share > 0.0) {
        worst = worst.max((force[1] / share / pressure - 1.0).abs());
    }
    let height = top.iter().map(|node| world.position(1, *node)[1]).sum::<f64>() / top.len() as f64;
    Ok(Patch { worst, height })
}

/// Access to worlds of either dimension.
pub(super) trait Worlds<const D: usize> {
    fn world(&self, scene: Scene) -> Result<World<D>, Trouble>;
}

impl Worlds<2> for Lab {
    fn world(&self, scene: Scene) -> Result<World<2>, Trouble> {
        self.plane(scene)
    }
}

impl Worlds<3> for Lab {
    fn world(&self, scene: Scene) -> Result<World<3>, Trouble> {
        self.space(scene)
    }
}

/// A part of a cylinder with a radius of 1 m about the origin. This part extends from x = 0 to `width`, and from the surface up to the height of the
/// axis. Cells near the lowest line are small.
fn lens(n: u32, width: f64) -> Result<Mesh<2>, Trouble> {
    mapped([n; 2], Cells::Boxes, |[s, t]| {
        let x = width * s * s;
        [x, -(1.0 - x * x).sqrt() * (1.0 - t * t)]
    })
}

/// The width of the contact of a cylinder that is pressed onto a plane by 1 cm, divided by Hertz's width for the same force. For Hertz's pressure, ∫
/// p x² = F a²/4.
fn hertz_line(lab: &Lab, n: f64) -> Result<f64, Trouble> {
    let mesh = lens(n as u32, 0.85)?;
    let top = nodes(&mesh, |x| x[1].abs() < 1e-9);
    let pins = format!(
        "pin = [{}, {{ select = {{ nodes = {top:?} }}, motion = [[0, 0, 0], [1, 0, -0.01]] }}]",
        pinned(&mesh, 0, |x| x[0].abs() < 1e-9)
    );
    let scene =
        Scene::statics(2, 1e-9).add("[[collider]]\nkind = \"half_space\"\npoint = [0, -1]\nnormal = [0, 1]").body(
            &mesh,
            &format!("mass = 1.0\nmodels = [{{ kind = \"fem\", youngs_modulus = 1e6, poissons_ratio = 0.3 }}]\n{pins}"),
        )?;
    let mut world = lab.plane(scene)?;
    world.frame()?;
    let (mut force, mut moment) = (0.0, 0.0);
    for (node, push) in world.contact_forces(0).iter().enumerate() {
        let x = world.position(0, node as u32)[0];
        force += push[1];
        moment += push[1] * x * x;
    }
    let young = 1e6 / (1.0 - 0.3 * 0.3);
    Ok(2.0 * (moment / force).sqrt() / (4.0 * 2.0 * force / (std::f64::consts::PI * young)).sqrt())
}

/// The force between two blocks after 5 s, divided by the weight of the upper one. The mass and the stiffness of the upper block are multiples of the
/// mass and the stiffness of the lower block, with the given factors. The stiffness of both blocks grows with the mass of the upper one, so that it
/// compresses the lower one equally in all cases.
pub(super) fn weight(lab: &Lab, rule: &str, contact: &str, masses: f64, stiffness: f64) -> Result<f64, Trouble> {
    let base = 1e5 * masses.max(1.0);
    let block = |name: &str, x: f64, y: f64, width: f64, mass: f64, young: f64, more: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\nmass = {mass:?}\nposition = [{x:?}, {y:?}]\n\
             shape = {{ kind = \"grid\", size = [{width:?}, 1], cells = [{}, 4] }}\n\
             models = [{{ kind = \"fem\", youngs_modulus = {young:?}, poissons_ratio = 0.3, damping = 1e-2 }}]\n{more}\n",
            (4.0 * width).round()
        )
    };
    let (below, above) = (base * (1.0 / stiffness).max(1.0), base * stiffness.max(1.0));
    let scene = Scene::new(2, 1.0 / 60.0, 1, rule)
        .add(&format!("[world]\ngravity = [0.0, -9.81]\n[contact]\nfriction = 0.5\n{contact}"))
        .add(&block("lower", -0.5, -1.0, 2.0, 1.0, below, "pin = [{ select = { side = \"bottom\" } }]"))
        .add(&block("upper", 0.03, 0.01, 1.0, masses, above, ""));
    let mut world = lab.plane(scene)?;
    for _ in 0..if rule == DAMPED { 300 } else { 1 } {
        world.frame()?;
    }
    let force: f64 = world.contact_forces(1).iter().map(|force| force[1]).sum();
    Ok(force / (9.81 * masses))
}
