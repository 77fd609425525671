//! A job as it goes on, as server-sent events.

use std::convert::Infallible;
use std::time::{Duration, Instant};

use axum::Extension;
use axum::extract::{Path, State as Shared};
use axum::http::HeaderMap;
use axum::response::IntoResponse;
use axum::response::sse::{Event, KeepAlive, Sse};
use serde_json::json;
use tokio::sync::mpsc::{Sender, channel};
use tokio_stream::wrappers::ReceiverStream;

use super::App;
use super::app::{Caller, Place};
use super::collections::{job_of, view};
use crate::job::JobKind;
use crate::problem::{Answer, Problem};

/// Time between two looks at the store.
const LOOK_EVERY: Duration = Duration::from_millis(250);
/// Time for which a store that does not answer is asked again, before the stream ends and the reader has to come back.
const PATIENCE: Duration = Duration::from_secs(30);
/// Time between two looks whether the token of a reader still counts.
const TOKEN_EVERY: Duration = Duration::from_secs(2);
/// Events that may wait for a slow reader.
const WAITING: usize = 16;

/// What a reader has seen; the id of every event.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Seen {
    revision: i64,
    /// Claim whose curve it was.
    fence: i64,
    entries: i64,
    picture: i64,
}

impl Seen {
    fn of(id: &str) -> Option<Seen> {
        let mut numbers = id.split('.').map(|number| number.parse().ok());
        let mut next = || numbers.next().flatten();
        Some(Seen { revision: next()?, fence: next()?, entries: next()?, picture: next()? })
    }

    fn id(&self) -> String {
        format!("{}.{}.{}.{}", self.revision, self.fence, self.entries, self.picture)
    }
}

/// A job as it goes on: events `job` (where it stands), `growth` (more of its curve: entries from `from` on, 0 starts over) and
/// `picture` (a new one is at its `href`). Ends when the job has ended, or the token does not count any more. `Last-Event-ID` goes on where a reader was cut off.
#[utoipa::path(get, path = "/v1/{collection}/{id}/events", tag = "jobs",
    params(("collection" = String, Path), ("id" = String, Path), ("Last-Event-ID" = Option<String>, Header)),
    responses((status = 200, description = "Events", content_type = "text/event-stream"), (status = 404, body = Problem), (status = 429, body = Problem)))]
pub async fn events(
    Shared(app): Shared<App>,
    Path((collection, id)): Path<(String, String)>,
    Extension(caller): Extension<Caller>,
    headers: HeaderMap,
) -> Answer<impl IntoResponse> {
    let places = app.stream(&caller)?;
    let kind = job_of(&app, &collection, &id).await?.kind;
    let seen = headers.get("last-event-id").and_then(|id| id.to_str().ok()).and_then(Seen::of).unwrap_or_default();
    let (events, reader) = channel(WAITING);
    tokio::spawn(async move {
        let mut follower = Follower { app, kind, id, seen, has_told: false, events, _places: places };
        let (mut answered, mut admitted) = (Instant::now(), Instant::now());
        loop {
            if admitted.elapsed() > TOKEN_EVERY {
                admitted = Instant::now();
                // A database that does not answer is the matter of the look.
                if !caller.token.is_empty() && matches!(follower.app.store.token(&caller.token).await, Ok(None)) {
                    break;
                }
            }
            match follower.look().await {
                Ok(true) => answered = Instant::now(),
                Ok(false) => break,
                Err(_) if answered.elapsed() > PATIENCE => break,
                Err(_) => {}
            }
            if follower.app.is_stopping() || follower.events.is_closed() {
                break;
            }
            tokio::time::sleep(LOOK_EVERY).await;
        }
    });
    // A proxy that gathers an answer before it hands it on would keep events back.
    Ok(([("x-accel-buffering", "no")], Sse::new(ReceiverStream::new(reader)).keep_alive(KeepAlive::default())))
}

/// Sends a reader what is new.
struct Follower {
    app: App,
    kind: JobKind,
    id: String,
    seen: Seen,
    has_told: bool,
    events: Sender<Result<Event, Infallible>>,
    _places: [Place; 2],
}

impl Follower {
    /// Looks once; whether there may be more to come.
    async fn look(&mut self) -> Answer<bool> {
        let Some(revision) = self.app.store.revision(&self.id).await? else { return Ok(false) };
        // Whoever comes is told where the job stands, even if he has heard it before: it may have ended.
        if std::mem::replace(&mut self.has_told, true) && revision == self.seen.revision {
            return Ok(true);
        }
        let Some(job) = self.app.store.job(self.kind, &self.id).await? else { return Ok(false) };
        let (is_final, fence, revision) = (job.state.is_final(), job.attempts, job.revision);
        if self.kind == JobKind::Prediction && !is_final {
            self.follow_growth(fence).await?;
            self.follow_picture().await?;
        }
        self.seen.revision = revision;
        let view = view(&self.app, job, false).await?;
        let sent = self.send("job", &json!(view)).await;
        Ok(sent && !is_final)
    }

    async fn follow_growth(&mut self, fence: i64) -> Answer<()> {
        if fence != self.seen.fence {
            // Another worker took the job up, perhaps further back.
            (self.seen.fence, self.seen.entries) = (fence, 0);
        }
        for growth in self.app.store.growth(&self.id, self.seen.entries, Some(fence)).await? {
            if growth.cycles.is_empty() {
                continue;
            }
            self.seen.entries = (growth.from + growth.cycles.len()) as i64;
            self.send("growth", &json!(growth)).await;
        }
        Ok(())
    }

    async fn follow_picture(&mut self) -> Answer<()> {
        let Some((revision, about)) = self.app.store.picture_about(&self.id).await? else { return Ok(()) };
        if revision != self.seen.picture {
            self.seen.picture = revision;
            let mut about: serde_json::Value = serde_json::from_str(&about).unwrap_or_else(|_| json!({}));
            about["revision"] = revision.into();
            about["href"] = format!("/v1/{}/{}/live/damage.svg", self.kind.collection(), self.id).into();
            self.send("picture", &about).await;
        }
        Ok(())
    }

    /// Sends an event; whether there is still somebody to send to.
    async fn send(&self, name: &str, data: &serde_json::Value) -> bool {
        let event = Event::default().event(name).id(self.seen.id()).data(data.to_string());
        self.events.send(Ok(event)).await.is_ok()
    }
}
