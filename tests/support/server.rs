//! The service as a process, and requests to it.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use assert_cmd::cargo::cargo_bin;
use serde_json::Value;
use ureq::Agent;
use ureq::http::{Request, Response};

/// Longest wait for anything, on a machine with other things to do.
pub const PATIENCE: Duration = Duration::from_secs(120);

/// Waits until something is so.
#[track_caller]
pub fn wait(what: &str, mut is_so: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !is_so() {
        assert!(begun.elapsed() < PATIENCE, "{what}");
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Does something within so many seconds.
#[track_caller]
pub fn within<T>(seconds: u64, act: impl FnOnce() -> T) -> T {
    let begun = Instant::now();
    let done = act();
    assert!(begun.elapsed() < Duration::from_secs(seconds), "{:?} for {seconds} s", begun.elapsed());
    done
}

/// A form of parts: name, file name, content.
pub fn multipart(parts: &[(&str, Option<&str>, &str)]) -> String {
    let part = |(name, file, content): &(&str, Option<&str>, &str)| {
        let file = file.map_or_else(String::new, |file| format!("; filename=\"{file}\""));
        format!("--XX\r\nContent-Disposition: form-data; name=\"{name}\"{file}\r\n\r\n{content}\r\n")
    };
    parts.iter().map(part).collect::<String>() + "--XX--\r\n"
}

/// A running `perilife serve` (or `worker`), killed when dropped.
pub struct Server {
    process: Child,
    /// `http://...`; empty for a worker.
    pub url: String,
    agent: Agent,
    token: Option<String>,
}

/// What came back.
pub struct Answer {
    pub status: u16,
    pub headers: Vec<(String, String)>,
    pub body: Vec<u8>,
}

impl Answer {
    pub fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|error| panic!("{error}: {}", self.text()))
    }

    pub fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }

    pub fn header(&self, name: &str) -> Option<&str> {
        self.headers.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }

    /// The same, if it has this status.
    pub fn expect(self, status: u16) -> Answer {
        assert_eq!(self.status, status, "{}", self.text());
        self
    }
}

impl Server {
    /// Starts the service with a free port of this machine; `place` is `["--data", DIR]` or `["--database", URL]`.
    pub fn start(place: &[impl AsRef<str>], more: &[&str]) -> Server {
        Server::start_with(place, more, &[])
    }

    /// The same with variables of its environment.
    pub fn start_with(place: &[impl AsRef<str>], more: &[&str], variables: &[(&str, &str)]) -> Server {
        let door: &[&str] = if more.contains(&"--listen") { &[] } else { &["--listen", "127.0.0.1:0"] };
        let (process, line) = started(&[&["serve"], door].concat(), place, more, variables);
        let url = line.rsplit(' ').next().unwrap_or_default().trim().to_owned();
        assert!(url.starts_with("http://"), "{line}");
        Server { process, url, agent: agent(), token: None }
    }

    /// Starts the service on a store in a folder of its own.
    pub fn alone(more: &[&str]) -> (tempfile::TempDir, Server) {
        let dir = tempfile::tempdir().unwrap();
        let service = Server::start(&in_folder(dir.path()), more);
        (dir, service)
    }

    /// Starts a worker without a door.
    pub fn worker(place: &[impl AsRef<str>], more: &[&str]) -> Server {
        let (process, line) = started(&["worker"], place, more, &[]);
        assert!(line.starts_with("perilife worker"), "{line}");
        Server { process, url: String::new(), agent: agent(), token: None }
    }

    pub fn with_token(mut self, token: &str) -> Server {
        self.token = Some(token.to_owned());
        self
    }

    /// Asks; connection trouble is an error.
    pub fn try_send(&self, method: &str, path: &str, headers: &[(&str, &str)], body: &[u8]) -> Result<Answer, ureq::Error> {
        answer_of(self.agent.run(self.request(method, path, headers, body))?)
    }

    fn request(&self, method: &str, path: &str, headers: &[(&str, &str)], body: &[u8]) -> Request<Vec<u8>> {
        let mut request = Request::builder().method(method).uri(format!("{}{path}", self.url));
        for (name, value) in headers {
            request = request.header(*name, *value);
        }
        if let Some(token) = &self.token {
            request = request.header("authorization", format!("Bearer {token}"));
        }
        request.body(body.to_vec()).unwrap()
    }

    pub fn send(&self, method: &str, path: &str, headers: &[(&str, &str)], body: &[u8]) -> Answer {
        self.try_send(method, path, headers, body).unwrap_or_else(|error| panic!("{method} {path}: {error}"))
    }

    pub fn get(&self, path: &str) -> Answer {
        self.send("GET", path, &[], b"")
    }

    pub fn post(&self, path: &str, body: &Value) -> Answer {
        self.send("POST", path, &[("content-type", "application/json")], body.to_string().as_bytes())
    }

    /// Sends a form: name, file name, content of its parts.
    pub fn send_form(&self, path: &str, parts: &[(&str, Option<&str>, &str)]) -> Answer {
        self.send("POST", path, &[("content-type", "multipart/form-data; boundary=XX")], multipart(parts).as_bytes())
    }

    /// Changes what is said of a job.
    pub fn change(&self, job: &str, body: &Value) -> Answer {
        self.send("PATCH", job, &[("content-type", "application/json")], body.to_string().as_bytes())
    }

    /// Submits and returns the job's address.
    pub fn submit(&self, collection: &str, body: &Value) -> String {
        let job = self.post(&format!("/v1/{collection}"), body).expect(202).json();
        format!("/v1/{collection}/{}", job["id"].as_str().unwrap())
    }

    /// Waits until a job has ended.
    pub fn ended(&self, job: &str) -> Value {
        let mut found = Value::Null;
        wait(job, || {
            // The service may be on its way back.
            let answer = self.try_send("GET", job, &[], b"").ok().filter(|answer| answer.status == 200);
            found = answer.map_or(Value::Null, |answer| answer.json());
            found["state"].as_str().is_some_and(|state| !["queued", "running"].contains(&state))
        });
        found
    }

    /// Waits until a job has ended well.
    pub fn succeeded(&self, job: &str) -> Value {
        let ended = self.ended(job);
        assert_eq!(ended["state"], "succeeded", "{ended:#}");
        ended
    }

    pub fn file(&self, job: &str, name: &str) -> Vec<u8> {
        self.file_of(&format!("{job}/files/{name}"))
    }

    pub fn file_of(&self, path: &str) -> Vec<u8> {
        self.get(path).expect(200).body
    }

    /// Asks for something and does not read the answer; the connection stays open as long as what is returned.
    pub fn ask_and_do_not_read(&self, path: &str) -> TcpStream {
        self.connect(format!("GET {path} HTTP/1.1\r\nHost: localhost\r\n\r\n").as_bytes())
    }

    /// A connection over which these bytes were sent, as far as they are taken.
    pub fn connect(&self, bytes: &[u8]) -> TcpStream {
        let mut stream = TcpStream::connect(self.url.trim_start_matches("http://")).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        let _ = stream.write_all(bytes);
        stream
    }

    /// Memory that the process has now, MB.
    pub fn memory_mb(&self) -> f64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.process.id())).unwrap();
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
        line.trim().trim_end_matches(" kB").parse::<f64>().unwrap() / 1000.0
    }

    /// Events of a job until its end: names and data.
    pub fn events(&self, job: &str, headers: &[(&str, &str)]) -> Vec<(String, Value)> {
        let mut events = Vec::new();
        self.each_event(job, headers, |name, data| events.push((name.to_owned(), data)));
        events
    }

    /// Does something with each event of a job as it comes.
    pub fn each_event(&self, job: &str, headers: &[(&str, &str)], mut take: impl FnMut(&str, Value)) {
        let response = self.agent.run(self.request("GET", &format!("{job}/events"), headers, b"")).unwrap();
        assert_eq!(response.status(), 200);
        let mut name = String::new();
        for line in BufReader::new(response.into_body().into_reader()).lines() {
            let line = line.unwrap();
            if let Some(value) = line.strip_prefix("event: ") {
                name = value.to_owned();
            } else if let Some(value) = line.strip_prefix("data: ") {
                take(&name, serde_json::from_str(value).unwrap());
            }
        }
    }

    /// Processes that it has started and that still run.
    pub fn children(&self) -> Vec<u32> {
        let own = self.process.id();
        let of_task = |task: std::fs::DirEntry| std::fs::read_to_string(task.path().join("children")).unwrap_or_default();
        let tasks = std::fs::read_dir(format!("/proc/{own}/task")).unwrap().flatten().map(of_task).collect::<String>();
        tasks.split_whitespace().map(|child| child.parse().unwrap()).collect()
    }

    /// Ends the process without a warning.
    pub fn kill(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }

    /// Sends the process a signal.
    pub fn signal(&self, name: &str) {
        let sent = Command::new("kill").args([name, &self.process.id().to_string()]).status();
        assert!(sent.is_ok_and(|sent| sent.success()), "{name}");
    }

    /// Asks the process to stop, and waits for it.
    pub fn stop(&mut self) {
        self.signal("-TERM");
        wait("it does not stop", || self.process.try_wait().unwrap().is_some());
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.kill();
    }
}

/// Starts the program and returns what it says once it is ready.
fn started(command: &[&str], place: &[impl AsRef<str>], more: &[&str], variables: &[(&str, &str)]) -> (Child, String) {
    let mut process = Command::new(cargo_bin("perilife"))
        .args(command.iter().copied().chain(place.iter().map(AsRef::as_ref)).chain(more.iter().copied()))
        .env("RUST_LOG", "perilife=error")
        .envs(variables.iter().copied())
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stderr = BufReader::new(process.stderr.take().unwrap());
    let mut line = String::new();
    while !line.starts_with("perilife ") {
        line.clear();
        assert!(stderr.read_line(&mut line).unwrap() > 0, "it ended before it was ready");
        if !line.starts_with("perilife ") {
            eprint!("{line}");
        }
    }
    // What it says later is shown with the test that fails.
    std::thread::spawn(move || {
        let mut rest = String::new();
        let _ = stderr.read_to_string(&mut rest);
        if !rest.is_empty() {
            eprintln!("{rest}");
        }
    });
    (process, line)
}

fn agent() -> Agent {
    Agent::config_builder()
        .http_status_as_error(false)
        .timeout_connect(Some(Duration::from_secs(5)))
        .timeout_recv_response(Some(PATIENCE))
        .build()
        .into()
}

fn answer_of(mut response: Response<ureq::Body>) -> Result<Answer, ureq::Error> {
    let headers = response.headers().iter();
    let headers = headers.map(|(name, value)| (name.to_string(), value.to_str().unwrap_or_default().to_owned())).collect();
    let body = response.body_mut().with_config().limit(1 << 30).read_to_vec()?;
    Ok(Answer { status: response.status().as_u16(), headers, body })
}

/// Where a service keeps its jobs: a folder, or a database.
pub fn in_folder(folder: &Path) -> [String; 2] {
    ["--data".to_owned(), folder.display().to_string()]
}
