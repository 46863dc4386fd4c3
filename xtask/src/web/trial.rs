//! Tests the page as a user works with it, on a screen and on a phone. The page is loaded, the ball is dragged, its model is changed, a body is
//! drawn, and the scene is saved and opened again from its link. The page must reach the same bits as the native program.

mod devices;

pub(super) use devices::measure;

use super::browser::{self, Browser};
use super::server;
use serde_json::Value;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// The longest time that a single action may take on a slow machine that draws on the processor.
const PATIENCE: Duration = Duration::from_secs(240);
/// The longest time until a press must hold the ball. After this time the press is repeated.
const HOLD: Duration = Duration::from_secs(20);
/// How often the ball is pressed. A press may miss, because the ball may have moved on before the press arrives.
const PRESSES: u32 = 4;
/// After this simulated time, nothing more happens in the scene, so the page is no longer given time [s].
const LATEST: f64 = 60.0;
/// Scenes that take too long if they are not compiled for this machine.
const LARGE: [&str; 3] = ["million-vertices", "thousand-balls", "giant-ring"];

/// Tests the page; pictures of it are saved in the folder that `PICTURES` names.
///
/// # Errors
/// The first expectation that the page does not meet, or a missing browser.
pub(super) fn run(page: &Path, native: PathBuf) -> Result<(), String> {
    if !browser::is_there() {
        return Err("there is no Chromium: on Debian `apt-get install chromium` gives one".into());
    }
    let folder = std::env::temp_dir().join(format!("opruga-web-{}", std::process::id()));
    std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let (address, answers) = server::serve(page.to_path_buf(), 0)?.start();
    // The browser with WebGPU comes first, because the server is switched off at the end.
    let rounds: [(bool, Round<'_>); 2] = [(true, &Trial::on_webgpu), (false, &|trial| trial.all(&answers))];
    let outcome = rounds.into_iter().try_for_each(|(webgpu, round)| {
        let browser = Browser::start(&folder, webgpu)?;
        let mut trial = Trial { browser, address: address.clone(), folder: folder.clone(), native: native.clone() };
        let outcome = round(&mut trial).and_then(|()| match trial.browser.troubles.first() {
            None => Ok(()),
            Some(trouble) => Err(format!("the page complains: {trouble}")),
        });
        if outcome.is_err() {
            let _ = trial.keep_picture("web-failed");
            trial.browser.troubles.iter().for_each(|trouble| eprintln!("the page says: {trouble}"));
        }
        outcome
    });
    let _ = std::fs::remove_dir_all(&folder);
    outcome
}

struct Trial {
    browser: Browser,
    address: String,
    folder: PathBuf,
    /// The native program.
    native: PathBuf,
}

type Outcome = Result<(), String>;
/// The tests in one browser.
type Round<'a> = &'a dyn Fn(&mut Trial) -> Outcome;

impl Trial {
    fn all(&mut self, answers: &std::sync::atomic::AtomicBool) -> Outcome {
        self.browser.size([1280, 720], 1.0, false)?;
        self.loads_and_moves()?;
        self.same_bits_as_golden()?;
        self.drags()?;
        self.changes_the_model()?;
        self.draws_a_body()?;
        let saved = self.saves()?;
        self.link_holds_the_scene(&saved)?;
        self.animation_is_handed_over()?;
        self.phone()?;
        self.browser.size([1280, 720], 1.0, false)?;
        self.slows_down_honestly()?;
        self.asks_about_long_frames()?;
        self.refuses_what_no_memory_holds()?;
        self.says_where_nothing_draws()?;
        self.goes_on_on_another_device()?;
        answers.store(false, Ordering::Relaxed);
        self.works_without_a_network()
    }

    fn loads_and_moves(&mut self) -> Outcome {
        let begin = Instant::now();
        let address = self.address.clone();
        self.browser.open(&address)?;
        self.until("the page begins", |state| state["frames"].as_u64() > Some(5))?;
        println!("the ball moves {:.1} s after the page was opened", begin.elapsed().as_secs_f64());
        // The positions are compared at two fixed frames, so that the speed of the page does not matter.
        self.until("half a second", |state| state["time"].as_f64() > Some(0.5))?;
        let mut at = [[0.0; 2]; 2];
        for (place, frame) in at.iter_mut().zip([0, 30]) {
            self.browser.value(&format!("opruga.seek({frame})"))?;
            self.until("a moment", |state| state["frames"].as_u64() == Some(frame))?;
            *place = self.top()?;
        }
        self.click("Play")?;
        holds(at[1][1] > at[0][1] + 5.0, || format!("the ball does not fall: {at:?}"))
    }

    /// Scenes of the program end with the same bits as in the native program. A second browser runs a part of them.
    fn same_bits_as_golden(&mut self) -> Outcome {
        let root = super::root()?;
        let golden = std::fs::read_to_string(root.join("scenes/golden.txt")).map_err(|e| e.to_string())?;
        let begin = Instant::now();
        let scenes: Vec<[&str; 3]> = golden
            .lines()
            .filter(|line| !line.starts_with('#'))
            .filter_map(|line| line.split_whitespace().collect::<Vec<_>>().try_into().ok())
            .filter(|[name, _, hash]: &[&str; 3]| *hash != "this_cpu_class" && !LARGE.contains(name))
            .collect();
        let left = Mutex::new(scenes.iter());
        let mut other = Browser::start(&self.folder.join("second"), false)?;
        other.open(&self.address)?;
        while other.value("window.opruga !== undefined")? != true {
            holds(begin.elapsed() < PATIENCE, || "the second browser shows no page".into())?;
            std::thread::sleep(Duration::from_millis(100));
        }
        std::thread::scope(|scope| {
            let second = scope.spawn(|| compare_bits(&mut other, &left));
            compare_bits(&mut self.browser, &left).and(second.join().map_err(|_| "a browser was lost")?)
        })?;
        let compared = scenes.len();
        println!("{compared} scenes end with the bits of the native program ({:.0} s)", begin.elapsed().as_secs_f64());
        holds(compared >= 10, || format!("only {compared} scenes were compared"))
    }

    /// Only the mouse pulls the ball.
    fn drags(&mut self) -> Outcome {
        self.quiet_ball()?;
        self.hold("mouse", |trial, top| {
            let at = |step: u32| [top[0] + 12.0 * f64::from(step), top[1] + 40.0 - 8.0 * f64::from(step)];
            trial.browser.mouse("mouseMoved", at(0), false)?;
            trial.browser.mouse("mousePressed", at(0), true)?;
            (1..=10).try_for_each(|step| trial.browser.mouse("mouseMoved", at(step), true))
        })?;
        self.keep_picture("web-pull")?;
        let top = self.top()?;
        self.browser.mouse("mouseReleased", top, false)?;
        self.until("the ball is let go", |state| state["pulls"] == 0).map(|_| ())
    }

    /// Opens the ball without the pull of its scene, and waits until it lies on the floor. There it waits for the pointer, however slow the machine
    /// is.
    fn quiet_ball(&mut self) -> Outcome {
        let root = super::root()?;
        let ball = std::fs::read_to_string(root.join("scenes/ball.toml")).map_err(|e| e.to_string())?;
        let (quiet, _) = ball.split_once("[[command]]").ok_or("the ball has no pull of its own")?;
        self.browser.value(&format!("opruga.show('ball', {})", serde_json::json!(quiet)))?;
        self.until("the ball lies on the floor", |state| state["time"].as_f64() > Some(2.6) && state["recorded"] == 0)
            .map(|_| ())
    }

    /// Grabs the ball near its highest node. A press that misses is repeated.
    fn hold(&mut self, what: &str, press: impl Fn(&mut Trial, [f64; 2]) -> Outcome) -> Outcome {
        for _ in 0..PRESSES {
            let top = self.top()?;
            press(self, top)?;
            let begin = Instant::now();
            while begin.elapsed() < HOLD {
                if self.state()?["pulls"].as_u64() >= Some(1) {
                    return Ok(());
                }
                std::thread::sleep(Duration::from_millis(50));
            }
            match what {
                "mouse" => self.browser.mouse("mouseReleased", top, false)?,
                _ => self.browser.fingers("touchEnd", &[])?,
            }
        }
        Err(format!("the {what} does not hold the ball after {PRESSES} presses; the page says {}", self.state()?))
    }

    fn changes_the_model(&mut self) -> Outcome {
        let models = |state: &Value| state["models"].as_array().map_or(0, Vec::len);
        let before = models(&self.state()?);
        self.click("Add a model")?;
        self.click("drag")?;
        self.until("another model on the moving ball", |state| models(state) == before + 1).map(|_| ())
    }

    fn draws_a_body(&mut self) -> Outcome {
        self.click("Draw")?;
        let [x, y, width, height] = self.place("canvas")?;
        let point = |k: u32| {
            let turn = f64::from(k) / 24.0 * std::f64::consts::TAU;
            [x + 0.75 * width + 0.1 * width * turn.cos(), y + 0.5 * height + 0.12 * height * turn.sin()]
        };
        self.browser.mouse("mouseMoved", point(0), false)?;
        self.browser.mouse("mousePressed", point(0), true)?;
        for k in 1..24 {
            self.browser.mouse("mouseMoved", point(k), true)?;
        }
        self.browser.mouse("mouseReleased", point(23), false)?;
        self.until("a drawn body", |state| state["bodies"].as_u64() == Some(2))?;
        self.click("Pull")?;
        self.keep_picture("web-desktop")
    }

    /// The saved file contains all actions, and the native program reaches the same bits with it.
    fn saves(&mut self) -> Result<String, String> {
        self.click("Pause")?;
        let state = self.until("time stands", |state| state["playing"] == false)?;
        self.click("Save")?;
        let path = self.folder.join("ball.toml");
        let saved = self.file(&path)?;
        let saved = String::from_utf8(saved).map_err(|e| e.to_string())?;
        holds(self.browser.value("opruga.scene()")? == saved.as_str(), || "another scene was saved".into())?;
        let native = self.native(&path, None)?;
        holds(state["state_hash"] == native.as_str(), || format!("{native} natively, in the browser {state}"))?;
        println!("the saved scene: state_hash {native} here and there, after {} s", state["time"]);
        Ok(saved)
    }

    /// The link is opened again, and after ten seconds of simulated time the bits are those of the native program.
    fn link_holds_the_scene(&mut self, saved: &str) -> Outcome {
        self.click("Export")?;
        self.click("Copy a link with the whole scene")?;
        let begin = Instant::now();
        let link = loop {
            let link = self.browser.value("location.href")?;
            match link.as_str() {
                Some(link) if link.contains("#scene=") => break link.to_string(),
                _ if begin.elapsed() > PATIENCE => return Err("no link stands in the address bar".into()),
                _ => std::thread::sleep(Duration::from_millis(100)),
            }
        };
        self.browser.open("about:blank")?;
        self.browser.open(&link)?;
        self.until("the scene of the link", |state| state["bodies"].as_u64() >= Some(1))?;
        holds(self.browser.value("opruga.state()")?.as_str().is_some_and(|s| s.contains("\"name\":\"ball\"")), || {
            "the link has lost the name of the scene".into()
        })?;
        self.until("ten seconds", |state| state["frames"].as_u64() >= Some(600))?;
        self.browser.value("opruga.seek(600)")?;
        let state = self.until("frame 600", |state| state["frames"].as_u64() == Some(600))?;
        let path = self.folder.join("again.toml");
        std::fs::write(&path, saved).map_err(|e| e.to_string())?;
        let native = self.native(&path, Some("10"))?;
        holds(state["state_hash"] == native.as_str(), || format!("{native} natively, in the browser {state}"))?;
        println!("after 10 s from a link of {} letters: state_hash {native} here and there", link.len());
        Ok(())
    }

    fn animation_is_handed_over(&mut self) -> Outcome {
        self.browser.value("opruga.seek(45)")?;
        self.until("frame 45", |state| state["frames"].as_u64() == Some(45))?;
        self.click("Export")?;
        self.click("Animation (.gif)")?;
        let bytes = self.file(&self.folder.join("ball.gif"))?;
        holds(bytes.starts_with(b"GIF89a"), || "no animation was handed over".into())
    }

    /// On a phone held upright, a finger drags the ball, two fingers zoom, and nothing scrolls.
    fn phone(&mut self) -> Outcome {
        self.browser.size([390, 844], 2.0, true)?;
        let address = self.address.clone();
        self.browser.open("about:blank")?;
        self.browser.open(&address)?;
        self.until("the page on a phone", |state| state["frames"].as_u64() > Some(20))?;
        self.quiet_ball()?;
        self.keep_picture("web-phone")?;
        self.hold("finger", |trial, top| {
            let at = |step: u32| [[top[0] + 6.0 * f64::from(step), top[1] + 20.0 - 10.0 * f64::from(step)]];
            trial.browser.fingers("touchStart", &at(0))?;
            (1..=8).try_for_each(|step| trial.browser.fingers("touchMove", &at(step)))
        })?;
        self.browser.fingers("touchEnd", &[])?;
        self.until("the pull was written down", |state| state["recorded"].as_u64() >= Some(1))?;
        self.browser.value("opruga.seek(0)")?;
        self.until("the start", |state| state["frames"].as_u64() == Some(0))?;
        let before = self.top()?;
        let [x, y, width, height] = self.place("canvas")?;
        let (x, y) = (x + 0.5 * width, y + 0.7 * height);
        self.browser.fingers("touchStart", &[[x - 30.0, y], [x + 30.0, y]])?;
        for step in 1..=8 {
            let far = 30.0 + 8.0 * f64::from(step);
            self.browser.fingers("touchMove", &[[x - far, y], [x + far, y]])?;
        }
        self.browser.fingers("touchEnd", &[])?;
        let begin = Instant::now();
        loop {
            let after = self.top()?;
            if (after[1] - before[1]).abs() > 20.0 {
                break;
            }
            holds(begin.elapsed() < PATIENCE, || format!("two fingers do not zoom: {before:?}, {after:?}"))?;
        }
        holds(self.browser.value("scrollX + scrollY")? == 0, || "the page was scrolled".into())
    }

    /// No memory is shared with workers. A scene that needs too much memory for a page is refused, and the present scene does not change.
    fn refuses_what_no_memory_holds(&mut self) -> Outcome {
        holds(self.browser.value("crossOriginIsolated")? == false, || "the page has memory to share".into())?;
        let before = self.state()?["name"].clone();
        let root = super::root()?;
        let ball = std::fs::read_to_string(root.join("scenes/ball.toml")).map_err(|e| e.to_string())?;
        let vast = ball.replace("vertices = 36", "vertices = 4000000");
        self.browser.value(&format!("opruga.show('vast', {})", serde_json::json!(vast)))?;
        let refused = |state: &Value| state["message"].as_str().is_some_and(|text| text.contains("limit.memory"));
        let state = self.until("a refusal", refused)?;
        holds(state["name"] == before, || format!("another scene is there: {state}"))
    }

    fn works_without_a_network(&mut self) -> Outcome {
        self.browser.size([1280, 720], 1.0, false)?;
        let address = self.address.clone();
        self.browser.open("about:blank")?;
        // The server is switched off.
        self.browser.open(&address)?;
        self.until("the page without a network", |state| state["frames"].as_u64() > Some(5))?;
        println!("it works without a network");
        Ok(())
    }

    /// The state of the page; null before it starts.
    fn state(&mut self) -> Result<Value, String> {
        let state =
            self.browser.value("window.opruga ? opruga.state() : document.querySelector('#about').innerText")?;
        let state = state.as_str().unwrap_or_default();
        Ok(serde_json::from_str(state).unwrap_or(Value::String(state.into())))
    }

    /// Waits until a condition on the state of the page holds.
    fn until(&mut self, what: &str, is: impl Fn(&Value) -> bool) -> Result<Value, String> {
        let mut begin = Instant::now();
        let mut last = Value::Null;
        loop {
            // While one page replaces another, no page answers.
            let state = self.state().unwrap_or(Value::Null);
            if is(&state) {
                return Ok(state);
            }
            // A slow machine is given more time as long as its simulation advances.
            if state["frames"].as_u64() > last["frames"].as_u64() && state["time"].as_f64() < Some(LATEST) {
                begin = Instant::now();
            }
            last = state.clone();
            if begin.elapsed() > PATIENCE {
                return Err(format!("{what}: not within {} s; the page says {state}", PATIENCE.as_secs()));
            }
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    /// The position of the highest node of the first body on the page.
    fn top(&mut self) -> Result<[f64; 2], String> {
        let spot = self.browser.value("Array.from(opruga.top_of(0))")?;
        match numbers(&spot)[..] {
            [x, y] => Ok([x, y]),
            _ => Err("the ball is out of sight".into()),
        }
    }

    /// The bounds of a control of this name: left, top, width, height.
    fn place(&mut self, name: &str) -> Result<[f64; 4], String> {
        let begin = Instant::now();
        while begin.elapsed() < PATIENCE {
            let place = self.browser.value(&format!("Array.from(opruga.find({name:?}))"))?;
            if let [x, y, width, height] = numbers(&place)[..] {
                return Ok([x, y, width, height]);
            }
            std::thread::sleep(Duration::from_millis(100));
        }
        Err(format!("nothing is called `{name}`"))
    }

    /// Presses a control of this name. If the control is below the window, the wheel scrolls it into view.
    fn click(&mut self, name: &str) -> Outcome {
        let height = self.browser.value("innerHeight")?.as_f64().unwrap_or(0.0);
        let begin = Instant::now();
        let mut last = [0.0; 2];
        loop {
            let [x, y, width, tall] = self.place(name)?;
            let middle = [x + 0.5 * width, y + 0.5 * tall];
            let below = middle[1] > height - 90.0 && tall < 60.0 && x > 900.0;
            if !below && middle == last {
                self.browser.mouse("mouseMoved", middle, false)?;
                self.browser.mouse("mousePressed", middle, true)?;
                std::thread::sleep(Duration::from_millis(60));
                return self.browser.mouse("mouseReleased", middle, false);
            }
            if below {
                let above = [middle[0], 0.5 * height];
                // The wheel scrolls what is under the pointer.
                self.browser.mouse("mouseMoved", above, false)?;
                self.browser.wheel(above, 200.0)?;
            }
            // The control is pressed when it no longer moves.
            last = middle;
            if begin.elapsed() > PATIENCE {
                return Err(format!("`{name}` does not come to rest in the window"));
            }
            std::thread::sleep(Duration::from_millis(250));
        }
    }

    /// A downloaded file.
    fn file(&mut self, path: &Path) -> Result<Vec<u8>, String> {
        let begin = Instant::now();
        while begin.elapsed() < PATIENCE {
            if let Ok(bytes) = std::fs::read(path)
                && !bytes.is_empty()
            {
                return Ok(bytes);
            }
            std::thread::sleep(Duration::from_millis(100));
        }
        let said = self.state()?;
        Err(format!("{} was not handed over; the page says {said}", path.display()))
    }

    /// The hash that the native program reaches with a scene.
    fn native(&self, scene: &Path, seconds: Option<&str>) -> Result<String, String> {
        let out = self.folder.join("run");
        let mut run = Command::new(&self.native);
        run.arg("run").arg(scene).args(["--no-pictures", "--force", "--json", "--out"]).arg(&out);
        if let Some(seconds) = seconds {
            run.args(["--seconds", seconds]);
        }
        let output = run.output().map_err(|e| format!("{}: {e}", self.native.display()))?;
        let told: Value = serde_json::from_slice(&output.stdout)
            .map_err(|_| format!("the native program: {}", String::from_utf8_lossy(&output.stderr)))?;
        told["state_hash"].as_str().map(String::from).ok_or_else(|| format!("no hash in {told}"))
    }

    /// Saves a picture of the page, if `PICTURES` names a folder.
    fn keep_picture(&mut self, name: &str) -> Outcome {
        let Some(folder) = std::env::var_os("PICTURES") else { return Ok(()) };
        let letters = self.browser.picture()?;
        let path = PathBuf::from(folder).join(format!("{name}.png"));
        let failed = |e: std::io::Error| format!("{}: {e}", path.display());
        let file = std::fs::File::create(&path).map_err(failed)?;
        let mut decode = Command::new("base64").arg("-d").stdin(Stdio::piped()).stdout(file).spawn().map_err(failed)?;
        decode.stdin.take().map_or(Ok(()), |mut input| input.write_all(letters.as_bytes())).map_err(failed)?;
        decode.wait().map_err(failed).map(|_| ())
    }
}

/// Compares the ends of scenes with those of the native program until none is left.
fn compare_bits(browser: &mut Browser, left: &Mutex<std::slice::Iter<'_, [&str; 3]>>) -> Outcome {
    loop {
        let next = left.lock().map_err(|_| "a browser was lost")?.next();
        let Some([name, frames, hash]) = next else { return Ok(()) };
        let found = browser.value(&format!("opruga_hash_after({name:?}, {frames})"))?;
        holds(found == *hash, || format!("{name} ends with {found} in the browser and {hash} natively"))?;
    }
}

fn holds(is: bool, otherwise: impl FnOnce() -> String) -> Outcome {
    if is { Ok(()) } else { Err(otherwise()) }
}

fn numbers(list: &Value) -> Vec<f64> {
    list.as_array().into_iter().flatten().filter_map(Value::as_f64).collect()
}
