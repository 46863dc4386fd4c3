//! The scenes that come with the program, with pictures that are drawn in the background while the gallery is open.

use super::thumbnails::{self, Pixels, SIZE};
use crate::words::Language;
use crate::work;
use egui::{Color32, ColorImage, RichText, ScrollArea, Sense, TextureHandle, TextureOptions, Ui, Vec2};
use opruga::Registries;
use std::collections::BTreeMap;
use std::sync::mpsc::{Receiver, TryRecvError};

/// The window with the scenes.
#[derive(Default)]
pub struct Gallery {
    /// Whether the gallery is open.
    pub open: bool,
    /// The models and integrators that the scenes can name.
    registries: Registries,
    /// The folder in which pictures are stored between starts.
    #[cfg(not(target_arch = "wasm32"))]
    pub cache: Option<std::path::PathBuf>,
    /// The pictures drawn so far; none for a scene that cannot be drawn.
    pictures: BTreeMap<&'static str, Option<TextureHandle>>,
    coming: Option<(&'static str, Receiver<Option<Pixels>>)>,
    /// The scenes whose cards are in sight.
    seen: Vec<&'static str>,
}

impl core::fmt::Debug for Gallery {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Gallery").field("open", &self.open).finish_non_exhaustive()
    }
}

impl Gallery {
    /// A gallery for scenes with these models and integrators.
    pub fn new(registries: Registries) -> Gallery {
        Gallery { registries, ..Gallery::default() }
    }

    /// Forgets the pictures after their device was lost, so that they are drawn again.
    #[cfg(target_arch = "wasm32")]
    pub fn forget_textures(&mut self) {
        (self.pictures, self.coming) = (BTreeMap::new(), None);
    }

    /// Whether pictures are still being drawn.
    pub fn is_drawing(&self) -> bool {
        self.open && self.coming.is_some()
    }

    /// Shows the window if it is open; returns the name of the scene that was chosen.
    pub fn show(&mut self, ui: &Ui, words: Language, now: &str) -> Option<&'static str> {
        if !self.open {
            return None;
        }
        self.seen.clear();
        let mut chosen = None;
        let mut open = true;
        let content = ui.ctx().content_rect();
        let columns = (((content.width() - 80.0) / 276.0) as usize).clamp(1, 4);
        let tall = (content.height() - 120.0).max(120.0);
        egui::Window::new(words.scenes())
            .open(&mut open)
            .collapsible(false)
            .resizable(false)
            .anchor(egui::Align2::CENTER_CENTER, Vec2::ZERO)
            .fixed_size([columns as f32 * 272.0 + 14.0, tall])
            .show(ui.ctx(), |ui| {
                ScrollArea::vertical().max_height(tall).auto_shrink([false, true]).show(ui, |ui| {
                    ui.set_width(columns as f32 * 272.0);
                    egui::Grid::new("scenes").num_columns(columns).spacing([12.0, 12.0]).show(ui, |ui| {
                        for (number, name) in opruga::scenes::names().enumerate() {
                            if self.card(ui, name, words, name == now) {
                                chosen = Some(name);
                            }
                            if number % columns == columns - 1 {
                                ui.end_row();
                            }
                        }
                    });
                });
            });
        self.take(ui);
        self.open = open && chosen.is_none();
        chosen
    }

    fn card(&mut self, ui: &mut Ui, name: &'static str, words: Language, here: bool) -> bool {
        ui.vertical(|ui| {
            ui.set_width(256.0);
            let (rect, response) = ui.allocate_exact_size(Vec2::new(256.0, 160.0), Sense::click());
            if ui.is_rect_visible(rect) {
                self.seen.push(name);
            }
            let painter = ui.painter();
            match self.pictures.get(name).and_then(Option::as_ref) {
                Some(picture) => {
                    let all = egui::Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
                    painter.image(picture.id(), rect, all, Color32::WHITE);
                }
                None => {
                    painter.rect_filled(rect, 4.0, ui.visuals().extreme_bg_color);
                    let font = egui::FontId::proportional(12.0);
                    let ink = ui.visuals().weak_text_color();
                    painter.text(rect.center(), egui::Align2::CENTER_CENTER, words.pictures_pending(), font, ink);
                }
            }
            let edge =
                if here || response.hovered() { Color32::from_rgb(86, 160, 230) } else { Color32::from_gray(120) };
            let wide = if here || response.hovered() { 2.0 } else { 1.0 };
            painter.rect_stroke(rect, 4.0, egui::Stroke::new(wide, edge), egui::StrokeKind::Inside);
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, name));
            ui.label(RichText::new(name).strong());
            let title = words.scene_title(name);
            ui.add(egui::Label::new(RichText::new(title).size(11.5).weak()).wrap());
            let credit = opruga::scenes::credit(opruga::scenes::find(name).unwrap_or_default());
            if !credit.is_empty() {
                ui.add(egui::Label::new(RichText::new(credit).size(9.5).weak()).wrap());
            }
            response.clicked()
        })
        .inner
    }

    /// Receives a finished picture, and orders the first missing picture whose card is visible. Pictures out of sight are not drawn.
    fn take(&mut self, ui: &Ui) {
        if let Some((name, coming)) = &self.coming {
            let done = match coming.try_recv() {
                Ok(pixels) => pixels,
                Err(TryRecvError::Empty) => return,
                Err(TryRecvError::Disconnected) => None,
            };
            let picture = done.map(|pixels| {
                let picture = ColorImage::from_rgba_unmultiplied(SIZE.map(|side| side as usize), &pixels);
                ui.ctx().load_texture(*name, picture, TextureOptions::LINEAR)
            });
            self.pictures.insert(name, picture);
            self.coming = None;
        }
        if let Some(name) = self.seen.iter().find(|name| !self.pictures.contains_key(*name)).copied() {
            #[cfg(not(target_arch = "wasm32"))]
            let cache = self.cache.clone();
            let (context, registries) = (ui.ctx().clone(), self.registries.clone());
            let coming = work::spawn(async move {
                #[cfg(not(target_arch = "wasm32"))]
                let picture = thumbnails::kept_or_drawn(name, &registries, cache);
                #[cfg(target_arch = "wasm32")]
                let picture = thumbnails::draw(name, &registries);
                let picture = picture.await;
                context.request_repaint();
                picture
            });
            self.coming = Some((name, coming));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A gallery in a window of this size, shown until all visible pictures are drawn.
    fn looked_at(size: [f32; 2]) -> Gallery {
        let (context, mut gallery) = (egui::Context::default(), Gallery { open: true, ..Gallery::default() });
        let begin = std::time::Instant::now();
        for picture in 0.. {
            let screen_rect = Some(egui::Rect::from_min_size(egui::Pos2::ZERO, size.into()));
            let mut output = context.run_ui(egui::RawInput { screen_rect, ..Default::default() }, |ui| {
                gallery.show(ui, Language::English, "ball");
            });
            output.textures_delta.clear();
            if picture > 3 && !gallery.is_drawing() {
                break;
            }
            assert!(begin.elapsed().as_secs() < 240, "it is still drawing");
            std::thread::sleep(std::time::Duration::from_millis(2));
        }
        gallery
    }

    #[test]
    fn pictures_that_nobody_sees_are_not_drawn() {
        let gallery = looked_at([420.0, 420.0]);
        let (drawn, all) = (gallery.pictures.len(), opruga::scenes::names().count());
        assert!((1..8).contains(&drawn) && all > 20, "{drawn} of {all}");
        let first = opruga::scenes::names().next().expect("a scene");
        assert!(gallery.pictures.contains_key(first), "{:?}", gallery.pictures.keys());
        assert!(gallery.pictures.values().all(Option::is_some));
    }
}
