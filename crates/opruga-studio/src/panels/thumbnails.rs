//! Small pictures of the scenes that come with the program. A desktop window stores them in the cache folder, with a fingerprint of their sources, so
//! that they need not be drawn at every start.

use crate::work;
use opruga::draw::{View, draw_scene};
use opruga::io::scene;
use opruga::pictures::Scenery;
use opruga::{AnyWorld, Options, Registries, catalogue_of};

/// The size of a picture in pixels.
pub(super) const SIZE: [u32; 2] = [256, 160];
/// The largest product of nodes and substeps for which a scene is run for its picture.
const WORK: u64 = 96_000_000;

/// The pixels of a picture: red, green, blue and opacity.
pub(super) type Pixels = Vec<u8>;

/// Draws a scene as it is a little after its start or, if the scene is large, at its start.
pub(super) async fn draw(name: &str, registries: &Registries) -> Option<Pixels> {
    let options = scene::Options { files: opruga::scenes::files(), ..scene::Options::default() };
    let text = opruga::scenes::find(name)?;
    let (blueprint, _) = scene::read(text.as_bytes(), name, &catalogue_of(registries), &options).ok()?;
    picture(blueprint.build_with(Options::default(), registries).ok()?).await
}

async fn picture(mut world: Box<dyn AnyWorld>) -> Option<Pixels> {
    let nodes: u64 = world.bodies().into_iter().map(|body| world.node_count(body) as u64).sum();
    let time = world.scene().time();
    let frames = (0.25 * time.seconds / time.frame) as u64;
    if nodes * frames * u64::from(time.substeps) <= WORK {
        for _ in 0..frames {
            work::breathe().await;
            world.frame().ok()?;
        }
    }
    let scenery = Scenery::new(&*world);
    let moment = scenery.capture(&mut *world, false);
    let mut picture = scenery.picture(&moment);
    picture.bodies.iter_mut().for_each(|body| body.label.clear());
    let view = View::fit([&picture]).ok()?;
    Some(draw_scene(&picture, &view, [252, 252, 253], SIZE).ok()?.pixels().to_vec())
}

#[cfg(not(target_arch = "wasm32"))]
pub(super) use kept::kept_or_drawn;

#[cfg(not(target_arch = "wasm32"))]
mod kept {
    use super::{Pixels, SIZE, draw};
    use crate::handing::named_files;
    use flate2::Compression;
    use flate2::read::DeflateDecoder;
    use flate2::write::DeflateEncoder;
    use opruga::Registries;
    use opruga::io::safe_write::safe_write;
    use std::hash::{DefaultHasher, Hash, Hasher};
    use std::io::{Read as _, Write as _};
    use std::path::{Path, PathBuf};

    /// The size of a picture in bytes.
    const BYTES: usize = 4 * SIZE[0] as usize * SIZE[1] as usize;

    /// Returns the picture of a scene, which is read from a folder or, if it is not there, drawn now and stored there. A picture that cannot be
    /// stored is drawn again the next time.
    pub(crate) async fn kept_or_drawn(
        name: &'static str,
        registries: &Registries,
        folder: Option<PathBuf>,
    ) -> Option<Pixels> {
        let Some(folder) = folder else { return draw(name, registries).await };
        let path = folder.join(format!("{name}-{:016x}.rgba", mark(name, registries)?));
        if let Some(pixels) = read(&path) {
            return Some(pixels);
        }
        let pixels = draw(name, registries).await?;
        let _ = keep(&folder, name, &path, &pixels);
        Some(pixels)
    }

    /// A fingerprint of everything that determines a picture: the scene, its files, and the program, identified by its executable.
    pub(super) fn mark(name: &str, registries: &Registries) -> Option<u64> {
        let text = opruga::scenes::find(name)?;
        let mut hasher = DefaultHasher::new();
        (SIZE, text, named_files(name, text, &opruga::scenes::files(), registries)).hash(&mut hasher);
        let own = std::env::current_exe().and_then(std::fs::metadata).ok();
        (env!("CARGO_PKG_VERSION"), own.map(|own| (own.len(), own.modified().ok()))).hash(&mut hasher);
        Some(hasher.finish())
    }

    fn read(path: &Path) -> Option<Pixels> {
        let file = std::fs::File::open(path).ok()?;
        let mut pixels = Vec::with_capacity(BYTES);
        DeflateDecoder::new(file).take(BYTES as u64 + 1).read_to_end(&mut pixels).ok()?;
        (pixels.len() == BYTES).then_some(pixels)
    }

    fn keep(folder: &Path, name: &str, path: &Path, pixels: &[u8]) -> std::io::Result<()> {
        let mut encoder = DeflateEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(pixels)?;
        let packed = encoder.finish()?;
        std::fs::create_dir_all(folder)?;
        // Pictures of an earlier version of the scene, or by another program, are no longer needed.
        let beginning = format!("{name}-");
        for old in std::fs::read_dir(folder)?.flatten() {
            let file = old.file_name();
            let mark = file.to_str().and_then(|file| file.strip_prefix(&beginning)?.strip_suffix(".rgba"));
            if mark.is_some_and(|mark| mark.len() == 16 && mark.bytes().all(|letter| letter.is_ascii_hexdigit())) {
                let _ = std::fs::remove_file(old.path());
            }
        }
        let written = safe_write(path, true, |file| file.write_all(&packed));
        written.map(drop).map_err(|error| std::io::Error::other(error.to_string()))
    }

    #[cfg(test)]
    mod tests {
        use super::*;
        use crate::work::finish;

        #[test]
        fn a_picture_is_drawn_once_and_taken_from_the_folder_from_then_on() {
            let folder = std::env::temp_dir().join(format!("opruga-thumbnails-{}", std::process::id()));
            let drawn = || {
                finish(kept_or_drawn("two-chambers", &Registries::default(), Some(folder.clone()))).expect("a picture")
            };
            let files = || -> Vec<PathBuf> {
                std::fs::read_dir(&folder).into_iter().flatten().flatten().map(|file| file.path()).collect()
            };
            let first = drawn();
            assert_eq!((first.len(), files().len()), (BYTES, 1));
            // If another picture is stored under the same name, that picture is shown, which proves that nothing was drawn.
            let other = vec![7; BYTES];
            keep(&folder, "two-chambers", &files()[0], &other).expect("it is kept");
            assert_eq!(drawn(), other);
            // A picture that is damaged, or belongs to an earlier version of a scene, is drawn again and replaced.
            std::fs::write(&files()[0], b"cut").expect("written");
            std::fs::write(folder.join("two-chambers-0123456789abcdef.rgba"), b"").expect("written");
            std::fs::write(folder.join("heart-0123456789abcdef.rgba"), b"").expect("written");
            assert_eq!(drawn(), first);
            assert_eq!(files().len(), 2, "that of another scene stays: {:?}", files());
            std::fs::remove_dir_all(&folder).expect("it goes");
            // There is a file where the folder should be.
            std::fs::write(&folder, b"").expect("a file");
            assert_eq!(drawn(), first);
            std::fs::remove_file(&folder).expect("it goes");
        }

        #[test]
        fn scenes_have_marks_of_their_own() {
            let registries = Registries::default();
            let marks: Vec<u64> = opruga::scenes::names().filter_map(|name| mark(name, &registries)).collect();
            let different: std::collections::BTreeSet<u64> = marks.iter().copied().collect();
            assert_eq!(
                (marks.len(), different.len()),
                (opruga::scenes::names().count(), opruga::scenes::names().count())
            );
        }
    }
}
