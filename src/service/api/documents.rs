//! The body of a request to what is to be run or checked: JSON or a form, a table or TOML text, files beside it.

use std::collections::BTreeMap;
use std::sync::Arc;

use axum::body::Bytes;
use axum::extract::multipart::MultipartRejection;
use axum::extract::{FromRequest, Multipart, Request};
use axum::http::{StatusCode, header};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use sha2::{Digest, Sha256};
use utoipa::ToSchema;

use super::App;
use super::app::{BodyPlace, Caller};
use super::security::BODY_WITHIN;
use crate::job::{FITTED, JobKind, Look, State, Submission, is_id};
use crate::problem::{Answer, Problem};
use crate::store::{Origin, hex};
use crate::worker;
use perilife_base::error::input;
use perilife_base::watch::{self, Watch};

/// Longest input, bytes; files beside it may be as large as bodies are.
const INPUT_MAX: usize = 1 << 20;
/// Most parts of a JSON body: each takes a hundred times its room in memory.
const PARTS_MAX: usize = 200_000;
/// Longest text and files, bytes, that no process of its own looks at before they are accepted: it would take longer than they can.
const SHORT: usize = 64 << 10;
/// Longest name of a case or file, bytes.
const NAME_MAX: usize = 200;

/// What is asked for, as it came.
#[derive(Debug, Clone, Default, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct JobRequest {
    /// Name of the case.
    pub name: Option<String>,
    /// The input: TOML text, or an object of the same keys.
    #[schema(value_type = Value)]
    pub input: Option<Value>,
    /// Files that the input names, as text.
    #[serde(default)]
    #[schema(value_type = BTreeMap<String, String>)]
    pub files: BTreeMap<String, FileText>,
    /// Calibration whose law is to be used, whatever `[fatigue]` says.
    pub calibration: Option<String>,
    /// Options of the command: `method` (a list) for stress intensity factors; `sensitivities`, `residual_strength`, `inspect_from_mm`,
    /// `factor`, `tip`, `pod` (a50,a90) and `measured` (name of a file of the request) for predictions.
    #[serde(default)]
    #[schema(value_type = Value)]
    pub options: BTreeMap<String, Value>,
}

/// Content of a file.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(from = "String")]
pub struct FileText(pub Vec<u8>);

impl From<String> for FileText {
    fn from(text: String) -> Self {
        FileText(text.into_bytes())
    }
}

/// A form of files and fields.
pub type Fields = (BTreeMap<String, String>, Vec<(String, Vec<u8>)>);

/// A body that was read, with its room among those that may be in memory, and its hash.
pub struct Body {
    pub asked: JobRequest,
    /// Hash of it.
    pub fingerprint: String,
    /// Given back when the body is done with.
    pub room: BodyPlace,
}

/// What a body is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Json,
    Toml,
    Form,
}

/// By its media type, in which case does not count (RFC 9110, 8.3.1). A body without one is taken for JSON.
fn kind_of(request: &Request) -> Answer<Kind> {
    let text = |name| request.headers().get(name).map(|value| String::from_utf8_lossy(value.as_bytes()).into_owned());
    let refused = |what: String| Err(Problem::new(StatusCode::UNSUPPORTED_MEDIA_TYPE, "Unsupported media type", what));
    if let Some(coding) = text(header::CONTENT_ENCODING).filter(|coding| !coding.trim().eq_ignore_ascii_case("identity")) {
        return refused(format!("the body comes in content-encoding {coding:?}; send it as it is"));
    }
    let given = text(header::CONTENT_TYPE).unwrap_or_default();
    match &*given.split(';').next().unwrap_or_default().trim().to_ascii_lowercase() {
        "" | "application/json" => Ok(Kind::Json),
        "application/toml" | "application/x-toml" | "text/toml" | "text/x-toml" => Ok(Kind::Toml),
        "multipart/form-data" => Ok(Kind::Form),
        other => refused(format!(
            "unsupported content type {other:?}; send TOML with content-type: application/toml, JSON with application/json, or a form with \
             multipart/form-data"
        )),
    }
}

/// Where a JSON value has a null, which TOML has not: the keys to it.
fn null_in(value: &Value, above: &str) -> Option<String> {
    let below = |key: &str| if above.is_empty() { key.to_owned() } else { format!("{above}.{key}") };
    match value {
        Value::Null => Some(above.to_owned()),
        Value::Object(fields) => fields.iter().find_map(|(key, value)| null_in(value, &below(key))),
        Value::Array(items) => items.iter().enumerate().find_map(|(i, value)| null_in(value, &format!("{above}[{i}]"))),
        _ => None,
    }
}

/// Reads a body.
pub async fn read(app: &App, caller: &Caller, request: Request) -> Answer<Body> {
    let room = app.bodies.wait(caller).await?;
    let kind = kind_of(&request)?;
    let (asked, fingerprint) = if kind == Kind::Form {
        let (mut fields, files) = form(app, request).await?;
        let mut hash = Sha256::new();
        let fields_and_files = fields.iter().map(|(name, value)| (name, value.as_bytes()));
        for (name, content) in fields_and_files.chain(files.iter().map(|(name, content)| (name, &content[..]))) {
            // With their lengths, so that no two forms run together to the same bytes.
            hash.update(format!("{} {} ", name.len(), content.len()));
            hash.update(name);
            hash.update(content);
        }
        let mut field = |name: &str| fields.remove(name);
        let asked = JobRequest {
            name: field("name"),
            input: field("input").map(input_of_form).transpose()?,
            calibration: field("calibration"),
            options: field("options")
                .map(|text| json(text.as_bytes(), "`options`", "give an object"))
                .transpose()?
                .unwrap_or_default(),
            files: files.into_iter().map(|(name, content)| (name, FileText(content))).collect(),
        };
        if let Some(name) = fields.keys().next() {
            let detail = format!("the form has a field `{name}`; known are input, name, calibration, options and file");
            return Err(Problem::bad_request(detail));
        }
        (asked, hex(&hash.finalize()))
    } else {
        let bytes = bytes(request).await?;
        let fingerprint = hex(&Sha256::digest(&bytes));
        let asked = if kind == Kind::Toml {
            if bytes.len() > INPUT_MAX {
                return Err(too_long());
            }
            let text = String::from_utf8(bytes.into()).map_err(|_| Problem::bad_request("the body is not UTF-8 text"))?;
            JobRequest { input: Some(Value::String(text)), ..JobRequest::default() }
        } else {
            json(&bytes, "the body", "known are input, name, calibration, files, options")?
        };
        (asked, fingerprint)
    };
    let most = app.limits.files;
    if asked.files.len() > most {
        return Err(Problem::too_large(format!("{} files are more than the {most} this server takes", asked.files.len())));
    }
    Ok(Body { asked, fingerprint, room })
}

/// A small body, an object in JSON; `known` says which keys it may have.
pub async fn object<T: DeserializeOwned>(app: &App, caller: &Caller, request: Request, known: &str) -> Answer<T> {
    let _room = app.bodies.wait(caller).await?;
    if kind_of(&request)? != Kind::Json {
        let detail = "send an object in JSON with content-type: application/json";
        return Err(Problem::new(StatusCode::UNSUPPORTED_MEDIA_TYPE, "Unsupported media type", detail));
    }
    json(&bytes(request).await?, "the body", known)
}

/// JSON of bounded size in memory.
fn json<T: DeserializeOwned>(bytes: &[u8], what: &str, known: &str) -> Answer<T> {
    if parts(bytes) > PARTS_MAX {
        return Err(Problem::too_large(format!("{what} has more than {PARTS_MAX} parts; send readings as files")));
    }
    let refused = |error| Problem::bad_request(format!("{what} is not JSON of the expected form: {error}; {known}"));
    serde_json::from_slice(bytes).map_err(refused)
}

/// The input of a form: TOML, or what no TOML begins with, an object in JSON.
fn input_of_form(text: String) -> Answer<Value> {
    match text.trim_start().starts_with('{') {
        true if text.len() > INPUT_MAX => Err(too_long()),
        true => json(text.as_bytes(), "`input`", "give an object of the keys of the TOML"),
        false => Ok(Value::String(text)),
    }
}

async fn bytes(request: Request) -> Answer<Bytes> {
    let read =
        tokio::time::timeout(BODY_WITHIN, Bytes::from_request(request, &())).await.map_err(|_| Problem::too_slow(BODY_WITHIN))?;
    read.map_err(|rejection| refused(rejection.status(), &rejection.body_text()))
}

fn refused(status: StatusCode, text: &str) -> Problem {
    match status {
        StatusCode::PAYLOAD_TOO_LARGE => Problem::too_large("the body is larger than this server takes; see /v1/service"),
        _ => Problem::bad_request(format!("the body cannot be read: {text}")),
    }
}

/// Reads a form; parts with a file name are files.
pub async fn form(app: &App, request: Request) -> Answer<Fields> {
    tokio::time::timeout(BODY_WITHIN, parts_of_form(app, request)).await.map_err(|_| Problem::too_slow(BODY_WITHIN))?
}

async fn parts_of_form(app: &App, request: Request) -> Answer<Fields> {
    let mut parts = Multipart::from_request(request, &()).await.map_err(|rejection: MultipartRejection| {
        Problem::bad_request(format!("the body is no multipart form: {}", rejection.body_text()))
    })?;
    let (mut fields, mut files) = (BTreeMap::new(), Vec::new());
    let broken = |error: axum::extract::multipart::MultipartError| refused(error.status(), &error.body_text());
    while let Some(part) = parts.next_field().await.map_err(broken)? {
        let (name, file) = (part.name().unwrap_or_default().to_owned(), part.file_name().map(str::to_owned));
        let content = part.bytes().await.map_err(broken)?.to_vec();
        match file {
            // `curl -F input=@case.toml` sends a field with the name of a file.
            Some(file) if name != "input" => {
                check_name("file", &file)?;
                if files.iter().any(|(other, _)| *other == file) {
                    return Err(Problem::bad_request(format!("two files are called {file:?}; give every file its own name")));
                }
                files.push((file, content));
            }
            _ => {
                let text = String::from_utf8(content).map_err(|_| Problem::bad_request(format!("`{name}` is not UTF-8 text")))?;
                fields.insert(name, text);
            }
        }
        if files.len() > app.limits.files {
            return Err(Problem::too_large(format!("more files than the {} this server takes", app.limits.files)));
        }
    }
    Ok((fields, files))
}

/// Refuses what is no name of a case or file.
pub fn check_name(key: &str, name: &str) -> Answer<()> {
    let shows = name.chars().any(|c| !c.is_whitespace()) && !name.chars().any(|c| c.is_control() || is_unseen(c));
    if shows && name.len() <= NAME_MAX && !matches!(name, "." | "..") {
        return Ok(());
    }
    let remedy = format!("give 1 to {NAME_MAX} bytes of text that shows, without line breaks, and not . or ..");
    Err(input(key, format!("{name:?}"), "is no name", remedy).into())
}

/// Whether a character shows nothing, or turns what stands beside it around: separators of lines, joiners, marks of direction and of the
/// byte order, fillers.
fn is_unseen(c: char) -> bool {
    matches!(c, '\u{ad}' | '\u{34f}' | '\u{61c}' | '\u{115f}' | '\u{1160}' | '\u{17b4}' | '\u{17b5}' | '\u{180b}'..='\u{180f}'
        | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{2800}' | '\u{3164}' | '\u{feff}'
        | '\u{ffa0}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}')
}

/// What was asked for as it can be stored and run, after a look at it as this kind of job; what the look found goes before.
pub async fn looked(app: &App, body: Body, kind: Option<JobKind>) -> Answer<(String, Submission, BodyPlace)> {
    let is_text = body.asked.input.as_ref().is_some_and(Value::is_string);
    let submission = submission(app, kind, body.asked).await?;
    let is_short = submission.text.len() + submission.files.iter().map(|(_, content)| content.len()).sum::<usize>() <= SHORT;
    let check = Look::Check { kind, submission, limits: [app.limits.points, app.limits.case_bytes] };
    match look(app, check, body.room, kind.is_none() || !is_short).await {
        Ok((found, Look::Check { submission, .. }, room)) => Ok((found, submission, room)),
        Ok(_) => Err(Problem::internal()),
        Err(problem) if is_text => Err(problem),
        Err(problem) => Err(problem.without_line()),
    }
}

/// What was asked for as it can be stored and run.
async fn submission(app: &App, kind: Option<JobKind>, asked: JobRequest) -> Answer<Submission> {
    let options = options(kind, &asked.options)?;
    let no_input = || Problem::bad_request("the body has no `input`: give TOML text or an object");
    let given = asked.input.ok_or_else(no_input)?;
    let name = asked.name.unwrap_or_else(|| kind.map_or("case", JobKind::name).to_owned());
    check_name("name", &name)?;
    let mut files: Vec<(String, Vec<u8>)> = Vec::with_capacity(asked.files.len() + 1);
    for (name, FileText(content)) in asked.files {
        check_name("file", &name)?;
        files.push((name, content));
    }
    let text = with_readings(text_of(given)?, &files)?;
    let with_fitted = asked.calibration.is_some();
    if let Some(id) = &asked.calibration {
        files.retain(|(name, _)| name != FITTED);
        files.push((FITTED.to_owned(), record_of(app, id).await?));
    }
    Ok(Submission { name, text, with_fitted, options, files })
}

/// Options as a command takes them, `NAME=VALUE`.
fn options(kind: Option<JobKind>, given: &BTreeMap<String, Value>) -> Answer<Vec<String>> {
    let known = kind.map_or(&[][..], JobKind::options);
    let mut options = Vec::new();
    for (name, value) in given {
        let refused = |problem: &str, remedy: String| Err(input(&format!("options.{name}"), value, problem, remedy).into());
        if !known.contains(&name.as_str()) {
            let remedy = if known.is_empty() { "remove it".to_owned() } else { format!("known are {}", known.join(", ")) };
            return refused("is no option of this job", remedy);
        }
        let values = value.as_array().cloned().unwrap_or_else(|| vec![value.clone()]);
        for value in values {
            match value {
                Value::String(text) if text.len() <= NAME_MAX => options.push(format!("{name}={text}")),
                Value::Bool(_) | Value::Number(_) => options.push(format!("{name}={value}")),
                _ => return refused("must be a string, number, boolean or a list of these", "give one of these".to_owned()),
            }
        }
    }
    Ok(options)
}

/// Asks for the end of work when nobody waits for it any more.
struct Asked(Arc<Watch>);

impl Drop for Asked {
    fn drop(&mut self) {
        self.0.cancel();
    }
}

/// Looks at input on a thread of its own, or in a process of its own, until the request that waits for it has gone: the process ends
/// then, the thread at its next mark. The room of the body is taken up until the work is done.
pub async fn look(app: &App, look: Look, room: BodyPlace, by_process: bool) -> Answer<(String, Look, BodyPlace)> {
    let watch = Arc::new(Watch::default());
    let _asked = Asked(Arc::clone(&watch));
    let (program, memory) = (app.workers.program.clone(), app.workers.memory);
    let work = move || {
        let found = if by_process { worker::look(&program, &look, memory) } else { look.answer() };
        found.map(|found| (found, look, room))
    };
    let worked = tokio::task::spawn_blocking(move || watch::with(Some(watch), work));
    worked.await.map_err(|_| Problem::internal())?
}

fn too_long() -> Problem {
    Problem::too_large(format!("the input is longer than {INPUT_MAX} bytes; send readings as files"))
}

/// Values of a JSON text and what separates them, roughly: commas, colons and brackets outside of strings.
fn parts(json: &[u8]) -> usize {
    let (mut count, mut in_string, mut is_escaped) = (0, false, false);
    for &byte in json {
        match (in_string, byte) {
            (true, _) if is_escaped => is_escaped = false,
            (true, b'\\') => is_escaped = true,
            (_, b'"') => in_string = !in_string,
            (false, b',' | b':' | b'[' | b'{') => count += 1,
            _ => {}
        }
    }
    count
}

/// TOML of the input.
fn text_of(given: Value) -> Answer<String> {
    match given {
        Value::String(text) if text.len() > INPUT_MAX => Err(too_long()),
        Value::String(text) => Ok(text),
        Value::Object(_) => {
            if let Some(key) = null_in(&given, "") {
                let detail = format!("`input` has no form in TOML: {key} is null; give a value, or leave the key out");
                return Err(Problem::bad_request(detail));
            }
            let refused = |error: &dyn std::fmt::Display| Problem::bad_request(format!("`input` has no form in TOML: {error}"));
            let table = toml::Table::try_from(given).map_err(|error| refused(&error))?;
            toml::to_string(&table).map_err(|error| refused(&error))
        }
        _ => Err(Problem::bad_request("`input` is neither text nor an object: give TOML text or an object of its keys")),
    }
}

/// A calibration that names no files uses all that came with it.
fn with_readings(text: String, files: &[(String, Vec<u8>)]) -> Answer<String> {
    let names = |measured: &toml::Value| ["files", "rates"].iter().any(|key| measured.get(key).is_some());
    let is_short = |table: &toml::Table| JobKind::of(table) == JobKind::Calibration && !table.get("measured").is_some_and(names);
    let table = text.parse::<toml::Table>().ok().filter(|table| !files.is_empty() && is_short(table));
    let Some(mut table) = table else { return Ok(text) };
    let measured = table.entry("measured").or_insert_with(|| toml::Table::new().into());
    if let Some(measured) = measured.as_table_mut() {
        measured.insert("files".to_owned(), files.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>().into());
    }
    toml::to_string(&table).map_err(|error| Problem::bad_request(error.to_string()))
}

/// The record of a finished calibration.
async fn record_of(app: &App, id: &str) -> Answer<Vec<u8>> {
    let refused = |problem: &str, remedy: &str| Problem::from(input("calibration", format!("\"{id}\""), problem, remedy));
    let known = if is_id(id) { app.store.job(JobKind::Calibration, id).await? } else { None };
    let Some(job) = known else {
        return Err(refused("is no calibration here", "give the id of one that GET /v1/calibrations lists"));
    };
    match app.store.whole_file(id, Origin::Result, FITTED).await? {
        Some(record) => Ok(record),
        None => Err(refused(&format!("has no result: it is {}", job.state), &format!("wait until it has {}", State::Succeeded))),
    }
}
