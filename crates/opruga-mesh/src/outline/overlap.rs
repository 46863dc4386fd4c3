//! Conversion of drawings with overlapping parts to rings that do not meet.

use super::{Ring, nesting, touching};
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::core::solver::Solver;
use i_overlay::float::overlay::{FloatOverlay, OverlayOptions};

/// The rule that determines the inside of overlapping parts of a drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Overlap {
    /// The area that any part covers: the silhouette. Each part by itself follows the even-odd rule.
    Union,
    /// The area that an odd number of rings of all parts enclose.
    EvenOdd,
}

/// Rings that bound the covered area and do not meet anywhere; they belong to part 0.
///
/// Coordinates are rounded to a grid of about 2⁻³⁰ of the drawing's size. Areas that touch only at points are not connected there: each gets its own
/// corner, which is set back by 2⁻³² of the size of the drawing.
pub fn joined(rings: &[Ring], how: Overlap) -> Vec<Ring> {
    let made = covered(rings, how, false);
    if matches!(nesting::meeting(&made), Ok(None)) {
        return made;
    }
    // Points at which rings touch may be on straight edges too, so none of them may be dropped.
    touching::apart(&covered(rings, how, true))
}

/// Rings that bound the area covered by the non-zero rule, that is, all points around which the given rings wind.
///
/// This function works like [`joined`], but for rings whose directions matter.
pub fn wound(rings: &[Ring]) -> Vec<Ring> {
    let all: Vec<&Ring> = rings.iter().collect();
    let made = numbered(contours(&all, FillRule::NonZero, false));
    if matches!(nesting::meeting(&made), Ok(None)) {
        made
    } else {
        touching::apart(&numbered(contours(&all, FillRule::NonZero, true)))
    }
}

/// The rings of [`joined`] before they are separated, so they may touch. With `all_points`, the rings keep all points on their edges; without it,
/// they have no points on straight lines.
fn covered(rings: &[Ring], how: Overlap, all_points: bool) -> Vec<Ring> {
    let everything: Vec<&Ring> = rings.iter().collect();
    numbered(match how {
        Overlap::EvenOdd => contours(&everything, FillRule::EvenOdd, all_points),
        Overlap::Union => {
            // First, each part is processed separately, so that outer rings and holes have opposite directions; then all of
            // them together.
            let mut by_part = everything;
            by_part.sort_by_key(|ring| ring.part);
            let clean: Vec<Ring> = by_part
                .chunk_by(|a, b| a.part == b.part)
                .flat_map(|own| contours(own, FillRule::EvenOdd, all_points))
                .map(|points| Ring { points, part: 0 })
                .collect();
            contours(&clean.iter().collect::<Vec<_>>(), FillRule::NonZero, all_points)
        }
    })
}

fn numbered(contours: Vec<Vec<[f64; 2]>>) -> Vec<Ring> {
    contours.into_iter().map(|points| Ring { points, part: 0 }).collect()
}

/// The contours of the area covered by a rule, with the area to their left.
fn contours(rings: &[&Ring], rule: FillRule, all_points: bool) -> Vec<Vec<[f64; 2]>> {
    let all: Vec<Vec<[f64; 2]>> = rings.iter().map(|ring| ring.points.clone()).collect();
    let mut options = OverlayOptions::default();
    (options.preserve_input_collinear, options.preserve_output_collinear) = (all_points, all_points);
    FloatOverlay::<[f64; 2], i32>::from_subj_custom(&all, options, Solver::default())
        .overlay(OverlayRule::Subject, rule)
        .into_iter()
        .flatten()
        .collect()
}
