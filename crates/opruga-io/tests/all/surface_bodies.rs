//! Bodies from surfaces of files: size and position, repairs and notices, chambers, crossings, lattices, remeshing (torture list, section 2). The
//! formats: surfaces.rs.

use crate::common;
use common::cube::*;
use common::shapes::{space, surface};
use opruga_mesh::Mesh;

#[test]
fn size_place_and_upright_axis() {
    let of = |more: &str| {
        let text = obj().replace("v -1 1\t1", "v -1 1\t3").replace("v -1 -1\t1", "v -1 -1\t3");
        let text = text.replace("v 1 1\t1", "v 1 1\t3").replace("v 1 -1\t1", "v 1 -1\t3");
        space(&format!("kind = \"surface\", file = \"a.obj\", {more}"), &[("a.obj", text.as_bytes())]).expect(more).0
    };
    let bounds = of("size = 1.0, center = [1, 2, 3]").bounds();
    assert_eq!(bounds, ([0.75, 1.75, 2.5], [1.25, 2.25, 3.5]));
    assert_eq!(of("up = \"z\"").bounds(), ([-1.0, -2.0, -1.0], [1.0, 2.0, 1.0]));
    assert!((of("up = \"z\"").enclosed_volume() - 16.0).abs() < 1e-12);
}

#[test]
fn what_is_mended_is_counted() {
    let codes = |text: &str, more: &str| -> (Mesh<3>, Vec<(&'static str, String)>) {
        let (mesh, notices) =
            space(&format!("kind = \"surface\", file = \"a.obj\"{more}"), &[("a.obj", text.as_bytes())])
                .unwrap_or_else(|e| panic!("{}", e[0]));
        let told = notices.into_iter().map(|n| (n.about.code, n.about.value.unwrap_or_default())).collect();
        ((*mesh).clone(), told)
    };
    let told = |code: &'static str, value: &str| vec![(code, value.to_string())];
    // One square reversed, all squares reversed, a vertex that nothing uses.
    let (mesh, notices) = codes(&obj().replace("f 5/1 6//1 7/1/1 8", "f 8 7 6 5"), "");
    is_cube(&mesh);
    assert_eq!(notices, told("mesh.flipped", "2"));
    let mut turned = String::new();
    CORNERS.iter().for_each(|[x, y, z]| turned += &format!("v {x} {y} {z}\n"));
    SQUARES.iter().for_each(|[a, b, c, d]| turned += &format!("f {} {} {} {}\n", d + 1, c + 1, b + 1, a + 1));
    let (mesh, notices) = codes(&turned, "");
    is_cube(&mesh);
    assert_eq!(notices, told("mesh.flipped", "1"));
    let (mesh, notices) = codes(&format!("{}v 9 9 9\nv 8 8 8\n", obj()), "");
    is_cube(&mesh);
    assert_eq!(notices, told("mesh.unreferenced", "2"));
    let (_, notices) = codes(&format!("{}l 1 2\np 3\n", obj()), "");
    assert_eq!(notices, told("mesh.strokes", "2"));
    // An open box: refused, closed, or cloth.
    let open = obj().replace("f 5/1 6//1 7/1/1 8\r\n", "");
    let error = &surface("a.obj", open.as_bytes()).expect_err("open")[0];
    assert_eq!((error.code, error.value.as_deref()), ("mesh.open", Some("1")));
    assert!(error.hint.as_ref().is_some_and(|h| h.contains("cap")));
    let (mesh, notices) = codes(&open, ", open = \"cap\"");
    assert!((mesh.enclosed_volume() - 8.0).abs() < 1e-12 && mesh.nodes() == 9);
    assert_eq!(notices, told("mesh.capped", "1"));
    let (mesh, notices) = codes(&open, ", open = \"sheet\"");
    assert_eq!((mesh.facets.len(), mesh.sheets.len(), notices.len()), (0, 10, 0));
    // Every triangle has separate vertices: the surface is in pieces until they are welded.
    let mut soup = String::new();
    for (k, corners) in triangles().into_iter().enumerate() {
        corners.iter().for_each(|c| soup += &format!("v {} {} {}\n", CORNERS[*c][0], CORNERS[*c][1], CORNERS[*c][2]));
        soup += &format!("f {} {} {}\n", 3 * k + 1, 3 * k + 2, 3 * k + 3);
    }
    let error = &surface("a.obj", soup.as_bytes()).expect_err("in pieces")[0];
    assert!(
        error.code == "mesh.open"
            && error.hint.as_ref().is_some_and(|h| h.contains("28 vertices") && h.contains("weld")),
        "{error}"
    );
    let (mesh, notices) = codes(&soup, ", weld = 1e-6");
    is_cube(&mesh);
    assert_eq!(notices, told("mesh.welded", "28"));
}

/// Rows 26 and 38: unusual features that may be intended are counted, with the worst of them and a guess at the unit.
#[test]
fn slivers_and_odd_scales_are_told() {
    let codes = |text: &str, more: &str| -> Vec<(&'static str, Option<String>)> {
        let shape = format!("kind = \"surface\", file = \"a.obj\"{more}");
        let (_, notices) = space(&shape, &[("a.obj", text.as_bytes())]).unwrap_or_else(|e| panic!("{}", e[0]));
        notices.into_iter().map(|n| (n.about.code, n.about.value)).collect()
    };
    // A tetrahedron whose sides are long and whose front is thin.
    let needle =
        |thin: f64| format!("v 0 0 0\nv 1 0 0\nv 0 {thin} 0\nv 0 0 {thin}\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
    assert_eq!(codes(&needle(0.1), ""), []);
    assert_eq!(codes(&needle(1e-4), ""), [("mesh.sliver", Some("3".into()))]);
    assert_eq!(refused("a.obj", needle(1e-11).as_bytes()).code, "mesh.degenerate_face");
    // The cube, 2 units wide, in other units.
    let cube = |scale: f64| {
        let mut text = String::new();
        CORNERS.iter().for_each(|c| text += &format!("v {:e} {:e} {:e}\n", scale * c[0], scale * c[1], scale * c[2]));
        SQUARES.iter().for_each(|[a, b, c, d]| text += &format!("f {} {} {} {}\n", a + 1, b + 1, c + 1, d + 1));
        text
    };
    for (scale, wanted) in [(1.0, None), (1e5, Some("200000")), (1e-6, Some("0.000002"))] {
        let told: Vec<_> = wanted.map(|value| ("mesh.scale", Some(value.to_string()))).into_iter().collect();
        assert_eq!(codes(&cube(scale), ""), told, "{scale}");
        assert_eq!(codes(&cube(scale), ", size = 2.0"), [], "whoever says the size has seen it");
    }
    for scale in [1e30, 1e-30, 1e200, 1e-200, 1e308] {
        match surface("a.obj", cube(scale).as_bytes()) {
            Ok((mesh, notices)) => {
                assert!(mesh.positions.iter().flatten().all(|x| x.is_finite()), "{scale}");
                assert_eq!(notices[0].about.code, "mesh.scale", "{scale}");
            }
            Err(errors) => assert_eq!(errors[0].file, "a.obj", "{scale}: {}", errors[0]),
        }
    }
}

/// Row 35: a shell inside another one is a cavity of the same chamber; separate shells are separate chambers.
#[test]
fn shells_are_chambers_and_shells_in_them_cavities() {
    let cubes = |scales: [f64; 2], apart: f64| {
        let mut text = String::new();
        for (k, scale) in scales.into_iter().enumerate() {
            for c in CORNERS {
                let [x, y, z] = c.map(|x| scale * x);
                text += &format!("v {} {y} {z}\n", x + apart * k as f64);
            }
        }
        for first in [1, 9] {
            SQUARES.iter().for_each(|[a, b, c, d]| {
                text += &format!("f {} {} {} {}\n", a + first, b + first, c + first, d + first);
            });
        }
        surface("a.obj", text.as_bytes()).unwrap_or_else(|e| panic!("{}", e[0])).0
    };
    let (nested, beside) = (cubes([1.0, 0.5], 0.0), cubes([1.0, 0.5], 4.0));
    assert_eq!((nested.components().expect("closed").len(), nested.chambers().expect("one").len()), (2, 1));
    assert!((nested.enclosed_volume() - 7.0).abs() < 1e-12, "{}", nested.enclosed_volume());
    assert_eq!((beside.components().expect("closed").len(), beside.chambers().expect("two").len()), (2, 2));
    assert!((beside.enclosed_volume() - 9.0).abs() < 1e-12, "{}", beside.enclosed_volume());
}

#[test]
fn a_lattice_needs_a_spacing_and_a_closed_surface() {
    let of = |more: &str| {
        space(
            &format!("kind = \"surface\", file = \"a.obj\", filling = \"lattice\"{more}"),
            &[("a.obj", obj().as_bytes())],
        )
    };
    assert_eq!(of("").expect_err("no spacing")[0].code, "scene.missing");
    let (mesh, _) = of(", spacing = 0.5").expect("a lattice");
    assert!(mesh.skin.as_ref().is_some_and(|skin| skin.carriers.len() > 8) && mesh.cells.tetrahedra.len() > 100);
    assert_eq!(of(", spacing = 1e-7").expect_err("too fine")[0].code, "limit.nodes");
}

/// `cargo test --release -p opruga-io --test all surface_bodies:: -- --ignored --nocapture` prints how long it takes.
#[test]
#[ignore = "a time, which only a quiet machine and a release build make meaningful"]
fn a_million_triangles_are_read_within_two_seconds() {
    let torus = Mesh::torus(1.0, 0.4, [1000, 500]).expect("a torus");
    let mut bytes = vec![0; 80];
    bytes.extend((torus.facets.len() as u32).to_le_bytes());
    for facet in &torus.facets {
        bytes.extend([0; 12]);
        facet
            .iter()
            .flat_map(|node| torus.positions[*node as usize])
            .for_each(|x| bytes.extend((x as f32).to_le_bytes()));
        bytes.extend([0; 2]);
    }
    let start = std::time::Instant::now();
    let (mesh, notices) = surface("a.stl", &bytes).expect("a torus");
    let seconds = start.elapsed().as_secs_f64();
    println!("{} triangles, {} nodes: {seconds:.2} s", mesh.facets.len(), mesh.nodes());
    assert_eq!((mesh.nodes(), mesh.euler_characteristic(), notices.len()), (torus.nodes(), 0, 0));
    assert!(seconds < 2.0, "{seconds} s");
}

/// Row 35: a closed surface that crosses itself is refused with two triangles and a position, in every format; on request it is accepted, and the
/// crossings are counted.
#[test]
fn surfaces_that_meet_themselves_are_refused_with_their_place() {
    // A second cube, moved by half of its side: it begins at vertex 9, face 7.
    let mut twice = obj().replace("\r\n", "\n");
    let first = twice.clone();
    CORNERS.iter().for_each(|[x, y, z]| twice += &format!("v {} {} {}\n", x + 1.0, y + 0.9, z + 0.8));
    SQUARES.iter().for_each(|[a, b, c, d]| twice += &format!("f {} {} {} {}\n", a + 9, b + 9, c + 9, d + 9));
    surface("a.obj", first.as_bytes()).expect("one cube is sound");
    let error = surface("a.obj", twice.as_bytes()).expect_err("two cubes cross");
    let error = &error[0];
    assert_eq!(error.code, "mesh.self_intersection", "{error}");
    let line = twice.lines().nth(error.line.expect("a line") - 1).expect("a line");
    assert!(line.starts_with("f "), "{line}");
    assert!(error.message.contains("triangle ") && error.to_string().contains("overlap = \"keep\""), "{error}");
    let kept = space("kind = \"surface\", file = \"a.obj\", overlap = \"keep\"", &[("a.obj", twice.as_bytes())]);
    let (mesh, notices) = kept.expect("taken as it is");
    assert_eq!(mesh.facets.len(), 24);
    assert!(notices.iter().any(|n| n.about.code == "mesh.self_intersection"), "{notices:?}");

    // The same as bytes: each triangle of a binary STL, each face of a PLY and each primitive of a glTF has its location.
    let mut stl = stl_bytes();
    stl[80..84].copy_from_slice(&24u32.to_le_bytes());
    let second: Vec<u8> = stl[84..].to_vec();
    for triangle in second.chunks_exact(50) {
        let mut moved = triangle.to_vec();
        for corner in moved[12..48].chunks_exact_mut(12) {
            for (axis, word) in corner.chunks_exact_mut(4).enumerate() {
                let x = f32::from_le_bytes([word[0], word[1], word[2], word[3]]);
                word.copy_from_slice(&(x + [1.0, 0.9, 0.8][axis]).to_le_bytes());
            }
        }
        stl.extend(moved);
    }
    let error = &surface("a.stl", &stl).expect_err("two cubes cross")[0];
    assert_eq!(error.code, "mesh.self_intersection");
    let byte: usize = error.sentence(None).rsplit_once("at byte ").expect("a byte").1.parse().expect("a number");
    assert!(byte >= 84 + 12 * 50 && (byte - 84).is_multiple_of(50), "{error}");
}

/// A surface is remeshed with triangles of a desired size; a cloth is not.
#[test]
fn surfaces_are_remeshed_to_a_length() {
    let text = obj();
    let files: &[(&str, &[u8])] = &[("a.obj", text.as_bytes())];
    let shape = "kind = \"surface\", file = \"a.obj\"";
    let (mesh, notices) = space(&format!("{shape}, remesh = 0.2"), files).expect("a cube");
    assert!((600..1200).contains(&mesh.nodes()) && notices.is_empty(), "{}", mesh.nodes());
    assert!((mesh.enclosed_volume() - 8.0).abs() < 1e-9 && mesh.check().is_empty());
    let (filled, _) =
        space(&format!("{shape}, remesh = 0.2, filling = \"lattice\", spacing = 0.5"), files).expect("filled");
    assert_eq!(filled.skin.as_ref().expect("a skin").carriers.len(), mesh.nodes());
    let open = format!("{}vt 0 0\nvn 0 0 1\n", text.rsplit_once("f ").expect("a face").0);
    let files: &[(&str, &[u8])] = &[("a.obj", open.as_bytes())];
    let error = &space(&format!("{shape}, open = \"sheet\", remesh = 0.2"), files).expect_err("it is open")[0];
    assert!(error.code == "mesh.open" && error.to_string().contains("remesh"), "{error}");
    let error = &space(&format!("{shape}, remesh = 1e-5, open = \"cap\""), files).expect_err("too many nodes")[0];
    assert!(error.code.starts_with("limit.") || error.code.starts_with("scene."), "{error}");
}

/// If a size is too coarse, the error gives one that works, rounded as it was tried.
#[test]
fn a_size_that_is_too_coarse_is_answered_by_one_that_works() {
    const SPOT: &[u8] = include_bytes!("../../../../scenes/shapes/spot.obj");
    let of = |length: &str| {
        let shape = format!("kind = \"surface\", file = \"a.obj\", size = 1.0, remesh = {length}");
        space(&shape, &[("a.obj", SPOT)])
    };
    let error = &of("0.6").expect_err("legs are thinner")[0];
    let hint = error.hint.as_deref().expect("a hint");
    let works = hint.strip_prefix("`remesh = ").and_then(|rest| rest.strip_suffix("` works")).expect(hint);
    let length: f64 = works.parse().expect("a number");
    assert!(length < 0.6 && length > 0.05, "{hint}");
    let (mesh, _) = of(works).unwrap_or_else(|errors| panic!("{works}: {}", errors[0]));
    assert!(mesh.check().is_empty());
    // The next coarser one that was tried does not work.
    assert!(of(&format!("{:.1e}", length / 0.9)).is_err(), "{works} is the coarsest");
}
