//! A headless Chromium, driven over its DevTools protocol.

use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tempfile::TempDir;

const PATIENCE: Duration = Duration::from_secs(300);

/// One browser with one page. Ends with this value.
pub(super) struct Browser {
    process: Child,
    calls_to: ChildStdin,
    answers: Receiver<Value>,
    session: Option<String>,
    calls: u64,
    /// Events of the page, in order.
    pub(super) events: Vec<Value>,
    /// Last: the browser writes here until it ends.
    _profile: TempDir,
}

impl Browser {
    /// `None`, with a message, where there is no Chromium: names on PATH, or the program in `CHROME`.
    pub(super) fn start() -> Option<Browser> {
        let Some(program) = program() else {
            eprintln!(
                "skipped: no chromium, chromium-browser or google-chrome on PATH, and CHROME is not set"
            );
            return None;
        };
        let profile = TempDir::new().expect("a folder for the profile");
        // Chromium reads calls from descriptor 3 and writes answers to descriptor 4.
        let mut process = Command::new("sh")
            .args(["-c", "exec \"$@\" 3<&0 4>&1 </dev/null >/dev/null", "sh"])
            .arg(program)
            .args(["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"])
            .args(["--disable-background-networking", "--disable-component-update", "--disable-sync"])
            .args(["--hide-scrollbars", "--force-color-profile=srgb", "--remote-debugging-pipe"])
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("Chromium starts");
        let calls_to = process.stdin.take().expect("a pipe");
        let answers = answers(process.stdout.take().expect("a pipe"));
        let mut browser = Browser {
            process,
            calls_to,
            answers,
            session: None,
            calls: 0,
            events: Vec::new(),
            _profile: profile,
        };
        let target = browser.call("Target.createTarget", json!({ "url": "about:blank" }));
        let attach = json!({ "targetId": target["targetId"], "flatten": true });
        let session = browser.call("Target.attachToTarget", attach);
        browser.session = session["sessionId"].as_str().map(str::to_owned);
        for domain in ["Page", "Runtime", "Log", "Network"] {
            browser.call(&format!("{domain}.enable"), json!({}));
        }
        Some(browser)
    }

    /// Loads a page and waits until it is there. Events of an earlier page are forgotten.
    pub(super) fn open(&mut self, url: &str) {
        // The same address with another fragment would not load again.
        self.call("Page.navigate", json!({ "url": "about:blank" }));
        self.wait("document.readyState === 'complete' && location.href === 'about:blank'");
        self.events.clear();
        self.call("Page.navigate", json!({ "url": url }));
        self.wait("document.readyState === 'complete' && location.protocol === 'file:'");
    }

    /// Value of an expression in the page.
    pub(super) fn eval(&mut self, expression: &str) -> Value {
        let ask = json!({ "expression": expression, "returnByValue": true, "awaitPromise": true });
        let answer = self.call("Runtime.evaluate", ask);
        assert!(answer.get("exceptionDetails").is_none(), "{expression}: {answer}");
        answer["result"]["value"].clone()
    }

    /// As [`Browser::eval`], for a number.
    pub(super) fn number(&mut self, expression: &str) -> f64 {
        let value = self.eval(expression);
        value.as_f64().unwrap_or_else(|| panic!("{expression} is {value}, not a number"))
    }

    /// As [`Browser::eval`], for text.
    pub(super) fn text(&mut self, expression: &str) -> String {
        let value = self.eval(expression);
        value.as_str().unwrap_or_else(|| panic!("{expression} is {value}, not text")).to_owned()
    }

    /// Waits until an expression is true.
    pub(super) fn wait(&mut self, expression: &str) {
        let start = Instant::now();
        while self.eval(expression) != true {
            assert!(start.elapsed() < PATIENCE, "{expression} does not come true");
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Middle of an element in the window [px], after it is scrolled to the middle of the window.
    pub(super) fn middle(&mut self, selector: &str) -> (f64, f64) {
        let place = self.eval(&format!(
            "(() => {{ const e = document.querySelector({selector:?}); \
             e.scrollIntoView({{ block: 'center', behavior: 'instant' }}); \
             const b = e.getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]; }})()"
        ));
        let coordinate =
            |index: usize| place[index].as_f64().unwrap_or_else(|| panic!("{selector}: {place}"));
        (coordinate(0), coordinate(1))
    }

    /// A mouse event: `mousePressed`, `mouseMoved`, `mouseReleased`.
    pub(super) fn mouse(&mut self, kind: &str, (x, y): (f64, f64)) {
        let pressed = i32::from(kind != "mouseMoved" || self.eval("window.pressed ?? false") == true);
        let button = if pressed == 1 { "left" } else { "none" };
        let event =
            json!({ "type": kind, "x": x, "y": y, "button": button, "buttons": pressed, "clickCount": 1 });
        self.call("Input.dispatchMouseEvent", event);
        let _ = self.eval(&format!("window.pressed = {}", kind == "mousePressed"));
    }

    /// A click in the middle of an element.
    pub(super) fn click(&mut self, selector: &str) {
        let place = self.middle(selector);
        self.mouse("mouseMoved", place);
        self.mouse("mousePressed", place);
        self.mouse("mouseReleased", place);
    }

    /// The wheel over a place; `dy` > 0 is towards the user.
    pub(super) fn wheel(&mut self, (x, y): (f64, f64), dy: f64) {
        let event = json!({ "type": "mouseWheel", "x": x, "y": y, "deltaX": 0, "deltaY": dy });
        self.call("Input.dispatchMouseEvent", event);
    }

    /// A key, by its name in `KeyboardEvent.key`.
    pub(super) fn key(&mut self, key: &str) {
        for kind in ["keyDown", "keyUp"] {
            self.call("Input.dispatchKeyEvent", json!({ "type": kind, "key": key, "code": key }));
        }
    }

    /// Width of the window [px] and what the system prefers, `light` or `dark`.
    pub(super) fn emulate(&mut self, width: u32, scheme: &str) {
        let size = json!({ "width": width, "height": 900, "deviceScaleFactor": 1, "mobile": false });
        self.call("Emulation.setDeviceMetricsOverride", size);
        let features = json!([{ "name": "prefers-color-scheme", "value": scheme }]);
        self.call("Emulation.setEmulatedMedia", json!({ "features": features }));
    }

    /// Where files go that the page saves.
    pub(super) fn download_to(&mut self, folder: &Path) {
        self.call("Page.setDownloadBehavior", json!({ "behavior": "allow", "downloadPath": folder }));
    }

    /// Saves the whole page as PNG.
    pub(super) fn screenshot(&mut self, path: &Path) {
        use base64::Engine;
        let shot =
            self.call("Page.captureScreenshot", json!({ "format": "png", "captureBeyondViewport": true }));
        let data = shot["data"].as_str().expect("a picture");
        let bytes = base64::engine::general_purpose::STANDARD.decode(data).expect("base64");
        std::fs::write(path, bytes).expect("the picture is written");
    }

    /// Errors and warnings of the page since it was opened.
    pub(super) fn complaints(&mut self) -> Vec<String> {
        // An answer comes after the events before it.
        let _ = self.eval("0");
        let events = self.events.iter().filter(|event| {
            let params = &event["params"];
            match event["method"].as_str() {
                Some("Runtime.exceptionThrown") => true,
                Some("Log.entryAdded") => params["entry"]["level"] != "verbose",
                Some("Runtime.consoleAPICalled") => {
                    ["error", "warning", "assert"].iter().any(|kind| params["type"] == *kind)
                }
                _ => false,
            }
        });
        events.map(Value::to_string).collect()
    }

    /// Addresses that the page has asked for since it was opened, without those inside it.
    pub(super) fn requests(&self) -> Vec<String> {
        let sent = self.events.iter().filter(|event| event["method"] == "Network.requestWillBeSent");
        let url = sent.filter_map(|event| event["params"]["request"]["url"].as_str());
        url.filter(|url| !url.starts_with("data:")).map(str::to_owned).collect()
    }

    fn call(&mut self, method: &str, params: Value) -> Value {
        self.calls += 1;
        let mut call = json!({ "id": self.calls, "method": method, "params": params });
        if let Some(session) = &self.session {
            call["sessionId"] = json!(session);
        }
        write!(self.calls_to, "{call}\0").expect("the browser takes a call");
        loop {
            let answer = self.answers.recv_timeout(PATIENCE);
            let mut answer = answer.unwrap_or_else(|error| panic!("no answer to {method}: {error}"));
            if answer["id"] == self.calls {
                assert!(answer.get("error").is_none(), "{method}: {answer}");
                return answer["result"].take();
            }
            if answer.get("method").is_some() {
                self.events.push(answer);
            }
        }
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// The program to start.
fn program() -> Option<PathBuf> {
    if let Some(program) = std::env::var_os("CHROME") {
        return Some(program.into());
    }
    let folders: Vec<PathBuf> = std::env::split_paths(&std::env::var_os("PATH")?).collect();
    let names = ["chromium", "chromium-browser", "google-chrome"];
    names
        .iter()
        .flat_map(|name| folders.iter().map(move |folder| folder.join(name)))
        .find(|path| path.is_file())
}

/// Reads answers and events, each of which ends in a zero, on a thread of its own, so that waiting for one has a limit.
fn answers(from: ChildStdout) -> Receiver<Value> {
    let (sender, receiver) = channel();
    std::thread::spawn(move || {
        for message in BufReader::new(from).split(0).map_while(Result::ok) {
            let Ok(message) = serde_json::from_slice(&message) else { continue };
            if sender.send(message).is_err() {
                return;
            }
        }
    });
    receiver
}
