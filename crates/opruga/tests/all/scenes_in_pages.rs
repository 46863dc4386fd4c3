//! Complete scenes in the documentation are read without an error or a notice, and run.

use crate::common;
use common::*;
use opruga::blueprint::AnyBlueprint;
use opruga::io::scene;
use opruga::{World, catalogue};

/// The complete scenes of a page.
fn scenes(page: &str) -> Vec<String> {
    let path = format!("{}/../../docs/{page}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).expect("a page").replace("\r\n", "\n");
    let blocks = text.split("```toml\n").skip(1).filter_map(|rest| rest.split("```").next());
    blocks.filter(|block| block.contains("format = \"opruga-1\"")).map(String::from).collect()
}

/// The scene of a block, without notices.
fn checked(page: &str, text: &str) -> AnyBlueprint {
    let options = scene::Options { files: opruga::scenes::files(), ..scene::Options::default() };
    let read = scene::read(text.as_bytes(), page, &catalogue(), &options);
    let (blueprint, notices) = read.unwrap_or_else(|errors| panic!("{page}: {errors:?}"));
    assert!(notices.is_empty(), "{page}: {notices:?}");
    blueprint
}

/// Steps a world until its bodies touch. No surfaces cross, and nothing is reported.
fn touching<const D: usize>(mut world: World<D>, page: &str) {
    world.report_contacts(true);
    let mut touched = 0;
    while touched < 10 {
        world.frame().unwrap_or_else(|error| panic!("{page}: {error}"));
        assert_eq!(world.crossed_surfaces(), [], "{page}, at {} s", world.time());
        touched += u32::from(!world.contacts().is_empty());
        assert!(world.time() < 1.0, "{page}: no bodies touch");
    }
    let warnings = world.warnings();
    assert!(warnings.is_empty(), "{page}: {warnings:?}");
}

#[test]
fn scenes_of_pages_are_read_and_built() {
    let pages = std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs")).expect("the documentation");
    let names = pages.map(|page| page.expect("a page").file_name().to_string_lossy().into_owned());
    let mut count = 0;
    for page in names.filter(|name| name.ends_with(".md")) {
        for text in scenes(&page) {
            count += 1;
            match checked(&page, &text) {
                AnyBlueprint::Plane(blueprint) => drop(built(blueprint)),
                AnyBlueprint::Space(blueprint) => drop(built(blueprint)),
            }
        }
    }
    assert!(count >= 6, "{count} scenes");
}

#[test]
fn bodies_of_the_scenes_about_contact_touch_and_do_not_cross() {
    let found = scenes("contact.md");
    assert!(found.len() >= 4, "{} scenes", found.len());
    for text in found {
        match checked("contact.md", &text) {
            AnyBlueprint::Plane(blueprint) => touching(built(blueprint), "contact.md"),
            AnyBlueprint::Space(blueprint) => touching(built(blueprint), "contact.md"),
        }
    }
}
