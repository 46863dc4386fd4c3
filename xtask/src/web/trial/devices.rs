//! Tests the renderers of the page (WebGPU, WebGL 2 or none) and lost devices, and measures the time of pictures.

use super::super::server;
use super::{Browser, Outcome, PATIENCE, Trial, holds};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Makes the page lose its device, as drivers do.
const LOSE: &str =
    "document.querySelector('canvas').getContext('webgl2').getExtension('WEBGL_lose_context').loseContext()";
/// Makes the browser have no graphics device.
const NONE: &str = "Object.defineProperty(navigator, 'gpu', { value: undefined }); \
                    const get = HTMLCanvasElement.prototype.getContext; \
                    HTMLCanvasElement.prototype.getContext = function (kind, ...rest) { \
                      return kind.startsWith('webgl') ? null : get.call(this, kind, ...rest); }";
/// The longest time for the pictures of one scene.
const LONGEST_MEASURE: Duration = Duration::from_secs(3600);
/// Faults of WebGPU that a browser may have.
const FAULTS: [(&str, &str); 4] = [
    ("without WebGPU", "Object.defineProperty(navigator, 'gpu', { value: undefined });"),
    ("without an adapter", "if (window.GPU) GPU.prototype.requestAdapter = async () => null;"),
    (
        "without a device",
        "if (window.GPUAdapter) GPUAdapter.prototype.requestDevice = async () => { throw new Error('no device'); };",
    ),
    ("with a device that shows nothing", "if (window.GPUQueue) GPUQueue.prototype.submit = () => {};"),
];
/// The difference of two pictures below the status line: the fraction of pixels with a visibly different colour.
const DIFFER: &str = "async (first, second) => { \
    const pixels = async (letters) => { \
      const image = await createImageBitmap(await (await fetch('data:image/png;base64,' + letters)).blob()); \
      const canvas = new OffscreenCanvas(image.width, image.height), context = canvas.getContext('2d'); \
      context.drawImage(image, 0, 0); \
      return context.getImageData(0, 60, image.width, image.height - 60).data; }; \
    const [a, b] = [await pixels(first), await pixels(second)]; \
    let count = 0; \
    for (let k = 0; k < a.length; k += 4) \
      count += [0, 1, 2].some((c) => Math.abs(a[k + c] - b[k + c]) > 48); \
    return 4 * count / a.length; }";
/// A scene with a frame that takes minutes.
const LONG: &str = r#"
format = "opruga-1"
dimension = 2
[time]
seconds = 1.0
frame = 0.02
substeps = 400000
[integrator]
kind = "symplectic_euler"
[[body]]
name = "square"
mass = 1.0
shape = { kind = "grid", corner = [0.0, 0.0], size = [1.0, 1.0], cells = [40, 40] }
models = [{ kind = "fem", youngs_modulus = 100.0, poissons_ratio = 0.3 }]
"#;
/// A picture in which nothing is drawn has fewer letters than this.
const FEWEST_LETTERS: usize = 60_000;

impl Trial {
    /// A lost device is replaced, and everything continues as before. If that happens repeatedly, the page reports it and keeps the scene.
    pub(super) fn goes_on_on_another_device(&mut self) -> Outcome {
        self.fresh("?graphics=webgl")?;
        self.click("Add a model")?;
        self.click("drag")?;
        let models = |state: &Value| state["models"].as_array().map_or(0, Vec::len);
        let before =
            self.until("another model", |state| models(state) == 4 && state["recorded"].as_u64() == Some(1))?;
        self.browser.value(LOSE)?;
        let frames = before["frames"].as_u64().unwrap_or(0);
        let after = self.until("it goes on", |state| state["frames"].as_u64() > Some(frames + 30))?;
        holds(models(&after) == 4 && after["recorded"] == before["recorded"], || {
            format!("the state was lost with the device: {before}, {after}")
        })?;
        self.drawn("after a lost device")?;
        self.click("Undo")?;
        self.until("what was done before the loss is undone", |state| models(state) == 3)?;
        self.click("Redo")?;
        self.until("and done again", |state| models(state) == 4)?;
        self.keep_picture("web-after-loss")?;
        for loss in 2..=4 {
            self.browser.value(LOSE)?;
            let over = "(document.querySelector('#cover').className === 'gone' || !!document.querySelector('button'))";
            self.until_value(&format!("opruga_losses.length === {loss} && {over}"))?;
        }
        let said = self.browser.value("document.querySelector('#about').innerText")?;
        let said = said.as_str().unwrap_or_default();
        holds(said.contains("again and again") && said.contains("address bar"), || format!("the page says: {said}"))?;
        self.keep_picture("web-lost")?;
        self.browser.value("location.reload()")?;
        self.until("the scene of the address", |state| state["recorded"].as_u64() == Some(0) && models(state) >= 3)?;
        println!("a lost device is replaced, and the scene is kept where that fails");
        Ok(())
    }

    /// WebGPU is used if it works. WebGL 2 is used if there is no WebGPU, if WebGPU fails, or if the user insists on WebGL 2. Both draw the same
    /// picture, and the page names the one in use.
    pub(super) fn on_webgpu(&mut self) -> Outcome {
        self.browser.size([1280, 720], 1.0, false)?;
        self.fresh("")?;
        if self.browser.value("navigator.gpu?.requestAdapter().then((adapter) => !!adapter)")? != true {
            println!("SKIPPED: this browser has no adapter of WebGPU");
            return Ok(());
        }
        let of_webgpu = self.picture_by("webgpu", "WebGPU")?;
        self.keep_picture("web-webgpu")?;
        self.drags()?;
        self.goes_on_after_the_driver_has_ended()?;
        self.fresh("?graphics=webgl")?;
        let of_webgl = self.picture_by("webgl", "WebGL 2")?;
        let differ = self.browser.value(&format!("({DIFFER})({}, {})", json!(of_webgpu), json!(of_webgl)))?;
        let share = differ.as_f64().unwrap_or(1.0);
        println!("WebGPU and WebGL 2 draw the same but for {:.2} % of the pixels", 100.0 * share);
        holds(share < 0.02, || format!("{share} of the pixels differ between WebGPU and WebGL 2"))?;
        for (fault, script) in FAULTS {
            let added = self.browser.call("Page.addScriptToEvaluateOnNewDocument", json!({ "source": script }))?;
            self.fresh("")?;
            let by = self.browser.value("opruga_drawn_by.name")?;
            holds(by == "webgl", || format!("{fault}: it is drawn by {by}"))?;
            self.drawn(fault)?;
            let added = json!({ "identifier": added["identifier"] });
            self.browser.call("Page.removeScriptToEvaluateOnNewDocument", added)?;
        }
        println!("where WebGPU is missing or fails, WebGL 2 draws");
        Ok(())
    }

    /// Takes the picture of a fixed moment, drawn by a given renderer. Checks that the title and the status line name this renderer.
    fn picture_by(&mut self, drawn_by: &str, named: &str) -> Result<String, String> {
        let by = self.browser.value("opruga_drawn_by.name")?;
        holds(by == drawn_by, || format!("it is drawn by {by} and not by {drawn_by}"))?;
        let title = self.browser.value("document.title")?;
        holds(title.as_str().is_some_and(|title| title.ends_with(named)), || format!("the title is {title}"))?;
        self.place(named)?;
        self.until("frame 20", |state| state["frames"].as_u64() >= Some(20))?;
        self.browser.value("opruga.seek(20)")?;
        self.until("back at frame 20", |state| state["frames"].as_u64() == Some(20))?;
        // The status line depends on the machine, so it is left out.
        self.drawn("at frame 20")?;
        self.browser.picture()
    }

    /// The process of the graphics driver ends, and the page continues with another one.
    fn goes_on_after_the_driver_has_ended(&mut self) -> Outcome {
        let before = self.state()?;
        // The result is ignored, because the answer may or may not arrive before the process has ended.
        let _ = self.browser.call("Browser.crashGpuProcess", json!({}));
        self.until_value("opruga_losses.length === 1 && document.querySelector('#cover').className === 'gone'")?;
        let frames = before["frames"].as_u64().unwrap_or(0);
        self.until("it goes on", |state| state["frames"].as_u64() > Some(frames + 5))?;
        self.drawn("after the driver has ended")?;
        let by = self.browser.value("opruga_drawn_by.name")?;
        println!("after the driver of WebGPU has ended it is drawn by {by}");
        Ok(())
    }

    /// If the browser cannot draw, the page reports this and does not load the program.
    pub(super) fn says_where_nothing_draws(&mut self) -> Outcome {
        let added = self.browser.call("Page.addScriptToEvaluateOnNewDocument", json!({ "source": NONE }))?;
        self.browser.open("about:blank")?;
        let address = self.address.clone();
        self.browser.open(&address)?;
        self.until_value("document.querySelector('#about').innerText.includes('neither')")?;
        let loaded = "performance.getEntriesByType('resource').filter((file) => file.name.includes('wasm')).length";
        holds(self.browser.value(loaded)? == 0, || "the program was loaded for nothing".into())?;
        self.keep_picture("web-no-device")?;
        self.browser.call("Page.removeScriptToEvaluateOnNewDocument", json!({ "identifier": added["identifier"] }))?;
        Ok(())
    }

    /// A scene that is too demanding for the browser runs more slowly, and the page reports the true ratio.
    pub(super) fn slows_down_honestly(&mut self) -> Outcome {
        self.fresh("")?;
        self.browser.value("location.hash = '#thousand-balls'")?;
        self.until("the crowd", |state| state["bodies"].as_u64() == Some(1000) && state["frames"].as_u64() > Some(5))?;
        let look = "[performance.now(), JSON.parse(opruga.state()).time, JSON.parse(opruga.state()).real_time]";
        let now = |trial: &mut Trial| trial.browser.value(look).map(|list| super::numbers(&list));
        let first = now(self)?;
        let mut told = Vec::new();
        while told.len() < 24 {
            std::thread::sleep(Duration::from_millis(250));
            told.extend(now(self)?.get(2));
        }
        let last = now(self)?;
        let [begin, end] =
            [&first, &last].map(|list| [list.first(), list.get(1)].map(|x| x.copied().unwrap_or(f64::NAN)));
        let measured = 1e3 * (end[1] - begin[1]) / (end[0] - begin[0]);
        let told = told.iter().sum::<f64>() / told.len() as f64;
        println!("a thousand balls: {measured:.2} of real time, {told:.2} as the page says");
        holds((measured - told).abs() < 0.1 + 0.25 * measured, || format!("{measured} is told as {told}"))
    }

    /// A frame that would take minutes blocks nothing. The page interrupts it, reports this, and handles the next requests.
    pub(super) fn asks_about_long_frames(&mut self) -> Outcome {
        self.fresh("")?;
        self.browser.value(&format!("opruga.show('long', {})", json!(LONG)))?;
        let says = |state: &Value, seconds: &str| {
            let said = state["message"].as_str().unwrap_or_default();
            state["name"] == "long" && state["playing"] == false && said.contains(seconds)
        };
        self.until("a long frame is given up", |state| says(state, "longer than 2 s"))?;
        self.keep_picture("web-long-frame")?;
        self.click("Wait for up to 8 s")?;
        self.until("it was waited for", |state| says(state, "longer than 8 s"))?;
        self.browser.value("location.hash = '#ball'")?;
        self.until("another scene", |state| state["name"] == "ball" && state["frames"].as_u64() > Some(5))?;
        println!("frames of minutes are given up after 2 s, or 8 s where the person waits");
        Ok(())
    }

    /// Opens the page again, without the data that it has stored earlier.
    fn fresh(&mut self, query: &str) -> Outcome {
        let address = format!("{}{query}", self.address);
        self.browser.open("about:blank")?;
        self.browser.open(&address)?;
        self.until("the page begins", |state| state["frames"].as_u64() > Some(5)).map(|_| ())
    }

    /// Asserts that something is visible.
    fn drawn(&mut self, when: &str) -> Outcome {
        let begin = Instant::now();
        loop {
            let letters = self.browser.picture()?.len();
            if letters > FEWEST_LETTERS {
                return Ok(());
            }
            holds(begin.elapsed() < PATIENCE, || format!("nothing is seen {when}: a picture of {letters} letters"))?;
            std::thread::sleep(Duration::from_millis(200));
        }
    }

    fn until_value(&mut self, expression: &str) -> Outcome {
        let begin = Instant::now();
        while self.browser.value(expression).ok().and_then(|value| value.as_bool()) != Some(true) {
            if begin.elapsed() > PATIENCE {
                return Err(format!("{expression}: not within {} s", PATIENCE.as_secs()));
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        Ok(())
    }
}

/// Measures how long pictures of the page take with scenes of growing size.
///
/// # Errors
/// There is no browser, or the page does not start.
pub(in super::super) fn measure(page: &Path, pictures: u32) -> Outcome {
    let folder = std::env::temp_dir().join(format!("opruga-measure-{}", std::process::id()));
    std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let (address, _) = server::serve(page.to_path_buf(), 0)?.start();
    let root = super::super::root()?;
    let outcome = [("webgl", false), ("webgpu", true)].into_iter().try_for_each(|(by, webgpu)| {
        let browser = Browser::start(&folder, webgpu)?;
        let mut trial = Trial { browser, address: address.clone(), folder: folder.clone(), native: PathBuf::new() };
        trial.browser.size([1280, 720], 1.0, false)?;
        for scene in ["scenes/ball", "benches/scenes/ring-10000", "scenes/thousand-balls", "scenes/giant-ring"] {
            let path = root.join(format!("{scene}.toml"));
            let text = std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
            let name = scene.rsplit('/').next().unwrap_or(scene);
            trial.fresh(&format!("?graphics={by}"))?;
            trial.browser.value(&format!("opruga.show({name:?}, {})", json!(text)))?;
            trial.until(name, |state| state["name"] == name && state["frames"].as_u64() > Some(2))?;
            // Large scenes are slow if the processor also draws.
            let count = if scene.ends_with("ball") || scene.ends_with("10000") { pictures } else { pictures / 4 };
            let begin = format!(
                "window.told = null; opruga_measure({}).then((told) => (window.told = told)); 0",
                count.max(10)
            );
            trial.browser.value(&begin)?;
            let begin = Instant::now();
            let said = loop {
                // A busy page answers late, so a missing report is not an error.
                if let Some(said) = trial.browser.value("window.told")?.as_str() {
                    break said.to_string();
                }
                holds(begin.elapsed() < LONGEST_MEASURE, || format!("{name} is not measured within the hour"))?;
                std::thread::sleep(Duration::from_secs(1));
            };
            println!("{said}");
        }
        Ok(())
    });
    let _ = std::fs::remove_dir_all(&folder);
    outcome
}
