//! What draws the page: WebGPU, WebGL 2 or nothing; a device that is lost; how long pictures take.

use super::super::server;
use super::{Browser, Outcome, PATIENCE, Trial, holds};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Takes the device away from the page, as drivers do.
const LOSE: &str =
    "document.querySelector('canvas').getContext('webgl2').getExtension('WEBGL_lose_context').loseContext()";
/// A browser that gives no device.
const NONE: &str = "Object.defineProperty(navigator, 'gpu', { value: undefined }); \
                    const get = HTMLCanvasElement.prototype.getContext; \
                    HTMLCanvasElement.prototype.getContext = function (kind, ...rest) { \
                      return kind.startsWith('webgl') ? null : get.call(this, kind, ...rest); }";
/// The letters of a picture in which nothing is drawn are fewer.
const FEWEST_LETTERS: usize = 60_000;

impl Trial {
    /// A device that is lost is replaced, and everything goes on as it was; where that happens again and again, the page says so
    /// and keeps the scene.
    pub(super) fn goes_on_on_another_device(&mut self) -> Outcome {
        self.fresh("?draw=webgl")?;
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

    /// The page runs on WebGPU too. What that draws is shown by no browser without a screen.
    pub(super) fn runs_on_webgpu(&mut self) -> Outcome {
        self.fresh("?draw=webgpu")?;
        let by = self.browser.value("opruga_drawn_by.name")?;
        holds(by == "webgpu", || format!("it is drawn by {by}"))?;
        self.until("it moves", |state| state["frames"].as_u64() > Some(30))?;
        println!("it runs on WebGPU");
        Ok(())
    }

    /// Where nothing can be drawn, the page says so and loads nothing.
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

    /// A scene that is too much for the browser goes more slowly, and what the page says of that is so.
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

    /// Opens the page anew, without what the last one kept.
    fn fresh(&mut self, query: &str) -> Outcome {
        let address = format!("{}{query}", self.address);
        self.browser.open("about:blank")?;
        self.browser.open(&address)?;
        self.until("the page begins", |state| state["frames"].as_u64() > Some(5)).map(|_| ())
    }

    /// Something is seen.
    fn drawn(&mut self, when: &str) -> Outcome {
        std::thread::sleep(Duration::from_millis(500));
        let letters = self.browser.picture()?.len();
        holds(letters > FEWEST_LETTERS, || format!("nothing is seen {when}: a picture of {letters} letters"))
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
/// Where there is no browser, or the page does not begin.
pub(in super::super) fn measure(page: &Path, pictures: u32) -> Outcome {
    let folder = std::env::temp_dir().join(format!("opruga-measure-{}", std::process::id()));
    std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let (address, _) = server::serve(page.to_path_buf(), 0)?.start();
    let browser = Browser::start(&folder)?;
    let mut trial = Trial { browser, address, folder: folder.clone(), native: PathBuf::new() };
    trial.browser.size([1280, 720], 1.0, false)?;
    let root = super::super::root()?;
    let outcome = (|| {
        for scene in ["scenes/ball", "benches/scenes/ring-10000", "scenes/thousand-balls", "scenes/giant-ring"] {
            let path = root.join(format!("{scene}.toml"));
            let text = std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
            let name = scene.rsplit('/').next().unwrap_or(scene);
            trial.fresh("?draw=webgl")?;
            trial.browser.value(&format!("opruga.show({name:?}, {})", json!(text)))?;
            trial.until(name, |state| state["name"] == name && state["frames"].as_u64() > Some(2))?;
            // Large scenes are slow on a processor that draws as well.
            let count = if scene.ends_with("ball") || scene.ends_with("10000") { pictures } else { pictures / 4 };
            let said = trial.browser.value(&format!("opruga_measure({})", count.max(10)))?;
            println!("{}", said.as_str().unwrap_or_default());
        }
        Ok(())
    })();
    drop(trial);
    let _ = std::fs::remove_dir_all(&folder);
    outcome
}
