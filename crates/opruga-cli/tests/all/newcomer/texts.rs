//! Scenes with errors in the text: another encoding, slips of syntax, other files, words that have another name here.

use super::*;

/// A scene in another encoding is refused with its location: no character is silently replaced.
#[test]
fn a_scene_that_is_no_utf_8_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut latin = scene("").into_bytes();
    latin.extend_from_slice(b"# caf\xe9\n");
    std::fs::write(folder.path().join("latin.toml"), &latin).expect("a file");
    let output = opruga(folder.path(), &["run", "latin.toml", "--out", "o"]);
    assert_eq!(code(&output), 2, "{}", said(&output));
    assert!(said(&output).contains("latin.toml:15:6: error[scene.encoding]"), "{}", said(&output));
}

/// One slip is one error, however many lines become meaningless because of it.
#[test]
fn one_slip_of_syntax_is_one_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let good = scene("");
    let lists =
        good.replace("models = [{", "models = \n  {").replace("}]\n", "},\n  { kind = \"pressure\", nRT = 5.0 },\n]\n");
    let cases = [
        (lists, "a value is missing", ""),
        (good.replace("mass = 1\n", "mass = 1 kg\n"), "must be quoted", "numbers have no units: write 1;"),
        (good.replace("mass = 1\n", "mass = 2.5e-3kg\n"), "", "write 2.5e-3;"),
    ];
    for (text, message, hint) in cases {
        std::fs::write(folder.path().join("s.toml"), &text).expect("a file");
        let output = opruga(folder.path(), &["check", "s.toml"]);
        assert_eq!(code(&output), 2, "{text}");
        let said = said(&output);
        assert_eq!(said.matches("error[scene.syntax]").count(), 1, "{said}");
        assert!(said.contains(message) && said.contains(hint), "{said}");
    }
    // An unclosed list includes everything that follows; the error is located where that stops making sense.
    let path = "[[command]]\ndo = \"drag\"\nat = 0\nuntil = 1\nbody = \"ring\"\nnode = 0\npath = [\n  [0, 0, 1],\n  [1, 0, 1\n  [2, 0, 1],\n]\n";
    let more = "[[probe]]\nname = \"p\"\nbody = \"ring\"\nselect = { node = 1 }\nrecord = [\"position\"]\n";
    for (text, place) in [
        (scene(&format!("{path}{more}")), "s.toml:24:"),
        (scene(&path.replace("1\n  [2", "1],\n  [2").replace("],\n]\n", "],\n")), "s.toml:2"),
    ] {
        std::fs::write(folder.path().join("s.toml"), &text).expect("a file");
        let said = said(&opruga(folder.path(), &["check", "s.toml"]));
        assert_eq!(said.matches("error[").count(), 1, "{text}\n{said}");
        assert!(
            said.starts_with(place)
                && said.contains("the list that opens in line ")
                && said.contains("a `]` is missing"),
            "{said}"
        );
    }
    // Two slips are two errors, also in consecutive lines.
    let two = good.replace("dimension = 2\n", "dimension = = 2\nseed = 1 2\n");
    std::fs::write(folder.path().join("s.toml"), two).expect("a file");
    let output = opruga(folder.path(), &["check", "s.toml"]);
    assert_eq!(said(&output).matches("error[scene.syntax]").count(), 2, "{}", said(&output));
}

#[test]
fn the_file_of_a_shape_is_not_read_as_a_scene() {
    let folder = tempfile::tempdir().expect("a folder");
    for (file, kind) in [("cow.obj", "surface"), ("heart.svg", "svg"), ("beam.msh", "mesh"), ("land.geojson", "map")] {
        std::fs::write(folder.path().join(file), "1 2 3\n4 5 6\n7 8 9\n").expect("a file");
        for command in ["check", "run", "modes"] {
            let output = opruga(folder.path(), &[command, file]);
            assert_eq!(code(&output), 2, "{}", said(&output));
            let text = format!(
                "error[scene.no_scene]: this is the file of a shape, not a scene\n  = hint: name the file in a scene: shape = {{ kind = \"{kind}\", file = \"{file}\""
            );
            assert!(said(&output).contains(&text), "{}", said(&output));
        }
    }
}

/// Terms of the field that have another name here, and fields that a new kind does not have.
#[test]
fn other_words_of_the_field_lead_to_ours() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("s.toml"), scene("")).expect("a file");
    for (word, ours) in [("rk4", "runge_kutta"), ("Leapfrog", "verlet"), ("implicit_euler", "backward_euler")] {
        let output = opruga(folder.path(), &["check", "s.toml", "--set", &format!("integrator={word}")]);
        assert_eq!(code(&output), 2);
        assert!(said(&output).contains(&format!("did you mean `{ours}`?")), "{}", said(&output));
    }
    let implicit = scene("").replace("kind = \"verlet\"", "kind = \"backward_euler\"\niterations = 20");
    std::fs::write(folder.path().join("i.toml"), implicit).expect("a file");
    let output = opruga(folder.path(), &["check", "i.toml", "--set", "integrator.kind=heun"]);
    assert_eq!(code(&output), 2);
    assert!(said(&output).contains("--set integrator=heun uses the defaults of this kind"), "{}", said(&output));
    assert_eq!(code(&opruga(folder.path(), &["check", "i.toml", "--set", "integrator=verlet"])), 0);
}
