//! What all pictures of a run have in common: the part of space, the range of scalars and the scale of arrows.

use crate::error::DrawError;
use crate::picture::{ArrowKind, ColliderPicture, Picture};
use std::collections::BTreeMap;

/// The length of the longest arrow of a kind, as a share of the larger side of the view.
const LONGEST_ARROW: f64 = 0.14;

/// The part of space which is seen, and the common scales of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// The lowest corner of the box which must be seen [m].
    pub low: [f64; 3],
    /// The highest corner of the box which must be seen [m].
    pub high: [f64; 3],
    /// The scalars at the ends of the colours, where there is any: the smallest and the largest, but for a few strays.
    pub scalars: Option<[f64; 2]>,
    /// Whether there are strays below and above these.
    pub strays: [bool; 2],
    /// Whether y counts downwards, as on a screen; only in two dimensions.
    pub y_down: bool,
    /// The length of the longest vector of each kind of arrow.
    pub longest: BTreeMap<ArrowKind, f64>,
    /// The angle of the camera around the y axis, from z towards x [degrees]; only in three dimensions.
    pub azimuth: f64,
    /// The angle of the camera above the horizon [degrees]; only in three dimensions.
    pub elevation: f64,
}

/// A box along the axes which grows with each point.
struct Bounds {
    /// The lowest corner.
    low: [f64; 3],
    /// The highest corner.
    high: [f64; 3],
}

impl Bounds {
    /// A box around nothing.
    fn empty() -> Bounds {
        Bounds { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] }
    }

    /// Takes a ball into the box; points which are not finite are left out.
    fn add(&mut self, point: [f64; 3], radius: f64) {
        if point.iter().all(|value| value.is_finite()) && radius.is_finite() {
            for axis in 0..3 {
                self.low[axis] = self.low[axis].min(point[axis] - radius);
                self.high[axis] = self.high[axis].max(point[axis] + radius);
            }
        }
    }

    /// Whether nothing was added.
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
        (0..3).map(|axis| (self.high[axis] - self.low[axis]).powi(2)).sum::<f64>().sqrt()
    }
}

impl View {
    /// The view which shows everything in all pictures of a run.
    pub fn fit<'a>(pictures: impl IntoIterator<Item = &'a Picture>) -> Result<View, DrawError> {
        let pictures: Vec<&Picture> = pictures.into_iter().collect();
        let mut bounds = Bounds::empty();
        let mut longest = BTreeMap::new();
        let mut planes: Vec<([f64; 3], [f64; 3])> = Vec::new();
        for picture in &pictures {
            for body in &picture.bodies {
                body.positions.iter().for_each(|&position| bounds.add(position, 0.0));
            }
            for pull in &picture.pulls {
                bounds.add(pull.pointer, 0.0);
            }
            for arrow in &picture.arrows {
                let length = arrow.vector.iter().map(|value| value * value).sum::<f64>().sqrt();
                let longest: &mut f64 = longest.entry(arrow.kind).or_insert(0.0);
                *longest = longest.max(if length.is_finite() { length } else { 0.0 });
            }
            for collider in &picture.colliders {
                match collider {
                    ColliderPicture::HalfSpace { point, normal } => {
                        if !planes.contains(&(*point, *normal)) {
                            planes.push((*point, *normal));
                        }
                    }
                    bounded => add_collider(&mut bounds, bounded),
                }
            }
        }
        if bounds.is_empty() {
            return Err(DrawError::Empty("no body has a node at a finite place"));
        }
        let diagonal = bounds.diagonal().max(1e-9);
        for (point, normal) in planes {
            let length = normal.iter().map(|value| value * value).sum::<f64>().sqrt();
            if length > 0.0 {
                take_plane(&mut bounds, point, normal.map(|value| value / length), diagonal);
            }
        }
        let scalars = pictures.iter().flat_map(|picture| &picture.bodies).flat_map(|body| &body.scalar).copied();
        let (scalars, strays) = range_of(scalars);
        let y_down = pictures.iter().any(|picture| picture.y_down);
        let view = View { strays, y_down, ..View::of(&bounds, scalars, longest) };
        for arrow in pictures.iter().flat_map(|picture| &picture.arrows) {
            let scale = view.arrow_scale(arrow.kind);
            bounds.add(std::array::from_fn(|axis| arrow.from[axis] + scale * arrow.vector[axis]), 0.0);
        }
        Ok(View { low: bounds.low, high: bounds.high, ..view })
    }

    /// The view of a box, from a little above and aside.
    fn of(bounds: &Bounds, scalars: Option<[f64; 2]>, longest: BTreeMap<ArrowKind, f64>) -> View {
        View {
            low: bounds.low,
            high: bounds.high,
            scalars,
            strays: [false; 2],
            y_down: false,
            longest,
            azimuth: 32.0,
            elevation: 20.0,
        }
    }

    /// The larger side of the view [m].
    pub fn extent(&self) -> f64 {
        (0..3).map(|axis| self.high[axis] - self.low[axis]).fold(1e-12, f64::max)
    }

    /// The centre of the view [m].
    pub fn center(&self) -> [f64; 3] {
        std::array::from_fn(|axis| 0.5 * (self.low[axis] + self.high[axis]))
    }

    /// The length which an arrow of a kind is drawn with, for each unit of its vector [m].
    pub fn arrow_scale(&self, kind: ArrowKind) -> f64 {
        match self.longest.get(&kind) {
            Some(&longest) if longest > 0.0 => LONGEST_ARROW * self.extent() / longest,
            _ => 0.0,
        }
    }

    /// The side of the squares of floors and walls [m].
    pub(crate) fn square(&self) -> f64 {
        crate::ticks::nice_length(0.3 * self.extent())
    }

    /// The place of a scalar from 0 to 1 between the ends of a range.
    pub(crate) fn place(range: [f64; 2], scalar: f64) -> f64 {
        if range[1] > range[0] { (scalar - range[0]) / (range[1] - range[0]) } else { 0.5 }
    }

    /// The range of scalars which a picture uses: its own, or the one of the run.
    pub(crate) fn range(&self, picture: &Picture) -> [f64; 2] {
        let own = picture.legend.as_ref().and_then(|legend| legend.range);
        own.or(self.scalars).unwrap_or([0.0, 1.0])
    }
}

/// The smallest and the largest of some scalars, and whether some of them are left out below and above.
///
/// One scalar in two hundred may be left out at each end, where this makes the range smaller by a sixth.
fn range_of(scalars: impl Iterator<Item = f64> + Clone) -> (Option<[f64; 2]>, [bool; 2]) {
    const BINS: usize = 4096;
    let scalars = scalars.filter(|scalar| scalar.is_finite());
    let ends = scalars.clone().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], s| [low.min(s), high.max(s)]);
    let [low, high] = ends;
    let width = high - low;
    if low > high || width <= 0.0 || !width.is_finite() {
        return ((low <= high).then_some(ends), [false; 2]);
    }
    let mut counts = [0_u64; BINS];
    for scalar in scalars {
        counts[(((scalar - low) / width * BINS as f64) as usize).min(BINS - 1)] += 1;
    }
    let spare = counts.iter().sum::<u64>() / 200;
    let few = |bins: &mut dyn Iterator<Item = &u64>| {
        let mut left = spare;
        let bins = bins.take_while(|count| left.checked_sub(**count).map(|rest| left = rest).is_some()).count();
        if bins > BINS / 6 { bins } else { 0 }
    };
    let (below, above) = (few(&mut counts.iter()), few(&mut counts.iter().rev()));
    if below + above >= BINS {
        return (Some(ends), [false; 2]);
    }
    let bin = width / BINS as f64;
    (Some([low + below as f64 * bin, high - above as f64 * bin]), [below > 0, above > 0])
}

/// Takes an obstacle with an end into the box.
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

/// Makes the box reach the surface of a half space, unless that is far away.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::BodyPicture;

    #[test]
    fn a_few_strays_do_not_spread_the_colours() {
        let even = || (0..1000).map(f64::from);
        assert_eq!(range_of(even()), (Some([0.0, 999.0]), [false; 2]));
        let (range, strays) = range_of(even().chain([5000.0, 5001.0]));
        let [low, high] = range.expect("a range");
        assert!(low == 0.0 && (990.0..1010.0).contains(&high) && strays == [false, true], "{low} {high} {strays:?}");
        assert_eq!(range_of([3.0, f64::NAN].into_iter()), (Some([3.0, 3.0]), [false; 2]));
        assert_eq!(range_of(std::iter::empty()), (None, [false; 2]));
    }

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
}
