//! A catalogue and a full scene for the tests of the reader.
#![allow(dead_code, reason = "every test file uses its own part")]

pub(crate) mod cube;
pub(crate) mod shapes;

use opruga_core::spec::{Allowed, Default, Field, Spec};
use opruga_io::scene::{Limits, Options, read};
use opruga_io::{Catalogue, Notice, SceneError};
use opruga_world::blueprint::{AnyBlueprint, Blueprint};

const fn field(name: &'static str, range: Allowed, unit: &'static str, default: Default) -> Field {
    Field::new(name, range, unit, default, "For tests.")
}

const fn spec(kind: &'static str, dimensions: &'static [usize], fields: &'static [Field]) -> Spec {
    Spec { kind, summary: "for tests", documentation: "", dimensions, fields, roles: &[] }
}

static MASS_SPRING: Spec = spec(
    "mass_spring",
    &[2, 3],
    &[
        field("stiffness", Allowed::NOT_NEGATIVE, "N/m", Default::Absent),
        field("modulus", Allowed::NOT_NEGATIVE, "N/m", Default::Absent),
        field("damping", Allowed::NOT_NEGATIVE, "N·s/m", Default::Number(0.0)),
        field("edges", Allowed::Choice(&["boundary", "all", "shear"]), "", Default::Text("all")),
    ],
);
static PRESSURE: Spec = spec(
    "pressure",
    &[2, 3],
    &[
        field("nRT", Allowed::POSITIVE, "J", Default::Required),
        field("ambient", Allowed::NOT_NEGATIVE, "Pa", Default::Number(0.0)),
        field("temperature", Allowed::Curve, "s, 1", Default::Absent),
    ],
);
static PLANE_ONLY: Spec = spec("plane_only", &[2], &[]);
static SYMPLECTIC_EULER: Spec = spec("symplectic_euler", &[2, 3], &[]);
static NEWTON: Spec = spec(
    "newton",
    &[2, 3],
    &[field("iterations", Allowed::Integer { least: 1, greatest: 1000 }, "", Default::Integer(20))],
);
static HALF_SPACE: Spec = spec(
    "half_space",
    &[2, 3],
    &[
        field("point", Allowed::Vector, "m", Default::Required),
        field("normal", Allowed::Vector, "", Default::Required),
        field("restitution", Allowed::FRACTION, "", Default::Number(0.0)),
        field("friction", Allowed::NOT_NEGATIVE, "", Default::Number(0.0)),
    ],
);

pub(crate) fn catalogue() -> Catalogue {
    Catalogue {
        models: vec![&MASS_SPRING, &PRESSURE, &PLANE_ONLY],
        integrators: vec![&SYMPLECTIC_EULER, &NEWTON],
        colliders: vec![&HALF_SPACE],
    }
}

pub(crate) fn read_text(text: &str) -> Result<(AnyBlueprint, Vec<Notice>), Vec<SceneError>> {
    // Limits that are the same on every machine.
    let options = Options { limits: Limits::of_addresses(64), ..Options::default() };
    read(text.as_bytes(), "scene.toml", &catalogue(), &options)
}

pub(crate) fn read_with(text: &str, options: &Options) -> Result<(AnyBlueprint, Vec<Notice>), Vec<SceneError>> {
    read(text.as_bytes(), "scene.toml", &catalogue(), options)
}

pub(crate) fn plane(text: &str) -> Blueprint<2> {
    match read_text(text) {
        Ok((AnyBlueprint::Plane(b), _)) => b,
        Ok(_) => panic!("the scene is in space"),
        Err(errors) => panic!("{}", errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")),
    }
}

pub(crate) fn space(text: &str) -> Blueprint<3> {
    match read_text(text) {
        Ok((AnyBlueprint::Space(b), _)) => b,
        Ok(_) => panic!("the scene is in the plane"),
        Err(errors) => panic!("{}", errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")),
    }
}

pub(crate) fn errors(text: &str) -> Vec<SceneError> {
    read_text(text).expect_err("the scene should be refused")
}

/// The first lines of every scene.
pub(crate) const HEAD: &str =
    "format = \"opruga-1\"\ndimension = 2\n[time]\nseconds = 1\n[integrator]\nkind = \"symplectic_euler\"\n";

/// A body to which other parts of a scene can be added.
pub(crate) const BALL: &str = "[[body]]\nname = \"ball\"\nshape = { kind = \"ring\", radius = 1.0, vertices = 8 }\nmass = 1.0\nmodels = [{ kind = \"mass_spring\", stiffness = 10 }]\n";

/// A scene with all features.
pub(crate) const FULL: &str = r#"format = "opruga-1"
dimension = 2
seed = 7
title = "Everything"
[time]
seconds = 8.0
frame = 0.016666666666666666
substeps = 16
[world]
gravity = [0.0, -9.81]
drag = 0.1
largest_force = 1e6
largest_velocity = 1e3
[integrator]
kind = "newton"
iterations = 12
[[body]]
name = "ball"
shape = { kind = "ring", radius = 0.5, vertices = 36, center = [0.0, 2.0] }
mass = 1.0
velocity = [1.0, 0.0]
angular_velocity = 0.5
models = [ { kind = "mass_spring", stiffness = 1600.0, damping = 4.0 }, { kind = "pressure", nRT = 100.0, ambient = 0.0, temperature = [[0, 1], [2, 1.5]] } ]
pin = [ { select = { box = [[-1.0, 1.9], [1.0, 2.1]] }, axes = "xy", motion = [[0, 0, 0], [1, 0.5, 0]] } ]
[[body]]
name = "row"
shape = { kind = "grid", size = [1, 1], cells = [2, 2] }
density = 1000
thickness = 0.1
rotation = 0.5
scale = 0.5
position = [5.0, 0.0]
copies = { count = [3, 2], spacing = [2.0, 2.0], jitter = 0.1, first = [0.5, 0.0] }
pin = [ { select = { and = [ { side = "left" }, { not = { node = 0 } } ] } } ]
[[body]]
name = "wall"
shape = { kind = "polygon", points = [[9, 0], [10, 0], [10, 1]] }
fixed = true
[[collider]]
kind = "half_space"
point = [0.0, 0.0]
normal = [0.0, 1.0]
restitution = 0.5
friction = 0.3
[[load]]
kind = "force"
body = "ball"
select = { node = 0 }
value = [0.0, 1.0]
curve = [[0, 0], [1, 1]]
[[load]]
kind = "traction"
body = "row[3]"
select = { or = [ { side = "top" }, { nodes = [0, 1] } ] }
value = [1.0, 0.0]
[[load]]
kind = "pressure"
body = 0
select = { boundary = true }
value = 10
[[command]]
at = 3.0
until = 4.0
do = "drag"
body = "ball"
node = "nearest"
path = [[3.0, 0.4, 0.2], [4.0, 1.5, 2.0]]
[[command]]
at = 1.0
until = 2.0
do = "push"
body = "ball"
select = { ball = { center = [0.0, 2.5], radius = 0.2 } }
force = [1.0, 0.0]
[[command]]
at = 1.0
until = 2.0
do = "pin"
body = "row[0]"
select = { half_space = { point = [0.0, -9.0], normal = [0.0, 1.0] } }
axes = "y"
[[command]]
at = 1.5
do = "free"
body = "row[0]"
select = { node = 0 }
[[command]]
at = 2.0
do = "set"
path = "body.ball.models.pressure.nRT"
value = 50
[[command]]
at = 2.5
do = "add"
body = { name = "late", shape = { kind = "ring", radius = 0.2, vertices = 8 }, node_mass = 0.1, models = [] }
[[command]]
at = 5.0
do = "remove"
body = "late"
[[probe]]
name = "top"
body = "ball"
select = { node = 0 }
record = ["position", "reaction"]
"#;
