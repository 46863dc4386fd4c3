//! The shapes that come with the scenes, measured in a second way: directly from the numbers in their files, by formulas that share no code with the
//! readers, and compared with published numbers.
#![allow(clippy::disallowed_methods, reason = "what tests expect needs no equal bits")]

use opruga::blueprint::AnyBlueprint;
use opruga::catalogue;
use opruga::io::{Files, SceneError, scene};
use opruga::mesh::{Mesh, signed_volume};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

fn tried(dimension: u8, shape: &str) -> Result<AnyBlueprint, Vec<SceneError>> {
    let text = format!(
        "format = \"opruga-1\"\ndimension = {dimension}\n[time]\nseconds = 1\n[integrator]\nkind = \"verlet\"\n\
         [[body]]\nname = \"it\"\nmass = 1\nshape = {{ {shape} }}\n"
    );
    // Some of the shapes are only for tests, and not part of the program.
    let options = scene::Options { files: Files::in_folder(folder().join("..")), ..scene::Options::default() };
    scene::read(text.as_bytes(), "test.toml", &catalogue(), &options).map(|read| read.0)
}

fn read(dimension: u8, shape: &str) -> AnyBlueprint {
    tried(dimension, shape).unwrap_or_else(|errors| panic!("{shape}: {}", errors[0]))
}

fn plane(shape: &str) -> Arc<Mesh<2>> {
    let AnyBlueprint::Plane(blueprint) = read(2, shape) else { panic!("a shape of the plane") };
    blueprint.bodies[0].mesh.clone()
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/shapes")
}

/// Every shape that is shipped is measured: surfaces and maps here, drawings and letters in shipped_shapes.rs.
#[test]
fn every_shape_that_is_shipped_is_measured() {
    let entries = std::fs::read_dir(folder()).expect("shapes");
    let names = entries.map(|entry| entry.expect("an entry").file_name().into_string().expect("a name"));
    let shapes: BTreeSet<String> =
        names.filter(|name| !name.contains("LICENSE") && !name.starts_with("README")).collect();
    let drawn = ["heart.svg", "star.svg", "drop.svg", "apple.svg", "fish.svg", "inter-black-subset.otf"];
    let maps = ["countries-110m.json", "land-110m.json"];
    let mut known: BTreeSet<String> = drawn.iter().chain(&maps).map(|name| name.to_string()).collect();
    known.extend(SURFACES.iter().map(|(name, ..)| format!("{name}.obj")));
    known.insert("CREDITS.md".into());
    assert_eq!(shapes, known);
}

/// Surface, vertices, triangles, V − E + F, volume: of Spot, boxes of 1 m, and polyhedra inscribed in a torus of 1 m and 0.5 m and in a ball of 1 m.
const SURFACES: [(&str, usize, usize, i64, f64); 5] = [
    ("spot", 2930, 5856, 2, 0.718_258_788),
    ("torus", 400, 800, 0, 4.774_581_347),
    ("cube", 8, 12, 2, 1.0),
    ("cube_5", 152, 300, 2, 1.0),
    ("sphere", 382, 760, 2, 4.094_867_320),
];

type Point = [f64; 3];

/// Vertices and triangles of an OBJ file, word by word.
fn raw_surface(name: &str) -> (Vec<Point>, Vec<[usize; 3]>) {
    let text = std::fs::read_to_string(folder().join(format!("{name}.obj"))).expect("a surface");
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words.split_first() {
            Some((&"v", rest)) => {
                let number = |k: usize| rest[k].parse::<f64>().expect("a coordinate");
                vertices.push([number(0), number(1), number(2)]);
            }
            Some((&"f", rest)) => {
                let corner =
                    |k: usize| rest[k].split('/').next().and_then(|w| w.parse::<usize>().ok()).expect("a number") - 1;
                triangles.extend((1..rest.len() - 1).map(|k| [corner(0), corner(k), corner(k + 1)]));
            }
            _ => {}
        }
    }
    (vertices, triangles)
}

/// ∮ x·n dA / 3, triangle by triangle: a sixth of det(a, b, c).
fn by_divergence(vertices: &[Point], triangles: &[[usize; 3]]) -> f64 {
    let sixth = |[a, b, c]: &[usize; 3]| {
        let (a, b, c) = (vertices[*a], vertices[*b], vertices[*c]);
        let cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
        (a[0] * cross[0] + a[1] * cross[1] + a[2] * cross[2]) / 6.0
    };
    triangles.iter().map(sixth).sum()
}

/// The positions of rays within their cells: never on edges of regular surfaces, which two triangles share.
const OFF: [f64; 2] = [0.487_31, 0.513_47];

/// The total length inside of rays along z, from entry to exit, whatever the orientation of the triangles: a grid of `rays` by `rays` rays.
fn by_rays(vertices: &[Point], triangles: &[[usize; 3]], rays: usize) -> f64 {
    let edge = |pick: fn(f64, f64) -> f64, from: f64, axis: usize| vertices.iter().fold(from, |x, v| pick(x, v[axis]));
    let low = [0, 1].map(|axis| edge(f64::min, f64::INFINITY, axis));
    let step = [0, 1].map(|axis| (edge(f64::max, f64::NEG_INFINITY, axis) - low[axis]) / rays as f64);
    let mut crossings: Vec<Vec<f64>> = vec![Vec::new(); rays * rays];
    for corners in triangles {
        let [a, b, c] = corners.map(|k| vertices[k]);
        let side = |p: Point, q: Point, x: f64, y: f64| (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0]);
        let doubled = side(a, b, c[0], c[1]);
        let range = |axis: usize| {
            let (least, most) = (a[axis].min(b[axis]).min(c[axis]), a[axis].max(b[axis]).max(c[axis]));
            let cell = |x: f64| (((x - low[axis]) / step[axis] - OFF[axis]).max(0.0) as usize).min(rays - 1);
            cell(least)..=cell(most)
        };
        for i in range(0) {
            for j in range(1) {
                let (x, y) = (low[0] + (i as f64 + OFF[0]) * step[0], low[1] + (j as f64 + OFF[1]) * step[1]);
                let [u, v, w] = [side(b, c, x, y), side(c, a, x, y), side(a, b, x, y)].map(|s| s / doubled);
                if doubled != 0.0 && u >= 0.0 && v >= 0.0 && w >= 0.0 {
                    crossings[i * rays + j].push(u * a[2] + v * b[2] + w * c[2]);
                }
            }
        }
    }
    let mut length = 0.0;
    for ray in &mut crossings {
        ray.sort_by(f64::total_cmp);
        assert!(ray.len() % 2 == 0, "a ray goes in and comes out: {ray:?}");
        length += ray.chunks_exact(2).map(|pair| pair[1] - pair[0]).sum::<f64>();
    }
    length * step[0] * step[1]
}

#[test]
fn surfaces_have_the_volume_of_their_raw_triangles_and_that_which_rays_find_inside() {
    for (name, nodes, facets, euler, volume) in SURFACES {
        let AnyBlueprint::Space(blueprint) = read(3, &format!("kind = \"surface\", file = \"shapes/{name}.obj\""))
        else {
            panic!("a shape of space");
        };
        let mesh = &blueprint.bodies[0].mesh;
        assert_eq!((mesh.nodes(), mesh.facets.len(), mesh.euler_characteristic()), (nodes, facets, euler), "{name}");
        let (vertices, triangles) = raw_surface(name);
        let edges: BTreeSet<[usize; 2]> = triangles
            .iter()
            .flat_map(|[a, b, c]| [[*a, *b], [*b, *c], [*c, *a]])
            .map(|[p, q]| [p.min(q), p.max(q)])
            .collect();
        assert_eq!(vertices.len() as i64 - edges.len() as i64 + triangles.len() as i64, euler, "{name}");
        let (found, divergence) = (mesh.enclosed_volume(), by_divergence(&vertices, &triangles).abs());
        assert!((found / divergence - 1.0).abs() < 1e-12, "{name}: {found}, not {divergence}");
        assert!((found / volume - 1.0).abs() < 1e-8, "{name}: {found}, not {volume}");
        let rays = by_rays(&vertices, &triangles, 400);
        println!("{name}: {found:.6}, rays {rays:.6}");
        assert!((rays / found - 1.0).abs() < 4e-3, "{name}: {found}, rays {rays}");
    }
}

/// A feature of a map as its polygons, each an outer ring and holes, in degrees.
type Polygons = Vec<Vec<Vec<[f64; 2]>>>;

/// A topology, decoded arc by arc.
struct Map {
    root: Value,
    arcs: Vec<Vec<[f64; 2]>>,
}

impl Map {
    fn open(name: &str) -> Map {
        let text = std::fs::read(folder().join(name)).expect("a map");
        let root: Value = serde_json::from_slice(&text).expect("JSON");
        let pair = |value: &Value| [0, 1].map(|k| value[k].as_f64().expect("a number"));
        let (scale, shift) = (pair(&root["transform"]["scale"]), pair(&root["transform"]["translate"]));
        let arc = |arc: &Value| {
            let mut at = [0.0; 2];
            let points = arc.as_array().expect("an arc").iter().map(pair);
            points
                .map(|[x, y]| {
                    at = [at[0] + x, at[1] + y];
                    [at[0] * scale[0] + shift[0], at[1] * scale[1] + shift[1]]
                })
                .collect()
        };
        let arcs = root["arcs"].as_array().expect("arcs").iter().map(arc).collect();
        Map { root, arcs }
    }

    fn features(&self, layer: &str) -> Vec<(String, Polygons)> {
        let all = self.root["objects"][layer]["geometries"].as_array().expect("a layer");
        let name = |value: &Value| value["properties"]["name"].as_str().unwrap_or("").to_string();
        all.iter().map(|feature| (name(feature), self.polygons(feature))).collect()
    }

    fn polygons(&self, feature: &Value) -> Polygons {
        let arcs = feature["arcs"].as_array().expect("arcs");
        match feature["type"].as_str() {
            Some("Polygon") => vec![arcs.iter().map(|ring| self.ring(ring)).collect()],
            _ => {
                arcs.iter().map(|p| p.as_array().expect("rings").iter().map(|ring| self.ring(ring)).collect()).collect()
            }
        }
    }

    fn ring(&self, arcs: &Value) -> Vec<[f64; 2]> {
        let mut points: Vec<[f64; 2]> = Vec::new();
        for index in arcs.as_array().expect("a ring").iter().map(|k| k.as_i64().expect("an arc")) {
            let mut arc = self.arcs[if index < 0 { !index } else { index } as usize].clone();
            if index < 0 {
                arc.reverse();
            }
            points.extend(arc.into_iter().skip(usize::from(!points.is_empty())));
        }
        points.pop();
        points
    }
}

/// From point to point, along the shorter way round the globe: a step over the antimeridian is not a step back.
fn sides(ring: &[[f64; 2]]) -> impl Iterator<Item = ([f64; 2], [f64; 2])> {
    let shorter = |from: f64, to: f64| from + (to - from + 540.0).rem_euclid(360.0) - 180.0;
    ring.iter().zip(ring.iter().cycle().skip(1)).map(move |(a, b)| (*a, [shorter(a[0], b[0]), b[1]]))
}

/// The bands between sides and the equator, with the height for a latitude given by a function; around a pole, the area beyond the ring.
fn bands(ring: &[[f64; 2]], height: impl Fn(f64) -> f64) -> f64 {
    let sum: f64 = sides(ring).map(|(a, b)| 0.5 * (b[0] - a[0]) * (height(a[1]) + height(b[1]))).sum();
    let turned: f64 = sides(ring).map(|(a, b)| b[0] - a[0]).sum();
    if turned.abs() > 180.0 { turned.abs() * height(90.0) - sum.abs() } else { sum.abs() }
}

/// Outer rings minus their holes, for a given area of rings.
fn total(polygons: &Polygons, area: impl Fn(&[[f64; 2]]) -> f64) -> f64 {
    polygons.iter().map(|rings| area(&rings[0]) - rings[1..].iter().map(|hole| area(hole)).sum::<f64>()).sum()
}

/// Square degrees of the plane of longitudes and latitudes.
fn flat(ring: &[[f64; 2]]) -> f64 {
    bands(ring, |latitude| latitude)
}

/// The mean radius of the Earth [km].
const EARTH: f64 = 6371.0088;

/// Square kilometres of the globe: the height of a band is the sine of its latitude (Archimedes).
fn round(ring: &[[f64; 2]]) -> f64 {
    EARTH * EARTH * 1f64.to_radians() * bands(ring, |latitude| latitude.to_radians().sin())
}

/// The lowest and the highest coordinates.
fn bounds(polygons: &Polygons) -> [[f64; 2]; 2] {
    let mut found = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    for point in polygons.iter().flatten().flatten() {
        for axis in 0..2 {
            found = [
                core::array::from_fn(|a| if a == axis { found[0][a].min(point[a]) } else { found[0][a] }),
                core::array::from_fn(|a| if a == axis { found[1][a].max(point[a]) } else { found[1][a] }),
            ];
        }
    }
    found
}

/// Country, its area in km², and the tolerance for the map of 1 : 110 million: the whole territory according to The World Factbook (CIA, 2024).
const PUBLISHED: [(&str, f64, f64); 9] = [
    ("Croatia", 56_594.0, 0.03),
    ("Hungary", 93_028.0, 0.02),
    ("Poland", 312_685.0, 0.02),
    ("Germany", 357_022.0, 0.02),
    ("Italy", 301_340.0, 0.06),
    ("Bosnia and Herz.", 51_197.0, 0.02),
    ("Mongolia", 1_564_116.0, 0.02),
    ("South Africa", 1_219_090.0, 0.01),
    ("Brazil", 8_515_770.0, 0.01),
];

/// A country drawn at its real size has its published area: the projection is equal-area at the central latitude, and the areas of countries that
/// extend over less than 40° of latitude differ by a few per cent at most.
#[test]
fn countries_have_the_areas_that_are_published_for_them() {
    let map = Map::open("countries-110m.json");
    let features = map.features("countries");
    let degree = EARTH * 1f64.to_radians();
    for (name, published, tolerance) in PUBLISHED {
        let (_, polygons) = features.iter().find(|(own, _)| own == name).expect(name);
        let [low, high] = bounds(polygons);
        let narrow = (0.5 * (low[1] + high[1])).to_radians().cos();
        // At its real size, with kilometres instead of metres.
        let size = degree * ((high[0] - low[0]) * narrow).max(high[1] - low[1]);
        let mesh = plane(&format!(
            "kind = \"map\", file = \"shapes/countries-110m.json\", layer = \"countries\", feature = \"{name}\", \
             spacing = {:?}, size = {size:?}",
            size / 1000.0
        ));
        let (found, globe) = (signed_volume(&mesh.facets, &mesh.positions), total(polygons, round));
        let raw = degree * degree * narrow * total(polygons, flat);
        println!("{name}: {found:.0} km², on the globe {globe:.0}, published {published:.0}");
        assert!((found / raw - 1.0).abs() < 2e-3, "{name}: {found} km², {raw} by its corners");
        assert!((found / published - 1.0).abs() < tolerance, "{name}: {found} km², published {published}");
        assert!((globe / published - 1.0).abs() < tolerance, "{name}: {globe} km² on the globe, published {published}");
    }
}

/// The lowest and the highest latitude; a ring around a pole includes the pole.
fn latitudes(polygons: &Polygons) -> [f64; 2] {
    let [low, high] = bounds(polygons);
    let polar = |ring: &Vec<[f64; 2]>| sides(ring).map(|(a, b)| b[0] - a[0]).sum::<f64>().abs() > 180.0;
    let south = polygons.iter().flatten().any(|ring| polar(ring) && ring[0][1] < 0.0);
    [if south { -90.0 } else { low[1] }, high[1]]
}

/// The body of polygons in the default projection, and the area in square degrees that follows from its height.
fn laid_out(polygons: &Polygons, more: &str) -> Result<(Arc<Mesh<2>>, f64), Vec<SceneError>> {
    let AnyBlueprint::Plane(blueprint) = tried(2, &format!("kind = \"map\", spacing = 0.0005, size = 1.0, {more}"))?
    else {
        panic!("a shape of the plane");
    };
    let mesh = blueprint.bodies[0].mesh.clone();
    let ([south, north], heights) = (latitudes(polygons), mesh.positions.iter().map(|p| p[1]));
    let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| (low.min(y), high.max(y)));
    let degree = (high - low) / (north - south);
    let narrow = (0.5 * (south + north)).to_radians().cos();
    let area = signed_volume(&mesh.facets, &mesh.positions) / degree / degree / narrow;
    Ok((mesh, area))
}

/// Countries whose outline touches itself in the file.
const TOUCHING: [&str; 1] = ["Sudan"];

/// Every country is read with all its islands and holes and with the area of its corners, also over the antimeridian and around the pole.
#[test]
fn all_countries_have_the_pieces_and_areas_of_their_raw_corners() {
    let map = Map::open("countries-110m.json");
    let (mut measured, mut touching) = (0, Vec::new());
    for (name, polygons) in map.features("countries") {
        let shape = format!("file = \"shapes/countries-110m.json\", layer = \"countries\", feature = \"{name}\"");
        let (mesh, found) = match laid_out(&polygons, &shape) {
            Ok(found) => found,
            Err(errors) => {
                assert_eq!(errors[0].code, "shape.crossing", "{name}: {}", errors[0]);
                touching.push(name);
                continue;
            }
        };
        let raw = total(&polygons, flat);
        assert!((found / raw - 1.0).abs() < 0.01, "{name}: {found}, not {raw} square degrees");
        // At this scale a few islands have shrunk to nothing: their outlines run there and back.
        let is_there = |ring: &Vec<[f64; 2]>| flat(ring) > 1e-6 * raw;
        let rings = polygons.iter().flatten().filter(|ring| is_there(ring)).count();
        assert_eq!(mesh.components().expect("closed").len(), rings, "{name}");
        assert_eq!(
            mesh.chambers().expect("chambers").len(),
            polygons.iter().filter(|p| is_there(&p[0])).count(),
            "{name}"
        );
        measured += 1;
    }
    assert_eq!((measured, touching), (177 - TOUCHING.len(), TOUCHING.map(String::from).to_vec()));
}

/// All land: the area of its corners, its pieces with the Caspian Sea as their only hole, and on the globe the land area of the Earth except small
/// islands.
#[test]
fn all_land_has_the_area_and_the_pieces_of_its_raw_corners() {
    let map = Map::open("land-110m.json");
    let polygons: Polygons = map.features("land").into_iter().flat_map(|(_, polygons)| polygons).collect();
    let holes: usize = polygons.iter().map(|rings| rings.len() - 1).sum();
    assert_eq!((polygons.len(), holes), (125, 1));
    let (mesh, found) = laid_out(&polygons, "file = \"shapes/land-110m.json\"").unwrap_or_else(|e| panic!("{}", e[0]));
    let raw = total(&polygons, flat);
    assert!((found / raw - 1.0).abs() < 0.01, "{found}, not {raw} square degrees");
    assert_eq!((mesh.components().expect("closed").len(), mesh.chambers().expect("chambers").len()), (126, 125));
    // 148.94 million km² (The World Factbook).
    let globe = total(&polygons, round) / 1e6;
    println!("land: {found:.0} square degrees, {globe:.2} million km²");
    assert!((globe / 148.94 - 1.0).abs() < 0.03, "{globe} million km²");
}
