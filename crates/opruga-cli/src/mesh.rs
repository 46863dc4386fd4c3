//! `opruga mesh`: a file to a mesh of cells, with its quality and a picture; also from one format to another.
#![allow(clippy::result_large_err, reason = "errors are rare, and say much")]

use crate::arguments::Mesh as Call;
use crate::failure::{Failure, print_data};
use opruga::blueprint::AnyBlueprint;
use opruga::draw::{self, BodyPicture, ColourMap, Facets, Legend, Picture};
use opruga::io::problem::visible;
use opruga::io::safe_write::safe_write;
use opruga::io::{Files, Notice, SceneError, meshes, scene};
use opruga::mesh::{CellQuality, Element, Mesh, triangle_parts};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Reads, fills, tells, draws and writes.
pub(crate) fn mesh(call: &Call) -> Result<u8, Failure> {
    for (option, value) in [("--size", call.size), ("--scale-to", call.scale_to)] {
        if let Some(value) = value.filter(|value| !(*value > 0.0 && value.is_finite())) {
            return Err(Failure::range(option, value, "numbers above 0"));
        }
    }
    let ending = |path: &Path| path.extension().map_or(String::new(), |e| e.to_string_lossy().to_ascii_lowercase());
    let out = call.out.as_deref().map(|path| (path, ending(path)));
    if let Some((path, ending)) = &out
        && !matches!(ending.as_str(), "msh" | "vtk" | "vtu" | "mesh" | "mfem" | "node" | "ele")
    {
        let message =
            format!("{} cannot be written: files ending in `.{}` are unknown", path.display(), visible(ending));
        return Err(Failure::Call { message, hint: Some(format!("{} can", meshes::WRITTEN)) });
    }
    let folder = call.input.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let Some(name) = call.input.file_name().and_then(|name| name.to_str()) else {
        return Err(Failure::call(format!("{} is no name of a file in UTF-8", call.input.display())));
    };
    let (dimension, shape) = shape(call, folder, name, &ending(&call.input))?;

    // One way from files to meshes: that of scenes.
    let order = if call.order == 2 { 2 } else { 1 };
    let text = format!(
        "format = \"opruga-1\"\ndimension = {dimension}\n[time]\nseconds = 1\n[integrator]\nkind = \"symplectic_euler\"\n\
         [[body]]\nname = \"mesh\"\nmass = 1\nshape = {{ {shape} }}\n"
    );
    let options = scene::Options { files: Files::in_folder(folder), ..scene::Options::default() };
    let told = |error: SceneError| match error.file == name {
        true => SceneError { file: call.input.display().to_string(), ..error },
        false => error,
    };
    let (blueprint, notices) = scene::read(text.as_bytes(), "opruga mesh", &opruga::catalogue(), &options)
        .map_err(|errors| Failure::Scene(errors.into_iter().map(told).collect()))?;
    match blueprint {
        AnyBlueprint::Plane(blueprint) => finish(call, &blueprint.bodies[0].mesh, order, &notices, out),
        AnyBlueprint::Space(blueprint) => finish(call, &blueprint.bodies[0].mesh, order, &notices, out),
    }
}

/// The dimension of the scene, and the shape in it.
fn shape(call: &Call, folder: &Path, name: &str, ending: &str) -> Result<(usize, String), Failure> {
    let file = format!("file = {}", json!(name));
    let extent = call.scale_to.map_or(String::new(), |size| format!(", size = {size:e}"));
    let needs = |what: &str, why: &str| Failure::Call {
        message: format!("{what} is missing"),
        hint: Some(format!("{what} {why}")),
    };
    let edge = "H: about the length of edges [m]";
    match ending {
        "svg" | "png" | "json" | "geojson" | "topojson" => {
            let kind = match ending {
                "svg" => "svg",
                "png" => "bitmap",
                _ => "map",
            };
            let size = call.size.ok_or_else(|| needs("--size", edge))?;
            let long = call.scale_to.ok_or_else(|| needs("--scale-to", "L: the longer side of the drawing [m]"))?;
            let more = format!("spacing = {size:e}, size = {long:e}, overlap = \"union\", filling = \"triangles\"");
            Ok((2, format!("kind = \"{kind}\", {file}, {more}")))
        }
        _ if meshes::is_mesh(name) => {
            let path = folder.join(name);
            let read = |name: &str| -> Result<Arc<[u8]>, SceneError> {
                std::fs::read(folder.join(name)).map(Arc::from).map_err(|e| {
                    let error = SceneError::new("read.failed", format!("the file cannot be read: {e}"));
                    SceneError { file: folder.join(name).display().to_string(), ..error }
                })
            };
            let bytes = read(name).map_err(|e| Failure::Scene(vec![e]))?;
            let found = meshes::read(name, &bytes, &mut |other| read(other))
                .map_err(|e| Failure::Scene(vec![SceneError { file: path.display().to_string(), ..e }]))?;
            let surface = found.dimension() == 2 && !found.is_plane();
            if surface {
                let size = call.size.ok_or_else(|| needs("--size", edge))?;
                return Ok((
                    3,
                    format!("kind = \"surface\", {file}, filling = \"tetrahedra\", spacing = {size:e}{extent}"),
                ));
            }
            if call.size.is_some() || call.scale_to.is_some() {
                return Err(Failure::Call {
                    message: format!("{} has cells already", path.display()),
                    hint: Some("without --size and --scale-to it is shown, and written in another format".into()),
                });
            }
            let mending = match call.mend {
                true => ", inverted = \"turn\", unreferenced = \"leave_out\"",
                false => "",
            };
            Ok((if found.dimension() == 3 { 3 } else { 2 }, format!("kind = \"mesh\", {file}{mending}")))
        }
        _ => {
            let size = call.size.ok_or_else(|| needs("--size", edge))?;
            let weld = if call.mend { ", weld = 0" } else { "" };
            Ok((3, format!("kind = \"surface\", {file}, filling = \"tetrahedra\", spacing = {size:e}{extent}{weld}")))
        }
    }
}

fn finish<const D: usize>(
    call: &Call,
    mesh: &Mesh<D>,
    order: u32,
    notices: &[Notice],
    out: Option<(&Path, String)>,
) -> Result<u8, Failure> {
    let refuse = |error: opruga::mesh::MeshError| Failure::call(error.to_string());
    let mesh = if order == 2 { mesh.clone().into_quadratic().map_err(refuse)? } else { mesh.clone() };
    let Some(quality) = mesh.cell_quality() else {
        return Err(Failure::call("the file holds nothing that fills a body"));
    };
    let mut files = Vec::new();
    let mut left_out = Vec::new();
    if let Some((path, ending)) = &out {
        let named = |error: SceneError| Failure::Scene(vec![SceneError { file: path.display().to_string(), ..error }]);
        let written = meshes::write(&mesh, ending).map_err(named)?;
        for (ending, bytes) in &written.files {
            let path = path.with_extension(ending);
            safe_write(&path, call.force, |out| out.write_all(bytes))?;
            files.push(path.display().to_string());
        }
        left_out = written.left_out;
    }
    let picture = call.picture.clone().or_else(|| out.as_ref().map(|(path, _)| path.with_extension("png")));
    if let Some(path) = picture {
        let png = drawn(&mesh, &call.input).map_err(|e| Failure::Draw(e.to_string()))?;
        safe_write(&path, call.force, |out| out.write_all(&png))?;
        files.push(path.display().to_string());
    }
    print(call, &mesh, &quality, notices, &left_out, &files)?;
    Ok(if quality.inverted == 0 { 0 } else { 1 })
}

/// Kinds of cells and how many there are of each.
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
    left_out: &[String],
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
            "warnings": warnings, "left_out": left_out, "files": files,
        });
        return print_data(&format!("{row}\n"));
    }
    for notice in notices {
        eprintln!("{notice}");
    }
    let cells: Vec<String> = kinds.iter().map(|(kind, count)| format!("{count} {}", plural(*kind, *count))).collect();
    let (of, unit) = if D == 2 { ("area", "m²") } else { ("volume", "m³") };
    let angle = if D == 2 { "angles of corners" } else { "angles between faces" };
    let mut text = format!(
        "{} nodes, {}, {} inverted\n{of} {:.6} {unit}, {angle} {:.2}° to {:.2}°, edges {:.4} m to {:.4} m\n",
        mesh.nodes(),
        cells.join(", "),
        quality.inverted,
        quality.measure,
        degrees(quality.smallest_angle),
        degrees(quality.largest_angle),
        quality.shortest_edge,
        quality.longest_edge
    );
    let names = |list: Vec<&String>| list.iter().map(|n| visible(n)).collect::<Vec<_>>().join(", ");
    for (what, list) in [
        ("groups of nodes", mesh.groups.keys().collect::<Vec<_>>()),
        ("groups of cells", mesh.cell_groups.keys().collect()),
        ("values of cells", mesh.cell_values.keys().collect()),
    ] {
        if !list.is_empty() {
            text += &format!("{what}: {}\n", names(list));
        }
    }
    for what in left_out {
        text += &format!("left out, since the format has no place for it: {what}\n");
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

/// The mesh as a picture: whole, and in space also cut open; colours tell the smallest angle of the cells at a node.
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
        // Cells in front of the middle are taken away.
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

/// Whether a facet names each node.
fn on_surface<const D: usize>(mesh: &Mesh<D>) -> Vec<bool> {
    let mut outer = vec![false; mesh.nodes()];
    mesh.facets.iter().flatten().for_each(|node| outer[*node as usize] = true);
    outer
}

/// The sides of cells between corners and nodes in their middle, each once.
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
