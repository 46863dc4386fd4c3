//! Every test of this crate that does not need its own process, in one program that is linked once.

mod barrier;
mod common;
mod facets;
mod friction;
mod impact;
mod overlap;
mod same_bits;
mod seams;
mod shapes;
mod surfaces;
mod touching;
