//! The last message, over the scene.

use super::Studio;
use crate::said::Step;
use crate::session::{Request, STEADY};
use crate::shown::{Offer, Severity, Shown};
use crate::words::Part;
use egui::{Align2, Color32, CornerRadius, Frame, RichText, Stroke, Ui};
use opruga::draw::format_value;

/// How long it stays on the screen that something was done [s].
const TOLD_FOR: f64 = 6.0;

impl Studio {
    /// The last message, at the bottom of the scene, with what would help.
    pub(super) fn message(&mut self, ui: &Ui, rect: egui::Rect, shown: &Shown, asks: &mut Vec<Request>) {
        let words = self.language;
        let own = self.canvas.refused.map(|why| match why {
            "crossing" => words.crossing(),
            "only_plane" => words.only_plane(),
            _ => words.too_small(),
        });
        let message = shown.message.as_ref().filter(|message| message.number != self.closed);
        let (text, severity, offer) = match (own, message, self.keeping.message()) {
            (Some(text), ..) => (text.to_string(), Severity::Refused, None),
            (None, Some(message), _) => (words.said(&message.said), message.severity, message.offer.clone()),
            (None, None, Some((said, severity))) => (words.said(said), *severity, None),
            _ => return,
        };
        let takes = message.filter(|_| own.is_none()).and_then(|message| message.frame_seconds);
        let text = match takes {
            Some(seconds) => format!("{text}. {}", words.frame_would_take().replace("{}", &format_value(seconds))),
            None => text,
        };
        let refused = severity == Severity::Refused;
        let now = ui.input(|i| i.time);
        let told = format!("{}: {text}", message.map_or(0, |m| m.number));
        if self.told.0 != told {
            self.told = (told, now);
        }
        if !refused && offer.is_none() && now - self.told.1 > TOLD_FOR {
            return;
        }
        egui::Area::new(egui::Id::unique("message"))
            .pivot(Align2::CENTER_BOTTOM)
            .fixed_pos(rect.center_bottom() - egui::vec2(0.0, if shown.beside.is_some() { 66.0 } else { 40.0 }))
            .order(egui::Order::Middle)
            .show(ui.ctx(), |ui| {
                let edge = if refused { Color32::from_rgb(214, 80, 60) } else { Color32::from_rgb(60, 140, 110) };
                Frame::popup(ui.style()).stroke(Stroke::new(1.5, edge)).corner_radius(CornerRadius::same(6)).show(
                    ui,
                    |ui| {
                        ui.set_max_width((rect.width() - 120.0).clamp(120.0, 620.0));
                        let lines: Vec<&str> = text.lines().collect();
                        let short = lines.iter().take(8).copied().collect::<Vec<_>>().join("\n");
                        let monospaced = lines.len() > 1;
                        let text = RichText::new(if monospaced { short } else { unbroken(&short) });
                        ui.label(if monospaced { text.monospace().size(11.5) } else { text });
                        ui.horizontal(|ui| {
                            if let Some(offer) = &offer {
                                let name = match offer {
                                    Offer::HalveStep => words.halve_step().to_string(),
                                    Offer::Steady(_) => {
                                        words.take_steady().replace("{}", &words.kind(Part::Integrator, STEADY))
                                    }
                                    Offer::Substeps(n) => words.use_substeps().replace("{}", &n.to_string()),
                                    Offer::Coarser(_, field, value) => {
                                        let field = words.done(&Step::Shape(field));
                                        words.take_coarser().replace("{}", &format!("{field} {value}"))
                                    }
                                    Offer::GoOn => words.go_on().to_string(),
                                };
                                if ui.button(name).clicked() {
                                    asks.push(Request::Accept(offer.clone()));
                                    self.closed = message.map_or(self.closed, |m| m.number);
                                }
                            }
                            // What made it fail may have been the last change.
                            if matches!(offer, Some(Offer::HalveStep | Offer::Steady(_)))
                                && let Some(step) = &shown.undo
                                && ui.button(format!("{} ({})", words.undo(), words.done(step))).clicked()
                            {
                                asks.push(Request::Undo);
                                self.closed = message.map_or(self.closed, |m| m.number);
                            }
                            if ui.button(words.close()).clicked() {
                                if own.is_some() {
                                    self.canvas.refused = None;
                                } else if let Some(message) = message {
                                    self.closed = message.number;
                                } else {
                                    self.keeping.forget_message();
                                }
                            }
                        });
                    },
                );
            });
    }
}

/// Units that stand behind numbers in messages.
const UNITS: [&str; 12] = ["s", "ms", "m", "kg", "N", "J", "Pa", "Hz", "%", "rad/s", "m/s", "N/m"];

/// The same with what belongs together held on one line: a letter, its sign of equality and its number, a number and its unit.
fn unbroken(text: &str) -> String {
    let mut whole = String::with_capacity(text.len() + 8);
    let mut last = "";
    for (place, word) in text.split(' ').enumerate() {
        let unit = word.trim_end_matches(['.', ',', ';', ':', ')']);
        let together =
            word == "=" || last == "=" || last.ends_with(|c: char| c.is_ascii_digit()) && UNITS.contains(&unit);
        if place > 0 {
            whole.push(if together { '\u{a0}' } else { ' ' });
        }
        whole.push_str(word);
        last = word;
    }
    whole
}

#[cfg(test)]
mod tests {
    use super::unbroken;

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
