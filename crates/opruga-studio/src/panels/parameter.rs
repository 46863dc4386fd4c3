//! Shows a parameter in the panel: its slider, unit and description. The slider, the unit and the description are made from the specification of the
//! model.

use crate::words::{Language, Part};
use egui::{ComboBox, DragValue, Response, RichText, Slider, SliderClamping, Ui};
use opruga::core::spec::{Allowed, Bound, Condition, Default as Unset, Field, Spec, Value, Values};
use std::collections::BTreeMap;

/// A field of a kind in the panel, with the dimension of the scene and the language.
#[derive(Clone, Copy, Debug)]
pub struct FieldContext<'a> {
    /// The path that identifies the field in the interface.
    pub path: &'a str,
    /// The part of a scene to which its kind belongs, such as a model or an integrator.
    pub part: Part,
    /// The kind to which the field belongs.
    pub kind: &'a str,
    /// The specification of the field.
    pub field: &'a Field,
    /// The dimension of the scene.
    pub dimension: usize,
    /// The language of the interface.
    pub words: Language,
    /// The values of all fields of the kind, because some fields have no effect if others are given.
    pub values: Option<&'a Values>,
    /// The specification of the kind, if fields can also be removed.
    pub whole: Option<&'static Spec>,
}

/// The request after a parameter was changed.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// Another value of the field.
    Value(Value),
    /// Other values of the whole kind, because the field replaces another one, or is removed.
    Whole(Values),
}

/// The values that the user is setting. A slider that is being dragged shows the value at the pointer, and not the value that the simulation reports.
#[derive(Debug, Default)]
pub struct Hand {
    grabbed: Option<(String, Value)>,
    /// The upper ends of sliders without a limit. The ends are stored so that they do not change during a drag.
    ends: BTreeMap<String, f64>,
}

/// Makes the initial values of a kind: its defaults, its required fields and, if exactly one of several fields must be given, the first of them.
pub fn begin(spec: &'static Spec, dimension: usize) -> Values {
    let mut values = Values::defaults(spec, dimension);
    let chosen = |field: &&Field| match field.default {
        Unset::Required => true,
        Unset::OneOf(set) => set.first() == Some(&field.name),
        _ => false,
    };
    for field in spec.fields.iter().filter(chosen) {
        if let Some(value) = starting(field) {
            // Starting values are allowed values; a test checks all of them.
            let _ = values.set(spec, field.name, value, dimension);
        }
    }
    values
}

/// Returns the same values without those of the named fields. The named fields are removed or get their defaults again.
fn without(spec: &'static Spec, values: &Values, names: &[&str], dimension: usize) -> Values {
    let mut rest = Values::defaults(spec, dimension);
    for (name, value) in values.iter().filter(|(name, _)| !names.contains(name)) {
        // The value was allowed before, so it is allowed now.
        let _ = rest.set(spec, name, value.clone(), dimension);
    }
    rest
}

/// Fields that must be given together with a field.
fn companions(spec: &Spec, name: &str) -> &'static [&'static str] {
    spec.fields.iter().find(|field| field.name == name).map_or(&[], |field| field.companions)
}

/// Returns the values with this field instead of another field of the same choice; none if no starting value is known for the field, or if it does
/// not belong to a choice.
pub fn instead(spec: &'static Spec, values: &Values, field: &Field, dimension: usize) -> Option<Values> {
    let Unset::OneOf(set) = field.default else { return None };
    // Values that only another field of the choice requires are removed together with that field.
    let asked_for = |name: &&str| spec.fields.iter().find(|f| f.name == *name).into_iter().flat_map(words_of);
    let words = set.iter().flat_map(asked_for).map(|(name, _)| name);
    let companions = set.iter().flat_map(|name| companions(spec, name)).copied();
    let leave: Vec<&str> = set.iter().copied().chain(companions).chain(words).collect();
    let mut new = without(spec, values, &leave, dimension);
    for (name, word) in words_of(field) {
        new.set(spec, name, Value::Text(word.into()), dimension).ok()?;
    }
    let with = field.companions;
    for field in std::iter::once(field).chain(spec.fields.iter().filter(|other| with.contains(&other.name))) {
        let kept = values.get(field.name).cloned().or_else(|| starting(field))?;
        new.set(spec, field.name, kept, dimension).ok()?;
    }
    Some(new)
}

/// The values that a field requires of other fields.
fn words_of(field: &Field) -> impl Iterator<Item = (&'static str, &'static str)> {
    field.applies.iter().filter_map(|condition| match condition {
        Condition::Word(name, words) => words.first().map(|word| (*name, *word)),
        _ => None,
    })
}

/// A starting value for a field that the scene does not give.
pub fn starting(field: &Field) -> Option<Value> {
    let known = match field.start {
        Some(start) => start,
        None => match field.range {
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

/// A typical magnitude of a quantity.
fn usual(unit: &str) -> f64 {
    match unit {
        "Pa" => 1e4,
        "N/m" => 100.0,
        "kg/m³" => 1000.0,
        "m" => 0.1,
        _ => 1.0,
    }
}

/// Shows a parameter. Returns the request if the user has changed it. Values that no slider can represent are shown but cannot be changed.
pub fn show(ui: &mut Ui, hand: &mut Hand, context: FieldContext<'_>, now: Option<&Value>) -> Option<Change> {
    let FieldContext { path, part, kind, field, words, .. } = context;
    let grabbed =
        hand.grabbed.as_ref().filter(|(grabbed_path, _)| grabbed_path == path).map(|(_, value)| value.clone());
    let now = grabbed.or_else(|| now.cloned());
    let unit = if field.unit.is_empty() { String::new() } else { format!(" [{}]", field.unit) };
    let name = words.field(part, kind, field.name);
    let label = RichText::new(format!("{name}{unit}")).size(12.0);
    let mut about = words.sentence(part, kind, field, context.dimension);
    let silent = context.values.and_then(|values| field.without_effect(values, context.dimension));
    if let Some(condition) = silent {
        about = format!("{about}\n{}", words.effect_only(part, kind, condition));
    }
    // A field that was added can be removed again.
    let removed = |ui: &mut Ui| {
        let (spec, values) = (context.whole?, context.values?);
        let optional = field.default == Unset::Absent && companion_is_silent(spec, values, field.name);
        let pressed = optional && ui.small_button("×").on_hover_text(words.remove_value()).clicked();
        pressed.then(|| Change::Whole(without(spec, values, &[field.name], context.dimension)))
    };
    let shown = |ui: &mut Ui| match (&field.range, now) {
        (_, None) => ui.horizontal(|ui| absent(ui, context, &name, &unit, &about)).inner,
        (_, Some(now @ (Value::Number(_) | Value::Integer(_)))) => {
            let (name, removed) = ui.horizontal(|ui| (explain(ui.label(label), &about).id, removed(ui))).inner;
            let value = match now {
                Value::Integer(x) => {
                    number(ui, hand, path, field, name, x as f64, true).map(|x| Value::Integer(x.round() as i64))
                }
                Value::Number(x) => number(ui, hand, path, field, name, x, false).map(Value::Number),
                _ => None,
            };
            removed.or(value.map(Change::Value))
        }
        (range, Some(now)) => {
            ui.horizontal(|ui| {
                let name = explain(ui.label(label), &about).id;
                let value = other(ui, words, name, range, &now);
                removed(ui).or(value.map(Change::Value))
            })
            .inner
        }
    };
    // A control without effect is disabled, and the reason is shown.
    ui.push_id(path, |ui| ui.add_enabled_ui(silent.is_none(), shown).inner).inner
}

/// Shows an explanation when the pointer is over a control, whether the control is enabled or not.
fn explain(response: Response, about: &str) -> Response {
    response.on_hover_text(about).on_disabled_hover_text(about)
}

/// Whether none of the given fields requires this field.
fn companion_is_silent(spec: &Spec, values: &Values, name: &str) -> bool {
    let needs = |field: &Field| field.companions.contains(&name) && values.get(field.name).is_some();
    !spec.fields.iter().any(needs)
}

/// Shows a field that the scene does not give. A button gives the field a value, possibly instead of another field. If no starting value is known,
/// only the name is shown.
fn absent(ui: &mut Ui, context: FieldContext<'_>, name: &str, unit: &str, about: &str) -> Option<Change> {
    let FieldContext { part, kind, field, words, .. } = context;
    let start = starting(field).map(Change::Value);
    let (start, text) = match (field.default, context.whole.zip(context.values)) {
        (Unset::OneOf(set), Some((spec, values))) => {
            let other =
                set.iter().find(|other| values.get(other).is_some()).map(|other| words.field(part, kind, other));
            let text = words.instead().replacen("{}", &format!("{name}{unit}"), 1);
            let text = other.map_or(format!("+ {name}{unit}"), |other| text.replacen("{}", &other, 1));
            (instead(spec, values, field, context.dimension).map(Change::Whole), text)
        }
        _ => (start, format!("+ {name}{unit}")),
    };
    if start.is_none() {
        let about = format!("{about}\n{}", words.in_the_scene());
        explain(ui.label(RichText::new(format!("{name}{unit}")).size(12.0).weak()), &about);
        return None;
    }
    let button = egui::Button::new(RichText::new(text).size(12.0)).small();
    if explain(ui.add(button), about).clicked() { start } else { None }
}

/// A slider below its name.
fn number(
    ui: &mut Ui,
    hand: &mut Hand,
    path: &str,
    field: &Field,
    name: egui::Id,
    now: f64,
    whole: bool,
) -> Option<f64> {
    let (low, high, open) = ends(field, now, whole);
    // If there is no limit, the upper end does not change after the slider was first shown, unless the value has exceeded it.
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
    // For a number that is typed, only the final value counts.
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
        hand.grabbed = Some((path.to_string(), value));
    } else if hand.grabbed.as_ref().is_some_and(|(grabbed_path, _)| grabbed_path == path) {
        hand.grabbed = None;
    }
    changed.then_some(x)
}

/// The upper end of sliders for whole numbers whose allowed range is larger.
const MOST_WHOLE: i64 = 100_000;

/// Limits whose magnitude is larger than this are not used as ends of sliders.
const FAR: f64 = 1e5;

/// Returns the ends of a slider, and whether the upper one may grow.
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
            // A very large limit is not used as an end, because it gives the possible values and not the usual ones.
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
        // Numbers of vertices and similar counts have very large limits, so the slider ends at a practical number.
        Allowed::Integer { least, greatest } if greatest >= MOST_WHOLE => {
            (least as f64, (MOST_WHOLE as f64).max(wide), false)
        }
        Allowed::Integer { least, greatest } => (least as f64, (greatest as f64).min(wide.max(64.0)), false),
        _ => (-wide, wide, false),
    }
}

/// Shows a value that is not a number.
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

    /// Bodies of all types: an outline that may contain gas and an outline with cells, in the plane and in space.
    const BODIES: [(usize, &str); 4] = [
        (2, "kind = \"ring\", radius = 0.5, vertices = 16, center = [0.0, 2.0]"),
        (2, "kind = \"grid\", corner = [0.0, 1.0], size = [1.0, 1.0], cells = [2, 2]"),
        (3, "kind = \"icosphere\", radius = 0.5, subdivisions = 1"),
        (3, "kind = \"grid\", corner = [0.0, 1.0, 0.0], size = [1.0, 1.0, 1.0], cells = [2, 2, 2]"),
    ];

    /// A scene with such a body.
    fn scene(dimension: usize, shape: &str) -> String {
        format!(
            "format = \"opruga-1\"\ndimension = {dimension}\n[time]\nseconds = 1.0\nframe = 0.02\nsubsteps = 4000\n\
             [integrator]\nkind = \"symplectic_euler\"\n[[body]]\nname = \"it\"\nshape = {{ {shape} }}\nmass = 1.0\n"
        )
    }

    /// Returns the reason why the body of this scene cannot have these models; none if it can.
    fn refused(text: &str, models: Vec<Values>) -> Option<String> {
        use crate::session::{Request, Session};
        let opened = Session::open("it", text, opruga::io::Files::default(), opruga::Options::default());
        let mut session = opened.unwrap_or_else(|report| panic!("{report}\n{text}"));
        session.handle(Request::Models(0, models));
        let message = session.shown().message.filter(|m| m.severity == crate::shown::Severity::Refused);
        message.map(|message| message.text)
    }

    #[test]
    fn every_model_of_the_program_can_be_chosen_and_built_as_it_begins() {
        let models = opruga::Registry::<2>::default().models();
        assert!(models.len() >= 6);
        for spec in models {
            for dimension in spec.dimensions {
                let values = begin(spec, *dimension);
                assert!(values.missing(spec).is_empty() && values.check_choices(spec).is_ok(), "{}", spec.kind);
                let bodies = BODIES.iter().filter(|(of, _)| of == dimension);
                let why: Vec<Option<String>> =
                    bodies.map(|(_, shape)| refused(&scene(*dimension, shape), vec![values.clone()])).collect();
                assert!(why.iter().any(Option::is_none), "{} in {dimension}D: {why:?}", spec.kind);
            }
        }
    }

    #[test]
    fn every_field_of_a_choice_takes_the_place_of_the_others_in_one_edit_and_can_be_given_back() {
        let mut count = 0;
        for spec in opruga::Registry::<2>::default().models() {
            for field in spec.fields.iter().filter(|field| matches!(field.default, Unset::OneOf(_))) {
                let values = begin(spec, 2);
                let Some(new) = instead(spec, &values, field, 2) else { continue };
                count += 1;
                assert!(new.get(field.name).is_some() && new.check_choices(spec).is_ok(), "{}: {new:?}", field.name);
                let bodies = BODIES.iter().filter(|(of, _)| *of == 2);
                let why: Vec<Option<String>> =
                    bodies.map(|(_, shape)| refused(&scene(2, shape), vec![new.clone()])).collect();
                assert!(why.iter().any(Option::is_none), "{} {}: {why:?}", spec.kind, field.name);
                let first = spec.fields.iter().find(|f| values.get(f.name).is_some() && f.default == field.default);
                let back = instead(spec, &new, first.expect("the first of them"), 2).expect("known");
                assert!(back.check_choices(spec).is_ok());
                assert_eq!(back.iter().count(), values.iter().count(), "{back:?}");
            }
        }
        assert!(count >= 6, "mass_spring, bending and pressure: {count}");
    }

    #[test]
    fn a_field_that_was_added_is_taken_away_and_the_others_stay() {
        let spec = opruga::Registry::<2>::default().models().into_iter().find(|spec| spec.kind == "fem").expect("it");
        let mut values = begin(spec, 2);
        values.set(spec, "cells", Value::Text("soft".into()), 2).expect("allowed");
        assert_eq!(without(spec, &values, &["cells"], 2), begin(spec, 2));
    }
}
