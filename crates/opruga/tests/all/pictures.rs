//! Fields of scenes that concern pictures, and the contents of pictures of scenes.

use crate::common;
use common::*;
use opruga::World;
use opruga::blueprint::AnyBlueprint;
use opruga::pictures::Scenery;
use opruga::scenes;

/// For every shape that comes with the scenes and has an author: the word that its credit must contain, and the licence if it must be named wherever
/// the shape is shown.
fn makers() -> Vec<(String, Vec<&'static str>)> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/shapes/CREDITS.md");
    let table = std::fs::read_to_string(path).expect("the credits");
    let mut found = Vec::new();
    for row in table.lines().filter(|line| line.starts_with("| `")) {
        let names = ["Twemoji", "Keenan Crane", "PositionBasedDynamics", "Natural Earth", "Inter"];
        let name = names.into_iter().find(|name| row.contains(name)).expect("a maker that the test knows");
        let mut wanted = vec![name];
        wanted.extend(row.contains("CC-BY 4.0").then_some("CC-BY 4.0"));
        let files = row.split('|').nth(1).expect("files");
        found.extend(files.split('`').filter(|word| word.contains('.')).map(|file| (file.to_string(), wanted.clone())));
    }
    assert!(found.len() >= 13, "{found:?}");
    found
}

#[test]
fn every_scene_with_a_shape_by_somebody_names_them_wherever_it_is_shown() {
    let makers = makers();
    let mut credited = 0;
    for name in scenes::names() {
        let text = scenes::find(name).expect("a scene");
        let credit = scenes::credit(text);
        for (file, wanted) in makers.iter().filter(|(file, _)| text.contains(&format!("\"shapes/{file}\""))) {
            assert!(
                wanted.iter().all(|word| credit.contains(word)),
                "{name} shows {file}: `{credit}` lacks one of {wanted:?}"
            );
            credited += 1;
        }
        assert_eq!(text.contains("\"shapes/"), !credit.is_empty(), "{name}");
        let read = match read(text).expect("a scene of ours") {
            AnyBlueprint::Plane(blueprint) => blueprint.credit,
            AnyBlueprint::Space(blueprint) => blueprint.credit,
        };
        assert_eq!(read, credit, "{name}: lists and pictures say the same");
    }
    assert!(credited >= 14, "{credited}");
}

#[test]
fn what_pictures_show_changes_no_bit_of_the_physics() {
    let ball = scenes::find("ball").expect("a scene");
    let told = ball.replacen("dimension", "credit = \"somebody\"\ndimension", 1)
        + "\n[picture]\npanels = 4\nlow = [0, 0]\nhigh = [1, 2]\n";
    let hash = |text: &str| {
        let mut world = built(plane(text));
        frames(&mut world, 20);
        let scenery = Scenery::new(&world);
        let moment = scenery.capture(&mut world, false);
        let picture = scenery.picture(&moment);
        (world.state_hash(), picture.credit, scenery.panels(), picture.sight.region)
    };
    let (plain, shown) = (hash(ball), hash(&told));
    assert_eq!(plain.0, shown.0);
    assert_eq!((plain.1.as_str(), plain.2, plain.3), ("", None, None));
    assert_eq!((shown.1.as_str(), shown.2, shown.3), ("somebody", Some(4), Some([[0.0; 3], [1.0, 2.0, 0.0]])));
}

#[test]
fn a_picture_that_cannot_be_is_refused_with_its_place() {
    let ball = scenes::find("ball").expect("a scene");
    for (table, code, word) in [
        ("low = [0, 0]", "scene.missing", "`high`"),
        ("high = [1, 1]", "scene.missing", "`low`"),
        ("low = [0, 0]\nhigh = [1, 0]", "scene.range", "is empty"),
        ("azimuth = 20", "scene.dimension", "only 3D scenes"),
        ("panels = 0", "scene.range", "panels"),
        ("pannels = 4", "scene.unknown_field", "pannels"),
    ] {
        let errors = read(&format!("{ball}\n[picture]\n{table}\n")).expect_err(table);
        assert_eq!(errors.len(), 1, "{table}: {errors:?}");
        assert_eq!(errors[0].code, code, "{table}: {}", errors[0]);
        assert!(errors[0].to_string().contains(word) && errors[0].line.is_some(), "{table}: {}", errors[0]);
    }
}

#[test]
fn a_held_solid_shows_where_it_lay_and_one_that_falls_does_not() {
    let mut world = built(plane(scenes::find("heart-solid").expect("a scene")));
    let scenery = Scenery::new(&world);
    let start = scenery.picture(&scenery.capture(&mut world, false));
    frames(&mut world, 12);
    let later = scenery.picture(&scenery.capture(&mut world, false));
    let [heart, croatia] = [0, 1].map(|body: usize| &later.bodies[body]);
    assert!(heart.rest.segments.is_empty() && !croatia.rest.segments.is_empty());
    let far = |a: &[[f64; 3]], b: &[[f64; 3]]| {
        largest(a.iter().zip(b).map(|(a, b)| (a[0] - b[0]).abs() + (a[1] - b[1]).abs()))
    };
    assert!(far(&croatia.rest.positions, &start.bodies[1].positions) < 1e-6, "the lines stay where it lay");
    assert!(far(&croatia.rest.positions, &croatia.positions) > 0.1, "and it has moved");
}

#[test]
fn bodies_at_rest_show_no_rounding() {
    for name in ["heart-solid", "jelly", "hanging-net", "cloth-over-ball"] {
        let text = scenes::find(name).expect("a scene");
        let scalars: Vec<f32> = match read(text).expect("a scene of ours") {
            AnyBlueprint::Plane(blueprint) => shown(built(blueprint)),
            AnyBlueprint::Space(blueprint) => shown(built(blueprint)),
        };
        assert!(!scalars.is_empty() && scalars.iter().all(|scalar| *scalar == 0.0), "{name}: {scalars:?}");
    }
}

/// The values that the colours of all bodies show at the start.
fn shown<const D: usize>(mut world: World<D>) -> Vec<f32> {
    let scenery = Scenery::new(&world);
    let moment = scenery.capture(&mut world, false);
    scenery
        .picture(&moment)
        .bodies
        .iter()
        .flat_map(|body| body.scalar.iter().map(|s| *s as f32).collect::<Vec<_>>())
        .collect()
}
