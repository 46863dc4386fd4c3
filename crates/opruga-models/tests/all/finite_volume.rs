//! Finite volumes compared with linear finite elements, patches, and the properties that quadrilaterals and hexahedra do not
//! have.

use crate::support::models::{Fem, FiniteVolume};
use crate::support::{Part, energy, forces, hessian, refusal, system};
use opruga_core::check::Random;
use opruga_core::potential::Model;
use opruga_core::spec::Values;
use opruga_core::system::System;
use opruga_mesh::Mesh;
use opruga_models::materials::NAMES;

/// Cells that all have different shapes: the inner nodes of a grid are moved.
fn irregular<const D: usize>(counts: [u32; D]) -> Mesh<D> {
    let mut mesh = Mesh::<D>::grid([0.2; D], [1.0; D], counts).unwrap();
    let mut random = Random::new(7);
    for x in &mut mesh.positions {
        for d in 0..D {
            x[d] += 0.15 / f64::from(counts[d]) * random.signed();
        }
    }
    mesh
}
fn size(v: &[f64]) -> f64 {
    v.iter().fold(0.0, |most, x| if x.abs() > most { x.abs() } else { most })
}
fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    size(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<f64>>()) / size(a)
}
fn moved<const D: usize>(mut system: System<D>, mesh: &Mesh<D>, map: impl Fn(&[f64; D]) -> [f64; D]) -> System<D> {
    for (node, x) in mesh.positions.iter().enumerate() {
        system.state.x.set(node, map(x));
    }
    system
}
/// A stretch with a rotation, and a bend on top.
fn bent<const D: usize>(x: &[f64; D], bend: f64) -> [f64; D] {
    core::array::from_fn(|d| {
        let e = (d + 1) % D;
        (1.1 + 0.05 * d as f64) * x[d] + (0.2 - 0.3 * d as f64) * x[e] + bend * x[d] * x[e]
    })
}
fn body<const D: usize>(mesh: &Mesh<D>, model: &dyn Model<D>, values: Values, bend: f64) -> System<D> {
    let parts: [Part<D>; 1] = [(model, values)];
    moved(system(mesh, &parts), mesh, |x| bent(x, bend))
}

/// Two independent implementations: forces, energy and Hessian agree to 1e-12 of the largest.
#[test]
fn triangles_and_tetrahedra_are_linear_finite_elements() {
    let plane = irregular::<2>([4, 3]).into_simplices().unwrap();
    let space = irregular::<3>([3, 2, 2]).into_simplices().unwrap();
    for material in NAMES {
        for state in ["strain", "stress"] {
            let ours = values!(finite_volume, youngs_modulus: 700.0, material: *material, plane: state);
            let theirs = values!(fem, youngs_modulus: 700.0, material: *material, plane: state);
            same(&plane, &FiniteVolume, ours, &Fem, theirs);
        }
        let ours = values!(finite_volume, youngs_modulus: 700.0, material: *material);
        let theirs = values!(fem, youngs_modulus: 700.0, material: *material);
        same(&space, &FiniteVolume, ours, &Fem, theirs);
    }
}
fn same<const D: usize>(mesh: &Mesh<D>, volumes: &dyn Model<D>, ours: Values, elements: &dyn Model<D>, theirs: Values) {
    let mut one = body(mesh, volumes, ours, 0.2);
    let mut other = body(mesh, elements, theirs, 0.2);
    assert!(difference(&forces(&mut one), &forces(&mut other)) < 1e-12);
    let (a, b) = (energy(&mut one), energy(&mut other));
    assert!((a - b).abs() < 1e-12 * b, "{a} {b}");
    assert!(difference(&hessian(&mut one).entries, &hessian(&mut other).entries) < 1e-12);
}

/// Under a uniform F the inner nodes are in equilibrium, whatever the shape of the cells.
#[test]
fn patches_of_irregular_boxes_are_exact() {
    fn check<const D: usize>(mesh: &Mesh<D>, model: &dyn Model<D>) {
        for material in NAMES {
            let values = values!(finite_volume, youngs_modulus: 700.0, material: *material);
            let all = forces(&mut body(mesh, model, values, 0.0));
            let mut on_boundary = vec![false; mesh.positions.len()];
            mesh.facets_from_cells().unwrap().iter().flatten().for_each(|node| on_boundary[*node as usize] = true);
            let inside: Vec<f64> = (0..all.len()).filter(|k| !on_boundary[k / D]).map(|k| all[k]).collect();
            assert!(
                !inside.is_empty() && size(&inside) < 1e-12 * size(&all),
                "{material}: {:e}",
                size(&inside) / size(&all)
            );
        }
    }
    check(&irregular::<2>([4, 4]), &FiniteVolume);
    check(&irregular::<3>([3, 3, 3]), &FiniteVolume);
}

fn asymmetry<const D: usize>(system: &mut System<D>) -> f64 {
    let matrix = hessian(system);
    let n = matrix.size;
    let transposed: Vec<f64> = (0..n * n).map(|k| matrix.entries[k % n * n + k / n]).collect();
    difference(&matrix.entries, &transposed)
}

/// The tangent of boxes is symmetric for the linear law on parallelograms, and for no law if F differs between faces.
#[test]
fn the_tangent_of_boxes_is_not_symmetric() {
    let mut sheared = Mesh::<2>::grid([0.0; 2], [1.0, 0.8], [3, 2]).unwrap();
    sheared.positions.iter_mut().for_each(|x| x[0] += 0.3 * x[1]);
    let linear = values!(finite_volume, youngs_modulus: 700.0, material: "linear");
    assert!(asymmetry(&mut body(&sheared, &FiniteVolume, linear, 0.2)) < 1e-12);
    let rubber = values!(finite_volume, youngs_modulus: 700.0);
    let square = Mesh::<2>::grid([0.0; 2], [1.0, 0.8], [3, 2]).unwrap();
    let found = asymmetry(&mut body(&square, &FiniteVolume, rubber.clone(), 0.2));
    assert!(found > 1e-3 && found < 0.3, "{found}");
    let cube = Mesh::<3>::grid([0.0; 3], [1.0, 0.8, 0.9], [2, 1, 1]).unwrap();
    let found = asymmetry(&mut body(&cube, &FiniteVolume, rubber, 0.2));
    assert!(found > 1e-3 && found < 0.3, "{found}");
}

/// F(Qx + t) = Q F(x), and there is no net force, even if F differs between faces.
#[test]
fn forces_of_boxes_turn_with_the_body() {
    let mesh = irregular::<3>([2, 2, 2]);
    let values = values!(finite_volume, youngs_modulus: 700.0, material: "corotated");
    let turn = |x: &[f64; 3]| [0.6 * x[0] - 0.8 * x[1], 0.8 * x[0] + 0.6 * x[1], x[2]];
    let at_first = forces(&mut body(&mesh, &FiniteVolume, values.clone(), 0.3));
    let parts: [Part<3>; 1] = [(&FiniteVolume, values)];
    let turned = forces(&mut moved(system(&mesh, &parts), &mesh, |x| {
        let y = turn(&bent(x, 0.3));
        [y[0] + 3.0, y[1] - 2.0, y[2] + 1.0]
    }));
    let expected: Vec<f64> = at_first.chunks(3).flat_map(|f| turn(&[f[0], f[1], f[2]])).collect();
    assert!(difference(&expected, &turned) < 1e-11, "{}", difference(&expected, &turned));
    for d in 0..3 {
        let net: f64 = at_first.iter().skip(d).step_by(3).sum();
        assert!(net.abs() < 1e-12 * size(&at_first));
    }
}

#[test]
fn what_has_no_meaning_is_refused_with_what_is_allowed() {
    let boxes = Mesh::<2>::grid([0.0; 2], [1.0, 1.0], [2, 2]).unwrap();
    let triangles = boxes.clone().into_simplices().unwrap();
    let ring = Mesh::<2>::ring(1.0, 12, [0.0; 2], 0.0).unwrap();
    let of = |mesh: &Mesh<2>, ratio: f64| {
        refusal(mesh, &FiniteVolume, values!(finite_volume, youngs_modulus: 1.0, poissons_ratio: ratio))
    };
    assert!(of(&ring, 0.3).starts_with("model.no_cells"), "{}", of(&ring, 0.3));
    assert!(of(&triangles, 0.46).starts_with("model.locking"), "{}", of(&triangles, 0.46));
    assert_eq!(of(&boxes, 0.4999), "built");
    let quadratic = of(&triangles.clone().into_quadratic().unwrap(), 0.3);
    assert!(quadratic.starts_with("model.quadratic_cells") && quadratic.contains("`order = 1`"), "{quadratic}");
    let accepted = values!(finite_volume, youngs_modulus: 1.0, poissons_ratio: 0.46, locking: "accept");
    assert_eq!(refusal(&triangles, &FiniteVolume, accepted), "built");
    let mut folded = boxes.clone();
    folded.positions[4] = [2.0, 2.0];
    assert!(of(&folded, 0.3).starts_with("model.inverted_cell"), "{}", of(&folded, 0.3));
    let mooney = values!(finite_volume, material: "mooney_rivlin", youngs_modulus: 1.0, poissons_ratio: 0.1);
    assert!(refusal(&boxes, &FiniteVolume, mooney).contains("at most 0.125"));
}
