//! Shows the latest message over the scene.

use super::Studio;
use crate::report::Step;
use crate::session::Request;
use crate::shown::{Offer, Severity, Shown};
use crate::words::{Language, Part};
use egui::{
    Align, Align2, Color32, CornerRadius, FontId, Frame, Key, Modifiers, Pos2, Rect, RichText, Stroke, Ui, Vec2,
};
use opruga::draw::format_value;

/// How long a notice stays on the screen [s]. `TO_READ` is the additional time [s] for every letter after the first sixty.
const SHOWN_FOR: f64 = 6.0;
const TO_READ: f64 = 0.05;

/// The possible positions of a message, the preferred one first.
const PIVOTS: [Align2; 6] = [
    Align2::CENTER_BOTTOM,
    Align2::CENTER_TOP,
    Align2::LEFT_BOTTOM,
    Align2::RIGHT_BOTTOM,
    Align2::LEFT_TOP,
    Align2::RIGHT_TOP,
];

/// The number of heights that are tried if each position in `PIVOTS` hides something.
const HEIGHTS: u8 = 32;

/// The widths of a message that are tried, as fractions of the largest.
const WIDTHS: [f32; 3] = [1.0, 0.6, 0.4];

/// The position of a message in the free area: the side at which it is anchored, its height from 0 (top) to 1 (bottom), and its largest width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placement {
    pivot: Align2,
    down: f32,
    max_width: f32,
}

impl Default for Placement {
    fn default() -> Placement {
        Placement::at(PIVOTS[0])
    }
}

impl Placement {
    /// A placement at the border, anchored at `pivot`.
    fn at(pivot: Align2) -> Placement {
        Placement { pivot, down: if pivot.y() == Align::BOTTOM { 1.0 } else { 0.0 }, max_width: 620.0 }
    }

    /// The anchor point.
    fn point(self, free: Rect) -> Pos2 {
        Pos2::new(self.pivot.pos_in_rect(&free).x, free.top() + self.down * free.height())
    }
}

/// The source of a message. If several sources have a new message at once, the message of the last of them is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Speaker {
    /// The session, about the scene.
    Session,
    /// The window, about files.
    Window,
    /// The pen, about an outline.
    Pen,
}

/// The messages so far: the number of the present message of each source, if it has one, and the order in which the sources spoke.
#[derive(Debug)]
pub(super) struct Heard {
    numbers: [Option<u64>; 3],
    order: [Speaker; 3],
}

impl Default for Heard {
    fn default() -> Heard {
        Heard { numbers: [None; 3], order: [Speaker::Session, Speaker::Window, Speaker::Pen] }
    }
}

impl Heard {
    /// Of the sources that have a message now, returns the one whose message came last.
    fn last(&mut self, now: [Option<u64>; 3]) -> Option<Speaker> {
        for speaker in [Speaker::Session, Speaker::Window, Speaker::Pen] {
            let index = speaker as usize;
            if now[index].is_some() && now[index] != self.numbers[index] {
                // This source moves to the end of the order, and the others keep their order.
                self.order.sort_by_key(|other| *other == speaker);
            }
        }
        self.numbers = now;
        self.order.into_iter().rev().find(|speaker| now[*speaker as usize].is_some())
    }
}

/// The message that is shown.
struct Spoken {
    speaker: Speaker,
    /// The number of the session's message.
    number: Option<u64>,
    text: String,
    refused: bool,
    offer: Option<Offer>,
}

impl Language {
    /// The label of the button with a remedy.
    fn offer(self, offer: &Offer) -> String {
        match offer {
            Offer::HalveStep => self.halve_step().to_string(),
            Offer::Steady(_, kind) => self.take_steady().replace("{}", &self.kind(Part::Integrator, kind)),
            Offer::Substeps(n) => self.use_substeps().replace("{}", &n.to_string()),
            Offer::Coarser(_, field, value) => {
                let field = self.done(&Step::Shape(field));
                self.take_coarser().replace("{}", &format!("{field} {value}"))
            }
            Offer::GoOn => self.go_on().to_string(),
            Offer::Wait(seconds) => self.wait_longer().replace("{}", &seconds.to_string()),
        }
    }
}

impl Studio {
    /// Shows the last message with its remedy, where it hides as little of the bodies as possible.
    pub(super) fn message(&mut self, ui: &Ui, rect: egui::Rect, shown: &Shown, asks: &mut Vec<Request>) {
        let words = self.language;
        let pen = self.canvas.refused.map(|why| match why {
            "crossing" => words.crossing(),
            "only_plane" => words.only_plane(),
            _ => words.too_small(),
        });
        let message = shown.message.as_ref().filter(|message| message.number != self.closed);
        let of_window = self.keeping.message().map(|_| self.keeping.message_count());
        let now = [message.map(|message| message.number), of_window, pen.map(|_| 0)];
        let Some(speaker) = self.heard.last(now) else { return };
        // When another message appears, a notice that is still shown is dropped.
        let is_notice = |severity: Severity, offer: bool| severity == Severity::Done && !offer;
        if speaker != Speaker::Session
            && let Some(message) = message.filter(|message| is_notice(message.severity, message.offer.is_some()))
        {
            self.closed = message.number;
        }
        if speaker != Speaker::Window && self.keeping.message().is_some_and(|(_, severity)| is_notice(*severity, false))
        {
            self.keeping.forget_message();
        }
        let message = message.filter(|_| speaker == Speaker::Session);
        let (text, severity, offer) = match (speaker, pen, message, self.keeping.message()) {
            (Speaker::Pen, Some(text), ..) => (text.to_string(), Severity::Refused, None),
            (Speaker::Session, _, Some(message), _) => {
                (words.report(&message.report), message.severity, message.offer.clone())
            }
            (Speaker::Window, _, _, Some((report, severity))) => (words.report(report), *severity, None),
            _ => return,
        };
        let takes = message.and_then(|message| message.frame_seconds);
        let text = match takes {
            Some(seconds) => format!("{text}. {}", words.frame_would_take().replace("{}", &format_value(seconds))),
            None => text,
        };
        let number = message.map(|message| message.number);
        let spoken = Spoken { speaker, number, text, refused: severity == Severity::Refused, offer };
        let free = self.free_for_messages(rect, shown);
        let heard = format!("{speaker:?} {:?}: {}", now[speaker as usize], spoken.text);
        let time = ui.input(|i| i.time);
        if self.last_message.0 != heard {
            // The placement is computed only once, so the message stays at its position although bodies move.
            let placement = self.least_hiding(&spoken.text, ui, free, rect.width(), shown);
            self.last_message = (heard, time, placement);
        }
        let long = SHOWN_FOR + TO_READ * spoken.text.chars().count().saturating_sub(60) as f64;
        // Escape first closes an open menu.
        let escape =
            !egui::Popup::is_any_open(ui.ctx()) && ui.input_mut(|i| i.consume_key(Modifiers::NONE, Key::Escape));
        if escape || !spoken.refused && spoken.offer.is_none() && time - self.last_message.1 > long {
            self.forget(speaker, number);
            return;
        }
        self.show_message(ui, &spoken, free, shown.undo.as_ref(), asks);
    }

    /// The area for messages: between the tools and the items at the lower border.
    fn free_for_messages(&self, rect: Rect, shown: &Shown) -> Rect {
        let high = self.canvas.tools.map_or(rect.top(), |tools| tools.bottom()) + 8.0;
        let low = rect.bottom()
            - match &shown.beside {
                None => 40.0,
                Some(_) if rect.width() >= rect.height() => 66.0,
                // If the scenes are one above the other, there is nothing at the lower border of the lower one.
                Some(_) => 8.0,
            };
        Rect::from_min_max(Pos2::new(rect.left() + 8.0, high), Pos2::new(rect.right() - 8.0, low.max(high)))
    }

    /// Returns the placement at which a text hides as little of the bodies as possible. To achieve this, the text may be broken into more lines.
    fn least_hiding(&self, text: &str, ui: &Ui, free: Rect, width: f32, shown: &Shown) -> Placement {
        let covered = self.canvas.covered(shown);
        let widest = (width - 120.0).clamp(120.0, 620.0);
        let placements = WIDTHS.map(|share| {
            let max_width = (share * widest).max(120.0);
            let galley = ui.painter().layout(text.to_string(), FontId::proportional(13.0), edge(false), max_width);
            let size = galley.size() + Vec2::new(16.0, 48.0);
            let (hidden, placement) = placement(free, size, &covered);
            (hidden, Placement { max_width, ..placement })
        });
        placements.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or_default().1
    }

    /// Shows the message with its buttons.
    fn show_message(&mut self, ui: &Ui, spoken: &Spoken, free: Rect, undo: Option<&Step>, asks: &mut Vec<Request>) {
        let placement = self.last_message.2;
        egui::Area::new(egui::Id::unique("message"))
            .pivot(placement.pivot)
            .fixed_pos(placement.point(free))
            .order(egui::Order::Middle)
            .show(ui.ctx(), |ui| {
                Frame::popup(ui.style())
                    .stroke(Stroke::new(1.5, edge(spoken.refused)))
                    .corner_radius(CornerRadius::same(6))
                    .show(ui, |ui| {
                        ui.set_max_width(placement.max_width);
                        let lines: Vec<&str> = spoken.text.lines().collect();
                        let short = lines.iter().take(8).copied().collect::<Vec<_>>().join("\n");
                        let monospaced = lines.len() > 1;
                        let text = RichText::new(if monospaced { short } else { unbroken(&short) });
                        ui.label(if monospaced { text.monospace().size(11.5) } else { text });
                        ui.horizontal(|ui| self.message_buttons(ui, spoken, undo, asks));
                    });
            });
    }

    /// Shows the buttons: the remedy, undo of the last change, and close.
    fn message_buttons(&mut self, ui: &mut Ui, spoken: &Spoken, undo: Option<&Step>, asks: &mut Vec<Request>) {
        let words = self.language;
        let closed = spoken.number.unwrap_or(self.closed);
        if let Some(offer) = &spoken.offer
            && ui.button(words.offer(offer)).clicked()
        {
            asks.push(Request::Accept(offer.clone()));
            self.closed = closed;
        }
        // The last change may have caused the failure.
        if matches!(spoken.offer, Some(Offer::HalveStep | Offer::Steady(..)))
            && let Some(step) = undo
            && ui.button(format!("{} ({})", words.undo(), words.done(step))).clicked()
        {
            asks.push(Request::Undo);
            self.closed = closed;
        }
        if ui.button(words.close()).on_hover_text("Esc").clicked() {
            self.forget(spoken.speaker, spoken.number);
        }
    }

    /// Forgets the message of a source, because it was read or was shown for long enough.
    fn forget(&mut self, speaker: Speaker, number: Option<u64>) {
        match speaker {
            Speaker::Session => self.closed = number.unwrap_or(self.closed),
            Speaker::Window => self.keeping.forget_message(),
            Speaker::Pen => self.canvas.refused = None,
        }
    }
}

/// The colour of the border of a message.
fn edge(refused: bool) -> Color32 {
    if refused { Color32::from_rgb(214, 80, 60) } else { Color32::from_rgb(60, 140, 110) }
}

/// Returns the placement at which a message of this size hides as little as possible, and the hidden area [square points].
fn placement(free: Rect, size: Vec2, covered: &[Rect]) -> (f32, Placement) {
    let hidden = |placement: &Placement| {
        let rect = placement.pivot.anchor_size(placement.point(free), size).intersect(free);
        let over = |other: &Rect| Some(other.intersect(rect)).filter(Rect::is_positive).map_or(0.0, |both| both.area());
        covered.iter().map(over).sum::<f32>()
    };
    // Positions between the borders are tried, too, because there may be free strips between bodies.
    let most = (1.0 - size.y / free.height().max(1.0)).max(0.0);
    let heights = (1..HEIGHTS).map(|k| f32::from(k) / f32::from(HEIGHTS) * most);
    let between = heights.flat_map(|down| {
        [Align2::CENTER_TOP, Align2::LEFT_TOP, Align2::RIGHT_TOP]
            .map(|pivot| Placement { down, ..Placement::at(pivot) })
    });
    let all = PIVOTS.into_iter().map(Placement::at).chain(between);
    all.map(|placement| (hidden(&placement), placement)).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or_default()
}

/// Units that follow numbers in messages.
const UNITS: [&str; 12] = ["s", "ms", "m", "kg", "N", "J", "Pa", "Hz", "%", "rad/s", "m/s", "N/m"];

/// Makes parts of a text stay on one line if they belong together: a symbol, its equals sign and its number, and a number and its unit.
fn unbroken(text: &str) -> String {
    let mut whole = String::with_capacity(text.len() + 8);
    let mut last = "";
    for (index, word) in text.split(' ').enumerate() {
        let unit = word.trim_end_matches(['.', ',', ';', ':', ')']);
        let together =
            word == "=" || last == "=" || last.ends_with(|c: char| c.is_ascii_digit()) && UNITS.contains(&unit);
        if index > 0 {
            whole.push(if together { '\u{a0}' } else { ' ' });
        }
        whole.push_str(word);
        last = word;
    }
    whole
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whoever_spoke_last_is_heard_and_whoever_has_nothing_to_say_any_more_is_not() {
        let mut heard = Heard::default();
        assert_eq!(heard.last([None; 3]), None);
        assert_eq!(heard.last([Some(1), None, None]), Some(Speaker::Session));
        // A file was written.
        assert_eq!(heard.last([Some(1), Some(1), None]), Some(Speaker::Window));
        assert_eq!(heard.last([Some(1), Some(1), None]), Some(Speaker::Window));
        assert_eq!(heard.last([Some(2), Some(1), None]), Some(Speaker::Session));
        assert_eq!(heard.last([Some(2), Some(2), Some(0)]), Some(Speaker::Pen));
        assert_eq!(heard.last([Some(2), Some(2), None]), Some(Speaker::Window));
        assert_eq!(heard.last([Some(2), None, None]), Some(Speaker::Session));
        assert_eq!(heard.last([None, None, Some(0)]), Some(Speaker::Pen), "another outline");
    }

    #[test]
    fn a_message_is_where_it_hides_nothing_or_least() {
        let free = Rect::from_min_max(Pos2::new(10.0, 60.0), Pos2::new(970.0, 580.0));
        let size = Vec2::new(400.0, 80.0);
        let body = |left: f32, top: f32, right: f32, bottom: f32| {
            Rect::from_min_max(Pos2::new(left, top), Pos2::new(right, bottom))
        };
        let placement = |free: Rect, size: Vec2, covered: &[Rect]| super::placement(free, size, covered).1;
        assert_eq!(placement(free, size, &[]), Placement::at(Align2::CENTER_BOTTOM));
        assert_eq!(placement(free, size, &[body(400.0, 200.0, 600.0, 400.0)]), Placement::at(Align2::CENTER_BOTTOM));
        // A flat body on the floor, another that also hangs from above, and one that fills the window except for a corner.
        let flat = body(200.0, 540.0, 800.0, 600.0);
        assert_eq!(placement(free, size, &[flat]), Placement::at(Align2::CENTER_TOP));
        let hanging = body(300.0, 60.0, 700.0, 200.0);
        let lying = body(300.0, 540.0, 500.0, 600.0);
        assert_eq!(placement(free, size, &[lying, hanging]), Placement::at(Align2::RIGHT_BOTTOM));
        assert_eq!(placement(free, size, &[body(0.0, 0.0, 980.0, 520.0)]), Placement::at(Align2::CENTER_BOTTOM));
        // Two scenes one above the other, with a strip between them.
        let scenes = [body(0.0, 60.0, 980.0, 260.0), body(0.0, 380.0, 980.0, 600.0)];
        let (hidden, between) = super::placement(free, size, &scenes);
        assert_eq!(hidden, 0.0);
        let strip = between.pivot.anchor_size(between.point(free), size);
        assert!(scenes.iter().all(|scene| !scene.intersects(strip)) && free.contains_rect(strip), "{strip:?}");
    }

    #[test]
    fn a_number_stays_with_its_letter_and_its_unit() {
        let text = unbroken("Undone: move, t = 0.333333 s, at 5 nodes (h = 2 ms).");
        let lines: Vec<&str> = text.split(' ').collect();
        assert_eq!(
            lines,
            ["Undone:", "move,", "t\u{a0}=\u{a0}0.333333\u{a0}s,", "at", "5", "nodes", "(h\u{a0}=\u{a0}2\u{a0}ms)."]
        );
        assert_eq!(unbroken(" a  b "), " a  b ");
    }
}
