//! Triangles as files contain them: welding, orientation, closing, fillings.
#![allow(clippy::disallowed_methods, reason = "what tests expect needs no equal bits")]

use opruga_mesh::{Mesh, MeshError, Turned, weld};

/// Every triangle with its own corners.
fn soup(mesh: &Mesh<3>) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let positions: Vec<[f64; 3]> = mesh.facets.iter().flatten().map(|node| mesh.positions[*node as usize]).collect();
    let triangles = (0..mesh.facets.len() as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    (positions, triangles)
}

fn torus() -> Mesh<3> {
    Mesh::torus(1.0, 0.4, [24, 12]).expect("a torus")
}

#[test]
fn welding_a_soup_gives_the_surface_back() {
    let torus = torus();
    let (mut positions, mut triangles) = soup(&torus);
    let before = positions.len();
    let joined = weld(&mut positions, &mut triangles, 0.0).expect("welded");
    assert_eq!((positions.len(), joined), (torus.nodes(), before - torus.nodes()));
    let mesh = Mesh { positions, facets: triangles, ..Mesh::default() };
    assert_eq!(mesh.euler_characteristic(), 0);
    assert!((mesh.enclosed_volume() - torus.enclosed_volume()).abs() < 1e-12);
    assert_eq!(mesh.components().expect("closed").len(), 1);
}

#[test]
fn welding_joins_what_is_near_and_nothing_else() {
    let ball = Mesh::icosphere(1.0, 2).expect("a ball");
    let (mut positions, mut triangles) = soup(&ball);
    for (k, position) in positions.iter_mut().enumerate() {
        position[k % 3] += 1e-7 * ((k * 7919 % 13) as f64 / 13.0 - 0.5);
    }
    let (mut exact, mut same) = (positions.clone(), triangles.clone());
    weld(&mut exact, &mut same, 0.0).expect("welded");
    assert!(exact.len() > ball.nodes(), "points that differ stay apart at distance 0");
    weld(&mut positions, &mut triangles, 1e-6).expect("welded");
    assert_eq!(positions.len(), ball.nodes());
}

#[test]
fn welding_that_would_collapse_a_triangle_is_refused_and_changes_nothing() {
    let (mut positions, mut triangles) = soup(&torus());
    let before = (positions.clone(), triangles.clone());
    let refused = weld(&mut positions, &mut triangles, 0.5);
    assert!(matches!(refused, Err(MeshError::RepeatedNode { .. })), "{refused:?}");
    assert!(
        weld(&mut positions, &mut triangles, f64::NAN).is_err() && weld(&mut positions, &mut triangles, -1.0).is_err()
    );
    assert_eq!((positions, triangles), before);
}

#[test]
fn components_are_turned_outward_and_cavities_inward() {
    let (outer, inner, other) = (Mesh::icosphere(1.0, 2), Mesh::icosphere(0.5, 1), Mesh::icosphere(0.3, 1));
    let mut mesh = Mesh::<3>::default();
    for (k, part) in [outer, inner, other].into_iter().enumerate() {
        let mut part = part.expect("a ball");
        if k == 2 {
            part.translate([3.0, 0.0, 0.0]);
        }
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(&part.positions);
        mesh.facets.extend(part.facets.iter().map(|f| f.map(|node| node + first)));
    }
    let volumes: Vec<f64> = mesh.components().expect("closed").iter().map(|c| c.signed_volume).collect();
    let wanted = volumes[0] - volumes[1] + volumes[2];
    // The other ball is inside out, and one triangle is reversed against its neighbours.
    let n = mesh.facets.len();
    mesh.facets[n - 80..].iter_mut().for_each(|f| f.swap(0, 1));
    mesh.facets[5].swap(0, 1);
    assert_eq!(mesh.orient_components(), Ok(Turned { against: 1, inside_out: 2, flat: None }));
    assert!((mesh.enclosed_volume() - wanted).abs() < 1e-12);
    assert_eq!(mesh.chambers().expect("chambers").len(), 2);
    assert_eq!(mesh.orient_components(), Ok(Turned::default()), "nothing is left to turn");
}

#[test]
fn caps_close_a_surface_and_one_sided_surfaces_are_refused() {
    let mut ball = Mesh::icosphere(1.0, 3).expect("a ball");
    let volume = ball.enclosed_volume();
    let positions = ball.positions.clone();
    ball.facets.retain(|f| f.iter().all(|node| positions[*node as usize][1].abs() < 0.8));
    assert!(matches!(ball.orient_components(), Err(MeshError::Open { loops: 2, .. })));
    ball.drop_unreferenced();
    assert_eq!(ball.cap(), Ok(2));
    assert_eq!(ball.euler_characteristic(), 2);
    assert_eq!(ball.orient_components().map(|t| t.against), Ok(0));
    assert!(ball.enclosed_volume() > 0.8 * volume && ball.enclosed_volume() < volume);

    let band = (0..12u32).flat_map(|k| {
        let (a, b, c, d) = (2 * k, 2 * k + 1, (2 * k + 2) % 24, (2 * k + 3) % 24);
        // The last joint is twisted.
        let (c, d) = if k == 11 { (d, c) } else { (c, d) };
        [[a, b, c], [b, d, c]]
    });
    let at = |k: u32| {
        let angle = std::f64::consts::TAU * f64::from(k / 2) / 12.0;
        let (side, half) = (f64::from(k % 2) - 0.5, 0.5 * angle);
        let r = 1.0 + 0.4 * side * half.cos();
        [r * angle.cos(), r * angle.sin(), 0.4 * side * half.sin()]
    };
    let mut moebius = Mesh::<3> { positions: (0..24).map(at).collect(), facets: band.collect(), ..Mesh::default() };
    assert!(matches!(moebius.orient_components(), Err(MeshError::NonOrientable { .. })));
}

#[test]
fn bad_triangles_are_found() {
    let mut ball = Mesh::icosphere(1.0, 1).expect("a ball");
    assert_eq!((ball.thin_facet(1e-10), ball.duplicate_facets()), (None, None));
    ball.facets.push([ball.facets[3][1], ball.facets[3][2], ball.facets[3][0]]);
    assert_eq!(ball.duplicate_facets(), Some([3, 80]));
    ball.positions.extend([[0.0; 3], [1.0, 1.0, 1.0], [2.0, 2.0, 2.0]]);
    ball.facets[80] = [42, 43, 44];
    assert_eq!(ball.thin_facet(1e-10).map(|f| f.0), Some(80));
}

#[test]
fn a_lattice_fills_its_surface_and_carries_it() {
    for (surface, volume) in [
        (Mesh::icosphere(1.0, 4).expect("a ball"), 4.0 / 3.0 * std::f64::consts::PI),
        (Mesh::torus(1.0, 0.45, [48, 24]).expect("a torus"), 2.0 * std::f64::consts::PI.powi(2) * 0.45 * 0.45),
    ] {
        let mut last = f64::INFINITY;
        for spacing in [0.3, 0.2, 0.1] {
            let body = surface.lattice_filling(spacing).expect("a filling");
            assert_eq!(body.check(), [], "spacing {spacing}");
            let own = body.measure().expect("a volume").value();
            // It extends beyond the surface, by less with finer cells.
            assert!(own / volume > 0.95 && own / volume < last, "{own} of {volume} at {spacing}");
            last = own / volume;
            let estimate = surface.lattice_estimate(spacing);
            let n = body.nodes() as f64;
            assert!(n < 1.5 * estimate + 50.0 && n > 0.4 * estimate, "{n} nodes, {estimate} estimated");
            // All tetrahedra have the same volume of a³/12.
            for cell in &body.cells.tetrahedra {
                let [a, b, c, d] = cell.map(|node| body.positions[node as usize]);
                let e = |p: [f64; 3]| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
                let (u, v, w) = (e(b), e(c), e(d));
                let det = u[0] * (v[1] * w[2] - v[2] * w[1])
                    + u[1] * (v[2] * w[0] - v[0] * w[2])
                    + u[2] * (v[0] * w[1] - v[1] * w[0]);
                assert!((det / 6.0 / (spacing * spacing * spacing / 12.0) - 1.0).abs() < 1e-9);
            }
            // The points of the skin are on the surface. Points from the file have weights between 0 and 1.
            let skin = body.skin.as_ref().expect("a skin");
            for (p, q) in skin.positions(&body.positions).iter().zip(&surface.positions) {
                assert!((0..3).all(|d| (p[d] - q[d]).abs() < 1e-12));
            }
            let own = skin.weights.iter().take(surface.nodes());
            assert!(own.flatten().all(|w| (-1e-12..1.0 + 1e-12).contains(w)));
            assert!(skin.weights.iter().all(|w| (w.iter().sum::<f64>() - 1.0).abs() < 1e-12));
        }
        assert!(last < 1.35, "{last}");
    }
}

#[test]
fn a_skin_follows_its_body() {
    let surface = Mesh::icosphere(1.0, 2).expect("a ball");
    let mut body = surface.lattice_filling(0.4).expect("a filling");
    body.rotate([1.0, 2.0, 3.0], 0.7, [0.1, 0.2, 0.3]).expect("turned");
    body.mirror([1.0, 1.0, 0.0], [0.0; 3]).expect("mirrored");
    let mut wanted = surface;
    wanted.rotate([1.0, 2.0, 3.0], 0.7, [0.1, 0.2, 0.3]).expect("turned");
    wanted.mirror([1.0, 1.0, 0.0], [0.0; 3]).expect("mirrored");
    let skin = body.skin.as_ref().expect("a skin");
    assert_eq!(skin.triangles, wanted.facets);
    for (p, q) in skin.positions(&body.positions).iter().zip(&wanted.positions) {
        assert!((0..3).all(|d| (p[d] - q[d]).abs() < 1e-12));
    }
    let heights: Vec<f64> = body.positions.iter().map(|p| p[2]).collect();
    for (z, q) in skin.values(&heights).iter().zip(&wanted.positions) {
        assert!((z - q[2]).abs() < 1e-12, "linear quantities are carried exactly");
    }
}

/// Large triangles of a surface are cut, so that pictures show the bending of the body. The added points are on the surface, and the nodes of the
/// body are the same as without them.
#[test]
fn a_skin_is_no_coarser_than_its_body() {
    let corner = |k: u32| [f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2 & 1)];
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let cube = Mesh::<3> {
        positions: (0..8).map(corner).collect(),
        facets: sides.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect(),
        ..Mesh::default()
    };
    let body = cube.lattice_filling(0.25).expect("a filling");
    let skin = body.skin.as_ref().expect("a skin");
    let points = skin.positions(&body.positions);
    let apart = |p: u32, q: u32| {
        let (p, q) = (points[p as usize], points[q as usize]);
        (0..3).map(|d| (p[d] - q[d]).powi(2)).sum::<f64>().sqrt()
    };
    assert!(
        skin.triangles.iter().all(|[a, b, c]| [(a, b), (b, c), (c, a)].iter().all(|(p, q)| apart(**p, **q) < 0.251))
    );
    for (point, own) in points.iter().zip(&cube.positions) {
        assert!((0..3).all(|d| (point[d] - own[d]).abs() < 1e-12), "those of the file come first");
    }
    let on_surface = |p: &[f64; 3]| {
        p.iter().any(|x| x.abs() < 1e-12 || (x - 1.0).abs() < 1e-12)
            && p.iter().all(|x| (-1e-12..1.0 + 1e-12).contains(x))
    };
    assert!(points.iter().all(on_surface) && points.len() > 100);
    // It is closed and encloses the cube: each edge belongs to two triangles, once in each direction.
    let surface = Mesh::<3> { positions: points.clone(), facets: skin.triangles.clone(), ..Mesh::default() };
    assert!((surface.enclosed_volume() - 1.0).abs() < 1e-12);
    assert_eq!(surface.components().expect("closed").len(), 1);
}

#[test]
fn a_needle_in_a_large_box_is_refused_before_its_box_is_walked_through() {
    let mut needle = Mesh::icosphere(1.0, 1).expect("a ball");
    needle.scale([1e6, 1e-3, 1e-3], [0.0; 3]).expect("stretched");
    needle.rotate([1.0, 1.0, 0.3], 0.8, [0.0; 3]).expect("turned");
    assert!(matches!(needle.lattice_filling(0.5), Err(MeshError::TooManyNodes { .. })));
    needle.scale([1e12; 3], [0.0; 3]).expect("stretched");
    assert!(matches!(needle.lattice_filling(0.5), Err(MeshError::TooManyNodes { .. })));
}

/// Two surfaces in one mesh, the second moved.
fn beside(first: &Mesh<3>, second: &Mesh<3>, by: [f64; 3]) -> Mesh<3> {
    let mut both = first.clone();
    let nodes = first.nodes() as u32;
    both.positions.extend(second.positions.iter().map(|p| [0, 1, 2].map(|d| p[d] + by[d])));
    both.facets.extend(second.facets.iter().map(|facet| facet.map(|node| node + nodes)));
    both
}

#[test]
fn sound_surfaces_do_not_meet_themselves() {
    let cube = Mesh::box_surface([0.0; 3], [1.0; 3], [4, 3, 2]).expect("a box");
    for mesh in [torus(), Mesh::icosphere(1.0, 3).expect("a ball"), cube] {
        let found = mesh.crossing_facets();
        assert!(found.complete && found.pairs.is_empty(), "{found:?}");
        // Neither do two that are apart, or one inside the other.
        assert_eq!(beside(&mesh, &mesh, [9.0, 0.0, 0.0]).crossing_facets().pairs, Vec::<[u32; 2]>::new());
    }
    let (outer, inner) = (Mesh::icosphere(1.0, 2).expect("a ball"), Mesh::icosphere(0.5, 1).expect("a ball"));
    assert_eq!(beside(&outer, &inner, [0.0; 3]).crossing_facets().pairs, Vec::<[u32; 2]>::new());
}

#[test]
fn surfaces_that_cross_touch_or_overlap_are_found_at_any_size() {
    let cube = Mesh::box_surface([0.0; 3], [1.0; 3], [1, 1, 1]).expect("a box");
    for (what, by) in [
        ("crosses", [0.3, 0.4, 0.5]),
        ("crosses symmetrically", [0.5, 0.5, 0.0]),
        ("has a common side", [1.0, 0.0, 0.0]),
        ("touches along an edge", [1.0, 1.0, 0.0]),
        ("touches in a corner", [1.0, 1.0, 1.0]),
        ("lies at the same place", [0.0; 3]),
        ("is pierced in the middle of a side", [0.25, 0.25, 0.75]),
    ] {
        for size in [1.0, 1e-140, 1e140] {
            let mut both = beside(&cube, &cube, by);
            both.positions.iter_mut().flatten().for_each(|x| *x *= size);
            let found = both.crossing_facets();
            assert!(!found.pairs.is_empty(), "{what}, {size:e}");
            assert!(found.pairs.iter().all(|[a, b]| *a < 12 && *b >= 12), "{what}: {found:?}");
        }
        let almost = beside(&cube, &cube, by.map(|x| x * (1.0 + 1e-12)));
        let apart = by.contains(&1.0);
        assert_eq!(almost.crossing_facets().pairs.is_empty(), apart, "{what}, a little farther away");
    }
    // A needle pulled through the opposite side of the ball; its neighbours share nodes with it.
    let mut ball = Mesh::icosphere(1.0, 3).expect("a ball");
    let pulled = ball.facets[0][0];
    ball.positions[pulled as usize] = ball.positions[pulled as usize].map(|x| -1.5 * x);
    let found = ball.crossing_facets();
    assert!(!found.pairs.is_empty());
    assert!(found.pairs.iter().all(|pair| pair.iter().any(|f| ball.facets[*f as usize].contains(&pulled))));
}

#[test]
fn triangles_folded_onto_a_neighbour_are_found() {
    // A tetrahedron without height: two pairs of triangles overlap.
    let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let facets = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
    let flat = Mesh::<3> { positions, facets, ..Mesh::default() };
    assert!(!flat.crossing_facets().pairs.is_empty());
    let mut open = flat.clone();
    open.positions[3][2] = 1e-300;
    assert_eq!(open.crossing_facets().pairs, Vec::<[u32; 2]>::new(), "not flat any more");
}

proptest::proptest! {
    #[test]
    fn two_balls_meet_where_their_distance_says_so(direction in proptest::array::uniform3(-1.0..1.0f64), distance in 0.0..2.5f64) {
        let length = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
        proptest::prop_assume!(length > 0.1);
        let (one, two) = (Mesh::icosphere(1.0, 3).expect("a ball"), Mesh::icosphere(0.5, 2).expect("a ball"));
        let both = beside(&one, &two, direction.map(|x| x / length * distance));
        // Triangles of these balls are at most 2 % and 7 % inside the spheres.
        let sure = distance > 0.54 && distance < 1.45;
        let may = (0.47..=1.5).contains(&distance);
        let found = both.crossing_facets().pairs.len();
        proptest::prop_assert!(if found > 0 { may } else { !sure }, "{distance}: {found}");
    }
}

#[test]
fn many_triangles_are_compared_in_little_time() {
    let ball = Mesh::icosphere(1.0, 7).expect("a ball of 327680 triangles");
    let start = std::time::Instant::now();
    let found = ball.crossing_facets();
    assert!(found.complete && found.pairs.is_empty());
    // A second for a million on an idle processor; a busy machine takes a few times as long.
    assert!(start.elapsed().as_secs_f64() < 20.0, "{:?}", start.elapsed());
}

#[test]
fn cubes_that_share_a_vertex_are_pinched_there() {
    let cube = Mesh::box_surface([0.0; 3], [1.0; 3], [2, 2, 2]).expect("a box");
    assert_eq!(cube.pinched_nodes(), Vec::<u32>::new());
    let n = cube.nodes() as u32;
    let mut two = cube.clone();
    two.positions.extend(cube.positions.iter().map(|p| p.map(|x| x + 1.0)));
    two.facets.extend(cube.facets.iter().map(|facet| facet.map(|node| node + n)));
    assert_eq!(two.pinched_nodes(), Vec::<u32>::new(), "each has a corner of its own");
    let (mut positions, mut facets) = (two.positions.clone(), two.facets.clone());
    assert_eq!(opruga_mesh::weld(&mut positions, &mut facets, 0.0), Ok(1));
    let shared = Mesh::<3> { positions, facets, ..Mesh::default() };
    let pinched = shared.pinched_nodes();
    assert_eq!(pinched.iter().map(|node| shared.positions[*node as usize]).collect::<Vec<_>>(), [[1.0; 3]]);
    assert!(shared.crossing_facets().pairs.is_empty(), "nothing else tells");
}
