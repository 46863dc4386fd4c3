//! Shape matching: natural frequencies, and a sag that is independent of the step.

use super::BASE;
use crate::case::{Case, Check, Family, Over, Scale};
use crate::lab::{Lab, Scene, Trouble};

const SQUARE: Case = Case {
    family: Family::Dynamics,
    quantity: "ω/√κ of the fastest motion that no map follows, in a block that is one cluster",
    source: "exact: U = ½ κ Σ m |x − g|² with a goal g that stays where it is",
    over: Over::Parameter("share β of the fitted map"),
    levels: &[0.0, 0.3, 0.8, 1.0],
    expected: &[1.0],
    scale: Scale::Of(1.0),
    tolerance: 1e-9,
    check: Check::Everywhere,
    quick: true,
    ..BASE
};

const STRAIN: Case = Case {
    quantity: "ω/√κ of the slowest strain that the fitted map follows, in a block that is one cluster",
    source: "exact: √(1 − β)",
    levels: &[0.1, 0.3, 0.8],
    expected: &[0.948_683_298_050_513_8, 0.836_660_026_534_075_6, 0.447_213_595_499_957_9],
    ..SQUARE
};

const RIGID: Case = Case {
    quantity: "ω/√κ of the fastest rigid motion of a block that is one cluster",
    source: "exact: 0; ω² is rounded by 1e-16 κ",
    expected: &[0.0],
    tolerance: 1e-9,
    ..SQUARE
};

const SAG: Case = Case {
    family: Family::Statics,
    quantity: "sag of the free end of a beam of overlapping clusters at rest, relative to that with steps of 1/60 s; backward Euler, κ = 4000/s²",
    source: "exact: 1; κ means the same for every step",
    over: Over::Step("step [s]"),
    levels: &[0.016_666_666_666_666_666, 0.004_166_666_666_666_667, 0.001_041_666_666_666_666_7],
    expected: &[1.0],
    tolerance: 0.01,
    check: Check::Everywhere,
    ..BASE
};

pub(super) const STATICS: &[Case] = &[Case { name: "matching-sag-of-any-step", measure: sag, ..SAG }];

pub(super) const DYNAMICS: &[Case] = &[
    Case { name: "matching-outside-2d", measure: |lab, b| plane(lab, b, "linear", Wanted::Last), ..SQUARE },
    Case { name: "matching-outside-3d", measure: |lab, b| space(lab, b, "linear", Wanted::Last), ..SQUARE },
    Case { name: "matching-strain-2d", measure: |lab, b| plane(lab, b, "linear", Wanted::Number(3)), ..STRAIN },
    Case { name: "matching-strain-3d", measure: |lab, b| space(lab, b, "linear", Wanted::Number(6)), ..STRAIN },
    Case {
        name: "matching-bend-3d-quadratic",
        quantity: "ω/√κ of the last of the 24 motions of a block that a quadratic map follows; all but 6 of them have energy",
        measure: |lab, b| space(lab, b, "quadratic", Wanted::Number(29)),
        ..STRAIN
    },
    Case { name: "matching-rigid-2d", measure: |lab, b| plane(lab, b, "linear", Wanted::Number(2)), ..RIGID },
    Case { name: "matching-rigid-3d", measure: |lab, b| space(lab, b, "linear", Wanted::Number(5)), ..RIGID },
];

/// The stiffness κ of shape matching [1/s²].
const STIFFNESS: f64 = 900.0;

/// The requested frequency, counted from the slowest.
#[derive(Clone, Copy)]
enum Wanted {
    Number(usize),
    Last,
}

fn scene(dimension: usize, share: f64, fit: &str) -> Scene {
    let (size, cells) = if dimension == 2 { ("[1.0, 0.7]", "[3, 4]") } else { ("[1.0, 0.7, 0.5]", "[2, 3, 2]") };
    Scene::new(dimension, 0.001, 1, "newmark").add(&format!(
        "[[body]]\nname = \"block\"\nmass = 2.0\nshape = {{ kind = \"grid\", size = {size}, cells = {cells} }}\n\
         models = [{{ kind = \"shape_matching\", stiffness = {STIFFNESS:?}, fit_share = {share:?}, fit = \"{fit}\" }}]"
    ))
}

fn found(omegas: &[f64], wanted: Wanted) -> Result<f64, Trouble> {
    let omega = match wanted {
        Wanted::Number(number) => omegas.get(number),
        Wanted::Last => omegas.last(),
    };
    Ok(*omega.ok_or("too few modes")? / STIFFNESS.sqrt())
}

fn plane(lab: &Lab, share: f64, fit: &str, wanted: Wanted) -> Result<f64, Trouble> {
    let world = lab.plane(scene(2, share, fit))?;
    let modes = world.modes(0, 2 * 20)?;
    found(&modes.iter().map(|mode| mode.omega()).collect::<Vec<f64>>(), wanted)
}

fn space(lab: &Lab, share: f64, fit: &str, wanted: Wanted) -> Result<f64, Trouble> {
    let world = lab.space(scene(3, share, fit))?;
    let modes = world.modes(0, 3 * 36)?;
    found(&modes.iter().map(|mode| mode.omega()).collect::<Vec<f64>>(), wanted)
}

/// The displacement of the tip of a beam after 3 s of strongly damped motion, divided by the displacement with the largest step.
fn sag(lab: &Lab, step: f64) -> Result<f64, Trouble> {
    let tip = |step: f64| -> Result<f64, Trouble> {
        let scene = Scene::new(2, 1.0 / 60.0, (1.0 / 60.0 / step).round() as u32, "backward_euler").add(
            "[world]\ngravity = [0.0, -9.81]\ndrag = 8.0\n[[body]]\nname = \"beam\"\nmass = 1.0\n\
             shape = { kind = \"grid\", size = [1.0, 0.2], cells = [10, 2] }\n\
             models = [{ kind = \"shape_matching\", stiffness = 4000.0, region = 0.4 }]\npin = [{ select = { side = \"left\" } }]",
        );
        let mut world = lab.plane(scene)?;
        for _ in 0..180 {
            world.frame()?;
        }
        let right = world.blueprint().bodies[0].mesh.groups["right"].clone();
        Ok(world.position(0, right[0])[1] - world.blueprint().bodies[0].mesh.positions[right[0] as usize][1])
    };
    Ok(tip(step)? / tip(1.0 / 60.0)?)
}
