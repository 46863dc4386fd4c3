//! Pictures of the documentation are equal to what the program draws now; `cargo xtask gallery --check` compares all of them.

use crate::common;
use common::*;
use std::path::{Path, PathBuf};

/// The size and the pixels of a picture.
fn pixels(path: &Path) -> ([u32; 2], Vec<u8>) {
    let file = std::io::BufReader::new(std::fs::File::open(path).unwrap_or_else(|e| panic!("{}: {e}", path.display())));
    let mut reader = png::Decoder::new(file).read_info().expect("a PNG");
    let mut found = vec![0; reader.output_buffer_size().expect("a size")];
    let info = reader.next_frame(&mut found).expect("pixels");
    found.truncate(info.buffer_size());
    ([info.width, info.height], found)
}

/// In the plane and in space, including a credit, a drawing, stresses, pins and pulls.
#[test]
fn a_few_pictures_of_the_documentation_are_what_is_drawn_today() {
    let documented = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../docs/pictures");
    let folder = tempfile::tempdir().expect("a folder");
    std::thread::scope(|scope| {
        for scene in ["ball", "fish", "leaking-tyre", "cantilever"] {
            let (documented, folder) = (&documented, folder.path());
            scope.spawn(move || {
                let output = opruga(folder, &["run", scene, "--out", scene, "--threads", "1"]);
                assert_eq!(code(&output), 0, "{scene}: {}", said(&output));
                let (old, new) =
                    (pixels(&documented.join(format!("{scene}.png"))), pixels(&folder.join(scene).join("strip.png")));
                assert_eq!(old.0, new.0, "{scene}.png has another size; `cargo xtask gallery` draws it again");
                let differing = old.1.iter().zip(&new.1).filter(|(a, b)| a != b).count();
                assert_eq!(differing, 0, "values of {scene}.png differ; `cargo xtask gallery` draws it again");
            });
        }
    });
}
