//! A browser without a screen, driven by the WebDriver protocol (W3C 2018), where the machine has it: Chromium, or Firefox where
//! `PERILIFE_TESTS_BROWSER` is `firefox`.

use std::cell::Cell;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use ureq::Agent;

use crate::support::installed::{free_ports, or_skipped};

const PATIENCE: Duration = Duration::from_secs(60);

/// A browser and where its parts are.
struct Kind {
    name: &'static str,
    binaries: &'static [&'static str],
    drivers: &'static [&'static str],
    driver_arguments: &'static [&'static str],
    install: &'static str,
}

const CHROMIUM: Kind = Kind {
    name: "chromium",
    binaries: &["/usr/bin/chromium"],
    drivers: &["/usr/bin/chromedriver"],
    driver_arguments: &[],
    install: "apt-get install chromium chromium-driver",
};
/// Themes and narrow windows are set from the browser's own context, which has to be allowed.
const FIREFOX: Kind = Kind {
    name: "firefox",
    binaries: &["/usr/bin/firefox", "/usr/bin/firefox-esr"],
    drivers: &["/usr/local/bin/geckodriver", "/usr/bin/geckodriver"],
    driver_arguments: &["--allow-system-access"],
    install: "apt-get install firefox-esr; cargo install geckodriver --root /usr/local",
};

/// A browser with one window; ended when dropped.
pub struct Browser {
    kind: &'static Kind,
    driver: Child,
    session: String,
    agent: Agent,
    /// Clicks and fields filled.
    pub actions: Cell<usize>,
    _profile: tempfile::TempDir,
}

impl Browser {
    /// Starts one, where the machine has it.
    pub fn start() -> Option<Browser> {
        let is_firefox = std::env::var("PERILIFE_TESTS_BROWSER").is_ok_and(|name| name == FIREFOX.name);
        let kind = if is_firefox { &FIREFOX } else { &CHROMIUM };
        let there = |paths: &[&'static str]| paths.iter().copied().find(|path| Path::new(path).is_file());
        let parts = there(kind.binaries).zip(there(kind.drivers));
        let (binary, driver) = or_skipped(kind.name, parts.ok_or(format!("not installed ({})", kind.install)))?;
        let [port] = free_ports();
        let quiet = || Stdio::null();
        let mut driver = Command::new(driver);
        driver.arg(format!("--port={port}")).args(kind.driver_arguments).stdin(quiet()).stdout(quiet()).stderr(quiet());
        let driver = driver.spawn().unwrap();
        let agent: Agent = Agent::config_builder().http_status_as_error(false).build().into();
        let profile = tempfile::tempdir().unwrap();
        let mut browser = Browser {
            kind,
            driver,
            session: format!("http://127.0.0.1:{port}"),
            agent,
            actions: Cell::new(0),
            _profile: profile,
        };
        let data = format!("--user-data-dir={}", browser._profile.path().display());
        let arguments = [
            "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
            "--disable-component-update", "--disable-sync", "--hide-scrollbars", &data,
        ];
        let always = if is_firefox {
            json!({ "browserName": "firefox", "moz:firefoxOptions": { "binary": binary, "args": ["-headless"] } })
        } else {
            json!({
                "browserName": "chrome",
                "goog:chromeOptions": { "binary": binary, "args": arguments },
                "goog:loggingPrefs": { "browser": "ALL" },
            })
        };
        let wanted = json!({ "capabilities": { "alwaysMatch": always } });
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

    fn is_firefox(&self) -> bool {
        self.kind.name == FIREFOX.name
    }

    /// What a script gives in the context of Firefox itself.
    fn run_inside(&self, script: &str) -> Value {
        self.command("moz/context", &json!({ "context": "chrome" }));
        let given = self.run(script);
        self.command("moz/context", &json!({ "context": "content" }));
        given
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
        self.actions.set(self.actions.get() + 1);
        let element = self.element(selector);
        self.command(&format!("element/{element}/click"), &json!({}));
    }

    /// Clicks what opens a window; the address of that. A window in front would stop the charts of this one.
    #[track_caller]
    pub fn window_of(&self, selector: &str) -> String {
        self.run("window.opened = null; window.open = (address) => { window.opened = address; };");
        self.click(selector);
        self.until("window.opened");
        self.run("return window.opened").as_str().unwrap().to_owned()
    }

    /// Types into a field, or gives the path of a file to one that takes files.
    #[track_caller]
    pub fn fill(&self, selector: &str, text: &str) {
        self.actions.set(self.actions.get() + 1);
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

    /// A command of the Chrome DevTools protocol.
    fn devtools(&self, command: &str, params: &Value) -> Value {
        self.command("goog/cdp/execute", &json!({ "cmd": command, "params": params }))
    }

    /// Size of the page and which colours the system prefers.
    pub fn look(&self, width: u32, height: u32, scheme: &str) {
        if self.is_firefox() {
            // A window is never below 500 px, the page in it can be.
            self.command("window/rect", &json!({ "width": width, "height": height + 200 }));
            let dark = u32::from(scheme != "dark");
            self.run_inside(&format!(
                "Services.prefs.setIntPref('layout.css.prefers-color-scheme.content-override', {dark});
                 const page = Services.wm.getMostRecentWindow('navigator:browser').gBrowser.selectedBrowser;
                 Object.assign(page.style, {{ minWidth: '0', maxWidth: '{width}px', minHeight: '0', maxHeight: '{height}px' }})"
            ));
            return self.until(&format!("innerWidth === {width} && matchMedia('(prefers-color-scheme: {scheme})').matches"));
        }
        self.devtools(
            "Emulation.setDeviceMetricsOverride",
            &json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false }),
        );
        let preferred = json!({ "features": [{ "name": "prefers-color-scheme", "value": scheme }] });
        self.devtools("Emulation.setEmulatedMedia", &preferred);
    }

    pub fn download_into(&self, folder: &Path) {
        if self.is_firefox() {
            self.run_inside(&format!(
                "Services.prefs.setIntPref('browser.download.folderList', 2);
                 Services.prefs.setStringPref('browser.download.dir', {})",
                json!(folder)
            ));
            return;
        }
        self.devtools("Browser.setDownloadBehavior", &json!({ "behavior": "allow", "downloadPath": folder }));
    }

    /// The whole page as PNG.
    pub fn picture(&self) -> Vec<u8> {
        if self.is_firefox() {
            let mut shot = self.agent.get(format!("{}/moz/screenshot/full", self.session)).call().unwrap();
            let shot = shot.body_mut().with_config().limit(1 << 28).read_json::<Value>().unwrap();
            return base64(shot["value"].as_str().unwrap());
        }
        let shot = self.devtools("Page.captureScreenshot", &json!({ "captureBeyondViewport": true }));
        base64(shot["data"].as_str().unwrap())
    }

    /// What the page had to complain about since it was asked before.
    pub fn complaints(&self) -> Vec<String> {
        if self.is_firefox() {
            let told = self.run_inside(
                "const told = Services.console.getMessageArray().filter((told) => told instanceof Ci.nsIScriptError)
                    .filter((told) => !(told.flags & Ci.nsIScriptError.warningFlag) && told.sourceName.startsWith('http'))
                    .map((told) => told.errorMessage);
                 Services.console.reset();
                 return told",
            );
            return told.as_array().unwrap().iter().map(|message| message.as_str().unwrap_or_default().to_owned()).collect();
        }
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
