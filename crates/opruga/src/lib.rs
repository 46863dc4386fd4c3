//! placeholder
pub use opruga_collide as collide;
pub use opruga_core as core;
pub use opruga_math as math;
pub use opruga_math::Simd;
pub use opruga_mesh as mesh;
pub use opruga_world::{BodyHandle, Energy, Momentum, Options, Registry, Warning, World, WorldError, blueprint};
