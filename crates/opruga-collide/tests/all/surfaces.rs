//! Surfaces of bodies: candidates compared with all pairs, closest points with samples, gaps inside and outside.
#![allow(missing_docs)]

use opruga_collide::{
    Candidates, Gap, Surface, closest_of_segments, closest_on_facet, edge_meets_edge, vertex_meets_facet,
};
use opruga_mesh::Mesh;

/// Numbers from −1 to 1 that are the same in every run.
struct Noise(u64);
impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
    fn vector<const D: usize>(&mut self) -> [f64; D] {
        core::array::from_fn(|_| self.next())
    }
}

/// Several bodies of different sizes, mixed, at the start and the end of a step.
fn crowd<const D: usize>(meshes: &[Mesh<D>], noise: &mut Noise) -> (Surface<D>, Vec<[f64; D]>, Vec<[f64; D]>) {
    let mut surface = Surface::default();
    let (mut start, mut end) = (Vec::new(), Vec::new());
    for (number, mesh) in meshes.iter().enumerate() {
        let size = if number % 3 == 0 { 1.0 } else { 0.1 };
        let (offset, step) = (noise.vector::<D>(), noise.vector::<D>());
        for node in surface.add(mesh, number as u32) {
            let x = mesh.positions[node as usize];
            start.push(core::array::from_fn(|d| size * x[d] + offset[d]));
            end.push(core::array::from_fn(|d| size * x[d] + offset[d] + 0.1 * step[d] + 0.02 * noise.next()));
        }
        for x in [&mut start, &mut end] {
            x.resize(surface.points(), [0.0; D]);
            surface.follow(x);
        }
    }
    (surface, start, end)
}

fn boxes_meet<const D: usize>(a: &[u32], b: &[u32], ends: [&[[f64; D]]; 2], margin: f64) -> bool {
    (0..D).all(|d| {
        let range = |points: &[u32]| {
            let all = points.iter().flat_map(|p| ends.map(|x| x[*p as usize][d]));
            all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
                [if x < low { x } else { low }, if x > high { x } else { high }]
            })
        };
        let ([a0, a1], [b0, b1]) = (range(a), range(b));
        a0 <= b1 + margin && b0 - margin <= a1
    })
}

/// The boxes around the motions of points.
fn boxes<const D: usize>(start: &[[f64; D]], end: &[[f64; D]]) -> Vec<[[f64; D]; 2]> {
    let least = |a: f64, b: f64| if a < b { a } else { b };
    let both = start.iter().zip(end);
    both.map(|(a, b)| {
        [0, 1].map(|k| core::array::from_fn(|d| if k == 0 { least(a[d], b[d]) } else { -least(-a[d], -b[d]) }))
    })
    .collect()
}

/// Whether two features share a point, or whether a node carries points of both.
fn join<const D: usize>(surface: &Surface<D>, a: &[u32], b: &[u32]) -> bool {
    let nodes = |points: &[u32]| {
        let mut all = Vec::new();
        points.iter().for_each(|p| surface.visit_nodes(*p, |node, _| all.push(node)));
        all
    };
    let (a, b) = (nodes(a), nodes(b));
    a.iter().any(|node| b.contains(node))
}

fn compare_with_all_pairs<const D: usize>(meshes: &[Mesh<D>], seed: u64) -> usize {
    let mut noise = Noise(seed);
    let (surface, start, end) = crowd(meshes, &mut noise);
    let meet = |a: u32, b: u32| if a == b { a.is_multiple_of(2) } else { !(a + b).is_multiple_of(5) };
    let mut candidates = Candidates::default();
    let margin = 0.03;
    // The search runs twice, because the data of the first search must not affect the second.
    assert!(candidates.find(&surface, &boxes(&end, &end), [0.5; 2], usize::MAX, |_, _| true));
    assert!(candidates.find(&surface, &boxes(&start, &end), [margin; 2], usize::MAX, meet));
    let mut expected = Vec::new();
    for p in 0..surface.points() as u32 {
        for (k, facet) in surface.facets.iter().enumerate() {
            let (a, b) = (surface.body[p as usize], surface.body[facet[0] as usize]);
            let joined = a == b && join(&surface, &[p], facet);
            if meet(a, b) && !joined && boxes_meet(&[p], facet, [&start, &end], margin) {
                expected.push([p, k as u32]);
            }
        }
    }
    assert_eq!(candidates.vertex_facet, expected);
    expected.clear();
    for (j, first) in surface.edges.iter().enumerate() {
        for (k, second) in surface.edges.iter().enumerate().skip(j + 1) {
            let (a, b) = (surface.body[first[0] as usize], surface.body[second[0] as usize]);
            let joined = a == b && join(&surface, first, second);
            if meet(a, b) && !joined && boxes_meet(first, second, [&start, &end], margin) {
                expected.push([j as u32, k as u32]);
            }
        }
    }
    assert_eq!(candidates.edge_edge, expected);
    let found = candidates.len();
    assert!(
        found < 10 || !candidates.find(&surface, &boxes(&start, &end), [margin; 2], 3, meet),
        "a limit ends the search"
    );
    found
}

#[test]
fn candidates_are_those_of_all_pairs() {
    let ring = Mesh::<2>::ring(1.0, 40, [0.0, 0.0], 0.0).expect("a ring");
    let wire = Mesh::<2>::line([0.0, 0.0], [1.0, 0.3], 30).expect("a wire");
    let square = Mesh::<2>::grid([0.0, 0.0], [1.0, 1.0], [6, 6]).expect("a square");
    let mut found = 0;
    for seed in 0..8 {
        found +=
            compare_with_all_pairs(&[ring.clone(), wire.clone(), ring.clone(), square.clone(), ring.clone()], seed);
    }
    assert!(found > 1000, "{found}");
    // With this many features, the hierarchy of boxes has four levels.
    let large = Mesh::<2>::ring(1.0, 1500, [0.0, 0.0], 0.0).expect("a ring");
    let found = compare_with_all_pairs(&[large.clone(), wire, ring, large], 8);
    assert!(found > 1000, "{found}");
    let ball = Mesh::<3>::icosphere(1.0, 2).expect("a ball");
    let cube = Mesh::<3>::grid([0.0; 3], [1.0; 3], [3, 3, 3]).expect("a cube");
    let string = Mesh::<3>::line([0.0; 3], [1.0, 0.3, -0.2], 30).expect("a wire");
    let mut found = 0;
    for seed in 0..4 {
        found += compare_with_all_pairs(&[ball.clone(), string.clone(), cube.clone(), ball.clone()], seed);
    }
    assert!(found > 1000, "{found}");
}

/// No points of a fine grid on two features are closer to one another than the computed closest points.
#[test]
fn closest_points_are_the_closest() {
    let mut noise = Noise(7);
    let square = |a: [f64; 3], b: [f64; 3]| (0..3).map(|d| (a[d] - b[d]) * (a[d] - b[d])).sum::<f64>();
    let mix = |w: &[f64], x: &[[f64; 3]]| -> [f64; 3] {
        core::array::from_fn(|d| w.iter().zip(x).map(|(w, x)| w * x[d]).sum())
    };
    for round in 0..2000 {
        let p: [f64; 3] = noise.vector();
        let mut corners: [[f64; 3]; 3] = core::array::from_fn(|_| noise.vector());
        if round % 7 == 0 {
            corners[2] = mix(&[0.3, 0.7], &corners[..2]);
        }
        let w = closest_on_facet(&p, &corners);
        assert!(w.iter().all(|w| *w >= 0.0) && (w.iter().sum::<f64>() - 1.0).abs() < 1e-14, "{w:?}");
        let found = square(p, mix(&w, &corners));
        let b: [[f64; 3]; 2] = core::array::from_fn(|_| noise.vector());
        let a = [corners[0], corners[1]];
        let [s, t] = closest_of_segments(&a, &b);
        let apart = square(mix(&[1.0 - s, s], &a), mix(&[1.0 - t, t], &b));
        for j in 0..=20 {
            for k in 0..=20 {
                let (u, v) = (f64::from(j) / 20.0, f64::from(k) / 20.0);
                if u + v <= 1.0 {
                    let there = square(p, mix(&[1.0 - u - v, u, v], &corners));
                    assert!(there > found - 1e-12, "{round}: {there} {found}");
                }
                let there = square(mix(&[1.0 - u, u], &a), mix(&[1.0 - v, v], &b));
                assert!(there > apart - 1e-12, "{round}: {there} {apart}");
            }
        }
    }
}

/// The gap to the nearest facet of a closed body is negative exactly inside, and changes according to its weights and normal.
#[test]
fn the_sign_of_the_gap_is_that_of_the_side() {
    let mut noise = Noise(3);
    let cube = Mesh::<3>::grid([-0.5; 3], [1.0; 3], [2, 2, 2]).expect("a cube");
    let mut surface = Surface::default();
    let mut x: Vec<[f64; 3]> = surface.add(&cube, 0).iter().map(|n| cube.positions[*n as usize]).collect();
    x.resize(surface.points(), [0.0; 3]);
    surface.follow(&mut x);
    let point = surface.add(&Mesh { positions: vec![[0.0; 3]], ..Mesh::default() }, 1);
    assert_eq!(point, [0]);
    let last = x.len();
    x.push([0.0; 3]);
    for _ in 0..3000 {
        let p: [f64; 3] = noise.vector();
        x[last] = p;
        let of = |facet: usize, x: &[[f64; 3]]| Gap::of_vertex_and_facet(&surface, x, last as u32, facet as u32);
        let all = (0..surface.facets.len()).map(|facet| (of(facet, &x), facet));
        let nearest = all.fold(None, |best: Option<(Gap<3>, usize)>, one| match best {
            Some(best) if best.0.gap.abs() <= one.0.gap.abs() => Some(best),
            _ => Some(one),
        });
        let (gap, facet) = nearest.expect("there are facets");
        let inside = p.iter().all(|c| c.abs() < 0.5);
        assert_eq!(gap.gap < 0.0, inside, "{p:?} {gap:?}");
        let outside: f64 = p.iter().map(|c| if c.abs() > 0.5 { (c.abs() - 0.5) * (c.abs() - 0.5) } else { 0.0 }).sum();
        let depth = p.iter().fold(1.0f64, |least, c| if 0.5 - c.abs() < least { 0.5 - c.abs() } else { least });
        let exact = if inside { -depth } else { outside.sqrt() };
        assert!((gap.gap - exact).abs() < 1e-12, "{p:?}: {} {exact}", gap.gap);
        // Displacements change it by Σ w n·Δx.
        let changes: Vec<[f64; 3]> = x.iter().map(|_| noise.vector::<3>().map(|c| 1e-7 * c)).collect();
        let moved: Vec<[f64; 3]> = x.iter().zip(&changes).map(|(x, c)| core::array::from_fn(|d| x[d] + c[d])).collect();
        let after = of(facet, &moved).gap;
        assert!((after - gap.gap - gap.along(&changes)).abs() < 1e-11 / (gap.gap.abs() + 1e-3), "{p:?}");
    }
}

/// Two edges of boxes, one above the other and across one another.
#[test]
fn edges_know_their_inner_side() {
    let brick = Mesh::<3>::grid([-1.0, -0.1, -0.1], [2.0, 0.2, 0.2], [1, 1, 1]).expect("a brick");
    // Rotated by 45° about its long axis, so that an edge is on top.
    let c = 0.5f64.sqrt();
    let turned: Vec<[f64; 3]> = brick.positions.iter().map(|[x, y, z]| [*x, c * (y - z), c * (y + z)]).collect();
    let across: Vec<[f64; 3]> = turned.iter().map(|[x, y, z]| [*z, *y, -x]).collect();
    let top = 0.1 * 2.0f64.sqrt();
    for lift in [0.02, 1e-3, -1e-3, -0.02] {
        let mut surface = Surface::default();
        let nodes = [surface.add(&brick, 0), surface.add(&brick, 1)];
        let lifted = across.iter().map(|[x, y, z]| [*x + 0.05, y + 2.0 * top + lift, *z + 0.05]).collect::<Vec<_>>();
        let mut x = vec![[0.0; 3]; surface.points()];
        for (number, positions) in [&turned, &lifted].into_iter().enumerate() {
            let points = surface.points_of(number).zip(&nodes[number]);
            points.for_each(|(p, node)| x[p] = positions[*node as usize]);
        }
        surface.follow(&mut x);
        let mut candidates = Candidates::default();
        assert!(candidates.find(&surface, &boxes(&x, &x), [0.05; 2], 1000, |a, b| a != b));
        let gaps: Vec<Gap<3>> =
            candidates.edge_edge.iter().filter_map(|[a, b]| Gap::of_edges(&surface, &x[..], *a, *b)).collect();
        let nearest = gaps.iter().fold(f64::INFINITY, |best, g| if g.gap.abs() < best.abs() { g.gap } else { best });
        assert!((nearest - lift).abs() < 1e-12, "{nearest} {lift}");
    }
}

struct Query {
    start: [[f64; 3]; 4],
    end: [[f64; 3]; 4],
    collides: bool,
}

/// The queries of a file: see `tests/data/ccd/CREDITS.md`.
fn queries(text: &str) -> Vec<Query> {
    let rows: Vec<([f64; 3], bool)> = text
        .lines()
        .map(|line| {
            let fields: Vec<f64> = line.split(',').map(|field| field.trim().parse().expect("a number")).collect();
            (core::array::from_fn(|d| fields[2 * d] / fields[2 * d + 1]), fields[6] == 1.0)
        })
        .collect();
    rows.chunks_exact(8)
        .map(|rows| Query {
            start: core::array::from_fn(|k| rows[k].0),
            end: core::array::from_fn(|k| rows[k + 4].0),
            collides: rows[0].1,
        })
        .collect()
}

/// No collision is missed, and at the returned time the features have not met.
#[test]
fn continuous_detection_misses_nothing() {
    let data = [
        ("edge", include_str!("../data/ccd/unit-tests-edge-edge-data_0_0.csv")),
        ("edge", include_str!("../data/ccd/unit-tests-edge-edge-data_0_1.csv")),
        ("edge", include_str!("../data/ccd/erleben-cube-internal-edges-edge-edge-data_0_0.csv")),
        ("facet", include_str!("../data/ccd/unit-tests-vertex-face-data_0_0.csv")),
        ("facet", include_str!("../data/ccd/unit-tests-vertex-face-data_0_1.csv")),
        ("facet", include_str!("../data/ccd/erleben-cube-internal-edges-vertex-face-data_0_0.csv")),
    ];
    let (mut total, mut missed, mut extra) = (0, 0, 0);
    for (kind, text) in data {
        for Query { start: a, end: b, collides } in queries(text) {
            let found = match kind {
                "edge" => edge_meets_edge(&[[a[0], a[1]], [b[0], b[1]]], &[[a[2], a[3]], [b[2], b[3]]], 0.0),
                _ => vertex_meets_facet(&[a[0], b[0]], &[[a[1], a[2], a[3]], [b[1], b[2], b[3]]], 0.0),
            };
            total += 1;
            missed += usize::from(collides && found.is_none());
            extra += usize::from(!collides && found.is_some());
        }
    }
    assert_eq!((total, missed), (574, 0));
    assert!(extra <= 10, "{extra} false alarms");
}

/// A vertex that moves through a facet at any speed meets the facet, at a point where the two are closer than the given
/// distance.
#[test]
fn fast_features_do_not_pass_through() {
    let facet = [[-1.0, 0.0], [1.0, 0.0]];
    for speed in [1e-3, 1.0, 1e3, 1e9] {
        let x = [0.3, 0.5];
        let found = vertex_meets_facet(&[x, [0.3, 0.5 - speed]], &[facet, facet], 0.01);
        match found {
            Some(time) => {
                let gap = 0.5 - time * speed;
                assert!((0.01..=0.01 + 1e-8).contains(&gap), "{speed}: {gap}");
            }
            None => assert_eq!(speed, 1e-3),
        }
    }
    // Features that move together never meet, however fast.
    let together = |x: [f64; 2]| [x[0] + 1e6, x[1] - 1e6];
    let moved = [facet[0], facet[1]].map(together);
    assert_eq!(vertex_meets_facet(&[[0.3, 0.5], together([0.3, 0.5])], &[facet, moved], 0.01), None);
}
