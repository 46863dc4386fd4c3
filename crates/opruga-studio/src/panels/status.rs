//! The status line with performance and other numbers. Every number has the space of its longest form, so that nothing moves while the numbers
//! change.

use super::bars::file_name;
use super::keeping::What;
use crate::shown::Shown;
use crate::theme;
use crate::words::Language;
use egui::{Align, Color32, FontId, Label, Layout, Popup, RichText, ScrollArea, Sense, Ui, vec2};
use opruga::Warning;
use std::time::Duration;

/// The font size of the line [points].
const SIZE: f32 = 11.5;
/// The height of a row, and the space between two numbers [points].
const TALL: f32 = 16.0;
const GAP: f32 = 14.0;
/// The smallest space for the text after the numbers [points].
const REST: f32 = 100.0;
/// The smallest width [points] at which everything fits into one row in every language.
const BROAD: f32 = 1000.0;

/// A number: its text, its longest usual form, whether it needs attention, and its explanation.
struct Number {
    text: String,
    longest: String,
    attention: bool,
    about: String,
}

/// Shows the status line with the numbers and the name of the renderer. The line includes the rate of pictures if pictures are consecutive, the
/// computing time of the present frame so far, and the progress of a preparation. The height of the line depends only on the width of the window.
pub fn status(
    ui: &mut Ui,
    shown: &Shown,
    words: Language,
    (rate, busy): (Option<f64>, Option<(Duration, Option<f64>)>),
    narrow: bool,
    drawn_by: Option<&[String; 2]>,
    mut making: impl Iterator<Item = (What, u32)>,
) {
    // In a narrow window, the slowdown is shown only while the pointer is over the line, because it would need another row.
    let numbers = numbers(shown, words, rate, narrow || ui.available_width() < BROAD);
    let font = FontId::proportional(SIZE);
    let wide: Vec<f32> = numbers
        .iter()
        .map(|number| ui.painter().layout_no_wrap(number.longest.clone(), font.clone(), Color32::WHITE).size().x.ceil())
        .collect();
    let rows = rows(&wide, ui.available_width());
    ui.spacing_mut().item_spacing.y = 2.0;
    for (index, row) in rows.iter().enumerate() {
        ui.horizontal(|ui| {
            ui.set_height(TALL);
            ui.spacing_mut().item_spacing.x = GAP;
            for number in row.clone() {
                let Number { text, attention, about, .. } = &numbers[number];
                let layout = Layout::left_to_right(Align::Center);
                ui.allocate_ui_with_layout(vec2(wide[number], TALL), layout, |ui| {
                    ui.set_min_size(vec2(wide[number], TALL));
                    // While a frame is being computed, all numbers except the first belong to the previous frame.
                    if busy.is_some() && number > 0 {
                        ui.disable();
                    }
                    let text = RichText::new(text).size(SIZE);
                    let text = if *attention { text.color(theme::attention(ui.visuals())) } else { text };
                    let response = ui.add(Label::new(text).extend());
                    if !about.is_empty() {
                        response.on_hover_text(about);
                    }
                });
            }
            if index + 1 == rows.len() {
                let mut notes: Vec<(RichText, String)> = Vec::new();
                let small = |text: String| RichText::new(text).size(SIZE);
                if let Some((busy, prepared)) = busy {
                    let mut text = words.computing().replace("{}", &format!("{:.0}", busy.as_secs_f64()));
                    if let Some(share) = prepared {
                        text += &format!(" · {:.0} %", 100.0 * share);
                    }
                    notes.push((small(text).color(theme::attention(ui.visuals())), String::new()));
                }
                if let Some(goal) = shown.goal.filter(|_| busy.is_none()) {
                    let text = words.again().replace("{}", &format!("{goal:.2}"));
                    notes.push((small(text).color(theme::attention(ui.visuals())), String::new()));
                }
                for (what, hundredths) in making.by_ref() {
                    // If there is little space, the end of the name is cut off.
                    let text = small(format!("{hundredths} % {}", file_name(words, what)));
                    notes.push((text.strong(), words.working().into()));
                }
                if let Some([by, device]) = drawn_by {
                    notes.push((small(by.clone()), format!("{}: {device}", words.drawn_by())));
                }
                if shown.recorded > 0 {
                    notes.push((small(format!("{}: {}", words.recorded(), shown.recorded)), String::new()));
                }
                for (text, about) in notes {
                    let response = ui.add(Label::new(text).truncate());
                    if !about.is_empty() {
                        response.on_hover_text(about);
                    }
                }
                warnings(ui, shown, words);
            }
        });
    }
}

/// The numbers that are always shown.
fn numbers(shown: &Shown, words: Language, rate: Option<f64>, narrow: bool) -> Vec<Number> {
    let nodes: usize = shown.bodies.iter().map(|body| body.nodes).sum();
    let cost = shown.pace.frame_cost;
    let moving = if shown.playing { shown.pace.ratio * shown.speed } else { 0.0 };
    let steps = if shown.frame > 0.0 { moving * f64::from(shown.substeps) / shown.frame } else { 0.0 };
    let margin = margin(shown).map_or("–".into(), |share| format!("{:.0} %", 100.0 * share));
    let rate = rate.map_or("–".into(), |rate| format!("{rate:.0}"));
    let slow = shown.playing && shown.pace.ratio < 0.95;
    let slower = |times: f64| format!("{times:.1} × {}", words.slower());
    let slower_now = slower(1.0 / shown.pace.ratio.max(1e-3));
    let pace = |moving: f64, slower: Option<&String>| match slower.filter(|_| !narrow) {
        Some(slower) => format!("{moving:.2} × {}: {slower}", words.real_time()),
        None => format!("{moving:.2} × {}", words.real_time()),
    };
    let number = |text: String, longest: String, about: &str| {
        let about = about.into();
        Number { text, longest, attention: false, about }
    };
    vec![
        number(format!("{rate} FPS"), "000 FPS".into(), ""),
        number(format!("{:.2} ms", 1e3 * cost), "0000.00 ms".into(), words.step_time()),
        number(format!("{} {}", short(nodes as f64), words.nodes()), format!("000000 {}", words.nodes()), ""),
        number(
            format!("{} {}", short(steps), words.steps_a_second()),
            format!("000000 {}", words.steps_a_second()),
            "",
        ),
        number(format!("{}: {margin}", words.margin()), format!("{}: 000 %", words.margin()), words.substeps_hint()),
        // The number with the longest form is last.
        Number {
            attention: slow,
            ..number(
                pace(moving, slow.then_some(&slower_now)),
                pace(0.0, Some(&slower(100.0))),
                if slow { &slower_now } else { "" },
            )
        },
    ]
}

/// Distributes numbers of these widths over rows. The last row has space left for the text after the numbers.
fn rows(wide: &[f32], available: f32) -> Vec<core::ops::Range<usize>> {
    let (mut rows, mut first, mut used) = (Vec::new(), 0, 0.0);
    for (index, wide) in wide.iter().enumerate() {
        if used + wide > available && used > 0.0 {
            rows.push(first..index);
            (first, used) = (index, 0.0);
        }
        used += wide + GAP;
    }
    rows.push(first..wide.len());
    if used + REST > available {
        rows.push(wide.len()..wide.len());
    }
    rows
}

/// Shows the beginning of the first warning and the number of the others. A click shows all warnings.
fn warnings(ui: &mut Ui, shown: &Shown, words: Language) {
    let warnings = of_both(shown);
    let Some(&(right, first)) = warnings.first() else { return };
    let others = warnings.len() - 1;
    let side = |right: bool| if right { format!("{}: ", words.on_the_right()) } else { String::new() };
    let beginning = beginning(&words.warning_text(first));
    let more = if others > 0 { format!("  +{others}") } else { String::new() };
    let text = RichText::new(format!("{}{} ({}){more}: {beginning}", side(right), words.warning(), first.count))
        .size(SIZE)
        .color(theme::attention(ui.visuals()));
    let all = |ui: &mut Ui| {
        ui.set_max_width((ui.ctx().content_rect().width() - 40.0).clamp(80.0, 520.0));
        ScrollArea::vertical().max_height(0.6 * ui.ctx().content_rect().height()).show(ui, |ui| {
            for (right, warning) in &warnings {
                ui.label(format!("{}{} ({})", side(*right), words.warning_text(warning), warning.count));
                ui.label(RichText::new(&warning.code).weak().size(SIZE));
            }
        });
    };
    let response = ui.add(Label::new(text).truncate().sense(Sense::click()));
    Popup::from_toggle_button_response(&response).show(all);
    if !Popup::is_id_open(ui.ctx(), Popup::default_response_id(&response)) {
        response.on_hover_ui(all);
    }
}

/// Returns the warnings of the left scene, followed by those that only the right scene has, each with whether it belongs to the right scene only.
fn of_both(shown: &Shown) -> Vec<(bool, &Warning)> {
    let own =
        |warning: &&Warning| !shown.warnings.iter().any(|w| (&w.code, &w.message) == (&warning.code, &warning.message));
    let right = shown.beside.iter().flat_map(|beside| &beside.right.warnings).filter(own);
    shown.warnings.iter().map(|warning| (false, warning)).chain(right.map(|warning| (true, warning))).collect()
}

/// The substep divided by the largest stable substep. For two scenes, it is the larger ratio. None if there is no limit.
fn margin(shown: &Shown) -> Option<f64> {
    let limited = shown.stable_step.is_finite() && shown.stable_step > 0.0;
    let own = limited.then(|| shown.frame / f64::from(shown.substeps.max(1)) / shown.stable_step);
    let of_right = shown.beside.as_ref().and_then(|beside| margin(&beside.right));
    own.into_iter().chain(of_right).max_by(f64::total_cmp)
}

/// Returns the beginning of a sentence up to its first parenthesis or semicolon, shortened to whole words that fit.
fn beginning(sentence: &str) -> String {
    const MOST: usize = 60;
    let whole = sentence.split_whitespace().collect::<Vec<_>>().join(" ");
    let aside = [" (", "; "].into_iter().filter_map(|mark| whole.find(mark)).min();
    let first = &whole[..aside.unwrap_or(whole.len())];
    let limit = first.char_indices().nth(MOST).map_or(first.len(), |(end, _)| end);
    // A single word that is too long is cut.
    let end = if limit < first.len() { first[..limit].rfind(' ').unwrap_or(limit) } else { limit };
    let cut = first[..end].trim_end_matches([',', ':']);
    if end < whole.len() { format!("{cut} …") } else { whole }
}

/// A count with at most six characters. Counts from a million are given in millions (M), and those from a thousand million in thousand millions (G).
fn short(count: f64) -> String {
    if count < 999_999.5 {
        return format!("{count:.0}");
    }
    let (part, letter) = if count < 999.5e6 { (count * 1e-6, 'M') } else { (count * 1e-9, 'G') };
    let digits = if part < 9.995 { 2 } else { usize::from(part < 99.95) };
    format!("{part:.digits$} {letter}")
}

#[cfg(test)]
mod tests {
    use super::{beginning, margin, of_both, rows};
    use crate::shown::{Beside, Shown};
    use opruga::Warning;
    use std::sync::Arc;

    #[test]
    fn of_two_scenes_the_one_that_is_nearer_to_its_limit_is_told() {
        let one = |substeps, stable_step| Shown { frame: 0.016, substeps, stable_step, ..Shown::default() };
        let both = |left: Shown, right: Shown| {
            let (right, differences) = (Arc::new(right), Vec::new());
            let beside =
                Beside { right, distances: None, center: None, volume: None, energy: None, differences, stopped: None };
            margin(&Shown { beside: Some(beside), ..left })
        };
        let limitless = || one(8, f64::INFINITY);
        assert_eq!(margin(&one(8, 0.004)), Some(0.5));
        assert_eq!(both(one(8, 0.004), one(4, 0.005)), Some(0.8));
        assert_eq!(both(one(4, 0.005), one(8, 0.004)), Some(0.8));
        assert_eq!(both(limitless(), one(8, 0.004)), Some(0.5));
        assert_eq!(both(one(8, 0.004), limitless()), Some(0.5));
        assert_eq!(both(limitless(), limitless()), None);
    }

    #[test]
    fn warnings_of_the_right_scene_that_the_left_one_has_not_stand_behind_those_of_the_left_one() {
        let warning =
            |code: &str, message: &str| Warning { code: code.into(), message: message.into(), count: 1, about: None };
        let [odd, lost] = [warning("shape.odd", "both"), warning("pressure.inverted", "the right one")];
        let right = Arc::new(Shown { warnings: vec![odd.clone(), lost.clone()], ..Shown::default() });
        let beside = Beside {
            right,
            distances: None,
            center: None,
            volume: None,
            energy: None,
            differences: Vec::new(),
            stopped: None,
        };
        let shown = Shown { warnings: vec![odd.clone()], beside: Some(beside), ..Shown::default() };
        assert_eq!(of_both(&shown), [(false, &odd), (true, &lost)]);
        assert_eq!(of_both(&Shown { beside: None, ..shown }).len(), 1);
    }

    #[test]
    fn numbers_stand_in_as_few_rows_as_the_window_is_wide_for_with_room_behind_the_last() {
        let wide = [50.0, 60.0, 90.0, 80.0, 95.0, 140.0];
        assert_eq!(rows(&wide, 1200.0).len(), 1);
        assert_eq!(rows(&wide, 374.0), [0..4, 4..6]);
        assert_eq!(rows(&wide, 330.0), [0..4, 4..6, 6..6]);
        assert_eq!(rows(&wide, 10.0).len(), 7, "one in every row, and the rest");
    }

    #[test]
    fn the_beginning_of_a_sentence_has_whole_words_and_says_where_it_was_cut() {
        assert_eq!(beginning("the body is stretched:\nby far"), "the body is stretched: by far");
        let long = "`heun` has no stable step for body `ball` (ω = 160 rad/s): a motion grows as exp(7 t)";
        assert_eq!(beginning(long), "`heun` has no stable step for body `ball` …");
        let words = "a word ".repeat(20);
        assert_eq!(beginning(&words), "a word a word a word a word a word a word a word a word a …");
        assert_eq!(beginning(&"č".repeat(90)).chars().filter(|letter| *letter == 'č').count(), 60);
    }
}
