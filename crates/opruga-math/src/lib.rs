//! Numbers of Opruga: a formula is written once for one `f64` or eight, and gives the same bits with every set of vector
//! instructions.

pub mod calibration;
mod column;
pub mod elementary;
mod fetch;
pub mod lane;
#[cfg(target_arch = "x86_64")]
mod logarithm;
pub mod matrix;
pub mod message;
mod portable;
mod registers;
pub mod rotation;
pub mod simd;
pub mod singular;
pub mod strip;
pub mod symmetric;
mod team;
mod twin;
pub mod words;
#[cfg(target_arch = "x86_64")]
mod x86_64;

pub use column::Column;
pub use fetch::fetch_early;
pub use lane::{Lane, Pack, ROW, Register, WIDTH, sum_in_fixed_order};
pub use simd::{Simd, Work};
pub use strip::{RepeatStrip, Strip, StripMut};
pub use team::Team;
pub use twin::Twin;
