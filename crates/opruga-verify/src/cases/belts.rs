//! A belt on a drum, and contact between bodies with explicit and with implicit integrators.

use super::BASE;
use crate::case::{Case, Check, Family, Over, Scale};
use crate::lab::{Lab, Scene, Trouble};
use std::f64::consts::PI;

pub(super) const CASES: &[Case] = &[
    Case {
        name: "belt-over-drum",
        family: Family::Dynamics,
        quantity: "tension of a belt after half a turn around a body, relative to that before it, µ = 0.3",
        source: "closed form: e^{µ π} (L. Euler 1762)",
        over: Over::Cells("edges along the half turn"),
        levels: &[10.0, 20.0, 40.0],
        expected: &[2.566_332_395_208_135],
        check: Check::Order(2.0),
        measure: belt,
        ..BASE
    },
    Case {
        name: "explicit-reaches-implicit",
        family: Family::Dynamics,
        quantity: "difference in height of a block that has fallen onto another one, between symplectic Euler and backward Euler",
        unit: "m",
        source: "in the limit of short steps: the same motion",
        over: Over::Step("step [s]"),
        levels: &[1.0 / 960.0, 1.0 / 1920.0, 1.0 / 3840.0],
        scale: Scale::Of(1.0),
        check: Check::Order(1.0),
        measure: |lab, h| {
            Ok(height_after_fall(lab, h, "symplectic_euler")? - height_after_fall(lab, h, "backward_euler")?)
        },
        ..BASE
    },
];

/// A belt touches a round body over half a turn. The belt is pulled slowly at one end and held back by 10 N at the other. Returns the ratio of the
/// tension at the pulled end to 10 N.
fn belt(lab: &Lab, n: f64) -> Result<f64, Trouble> {
    let (thickness, tail, held_back, stiffness, speed) = (1e-3, 0.5, 10.0, 1e4, 0.0025);
    // The belt is light, so that waves along it have little effect. Their force ρ c v is 0.08 N.
    let density = 0.1;
    let (angle, count) = (PI / n, n as usize);
    let radius = (1.0 + thickness) / (0.5 * angle).cos();
    let mut points: Vec<[f64; 2]> = (0..count)
        .map(|k| {
            let at = PI - (k as f64 + 0.5) * angle;
            [radius * at.cos(), radius * at.sin()]
        })
        .collect();
    let edge = 2.0 * radius * (0.5 * angle).sin();
    let more = (tail / edge).ceil() as usize;
    let side = |sign: f64, k: usize| [sign * (1.0 + thickness), radius * (0.5 * angle).sin() - edge * (k as f64 + 1.0)];
    (0..more).for_each(|k| points.insert(0, side(-1.0, k)));
    (0..more).for_each(|k| points.push(side(1.0, k)));
    let last = points.len() - 1;
    let length = edge * last as f64;
    let spring = stiffness / edge;
    let sides = 16 * count;
    let drum: Vec<[f64; 2]> =
        (0..sides).map(|k| 2.0 * PI * k as f64 / sides as f64).map(|at| [at.cos(), at.sin()]).collect();
    let omega = 2.0 * (spring / (density * edge)).sqrt();
    let frame = 1.0 / 100.0;
    let substeps = (frame * omega / 0.5).ceil() as u32;
    let scene = Scene::new(2, frame, substeps, "symplectic_euler").add(&format!(
        "[world]\ndrag = 20.0\n[contact]\nfriction = 0.3\nthickness = {thickness:?}\nself = false\n\
         [[body]]\nname = \"belt\"\nmass = {:?}\nshape = {{ kind = \"polyline\", points = {points:?} }}\n\
         models = [{{ kind = \"mass_spring\", stiffness = {spring:?}, damping = {:?} }}]\n\
         pin = [{{ select = {{ node = {last} }}, motion = [[0, 0, 0], [3, 0, {:?}]] }}]\n\
         [[body]]\nname = \"drum\"\nmass = 1\nshape = {{ kind = \"polygon\", points = {drum:?} }}\n\
         models = [{{ kind = \"mass_spring\", stiffness = 1.0 }}]\npin = [{{ select = {{ all = true }} }}]\n\
         [[load]]\nkind = \"force\"\nbody = \"belt\"\nvalue = [0, {:?}]\nselect = {{ node = 0 }}",
        density * length,
        0.1 * (spring * density * edge).sqrt(),
        -3.0 * speed,
        -held_back
    ));
    let mut world = lab.plane(scene)?;
    let (mut tension, mut frames) = (0.0, 0.0);
    for _ in 0..300 {
        world.frame()?;
        if world.time() > 2.0 {
            let [a, b] = [last - 1, last].map(|node| world.position(0, node as u32));
            tension += spring * ((b[0] - a[0]).hypot(b[1] - a[1]) - edge);
            frames += 1.0;
        }
    }
    Ok(tension / frames / held_back)
}

/// The height of the highest node of a block, 0.2 s after it begins to fall onto another block at 1 m/s [m].
fn height_after_fall(lab: &Lab, h: f64, rule: &str) -> Result<f64, Trouble> {
    let frame = 1.0 / 60.0;
    let scene = Scene::new(2, frame, (frame / h).round() as u32, rule).add(
        "[world]\ngravity = [0, -9.81]\n[contact]\nfriction = 0.3\n\
         [[body]]\nname = \"lower\"\nmass = 1\nshape = { kind = \"grid\", size = [1, 0.5], cells = [4, 2] }\n\
         models = [{ kind = \"fem\", youngs_modulus = 1e4, poissons_ratio = 0.3, damping = 1e-3 }]\npin = [{ select = { side = \"bottom\" } }]\n\
         [[body]]\nname = \"upper\"\nmass = 1\nposition = [0.03, 0.55]\nvelocity = [0, -1]\nshape = { kind = \"grid\", size = [0.5, 0.5], cells = [2, 2] }\n\
         models = [{ kind = \"fem\", youngs_modulus = 1e4, poissons_ratio = 0.3, damping = 1e-3 }]\n",
    );
    let mut world = lab.plane(scene)?;
    for _ in 0..12 {
        world.frame()?;
    }
    Ok((0..world.node_count(1) as u32).map(|node| world.position(1, node)[1]).fold(f64::NEG_INFINITY, f64::max))
}
