//! One parameter: its slider, unit and sentence, made from what its model says of it.

use crate::words::{Language, Part};
use egui::{ComboBox, DragValue, Response, RichText, Slider, SliderClamping, Ui};
use opruga::core::spec::{Allowed, Bound, Default as Unset, Field, Value, Values};
use std::collections::BTreeMap;

/// A field of a kind in the panel of a scene of so many dimensions, in a language.
#[derive(Clone, Copy, Debug)]
pub struct Place<'a> {
    /// Where the interface finds it.
    pub path: &'a str,
    /// What its kind is a kind of.
    pub part: Part,
    /// Its kind.
    pub kind: &'a str,
    /// What it says of itself.
    pub field: &'a Field,
    /// The dimension of the scene.
    pub dimension: usize,
    /// The language of the interface.
    pub words: Language,
    /// The values of all fields of the kind: some have no say among the others.
    pub values: Option<&'a Values>,
}

/// What is being set: while a slider is held it shows what the hand wants and not what came back.
#[derive(Debug, Default)]
pub struct Hand {
    held: Option<(String, Value)>,
    /// The upper ends of open sliders, so that they do not run away from the hand.
    ends: BTreeMap<String, f64>,
}

/// A starting value for a field that the scene leaves silent.
pub fn starting(kind: &str, field: &Field) -> Option<Value> {
    let known = match (kind, field.name) {
        ("mass_spring", "stiffness") => 400.0,
        ("mass_spring", "modulus") => 300.0,
        ("bending", "stiffness") => 0.02,
        ("pressure", "nRT") => 20.0,
        ("pressure", "pressure") => 50.0,
        _ => match field.range {
            Allowed::Number { least, greatest } => {
                let end = |bound: Bound| match bound {
                    Bound::None => None,
                    Bound::Closed(x) | Bound::Open(x) => Some(x),
                };
                match (end(least), end(greatest)) {
                    (Some(a), Some(b)) => 0.5 * (a + b),
                    (Some(a), None) => a + usual(field.unit),
                    (None, Some(b)) => b - usual(field.unit),
                    (None, None) => 0.0,
                }
            }
            Allowed::Integer { least, .. } => return Some(Value::Integer(least.max(1))),
            Allowed::Boolean => return Some(Value::Boolean(true)),
            Allowed::Choice(words) => return words.first().map(|word| Value::Text((*word).into())),
            _ => return None,
        },
    };
    Some(Value::Number(known))
}

/// A usual size of a quantity.
fn usual(unit: &str) -> f64 {
    match unit {
        "Pa" => 1e4,
        "N/m" => 100.0,
        "kg/m³" => 1000.0,
        "m" => 0.1,
        _ => 1.0,
    }
}

/// Shows a parameter; its new value if it was changed. Values that no slider can hold are shown and not changed.
pub fn show(ui: &mut Ui, hand: &mut Hand, place: Place<'_>, now: Option<&Value>) -> Option<Value> {
    let Place { path, part, kind, field, words, .. } = place;
    let held = hand.held.as_ref().filter(|(held, _)| held == path).map(|(_, value)| value.clone());
    let now = held.or_else(|| now.cloned());
    let unit = if field.unit.is_empty() { String::new() } else { format!(" [{}]", field.unit) };
    let name = words.field(part, kind, field.name);
    let label = RichText::new(format!("{name}{unit}")).size(12.0);
    let mut about = words.sentence(part, kind, field, place.dimension);
    let silent = place.values.and_then(|values| field.without_effect(values, place.dimension));
    if let Some(condition) = silent {
        about = format!("{about}\n{}", words.effect_only(part, kind, condition));
    }
    let shown = |ui: &mut Ui| match (&field.range, now) {
        (_, None) => ui.horizontal(|ui| absent(ui, place, &name, &unit, &about)).inner,
        (_, Some(Value::Number(x))) => number(ui, hand, path, field, label, &about, x, false).map(Value::Number),
        (_, Some(Value::Integer(x))) => {
            number(ui, hand, path, field, label, &about, x as f64, true).map(|x| Value::Integer(x.round() as i64))
        }
        (range, Some(now)) => {
            ui.horizontal(|ui| {
                let name = tell(ui.label(label), &about).id;
                other(ui, words, name, range, &now)
            })
            .inner
        }
    };
    // What would do nothing is seen, and why, but cannot be pressed.
    ui.push_id(path, |ui| ui.add_enabled_ui(silent.is_none(), shown).inner).inner
}

/// Says something of a control, whether it can be pressed or not.
fn tell(response: Response, about: &str) -> Response {
    response.on_hover_text(about).on_disabled_hover_text(about)
}

/// A field about which the scene is silent: a button that gives it a value, or its name where a scene alone can.
fn absent(ui: &mut Ui, place: Place<'_>, name: &str, unit: &str, about: &str) -> Option<Value> {
    let start = starting(place.kind, place.field);
    if start.is_none() {
        let about = format!("{about}\n{}", place.words.in_the_scene());
        tell(ui.label(RichText::new(format!("{name}{unit}")).size(12.0).weak()), &about);
        return None;
    }
    let button = egui::Button::new(RichText::new(format!("+ {name}{unit}")).size(12.0)).small();
    if tell(ui.add(button), about).clicked() { start } else { None }
}

/// A slider below its name.
#[allow(clippy::too_many_arguments, reason = "all of them describe one slider")]
fn number(
    ui: &mut Ui,
    hand: &mut Hand,
    path: &str,
    field: &Field,
    label: RichText,
    about: &str,
    now: f64,
    whole: bool,
) -> Option<f64> {
    let name = tell(ui.label(label), about).id;
    let (low, high, open) = ends(field, now, whole);
    // An open end stays where it was when the slider was first seen, unless the value has gone beyond it.
    let high = if open {
        let end = hand.ends.entry(path.to_string()).or_insert(high);
        if now > *end {
            *end = high;
        }
        *end
    } else {
        high
    };
    let mut x = now;
    let mut slider = Slider::new(&mut x, low..=high).clamping(SliderClamping::Never).max_decimals(6);
    // Of a number that is typed the last digit counts, not every one on the way.
    slider = slider.update_while_editing(false);
    if open || whole && high > 1000.0 {
        slider = slider.logarithmic(true).smallest_positive(if whole { 1.0 } else { high * 1e-6 });
    }
    if whole {
        slider = slider.integer();
    } else {
        slider = slider.custom_formatter(|x, _| opruga::draw::format_value(x));
    }
    let response = ui.add(slider).labelled_by(name);
    let changed = response.changed() && x != now && x.is_finite();
    if response.dragged() || response.has_focus() && changed {
        let value = if whole { Value::Integer(x.round() as i64) } else { Value::Number(x) };
        hand.held = Some((path.to_string(), value));
    } else if hand.held.as_ref().is_some_and(|(held, _)| held == path) {
        hand.held = None;
    }
    changed.then_some(x)
}

/// The end of sliders of whole numbers that know none before it.
const MOST_WHOLE: i64 = 100_000;

/// Bounds beyond this are no ends of sliders.
const FAR: f64 = 1e5;

/// The ends of a slider, and whether the upper one is open.
fn ends(field: &Field, now: f64, whole: bool) -> (f64, f64, bool) {
    let default = match field.default {
        Unset::Number(x) => x,
        Unset::Integer(x) => x as f64,
        _ => 0.0,
    };
    let size = now.abs().max(default.abs()).max(if now == 0.0 { usual(field.unit) } else { 0.0 });
    let wide = 10f64.powf((20.0 * size).log10().ceil());
    match field.range {
        Allowed::Number { least, greatest } => {
            // Far ends say what has a meaning, not what is usual.
            let low = match least {
                Bound::Closed(x) | Bound::Open(x) if x >= -FAR => x,
                _ if whole => 0.0,
                _ => -wide,
            };
            match greatest {
                Bound::Closed(x) | Bound::Open(x) if x <= FAR => (low, x, false),
                _ if low < 0.0 => (low, wide, false),
                _ => (low, wide, true),
            }
        }
        // Numbers of vertices and the like: as many as can be worked with.
        Allowed::Integer { least, greatest } if greatest >= MOST_WHOLE => {
            (least as f64, (MOST_WHOLE as f64).max(wide), false)
        }
        Allowed::Integer { least, greatest } => (least as f64, (greatest as f64).min(wide.max(64.0)), false),
        _ => (-wide, wide, false),
    }
}

/// A value that is no number.
fn other(ui: &mut Ui, words: Language, name: egui::Id, range: &Allowed, now: &Value) -> Option<Value> {
    match (range, now) {
        (Allowed::Boolean, Value::Boolean(flag)) => {
            let mut flag = *flag;
            ui.checkbox(&mut flag, "").labelled_by(name).changed().then_some(Value::Boolean(flag))
        }
        (Allowed::Choice(choices), Value::Text(word)) => {
            let mut chosen = word.clone();
            let menu = ComboBox::from_id_salt("choice").selected_text(words.choice(&chosen)).show_ui(ui, |ui| {
                for choice in *choices {
                    ui.selectable_value(&mut chosen, (*choice).to_string(), words.choice(choice));
                }
            });
            menu.response.labelled_by(name);
            (chosen != *word).then_some(Value::Text(chosen))
        }
        (Allowed::Vector | Allowed::Direction, Value::Numbers(list)) => {
            let mut list = list.clone();
            let before = list.clone();
            for x in &mut list {
                ui.add(DragValue::new(x).speed(0.02).max_decimals(3)).labelled_by(name);
            }
            (list != before).then_some(Value::Numbers(list))
        }
        _ => {
            let text: String = now.to_string().chars().take(24).collect();
            ui.label(RichText::new(text).weak().size(12.0));
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sliders_reach_around_their_value_and_stay_within_what_is_allowed() {
        let field = |range| Field::new("x", range, "N/m", Unset::Absent, "");
        let (low, high, open) = ends(&field(Allowed::NOT_NEGATIVE), 1600.0, false);
        assert!(low == 0.0 && (16_000.0..=1e6).contains(&high) && open);
        assert_eq!(ends(&field(Allowed::FRACTION), 0.3, false), (0.0, 1.0, false));
        let (low, high, _) = ends(&field(Allowed::ANY), -3.0, false);
        assert!(low <= -30.0 && high >= 30.0);
        let turned = Allowed::Number { least: Bound::Closed(-1e6), greatest: Bound::Closed(1e6) };
        assert_eq!(ends(&field(turned), -3.0, false), ends(&field(Allowed::ANY), -3.0, false));
        let (low, high, _) = ends(&field(Allowed::Integer { least: 3, greatest: 1 << 40 }), 36.0, true);
        assert!(low == 3.0 && (200.0..1e6).contains(&high));
    }

    #[test]
    fn every_model_of_the_program_has_starting_values_with_which_it_can_be_built() {
        let registry = opruga::Registry::<2>::default();
        for spec in registry.models() {
            let mut values = opruga::core::spec::Values::defaults(spec, 2);
            for field in spec.fields.iter().filter(|f| f.default == Unset::Required) {
                let start = starting(spec.kind, field).expect("a starting value");
                values.set(spec, field.name, start, 2).expect("an allowed one");
            }
            assert!(values.missing(spec).is_empty(), "{}", spec.kind);
        }
    }
}
