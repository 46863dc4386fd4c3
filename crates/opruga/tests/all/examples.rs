//! Every example runs, and its output is right.
#![allow(dead_code, reason = "a test calls `run` of an example, cargo calls `main`")]
#![allow(clippy::duplicate_mod, reason = "two examples build on the scene of a third")]

#[path = "../../examples/ball_in_code.rs"]
mod ball_in_code;
#[path = "../../examples/elements_from_arrays.rs"]
mod elements_from_arrays;
#[path = "../../examples/game_loop.rs"]
mod game_loop;
#[path = "../../examples/own_integrator.rs"]
mod own_integrator;
#[path = "../../examples/own_model.rs"]
mod own_model;
#[path = "../../examples/study.rs"]
mod study;

/// A point falls from 1.5 m in √(2 · 1.5 / 9.81) s = 0.553 s; the ball swells first, so its lowest node arrives earlier.
#[test]
fn the_ball_in_code_bounces() {
    let (meets, rises) = ball_in_code::run().expect("it runs");
    assert!((0.4..=0.56).contains(&meets), "it meets the floor after {meets} s");
    assert!((0.1..1.4).contains(&rises), "it rises by {rises} m");
}

#[test]
fn the_game_loop_pulls_spawns_and_despawns() {
    let (lifted, bodies, code) = game_loop::run().expect("it runs");
    assert!(lifted > 0.5, "the pull lifts the ball by {lifted} m");
    assert_eq!((bodies, code), (1, "stale_handle"));
}

#[test]
fn the_own_model_sags_as_the_closed_form_says() {
    let [sag, expected] = own_model::run().expect("it runs");
    assert!((sag - expected).abs() < 1e-3 * expected, "{sag} m instead of {expected} m");
}

/// With symplectic Euler the ring falls ½ g h t too far, where h = 1/1920 s.
#[test]
fn the_own_integrator_is_exact_in_free_fall() {
    let (own, euler) = (own_integrator::run("taylor"), own_integrator::run("symplectic_euler"));
    let (own, euler) = (own.expect("it runs"), euler.expect("it runs"));
    assert!((own - 1.22625).abs() < 1e-9, "{own} m");
    assert!((euler - 1.22625 - 0.5 * 9.81 * 0.5 / 1920.0).abs() < 1e-9, "{euler} m");
}

/// The stress is uniform, which linear tetrahedra represent exactly.
#[test]
fn the_bar_from_arrays_stretches_as_the_closed_form_says() {
    let [found, expected] = elements_from_arrays::run().expect("it runs");
    assert!((found - expected).abs() < 1e-9 * expected, "{found} m instead of {expected} m");
}

#[test]
fn in_the_study_the_ball_bounces_higher_with_more_gas() {
    let found = study::run().expect("it runs");
    assert_eq!(found.iter().map(|row| row.0).collect::<Vec<_>>(), [20.0, 40.0, 80.0, 160.0]);
    assert!(found.windows(2).all(|pair| pair[0].1 < pair[1].1), "{found:?}");
    assert!(found[0].1 > 0.3 && found[3].1 < 1.5, "{found:?}");
}
