//! Controls headless Chromium by its DevTools protocol. Two pipes carry JSON messages, each ended by a zero byte.

use serde_json::{Value, json};
use std::io::{BufRead as _, BufReader, Write as _};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// How long an answer may take on a slow machine.
const PATIENCE: Duration = Duration::from_secs(300);
const NAMES: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];
/// The arguments for WebGL on the processor.
const WEBGL: &str = "--use-angle=swiftshader --enable-unsafe-swiftshader";
/// The arguments for a WebGPU adapter on the processor whose pictures can be seen.
const WEBGPU: &str =
    "--enable-unsafe-webgpu --use-webgpu-adapter=swiftshader --enable-features=Vulkan --use-vulkan=swiftshader";

/// A browser with one page.
pub(super) struct Browser {
    child: Child,
    orders: ChildStdin,
    messages: Receiver<Value>,
    page: Option<String>,
    number: u64,
    /// The errors of the page.
    pub(super) troubles: Vec<String>,
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Whether there is a browser on this machine.
pub(super) fn is_there() -> bool {
    program().is_some()
}

fn program() -> Option<&'static str> {
    let found = |name: &&str| Command::new(name).arg("--version").output().is_ok_and(|output| output.status.success());
    NAMES.into_iter().find(found)
}

impl Browser {
    /// Starts the browser with an empty page, with WebGL and, if requested, WebGPU. Its data and downloads go to a folder.
    ///
    /// # Errors
    /// There is no browser, or it does not answer.
    pub(super) fn start(folder: &Path, webgpu: bool) -> Result<Browser, String> {
        let program = program().ok_or_else(|| format!("there is no browser: none of {}", NAMES.join(", ")))?;
        let drawing = if webgpu { format!("{WEBGL} {WEBGPU}") } else { WEBGL.to_string() };
        // The browser reads commands from file descriptor 3 and writes answers to file descriptor 4.
        let script = format!(
            "exec {program} --headless=new --no-sandbox --no-first-run --disable-dev-shm-usage --mute-audio --hide-scrollbars \
             {drawing} --remote-debugging-pipe --user-data-dir=\"$0\" \
             3<&0 4>&1 </dev/null >/dev/null 2>&1"
        );
        let mut child = Command::new("sh")
            .args(["-c", &script])
            .arg(folder.join(if webgpu { "profile-webgpu" } else { "profile" }))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|e| format!("{program}: {e}"))?;
        let (orders, answers) = (child.stdin.take(), child.stdout.take());
        let (orders, answers) = orders.zip(answers).ok_or("the browser has no pipes")?;
        let (sender, messages) = channel();
        std::thread::spawn(move || {
            for message in BufReader::new(answers).split(0).map_while(Result::ok) {
                let Ok(message) = serde_json::from_slice::<Value>(&message) else { continue };
                if sender.send(message).is_err() {
                    return;
                }
            }
        });
        let mut browser = Browser { child, orders, messages, page: None, number: 0, troubles: Vec::new() };
        let target = browser.call("Target.createTarget", json!({ "url": "about:blank" }))?;
        let attach = json!({ "targetId": target["targetId"], "flatten": true });
        let session = browser.call("Target.attachToTarget", attach)?;
        browser.page = session["sessionId"].as_str().map(String::from);
        for domain in ["Runtime", "Page", "Network"] {
            browser.call(&format!("{domain}.enable"), json!({}))?;
        }
        let downloads = json!({ "behavior": "allow", "downloadPath": folder, "eventsEnabled": false });
        browser.call("Browser.setDownloadBehavior", downloads)?;
        Ok(browser)
    }

    /// Sends a command and waits for the answer.
    ///
    /// # Errors
    /// The errors of the browser.
    pub(super) fn call(&mut self, method: &str, parameters: Value) -> Result<Value, String> {
        self.number += 1;
        let number = self.number;
        let mut order = json!({ "id": number, "method": method, "params": parameters });
        // Commands for the whole browser are not sent to its page.
        if let Some(page) = self.page.as_ref().filter(|_| !method.starts_with("Browser.")) {
            order["sessionId"] = page.as_str().into();
        }
        let sent = self.orders.write_all(order.to_string().as_bytes()).and_then(|()| self.orders.write_all(&[0]));
        sent.and_then(|()| self.orders.flush()).map_err(|e| format!("{method}: the browser has ended: {e}"))?;
        let begin = Instant::now();
        while let Some(left) = PATIENCE.checked_sub(begin.elapsed()) {
            let Ok(message) = self.messages.recv_timeout(left) else { break };
            if message["id"].as_u64() == Some(number) {
                return match message.get("error") {
                    None => Ok(message["result"].clone()),
                    Some(error) => Err(format!("{method}: {}", error["message"])),
                };
            }
            self.hear(&message);
        }
        Err(format!("{method}: no answer within {} s", PATIENCE.as_secs()))
    }

    /// Collects errors of the page.
    fn hear(&mut self, message: &Value) {
        let parameters = &message["params"];
        match message["method"].as_str() {
            Some("Runtime.exceptionThrown") => {
                let details = &parameters["exceptionDetails"];
                self.troubles.push(format!("{} {}", details["text"], details["exception"]["description"]));
            }
            Some("Runtime.consoleAPICalled") if parameters["type"] == "error" => {
                let words = parameters["args"].as_array().into_iter().flatten();
                let text: Vec<String> =
                    words.map(|word| word["value"].as_str().map_or(word.to_string(), String::from)).collect();
                self.troubles.push(text.join(" "));
            }
            _ => {}
        }
    }

    /// Evaluates an expression on the page.
    ///
    /// # Errors
    /// Exceptions of the page.
    pub(super) fn value(&mut self, expression: &str) -> Result<Value, String> {
        let parameters = json!({ "expression": expression, "returnByValue": true, "awaitPromise": true });
        let outcome = self.call("Runtime.evaluate", parameters)?;
        match outcome.get("exceptionDetails") {
            None => Ok(outcome["result"]["value"].clone()),
            Some(details) => Err(format!("{expression}: {} {}", details["text"], details["exception"])),
        }
    }

    /// Sets the size of the page, and whether it has a touch screen.
    pub(super) fn size(&mut self, [width, height]: [u32; 2], fine: f64, phone: bool) -> Result<(), String> {
        let size = json!({ "width": width, "height": height, "deviceScaleFactor": fine, "mobile": phone });
        self.call("Emulation.setDeviceMetricsOverride", size)?;
        let touch = json!({ "enabled": phone, "maxTouchPoints": 5 });
        self.call("Emulation.setTouchEmulationEnabled", touch).map(|_| ())
    }

    /// Opens an address.
    pub(super) fn open(&mut self, address: &str) -> Result<(), String> {
        let outcome = self.call("Page.navigate", json!({ "url": address }))?;
        match outcome.get("errorText") {
            None => Ok(()),
            Some(error) => Err(format!("{address}: {error}")),
        }
    }

    /// A mouse event at a position: `mouseMoved`, `mousePressed`, `mouseReleased`.
    pub(super) fn mouse(&mut self, what: &str, [x, y]: [f64; 2], pressed: bool) -> Result<(), String> {
        let button = if what == "mouseMoved" && !pressed { "none" } else { "left" };
        let event = json!({ "type": what, "x": x, "y": y, "button": button, "buttons": u8::from(pressed),
                            "clickCount": u8::from(what != "mouseMoved") });
        self.call("Input.dispatchMouseEvent", event).map(|_| ())
    }

    /// A wheel event at a position.
    pub(super) fn wheel(&mut self, [x, y]: [f64; 2], down: f64) -> Result<(), String> {
        let event = json!({ "type": "mouseWheel", "x": x, "y": y, "deltaX": 0.0, "deltaY": down });
        self.call("Input.dispatchMouseEvent", event).map(|_| ())
    }

    /// A touch event at positions: `touchStart`, `touchMove`, `touchEnd`.
    pub(super) fn fingers(&mut self, what: &str, at: &[[f64; 2]]) -> Result<(), String> {
        let points: Vec<Value> =
            at.iter().enumerate().map(|(id, [x, y])| json!({ "x": x, "y": y, "id": id })).collect();
        self.call("Input.dispatchTouchEvent", json!({ "type": what, "touchPoints": points })).map(|_| ())
    }

    /// A picture of the page as PNG.
    pub(super) fn picture(&mut self) -> Result<String, String> {
        let picture = self.call("Page.captureScreenshot", json!({ "format": "png" }))?;
        picture["data"].as_str().map(String::from).ok_or_else(|| "there is no picture".into())
    }
}
