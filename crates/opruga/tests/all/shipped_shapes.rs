//! The shapes that come with the scenes: their areas, volumes, pieces and holes, and the quality of their fillings.
#![allow(clippy::disallowed_methods, reason = "what tests expect needs no equal bits")]

use opruga::blueprint::AnyBlueprint;
use opruga::io::scene;
use opruga::mesh::{EdgeSet, Mesh};
use opruga::{catalogue, scenes};
use std::sync::Arc;

fn read(dimension: u8, shape: &str) -> AnyBlueprint {
    let text = format!(
        "format = \"opruga-1\"\ndimension = {dimension}\n[time]\nseconds = 1\n[integrator]\nkind = \"verlet\"\n\
         [[body]]\nname = \"it\"\nmass = 1\nshape = {{ {shape} }}\n"
    );
    let options = scene::Options { files: scenes::files(), strict: true, ..scene::Options::default() };
    let read = scene::read(text.as_bytes(), "test.toml", &catalogue(), &options);
    read.unwrap_or_else(|errors| panic!("{}", errors[0])).0
}

fn plane(shape: &str) -> Arc<Mesh<2>> {
    let AnyBlueprint::Plane(blueprint) = read(2, shape) else { panic!("a shape of the plane") };
    blueprint.bodies[0].mesh.clone()
}

fn space(shape: &str) -> Arc<Mesh<3>> {
    let AnyBlueprint::Space(blueprint) = read(3, shape) else { panic!("a shape of space") };
    blueprint.bodies[0].mesh.clone()
}

fn area(mesh: &Mesh<2>) -> f64 {
    opruga::mesh::signed_volume(&mesh.facets, &mesh.positions)
}

/// V − E + T of a filled body of the plane: pieces minus holes.
fn euler(mesh: &Mesh<2>) -> i64 {
    mesh.nodes() as i64 - mesh.edges(EdgeSet::All).len() as i64 + mesh.cells.len() as i64
}

/// The smallest angle of all triangles [°].
fn smallest_angle(mesh: &Mesh<2>) -> f64 {
    let mut smallest = 180.0f64;
    for t in &mesh.cells.triangles {
        for k in 0..3 {
            let [o, a, b] = [0, 1, 2].map(|j| mesh.positions[t[(k + j) % 3] as usize]);
            let (u, v) = ([a[0] - o[0], a[1] - o[1]], [b[0] - o[0], b[1] - o[1]]);
            smallest = smallest.min((u[0] * v[1] - u[1] * v[0]).atan2(u[0] * v[0] + u[1] * v[1]).to_degrees());
        }
    }
    smallest
}

/// Shape, pieces, holes, area at size 1, the smallest allowed angle of its filling [°].
#[test]
fn outlines_have_their_areas_pieces_and_holes() {
    let svg = |name: &str| format!("kind = \"svg\", file = \"shapes/{name}.svg\"");
    let italy = "kind = \"map\", file = \"shapes/countries-110m.json\", layer = \"countries\", feature = \"Italy\"";
    let africa =
        "kind = \"map\", file = \"shapes/countries-110m.json\", layer = \"countries\", feature = \"South Africa\"";
    let word = "kind = \"text\", file = \"shapes/inter-black-subset.otf\", text = \"OPRUGA\"";
    let union = |shape: String| format!("{shape}, overlap = \"union\"");
    for (shape, spacing, pieces, holes, wanted, angle) in [
        (svg("heart"), 0.03, 1, 0, AREAS[0], 25.0),
        (svg("star"), 0.03, 1, 0, AREAS[1], 25.0),
        (svg("drop"), 0.03, 1, 0, AREAS[2], 25.0),
        (union(svg("apple")), 0.03, 1, 1, AREAS[3], 25.0),
        (union(svg("fish")), 0.03, 1, 0, AREAS[4], 25.0),
        (italy.to_string(), 0.02, 3, 0, AREAS[5], 25.0),
        (africa.to_string(), 0.03, 1, 1, AREAS[6], 25.0),
        (word.to_string(), 0.01, 6, 4, AREAS[7], 25.0),
    ] {
        let common = format!("{shape}, spacing = {spacing}, size = 1.0");
        let (skin, filled) = (plane(&common), plane(&format!("{common}, filling = \"triangles\"")));
        println!("{shape}: area {:.4}, angle {:.1}, euler {}", area(&skin), smallest_angle(&filled), euler(&filled));
        assert!((area(&skin) / wanted - 1.0).abs() < 0.01, "{shape}: {}", area(&skin));
        assert!((filled.measure().expect("an area").value() / area(&skin) - 1.0).abs() < 1e-9, "{shape}");
        assert_eq!(skin.components().expect("closed").len(), pieces + holes, "{shape}");
        assert_eq!(skin.chambers().expect("chambers").len(), pieces, "{shape}");
        assert_eq!(euler(&filled), pieces as i64 - holes as i64, "{shape}");
        assert!(smallest_angle(&filled) >= angle, "{shape}: {}", smallest_angle(&filled));
        assert_eq!(filled.check(), [], "{shape}");
    }
}

/// The tip of the heart has an angle of 40°: at every spacing there is a node in it, and the skin extends as far down as the drawing.
#[test]
fn the_heart_keeps_its_tip_at_every_spacing() {
    // From its path: 32.069 of 35.77 units high, so that its centre is half of that above the tip.
    let tip = -0.5 * (34.034 - 1.965) / (35.885 - 0.115);
    for spacing in [0.02, 0.03, 0.05, 0.06, 0.07, 0.1, 0.2] {
        let skin = plane(&format!("kind = \"svg\", file = \"shapes/heart.svg\", spacing = {spacing}, size = 1.0"));
        let lowest = skin.positions.iter().map(|x| x[1]).fold(f64::INFINITY, f64::min);
        assert!((lowest - tip).abs() < 1e-4, "{spacing}: {lowest} instead of {tip}");
    }
}

/// Squares around every outline are connected, and carry it with its original area.
#[test]
fn lattices_of_squares_carry_the_outlines_as_they_were_drawn() {
    let svg = |name: &str| format!("kind = \"svg\", file = \"shapes/{name}.svg\"");
    let map = |name: &str| {
        format!("kind = \"map\", file = \"shapes/countries-110m.json\", layer = \"countries\", feature = \"{name}\"")
    };
    let word = "kind = \"text\", file = \"shapes/inter-black-subset.otf\", text = \"OPRUGA\"";
    let union = |shape: String| format!("{shape}, overlap = \"union\"");
    for (shape, wanted) in [
        svg("heart"),
        svg("star"),
        svg("drop"),
        union(svg("apple")),
        union(svg("fish")),
        map("Italy"),
        map("South Africa"),
        word.to_string(),
    ]
    .into_iter()
    .zip(AREAS)
    {
        let mesh = plane(&format!("{shape}, spacing = 0.04, size = 1.0, filling = \"lattice\""));
        assert_eq!(mesh.check(), [], "{shape}");
        let squares = mesh.cells.quadrilaterals.len() as f64 * 0.04 * 0.04;
        assert!((mesh.measure().expect("an area").value() / squares - 1.0).abs() < 1e-9, "{shape}");
        let skin = mesh.skin.as_ref().expect("the outline");
        let points = skin.positions(&mesh.positions.iter().map(|p| [p[0], p[1], 0.0]).collect::<Vec<_>>());
        let ring = |ring: &Vec<u32>| -> f64 {
            let pairs = ring.iter().zip(ring.iter().cycle().skip(1));
            pairs
                .map(|(a, b)| (points[*a as usize], points[*b as usize]))
                .map(|(a, b)| 0.5 * (a[0] * b[1] - a[1] * b[0]))
                .sum()
        };
        let drawn: f64 = skin.areas[0].rings.iter().map(ring).sum::<f64>().abs();
        assert!((drawn / wanted - 1.0).abs() < 2e-3, "{shape}: {drawn}, not {wanted}");
        assert!(squares > drawn, "{shape}");
    }
}

#[test]
fn surfaces_have_their_volumes_and_euler_characteristics() {
    // Nodes, triangles, V − E + F; the torus has the volume of its polygons, not 2π²Rr².
    let (spot, torus) = (
        space("kind = \"surface\", file = \"shapes/spot.obj\""),
        space("kind = \"surface\", file = \"shapes/torus.obj\""),
    );
    assert_eq!((spot.nodes(), spot.facets.len(), spot.euler_characteristic()), (2930, 5856, 2));
    assert_eq!((torus.nodes(), torus.facets.len(), torus.euler_characteristic()), (400, 800, 0));
    println!("spot {}, torus {}", spot.enclosed_volume(), torus.enclosed_volume());
    let ring = {
        // 20 by 20 nodes on a torus of radii 1 and ½: polygons of 20 corners in both directions.
        let (low, high) = torus.bounds();
        let tube = 0.5 * (high[1] - low[1]);
        2.0 * std::f64::consts::PI.powi(2) * (0.5 * (high[0] - low[0]) - tube) * tube * tube
    };
    assert!(
        torus.enclosed_volume() / ring > 0.93 && torus.enclosed_volume() / ring < 1.0,
        "{}",
        torus.enclosed_volume() / ring
    );
    for mesh in [&spot, &torus] {
        assert_eq!((mesh.components().expect("closed").len(), mesh.check()), (1, vec![]));
    }
    let jelly = space("kind = \"surface\", file = \"shapes/spot.obj\", filling = \"lattice\", spacing = 0.08");
    assert_eq!(jelly.check(), []);
    let volume = jelly.measure().expect("a volume").value() / spot.enclosed_volume();
    assert!((1.0..1.8).contains(&volume), "the lattice reaches beyond the skin: {volume}");
    let skin = jelly.skin.as_ref().expect("a skin");
    let far = |(p, q): (&[f64; 3], &[f64; 3])| (0..3).any(|d| (p[d] - q[d]).abs() > 1e-12);
    assert!(!skin.positions(&jelly.positions).iter().zip(&spot.positions).any(far));
}

/// The areas of the drawings themselves at size 1: integrals over their curves by an independent program.
const AREAS: [f64; 8] = [0.65282, 0.44842, 0.43381, 0.60890, 0.50971, 0.23453, 0.47180, 0.09967];
