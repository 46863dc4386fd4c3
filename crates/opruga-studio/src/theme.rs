//! The appearance of the interface, dark and light.

use egui::{
    Color32, Context, CornerRadius, FontData, FontDefinitions, FontFamily, FontId, Style, TextStyle, Theme, vec2,
};
use std::sync::Arc;

/// A monospaced font for excerpts of files and for time: the characters of English and Croatian from Hack.
const MONOSPACE: &[u8] = include_bytes!("../font/hack-subset.ttf");

/// Adds the fonts of the interface to other fonts. In a desktop window, missing characters come from the fonts of the toolkit. A web page need not
/// contain these, because a browser draws missing characters with its own fonts.
fn with_own(mut fonts: FontDefinitions) -> FontDefinitions {
    // This font of the pictures contains the characters of formulas and of Croatian.
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

/// Sets fonts, sizes and corner radii for both themes.
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
    // The toolkit draws faint text with too little contrast. If faint text gets more contrast, plain text needs more, too.
    for (theme, plain, faint) in [(Theme::Dark, 190, 154), (Theme::Light, 60, 100)] {
        context.style_mut_of(theme, |style| {
            style.visuals.widgets.noninteractive.fg_stroke.color = Color32::from_gray(plain);
            style.visuals.weak_text_color = Some(Color32::from_gray(faint));
        });
    }
}

/// The colour of text that needs attention.
pub fn attention(visuals: &egui::Visuals) -> Color32 {
    if visuals.dark_mode { Color32::from_rgb(230, 140, 20) } else { Color32::from_rgb(158, 80, 0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The contrast of two colours according to the Web Content Accessibility Guidelines, from 1 to 21.
    fn contrast(a: Color32, b: Color32) -> f64 {
        let linear = |part: u8| {
            let share = f64::from(part) / 255.0;
            if share <= 0.04045 { share / 12.92 } else { ((share + 0.055) / 1.055).powf(2.4) }
        };
        let light = |c: Color32| 0.2126 * linear(c.r()) + 0.7152 * linear(c.g()) + 0.0722 * linear(c.b()) + 0.05;
        let (a, b) = (light(a), light(b));
        a.max(b) / a.min(b)
    }

    #[test]
    fn faint_text_can_be_read_on_every_ground_of_both_themes_and_plain_text_stands_out_more() {
        let context = Context::default();
        apply(&context);
        for theme in [Theme::Dark, Theme::Light] {
            let style = context.style_of(theme);
            let visuals = &style.visuals;
            let grounds = [
                visuals.panel_fill,
                visuals.window_fill,
                visuals.extreme_bg_color,
                visuals.widgets.inactive.weak_bg_fill,
            ];
            for ground in grounds {
                let [faint, plain] =
                    [visuals.weak_text_color(), visuals.text_color()].map(|text| contrast(text, ground));
                assert!(contrast(attention(visuals), ground) >= 4.5, "{theme:?} on {ground:?}");
                assert!(faint >= 4.5 && plain > 1.3 * faint, "{theme:?} on {ground:?}: {faint} {plain}");
            }
        }
    }

    #[test]
    fn the_fonts_that_the_page_carries_have_every_letter_of_the_interface_and_of_the_scenes() {
        let context = Context::default();
        context.set_fonts(with_own(FontDefinitions::empty()));
        let mut output = context.run_ui(egui::RawInput::default(), |_| {});
        output.textures_delta.clear();
        let own = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
        let mut said =
            crate::words::ALL.iter().map(|(_, english, croatian)| format!("{english}{croatian}")).collect::<String>();
        said.extend(opruga::scenes::names().filter_map(opruga::scenes::find));
        let mut folders = vec![own.join("src/words"), own.join("../opruga-words/hr")];
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
