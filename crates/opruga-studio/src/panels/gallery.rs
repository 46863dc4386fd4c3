//! The scenes that come with the program, with pictures of them that are drawn beside the interface while they are looked at.

use crate::words::Language;
use crate::work;
use egui::{Color32, ColorImage, RichText, ScrollArea, Sense, TextureHandle, TextureOptions, Ui, Vec2};
use opruga::draw::{Image, View, draw_scene};
use opruga::io::scene;
use opruga::pictures::Scenery;
use opruga::{Options, World, blueprint::AnyBlueprint};
use std::collections::BTreeMap;
use std::sync::mpsc::{Receiver, channel};

/// The size of a picture in pixels.
const SIZE: [u32; 2] = [256, 160];
/// Nodes times frames up to which a scene is run for its picture.
const WORK: u64 = 3_000_000;

/// The window with the scenes.
#[derive(Default)]
pub struct Gallery {
    /// Whether it is open.
    pub open: bool,
    pictures: BTreeMap<&'static str, TextureHandle>,
    coming: Option<Receiver<(&'static str, Image)>>,
}

impl core::fmt::Debug for Gallery {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Gallery").field("open", &self.open).finish_non_exhaustive()
    }
}

impl Gallery {
    /// Draws its pictures anew: what they were drawn on is gone.
    #[cfg(target_arch = "wasm32")]
    pub fn forget_textures(&mut self) {
        (self.pictures, self.coming) = (BTreeMap::new(), None);
    }

    /// Whether pictures are still to come.
    pub fn is_drawing(&self) -> bool {
        self.open && self.coming.is_some() && self.pictures.len() < opruga::scenes::names().count()
    }

    /// Shows the window if it is open; the name of the scene that was chosen.
    pub fn show(&mut self, ui: &Ui, words: Language, now: &str) -> Option<&'static str> {
        if !self.open {
            return None;
        }
        self.take(ui);
        let mut chosen = None;
        let mut open = true;
        let room = ui.ctx().content_rect();
        let columns = (((room.width() - 80.0) / 276.0) as usize).clamp(1, 4);
        let tall = (room.height() - 120.0).max(120.0);
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
        self.open = open && chosen.is_none();
        chosen
    }

    fn card(&self, ui: &mut Ui, name: &'static str, words: Language, here: bool) -> bool {
        ui.vertical(|ui| {
            ui.set_width(256.0);
            let (rect, response) = ui.allocate_exact_size(Vec2::new(256.0, 160.0), Sense::click());
            let painter = ui.painter();
            match self.pictures.get(name) {
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

    /// Takes pictures that are done; orders them when the window is opened for the first time.
    fn take(&mut self, ui: &Ui) {
        let coming = self.coming.get_or_insert_with(|| {
            let (sender, receiver) = channel();
            let context = ui.ctx().clone();
            // The pictures come one by one; nothing is to be said when all are there.
            drop(work::spawn(async move {
                for name in opruga::scenes::names() {
                    work::breathe().await;
                    let Some(image) = thumbnail(name).await else { continue };
                    if sender.send((name, image)).is_err() {
                        return;
                    }
                    context.request_repaint();
                }
            }));
            receiver
        });
        for (name, image) in coming.try_iter() {
            let size = [image.width() as usize, image.height() as usize];
            let picture = ColorImage::from_rgba_unmultiplied(size, image.pixels());
            self.pictures.insert(name, ui.ctx().load_texture(name, picture, TextureOptions::LINEAR));
        }
    }
}

/// A picture of a scene a little after its start; of a large one at its start.
async fn thumbnail(name: &str) -> Option<Image> {
    let options = scene::Options { files: opruga::scenes::files(), ..scene::Options::default() };
    let text = opruga::scenes::find(name)?;
    let (blueprint, _) = scene::read(text.as_bytes(), name, &opruga::catalogue(), &options).ok()?;
    match blueprint {
        AnyBlueprint::Plane(blueprint) => picture(World::new(blueprint, Options::default()).ok()?).await,
        AnyBlueprint::Space(blueprint) => picture(World::new(blueprint, Options::default()).ok()?).await,
    }
}

async fn picture<const D: usize>(mut world: World<D>) -> Option<Image> {
    let nodes: u64 = world.bodies().map(|body| world.node_count(body) as u64).sum();
    let frames = (0.25 * world.blueprint().time.seconds / world.blueprint().time.frame) as u64;
    let work = nodes * frames * u64::from(world.blueprint().time.substeps);
    if work <= 32 * WORK {
        for _ in 0..frames {
            work::breathe().await;
            world.frame().ok()?;
        }
    }
    let scenery = Scenery::new(&world);
    let moment = scenery.capture(&mut world, false);
    let mut picture = scenery.picture(&moment);
    picture.bodies.iter_mut().for_each(|body| body.label.clear());
    let view = View::fit([&picture]).ok()?;
    draw_scene(&picture, &view, [252, 252, 253], SIZE).ok()
}
