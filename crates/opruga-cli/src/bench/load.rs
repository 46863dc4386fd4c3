//! `opruga bench load`: measures how long it takes to make a body from a file with many triangles, and to make a world with this body. The first
//! time is compared with the time for reading the bytes of the file. The second includes springs along the edges and the estimate of the stable
//! step.

use super::{Machine, median, processor_time};
use crate::arguments::BenchLoad;
use crate::errors::CallError;
use crate::failure::{Failure, print_data};
use opruga::io::{Files, SceneError, scene};
use opruga::mesh::Mesh;
use opruga::{Options, Registries, Simd, catalogue_of};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Reads a surface several times, as a scene does, and prints how long it takes.
pub(crate) fn bench(call: &BenchLoad, registries: &Registries) -> Result<u8, Failure> {
    match &call.file {
        Some(file) => of_file(call, file, registries),
        None => {
            let path = std::env::temp_dir().join(format!("opruga-bench-{}.stl", std::process::id()));
            let written = opruga::io::safe_write::safe_write(&path, true, |out| out.write_all(&torus(call.triangles)));
            let outcome = written.map_err(Failure::Write).and_then(|_| of_file(call, &path, registries));
            let _ = std::fs::remove_file(&path);
            outcome
        }
    }
}

/// A torus of about this many triangles in binary STL, with separate numbers for every corner, as scanners write them.
fn torus(triangles: u32) -> Vec<u8> {
    let around = (f64::from(triangles) / 4.0).sqrt().ceil().max(4.0) as u32;
    let mut bytes = vec![0; 80];
    let Ok(torus) = Mesh::torus(1.0, 0.4, [2 * around, around]) else { unreachable!("it has enough vertices") };
    bytes.extend((torus.facets.len() as u32).to_le_bytes());
    for facet in &torus.facets {
        bytes.extend([0; 12]);
        let corners = facet.iter().flat_map(|node| torus.positions[*node as usize]);
        corners.for_each(|x| bytes.extend((x as f32).to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

fn of_file(call: &BenchLoad, path: &Path, registries: &Registries) -> Result<u8, Failure> {
    let shown = path.display().to_string();
    let unreadable = |e: std::io::Error| {
        let error = SceneError::of(CallError::FileUnreadable { reason: e.to_string() });
        Failure::Scene(vec![SceneError { file: shown.clone(), ..error }])
    };
    let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let text = format!(
        "format = \"opruga-1\"\ndimension = 3\n[time]\nseconds = 1\n[integrator]\nkind = \"symplectic_euler\"\n\
         [[body]]\nname = \"it\"\nmass = 1\nshape = {{ kind = \"surface\", file = {} }}\n\
         models = [{{ kind = \"mass_spring\", stiffness = 1.0, damping = 0.0 }}]\n",
        serde_json::Value::from(name.as_str()),
    );
    let scene: PathBuf = path.with_file_name("bench.toml");
    let options = scene::Options { files: Files::beside(&scene), ..scene::Options::default() };
    let machine = Machine::measure(Simd::best());
    let (mut plain, mut wall, mut processor, mut found) = (Vec::new(), Vec::new(), Vec::new(), [0; 3]);
    let mut built = Vec::new();
    // The size of the step does not matter, because the world is not stepped.
    let world = Options { threads: 1, allow_unstable: true, ..Options::default() };
    for _ in 0..call.rounds {
        let start = Instant::now();
        let bytes = std::fs::read(path).map_err(unreadable)?;
        plain.push(start.elapsed().as_secs_f64());
        found[0] = bytes.len();
        drop(bytes);
        let (start, before) = (Instant::now(), processor_time());
        let (blueprint, _) = scene::read(text.as_bytes(), &shown, &catalogue_of(registries), &options)?;
        wall.push(start.elapsed().as_secs_f64());
        processor.push(processor_time() - before);
        if let Some(body) = blueprint.scene().body(0) {
            (found[1], found[2]) = (body.facets().len() / 3, body.nodes());
        }
        let before = processor_time();
        let made = blueprint.build_with(world.clone(), registries).map_err(|error| vec![SceneError::from(&error)])?;
        built.push(processor_time() - before);
        drop(made);
    }
    let [bytes, triangles, nodes] = found;
    let [plain, wall, processor, built] = [&plain, &wall, &processor, &built].map(|times| median(times));
    let row = json!({
        "bytes": bytes, "triangles": triangles, "nodes": nodes, "rounds": call.rounds, "plain_read_seconds": plain,
        "wall_seconds": wall, "processor_seconds": processor, "world_processor_seconds": built, "calibration": machine,
    });
    if call.json {
        print_data(&format!("{}\n", json!({ "rows": [row] })))?;
        return Ok(0);
    }
    print_data(&format!(
        "{name}: {:.1} MB, {triangles} triangles, {nodes} nodes\n  \
         {plain:.3} s to read its bytes, {wall:.3} s to make a checked body of them ({processor:.3} s of this thread; medians of {})\n  \
         {built:.3} s of this thread more to make a world of it, with springs and the estimate of the stable step\n  {}\n",
        bytes as f64 * 1e-6,
        call.rounds,
        machine.sentence(),
    ))?;
    Ok(0)
}
