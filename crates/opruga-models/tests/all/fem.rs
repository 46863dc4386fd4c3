//! Finite elements: the conformance of every material on every element, one line each.

use crate::support::models::Fem;
use opruga_core::check::{Options, conformance};
use opruga_core::spec::Values;
use opruga_mesh::Mesh;
use opruga_models::materials::NAMES;

/// A grid whose inner nodes are moved by up to a tenth of a cell.
fn irregular<const D: usize>(cells: [u32; D]) -> Mesh<D> {
    let mut mesh = Mesh::grid([0.3; D], core::array::from_fn(|d| 0.4 * f64::from(cells[d])), cells).unwrap();
    let mut random = 3u64;
    for x in &mut mesh.positions {
        for c in x.iter_mut() {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            *c += 0.08 * ((random >> 11) as f64 / (1u64 << 53) as f64 - 0.5);
        }
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

/// Two kinds of parameters for the bodies of a batch.
fn parameters(material: &str) -> [Values; 2] {
    [
        values!(fem, material: material, youngs_modulus: 900.0, poissons_ratio: 0.4, damping: 0.02),
        values!(fem, material: material, youngs_modulus: 400.0, poissons_ratio: 0.3),
    ]
}

fn options(material: &str) -> Options {
    // A rotated body grows under the law of small rotation. A point at which all nodes coincide has no unique rotation.
    Options {
        rigid: material != "linear",
        states: 2,
        noise: 0.1,
        hessian_tolerance: 3e-7,
        gradient_tolerance: 1e-7,
        ..Options::default()
    }
}

#[test]
fn every_material_on_every_element_in_the_plane() {
    for material in NAMES {
        for (cells, mesh) in meshes([2, 2]) {
            let name = format!("{material}, {cells}");
            conformance(&name, &Fem, &parameters(material), &mesh, &options(material)).assert();
        }
    }
}

#[test]
fn every_material_on_every_element_in_plane_stress() {
    for material in NAMES {
        let values = [
            values!(fem, material: *material, youngs_modulus: 900.0, poissons_ratio: 0.4, plane: "stress"),
            values!(fem, material: *material, youngs_modulus: 400.0, poissons_ratio: 0.3, plane: "stress"),
        ];
        for (cells, mesh) in meshes([2, 1]) {
            let name = format!("{material} in plane stress, {cells}");
            let options = Options { coincident: false, noise: 0.05, ..options(material) };
            conformance(&name, &Fem, &values, &mesh, &options).assert();
        }
    }
}

#[test]
fn every_material_on_every_element_in_space() {
    for material in NAMES {
        for (cells, mesh) in meshes([2, 1, 1]) {
            let name = format!("{material}, {cells}");
            let options = Options { states: 1, ..options(material) };
            conformance(&name, &Fem, &parameters(material), &mesh, &options).assert();
        }
    }
}

/// Linear simplices whose nodes resist changes of volume. This couples more nodes than those of one cell.
#[test]
fn every_material_with_volumes_of_nodes() {
    for material in NAMES {
        let of = |ratio: f64, damping: f64| values!(fem, material: *material, youngs_modulus: 900.0, poissons_ratio: ratio, damping: damping, locking: "nodal_volume");
        let values = [of(0.48, 0.02), of(0.4, 0.0)];
        let options = Options { states: 1, noise: 0.05, ..options(material) };
        let plane = irregular([2, 2]).into_simplices().unwrap();
        conformance(&format!("{material}, triangles"), &Fem, &values, &plane, &options).assert();
        let space = irregular([2, 1, 1]).into_simplices().unwrap();
        conformance(&format!("{material}, tetrahedra"), &Fem, &values, &space, &options).assert();
    }
}

/// Inverted bodies: energies are finite and derivatives agree, and a clamped tangent has no negative eigenvalue there.
#[test]
fn bodies_turned_inside_out() {
    for material in NAMES {
        let options = Options { mirrored: true, states: 1, ..options(material) };
        // Where J is far below zero the barrier of the logarithm is steep: finite differences contain its fourth derivative.
        let options = Options { noise: 0.05, gradient_tolerance: 1e-6, hessian_tolerance: 1e-6, ..options };
        for (cells, mesh) in meshes([2, 1]) {
            conformance(&format!("{material}, {cells}"), &Fem, &parameters(material), &mesh, &options).assert();
        }
        for (cells, mesh) in meshes([1, 1, 1]) {
            conformance(&format!("{material}, {cells}"), &Fem, &parameters(material), &mesh, &options).assert();
        }
    }
}

/// Meshes of many tiles: bits and invariance, without finite differences.
#[test]
fn many_tiles() {
    let large = Options { states: 1, derivatives: false, noise: 0.05, ..Options::default() };
    let values = parameters("neo_hookean");
    let plate = Mesh::<2>::grid([0.0; 2], [1.0, 1.0], [25, 31]).unwrap();
    let block = Mesh::<3>::grid([0.0; 3], [1.0, 1.0, 1.0], [8, 9, 9]).unwrap();
    conformance("plate", &Fem, &values, &plate, &large).assert();
    conformance("plate", &Fem, &values, &plate.into_simplices().unwrap().into_quadratic().unwrap(), &large).assert();
    conformance("block", &Fem, &values, &block, &large).assert();
    conformance("block", &Fem, &values, &block.into_simplices().unwrap(), &large).assert();
}
