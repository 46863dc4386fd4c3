//! Bodies that begin closer to one another than their contact distance.

use opruga_collide::{Laws, PairLaw, Touching};
use opruga_mesh::Mesh;
use std::f64::consts::FRAC_PI_2;

/// A quarter of a tube about the origin.
fn quarter(inner: f64, outer: f64, layers: u32, sides: u32) -> Mesh<2> {
    let mut mesh = Mesh::<2>::grid([0.0; 2], [1.0; 2], [layers, sides]).expect("a grid");
    for x in &mut mesh.positions {
        let (radius, angle) = (inner + x[0] * (outer - inner), FRAC_PI_2 * x[1]);
        *x = [radius * libm::cos(angle), radius * libm::sin(angle)].map(|c| if c.abs() < 1e-12 { 0.0 } else { c });
    }
    mesh
}

#[test]
fn tubes_that_are_too_near_part_by_no_more_than_they_lack() {
    for (sides, thickness) in [(16, 1e-2), (32, 3e-3), (64, 2e-3), (128, 2e-3)] {
        let meshes = [quarter(1.0, 1.4995, sides / 8, sides), quarter(1.5005, 2.0, sides / 8, sides + 1)];
        let mut touching = Touching::<2>::default();
        for (body, mesh) in meshes.iter().enumerate() {
            for node in touching.surface.add(mesh, body as u32) {
                let x = mesh.positions[node as usize];
                touching.after[0].push(x);
                touching.before[0].push(x);
                touching.inverse_mass.push(x.map(|c| if c == 0.0 { 0.0 } else { 1.0 }));
            }
        }
        for vectors in [&mut touching.after[1], &mut touching.before[1]] {
            vectors.resize(touching.inverse_mass.len(), [0.0; 2]);
        }
        let law = PairLaw { touch: true, friction: 0.0, restitution: 0.0, thickness };
        touching.laws = Laws {
            obstacles: 0,
            class: vec![0; 2],
            classes: 1,
            table: vec![law],
            itself: vec![false],
            rest_speed: 0.05,
            recovery_speed: 0.5,
            thickest_elsewhere: [0.0; 2],
        };
        touching.margin = 0.5 / f64::from(sides);
        touching.most = 1_000_000;
        touching.step(0.1, None).expect("few pairs");
        let mut moved = 0;
        for (from, to) in touching.before[0].iter().zip(&touching.after[0]) {
            let radius = (from[0] * from[0] + from[1] * from[1]).sqrt();
            let [x, y] = [to[0] - from[0], to[1] - from[1]];
            let way = (x * x + y * y).sqrt();
            assert!(way < 1.5 * thickness, "{sides}: {from:?} went to {to:?}");
            assert!(way == 0.0 || (radius - 1.5).abs() < 0.1 * thickness + 1e-3, "{sides}: {from:?} went to {to:?}");
            moved += u32::from(way > 0.0);
        }
        assert!(moved > sides, "{sides}: {moved}");
    }
}
