//! Reduces a closed line to its visible detail. A point is omitted if the line looks the same on the screen without it.

use egui::{Color32, Pos2, Rect, Vec2};

/// The limits of visible detail.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Detail {
    /// Points closer to one another than this are merged [points of the screen].
    pub(crate) merge_distance: f32,
    /// The largest distance of the line from a point that is left out [points of the screen].
    pub(crate) beside: f32,
    /// The largest difference of a colour from the colour at the beginning of a straight piece, on a scale of 255.
    pub(crate) colour: u8,
    /// The visible area.
    pub(crate) screen: Rect,
}

/// A straight piece of a line that is extended point by point.
struct Piece {
    from: (Pos2, Color32),
    /// The range of directions in which a straight line from the beginning of the piece passes close enough to all points of the piece. It is given
    /// by its two outermost directions. None until a point is far enough from the beginning.
    cone: Option<[Vec2; 2]>,
    /// The largest distance of the points of the piece from its beginning.
    far: f32,
    /// Whether the piece has a second point. Between two neighbouring points the colour is interpolated, so the second point may have any colour.
    begun: bool,
    /// Whether the points of the piece are still close enough to a straight line.
    straight: bool,
    /// The sides of the screen beyond which all points of the piece are, as bits.
    outside: u8,
}

impl Piece {
    fn new(from: (Pos2, Color32), detail: &Detail) -> Piece {
        Piece { from, cone: None, far: 0.0, begun: false, straight: true, outside: detail.outside(from.0) }
    }

    /// Extends the piece by a point if possible; returns whether it was possible.
    fn takes(&mut self, point: (Pos2, Color32), detail: &Detail) -> bool {
        self.outside &= detail.outside(point.0);
        let offset = point.0 - self.from.0;
        let long = offset.length();
        let [a, b] = [self.from.1, point.1].map(|colour| colour.to_array());
        let free = !std::mem::replace(&mut self.begun, true) || long <= detail.merge_distance;
        let alike = free || a.iter().zip(b).all(|(a, b)| a.abs_diff(b) <= detail.colour);
        // A piece ends where the line turns back, because the tip would otherwise be lost.
        self.straight &= alike && long.is_finite() && long >= self.far - detail.beside;
        self.far = self.far.max(long);
        if self.straight && long > detail.merge_distance {
            let ahead = offset / long;
            let sine = (detail.beside / long).min(1.0);
            let cosine = (1.0 - sine * sine).sqrt();
            let turned = |sine: f32| Vec2::new(cosine * ahead.x - sine * ahead.y, sine * ahead.x + cosine * ahead.y);
            let own = [turned(-sine), turned(sine)];
            let cross = |a: Vec2, b: Vec2| a.x * b.y - a.y * b.x;
            self.cone = match self.cone {
                None => Some(own),
                Some([low, high]) => {
                    self.straight = cross(low, ahead) >= 0.0 && cross(ahead, high) >= 0.0;
                    let inner_low = if cross(low, own[0]) > 0.0 { own[0] } else { low };
                    Some([inner_low, if cross(own[1], high) > 0.0 { own[1] } else { high }])
                }
            };
        }
        self.straight || self.outside != 0
    }
}

impl Detail {
    fn outside(&self, at: Pos2) -> u8 {
        let Rect { min, max } = self.screen;
        u8::from(at.x < min.x) | u8::from(at.x > max.x) << 1 | u8::from(at.y < min.y) << 2 | u8::from(at.y > max.y) << 3
    }

    /// Collects the indices of the points of a closed line that are needed, in their order.
    pub(crate) fn seen(&self, line: impl Iterator<Item = (Pos2, Color32)>, kept: &mut Vec<u32>) {
        kept.clear();
        let mut piece: Option<(Piece, (Pos2, Color32), u32)> = None;
        for (index, point) in line.enumerate() {
            let index = index as u32;
            match &mut piece {
                None => {
                    kept.push(index);
                    piece = Some((Piece::new(point, self), point, index));
                }
                Some((now, last, end)) => {
                    if !now.takes(point, self) {
                        *now = Piece::new(*last, self);
                        now.takes(point, self);
                        kept.push(*end);
                    }
                    (*last, *end) = (point, index);
                }
            }
        }
        if let Some((now, last, end)) = piece
            && (last.0 - now.from.0).length() > self.merge_distance
        {
            kept.push(end);
        }
    }

    /// The same detail with twice the tolerances.
    fn rougher(self) -> Detail {
        Detail {
            merge_distance: 2.0 * self.merge_distance,
            beside: 2.0 * self.beside,
            colour: self.colour.saturating_mul(2),
            ..self
        }
    }
}

/// The largest number of corners of a large outline that is triangulated in every picture.
const MOST_CORNERS: usize = 5_000;

/// In a large outline, nodes that are closer to one another on the screen than this distance [points] are merged.
const JOINED: f32 = 0.3;

/// The nodes of a closed line that are separate on the screen: the first and cheapest reduction of a large outline.
pub(crate) fn apart(line: &[u32], at: &[Pos2]) -> Vec<u32> {
    let mut kept: Vec<u32> = Vec::new();
    let mut last: Option<Pos2> = None;
    for node in line {
        let here = at[*node as usize];
        if last.is_none_or(|last| (here - last).length_sq() > JOINED * JOINED) {
            kept.push(*node);
            last = Some(here);
        }
    }
    kept
}

/// Returns the visible corners of the closed lines of a large outline, at most as many as can be filled in every picture. `of` returns the position
/// of a node on the screen, and its colour.
pub(crate) fn corners(
    closed: &[Vec<u32>],
    mut detail: Detail,
    of: impl Fn(&u32) -> (Pos2, Color32),
    kept: &mut Vec<u32>,
) -> Vec<Vec<u32>> {
    loop {
        let mut seen = |line: &Vec<u32>| {
            detail.seen(line.iter().map(&of), kept);
            kept.iter().map(|index| line[*index as usize]).collect::<Vec<u32>>()
        };
        let lines: Vec<Vec<u32>> = closed.iter().map(&mut seen).filter(|line| line.len() >= 3).collect();
        if lines.iter().map(Vec::len).sum::<usize>() <= MOST_CORNERS || detail.merge_distance > 64.0 {
            return lines;
        }
        detail = detail.rougher();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: Color32 = Color32::RED;

    fn detail() -> Detail {
        let screen = Rect::from_min_size(Pos2::ZERO, Vec2::new(1000.0, 800.0));
        Detail { merge_distance: 0.4, beside: 0.1, colour: 6, screen }
    }

    fn circle(count: usize, radius: f32) -> Vec<(Pos2, Color32)> {
        let at = |k: usize| Vec2::angled(std::f32::consts::TAU * k as f32 / count as f32) * radius;
        (0..count).map(|k| (Pos2::new(500.0, 400.0) + at(k), RED)).collect()
    }

    fn kept(detail: &Detail, line: &[(Pos2, Color32)]) -> Vec<u32> {
        let mut kept = Vec::new();
        detail.seen(line.iter().copied(), &mut kept);
        kept
    }

    /// The distance of a point from the closed line through the kept points.
    fn distance(at: Pos2, line: &[(Pos2, Color32)], kept: &[u32]) -> f32 {
        let ends = (0..kept.len()).map(|k| [k, (k + 1) % kept.len()].map(|k| line[kept[k] as usize].0));
        let far = |[a, b]: [Pos2; 2]| {
            let (offset, to) = (b - a, at - a);
            let share = (offset.dot(to) / offset.length_sq().max(1e-12)).clamp(0.0, 1.0);
            (to - offset * share).length()
        };
        ends.map(far).fold(f32::MAX, f32::min)
    }

    #[test]
    fn of_a_hundred_thousand_points_of_a_circle_those_are_kept_that_can_be_told_apart() {
        let line = circle(100_000, 350.0);
        let kept = kept(&detail(), &line);
        assert!((50..400).contains(&kept.len()), "{}", kept.len());
        let worst = line.iter().step_by(97).map(|p| distance(p.0, &line, &kept)).fold(0.0, f32::max);
        assert!(worst < 0.5, "{worst}");
    }

    #[test]
    fn no_point_of_a_crumpled_line_lies_farther_beside_than_what_is_told_apart() {
        let mut line = circle(20_000, 300.0);
        for (k, point) in line.iter_mut().enumerate() {
            let wave = 12.0 * (0.013 * k as f32).sin() + 3.0 * (0.11 * k as f32).cos();
            point.0 += (point.0 - Pos2::new(500.0, 400.0)).normalized() * wave;
        }
        let kept = kept(&detail(), &line);
        assert!(kept.len() < line.len() / 4, "{}", kept.len());
        let worst = line.iter().step_by(7).map(|p| distance(p.0, &line, &kept)).fold(0.0, f32::max);
        assert!(worst < 0.9, "{worst}");
    }

    #[test]
    fn tips_corners_and_colours_are_kept_and_points_on_one_another_and_numbers_that_are_none_do_no_harm() {
        let at = |x: f32, y: f32| (Pos2::new(x, y), RED);
        // A line that goes in one direction and returns: its tip must be kept.
        let spike: Vec<_> = (0..=100).chain((0..100).rev()).map(|k| at(k as f32, 100.0)).collect();
        let tip = kept(&detail(), &spike);
        assert!(tip.iter().any(|index| (*index as i32 - 100).abs() <= 1), "{tip:?}");
        // A straight line whose colour changes.
        let green = Color32::from_rgb(0, 200, 0);
        let two: Vec<_> = (0..200).map(|k| (Pos2::new(k as f32, 9.0), if k < 90 { RED } else { green })).collect();
        let both = kept(&detail(), &two);
        assert!(both.contains(&89) && both.contains(&90), "{both:?}");
        assert!(both.len() < 8, "{both:?}");
        assert_eq!(kept(&detail(), &[at(5.0, 5.0); 40]), [0]);
        let odd = [at(0.0, 0.0), at(f32::NAN, 3.0), at(9.0, 0.0), at(9.0, 9.0)];
        assert!(kept(&detail(), &odd).len() <= odd.len() + 1);
        assert!(kept(&detail(), &[]).is_empty());
    }

    #[test]
    fn what_lies_beside_the_screen_costs_nothing_and_what_enters_it_is_seen() {
        // A large circle, of which only a piece is on the screen.
        let line = circle(100_000, 40_000.0);
        let moved: Vec<_> = line.iter().map(|(p, c)| (*p + Vec2::new(39_600.0, 0.0), *c)).collect();
        let kept = kept(&detail(), &moved);
        assert!(kept.len() < 60, "{}", kept.len());
        let screen = detail().screen;
        let inside = moved.iter().filter(|p| screen.contains(p.0));
        let worst = inside.map(|p| distance(p.0, &moved, &kept)).fold(0.0, f32::max);
        assert!(worst < 0.5, "{worst}");
    }

    #[test]
    fn nodes_that_lie_on_one_another_on_the_screen_are_one_and_the_first_is_always_there() {
        let at: Vec<Pos2> = circle(100_000, 50.0).into_iter().map(|(at, _)| at).collect();
        let line: Vec<u32> = (0..100_000).collect();
        let kept = apart(&line, &at);
        assert!((500..1_100).contains(&kept.len()), "{}", kept.len());
        assert_eq!(kept[0], 0);
        assert_eq!(apart(&line, &vec![Pos2::ZERO; 100_000]), [0]);
    }

    #[test]
    fn an_outline_has_never_more_corners_than_are_filled_with_every_picture() {
        let of = |node: &u32| {
            let far = 300.0 + if node.is_multiple_of(2) { 20.0 } else { 0.0 };
            let turn = std::f32::consts::TAU * *node as f32 / 60_000.0;
            (Pos2::new(500.0, 400.0) + Vec2::angled(turn) * far, RED)
        };
        let closed = vec![(0..60_000).collect::<Vec<u32>>()];
        let lines = corners(&closed, detail(), of, &mut Vec::new());
        assert!((3..=MOST_CORNERS).contains(&lines[0].len()), "{}", lines[0].len());
    }
}
