//! `pin` of a body: pinned nodes, and pins that prescribe different positions for the same node.

use super::errors::BodyError;
use super::reader::{Reader, join};
use super::{location_of, selectors};
use crate::document::{Location, Node};
use crate::problem::SceneError;
use opruga_core::spec::Values;
use opruga_core::system::along_path;
use opruga_world::blueprint::{BodyBlueprint, PinBlueprint};
use opruga_world::schema;
use opruga_world::selection::longest_side;
use std::collections::BTreeMap;

/// A pin with the location of its selector in the file, and its path.
pub(crate) type Located<const D: usize> = (PinBlueprint<D>, Location, String);

/// The axes that the letters name; all axes if there are none.
pub(crate) fn axes<const D: usize>(reader: &mut Reader<'_>, node: &Node, path: &str, values: &Values) -> [bool; D] {
    let Some(letters) = values.text("axes") else { return [true; D] };
    if D == 2 && letters.contains('z') {
        let error = SceneError::of(BodyError::Axes { letters: letters.into() }).path(join(path, "axes"));
        reader.report(location_of(node, "axes"), error);
    }
    core::array::from_fn(|a| letters.contains(['x', 'y', 'z'][a]))
}

/// Reads a pin.
pub(super) fn pin<const D: usize>(reader: &mut Reader<'_>, node: &Node, path: &str) -> Option<Located<D>> {
    let values = reader.fields(node, path, &schema::PIN, None);
    let axes = axes(reader, node, path, &values);
    node.get("select")?;
    let select = selectors::of(reader, node, path)?;
    let motion = values.rows("motion").to_vec();
    Some((PinBlueprint { select, axes, motion }, location_of(node, "select"), join(path, "select")))
}

/// Reports pins that prescribe different positions of a node along the same axis. Both pins of a pair are named, once for each pair.
pub(super) fn conflicts<const D: usize>(reader: &mut Reader<'_>, pins: &[Located<D>], body: &BodyBlueprint<D>) {
    // Pins at rest cannot conflict: each keeps a node at its position.
    if pins.iter().all(|(pin, ..)| pin.motion.is_empty()) {
        return;
    }
    let size = longest_side(&body.mesh);
    let mut holders: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    let mut reported: Vec<[usize; 2]> = Vec::new();
    for (number, (pin, location, path)) in pins.iter().enumerate() {
        for node in pin.select.resolve(&body.mesh, &body.translation) {
            let others = holders.entry(node).or_default();
            for &other in others.iter() {
                let (first, at, first_path) = &pins[other];
                if reported.contains(&[other, number]) {
                    continue;
                }
                let Some((time, axis)) = parted(first, pin, size) else { continue };
                reported.push([other, number]);
                let line = match at {
                    Location::Bytes(start, _) => Some(reader.source.position(*start).0),
                    Location::Override(_) => None,
                };
                let (body, pin, axis) = (body.name.clone(), first_path.clone(), ["x", "y", "z"][axis]);
                let about = BodyError::PinnedTwice { node, body, pin, line, axis, time };
                reader.report(*location, SceneError::of(about).path(path.as_str()));
            }
            others.push(number);
        }
    }
}

/// The first time [s] at which two pins prescribe different positions along a common axis, and that axis, for a body of a given size [m].
fn parted<const D: usize>(a: &PinBlueprint<D>, b: &PinBlueprint<D>, size: f64) -> Option<(f64, usize)> {
    let mut times: Vec<f64> = a.motion.iter().chain(&b.motion).map(|row| row[0]).collect();
    times.sort_by(f64::total_cmp);
    let shared = |axis: &usize| a.axes[*axis] && b.axes[*axis];
    times.into_iter().find_map(|time| {
        let (p, q) = (along_path::<D>(&a.motion, time).0, along_path::<D>(&b.motion, time).0);
        // Differences due to rounding do not count. They occur if the same motion is given by different rows, or if components vanish by symmetry.
        let apart =
            |axis: &usize| (p[*axis] - q[*axis]).abs() > 1e-9 * (p[*axis].abs() + q[*axis].abs()) + 1e-12 * size;
        (0..D).filter(shared).find(apart).map(|axis| (time, axis))
    })
}
