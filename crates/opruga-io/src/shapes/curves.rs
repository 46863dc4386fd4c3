//! Lines and curves before they are divided into points.

use opruga_mesh::outline::Ring;

pub(super) type Point = [f64; 2];

/// The largest number of points of one curve.
const MOST_PIECES: f64 = 10_000.0;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Segment {
    Line(Point),
    /// A cubic Bézier curve by its two control points and its end.
    Cubic(Point, Point, Point),
}

/// A closed curve: from its start through its segments, and straight back to the start.
#[derive(Clone, Debug, PartialEq)]
struct Contour {
    start: Point,
    segments: Vec<Segment>,
    part: u32,
}

/// The closed curves of a drawing, drawn as with a pen.
#[derive(Clone, Debug, Default)]
pub(super) struct Curves {
    contours: Vec<Contour>,
    /// The position of the pen.
    at: Point,
    /// The part that is being drawn.
    part: u32,
}

/// The smaller of two finite numbers; if they are equal (zeros of either sign included), the first.
pub(super) fn smaller(a: f64, b: f64) -> f64 {
    if b < a { b } else { a }
}

/// The larger of two finite numbers; if they are equal, the first.
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

/// An affine map with the coefficients a, b, c, d, e, f: x′ = a x + c y + e, y′ = b x + d y + f.
pub(super) type Affine = [f64; 6];

/// The identity map.
pub(super) const IDENTITY: Affine = [1.0, 0.0, 0.0, 1.0, 0.0, 0.0];

/// The composition of two maps: first `inner`, then `outer`.
pub(super) fn after(outer: &Affine, inner: &Affine) -> Affine {
    let [a, b, c, d, e, f] = *outer;
    let [p, q, r, s, t, u] = *inner;
    [a * p + c * q, b * p + d * q, a * r + c * s, b * r + d * s, a * t + c * u + e, b * t + d * u + f]
}

/// The image of a point under a map.
pub(super) fn mapped(map: &Affine, [x, y]: Point) -> Point {
    [map[0] * x + map[2] * y + map[4], map[1] * x + map[3] * y + map[5]]
}

impl Curves {
    /// An empty drawing for a part.
    pub(super) fn of_part(part: u32) -> Curves {
        Curves { part, ..Curves::default() }
    }

    /// Begins a new contour.
    pub(super) fn move_to(&mut self, to: Point) {
        self.contours.push(Contour { start: to, segments: Vec::new(), part: self.part });
        self.at = to;
    }

    /// Draws a straight line.
    pub(super) fn line_to(&mut self, to: Point) {
        self.push(Segment::Line(to), to);
    }

    /// Draws a cubic Bézier curve.
    pub(super) fn cubic_to(&mut self, first: Point, second: Point, to: Point) {
        self.push(Segment::Cubic(first, second, to), to);
    }

    /// Draws a quadratic Bézier curve, converted to a cubic one.
    pub(super) fn quadratic_to(&mut self, control: Point, to: Point) {
        let third = |p: Point, q: Point| [p[0] + (q[0] - p[0]) * 2.0 / 3.0, p[1] + (q[1] - p[1]) * 2.0 / 3.0];
        self.cubic_to(third(self.at, control), third(to, control), to);
    }

    /// Draws a whole polygon.
    pub(super) fn polygon(&mut self, points: &[Point]) {
        let Some((first, rest)) = points.split_first() else { return };
        self.move_to(*first);
        rest.iter().for_each(|point| self.line_to(*point));
    }

    fn push(&mut self, segment: Segment, to: Point) {
        if self.contours.is_empty() {
            self.move_to(self.at);
        }
        if let Some(contour) = self.contours.last_mut() {
            contour.segments.push(segment);
        }
        self.at = to;
    }

    /// The start of the present contour.
    pub(super) fn start(&self) -> Point {
        self.contours.last().map_or([0.0; 2], |contour| contour.start)
    }

    /// Adds the images of curves under a map.
    pub(super) fn append(&mut self, other: Curves, map: &Affine) {
        self.contours.extend(other.contours.into_iter().map(|contour| {
            Contour {
                start: mapped(map, contour.start),
                segments: contour
                    .segments
                    .into_iter()
                    .map(|segment| match segment {
                        Segment::Line(to) => Segment::Line(mapped(map, to)),
                        Segment::Cubic(p, q, to) => Segment::Cubic(mapped(map, p), mapped(map, q), mapped(map, to)),
                    })
                    .collect(),
                part: contour.part,
            }
        }));
    }

    /// The number of contours.
    pub(super) fn count(&self) -> usize {
        self.contours.len()
    }

    /// The number of contours with enough points to enclose an area.
    pub(super) fn closed(&self) -> usize {
        self.contours.iter().filter(|contour| !contour.segments.is_empty()).count()
    }

    /// The contours from index `begun` on.
    pub(super) fn from(&self, begun: usize) -> Curves {
        Curves { contours: self.contours.get(begun..).unwrap_or(&[]).to_vec(), ..Curves::default() }
    }

    /// Whether this is a single convex polygon that contains all points and control points of other curves, within a tolerance. The polygon then
    /// contains the curves.
    pub(super) fn holds_points_of(&self, other: &Curves, within: f64) -> bool {
        let [contour] = self.contours.as_slice() else { return false };
        let mut corners = vec![contour.start];
        for segment in &contour.segments {
            let Segment::Line(to) = segment else { return false };
            corners.push(*to);
        }
        corners.dedup();
        while corners.len() > 1 && corners.first() == corners.last() {
            corners.pop();
        }
        let n = corners.len();
        let side = |k: usize, p: Point| {
            let (a, b) = (corners[k], corners[(k + 1) % n]);
            let (u, v) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
            (u[0] * v[1] - u[1] * v[0]) / (u[0] * u[0] + u[1] * u[1]).sqrt()
        };
        // Every corner and every point is on the same side of all edges.
        let turn = (0..n).map(|k| side(k, corners[(k + 2) % n])).find(|turn| *turn != 0.0).unwrap_or(0.0).signum();
        let inside = |p: Point| (0..n).all(|k| turn * side(k, p) >= -within);
        let convex = n > 2 && turn != 0.0 && corners.iter().all(|p| (0..n).all(|k| turn * side(k, *p) >= 0.0));
        let segment_inside = |segment: &Segment| match *segment {
            Segment::Line(to) => inside(to),
            Segment::Cubic(p, q, to) => [p, q, to].into_iter().all(inside),
        };
        convex
            && other.contours.iter().all(|contour| inside(contour.start) && contour.segments.iter().all(segment_inside))
    }

    /// The number of points that lines and curves connect. A point that repeats the start of its contour is not counted twice.
    pub(super) fn points(&self) -> usize {
        let of = |contour: &Contour| {
            let end = contour.segments.last().map(|segment| match *segment {
                Segment::Line(to) | Segment::Cubic(_, _, to) => to,
            });
            1 + contour.segments.len() - usize::from(end == Some(contour.start))
        };
        self.contours.iter().map(of).sum()
    }

    /// The larger side of the box around all points and control points.
    pub(super) fn extent(&self) -> f64 {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        let mut add = |p: Point| {
            for a in 0..2 {
                low[a] = smaller(low[a], p[a]);
                high[a] = larger(high[a], p[a]);
            }
        };
        for contour in &self.contours {
            add(contour.start);
            for segment in &contour.segments {
                match segment {
                    Segment::Line(to) => add(*to),
                    Segment::Cubic(p, q, to) => [*p, *q, *to].into_iter().for_each(&mut add),
                }
            }
        }
        larger(high[0] - low[0], high[1] - low[1])
    }

    /// The number of points that [`Curves::flatten`] would make. Counting stops once the number exceeds `most`.
    pub(super) fn flat_points(&self, tolerance: f64, most: u64) -> u64 {
        let mut count = 0;
        for contour in &self.contours {
            let mut at = contour.start;
            count += 1;
            for segment in &contour.segments {
                count += match *segment {
                    Segment::Line(_) => 1,
                    Segment::Cubic(p, q, to) => pieces([at, p, q, to], tolerance),
                };
                at = match *segment {
                    Segment::Line(to) | Segment::Cubic(_, _, to) => to,
                };
            }
            if count > most {
                break;
            }
        }
        count
    }

    /// Rings that stay within `tolerance` of the curves. A point that repeats the previous point is left out.
    pub(super) fn flatten(&self, tolerance: f64) -> Vec<Ring> {
        let flat = |contour: &Contour| {
            let mut points = vec![contour.start];
            let mut at = contour.start;
            for segment in &contour.segments {
                match *segment {
                    Segment::Line(to) => {
                        points.push(to);
                        at = to;
                    }
                    Segment::Cubic(p, q, to) => {
                        let pieces = pieces([at, p, q, to], tolerance);
                        for k in 1..pieces {
                            points.push(on_cubic([at, p, q, to], k as f64 / pieces as f64));
                        }
                        points.push(to);
                        at = to;
                    }
                }
            }
            points.dedup();
            while points.len() > 1 && points.first() == points.last() {
                points.pop();
            }
            Ring { points, part: contour.part }
        };
        self.contours.iter().filter(|contour| !contour.segments.is_empty()).map(flat).collect()
    }
}

/// The number of lines that approximate a cubic curve within a tolerance: n² = ¾ max|second difference| / tolerance.
fn pieces([a, p, q, b]: [Point; 4], tolerance: f64) -> u64 {
    let second = |a: Point, b: Point, c: Point| {
        let (x, y) = (a[0] - 2.0 * b[0] + c[0], a[1] - 2.0 * b[1] + c[1]);
        (x * x + y * y).sqrt()
    };
    let n = (0.75 * larger(second(a, p, q), second(p, q, b)) / tolerance).sqrt().ceil();
    if n >= 1.0 { smaller(n, MOST_PIECES) as u64 } else { 1 }
}

fn on_cubic([a, p, q, b]: [Point; 4], t: f64) -> Point {
    let s = 1.0 - t;
    let (wa, wp, wq, wb) = (s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t);
    core::array::from_fn(|k| wa * a[k] + wp * p[k] + wq * q[k] + wb * b[k])
}

impl Curves {
    /// Adds an elliptical arc of the SVG path language from the present point. Radii that are too small are enlarged according to the standard.
    ///
    /// Pieces of at most 45° become cubic curves, which differ from the arc by less than 5·10⁻⁶ of its radius.
    ///
    /// # Source
    /// W3C, Scalable Vector Graphics 1.1, appendix F.6.
    pub(super) fn arc_to(&mut self, radii: Point, rotation: f64, large: bool, sweep: bool, to: Point) {
        let from = self.at;
        let (mut rx, mut ry) = (radii[0].abs(), radii[1].abs());
        if from == to {
            return;
        }
        if rx == 0.0 || ry == 0.0 {
            return self.line_to(to);
        }
        let (sin, cos) = (libm::sin(rotation), libm::cos(rotation));
        // Relative to the midpoint of the chord, along the axes of the ellipse.
        let (hx, hy) = (0.5 * (from[0] - to[0]), 0.5 * (from[1] - to[1]));
        let (x, y) = (cos * hx + sin * hy, cos * hy - sin * hx);
        let stretch = (x / rx) * (x / rx) + (y / ry) * (y / ry);
        if stretch > 1.0 {
            rx *= stretch.sqrt();
            ry *= stretch.sqrt();
        }
        let (u, v) = (rx * y, ry * x);
        let rest = ((rx * ry) * (rx * ry) - u * u - v * v) / (u * u + v * v);
        let factor = if rest > 0.0 { rest.sqrt() } else { 0.0 } * if large == sweep { -1.0 } else { 1.0 };
        let (cx, cy) = (factor * rx * y / ry, -factor * ry * x / rx);
        let center = [cos * cx - sin * cy + 0.5 * (from[0] + to[0]), sin * cx + cos * cy + 0.5 * (from[1] + to[1])];
        let first = libm::atan2((y - cy) / ry, (x - cx) / rx);
        let last = libm::atan2((-y - cy) / ry, (-x - cx) / rx);
        let turn = core::f64::consts::TAU;
        let mut angle = last - first;
        if sweep && angle < 0.0 {
            angle += turn;
        } else if !sweep && angle > 0.0 {
            angle -= turn;
        }
        let pieces = larger((angle.abs() / core::f64::consts::FRAC_PI_4).ceil(), 1.0);
        let step = angle / pieces;
        let handle = 4.0 / 3.0 * libm::tan(0.25 * step);
        let point_at =
            |c: f64, s: f64| [center[0] + cos * rx * c - sin * ry * s, center[1] + sin * rx * c + cos * ry * s];
        for k in 0..pieces as u32 {
            let (a, b) = (first + f64::from(k) * step, first + f64::from(k + 1) * step);
            let (ca, sa, cb, sb) = (libm::cos(a), libm::sin(a), libm::cos(b), libm::sin(b));
            let end = if f64::from(k + 1) == pieces { to } else { point_at(cb, sb) };
            self.cubic_to(
                point_at(ca - handle * sa, sa + handle * ca),
                point_at(cb + handle * sb, sb - handle * cb),
                end,
            );
        }
    }
}
