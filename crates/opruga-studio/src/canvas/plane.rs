//! Draws a scene in the plane with the painter of the interface, so that it is sharp at every zoom.

use super::arrows::{self, Longest};
use super::brush::Brush;
use super::camera::Flat;
use super::captions::Captions;
use super::detail::{Detail, apart, corners};
use super::labels::{self, Named};
use super::look::{Look, Paper, RUBBER, colour, on_paper};
use super::outlines::{Outlines, Part, fill};
use egui::{Align2, Color32, FontId, Mesh, Painter, Pos2, Rect, Shape, Stroke, Vec2};
use opruga::core::spec::Role;
use opruga::draw::{BODIES, BodyPicture, ColliderPicture, ColourMap, Facets, format_value, nice_length};

/// If there are more lines than this, they are drawn with hard borders.
const SOFT_EDGES: usize = 6_000;
/// The opacity of filled outlines. `FILLED_CELLS` is the opacity of filled cells.
const FILLED: f32 = 0.34;
const FILLED_CELLS: f32 = 0.62;

/// The colours of a node: for filled areas, and for lines.
#[derive(Clone, Copy, Debug, Default)]
struct Ink {
    fill: Color32,
    fill_of_cells: Color32,
    line: Color32,
}

impl Ink {
    fn new(colour: Color32, paper: &Paper) -> Ink {
        Ink {
            fill: colour.gamma_multiply(FILLED),
            fill_of_cells: colour.gamma_multiply(FILLED_CELLS),
            line: if paper.dark { colour } else { darker(colour) },
        }
    }
}

/// The colours of a colour map. They are computed once per picture, because there may be a hundred times as many nodes. The last colour is that of
/// NaN.
struct Colours {
    inks: [Ink; 257],
    low: f64,
    /// Colours per unit of the quantity.
    factor: f64,
}

impl Colours {
    fn new(map: ColourMap, range: [f64; 2], paper: &Paper) -> Colours {
        let at = |k: usize| match k {
            256 => Color32::GRAY,
            k => on_paper(colour(map.colour(k as f64 / 255.0)), paper),
        };
        let inks = std::array::from_fn(|k| Ink::new(at(k), paper));
        Colours { inks, low: range[0], factor: 255.0 / (range[1] - range[0]).max(1e-300) }
    }
    fn at(&self, scalar: f64) -> Ink {
        let index = (scalar - self.low) * self.factor;
        // The conversion to a byte limits the index to the range of the colours.
        self.inks[if index.is_nan() { 256 } else { usize::from(index as u8) }]
    }
}

/// Data that are kept from picture to picture.
#[derive(Debug, Default)]
pub(crate) struct Kept {
    outlines: Outlines,
    brush: Brush,
    /// The positions of the nodes of a body on the screen, and their colours.
    at: Vec<Pos2>,
    inks: Vec<Ink>,
    /// The visible corners of a large outline, as indices in it.
    seen: Vec<u32>,
}

impl Kept {
    /// Forgets the data of a scene.
    pub(crate) fn forget(&mut self) {
        self.outlines.forget();
    }
}

/// Draws obstacles, bodies and arrows; names do not cover `taken` rectangles.
pub(crate) fn paint(
    look: &Look<'_>,
    flat: &Flat,
    kept: &mut Kept,
    selected: Option<&str>,
    taken: &[Rect],
    longest: &Longest,
) {
    let Look { painter, shown, rect, paper, .. } = *look;
    let picture = &shown.picture;
    let project = |p: [f64; 3]| flat.to_screen(rect, p, picture.y_down);
    grid(painter, flat, rect, paper, picture.y_down);
    picture.colliders.iter().for_each(|c| obstacle(painter, c, flat, rect, paper, &project));
    // A single outline has no more visible points than the screen. Many bodies or a lattice may have more.
    let alone = matches!(&picture.bodies[..], [body] if body.segments.len() <= body.positions.len());
    let edges = |body: &BodyPicture| match &body.facets {
        Facets::Edges(edges) => edges.len(),
        Facets::Triangles(_) => 0,
    };
    let lines: usize = picture.bodies.iter().map(|body| body.segments.len() + edges(body)).sum();
    let crowd = lines > SOFT_EDGES && !alone;
    kept.outlines.next_picture();
    kept.brush.begin(if crowd { 0.0 } else { 1.0 / painter.ctx().pixels_per_point() }, rect);
    let map = picture.legend.as_ref().map_or(ColourMap::Viridis, |legend| legend.map);
    let map = Colours::new(map, look.range, paper);
    for (index, (body, extent)) in picture.bodies.iter().zip(&shown.extents).enumerate() {
        // Bodies out of sight are skipped.
        if Rect::from_points(&extent.corners.map(project)).expand(4.0).intersects(rect) && !body.positions.is_empty() {
            kept.at.clear();
            kept.at.extend(body.positions.iter().map(|p| project(*p)));
            let wide = selected.is_some_and(|name| shown.bodies.get(index).is_some_and(|b| b.name == name));
            self::body(look, kept, &map, (index, body), wide, flat);
        }
    }
    kept.brush.end(painter);
    // Labels and marks are above all bodies.
    for body in &picture.bodies {
        body.pinned.iter().filter_map(|node| body.positions.get(*node as usize)).for_each(|p| {
            pin(painter, project(*p), paper);
        });
    }
    let labelled = picture.bodies.iter().filter(|body| !body.label.is_empty());
    let named = labelled.filter_map(|body| Named::of(&body.label, body.positions.iter().map(|p| project(*p))));
    labels::names(painter, &named.collect::<Vec<_>>(), paper, taken);
    arrows::paint(look, flat, longest, &project);
}

/// Draws the filling, the springs, the outline and the vertices of a body. The positions of the body's nodes on the screen are in `kept`.
fn body(look: &Look<'_>, kept: &mut Kept, map: &Colours, number: (usize, &BodyPicture), wide: bool, flat: &Flat) {
    let Look { rect, paper, shown, show, .. } = *look;
    let (index, body) = number;
    let Kept { outlines, brush, at, inks, seen } = kept;
    if body.areas.iter().any(|area| area.colour.is_some()) {
        // The areas that the body carries are drawn in their own colours, one over another.
        for area in &body.areas {
            let Some([r, g, b, opacity]) = area.colour else { continue };
            let colour = Color32::from_rgba_unmultiplied(r, g, b, opacity);
            let corners = area.positions.iter().map(|p| (flat.to_screen(rect, *p, shown.picture.y_down), colour));
            brush.fill(corners, &area.triangles);
            // A thin line of the same colour smooths the border of the area.
            let starts = std::iter::once(0).chain(area.ends.iter().copied());
            for (start, end) in starts.zip(area.ends.iter().copied()) {
                let Some(line) = area.positions.get(start..end) else { continue };
                brush.ring(line.iter().map(|p| (flat.to_screen(rect, *p, shown.picture.y_down), colour)), 0.5);
            }
        }
        return;
    }
    inks.clear();
    if body.scalar.is_empty() {
        inks.resize(at.len(), Ink::new(colour(body.colour.unwrap_or(BODIES[index % BODIES.len()])), paper));
    } else {
        inks.extend(body.scalar.iter().map(|s| map.at(*s)));
    }
    let outline = outlines.of(index, body);
    let thinned: Vec<Vec<u32>> = match outline.large {
        true => outline.closed.iter().map(|line| apart(line, at)).collect(),
        false => Vec::new(),
    };
    let closed = if outline.large { &thinned } else { &outline.closed };
    if outline.large {
        // A surface with this many points is filled only between those that are distinct on the screen.
        let detail = Detail { merge_distance: 1.0, beside: 0.35, colour: 24, screen: rect };
        let lines = corners(closed, detail, |node| (at[*node as usize], inks[*node as usize].line), seen);
        let parts = fill(body, &lines);
        // The mean over all nodes is used, so that the zoom does not change the colour of the interior.
        let all: Vec<u32> = outline.closed.iter().flatten().copied().collect();
        for part in &parts {
            let ink = inside(body, if parts.len() == 1 { &all } else { &part.nodes }, map, inks);
            brush.fill(part.nodes.iter().map(|node| (at[*node as usize], ink)), &part.triangles);
        }
    } else if !body.cells.is_empty() {
        brush.fill(at.iter().zip(inks.iter()).map(|(pos, ink)| (*pos, ink.fill_of_cells)), &body.cells);
    } else {
        for Part { nodes, triangles } in &outline.parts {
            let ink = inside(body, nodes, map, inks);
            brush.fill(nodes.iter().map(|node| (at[*node as usize], ink)), triangles);
        }
    }
    let of = |node: &u32| (at[*node as usize], inks[*node as usize].line);
    let edged = !(outline.closed.is_empty() && outline.open.is_empty());
    if outline.springs {
        // Over filled areas, springs have another colour so that they are visible.
        let (width, share) = if edged { (1.2, if paper.dark { 0.4 } else { 0.15 }) } else { (1.8, 0.0) };
        for [a, b] in &body.segments {
            let (a, b) = (of(a), of(b));
            brush.line([a.0, b.0], width, [a.1, b.1].map(|colour| colour.lerp_to_gamma(paper.ink, share)));
        }
    }
    // Springs along an outline make it look thicker, so it is drawn thinner if the springs of a body are hidden. Other outlines stay the same.
    let sprung = |body: &crate::shown::BodyShown| body.models.iter().any(|model| model.spec().has_role(Role::Edges));
    let thin = !show.springs && shown.bodies.get(index).is_some_and(sprung);
    let width = if wide { 3.2 } else { 2.2 } - if thin { 1.2 } else { 0.0 };
    for line in closed {
        brush.ring(line.iter().map(of), width);
    }
    for [a, b] in &outline.open {
        let (a, b) = (of(a), of(b));
        brush.line([a.0, b.0], width, [a.1, b.1]);
    }
    if body.nodes_drawn && at.len() <= 20_000 {
        let radius = if at.len() > 400 { 1.6 } else { 2.6 };
        for (pos, ink) in at.iter().zip(inks.iter()) {
            // If the user wants to see the vertices, they are drawn wider than the line.
            if show.vertices {
                brush.disc(*pos, radius + 1.8, paper.background);
                brush.disc(*pos, radius + 0.6, ink.line.lerp_to_gamma(paper.ink, 0.6));
            } else {
                brush.disc(*pos, radius, ink.line);
            }
        }
    }
}

/// Returns the colour of the area within lines: that of the mean value of the nodes of the lines, as in pictures of the command line. The values
/// between the nodes are unknown, and the triangles have no physical meaning.
fn inside(body: &BodyPicture, nodes: &[u32], map: &Colours, inks: &[Ink]) -> Color32 {
    match (body.scalar.is_empty(), nodes.first()) {
        (false, Some(_)) => {
            let sum: f64 = nodes.iter().map(|node| body.scalar[*node as usize]).sum();
            map.at(sum / nodes.len() as f64).fill
        }
        (true, Some(node)) => inks[*node as usize].fill,
        (_, None) => Color32::TRANSPARENT,
    }
}

fn darker(c: Color32) -> Color32 {
    let scale = |x: u8| (f32::from(x) * 0.78) as u8;
    Color32::from_rgb(scale(c.r()), scale(c.g()), scale(c.b()))
}

/// The side of the grid squares: a round length [m].
fn square(flat: &Flat) -> f64 {
    nice_length(flat.metres(110.0))
}

/// Draws a grid of squares with a round length.
fn grid(painter: &Painter, flat: &Flat, rect: Rect, paper: &Paper, y_down: bool) {
    let length = square(flat);
    let [left, top] = flat.to_world(rect, rect.min, y_down);
    let [right, bottom] = flat.to_world(rect, rect.max, y_down);
    let (low, high) = (top.min(bottom), top.max(bottom));
    let stroke = Stroke::new(1.0, paper.grid);
    for k in (left / length).ceil() as i64..=(right / length).floor() as i64 {
        painter.vline(flat.to_screen(rect, [k as f64 * length, 0.0, 0.0], y_down).x, rect.y_range(), stroke);
    }
    for k in (low / length).ceil() as i64..=(high / length).floor() as i64 {
        painter.hline(rect.x_range(), flat.to_screen(rect, [0.0, k as f64 * length, 0.0], y_down).y, stroke);
    }
}

/// Writes the length of a side of the grid squares. The length is written over everything else, because floors often reach into its corner.
pub(crate) fn scale_bar(look: &Look<'_>, flat: &Flat) {
    let Look { painter, rect, paper, .. } = *look;
    let unit = &look.shown.picture.length_unit;
    let length = square(flat);
    let from = Pos2::new(rect.left() + 14.0, rect.bottom() - 14.0);
    let to = from + Vec2::new((length * flat.scale) as f32, 0.0);
    painter.line_segment([from, to], Stroke::new(2.0, paper.ink));
    for end in [from, to] {
        painter.line_segment([end - Vec2::new(0.0, 4.0), end + Vec2::new(0.0, 4.0)], Stroke::new(1.5, paper.ink));
    }
    let text = format!("{} {unit}", format_value(length));
    painter.text(from + Vec2::new(0.0, -6.0), Align2::LEFT_BOTTOM, text, FontId::proportional(12.0), paper.ink);
}

fn obstacle(
    painter: &Painter,
    collider: &ColliderPicture,
    flat: &Flat,
    rect: Rect,
    paper: &Paper,
    project: &dyn Fn([f64; 3]) -> Pos2,
) {
    let edge = Stroke::new(2.0, paper.solid_edge);
    let polygon = |points: Vec<Pos2>| {
        painter.add(Shape::convex_polygon(points, paper.solid, edge));
    };
    match collider {
        ColliderPicture::HalfSpace { point, normal } => {
            let size = (normal[0] * normal[0] + normal[1] * normal[1]).sqrt();
            if size == 0.0 {
                return;
            }
            // The line is drawn across the whole window, wherever the given point of the plane is.
            let n = [normal[0] / size, normal[1] / size];
            let t = [-n[1], n[0]];
            let middle = flat.middle();
            let ahead = (middle[0] - point[0]) * t[0] + (middle[1] - point[1]) * t[1];
            let far = flat.metres(f64::from(rect.width() + rect.height()));
            let spot = |along: f64, depth: f64| {
                let at = |d: usize| point[d] + (ahead + along) * t[d] - depth * n[d];
                project([at(0), at(1), 0.0])
            };
            let corners = vec![spot(-far, 0.0), spot(far, 0.0), spot(far, 2.0 * far), spot(-far, 2.0 * far)];
            painter.add(Shape::convex_polygon(corners, paper.solid, Stroke::NONE));
            painter.line_segment([spot(-far, 0.0), spot(far, 0.0)], edge);
        }
        ColliderPicture::Ball { center, radius } => {
            let radius = (radius * flat.scale).min(1e5) as f32;
            painter.circle(project(*center), radius, paper.solid, edge);
        }
        ColliderPicture::Capsule { a, b, radius } => {
            let (from, to) = (project(*a), project(*b));
            let width = (2.0 * radius * flat.scale).min(1e5) as f32;
            for (width, shade) in [(width + 4.0, paper.solid_edge), (width, paper.solid)] {
                painter.line_segment([from, to], Stroke::new(width, shade));
                for end in [from, to] {
                    painter.circle_filled(end, 0.5 * width, shade);
                }
            }
        }
        ColliderPicture::Box { min, max, inside } => {
            let corners = vec![
                project([min[0], min[1], 0.0]),
                project([max[0], min[1], 0.0]),
                project([max[0], max[1], 0.0]),
                project([min[0], max[1], 0.0]),
            ];
            if *inside {
                painter.add(Shape::closed_line(corners, edge));
            } else {
                polygon(corners);
            }
        }
        ColliderPicture::Polygon(points) => polygon(points.iter().map(|p| project(*p)).collect()),
        ColliderPicture::Polyline(points) => {
            painter.line(points.iter().map(|p| project(*p)).collect(), edge);
        }
        ColliderPicture::Mesh { positions, triangles } => {
            let mut mesh = Mesh::default();
            positions.iter().for_each(|p| mesh.colored_vertex(project(*p), paper.solid));
            triangles.iter().for_each(|[a, b, c]| mesh.add_triangle(*a, *b, *c));
            painter.add(Shape::mesh(mesh));
        }
    }
}

/// The mark of a pinned node.
pub(crate) fn pin(painter: &Painter, at: Pos2, paper: &Paper) {
    painter.circle(at, 4.5, Color32::from_rgb(238, 178, 40), Stroke::new(1.5, paper.ink));
}

/// Draws the rubber band of a pull and, next to the pointer where there is space, its force in newtons.
pub(crate) fn rubber(look: &Look<'_>, from: Pos2, to: Pos2, force: &[f64; 3], taken: &[Rect]) {
    let Look { painter, paper, .. } = *look;
    painter.line_segment([from, to], Stroke::new(2.5, RUBBER));
    painter.circle_filled(from, 4.0, RUBBER);
    painter.circle(to, 6.0, paper.background, Stroke::new(2.0, RUBBER));
    newtons(look, to, force, taken);
}

/// Draws the arrow of a push, which is as long as the displacement of the pointer, and its force in newtons.
pub(crate) fn push(look: &Look<'_>, from: Pos2, to: Pos2, force: &[f64; 3], taken: &[Rect]) {
    look.painter.circle_filled(from, 4.0, RUBBER);
    if (to - from).length() >= 2.0 {
        arrows::arrow(look.painter, from, to, Stroke::new(2.5, RUBBER), 11.0);
    }
    newtons(look, to, force, taken);
}

/// Writes a force in newtons next to the pointer, where there is space.
fn newtons(look: &Look<'_>, to: Pos2, force: &[f64; 3], taken: &[Rect]) {
    let Look { painter, paper, .. } = *look;
    let newtons = force.iter().map(|f| f * f).sum::<f64>().sqrt();
    let text = format!("{} N", format_value(newtons));
    let galley = painter.layout_no_wrap(text, FontId::proportional(14.0), RUBBER);
    let text_rect = beside(to, galley.size(), look.rect.shrink(6.0), taken);
    painter.rect_filled(text_rect.expand(3.0), 4.0, paper.background.gamma_multiply(0.85));
    painter.galley(text_rect.min, galley, RUBBER);
}

/// Finds a free position for a rectangle of this size next to a point: above and to the right of the point if possible, otherwise at another side. If
/// the point is out of sight, the rectangle is at the border.
fn beside(at: Pos2, size: Vec2, bounds: Rect, taken: &[Rect]) -> Rect {
    let candidates = [
        (Align2::LEFT_BOTTOM, Vec2::new(12.0, -10.0)),
        (Align2::RIGHT_BOTTOM, Vec2::new(-12.0, -10.0)),
        (Align2::RIGHT_TOP, Vec2::new(-12.0, 10.0)),
        (Align2::LEFT_TOP, Vec2::new(12.0, 10.0)),
    ];
    let candidates = candidates.map(|(align, offset)| align.anchor_size(at + offset, size));
    let free = |rect: &Rect| taken.iter().all(|other| !other.intersects(rect.expand(3.0)));
    // If the point itself is within a taken area, positions next to this area are tried, too.
    let around = taken.iter().filter(|other| other.contains(at)).flat_map(|other| {
        let level = candidates[0].min;
        let [left, right] = [other.left() - size.x - 6.0, other.right() + 6.0].map(|x| Pos2::new(x, level.y));
        [left, right, Pos2::new(level.x, other.bottom() + 6.0)].map(|corner| Rect::from_min_size(corner, size))
    });
    let mut all = candidates.into_iter().chain(around);
    let rect = all.find(|rect| bounds.contains_rect(*rect) && free(rect));
    let rect = rect.or_else(|| candidates.into_iter().find(free)).unwrap_or(candidates[0]);
    let low = bounds.min.to_vec2();
    let high = (bounds.max - size).to_vec2().max(low);
    Rect::from_min_size(rect.min.to_vec2().clamp(low, high).to_pos2(), size)
}

/// Draws a body where it would be placed.
pub(crate) fn ghost(
    painter: &Painter,
    body: &BodyPicture,
    moved: [f64; 3],
    project: &dyn Fn([f64; 3]) -> Option<Pos2>,
    paper: &Paper,
) {
    let lines: &[[u32; 2]] = match &body.facets {
        Facets::Edges(edges) if !edges.is_empty() => edges,
        _ => &body.segments,
    };
    let at = |node: u32| project([0, 1, 2].map(|d| body.positions[node as usize][d] + moved[d]));
    for [a, b] in lines.iter().take(4_000) {
        if let (Some(from), Some(to)) = (at(*a), at(*b)) {
            painter.line_segment([from, to], Stroke::new(1.2, paper.soft));
        }
    }
}

/// Writes the authors of the visible drawings, maps or surfaces, and their licence, at the lower right.
pub(crate) fn credit(look: &Look<'_>) {
    let (rect, credit) = (look.rect, &look.shown.picture.credit);
    if !credit.is_empty() {
        // The credit is next to the scale bar, on as many lines as needed.
        let wrap_width = (0.6 * rect.width()).max(120.0);
        let font = FontId::proportional(10.0);
        let galley = look.painter.layout(credit.clone(), font, look.paper.soft, wrap_width);
        // If there are two scenes, the credit is above the caption of its scene.
        let foot = if look.shown.beside.is_some() { Captions::FOOT[0] } else { 0.0 };
        let spot = rect.max - galley.size() - Vec2::new(8.0, 6.0 + foot);
        look.painter.galley(spot, galley, look.paper.soft);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_force_of_a_pull_stands_where_neither_the_border_nor_anything_else_covers_it() {
        let room = Rect::from_min_size(Pos2::new(10.0, 20.0), Vec2::new(600.0, 400.0));
        let size = Vec2::new(48.0, 18.0);
        let legend = Rect::from_min_max(Pos2::new(500.0, 20.0), Pos2::new(610.0, 220.0));
        let tools = Rect::from_min_max(Pos2::new(10.0, 20.0), Pos2::new(420.0, 60.0));
        let free = beside(Pos2::new(300.0, 200.0), size, room, &[legend, tools]);
        assert!(free.left() > 300.0 && free.bottom() < 200.0, "{free:?}");
        let near = [[480.0, 100.0], [440.0, 200.0], [608.0, 400.0], [12.0, 300.0], [300.0, 70.0], [495.0, 21.0]];
        // Some of these points are within the tools or the legend.
        for at in near.into_iter().chain([[200.0, 40.0], [555.0, 120.0], [604.0, 60.0], [520.0, 210.0]]) {
            let at = Pos2::from(at);
            let place = beside(at, size, room, &[legend, tools]);
            assert!(room.contains_rect(place) && !place.contains(at), "{at:?}: {place:?}");
            assert!(![legend, tools].iter().any(|other| other.intersects(place)), "{at:?}: {place:?}");
        }
        // The point is out of sight, or the window is too small.
        assert!(room.contains_rect(beside(Pos2::new(-900.0, 9000.0), size, room, &[])));
        assert!(beside(Pos2::ZERO, size, Rect::from_min_size(Pos2::ZERO, Vec2::splat(4.0)), &[]).is_finite());
    }
}
