//! The curve of equilibria where a body meets obstacles on its way.
#![allow(clippy::disallowed_methods)] // expected values of the tests' own

mod common;

use common::{built, frames, head, plane};
use opruga::World;

fn statics(fields: &str) -> String {
    head(1.0, 1, 0.0, "equilibrium").replace("kind = \"equilibrium\"\n", &format!("kind = \"equilibrium\"\n{fields}"))
}

fn floor(height: f64, friction: f64) -> String {
    format!(
        "[[collider]]\nkind = \"half_space\"\npoint = [0.0, {height:?}]\nnormal = [0.0, 1.0]\nfriction = {friction:?}\n"
    )
}

/// A ball whose top is at a height over some point of the x-axis.
fn ball(x: f64, top: f64, friction: f64) -> String {
    format!(
        "[[collider]]\nkind = \"ball\"\ncenter = [{x:?}, {:?}]\nradius = 0.35\nfriction = {friction:?}\n",
        top - 0.35
    )
}

/// The part of the load that is on.
fn load(world: &mut World<2>) -> f64 {
    world.readings(0).into_iter().find(|reading| reading.0 == "load_factor").expect("statics have a load factor").1
}

fn heights(world: &World<2>) -> Vec<f64> {
    (0..world.node_count(0) as u32).map(|node| world.position(0, node)[1]).collect()
}

/// Two springs with their apex at 0.2 m, pressed onto a floor, or onto a ball, at some height: on the way down the load is that of the closed
/// form 2 k (1 − l) y/l, also where it has to be held back; on the floor nothing moves any more, and the rest of the load goes
/// into that.
#[test]
fn a_truss_snaps_onto_a_floor_by_its_closed_form() {
    let (stiffness, force): (f64, f64) = (1000.0, 30.0);
    let half = (1.0f64 - 0.04).sqrt();
    let obstacles = [(0.15, 0.0), (0.05, 0.4), (-0.05, 0.0)].map(|(top, friction)| (top, ball(0.0, top, friction)));
    let floors = [(-0.05, 0.4), (-0.1, 0.0), (-0.19, 0.4)].map(|(top, friction)| (top, floor(top, friction)));
    for (height, obstacle) in obstacles.into_iter().chain(floors) {
        let mut world = built(plane(
            &(statics("arc_length = 0.007\ntolerance = 1e-11\n")
                + &format!(
                    "[[body]]\nname = \"roof\"\nmass = 1.0\nshape = {{ kind = \"polyline\", points = [[{:?}, 0.0], [0.0, 0.2], \
                     [{half:?}, 0.0]] }}\nmodels = [{{ kind = \"mass_spring\", stiffness = {stiffness:?} }}]\n\
                     pin = [{{ select = {{ nodes = [0, 2] }} }}, {{ select = {{ node = 1 }}, axes = \"x\" }}]\n\
                     [[load]]\nkind = \"force\"\nbody = \"roof\"\nselect = {{ node = 1 }}\nvalue = [0.0, {:?}]\n",
                    -half, -force
                )
                + &obstacle),
        ));
        let needed = |y: f64| {
            let length = (half * half + y * y).sqrt();
            2.0 * stiffness * (1.0 - length) * (y / length) / force
        };
        let mut points = 0;
        while load(&mut world) < 1.0 {
            frames(&mut world, 1);
            let (y, load) = (world.position(0, 1)[1], load(&mut world));
            assert!(y > height - 1e-9, "floor at {height}: {y}");
            if y > height + 1e-9 {
                points += 1;
                assert!((needed(y) - load).abs() < 1e-7, "floor at {height}, apex at {y}: {load}, not {}", needed(y));
            }
            assert!(points < 200, "floor at {height}");
        }
        let y = world.position(0, 1)[1];
        assert!(points > 3 && (y - height).abs() < 1e-9, "floor at {height}: {y} after {points} points");
        frames(&mut world, 1);
        assert!((world.position(0, 1)[1] - height).abs() < 1e-9);
    }
}

/// The arch of the scene `snap-through` over obstacles: it comes to lie on them with all of the load, and what the curve ends in
/// is a balance for Newton's method without an arc too.
#[test]
fn an_arch_snaps_onto_obstacles_and_stays_there() {
    let arch = |fields: &str, obstacle: &str| {
        let shipped = opruga::scenes::find("snap-through").expect("a scene");
        built(plane(&(shipped.replace("arc_length = 0.008\n", fields) + obstacle)))
    };
    for (obstacle, top) in [
        (floor(-0.08, 0.0), Some(-0.08)),
        (floor(-0.08, 0.3), Some(-0.08)),
        (ball(0.0, 0.1, 0.0), Some(0.1)),
        (ball(0.0, -0.05, 0.2), Some(-0.05)),
        (ball(0.3, 0.0, 0.4), None),
    ] {
        let mut world = arch("arc_length = 0.008\n", &obstacle);
        let (mut highest, mut count) = (0.0f64, 0);
        let mut falls = 0;
        while load(&mut world) < 1.0 {
            let before = load(&mut world);
            frames(&mut world, 1);
            falls += u32::from(load(&mut world) < before);
            highest = highest.max(load(&mut world));
            count += 1;
            assert!(count < 300, "{obstacle}: {}", load(&mut world));
        }
        println!("{obstacle}{count} steps, {falls} of them downwards, {:?}", world.solver_work());
        // It gives way at a height of 0.09 m.
        assert!(falls > 3 || top.is_some_and(|top| top > 0.09), "{obstacle}: {falls}");
        let end = heights(&world);
        match top {
            Some(top) => assert!((end[12] - top).abs() < 1e-8, "{obstacle}: {end:?}"),
            None => {
                let gap = |[x, y]: [f64; 2]| ((x - 0.3).powi(2) + (y + 0.35).powi(2)).sqrt() - 0.35;
                let least = (0..25).map(|node| gap(world.position(0, node))).fold(f64::INFINITY, f64::min);
                assert!(least.abs() < 1e-7, "{obstacle}: {least}");
            }
        }
        frames(&mut world, 1);
        let moved = end.iter().zip(heights(&world)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(moved < 1e-7, "{obstacle}: {moved}");
    }
}
