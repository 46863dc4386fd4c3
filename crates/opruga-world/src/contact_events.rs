//! Contacts between bodies that began, continue or ended, for programs that ask for them.

use crate::blueprint::BodyBlueprint;
use crate::contact_report::{Contact, ContactPhase};
use crate::warnings::{Warning, WorldWarning};
use crate::world::World;

impl<const D: usize> World<D> {
    /// Turns the report of contacts on or off for the frames that follow. The report is off at the start. While it is off, it costs nothing.
    pub fn report_contacts(&mut self, report: bool) {
        self.contacts = report.then(Vec::new);
    }

    /// The contacts between bodies in the last frame, in ascending order of bodies. The contacts are the same for every number of threads. Empty
    /// unless [`World::report_contacts`] was called.
    ///
    /// Reports are not part of the state: after [`World::restore`] all contacts begin again.
    pub fn contacts(&self) -> &[Contact<D>] {
        self.contacts.as_deref().unwrap_or_default()
    }

    /// Forgets which bodies touched before, and their impulses.
    pub(crate) fn forget_contacts(&mut self) {
        let meetings = self.clusters.iter_mut().flat_map(|clusters| clusters.meetings_mut());
        meetings.for_each(|meeting| meeting.touching.forget_impulses());
        self.contacts.iter_mut().for_each(Vec::clear);
    }

    /// Warns about bodies with different integrators that met in the frame. The warning is issued once, for the first pair, and counts frames and
    /// pairs.
    pub(crate) fn warn_of_mixed_contact(&mut self) {
        const MIXED: &str = "contact.mixed";
        let mixed = || self.clusters.iter().flat_map(|clusters| clusters.meetings()).flat_map(|meeting| &meeting.mixed);
        let count = mixed().count() as u64;
        let Some([first, second]) = mixed().min().map(|pair| pair.map(|body| &self.blueprint.bodies[body])) else {
            return;
        };
        let rule =
            |body: &BodyBlueprint<D>| body.integrator.as_ref().unwrap_or(&self.blueprint.integrator).kind().into();
        let about = WorldWarning::Mixed {
            time: self.time(),
            first: first.name.clone(),
            first_rule: rule(first),
            second: second.name.clone(),
            second_rule: rule(second),
        };
        match self.warnings.iter_mut().find(|warning| warning.code == MIXED) {
            Some(known) => known.count += count,
            None => self.warnings.push(Warning::new(about, count)),
        }
    }

    /// Collects the reports of a frame.
    pub(crate) fn take_contacts(&mut self) {
        let Some(before) = self.contacts.take() else { return };
        let mut now = Vec::new();
        for meeting in self.clusters.iter().flat_map(|clusters| clusters.meetings()) {
            for report in &meeting.touching.reports {
                let bodies = report.bodies.map(|number| meeting.bodies[number as usize]);
                let known = before.binary_search_by_key(&bodies, |contact| contact.bodies);
                let touched = known.is_ok_and(|k| before[k].phase != ContactPhase::Ended);
                let phase = if touched { ContactPhase::Persists } else { ContactPhase::Began };
                now.push(Contact::of(report, bodies, phase));
            }
        }
        now.sort_by_key(|contact| contact.bodies);
        let still = now.len();
        for contact in before.into_iter().filter(|contact| contact.phase != ContactPhase::Ended) {
            let there = contact.bodies.iter().all(|body| self.handle(*body).is_some());
            if there && now[..still].binary_search_by_key(&contact.bodies, |other| other.bodies).is_err() {
                now.push(Contact { phase: ContactPhase::Ended, impulse: [0.0; D], pressed: 0.0, ..contact });
            }
        }
        now.sort_by_key(|contact| contact.bodies);
        self.contacts = Some(now);
    }
}
