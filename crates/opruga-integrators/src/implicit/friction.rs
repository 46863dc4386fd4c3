//! The friction force on nodes that slip.
//!
//! In the exact minimiser friction acts against the slide w, t = −µ λ w/|w|, and its matrix contains the derivatives. The
//! real-time minimiser keeps a matrix without friction, so t would flip from iteration to iteration if w is small. The real-time
//! minimiser therefore uses a projection instead:
//!
//! ```text
//! t' = t − k w     sticks where |t'| ≤ µ λ, else t = µ λ t'/|t'|
//! ```
//!
//! The fixed point is Coulomb's law for every k > 0. The iteration converges if k is below twice the stiffness of a node whose
//! neighbours follow its motion.
//!
//! # Source
//! P. Alart, A. Curnier, A mixed formulation for frictional contact problems prone to Newton like solution methods, CMAME 92 (1991)
//! 353–375.

use opruga_solve::dot;

/// How friction on a slipping node follows from its slide.
#[derive(Clone, Copy, Debug)]
pub(crate) enum SlipRule {
    /// Friction acts against the slide. A slide that moves a node by less than `tolerance` of the extent counts as zero.
    AgainstSlide { tolerance: f64 },
    /// The previous force, minus the slide times a stiffness, is projected onto Coulomb's cone.
    Projected,
}

/// k as a fraction of the diagonal of the block of a node. Since neighbours move too, the stiffness of a node is less than its
/// block, and k has to stay below twice that stiffness. With 2 instead of 0.5, 20 of 720 steps in the test `real_time_contact`
/// leave a larger residual than promised. With 0.5, only one step does so.
const PART_OF_DIAGONAL: f64 = 0.5;

/// The effect of friction on a slipping node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Followed<const D: usize> {
    /// Friction holds the node.
    Sticks,
    /// Friction acts in this direction.
    Pushes([f64; D]),
    /// The node does not slide, and the known direction remains valid.
    Rests,
}

/// Friction against a slide [m], given the previous direction of friction. A slide below `small` counts as zero.
pub(super) fn against_slide<const D: usize>(slide: &[f64; D], push: &[f64; D], small: f64) -> Followed<D> {
    let size = dot(slide, slide).sqrt();
    if size <= small {
        Followed::Rests
    } else if dot(slide, push) > 0.0 {
        // Friction would act along the slide.
        Followed::Sticks
    } else {
        Followed::Pushes(slide.map(|s| -s / size))
    }
}

/// Friction by projection, from the previous force [N], a slide [m] and the diagonal of the block of a node [N/m]. The friction
/// force is at most `most` [N].
pub(super) fn projected<const D: usize>(slide: &[f64; D], before: &[f64; D], diagonal: f64, most: f64) -> Followed<D> {
    let force: [f64; D] = core::array::from_fn(|d| before[d] - PART_OF_DIAGONAL * diagonal * slide[d]);
    let size = dot(&force, &force).sqrt();
    if size <= most {
        Followed::Sticks
    } else if size > 0.0 {
        Followed::Pushes(force.map(|f| f / size))
    } else {
        Followed::Rests
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A node on a spring of 1 N/m, moved by 0.5 N along x against friction of 0.3 N.
    #[test]
    fn friction_by_projection_settles_against_the_slide_below_twice_the_stiffness() {
        for stiffness in [0.1, 1.0, 1.9] {
            let diagonal = stiffness / PART_OF_DIAGONAL;
            let mut push = [-0.6, 0.8];
            let slide_by = |push: [f64; 2]| [0.5 + 0.3 * push[0], 0.3 * push[1]];
            for _ in 0..400 {
                match projected(&slide_by(push), &push.map(|p| 0.3 * p), diagonal, 0.3) {
                    Followed::Pushes(next) => push = next,
                    other => panic!("{stiffness}: {push:?} {other:?}"),
                }
            }
            let slide = slide_by(push);
            assert!((slide[0] - 0.2).abs() + slide[1].abs() < 1e-9, "{stiffness}: {slide:?}, {push:?}");
        }
    }

    #[test]
    fn friction_by_projection_holds_what_it_can_hold() {
        assert_eq!(projected(&[1e-3, 0.0], &[-0.1, 0.0], 100.0, 0.3), Followed::Sticks);
        assert_eq!(projected(&[1e-3, 0.0], &[-0.3, 0.0], 100.0, 0.3), Followed::Pushes([-1.0, 0.0]));
    }
}
