//! Chromium without a screen, driven through ChromeDriver by the WebDriver protocol (W3C 2018), where the machine has both.

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use ureq::Agent;

use crate::support::installed::{free_ports, or_skipped};

const DRIVER: &str = "/usr/bin/chromedriver";
const BROWSER: &str = "/usr/bin/chromium";
const PATIENCE: Duration = Duration::from_secs(60);

/// A browser with one window; ended when dropped.
pub struct Browser {
    driver: Child,
    session: String,
    agent: Agent,
    _profile: tempfile::TempDir,
}

impl Browser {
    /// Starts one, where the machine has it.
    pub fn start() -> Option<Browser> {
        let is_there = Path::new(DRIVER).is_file() && Path::new(BROWSER).is_file();
        let missing = "no browser is installed (Debian: apt-get install chromium chromium-driver)".to_owned();
        or_skipped("chromium", is_there.then_some(()).ok_or(missing))?;
        let [port] = free_ports();
        let quiet = || Stdio::null();
        let driver =
            Command::new(DRIVER).arg(format!("--port={port}")).stdin(quiet()).stdout(quiet()).stderr(quiet()).spawn().unwrap();
        let agent: Agent = Agent::config_builder().http_status_as_error(false).build().into();
        let profile = tempfile::tempdir().unwrap();
        let mut browser = Browser { driver, session: format!("http://127.0.0.1:{port}"), agent, _profile: profile };
        let data = format!("--user-data-dir={}", browser._profile.path().display());
        let arguments = [
            "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
            "--disable-component-update", "--disable-sync", "--hide-scrollbars", &data,
        ];
        let wanted = json!({ "capabilities": { "alwaysMatch": {
            "browserName": "chrome",
            "goog:chromeOptions": { "binary": BROWSER, "args": arguments },
            "goog:loggingPrefs": { "browser": "ALL" },
        }}});
        let begun = Instant::now();
        let session = loop {
            match browser.agent.post(format!("{}/session", browser.session)).send_json(&wanted) {
                Ok(mut answer) => break answer.body_mut().read_json::<Value>().unwrap(),
                Err(error) => assert!(begun.elapsed() < PATIENCE, "{error}"),
            }
            std::thread::sleep(Duration::from_millis(50));
        };
        let id = session["value"]["sessionId"].as_str().unwrap_or_else(|| panic!("{session}"));
        browser.session = format!("{}/session/{id}", browser.session);
        Some(browser)
    }

    #[track_caller]
    fn command(&self, path: &str, body: &Value) -> Value {
        let mut answer = self.agent.post(format!("{}/{path}", self.session)).send_json(body).unwrap();
        let value = answer.body_mut().with_config().limit(1 << 28).read_json::<Value>().unwrap()["value"].take();
        assert!(value.get("error").is_none(), "{path} {body}: {}", value["message"]);
        value
    }

    pub fn open(&self, url: &str) {
        self.command("url", &json!({ "url": url }));
    }

    /// What a script gives.
    #[track_caller]
    pub fn run(&self, script: &str) -> Value {
        self.command("execute/sync", &json!({ "script": script, "args": [] }))
    }

    /// Waits until an expression is true.
    #[track_caller]
    pub fn until(&self, expression: &str) {
        let begun = Instant::now();
        while self.run(&format!("return Boolean({expression})")) != true {
            assert!(begun.elapsed() < PATIENCE, "not so: {expression}\n{}", self.text("main"));
            std::thread::sleep(Duration::from_millis(40));
        }
    }

    /// Waits until there is something to see for a selector.
    #[track_caller]
    pub fn see(&self, selector: &str) {
        self.until(&seen(selector));
    }

    /// Whether there is something to see for a selector within a time.
    pub fn comes(&self, selector: &str, within: Duration) -> bool {
        let begun = Instant::now();
        while self.run(&format!("return {}", seen(selector))) != true {
            if begun.elapsed() > within {
                return false;
            }
            std::thread::sleep(Duration::from_millis(40));
        }
        true
    }

    pub fn text(&self, selector: &str) -> String {
        let text = self.run(&format!("return document.querySelector({})?.innerText ?? ''", json!(selector)));
        text.as_str().unwrap_or_default().to_owned()
    }

    /// How many elements there are for a selector.
    pub fn count(&self, selector: &str) -> u64 {
        self.run(&format!("return document.querySelectorAll({}).length", json!(selector))).as_u64().unwrap()
    }

    /// The first element for a selector, one that can be seen if there is one, brought into view.
    #[track_caller]
    fn element(&self, selector: &str) -> String {
        let script = format!(
            "const all = [...document.querySelectorAll({})]; const one = all.find((e) => e.getClientRects().length) ?? all[0];
             one?.scrollIntoView({{ block: 'center' }}); return one",
            json!(selector)
        );
        let found = self.run(&script);
        let reference = found.as_object().and_then(|found| found.values().next()?.as_str());
        reference.unwrap_or_else(|| panic!("nothing for {selector}")).to_owned()
    }

    /// Clicks as a user does: only what can be seen and reached.
    #[track_caller]
    pub fn click(&self, selector: &str) {
        self.see(selector);
        let element = self.element(selector);
        self.command(&format!("element/{element}/click"), &json!({}));
    }

    /// Types into a field, or gives the path of a file to one that takes files.
    #[track_caller]
    pub fn fill(&self, selector: &str, text: &str) {
        let element = self.element(selector);
        if self.run(&format!("return document.querySelector({}).type", json!(selector))) != "file" {
            self.command(&format!("element/{element}/clear"), &json!({}));
        }
        self.command(&format!("element/{element}/value"), &json!({ "text": text }));
    }

    /// Presses keys at whatever has the focus.
    pub fn press(&self, keys: &[char]) {
        let down_up = |key: &char| [json!({ "type": "keyDown", "value": key }), json!({ "type": "keyUp", "value": key })];
        let actions: Vec<Value> = keys.iter().flat_map(down_up).collect();
        self.command("actions", &json!({ "actions": [{ "type": "key", "id": "keys", "actions": actions }] }));
    }

    /// Drags the pointer along a way, px.
    pub fn drag(&self, way: &[[f64; 2]]) {
        let to = |[x, y]: &[f64; 2]| json!({ "type": "pointerMove", "duration": 60, "x": x, "y": y, "origin": "viewport" });
        let mut actions: Vec<Value> = way.iter().map(to).collect();
        actions.insert(1, json!({ "type": "pointerDown", "button": 0 }));
        actions.push(json!({ "type": "pointerUp", "button": 0 }));
        let pointer = json!({ "type": "pointer", "id": "mouse", "parameters": { "pointerType": "mouse" }, "actions": actions });
        self.command("actions", &json!({ "actions": [pointer] }));
    }

    /// Size of the window and which colours the system prefers.
    pub fn look(&self, width: u32, height: u32, scheme: &str) {
        let metrics = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        let cdp = |command: &str, params: Value| self.command("goog/cdp/execute", &json!({ "cmd": command, "params": params }));
        cdp("Emulation.setDeviceMetricsOverride", metrics);
        let preferred = json!({ "features": [{ "name": "prefers-color-scheme", "value": scheme }] });
        cdp("Emulation.setEmulatedMedia", preferred);
    }

    pub fn download_into(&self, folder: &Path) {
        let params = json!({ "behavior": "allow", "downloadPath": folder });
        self.command("goog/cdp/execute", &json!({ "cmd": "Browser.setDownloadBehavior", "params": params }));
    }

    /// The whole page as PNG.
    pub fn picture(&self) -> Vec<u8> {
        let params = json!({ "captureBeyondViewport": true });
        let shot = self.command("goog/cdp/execute", &json!({ "cmd": "Page.captureScreenshot", "params": params }));
        base64(shot["data"].as_str().unwrap())
    }

    /// What the page had to complain about.
    pub fn complaints(&self) -> Vec<String> {
        let log = self.command("se/log", &json!({ "type": "browser" }));
        let lines = log.as_array().unwrap().iter().filter(|line| line["level"] != "INFO" && line["level"] != "DEBUG");
        lines.map(|line| line["message"].as_str().unwrap_or_default().to_owned()).collect()
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.agent.delete(&self.session).call();
        let _ = self.driver.kill();
        let _ = self.driver.wait();
    }
}

/// Expression: something can be seen for a selector.
fn seen(selector: &str) -> String {
    format!("[...document.querySelectorAll({})].some((e) => e.getClientRects().length)", json!(selector))
}

/// Bytes of base64 text.
fn base64(text: &str) -> Vec<u8> {
    const DIGITS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let (mut bytes, mut bits, mut count) = (Vec::new(), 0_u32, 0);
    for digit in text.bytes().filter_map(|byte| DIGITS.iter().position(|digit| *digit == byte)) {
        (bits, count) = ((bits << 6) | digit as u32, count + 6);
        if count >= 8 {
            count -= 8;
            bytes.push((bits >> count) as u8);
        }
    }
    bytes
}
