//! Drawings whose parts lie over one another, made into rings that do not meet.

use super::Ring;
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::overlay::FloatOverlay;

/// What is inside where parts of a drawing lie over one another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Overlap {
    /// What any part covers: the silhouette. Each part by itself follows the even-odd rule.
    Union,
    /// What an odd number of rings of all parts enclose.
    EvenOdd,
}

/// Rings that bound what is covered, and that meet nowhere; they belong to part 0.
///
/// Coordinates are kept on a grid of about 2⁻³⁰ of the drawing's size.
pub fn joined(rings: &[Ring], how: Overlap) -> Vec<Ring> {
    let contours = |rings: &[&Ring], rule: FillRule| -> Vec<Vec<[f64; 2]>> {
        let all: Vec<Vec<[f64; 2]>> = rings.iter().map(|ring| ring.points.clone()).collect();
        FloatOverlay::<[f64; 2], i32>::from_subj(&all)
            .overlay(OverlayRule::Subject, rule)
            .into_iter()
            .flatten()
            .collect()
    };
    let everything: Vec<&Ring> = rings.iter().collect();
    let rings = match how {
        Overlap::EvenOdd => contours(&everything, FillRule::EvenOdd),
        Overlap::Union => {
            // First every part by itself, then all of them together: outer rings and holes then wind opposite ways.
            let mut parts: Vec<u32> = rings.iter().map(|ring| ring.part).collect();
            parts.sort_unstable();
            parts.dedup();
            let clean: Vec<Ring> = parts
                .into_iter()
                .flat_map(|part| {
                    let own: Vec<&Ring> = rings.iter().filter(|ring| ring.part == part).collect();
                    contours(&own, FillRule::EvenOdd)
                })
                .map(|points| Ring { points, part: 0 })
                .collect();
            contours(&clean.iter().collect::<Vec<_>>(), FillRule::NonZero)
        }
    };
    rings.into_iter().map(|points| Ring { points, part: 0 }).collect()
}
