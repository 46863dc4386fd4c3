//! The frames with which commands begin and end. Each of these frames is the first frame that begins at the given time or later. Commands that
//! therefore never act are reported.

use super::errors::{CommandError, SceneHint};
use super::location_of;
use super::reader::{Reader, join};
use crate::document::{Data, Location, Node};
use crate::problem::{SceneError, visible};
use opruga_world::blueprint::Time;
use std::collections::BTreeMap;

/// The frames of a run.
pub(crate) struct Frames {
    /// The length of each frame [s].
    length: f64,
    /// The end of the run [s], if the scene itself gives it. An end set by an override does not count.
    end: Option<f64>,
}

impl Frames {
    pub(super) fn of(root: &Node, time: &Time) -> Frames {
        let end = root.get("time").and_then(|time| time.get("seconds"));
        let end = end.filter(|node| {
            matches!(node.location, Location::Bytes(..)) && matches!(node.data, Data::Number(..) | Data::Integer(..))
        });
        Frames { length: time.frame, end: end.map(|_| time.seconds) }
    }

    /// The number of the first frame that begins at or after a time, rounded as in the world.
    fn first_from(&self, time: f64) -> f64 {
        (time / self.length - 1e-9).ceil()
    }

    /// Returns whether a command ever acts, and reports the command if it does not; `until` is the end of a command that lasts.
    pub(super) fn command(
        &self,
        reader: &mut Reader<'_>,
        node: &Node,
        path: &str,
        at: f64,
        until: Option<f64>,
    ) -> bool {
        let (key, about) = match (self.end, until) {
            (Some(end), _) if at > end => ("at", SceneError::of(CommandError::AfterEnd { at, end })),
            (Some(end), _) if self.first_from(at) >= self.first_from(end) => {
                ("at", SceneError::of(CommandError::NoFrame { at }))
            }
            (_, Some(until)) if self.first_from(at) >= self.first_from(until) => {
                let key = if node.get("until").is_some() { "until" } else { "path" };
                (key, SceneError::of(CommandError::BetweenFrames { at, until }).advice(self.rule()))
            }
            _ => return true,
        };
        let about = about.path(join(path, key));
        reader.notice(location_of(node, key), about);
        false
    }

    /// Reports parameters that are set twice before a frame begins, so that the first value has no effect.
    pub(super) fn sets(&self, reader: &mut Reader<'_>, mut sets: Vec<Set>) {
        // Sorted in the order in which the world runs them.
        sets.sort_by(|a, b| a.at.total_cmp(&b.at));
        let mut last: BTreeMap<&str, &Set> = BTreeMap::new();
        for set in &sets {
            let Some(before) = last.insert(&set.parameter, set) else { continue };
            if self.first_from(before.at) == self.first_from(set.at) {
                let (parameter, first, second) = (visible(&set.parameter), before.at, set.at);
                let about = SceneError::of(CommandError::SetAgain { parameter, first, second });
                let about = about.path(join(&before.path, "at")).advice(self.rule());
                reader.notice(before.location, about);
            }
        }
    }

    fn rule(&self) -> SceneHint {
        SceneHint::Frames { frame: self.length }
    }
}

/// A command that sets a parameter.
pub(super) struct Set {
    pub(super) at: f64,
    pub(super) parameter: String,
    /// The location of the time of the command.
    pub(super) location: Location,
    /// The path of the command.
    pub(super) path: String,
}
