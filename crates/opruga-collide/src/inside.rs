//! Bodies that begin inside an obstacle: how deep they are, and a shift that would free them.

use crate::contacts::Colliders;
use crate::vector::{add, scaled};
use opruga_core::contacts::{Contacts, Touch};

/// A body with nodes inside an obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Buried<const D: usize> {
    /// The number of the obstacle.
    pub collider: usize,
    /// The index of the deepest node among the points.
    pub point: usize,
    /// The number of nodes inside.
    pub count: usize,
    /// The depth of the deepest node, including its margin [m].
    pub depth: f64,
    /// A shift after which no node is inside any obstacle [m]; `None` if no such shift was found.
    pub shift: Option<[f64; D]>,
}

/// A step so short that obstacles hardly move in it [s].
const INSTANT: f64 = 1e-9;
/// The largest number of times that a body is pushed out along the normal of its deepest node.
const PUSHES: usize = 32;
/// The largest number of times that an offset along an axis is doubled, and the number of bisections that follow.
const DOUBLINGS: usize = 12;
const HALVINGS: usize = 20;

impl<const D: usize> Colliders<D> {
    /// Returns the obstacle that contains the deepest node of a body at the start; `None` if no node is deeper than `slack` [m].
    pub fn buried(&self, points: &[[f64; D]], slack: f64) -> Option<Buried<D>> {
        let (point, deepest, count) = self.deepest(points, &[0.0; D], slack)?;
        let collider = self.collider_of(deepest.surface);
        let shift = self.pushed_out(points, slack).or_else(|| self.along_an_axis(points, slack));
        Some(Buried { collider, point, count, depth: -deepest.gap, shift })
    }

    /// The deepest of all points, moved by a shift, and the number of points deeper than `slack`.
    fn deepest(&self, points: &[[f64; D]], shift: &[f64; D], slack: f64) -> Option<(usize, Touch<D>, usize)> {
        let mut deepest: Option<(usize, Touch<D>)> = None;
        let mut count = 0;
        for (number, point) in points.iter().enumerate() {
            let x = add(point, shift);
            let mut inside = false;
            self.touch(&x, &x, 0.0, INSTANT, -slack, &mut |touch| {
                // A node on a thin surface is within the margin that keeps rounding from putting it on the other side. This
                // margin grows with the distance from the origin.
                if -touch.gap <= 1.001 * self.collider(self.collider_of(touch.surface)).margin_of_rounding() {
                    return;
                }
                inside = true;
                if deepest.as_ref().is_none_or(|(_, other)| touch.gap < other.gap) {
                    deepest = Some((number, touch));
                }
            });
            count += usize::from(inside);
        }
        deepest.map(|(number, touch)| (number, touch, count))
    }

    /// The shift that results from pushing the body out repeatedly along the normal of its deepest node.
    fn pushed_out(&self, points: &[[f64; D]], slack: f64) -> Option<[f64; D]> {
        let mut shift = [0.0; D];
        for _ in 0..PUSHES {
            let Some((_, touch, _)) = self.deepest(points, &shift, slack) else { return Some(shift) };
            shift = add(&shift, &scaled(&touch.normal, -touch.gap));
        }
        None
    }

    /// The shortest shift out along a coordinate axis.
    fn along_an_axis(&self, points: &[[f64; D]], slack: f64) -> Option<[f64; D]> {
        let free = |axis: usize, offset: f64| {
            let mut shift = [0.0; D];
            shift[axis] = offset;
            self.deepest(points, &shift, slack).is_none()
        };
        let mut best: Option<(usize, f64)> = None;
        for (axis, sign) in (0..D).flat_map(|axis| [(axis, 1.0), (axis, -1.0)]) {
            let (low, high) = points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), point| {
                (if point[axis] < low { point[axis] } else { low }, if point[axis] > high { point[axis] } else { high })
            });
            let mut out = 0.25 * (high - low);
            let Some(_) = (0..DOUBLINGS).find(|_| {
                out *= 2.0;
                free(axis, sign * out)
            }) else {
                continue;
            };
            let mut inside = 0.0;
            for _ in 0..HALVINGS {
                let middle = 0.5 * (inside + out);
                if free(axis, sign * middle) { out = middle } else { inside = middle }
            }
            if best.is_none_or(|(_, offset)| out < offset.abs()) {
                best = Some((axis, sign * out));
            }
        }
        best.map(|(axis, offset)| {
            let mut shift = [0.0; D];
            shift[axis] = offset;
            shift
        })
    }
}
