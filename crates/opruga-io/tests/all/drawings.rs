//! Drawings, maps, texts and pictures: areas of good ones, and errors of bad ones.
#![allow(clippy::disallowed_methods, reason = "what tests expect needs no equal bits")]

use crate::common;
use common::shapes::{plane, svg};
use opruga_io::SceneError;
use opruga_mesh::{Mesh, signed_volume};
use std::f64::consts::PI;

fn area(mesh: &Mesh<2>) -> f64 {
    signed_volume(&mesh.facets, &mesh.positions)
}

fn drawing(inside: &str) -> String {
    format!("<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\">\n{inside}\n</svg>")
}

fn area_of(inside: &str) -> f64 {
    let (mesh, notices) = svg(&drawing(inside)).unwrap_or_else(|e| panic!("{}", e[0]));
    assert!(notices.is_empty(), "{}", notices[0]);
    area(&mesh)
}

#[test]
fn shapes_of_a_drawing_have_their_areas() {
    // The longer side becomes 2; a polygon inside a circle is a little smaller.
    let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 5e-3, "{a}, not {b}");
    near(area_of("<rect width=\"40\" height=\"20\"/>"), 2.0);
    near(area_of("<circle r=\"5\" cx=\"100\"/>"), PI);
    near(area_of("<ellipse rx=\"10\" ry=\"5\"/>"), PI / 2.0);
    near(area_of("<polygon points=\"0,0 2,0 2,2 0,2\"/>"), 4.0);
    near(area_of("<path d=\"M0 0h2v2h-2z\"/>"), 4.0);
    near(area_of("<path d=\"m1 1 2 0 0 2 -2 0z\"/>"), 4.0);
    // A circle of two arcs, one of four cubic curves, and a stadium with rounded corners.
    near(area_of("<path d=\"M-1 0A1 1 0 0 0 1 0A1 1 0 0 0-1 0z\"/>"), PI);
    near(area_of("<rect width=\"4\" height=\"2\" rx=\"1\"/>"), (2.0 * 2.0 + PI) / 4.0);
    // A parabola has 2/3 of the area of its box of 2 by 1.
    near(area_of("<path d=\"M0 0Q1 2 2 0z\"/>"), 4.0 / 3.0);
}

#[test]
fn holes_follow_the_even_odd_rule_and_transforms_keep_areas() {
    let ring = "<path fill-rule=\"evenodd\" d=\"M0 0h4v4h-4z M1 1h2v2h-2z\"/>";
    assert!((area_of(ring) - 3.0).abs() < 1e-9);
    for transform in
        ["rotate(90)", "translate(5,-7)", "scale(-3,3)", "matrix(0 1 1 0 4 4)", "translate(1) rotate(180 3 4) scale(2)"]
    {
        let turned = format!("<g transform=\"{transform}\">{ring}</g>");
        assert!((area_of(&turned) - 3.0).abs() < 1e-9, "{transform}");
    }
    let nested = format!(
        "<g transform=\"scale(2)\"><g transform=\"translate(3,3)\"><g transform=\"scale(.25)\">{ring}</g></g></g>"
    );
    assert!((area_of(&nested) - 3.0).abs() < 1e-9);
    // A rotation by 30° makes the box larger by cos 30° + sin 30°.
    let tilted = area_of("<rect width=\"2\" height=\"2\" transform=\"rotate(30)\"/>");
    assert!(
        (tilted
            - 4.0 / (1.0 + 3f64.sqrt() / 2.0 * 1.0).powi(2) * (1.0 + 0.866_025_403_784_438_6f64).powi(2)
                / (0.5 + 0.866_025_403_784_438_6f64).powi(2))
        .abs()
            < 1e-6,
        "{tilted}"
    );
}

#[test]
fn a_drawing_stands_upright() {
    let (mesh, _) = svg(&drawing("<polygon points=\"0,0 2,2 -2,2\"/>")).expect("a triangle");
    // The tip is at the top of the drawing, where y is lowest.
    let top = mesh.positions.iter().max_by(|a, b| a[1].total_cmp(&b[1])).expect("a node");
    assert!((top[0]).abs() < 1e-9 && (top[1] - 0.5).abs() < 1e-9, "{top:?}");
    assert!(area(&mesh) > 0.0);
}

#[test]
fn elements_are_found_by_id_and_used_again() {
    let two = drawing(
        "<defs><rect id=\"box\" width=\"2\" height=\"1\"/></defs><g transform=\"scale(3)\"><circle id=\"disc\" r=\"1\"/></g><use href=\"#box\" x=\"10\"/><use xlink:href=\"#box\" x=\"14\"/>",
    );
    let of = |id: &str| {
        let shape = format!("kind = \"svg\", file = \"a.svg\", spacing = 0.05, size = 2.0, path = \"{id}\"");
        plane(&shape, "a.svg", two.as_bytes())
    };
    assert!((area(&of("disc").expect("a disc").0) / PI - 1.0).abs() < 1e-3);
    assert!((area(&of("box").expect("a box").0) - 2.0).abs() < 1e-9);
    let error = &of("dics").expect_err("no such element")[0];
    assert_eq!((error.code, error.hint.as_deref()), ("svg.unknown_id", Some("did you mean `disc`?")));
    let (all, _) = svg(&two).expect("all");
    assert_eq!(all.components().expect("closed").len(), 3);
}

#[test]
fn open_paths_and_strokes_are_counted() {
    let (mesh, notices) =
        svg(&drawing("<path d=\"M0 0H4V4\"/><path d=\"M0 9L4 9\" fill=\"none\"/><image/>")).expect("a triangle");
    assert!((area(&mesh) - 2.0).abs() < 1e-9);
    let codes: Vec<&str> = notices.iter().map(|n| n.about.code).collect();
    assert_eq!(codes, ["svg.open_path", "svg.stroke", "svg.image", "shape.no_area"]);
    assert_eq!(notices[0].about.value.as_deref(), Some("2"));
}

/// Torture list, row 41. Each entry: the contents of the drawing, the code, the line.
#[test]
fn bad_drawings_are_refused_with_their_place() {
    let bomb = "<!DOCTYPE svg [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;&a;&a;&a;&a;\"><!ENTITY c \"&b;&b;&b;&b;&b;&b;&b;&b;\"><!ENTITY d \"&c;&c;&c;&c;&c;&c;&c;&c;\"><!ENTITY e \"&d;&d;&d;&d;&d;&d;&d;&d;\"><!ENTITY f \"&e;&e;&e;&e;&e;&e;&e;&e;\"><!ENTITY g \"&f;&f;&f;&f;&f;&f;&f;&f;\">]>\n<svg><title>&g;</title></svg>";
    let outside = "<!DOCTYPE svg [<!ENTITY x SYSTEM \"file:///etc/passwd\">]>\n<svg><path d=\"&x;\"/></svg>";
    let loops = "<!DOCTYPE svg [<!ENTITY x \"&y;\"><!ENTITY y \"&x;\">]>\n<svg><path d=\"&x;\"/></svg>";
    let whole: [(&str, &str, usize); 8] = [
        ("", "svg.syntax", 1),
        ("<svg>", "svg.syntax", 1),
        ("<html/>", "svg.syntax", 1),
        ("<svg><path d=\"M0 0\"", "svg.syntax", 1),
        (outside, "svg.entity", 2),
        (bomb, "svg.entity", 1),
        (loops, "svg.entity", 0),
        ("<svg>\n\n<g></svg>", "svg.syntax", 3),
    ];
    let inside: [(&str, &str, usize); 25] = [
        ("<path d=\"M0 0 L 1 x 3\"/>", "svg.syntax", 2),
        ("<path d=\"L 1 1\"/>", "svg.syntax", 2),
        ("<path d=\"M0 0 A 1 1 0 2 0 1 1\"/>", "svg.syntax", 2),
        ("<path d=\"M0 0 L1e999 0 L3 3z\"/>", "svg.syntax", 2),
        ("<path/>", "shape.no_area", 0),
        ("\n<rect width=\"-4\" height=\"2\"/>", "svg.number", 3),
        ("<rect width=\"4em\" height=\"2\"/>", "svg.unsupported", 2),
        ("<rect width=\"four\" height=\"2\"/>", "svg.syntax", 2),
        ("<circle r=\"1,5\"/>", "svg.syntax", 2),
        ("<polygon points=\"0,0 1,1 2\"/>", "svg.syntax", 2),
        ("<polygon points=\"0,0 1,1 2;3\"/>", "svg.syntax", 2),
        ("<g transform=\"rotate(\"><circle r=\"1\"/></g>", "svg.syntax", 2),
        ("<g transform=\"scale(1e300)\"><circle r=\"1e200\"/></g>", "shape.no_area", 0),
        ("<text>hello</text>", "svg.unsupported", 2),
        ("<g id=\"a\"><use href=\"#a\"/></g>", "svg.cycle", 2),
        ("<g id=\"a\"><use href=\"#b\"/></g>\n<g id=\"b\"><use href=\"#a\"/></g>", "svg.cycle", 3),
        ("<use href=\"#nobody\"/>", "svg.unknown_id", 2),
        ("<use href=\"other.svg#a\"/>", "svg.outside", 2),
        ("<g clip-path=\"url(#c)\"><circle r=\"1\"/></g>", "svg.unknown_id", 2),
        ("<svg viewBox=\"0 0 1 1\"><circle r=\"1\"/></svg>", "svg.unsupported", 2),
        ("<svg width=\"2\" height=\"2\"><circle r=\"2\"/></svg>", "svg.unsupported", 2),
        ("<blink/>", "svg.unsupported", 2),
        ("<path d=\"M0 0L4 4L4 0L0 3z\"/>", "shape.crossing", 2),
        ("<circle r=\"2\"/>\n<circle r=\"2\" cx=\"1\"/>", "shape.crossing", 3),
        ("<title>nothing here</title>", "shape.no_area", 0),
    ];
    let inside = inside.map(|(text, code, line)| (drawing(text), code, line));
    let whole = whole.map(|(text, code, line)| (text.to_string(), code, line));
    let mut wrong = Vec::new();
    for (text, code, line) in whole.into_iter().chain(inside) {
        let error = svg(&text).expect_err(&text).remove(0);
        let placed = line == 0 || (error.file == "a.svg" && error.line == Some(line));
        // Nothing from outside the file is shown.
        if error.code != code || !placed || error.value.is_none() || error.to_string().contains("root:") {
            wrong.push(format!("{text}\n{error:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn deep_drawings_are_refused_and_large_ones_read() {
    let deep = drawing(&format!("{}<circle r=\"1\"/>{}", "<g>".repeat(200), "</g>".repeat(200)));
    assert_eq!(svg(&deep).expect_err("deep")[0].code, "svg.depth");
    // Ten `use` of ten `use` of ten …: 10⁹ circles.
    let mut many = String::from("<defs><circle id=\"u0\" r=\"1\"/>");
    for k in 1..10 {
        let uses = format!("<use href=\"#u{}\"/>", k - 1).repeat(10);
        many += &format!("<g id=\"u{k}\">{uses}</g>");
    }
    let many = drawing(&format!("{many}</defs><use href=\"#u9\"/>"));
    assert_eq!(svg(&many).expect_err("many")[0].code, "limit.outlines");
    // 10⁵ points.
    let n = 100_000;
    let points: String = (0..n)
        .map(|k| {
            let angle = 2.0 * PI * f64::from(k) / f64::from(n);
            format!("{:.6},{:.6} ", 100.0 * angle.cos(), 100.0 * angle.sin())
        })
        .collect();
    let (mesh, notices) = svg(&drawing(&format!("<polygon points=\"{points}\"/>"))).expect("a circle");
    assert!((area(&mesh) / PI - 1.0).abs() < 5e-3);
    assert_eq!(notices.iter().map(|n| n.about.code).collect::<Vec<_>>(), ["shape.thinned"]);
}

#[test]
fn parts_that_overlap_are_joined_where_the_scene_says_so() {
    let text = drawing("<rect width=\"2\" height=\"2\"/><rect x=\"1\" y=\"1\" width=\"2\" height=\"2\"/>");
    let of = |more: &str| {
        let shape = format!("kind = \"svg\", file = \"a.svg\", spacing = 0.1, size = 3.0, {more}");
        plane(&shape, "a.svg", text.as_bytes()).map(|(mesh, _)| area(&mesh))
    };
    assert!((of("overlap = \"union\"").expect("a union") - 7.0).abs() < 1e-6);
    // The two remaining parts touch at two corners, where they are separated.
    assert!((of("overlap = \"even_odd\"").expect("two angles") - 6.0).abs() < 1e-6);
    let refused: SceneError = of("filling = \"triangles\"").expect_err("they cross")[0].clone();
    assert!(refused.hint.is_some_and(|hint| hint.contains("union")));
}

/// The fill colours of a drawing of two parts: inherited, by style, in per cent, from a gradient, or none.
#[test]
fn parts_are_painted_in_their_fill_colours() {
    let painted = |inside: &str| {
        let shape = "kind = \"svg\", file = \"a.svg\", spacing = 0.5, size = 4.0, overlap = \"union\", colours = true";
        let (mesh, notices) = plane(shape, "a.svg", drawing(inside).as_bytes()).unwrap_or_else(|e| panic!("{}", e[0]));
        let colours: Vec<[u8; 4]> =
            mesh.skin.as_ref().map_or_else(Vec::new, |skin| skin.areas.iter().filter_map(|area| area.colour).collect());
        (colours, notices.into_iter().map(|n| n.about.code).collect::<Vec<_>>())
    };
    let whole = "<rect width=\"8\" height=\"8\" fill=\"#fff\"/>";
    for (inside, wanted) in [
        ("<rect x=\"1\" width=\"4\" height=\"4\"/>", [0, 0, 0, 255]),
        ("<rect x=\"1\" width=\"4\" height=\"4\" fill=\"#DD2E44\"/>", [221, 46, 68, 255]),
        ("<rect x=\"1\" width=\"4\" height=\"4\" fill=\"#269\" fill-opacity=\"0.5\"/>", [34, 102, 153, 128]),
        (
            "<g fill=\"gold\" opacity=\".4\"><rect x=\"1\" width=\"4\" height=\"4\" opacity=\"50%\"/></g>",
            [255, 215, 0, 51],
        ),
        ("<g fill=\"red\"><rect x=\"1\" width=\"4\" height=\"4\" style=\"fill: rgb(1, 2, 3)\"/></g>", [1, 2, 3, 255]),
        ("<g color=\"lime\"><rect x=\"1\" width=\"4\" height=\"4\" fill=\"currentColor\"/></g>", [0, 255, 0, 255]),
        ("<rect x=\"1\" width=\"4\" height=\"4\" fill=\"url(#none) blue\"/>", [0, 0, 255, 255]),
    ] {
        assert_eq!(painted(&format!("{whole}{inside}")), (vec![[255, 255, 255, 255], wanted], vec![]), "{inside}");
    }
    // A part that is not filled is not painted.
    let none = painted(&format!("{whole}<path d=\"M1 1h2v2h-2z\" fill=\"none\"/>"));
    assert_eq!(none, (vec![[255; 4]], vec!["svg.stroke"]));
    let stops = "<stop stop-color=\"black\"/><stop offset=\"1\" stop-color=\"#204060\" stop-opacity=\"0\"/>";
    let gradient = format!(
        "<defs><linearGradient id=\"a\">{stops}</linearGradient><radialGradient id=\"b\" href=\"#a\"/></defs>\
         <circle r=\"3\" fill=\"url(#b)\"/>"
    );
    assert_eq!(painted(&gradient), (vec![[16, 32, 48, 128]], vec!["svg.gradient"]));
    let styled = "<style>.a { fill: red }</style><circle r=\"3\" class=\"a\"/>";
    assert_eq!(painted(styled), (vec![[255, 0, 0, 255]], vec![]));
    // Colours that cannot be read are refused if they are needed; otherwise they are ignored.
    for bad in ["#12", "url(#nobody)", "rgb(1,2)", "context-stroke"] {
        let text = drawing(&format!("\n<circle r=\"2\" fill=\"{bad}\"/>"));
        let shape = "kind = \"svg\", file = \"a.svg\", spacing = 0.5, size = 4.0, colours = true";
        let error = &plane(shape, "a.svg", text.as_bytes()).expect_err(bad)[0];
        assert_eq!((error.code, error.line, error.value.as_deref()), ("svg.colour", Some(3), Some(bad)));
        assert!(svg(&text).is_ok(), "{bad}");
    }
}

/// Squares around a drawing carry it as it is, with detail finer than the squares.
#[test]
fn a_coarse_lattice_carries_a_fine_outline() {
    let spikes: String = (0..400)
        .map(|k| {
            let (angle, r) = (2.0 * PI * f64::from(k) / 400.0, if k % 2 == 0 { 10.0 } else { 9.0 });
            format!("{:.6},{:.6} ", r * angle.cos(), r * angle.sin())
        })
        .collect();
    let text = drawing(&format!("<polygon points=\"{spikes}\"/>"));
    let shape = "kind = \"svg\", file = \"a.svg\", spacing = 0.5, size = 2.0, filling = \"lattice\"";
    let (mesh, notices) = plane(shape, "a.svg", text.as_bytes()).expect("a lattice");
    assert!(notices.is_empty() && mesh.nodes() < 50 && mesh.cells.quadrilaterals.len() > 9, "{}", mesh.nodes());
    let skin = mesh.skin.as_ref().expect("the outline");
    assert_eq!((skin.areas.len(), skin.areas[0].colour, skin.areas[0].rings[0].len()), (1, None, 400));
    // 200 spikes between radii 1 and 0.9: ½ · 400 · 0.9 · sin(2π/400).
    let points = skin.positions(&mesh.positions.iter().map(|p| [p[0], p[1], 0.0]).collect::<Vec<_>>());
    let ring = &skin.areas[0].rings[0];
    let twice: f64 = (0..400)
        .map(|k| {
            let (a, b) = (points[ring[k] as usize], points[ring[(k + 1) % 400] as usize]);
            a[0] * b[1] - a[1] * b[0]
        })
        .sum();
    assert!((0.5 * twice.abs() / (180.0 * (2.0 * PI / 400.0).sin()) - 1.0).abs() < 1e-4, "{twice}");
}

#[test]
fn small_parts_are_dropped_only_where_the_scene_says_so() {
    let text = drawing("<rect width=\"4\" height=\"4\"/><circle r=\"0.1\" cx=\"5\"/>");
    let shape = "kind = \"svg\", file = \"a.svg\", spacing = 0.2, size = 5.1";
    let (both, notices) = plane(shape, "a.svg", text.as_bytes()).expect("both");
    assert_eq!((both.components().expect("closed").len(), notices.len()), (2, 0));
    let (one, notices) = plane(&format!("{shape}, drop_below = 0.1"), "a.svg", text.as_bytes()).expect("one");
    assert_eq!(one.components().expect("closed").len(), 1);
    assert_eq!((notices[0].about.code, notices[0].about.value.as_deref()), ("shape.dropped", Some("1")));
    let none = plane(&format!("{shape}, drop_below = 100.0"), "a.svg", text.as_bytes());
    assert_eq!(none.expect_err("nothing is left")[0].code, "shape.no_area");
}

const SQUARE: &str = "[[0,0],[4,0],[4,4],[0,4],[0,0]]";
const HOLE: &str = "[[1,1],[1,3],[3,3],[3,1],[1,1]]";

fn map(text: &str, more: &str) -> Result<(f64, usize, Vec<opruga_io::Notice>), Vec<SceneError>> {
    let shape = format!("kind = \"map\", file = \"a.json\", spacing = 0.2, size = 4.0{more}");
    let (mesh, notices) = plane(&shape, "a.json", text.as_bytes())?;
    Ok((area(&mesh), mesh.components().expect("closed").len(), notices))
}

#[test]
fn polygons_of_maps_are_found_by_name_with_holes_and_islands() {
    let text = format!(
        r#"{{"type":"FeatureCollection","features":[
 {{"type":"Feature","id":7,"properties":{{"name":"Ring","code":"R"}},"geometry":{{"type":"Polygon","coordinates":[{SQUARE},{HOLE}]}}}},
 {{"type":"Feature","properties":{{"name":"Islands"}},"geometry":{{"type":"MultiPolygon","coordinates":[[[[0,0],[1,0],[1,1],[0,1],[0,0]]],[[[3,3,5],[4,3,5],[4,4,5],[3,4,5],[3,3,5]]]]}}}},
 {{"type":"Feature","properties":null,"geometry":null}},
 {{"type":"Feature","properties":{{"name":"Road"}},"geometry":{{"type":"LineString","coordinates":[[0,0],[1,1]]}}}}]}}"#
    );
    let flat = ", projection = \"none\"";
    for name in ["Ring", "R", "7"] {
        let (area, components, notices) = map(&text, &format!("{flat}, feature = \"{name}\"")).expect(name);
        assert!((area - 12.0).abs() < 1e-9 && components == 2 && notices.is_empty(), "{name}: {area}, {components}");
    }
    let (area, components, _) = map(&text, &format!("{flat}, feature = \"Islands\"")).expect("islands");
    assert!((area - 2.0).abs() < 1e-9 && components == 2, "{area}, {components}");
    // A road exists, but has no area; nor is it offered as the name that may have been meant.
    let error = &map(&text, ", feature = \"Road\"").expect_err("a line")[0];
    assert_eq!((error.code, error.hint.as_deref()), ("map.unknown_feature", None));
    assert_eq!(error.message, "`Road` has only points and lines");
    let error = &map(&text, ", feature = \"Roar\"").expect_err("misspelt")[0];
    assert_eq!((error.code, error.hint.as_deref()), ("map.unknown_feature", None));
    let error = &map(&text, ", feature = \"Island\"").expect_err("misspelt")[0];
    assert_eq!((error.code, error.hint.as_deref()), ("map.unknown_feature", Some("did you mean `Islands`?")));
    // The ring and the islands overlap.
    assert_eq!(map(&text, flat).expect_err("they touch")[0].code, "shape.crossing");
    let (area, _, notices) = map(&text, &format!("{flat}, overlap = \"union\"")).expect("a union");
    assert!((area - 12.0).abs() < 1e-6, "{area}");
    assert_eq!(notices[0].about.code, "mesh.strokes");
}

#[test]
fn arcs_of_a_topology_are_shared_turned_and_decoded() {
    // Two squares next to each other share arc 0; positions are differences on a grid of 0.5.
    let text = r#"{"type":"Topology","transform":{"scale":[0.5,0.5],"translate":[0,0]},
 "arcs":[[[4,0],[0,4]],[[4,4],[-4,0],[0,-4],[4,0]],[[4,0],[4,0],[0,4],[-4,0]]],
 "objects":{"two":{"type":"GeometryCollection","geometries":[
  {"type":"Polygon","arcs":[[0,1]],"id":"left"},
  {"type":"Polygon","arcs":[[2,-1]],"id":"right"}]},"one":{"type":"Polygon","arcs":[[0,1]]}}}"#;
    let flat = ", projection = \"none\"";
    for id in ["left", "right"] {
        let (area, components, _) = map(text, &format!("{flat}, layer = \"two\", feature = \"{id}\"")).expect(id);
        assert!((area - 16.0).abs() < 1e-9 && components == 1, "{id}: {area}");
    }
    let (area, components, _) = map(text, &format!("{flat}, layer = \"two\", overlap = \"union\"")).expect("both");
    assert!((area - 8.0).abs() < 1e-6 && components == 1, "{area}");
    assert_eq!(map(text, flat).expect_err("two layers")[0].code, "map.unknown_layer");
    let error = &map(text, ", layer = \"tow\"").expect_err("misspelt")[0];
    assert_eq!((error.code, error.hint.as_deref()), ("map.unknown_layer", Some("did you mean `two`?")));
}

#[test]
fn bad_maps_are_refused_with_their_place() {
    let polygon = |coordinates: &str| format!("{{\"type\":\"Polygon\",\n\"coordinates\":{coordinates}}}");
    let arcs = |index: &str| {
        format!(
            "{{\"type\":\"Topology\",\"arcs\":[[[0,0],[1,0],[1,1],[0,0]]],\n\"objects\":{{\"a\":{{\"type\":\"Polygon\",\"arcs\":[[{index}]]}}}}}}"
        )
    };
    for (text, code, line) in [
        ("".to_string(), "json.syntax", 1),
        ("{".to_string(), "json.syntax", 1),
        ("{\n\"type\":}".to_string(), "json.syntax", 2),
        ("{\"type\":\"Sphere\"}".to_string(), "map.syntax", 1),
        ("{\"type\":\"Polygon\"}".to_string(), "map.syntax", 1),
        (polygon("[[[0,0],[1,0],[1,1]]]"), "map.syntax", 2),
        (polygon("[[[0,0],[1,0],[1,1],[0,1]]]"), "map.syntax", 2),
        (polygon("[[[0],[1,0],[1,1],[0]]]"), "map.syntax", 2),
        (polygon("[[[0,0],[1,\"0\"],[1,1],[0,0]]]"), "json.syntax", 2),
        (polygon("[[[0,0],[1,1e999],[1,1],[0,0]]]"), "json.syntax", 2),
        (polygon("[[[0,0],[1,95],[1,1],[0,0]]]"), "map.range", 1),
        (polygon("[[[0,0],[4,4],[4,0],[0,3],[0,0]]]"), "shape.crossing", 1),
        (arcs("5"), "map.arc", 2),
        (arcs("-2"), "map.arc", 2),
        (arcs("9223372036854775807"), "map.arc", 2),
        (format!("{}1{}", "[".repeat(100_000), "]".repeat(100_000)), "json.syntax", 1),
        (
            format!(
                "{}{{\"type\":\"Point\"}}{}",
                "{\"type\":\"GeometryCollection\",\"geometries\":[".repeat(40),
                "]}".repeat(40)
            ),
            "map.depth",
            1,
        ),
    ] {
        let short: String = text.chars().take(200).collect();
        let error = map(&text, "").expect_err(&short).remove(0);
        assert_eq!((error.code, error.line, error.file.as_str()), (code, Some(line), "a.json"), "{short}\n{error}");
        assert!(error.value.is_some(), "{error}");
    }
}

const FONT: &[u8] = include_bytes!("../../../../scenes/shapes/inter-black-subset.otf");

fn text(words: &str, more: &str) -> Result<(std::sync::Arc<Mesh<2>>, Vec<opruga_io::Notice>), Vec<SceneError>> {
    plane(
        &format!("kind = \"text\", file = \"f.otf\", text = \"{words}\", spacing = 0.03, size = 1.5{more}"),
        "f.otf",
        FONT,
    )
}

#[test]
fn letters_have_their_counters() {
    // Components of the skin: outer rings and counters; i has a dot, B two counters.
    for (words, rings, chambers) in [("l", 1, 1), ("o", 2, 1), ("B", 3, 1), ("i", 2, 2), ("o l", 3, 2), ("č", 2, 2)] {
        let (mesh, notices) = text(words, "").unwrap_or_else(|e| panic!("{words}: {}", e[0]));
        assert!(notices.is_empty());
        assert_eq!(mesh.components().expect("closed").len(), rings, "{words}");
        assert_eq!(mesh.chambers().expect("chambers").len(), chambers, "{words}");
        let (filled, _) = text(words, ", filling = \"triangles\"").expect("filled");
        let edges = filled.edges(opruga_mesh::EdgeSet::All).len() as i64;
        // V − E + T: one for every piece, minus one for every hole.
        let euler = filled.nodes() as i64 - edges + filled.cells.len() as i64;
        assert_eq!(euler, 2 * chambers as i64 - rings as i64, "{words}");
        assert!((area(&filled) / area(&mesh) - 1.0).abs() < 1e-9);
    }
    let error = &text("日", "").expect_err("not in the font")[0];
    assert_eq!((error.code, error.value.as_deref(), error.line), ("font.no_glyph", Some("日"), Some(10)));
    for empty in ["", "   "] {
        let error = &text(empty, "").expect_err("no outline")[0];
        assert_eq!((error.code, error.line), ("shape.no_area", Some(10)), "{error}");
        assert!(error.message.starts_with("the text"), "{error}");
    }
    // Letters that join, run from right to left, or are placed on others.
    for script in ["سلام", "שלום", "नमस्ते", "e\\u0301"] {
        let error = &text(script, "").expect_err(script)[0];
        assert_eq!((error.code, error.line), ("font.script", Some(10)), "{error}");
    }
    let cut =
        plane("kind = \"text\", file = \"f.otf\", text = \"a\", spacing = 0.1, size = 1.0", "f.otf", &FONT[..100]);
    assert_eq!(cut.expect_err("cut off")[0].code, "font.syntax");
}

fn picture(width: u32, height: u32, pixel: impl Fn(u32, u32) -> u8) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Eight);
    let data: Vec<u8> = (0..width * height).map(|k| pixel(k % width, k / width)).collect();
    encoder.write_header().expect("a header").write_image_data(&data).expect("pixels");
    bytes
}

#[test]
fn contours_of_a_picture_follow_its_pixels() {
    // A dark disc of radius 30 pixels with a bright hole of radius 12, smoothed over a pixel.
    let disc = picture(80, 100, |x, y| {
        let r = (f64::from(x) - 39.5).hypot(f64::from(y) - 49.5);
        let edge = |radius: f64| (r - radius + 0.5).clamp(0.0, 1.0);
        (255.0 * (1.0 - (1.0 - edge(30.0)) * edge(12.0))) as u8
    });
    let shape = "kind = \"bitmap\", file = \"a.png\", spacing = 0.05, size = 2.0";
    let (mesh, _) = plane(shape, "a.png", &disc).expect("a ring");
    assert_eq!((mesh.components().expect("closed").len(), mesh.chambers().expect("one").len()), (2, 1));
    let wanted = PI * (1.0 - 0.16);
    assert!((area(&mesh) / wanted - 1.0).abs() < 0.01, "{} and {wanted}", area(&mesh));
    // The bright part: the hole, and everything around.
    let (bright, _) = plane(&format!("{shape}, inside = \"bright\""), "a.png", &disc).expect("the rest");
    assert_eq!(bright.chambers().expect("two").len(), 2);
    // An upright picture: dark in the upper half only.
    let upper = picture(20, 20, |x, y| if y < 10 && x > 2 && x < 17 { 0 } else { 255 });
    let (half, _) =
        plane("kind = \"bitmap\", file = \"a.png\", spacing = 0.2, size = 2.0", "a.png", &upper).expect("half");
    assert!(area(&half) > 0.0);
    let all_dark = picture(9, 9, |_, _| 0);
    let (whole, _) =
        plane("kind = \"bitmap\", file = \"a.png\", spacing = 0.2, size = 2.0", "a.png", &all_dark).expect("all of it");
    assert!((area(&whole) - 4.0).abs() < 0.1, "{}", area(&whole));
}

#[test]
fn bad_pictures_are_refused() {
    let good = picture(9, 9, |x, _| if x < 4 { 0 } else { 255 });
    let shape = "kind = \"bitmap\", file = \"a.png\", spacing = 0.2, size = 2.0";
    for end in 0..good.len() {
        if let Err(errors) = plane(shape, "a.png", &good[..end]) {
            assert_eq!((errors[0].code, errors[0].file.as_str()), ("png.syntax", "a.png"), "{end} bytes");
        }
    }
    let white = picture(9, 9, |_, _| 255);
    let error = &plane(shape, "a.png", &white).expect_err("nothing dark")[0];
    assert_eq!((error.code, &error.message[..]), ("shape.no_area", "no pixel is more dark than the threshold"));
    // A header that announces 10¹⁰ pixels.
    let mut huge = good.clone();
    huge[16..24].copy_from_slice(&[0, 1, 0x86, 0xa0, 0, 1, 0x86, 0xa0]);
    assert!(plane(shape, "a.png", &huge).is_err());
}
