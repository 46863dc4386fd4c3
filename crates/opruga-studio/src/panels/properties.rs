//! The side panel with the selected body, the world and the obstacles. The panel is made from the specifications of models, integrators, shapes and
//! obstacles, so that new ones appear without further work.

use super::parameter::{self, Change, FieldContext, Hand};
use crate::session::{Edit, Placed, Request};
use crate::shown::{BodyShown, Shown};
use crate::words::{Language, Part};
use egui::{Button, CollapsingHeader, Color32, ComboBox, Pos2, RichText, ScrollArea, Sense, Slider, Stroke, Ui, Vec2};
use opruga::core::spec::{Allowed, Spec, Value, Values};
use opruga::io::Catalogue;
use opruga::world::schema::MOST_SUBSTEPS;

/// The largest gravity of the arrow control [m/s²].
const MOST_GRAVITY: f64 = 20.0;

/// The panel with the state of its controls.
#[derive(Debug)]
pub struct Properties {
    /// The specifications that the panel offers.
    catalogue: Catalogue,
    hand: Hand,
    /// The new value of a field of a shape, which is set when the pointer is released.
    pending: Option<(String, &'static str, Value)>,
    /// Whether the hash of the state is displayed.
    pub hash: bool,
    /// The number of substeps while it is being dragged.
    substeps: Option<u32>,
}

/// The specifications that exist in the dimension of the scene.
struct Kinds {
    models: Vec<&'static Spec>,
    integrators: Vec<&'static Spec>,
    dimension: usize,
}

impl Kinds {
    fn of(catalogue: &Catalogue, dimension: usize) -> Kinds {
        let there =
            |list: &[&'static Spec]| list.iter().copied().filter(|s| s.dimensions.contains(&dimension)).collect();
        Kinds { models: there(&catalogue.models), integrators: there(&catalogue.integrators), dimension }
    }
}

impl Properties {
    /// A panel that offers the contents of a catalogue.
    pub fn new(catalogue: Catalogue) -> Properties {
        Properties { catalogue, hand: Hand::default(), pending: None, hash: false, substeps: None }
    }

    /// Shows the panel.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        shown: &Shown,
        words: Language,
        selected: &mut Option<String>,
        asks: &mut Vec<Request>,
    ) {
        if shown.dimension == 0 {
            return;
        }
        let kinds = Kinds::of(&self.catalogue, usize::from(shown.dimension));
        ui.spacing_mut().slider_width = 168.0;
        ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
            let body = selected.as_ref().and_then(|name| shown.bodies.iter().find(|body| body.name == *name));
            let heading = |text: &str| RichText::new(text).heading();
            CollapsingHeader::new(heading(words.body())).id_salt("body").default_open(true).show(ui, |ui| match body {
                _ if shown.bodies.len() > 64 => {
                    ui.label(words.crowd());
                }
                Some(body) => self.body(ui, body, &kinds, words, asks),
                None => {
                    ui.label(words.nothing_selected());
                }
            });
            CollapsingHeader::new(heading(words.world())).id_salt("world").default_open(true).show(ui, |ui| {
                self.world(ui, shown, &kinds, words, asks);
            });
            CollapsingHeader::new(heading(words.contact())).id_salt("contact").default_open(false).show(ui, |ui| {
                self.contact(ui, shown, kinds.dimension, words, asks);
            });
            for (number, obstacle) in shown.obstacles.iter().enumerate().take(16) {
                let kind = obstacle.values.kind();
                let title = format!("{}: {}", words.obstacle(), words.kind(Part::Obstacle, kind));
                let header = CollapsingHeader::new(heading(&title)).id_salt(("obstacle", number));
                header.default_open(false).show(ui, |ui| {
                    for field in obstacle.values.spec().fields {
                        let path = &format!("collider.{number}.{}", field.name);
                        let dimension = kinds.dimension;
                        let context = FieldContext {
                            path,
                            part: Part::Obstacle,
                            kind,
                            field,
                            dimension,
                            words,
                            values: Some(&obstacle.values),
                            whole: Some(obstacle.values.spec()),
                        };
                        let unset = |_| Some(Request::Unset(path.clone()));
                        self.set(ui, context, obstacle.values.get(field.name), asks, unset);
                    }
                });
            }
        });
    }

    /// Shows a parameter. `whole` makes the request if the values of the parameter's whole kind change.
    fn set(
        &mut self,
        ui: &mut Ui,
        context: FieldContext<'_>,
        now: Option<&Value>,
        asks: &mut Vec<Request>,
        whole: impl FnOnce(Values) -> Option<Request>,
    ) {
        asks.extend(match parameter::show(ui, &mut self.hand, context, now) {
            Some(Change::Value(value)) => Some(Request::Set(context.path.into(), value)),
            Some(Change::Whole(values)) => whole(values),
            None => None,
        });
    }

    fn body(&mut self, ui: &mut Ui, body: &BodyShown, kinds: &Kinds, words: Language, asks: &mut Vec<Request>) {
        ui.horizontal(|ui| {
            ui.label(RichText::new(&body.title).strong().size(14.0));
            ui.label(RichText::new(format!("{} {}", body.nodes, words.nodes())).weak());
        });
        // Readings of single chambers are shown in the table and by the colours.
        let readings: Vec<_> = body.readings.iter().filter(|(name, _)| !name.contains('.')).take(4).collect();
        let half = 0.5 * ui.available_width() - 10.0;
        for two in readings.chunks(2) {
            ui.horizontal(|ui| {
                ui.spacing_mut().interact_size.y = 14.0;
                for (name, x) in two {
                    let unit = match &**name {
                        "pressure" => " Pa",
                        // As in the plots, a body in the plane encloses an area.
                        "volume" if kinds.dimension == 3 => " m³",
                        "volume" => " m²",
                        "nRT" => " J",
                        _ => "",
                    };
                    // The height is fixed, so that the items below stay where they are, however many numbers there are.
                    let text = format!("{} {}{unit}", words.reading(name), opruga::draw::format_value(*x));
                    let layout = egui::Layout::left_to_right(egui::Align::Center);
                    ui.allocate_ui_with_layout(Vec2::new(half, 14.0), layout, |ui| {
                        ui.set_min_width(half);
                        ui.add(egui::Label::new(RichText::new(text).weak().size(11.5)).truncate());
                    });
                }
            });
        }
        self.integrator(ui, words, body.integrator.as_ref(), Some(body), kinds, asks);
        for (number, model) in body.models.iter().enumerate() {
            let spec = model.spec();
            let title = RichText::new(words.kind(Part::Model, spec.kind)).strong();
            let header =
                CollapsingHeader::new(title).id_salt(("model", &body.title, spec.kind)).default_open(number < 2);
            let response = header.show(ui, |ui| {
                for field in spec.fields {
                    let path = &format!("body.{}.models.{number}.{}", body.name, field.name);
                    let dimension = kinds.dimension;
                    let context = FieldContext {
                        path,
                        part: Part::Model,
                        kind: spec.kind,
                        field,
                        dimension,
                        words,
                        values: Some(model),
                        whole: Some(spec),
                    };
                    self.set(ui, context, model.get(field.name), asks, |values| {
                        let mut models = body.models.clone();
                        models[number] = values;
                        Some(Request::Models(body.number, models))
                    });
                }
                self.another_model(ui, words, body, number, kinds, asks);
            });
            response.header_response.on_hover_text(words.summary(Part::Model, spec));
        }
        let add = ComboBox::from_id_salt(("add", &body.title)).selected_text(words.add_model()).show_ui(ui, |ui| {
            for spec in &kinds.models {
                let button = ui.button(words.kind(Part::Model, spec.kind));
                if button.on_hover_text(words.summary(Part::Model, spec)).clicked() {
                    let mut models = body.models.clone();
                    models.push(parameter::begin(spec, kinds.dimension));
                    asks.push(Request::Models(body.number, models));
                    ui.close();
                }
            }
        });
        name(&add.response, words.add_model());
        self.shape(ui, body, kinds.dimension, words, asks);
        let transform = |turned: f64, scaled: f64| {
            Request::Edit(Edit::Transform(body.name.clone(), Placed { moved: [0.0; 3], turned, scaled }))
        };
        ui.horizontal_wrapped(|ui| {
            let fifteen = 15f64.to_radians();
            for (text, key, request) in [
                (format!("{} +15°", words.turn()), "[", transform(fifteen, 1.0)),
                ("−15°".into(), "]", transform(-fifteen, 1.0)),
                (words.scale().into(), "+", transform(0.0, 1.1)),
                (words.smaller().into(), "−", transform(0.0, 1.0 / 1.1)),
                (words.duplicate().into(), "Ctrl D", Request::Edit(Edit::Duplicate(body.name.clone()))),
                (words.delete().into(), "Del", Request::Edit(Edit::Delete(body.name.clone()))),
            ] {
                if ui.add(Button::new(RichText::new(text).size(12.0))).on_hover_text(key).clicked() {
                    asks.push(request);
                }
            }
        });
    }

    /// Lets the user choose another model instead of this one, or none.
    fn another_model(
        &mut self,
        ui: &mut Ui,
        words: Language,
        body: &BodyShown,
        number: usize,
        kinds: &Kinds,
        asks: &mut Vec<Request>,
    ) {
        ui.horizontal(|ui| {
            let now = body.models[number].kind();
            let name_now = words.kind(Part::Model, now);
            let menu = ComboBox::from_id_salt(("kind", number)).selected_text(&name_now).show_ui(ui, |ui| {
                for spec in &kinds.models {
                    let here = spec.kind == now;
                    let choice = ui.selectable_label(here, words.kind(Part::Model, spec.kind));
                    let choice = choice.on_hover_text(words.summary(Part::Model, spec));
                    if choice.clicked() && !here {
                        let mut models = body.models.clone();
                        models[number] = parameter::begin(spec, kinds.dimension);
                        asks.push(Request::Models(body.number, models));
                    }
                }
            });
            name(&menu.response, &format!("{} {name_now}", words.models()));
            if ui.small_button("×").on_hover_text(words.remove_model()).clicked() {
                let mut models = body.models.clone();
                models.remove(number);
                asks.push(Request::Models(body.number, models));
            }
        });
    }

    /// Shows the integrator of the scene, or of a body.
    fn integrator(
        &mut self,
        ui: &mut Ui,
        words: Language,
        own: Option<&Values>,
        body: Option<&BodyShown>,
        kinds: &Kinds,
        asks: &mut Vec<Request>,
    ) {
        let now = own.map_or("", |values| values.kind());
        let name = if now.is_empty() { words.of_the_scene().into() } else { words.kind(Part::Integrator, now) };
        ui.horizontal(|ui| {
            let label = ui.label(words.integrator());
            let salt = ("integrator", body.map(|body| body.title.as_str()));
            let menu = ComboBox::from_id_salt(salt).selected_text(name).show_ui(ui, |ui| {
                if let Some(body) = body
                    && ui.selectable_label(now.is_empty(), words.of_the_scene()).clicked()
                    && !now.is_empty()
                {
                    asks.push(Request::AsTheScene(body.number));
                }
                for spec in &kinds.integrators {
                    let here = spec.kind == now;
                    let choice = ui.selectable_label(here, words.kind(Part::Integrator, spec.kind));
                    let choice = choice.on_hover_text(words.summary(Part::Integrator, spec));
                    if choice.clicked() && !here {
                        asks.push(Request::Integrator(
                            body.map(|body| body.number),
                            parameter::begin(spec, kinds.dimension),
                        ));
                    }
                }
            });
            menu.response.labelled_by(label.id);
        });
        let Some(values) = own else { return };
        let spec = values.spec();
        for field in spec.fields {
            let path = &match body {
                Some(body) => format!("body.{}.integrator.{}", body.name, field.name),
                None => format!("integrator.{}", field.name),
            };
            let dimension = kinds.dimension;
            let context = FieldContext {
                path,
                part: Part::Integrator,
                kind: spec.kind,
                field,
                dimension,
                words,
                values: Some(values),
                whole: Some(spec),
            };
            let whole = |values| Some(Request::Integrator(body.map(|body| body.number), values));
            self.set(ui, context, values.get(field.name), asks, whole);
        }
    }

    /// Shows the fields of a shape that determine its number of nodes.
    fn shape(&mut self, ui: &mut Ui, body: &BodyShown, dimension: usize, words: Language, asks: &mut Vec<Request>) {
        let Some(shape) = &body.shape else { return };
        let Some(spec) = opruga::shapes::all().into_iter().find(|spec| spec.kind == shape.kind()) else { return };
        let title = RichText::new(format!("{}: {}", words.shape(), words.kind(Part::Shape, spec.kind))).strong();
        CollapsingHeader::new(title).id_salt(("shape", &body.title)).default_open(false).show(ui, |ui| {
            for field in spec.fields.iter().filter(|f| f.name != "center" && f.name != "corner") {
                // Every value makes a new body, but for the user it is the same body, so the path contains its title.
                let path = &format!("shape.{}.{}", body.title, field.name);
                let now = shape.get(field.name);
                let context = FieldContext {
                    path,
                    part: Part::Shape,
                    kind: spec.kind,
                    field,
                    dimension,
                    words,
                    values: Some(shape),
                    whole: Some(spec),
                };
                let slider = matches!(field.range, Allowed::Number { .. } | Allowed::Integer { .. });
                let value = match parameter::show(ui, &mut self.hand, context, now) {
                    Some(Change::Value(value)) => value,
                    Some(Change::Whole(_)) => {
                        asks.push(Request::Edit(Edit::ShapeWithout(body.name.clone(), field.name)));
                        continue;
                    }
                    None => continue,
                };
                if slider && ui.input(|i| i.pointer.any_down()) {
                    // Making a new mesh for every movement of the pointer would take too long, so only the last value counts.
                    self.pending = Some((body.name.clone(), field.name, value));
                } else {
                    asks.push(Request::Edit(Edit::Shape(body.name.clone(), field.name, value)));
                }
            }
        });
        if !ui.input(|i| i.pointer.any_down())
            && let Some((name, field, value)) = self.pending.take()
        {
            asks.push(Request::Edit(Edit::Shape(name, field, value)));
        }
    }

    /// Shows whether there is contact between bodies, and its parameters.
    fn contact(&mut self, ui: &mut Ui, shown: &Shown, dimension: usize, words: Language, asks: &mut Vec<Request>) {
        let mut touch = shown.contact.is_some();
        if ui.checkbox(&mut touch, words.bodies_touch()).on_hover_text(words.bodies_touch_hint()).changed() {
            asks.push(Request::Edit(Edit::Contact(touch)));
        }
        let Some(values) = &shown.contact else { return };
        let spec = values.spec();
        // A choice between words is not shown if there is only one word.
        for field in spec.fields.iter().filter(|field| !matches!(field.range, Allowed::Choice([_]))) {
            let path = &format!("contact.{}", field.name);
            let row = FieldContext {
                path,
                part: Part::Contact,
                kind: spec.kind,
                field,
                dimension,
                words,
                values: Some(values),
                whole: Some(spec),
            };
            let unset = |_| Some(Request::Unset(path.clone()));
            self.set(ui, row, values.get(field.name), asks, unset);
        }
    }

    fn world(&mut self, ui: &mut Ui, shown: &Shown, kinds: &Kinds, words: Language, asks: &mut Vec<Request>) {
        let dimension = kinds.dimension;
        ui.horizontal(|ui| {
            if let Some(gravity) = gravity_arrow(ui, shown.gravity, shown.picture.y_down, words) {
                asks.push(Request::Set("world.gravity".into(), Value::Numbers(gravity[..dimension].to_vec())));
            }
            ui.vertical(|ui| {
                let label = ui.label(format!("{} [m/s²]", words.gravity()));
                let mut gravity = shown.gravity;
                for (d, axis) in ["x", "y", "z"].iter().enumerate().take(dimension) {
                    let value =
                        egui::DragValue::new(&mut gravity[d]).speed(0.05).max_decimals(2).prefix(format!("{axis} "));
                    ui.add(value).labelled_by(label.id);
                }
                if gravity != shown.gravity {
                    asks.push(Request::Set("world.gravity".into(), Value::Numbers(gravity[..dimension].to_vec())));
                }
            });
        });
        let drag = ui.label(format!("{} [1/s]", words.drag()));
        let mut rate = shown.drag;
        let slider = Slider::new(&mut rate, 0.0..=20.0).logarithmic(true).smallest_positive(0.01).max_decimals(3);
        if ui.add(slider).labelled_by(drag.id).changed() {
            asks.push(Request::Set("world.drag".into(), Value::Number(rate)));
        }
        let own = shown.integrator.as_ref();
        self.integrator(ui, words, own, None, kinds, asks);
        let label = ui.label(words.substeps()).on_hover_text(words.substeps_hint());
        let mut substeps = self.substeps.unwrap_or(shown.substeps);
        // The range includes the present value, because a slider would otherwise change the value to the end of its range.
        let most = (4 * shown.substeps.max(16)).next_power_of_two().min(MOST_SUBSTEPS);
        let response = ui.add(Slider::new(&mut substeps, 1..=most).logarithmic(true)).labelled_by(label.id);
        // Only the value at the release of the pointer counts.
        self.substeps = response.dragged().then_some(substeps);
        if (response.changed() || response.drag_stopped()) && !response.dragged() && substeps != shown.substeps {
            asks.push(Request::Set("time.substeps".into(), Value::Integer(i64::from(substeps))));
        }
        // The row always exists, so that the items below stay where they are.
        let limit = (shown.stable_step.is_finite() && shown.stable_step > 0.0).then_some(shown.stable_step);
        let least_text = limit.map_or("–".into(), |limit| (shown.frame / limit).ceil().max(1.0).to_string());
        ui.label(RichText::new(format!("{} {least_text}", words.stable())).weak().size(11.5));
        if let Some(limit) = limit {
            let least = (shown.frame / limit).ceil().max(1.0);
            // The position of the limit on the slider, which has a logarithmic scale.
            let rail = response.rect.left() + 6.0 + 156.0 * (least.ln() / f64::from(most).ln()).clamp(0.0, 1.0) as f32;
            let y = response.rect.center().y;
            let mark = [Pos2::new(rail, y - 8.0), Pos2::new(rail, y + 8.0)];
            ui.painter().line_segment(mark, Stroke::new(2.0, Color32::from_rgb(230, 140, 20)));
        }
        let header = CollapsingHeader::new(words.state_hash()).id_salt("hash").show(ui, |ui| {
            self.hash = true;
            let Some(hash) = shown.hash else { return };
            let hash = format!("{hash:016x}");
            ui.horizontal(|ui| {
                ui.label(RichText::new(&hash).monospace());
                if ui.small_button(words.copy()).clicked() {
                    ui.ctx().copy_text(hash);
                }
            });
        });
        header.header_response.on_hover_text(words.state_hash_hint());
    }
}

/// Gives a control without a label a name for screen readers.
fn name(response: &egui::Response, text: &str) {
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, text));
}

/// Shows gravity as an arrow with a draggable tip. Returns the new gravity if the user has changed it.
fn gravity_arrow(ui: &mut Ui, now: [f64; 3], y_down: bool, words: Language) -> Option<[f64; 3]> {
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(84.0), Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Canvas, true, words.gravity()));
    let sign = if y_down { 1.0 } else { -1.0 };
    let radius = 0.46 * rect.width();
    let scale = f64::from(radius) / MOST_GRAVITY;
    let visuals = ui.visuals();
    let painter = ui.painter();
    painter.circle(rect.center(), radius, visuals.extreme_bg_color, Stroke::new(1.0, visuals.weak_text_color()));
    let end = rect.center() + Vec2::new((now[0] * scale) as f32, (sign * now[1] * scale) as f32);
    let ink = Color32::from_rgb(230, 140, 20);
    painter.line_segment([rect.center(), end], Stroke::new(3.0, ink));
    painter.circle_filled(end, 5.5, ink);
    let response = response.on_hover_text(words.gravity_hint());
    let at = response.interact_pointer_pos().filter(|_| response.dragged() || response.clicked())?;
    let from = (at - rect.center()) / radius;
    let from = if from.length() > 1.0 { from.normalized() } else { from };
    // The tip of the arrow snaps to zero and to the gravity of the earth.
    let mut gravity = [f64::from(from.x) * MOST_GRAVITY, sign * f64::from(from.y) * MOST_GRAVITY];
    for x in &mut gravity {
        *x = if x.abs() < 0.8 { 0.0 } else { (*x * 10.0).round() / 10.0 };
    }
    if gravity[0] == 0.0 && (gravity[1].abs() - 9.81).abs() < 0.8 {
        gravity[1] = 9.81 * gravity[1].signum();
    }
    let new = [gravity[0], gravity[1], now[2]];
    (new != now).then_some(new)
}
