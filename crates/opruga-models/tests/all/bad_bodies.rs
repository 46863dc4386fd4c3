//! Rows 26, 27, 31, 35, 37, 39, 47 and 59 of the list of bad inputs for finite volumes, finite differences and shape matching,
//! and row 47 for boundary elements: meaningless bodies and parameters are refused; unusual bodies have finite forces, and none
//! at rest.

use crate::support::models::{
    BoundaryElement as Boundary, FiniteDifference as Difference, FiniteVolume as Volume, ShapeMatching as Matching,
};
use crate::support::{energy, forces, refusal, system};
use opruga_core::check::{Options, conformance};
use opruga_core::potential::Model;
use opruga_core::spec::{Spec, Value, Values};
use opruga_mesh::Mesh;

fn size(v: &[f64]) -> f64 {
    v.iter().fold(0.0, |most, x| if x.abs() > most { x.abs() } else { most })
}
fn begins(found: &str, code: &str) {
    assert!(found.starts_with(code), "{found}");
}
fn volume() -> Values {
    values!(finite_volume, youngs_modulus: 1e5)
}
fn solid() -> Values {
    values!(finite_difference, youngs_modulus: 1e5)
}
fn thin() -> Values {
    values!(finite_difference, youngs_modulus: 1e5, thickness: 0.02)
}
fn matching() -> Values {
    values!(shape_matching, stiffness: 1e3, fit_share: 0.5)
}

/// Checks that there is no force at rest, and a finite force with an energy of the expected sign when nodes are moved; forces are
/// relative to the given scale [N].
fn sound<const D: usize>(name: &str, mesh: &Mesh<D>, model: &dyn Model<D>, values: &Values, strength: f64) {
    let mut body = system(mesh, &[(model, values.clone())]);
    let found = size(&forces(&mut body));
    assert!(found <= 1e-9 * strength, "{name}: {found} N at rest");
    for (node, x) in mesh.positions.iter().enumerate() {
        body.state.x.set(node, core::array::from_fn(|d| x[d] * (1.0 + 0.05 * ((node * 7 + d * 5) % 11) as f64)));
    }
    let (found, energy) = (forces(&mut body), energy(&mut body));
    assert!(found.iter().all(|f| f.is_finite()), "{name}");
    assert!(energy.is_finite() && energy >= -1e-12 * strength, "{name}: {energy} J");
}

/// Row 47: ν = 0.5, −1 and beyond are refused; 0.4999 is accepted.
#[test]
fn ratios_of_no_meaning_are_refused() {
    let specs: [&'static Spec; 3] = [
        &opruga_models::finite_volume::SPEC,
        &opruga_models::finite_difference::SPEC,
        &opruga_models::boundary_element::SPEC,
    ];
    for spec in specs {
        let with = |ratio: f64| {
            let mut values = Values::defaults(spec, 3);
            values.set(spec, "poissons_ratio", Value::Number(ratio), 3).is_ok()
        };
        for ratio in [0.5, -1.0, 0.6, -1.5, f64::NAN, f64::INFINITY] {
            assert!(!with(ratio), "{} takes ν = {ratio}", spec.kind);
        }
        for ratio in [0.4999, -0.99, 0.0] {
            assert!(with(ratio), "{} does not take ν = {ratio}", spec.kind);
        }
    }
    let boxes = Mesh::<3>::grid([0.0; 3], [1.0, 0.8, 0.6], [2, 2, 2]).unwrap();
    let tetrahedra = boxes.clone().into_simplices().unwrap();
    let strength = 1e5 / (1.0 - 2.0 * 0.4999);
    let of = values!(finite_volume, youngs_modulus: 1e5, poissons_ratio: 0.4999, material: "neo_hookean");
    begins(&refusal(&tetrahedra, &Volume, of.clone()), "model.locking");
    // Boxes have no energy.
    let mut body = system(&boxes, &[(&Volume, of)]);
    assert!(size(&forces(&mut body)) <= 1e-9 * strength);
    let of = values!(finite_difference, youngs_modulus: 1e5, poissons_ratio: 0.4999);
    sound("differences", &boxes, &Difference, &of, strength);
    let surface = Mesh::<3>::box_surface([0.0; 3], [1.0, 0.8, 0.6], [2, 2, 2]).unwrap();
    let of = values!(boundary_element, youngs_modulus: 1e5, poissons_ratio: 0.4999);
    sound("boundary", &surface, &Boundary, &of, strength);
}

/// Row 26: cells without volume are refused; thin ones have forces.
#[test]
fn slivers_are_refused_where_they_have_no_volume() {
    let tetrahedron = |height: f64| {
        let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.3, 0.3, height]];
        let mut mesh = Mesh::<3> { positions, ..Mesh::default() };
        mesh.cells.tetrahedra = vec![[0, 1, 2, 3]];
        mesh.facets = mesh.facets_from_cells().unwrap();
        mesh
    };
    begins(&refusal(&tetrahedron(1e-13), &Volume, volume()), "model.inverted_cell");
    begins(&refusal(&tetrahedron(0.0), &Volume, volume()), "model.inverted_cell");
    sound("a sliver", &tetrahedron(1e-4), &Volume, &volume(), 1e9);
    let grid = |size: [f64; 2]| Mesh::<2>::grid([0.0; 2], size, [3, 2]).unwrap();
    sound("a thin grid", &grid([1.0, 1e-4]), &Difference, &solid(), 1e9);
    for height in [1e-4, 1e-13, 0.0] {
        sound("a thin cluster", &tetrahedron(height), &Matching, &matching(), 1e3);
    }
    let regions = values!(shape_matching, stiffness: 1e3, fit_share: 0.5, region: 0.5);
    sound("thin clusters", &grid([1.0, 1e-7]), &Matching, &regions, 1e3);
}

/// Row 27: finite volumes refuse inverted cells; metric tensors and clusters do not distinguish a shape from its mirror image.
#[test]
fn cells_that_are_inside_out() {
    let mut grid = Mesh::<2>::grid([0.0; 2], [1.0, 1.0], [2, 2]).unwrap();
    let mut triangles = grid.clone().into_simplices().unwrap();
    grid.cells.quadrilaterals.iter_mut().for_each(|cell| cell.swap(1, 3));
    triangles.cells.triangles[1].swap(0, 1);
    begins(&refusal(&grid, &Volume, volume()), "model.inverted_cell");
    begins(&refusal(&triangles, &Volume, volume()), "model.inverted_cell");
    sound("differences", &grid, &Difference, &solid(), 1e5);
    sound("a cluster", &triangles, &Matching, &matching(), 1e3);
}

/// Rows 31 and 35: grids with a hole are grids; three surfaces at one edge are not.
#[test]
fn holes_and_branches_of_grids() {
    let once = Options { states: 1, ..Options::default() };
    let mut plate = Mesh::<2>::grid([0.0; 2], [1.0, 1.0], [4, 4]).unwrap();
    plate.cells.quadrilaterals.remove(5);
    plate.facets = plate.facets_from_cells().unwrap();
    conformance("plate with a hole", &Difference, &[solid()], &plate, &once).assert();
    conformance("plate with a hole", &Matching, &[matching()], &plate, &once).assert();
    sound("plate with a hole", &plate, &Difference, &solid(), 1e5);
    let mut block = Mesh::<3>::grid([0.0; 3], [1.0; 3], [3, 3, 3]).unwrap();
    block.cells.hexahedra.remove(13);
    block.facets = block.facets_from_cells().unwrap();
    sound("block with a cavity", &block, &Difference, &solid(), 1e5);
    let mut body = system(&block, &[(&Volume, volume())]);
    assert!(size(&forces(&mut body)) < 1e-9);

    let mut sheet = Mesh::sheet([0.0; 3], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [4, 4]).unwrap();
    let hole = sheet.sheet_quadrilaterals.remove(5);
    sheet.sheets.retain(|triangle| !triangle.iter().all(|node| hole.contains(node)));
    conformance("sheet with a hole", &Difference, &[thin()], &sheet, &once).assert();
    // A sheet with a missing triangle is not a grid, and neither is one with a third cell at an edge.
    let mut torn = Mesh::sheet([0.0; 3], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [4, 4]).unwrap();
    torn.sheets.pop();
    begins(&refusal(&torn, &Difference, thin()), "model.not_a_grid");
    let mut winged = Mesh::sheet([0.0; 3], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [2, 1]).unwrap();
    let first = winged.positions.len() as u32;
    winged.positions.extend([[0.5, 0.0, 0.5], [0.5, 1.0, 0.5]]);
    winged.sheets.extend([[1, first, first + 1], [1, first + 1, 4]]);
    winged.sheet_quadrilaterals.push([1, first, first + 1, 4]);
    begins(&refusal(&winged, &Difference, thin()), "model.not_a_grid");
}

/// Rows 37, 39 and 59: bodies of one and two nodes, flat ones, and nodes that all coincide.
#[test]
fn bodies_of_few_nodes_and_of_no_extent() {
    let one = Mesh::<3> { positions: vec![[1.0, 2.0, 3.0]], ..Mesh::default() };
    begins(&refusal(&one, &Volume, volume()), "model.no_cells");
    begins(&refusal(&one, &Difference, thin()), "model.not_a_grid");
    begins(
        &refusal(&Mesh::<2> { positions: vec![[1.0, 2.0]], ..Mesh::default() }, &Difference, thin()),
        "model.not_a_grid",
    );
    let two = Mesh::<3>::line([0.0; 3], [1.0, 0.0, 0.0], 1).unwrap();
    begins(&refusal(&two, &Volume, volume()), "model.no_cells");
    sound("two nodes", &two, &Difference, &thin(), 1e5);
    let mut coincident = two.clone();
    coincident.positions[1] = coincident.positions[0];
    begins(&refusal(&coincident, &Difference, thin()), "model.zero_length");

    let mut flat = Mesh::<3>::grid([0.0; 3], [1.0; 3], [2, 2, 2]).unwrap();
    flat.positions.iter_mut().for_each(|x| x[2] = 0.0);
    begins(&refusal(&flat, &Volume, volume()), "model.inverted_cell");
    begins(&refusal(&flat, &Difference, solid()), "model.not_rectangular");
    let mut point = flat.clone();
    point.positions.iter_mut().for_each(|x| *x = [0.5, 0.25, 0.125]);
    for fit in ["linear", "quadratic"] {
        for region in [None, Some(0.6)] {
            let mut values = values!(shape_matching, stiffness: 1e3, fit_share: 0.5, fit: fit);
            if let Some(region) = region {
                values = values!(shape_matching, stiffness: 1e3, fit_share: 0.5, fit: fit, region: region);
            }
            for (name, mesh) in [("one node", &one), ("two nodes", &two), ("flat", &flat), ("a point", &point)] {
                sound(name, mesh, &Matching, &values, 1e3);
            }
        }
    }
}

/// Clusters of one node each: nothing is matched, and there is no force.
#[test]
fn clusters_of_one_node_have_no_force() {
    let line = Mesh::<2>::line([0.0; 2], [1.0, 0.0], 8).unwrap();
    let values = values!(shape_matching, stiffness: 1e3, fit_share: 0.5, region: 0.1);
    let mut body = system(&line, &[(&Matching, values)]);
    for (node, x) in line.positions.iter().enumerate() {
        body.state.x.set(node, [2.0 * x[0], 0.3 * (node % 3) as f64]);
    }
    assert!(size(&forces(&mut body)) < 1e-12);
}
