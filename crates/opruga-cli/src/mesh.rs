//! `opruga mesh`: makes a mesh of cells from a file, reports its quality and draws a picture. The command also converts between
//! formats.
#![allow(clippy::result_large_err, reason = "errors are rare, and say much")]

use crate::arguments::Mesh as Call;
use crate::errors::{CallError, CallFault, CallRange};
use crate::failure::{Failure, print_data};
use crate::language::translation;
use crate::source::overrides;
use crate::uses;
use opruga::core::spec::Values;
use opruga::draw::{self, BodyPicture, ColourMap, Facets, Legend, Picture};
use opruga::io::meshes::{LeftOut, NotInFormat};
use opruga::io::outputs_apart::Use;
use opruga::io::problem::{in_words, visible};
use opruga::io::safe_write::{safe_write, try_write};
use opruga::io::scene::{self, Limits};
use opruga::io::shapes::{Problem, body, kind_of_file};
use opruga::io::{Files, Notice, SceneError, meshes};
use opruga::math::message::{Replacing, Setting};
use opruga::math::words::{counted, number, rounded};
use opruga::mesh::{CellQuality, Element, Mesh, triangle_parts};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Reads the file, fills it, reports on it, draws it, and writes the mesh.
pub(crate) fn mesh(call: &Call) -> Result<u8, Failure> {
    for (option, value) in [("--size", call.size), ("--scale-to", call.scale_to)] {
        if let Some(value) = value.filter(|value| !(*value > 0.0 && value.is_finite())) {
            return Err(Failure::range(option, value, CallRange::Positive {}));
        }
    }
    let ending = |path: &Path| path.extension().map_or(String::new(), |e| e.to_string_lossy().to_ascii_lowercase());
    let out = call.out.as_deref().map(|path| (path, ending(path)));
    if let Some((path, ending)) = &out
        && !matches!(ending.as_str(), "msh" | "vtk" | "vtu" | "mesh" | "mfem" | "node" | "ele")
    {
        let (path, ending) = (path.display().to_string(), visible(ending));
        return Err(Failure::call(CallFault::UnknownEnding { path, ending, known: meshes::WRITTEN }));
    }
    let mut uses = uses::of_file(Use::Input {}, &call.input);
    let written =
        |path: &Path, ending: &str| meshes::endings(ending).into_iter().map(|e| path.with_extension(e)).collect();
    let written: Vec<PathBuf> = out.as_ref().map_or_else(Vec::new, |(path, ending)| written(path, ending));
    written.iter().for_each(|path| uses.output("-o", path));
    if let Some(path) = picture_of(call, out.as_ref()) {
        uses.output("--picture", &path);
    }
    uses::apart(&uses)?;
    let folder = call.input.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let Some(name) = call.input.file_name().and_then(|name| name.to_str()) else {
        return Err(Failure::call(CallFault::NotUtf8 { path: call.input.display().to_string() }));
    };
    let (dimension, shape) = shape(call, folder, name, &ending(&call.input))?;
    let files = Files::in_folder(folder);
    // Files are read in the same way as by scenes. The files next to the input are known after reading.
    let mut named = Vec::new();
    let mut apart = |named: &[String]| {
        let beside = named.iter().filter_map(|name| Some((name, files.path_of(name)?)));
        beside.for_each(|(name, path)| uses.input(Use::NamedByInput { name: name.clone() }, &path));
        uses::apart(&uses)
    };
    if dimension == 2 {
        let made = body::<2>(&shape, &files, &Limits::default(), &mut named);
        let (mesh, notices) = made.map_err(|e| refused(call, name, e))?;
        apart(&named)?;
        finish(call, mesh, &file_notices(call, name, notices), out)
    } else {
        let made = body::<3>(&shape, &files, &Limits::default(), &mut named);
        let (mesh, notices) = made.map_err(|e| refused(call, name, e))?;
        apart(&named)?;
        finish(call, mesh, &file_notices(call, name, notices), out)
    }
}

/// The path of the picture, or `None` if no picture is requested. The path contains the full name of the mesh, so that each format of a
/// mesh can have its own picture in the same folder.
fn picture_of(call: &Call, out: Option<&(&Path, String)>) -> Option<PathBuf> {
    let beside = || out.map(|(path, ending)| path.with_extension(format!("{ending}.png")));
    call.picture.clone().or_else(beside)
}

/// The shape that the call asks for, in the terms of scenes, and its dimension.
fn shape(call: &Call, folder: &Path, name: &str, ending: &str) -> Result<(usize, Values), Failure> {
    let set = overrides(&call.set)?;
    let is_set = |field: &str| set.iter().any(|(path, _)| path == field);
    let word = |field: &str, value: &str| (field.to_string(), serde_json::Value::from(value).to_string());
    // Lengths that `--set` gives are not required again.
    let length = |field: &str, given: Option<f64>, missing: Option<CallFault>| match (given, missing) {
        (Some(length), _) => Ok(Some((field.to_string(), format!("{length:?}")))),
        (None, Some(missing)) if !is_set(field) => Err(Failure::call(missing)),
        _ => Ok(None),
    };
    let spacing = || length("spacing", call.size, Some(CallFault::NoSize {}));
    // The options of the call come first, then `--set`.
    let made = |kind: &str, dimension: usize, fields: Vec<(String, String)>| {
        let all = [&[word("file", name)], &fields[..], &set[..]].concat();
        let (values, _) = scene::shape_of_fields(kind, dimension, &all).map_err(Failure::Scene)?;
        Ok((dimension, values))
    };
    let surface = |weld: bool| {
        let mut fields = vec![word("filling", "tetrahedra")];
        fields.extend(spacing()?);
        fields.extend(length("size", call.scale_to, None)?);
        fields.extend(weld.then(|| ("weld".to_string(), "0.0".to_string())));
        made("surface", 3, fields)
    };
    let outline = |kind: &str| {
        let mut fields = vec![word("overlap", "union"), word("filling", "triangles")];
        fields.extend(spacing()?);
        fields.extend(length("size", call.scale_to, Some(CallFault::NoScale {}))?);
        made(kind, 2, fields)
    };
    match ending {
        "json" => outline("map"),
        _ if meshes::is_mesh(name) => {
            let path = folder.join(name);
            let read = |name: &str| -> Result<Arc<[u8]>, SceneError> {
                std::fs::read(folder.join(name)).map(Arc::from).map_err(|e| {
                    let error = SceneError::of(CallError::FileUnreadable { reason: e.to_string() });
                    SceneError { file: folder.join(name).display().to_string(), ..error }
                })
            };
            let bytes = read(name).map_err(|e| Failure::Scene(vec![e]))?;
            let found = meshes::read(name, &bytes, &mut |other| read(other))
                .map_err(|e| Failure::Scene(vec![SceneError { file: placed(call, name, &e.file), ..e }]))?;
            if found.dimension() == 2 && !found.is_plane() {
                return surface(false);
            }
            if call.size.is_some() || call.scale_to.is_some() {
                return Err(Failure::call(CallFault::HasCells { path: path.display().to_string() }));
            }
            let mending = vec![word("inverted", "turn"), word("unreferenced", "leave_out")];
            let dimension = if found.dimension() == 3 { 3 } else { 2 };
            made("mesh", dimension, if call.mend { mending } else { Vec::new() })
        }
        "obj" | "stl" | "ply" | "gltf" | "glb" => surface(call.mend),
        "ttf" | "otf" if !is_set("text") => Err(Failure::call(CallFault::NoText {})),
        _ => match kind_of_file(name) {
            Some(kind) => outline(kind),
            None => {
                let path = call.input.display().to_string();
                Err(Failure::call(match ending {
                    "toml" => CallFault::SceneAsShape { path },
                    _ => CallFault::NoShape { path, ending: visible(ending), meshes: meshes::ENDINGS },
                }))
            }
        },
    }
}

/// Makes the error about a file or an option of the call.
fn refused(call: &Call, name: &str, problem: Problem) -> Failure {
    let value = |option: &str, value: Option<f64>| value.map(|value| format!("{option} {value}"));
    let option = match problem.field {
        "spacing" => value("--size", call.size),
        "size" => value("--scale-to", call.scale_to),
        field => call.set.iter().rfind(|set| set.split('=').next() == Some(field)).map(|set| format!("--set {set}")),
    };
    let error = of_call(call, name, problem.about);
    Failure::Scene(vec![match option.filter(|_| error.line.is_none()) {
        Some(file) => SceneError { file, ..error },
        None => error,
    }])
}

/// The notices about the file.
fn file_notices(call: &Call, name: &str, notices: Vec<SceneError>) -> Vec<Notice> {
    notices.into_iter().map(|about| Notice { about: of_call(call, name, about), count: 1 }).collect()
}

/// The path of the file that an error names, in the form that the call uses. TetGen's second file is next to the first.
fn placed(call: &Call, name: &str, file: &str) -> String {
    let stem = |name: &str| name.rsplit_once('.').map(|(stem, _)| stem.to_string());
    match file {
        "" => call.input.display().to_string(),
        file if file == name || stem(file) == stem(name) => call.input.with_file_name(file).display().to_string(),
        file => file.to_string(),
    }
}

/// The option that corresponds to a setting of a shape.
fn option(setting: &Setting) -> Setting {
    let Setting::InScene { name, value } = setting else { return setting.clone() };
    let value = value.as_ref().map(|value| value.trim_matches('"'));
    Setting::InCall(match (*name, value) {
        ("weld", Some("0")) | ("inverted", Some("turn")) | ("unreferenced", Some("leave_out")) => "--mend".into(),
        ("spacing", value) => ["--size"].into_iter().chain(value).collect::<Vec<_>>().join(" "),
        ("size", None) => "--scale-to".into(),
        (name, value) => format!("--set {name}={}", value.unwrap_or("…")),
    })
}

/// Converts an error to the terms of the call: it names options of the command, and no path in a scene.
fn of_call(call: &Call, name: &str, error: SceneError) -> SceneError {
    let file = placed(call, name, &error.file);
    let by = Replacing { setting: &option, name: &str::to_string };
    SceneError { file, path: String::new(), ..error.replaced(&by) }
}

fn finish<const D: usize>(
    call: &Call,
    mesh: Mesh<D>,
    notices: &[Notice],
    out: Option<(&Path, String)>,
) -> Result<u8, Failure> {
    let refuse = |error: opruga::mesh::MeshError| Failure::call(error);
    let mesh = if call.order == 2 { mesh.into_quadratic().map_err(refuse)? } else { mesh };
    let Some(quality) = mesh.cell_quality() else {
        return Err(Failure::call(CallFault::NothingFills {}));
    };
    let (mut written, mut left_out) = (Vec::new(), Vec::new());
    if let Some((path, ending)) = &out {
        let named = |error: SceneError| Failure::Scene(vec![SceneError { file: path.display().to_string(), ..error }]);
        let mesh = meshes::write(&mesh, ending).map_err(named)?;
        written.extend(mesh.files.into_iter().map(|(ending, bytes)| (path.with_extension(ending), bytes)));
        left_out = mesh.left_out;
    }
    if call.strict {
        // Notices about what the call itself asks for are reported, but are not errors.
        let odd = notices.iter().filter(|notice| !Notice::is_asked_for(notice.about.code));
        let of_format = left_out.iter().map(|what| {
            let error = SceneError::of(NotInFormat::LeftOutOfFormat { what: what.clone() });
            SceneError { file: out.as_ref().map_or(String::new(), |(path, _)| path.display().to_string()), ..error }
        });
        let errors: Vec<SceneError> = odd.map(|notice| notice.about.clone()).chain(of_format).collect();
        if !errors.is_empty() {
            return Err(Failure::Scene(errors));
        }
    }
    if let Some(path) = picture_of(call, out.as_ref()) {
        written.push((path, drawn(&mesh, &call.input)?));
    }
    // No file is written unless all of them can be written.
    written.iter().try_for_each(|(path, _)| try_write(path, call.force))?;
    let mut files = Vec::new();
    for (path, bytes) in &written {
        safe_write(path, call.force, |out| out.write_all(bytes))?;
        files.push(path.display().to_string());
    }
    print(call, &mesh, &quality, notices, &left_out, &files)?;
    Ok(if quality.inverted == 0 { 0 } else { 1 })
}

/// The kinds of cells with their counts.
fn kinds<const D: usize>(mesh: &Mesh<D>) -> Vec<(Element, usize)> {
    let mut out: Vec<(Element, usize)> = Vec::new();
    for (element, ..) in mesh.cells.iter() {
        match out.last_mut() {
            Some((last, count)) if *last == element => *count += 1,
            _ => out.push((element, 1)),
        }
    }
    out
}

fn print<const D: usize>(
    call: &Call,
    mesh: &Mesh<D>,
    quality: &CellQuality,
    notices: &[Notice],
    left_out: &[LeftOut],
    files: &[String],
) -> Result<(), Failure> {
    let degrees = |angle: f64| angle.to_degrees();
    let kinds = kinds(mesh);
    if call.json {
        let cells: serde_json::Map<String, serde_json::Value> =
            kinds.iter().map(|(kind, count)| (kind.to_string(), json!(count))).collect();
        let warnings: Vec<serde_json::Value> = notices
            .iter()
            .map(|n| json!({"code": n.about.code, "message": n.about.message, "count": n.count}))
            .collect();
        let row = json!({
            "schema": 1, "input": call.input.display().to_string(), "dimension": D, "nodes": mesh.nodes(), "cells": cells,
            "measure": quality.measure, "inverted": quality.inverted,
            "smallest_angle": degrees(quality.smallest_angle), "largest_angle": degrees(quality.largest_angle),
            "shortest_edge": quality.shortest_edge, "longest_edge": quality.longest_edge,
            "groups": mesh.groups.keys().collect::<Vec<_>>(), "cell_groups": mesh.cell_groups.keys().collect::<Vec<_>>(),
            "cell_values": mesh.cell_values.keys().collect::<Vec<_>>(),
            "node_values": mesh.node_values.keys().collect::<Vec<_>>(),
            "warnings": warnings, "left_out": left_out.iter().map(LeftOut::to_string).collect::<Vec<_>>(), "files": files,
        });
        return print_data(&format!("{row}\n"));
    }
    for notice in notices {
        eprintln!("{}", notice.text(translation()));
    }
    let cells: Vec<String> = kinds.iter().map(|(kind, count)| format!("{count} {}", plural(*kind, *count))).collect();
    let (of, unit) = if D == 2 { ("area", "m²") } else { ("volume", "m³") };
    let angle = if D == 2 { "angles of corners" } else { "angles between faces" };
    let mut text = format!(
        "{}, {}, {} inverted\n{of} {} {unit}, {angle} {:.2}° to {:.2}°, edges {} m to {} m\n",
        counted(mesh.nodes() as u64, "node", "nodes"),
        cells.join(", "),
        quality.inverted,
        number(quality.measure),
        degrees(quality.smallest_angle),
        degrees(quality.largest_angle),
        rounded(quality.shortest_edge, 4),
        rounded(quality.longest_edge, 4)
    );
    let names = |list: Vec<&String>| list.iter().map(|n| visible(n)).collect::<Vec<_>>().join(", ");
    for (what, list) in [
        ("groups of nodes", mesh.groups.keys().collect::<Vec<_>>()),
        ("groups of cells", mesh.cell_groups.keys().collect()),
        ("values of cells", mesh.cell_values.keys().collect()),
        ("values of nodes", mesh.node_values.keys().collect()),
    ] {
        if !list.is_empty() {
            text += &format!("{what}: {}\n", names(list));
        }
    }
    for what in left_out {
        let note = NotInFormat::LeftOutOfFormat { what: what.clone() };
        text += &format!("{}\n", in_words(translation(), &note));
    }
    for file in files {
        text += &format!("written: {file}\n");
    }
    print_data(&text)
}

fn plural(kind: Element, count: usize) -> String {
    let one = kind.to_string();
    match one.strip_suffix("hedron") {
        _ if count == 1 => one,
        Some(stem) => format!("{stem}hedra"),
        None => format!("{one}s"),
    }
}

/// A picture of the mesh: complete and, in space, also cut open. The colours show the smallest angle of the cells at a node.
fn drawn<const D: usize>(mesh: &Mesh<D>, input: &Path) -> Result<Vec<u8>, draw::DrawError> {
    let positions: Vec<[f64; 3]> =
        mesh.positions.iter().map(|x| [x[0], x[1], x.get(2).copied().unwrap_or(0.0)]).collect();
    let scalar = smallest_angles(mesh);
    let body = |facets: Facets, cells: Vec<[u32; 3]>, segments: Vec<[u32; 2]>| BodyPicture {
        positions: positions.clone(),
        facets,
        cells,
        segments,
        scalar: scalar.clone(),
        ..BodyPicture::default()
    };
    let name = PathBuf::from(input).file_name().map_or(String::new(), |name| name.to_string_lossy().into_owned());
    let picture = |body: BodyPicture, title: String| Picture {
        dimension: D as u8,
        time: f64::NAN,
        title,
        bodies: vec![body],
        legend: Some(Legend {
            label: "smallest angle".into(),
            unit: "°".into(),
            range: Some([0.0, 60.0]),
            map: ColourMap::default(),
        }),
        ..Picture::default()
    };
    let mut pictures = Vec::new();
    if D == 2 {
        let mut cells = mesh.cells.triangles.clone();
        for &[a, b, c, d] in &mesh.cells.quadrilaterals {
            cells.extend([[a, b, c], [a, c, d]]);
        }
        cells.extend(mesh.cells.quadratic_triangles.iter().flat_map(triangle_parts));
        let outline = Facets::Edges(mesh.facets.iter().map(|f| [f[0], f[1]]).collect());
        pictures.push(picture(body(outline, cells, sides(mesh, |_| true)), name));
    } else {
        let surface =
            |mesh: &Mesh<D>| -> Vec<[u32; 3]> { mesh.facets.iter().map(|f| [f[0], f[1], f[D - 1]]).collect() };
        let outer: Vec<bool> = on_surface(mesh);
        let lines = sides(mesh, |edge| edge.iter().all(|node| outer[*node as usize]));
        pictures.push(picture(body(Facets::Triangles(surface(mesh)), Vec::new(), lines), name));
        // Cells in front of the centre are removed.
        let depth = |nodes: &[u32]| nodes.iter().map(|n| positions[*n as usize][2]).sum::<f64>() / nodes.len() as f64;
        let (low, high) =
            positions.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| (l.min(p[2]), h.max(p[2])));
        let behind = |nodes: &[u32]| depth(nodes) < 0.5 * (low + high);
        let mut half = mesh.clone();
        half.groups.clear();
        half.cell_groups.clear();
        half.cell_values.clear();
        half.skin = None;
        half.cells.tetrahedra.retain(|nodes| behind(nodes));
        half.cells.hexahedra.retain(|nodes| behind(nodes));
        half.cells.quadratic_tetrahedra.retain(|nodes| behind(nodes));
        if let Ok(facets) = half.facets_from_cells() {
            half.facets = facets;
            let outer = on_surface(&half);
            let lines = sides(&half, |edge| edge.iter().all(|node| outer[*node as usize]));
            pictures.push(picture(body(Facets::Triangles(surface(&half)), Vec::new(), lines), "cut open".into()));
        }
    }
    let view = draw::View::fit(&pictures)?;
    if let [only] = &pictures[..] {
        return draw::draw(only, &view, &draw::Style::film(&view, D as u8, 1200))?.to_png();
    }
    let panels: Vec<&Picture> = pictures.iter().collect();
    draw::strip(&panels, &view, &draw::StripStyle { columns: Some(panels.len()), ..draw::StripStyle::default() })?
        .to_png()
}

/// For each node, whether a facet uses it.
fn on_surface<const D: usize>(mesh: &Mesh<D>) -> Vec<bool> {
    let mut outer = vec![false; mesh.nodes()];
    mesh.facets.iter().flatten().for_each(|node| outer[*node as usize] = true);
    outer
}

/// The sides of cells between corners and midpoint nodes. Each side occurs once.
fn sides<const D: usize>(mesh: &Mesh<D>, wanted: impl Fn(&[u32; 2]) -> bool) -> Vec<[u32; 2]> {
    let mut straight = mesh.clone();
    straight.facets.clear();
    straight.cells.quadratic_triangles.clear();
    straight.cells.quadratic_tetrahedra.clear();
    let mut edges = straight.edges(opruga::mesh::EdgeSet::All);
    for cell in &mesh.cells.quadratic_triangles {
        for ([i, j], middle) in opruga::mesh::TRIANGLE_SIDES.into_iter().zip(3..) {
            edges.extend([[cell[i], cell[middle]], [cell[j], cell[middle]]]);
        }
    }
    for cell in &mesh.cells.quadratic_tetrahedra {
        for ([i, j], middle) in opruga::mesh::TETRAHEDRON_EDGES.into_iter().zip(4..) {
            edges.extend([[cell[i], cell[middle]], [cell[j], cell[middle]]]);
        }
    }
    edges.iter_mut().for_each(|edge| edge.sort_unstable());
    edges.sort_unstable();
    edges.dedup();
    edges.retain(|edge| wanted(edge));
    edges
}

/// The smallest angle of the cells at each node [°].
fn smallest_angles<const D: usize>(mesh: &Mesh<D>) -> Vec<f64> {
    let mut out = vec![180.0f64; mesh.nodes()];
    for ((_, _, nodes), angle) in mesh.cells.iter().zip(mesh.smallest_cell_angles()) {
        nodes.iter().for_each(|node| out[*node as usize] = out[*node as usize].min(angle.to_degrees()));
    }
    out
}
