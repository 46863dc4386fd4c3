//! All tests of this crate that do not need their own process, in one program, so that it is linked only once.

mod carried_drawings;
mod faces;
mod generators;
mod outlines;
mod quadratic;
mod remeshing;
mod stuffing;
mod surfaces;
mod topology;
mod touching_surfaces;
