//! Bodies at rest: positions and topology, with common code for the plane and for space.
//!
//! A [`Mesh`] contains rest positions and the elements between them: boundary facets, wires, sheets, filled cells, named node groups. A mesh is
//! created by a generator ([`Mesh::ring`], [`Mesh::polygon`], [`Mesh::grid`], [`Mesh::icosphere`], …), by hand or by an importer. Everything else in
//! this crate reads it:
//!
//! | question | answer |
//! |---|---|
//! | which edges have springs, in the order of memory access | [`Mesh::edges`], [`edge_runs`], [`Mesh::edge_areas`] |
//! | which nodes are neighbours of a node | [`node_neighbours`], [`Mesh::node_rings`] |
//! | which closed chambers hold gas | [`Mesh::chambers`], [`Mesh::components`], [`signed_volume`], [`Mesh::orient_outward`] |
//! | where a body bends | [`Mesh::hinges`], [`Mesh::bends`] |
//! | which length, area or volume belongs to each node | [`Mesh::lumped_measures`], [`Mesh::measure`] |
//! | whether a mesh is sound | [`Mesh::check`], [`Mesh::validate`], [`Mesh::cell_quality`], [`Mesh::cell_measures`] |
//! | what bounds the cells | [`Mesh::facets_from_cells`], [`Mesh::into_simplices`] |
//! | what fills a closed surface | [`Mesh::tetrahedra_filling`], [`Mesh::lattice_filling`] |
//! | cells of second order | [`Mesh::into_quadratic`] |
//!
//! Orientation: a plane outline runs counter-clockwise (interior to its left); the facets of a closed surface are counter-clockwise as seen from
//! outside. Both make [`signed_volume`] positive. Holes have the opposite orientation.
//!
//! Results have the same bits on every platform: sines come from `libm`, and all orders result from sorting.

// Units are in brackets, [m], which rustdoc interprets as links.
#![allow(rustdoc::broken_intra_doc_links)]

mod adjacency;
mod bending;
mod boundary;
mod boxes;
mod buckets;
mod cell_shares;
mod chambers;
mod check;
mod crossing_edges;
mod crossings;
mod edges;
mod error;
mod face;
mod geometry;
mod jacobian;
mod lattice;
mod lattice_bcc;
mod lattice_filling;
mod measure;
mod mesh;
mod nearest;
pub mod outline;
mod plane;
mod polygon;
mod quadratic;
mod quality;
mod remesh;
mod sides;
mod skin;
mod soup;
mod sphere;
mod stuffing;
mod surface;
mod touching_surface;
mod transform;

pub use adjacency::{Adjacency, node_neighbours};
pub use bending::{bends, hinges};
pub use boundary::Cut;
pub use chambers::{Component, winding_number};
pub use check::{Problem, SHORT_EDGE, THIN_ELEMENT};
pub use crossing_edges::crossing_edges;
pub use crossings::Crossings;
pub use edges::{EdgeRun, EdgeSet, bandwidth, edge_runs};
pub use error::{Element, MeshError, Must, Quantity};

/// All messages of this crate, for tests of translations.
#[doc(hidden)]
pub const MESSAGES: &[&[opruga_math::message::Variant]] = &[
    Element::VARIANTS,
    Quantity::VARIANTS,
    Must::VARIANTS,
    MeshError::VARIANTS,
    outline::MeetingOf::VARIANTS,
    outline::OutlineError::VARIANTS,
];

pub use face::{CutFace, FaceError, cut_face};
pub use geometry::signed_volume;
pub use jacobian::{LeastJacobian, jacobian_at, least_jacobian};
pub use measure::{Measure, Share};
pub use mesh::{Cells, MAXIMUM_NODES, Mesh, NodeValues};
pub use plane::LARGEST_ANGLE;
pub use polygon::Polygon;
pub use quadratic::{TETRAHEDRON_EDGES, TETRAHEDRON_SHARES, TRIANGLE_SHARES, TRIANGLE_SIDES, triangle_parts};
pub use quality::{CellMeasure, CellQuality};
pub use sides::{MOST_SIDE_NODES, SidePoint, side_points, side_tangents, side_vector};
pub use skin::{Area, Skin};
pub use soup::{Turned, weld};
pub use sphere::MAXIMUM_SUBDIVISIONS;
pub use stuffing::{LARGEST_DIHEDRAL_ANGLE, SMALLEST_DIHEDRAL_ANGLE};
pub use touching_surface::{Carrier, TouchingSurface};
