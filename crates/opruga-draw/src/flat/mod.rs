//! Pictures in two dimensions.

mod areas;
mod bodies;
mod colliders;
mod loops;
mod shade;

use crate::canvas::Canvas;
use crate::error::DrawError;
use crate::image::Image;
use crate::marks::{draw_arrows, draw_marks};
use crate::picture::{ArrowKind, ArrowPicture, Facets, Picture};
use crate::view::View;

/// The free border between the visible part and the frame, as a fraction of the larger side.
pub(crate) const BORDER: f64 = 0.04;

/// The mapping of points in the plane to pixels of the scene.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Projection {
    /// The number of pixels per metre.
    pub(crate) scale: f64,
    /// 1 if y points downwards as for pixels, otherwise -1.
    pub(crate) down: f64,
    /// The point that is drawn in the middle [m].
    center: [f64; 2],
    /// The size of the scene in pixels.
    pub(crate) size: [f32; 2],
}

impl Projection {
    /// The projection that shows the whole view in a scene.
    pub(crate) fn new(view: &View, width: u32, height: u32) -> Projection {
        let border = BORDER * view.extent();
        let wide = view.high[0] - view.low[0] + 2.0 * border;
        let tall = view.high[1] - view.low[1] + 2.0 * border;
        let center = view.center();
        Projection {
            scale: (f64::from(width) / wide).min(f64::from(height) / tall),
            down: if view.y_down { 1.0 } else { -1.0 },
            center: [center[0], center[1]],
            size: [width as f32, height as f32],
        }
    }

    /// The pixel of a point.
    pub(crate) fn pixel(&self, point: [f64; 3]) -> [f32; 2] {
        let far = 1e6;
        let x = 0.5 * f64::from(self.size[0]) + self.scale * (point[0] - self.center[0]);
        let y = 0.5 * f64::from(self.size[1]) + self.down * self.scale * (point[1] - self.center[1]);
        [x.clamp(-far, far) as f32, y.clamp(-far, far) as f32]
    }
}

/// Draws the scene of a picture in two dimensions, and returns the number of pixels per metre.
pub(crate) fn scene(
    picture: &Picture,
    view: &View,
    background: [u8; 3],
    [width, height]: [u32; 2],
    unit: f32,
) -> Result<(Image, f64), DrawError> {
    let mut scene = Image::new(width, height, background)?;
    let projection = Projection::new(view, width, height);
    let mut canvas = Canvas::new(&mut scene);
    for collider in &picture.colliders {
        colliders::draw(&mut canvas, collider, &projection, unit);
    }
    let project = |point: [f64; 3]| point.iter().all(|value| value.is_finite()).then(|| projection.pixel(point));
    // Arrows of pressure that point out of all bodies start at the outline and are drawn beneath the bodies, so that they do not cover neighbours.
    let (beneath, above): (Vec<ArrowPicture>, Vec<ArrowPicture>) =
        picture.arrows.iter().partition(|arrow| arrow.kind == ArrowKind::Pressure && leaves(picture, view, arrow));
    draw_arrows(&mut canvas, &beneath, view, unit, &project, &|_| true);
    bodies::draw(&mut canvas, picture, view, &projection, unit);
    draw_marks(&mut canvas, (picture, &above), view, background, unit, &project, &|_, _| true);
    Ok((scene, projection.scale))
}

/// Whether an arrow points from its start out of all bodies.
fn leaves(picture: &Picture, view: &View, arrow: &ArrowPicture) -> bool {
    // The tested point is near the start of the arrow as drawn.
    let share = 0.02 * view.arrow_scale(arrow.kind);
    let point: [f64; 2] = std::array::from_fn(|axis| arrow.from[axis] + share * arrow.vector[axis]);
    picture.bodies.iter().all(|body| {
        let Facets::Edges(edges) = &body.facets else { return true };
        let within = |axis: usize| {
            let along = || body.positions.iter().map(|position| position[axis]);
            along().any(|value| value <= point[axis]) && along().any(|value| value >= point[axis])
        };
        if !within(0) || !within(1) {
            return true;
        }
        let at = |node: u32| [body.positions[node as usize][0], body.positions[node as usize][1]];
        edges.iter().filter(|[a, b]| loops::crosses(at(*a), at(*b), point)).count() % 2 == 0
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::ColourMap;
    use crate::picture::{AreaPicture, BodyPicture, ColliderPicture, Legend};

    /// A square with a square hole, as an area.
    fn frame(colour: Option<[u8; 4]>) -> AreaPicture {
        let square = |s: f64| [[-s, -s, 0.0], [s, -s, 0.0], [s, s, 0.0], [-s, s, 0.0]];
        let positions = square(1.0).into_iter().chain(square(0.5)).collect();
        AreaPicture { colour, positions, ends: vec![4, 8], triangles: Vec::new() }
    }

    #[test]
    fn areas_are_painted_one_over_another_with_their_holes() {
        let dot = AreaPicture {
            colour: Some([0, 0, 255, 255]),
            positions: vec![[-0.2, -0.2, 0.0], [0.2, -0.2, 0.0], [0.0, 0.3, 0.0]],
            ends: vec![3],
            triangles: Vec::new(),
        };
        let positions = [[-2.0, -2.0], [2.0, -2.0], [2.0, 2.0], [-2.0, 2.0]].map(|[x, y]| [x, y, 0.0]).to_vec();
        let cells = vec![[0, 1, 2], [0, 2, 3]];
        let legend =
            Legend { label: String::new(), unit: String::new(), range: Some([0.0, 1.0]), map: ColourMap::Viridis };
        let at = |areas: Vec<AreaPicture>, scalar: Vec<f64>| {
            let body =
                BodyPicture { positions: positions.clone(), cells: cells.clone(), scalar, areas, ..Default::default() };
            let picture = Picture { bodies: vec![body], legend: Some(legend.clone()), ..Default::default() };
            picture.check().expect("it fits together");
            let view = View::fit([&picture]).expect("a view");
            let (image, scale) = scene(&picture, &view, [255; 3], [200, 200], 1.0).expect("an image");
            move |x: f64, y: f64| image.pixel((100.0 + scale * x) as u32, (100.0 - scale * y) as u32)
        };
        let painted = at(vec![frame(Some([255, 0, 0, 255])), dot], Vec::new());
        assert_eq!(painted(0.75, 0.0), [255, 0, 0]);
        assert_eq!(painted(0.0, 0.0), [0, 0, 255], "the dot in the hole");
        assert_eq!([painted(0.4, 0.4), painted(1.5, 0.0)], [[255; 3]; 2], "the hole, and the body around the drawing");
        // An area without a colour gets the colours of the nodes, clipped at its border.
        let shaded = at(vec![frame(None)], vec![1.0; 4]);
        assert_eq!(shaded(0.75, 0.0), [253, 231, 37]);
        assert_eq!([shaded(0.0, 0.0), shaded(1.5, 0.0)], [[255; 3]; 2]);
        // The colour is mixed with white in equal parts.
        assert_eq!(at(vec![frame(Some([0, 0, 0, 128]))], Vec::new())(0.75, 0.0), [127; 3]);
        let mut broken = frame(None);
        broken.ends = vec![4, 7];
        let body = BodyPicture { positions: positions.clone(), areas: vec![broken], ..Default::default() };
        assert!(Picture { bodies: vec![body], ..Default::default() }.check().is_err());
    }

    /// An area whose lower half is folded up over its upper half covers the region of the upper half. The area has no hole, although the even-odd
    /// rule leaves one where the line of the area overlaps itself.
    #[test]
    fn a_folded_drawing_has_no_holes() {
        let positions =
            vec![[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0], [2.0, 1.5, 0.0], [0.0, 1.5, 0.0]];
        let area = AreaPicture {
            colour: Some([0, 90, 200, 255]),
            positions: positions.clone(),
            ends: vec![6],
            // The upper part between 1, 2, 3 and 0, and the part folded over it, with reversed orientation.
            triangles: vec![[0, 1, 2], [0, 2, 3], [0, 5, 4], [0, 4, 1]],
        };
        let ring = [0, 3, 2, 1, 4, 5].map(|point: usize| positions[point]).to_vec();
        let order = [0_u32, 3, 2, 1, 4, 5];
        let place = |point: u32| order.iter().position(|other| *other == point).expect("a point") as u32;
        let triangles = area.triangles.iter().map(|t| t.map(place)).collect();
        let area = AreaPicture { positions: ring, triangles, ..area };
        let body = BodyPicture { positions, areas: vec![area.clone()], ..Default::default() };
        let picture = Picture { bodies: vec![body], ..Default::default() };
        picture.check().expect("it fits together");
        let view = View::fit([&picture]).expect("a view");
        let seen = |picture: &Picture| {
            let (image, scale) = scene(picture, &view, [255; 3], [200, 200], 1.0).expect("an image");
            image.pixel(100, (100.0 + scale * 0.25) as u32)
        };
        assert_eq!(seen(&picture), [0, 90, 200]);
        let mut by_lines = picture.clone();
        by_lines.bodies[0].areas[0].triangles.clear();
        assert_eq!(seen(&by_lines), [255; 3], "the line alone leaves a hole, which is why triangles are filled");
    }

    /// The decision whether the cells of a body are drawn is made once per run, so a body is drawn in the same way after it is squeezed.
    #[test]
    fn the_lattice_is_drawn_in_all_pictures_of_a_run_or_in_none() {
        let side = 24;
        let at = |k: usize| (k % (side + 1), k / (side + 1));
        let nodes = (side + 1) * (side + 1);
        let square = |x: usize, y: usize| (y * (side + 1) + x) as u32;
        let cells: Vec<[u32; 3]> = (0..side * side)
            .flat_map(|k| {
                let (x, y) = (k % side, k / side);
                let [a, b, c, d] = [square(x, y), square(x + 1, y), square(x + 1, y + 1), square(x, y + 1)];
                [[a, b, c], [a, c, d]]
            })
            .collect();
        let body = |stretch: f64| BodyPicture {
            positions: (0..nodes).map(|k| [at(k).0 as f64 * stretch, at(k).1 as f64 / stretch, 0.0]).collect(),
            scalar: vec![0.5; nodes],
            cells: cells.clone(),
            extent: Some(side as f64),
            ..Default::default()
        };
        let picture = |stretch: f64| Picture {
            bodies: vec![body(stretch)],
            legend: Some(Legend { range: Some([0.0, 1.0]), ..Legend::default() }),
            ..Default::default()
        };
        let shown = |size: u32| {
            let view = View::fit([&picture(1.0), &picture(2.0)]).expect("a view");
            [1.0, 1.5, 2.0].map(|stretch| {
                let (image, _) = scene(&picture(stretch), &view, [255; 3], [size, size], 1.0).expect("an image");
                let mut colours: Vec<[u8; 3]> =
                    (0..size * size).map(|k| image.pixel(k % size, k / size)).filter(|c| *c != [255; 3]).collect();
                colours.sort_unstable();
                colours.dedup();
                // A plain body has at most two colours: its own, and that of its soft edge. If there are more, there are lines over the body.
                colours.len() > 2
            })
        };
        for size in [120, 250, 300, 350, 400, 450, 500, 600] {
            let shown = shown(size);
            assert!(shown.iter().all(|lines| *lines == shown[0]), "{size}: {shown:?}");
        }
        assert!(shown(600)[0] && !shown(120)[0]);
    }

    /// Names are either all above or all below their bodies, and not on a floor. In a pile of two bodies, each name is nearer
    /// to its own body.
    #[test]
    fn names_lie_where_nothing_is_in_the_way() {
        let body = |x: f64, y: f64, label: &str| BodyPicture {
            positions: [[-0.5, 0.0], [0.5, 0.0], [0.5, 1.0], [-0.5, 1.0]].map(|p| [p[0] + x, p[1] + y, 0.0]).to_vec(),
            facets: Facets::Edges(vec![[0, 1], [1, 2], [2, 3], [3, 0]]),
            label: label.into(),
            ..Default::default()
        };
        let floor = || vec![ColliderPicture::HalfSpace { point: [0.0; 3], normal: [0.0, 1.0, 0.0] }];
        let rows = |bodies: Vec<BodyPicture>, colliders: Vec<ColliderPicture>| -> (Vec<u32>, Projection) {
            // The view leaves space at the top and at the bottom.
            let frame = BodyPicture { positions: vec![[-3.0, -1.5, 0.0], [3.0, 4.5, 0.0]], ..Default::default() };
            let mut picture = Picture { bodies, colliders, ..Default::default() };
            picture.bodies.push(frame);
            let view = View::fit([&picture]).expect("a view");
            let draw = |picture: &Picture| scene(picture, &view, [255; 3], [300, 300], 0.6).expect("an image").0;
            let named = draw(&picture);
            picture.bodies.iter_mut().for_each(|body| body.label.clear());
            let bare = draw(&picture);
            let written = |y: &u32| (0..300).any(|x| named.pixel(x, *y) != bare.pixel(x, *y));
            ((0..300).filter(written).collect(), Projection::new(&view, 300, 300))
        };
        let (written, at) = rows(vec![body(-1.5, 0.0, "left"), body(1.5, 0.1, "right")], floor());
        let ground = at.pixel([0.0; 3])[1] as u32;
        assert!(!written.is_empty() && written.iter().all(|y| *y < ground), "{written:?} {ground}");
        // If bodies hang from above, names are below them.
        let ceiling = vec![ColliderPicture::HalfSpace { point: [0.0, 1.05, 0.0], normal: [0.0, -1.0, 0.0] }];
        let (written, at) = rows(vec![body(-1.5, 0.0, "left"), body(1.5, 0.0, "right")], ceiling);
        let feet = at.pixel([0.0; 3])[1] as u32;
        assert!(!written.is_empty() && written.iter().all(|y| *y >= feet), "{written:?} {feet}");
        // If one body is above the other, there are two rows of letters, both above their bodies.
        let (written, at) = rows(vec![body(0.0, 0.0, "low"), body(0.0, 2.0, "high")], floor());
        let rows_of =
            |y: f64| written.iter().filter(|row| (at.pixel([0.0, y, 0.0])[1] - **row as f32).abs() < 12.0).count();
        assert!(rows_of(1.0) > 2 && rows_of(3.0) > 2, "{written:?}");
    }

    #[test]
    fn a_scene_whose_y_counts_downwards_is_drawn_with_its_floor_below() {
        for y_down in [false, true] {
            let sign = if y_down { -1.0 } else { 1.0 };
            let body = BodyPicture {
                positions: [[-1.0, 1.0], [1.0, 1.0], [0.0, 3.0]].map(|[x, y]| [x, sign * y, 0.0]).to_vec(),
                facets: Facets::Edges(vec![[0, 1], [1, 2], [2, 0]]),
                ..Default::default()
            };
            let floor = ColliderPicture::HalfSpace { point: [0.0; 3], normal: [0.0, sign, 0.0] };
            let picture = Picture { bodies: vec![body], colliders: vec![floor], y_down, ..Default::default() };
            let view = View::fit([&picture]).expect("a view");
            let (image, _) = scene(&picture, &view, [255; 3], [60, 60], 1.0).expect("an image");
            assert_eq!(image.pixel(58, 1), [255; 3], "the sky");
            assert!((56..60).all(|row| image.pixel(58, row) != [255; 3]), "the ground");
            let widest = |row: u32| (0..60).filter(|column| image.pixel(*column, row) != [255; 3]).count();
            assert!(widest(35) > widest(15) && widest(15) > 0, "the triangle stands on its side");
        }
    }
}
