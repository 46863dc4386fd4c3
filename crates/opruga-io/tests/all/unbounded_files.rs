//! Small files that ask for a lot: each is read or refused within seconds, with the count and what is allowed.
//!
//! Most of these took minutes or gigabytes. The quantities that grow are counted before they are made, so these tests need no clock; the time limit
//! is for the files that are accepted.

#![allow(clippy::disallowed_methods, reason = "what tests make needs no equal bits")]

use crate::common;
use common::cube::base64;
use common::shapes::{plane, space, surface};
use opruga_io::SceneError;
use std::time::{Duration, Instant};

/// No error.
const READ: &str = "";

/// The code of the first error, which gives the limit.
fn code<T>(read: Result<T, Vec<SceneError>>) -> &'static str {
    let Err(errors) = read else { return READ };
    let error = &errors[0];
    println!("{error}");
    assert!(error.value.is_some() && error.allowed.is_some(), "{error}");
    error.code
}

fn svg(shape: &str, text: &str) -> &'static str {
    code(plane(&format!("kind = \"svg\", file = \"a.svg\", {shape}"), "a.svg", text.as_bytes()))
}

/// The cases that took minutes end long before this limit, even on a slow and busy machine.
fn soon<T>(what: &str, work: impl FnOnce() -> T) -> T {
    let begun = Instant::now();
    let done = work();
    println!("{what}: {:.2} s", begun.elapsed().as_secs_f64());
    assert!(begun.elapsed() < Duration::from_secs(30), "{what} takes {:?}", begun.elapsed());
    done
}

fn bitmap(bytes: &[u8]) -> &'static str {
    code(plane("kind = \"bitmap\", file = \"a.png\", spacing = 0.05, size = 1.0", "a.png", bytes))
}

#[test]
fn chessboards_of_pixels_are_read_or_refused() {
    // The fields are 20,000 diamonds, then more than the parts allowed in a body, then more points than allowed.
    let cases: [(&[u8], &str); 4] = [
        (include_bytes!("../data/faults/checker200.png"), READ),
        (include_bytes!("../data/faults/checker400.png"), "limit.outlines"),
        (include_bytes!("../data/faults/checker800.png"), "limit.outlines"),
        (include_bytes!("../data/faults/checker2000.png"), "limit.points"),
    ];
    for (bytes, wanted) in cases {
        assert_eq!(soon(&format!("{} bytes", bytes.len()), || bitmap(bytes)), wanted);
    }
}

/// A picture of grey values.
fn png(width: u32, height: u32, pixel: impl Fn(u32, u32) -> u8) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    let data: Vec<u8> = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| pixel(x, y)).collect();
    let mut writer = encoder.write_header().expect("a head");
    writer.write_image_data(&data).expect("pixels");
    drop(writer);
    bytes
}

#[test]
fn noise_and_large_white_pictures_are_refused_and_nested_frames_read() {
    let noise = |x: u32, y: u32| {
        let mixed = (x.wrapping_mul(0x9e37_79b9) ^ y.wrapping_mul(0x85eb_ca6b)).wrapping_mul(0xc2b2_ae35);
        (mixed >> 24) as u8
    };
    assert_eq!(soon("noise", || bitmap(&png(1500, 1500, noise))), "limit.points");
    // The header alone announces this many pixels.
    let mut white = png(1, 1, |_, _| 255);
    white[16..24].copy_from_slice(&[9000u32.to_be_bytes(), 9000u32.to_be_bytes()].concat());
    let check = crc32fast::hash(&white[12..29]);
    white[29..33].copy_from_slice(&check.to_be_bytes());
    assert_eq!(bitmap(&white), "limit.pixels");
    // Nested frames: every ring except the outermost is inside all of those around it.
    let frames = png(1200, 1200, |x, y| {
        let edge = x.min(y).min(1199 - x).min(1199 - y);
        if edge / 2 % 2 == 0 { 0 } else { 255 }
    });
    assert_eq!(
        code(plane("kind = \"bitmap\", file = \"a.png\", spacing = 1.0, size = 1200.0", "a.png", &frames)),
        READ
    );
}

/// Pictures are read row by row.
#[test]
fn a_disc_of_pixels_has_its_area() {
    let disc = png(40, 30, |x, y| if (x as i32 - 20).pow(2) + (y as i32 - 15).pow(2) < 120 { 0 } else { 255 });
    let shape = "kind = \"bitmap\", file = \"a.png\", spacing = 0.1, size = 2.0";
    let (mesh, notices) = plane(shape, "a.png", &disc).expect("a disc");
    let area = opruga_mesh::signed_volume(&mesh.facets, &mesh.positions);
    assert!(notices.is_empty() && (area / std::f64::consts::PI - 1.0).abs() < 0.1, "{area}");
}

fn comb(teeth: usize) -> String {
    let w = 50.0 / teeth as f64;
    let teeth = format!("h{w}V99h{w}V0").repeat(teeth - 1);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 100 100\"><path d=\"M0 100V0{teeth}h{w}V99h{w}V100Z\"/></svg>"
    )
}

#[test]
fn combs_of_many_teeth_are_read_however_they_lie() {
    for teeth in [5_000, 10_000] {
        let text = comb(teeth);
        assert_eq!(soon("a comb", || svg("spacing = 0.05, size = 1.0", &text)), READ);
    }
    let slanting = comb(200).replace("<path", "<path transform=\"rotate(31)\"");
    assert_eq!(soon("a comb that is read", || svg("spacing = 0.2, size = 100.0", &slanting)), READ);
}

#[test]
fn entities_and_use_do_not_multiply_a_drawing() {
    let head = "xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 100 100\"";
    let square = "M0 0H50V50H0Z ";
    let entity = |declared: usize, named: usize| {
        format!(
            "<!DOCTYPE l [<!ENTITY a \"{}\">]><svg {head}><path d=\"{}\"/></svg>",
            square.repeat(declared),
            "&a;".repeat(named)
        )
    };
    let shape = "spacing = 5.0, size = 50.0, overlap = \"union\"";
    assert_eq!(svg(shape, &entity(4_000, 4_000)), "limit.expansion");
    assert_eq!(svg(shape, &entity(1, 3)), READ);
    // The entities that drawing programs declare for their own namespaces are short.
    let spaces =
        format!("<!DOCTYPE svg [<!ENTITY ns \"http://a/\">]><svg {head} xmlns:x=\"&ns;\"><path d=\"{square}\"/></svg>");
    assert_eq!(svg(shape, &spaces), READ);
    // Groups that each use another one twice, and draw nothing.
    let mut doubled = String::from("<g id=\"u0\"/>");
    for k in 1..60 {
        doubled += &format!("<g id=\"u{k}\"><use href=\"#u{0}\"/><use href=\"#u{0}\"/></g>", k - 1);
    }
    let nothing = format!("<svg {head}><defs>{doubled}</defs><use href=\"#u59\"/><path d=\"{square}\"/></svg>");
    assert_eq!(soon("nothing", || svg(shape, &nothing)), "limit.elements");
    // One long path, drawn a thousand times.
    let long = format!("<path id=\"p\" d=\"M0 0{}\"/>", "l1 1l-1 2".repeat(5_000));
    let many = format!("<svg {head}>{long}{}</svg>", "<use href=\"#p\"/>".repeat(1_000));
    assert_eq!(soon("a path", || svg(shape, &many)), "limit.points");
    // Rules with which all elements must be compared.
    let rules: String = (0..8_000).map(|k| format!(".c{k} .d{k}{{fill:red}}")).collect();
    let styled = format!("<svg {head}><style>{rules}</style>{}</svg>", "<g/>".repeat(8_000));
    assert_eq!(svg(shape, &styled), "limit.rules");
}

/// The long style of a group is looked up by every element in it, and every `use` looks up its id.
#[test]
fn long_styles_and_many_ids_are_looked_up_once() {
    let style: String = (0..20_000).map(|k| format!("a{k}:1;")).collect();
    let squares: String =
        (0..10_000).map(|k| format!("<rect id=\"r{k}\" x=\"{}\" width=\"1\" height=\"1\"/>", 2 * k)).collect();
    let uses: String = (0..10_000).map(|k| format!("<use href=\"#r{k}\" y=\"2\"/>")).collect();
    let text =
        format!("<svg xmlns=\"http://www.w3.org/2000/svg\"><g style=\"{style}stroke:none\">{squares}{uses}</g></svg>");
    assert_eq!(soon("styles and ids", || svg("spacing = 1.0, size = 20000.0", &text)), READ);
}

#[test]
fn a_spacing_that_makes_too_many_nodes_is_refused_before_they_are_made() {
    let square = "<svg><path d=\"M0 0H1V1H0Z\"/></svg>";
    let shape = "kind = \"svg\", file = \"a.svg\", spacing = 1e-6, size = 1.0, filling = \"triangles\"";
    let errors = plane(shape, "a.svg", square.as_bytes()).expect_err("too fine");
    assert_eq!((errors[0].code, &errors[0].path[..]), ("limit.nodes", "body.0.shape.spacing"));
    // With the suggested spacing there are as many nodes as allowed.
    let allowed = errors[0].allowed.as_deref().expect("what is allowed");
    let least: f64 = allowed.split(' ').next().and_then(|word| word.parse().ok()).expect("a number");
    assert!((1.0 / (0.866 * least * least) / (1u64 << 25) as f64 - 1.0).abs() < 0.01, "{allowed}");
    // Curves are divided as finely as the spacing requires.
    let circles = "<circle r=\"1\"/>".repeat(1_000);
    assert_eq!(
        svg("spacing = 1e-9, size = 1.0, filling = \"lattice\"", &format!("<svg>{circles}</svg>")),
        "limit.points"
    );
}

#[test]
fn a_hundred_thousand_groups_of_obj_are_read() {
    let mut text: String = (0..100_000).map(|k| format!("g g{k}\n")).collect();
    text += "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
    let (mesh, _) = soon("groups", || surface("a.obj", text.as_bytes())).expect("a tetrahedron");
    assert_eq!(mesh.groups.keys().collect::<Vec<_>>(), ["g99999"]);
}

#[test]
fn elements_of_ply_without_properties_take_no_time() {
    let file = include_bytes!("../data/faults/zero-property-element.ply");
    let (mesh, notices) = surface("a.ply", file).expect("a cube");
    assert_eq!((mesh.nodes(), notices[0].about.code), (8, "ply.element"));
}

#[test]
fn nodes_of_gltf_have_one_parent_and_meshes_are_drawn_some_million_times_at_most() {
    let file = include_bytes!("../data/faults/dag40.gltf");
    let error = &surface("a.gltf", file).expect_err("two parents")[0];
    assert_eq!((error.code, error.value.as_deref(), error.line), ("gltf.tree", Some("40"), Some(1)));
    // A cycle of nodes, and a root that is named twice.
    let text = std::str::from_utf8(file).expect("a text");
    let (children, leaf) = (text.find("\"nodes\": [{").expect("nodes"), text.find(", \"scenes\"").expect("scenes"));
    let tree = |nodes: &str, roots: &str| {
        let head = text[..children].to_string();
        assert!(leaf > children);
        format!("{head}\"nodes\": [{nodes}], \"scenes\": [{{\"nodes\": [{roots}]}}], \"scene\": 0}}")
    };
    let of = |nodes: &str, roots: &str| code(surface("a.gltf", tree(nodes, roots).as_bytes()));
    assert_eq!(of("{\"mesh\": 0}", "0"), READ);
    assert_eq!(of("{\"mesh\": 0}", "0, 0"), "gltf.tree");
    assert_eq!(of("{\"children\": [1]}, {\"children\": [0]}", "0"), "gltf.tree");
    // A hundred thousand nodes with a mesh of thousands of vertices: too many, although they are placed next to one another.
    let many = 100_000;
    let nodes: Vec<String> = (0..many).map(|k| format!("{{\"mesh\":0,\"translation\":[{},0,0]}}", 2 * k)).collect();
    let roots: Vec<String> = (0..many).map(|k| k.to_string()).collect();
    let count = 3_000;
    let buffer = base64(&vec![0; 12 * count]);
    let file = format!(
        "{{\"asset\":{{\"version\":\"2.0\"}},\"buffers\":[{{\"byteLength\":{0},\"uri\":\"data:;base64,{buffer}\"}}],\"bufferViews\":[{{\"buffer\":0,\
         \"byteLength\":{0}}}],\"accessors\":[{{\"bufferView\":0,\"componentType\":5126,\"count\":{count},\"type\":\"VEC3\"}}],\"meshes\":[{{\
         \"primitives\":[{{\"attributes\":{{\"POSITION\":0}}}}]}}],\"nodes\":[{1}],\"scenes\":[{{\"nodes\":[{2}]}}]}}",
        12 * count,
        nodes.join(","),
        roots.join(",")
    );
    assert_eq!(soon("instances", || code(surface("a.gltf", file.as_bytes()))), "limit.instances");
}

#[test]
fn arcs_of_a_topology_are_not_drawn_without_end() {
    let arc: Vec<String> = (0..1_000).map(|k| format!("[{},{}]", k % 50, k / 50)).collect();
    let ring = vec!["0"; 10_000].join(",");
    let text = format!(
        "{{\"type\":\"Topology\",\"arcs\":[[{}]],\"objects\":{{\"a\":{{\"type\":\"Polygon\",\"arcs\":[[{ring}]]}}}}}}",
        arc.join(",")
    );
    let shape = "kind = \"map\", file = \"a.topojson\", spacing = 0.2, size = 1.0";
    assert_eq!(soon("arcs", || code(plane(shape, "a.topojson", text.as_bytes()))), "limit.points");
}

#[test]
fn many_holes_in_a_long_outline_are_found_inside() {
    let n = 20_000;
    let mut ring: Vec<String> = (0..n).map(|k| format!("[{:.6},0]", 40.0 * f64::from(k) / f64::from(n))).collect();
    ring.extend(["[40,40]".into(), "[0,40]".into(), ring[0].clone()]);
    let hole = |k: u32| {
        let (x, y) = (0.2 + 0.3 * f64::from(k % 130), 1.0 + 0.3 * f64::from(k / 130));
        format!("[[{x},{y}],[{x},{}],[{},{y}],[{x},{y}]]", y + 0.1, x + 0.1)
    };
    let holes: Vec<String> = (0..15_000).map(hole).collect();
    let text = format!("{{\"type\":\"Polygon\",\"coordinates\":[[{}],{}]}}", ring.join(","), holes.join(","));
    let shape = "kind = \"map\", file = \"a.geojson\", spacing = 0.1, size = 40.0, projection = \"none\"";
    assert_eq!(soon("holes", || code(plane(shape, "a.geojson", text.as_bytes()))), READ);
}

fn zlib(bytes: &[u8]) -> Vec<u8> {
    use std::io::Write;
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
    encoder.write_all(bytes).expect("bytes");
    encoder.finish().expect("bytes")
}

#[test]
fn compressed_zeros_and_values_of_few_cells_do_not_fill_the_memory() {
    // Ten million points in ten kilobytes.
    let points: u32 = 10_000_000;
    let packed = zlib(&vec![0; 12 * points as usize]);
    let mut data: Vec<u8> = [1, 12 * points, 0, packed.len() as u32].iter().flat_map(|x| x.to_le_bytes()).collect();
    data.extend(&packed);
    let head: Vec<u8> = data.drain(..16).collect();
    let text = format!(
        "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\" compressor=\"vtkZLibDataCompressor\"><UnstructuredGrid><Piece \
         NumberOfPoints=\"{points}\" NumberOfCells=\"0\"><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"binary\">{}{}\
         </DataArray></Points></Piece></UnstructuredGrid></VTKFile>",
        base64(&head),
        base64(&data)
    );
    let mesh = "kind = \"mesh\", file = \"a.vtu\"";
    assert_eq!(code(space(mesh, &[("a.vtu", text.as_bytes())])), "limit.numbers");

    // Two thousand pieces, each with values of a separate name: four million entries for two thousand numbers, and so on.
    let piece = |k: usize| {
        format!(
            "<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><Points><DataArray type=\"Float64\">{k} 0 0 {k} 1 0 {k} 0 1 {k}.5 0 0</DataArray></Points>\
             <Cells><DataArray type=\"Int8\" Name=\"connectivity\">0 1 2 3</DataArray><DataArray type=\"Int8\" Name=\"offsets\">4</DataArray><DataArray \
             type=\"Int8\" Name=\"types\">10</DataArray></Cells><CellData><DataArray type=\"Float64\" Name=\"v{k}\">1</DataArray></CellData></Piece>"
        )
    };
    let pieces: String = (0..9_000).map(piece).collect();
    let text = format!("<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid>{pieces}</UnstructuredGrid></VTKFile>");
    assert_eq!(soon("pieces", || code(space(mesh, &[("a.vtu", text.as_bytes())]))), "limit.values");
}

/// A strip of tetrahedra that share an edge, in Gmsh 4.1.
fn msh(cells: usize, groups: usize, more: &str) -> String {
    let nodes = cells + 3;
    let list: String = (1..=nodes).map(|k| format!("{k}\n")).collect();
    let place = |k: usize| {
        let angle = 3.0 * k as f64 / nodes as f64;
        format!("{} {} {}\n", angle.cos(), angle.sin(), k % 2)
    };
    let places: String = (2..nodes).map(place).collect();
    let elements: String = (1..=cells).map(|k| format!("{k} 1 2 {} {}\n", k + 2, k + 3)).collect();
    let tags: String = (1..=groups).map(|k| format!(" {k}")).collect();
    format!(
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 1\n1 0 0 0 1 1 1 {groups}{tags} 0\n$EndEntities\n$Nodes\n1 {nodes} 1 {nodes}\n3 1 0 {nodes}\n\
         {list}0 0 0\n0 0 1\n{places}$EndNodes\n$Elements\n1 {cells} 1 {cells}\n3 1 4 {cells}\n{elements}$EndElements\n{more}"
    )
}

#[test]
fn names_of_gmsh_times_cells_are_limited() {
    let read = |text: &str| {
        let shape = "kind = \"mesh\", file = \"a.msh\", inverted = \"turn\", unreferenced = \"leave_out\"";
        code(space(shape, &[("a.msh", text.as_bytes())]))
    };
    // Sections that give no value to any cell.
    let empty = |k: usize| format!("$ElementData\n1\n\"v{k}\"\n0\n3\n0\n1\n0\n$EndElementData\n");
    let data: String = (0..9_000).map(empty).collect();
    assert_eq!(soon("values", || read(&msh(5_000, 0, &data))), "limit.values");
    assert_eq!(soon("groups", || read(&msh(5_000, 9_000, ""))), "limit.values");
}

#[test]
fn what_is_left_out_is_listed_up_to_fifty_and_counted() {
    let sections: String = (0..80).map(|k| format!("$Other{k}\n1\n$EndOther{k}\n")).collect();
    let file = include_str!("../data/meshes/mujoco/cube_41_ascii_vol_gmshApp.msh").to_string() + &sections;
    let (_, notices) = space("kind = \"mesh\", file = \"a.msh\"", &[("a.msh", file.as_bytes())]).expect("a cube");
    assert_eq!(notices.len(), 50);
    assert_eq!(notices[49].about.message, "31 more items are left out");
}
