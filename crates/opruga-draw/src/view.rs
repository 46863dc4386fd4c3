//! The properties that all pictures of a run share: the part of space, the range of scalars and the scale of arrows.

use crate::picture::{ArrowKind, Legend, Picture};
use std::collections::BTreeMap;

/// The length of a long arrow, as a fraction of the larger side of the view.
const LONG_ARROW: f64 = 0.14;
/// The maximum length of a long arrow, as a fraction of the size of a body.
const ARROW_OF_BODY: f64 = 0.45;

/// The visible part of space, and the common scales of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// The lowest corner of the box that must be visible [m].
    pub low: [f64; 3],
    /// The highest corner of the box that must be visible [m].
    pub high: [f64; 3],
    /// The extreme points [m] of the content in many directions, including shadows. The camera keeps these points in sight.
    pub points: Vec<[f64; 3]>,
    /// The scalars at the ends of the colour map: the smallest and the largest, except for a few outliers. None if there are no scalars.
    pub scalars: Option<[f64; 2]>,
    /// Whether there are outliers below and above the range of `scalars`.
    pub strays: [bool; 2],
    /// Whether y points downwards, as on a screen; only in two dimensions.
    pub y_down: bool,
    /// For each kind of arrow, the magnitude that 95 per cent of its vectors do not exceed, in the unit of its kind.
    pub longest: BTreeMap<ArrowKind, f64>,
    /// The length [m] at which a vector of the magnitude `longest` is drawn.
    pub arrow: f64,
    /// The larger side of most bodies at the start [m]; 0 without bodies.
    pub body: f64,
    /// The angle of the camera around the y axis, from z towards x [degrees]; only in three dimensions.
    pub azimuth: f64,
    /// The angle of the camera above the horizon [degrees]; only in three dimensions.
    pub elevation: f64,
}

impl View {
    /// The larger side of the view [m].
    pub fn extent(&self) -> f64 {
        (0..3).map(|axis| self.high[axis] - self.low[axis]).fold(1e-12, f64::max)
    }

    /// The centre of the view [m].
    pub fn center(&self) -> [f64; 3] {
        std::array::from_fn(|axis| 0.5 * (self.low[axis] + self.high[axis]))
    }

    /// The length of a long arrow beside bodies of a given size [m].
    pub(crate) fn long_arrow(extent: f64, body: f64) -> f64 {
        (LONG_ARROW * extent).min(ARROW_OF_BODY * body)
    }

    /// The drawn length [m] of an arrow of a kind, per unit of its vector.
    pub fn arrow_scale(&self, kind: ArrowKind) -> f64 {
        match self.longest.get(&kind) {
            Some(&longest) if longest > 0.0 => self.arrow / longest,
            _ => 0.0,
        }
    }

    /// The side of the squares of floors and walls [m].
    pub(crate) fn square(&self) -> f64 {
        crate::ticks::nice_length(0.3 * self.extent())
    }

    /// The position of a scalar between the ends of a range, as a fraction from 0 to 1.
    pub(crate) fn fraction(range: [f64; 2], scalar: f64) -> f64 {
        if range[1] > range[0] || scalar.is_nan() { (scalar - range[0]) / (range[1] - range[0]) } else { 0.5 }
    }

    /// The legend of the colours of a picture, if any picture of the run has a value.
    pub(crate) fn legend<'a>(&self, picture: &'a Picture) -> Option<&'a Legend> {
        picture.legend.as_ref().filter(|legend| legend.range.is_some() || self.scalars.is_some())
    }

    /// The range of scalars that a picture uses: its own, or that of the run.
    pub(crate) fn range(&self, picture: &Picture) -> [f64; 2] {
        let own = picture.legend.as_ref().and_then(|legend| legend.range);
        own.or(self.scalars).unwrap_or([0.0, 1.0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::{ArrowPicture, BodyPicture, ColliderPicture};

    #[test]
    fn a_view_reaches_the_floor_and_skips_broken_nodes() {
        let body = BodyPicture {
            positions: vec![[0.0, 1.0, 0.0], [2.0, 2.0, 0.0], [f64::NAN, 0.0, 0.0]],
            ..Default::default()
        };
        let floor = ColliderPicture::HalfSpace { point: [0.0; 3], normal: [0.0, 1.0, 0.0] };
        let picture = Picture { bodies: vec![body], colliders: vec![floor], ..Default::default() };
        let view = View::fit([&picture]).unwrap();
        assert!(view.low[1] < 0.0 && view.low[1] > -0.2);
        assert_eq!(view.high, [2.0, 2.0, 0.0]);
        assert!(View::fit([&Picture::default()]).is_err());
    }

    #[test]
    fn arrows_are_as_long_as_bodies_allow_and_strays_do_not_shorten_them() {
        let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let body = |shift: f64| BodyPicture {
            positions: square.map(|[x, y, z]| [x + shift, y, z]).to_vec(),
            ..Default::default()
        };
        let push = |length: f64| ArrowPicture { kind: ArrowKind::Pressure, from: [0.0; 3], vector: [0.0, length, 0.0] };
        let mut arrows = vec![push(5.0); 99];
        arrows.push(push(5000.0));
        let picture = Picture { bodies: vec![body(0.0), body(99.0)], arrows, ..Default::default() };
        let view = View::fit([&picture]).unwrap();
        assert_eq!(view.longest[&ArrowKind::Pressure], 5.0);
        let drawn = view.arrow_scale(ArrowKind::Pressure) * 5.0;
        assert!((drawn - ARROW_OF_BODY).abs() < 1e-12, "{drawn}: the bodies have a side of 1 m");
        assert_eq!(view.arrow_scale(ArrowKind::Pull), 0.0);
    }
}
