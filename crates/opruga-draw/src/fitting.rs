//! Finds the view that suits all pictures of a run. The pictures are added one after another.

use crate::error::{DrawError, Nothing};
use crate::flat::BORDER;
use crate::picture::{ArrowKind, ColliderPicture, Picture, Sight};
use crate::solid::{cast, directions_of_view};
use crate::view::View;
use std::collections::BTreeMap;

/// The number of scalars of a picture that are sampled to find the range of the colours.
const SAMPLE: usize = 20_000;
/// The fraction of the scalars that may be outside the colour range at each end.
const STRAYS: f64 = 0.03;

/// The extents of all pictures added so far. The pictures themselves are not kept.
#[derive(Clone, Debug)]
pub struct Fitting {
    /// The box around everything.
    bounds: Bounds,
    /// The farthest points in many directions, for a camera in space.
    farthest: Vec<([f64; 3], f64, [f64; 3])>,
    /// The planes of half spaces, each given by a point and a normal.
    planes: Vec<([f64; 3], [f64; 3])>,
    /// Some of the scalars of every picture.
    scalars: Vec<f64>,
    /// The smallest and the largest scalar.
    ends: [f64; 2],
    /// The lengths of the vectors of each kind of arrow.
    lengths: BTreeMap<ArrowKind, Vec<f64>>,
    /// The box around the points at which arrows start.
    starts: Bounds,
    /// The sizes of the bodies of the first picture.
    sizes: Vec<f64>,
    /// Whether a picture has y pointing downwards.
    y_down: bool,
    /// The sight of the first picture.
    sight: Option<Sight>,
}

/// An axis-aligned box that grows with each point.
#[derive(Clone, Copy, Debug)]
struct Bounds {
    /// The lowest corner.
    low: [f64; 3],
    /// The highest corner.
    high: [f64; 3],
}

impl Bounds {
    /// An empty box.
    fn empty() -> Bounds {
        Bounds { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] }
    }

    /// Extends the box to include a ball; points that are not finite are ignored.
    fn add(&mut self, point: [f64; 3], radius: f64) {
        if point.iter().all(|value| value.is_finite()) && radius.is_finite() {
            for axis in 0..3 {
                self.low[axis] = self.low[axis].min(point[axis] - radius);
                self.high[axis] = self.high[axis].max(point[axis] + radius);
            }
        }
    }

    /// Whether no point was added.
    fn is_empty(&self) -> bool {
        self.low[0] > self.high[0]
    }

    /// The eight corners.
    fn corners(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        (0..8).map(|corner| {
            std::array::from_fn(|axis| if corner >> axis & 1 == 0 { self.low[axis] } else { self.high[axis] })
        })
    }

    /// The length of the diagonal.
    fn diagonal(&self) -> f64 {
        length(std::array::from_fn(|axis| self.high[axis] - self.low[axis]))
    }

    /// The longest side.
    fn side(&self) -> f64 {
        (0..3).map(|axis| self.high[axis] - self.low[axis]).fold(0.0, f64::max)
    }
}

/// The length of a vector.
fn length(vector: [f64; 3]) -> f64 {
    vector.iter().map(|value| value * value).sum::<f64>().sqrt()
}

impl Default for Fitting {
    fn default() -> Fitting {
        let steps = || [-2.0, -1.0, 0.0, 1.0, 2.0];
        let all = steps().into_iter().flat_map(|x| steps().into_iter().flat_map(move |y| steps().map(|z| [x, y, z])));
        let outer = all.filter(|d: &[f64; 3]| d.iter().any(|value| value.abs() == 2.0));
        let farthest = outer.map(|d| (d.map(|value| value / length(d)), f64::NEG_INFINITY, [0.0; 3])).collect();
        Fitting {
            bounds: Bounds::empty(),
            farthest,
            planes: Vec::new(),
            scalars: Vec::new(),
            ends: [f64::INFINITY, f64::NEG_INFINITY],
            lengths: BTreeMap::new(),
            starts: Bounds::empty(),
            sizes: Vec::new(),
            y_down: false,
            sight: None,
        }
    }
}

impl Fitting {
    /// Adds a picture.
    pub fn add(&mut self, picture: &Picture) {
        self.y_down |= picture.y_down;
        self.sight.get_or_insert(picture.sight);
        let first = self.sizes.is_empty();
        for body in &picture.bodies {
            let mut around = Bounds::empty();
            body.positions.iter().for_each(|&position| around.add(position, 0.0));
            if around.is_empty() {
                continue;
            }
            if first {
                self.sizes.push(around.side());
            }
            body.rest.positions.iter().for_each(|&position| around.add(position, 0.0));
            self.take(&around);
            if picture.dimension == 3 {
                let points = body.positions.iter().chain(&body.rest.positions);
                points.for_each(|&position| self.reach(position));
            }
        }
        for pull in &picture.pulls {
            self.bounds.add(pull.pointer, 0.0);
            self.reach(pull.pointer);
        }
        for arrow in &picture.arrows {
            let long = length(arrow.vector);
            if long.is_finite() {
                self.lengths.entry(arrow.kind).or_default().push(long);
                self.starts.add(arrow.from, 0.0);
            }
        }
        for collider in &picture.colliders {
            match collider {
                ColliderPicture::HalfSpace { point, normal } => {
                    let long = length(*normal);
                    let plane = (*point, normal.map(|value| value / long));
                    if long > 0.0 && !self.planes.contains(&plane) {
                        self.planes.push(plane);
                    }
                }
                bounded => {
                    let mut around = Bounds::empty();
                    add_collider(&mut around, bounded);
                    self.take(&around);
                    around.corners().for_each(|corner| self.reach(corner));
                }
            }
        }
        self.sample(picture);
    }

    /// Extends the box to include another box.
    fn take(&mut self, other: &Bounds) {
        self.bounds.add(other.low, 0.0);
        self.bounds.add(other.high, 0.0);
    }

    /// Keeps a point if it is the farthest in some direction.
    fn reach(&mut self, point: [f64; 3]) {
        if point.iter().any(|value| !value.is_finite()) {
            return;
        }
        for (direction, most, farthest) in &mut self.farthest {
            let far = direction[0] * point[0] + direction[1] * point[1] + direction[2] * point[2];
            if far > *most {
                (*most, *farthest) = (far, point);
            }
        }
    }

    /// Keeps a sample of the scalars of a picture, evenly distributed.
    fn sample(&mut self, picture: &Picture) {
        let all: usize = picture.bodies.iter().map(|body| body.scalar.len()).sum();
        // An odd step does not select the same nodes of every body.
        let every = (all / SAMPLE) | 1;
        let scalars = picture.bodies.iter().flat_map(|body| &body.scalar).copied();
        for (index, scalar) in scalars.filter(|scalar| scalar.is_finite()).enumerate() {
            self.ends = [self.ends[0].min(scalar), self.ends[1].max(scalar)];
            if index % every == 0 {
                self.scalars.push(scalar);
            }
        }
    }

    /// Ignores the region that the pictures request, so that everything is shown.
    pub fn everything(mut self) -> Fitting {
        self.sight.iter_mut().for_each(|sight| sight.region = None);
        self
    }

    /// Returns the view that shows everything in the pictures, or the region that they request.
    pub fn finish(mut self) -> Result<View, DrawError> {
        if self.bounds.is_empty() {
            return Err(DrawError::Empty { nothing: Nothing::FinitePlace });
        }
        let diagonal = self.bounds.diagonal().max(1e-9);
        for (point, normal) in &self.planes {
            take_plane(&mut self.bounds, *point, *normal, diagonal);
        }
        let longest = self.lengths.iter_mut().map(|(&kind, lengths)| (kind, quantile(lengths, 0.95))).collect();
        let size = quantile(&mut self.sizes, 0.5);
        let arrow = View::long_arrow(self.bounds.side(), if size > 0.0 { size } else { f64::INFINITY });
        if !self.starts.is_empty() {
            let starts = self.starts;
            self.bounds.add(starts.low, arrow);
            self.bounds.add(starts.high, arrow);
        }
        let sight = self.sight.unwrap_or_default();
        if let Some([low, high]) = sight.region {
            // A picture in the plane later gets a border. The border is subtracted here, so that the requested region is shown exactly.
            let border = if low[2] == high[2] { BORDER / (1.0 + 2.0 * BORDER) } else { 0.0 };
            let side = border * Bounds { low, high }.side();
            self.bounds = Bounds { low, high };
            for axis in 0..2 {
                let inset = side.min(0.4 * (high[axis] - low[axis]));
                self.bounds.low[axis] += inset;
                self.bounds.high[axis] -= inset;
            }
        }
        let (scalars, strays) = range_of(&mut self.scalars, self.ends);
        let mut view = View {
            low: self.bounds.low,
            high: self.bounds.high,
            points: Vec::new(),
            scalars,
            strays,
            y_down: self.y_down,
            longest,
            arrow,
            body: size,
            azimuth: sight.azimuth.unwrap_or(32.0),
            elevation: sight.elevation.unwrap_or(20.0),
        };
        if sight.region.is_some() {
            // The camera must see the corners of the box.
            return Ok(view);
        }
        let spread = if self.starts.is_empty() { 0.0 } else { arrow };
        let seen = self.farthest.iter().filter(|(_, most, _)| most.is_finite());
        let mut points: Vec<[f64; 3]> =
            seen.map(|(direction, _, p)| std::array::from_fn(|axis| p[axis] + spread * direction[axis])).collect();
        let floor = self.planes.iter().find(|(_, normal)| normal[1] > 0.6);
        if let Some((point, normal)) = floor {
            let (_, light) = directions_of_view(&view);
            let shadows: Vec<[f64; 3]> = points.iter().map(|&p| cast(p, *point, *normal, light)).collect();
            points.extend(shadows);
        }
        view.points = points;
        Ok(view)
    }
}

/// The value that a given fraction of the values does not exceed; 0 if there are no values.
fn quantile(values: &mut [f64], share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let index = (share * values.len().saturating_sub(1) as f64).round() as usize;
    values.get(index).copied().unwrap_or(0.0)
}

/// Returns the colour range of scalars, and whether some scalars are below and above it.
///
/// At each end, three per cent of the scalars may be outside the range if leaving them out reduces it by more than a sixth.
fn range_of(scalars: &mut [f64], ends: [f64; 2]) -> (Option<[f64; 2]>, [bool; 2]) {
    let width = ends[1] - ends[0];
    if width.is_nan() || width < 0.0 || scalars.is_empty() {
        return (None, [false; 2]);
    }
    // Rounding errors are not data.
    if width <= 1e-9 * ends[0].abs().max(ends[1].abs()).max(1.0) {
        return (Some([ends[0]; 2]), [false; 2]);
    }
    let inner = [quantile(scalars, STRAYS), quantile(scalars, 1.0 - STRAYS)];
    let strays = [inner[0] - ends[0] > width / 6.0, ends[1] - inner[1] > width / 6.0];
    let range = [0, 1].map(|end| if strays[end] { inner[end] } else { ends[end] });
    if range[1] > range[0] { (Some(range), strays) } else { (Some(ends), [false; 2]) }
}

/// Extends the box to include a bounded obstacle.
fn add_collider(bounds: &mut Bounds, collider: &ColliderPicture) {
    match collider {
        ColliderPicture::HalfSpace { .. } => {}
        ColliderPicture::Box { min, max, .. } => {
            bounds.add(*min, 0.0);
            bounds.add(*max, 0.0);
        }
        ColliderPicture::Ball { center, radius } => bounds.add(*center, *radius),
        ColliderPicture::Capsule { a, b, radius } => {
            bounds.add(*a, *radius);
            bounds.add(*b, *radius);
        }
        ColliderPicture::Polygon(points) | ColliderPicture::Polyline(points) => {
            points.iter().for_each(|&point| bounds.add(point, 0.0));
        }
        ColliderPicture::Mesh { positions, .. } => positions.iter().for_each(|&point| bounds.add(point, 0.0)),
    }
}

/// Extends the box to the surface of a half space, unless this surface is far away.
fn take_plane(bounds: &mut Bounds, point: [f64; 3], normal: [f64; 3], diagonal: f64) {
    let height = |corner: [f64; 3]| (0..3).map(|axis| (corner[axis] - point[axis]) * normal[axis]).sum::<f64>();
    let gap = bounds.corners().map(height).fold(f64::INFINITY, f64::min);
    if gap.is_finite() && gap < diagonal {
        let step = (gap + 0.03 * diagonal).max(0.0);
        for axis in 0..3 {
            let shift = -normal[axis] * step;
            bounds.low[axis] += shift.min(0.0);
            bounds.high[axis] += shift.max(0.0);
        }
    }
}

impl View {
    /// The view that shows everything in all pictures of a run.
    pub fn fit<'a>(pictures: impl IntoIterator<Item = &'a Picture>) -> Result<View, DrawError> {
        let mut fitting = Fitting::default();
        pictures.into_iter().for_each(|picture| fitting.add(picture));
        fitting.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_region_is_what_strips_show_and_films_show_everything() {
        use crate::picture::BodyPicture;
        let body = BodyPicture { positions: vec![[0.0; 3], [9.0, 4.0, 2.0]], ..Default::default() };
        for dimension in [2, 3] {
            let region = [[1.0, 1.0, 0.0], [3.0, 2.0, 1.0]];
            let sight = Sight { region: Some(region), azimuth: Some(-20.0), elevation: None };
            let picture = Picture { dimension, sight, bodies: vec![body.clone()], ..Default::default() };
            let mut fitting = Fitting::default();
            fitting.add(&picture);
            let (part, whole) =
                (fitting.clone().finish().expect("a view"), fitting.everything().finish().expect("a view"));
            if dimension == 3 {
                assert_eq!([part.low, part.high], region);
            }
            let flat = Sight { region: Some(region.map(|[x, y, _]| [x, y, 0.0])), ..sight };
            let flat = View::fit([&Picture { sight: flat, ..picture.clone() }]).expect("a view");
            let border = BORDER * flat.extent();
            for axis in 0..2 {
                assert!((flat.low[axis] - border - region[0][axis]).abs() < 1e-12, "{:?}", flat.low);
                assert!((flat.high[axis] + border - region[1][axis]).abs() < 1e-12, "{:?}", flat.high);
            }
            assert_eq!([whole.low, whole.high], [[0.0; 3], [9.0, 4.0, 2.0]]);
            assert_eq!([part.azimuth, whole.azimuth, part.elevation], [-20.0, -20.0, 20.0]);
        }
    }

    #[test]
    fn a_few_strays_do_not_spread_the_colours() {
        let range = |mut scalars: Vec<f64>| {
            let ends = scalars.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], &s| [l.min(s), h.max(s)]);
            range_of(&mut scalars, ends)
        };
        let even = || (0..1000).map(f64::from);
        assert_eq!(range(even().collect()), (Some([0.0, 999.0]), [false; 2]));
        let (found, strays) = range(even().chain([5000.0, 5001.0]).collect());
        let [low, high] = found.expect("a range");
        assert!(low == 0.0 && (960.0..1010.0).contains(&high) && strays == [false, true], "{low} {high} {strays:?}");
        assert_eq!(range(vec![3.0]), (Some([3.0, 3.0]), [false; 2]));
        assert_eq!(range(Vec::new()), (None, [false; 2]));
    }

    #[test]
    fn a_net_with_two_tight_corners_uses_all_colours() {
        // One node in forty is stretched four times as much as any other.
        let mut scalars: Vec<f64> =
            (0..400).map(|i| if i % 40 == 0 { 40.0 } else { f64::from(i % 40) * 0.25 }).collect();
        let (found, strays) = range_of(&mut scalars, [0.0, 40.0]);
        let [_, high] = found.expect("a range");
        assert!(high < 11.0 && strays == [false, true], "{high} {strays:?}");
    }
}
