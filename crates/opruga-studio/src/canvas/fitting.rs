//! Chooses the visible part of a scene. At the start, this part contains everything. The visible part is then widened to include what moves, until
//! the user moves the view.

use super::camera::with_floors;
use super::{Canvas, Doing};
use crate::report::Report;
use crate::shown::Shown;
use egui::Rect;
use opruga::WorldError;
use opruga::draw::View;

impl Canvas {
    /// Forgets what was fitted to states that no longer exist: the range of the colours and, if the user has not moved the view, the widening of the
    /// view.
    fn fit_if_replaced(&mut self, shown: &Shown, rect: Rect) {
        if std::mem::replace(&mut self.replaced, shown.replaced) == shown.replaced {
            return;
        }
        self.range = None;
        if std::mem::replace(&mut self.resets, shown.resets) != shown.resets {
            // After a reset, the start is shown as at first, even if the user has moved the view.
            self.far = false;
            self.fit();
        } else if std::mem::take(&mut self.far) {
            self.fit();
        } else if let (Some(_), Some(view)) = (self.fitted_size, &mut self.scales) {
            [view.low, view.high] = self.first;
            self.flat.fit(view, rect, self.tools);
        }
    }

    /// Restores the first view if a body has just exploded, because this view shows the rest of the scene. A view that the user has moved does not
    /// change.
    fn stay_if_exploded(&mut self, shown: &Shown, rect: Rect) {
        let exploded = shown.message.as_ref().filter(|message| matches!(message.report, Report::Exploded(_)));
        let number = exploded.map(|message| message.number);
        if std::mem::replace(&mut self.exploded, number) != number
            && number.is_some()
            && let (Some(_), Some(view)) = (self.fitted_size, &mut self.scales)
        {
            [view.low, view.high] = self.first;
            self.flat.fit(view, rect, self.tools);
        }
    }

    /// Shows everything if a motion has just failed and nothing is in sight in its last good frame.
    fn fit_if_lost(&mut self, shown: &Shown, rect: Rect) {
        let failed = shown.message.as_ref().filter(|message| {
            matches!(
                message.report,
                Report::World(WorldError::Diverged { .. } | WorldError::Step { .. } | WorldError::NotConverged { .. })
            )
        });
        let Some(number) = failed.map(|message| message.number).filter(|number| self.failed != Some(*number)) else {
            return;
        };
        self.failed = Some(number);
        let in_sight = |point: [f64; 3]| self.on_screen(shown, point).is_some_and(|at| rect.contains(at));
        let seen = shown.extents.iter().map(|extent| extent.corners).any(|[low, high]| {
            let middle = [0, 1, 2].map(|d| 0.5 * (low[d] + high[d]));
            in_sight(low) || in_sight(high) || in_sight(middle)
        });
        if !seen {
            self.far = true;
            self.fit();
        }
    }

    pub(super) fn fit_if_new(&mut self, shown: &Shown, rect: Rect) {
        self.fit_if_replaced(shown, rect);
        self.fit_if_lost(shown, rect);
        self.stay_if_exploded(shown, rect);
        if self.fitted == shown.opened && self.scales.is_some() {
            // The view adapts to the window until the user moves it.
            if let (Some(size), Some(view)) = (self.fitted_size, &mut self.scales) {
                if size != rect.size() {
                    self.flat.fit(view, rect, self.tools);
                    self.space.look_at_all(view, rect.size());
                    self.fitted_size = Some(rect.size());
                } else if matches!(self.doing, Doing::Nothing)
                    && self.exploded.is_none()
                    && self.flat.widen(view, &self.first, shown, rect)
                {
                    self.flat.fit(view, rect, self.tools);
                }
            }
            return;
        }
        self.fitted_size = Some(rect.size());
        let first = self.fitted != 0;
        self.fitted = shown.opened;
        let beside = shown.beside.iter().map(|beside| &beside.right.picture);
        self.scales = View::fit([&shown.picture].into_iter().chain(beside)).ok().map(|view| with_floors(view, shown));
        if let Some(view) = &self.scales {
            self.flat.fit(view, rect, self.tools);
            self.space.fit(view, rect.size());
            self.first = [view.low, view.high];
        }
        self.range = None;
        self.kept.forget();
        self.kept_beside.forget();
        if first {
            self.selected = None;
        }
        let only = (shown.bodies.len() == 1).then(|| shown.bodies[0].name.clone());
        self.selected = self.selected.take().or(only);
        self.doing = Doing::Nothing;
    }

    /// Makes the range of the colours follow the values. The range grows at once and shrinks slowly.
    pub(super) fn fit_colours(&mut self, shown: &Shown) {
        // The values of a side that has stopped are ignored, because they may be meaningless.
        let beside = shown.beside.iter().filter(|beside| beside.stopped.is_none());
        let beside = beside.flat_map(|beside| &beside.right.extents);
        let colours = shown.extents.iter().chain(beside).map(|extent| extent.colours);
        let (low, high) = colours.fold((f64::MAX, f64::MIN), |(low, high), [a, b]| (low.min(a), high.max(b)));
        if low > high {
            return;
        }
        // Values that are nearly zero must not be spread over all colours.
        let least = match shown.picture.legend.as_ref().map_or("", |legend| &legend.unit) {
            "%" | "Pa" => 1.0,
            _ => 0.01,
        };
        let least = f64::max(least, 1e-3 * low.abs().max(high.abs()));
        let now = [low, high.max(low + least)];
        let slowly = |old: f64, new: f64| old + 0.01 * (new - old);
        self.range = Some(match self.range {
            Some([a, b]) if a <= now[1] && b >= now[0] => [
                if now[0] < a { now[0] } else { slowly(a, now[0]) },
                if now[1] > b { now[1] } else { slowly(b, now[1]) },
            ],
            _ => now,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shown::{Extent, Message, Severity};
    use egui::Pos2;

    const RECT: Rect = Rect { min: Pos2::ZERO, max: Pos2::new(600.0, 500.0) };

    /// A ball of one metre at position `x`, in colours up to `most`.
    fn ball(x: f64, most: f64) -> Shown {
        let body = opruga::draw::BodyPicture {
            positions: vec![[x - 0.5, 0.0, 0.0], [x + 0.5, 1.0, 0.0]],
            ..Default::default()
        };
        let extent = Extent { colours: [0.0, most], ..Extent::of(&body) };
        let picture = opruga::draw::Picture { dimension: 2, bodies: vec![body], ..Default::default() };
        Shown { dimension: 2, opened: 1, extents: vec![extent], picture, ..Default::default() }
    }

    fn seen(canvas: &mut Canvas, shown: &Shown) {
        canvas.rect = Some(RECT);
        canvas.fit_if_new(shown, RECT);
        canvas.fit_colours(shown);
    }

    #[test]
    fn what_was_fitted_to_states_that_are_gone_is_fitted_anew_at_once() {
        let mut canvas = Canvas::default();
        seen(&mut canvas, &ball(0.0, 20.0));
        let first = (canvas.flat.scale, canvas.range);
        for _ in 0..3 {
            seen(&mut canvas, &ball(1.5, 15_000.0));
        }
        assert!(canvas.flat.scale < first.0 && canvas.range > first.1);
        seen(&mut canvas, &ball(0.0, 20.0));
        assert!(canvas.range > first.1, "slowly, while nothing is replaced");
        seen(&mut canvas, &Shown { replaced: 1, ..ball(0.0, 20.0) });
        assert_eq!((canvas.flat.scale, canvas.range), first);
        // A view that the user has moved does not change, unless the scene is restarted.
        (canvas.fitted_size, canvas.flat.scale) = (None, 7.0);
        seen(&mut canvas, &Shown { replaced: 2, ..ball(0.0, 20.0) });
        assert_eq!(canvas.flat.scale, 7.0);
        canvas.flat.pan(egui::Vec2::new(9000.0, 0.0), false);
        seen(&mut canvas, &Shown { replaced: 3, resets: 1, ..ball(0.0, 20.0) });
        assert_eq!((canvas.flat.scale, canvas.range), first);
        assert!(RECT.contains(canvas.on_screen(&ball(0.0, 20.0), [0.0, 0.5, 0.0]).expect("a place")));
    }

    #[test]
    fn the_view_stays_where_a_body_explodes_and_does_not_follow_what_is_left_of_it() {
        let mut canvas = Canvas::default();
        seen(&mut canvas, &ball(0.0, 20.0));
        let first = canvas.flat;
        for x in [1.0, 1.5, 1.9] {
            seen(&mut canvas, &ball(x, 20.0));
        }
        assert!(canvas.flat.scale < first.scale, "it widens for a body that leaves it");
        let exploded =
            crate::exploded::Exploded { body: "ball".into(), integrator: "explicit_euler".into(), unstable: true };
        let report = Report::Exploded(exploded);
        let text = report.to_string();
        let message =
            Message { number: 3, severity: Severity::Refused, report, text, offer: None, frame_seconds: None };
        let mut lost = Shown { message: Some(message), ..ball(0.0, 20.0) };
        lost.extents[0].corners = [[-80.0, -70.0, 0.0], [90.0, 85.0, 0.0]];
        for _ in 0..5 {
            seen(&mut canvas, &lost);
            assert_eq!((canvas.flat.scale, canvas.flat.middle()), (first.scale, first.middle()));
        }
    }

    #[test]
    fn the_last_good_frame_of_a_motion_that_failed_is_in_sight_and_so_is_what_is_undone_to() {
        let mut canvas = Canvas::default();
        seen(&mut canvas, &ball(0.0, 20.0));
        let first = canvas.flat.scale;
        let error = WorldError::Diverged { body: "ball".into(), node: 0, time: 0.2, last: 0.1, range: None };
        let report = Report::World(error);
        let text = report.to_string();
        let message =
            Message { number: 3, severity: Severity::Refused, report, text, offer: None, frame_seconds: None };
        let lost = Shown { message: Some(message), ..ball(5e5, 20.0) };
        seen(&mut canvas, &lost);
        assert!(RECT.contains(canvas.on_screen(&lost, [5e5, 0.5, 0.0]).expect("a place")));
        seen(&mut canvas, &Shown { replaced: 1, ..ball(0.0, 20.0) });
        assert!((canvas.flat.scale / first - 1.0).abs() < 1e-9);
        assert!(RECT.contains(canvas.on_screen(&ball(0.0, 20.0), [0.0, 0.5, 0.0]).expect("a place")));
    }
}
