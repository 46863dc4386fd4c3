//! Logarithm and exponential with the same bits on every machine.
//!
//! The functions use `libm`, a translation of musl's C code to Rust without platform calls.

/// Natural logarithm of `x`.
#[inline]
pub fn natural_logarithm(x: f64) -> f64 {
    libm::log(x)
}

/// Exponential function of `x`.
#[inline]
pub fn exponential(x: f64) -> f64 {
    libm::exp(x)
}
