//! How long frames of the window take: `opruga-studio SCENE --measure-frames N` shows them, prints what it has seen and ends.

use crate::app::Studio;
use crate::session::Request;
use eframe::egui::{Context, Ui, ViewportCommand};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

/// Frames before any is counted: fonts, textures and the first build of everything.
const WARM_UP: usize = 60;

/// The name of the graphics driver, which the painter of the window tells its log and nobody else.
static ADAPTER: Mutex<String> = Mutex::new(String::new());

struct Ear;

impl log::Log for Ear {
    fn enabled(&self, about: &log::Metadata<'_>) -> bool {
        about.target().starts_with("egui_glow")
    }
    fn log(&self, record: &log::Record<'_>) {
        let text = record.args().to_string();
        if let Some(name) = text.lines().find_map(|line| line.strip_prefix("opengl renderer: ")) {
            *ADAPTER.lock().unwrap_or_else(PoisonError::into_inner) = name.to_string();
        }
    }
    fn flush(&self) {}
}

/// Begins to listen for the name of the graphics driver.
pub fn listen() {
    if log::set_logger(&Ear).is_ok() {
        log::set_max_level(log::LevelFilter::Debug);
    }
}

/// The processor time of this thread [ms]; where the system does not tell it, the time that has passed.
fn processor_time(begin: Instant) -> f64 {
    // The system counts when a thread gives way.
    std::thread::yield_now();
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = told.and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(|| 1e3 * begin.elapsed().as_secs_f64(), |ns| 1e-6 * ns)
}

/// What was measured of one frame [ms].
#[derive(Clone, Copy, Debug)]
struct Frame {
    /// What passes from the beginning of the frame before to that of this one.
    whole: f64,
    /// Processor time of panels and scene, up to the shapes that are to be drawn.
    interface: f64,
    /// Processor time of the whole thread: these, the triangles made of the shapes, and what the driver does in it.
    thread: f64,
}

/// The window, with a watch in its hand.
pub struct Measured {
    studio: Studio,
    frames: Vec<Frame>,
    wanted: usize,
    begin: Instant,
    last: Option<(Instant, f64)>,
    report: Arc<Mutex<String>>,
}

impl Measured {
    /// Measures so many frames while time passes; the report is there when the window has closed.
    pub fn new(studio: Studio, wanted: usize, report: &Arc<Mutex<String>>) -> Measured {
        studio.ask(Request::Play(true));
        let report = Arc::clone(report);
        Measured { studio, frames: Vec::new(), wanted, begin: Instant::now(), last: None, report }
    }

    fn close(&self, context: &Context) {
        let shown = self.studio.shown();
        let nodes: usize = shown.bodies.iter().map(|body| body.nodes).sum();
        let counted = self.frames.get(WARM_UP..).unwrap_or_default();
        let ends = |of: fn(&Frame) -> f64| {
            let mut times: Vec<f64> = counted.iter().map(of).collect();
            times.sort_by(f64::total_cmp);
            let at = |share: f64| times.get(((times.len().max(1) - 1) as f64 * share).round() as usize).copied();
            format!("{:.2} / {:.2}", at(0.5).unwrap_or(f64::NAN), at(0.99).unwrap_or(f64::NAN))
        };
        let adapter = ADAPTER.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let text = format!(
            "scene {}, {} bodies, {nodes} vertices, {} frames of the window, {adapter}\n\
             median / 99th percentile in ms: interface {}, its thread {}, frame {}; simulated over real time {:.2}",
            shown.name,
            shown.bodies.len(),
            counted.len(),
            ends(|f| f.interface),
            ends(|f| f.thread),
            ends(|f| f.whole),
            shown.pace.ratio,
        );
        *self.report.lock().unwrap_or_else(PoisonError::into_inner) = text;
        context.send_viewport_cmd(ViewportCommand::Close);
    }
}

impl eframe::App for Measured {
    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        let (now, before) = (Instant::now(), processor_time(self.begin));
        self.studio.show(ui);
        let after = processor_time(self.begin);
        if let Some((last, thread)) = self.last.replace((now, before)) {
            let whole = 1e3 * now.duration_since(last).as_secs_f64();
            self.frames.push(Frame { whole, interface: after - before, thread: before - thread });
        }
        if self.frames.len() >= self.wanted + WARM_UP {
            self.close(ui.ctx());
        }
        ui.ctx().request_repaint();
    }
}
