//! # Opruga
//!
//! Elastically deformable bodies in 2D and 3D: springs, gas, bending and more, stepped by any integrator, chosen by a
//! word in a scene file.
//!
//! ```
//! use opruga::{Options, catalogue, io::scene};
//!
//! fn main() -> Result<(), Box<dyn std::error::Error>> {
//!     let text = opruga::scenes::find("ball").ok_or("there is no such scene")?;
//!     let (blueprint, _) = scene::read(text.as_bytes(), "ball.toml", &catalogue(), &scene::Options::default())
//!         .map_err(|errors| errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))?;
//!     let mut world = blueprint.build(Options::default())?;
//!     for _ in 0..60 {
//!         world.frame()?; // one sixtieth of a second
//!     }
//!     let ball = world.body("ball").ok_or("there is no ball")?;
//!     let top = world.positions(ball).at(9);
//!     println!("t = {:.2} s: top at {:.3} m, {:.4} J", world.time(), top[1], world.energy().total());
//!     Ok(())
//! }
//! ```

pub mod extend;
pub mod pictures;
pub mod recordings;
pub mod scenes;
pub mod sweep;

pub use opruga_collide as collide;
pub use opruga_core as core;
pub use opruga_draw as draw;
pub use opruga_io as io;
pub use opruga_math as math;
pub use opruga_math::Simd;
pub use opruga_mesh as mesh;
pub use opruga_world as world;
pub use opruga_world::shapes;
pub use opruga_world::{
    AnyBody, AnyScene, AnyWorld, BodyHandle, BodyView, BreakOff, Energy, Input, Momentum, Options, Registry, Warning,
    World, WorldError, blueprint,
};

/// What scenes can name: the models, integrators and colliders of this library.
pub fn catalogue() -> io::Catalogue {
    let registry = Registry::<2>::default();
    let colliders = [collide::all(2), collide::all(3)].concat();
    io::Catalogue { models: registry.models(), integrators: registry.integrators(), colliders }
}

/// The program of docs/library.md, for the tests.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/library.md")]
struct Library;

/// README.md may get a program too.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
