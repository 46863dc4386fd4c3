//! Bad scenes, row by row: every one is refused with a stable code and a location, and none causes a panic.

use crate::common;
use common::*;
use opruga_io::scene::{Limits, Options, read, read_file};

/// The codes of the errors, with limits that are the same on every machine.
fn codes(bytes: &[u8]) -> Vec<&'static str> {
    let options = Options { limits: Limits::of_addresses(64), ..Options::default() };
    match read(bytes, "scene.toml", &catalogue(), &options) {
        Ok(_) => vec![],
        Err(errors) => errors.iter().map(|e| e.code).collect(),
    }
}

fn utf16(text: &str, big: bool, mark: bool) -> Vec<u8> {
    let units = mark.then_some(0xfeffu16).into_iter().chain(text.encode_utf16());
    units.flat_map(|u| if big { u.to_be_bytes() } else { u.to_le_bytes() }).collect()
}

/// Row 1.
#[test]
fn empty_and_foreign_encodings() {
    for text in ["", " ", "\n\n\t ", "\u{feff}", "\u{feff}  \r\n"] {
        assert_eq!(codes(text.as_bytes()), ["scene.empty"], "{text:?}");
    }
    for (big, mark) in [(true, true), (false, true), (true, false), (false, false)] {
        assert_eq!(codes(&utf16(HEAD, big, mark)), ["scene.encoding"]);
    }
    let mut latin = HEAD.as_bytes().to_vec();
    latin.extend_from_slice(b"title = \"caf\xe9\"\n");
    let errors = read(&latin, "scene.toml", &catalogue(), &Options::default()).expect_err("latin-1");
    assert_eq!((errors[0].code, errors[0].line, errors[0].column), ("scene.encoding", Some(7), Some(13)));
    assert!(codes(format!("\u{feff}{HEAD}").as_bytes()).is_empty());
    // The parser would skip a second mark.
    assert_eq!(codes(format!("\u{feff}\u{feff}{HEAD}").as_bytes()), ["scene.encoding"]);
}

/// Row 2: every prefix of a full scene is accepted or refused with line and column.
#[test]
fn every_prefix() {
    let mut whole = 0;
    for end in 0..FULL.len() {
        match read(&FULL.as_bytes()[..end], "scene.toml", &catalogue(), &Options::default()) {
            Ok(_) => whole += 1,
            Err(errors) => {
                assert!(!errors.is_empty());
                for error in errors {
                    assert!(error.line.is_some() && error.column.is_some(), "prefix {end}: {error}");
                    assert!(error.to_string().contains("scene.toml:"), "{error}");
                }
            }
        }
    }
    // If it is cut at the end of a table, the rest is a smaller scene.
    assert!(whole > 0 && whole < FULL.len() / 20, "{whole} prefixes are scenes");
}

/// Row 3.
#[test]
fn deep_nesting() {
    let million = 1_000_000;
    let deep = [
        "[".repeat(million),
        format!("a = {}", "[".repeat(million)),
        format!("a = {}", "[\n".repeat(million)),
        format!("a = {}", "{a=".repeat(million)),
        format!("a = {}", "{a=[".repeat(million)),
        format!("a = {}", "[}".repeat(million)),
        format!("{}a = 1", "a.".repeat(million)),
        format!("[{}a]", "a.".repeat(million)),
        format!("[[{}a]]", "a . ".repeat(million)),
        format!("{}a = 1", "\"a\".".repeat(million)),
        format!("x = {{ {}a = 1 }}", "a.".repeat(million)),
        format!("[{}a]\nx = {}", "a.".repeat(100), "[".repeat(100)),
    ];
    for text in &deep {
        let short: String = text.chars().take(20).collect();
        assert_eq!(codes(text.as_bytes()), ["scene.depth"], "{short}");
    }
    // Brackets in texts and comments do not count as depth.
    let text = format!("{HEAD}# {}\n[world]\ndrag = 1 # {}\n", "[".repeat(1000), "{".repeat(1000));
    assert!(codes(text.as_bytes()).is_empty());
    let text = format!("title = \"{}\"\n{HEAD}", "[".repeat(200));
    assert!(codes(text.as_bytes()).is_empty());
}

/// Row 4.
#[test]
fn too_large() {
    let limits = Limits { file_bytes: 1000, ..Limits::default() };
    let options = Options { limits, ..Options::default() };
    let errors = read(&[b'#'; 1001], "scene.toml", &catalogue(), &options).expect_err("too large");
    assert_eq!(errors[0].code, "scene.too_large");
    assert_eq!(codes(format!("a = [{}]", "1,".repeat(5_000_000)).as_bytes()), ["scene.too_large"]);
    let sparse = std::env::temp_dir().join(format!("opruga-sparse-{}", std::process::id()));
    let file = std::fs::File::create(&sparse).expect("a file");
    file.set_len(1 << 40).expect("a sparse file");
    let errors = read_file(&sparse, &catalogue(), &Options::default()).expect_err("too large");
    std::fs::remove_file(&sparse).expect("the file is there");
    assert_eq!(errors[0].code, "scene.too_large");
}

#[test]
fn files_that_are_none() {
    for (path, code) in [
        ("/nowhere/at/all.toml", "read.failed"),
        ("/dev/zero", "read.not_regular_file"),
        ("/", "read.not_regular_file"),
    ] {
        let errors = read_file(path.as_ref(), &catalogue(), &Options::default()).expect_err(path);
        assert_eq!((errors[0].code, errors[0].exit_code(), errors[0].file.as_str()), (code, 4, path));
    }
}

/// Rows 5 to 11, 16, and those of section 3 about parameters: additions to a good scene, and their errors.
#[test]
#[expect(clippy::too_many_lines, reason = "a table: one row for every error")]
fn one_error_each() {
    let body = |more: &str| {
        format!("{HEAD}[[body]]\nname = \"b\"\nshape = {{ kind = \"ring\", radius = 1, vertices = 8 }}\n{more}\n")
    };
    let model = |fields: &str| format!("{HEAD}{}", BALL.replace("stiffness = 10", fields));
    let time = |line: &str| HEAD.replace("seconds = 1", line);
    let cases: Vec<(String, &str)> = vec![
        // 5: unknown fields
        (model("stifness = 1"), "scene.unknown_field"),
        (format!("{HEAD}[tiem]\n"), "scene.unknown_field"),
        // 6: duplicates
        (format!("{HEAD}{BALL}mass = 2\n"), "scene.duplicate_key"),
        (format!("{HEAD}[time]\nframe = 1\n"), "scene.duplicate_key"),
        (model("stiffness = 1, stiffness = 2"), "scene.duplicate_key"),
        // 7: formats
        (HEAD.replace("opruga-1", "opruga-2"), "scene.format"),
        (HEAD.replace("opruga-1", "opruga-0"), "scene.format"),
        (HEAD.replace("\"opruga-1\"", "1"), "scene.format"),
        ("dimension = 2\n".into(), "scene.format"),
        (HEAD.replace("dimension = 2", "dimension = 4"), "scene.dimension"),
        (HEAD.replace("dimension = 2", "dimension = 2.0"), "scene.dimension"),
        (HEAD.replace("dimension = 2\n", ""), "scene.missing"),
        // 8: not numbers
        (model("stiffness = nan"), "scene.not_finite"),
        (model("stiffness = inf"), "scene.not_finite"),
        (model("stiffness = -inf"), "scene.not_finite"),
        (model("stiffness = 1e400"), "scene.not_finite"),
        (model("stiffness = \"1.0\""), "scene.type"),
        (model("stiffness = true"), "scene.type"),
        (model("stiffness = 1979-05-27"), "scene.type"),
        (model("stiffness = [1]"), "scene.type"),
        (body("mass = 1\nvelocity = [nan, 0]"), "scene.not_finite"),
        (body("mass = 1\nvelocity = [1, \"0\"]"), "scene.type"),
        (body("mass = 1\nvelocity = [1]"), "scene.length"),
        (body("mass = 1\nvelocity = [1, 2, 3]"), "scene.length"),
        (body("mass = 1\nvelocity = 1"), "scene.type"),
        // 9: whole numbers
        (model("stiffness = 9007199254740993"), "scene.range"),
        (model("stiffness = 99999999999999999999999"), "scene.range"),
        (format!("seed = -1\n{HEAD}"), "scene.range"),
        (format!("seed = 9223372036854775807\n{HEAD}"), "scene.range"),
        (format!("seed = 1.5\n{HEAD}"), "scene.type"),
        (format!("{HEAD}{}", BALL.replace("vertices = 8", "vertices = -8")), "scene.range"),
        (format!("{HEAD}{}", BALL.replace("vertices = 8", "vertices = 2")), "scene.range"),
        // 10: missing
        (format!("{HEAD}[[body]]\nmass = 1\n"), "scene.missing"),
        (body(""), "scene.missing"),
        ("format = \"opruga-1\"\ndimension = 2\n".into(), "scene.missing"),
        // 11: names
        (format!("{HEAD}{BALL}{BALL}"), "scene.duplicate_name"),
        (format!("{HEAD}{BALL}[[load]]\nkind = \"force\"\nbody = \"bal\"\nvalue = [1, 0]\n"), "scene.unknown_name"),
        (format!("{HEAD}{BALL}[[load]]\nkind = \"force\"\nbody = 1\nvalue = [1, 0]\n"), "scene.unknown_name"),
        (format!("{HEAD}{BALL}[[load]]\nkind = \"force\"\nbody = 0.0\nvalue = [1, 0]\n"), "scene.type"),
        (format!("{HEAD}{BALL}[[command]]\ndo = \"remove\"\nat = 0\nbody = \"b\"\n"), "scene.unknown_name"),
        // 16: unusual names
        (format!("{HEAD}{}", BALL.replace("\"ball\"", "\"a\\nb\"")), "scene.name"),
        (format!("{HEAD}{}", BALL.replace("\"ball\"", "\"\\u001b[31m\"")), "scene.name"),
        (format!("{HEAD}{}", BALL.replace("\"ball\"", "\"\\u0000\"")), "scene.name"),
        (format!("{HEAD}{}", BALL.replace("\"ball\"", "\"\u{202e}abc\"")), "scene.name"),
        (format!("{HEAD}{}", BALL.replace("\"ball\"", "\"a.b\"")), "scene.name"),
        (format!("{HEAD}{}", BALL.replace("\"ball\"", "\"7\"")), "scene.name"),
        (format!("{HEAD}{}", BALL.replace("\"ball\"", "\"\"")), "scene.name"),
        (format!("{HEAD}{}", BALL.replace("ball", &"x".repeat(1 << 20))), "scene.range"),
        // 18: costs
        (format!("{HEAD}{}copies = {{ count = [4000000, 4000000], spacing = [1, 1] }}\n", BALL), "limit.bodies"),
        (
            format!(
                "{HEAD}{}copies = {{ count = [1000, 1000], spacing = [1, 1] }}\n",
                BALL.replace("vertices = 8", "vertices = 1000000")
            ),
            "limit.nodes",
        ),
        (
            format!(
                "{HEAD}{}copies = {{ count = [1000], spacing = [1, 1] }}\n",
                BALL.replace("vertices = 8", "vertices = 100000")
            ),
            "limit.memory",
        ),
        // 44: mass
        (body("mass = 0"), "scene.range"),
        (body("mass = -1"), "scene.range"),
        (body("density = 0"), "scene.range"),
        (body("mass = 1\ndensity = 1"), "scene.conflict"),
        (body("mass = nan"), "scene.not_finite"),
        // 46: ranges
        (model("stiffness = -1"), "scene.range"),
        (model("damping = -1"), "scene.range"),
        (body("mass = 1\nthickness = 0"), "scene.range"),
        (body("mass = 1\nscale = 0"), "scene.range"),
        (
            format!("{HEAD}[[collider]]\nkind = \"half_space\"\npoint = [0, 0]\nnormal = [0, 1]\nfriction = -1\n"),
            "scene.range",
        ),
        (
            format!("{HEAD}[[collider]]\nkind = \"half_space\"\npoint = [0, 0]\nnormal = [0, 1]\nrestitution = 1.5\n"),
            "scene.range",
        ),
        // 49: time
        (time("seconds = 1\nframe = 0"), "scene.range"),
        (time("seconds = 1\nframe = -1"), "scene.range"),
        (time("seconds = 1\nframe = nan"), "scene.not_finite"),
        (time("seconds = 1\nframe = 1e-18"), "scene.range"),
        (time("seconds = -1"), "scene.range"),
        // 51: counts of zero
        (time("seconds = 1\nsubsteps = 0"), "scene.range"),
        (HEAD.replace("\"symplectic_euler\"", "\"newton\"\niterations = 0"), "scene.range"),
        // 53: curves
        (model("stiffness = 1 }, { kind = \"pressure\", nRT = 0"), "scene.range"),
        (model("stiffness = 1 }, { kind = \"pressure\", nRT = 1, temperature = [[1, 1], [1, 2]]"), "scene.range"),
        (model("stiffness = 1 }, { kind = \"pressure\", nRT = 1, temperature = []"), "scene.range"),
        (model("stiffness = 1 }, { kind = \"pressure\", nRT = 1, temperature = [[0, 1, 2]]"), "scene.length"),
        // 56: gravity
        (format!("{HEAD}[world]\ngravity = [0, nan]\n"), "scene.not_finite"),
        (format!("{HEAD}[world]\ngravity = [0, 0, 0]\n"), "scene.length"),
        // selectors, kinds, shapes
        (format!("{HEAD}{BALL}pin = [{{ select = {{ box = [[5, 5], [6, 6]] }} }}]\n"), "scene.selects_nothing"),
        (format!("{HEAD}{BALL}pin = [{{ select = {{ node = 8 }} }}]\n"), "scene.range"),
        (format!("{HEAD}{BALL}pin = [{{ select = {{ group = \"g\" }} }}]\n"), "scene.unknown_name"),
        (format!("{HEAD}{BALL}pin = [{{ select = {{ sides = \"top\" }} }}]\n"), "scene.unknown_field"),
        (format!("{HEAD}{BALL}pin = [{{ select = {{ side = \"front\" }} }}]\n"), "scene.unknown_word"),
        (format!("{HEAD}{BALL}pin = [{{ select = {{ all = true, node = 1 }} }}]\n"), "scene.selector"),
        (format!("{HEAD}{BALL}pin = [{{ select = {{ all = false }} }}]\n"), "scene.selector"),
        (format!("{HEAD}{BALL}pin = [{{ select = {{ and = [] }} }}]\n"), "scene.length"),
        (format!("{HEAD}{BALL}pin = [{{ select = {{ not = {{ or = [] }} }} }}]\n"), "scene.length"),
        (format!("{HEAD}{BALL}pin = [{{ select = {{ all = true }}, axes = \"xz\" }}]\n"), "scene.range"),
        (format!("{HEAD}{BALL}pin = {{ select = {{ all = true }} }}\n"), "scene.type"),
        (HEAD.replace("symplectic_euler", "symplectic"), "scene.unknown_kind"),
        (format!("{HEAD}{}", BALL.replace("\"ring\"", "\"icosphere\"")), "scene.dimension"),
        (format!("{HEAD}{}", BALL.replace("mass_spring", "mass_springs")), "scene.unknown_kind"),
        (format!("{HEAD}[body]\nname = \"b\"\n"), "scene.type"),
        (
            body("mass = 1").replace(
                "kind = \"ring\", radius = 1, vertices = 8",
                "kind = \"polygon\", points = [[0, 0], [1, 1], [1, 0], [0, 1]]",
            ),
            "scene.shape",
        ),
        // commands and probes
        (
            format!("{HEAD}{BALL}[[command]]\ndo = \"push\"\nat = 2\nuntil = 1\nbody = \"ball\"\nforce = [0, 0]\n"),
            "scene.range",
        ),
        (
            format!(
                "{HEAD}{BALL}[[command]]\ndo = \"set\"\nat = 2\npath = \"body.ball.models.mass_spring.stifness\"\nvalue = 1\n"
            ),
            "scene.unknown_parameter",
        ),
        (format!("{HEAD}{BALL}[[command]]\ndo = \"set\"\nat = 2\npath = \"world.drag\"\nvalue = -1\n"), "scene.range"),
        (
            format!("{HEAD}{BALL}[[command]]\ndo = \"drag\"\nat = 2\nbody = \"ball\"\nnode = 9\npath = [[2, 0, 0]]\n"),
            "scene.range",
        ),
        (
            format!(
                "{HEAD}{BALL}[[command]]\ndo = \"drag\"\nat = 2\nbody = \"ball\"\nnode = \"near\"\npath = [[2, 0, 0]]\n"
            ),
            "scene.unknown_word",
        ),
        (format!("{HEAD}{BALL}[[probe]]\nname = \"p\"\nbody = \"ball\"\nrecord = []\n"), "scene.length"),
        (
            format!("{HEAD}{BALL}[[probe]]\nname = \"p\"\nbody = \"ball\"\nrecord = [\"positions\"]\n"),
            "scene.unknown_word",
        ),
    ];
    for (text, code) in cases {
        let short: String = text.chars().take(600).collect();
        assert_eq!(codes(text.as_bytes()), [code], "{short}\n{}", errors(&text)[0]);
        let error = &errors(&text)[0];
        assert!(error.line.is_some(), "{error}");
        let json = error.to_json();
        for key in ["code", "message", "file", "line", "column", "path", "value", "allowed", "hint"] {
            assert!(json.get(key).is_some(), "{key}");
        }
        // No control sequences for a terminal are printed.
        assert!(error.to_string().chars().all(|c| c == '\n' || !c.is_control()), "{error:?}");
        assert!(error.to_string().len() < 3000, "{error}");
    }
}

/// Row 8: numbers that are accepted.
#[test]
fn numbers_that_are_fine() {
    for (text, value) in [
        ("-0.0", 0.0),
        ("0", 0.0),
        ("5e-324", 5e-324),
        ("1", 1.0),
        ("9007199254740992", 9_007_199_254_740_992.0),
        ("1_000.5", 1000.5),
        ("0x10", 16.0),
    ] {
        let scene = plane(&format!("{HEAD}{}", BALL.replace("stiffness = 10", &format!("stiffness = {text}"))));
        let number = scene.bodies[0].models[0].number("stiffness").expect("given");
        assert_eq!(number.to_bits(), f64::to_bits(value), "{text}");
    }
    let scene = plane(&format!("{HEAD}[world]\ngravity = [-0.0, 1]\n"));
    assert!(scene.surroundings.gravity[0].is_sign_positive());
}

/// All errors at once, in the order of their lines.
#[test]
fn all_errors_at_once() {
    let text = format!(
        "{HEAD}tolerance = 1\n[world]\ngravity = [0]\n{BALL}pin = [{{ select = {{ node = 99 }} }}]\n[[body]]\nname = \"c\"\nmass = -1\nshape = {{ kind = \"rng\" }}\n\
        [[probe]]\nname = \"p\"\nbody = \"c\"\nrecord = [\"speed\"]\n[[load]]\nkind = \"force\"\nbody = \"d\"\n"
    );
    let found: Vec<(&str, usize)> = errors(&text).iter().map(|e| (e.code, e.line.unwrap_or(0))).collect();
    assert_eq!(
        found,
        [
            ("scene.unknown_field", 7),
            ("scene.length", 9),
            ("scene.range", 15),
            ("scene.range", 18),
            ("scene.unknown_kind", 19),
            ("scene.unknown_word", 23),
            ("scene.missing", 24),
            ("scene.unknown_name", 26),
        ]
    );
    // Very many errors are cut off, and this is reported.
    let many: String = (0..500).map(|k| format!("x{k} = 1\n")).collect();
    let found = errors(&format!("{many}{HEAD}"));
    assert_eq!((found.len(), found[50].code, found[50].message.as_str()), (51, "scene.more", "and 450 more"));
}

/// Whatever a scene contains, it is refused before a parser takes much memory for it. These scenes took 0.4 to 1.4 GB.
#[test]
fn the_memory_of_a_parser_is_bounded() {
    let many: [(&str, String); 9] = [
        ("keys", (0..2_000_000).map(|k| format!("k{k} = 1\n")).collect()),
        ("empty lines", "\n".repeat(30_000_000)),
        ("remarks", "#\n".repeat(15_000_000)),
        ("words", "x\n".repeat(2_000_000)),
        ("numbers", format!("a = {}", "1 ".repeat(10_000_000))),
        ("dotted keys", (0..10_000).map(|k| format!("a{k}.{}b = 1\n", "b.".repeat(99))).collect()),
        ("heads", "[[a]]\n".repeat(2_000_000)),
        ("dotted heads", (0..10_000).map(|k| format!("[a{k}.{}b]\n", "b.".repeat(99))).collect()),
        ("tables", format!("a = [{}]", "{},".repeat(2_000_000))),
    ];
    for (what, text) in many {
        let errors = read(format!("{HEAD}{text}").as_bytes(), "scene.toml", &catalogue(), &Options::default());
        let found: Vec<&str> = errors.expect_err(what).iter().map(|error| error.code).collect();
        assert_eq!(found, ["scene.too_large"], "{what}");
    }
    // However many unknown keys are read, only the first fifty are listed, as errors and as warnings.
    let text = (0..300_000).map(|k| format!("k{k} = 1\n")).collect::<String>() + HEAD;
    let found = errors(&text);
    assert_eq!((found.len(), found[50].code, found[50].message.as_str()), (51, "scene.more", "and 299950 more"));
    let lenient = Options { lenient: true, ..Options::default() };
    let (_, notices) = read(text.as_bytes(), "scene.toml", &catalogue(), &lenient).expect("a scene");
    assert_eq!((notices.len(), notices[50].about.message.as_str()), (51, "and 299950 more"));
    // The same for duplicate keys; the first of them is not a field.
    let found = errors(&format!("{HEAD}{}", "a = 1\n".repeat(1_000)));
    assert_eq!((found.len(), found[50].message.as_str()), (51, "and 950 more"));
}

/// The limits of depth and size are the same for values of the command line and of a scene.
#[test]
fn overrides_have_the_limits_of_scenes() {
    let with = |value: String| {
        let overrides = vec![("world.gravity".to_string(), value)];
        let options = Options { overrides, ..Options::default() };
        let found = read(HEAD.as_bytes(), "scene.toml", &catalogue(), &options).expect_err("no gravity");
        (found[0].code, found[0].path.clone())
    };
    for deep in ["[", "{a=", "[{a=["] {
        assert_eq!(with(deep.repeat(10_000)), ("scene.depth", "world.gravity".into()), "{deep}");
    }
    assert_eq!(with(format!("{}1{}", "[".repeat(10_000), "]".repeat(10_000))).0, "scene.depth");
    assert_eq!(with(format!("{{{}a = 1}}", "a.".repeat(10_000))).0, "scene.depth");
    assert_eq!(with(format!("[{}]", "1,".repeat(5_000_000))).0, "scene.too_large");
    // A depth that a scene may have is not an error here.
    assert_eq!(with(format!("{}1{}", "[".repeat(100), "]".repeat(100))).0, "scene.length");
}

/// Names that look the same in print but differ in their code points are refused, because nobody could know which body is meant.
#[test]
fn names_that_print_alike_are_refused() {
    let named = |name: &str| BALL.replace("\"ball\"", &format!("\"{name}\""));
    let text = format!("{HEAD}{}{}", named("caf\u{e9}"), named("cafe\u{301}"));
    let found = errors(&text);
    assert_eq!((found.len(), found[0].code), (1, "scene.duplicate_name"));
    assert!(found[0].message.contains("U+00E9") && found[0].message.contains("U+0065 U+0301"), "{}", found[0]);
    assert!(codes(format!("{HEAD}{}{}", named("caf\u{e9}"), named("cafe")).as_bytes()).is_empty());
    let probe = |name: &str| {
        format!("[[probe]]\nname = \"{name}\"\nbody = \"ball\"\nselect = {{ node = 0 }}\nrecord = [\"position\"]\n")
    };
    let text = format!("{HEAD}{BALL}{}{}", probe("\u{e9}"), probe("e\u{301}"));
    assert_eq!(errors(&text).iter().map(|e| e.code).collect::<Vec<_>>(), ["scene.duplicate_name"]);
    let add =
        format!("[[command]]\ndo = \"add\"\nat = 0.5\n[command.body]\n{}", named("e\u{301}").replace("[[body]]\n", ""));
    let text = format!("{HEAD}{}{add}", named("\u{e9}"));
    assert_eq!(errors(&text).iter().map(|e| e.code).collect::<Vec<_>>(), ["scene.duplicate_name"]);
}

/// A misspelt name is one error: the field that it probably means is not reported as missing. If unknown fields are accepted, it is.
#[test]
fn a_misspelt_name_is_one_error() {
    for (right, wrong) in [("vertices", "vertces"), ("radius", "radus"), ("mass = 1.0", "mas = 1.0"), ("name", "nme")] {
        let text = format!("{HEAD}{}", BALL.replacen(right, wrong, 1));
        let found: Vec<&str> = errors(&text).iter().map(|error| error.code).collect();
        assert_eq!(found, ["scene.unknown_field"], "{wrong}");
        assert!(read_with(&text, &Options { lenient: true, ..Options::default() }).is_err(), "{wrong}");
    }
}

/// Errors in the fields of a body do not hide those of selectors of its nodes, wherever these are.
#[test]
fn wrong_numbers_of_nodes_are_found_beside_wrong_fields() {
    let text = format!(
        "{HEAD}[[body]]\nname = \"b\"\nshape = {{ kind = \"ring\", radius = 1, vertices = 8 }}\nmass = -1\nvelocity = [1]\n\
         models = [{{ kind = \"mass_spring\", stifness = 10 }}]\npin = [{{ select = {{ node = 99 }} }}]\n\
         [[probe]]\nname = \"p\"\nbody = \"b\"\nselect = {{ node = 98 }}\nrecord = [\"position\"]\n\
         [[load]]\nkind = \"force\"\nbody = \"b\"\nvalue = [1, 0]\nselect = {{ nodes = [0, 97] }}\n\
         [[command]]\ndo = \"drag\"\nat = 0\nbody = \"b\"\nnode = 96\npath = [[0, 0, 0]]\n"
    );
    let found: Vec<(&str, Option<String>)> = errors(&text).into_iter().map(|e| (e.code, e.value)).collect();
    let expected = [
        ("scene.range", "-1"),
        ("scene.length", "[1]"),
        ("scene.unknown_field", "stifness"),
        ("scene.range", "99"),
        ("scene.range", "98"),
        ("scene.range", "97"),
        ("scene.range", "96"),
    ];
    assert_eq!(found, expected.map(|(code, value)| (code, Some(value.to_string()))));
    // If the nodes themselves are in doubt, nothing is reported about selectors.
    for (good, bad) in [("vertices = 8", "vertices = 2"), ("radius = 1", "radius = -1"), ("mass = -1", "scale = 0")] {
        let text = text.replace(good, bad);
        assert!(errors(&text).iter().all(|e| !matches!(e.value.as_deref(), Some("99" | "98" | "97" | "96"))), "{bad}");
    }
}

/// The rest of a scene with errors consists of its parts without errors of their own.
#[test]
fn what_is_left_of_a_scene_with_errors() {
    use opruga_world::blueprint::AnyBlueprint;
    let load = |body: &str| format!("[[load]]\nkind = \"force\"\nbody = \"{body}\"\nvalue = [1, 0]\n");
    let wall = |friction: &str| {
        format!("[[collider]]\nkind = \"half_space\"\npoint = [0, 0]\nnormal = [0, 1]\nfriction = {friction}\n")
    };
    let text = format!(
        "{HEAD}{}{}{}{}{}{}{}",
        BALL.replace("\"ball\"", "\"bad\"").replace("stiffness", "stifness"),
        BALL,
        BALL.replace("\"ball\"", "\"many\"") + "copies = { count = [2], spacing = [3] }\n",
        load("bad"),
        load("ball"),
        wall("-1"),
        wall("0.5"),
    );
    let survey =
        |text: &str| opruga_io::scene::survey(text.as_bytes(), "scene.toml", &catalogue(), &Options::default());
    let reading = survey(&text);
    let found: Vec<&str> = reading.errors.iter().map(|e| e.code).collect();
    assert_eq!(found, ["scene.unknown_field", "scene.length", "scene.range"]);
    let Some(AnyBlueprint::Plane(rest)) = reading.blueprint else { panic!("something is left") };
    let names: Vec<&str> = rest.bodies.iter().map(|b| b.name.as_str()).collect();
    assert_eq!(names, ["ball"]);
    assert_eq!(rest.loads.iter().map(|l| l.body).collect::<Vec<_>>(), [0]);
    assert_eq!(rest.colliders.len(), 1);
    assert_eq!(rest.colliders[0].values.number("friction"), Some(0.5));
    // Without time and an integrator there is nothing to build on.
    for (good, bad) in [("seconds = 1", "seconds = -1"), ("symplectic_euler", "symplectic")] {
        assert!(survey(&text.replace(good, bad)).blueprint.is_none());
    }
    assert!(survey(&format!("{HEAD}{BALL}")).errors.is_empty());
}

/// Row 18: large, but accepted.
#[test]
fn many_bodies() {
    let text = format!("{HEAD}{}copies = {{ count = [1000, 100], spacing = [3, 3] }}\n", BALL);
    assert_eq!(plane(&text).bodies.len(), 100_000);
}

/// Rows 18 and 46: bodies that commands add count as well, and thin bodies with a density need a thickness.
#[test]
fn added_bodies_count_and_thin_ones_need_a_thickness() {
    let add = |k: usize| {
        format!(
            "[[command]]\ndo = \"add\"\nat = {k}\nbody = {{ name = \"late{k}\", mass = 1, shape = {{ kind = \"ring\", radius = 1, vertices = 40 }} }}\n"
        )
    };
    let text = |count: usize| format!("{HEAD}{BALL}{}", (0..count).map(add).collect::<String>());
    let limits = |bodies, nodes| Limits { bodies, nodes, ..Limits::default() };
    let codes = |count: usize, limits: Limits| -> Vec<String> {
        match read_with(&text(count), &Options { limits, ..Options::default() }) {
            Ok(_) => Vec::new(),
            Err(errors) => errors.iter().map(|e| format!("{}@{}", e.code, e.line.unwrap_or(0))).collect(),
        }
    };
    // 8 nodes of the ball and 40 of every other body.
    assert_eq!(codes(3, limits(4, 128)), Vec::<String>::new());
    assert_eq!(codes(3, limits(4, 127)), ["limit.nodes@23"]);
    assert_eq!(codes(3, limits(3, 1000)), ["limit.bodies@23"]);

    let body = |dimension: usize, shape: &str, more: &str| {
        let head = HEAD.replace("dimension = 2", &format!("dimension = {dimension}"));
        let head = if dimension == 3 { head.replace("-9.81]", "-9.81, 0.0]") } else { head };
        format!("{head}[[body]]\nname = \"b\"\nshape = {{ {shape} }}\ndensity = 1000\n{more}")
    };
    let sheet = "kind = \"sheet\", u = [1, 0, 0], v = [0, 0, 1], cells = [2, 2]";
    let chain = "kind = \"line\", from = [0, 0], to = [1, 0], segments = 3";
    let filled = "kind = \"grid\", size = [1, 1, 1], cells = [1, 1, 1]";
    for (scene, expected) in [
        (body(3, sheet, ""), "`density` of a sheet needs its `thickness`"),
        (body(3, sheet, "thickness = 1e-3\n"), ""),
        (body(2, chain, ""), "`density` of a wire needs its width, which `thickness` gives"),
        (body(2, chain, "thickness = 0.1\n"), ""),
        (body(3, filled, ""), ""),
    ] {
        let said = match read_text(&scene) {
            Ok(_) => String::new(),
            Err(errors) => errors[0].message.clone(),
        };
        assert_eq!(said, expected, "{scene}");
    }
}
