//! Numbers of Opruga: one formula over `f64` or eight of them, the same bits with every set of vector instructions.

mod column;
pub mod elementary;
pub mod lane;
mod portable;
mod registers;
pub mod simd;
pub mod strip;
#[cfg(target_arch = "x86_64")]
mod x86_64;

pub use column::Column;
pub use lane::{Lane, Pack, Register, WIDTH, sum_in_fixed_order};
pub use simd::{Simd, Work};
pub use strip::{RepeatStrip, Strip, StripMut};
