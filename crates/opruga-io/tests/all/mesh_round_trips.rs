//! Meshes that are written and read again, in every format; the encodings of VTK XML; closed surfaces filled by a line of a scene.
#![allow(clippy::result_large_err, reason = "errors are rare, and say much")]

use crate::common;

use common::{HEAD, catalogue};
use opruga_io::Files;
use opruga_io::SceneError;
use opruga_io::meshes::{Mending, read, write};
use opruga_io::scene;
use opruga_mesh::{Cells, Mesh, NodeValues};
use opruga_world::blueprint::AnyBlueprint;
use std::collections::BTreeMap;
use std::io::Write as _;
use std::sync::Arc;

/// Written as `ending`, and read again.
fn again<const D: usize>(mesh: &Mesh<D>, ending: &str) -> Mesh<D> {
    let written = write(mesh, ending).unwrap_or_else(|e| panic!("{ending}: {e}"));
    let name = |ending: &str| format!("a.{ending}");
    let mut files: BTreeMap<String, Vec<u8>> = written.files.into_iter().map(|(e, bytes)| (name(e), bytes)).collect();
    let first = name(ending);
    let bytes = files.remove(&first).expect("the file that was asked for");
    let mut open = |other: &str| -> Result<Arc<[u8]>, SceneError> { Ok(Arc::from(files[other].clone())) };
    let (mesh, notices) = read(&first, &bytes, &mut open)
        .and_then(|file| file.assemble::<D>(Mending::default()))
        .unwrap_or_else(|e| panic!("{ending}: {e}\n{}", String::from_utf8_lossy(&bytes)));
    assert_eq!(notices, [], "{ending}");
    mesh
}

/// A box with everything that a mesh in space can contain, with groups and values.
fn solid() -> Mesh<3> {
    let mut mesh = Mesh::grid([0.1, -0.2, 1.0 / 3.0], [3.0, 1.0, 2.0], [3, 1, 2]).unwrap();
    mesh.cell_groups.insert("hard rubber".into(), vec![0, 2, 5]);
    mesh.cell_groups.insert("end".into(), vec![2]);
    mesh.cell_values.insert("Young's modulus".into(), vec![1e5, 2.5, 1e-7, 0.1, 3.0, 1.0 / 3.0]);
    let nodes = mesh.nodes();
    let of_nodes = |components: usize, from: f64| NodeValues {
        components,
        values: (0..components * nodes).map(|k| from + k as f64 / 3.0).collect(),
    };
    mesh.node_values =
        BTreeMap::from([("v [m/s]".to_string(), of_nodes(3, -2.0)), ("T".to_string(), of_nodes(1, 1e-7))]);
    mesh
}

/// A strip of triangles, quadrilaterals and curved triangles.
fn plate() -> Mesh<2> {
    let mut mesh = Mesh::<2> {
        positions: vec![
            [0.0, 0.0],
            [1.0, 0.0],
            [1.0, 1.0],
            [0.0, 1.0],
            [-1.0, 0.5],
            [2.0, 0.25],
            [1.5, 0.1],
            [1.5, 0.7],
            [1.0, 0.5],
        ],
        cells: Cells {
            triangles: vec![[0, 3, 4]],
            quadrilaterals: vec![[0, 1, 2, 3]],
            quadratic_triangles: vec![[1, 5, 2, 6, 7, 8]],
            ..Cells::default()
        },
        ..Mesh::default()
    };
    mesh.facets = mesh.facets_from_cells().unwrap();
    mesh.groups.insert("tip".into(), vec![4]);
    mesh.groups.insert("foot".into(), vec![0, 1, 4]);
    mesh
}

#[test]
fn gmsh_keeps_cells_groups_and_values() {
    let solid = solid();
    let mut expected = solid.clone();
    // Groups of cells come with the groups of their nodes.
    for (name, cells) in &solid.cell_groups {
        let mut nodes: Vec<u32> = cells.iter().flat_map(|cell| solid.cells.hexahedra[*cell as usize]).collect();
        nodes.sort_unstable();
        nodes.dedup();
        expected.groups.insert(name.clone(), nodes);
    }
    assert_eq!(again(&solid, "msh"), expected);
    assert_eq!(again(&plate(), "msh"), plate());
    let quadratic = solid.into_simplices().unwrap().into_quadratic().unwrap();
    let read = again(&quadratic, "msh");
    assert_eq!((&read.cells, &read.positions), (&quadratic.cells, &quadratic.positions));
    assert_eq!(read.cell_values, quadratic.cell_values);
    assert_eq!(read.node_values, quadratic.node_values);
}

#[test]
fn vtk_keeps_cells_and_values() {
    for ending in ["vtk", "vtu"] {
        let quadratic = solid().into_simplices().unwrap().into_quadratic().unwrap();
        for mesh in [solid(), quadratic] {
            let read = again(&mesh, ending);
            assert_eq!((&read.positions, &read.cells), (&mesh.positions, &mesh.cells), "{ending}");
            assert_eq!(read.cell_values, mesh.cell_values, "{ending}");
            assert_eq!(read.node_values, mesh.node_values, "{ending}");
            assert_eq!(write(&mesh, ending).unwrap().left_out.len(), 1, "groups are told of");
        }
        let (mesh, read) = (plate(), again(&plate(), ending));
        assert_eq!((&read.positions, &read.cells), (&mesh.positions, &mesh.cells), "{ending}");
    }
}

/// Missing values of some cells are kept in formats that support them, and reported in others.
#[test]
fn gaps_in_values_are_kept_or_told_of() {
    let mut mesh = solid().into_simplices().unwrap();
    mesh.cell_groups.clear();
    mesh.groups.clear();
    let values: Vec<f64> = (0..mesh.cells.len()).map(|k| if k == 3 { f64::NAN } else { k as f64 }).collect();
    mesh.cell_values = BTreeMap::from([("some".to_string(), values)]);
    for ending in ["msh", "vtu"] {
        let read = &again(&mesh, ending).cell_values["some"];
        assert!(read[3].is_nan() && read[4] == 4.0, "{ending}");
        assert!(write(&mesh, ending).unwrap().left_out.is_empty());
    }
    for ending in ["vtk", "ele"] {
        assert!(again(&mesh, ending).cell_values.is_empty(), "{ending}");
        assert!(!write(&mesh, ending).unwrap().left_out.is_empty(), "{ending}");
    }
}

#[test]
fn formats_of_straight_cells_keep_them_and_refuse_others() {
    let (boxes, simplices) = (solid(), solid().into_simplices().unwrap());
    let quadratic = simplices.clone().into_quadratic().unwrap();
    for ending in ["mesh", "mfem", "node", "ele"] {
        let read = again(&simplices, ending);
        assert_eq!((&read.positions, &read.cells), (&simplices.positions, &simplices.cells), "{ending}");
        assert!(!write(&simplices, ending).unwrap().left_out.is_empty(), "{ending}");
        let error = write(&quadratic, ending).unwrap_err();
        assert_eq!(error.code, "mesh.write", "{error}");
        assert!(error.message.contains("cells of second order are not written to "), "{error}");
    }
    for ending in ["mesh", "mfem"] {
        let read = again(&boxes, ending);
        assert_eq!((&read.positions, &read.cells), (&boxes.positions, &boxes.cells), "{ending}");
        // Both cells of the group `end` come back under its number.
        assert!(read.cell_groups.values().any(|cells| *cells == [2]), "{ending}: {:?}", read.cell_groups);
    }
    assert!(write(&boxes, "ele").is_err() && write(&boxes, "exe").is_err());
    assert!(write(&Mesh::icosphere(1.0, 1).unwrap(), "msh").is_err(), "a surface has no cells");
}

/// One tetrahedron with a value, as VTK XML; the caller gives the arrays.
fn vtu(attributes: &str, arrays: [&str; 5], appended: &str) -> String {
    let [points, nodes, offsets, types, values] = arrays;
    format!(
        "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" {attributes}><UnstructuredGrid><Piece NumberOfPoints=\"4\" NumberOfCells=\"1\">\n\
         <Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" {points}</DataArray></Points>\n\
         <Cells><DataArray type=\"Int32\" Name=\"connectivity\" {nodes}</DataArray><DataArray type=\"Int64\" Name=\"offsets\" {offsets}</DataArray>\n\
         <DataArray type=\"UInt8\" Name=\"types\" {types}</DataArray></Cells>\n\
         <CellData><DataArray type=\"Float64\" Name=\"E\" {values}</DataArray></CellData>\n\
         <PointData><DataArray type=\"Float32\" Name=\"u\" format=\"ascii\">1 2 3 4</DataArray></PointData>\n\
         </Piece></UnstructuredGrid>{appended}</VTKFile>\n"
    )
}

fn text_vtu() -> String {
    let arrays = [
        "format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 1",
        "format=\"ascii\">0 1 2 3",
        "format=\"ascii\">4",
        "format=\"ascii\">10",
        "format=\"ascii\">2.5e6",
    ];
    vtu("", arrays, "")
}

/// The bytes of the five arrays.
fn raw(big: bool) -> [Vec<u8>; 5] {
    let points = [0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 1.0f32];
    let order = |bytes: &[u8]| -> Vec<u8> { if big { bytes.iter().rev().copied().collect() } else { bytes.to_vec() } };
    [
        points.iter().flat_map(|x| order(&x.to_le_bytes())).collect(),
        [0i32, 1, 2, 3].iter().flat_map(|x| order(&x.to_le_bytes())).collect(),
        order(&4i64.to_le_bytes()),
        vec![10],
        order(&2.5e6f64.to_le_bytes()),
    ]
}

fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::new();
    for group in bytes.chunks(3) {
        let bits = group.iter().fold(0u32, |bits, byte| bits << 8 | u32::from(*byte)) << (8 * (3 - group.len()));
        for k in 0..4 {
            out.push(if k <= group.len() { char::from(LETTERS[(bits >> (18 - 6 * k) & 63) as usize]) } else { '=' });
        }
    }
    out
}

/// Header and zlib blocks of at most 16 bytes.
fn compressed(bytes: &[u8]) -> Vec<u8> {
    let mut head = vec![bytes.len().div_ceil(16) as u32, 16, (bytes.len() % 16) as u32];
    let mut data = Vec::new();
    for block in bytes.chunks(16) {
        let mut writer = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
        writer.write_all(block).unwrap();
        let packed = writer.finish().unwrap();
        head.push(packed.len() as u32);
        data.extend(packed);
    }
    let head: Vec<u8> = head.iter().flat_map(|x| x.to_le_bytes()).collect();
    // Header and data are encoded separately, as the padding of the first shows.
    [head, data].concat()
}

fn one(bytes: &[u8]) -> Result<(Mesh<3>, Vec<SceneError>), SceneError> {
    let mut open = |_: &str| -> Result<Arc<[u8]>, SceneError> { panic!("no other file") };
    read("a.vtu", bytes, &mut open)?.assemble(Mending::default())
}

#[test]
fn all_codings_of_vtk_xml_give_the_same_mesh() {
    let (expected, notices) = one(text_vtu().as_bytes()).unwrap();
    assert_eq!(notices, []);
    assert_eq!(expected.node_values["u"].values, [1.0, 2.0, 3.0, 4.0]);
    assert_eq!((expected.cells.tetrahedra[0], expected.cell_values["E"][0]), ([0, 1, 2, 3], 2.5e6));

    let inline = |texts: [String; 5]| texts.map(|text| format!("format=\"binary\">{text}"));
    let borrowed = |texts: &[String; 5]| -> Vec<String> { texts.to_vec() };
    let build = |attributes: &str, texts: [String; 5], appended: &str| {
        let texts = borrowed(&texts);
        vtu(attributes, core::array::from_fn(|k| texts[k].as_str()), appended)
    };
    let with_length = |big: bool| {
        raw(big).map(|bytes| {
            let length = (bytes.len() as u32).to_le_bytes();
            let length: Vec<u8> = if big { length.iter().rev().copied().collect() } else { length.to_vec() };
            [length, bytes].concat()
        })
    };
    // Encoded together, separately, big-endian, with a header of 8 bytes, compressed.
    let together = with_length(false).map(|bytes| base64(&bytes));
    let apart = with_length(false).map(|bytes| base64(&bytes[..4]) + &base64(&bytes[4..]));
    let big = with_length(true).map(|bytes| base64(&bytes));
    let long = raw(false).map(|bytes| base64(&[&(bytes.len() as u64).to_le_bytes()[..], &bytes].concat()));
    let zlib = raw(false).map(|bytes| {
        let blocks = bytes.len().div_ceil(16);
        let all = compressed(&bytes);
        base64(&all[..4 * (3 + blocks)]) + &base64(&all[4 * (3 + blocks)..])
    });
    for (what, file) in [
        ("together", build("byte_order=\"LittleEndian\"", inline(together.clone()), "")),
        ("apart", build("byte_order=\"LittleEndian\"", inline(apart), "")),
        ("big", build("byte_order=\"BigEndian\"", inline(big), "")),
        ("long", build("header_type=\"UInt64\"", inline(long), "")),
        ("zlib", build("compressor=\"vtkZLibDataCompressor\"", inline(zlib.clone()), "")),
    ] {
        let (mesh, _) = one(file.as_bytes()).unwrap_or_else(|e| panic!("{what}: {e}"));
        assert_eq!(mesh, expected, "{what}");
    }
    // At the end of the file: base64, and raw bytes.
    let offsets = |parts: &[Vec<u8>]| {
        let mut at = 0;
        let texts: Vec<String> = parts
            .iter()
            .map(|part| {
                at += part.len();
                format!("format=\"appended\" offset=\"{}\">", at - part.len())
            })
            .collect();
        <[String; 5]>::try_from(texts).unwrap()
    };
    let letters: Vec<Vec<u8>> = together.iter().map(|text| text.clone().into_bytes()).collect();
    let end = format!("<AppendedData encoding=\"base64\">\n_{}\n</AppendedData>", together.concat());
    let file = build("", offsets(&letters), &end);
    assert_eq!(one(file.as_bytes()).unwrap().0, expected);
    for packed in [false, true] {
        let parts: Vec<Vec<u8>> =
            if packed { raw(false).map(|b| compressed(&b)).to_vec() } else { with_length(false).to_vec() };
        let attributes = if packed { "compressor=\"vtkZLibDataCompressor\"" } else { "" };
        let file = build(attributes, offsets(&parts), "<AppendedData encoding=\"raw\">_@</AppendedData>");
        let (head, tail) = file.split_once('@').unwrap();
        let bytes = [head.as_bytes(), &parts.concat(), tail.as_bytes()].concat();
        assert_eq!(one(&bytes).unwrap().0, expected, "raw, packed: {packed}");
        for cut in 0..bytes.len() - 2 {
            assert!(one(&bytes[..cut]).is_err(), "{cut} of {} bytes", bytes.len());
        }
    }
}

#[test]
fn what_is_wrong_with_vtk_xml_is_told_with_its_line() {
    for (from, to, code) in [
        (">0 1 2 3<", ">0 1 2<", "vtu.size"),
        (">0 1 2 3<", ">0 1 2 4<", "mesh.index"),
        (">0 1 2 3<", ">0 1 2 -1<", "mesh.index"),
        (">0 1 2 3<", ">0 1 2 x<", "vtu.syntax"),
        (">10<", ">13<", "mesh.unsupported_element"),
        (">4<", ">5<", "vtu.size"),
        ("Float32\" NumberOfC", "Float16\" NumberOfC", "vtu.syntax"),
        ("NumberOfPoints=\"4\"", "NumberOfPoints=\"4000000000\"", "vtu.syntax"),
        ("NumberOfPoints=\"4\"", "NumberOfPoints=\"400000000\"", "vtu.size"),
        ("UnstructuredGrid\" ver", "PolyData\" ver", "vtu.syntax"),
        ("version=\"1.0\"", "compressor=\"vtkLZ4DataCompressor\"", "vtu.compressor"),
        ("0 0 0 1 0 0", "0 0 nan 1 0 0", "scene.not_finite"),
        ("</Piece>", "</Peace>", "vtu.syntax"),
        ("format=\"ascii\">2.5e6", "format=\"binary\">AAAA", "vtu.size"),
        ("format=\"ascii\">2.5e6", "format=\"appended\" offset=\"0\">", "vtu.size"),
    ] {
        let file = text_vtu();
        assert!(file.contains(from), "{from}");
        let error = one(file.replacen(from, to, 1).as_bytes()).map(|_| to).unwrap_err();
        assert_eq!(error.code, code, "{to}: {error}");
        assert!(error.line.is_some() && error.file == "a.vtu" && error.value.is_some(), "{to}: {error}");
    }
}

/// A scene whose body has this shape; the files are in memory.
fn scene_of(dimension: usize, shape: &str, files: &[(&str, Vec<u8>)]) -> Result<AnyBlueprint, Vec<SceneError>> {
    let head = HEAD.replace("dimension = 2", &format!("dimension = {dimension}"));
    let text = format!("{head}[[body]]\nname = \"it\"\nmass = 1\nshape = {{ {shape} }}\n");
    let files = Files::in_memory(files.iter().map(|(name, bytes)| (name.to_string(), Arc::from(bytes.clone()))));
    let options = scene::Options { files, ..scene::Options::default() };
    scene::read(text.as_bytes(), "scene.toml", &catalogue(), &options).map(|read| read.0)
}

fn space(blueprint: AnyBlueprint) -> Mesh<3> {
    match blueprint {
        AnyBlueprint::Space(blueprint) => (*blueprint.bodies[0].mesh).clone(),
        AnyBlueprint::Plane(_) => panic!("a scene of space"),
    }
}

#[test]
fn one_line_makes_a_body_of_a_mesh_file_or_of_a_surface() {
    let file = write(&solid(), "msh").unwrap().files.remove(0).1;
    let mesh = space(scene_of(3, "kind = \"mesh\", file = \"a.msh\"", &[("a.msh", file.clone())]).unwrap());
    assert_eq!((mesh.positions, mesh.cells), (solid().positions, solid().cells));

    // TetGen's other file is found next to the one that is named.
    let simplices = solid().into_simplices().unwrap();
    let both: Vec<(&str, Vec<u8>)> = write(&simplices, "ele")
        .unwrap()
        .files
        .into_iter()
        .map(|(e, b)| (if e == "ele" { "a.ele" } else { "a.node" }, b))
        .collect();
    for name in ["a.ele", "a.node"] {
        let mesh = space(scene_of(3, &format!("kind = \"mesh\", file = \"{name}\""), &both).unwrap());
        assert_eq!(mesh.cells, simplices.cells);
    }
    let missing = scene_of(3, "kind = \"mesh\", file = \"a.ele\"", &both[1..]).unwrap_err();
    assert_eq!(missing[0].code, "read.failed");

    let errors = scene_of(2, "kind = \"mesh\", file = \"a.msh\"", &[("a.msh", file)]).unwrap_err();
    assert_eq!((errors[0].code, errors[0].file.as_str()), ("mesh.dimension", "a.msh"), "{}", errors[0]);

    // The triangles of a mesh file form a surface, which tetrahedra fill.
    let surface =
        std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/meshes/mujoco/cube_41_binary_surf_gmshApp.msh"));
    let files = [("cube.msh", surface.unwrap())];
    let filled = "filling = \"tetrahedra\", spacing = 0.25";
    let cube = space(scene_of(3, &format!("kind = \"surface\", file = \"cube.msh\", {filled}"), &files).unwrap());
    assert!((0.9..=1.0).contains(&cube.measure().unwrap().value()) && cube.cells.tetrahedra.len() > 100);
    for shape in [
        "kind = \"icosphere\", radius = 0.5, subdivisions = 3",
        "kind = \"torus\", radius = 0.5, tube_radius = 0.25, nodes_around = 24, nodes_of_tube = 12",
        "kind = \"box\", size = [1, 1, 1], cells = [1, 1, 1]",
    ] {
        let body = space(scene_of(3, &format!("{shape}, {filled}"), &[]).unwrap());
        assert!(body.cells.tetrahedra.len() > 100 && body.cell_quality().unwrap().inverted == 0, "{shape}");
        let lattice = space(scene_of(3, &format!("{shape}, filling = \"lattice\", spacing = 0.25"), &[]).unwrap());
        assert!(lattice.skin.is_some(), "{shape}");
        let errors = scene_of(3, &format!("{shape}, filling = \"tetrahedra\""), &[]).unwrap_err();
        assert!(errors[0].message.contains("`spacing` is missing"), "{}", errors[0]);
        let errors = scene_of(3, &format!("{shape}, filling = \"tetrahedra\", spacing = 1e-4"), &[]).unwrap_err();
        assert_eq!(errors[0].code, "limit.nodes", "too many nodes are refused before they are made: {}", errors[0]);
    }
}
