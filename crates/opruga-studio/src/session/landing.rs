//! Places a new body: at the pointer, or at the nearest position at which it intersects no other body and no obstacle.

use super::Session;
use super::edits::shift;
use crate::document::read;
use opruga::draw::ColliderPicture;
use toml_edit::InlineTable;

/// The lowest and the highest corner of a box [m].
type Ends = [[f64; 3]; 2];

/// The spacing of the positions that are tried, in the plane and in space, relative to the size of the body. The positions that are tried are up to
/// six body sizes away in the plane, and up to four in space.
const APART: [f64; 2] = [0.25, 0.5];
const TRIED: [i32; 2] = [24, 8];
/// The gap between a body and its neighbours, relative to the size of the body.
const GAP: f64 = 0.02;

/// The box around points.
fn around(points: impl Iterator<Item = [f64; 3]>) -> Ends {
    let mut ends = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for point in points {
        for d in 0..3 {
            (ends[0][d], ends[1][d]) = (ends[0][d].min(point[d]), ends[1][d].max(point[d]));
        }
    }
    ends
}

fn moved(ends: Ends, by: [f64; 3]) -> Ends {
    ends.map(|corner| [0, 1, 2].map(|d| corner[d] + by[d]))
}

fn grown(ends: Ends, by: f64) -> Ends {
    [ends[0].map(|x| x - by), ends[1].map(|x| x + by)]
}

/// Whether two boxes intersect; in the plane only two axes count.
fn meet(a: &Ends, b: &Ends, dimension: usize) -> bool {
    (0..dimension).all(|d| a[0][d] <= b[1][d] && b[0][d] <= a[1][d])
}

/// Whether a body in this box may intersect an obstacle. A body inside a container does not intersect the container. `hollow` distinguishes hollow
/// from solid obstacles whose pictures are equal.
fn is_in(ends: &Ends, obstacle: &ColliderPicture, hollow: bool, dimension: usize) -> bool {
    let meets = |other: &Ends| meet(ends, other, dimension);
    match obstacle {
        ColliderPicture::HalfSpace { point, normal } => {
            let lowest = [0, 1, 2].map(|d| if normal[d] > 0.0 { ends[0][d] } else { ends[1][d] });
            (0..dimension).map(|d| normal[d] * (lowest[d] - point[d])).sum::<f64>() < 0.0
        }
        ColliderPicture::Box { min, max, inside: true } => {
            (0..dimension).any(|d| ends[0][d] < min[d] || ends[1][d] > max[d])
        }
        ColliderPicture::Box { min, max, .. } => meets(&[*min, *max]),
        _ if hollow => false,
        ColliderPicture::Ball { center, radius } => {
            let away = |d: usize| center[d] - center[d].clamp(ends[0][d], ends[1][d]);
            (0..dimension).map(|d| away(d) * away(d)).sum::<f64>() < radius * radius
        }
        ColliderPicture::Capsule { a, b, radius } => meets(&grown(around([*a, *b].into_iter()), *radius)),
        ColliderPicture::Polygon(points) => meets(&around(points.iter().copied())),
        ColliderPicture::Polyline(points) => points.windows(2).any(|side| meets(&around(side.iter().copied()))),
        ColliderPicture::Mesh { positions, triangles } => triangles.iter().any(|corners| {
            meets(&around(corners.iter().filter_map(|corner| positions.get(*corner as usize).copied())))
        }),
    }
}

/// Returns the free displacement that is nearest to the desired one among those that are tried; the desired one if none is free. Of two displacements
/// that are equally near, the one that leads higher is chosen.
fn nearest(wanted: [f64; 3], size: f64, dimension: usize, free: impl Fn([f64; 3]) -> bool) -> [f64; 3] {
    if free(wanted) {
        return wanted;
    }
    let space = usize::from(dimension == 3);
    let (apart, most) = (APART[space] * size, TRIED[space]);
    let deep = if dimension == 3 { most } else { 0 };
    let steps = (-most..=most).flat_map(|y| (-most..=most).flat_map(move |x| (-deep..=deep).map(move |z| [x, y, z])));
    let mut steps: Vec<[i32; 3]> = steps.collect();
    steps.sort_by_key(|[x, y, z]| (x * x + y * y + z * z, -y, -x, -z));
    let displacements = steps.into_iter().map(|step| [0, 1, 2].map(|d| wanted[d] + apart * f64::from(step[d])));
    displacements.into_iter().find(|displacement| free(*displacement)).unwrap_or(wanted)
}

impl Session {
    /// Moves the table of a new body so that its centre is at a point, or at the nearest free position.
    pub(super) fn land(&mut self, table: &mut InlineTable, at: [f64; 3]) {
        let dimension = self.dimension();
        // A table that cannot be read is refused later, when the body is added.
        let Some([low, high]) = self.box_of(table) else { return shift(table, at, dimension) };
        let by = self.free_displacement(table, [0, 1, 2].map(|d| at[d] - 0.5 * (low[d] + high[d])));
        // The displacement is rounded to a hundredth of the size of the body, because users do not point more precisely.
        let size = (0..dimension).map(|d| high[d] - low[d]).fold(0.0, f64::max);
        let unit = if size > 0.0 { 10f64.powi(size.log10().floor() as i32 - 2) } else { 0.01 };
        let rounded = by.map(|x| {
            // A unit below 1 is the reciprocal of a whole number. Dividing by this whole number gives 0.01 instead of 0.010000000000000002.
            if unit < 1.0 { (x / unit).round() / (1.0 / unit).round() } else { (x / unit).round() * unit }
        });
        shift(table, rounded, dimension);
    }

    /// Returns the displacement nearest to the desired one at which a body with this table intersects nothing.
    pub(super) fn free_displacement(&mut self, table: &InlineTable, wanted: [f64; 3]) -> [f64; 3] {
        let Some(own) = self.box_of(table) else { return wanted };
        let shown = self.engine.shown(&self.show);
        let dimension = usize::from(shown.dimension);
        let size = (0..dimension).map(|d| own[1][d] - own[0][d]).fold(0.0, f64::max);
        // A body of zero size needs no search.
        if !(size > 0.0 && wanted.iter().all(|x| x.is_finite())) {
            return wanted;
        }
        let hollow = shown.obstacles.iter().any(|obstacle| obstacle.values.flag("inside"));
        let free = |by: [f64; 3]| {
            let ends = grown(moved(own, by), GAP * size);
            let bodies = shown.extents.iter().all(|extent| !meet(&ends, &extent.corners, dimension));
            bodies && shown.picture.colliders.iter().all(|obstacle| !is_in(&ends, obstacle, hollow, dimension))
        };
        nearest(wanted, size, dimension, free)
    }

    /// The box around a body as placed by its table; none if the table cannot be read.
    fn box_of(&self, table: &InlineTable) -> Option<Ends> {
        let (blueprint, _) = read(&self.document.alone(table), &self.files, &self.setting.registries).ok()?;
        let body = blueprint.scene().bodies().last()?;
        let translation = body.translation();
        Some(around(body.rest_positions().into_iter().map(|point| [0, 1, 2].map(|d| point[d] + translation[d]))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_body_is_in_no_obstacle_and_in_its_container() {
        let unit: Ends = [[0.0; 3], [1.0, 1.0, 0.0]];
        let floor = |height: f64| ColliderPicture::HalfSpace { point: [0.0, height, 0.0], normal: [0.0, 1.0, 0.0] };
        let ball = |x: f64| ColliderPicture::Ball { center: [x, 0.5, 0.0], radius: 0.5 };
        let room = |inside| ColliderPicture::Box { min: [-1.0; 3], max: [2.0; 3], inside };
        let line = ColliderPicture::Polyline(vec![[-1.0, 2.0, 0.0], [2.0, 2.0, 0.0], [2.0, -1.0, 0.0]]);
        for (obstacle, wanted) in [
            (floor(-0.1), false),
            (floor(0.1), true),
            (ball(2.0), false),
            (ball(1.4), true),
            (room(false), true),
            (room(true), false),
            // The tested box is inside the box around the whole line, but intersects none of its segments.
            (line, false),
        ] {
            assert_eq!(is_in(&unit, &obstacle, false, 2), wanted, "{obstacle:?}");
        }
        assert!(!is_in(&unit, &ball(1.4), true, 2), "it may be a container");
    }

    #[test]
    fn the_nearest_free_place_is_taken_the_higher_one_of_two_and_the_wanted_one_where_there_is_none() {
        let free = |by: [f64; 3]| by[0].abs() > 0.6 || by[1].abs() > 0.6;
        assert_eq!(nearest([5.0, 0.0, 0.0], 1.0, 2, free), [5.0, 0.0, 0.0]);
        assert_eq!(nearest([0.0; 3], 1.0, 2, free), [0.0, 0.75, 0.0]);
        assert_eq!(nearest([0.4, 0.0, 0.0], 1.0, 2, free), [0.65, 0.0, 0.0]);
        assert_eq!(nearest([0.4, 0.0, 0.0], 1.0, 3, |_| false), [0.4, 0.0, 0.0]);
    }
}
