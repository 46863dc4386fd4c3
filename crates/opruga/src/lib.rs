//! # Opruga
//!
//! Elastically deformable bodies in 2D and 3D: springs, gas, bending and more, stepped by any integrator, chosen by a
//! word in a scene file.
//!
//! ```
//! use opruga::{Options, World, blueprint::AnyBlueprint, catalogue, io::scene};
//!
//! let text = opruga::scenes::find("ball").unwrap();
//! let (blueprint, _) = scene::read(text.as_bytes(), "ball.toml", &catalogue(), &scene::Options::default()).unwrap();
//! let AnyBlueprint::Plane(blueprint) = blueprint else { unreachable!("the ball lives in the plane") };
//! let mut world = World::new(blueprint, Options::default())?;
//! for _ in 0..60 {
//!     world.frame()?; // one sixtieth of a second
//! }
//! let ball = world.body("ball").unwrap();
//! let top = world.position(ball, 9);
//! println!("t = {:.2} s: top at {:.3} m, {:.4} J", world.time(), top[1], world.energy().total());
//! # Ok::<(), opruga::WorldError>(())
//! ```

pub mod pictures;
pub mod scenes;

pub use opruga_collide as collide;
pub use opruga_core as core;
pub use opruga_draw as draw;
pub use opruga_io as io;
pub use opruga_math as math;
pub use opruga_math::Simd;
pub use opruga_mesh as mesh;
pub use opruga_world::shapes;
pub use opruga_world::{BodyHandle, Energy, Momentum, Options, Registry, Warning, World, WorldError, blueprint};

/// What scenes can name: the models, integrators and colliders of this library.
pub fn catalogue() -> io::Catalogue {
    let registry = Registry::<2>::default();
    let colliders = [collide::all(2), collide::all(3)].concat();
    io::Catalogue { models: registry.models(), integrators: registry.integrators(), colliders }
}
