//! Closed-form counts, areas, volumes and Euler characteristics of every generator.

use std::f64::consts::PI;

use opruga_mesh::{Cut, EdgeSet, Measure, Mesh, MeshError, Quantity, Share, bandwidth, edge_runs, signed_volume};

/// Relative agreement.
#[track_caller]
fn close(computed: f64, expected: f64) {
    assert!((computed - expected).abs() <= 1e-12 * (1.0 + expected.abs()), "{computed} is not {expected}");
}

fn volume<const D: usize>(mesh: &Mesh<D>) -> f64 {
    signed_volume(&mesh.facets, &mesh.positions)
}

#[track_caller]
fn sound<const D: usize>(mesh: &Mesh<D>) {
    assert_eq!(mesh.check(), []);
    for share in [Share::Equal, Share::Proportional] {
        let sum: f64 = mesh.lumped_measures(share).unwrap().iter().sum();
        close(sum, mesh.measure().unwrap().value());
    }
}

#[test]
fn ring_is_a_regular_polygon_of_many_sides() {
    let (r, n) = (0.5, 36);
    let mesh = Mesh::ring(r, n, [3.0, 2.0], 0.25).unwrap();
    sound(&mesh);
    let a = PI / f64::from(n);
    close(volume(&mesh), 0.5 * f64::from(n) * r * r * libm::sin(2.0 * a));
    let Measure::Length(length) = mesh.measure().unwrap() else { panic!("an outline has a length") };
    close(length, 2.0 * f64::from(n) * r * libm::sin(a));
    assert_eq!(mesh.euler_characteristic(), 0);
    close(mesh.positions[0][0], 3.0 + r * libm::cos(0.25));
    assert_eq!(mesh.facets[0], [0, 1]);
    assert_eq!(mesh.facets[35], [35, 0]);

    // Two runs: the sides, and the edge that closes the ring.
    let edges = mesh.edges(EdgeSet::Boundary);
    let runs = edge_runs(&edges);
    assert_eq!(runs.len(), 2);
    assert_eq!((runs[0].first, runs[0].count), ([0, 1], 35));
    assert_eq!((runs[1].first, runs[1].count, runs[1].start), ([0, 35], 1, 35));
}

#[test]
fn regular_polygon_has_straight_sides() {
    let mesh = Mesh::regular_polygon(6, 2.0, 5, [0.0, 0.0], 0.0).unwrap();
    sound(&mesh);
    assert_eq!(mesh.nodes(), 30);
    close(volume(&mesh), 1.5 * 3.0_f64.sqrt() * 4.0);
    close(mesh.measure().unwrap().value(), 12.0);
}

#[test]
fn polygon_runs_counter_clockwise() {
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let with = Mesh::polygon(&square).unwrap();
    assert!(!with.flipped);
    let mut backward = square;
    backward.reverse();
    let against = Mesh::polygon(&backward).unwrap();
    assert!(against.flipped);
    assert_eq!(against.mesh.positions, backward);
    for mesh in [&with.mesh, &against.mesh] {
        sound(mesh);
        close(volume(mesh), 1.0);
    }
    // The first point may be repeated at the end.
    let mut closed = square.to_vec();
    closed.push(square[0]);
    assert_eq!(Mesh::polygon(&closed).unwrap(), with);
}

#[test]
fn polygon_that_meets_itself_is_refused() {
    let bow = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
    assert_eq!(Mesh::polygon(&bow).unwrap_err(), MeshError::SelfIntersection { first: [0, 1], second: [2, 3] });
    // A corner that touches a side, and a spike that folds back.
    let touch = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.0], [0.0, 2.0]];
    assert_eq!(Mesh::polygon(&touch).unwrap_err(), MeshError::SelfIntersection { first: [0, 1], second: [2, 3] });
    let spike = [[0.0, 0.0], [2.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    assert_eq!(Mesh::polygon(&spike).unwrap_err(), MeshError::SelfIntersection { first: [0, 1], second: [1, 2] });
    let repeat = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    assert_eq!(Mesh::polygon(&repeat).unwrap_err(), MeshError::RepeatedPoint { first: 1, second: 2 });
    assert!(matches!(Mesh::polygon(&bow[..2]), Err(MeshError::Count { least: 3, .. })));
    assert!(matches!(Mesh::polygon(&[[0.0, 0.0], [1.0, f64::NAN], [1.0, 1.0]]), Err(MeshError::Size { .. })));
}

#[test]
fn lines_are_wires() {
    let mesh = Mesh::line([0.0, 0.0, 0.0], [1.0, 2.0, 2.0], 6).unwrap();
    sound(&mesh);
    assert_eq!(mesh.nodes(), 7);
    close(mesh.measure().unwrap().value(), 3.0);
    assert_eq!(edge_runs(&mesh.edges(EdgeSet::All)).len(), 1);
    assert_eq!(mesh.bends().unwrap().len(), 5);
    assert!(mesh.edges(EdgeSet::Boundary).is_empty());
    let plane = Mesh::line([0.0, 0.0], [3.0, 4.0], 1).unwrap();
    close(plane.measure().unwrap().value(), 5.0);
    let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]];
    assert_eq!(Mesh::polyline(&points, false).unwrap().wires.len(), 2);
    let closed = Mesh::polyline(&points, true).unwrap();
    assert_eq!(closed.wires, [[0, 1], [1, 2], [2, 0]]);
    assert_eq!(closed.bends().unwrap(), [[2, 0, 1], [0, 1, 2], [1, 2, 0]]);
    assert!(Mesh::line([1.0, 1.0], [1.0, 1.0], 3).is_err());
    assert!(Mesh::line([0.0, 0.0], [1.0, 1.0], 0).is_err());
}

#[test]
fn plane_grid() {
    let (nx, ny) = (4, 3);
    let mesh = Mesh::grid([-1.0, 0.0], [2.0, 0.6], [nx, ny]).unwrap();
    sound(&mesh);
    assert_eq!(mesh.nodes(), 20);
    assert_eq!(mesh.cells.quadrilaterals.len(), 12);
    assert_eq!(mesh.facets.len(), 14);
    close(volume(&mesh), 1.2);
    assert_eq!(mesh.measure().unwrap(), Measure::Area(mesh.measure().unwrap().value()));
    close(mesh.measure().unwrap().value(), 1.2);
    assert_eq!(mesh.groups["left"], [0, 5, 10, 15]);
    assert_eq!(mesh.groups["right"], [4, 9, 14, 19]);
    assert_eq!(mesh.groups["bottom"], [0, 1, 2, 3, 4]);
    assert_eq!(mesh.groups["top"], [15, 16, 17, 18, 19]);

    // nx(ny+1) + ny(nx+1) sides, 2 nx ny diagonals.
    let all = mesh.edges(EdgeSet::All);
    assert_eq!(all.len(), 16 + 15);
    assert_eq!(mesh.edges(EdgeSet::AllWithShear).len(), 16 + 15 + 24);
    // One run per row of horizontal edges, one for all vertical edges.
    let runs = edge_runs(&all);
    assert_eq!(runs.len(), 5);
    assert_eq!((runs[4].first, runs[4].count), ([0, 5], 15));
}

#[test]
fn solid_grid() {
    let mesh = Mesh::grid([0.0; 3], [2.0, 3.0, 4.0], [2, 3, 4]).unwrap();
    sound(&mesh);
    assert_eq!(mesh.nodes(), 3 * 4 * 5);
    assert_eq!(mesh.cells.hexahedra.len(), 24);
    assert_eq!(mesh.facets.len(), 4 * (2 * 3 + 3 * 4 + 4 * 2));
    close(volume(&mesh), 24.0);
    close(mesh.measure().unwrap().value(), 24.0);
    assert_eq!(mesh.euler_characteristic(), 2);
    assert_eq!(
        mesh.groups.keys().map(String::as_str).collect::<Vec<_>>(),
        ["back", "bottom", "front", "left", "right", "top"]
    );
    assert!(mesh.groups["front"].iter().all(|&node| mesh.positions[node as usize][2] == 4.0));
    assert_eq!(mesh.groups["top"].len(), 3 * 5);
    // Lattice edges, then two diagonals for each of the lattice faces.
    assert_eq!(mesh.edges(EdgeSet::All).len(), 2 * 4 * 5 + 3 * 3 * 5 + 4 * 3 * 4);
    let faces = 2 * 3 * 5 + 3 * 4 * 3 + 4 * 2 * 4;
    assert_eq!(mesh.edges(EdgeSet::AllWithShear).len(), 133 + 2 * faces);
    // A corner belongs to one cell, an inner node to eight.
    let shares = mesh.lumped_measures(Share::Proportional).unwrap();
    close(shares[0], 0.125);
    close(shares[1 + 3 * (1 + 4)], 1.0);
}

#[test]
fn simplices_fill_the_same_body() {
    let plane = Mesh::grid([0.0; 2], [1.0, 1.0], [3, 2]).unwrap();
    let cut = plane.clone().into_simplices().unwrap();
    sound(&cut);
    assert_eq!((cut.cells.triangles.len(), cut.cells.quadrilaterals.len()), (12, 0));
    assert_eq!(cut.facets.len(), plane.facets.len());
    close(cut.measure().unwrap().value(), 1.0);
    let solid = Mesh::grid([0.0; 3], [1.0; 3], [2, 3, 2]).unwrap();
    let cut = solid.clone().into_simplices().unwrap();
    sound(&cut);
    assert_eq!(cut.cells.tetrahedra.len(), 6 * 12);
    assert_eq!(cut.facets.len(), solid.facets.len());
    close(cut.measure().unwrap().value(), 1.0);
    close(volume(&cut), 1.0);
}

#[test]
fn five_tetrahedra_a_box_alternate_and_fill_the_same_body() {
    let solid = Mesh::grid([0.0; 3], [1.0; 3], [2, 3, 2]).unwrap();
    let cut = solid.clone().into_simplices_by(Cut::Five).unwrap();
    sound(&cut);
    assert_eq!(cut.cells.tetrahedra.len(), 5 * 12);
    assert_eq!(cut.facets.len(), solid.facets.len());
    close(volume(&cut), 1.0);
    // One tetrahedron in five is inscribed, with a third of the volume of its box.
    let size = |cell: &[u32; 4]| {
        let [a, b, c, d] = cell.map(|node| cut.positions[node as usize]);
        let [u, v, w] = [b, c, d].map(|p| [p[0] - a[0], p[1] - a[1], p[2] - a[2]]);
        let normal = [v[1] * w[2] - v[2] * w[1], v[2] * w[0] - v[0] * w[2], v[0] * w[1] - v[1] * w[0]];
        (u[0] * normal[0] + u[1] * normal[1] + u[2] * normal[2]) / 6.0
    };
    let inscribed = cut.cells.tetrahedra.iter().filter(|cell| (size(cell) - 1.0 / 36.0).abs() < 1e-15).count();
    let corners = cut.cells.tetrahedra.iter().filter(|cell| (size(cell) - 1.0 / 72.0).abs() < 1e-15).count();
    assert_eq!((inscribed, corners), (12, 48));

    // Three boxes around an axis: a loop of three edges.
    let mut ring = Mesh::<3> { positions: vec![[0.0; 3]; 14], ..Mesh::default() };
    for k in 0..3u32 {
        let (near, far, next) = (1 + 2 * k, 2 + 2 * k, 1 + 2 * ((k + 1) % 3));
        ring.cells.hexahedra.push([0, near, far, next, 7, 7 + near, 7 + far, 7 + next]);
    }
    assert!(ring.clone().into_simplices_by(Cut::Five).is_ok(), "around an axis with spokes every loop is even");
    // A wedge that closes the ring has an edge that leads back to a node of the same parity.
    ring.cells.hexahedra.push([0, 2, 1, 4, 7, 9, 8, 11]);
    let refused = ring.into_simplices_by(Cut::Five).unwrap_err();
    assert!(matches!(refused, MeshError::OddLoop { .. }), "{refused}");
}

#[test]
fn sheet_is_open() {
    let mesh = Mesh::sheet([0.0, 1.0, 0.0], [[2.0, 0.0, 0.0], [0.0, 0.0, -3.0]], [4, 6]).unwrap();
    sound(&mesh);
    assert_eq!((mesh.nodes(), mesh.sheets.len()), (35, 48));
    close(mesh.measure().unwrap().value(), 6.0);
    assert_eq!(mesh.groups["left"].len(), 7);
    let sides = 4 * 7 + 6 * 5;
    assert_eq!(mesh.edges(EdgeSet::All).len(), sides + 24);
    assert_eq!(mesh.edges(EdgeSet::AllWithShear).len(), sides + 48);
    // Every edge that is not on the border is a hinge.
    assert_eq!(mesh.hinges().unwrap().len(), sides + 24 - 20);
    assert!(Mesh::sheet([0.0; 3], [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0]], [1, 1]).is_err());
}

#[test]
fn box_surface_is_closed() {
    for cells in [[1, 1, 1], [2, 3, 4], [5, 1, 2], [1, 4, 1]] {
        let mesh = Mesh::box_surface([-1.0, 0.0, 2.0], [1.0, 2.0, 0.5], cells).unwrap();
        sound(&mesh);
        let [x, y, z] = cells;
        assert_eq!(mesh.nodes() as u32, 2 * (x * y + y * z + z * x) + 2);
        assert_eq!(mesh.facets.len() as u32, 4 * (x * y + y * z + z * x));
        assert_eq!(mesh.euler_characteristic(), 2);
        close(volume(&mesh), 1.0);
        close(mesh.measure().unwrap().value(), 2.0 * (2.0 + 1.0 + 0.5));
        assert_eq!(mesh.groups["bottom"].len() as u32, (x + 1) * (z + 1));
    }
}

#[test]
fn icosphere_counts_rings_and_order() {
    for (s, nodes) in [12, 42, 162, 642, 2562, 10242, 40962].into_iter().enumerate() {
        let mesh = Mesh::icosphere(2.0, s as u32).unwrap();
        assert_eq!((mesh.nodes(), mesh.facets.len()), (nodes, 2 * nodes - 4));
        assert_eq!(mesh.euler_characteristic(), 2);
        assert!(mesh.positions.iter().all(|p| (p[0] * p[0] + p[1] * p[1] + p[2] * p[2] - 4.0).abs() < 1e-14 * 4.0));

        // Rows from pole to pole: neighbours are near, and the belt gives long runs.
        let edges = mesh.edges(EdgeSet::All);
        assert_eq!(edges.len(), 3 * nodes - 6);
        assert!(bandwidth(&edges) <= 10 << s, "{} at {s}", bandwidth(&edges));
        let mean = edges.iter().map(|edge| f64::from(edge[1] - edge[0])).sum::<f64>() / edges.len() as f64;
        assert!(mean < f64::from(4 << s) + 2.0, "mean distance {mean} at {s}");
        assert!(edge_runs(&edges).len() <= 80 << s, "{} runs at {s}", edge_runs(&edges).len());

        let rings = mesh.node_rings().unwrap();
        let count = |size| (0..nodes).filter(|&node| rings.of(node as u32).len() == size).count();
        assert_eq!((count(5), count(6)), (12, nodes - 12));
        if s < 5 {
            sound(&mesh);
        }
    }
    // The icosahedron in closed form, and second-order convergence to the ball.
    let edge = 1.0 / libm::sin(2.0 * PI / 5.0);
    close(volume(&Mesh::icosphere(1.0, 0).unwrap()), 5.0 / 12.0 * (3.0 + 5.0_f64.sqrt()) * edge * edge * edge);
    let error = |s| 4.0 / 3.0 * PI - volume(&Mesh::icosphere(1.0, s).unwrap());
    let ratio = error(4) / error(5);
    assert!((3.9..4.1).contains(&ratio), "{ratio}");
    assert!(matches!(Mesh::icosphere(1.0, 8), Err(MeshError::Count { most: 7, .. })));
}

#[test]
fn torus_has_a_hole() {
    let mesh = Mesh::torus(1.0, 0.25, [96, 48]).unwrap();
    sound(&mesh);
    assert_eq!((mesh.nodes(), mesh.facets.len()), (96 * 48, 2 * 96 * 48));
    assert_eq!(mesh.euler_characteristic(), 0);
    let expected = 2.0 * PI * PI * 0.0625;
    assert!((volume(&mesh) / expected - 1.0).abs() < 0.01 && volume(&mesh) < expected);
    let rings = mesh.node_rings().unwrap();
    assert!((0..mesh.nodes()).all(|node| rings.of(node as u32).len() == 6));
    assert!(Mesh::torus(1.0, 1.0, [8, 8]).is_err());
    assert!(Mesh::torus(1.0, 0.5, [2, 8]).is_err());
}

#[test]
fn impossible_numbers_are_refused() {
    assert!(matches!(Mesh::ring(1.0, 2, [0.0; 2], 0.0), Err(MeshError::Count { value: 2, least: 3, .. })));
    assert!(matches!(Mesh::ring(1.0, u32::MAX, [0.0; 2], 0.0), Err(MeshError::Count { .. })));
    for radius in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(Mesh::ring(radius, 8, [0.0; 2], 0.0), Err(MeshError::Size { .. })));
        assert!(Mesh::icosphere(radius, 1).is_err());
        assert!(Mesh::grid([0.0; 2], [radius, 1.0], [1, 1]).is_err());
    }
    assert!(Mesh::ring(1.0, 8, [0.0, f64::NAN], 0.0).is_err());
    // An angle so large that all nodes would be at one point.
    for angle in [1e20, -1e20, f64::NAN] {
        assert!(matches!(Mesh::ring(1.0, 8, [0.0; 2], angle), Err(MeshError::Size { what: Quantity::StartAngle, .. })));
        assert!(Mesh::regular_polygon(5, 1.0, 2, [0.0; 2], angle).is_err());
    }
    assert!(Mesh::ring(1.0, 8, [0.0; 2], -1e6).is_ok());
    assert!(matches!(Mesh::grid([0.0; 3], [1.0; 3], [1 << 20; 3]), Err(MeshError::TooManyNodes { .. })));
    assert!(matches!(Mesh::grid([0.0; 2], [1.0; 2], [0, 1]), Err(MeshError::Count { .. })));
    assert!(Mesh::box_surface([0.0; 3], [1.0; 3], [1 << 25; 3]).is_err());
    assert!(Mesh::regular_polygon(1 << 20, 1.0, 1 << 20, [0.0; 2], 0.0).is_err());
}
