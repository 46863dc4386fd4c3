//! By which rule the parts of a drawing are filled.

use super::drawing_errors::SvgNotice;
use crate::problem::SceneError;
use opruga_mesh::outline::{self, Overlap, Ring};

/// What is inside where the rings of a part lie over one another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rule {
    /// The file does not say, and other programs take the non-zero rule then.
    Unsaid,
    /// What an odd number of rings enclose.
    EvenOdd,
    /// Points around which the rings wind.
    NonZero,
}

/// Makes rings of parts with the non-zero rule into such that the even-odd rule bounds the same; says for how many of those
/// that name no rule the two differ.
pub(super) fn follow(rings: &mut Vec<Ring>, rules: &[Rule]) -> Option<SceneError> {
    let mut differing = 0;
    // Rings come part by part.
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
