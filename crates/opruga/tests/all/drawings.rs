//! Pictures of drawings that bodies carry.
#![allow(clippy::disallowed_methods, reason = "pictures need no equal bits")]

use crate::common;
use common::*;
use opruga::draw::Facets;
use opruga::pictures::{Quantity, Scenery};
use opruga::scenes;

const TEXT: &str = "[[body]]\nname = \"fish\"\nmass = 1\nmodels = [{ kind = \"mass_spring\", stiffness = 900.0 }]\nshape = { kind = \"svg\", file = \"shapes/fish.svg\", size = 1.0, overlap = \"union\", ";

fn fish(more: &str) -> opruga::World<2> {
    built(plane(&format!("{}{TEXT}{more} }}\n", head(0.01, 32, -9.81, "verlet"))))
}

/// The six paths of the fish, in the order of the drawing.
const COLOURS: [[u8; 3]; 6] =
    [[0x3b, 0x88, 0xc3], [0x3b, 0x88, 0xc3], [0, 0, 0], [0x55, 0xac, 0xee], [0, 0, 0], [0x22, 0x66, 0x99]];

#[test]
fn a_drawing_is_seen_in_its_colours_unless_something_else_is_asked_for() {
    for filling in ["none", "triangles", "lattice"] {
        let mut world = fish(&format!("spacing = 0.08, filling = \"{filling}\", colours = true"));
        let mut scenery = Scenery::new(&world);
        let own = scenery.picture(&scenery.capture(&mut world, false));
        own.check().expect("it fits together");
        let colours: Vec<[u8; 4]> = own.bodies[0].areas.iter().filter_map(|area| area.colour).collect();
        assert_eq!(colours, COLOURS.map(|[r, g, b]| [r, g, b, 255]), "{filling}");
        assert!(own.legend.is_none() && own.bodies[0].scalar.is_empty());
        assert!(own.bodies[0].areas.iter().all(|area| !area.triangles.is_empty()), "{filling}");
        // The strain is requested: on squares, the silhouette clips it.
        let strain = scenery.picture(&scenery.capture_quantity(&mut world, false, Quantity::Strain));
        strain.check().expect("it fits together");
        let silhouettes = usize::from(filling == "lattice");
        assert_eq!(strain.bodies[0].areas.iter().filter(|area| area.colour.is_none()).count(), silhouettes);
        assert_eq!((strain.bodies[0].areas.len(), strain.bodies[0].scalar.is_empty()), (silhouettes, false));
        scenery.show_springs(&world);
        assert!(scenery.picture(&scenery.capture(&mut world, false)).bodies[0].areas.is_empty());
    }
    // No quantity is requested.
    let world = fish("spacing = 0.08, filling = \"triangles\"");
    assert!(world.blueprint().bodies[0].mesh.skin.is_none());
}

/// The centre of the drawing falls like the body, and the drawing is within the body's nodes.
#[test]
fn a_drawing_moves_with_its_body() {
    for filling in ["none", "triangles", "lattice"] {
        let mut world = fish(&format!("spacing = 0.08, filling = \"{filling}\", colours = true"));
        let scenery = Scenery::new(&world);
        let middle = |world: &mut opruga::World<2>| {
            let picture = scenery.picture(&scenery.capture(world, false));
            let points: Vec<[f64; 3]> = picture.bodies[0].areas.iter().flat_map(|a| a.positions.clone()).collect();
            let Facets::Edges(edges) = &picture.bodies[0].facets else { panic!("a flat body") };
            let node = picture.bodies[0].positions[edges[0][0] as usize];
            (points.iter().map(|p| p[1]).sum::<f64>() / points.len() as f64, node[1])
        };
        let before = middle(&mut world);
        frames(&mut world, 20);
        let after = middle(&mut world);
        assert!((after.0 - before.0 - (after.1 - before.1)).abs() < 1e-5, "{filling}: {before:?} {after:?}");
        assert!((before.0 - after.0 - 0.5 * 9.81 * 0.04).abs() < 1e-5, "{filling}");
    }
}

/// Painting changes no bit of a run.
#[test]
fn colours_change_no_bits() {
    let hash = |colours: bool| {
        let mut world = fish(&format!("spacing = 0.08, filling = \"triangles\", colours = {colours}"));
        frames(&mut world, 10);
        world.state_hash()
    };
    assert_eq!(hash(true), hash(false));
}

#[test]
fn scenes_with_drawings_are_drawn() {
    for name in ["fish", "drawings"] {
        let mut world = built(plane(scenes::find(name).expect("a scene")));
        let scenery = Scenery::new(&world);
        let picture = scenery.picture(&scenery.capture(&mut world, false));
        let view = opruga::draw::View::fit([&picture]).expect("a view");
        let style = opruga::draw::Style::film(&view, 2, 320);
        let image = opruga::draw::draw(&picture, &view, &style).expect("an image");
        // The sea blue of the fish is visible.
        let blue = (0..image.height()).flat_map(|y| (0..image.width()).map(move |x| (x, y)));
        let count = blue.filter(|(x, y)| image.pixel(*x, *y) == [0x55, 0xac, 0xee]).count();
        assert!(count > 100, "{name}: {count} pixels");
    }
}
