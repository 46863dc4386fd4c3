//! How the interface looks, dark and light.

use egui::{Context, CornerRadius, FontData, FontDefinitions, FontFamily, FontId, Style, TextStyle, Theme, vec2};
use std::sync::Arc;

/// Sets sizes and roundings for both themes.
pub fn apply(context: &Context) {
    // The font of the pictures: it has the letters of formulas and of Croatian.
    let mut fonts = FontDefinitions::default();
    fonts.font_data.insert("inter".into(), Arc::new(FontData::from_static(opruga::draw::FONT)));
    fonts.families.entry(FontFamily::Proportional).or_default().insert(0, "inter".into());
    fonts.families.entry(FontFamily::Monospace).or_default().push("inter".into());
    context.set_fonts(fonts);
    context.set_theme(Theme::Dark);
    context.all_styles_mut(|style: &mut Style| {
        let sizes =
            [(TextStyle::Small, 11.0), (TextStyle::Body, 13.0), (TextStyle::Button, 13.0), (TextStyle::Heading, 15.5)];
        for (kind, size) in sizes {
            style.text_styles.insert(kind, FontId::proportional(size));
        }
        style.spacing.item_spacing = vec2(7.0, 5.0);
        style.spacing.button_padding = vec2(8.0, 3.0);
        style.spacing.slider_width = 150.0;
        style.interaction.tooltip_delay = 0.4;
        for widget in [
            &mut style.visuals.widgets.inactive,
            &mut style.visuals.widgets.hovered,
            &mut style.visuals.widgets.active,
            &mut style.visuals.widgets.open,
        ] {
            widget.corner_radius = CornerRadius::same(5);
        }
    });
}
