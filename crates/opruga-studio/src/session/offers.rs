//! What is offered where something was refused or a motion has ended, and what becomes of it where a person accepts.

use super::{Request, Session};
use crate::said::Said;
use crate::shown::{Offer, Severity, Shown};
use opruga::core::spec::{Value, Values};
use opruga::world::schema::MOST_SUBSTEPS;
use opruga::{Registry, WorldError};

/// The integrator that is offered instead of one without a stable step: it costs as little.
pub const STEADY: &str = "symplectic_euler";

impl Session {
    pub(super) fn accept(&mut self, offer: &Offer) -> Result<(), Said> {
        self.message = None;
        match offer {
            Offer::HalveStep => {
                self.go_back_a_second()?;
                let substeps = self.engine.shown(&self.show).substeps;
                self.set("time.substeps", Value::Integer(i64::from(substeps) * 2))?;
                self.playing = true;
                Ok(())
            }
            Offer::Steady(body) => {
                self.go_back_a_second()?;
                let dimension = self.dimension();
                if let Some(kind) = Registry::<2>::default().integrator(STEADY) {
                    let values = Values::defaults(kind.spec(), dimension);
                    match body {
                        Some(body) => self.change(*body, None, Some(values))?,
                        None => self.integrator(&values)?,
                    }
                }
                self.playing = true;
                Ok(())
            }
            Offer::Substeps(substeps) => {
                let refused = self.refused.take();
                // A scene that was not opened has substeps of its own.
                if let Some(Request::Open { name, text, files }) = refused {
                    return self.open_with(&name, &text, files, *substeps);
                }
                self.set("time.substeps", Value::Integer(i64::from(*substeps)))?;
                if let Some(request) = refused {
                    self.handle(request);
                }
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

    fn go_back_a_second(&mut self) -> Result<(), Said> {
        let second = (1.0 / self.engine.frame_seconds()).round() as u64;
        let goal = self.engine.frames().saturating_sub(second);
        self.release();
        self.seek(goal);
        while self.goal.is_some_and(|goal| self.engine.frames() < goal) {
            self.frame().map_err(Said::World)?;
        }
        self.goal = None;
        Ok(())
    }

    pub(super) fn refuse(&mut self, error: &WorldError, request: Option<Request>) {
        let offer = match error {
            WorldError::Diverged { body, .. }
            | WorldError::Step { body, .. }
            | WorldError::NotConverged { body, .. } => {
                let shown = self.engine.shown(&self.show);
                let more = 2 * u64::from(shown.substeps) <= u64::from(MOST_SUBSTEPS);
                // Where no step is stable, half of it is not either.
                without_a_stable_step(&shown, body).map(Offer::Steady).or(more.then_some(Offer::HalveStep))
            }
            // Where a frame cannot have as many, the message says what else helps.
            WorldError::UnstableStep { substeps, .. } if *substeps <= MOST_SUBSTEPS => {
                self.refused = request;
                Some(Offer::Substeps(with_a_margin(*substeps)))
            }
            _ => None,
        };
        self.tell(Severity::Refused, Said::World(error.clone()), offer);
    }
}

/// Whether the world warns that no step is stable for the integrator of a body: then its number, or none where it has that of the
/// scene.
fn without_a_stable_step(shown: &Shown, name: &str) -> Option<Option<usize>> {
    let body = shown.bodies.iter().find(|body| body.name == name)?;
    let values = body.integrator.as_ref().or(shown.integrator.as_ref())?;
    let begins = format!("`{}` has", values.kind());
    let warned = |w: &opruga::Warning| w.code == "step.no_stable_step" && w.message.starts_with(&begins);
    shown.warnings.iter().any(warned).then(|| body.integrator.is_some().then_some(body.number))
}

/// A little more substeps than the least, so that the next change does not fail at once; never more than a frame may have.
pub(super) fn with_a_margin(substeps: u32) -> u32 {
    substeps.saturating_add(substeps / 8 + 1).min(MOST_SUBSTEPS)
}
