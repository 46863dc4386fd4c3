//! The fill rules of the parts of a drawing.

use super::drawing_errors::SvgNotice;
use crate::problem::SceneError;
use opruga_mesh::outline::{self, Overlap, Ring};

/// The rule for what is inside if the rings of a part overlap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rule {
    /// The file gives no rule; other programs then use the non-zero rule.
    Unsaid,
    /// Points that an odd number of rings enclose.
    EvenOdd,
    /// Points with a winding number other than zero.
    NonZero,
}

/// Replaces the rings of parts with the non-zero rule by rings that bound the same region under the even-odd rule. Also reports for how many parts
/// without a rule the two rules differ.
pub(super) fn follow(rings: &mut Vec<Ring>, rules: &[Rule]) -> Option<SceneError> {
    let mut differing = 0;
    // Rings are sorted by part.
    let mut followed = Vec::with_capacity(rings.len());
    let mut rest = std::mem::take(rings).into_iter().peekable();
    while let Some(part) = rest.peek().map(|ring| ring.part) {
        let own: Vec<Ring> = std::iter::from_fn(|| rest.next_if(|ring| ring.part == part)).collect();
        let rule = rules.get(part as usize).copied().unwrap_or(Rule::EvenOdd);
        if rule == Rule::EvenOdd {
            followed.extend(own);
            continue;
        }
        let (odd, mut wound) = (outline::joined(&own, Overlap::EvenOdd), outline::wound(&own));
        let area = |rings: &[Ring]| rings.iter().map(Ring::area).sum::<f64>();
        if (area(&wound) - area(&odd)).abs() <= 1e-9 * area(&wound).abs() {
            followed.extend(own);
        } else if rule == Rule::Unsaid {
            differing += 1;
            followed.extend(own);
        } else {
            wound.iter_mut().for_each(|ring| ring.part = part);
            followed.append(&mut wound);
        }
    }
    *rings = followed;
    (differing > 0).then(|| SceneError::of(SvgNotice::FillRule { count: differing }))
}
