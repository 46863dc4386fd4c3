//! All tests of this crate that do not need a process of their own, in one program, so that it is linked once.

mod common;
mod crossing_drawings;
mod drawings;
mod error_texts;
mod files;
mod framed_drawings;
mod fuzz;
mod lifetimes;
mod malformed_meshes;
mod maps;
mod mesh_files;
mod mesh_round_trips;
mod node_values;
mod odd_surfaces;
mod recordings;
mod rounded_coordinates;
mod scenes;
mod shape_fuzz;
mod surface_bodies;
mod surfaces;
mod told_drawings;
mod torture;
mod unbounded_files;
