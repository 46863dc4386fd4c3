//! The scene that shows the published ball next to the same ball with corrected physics, as the documentation describes it.
#![allow(clippy::disallowed_methods)] // no physics here

use crate::common;
use common::*;
use opruga::World;

/// The area that the nodes of a ring enclose.
fn area(world: &World<2>, body: usize) -> f64 {
    let n = world.node_count(body) as u32;
    let twice: f64 = (0..n)
        .map(|k| {
            let (a, b) = (world.position(body, k), world.position(body, (k + 1) % n));
            a[0] * b[1] - a[1] * b[0]
        })
        .sum();
    0.5 * twice.abs()
}

fn reading(world: &mut World<2>, body: usize, name: &str) -> f64 {
    world.readings(body).into_iter().find(|r| r.0 == name).expect("a reading").1
}

/// In flight both oscillate about the mean radius of the thesis, 131 px, with an area of N R² sin(2π/N)/2 = 53,640 px². On the floor the published
/// "volume" (erratum E1) loses up to 8 % compared with the true area, the corrected one nothing.
#[test]
fn both_balls_agree_in_flight_and_part_on_the_floor() {
    let mut world = built(plane(opruga::scenes::find("published-beside-physics").expect("a scene")));
    let (published, physics) = (world.body("published").expect("a body"), world.body("physics").expect("a body"));
    let mut mean = [0.0; 2];
    // The published "volume" divided by the true area: smallest and largest, in flight and on the floor.
    let mut share = [[f64::INFINITY, 0.0f64]; 2];
    for frame in 1..=450 {
        frames(&mut world, 1);
        let areas = [area(&world, published), area(&world, physics)];
        let ratio = reading(&mut world, published, "volume") / areas[0];
        assert!((reading(&mut world, physics, "volume") / areas[1] - 1.0).abs() < 1e-12);
        let floor = usize::from(world.energy().loss_contact > 0.0);
        share[floor] = [share[floor][0].min(ratio), share[floor][1].max(ratio)];
        if (150..350).contains(&frame) {
            (0..2).for_each(|k| mean[k] += areas[k] / 200.0);
        }
    }
    println!("mean areas {mean:?}, volume over area {share:?}");
    for area in mean {
        assert!((area / 53_640.0 - 1.0).abs() < 0.01, "{mean:?}");
    }
    // A constant factor as long as the ball is round.
    let [flight, floor] = share;
    assert!(flight[1] / flight[0] < 1.0 + 1e-12, "{share:?}");
    assert!((floor[0] / flight[0] - 0.92).abs() < 0.005, "{share:?}");
}
