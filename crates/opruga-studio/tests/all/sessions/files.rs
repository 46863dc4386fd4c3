//! Files that are saved, and files that are dropped on the window.

use super::{arrive, no_refusal, open, pass, pull, refusal, replayed};
use opruga::Options;
use opruga::io::Files;
use opruga_studio::panels::keeping::{What, content};
use opruga_studio::session::{Request, Session};
use opruga_studio::shown::Show;

#[test]
fn scene_picture_film_animation_and_table_are_kept() {
    let mut session = open("ball");
    pull(&mut session, 12);
    let copied = opruga_studio::runner::Copied::of(&session);
    let bytes = |what| content(what, &copied, Show::default()).expect("a file");
    assert!(bytes(What::Picture).starts_with(b"\x89PNG"));
    let table = String::from_utf8(bytes(What::Table)).expect("a text");
    assert_eq!(table.lines().count(), 14, "a head and thirteen states");
    assert!(table.starts_with("time,kinetic,") && table.contains("ball.volume"));
    let scene = String::from_utf8(bytes(What::Scene)).expect("a text");
    assert_eq!(replayed(&scene, 12), session.hash());
}

#[test]
fn row_99_files_that_are_dropped_become_scenes_or_are_refused_with_a_reason() {
    use opruga_studio::dropping::take;
    let folder = std::env::temp_dir().join(format!("opruga-dropped-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let put = |name: &str, bytes: &[u8]| {
        let path = folder.join(name);
        std::fs::write(&path, bytes).expect("a file");
        path
    };
    let refused = |path: &std::path::Path| take(path).expect_err("it is refused").to_string();
    assert!(refused(&put("letter.docx", b"PK")).contains(".toml"));
    assert!(refused(&put("bytes.toml", &[0xff, 0xfe, 0x00])).contains("UTF-8"));
    assert!(refused(&folder.join("absent.toml")).contains("read"));
    // Two gigabytes that take no disk space: they are refused before they are read.
    let large = std::fs::File::create(folder.join("large.toml")).expect("a file");
    large.set_len(2 << 30).expect("a length");
    assert!(refused(&folder.join("large.toml")).contains("2147483648 bytes"));
    let mut session = open("ball");
    let (hash, name) = (session.hash(), session.name().to_string());
    let wrong = take(&put("wrong.toml", b"format = \"opruga-1\"\ndimension = 7\n")).expect("it is read");
    session.handle(wrong);
    assert!(refusal(&mut session).contains("dimension"));
    assert_eq!((session.hash(), session.name()), (hash, name.as_str()));
    let svg = b"<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 10 10\"><path d=\"M0 0 H10 V10 H0 Z\"/></svg>";
    // A shape of the plane is added to a scene of the plane, also during the run, and again under another name.
    for count in 2..4 {
        session.handle(take(&put("square.svg", svg)).expect("a shape"));
        no_refusal(&mut session);
        assert_eq!((session.shown().bodies.len(), session.name()), (count, name.as_str()));
        pass(&mut session, 3);
    }
    let squares = session.shown().bodies.iter().filter(|body| body.name.starts_with("square")).count();
    assert_eq!(squares, 2);
    let other = String::from_utf8_lossy(svg).replace("H10 V10", "H10 V5");
    session.handle(take(&put("square.svg", other.as_bytes())).expect("a shape"));
    no_refusal(&mut session);
    assert!(session.saved().contains("square-2.svg"), "another file of the same name");
    session.handle(Request::Undo);
    arrive(&mut session);
    assert_eq!(session.shown().bodies.len(), 3);
    // A shape of space opens a scene of its own, from which the user can return.
    let obj = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    session.handle(take(&put("four.obj", obj)).expect("a shape"));
    no_refusal(&mut session);
    pass(&mut session, 3);
    assert_eq!(session.shown().dimension, 3);
    session.handle(Request::Undo);
    assert_eq!((session.shown().bodies.len(), session.name()), (3, name.as_str()));
    std::fs::remove_dir_all(&folder).expect("the folder goes");
}

/// Nobody has seen the scene around such a file, and there is no other file of its name.
#[test]
fn what_is_wrong_with_a_file_that_is_dropped_is_said_of_that_file_and_it_keeps_its_name() {
    use opruga_studio::dropping::take;
    let folder = std::env::temp_dir().join(format!("opruga-dropped-names-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("dir.obj")).expect("a folder");
    let put = |name: &str, bytes: &[u8]| {
        let path = folder.join(name);
        std::fs::write(&path, bytes).expect("a file");
        path
    };
    let ball = opruga::scenes::find("ball").expect("it");
    let beside = Files::beside(&folder.join("ball.toml"));
    let mut session = Session::open("ball", ball, beside, Options::default()).expect("it opens");
    for (path, name) in [
        (put("cut.obj", b"v 0 0"), "cut.obj"),
        (folder.join("dir.obj"), "dir.obj"),
        (put("cut.svg", b"<svg"), "cut.svg"),
    ] {
        session.handle(take(&path).expect("a shape by its name"));
        let said = refusal(&mut session);
        assert!(said.starts_with(&format!("{name}:")) && !said.contains(".toml"), "{said}");
    }
    let svg = b"<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 10 10\"><path d=\"M0 0 H10 V10 H0 Z\"/></svg>";
    session.handle(take(&put("square.svg", svg)).expect("a shape"));
    no_refusal(&mut session);
    assert!(session.saved().contains("\"square.svg\""), "{}", session.saved());
    std::fs::remove_dir_all(&folder).expect("the folder goes");
}

/// What a reader omits from a file is also reported in the window, in both languages.
#[test]
fn what_is_left_out_of_a_file_is_counted_and_named() {
    let text = opruga::scenes::find("ball").expect("it");
    let svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 10 10\"><path d=\"M0 0 H10 V10 H0 Z\"/>\
               <image width=\"3\" height=\"3\"/><image width=\"4\" height=\"4\"/></svg>";
    let files = opruga::scenes::files().with([("odd.svg".to_string(), svg.as_bytes().into())]);
    let odd = "[[body]]\nname = \"odd\"\nshape = { kind = \"svg\", file = \"odd.svg\", size = 0.5, spacing = 0.1, center = [2.0, 2.0] }\n\
               mass = 1.0\nmodels = [{ kind = \"mass_spring\", stiffness = 100.0, damping = 0.1 }]\n\n[[collider]]";
    let text = text.replacen("[[collider]]", odd, 1);
    let mut session = Session::open("odd", &text, files, Options::default()).expect("it opens");
    let warnings = session.shown().warnings;
    let warning = warnings.iter().find(|warning| warning.code == "svg.image").expect("it is named");
    assert_eq!(warning.message, "2 images are left out");
    assert_eq!(opruga_studio::words::Language::Croatian.warning_text(warning), "izostavljeno slika: 2");
    assert!(open("ball").shown().warnings.iter().all(|warning| warning.code != "svg.image"));
}

/// A fine surface needs more substeps than a coarse one, and a user who drops a file does not know how many.
#[test]
fn a_surface_that_is_dropped_takes_as_many_substeps_as_it_needs() {
    let spot = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/shapes/spot.obj");
    let mut session = open("ball");
    session.handle(opruga_studio::dropping::take(std::path::Path::new(spot)).expect("a shape"));
    no_refusal(&mut session);
    assert_eq!(session.name(), "spot");
    assert!(session.shown().substeps > 96, "more than it begins with");
    pass(&mut session, 2);
}

/// The pictures of an animation with their durations [hundredths of a second].
fn pictures_of(gif: &[u8]) -> Vec<(u16, [usize; 2], Vec<u8>)> {
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(gif).expect("an animation");
    let size = [usize::from(decoder.width()), usize::from(decoder.height())];
    let mut canvas = vec![255; 4 * size[0] * size[1]];
    let mut pictures = Vec::new();
    while let Some(frame) = decoder.read_next_frame().expect("a picture") {
        // A picture contains the differences from the previous one: the rest is transparent or omitted.
        let [left, top, width] = [frame.left, frame.top, frame.width].map(usize::from);
        for (k, pixel) in frame.buffer.chunks_exact(4).enumerate().filter(|(_, pixel)| pixel[3] > 0) {
            let place = (top + k / width) * size[0] + left + k % width;
            canvas[4 * place..4 * place + 4].copy_from_slice(pixel);
        }
        pictures.push((frame.delay, size, canvas.clone()));
    }
    pictures
}

/// The position of the ball in a picture: the mean row of the coloured pixels above the floor.
fn height_of_ball([width, height]: [usize; 2], picture: &[u8]) -> f64 {
    let coloured = |pixel: &[u8]| pixel[..3].iter().max().unwrap_or(&0) - pixel[..3].iter().min().unwrap_or(&0) > 60;
    // The legend is on the right.
    let rows = picture.chunks_exact(4).enumerate().filter(|(k, pixel)| k % width < 7 * width / 10 && coloured(pixel));
    let (sum, count) = rows.fold((0.0, 0.0), |(sum, count), (k, _)| (sum + (k / width) as f64, count + 1.0));
    assert!(count > 100.0, "a ball is seen in a picture of {width} by {height}: {count}");
    sum / count
}

/// A ball that falls freely for half a second: in every picture of the films it is lower than in the previous one.
#[test]
fn the_films_hold_every_picture_of_a_ball_that_falls() {
    let text = opruga::scenes::find("ball").expect("it");
    let end = text.find("[[command]]").expect("its pull");
    let mut session =
        Session::open("quiet", &text[..end], opruga::scenes::files(), Options::default()).expect("it opens");
    pass(&mut session, 24);
    let copied = opruga_studio::runner::Copied::of(&session);
    let bytes = |what| content(what, &copied, Show::default()).expect("a file");
    // Thirty pictures per second for 0.4 s, and the one at the start.
    let animation = pictures_of(&bytes(What::Animation));
    assert_eq!(animation.len(), 13);
    assert!(animation.iter().all(|(delay, ..)| (3..=4).contains(delay)), "a thirtieth of a second each");
    let heights: Vec<f64> = animation.iter().map(|(_, size, picture)| height_of_ball(*size, picture)).collect();
    falls(&heights, "animation");
    let film = bytes(What::Film);
    let size = animation[0].1;
    assert_eq!(&film[4..8], b"ftyp");
    // The table of sizes gives the number of pictures, and the header of a picture its size.
    let number = |place: usize| u32::from_be_bytes(film[place..place + 4].try_into().expect("four bytes")) as usize;
    // The first box lists film types that look like names of boxes.
    let first = number(0);
    let of = |name: &[u8; 4]| 4 + first + film[first..].windows(4).position(|word| word == name).expect("a box");
    assert_eq!(number(of(b"stsz") + 8), 13);
    let side =
        |offset: usize| usize::from(u16::from_be_bytes([film[of(b"avc1") + offset], film[of(b"avc1") + offset + 1]]));
    assert_eq!([side(24), side(26)], size.map(|side| side.next_multiple_of(2)));
    let Some(shown) = decoded(&film) else {
        eprintln!("SKIPPED: there is no ffmpeg on this machine; the pictures of the film were counted and not decoded");
        return;
    };
    let bytes_each = 4 * side(24) * side(26);
    assert_eq!(shown.len(), 13 * bytes_each);
    let heights: Vec<f64> =
        shown.chunks_exact(bytes_each).map(|picture| height_of_ball([side(24), side(26)], picture)).collect();
    falls(&heights, "film");
}

/// Asserts that it falls faster and faster.
fn falls(heights: &[f64], what: &str) {
    let steps: Vec<f64> = heights.windows(2).map(|pair| pair[1] - pair[0]).collect();
    assert!(steps.iter().skip(1).all(|step| *step > 0.2), "{what}: {heights:?}");
    assert!(steps[steps.len() - 1] > 3.0 * steps[1], "{what}: {steps:?}");
}

/// The pictures of a film from an independent decoder; none if there is no decoder.
fn decoded(film: &[u8]) -> Option<Vec<u8>> {
    use std::process::Command;
    Command::new("ffmpeg").arg("-version").output().ok().filter(|output| output.status.success())?;
    let path = std::env::temp_dir().join(format!("opruga-film-{}.mp4", std::process::id()));
    std::fs::write(&path, film).expect("a file");
    let mut ffmpeg = Command::new("ffmpeg");
    ffmpeg.args(["-v", "error", "-i"]).arg(&path).args(["-f", "rawvideo", "-pix_fmt", "rgba", "-"]);
    let output = ffmpeg.output().expect("it runs");
    std::fs::remove_file(&path).expect("the file goes");
    assert!(output.status.success() && output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    Some(output.stdout)
}
