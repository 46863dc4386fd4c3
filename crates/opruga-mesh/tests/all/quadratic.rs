//! Cells of second order: numbering, measures, shares, boundaries, maps; groups and values of cells.

use opruga_mesh::{
    Cells, EdgeSet, Element, Mesh, MeshError, Problem, Share, TETRAHEDRON_EDGES, jacobian_at, least_jacobian,
    signed_volume,
};
use std::collections::BTreeMap;

#[track_caller]
fn close(computed: f64, expected: f64) {
    assert!((computed - expected).abs() <= 1e-12 * (1.0 + expected.abs()), "{computed} is not {expected}");
}

/// A box of 6·3·2·2 tetrahedra of second order.
fn solid() -> Mesh<3> {
    let grid = Mesh::grid([-1.0, 0.0, 2.0], [3.0, 1.0, 2.0], [3, 2, 2]).unwrap();
    grid.into_simplices().unwrap().into_quadratic().unwrap()
}

fn plate() -> Mesh<2> {
    let grid = Mesh::grid([-1.0, 0.0], [3.0, 1.0], [3, 2]).unwrap();
    grid.into_simplices().unwrap().into_quadratic().unwrap()
}

/// The ball of radius 1 as tetrahedra around its centre, with mid-edge nodes of the surface projected onto the sphere.
fn ball(subdivisions: u32, curved: bool) -> Mesh<3> {
    let mut mesh = Mesh::icosphere(1.0, subdivisions).unwrap();
    let center = mesh.nodes() as u32;
    mesh.positions.push([0.0; 3]);
    mesh.cells.tetrahedra = mesh.facets.iter().map(|&[a, b, c]| [center, a, b, c]).collect();
    let linear = mesh.nodes();
    let mut mesh = mesh.into_quadratic().unwrap();
    if curved {
        let outer: Vec<u32> = mesh.facets.iter().flatten().copied().filter(|n| *n as usize >= linear).collect();
        for node in outer {
            let p = mesh.positions[node as usize];
            let r = p.iter().map(|x| x * x).sum::<f64>().sqrt();
            mesh.positions[node as usize] = p.map(|x| x / r);
        }
    }
    mesh
}

#[test]
fn straight_quadratic_cells_measure_what_linear_ones_do() {
    let (solid, plate) = (solid(), plate());
    close(solid.measure().unwrap().value(), 6.0);
    close(plate.measure().unwrap().value(), 3.0);
    assert_eq!((solid.check(), plate.check()), (vec![], vec![]));
    assert_eq!(solid.cells.len(), 72);
    // Nodes at all corners and midpoints of edges of a lattice twice as fine, except those in the middle of cubes, which are only on edges of
    // tetrahedra.
    assert_eq!(plate.nodes(), 7 * 5);
    assert_eq!(solid.nodes(), 7 * 5 * 5);
}

#[test]
fn shares_of_quadratic_cells_are_positive_and_add_up() {
    for (shares, total) in [
        (solid().lumped_measures(Share::Proportional).unwrap(), 6.0),
        (plate().lumped_measures(Share::Proportional).unwrap(), 3.0),
        (solid().lumped_measures(Share::Equal).unwrap(), 6.0),
        (ball(1, true).lumped_measures(Share::Proportional).unwrap(), ball(1, true).measure().unwrap().value()),
    ] {
        assert!(shares.iter().all(|share| *share > 0.0));
        close(shares.iter().sum::<f64>(), total);
    }
    // One tetrahedron: the diagonal of its mass matrix, ∫(λ(2λ−1))² = 1/70 and ∫(4λμ)² = 8/105 of the volume, scaled by 35/18.
    let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 6.0]];
    let cells = Cells { tetrahedra: vec![[0, 1, 2, 3]], ..Cells::default() };
    let one = Mesh { positions, cells, ..Mesh::default() }.into_quadratic().unwrap();
    let shares = one.lumped_measures(Share::Proportional).unwrap();
    shares[..4].iter().for_each(|share| close(*share, 1.0 / 70.0 * 35.0 / 18.0));
    shares[4..].iter().for_each(|share| close(*share, 8.0 / 105.0 * 35.0 / 18.0));
}

#[test]
fn curved_cells_measure_what_their_curves_enclose() {
    // A side curved as a parabola of height h over base b adds 2/3·b·h.
    let positions = vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, -0.1], [0.5, 0.5], [0.0, 0.5]];
    let cells = Cells { quadratic_triangles: vec![[0, 1, 2, 3, 4, 5]], ..Cells::default() };
    let mesh = Mesh::<2> { positions, cells, ..Mesh::default() };
    close(mesh.measure().unwrap().value(), 0.5 + 2.0 / 3.0 * 0.1);
    // The volume of a ball of curved tetrahedra converges with the fourth power of the edge, that of straight ones with the second.
    let exact = 4.0 / 3.0 * std::f64::consts::PI;
    let error = |subdivisions, curved| (ball(subdivisions, curved).measure().unwrap().value() / exact - 1.0).abs();
    for (curved, order) in [(false, 2.0), (true, 4.0)] {
        let measured = (error(1, curved) / error(2, curved)).log2();
        assert!((measured - order).abs() < 0.25, "order {measured} instead of {order}");
    }
    assert!(error(2, true) < 2e-4 && ball(2, true).check().is_empty());
}

#[test]
fn the_boundary_runs_through_all_boundary_nodes() {
    let (solid, plate) = (solid(), plate());
    // Every face of the box has 2·2·(cells) quarters; every side has two edges.
    assert_eq!(solid.facets.len(), 4 * 2 * 2 * (6 + 6 + 4));
    assert_eq!(plate.facets.len(), 2 * 2 * (3 + 2));
    close(signed_volume(&solid.facets, &solid.positions), 6.0);
    close(signed_volume(&plate.facets, &plate.positions), 3.0);
    assert_eq!((solid.euler_characteristic(), plate.euler_characteristic()), (2, 0));
    assert_eq!((solid.chambers().unwrap().len(), plate.chambers().unwrap().len()), (1, 1));
    for (mesh_groups, nodes) in [(&solid.groups, 5 * 5), (&plate.groups, 5)] {
        assert_eq!(mesh_groups["left"].len(), nodes, "middles between nodes of a side belong to it");
        assert!(mesh_groups["left"].is_sorted());
    }
    // Edges of the four parts of every triangle: V − E + F = 1.
    let edges = plate.edges(EdgeSet::All).len() as i64;
    assert_eq!(plate.nodes() as i64 - edges + 4 * plate.cells.len() as i64, 1);
}

#[test]
fn quadratic_cells_stay_sound_when_they_are_mirrored() {
    let (mut solid, mut plate) = (solid(), plate());
    assert!(solid.mirror([1.0, 2.0, -1.0], [0.3, 0.0, 0.0]).unwrap());
    assert!(plate.mirror([1.0, 2.0], [0.3, 0.0]).unwrap());
    assert_eq!((solid.check(), plate.check()), (vec![], vec![]));
    close(solid.measure().unwrap().value(), 6.0);
    assert_eq!(sorted(solid.facets_from_cells().unwrap()), sorted(solid.facets.clone()));
    assert_eq!(sorted(plate.facets_from_cells().unwrap()), sorted(plate.facets.clone()));
}

/// Facets as sets, starting at their lowest node.
fn sorted<const D: usize>(mut facets: Vec<[u32; D]>) -> Vec<[u32; D]> {
    for facet in &mut facets {
        if D == 3 {
            let lowest = (0..D).min_by_key(|k| facet[*k]).unwrap();
            facet.rotate_left(lowest);
        }
    }
    facets.sort_unstable();
    facets
}

#[test]
fn a_cell_that_folds_over_at_a_node_is_inverted() {
    // If the mid-edge node is beyond three quarters of the edge, the Jacobian at the corner changes its sign, although the volume stays positive.
    let mut mesh = plate();
    let [a, b, _, middle, ..] = mesh.cells.quadratic_triangles[0];
    let (p, q) = (mesh.positions[a as usize], mesh.positions[b as usize]);
    mesh.positions[middle as usize] = std::array::from_fn(|d| p[d] + 0.8 * (q[d] - p[d]));
    let problems = mesh.check();
    assert!(
        matches!(problems[0], Problem::Inverted { element: Element::QuadraticTriangle, index: 0, measure } if measure < 0.0),
        "{problems:?}"
    );
}

#[test]
fn a_cell_that_folds_over_between_its_nodes_is_inverted() {
    // Pseudo-random numbers from −1 to 1, the same in every run.
    let mut state = 3_u64;
    let mut chance = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    let straight = {
        let mut out = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for [a, b] in TETRAHEDRON_EDGES {
            out.push(std::array::from_fn(|d| 0.5 * (out[a][d] + out[b][d])));
        }
        out
    };
    let at = |node: usize| -> [f64; 4] {
        std::array::from_fn(|corner| match node.checked_sub(4) {
            None => f64::from(u8::from(corner == node)),
            Some(edge) => 0.5 * f64::from(u8::from(TETRAHEDRON_EDGES[edge].contains(&corner))),
        })
    };
    let folded = (0..200_000).find_map(|_| {
        let nodes: Vec<[f64; 3]> = straight.iter().map(|x| x.map(|x| x + 0.18 * chance())).collect();
        let right = (0..10).all(|node| jacobian_at(&nodes, at(node)).is_some_and(|j| j > 0.0));
        (right && least_jacobian(&nodes).is_some_and(|least| least.is_inverted())).then_some(nodes)
    });
    let cells = Cells { quadratic_tetrahedra: vec![[0, 1, 2, 3, 4, 5, 6, 7, 8, 9]], ..Cells::default() };
    let mut mesh = Mesh::<3> { positions: folded.expect("such a cell"), cells, ..Mesh::default() };
    mesh.facets = mesh.facets_from_cells().unwrap();
    assert!(matches!(mesh.check()[..], [Problem::Inverted { .. }]), "{:?}", mesh.check());
    assert!(mesh.cell_measures()[0].least < 0.0);
    assert_eq!(mesh.cell_quality().unwrap().inverted, 1);
}

#[test]
fn groups_and_values_of_cells_follow_them() {
    let mut grid = Mesh::grid([0.0; 3], [2.0, 1.0, 1.0], [2, 1, 1]).unwrap();
    grid.cell_groups = BTreeMap::from([("hard".to_string(), vec![1])]);
    grid.cell_values = BTreeMap::from([("density".to_string(), vec![10.0, 20.0])]);
    let cut = grid.clone().into_simplices().unwrap().into_quadratic().unwrap();
    assert_eq!(cut.cell_groups["hard"], (6..12).collect::<Vec<u32>>());
    assert_eq!(cut.cell_values["density"], [[10.0; 6], [20.0; 6]].concat());
    // Only cells beyond x = 1 are hard.
    for cell in &cut.cell_groups["hard"] {
        let corners = &cut.cells.quadratic_tetrahedra[*cell as usize];
        assert!(corners.iter().all(|node| cut.positions[*node as usize][0] >= 1.0));
    }
    grid.cell_groups.insert("none".into(), vec![2]);
    assert_eq!(grid.validate(), Err(MeshError::CellOutOfRange { group: "none".into(), cell: 2, cells: 2 }));
    grid.cell_groups.clear();
    grid.cell_values.insert("few".into(), vec![1.0]);
    assert_eq!(grid.validate(), Err(MeshError::CellValues { name: "few".into(), values: 1, cells: 2 }));
}

#[test]
fn quadratic_cells_lend_their_middles_to_linear_neighbours() {
    let mut mesh = plate();
    let curved = mesh.cells.quadratic_triangles.clone();
    // The second half of the triangles becomes linear again; the nodes between them and the others are kept.
    let (kept, cut) = curved.split_at(6);
    mesh.cells.quadratic_triangles = kept.to_vec();
    mesh.cells.triangles = cut.iter().map(|cell| [cell[0], cell[1], cell[2]]).collect();
    mesh.cell_values.insert("number".into(), (0..12).map(f64::from).collect());
    mesh.facets = mesh.facets_from_cells().unwrap();
    mesh.drop_unreferenced();
    let again = mesh.into_quadratic().unwrap();
    assert_eq!((again.nodes(), again.cells.len()), (35, 12));
    assert_eq!(again.check(), vec![]);
    // The linear cells, numbered first, now come after the others.
    assert_eq!(again.cell_values["number"][..2], [6.0, 7.0]);
    let grid = Mesh::grid([0.0; 2], [1.0; 2], [1, 1]).unwrap();
    assert_eq!(grid.into_quadratic(), Err(MeshError::NotSimplices { element: Element::Quadrilateral }));
}
