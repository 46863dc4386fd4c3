//! Gas that is let in, heated, or leaks: amounts and energies compared with their closed forms, in bodies of constant volume.
#![allow(clippy::disallowed_methods)] // expected values of the tests' own

use crate::common;
use common::*;
use opruga::World;
use opruga::core::spec::Value;

/// N R² sin(2π/N)/2 for N = 36, R = 0.5 m, one metre deep [m³].
const VOLUME: f64 = 0.781_416_799_501_186_5;

/// A pinned ring with gas in it.
fn held(gas: &str) -> World<2> {
    built(plane(&format!(
        "{}[[body]]\nname = \"ring\"\nfixed = true\nshape = {{ kind = \"ring\", radius = 0.5, vertices = 36 }}\n\
         models = [{{ kind = \"pressure\", {gas} }}]\n",
        head(0.02, 20, 0.0, "symplectic_euler")
    )))
}

fn reading(world: &mut World<2>, name: &str) -> f64 {
    world.readings(0).into_iter().find(|r| r.0 == name).expect("a reading").1
}

/// The ramp is linear and ends. The energy of the gas that it lets in counts as work on the gas: P V/(γ − 1) for an adiabatic gas.
#[test]
fn a_ramp_lets_the_gas_in_linearly() {
    let mut world = held("nRT = 80.0, ramp = 0.8");
    for frame in 1..=50 {
        frames(&mut world, 1);
        let expected = 80.0 * (f64::from(frame) * 0.02 / 0.8).min(1.0);
        assert!((reading(&mut world, "nRT") - expected).abs() < 1e-9, "frame {frame}");
        assert!((reading(&mut world, "pressure") * VOLUME - expected).abs() < 1e-9, "frame {frame}");
    }
    let mut world = held("pressure = 200.0, process = \"adiabatic\", gamma = 1.4, ramp = 0.5");
    frames(&mut world, 30);
    let expected = 200.0 * VOLUME / 0.4;
    assert!((reading(&mut world, "pressure") - 200.0).abs() < 1e-9);
    assert!((world.energy().work_gas - expected).abs() < 1e-6, "{:?}", world.energy());
    assert!(world.energy().loss_integrator.abs() < 1e-6, "{:?}", world.energy());
}

/// d(nRT)/dt = −λ (P − P_a) V at constant V: nRT = P_a V + (nRT₀ − P_a V) e^(−λt).
#[test]
fn a_leak_brings_the_pressure_down_to_that_outside() {
    for ambient in [0.0, 40.0] {
        let mut world = held(&format!("nRT = 80.0, leak = 1.5, ambient = {ambient:?}"));
        for frame in 1..=200 {
            frames(&mut world, 1);
            let outside = ambient * VOLUME;
            let expected = outside + (80.0 - outside) * (-1.5 * 0.02 * f64::from(frame)).exp();
            let found = reading(&mut world, "nRT");
            assert!((found - expected).abs() < 1e-9, "{ambient} Pa, frame {frame}: {found} {expected}");
        }
        // After 4 s, six times the time constant.
        assert!((reading(&mut world, "pressure") - ambient).abs() < 0.3);
    }
}

/// T/T₀ is linear between the points of its curve and constant after the last.
#[test]
fn temperature_follows_its_curve() {
    let mut world = held("nRT = 80.0, temperature = [[0, 1], [0.4, 1.5], [0.8, 0.5]]");
    for (frame, factor) in [(10, 1.25), (20, 1.5), (30, 1.0), (40, 0.5), (50, 0.5)] {
        while world.frames() < frame {
            frames(&mut world, 1);
        }
        let found = reading(&mut world, "pressure") * VOLUME / 80.0;
        assert!((found - factor).abs() < 1e-9, "frame {frame}: {found}");
    }
}

/// d(nRT)/dt = A/T − λ (P − P_a) V while a ramp of T lets A in: nRT = c (1 − e^(−λt)) with c = A/(λT) + P_a V.
#[test]
fn a_leak_loses_what_a_ramp_has_let_in_and_no_more() {
    for (amount, leak, ambient, ramp) in
        [(50.0, 1.0, 90.0, 1.0), (150.0 * VOLUME, 0.4, 90.0, 0.5), (50.0, 0.5, 0.0, 2.0)]
    {
        let mut world = held(&format!("nRT = {amount:?}, leak = {leak:?}, ambient = {ambient:?}, ramp = {ramp:?}"));
        let most = amount / (leak * ramp) + ambient * VOLUME;
        for frame in 1..=(ramp / 0.02) as u32 {
            frames(&mut world, 1);
            let expected = most * (1.0 - (-leak * 0.02 * f64::from(frame)).exp());
            let found = reading(&mut world, "nRT");
            assert!((found - expected).abs() < 1e-5 * most, "{amount} J, frame {frame}: {found} {expected}");
        }
        // When the ramp has ended, it leaks down to the ambient pressure.
        let full = reading(&mut world, "nRT");
        frames(&mut world, 50);
        let expected = ambient * VOLUME + (full - ambient * VOLUME) * (-leak).exp();
        assert!((reading(&mut world, "nRT") - expected).abs() < 1e-9 * most);
        assert!(world.energy().closure < 1e-9, "{:?}", world.energy());
    }
}

#[test]
fn what_has_leaked_stays_lost_when_the_leak_is_closed_and_setting_the_amount_fills_anew() {
    let mut world = held("nRT = 50.0, leak = 0.5");
    let set = |world: &mut World<2>, field: &str, value: f64| {
        world.set(&format!("body.ring.models.pressure.{field}"), Value::Number(value)).expect("a parameter");
    };
    frames(&mut world, 50);
    let left = 50.0 * (-0.5_f64).exp();
    assert!((reading(&mut world, "nRT") - left).abs() < 1e-9);
    set(&mut world, "leak", 0.0);
    frames(&mut world, 25);
    assert!((reading(&mut world, "nRT") - left).abs() < 1e-9, "nothing comes back");
    set(&mut world, "leak", 0.1);
    frames(&mut world, 50);
    let left = left * (-0.1_f64).exp();
    assert!((reading(&mut world, "nRT") - left).abs() < 1e-9);
    set(&mut world, "nRT", 70.0);
    assert!((reading(&mut world, "nRT") - 70.0).abs() < 1e-9, "filled anew");
    frames(&mut world, 50);
    assert!((reading(&mut world, "nRT") - 70.0 * (-0.1_f64).exp()).abs() < 1e-9);
}

/// However fast it is, a leak brings the pressure to the ambient one and not beyond, from above and from zero.
#[test]
fn a_leak_faster_than_a_step_ends_at_the_pressure_outside() {
    for gas in ["nRT = 50.0", "nRT = 50.0, process = \"adiabatic\"", "nRT = 0.0", "nRT = 0.0, process = \"adiabatic\""]
    {
        let mut world = held(&format!("{gas}, leak = 1e5, ambient = 90.0"));
        frames(&mut world, 3);
        assert!((reading(&mut world, "pressure") - 90.0).abs() < 1e-9, "{gas}");
        assert!((reading(&mut world, "nRT") - 90.0 * VOLUME).abs() < 1e-9, "{gas}");
        assert!(world.energy().closure < 1e-9, "{gas}: {:?}", world.energy());
    }
}

/// Energy changed by a command counts as work: at every moment the energy is the initial energy plus the entries of the ledger.
#[test]
fn the_energy_that_comes_with_a_parameter_is_entered_as_work() {
    let mut world = held("nRT = 50.0, ambient = 20.0");
    let start = world.energy().total();
    for (field, value) in [("ambient", Value::Number(60.0)), ("process", Value::Text("adiabatic".into()))] {
        let before = world.energy();
        world.set(&format!("body.ring.models.pressure.{field}"), value).expect("a parameter");
        frames(&mut world, 2);
        let energy = world.energy();
        assert!((energy.total() - before.total()).abs() > 1.0, "{field}: {energy:?}");
        assert!((energy.total() - start - energy.work_user).abs() < 1e-9, "{field}: {energy:?}");
        assert!(energy.loss_integrator.abs() < 1e-9, "{field}: {energy:?}");
    }
}

/// A gas is given by its amount or its pressure. If the other one is set, by a program or by a command, it replaces the former: the chamber is filled
/// again, whatever had leaked. An earlier snapshot restores the former state.
#[test]
fn a_gas_given_by_its_amount_can_be_set_by_its_pressure() {
    let mut world = held("nRT = 80.0, leak = 1.5");
    frames(&mut world, 20);
    assert!(reading(&mut world, "nRT") < 50.0);
    let before = world.snapshot();
    world.set("body.ring.models.pressure.pressure", Value::Number(200.0)).expect("the amount gives way");
    assert!((reading(&mut world, "pressure") - 200.0).abs() < 1e-9, "{}", reading(&mut world, "pressure"));
    world.set("body.ring.models.pressure.nRT", Value::Number(30.0)).expect("the pressure gives way");
    assert!((reading(&mut world, "nRT") - 30.0).abs() < 1e-9);
    world.set("body.ring.models.pressure.nRT", Value::Number(-1.0)).expect_err("no amount");
    assert!((reading(&mut world, "nRT") - 30.0).abs() < 1e-9);
    world.restore(&before).expect("a snapshot of this world");
    assert!(reading(&mut world, "nRT") < 50.0);
    let command = "[[command]]\ndo = \"set\"\nat = 0.2\npath = \"body.ring.models.pressure.pressure\"\nvalue = 200.0\n";
    let mut world = built(plane(&format!(
        "{}[[body]]\nname = \"ring\"\nfixed = true\nshape = {{ kind = \"ring\", radius = 0.5, vertices = 36 }}\n\
         models = [{{ kind = \"pressure\", nRT = 80.0 }}]\n{command}",
        head(0.02, 20, 0.0, "symplectic_euler")
    )));
    frames(&mut world, 9);
    assert!((reading(&mut world, "nRT") - 80.0).abs() < 1e-9);
    frames(&mut world, 3);
    assert!((reading(&mut world, "pressure") - 200.0).abs() < 1e-9);
}
