//! The legend: what the colours of a scene mean.

use super::look::Look;
use super::plane::{colour, on_paper};
use crate::words::Language;
use egui::{Align2, FontId, Mesh, Pos2, Rect, Shape, Stroke, Vec2};
use opruga::draw::{BodyPicture, format_value, nice_ticks, scientific};

/// The bar of colours, and all that the legend takes; none where nothing has colours that mean something.
fn places(look: &Look<'_>, tools: Option<Rect>) -> Option<[Rect; 2]> {
    let Look { shown, rect, .. } = *look;
    shown.picture.legend.as_ref()?;
    let drawn = |body: &BodyPicture| shown.dimension == 2 && body.areas.iter().any(|area| area.colour.is_some());
    if shown.picture.bodies.iter().all(|body| drawn(body) || body.scalar.iter().all(|s| !s.is_finite())) {
        return None;
    }
    let tall = (0.4 * rect.height()).clamp(60.0, 180.0);
    // Beside the tools, or where there is no room for that, below them.
    let below = tools.filter(|tools| tools.right() > rect.right() - 110.0).map_or(rect.top(), |tools| tools.bottom());
    let bar = Rect::from_min_size(Pos2::new(rect.right() - 70.0, below + 44.0), Vec2::new(12.0, tall));
    let whole = Rect::from_min_max(bar.min - Vec2::new(24.0, 28.0), Pos2::new(rect.right() - 4.0, bar.bottom() + 12.0));
    Some([bar, whole])
}

/// Where the legend is.
pub(super) fn place(look: &Look<'_>, tools: Option<Rect>) -> Option<Rect> {
    places(look, tools).map(|[_, whole]| whole)
}

/// What the colours mean.
pub(super) fn paint(look: &Look<'_>, tools: Option<Rect>, language: Language) {
    let Look { painter, shown, rect, paper, range, .. } = *look;
    let (Some(legend), Some([bar, behind])) = (&shown.picture.legend, places(look, tools)) else { return };
    painter.rect_filled(behind, 6.0, paper.background.gamma_multiply(0.7));
    let mut mesh = Mesh::default();
    let steps = 32;
    for k in 0..=steps {
        let share = k as f32 / steps as f32;
        let c = colour(legend.map.colour(f64::from(1.0 - share)));
        let c = if shown.dimension == 2 { on_paper(c, paper) } else { c };
        let y = bar.top() + share * bar.height();
        mesh.colored_vertex(Pos2::new(bar.left(), y), c);
        mesh.colored_vertex(Pos2::new(bar.right(), y), c);
        if k < steps {
            let first = 2 * k as u32;
            mesh.add_triangle(first, first + 1, first + 2);
            mesh.add_triangle(first + 1, first + 3, first + 2);
        }
    }
    painter.add(Shape::mesh(mesh));
    let unit = if legend.unit.is_empty() { String::new() } else { format!(" [{}]", legend.unit) };
    let name = format!("{}{unit}", language.quantity(&legend.label));
    let spot = Pos2::new(rect.right() - 10.0, bar.top() - 8.0);
    painter.text(spot, Align2::RIGHT_BOTTOM, name, FontId::proportional(12.0), paper.ink);
    for tick in nice_ticks(range[0], range[1], 4) {
        let share = ((tick - range[0]) / (range[1] - range[0])) as f32;
        if !(0.0..=1.0).contains(&share) {
            continue;
        }
        let y = bar.bottom() - share * bar.height();
        painter
            .line_segment([Pos2::new(bar.right(), y), Pos2::new(bar.right() + 4.0, y)], Stroke::new(1.0, paper.soft));
        let spot = Pos2::new(bar.right() + 7.0, y);
        let (text, room) = (figure(tick), behind.right() - spot.x);
        let laid = |size: f32| painter.layout_no_wrap(text.clone(), FontId::proportional(size), paper.ink);
        let mut galley = laid(SIZE);
        if galley.size().x > room {
            galley = laid(SIZE * room / galley.size().x);
        }
        painter.galley(spot - Vec2::new(0.0, 0.5 * galley.size().y), galley, paper.ink);
    }
}

/// The size of the figures, where they find room [points].
const SIZE: f32 = 11.5;

/// A figure beside the bar, where there is no room for many digits.
fn figure(value: f64) -> String {
    if value.is_finite() && value.abs() >= 1e5 { scientific(value) } else { format_value(value) }
}

#[cfg(test)]
mod tests {
    use super::figure;

    #[test]
    fn figures_beside_the_bar_are_short_however_large_they_are() {
        for (value, text) in [
            (0.0, "0"),
            (0.25, "0.25"),
            (50_000.0, "50\u{a0}000"),
            (6e6, "6×10⁶"),
            (-250_000.0, "−2.5×10⁵"),
            (1e5, "10⁵"),
        ] {
            assert_eq!(figure(value), text);
        }
    }
}
