//! The legend: the meaning of the colours of a scene.

use super::look::{Look, colour, on_paper};
use crate::shown::Shown;
use crate::words::Language;
use egui::text::LayoutJob;
use egui::{Align, Align2, CornerRadius, FontId, Galley, Mesh, Pos2, Rect, Shape, Stroke, Vec2};
use opruga::draw::{BodyPicture, format_value, nice_ticks, scientific};
use std::sync::Arc;

/// The smallest and the largest width of a line of the name [points].
const NAME: [f32; 2] = [84.0, 240.0];

/// Whether a body is drawn in its own colours.
fn drawn(shown: &Shown, body: &BodyPicture) -> bool {
    shown.dimension == 2 && body.areas.iter().any(|area| area.colour.is_some())
}

/// The layout of the legend: its bar of colours, its name, and its whole rectangle.
struct LegendLayout {
    bar: Rect,
    name: Arc<Galley>,
    whole: Rect,
}

/// Computes the layout of the legend; none if no colours have a meaning.
fn legend_layout(look: &Look<'_>, tools: Option<Rect>, language: Language) -> Option<LegendLayout> {
    let Look { painter, shown, rect, paper, .. } = *look;
    let legend = shown.picture.legend.as_ref()?;
    if shown.picture.bodies.iter().all(|body| drawn(shown, body) || body.scalar.iter().all(|s| !s.is_finite())) {
        return None;
    }
    let tall = (0.4 * rect.height()).clamp(60.0, 180.0);
    // The legend is next to the tools or, if there is no space, below them. The lower one of two scenes has no tools.
    let tools = tools.filter(|tools| tools.intersects(rect));
    let over = tools.filter(|tools| tools.right() > rect.right() - 110.0);
    let below = over.map_or(rect.top(), |tools| tools.bottom());
    let unit = if legend.unit.is_empty() { String::new() } else { format!(" [{}]", legend.unit) };
    let left = if over.is_some() { rect.left() } else { tools.map_or(rect.left(), |tools| tools.right()) };
    let max_width = (rect.right() - 24.0 - left).clamp(NAME[0], NAME[1]);
    let text = format!("{}{unit}", language.quantity(&legend.label));
    let mut job = LayoutJob::simple(text, FontId::proportional(12.0), paper.ink, max_width);
    job.halign = Align::RIGHT;
    let name = painter.layout_job(job);
    // A name of two lines moves the bar down.
    let more = name.size().y * (1.0 - 1.0 / name.rows.len().max(1) as f32);
    let bar = Rect::from_min_size(Pos2::new(rect.right() - 70.0, below + 44.0 + more), Vec2::new(12.0, tall));
    let left = (bar.left() - 24.0).min(rect.right() - 16.0 - name.size().x);
    let whole = Rect::from_min_max(
        Pos2::new(left, bar.top() - 28.0 - more),
        Pos2::new(rect.right() - 4.0, bar.bottom() + 12.0),
    );
    Some(LegendLayout { bar, name, whole })
}

/// The rectangle of the legend.
pub(super) fn bounds(look: &Look<'_>, tools: Option<Rect>, language: Language) -> Option<Rect> {
    legend_layout(look, tools, language).map(|layout| layout.whole)
}

/// If everything is grey because no visible body has the quantity that the colours show, writes a text that explains this.
pub(super) fn explain_absence(look: &Look<'_>, tools: Option<Rect>, language: Language) {
    let Look { painter, shown, rect, paper, .. } = *look;
    let Some(legend) = &shown.picture.legend else { return };
    if shown.picture.bodies.iter().all(|body| drawn(shown, body)) {
        return;
    }
    let text = language.nothing_has_it().replace("{}", language.quantity(&legend.label));
    let below = tools.filter(|tools| tools.intersects(rect)).map_or(rect.top(), |tools| tools.bottom());
    let galley = painter.layout(text, FontId::proportional(12.0), paper.soft, (0.6 * rect.width()).max(NAME[0]));
    let text_rect = Align2::RIGHT_TOP.anchor_size(Pos2::new(rect.right() - 12.0, below + 12.0), galley.size());
    painter.rect_filled(text_rect.expand(4.0), 4.0, paper.background.gamma_multiply(0.7));
    painter.galley(text_rect.min, galley, paper.soft);
}

/// Draws the legend.
pub(super) fn paint(look: &Look<'_>, tools: Option<Rect>, language: Language) {
    let Look { painter, shown, rect, paper, range, .. } = *look;
    let Some(legend) = &shown.picture.legend else { return };
    let Some(LegendLayout { bar, name, whole: behind }) = legend_layout(look, tools, language) else { return };
    // A long name is wider than the bar with its numbers. The background is not drawn in the corner below the name and next to the bar, so that the
    // scene remains visible there.
    let side = behind.with_min_x(bar.left() - 24.0);
    let above = behind.with_max_y(bar.top() - 4.0);
    let ground = paper.background.gamma_multiply(0.7);
    if above.left() < side.left() - 1.0 {
        let corners = CornerRadius { nw: 6, sw: 6, ..CornerRadius::ZERO };
        painter.rect_filled(above.with_max_x(side.left()), corners, ground);
    }
    painter.rect_filled(side, 6.0, ground);
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
    let spot = Pos2::new(rect.right() - 10.0, bar.top() - 8.0 - name.size().y);
    painter.galley(spot, name, paper.ink);
    for tick in nice_ticks(range[0], range[1], 4) {
        let share = ((tick - range[0]) / (range[1] - range[0])) as f32;
        if !(0.0..=1.0).contains(&share) {
            continue;
        }
        let y = bar.bottom() - share * bar.height();
        painter
            .line_segment([Pos2::new(bar.right(), y), Pos2::new(bar.right() + 4.0, y)], Stroke::new(1.0, paper.soft));
        let spot = Pos2::new(bar.right() + 7.0, y);
        let (text, max_width) = (figure(tick), behind.right() - spot.x);
        let laid = |size: f32| painter.layout_no_wrap(text.clone(), FontId::proportional(size), paper.ink);
        let mut galley = laid(SIZE);
        if galley.size().x > max_width {
            galley = laid(SIZE * max_width / galley.size().x);
        }
        painter.galley(spot - Vec2::new(0.0, 0.5 * galley.size().y), galley, paper.ink);
    }
}

/// The font size of the numbers, if they fit [points].
const SIZE: f32 = 11.5;

/// The text of a number next to the bar, where there is space for only a few digits.
fn figure(value: f64) -> String {
    if value.is_finite() && value.abs() >= 1e5 { scientific(value) } else { format_value(value) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::canvas::look::Paper;
    use egui_kittest::Harness;
    use opruga::draw::{Legend, Picture};

    #[test]
    fn the_name_of_what_is_shown_lies_within_the_legend_and_the_legend_in_its_part_of_the_window() {
        let legend = |label: &str| Legend { label: label.into(), unit: "Pa".into(), ..Default::default() };
        let shown = |label: &str| {
            let body = BodyPicture { positions: vec![[0.0; 3]], scalar: vec![1.0], ..Default::default() };
            let picture =
                Picture { dimension: 2, bodies: vec![body], legend: Some(legend(label)), ..Default::default() };
            Shown { dimension: 2, picture, ..Default::default() }
        };
        let tools = Rect::from_min_max(Pos2::new(10.0, 160.0), Pos2::new(314.0, 248.0));
        // The cases are a phone, the lower of two scenes on a phone, and a small laptop with space next to the tools.
        let parts = [
            (Rect::from_min_max(Pos2::new(0.0, 150.0), Pos2::new(360.0, 555.0)), tools),
            (Rect::from_min_max(Pos2::new(0.0, 352.0), Pos2::new(360.0, 555.0)), tools),
            (
                Rect::from_min_max(Pos2::new(0.0, 55.0), Pos2::new(976.0, 686.0)),
                Rect::from_min_max(Pos2::new(10.0, 66.0), Pos2::new(850.0, 100.0)),
            ),
        ];
        let mut harness = Harness::new_ui(move |ui| {
            for (rect, tools) in parts {
                for label in ["strain", "volume / volume at rest", "von Mises stress"] {
                    for language in [Language::English, Language::Croatian] {
                        let (shown, paper) = (shown(label), Paper::of(ui));
                        let painter = ui.painter();
                        let range = [0.0, 1.0];
                        let look =
                            Look { painter, shown: &shown, rect, paper: &paper, show: Default::default(), range };
                        let LegendLayout { bar, name, whole } =
                            legend_layout(&look, Some(tools), language).expect("a legend");
                        let at = Vec2::new(rect.right() - 10.0, bar.top() - 8.0 - name.size().y);
                        let named = name.rect.translate(at);
                        let told = format!("{label}, {language:?}, {rect:?}: {named:?} of {whole:?}");
                        assert!(whole.contains_rect(named.expand(2.0)) && whole.contains_rect(bar), "{told}");
                        assert!(rect.contains_rect(whole) && !tools.intersects(named), "{told}");
                    }
                }
            }
        });
        harness.run();
    }

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
