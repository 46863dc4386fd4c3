//! `opruga modes`: natural frequencies and mode shapes.

use crate::arguments::Modes;
use crate::errors::{CallFault, CallRange};
use crate::failure::{Failure, print_data};
use crate::opened::{Opened, open};
use crate::run::default_folder;
use crate::source::Source;
use crate::uses;
use opruga::blueprint::AnyBlueprint;
use opruga::core::spec::{Role, Spec, Values};
use opruga::draw;
use opruga::io::output_folder::{Existing, OutputFolder};
use opruga::io::scene;
use opruga::math::words::{number, rounded};
use opruga::pictures::{Scenery, rest_of};
use opruga::world::modes::Mode;
use opruga::{AnyBody, AnyWorld, Registries, catalogue_of};
use serde_json::json;
use std::fmt::Write as _;
use std::path::PathBuf;

/// Because of rounding, the square of a frequency that should be zero may be this fraction of the square of the largest frequency.
const ROUNDING: f64 = 1e-15;

/// The largest displacement in a picture, as a fraction of the extent of the body.
const AMPLITUDE: f64 = 0.12;

/// Finds the modes of a body, prints them, and draws their shapes.
pub(crate) fn modes(call: &Modes, registries: &Registries) -> Result<u8, Failure> {
    if !(0.0..=1e9).contains(&call.after) {
        return Err(Failure::range("--after", call.after, CallRange::Between { least: 0.0, most: 1e9 }));
    }
    let Opened { source, reading, options, mut blueprint, files } =
        open(&call.scene, registries, &call.set, call.allow_outside, call.json)?;
    let mut uses = uses::of_scene(&source, &reading.files, files.iter());
    uses.folder(&folder_of(call, &source), uses::modes_writes);
    uses::apart(&uses)?;
    look_for_equilibrium(call, registries, &mut blueprint);
    leave_statics(call, registries, &mut blueprint);
    of_world(call, &source, &reading, &mut *source.build(blueprint, &reading, &options)?)
}

/// The integrator with the given role, among those that scenes can name.
fn integrator_with(registries: &Registries, role: Role) -> Option<&'static Spec> {
    catalogue_of(registries).integrators.into_iter().find(|spec| spec.has_role(role))
}

/// If `equilibrium` is requested, gives every body this integrator. It keeps the parameters of the former integrator that it supports: the
/// tolerance, the number of iterations and the linear solver.
fn look_for_equilibrium(call: &Modes, registries: &Registries, blueprint: &mut AnyBlueprint) {
    let dimension = blueprint.scene().dimension();
    let Some(spec) = integrator_with(registries, Role::Statics).filter(|_| call.equilibrium) else { return };
    for values in blueprint.integrators_mut() {
        let mut statics = Values::defaults(spec, dimension);
        for (name, value) in values.iter() {
            // Parameters that it does not support are dropped.
            let _ = statics.set(spec, name, value.clone(), dimension);
        }
        *values = statics;
    }
}

/// If no frame is run, replaces statics by an implicit integrator. Modes belong to a state, independently of the integrator. A body that can
/// move freely, which statics refuses, has modes like any other body. The replacement supports all bodies and all steps.
fn leave_statics(call: &Modes, registries: &Registries, blueprint: &mut AnyBlueprint) {
    let dimension = blueprint.scene().dimension();
    let runs = call.equilibrium || call.after > 0.0;
    let Some(spec) = integrator_with(registries, Role::OfferedImplicit).filter(|_| !runs) else { return };
    for values in blueprint.integrators_mut().into_iter().filter(|values| values.spec().has_role(Role::Statics)) {
        *values = Values::defaults(spec, dimension);
    }
}

/// The folder for the output.
fn folder_of(call: &Modes, source: &Source) -> PathBuf {
    call.out.clone().unwrap_or_else(|| default_folder(&format!("{}-modes", source.name)))
}

fn of_world(call: &Modes, source: &Source, reading: &scene::Options, world: &mut dyn AnyWorld) -> Result<u8, Failure> {
    let body = match &call.body {
        None => world.bodies().first().copied().ok_or_else(|| Failure::call(CallFault::NoBody {}))?,
        Some(name) => world.body(name).ok_or_else(|| {
            let bodies = world.bodies().into_iter().filter_map(|body| world.scene().body(body));
            let names: Vec<&str> = bodies.map(AnyBody::name).collect();
            Failure::range("--body", format!("`{name}`"), CallRange::OneOf { names: names.join(", ") })
        })?,
    };
    // The frames up to the state about which the body vibrates.
    let frames = (call.after / world.scene().time().frame - 1e-9).ceil() as u64;
    for _ in 0..frames.max(u64::from(call.equilibrium)) {
        world.frame().map_err(|error| source.frame_error(&error, world, reading))?;
    }
    let modes = world.modes(body, call.count).map_err(|error| source.run_error(&error, world.time()))?;
    let dimension = world.scene().dimension();
    let name = world.scene().body(body).map_or("", AnyBody::name).to_string();
    let rounding = rounding(world);
    let rows: Vec<_> = modes
        .iter()
        .enumerate()
        .map(|(k, mode)| {
            json!({"mode": k + 1, "frequency": mode.frequency(), "omega": mode.omega(), "omega_squared": mode.square,
                   "growth": growth(mode, rounding), "residual": mode.residual, "rigid": mode.rigid})
        })
        .collect();
    let mut files = Vec::new();
    let folder =
        OutputFolder::open(&folder_of(call, source), if call.force { Existing::Replace } else { Existing::Refuse })?;
    folder.write("modes.csv", false, |out| out.write_all(table_of_shapes(&modes, dimension).as_bytes()))?;
    files.push("modes.csv");
    if !call.no_pictures
        && let Some(png) = draw_shapes(world, body, &modes, rounding)?
    {
        folder.write("modes.png", false, |out| out.write_all(&png))?;
        files.push("modes.png");
    }
    let object =
        json!({"schema": 1, "scene": source.name, "body": name, "time": world.time(), "rows": rows, "files": files});
    let text = format!("{}\n", serde_json::to_string_pretty(&object).unwrap_or_default());
    folder.write("modes.json", false, |out| out.write_all(text.as_bytes()))?;
    if call.json {
        print_data(&text)?;
        return Ok(0);
    }
    print_data(&table(&name, world.time(), &modes, rounding))?;
    eprintln!("written to {}", folder.path("").display());
    Ok(0)
}

/// A table for the terminal, with frequencies of five digits. All digits are in `modes.json` and `modes.csv`.
fn table(name: &str, time: f64, modes: &[Mode<3>], rounding: f64) -> String {
    let mut text = format!("`{name}` at t = {} s\nmode  frequency [Hz]     ω [rad/s]\n", number(time));
    for (k, mode) in modes.iter().enumerate() {
        let (times_i, remark) = match (&mode.rigid, growth(mode, rounding)) {
            (Some(motion), _) => ("", format!("  rigid: {motion}")),
            (None, None) if mode.square.abs() <= rounding => ("", "  nothing resists it, except rounding".into()),
            (None, Some(growth)) => (" i", format!("  unstable: grows as exp({} t/s)", rounded(growth, 5))),
            (None, None) => ("", String::new()),
        };
        let omega = growth(mode, rounding).unwrap_or(mode.omega());
        let shown = |x: f64| rounded(x, 5) + times_i;
        let _ = writeln!(text, "{:4}{:>16}{:>14}{remark}", k + 1, shown(omega / core::f64::consts::TAU), shown(omega));
    }
    text
}

/// The largest ω² of a mode that may be due to rounding alone [1/s²].
fn rounding(world: &dyn AnyWorld) -> f64 {
    let squares = world.stability().iter().map(|(_, stability)| stability.spectrum.omega * stability.spectrum.omega);
    ROUNDING * squares.filter(|square| square.is_finite()).max_by(f64::total_cmp).unwrap_or(0.0)
}

/// √(−ω²) of an unstable mode [1/s], whose frequency is imaginary: its displacement grows as exp(√(−ω²) t).
fn growth(mode: &Mode<3>, rounding: f64) -> Option<f64> {
    (mode.rigid.is_none() && mode.square < -rounding).then(|| (-mode.square).sqrt())
}

/// `modes.csv`: the displacement of every node in every mode.
fn table_of_shapes(modes: &[Mode<3>], dimension: usize) -> String {
    let axes = &["x", "y", "z"][..dimension];
    let mut text = format!("mode,frequency,node,{}\n", axes.join(","));
    for (k, mode) in modes.iter().enumerate() {
        for (node, vector) in mode.shape.iter().enumerate() {
            let numbers: Vec<String> = vector[..dimension].iter().map(|x| format!("{x:.16e}")).collect();
            let _ = writeln!(text, "{},{:.16e},{node},{}", k + 1, mode.frequency(), numbers.join(","));
        }
    }
    text
}

/// One panel for every mode: the body displaced along its shape.
fn draw_shapes(
    world: &mut dyn AnyWorld,
    body: usize,
    modes: &[Mode<3>],
    rounding: f64,
) -> Result<Option<Vec<u8>>, Failure> {
    let failed = Failure::Draw;
    let scenery = Scenery::new(world);
    let start: Vec<[f64; 3]> = world.positions(body).iter().collect();
    let mut extent: f64 = 0.0;
    for d in 0..world.scene().dimension() {
        let column = || start.iter().map(|x| x[d]);
        extent = extent.max(column().fold(f64::MIN, f64::max) - column().fold(f64::MAX, f64::min));
    }
    let number = world.bodies().into_iter().position(|b| b == body).unwrap_or(0);
    let own = |picture: draw::Picture| picture.bodies.into_iter().nth(number);
    let Some(rest) = own(scenery.picture(&scenery.capture(world, false))) else { return Ok(None) };
    let (mut pictures, mut captions) = (Vec::new(), Vec::new());
    for (k, mode) in modes.iter().enumerate().take(24) {
        let most = mode.shape.iter().map(|v| v.iter().map(|c| c * c).sum::<f64>()).fold(0.0, f64::max).sqrt();
        let factor = if most > 0.0 { AMPLITUDE * extent / most } else { 0.0 };
        for (node, (x, shape)) in start.iter().zip(&mode.shape).enumerate() {
            let position = core::array::from_fn(|d| x[d] + factor * shape[d]);
            world.set_node(body, node as u32, position, [0.0; 3]).map_err(Failure::call)?;
        }
        let mut picture = scenery.picture(&scenery.capture(world, false));
        let legend = picture.legend.take().unwrap_or_default();
        picture.bodies = picture.bodies.into_iter().skip(number).take(1).collect();
        for body in &mut picture.bodies {
            body.scalar = moved(&rest, body);
        }
        picture.bodies.iter_mut().for_each(|body| body.rest = rest_of(&rest));
        picture.legend = Some(draw::Legend {
            label: "displacement / largest".into(),
            unit: String::new(),
            range: Some([0.0, 1.0]),
            ..legend
        });
        pictures.push(picture);
        captions.push(match &mode.rigid {
            Some(motion) => format!("{}: {motion}", k + 1),
            None if mode.square.abs() <= rounding => format!("{}: 0 Hz", k + 1),
            None => match growth(mode, rounding) {
                Some(growth) => {
                    let frequency = rounded(growth / core::f64::consts::TAU, 4);
                    format!("{}: unstable, {frequency} i Hz", k + 1)
                }
                None => format!("{}: {} Hz", k + 1, rounded(mode.frequency(), 4)),
            },
        });
    }
    let mut fitting = draw::Fitting::default();
    pictures.iter().for_each(|picture| fitting.add(picture));
    let view = match fitting.finish() {
        Ok(view) => view,
        Err(draw::DrawError::Empty { .. }) => return Ok(None),
        Err(error) => return Err(failed(error)),
    };
    let panels: Vec<&draw::Picture> = pictures.iter().collect();
    let strip = draw::captioned_strip(&panels, &captions, &view, &draw::StripStyle::default()).map_err(failed)?;
    Ok(Some(strip.to_png().map_err(failed)?))
}

/// The displacement of every point of a body, divided by the largest displacement.
fn moved(rest: &draw::BodyPicture, body: &draw::BodyPicture) -> Vec<f64> {
    let apart = |(a, b): (&[f64; 3], &[f64; 3])| (0..3).map(|d| (a[d] - b[d]).powi(2)).sum::<f64>().sqrt();
    let displacements: Vec<f64> = rest.positions.iter().zip(&body.positions).map(apart).collect();
    let most = displacements.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    displacements.into_iter().map(|displacement| displacement / most).collect()
}
