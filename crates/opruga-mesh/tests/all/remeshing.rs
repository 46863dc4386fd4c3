//! Surfaces with edges of a given length: closed, outward, near the original surface, with good triangles.
#![allow(clippy::disallowed_methods, reason = "what tests expect needs no equal bits")]

use opruga_mesh::{EdgeSet, Mesh};

/// The smallest angle of all triangles [°].
fn smallest_angle(mesh: &Mesh<3>) -> f64 {
    let mut smallest = 180.0f64;
    for facet in &mesh.facets {
        for k in 0..3 {
            let at = |j: usize| mesh.positions[facet[(k + j) % 3] as usize];
            let [o, a, b] = [at(0), at(1), at(2)];
            let (u, v) = ([0, 1, 2].map(|d| a[d] - o[d]), [0, 1, 2].map(|d| b[d] - o[d]));
            let dot = |u: [f64; 3], v: [f64; 3]| u.iter().zip(&v).map(|(x, y)| x * y).sum::<f64>();
            smallest = smallest.min((dot(u, v) / (dot(u, u) * dot(v, v)).sqrt()).acos().to_degrees());
        }
    }
    smallest
}

/// The fraction of edges with a length between two fractions of the target length.
fn part_between(mesh: &Mesh<3>, length: f64, low: f64, high: f64) -> f64 {
    let edges = mesh.edges(EdgeSet::Boundary);
    let fits = |[a, b]: &&[u32; 2]| {
        let (p, q) = (mesh.positions[*a as usize], mesh.positions[*b as usize]);
        let far = (0..3).map(|d| (p[d] - q[d]) * (p[d] - q[d])).sum::<f64>().sqrt();
        low * length <= far && far <= high * length
    };
    edges.iter().filter(fits).count() as f64 / edges.len() as f64
}

fn spot() -> Mesh<3> {
    let text = include_str!("../../../../scenes/shapes/spot.obj");
    let mut mesh = Mesh::<3>::default();
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words.as_slice() {
            ["v", rest @ ..] => mesh.positions.push([0, 1, 2].map(|d| rest[d].parse().expect("a number"))),
            ["f", rest @ ..] => {
                let corner =
                    |k: usize| rest[k].split('/').next().expect("a word").parse::<u32>().expect("a number") - 1;
                mesh.facets.push([corner(0), corner(1), corner(2)]);
            }
            _ => {}
        }
    }
    mesh
}

#[test]
fn remeshed_surfaces_are_closed_outward_and_of_good_triangles() {
    let ball = Mesh::icosphere(1.0, 3).expect("a ball");
    let torus = Mesh::torus(1.0, 0.4, [60, 24]).expect("a torus");
    let cube = Mesh::box_surface([0.0; 3], [1.0, 2.0, 1.0], [2, 2, 2]).expect("a box");
    // Creases of Spot are finer than these lengths, so triangles beside them are thin.
    for (name, mesh, lengths, drift, sharpest) in [
        ("ball", ball, [0.3, 0.08], 0.05, 25.0),
        ("torus", torus, [0.2, 0.1], 0.05, 25.0),
        ("box", cube, [0.4, 0.1], 1e-9, 25.0),
        ("spot", spot(), [0.06, 0.03], 0.06, 2.0),
    ] {
        for length in lengths {
            let made = mesh.remeshed(length).expect("closed");
            let volume = made.enclosed_volume() / mesh.enclosed_volume();
            let (angle, fits) = (smallest_angle(&made), part_between(&made, length, 0.6, 1.45));
            println!(
                "{name}, {length}: {} nodes (about {}), volume {volume:.4}, angle {angle:.1}, edges {fits:.3}",
                made.nodes(),
                mesh.remesh_estimate(length)
            );
            assert_eq!(made.check(), [], "{name}, {length}");
            assert_eq!(made.euler_characteristic(), mesh.euler_characteristic(), "{name}, {length}");
            assert_eq!(made.components().expect("closed").len(), 1, "{name}, {length}");
            assert!(made.crossing_facets().pairs.is_empty(), "{name}, {length}");
            assert!((volume - 1.0).abs() < drift, "{name}, {length}: {volume}");
            assert!(angle > sharpest && fits > 0.85, "{name}, {length}: {angle}, {fits}");
            let estimate = mesh.remesh_estimate(length) / made.nodes() as f64;
            assert!((0.5..2.0).contains(&estimate), "{name}, {length}: {estimate}");
            assert_eq!(mesh.remeshed(length), Ok(made), "the same bits");
        }
    }
}

#[test]
fn groups_stay_where_they_are_and_bad_lengths_are_refused() {
    let mut cube = Mesh::box_surface([0.0; 3], [1.0; 3], [3, 3, 3]).expect("a box");
    let made = cube.remeshed(0.15).expect("a box");
    for (name, nodes) in &cube.groups {
        let (axis, value) = match name.as_str() {
            "left" => (0, 0.0),
            "right" => (0, 1.0),
            _ => continue,
        };
        assert!(made.groups[name].len() > nodes.len());
        assert!(made.groups[name].iter().all(|n| made.positions[*n as usize][axis] == value), "{name}");
    }
    for bad in [0.0, -1.0, f64::NAN, 1e-9] {
        assert!(cube.remeshed(bad).is_err(), "{bad}");
    }
    cube.facets.pop();
    assert!(cube.remeshed(0.2).is_err(), "it is open");
}

/// Spot, 1.5 m in size: its horns and ears are finer than the longer edges, its legs than the longest.
#[test]
fn coarse_triangles_do_not_let_a_fine_surface_cross_itself() {
    let mut spot = spot();
    let (low, high) = spot.bounds();
    let extent = (0..3).map(|d| high[d] - low[d]).fold(0.0, f64::max);
    spot.positions.iter_mut().flatten().for_each(|x| *x *= 1.5 / extent);
    for (length, drift) in [(0.03, 0.01), (0.045, 0.02), (0.05, 0.02), (0.1, 0.07), (0.3, 0.5)] {
        let made = spot.remeshed(length).expect("closed");
        let volume = made.enclosed_volume() / spot.enclosed_volume();
        println!("{length}: {} nodes, volume {volume:.4}, {:.3}", made.nodes(), part_between(&made, length, 0.6, 1.45));
        assert_eq!(made.check(), [], "{length}");
        assert_eq!(made.euler_characteristic(), 2, "{length}");
        assert_eq!(made.components().expect("closed").len(), 1, "{length}");
        assert_eq!(made.crossing_facets().pairs, Vec::<[u32; 2]>::new(), "{length}");
        assert!((volume - 1.0).abs() < drift, "{length}: {volume}");
    }
}
