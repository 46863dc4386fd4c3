//! Every test of this crate that needs no process of its own, in one program: it is linked once.

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
