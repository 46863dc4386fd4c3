//! The commands that tell: check, list, new, reference, bench; and the plots of a run.

use crate::arguments::{Bench, Check};
use crate::bench;
use crate::failure::{Failure, print_data};
use crate::run::{find_scene, overrides, simd_from_environment};
use opruga::core::spec::Spec;
use opruga::draw;
use opruga::io::safe_write::safe_write;
use opruga::io::scene;
use opruga::{Options, World, blueprint::AnyBlueprint};
use serde_json::json;
use std::fmt::Write as _;
use std::path::Path;

/// Reads a scene, builds its world, and says what is in it.
pub(crate) fn check(call: &Check) -> Result<u8, Failure> {
    let source = find_scene(&call.scene)?;
    let options = scene::Options {
        lenient: call.lenient,
        strict: call.strict,
        overrides: overrides(&call.set)?,
        files: source.files.clone().allow_outside(call.allow_outside),
        ..scene::Options::default()
    };
    let (blueprint, notices) = scene::read(source.text.as_bytes(), &source.file, &opruga::catalogue(), &options)?;
    for notice in &notices {
        eprintln!("{notice}");
    }
    let text = match blueprint {
        AnyBlueprint::Plane(b) => {
            describe(&World::new(b, Options::default()).map_err(|e| world_error(e, &source.file))?)
        }
        AnyBlueprint::Space(b) => {
            describe(&World::new(b, Options::default()).map_err(|e| world_error(e, &source.file))?)
        }
    };
    print_data(&format!("{}: no errors\n{text}", source.file))?;
    Ok(0)
}

fn world_error(error: opruga::WorldError, file: &str) -> Failure {
    Failure::World { error, file: file.to_string() }
}

fn describe<const D: usize>(world: &World<D>) -> String {
    let mut text = String::new();
    let nodes: usize = world.bodies().map(|b| world.node_count(b)).sum();
    let bodies = world.bodies().count();
    let plural = if bodies == 1 { "body" } else { "bodies" };
    let _ = writeln!(text, "{bodies} {plural}, {nodes} nodes, {D} dimensions");
    let _ = writeln!(
        text,
        "{}: h = {:.6e} s, {} substeps a frame",
        world.blueprint().integrator.kind(),
        world.h(),
        world.blueprint().time.substeps
    );
    for (body, stability) in world.stability() {
        let limit = stability.largest_stable_step.map_or("none".into(), |h| format!("{h:.4e} s"));
        let s = &stability.spectrum;
        let _ = writeln!(
            text,
            "  `{body}`: ω = {:.4e} rad/s, damping {:.4e} 1/s, largest stable step {limit}",
            s.omega, s.damping
        );
    }
    for warning in world.warnings() {
        let _ = writeln!(text, "warning[{}]: {}", warning.code, warning.message);
    }
    text
}

/// Lists what there is.
pub(crate) fn list(as_json: bool) -> Result<u8, Failure> {
    let catalogue = opruga::catalogue();
    let shapes = opruga::shapes::all();
    let sections: [(&str, &[&Spec]); 4] = [
        ("models", &catalogue.models),
        ("integrators", &catalogue.integrators),
        ("shapes", &shapes),
        ("colliders", &catalogue.colliders),
    ];
    let scenes: Vec<(&str, &str)> =
        opruga::scenes::names().map(|n| (n, opruga::scenes::title(opruga::scenes::find(n).unwrap_or("")))).collect();
    if as_json {
        let rows = |specs: &[&Spec]| -> Vec<_> {
            specs.iter().map(|s| json!({"kind": s.kind, "summary": s.summary, "dimensions": s.dimensions})).collect()
        };
        let mut object = serde_json::Map::new();
        for (name, specs) in sections {
            object.insert(name.into(), rows(specs).into());
        }
        let scenes: Vec<_> = scenes.iter().map(|(n, t)| json!({"name": n, "title": t})).collect();
        object.insert("scenes".into(), scenes.into());
        print_data(&format!("{}\n", serde_json::Value::Object(object)))?;
        return Ok(0);
    }
    let mut text = String::new();
    for (name, specs) in sections {
        let _ = writeln!(text, "{name}");
        for spec in specs {
            let _ = writeln!(text, "  {:<18} {}", spec.kind, spec.summary);
        }
    }
    let _ = writeln!(text, "scenes (opruga run NAME)");
    for (name, title) in scenes {
        let _ = writeln!(text, "  {name:<18} {title}");
    }
    print_data(&text)?;
    Ok(0)
}

/// Writes a commented scene to start from.
pub(crate) fn new(name: &str) -> Result<u8, Failure> {
    let stem = name.strip_suffix(".toml").unwrap_or(name);
    let path = Path::new(stem).with_extension("toml");
    let title = path.file_stem().map_or_else(|| stem.to_string(), |s| s.to_string_lossy().into_owned());
    let text = opruga::io::template::commented(&title);
    safe_write(&path, false, |out| out.write_all(text.as_bytes()))?;
    eprintln!("{} written; try `opruga run {}`", path.display(), path.display());
    Ok(0)
}

/// Prints the reference of the scene format.
pub(crate) fn reference(schema: bool) -> Result<u8, Failure> {
    let catalogue = opruga::catalogue();
    if schema {
        let schema = opruga::io::schema::json_schema(&catalogue);
        print_data(&format!("{}\n", serde_json::to_string_pretty(&schema).unwrap_or_default()))?;
    } else {
        print_data(&opruga::io::reference::markdown(&catalogue))?;
    }
    Ok(0)
}

/// Runs a benchmark.
pub(crate) fn bench(what: &Bench) -> Result<u8, Failure> {
    let Bench::Vertices(call) = what;
    if !(call.seconds > 0.0 && call.seconds <= 600.0) {
        return Err(Failure::call("--seconds: allowed are numbers above 0 up to 600"));
    }
    if opruga::Registry::<2>::default().integrator(&call.integrator).is_none() {
        return Err(Failure::call(format!("there is no integrator `{}`; `opruga list` shows them", call.integrator)));
    }
    let options = Options { threads: call.threads.into(), simd: simd_from_environment()?, ..Options::default() };
    let mut rows = Vec::new();
    for (bodies, vertices) in bench::ROWS {
        if call.only.is_some_and(|only| only != vertices) {
            continue;
        }
        eprint!("\r{bodies} × {vertices} …                ");
        let mut scenery = None;
        let mut draw_frame = |world: &mut World<2>| {
            let scenery = scenery.get_or_insert_with(|| opruga::pictures::Scenery::new(world));
            let picture = scenery.picture(&scenery.capture(world, false));
            if let Ok(view) = draw::View::fit([&picture]) {
                let _ = draw::draw(&picture, &view, &draw::Style::default());
            }
        };
        let drawing: Option<&mut dyn FnMut(&mut World<2>)> = if call.draw { Some(&mut draw_frame) } else { None };
        rows.push(
            bench::time(bodies, vertices, &call.integrator, &options, call.seconds, drawing).map_err(Failure::call)?,
        );
    }
    eprintln!("\r                              ");
    if let Some(path) = &call.plot {
        let plot = crate::plots::of_bench(&rows).map_err(|e| Failure::Draw(e.to_string()))?;
        safe_write(path, true, |out| out.write_all(plot.as_bytes()))?;
    }
    if call.json {
        print_data(&format!("{}\n", json!({"rows": rows})))?;
    } else {
        print_data(&bench::table(&rows))?;
    }
    Ok(0)
}
