//! Commands that print information: check, list, new, reference and bench. The plots of a run are
//! here too.

use crate::arguments::{Bench, BenchVertices, Check};
use crate::bench::vertices as bench;
use crate::errors::{CallFault, CallRange};
use crate::failure::{Failure, print_data};
use crate::language::translation;
use crate::outputs::cells;
use crate::run::simd_from_environment;
use crate::source::{Source, Whole, argument, overrides};
use opruga::core::spec::{Spec, nearest};
use opruga::core::stability::Stability;
use opruga::draw;
use opruga::io::problem::visible;
use opruga::io::problem::warning_text;
use opruga::io::safe_write::{safe_write, try_write};
use opruga::io::tables::CellSummary;
use opruga::io::{Notice, scene};
use opruga::math::words::{counted, number, rounded};
use opruga::{AnyWorld, Options, Registries, Warning, World, catalogue_of};
use serde_json::json;
use std::fmt::Write as _;
use std::io::IsTerminal as _;
use std::path::PathBuf;

/// Reads a scene, builds its world, and reports its contents.
pub(crate) fn check(call: &Check, registries: &Registries) -> Result<u8, Failure> {
    let source = Source::find(&call.scene, registries)?;
    let reading = scene::Options {
        lenient: call.lenient,
        strict: call.strict,
        overrides: overrides(&call.set)?,
        files: source.files.clone().allow_outside(call.allow_outside),
        ..scene::Options::default()
    };
    let most_bytes = Some(reading.limits.memory_bytes);
    let world = Options { allow_unstable: call.allow_unstable, most_bytes, ..Options::default() };
    let Whole { blueprint, notices, .. } = source.read(&reading, &world)?;
    let found = Found::of(&*source.build(blueprint, &reading, &world)?);
    if call.json {
        print_data(&format!("{}\n", found.to_json(&source.file, &notices)))?;
    } else {
        notices.iter().for_each(|notice| eprintln!("{}", notice.text(translation())));
        print_data(&format!("{}: no errors\n{found}", source.file))?;
    }
    Ok(0)
}

/// The contents of a scene without errors.
struct Found {
    dimension: usize,
    bodies: usize,
    nodes: usize,
    integrator: String,
    /// Whether every body is in statics, which has no time.
    is_static: bool,
    h: f64,
    substeps: u32,
    cells: Vec<CellSummary>,
    stability: Vec<(String, Stability)>,
    warnings: Vec<Warning>,
}

impl Found {
    fn of(world: &dyn AnyWorld) -> Found {
        let bodies = world.bodies();
        Found {
            dimension: world.scene().dimension(),
            bodies: bodies.len(),
            nodes: bodies.iter().map(|body| world.node_count(*body)).sum(),
            integrator: world.integrators().join(", "),
            is_static: world.is_static(),
            h: world.h(),
            substeps: world.scene().time().substeps,
            cells: cells(world),
            stability: world.stability().to_vec(),
            warnings: world.warnings(),
        }
    }

    fn to_json(&self, file: &str, notices: &[Notice]) -> serde_json::Value {
        let stability = |(body, s): &(String, Stability)| {
            json!({"body": body, "omega": s.spectrum.omega, "damping": s.spectrum.damping,
                   "largest_stable_step": s.largest_stable_step})
        };
        let of_scene = notices.iter().map(|n| {
            let mut object = n.about.to_json();
            object["count"] = n.count.into();
            object
        });
        let of_world = self.warnings.iter().map(|w| json!({"code": w.code, "message": w.message, "count": w.count}));
        json!({
            "file": file, "errors": 0, "dimension": self.dimension, "bodies": self.bodies, "nodes": self.nodes,
            "integrator": self.integrator, "h": self.h, "substeps": self.substeps,
            "cells": self.cells,
            "stability": self.stability.iter().map(stability).collect::<Vec<_>>(),
            "warnings": of_scene.chain(of_world).collect::<Vec<_>>(),
        })
    }
}

impl core::fmt::Display for Found {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let (bodies, nodes) =
            (counted(self.bodies as u64, "body", "bodies"), counted(self.nodes as u64, "node", "nodes"));
        writeln!(f, "{bodies}, {nodes}, {} dimensions", self.dimension)?;
        let substeps = counted(self.substeps.into(), "substep", "substeps");
        match self.is_static {
            true => writeln!(f, "{}: an equilibrium", self.integrator)?,
            false => writeln!(f, "{}: h = {} s, {substeps} per frame", self.integrator, number(self.h))?,
        }
        for c in &self.cells {
            let (low, high) = (rounded(c.smallest_angle, 3), rounded(c.largest_angle, 4));
            let (short, long) = (rounded(c.shortest_edge, 3), rounded(c.longest_edge, 3));
            let cells = counted(c.cells as u64, "cell", "cells");
            writeln!(f, "  `{}`: {cells} with angles of {low}° to {high}°, edges of {short} m to {long} m", c.body)?;
        }
        for (body, stability) in self.stability.iter().filter(|_| !self.is_static) {
            let limit = match stability.largest_stable_step {
                None => "there is no stable step".into(),
                Some(limit) if limit.is_infinite() => "every step is stable".into(),
                Some(limit) => format!("largest stable step {} s", number(limit)),
            };
            let s = &stability.spectrum;
            let (omega, damping) = (number(s.omega), number(s.damping));
            writeln!(f, "  `{body}`: ω = {omega} rad/s, damping {damping} 1/s, {limit}")?;
        }
        for warning in &self.warnings {
            writeln!(f, "{}", warning_text(warning, translation()))?;
        }
        Ok(())
    }
}

/// The specifications of one kind. There may be one for each dimension.
struct Kind {
    kind: &'static str,
    summary: &'static str,
    dimensions: Vec<usize>,
}

/// One row per kind, with all dimensions in which it exists.
fn kinds(specs: &[&'static Spec]) -> Vec<Kind> {
    let mut kinds: Vec<Kind> = Vec::new();
    for spec in specs {
        match kinds.iter_mut().find(|k| k.kind == spec.kind) {
            Some(kind) => kind.dimensions.extend(spec.dimensions),
            None => kinds.push(Kind { kind: spec.kind, summary: spec.summary, dimensions: spec.dimensions.to_vec() }),
        }
    }
    for kind in &mut kinds {
        kind.dimensions.sort_unstable();
        kind.dimensions.dedup();
    }
    kinds
}

/// Lists what is available.
pub(crate) fn list(as_json: bool, registries: &Registries) -> Result<u8, Failure> {
    print_data(&listed(as_json, registries))?;
    Ok(0)
}

fn listed(as_json: bool, registries: &Registries) -> String {
    let catalogue = catalogue_of(registries);
    let sections = [
        ("models", kinds(&catalogue.models)),
        ("integrators", kinds(&catalogue.integrators)),
        ("shapes", kinds(&opruga::shapes::all())),
        ("colliders", kinds(&catalogue.colliders)),
    ];
    let pairs = registries.plane.pairs();
    let described = |name| {
        let text = opruga::scenes::find(name).unwrap_or("");
        (name, opruga::scenes::title(text), opruga::scenes::credit(text))
    };
    let scenes: Vec<(&str, &str, &str)> = opruga::scenes::names().map(described).collect();
    if as_json {
        let row = |k: &Kind| json!({"kind": k.kind, "summary": k.summary, "dimensions": k.dimensions});
        let mut object = serde_json::Map::new();
        for (name, kinds) in &sections {
            object.insert((*name).into(), kinds.iter().map(row).collect::<Vec<_>>().into());
        }
        let scenes: Vec<_> = scenes.iter().map(|(n, t, c)| json!({"name": n, "title": t, "credit": c})).collect();
        object.insert("scenes".into(), scenes.into());
        let pair = |(model, integrator, fits): &(&str, &str, bool)| json!({"model": model, "integrator": integrator, "fits": fits});
        object.insert("pairs".into(), pairs.iter().map(pair).collect::<Vec<_>>().into());
        return format!("{}\n", serde_json::Value::Object(object));
    }
    let mut text = String::new();
    for (name, kinds) in &sections {
        let _ = writeln!(text, "{name}");
        for kind in kinds {
            let dimensions: Vec<String> = kind.dimensions.iter().map(|d| format!("{d}D")).collect();
            let _ = writeln!(text, "  {:<18} {:<6} {}", kind.kind, dimensions.join(" "), kind.summary);
        }
    }
    let mut refused: Vec<(&str, Vec<&str>)> = Vec::new();
    for (model, integrator, _) in pairs.iter().filter(|pair| !pair.2) {
        match refused.iter_mut().find(|row| row.0 == *model) {
            Some(row) => row.1.push(*integrator),
            None => refused.push((*model, vec![*integrator])),
        }
    }
    let _ = writeln!(text, "every model works with every integrator, except");
    for (model, integrators) in refused {
        let _ = writeln!(text, "  {model:<18} not with {}", integrators.join(", "));
    }
    let _ = writeln!(text, "scenes (opruga run NAME)");
    let widest = scenes.iter().map(|scene| scene.0.len()).max().unwrap_or(0);
    for (name, title, credit) in scenes {
        let _ = writeln!(text, "  {name:<widest$} {title}");
        if !credit.is_empty() {
            let _ = writeln!(text, "  {:<widest$}   {credit}", "");
        }
    }
    text
}

/// Writes a commented scene to start from.
pub(crate) fn new(name: &str, force: bool) -> Result<u8, Failure> {
    let stem = name.strip_suffix(".toml").unwrap_or(name);
    if stem.is_empty() || stem.ends_with(['/', '\\']) {
        return Err(Failure::range("NAME", format!("`{name}`"), CallRange::FileName {}));
    }
    let path = PathBuf::from(format!("{stem}.toml"));
    let title = path.file_stem().map_or_else(|| stem.to_string(), |s| s.to_string_lossy().into_owned());
    let text = opruga::io::template::commented(&title);
    safe_write(&path, force, |out| out.write_all(text.as_bytes()))?;
    let shown = path.display().to_string();
    eprintln!("{} written; try `opruga run {}`", visible(&shown), argument(&shown));
    Ok(0)
}

/// Prints the reference of the scene format.
pub(crate) fn reference(schema: bool, registries: &Registries) -> Result<u8, Failure> {
    let catalogue = catalogue_of(registries);
    if schema {
        let schema = opruga::io::schema::json_schema(&catalogue);
        print_data(&format!("{}\n", serde_json::to_string_pretty(&schema).unwrap_or_default()))?;
    } else {
        print_data(&opruga::io::reference::markdown(&catalogue))?;
    }
    Ok(0)
}

/// Runs a benchmark.
pub(crate) fn bench(what: &Bench, registries: &Registries) -> Result<u8, Failure> {
    match what {
        Bench::Vertices(call) => bench_vertices(call, registries),
        Bench::Scene(call) => crate::bench::scene::bench(call, registries),
        Bench::Elements(call) => crate::bench::elements::bench(call, registries),
        Bench::Record(call) => crate::bench::record::bench(call, registries),
        Bench::Load(call) => crate::bench::load::bench(call, registries),
    }
}

fn bench_vertices(call: &BenchVertices, registries: &Registries) -> Result<u8, Failure> {
    if !(call.seconds > 0.0 && call.seconds <= 600.0) {
        return Err(Failure::range("--seconds", call.seconds, CallRange::PositiveUpTo { most: 600.0 }));
    }
    let integrators: Vec<&str> = registries.plane.integrators().iter().map(|s| s.kind).collect();
    if !integrators.contains(&call.integrator.as_str()) {
        let name = visible(&call.integrator);
        return Err(Failure::call(match nearest(&call.integrator, integrators.iter().copied()) {
            Some(closest) => CallFault::NoIntegratorNear { name, closest },
            None => CallFault::NoIntegrator { name, known: integrators.join(", ") },
        }));
    }
    let chosen = call.only.as_deref().map(bench::row).transpose()?;
    if let Some(path) = &call.plot {
        // This is checked now, and not after minutes of measuring.
        try_write(path, true)?;
    }
    let options = Options { threads: call.threads.into(), simd: simd_from_environment()?, ..Options::default() };
    let mut rows = Vec::new();
    for (bodies, vertices) in bench::ROWS {
        if chosen.is_some_and(|row| row != (bodies, vertices)) {
            continue;
        }
        if std::io::stderr().is_terminal() {
            eprint!("\r{bodies} × {vertices} …                ");
        }
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
            bench::time((bodies, vertices), registries, &call.integrator, &options, call.seconds, drawing)
                .map_err(Failure::call)?,
        );
    }
    if std::io::stderr().is_terminal() {
        eprint!("\r                              \r");
    }
    if call.json {
        print_data(&format!("{}\n", json!({"rows": rows})))?;
    } else {
        print_data(&bench::table(&rows))?;
    }
    if let Some(path) = &call.plot {
        let plot = crate::plots::of_bench(&rows)?;
        safe_write(path, true, |out| out.write_all(plot.as_bytes()))?;
    }
    Ok(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use opruga::core::error::BuildError;
    use opruga::core::potential::{Ingredients, Model, Potential, Views};
    use std::sync::Arc;

    const SPEC: Spec = Spec {
        kind: "bed_of_a_test",
        summary: "a bed that only a test knows",
        documentation: "",
        dimensions: &[2],
        fields: &[],
        roles: &[],
    };

    struct Bed;
    impl Model<2> for Bed {
        fn spec(&self) -> &'static Spec {
            &SPEC
        }
        fn views(&self) -> Views {
            Views::default()
        }
        fn build(&self, _: &Ingredients<2>) -> Result<Box<dyn Potential<2>>, BuildError> {
            Err(BuildError::new(SPEC.kind, "bed.none", "nobody builds it"))
        }
    }

    #[test]
    fn a_registered_model_is_listed_with_the_integrators_that_cannot_step_it() {
        let mut plane = opruga::Registry::default();
        plane.add_model(Box::new(Bed));
        let registries = Registries { plane: Arc::new(plane), ..Registries::default() };
        let line = |text: &str, part: &str| text.lines().find(|line| line.contains(part)).map(String::from);
        let text = listed(false, &registries);
        let row = line(&text, SPEC.summary).expect("a row");
        assert!(row.contains(SPEC.kind) && row.contains("2D") && !row.contains("3D"), "{row}");
        assert!(line(&text, "bed_of_a_test      not with").expect("its pairs").contains("newmark"), "{text}");
        let json: serde_json::Value = serde_json::from_str(&listed(true, &registries)).expect("JSON");
        assert_eq!(json["models"][0]["kind"], SPEC.kind);
        assert!(!listed(false, &Registries::default()).contains(SPEC.kind));
    }
}
