//! Measures how long frames of the window take. `opruga-studio SCENE --measure-frames N` shows N frames, prints the result and ends. On a web page,
//! call `opruga.measure(N)`, or open the page with `?measure=N`.

use crate::shown::Shown;

/// The number of frames at the start that are not measured, because they also prepare fonts and textures.
const WARM_UP: usize = 60;

/// The measurements of one frame [ms].
#[derive(Clone, Copy, Debug, PartialEq)]
struct Frame {
    /// The time from the beginning of the previous frame to the beginning of this one.
    whole: f64,
    /// The computation of the panels and the scene, up to the shapes to be drawn.
    interface: f64,
    /// The triangulation of these shapes, if it was measured separately.
    triangles: f64,
    /// The simulation, if it does not have its own thread.
    simulation: f64,
    /// All work of the thread: the work of the parts above, and the work of the driver in this thread.
    thread: f64,
}

/// The measurements of a number of frames.
#[derive(Clone, Debug)]
pub struct Watch {
    frames: Vec<Frame>,
    wanted: usize,
    last: Option<f64>,
}

impl Watch {
    /// Measures `wanted` frames after the warm-up.
    pub fn new(wanted: usize) -> Watch {
        Watch { frames: Vec::new(), wanted: wanted.max(1), last: None }
    }

    /// Adds a frame that began at the time `begin`, with the times of its interface and its simulation. `triangles` and `thread` are the times of the
    /// previous frame [ms].
    pub fn add(&mut self, begin: f64, interface: f64, triangles: f64, simulation: f64, thread: f64) {
        if let Some(last) = self.last.replace(begin) {
            self.frames.push(Frame { whole: begin - last, interface, triangles, simulation, thread });
        }
    }

    /// Whether all frames have been measured.
    pub fn is_done(&self) -> bool {
        self.frames.len() >= self.wanted + WARM_UP
    }

    /// Median and 99th percentile of the measurements.
    pub fn report(&self, shown: &Shown) -> String {
        let nodes: usize = shown.bodies.iter().map(|body| body.nodes).sum();
        let counted = self.frames.get(WARM_UP..).unwrap_or_default();
        let ends = |of: fn(&Frame) -> f64| {
            let mut times: Vec<f64> = counted.iter().map(of).collect();
            times.sort_by(f64::total_cmp);
            let at = |share: f64| times.get(((times.len().max(1) - 1) as f64 * share).round() as usize).copied();
            format!("{:.2} / {:.2}", at(0.5).unwrap_or(f64::NAN), at(0.99).unwrap_or(f64::NAN))
        };
        let where_known = |name: &str, of: fn(&Frame) -> f64| match counted.iter().any(|frame| of(frame) > 0.0) {
            true => format!("{name} {}, ", ends(of)),
            false => String::new(),
        };
        let triangles = where_known("triangles", |f| f.triangles);
        let simulation = where_known("simulation", |f| f.simulation);
        format!(
            "scene {}, {} bodies, {nodes} vertices, {} frames of the window\n\
             median / 99th percentile in ms: interface {}, {triangles}{simulation}its thread {}, frame {}; \
             simulated over real time {:.2}",
            shown.name,
            shown.bodies.len(),
            counted.len(),
            ends(|f| f.interface),
            ends(|f| f.thread),
            ends(|f| f.whole),
            shown.pace.ratio,
        )
    }
}

#[cfg(not(target_arch = "wasm32"))]
pub use native::{Measured, listen};

#[cfg(not(target_arch = "wasm32"))]
mod native {
    use super::Watch;
    use crate::app::Studio;
    use crate::session::Request;
    use eframe::egui::{Context, FullOutput, Plugin, Ui, ViewportCommand};
    use std::sync::{Arc, Mutex, PoisonError};
    use std::time::Instant;

    /// The name of the graphics driver, which the painter of the window reports only to the log.
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

    /// Begins to watch the log for the name of the graphics driver.
    pub fn listen() {
        if log::set_logger(&Ear).is_ok() {
            log::set_max_level(log::LevelFilter::Debug);
        }
    }

    /// The processor time of this thread [ms]; if the system does not provide it, the elapsed time.
    fn processor_time(begin: Instant) -> f64 {
        // The thread yields because the system then updates the processor time of the thread.
        std::thread::yield_now();
        let statistics = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
        let nanoseconds = statistics.and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok());
        nanoseconds.map_or_else(|| 1e3 * begin.elapsed().as_secs_f64(), |ns| 1e-6 * ns)
    }

    /// Triangulates every frame once more than necessary, to measure how long this takes [ms].
    struct Triangles(Arc<Mutex<f64>>, Instant);

    impl Plugin for Triangles {
        fn debug_name(&self) -> &'static str {
            "triangles"
        }

        fn output_hook(&mut self, context: &Context, output: &mut FullOutput) {
            let shapes = output.shapes.clone();
            let before = processor_time(self.1);
            drop(context.tessellate(shapes, output.pixels_per_point));
            *self.0.lock().unwrap_or_else(PoisonError::into_inner) = processor_time(self.1) - before;
        }
    }

    /// The window with its measurements.
    pub struct Measured {
        studio: Studio,
        watch: Watch,
        begin: Instant,
        /// Processor time of the thread when the last frame began [ms].
        last: f64,
        /// The time of the triangulation of the last frame [ms].
        triangles: Arc<Mutex<f64>>,
        report: Arc<Mutex<String>>,
    }

    impl Measured {
        /// Measures a number of frames while the simulation plays; the report is available when the window has closed.
        pub fn new(studio: Studio, context: &Context, wanted: usize, report: &Arc<Mutex<String>>) -> Measured {
            studio.ask(Request::Play(true));
            let (report, triangles, begin) = (Arc::clone(report), Arc::default(), Instant::now());
            context.add_plugin(Triangles(Arc::clone(&triangles), begin));
            Measured { studio, watch: Watch::new(wanted), begin, last: 0.0, triangles, report }
        }

        fn close(&self, context: &Context) {
            let adapter = ADAPTER.lock().unwrap_or_else(PoisonError::into_inner).clone();
            let text = format!("{}\ndrawn by {adapter}", self.watch.report(&self.studio.shown()));
            *self.report.lock().unwrap_or_else(PoisonError::into_inner) = text;
            context.send_viewport_cmd(ViewportCommand::Close);
        }
    }

    impl eframe::App for Measured {
        fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
            let (now, before) = (1e3 * self.begin.elapsed().as_secs_f64(), processor_time(self.begin));
            self.studio.show(ui);
            let after = processor_time(self.begin);
            let triangles = *self.triangles.lock().unwrap_or_else(PoisonError::into_inner);
            self.watch.add(now, after - before, triangles, 0.0, before - self.last - triangles);
            self.last = before;
            if self.watch.is_done() {
                self.close(ui.ctx());
            }
            ui.ctx().request_repaint();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_frames_are_not_counted_and_the_middle_and_the_slow_end_of_the_others_are_told() {
        let mut watch = Watch::new(101);
        for k in 0..=WARM_UP {
            watch.add(1000.0 * k as f64, 500.0, 7.0, 0.0, 900.0);
        }
        let begin = 1000.0 * WARM_UP as f64;
        for k in 1..=101 {
            assert!(!watch.is_done());
            watch.add(begin + 20.0 * f64::from(k), f64::from(102 - k), 0.0, 0.0, 3.0);
        }
        assert!(watch.is_done());
        let report = watch.report(&Shown::default());
        assert!(report.contains("interface 51.00 / 100.00, its thread 3.00 / 3.00, frame 20.00 / 20.00"), "{report}");
    }
}
