//! The curve of equilibria of a body that comes into contact with obstacles.
#![allow(clippy::disallowed_methods)] // expected values of the tests' own

use crate::common;

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

/// A ball with its top at a given height above a point of the x-axis.
fn ball(x: f64, top: f64, friction: f64) -> String {
    format!(
        "[[collider]]\nkind = \"ball\"\ncenter = [{x:?}, {:?}]\nradius = 0.35\nfriction = {friction:?}\n",
        top - 0.35
    )
}

/// The present fraction of the load.
fn load(world: &mut World<2>) -> f64 {
    world.readings(0).into_iter().find(|reading| reading.0 == "load_factor").expect("statics have a load factor").1
}

fn heights(world: &World<2>) -> Vec<f64> {
    (0..world.node_count(0) as u32).map(|node| world.position(0, node)[1]).collect()
}

/// Two springs with their apex at 0.2 m, pressed onto a floor or a ball at some height. On the way down, the load is that of the closed form 2 k (1 −
/// l) y/l, even where the apex must be held back. On the floor nothing moves any more, and the floor carries the rest of the load.
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

/// The arch of the scene `snap-through` over obstacles: under the full load it lies on them, and the end of the curve is an equilibrium for Newton's
/// method without arc length, too.
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
        // It snaps through at a height of 0.09 m.
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

/// Half of a shallow arch, cut at its top, whose curve of equilibria winds: at −1 % of the load it turns within less than a step. The computed points
/// are on the curve, none of them twice: each step continues from the previous one, and all step lengths reach the same equilibrium under the full
/// load.
#[test]
fn a_winding_curve_of_equilibria_is_never_gone_back_on_however_long_the_steps() {
    let half_arch = |length: f64| {
        built(plane(
            &(statics(&format!("arc_length = {length:?}\n"))
                + "[[body]]\nname = \"half\"\ndensity = 1000.0\nshape = { kind = \"quadrilateral\", corners = [[0.0, 0.0], [1.0, 0.2], \
                   [1.0, 0.24], [0.0, 0.04]], cells = [20, 2] }\n\
                   models = [{ kind = \"fem\", material = \"st_venant_kirchhoff\", youngs_modulus = 1e6, poissons_ratio = 0.0 }]\n\
                   pin = [{ select = { side = \"right\" }, axes = \"x\" }, { select = { node = 0 }, axes = \"xy\" }]\n\
                   [[load]]\nkind = \"force\"\nbody = \"half\"\nselect = { node = 20 }\nvalue = [0.0, -400.0]\n"),
        ))
    };
    let places = |world: &World<2>| -> Vec<f64> {
        (0..world.node_count(0) as u32).flat_map(|node| world.position(0, node)).collect()
    };
    let mut ends = Vec::new();
    for length in [0.02, 0.013, 0.01] {
        let mut world = half_arch(length);
        let mut last: Option<Vec<f64>> = None;
        let (mut count, mut lowest) = (0, 0.0f64);
        while load(&mut world) < 1.0 {
            let before = places(&world);
            frames(&mut world, 1);
            let way: Vec<f64> = places(&world).iter().zip(&before).map(|(a, b)| a - b).collect();
            let on: f64 = last.iter().flatten().zip(&way).map(|(a, b)| a * b).sum();
            assert!(on >= 0.0, "{length}: step {count} leads back at a load of {}", load(&mut world));
            lowest = lowest.min(load(&mut world));
            last = Some(way);
            count += 1;
            assert!(count < 400, "{length}: {}", load(&mut world));
        }
        // The curve has two minima, neither below minus two hundredths of the load.
        assert!(lowest < -0.009 && lowest > -0.02, "{length}: {lowest}");
        ends.push(world.position(0, 20)[1]);
    }
    for end in &ends {
        assert!((end - ends[2]).abs() < 1e-6, "{ends:?}");
    }
}

/// A run that ends before the end of the curve reports the present fraction of the load; a run that reaches the end does not.
#[test]
fn a_run_that_ends_before_the_whole_load_is_on_is_warned_of() {
    let half = (1.0f64 - 0.04).sqrt();
    let roof = |fields: &str| {
        statics(fields)
            + &format!(
                "[[body]]\nname = \"roof\"\nmass = 1.0\nshape = {{ kind = \"polyline\", points = [[{:?}, 0.0], [0.0, 0.2], \
                 [{half:?}, 0.0]] }}\nmodels = [{{ kind = \"mass_spring\", stiffness = 1000.0 }}]\n\
                 pin = [{{ select = {{ nodes = [0, 2] }} }}, {{ select = {{ node = 1 }}, axes = \"x\" }}]\n\
                 [[load]]\nkind = \"force\"\nbody = \"roof\"\nselect = {{ node = 1 }}\nvalue = [0.0, -30.0]\n",
                -half
            )
    };
    let text = |arc: f64| {
        let whole = roof(&format!("arc_length = {arc:?}\n"));
        whole.replace("seconds = 1\nframe = 1.0\n", "seconds = 1\nframe = 0.125\n")
    };
    let warned = |world: &World<2>| {
        world.warnings().into_iter().find(|w| w.code == "statics.load_left").map(|w| (w.count, w.message))
    };
    let mut short = built(plane(&text(0.007)));
    frames(&mut short, 7);
    assert_eq!(warned(&short), None, "it may still come to its end");
    frames(&mut short, 1);
    let part = load(&mut short);
    let (count, message) = warned(&short).expect("a part of the load is left");
    assert!(part < 1.0 && count == 1, "{part}");
    let said = format!(
        "the last state of body `roof` is the equilibrium under {} of the load",
        opruga::math::words::number(part)
    );
    assert!(message.contains(&said) && message.contains("use more frames, or a longer `arc_length`"), "{message}");
    let mut whole = built(plane(&text(0.2)));
    frames(&mut whole, 8);
    assert!(load(&mut whole) >= 1.0 && warned(&whole).is_none(), "{:?}", warned(&whole));
    let mut plain = built(plane(&roof("")));
    frames(&mut plain, 1);
    assert_eq!(warned(&plain), None);
}
