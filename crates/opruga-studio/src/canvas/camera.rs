//! The view of a scene in the plane.

use crate::shown::Shown;
use egui::{Pos2, Rect, Vec2};
use opruga::draw::View;

/// The margin around a scene [points].
const BORDER: f32 = 36.0;
/// The height [points] that is assumed for the tools above a scene before they were drawn.
const TOOLS: f32 = 50.0;

/// The point at the centre and the scale.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Flat {
    center: [f64; 2],
    /// Points of the screen per metre.
    pub(crate) scale: f64,
    /// The height of captions below a scene [points].
    pub(crate) foot: f32,
}

impl Default for Flat {
    fn default() -> Flat {
        Flat { center: [0.0; 2], scale: 100.0, foot: 0.0 }
    }
}

impl Flat {
    /// Shows the whole of a view below the tools and above the captions.
    pub(crate) fn fit(&mut self, view: &View, rect: Rect, tools: Option<Rect>) {
        let tools =
            tools.map_or(TOOLS, |tools| tools.bottom() - rect.top()).clamp(TOOLS, (0.5 * rect.height()).max(TOOLS));
        // There is space around the bodies, because they move.
        let wide = (view.high[0] - view.low[0]).max(1e-9) * 1.25;
        let tall = (view.high[1] - view.low[1]).max(1e-9) * 1.1;
        let high = rect.height() - BORDER - tools - self.foot;
        let available = [f64::from((rect.width() - BORDER).max(8.0)), f64::from(high.max(8.0))];
        self.scale = (available[0] / wide).min(available[1] / tall);
        let up = if view.y_down { -0.5 } else { 0.5 };
        self.center = [view.center()[0], view.center()[1] + up * f64::from(tools - self.foot) / self.scale];
    }

    /// Widens a view in the plane if a body leaves it and the user has not moved the view. Each side moves by at most twice the size of the first
    /// view. If bodies go farther, the view keeps its size and follows them if they fit into it. Returns whether the view changed.
    pub(crate) fn widen(&self, view: &mut View, first: &[[f64; 3]; 2], shown: &Shown, rect: Rect) -> bool {
        if shown.dimension != 2 {
            return false;
        }
        let corners = [rect.min, rect.max].map(|corner| self.to_world(rect, corner, view.y_down));
        let mut ends = [[f64::MAX, f64::MIN]; 2];
        for [lowest, highest] in shown.extents.iter().map(|extent| extent.corners) {
            for (d, [low, high]) in ends.iter_mut().enumerate() {
                (*low, *high) = (low.min(lowest[d]), high.max(highest[d]));
            }
        }
        // The view also includes the scene beside this one, as far as it may widen, unless it follows bodies.
        let limits = [0, 1].map(|d| {
            let most = 2.0 * (first[1][d] - first[0][d]);
            [first[0][d] - most, first[1][d] + most]
        });
        let beside = shown.beside.iter().flat_map(|beside| &beside.right.extents);
        for [lowest, highest] in beside.map(|extent| extent.corners) {
            for (d, [low, high]) in ends.iter_mut().enumerate() {
                let [least, most] = limits[d];
                if *low >= least && *high <= most {
                    (*low, *high) = (low.min(lowest[d].max(least)), high.max(highest[d].min(most)));
                }
            }
        }
        let mut wider = false;
        for d in 0..2 {
            let most = 2.0 * (first[1][d] - first[0][d]);
            let [low, high] = ends[d];
            let seen = [corners[0][d].min(corners[1][d]), corners[0][d].max(corners[1][d])];
            let edge = 0.02 * (seen[1] - seen[0]);
            if low < first[0][d] - most || high > first[1][d] + most {
                // If bodies are farther away than the view may widen, the view keeps its size and follows them.
                let over = [seen[0] + edge - low, high - seen[1] + edge];
                if high - low + 2.0 * edge < seen[1] - seen[0] && over.iter().any(|over| *over > 0.0) {
                    let shift = if over[1] > 0.0 { over[1] } else { -over[0] };
                    (view.low[d], view.high[d]) = (view.low[d] + shift, view.high[d] + shift);
                    wider = true;
                }
                continue;
            }
            let (low, high) = (low.max(first[0][d] - most), high.min(first[1][d] + most));
            let below = seen[0] + edge - low;
            let above = high - seen[1] + edge;
            if below > 0.0 && view.low[d] > first[0][d] - most {
                view.low[d] -= below;
                wider = true;
            }
            if above > 0.0 && view.high[d] < first[1][d] + most {
                view.high[d] += above;
                wider = true;
            }
            // If the view has followed bodies that have now returned, the part of the view that they have left is dropped.
            let widest = first[1][d] - first[0][d] + 2.0 * most;
            if wider && view.high[d] - view.low[d] > widest {
                if above > 0.0 {
                    view.low[d] = view.high[d] - widest;
                } else {
                    view.high[d] = view.low[d] + widest;
                }
            }
        }
        wider
    }

    pub(crate) fn to_screen(self, rect: Rect, point: [f64; 3], y_down: bool) -> Pos2 {
        let sign = if y_down { 1.0 } else { -1.0 };
        let x = self.scale * (point[0] - self.center[0]);
        let y = sign * self.scale * (point[1] - self.center[1]);
        // Points far outside are not visible, and the painter cannot handle very large numbers or NaN.
        let sane = |x: f64| if x.is_nan() { 1e5 } else { x.clamp(-1e5, 1e5) } as f32;
        rect.center() + Vec2::new(sane(x), sane(y))
    }

    pub(crate) fn to_world(self, rect: Rect, at: Pos2, y_down: bool) -> [f64; 2] {
        let sign = if y_down { 1.0 } else { -1.0 };
        let from = at - rect.center();
        [self.center[0] + f64::from(from.x) / self.scale, self.center[1] + sign * f64::from(from.y) / self.scale]
    }

    /// Moves the view along with the pointer.
    pub(crate) fn pan(&mut self, delta: Vec2, y_down: bool) {
        let sign = if y_down { 1.0 } else { -1.0 };
        self.center[0] -= f64::from(delta.x) / self.scale;
        self.center[1] -= sign * f64::from(delta.y) / self.scale;
    }

    /// Zooms about the point under the pointer.
    pub(crate) fn zoom(&mut self, factor: f64, rect: Rect, at: Pos2, y_down: bool) {
        let before = self.to_world(rect, at, y_down);
        self.scale = (self.scale * factor).clamp(1e-6, 1e9);
        let after = self.to_world(rect, at, y_down);
        self.center = [self.center[0] + before[0] - after[0], self.center[1] + before[1] - after[1]];
    }

    /// The point at the centre [m].
    pub(crate) fn middle(&self) -> [f64; 3] {
        [self.center[0], self.center[1], 0.0]
    }

    /// Converts a number of points on the screen to a length [m].
    pub(crate) fn metres(&self, points: f64) -> f64 {
        points / self.scale
    }
}

/// Extends a view to the floors and walls that bodies may reach, because bodies are often far above them at the start.
pub(super) fn with_floors(mut view: View, shown: &Shown) -> View {
    let center = view.center();
    let size = view.extent();
    for collider in &shown.picture.colliders {
        let opruga::draw::ColliderPicture::HalfSpace { point, normal } = collider else { continue };
        let long = normal.iter().map(|n| n * n).sum::<f64>();
        let height = (0..3).map(|d| normal[d] * (center[d] - point[d])).sum::<f64>() / long.max(1e-300);
        let foot = [0, 1, 2].map(|d| center[d] - height * normal[d]);
        // A distant floor is not included, because everything would then look small.
        if foot.iter().zip(&center).all(|(a, b)| (a - b).abs() < 8.0 * size) {
            for d in 0..3 {
                view.low[d] = view.low[d].min(foot[d] - 0.05 * size);
                view.high[d] = view.high[d].max(foot[d] + 0.05 * size);
            }
        }
    }
    if shown.dimension == 2 {
        (view.low[2], view.high[2]) = (0.0, 0.0);
    }
    view
}

/// The areas of the scene and of the scene beside it. They are next to each other or, in a tall window, one above the other.
pub(super) fn halves(whole: Rect, two: bool) -> (Rect, Option<Rect>) {
    if !two {
        return (whole, None);
    }
    let (first, second) = if whole.width() >= whole.height() {
        whole.split_left_right_at_fraction(0.5)
    } else {
        whole.split_top_bottom_at_fraction(0.5)
    };
    (first, Some(second))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shown::Extent;

    #[test]
    fn a_view_that_nobody_has_moved_widens_for_a_body_that_leaves_it_and_then_goes_along() {
        let rect = Rect::from_min_size(Pos2::ZERO, Vec2::new(390.0, 600.0));
        let ball = |x: f64| opruga::draw::BodyPicture {
            positions: vec![[x - 0.5, 0.0, 0.0], [x + 0.5, 1.0, 0.0]],
            ..Default::default()
        };
        let shown = |x: f64| Shown {
            dimension: 2,
            extents: vec![Extent::of(&ball(x))],
            picture: opruga::draw::Picture { dimension: 2, bodies: vec![ball(x)], ..Default::default() },
            ..Default::default()
        };
        let mut view = View::fit([&shown(0.0).picture]).expect("a view");
        let (first, mut flat) = ([view.low, view.high], Flat::default());
        flat.fit(&view, rect, None);
        assert!(!flat.widen(&mut view, &first, &shown(0.0), rect), "what is seen whole stays as it is");
        for step in 0..400 {
            let x = 0.01 * f64::from(step);
            if flat.widen(&mut view, &first, &shown(x), rect) {
                flat.fit(&view, rect, None);
            }
            let right = flat.to_screen(rect, [x + 0.5, 0.5, 0.0], false);
            assert!(rect.contains(right), "{x} {right:?}");
        }
        assert!(view.high[0] - view.low[0] < 4.0, "it grows for ever: {:?}", view.high);
        // When the bodies are back at the start, the view is as wide as before.
        for _ in 0..3 {
            if flat.widen(&mut view, &first, &shown(0.0), rect) {
                flat.fit(&view, rect, None);
            }
        }
        assert!(rect.contains(flat.to_screen(rect, [-0.5, 0.5, 0.0], false)), "it is seen again");
        assert!(view.high[0] - view.low[0] <= 5.0 * (first[1][0] - first[0][0]) + 1e-9, "{:?}", view.high);
        // Two bodies that fly apart do not fit into the view, so it does not move.
        let mut apart = shown(0.0);
        apart.picture.bodies = vec![ball(-40.0), ball(40.0)];
        apart.extents = apart.picture.bodies.iter().map(Extent::of).collect();
        assert!(!flat.widen(&mut view, &first, &apart, rect));
        // The view also includes the scene beside this one, as far as both fit into it.
        let mut both = shown(0.0);
        for (x, there) in [(1.5, true), (40.0, false)] {
            let right = std::sync::Arc::new(shown(x));
            let (distances, center, volume, energy, stopped) = (None, None, None, None, None);
            let differences = Vec::new();
            let beside = crate::shown::Beside { right, distances, center, volume, energy, differences, stopped };
            both.beside = Some(beside);
            for _ in 0..3 {
                if flat.widen(&mut view, &first, &both, rect) {
                    flat.fit(&view, rect, None);
                }
            }
            assert_eq!(rect.contains(flat.to_screen(rect, [x + 0.5, 0.5, 0.0], false)), there, "{x}");
            assert!(rect.contains(flat.to_screen(rect, [-0.5, 0.5, 0.0], false)), "{x}: the first one");
        }
    }

    #[test]
    fn what_is_under_the_pointer_stays_there_while_zooming() {
        let rect = Rect::from_min_size(Pos2::new(10.0, 20.0), Vec2::new(640.0, 480.0));
        for y_down in [false, true] {
            let mut flat = Flat { center: [1.0, 2.0], scale: 100.0, foot: 0.0 };
            let at = Pos2::new(200.0, 300.0);
            let [x, y] = flat.to_world(rect, at, y_down);
            flat.zoom(3.7, rect, at, y_down);
            let back = flat.to_screen(rect, [x, y, 0.0], y_down);
            assert!((back - at).length() < 1e-3, "{back:?}");
            flat.pan(Vec2::new(5.0, -7.0), y_down);
            let moved = flat.to_screen(rect, [x, y, 0.0], y_down);
            assert!((moved - at - Vec2::new(5.0, -7.0)).length() < 1e-3, "{moved:?}");
        }
    }
}
