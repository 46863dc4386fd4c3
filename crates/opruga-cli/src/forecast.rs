//! Estimates the duration of a run. A long duration is reported, with ways to make the run shorter.

use crate::errors::{CallNote, Shorter};
use opruga::core::spec::{Role, Value, Values};
use opruga::math::words::rounded;
use opruga::{AnyBody, AnyWorld};

/// The least time over which frames are measured [s].
const MEASURED: f64 = 2.0;
/// Runs that take longer than this time are reported [s].
const LONG: f64 = 30.0;
/// If a run takes this many times as long as reported, it is reported again.
const TOO_LOW: f64 = 3.0;
/// The largest number of substeps that is suggested.
const MANY_SUBSTEPS: f64 = 1000.0;

/// Reports the duration, and again if it turns out to be much longer.
#[derive(Default)]
pub(crate) struct Forecast {
    /// The time and the frames at the end of the last measurement [s].
    measured: (f64, u64),
    /// The time at which the run should end according to the last report [s].
    end: f64,
}

impl Forecast {
    /// The remaining time of a run, if it is long: `wall` seconds were spent on `done` frames, and `left` frames remain. Each measurement covers the
    /// frames since the previous one, because later frames may take longer: bodies meet.
    pub(crate) fn of(&mut self, world: &dyn AnyWorld, done: u64, left: u64, wall: f64) -> Option<CallNote> {
        let each = self.frame_time_if_too_low(done, left, wall)?;
        let rest = each * left as f64;
        Some(CallNote::TakesLong { duration: duration(rest), frames: left, each, shorter: shorter(world) })
    }

    /// The time of a frame, if the run takes long and much longer than reported.
    fn frame_time_if_too_low(&mut self, done: u64, left: u64, wall: f64) -> Option<f64> {
        let (before, first) = self.measured;
        if wall - before < MEASURED || done == first {
            return None;
        }
        self.measured = (wall, done);
        let each = (wall - before) / (done - first) as f64;
        let rest = each * left as f64;
        let expected = self.end - wall;
        if rest <= LONG || rest <= TOO_LOW * expected {
            return None;
        }
        self.end = wall + rest;
        Some(each)
    }
}

/// `50 s`, `6 min`, `3.5 h`.
pub(crate) fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 90.0 => format!("{} s", s.round()),
        s if s < 90.0 * 60.0 => format!("{} min", (s / 60.0).round()),
        s => format!("{} h", rounded(s / 3600.0, 2)),
    }
}

/// For each integrator in use, whether it is implicit.
fn implicit(world: &dyn AnyWorld) -> impl Iterator<Item = bool> {
    let scene = world.scene();
    let own = world.bodies().into_iter().filter_map(|body| scene.body(body)).map(AnyBody::integrator);
    // A world without bodies has the integrator of its scene.
    let mut all: Vec<&Values> = own.map(|own| own.unwrap_or(scene.integrator())).collect();
    if all.is_empty() {
        all.push(scene.integrator());
    }
    all.into_iter().map(|integrator| world.is_implicit(integrator))
}

/// Whether every body has an implicit integrator.
pub(crate) fn is_implicit(world: &dyn AnyWorld) -> bool {
    implicit(world).all(|implicit| implicit)
}

/// Ways to make a run shorter, the most effective first.
fn shorter(world: &dyn AnyWorld) -> Shorter {
    let mut out = Vec::new();
    let (time, integrator) = (world.scene().time(), world.scene().integrator());
    let implicit = implicit(world).any(|implicit| implicit);
    if implicit {
        if has_real_time(world, integrator) {
            out.push(Shorter::RealTime {});
        }
        if let Some((integrator, substeps)) = explicit_substeps(world).filter(|_| world.is_implicit(integrator)) {
            out.push(Shorter::Explicit { integrator, substeps });
        }
        if time.substeps > 1 {
            out.push(Shorter::FewerSubsteps { substeps: time.substeps });
        }
    } else {
        let limits = world.stability().iter().map(|(_, stability)| stability.largest_stable_step.unwrap_or(0.0));
        let limit = limits.fold(f64::INFINITY, f64::min);
        let enough = (1.2 * time.frame / limit).ceil().max(1.0);
        if enough.is_finite() && enough < 0.8 * f64::from(time.substeps) {
            out.push(Shorter::Substeps { substeps: enough as u32 });
        }
    }
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    if world.threads() < cores && (world.islands() > 1 || implicit) {
        out.push(Shorter::Threads { threads: cores });
    }
    let list = |rest, first| Shorter::List { first: Box::new(first), rest: Box::new(rest) };
    out.into_iter().rev().fold(Shorter::Less {}, list)
}

/// Whether the integrator of a scene has a faster setting that is not in use.
fn has_real_time(world: &dyn AnyWorld, integrator: &Values) -> bool {
    let mut faster = integrator.clone();
    let set = faster.set(integrator.spec(), "accuracy", Value::Text("real_time".into()), world.scene().dimension());
    integrator.text("accuracy") == Some("exact") && set.is_ok() && world.is_implicit(&faster)
}

/// The explicit integrator to suggest, and the number of substeps with which it would be stable, if that is not large.
fn explicit_substeps(world: &dyn AnyWorld) -> Option<(&'static str, u32)> {
    let spec = world.integrator_with(Role::OfferedExplicit)?;
    let limit = world.stable_step_under(&Values::defaults(spec, world.scene().dimension()))?;
    let substeps = (1.2 * world.scene().time().frame / limit).ceil().max(1.0);
    (substeps <= MANY_SUBSTEPS).then_some((spec.kind, substeps as u32))
}

#[cfg(test)]
mod tests {
    use super::{Forecast, duration};

    #[test]
    fn a_run_is_reported_again_if_it_takes_much_longer_than_expected() {
        let mut forecast = Forecast::default();
        let mut at = |done, left, wall| forecast.frame_time_if_too_low(done, left, wall);
        assert_eq!(at(10, 990, 1.0), None, "too early");
        assert_eq!(at(20, 980, 2.0), Some(0.1), "98 s");
        assert_eq!(at(40, 960, 6.0), None, "192 s are not much longer");
        assert_eq!(at(50, 950, 11.0), Some(0.5), "475 s");
        assert_eq!(at(60, 940, 21.0), None, "940 s are not much longer");
        let mut forecast = Forecast::default();
        assert_eq!(forecast.frame_time_if_too_low(20, 80, 2.0), None, "8 s are short");
        assert_eq!(forecast.frame_time_if_too_low(22, 78, 6.0), Some(2.0), "156 s");
    }

    #[test]
    fn durations_are_said_as_people_say_them() {
        let rows = [(31.0, "31 s"), (89.0, "89 s"), (120.0, "2 min"), (5000.0, "83 min"), (12_600.0, "3.5 h")];
        rows.iter().for_each(|(seconds, text)| assert_eq!(duration(*seconds), *text));
    }
}
