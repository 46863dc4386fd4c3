//! Offers remedies if a request was refused or a motion has failed, and executes them when the user accepts them.

use super::{Edit, Request, Session};
use crate::document::{Document, read};
use crate::report::Report;
use crate::shown::{Offer, Severity, Shown};
use opruga::core::spec::{Role, Spec, Value, Values};
use opruga::io::Files;
use opruga::world::schema::MOST_SUBSTEPS;
use opruga::{Registries, WorldError, catalogue_of};

/// The integrator that is offered instead of one without a stable step. A step of it takes about the same time.
fn steady(registries: &Registries) -> Option<&'static Spec> {
    catalogue_of(registries).integrators.into_iter().find(|spec| spec.has_role(Role::OfferedExplicit))
}

/// The user is informed about the computing time of a frame if it is longer than this [s].
const LONG: f64 = 1.0;
/// The longest computing time [s] of a frame for which a remedy is offered. During a longer frame, nothing else could be done for too long.
const TOO_LONG: f64 = 4.0;
/// The computing time [s] of a node in a substep: the time that is assumed before anything was measured, and the lower limit.
const NODE: [f64; 2] = [2e-8, 1e-8];
/// The part of the computing time of a substep that does not depend on the number of nodes is assumed to be at most this [s].
const OVERHEAD: f64 = 5e-6;

impl Session {
    pub(super) fn accept(&mut self, offer: &Offer) -> Result<(), Report> {
        self.message = None;
        match offer {
            Offer::HalveStep => {
                self.go_back_a_second()?;
                let substeps = self.engine.shown(&self.show).substeps;
                self.set("time.substeps", Value::Integer(i64::from(substeps) * 2), None)?;
                self.playing = true;
                Ok(())
            }
            Offer::Steady(body, _) => {
                self.go_back_a_second()?;
                let dimension = self.dimension();
                if let Some(spec) = steady(&self.setting.registries) {
                    let values = Values::defaults(spec, dimension);
                    let take = |session: &mut Session, values: &Values| match body {
                        Some(body) => session.change(*body, None, Some(values.clone())),
                        None => session.integrator(values),
                    };
                    match take(self, &values) {
                        // This integrator has a stable step, which may be shorter than the present step.
                        Err(Report::World(WorldError::UnstableStep { substeps, .. }))
                            if substeps <= MOST_SUBSTEPS
                                && self.frame_would_take(self.nodes_now(), with_a_margin(substeps)) <= TOO_LONG =>
                        {
                            self.set("time.substeps", Value::Integer(i64::from(with_a_margin(substeps))), None)?;
                            take(self, &values)?;
                        }
                        outcome => outcome?,
                    }
                }
                self.playing = true;
                Ok(())
            }
            Offer::Substeps(substeps) => {
                let refused = self.refused.take();
                // If a scene could not be opened, the number of substeps of that scene is changed.
                if let Some(Request::Open { name, text, files }) = refused {
                    return self.open_with(&name, &text, files, *substeps);
                }
                self.set("time.substeps", Value::Integer(i64::from(*substeps)), None)?;
                if let Some(request) = refused {
                    self.handle(request);
                }
                Ok(())
            }
            Offer::Coarser(name, field, value) => {
                self.handle(Request::Edit(Edit::Shape(name.clone(), field, Value::Integer(*value))));
                match self.message.as_ref().and_then(|message| message.offer.clone()) {
                    Some(offer @ Offer::Substeps(_)) => self.accept(&offer),
                    _ => Ok(()),
                }
            }
            Offer::Wait(seconds) => {
                self.wait_longer(*seconds);
                Ok(())
            }
            Offer::GoOn => {
                self.leave_the_recording(self.latest);
                self.playing = true;
                self.pacing.rest();
                Ok(())
            }
        }
    }

    fn go_back_a_second(&mut self) -> Result<(), Report> {
        let second = (1.0 / self.engine.frame_seconds()).round() as u64;
        let goal = self.engine.frames().saturating_sub(second);
        self.release();
        self.seek(goal);
        while self.goal.is_some_and(|goal| self.engine.frames() < goal) {
            self.frame().map_err(Report::World)?;
        }
        self.goal = None;
        Ok(())
    }

    /// Returns the remedy that is offered after the motion of a body has failed.
    pub(super) fn offer_after_a_failure(&mut self, body: &str) -> Option<Offer> {
        let shown = self.engine.shown(&self.show);
        let more = 2 * u64::from(shown.substeps) <= u64::from(MOST_SUBSTEPS);
        // If no step is stable, half the step is not stable either.
        let steady = steady(&self.setting.registries);
        let another =
            without_a_stable_step(&shown, body).zip(steady).map(|(body, spec)| Offer::Steady(body, spec.kind));
        another.or(more.then_some(Offer::HalveStep))
    }

    pub(super) fn refuse(&mut self, error: &WorldError, request: Option<Request>) {
        let mut frame_seconds = None;
        let offer = match error {
            WorldError::Diverged { body, .. }
            | WorldError::Step { body, .. }
            | WorldError::NotConverged { body, .. } => self.offer_after_a_failure(body),
            // If more substeps are needed than a frame may have, the message names other remedies.
            WorldError::UnstableStep { substeps, .. } if *substeps <= MOST_SUBSTEPS => {
                let wanted = with_a_margin(*substeps);
                let nodes = self.nodes_with(request.as_ref());
                let seconds = self.frame_would_take(nodes, wanted);
                frame_seconds = (seconds > LONG).then_some(seconds);
                let opens = matches!(request, Some(Request::Open { .. }));
                if seconds > TOO_LONG {
                    self.coarser(request.as_ref(), nodes, wanted)
                } else if opens || *substeps > self.engine.substeps() {
                    self.refused = request;
                    Some(Offer::Substeps(wanted))
                } else {
                    // The request was for fewer substeps, and the number that is needed is not above the present one. Nothing is offered, because the
                    // present number stays.
                    None
                }
            }
            _ => None,
        };
        self.report(Severity::Refused, Report::World(error.clone()), offer);
        if let Some(message) = &mut self.message {
            message.frame_seconds = frame_seconds;
        }
    }

    fn nodes_now(&self) -> usize {
        self.engine.positions().len()
    }

    /// The number of nodes that the scene would have after a request.
    fn nodes_with(&self, request: Option<&Request>) -> usize {
        let now = self.nodes_now();
        let of = |document: &Document, files: &Files| -> Vec<usize> {
            match read(document, files, &self.setting.registries) {
                Ok((blueprint, _)) => blueprint.scene().bodies().map(|body| body.nodes()).collect(),
                Err(_) => Vec::new(),
            }
        };
        match request {
            Some(Request::Open { name, text, files }) => {
                let nodes = Document::new(name, text).map(|document| of(&document, files));
                nodes.map_or(now, |nodes| nodes.iter().sum())
            }
            Some(Request::Edit(Edit::Shape(name, field, value))) => {
                let with = |other: &Value| {
                    let mut table = self.document.body(name)?;
                    table.get_mut("shape")?.as_inline_table_mut()?.insert(*field, crate::document::toml(other));
                    // The pinned nodes of the body do not matter here.
                    table.remove("pin");
                    table.insert("name", self.document.free_name(name).into());
                    let mut bare = self.document.without_nodes();
                    bare.push_body(&table);
                    of(&bare, &self.files).last().copied()
                };
                let old =
                    self.document.shape(name, self.engine.dimension()).and_then(|shape| shape.get(field).cloned());
                let (new, old) = (with(value), old.and_then(|old| with(&old)));
                new.zip(old).map_or(now, |(new, old)| (now + new).saturating_sub(old))
            }
            _ => now,
        }
    }

    /// Estimates the computing time [s] of a frame with this many nodes and substeps, from recent frames. A part of the time of a substep is fixed,
    /// and the rest is proportional to the number of nodes.
    fn frame_would_take(&self, nodes: usize, substeps: u32) -> f64 {
        let now = f64::from(self.engine.substeps().max(1));
        let one = self.pacing.cost() / now;
        let [unknown, least] = NODE;
        let (itself, node) = match one > 0.0 {
            true => (one.min(OVERHEAD), ((one - OVERHEAD) / self.nodes_now().max(1) as f64).max(least)),
            false => (0.0, unknown),
        };
        f64::from(substeps) * (itself + node * nodes as f64)
    }

    /// Offers a shape between the present one and the refused one, for which a frame would not take long.
    fn coarser(&mut self, request: Option<&Request>, nodes: usize, substeps: u32) -> Option<Offer> {
        let Some(Request::Edit(Edit::Shape(name, field, Value::Integer(wanted)))) = request else { return None };
        let shape = self.document.shape(name, self.engine.dimension())?;
        let Some(Value::Integer(now)) = shape.get(field) else { return None };
        let shown = self.engine.shown(&self.show);
        let limited = shown.stable_step.is_finite() && shown.stable_step > 0.0;
        let needed = if limited { shown.frame / shown.stable_step } else { f64::from(shown.substeps) }.max(1.0);
        let ratio = (*wanted as f64 / *now as f64).ln();
        if *now < 1 || ratio <= 0.0 {
            return None;
        }
        // The number of substeps and the number of nodes are assumed to be proportional to powers of the value of the field. The present and the
        // refused value determine the exponents.
        let of_steps = (f64::from(substeps) / needed).ln() / ratio;
        let of_nodes = (nodes as f64 / self.nodes_now().max(1) as f64).ln() / ratio;
        let takes = |value: i64| {
            let larger = (value as f64 / *now as f64).ln();
            let nodes = self.nodes_now() as f64 * (of_nodes * larger).exp();
            self.frame_would_take(nodes as usize, (1.125 * needed * (of_steps * larger).exp()) as u32)
        };
        let (mut good, mut bad) = (*now, *wanted);
        while bad - good > 1 {
            let middle = good + (bad - good) / 2;
            if takes(middle) <= LONG { good = middle } else { bad = middle }
        }
        (good > *now).then(|| Offer::Coarser(name.clone(), field, good))
    }
}

/// If the world warns that no step is stable for the integrator of a body, returns the index of the body, or none if the body uses the integrator of
/// the scene.
fn without_a_stable_step(shown: &Shown, name: &str) -> Option<Option<usize>> {
    let body = shown.bodies.iter().find(|body| body.name == name)?;
    let values = body.integrator.as_ref().or(shown.integrator.as_ref())?;
    let warned = |w: &opruga::Warning| w.is_about("step.no_stable_step", "integrator", values.kind());
    shown.warnings.iter().any(warned).then(|| body.integrator.is_some().then_some(body.number))
}

/// Returns slightly more substeps than the minimum, so that the next change is not refused at once, but never more than a frame may have.
pub(super) fn with_a_margin(substeps: u32) -> u32 {
    substeps.saturating_add(substeps / 8 + 1).min(MOST_SUBSTEPS)
}
