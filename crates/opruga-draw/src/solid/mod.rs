//! Pictures in three dimensions, drawn by a built-in rasteriser.

pub(crate) mod camera;
mod ground;
mod outline;
mod raster;
mod shade;
mod shapes;

use crate::canvas::Canvas;
use crate::colour::{BODIES, ColourMap, FRAME, OBSTACLE_EDGE, SOFT_INK, darker, mix};
use crate::error::DrawError;
use crate::image::Image;
use crate::marks::draw_marks;
use crate::picture::{BodyPicture, ColliderPicture, Facets, Picture};
use crate::view::View;
pub(crate) use camera::seen_size;
use camera::{Camera, Seen, between, dot, unit};
use ground::{Plane, Shadow};
use raster::{SAMPLES, Screen};
use shade::{Colouring, Light, Surface};
use shapes::{FACES, corner, shape};

/// The colour of an obstacle in full light.
const SOLID: [u8; 3] = [188, 193, 202];

/// The width of the line around a body, in units of the size of lines.
const OUTLINE: f32 = 2.0;

/// Draws the scene of a picture in three dimensions.
pub(crate) fn scene(
    picture: &Picture,
    view: &View,
    background: [u8; 3],
    [width, height]: [u32; 2],
    unit: f32,
) -> Result<(Image, f64), DrawError> {
    let mut screen = Screen::new(width, height, background);
    // The camera uses samples as its pixels.
    let camera = Camera::new(view, screen.width as f64, screen.height as f64);
    let light = Light::new(&camera);
    let painter = Painter { picture, view, camera, light, unit: unit * SAMPLES as f32 };
    let planes = painter.planes();
    let floor = planes.iter().find(|plane| plane.is_floor());
    let shadow = floor.map(|floor| painter.shadow(&screen, *floor));
    for collider in &picture.colliders {
        painter.collider(&mut screen, collider);
    }
    for (index, body) in picture.bodies.iter().enumerate() {
        painter.body(&mut screen, body, BODIES[index % BODIES.len()]);
    }
    for plane in &planes {
        let shadow = shadow.as_ref().filter(|_| Some(plane) == floor);
        ground::draw(&mut screen, background, &painter.camera, view, *plane, shadow);
    }
    // The dot of a node is slightly in front of the node and would hide an arrow that begins at the node.
    let dotted = picture.bodies.iter().any(|body| body.nodes_drawn);
    let surfaces = (dotted && !picture.arrows.is_empty()).then(|| screen.inverse_distances.clone());
    for (index, body) in picture.bodies.iter().enumerate() {
        painter.nodes(&mut screen, body, BODIES[index % BODIES.len()]);
    }
    let mut image = screen.image()?;
    for body in &picture.bodies {
        if let Some(colour) = body.outlined {
            let seen: Vec<Option<Seen>> = body.positions.iter().map(|&position| painter.camera.see(position)).collect();
            outline::draw(&mut image, &screen, (body, &seen), colour, (OUTLINE * unit, painter.spring(body)));
        }
    }
    let mut canvas = Canvas::new(&mut image);
    let project = |point| painter.camera.see(point).map(|seen| seen.pixel.map(|value| value / SAMPLES as f32));
    let inverse_distances = surfaces.as_deref().unwrap_or(&screen.inverse_distances);
    draw_marks(&mut canvas, (picture, &picture.arrows), view, background, unit, &project, &|point, below| {
        let towards = camera::unit(between(point, painter.camera.position));
        painter.in_sight([screen.width, screen.height], inverse_distances, camera::along(point, towards, below))
    });
    Ok((image, painter.camera.scale(view.center()) / SAMPLES as f64))
}

/// The axes of the camera of a view, and the direction towards the light.
pub(crate) fn directions_of_view(view: &View) -> ([[f64; 3]; 3], [f64; 3]) {
    let axes = camera::axes(view);
    (axes, shade::light_of(&axes))
}

/// The shadow of a point on a plane; points below the plane are unchanged.
pub(crate) fn cast(point: [f64; 3], plane: [f64; 3], normal: [f64; 3], light: [f64; 3]) -> [f64; 3] {
    let height = dot(normal, between(plane, point)).max(0.0);
    camera::along(point, light, -height / dot(light, normal))
}

/// The data that all parts of a scene need.
struct Painter<'a> {
    /// The picture.
    picture: &'a Picture,
    /// The visible part of space.
    view: &'a View,
    /// The camera, whose pixels are samples.
    camera: Camera,
    /// The light.
    light: Light,
    /// The size of lines in samples.
    unit: f32,
}

impl Painter<'_> {
    /// The planes of all half spaces.
    fn planes(&self) -> Vec<Plane> {
        let plane = |collider: &ColliderPicture| match collider {
            ColliderPicture::HalfSpace { point, normal } if dot(*normal, *normal) > 0.0 => {
                Some(Plane { point: *point, normal: unit(*normal) })
            }
            _ => None,
        };
        self.picture.colliders.iter().filter_map(plane).collect()
    }

    /// The shadows of all bodies and obstacles on a floor.
    fn shadow(&self, screen: &Screen, floor: Plane) -> Shadow {
        let mut shadow = Shadow::new(screen, floor, self.light.world);
        for body in &self.picture.bodies {
            shadow.triangles(screen, &self.camera, &body.positions, triangles(body));
            for segment in &body.segments {
                let ends = segment.map(|node| body.positions[node as usize]);
                if body.spring_width > 0.0 {
                    let wire = shapes::wire(ends, body.spring_width);
                    shadow.triangles(screen, &self.camera, &wire.positions, &wire.triangles);
                }
                shadow.line(screen, &self.camera, ends, 1.2 * self.unit);
            }
        }
        for shape in self.picture.colliders.iter().filter_map(shape) {
            shadow.triangles(screen, &self.camera, &shape.positions, &shape.triangles);
        }
        shadow.soften(screen, (2.5 * self.unit) as usize);
        shadow
    }

    /// Whether a point of a surface is visible on a screen of this size whose samples show surfaces at these inverse distances.
    fn in_sight(&self, [width, height]: [usize; 2], inverse_distances: &[f32], point: [f64; 3]) -> bool {
        let Some(seen) = self.camera.see(point) else { return false };
        let [column, row] = seen.pixel.map(|value| value as usize);
        column >= width || row >= height || inverse_distances[row * width + column] < seen.inverse_distance * 1.004
    }

    /// Draws a line between two points.
    fn line(&self, screen: &mut Screen, ends: [[f64; 3]; 2], width: f32, colour: [u8; 3]) {
        if let [Some(from), Some(to)] = ends.map(|end| self.camera.see(end)) {
            screen.line([from, to], width, [colour; 2]);
        }
    }

    /// Draws an obstacle, unless it is a plane.
    fn collider(&self, screen: &mut Screen, collider: &ColliderPicture) {
        match collider {
            ColliderPicture::HalfSpace { .. } => {}
            ColliderPicture::Box { min, max, inside: true } => self.container(screen, *min, *max),
            ColliderPicture::Polyline(points) => {
                for pair in points.windows(2) {
                    self.line(screen, [pair[0], pair[1]], 3.0 * self.unit, OBSTACLE_EDGE);
                }
            }
            _ => {
                if let Some(shape) = shape(collider) {
                    let smooth = !matches!(collider, ColliderPicture::Box { .. } | ColliderPicture::Polygon(_));
                    let surface = Surface { positions: &shape.positions, triangles: &shape.triangles, smooth };
                    shade::fill(screen, &self.camera, &self.light, &surface, &Colouring::Plain(SOLID));
                }
            }
        }
    }

    /// Draws the walls of a container whose inner side is visible: their edges, and lines at round distances.
    fn container(&self, screen: &mut Screen, min: [f64; 3], max: [f64; 3]) {
        let square = self.view.square();
        for (corners, axis, high) in FACES {
            let corners = corners.map(|bits| corner(min, max, bits));
            let towards = between(corners[0], self.camera.position)[axis];
            if (towards > 0.0) == high {
                continue;
            }
            for other in (0..3).filter(|&other| other != axis) {
                let third = 3 - axis - other;
                let mut coordinate = (min[other] / square).ceil() * square;
                while coordinate <= max[other] {
                    let mut ends = [corners[0]; 2];
                    for (end, limit) in ends.iter_mut().zip([min[third], max[third]]) {
                        end[other] = coordinate;
                        end[third] = limit;
                    }
                    self.line(screen, ends, 0.6 * self.unit, mix(FRAME, [255; 3], 0.4));
                    coordinate += square;
                }
            }
            for side in 0..4 {
                let ends = [corners[side], corners[(side + 1) % 4]];
                self.line(screen, ends, 1.0 * self.unit, OBSTACLE_EDGE);
            }
        }
    }

    /// The width of the springs of a body, in samples.
    fn spring(&self, body: &BodyPicture) -> f32 {
        if triangles(body).is_empty() { 1.6 * self.unit } else { 0.8 * self.unit }
    }

    /// The fractions of the colour map for the scalars of a body.
    fn fractions(&self, body: &BodyPicture) -> (ColourMap, Vec<f32>) {
        let range = self.view.range(self.picture);
        let map = self.picture.legend.as_ref().map_or(ColourMap::Viridis, |legend| legend.map);
        (map, body.scalar.iter().map(|&scalar| View::fraction(range, scalar) as f32).collect())
    }

    /// Draws the nodes of a body, if requested.
    fn nodes(&self, screen: &mut Screen, body: &BodyPicture, base: [u8; 3]) {
        if !body.nodes_drawn {
            return;
        }
        let (map, fractions) = self.fractions(body);
        for (node, &position) in body.positions.iter().enumerate() {
            if let Some(seen) = self.camera.see(position) {
                let colour = fractions
                    .get(node)
                    .map_or_else(|| darker(body.colour.unwrap_or(base)), |&fraction| map.colour(f64::from(fraction)));
                screen.disc(seen, 1.9 * self.unit, darker(colour));
            }
        }
    }

    /// Draws the springs of a body as round wires.
    fn wires(&self, screen: &mut Screen, body: &BodyPicture, base: [u8; 3]) {
        let (map, of_nodes) = self.fractions(body);
        let (mut positions, mut triangles, mut fractions) = (Vec::new(), Vec::new(), Vec::new());
        for nodes in &body.segments {
            let wire = shapes::wire(nodes.map(|node| body.positions[node as usize]), body.spring_width);
            let (first, half) = (positions.len() as u32, wire.positions.len() / 2);
            triangles.extend(wire.triangles.iter().map(|triangle| triangle.map(|corner| first + corner)));
            if !of_nodes.is_empty() {
                fractions.extend((0..wire.positions.len()).map(|k| of_nodes[nodes[usize::from(k >= half)] as usize]));
            }
            positions.extend(wire.positions);
        }
        let colouring = if fractions.is_empty() { Colouring::Plain(base) } else { Colouring::mapped(map, &fractions) };
        let surface = Surface { positions: &positions, triangles: &triangles, smooth: true };
        shade::fill(screen, &self.camera, &self.light, &surface, &colouring);
    }

    /// Draws a body without its nodes.
    fn body(&self, screen: &mut Screen, body: &BodyPicture, base: [u8; 3]) {
        for ends in &body.rest.segments {
            let ends = ends.map(|node| body.rest.positions[node as usize]);
            self.line(screen, ends, 1.0 * self.unit, SOFT_INK);
        }
        let base = body.colour.unwrap_or(base);
        let (map, fractions) = self.fractions(body);
        let colouring = if fractions.is_empty() { Colouring::Plain(base) } else { Colouring::mapped(map, &fractions) };
        let surface = Surface { positions: &body.positions, triangles: triangles(body), smooth: true };
        shade::fill(screen, &self.camera, &self.light, &surface, &colouring);
        let filled = !surface.triangles.is_empty();
        let colour = |node: u32| match fractions.get(node as usize) {
            Some(&fraction) => map.colour(f64::from(fraction)),
            None => darker(base),
        };
        if body.spring_width > 0.0 {
            self.wires(screen, body, base);
        }
        let seen: Vec<Option<Seen>> = body.positions.iter().map(|&position| self.camera.see(position)).collect();
        let width = self.spring(body);
        for &[a, b] in &body.segments {
            if let (Some(from), Some(to)) = (seen[a as usize], seen[b as usize]) {
                // On a surface of the same colour, a line is visible only if it is darker.
                let colours = [colour(a), colour(b)].map(|colour| if filled { darker(colour) } else { colour });
                screen.line([from, to], width, colours);
            }
        }
    }
}

/// The triangles of a body.
fn triangles(body: &BodyPicture) -> &[[u32; 3]] {
    match &body.facets {
        Facets::Triangles(triangles) => triangles,
        Facets::Edges(_) => &body.cells,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::{ArrowKind, ArrowPicture, Legend};

    /// A square in front of the camera of its view, with an arrow at its first corner.
    fn square() -> Picture {
        let body = BodyPicture {
            positions: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
            facets: Facets::Triangles(vec![[0, 1, 2], [0, 2, 3]]),
            ..BodyPicture::default()
        };
        let arrow = ArrowPicture { kind: ArrowKind::Velocity, from: [0.0; 3], vector: [1.0, 1.0, 0.0] };
        Picture { dimension: 3, bodies: vec![body], arrows: vec![arrow], ..Picture::default() }
    }

    #[test]
    fn an_arrow_that_begins_at_a_node_is_seen_with_the_dot_of_that_node() {
        let drawn = |nodes_drawn: bool, arrows: bool| {
            let mut picture = square();
            let view = View::fit([&picture]).expect("a view");
            picture.bodies[0].nodes_drawn = nodes_drawn;
            if !arrows {
                picture.arrows.clear();
            }
            scene(&picture, &view, [255; 3], [200, 200], 1.0).expect("an image").0
        };
        for nodes_drawn in [false, true] {
            let (with, without) = (drawn(nodes_drawn, true), drawn(nodes_drawn, false));
            let other = with.pixels().chunks_exact(4).zip(without.pixels().chunks_exact(4)).filter(|(a, b)| a != b);
            assert!(other.count() > 40, "with dots: {nodes_drawn}");
        }
    }

    #[test]
    fn a_wire_is_as_wide_as_it_is_said_to_be_and_does_not_hide_its_pin() {
        let drawn = |spring_width: f64, pinned: Vec<u32>| {
            let body = BodyPicture {
                positions: vec![[0.0, 0.5, 0.0], [1.0, 0.5, 0.0]],
                facets: Facets::Triangles(Vec::new()),
                segments: vec![[0, 1]],
                spring_width,
                pinned,
                ..BodyPicture::default()
            };
            let region = Some([[0.0; 3], [1.0, 1.0, 0.1]]);
            let sight = crate::Sight { region, azimuth: Some(0.0), elevation: Some(0.0) };
            let picture = Picture { dimension: 3, bodies: vec![body], sight, ..Picture::default() };
            let view = View::fit([&picture]).expect("a view");
            let image = scene(&picture, &view, [255; 3], [200, 200], 1.0).expect("an image").0;
            image.pixels().chunks_exact(4).map(<[u8]>::to_vec).collect::<Vec<_>>()
        };
        let area = |width: f64| drawn(width, Vec::new()).iter().filter(|p| p[..3] != [255; 3]).count() as f64;
        let ratio = area(0.2) / area(0.1);
        assert!((1.8..2.3).contains(&ratio), "{ratio}");
        let (with, without) = (drawn(0.1, vec![0]), drawn(0.1, Vec::new()));
        assert!(with.iter().zip(&without).filter(|(a, b)| a != b).count() > 20);
    }

    #[test]
    fn what_is_no_number_is_grey_and_not_the_colour_of_the_lowest_one() {
        for range in [[0.0, 1.0], [0.0, 0.0]] {
            let mut picture = square();
            picture.arrows.clear();
            picture.bodies[0].scalar = vec![f64::NAN; 4];
            picture.legend = Some(Legend { range: Some(range), ..Legend::default() });
            let view = View::fit([&picture]).expect("a view");
            let image = scene(&picture, &view, [255; 3], [200, 200], 1.0).expect("an image").0;
            let coloured = image.pixels().chunks_exact(4).filter(|p| p[0] != p[1] || p[1] != p[2]);
            assert_eq!(coloured.count(), 0, "{range:?}");
            let grey = image.pixels().chunks_exact(4).filter(|p| p[0] < 200);
            assert!(grey.count() > 2000, "the square is seen");
        }
    }

    /// Every face of a box has one colour up to its edges: the shading of its neighbours does not affect it.
    #[test]
    fn the_edges_of_a_box_are_sharp() {
        // One box has two triangles per face, and the other has four squares per face, so that it has nodes at corners, on edges and inside faces.
        for cells in [1_usize, 2] {
            let found =
                shapes::shape(&ColliderPicture::Box { min: [0.0; 3], max: [1.0; 3], inside: false }).expect("a box");
            let (mut positions, mut triangles): (Vec<[f64; 3]>, Vec<[u32; 3]>) = (Vec::new(), Vec::new());
            let node = |p: [f64; 3], positions: &mut Vec<[f64; 3]>| {
                positions.iter().position(|other| *other == p).unwrap_or_else(|| {
                    positions.push(p);
                    positions.len() - 1
                }) as u32
            };
            for triangle in &found.triangles {
                let [a, b, c] = triangle.map(|k| found.positions[k as usize]);
                let half = |p: [f64; 3], q: [f64; 3]| -> [f64; 3] { std::array::from_fn(|d| 0.5 * (p[d] + q[d])) };
                let parts = if cells == 1 {
                    vec![[a, b, c]]
                } else {
                    let [ab, bc, ca] = [half(a, b), half(b, c), half(c, a)];
                    vec![[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
                };
                triangles.extend(parts.into_iter().map(|part| part.map(|p| node(p, &mut positions))));
            }
            let body = BodyPicture {
                positions,
                facets: Facets::Triangles(triangles),
                colour: Some([200; 3]),
                ..BodyPicture::default()
            };
            let picture = Picture { dimension: 3, bodies: vec![body], ..Picture::default() };
            let view = View::fit([&picture]).expect("a view");
            let (image, _) = scene(&picture, &view, [255; 3], [200, 200], 1.0).expect("an image");
            let mut counts = std::collections::BTreeMap::new();
            for k in 0..200 * 200 {
                *counts.entry(image.pixel(k % 200, k / 200)).or_insert(0) += 1;
            }
            counts.remove(&[255; 3]);
            let (all, large): (u32, u32) =
                counts.values().fold((0, 0), |(all, large), n| (all + n, large + if *n > 300 { *n } else { 0 }));
            // Gloss varies slightly over a face seen in perspective; the remaining pixels are those of the edges.
            assert!(large > all * 9 / 10, "{cells}: {large} of {all}");
        }
    }
}
