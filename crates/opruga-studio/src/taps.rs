//! Handles presses that end before the next picture. If a screen draws rarely, both the press and the release arrive with the same picture, and
//! sliders do not notice them. The release of such a press is therefore delayed until the next picture.

use egui::{Context, Event, Plugin, PointerButton, RawInput};

/// The longest duration \[s\] that is assumed for a press that began and ended within one picture. The press therefore counts as a click, however
/// long the picture took.
const TAP: f64 = 0.125;

/// The events that wait for the next picture.
#[derive(Debug, Default)]
pub(crate) struct Taps {
    later: Vec<Event>,
    /// The time [s] at which a press began if its release waits for the next picture; none if no release waits.
    pressed: Option<f64>,
}

/// The index of the first release among the events whose press is also among them.
fn end_of_tap(events: &[Event]) -> Option<usize> {
    let mut down: Vec<PointerButton> = Vec::new();
    events.iter().position(|event| {
        let Event::PointerButton { button, pressed, .. } = event else { return false };
        if *pressed {
            down.push(*button);
        }
        !*pressed && down.contains(button)
    })
}

impl Plugin for Taps {
    fn debug_name(&self) -> &'static str {
        "taps"
    }

    fn input_hook(&mut self, context: &Context, input: &mut RawInput) {
        if let (Some(pressed), Some(now)) = (self.pressed.take(), input.time) {
            input.time = Some(now.min(pressed + TAP));
        }
        let mut events = std::mem::take(&mut self.later);
        events.append(&mut input.events);
        if let Some(end) = end_of_tap(&events) {
            self.later = events.split_off(end);
            self.pressed = input.time;
            context.request_repaint();
        }
        input.events = events;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Modifiers, pos2};

    #[test]
    fn the_end_of_a_press_that_begins_with_the_same_picture_comes_with_the_next_one() {
        let context = Context::default();
        let at = |x: f32| Event::PointerMoved(pos2(x, 0.0));
        let button = |pressed| Event::PointerButton {
            pos: pos2(1.0, 0.0),
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        };
        let mut taps = Taps::default();
        let mut picture = |events: Vec<Event>, time: f64| {
            let mut input = RawInput { events, time: Some(time), ..RawInput::default() };
            taps.input_hook(&context, &mut input);
            (input.events, input.time.expect("a time"))
        };
        let two = vec![at(1.0), button(true), at(2.0), button(false), at(3.0), button(true), button(false)];
        assert_eq!(picture(two.clone(), 5.0), (two[..3].to_vec(), 5.0));
        // The picture took two seconds.
        assert_eq!(picture(vec![at(4.0)], 7.0), (two[3..6].to_vec(), 5.125));
        assert_eq!(picture(vec![], 7.1), (vec![button(false), at(4.0)], 5.25));
        // A longer press is not changed.
        for (events, time) in [(vec![button(true)], 8.0), (vec![at(5.0), button(false)], 9.0), (vec![], 10.0)] {
            assert_eq!(picture(events.clone(), time), (events, time));
        }
    }
}
