//! The law of the gas: pressure and energy as functions of the volume.

use opruga_core::spec::Values;
use opruga_math::Lane;

/// The default of `smallest_volume`. Below this fraction of the rest volume the pressure no longer rises. At this volume, the
/// pressure is fifty times the pressure at rest. With a thousandth instead, a ball that was thrown or shaken hard enough to be
/// flattened gained energy without bound, even with steps far below the stable step, because the steps jumped across the narrow
/// range of high pressure.
pub(super) const SMALLEST_VOLUME: f64 = 0.02;

/// How the temperature of the gas behaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Process {
    /// Constant temperature: P V = nRT.
    Isothermal,
    /// No heat exchange: P V^γ is constant.
    Adiabatic {
        /// The ratio of heat capacities γ > 1.
        gamma: f64,
    },
}

/// The gas of one chamber of one body.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Gas {
    pub(super) process: Process,
    /// nRT at the rest volume [J].
    pub(super) amount: f64,
    /// Rest volume V₀ [m³].
    pub(super) rest_volume: f64,
    /// Ambient pressure [Pa].
    pub(super) ambient: f64,
    /// The volume below which the pressure stays constant, as a fraction of V₀.
    pub(super) smallest_volume: f64,
    /// The largest pressure [Pa].
    pub(super) largest_pressure: Option<f64>,
    /// Length of the start-up ramp [s].
    pub(super) ramp: f64,
    /// Rate of loss [1/s].
    pub(super) leak: f64,
    /// Whether nRT depends on time.
    pub(super) changes: bool,
    /// T/T₀ over time.
    pub(super) temperature: Vec<Vec<f64>>,
}

/// Pressure, energy and slope at a volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GasState {
    /// P [Pa].
    pub(super) pressure: f64,
    /// U(V), including the ambient pressure [J].
    pub(super) energy: f64,
    /// U″(V) = γP/V [Pa/m³], or zero if the pressure is limited.
    pub(super) curvature: f64,
    /// Whether the volume is below the limit.
    pub(super) limited: bool,
}

impl Gas {
    pub(super) fn new(values: &Values, rest_volume: f64) -> Gas {
        let number = |name| values.number(name);
        let process = match values.text("process") {
            Some("adiabatic") => Process::Adiabatic { gamma: number("gamma").unwrap_or(1.4) },
            _ => Process::Isothermal,
        };
        let (ramp, leak) = (number("ramp").unwrap_or(0.0), number("leak").unwrap_or(0.0));
        let temperature = values.rows("temperature").to_vec();
        Gas {
            changes: ramp > 0.0 || leak > 0.0 || !temperature.is_empty(),
            process,
            amount: number("nRT").unwrap_or_else(|| number("pressure").unwrap_or(0.0) * rest_volume),
            rest_volume,
            ambient: number("ambient").unwrap_or(0.0),
            smallest_volume: number("smallest_volume").unwrap_or(SMALLEST_VOLUME),
            largest_pressure: number("largest_pressure"),
            ramp,
            leak,
            temperature,
        }
    }
    /// nRT₀ that has entered up to a time, minus the amount that has been lost [J].
    pub(super) fn cold_at(&self, time: f64, lost: f64) -> f64 {
        let ramp = if self.ramp > 0.0 { (time / self.ramp).larger(0.0).smaller(1.0) } else { 1.0 };
        // If a ramp is lengthened while it lasts, less gas may have entered than was lost.
        (self.amount * ramp - lost).larger(0.0)
    }
    /// T/T₀ at a time.
    pub(super) fn warmth(&self, time: f64) -> f64 {
        if self.temperature.is_empty() {
            return 1.0;
        }
        opruga_core::system::along_path::<1>(&self.temperature, time).0[0]
    }
    /// nRT at the rest volume at a time, after a loss of nRT₀ [J].
    pub(super) fn amount_at(&self, time: f64, lost: f64) -> f64 {
        self.cold_at(time, lost) * self.warmth(time)
    }
    /// The nRT₀ [J] that remains after a leak of h [s] at constant volume.
    ///
    /// With dP/dt = −λ (P − P_a), P becomes P_a + (P − P_a) e^(−λh) for any λh, and the amount of gas changes in proportion to
    /// P.
    pub(super) fn after_leak(&self, cold: f64, warmth: f64, volume: f64, h: f64) -> f64 {
        if self.leak <= 0.0 || warmth <= 0.0 {
            return cold;
        }
        let pressure = self.at(volume, cold * warmth).pressure;
        let kept = Lane::exp(-self.leak * h);
        let after = self.ambient + (pressure - self.ambient) * kept;
        if pressure > 0.0 {
            return cold * (after / pressure);
        }
        // If the chamber is empty, the new amount is the pressure times `unit`, the amount of gas at unit pressure.
        let v = volume.larger(self.smallest_volume * self.rest_volume);
        let unit = match self.process {
            Process::Isothermal => v,
            Process::Adiabatic { gamma } => self.rest_volume * Lane::exp(gamma * Lane::ln(v / self.rest_volume)),
        };
        after * unit / warmth
    }
    /// P V [J] of the gas at the present volume, from nRT at the rest volume: the present value of nRT.
    pub(super) fn heat(&self, volume: f64, amount: f64) -> f64 {
        match self.process {
            Process::Isothermal => amount,
            Process::Adiabatic { gamma } => {
                let mut v = volume.larger(self.smallest_volume * self.rest_volume);
                if let Some(cap) = self.largest_pressure {
                    v = v.larger(self.volume_at(cap, amount));
                }
                amount * Lane::exp((1.0 - gamma) * Lane::ln(v / self.rest_volume))
            }
        }
    }
    /// The state at the volume V, if nRT has this value at the rest volume.
    ///
    /// Below the volume V_s (a fraction of the rest volume, or the volume at which the largest pressure is reached) the
    /// pressure stays P(V_s), and the energy continues along its tangent. The same rule holds at zero volume and for inverted
    /// bodies. U is a function of V with a continuous slope, so no energy is created, and the force still inflates the body.
    pub(super) fn at(&self, volume: f64, amount: f64) -> GasState {
        let v0 = self.rest_volume;
        let mut least = self.smallest_volume * v0;
        if let Some(cap) = self.largest_pressure {
            least = least.larger(self.volume_at(cap, amount));
        }
        let limited = volume < least;
        let v = if limited { least } else { volume };
        let (pressure, mut energy, exponent) = match self.process {
            Process::Isothermal => (amount / v, -amount * Lane::ln(v / v0), 1.0),
            Process::Adiabatic { gamma } => {
                let pressure = amount / v0 * Lane::exp(-gamma * Lane::ln(v / v0));
                (pressure, pressure * v / (gamma - 1.0), gamma)
            }
        };
        if limited {
            energy += pressure * (v - volume);
        }
        GasState {
            pressure,
            energy: energy + self.ambient * volume,
            curvature: if limited { 0.0 } else { exponent * pressure / v },
            limited,
        }
    }
    /// The pressure at a volume, and whether it is limited. A step needs only these two values. For a gas of constant
    /// temperature no logarithm is computed.
    pub(super) fn pressure_at(&self, volume: f64, amount: f64) -> (f64, bool) {
        if self.process == Process::Isothermal {
            let mut least = self.smallest_volume * self.rest_volume;
            if let Some(cap) = self.largest_pressure {
                least = least.larger(amount / cap);
            }
            let limited = volume < least;
            return (amount / if limited { least } else { volume }, limited);
        }
        let state = self.at(volume, amount);
        (state.pressure, state.limited)
    }
    /// The volume at which a pressure is reached [m³].
    fn volume_at(&self, pressure: f64, amount: f64) -> f64 {
        match self.process {
            Process::Isothermal => amount / pressure,
            Process::Adiabatic { gamma } => {
                let ratio = amount / self.rest_volume / pressure;
                if ratio > 0.0 { self.rest_volume * Lane::exp(Lane::ln(ratio) / gamma) } else { 0.0 }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use opruga_core::spec::Value;

    fn gas(process: &str) -> Gas {
        let spec = &super::super::SPEC;
        let mut values = Values::defaults(spec, 2);
        for (name, value) in [
            ("nRT", Value::Number(100.0)),
            ("leak", Value::Number(0.5)),
            ("ambient", Value::Number(30.0)),
            ("process", Value::Text(process.into())),
        ] {
            values.set(spec, name, value, 2).expect("allowed");
        }
        Gas::new(&values, 1.0)
    }

    /// dP/dt = −λ (P − P_a) at constant volume, however compressed the gas is.
    #[test]
    fn a_leak_is_as_fast_in_a_compressed_gas_of_either_process() {
        for process in ["isothermal", "adiabatic"] {
            let gas = gas(process);
            for volume in [0.4, 1.0, 1.7] {
                let before = gas.at(volume, 100.0);
                let after = gas.at(volume, gas.after_leak(100.0, 1.0, volume, 0.8));
                let expected = 30.0 + (before.pressure - 30.0) * Lane::exp(-0.4);
                assert!((after.pressure - expected).abs() < 1e-12 * expected, "{process}, {volume} m³");
                assert!((gas.heat(volume, 100.0) - before.pressure * volume).abs() < 1e-12 * 100.0, "{process}");
            }
        }
    }
}
