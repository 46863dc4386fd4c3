//! How long a run will take, told once where that is long, and what would make it shorter.

use opruga::core::spec::{Role, Value, Values};
use opruga::math::words::{counted, rounded};
use opruga::{Registry, World};

/// So long the first frames are measured [s].
const MEASURED: f64 = 2.0;
/// Runs that take longer are told of [s].
const LONG: f64 = 30.0;
/// More substeps than this are no advice.
const MANY_SUBSTEPS: f64 = 1000.0;

/// Tells once.
#[derive(Default)]
pub(crate) struct Forecast {
    looked: bool,
}

impl Forecast {
    /// A sentence on how long the rest of a run takes, if that is long: `wall` seconds were spent on `done` frames, and
    /// `left` frames are left.
    pub(crate) fn of<const D: usize>(&mut self, world: &World<D>, done: u64, left: u64, wall: f64) -> Option<String> {
        if self.looked || wall < MEASURED || done == 0 {
            return None;
        }
        self.looked = true;
        let each = wall / done as f64;
        let rest = each * left as f64;
        (rest > LONG).then(|| {
            let frames = counted(left, "frame", "frames");
            format!(
                "note: the run will take about {} more ({frames} of {} s). Shorter: {}",
                duration(rest),
                rounded(each, 2),
                shorter(world).join("; ")
            )
        })
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

/// Whether an integrator solves for the end of its steps.
pub(crate) fn is_implicit<const D: usize>(library: &Registry<D>, kind: &str) -> bool {
    let rule = library.integrator(kind).and_then(|rule| rule.build(&Values::defaults(rule.spec(), D)).ok());
    rule.is_some_and(|rule| rule.needs().hessian)
}

/// What would make a run shorter, the most effective first.
fn shorter<const D: usize>(world: &World<D>) -> Vec<String> {
    let library = Registry::<D>::default();
    let mut out = Vec::new();
    let time = world.blueprint().time;
    let rule = &world.blueprint().integrator;
    let implicit = world.integrators().iter().any(|kind| is_implicit(&library, kind));
    if implicit {
        if has_real_time(&library, rule) {
            out.push("--set integrator.accuracy=real_time".to_string());
        }
        if let Some((kind, substeps)) = explicit_substeps(world, &library) {
            out.push(format!("an explicit rule, --set integrator={kind} --set time.substeps={substeps}"));
        }
        if time.substeps > 1 {
            out.push(format!("fewer substeps than {}: implicit rules have no largest stable step", time.substeps));
        }
    } else {
        let limits = world.stability().iter().map(|(_, stability)| stability.largest_stable_step.unwrap_or(0.0));
        let limit = limits.fold(f64::INFINITY, f64::min);
        let enough = (1.2 * time.frame / limit).ceil().max(1.0);
        if enough.is_finite() && enough < 0.8 * f64::from(time.substeps) {
            out.push(format!("--set time.substeps={enough}, which is stable for the shapes at rest"));
        }
    }
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    if world.threads() < cores && (world.islands() > 1 || implicit) {
        out.push(format!("--threads {cores}"));
    }
    out.push("fewer nodes, or an earlier end (--seconds)".into());
    out
}

/// Whether the integrator of a scene has a faster setting that it does not use yet.
fn has_real_time<const D: usize>(library: &Registry<D>, rule: &Values) -> bool {
    let Some(kind) = library.integrator(rule.kind()) else { return false };
    let mut faster = rule.clone();
    let set = faster.set(kind.spec(), "accuracy", Value::Text("real_time".into()), D);
    rule.text("accuracy") == Some("exact") && set.is_ok() && kind.build(&faster).is_ok()
}

/// The explicit rule that is offered, and the substeps at which it would be stable, if these are not many.
fn explicit_substeps<const D: usize>(world: &World<D>, library: &Registry<D>) -> Option<(&'static str, f64)> {
    let kind = library.integrator_with(Role::OfferedExplicit)?;
    let rule = kind.build(&Values::defaults(kind.spec(), D)).ok()?;
    let mut limit = f64::INFINITY;
    for (_, stability) in world.stability() {
        limit = limit.min(stability.spectrum.largest_stable_step(&*rule)?);
    }
    let substeps = (1.2 * world.blueprint().time.frame / limit).ceil().max(1.0);
    (substeps <= MANY_SUBSTEPS).then_some((kind.spec().kind, substeps))
}

#[cfg(test)]
mod tests {
    use super::duration;

    #[test]
    fn durations_are_said_as_people_say_them() {
        let rows = [(31.0, "31 s"), (89.0, "89 s"), (120.0, "2 min"), (5000.0, "83 min"), (12_600.0, "3.5 h")];
        rows.iter().for_each(|(seconds, text)| assert_eq!(duration(*seconds), *text));
    }
}
