//! The studio on a web page: how it begins, and what a page around it can ask.

use crate::app::{FIRST_SCENE, Studio};
use crate::document::Document;
use crate::engine;
use crate::runner::Copied;
use crate::session::{Request, Session};
use crate::share::{self, Shared};
use crate::{browser, shown::Severity};
use eframe::{WebOptions, WebRunner};
use egui::accesskit::Node;
use egui::{Context, FullOutput};
use opruga::io::scene;
use opruga::{Options, WorldError};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};
use wasm_bindgen::prelude::*;

/// The studio on a canvas of a page.
#[wasm_bindgen]
pub struct Page {
    runner: WebRunner,
    context: Context,
    places: Places,
}

impl core::fmt::Debug for Page {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("Page")
    }
}

/// Where everything is that has a name, as screen readers are told.
#[derive(Clone, Default)]
struct Places(Arc<Mutex<HashMap<egui::accesskit::NodeId, Node>>>);

impl egui::Plugin for Places {
    fn debug_name(&self) -> &'static str {
        "places"
    }

    fn output_hook(&mut self, _: &Context, output: &mut FullOutput) {
        if let Some(update) = &output.platform_output.accesskit_update {
            *self.0.lock().unwrap_or_else(PoisonError::into_inner) = update.nodes.iter().cloned().collect();
        }
    }
}

/// Opens the studio on a canvas: the scene of the address, or the first one where there is none or it is refused.
///
/// # Errors
/// Where the browser gives no WebGL.
#[wasm_bindgen]
pub async fn open(canvas: web_sys::HtmlCanvasElement) -> Result<Page, JsValue> {
    let (session, refused) = first_session().map_err(|error| JsValue::from_str(&error))?;
    let runner = WebRunner::new();
    let places = Places::default();
    let (sender, context) = std::sync::mpsc::channel();
    let own = places.clone();
    let begin: eframe::AppCreator<'static> = Box::new(move |creation| {
        let mut studio = Studio::new(session, &creation.egui_ctx)?;
        studio.ask(Request::Play(true));
        if let Some(refused) = refused {
            studio.tell(Severity::Refused, refused);
        }
        creation.egui_ctx.add_plugin(own);
        let _ = sender.send(creation.egui_ctx.clone());
        Ok(Box::new(studio))
    });
    runner.start(canvas, WebOptions::default(), begin).await?;
    let context = context.try_recv().map_err(|_| JsValue::from_str("the studio has not begun"))?;
    Ok(Page { runner, context, places })
}

/// The scene of the address; where that is refused, the first scene, and why.
fn first_session() -> Result<(Session, Option<String>), String> {
    let opened = share::of_fragment(&browser::fragment()).and_then(|shared| {
        let Some(Shared { name, text, files }) = shared else { return Ok(None) };
        Session::open(&name, &text, files, Options::default()).map(Some)
    });
    let refused = match opened {
        Ok(Some(session)) => return Ok((session, None)),
        Ok(None) => None,
        Err(refused) => Some(refused),
    };
    let text = opruga::scenes::find(FIRST_SCENE).unwrap_or_default();
    Session::open(FIRST_SCENE, text, opruga::scenes::files(), Options::default()).map(|session| (session, refused))
}

#[wasm_bindgen]
impl Page {
    /// Opens the scene that the address names now.
    pub fn follow(&self) {
        let Some(mut studio) = self.runner.app_mut::<Studio>() else { return };
        match share::of_fragment(&browser::fragment()) {
            Ok(Some(Shared { name, text, files })) => studio.ask(Request::Open { name, text, files }),
            Ok(None) => {}
            Err(refused) => studio.tell(Severity::Refused, refused),
        }
        self.context.request_repaint();
    }

    /// What the simulation says of itself, as JSON: `name`, `time` \[s\], `frames`, `latest`, `playing`, `bodies`, `nodes`,
    /// `models` of the first body, `pulls`, `recorded`, `real_time` (simulated over real time), `frame_milliseconds`,
    /// `message`, `state_hash`.
    pub fn state(&self) -> String {
        let Some(studio) = self.runner.app_mut::<Studio>() else {
            return serde_json::json!({ "stopped": self.runner.panic_summary().map(|summary| summary.message()) })
                .to_string();
        };
        let shown = studio.shown();
        let hash = studio.link().with_session(Session::hash);
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

    /// The scene with all that was done, as `Save` writes it.
    pub fn scene(&self) -> Option<String> {
        Some(self.runner.app_mut::<Studio>()?.link().with_session(|session| Copied::of(session).text))
    }

    /// Goes to a frame of the scene, back or forth.
    pub fn seek(&self, frame: u32) {
        if let Some(studio) = self.runner.app_mut::<Studio>() {
            studio.ask(Request::Play(false));
            studio.ask(Request::Seek(frame.into()));
        }
    }

    /// Where the highest node of a body is on the canvas: x, y \[CSS pixels\]; empty where it is not seen.
    pub fn top_of(&self, body: usize) -> Vec<f32> {
        let Some(studio) = self.runner.app_mut::<Studio>() else { return Vec::new() };
        let shown = studio.shown();
        let positions = shown.picture.bodies.get(body).map(|body| body.positions.iter().copied());
        let top = positions.and_then(|all| all.max_by(|a, b| a[1].total_cmp(&b[1])));
        let spot = top.and_then(|top| studio.on_screen(top)).map(|spot| spot * self.context.zoom_factor());
        spot.map_or_else(Vec::new, |spot| vec![spot.x, spot.y])
    }

    /// Where a button, a slider or a text of this name is: its left, top, width and height \[CSS pixels\]; empty where there
    /// is none. Names are known from the picture after the first question on.
    pub fn find(&self, name: &str) -> Vec<f32> {
        self.context.enable_accesskit();
        self.context.request_repaint();
        let nodes = self.places.0.lock().unwrap_or_else(PoisonError::into_inner);
        let named = |node: &&Node| node.label() == Some(name) || node.value() == Some(name);
        let Some(bounds) = nodes.values().filter(named).find_map(Node::bounds) else { return Vec::new() };
        let zoom = f64::from(self.context.zoom_factor());
        [bounds.x0, bounds.y0, bounds.x1 - bounds.x0, bounds.y1 - bounds.y0].map(|x| (x * zoom) as f32).to_vec()
    }
}

/// The hash of the state to which a scene comes after so many frames, without a window: a scene that comes with the program,
/// or a text.
///
/// # Errors
/// What is wrong with the scene, or why it does not run.
#[wasm_bindgen]
pub fn hash_after(scene_or_text: &str, frames: u32) -> Result<String, String> {
    let text = opruga::scenes::find(scene_or_text).unwrap_or(scene_or_text);
    let document = Document::new("scene", text)?;
    let options = scene::Options { files: opruga::scenes::files(), ..scene::Options::default() };
    let read = scene::read(document.text().as_bytes(), "scene.toml", &opruga::catalogue(), &options);
    let together = |errors: Vec<_>| errors.iter().map(ToString::to_string).collect::<Vec<String>>().join("\n");
    let (blueprint, _) = read.map_err(together)?;
    let refused = |error: WorldError| error.to_string();
    let mut engine = engine::build(blueprint, &Options::default()).map_err(refused)?;
    for _ in 0..frames {
        engine.frame().map_err(refused)?;
    }
    Ok(format!("{:016x}", engine.hash()))
}

/// What a file of the browser asks for: see [`crate::dropping`].
pub(crate) fn request_of(file: &str, bytes: Vec<u8>) -> Result<Request, String> {
    let held: Arc<[u8]> = bytes.as_slice().into();
    let files = || opruga::scenes::files().with([(file.to_string(), held)]);
    crate::dropping::request(file, || Ok(bytes), files)
}
