//! Bad parameters and bad states, from the text of a scene to its frames. The numbers are rows of the torture list: 43–58 parameters, 61–78 states
//! and contact. (Rows that need shape matching or contact between bodies are tested with those; those of finite elements are next to theirs, such as
//! `robust_steps` and `falling_solids`.)

use crate::common;
mod contact;
mod ledger;
mod methods;
mod parameters;
mod state;
mod world;

use common::*;
use opruga::math::message::Message as _;
use opruga::{Options, World};

/// A ring above a floor; `more` follows its fields.
fn ring(substeps: u32, models: &str, more: &str) -> String {
    format!(
        "{}[[body]]\nname = \"b\"\nmass = 1\nshape = {{ kind = \"ring\", radius = 0.5, vertices = 24, center = [0, 0.6] }}\n\
         models = [{models}]\n{more}\n",
        head(1.0 / 60.0, substeps, -9.81, "symplectic_euler")
    )
}

const BALL: &str = "{ kind = \"mass_spring\", stiffness = 600.0, damping = 1.0 }, { kind = \"pressure\", nRT = 30.0 }";
const FLOOR: &str =
    "[[collider]]\nkind = \"half_space\"\npoint = [0, 0]\nnormal = [0, 1]\nfriction = 0.5\nrestitution = 0.2\n";

fn said(text: &str) -> String {
    match read(text) {
        Ok(_) => match World::new(plane(text), Options::default()) {
            Ok(_) => "nothing".into(),
            Err(error) => format!("{}: {}", error.code(), error.in_full()),
        },
        Err(errors) => errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"),
    }
}

fn finite(world: &World<2>) -> bool {
    world.bodies().all(|b| {
        (0..world.node_count(b) as u32)
            .all(|n| world.position(b, n).iter().chain(&world.velocity(b, n)).all(|x| x.is_finite()))
    })
}
