//! A headless Chromium, controlled through pipes by the DevTools protocol.

use std::io::{BufRead as _, BufReader, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result, anyhow, bail};
use serde_json::{Value, json};

/// The longest wait for one answer: WebGL runs in software here.
const PATIENCE: Duration = Duration::from_secs(60);

/// The browser, if this machine has one.
pub(crate) fn find() -> Option<PathBuf> {
    let folders = std::env::var_os("PATH")?;
    let names = ["chromium", "chromium-browser", "google-chrome"];
    std::env::split_paths(&folders)
        .flat_map(|folder| names.map(|name| folder.join(name)))
        .find(|path| path.is_file())
}

/// A browser with one tab at a time.
pub(crate) struct Chrome {
    child: Child,
    input: ChildStdin,
    messages: Receiver<Value>,
    target: Option<String>,
    session: Option<String>,
    next: u64,
    /// Errors on the console, uncaught exceptions and failed loads.
    pub(crate) complaints: Vec<String>,
    /// Every requested address.
    pub(crate) requests: Vec<String>,
    _profile: tempfile::TempDir,
}

impl Chrome {
    pub(crate) fn start(program: &Path) -> Result<Self> {
        let profile = tempfile::tempdir()?;
        // The protocol uses the descriptors 3 and 4: the shell connects them to our ends of
        // standard input and output.
        let mut child = Command::new("sh")
            .args(["-c", "exec \"$0\" \"$@\" 3<&0 4>&1 >/dev/null 2>&1 </dev/null"])
            .arg(program)
            .args([
                "--headless",
                "--no-sandbox",
                "--disable-quic",
                "--no-first-run",
                "--disable-background-networking",
                "--disable-component-update",
                "--disable-sync",
                "--use-gl=angle",
                "--use-angle=swiftshader",
                "--enable-unsafe-swiftshader",
                "--hide-scrollbars",
                "--window-size=1200,900",
                "--remote-debugging-pipe",
            ])
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .arg("about:blank")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()?;
        let input = child.stdin.take().context("no pipe to the browser")?;
        let output = child.stdout.take().context("no pipe from the browser")?;
        let (sender, messages) = channel();
        std::thread::spawn(move || {
            for message in BufReader::new(output).split(0).map_while(Result::ok) {
                let Ok(message) = serde_json::from_slice(&message) else { continue };
                if sender.send(message).is_err() {
                    return;
                }
            }
        });
        Ok(Self {
            child,
            input,
            messages,
            target: None,
            session: None,
            next: 0,
            complaints: vec![],
            requests: vec![],
            _profile: profile,
        })
    }

    /// Replaces the open tab by a new one with no shared state.
    pub(crate) fn new_tab(&mut self) -> Result<()> {
        self.session = None;
        if let Some(old) = self.target.take() {
            self.call("Target.closeTarget", json!({"targetId": old}))?;
        }
        let target = self.call("Target.createTarget", json!({"url": "about:blank"}))?;
        let attach = json!({"targetId": target["targetId"], "flatten": true});
        let session = self.call("Target.attachToTarget", attach)?;
        self.target = target["targetId"].as_str().map(String::from);
        self.session = session["sessionId"].as_str().map(String::from);
        self.complaints.clear();
        self.requests.clear();
        for domain in ["Page", "Runtime", "Log", "Network"] {
            self.call(&format!("{domain}.enable"), json!({}))?;
        }
        // Keys reach a tab only while it has the focus.
        self.call("Emulation.setFocusEmulationEnabled", json!({"enabled": true}))?;
        Ok(())
    }

    /// Sends one command and waits for its answer.
    pub(crate) fn call(&mut self, method: &str, parameters: Value) -> Result<Value> {
        self.next += 1;
        let mut message = json!({"id": self.next, "method": method, "params": parameters});
        if let Some(session) = &self.session {
            message["sessionId"] = session.as_str().into();
        }
        self.input.write_all(format!("{message}\0").as_bytes())?;
        self.input.flush()?;
        let until = Instant::now() + PATIENCE;
        loop {
            let left = until.saturating_duration_since(Instant::now());
            let answer = self
                .messages
                .recv_timeout(left)
                .map_err(|e| anyhow!("the browser did not answer {method}: {e}"))?;
            if answer["id"] == self.next {
                if let Some(error) = answer.get("error") {
                    bail!("{method}: {error}");
                }
                return Ok(answer["result"].clone());
            }
            self.notice(&answer);
        }
    }

    fn notice(&mut self, event: &Value) {
        let about = &event["params"];
        match event["method"].as_str() {
            Some("Runtime.exceptionThrown") => self.complaints.push(about.to_string()),
            Some("Runtime.consoleAPICalled") if about["type"] == "error" => {
                self.complaints.push(about["args"].to_string());
            }
            Some("Log.entryAdded") if about["entry"]["level"] == "error" => {
                self.complaints.push(about["entry"].to_string());
            }
            Some("Network.requestWillBeSent") => {
                let url = about["request"]["url"].as_str().unwrap_or_default();
                self.requests.push(url.chars().take(100).collect());
            }
            _ => {}
        }
    }

    /// Opens a page and waits until it reports that it is ready.
    pub(crate) fn open(&mut self, url: &str) -> Result<()> {
        self.call("Page.navigate", json!({"url": url}))?;
        let until = Instant::now() + PATIENCE;
        while self.run("document.documentElement?.dataset.ready ?? ''")? != "1" {
            if Instant::now() > until {
                bail!("{url} never became ready");
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        Ok(())
    }

    /// The value of an expression in the page; promises are awaited.
    pub(crate) fn run(&mut self, expression: &str) -> Result<Value> {
        let answer = self.call(
            "Runtime.evaluate",
            json!({"expression": expression, "returnByValue": true, "awaitPromise": true}),
        )?;
        match answer.get("exceptionDetails") {
            Some(details) => bail!("{expression}: {details}"),
            None => Ok(answer["result"]["value"].clone()),
        }
    }

    /// Waits until an expression has an accepted value, and returns it; after a time limit, the
    /// last value.
    pub(crate) fn until(
        &mut self,
        expression: &str,
        wanted: impl Fn(&Value) -> bool,
    ) -> Result<Value> {
        let until = Instant::now() + PATIENCE;
        loop {
            let value = self.run(expression)?;
            if wanted(&value) || Instant::now() > until {
                return Ok(value);
            }
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    /// The value of an expression that must be a number.
    pub(crate) fn number(&mut self, expression: &str) -> Result<f64> {
        let value = self.run(expression)?;
        value.as_f64().with_context(|| format!("{expression} is {value}"))
    }

    /// Drags the mouse from one place to another.
    pub(crate) fn drag(&mut self, from: [f64; 2], to: [f64; 2]) -> Result<()> {
        let mut mouse = |kind: &str, [x, y]: [f64; 2], buttons: u8| {
            let button = if kind == "mouseMoved" && buttons == 0 { "none" } else { "left" };
            let event = json!({
                "type": kind, "x": x, "y": y, "button": button, "buttons": buttons, "clickCount": 1
            });
            self.call("Input.dispatchMouseEvent", event)
        };
        mouse("mouseMoved", from, 0)?;
        mouse("mousePressed", from, 1)?;
        if from != to {
            for step in 1..=4 {
                let t = f64::from(step) / 4.0;
                mouse("mouseMoved", [0, 1].map(|k| from[k] + (to[k] - from[k]) * t), 1)?;
            }
        }
        mouse("mouseReleased", to, 0)?;
        Ok(())
    }

    /// Saves a picture of the tab in the folder `FAIRING_SCREENSHOTS`, for visual inspection.
    pub(crate) fn picture(&mut self, name: &str) -> Result<()> {
        let Some(folder) = std::env::var_os("FAIRING_SCREENSHOTS") else { return Ok(()) };
        let answer = self.call("Page.captureScreenshot", json!({"format": "png"}))?;
        let data = answer["data"].as_str().context("no picture")?;
        let bytes = base64::Engine::decode(&base64::engine::general_purpose::STANDARD, data)?;
        std::fs::write(Path::new(&folder).join(format!("{name}.png")), bytes)?;
        Ok(())
    }
}

impl Drop for Chrome {
    fn drop(&mut self) {
        // The process may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
