//! # Opruga
//!
//! Elastically deformable bodies in 2D and 3D: springs, gas, bending and more, stepped by any integrator that the scene file names.
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

use opruga_core::spec::Spec;

pub use opruga_collide as collide;
pub use opruga_core as core;
pub use opruga_draw as draw;
pub use opruga_io as io;
pub use opruga_math as math;
pub use opruga_math::Simd;
pub use opruga_mesh as mesh;
pub use opruga_words as words;
pub use opruga_world as world;
pub use opruga_world::shapes;
pub use opruga_world::{
    AnyBody, AnyScene, AnyWorld, BodyHandle, BodyView, BreakOff, Energy, Input, Momentum, Options, Registries,
    Registry, Warning, World, WorldError, blueprint,
};

/// The models, integrators and colliders of this library, which scenes can name.
pub fn catalogue() -> io::Catalogue {
    catalogue_of(&Registries::default())
}

/// Everything that scenes can name in a program with its own models or integrators: first the kinds for the plane, then the kinds that exist only in
/// space.
pub fn catalogue_of(registries: &Registries) -> io::Catalogue {
    let both = |plane: Vec<&'static Spec>, space: Vec<&'static Spec>| {
        let same = |a: &Spec, b: &Spec| (a.kind, a.dimensions) == (b.kind, b.dimensions);
        let further = space.into_iter().filter(|spec| !plane.iter().any(|known| same(known, spec)));
        plane.iter().copied().chain(further).collect()
    };
    let Registries { plane, space } = registries;
    io::Catalogue {
        models: both(plane.models(), space.models()),
        integrators: both(plane.integrators(), space.integrators()),
        colliders: [collide::all(2), collide::all(3)].concat(),
    }
}

/// The program in docs/library.md, for the tests.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/library.md")]
struct Library;

/// The program in README.md, if there is one, for the tests.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
