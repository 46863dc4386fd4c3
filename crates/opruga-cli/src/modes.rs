//! `opruga modes`: natural frequencies and their shapes.

use crate::arguments::Modes;
use crate::failure::{Failure, print_data};
use crate::run::{default_folder, simd_from_environment};
use crate::source::{Source, Whole, overrides};
use opruga::blueprint::{AnyBlueprint, Blueprint};
use opruga::core::spec::Values;
use opruga::draw;
use opruga::io::safe_write::{Existing, OutputFolder};
use opruga::io::scene;
use opruga::pictures::Scenery;
use opruga::world::modes::Mode;
use opruga::{Options, Registry, World};
use serde_json::json;
use std::fmt::Write as _;

/// The largest displacement in a picture, in extents of the body.
const AMPLITUDE: f64 = 0.12;

/// Finds the modes of a body, prints them, and draws their shapes.
pub(crate) fn modes(call: &Modes) -> Result<u8, Failure> {
    if !(1..=500).contains(&call.count) {
        return Err(Failure::range("-n", call.count, "1 to 500"));
    }
    if !(0.0..=1e9).contains(&call.after) {
        return Err(Failure::range("--after", call.after, "0 to 1e9"));
    }
    let source = Source::find(&call.scene)?;
    let reading = scene::Options {
        overrides: overrides(&call.set)?,
        files: source.files.clone().allow_outside(call.allow_outside),
        ..scene::Options::default()
    };
    let options = Options { simd: simd_from_environment()?, ..Options::default() };
    let Whole { blueprint, notices, .. } = source.read(&reading, &options)?;
    if !call.json {
        notices.iter().for_each(|notice| eprintln!("{notice}"));
    }
    match blueprint {
        AnyBlueprint::Plane(mut blueprint) => {
            look_for_equilibrium(call, &mut blueprint);
            of_world(call, &source, source.build(blueprint, &reading, &options)?)
        }
        AnyBlueprint::Space(mut blueprint) => {
            look_for_equilibrium(call, &mut blueprint);
            of_world(call, &source, source.build(blueprint, &reading, &options)?)
        }
    }
}

/// Gives every body the integrator `equilibrium` where that is asked for, with what it understands of the parameters of the
/// one that it had: the tolerance, the number of iterations, the linear solver.
fn look_for_equilibrium<const D: usize>(call: &Modes, blueprint: &mut Blueprint<D>) {
    let registry = Registry::<D>::default();
    let Some(spec) = registry.integrator("equilibrium").map(|kind| kind.spec()).filter(|_| call.equilibrium) else {
        return;
    };
    let own = blueprint.bodies.iter_mut().filter_map(|body| body.integrator.as_mut());
    for values in own.chain([&mut blueprint.integrator]) {
        let mut statics = Values::defaults(spec, D);
        for (name, value) in values.iter() {
            // What means nothing to it is left out.
            let _ = statics.set(spec, name, value.clone(), D);
        }
        *values = statics;
    }
}

fn of_world<const D: usize>(call: &Modes, source: &Source, mut world: World<D>) -> Result<u8, Failure> {
    let body = match &call.body {
        None => world.bodies().next().ok_or_else(|| Failure::call("the scene has no body"))?,
        Some(name) => world.body(name).ok_or_else(|| {
            let names: Vec<&str> = world.bodies().map(|b| world.blueprint().bodies[b].name.as_str()).collect();
            Failure::range("--body", format!("`{name}`"), &names.join(", "))
        })?,
    };
    // To the state about which the body swings.
    let frames = (call.after / world.blueprint().time.frame - 1e-9).ceil() as u64;
    for _ in 0..frames.max(u64::from(call.equilibrium)) {
        world.frame().map_err(|error| source.run_error(&error, world.time()))?;
    }
    let modes = world.modes(body, call.count).map_err(|error| source.run_error(&error, world.time()))?;
    let name = world.blueprint().bodies[body].name.clone();
    let rows: Vec<_> = modes
        .iter()
        .enumerate()
        .map(|(k, mode)| {
            json!({"mode": k + 1, "frequency": mode.frequency(), "omega": mode.omega(), "omega_squared": mode.square,
                   "residual": mode.residual, "rigid": mode.rigid})
        })
        .collect();
    let mut files = Vec::new();
    let folder = match &call.out {
        Some(path) => path.clone(),
        None => default_folder(&format!("{}-modes", source.name))?,
    };
    let folder = OutputFolder::open(&folder, if call.force { Existing::Replace } else { Existing::Refuse })?;
    folder.write("modes.csv", false, |out| out.write_all(table_of_shapes(&modes).as_bytes()))?;
    files.push("modes.csv");
    if !call.no_pictures
        && let Some(png) = draw_shapes(&mut world, body, &modes)?
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
    print_data(&table(&name, world.time(), &modes))?;
    eprintln!("written to {}", folder.path("").display());
    Ok(0)
}

/// For people.
fn table<const D: usize>(name: &str, time: f64, modes: &[Mode<D>]) -> String {
    let mut text = format!("`{name}` at t = {time} s\nmode   frequency [Hz]      ω [rad/s]\n");
    for (k, mode) in modes.iter().enumerate() {
        let remark = match &mode.rigid {
            Some(motion) => format!("  rigid: {motion}"),
            None if mode.square < 0.0 => format!("  unstable: ω² = {:.4e} 1/s²", mode.square),
            None => String::new(),
        };
        let _ = writeln!(text, "{:4}  {:15.8e}  {:14.8e}{remark}", k + 1, mode.frequency(), mode.omega());
    }
    text
}

/// `modes.csv`: the displacement of every node in every mode.
fn table_of_shapes<const D: usize>(modes: &[Mode<D>]) -> String {
    let axes = &["x", "y", "z"][..D];
    let mut text = format!("mode,frequency,node,{}\n", axes.join(","));
    for (k, mode) in modes.iter().enumerate() {
        for (node, vector) in mode.shape.iter().enumerate() {
            let numbers: Vec<String> = vector.iter().map(|x| format!("{x:.16e}")).collect();
            let _ = writeln!(text, "{},{:.16e},{node},{}", k + 1, mode.frequency(), numbers.join(","));
        }
    }
    text
}

/// A panel for every mode: the body displaced along its shape.
fn draw_shapes<const D: usize>(
    world: &mut World<D>,
    body: usize,
    modes: &[Mode<D>],
) -> Result<Option<Vec<u8>>, Failure> {
    let failed = |e: draw::DrawError| Failure::Draw(e.to_string());
    let scenery = Scenery::new(world);
    let start: Vec<[f64; D]> = (0..world.node_count(body) as u32).map(|n| world.position(body, n)).collect();
    let mut extent: f64 = 0.0;
    for d in 0..D {
        let column = || start.iter().map(|x| x[d]);
        extent = extent.max(column().fold(f64::MIN, f64::max) - column().fold(f64::MAX, f64::min));
    }
    let number = world.bodies().position(|b| b == body).unwrap_or(0);
    let (mut pictures, mut captions) = (Vec::new(), Vec::new());
    for mode in modes.iter().take(24) {
        let most = mode.shape.iter().map(|v| v.iter().map(|c| c * c).sum::<f64>()).fold(0.0, f64::max).sqrt();
        let factor = if most > 0.0 { AMPLITUDE * extent / most } else { 0.0 };
        for (node, (x, shape)) in start.iter().zip(&mode.shape).enumerate() {
            let place = core::array::from_fn(|d| x[d] + factor * shape[d]);
            world.place_node(body, node as u32, place, [0.0; D]).map_err(|e| Failure::call(e.to_string()))?;
        }
        let mut picture = scenery.picture(&scenery.capture(world, false));
        picture.bodies = picture.bodies.into_iter().skip(number).take(1).collect();
        pictures.push(picture);
        captions.push(match &mode.rigid {
            Some(motion) => motion.clone(),
            None => format!("{:.4} Hz", mode.frequency()),
        });
    }
    let mut fitting = draw::Fitting::default();
    pictures.iter().for_each(|picture| fitting.add(picture));
    let view = match fitting.finish() {
        Ok(view) => view,
        Err(draw::DrawError::Empty(_)) => return Ok(None),
        Err(error) => return Err(failed(error)),
    };
    let panels: Vec<&draw::Picture> = pictures.iter().collect();
    let strip = draw::captioned_strip(&panels, &captions, &view, &draw::StripStyle::default()).map_err(failed)?;
    Ok(Some(strip.to_png().map_err(failed)?))
}
