//! Thermal expansion: the conformance of every law on every cell, warmer than at rest.

use crate::support::models::Fem;
use opruga_core::check::{Options, conformance};
use opruga_core::spec::Values;
use opruga_mesh::Mesh;
use opruga_models::materials::NAMES;

/// A grid whose nodes are moved by up to a tenth of a cell.
fn irregular<const D: usize>(cells: [u32; D]) -> Mesh<D> {
    let mut mesh = Mesh::grid([0.3; D], core::array::from_fn(|d| 0.4 * f64::from(cells[d])), cells).unwrap();
    let mut random = 7u64;
    for c in mesh.positions.as_flattened_mut() {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        *c += 0.08 * ((random >> 11) as f64 / (1u64 << 53) as f64 - 0.5);
    }
    mesh
}

/// Linear boxes, linear simplices, quadratic simplices.
fn meshes<const D: usize>(cells: [u32; D]) -> [(&'static str, Mesh<D>); 3] {
    let boxes = irregular(cells);
    let simplices = boxes.clone().into_simplices().unwrap();
    let quadratic = simplices.clone().into_quadratic().unwrap();
    [("boxes", boxes), ("simplices", simplices), ("quadratic", quadratic)]
}

/// Warm, cold and at the reference temperature: bodies side by side differ only in parameters, and each has the same bits as
/// alone.
fn parameters(material: &str, plane: &str) -> [Values; 3] {
    let of = |temperature: f64, damping: f64| {
        values!(fem, material: material, youngs_modulus: 900.0, poissons_ratio: 0.4, damping: damping, plane: plane,
                thermal_expansion: 1e-3, temperature: temperature, reference_temperature: 300.0)
    };
    [of(400.0, 0.02), of(220.0, 0.0), of(300.0, 0.0)]
}

fn options(material: &str) -> Options {
    Options {
        rigid: material != "linear",
        states: 1,
        noise: 0.05,
        hessian_tolerance: 3e-7,
        gradient_tolerance: 1e-7,
        ..Options::default()
    }
}

#[test]
fn every_material_on_every_cell_of_the_plane_under_heat() {
    for material in NAMES {
        for plane in ["strain", "stress"] {
            for (cells, mesh) in meshes([2, 2]) {
                let name = format!("{material} in plane {plane}, {cells}");
                let options = Options { coincident: plane == "strain", ..options(material) };
                conformance(&name, &Fem, &parameters(material, plane), &mesh, &options).assert();
            }
        }
    }
}

#[test]
fn every_material_on_every_cell_of_space_under_heat() {
    for material in NAMES {
        for (cells, mesh) in meshes([2, 1, 1]) {
            let values = parameters(material, "strain");
            conformance(&format!("{material}, {cells}"), &Fem, &values, &mesh, &options(material)).assert();
        }
    }
}
