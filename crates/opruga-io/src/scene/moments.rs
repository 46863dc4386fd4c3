//! When commands begin and end: with a frame, the first that begins at their time or later. What never comes about by that is told of.

use super::place_of;
use super::reader::{Reader, join};
use crate::document::{Data, Node, Place};
use crate::problem::{SceneError, visible};
use opruga_math::words::number;
use opruga_world::blueprint::Time;
use std::collections::BTreeMap;

/// The code of what is told here.
const NEVER: &str = "command.never";

/// The frames of a run.
pub(crate) struct Frames {
    /// How long each is [s].
    length: f64,
    /// When the run ends [s], where the scene itself says so: an end that an override has set is not that of the scene.
    end: Option<f64>,
}

impl Frames {
    pub(super) fn of(root: &Node, time: &Time) -> Frames {
        let end = root.get("time").and_then(|time| time.get("seconds"));
        let end = end.filter(|node| {
            matches!(node.place, Place::Bytes(..)) && matches!(node.data, Data::Number(..) | Data::Integer(..))
        });
        Frames { length: time.frame, end: end.map(|_| time.seconds) }
    }

    /// The number of the first frame that begins at a time or later, rounded as the world does.
    fn first_from(&self, time: f64) -> f64 {
        (time / self.length - 1e-9).ceil()
    }

    /// Tells of a command that never acts; `until` is the end of one that lasts. Whether it does.
    pub(super) fn command(
        &self,
        reader: &mut Reader<'_>,
        node: &Node,
        path: &str,
        at: f64,
        until: Option<f64>,
    ) -> bool {
        let (key, about) = match (self.end, until) {
            (Some(end), _) if at > end => {
                let message = format!("the command begins at {at} s, after the end at {end} s");
                ("at", SceneError::new(NEVER, message).hint("it only comes about in a run with a larger --seconds"))
            }
            (Some(end), _) if self.first_from(at) >= self.first_from(end) => {
                let message = format!("the command begins at {at} s, and no frame of the run begins then or later");
                let hint = "commands begin with a frame; this one only comes about in a run with a larger --seconds";
                ("at", SceneError::new(NEVER, message).hint(hint))
            }
            (_, Some(until)) if self.first_from(at) >= self.first_from(until) => {
                let message = format!("the command begins at {at} s and ends at {until} s, before a frame begins");
                let key = if node.get("until").is_some() { "until" } else { "path" };
                (key, SceneError::new(NEVER, message).hint(self.rule()))
            }
            _ => return true,
        };
        let about = about.path(join(path, key)).value(if key == "at" { at } else { until.unwrap_or(at) }.to_string());
        reader.notice(place_of(node, key), about);
        false
    }

    /// Tells of parameters that are set again before a frame begins with what they were set to.
    pub(super) fn sets(&self, reader: &mut Reader<'_>, mut sets: Vec<Set>) {
        // In the order in which the world runs them.
        sets.sort_by(|a, b| a.at.total_cmp(&b.at));
        let mut last: BTreeMap<&str, &Set> = BTreeMap::new();
        for set in &sets {
            let Some(before) = last.insert(&set.parameter, set) else { continue };
            if self.first_from(before.at) == self.first_from(set.at) {
                let name = visible(&set.parameter);
                let message =
                    format!("`{name}` is set at {} s and again at {} s, before a frame begins", before.at, set.at);
                let about = SceneError::new(NEVER, message).path(join(&before.path, "at")).value(before.at.to_string());
                reader.notice(before.place, about.hint(self.rule()));
            }
        }
    }

    fn rule(&self) -> String {
        format!(
            "commands begin and end with a frame, the first at their time or later; here one begins every {} s",
            number(self.length)
        )
    }
}

/// A command that sets a parameter.
pub(super) struct Set {
    pub(super) at: f64,
    pub(super) parameter: String,
    /// Where its time stands.
    pub(super) place: Place,
    /// The path of the command.
    pub(super) path: String,
}
