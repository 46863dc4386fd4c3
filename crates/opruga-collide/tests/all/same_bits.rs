//! The same bits with every set of vector instructions and in every layout; and a body at rest does not vibrate.
#![allow(missing_docs)]

use crate::common;
use common::*;
use opruga_core::potential::{Observe, Potential, Properties, Views};
use opruga_core::spec::{Value, Values};
use opruga_core::state::{Layout, View};
use opruga_core::system::System;
use opruga_core::tile::Tile;
use opruga_math::Simd;

/// Every kind of collider, moving and at rest, in one scene.
fn zoo<const D: usize>() -> Vec<Values> {
    let v = |x: [f64; 3]| vector(&x[..D]);
    let path = |rows: [[f64; 4]; 3]| Value::Rows(rows.iter().map(|r| r[..D + 1].to_vec()).collect());
    let spin = |s: f64| if D == 2 { number(s) } else { vector(&[0.3 * s, 0.1 * s, s]) };
    let law = |e: f64, mu: f64| vec![("restitution", number(e)), ("friction", number(mu))];
    let with = |mut own: Vec<(&'static str, Value)>, law: Vec<(&'static str, Value)>| {
        own.extend(law);
        own
    };
    let facets = if D == 2 {
        values::<D>(
            "polyline",
            &with(vec![("points", rows(&[&[-2.0, -1.0], &[-0.5, -1.3], &[1.0, -0.9]]))], law(0.3, 0.4)),
        )
    } else {
        values::<D>(
            "triangle_mesh",
            &with(
                vec![
                    ("points", rows(&[&[-2.0, -1.0, -2.0], &[2.0, -1.1, -2.0], &[2.0, -1.2, 2.0], &[-2.0, -0.9, 2.0]])),
                    ("triangles", Value::Integers(vec![0, 1, 2, 0, 2, 3])),
                    ("spin", spin(0.3)),
                ],
                law(0.3, 0.4),
            ),
        )
    };
    let hull = [[1.2, 0.2, 0.0], [1.8, 0.1, 0.3], [1.5, 0.9, 0.1], [1.4, 0.4, -0.8], [1.5, 0.4, 0.9]];
    vec![
        values::<D>(
            "half_space",
            &with(vec![("point", v([0.0, -2.0, 0.0])), ("normal", v([0.1, 1.0, 0.05]))], law(0.5, 0.3)),
        ),
        values::<D>(
            "box",
            &with(
                vec![("center", v([0.0, -1.4, 0.0])), ("size", v([1.0, 0.4, 1.0])), ("spin", spin(2.0))],
                law(0.0, 0.7),
            ),
        ),
        values::<D>(
            "box",
            &with(vec![("min", v([-3.0; 3])), ("max", v([3.0; 3])), ("inside", Value::Boolean(true))], law(0.9, 0.0)),
        ),
        values::<D>(
            "ball",
            &with(
                vec![
                    ("center", v([-1.5, 0.0, 0.0])),
                    ("radius", number(0.5)),
                    ("motion", path([[0.0, 0.0, 0.0, 0.0], [0.5, 1.0, 0.2, 0.1], [1.0, 0.0, 0.0, 0.0]])),
                ],
                law(0.8, 0.2),
            ),
        ),
        values::<D>(
            "capsule",
            &with(
                vec![
                    ("a", v([-1.0, 0.8, 0.0])),
                    ("b", v([0.3, 1.0, 0.2])),
                    ("radius", number(0.2)),
                    ("spin", spin(-3.0)),
                ],
                law(0.1, 0.1),
            ),
        ),
        values::<D>(
            "convex",
            &with(
                vec![
                    ("points", Value::Rows(hull.iter().map(|p| p[..D].to_vec()).collect())),
                    ("thickness", number(0.05)),
                ],
                law(0.4, 0.5),
            ),
        ),
        facets,
    ]
}

/// 611 nodes (two tiles, the last pack not full) rain through the zoo.
fn rain<const D: usize>(simd: Simd, layout: Layout) -> System<D> {
    let mut seed = 3u64;
    let mut random = move || {
        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (seed >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
    };
    let x: Vec<[f64; D]> = (0..611).map(|_| core::array::from_fn(|_| 2.0 * random())).collect();
    let v: Vec<[f64; D]> = (0..611).map(|_| core::array::from_fn(|_| 4.0 * random())).collect();
    let mut system = laid_out(simd, layout, &x, &v, 0.5, &zoo::<D>());
    system.gravity[1] = -G;
    run(&mut system, 1.0 / 480.0, 480);
    system
}
fn same_bits<const D: usize>() {
    let reference = rain::<D>(Simd::Baseline, Layout::Single);
    assert!(
        reference.work.contact.iter().all(|w| *w > 0.0)
            && sum(&reference.work.friction) > 0.0
            && sum(&reference.work.user) != 0.0
    );
    for simd in [Simd::Baseline, Simd::Avx2, Simd::Avx512] {
        let single = rain::<D>(simd, Layout::Single);
        assert_eq!(single.work, reference.work, "{simd:?}");
        let batch = rain::<D>(simd, Layout::Batch);
        for node in 0..611 {
            let expected = (reference.state.x.at(node), reference.state.v.at(node));
            assert!(expected.0.iter().all(|x| x.abs() < 3.5));
            assert_eq!((single.state.x.at(node), single.state.v.at(node)), expected, "{simd:?} {node}");
            for body in 0..8 {
                let place = Layout::Batch.index(node, body);
                assert_eq!((batch.state.x.at(place), batch.state.v.at(place)), expected, "{simd:?} {node} {body}");
            }
        }
        // The ledger of one body is summed in another order.
        let total = sum(&reference.work.contact);
        assert!((batch.work.contact[0] - total).abs() < 1e-12 * total);
    }
}
#[test]
fn same_bits_in_2d() {
    same_bits::<2>();
}
#[test]
fn same_bits_in_3d() {
    same_bits::<3>();
}

/// Damped springs between all pairs of nodes.
#[derive(Debug)]
struct Jelly(Vec<(usize, usize, f64)>);
impl<const D: usize> Potential<D> for Jelly {
    fn properties(&self) -> Properties {
        Properties::new("jelly", Views { energy: true, damping: true, ..Views::default() })
    }
    fn stencils(&self, visit: &mut dyn FnMut(&[u32])) {
        self.0.iter().for_each(|s| visit(&[s.0 as u32, s.1 as u32]));
    }
    fn add_force(&self, _simd: Simd, view: &View<D>, _scratch: &[f64], tile: &mut Tile<D>) {
        for &(a, b, rest) in &self.0 {
            let d: [f64; D] = core::array::from_fn(|i| view.x[i][a] - view.x[i][b]);
            let w: [f64; D] = core::array::from_fn(|i| view.v[i][a] - view.v[i][b]);
            let r = dot(&d, &d).sqrt();
            let f = 400.0 * (r - rest) + 4.0 * dot(&d, &w) / r;
            for i in 0..D {
                tile.force[i][a] -= f * d[i] / r;
                tile.force[i][b] += f * d[i] / r;
            }
        }
    }
}

impl<const D: usize> Observe<D> for Jelly {}

#[test]
fn a_body_at_rest_does_not_tremble() {
    let slope = |e: f64, mu: f64| {
        values::<2>(
            "half_space",
            &[("normal", vector(&[0.2, 1.0])), ("restitution", number(e)), ("friction", number(mu))],
        )
    };
    for (e, mu) in [(0.0, 0.5), (0.8, 0.5)] {
        let ring: Vec<[f64; 2]> = (0..12)
            .map(|k| {
                let angle = core::f64::consts::TAU * k as f64 / 12.0;
                [0.5 * libm::cos(angle), 0.6 + 0.5 * libm::sin(angle)]
            })
            .collect();
        let mut springs = Vec::new();
        for a in 0..12 {
            for b in 0..a {
                let d = [ring[a][0] - ring[b][0], ring[a][1] - ring[b][1]];
                springs.push((a, b, dot(&d, &d).sqrt()));
            }
        }
        let mut system = particles(&ring, &[[0.0; 2]; 12], 0.1, &[slope(e, mu)]);
        system.gravity = [0.0, -G];
        // A second plane is needed, because a ring on one slope would roll down. Between the slope and this wall, the ring
        // stays in place.
        system.contacts = Some(std::sync::Arc::new(colliders::<2>(&[
            slope(e, mu),
            values::<2>(
                "half_space",
                &[
                    ("point", vector(&[1.0, 0.0])),
                    ("normal", vector(&[-1.0, 0.2])),
                    ("restitution", number(e)),
                    ("friction", number(mu)),
                ],
            ),
        ])));
        system.add(Box::new(Jelly(springs)));
        system.plan(0);
        run(&mut system, 1.0 / 960.0, 960 * 40);
        let mut square = 0.0;
        for _ in 0..960 {
            step(&mut system, 1.0 / 960.0);
            for node in 0..12 {
                let v = at(&system, node).1;
                square += dot(&v, &v) / (12.0 * 960.0);
            }
        }
        println!("rest: e {e}: {:e} m/s", square.sqrt());
        assert!(square.sqrt() < 1e-6, "{}", square.sqrt());
    }
}
