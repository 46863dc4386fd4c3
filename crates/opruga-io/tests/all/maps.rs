//! Maps of the whole globe: every feature of the shipped one, the antimeridian, the poles.
#![allow(clippy::disallowed_methods, reason = "what tests expect needs no equal bits")]

use crate::common;
use common::shapes::plane;
use opruga_io::SceneError;
use opruga_mesh::signed_volume;

const COUNTRIES: &[u8] = include_bytes!("../../../../scenes/shapes/countries-110m.json");
const LAND: &[u8] = include_bytes!("../../../../scenes/shapes/land-110m.json");

/// Area, closed parts of the outline, and the codes of the notices.
fn read(map: &[u8], more: &str) -> Result<(f64, usize, Vec<&'static str>), Vec<SceneError>> {
    let (mesh, notices) = plane(&format!("kind = \"map\", file = \"a.json\", {more}"), "a.json", map)?;
    let parts = mesh.components().expect("closed").len();
    Ok((signed_volume(&mesh.facets, &mesh.positions), parts, notices.into_iter().map(|n| n.about.code).collect()))
}

fn names() -> Vec<String> {
    let map: serde_json::Value = serde_json::from_slice(COUNTRIES).expect("JSON");
    let all = map["objects"]["countries"]["geometries"].as_array().expect("geometries").clone();
    all.iter().map(|g| g["properties"]["name"].as_str().expect("a name").to_string()).collect()
}

#[test]
fn every_country_can_be_filled() {
    let names = names();
    assert_eq!(names.len(), 177);
    let mut wrong = Vec::new();
    for name in &names {
        // One whose outline crosses itself in the data needs a rule.
        for overlap in ["refuse", "union"] {
            let shape = format!(
                "layer = \"countries\", feature = \"{name}\", spacing = 0.02, size = 2.0, filling = \"triangles\", overlap = \"{overlap}\""
            );
            match read(COUNTRIES, &shape) {
                Ok((area, parts, _)) => assert!(area > 0.02 && area <= 4.0 && parts > 0, "{name}: {area}"),
                Err(e) if overlap == "refuse" && e[0].code == "shape.crossing" => continue,
                Err(e) => wrong.push(format!("{name}, {overlap}: {}", e[0])),
            }
            break;
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn countries_over_the_antimeridian_are_in_one_piece() {
    for (name, told, wide) in
        [("Fiji", "map.antimeridian", 0.5), ("Russia", "map.antimeridian", 0.2), ("Antarctica", "map.pole", 0.3)]
    {
        let shape = format!("layer = \"countries\", feature = \"{name}\", spacing = 0.01, size = 2.0");
        let (mesh, notices) = plane(&format!("kind = \"map\", file = \"a.json\", {shape}"), "a.json", COUNTRIES)
            .unwrap_or_else(|e| panic!("{}", e[0]));
        assert!(!notices.is_empty() && notices.iter().all(|n| n.about.code == told), "{name}: {}", notices[0]);
        // In degrees of the globe, Russia is 171° wide and 37° high, not 360° wide.
        let extent = |d: usize| {
            let all = mesh.positions.iter().map(|p| p[d]);
            all.clone().fold(f64::NEG_INFINITY, f64::max) - all.fold(f64::INFINITY, f64::min)
        };
        assert!(extent(1) / extent(0) > wide || name == "Antarctica", "{name}: {} × {}", extent(0), extent(1));
    }
}

#[test]
fn all_land_and_all_countries_can_be_filled() {
    let (from_layer, ..) = read(COUNTRIES, "layer = \"land\", spacing = 0.015, size = 4.0, filling = \"triangles\"")
        .unwrap_or_else(|e| panic!("{}", e[0]));
    let (from_file, ..) =
        read(LAND, "spacing = 0.015, size = 4.0, filling = \"triangles\"").unwrap_or_else(|e| panic!("{}", e[0]));
    let (together, ..) = read(
        COUNTRIES,
        "layer = \"countries\", spacing = 0.015, size = 4.0, filling = \"lattice\", overlap = \"union\"",
    )
    .unwrap_or_else(|e| panic!("{}", e[0]));
    assert!((from_layer / from_file - 1.0).abs() < 1e-2, "{from_layer}, {from_file}");
    assert!((from_layer / together - 1.0).abs() < 0.4, "{from_layer}, {together}");
}

fn collection(features: &[&str]) -> String {
    let all: Vec<String> = features
        .iter()
        .map(|geometry| format!("{{\"type\":\"Feature\",\"properties\":{{\"name\":\"a\"}},\n\"geometry\":{geometry}}}"))
        .collect();
    format!("{{\"type\":\"FeatureCollection\",\"features\":[{}]}}", all.join(","))
}

fn polygon(rings: &str) -> String {
    format!("{{\"type\":\"Polygon\",\"coordinates\":[{rings}]}}")
}

const SHAPE: &str = "spacing = 0.2, size = 8.0";

#[test]
fn a_polygon_cut_at_the_antimeridian_is_one() {
    let cut = "{\"type\":\"MultiPolygon\",\"coordinates\":[[[[176,-2],[180,-2],[180,2],[176,2],[176,-2]]],[[[-180,-2],[-176,-2],[-176,2],[-180,2],[-180,-2]]]]}";
    let (area, parts, told) = read(collection(&[cut]).as_bytes(), SHAPE).expect("one rectangle");
    assert!((area - 32.0).abs() < 1e-6 && parts == 1, "{area}, {parts}");
    assert_eq!(told, ["map.antimeridian", "map.antimeridian"]);
    // The same polygon as one ring that crosses it.
    let over = polygon("[[176,-2],[-176,-2],[-176,2],[176,2],[176,-2]]");
    let (area, parts, told) = read(collection(&[&over]).as_bytes(), SHAPE).expect("one rectangle");
    assert!((area - 32.0).abs() < 1e-6 && parts == 1 && told == ["map.antimeridian"], "{area}, {parts}, {told:?}");
    // Coordinates that are taken as they are do not mean a globe.
    let flat = read(collection(&[cut]).as_bytes(), "spacing = 2.0, size = 360.0, projection = \"none\"");
    assert_eq!(flat.map(|(_, parts, told)| (parts, told)), Ok((2, vec![])));
}

#[test]
fn what_a_map_leaves_open_is_told_or_refused() {
    let square = polygon("[[0,-2],[4,-2],[4,2],[0,2],[0,-2]]");
    let beside = polygon("[[6,-2],[8,-2],[8,2],[6,2],[6,-2]]");
    let two = collection(&[&square, &beside]);
    let named = format!("{SHAPE}, feature = \"a\"");
    assert_eq!(read(two.as_bytes(), &named).map(|(_, parts, told)| (parts, told)), Ok((2, vec!["map.features"])));
    let null = collection(&[&square, "null"]);
    assert_eq!(read(null.as_bytes(), SHAPE).map(|(_, parts, told)| (parts, told)), Ok((1, vec!["map.empty"])));
    let outside = polygon("[[0,0],[4,0],[4,4],[0,4],[0,0]],[[10,0],[12,0],[12,2],[10,2],[10,0]]");
    let error = &read(collection(&[&outside]).as_bytes(), SHAPE).expect_err("no hole")[0];
    assert_eq!((error.code, error.line, error.value.as_deref()), ("map.hole", Some(2), Some("10, 0")));
}
