//! `copies`: many bodies of one shape in rows, columns and layers.

use super::body_list::Bodies;
use super::errors::{FieldError, SceneAllowed, Wanted};
use super::reader::{Reader, join};
use crate::document::{Data, Node};
use crate::problem::SceneError;
use opruga_core::spec::{Allowed, Value};
use opruga_world::blueprint::{BodyBlueprint, PinBlueprint};
use opruga_world::schema;

/// Rows, columns and layers.
#[derive(Clone, Copy)]
pub(super) struct Copies<const D: usize> {
    count: [u32; D],
    spacing: [f64; D],
    first: [f64; D],
    jitter: f64,
}

impl<const D: usize> Copies<D> {
    pub(super) fn total(&self) -> u64 {
        self.count.iter().fold(1u64, |product, n| product.saturating_mul(u64::from(*n)))
    }
}

/// Reads the table.
pub(super) fn copies<const D: usize>(reader: &mut Reader<'_>, node: &Node, path: &str) -> Option<Copies<D>> {
    let values = reader.fields(node, path, &schema::COPIES, None);
    let count = node.get("count")?;
    let here = join(path, "count");
    let Data::Array(items) = &count.data else {
        reader.wrong_type(count, &here, Wanted::Counts);
        return None;
    };
    if items.is_empty() || items.len() > D {
        let about = FieldError::Length { field: "count".into(), count: items.len(), value: count.shown() };
        let error = SceneError::of(about).path(here).allows(SceneAllowed::Counts { dimension: D });
        reader.report(count.location, error);
        return None;
    }
    let mut number = [1u32; D];
    let range = Allowed::Integer { least: 1, greatest: i64::from(u32::MAX) };
    let mut sound = true;
    for (k, item) in items.iter().enumerate() {
        match reader.plain(item, &join(&here, &k.to_string()), "count", &range) {
            Some(Value::Integer(n)) => number[k] = u32::try_from(n).unwrap_or(1),
            _ => sound = false,
        }
    }
    let jitter = values.number("jitter").unwrap_or(0.0);
    sound.then(|| Copies { count: number, spacing: values.vector("spacing"), first: values.vector("first"), jitter })
}

/// Adds the copies of a body to the list. Positions in selectors move along with every copy.
pub(super) fn write_out<const D: usize>(
    bodies: &mut Bodies<D>,
    copies: Copies<D>,
    body: BodyBlueprint<D>,
    seed: u64,
    number: u64,
) {
    let mut random = SplitMix(seed ^ number.wrapping_mul(0xa076_1d64_78bd_642f));
    let first = bodies.list.len();
    let mut offsets = Vec::new();
    for k in 0..copies.total() {
        let mut rest = k;
        let offset: [f64; D] = core::array::from_fn(|a| {
            let along = rest % u64::from(copies.count[a]);
            rest /= u64::from(copies.count[a]);
            let jitter = if copies.jitter > 0.0 { copies.jitter * (2.0 * random.unit() - 1.0) } else { 0.0 };
            copies.first[a] + along as f64 * copies.spacing[a] + jitter
        });
        offsets.push(offset);
        let name = format!("{}[{k}]", body.name);
        bodies.names.entry(name.clone()).or_insert(bodies.list.len());
        bodies.list.push(BodyBlueprint {
            name,
            translation: core::array::from_fn(|a| body.translation[a] + offset[a]),
            pins: body
                .pins
                .iter()
                .map(|pin| PinBlueprint { select: pin.select.moved(offset), ..pin.clone() })
                .collect(),
            ..body.clone()
        });
    }
    bodies.copied.insert(body.name, (first, offsets));
}

/// SplitMix64 (Steele, Lea and Flood 2014): a small generator with the same numbers on every machine.
struct SplitMix(u64);

impl SplitMix {
    /// A uniformly distributed number in [0, 1).
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as f64 / 18_446_744_073_709_551_616.0
    }
}
