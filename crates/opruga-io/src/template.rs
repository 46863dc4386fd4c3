//! The text that `opruga new NAME` writes: a scene to start from.

use crate::problem::unprintable;

/// A commented scene that runs as it is.
pub fn commented(name: &str) -> String {
    let title: String = name.chars().filter(|c| !unprintable(*c) && !"\"\\".contains(*c)).take(64).collect();
    TEMPLATE.replace("TITLE", &title)
}

const TEMPLATE: &str = r#"# A scene of Opruga. Lengths in metres, masses in kilograms, times in seconds.
#   opruga check FILE    reads it and reports all errors
#   opruga run FILE      runs it
#   opruga list          shows the models, integrators, shapes and colliders
format = "opruga-1"
dimension = 2              # 2 for the plane, 3 for space
seed = 1                   # the same seed gives the same bits
title = "TITLE"

[time]
seconds = 4.0              # how long the scene lasts
frame = 0.016666666666666666 # the length of a frame
substeps = 32              # steps of the integrator in a frame: h = frame / substeps

[world]
gravity = [0.0, -9.81]     # m/s²
# drag = 0.1               # 1/s; brakes rigid motion too

[integrator]
kind = "symplectic_euler"

# How bodies touch one another and themselves; without this they pass through one another.
[contact]
friction = 0.3

# A ball: springs on its outline, gas inside.
[[body]]
name = "ball"
shape = { kind = "ring", radius = 0.5, vertices = 36, center = [0.0, 2.0] }
mass = 1.0                 # of the whole body; or density, or node_mass
velocity = [0.5, 0.0]
models = [
    { kind = "mass_spring", stiffness = 1600.0, damping = 4.0 },
    { kind = "pressure", nRT = 100.0 },
]
# pin = [ { select = { side = "top" }, axes = "xy" } ]
# copies = { count = [3, 2], spacing = [1.5, 1.5] }

# The floor.
[[collider]]
kind = "half_space"
point = [0.0, 0.0]
normal = [0.0, 1.0]
restitution = 0.5
friction = 0.3

# From 2 s to 3 s, a pointer pulls the ball.
[[command]]
do = "drag"
at = 2.0
until = 3.0
body = "ball"
node = "nearest"
path = [[2.0, 1.0, 1.0], [3.0, 2.0, 2.0]] # t, x, y

# Columns of diagnostics.csv.
[[probe]]
name = "top"
body = "ball"
select = { node = 0 }
record = ["position", "velocity"]
"#;
