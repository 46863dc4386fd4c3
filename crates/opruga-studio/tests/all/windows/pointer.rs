//! The actions of the pointer on the scene.

use super::screen::window::{SIZE, Window, top_of};
use egui::{Event, Key, Modifiers, PointerButton, Pos2, Vec2};
use egui_kittest::kittest::Queryable;
use opruga_studio::session::Request;

#[test]
fn the_ball_is_pulled_by_the_pointer_and_a_rubber_line_shows_the_force() {
    let mut window = Window::open("ball", SIZE);
    let top = top_of(&window);
    window.pointer(top);
    window.button(top, PointerButton::Primary, true, Modifiers::NONE);
    window.pointer(top + Vec2::new(60.0, -40.0));
    for _ in 0..6 {
        window.click("Step");
        window.harness.event(Event::PointerMoved(top + Vec2::new(60.0, -40.0)));
    }
    // Pressing a button of the window has released the ball: the pull is recorded from its beginning to its end.
    window.until("a pull was recorded", |shown| shown.recorded == 1 && shown.frames >= 6);
    let mut window = Window::open("ball", SIZE);
    window.pointer(top);
    window.button(top, PointerButton::Primary, true, Modifiers::NONE);
    window.pointer(top + Vec2::new(60.0, -40.0));
    for _ in 0..12 {
        window.studio().ask(Request::Step);
    }
    window.until("the pull acts", |shown| shown.pulls.len() == 1 && shown.frames == 12);
    let [_, pointer, force] = window.shown().pulls[0];
    let newtons = force.iter().map(|f| f * f).sum::<f64>().sqrt();
    assert!(newtons > 0.1 && pointer[0] > 0.2 && pointer[1] > 2.5, "{pointer:?} {force:?}");
    window.button(top, PointerButton::Primary, false, Modifiers::NONE);
    window.studio().ask(Request::Step);
    window.until("it was let go", |shown| shown.pulls.is_empty() && shown.frames == 13);
}

/// If a screen draws rarely, a press arrives together with the movement of the pointer after it.
#[test]
fn a_body_is_held_where_it_was_pressed_however_far_the_pointer_has_gone_until_the_next_picture() {
    let mut window = Window::open("ball", SIZE);
    let top = top_of(&window);
    let far = top + Vec2::new(240.0, -60.0);
    window.pointer(top + Vec2::new(0.0, 200.0));
    let press =
        Event::PointerButton { pos: top, button: PointerButton::Primary, pressed: true, modifiers: Modifiers::NONE };
    window.harness.input_mut().events.extend([Event::PointerMoved(top), press, Event::PointerMoved(far)]);
    window.frames(2);
    window.studio().ask(Request::Step);
    window.studio().ask(Request::Step);
    window.until("the ball is held", |shown| shown.pulls.len() == 1 && shown.frames == 2);
    window.button(far, PointerButton::Primary, false, Modifiers::NONE);
    window.until("it is let go", |shown| shown.recorded == 1);
}

#[test]
fn outlines_become_bodies_and_those_that_cross_themselves_are_refused_with_a_reason() {
    let mut window = Window::open("ball", SIZE);
    window.key(Modifiers::NONE, Key::Num5);
    let middle = window.canvas().center() + Vec2::new(180.0, 60.0);
    let line = |of: &dyn Fn(f32) -> Vec2| -> Vec<Pos2> {
        (0..80).map(|k| middle + of(k as f32 / 80.0 * std::f32::consts::TAU)).collect()
    };
    window.drag(&line(&|t| 70.0 * Vec2::new(t.cos(), 0.7 * t.sin())), PointerButton::Primary, Modifiers::NONE);
    window.until("a drawn body", |shown| shown.bodies.len() == 2 && shown.bodies[1].name == "drawn");
    // Later actions apply to the new body.
    assert!(window.harness.query_by_label("drawn").is_some());
    window.drag(&line(&|t| 70.0 * Vec2::new(t.sin(), (2.0 * t).sin())), PointerButton::Primary, Modifiers::NONE);
    assert!(window.harness.query_by_label_contains("crosses itself").is_some());
    assert_eq!(window.shown().bodies.len(), 2);
}

/// A slow screen receives the whole path of the pointer with one picture; it may run in either direction.
#[test]
fn an_outline_that_comes_with_one_picture_keeps_its_corners() {
    for clockwise in [false, true] {
        let mut window = Window::open("ball", SIZE);
        window.key(Modifiers::NONE, Key::Num5);
        let middle = window.canvas().center() + Vec2::new(180.0, 60.0);
        let mut corners = [(-70.0, -70.0), (70.0, -70.0), (70.0, 70.0), (-70.0, 70.0)].map(|(x, y)| Vec2::new(x, y));
        // On the screen y points downwards: this order is clockwise as seen.
        if !clockwise {
            corners.reverse();
        }
        let corners = corners.map(|corner| middle + corner);
        window.pointer(corners[0]);
        let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
        let press = |pos, pressed| Event::PointerButton { pos, button, pressed, modifiers };
        let mut events = vec![press(corners[0], true)];
        events.extend(corners[1..].iter().map(|corner| Event::PointerMoved(*corner)));
        events.push(press(corners[3], false));
        window.harness.input_mut().events.extend(events);
        window.frames(2);
        window.until("a drawn body", |shown| shown.bodies.len() == 2);
        let shown = window.shown();
        let outline: Vec<Pos2> =
            shown.picture.bodies[1].positions.iter().filter_map(|p| window.studio().on_screen(*p)).collect();
        for corner in corners {
            let far = outline.iter().map(|at| at.distance(corner)).fold(f32::MAX, f32::min);
            assert!(far < 12.0, "{corner}: {far}");
        }
        assert!(shown.warnings.iter().all(|warning| warning.code != "shape.flipped"), "{:?}", shown.warnings);
    }
}

#[test]
fn pins_pushes_and_moves_are_done_by_the_pointer_and_written_down() {
    let mut window = Window::open("ball", SIZE);
    let top = top_of(&window);
    window.drag(&[top], PointerButton::Primary, Modifiers::SHIFT);
    window.until("a pin", |shown| shown.pins.len() == 1);
    for _ in 0..2 {
        window.button(top, PointerButton::Primary, true, Modifiers::NONE);
        window.button(top, PointerButton::Primary, false, Modifiers::NONE);
    }
    window.until("no pin", |shown| shown.pins.is_empty());
    window.key(Modifiers::COMMAND, Key::Z);
    window.studio().ask(Request::Reset);
    window.until("the start", |shown| shown.frames == 0 && shown.recorded == 0);
    window.click("Move");
    let there = top + Vec2::new(80.0, 0.0);
    window.drag(&[top, top + Vec2::new(40.0, 0.0), there], PointerButton::Primary, Modifiers::NONE);
    window.until("it was moved", |shown| shown.picture.bodies[0].positions[9][0] > 0.2);
    assert_eq!(window.shown().recorded, 0, "at the start it is written into the scene");
}

#[test]
fn a_selected_body_is_turned_and_scaled_by_its_handles_copied_and_looked_at() {
    let mut window = Window::open("ball", SIZE);
    window.click("Move");
    let shown = window.shown();
    let spots: Vec<Pos2> =
        shown.picture.bodies[0].positions.iter().filter_map(|p| window.studio().on_screen(*p)).collect();
    let around = egui::Rect::from_points(&spots).expand(8.0);
    // The corner of the box moves to one and a half times its distance from the centre.
    let corner = around.right_bottom();
    let out = around.center() + 1.5 * (corner - around.center());
    window.drag(&[corner, corner + Vec2::splat(3.0), out], PointerButton::Primary, Modifiers::NONE);
    let width = |shown: &opruga_studio::shown::Shown| {
        let xs = shown.picture.bodies[0].positions.iter().map(|p| p[0]);
        xs.clone().fold(f64::MIN, f64::max) - xs.fold(f64::MAX, f64::min)
    };
    window.until("it has grown", |shown| (width(shown) - 1.5).abs() < 0.02);
    window.key(Modifiers::COMMAND, Key::Z);
    window.until("undone", |shown| (width(shown) - 1.0).abs() < 0.02);
    // The handle above the box, moved to the right of it: a quarter of a turn.
    let node = |shown: &opruga_studio::shown::Shown| shown.picture.bodies[0].positions[0];
    let (before, handle) = (node(&window.shown()), around.center_top() - Vec2::new(0.0, 24.0));
    let right = around.center() + Vec2::new(around.center().y - handle.y, 0.0);
    window.drag(&[handle, handle + Vec2::splat(4.0), right], PointerButton::Primary, Modifiers::NONE);
    window.until("it was turned", |shown| {
        let now = node(shown);
        // Clockwise as seen: what was on the right is at the bottom.
        (now[0] - (before[1] - 2.0)).abs() < 0.03 && (now[1] - 2.0 + before[0]).abs() < 0.03
    });
    window.harness.get_by_label("Duplicate").scroll_to_me();
    window.frames(30);
    window.click("Duplicate");
    window.until("two of them", |shown| shown.bodies.len() == 2);
    let apart = |window: &Window| {
        let at = |p: [f64; 3]| window.studio().on_screen(p).expect("in sight");
        at([0.5, 2.0, 0.0]).distance(at([-0.5, 2.0, 0.0]))
    };
    window.frames(2);
    let before = apart(&window);
    window.click("Focus");
    assert!(apart(&window) > 1.2 * before, "the body fills the window");
}

#[test]
fn a_pin_of_the_scene_is_freed_by_a_double_click() {
    let mut window = Window::open("hanging-net", SIZE);
    let shown = window.shown();
    let (node, count) = (shown.picture.bodies[0].pinned[0], shown.picture.bodies[0].pinned.len());
    let at = window.studio().on_screen(shown.picture.bodies[0].positions[node as usize]).expect("in sight");
    for _ in 0..2 {
        window.button(at, PointerButton::Primary, true, Modifiers::NONE);
        window.button(at, PointerButton::Primary, false, Modifiers::NONE);
    }
    window.studio().ask(Request::Step);
    window.until("one pin fewer", |shown| shown.picture.bodies[0].pinned.len() == count - 1);
    assert!(!window.shown().picture.bodies[0].pinned.contains(&node));
}

/// The view is moved with the space bar held; the order in which the space bar and the pointer are released does not matter.
#[test]
fn the_space_bar_takes_the_view_along_and_lets_time_pass_when_it_is_pressed_by_itself() {
    let mut window = Window::open("ball", SIZE);
    let space = |window: &mut Window, pressed: bool| {
        let (key, modifiers) = (Key::Space, Modifiers::NONE);
        window.harness.event(Event::Key { key, physical_key: None, pressed, repeat: false, modifiers });
        window.frames(1);
    };
    let from = window.canvas().center() + Vec2::new(150.0, 60.0);
    for space_first in [false, true] {
        let before = top_of(&window);
        window.pointer(from);
        space(&mut window, true);
        window.button(from, PointerButton::Primary, true, Modifiers::NONE);
        window.pointer(from + Vec2::new(30.0, 20.0));
        if space_first {
            space(&mut window, false);
        }
        window.button(from + Vec2::new(30.0, 20.0), PointerButton::Primary, false, Modifiers::NONE);
        if !space_first {
            space(&mut window, false);
        }
        window.frames(2);
        assert!((top_of(&window) - before - Vec2::new(30.0, 20.0)).length() < 1.0, "the view went along");
        let shown = window.shown();
        assert!(!shown.playing && shown.recorded == 0, "time stands, and nothing was pulled");
        window.studio().ask(Request::Step);
        window.until("the request after that", |shown| shown.frames == 1 && !shown.playing);
        space(&mut window, true);
        space(&mut window, false);
        window.until("time passes", |shown| shown.playing);
        window.studio().ask(Request::Play(false));
        window.studio().ask(Request::Reset);
        window.until("the start", |shown| shown.frames == 0 && !shown.playing);
    }
}

/// A body of the plane and one of space: the view is moved with the middle button until nothing is visible any more.
#[test]
fn where_no_body_is_in_sight_an_arrow_points_to_them_and_a_press_shows_them() {
    for scene in ["ball", "balloons"] {
        let mut window = Window::open(scene, SIZE);
        window.rest();
        let away = |window: &Window| window.harness.query_by_label_contains("the bodies are this way").is_some();
        assert!(!away(&window), "{scene}");
        let canvas = window.canvas();
        let (low, high) =
            (canvas.left_bottom() + Vec2::new(60.0, -60.0), canvas.right_top() + Vec2::new(-150.0, 120.0));
        for _ in 0..3 {
            window.drag(&[low, low.lerp(high, 0.5), high], PointerButton::Middle, Modifiers::NONE);
        }
        window.rest();
        assert!(away(&window) && !canvas.contains(top_of(&window)), "{scene}");
        window.harness.get_by_label_contains("the bodies are this way").click();
        window.frames(3);
        window.rest();
        assert!(!away(&window) && canvas.contains(top_of(&window)), "{scene}");
    }
}

/// Pressing a body in the past to see its properties does nothing to it.
#[test]
fn while_time_stands_still_a_press_selects_a_body_and_leaves_what_was_recorded() {
    let mut window = Window::open("two-chambers", SIZE);
    for _ in 0..20 {
        window.studio().ask(Request::Step);
    }
    window.until("twenty frames", |shown| shown.frames == 20);
    window.studio().ask(Request::Seek(5));
    window.until("the past", |shown| shown.frames == 5);
    let top = top_of(&window);
    window.pointer(top);
    window.button(top, PointerButton::Primary, true, Modifiers::NONE);
    window.frames(3);
    window.button(top, PointerButton::Primary, false, Modifiers::NONE);
    window.frames(3);
    assert!(window.harness.query_by_role_and_label(egui::Role::Slider, "stiffness [N/m]").is_some(), "its properties");
    let shown = window.shown();
    assert_eq!((shown.recorded, shown.frames, shown.latest), (0, 5, 20));
    // Dragged away, it is pulled, and what was recorded later is replaced.
    window.drag(&[top, top + Vec2::new(10.0, -20.0)], PointerButton::Primary, Modifiers::NONE);
    window.until("a pull", |shown| shown.recorded == 1 && shown.latest == 5);
}

/// A body that is grabbed while time is stopped is pulled from the moment at which time starts, also if something was undone before.
#[test]
fn a_body_that_is_held_is_pulled_when_time_begins_to_pass() {
    for undoes in [false, true] {
        let mut window = Window::open("ball", SIZE);
        let top = top_of(&window);
        if undoes {
            window.drag(&[top, top], PointerButton::Primary, Modifiers::SHIFT);
            window.until("a pin", |shown| shown.recorded == 1);
            window.studio().ask(Request::Undo);
            window.until("that it is undone", |shown| shown.recorded == 0);
        }
        window.pointer(top);
        window.button(top, PointerButton::Primary, true, Modifiers::NONE);
        window.studio().ask(Request::Play(true));
        window.until("a pull", |shown| shown.recorded == 1 && shown.frames > 5);
        window.studio().ask(Request::Play(false));
        window.button(top, PointerButton::Primary, false, Modifiers::NONE);
    }
}

#[test]
fn a_body_of_space_that_is_held_keeps_its_depth_while_the_wheel_brings_the_eye_nearer() {
    let mut window = Window::open("balloons", SIZE);
    window.rest();
    let middle = |body: usize| {
        let positions = &window.shown().picture.bodies[body].positions;
        [0, 1, 2].map(|d| positions.iter().map(|p| p[d]).sum::<f64>() / positions.len() as f64)
    };
    // The body nearest to the centre of the window, to which the wheel zooms.
    let canvas = window.canvas();
    let spot = |body: usize| window.studio().on_screen(middle(body)).expect("in sight");
    let far = |body: &usize| spot(*body).distance(canvas.center());
    let at = spot((0..3).min_by(|a, b| far(a).total_cmp(&far(b))).expect("a body"));
    window.pointer(at);
    window.button(at, PointerButton::Primary, true, Modifiers::NONE);
    let held = at + Vec2::new(0.0, -12.0);
    let pulled = |window: &mut Window, frames: u64| {
        let until = window.shown().frames + frames;
        for _ in 0..frames {
            window.pointer(held);
            window.studio().ask(Request::Step);
        }
        window.until("time passes", |shown| shown.frames == until && shown.pulls.len() == 1);
        window.rest();
        window.shown().pulls[0][1]
    };
    let before = pulled(&mut window, 5);
    let (delta, modifiers) = (Vec2::new(0.0, 120.0), Modifiers::NONE);
    let (unit, phase, source) = (egui::MouseWheelUnit::Point, egui::TouchPhase::Move, egui::MouseWheelSource::Wheel);
    window.harness.event(Event::MouseWheel { unit, delta, phase, modifiers, source });
    window.frames(40);
    window.rest();
    let after = pulled(&mut window, 5);
    let way: f64 = before.iter().zip(after).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
    // The camera has moved metres closer.
    assert!(way < 0.6, "{way} m: {before:?} {after:?}");
    let drawn = window.studio().on_screen(after).expect("in sight");
    assert!(drawn.distance(held) < 3.0, "the handle is under the pointer: {drawn:?} {held:?}");
}

#[test]
fn a_body_from_the_menu_comes_to_the_pointer_and_into_no_other_one() {
    let mut window = Window::open("ball", SIZE);
    for count in 2..6 {
        window.click("Add");
        // The name of the body that was added last is also shown next to the scene.
        let canvas = window.canvas();
        let entries: Vec<Pos2> = window.harness.get_all_by_label("jelly").map(|entry| entry.rect().center()).collect();
        let at = entries.into_iter().find(|at| canvas.contains(*at)).expect("an entry of the menu");
        window.pointer(at);
        for pressed in [true, false] {
            window.button(at, PointerButton::Primary, pressed, Modifiers::NONE);
        }
        window.until("one body more", |shown| shown.bodies.len() == count);
        let boxes: Vec<egui::Rect> = window
            .shown()
            .extents
            .iter()
            .map(|extent| {
                let corner = |k: usize| window.studio().on_screen(extent.corners[k]).expect("a place");
                egui::Rect::from_two_pos(corner(0), corner(1))
            })
            .collect();
        if count == 2 {
            assert!(boxes[1].contains(at), "{at:?}: {boxes:?}");
        }
        for (place, one) in boxes.iter().enumerate() {
            assert!(boxes[..place].iter().all(|other| !one.intersects(*other)), "{boxes:?}");
        }
    }
}

#[test]
fn a_reset_shows_the_scene_as_it_was_at_first_wherever_the_view_was_taken() {
    for scene in ["ball", "balloons"] {
        let mut window = Window::open(scene, SIZE);
        window.rest();
        let first = top_of(&window);
        window.studio().ask(Request::Step);
        let canvas = window.canvas();
        let from = canvas.left_bottom() + Vec2::new(60.0, -60.0);
        window.drag(&[from, from + Vec2::new(300.0, -200.0)], PointerButton::Middle, Modifiers::NONE);
        window.rest();
        assert!(top_of(&window).distance(first) > 100.0, "{scene}");
        window.click("Reset");
        window.until("the start", |shown| shown.frames == 0 && shown.resets == 1);
        window.rest();
        assert!(top_of(&window).distance(first) < 2.0, "{scene}: {:?} {first:?}", top_of(&window));
    }
}
