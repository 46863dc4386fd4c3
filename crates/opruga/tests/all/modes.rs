//! Natural frequencies against closed forms.
#![allow(clippy::disallowed_methods)] // expected values of the tests' own

use crate::common;

use common::{built, frames, head, plane};

/// A chain of N equal springs, pinned at one end, with half a mass at the other: ω = 2 √(k/m) sin((2n − 1) π/4N), which tends to (2n − 1) c/4L of the
/// bar (validation B4); nothing resists transverse displacements.
#[test]
fn a_chain_swings_along_itself_as_a_bar() {
    let (springs, stiffness, mass) = (20, 800.0, 0.05);
    let text = head(0.001, 1, 0.0, "verlet")
        + &format!(
            "[[body]]\nname = \"chain\"\nshape = {{ kind = \"line\", from = [0.0, 0.0], to = [2.0, 0.0], segments = {springs} }}\n\
             mass = {:?}\nmodels = [ {{ kind = \"mass_spring\", stiffness = {stiffness:?} }} ]\n\
             pin = [ {{ select = {{ all = true }}, axes = \"y\" }}, {{ select = {{ node = 0 }}, axes = \"x\" }} ]\n",
            mass * f64::from(springs)
        );
    let world = built(plane(&text));
    // Masses are proportional to lengths: half of one at each end.
    assert!((world.node_mass(0, springs as u32) - 0.5 * mass).abs() < 1e-12);
    let modes = world.modes(0, 8).unwrap();
    assert_eq!(modes.len(), 8);
    for (n, mode) in modes.iter().enumerate() {
        let angle = core::f64::consts::PI * f64::from(2 * n as u32 + 1) / f64::from(4 * springs);
        let omega = 2.0 * (stiffness / mass).sqrt() * angle.sin();
        assert!((mode.omega() / omega - 1.0).abs() < 1e-10, "mode {n}: {} {omega}", mode.omega());
        assert!(mode.rigid.is_none() && mode.residual < 1e-6 * omega * omega);
    }
}

/// A ring of springs at rest around a gas at ambient pressure: the breathing mode has ω² = 2 γ P N sin(2π/N)/M, which tends to 4πγP/M (validation
/// B3), plus 4 k sin²(π/N)/m of the springs; the free ring has three rigid modes.
#[test]
fn a_ring_breathes_at_the_frequency_of_its_gas_and_springs() {
    let (nodes, radius, pressure, mass, stiffness) = (16u32, 0.5f64, 100.0f64, 2.0f64, 50.0f64);
    let pi = core::f64::consts::PI;
    let area = 0.5 * f64::from(nodes) * radius * radius * (2.0 * pi / f64::from(nodes)).sin();
    for gamma in [1.0, 1.4] {
        let gas = if gamma == 1.0 { String::new() } else { format!(", process = \"adiabatic\", gamma = {gamma:?}") };
        let text = head(0.001, 1, 0.0, "verlet")
            + &format!(
                "[[body]]\nname = \"ring\"\nshape = {{ kind = \"ring\", radius = {radius:?}, vertices = {nodes} }}\nmass = {mass:?}\n\
                 models = [ {{ kind = \"mass_spring\", stiffness = {stiffness:?} }}, {{ kind = \"pressure\", nRT = {:?}, \
                 ambient = {pressure:?}{gas} }} ]\n",
                pressure * area
            );
        let world = built(plane(&text));
        let modes = world.modes(0, 2 * nodes as usize).unwrap();
        assert_eq!(modes.len(), 2 * nodes as usize);
        let rigid: Vec<&str> = modes.iter().filter_map(|mode| mode.rigid.as_deref()).collect();
        assert_eq!(rigid, ["translation along x", "translation along y", "rotation"]);
        let n = f64::from(nodes);
        let expected = 2.0 * gamma * pressure * n * (2.0 * pi / n).sin() / mass
            + 4.0 * stiffness * (pi / n).sin().powi(2) * n / mass;
        // The mode in which all nodes move outward equally.
        let outward = |shape: &[[f64; 2]]| -> f64 {
            let along = |k: usize| {
                let x = world.position(0, k as u32);
                (shape[k][0] * x[0] + shape[k][1] * x[1]) / radius
            };
            (0..shape.len()).map(along).sum::<f64>().abs() * (mass / n).sqrt() / n.sqrt()
        };
        let breathing = modes.iter().find(|mode| outward(&mode.shape) > 0.99).expect("a breathing mode");
        assert!((breathing.square / expected - 1.0).abs() < 1e-9, "γ = {gamma}: {} {expected}", breathing.square);
    }
}

/// A mass between two springs that their pins compress: it is unstable across their axis.
#[test]
fn an_unstable_state_has_a_negative_square() {
    let text = head(0.001, 1, 0.0, "verlet")
        + "[[body]]\nname = \"strut\"\nshape = { kind = \"line\", from = [0.0, 0.0], to = [2.0, 0.0], segments = 2 }\nmass = 4.0\n\
           models = [ { kind = \"mass_spring\", stiffness = 100.0, rest_scale = 1.2 } ]\n\
           pin = [ { select = { nodes = [0, 2] }, axes = \"xy\" } ]\n";
    let mut world = built(plane(&text));
    let modes = world.modes(0, 2).unwrap();
    // Transverse 2 k (1 − l₀/l)/m, axial 2 k/m, with m = 2 kg in the middle.
    assert!((modes[0].square + 2.0 * 100.0 * 0.2 / 2.0).abs() < 1e-9 && modes[0].omega() == 0.0, "{modes:?}");
    assert!((modes[1].square - 2.0 * 100.0 / 2.0).abs() < 1e-9, "{modes:?}");
    frames(&mut world, 1);
    assert!(world.modes(5, 1).is_err());
}

/// If the search for modes would exceed its memory limit, it is refused before it begins.
#[test]
fn more_modes_than_memory_allows_are_refused() {
    let text = head(0.001, 1, 0.0, "backward_euler")
        + "[[body]]\nname = \"plate\"\nshape = { kind = \"grid\", size = [1.0, 1.0], cells = [75, 75] }\nmass = 1.0\n\
           models = [ { kind = \"mass_spring\", stiffness = 100.0 } ]\n";
    let refused = built(plane(&text)).modes(0, usize::MAX).unwrap_err();
    assert_eq!(refused.code(), "modes.memory");
}
