//! Arrows, pins and the rubber lines of pointers, which are drawn over flat and solid scenes alike.

use crate::canvas::{Anchor, Canvas, paint, text_width};
use crate::colour::{INK, OKABE_ITO, RUBBER};
use crate::picture::{ArrowKind, ArrowPicture, Picture};
use crate::view::View;
use tiny_skia::PathBuilder;

/// The largest number of pins of a body for which each pin may be drawn as a support.
const SUPPORTS: usize = 40;
/// The minimum distance between neighbouring supports, in units of the size of lines.
const SUPPORT_SPACING: f32 = 17.0;

/// The number of arrows above which they are drawn thinner.
const CROWD: usize = 50;

/// The colour of a kind of arrow.
pub fn arrow_colour(kind: ArrowKind) -> [u8; 3] {
    match kind {
        ArrowKind::Force => INK,
        ArrowKind::Pressure => OKABE_ITO[0],
        ArrowKind::Elastic => OKABE_ITO[2],
        ArrowKind::Gravity => [120, 124, 132],
        ArrowKind::Contact => OKABE_ITO[1],
        ArrowKind::Pull => RUBBER,
        ArrowKind::Velocity => [128, 72, 160],
        ArrowKind::Normal => [108, 114, 124],
    }
}

/// The name of a kind of arrow.
pub(crate) fn arrow_name(kind: ArrowKind) -> &'static str {
    match kind {
        ArrowKind::Force => "force",
        ArrowKind::Pressure => "pressure",
        ArrowKind::Elastic => "elastic",
        ArrowKind::Gravity => "gravity",
        ArrowKind::Contact => "contact",
        ArrowKind::Pull => "pull",
        ArrowKind::Velocity => "velocity",
        ArrowKind::Normal => "normal",
    }
}

/// The unit of a kind of arrow, given the unit of lengths.
pub fn arrow_unit(kind: ArrowKind, length: &str) -> String {
    match (kind, length) {
        (ArrowKind::Normal, _) => String::new(),
        (ArrowKind::Pressure, "m") => "Pa".into(),
        (ArrowKind::Velocity, length) => format!("{length}/s"),
        (_, "m") => "N".into(),
        (ArrowKind::Pressure, length) => format!("kg/({length} s²)"),
        (_, length) => format!("kg {length}/s²"),
    }
}

/// Draws the pins, names and rubber lines of a picture, and the given arrows. `project` returns the pixel of a point, and `in_sight` returns whether
/// a point is visible that lies at most a distance [m] below a surface.
pub(crate) fn draw_marks(
    canvas: &mut Canvas,
    (picture, arrows): (&Picture, &[ArrowPicture]),
    view: &View,
    background: [u8; 3],
    unit: f32,
    project: &dyn Fn([f64; 3]) -> Option<[f32; 2]>,
    in_sight: &dyn Fn([f64; 3], f64) -> bool,
) {
    for body in &picture.bodies {
        let pins = body.pinned.iter().map(|node| body.positions[*node as usize]);
        let points: Vec<[f32; 2]> =
            pins.filter(|position| in_sight(*position, 0.5 * body.spring_width)).filter_map(project).collect();
        // Marks that would overlap are merged. If supports would be so close that they form a row, dots replace them.
        let supports = marks_apart(&points, 12.0 * unit);
        let row = marks_apart(&supports, SUPPORT_SPACING * unit).len() < supports.len();
        if body.pinned.len() <= SUPPORTS && !row {
            supports.into_iter().for_each(|point| support(canvas, point, unit));
        } else {
            marks_apart(&points, 7.0 * unit).into_iter().for_each(|point| canvas.disc(point, 2.2 * unit, INK));
        }
    }
    draw_arrows(canvas, arrows, view, unit, project, &|point| in_sight(point, 0.0));
    for pull in &picture.pulls {
        if let (Some(node), Some(pointer)) = (project(pull.node), project(pull.pointer)) {
            rubber_line(canvas, node, pointer, unit);
        }
    }
    // Names are drawn over everything else.
    labels(canvas, picture, background, unit, project);
}

/// Selects the points that are farther than `apart` from all points selected before them.
fn marks_apart(points: &[[f32; 2]], apart: f32) -> Vec<[f32; 2]> {
    let close = |a: [f32; 2], b: [f32; 2]| (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2) < apart * apart;
    let mut marked: Vec<[f32; 2]> = Vec::new();
    for &point in points {
        if !marked.iter().any(|other| close(*other, point)) {
            marked.push(point);
        }
    }
    marked
}

/// Draws arrows.
pub(crate) fn draw_arrows(
    canvas: &mut Canvas,
    arrows: &[ArrowPicture],
    view: &View,
    unit: f32,
    project: &dyn Fn([f64; 3]) -> Option<[f32; 2]>,
    in_sight: &dyn Fn([f64; 3]) -> bool,
) {
    let width = if arrows.len() > CROWD { 1.2 } else { 1.8 } * unit;
    for mark in arrows {
        let scale = view.arrow_scale(mark.kind);
        let to = std::array::from_fn(|axis| mark.from[axis] + scale * mark.vector[axis]);
        if !in_sight(mark.from) {
            continue;
        }
        if let (Some(from), Some(to)) = (project(mark.from), project(to)) {
            let long = (to[0] - from[0]).abs() + (to[1] - from[1]).abs();
            arrow(canvas, [from, to], width, arrow_colour(mark.kind), long > 16.0 * unit);
        }
    }
}

/// A name and the box of pixels of its body.
struct Label<'a> {
    text: &'a str,
    low: [f32; 2],
    high: [f32; 2],
}

/// The position of a name relative to its body.
#[derive(Clone, Copy)]
enum Side {
    Above,
    Below,
    Right,
    Left,
}

/// Writes the names of bodies either all above or all below the bodies, whichever covers less. No name then seems to belong to a neighbour. Names
/// that still cover something are written to the right or to the left of their body; if neither side is free, they get a light background.
fn labels(
    canvas: &mut Canvas,
    picture: &Picture,
    background: [u8; 3],
    unit: f32,
    project: &dyn Fn([f64; 3]) -> Option<[f32; 2]>,
) {
    let scene = canvas.size();
    let mut all: Vec<Label<'_>> = Vec::new();
    for body in picture.bodies.iter().filter(|body| !body.label.is_empty()) {
        let (mut low, mut high) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
        // The box includes the rest position, so that the name stays in place while the body oscillates about that position.
        for pixel in body.positions.iter().chain(&body.rest.positions).filter_map(|x| project(*x)) {
            for axis in 0..2 {
                low[axis] = low[axis].min(pixel[axis]);
                high[axis] = high[axis].max(pixel[axis]);
            }
        }
        if (0..2).all(|axis| high[axis] >= 0.0 && low[axis] <= scene[axis] && (high[axis] - low[axis]).is_finite()) {
            all.push(Label { text: &body.label, low, high });
        }
    }
    let rect = |label: &Label<'_>, side: Side| label.rect(side, scene, unit);
    let covered = |canvas: &Canvas, side: Side| -> usize {
        all.iter().map(|label| canvas.differing(rect(label, side), background)).sum()
    };
    // Names are above the bodies unless they would cover much more there than below. This prevents them from jumping between pictures.
    let area: f32 = all.iter().map(|label| rect(label, Side::Above)).map(|[.., wide, tall]| wide * tall).sum();
    let much = covered(canvas, Side::Below) + (0.15 * area) as usize;
    let side = if much < covered(canvas, Side::Above) { Side::Below } else { Side::Above };
    for label in &all {
        let own = rect(label, side);
        // A name that covers only a little stays in the row.
        let enough = (0.1 * own[2] * own[3]) as usize;
        let free = [Side::Right, Side::Left].map(|side| rect(label, side));
        let free = free.into_iter().find(|rect| canvas.differing(*rect, background) == 0);
        let at = match free {
            Some(free) if canvas.differing(own, background) > enough => free,
            _ => own,
        };
        if canvas.differing(at, background) > 0 {
            canvas.rectangle(at, [255; 3], 0.8);
        }
        let size = LABEL * unit;
        canvas.text(label.text, [at[0] + 0.5 * at[2], at[1] + 0.85 * size], size, Anchor::Middle, INK);
    }
}

/// The size of names.
const LABEL: f32 = 12.0;

impl Label<'_> {
    /// The left, top, width and height of the name at the given side of its body, moved so that they are within the scene.
    fn rect(&self, side: Side, scene: [f32; 2], unit: f32) -> [f32; 4] {
        let size = LABEL * unit;
        let (wide, tall, gap) = (text_width(self.text, size) + 4.0 * unit, 1.15 * size, 4.0 * unit);
        let middle = [0.5 * (self.low[0] + self.high[0]), 0.5 * (self.low[1] + self.high[1])];
        let [left, top] = match side {
            Side::Above => [middle[0] - 0.5 * wide, self.low[1] - gap - tall],
            Side::Below => [middle[0] - 0.5 * wide, self.high[1] + gap],
            Side::Right => [self.high[0] + gap, middle[1] - 0.5 * tall],
            Side::Left => [self.low[0] - gap - wide, middle[1] - 0.5 * tall],
        };
        [left.min(scene[0] - wide - unit).max(unit), top.min(scene[1] - tall - unit).max(unit), wide, tall]
    }
}

/// Draws an arrow with a filled head and, over a scene, with a light rim.
pub(crate) fn arrow(canvas: &mut Canvas, [from, to]: [[f32; 2]; 2], width: f32, colour: [u8; 3], rim: bool) {
    let along = [to[0] - from[0], to[1] - from[1]];
    let length = (along[0] * along[0] + along[1] * along[1]).sqrt();
    if !length.is_finite() || length < 1.5 {
        return;
    }
    let direction = [along[0] / length, along[1] / length];
    let head = (4.6 * width).min(0.6 * length);
    let half = 0.38 * head;
    let neck = [to[0] - head * direction[0], to[1] - head * direction[1]];
    let left = [neck[0] - half * direction[1], neck[1] + half * direction[0]];
    let right = [neck[0] + half * direction[1], neck[1] - half * direction[0]];
    let inner = [neck[0] + 0.2 * head * direction[0], neck[1] + 0.2 * head * direction[1]];
    if rim {
        // The rim begins a little later than the arrow, so that it does not cover the outline from which the arrow starts.
        let start = [from[0] + 3.0 * width * direction[0], from[1] + 3.0 * width * direction[1]];
        canvas.line(&[start, neck], width + 2.0, [255; 3], 0.6);
        canvas.line(&[to, left, right, to], 2.4, [255; 3], 0.75);
    }
    canvas.line(&[from, inner], width.min(0.35 * length), colour, 1.0);
    canvas.polygon(&[to, left, inner, right], colour, 1.0);
}

/// Draws the symbol of a support under a pinned node.
fn support(canvas: &mut Canvas, point: [f32; 2], unit: f32) {
    let (half, tall) = (5.5 * unit, 9.0 * unit);
    let corners = [point, [point[0] - half, point[1] + tall], [point[0] + half, point[1] + tall]];
    canvas.polygon(&corners, [255; 3], 1.0);
    canvas.line(&[corners[0], corners[1], corners[2], corners[0]], 1.3 * unit, INK, 1.0);
    canvas.line(
        &[[point[0] - 1.5 * half, point[1] + tall], [point[0] + 1.5 * half, point[1] + tall]],
        1.6 * unit,
        INK,
        1.0,
    );
    canvas.disc(point, 2.2 * unit, INK);
}

/// Draws the rubber line from a node to a pointer.
fn rubber_line(canvas: &mut Canvas, node: [f32; 2], pointer: [f32; 2], unit: f32) {
    canvas.line(&[node, pointer], 3.4 * unit, [255; 3], 0.8);
    if let Some(path) = crate::canvas::path_of(&[node, pointer], false) {
        canvas.stroke_dashed(&path, 1.8 * unit, &[6.0 * unit, 3.5 * unit], &paint(RUBBER, 1.0));
    }
    canvas.disc(node, 3.0 * unit, RUBBER);
    canvas.disc(pointer, 6.5 * unit, RUBBER);
    if let Some(path) = PathBuilder::from_circle(pointer[0], pointer[1], 4.4 * unit) {
        canvas.fill(&path, &paint([255; 3], 1.0));
    }
}
