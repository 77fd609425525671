//! What every request can reach; places of which there are so many: for each caller, for each role, for all.

use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::io::Write as _;
use std::net::IpAddr;
use std::num::NonZeroU32;
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant, SystemTime};

use axum::http::{Method, StatusCode};
use governor::{DefaultKeyedRateLimiter, Quota, RateLimiter};
use serde_json::json;
use tokio::sync::{Notify, OwnedSemaphorePermit, RwLock, Semaphore};

use crate::problem::{Answer, Problem};
use crate::store::{Role, Store, Token};
use crate::worker;
use perilife_base::error::{Error, Result};

#[derive(Debug, Clone)]
pub struct Limits {
    /// Bytes of a body, all files together.
    pub body_bytes: usize,
    pub files: usize,
    pub points: f64,
    pub case_bytes: f64,
    /// Jobs of one owner that wait.
    pub queued: i64,
    /// Bytes of the files of one owner, inputs and results.
    pub quota_bytes: i64,
    pub requests_per_second: NonZeroU32,
    /// Of them those that submit, check or upload.
    pub writes_per_second: NonZeroU32,
    /// Bodies read and checked at a time, so that memory is bounded: the others wait.
    pub bodies_at_once: usize,
    pub bodies_of_caller: usize,
    /// Of them those of all callers together who may only read.
    pub bodies_of_readers: usize,
    /// Streams of events, and waits for the end of a job, of one caller at a time.
    pub streams_of_caller: usize,
    pub connections: usize,
    pub answer_within: Duration,
}

impl Default for Limits {
    fn default() -> Self {
        const READS: NonZeroU32 = NonZeroU32::new(5_000).unwrap();
        const WRITES: NonZeroU32 = NonZeroU32::new(1_000).unwrap();
        Limits {
            body_bytes: 32 << 20,
            files: 64,
            points: 1e6,
            case_bytes: 4.0 * 1024.0 * 1024.0 * 1024.0,
            queued: 1000,
            quota_bytes: 100 << 30,
            requests_per_second: READS,
            writes_per_second: WRITES,
            bodies_at_once: 8,
            bodies_of_caller: 3,
            bodies_of_readers: 4,
            streams_of_caller: 64,
            connections: 1000,
            answer_within: Duration::from_secs(60),
        }
    }
}

/// Whole curves in memory at a time.
const CURVES_AT_ONCE: usize = 16;

#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Security {
    /// Whether every request needs a token. Without, only this machine can reach the service, and all who can may do all.
    pub needs_token: bool,
    /// Whether what a proxy says of a request is believed. Else one that came through a proxy needs a token in any case.
    pub trusts_proxy: bool,
    /// Where the service is reached from outside, without a slash at the end.
    pub public_url: Option<String>,
}

/// Time for which a token that was found good is not looked up again.
const TOKEN_FRESH: Duration = Duration::from_secs(10);
const TOKENS_REMEMBERED: usize = 1000;

/// What every request can reach.
#[derive(Debug, Clone)]
pub struct App {
    pub store: Store,
    pub limits: Limits,
    pub security: Security,
    /// Told of new jobs.
    pub wake: Arc<Notify>,
    /// How workers of this process work, and what a process that looks at input may take.
    pub workers: worker::Settings,
    pub bodies: BodyPlaces,
    /// Room for whole curves that something is computed from.
    pub curves: Arc<Semaphore>,
    /// Folders that are written to, by name: of the database file, of temporary files.
    pub disks: Arc<Vec<(&'static str, PathBuf)>>,
    /// Who has changed what, if that is written down.
    pub audit: Option<Arc<Audit>>,
    streams: Places,
    all_streams: Places,
    shared: Arc<Shared>,
}

#[derive(Debug)]
struct Shared {
    requests: DefaultKeyedRateLimiter<String>,
    writes: DefaultKeyedRateLimiter<String>,
    tokens: RwLock<Vec<(String, Token, Instant)>>,
    stopping: AtomicBool,
}

impl App {
    pub fn new(store: Store, limits: Limits, security: Security, workers: worker::Settings, wake: Arc<Notify>) -> Self {
        let limiter = |per_second: NonZeroU32| RateLimiter::keyed(Quota::per_second(per_second));
        let shared = Shared {
            requests: limiter(limits.requests_per_second),
            writes: limiter(limits.writes_per_second),
            tokens: RwLock::new(Vec::new()),
            stopping: AtomicBool::new(false),
        };
        let bodies = BodyPlaces::new(limits.bodies_of_caller, limits.bodies_of_readers, limits.bodies_at_once);
        let curves = Arc::new(Semaphore::new(CURVES_AT_ONCE));
        // Half of the connections are left to those who ask and go.
        let (streams, all_streams) = (Places::new(limits.streams_of_caller), Places::new((limits.connections / 2).max(1)));
        App {
            store,
            limits,
            security,
            wake,
            workers,
            bodies,
            curves,
            disks: Arc::default(),
            audit: None,
            streams,
            all_streams,
            shared: Arc::new(shared),
        }
    }

    /// A place for a stream of events, or a wait for the end of a job.
    pub fn stream(&self, caller: &Caller) -> Answer<[Place; 2]> {
        let take = |places: &Places, key: &str, whose: &str| {
            let full = || format!("{} streams{whose} are open, which is all this server takes", places.most());
            places.take(key).ok_or_else(|| Problem::too_many(full(), 5))
        };
        Ok([take(&self.streams, &caller.name, " of yours")?, take(&self.all_streams, "", "")?])
    }

    /// An address as others reach it.
    pub fn public(&self, path: &str) -> String {
        format!("{}{path}", self.security.public_url.as_deref().unwrap_or_default())
    }

    /// Whether a caller may ask once more just now.
    pub fn may_ask(&self, caller: Option<&str>, address: IpAddr, is_write: bool) -> bool {
        let key = caller.map_or_else(|| address.to_string(), |name| format!("token {name}"));
        let within = |limiter: &DefaultKeyedRateLimiter<String>| limiter.check_key(&key).is_ok();
        within(&self.shared.requests) && (!is_write || within(&self.shared.writes))
    }

    pub fn forget_callers(&self) {
        self.shared.requests.retain_recent();
        self.shared.writes.retain_recent();
        self.bodies.forget();
    }

    /// The token with this hash as it was when it was last looked up, and whether that was a moment ago.
    pub async fn known_token(&self, hash: &str) -> Option<(Token, bool)> {
        let known = self.shared.tokens.read().await;
        known.iter().find(|(known, ..)| known == hash).map(|(_, token, at)| (token.clone(), at.elapsed() < TOKEN_FRESH))
    }

    /// The token with this hash, if there is one that has not ended.
    pub async fn token(&self, hash: &str) -> crate::store::Result<Option<Token>> {
        let found = self.store.token(hash).await?;
        let mut known = self.shared.tokens.write().await;
        known.retain(|(other, ..)| other != hash);
        if let Some(token) = &found
            && known.len() < TOKENS_REMEMBERED
        {
            known.push((hash.to_owned(), token.clone(), Instant::now()));
        }
        Ok(found)
    }

    /// Ends what would otherwise never end.
    pub fn stop(&self) {
        self.shared.stopping.store(true, Ordering::Relaxed);
    }

    /// Whether the service is about to stop.
    pub fn is_stopping(&self) -> bool {
        self.shared.stopping.load(Ordering::Relaxed)
    }
}

/// Counts what each has taken; who comes when all of his are taken gets none.
#[derive(Debug, Clone)]
pub struct Places(Arc<Counted>);

#[derive(Debug)]
struct Counted {
    most: usize,
    taken: Mutex<HashMap<String, usize>>,
}

/// A place; given back when dropped.
#[derive(Debug)]
pub struct Place {
    places: Places,
    key: String,
    /// How many of its key were left when it was taken.
    pub left: usize,
}

impl Places {
    pub fn new(most: usize) -> Self {
        Places(Arc::new(Counted { most, taken: Mutex::default() }))
    }

    pub fn most(&self) -> usize {
        self.0.most
    }

    pub fn take(&self, key: &str) -> Option<Place> {
        let mut taken = self.0.taken.lock().unwrap_or_else(PoisonError::into_inner);
        let count = taken.entry(key.to_owned()).or_default();
        if *count >= self.0.most {
            return None;
        }
        *count += 1;
        Some(Place { places: self.clone(), key: key.to_owned(), left: self.0.most - *count })
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        let mut taken = self.places.0.taken.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(count) = taken.get_mut(&self.key) {
            *count -= 1;
            if *count == 0 {
                taken.remove(&self.key);
            }
        }
    }
}

/// Places for bodies in memory: who waits for one does so behind those of his own, then of his role, then of all, so that nobody's slow
/// bodies keep the others waiting.
#[derive(Debug, Clone)]
pub struct BodyPlaces {
    most_of_caller: usize,
    of_callers: Arc<Mutex<HashMap<String, Arc<Semaphore>>>>,
    of_readers: Arc<Semaphore>,
    of_all: Arc<Semaphore>,
}

/// Room for one body; given back when dropped.
#[derive(Debug)]
pub struct BodyPlace {
    _held: Vec<OwnedSemaphorePermit>,
}

impl BodyPlaces {
    pub fn new(of_caller: usize, of_readers: usize, of_all: usize) -> Self {
        BodyPlaces {
            most_of_caller: of_caller,
            of_callers: Arc::default(),
            of_readers: Arc::new(Semaphore::new(of_readers)),
            of_all: Arc::new(Semaphore::new(of_all)),
        }
    }

    /// Waits for room for one more body of a caller.
    pub async fn wait(&self, caller: &Caller) -> Answer<BodyPlace> {
        let own = {
            let mut callers = self.of_callers.lock().unwrap_or_else(PoisonError::into_inner);
            let own = callers.entry(caller.name.clone()).or_insert_with(|| Arc::new(Semaphore::new(self.most_of_caller)));
            Arc::clone(own)
        };
        let of_role = (caller.role == Role::Read).then(|| Arc::clone(&self.of_readers));
        let mut held = Vec::with_capacity(3);
        for places in [Some(own), of_role, Some(Arc::clone(&self.of_all))].into_iter().flatten() {
            // Never closed, and if it were: come back later.
            let stops = |_| Problem::too_many("the server is about to stop", 5);
            held.push(places.acquire_owned().await.map_err(stops)?);
        }
        Ok(BodyPlace { _held: held })
    }

    /// Forgets callers who have no body in memory.
    pub fn forget(&self) {
        let most = self.most_of_caller;
        let in_use = |places: &Arc<Semaphore>| Arc::strong_count(places) > 1 || places.available_permits() < most;
        self.of_callers.lock().unwrap_or_else(PoisonError::into_inner).retain(|_, places| in_use(places));
    }
}

/// Who asks.
#[derive(Debug, Clone, PartialEq)]
pub struct Caller {
    /// Name of the token; empty where none is needed.
    pub name: String,
    /// What he may do.
    pub role: Role,
    /// Hash of the token; empty where none is needed.
    pub token: String,
}

impl Caller {
    /// Refuses who may not.
    pub fn must_be(&self, role: Role) -> Answer<()> {
        if self.role >= role {
            return Ok(());
        }
        let detail = format!("requires role {role}; your token has {}", self.role);
        Err(Problem::new(StatusCode::FORBIDDEN, "Forbidden", detail))
    }

    /// Refuses who may not do something with a job of this owner.
    pub fn must_own(&self, owner: &str) -> Answer<()> {
        self.must_be(if owner == self.name { Role::Run } else { Role::Admin })
    }
}

/// The file that it is written to.
#[derive(Debug)]
pub struct Audit(Mutex<File>);

impl Audit {
    /// Appends to a file, which nobody else may read if it is made now.
    pub fn open(path: &Path) -> Result<Audit> {
        let file = OpenOptions::new().create(true).append(true).mode(0o600).open(path);
        Ok(Audit(Mutex::new(file.map_err(|error| Error::file(path, "cannot append to", error))?)))
    }

    /// Writes down a request that changed something, or that was refused for who made it.
    pub fn write(&self, caller: Option<&Caller>, address: IpAddr, method: &Method, path: &str, status: StatusCode) {
        let is_read = matches!(*method, Method::GET | Method::HEAD);
        if is_read && ![StatusCode::UNAUTHORIZED, StatusCode::FORBIDDEN].contains(&status) {
            return;
        }
        let line = json!({
            "time": humantime::format_rfc3339_millis(SystemTime::now()).to_string(),
            "caller": caller.map(|caller| caller.name.as_str()), "role": caller.map(|caller| caller.role.name()),
            "address": address.to_string(), "method": method.as_str(), "path": path, "status": status.as_u16(),
        });
        let mut file = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        // In one call, so that lines of two processes do not mix.
        if let Err(error) = file.write_all(format!("{line}\n").as_bytes()) {
            tracing::error!("the audit log cannot be written: {error}");
        }
    }
}
