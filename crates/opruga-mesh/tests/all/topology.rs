//! Chambers, rings, hinges, edge areas, transforms, and the list of problems.

use opruga_mesh::{
    EdgeSet, Element, Mesh, MeshError, Problem, bends, edge_runs, hinges, node_neighbours, signed_volume,
};

#[track_caller]
fn close(computed: f64, expected: f64) {
    assert!((computed - expected).abs() <= 1e-12 * (1.0 + expected.abs()), "{computed} is not {expected}");
}

/// Both meshes in one; the facets of the second are reversed if `hole`.
fn joined<const D: usize>(mut first: Mesh<D>, second: Mesh<D>, hole: bool) -> Mesh<D> {
    let shift = first.nodes() as u32;
    first.positions.extend(second.positions);
    for mut facet in second.facets {
        if hole {
            facet.swap(0, 1);
        }
        first.facets.push(facet.map(|node| node + shift));
    }
    first
}

/// A band of n quadrilaterals, with or without a half twist.
fn band(n: u32, twist: bool) -> Mesh<3> {
    let mut mesh = Mesh::<3>::default();
    for i in 0..n {
        let a = 2.0 * std::f64::consts::PI * f64::from(i) / f64::from(n);
        let half = if twist { 0.5 * a } else { 0.0 };
        for side in [-0.3, 0.3] {
            let r = 1.0 + side * libm::sin(half);
            mesh.positions.push([r * libm::cos(a), r * libm::sin(a), side * libm::cos(half)]);
        }
        let (p, q) = (2 * i, 2 * i + 1);
        let (r, s) = match (i + 1 == n, twist) {
            (false, _) => (p + 2, p + 3),
            (true, false) => (0, 1),
            (true, true) => (1, 0),
        };
        mesh.facets.extend([[p, r, q], [r, s, q]]);
    }
    mesh
}

#[test]
fn a_hole_belongs_to_the_chamber_around_it() {
    let ring = |radius, x| Mesh::ring(radius, 24, [x, 0.0], 0.0).unwrap();
    let mesh = joined(joined(ring(2.0, 0.0), ring(1.0, 0.2), true), ring(0.5, 9.0), false);
    let components = mesh.components().unwrap();
    assert_eq!(components.len(), 3);
    assert!(
        components[0].signed_volume > 0.0 && components[1].signed_volume < 0.0 && components[2].signed_volume > 0.0
    );
    let chambers = mesh.chambers().unwrap();
    assert_eq!(chambers, [(0..48).collect::<Vec<u32>>(), (48..72).collect()]);
    close(
        signed_volume(&mesh.facets, &mesh.positions),
        12.0 * libm::sin(std::f64::consts::PI / 12.0) * (4.0 - 1.0 + 0.25),
    );

    // In space, and a hole inside the smaller of two nested skins.
    let sphere = |radius, s| Mesh::icosphere(radius, s).unwrap();
    let mesh = joined(joined(sphere(3.0, 2), sphere(2.0, 1), false), sphere(1.0, 0), true);
    assert_eq!(mesh.chambers().unwrap(), [(0..320).collect::<Vec<u32>>(), (320..420).collect()]);

    // A hole without an enclosing component.
    let mesh = joined(sphere(1.0, 0), Mesh::<3>::default(), false);
    let mut inside_out = mesh.clone();
    inside_out.facets.iter_mut().for_each(|facet| facet.swap(0, 1));
    assert!(matches!(inside_out.chambers(), Err(MeshError::InsideOut { facet: 0, .. })));
    assert_eq!(inside_out.orient_outward().unwrap(), 20);
    assert_eq!(inside_out.chambers().unwrap().len(), 1);
    assert_eq!(inside_out.orient_outward().unwrap(), 0);
}

#[test]
fn facets_against_their_neighbours_are_named_and_turned() {
    let mut mesh = Mesh::icosphere(1.0, 1).unwrap();
    let sound = mesh.clone();
    mesh.facets[7].swap(0, 1);
    mesh.facets[30].swap(0, 1);
    assert_eq!(mesh.chambers().unwrap_err(), MeshError::InconsistentOrientation { count: 2, first: 7 });
    assert!(mesh.node_rings().is_err());
    assert_eq!(mesh.orient_outward().unwrap(), 2);
    assert_eq!(mesh, sound);
    let mut ring = Mesh::ring(1.0, 5, [0.0; 2], 0.0).unwrap();
    ring.facets[2].swap(0, 1);
    assert_eq!(ring.chambers().unwrap_err(), MeshError::InconsistentOrientation { count: 1, first: 2 });
    assert_eq!(ring.orient_outward().unwrap(), 1);
}

#[test]
fn open_and_one_sided_surfaces_are_refused() {
    assert!(matches!(band(9, true).chambers(), Err(MeshError::NonOrientable { .. })));
    assert_eq!(band(9, false).chambers().unwrap_err(), MeshError::Open { loops: 2, nodes: vec![0, 1] });
    assert!(band(9, false).orient_outward().is_err());
    let mut sphere = Mesh::icosphere(1.0, 2).unwrap();
    sphere.facets.remove(200);
    sphere.facets.remove(3);
    let Err(MeshError::Open { loops: 2, nodes }) = sphere.chambers() else { panic!("two triangles are missing") };
    assert_eq!(nodes.len(), 2);
    let mut ring = Mesh::ring(1.0, 8, [0.0; 2], 0.0).unwrap();
    ring.facets.remove(5);
    ring.facets.remove(2);
    assert_eq!(ring.chambers().unwrap_err(), MeshError::Open { loops: 2, nodes: vec![2, 3] });
    // Even a Möbius band has hinges.
    assert_eq!(hinges(&band(9, true).facets).unwrap().len(), 18);
}

#[test]
fn surfaces_that_are_no_manifolds_are_refused() {
    let tetrahedron = |d: u32| [[0, 2, 1], [0, 1, d], [1, 2, d], [0, d, 2]];
    let mut mesh = Mesh::<3> {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.2, 0.2, 2.0]],
        facets: tetrahedron(3).to_vec(),
        ..Mesh::default()
    };
    assert_eq!(mesh.check(), [Problem::UnreferencedNodes { nodes: vec![4] }]);
    mesh.facets.extend(tetrahedron(4));
    let edges = vec![[0, 1], [0, 2], [1, 2]];
    assert_eq!(mesh.chambers().unwrap_err(), MeshError::NonManifoldEdges { edges: edges.clone() });
    assert_eq!(mesh.hinges().unwrap_err(), MeshError::NonManifoldEdges { edges });
    assert!(mesh.check().contains(&Problem::DuplicateFacet { first: 0, second: 4 }));

    // Two tetrahedra at one node: two chambers, but no ring at the node.
    let one = Mesh::<3> { positions: mesh.positions[..4].to_vec(), facets: tetrahedron(3).to_vec(), ..Mesh::default() };
    let mut two = joined(one.clone(), one, false);
    two.facets.iter_mut().flatten().filter(|node| **node == 4).for_each(|node| *node = 0);
    two.positions[5..].iter_mut().for_each(|point| *point = point.map(|x| -x));
    two.facets[4..].iter_mut().for_each(|facet| facet.swap(0, 1));
    assert_eq!(two.chambers().unwrap().len(), 2);
    assert_eq!(two.node_rings().unwrap_err(), MeshError::NonManifoldNodes { nodes: vec![0] });

    // An outline that passes through one node twice.
    let eight = Mesh::<2> {
        positions: vec![[0.0; 2], [1.0, 0.0], [1.0, 1.0], [-1.0, 0.0], [-1.0, -1.0]],
        facets: vec![[0, 1], [1, 2], [2, 0], [0, 3], [3, 4], [4, 0]],
        ..Mesh::default()
    };
    assert_eq!(eight.chambers().unwrap_err(), MeshError::NonManifoldNodes { nodes: vec![0] });
}

#[test]
fn rings_run_counter_clockwise_from_outside() {
    let mesh = Mesh::icosphere(1.0, 2).unwrap();
    let rings = mesh.node_rings().unwrap();
    let neighbours = node_neighbours(&mesh.edges(EdgeSet::All), mesh.nodes()).unwrap();
    assert_eq!(rings.nodes(), mesh.nodes());
    for node in 0..mesh.nodes() as u32 {
        let ring = rings.of(node);
        let mut sorted = ring.to_vec();
        sorted.sort_unstable();
        assert_eq!(sorted, neighbours.of(node));
        assert_eq!(ring[0], sorted[0]);
        for (place, &b) in ring.iter().enumerate() {
            let mut facet = [node, b, ring[(place + 1) % ring.len()]];
            let lowest = (0..3).min_by_key(|&corner| facet[corner]).unwrap();
            facet.rotate_left(lowest);
            assert!(
                mesh.facets.iter().any(|&[p, q, r]| facet == [p, q, r] || facet == [q, r, p] || facet == [r, p, q])
            );
        }
    }
    assert!(rings.of(9999).is_empty());
    assert!(node_neighbours(&[[0, 3]], 3).is_err());
}

#[test]
fn hinges_and_bends() {
    assert_eq!(hinges(&[[0, 1, 2], [1, 0, 3]]).unwrap(), [[0, 1, 2, 3]]);
    assert_eq!(hinges(&[[1, 0, 3], [0, 1, 2]]).unwrap(), [[1, 0, 3, 2]]);
    assert_eq!(bends(&[[0, 1], [1, 2], [2, 3]]), [[0, 1, 2], [1, 2, 3]]);
    // A branching node has no triple.
    assert_eq!(bends(&[[0, 1], [1, 2], [1, 3]]), [[0_u32; 3]; 0]);
    let sphere = Mesh::icosphere(1.0, 1).unwrap();
    assert_eq!(sphere.hinges().unwrap().len(), 120);
    // Bending of clockwise points still follows the facets.
    let turned = Mesh::polygon(&[[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]]).unwrap();
    assert_eq!(turned.mesh.bends().unwrap(), [[1, 0, 2], [2, 1, 0], [0, 2, 1]]);
}

#[test]
fn areas_beside_edges() {
    // Two equilateral triangles of side 1: the shared edge has both, the others one.
    let h = 0.75_f64.sqrt();
    let mesh = Mesh::<3> {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.5, h, 0.0], [1.5, h, 0.0]],
        sheets: vec![[0, 1, 2], [1, 3, 2]],
        ..Mesh::default()
    };
    let edges = mesh.edges(EdgeSet::All);
    for (edge, area) in edges.iter().zip(mesh.edge_areas(&edges).unwrap()) {
        close(area, if *edge == [1, 2] { 0.5 * h * 2.0 } else { 0.5 * h });
    }
    // A closed surface counts each triangle at three edges.
    let sphere = Mesh::icosphere(1.0, 3).unwrap();
    let edges = sphere.edges(EdgeSet::All);
    close(sphere.edge_areas(&edges).unwrap().iter().sum(), 3.0 * sphere.measure().unwrap().value());

    // Cells 0.5 × 1: sides A/2 from each cell, both diagonals A/2.
    let grid = Mesh::grid([0.0; 2], [1.0, 1.0], [2, 1]).unwrap();
    let edges = grid.edges(EdgeSet::AllWithShear);
    for (edge, area) in edges.iter().zip(grid.edge_areas(&edges).unwrap()) {
        close(area, if *edge == [1, 4] { 0.5 } else { 0.25 });
    }
    // A sheet with the diagonals of its triangulation counts whole triangles; with both diagonals it counts the mean.
    let sheet = Mesh::sheet([0.0; 3], [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0]], [2, 2]).unwrap();
    let own = sheet.edges(EdgeSet::All);
    let areas = sheet.edge_areas(&own).unwrap();
    close(areas[own.iter().position(|&edge| edge == [1, 3]).unwrap()], 1.0);
    close(areas.iter().sum(), 12.0);
    let shear = sheet.edges(EdgeSet::AllWithShear);
    close(sheet.edge_areas(&shear).unwrap()[shear.iter().position(|&edge| edge == [1, 3]).unwrap()], 0.5);
}

#[test]
fn edges_form_runs_in_ascending_distance() {
    let mesh = Mesh::torus(1.0, 0.3, [16, 8]).unwrap();
    let edges = mesh.edges(EdgeSet::All);
    assert_eq!(edges.len(), 3 * 128);
    assert!(edges.iter().all(|edge| edge[0] < edge[1]));
    assert!(edges.windows(2).all(|pair| (pair[0][1] - pair[0][0], pair[0][0]) < (pair[1][1] - pair[1][0], pair[1][0])));
    let runs = edge_runs(&edges);
    assert_eq!(runs.iter().map(|run| run.count as usize).sum::<usize>(), edges.len());
    for run in runs {
        for k in 0..run.count {
            assert_eq!(edges[(run.start + k) as usize], [run.first[0] + k, run.first[1] + k]);
        }
    }
    let sheet = Mesh::sheet([0.0; 3], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [30, 30]).unwrap();
    let longest = edge_runs(&sheet.edges(EdgeSet::AllWithShear)).iter().map(|run| run.count).max();
    assert_eq!(longest, Some(30 * 31));
}

#[test]
fn transforms_keep_orientation() {
    let mut plane = Mesh::grid([0.0; 2], [2.0, 1.0], [4, 2]).unwrap();
    plane.translate([1.0, -1.0]);
    plane.rotate(0.7, [3.0, 3.0]).unwrap();
    assert!(!plane.scale([2.0, 0.5], [0.0; 2]).unwrap());
    assert!(plane.scale([-1.0, 1.0], [0.0; 2]).unwrap());
    assert!(plane.mirror([1.0, 2.0], [0.0; 2]).unwrap());
    assert_eq!(plane.check(), []);
    close(signed_volume(&plane.facets, &plane.positions), 2.0);

    for mut mesh in [
        Mesh::grid([0.0; 3], [1.0, 2.0, 3.0], [2, 2, 2]).unwrap(),
        Mesh::box_surface([0.0; 3], [1.0, 2.0, 3.0], [2, 1, 3]).unwrap(),
    ] {
        mesh.rotate([1.0, 1.0, 1.0], 2.0 * std::f64::consts::PI / 3.0, [0.0; 3]).unwrap();
        // A third of a turn about the diagonal maps x to y to z.
        let far = mesh
            .positions
            .iter()
            .fold([0.0; 3], |far: [f64; 3], p| std::array::from_fn(|k| if p[k] > far[k] { p[k] } else { far[k] }));
        close(far[0], 3.0);
        close(far[1], 1.0);
        assert!(mesh.mirror([0.0, 3.0, 4.0], [1.0; 3]).unwrap());
        assert_eq!(mesh.check(), []);
        close(signed_volume(&mesh.facets, &mesh.positions), 6.0);
        let simplices = mesh.into_simplices().unwrap();
        assert_eq!(simplices.check(), []);
    }
    let mut sheet = Mesh::sheet([0.0; 3], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [3, 2]).unwrap();
    assert!(sheet.mirror([0.0, 0.0, 1.0], [0.0; 3]).unwrap());
    assert_eq!(sheet.check(), []);
    assert!(sheet.scale([1.0, 0.0, 1.0], [0.0; 3]).is_err());
    assert!(sheet.rotate([0.0; 3], 1.0, [0.0; 3]).is_err());
    assert!(sheet.mirror([f64::NAN, 0.0, 0.0], [0.0; 3]).is_err());
}

#[test]
fn problems_are_listed() {
    let good = Mesh::ring(1.0, 6, [0.0; 2], 0.0).unwrap();
    let mut mesh = good.clone();
    mesh.positions[2] = [f64::NAN, 0.0];
    mesh.positions[4] = [0.0, f64::INFINITY];
    assert_eq!(mesh.check(), [Problem::NotFinite { node: 2 }, Problem::NotFinite { node: 4 }]);

    mesh = good.clone();
    mesh.facets[3] = [3, 6];
    let error = MeshError::IndexOutOfRange { element: Element::Facet, index: 3, node: 6, nodes: 6 };
    assert_eq!(mesh.check(), [Problem::Topology(error.clone())]);
    assert_eq!(error.to_string(), "facet 3 names node 6, but there are 6 nodes, numbered from 0");
    mesh.facets[3] = [3, 3];
    assert!(matches!(mesh.validate(), Err(MeshError::RepeatedNode { .. })));
    mesh = good.clone();
    mesh.sheets.push([0, 1, 2]);
    assert!(matches!(mesh.validate(), Err(MeshError::WrongDimension { .. })));
    mesh = good.clone();
    mesh.groups.insert("far".to_owned(), vec![7]);
    assert!(mesh.validate().is_err());
    mesh = good.clone();
    mesh.positions[1] = mesh.positions[0];
    assert_eq!(mesh.check(), [Problem::Degenerate { element: Element::Facet, index: 0, measure: 0.0 }]);

    // A line in the plane, a plane in space.
    mesh = good.clone();
    mesh.positions.iter_mut().for_each(|point| point[1] = 2.0 * point[0] + 1.0);
    assert!(mesh.check().contains(&Problem::Flat { dimension: 1 }));
    let mut solid = Mesh::icosphere(1.0, 0).unwrap();
    solid.positions.iter_mut().for_each(|point| point[2] = 0.5 * point[0] - point[1]);
    assert!(solid.check().contains(&Problem::Flat { dimension: 2 }));

    let mut grid = Mesh::grid([0.0; 2], [1.0; 2], [1, 1]).unwrap();
    grid.cells.quadrilaterals[0].reverse();
    assert!(grid.check().contains(&Problem::Inverted { element: Element::Quadrilateral, index: 0, measure: -1.0 }));
    let mut sheet = Mesh::sheet([0.0; 3], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [2, 1]).unwrap();
    sheet.sheets.swap(0, 2);
    assert_eq!(sheet.validate(), Err(MeshError::SheetPairing { index: 0 }));
    let mut mixed = Mesh::grid([0.0; 2], [1.0; 2], [1, 1]).unwrap();
    mixed.wires.push([0, 2]);
    assert!(matches!(mixed.measure(), Err(MeshError::MixedMeasures { .. })));
    assert_eq!(Mesh::<3>::default().check(), []);
}

/// Boxes whose corners a file numbers with different rotations are nevertheless cut into tetrahedra that fit together: every inner face has a
/// counterpart, and the volume is that of the boxes.
#[test]
fn boxes_that_are_turned_among_each_other_are_cut_into_tetrahedra_that_fit() {
    let mut mesh = Mesh::<3>::grid([0.0; 3], [3.0, 2.0, 2.0], [3, 2, 2]).unwrap();
    // Quarter turns about the third axis of a box, and about its first.
    let turns = [[1, 2, 3, 0, 5, 6, 7, 4], [3, 2, 6, 7, 0, 1, 5, 4]];
    for (k, cell) in mesh.cells.hexahedra.iter_mut().enumerate() {
        for _ in 0..k % 4 {
            *cell = turns[k % 2].map(|corner| cell[corner]);
        }
    }
    let cut = mesh.clone().into_simplices().unwrap();
    assert_eq!(cut.cells.tetrahedra.len(), 6 * 12);
    // Each square of the boundary is two triangles, and there are no cracks.
    assert_eq!(cut.facets.len(), 2 * 32);
    let mut volume = 0.0;
    for tetrahedron in &cut.cells.tetrahedra {
        let [a, b, c, d] = tetrahedron.map(|node| cut.positions[node as usize]);
        let [p, q, r]: [[f64; 3]; 3] = [b, c, d].map(|x| std::array::from_fn(|k| x[k] - a[k]));
        let part =
            (0..3).map(|k| p[k] * (q[(k + 1) % 3] * r[(k + 2) % 3] - q[(k + 2) % 3] * r[(k + 1) % 3])).sum::<f64>()
                / 6.0;
        assert!(part > 0.1, "{tetrahedron:?}: {part}");
        volume += part;
    }
    close(volume, 12.0);
}
