//! The surfaces with which bodies touch.

use opruga_mesh::{Mesh, TouchingSurface, signed_volume};

/// The volume that closed facets enclose [m³].
fn volume(surface: &TouchingSurface<3>, nodes: &[[f64; 3]]) -> f64 {
    signed_volume(&surface.facets[..surface.closed], &surface.positions(nodes))
}

#[test]
fn simplices_touch_with_their_boundary() {
    let mesh = Mesh::<3>::grid([0.0; 3], [1.0; 3], [2; 3]).expect("a cube").into_simplices().expect("tetrahedra");
    let surface = mesh.touching_surface(true);
    // All nodes except the one in the middle.
    assert_eq!((surface.nodes.len(), surface.carrying, surface.carried.len()), (26, 0, 0));
    assert_eq!((surface.facets.len(), surface.closed), (mesh.facets.len(), mesh.facets.len()));
    for (own, facet) in surface.facets.iter().zip(&mesh.facets) {
        assert_eq!(own.map(|p| surface.nodes[p as usize]), *facet);
    }
}

#[test]
fn faces_of_hexahedra_are_four_triangles() {
    let mesh = Mesh::<3>::grid([0.0; 3], [1.0; 3], [2; 3]).expect("a cube");
    let surface = mesh.touching_surface(true);
    assert_eq!((surface.nodes.len(), surface.carried.len(), surface.facets.len()), (26, 24, 96));
    assert!((volume(&surface, &mesh.positions) - 1.0).abs() < 1e-15);
    // The surface encloses the volume of the hexahedra, however they are bent; two triangles per face would enclose another
    // volume.
    let bent: Vec<[f64; 3]> =
        mesh.positions.iter().map(|[x, y, z]| [x + 0.1 * y * z, y + 0.2 * x * z, z - 0.1 * x * y]).collect();
    let twisted = Mesh { positions: bent, ..mesh.clone() };
    let whole = twisted.measure().expect("hexahedra").value();
    assert!((volume(&surface, &twisted.positions) / whole - 1.0).abs() < 1e-14);
    assert!((twisted.enclosed_volume() / whole - 1.0).abs() > 1e-4);
}

#[test]
fn what_is_filled_by_a_lattice_touches_with_its_skin() {
    let ball = Mesh::<3>::icosphere(0.5, 2).expect("a ball");
    let mesh = ball.lattice_filling(0.2).expect("a lattice");
    let skin = mesh.skin.as_ref().expect("a skin");
    let surface = mesh.touching_surface(true);
    assert_eq!((surface.carried.len(), surface.facets.len()), (skin.carriers.len(), skin.triangles.len()));
    assert_eq!(surface.carrying, surface.nodes.len());
    let moved: Vec<[f64; 3]> = mesh.positions.iter().map(|[x, y, z]| [x + 0.3 * y, *y, z * z]).collect();
    let points = surface.positions(&moved);
    for (triangle, facet) in skin.triangles.iter().zip(&surface.facets) {
        let drawn = skin.positions(&moved);
        for (p, q) in triangle.iter().zip(facet) {
            assert!((0..3).all(|d| (drawn[*p as usize][d] - points[*q as usize][d]).abs() < 1e-15));
        }
    }
    let cells = mesh.touching_surface(false);
    assert_eq!((cells.carried.len(), cells.facets.len()), (0, mesh.facets.len()));
}

#[test]
fn open_surfaces_wires_and_points_touch() {
    let sheet = Mesh::<3>::sheet([0.0; 3], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [2, 2]).expect("a sheet");
    let surface = sheet.touching_surface(true);
    assert_eq!((surface.facets.len(), surface.closed, surface.nodes.len()), (8, 0, 9));
    let wire = Mesh::<3> { positions: vec![[0.0; 3]; 3], wires: vec![[0, 2]], ..Mesh::default() };
    let surface = wire.touching_surface(true);
    assert_eq!((surface.nodes, surface.wires), (vec![0, 2], vec![[0, 1]]));
    let wire = Mesh::<2> { positions: vec![[0.0; 2]; 3], wires: vec![[0, 2]], ..Mesh::default() };
    assert_eq!(wire.touching_surface(true).facets, vec![[0, 1]]);
    let points = Mesh::<3> { positions: vec![[0.0; 3]; 3], ..Mesh::default() };
    assert_eq!(points.touching_surface(true).nodes, vec![0, 1, 2]);
}
