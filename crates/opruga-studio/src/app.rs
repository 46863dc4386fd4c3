//! The window: its layout, shortcuts and messages.

mod arrivals;
#[cfg(not(target_arch = "wasm32"))]
mod closing;
mod help;
mod keys;
mod message;

use crate::canvas::{Canvas, Tool};
use crate::differences::Difference;
use crate::hand::Hand;
use crate::panels::gallery::Gallery;
use crate::panels::keeping::Keeping;
use crate::panels::properties::Properties;
use crate::panels::{bars, palette, plots, status};
use crate::preferences::{Preferences, Store};
use crate::report::Report;
use crate::runner::Link;
use crate::session::{Edit, Request, Session};
use crate::shown::{Severity, Show, Shown};
use crate::words::Language;
use egui::{Align2, Color32, FontId, Frame, Margin, Panel, Theme, Ui};
use std::sync::Arc;
use std::time::Duration;

/// The scene that is opened first.
pub const FIRST_SCENE: &str = "ball";

/// In a window that is no wider than this [points], such as on a phone held upright, the properties are in a drawer.
const NARROW: f32 = 700.0;

/// Two pictures of the window do not count as consecutive if at least this time [s] is between them, unless time passes in the simulation.
const IDLE: f64 = 0.25;
/// If a frame takes longer than this to compute, the window marks the picture as outdated.
const STALE: Duration = Duration::from_millis(700);

/// The whole window.
#[derive(Debug)]
pub struct Studio {
    link: Link,
    canvas: Canvas,
    properties: Properties,
    gallery: Gallery,
    keeping: Keeping,
    hand: Hand,
    /// Shapes that wait for the position of the pointer.
    landing: arrivals::Waiting,
    /// The language of the interface.
    pub language: Language,
    theme: Theme,
    /// The store of language and theme.
    store: Store,
    show: Show,
    plots_open: bool,
    /// Whether the properties are open in a window that is too narrow to show them permanently.
    drawer_open: bool,
    /// Whether the panel of properties shows and changes the right side only.
    right_only: bool,
    /// A difference of the right side. The difference is applied only when the pointer is released, because both sides must then be computed again.
    difference: Option<Request>,
    help_open: bool,
    /// The number of presses of the pointer so far.
    presses: u64,
    /// The number of the message that was closed.
    closed: u64,
    /// The messages of each source so far.
    heard: message::Heard,
    /// The last message, the time since which it has been shown, and its position. The message disappears by itself.
    last_message: (String, f64, message::Placement),
    /// Pictures of the interface per second.
    rate: f64,
    /// Whether time passed in the simulation in the previous picture of the window.
    played: bool,
    /// The names of the renderer and of its device, if there is a choice.
    drawn_by: Option<[String; 2]>,
    /// The saving of the work to a file, in case the window is lost.
    #[cfg(not(target_arch = "wasm32"))]
    rescue: Option<crate::rescue::Rescue>,
    /// The state of closing the window.
    #[cfg(not(target_arch = "wasm32"))]
    closing: closing::Closing,
}

impl Studio {
    /// Makes the window of a session.
    ///
    /// # Errors
    /// The system provides no thread.
    pub fn new(session: Session, context: &egui::Context) -> std::io::Result<Studio> {
        crate::theme::apply(context);
        context.add_plugin(crate::taps::Taps::default());
        let waker = context.clone();
        let registries = session.registries().clone();
        let properties = Properties::new(opruga::catalogue_of(&registries));
        let link = Link::start(session, move || waker.request_repaint())?;
        Ok(Studio {
            link,
            canvas: Canvas::default(),
            properties,
            gallery: Gallery::new(registries),
            keeping: Keeping::default(),
            hand: Default::default(),
            landing: Vec::new(),
            language: Language::default(),
            theme: Theme::Dark,
            store: Store::default(),
            show: Show::default(),
            plots_open: false,
            drawer_open: false,
            right_only: false,
            difference: None,
            help_open: false,
            presses: 0,
            closed: 0,
            heard: Default::default(),
            last_message: (String::new(), 0.0, message::Placement::default()),
            rate: 60.0,
            played: false,
            drawn_by: None,
            #[cfg(not(target_arch = "wasm32"))]
            rescue: None,
            #[cfg(not(target_arch = "wasm32"))]
            closing: Default::default(),
        })
    }

    /// Restores the user's preferences from a store, and saves further choices there.
    pub fn prefer(&mut self, store: Store, context: &egui::Context) {
        let kept = store.read();
        (self.language, self.theme) = (kept.language, kept.theme);
        context.set_theme(self.theme);
        self.store = store;
    }

    /// Saves pictures of scenes in this folder, so that they need not be drawn again.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn keep_pictures_in(&mut self, folder: std::path::PathBuf) {
        self.gallery.cache = Some(folder);
    }

    /// Sets how and where the work is saved in case the window is lost.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn keep_at(&mut self, rescue: crate::rescue::Rescue) {
        self.rescue = Some(rescue);
    }

    /// Continues in another context, on another device; pictures that were uploaded to the previous one are uploaded again. `drawn_by` names the
    /// renderer and its device.
    #[cfg(target_arch = "wasm32")]
    pub fn move_to(&mut self, context: &egui::Context, drawn_by: [String; 2]) {
        self.drawn_by = Some(drawn_by);
        crate::theme::apply(context);
        context.set_theme(self.theme);
        context.add_plugin(crate::taps::Taps::default());
        let waker = context.clone();
        self.link.wake_by(move || waker.request_repaint());
        self.canvas.forget_textures();
        self.gallery.forget_textures();
    }

    /// Returns what the window shows now.
    pub fn shown(&self) -> Arc<Shown> {
        self.link.shown()
    }

    /// Sends a request to the session.
    pub fn ask(&self, request: Request) {
        self.link.ask(request);
    }

    /// Reports something to the user.
    pub fn report(&mut self, severity: Severity, report: Report) {
        self.keeping.report(severity, report);
    }

    /// The simulation.
    pub fn link(&self) -> &Link {
        &self.link
    }

    /// The position in the window of a point of the scene.
    pub fn on_screen(&self, point: [f64; 3]) -> Option<egui::Pos2> {
        self.canvas.on_screen(&self.link.shown(), point)
    }

    /// Whether a picture in space is still being drawn.
    pub fn is_drawing(&self) -> bool {
        self.canvas.is_drawing() || self.gallery.is_drawing() || self.keeping.is_working()
    }

    /// Whether a modal question is open.
    fn is_asking(&self) -> bool {
        #[cfg(target_arch = "wasm32")]
        return false;
        #[cfg(not(target_arch = "wasm32"))]
        self.closing.is_asking()
    }

    /// Shows the window for one frame.
    pub fn show(&mut self, ui: &mut Ui) {
        let shown = self.link.shown();
        let seconds = f64::from(ui.input(|i| i.unstable_dt)).max(1e-4);
        // If two pictures are not consecutive, nothing had to be drawn between them, so the time between them is not a delay.
        let follows = seconds < IDLE || shown.playing && self.played;
        self.played = shown.playing;
        if follows {
            self.rate += 0.05 * (1.0 / seconds - self.rate);
        }
        // Finished files are reported in this picture, because the next one may come much later.
        self.keeping.poll(&self.link);
        self.canvas.follow_names(&shown);
        let mut asks = Vec::new();
        #[cfg(not(target_arch = "wasm32"))]
        self.close(ui, &shown);
        if !self.is_asking() {
            self.shortcuts(ui, &shown, &mut asks);
        }
        self.dropped(ui, &shown, &mut asks);
        self.properties.hash = false;
        let words = self.language;
        let bar = Frame::new().fill(ui.visuals().panel_fill).inner_margin(Margin::symmetric(8, 5));
        let narrow = ui.available_width() <= NARROW;
        Panel::top("tools").frame(bar).show(ui, |ui| {
            let chosen = bars::tools(ui, &shown, words, narrow, &mut asks);
            self.choose(ui, chosen);
            let making = self.keeping.working();
            let rate = follows.then_some(self.rate);
            let busy = self.link.busy().filter(|busy| *busy > STALE).map(|busy| (busy, self.link.prepared()));
            status::status(ui, &shown, words, (rate, busy), narrow, self.drawn_by.as_ref(), making);
        });
        Panel::bottom("time").frame(bar).show(ui, |ui| bars::time(ui, &shown, words, narrow, &mut asks));
        let side = Frame::new().fill(ui.visuals().panel_fill).inner_margin(Margin::symmetric(10, 6));
        if !narrow {
            Panel::right("properties").frame(side).resizable(false).exact_size(304.0).show(ui, |ui| {
                self.properties(ui, &shown, &mut asks);
            });
        } else if self.drawer_open {
            let tall = (0.45 * ui.available_height()).max(60.0);
            Panel::bottom("drawer").frame(side).resizable(false).exact_size(tall).show(ui, |ui| {
                self.properties(ui, &shown, &mut asks);
            });
        }
        if self.plots_open {
            Panel::bottom("plots").frame(side).resizable(true).default_size(210.0).size_range(200.0..=420.0).show(
                ui,
                |ui| {
                    // In a narrow window curves keep their width and are scrolled. The space below them is for the scroll bar, so that it is always
                    // visible.
                    let available = ui.available_size() - egui::vec2(0.0, 10.0);
                    ui.spacing_mut().scroll = egui::style::ScrollStyle::thin();
                    egui::ScrollArea::horizontal().auto_shrink(false).show(ui, |ui| {
                        plots::show(ui, &shown, words, self.canvas.selected.as_deref(), available);
                    });
                },
            );
        }
        egui::CentralPanel::no_frame().show(ui, |ui| {
            let rect = ui.max_rect();
            self.canvas.wanted = self.show;
            asks.extend(self.canvas.show(ui, &shown, words));
            self.on_canvas(ui, rect, &shown, &mut asks);
        });
        self.windows(ui, &shown, &mut asks);
        // Hidden values are not computed.
        if self.properties.hash != self.show.hash {
            asks.push(Request::Show(Show { hash: self.properties.hash, ..self.show }));
        }
        #[cfg(not(target_arch = "wasm32"))]
        if let Some(rescue) = &mut self.rescue {
            rescue.poll(&self.link);
        }
        let (pressed, is_down) = ui.input(|i| {
            let begins = i.pointer.any_pressed();
            (begins, begins || i.pointer.any_down() || i.pointer.any_released())
        });
        self.presses += u64::from(pressed);
        for ask in asks {
            // All changes during one press of the pointer are undone together.
            let ask = match ask {
                Request::Set(path, value) if is_down => Request::Draw(self.presses, path, value),
                ask => ask,
            };
            if let Request::Show(show) = &ask {
                if show.quantity != self.show.quantity {
                    self.canvas.forget_colours();
                }
                self.show = *show;
            }
            self.link.ask(ask);
        }
        if self.gallery.is_drawing() || self.keeping.is_working() {
            ui.ctx().request_repaint_after(Duration::from_millis(100));
        }
        // A frame that takes long is reported while it is computed.
        if shown.playing || self.link.busy().is_some() {
            ui.ctx().request_repaint_after(STALE);
        }
    }

    /// Shows the panel of properties. If two scenes are side by side, the panel applies to both sides or to the right one only.
    fn properties(&mut self, ui: &mut Ui, shown: &Arc<Shown>, asks: &mut Vec<Request>) {
        let words = self.language;
        let Some(beside) = &shown.beside else {
            self.right_only = false;
            self.properties.show(ui, shown, words, &mut self.canvas.selected, asks);
            return;
        };
        ui.horizontal(|ui| {
            for (right, name, about) in [
                (false, words.both_sides(), words.both_sides_hint()),
                (true, words.right_only(), words.right_only_hint()),
            ] {
                ui.selectable_value(&mut self.right_only, right, name).on_hover_text(about);
            }
        });
        if !self.right_only {
            self.properties.show(ui, shown, words, &mut self.canvas.selected, asks);
            return;
        }
        let mut wanted = Vec::new();
        self.properties.show(ui, &beside.right, words, &mut self.canvas.selected, &mut wanted);
        for ask in wanted {
            match difference(&ask, &beside.right) {
                Some(difference) => self.difference = Some(Request::Differ(difference)),
                // The positions and the number of bodies are common to both sides.
                None => asks.push(ask),
            }
        }
        if !ui.input(|i| i.pointer.any_down()) {
            asks.extend(self.difference.take());
        }
    }

    fn choose(&mut self, ui: &Ui, chosen: bars::Chosen) {
        use bars::Chosen;
        match chosen {
            Chosen::Nothing => {}
            Chosen::Gallery => (self.gallery.open, self.help_open) = (!self.gallery.open, false),
            Chosen::Plots => self.plots_open = !self.plots_open,
            Chosen::Properties => self.drawer_open = !self.drawer_open,
            Chosen::Help => (self.help_open, self.gallery.open) = (!self.help_open, false),
            Chosen::Language => {
                self.language = match self.language {
                    Language::English => Language::Croatian,
                    Language::Croatian => Language::English,
                };
                self.store.write(Preferences { language: self.language, theme: self.theme });
            }
            Chosen::Theme => {
                self.theme = if ui.visuals().dark_mode { Theme::Light } else { Theme::Dark };
                ui.ctx().set_theme(self.theme);
                self.store.write(Preferences { language: self.language, theme: self.theme });
            }
            Chosen::Keep(what) => self.keeping.begin(what, &self.link, self.show),
            Chosen::Link => self.hand.copy_link(&self.link),
            Chosen::File => self.hand.choose_file(),
        }
    }

    /// Shows the toolbar, the palette and the colour settings over the scene.
    fn on_canvas(&mut self, ui: &mut Ui, rect: egui::Rect, shown: &Arc<Shown>, asks: &mut Vec<Request>) {
        let words = self.language;
        let spot = rect.min + egui::vec2(10.0, 10.0);
        let tools = egui::Area::new(egui::Id::unique("tools of the canvas"))
            .fixed_pos(spot)
            .order(egui::Order::Middle)
            .show(ui.ctx(), |ui| {
                Frame::popup(ui.style()).inner_margin(Margin::same(5)).show(ui, |ui| {
                    ui.set_max_width((rect.width() - 32.0).max(40.0));
                    ui.horizontal_wrapped(|ui| {
                        for (number, tool) in Tool::ALL.into_iter().enumerate() {
                            let (name, about) = tool.words(words);
                            let about = format!("{about}  ({})", number + 1);
                            if ui.selectable_label(self.canvas.tool == tool, name).on_hover_text(about).clicked() {
                                self.canvas.tool = tool;
                            }
                        }
                        if rect.width() > NARROW {
                            ui.separator();
                        }
                        let pointer = ui.input(|i| i.pointer.interact_pos());
                        palette::menu(ui, shown, words, self.canvas.landing(shown, pointer), asks);
                        if ui.button(words.fit()).on_hover_text(format!("{}  (F)", words.fit_hint())).clicked() {
                            self.canvas.fit();
                        }
                        // These controls are not in a nested layout, because such a layout does not wrap to the next row.
                        let focus = ui.add_enabled(self.canvas.selected.is_some(), egui::Button::new(words.focus()));
                        if focus.on_hover_text(format!("{}  (C)", words.focus_hint())).clicked() {
                            self.canvas.focus(shown);
                        }
                        bars::view_menu(ui, shown, words, self.show, asks);
                    });
                });
            });
        self.canvas.tools = Some(tools.response.rect);
        self.message(ui, rect, shown, asks);
        if ui.input(|i| !i.raw.hovered_files.is_empty()) {
            let painter = ui.ctx().layer_painter(egui::LayerId::new(egui::Order::Foreground, egui::Id::unique("drop")));
            painter.rect_filled(rect, 0.0, Color32::from_black_alpha(150));
            let font = FontId::proportional(22.0);
            painter.text(rect.center(), Align2::CENTER_CENTER, words.drop_here(), font, Color32::WHITE);
        }
    }

    fn windows(&mut self, ui: &Ui, shown: &Shown, asks: &mut Vec<Request>) {
        let words = self.language;
        if let Some(name) = self.gallery.show(ui, words, &shown.name)
            && let Some(text) = opruga::scenes::find(name)
        {
            let files = opruga::scenes::files();
            asks.push(Request::Open { name: name.into(), text: text.into(), files });
        }
        self.help(ui);
    }
}

/// Converts a request about both sides to a difference of the right side; none if the request must concern both sides.
fn difference(ask: &Request, shown: &Shown) -> Option<Difference> {
    let name = |number: usize| shown.bodies.iter().find(|body| body.number == number).map(|body| body.name.clone());
    Some(match ask {
        Request::Set(path, value) => Difference::Set(path.clone(), value.clone()),
        Request::Integrator(None, values) => Difference::Integrator(None, values.clone()),
        Request::Integrator(Some(body), values) => Difference::Integrator(Some(name(*body)?), values.clone()),
        Request::AsTheScene(body) => Difference::Integrator(Some(name(*body)?), shown.integrator.clone()?),
        Request::Models(body, models) => Difference::Models(name(*body)?, models.clone()),
        Request::Edit(Edit::Shape(body, field, value)) => Difference::Shape(body.clone(), field, value.clone()),
        _ => return None,
    })
}

#[cfg(not(target_arch = "wasm32"))]
impl eframe::App for Studio {
    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        self.show(ui);
    }
}
