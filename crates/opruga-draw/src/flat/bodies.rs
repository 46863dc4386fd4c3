//! Bodies in two dimensions.

use super::Projection;
use super::loops::{Loop, chain, parts};
use super::{areas, shade};
use crate::canvas::{Canvas, paint};
use crate::colour::{BODIES, ColourMap, INK, SOFT_INK, darker, mix};
use crate::picture::{BodyPicture, Facets, Picture};
use crate::view::View;
use tiny_skia::{FilterQuality, Paint, Path, PathBuilder, Pattern, Pixmap, SpreadMode, Transform};

/// An edge of a coloured outline that is shorter than this length [pixels] is joined to the next edge.
const SHORT: f32 = 1.2;
/// The smallest spacing of nodes at which they are drawn as dots, in units of the size of lines.
const DOT_SPACING: f32 = 15.0;

/// The mapping of the scalars of a picture to colours.
struct Scalars {
    /// The colour map.
    map: ColourMap,
    /// The values at the ends of the colour map.
    range: [f64; 2],
}

impl Scalars {
    /// The fraction of the colour map that corresponds to a scalar.
    fn fraction(&self, scalar: f64) -> f64 {
        View::fraction(self.range, scalar)
    }

    /// The colour of a scalar.
    fn colour(&self, scalar: f64) -> [u8; 3] {
        self.map.colour(self.fraction(scalar))
    }

    /// The mean of the scalars of some nodes.
    fn mean(body: &BodyPicture, nodes: impl Iterator<Item = u32>) -> f64 {
        let (sum, count) = nodes.fold((0.0, 0.0), |(sum, count), node| (sum + body.scalar[node as usize], count + 1.0));
        sum / f64::max(count, 1.0)
    }
}

/// Draws all bodies of a picture.
pub(crate) fn draw(canvas: &mut Canvas, picture: &Picture, view: &View, projection: &Projection, unit: f32) {
    let map = picture.legend.as_ref().map_or(ColourMap::Viridis, |legend| legend.map);
    let scalars = Scalars { map, range: view.range(picture) };
    let mut pixels = Vec::new();
    for (index, body) in picture.bodies.iter().enumerate() {
        pixels.clear();
        pixels.extend(body.positions.iter().map(|&position| projection.pixel(position)));
        let used = body.positions.iter().zip(&pixels).filter(|(position, _)| position.iter().all(|v| v.is_finite()));
        let (mut low, mut high) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
        for (_, pixel) in used {
            for axis in 0..2 {
                low[axis] = low[axis].min(pixel[axis]);
                high[axis] = high[axis].max(pixel[axis]);
            }
        }
        let outside = (0..2).any(|axis| high[axis] < -2.0 || low[axis] > projection.size[axis] + 2.0);
        if outside || low[0] > high[0] {
            continue;
        }
        let base = body.colour.unwrap_or(body_colour(index, picture.bodies.len()));
        let seen = (high[0] - low[0]).max(high[1] - low[1]);
        // The size at the start is used, so that a body is drawn in the same way while it is squeezed or stretched.
        let size = body.extent.map_or(seen, |extent| (extent * projection.scale) as f32);
        Drawing { body, pixels: &pixels, low, high, size, unit, base, scalars: &scalars, projection }.draw(canvas);
    }
}

/// The colour of a body without scalars. If there are many bodies, their colours follow no visible order.
pub(crate) fn body_colour(index: usize, count: usize) -> [u8; 3] {
    let shuffled = (index as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 33;
    let choice = if count <= 2 * BODIES.len() { index } else { shuffled as usize };
    BODIES[choice % BODIES.len()]
}

/// The data for drawing one body.
struct Drawing<'a> {
    /// The body.
    body: &'a BodyPicture,
    /// The pixels of the nodes of the body.
    pixels: &'a [[f32; 2]],
    /// The left and upper limits of the body in pixels.
    low: [f32; 2],
    /// The right and lower limits of the body in pixels.
    high: [f32; 2],
    /// The larger side of the body at the start in pixels.
    size: f32,
    /// The size of lines.
    unit: f32,
    /// The colour without scalars.
    base: [u8; 3],
    /// The colours of scalars.
    scalars: &'a Scalars,
    /// The mapping of points to pixels.
    projection: &'a Projection,
}

impl Drawing<'_> {
    /// Draws the body.
    fn draw(&self, canvas: &mut Canvas) {
        let body = self.body;
        self.rest(canvas);
        let coloured = !body.scalar.is_empty();
        let loops = match &body.facets {
            Facets::Edges(edges) => chain(edges),
            Facets::Triangles(_) => Vec::new(),
        };
        let surface: &[[u32; 3]] = match &body.facets {
            Facets::Triangles(triangles) => triangles,
            Facets::Edges(_) => &[],
        };
        let cells = if body.cells.is_empty() { surface } else { &body.cells };
        if !body.areas.is_empty() {
            self.carried(canvas, cells);
            self.nodes(canvas);
            return;
        }
        let outline = self.outline(loops.iter());
        let fill =
            if coloured { self.scalars.colour(Scalars::mean(body, 0..body.positions.len() as u32)) } else { self.base };
        if coloured && !cells.is_empty() && self.size > 4.0 {
            self.fill_cells(canvas, cells, outline.as_ref());
        } else if coloured && outline.is_some() {
            // The inside of each closed line, without its holes, gets its own colour, because each chamber has its own pressure.
            for part in parts(&loops, &body.positions) {
                let Some(path) = self.outline(part.iter().copied()) else { continue };
                let nodes = part.iter().flat_map(|chain| chain.nodes.iter().copied());
                let fill = self.scalars.colour(Scalars::mean(body, nodes));
                canvas.fill(&path, &paint(if self.size > 12.0 { mix(fill, [255; 3], 0.6) } else { fill }, 1.0));
            }
        } else if let Some(outline) = &outline {
            canvas.fill(outline, &paint(fill, 1.0));
        } else if !cells.is_empty() {
            cells.iter().for_each(|cell| canvas.polygon(&cell.map(|node| self.pixels[node as usize]), fill, 1.0));
        }
        self.cell_edges(canvas, cells);
        self.segments(canvas, outline.is_some());
        if let (Some(path), true) = (&outline, self.size > 7.0) {
            let width = (0.03 * self.size).clamp(0.5, 1.7 * self.unit);
            if coloured && cells.is_empty() && self.size > 12.0 {
                self.coloured_outline(canvas, &loops, path);
            } else {
                canvas.stroke(path, width, &paint(darker(fill), 0.95));
            }
        }
        self.nodes(canvas);
    }

    /// Draws the rest shape of the body.
    fn rest(&self, canvas: &mut Canvas) {
        let rest = &self.body.rest;
        for chain in chain(&rest.segments) {
            let mut points: Vec<[f32; 2]> =
                chain.nodes.iter().map(|node| self.projection.pixel(rest.positions[*node as usize])).collect();
            points.extend(chain.closed.then(|| points[0]));
            if let Some(path) = crate::canvas::path_of(&points, false) {
                let dashes = [5.0 * self.unit, 3.5 * self.unit];
                canvas.stroke_dashed(&path, 1.1 * self.unit, &dashes, &paint(SOFT_INK, 0.8));
            }
        }
    }

    /// Draws the areas that the body carries. Areas without their own colour get the colours of the nodes.
    fn carried(&self, canvas: &mut Canvas, cells: &[[u32; 3]]) {
        for area in self.body.areas.iter().filter(|area| area.colour.is_none()) {
            let Some(path) = areas::path(area, self.projection) else { continue };
            if self.body.scalar.is_empty() {
                areas::fill(canvas, area, self.projection, &paint(self.base, 1.0));
            } else {
                self.fill_within(canvas, cells, Some(&path));
            }
            let width = (0.03 * self.size).clamp(0.5, 1.7 * self.unit);
            canvas.stroke(&path, width, &paint(darker(self.base), 0.95));
        }
        areas::draw(canvas, &self.body.areas, self.projection);
    }

    /// The path through the points of the loops. Consecutive points on the same pixel are merged.
    fn outline<'l>(&self, loops: impl Iterator<Item = &'l Loop>) -> Option<Path> {
        let mut builder = PathBuilder::new();
        for chain in loops {
            let mut last = [f32::INFINITY; 2];
            for &node in &chain.nodes {
                let point = self.pixels[node as usize];
                if !last[0].is_finite() {
                    builder.move_to(point[0], point[1]);
                } else if (point[0] - last[0]).abs() + (point[1] - last[1]).abs() < 0.4 {
                    continue;
                } else {
                    builder.line_to(point[0], point[1]);
                }
                last = point;
            }
            if chain.closed {
                builder.close();
            }
        }
        builder.finish()
    }

    /// Fills cells with the colours of their nodes. On small bodies, the cells are clipped at the outline.
    fn fill_cells(&self, canvas: &mut Canvas, cells: &[[u32; 3]], outline: Option<&Path>) {
        // On large bodies the outline is thick enough to hide the hard edges of the cells. They need no clipping, which would make folds look like
        // holes.
        self.fill_within(canvas, cells, outline.filter(|_| self.size < 48.0));
    }

    /// Fills cells with the colours of their nodes, clipped at an outline.
    fn fill_within(&self, canvas: &mut Canvas, cells: &[[u32; 3]], outline: Option<&Path>) {
        let limit = [canvas.pixmap.width() as f32, canvas.pixmap.height() as f32];
        let low: [f32; 2] = std::array::from_fn(|axis| (self.low[axis] - 2.0).floor().clamp(0.0, limit[axis]));
        let high: [f32; 2] = std::array::from_fn(|axis| (self.high[axis] + 2.0).ceil().clamp(0.0, limit[axis]));
        let Some(mut scratch) = Pixmap::new((high[0] - low[0]) as u32, (high[1] - low[1]) as u32) else {
            return;
        };
        let fractions: Vec<f64> = self.body.scalar.iter().map(|&scalar| self.scalars.fraction(scalar)).collect();
        // With an outline, a first pass fills a little more than the cells, so that the soft edge of the outline also has a colour.
        let passes: &[f32] = if outline.is_some() { &[1.5, 0.01] } else { &[0.01] };
        for &reach in passes {
            for cell in cells {
                let corners = cell.map(|node| {
                    let [x, y] = self.pixels[node as usize];
                    ([x - low[0], y - low[1]], fractions[node as usize])
                });
                shade::triangle(&mut scratch.as_mut(), corners, reach, &|fraction| self.scalars.map.colour(fraction));
            }
        }
        let shift = Transform::from_translate(low[0], low[1]);
        let shader = Pattern::new(scratch.as_ref(), SpreadMode::Pad, FilterQuality::Nearest, 1.0, shift);
        let paint = Paint { shader, anti_alias: true, ..Paint::default() };
        match outline {
            Some(outline) => canvas.fill(outline, &paint),
            None => {
                let all = tiny_skia::Rect::from_ltrb(low[0], low[1], high[0], high[1]).map(PathBuilder::from_rect);
                all.iter().for_each(|path| canvas.fill(path, &paint));
            }
        }
    }

    /// Draws the edges of cells if they are large enough to be distinguished.
    fn cell_edges(&self, canvas: &mut Canvas, cells: &[[u32; 3]]) {
        let spacing = self.size / (cells.len().max(1) as f32).sqrt();
        if spacing < 7.0 {
            return;
        }
        let (colour, opacity) = if self.is_light() { (INK, 0.16) } else { ([255; 3], 0.38) };
        let mut edges: Vec<[u32; 2]> =
            cells.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).map(|[a, b]| [a.min(b), a.max(b)]).collect();
        edges.sort_unstable();
        edges.dedup();
        self.lines(canvas, &edges, 0.6 * self.unit, colour, opacity);
    }

    /// Whether the colour map begins with a light colour, over which lines must be dark.
    fn is_light(&self) -> bool {
        !self.body.scalar.is_empty() && self.scalars.map.is_light_below()
    }

    /// Draws springs if they are long enough to be visible.
    fn segments(&self, canvas: &mut Canvas, filled: bool) {
        let segments = &self.body.segments;
        if segments.is_empty() || self.size < 6.0 {
            return;
        }
        let spacing = self.size / (segments.len() as f32).sqrt();
        let width = (0.09 * spacing).clamp(0.35, 1.3) * self.unit;
        if self.body.scalar.is_empty() || filled {
            let colour = if filled && self.is_light() { INK } else { darker(self.base) };
            let opacity = match filled {
                false => 1.0,
                // Over a filled body, these lines coincide with the edges of the cells.
                true if self.is_light() => 0.2,
                true => 0.45,
            };
            self.lines(canvas, segments, width, colour, opacity);
            return;
        }
        for &[a, b] in segments {
            let colour = self.scalars.colour(Scalars::mean(self.body, [a, b].into_iter()));
            let points = [self.pixels[a as usize], self.pixels[b as usize]];
            canvas.line(&points, 1.5 * width, colour, 1.0);
        }
    }

    /// Draws many lines of one colour at once.
    fn lines(&self, canvas: &mut Canvas, lines: &[[u32; 2]], width: f32, colour: [u8; 3], opacity: f64) {
        for part in lines.chunks(512) {
            let mut builder = PathBuilder::new();
            for &[a, b] in part {
                let (from, to) = (self.pixels[a as usize], self.pixels[b as usize]);
                builder.move_to(from[0], from[1]);
                builder.line_to(to[0], to[1]);
            }
            if let Some(path) = builder.finish() {
                canvas.stroke(&path, width, &paint(colour, opacity));
            }
        }
    }

    /// Draws an outline whose colour varies from node to node, with a dark rim.
    fn coloured_outline(&self, canvas: &mut Canvas, loops: &[Loop], path: &Path) {
        let width = (0.045 * self.size).clamp(1.0, 5.0 * self.unit);
        if self.size > 30.0 {
            canvas.stroke(path, width + 1.4 * self.unit, &paint(INK, 0.85));
        }
        // Neighbouring edges with nearly the same colour are drawn as one line. Fewer colours can be distinguished on small bodies.
        let shades = if self.size > 60.0 { 64.0 } else { 24.0 };
        let mut points: Vec<[f32; 2]> = Vec::new();
        for chain in loops {
            let count = if chain.closed { chain.nodes.len() } else { chain.nodes.len() - 1 };
            let (mut from, mut last) = (self.pixels[chain.nodes[0] as usize], None);
            let (mut sum, mut edges) = (0.0, 0.0);
            for edge in 0..count {
                let ends = [chain.nodes[edge], chain.nodes[(edge + 1) % chain.nodes.len()]];
                let to = self.pixels[ends[1] as usize];
                sum += Scalars::mean(self.body, ends.into_iter());
                edges += 1.0;
                // Edges too short to be visible are drawn together, in their mean colour.
                if (to[0] - from[0]).abs() + (to[1] - from[1]).abs() < SHORT && edge + 1 < count {
                    continue;
                }
                let shade = (self.scalars.fraction(sum / edges).clamp(0.0, 1.0) * shades).round() / shades;
                if last != Some(shade) {
                    self.coloured_line(canvas, &mut points, width, last);
                    points.push(from);
                    last = Some(shade);
                }
                points.push(to);
                (from, sum, edges) = (to, 0.0, 0.0);
            }
            self.coloured_line(canvas, &mut points, width, last);
        }
    }

    /// Draws a part of an outline and clears it.
    fn coloured_line(&self, canvas: &mut Canvas, points: &mut Vec<[f32; 2]>, width: f32, shade: Option<f64>) {
        if let Some(shade) = shade {
            canvas.line(points, width, self.scalars.map.colour(shade), 1.0);
        }
        points.clear();
    }

    /// Draws the nodes as dots, if requested. A body with a known node spacing gets no dots if they would be too close together. Otherwise, the dots
    /// shrink with the distance between the nodes.
    fn nodes(&self, canvas: &mut Canvas) {
        if !self.body.nodes_drawn {
            return;
        }
        let radius = match self.body.node_spacing {
            Some(spacing) if ((spacing * self.projection.scale) as f32) < DOT_SPACING * self.unit => return,
            Some(_) => 2.6 * self.unit,
            None => {
                // An estimate of the distance of neighbours: for nodes around the body if there are no cells, otherwise for nodes that fill the body.
                let count = self.pixels.len().max(1) as f32;
                let spacing = if self.body.cells.is_empty() { 3.0 / count } else { 1.0 / count.sqrt() } * self.size;
                (0.25 * spacing).clamp(0.8 * self.unit, 2.6 * self.unit)
            }
        };
        for (node, &pixel) in self.pixels.iter().enumerate() {
            let colour = self.body.scalar.get(node).map_or(self.base, |&scalar| self.scalars.colour(scalar));
            canvas.disc(pixel, 1.35 * radius, darker(darker(colour)));
            canvas.disc(pixel, radius, mix(colour, [255; 3], 0.25));
        }
    }
}
