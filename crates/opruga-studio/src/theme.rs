//! How the interface looks, dark and light.

use egui::{Context, CornerRadius, FontData, FontDefinitions, FontFamily, FontId, Style, TextStyle, Theme, vec2};
use std::sync::Arc;

/// Letters of one width for excerpts of files and for time: those of English and Croatian out of Hack.
const MONOSPACE: &[u8] = include_bytes!("../font/hack-subset.ttf");

/// Adds the fonts of the interface to others. What they lack natively comes from those of the toolkit; a browser draws it with
/// its own, and the page need not carry those.
fn with_own(mut fonts: FontDefinitions) -> FontDefinitions {
    // The font of the pictures: it has the letters of formulas and of Croatian.
    fonts.font_data.insert("inter".into(), Arc::new(FontData::from_static(opruga::draw::FONT)));
    fonts.font_data.insert("hack".into(), Arc::new(FontData::from_static(MONOSPACE)));
    for (family, [first, last]) in
        [(FontFamily::Proportional, ["inter", "hack"]), (FontFamily::Monospace, ["hack", "inter"])]
    {
        let names = fonts.families.entry(family).or_default();
        names.insert(0, first.into());
        names.push(last.into());
    }
    fonts
}

/// Sets fonts, sizes and roundings for both themes.
pub fn apply(context: &Context) {
    context.set_fonts(with_own(FontDefinitions::default()));
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fonts_that_the_page_carries_have_every_letter_of_the_interface_and_of_the_scenes() {
        let context = Context::default();
        context.set_fonts(with_own(FontDefinitions::empty()));
        let mut output = context.run_ui(egui::RawInput::default(), |_| {});
        output.textures_delta.clear();
        let words = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src/words");
        let mut said =
            crate::words::ALL.iter().map(|(_, english, croatian)| format!("{english}{croatian}")).collect::<String>();
        said.extend(opruga::scenes::names().filter_map(opruga::scenes::find));
        let mut folders = vec![words];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(folder).expect("a folder").flatten() {
                match entry.path() {
                    path if path.is_dir() => folders.push(path),
                    path => said.push_str(&std::fs::read_to_string(path).expect("a source")),
                }
            }
        }
        let letters: std::collections::BTreeSet<char> = said.chars().filter(|letter| !letter.is_control()).collect();
        assert!(letters.len() > 120, "{}", letters.len());
        for family in [FontFamily::Proportional, FontFamily::Monospace] {
            let font = FontId::new(12.0, family);
            let missing: Vec<&char> =
                letters.iter().filter(|letter| !context.fonts_mut(|fonts| fonts.has_glyph(&font, **letter))).collect();
            assert!(missing.is_empty(), "{font:?}: {missing:?}");
        }
    }
}
