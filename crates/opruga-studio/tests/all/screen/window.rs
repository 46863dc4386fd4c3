//! The window of the studio without a screen, and actions of a user on it.

use super::{Screen, Textures};
use egui::{Event, Key, Modifiers, PointerButton, Pos2, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use opruga::Options;
use opruga_studio::app::Studio;
use opruga_studio::session::Session;
use opruga_studio::shown::Shown;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The size of a small laptop [points].
pub(crate) const SIZE: [f32; 2] = [1280.0, 720.0];

/// The longest time for anything, on a busy machine.
const PATIENCE: Duration = Duration::from_secs(240);

/// A window on a scene.
pub(crate) struct Window {
    pub(crate) harness: Harness<'static, Option<Studio>>,
    pub(crate) textures: Textures,
}

impl Window {
    pub(crate) fn open(scene: &str, size: [f32; 2]) -> Window {
        Window::open_at(scene, size, 1.0)
    }

    /// A window on a screen with this number of pixels per point.
    pub(crate) fn open_at(scene: &str, size: [f32; 2], fine: f32) -> Window {
        let text = opruga::scenes::find(scene).expect("a scene of the program");
        let session = Session::open(scene, text, opruga::scenes::files(), Options::default()).expect("it opens");
        Window::on(session, size, fine)
    }

    /// A window on a session.
    pub(crate) fn on(session: Session, size: [f32; 2], fine: f32) -> Window {
        let textures = Textures::default();
        let mut session = Some(session);
        let show = move |ui: &mut egui::Ui, studio: &mut Option<Studio>| {
            if let Some(session) = session.take() {
                *studio = Some(Studio::new(session, ui.ctx()).expect("a thread"));
            }
            studio.as_mut().expect("a window").show(ui);
        };
        let harness = Harness::builder()
            .with_size(Vec2::from(size))
            .with_pixels_per_point(fine)
            .with_step_dt(1.0 / 60.0)
            .renderer(textures.clone())
            .build_ui_state(show, None);
        let mut window = Window { harness, textures };
        window.frames(3);
        window
    }

    pub(crate) fn frames(&mut self, count: usize) {
        (0..count).for_each(|_| self.harness.step());
    }

    pub(crate) fn studio(&self) -> &Studio {
        self.harness.state().as_ref().expect("a window")
    }

    pub(crate) fn shown(&self) -> Arc<Shown> {
        self.studio().shown()
    }

    /// Shows frames until a condition holds.
    pub(crate) fn until(&mut self, what: &str, holds: impl Fn(&Shown) -> bool) {
        let begin = Instant::now();
        while !holds(&self.shown()) {
            if begin.elapsed() > PATIENCE {
                let Shown { name, frames, playing, message, .. } = &*self.shown();
                panic!("{what}: {name}, frame {frames}, playing {playing}, {message:?}");
            }
            std::thread::sleep(Duration::from_millis(2));
            self.frames(1);
        }
        self.frames(2);
    }

    /// Shows frames until other threads draw nothing any more.
    pub(crate) fn rest(&mut self) {
        let begin = Instant::now();
        self.frames(2);
        while self.studio().is_drawing() {
            assert!(begin.elapsed() < PATIENCE, "it is still drawing");
            std::thread::sleep(Duration::from_millis(2));
            self.frames(1);
        }
        self.frames(2);
    }

    pub(crate) fn click(&mut self, label: &str) {
        self.harness.get_by_label(label).click();
        self.frames(3);
    }

    /// The area of the scene.
    pub(crate) fn canvas(&self) -> egui::Rect {
        self.harness.get_by_label("canvas").rect()
    }

    pub(crate) fn pointer(&mut self, at: Pos2) {
        self.harness.event(Event::PointerMoved(at));
        self.frames(1);
    }

    pub(crate) fn button(&mut self, at: Pos2, button: PointerButton, pressed: bool, modifiers: Modifiers) {
        self.harness.event_modifiers(Event::PointerButton { pos: at, button, pressed, modifiers }, modifiers);
        self.frames(1);
    }

    pub(crate) fn drag(&mut self, path: &[Pos2], button: PointerButton, modifiers: Modifiers) {
        self.pointer(path[0]);
        self.button(path[0], button, true, modifiers);
        for at in path {
            self.pointer(*at);
        }
        let last = path[path.len() - 1];
        self.button(last, button, false, modifiers);
        self.frames(2);
    }

    pub(crate) fn key(&mut self, modifiers: Modifiers, key: Key) {
        self.harness.key_press_modifiers(modifiers, key);
        self.frames(3);
    }

    pub(crate) fn picture(&self) -> Screen {
        Screen::of(&self.harness, &self.textures)
    }
}

/// The position of the highest node of the first body in the window.
pub(crate) fn top_of(window: &Window) -> Pos2 {
    let shown = window.shown();
    let positions = &shown.picture.bodies[0].positions;
    let top = positions.iter().copied().max_by(|a, b| a[1].total_cmp(&b[1])).expect("a node");
    window.studio().on_screen(top).expect("in sight")
}
