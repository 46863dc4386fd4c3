//! Every test of this crate that needs no process of its own, in one program: it is linked once.

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
