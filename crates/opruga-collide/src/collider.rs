//! A collider: a shape, its motion, and its contact law.

use crate::facets::{Facets, Flaw};
use crate::motion::{Frame, Motion};
use crate::refusals::Refusal;
use crate::shape::{Ball, Capsule, Cuboid, HalfSpace};
use crate::vector::{add, dot, identity, length, magnitude, rotation, scaled, subtract, turning};
use opruga_core::error::BuildError;
use opruga_core::spec::{Value, Values};
use opruga_math::Lane;

/// The contact law of a collider.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Law {
    /// Ratio of normal speeds after and before an impact.
    pub(crate) restitution: f64,
    /// Coulomb's coefficient.
    pub(crate) friction: f64,
    /// The normal speed up to which there is no bounce [m/s].
    pub(crate) rest_speed: f64,
    /// The distance that nodes keep [m].
    pub(crate) thickness: f64,
    /// The size of the coordinates of the shape [m], to which rounding errors are proportional.
    pub(crate) extent: f64,
}

/// One convex piece, or one set of facets, of a collider at rest.
#[derive(Clone, Debug)]
pub(crate) enum Part<const D: usize> {
    HalfSpace(HalfSpace<D>),
    Ball(Ball<D>),
    Capsule(Capsule<D>),
    Cuboid(Cuboid<D>),
    Facets(Facets<D>),
}

impl<const D: usize> Form<D> {
    /// Whether the shape has flat faces (in the plane: straight lines) between corners.
    pub(crate) fn has_faces(&self) -> bool {
        match self {
            Form::Box { inside, .. } => !inside,
            Form::Polygon { .. } | Form::Polyline { .. } | Form::Triangles { .. } => true,
            Form::HalfSpace { .. } | Form::Ball { .. } | Form::Capsule { .. } => false,
        }
    }
}

impl<const D: usize> Part<D> {
    /// Whether it is a solid with edges.
    pub(crate) fn has_edges(&self) -> bool {
        match self {
            Part::Cuboid(_) => true,
            Part::Facets(facets) => facets.solid,
            Part::HalfSpace(_) | Part::Ball(_) | Part::Capsule(_) => false,
        }
    }
}

/// The shape as described in the scene, for drawing.
#[derive(Clone, Debug)]
pub(crate) enum Form<const D: usize> {
    HalfSpace { point: [f64; D], normal: [f64; D] },
    Box { shape: Cuboid<D>, inside: bool },
    Ball { center: [f64; D], radius: f64, inside: bool },
    Capsule { a: [f64; D], b: [f64; D], radius: f64 },
    Polygon { points: Vec<[f64; D]> },
    Polyline { points: Vec<[f64; D]>, closed: bool },
    Triangles { points: Vec<[f64; D]>, triangles: Vec<[u32; 3]>, solid: bool },
}

/// A shape, its motion, and its contact law.
#[derive(Clone, Debug)]
pub(crate) struct Collider<const D: usize> {
    pub(crate) law: Law,
    pub(crate) motion: Motion<D>,
    /// If the collider is at rest, its frame, which is the same in every step.
    pub(crate) still: Option<Frame<D>>,
    pub(crate) form: Form<D>,
    pub(crate) parts: Vec<Part<D>>,
    /// The box around a bounded shape at rest.
    bounds: Option<[[f64; D]; 2]>,
}

/// How far a collider may move from its placement within an interval of time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach<const D: usize> {
    /// The smallest and largest displacement along each axis [m].
    pub(crate) shifts: [[f64; D]; 2],
    /// How far a straight line in the rotating frame may deviate from the straight line in space [m].
    pub(crate) bend: f64,
}

/// Returns the error for a refused collider.
fn refused(values: &Values, refusal: Refusal) -> BuildError {
    BuildError::of(values.kind(), refusal)
}

/// Returns the value of a field as written in the scene.
fn shown(values: &Values, field: &str) -> String {
    values.get(field).map_or("absent".to_string(), Value::to_string)
}

impl<const D: usize> Collider<D> {
    /// Builds a collider from its parameters.
    pub(crate) fn build(values: &Values) -> Result<Collider<D>, BuildError> {
        let (form, parts, center) = match values.kind() {
            "half_space" => half_space(values)?,
            "box" => cuboid(values)?,
            "ball" => ball(values),
            "capsule" => capsule(values)?,
            "convex" => convex(values)?,
            "polyline" if D == 2 => polyline(values)?,
            "triangle_mesh" if D == 3 => triangle_mesh(values)?,
            _ => return Err(refused(values, Refusal::Kind { dimension: D })),
        };
        let motion = motion(values, &center);
        let mut law = Law {
            restitution: values.number("restitution").unwrap_or(0.0),
            friction: values.number("friction").unwrap_or(0.0),
            rest_speed: values.number("rest_speed").unwrap_or(0.05),
            thickness: values.number("thickness").unwrap_or(0.0),
            extent: magnitude(&center),
        };
        let mut bounds: Option<[[f64; D]; 2]> = None;
        for part in &parts {
            bounds = part.bounds();
            if let Some([low, high]) = &bounds {
                law.extent = magnitude(low).larger(magnitude(high));
            }
            match part {
                Part::Facets(facets) => law.thickness = law.thickness.larger(facets.skin()),
                Part::Ball(ball) => {
                    law.extent += ball.radius;
                    if ball.sign < 0.0 && law.thickness >= ball.radius {
                        let (thickness, radius) = (law.thickness, ball.radius);
                        return Err(refused(values, Refusal::FilledBall { thickness, radius }));
                    }
                }
                _ => {}
            }
        }
        if let Form::Box { shape, inside: true } = &form {
            law.extent += magnitude(&shape.half);
            for half in &shape.half {
                if law.thickness >= *half {
                    return Err(refused(values, Refusal::FilledBox { thickness: law.thickness, half: *half }));
                }
            }
        }
        let still = motion.is_still().then(|| Frame::new(&motion, 0.0, 0.0));
        Ok(Collider { law, motion, still, form, parts, bounds })
    }
    /// The distance that nodes keep from the collider because of rounding [m].
    pub(crate) fn margin_of_rounding(&self) -> f64 {
        let margin = |part: &Part<D>| if let Part::Facets(facets) = part { facets.skin() } else { 0.0 };
        self.parts.iter().map(margin).fold(0.0, |most, margin| margin.larger(most))
    }
    /// Whether the collider has flat faces (in the plane: straight lines) between corners.
    pub(crate) fn has_faces(&self) -> bool {
        self.form.has_faces()
    }
    /// Whether it is at rest.
    pub(crate) fn is_static(&self) -> bool {
        self.still.is_some()
    }
    /// How far the collider may move from its placement within an interval of time.
    pub(crate) fn reach(&self, from: f64, to: f64) -> Reach<D> {
        Reach { shifts: if self.is_static() { [[0.0; D]; 2] } else { self.motion.shifts(from, to) }, bend: 0.0 }
    }
    /// How far it may move, relative to nodes that stay within a box, in a step that ends at `time`.
    ///
    /// The paths of nodes are straight lines from a to b in the rotating frame, and T(s) is the rotation at the fraction s of
    /// the step. The straight line in space, (1 − s) T(0) a + s T(1) b, deviates from T(s) ((1 − s) a + s b) by at most φ |b −
    /// a|/4 + φ² r/8 if the frame rotates by an angle φ and the path is within a radius r.
    pub(crate) fn sweep(&self, time: f64, h: f64, space: &[[f64; D]; 2]) -> Reach<D> {
        let mut reach = self.reach(time - h, time);
        if self.motion.turns {
            let mut rate = 0.0;
            for row in &self.motion.omega {
                rate += 0.5 * dot(row, row);
            }
            let (angle, radius) = (rate.sqrt() * h, self.radius());
            let travel = length(&subtract(&space[1], &space[0])) + angle * radius;
            reach.bend = angle * travel + angle * angle * radius;
        }
        reach
    }
    /// The largest distance of a bounded shape from the pivot.
    fn radius(&self) -> f64 {
        let Some([low, high]) = &self.bounds else { return 0.0 };
        let mut arm = [0.0; D];
        for d in 0..D {
            arm[d] = (low[d] - self.motion.pivot[d]).abs().larger((high[d] - self.motion.pivot[d]).abs());
        }
        length(&arm)
    }
    /// Whether a part may touch something within a box. If the part can touch something there, the function returns true. It may also return true
    /// although the part cannot.
    pub(crate) fn may_touch(&self, part: &Part<D>, reach: &Reach<D>, low: &[f64; D], high: &[f64; D]) -> bool {
        let slack = 1e-9 * (self.law.extent + magnitude(low) + magnitude(high));
        let margin = self.law.thickness + reach.bend + slack;
        let [least, most] = &reach.shifts;
        match part {
            // A rotating plane may be anywhere.
            Part::HalfSpace(_) if self.motion.turns => true,
            Part::HalfSpace(plane) => {
                // The largest motion of the plane along its normal.
                let mut ahead = 0.0;
                for d in 0..D {
                    ahead += (least[d] * plane.normal[d]).larger(most[d] * plane.normal[d]);
                }
                let clear = plane.least_gap(low, high) - ahead >= margin;
                !clear
            }
            // A rotating hollow ball may be anywhere, because its pivot need not be its centre.
            Part::Ball(ball) if ball.sign < 0.0 => {
                let mut far = [0.0; D];
                for d in 0..D {
                    let below =
                        (ball.center[d] + most[d] - low[d]).abs().larger((ball.center[d] + least[d] - low[d]).abs());
                    let above =
                        (high[d] - ball.center[d] - least[d]).abs().larger((high[d] - ball.center[d] - most[d]).abs());
                    far[d] = below.larger(above);
                }
                let clear = ball.radius - length(&far) >= margin;
                self.motion.turns || !clear
            }
            _ => {
                let Some([from, to]) = &self.bounds else { return true };
                let (mut from, mut to) = (*from, *to);
                if self.motion.turns {
                    let radius = self.radius();
                    for d in 0..D {
                        from[d] = self.motion.pivot[d] - radius;
                        to[d] = self.motion.pivot[d] + radius;
                    }
                }
                for d in 0..D {
                    if from[d] + least[d] - margin > high[d] || to[d] + most[d] + margin < low[d] {
                        return false;
                    }
                }
                true
            }
        }
    }
}

impl<const D: usize> Part<D> {
    /// The bounding box; `None` if the shape is unbounded.
    fn bounds(&self) -> Option<[[f64; D]; 2]> {
        let (center, half) = match self {
            Part::HalfSpace(_) => return None,
            Part::Ball(ball) if ball.sign < 0.0 => return None,
            Part::Ball(ball) => (ball.center, [ball.radius; D]),
            Part::Capsule(capsule) => {
                let mut half = [capsule.radius; D];
                for d in 0..D {
                    half[d] += 0.5 * capsule.along[d].abs();
                }
                (add(&capsule.start, &scaled(&capsule.along, 0.5)), half)
            }
            Part::Cuboid(cuboid) => {
                let mut half = [0.0; D];
                for d in 0..D {
                    for i in 0..D {
                        half[d] += (cuboid.half[i] * cuboid.axes[i][d]).abs();
                    }
                }
                (cuboid.center, half)
            }
            Part::Facets(facets) => return Some([facets.low, facets.high]),
        };
        Some([subtract(&center, &half), add(&center, &half)])
    }
}

/// Vectors shorter than this have lost digits of their direction, because the squares of their components are subnormal.
const SHORTEST: f64 = 1e-150;

/// Form, parts and centre of a shape.
type Built<const D: usize> = (Form<D>, Vec<Part<D>>, [f64; D]);

fn half_space<const D: usize>(values: &Values) -> Result<Built<D>, BuildError> {
    let (point, normal) = (values.vector::<D>("point"), values.vector::<D>("normal"));
    let mut unit = normal;
    let mut size = length(&unit);
    if !size.is_finite() {
        // The squares of these components may overflow or underflow, but the vector still has a direction.
        let most = normal.iter().fold(0.0, |most: f64, n| if n.abs() > most { n.abs() } else { most });
        unit = normal.map(|n| n / most);
        size = length(&unit);
    }
    if !(size > SHORTEST && size.is_finite()) {
        let (normal, least) = (shown(values, "normal"), format!("{SHORTEST:e}"));
        return Err(refused(values, Refusal::NoNormal { normal, least }));
    }
    for n in &mut unit {
        *n /= size;
    }
    Ok((Form::HalfSpace { point, normal: unit }, vec![Part::HalfSpace(HalfSpace::through(&point, unit))], point))
}

fn cuboid<const D: usize>(values: &Values) -> Result<Built<D>, BuildError> {
    let given = |name| values.get(name).is_some();
    let corners = [given("min"), given("max")];
    let middle = [given("center"), given("size")];
    let (center, half) = match (corners, middle) {
        ([true, true], [false, false]) => {
            let (min, max) = (values.vector::<D>("min"), values.vector::<D>("max"));
            (scaled(&add(&min, &max), 0.5), scaled(&subtract(&max, &min), 0.5))
        }
        ([false, false], [true, true]) => (values.vector::<D>("center"), scaled(&values.vector::<D>("size"), 0.5)),
        _ => return Err(refused(values, Refusal::BoxFields {})),
    };
    if half.iter().any(|h| !(*h > 0.0 && h.is_finite())) {
        return Err(refused(
            values,
            match corners[0] {
                true => Refusal::EmptyCorners { max: shown(values, "max"), min: shown(values, "min") },
                false => Refusal::EmptySize { size: shown(values, "size") },
            },
        ));
    }
    // The rows of the transpose are the rotated unit vectors.
    let turn = rotation::<D>(&turning(&spin(values, "rotation")), -1.0);
    let shape = Cuboid { center, axes: if given("rotation") { turn } else { identity() }, half };
    let inside = values.flag("inside");
    let parts = if inside {
        // A container consists of the half-spaces behind its walls, so that a node in a corner meets each of them.
        let mut walls = Vec::with_capacity(2 * D);
        for d in 0..D {
            for side in [-1.0, 1.0] {
                let wall = add(&center, &scaled(&shape.axes[d], side * half[d]));
                walls.push(Part::HalfSpace(HalfSpace::through(&wall, scaled(&shape.axes[d], -side))));
            }
        }
        walls
    } else {
        vec![Part::Cuboid(shape)]
    };
    Ok((Form::Box { shape, inside }, parts, center))
}

fn ball<const D: usize>(values: &Values) -> Built<D> {
    let (center, inside) = (values.vector::<D>("center"), values.flag("inside"));
    let radius = values.number("radius").unwrap_or(0.0);
    let ball = Ball { center, radius, sign: if inside { -1.0 } else { 1.0 } };
    (Form::Ball { center, radius, inside }, vec![Part::Ball(ball)], center)
}

fn capsule<const D: usize>(values: &Values) -> Result<Built<D>, BuildError> {
    let (a, b) = (values.vector::<D>("a"), values.vector::<D>("b"));
    let radius = values.number("radius").unwrap_or(0.0);
    let along = subtract(&b, &a);
    let square = dot(&along, &along);
    if !(square > 1e-280 && square.is_finite()) {
        return Err(refused(values, Refusal::NoAxis { a: shown(values, "a"), b: shown(values, "b") }));
    }
    // The coordinate axis that is closest to perpendicular to the segment, made exactly perpendicular.
    let mut least = 0;
    for d in 1..D {
        if along[d].abs() < along[least].abs() {
            least = d;
        }
    }
    let mut aside = scaled(&along, -along[least] / square);
    aside[least] += 1.0;
    let aside = scaled(&aside, 1.0 / length(&aside));
    let capsule = Capsule { start: a, along, inverse_square: 1.0 / square, radius, aside };
    Ok((Form::Capsule { a, b, radius }, vec![Part::Capsule(capsule)], add(&a, &scaled(&along, 0.5))))
}

/// The points of a field, and the centre of their bounding box.
fn points<const D: usize>(values: &Values) -> Result<(Vec<[f64; D]>, [f64; D]), BuildError> {
    let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
    let mut points = Vec::new();
    for row in values.rows("points") {
        let mut point = [0.0; D];
        for d in 0..D.min(row.len()) {
            point[d] = row[d];
            low[d] = point[d].smaller(low[d]);
            high[d] = point[d].larger(high[d]);
        }
        points.push(point);
    }
    // Squares of lengths must stay finite.
    let fits = magnitude(&subtract(&high, &low)) < 1e100;
    if points.is_empty() || !fits {
        let (low, high) = (format!("{low:?}"), format!("{high:?}"));
        return Err(refused(values, Refusal::FarPoints { count: points.len(), low, high }));
    }
    Ok((points, scaled(&add(&low, &high), 0.5)))
}

fn convex<const D: usize>(values: &Values) -> Result<Built<D>, BuildError> {
    let (points, center) = points::<D>(values)?;
    let count = points.len();
    let flat = || if D == 2 { Refusal::NoArea { count } } else { Refusal::NoVolume { count } };
    let (facets, faces) = Facets::convex(&points).map_err(|_| refused(values, flat()))?;
    let form = if D == 2 {
        // Each face runs clockwise, but the faces are listed counterclockwise. Their second corners therefore list the polygon
        // counterclockwise.
        Form::Polygon { points: faces.iter().map(|f| points[f[1]]).collect() }
    } else {
        Form::Triangles {
            points,
            triangles: faces.iter().map(|f| [f[0] as u32, f[1] as u32, f[D - 1] as u32]).collect(),
            solid: true,
        }
    };
    Ok((form, vec![Part::Facets(facets)], center))
}

fn polyline<const D: usize>(values: &Values) -> Result<Built<D>, BuildError> {
    let (points, center) = points::<D>(values)?;
    let closed = values.flag("closed");
    let least = if closed { 3 } else { 2 };
    if points.len() < least {
        return Err(refused(values, Refusal::FewPoints { count: points.len(), least }));
    }
    let count = if closed { points.len() } else { points.len() - 1 };
    let mut segments = Vec::with_capacity(count);
    for k in 0..count {
        let mut corners = [points[k]; D];
        corners[1] = points[(k + 1) % points.len()];
        segments.push(corners);
    }
    let facets = Facets::surface(&segments).map_err(|flaw| match flaw {
        Flaw::Degenerate(k) => {
            let (first, second, position) = (k, (k + 1) % points.len(), format!("{:?}", points[k]));
            refused(values, Refusal::SamePoints { first, second, position })
        }
        Flaw::Flat => refused(values, Refusal::NoExtent {}),
    })?;
    Ok((Form::Polyline { points, closed }, vec![Part::Facets(facets)], center))
}

fn triangle_mesh<const D: usize>(values: &Values) -> Result<Built<D>, BuildError> {
    let (points, center) = points::<D>(values)?;
    let numbers = values.integers("triangles");
    if numbers.is_empty() || !numbers.len().is_multiple_of(3) {
        return Err(refused(values, Refusal::Triangles { count: numbers.len() }));
    }
    let mut corners = Vec::with_capacity(numbers.len() / 3);
    let mut triangles = Vec::with_capacity(numbers.len() / 3);
    for triangle in numbers.chunks_exact(3) {
        let mut corner = [points[0]; D];
        for (k, &number) in triangle.iter().enumerate() {
            let Some(point) = points.get(number as usize) else {
                return Err(refused(values, Refusal::NoPoint { point: number, last: points.len() - 1 }));
            };
            corner[k % D] = *point;
        }
        corners.push(corner);
        triangles.push([triangle[0], triangle[1], triangle[2]]);
    }
    let facets = Facets::surface(&corners).map_err(|flaw| match flaw {
        Flaw::Degenerate(k) => {
            refused(values, Refusal::FlatTriangle { triangle: k, points: format!("{:?}", triangles[k]) })
        }
        Flaw::Flat => refused(values, Refusal::NoExtent {}),
    })?;
    Ok((Form::Triangles { points, triangles, solid: false }, vec![Part::Facets(facets)], center))
}

/// The number (2D) or vector (3D) of a rotation; zeros if there is none.
fn spin(values: &Values, field: &str) -> [f64; 3] {
    match values.number(field) {
        Some(number) => [number, 0.0, 0.0],
        None => values.vector::<3>(field),
    }
}

fn motion<const D: usize>(values: &Values, center: &[f64; D]) -> Motion<D> {
    let spin = spin(values, "spin");
    Motion {
        path: values.rows("motion").to_vec(),
        omega: turning(&spin),
        turns: spin.iter().any(|s| *s != 0.0),
        pivot: if values.get("pivot").is_some() { values.vector("pivot") } else { *center },
    }
}
