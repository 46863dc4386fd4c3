//! The studio on a web page: its start, and the functions that the page around it can call.

use crate::app::{FIRST_SCENE, Studio};
use crate::document::Document;
use crate::engine;
use crate::measure::Watch;
use crate::preferences::Store;
use crate::report::Report;
use crate::runner::Copied;
use crate::session::{self, Request, Session};
use crate::setting::Setting;
use crate::share;
use crate::{browser, shown::Severity};
use eframe::{Renderer, WebOptions, WebRunner};
use egui::accesskit::Node;
use egui::{Context, FullOutput, Ui};
use opruga::io::scene;
use opruga::{Options, WorldError};
use std::cell::{RefCell, RefMut};
use std::collections::HashMap;
use std::rc::Rc;
use std::sync::{Arc, Mutex, PoisonError};
use wasm_bindgen::prelude::*;

/// The time [s] that a frame may take before the user is asked whether to wait for it. The limit is below five seconds, after which browsers offer to
/// close a page that does not respond.
const PATIENCE: f64 = 2.0;

/// The studio on a canvas of a page. The studio outlives its graphics device, which may be lost.
#[wasm_bindgen]
pub struct Page {
    studio: Shared,
    screen: RefCell<Screen>,
    named_nodes: NamedNodes,
}

impl core::fmt::Debug for Page {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("Page")
    }
}

/// The surface and device on which the studio is drawn.
struct Screen {
    runner: WebRunner,
    context: Context,
}

/// The studio and the measurement of its pictures, independent of the device.
#[derive(Clone)]
struct Shared(Rc<RefCell<(Studio, Option<Watch>)>>);

impl eframe::App for Shared {
    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        let (studio, watch) = &mut *self.0.borrow_mut();
        let begin = browser::milliseconds();
        studio.link().turn();
        let turned = browser::milliseconds();
        studio.show(ui);
        if let Some(watch) = watch.as_mut().filter(|watch| !watch.is_done()) {
            let interface = browser::milliseconds() - turned;
            let thread = 1e3 * f64::from(frame.info().cpu_usage.unwrap_or_default());
            watch.add(begin, interface, 0.0, turned - begin, thread);
            ui.ctx().request_repaint();
        }
    }
}

/// The bounds of all controls that have a name, as reported to screen readers.
#[derive(Clone, Default)]
struct NamedNodes(Arc<Mutex<HashMap<egui::accesskit::NodeId, Node>>>);

impl egui::Plugin for NamedNodes {
    fn debug_name(&self) -> &'static str {
        "places"
    }

    fn output_hook(&mut self, _: &Context, output: &mut FullOutput) {
        if let Some(update) = &output.platform_output.accesskit_update {
            *self.0.lock().unwrap_or_else(PoisonError::into_inner) = update.nodes.iter().cloned().collect();
        }
    }
}

/// Opens the studio on a canvas, with the scene of the address, or with the first scene if there is none or it is refused. `drawn_by` is the
/// renderer, `webgpu` or `webgl`, and `device` is the name of its device.
///
/// # Errors
/// The browser provides no such device.
#[wasm_bindgen]
pub async fn open(canvas: web_sys::HtmlCanvasElement, drawn_by: String, device: String) -> Result<Page, JsValue> {
    let (session, refused) = first_session().map_err(|error| JsValue::from_str(&error.to_string()))?;
    let mut studio = Studio::new(session, &Context::default()).map_err(|e| JsValue::from_str(&e.to_string()))?;
    studio.prefer(Store::Browser, &Context::default());
    studio.ask(Request::Play(true));
    if let Some(refused) = refused {
        studio.report(Severity::Refused, refused);
    }
    let studio = Shared(Rc::new(RefCell::new((studio, None))));
    let named_nodes = NamedNodes::default();
    let screen = Screen::begin(canvas, [&drawn_by, &device], studio.clone(), named_nodes.clone()).await?;
    Ok(Page { studio, screen: RefCell::new(screen), named_nodes })
}

impl Screen {
    /// Begins to draw a studio on a canvas with this renderer and this device.
    async fn begin(
        canvas: web_sys::HtmlCanvasElement,
        [drawn_by, device]: [&str; 2],
        studio: Shared,
        named_nodes: NamedNodes,
    ) -> Result<Screen, JsValue> {
        let runner = WebRunner::new();
        let renderer = if drawn_by == "webgpu" { Renderer::Wgpu } else { Renderer::Glow };
        let drawn_by = [if drawn_by == "webgpu" { "WebGPU" } else { "WebGL 2" }, device].map(String::from);
        let (sender, context) = std::sync::mpsc::channel();
        let begin: eframe::AppCreator<'static> = Box::new(move |creation| {
            studio.0.try_borrow_mut()?.0.move_to(&creation.egui_ctx, drawn_by);
            if let Some(state) = &creation.wgpu_render_state {
                state.device.set_device_lost_callback(|reason, _| {
                    // A device that was released on purpose is not a loss.
                    if reason != wgpu::DeviceLostReason::Destroyed {
                        browser::report_lost_device();
                    }
                });
            }
            creation.egui_ctx.add_plugin(named_nodes);
            let _ = sender.send(creation.egui_ctx.clone());
            Ok(Box::new(studio))
        });
        runner.start(canvas, WebOptions { renderer, ..WebOptions::default() }, begin).await?;
        let context = context.try_recv().map_err(|_| JsValue::from_str("the studio has not begun"))?;
        Ok(Screen { runner, context })
    }
}

/// Opens the scene of the address or, if it is refused, the first scene, and then also returns the reason.
fn first_session() -> Result<(Session, Option<Report>), Report> {
    let open = |name: &str, text: &str, files| {
        let most_bytes = Some(scene::Limits::default().memory_bytes);
        let options = Options { break_off: session::by_the_clock(), most_bytes, ..Options::default() };
        let mut session = Session::open(name, text, files, options)?;
        session.wait_for_frames(PATIENCE);
        Ok(session)
    };
    let opened = share::of_fragment(&browser::fragment()).and_then(|shared| {
        let Some(share::Shared { name, text, files }) = shared else { return Ok(None) };
        open(&name, &text, files).map(Some)
    });
    let refused = match opened {
        Ok(Some(session)) => return Ok((session, None)),
        Ok(None) => None,
        Err(refused) => Some(refused),
    };
    let text = opruga::scenes::find(FIRST_SCENE).unwrap_or_default();
    open(FIRST_SCENE, text, opruga::scenes::files()).map(|session| (session, refused))
}

impl Page {
    /// The studio, unless it has stopped.
    fn studio(&self) -> Option<RefMut<'_, (Studio, Option<Watch>)>> {
        if self.screen.borrow().runner.has_panicked() { None } else { self.studio.0.try_borrow_mut().ok() }
    }

    fn repaint(&self) {
        self.screen.borrow().context.request_repaint();
    }
}

#[wasm_bindgen]
impl Page {
    /// Continues on another canvas in the same state, after the device of the first one was lost.
    ///
    /// # Errors
    /// The browser provides no such device.
    pub async fn go_on(
        &self,
        canvas: web_sys::HtmlCanvasElement,
        drawn_by: String,
        device: String,
    ) -> Result<(), JsValue> {
        self.screen.borrow().runner.destroy();
        let screen = Screen::begin(canvas, [&drawn_by, &device], self.studio.clone(), self.named_nodes.clone()).await?;
        self.screen.replace(screen);
        Ok(())
    }

    /// Writes the whole scene to the address, so that reloading the page opens it. Returns false if the scene is too large.
    pub fn keep(&self) -> bool {
        let Ok(studio) = self.studio.0.try_borrow() else { return false };
        let copied = studio.0.link().with_session(Copied::of);
        let shared = share::Shared { name: copied.name, text: copied.text, files: copied.files };
        share::to_fragment(&shared).and_then(|fragment| browser::set_fragment(&fragment)).is_ok()
    }

    /// Opens the scene that the address names now.
    pub fn follow(&self) {
        let Some(mut studio) = self.studio() else { return };
        match share::of_fragment(&browser::fragment()) {
            Ok(Some(share::Shared { name, text, files })) => studio.0.ask(Request::Open { name, text, files }),
            Ok(None) => {}
            Err(refused) => studio.0.report(Severity::Refused, refused),
        }
        self.repaint();
    }

    /// Opens a scene from its text; errors in it are shown as a message.
    pub fn show(&self, name: String, text: String) {
        if let Some(studio) = self.studio() {
            studio.0.ask(Request::Open { name, text, files: opruga::scenes::files() });
        }
        self.repaint();
    }

    /// Begins to measure a number of pictures of the window.
    pub fn measure(&self, pictures: usize) {
        if let Some(mut studio) = self.studio() {
            studio.1 = Some(Watch::new(pictures));
        }
        self.repaint();
    }

    /// Returns the measurements once they are complete: median and 99th percentile in milliseconds.
    pub fn measured(&self) -> Option<String> {
        let studio = self.studio()?;
        let watch = studio.1.as_ref().filter(|watch| watch.is_done())?;
        Some(watch.report(&studio.0.shown()))
    }

    /// The state of the simulation as JSON: `name`, `time` \[s\], `frames`, `latest`, `playing`, `bodies`, `nodes`, `models` of the first body,
    /// `pulls`, `recorded`, `real_time` (simulated over real time), `frame_milliseconds`, `message`, `state_hash`.
    pub fn state(&self) -> String {
        let Some(studio) = self.studio() else {
            let why = self.screen.borrow().runner.panic_summary().map(|summary| summary.message());
            return serde_json::json!({ "stopped": why }).to_string();
        };
        let shown = studio.0.shown();
        let hash = studio.0.link().with_session(Session::hash);
        let models = shown.bodies.first().map(|body| body.models.iter().map(|m| m.kind()).collect::<Vec<_>>());
        serde_json::json!({
            "name": shown.name, "time": shown.time, "frames": shown.frames, "latest": shown.latest,
            "playing": shown.playing, "bodies": shown.bodies.len(), "models": models,
            "nodes": shown.bodies.iter().map(|body| body.nodes).sum::<usize>(),
            "pulls": shown.pulls.len(), "recorded": shown.recorded, "real_time": shown.pace.ratio,
            "frame_milliseconds": 1e3 * shown.pace.frame_cost,
            "message": shown.message.as_ref().map(|message| message.text.as_str()),
            "state_hash": format!("{hash:016x}"),
        })
        .to_string()
    }

    /// Returns the scene with everything that was done, as `Save` writes it.
    pub fn scene(&self) -> Option<String> {
        Some(self.studio()?.0.link().with_session(|session| Copied::of(session).text))
    }

    /// Goes to a frame of the scene, backwards or forwards.
    pub fn seek(&self, frame: u32) {
        if let Some(studio) = self.studio() {
            studio.0.ask(Request::Play(false));
            studio.0.ask(Request::Seek(frame.into()));
        }
    }

    /// The position of the highest node of a body on the canvas: x, y \[CSS pixels\]; empty if it is not visible.
    pub fn top_of(&self, body: usize) -> Vec<f32> {
        let Some(studio) = self.studio() else { return Vec::new() };
        let shown = studio.0.shown();
        let positions = shown.picture.bodies.get(body).map(|body| body.positions.iter().copied());
        let top = positions.and_then(|all| all.max_by(|a, b| a[1].total_cmp(&b[1])));
        let zoom = self.screen.borrow().context.zoom_factor();
        let spot = top.and_then(|top| studio.0.on_screen(top)).map(|spot| spot * zoom);
        spot.map_or_else(Vec::new, |spot| vec![spot.x, spot.y])
    }

    /// The bounds of a button, a slider or a text with this name: left, top, width and height \[CSS pixels\]; empty if there is none. The first call
    /// finds nothing, because names are collected only from the next picture on.
    pub fn find(&self, name: &str) -> Vec<f32> {
        let context = self.screen.borrow().context.clone();
        context.enable_accesskit();
        context.request_repaint();
        let nodes = self.named_nodes.0.lock().unwrap_or_else(PoisonError::into_inner);
        let named = |node: &&Node| node.label() == Some(name) || node.value() == Some(name);
        let Some(bounds) = nodes.values().filter(named).find_map(Node::bounds) else { return Vec::new() };
        let zoom = f64::from(context.zoom_factor());
        [bounds.x0, bounds.y0, bounds.x1 - bounds.x0, bounds.y1 - bounds.y0].map(|x| (x * zoom) as f32).to_vec()
    }
}

/// Computes the hash of the state of a scene after a number of frames, without a window. The scene is given by its name, if it comes with the
/// program, or by its text.
///
/// # Errors
/// The errors of the scene, or the reason why it does not run.
#[wasm_bindgen]
pub fn hash_after(scene_or_text: &str, frames: u32) -> Result<String, String> {
    let text = opruga::scenes::find(scene_or_text).unwrap_or(scene_or_text);
    let document = Document::new("scene", text).map_err(|report| report.to_string())?;
    let options = scene::Options { files: opruga::scenes::files(), ..scene::Options::default() };
    let setting = Setting::default();
    let read =
        scene::read(document.text().as_bytes(), "scene.toml", &opruga::catalogue_of(&setting.registries), &options);
    let together = |errors: Vec<_>| errors.iter().map(ToString::to_string).collect::<Vec<String>>().join("\n");
    let (blueprint, _) = read.map_err(together)?;
    let refused = |error: WorldError| error.to_string();
    let mut engine = engine::build(blueprint, Vec::new(), &setting).map_err(refused)?;
    for _ in 0..frames {
        engine.frame().map_err(refused)?;
    }
    Ok(format!("{:016x}", engine.hash()))
}
