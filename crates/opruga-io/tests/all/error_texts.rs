//! The texts of typical errors, word by word.

use crate::common;
use common::*;

fn said(text: &str) -> String {
    errors(text).iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}

/// A command that adds a body at 2 s, in four lines.
const LATE: &str = "[[command]]\ndo = \"add\"\nat = 2\nbody = { name = \"late\", shape = { kind = \"ring\", radius = 1, vertices = 4 }, mass = 1 }\n";

/// Scenes with the texts of their errors.
#[expect(clippy::too_many_lines, reason = "a table: one row for every text")]
fn cases() -> Vec<(String, &'static str)> {
    let model = |fields: &str| format!("{HEAD}{}", BALL.replace("stiffness = 10", fields));
    let with = |more: &str| format!("{HEAD}{BALL}{more}");
    vec![
        (
            String::new(),
            r#"scene.toml:1:1: error[scene.empty]: the scene is empty
 1 | 
   | ^
  = hint: `opruga new NAME` writes a scene to begin with"#,
        ),
        (
            "format = ".into(),
            r#"scene.toml:1:10: error[scene.syntax]: the text is not TOML: a value is missing
 1 | format = 
   |          ^"#,
        ),
        (
            HEAD.replace("opruga-1", "opruga-9"),
            r#"scene.toml:1:10: error[scene.format]: the format is "opruga-9"
 1 | format = "opruga-9"
   |          ^^^^^^^^^^
  = allowed: "opruga-1"
  = hint: this version reads opruga-1 only; another version of the program may read this scene"#,
        ),
        (
            "dimension = 2\n".into(),
            r#"scene.toml:1:1: error[scene.format]: the format is missing
 1 | dimension = 2
   | ^
  = allowed: "opruga-1"
  = hint: begin the file with format = "opruga-1""#,
        ),
        (
            HEAD.replace("dimension = 2", "dimension = 4"),
            r#"scene.toml:2:13: error[scene.dimension]: `dimension` is 4
 2 | dimension = 4
   |             ^
  = allowed: 2 or 3"#,
        ),
        (
            model("stiffness = -5").replace("dimension = 2", "dimensions = 2"),
            r#"scene.toml:2:1: error[scene.missing]: `dimension` is missing
 2 | dimensions = 2
   | ^^^^^^^^^^
  = allowed: 2 or 3
  = hint: `dimensions` is misspelt
scene.toml:11:47: error[scene.range]: `stiffness` is -5
 11 | models = [{ kind = "mass_spring", stiffness = -5 }]
    |                                               ^^
  = allowed: a number >= 0"#,
        ),
        (
            (model("stiffness = -5")
                + "velocity = [1, 2]\nangular_velocity = [0, 0, 1]\npin = [{ selct = { node = 0 } }]\n")
                .replace("dimension = 2", "dimension = 4")
                .replace("\"ring\"", "\"rng\""),
            r#"scene.toml:2:13: error[scene.dimension]: `dimension` is 4
 2 | dimension = 4
   |             ^
  = allowed: 2 or 3
scene.toml:9:18: error[scene.unknown_kind]: there is no shape `rng`
 9 | shape = { kind = "rng", radius = 1.0, vertices = 8 }
   |                  ^^^^^
scene.toml:11:47: error[scene.range]: `stiffness` is -5
 11 | models = [{ kind = "mass_spring", stiffness = -5 }]
    |                                               ^^
  = allowed: a number >= 0
scene.toml:14:10: error[scene.unknown_field]: there is no field `selct` in `pin`
 14 | pin = [{ selct = { node = 0 } }]
    |          ^^^^^
  = allowed: axes, motion, select
  = hint: did you mean `select`?"#,
        ),
        (
            model("stifness = 10"),
            r#"scene.toml:11:35: error[scene.unknown_field]: there is no field `stifness` in `mass_spring`
 11 | models = [{ kind = "mass_spring", stifness = 10 }]
    |                                   ^^^^^^^^
  = allowed: stiffness, modulus, damping, edges, kind
  = hint: did you mean `stiffness`?"#,
        ),
        (
            with("pin = [{ select = { nodes = [[0, 1], [2, 3]] } }]\n"),
            r#"scene.toml:12:29: error[scene.type]: `nodes` is a list of lists
 12 | pin = [{ select = { nodes = [[0, 1], [2, 3]] } }]
    |                             ^^^^^^^^^^^^^^^^
  = allowed: a list of whole numbers from 0
  = hint: write the numbers of all lists one after another, in a single list"#,
        ),
        (
            model("stiffness = -5"),
            r#"scene.toml:11:47: error[scene.range]: `stiffness` is -5
 11 | models = [{ kind = "mass_spring", stiffness = -5 }]
    |                                               ^^
  = allowed: a number >= 0"#,
        ),
        (
            model("stiffness = \"10\""),
            r#"scene.toml:11:47: error[scene.type]: `stiffness` is a text
 11 | models = [{ kind = "mass_spring", stiffness = "10" }]
    |                                               ^^^^
  = allowed: a number >= 0
  = hint: write it without quotes"#,
        ),
        (
            model("stiffness = nan"),
            r#"scene.toml:11:47: error[scene.not_finite]: `stiffness` is not finite
 11 | models = [{ kind = "mass_spring", stiffness = nan }]
    |                                               ^^^
  = allowed: a number >= 0"#,
        ),
        (
            model("stiffness = 1e400"),
            r#"scene.toml:11:47: error[scene.not_finite]: `stiffness` is too large for a 64-bit number
 11 | models = [{ kind = "mass_spring", stiffness = 1e400 }]
    |                                               ^^^^^
  = allowed: a number >= 0"#,
        ),
        (
            model("stiffness = 1, edges = \"boundry\""),
            r#"scene.toml:11:58: error[scene.unknown_word]: `edges` is "boundry"
 11 | models = [{ kind = "mass_spring", stiffness = 1, edges = "boundry" }]
    |                                                          ^^^^^^^^^
  = allowed: one of "boundary", "all", "shear"
  = hint: did you mean `boundary`?"#,
        ),
        (
            format!("{HEAD}[[body]]\nmass = 1\n"),
            r#"scene.toml:7:1: error[scene.missing]: `name`, `shape` are missing from `body`
 7 | [[body]]
   | ^^^^^^^^"#,
        ),
        (
            with("density = 3\n"),
            r#"scene.toml:12:11: error[scene.conflict]: the body has `mass` and `density`
 12 | density = 3
    |           ^
  = allowed: exactly one of mass, density, density_of_cells, node_mass"#,
        ),
        (
            HEAD.to_string() + &BALL.replace("mass = 1.0\n", ""),
            r#"scene.toml:7:1: error[scene.missing]: the body has no mass
 7 | [[body]]
   | ^^^^^^^^
  = allowed: exactly one of mass, density, density_of_cells, node_mass
  = hint: a body that never moves has `fixed = true`"#,
        ),
        (
            with("mass = 2\n"),
            r#"scene.toml:12:1: error[scene.duplicate_key]: `mass` is given twice, first in line 10
 12 | mass = 2
    | ^^^^
  = hint: keep one of the two"#,
        ),
        (
            with(BALL),
            r#"scene.toml:13:8: error[scene.duplicate_name]: two bodies are called `ball`, first in line 8
 13 | name = "ball"
    |        ^^^^^^
  = hint: every body needs a unique name; use `copies` for many identical bodies"#,
        ),
        (
            with("velocity = [1, 2, 3]\n"),
            r#"scene.toml:12:12: error[scene.length]: `velocity` has 3 numbers
 12 | velocity = [1, 2, 3]
    |            ^^^^^^^^^
  = allowed: 2 finite numbers"#,
        ),
        (
            with("pin = [{ select = { box = [[5, 5], [6, 6]] } }]\n"),
            r#"scene.toml:12:19: error[scene.selects_nothing]: the selector selects no node of `ball`
 12 | pin = [{ select = { box = [[5, 5], [6, 6]] } }]
    |                   ^^^^^^^^^^^^^^^^^^^^^^^^^^
  = hint: at the start, the body lies between [-1.0, -1.0] and [1.0, 1.0]"#,
        ),
        (
            with("pin = [{ select = { and = [] } }]\n"),
            r#"scene.toml:12:27: error[scene.length]: `and` is empty
 12 | pin = [{ select = { and = [] } }]
    |                           ^^
  = allowed: a list of at least one selector"#,
        ),
        (
            with("pin = [{ select = { node = 8 } }]\n"),
            r#"scene.toml:12:19: error[scene.range]: body `ball` has no node 8
 12 | pin = [{ select = { node = 8 } }]
    |                   ^^^^^^^^^^^^
  = allowed: nodes from 0 to 7"#,
        ),
        (
            with("[[load]]\nkind = \"force\"\nbody = \"bal\"\nvalue = [0, 1]\n"),
            r#"scene.toml:14:8: error[scene.unknown_name]: there is no body `bal`
 14 | body = "bal"
    |        ^^^^^
  = allowed: ball
  = hint: did you mean `ball`?"#,
        ),
        (
            with("[[load]]\nkind = \"traction\"\nbody = \"ball\"\nvalue = [0, 1]\nselect = { node = 0 }\n"),
            r#"scene.toml:16:10: error[scene.selects_nothing]: no facet of the boundary of `ball` has all of its nodes selected by the load
 16 | select = { node = 0 }
    |          ^^^^^^^^^^^^
  = allowed: all nodes of at least one facet: an edge of the outline, or a triangle of the surface
  = hint: `side`, `group` and `boundary` select whole sides; `kind = "force"` acts on nodes"#,
        ),
        (
            with(&format!(
                "{LATE}[[load]]\nkind = \"pressure\"\nbody = \"late\"\nvalue = 1\nselect = {{ nodes = [0, 2] }}\n"
            )),
            r#"scene.toml:20:10: error[scene.selects_nothing]: no facet of the boundary of `late` has all of its nodes selected by the load
 20 | select = { nodes = [0, 2] }
    |          ^^^^^^^^^^^^^^^^^^
  = allowed: all nodes of at least one facet: an edge of the outline, or a triangle of the surface
  = hint: `side`, `group` and `boundary` select whole sides; `kind = "force"` acts on nodes"#,
        ),
        (
            with("[[load]]\nkind = \"pressure\"\nbody = \"ball\"\nvalue = 1\n").replace(
                "kind = \"ring\", radius = 1.0, vertices = 8",
                "kind = \"line\", from = [0, 0], to = [1, 0], segments = 2",
            ),
            r#"scene.toml:12:1: error[scene.selects_nothing]: no facet of the boundary of `ball` has all of its nodes selected by the load
 12 | [[load]]
    | ^^^^^^^^
  = allowed: bodies that have a boundary
  = hint: a chain has none; `kind = "force"` acts on nodes"#,
        ),
        (
            with(&format!("{BALL}[[command]]\ndo = \"remove\"\nat = 0.1\nbody = \"bell\"\n")),
            r#"scene.toml:13:8: error[scene.duplicate_name]: two bodies are called `ball`, first in line 8
 13 | name = "ball"
    |        ^^^^^^
  = hint: every body needs a unique name; use `copies` for many identical bodies
scene.toml:20:8: error[scene.unknown_name]: there is no body `bell`
 20 | body = "bell"
    |        ^^^^^^
  = allowed: ball
  = hint: did you mean `ball`?"#,
        ),
        (
            with(
                "copies = { count = [2], spacing = [3, 0] }\n[[probe]]\nname = \"p\"\nbody = \"ball\"\nrecord = [\"position\"]\n",
            ),
            r#"scene.toml:15:8: error[scene.unknown_name]: there is no body `ball`
 15 | body = "ball"
    |        ^^^^^^
  = allowed: ball[0], ball[1]
  = hint: `ball` has 2 copies: `ball[0]` … `ball[1]`"#,
        ),
        (
            with(
                "copies = { count = [2], spacing = [3, 0] }\n[[command]]\ndo = \"remove\"\nat = 0.1\nbody = \"ball\"\n",
            ),
            r#"scene.toml:16:8: error[scene.unknown_name]: there is no body `ball`
 16 | body = "ball"
    |        ^^^^^^
  = allowed: ball[0], ball[1]
  = hint: `ball` has 2 copies: `ball[0]` … `ball[1]`"#,
        ),
        (
            with(&format!("{LATE}[[command]]\ndo = \"pin\"\nat = 1\nuntil = 3\nbody = \"late\"\n")),
            r#"scene.toml:18:6: error[scene.range]: the command begins at 1 s, before `late` is added at 2 s
 18 | at = 1
    |      ^
  = allowed: a time from 2"#,
        ),
        (
            with(&format!("{LATE}[[load]]\nkind = \"force\"\nbody = \"lat\"\nvalue = [0, 1]\n")),
            r#"scene.toml:18:8: error[scene.unknown_name]: there is no body `lat`
 18 | body = "lat"
    |        ^^^^^
  = allowed: ball, late
  = hint: did you mean `late`?"#,
        ),
        (
            with(&format!("{LATE}{LATE}")),
            r#"scene.toml:19:17: error[scene.duplicate_name]: two bodies are called `late`
 19 | body = { name = "late", shape = { kind = "ring", radius = 1, vertices = 4 }, mass = 1 }
    |                 ^^^^^^"#,
        ),
        (
            HEAD.replace("symplectic_euler", "symplectic_eler"),
            r#"scene.toml:6:8: error[scene.unknown_kind]: there is no integrator `symplectic_eler`
 6 | kind = "symplectic_eler"
   |        ^^^^^^^^^^^^^^^^^
  = allowed: symplectic_euler, newton
  = hint: did you mean `symplectic_euler`?"#,
        ),
        (
            format!("{HEAD}{}", BALL.replace("\"ring\"", "\"plygon\"")),
            r#"scene.toml:9:18: error[scene.unknown_kind]: there is no shape `plygon`
 9 | shape = { kind = "plygon", radius = 1.0, vertices = 8 }
   |                  ^^^^^^^^
  = allowed: ring, rings, regular_polygon, polygon, line, polyline, grid, quadrilateral, svg, map, text, bitmap, mesh
  = hint: did you mean `polygon`?"#,
        ),
        (
            format!(
                "{HEAD}{}",
                BALL.replace(
                    "kind = \"ring\", radius = 1.0, vertices = 8",
                    "kind = \"rings\", centers = [[0, 0], [9, 0], [0.5, 0]], radii = [1, 1, 1], vertices = 40",
                )
            ),
            r#"scene.toml:9:9: error[scene.shape]: the rings 0 and 2 cross or touch
 9 | shape = { kind = "rings", centers = [[0, 0], [9, 0], [0.5, 0]], radii = [1, 1, 1], vertices = 40 }
   |         ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
  = allowed: rings apart from each other, or one inside the other
  = hint: rings are counted from 0; `centers` moves them"#,
        ),
        (
            format!("{HEAD}{}", BALL.replace("\"ring\"", "\"torus\"")),
            r#"scene.toml:9:18: error[scene.dimension]: `torus` does not exist in 2D
 9 | shape = { kind = "torus", radius = 1.0, vertices = 8 }
   |                  ^^^^^^^
  = allowed: dimension 3"#,
        ),
        (
            HEAD.replace("seconds = 1", "seconds = 1\nframe = 1e-18"),
            r#"scene.toml:5:9: error[scene.range]: a step of 6.25e-20 s is lost in rounding at t = 1 s: time would not advance
 5 | frame = 1e-18
   |         ^^^^^
  = allowed: a step that changes the time"#,
        ),
        (
            format!(
                "{HEAD}{}copies = {{ count = [1000], spacing = [1, 1] }}\n",
                BALL.replace("vertices = 8", "vertices = 100000")
            ),
            r#"scene.toml:12:10: error[limit.memory]: the scene would need at least about 24051600000 bytes
 12 | copies = { count = [1000], spacing = [1, 1] }
    |          ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
  = allowed: at most 8589934592 bytes"#,
        ),
        (
            format!("{HEAD}{}", BALL.replace("\"ball\"", "\"\\u001b[31mred\"")),
            r#"scene.toml:8:8: error[scene.name]: the name contains `\u{1b}`
 8 | name = "\u001b[31mred"
   |        ^^^^^^^^^^^^^^^
  = allowed: 1 to 256 bytes without control characters and . , [ ] = quotes; not only digits"#,
        ),
        (
            with("[[command]]\ndo = \"set\"\nat = 2\npath = \"body.ball.models.mass_spring.stifness\"\nvalue = 1\n"),
            r#"scene.toml:15:8: error[scene.unknown_parameter]: there is no parameter `stifness` of `mass_spring`
 15 | path = "body.ball.models.mass_spring.stifness"
    |        ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
  = allowed: stiffness, modulus, damping, edges
  = hint: did you mean `stiffness`?"#,
        ),
        (
            with("[[command]]\ndo = \"drag\"\nat = 2\nbody = \"ball\"\npath = [[2, 0, 0], [1, 0, 0]]\n"),
            r#"scene.toml:16:20: error[scene.range]: t does not increase: 1 follows 2
 16 | path = [[2, 0, 0], [1, 0, 0]]
    |                    ^^^^^^^^^
  = allowed: a path [[t, x, y], …] of finite numbers with rising t"#,
        ),
        (
            "[[[[".repeat(40),
            r#"scene.toml:1:2: error[scene.depth]: tables and arrays are nested more than 128 levels deep
 1 | [[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[
   |  ^
  = allowed: at most 128 levels"#,
        ),
        (
            format!("{HEAD}[time]\nseconds = 2\n"),
            r#"scene.toml:7:2: error[scene.duplicate_key]: `time` is given twice
 7 | [time]
   |  ^^^^
  = hint: keep one of the two
scene.toml:8:1: error[scene.duplicate_key]: `seconds` is given twice, first in line 4
 8 | seconds = 2
   | ^^^^^^^
  = hint: keep one of the two"#,
        ),
    ]
}

#[test]
fn errors_say_what_they_should() {
    let told = cases().into_iter().map(|(scene, expected)| (said(&scene), expected));
    let wrong: Vec<(String, &str)> = told.filter(|(said, expected)| said != expected).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn the_error_object() {
    let scene = format!("{HEAD}{}", BALL.replace("stiffness = 10", "stifness = 10"));
    assert_eq!(
        errors(&scene)[0].to_json(),
        serde_json::json!({
            "code": "scene.unknown_field",
            "message": "there is no field `stifness` in `mass_spring`",
            "file": "scene.toml",
            "line": 11,
            "column": 35,
            "path": "body.0.models.0.stifness",
            "value": "stifness",
            "allowed": "stiffness, modulus, damping, edges, kind",
            "hint": "did you mean `stiffness`?",
        })
    );
}

/// Positions of excessive size are refused at their own line, with the value and what is allowed.
#[test]
fn placements_beyond_all_measure_name_their_field() {
    let with = |field: &str| format!("{HEAD}{BALL}{field}\n");
    for (field, parts) in [
        ("rotation = 1e200", ["`rotation` is 1e200", "angles within 1e6 radians", "whole turns of 6.283185307179586"]),
        ("rotation = -1e7", ["`rotation` is -1e7", "angles within 1e6 radians", "whole turns of 6.283185307179586"]),
        ("scale = 1e-320", ["`scale` is 1e-320: products of such small lengths are zero", "from 1e-70", "in metres"]),
    ] {
        let said = said(&with(field));
        assert!(said.contains(&format!(" | {field}")), "{said}");
        assert!(parts.iter().all(|part| said.contains(part)), "{said}");
    }
}
