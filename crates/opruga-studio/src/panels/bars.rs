//! The bars above and below the scene: tools, time, numbers.

use super::keeping::What;
use crate::session::Request;
use crate::shown::{Show, Shown};
use crate::words::Language;
use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{Align, Layout, PopupCloseBehavior, Rect, RichText, Sense, Slider, Stroke, Ui, pos2, vec2};
use opruga::draw::ColourMap;
use opruga::pictures::Quantity;

/// The choice in the upper bar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Chosen {
    /// No choice that concerns the window itself.
    Nothing,
    /// Open the gallery.
    Gallery,
    /// Show the plots.
    Plots,
    /// Show the properties, if the window is too narrow to show them permanently.
    Properties,
    /// Show the shortcuts.
    Help,
    /// Switch the language.
    Language,
    /// Switch the theme.
    Theme,
    /// Save a file.
    Keep(What),
    /// Copy an address that contains the scene. Only on a web page.
    Link,
    /// Open a file. Only on a web page, because files cannot be dropped on a phone.
    File,
}

/// The bar above the scene.
pub fn tools(ui: &mut Ui, shown: &Shown, words: Language, narrow: bool, asks: &mut Vec<Request>) -> Chosen {
    let mut chosen = Chosen::Nothing;
    ui.horizontal_wrapped(|ui| {
        if ui.button(words.scenes()).on_hover_text(format!("{}  (G)", words.scenes_hint())).clicked() {
            chosen = Chosen::Gallery;
        }
        if ui.button(words.save()).on_hover_text(format!("{}  (Ctrl S)", words.save_scene())).clicked() {
            chosen = Chosen::Keep(What::Scene);
        }
        ui.menu_button(words.keep(), |ui| {
            for what in [What::Scene, What::Picture, What::Film, What::Animation, What::Table] {
                if ui.button(file_name(words, what)).clicked() {
                    chosen = Chosen::Keep(what);
                    ui.close();
                }
            }
            if cfg!(target_arch = "wasm32") {
                ui.separator();
                for (other, name) in [(Chosen::Link, words.copy_link()), (Chosen::File, words.open_file())] {
                    if ui.button(name).clicked() {
                        chosen = other;
                        ui.close();
                    }
                }
            }
        });
        if !narrow {
            ui.separator();
        }
        for (name, key, step, ask) in
            [(words.undo(), "Ctrl Z", &shown.undo, Request::Undo), (words.redo(), "Ctrl Y", &shown.redo, Request::Redo)]
        {
            let about = format!("{} ({key})", step.as_ref().map_or(String::new(), |step| words.done(step)));
            if ui.add_enabled(step.is_some(), egui::Button::new(name)).on_hover_text(about).clicked() {
                asks.push(ask);
            }
        }
        let compared = ui.add(egui::Button::new(words.compare()).selected(shown.beside.is_some()));
        if compared.on_hover_text(format!("{}  (B)", words.compare_hint())).clicked() {
            asks.push(Request::Compare(shown.beside.is_none()));
        }
        if narrow {
            if ui.button(words.properties()).clicked() {
                chosen = Chosen::Properties;
            }
            windows(ui, words, &mut chosen, false);
            ui.label(RichText::new(&shown.name).strong());
            return;
        }
        ui.separator();
        ui.label(RichText::new(&shown.name).strong());
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| windows(ui, words, &mut chosen, true));
    });
    chosen
}

/// The name of a type of file.
pub fn file_name(words: Language, what: What) -> &'static str {
    match what {
        What::Scene => words.save_scene(),
        What::Picture => words.screenshot(),
        What::Film => words.film(),
        What::Animation => words.animation(),
        What::Table => words.table(),
    }
}

/// Shows the buttons of other parts of the window, placed from left to right or from right to left.
fn windows(ui: &mut Ui, words: Language, chosen: &mut Chosen, from_right: bool) {
    let theme = if ui.visuals().dark_mode { words.light() } else { words.dark() };
    let mut buttons = [
        (Chosen::Plots, words.plots(), "P"),
        (Chosen::Theme, theme, ""),
        (Chosen::Language, words.language(), ""),
        (Chosen::Help, "?", words.help()),
    ];
    if from_right {
        buttons.reverse();
    }
    for (what, name, about) in buttons {
        let mut response = ui.button(name);
        if !about.is_empty() {
            response = response.on_hover_text(about);
        }
        if response.clicked() {
            *chosen = what;
        }
    }
}

/// Shows the bar below the scene: play, step, and the time slider.
pub fn time(ui: &mut Ui, shown: &Shown, words: Language, narrow: bool, asks: &mut Vec<Request>) {
    ui.horizontal(|ui| {
        flow(ui, shown, words, asks);
        if !narrow {
            speed(ui, shown, words, asks);
            ui.separator();
            course(ui, shown, words, asks);
        }
    });
    if narrow {
        ui.horizontal(|ui| speed(ui, shown, words, asks));
        ui.horizontal(|ui| course(ui, shown, words, asks));
    }
}

/// Shows the controls that start and stop time.
fn flow(ui: &mut Ui, shown: &Shown, words: Language, asks: &mut Vec<Request>) {
    if ui.button(words.reset()).on_hover_text(format!("{}  (Home)", words.reset_hint())).clicked() {
        asks.push(Request::Reset);
    }
    if ui.button(words.replay()).on_hover_text(words.replay_hint()).clicked() {
        asks.push(Request::Replay);
    }
    let name = if shown.playing { words.pause() } else { words.play() };
    let button = egui::Button::new(RichText::new(name).strong()).min_size(egui::vec2(72.0, 0.0));
    if ui.add(button).clicked() {
        asks.push(Request::Play(!shown.playing));
    }
    if ui.button(words.step()).on_hover_text(format!("{}  (→)", words.step_hint())).clicked() {
        asks.push(Request::Step);
    }
}

/// Shows the choice of the speed of simulated time.
fn speed(ui: &mut Ui, shown: &Shown, words: Language, asks: &mut Vec<Request>) {
    let speed = ui.label(words.speed());
    let mut wanted = shown.speed;
    ui.spacing_mut().slider_width = 84.0;
    let slider = Slider::new(&mut wanted, 0.05..=4.0).logarithmic(true).max_decimals(2).suffix("×");
    if ui.add(slider).labelled_by(speed.id).on_hover_text(words.speed_hint()).changed() {
        asks.push(Request::Speed(wanted));
    }
}

/// Shows the time slider.
fn course(ui: &mut Ui, shown: &Shown, words: Language, asks: &mut Vec<Request>) {
    let time = ui.label(words.time());
    let mut frame = shown.frames;
    let shows_end = shown.recorded_until.is_some() && ui.available_width() > 420.0;
    let available = ui.available_width() - if shows_end { 236.0 } else { 96.0 };
    ui.spacing_mut().slider_width = available.max(40.0);
    let slider = Slider::new(&mut frame, 0..=shown.latest.max(1)).show_value(false);
    let response = ui.add(slider).labelled_by(time.id);
    if let Some(until) = shown.recorded_until {
        end_of_recording(ui, shown, words, until, response.rect);
    }
    if response.on_hover_text(words.rewind_hint()).changed() {
        asks.push(Request::Play(false));
        asks.push(Request::Seek(frame));
    }
    ui.label(RichText::new(format!("{:.2} s", shown.time)).monospace());
    if let Some(until) = shown.recorded_until.filter(|_| shows_end) {
        let end = format!("{} {:.2} s", words.recording_until(), shown.frame * until as f64);
        ui.label(RichText::new(end).size(11.5).weak()).on_hover_text(words.recording_hint());
    }
}

/// Marks where a recording ends: a line along the time slider, a mark at the end of the line, and the time in seconds.
fn end_of_recording(ui: &Ui, shown: &Shown, words: Language, until: u64, slider: Rect) {
    // The centre of the handle does not reach the ends of the slider.
    let inner = slider.shrink2(vec2(0.5 * slider.height().min(slider.width()) * 0.8, 0.0));
    let share = until as f32 / shown.latest.max(1) as f32;
    let (x, y) = (inner.left() + share.min(1.0) * inner.width(), slider.center().y);
    let ink = ui.visuals().warn_fg_color;
    ui.painter().line_segment([pos2(inner.left(), y + 7.0), pos2(x, y + 7.0)], Stroke::new(2.0, ink));
    ui.painter().line_segment([pos2(x, y - 8.0), pos2(x, y + 8.0)], Stroke::new(2.0, ink));
    let end = format!("{} {:.2} s", words.recording_until(), shown.frame * until as f64);
    let mark = Rect::from_center_size(pos2(x, y), vec2(10.0, 18.0));
    let response = ui.interact(mark, ui.scope_id().with("end of the recording"), Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &end));
    response.on_hover_text(format!("{end}\n{}", words.recording_hint()));
}

/// Shows the menu for the colours and for the other parts of the picture.
pub fn view_menu(ui: &mut Ui, shown: &Shown, words: Language, now: Show, asks: &mut Vec<Request>) {
    let mut show = now;
    let drawn = shown.has_drawings && now.own_colours;
    let name = if drawn { words.own_colours() } else { quantity_name(words, now.quantity) };
    ui.menu_button(format!("{}: {name}", words.colour()), |ui| {
        // A drawing has its own colours until the user chooses a quantity for the colours.
        if shown.has_drawings {
            let choice = ui.radio(drawn, words.own_colours()).on_hover_text(words.own_colours_hint());
            if choice.clicked() {
                (show.own_colours, show.quantity) = (true, Quantity::Strain);
                ui.close();
            }
        }
        for quantity in Quantity::ALL {
            let mut choice = ui.radio(!drawn && show.quantity == quantity, quantity_name(words, quantity));
            let about = match quantity {
                Quantity::ElasticForce => words.elastic_force_hint(),
                Quantity::VonMises => words.von_mises_hint(),
                Quantity::Pressure => words.pressure_hint(),
                _ => "",
            };
            if !about.is_empty() {
                choice = choice.on_hover_text(about);
            }
            if choice.clicked() {
                (show.own_colours, show.quantity) = (show.own_colours && !shown.has_drawings, quantity);
                ui.close();
            }
        }
        ui.separator();
        ui.label(RichText::new(words.colour_map()).weak());
        for map in ColourMap::ALL {
            let name = match map {
                ColourMap::Viridis => words.viridis(),
                ColourMap::Cividis => words.cividis(),
                ColourMap::Embers => words.embers(),
                ColourMap::Grey => words.grey(),
                ColourMap::Diverging => words.diverging(),
            };
            if ui.radio_value(&mut show.map, map, name).clicked() {
                ui.close();
            }
        }
    });
    // The menu stays open after a click, because several items can be chosen at once.
    let open = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    MenuButton::new(words.overlays()).config(open).ui(ui, |ui| {
        ui.checkbox(&mut show.springs, words.springs());
        ui.checkbox(&mut show.vertices, words.vertices());
        ui.checkbox(&mut show.arrows, words.arrows());
        ui.checkbox(&mut show.contacts, words.contacts()).on_hover_text(words.contacts_hint());
        ui.checkbox(&mut show.normals, words.normals());
        ui.checkbox(&mut show.velocities, words.velocities());
    });
    if show != now {
        asks.push(Request::Show(show));
    }
}

/// The name of a quantity.
fn quantity_name(words: Language, quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Strain => words.strain(),
        Quantity::ElasticForce => words.elastic_force(),
        Quantity::Pressure => words.pressure(),
        Quantity::Speed => words.speed_of_nodes(),
        Quantity::VonMises => words.von_mises_stress(),
        Quantity::VolumeRatio => words.volume_ratio(),
        Quantity::Plain => words.plain(),
    }
}
